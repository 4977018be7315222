//! Data that a model exchanges in open formats: `$load` and `$unload` while the text is read, so that what
//! follows sees the data, `execute_load` and `execute_unload` in the run.
//!
//! The file's ending says the format: `.csv` (one symbol, or many with a column `symbol`), `.json`; a
//! name that ends in `/` is a folder with a CSV file per symbol; everything else is GDX, with the ending `.gdx` where the
//! name has none. `docs/data-exchange.md` describes them.
//!
//! Invariant: a load changes all of its symbols or, with a diagnostic, nothing.

mod csv;
mod gdx;
mod json;
mod records;
mod write;

use super::data::second_data;
use super::node::{EquationDef, SymbolId};
use super::symbols::{DomainPosition, Store, SymbolKind, Symbols, attribute};
use super::{Checked, Compiler};
use crate::data::value::{EPS, NA, UNDF};
use crate::diag::{Diagnostic, nearest};
use crate::source::{Outcome, Span};
use crate::syntax::Parser;
use crate::syntax::ast::{Exchange, ExchangeBy, ExchangeItem, Ident};
use records::Loading;

/// Files to write: names and bytes.
pub type Files = Vec<(String, Vec<u8>)>;

/// The bytes of a file.
pub type Read<'a> = &'a mut dyn FnMut(&str, Span) -> Outcome<Vec<u8>>;

/// A symbol, and its name in the file.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// The symbol.
    pub symbol: SymbolId,
    /// Its name in the file.
    pub name: String,
    /// Where it is asked for.
    pub span: Span,
    /// What of it is read.
    pub part: Part,
    /// The attribute of the symbol that it becomes, by its place behind the first table: `x.l = p`.
    pub into: Option<u32>,
}

impl Wanted {
    /// All of a symbol.
    pub fn whole(symbol: SymbolId, name: &str, span: Span) -> Self {
        Self {
            symbol,
            name: name.to_string(),
            span,
            part: Part::Whole,
            into: None,
        }
    }
}

/// What of a symbol in a file is read.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Part {
    /// All of it.
    Whole,
    /// An attribute, by its place behind the first table, into a parameter or an attribute.
    Attribute(u32),
    /// The labels of an index position, into a set.
    Position(usize),
    /// The labels of the last position whose domain has the name of the set.
    LastPosition,
    /// The labels of the first position whose domain has the name of the set.
    FirstPosition,
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
    /// GAMS's binary files.
    Gdx,
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
pub fn wanted(symbols: &Symbols, items: &[ExchangeItem]) -> Outcome<Vec<Wanted>> {
    let mut out = Vec::new();
    for item in items {
        let Ident { name, span } = &item.name;
        let refused = Diagnostic::execution("E0475", *span);
        let Some(symbol) = symbols.find(name) else {
            return refused.says(format!("`{name}` is not known")).refuse();
        };
        let own = symbols.get(symbol);
        if !has_data(&own.kind) {
            let kind = own.a_kind();
            return refused
                .says(format!("`{name}` is {kind}; it has no data to exchange"))
                .label("a set, parameter, variable or equation is expected")
                .refuse();
        }
        let shown = item.other.as_ref().map_or(&own.name, |o| &o.name);
        out.push(Wanted {
            part: part_of(item)?,
            into: into_of(item)?,
            ..Wanted::whole(symbol, shown, *span)
        });
    }
    Ok(out)
}

/// The attribute that an item fills.
fn into_of(item: &ExchangeItem) -> Outcome<Option<u32>> {
    let Some(into) = &item.into else {
        return Ok(None);
    };
    match attribute_offset(&into.name) {
        Some(a) if item.by == ExchangeBy::Name => Ok(Some(a)),
        _ => Err(no_part(into)),
    }
}

/// What of a symbol an item asks for.
fn part_of(item: &ExchangeItem) -> Outcome<Part> {
    let own = item.into.as_ref().filter(|_| item.other.is_none());
    let Some(suffix) = item.suffix.as_ref().or(own) else {
        return Ok(match item.by {
            ExchangeBy::Name => Part::Whole,
            ExchangeBy::LastPosition => Part::LastPosition,
            ExchangeBy::FirstPosition => Part::FirstPosition,
        });
    };
    let lower = suffix.name.to_ascii_lowercase();
    let position = lower.strip_prefix("dim").and_then(|n| n.parse().ok());
    let found = match (item.by, position) {
        (ExchangeBy::Name, _) => attribute_offset(&lower).map(Part::Attribute),
        (_, Some(p @ 1..=20)) => Some(Part::Position(p - 1)),
        _ => None,
    };
    found.ok_or_else(|| no_part(suffix))
}

fn no_part(suffix: &Ident) -> Box<Diagnostic> {
    let message = format!("`.{}` is not a part of a symbol in a file", suffix.name);
    Box::new(
        Diagnostic::execution("E0475", suffix.span)
            .says(message)
            .help("`p = x.l` reads an attribute into a parameter, `i < p.dim1` the labels of a position into a set"),
    )
}

/// The format of a file, by the ending of its name.
fn format_of(file: &str) -> Kind {
    if file.ends_with('/') {
        return Kind::Folder;
    }
    let ending = std::path::Path::new(file).extension();
    let ending = ending.map(|e| e.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("csv" | "tsv" | "txt") => Kind::Csv,
        Some("json") => Kind::Json,
        _ => Kind::Gdx,
    }
}

/// The name of a file: a GDX file has an ending.
fn full_name(file: &str) -> String {
    let bare = format_of(file) == Kind::Gdx && std::path::Path::new(file).extension().is_none();
    format!("{file}{}", if bare { ".gdx" } else { "" })
}

/// The symbols of the program that a file has.
fn declared_in(
    kind: Kind,
    file: &str,
    bytes: &[u8],
    symbols: &Symbols,
    point: bool,
    span: Span,
) -> Outcome<Vec<Wanted>> {
    let names = match kind {
        Kind::Gdx => gdx::names(file, bytes, span, symbols)?,
        Kind::Json => json::names(text_of(file, bytes, span)?),
        _ => csv::names(text_of(file, bytes, span)?),
    };
    let mut out: Vec<Wanted> = Vec::new();
    for n in &names {
        let Some(symbol) = symbols.find(n) else {
            continue;
        };
        let fits = match point {
            true => symbols.get(symbol).has_attributes(),
            false => has_data(&symbols.get(symbol).kind),
        };
        if fits && !out.iter().any(|w| w.symbol == symbol) {
            out.push(Wanted::whole(symbol, n, span));
        }
    }
    Ok(out)
}

/// What is to be loaded.
pub struct Request<'a> {
    /// Name of the file.
    pub file: &'a str,
    /// Where the file is named.
    pub at: Span,
    /// The symbols; none for all that the file has.
    pub items: &'a [Wanted],
    /// Levels and marginals only, of the records that the file has.
    pub point: bool,
    /// A label outside the domain is an error: its record is not left out.
    pub strict: bool,
    /// What a symbol held stays where the file has no record.
    pub merge: bool,
    /// The text is being read: symbols without an explanatory text take that of the file, and its labels are new ones.
    pub reading: bool,
    /// Place of the statement.
    pub span: Span,
}

/// Reads symbols from a file, or a folder of files; warnings.
pub fn load(
    symbols: &mut Symbols,
    store: &mut Store,
    request: &Request<'_>,
    read: Read<'_>,
) -> Outcome<Vec<Diagnostic>> {
    let kind = format_of(request.file);
    let file = full_name(request.file);
    let is_part = |w: &&Wanted| w.part != Part::Whole || w.into.is_some();
    let part = request.items.iter().find(is_part);
    if let Some(w) = part.filter(|_| kind != Kind::Gdx) {
        return Diagnostic::execution("E0475", w.span)
            .says(format!(
                "a part of `{}` is read from GDX files only",
                w.name
            ))
            .help("read the whole symbol, and take its part in an assignment")
            .refuse();
    }
    let mut files = Vec::new();
    if kind == Kind::Folder {
        for w in request.items {
            let name = format!("{file}{}.csv", w.name);
            let bytes = read(&name, request.at)?;
            files.push((name, bytes, vec![w.clone()]));
        }
    } else {
        let bytes = read(&file, request.at)?;
        files.push((file, bytes, request.items.to_vec()));
    }
    if let (Kind::Gdx, [(name, bytes, items)]) = (kind, files.as_slice()) {
        gdx::shape(name, bytes, items, symbols, store, request)?;
    }
    let mut loading = Loading::new(symbols, store, request);
    for (name, bytes, mut items) in files {
        let text = match kind {
            Kind::Gdx => "",
            _ => text_of(&name, &bytes, request.at)?,
        };
        if items.is_empty() {
            items = declared_in(kind, &name, &bytes, symbols, request.point, request.span)?;
        }
        // What is found at an index position first, then sets: they may be the domains of the others.
        items.sort_by_key(|w| {
            let found = matches!(w.part, Part::Position(_));
            (!found, !symbols.get(w.symbol).is_set())
        });
        match kind {
            Kind::Gdx => gdx::read(&name, &bytes, request.at, &items, &mut loading)?,
            Kind::Json => json::read(&name, text, &items, &mut loading)?,
            _ => csv::read(&name, text, &items, &mut loading)?,
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
    for (symbol, text) in loaded.explanations {
        let symbol = symbols.get_mut(symbol);
        if request.reading && symbol.text.is_empty() {
            symbol.text = text;
        }
    }
    Ok(loaded.warnings)
}

/// A text file's text.
fn text_of<'a>(file: &str, bytes: &'a [u8], at: Span) -> Outcome<&'a str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.strip_prefix('\u{feff}').unwrap_or(text)),
        Err(e) => Diagnostic::execution("E0478", at)
            .says(format!("{file}: byte {} is not UTF-8", e.valid_up_to() + 1))
            .help("save the file as UTF-8")
            .refuse(),
    }
}

/// The files that hold these symbols (all, if none is named): names and bytes.
pub fn unload(
    symbols: &Symbols,
    store: &mut Store,
    equations: &[EquationDef],
    file: &str,
    items: &[Wanted],
    span: Span,
) -> Outcome<Files> {
    let kind = format_of(file);
    let everything = everything(symbols, kind, span);
    let items = if items.is_empty() { &everything } else { items };
    let file = full_name(file);
    write::tidy(symbols, store, items);
    let writer = write::Writer { symbols, store };
    let one = |bytes| Ok(vec![(file.clone(), bytes)]);
    match kind {
        Kind::Csv => one(writer.csv(items).into_bytes()),
        Kind::Json => one(writer.json(items).into_bytes()),
        Kind::Folder => {
            let text = |w: &Wanted| writer.csv(std::slice::from_ref(w)).into_bytes();
            let named = |w: &Wanted| (format!("{file}{}.csv", w.name), text(w));
            Ok(items.iter().map(named).collect())
        }
        Kind::Gdx => one(gdx::write(symbols, store, equations, items).map_err(|e| {
            let d = Diagnostic::execution("E0470", span)
                .says(format!("`{file}` cannot be written: {e}"));
            Box::new(d.label("nothing was written"))
        })?),
    }
}

/// All symbols with data, in order of declaration.
fn everything(symbols: &Symbols, kind: Kind, span: Span) -> Vec<Wanted> {
    let aliases = kind == Kind::Gdx;
    let listed = |k: &SymbolKind| has_data(k) && (aliases || !matches!(k, SymbolKind::Alias(_)));
    let all = symbols.iter().skip(1).filter(|(_, s)| listed(&s.kind));
    all.map(|(symbol, s)| Wanted::whole(symbol, &s.name, span))
        .collect()
}

impl Compiler {
    /// `$gdxIn`, `$load`, `$gdxOut` and `$unload` act while the text is read. False if it is another statement.
    pub(super) fn exchange_now(
        &mut self,
        x: &Exchange,
        span: Span,
        parser: &mut Parser,
    ) -> Checked<bool> {
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
            k if k.starts_with("load") || k.starts_with("gdxload") => {
                self.load_listed(x, span, parser)
            }
            _ => return Ok(false),
        };
        let Err(d) = done else { return Ok(true) };
        // One mistake, one message: what should have come is not missed again.
        for item in &x.items {
            if let Some(s) = self.symbols.find(&item.name.name) {
                let root = self.symbols.root(s);
                self.symbols.get_mut(root).assigned = true;
                self.not_loaded.insert(root);
            }
        }
        d.as_error().fail(self)
    }

    fn load_listed(&mut self, x: &Exchange, span: Span, parser: &mut Parser) -> Outcome<()> {
        let mut items = wanted(&self.symbols, &x.items)?;
        items.retain(|w| !self.inputs.has(self.symbols.root(w.symbol)));
        let named = x.file.as_ref().map(|(f, s)| (f.to_string(), *s));
        let Some((file, at)) = named.or_else(|| self.input.clone()) else {
            return Err(no_file(span, "$gdxIn data.gdx"));
        };
        // `loadDC`, `loadM`, `loadDCR` …: what comes after `load`.
        let how = x.keyword.name.rsplit("load").next().unwrap_or_default();
        let how = match how {
            "all" => {
                let (kind, file) = (format_of(&file), full_name(&file));
                let bytes = parser.read(&file, at)?;
                items = declared_in(kind, &file, &bytes, &self.symbols, false, at)?;
                ""
            }
            how => how,
        };
        // `$load` alone lists a file in GAMS; there is nothing to do.
        if items.is_empty() {
            return Ok(());
        }
        self.defined_domains(&file, &mut items);
        let merges = self.merges(how, &items, span)?;
        let request = Request {
            file: &file,
            at,
            items: &items,
            point: false,
            strict: how.starts_with("dc"),
            merge: merges,
            reading: true,
            span,
        };
        let mut read = |name: &str, at| parser.read(name, at);
        let warnings = load(&mut self.symbols, &mut self.store, &request, &mut read)?;
        warnings.into_iter().for_each(|d| d.report(self));
        Ok(())
    }

    /// Whether a load adds to what its symbols hold: `loadM`, or `$onMulti`. An error for one that has data or is
    /// assigned, unless these or `loadR`, `$onMultiR` allow it.
    fn merges(&self, how: &str, items: &[Wanted], span: Span) -> Outcome<bool> {
        let modes = self.modes.at(span);
        let plain = matches!(how, "" | "dc");
        if plain && !modes.multi {
            for (n, w) in items.iter().enumerate() {
                let root = self.symbols.root(w.symbol);
                let symbol = self.symbols.get(root);
                let is_same = |v: &Wanted| self.symbols.root(v.symbol) == root;
                let again = items[..n].iter().any(is_same);
                let filled = symbol.has_data || symbol.assigned && !self.not_loaded.contains(&root);
                if again || filled {
                    return Err(Box::new(second_data(&symbol.name, w.span, symbol.declared)));
                }
            }
        }
        Ok(matches!(how, "m" | "dcm") || plain && modes.multi && !modes.multi_replace)
    }

    /// `parameter p(i<)`: with `p`, a GDX file also brings the labels of `i`.
    fn defined_domains(&self, file: &str, items: &mut Vec<Wanted>) {
        if format_of(file) != Kind::Gdx {
            return;
        }
        let mut more = Vec::new();
        for w in items.iter().filter(|w| w.part == Part::Whole) {
            let domain = &self.symbols.get(w.symbol).domain;
            for (p, d) in domain.iter().enumerate() {
                if let DomainPosition::Set(set) = d
                    && self.defines(w.symbol, p)
                {
                    let part = Part::Position(p);
                    let symbol = *set;
                    more.push(Wanted {
                        symbol,
                        part,
                        ..w.clone()
                    });
                }
            }
        }
        items.extend(more);
    }

    /// `$unload`: what it lists is written at the next `$gdxOut`; alone it lists everything.
    fn unload_listed(&mut self, x: &Exchange, span: Span) -> Outcome<()> {
        let mut items = wanted(&self.symbols, &x.items)?;
        if items.is_empty() {
            let file = x.file.as_ref().map(|(f, _)| &**f);
            let file = file.or(self.output.as_ref().map(|(f, ..)| f.as_str()));
            items = everything(&self.symbols, format_of(file.unwrap_or_default()), span);
        }
        match (&mut self.output, &x.file) {
            (output, Some((file, at))) => *output = Some((file.to_string(), *at, items)),
            (Some((_, _, listed)), None) => listed.extend(items),
            (None, None) => return Err(no_file(span, "$gdxOut results.gdx")),
        }
        Ok(())
    }

    /// Keeps what `$unload` collected: the run writes it, and what follows may load it.
    pub(super) fn finish_unload(&mut self, parser: &mut Parser) -> Outcome<()> {
        let Some((file, span, items)) = self.output.take().filter(|o| !o.2.is_empty()) else {
            return Ok(());
        };
        self.asked_for_data.set(true);
        let store = &mut self.store;
        let files = unload(&self.symbols, store, &self.equations, &file, &items, span)?;
        for (name, bytes) in files {
            parser.remember(&name, bytes, span);
        }
        Ok(())
    }
}

/// A load or unload without a file.
pub fn no_file(span: Span, write: &str) -> Box<Diagnostic> {
    Box::new(
        Diagnostic::execution("E0475", span)
            .says("no file is named")
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
            let mut names = acronyms.iter();
            let n = names.position(|a| a.eq_ignore_ascii_case(lower))?;
            crate::data::value::acronym(n as u32)
        }
    })
}

/// No symbol of that name in the file.
fn missing(file: &str, w: &Wanted, there: &[String]) -> Box<Diagnostic> {
    let d = Diagnostic::execution("E0477", w.span)
        .says(format!("the file `{file}` has no symbol `{}`", w.name));
    Box::new(match nearest(&w.name, there.iter().map(String::as_str)) {
        Some(n) => d.help(format!("did you mean `{n}`? write `{} = {n}`", w.name)),
        None if there.is_empty() => d.help("the file holds no symbols"),
        None => d.help(format!("it has: {}", there.join(", "))),
    })
}
