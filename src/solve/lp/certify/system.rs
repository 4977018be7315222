//! Equations made true exactly: a verified solution of a square sparse system.
//!
//! Given equations E x = b (some rows of a polyhedron) and a point that satisfies them nearly, some
//! of the columns, a *basis* M of the equations, take a correction δ with Mδ = r, r the exact rest.
//! With C the rows of an approximate inverse, computed one at a time, ‖I − CM‖∞ ≤ κ < 1 shows that M
//! is regular, and
//!
//! ```text
//!     |δ_i| ≤ (|C| |r|)_i + κ/(1−κ) · max_k (|C| |r|)_k .
//! ```
//!
//! Only the weighted row sums of |C| are kept, so nothing dense is stored; κ and these sums are
//! rounded upwards. Source: Rump, "Verification methods" (2010), section 10.
//!
//! The basis is chosen for few entries: each equation takes a column of its own. (How much room a column has does not matter, for
//! corrections are far smaller; columns of few entries leave the inverse sparse.) Where the choice is singular, pivots repair it.

use super::super::simplex::factor::{Entries, Factor, Failure};
use super::Enclosed;
use crate::solve::interval::{WideSum, two_sum};
use crate::solve::lp::form::Problem;

/// A basis of equations with proved bounds on its inverse.
pub(super) struct System {
    /// The equations.
    rows: Vec<usize>,
    /// The columns that take the correction.
    pub basis: Vec<usize>,
    factor: Factor,
    /// Σ_k |C_ik| w_k, rounded upwards.
    reach: Vec<f64>,
    /// w: the unit in which the rest of an equation is measured.
    unit: Vec<f64>,
    /// κ.
    contraction: f64,
}

/// Larger than the sum of n terms of this absolute sum that were added in any order.
fn rounded_up(sum: f64, terms: usize) -> f64 {
    sum * (1.0 + (terms as f64 + 4.0) * f64::EPSILON)
}

impl System {
    /// For the equations `rows`; column j may move if `moves[j]`. Err: an
    /// equation that depends on others, or on which no column may move.
    pub(super) fn new(
        poly: &Problem,
        rows: Vec<usize>,
        moves: &[bool],
        unit: Vec<f64>,
        stop: &mut dyn FnMut() -> bool,
    ) -> Result<Self, Option<usize>> {
        let k = rows.len();
        let mut position = vec![u32::MAX; poly.m()];
        for (p, &i) in rows.iter().enumerate() {
            position[i] = p as u32;
        }
        let entries = |j: usize| -> Entries {
            let line = poly.columns.line(j);
            line.filter(|&(i, _)| position[i] != u32::MAX)
                .map(|(i, a)| (position[i] as usize, a))
                .collect()
        };
        let mut basis = choose(poly, &rows, moves, &entries);
        let mut factor = None;
        for _ in 0..20 {
            let columns: Vec<Entries> = basis.iter().map(|c| c.entries(&entries)).collect();
            match Factor::new(k, &columns) {
                Ok(f) => {
                    factor = Some(f);
                    break;
                }
                Err(Failure::Numbers) => return Err(None),
                Err(Failure::Dependent(list)) => {
                    for (slot, p) in list {
                        basis[slot] = Choice::Unit(p);
                    }
                }
            }
        }
        let mut factor = factor.ok_or(None)?;
        let repaired = repair(poly, &rows, moves, &entries, &mut basis, &mut factor, stop)?;
        let columns: Vec<Entries> = repaired.iter().map(|&j| entries(j)).collect();
        let mut factor = Factor::new(k, &columns).map_err(|_| None)?;
        // The rows of M, for the products with the rows of C.
        let mut by_row: Vec<Entries> = vec![Vec::new(); k];
        for (slot, column) in columns.iter().enumerate() {
            for &(p, a) in column {
                by_row[p].push((slot, a));
            }
        }
        let mut reach = Vec::with_capacity(k);
        let mut contraction = 0.0f64;
        let (mut value, mut size) = (vec![0.0; k], vec![0.0; k]);
        let mut touched: Vec<usize> = Vec::new();
        for i in 0..k {
            if i.is_multiple_of(256) && stop() {
                return Err(None);
            }
            let c = factor.backward(&[(i, 1.0)]).ok_or(None)?;
            let sum: f64 = c.iter().map(|&(p, v)| v.abs() * unit[p]).sum();
            reach.push(rounded_up(sum, 2 * c.len()));
            value[i] = -1.0;
            size[i] = 1.0;
            touched.push(i);
            for &(p, v) in c {
                for &(slot, a) in &by_row[p] {
                    if size[slot] == 0.0 {
                        touched.push(slot);
                    }
                    value[slot] += v * a;
                    // Never 0 once touched, even if the product underflows.
                    size[slot] += (v * a).abs() + f64::MIN_POSITIVE;
                }
            }
            let terms = c.len() + 2;
            let mut rest = 0.0;
            for &slot in &touched {
                rest += value[slot].abs() + size[slot] * (terms as f64) * f64::EPSILON;
            }
            contraction = contraction.max(rounded_up(rest, 4 * touched.len()));
            for slot in touched.drain(..) {
                value[slot] = 0.0;
                size[slot] = 0.0;
            }
        }
        if contraction.is_nan() || contraction > 0.5 || !reach.iter().all(|r| r.is_finite()) {
            return Err(None);
        }
        Ok(Self {
            rows,
            basis: repaired,
            factor,
            reach,
            unit,
            contraction,
        })
    }

    /// The equations.
    pub(super) fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Moves the basis columns of `x` until the equations hold as well as pairs of numbers allow,
    /// and encloses the point at which they hold exactly. None: numbers broke down.
    pub(super) fn enclose(&mut self, poly: &Problem, x: &mut Enclosed) -> Option<()> {
        for _ in 0..4 {
            let mut rest: Vec<f64> = Vec::with_capacity(self.rows.len());
            for &i in &self.rows {
                rest.push(-self.rest(poly, i, x).value().middle());
            }
            self.factor.forward_dense(&mut rest)?;
            for (&j, &step) in self.basis.iter().zip(&rest) {
                let (s, e) = two_sum(x.high[j], step);
                let (high, low) = two_sum(s, x.low[j] + e);
                x.high[j] = high;
                x.low[j] = low;
            }
        }
        let mut worst = 0.0f64;
        for (p, &i) in self.rows.iter().enumerate() {
            let rest = self.rest(poly, i, x).value().magnitude();
            worst = worst.max((rest / self.unit[p]).next_up());
        }
        if !worst.is_finite() {
            return None;
        }
        let top = self.reach.iter().fold(0.0f64, |t, &r| t.max(r));
        let tail = (self.contraction / (1.0 - self.contraction) * top).next_up() * (1.0 + 1e-10);
        for (&j, &r) in self.basis.iter().zip(&self.reach) {
            x.radius[j] = ((r + tail) * worst * (1.0 + 1e-10)).next_up();
        }
        Some(())
    }

    /// Row minus its right-hand side.
    fn rest(&self, poly: &Problem, i: usize, x: &Enclosed) -> WideSum {
        // A held row is at the side where it is; an equation at either.
        let mut sum = WideSum::new(-x.target[i]);
        for (j, a) in poly.rows.line(i) {
            sum.add_product(a, x.high[j]);
            if x.low[j] != 0.0 {
                sum.add_product(a, x.low[j]);
            }
        }
        sum
    }
}

/// What stands in a slot of the basis while it is being chosen.
#[derive(Clone, Copy)]
enum Choice {
    Column(usize),
    /// Nothing yet: the equation of this position stands in.
    Unit(usize),
}

impl Choice {
    fn entries(&self, of_column: &dyn Fn(usize) -> Entries) -> Entries {
        match *self {
            Self::Column(j) => of_column(j),
            Self::Unit(p) => vec![(p, 1.0)],
        }
    }
}

/// A column of its own for each equation, the equations with the fewest candidates first.
fn choose(
    poly: &Problem,
    rows: &[usize],
    moves: &[bool],
    entries: &dyn Fn(usize) -> Entries,
) -> Vec<Choice> {
    let shape: Vec<(f64, f64)> = (0..poly.n())
        .map(|j| {
            if !moves[j] {
                return (1.0, 0.0);
            }
            let e = entries(j);
            let top = e.iter().fold(0.0f64, |t, &(_, a)| t.max(a.abs()));
            (top, 1.0 / (e.len().max(1) as f64))
        })
        .collect();
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by_key(|&p| {
        let line = poly.rows.line(rows[p]);
        (line.filter(|&(j, _)| moves[j]).count(), p)
    });
    let mut taken = vec![false; poly.n()];
    let mut basis: Vec<Choice> = (0..rows.len()).map(Choice::Unit).collect();
    for p in order {
        let mut best = (0.0, None);
        for (j, a) in poly.rows.line(rows[p]) {
            let (top, value) = shape[j];
            let score = value * a.abs() / top;
            if !taken[j] && score > best.0 {
                best = (score, Some(j));
            }
        }
        if let Some(j) = best.1 {
            taken[j] = true;
            basis[p] = Choice::Column(j);
        }
    }
    basis
}

/// Brings a column into every slot that has none.
fn repair(
    poly: &Problem,
    rows: &[usize],
    moves: &[bool],
    entries: &dyn Fn(usize) -> Entries,
    basis: &mut [Choice],
    factor: &mut Factor,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Vec<usize>, Option<usize>> {
    let mut inside = vec![false; poly.n()];
    for c in basis.iter() {
        if let Choice::Column(j) = *c {
            inside[j] = true;
        }
    }
    for slot in 0..basis.len() {
        let Choice::Unit(p) = basis[slot] else {
            continue;
        };
        if stop() {
            return Err(None);
        }
        let rho = factor.backward(&[(slot, 1.0)]).ok_or(None)?.clone();
        let mut pivots: std::collections::BTreeMap<usize, f64> = std::collections::BTreeMap::new();
        let mut size = 0.0f64;
        for &(q, r) in &rho {
            for (j, a) in poly.rows.line(rows[q]) {
                if moves[j] && !inside[j] {
                    *pivots.entry(j).or_default() += r * a;
                    size = size.max((r * a).abs());
                }
            }
        }
        let mut best = (0.0, None);
        for (&j, &v) in &pivots {
            if v.abs() > (1e-9 * size.max(1e-9)).max(best.0) {
                best = (v.abs(), Some(j));
            }
        }
        let Some(j) = best.1 else {
            return Err(Some(rows[p]));
        };
        inside[j] = true;
        basis[slot] = Choice::Column(j);
        if !factor.replace(slot, &entries(j)) || factor.is_worn() {
            let columns: Vec<Entries> = basis.iter().map(|c| c.entries(entries)).collect();
            *factor = Factor::new(basis.len(), &columns).map_err(|_| None)?;
        }
    }
    let chosen = basis.iter().map(|&c| match c {
        Choice::Column(j) => Some(j),
        Choice::Unit(_) => None,
    });
    chosen.collect::<Option<Vec<usize>>>().ok_or(None)
}
