//! The certificate of nonlinear instances: KKT residuals on the unscaled instance.
//!
//! With a(x) the activities, m the marginals of the rows, σ = +1 for min and −1 for max, z the
//! objective column and r_j = \[j = z\] − Σ_i m_i ∂a_i/∂x_j the reduced costs, x is stationary when for
//! every column σr_j ≥ 0 at the lower bound, ≤ 0 at the upper, 0 in between, and for every inequality
//! its multiplier has the right sign and is 0 where the row is slack. Each of these is a pair "one of
//! two numbers is 0, the other has a sign", and its residual is the natural one: the smaller of the
//! two numbers (so a tiny reduced cost far from a bound is as tiny a residual, whatever the distance).
//!
//! * **dual** residual: the largest of these, in the model's units;
//! * **complementarity**: the largest |multiplier · distance|;
//! * **dual relative**: a reduced cost relative to max(1, max_i |m_i ∂a_i/∂x_j|), a distance relative to max(1, |x_j|), a multiplier by the reduced costs it makes, a slack relative to its row's size; a reduced cost that
//!   changes its sign within the tolerance of the level is 0.
//!
//! The primal residuals are those of [`super`], with |∂a_i/∂x_j · x_j| as the size of an
//! entry.

use super::{Linearised, Residuals, TOLERANCE, primal, row_violation, units, wrong_sign};
use crate::autodiff::{ErrorKind, EvalFailure, Evaluator, kinks};
use crate::model::instance::{Instance, Relation};
use crate::model::sum::Sum;
use crate::solve::vector::largest;

/// Width of the smoothing by which derivatives at a kink are judged; a shrinking sequence ends there.
pub const KINK_WIDTH: f64 = 1e-7;
/// Levels from here on are large for a model that has a solution.
pub const FAR: f64 = 1e7;
/// A change of the objective that matters, relative to its size.
pub const CONSIDERABLE: f64 = 0.01;

/// Products of multipliers and slopes beyond this lose a slope of 1e-3 by rounding: a reduced cost that is small
/// beside them alone says nothing about the objective.
const HIDING: f64 = 1e12;

/// How far inside of a bound values and derivatives are taken that do not exist on it or just beyond, relative to its size.
const INSIDE: f64 = 1e-10;

/// Values, reduced costs and sizes at a point.
///
/// Errors: a function that has no value or no derivative there.
pub fn linearise(
    instance: &Instance,
    evaluator: &mut Evaluator,
    x: &[f64],
    row_marginal: &[f64],
) -> Result<Linearised, EvalFailure> {
    let (m, n) = (instance.row_count(), instance.column_count());
    let mut activity = vec![0.0; m];
    evaluator.rows(x, &mut activity)?;
    let mut value = vec![0.0; evaluator.jacobian_pattern().1.len()];
    let columns = &instance.columns;
    if let Err(e) = evaluator.jacobian(x, &mut value) {
        let inside = inside(&e, x, &columns.lower, &columns.upper).ok_or(e)?;
        evaluator.jacobian(&inside, &mut value)?;
    }
    let (start, column) = evaluator.jacobian_pattern();
    let (xi, _) = units(instance);
    let mut reduced = vec![Sum::default(); n];
    let mut column_size = vec![0.0f64; n];
    let mut row_size = vec![0.0f64; m];
    if let Some(objective) = instance.objective {
        reduced[objective.column as usize].add(1.0);
        column_size[objective.column as usize] = 1.0;
    }
    for i in 0..m {
        for k in start[i]..start[i + 1] {
            let (j, a) = (column[k] as usize, value[k]);
            // A slope says little about the size of its row where the variable is small: in y·z ≤ μ at y = 0 it is z, which
            // may be anything, as may the coefficient of a switch.
            let floor = (a.abs() * xi).min(1.0);
            row_size[i] = row_size[i].max((a * x[j]).abs()).max(floor);
        }
        let multiplier = row_marginal[i];
        for k in start[i]..start[i + 1] {
            let (j, a) = (column[k] as usize, value[k]);
            reduced[j].add_product(-multiplier, a);
            column_size[j] = column_size[j].max((a * multiplier).abs());
        }
    }
    Ok(Linearised {
        activity,
        reduced: reduced.into_iter().map(Sum::value).collect(),
        row_size,
        column_size,
    })
}

/// Whether each row holds as an equation at a point, by its level and derivatives.
pub fn binding_rows(
    instance: &Instance,
    x: &[f64],
    activity: &[f64],
    lines: &[Vec<(usize, f64)>],
) -> Vec<bool> {
    let binds = |i: usize| {
        let rhs = instance.rows.rhs[i];
        let terms = lines[i]
            .iter()
            .map(|&(j, a)| (a * x[j].abs().max(1.0)).abs());
        let size = terms.fold(rhs.abs().max(1.0), f64::max);
        match instance.rows.relation[i] {
            Relation::Equal => true,
            Relation::Free => false,
            _ => (activity[i] - rhs).abs() <= TOLERANCE * size,
        }
    };
    (0..lines.len()).map(binds).collect()
}

/// How far a column may move down and up, at most `reach` each way: not beyond a bound that it is at.
pub fn steps_within_bounds(instance: &Instance, x: &[f64], j: usize, reach: f64) -> [f64; 2] {
    let near = TOLERANCE * x[j].abs().max(1.0);
    let down = x[j] - instance.columns.lower[j] > near;
    let up = instance.columns.upper[j] - x[j] > near;
    [
        if down { -reach } else { 0.0 },
        if up { reach } else { 0.0 },
    ]
}

/// Where a derivative does not exist, as that of √x at 0: the point with what is at a bound moved inside by next to nothing.
/// There the slope is steep, as the limit is. Where something is beyond a bound, which an interior point relaxes a little, the
/// same for any failure. None where the failure is another.
pub fn inside(failure: &EvalFailure, x: &[f64], lower: &[f64], upper: &[f64]) -> Option<Vec<f64>> {
    let moved = |(&x, (&l, &u)): (&f64, (&f64, &f64))| match INSIDE * x.abs().max(1.0) {
        by if x <= l && u - l > 2.0 * by => l + by,
        by if x >= u && u - l > 2.0 * by => u - by,
        _ => x,
    };
    let all = x.iter().zip(lower.iter().zip(upper));
    let is_beyond = |(x, (l, u)): (&f64, (&f64, &f64))| x < l || x > u;
    let counts = failure.error.kind == ErrorKind::Derivative || all.clone().any(is_beyond);
    counts.then(|| all.map(moved).collect())
}

/// The worst of a kind of residual.
#[derive(Default)]
struct Worst {
    value: f64,
    relative: f64,
    place: Option<usize>,
}

impl Worst {
    fn see(&mut self, value: f64, relative: f64, place: usize) {
        let relative = if relative.is_nan() {
            f64::INFINITY
        } else {
            relative
        };
        self.value = self
            .value
            .max(if value.is_nan() { f64::INFINITY } else { value });
        if relative > self.relative {
            self.relative = relative;
            self.place = Some(place);
        }
    }
}

/// All residuals of an instance with or without an objective, given its linearisation.
pub fn residuals(
    instance: &Instance,
    x: &[f64],
    row_marginal: &[f64],
    at: &Linearised,
) -> Residuals {
    let mut out = primal(instance, x, &at.activity, &at.row_size);
    let Some(sigma) = instance.objective.map(|o| o.sense.sign()) else {
        // nothing to be stationary for
        return out;
    };
    let (mut rows, mut columns) = (Worst::default(), Worst::default());
    let (mut product, mut products) = (0.0f64, Sum::default());
    let mut complement = |p: f64| {
        product = product.max(p);
        products.add(p);
    };
    let unit = at.column_size.iter().fold(1.0f64, |s, v| v.max(s));
    for (i, &m) in row_marginal.iter().enumerate() {
        let rhs = instance.rows.rhs[i];
        let size = at.row_size[i].max(rhs.abs()).max(1.0);
        // multiplier in the direction the row may push, slack in the direction it may not go
        let (push, slack) = match instance.rows.relation[i] {
            Relation::Equal => continue,
            Relation::Free => (-m.abs(), f64::INFINITY),
            Relation::Greater => (sigma * m, at.activity[i] - rhs),
            Relation::Less => (-sigma * m, rhs - at.activity[i]),
        };
        let effect = push.abs() * (at.row_size[i].max(1.0) / unit).min(1.0);
        if push < 0.0 || push.is_nan() {
            rows.see(push.abs(), effect, i);
        } else {
            let slack = slack.max(0.0);
            rows.see(push.min(slack), effect.min(slack / size), i);
            if push > 0.0 {
                complement(push * slack);
            }
        }
    }
    for (j, &r) in at.reduced.iter().enumerate() {
        let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
        if l == u {
            continue;
        }
        let priced = sigma * r;
        let side = if priced > 0.0 { x[j] - l } else { u - x[j] };
        let distance = side.max(0.0);
        let size = match at.column_size[j] {
            size if size > HIDING => 1.0,
            size => size.max(1.0),
        };
        let relative = (priced.abs() / size).min(distance / x[j].abs().max(1.0));
        columns.see(priced.abs().min(distance), relative, j);
        if r != 0.0 && distance.is_finite() {
            complement(priced.abs() * distance);
        }
    }
    out.dual = Some(rows.value.max(columns.value));
    out.dual_relative = rows.relative.max(columns.relative);
    out.worst_dual_row = rows.place.filter(|_| rows.relative >= columns.relative);
    out.worst_dual_column = columns.place.filter(|_| columns.relative > rows.relative);
    out.complementarity = Some(product);
    out.complementarity_sum = Some(products.value());
    out
}

/// Levels of the rows; not a number where a function has no value.
pub fn activity(instance: &Instance, level: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; instance.row_count()];
    let known = Evaluator::first_order(instance).rows(level, &mut out);
    if known.is_err() {
        out.fill(f64::NAN);
    }
    out
}

/// For instances with kinks: derivatives beside them, for [`measure`].
pub fn beside_kinks(instance: &Instance) -> Option<Evaluator> {
    kinks(instance).map(|_| Evaluator::smoothed_first_order(instance, KINK_WIDTH))
}

/// Residuals at a point with marginals of the rows, and the instance there; infinite residuals where a function has no value
/// or no derivative.
///
/// At a kink the derivative is any number between the one-sided ones: that of the smoothed functions is taken if it makes the
/// point more nearly stationary. Values stay exact.
pub fn measure(
    instance: &Instance,
    evaluator: &mut Evaluator,
    smoothed: &mut Option<Evaluator>,
    level: &[f64],
    row_marginal: &[f64],
) -> (Residuals, Linearised) {
    let Ok(mut at) = linearise(instance, evaluator, level, row_marginal) else {
        return without_derivatives(instance, evaluator, level);
    };
    let mut found = residuals(instance, level, row_marginal, &at);
    if found.is_feasible(TOLERANCE)
        && found.dual_relative > TOLERANCE
        && change_sign_nearby(instance, evaluator, level, row_marginal, &mut at)
    {
        found = residuals(instance, level, row_marginal, &at);
    }
    if let Some(evaluator) = smoothed
        && let Ok(mut beside) = linearise(instance, evaluator, level, row_marginal)
    {
        beside.activity.clone_from(&at.activity);
        let better = residuals(instance, level, row_marginal, &beside);
        if better.dual_relative < found.dual_relative {
            (found, at) = (better, beside);
        }
    }
    (found, at)
}

/// Reduced costs that are looked at from nearby, at most.
const MOST_STEEP: usize = 100;

/// Puts reduced costs to 0 that change their sign within the tolerance of the level: where slopes change faster than digits, as that of
/// x**1.1 − c·x near 0, such a column is as near to where it is stationary as others are to their bounds. Only if all that are not 0
/// do so, each at a gain that is none beside the objective; whether they do.
fn change_sign_nearby(
    instance: &Instance,
    evaluator: &mut Evaluator,
    level: &[f64],
    row_marginal: &[f64],
    at: &mut Linearised,
) -> bool {
    let Some(objective) = instance.objective else {
        return false;
    };
    let value = level[objective.column as usize].abs().max(1.0);
    let columns = &instance.columns;
    let mut there = level.to_vec();
    let mut steep = Vec::new();
    for (j, &x) in level.iter().enumerate() {
        let (l, u, r) = (columns.lower[j], columns.upper[j], at.reduced[j]);
        let by = TOLERANCE * x.abs().max(1.0);
        let (to, room) = match objective.sense.sign() * r > 0.0 {
            true => (x - by, x - l),
            false => (x + by, u - x),
        };
        let size = at.column_size[j].clamp(1.0, HIDING);
        if l == u || room <= by || r.abs() <= TOLERANCE * size {
            continue;
        }
        there[j] = to;
        let moved = linearise(instance, evaluator, &there, row_marginal);
        there[j] = x;
        let changes = moved.is_ok_and(|m| m.reduced[j] * r <= 0.0);
        if !changes || r.abs() * by > TOLERANCE * value || steep.len() == MOST_STEEP {
            return false;
        }
        steep.push(j);
    }
    steep.iter().for_each(|&j| at.reduced[j] = 0.0);
    !steep.is_empty()
}

/// Residuals of a point without derivatives, or without values.
fn without_derivatives(
    instance: &Instance,
    evaluator: &mut Evaluator,
    level: &[f64],
) -> (Residuals, Linearised) {
    let mut activity = vec![0.0; instance.row_count()];
    let known = evaluator.rows(level, &mut activity).is_ok();
    if !known {
        activity.fill(f64::NAN);
    }
    let row_size: Vec<f64> = activity.iter().map(|a| a.abs().max(1.0)).collect();
    let mut residuals = primal(instance, level, &activity, &row_size);
    residuals.dual_relative = f64::INFINITY;
    if !known {
        residuals.primal_relative = f64::INFINITY;
    }
    let at = Linearised {
        activity,
        reduced: vec![0.0; level.len()],
        row_size,
        column_size: vec![1.0; level.len()],
    };
    (residuals, at)
}

/// Whether the point is feasible by the scale of its numbers only: a variable is beyond [`FAR`], and violations within the
/// tolerance are worth a considerable part of the objective. x y ≥ 10 and x + y ≤ 1 hold where x = −1e-9 stands for x ≥ 0, and y
/// for −1e10.
pub fn is_feasible_only_by_scaling(
    instance: &Instance,
    level: &[f64],
    row_marginal: &[f64],
    activity: &[f64],
) -> bool {
    let rows = &instance.rows;
    let violation = |i: usize| row_violation(rows.relation[i], activity[i], rows.rhs[i]);
    let worth = |i: usize| row_marginal[i].abs() * violation(i);
    let objective = instance.objective.map_or(0.0, |o| level[o.column as usize]);
    level.iter().any(|x| x.abs() >= FAR)
        && (0..row_marginal.len()).map(worth).sum::<f64>() > CONSIDERABLE * objective.abs().max(1.0)
}

/// What is left of terms that cancel, where x is not quite where they do.
const CANCELLED: f64 = 0.01;

/// Whether multipliers y of the rows prove that the rows, linearised at x, have no solution within
/// the bounds: y has the rows' signs, and Σ y_i (b_i − a_i(x)) exceeds every Σ_j (Jᵀy)_j (x'_j − x_j)
/// (Farkas). For convex rows that is a proof of infeasibility, for others of local infeasibility.
///
/// Components of Jᵀy below `tolerance` relative to the largest term, or to what they could change in the
/// neighbourhood of x if most of their own terms cancel, count as 0.
pub fn is_locally_infeasible(
    instance: &Instance,
    evaluator: &mut Evaluator,
    x: &[f64],
    y: &[f64],
    tolerance: f64,
) -> bool {
    let m = instance.row_count();
    let mut activity = vec![0.0; m];
    let mut value = vec![0.0; evaluator.jacobian_pattern().1.len()];
    if evaluator.rows(x, &mut activity).is_err() || evaluator.jacobian(x, &mut value).is_err() {
        return false;
    }
    let (start, column) = evaluator.jacobian_pattern();
    let mut reach = vec![Sum::default(); x.len()];
    let mut size_of = vec![0.0f64; x.len()];
    let mut margin = Sum::default();
    let unit = largest(y);
    for i in 0..m {
        let wrong = wrong_sign(instance.rows.relation[i], y[i]);
        if wrong > 1e-6 * unit || y[i].is_nan() {
            return false;
        }
        if wrong > 0.0 || y[i] == 0.0 {
            continue;
        }
        margin.add_product(y[i], instance.rows.rhs[i] - activity[i]);
        for k in start[i]..start[i + 1] {
            let j = column[k] as usize;
            reach[j].add_product(value[k], y[i]);
            size_of[j] = size_of[j].max((value[k] * y[i]).abs());
        }
    }
    let term = size_of.iter().fold(0.0f64, |s, v| s.max(*v));
    let mut margin = margin.value();
    let size = margin;
    for (j, r) in reach.iter().enumerate() {
        let r = r.value();
        let bound = if r > 0.0 {
            instance.columns.upper[j]
        } else {
            instance.columns.lower[j]
        };
        let room = (bound - x[j]).abs();
        let near = r.abs() * x[j].abs().max(1.0) <= tolerance * size;
        if r.abs() <= tolerance * term || near && r.abs() <= CANCELLED * size_of[j] {
            // noise: only as far as the neighbourhood of x
            margin -= (r * room.min(x[j].abs().max(1.0))).abs();
        } else if r != 0.0 {
            margin -= r.abs() * room;
        }
    }
    margin > 1e-3 * size && size > 0.0
}

/// Multipliers for [`is_locally_infeasible`] from the violations themselves: right where x minimises
/// the sum of their squares.
pub fn violations(instance: &Instance, activity: &[f64]) -> Vec<f64> {
    activity
        .iter()
        .enumerate()
        .map(|(i, a)| {
            let gap = instance.rows.rhs[i] - a;
            match instance.rows.relation[i] {
                Relation::Equal => gap,
                Relation::Greater => gap.max(0.0),
                Relation::Less => gap.min(0.0),
                Relation::Free => 0.0,
            }
        })
        .collect()
}
