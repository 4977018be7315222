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

use super::problem::{Nlp, ObjectiveForm, Problem};
use super::provider::{Ended, Solution};
use crate::autodiff::Degree;
use crate::solve::lp::form::{self, Sparse};
use crate::solve::lp::interior::{self, Aim};
use crate::solve::lp::{self, Limits};
use faer::Side;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};

/// What the shift of the diagonal is to the largest entry of H.
const SHIFT: f64 = 1e-12;
/// Clarabel's tolerance; the active set found there is solved for afterwards.
const TOLERANCE: f64 = 1e-9;

/// A convex quadratic program.
#[derive(Debug)]
pub struct Quadratic {
    linear: form::Problem,
    /// Upper triangle of H by columns.
    hessian: Sparse,
}

impl Quadratic {
    /// Takes a problem apart; None where it is none of the kind.
    pub fn new(problem: &mut Problem) -> Option<Self> {
        let ObjectiveForm::Row { row, .. } = problem.form() else {
            return None;
        };
        let degrees = problem.evaluator().degrees();
        let linear = |&i: &u32| degrees[i as usize] == Degree::Linear;
        if degrees[row] != Degree::Quadratic || !problem.rows.iter().all(linear) {
            return None;
        }
        let (n, m) = problem.size();
        let origin = vec![0.0; n];
        let entries = hessian(problem, &origin)?;
        if !is_semidefinite(n, &entries) {
            return None;
        }
        let mut cost = vec![0.0; n];
        problem.gradient(&origin, &mut cost)?;
        let mut constant = vec![0.0; m];
        problem.constraints(&origin, &mut constant)?;
        let rows = jacobian(problem, &origin)?;
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
            linear,
            hessian: by_columns(n, &entries),
        })
    }

    /// Runs Clarabel. Multipliers λ as in L = f + λᵀg.
    pub fn solve(&self, limits: &Limits, interrupted: &mut dyn FnMut() -> bool) -> Solution {
        let hessian = Some(&self.hessian);
        let run = interior::solve(
            &self.linear,
            hessian,
            Aim::Tolerance(TOLERANCE),
            limits,
            interrupted,
        );
        Solution {
            ended: match run.ended {
                lp::Ended::Solved => Ended::Solved,
                lp::Ended::Infeasible(_) => Ended::Infeasible,
                lp::Ended::Unbounded(_) => Ended::Diverging,
                lp::Ended::Iterations => Ended::Iterations,
                lp::Ended::Time => Ended::Time,
                lp::Ended::Interrupted => Ended::Stopped,
                lp::Ended::Failed => Ended::Failed,
            },
            x: run.point.x,
            lambda: run.point.y.iter().map(|y| -y).collect(),
            objective: f64::NAN,
            iterations: run.iterations,
        }
    }
}

/// Row, column (row ≥ column) and value of what is not zero in H.
fn hessian(problem: &mut Problem, x: &[f64]) -> Option<Vec<(usize, usize, f64)>> {
    let (rows, columns) = problem.hessian_pattern();
    let place: Vec<(u32, u32)> = rows.iter().copied().zip(columns.iter().copied()).collect();
    let mut value = vec![0.0; place.len()];
    let multipliers = vec![0.0; problem.size().1];
    problem.hessian(x, 1.0, &multipliers, &mut value)?;
    let all = place.iter().zip(value).filter(|(_, v)| *v != 0.0);
    Some(
        all.map(|(&(i, j), v)| (i as usize, j as usize, v))
            .collect(),
    )
}

fn jacobian(problem: &mut Problem, x: &[f64]) -> Option<Sparse> {
    let (rows, columns) = problem.jacobian_pattern();
    let place: Vec<(u32, u32)> = rows.iter().copied().zip(columns.iter().copied()).collect();
    let mut value = vec![0.0; place.len()];
    problem.jacobian(x, &mut value)?;
    let mut out = Sparse::new();
    let mut k = 0;
    for i in 0..problem.size().1 {
        let end = k + place[k..].partition_point(|&(r, _)| r as usize <= i);
        out.push((k..end).map(|k| (place[k].1 as usize, value[k])));
        k = end;
    }
    Some(out)
}

/// The upper triangle by columns, rows increasing.
fn by_columns(n: usize, lower: &[(usize, usize, f64)]) -> Sparse {
    // Row i of the lower triangle is column i of the upper one.
    let mut entries = lower.to_vec();
    entries.sort_unstable_by_key(|&(i, j, _)| (i, j));
    let mut out = Sparse::new();
    let mut lines = entries.chunk_by(|a, b| a.0 == b.0).peekable();
    for i in 0..n {
        let line = lines.next_if(|l| l[0].0 == i).unwrap_or_default();
        out.push(line.iter().map(|&(_, j, v)| (j, v)));
    }
    out
}

fn is_semidefinite(n: usize, lower: &[(usize, usize, f64)]) -> bool {
    let top = lower.iter().fold(0.0f64, |t, e| t.max(e.2.abs()));
    if !top.is_finite() {
        return false;
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
