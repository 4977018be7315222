//! Factors of the symmetric systems around an active set: `feral`'s LDLᵀ with Bunch–Kaufman pivots.
//!
//! A KKT matrix has dense columns as soon as one variable stands in every row, the length of a time
//! step say; a symmetric ordering puts them last, where an LU ordered for AᵀA fills up. The signs of
//! the pivots are those of the eigenvalues.

use super::polish::number;
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

/// The places of free variables and held rows in a KKT matrix \[H Jᵀ; J 0\]. Where they are most of it, what is not free or held has a place
/// as well, with a unit row: the pattern is then the same whatever is held, and so is the order of the pivots.
pub(super) struct Places {
    pub(super) column: Vec<Option<usize>>,
    pub(super) row: Vec<Option<usize>>,
    /// Variables and rows that have a place.
    pub(super) variables: usize,
    pub(super) rows: usize,
    whole: bool,
}

impl Places {
    /// `most`: this part of the variables and rows.
    pub(super) fn new(column: &[bool], row: &[bool], most: f64) -> Self {
        let (n, m) = (column.len(), row.len());
        let kept = column.iter().chain(row).filter(|k| **k).count();
        let whole = kept as f64 >= most * (n + m) as f64;
        let place = |keep: &[bool]| match whole {
            true => {
                let each = keep.iter().enumerate();
                (
                    each.map(|(k, &kept)| kept.then_some(k)).collect(),
                    keep.len(),
                )
            }
            false => number(|k| keep[k], keep.len()),
        };
        let ((column, variables), (row, rows)) = (place(column), place(row));
        Self {
            column,
            row,
            variables,
            rows,
            whole,
        }
    }

    /// Whether as many rows are held as variables are free.
    pub(super) fn is_square(&self) -> bool {
        let count = |places: &[Option<usize>]| places.iter().flatten().count();
        count(&self.column) == count(&self.row)
    }

    /// The order of the matrix.
    pub(super) fn total(&self) -> usize {
        self.variables + self.rows
    }

    /// Adds an entry of H.
    pub(super) fn curve(&self, matrix: &mut Lower, i: usize, j: usize, h: f64) {
        match (self.column[i], self.column[j]) {
            (Some(p), Some(q)) => matrix.push(p, q, h),
            _ if self.whole => matrix.push(i, j, 0.0),
            _ => {}
        }
    }

    /// Adds an entry of J.
    pub(super) fn slope(&self, matrix: &mut Lower, i: usize, j: usize, a: f64) {
        match (self.row[i], self.column[j]) {
            (Some(p), Some(q)) => matrix.push(self.variables + p, q, a),
            _ if self.whole => matrix.push(self.variables + i, j, 0.0),
            _ => {}
        }
    }

    /// Adds to the diagonals of free variables and of held rows.
    pub(super) fn diagonal(&self, matrix: &mut Lower, free: impl Fn(usize) -> f64, held: f64) {
        for (j, p) in self.column.iter().enumerate() {
            match p {
                Some(p) => matrix.push(*p, *p, free(j)),
                None if self.whole => matrix.push(j, j, 1.0),
                None => {}
            }
        }
        for (i, p) in self.row.iter().enumerate() {
            let (p, value) = match p {
                Some(p) => (*p, held),
                None if self.whole => (i, -1.0),
                None => continue,
            };
            matrix.push(self.variables + p, self.variables + p, value);
        }
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
