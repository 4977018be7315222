//! What bounds imply for other bounds: rows, thresholds and ordered sets, followed until nothing moves.

use super::model::{FEASIBLE, INTEGRAL, Mip};
use std::collections::VecDeque;

/// A row's least and largest activity over bounds, with the infinite terms counted apart.
#[derive(Clone, Copy, Default)]
pub struct Activity {
    low: f64,
    high: f64,
    low_infinite: u32,
    high_infinite: u32,
    size: f64,
}

/// The larger end of a·\[l, u\].
fn top(a: f64, l: f64, u: f64) -> f64 {
    if a > 0.0 { a * u } else { a * l }
}

impl Activity {
    /// Of a row over these bounds.
    pub fn of(mip: &Mip, row: usize, lower: &[f64], upper: &[f64]) -> Self {
        let mut s = Self::default();
        for (j, a) in mip.problem.rows.line(row) {
            let high = top(a, lower[j], upper[j]);
            let low = -top(-a, lower[j], upper[j]);
            match low.is_finite() {
                true => s.low += low,
                false => s.low_infinite += 1,
            }
            match high.is_finite() {
                true => s.high += high,
                false => s.high_infinite += 1,
            }
            let larger = |v: f64| if v.is_finite() { v.abs() } else { 0.0 };
            s.size = s.size.max(larger(low)).max(larger(high));
        }
        s
    }

    /// The least activity.
    pub fn least(&self) -> f64 {
        if self.low_infinite > 0 {
            f64::NEG_INFINITY
        } else {
            self.low
        }
    }

    /// The largest activity.
    pub fn most(&self) -> f64 {
        if self.high_infinite > 0 {
            f64::INFINITY
        } else {
            self.high
        }
    }

    /// What rounding may have done to it.
    pub fn slack(&self) -> f64 {
        FEASIBLE * self.size.max(1.0)
    }
}

/// Works on one program; its queue is empty between runs.
pub struct Propagator {
    queue: VecDeque<u32>,
    queued: Vec<bool>,
    /// Bounds of continuous columns are tightened as well, where they were infinite or shrink to a half.
    pub continuous: bool,
    /// Columns whose bounds the last run moved.
    pub moved: Vec<usize>,
}

impl Propagator {
    /// For a program.
    pub fn new(mip: &Mip) -> Self {
        Self {
            queue: VecDeque::new(),
            queued: vec![false; mip.problem.m()],
            continuous: false,
            moved: Vec::new(),
        }
    }

    fn enqueue(&mut self, mip: &Mip, column: usize) {
        for (i, _) in mip.problem.columns.line(column) {
            if !self.queued[i] {
                self.queued[i] = true;
                self.queue.push_back(i as u32);
            }
        }
    }

    /// Tightens bounds that follow from those of `columns` (None: from all rows). False: nothing satisfies them.
    pub fn run(
        &mut self,
        mip: &Mip,
        columns: Option<&[usize]>,
        lower: &mut [f64],
        upper: &mut [f64],
    ) -> bool {
        self.moved.clear();
        match columns {
            Some(columns) => columns.iter().for_each(|&j| self.enqueue(mip, j)),
            None => {
                self.queue.extend(0..mip.problem.m() as u32);
                self.queued.fill(true);
            }
        }
        let mut fine = true;
        let mut budget = 50 * mip.problem.rows.value.len() + 1000;
        loop {
            while let Some(i) = self.queue.pop_front() {
                self.queued[i as usize] = false;
                let length =
                    mip.problem.rows.start[i as usize + 1] - mip.problem.rows.start[i as usize];
                budget = budget.saturating_sub(length);
                fine &= budget == 0 || self.row(mip, i as usize, lower, upper);
                if !fine || budget == 0 {
                    self.queue
                        .drain(..)
                        .for_each(|i| self.queued[i as usize] = false);
                }
            }
            let before = self.moved.len();
            if !fine || !self.thresholds_and_sets(mip, lower, upper) {
                self.queue
                    .drain(..)
                    .for_each(|i| self.queued[i as usize] = false);
                return false;
            }
            if self.moved.len() == before || budget == 0 {
                self.queue
                    .drain(..)
                    .for_each(|i| self.queued[i as usize] = false);
                return true;
            }
        }
    }

    fn row(&mut self, mip: &Mip, i: usize, lower: &mut [f64], upper: &mut [f64]) -> bool {
        let p = &mip.problem;
        let (least, most) = (p.row_lower[i], p.row_upper[i]);
        let at = Activity::of(mip, i, lower, upper);
        if at.least() > most + at.slack() || at.most() < least - at.slack() {
            return false;
        }
        let idle_high = most.is_infinite() || at.most() <= most || at.low_infinite > 1;
        let idle_low = least.is_infinite() || at.least() >= least || at.high_infinite > 1;
        if idle_high && idle_low {
            return true;
        }
        for (j, a) in p.rows.line(i) {
            let (l, u) = (lower[j], upper[j]);
            if l == u || a == 0.0 || !(mip.integer[j] || self.continuous) {
                continue;
            }
            let (mut new_l, mut new_u) = (l, u);
            let mut limit = |value: f64, above: bool| {
                if above {
                    new_u = new_u.min(value);
                } else {
                    new_l = new_l.max(value);
                }
            };
            if !idle_high {
                let own = -top(-a, l, u);
                let (own, infinite) = if own.is_finite() { (own, 0) } else { (0.0, 1) };
                if at.low_infinite == infinite {
                    limit((most - (at.low - own)) / a, a > 0.0);
                }
            }
            if !idle_low {
                let own = top(a, l, u);
                let (own, infinite) = if own.is_finite() { (own, 0) } else { (0.0, 1) };
                if at.high_infinite == infinite {
                    limit((least - (at.high - own)) / a, a < 0.0);
                }
            }
            if mip.integer[j] {
                new_l = (new_l - INTEGRAL).ceil();
                new_u = (new_u + INTEGRAL).floor();
            } else {
                // Widened by the tolerance, and only where it tightens much: such a bound is as good as its row.
                let slack = |v: f64| 1e-7 * v.abs().max(1.0);
                let much = |new: f64, old: f64, range: f64| {
                    new.abs() < 1e7 && (old.is_infinite() || (new - old).abs() > 0.5 * range)
                };
                let range = u - l;
                new_l = if new_l > l && much(new_l, l, range) {
                    new_l - slack(new_l)
                } else {
                    l
                };
                new_u = if new_u < u && much(new_u, u, range) {
                    new_u + slack(new_u)
                } else {
                    u
                };
            }
            if !self.set(mip, j, new_l, new_u, lower, upper) {
                return false;
            }
        }
        true
    }

    /// False: the bounds cross.
    fn set(
        &mut self,
        mip: &Mip,
        j: usize,
        l: f64,
        u: f64,
        lower: &mut [f64],
        upper: &mut [f64],
    ) -> bool {
        let (l, u) = (l.max(lower[j]), u.min(upper[j]));
        if l > u + FEASIBLE * l.abs().max(1.0) {
            return false;
        }
        if l > lower[j] || u < upper[j] {
            (lower[j], upper[j]) = if l > u { (u, u) } else { (l, u) };
            self.moved.push(j);
            self.enqueue(mip, j);
        }
        true
    }

    fn thresholds_and_sets(&mut self, mip: &Mip, lower: &mut [f64], upper: &mut [f64]) -> bool {
        for j in 0..lower.len() {
            let t = mip.threshold[j];
            if t > 0.0 && lower[j] < t {
                if upper[j] < t - FEASIBLE * t.max(1.0) && upper[j] > 0.0 {
                    if !self.set(mip, j, lower[j], 0.0, lower, upper) {
                        return false;
                    }
                } else if lower[j] > FEASIBLE && !self.set(mip, j, t, upper[j], lower, upper) {
                    return false;
                }
            }
        }
        for set in &mip.sets {
            let held = |j: &u32| lower[*j as usize] > 0.0 || upper[*j as usize] < 0.0;
            let Some(first) = set.columns.iter().position(held) else {
                continue;
            };
            let last = set.columns.iter().rposition(held).unwrap_or(first);
            let reach = usize::from(set.neighbours);
            if last - first > reach {
                return false;
            }
            for (k, &j) in set.columns.iter().enumerate() {
                let j = j as usize;
                let far = k + reach < last || k > first + reach;
                if far
                    && (lower[j] != 0.0 || upper[j] != 0.0)
                    && !self.set(mip, j, 0.0, 0.0, lower, upper)
                {
                    return false;
                }
            }
        }
        true
    }
}
