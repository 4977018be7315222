//! The certificate: what a returned point is worth, recomputed on the unscaled instance.
//!
//! A solver's status is a claim. This module measures the point itself and decides what is
//! reported: a point is called optimal when its residuals say so, a model infeasible or unbounded
//! when the solver's ray proves it.
//!
//! With a the activities of the rows, m the marginals of the rows, x the levels, σ = +1 for min
//! and −1 for max, and z the objective column, the reduced cost of column j is
//! r_j = \[j = z\] − Σ_i m_i ∂a_i/∂x_j, and
//!
//! * **primal** residual: the largest violation of a row or a bound;
//! * **dual** residual: the largest wrong-signed multiplier: σm_i < 0 for `=g=`, > 0 for `=l=`,
//!   σr_j > 0 without a lower bound, < 0 without an upper bound;
//! * **complementarity**: the largest |multiplier · distance to the side it belongs to|;
//! * **gap**: primal minus dual objective (the sum of those products for linear instances);
//! * **natural** residual (complementarity models): max |x − mid(l, u, x − F)|.
//!
//! These are absolute numbers, in the model's units. Whether they are small is judged relative to
//! the data: the violation of row i relative to max(|rhs_i|, max_j |a_ij x_j|, max_j min(|a_ij| ξ, 1)), of
//! which only a thousandth counts beyond 1, that of a multiplier of column j relative to max_i |a_ij|·max(|m_i|, η), the gap relative to the largest
//! term of the two objectives or ξη. ξ is 1, or the largest level that right-hand sides and bounds
//! suggest where that is smaller; η is 1, or the largest cost (see [`units`]). So an instance in
//! other units has the same status, and noise around 0 is not mistaken for a violation. The
//! tolerance is [`TOLERANCE`].

pub mod nonlinear;

use crate::model::instance::{INFINITE, Instance, Relation, Sense};
use crate::model::outcome::{Claim, ModelStatus, Outcome};
use crate::model::sum::Sum;
use crate::solve::lp::form::{self, Problem};
use crate::solve::noise::is_rounding;
use crate::solve::vector::largest;

/// Relative tolerance for primal and dual residuals and the gap.
pub const TOLERANCE: f64 = 1e-6;

/// What of a size above 1 counts: rows and bounds are judged by [`TOLERANCE`], or by this times it relative to terms of a
/// thousand and more.
const LARGE_TERM_FACTOR: f64 = 1e-3;

/// What a violation is relative to in a row whose largest term, or at a bound whose size, is this.
pub fn unit_of(size: f64) -> f64 {
    size.min(1.0).max(LARGE_TERM_FACTOR * size)
}

/// Largest violations, in the model's units; None where one does not apply.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Residuals {
    /// Largest violation of a row or bound.
    pub primal: Option<f64>,
    /// Sum of all violations.
    pub primal_sum: Option<f64>,
    /// Largest wrong-signed multiplier, or departure from stationarity.
    pub dual: Option<f64>,
    /// Largest |multiplier · slack|; for mpec over the pairs.
    pub complementarity: Option<f64>,
    /// Sum of them.
    pub complementarity_sum: Option<f64>,
    /// max |x − mid(l, u, x − F)|.
    pub natural: Option<f64>,
    /// For mcp: the largest |F| times the distance to the bound that F's sign asks for, if that is below 1. GAMS gives
    /// it as the objective value.
    pub pairs: Option<f64>,
    /// |primal − dual objective|.
    pub gap: Option<f64>,
    /// Row of the largest residual (primal; for mcp natural), if it is a row's.
    pub worst_row: Option<usize>,
    /// Column of the largest residual, if it is a column's.
    pub worst_column: Option<usize>,
    /// Column of the largest dual residual, if it is a column's.
    pub worst_dual_column: Option<usize>,
    /// Row of the largest dual residual, if it is a row's.
    pub worst_dual_row: Option<usize>,
    /// The primal residual relative to the data.
    pub primal_relative: f64,
    /// The dual residual relative to the data.
    pub dual_relative: f64,
    /// The gap relative to the data.
    pub gap_relative: f64,
    /// The natural residual with every variable in units of max(1, |x_j|), every row in units of its largest term.
    pub natural_relative: f64,
    /// Number of rows and columns that violate the relative tolerance (`.numinfes`).
    pub infeasible_count: usize,
    /// What the rows of unsolved pairs are off by in a complementarity model: the sum and the largest (`.suminfes`, `.maxinfes`).
    pub unsolved: Option<(f64, f64)>,
}

impl Residuals {
    /// The point satisfies all rows and bounds to `tolerance`, relative to the data.
    pub fn is_feasible(&self, tolerance: f64) -> bool {
        self.primal_relative <= tolerance
    }

    /// The point is optimal to `tolerance`, relative to the data.
    pub fn is_optimal(&self, tolerance: f64) -> bool {
        self.is_feasible(tolerance)
            && self.dual_relative <= tolerance
            && self.gap_relative <= tolerance
    }
}

/// The instance at a point: values, and derivatives summed with the marginals. For a linear
/// instance see [`linearise`]; for others the derivatives come from `autodiff`.
#[derive(Clone, Debug, Default)]
pub struct Linearised {
    /// Σ_j a_ij x_j, or the value of the row's left side.
    pub activity: Vec<f64>,
    /// r_j = \[j = z\] − Σ_i m_i a_ij.
    pub reduced: Vec<f64>,
    /// max_j max(|a_ij x_j|, min(|a_ij| ξ, 1)), per row.
    pub row_size: Vec<f64>,
    /// max_i |a_ij|·max(|m_i|, η), per column.
    pub column_size: Vec<f64>,
}

/// The units (ξ, η) of levels and of multipliers below which nothing is resolved. Both are at most
/// 1: ξ is the largest of the finite bounds and of |rhs_i| / max_j |a_ij|, η the largest
/// |a_ij / a_iz| of a row that contains the objective column z; 1 where there is none but 0.
/// Only the linear part is looked at.
pub fn units(instance: &Instance) -> (f64, f64) {
    let columns = &instance.columns;
    let bounds = columns.lower.iter().chain(&columns.upper);
    let mut data = bounds
        .filter(|b| b.is_finite())
        .fold(0.0f64, |d, b| d.max(b.abs()));
    let mut cost = 0.0f64;
    for i in 0..instance.row_count() {
        let row = instance.matrix.row(i);
        let top = row.fold(0.0f64, |t, (_, a)| t.max(a.abs()));
        if top > 0.0 {
            data = data.max(instance.rows.rhs[i].abs() / top);
        }
        let Some(z) = instance.objective.map(|o| o.column as usize) else {
            continue;
        };
        if let Some((_, a_z)) = instance.matrix.row(i).find(|&(j, _)| j == z) {
            let others = instance.matrix.row(i).filter(|&(j, _)| j != z);
            cost = others.fold(cost, |c, (_, a)| c.max((a / a_z).abs()));
        }
    }
    let unit = |x: f64| if x > 0.0 { x.min(1.0) } else { 1.0 };
    (unit(data), unit(cost))
}

/// Activities, reduced costs and sizes of a linear instance at an outcome's point.
pub fn linearise(instance: &Instance, outcome: &Outcome) -> Linearised {
    let (m, n) = (instance.row_count(), instance.column_count());
    let x = &outcome.level;
    let (xi, eta) = units(instance);
    let mut out = Linearised {
        activity: Vec::with_capacity(m),
        row_size: Vec::with_capacity(m),
        reduced: Vec::new(),
        column_size: vec![0.0; n],
    };
    let mut reduced = vec![Sum::default(); n];
    let mut terms = vec![0.0f64; n];
    if let Some(objective) = instance.objective {
        reduced[objective.column as usize].add(1.0);
        out.column_size[objective.column as usize] = 1.0;
        terms[objective.column as usize] = 1.0;
    }
    for i in 0..m {
        let multiplier = outcome.row_marginal[i];
        let mut activity = Sum::default();
        let mut size = 0.0f64;
        for (j, a) in instance.matrix.row(i) {
            activity.add_product(a, x[j]);
            // a large coefficient of what is 0 is no size
            size = size.max((a * x[j]).abs()).max((a.abs() * xi).min(1.0));
            reduced[j].add_product(-multiplier, a);
            terms[j] = terms[j].max((a * multiplier).abs());
            let dual_size = (a * multiplier.abs().max(eta)).abs();
            out.column_size[j] = out.column_size[j].max(dual_size);
        }
        out.activity.push(activity.value());
        out.row_size.push(size);
    }
    // a rounding error of a basic column, times the way to a bound far off, is no complementarity
    let reduced = reduced.into_iter().map(Sum::value).zip(terms);
    let without_noise = |(r, largest)| if is_rounding(r, largest) { 0.0 } else { r };
    out.reduced = reduced.map(without_noise).collect();
    out
}

/// Keeps the largest value and where it was.
#[derive(Default)]
struct Worst {
    value: f64,
    place: Option<usize>,
}

impl Worst {
    fn see(&mut self, value: f64, place: usize) {
        // A NaN is the worst of all.
        if value > self.value || value.is_nan() {
            self.value = if value.is_nan() { f64::INFINITY } else { value };
            self.place = Some(place);
        }
    }
}

/// `violation / size`; a violation of 0 is 0, any other of a size 0 is infinite.
fn relative(violation: f64, size: f64) -> f64 {
    if violation == 0.0 {
        0.0
    } else {
        violation / size
    }
}

/// By how much a multiplier has the sign that a row excludes, for a minimum; not above 0 where it has the other.
fn wrong_sign(relation: Relation, multiplier: f64) -> f64 {
    match relation {
        Relation::Equal => 0.0,
        Relation::Greater => -multiplier,
        Relation::Less => multiplier,
        Relation::Free => multiplier.abs(),
    }
}

/// Violation of a row.
pub fn row_violation(relation: Relation, activity: f64, rhs: f64) -> f64 {
    match relation {
        Relation::Equal => (activity - rhs).abs(),
        Relation::Greater => (rhs - activity).max(0.0),
        Relation::Less => (activity - rhs).max(0.0),
        Relation::Free => 0.0,
    }
}

/// Primal residuals only: for any instance, given the activities and sizes of its rows.
pub fn primal(instance: &Instance, x: &[f64], activity: &[f64], row_size: &[f64]) -> Residuals {
    let (xi, _) = units(instance);
    let (mut row, mut column, mut sum) = (Worst::default(), Worst::default(), Sum::default());
    let mut relative_worst = 0.0f64;
    let mut count = 0;
    let mut judge = |violation: f64, size: f64| {
        let r = relative(violation, unit_of(size));
        relative_worst = relative_worst.max(if r.is_nan() { f64::INFINITY } else { r });
        count += usize::from(r.is_nan() || r > TOLERANCE);
    };
    for i in 0..instance.row_count() {
        let rhs = instance.rows.rhs[i];
        let v = match activity[i] {
            a if a.is_nan() => f64::INFINITY,
            a => row_violation(instance.rows.relation[i], a, rhs),
        };
        row.see(v, i);
        sum.add(v);
        judge(v, row_size[i].max(rhs.abs()));
    }
    for (j, &level) in x.iter().enumerate() {
        let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
        let v = match level {
            x if x.is_nan() => f64::INFINITY,
            x => (l - x).max(x - u).max(0.0),
        };
        column.see(v, j);
        sum.add(v);
        let bound = if level < l { l } else { u };
        judge(v, level.abs().max(bound.abs()).max(xi));
    }
    Residuals {
        primal: Some(row.value.max(column.value)),
        primal_sum: Some(sum.value()),
        worst_row: row.place.filter(|_| row.value >= column.value),
        worst_column: column.place.filter(|_| column.value > row.value),
        primal_relative: relative_worst,
        infeasible_count: count,
        ..Residuals::default()
    }
}

/// All residuals of an optimisation model, given its linearisation at the point.
pub fn residuals(instance: &Instance, outcome: &Outcome, at: &Linearised) -> Residuals {
    let mut out = primal(instance, &outcome.level, &at.activity, &at.row_size);
    let Some(objective) = instance.objective else {
        return out;
    };
    let sigma = objective.sense.sign();
    let (mut dual_row, mut dual_column) = (Worst::default(), Worst::default());
    let (mut product, mut products) = (Worst::default(), Sum::default());
    let mut dual_relative = 0.0f64;
    // The largest term of the two objectives, for judging the gap.
    let (xi, eta) = units(instance);
    let mut term = outcome.level[objective.column as usize].abs().max(xi * eta);
    let unit = largest(&outcome.row_marginal).max(eta);
    for i in 0..instance.row_count() {
        let m = outcome.row_marginal[i];
        let rhs = instance.rows.rhs[i];
        let wrong = wrong_sign(instance.rows.relation[i], sigma * m).max(0.0);
        dual_row.see(wrong, i);
        dual_relative = dual_relative.max(relative(wrong, unit));
        let slack = match instance.rows.relation[i] {
            Relation::Free => 0.0,
            _ => at.activity[i] - rhs,
        };
        let p = if m == 0.0 { 0.0 } else { m * slack };
        product.see(p.abs(), i);
        products.add(p);
        term = term.max((m * at.row_size[i].max(rhs.abs())).abs());
    }
    for (j, &r) in at.reduced.iter().enumerate() {
        let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
        let priced = sigma * r;
        let bound = if priced > 0.0 { l } else { u };
        let x = outcome.level[j];
        if bound.is_infinite() || r.is_nan() {
            dual_column.see(priced.abs(), j);
            dual_relative = dual_relative.max(relative(priced.abs(), at.column_size[j]));
        } else {
            // A reduced cost off its bound counts as complementarity, whichever bound is meant.
            let p = if r == 0.0 { 0.0 } else { r * (x - bound) };
            product.see(p.abs(), j);
            products.add(p);
        }
    }
    let gap = products.value().abs();
    out.dual = Some(dual_row.value.max(dual_column.value));
    out.worst_dual_row = dual_row
        .place
        .filter(|_| dual_row.value >= dual_column.value);
    out.worst_dual_column = dual_column
        .place
        .filter(|_| dual_column.value > dual_row.value);
    out.complementarity = Some(product.value);
    out.gap = Some(gap);
    out.dual_relative = if dual_relative.is_nan() {
        f64::INFINITY
    } else {
        dual_relative
    };
    out.gap_relative = relative(gap, term);
    if out.gap_relative.is_nan() {
        out.gap_relative = f64::INFINITY;
    }
    out
}

/// All residuals of a linear instance with an objective.
pub fn linear(instance: &Instance, outcome: &Outcome) -> Residuals {
    residuals(instance, outcome, &linearise(instance, outcome))
}

/// Residuals of a complementarity model: natural, complementarity, and the equations that are
/// matched with nothing. `at` is the instance at the levels x.
///
/// Both sides of a pair are measured, the variable in units of |x_j| and the row in units of its largest term, both by [`unit_of`]: on the
/// way to infinity, where a model without a solution leads, what is missing in a row is small beside x_j.
pub fn complementarity(instance: &Instance, x: &[f64], at: &Linearised) -> Residuals {
    let nothing = Vec::new();
    let matched = instance.matched.as_ref().unwrap_or(&nothing);
    let (mut row, mut column) = (Worst::default(), Worst::default());
    let (mut product, mut sum) = (0.0f64, Sum::default());
    let mut pairs = 0.0f64;
    let mut natural_relative = 0.0f64;
    let (mut off, mut farthest, mut count) = (Sum::default(), 0.0f64, 0);
    let mut taken = vec![false; instance.row_count()];
    let f = |i: usize| at.activity[i] - instance.rows.rhs[i];
    let mut see = |r: f64| {
        natural_relative = natural_relative.max(if r.is_nan() { f64::INFINITY } else { r });
    };
    for (j, &x) in x.iter().enumerate() {
        let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
        let partner = matched.get(j).copied().flatten().map(|i| i as usize);
        let (step, size) = match partner {
            Some(i) => {
                taken[i] = true;
                (f(i), unit_of(at.row_size[i].max(1.0)))
            }
            None => (0.0, 1.0),
        };
        let residual = |step: f64| (x - (x - step).max(l).min(u)).abs();
        let natural = residual(step);
        match partner {
            Some(i) => row.see(natural, i),
            None => column.see(natural, j),
        }
        let unit = unit_of(x.abs().max(1.0));
        see(residual(step * (unit / size)) / unit);
        let bound = if step > 0.0 { l } else { u };
        if (x - bound).abs() > TOLERANCE * unit && step.abs() > TOLERANCE * size {
            off.add(step.abs());
            farthest = farthest.max(step.abs());
            count += 1;
        }
        pairs = pairs.max(step.abs() * (x - bound).abs().min(1.0));
        if step != 0.0 && bound.is_finite() {
            let p = (step * (x - bound)).abs();
            product = product.max(p);
            sum.add(p);
        }
    }
    for i in (0..instance.row_count()).filter(|&i| !taken[i]) {
        let v = row_violation(instance.rows.relation[i], f(i), 0.0);
        row.see(v, i);
        pairs = pairs.max(v);
        let unit = unit_of(at.row_size[i].max(1.0));
        if v > TOLERANCE * unit {
            off.add(v);
            farthest = farthest.max(v);
            count += 1;
        }
        see(v / unit);
    }
    Residuals {
        natural: Some(row.value.max(column.value)),
        pairs: Some(pairs),
        complementarity: Some(product),
        complementarity_sum: Some(sum.value()),
        worst_row: row.place.filter(|_| row.value >= column.value),
        worst_column: column.place.filter(|_| column.value > row.value),
        natural_relative,
        infeasible_count: count,
        unsolved: Some((off.value(), farthest)),
        ..Residuals::default()
    }
}

/// Whether the row multipliers `y` prove that no x within bounds satisfies the rows:
/// y has the rows' signs, and yᵀa(x) < yᵀb for every x within bounds (Farkas).
/// Only for linear instances.
pub fn proves_infeasible(instance: &Instance, y: &[f64]) -> bool {
    if y.len() != instance.row_count() || y.iter().any(|v| !v.is_finite()) {
        return false;
    }
    let p = Problem::of(instance);
    let (bounds, sides) = ([&*p.lower, &*p.upper], [&*p.row_lower, &*p.row_upper]);
    form::proves_infeasible(&p.columns, bounds, sides, y, [1e-9, 1e-9])
}

/// Whether the direction `d` of the columns leads to ever better points: rows and bounds allow it
/// without end, and the objective improves. Only for linear instances.
pub fn proves_unbounded(instance: &Instance, d: &[f64]) -> bool {
    let Some(objective) = instance.objective else {
        return false;
    };
    if d.len() != instance.column_count() || d.iter().any(|v| !v.is_finite()) {
        return false;
    }
    let gain = match objective.sense {
        Sense::Minimize => -d[objective.column as usize],
        Sense::Maximize => d[objective.column as usize],
    };
    let unit = largest(d);
    if gain <= 1e-9 * unit {
        return false;
    }
    let bounded = d.iter().enumerate().any(|(j, &d)| {
        let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
        (d > 1e-9 * unit && u < INFINITE) || (d < -1e-9 * unit && l > -INFINITE)
    });
    if bounded {
        return false;
    }
    (0..instance.row_count()).all(|i| {
        let (mut change, mut size) = (Sum::default(), 0.0f64);
        for (j, a) in instance.matrix.row(i) {
            change.add_product(a, d[j]);
            size = size.max((a * d[j]).abs());
        }
        let wrong = row_violation(instance.rows.relation[i], change.value(), 0.0);
        wrong <= 1e-9 * size.max(gain)
    })
}

/// Model status of a linear program: what the point and the rays prove.
pub fn linear_status(instance: &Instance, outcome: &Outcome, r: &Residuals) -> ModelStatus {
    match outcome.claim {
        // a proof outweighs a point that is within the tolerance
        Claim::Infeasible if proves_infeasible(instance, &outcome.ray) => ModelStatus::Infeasible,
        _ if r.is_optimal(TOLERANCE) => ModelStatus::Optimal,
        Claim::Unbounded if proves_unbounded(instance, &outcome.ray) => {
            if r.is_feasible(TOLERANCE) {
                ModelStatus::Unbounded
            } else {
                ModelStatus::UnboundedNoSolution
            }
        }
        _ if r.is_feasible(TOLERANCE) => ModelStatus::Feasible,
        _ => ModelStatus::IntermediateInfeasible,
    }
}

/// Model status of a complementarity model: solved, proved infeasible, given up after all methods from all starts (as GAMS
/// calls it, locally infeasible), or stopped before.
pub fn complementarity_status(r: &Residuals, claim: Claim) -> ModelStatus {
    match claim {
        _ if r.natural_relative <= TOLERANCE => ModelStatus::Optimal,
        Claim::Infeasible => ModelStatus::Infeasible,
        Claim::LocallyInfeasible => ModelStatus::LocallyInfeasible,
        _ => ModelStatus::IntermediateInfeasible,
    }
}

/// Whether the bounds alone keep a linear row from its right-hand side.
pub fn is_beyond_bounds(instance: &Instance) -> bool {
    let nonlinear = instance.nonlinear_rows();
    (0..instance.row_count())
        .filter(|&i| !nonlinear[i])
        .any(|i| {
            let (mut low, mut high, mut size) = (0.0, 0.0, 0.0f64);
            for (j, a) in instance.matrix.row(i) {
                let ends = [instance.columns.lower[j], instance.columns.upper[j]].map(|b| a * b);
                low += ends[0].min(ends[1]);
                high += ends[0].max(ends[1]);
                for e in ends.iter().filter(|e| e.is_finite()) {
                    size = size.max(e.abs());
                }
            }
            let (relation, rhs) = (instance.rows.relation[i], instance.rows.rhs[i]);
            let nearest = rhs.max(low).min(high);
            relative(row_violation(relation, nearest, rhs), size.max(rhs.abs())) > TOLERANCE
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::outcome::SolverStatus;
    use crate::solve::dense::linear as program;

    fn outcome(level: &[f64], row_marginal: &[f64], claim: Claim, ray: &[f64]) -> Outcome {
        Outcome {
            level: level.to_vec(),
            row_marginal: row_marginal.to_vec(),
            column_marginal: vec![0.0; level.len()],
            claim,
            status: SolverStatus::NormalCompletion,
            iterations: 0,
            solver: "test",
            ray: ray.to_vec(),
            message: None,
            basis: None,
        }
    }

    /// min x + 2y, x + y >= 10, x <= 5, in units of `unit`.
    fn example(unit: f64) -> Instance {
        program(
            Sense::Minimize,
            &[1., 2.],
            &[(0., 5. * unit), (0., f64::INFINITY)],
            &[(vec![1., 1.], Relation::Greater, 10. * unit)],
        )
    }

    /// Equal rows whose multipliers cancel: beside their size any slope of the objective looks small.
    #[test]
    fn multipliers_that_cancel_hide_no_slope() {
        let row = (vec![1., 1.], Relation::Equal, 10.);
        let free = (0., f64::INFINITY);
        let instance = program(
            Sense::Minimize,
            &[1., 2.],
            &[free, free],
            &[row.clone(), row],
        );
        let mut evaluator = crate::autodiff::Evaluator::first_order(&instance);
        let mut dual = |m: [f64; 2]| {
            let (x, m) = ([3., 7., 17.], [m[0], m[1], 1.]);
            let at = nonlinear::linearise(&instance, &mut evaluator, &x, &m).expect("it is linear");
            nonlinear::residuals(&instance, &x, &m, &at).dual_relative
        };
        assert!(dual([1., 1.]) > 0.1);
        assert!(dual([5e15, -5e15]) > 0.1);
    }

    #[test]
    fn status_follows_the_point_in_any_unit() {
        for unit in [1e-9, 1e-3, 1.0, 1e6] {
            let instance = example(unit);
            let status = |x: f64, y: f64, m: f64, claim| {
                let level = [x * unit, y * unit, (x + 2.0 * y) * unit];
                let o = outcome(&level, &[m, 1.0], claim, &[]);
                linear_status(&instance, &o, &linear(&instance, &o))
            };
            use ModelStatus::{Feasible, IntermediateInfeasible, Optimal};
            assert_eq!(status(5.0, 5.0, 2.0, Claim::Solved), Optimal);
            assert_eq!(status(5.0, 5.0, 2.0, Claim::Unfinished), Optimal);
            assert_eq!(status(5.0, 5.0001, 2.0, Claim::Solved), Feasible);
            assert_eq!(status(5.0, 5.0, 2.1, Claim::Solved), Feasible);
            assert_eq!(status(5.0, 5.0, -1.0, Claim::Solved), Feasible);
            assert_eq!(
                status(5.0001, 5.0, 2.0, Claim::Solved),
                IntermediateInfeasible
            );
            assert_eq!(
                status(5.0, 4.9999, 2.0, Claim::Solved),
                IntermediateInfeasible
            );
            assert_eq!(
                status(f64::NAN, 5.0, 2.0, Claim::Solved),
                IntermediateInfeasible
            );
            assert_eq!(status(5.0, 5.0, f64::NAN, Claim::Solved), Feasible);
        }
    }

    #[test]
    fn names_the_worst_place() {
        let instance = example(1.0);
        let o = outcome(&[5.25, 5.0, 15.25], &[2.0, 1.0], Claim::Solved, &[]);
        let r = linear(&instance, &o);
        assert_eq!(r.primal, Some(0.25));
        assert_eq!((r.worst_column, r.worst_row), (Some(0), None));
        assert_eq!(r.infeasible_count, 1);
        let o = outcome(&[5.0, 4.0, 13.0], &[2.0, 1.0], Claim::Solved, &[]);
        let r = linear(&instance, &o);
        assert_eq!((r.worst_column, r.worst_row), (None, Some(0)));
        assert_eq!(r.primal_sum, Some(1.0));
        assert_eq!(r.complementarity, Some(2.0));
    }

    #[test]
    fn claims_need_proofs() {
        let mut instance = example(1.0);
        instance.columns.upper[1] = 4.0;
        let point = [5.0, 4.0, 13.0];
        let status = |ray: &[f64]| {
            let o = outcome(&point, &[0.0, 0.0], Claim::Infeasible, ray);
            linear_status(&instance, &o, &linear(&instance, &o))
        };
        assert_eq!(status(&[1.0, 0.0]), ModelStatus::Infeasible);
        assert_eq!(status(&[-1.0, 0.0]), ModelStatus::IntermediateInfeasible);
        assert_eq!(status(&[1.0, 0.1]), ModelStatus::IntermediateInfeasible);
        assert_eq!(status(&[]), ModelStatus::IntermediateInfeasible);
        assert_eq!(
            status(&[f64::NAN, 0.0]),
            ModelStatus::IntermediateInfeasible
        );

        let mut instance = example(1.0);
        instance.objective = instance
            .objective
            .map(|o| crate::model::instance::Objective {
                sense: Sense::Maximize,
                ..o
            });
        let status = |level: &[f64], ray: &[f64]| {
            let o = outcome(level, &[0.0, 1.0], Claim::Unbounded, ray);
            linear_status(&instance, &o, &linear(&instance, &o))
        };
        let point = [5.0, 5.0, 15.0];
        assert_eq!(status(&point, &[0.0, 1.0, 2.0]), ModelStatus::Unbounded);
        assert_eq!(
            status(&[0.0; 3], &[0.0, 1.0, 2.0]),
            ModelStatus::UnboundedNoSolution
        );
        assert_eq!(status(&point, &[1.0, 1.0, 3.0]), ModelStatus::Feasible);
        assert_eq!(status(&point, &[0.0, 1.0, 3.0]), ModelStatus::Feasible);
        assert_eq!(status(&point, &[0.0, -1.0, -2.0]), ModelStatus::Feasible);
    }

    #[test]
    fn natural_residual_of_pairs() {
        // F1 = x - 2 with x >= 0; F2 = y + 1 with y >= 0; F3 = w - 1 with w free.
        let mut instance = Instance {
            matched: Some(vec![Some(0), Some(1), Some(2)]),
            ..Instance::default()
        };
        let inf = f64::INFINITY;
        instance.columns = crate::solve::dense::columns(&[(0., inf), (0., inf), (-inf, inf)]);
        instance.rows.relation = vec![Relation::Greater, Relation::Greater, Relation::Equal];
        instance.rows.rhs = vec![2.0, -1.0, 1.0];
        let at = |x: &[f64]| {
            let at = Linearised {
                activity: x.to_vec(),
                row_size: x.to_vec(),
                ..Linearised::default()
            };
            complementarity(&instance, x, &at)
        };
        let r = at(&[2.0, 0.0, 1.0]);
        assert_eq!(r.natural, Some(0.0));
        assert_eq!(
            complementarity_status(&r, Claim::Solved),
            ModelStatus::Optimal
        );
        let r = at(&[2.0, 0.5, 1.0]);
        assert_eq!(r.natural, Some(0.5));
        assert_eq!(r.complementarity, Some(0.75));
        assert_eq!(r.worst_row, Some(1));
        for (claim, status) in [
            (Claim::Solved, ModelStatus::IntermediateInfeasible),
            (Claim::Infeasible, ModelStatus::Infeasible),
            (Claim::LocallyInfeasible, ModelStatus::LocallyInfeasible),
        ] {
            assert_eq!(complementarity_status(&r, claim), status);
        }
        assert_eq!(at(&[2.0, 0.0, 1.25]).natural, Some(0.25));
        assert_eq!(
            complementarity_status(&at(&[f64::NAN, 0., 1.]), Claim::Solved),
            ModelStatus::IntermediateInfeasible
        );
        // Far out a variable is no excuse for its row.
        let far = Linearised {
            activity: vec![2.0, 0.0, 2.0],
            row_size: vec![1.0; 3],
            ..Linearised::default()
        };
        let r = complementarity(&instance, &[2.0, 0.0, 1e9], &far);
        assert_eq!(r.natural_relative, 1.0);
    }
}
