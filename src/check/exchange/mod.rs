//! Data that a model exchanges in open formats: `$load` and `$unload` while the text is read, so that what
//! follows sees the data, `execute_load` and `execute_unload` in the run.
//!
//! The file's ending says the format: `.csv` (one symbol, or many with a column `symbol`), `.json`; a
//! name that ends in `/` is a folder with a CSV file per symbol. `docs/data-exchange.md` describes them.
//!
//! Invariant: a load changes all of its symbols or, with a diagnostic, nothing.

mod csv;
mod json;
mod records;
mod write;

use super::node::SymbolId;
use super::symbols::{Store, SymbolKind, Symbols, attribute};
use super::{Compiler, Failed};
use crate::data::value::{EPS, NA, UNDF};
use crate::diag::{Diagnostic, nearest};
use crate::source::{SourceMap, Span};
use crate::syntax::Parser;
use crate::syntax::ast::{Exchange, Ident};
use records::Loading;

/// A diagnostic; boxed, because it is large and rare.
pub type Loaded<T> = Result<T, Box<Diagnostic>>;

/// Files to write: names and texts.
pub type Files = Vec<(String, String)>;

/// The text of a file.
pub type Read<'a> = &'a mut dyn FnMut(&str, Span) -> Loaded<String>;

/// A symbol, and its name in the file.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// The symbol.
    pub symbol: SymbolId,
    /// Its name in the file.
    pub name: String,
    /// Where it is asked for.
    pub span: Span,
}

/// A format, by the ending of a file's name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// Comma-separated values.
    Csv,
    /// An object with a member per symbol.
    Json,
    /// A folder with a CSV file per symbol.
    Folder,
}

/// Attributes of variables and equations in files: name, other names, place behind the first table.
pub const ATTRIBUTES: &[(&str, &str, u32)] = &[
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

/// The symbols of a list; an error if one is not known or has no data.
pub fn wanted(symbols: &Symbols, items: &[(Ident, Option<Ident>)]) -> Loaded<Vec<Wanted>> {
    let mut out = Vec::new();
    for (name, other) in items {
        let Some(symbol) = symbols.find(&name.name) else {
            return Err(Box::new(Diagnostic::execution(
                "E0475",
                name.span,
                format!("`{}` is not known", name.name),
            )));
        };
        if !has_data(&symbols.get(symbol).kind) {
            let kind = symbols.get(symbol).kind_name();
            return Err(Box::new(
                Diagnostic::execution(
                    "E0475",
                    name.span,
                    format!("`{}` is a {kind}; it has no data to exchange", name.name),
                )
                .label("a set, parameter, variable or equation is expected"),
            ));
        }
        let shown = other.as_ref().map_or_else(
            || symbols.get(symbol).name.to_string(),
            |o| o.name.to_string(),
        );
        out.push(Wanted {
            symbol,
            name: shown,
            span: name.span,
        });
    }
    Ok(out)
}

/// The format of a file, by the ending of its name.
pub fn format_of(file: &str, span: Span) -> Loaded<Kind> {
    if file.ends_with('/') {
        return Ok(Kind::Folder);
    }
    let ending = std::path::Path::new(file)
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("csv" | "tsv" | "txt") => return Ok(Kind::Csv),
        Some("json") => return Ok(Kind::Json),
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
                    format!("`{file}`: GDX is GAMS's own binary format; bmod exchanges open ones"),
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
    Err(Box::new(d))
}

/// The symbols of the program among names in a file.
fn declared(symbols: &Symbols, names: &[String], point: bool, span: Span) -> Vec<Wanted> {
    let mut out: Vec<Wanted> = Vec::new();
    for n in names {
        let Some(symbol) = symbols.find(n) else {
            continue;
        };
        let kind = &symbols.get(symbol).kind;
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

/// What is to be loaded.
pub struct Request<'a> {
    /// Name of the file.
    pub file: &'a str,
    /// Where the file is named.
    pub at: Span,
    /// The symbols; none for all that the file has.
    pub items: &'a [Wanted],
    /// Levels and marginals only.
    pub point: bool,
    /// Place of the statement.
    pub span: Span,
}

/// Reads symbols from a file, or a folder of files.
pub fn load(
    symbols: &mut Symbols,
    store: &mut Store,
    request: &Request<'_>,
    read: Read<'_>,
) -> Loaded<()> {
    let kind = format_of(request.file, request.at)?;
    let mut files = Vec::new();
    if kind == Kind::Folder {
        for w in request.items {
            let name = format!("{}{}.csv", request.file, w.name);
            let text = read(&name, request.at)?;
            files.push((name, text, vec![w.clone()]));
        }
    } else {
        let text = read(request.file, request.at)?;
        files.push((request.file.to_string(), text, request.items.to_vec()));
    }
    let mut loading = Loading::new(symbols, store, request.point);
    for (name, text, mut items) in files {
        if items.is_empty() {
            let found = match kind {
                Kind::Json => json::names(&text),
                _ => csv::names(&text),
            };
            items = declared(symbols, &found, request.point, request.span);
        }
        // Sets first: they may be the domains of the others.
        items.sort_by_key(|w| !symbols.get(w.symbol).is_set());
        match kind {
            Kind::Json => json::read(&name, &text, &items, &mut loading)?,
            _ => csv::read(&name, &text, &items, &mut loading)?,
        }
    }
    let loaded = loading.finish();
    for label in &loaded.labels {
        store.universe.intern(label);
    }
    for (table, data) in loaded.tables {
        *store.table_mut(table) = data;
    }
    for (table, texts) in loaded.texts {
        store.texts.insert(table, texts);
    }
    store.refresh_universe();
    for w in loaded.symbols {
        let root = symbols.root(w);
        symbols.get_mut(root).assigned = true;
    }
    Ok(())
}

/// The files that hold these symbols: names and texts. A warning says where another name was asked for.
pub fn unload(
    symbols: &Symbols,
    store: &mut Store,
    file: &str,
    items: &[Wanted],
    span: Span,
) -> Loaded<(Files, Option<Diagnostic>)> {
    let instead = instead_of_gdx(file);
    let warning = instead.as_ref().map(|other| {
        Diagnostic::warning(
            "E0476",
            span,
            format!("`{other}` is written in place of the GDX file `{file}`"),
        )
        .label("GDX is GAMS's own binary format")
        .help("name a file that ends in `.csv` or `.json` to choose the format")
    });
    let file = instead.as_deref().unwrap_or(file);
    let kind = format_of(file, span)?;
    let everything = match items.is_empty() {
        true => everything(symbols, span),
        false => Vec::new(),
    };
    let items = if items.is_empty() { &everything } else { items };
    Ok((write::files(symbols, store, kind, file, items), warning))
}

/// All symbols with data, in order of declaration.
fn everything(symbols: &Symbols, span: Span) -> Vec<Wanted> {
    let listed = |k: &SymbolKind| has_data(k) && !matches!(k, SymbolKind::Alias(_));
    let all = symbols.iter().skip(1).filter(|(_, s)| listed(&s.kind));
    all.map(|(symbol, s)| Wanted {
        symbol,
        name: s.name.to_string(),
        span,
    })
    .collect()
}

/// The name of a file to load: what the run has written is found by the name that was asked for.
pub fn file_to_load(map: &SourceMap, file: &str) -> String {
    instead_of_gdx(file)
        .filter(|f| map.written(f).is_some())
        .unwrap_or_else(|| file.to_string())
}

/// What a model writes for GAMS as `results.gdx`, or without an ending, is `results.json` here.
fn instead_of_gdx(file: &str) -> Option<String> {
    let path = std::path::Path::new(file);
    let gdx = path
        .extension()
        .is_none_or(|e| e.eq_ignore_ascii_case("gdx"));
    (gdx && !file.ends_with('/')).then(|| path.with_extension("json").to_string_lossy().into())
}

impl Compiler {
    /// `$gdxIn`, `$load`, `$gdxOut` and `$unload` act while the text is read. False if it is another statement.
    pub(super) fn exchange_now(
        &mut self,
        x: &Exchange,
        span: Span,
        parser: &mut Parser,
    ) -> Result<bool, Failed> {
        let done = match &*x.keyword.name {
            "gdxin" => {
                self.input = x.file.as_ref().map(|(f, s)| (f.to_string(), *s));
                Ok(())
            }
            "gdxout" => {
                let before = self.finish_unload(parser);
                let file = x.file.as_ref();
                self.output = file.map(|(f, s)| (f.to_string(), *s, Vec::new()));
                before
            }
            "unload" => self.unload_listed(x, span),
            "gdxunload" => self
                .unload_listed(x, span)
                .and_then(|()| self.finish_unload(parser)),
            k if k.starts_with("load") || k == "gdxload" => self.load_listed(x, span, parser),
            _ => return Ok(false),
        };
        let Err(d) = done else { return Ok(true) };
        // One mistake, one message: what should have come is not missed again.
        for (name, _) in &x.items {
            if let Some(s) = self.symbols.find(&name.name) {
                let root = self.symbols.root(s);
                self.symbols.get_mut(root).assigned = true;
            }
        }
        self.fail(d.as_error())
    }

    fn load_listed(&mut self, x: &Exchange, span: Span, parser: &mut Parser) -> Loaded<()> {
        let items = wanted(&self.symbols, &x.items)?;
        let named = x.file.as_ref().map(|(f, s)| (f.to_string(), *s));
        let Some((file, at)) = named.or_else(|| self.input.clone()) else {
            return Err(no_file(span, "$gdxIn 'data.csv'"));
        };
        // `$load` alone lists a file in GAMS; there is nothing to do.
        if items.is_empty() {
            return Ok(());
        }
        let request = Request {
            file: &file_to_load(parser.map(), &file),
            at,
            items: &items,
            point: false,
            span,
        };
        let mut read = |name: &str, at| parser.read(name, at);
        load(&mut self.symbols, &mut self.store, &request, &mut read)
    }

    /// `$unload`: what it lists is written at the next `$gdxOut`; alone it lists everything.
    fn unload_listed(&mut self, x: &Exchange, span: Span) -> Loaded<()> {
        let mut items = wanted(&self.symbols, &x.items)?;
        if items.is_empty() {
            items = everything(&self.symbols, span);
        }
        match (&mut self.output, &x.file) {
            (output, Some((file, at))) => *output = Some((file.to_string(), *at, items)),
            (Some((_, _, listed)), None) => listed.extend(items),
            (None, None) => return Err(no_file(span, "$gdxOut 'results.json'")),
        }
        Ok(())
    }

    /// Keeps what `$unload` collected: the run writes it, and what follows may load it.
    pub(super) fn finish_unload(&mut self, parser: &mut Parser) -> Loaded<()> {
        let Some((file, span, items)) = self.output.take().filter(|o| !o.2.is_empty()) else {
            return Ok(());
        };
        let (files, warning) = unload(&self.symbols, &mut self.store, &file, &items, span)?;
        warning.into_iter().for_each(|d| self.report(d));
        for (name, text) in files {
            parser.remember(&name, text);
        }
        Ok(())
    }
}

/// A load or unload without a file.
pub fn no_file(span: Span, write: &str) -> Box<Diagnostic> {
    Box::new(
        Diagnostic::execution("E0475", span, "no file is named")
            .label("which file?")
            .help(format!("write `{write}` before")),
    )
}

/// Whether a symbol can be in a file.
pub fn has_data(kind: &SymbolKind) -> bool {
    !matches!(
        kind,
        SymbolKind::Model(_) | SymbolKind::File(_) | SymbolKind::Acronym(_) | SymbolKind::Figure(_)
    )
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
