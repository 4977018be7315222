//! The primal simplex method: from a primal feasible basis to an optimal one.
//!
//! A nonbasic variable whose reduced cost has the wrong sign enters; it moves until a basic
//! variable reaches a bound, which leaves, or until it reaches its own other bound.

use super::factor::Entries;
use super::{NONBASIC, PIVOT, SAFE_PIVOT, Simplex, Stop};
use crate::solve::lp::Ended;

/// Where a moving variable stops.
enum Block {
    /// At a basic variable's bound: its slot and the bound.
    Slot(usize, f64),
    /// At its own other bound.
    Own(f64),
    /// Nowhere.
    Never,
}

impl Simplex {
    /// Pivots until no reduced cost has the wrong sign.
    pub(super) fn primal(&mut self, stop: &mut dyn FnMut(u64) -> Option<Ended>) -> Stop {
        let mut refused: Vec<u32> = Vec::new();
        // After a flip the reduced costs are what they were: those who come next in their order.
        let mut next: Vec<u32> = Vec::new();
        loop {
            if self.iterations.is_multiple_of(32)
                && let Some(why) = stop(self.iterations)
            {
                return Stop::Ended(why);
            }
            if self.is_spent() {
                return Stop::Ended(Ended::Iterations);
            }
            let fresh = self.is_fresh();
            let entering = next.pop().map(|j| j as usize);
            let Some(entering) = entering.or_else(|| self.priced(&refused)) else {
                if self.is_trusted() {
                    return Stop::Done;
                }
                if self.refactor().is_none() {
                    return Stop::Ended(Ended::Failed);
                }
                refused.clear();
                continue;
            };
            let a_q = self.column(entering);
            let column = self.factor.as_mut().and_then(|f| f.forward(&a_q).cloned());
            let Some(column) = column else {
                if fresh || self.refactor().is_none() {
                    return Stop::Ended(Ended::Failed);
                }
                next.clear();
                continue;
            };
            let up = self.d[entering] < 0.0;
            let sigma = if up { 1.0 } else { -1.0 };
            match self.block(entering, sigma, &column, fresh) {
                Some(Block::Never) if fresh => {
                    let mut direction = vec![0.0; self.n + self.m];
                    direction[entering] = sigma;
                    for &(k, a) in &column {
                        direction[self.head[k] as usize] = -sigma * a;
                    }
                    return Stop::Unbounded(direction);
                }
                Some(Block::Own(bound)) => {
                    let step = (bound - self.x[entering]).abs();
                    self.advance(&column, sigma * step);
                    self.x[entering] = bound;
                    self.iterations += 1;
                    refused.clear();
                    if next.is_empty() {
                        next = self.all_priced();
                    }
                }
                Some(Block::Slot(slot, bound)) => {
                    next.clear();
                    if self
                        .primal_pivot(entering, sigma, &column, slot, bound)
                        .is_none()
                        && self.refactor().is_none()
                    {
                        return Stop::Ended(Ended::Failed);
                    }
                    refused.clear();
                }
                // The pivots are not to be trusted.
                Some(Block::Never) | None => {
                    next.clear();
                    if fresh {
                        refused.push(entering as u32);
                        if refused.len() > 50 {
                            return Stop::Ended(Ended::Failed);
                        }
                    } else if self.refactor().is_none() {
                        return Stop::Ended(Ended::Failed);
                    }
                }
            }
        }
    }

    /// The variable that enters: largest violation relative to its Devex weight.
    fn priced(&self, refused: &[u32]) -> Option<usize> {
        let mut best = (0.0, None);
        for j in 0..self.n + self.m {
            let score = self.score(j);
            if score > best.0 && !refused.contains(&(j as u32)) {
                best = (score, Some(j));
            }
        }
        best.1
    }

    /// All that may enter, the best last.
    fn all_priced(&self) -> Vec<u32> {
        let scores = (0..self.n + self.m).map(|j| (self.score(j), j as u32));
        let mut scores: Vec<(f64, u32)> = scores.filter(|s| s.0 > 0.0).collect();
        scores.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        scores.into_iter().map(|s| s.1).collect()
    }

    /// What a variable is worth as the entering one; 0 for one that may not enter.
    fn score(&self, j: usize) -> f64 {
        if self.slot[j] != NONBASIC || self.d[j].abs() <= self.dual_tolerance {
            return 0.0;
        }
        match self.dual_violation(j) {
            v if v > self.dual_tolerance => v * v / self.devex[j],
            _ => 0.0,
        }
    }

    /// Harris's ratio test. None: the best pivot is too small to be trusted.
    fn block(&self, entering: usize, sigma: f64, column: &Entries, fresh: bool) -> Option<Block> {
        let slack = 0.5 * self.tolerance;
        // Distance of a basic variable to the bound it moves to.
        let distance = |k: usize, rate: f64| {
            let j = self.head[k] as usize;
            if rate > 0.0 {
                self.x[j] - self.work_lower[j]
            } else {
                self.work_upper[j] - self.x[j]
            }
        };
        let mut limit = f64::INFINITY;
        for &(k, a) in column {
            let rate = sigma * a;
            if rate.abs() > PIVOT {
                limit = limit.min((distance(k, rate).max(0.0) + slack) / rate.abs());
            }
        }
        let range = self.work_upper[entering] - self.work_lower[entering];
        if range <= limit {
            let bound = if sigma > 0.0 {
                self.work_upper[entering]
            } else {
                self.work_lower[entering]
            };
            return Some(if bound.is_finite() {
                Block::Own(bound)
            } else {
                Block::Never
            });
        }
        if limit.is_infinite() {
            return Some(Block::Never);
        }
        let mut best = (0.0, 0, 0.0);
        for &(k, a) in column {
            let rate = sigma * a;
            if rate.abs() > PIVOT && rate.abs() > best.0 && distance(k, rate) / rate.abs() <= limit
            {
                best = (rate.abs(), k, rate);
            }
        }
        let (size, k, rate) = best;
        if size < if fresh { 100.0 * PIVOT } else { SAFE_PIVOT } {
            return None;
        }
        let j = self.head[k] as usize;
        let bound = if rate > 0.0 {
            self.work_lower[j]
        } else {
            self.work_upper[j]
        };
        Some(Block::Slot(k, bound))
    }

    /// Moves the basic variables along the entering one's column.
    fn advance(&mut self, column: &Entries, step: f64) {
        if step != 0.0 {
            for &(k, a) in column {
                self.x[self.head[k] as usize] -= step * a;
            }
        }
    }

    fn primal_pivot(
        &mut self,
        entering: usize,
        sigma: f64,
        column: &Entries,
        slot: usize,
        bound: f64,
    ) -> Option<()> {
        let alpha = column.iter().find(|e| e.0 == slot)?.1;
        let leaving = self.head[slot] as usize;
        // Within Harris's slack the exact step may be backwards: then the variable leaves from
        // where it is, a little beyond its bound.
        let exact = (self.x[leaving] - bound) / (sigma * alpha);
        let step = exact.max(0.0);
        let rho = self.factor.as_mut()?.backward(&[(slot, 1.0)])?.clone();
        self.pivot_row(&rho);
        self.advance(column, sigma * step);
        self.x[entering] += sigma * step;
        if exact >= 0.0 {
            self.x[leaving] = bound;
        }
        let theta = self.d[entering] / alpha;
        let weight = self.devex[entering];
        let mut top = 1.0f64;
        for k in 0..self.row_index.len() {
            let j = self.row_index[k] as usize;
            let r = self.row[j];
            self.d[j] -= theta * r;
            let ratio = r / alpha;
            self.devex[j] = self.devex[j].max(ratio * ratio * weight);
            top = top.max(self.devex[j]);
        }
        self.d[leaving] = -theta;
        self.devex[leaving] = (weight / (alpha * alpha)).max(1.0);
        if top > 1e7 {
            self.devex.fill(1.0);
        }
        self.add_work(self.n + self.m, rho.len() + column.len());
        self.iterations += 1;
        self.exchange(slot, entering)
    }
}
