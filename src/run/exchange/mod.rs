//! Data exchange: `execute_unload`, `execute_load`, `$gdxin`, `$load` and their kin, with open formats.
//!
//! The file's ending says the format: `.csv` (one symbol, or many with a column `symbol`), `.json`; a
//! name that ends in `/` is a folder with a CSV file per symbol. `docs/data-exchange.md` describes them.
//!
//! Invariant: a load changes all of its symbols or, with a diagnostic, nothing.

mod csv;
mod json;
mod load;
mod write;

use super::Machine;
use crate::check::node::SymbolId;
use crate::check::symbols::{SymbolKind, attribute};
use crate::data::value::{EPS, NA, UNDF, as_acronym, is_eps, is_na};
use crate::diag::{Diagnostic, nearest};
use crate::source::Span;
use crate::syntax::ast::{Exchange, Ident};
use load::Loading;

/// Where `$load` reads from and `$unload` writes to.
#[derive(Clone, Debug, Default)]
pub struct ExchangeState {
    /// The file that `$gdxIn` named.
    input: Option<(String, Span)>,
    /// The file that `$gdxOut` named, and what `$unload` asked for.
    output: Option<(String, Span, Vec<Wanted>)>,
}

/// A symbol, and its name in the file.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    symbol: SymbolId,
    name: String,
    span: Span,
}

/// A format, by the ending of a file's name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Kind {
    Csv,
    Json,
    /// A folder with a CSV file per symbol.
    Folder,
}

/// Attributes of variables and equations in files: name, other names, place behind the first table.
const ATTRIBUTES: &[(&str, &str, u32)] = &[
    ("level", "l", attribute::L),
    ("marginal", "m", attribute::M),
    ("lower", "lo", attribute::LO),
    ("upper", "up", attribute::UP),
    ("scale", "scale", attribute::SCALE),
];

/// Place of an attribute by either of its names.
fn attribute_offset(name: &str) -> Option<u32> {
    let hit =
        |a: &&(&str, &str, u32)| a.0.eq_ignore_ascii_case(name) || a.1.eq_ignore_ascii_case(name);
    ATTRIBUTES.iter().find(hit).map(|a| a.2)
}

impl Machine<'_> {
    /// A statement or directive.
    pub(super) fn exchange(&mut self, x: &Exchange, span: Span) {
        let keyword = x.keyword.name.to_lowercase();
        match keyword.as_str() {
            "gdxin" => self.transfer.input = x.file.as_ref().map(|(f, s)| (f.to_string(), *s)),
            "gdxout" => {
                self.finish_unload();
                self.transfer.output = x
                    .file
                    .as_ref()
                    .map(|(f, s)| (f.to_string(), *s, Vec::new()));
            }
            k if k.contains("unload") => {
                let Some(items) = self.wanted(&x.items) else {
                    return;
                };
                match (&x.file, &mut self.transfer.output) {
                    (Some((file, at)), _) => {
                        let items = if items.is_empty() {
                            self.everything(span)
                        } else {
                            items
                        };
                        self.unload(file, &items, *at);
                    }
                    (None, Some(output)) => output.2.extend(items),
                    (None, None) => self.no_file(span, "$gdxOut 'results.json'"),
                }
            }
            k => {
                let Some(items) = self.wanted(&x.items) else {
                    return;
                };
                let file = x
                    .file
                    .as_ref()
                    .map(|(f, s)| (f.to_string(), *s))
                    .or_else(|| self.transfer.input.clone());
                match file {
                    Some((file, at)) if x.file.is_some() || !items.is_empty() => {
                        self.load(&file, &items, k.contains("point"), at, span);
                    }
                    // `$load` alone lists a file in GAMS; there is nothing to do.
                    Some(_) => {}
                    None => self.no_file(span, "$gdxIn 'data.csv'"),
                }
            }
        }
    }

    fn no_file(&self, span: Span, write: &str) {
        self.note(
            Diagnostic::execution("E0475", span, "no file is named")
                .label("which file?")
                .help(format!("write `{write}` before")),
        );
    }

    /// Writes what `$unload` collected.
    pub(super) fn finish_unload(&mut self) {
        if let Some((file, span, items)) = self.transfer.output.take()
            && !items.is_empty()
        {
            self.unload(&file, &items, span);
        }
    }

    /// The symbols of a list; None, and a diagnostic, if one is not known or has no data.
    fn wanted(&self, items: &[(Ident, Option<Ident>)]) -> Option<Vec<Wanted>> {
        let mut out = Vec::new();
        for (name, other) in items {
            let Some(symbol) = self.symbols.find(&name.name) else {
                self.note(Diagnostic::execution(
                    "E0475",
                    name.span,
                    format!("`{}` is not known", name.name),
                ));
                return None;
            };
            if !has_data(&self.symbols.get(symbol).kind) {
                let kind = self.symbols.get(symbol).kind_name();
                self.note(
                    Diagnostic::execution(
                        "E0475",
                        name.span,
                        format!("`{}` is a {kind}; it has no data to exchange", name.name),
                    )
                    .label("a set, parameter, variable or equation is expected"),
                );
                return None;
            }
            let shown = other.as_ref().map_or_else(
                || self.symbols.get(symbol).name.to_string(),
                |o| o.name.to_string(),
            );
            out.push(Wanted {
                symbol,
                name: shown,
                span: name.span,
            });
        }
        Some(out)
    }

    /// All symbols with data, in order of declaration.
    fn everything(&self, span: Span) -> Vec<Wanted> {
        let listed = |k: &SymbolKind| has_data(k) && !matches!(k, SymbolKind::Alias(_));
        let all = self.symbols.iter().skip(1).filter(|(_, s)| listed(&s.kind));
        all.map(|(symbol, s)| Wanted {
            symbol,
            name: s.name.to_string(),
            span,
        })
        .collect()
    }

    /// The format of a file; a diagnostic if it is none of ours.
    fn format_of(&self, file: &str, span: Span) -> Option<Kind> {
        if file.ends_with('/') {
            return Some(Kind::Folder);
        }
        let ending = std::path::Path::new(file)
            .extension()
            .map(|e| e.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("csv" | "tsv" | "txt") => return Some(Kind::Csv),
            Some("json") => return Some(Kind::Json),
            _ => {}
        }
        let d = match ending.as_deref() {
            Some("gdx") | None => {
                let stem = file.strip_suffix(".gdx").unwrap_or(file);
                let d = if ending.is_none() {
                    Diagnostic::execution(
                        "E0476",
                        span,
                        format!("the name `{file}` does not say a format"),
                    )
                } else {
                    Diagnostic::execution(
                        "E0476",
                        span,
                        format!(
                            "`{file}`: GDX is GAMS's own binary format; bmod exchanges open ones"
                        ),
                    )
                };
                d.label("a name that ends in .csv or .json is expected").help(format!(
                    "write `'{stem}.csv'` or `'{stem}.json'`; `gdxdump {stem}.gdx symb=NAME format=csv` makes a CSV file of a GDX symbol"
                ))
            }
            Some(other) => Diagnostic::execution(
                "E0476",
                span,
                format!("`.{other}` is not a format for data"),
            )
            .label("a name that ends in .csv or .json is expected"),
        };
        self.note(d);
        None
    }

    /// What a model writes for GAMS as `results.gdx` is written as `results.json`, with a warning.
    fn instead_of_gdx(&self, file: &str, span: Span) -> Option<String> {
        let path = std::path::Path::new(file);
        let gdx = path
            .extension()
            .is_none_or(|e| e.eq_ignore_ascii_case("gdx"));
        if !gdx || file.ends_with('/') {
            return None;
        }
        let other = path.with_extension("json").to_string_lossy().into_owned();
        self.note(
            Diagnostic::warning(
                "E0476",
                span,
                format!("`{other}` is written in place of the GDX file `{file}`"),
            )
            .label("GDX is GAMS's own binary format")
            .help("name a file that ends in `.csv` or `.json` to choose the format"),
        );
        Some(other)
    }

    fn unload(&mut self, file: &str, items: &[Wanted], span: Span) {
        let instead = self.instead_of_gdx(file, span);
        let file = instead.as_deref().unwrap_or(file);
        let Some(kind) = self.format_of(file, span) else {
            return;
        };
        for w in items {
            let symbol = self.symbols.get(w.symbol);
            let (first, count) = match symbol.kind {
                SymbolKind::Variable(_) | SymbolKind::Equation(_) => {
                    (symbol.table, attribute::COUNT)
                }
                _ => (symbol.table, 1),
            };
            for t in first..first + count {
                self.store.table_mut(t).tidy();
            }
        }
        match kind {
            Kind::Csv => {
                let text = self.csv_of(items);
                self.write_file(file, text.as_bytes(), span);
            }
            Kind::Json => {
                let text = self.json_of(items);
                self.write_file(file, text.as_bytes(), span);
            }
            Kind::Folder => {
                for w in items {
                    let text = self.csv_of(std::slice::from_ref(w));
                    if !self.write_file(&format!("{file}{}.csv", w.name), text.as_bytes(), span) {
                        return;
                    }
                }
            }
        }
    }

    fn load(&mut self, file: &str, items: &[Wanted], point: bool, at: Span, span: Span) {
        let Some(kind) = self.format_of(file, at) else {
            return;
        };
        let mut files = Vec::new();
        if kind == Kind::Folder {
            for w in items {
                let name = format!("{file}{}.csv", w.name);
                let Some(text) = self.read_file(&name, at) else {
                    return;
                };
                files.push((name, text, vec![w.clone()]));
            }
        } else {
            let Some(text) = self.read_file(file, at) else {
                return;
            };
            files.push((file.to_string(), text, items.to_vec()));
        }
        let mut loading = Loading::new(&self.symbols, &self.store, point);
        for (name, text, mut items) in files {
            if items.is_empty() {
                let found = match kind {
                    Kind::Json => json::names(&text),
                    _ => csv::names(&text),
                };
                items = self.declared(&found, point, span);
            }
            // Sets first: they may be the domains of the others.
            items.sort_by_key(|w| !self.symbols.get(w.symbol).is_set());
            let result = match kind {
                Kind::Json => json::read(&name, &text, &items, &mut loading),
                _ => csv::read(&name, &text, &items, &mut loading),
            };
            if let Err(d) = result {
                self.note(*d);
                return;
            }
        }
        let loaded = loading.finish();
        for label in &loaded.labels {
            self.store.universe.intern(label);
        }
        for (table, data) in loaded.tables {
            *self.store.table_mut(table) = data;
        }
        for (table, texts) in loaded.texts {
            self.store.texts.insert(table, texts);
        }
        self.store.refresh_universe();
        for w in loaded.symbols {
            let root = self.symbols.root(w);
            self.symbols.get_mut(root).assigned = true;
        }
    }

    /// The symbols of the program among names in a file.
    fn declared(&self, names: &[String], point: bool, span: Span) -> Vec<Wanted> {
        let mut out: Vec<Wanted> = Vec::new();
        for n in names {
            let Some(symbol) = self.symbols.find(n) else {
                continue;
            };
            let kind = &self.symbols.get(symbol).kind;
            let fits = if point {
                matches!(kind, SymbolKind::Variable(_) | SymbolKind::Equation(_))
            } else {
                has_data(kind)
            };
            if fits && !out.iter().any(|w| w.symbol == symbol) {
                out.push(Wanted {
                    symbol,
                    name: n.clone(),
                    span,
                });
            }
        }
        out
    }

    /// A value as files hold it.
    fn value_text(&self, v: f64) -> String {
        match special_name(v) {
            Some(name) => name.to_string(),
            None => match as_acronym(v).and_then(|a| self.store.acronyms.get(a as usize)) {
                Some(name) => name.to_string(),
                None if v == 0.0 || (1e-5..1e15).contains(&v.abs()) => v.to_string(),
                None => format!("{v:e}"),
            },
        }
    }
}

fn has_data(kind: &SymbolKind) -> bool {
    !matches!(
        kind,
        SymbolKind::Model(_) | SymbolKind::File(_) | SymbolKind::Acronym(_) | SymbolKind::Figure(_)
    )
}

/// The name of a special value.
fn special_name(v: f64) -> Option<&'static str> {
    match v {
        v if v.is_finite() => None,
        f64::INFINITY => Some("+INF"),
        f64::NEG_INFINITY => Some("-INF"),
        v if is_eps(v) => Some("EPS"),
        v if is_na(v) => Some("NA"),
        v if as_acronym(v).is_some() => None,
        _ => Some("UNDF"),
    }
}

/// A number, a special value, `yes`, `no` or an acronym.
fn parse_value(text: &str, acronyms: &[Box<str>]) -> Option<f64> {
    let t = text.trim();
    if let Ok(v) = fast_float2::parse::<f64, _>(t.strip_prefix('+').unwrap_or(t))
        && v.is_finite()
        && t.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.'))
    {
        return Some(v);
    }
    Some(match t.to_ascii_lowercase().as_str() {
        "inf" | "+inf" | "infinity" => f64::INFINITY,
        "-inf" | "-infinity" => f64::NEG_INFINITY,
        "eps" => EPS,
        "na" => NA,
        "undf" => UNDF,
        "yes" | "true" => 1.0,
        "no" | "false" => 0.0,
        lower => {
            let n = acronyms
                .iter()
                .position(|a| a.eq_ignore_ascii_case(lower))?;
            crate::data::value::acronym(n as u32)
        }
    })
}

/// No symbol of that name in the file.
fn missing(file: &str, w: &Wanted, there: &[String]) -> Box<Diagnostic> {
    let d = Diagnostic::execution(
        "E0477",
        w.span,
        format!("the file `{file}` has no symbol `{}`", w.name),
    );
    Box::new(match nearest(&w.name, there.iter().map(String::as_str)) {
        Some(n) => d.help(format!("did you mean `{n}`? write `{} = {n}`", w.name)),
        None if there.is_empty() => d.help("the file holds no symbols"),
        None => d.help(format!("it has: {}", there.join(", "))),
    })
}
