//! Data given from outside the text ([`Input`]): a symbol takes them where it is declared, and what data
//! statements say about it is passed over.

use super::node::SymbolId;
use super::symbols::{DomainPosition, Symbol, SymbolKind, UNIVERSE};
use super::{Checked, Compiler, Program};
use crate::data::input::{Input, InputData, Keys};
use crate::data::table::Table;
use crate::data::universe::Label;
use crate::diag::{Diagnostic, nearest};
use crate::source::Span;
use rustc_hash::{FxHashMap, FxHashSet};
use std::sync::Arc;

/// Data from outside while the text is read.
#[derive(Debug, Default)]
pub(super) struct Inputs {
    /// What no declaration has taken yet, in the order given.
    waiting: Vec<Arc<Input>>,
    /// Symbols that took theirs.
    taken: FxHashSet<SymbolId>,
}

impl Inputs {
    pub(super) fn new(waiting: Vec<Arc<Input>>) -> Self {
        Self {
            waiting,
            taken: FxHashSet::default(),
        }
    }

    /// Whether a symbol has data from outside.
    pub(super) fn has(&self, s: SymbolId) -> bool {
        self.taken.contains(&s)
    }
}

impl Compiler {
    /// Gives a symbol that was just declared its data from outside. True if it has some: the text's own are
    /// passed over then.
    pub(super) fn take_input(&mut self, s: SymbolId, span: Span) -> bool {
        if self.inputs.has(s) {
            return true;
        }
        let name = &self.symbols.get(s).name;
        let named = |i: &Arc<Input>| i.name.eq_ignore_ascii_case(name);
        let Some(at) = self.inputs.waiting.iter().position(named) else {
            return false;
        };
        let mut input = self.inputs.waiting.remove(at);
        // What was given last counts.
        while let Some(at) = self.inputs.waiting.iter().position(named) {
            input = self.inputs.waiting.remove(at);
        }
        self.inputs.taken.insert(s);
        let symbol = self.symbols.get_mut(s);
        symbol.has_data = true;
        let open = std::mem::take(&mut symbol.open);
        let keys = input.data.keys();
        if open && !keys.is_empty() {
            self.set_dimension(s, keys.dimension());
        }
        // Which members the set has is known only here then.
        self.asked_for_data.set(
            self.asked_for_data.get() || self.defining.get(&s).is_some_and(|d| d.contains(&true)),
        );
        let _ = self.fill_from_input(s, &input, span);
        true
    }

    /// An error for data that a symbol of this kind and shape cannot have.
    fn fits_symbol(&mut self, symbol: &Symbol, input: &Input, span: Span) -> Checked<()> {
        let wrong_kind = match (&symbol.kind, &input.data) {
            (SymbolKind::Set { .. }, InputData::Values(..)) => Some("numbers"),
            (SymbolKind::Parameter { .. }, InputData::Members(..)) => Some("members"),
            _ => None,
        };
        if let Some(what) = wrong_kind {
            let (kind, name) = (symbol.kind_name(), &symbol.name);
            return Diagnostic::error("E0376", span)
                .says(format!("`{name}` is a {kind}; {what} were given for it"))
                .label("declared here")
                .help("give members to sets, and numbers to parameters")
                .fail(self);
        }
        let dim = symbol.dim();
        let given = input.data.keys();
        let (name, many) = (&symbol.name, given.len());
        let message = match (given.unlike(dim), &symbol.kind) {
            (Some((n, key)), _) => {
                let plural = if dim == 1 { "" } else { "s" };
                let (record, has) = (record(name, &key, n), key.len());
                format!(
                    "`{name}` has {dim} index position{plural}; {record} given for it has {has}"
                )
            }
            (None, SymbolKind::Set { singleton: true }) if many > 1 => {
                format!("`{name}` is a singleton; {many} members were given")
            }
            _ => return Ok(()),
        };
        let d = Diagnostic::error("E0377", span).says(message);
        d.label("declared here").fail(self)
    }

    fn fill_from_input(&mut self, s: SymbolId, input: &Input, span: Span) -> Checked<()> {
        let symbol = self.symbols.get(s).clone();
        self.fits_symbol(&symbol, input, span)?;
        let (dim, given) = (symbol.dim(), input.data.keys());
        // Labels are looked up when a record first has them: the universe keeps the order of the records.
        let unknown = |p: usize| vec![None; given.labels(p).len()];
        let mut known: Vec<Vec<Option<Label>>> = (0..dim).map(unknown).collect();
        let mut keys: Vec<Label> = Vec::with_capacity(given.len() * dim);
        for r in 0..given.len() {
            for (p, known) in known.iter_mut().enumerate() {
                let code = given.codes(p)[r] as usize;
                let label = match known[code] {
                    Some(label) => label,
                    None => {
                        let label = self.store.universe.intern(&given.labels(p)[code]);
                        if let Some(DomainPosition::Set(d)) = symbol.domain.get(p) {
                            let d = self.symbols.root(*d);
                            self.check_member(s, given, [r, p], d, label, span)?;
                        }
                        known[code] = Some(label);
                        label
                    }
                };
                keys.push(label);
            }
        }
        fill(self.store.table_mut(symbol.table), &keys, &input.data);
        if let InputData::Members(_, texts) = &input.data {
            let labels = keys.chunks_exact(dim.max(1));
            let texts = labels.zip(texts).filter(|(_, t)| !t.is_empty());
            let texts: FxHashMap<_, _> =
                texts.map(|(k, t)| (k.into(), t.as_str().into())).collect();
            self.store.texts.insert(symbol.table, texts);
            let ordered = dim > 1 || keys.is_sorted();
            self.symbols.get_mut(s).unordered = !ordered;
        }
        self.store.refresh_universe();
        Ok(())
    }

    /// Checks a label against the set of its position, or adds it to a set that the data define (`p(i<)`).
    fn check_member(
        &mut self,
        s: SymbolId,
        keys: &Keys,
        [r, position]: [usize; 2],
        set: SymbolId,
        label: Label,
        span: Span,
    ) -> Checked<()> {
        if set == UNIVERSE {
            return Ok(());
        }
        let defines = self.defines(s, position) && !self.inputs.has(set);
        let domain = self.symbols.get(set);
        let table = &mut self.store.tables[domain.table as usize];
        if table.find(&[label]).is_some() {
            return Ok(());
        }
        if defines {
            table.set(&[label], 1.0);
            table.tidy();
            self.symbols.get_mut(set).has_data = true;
            return Ok(());
        }
        let key = keys.key(r);
        let members = table.all_keys().iter().take(10_000);
        let members = members.map(|&l| self.store.universe.name(l));
        let near = nearest(key[position], members).map(str::to_string);
        let (set, label) = (domain.name.clone(), key[position]);
        let record = record(&self.symbols.get(s).name, &key, r);
        let help = format!("give `{set}` this member too, or leave the record out");
        Diagnostic::error("E0377", span)
            .says(format!(
                "{record} was given from outside, but `{label}` is not a member of `{set}`"
            ))
            .label("declared here")
            .other(domain.declared, format!("`{set}` is declared here"))
            .did_you_mean(near, help)
            .fail(self)
    }

    /// An error for each piece of data that no symbol has taken.
    pub(super) fn unused_inputs(&mut self) {
        for input in std::mem::take(&mut self.inputs.waiting) {
            let name = &input.name;
            let d = match self.symbols.find(name) {
                Some(s) => {
                    let symbol = self.symbols.get(s);
                    let kind = symbol.kind_name();
                    Diagnostic::error("E0376", symbol.declared)
                        .says(format!("data were given for `{name}`, which is a {kind}"))
                        .label("declared here")
                        .help("data from outside are for sets and parameters")
                }
                None => {
                    let known = self.symbols.iter().skip(1).map(|(_, s)| s);
                    let known = known.filter(|s| {
                        matches!(
                            s.kind,
                            SymbolKind::Set { .. } | SymbolKind::Parameter { .. }
                        )
                    });
                    let near = nearest(name, known.map(|s| &*s.name));
                    Diagnostic::error("E0376", Span::default())
                        .says(format!(
                            "data were given for `{name}`, which the model does not declare"
                        ))
                        .did_you_mean(near, format!("declare it: `parameter {name};`"))
                }
            };
            d.report(self);
        }
    }
}

/// `d('a','b')` as a message names it.
fn record(name: &str, key: &[impl AsRef<str>], number: usize) -> String {
    if key.is_empty() {
        return format!("record {}", number + 1);
    }
    let labels: Vec<String> = key.iter().map(|l| format!("'{}'", l.as_ref())).collect();
    format!("`{name}({})`", labels.join(","))
}

/// Puts records into an empty table.
fn fill(table: &mut Table, keys: &[Label], data: &InputData) {
    let dim = table.dim();
    let values = match data {
        InputData::Values(_, values) => values.clone(),
        InputData::Members(keys, _) => vec![1.0; keys.len()],
    };
    // Of equal keys, and of a scalar's records, the last one counts.
    *table = match (dim, values.last()) {
        (0, Some(&last)) => Table::from_records(0, table.default_value(), Vec::new(), vec![last]),
        _ => Table::from_records(dim, table.default_value(), keys.to_vec(), values),
    };
}

impl Program {
    /// Puts other numbers in place of those that were given from outside when the text was compiled. False where the text must be
    /// compiled again: a set changes, or the text asked for data, or a label is new.
    pub fn replace_numbers(&mut self, before: &[Arc<Input>], now: &[Arc<Input>]) -> bool {
        let alike = |(a, b): (&Arc<Input>, &Arc<Input>)| a.name.eq_ignore_ascii_case(&b.name);
        if before.len() != now.len() || !before.iter().zip(now).all(alike) {
            return false;
        }
        let changed = before.iter().zip(now).filter(|(a, b)| !Arc::ptr_eq(a, b));
        changed.fold(true, |all, (a, b)| all && self.replace(&a.data, b))
    }

    fn replace(&mut self, before: &InputData, now: &Input) -> bool {
        let (InputData::Values(..), Some(s), false) =
            (&now.data, self.symbols.find(&now.name), self.asked_for_data)
        else {
            return false;
        };
        let symbol = self.symbols.get(s);
        let given = now.data.keys();
        if !matches!(symbol.kind, SymbolKind::Parameter { .. })
            || given.unlike(symbol.dim()).is_some()
        {
            return false;
        }
        // Where any label may stand, new ones would come after those of the text.
        let any = |p: &DomainPosition| !matches!(p, DomainPosition::Set(d) if *d != UNIVERSE);
        if symbol.domain.iter().any(any) && given != before.keys() {
            return false;
        }
        let mut columns = Vec::with_capacity(symbol.dim());
        for (p, domain) in symbol.domain.iter().enumerate() {
            let set = match domain {
                DomainPosition::Set(d) if *d != UNIVERSE => {
                    let set = self.symbols.rooted(*d);
                    Some(self.store.table(set.table))
                }
                _ => None,
            };
            let labels = given.labels(p).iter().map(|text| {
                let label = self.store.universe.get(text)?;
                set.is_none_or(|t| t.find(&[label]).is_some())
                    .then_some(label)
            });
            let Some(labels) = labels.collect::<Option<Vec<Label>>>() else {
                return false;
            };
            columns.push(labels);
        }
        let key = |r: usize| {
            let label = move |(p, labels): (usize, &Vec<Label>)| labels[given.codes(p)[r] as usize];
            columns.iter().enumerate().map(label)
        };
        let keys: Vec<Label> = (0..given.len()).flat_map(key).collect();
        let table = symbol.table;
        fill(self.store.table_mut(table), &keys, &now.data);
        true
    }
}
