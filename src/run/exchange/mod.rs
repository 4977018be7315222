//! Data exchange in the run: `execute_unload`, `execute_load`, `$unload` and their kin, with open formats
//! (`$load` acts while the text is read: [`crate::check::load`]).
//!
//! The file's ending says the format: `.csv` (one symbol, or many with a column `symbol`), `.json`; a
//! name that ends in `/` is a folder with a CSV file per symbol. `docs/data-exchange.md` describes them.
//!
//! Invariant: a load changes all of its symbols or, with a diagnostic, nothing.

mod write;

use super::Machine;
use crate::check::load::{Kind, Request, Wanted, format_of, has_data, load, no_file, wanted};
use crate::check::node::SymbolId;
use crate::check::symbols::{SymbolKind, attribute};
use crate::data::value::{as_acronym, is_eps, is_na};
use crate::diag::Diagnostic;
use crate::model::origin::Origin;
use crate::source::Span;
use crate::syntax::ast::Exchange;
use rustc_hash::FxHashMap;

/// Where `$unload` writes to.
#[derive(Clone, Debug, Default)]
pub struct ExchangeState {
    /// The file that `$gdxOut` named, and what `$unload` asked for.
    output: Option<(String, Span, Vec<Wanted>)>,
    /// Files that `put_utility` named for the next unload and load without a name.
    pub(super) unload_to: Option<String>,
    pub(super) load_from: Option<String>,
    /// What this run wrote, by name: it may be read again.
    written: FxHashMap<String, String>,
}

impl Machine<'_> {
    /// A statement or directive.
    pub(super) fn exchange(&mut self, x: &Exchange, span: Span) {
        let keyword = x.keyword.name.to_lowercase();
        match keyword.as_str() {
            "gdxout" => {
                self.finish_unload();
                self.transfer.output = x
                    .file
                    .as_ref()
                    .map(|(f, s)| (f.to_string(), *s, Vec::new()));
            }
            k if k.contains("unload") => {
                let items = match wanted(&self.symbols, &x.items) {
                    Ok(items) => items,
                    Err(d) => return self.note(*d),
                };
                let named = match k.starts_with("execute") {
                    true => self.transfer.unload_to.clone().map(|f| (f.into(), span)),
                    false => None,
                };
                match (
                    x.file.as_ref().or(named.as_ref()),
                    &mut self.transfer.output,
                ) {
                    (Some((file, at)), _) => {
                        let items = if items.is_empty() {
                            self.everything(span)
                        } else {
                            items
                        };
                        self.unload(file, &items, *at);
                    }
                    (None, Some(output)) => output.2.extend(items),
                    (None, None) => self.note(*no_file(span, "$gdxOut 'results.json'")),
                }
            }
            k => {
                let items = match wanted(&self.symbols, &x.items) {
                    Ok(items) => items,
                    Err(d) => return self.note(*d),
                };
                let named = self.transfer.load_from.clone().map(|f| (f.into(), span));
                let Some((file, at)) = x.file.as_ref().or(named.as_ref()) else {
                    return self.note(*no_file(span, "execute_load 'data.csv', p;"));
                };
                let instead =
                    instead_of_gdx(file).filter(|f| self.transfer.written.contains_key(f));
                let file = instead.as_deref().unwrap_or(file);
                self.load(&Request {
                    file,
                    at: *at,
                    items: &items,
                    point: k.contains("point"),
                    span,
                });
            }
        }
    }

    fn load(&mut self, request: &Request<'_>) {
        let mut symbols = std::mem::take(&mut self.symbols);
        let mut store = std::mem::take(&mut self.store);
        let done = load(
            &mut symbols,
            &mut store,
            request,
            &mut |name, at| match self.transfer.written.get(name) {
                Some(text) => Ok(text.clone()),
                None => self.read_file(name, at),
            },
        );
        (self.symbols, self.store) = (symbols, store);
        if let Err(d) = done {
            self.note(*d);
        }
    }

    /// `savepoint`: levels and marginals of a model are written after its solve, for `execute_loadpoint`.
    pub(super) fn save_point(
        &mut self,
        model: SymbolId,
        savepoint: f64,
        origin: &Origin,
        span: Span,
    ) {
        let mut name = format!("{}_p", self.symbols.get(model).name);
        match savepoint {
            1.0 => {}
            2.0 => name.push_str(&(self.report.solves.len() + 1).to_string()),
            _ => return,
        }
        let blocks = origin.columns.list.iter().chain(&origin.rows.list);
        let items: Vec<Wanted> = blocks
            .map(|b| Wanted {
                symbol: b.symbol,
                name: self.symbols.get(b.symbol).name.to_string(),
                span,
            })
            .collect();
        self.unload(&format!("{name}.gdx"), &items, span);
    }

    /// Writes what `$unload` collected.
    pub(super) fn finish_unload(&mut self) {
        if let Some((file, span, items)) = self.transfer.output.take()
            && !items.is_empty()
        {
            self.unload(&file, &items, span);
        }
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

    fn unload(&mut self, file: &str, items: &[Wanted], span: Span) {
        let instead = instead_of_gdx(file);
        if let Some(other) = &instead {
            self.note(
                Diagnostic::warning(
                    "E0476",
                    span,
                    format!("`{other}` is written in place of the GDX file `{file}`"),
                )
                .label("GDX is GAMS's own binary format")
                .help("name a file that ends in `.csv` or `.json` to choose the format"),
            );
        }
        let file = instead.as_deref().unwrap_or(file);
        let kind = match format_of(file, span) {
            Ok(kind) => kind,
            Err(d) => return self.note(*d),
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
                self.written(file.to_string(), text, span);
            }
            Kind::Json => {
                let text = self.json_of(items);
                self.written(file.to_string(), text, span);
            }
            Kind::Folder => {
                for w in items {
                    let text = self.csv_of(std::slice::from_ref(w));
                    if !self.written(format!("{file}{}.csv", w.name), text, span) {
                        return;
                    }
                }
            }
        }
    }

    /// Writes a file, which may be loaded again.
    fn written(&mut self, name: String, text: String, span: Span) -> bool {
        let done = self.write_file(&name, text.as_bytes(), span);
        self.transfer.written.insert(name, text);
        done
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

/// What a model writes for GAMS as `results.gdx`, or without an ending, is `results.json` here.
fn instead_of_gdx(file: &str) -> Option<String> {
    let path = std::path::Path::new(file);
    let gdx = path
        .extension()
        .is_none_or(|e| e.eq_ignore_ascii_case("gdx"));
    (gdx && !file.ends_with('/')).then(|| path.with_extension("json").to_string_lossy().into())
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
