//! What to branch on.

use super::model::{Change, INTEGRAL};
use super::relaxation::{Control, Relaxation};
use super::tree::Search;
use crate::model::instance::OrderedSet;

/// Gains per unit of a column, in one direction.
#[derive(Clone, Copy, Default, Debug)]
pub struct Pseudo {
    sum: f64,
    count: u32,
}

impl Pseudo {
    /// Learns from a branch.
    pub fn add(&mut self, gain: f64) {
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
pub enum Branch {
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

/// Candidates that are looked at, at most, without a better one.
const PATIENCE: usize = 6;

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
            return self.branch_on_set(x);
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
            if known < RELIABLE && spent && idle < PATIENCE {
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
                if idle >= 2 * PATIENCE {
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
        [
            Change {
                column: j,
                lower: l,
                upper: low,
            },
            Change {
                column: j,
                lower: high,
                upper: u,
            },
        ]
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

    pub(super) fn branch_on_set(&self, x: &[f64]) -> Option<Branch> {
        let weight = |s: &OrderedSet| s.columns.iter().map(|&j| x[j as usize].abs()).sum::<f64>();
        let violated = self
            .mip
            .sets
            .iter()
            .filter_map(|s| Some((s, self.mip.spread(s, x)?)));
        let of = |s: &OrderedSet| match self.mip.priority.is_empty() {
            true => 1.0,
            false => s
                .columns
                .iter()
                .map(|&j| self.mip.priority[j as usize])
                .fold(f64::INFINITY, f64::min),
        };
        let best = violated.min_by(|a, b| {
            of(a.0)
                .total_cmp(&of(b.0))
                .then(weight(b.0).total_cmp(&weight(a.0)))
        });
        let (set, (first, last)) = best?;
        let place = |(k, &j): (usize, &u32)| k as f64 * x[j as usize].abs();
        let middle: f64 = set.columns.iter().enumerate().map(place).sum::<f64>() / weight(set);
        let zero = |k: usize| {
            let column = set.columns[k] as usize;
            Change {
                column,
                lower: 0.0,
                upper: 0.0,
            }
        };
        // Left: what is behind the middle is 0; right: what is before it.
        let (left, right) = if set.neighbours {
            let at = (middle.round() as usize).clamp(first + 1, last - 1);
            (at + 1, at)
        } else {
            let at = (middle.floor() as usize).clamp(first, last - 1);
            (at + 1, at + 1)
        };
        let open = |k: &usize| {
            self.lower[set.columns[*k] as usize] != 0.0
                || self.upper[set.columns[*k] as usize] != 0.0
        };
        let low: Vec<Change> = (left..set.columns.len()).filter(open).map(zero).collect();
        let high: Vec<Change> = (0..right).filter(open).map(zero).collect();
        let sum = |list: &[Change]| list.iter().map(|c| x[c.column].abs()).sum::<f64>();
        let far = [sum(&low), sum(&high)];
        Some(Branch::Two {
            first: usize::from(far[1] < far[0]),
            sides: [low, high],
            column: None,
            far,
        })
    }

    /// A branch on the discrete column with the widest bounds, where the relaxation says nothing.
    pub(super) fn split_widest(&self) -> Option<Branch> {
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
        let sides = [
            vec![Change {
                column: j,
                lower: l,
                upper: at,
            }],
            vec![Change {
                column: j,
                lower: at + 1.0,
                upper: u,
            }],
        ];
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
