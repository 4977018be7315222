//! The formulation itself: formulas of a model, its dual, its optimality conditions, with indices.
//!
//! [`lower`] makes formulas of the checked tree, [`gradient`] takes them apart into terms (derivatives in symbols),
//! [`invert`] sees a term from its column, [`dual`] and [`kkt`] put these together, [`text`] writes the result as a model,
//! [`math`] as formulas (text, LaTeX, MathML), [`check`] compares matrices. All of it is data: trees of [`tree`], and of
//! [`algebra`] for other programs. [`derived`] is what the commands and the library ask for.

pub mod algebra;
pub mod bounds;
pub mod check;
mod columns;
pub mod data;
pub mod derive;
pub mod derived;
pub mod dual;
pub mod explain;
pub mod gradient;
pub mod invert;
pub mod kkt;
pub mod lower;
pub mod math;
pub mod names;
pub mod numbers;
pub mod page;
pub mod range;
pub mod render;
pub mod show;
pub mod side;
pub mod study;
pub mod text;
pub mod tree;

use crate::check::node::SymbolId;
use crate::check::symbols::{Store, Symbol, Symbols};
use crate::data::table::Table;
use crate::data::universe::Label;
use crate::model::named::named;
use crate::model::origin::Blocks;
use crate::run::Machine;
use crate::syntax::ast::VariableKind;
use tree::{Binder, Expr, Indices, Part, Relation, Sense, Variable};

/// All names, and data as they were at the solve.
#[derive(Clone, Copy)]
pub struct Scope<'a> {
    /// All names.
    pub symbols: &'a Symbols,
    /// All data.
    pub store: &'a Store,
}

impl<'a> Scope<'a> {
    /// Those of a run.
    pub fn of(m: &'a Machine) -> Self {
        Self {
            symbols: &m.symbols,
            store: &m.store,
        }
    }

    /// A symbol.
    pub fn get(self, s: SymbolId) -> &'a Symbol {
        self.symbols.get(s)
    }

    /// The records of a symbol.
    pub fn table(self, s: SymbolId) -> &'a Table {
        self.store.table(self.get(s).table)
    }

    /// A row or column, as it is called.
    pub fn called(self, blocks: &Blocks, i: usize) -> String {
        let b = blocks.of(i as u32);
        text::record(self.store, &self.get(b.symbol).name, b.key(i as u32))
    }
}

named! {
    /// The sign of a variable.
    pub enum Sign {
        /// Any.
        Free "free";
        /// At least 0.
        Positive "positive";
        /// At most 0.
        Negative "negative";
    }
}

impl Sign {
    /// The sign that a kind of variables has by its declaration, discrete ones relaxed.
    pub fn of(kind: VariableKind) -> Self {
        match kind {
            VariableKind::Positive => Self::Positive,
            VariableKind::Negative => Self::Negative,
            _ => Self::Free,
        }
    }

    /// That of the same number times -1.
    pub fn opposite(self) -> Self {
        match self {
            Self::Positive => Self::Negative,
            Self::Negative => Self::Positive,
            Self::Free => Self::Free,
        }
    }
}

/// Where a multiplier comes from.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Origin {
    /// From the rows of an equation.
    Row(SymbolId),
    /// From the lower bounds of a variable.
    Lower(SymbolId),
    /// From the upper bounds of a variable.
    Upper(SymbolId),
    /// From the columns of a variable that are fixed.
    Fixed(SymbolId),
    /// From the bounds that columns of a variable do not have: they stand in no row and make the objective better without
    /// limit, so that their rows in the dual are to hold nowhere. Its coefficient is 0.
    Missing(SymbolId),
    /// It is no multiplier but the point at which the dual of a quadratic program takes the gradient.
    Point(SymbolId),
}

/// A variable that the derivation introduces.
#[derive(Clone, Debug)]
pub struct Multiplier {
    /// Its name.
    pub name: String,
    /// The sets that it runs over.
    pub domain: Vec<SymbolId>,
    /// Its sign.
    pub sign: Sign,
    /// What it belongs to.
    pub origin: Origin,
}

/// Data that the derivation introduces.
#[derive(Clone, Debug)]
pub struct NewData {
    /// Its name.
    pub name: String,
    /// Explanatory text.
    pub text: String,
    /// The sets that it runs over.
    pub domain: Vec<SymbolId>,
    /// Whether it is a set.
    pub is_set: bool,
    /// Its records in label order; 1 for members.
    pub records: Vec<(Vec<Label>, f64)>,
}

/// A start value or bound: `target.attribute(…)$data(…) = data(…)`.
#[derive(Clone, Debug)]
pub struct Assignment {
    /// Name of the variable.
    pub target: String,
    /// The attribute.
    pub attribute: &'static str,
    /// The indices that it runs over.
    pub indices: Vec<tree::IndexId>,
    /// Its values.
    pub data: NewData,
}

/// The rows of an equation.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// Explanatory text.
    pub text: String,
    /// The sets that it runs over.
    pub domain: Vec<SymbolId>,
    /// Labels of its rows.
    pub key: Vec<Part>,
    /// What it runs over.
    pub binder: Binder,
    /// Left side.
    pub left: Expr,
    /// Relation.
    pub relation: Relation,
    /// Right side.
    pub right: Expr,
    /// The variable it is paired with: in the dual the column it comes from, in complementarity problems its partner.
    pub pair: Option<Variable>,
}

impl Row {
    /// A row that says `0 = 0`.
    pub fn new(name: String) -> Self {
        Self {
            name,
            text: String::new(),
            domain: Vec::new(),
            key: Vec::new(),
            binder: Binder::default(),
            left: Expr::Number(0.0),
            relation: Relation::Equal,
            right: Expr::Number(0.0),
            pair: None,
        }
    }
}

/// A model as formulas.
#[derive(Clone, Debug, Default)]
pub struct Formulation {
    /// Its name.
    pub name: String,
    /// Problem type.
    pub using: String,
    /// Direction and objective function; None for complementarity problems.
    pub objective: Option<(Sense, Expr)>,
    /// Name of the variable that the objective function is called when it is written as a model.
    pub objective_name: String,
    /// The user's variables in it.
    pub own: Vec<SymbolId>,
    /// Variables that it introduces.
    pub multipliers: Vec<Multiplier>,
    /// Its equations.
    pub rows: Vec<Row>,
    /// Data that it introduces.
    pub data: Vec<NewData>,
    /// Levels and bounds at which it begins.
    pub start: Vec<Assignment>,
    /// Its indices.
    pub indices: Indices,
    /// Whether its multipliers are those of GAMS times -1, as the text has them.
    pub flipped: bool,
    /// What could not be written in symbols: equation and variable, and why.
    pub by_instance: Vec<String>,
    /// What else is to be said.
    pub notes: Vec<String>,
}

impl Formulation {
    /// The name of a variable.
    pub fn variable(&self, symbols: &Symbols, v: Variable) -> String {
        match v {
            Variable::Own(s) => symbols.get(s).name.to_string(),
            Variable::Multiplier(n) => self.multipliers[n].name.clone(),
        }
    }
}
