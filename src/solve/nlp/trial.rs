//! A point and what it is worth.

use super::interior_point::Ended;
use super::polish::{Active, polish};
use super::problem::Problem;
use crate::autodiff::{Degree, Evaluator};
use crate::model::instance::{Instance, Relation};
pub(super) use crate::solve::certificate::nonlinear::{CONSIDERABLE, FAR};
use crate::solve::certificate::nonlinear::{is_feasible_only_by_scaling, measure};
use crate::solve::certificate::{Linearised, Residuals, TOLERANCE, row_violation};
use crate::solve::noise::{LEVELS, rounding, snap};
use crate::solve::vector::clip;

/// A point that was judged.
#[derive(Clone)]
pub(super) struct Trial {
    pub(super) x: Vec<f64>,
    pub(super) lambda: Vec<f64>,
    pub(super) level: Vec<f64>,
    pub(super) row_marginal: Vec<f64>,
    pub(super) at: Linearised,
    pub(super) residuals: Residuals,
    pub(super) ended: Ended,
    /// Minimised.
    pub(super) objective: f64,
    /// Stationary to the tolerance only because it is far away: the objective still changes there.
    pub(super) diverging: bool,
    /// Feasible to the tolerance only because it is far away: without what is violated, the objective would be another.
    pub(super) feasible_only_by_scaling: bool,
    /// Complementary only because a variable is near its bound: the slope is so steep that the objective still changes on the way there.
    pub(super) steep: bool,
    /// The objective gets better without limit.
    pub(super) unbounded: bool,
    /// The rows have no multipliers here; rows a little wider have, with all but the same value.
    pub(super) irregular: bool,
}

impl Trial {
    pub(super) fn is_optimal(&self) -> bool {
        self.is_stationary() && !self.diverging && !self.steep || self.irregular
    }

    /// Satisfies the conditions of first order.
    pub(super) fn is_stationary(&self) -> bool {
        self.is_feasible() && self.residuals.dual_relative <= TOLERANCE
    }

    pub(super) fn is_feasible(&self) -> bool {
        self.residuals.is_feasible(TOLERANCE) && !self.feasible_only_by_scaling
    }

    /// The larger of the relative residuals.
    pub(super) fn residual(&self) -> f64 {
        self.residuals
            .primal_relative
            .max(self.residuals.dual_relative)
    }

    /// The largest violation of a row, relative to its right-hand side, if that is not 0.
    pub(super) fn relative_miss(&self, instance: &Instance) -> f64 {
        let rows = (0..instance.row_count()).filter(|&i| instance.rows.rhs[i] != 0.0);
        let misses = rows.map(|i| violation(instance, &self.at, i) / instance.rows.rhs[i].abs());
        misses.fold(0.0, f64::max)
    }

    /// Whether the residuals are not above those of the other, or what matters.
    fn is_as_good(&self, other: &Self, matters: f64) -> bool {
        let (now, before) = (&self.residuals, &other.residuals);
        now.primal_relative <= before.primal_relative.max(matters)
            && now.dual_relative <= before.dual_relative.max(matters)
    }

    /// Whether this one is worth more than the other.
    pub(super) fn better(&self, other: &Self) -> bool {
        let rank = |t: &Self| u8::from(t.is_optimal()) + u8::from(t.is_feasible());
        let (a, b) = (rank(self), rank(other));
        if a != b {
            return a > b;
        }
        if a == 0 {
            return self.residuals.primal_relative < other.residuals.primal_relative;
        }
        self.objective < other.objective
    }
}

/// Levels, marginals and residuals of a point.
pub(super) fn residuals_at(
    instance: &Instance,
    problem: &mut Problem,
    kinks: &mut Option<Evaluator>,
    x: Vec<f64>,
    lambda: Vec<f64>,
    ended: Ended,
) -> Trial {
    let level = problem.levels(&x);
    let row_marginal = problem.row_marginals(&lambda);
    let objective = instance
        .objective
        .map_or(0.0, |o| o.sense.sign() * level[o.column as usize]);
    let (residuals, at) = measure(
        instance,
        &mut problem.evaluator,
        kinks,
        &level,
        &row_marginal,
    );
    let diverging = is_promising(instance, &level, &at.reduced, objective, |x, _| x >= FAR);
    let steep = |x: f64, distance: f64| distance <= TOLERANCE * x.max(1.0);
    let steep = is_promising(instance, &level, &at.reduced, objective, steep);
    let feasible_only_by_scaling =
        is_feasible_only_by_scaling(instance, &level, &row_marginal, &at.activity);
    Trial {
        x,
        lambda,
        level,
        row_marginal,
        at,
        residuals,
        ended,
        objective,
        diverging,
        feasible_only_by_scaling,
        steep,
        unbounded: false,
        irregular: false,
    }
}

/// Whether a variable of some size and distance from its bound promises a considerable change of the objective if it goes on to
/// that bound, or as far again: beyond [`FAR`], where everything flattens out towards infinity, and next to a pole derivatives alone say little.
fn is_promising(
    instance: &Instance,
    level: &[f64],
    reduced: &[f64],
    objective: f64,
    concerns: impl Fn(f64, f64) -> bool,
) -> bool {
    let columns = &instance.columns;
    let sign = instance.sign();
    let considerable = CONSIDERABLE * objective.abs().max(1.0);
    (0..level.len()).any(|j| {
        let slope = sign * reduced[j];
        let bound = if slope > 0.0 {
            columns.lower[j]
        } else {
            columns.upper[j]
        };
        let (size, distance) = (level[j].abs(), (level[j] - bound).abs());
        concerns(size, distance) && slope.abs() * distance.min(size) > considerable
    })
}

/// Violation of row i.
fn violation(instance: &Instance, at: &Linearised, i: usize) -> f64 {
    let rows = &instance.rows;
    row_violation(rows.relation[i], at.activity[i], rows.rhs[i])
}

/// An interior point stops slightly short of the bounds. Puts such variables on their bounds, also on those that
/// linear rows of one variable are, and multipliers of slack rows and reduced costs of variables between their bounds to 0.
pub(super) fn tidy(
    instance: &Instance,
    problem: &mut Problem,
    kinks: &mut Option<Evaluator>,
    t: &Trial,
) -> Option<Trial> {
    let (lower, upper) = (problem.bounds().0.to_vec(), problem.bounds().1.to_vec());
    let mut x = t.x.clone();
    // on the bound if it is near, and nearer than its multiplier is to 0
    let place = |v: &mut f64, b: f64, multiplier: f64| {
        let distance = (*v - b).abs();
        if distance <= 1e-6 * b.abs().max(1.0) && distance <= 1e3 * multiplier.abs() {
            *v = b;
        }
    };
    for (k, v) in x.iter_mut().enumerate() {
        let r = t.at.reduced[problem.columns[k] as usize];
        place(v, lower[k], r);
        place(v, upper[k], r);
    }
    let degrees = problem.evaluator.degrees();
    for (k, l) in t.lambda.iter().enumerate() {
        let i = problem.rows[k] as usize;
        let mut entries = instance.matrix.row(i);
        let (Some((j, a)), None, Degree::Linear) = (entries.next(), entries.next(), degrees[i])
        else {
            continue;
        };
        let certain = instance.rows.relation[i] == Relation::Equal;
        let multiplier = if certain { f64::INFINITY } else { l * a };
        if let Ok(v) = problem.columns.binary_search(&(j as u32)) {
            place(&mut x[v], instance.rows.rhs[i] / a, multiplier);
        }
    }
    let mut lambda = t.lambda.clone();
    for (k, l) in lambda.iter_mut().enumerate() {
        let i = problem.rows[k] as usize;
        if instance.rows.relation[i] == Relation::Equal {
            continue;
        }
        let slack = (t.at.activity[i] - instance.rows.rhs[i]).abs();
        if slack > 1e-6 * t.at.row_size[i].max(1.0)
            && l.abs() * t.at.row_size[i].max(1.0) <= 1e-5 * slack
        {
            *l = 0.0;
        }
    }
    let tidied = residuals_at(instance, problem, kinks, x, lambda, t.ended);
    tidied.is_as_good(t, 1e-9).then_some(tidied)
}

/// The trial without values that are nothing but noise around 0 or a bound, if it is worth as much.
pub(super) fn without_noise(
    instance: &Instance,
    problem: &mut Problem,
    kinks: &mut Option<Evaluator>,
    t: &Trial,
) -> Option<Trial> {
    let (lower, upper) = problem.bounds();
    let mut x = t.x.clone();
    snap(&mut x, lower, upper, &rounding(&t.x));
    for (v, (&l, &u)) in x.iter_mut().zip(lower.iter().zip(upper)) {
        if v.abs() <= LEVELS && l <= 0.0 && u >= 0.0 {
            *v = 0.0;
        }
    }
    if x == t.x {
        return None;
    }
    let lambda = t.lambda.clone();
    let quiet = residuals_at(instance, problem, kinks, x, lambda, t.ended);
    quiet.is_as_good(t, LEVELS).then_some(quiet)
}

/// Variables at a bound and rows that bind, to a relative tolerance.
pub(super) fn active_set(
    instance: &Instance,
    problem: &Problem,
    t: &Trial,
    tolerance: f64,
) -> Active {
    let (lower, upper) = problem.bounds();
    let near = |x: f64, b: f64| b.is_finite() && (x - b).abs() <= tolerance * b.abs().max(1.0);
    let fixed =
        t.x.iter()
            .zip(lower.iter().zip(upper))
            .map(|(&x, (&l, &u))| near(x, l) || near(x, u))
            .collect();
    let binding = problem
        .rows
        .iter()
        .map(|&i| {
            let i = i as usize;
            let (a, b) = (t.at.activity[i], instance.rows.rhs[i]);
            let size = t.at.row_size[i].max(b.abs()).max(1.0);
            instance.rows.relation[i] == Relation::Equal || (a - b).abs() <= tolerance * size
        })
        .collect();
    Active { fixed, binding }
}

/// The trial after Newton steps on its active set, found to a relative tolerance.
pub(super) fn polished(
    instance: &Instance,
    problem: &mut Problem,
    kinks: &mut Option<Evaluator>,
    t: &Trial,
    tolerance: f64,
) -> Option<Trial> {
    let mut active = active_set(instance, problem, t, tolerance);
    let (lower, upper) = (problem.bounds().0.to_vec(), problem.bounds().1.to_vec());
    let mut x = t.x.clone();
    let mut lambda = t.lambda.clone();
    for k in 0..x.len() {
        if active.fixed[k] {
            // at a bound without a reduced cost: free, unless it is exactly there
            let r = t.at.reduced[problem.columns[k] as usize].abs();
            let (l, u) = (lower[k], upper[k]);
            let b = if (x[k] - l).abs() <= (x[k] - u).abs() {
                l
            } else {
                u
            };
            if r < 1e-7 * t.at.column_size[problem.columns[k] as usize].max(1.0) && x[k] != b {
                active.fixed[k] = false;
            } else {
                x[k] = b;
            }
        }
    }
    let mut target = Vec::with_capacity(problem.rows.len());
    for (k, &i) in problem.rows.iter().enumerate() {
        target.push(instance.rows.rhs[i as usize]);
        if !active.binding[k] {
            lambda[k] = 0.0;
        }
    }
    if !polish(problem, &active, &target, &mut x, &mut lambda) {
        return None;
    }
    clip(&mut x, (&lower, &upper));
    Some(residuals_at(instance, problem, kinks, x, lambda, t.ended))
}

/// Reduced costs of variables between their bounds that are nothing but noise become 0.
pub(super) fn clean(instance: &Instance, t: &mut Trial) {
    for j in 0..instance.column_count() {
        let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
        let inside = t.level[j] > l && t.level[j] < u;
        if inside && t.at.reduced[j].abs() <= TOLERANCE * t.at.column_size[j].max(1.0) {
            t.at.reduced[j] = 0.0;
        }
    }
}
