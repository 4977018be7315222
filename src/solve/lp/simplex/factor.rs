//! The basis matrix: sparse LU with Forrest–Tomlin updates, by `feral`.
//!
//! A column of A that makes the basis singular is noticed by a *marked* pivot: `feral` is told to
//! put a known number where no pivot is large enough, and the factor is then searched for it. The
//! marked column is replaced by the logical of the row that it left without a pivot.
//!
//! A copy shares the LU. Columns that are replaced while it is shared stand in product form beside it,
//! B = B₀ E₁ ⋯ E_k with E_i a unit matrix but for one column, so that many short runs from one basis cost
//! neither a copy nor an update of the LU.

use feral::lu::{LuParams, LuSingularAction, SparseColMatrix, SparseLu};
use std::cell::RefCell;
use std::rc::Rc;

/// Stands in U where no pivot was found. A number that no data gives.
const MARK: f64 = 0.987_654_321_012_345_6;

/// Updates before a fresh factorisation.
const MOST_UPDATES: usize = 150;

/// A column as row–value pairs.
pub(crate) type Entries = Vec<(usize, f64)>;

/// A factorised basis.
#[derive(Clone)]
pub(crate) struct Factor {
    lu: Rc<RefCell<SparseLu>>,
    /// Replacements since the LU is shared.
    etas: Vec<Eta>,
    /// Nonzeros of the factor when it was fresh.
    fresh: usize,
    /// What the last sparse solve gave.
    solution: Entries,
    /// A dense vector, 0 between uses.
    work: Vec<f64>,
}

/// A replaced column: B⁻¹a for the basis before.
#[derive(Clone)]
struct Eta {
    slot: usize,
    pivot: f64,
    /// Without the pivot.
    others: Entries,
}

/// Why there is no factor.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Failure {
    /// These slots hold dependent columns; the logicals of these rows would complete the basis.
    Dependent(Vec<(usize, usize)>),
    /// Numbers that are not finite.
    Numbers,
}

/// A smaller pivot is none, usually.
pub(crate) const ZERO: f64 = 1e-11;

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
    pub(crate) fn new(m: usize, columns: &[Entries]) -> Result<Self, Failure> {
        Self::without_pivots_below(ZERO, m, columns)
    }

    /// The same, where columns count as dependent whose pivots are smaller than `zero`.
    pub(crate) fn without_pivots_below(
        zero: f64,
        m: usize,
        columns: &[Entries],
    ) -> Result<Self, Failure> {
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
            lu: Rc::new(RefCell::new(lu)),
            etas: Vec::new(),
            solution: Vec::new(),
            work: vec![0.0; m],
        })
    }

    /// Solves B x = a. None if the factor has broken down.
    pub(crate) fn forward(&mut self, a: &[(usize, f64)]) -> Option<&Entries> {
        let mut lu = self.lu.borrow_mut();
        lu.ftran_sparse(a, &mut self.solution).ok()?;
        if !self.etas.is_empty() {
            let (x, work) = (&mut self.solution, &mut self.work);
            x.iter().for_each(|&(k, v)| work[k] = v);
            for eta in &self.etas {
                if work[eta.slot] != 0.0 {
                    // Entries are listed twice where an old one cancelled.
                    let new = eta.others.iter().filter(|e| work[e.0] == 0.0);
                    x.extend(new.map(|&(k, _)| (k, 0.0)));
                    eta.forward(work);
                }
            }
            x.sort_unstable_by_key(|e| e.0);
            x.retain_mut(|(k, v)| {
                *v = std::mem::take(&mut work[*k]);
                *v != 0.0
            });
        }
        Some(&self.solution)
    }

    /// Solves Bᵀ y = a. None if the factor has broken down.
    pub(crate) fn backward(&mut self, a: &[(usize, f64)]) -> Option<&Entries> {
        let mut lu = self.lu.borrow_mut();
        if self.etas.is_empty() {
            lu.btran_sparse(a, &mut self.solution).ok()?;
            return Some(&self.solution);
        }
        let work = &mut self.work;
        a.iter().for_each(|&(k, v)| work[k] = v);
        let slots = self.etas.iter().rev().map(|eta| {
            eta.backward(work);
            eta.slot
        });
        let mut touched: Vec<usize> = slots.chain(a.iter().map(|e| e.0)).collect();
        touched.sort_unstable();
        touched.dedup();
        let rest = |k: usize| (k, std::mem::take(&mut work[k]));
        let rest: Entries = touched.into_iter().map(rest).collect();
        lu.btran_sparse(&rest, &mut self.solution).ok()?;
        Some(&self.solution)
    }

    /// Hands over what the last sparse solve gave, for room to put the next one in.
    pub(crate) fn hand_over(&mut self, to: &mut Entries) {
        std::mem::swap(&mut self.solution, to);
    }

    /// Solves B x = a in place for a dense right-hand side.
    pub(crate) fn forward_dense(&mut self, a: &mut [f64]) -> Option<()> {
        self.lu.borrow_mut().ftran(a).ok()?;
        self.etas.iter().for_each(|eta| eta.forward(a));
        Some(())
    }

    /// Solves Bᵀ y = a in place for a dense right-hand side.
    pub(crate) fn backward_dense(&mut self, a: &mut [f64]) -> Option<()> {
        self.etas.iter().rev().for_each(|eta| eta.backward(a));
        self.lu.borrow_mut().btran(a).ok()
    }

    /// Replaces the column in a slot. False: factorise afresh.
    pub(crate) fn replace(&mut self, slot: usize, column: &[(usize, f64)]) -> bool {
        if self.etas.is_empty()
            && let Some(lu) = Rc::get_mut(&mut self.lu)
        {
            return lu.get_mut().update_sparse(slot, column).is_ok();
        }
        let Some(mut others) = self.forward(column).cloned() else {
            return false;
        };
        let Ok(at) = others.binary_search_by_key(&slot, |e| e.0) else {
            return false;
        };
        let (_, pivot) = others.remove(at);
        self.etas.push(Eta {
            slot,
            pivot,
            others,
        });
        true
    }

    /// Numbers that a solve with a full right-hand side touches.
    pub(crate) fn nonzeros(&self) -> usize {
        let lu = self.lu.borrow();
        let etas: usize = self.etas.iter().map(|e| 1 + e.others.len()).sum();
        etas + lu.eta_ops() + lu.factor_nnz()
    }

    /// Number of updates since the factorisation.
    pub(crate) fn updates(&self) -> usize {
        self.lu.borrow().updates_since_refactor() + self.etas.len()
    }

    /// Whether a fresh factorisation is due.
    pub(crate) fn is_worn(&self) -> bool {
        let lu = self.lu.borrow();
        // A factorisation costs hundreds of times what its nonzeros suggest, so the solves may grow
        // a good deal before a fresh one pays.
        lu.updates_since_refactor() + self.etas.len() >= MOST_UPDATES
            || lu.should_refactor_growth()
            || self.nonzeros() > 3 * self.fresh + 1000
    }
}

impl Eta {
    /// Solves E x = a in place.
    fn forward(&self, a: &mut [f64]) {
        if a[self.slot] != 0.0 {
            let x = a[self.slot] / self.pivot;
            a[self.slot] = x;
            self.others.iter().for_each(|&(k, e)| a[k] -= x * e);
        }
    }

    /// Solves Eᵀ y = a in place.
    fn backward(&self, a: &mut [f64]) {
        let rest: f64 = self.others.iter().map(|&(k, e)| e * a[k]).sum();
        a[self.slot] = (a[self.slot] - rest) / self.pivot;
    }
}
