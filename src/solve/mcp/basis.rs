//! The basis of the path: a square matrix of columns ±eᵢ and columns of M, held as an LU
//! factorisation that is updated when a column is replaced.
//!
//! Two engines, chosen by the fill to expect ([`Fill`]):
//!
//! - `feral`'s Markowitz LU with Forrest–Tomlin updates, whose solves touch only what the right-hand
//!   side reaches. It wins where factors stay about as sparse as the matrix: linear programs,
//!   networks, bands, models of an economy.
//! - `faer`'s supernodal LU with product-form updates, B⁻¹ = Eₖ⁻¹…E₁⁻¹B₀⁻¹, where Eₖ is the
//!   identity with the direction d in the replaced slot. On problems from the plane (walls,
//!   obstacle problems) factors fill up, directions are full vectors anyway, and blocks of dense
//!   arithmetic are ten times faster.

use feral::{LuParams, SparseColMatrix, SparseLu, SparseLuSymbolic};

use super::factor::{Fill, faer_lu, faer_solve};

/// A sparse vector as (index, value) pairs.
pub(super) type Sparse = Vec<(usize, f64)>;

/// Column replacements after which the factors are made anew, whatever they cost.
const UPDATE_LIMIT: usize = 100;
/// A pivot of the product form, relative to the direction's largest entry, below which the factors
/// are made anew.
const PRODUCT_PIVOT: f64 = 1e-7;

/// LU factors of the basis matrix.
pub(super) struct Basis(Engine);

enum Engine {
    ForrestTomlin {
        lu: Box<SparseLu>,
        /// Work done by updates and the solves lengthened by them, against that of a factorisation.
        work: usize,
        budget: usize,
        /// Updates at most.
        limit: usize,
    },
    Product {
        lu: Box<faer::sparse::linalg::solvers::Lu<usize, f64>>,
        etas: Vec<Eta>,
        work: Vec<f64>,
    },
}

/// One factor of the product form: the direction with which a slot was replaced.
struct Eta {
    slot: usize,
    pivot: f64,
    direction: Vec<f64>,
}

impl Eta {
    /// x ← E⁻¹x.
    fn apply(&self, x: &mut [f64]) {
        let value = x[self.slot] / self.pivot;
        if value != 0.0 {
            x.iter_mut()
                .zip(&self.direction)
                .for_each(|(x, d)| *x -= value * d);
        }
        x[self.slot] = value;
    }
}

impl Basis {
    /// Factorises; None if the matrix is singular.
    pub(super) fn new(matrix: &SparseColMatrix, fill: Fill) -> Option<Basis> {
        if matrix.values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        if fill == Fill::Heavy {
            let lu = Box::new(faer_lu(matrix, &mut None)?);
            return Some(Basis(Engine::Product {
                lu,
                etas: Vec::new(),
                work: vec![0.0; matrix.m],
            }));
        }
        // Where factors are sparse, updates are too, and a factorisation costs many of them.
        let limit = (matrix.m / 20).clamp(UPDATE_LIMIT, 20 * UPDATE_LIMIT);
        let params = LuParams {
            zero_pivot_tol: 1e-13,
            max_updates: limit + 1,
            sparse_rhs_max_density: 0.3,
            ..LuParams::default()
        };
        let lu =
            Box::new(SparseLu::factor(matrix, &SparseLuSymbolic::natural(matrix.m), params).ok()?);
        // A factorisation costs many times its nonzeros: ordering, and memory not in order.
        let budget = 100 * (lu.factor_nnz() + 2 * matrix.m);
        Some(Basis(Engine::ForrestTomlin {
            lu,
            work: 0,
            budget,
            limit,
        }))
    }

    /// B⁻¹a for a sparse a, as (slot, value) pairs; false if the factors are unusable.
    pub(super) fn solve_sparse(&mut self, a: &[(usize, f64)], out: &mut Sparse) -> bool {
        match &mut self.0 {
            Engine::ForrestTomlin { lu, .. } => {
                lu.ftran_sparse(a, out).is_ok() && out.iter().all(|(_, v)| v.is_finite())
            }
            Engine::Product { lu, etas, work } => {
                work.fill(0.0);
                a.iter().for_each(|&(i, v)| work[i] = v);
                faer_solve(lu, work);
                etas.iter().for_each(|eta| eta.apply(work));
                out.clear();
                out.extend(work.iter().copied().enumerate().filter(|(_, v)| *v != 0.0));
                out.iter().all(|(_, v)| v.is_finite())
            }
        }
    }

    /// B⁻¹b for a dense b, in place; false if the factors are unusable.
    pub(super) fn solve(&mut self, b: &mut [f64]) -> bool {
        match &mut self.0 {
            Engine::ForrestTomlin { lu, .. } => {
                lu.ftran(b).is_ok() && b.iter().all(|v| v.is_finite())
            }
            Engine::Product { lu, etas, .. } => {
                faer_solve(lu, b);
                etas.iter().for_each(|eta| eta.apply(b));
                b.iter().all(|v| v.is_finite())
            }
        }
    }

    /// Replaces the column of a slot; `direction` is B⁻¹ times the new column. False if the factors
    /// must be made anew (they are then as before the call).
    pub(super) fn replace(
        &mut self,
        slot: usize,
        column: &[(usize, f64)],
        direction: &[(usize, f64)],
    ) -> bool {
        match &mut self.0 {
            Engine::ForrestTomlin { lu, work, .. } => {
                let replaced = lu.update_sparse(slot, column).is_ok();
                *work += lu.last_update_work() + lu.eta_ops() + lu.last_sparse_solve_work();
                replaced
            }
            Engine::Product { etas, work, .. } => {
                let mut full = vec![0.0; work.len()];
                direction.iter().for_each(|&(i, v)| full[i] = v);
                let largest = full.iter().fold(0.0f64, |a, v| a.max(v.abs()));
                let pivot = full[slot];
                if pivot.abs() <= PRODUCT_PIVOT * largest {
                    return false;
                }
                etas.push(Eta {
                    slot,
                    pivot,
                    direction: full,
                });
                true
            }
        }
    }

    /// Number of replacements since the factorisation.
    pub(super) fn updates(&self) -> usize {
        match &self.0 {
            Engine::ForrestTomlin { lu, .. } => lu.updates_since_refactor(),
            Engine::Product { etas, .. } => etas.len(),
        }
    }

    /// Whether a fresh factorisation is due.
    pub(super) fn is_old(&self) -> bool {
        match &self.0 {
            Engine::ForrestTomlin {
                lu,
                work,
                budget,
                limit,
            } => {
                self.updates() >= *limit
                    || self.updates() >= 20 && *work >= *budget
                    || lu.should_refactor_growth()
            }
            Engine::Product { etas, .. } => etas.len() >= UPDATE_LIMIT,
        }
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
        for fill in [Fill::Light, Fill::Heavy] {
            updates(fill);
        }
    }

    fn updates(fill: Fill) {
        let m = 120;
        let mut random = Random::new(7);
        let mut columns: Vec<Sparse> = (0..m).map(|j| column(&mut random, m, j)).collect();
        let mut basis = Basis::new(&matrix(&columns), fill).expect("diagonally dominant");
        for _ in 0..90 {
            let slot = (random.uniform() * m as f64) as usize;
            columns[slot] = column(&mut random, m, slot);
            let mut direction = Sparse::default();
            assert!(basis.solve_sparse(&columns[slot], &mut direction));
            if !basis.replace(slot, &columns[slot], &direction) {
                basis = Basis::new(&matrix(&columns), fill).expect("diagonally dominant");
            }
            let a = column(&mut random, m, slot);
            let (mut updated, mut fresh) = (Sparse::default(), vec![0.0; m]);
            assert!(basis.solve_sparse(&a, &mut updated));
            a.iter().for_each(|&(i, v)| fresh[i] = v);
            assert!(
                Basis::new(&matrix(&columns), fill)
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
        assert!(Basis::new(&matrix(&columns), Fill::Light).is_none());
        for fill in [Fill::Light, Fill::Heavy] {
            assert!(Basis::new(&matrix(&[vec![], vec![(0, 1.0)]]), fill).is_none());
        }
    }
}
