//! The dual simplex method: from a dual feasible basis to an optimal one.
//!
//! A basic variable outside its bounds leaves, at the bound it violates; of the nonbasic
//! variables whose reduced cost would reach 0 first, the one with the largest pivot enters.
//! Variables with two bounds whose reduced cost changes sign on the way change bounds instead
//! (Maros 2003).

use super::factor::Entries;
use super::{NONBASIC, PIVOT, SAFE_PIVOT, Simplex, Stop, jitter};
use crate::solve::lp::Ended;
use crate::solve::lp::form::proves_infeasible;
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// Pivots one after the other that no update of the factor takes: the numbers have broken down.
const REFUSED_UPDATES: u32 = 100;

impl Simplex {
    /// Makes the basis dual feasible, by flipping bounds and, what is left, by shifting costs; then pivots until it is primal
    /// feasible.
    pub(super) fn dual(&mut self, stop: &mut dyn FnMut(u64) -> Option<Ended>) -> Stop {
        self.make_dual_feasible();
        self.pivots(stop)
    }

    /// Whether a variable that no flip helps has a reduced cost of the wrong sign.
    pub(super) fn is_endless_infeasible(&self) -> bool {
        (0..self.n + self.m).any(|j| {
            let endless = self.work_lower[j].is_infinite() || self.work_upper[j].is_infinite();
            endless && self.slot[j] == NONBASIC && self.dual_violation(j) > self.dual_tolerance
        })
    }

    /// Pivots of the dual method, from a dual feasible basis.
    fn pivots(&mut self, stop: &mut dyn FnMut(u64) -> Option<Ended>) -> Stop {
        // Slots that are passed over until the factor is fresh again, or until the next pivot.
        let mut refused = vec![false; self.m];
        let mut bad_rows = 0;
        let mut violations = vec![0.0; self.m];
        // Everything is looked at anew.
        let mut renewed = None;
        let mut largest = 0.0f64;
        loop {
            if self.iterations.is_multiple_of(32)
                && let Some(why) = stop(self.iterations)
            {
                return Stop::Ended(why);
            }
            if self.is_spent() {
                return Stop::Ended(Ended::Iterations);
            }
            if self.refused_updates > REFUSED_UPDATES {
                return Stop::Ended(Ended::Failed);
            }
            if self.cutoff.is_finite() && self.iterations.is_multiple_of(4) {
                let terms = self.work_cost.iter().zip(&self.x).map(|(c, x)| c * x);
                if terms.sum::<f64>() > self.cutoff {
                    return Stop::Ended(Ended::Iterations);
                }
            }
            let fresh = self.is_fresh();
            let mut renew = false;
            if renewed.replace(self.renewals) == Some(self.renewals) {
                for &k in &self.touched {
                    violations[k as usize] = self.squared_violation(k as usize);
                }
            } else {
                (0..self.m).for_each(|k| violations[k] = self.squared_violation(k));
                (0..self.n + self.m).for_each(|j| self.side[j] = self.side_of(j));
            }
            self.touched.clear();
            if self.most_work.is_finite() && self.iterations.is_multiple_of(16) {
                let sum: f64 = violations.iter().map(|v| v.sqrt()).sum();
                largest = largest.max(sum);
                self.left = if largest > 0.0 { sum / largest } else { 1.0 };
            }
            match self.leaving(&violations, &refused) {
                None if fresh || self.is_trusted() && !refused.contains(&true) => {
                    return Stop::Done;
                }
                None => renew = true,
                Some((slot, above)) => match self.dual_step(slot, above) {
                    Step::Done => {
                        bad_rows = 0;
                        if self.is_fresh() {
                            refused.fill(false);
                        }
                    }
                    Step::Nothing(y) if self.is_proof(&y) => {
                        if fresh {
                            return Stop::Infeasible(y);
                        }
                        renew = true;
                    }
                    // Entries too small to pivot on could still help.
                    Step::Nothing(_) => refused[slot] = true,
                    // On a fresh factor the row itself is bad: look at the others first.
                    Step::Unsafe if fresh => {
                        refused[slot] = true;
                        bad_rows += 1;
                        if bad_rows > 50 {
                            return Stop::Ended(Ended::Failed);
                        }
                    }
                    Step::Unsafe | Step::Broken => renew = true,
                },
            }
            if renew {
                refused.fill(false);
                if self.refresh().is_none() {
                    return Stop::Ended(Ended::Failed);
                }
            }
        }
    }

    /// Whether the multipliers prove infeasibility for the true bounds.
    fn is_proof(&self, y: &[f64]) -> bool {
        let (lower, row_lower) = self.lower.split_at(self.n);
        let (upper, row_upper) = self.upper.split_at(self.n);
        proves_infeasible(
            &self.columns,
            [lower, upper],
            [row_lower, row_upper],
            y,
            [1e-9, 1e-9],
        )
    }

    /// Factorises afresh, and shifts away what rounding did to dual feasibility.
    fn refresh(&mut self) -> Option<()> {
        self.refactor()?;
        self.shift_costs(false);
        Some(())
    }

    fn make_dual_feasible(&mut self) {
        let mut flipped = false;
        for j in 0..self.n + self.m {
            let (l, u) = (self.work_lower[j], self.work_upper[j]);
            if self.slot[j] == NONBASIC && l.is_finite() && u.is_finite() {
                let target = if self.d[j] < 0.0 { u } else { l };
                if self.d[j].abs() > self.dual_tolerance {
                    flipped |= self.x[j] != target;
                    self.x[j] = target;
                }
            }
        }
        self.shift_costs(self.perturb);
        // The flips change the basic values.
        if flipped {
            let _ = self.compute_values();
        }
    }

    /// Moves costs so that no reduced cost has the wrong sign; with `perturb` a little further, by a
    /// different amount for each variable, so that ties are rare.
    fn shift_costs(&mut self, perturb: bool) {
        let top = self
            .cost
            .iter()
            .fold(0.0f64, |t, c| t.max(c.abs()))
            .clamp(1e-3, 1e3);
        for j in 0..self.n + self.m {
            if self.slot[j] != NONBASIC || self.work_lower[j] == self.work_upper[j] {
                continue;
            }
            let (l, u) = (self.work_lower[j], self.work_upper[j]);
            let free = l.is_infinite() && u.is_infinite();
            let wrong = self.dual_violation(j) > 0.0;
            let at_lower = self.is_low(j);
            let target = if free || (wrong && !perturb) {
                0.0
            } else if perturb {
                let size = jitter(j) * (5e-7 * top + 1e-6 * self.cost[j].abs());
                let base = if wrong { 0.0 } else { self.d[j] };
                if at_lower { base + size } else { base - size }
            } else {
                continue;
            };
            self.work_cost[j] += target - self.d[j];
            self.d[j] = target;
        }
    }

    fn side_of(&self, j: usize) -> i8 {
        let (l, u) = (self.work_lower[j], self.work_upper[j]);
        match (l == u, l.is_infinite() && u.is_infinite()) {
            (true, _) => 0,
            (_, true) => 2,
            _ if self.is_low(j) => 1,
            _ => -1,
        }
    }

    /// By how much the variable in a slot violates a bound, squared.
    fn squared_violation(&self, slot: usize) -> f64 {
        let j = self.head[slot] as usize;
        let violation = (self.x[j] - self.work_upper[j]).max(self.work_lower[j] - self.x[j]);
        match violation > self.tolerance {
            true => violation * violation,
            false => 0.0,
        }
    }

    /// The slot that leaves: largest violation relative to the steepest-edge weight; and whether it
    /// is above its upper bound.
    fn leaving(&self, violations: &[f64], refused: &[bool]) -> Option<(usize, bool)> {
        let mut best = (0.0, None);
        for (k, (&v, &edge)) in violations.iter().zip(&self.edge).enumerate() {
            if v > best.0 * edge && !refused[k] {
                best = (v / edge, Some(k));
            }
        }
        let slot = best.1?;
        let j = self.head[slot] as usize;
        Some((slot, self.x[j] > self.work_upper[j]))
    }

    fn dual_step(&mut self, slot: usize, above: bool) -> Step {
        let leaving = self.head[slot] as usize;
        let [mut rho, mut column, mut tau] = std::mem::take(&mut self.solutions);
        let Some(factor) = self.factor.as_mut() else {
            return Step::Broken;
        };
        if factor.backward(&[(slot, 1.0)]).is_none() {
            return Step::Broken;
        }
        factor.hand_over(&mut rho);
        self.pivot_row(&rho);
        let sign = if above { 1.0 } else { -1.0 };
        let bound = if above {
            self.work_upper[leaving]
        } else {
            self.work_lower[leaving]
        };
        let violation = (self.x[leaving] - bound).abs();
        let Some((entering, flips)) = self.entering(sign, violation) else {
            // ρᵀ(Ax − s) = 0 for every solution; within bounds its largest value (its smallest, if
            // the variable is below its lower bound) has the wrong sign. So sup ±ρᵀAx < inf ±ρᵀs.
            let mut y = vec![0.0; self.m];
            rho.iter().for_each(|&(i, r)| y[i] = sign * r);
            return Step::Nothing(y);
        };
        let pivot = self.row[entering];
        let fresh = self.is_fresh();
        let top = self.row_top.min(1.0);
        if pivot.abs() < SAFE_PIVOT * top && !fresh {
            return Step::Unsafe;
        }
        if pivot.abs() < PIVOT * 100.0 * top {
            return Step::Unsafe;
        }
        let a_q = self.column(entering);
        let Some(factor) = self.factor.as_mut() else {
            return Step::Broken;
        };
        if factor.forward(&a_q).is_none() {
            return Step::Broken;
        }
        factor.hand_over(&mut column);
        let alpha = column.iter().find(|e| e.0 == slot).map_or(0.0, |e| e.1);
        if (alpha - pivot).abs() > 1e-7 * (top + alpha.abs()) * if fresh { 100.0 } else { 1.0 } {
            return Step::Unsafe;
        }
        // Steepest edge: τ = B⁻¹ρ.
        let weight: f64 = rho.iter().map(|e| e.1 * e.1).sum();
        if factor.forward(&rho).is_none() {
            return Step::Broken;
        }
        factor.hand_over(&mut tau);
        // Flips change the basic values before the step is measured.
        if !flips.is_empty() {
            self.flip(&flips);
        }
        let theta = self.shift_reduced(entering, alpha, sign);
        self.d[leaving] = -theta;
        // Primal step: the leaving variable goes to its bound.
        let step = (self.x[leaving] - bound) / alpha;
        for &(k, a) in &column {
            let j = self.head[k] as usize;
            self.x[j] -= step * a;
            self.touched.push(k as u32);
        }
        self.x[entering] += step;
        self.x[leaving] = bound;
        self.side[leaving] = self.side_of(leaving);
        self.update_weights(slot, alpha, weight, &column, &tau);
        self.add_work(self.m, rho.len() + column.len() + tau.len());
        self.solutions = [rho, column, tau];
        self.iterations += 1;
        let worn = self.exchange(slot, entering);
        if worn.is_none() {
            return Step::Broken;
        }
        if self.is_fresh() {
            self.shift_costs(false);
        }
        Step::Done
    }

    /// The dual step: the entering reduced cost becomes 0; those of the wrong sign are shifted away. Returns its length.
    fn shift_reduced(&mut self, entering: usize, alpha: f64, sign: f64) -> f64 {
        let mut theta = self.d[entering] / alpha;
        if theta * sign < 0.0 {
            self.work_cost[entering] -= self.d[entering];
            self.d[entering] = 0.0;
            theta = 0.0;
        }
        if theta != 0.0 {
            for k in 0..self.row_index.len() {
                let j = self.row_index[k] as usize;
                let before = self.d[j];
                self.d[j] -= theta * self.row[j];
                // All signs were right before.
                let turned = before * self.d[j] <= 0.0;
                if turned && j != entering && self.dual_violation(j) > 0.0 {
                    self.work_cost[j] -= self.d[j];
                    self.d[j] = 0.0;
                }
            }
        }
        theta
    }

    /// Steepest-edge weights for the next basis; `tau` is B⁻¹ρ, `weight` |ρ|².
    fn update_weights(
        &mut self,
        slot: usize,
        alpha: f64,
        weight: f64,
        column: &Entries,
        tau: &Entries,
    ) {
        let mut t = tau.iter().peekable();
        for &(k, a) in column {
            if k == slot {
                continue;
            }
            while t.peek().is_some_and(|e| e.0 < k) {
                t.next();
            }
            let tau_k = t.peek().filter(|e| e.0 == k).map_or(0.0, |e| e.1);
            let ratio = a / alpha;
            let w = self.edge[k] - 2.0 * ratio * tau_k + ratio * ratio * weight;
            self.edge[k] = w.max(1e-4).max(1e-3 * ratio * ratio * weight);
        }
        self.edge[slot] = (weight / (alpha * alpha)).max(1e-4);
    }

    /// The entering variable and the variables that change bounds. None: no variable can enter.
    fn entering(&self, sign: f64, violation: f64) -> Option<(usize, Vec<u32>)> {
        // What is noise depends on the row: entries of one that is small throughout count.
        let top = self.row_top;
        let noise = PIVOT * top.min(1.0);
        // Candidates with their pivots, oriented so that a ratio is d/α ≥ 0.
        let mut candidates: Vec<(u32, f64, f64)> = Vec::new();
        let (row, d, side) = (&self.row[..], &self.d[..], &self.side[..]);
        for &j in &self.row_index {
            let k = j as usize;
            let (alpha, side) = (sign * row[k], side[k]);
            let free = side == 2;
            let may = free || side != 0 && (alpha > 0.0) == (side > 0);
            if may && alpha.abs() > noise {
                candidates.push((j, alpha.abs(), if free { 0.0 } else { d[k].abs() }));
            }
        }
        // In the order of their ratios, each group by the ratios with slack: what is left has larger ones. Mostly the first is all.
        let slack = 0.5 * self.dual_tolerance;
        let limits = candidates.iter().map(|c| (c.2 + slack) / c.1);
        let first = limits.fold(f64::INFINITY, f64::min);
        let (mut group, mut queue) = (Vec::new(), BinaryHeap::new());
        let mut later = Vec::new();
        for (k, c) in candidates.iter().enumerate() {
            match c.2 / c.1 <= first {
                true => group.push(k),
                false => later.push(k),
            }
        }
        let mut slope = violation;
        let mut flips: Vec<u32> = Vec::new();
        let mut reserve: Option<(usize, usize)> = None;
        while !group.is_empty() {
            let before = flips.len();
            let mut drop = 0.0;
            let mut best = (0.0, usize::MAX);
            for k in group.drain(..) {
                let (j, alpha, _) = candidates[k];
                drop += alpha * (self.work_upper[j as usize] - self.work_lower[j as usize]);
                if alpha > best.0 || (alpha == best.0 && k < best.1) {
                    best = (alpha, k);
                }
                flips.push(j);
            }
            let entering = candidates[best.1].0 as usize;
            let enough = best.0 >= SAFE_PIVOT * top.min(1.0);
            if slope - drop < 0.0 || drop.is_nan() {
                flips.truncate(before);
                if enough || reserve.is_none() {
                    return Some((entering, flips));
                }
                break;
            }
            // The violation outlasts the whole group: all of it changes bounds.
            if enough {
                reserve = Some((entering, before));
            }
            slope -= drop;
            if !later.is_empty() {
                let ratio = |k: usize| Reverse(Ratio(candidates[k].2 / candidates[k].1, k));
                queue = later.drain(..).map(ratio).collect();
            }
            let mut limit = f64::INFINITY;
            while let Some(&Reverse(Ratio(ratio, k))) = queue.peek()
                && ratio <= limit
            {
                queue.pop();
                limit = limit.min((candidates[k].2 + slack) / candidates[k].1);
                group.push(k);
            }
        }
        // Every candidate was passed, or only bad pivots were left: the last good one enters.
        let (entering, flipped) = reserve?;
        if flips.len() == candidates.len() && slope > self.tolerance {
            // All can change bounds and the violation is still there: infeasible.
            return None;
        }
        flips.truncate(flipped);
        Some((entering, flips))
    }

    /// Moves variables to their other bounds and updates the basic values.
    fn flip(&mut self, flips: &[u32]) {
        let mut change = vec![0.0; self.m];
        for &j in flips {
            let j = j as usize;
            let (l, u) = (self.work_lower[j], self.work_upper[j]);
            let to = if self.x[j] - l <= u - self.x[j] { u } else { l };
            let by = to - self.x[j];
            self.x[j] = to;
            self.side[j] = -self.side[j];
            (self.column(j).iter()).for_each(|&(i, a)| change[i] += a * by);
        }
        let change = change.into_iter().enumerate();
        let change: Entries = change.filter(|e| e.1 != 0.0).collect();
        if let Some(moved) = self
            .factor
            .as_mut()
            .and_then(|f| f.forward(&change).cloned())
        {
            for (k, v) in moved {
                self.touched.push(k as u32);
                self.x[self.head[k] as usize] -= v;
            }
        }
    }
}

/// At which ratio a reduced cost reaches 0, and whose it is.
#[derive(PartialEq)]
struct Ratio(f64, usize);

impl Eq for Ratio {}

impl Ord for Ratio {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(self.1.cmp(&other.1))
    }
}

impl PartialOrd for Ratio {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

enum Step {
    /// A pivot was made.
    Done,
    /// No variable can enter: these multipliers prove infeasibility.
    Nothing(Vec<f64>),
    /// The pivot is not to be trusted.
    Unsafe,
    /// The factor broke down.
    Broken,
}
