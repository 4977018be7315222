//! What to branch on.

use super::model::{Change, INTEGRAL};
use super::relaxation::{Control, Relaxation};
use super::tree::Search;
use crate::model::instance::OrderedSet;

/// Gains per unit of a column, in one direction.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct Pseudo {
    sum: f64,
    count: u32,
}

impl Pseudo {
    /// Learns from a branch.
    pub(super) fn add(&mut self, gain: f64) {
        if gain.is_finite() {
            self.sum += gain;
            self.count += 1;
        }
    }

    fn mean(&self, other: f64) -> f64 {
        if self.count == 0 {
            other
        } else {
            self.sum / f64::from(self.count)
        }
    }
}

/// What to do at a node.
pub(super) enum Branch {
    /// A side is empty: these bounds hold below the node.
    Fixed(Vec<Change>),
    /// Two children.
    Two {
        /// The bounds of each.
        sides: [Vec<Change>; 2],
        /// The column, where it is one.
        column: Option<usize>,
        /// How far the point is from each side.
        far: [f64; 2],
        /// The side to go on with.
        first: usize,
    },
}

/// Gains that a column must have been seen to make before they are believed.
const RELIABLE: u32 = 4;

/// Sets that are looked at, at most.
const SETS_LOOKED_AT: usize = 8;

/// Candidates that are looked at, at most, without a better one.
const MAX_IDLE_CANDIDATES: usize = 6;

impl<R: Relaxation> Search<'_, R> {
    /// A discrete condition that the point violates, and what to do about it. None: there is none.
    pub(super) fn branch(
        &mut self,
        x: &[f64],
        value: f64,
        control: &mut Control,
    ) -> Option<Branch> {
        let mut candidates = self.candidates(x);
        if candidates.is_empty() {
            return self.branch_on_set(x, value, SETS_LOOKED_AT, control);
        }
        if !self.mip.priority.is_empty() {
            let of = |j: usize| self.mip.priority[j];
            let first = candidates
                .iter()
                .map(|c| of(c.0))
                .fold(f64::INFINITY, f64::min);
            candidates.retain(|c| of(c.0) <= first);
        }
        let mean = self.mean_gain();
        let mut scored: Vec<(f64, usize, f64)> = candidates
            .iter()
            .map(|&(j, far)| (self.score(j, self.far(j, x[j]), mean), j, far))
            .collect();
        scored.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.2.total_cmp(&a.2)));
        let cutoff = self.cutoff();
        let (mut best, mut best_score, mut idle) = (scored[0].1, -1.0, 0);
        for &(guess, j, _) in scored.iter().take(100) {
            let sides = self.sides(j, x[j]);
            let known = self.pseudo[j].iter().map(|p| p.count).min().unwrap_or(0);
            let spent = control.iterations / 2 + 20_000 > self.dives.probes;
            let mut score = guess;
            if known < RELIABLE && spent && idle < MAX_IDLE_CANDIDATES {
                let before = control.iterations;
                let mut gains = [0.0; 2];
                let mut seen = true;
                for side in 0..2 {
                    match self.relaxation.probe(&sides[side..=side], cutoff) {
                        Some(v) if v >= cutoff => {
                            let other = vec![sides[1 - side]];
                            return Some(Branch::Fixed(other));
                        }
                        Some(v) => {
                            gains[side] = (v - value).max(0.0);
                            let far = self.far(j, x[j])[side];
                            self.pseudo[j][side].add(gains[side] / far.max(1e-6));
                        }
                        None => seen = false,
                    }
                }
                self.dives.probes += 30 + control.iterations - before;
                if seen {
                    score = product(gains);
                }
                if control.stop(control.iterations).is_some() {
                    break;
                }
            }
            if score > best_score {
                (best, best_score, idle) = (j, score, 0);
            } else {
                idle += 1;
                if idle >= 2 * MAX_IDLE_CANDIDATES {
                    break;
                }
            }
        }
        let far = self.far(best, x[best]);
        let sides = self.sides(best, x[best]).map(|c| vec![c]);
        let first = self.first_side(best, far, mean);
        Some(Branch::Two {
            sides,
            column: Some(best),
            far,
            first,
        })
    }

    /// Columns whose values they must not have, with how far they are from one they may.
    pub(super) fn candidates(&self, x: &[f64]) -> Vec<(usize, f64)> {
        (0..x.len())
            .filter(|&j| self.lower[j] < self.upper[j])
            .map(|j| (j, self.mip.distance(j, x[j], self.lower[j])))
            .filter(|c| c.1 > INTEGRAL)
            .collect()
    }

    fn is_threshold(&self, j: usize, x: f64) -> bool {
        let t = self.mip.threshold[j];
        t > 0.0 && self.lower[j] < t && x < t
    }

    /// How far a value is from each side of a branch on its column.
    fn far(&self, j: usize, x: f64) -> [f64; 2] {
        match self.is_threshold(j, x) {
            true => [x, self.mip.threshold[j] - x],
            false => [x - x.floor(), x.ceil() - x],
        }
    }

    /// The two sides of a branch on a column.
    pub(super) fn sides(&self, j: usize, x: f64) -> [Change; 2] {
        let (l, u) = (self.lower[j], self.upper[j]);
        let (low, high) = match self.is_threshold(j, x) {
            true => (0.0, self.mip.threshold[j]),
            false => (x.floor(), x.ceil()),
        };
        [Change::new(j, l, low), Change::new(j, high, u)]
    }

    fn mean_gain(&self) -> [f64; 2] {
        [0, 1].map(|side| {
            let all = self.pseudo.iter().map(|p| p[side]);
            let (sum, count) = all.fold((0.0, 0u32), |(s, c), p| (s + p.sum, c + p.count));
            if count == 0 {
                1.0
            } else {
                sum / f64::from(count)
            }
        })
    }

    fn score(&self, j: usize, far: [f64; 2], mean: [f64; 2]) -> f64 {
        product([0, 1].map(|side| self.pseudo[j][side].mean(mean[side]) * far[side]))
    }

    /// Towards the smaller gain, and where none is known to the nearer side; up in a tie.
    fn first_side(&self, j: usize, far: [f64; 2], mean: [f64; 2]) -> usize {
        let [down, up] = [0, 1].map(|side| self.pseudo[j][side].mean(mean[side]) * far[side]);
        if (down - up).abs() > 0.1 * down.max(up) {
            usize::from(up < down)
        } else {
            usize::from(far[1] <= far[0])
        }
    }

    /// A set with more that is not 0 than it allows, and what to do about it: of the heaviest the one whose children rise most.
    pub(super) fn branch_on_set(
        &mut self,
        x: &[f64],
        value: f64,
        looks: usize,
        control: &mut Control,
    ) -> Option<Branch> {
        let mip = self.mip;
        let weight = |s: &OrderedSet| s.columns.iter().map(|&j| x[j as usize].abs()).sum::<f64>();
        let mut violated: Vec<(f64, f64, &OrderedSet)> = mip
            .sets
            .iter()
            .filter(|s| mip.spread(s, x).is_some())
            .map(|s| (self.set_priority(s), weight(s), s))
            .collect();
        violated.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
        let least = violated.first()?.0;
        violated.retain(|v| v.0 <= least);
        violated.truncate(looks);
        let halves: Vec<[Vec<Change>; 2]> = violated
            .iter()
            .map(|(_, weight, s)| {
                let place = |(k, &j): (usize, &u32)| k as f64 * x[j as usize].abs();
                let middle = s.columns.iter().enumerate().map(place).sum::<f64>() / weight;
                let (first, last) = mip.spread(s, x).unwrap_or((0, s.columns.len() - 1));
                self.halves(s, first, last, middle)
            })
            .collect();
        let (mut best, mut best_score) = (0, -1.0);
        let cutoff = self.cutoff();
        for (k, sides) in halves.iter().enumerate() {
            let spent = control.iterations / 2 + 20_000 > self.dives.probes;
            if halves.len() == 1 || !spent || control.stop(control.iterations).is_some() {
                break;
            }
            let before = control.iterations;
            let mut gains = [0.0; 2];
            for side in 0..2 {
                match self.relaxation.probe(&sides[side], cutoff) {
                    Some(v) if v >= cutoff => return Some(Branch::Fixed(sides[1 - side].clone())),
                    Some(v) => gains[side] = (v - value).max(0.0),
                    None => break,
                }
            }
            self.dives.probes += 30 + control.iterations - before;
            if product(gains) > best_score {
                (best, best_score) = (k, product(gains));
            }
        }
        let sum = |list: &[Change]| list.iter().map(|c| x[c.column].abs()).sum::<f64>();
        let sides = halves.into_iter().nth(best)?;
        let far = [sum(&sides[0]), sum(&sides[1])];
        Some(Branch::Two {
            first: usize::from(far[1] < far[0]),
            sides,
            column: None,
            far,
        })
    }

    fn set_priority(&self, set: &OrderedSet) -> f64 {
        let of = |&j: &u32| self.mip.priority[j as usize];
        match self.mip.priority.is_empty() {
            true => 1.0,
            false => set.columns.iter().map(of).fold(f64::INFINITY, f64::min),
        }
    }

    /// The two sides of a branch on a set: what lies behind a place between two positions is 0, or what lies before it.
    fn halves(&self, set: &OrderedSet, first: usize, last: usize, middle: f64) -> [Vec<Change>; 2] {
        let (left, right) = if set.neighbours {
            let at = (middle.round() as usize).clamp(first + 1, last - 1);
            (at + 1, at)
        } else {
            let at = (middle.floor() as usize).clamp(first, last - 1);
            (at + 1, at + 1)
        };
        let zero = |k: usize| Change::new(set.columns[k] as usize, 0.0, 0.0);
        let open = |k: &usize| self.is_open(set.columns[*k] as usize);
        let low = (left..set.columns.len()).filter(open).map(zero).collect();
        let high = (0..right).filter(open).map(zero).collect();
        [low, high]
    }

    fn is_open(&self, j: usize) -> bool {
        self.lower[j] != 0.0 || self.upper[j] != 0.0
    }

    /// A branch on a set that bounds have not decided.
    pub(super) fn split_set(&self) -> Option<Branch> {
        self.mip.sets.iter().find_map(|s| {
            let open = |j: &u32| self.is_open(*j as usize);
            let first = s.columns.iter().position(open)?;
            let last = s.columns.iter().rposition(open)?;
            (last - first > usize::from(s.neighbours)).then(|| Branch::Two {
                sides: self.halves(s, first, last, (first + last) as f64 / 2.0),
                column: None,
                far: [1.0; 2],
                first: 0,
            })
        })
    }

    /// A branch on the discrete column with the widest bounds, or on a set, where the relaxation says nothing.
    pub(super) fn split_widest(&self) -> Option<Branch> {
        self.split_column().or_else(|| self.split_set())
    }

    /// A branch on the integer column that is farthest from an integer, although within the tolerance.
    pub(super) fn split_rounded(&self, x: &[f64]) -> Option<Branch> {
        let noise = match self.relaxation.is_linear() {
            true => 1e-10,
            false => 1e-7,
        };
        let far = |j: &usize| (x[*j] - x[*j].round()).abs();
        // At a bound, or beyond it by rounding, neither side would be smaller.
        let inside = |j: usize| self.lower[j] < x[j] && x[j] < self.upper[j];
        let whole = (0..x.len()).filter(|&j| self.mip.integer[j] && inside(j));
        let j = whole
            .filter(|j| far(j) > noise)
            .max_by(|a, b| far(a).total_cmp(&far(b)))?;
        Some(Branch::Two {
            sides: self.sides(j, x[j]).map(|c| vec![c]),
            column: None,
            far: self.far(j, x[j]),
            first: usize::from(x[j] > x[j].round()),
        })
    }

    fn split_column(&self) -> Option<Branch> {
        let width = |j: &usize| self.upper[*j] - self.lower[*j];
        let whole = (0..self.lower.len()).filter(|&j| self.mip.integer[j] && width(&j) > 0.5);
        let j = whole.max_by(|a, b| width(a).total_cmp(&width(b)))?;
        let (l, u) = (self.lower[j], self.upper[j]);
        let near = self.relaxation.x()[j].round().clamp(l, u);
        let at = match (l.is_finite(), u.is_finite()) {
            (true, true) => ((l + u) / 2.0).floor(),
            (true, false) => l.max(near),
            _ => (u - 1.0).min(near),
        };
        let sides = [Change::new(j, l, at), Change::new(j, at + 1.0, u)].map(|c| vec![c]);
        Some(Branch::Two {
            sides,
            column: None,
            far: [1.0; 2],
            first: usize::from(near > at),
        })
    }
}

fn product([down, up]: [f64; 2]) -> f64 {
    down.max(1e-6) * up.max(1e-6)
}
