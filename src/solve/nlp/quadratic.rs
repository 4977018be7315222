//! Convex quadratic programs: Clarabel instead of a general method.
//!
//! ```text
//!     min  ½ xᵀHx + cᵀx    subject to    a ≤ A x ≤ b,   l ≤ x ≤ u
//! ```
//!
//! with H positive semidefinite: every point that satisfies the KKT conditions is a global minimum, so
//! the certified point is optimal and not just locally so. Degree two and linearity of the rows are
//! read off the kernels; H ⪰ 0 is shown by a Cholesky factorisation of H + εI, with
//! ε = 1e-12 · max |H|, which is below what the evaluation of H is good for. A programme for which
//! this fails, for whatever reason, is one for the general method.

use super::interior_point::{Ended, Solution};
use super::problem::{Entry, ObjectiveForm, Problem};
use crate::autodiff::Degree;
use crate::solve::Budget;
use crate::solve::backend::QuadraticEngine;
use crate::solve::factor_size::symmetric_size;
use crate::solve::lp;
use crate::solve::lp::form::{self, Sparse};
use faer::Side;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};

/// What the shift of the diagonal is to the largest entry of H.
const SHIFT: f64 = 1e-12;

/// Tolerances of the engine, relative to the whole program: where small terms miss the certificate's with one, the next follows.
pub(super) const TOLERANCES: [f64; 2] = [1e-9, 1e-12];

/// A convex quadratic program.
#[derive(Debug)]
pub struct Quadratic {
    engine: QuadraticEngine,
    linear: form::Problem,
    /// Upper triangle of H by columns.
    hessian: Sparse,
}

impl Quadratic {
    /// Takes a problem apart; None where it is none of the kind.
    pub fn new(problem: &mut Problem, engine: QuadraticEngine, budget: &Budget) -> Option<Self> {
        let ObjectiveForm::Row { row, .. } = problem.form else {
            return None;
        };
        let degrees = problem.evaluator.degrees();
        let linear = |&i: &u32| degrees[i as usize] == Degree::Linear;
        if degrees[row] != Degree::Quadratic || !problem.rows.iter().all(linear) {
            return None;
        }
        let (n, m) = problem.size();
        let origin = vec![0.0; n];
        let mut entries = problem.hessian_entries(&origin, &vec![0.0; m])?;
        entries.retain(|e| e.2 != 0.0);
        let pattern = || entries.iter().map(|e| (e.0, e.1)).filter(|(i, j)| i != j);
        let size = || symmetric_size("the factor of the Hessian", n, pattern());
        if budget.affords(size).is_err() || !is_semidefinite(n, &entries) {
            return None;
        }
        let mut cost = vec![0.0; n];
        problem.gradient(&origin, &mut cost)?;
        let mut constant = vec![0.0; m];
        problem.constraints(&origin, &mut constant)?;
        let rows = by_rows(m, &problem.jacobian_entries(&origin)?);
        // row i of the lower triangle is column i of the upper one
        entries.sort_unstable_by_key(|&(i, j, _)| (i, j));
        let (lower, upper) = problem.bounds();
        let (row_lower, row_upper) = problem.sides();
        let less = |side: &[f64]| side.iter().zip(&constant).map(|(s, c)| s - c).collect();
        let linear = form::Problem {
            cost,
            lower: lower.to_vec(),
            upper: upper.to_vec(),
            row_lower: less(row_lower),
            row_upper: less(row_upper),
            columns: rows.transpose(n),
            rows,
            offset: 0.0,
        };
        Some(Self {
            engine,
            linear,
            hessian: by_rows(n, &entries),
        })
    }

    /// Name of the engine.
    pub fn name(&self) -> &'static str {
        self.engine.name
    }

    /// Runs the engine. Multipliers λ as in L = f + λᵀg.
    pub fn solve(&self, tolerance: f64, budget: &Budget) -> Solution {
        let (linear, hessian) = (&self.linear, &self.hessian);
        let run = (self.engine.solve)(linear, hessian, tolerance, budget);
        Solution {
            ended: match run.ended {
                lp::Ended::Solved => Ended::Solved,
                lp::Ended::Infeasible(_) => Ended::Infeasible,
                lp::Ended::Unbounded(_) => Ended::Diverging,
                lp::Ended::Iterations => Ended::Iterations,
                lp::Ended::Time => Ended::Time,
                lp::Ended::Interrupted => Ended::Stopped,
                lp::Ended::Failed | lp::Ended::TooLarge(_) => Ended::Failed,
            },
            x: run.point.x,
            lambda: run.point.y.iter().map(|y| -y).collect(),
            iterations: run.iterations,
        }
    }
}

/// The point nearest to x that is within the bounds and satisfies the linear rows. None: there is none, or it was not found.
pub(super) fn nearest(problem: &mut Problem, x: &[f64], budget: &Budget) -> Option<Vec<f64>> {
    let degrees = problem.evaluator.degrees();
    let linear = |&i: &u32| degrees[i as usize] == Degree::Linear;
    let linear: Vec<bool> = problem.rows.iter().map(linear).collect();
    let (n, m) = problem.size();
    let mut values = vec![0.0; m];
    problem.constraints(x, &mut values)?;
    let mut entries = problem.jacobian_entries(x)?;
    entries.retain(|e| linear[e.0]);
    let rows = by_rows(m, &entries);
    // in steps from x
    let less = |side: &[f64], by: &[f64]| side.iter().zip(by).map(|(s, v)| s - v).collect();
    let ((lower, upper), (row_lower, row_upper)) = (problem.bounds(), problem.sides());
    let mut steps = form::Problem {
        cost: vec![0.0; n],
        lower: less(lower, x),
        upper: less(upper, x),
        row_lower: less(row_lower, &values),
        row_upper: less(row_upper, &values),
        columns: rows.transpose(n),
        rows,
        offset: 0.0,
    };
    for i in (0..m).filter(|&i| !linear[i]) {
        (steps.row_lower[i], steps.row_upper[i]) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    let identity: Vec<Entry> = (0..n).map(|j| (j, j, 1.0)).collect();
    let run = (lp::QUADRATIC.solve)(&steps, &by_rows(n, &identity), TOLERANCES[0], budget);
    let inside = |(x, (d, (l, u))): (&f64, (f64, (&f64, &f64)))| (x + d).max(*l).min(*u);
    let bounds = lower.iter().zip(upper);
    (run.ended == lp::Ended::Solved).then(|| {
        let steps = run.point.x.into_iter();
        x.iter().zip(steps.zip(bounds)).map(inside).collect()
    })
}

/// Rows from entries ordered by row.
pub(super) fn by_rows(m: usize, entries: &[Entry]) -> Sparse {
    let mut out = Sparse::default();
    let mut lines = entries.chunk_by(|a, b| a.0 == b.0).peekable();
    for i in 0..m {
        let line = lines.next_if(|l| l[0].0 == i).unwrap_or_default();
        out.push(line.iter().map(|&(_, j, v)| (j, v)));
    }
    out
}

/// Whether a symmetric matrix, given by the entries of its lower triangle, is positive semidefinite.
pub fn is_semidefinite(n: usize, lower: &[Entry]) -> bool {
    let top = lower.iter().fold(0.0f64, |t, e| t.max(e.2.abs()));
    if !top.is_finite() || top == 0.0 {
        return top == 0.0;
    }
    let entries = lower.iter().map(|&(i, j, v)| Triplet::new(i, j, v));
    let shift = (0..n).map(|i| Triplet::new(i, i, SHIFT * top));
    let triplets: Vec<_> = entries.chain(shift).collect();
    let Ok(matrix) = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &triplets) else {
        return false;
    };
    let Ok(symbolic) = SymbolicLlt::try_new(matrix.symbolic(), Side::Lower) else {
        return false;
    };
    Llt::try_new_with_symbolic(symbolic, matrix.as_ref(), Side::Lower).is_ok()
}
