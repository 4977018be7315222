//! The sparse model IR: what `solve` hands to a solver.
//!
//! Columns and rows are structs of arrays; the linear part is one compressed sparse matrix; the
//! nonlinear part is a list of [`Kernel`]s, one expression with slots, each with arrays of the
//! columns and constants that fill the slots.
//!
//! Row i reads  `sum_j matrix[i][j]·x_j + sum_t coef_t·kernel_t(x, c)  (= | >= | <= | free)  rhs_i`.
//!
//! Invariants: column indices in a matrix row are strictly increasing and no stored coefficient is
//! 0; all coefficients and right-hand sides are finite; solvers see no names.

pub use super::function::Function;
use super::named::named;
/// −∞ as used in bounds.
pub const NEG_INF: f64 = f64::NEG_INFINITY;
/// +∞ as used in bounds.
pub const INF: f64 = f64::INFINITY;

named! {
    /// `=e=`, `=g=`, `=l=`, `=n=`.
    pub enum Relation {
        /// Equal.
        Equal "=e=";
        /// Left side at least the right.
        Greater "=g=";
        /// Left side at most the right.
        Less "=l=";
        /// No relation.
        Free "=n=";
    }
}

impl Relation {
    /// Lower and upper bound of a left side whose right side is this.
    pub fn bounds(self, rhs: f64) -> [f64; 2] {
        match self {
            Self::Equal => [rhs, rhs],
            Self::Greater => [rhs, f64::INFINITY],
            Self::Less => [f64::NEG_INFINITY, rhs],
            Self::Free => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }
}

/// Bounds from here on are infinite.
pub const INFINITE: f64 = 1e30;

named! {
    /// Direction of a solve.
    pub enum Sense {
        /// `minimizing`
        Minimize "min";
        /// `maximizing`
        Maximize "max";
    }
}

/// As its name.
impl serde::Serialize for Sense {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.name())
    }
}

impl Sense {
    /// What the objective is multiplied by to make the problem a minimum.
    pub fn sign(self) -> f64 {
        match self {
            Self::Minimize => 1.0,
            Self::Maximize => -1.0,
        }
    }
}

/// Kind of a column.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum ColumnKind {
    /// Continuous.
    #[default]
    Continuous,
    /// Binary or integer.
    Integer,
    /// Zero, or within its bounds; the stored lower bound is not above 0.
    SemiContinuous,
    /// Zero, or an integer within its bounds; the stored lower bound is not above 0.
    SemiInteger,
    /// Member of a special ordered set.
    OrderedSet,
}

/// Columns, one entry per variable.
#[derive(Clone, Default, Debug)]
pub struct Columns {
    /// Lower bounds, −∞ allowed.
    pub lower: Vec<f64>,
    /// Upper bounds, +∞ allowed.
    pub upper: Vec<f64>,
    /// Start level (where the last solve left it), not necessarily within bounds.
    pub level: Vec<f64>,
    /// Start marginal.
    pub marginal: Vec<f64>,
    /// `.scale` (1 unless `scaleopt` is on).
    pub scale: Vec<f64>,
    /// Kind.
    pub kind: Vec<ColumnKind>,
}

impl Columns {
    /// The first column that bounds leave a discrete choice: a relaxation is no solution for it.
    pub fn first_undecided(&self) -> Option<usize> {
        (0..self.kind.len())
            .find(|&j| self.kind[j] != ColumnKind::Continuous && self.lower[j] < self.upper[j])
    }

    /// Appends a continuous column at level 0; its number.
    pub fn push(&mut self, lower: f64, upper: f64) -> usize {
        self.lower.push(lower);
        self.upper.push(upper);
        self.level.push(0.0);
        self.marginal.push(0.0);
        self.scale.push(1.0);
        self.kind.push(ColumnKind::Continuous);
        self.lower.len() - 1
    }
}

/// Columns of which only some may be nonzero, in their order.
#[derive(Clone, Default, Debug, PartialEq)]
pub struct OrderedSet {
    /// Two neighbours may be nonzero (`sos2`), not just one (`sos1`).
    pub neighbours: bool,
    /// Members.
    pub columns: Vec<u32>,
}

/// What the kinds of columns leave open. Empty for a program without discrete columns.
#[derive(Clone, Default, Debug)]
pub struct Discrete {
    /// Semicontinuous columns: the least value other than 0.
    pub thresholds: Vec<(u32, f64)>,
    /// Special ordered sets.
    pub sets: Vec<OrderedSet>,
    /// Branching priority of each column, the least first; empty where all are 1.
    pub priorities: Vec<f64>,
}

/// Rows, one entry per equation.
#[derive(Clone, Default, Debug)]
pub struct Rows {
    /// Relation.
    pub relation: Vec<Relation>,
    /// Right-hand side: all constants moved to the right.
    pub rhs: Vec<f64>,
    /// Start marginal.
    pub marginal: Vec<f64>,
    /// `.scale`.
    pub scale: Vec<f64>,
}

/// A matrix compressed by rows.
#[derive(Clone, Default, Debug)]
pub struct SparseRows {
    /// Row i is `start[i]..start[i+1]`; length rows + 1.
    pub start: Vec<usize>,
    /// Columns, increasing within a row.
    pub column: Vec<u32>,
    /// Coefficients.
    pub value: Vec<f64>,
}

impl SparseRows {
    /// Entries of row i.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let r = self.start[i]..self.start[i + 1];
        self.column[r.clone()]
            .iter()
            .map(|&j| j as usize)
            .zip(self.value[r].iter().copied())
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.start.len().saturating_sub(1)
    }
}

/// One step of a kernel: a program in postfix order on a stack of numbers.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Op {
    /// Pushes the variable in slot k.
    Var(u32),
    /// Pushes the constant in slot k.
    Const(u32),
    /// Pushes `const[k] + sum_{m<n} const[k+1+m]·var[v+m]`, an affine form: k, v and n.
    Affine(u32, u32, u32),
    /// Pops n values; pushes their sum.
    Add(u32),
    /// Pops n values; pushes their product.
    Multiply(u32),
    /// Pops b, a; pushes a / b.
    Divide,
    /// Pops a; pushes −a.
    Negate,
    /// Pops b, a; pushes a ** b (real power, a >= 0).
    Power,
    /// Pops a; pushes a to the whole number k.
    PowerInt(i32),
    /// Pops the function's arguments (first pushed first); pushes its value.
    Call(Function, u32),
}

impl Op {
    /// How many values it pops.
    pub fn arguments(self) -> usize {
        match self {
            Self::Var(_) | Self::Const(_) | Self::Affine(..) => 0,
            Self::Negate | Self::PowerInt(_) => 1,
            Self::Divide | Self::Power => 2,
            Self::Add(n) | Self::Multiply(n) | Self::Call(_, n) => n as usize,
        }
    }

    /// The same with slots that many further on.
    pub(crate) fn moved(self, variables: u32, constants: u32) -> Self {
        match self {
            Self::Var(k) => Self::Var(k + variables),
            Self::Const(k) => Self::Const(k + constants),
            Self::Affine(constant, variable, terms) => {
                Self::Affine(constant + constants, variable + variables, terms)
            }
            op => op,
        }
    }
}

/// One expression with slots.
#[derive(Clone, PartialEq, Eq, Hash, Default, Debug)]
pub struct Kernel {
    /// The program. Leaves exactly one value.
    pub ops: Vec<Op>,
    /// Number of variable slots; two slots of one term may hold the same column.
    pub variables: u32,
    /// Number of constant slots.
    pub constants: u32,
}

/// All terms that share a kernel: term t is `coef[t] · kernel(x[columns[t·v ..]], constants[t·c ..])` in row `row[t]`.
#[derive(Clone, Default, Debug)]
pub struct KernelTerms {
    /// The expression.
    pub kernel: Kernel,
    /// Row of each term.
    pub row: Vec<u32>,
    /// Coefficient of each term.
    pub coef: Vec<f64>,
    /// Columns, `kernel.variables` per term.
    pub columns: Vec<u32>,
    /// Constants, `kernel.constants` per term.
    pub constants: Vec<f64>,
}

impl KernelTerms {
    /// No terms with this expression yet.
    pub(crate) fn new(kernel: Kernel) -> Self {
        Self {
            kernel,
            ..Self::default()
        }
    }

    /// Adds a term.
    pub(crate) fn push(&mut self, row: u32, coef: f64, columns: &[u32], constants: &[f64]) {
        self.row.push(row);
        self.coef.push(coef);
        self.columns.extend_from_slice(columns);
        self.constants.extend_from_slice(constants);
    }

    /// A term by its number.
    pub(crate) fn term(&self, t: usize) -> KernelTerm<'_> {
        let (v, c) = (
            self.kernel.variables as usize,
            self.kernel.constants as usize,
        );
        KernelTerm {
            row: self.row[t] as usize,
            coef: self.coef[t],
            columns: &self.columns[t * v..(t + 1) * v],
            constants: &self.constants[t * c..(t + 1) * c],
        }
    }

    /// All terms in order.
    pub(crate) fn terms(&self) -> impl Iterator<Item = KernelTerm<'_>> {
        (0..self.row.len()).map(|t| self.term(t))
    }
}

/// What fills the slots of a kernel, and where it stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KernelTerm<'a> {
    /// Its row.
    pub row: usize,
    /// Its coefficient.
    pub coef: f64,
    /// Column of each variable slot.
    pub columns: &'a [u32],
    /// Value of each constant slot.
    pub constants: &'a [f64],
}

/// What is minimised or maximised: the level of one column.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Objective {
    /// The objective variable.
    pub column: u32,
    /// Direction.
    pub sense: Sense,
}

/// A model instance.
#[derive(Clone, Default, Debug)]
pub struct Instance {
    /// Variables.
    pub columns: Columns,
    /// Equations.
    pub rows: Rows,
    /// Linear part.
    pub matrix: SparseRows,
    /// Nonlinear part.
    pub nonlinear: Vec<KernelTerms>,
    /// Objective; None for mcp and cns.
    pub objective: Option<Objective>,
    /// For mcp and mpec: per column the row it is matched with, if any.
    pub matched: Option<Vec<Option<u32>>>,
    /// Thresholds, ordered sets and priorities of discrete columns.
    pub discrete: Discrete,
}

impl Instance {
    /// Number of columns.
    pub fn column_count(&self) -> usize {
        self.columns.lower.len()
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.rows.rhs.len()
    }

    /// All nonlinear terms.
    pub(crate) fn terms(&self) -> impl Iterator<Item = KernelTerm<'_>> {
        self.nonlinear.iter().flat_map(KernelTerms::terms)
    }

    /// Row and column of the places where nonlinear terms stand, each once, in order.
    pub(crate) fn nonlinear_places(&self) -> Vec<(u32, u32)> {
        let mut places = Vec::new();
        for t in self.terms() {
            places.extend(t.columns.iter().map(|&j| (t.row as u32, j)));
        }
        places.sort_unstable();
        places.dedup();
        places
    }

    /// By row: whether a nonlinear term stands in it.
    pub fn nonlinear_rows(&self) -> Vec<bool> {
        let mut out = vec![false; self.row_count()];
        for &i in self.nonlinear.iter().flat_map(|k| &k.row) {
            out[i as usize] = true;
        }
        out
    }

    /// The row in which the objective column stands, and its coefficient there, if it stands in no other and in no
    /// nonlinear term: where that row is an equation and the column is free, the column need not be solved for.
    pub fn objective_row(&self) -> Option<(usize, f64)> {
        let z = self.objective?.column;
        if self.nonlinear.iter().any(|t| t.columns.contains(&z)) {
            return None;
        }
        let matrix = &self.matrix;
        let mut places = (0..self.row_count()).filter_map(|i| {
            let entries = matrix.start[i]..matrix.start[i + 1];
            let k = matrix.column[entries.clone()].binary_search(&z).ok()?;
            Some((i, matrix.value[entries.start + k]))
        });
        let first = places.next().filter(|(_, a)| *a != 0.0)?;
        places.next().is_none().then_some(first)
    }

    /// Whether nothing bounds a column.
    pub fn is_free(&self, column: usize) -> bool {
        let (lower, upper) = (self.columns.lower[column], self.columns.upper[column]);
        lower <= -INFINITE && upper >= INFINITE
    }

    /// What the objective is multiplied by to make the problem a minimum; 1 without an objective.
    pub fn sign(&self) -> f64 {
        self.objective.map_or(1.0, |o| o.sense.sign())
    }

    /// Whether there is no nonlinear term.
    pub fn is_linear(&self) -> bool {
        self.nonlinear.iter().all(|k| k.row.is_empty())
    }
}
