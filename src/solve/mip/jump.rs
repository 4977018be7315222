//! Solutions without linear programs: feasibility jump (Luteberget & Sartor 2023).
//!
//! One column after the other goes to where the weighted violations of the rows are least. Where no step lessens them, the
//! rows that are violated weigh more from then on. Once there is a solution, the objective is a row as well: the next must be
//! better. It finds what plunges and dives miss where many columns must agree with each other: packings, schedules, puzzles.

use super::model::Mip;
use super::relaxation::{Control, Relaxation};
use super::tree::Search;
use crate::solve::Settings;
use crate::solve::lp::form::Sparse;
use crate::solve::random::Random;
use crate::solve::strategy::Strategy;

/// A violation of a row up to this, relative to its side, is none.
const TOLERANCE: f64 = 1e-7;

/// Steps among which the best is taken.
const MAX_SAMPLED_STEPS: usize = 25;

/// What a step must lessen.
const MIN_GAIN: f64 = 1e-7;

/// Some numbers below n, with their places, to go in and out at once.
struct Subset {
    members: Vec<u32>,
    place: Vec<u32>,
}

impl Subset {
    fn new(n: usize) -> Self {
        Self {
            members: Vec::new(),
            place: vec![u32::MAX; n],
        }
    }

    fn set(&mut self, k: usize, inside: bool) {
        match (self.place[k], inside) {
            (u32::MAX, true) => {
                self.place[k] = self.members.len() as u32;
                self.members.push(k as u32);
            }
            (at, false) if at != u32::MAX => {
                self.members.swap_remove(at as usize);
                if let Some(&moved) = self.members.get(at as usize) {
                    self.place[moved as usize] = at;
                }
                self.place[k] = u32::MAX;
            }
            _ => {}
        }
    }
}

/// A walk from point to point. The last row is the objective.
struct Walk<'m> {
    mip: &'m Mip,
    rows: Sparse,
    columns: Sparse,
    sides: Vec<[f64; 2]>,
    lower: &'m [f64],
    upper: &'m [f64],
    x: Vec<f64>,
    activity: Vec<f64>,
    weight: Vec<f64>,
    /// By row: what it gains in weight when it is violated, so that its largest coefficient counts as 1.
    unit: Vec<f64>,
    /// By column: where it would go, and what that does to the violations.
    target: Vec<f64>,
    score: Vec<f64>,
    /// Columns whose step lessens them.
    good: Subset,
    violated: Subset,
    random: Random,
    /// Entries of rows that were touched.
    work: u64,
}

/// How far a value is outside two sides.
#[inline]
fn outside(value: f64, [low, high]: [f64; 2]) -> f64 {
    let far = (low - value).max(value - high);
    match far > TOLERANCE * value.abs().max(1.0) {
        true => far,
        false => 0.0,
    }
}

impl<'m> Walk<'m> {
    /// From a point, within these bounds; integers are rounded.
    fn new(mip: &'m Mip, lower: &'m [f64], upper: &'m [f64], start: &[f64], seed: u64) -> Self {
        let p = &mip.problem;
        let (n, m) = (p.n(), p.m());
        let costs = p.cost.iter().copied().enumerate().filter(|c| c.1 != 0.0);
        let mut rows = p.rows.clone();
        rows.push(costs);
        let sides = p.row_lower.iter().zip(&p.row_upper);
        let mut sides: Vec<[f64; 2]> = sides.map(|(l, u)| [*l, *u]).collect();
        sides.push([f64::NEG_INFINITY, f64::INFINITY]);
        let unit = |i: usize| {
            let largest = rows.line(i).fold(0.0f64, |t, e| t.max(e.1.abs()));
            if largest > 0.0 { 1.0 / largest } else { 1.0 }
        };
        let unit: Vec<f64> = (0..=m).map(unit).collect();
        let inside = |(j, &x): (usize, &f64)| {
            let x = if mip.integer[j] { x.round() } else { x };
            x.max(lower[j]).min(upper[j])
        };
        let mut walk = Self {
            mip,
            columns: rows.transpose(n),
            rows,
            sides,
            lower,
            upper,
            x: start.iter().enumerate().map(inside).collect(),
            activity: vec![0.0; m + 1],
            weight: unit.clone(),
            unit,
            target: vec![0.0; n],
            score: vec![0.0; n],
            good: Subset::new(n),
            violated: Subset::new(m + 1),
            random: Random(seed),
            work: 0,
        };
        walk.refresh();
        (0..n).for_each(|j| walk.aim(j));
        walk
    }

    fn below(&mut self, n: usize) -> usize {
        (self.random.uniform() * n as f64) as usize
    }

    /// Activities without what rounding has added to them.
    fn refresh(&mut self) {
        for i in 0..self.activity.len() {
            let terms = self.rows.line(i).map(|(j, a)| a * self.x[j]);
            self.activity[i] = terms.sum();
            let far = outside(self.activity[i], self.sides[i]);
            self.violated.set(i, far > 0.0);
        }
        self.work += self.rows.value.len() as u64;
    }

    /// From now on the objective must not be above this.
    fn limit(&mut self, most: f64) {
        let i = self.activity.len() - 1;
        self.sides[i][1] = most;
        let far = outside(self.activity[i], self.sides[i]);
        self.violated.set(i, far > 0.0);
        (0..self.x.len()).for_each(|j| self.aim(j));
    }

    /// Weighted violations with column j there.
    fn cost(&self, j: usize, value: f64) -> f64 {
        let d = value - self.x[j];
        let of = |(i, a): (usize, f64)| {
            self.weight[i] * outside(self.activity[i] + a * d, self.sides[i])
        };
        self.columns.line(j).map(of).sum()
    }

    fn is_binary(&self, j: usize) -> bool {
        self.mip.integer[j] && self.lower[j] == 0.0 && self.upper[j] == 1.0
    }

    /// Where column j would go.
    fn aim(&mut self, j: usize) {
        let (l, u, x) = (self.lower[j], self.upper[j], self.x[j]);
        self.work += self.columns.line(j).len() as u64;
        let target = match () {
            () if l == u => x,
            () if self.is_binary(j) => 1.0 - x,
            () => self.least(j),
        };
        self.target[j] = target;
        self.score[j] = match target == x {
            true => 0.0,
            false => self.cost(j, target) - self.cost(j, x),
        };
        self.good.set(j, self.score[j] < -MIN_GAIN);
    }

    /// The value of column j with the least weighted violations, other than the present one where it is an integer: their
    /// slope grows from one end of a row to the next.
    fn least(&self, j: usize) -> f64 {
        let (l, u, x) = (self.lower[j], self.upper[j], self.x[j]);
        let mut ends: Vec<(f64, f64)> = Vec::new();
        let mut slope = 0.0;
        for (i, a) in self.columns.line(j) {
            let w = self.weight[i] * a.abs();
            let mut at = self.sides[i].map(|side| x + (side - self.activity[i]) / a);
            if a < 0.0 {
                at.swap(0, 1);
            }
            if at[0].is_finite() {
                slope -= w;
                ends.push((at[0], w));
            }
            if at[1].is_finite() {
                ends.push((at[1], w));
            }
        }
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best = if slope < 0.0 { x } else { l.max(x.min(u)) };
        for (at, w) in ends {
            if slope >= 0.0 {
                break;
            }
            slope += w;
            best = at;
        }
        let best = best.max(l).min(u);
        if !self.mip.integer[j] {
            return best;
        }
        let near = match best == x {
            true => [x - 1.0, x + 1.0],
            false => [best.floor(), best.ceil()],
        };
        let allowed = near.into_iter().filter(|v| *v >= l && *v <= u && *v != x);
        let least = allowed.min_by(|v, w| self.cost(j, *v).total_cmp(&self.cost(j, *w)));
        least.unwrap_or(x)
    }

    /// The column with the best step of a few; numbers of columns by their place in a list.
    fn best(&mut self, of: impl Fn(&Self, usize) -> usize, count: usize) -> Option<usize> {
        let mut best: Option<usize> = None;
        for k in 0..MAX_SAMPLED_STEPS.min(count) {
            let k = if count <= MAX_SAMPLED_STEPS {
                k
            } else {
                self.below(count)
            };
            let j = of(self, k);
            if self.target[j] != self.x[j] && best.is_none_or(|b| self.score[j] < self.score[b]) {
                best = Some(j);
            }
        }
        best
    }

    /// The next step: one that lessens violations, or, after those that are there have got more weight, one in a violated row.
    fn choose(&mut self) -> Option<usize> {
        let count = self.good.members.len();
        if let Some(j) = self.best(|s, k| s.good.members[k] as usize, count) {
            // what is not binary may have a better place by now
            if !self.is_binary(j) {
                self.aim(j);
            }
            if self.score[j] < -MIN_GAIN {
                return Some(j);
            }
        }
        for k in 0..self.violated.members.len() {
            let i = self.violated.members[k] as usize;
            let unit = self.unit[i];
            self.weight[i] += unit;
            let (now, sides) = (self.activity[i], self.sides[i]);
            let here = outside(now, sides);
            for (j, a) in self.rows.line(i) {
                let d = self.target[j] - self.x[j];
                self.score[j] += unit * (outside(now + a * d, sides) - here);
                self.good.set(j, self.score[j] < -MIN_GAIN);
            }
            self.work += self.rows.line(i).len() as u64;
        }
        let k = self.below(self.violated.members.len());
        let i = self.violated.members[k] as usize;
        let first = self.rows.start[i];
        let count = self.rows.start[i + 1] - first;
        let j = self.best(|s, k| s.rows.index[first + k] as usize, count)?;
        if !self.is_binary(j) {
            self.aim(j);
        }
        Some(j)
    }

    /// Goes there.
    fn step(&mut self, j: usize) {
        let d = self.target[j] - self.x[j];
        let entries = self.columns.start[j]..self.columns.start[j + 1];
        for e in entries {
            let (i, a) = (self.columns.index[e] as usize, self.columns.value[e]);
            let (old, sides, w) = (self.activity[i], self.sides[i], self.weight[i]);
            let new = old + a * d;
            self.activity[i] = new;
            let (before, after) = (outside(old, sides), outside(new, sides));
            self.violated.set(i, after > 0.0);
            let line = self.rows.start[i]..self.rows.start[i + 1];
            self.work += line.len() as u64;
            for t in line {
                let (k, b) = (self.rows.index[t] as usize, self.rows.value[t]);
                let s = b * (self.target[k] - self.x[k]);
                let change = outside(new + s, sides) - after - outside(old + s, sides) + before;
                if k != j && change != 0.0 {
                    self.score[k] += w * change;
                    self.good.set(k, self.score[k] < -MIN_GAIN);
                }
            }
        }
        self.x[j] = self.target[j];
        self.aim(j);
    }

    /// Walks to a point that satisfies all rows. None: not within so much work.
    fn run(&mut self, most: u64, stop: &mut dyn FnMut() -> bool) -> Option<Vec<f64>> {
        let mut steps = 0u32;
        while self.work < most {
            steps += 1;
            if steps.is_multiple_of(1000) && stop() {
                return None;
            }
            if self.violated.members.is_empty() {
                self.refresh();
                if self.violated.members.is_empty() {
                    return Some(self.x.clone());
                }
            }
            match self.choose() {
                Some(j) => self.step(j),
                None => self.work += 10,
            }
        }
        None
    }
}

impl<R: Relaxation> Search<'_, R> {
    /// Entries that a walk may touch.
    fn jump_work(&self) -> u64 {
        (2000 * self.mip.problem.rows.value.len() as u64).clamp(200_000, 20_000_000)
    }

    /// Walks between plunges: often while there is no solution, for a tenth of the time at most.
    pub(super) fn jump_again(&mut self, control: &mut Control) {
        let entries = self.mip.problem.rows.value.len() as u64;
        let affordable = self.dives.jumped < control.iterations * entries / 10;
        if self.nodes == 0 || self.nodes < self.dives.next_jump || !affordable {
            return;
        }
        let every = if self.best.is_none() { 100 } else { 1000 };
        self.dives.next_jump = self.nodes + every;
        [self.lower, self.upper] = self.root.clone();
        self.send_bounds();
        let from = match &self.best {
            Some((_, best)) if self.dives.jumps.is_multiple_of(2) => best.clone(),
            _ => self.relaxation.x().to_vec(),
        };
        self.jump(&from, control);
    }

    /// Walks from a point to solutions, each better than the one before.
    pub(super) fn jump(&mut self, from: &[f64], control: &mut Control) {
        let applies = self.mip.has_integers_only() && self.mip.problem.m() > 0;
        let runs = |s: &Settings| s.runs(Strategy::FeasibilityJump);
        if !applies || !self.settings.is_some_and(runs) {
            return;
        }
        let mip = self.mip;
        let (lower, upper) = (self.lower.clone(), self.upper.clone());
        self.dives.jumps += 1;
        let mut walk = Walk::new(mip, &lower, &upper, from, self.dives.jumps);
        let most = self.jump_work();
        loop {
            if let Some((v, _)) = &self.best {
                let gain = 0.01 * (v - self.bound);
                let wanted = if gain.is_finite() { v - gain } else { *v };
                walk.limit(self.cutoff().min(wanted));
            }
            let spent = control.iterations;
            let Some(y) = walk.run(most, &mut || control.stop(spent).is_some()) else {
                break;
            };
            let before = self.best.as_ref().map(|b| b.0);
            if !self.offer(&y, control) || before == self.best.as_ref().map(|b| b.0) {
                break;
            }
        }
        self.dives.jumped += walk.work;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::lp::form::Problem;

    /// Items of these weights, each in one of so many bins that hold 100.
    fn packing(weights: &[f64], bins: usize) -> Mip {
        let n = weights.len() * bins;
        let mut problem = Problem {
            cost: (0..n).map(|j| (j % bins) as f64).collect(),
            lower: vec![0.0; n],
            upper: vec![1.0; n],
            rows: Sparse::new(),
            ..Problem::default()
        };
        for i in 0..weights.len() {
            problem.rows.push((0..bins).map(|b| (i * bins + b, 1.0)));
            problem.row_lower.push(1.0);
            problem.row_upper.push(1.0);
        }
        for b in 0..bins {
            let all = weights.iter().enumerate();
            problem.rows.push(all.map(|(i, w)| (i * bins + b, *w)));
            problem.row_lower.push(f64::NEG_INFINITY);
            problem.row_upper.push(100.0);
        }
        problem.columns = problem.rows.transpose(n);
        Mip {
            integer: vec![true; n],
            threshold: vec![0.0; n],
            problem,
            ..Mip::default()
        }
    }

    #[test]
    fn a_walk_packs_what_fits() {
        // three bins with little room left, found from nothing
        let weights = [60.0, 40.0, 50.0, 30.0, 15.0, 45.0, 35.0, 10.0];
        let mip = packing(&weights, 3);
        let n = mip.problem.n();
        let (lower, upper) = (vec![0.0; n], vec![1.0; n]);
        let mut walk = Walk::new(&mip, &lower, &upper, &vec![0.0; n], 1);
        let first = walk.run(1_000_000, &mut || false).expect("a packing");
        assert!(mip.is_feasible(&first) && mip.is_discrete(&first));
        // four items of 60 do not fit into three bins
        let mip = packing(&[60.0; 4], 3);
        let n = mip.problem.n();
        let (lower, upper) = (vec![0.0; n], vec![1.0; n]);
        let mut walk = Walk::new(&mip, &lower, &upper, &vec![0.5; n], 1);
        assert_eq!(walk.run(100_000, &mut || false), None);
    }
}
