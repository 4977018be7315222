//! Factors of the symmetric systems around an active set: `feral`'s LDLᵀ with Bunch–Kaufman pivots.
//!
//! A KKT matrix has dense columns as soon as one variable stands in every row, the length of a time
//! step say; a symmetric ordering puts them last, where an LU ordered for AᵀA fills up. The signs of
//! the pivots are those of the eigenvalues.

use feral::{CscMatrix, FactorStatus, Solver};

/// Order from which on pivots that are rounding, beside the largest entry of the scaled matrix, become this large, which refinement makes
/// good: each would otherwise be put off until a dense row is reached, and all together fill a square.
const MANY: usize = 1000;
const LEAST_PIVOT: f64 = 1e-12;

/// A symmetric matrix and its factors.
pub(super) struct Symmetric {
    matrix: CscMatrix,
    solver: Solver,
}

/// Entries (row, column, value) with row ≥ column; those of the same place add up.
#[derive(Clone, Default)]
pub(super) struct Lower {
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl Lower {
    /// Adds an entry of either triangle.
    pub(super) fn push(&mut self, i: usize, j: usize, value: f64) {
        self.rows.push(i.max(j));
        self.columns.push(i.min(j));
        self.values.push(value);
    }
}

impl Symmetric {
    /// Factors a matrix of order n; None if it is singular or not finite.
    pub(super) fn new(n: usize, lower: &Lower) -> Option<Self> {
        let mut out = Self::empty();
        out.factor(n, lower).then_some(out)
    }

    /// Without a matrix.
    pub(super) fn empty() -> Self {
        Self {
            matrix: CscMatrix {
                n: 0,
                col_ptr: vec![0],
                row_idx: Vec::new(),
                values: Vec::new(),
            },
            solver: solver(0),
        }
    }

    /// Factors a matrix of order n, in the order that was found for the last one if the places are the same. Whether it is regular
    /// and finite; otherwise there are no factors.
    pub(super) fn factor(&mut self, n: usize, lower: &Lower) -> bool {
        let entries = (&lower.rows, &lower.columns, &lower.values);
        if n != self.matrix.n {
            self.solver = solver(n);
        }
        let finite = lower.values.iter().all(|v| v.is_finite());
        match CscMatrix::from_triplets(n, entries.0, entries.1, entries.2) {
            Ok(matrix) if finite => self.matrix = matrix,
            _ => return false,
        }
        matches!(
            self.solver.factor(&self.matrix, None),
            FactorStatus::Success
        )
    }

    /// A⁻¹b, refined; None if it is not finite.
    pub(super) fn solve(&self, b: &[f64]) -> Option<Vec<f64>> {
        let x = self.solver.solve_refined(&self.matrix, b).ok()?;
        x.iter().all(|v| v.is_finite()).then_some(x)
    }

    /// Numbers of positive and negative eigenvalues.
    pub(super) fn inertia(&self) -> Option<(usize, usize)> {
        let i = self.solver.inertia()?;
        Some((i.positive, i.negative))
    }
}

/// A solver for matrices of this order.
fn solver(n: usize) -> Solver {
    // One thread: the same digits on every machine.
    let solver = Solver::new().with_parallel(false);
    match n >= MANY {
        true => solver.with_static_pivot_threshold(LEAST_PIVOT),
        false => solver,
    }
}
