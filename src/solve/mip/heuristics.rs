//! Ways to solutions besides the tree: rounding, diving, and small searches near what is known.

use super::model::{Change, INTEGRAL};
use super::relaxation::{Control, Relaxation, Solved};
use super::tree::Search;

/// A gap, relative to the solution, from which on it is no guide.
const POOR: f64 = 0.1;

/// A dive over nonlinear programs, which take long, decides one column and this part of all that are left at a time, and less where
/// that leads nowhere.
const AT_ONCE: usize = 10;

/// How a dive chooses.
#[derive(Clone, Copy, PartialEq)]
enum Dive {
    /// The column that is nearest to an integer, to it.
    Nearest,
    /// Where rows object least.
    Locks,
    /// Towards the best solution.
    Guided,
    /// Up: the column that is nearest to the integer above it. Where one of many is chosen, that fixes the others.
    Up,
}

impl<R: Relaxation> Search<'_, R> {
    /// Whatever is due at a node whose relaxation has this solution.
    pub(super) fn heuristics(&mut self, depth: u32, x: &[f64], control: &mut Control) {
        if self.relaxation.is_linear() {
            self.round(x, control);
        }
        let root = depth == 0 && self.nodes <= 1;
        let affordable = self.dives.iterations < control.iterations / 4 + 2000;
        let often = if self.is_poor() { 5 } else { 40 };
        if root {
            self.dive(Dive::Locks, x, control);
            for kind in [Dive::Nearest, Dive::Up] {
                if self.is_poor() {
                    self.dive(kind, x, control);
                }
            }
        } else if affordable && self.nodes.is_multiple_of(often) {
            self.dives.count += 1;
            let kind = match (self.is_poor(), self.dives.count % 3) {
                (false, 0) => Dive::Guided,
                (true, 0) => Dive::Up,
                (_, 1) => Dive::Locks,
                _ => Dive::Nearest,
            };
            self.dive(kind, x, control);
        }
        let near = root || self.nodes.is_multiple_of(100);
        if near && affordable && control.stop(control.iterations).is_none() {
            self.search_near(x, control);
        }
    }

    /// Whether there is no solution, or one that is far from the bound: then others are looked for as if there were none.
    fn is_poor(&self) -> bool {
        let far = |v: f64| self.units.gap(v, self.bound)[1] > POOR;
        let best = self.best.as_ref();
        best.is_none_or(|b| self.relaxation.is_exact() && far(b.0))
    }

    /// By column and direction: how many rows object to a step.
    fn locks(&self, j: usize) -> [usize; 2] {
        let p = &self.mip.problem;
        let mut locks = [0; 2];
        for (i, a) in p.columns.line(j) {
            let up = a > 0.0;
            locks[usize::from(up)] += usize::from(p.row_upper[i].is_finite());
            locks[usize::from(!up)] += usize::from(p.row_lower[i].is_finite());
        }
        locks
    }

    /// Rounds in the direction to which no row objects.
    fn round(&mut self, x: &[f64], control: &mut Control) {
        if !self.mip.sets.is_empty() {
            return;
        }
        let mut y = x.to_vec();
        for (j, _) in self.candidates(x) {
            let sides = self.sides(j, x[j]);
            let locks = self.locks(j);
            y[j] = match locks {
                [0, _] => sides[0].upper,
                [_, 0] => sides[1].lower,
                _ => return,
            };
        }
        if self.mip.value(&y) < self.cutoff() && self.mip.is_feasible(&y) {
            self.offer(&y, control);
        }
    }

    /// Bounds one column after the other until the relaxation's solution is discrete, or nothing is left.
    fn dive(&mut self, kind: Dive, x: &[f64], control: &mut Control) {
        let before = self.here();
        let start = self.relaxation.start();
        let spent = control.iterations;
        let mut x = x.to_vec();
        let mut failures = 0;
        let mut part = if self.relaxation.is_linear() {
            usize::MAX
        } else {
            AT_ONCE
        };
        let budget = 5 * self.lower.len() as u64 + 2000;
        for _ in 0..2 * self.lower.len() + 10 {
            if control.stop(control.iterations).is_some() || control.iterations - spent > budget {
                break;
            }
            let Some((sides, others)) = self.step(kind, &x, part, control) else {
                self.offer(&x, control);
                break;
            };
            let here = self.here();
            let mut done = false;
            let mut ways = vec![(&sides[0], &[][..]), (&sides[1], &[][..])];
            if !others.is_empty() {
                ways.insert(0, (&sides[0], &others[..]));
            }
            for (side, others) in ways {
                if self.apply(side)
                    && self.apply_fitting(others)
                    && let Solved::Value(v) = self.relax(self.cutoff(), control)
                    && v < self.cutoff()
                {
                    done = true;
                    break;
                }
                match others {
                    [] => failures += 1,
                    _ => part *= 4,
                }
                self.back_to(here.clone());
            }
            if !done || failures > 8 {
                break;
            }
            x = self.relaxation.x().to_vec();
        }
        self.dives.iterations += control.iterations - spent;
        self.back_to(before);
        self.relaxation.restart(&start);
    }

    /// Applies those of the changes that what was applied before leaves possible. Whether nothing contradicts itself.
    fn apply_fitting(&mut self, changes: &[Change]) -> bool {
        changes.iter().all(|c| {
            let (lower, upper) = (self.lower[c.column], self.upper[c.column]);
            c.upper < lower || c.lower > upper || self.apply(&[*c])
        })
    }

    /// The two sides of a dive's next step, the preferred one first, and what may be decided with it. None: the point is discrete.
    fn step(
        &mut self,
        kind: Dive,
        x: &[f64],
        part: usize,
        control: &mut Control,
    ) -> Option<([Vec<Change>; 2], Vec<Change>)> {
        let candidates = self.candidates(x);
        if candidates.is_empty() {
            let sides = match self.branch_on_set(x, 0.0, 1, control)? {
                super::branching::Branch::Two {
                    sides: [a, b],
                    first,
                    ..
                } => match first {
                    0 => [a, b],
                    _ => [b, a],
                },
                super::branching::Branch::Fixed(changes) => [changes.clone(), changes],
            };
            return Some((sides, Vec::new()));
        }
        let guide = match (kind, &self.best) {
            (Dive::Guided, Some((_, best))) => Some(best),
            _ => None,
        };
        // The smallest score wins: which column, and whether up.
        let choice = candidates.iter().map(|&(j, far)| {
            let fraction = x[j] - x[j].floor();
            match (kind, guide) {
                (_, Some(best)) => ((x[j] - best[j]).abs(), j, best[j] > x[j]),
                (Dive::Locks, _) => {
                    let [down, up] = self.locks(j);
                    let harmless = down == 0 || up == 0;
                    let goes_up = match down.cmp(&up) {
                        std::cmp::Ordering::Equal => fraction >= 0.5,
                        order => order.is_gt(),
                    };
                    let way = if goes_up { 1.0 - fraction } else { fraction };
                    let rate = down.min(up) as f64;
                    // Columns that go somewhere freely come last: they can be rounded in the end.
                    (
                        if harmless {
                            1e6
                        } else {
                            way * (1.0 + 0.1 * rate)
                        },
                        j,
                        goes_up,
                    )
                }
                (Dive::Up, _) => (1.0 - fraction, j, true),
                _ => (far, j, fraction >= 0.5),
            }
        });
        let mut choice: Vec<(f64, usize, bool)> = choice.collect();
        choice.sort_by(|a, b| a.0.total_cmp(&b.0));
        choice.truncate(1 + candidates.len() / part);
        let mut sides = choice.into_iter().map(|(_, j, up)| {
            let [down, high] = self.sides(j, x[j]);
            if up { [high, down] } else { [down, high] }
        });
        let first = sides.next()?.map(|side| vec![side]);
        Some((first, sides.map(|[side, _]| side).collect()))
    }

    /// Fixes the columns on which the relaxation and the best solution agree (without one: those that are integers in the
    /// relaxation), and searches the rest a little.
    fn search_near(&mut self, x: &[f64], control: &mut Control) {
        let Some(search) = self.neighbourhood else {
            return;
        };
        let seen = self.best.as_ref().map_or(f64::NAN, |b| b.0);
        if seen == self.dives.last_near && self.nodes > 1 && !self.nodes.is_multiple_of(500) {
            return;
        }
        self.dives.last_near = seen;
        let mut changes = Vec::new();
        let mut open = 0;
        let guide = self.best.as_ref().filter(|_| !self.is_poor());
        for j in (0..x.len()).filter(|&j| self.mip.integer[j] && self.mip.threshold[j] == 0.0) {
            let agrees = match guide {
                Some((_, best)) => (best[j] - x[j]).abs() <= INTEGRAL,
                None => (x[j] - x[j].round()).abs() <= INTEGRAL,
            };
            if agrees {
                let v = x[j].round();
                changes.push(Change {
                    column: j,
                    lower: v,
                    upper: v,
                });
            } else {
                open += usize::from(self.lower[j] < self.upper[j]);
            }
        }
        // Too little fixed is the same problem again.
        if changes.len() < (changes.len() + open) / 3 || open == 0 {
            return;
        }
        let spent = control.iterations;
        let found = search(self.mip, &changes, self.cutoff(), control);
        self.dives.iterations += control.iterations - spent;
        if let Some(y) = found {
            self.offer(&y, control);
        }
    }
}
