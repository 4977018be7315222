//! Instances written in Rust: columns, rows, and nonlinear terms as expressions with operators.

use super::instance::{Function, Instance, Kernel, KernelTerms, Objective, Op, Relation, Sense};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A nonlinear expression in the columns of an [`Instance`].
///
/// ```
/// use bmod::solver::Term;
///
/// let (x, y) = (Term::column(0), Term::column(1));
/// let rosenbrock = (1.0 - x.clone()).powi(2) + 100.0 * (y - x.powi(2)).powi(2);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Term {
    /// The program, in postfix form.
    pub(crate) ops: Vec<Op>,
    /// Column of each variable slot.
    pub(crate) columns: Vec<u32>,
    /// Value of each constant slot.
    pub(crate) constants: Vec<f64>,
}

impl Term {
    /// The level of a column.
    pub fn column(column: usize) -> Self {
        Self {
            ops: vec![Op::Var(0)],
            columns: vec![column as u32],
            constants: Vec::new(),
        }
    }

    /// A number.
    pub fn constant(value: f64) -> Self {
        Self {
            ops: vec![Op::Const(0)],
            columns: Vec::new(),
            constants: vec![value],
        }
    }

    /// A whole power.
    pub fn powi(mut self, exponent: i32) -> Self {
        self.ops.push(Op::PowerInt(exponent));
        self
    }

    /// A function of expressions, as many as it has arguments.
    pub fn call(function: Function, arguments: impl IntoIterator<Item = Term>) -> Self {
        let (mut out, mut count) = (Self::default(), 0);
        for argument in arguments {
            out.append(argument);
            count += 1;
        }
        out.ops.push(Op::Call(function, count));
        out
    }

    /// Appends a program; its slots come after those that are there.
    pub(crate) fn append(&mut self, other: Self) {
        let (v, c) = (self.columns.len() as u32, self.constants.len() as u32);
        let ops = other.ops.into_iter().map(|op| op.moved(v, c));
        self.ops.extend(ops);
        self.columns.extend(other.columns);
        self.constants.extend(other.constants);
    }

    /// Appends an operation of another program, with slots of its own.
    pub(crate) fn copy(&mut self, whole: &Self, op: Op) {
        let (v, c) = (self.columns.len() as u32, self.constants.len() as u32);
        self.ops.push(match op {
            Op::Var(k) => {
                self.columns.push(whole.columns[k as usize]);
                Op::Var(v)
            }
            Op::Const(k) => {
                self.constants.push(whole.constants[k as usize]);
                Op::Const(c)
            }
            Op::Affine(constant, variable, terms) => {
                let (first, x, n) = (constant as usize, variable as usize, terms as usize);
                self.constants.extend(&whole.constants[first..=first + n]);
                self.columns.extend(&whole.columns[x..x + n]);
                Op::Affine(c, v, terms)
            }
            op => op,
        });
    }

    /// The expression with slots.
    pub(crate) fn kernel(&self) -> Kernel {
        Kernel {
            ops: self.ops.clone(),
            variables: self.columns.len() as u32,
            constants: self.constants.len() as u32,
        }
    }

    fn then(mut self, other: impl Into<Self>, ops: &[Op]) -> Self {
        self.append(other.into());
        self.ops.extend(ops);
        self
    }
}

impl From<f64> for Term {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

macro_rules! operators {
    ($($name:ident $method:ident $ops:expr),*) => {$(
        impl<T: Into<Term>> $name<T> for Term {
            type Output = Term;
            fn $method(self, other: T) -> Term {
                self.then(other, &$ops)
            }
        }

        impl $name<Term> for f64 {
            type Output = Term;
            fn $method(self, other: Term) -> Term {
                Term::constant(self).then(other, &$ops)
            }
        }
    )*};
}

operators!(Add add [Op::Add(2)], Sub sub [Op::Negate, Op::Add(2)], Mul mul [Op::Multiply(2)], Div div [Op::Divide]);

impl Neg for Term {
    type Output = Term;

    fn neg(mut self) -> Term {
        self.ops.push(Op::Negate);
        self
    }
}

/// An instance is built column by column and row by row; rows and columns are numbered from 0 in the order in which they
/// are added.
///
/// ```
/// use bmod::solver::{Term, Instance, Relation, Sense};
///
/// // min z, z = (x − 1)² + y, x + y ≥ 2, y ≥ 0
/// let mut instance = Instance::default();
/// let z = instance.add_column(f64::NEG_INFINITY, f64::INFINITY, 0.0);
/// let x = instance.add_column(f64::NEG_INFINITY, f64::INFINITY, 1.0);
/// let y = instance.add_column(0.0, f64::INFINITY, 1.0);
/// let objective = instance.add_row([(z, 1.0), (y, -1.0)], Relation::Equal, 0.0);
/// instance.add_term(objective, -1.0, (Term::column(x) - 1.0).powi(2));
/// instance.add_row([(x, 1.0), (y, 1.0)], Relation::Greater, 2.0);
/// instance.set_objective(z, Sense::Minimize);
/// assert_eq!((instance.row_count(), instance.column_count()), (2, 3));
/// ```
impl Instance {
    /// Appends a continuous column with these bounds, which may be infinite, and its level at the start. Its number.
    pub fn add_column(&mut self, lower: f64, upper: f64, level: f64) -> usize {
        let column = self.columns.push(lower, upper);
        self.columns.level[column] = level;
        column
    }

    /// Appends a row of linear terms; terms in one column are added up. Its number.
    pub fn add_row(
        &mut self,
        terms: impl IntoIterator<Item = (usize, f64)>,
        relation: Relation,
        rhs: f64,
    ) -> usize {
        let mut terms: Vec<(usize, f64)> = terms.into_iter().collect();
        terms.sort_by_key(|t| t.0);
        if self.matrix.start.is_empty() {
            self.matrix.start.push(0);
        }
        for same in terms.chunk_by(|a, b| a.0 == b.0) {
            let sum: f64 = same.iter().map(|t| t.1).sum();
            if sum != 0.0 {
                self.matrix.column.push(same[0].0 as u32);
                self.matrix.value.push(sum);
            }
        }
        self.matrix.start.push(self.matrix.column.len());
        self.rows.relation.push(relation);
        self.rows.rhs.push(rhs);
        self.rows.marginal.push(0.0);
        self.rows.scale.push(1.0);
        self.rows.rhs.len() - 1
    }

    /// Adds a coefficient times an expression to the left side of a row.
    pub fn add_term(&mut self, row: usize, coefficient: f64, term: Term) {
        let kernel = term.kernel();
        let place = self.nonlinear.iter().position(|t| t.kernel == kernel);
        let place = place.unwrap_or_else(|| {
            self.nonlinear.push(KernelTerms::new(kernel));
            self.nonlinear.len() - 1
        });
        self.nonlinear[place].push(row as u32, coefficient, &term.columns, &term.constants);
    }

    /// What is minimised or maximised: the level of a column, which a row may define.
    pub fn set_objective(&mut self, column: usize, sense: Sense) {
        self.objective = Some(Objective {
            column: column as u32,
            sense,
        });
    }

    /// Pairs a row with a column, for complementarity problems and equilibrium constraints.
    pub fn pair(&mut self, row: usize, column: usize) {
        let columns = self.column_count();
        let matched = self.matched.get_or_insert_default();
        matched.resize(columns, None);
        matched[column] = Some(row as u32);
    }
}
