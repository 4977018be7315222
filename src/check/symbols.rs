//! Symbols, and the store of their data.

use super::node::{FigureCode, SymbolId, TableId};
use crate::data::table::Table;
use crate::data::universe::{Label, Universe};
use crate::source::Span;
use crate::syntax::ast::VariableKind;
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// Order of a variable's or equation's attribute tables behind `Symbol::table`.
pub mod attribute {
    /// Level.
    pub const L: u32 = 0;
    /// Marginal.
    pub const M: u32 = 1;
    /// Lower bound.
    pub const LO: u32 = 2;
    /// Upper bound.
    pub const UP: u32 = 3;
    /// Scale.
    pub const SCALE: u32 = 4;
    /// Branching priority.
    pub const PRIOR: u32 = 5;
    /// Stage.
    pub const STAGE: u32 = 6;
    /// How many there are.
    pub const COUNT: u32 = 7;
}

/// One index position of a symbol.
#[derive(Clone, Debug, PartialEq)]
pub enum DomainPosition {
    /// `*`: any label.
    Universe,
    /// Members of a set.
    Set(SymbolId),
}

/// What a symbol is.
#[derive(Clone, Debug)]
pub enum SymbolKind {
    /// A set.
    Set {
        /// At most one element.
        singleton: bool,
    },
    /// Another name of a set.
    Alias(SymbolId),
    /// A parameter.
    Parameter {
        /// Declared by `scalar`.
        scalar: bool,
    },
    /// A variable.
    Variable(VariableKind),
    /// An equation; its definition's index once there is one.
    Equation(Option<usize>),
    /// A model.
    Model(Arc<ModelInfo>),
    /// A file for `put`: name outside.
    File(Box<str>),
    /// An acronym: its number.
    Acronym(u32),
    /// A figure.
    Figure(Arc<FigureCode>),
}

/// What a model contains, unresolved until a solve (so that `/all/` means all that is known then).
#[derive(Clone, Debug, Default)]
pub struct ModelInfo {
    /// Its items; None: never given.
    pub items: Option<Vec<crate::syntax::ast::ModelItem>>,
}

/// A symbol.
#[derive(Clone, Debug)]
pub struct Symbol {
    /// First spelling.
    pub name: Box<str>,
    /// What it is.
    pub kind: SymbolKind,
    /// Index positions.
    pub domain: Vec<DomainPosition>,
    /// Explanatory text.
    pub text: Box<str>,
    /// Where it was declared.
    pub declared: Span,
    /// First table of its data (aliases: the set's).
    pub table: TableId,
    /// It got data by a data statement.
    pub has_data: bool,
    /// It is assigned, loaded or solved for somewhere above.
    pub assigned: bool,
    /// A set that an assignment changes: it may not be a domain, and has no fixed order.
    pub dynamic: bool,
    /// A set that is the domain of a symbol: it may not be changed any more.
    pub is_domain: bool,
    /// A set whose elements are not in the order of the universe.
    pub unordered: bool,
    /// Declared without a domain and not used yet: the first use says how many indices there are.
    pub open: bool,
}

impl Symbol {
    /// Number of index positions.
    pub fn dim(&self) -> usize {
        self.domain.len()
    }

    /// `set`, `parameter` … as a user would say.
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            SymbolKind::Set { .. } => "set",
            SymbolKind::Alias(_) => "alias",
            SymbolKind::Parameter { scalar: true } => "scalar",
            SymbolKind::Parameter { scalar: false } => "parameter",
            SymbolKind::Variable(_) => "variable",
            SymbolKind::Equation(_) => "equation",
            SymbolKind::Model(_) => "model",
            SymbolKind::File(_) => "file",
            SymbolKind::Acronym(_) => "acronym",
            SymbolKind::Figure(_) => "figure",
        }
    }

    /// The same with its article.
    pub fn a_kind(&self) -> String {
        let kind = self.kind_name();
        let article = if kind.starts_with(['a', 'e']) {
            "an"
        } else {
            "a"
        };
        format!("{article} {kind}")
    }

    /// Whether it has levels, marginals and bounds.
    pub fn has_attributes(&self) -> bool {
        matches!(self.kind, SymbolKind::Variable(_) | SymbolKind::Equation(_))
    }

    /// Whether it is a set or an alias of one.
    pub fn is_set(&self) -> bool {
        matches!(self.kind, SymbolKind::Set { .. } | SymbolKind::Alias(_))
    }
}

/// The universe set: symbol 0, table 0.
pub const UNIVERSE: SymbolId = 0;

/// All data of a run.
#[derive(Clone, Default, Debug)]
pub struct Store {
    /// Labels.
    pub universe: Universe,
    /// Tables; a symbol's first is `Symbol::table`.
    pub tables: Vec<Table>,
    /// Element texts, by set table.
    pub texts: FxHashMap<TableId, FxHashMap<Box<[Label]>, Box<str>>>,
    /// Names of acronyms.
    pub acronyms: Vec<Box<str>>,
    /// The label of `$phantom`, which stands for no element.
    pub phantom: Option<Box<str>>,
}

impl Store {
    /// Whether a label in data stands for no element.
    pub(super) fn is_phantom(&self, label: &str) -> bool {
        let is = |p: &str| p.eq_ignore_ascii_case(label);
        self.phantom.as_deref().is_some_and(is)
    }

    /// A table.
    pub fn table(&self, id: TableId) -> &Table {
        &self.tables[id as usize]
    }

    /// A table to write to.
    pub fn table_mut(&mut self, id: TableId) -> &mut Table {
        &mut self.tables[id as usize]
    }

    /// Gives a symbol without data another number of indices.
    pub(super) fn reshape(&mut self, symbol: &mut Symbol, dim: usize) {
        symbol.domain = vec![DomainPosition::Universe; dim];
        let tables = if symbol.has_attributes() {
            attribute::COUNT
        } else {
            1
        };
        for t in symbol.table..symbol.table + tables {
            *self.table_mut(t) = Table::new(dim, self.table(t).default_value());
        }
    }

    /// Gives a symbol, or one attribute of it, its default values.
    pub fn clear(&mut self, symbol: &Symbol, attribute: Option<u32>) {
        let offsets = match (&symbol.kind, attribute) {
            (_, Some(offset)) => offset..offset + 1,
            (SymbolKind::Variable(_) | SymbolKind::Equation(_), None) => 0..attribute::COUNT,
            (
                SymbolKind::Set { .. } | SymbolKind::Alias(_) | SymbolKind::Parameter { .. },
                None,
            ) => 0..1,
            _ => return,
        };
        for o in offsets {
            self.table_mut(symbol.table + o).clear();
        }
    }

    /// Adds a table.
    pub fn add_table(&mut self, dim: usize, default: f64) -> TableId {
        self.tables.push(Table::new(dim, default));
        self.tables.len() as TableId - 1
    }

    /// Makes the table of the universe hold all labels.
    pub fn refresh_universe(&mut self) {
        let n = self.universe.len();
        let t = &mut self.tables[UNIVERSE as usize];
        for l in t.len() as u32..n as u32 {
            t.set(&[l], 1.0);
        }
    }

    /// Text of a set's element, if it has one.
    pub fn element_text(&self, table: TableId, key: &[Label]) -> Option<&str> {
        self.texts.get(&table)?.get(key).map(|t| &**t)
    }
}

/// All names.
#[derive(Clone, Default, Debug)]
pub struct Symbols {
    list: Vec<Symbol>,
    index: FxHashMap<String, SymbolId>,
}

impl Symbols {
    /// The symbol with this name.
    pub fn find(&self, name: &str) -> Option<SymbolId> {
        match self.index.get(name) {
            Some(&s) => Some(s),
            None => self.index.get(&name.to_lowercase()).copied(),
        }
    }

    /// A symbol.
    pub fn get(&self, id: SymbolId) -> &Symbol {
        &self.list[id as usize]
    }

    /// A symbol to change.
    pub fn get_mut(&mut self, id: SymbolId) -> &mut Symbol {
        &mut self.list[id as usize]
    }

    /// Adds a symbol.
    pub fn add(&mut self, symbol: Symbol) -> SymbolId {
        let id = self.list.len() as SymbolId;
        self.index.insert(symbol.name.to_lowercase(), id);
        self.list.push(symbol);
        id
    }

    /// All symbols in order of declaration.
    pub fn iter(&self) -> impl Iterator<Item = (SymbolId, &Symbol)> {
        self.list
            .iter()
            .enumerate()
            .map(|(i, s)| (i as SymbolId, s))
    }

    /// The set, or the alias of one, that has this name.
    pub fn find_set(&self, name: &str) -> Option<SymbolId> {
        self.find(name).filter(|&s| self.get(s).is_set())
    }

    /// The symbol itself, or what it is an alias of.
    pub fn rooted(&self, s: SymbolId) -> &Symbol {
        self.get(self.root(s))
    }

    /// The set behind an alias.
    pub fn root(&self, id: SymbolId) -> SymbolId {
        match self.get(id).kind {
            SymbolKind::Alias(r) => r,
            _ => id,
        }
    }

    /// Names of the index sets of a symbol.
    pub fn domain_names(&self, symbol: &Symbol) -> Vec<String> {
        let name = |d: &DomainPosition| match d {
            DomainPosition::Universe => "*".to_string(),
            DomainPosition::Set(i) => self.get(*i).name.to_string(),
        };
        symbol.domain.iter().map(name).collect()
    }

    /// Whether every member of set `a` is a member of `b`, by their declarations.
    pub fn is_subset(&self, a: SymbolId, b: SymbolId) -> bool {
        let b = self.root(b);
        if b == UNIVERSE {
            return true;
        }
        let mut a = self.root(a);
        loop {
            if a == b {
                return true;
            }
            match self.get(a).domain.as_slice() {
                [DomainPosition::Set(up)] => a = self.root(*up),
                _ => return false,
            }
        }
    }
}
