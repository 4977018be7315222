//! Sparse LU factorisations of Newton systems, each checked by its residual.
//!
//! `faer`'s LU (COLAMD ordering, partial pivoting, supernodal) reports structural singularity
//! only; a numerically singular matrix gives factors full of infinities, or of rounding errors. So
//! every solution is refined, and one whose residual is not small against the right-hand side
//! counts as a singular matrix. Where little fill is to be expected ([`Fill`]), `feral`'s Markowitz
//! LU is used instead: it peels singletons, and a dense row does no harm.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use feral::{LuParams, LuScaling, SparseColMatrix, SparseLu, SparseLuSymbolic};

/// How much the factors of a problem's matrices will fill up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fill {
    /// Factors about as sparse as the matrix.
    Light,
    /// Factors with dense blocks.
    Heavy,
}

/// Operations per nonzero of the factors from which dense blocks pay.
const HEAVY_RATIO: f64 = 6.0;
/// Bound on the nonzeros of AᵀA, which bound the memory of the supernodal LU.
const HEAVY_MEMORY: f64 = 2e8;

impl Fill {
    /// Judges a pattern by the operations a minimum degree ordering of A + Aᵀ leads to.
    pub(super) fn of(n: usize, col_ptr: &[usize], row_idx: &[usize]) -> Fill {
        let mut row_count = vec![0usize; n];
        row_idx.iter().for_each(|&i| row_count[i] += 1);
        let product: f64 = row_count.iter().map(|&r| (r as f64).powi(2)).sum();
        if n == 0 || product > HEAVY_MEMORY {
            return Fill::Light;
        }
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, col_ptr, None, row_idx);
        let (mut order, mut inverse) = (vec![0usize; n], vec![0usize; n]);
        let mut memory = MemBuffer::new(amd::order_scratch::<usize>(n, row_idx.len()));
        match amd::order(
            &mut order,
            &mut inverse,
            pattern,
            amd::Control::default(),
            MemStack::new(&mut memory),
        ) {
            Ok(count) if count.n_mult_subs_lu > HEAVY_RATIO * (count.n_div + n as f64) => {
                Fill::Heavy
            }
            _ => Fill::Light,
        }
    }
}

/// `faer`'s factors of a finite matrix; None if it is structurally singular.
pub(super) fn faer_lu(matrix: &SparseColMatrix, ordering: &mut Ordering) -> Option<Lu<usize, f64>> {
    let m = matrix.m;
    let pattern =
        SymbolicSparseColMatRef::new_checked(m, m, &matrix.col_ptr, None, &matrix.row_idx);
    if ordering.is_none() {
        *ordering = Some(SymbolicLu::try_new(pattern).ok()?);
    }
    let matrix = SparseColMatRef::new(pattern, &matrix.values);
    Lu::try_new_with_symbolic(ordering.clone()?, matrix).ok()
}

/// x ← A⁻¹x.
pub(super) fn faer_solve(lu: &Lu<usize, f64>, x: &mut [f64]) {
    lu.solve_in_place(faer::ColMut::from_slice_mut(x));
}

/// A matrix and its LU factors.
pub(super) struct Factor {
    matrix: SparseColMatrix,
    lu: Engine,
}

enum Engine {
    Markowitz(Box<SparseLu>),
    Supernodal(Box<Lu<usize, f64>>),
}

/// Residual, relative to the right-hand side, above which a solution is not one.
const RESIDUAL_TOLERANCE: f64 = 1e-6;
/// The ordering of a pattern, for the matrices that share it.
pub(super) type Ordering = Option<SymbolicLu<usize>>;

impl Factor {
    /// Factorises; None if singular or not finite.
    pub(super) fn new(matrix: SparseColMatrix, fill: Fill) -> Option<Factor> {
        Factor::ordered(matrix, fill, &mut None)
    }

    /// As [`Factor::new`], for one of several matrices with the same pattern.
    pub(super) fn ordered(
        matrix: SparseColMatrix,
        fill: Fill,
        ordering: &mut Ordering,
    ) -> Option<Factor> {
        // A non-finite entry must not reach the factorisation, which compares magnitudes.
        if matrix.m == 0 || matrix.values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let lu = match fill {
            Fill::Heavy => Engine::Supernodal(Box::new(faer_lu(&matrix, ordering)?)),
            Fill::Light => {
                let params = LuParams {
                    scaling: LuScaling::InfNorm,
                    zero_pivot_tol: 1e-14,
                    ..LuParams::default()
                };
                let lu =
                    SparseLu::factor(&matrix, &SparseLuSymbolic::natural(matrix.m), params).ok()?;
                Engine::Markowitz(Box::new(lu))
            }
        };
        Some(Factor { matrix, lu })
    }

    /// b ← A⁻¹b.
    fn solve_once(&mut self, b: &mut [f64]) -> Option<()> {
        match &mut self.lu {
            Engine::Markowitz(lu) => lu.ftran(b).ok()?,
            Engine::Supernodal(lu) => faer_solve(lu, b),
        }
        Some(())
    }

    /// Solves A x = b; None if the solution does not satisfy the system.
    pub(super) fn solve(&mut self, b: &[f64]) -> Option<Vec<f64>> {
        self.solve_to(b, 1e-14)
    }

    /// As [`Factor::solve`], refined only as long as the residual, relative to b, is larger than `enough`.
    pub(super) fn solve_to(&mut self, b: &[f64], enough: f64) -> Option<Vec<f64>> {
        let norm = b.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        let mut x = b.to_vec();
        self.solve_once(&mut x)?;
        let mut residual = vec![0.0; b.len()];
        for step in 0..3 {
            self.matrix.matvec(&x, &mut residual);
            let mut worst = 0.0f64;
            for (r, b) in residual.iter_mut().zip(b) {
                *r = b - *r;
                worst = if r.is_nan() {
                    f64::INFINITY
                } else {
                    worst.max(r.abs())
                };
            }
            if !worst.is_finite() {
                return None;
            }
            if worst <= enough * norm {
                return Some(x);
            }
            if step == 2 {
                return (worst <= RESIDUAL_TOLERANCE * norm).then_some(x);
            }
            self.solve_once(&mut residual)?;
            x.iter_mut().zip(&residual).for_each(|(x, d)| *x += d);
        }
        unreachable!("the loop returns in its last step")
    }
}

/// Builds a matrix from columns given as (row, value) lists.
pub(super) struct Builder {
    matrix: SparseColMatrix,
}

impl Builder {
    /// An m × m matrix without columns yet.
    pub(super) fn new(m: usize) -> Self {
        let mut col_ptr = Vec::with_capacity(m + 1);
        col_ptr.push(0);
        Builder {
            matrix: SparseColMatrix {
                m,
                col_ptr,
                row_idx: Vec::new(),
                values: Vec::new(),
            },
        }
    }

    /// Adds an entry to the column under construction; rows must come in increasing order.
    pub(super) fn push(&mut self, row: usize, value: f64) {
        self.matrix.row_idx.push(row);
        self.matrix.values.push(value);
    }

    /// Ends the column.
    pub(super) fn end_column(&mut self) {
        self.matrix.col_ptr.push(self.matrix.row_idx.len());
    }

    /// The matrix; all m columns must have been ended.
    pub(super) fn finish(self) -> SparseColMatrix {
        debug_assert_eq!(self.matrix.col_ptr.len(), self.matrix.m + 1);
        self.matrix
    }
}

/// A + v·I. The pattern of A need not contain the diagonal.
pub(super) fn shifted(a: &SparseColMatrix, v: f64) -> SparseColMatrix {
    combine(a, |_| v, |_| 1.0)
}

/// Diagonal(da) + Diagonal(db)·A.
pub(super) fn combine(
    a: &SparseColMatrix,
    da: impl Fn(usize) -> f64,
    db: impl Fn(usize) -> f64,
) -> SparseColMatrix {
    let mut b = Builder::new(a.m);
    for j in 0..a.m {
        let (rows, values) = a.column(j);
        let mut diagonal = Some(da(j)).filter(|d| *d != 0.0);
        for (&i, &v) in rows.iter().zip(values) {
            if i >= j
                && let Some(d) = diagonal.take()
            {
                if i == j {
                    b.push(i, d + db(i) * v);
                    continue;
                }
                b.push(j, d);
            }
            b.push(i, db(i) * v);
        }
        if let Some(d) = diagonal {
            b.push(j, d);
        }
        b.end_column();
    }
    b.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagonal_is_added_where_the_pattern_lacks_it() {
        let a = SparseColMatrix {
            m: 3,
            col_ptr: vec![0, 2, 3, 4],
            row_idx: vec![1, 2, 1, 0],
            values: vec![5.0, 6.0, 7.0, 8.0],
        };
        let b = shifted(&a, 2.0);
        let mut y = vec![0.0; 3];
        b.matvec(&[1.0, 10.0, 100.0], &mut y);
        assert_eq!(y, [2.0 + 800.0, 5.0 + 70.0 + 20.0, 6.0 + 200.0]);
        assert!(b.validate().is_ok());
    }

    #[test]
    fn singular_matrices_are_noticed() {
        // Rank one, and its perturbation by rounding.
        for epsilon in [0.0, 1e-17] {
            let a = SparseColMatrix {
                m: 2,
                col_ptr: vec![0, 2, 4],
                row_idx: vec![0, 1, 0, 1],
                values: vec![1.0, 2.0, 2.0, 4.0 + epsilon],
            };
            for fill in [Fill::Light, Fill::Heavy] {
                let solved = Factor::new(a.clone(), fill).and_then(|mut f| f.solve(&[1.0, 0.0]));
                assert!(solved.is_none());
            }
        }
        let nan = SparseColMatrix {
            m: 1,
            col_ptr: vec![0, 1],
            row_idx: vec![0],
            values: vec![f64::NAN],
        };
        assert!(Factor::new(nan, Fill::Light).is_none());
    }
}
