//! The sets and data that a derived model needs, as statements with the values they had at the solve.

use super::derive::domain_of;
use super::text::attribute_name;
use super::tree::*;
use super::{NewData, Row, Scope};
use crate::check::node::{SymbolId, TableId};
use crate::check::symbols::{DomainPosition, Store, SymbolKind, Symbols, UNIVERSE};
use crate::data::input::{Input, InputData, Keys};
use crate::data::table::Table;
use crate::data::universe::Label;
use crate::data::value::{is_eps, is_na};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::sync::Arc;

/// A number as the language reads it, with all its digits.
pub fn number(x: f64) -> String {
    match x {
        _ if is_eps(x) => "eps".into(),
        _ if is_na(x) => "na".into(),
        f64::INFINITY => "inf".into(),
        f64::NEG_INFINITY => "-inf".into(),
        _ if x.is_nan() => "na".into(),
        _ => {
            let (plain, short) = (format!("{x}"), format!("{x:e}"));
            match plain.len() > 17 && short.len() < plain.len() {
                true => short,
                false => plain,
            }
        }
    }
}

/// A label or a text in quotes.
pub fn quoted(text: &str) -> String {
    match text.contains('\'') {
        true => format!("\"{}\"", text.replace('"', "'")),
        false => format!("'{text}'"),
    }
}

/// What a derived model needs of the user's data.
pub struct Data<'a> {
    scope: Scope<'a>,
    sets: BTreeSet<SymbolId>,
    parameters: BTreeSet<SymbolId>,
    attributes: BTreeSet<(SymbolId, u32)>,
}

impl<'a> Data<'a> {
    /// Nothing yet.
    pub fn new(scope: Scope<'a>) -> Self {
        Self {
            scope,
            sets: BTreeSet::new(),
            parameters: BTreeSet::new(),
            attributes: BTreeSet::new(),
        }
    }

    /// A set or an alias, with the sets it is a subset of.
    pub fn set(&mut self, s: SymbolId) {
        if s == UNIVERSE || !self.scope.get(s).is_set() || !self.sets.insert(s) {
            return;
        }
        self.set(self.scope.symbols.root(s));
        self.domain_of(s);
    }

    /// The sets that a symbol is declared over.
    pub fn domain_of(&mut self, s: SymbolId) {
        for p in &self.scope.get(s).domain {
            if let DomainPosition::Set(d) = p {
                self.set(*d);
            }
        }
    }

    /// What a row needs.
    pub fn row(&mut self, r: &Row) {
        r.domain.iter().for_each(|s| self.set(*s));
        r.key.iter().for_each(|p| self.part(p));
        r.binder.conditions.iter().for_each(|c| self.expr(c));
        self.expr(&r.left);
        self.expr(&r.right);
    }

    /// What an expression needs.
    pub fn expr(&mut self, e: &Expr) {
        e.walk(&mut |e| {
            e.parts(&mut |p| self.part(p));
            match e {
                Expr::Data(Source::Parameter(p), _) => {
                    self.parameters.insert(*p);
                    self.domain_of(*p);
                }
                Expr::Data(Source::Attribute(s, o), _) => {
                    self.attributes.insert((*s, *o));
                    self.domain_of(*s);
                }
                Expr::Member(s, _) | Expr::Card(s) => self.set(*s),
                _ => {}
            }
        });
    }

    fn part(&mut self, p: &Part) {
        match p {
            Part::Singleton(s, _) => self.set(*s),
            Part::Lag(l) => {
                self.set(l.set);
                self.part(&l.base);
            }
            _ => {}
        }
    }

    /// All of it as statements.
    pub fn statements(&self, out: &mut Statements) {
        self.order(out);
        for &s in &self.sets {
            let symbol = self.scope.get(s);
            if let SymbolKind::Alias(root) = symbol.kind {
                let root = match root {
                    UNIVERSE => "*".to_string(),
                    r => self.scope.get(r).name.to_string(),
                };
                let _ = writeln!(out.text, "Alias ({root},{});", symbol.name);
                continue;
            }
            let singleton = matches!(symbol.kind, SymbolKind::Set { singleton: true });
            let word = if singleton { "Singleton set" } else { "Set" };
            let table = self.scope.store.table(symbol.table);
            let head = self.head(s, &symbol.name);
            let keys = records(table).map(|(k, _)| (k.to_vec(), 1.0));
            out.records(word, &head, &symbol.text, true, keys);
        }
        for &p in &self.parameters {
            let symbol = self.scope.get(p);
            let head = self.head(p, &symbol.name);
            let all = records(self.scope.store.table(symbol.table)).map(|(k, v)| (k.to_vec(), v));
            out.records("Parameter", &head, &symbol.text, false, all);
        }
        for &(s, offset) in &self.attributes {
            let symbol = self.scope.get(s);
            let table = self.scope.store.table(symbol.table + offset);
            let head = self.head(s, &attribute_name(self.scope.symbols, s, offset));
            let word = crate::check::functions::attribute_word(offset);
            let text = format!("{}.{word} at the solve", symbol.name);
            let default = table.default_value();
            if default == 0.0 {
                let all = records(table).map(|(k, v)| (k.to_vec(), v));
                out.records("Parameter", &head, &text, false, all);
                continue;
            }
            // What is not stored has another value than 0.
            let mut keys = vec![Vec::new()];
            for set in domain_of(self.scope.symbols, s) {
                let members = self.scope.table(set);
                let longer = |k: &Vec<Label>| {
                    let k = k.clone();
                    records(members).map(move |(m, _)| [k.as_slice(), m].concat())
                };
                keys = keys.iter().flat_map(longer).collect();
            }
            let all = keys.into_iter().map(|k| {
                let v = table.get(&k);
                (k, v)
            });
            out.records("Parameter", &head, &text, false, all);
        }
        out.text.push('\n');
    }

    /// What of it has other records elsewhere, by name.
    pub fn changed<'t>(&self, other: &dyn Fn(TableId) -> Option<&'t Table>) -> Vec<String> {
        let differs = |table: TableId, is_set: bool| {
            let own = self.scope.store.table(table);
            let value = |v: f64| if is_set { 0 } else { v.to_bits() };
            let same = |o: &Table| {
                let mut pairs = records(own).zip(records(o));
                own.len() == o.len() && pairs.all(|((k, v), (l, w))| k == l && value(v) == value(w))
            };
            other(table).is_some_and(|o| !same(o))
        };
        let symbol = |s: &SymbolId| self.scope.get(*s);
        let sets = self.sets.iter().filter(|s| differs(symbol(s).table, true));
        let parameters = self
            .parameters
            .iter()
            .filter(|p| differs(symbol(p).table, false));
        let plain = sets.chain(parameters).map(|s| symbol(s).name.to_string());
        let attributes = self.attributes.iter();
        let attributes = attributes.filter(|(s, o)| differs(symbol(s).table + o, false));
        let word = crate::check::functions::attribute_word;
        let attributes = attributes.map(|(s, o)| format!("{}.{}", symbol(s).name, word(*o)));
        plain.chain(attributes).collect()
    }

    /// Labels in the order they had, where the sets alone would bring them up in another one.
    fn order(&self, out: &mut Statements) {
        let mut seen: FxHashSet<Label> = FxHashSet::default();
        let mut order: Vec<Label> = Vec::new();
        for &s in &self.sets {
            if matches!(self.scope.get(s).kind, SymbolKind::Alias(_)) {
                continue;
            }
            for (k, _) in records(self.scope.table(s)) {
                order.extend(k.iter().filter(|l| seen.insert(**l)));
            }
        }
        if order.is_sorted() {
            return;
        }
        order.sort_unstable();
        let mut name = "labels_in_order".to_string();
        while self.scope.symbols.find(&name).is_some() {
            name.push('_');
        }
        let labels = order.into_iter().map(|l| (vec![l], 1.0));
        let text = "the labels in the order of the text";
        out.records("Set", &name, text, true, labels);
    }

    fn head(&self, s: SymbolId, name: &str) -> String {
        head(self.scope.symbols, name, &domain_of(self.scope.symbols, s))
    }
}

/// A name with the sets that it runs over.
pub(super) fn head(symbols: &Symbols, name: &str, domain: &[SymbolId]) -> String {
    let sets: Vec<&str> = domain.iter().map(|s| &*symbols.get(*s).name).collect();
    match sets.is_empty() {
        true => name.to_string(),
        false => format!("{name}({})", sets.join(",")),
    }
}

/// The records of a table in label order, tidy or not.
fn records(t: &Table) -> impl Iterator<Item = (&[Label], f64)> {
    (0..t.len() as u32).map(|r| (t.key(r), t.value(r)))
}

/// Statements that declare data, and the data: in the text, or apart from it.
pub struct Statements<'a> {
    scope: Scope<'a>,
    /// The text.
    pub text: String,
    /// Where the records of what has indices go that are not to be written.
    pub apart: Option<&'a mut Vec<Arc<Input>>>,
}

impl<'a> Statements<'a> {
    /// Nothing yet.
    pub fn new(scope: Scope<'a>, apart: Option<&'a mut Vec<Arc<Input>>>) -> Self {
        Self {
            scope,
            text: String::new(),
            apart,
        }
    }

    /// Data that a derivation introduces.
    pub fn introduced(&mut self, d: &NewData) {
        let word = if d.is_set { "Set" } else { "Parameter" };
        let head = head(self.scope.symbols, &d.name, &d.domain);
        self.records(word, &head, &d.text, d.is_set, d.records.iter().cloned());
    }

    fn records(
        &mut self,
        word: &str,
        head: &str,
        text: &str,
        is_set: bool,
        records: impl Iterator<Item = (Vec<Label>, f64)>,
    ) {
        let out = &mut self.text;
        let _ = write!(out, "{word} {head}");
        if !text.is_empty() {
            let _ = write!(out, " {}", quoted(text));
        }
        let mut records = records.peekable();
        let has_indices = records.peek().is_some_and(|r| !r.0.is_empty());
        if let Some(apart) = self.apart.as_mut().filter(|_| has_indices) {
            out.push_str(";\n");
            let name = head.split('(').next().unwrap_or_default();
            apart.push(Arc::new(input(self.scope.store, name, is_set, records)));
            return;
        }
        let mut any = false;
        for (key, v) in records {
            out.push_str(if any { ",\n     " } else { "\n   / " });
            any = true;
            for (n, l) in key.iter().enumerate() {
                if n > 0 {
                    out.push('.');
                }
                let name = self.scope.store.universe.name(*l);
                match name.contains('\'') {
                    true => out.push_str(&quoted(name)),
                    false => out.extend(["'", name, "'"]),
                }
            }
            if !is_set {
                if !key.is_empty() {
                    out.push(' ');
                }
                out.push_str(&number(v));
            }
        }
        // A parameter without records is 0 everywhere.
        out.push_str(if any { " /;\n" } else { " / /;\n" });
    }
}

/// Records as data from outside the text.
fn input(
    store: &Store,
    name: &str,
    is_set: bool,
    records: impl Iterator<Item = (Vec<Label>, f64)>,
) -> Input {
    let (mut labels, mut codes, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let mut known: Vec<FxHashMap<Label, u32>> = Vec::new();
    for (key, v) in records.filter(|r| r.1 != 0.0) {
        labels.resize(key.len(), Vec::new());
        codes.resize(key.len(), Vec::new());
        known.resize(key.len(), FxHashMap::default());
        for (p, l) in key.into_iter().enumerate() {
            let code = *known[p].entry(l).or_insert_with(|| {
                labels[p].push(store.universe.name(l).to_string());
                labels[p].len() as u32 - 1
            });
            codes[p].push(code);
        }
        values.push(v);
    }
    let keys = Keys::new(labels, codes).unwrap_or_default();
    let data = match is_set {
        true => InputData::Members(keys, Vec::new()),
        false => InputData::Values(keys, values),
    };
    Input {
        name: name.into(),
        data,
    }
}
