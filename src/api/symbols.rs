//! The symbols of a run and their data, by name and labels.

use super::{Error, Labels};
use crate::check::symbols::{self as checked, Store, Symbols, attribute};
use crate::data::input::Keys;
use crate::data::sort::sort_tuples;
use crate::data::universe::{Label, Universe};
use crate::data::value;
use crate::diag::nearest;
use rustc_hash::FxHashMap;
use std::fmt;

/// Labels that are looked at for a similar one.
const SIMILAR_AMONG: u32 = 10_000;

/// What a symbol is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum SymbolKind {
    /// A set, or another name of one.
    Set,
    /// A parameter, or a scalar.
    Parameter,
    /// A variable.
    Variable,
    /// An equation.
    Equation,
    /// A model.
    Model,
    /// A file for `put`.
    File,
    /// An acronym.
    Acronym,
    /// A figure.
    Figure,
}

impl fmt::Display for SymbolKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&format!("{self:?}").to_lowercase())
    }
}

/// A value that is not an ordinary number.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum Special<'a> {
    /// `eps`: a zero that is stored.
    Eps,
    /// `na`: not available.
    NotAvailable,
    /// `undf`: the result of an error.
    Undefined,
    /// An acronym.
    Acronym(&'a str),
}

/// Records in label order: `dim` labels and a value each.
#[derive(Debug, Default)]
struct Column {
    default: f64,
    keys: Vec<Label>,
    values: Vec<f64>,
}

impl Column {
    fn get(&self, key: &[Label]) -> f64 {
        let dim = key.len();
        let n = self.values.len();
        let at = |r: usize| &self.keys[r * dim..(r + 1) * dim];
        let (mut lo, mut hi) = (0, n);
        while lo < hi {
            let mid = lo.midpoint(hi);
            if at(mid) < key {
                lo = mid + 1;
            } else {
                hi = mid;
            }
        }
        match lo < n && at(lo) == key {
            true => self.values[lo],
            false => self.default,
        }
    }
}

#[derive(Debug)]
struct Entry {
    name: String,
    kind: SymbolKind,
    domain: Vec<String>,
    text: String,
    /// The symbol whose data these are: of an alias the set, else itself.
    root: usize,
    /// One column of sets and parameters; level, marginal, lower and upper bound of variables and equations.
    columns: Vec<Column>,
    /// Texts of a set's members.
    texts: FxHashMap<Box<[Label]>, Box<str>>,
}

/// All symbols of a run with their data.
#[derive(Debug, Default)]
pub(super) struct Data {
    universe: Universe,
    acronyms: Vec<Box<str>>,
    entries: Vec<Entry>,
    index: FxHashMap<String, usize>,
}

/// What is kept of variables and equations, in the order of their columns.
const RECORD: [u32; 4] = [attribute::L, attribute::M, attribute::LO, attribute::UP];
const LEVEL: usize = 0;
const MARGINAL: usize = 1;
const LOWER: usize = 2;
const UPPER: usize = 3;

impl Data {
    pub(super) fn new(symbols: &Symbols, mut store: Store) -> Self {
        let mut data = Self::default();
        for (id, s) in symbols.iter() {
            use checked::SymbolKind as K;
            let (kind, offsets): (_, &[u32]) = match &s.kind {
                K::Set { .. } => (SymbolKind::Set, &[0]),
                K::Alias(_) => (SymbolKind::Set, &[]),
                K::Parameter { .. } => (SymbolKind::Parameter, &[0]),
                K::Variable(_) => (SymbolKind::Variable, &RECORD),
                K::Equation(_) => (SymbolKind::Equation, &RECORD),
                K::Model(_) => (SymbolKind::Model, &[]),
                K::File(_) => (SymbolKind::File, &[]),
                K::Acronym(_) => (SymbolKind::Acronym, &[]),
                K::Figure(_) => (SymbolKind::Figure, &[]),
            };
            let mut column = |o: &u32| {
                let table = std::mem::take(&mut store.tables[(s.table + o) as usize]);
                let default = table.default_value();
                let (keys, values) = table.into_records();
                Column {
                    default,
                    keys,
                    values,
                }
            };
            let columns = offsets.iter().map(&mut column).collect();
            let texts = match kind {
                SymbolKind::Set if !offsets.is_empty() => store.texts.remove(&s.table),
                _ => None,
            };
            data.index.insert(s.name.to_lowercase(), data.entries.len());
            data.entries.push(Entry {
                name: s.name.to_string(),
                kind,
                domain: symbols.domain_names(s),
                text: s.text.to_string(),
                root: symbols.root(id) as usize,
                columns,
                texts: texts.unwrap_or_default(),
            });
        }
        data.universe = store.universe;
        data.acronyms = store.acronyms;
        data
    }

    /// All symbols in order of declaration, without the universe.
    pub(super) fn symbols(&self) -> impl Iterator<Item = Symbol<'_>> {
        self.entries
            .iter()
            .skip(1)
            .map(|entry| Symbol { data: self, entry })
    }

    pub(super) fn symbol(&self, name: &str) -> Result<Symbol<'_>, Error> {
        match self.index.get(&name.to_lowercase()) {
            Some(&n) => Ok(Symbol {
                data: self,
                entry: &self.entries[n],
            }),
            None => {
                let known = self.entries.iter().skip(1).map(|e| &*e.name);
                Err(Error::UnknownSymbol {
                    name: name.into(),
                    similar: nearest(name, known).map(Into::into),
                })
            }
        }
    }

    fn special(&self, v: f64) -> Option<Special<'_>> {
        match () {
            () if !v.is_nan() => None,
            () if value::is_eps(v) => Some(Special::Eps),
            () if value::is_na(v) => Some(Special::NotAvailable),
            () => match value::as_acronym(v).and_then(|n| self.acronyms.get(n as usize)) {
                Some(name) => Some(Special::Acronym(name)),
                None => Some(Special::Undefined),
            },
        }
    }

    /// Tuples of labels by position; at each, labels in their order.
    fn keys(&self, tuples: &[Label], dim: usize) -> Keys {
        let mut labels = Vec::with_capacity(dim);
        let mut codes = Vec::with_capacity(dim);
        for p in 0..dim {
            let column = || tuples.iter().skip(p).step_by(dim);
            let mut place = vec![u32::MAX; self.universe.len()];
            column().for_each(|&l| place[l as usize] = 0);
            let mut list = Vec::new();
            for (l, place) in place.iter_mut().enumerate().filter(|(_, p)| **p == 0) {
                *place = list.len() as u32;
                list.push(self.universe.name(l as Label).to_string());
            }
            codes.push(column().map(|&l| place[l as usize]).collect());
            labels.push(list);
        }
        Keys::new(labels, codes).unwrap_or_default()
    }

    fn names(&self, key: &[Label]) -> Vec<&str> {
        key.iter().map(|&l| self.universe.name(l)).collect()
    }
}

/// A symbol of a run, and its data.
#[derive(Clone, Copy, Debug)]
pub struct Symbol<'a> {
    data: &'a Data,
    entry: &'a Entry,
}

impl<'a> Symbol<'a> {
    /// Its name as first spelled.
    pub fn name(&self) -> &'a str {
        &self.entry.name
    }

    /// What it is.
    pub fn kind(&self) -> SymbolKind {
        self.entry.kind
    }

    /// Its explanatory text, perhaps empty.
    pub fn text(&self) -> &'a str {
        &self.entry.text
    }

    /// Names of its index sets; `*` for any label.
    pub fn domain(&self) -> &'a [String] {
        &self.entry.domain
    }

    /// Number of indices.
    pub fn dimension(&self) -> usize {
        self.entry.domain.len()
    }

    /// For an alias, the set that it names.
    pub fn alias_of(&self) -> Option<&'a str> {
        let root = self.root();
        (!std::ptr::eq(root, self.entry)).then_some(&*root.name)
    }

    fn root(&self) -> &'a Entry {
        &self.data.entries[self.entry.root]
    }

    fn wrong_kind(&self, wanted: &'static str) -> Error {
        Error::WrongKind {
            name: self.entry.name.clone(),
            kind: self.entry.kind,
            wanted,
        }
    }

    fn column(
        &self,
        n: usize,
        has: &[SymbolKind],
        wanted: &'static str,
    ) -> Result<&'a Column, Error> {
        match has.contains(&self.entry.kind) {
            true => Ok(&self.root().columns[n]),
            false => Err(self.wrong_kind(wanted)),
        }
    }

    fn at(&self, column: &Column, labels: impl Labels) -> Result<f64, Error> {
        let labels = labels.labels();
        if labels.len() != self.dimension() {
            return Err(Error::WrongDimension {
                name: self.entry.name.clone(),
                expected: self.dimension(),
                given: labels.len(),
            });
        }
        let mut key = Vec::with_capacity(labels.len());
        for label in labels {
            let universe = &self.data.universe;
            match universe.get(&label) {
                Some(l) => key.push(l),
                None => {
                    let count = (universe.len() as u32).min(SIMILAR_AMONG);
                    let known = (0..count).map(|l| universe.name(l));
                    return Err(Error::UnknownLabel {
                        similar: nearest(&label, known).map(Into::into),
                        label,
                    });
                }
            }
        }
        Ok(value::number(column.get(&key)))
    }

    /// A value of a parameter; of a set 1 for a member, 0 else. `eps` is 0; `na` and `undf` are NaN.
    ///
    /// # Errors
    /// If it is another kind of symbol, or the labels do not fit.
    pub fn value(&self, labels: impl Labels) -> Result<f64, Error> {
        let has = [SymbolKind::Parameter, SymbolKind::Set];
        self.at(self.column(0, &has, "value")?, labels)
    }

    fn attribute(&self, n: usize, wanted: &'static str, labels: impl Labels) -> Result<f64, Error> {
        let has = [SymbolKind::Variable, SymbolKind::Equation];
        self.at(self.column(n, &has, wanted)?, labels)
    }

    /// Level of a variable, or of an equation's left side.
    ///
    /// # Errors
    /// If it is another kind of symbol, or the labels do not fit. So for the next three.
    pub fn level(&self, labels: impl Labels) -> Result<f64, Error> {
        self.attribute(LEVEL, "level", labels)
    }

    /// Marginal: reduced cost of a variable, dual value of an equation.
    pub fn marginal(&self, labels: impl Labels) -> Result<f64, Error> {
        self.attribute(MARGINAL, "marginal", labels)
    }

    /// Lower bound.
    pub fn lower(&self, labels: impl Labels) -> Result<f64, Error> {
        self.attribute(LOWER, "lower bound", labels)
    }

    /// Upper bound.
    pub fn upper(&self, labels: impl Labels) -> Result<f64, Error> {
        self.attribute(UPPER, "upper bound", labels)
    }

    /// Level, marginal, lower and upper bound of a record of a variable or an equation that is not stored.
    ///
    /// # Errors
    /// If it is another kind of symbol.
    pub fn defaults(&self) -> Result<[f64; 4], Error> {
        let has = [SymbolKind::Variable, SymbolKind::Equation];
        let mut out = [0.0; 4];
        for (n, v) in out.iter_mut().enumerate() {
            *v = value::number(self.column(n, &has, "level")?.default);
        }
        Ok(out)
    }

    /// The records of a set or a parameter in label order; of other symbols there are none.
    pub fn records(&self) -> Records<'a> {
        let has = matches!(self.entry.kind, SymbolKind::Set | SymbolKind::Parameter);
        Records {
            data: self.data,
            root: self.root(),
            next: 0,
            end: if has {
                self.root().columns[0].values.len()
            } else {
                0
            },
        }
    }

    /// All records as columns; a symbol without indices has one. Other symbols than sets, parameters, variables and equations
    /// have none.
    pub fn columns(&self) -> Columns {
        let dim = self.dimension();
        let root = self.root();
        let flat = |columns: &[Column]| -> Vec<Label> {
            let mut merged = columns[0].keys.clone();
            for c in &columns[1..] {
                if c.keys != merged {
                    merged.extend(&c.keys);
                }
            }
            sort_tuples(merged, dim, true)
        };
        let read = |c: &Column, keys: &[Label]| -> Vec<f64> {
            let numbers = |values: &[f64]| values.iter().map(|&v| value::number(v)).collect();
            if c.keys.len() == keys.len() {
                return numbers(&c.values);
            }
            let mut r = 0;
            let next = keys.chunks_exact(dim).map(|key| {
                let here = c.keys.get(r * dim..(r + 1) * dim) == Some(key);
                r += usize::from(here);
                if here { c.values[r - 1] } else { c.default }
            });
            numbers(&next.collect::<Vec<f64>>())
        };
        let names: &[&str] = match self.entry.kind {
            SymbolKind::Variable | SymbolKind::Equation => &["level", "marginal", "lower", "upper"],
            SymbolKind::Parameter => &["value"],
            SymbolKind::Set => &[""],
            _ => return Columns::default(),
        };
        if dim == 0 {
            let one = |(&n, c): (_, &Column)| (n, vec![value::number(c.get(&[]))]);
            return Columns {
                values: names.iter().zip(&root.columns).map(one).collect(),
                ..Columns::default()
            };
        }
        let keys = flat(&root.columns);
        let columns = names.iter().zip(&root.columns);
        let is_set = self.entry.kind == SymbolKind::Set;
        let text = |key: &[Label]| root.texts.get(key).map_or(String::new(), |t| t.to_string());
        Columns {
            keys: self.data.keys(&keys, dim),
            values: match is_set {
                true => Vec::new(),
                false => columns.map(|(&n, c)| (n, read(c, &keys))).collect(),
            },
            texts: is_set.then(|| keys.chunks_exact(dim).map(text).collect()),
        }
    }

    /// The records of a variable or an equation in label order, those whose level, marginal or bounds are not all
    /// the default; of other symbols there are none.
    pub fn variable_records(&self) -> VariableRecords<'a> {
        VariableRecords {
            data: self.data,
            columns: match self.entry.kind {
                SymbolKind::Variable | SymbolKind::Equation => &self.entry.columns,
                _ => &[],
            },
            dim: self.dimension(),
            next: [0; 4],
        }
    }
}

/// All records of a symbol, in label order, as columns ([`Symbol::columns`]).
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Columns {
    /// Their labels.
    pub keys: Keys,
    /// `value` of a parameter; `level`, `marginal`, `lower`, `upper` of a variable or an equation; none of a set. `eps` is 0; `na`,
    /// `undf` and acronyms are NaN.
    pub values: Vec<(&'static str, Vec<f64>)>,
    /// Texts of the members of a set.
    pub texts: Option<Vec<String>>,
}

/// A record of a set or a parameter.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Record<'a> {
    /// Its labels.
    pub labels: Vec<&'a str>,
    /// Its value; 1 for a set. `eps` is 0; `na`, `undf` and acronyms are NaN.
    pub value: f64,
    /// What the value is, if it is not an ordinary number.
    pub special: Option<Special<'a>>,
    /// The text of a set's member, perhaps empty.
    pub text: &'a str,
}

/// The records of a set or a parameter ([`Symbol::records`]).
#[derive(Clone, Debug)]
pub struct Records<'a> {
    data: &'a Data,
    root: &'a Entry,
    next: usize,
    end: usize,
}

impl<'a> Iterator for Records<'a> {
    type Item = Record<'a>;

    fn next(&mut self) -> Option<Record<'a>> {
        if self.next >= self.end {
            return None;
        }
        let (r, dim) = (self.next, self.root.domain.len());
        self.next += 1;
        let column = &self.root.columns[0];
        let key = &column.keys[r * dim..(r + 1) * dim];
        let v = column.values[r];
        Some(Record {
            labels: self.data.names(key),
            value: value::number(v),
            special: self.data.special(v),
            text: self.root.texts.get(key).map_or("", |t| t),
        })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = self.end - self.next;
        (left, Some(left))
    }
}

impl ExactSizeIterator for Records<'_> {}

/// A record of a variable or an equation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct VariableRecord<'a> {
    /// Its labels.
    pub labels: Vec<&'a str>,
    /// Level.
    pub level: f64,
    /// Marginal; a stored `eps` is 0.
    pub marginal: f64,
    /// Lower bound.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
}

/// The records of a variable or an equation ([`Symbol::variable_records`]).
#[derive(Clone, Debug)]
pub struct VariableRecords<'a> {
    data: &'a Data,
    columns: &'a [Column],
    dim: usize,
    /// The next record of each column.
    next: [usize; 4],
}

impl<'a> Iterator for VariableRecords<'a> {
    type Item = VariableRecord<'a>;

    fn next(&mut self) -> Option<VariableRecord<'a>> {
        let dim = self.dim;
        let heads = self.columns.iter().zip(self.next);
        let heads = heads.filter(|(c, r)| *r < c.values.len());
        let key = heads.map(|(c, r)| &c.keys[r * dim..(r + 1) * dim]).min()?;
        let mut values = [0.0; 4];
        for (k, c) in self.columns.iter().enumerate() {
            let r = self.next[k];
            let here = r < c.values.len() && &c.keys[r * dim..(r + 1) * dim] == key;
            values[k] = value::number(if here { c.values[r] } else { c.default });
            self.next[k] += usize::from(here);
        }
        Some(VariableRecord {
            labels: self.data.names(key),
            level: values[LEVEL],
            marginal: values[MARGINAL],
            lower: values[LOWER],
            upper: values[UPPER],
        })
    }
}
