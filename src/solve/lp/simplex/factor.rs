//! The basis matrix: sparse LU with Forrest–Tomlin updates, by `feral`.
//!
//! A column of A that makes the basis singular is noticed by a *marked* pivot: `feral` is told to
//! put a known number where no pivot is large enough, and the factor is then searched for it. The
//! marked column is replaced by the logical of the row that it left without a pivot.

use feral::lu::{LuParams, LuSingularAction, SparseColMatrix, SparseLu};

/// Stands in U where no pivot was found. A number that no data gives.
const MARK: f64 = 0.987_654_321_012_345_6;

/// Updates before a fresh factorisation.
const MOST_UPDATES: usize = 150;

/// A column as row–value pairs.
pub type Entries = Vec<(usize, f64)>;

/// A factorised basis.
#[derive(Clone)]
pub struct Factor {
    lu: SparseLu,
    /// Nonzeros of the factor when it was fresh.
    fresh: usize,
    /// What the last sparse solve gave.
    solution: Entries,
}

/// Why there is no factor.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// These slots hold dependent columns; the logicals of these rows would complete the basis.
    Dependent(Vec<(usize, usize)>),
    /// Numbers that are not finite.
    Numbers,
}

/// A smaller pivot is none, usually.
pub const ZERO: f64 = 1e-11;

fn parameters(zero: f64) -> LuParams {
    LuParams {
        max_updates: MOST_UPDATES,
        zero_pivot_tol: zero,
        on_singular: LuSingularAction::PerturbToEps { abs_floor: MARK },
        ..LuParams::default()
    }
}

impl Factor {
    /// Factorises the matrix with these columns.
    pub fn new(m: usize, columns: &[Entries]) -> Result<Self, Failure> {
        Self::without_pivots_below(ZERO, m, columns)
    }

    /// The same, where columns count as dependent whose pivots are smaller than `zero`.
    pub fn without_pivots_below(zero: f64, m: usize, columns: &[Entries]) -> Result<Self, Failure> {
        let matrix =
            SparseColMatrix::from_sparse_columns(m, columns).map_err(|_| Failure::Numbers)?;
        let lu =
            SparseLu::factor_markowitz(&matrix, parameters(zero)).map_err(|_| Failure::Numbers)?;
        let dependent: Vec<(usize, usize)> = (0..m)
            .filter(|&k| lu.u_dense(k, k).abs() == MARK)
            .map(|k| (lu.qcol()[k], lu.perm()[k]))
            .collect();
        if !dependent.is_empty() {
            return Err(Failure::Dependent(dependent));
        }
        Ok(Self {
            fresh: lu.factor_nnz(),
            lu,
            solution: Vec::new(),
        })
    }

    /// Solves B x = a. None if the factor has broken down.
    pub fn forward(&mut self, a: &[(usize, f64)]) -> Option<&Entries> {
        self.lu.ftran_sparse(a, &mut self.solution).ok()?;
        Some(&self.solution)
    }

    /// Solves Bᵀ y = a. None if the factor has broken down.
    pub fn backward(&mut self, a: &[(usize, f64)]) -> Option<&Entries> {
        self.lu.btran_sparse(a, &mut self.solution).ok()?;
        Some(&self.solution)
    }

    /// Solves B x = a in place for a dense right-hand side.
    pub fn forward_dense(&mut self, a: &mut [f64]) -> Option<()> {
        self.lu.ftran(a).ok()
    }

    /// Solves Bᵀ y = a in place for a dense right-hand side.
    pub fn backward_dense(&mut self, a: &mut [f64]) -> Option<()> {
        self.lu.btran(a).ok()
    }

    /// Replaces the column in a slot. False: factorise afresh.
    pub fn replace(&mut self, slot: usize, column: &[(usize, f64)]) -> bool {
        self.lu.update_sparse(slot, column).is_ok()
    }

    /// Number of updates since the factorisation.
    pub fn updates(&self) -> usize {
        self.lu.updates_since_refactor()
    }

    /// Whether a fresh factorisation is due.
    pub fn is_worn(&self) -> bool {
        // A factorisation costs hundreds of times what its nonzeros suggest, so the solves may grow
        // a good deal before a fresh one pays.
        self.updates() >= MOST_UPDATES
            || self.lu.should_refactor_growth()
            || self.lu.eta_ops() + self.lu.factor_nnz() > 3 * self.fresh + 1000
    }
}
