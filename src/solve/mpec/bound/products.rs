//! The bound of the lifted relaxation ([`super::lift`]), proved.
//!
//! The multipliers of a linear program without bounds on its columns satisfy their equations only up to
//! rounding, and rounding times a column without bound is no bound. So the size of the columns is
//! derived first, of solutions not worse than the best one known:
//!
//! * side A alone, by linear programs ([`weak::derive`]): |x_i| ≤ X_i;
//! * side B, whose columns are often unbounded alone, by the largest values that the lifted relaxation
//!   allows: |z_j| ≤ Z_j. Columns with a sign are taken together, their sum being as good; where the equations
//!   of B bound a column by others, no linear program is solved;
//! * products: |x_i z_j| ≤ X_i Z_j.
//!
//! **Why the second is a proof.** Let Z_j be twice what the linear programs found, and a little more, and let a
//! solution have N = max |z_j| / Z_j > 1. Its products are within N times their bounds, so for each column the
//! program's multipliers prove |z_j| ≤ R_j + N ε_j, where R_j + ε_j ≤ ¾ Z_j has been computed with directed
//! rounding. Hence |z_j| ≤ ¾ N Z_j for all of them, and N ≤ ¾ N: a contradiction. So N ≤ 1.

use std::time::Instant;

use super::super::pairs::Program;
use super::lift::Sides;
use super::weak;
use crate::solve::answer::linear;
use crate::solve::lp::form::Form;
use crate::solve::lp::simplex::Simplex;
use crate::solve::lp::{self, Ended, crossover};
use crate::solve::{ModelStatus, Monitor, Settings};

/// The largest sum of some columns, times a sign, with the multipliers that are to prove it.
struct Tried {
    columns: Vec<usize>,
    sign: f64,
    limit: f64,
    y: Vec<f64>,
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
    /// value, `most` the largest number of products that is tried.
    pub fn bound(&mut self, program: &Program, cutoff: f64, level: &[f64], most: usize) -> f64 {
        let low = self.proved(program, cutoff, level, most);
        low.unwrap_or(f64::NEG_INFINITY)
    }

    fn proved(
        &mut self,
        program: &Program,
        cutoff: f64,
        level: &[f64],
        most: usize,
    ) -> Option<f64> {
        let sides = Sides::new(program, cutoff).filter(|s| s.products() <= most)?;
        let mut first = sides.first();
        let known: Vec<f64> = sides.columns().iter().map(|&j| level[j]).collect();
        self.iterations += self.watched(|stop| weak::derive(&mut first, cutoff, &known, stop));
        let size = |l: f64, u: f64| l.abs().max(u.abs());
        let mut a: Vec<f64> = first
            .lower
            .iter()
            .zip(&first.upper)
            .map(|(l, u)| size(*l, *u))
            .collect();
        if a.iter().any(|x| x.is_infinite()) {
            self.monitor
                .log("products: the objective's side is not bounded");
            return None;
        }
        a.push(1.0);

        let (instance, products) = sides.lift();
        let answer = linear(&lp::Clarabel, &instance, self.settings, self.monitor).ok()?;
        self.iterations += answer.outcome.iterations;
        self.monitor.log(&format!(
            "products: {} rows, {} columns, {}, {:.1} s",
            instance.row_count(),
            instance.column_count(),
            answer.status.name(),
            self.begin.elapsed().as_secs_f64(),
        ));
        if answer.status != ModelStatus::Optimal {
            return None;
        }
        let form = Form::exact(&instance).ok()?;
        let mut problem = form.problem.clone();
        let near = form.near(&answer.outcome);
        let mut simplex = Simplex::new(&problem);
        let start = crossover::start(&problem, &near, None);
        let mut y = near.y;
        let ended = self.watched(|stop| {
            let _ = simplex.push(&start, stop);
            simplex.solve(stop)
        });
        if ended == Ended::Solved {
            y = simplex.point()?.y;
        }

        // Sizes of side B.
        let mut b = vec![f64::INFINITY; sides.count()];
        let base: Vec<usize> = {
            let mut base = vec![usize::MAX; b.len()];
            for (k, &column) in form.columns.iter().enumerate() {
                let (i, j) = products[column as usize];
                if i + 1 == a.len() && j < b.len() {
                    base[j] = k;
                }
            }
            base
        };
        for (j, &c) in problem.cost.iter().enumerate() {
            if c != 0.0 {
                simplex.set_cost(j, 0.0);
            }
        }
        let mut tried: Vec<Tried> = Vec::new();
        // All that have a sign at once, if that can be, and then one by one what does not follow.
        let together: Vec<usize> = (0..b.len())
            .filter(|&j| sides.is_signed(j) && !sides.is_opposite(j))
            .collect();
        let one_by_one = (0..b.len()).filter(|&j| !sides.is_opposite(j));
        let groups = std::iter::once(together).chain(one_by_one.map(|j| vec![j]));
        for (k, group) in groups.enumerate() {
            sides.spread(&mut b);
            if group.iter().all(|&j| b[j].is_finite()) {
                continue;
            }
            let columns: Vec<usize> = group.iter().map(|&j| base[j]).collect();
            let mut reach = 0.0f64;
            let mut found = Vec::new();
            for sign in if k == 0 { &[-1.0][..] } else { &[-1.0, 1.0] } {
                columns.iter().for_each(|&c| simplex.set_cost(c, *sign));
                let ended = self.watched(|stop| simplex.solve(stop));
                let point = simplex.point()?;
                columns.iter().for_each(|&c| simplex.set_cost(c, 0.0));
                if ended == Ended::Solved {
                    let sum: f64 = columns.iter().map(|&c| point.x[c]).sum();
                    reach = reach.max(sum.abs());
                    found.push((*sign, point.y));
                } else if k > 0 {
                    self.monitor
                        .log("products: a column of the other side is not bounded");
                    return None;
                }
            }
            if found.is_empty() {
                continue;
            }
            let limit = 2.0 * reach + 1.0;
            group.iter().for_each(|&j| b[j] = b[j].min(limit));
            tried.extend(found.into_iter().map(|(sign, y)| Tried {
                columns: columns.clone(),
                sign,
                limit,
                y,
            }));
            self.monitor.log(&format!(
                "products: {} columns at most {limit:.3e}, {:.1} s",
                group.len(),
                self.begin.elapsed().as_secs_f64()
            ));
        }
        sides.spread(&mut b);
        b.push(1.0);
        self.iterations += simplex.iterations;
        for (k, &column) in form.columns.iter().enumerate() {
            let (i, j) = products[column as usize];
            let most = (a[i] * b[j]).next_up();
            problem.lower[k] = problem.lower[k].max(-most);
            problem.upper[k] = problem.upper[k].min(most);
        }
        let proves = |t: &Tried| {
            let mut cost = vec![0.0; problem.n()];
            t.columns.iter().for_each(|&c| cost[c] = t.sign);
            -weak::bound(&problem, &cost, &t.y) <= 0.75 * t.limit
        };
        if !tried.iter().all(proves) {
            self.monitor.log("products: the sizes could not be proved");
            return None;
        }
        Some(weak::bound(&problem, &problem.cost, &y) + problem.offset)
    }

    /// Runs with the limits.
    fn watched<T>(&mut self, run: impl FnOnce(&mut dyn FnMut(u64) -> Option<Ended>) -> T) -> T {
        let (begin, settings) = (self.begin, self.settings);
        run(&mut |iterations| super::watch(iterations, begin, settings, self.monitor))
    }
}
