//! GDX files: from the symbols of a file to those of the program, and back.

use super::records::{Loading, Records};
use super::{ATTRIBUTES, Outcome, Part, Request, Wanted, missing, write as tables};
use crate::check::node::EquationDef;
use crate::check::symbols::{
    DomainPosition, Store, Symbol, SymbolKind, Symbols, UNIVERSE, attribute,
};
use crate::data::universe::Label;
use crate::data::value::{EPS, NA, UNDF, acronym, as_acronym, is_eps, is_na};
use crate::diag::Diagnostic;
use crate::gdx::{self, Contents, Domain, Error, File, Kind, Value};
use crate::source::Span;
use crate::syntax::ast::{Relation, VariableKind};
use rustc_hash::{FxHashMap, FxHashSet};

/// Opens a file.
fn open<'a>(file: &str, bytes: &'a [u8], at: Span) -> Outcome<File<'a>> {
    File::open(bytes).map_err(|e| damaged(file, at, &e))
}

fn damaged(file: &str, at: Span, e: &Error) -> Box<Diagnostic> {
    let d = Diagnostic::execution("E0478", at);
    let d = d.says(format!("the GDX file `{file}` cannot be read: {e}"));
    Box::new(d.label("nothing was loaded"))
}

/// Whether a symbol of a file can be loaded into one of the program.
fn same_kind(inside: Kind, symbol: &SymbolKind) -> bool {
    match inside {
        Kind::Set { .. } | Kind::Alias(_) => {
            matches!(symbol, SymbolKind::Set { .. } | SymbolKind::Alias(_))
        }
        Kind::Parameter => matches!(symbol, SymbolKind::Parameter { .. }),
        Kind::Variable(_) => matches!(symbol, SymbolKind::Variable(_)),
        Kind::Equation(_) => matches!(symbol, SymbolKind::Equation(_)),
    }
}

/// Names in a file that fit symbols of the program.
pub(super) fn names(file: &str, bytes: &[u8], at: Span, symbols: &Symbols) -> Outcome<Vec<String>> {
    let gdx = open(file, bytes, at)?;
    let fits = |s: &&gdx::Symbol| {
        symbols.find(&s.name).is_some_and(|id| {
            let symbol = symbols.get(id);
            same_kind(s.kind, &symbol.kind)
                && !matches!(symbol.kind, SymbolKind::Alias(_))
                && symbol.dim() == s.domain.len()
        })
    };
    let found = gdx.symbols.iter().filter(fits);
    Ok(found.map(|s| s.name.clone()).collect())
}

/// A symbol that was declared without index positions takes those of the file.
pub(super) fn shape(
    file: &str,
    bytes: &[u8],
    items: &[Wanted],
    symbols: &mut Symbols,
    store: &mut Store,
    request: &Request<'_>,
) -> Outcome<()> {
    let is_open = |w: &&Wanted| w.part == Part::Whole && symbols.get(w.symbol).open;
    let items: Vec<&Wanted> = items.iter().filter(is_open).collect();
    if items.is_empty() {
        return Ok(());
    }
    let gdx = open(file, bytes, request.at)?;
    for w in items {
        let Some(inside) = gdx.find(&w.name).map(|n| &gdx.symbols[n]) else {
            continue;
        };
        let dim = inside.domain.len();
        let symbol = symbols.get_mut(w.symbol);
        if !same_kind(inside.kind, &symbol.kind) {
            continue;
        }
        symbol.open = false;
        if dim != symbol.dim() {
            store.reshape(symbol, dim);
        }
    }
    Ok(())
}

/// Reads symbols.
pub(super) fn read(
    file: &str,
    bytes: &[u8],
    at: Span,
    items: &[Wanted],
    loading: &mut Loading<'_>,
) -> Outcome<()> {
    let gdx = open(file, bytes, at)?;
    let mut reader = Reader {
        file,
        at,
        labels: vec![None; gdx.labels.len()],
        gdx: &gdx,
    };
    for w in items {
        let (records, columns) = reader.symbol(w, loading)?;
        loading.take(w, file, records, &columns)?;
    }
    Ok(())
}

/// A file, and the labels of the program that its labels became.
struct Reader<'a> {
    file: &'a str,
    at: Span,
    gdx: &'a File<'a>,
    labels: Vec<Option<Label>>,
}

impl Reader<'_> {
    fn wrong<T>(&self, w: &Wanted, what: &str, help: &str) -> Outcome<T> {
        let d = Diagnostic::execution("E0478", w.span)
            .says(format!("{}: `{}`: {what}", self.file, w.name))
            .label("nothing was loaded");
        Err(Box::new(match help {
            "" => d,
            help => d.help(help),
        }))
    }

    /// The records of a symbol, and the tables that their values go to.
    fn symbol(&mut self, w: &Wanted, loading: &mut Loading<'_>) -> Outcome<(Records, Vec<u32>)> {
        let symbol = loading.symbols.rooted(w.symbol);
        if w.name == "*" {
            return match symbol.is_set() && symbol.dim() == 1 {
                true => self.set(w, self.gdx.universe(), 1, loading),
                false => self.wrong(w, "all labels make a set of one index", ""),
            };
        }
        let Some(n) = self.gdx.find(&w.name) else {
            let there = self.gdx.symbols.iter().map(|s| s.name.clone());
            return Err(missing(self.file, w, &there.collect::<Vec<_>>()));
        };
        let inside = &self.gdx.symbols[n];
        let records = || {
            let read = self.gdx.records(n);
            read.map_err(|e| damaged(self.file, self.at, &e))
        };
        let dim = inside.domain.len();
        let position = match w.part {
            Part::Position(p) => Some(p),
            Part::LastPosition => self.position(inside, symbol, true),
            Part::FirstPosition => self.position(inside, symbol, false),
            _ => None,
        };
        if let Some(p) = position {
            if !symbol.is_set() || symbol.dim() != 1 || p >= dim {
                let what = format!("position {} of {dim} makes a set of one index", p + 1);
                return self.wrong(w, &what, "");
            }
            let text = format!("Domain loaded from {} position {}", w.name, p + 1);
            loading.text(w.symbol, &text);
            return self.projection(w, records()?, dim, p, loading);
        }
        if w.part == Part::Whole {
            loading.text(w.symbol, &inside.text);
        }
        let kind = inside.kind.name();
        let (own, own_dim) = (&symbol.name, symbol.dim());
        let other_dim = || {
            let inside = format!("it has {dim} index positions in the file");
            self.wrong(w, &format!("{inside}; `{own}` has {own_dim}"), "")
        };
        if w.into.is_some() {
            let is_record = matches!(inside.kind, Kind::Variable(_) | Kind::Equation(_));
            let part = match w.part {
                Part::Whole if inside.kind == Kind::Parameter => Some(Part::Whole),
                Part::Whole if is_record => Some(Part::Attribute(attribute::L)),
                Part::Attribute(a) if is_record && a < 5 => Some(w.part),
                _ => None,
            };
            return match part.filter(|_| symbol.has_attributes()) {
                None => {
                    let what = "an attribute is read from a parameter, or from another attribute";
                    self.wrong(w, what, "")
                }
                Some(_) if dim != symbol.dim() => other_dim(),
                Some(part) => self.values(w, records()?, inside, part, loading),
            };
        }
        match w.part {
            Part::LastPosition | Part::FirstPosition => {
                let what = format!("no index of this {kind} has the domain `{own}`");
                let help = format!("say which one: `{own} < {}.dim1`", w.name);
                self.wrong(w, &what, &help)
            }
            Part::Attribute(a)
                if inside.kind.width() < 5
                    || a >= 5
                    || symbol.has_attributes()
                    || symbol.is_set() =>
            {
                let what = "an attribute is read from a variable or equation, into a parameter";
                self.wrong(w, what, "")
            }
            Part::Whole if !same_kind(inside.kind, &symbol.kind) => {
                let own_kind = symbol.kind_name();
                let what = format!("it is a {kind} in the file; `{own}` is a {own_kind}");
                let help = match (inside.kind.width(), &symbol.kind) {
                    (5, SymbolKind::Parameter { .. }) => {
                        "name the attribute: `p = x.l`, `.m`, `.lo`, `.up` or `.scale`"
                    }
                    (_, SymbolKind::Set { .. }) => {
                        "the labels of an index position are read by `i < p.dim1`"
                    }
                    _ => "",
                };
                self.wrong(w, &what, help)
            }
            _ if dim != symbol.dim() => other_dim(),
            _ if symbol.is_set() => self.set(w, records()?, dim, loading),
            part => self.values(w, records()?, inside, part, loading),
        }
    }

    /// The position whose domain has the name of a set: the last one, or the first.
    fn position(&self, inside: &gdx::Symbol, set: &Symbol, last: bool) -> Option<usize> {
        let fits = |d: &Domain| match d {
            Domain::Universe => false,
            Domain::Set(n) => self.gdx.symbols[*n].name.eq_ignore_ascii_case(&set.name),
            Domain::Relaxed(name) => name.eq_ignore_ascii_case(&set.name),
        };
        match last {
            true => inside.domain.iter().rposition(fits),
            false => inside.domain.iter().position(fits),
        }
    }

    /// Records with labels of the program. Records with labels outside the domain are left out, with a
    /// warning, unless that is to be an error. Also says which records of the file these are.
    fn keys(
        &mut self,
        w: &Wanted,
        keys: &[u32],
        dim: usize,
        loading: &mut Loading<'_>,
    ) -> (Records, Vec<usize>) {
        let symbol = loading.symbols.rooted(w.symbol);
        let mut out = Records::default();
        if dim == 0 {
            out.places.push(1);
            return (out, vec![0]);
        }
        let sets: Vec<_> = symbol.domain.iter().map(domain_set).collect();
        let mut taken = Vec::new();
        let mut outside: Option<(Label, usize, String)> = None;
        let mut count = 0;
        // Membership is asked once per position and label of the file.
        let mut belongs: FxHashMap<(usize, u32), bool> = FxHashMap::default();
        for (r, key) in keys.chunks_exact(dim).enumerate() {
            if !loading.request.strict {
                let wrong = key.iter().enumerate().find(|&(p, &k)| {
                    let set = sets.get(p).copied().flatten();
                    if set.is_none() && loading.request.reading {
                        return false;
                    }
                    let known = belongs.entry((p, k)).or_insert_with(|| {
                        let label = loading.known(&self.gdx.labels[k as usize]);
                        label.is_some_and(|l| set.is_none_or(|s| loading.belongs(s, l)))
                    });
                    !*known
                });
                if let Some((p, &k)) = wrong {
                    count += 1;
                    let label = || self.gdx.labels[k as usize].clone();
                    outside.get_or_insert_with(|| (k, p, label()));
                    continue;
                }
            }
            taken.push(r);
            for &k in key {
                let l = &mut self.labels[k as usize];
                let name = &self.gdx.labels[k as usize];
                out.keys.push(*l.get_or_insert_with(|| loading.label(name)));
            }
            out.places.push(r + 1);
        }
        if let Some((_, p, label)) = outside {
            let set = symbol.domain.get(p).and_then(domain_set);
            let why = set.map_or("which the program does not have".into(), |s| {
                format!("which is not in `{}`", loading.symbols.get(s).name)
            });
            let (file, name) = (self.file, &w.name);
            let total = taken.len() + count;
            let d = Diagnostic::warning("E0479", w.span)
                .says(format!(
                    "{file}: {count} of the {total} records of `{name}` are left out"
                ))
                .label(format!("such as one with `{label}`, {why}"))
                .help("`$loadDC` and `execute_loadDC` make it an error");
            loading.warn(d);
        }
        (out, taken)
    }

    fn set(
        &mut self,
        w: &Wanted,
        records: gdx::Records,
        dim: usize,
        loading: &mut Loading<'_>,
    ) -> Outcome<(Records, Vec<u32>)> {
        let (mut out, taken) = self.keys(w, &records.keys, dim, loading);
        out.values = vec![1.0; taken.len()];
        for (n, r) in taken.into_iter().enumerate() {
            let text = self.gdx.texts.get(records.texts[r] as usize);
            if let Some(text) = text.filter(|t| !t.is_empty()) {
                let key = &out.keys[n * dim..(n + 1) * dim];
                out.texts.insert(key.into(), text.as_str().into());
            }
        }
        Ok((out, vec![0]))
    }

    /// The labels of an index position.
    fn projection(
        &mut self,
        w: &Wanted,
        records: gdx::Records,
        dim: usize,
        position: usize,
        loading: &mut Loading<'_>,
    ) -> Outcome<(Records, Vec<u32>)> {
        let mut seen = FxHashSet::default();
        let labels = records.keys.iter().skip(position).step_by(dim).copied();
        let keys: Vec<u32> = labels.filter(|k| seen.insert(*k)).collect();
        let (mut out, taken) = self.keys(w, &keys, 1, loading);
        out.values = vec![1.0; taken.len()];
        Ok((out, vec![0]))
    }

    fn values(
        &mut self,
        w: &Wanted,
        records: gdx::Records,
        inside: &gdx::Symbol,
        part: Part,
        loading: &mut Loading<'_>,
    ) -> Outcome<(Records, Vec<u32>)> {
        let (dim, width) = (inside.domain.len(), inside.kind.width());
        let (mut out, taken) = self.keys(w, &records.keys, dim, loading);
        // The file's order is level, marginal, lower and upper bound, scale: that of the tables.
        let columns = match part {
            Part::Attribute(a) => a as usize..a as usize + 1,
            _ => 0..width,
        };
        let known = &loading.store.acronyms;
        let acronyms = self.gdx.acronyms().map(|name| {
            let found = known.iter().position(|a| a.eq_ignore_ascii_case(name));
            found.map_or(UNDF, |n| acronym(n as u32))
        });
        let acronyms: Vec<f64> = acronyms.collect();
        for r in taken {
            for v in &records.values[r * width..][columns.clone()] {
                out.values.push(match *v {
                    Value::Number(x) => x,
                    Value::Undefined => UNDF,
                    Value::NotAvailable => NA,
                    Value::Eps => EPS,
                    Value::Acronym(n) => acronyms.get(n as usize).copied().unwrap_or(UNDF),
                });
            }
        }
        let mut named = self.gdx.acronyms().zip(&acronyms);
        let unknown = named.find(|a| a.1.is_nan() && as_acronym(*a.1).is_none());
        let undefined = out.values.iter().any(|v| v.to_bits() == UNDF.to_bits());
        if let Some((name, _)) = unknown.filter(|_| undefined) {
            let d = Diagnostic::warning("E0478", w.span)
                .says(format!(
                    "{}: the acronym `{name}` is not declared",
                    self.file
                ))
                .label("its records have the value UNDF")
                .help(format!("write `acronym {name};` before"));
            loading.warn(d);
        }
        let columns = match (w.into, part) {
            (Some(a), _) => vec![a],
            (None, Part::Attribute(_)) => vec![0],
            _ => (0..width as u32).collect(),
        };
        Ok((out, columns))
    }
}

fn domain_set(d: &DomainPosition) -> Option<crate::check::node::SymbolId> {
    match d {
        DomainPosition::Set(s) => Some(*s),
        _ => None,
    }
}

/// The bytes of a file with these symbols.
pub(super) fn write(
    symbols: &Symbols,
    store: &Store,
    equations: &[EquationDef],
    items: &[Wanted],
) -> Result<Vec<u8>, Error> {
    // Labels that are used, in the order of the universe.
    let data = |w: &Wanted| symbols.rooted(w.symbol);
    let is_alias = |w: &Wanted| {
        let root = symbols.root(w.symbol);
        let mut before = items.iter().take_while(|o| o.symbol != w.symbol);
        root != w.symbol && (root == UNIVERSE || before.any(|o| o.symbol == root))
    };
    let keys = items.iter().map(|w| match is_alias(w) {
        true => Vec::new(),
        false => tables::keys(store, data(w)),
    });
    let keys: Vec<Vec<Vec<Label>>> = keys.collect();
    let mut used: Vec<Label> = keys.iter().flatten().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let number: FxHashMap<Label, u32> = used.iter().zip(0..).map(|(l, n)| (*l, n)).collect();
    let mut contents = Contents {
        labels: used.iter().map(|l| store.universe.name(*l)).collect(),
        texts: vec![""],
        acronyms: store.acronyms.iter().map(|a| &**a).collect(),
        symbols: Vec::new(),
    };
    let mut texts: FxHashMap<&str, u32> = FxHashMap::from_iter([("", 0)]);
    let place = |set| {
        let same = |w: &Wanted| w.symbol == set;
        items.iter().position(same)
    };
    for (w, keys) in items.iter().zip(keys) {
        let symbol = symbols.get(w.symbol);
        let alias = is_alias(w);
        let domain = symbol.domain.iter().map(|d| match d {
            DomainPosition::Universe => Domain::Universe,
            // A set must stand before what runs over it.
            DomainPosition::Set(s) => match place(*s).filter(|n| *n < contents.symbols.len()) {
                Some(n) => Domain::Set(n),
                None => Domain::Relaxed(symbols.get(*s).name.to_string()),
            },
        });
        let head = gdx::Symbol {
            name: w.name.clone(),
            text: match alias {
                true => format!("Aliased with {}", data(w).name),
                false => symbol.text.to_string(),
            },
            kind: match alias {
                true => Kind::Alias(place(symbols.root(w.symbol))),
                false => kind(data(w), equations),
            },
            domain: domain.collect(),
        };
        let mut records = gdx::Records::default();
        if !alias {
            records.len = keys.len();
            for key in &keys {
                records.keys.extend(key.iter().map(|l| number[l]));
                if symbol.is_set() {
                    let text = store.element_text(symbol.table, key).unwrap_or("");
                    let n = *texts.entry(text).or_insert_with(|| {
                        contents.texts.push(text);
                        contents.texts.len() as u32 - 1
                    });
                    records.texts.push(n);
                }
                let width = head.kind.width() as u32;
                let values = (0..width).map(|a| store.table(symbol.table + a).get(key));
                records.values.extend(values.map(value));
            }
        }
        contents.symbols.push((head, records));
    }
    gdx::write(&contents)
}

fn value(v: f64) -> Value {
    match v {
        v if !v.is_nan() => Value::Number(v),
        v if is_eps(v) => Value::Eps,
        v if is_na(v) => Value::NotAvailable,
        v => as_acronym(v).map_or(Value::Undefined, Value::Acronym),
    }
}

/// Kind and type of a symbol, in GAMS's numbers.
fn kind(symbol: &Symbol, equations: &[EquationDef]) -> Kind {
    match symbol.kind {
        SymbolKind::Set { singleton } => Kind::Set { singleton },
        SymbolKind::Variable(kind) => Kind::Variable(match kind {
            VariableKind::Binary => 1,
            VariableKind::Integer => 2,
            VariableKind::Positive => 3,
            VariableKind::Negative => 4,
            VariableKind::Unstated | VariableKind::Free => 5,
            VariableKind::Sos1 => 6,
            VariableKind::Sos2 => 7,
            VariableKind::SemiContinuous => 8,
            VariableKind::SemiInteger => 9,
        }),
        SymbolKind::Equation(definition) => {
            let equation = definition.and_then(|d| equations.get(d));
            Kind::Equation(match equation.map(|e| e.relation) {
                Some(Relation::Equal) => 53,
                Some(Relation::Greater) => 54,
                Some(Relation::Less) => 55,
                Some(Relation::Free) | None => 56,
            })
        }
        _ => Kind::Parameter,
    }
}

const _: () = assert!(
    ATTRIBUTES[0].2 == attribute::L
        && ATTRIBUTES[1].2 == attribute::M
        && ATTRIBUTES[2].2 == attribute::LO
        && ATTRIBUTES[3].2 == attribute::UP
        && ATTRIBUTES[4].2 == attribute::SCALE
);
