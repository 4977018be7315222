//! What a load collects before anything is changed.

use super::{Outcome, Request, Wanted, parse_value};
use crate::check::node::{SymbolId, TableId};
use crate::check::symbols::{DomainPosition, Store, SymbolKind, Symbols, attribute};
use crate::data::table::Table;
use crate::data::universe::{Label, Universe};
use crate::diag::{Diagnostic, nearest};
use rustc_hash::{FxHashMap, FxHashSet};

/// Texts of a set's elements.
type Texts = FxHashMap<Box<[Label]>, Box<str>>;

/// Symbols while they are read.
pub(super) struct Loading<'a> {
    pub symbols: &'a Symbols,
    pub store: &'a Store,
    pub request: &'a Request<'a>,
    /// Labels that the universe does not have yet: their numbers follow on its own.
    new: Universe,
    /// Members of sets that this load brings.
    members: FxHashMap<SymbolId, FxHashSet<Label>>,
    out: Finished,
}

/// What a load changes.
#[derive(Default)]
pub(super) struct Finished {
    /// New labels, to be added in this order.
    pub labels: Vec<String>,
    pub tables: Vec<(TableId, Table)>,
    pub texts: Vec<(TableId, Texts)>,
    pub symbols: Vec<SymbolId>,
    /// Explanatory texts for symbols that may have none.
    pub explanations: Vec<(SymbolId, Box<str>)>,
    pub warnings: Vec<Diagnostic>,
}

/// Records of one symbol.
#[derive(Default)]
pub(super) struct Records {
    pub keys: Vec<Label>,
    /// Per record and attribute that the file has.
    pub values: Vec<f64>,
    /// Line or number of each record in the file, for messages.
    pub places: Vec<usize>,
    pub texts: Texts,
}

impl Records {
    /// The text of the record whose `dim` labels came last.
    pub(super) fn text(&mut self, dim: usize, text: &str) {
        if !text.is_empty() {
            let key = self.keys[self.keys.len() - dim..].into();
            self.texts.insert(key, text.into());
        }
    }
}

impl<'a> Loading<'a> {
    pub(super) fn new(symbols: &'a Symbols, store: &'a Store, request: &'a Request<'a>) -> Self {
        Self {
            symbols,
            store,
            request,
            new: Universe::default(),
            members: FxHashMap::default(),
            out: Finished::default(),
        }
    }

    /// Number of a label, new or not.
    pub(super) fn label(&mut self, text: &str) -> Label {
        match self.store.universe.get(text) {
            Some(l) => l,
            None => self.store.universe.len() as Label + self.new.intern(text),
        }
    }

    /// Number of a label that is known.
    pub(super) fn known(&self, text: &str) -> Option<Label> {
        let new = || Some(self.store.universe.len() as Label + self.new.get(text)?);
        self.store.universe.get(text).or_else(new)
    }

    /// An explanatory text for a symbol that has none.
    pub(super) fn text(&mut self, symbol: SymbolId, text: &str) {
        self.out.explanations.push((symbol, text.into()));
    }

    /// Tells of something that does not stop the load.
    pub(super) fn warn(&mut self, d: Diagnostic) {
        self.out.warnings.push(d);
    }

    pub(super) fn name(&self, l: Label) -> &str {
        match (l as usize).checked_sub(self.store.universe.len()) {
            Some(k) => self.new.name(k as Label),
            None => self.store.universe.name(l),
        }
    }

    /// A value, or a message about the place in the file.
    pub(super) fn value(&self, text: &str, file: &str, place: usize, w: &Wanted) -> Outcome<f64> {
        parse_value(text, &self.store.acronyms).ok_or_else(|| {
            Box::new(
                Diagnostic::execution("E0478", w.span)
                    .says(format!("{file}:{place}: `{text}` is not a number"))
                    .label(format!("while loading `{}`", w.name))
                    .help("numbers, EPS, NA, INF, -INF, UNDF, yes and no are values"),
            )
        })
    }

    /// Whether a label belongs to the set of a position.
    pub(super) fn belongs(&self, set: SymbolId, l: Label) -> bool {
        let root = self.symbols.root(set);
        if root == crate::check::symbols::UNIVERSE {
            return true;
        }
        match self.members.get(&root) {
            Some(m) => m.contains(&l),
            None => {
                let table = self.store.table(self.symbols.get(root).table);
                table.find(&[l]).is_some()
            }
        }
    }

    /// Checks the labels of a symbol against its domain.
    fn check_domain(&self, w: &Wanted, file: &str, r: &Records) -> Outcome<()> {
        let symbol = self.symbols.get(w.symbol);
        let dim = symbol.dim();
        for (p, d) in symbol.domain.iter().enumerate() {
            let DomainPosition::Set(set) = d else {
                continue;
            };
            let mut wrong: Vec<(Label, usize)> = Vec::new();
            let mut seen = FxHashSet::default();
            let mut last = None;
            for (k, key) in r.keys.chunks_exact(dim).enumerate() {
                if last == Some(key[p]) {
                    continue;
                }
                last = Some(key[p]);
                if !self.belongs(*set, key[p]) && seen.insert(key[p]) {
                    wrong.push((key[p], r.places[k]));
                }
            }
            let Some(&(first, place)) = wrong.first() else {
                continue;
            };
            let set_symbol = self.symbols.rooted(*set);
            let others = match wrong.len() {
                1 => String::new(),
                n => format!(" (and {} more)", n - 1),
            };
            let table = self.store.table(set_symbol.table);
            let labels = (0..table.len().min(10_000) as u32).map(|row| table.key(row)[0]);
            let (name, set) = (self.name(first), &set_symbol.name);
            let near = nearest(name, labels.map(|l| self.store.universe.name(l)));
            let near = near.map(str::to_string);
            return Diagnostic::execution("E0479", w.span)
                .says(format!(
                    "{file}:{place}: `{name}` is not a member of the set `{set}`{others}"
                ))
                .label(format!(
                    "position {} of `{}` runs over `{set}`",
                    p + 1,
                    symbol.name
                ))
                .other(set_symbol.declared, format!("`{set}` is declared here"))
                .did_you_mean(
                    near,
                    format!("add the label to `{set}`, or correct the file"),
                )
                .refuse();
        }
        Ok(())
    }

    /// Takes the records of a symbol. `columns` says which tables the values of a record go to, counted
    /// from the symbol's first.
    pub(super) fn take(
        &mut self,
        w: &Wanted,
        file: &str,
        mut r: Records,
        columns: &[u32],
    ) -> Outcome<()> {
        self.check_domain(w, file, &r)?;
        let root = self.symbols.root(w.symbol);
        let symbol = self.symbols.get(root);
        let (dim, width) = (symbol.dim(), columns.len());
        let count = r.places.len();
        let key = |k: usize| &r.keys[k * dim..(k + 1) * dim];
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&a, &b| key(a).cmp(key(b)));
        for pair in order.windows(2) {
            if key(pair[0]) == key(pair[1]) {
                let labels: Vec<&str> = key(pair[0]).iter().map(|&l| self.name(l)).collect();
                let what = match dim {
                    0 => "the value".to_string(),
                    _ => format!("the record `{}`", labels.join(".")),
                };
                return Diagnostic::execution("E0478", w.span)
                    .says(format!(
                        "{file}:{}: {what} of `{}` was given before, at {}",
                        r.places[pair[1]], w.name, r.places[pair[0]]
                    ))
                    .label("given twice; nothing was loaded")
                    .help("keep one of the two")
                    .refuse();
            }
        }
        let keys: Vec<Label> = order.iter().flat_map(|&k| key(k).iter().copied()).collect();
        let is_set = symbol.is_set();
        if let SymbolKind::Set { singleton: true } = symbol.kind
            && count > 1
        {
            let name = &w.name;
            return Diagnostic::execution("E0478", w.span)
                .says(format!(
                    "`{name}` is a singleton; the file has {count} elements for it"
                ))
                .label("nothing was loaded")
                .refuse();
        }
        // As in GAMS the records of the file are all that there is: the other attributes get their defaults.
        if w.into.is_some() && dim > 0 && !self.request.point {
            let others = (0..attribute::COUNT).filter(|o| !columns.contains(o));
            for table in others.map(|o| symbol.table + o) {
                let default = self.store.table(table).default_value();
                self.out.tables.push((table, Table::new(dim, default)));
            }
        }
        for (c, &offset) in columns.iter().enumerate() {
            let of_point = matches!(offset, attribute::L | attribute::M) || w.into.is_some();
            if self.request.point && !of_point {
                continue;
            }
            let values: Vec<f64> = order.iter().map(|&k| r.values[k * width + c]).collect();
            let before = self.store.table(symbol.table + offset);
            let default = before.default_value();
            let table = if self.request.merge || self.request.point {
                let mut t = before.clone();
                for (n, v) in values.iter().enumerate() {
                    t.set(&keys[n * dim..(n + 1) * dim], *v);
                }
                t.tidy();
                t
            } else if dim == 0 {
                let mut t = Table::new(0, default);
                t.set(&[], values.first().copied().unwrap_or(default));
                t
            } else {
                Table::from_records(dim, default, keys.clone(), values)
            };
            if is_set && dim == 1 {
                self.members
                    .insert(root, table.iter().map(|(k, _)| k[0]).collect());
            }
            self.out.tables.push((symbol.table + offset, table));
        }
        if is_set {
            let mut texts = std::mem::take(&mut r.texts);
            if self.request.merge {
                for (key, text) in self.store.texts.get(&symbol.table).into_iter().flatten() {
                    texts.entry(key.clone()).or_insert_with(|| text.clone());
                }
            }
            self.out.texts.push((symbol.table, texts));
        }
        self.out.symbols.push(root);
        Ok(())
    }

    pub(super) fn finish(mut self) -> Finished {
        self.out.labels = (0..self.new.len() as Label)
            .map(|l| self.new.name(l).to_string())
            .collect();
        self.out
    }
}
