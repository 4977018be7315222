//! Linear mixed complementarity problems and their basis matrices.
//!
//! For Mx + q ⟂ l ≤ x ≤ u every index has three variables: x, w ≥ 0 complementary to x − l, and v ≥ 0
//! complementary to u − x, with Mx − w + v + q = 0. A basis takes one of the three for each index.

use feral::SparseColMatrix;

use super::basis::Basis;
use super::factor::Builder;
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
    pub(super) fn column(&self, variable: Variable) -> impl Iterator<Item = (usize, f64)> + '_ {
        let index = variable.index;
        let (slack, (rows, values)) = match variable.kind {
            Kind::AtLower => (Some((index, -1.0)), (&[][..], &[][..])),
            Kind::AtUpper => (Some((index, 1.0)), (&[][..], &[][..])),
            Kind::Between => (None, self.m.column(index)),
        };
        let own = rows.iter().copied().zip(values.iter().copied());
        slack.into_iter().chain(own)
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
    slot: &[Variable],
) -> Option<Basis> {
    run.factorisations += 1;
    let mut b = Builder::new(slot.len());
    for &v in slot {
        problem.column(v).for_each(|(i, x)| b.push(i, x));
        b.end_column();
    }
    Basis::new(&b.finish(), run.fill)
}

/// Solves with the basis, refines once, and checks the residual.
pub(super) fn solve_refined(
    basis: &mut Basis,
    problem: &LinearProblem,
    slot: &[Variable],
    b: &mut [f64],
) -> bool {
    let right = b.to_vec();
    if !basis.solve(b) {
        return false;
    }
    let norm = right.iter().fold(0.0f64, |a, v| a.max(v.abs()));
    for step in 0..2 {
        let mut residual = right.clone();
        for (&v, &value) in slot.iter().zip(b.iter()) {
            let column = problem.column(v);
            column.for_each(|(i, m)| residual[i] -= m * value);
        }
        let worst = residual.iter().fold(0.0f64, |a, v| {
            if v.is_nan() {
                f64::INFINITY
            } else {
                a.max(v.abs())
            }
        });
        if worst <= 1e-15 * norm {
            return true;
        }
        if step == 1 || !basis.solve(&mut residual) {
            return worst <= 1e-6 * norm.max(1e-300);
        }
        b.iter_mut().zip(&residual).for_each(|(x, d)| *x += d);
    }
    true
}

/// Whether y solves the linear problem, to a tolerance that says the path did not lie.
pub(super) fn solves(linear: &LinearProblem, y: &[f64]) -> bool {
    let mut f = vec![0.0; y.len()];
    linear.m.matvec(y, &mut f);
    f.iter_mut().zip(linear.q).for_each(|(f, q)| *f += q);
    let scale = y.iter().fold(1.0f64, |a, v| a.max(v.abs()));
    natural_residual(y, &f, linear.lower, linear.upper).0 <= 1e-6 * scale
}
