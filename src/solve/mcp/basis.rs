//! The basis of the path: a square matrix of columns ±eᵢ and columns of M, held as an LU
//! factorisation that is updated when a column is replaced.
//!
//! `feral`'s sparse LU does the work: Markowitz pivoting, Forrest–Tomlin updates, and solves that
//! touch only what the right-hand side reaches.

use feral::{LuParams, SparseColMatrix, SparseLu, SparseLuSymbolic};

/// A sparse vector as (index, value) pairs.
pub(super) type Sparse = Vec<(usize, f64)>;

/// Column replacements after which the factors are made anew, whatever they cost.
const UPDATE_LIMIT: usize = 100;

/// LU factors of the basis matrix.
pub(super) struct Basis {
    lu: SparseLu,
    /// Work done by updates and the solves lengthened by them, against that of a factorisation.
    work: usize,
    budget: usize,
}

impl Basis {
    /// Factorises; None if the matrix is singular.
    pub(super) fn new(matrix: &SparseColMatrix) -> Option<Basis> {
        if matrix.values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let params = LuParams {
            zero_pivot_tol: 1e-13,
            max_updates: 2 * UPDATE_LIMIT,
            sparse_rhs_max_density: 0.3,
            ..LuParams::default()
        };
        let lu = SparseLu::factor(matrix, &SparseLuSymbolic::natural(matrix.m), params).ok()?;
        // A factorisation costs several times its nonzeros, more for the ordering.
        let budget = 20 * (lu.factor_nnz() + 4 * matrix.m);
        Some(Basis {
            lu,
            work: 0,
            budget,
        })
    }

    /// B⁻¹a for a sparse a, as (slot, value) pairs; false if the factors are unusable.
    pub(super) fn solve_sparse(&mut self, a: &[(usize, f64)], out: &mut Sparse) -> bool {
        self.lu.ftran_sparse(a, out).is_ok() && out.iter().all(|(_, v)| v.is_finite())
    }

    /// B⁻¹b for a dense b, in place; false if the factors are unusable.
    pub(super) fn solve(&mut self, b: &mut [f64]) -> bool {
        self.lu.ftran(b).is_ok() && b.iter().all(|v| v.is_finite())
    }

    /// Replaces the column of a slot; false if the factors must be made anew (they are then as
    /// before the call).
    pub(super) fn replace(&mut self, slot: usize, column: &[(usize, f64)]) -> bool {
        let replaced = self.lu.update_sparse(slot, column).is_ok();
        self.work +=
            self.lu.last_update_work() + self.lu.eta_ops() + self.lu.last_sparse_solve_work();
        replaced
    }

    /// Number of replacements since the factorisation.
    pub(super) fn updates(&self) -> usize {
        self.lu.updates_since_refactor()
    }

    /// Whether a fresh factorisation is due.
    pub(super) fn is_old(&self) -> bool {
        self.updates() >= UPDATE_LIMIT
            || self.updates() >= 20 && self.work >= self.budget
            || self.lu.should_refactor_growth()
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::Random;
    use super::*;

    fn matrix(columns: &[Sparse]) -> SparseColMatrix {
        SparseColMatrix::from_sparse_columns(columns.len(), columns).expect("rows in range")
    }

    fn column(random: &mut Random, m: usize, diagonal: usize) -> Sparse {
        let mut dense = vec![0.0; m];
        dense[diagonal] = 2.0 + random.uniform();
        for _ in 0..3 {
            dense[(random.uniform() * m as f64) as usize] += random.between(-1.0, 1.0);
        }
        dense
            .into_iter()
            .enumerate()
            .filter(|(_, v)| *v != 0.0)
            .collect()
    }

    #[test]
    fn updated_factors_solve_like_fresh_ones() {
        let m = 120;
        let mut random = Random::new(7);
        let mut columns: Vec<Sparse> = (0..m).map(|j| column(&mut random, m, j)).collect();
        let mut basis = Basis::new(&matrix(&columns)).expect("diagonally dominant");
        for _ in 0..90 {
            let slot = (random.uniform() * m as f64) as usize;
            columns[slot] = column(&mut random, m, slot);
            if !basis.replace(slot, &columns[slot]) {
                basis = Basis::new(&matrix(&columns)).expect("diagonally dominant");
            }
            let a = column(&mut random, m, slot);
            let (mut updated, mut fresh) = (Sparse::new(), vec![0.0; m]);
            assert!(basis.solve_sparse(&a, &mut updated));
            a.iter().for_each(|&(i, v)| fresh[i] = v);
            assert!(
                Basis::new(&matrix(&columns))
                    .expect("diagonally dominant")
                    .solve(&mut fresh)
            );
            for (i, v) in updated {
                assert!((v - fresh[i]).abs() < 1e-9, "{v} {}", fresh[i]);
                fresh[i] = 0.0;
            }
            assert!(
                fresh.iter().all(|v| v.abs() < 1e-9),
                "the sparse solution misses an entry"
            );
        }
    }

    #[test]
    fn singular_is_none() {
        let columns = vec![vec![(0, 1.0), (1, 2.0)], vec![(0, 2.0), (1, 4.0)]];
        assert!(Basis::new(&matrix(&columns)).is_none());
        assert!(Basis::new(&matrix(&[vec![], vec![(0, 1.0)]])).is_none());
    }
}
