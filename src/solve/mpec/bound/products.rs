//! The bound of the lifted relaxation ([`super::lift`]), proved.
//!
//! The multipliers of a linear program without bounds on its columns satisfy their equations only up to
//! rounding, and rounding times a column without bound is no bound. So the size of the columns is
//! derived first, of solutions not worse than the best one known:
//!
//! * side A alone, by linear programs ([`weak::derive`]): |x_i| ≤ X_i;
//! * side B, whose columns are often unbounded alone, by multipliers of the lifted relaxation: |z_j| ≤ Z_j. They
//!   need not be the best, so no linear program is solved for each ([`super::multipliers`]). Columns with a sign are
//!   taken together, their sum being as good; where the equations of B bound a column by others, nothing is needed;
//! * products: |x_i z_j| ≤ X_i Z_j.
//!
//! **Why the second is a proof.** Let Z_j be twice what the multipliers promise, and a little more, and let a
//! solution have N = max |z_j| / Z_j > 1. Its products are within N times their bounds, so for each column the
//! program's multipliers prove |z_j| ≤ R_j + N ε_j, where R_j + ε_j ≤ ¾ Z_j has been computed with directed
//! rounding. Hence |z_j| ≤ ¾ N Z_j for all of them, and N ≤ ¾ N: a contradiction. So N ≤ 1.

use std::time::Instant;

use super::super::pairs::Program;
use super::lift::Sides;
use super::multipliers::Multipliers;
use super::weak;
use crate::solve::answer::linear;
use crate::solve::lp::form::{Form, Problem};
use crate::solve::lp::simplex::{Simplex, Wide};
use crate::solve::lp::{self, Ended};
use crate::solve::{ModelStatus, Monitor, Settings};

/// The largest sum of some columns, times a sign, with the multipliers that are to prove it.
struct Tried {
    columns: Vec<usize>,
    sign: f64,
    limit: f64,
    y: Wide,
}

impl Tried {
    /// The objective whose minimum is minus the sum, of a program with n columns.
    fn cost(&self, n: usize) -> Vec<f64> {
        let mut cost = vec![0.0; n];
        self.columns.iter().for_each(|&c| cost[c] = self.sign);
        cost
    }
}

/// The state of a proof.
pub struct Products<'a> {
    /// Limits.
    pub settings: &'a Settings,
    /// Of the caller.
    pub monitor: &'a mut dyn Monitor,
    /// When the solve began.
    pub begin: Instant,
    /// Of the linear programs so far.
    pub iterations: u64,
}

impl Products<'_> {
    /// The bound, −∞ if none is proved. `level` is the best solution known, `cutoff` a little above its
    /// value, `most` the largest number of products that is tried. The columns of side A in `whole`, the program
    /// without its pairs, get the bounds that solutions not above the cutoff have.
    pub fn bound(
        &mut self,
        program: &Program,
        whole: &mut Problem,
        cutoff: f64,
        level: &[f64],
        most: usize,
    ) -> f64 {
        let none = f64::NEG_INFINITY;
        let Some(sides) = Sides::new(program, cutoff) else {
            return none;
        };
        let mut first = sides.first();
        let known: Vec<f64> = sides.columns().iter().map(|&j| level[j]).collect();
        self.iterations += self.watched(|stop| weak::derive(&mut first, cutoff, &known, stop));
        for (k, &j) in sides.columns().iter().enumerate() {
            whole.lower[j] = whole.lower[j].max(first.lower[k]);
            whole.upper[j] = whole.upper[j].min(first.upper[k]);
        }
        let mut simplex = Simplex::new(&first);
        let solved = self.watched(|stop| simplex.solve(stop)) == Ended::Solved;
        self.iterations += simplex.iterations;
        let y = simplex.point().filter(|_| solved);
        let low = y.map_or(none, |p| {
            weak::bound(&first, &first.cost, &p.y) + first.offset
        });
        self.log(&format!("side A alone {low}"));
        let bounds = first.lower.iter().zip(&first.upper);
        let sizes: Vec<f64> = bounds.map(|(l, u)| l.abs().max(u.abs())).collect();
        if sides.products() > most || sizes.iter().any(|x| x.is_infinite()) {
            return low;
        }
        self.lifted(&sides, sizes).map_or(low, |v| v.max(low))
    }

    /// What the products prove, where those of side A's columns are known.
    fn lifted(&mut self, sides: &Sides, mut a: Vec<f64>) -> Option<f64> {
        a.push(1.0);
        let (instance, products) = sides.lift();
        let answer = linear(&lp::Clarabel, &instance, self.settings, self.monitor).ok()?;
        self.iterations += answer.outcome.iterations;
        self.log(&format!(
            "{} rows, {} columns, {}",
            instance.row_count(),
            instance.column_count(),
            answer.status.name(),
        ));
        if answer.status != ModelStatus::Optimal {
            return None;
        }
        let form = Form::exact(&instance).ok()?;
        let mut problem = form.problem.clone();
        let near = form.near(&answer.outcome);
        let limits = lp::Limits::of(self.settings, self.begin);
        let monitor = &mut *self.monitor;
        let multipliers = Multipliers::new(&problem, &limits, &mut || monitor.interrupted());
        let Some(multipliers) = multipliers else {
            self.log("there are no multipliers with room");
            return None;
        };
        let (y, _) = multipliers.for_cost(&problem.cost, Some(&near.y))?;
        // Where the columns of side B stand alone.
        let mut base = vec![usize::MAX; sides.count()];
        for (k, &column) in form.columns.iter().enumerate() {
            let (i, j) = products[column as usize];
            if i + 1 == a.len() && j < base.len() {
                base[j] = k;
            }
        }
        let Some((mut b, tried)) = sizes(sides, &multipliers, &base) else {
            self.log("a column of the other side is not bounded");
            return None;
        };
        b.push(1.0);
        for (k, &column) in form.columns.iter().enumerate() {
            let (i, j) = products[column as usize];
            let most = (a[i] * b[j]).next_up();
            problem.lower[k] = problem.lower[k].max(-most);
            problem.upper[k] = problem.upper[k].min(most);
        }
        let prove = |cost: &[f64], y: &Wide| weak::wide_bound(&problem, cost, (&y.0, &y.1));
        let holds = |t: &Tried| -prove(&t.cost(problem.n()), &t.y) <= 0.75 * t.limit;
        if !tried.iter().all(holds) {
            self.log("the sizes could not be proved");
            return None;
        }
        let low = prove(&problem.cost, &y) + problem.offset;
        self.log(&format!("{} sizes proved, bound {low}", tried.len()));
        Some(low)
    }

    fn log(&mut self, what: &str) {
        let seconds = self.begin.elapsed().as_secs_f64();
        self.monitor
            .log(&format!("products: {what}, {seconds:.1} s"));
    }

    /// Runs with the limits.
    fn watched<T>(&mut self, run: impl FnOnce(&mut dyn FnMut(u64) -> Option<Ended>) -> T) -> T {
        let (begin, settings) = (self.begin, self.settings);
        run(&mut |iterations| super::watch(iterations, begin, settings, self.monitor))
    }
}

/// Sizes of side B's columns, with what is to prove them. `base` says where they stand in the program.
fn sizes(
    sides: &Sides,
    multipliers: &Multipliers,
    base: &[usize],
) -> Option<(Vec<f64>, Vec<Tried>)> {
    let mut radius = vec![f64::INFINITY; base.len()];
    let mut tried: Vec<Tried> = Vec::new();
    let alone = |j: &usize| !sides.is_opposite(*j) && base[*j] != usize::MAX;
    // All that have a sign at once, if that can be, and then one by one what does not follow.
    let together: Vec<usize> = (0..base.len())
        .filter(|&j| sides.is_signed(j))
        .filter(alone)
        .collect();
    let one_by_one = (0..base.len()).filter(alone).map(|j| vec![j]);
    for (k, group) in std::iter::once(together).chain(one_by_one).enumerate() {
        sides.spread(&mut radius);
        if group.iter().all(|&j| radius[j].is_finite()) {
            continue;
        }
        let found = (if k == 0 { &[-1.0][..] } else { &[-1.0, 1.0] })
            .iter()
            .map(|&sign| {
                let columns: Vec<usize> = group.iter().map(|&j| base[j]).collect();
                let mut one = Tried {
                    columns,
                    sign,
                    limit: 0.0,
                    y: Wide::default(),
                };
                let (y, low) = multipliers.for_cost(&one.cost(multipliers.columns()), None)?;
                one.y = y;
                Some((one, low.abs()))
            })
            .collect::<Option<Vec<_>>>();
        match found {
            Some(found) => {
                let limit = 2.0 * found.iter().fold(0.0f64, |r, f| r.max(f.1)) + 1.0;
                group.iter().for_each(|&j| radius[j] = radius[j].min(limit));
                tried.extend(found.into_iter().map(|f| Tried { limit, ..f.0 }));
            }
            None if k == 0 => {}
            None => return None,
        }
    }
    sides.spread(&mut radius);
    Some((radius, tried))
}
