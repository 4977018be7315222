//! Linear mixed complementarity problems and their basis matrices.
//!
//! For Mx + q ⟂ l ≤ x ≤ u every index has three variables: x, w ≥ 0 complementary to x − l, and v ≥ 0
//! complementary to u − x, with Mx − w + v + q = 0. A basis takes one of the three for each index.

use feral::SparseColMatrix;

use super::basis::Sparse;
use super::factor::{Builder, Factor};
use super::merit::natural_residual;
use super::run::Run;

/// A linear mixed complementarity problem Mx + q ⟂ l ≤ x ≤ u.
pub(super) struct LinearProblem<'a> {
    pub(super) m: &'a SparseColMatrix,
    pub(super) q: &'a [f64],
    pub(super) lower: &'a [f64],
    pub(super) upper: &'a [f64],
}

impl LinearProblem<'_> {
    /// The column of a variable in the extended system.
    pub(super) fn column(&self, variable: Variable) -> Sparse {
        match variable.kind {
            Kind::AtLower => vec![(variable.index, -1.0)],
            Kind::AtUpper => vec![(variable.index, 1.0)],
            Kind::Between => {
                let (rows, values) = self.m.column(variable.index);
                rows.iter().copied().zip(values.iter().copied()).collect()
            }
        }
    }
}

/// Which variable of an index is basic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// x, between its bounds.
    Between,
    /// w: x is at its lower bound.
    AtLower,
    /// v: x is at its upper bound.
    AtUpper,
}

/// A variable of the extended system: x, w or v of an index.
#[derive(Debug, Clone, Copy)]
pub(super) struct Variable {
    pub(super) index: usize,
    pub(super) kind: Kind,
}

/// Factorises the matrix of the slots' columns.
pub(super) fn factorise(
    run: &mut Run,
    problem: &LinearProblem,
    slot: impl Iterator<Item = Variable>,
) -> Option<Factor> {
    run.factorisations += 1;
    let mut b = Builder::new(problem.q.len());
    for variable in slot {
        let column = problem.column(variable);
        column.into_iter().for_each(|(i, v)| b.push(i, v));
        b.end_column();
    }
    Factor::new(b.finish(), run.fill)
}

/// Whether y solves the linear problem, to a tolerance that says the path did not lie.
pub(super) fn solves(linear: &LinearProblem, y: &[f64]) -> bool {
    let mut f = vec![0.0; y.len()];
    linear.m.matvec(y, &mut f);
    f.iter_mut().zip(linear.q).for_each(|(f, q)| *f += q);
    let scale = y.iter().fold(1.0f64, |a, v| a.max(v.abs()));
    natural_residual(y, &f, linear.lower, linear.upper).0 <= 1e-6 * scale
}
