//! The basis matrix: sparse LU with Forrest–Tomlin updates, by `feral`.
//!
//! A column of A that makes the basis singular is noticed by a *marked* pivot: `feral` is told to
//! put a known number where no pivot is large enough, and the factor is then searched for it. The
//! marked column is replaced by the logical of the row that it left without a pivot.
//!
//! A copy shares the LU. Columns that are replaced while it is shared stand in product form beside it,
//! B = B₀ E₁ ⋯ E_k with E_i a unit matrix but for one column, so that many short runs from one basis cost
//! neither a copy nor an update of the LU.

use crate::solve::lp::form::Sparse;
use feral::lu::{
    LuParams, LuPivoting, LuSingularAction, SparseColMatrix, SparseLu, SparseLuSymbolic,
};
use std::cell::RefCell;
use std::rc::Rc;

/// Stands in U where no pivot was found. A number that no data gives.
const MARK: f64 = 0.987_654_321_012_345_6;

/// Where rows and columns of one entry leave at most one column of so many, an order of the columns is as good as a search for pivots. (Of two
/// columns in ten some bases of DEGEN3 of Netlib fill up.)
const TRIANGULAR: usize = 10;

/// Twice that, or so many columns, where only the rows without pivots are asked for. (Larger ones fill up on walls: 45 s instead of 1.)
const SMALL_BUMP: usize = 300;

/// Rows beyond those of the program, where the columns that only make a matrix square have their entries: not 0, but too small for a pivot. The
/// search for pivots looks at the columns with the fewest entries first, so empty ones would be in its way at every step; and entries in other
/// rows would fill up. (The time of the search grows with the square of the number of these columns all the same.)
const PADDING: usize = 100;
const NO_PIVOT: f64 = 1e-200;

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
    /// Nonzeros of the factor when it was fresh, and what [`Factor::nonzeros`] is now: to count them takes a pass over the rows.
    fresh: usize,
    nonzeros: usize,
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
        let lu = match Self::nearly_triangular(m, columns, &matrix, zero) {
            Some(lu) => lu,
            None => SparseLu::factor_markowitz(&matrix, parameters(zero))
                .map_err(|_| Failure::Numbers)?,
        };
        let dependent: Vec<(usize, usize)> = (0..m)
            .filter(|&k| is_marked(&lu, k))
            .map(|k| (lu.qcol()[k], lu.perm()[k]))
            .collect();
        if !dependent.is_empty() {
            return Err(Failure::Dependent(dependent));
        }
        Ok(Self {
            fresh: lu.factor_nnz(),
            nonzeros: lu.factor_nnz(),
            lu: Rc::new(RefCell::new(lu)),
            etas: Vec::new(),
            solution: Vec::new(),
            work: vec![0.0; m],
        })
    }

    /// The factor where rows and columns of one entry, taken away one after the other, leave little. None: much is left, or a
    /// column is dependent.
    fn nearly_triangular(
        m: usize,
        columns: &[Entries],
        matrix: &SparseColMatrix,
        zero: f64,
    ) -> Option<SparseLu> {
        let (order, left) = triangular_order(m, columns);
        if TRIANGULAR * left > m {
            return None;
        }
        let lu = in_order(matrix, order, zero)?;
        let marked = (0..m).any(|k| is_marked(&lu, k));
        (!marked).then_some(lu)
    }

    /// Rows in which none of these columns, which have entries, has its pivot, and the columns that depend on the others. None: numbers that are not
    /// finite.
    pub(crate) fn without_pivots(
        m: usize,
        mut columns: Vec<Entries>,
    ) -> Option<(Vec<usize>, Vec<usize>)> {
        let given = columns.len();
        columns.resize(m, Vec::new());
        let (order, between) = triangular_order(m, &columns);
        let lu = if between <= SMALL_BUMP.max(2 * m / TRIANGULAR) {
            let matrix = SparseColMatrix::from_sparse_columns(m, &columns).ok()?;
            in_order(&matrix, order, ZERO)?
        } else {
            let rows = m + PADDING;
            let padding: Entries = (m..rows).map(|i| (i, NO_PIVOT)).collect();
            columns.retain(|c| !c.is_empty());
            columns.resize(rows, padding);
            let matrix = SparseColMatrix::from_sparse_columns(rows, &columns).ok()?;
            SparseLu::factor_markowitz(&matrix, parameters(ZERO)).ok()?
        };
        let left = (0..columns.len()).filter(|&k| is_marked(&lu, k));
        let rows = left.clone().map(|k| lu.perm()[k]).filter(|&i| i < m);
        let dependent = left.map(|k| lu.qcol()[k]).filter(|&k| k < given);
        Some((rows.collect(), dependent.collect()))
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
        let replaced = self.replace_column(slot, column);
        let lu = self.lu.borrow();
        let etas: usize = self.etas.iter().map(|e| 1 + e.others.len()).sum();
        self.nonzeros = etas + lu.eta_ops() + lu.factor_nnz();
        replaced
    }

    fn replace_column(&mut self, slot: usize, column: &[(usize, f64)]) -> bool {
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
        self.nonzeros
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

/// Whether there was no pivot in this step.
fn is_marked(lu: &SparseLu, k: usize) -> bool {
    lu.u_dense(k, k).abs() == MARK
}

/// An order of the columns in which those go first, and last, that rows and columns of one entry give, taken away one after the other,
/// short ones before long ones between them, and empty ones at the very end; and how many are between.
fn triangular_order(m: usize, columns: &[Entries]) -> (Vec<usize>, usize) {
    let mut lines = Sparse::default();
    for column in columns {
        lines.push(column.iter().copied());
    }
    let rows = lines.transpose(m);
    let left = &mut [vec![true; m], vec![true; m]];
    let first = peel(&lines, &rows, left);
    left.swap(0, 1);
    let last = peel(&rows, &lines, left);
    let rest = (0..m).filter(|&j| left[1][j]);
    let (empty, mut rest): (Vec<usize>, Vec<usize>) = rest.partition(|&j| lines.line(j).len() == 0);
    rest.sort_by_key(|&j| lines.line(j).len());
    let between = rest.len();
    let order = first.into_iter().map(|e| e.0).chain(rest);
    let order = order.chain(last.into_iter().rev().map(|e| e.1));
    (order.chain(empty).collect(), between)
}

/// The factor with the columns in this order, the largest pivot in each.
fn in_order(matrix: &SparseColMatrix, order: Vec<usize>, zero: f64) -> Option<SparseLu> {
    let symbolic = SparseLuSymbolic::with_order(order.len(), order).ok()?;
    let params = LuParams {
        pivoting: LuPivoting::GilbertPeierls,
        ..parameters(zero)
    };
    SparseLu::factor(matrix, &symbolic, params).ok()
}

/// Takes lines away that have one entry where lines of the other kind are left, with the line in which it is, as long as there are any: both.
fn peel(lines: &Sparse, across: &Sparse, left: &mut [Vec<bool>; 2]) -> Vec<(usize, usize)> {
    let [left, across_left] = left;
    let mut count: Vec<usize> = (0..lines.lines())
        .map(|k| lines.line(k).filter(|e| across_left[e.0]).count())
        .collect();
    let mut single: Vec<usize> = (0..count.len())
        .filter(|&k| left[k] && count[k] == 1)
        .collect();
    let mut gone = Vec::new();
    while let Some(k) = single.pop() {
        // None: another one took it.
        let Some((i, _)) = lines.line(k).find(|e| across_left[e.0]) else {
            continue;
        };
        (left[k], across_left[i]) = (false, false);
        gone.push((k, i));
        for (other, _) in across.line(i) {
            count[other] -= 1;
            if count[other] == 1 && left[other] {
                single.push(other);
            }
        }
    }
    gone
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
