//! The necessary conditions of second order, and the way on where they do not hold.
//!
//! A point that satisfies the conditions of first order may be a saddle: min x y at 0. Where the Lagrangian curves downwards on the tangent
//! space of what is active ([`super::curvature`]), the search goes on from a point along that direction. Bounds and rows that are active
//! without a multiplier confine the direction to one side only: they are left out of the tangent space, and the side is chosen.
//! The same holds for a point where linear programs see no way to lessen what is violated: the violation itself may curve
//! downwards (x² + y² = 1 at 0).

use super::curvature::negative_curvature;
use super::driver::Driver;
use super::interior_point::{Ended, lock};
use super::polish::Active;
use super::problem::Problem;
use super::schedule::FINEST;
use super::slqp::Effort;
use super::trial::{Trial, active_set};
use crate::model::instance::Relation;
use crate::solve::vector::{clip, largest, sum};
use crate::solve::{SolveError, Strategy};

/// How often a saddle is left.
const MOST_SADDLES: u32 = 3;
/// A multiplier this small, relative to the largest or to the terms of the reduced cost, holds nothing.
const WEAK: f64 = 1e-7;
/// The first steps along a direction, relative to the size of the point; from there on it is doubled.
const FIRST_STEPS: [f64; 3] = [1e-3, 1e-2, 0.1];
/// Rounds of projections on half spaces.
const PROJECTIONS: usize = 50;
/// How often it is doubled.
const DOUBLINGS: u32 = 30;
/// What a decrease must be worth, relative to the value.
const NOTICEABLE: f64 = 1e-12;
/// What a row may be violated by along the way, relative to its size, and how far a row that binds may be left.
const MET: f64 = 1e-6;
const NEAR: f64 = 0.1;

impl Driver<'_, '_> {
    /// While the best point is a saddle: follow the negative curvature and solve again.
    pub(super) fn leave_saddles(&mut self) -> Result<(), SolveError> {
        self.at_saddle = false;
        for _ in 0..MOST_SADDLES {
            let regular = |t: &Trial| t.is_optimal() && !t.irregular;
            let Some(best) = self.best.clone().filter(regular) else {
                return Ok(());
            };
            if self.is_stopped() {
                return Ok(());
            }
            let Some(x) = self.beyond_saddle(&best) else {
                return Ok(());
            };
            let before = best.objective;
            let margin = 1e-9 * before.abs().max(1.0);
            if !self.named {
                self.sequential(x.clone(), None, Effort::FULL);
            }
            let now = self.best.as_ref().map_or(before, |t| t.objective);
            if now < before - margin {
                continue;
            }
            self.attempt_from(
                x,
                &[
                    ("mu_init", "1e-3"),
                    ("bound_push", "1e-6"),
                    ("bound_frac", "1e-6"),
                ],
            )?;
            let now = self.best.as_ref().map_or(before, |t| t.objective);
            self.at_saddle = now == before && self.ended == Ended::Diverging;
            if now >= before - margin {
                return Ok(());
            }
        }
        Ok(())
    }

    /// A point beyond the saddle, if the trial is one.
    fn beyond_saddle(&mut self, t: &Trial) -> Option<Vec<f64>> {
        if !self.affords_factors() {
            return None;
        }
        let mut problem = lock(&self.problem);
        let active = active_set(self.instance, &problem, t, 1e-6);
        let strong = self.strongly_active(&problem, t, &active);
        let differs = strong.fixed != active.fixed || strong.binding != active.binding;
        let wider = differs && self.settings.runs(Strategy::WeaklyActiveCurvature);
        let sets = [Some(&active), Some(&strong).filter(|_| wider)];
        for set in sets.into_iter().flatten() {
            let curvature = |p: &mut Problem| {
                negative_curvature(p, &t.x, (1.0, &t.lambda), &set.fixed, &set.binding)
            };
            // a kink that points upwards shows once it is rounded
            let rounded = || Problem::smoothed(self.instance, FINEST);
            let direction = match curvature(&mut problem) {
                None if self.kinks.is_some() => curvature(&mut rounded()),
                d => d,
            };
            let Some(d) = direction else { continue };
            if !self.settings.runs(Strategy::SaddleEscape) {
                return None;
            }
            let sizes = row_sizes(&problem);
            let mut from = vec![0.0; sizes.len()];
            problem.constraints(&t.x, &mut from)?;
            let (below, above) = (problem.sides().0.to_vec(), problem.sides().1.to_vec());
            let mut lagrangian = |p: &mut Problem, y: &[f64]| {
                let mut g = vec![0.0; from.len()];
                p.constraints(y, &mut g)?;
                let mut value = p.objective(y)?;
                for (i, &g) in g.iter().enumerate() {
                    if set.binding[i] {
                        value += t.lambda[i] * (g - from[i]);
                    }
                    let missed = (below[i] - g).max(g - above[i]);
                    let most = if set.binding[i] { NEAR } else { MET };
                    if missed > most * sizes[i] {
                        return None;
                    }
                }
                Some(value)
            };
            let weak = |i: usize| active.binding[i] && !set.binding[i];
            let sides = inner_sides(&mut problem, &t.x, &from, weak)?;
            if let Some(y) = downhill(&mut problem, &mut lagrangian, &t.x, &d, &sides) {
                return Some(y);
            }
        }
        None
    }

    /// What is active with a multiplier that is not 0.
    fn strongly_active(&self, problem: &Problem, t: &Trial, active: &Active) -> Active {
        let largest = t.lambda.iter().fold(1.0_f64, |s, l| s.max(l.abs()));
        let fixed = active.fixed.iter().zip(&problem.columns);
        let fixed = fixed.map(|(&is, &j)| {
            let j = j as usize;
            is && t.at.reduced[j].abs() > WEAK * t.at.column_size[j].max(1.0)
        });
        let rows = active.binding.iter().zip(&problem.rows).zip(&t.lambda);
        let binding = rows.map(|((&is, &i), l)| {
            let equation = self.instance.rows.relation[i as usize] == Relation::Equal;
            is && (equation || l.abs() > WEAK * largest)
        });
        Active {
            fixed: fixed.collect(),
            binding: binding.collect(),
        }
    }

    /// A point where less is violated, if linear programs see no way from x to one but the violation curves downwards there. `lambda`:
    /// the multipliers of the least violation.
    pub(super) fn beyond_least_violation(&mut self, x: &[f64], lambda: &[f64]) -> Option<Vec<f64>> {
        if !self.affords_factors() {
            return None;
        }
        let mut problem = lock(&self.problem);
        let (n, m) = problem.size();
        let sizes = row_sizes(&problem);
        let (below, above) = (problem.sides().0.to_vec(), problem.sides().1.to_vec());
        let missed = |i: usize, g: f64| (below[i] - g).max(g - above[i]).max(0.0) / sizes[i];
        let mut violation = |p: &mut Problem, y: &[f64]| {
            let mut g = vec![0.0; m];
            p.constraints(y, &mut g)?;
            Some(g.iter().enumerate().map(|(i, &g)| missed(i, g)).sum())
        };
        let mut g = vec![0.0; m];
        problem.constraints(x, &mut g)?;
        let mut reduced = vec![0.0; n];
        for (i, j, a) in problem.jacobian_entries(x)? {
            reduced[j] += lambda[i] * a;
        }
        let most = largest(lambda);
        let (lower, upper) = problem.bounds();
        let fixed: Vec<bool> = (0..n)
            .map(|j| (x[j] <= lower[j] || x[j] >= upper[j]) && reduced[j].abs() > WEAK * most)
            .collect();
        let binding: Vec<bool> = (0..m)
            .map(|i| missed(i, g[i]) <= MET && lambda[i].abs() > WEAK * most)
            .collect();
        let d = negative_curvature(&mut problem, x, (0.0, lambda), &fixed, &binding)?;
        if !self.settings.runs(Strategy::ViolationCurvature) {
            return None;
        }
        let weak = |i: usize| !binding[i] && missed(i, g[i]) <= MET;
        let sides = inner_sides(&mut problem, x, &g, weak)?;
        downhill(&mut problem, &mut violation, x, &d, &sides)
    }
}

/// What the violation of a row is measured by.
fn row_sizes(problem: &Problem) -> Vec<f64> {
    let (below, above) = problem.sides();
    let finite = |v: f64| if v.is_finite() { v.abs() } else { 0.0 };
    let sides = below.iter().zip(above);
    sides
        .map(|(&a, &b)| finite(a).max(finite(b)).max(1.0))
        .collect()
}

/// A row that a direction may be confined by: entries, and 1 where its value may not fall, −1 where it may not rise.
type InnerSide = (Vec<(usize, f64)>, f64);

/// Gradients of these rows at x, with the sides that their values are at.
fn inner_sides(
    problem: &mut Problem,
    x: &[f64],
    g: &[f64],
    weak: impl Fn(usize) -> bool,
) -> Option<Vec<InnerSide>> {
    let entries = problem.jacobian_entries(x)?;
    let sizes = row_sizes(problem);
    let (below, above) = problem.sides();
    let at = |i: usize, side: f64| (g[i] - side).abs() <= MET * sizes[i];
    let sign = |i: usize| match weak(i) && (at(i, below[i]) || at(i, above[i])) {
        true if at(i, below[i]) => 1.0,
        true => -1.0,
        false => 0.0,
    };
    let mut rows: Vec<InnerSide> = (0..g.len()).map(|i| (Vec::new(), sign(i))).collect();
    for (i, j, a) in entries.into_iter().filter(|e| e.2 != 0.0) {
        rows[i].0.push((j, a));
    }
    rows.retain(|(line, sign)| *sign != 0.0 && !line.is_empty());
    Some(rows)
}

/// d projected on one half space after the other until it is in all of them, nearly: bounds that x is at, and weakly active rows.
fn confined(d: &mut [f64], x: &[f64], (lower, upper): (&[f64], &[f64]), sides: &[InnerSide]) {
    for _ in 0..PROJECTIONS {
        for (j, d) in d.iter_mut().enumerate() {
            if x[j] <= lower[j] {
                *d = d.max(0.0);
            }
            if x[j] >= upper[j] {
                *d = d.min(0.0);
            }
        }
        let mut moved = false;
        for (line, sign) in sides {
            let rate: f64 = sign * line.iter().map(|&(j, a)| a * d[j]).sum::<f64>();
            let size: f64 = line.iter().map(|&(_, a)| a * a).sum();
            if rate < 0.0 {
                moved = true;
                line.iter()
                    .for_each(|&(j, a)| d[j] -= sign * rate / size * a);
            }
        }
        if !moved {
            break;
        }
    }
}

/// The point along d or −d, put into the bounds, up to which a value falls; of the two the one with the lower value. None where it does not
/// fall. The value has none where the way ends.
fn downhill(
    problem: &mut Problem,
    value: &mut dyn FnMut(&mut Problem, &[f64]) -> Option<f64>,
    x: &[f64],
    d: &[f64],
    sides: &[InnerSide],
) -> Option<Vec<f64>> {
    let (lower, upper) = (problem.bounds().0.to_vec(), problem.bounds().1.to_vec());
    let here = value(problem, x)?;
    let noticeable = NOTICEABLE * here.abs().max(1.0);
    let mut best: Option<(f64, Vec<f64>)> = None;
    for sign in [1.0, -1.0] {
        let mut d: Vec<f64> = d.iter().map(|d| sign * d).collect();
        confined(&mut d, x, (&lower, &upper), sides);
        let length = largest(&d);
        if length == 0.0 {
            continue;
        }
        let unit = largest(x).max(1.0) / length;
        let along = |t: f64| -> Vec<f64> {
            let mut y = sum(x, t * unit, &d);
            clip(&mut y, (&lower, &upper));
            y
        };
        let mut reached: Option<(f64, f64, Vec<f64>)> = None;
        for t in FIRST_STEPS {
            let y = along(t);
            if let Some(v) = value(problem, &y).filter(|v| *v < here - noticeable) {
                reached = Some((t, v, y));
                break;
            }
        }
        let Some((mut t, mut least, mut point)) = reached else {
            continue;
        };
        for _ in 0..DOUBLINGS {
            t *= 2.0;
            let y = along(t);
            match value(problem, &y).filter(|v| *v < least - noticeable) {
                Some(v) => (least, point) = (v, y),
                None => break,
            }
        }
        if best.as_ref().is_none_or(|b| least < b.0) {
            best = Some((least, point));
        }
    }
    best.map(|b| b.1)
}
