//! A rigorous interval for the optimal value of a linear program.
//!
//! A point that satisfies all rows and bounds *exactly* gives an upper bound of the minimum,
//! multipliers that satisfy the dual ones exactly give a lower bound; on a block wall these are the
//! kinematic and the static theorem. Both are points of polyhedra ([`polyhedron`]) and both are
//! found in the same way:
//!
//! 1. take the solver's point x*, and a point x⁰ with room around it ([`inner`]);
//! 2. mix, x = x* + θ(x⁰ − x*), with θ as small as possible: the inequalities get room;
//! 3. move some columns a little so that the equations hold exactly ([`system`]): how far they
//!    move is proved, not known to the last bit;
//! 4. check every bound and every inequality with intervals ([`crate::solve::interval`]).
//!
//! The program is the instance as its numbers are stored. No floating-point result is trusted on
//! the way: a wrong x* or x⁰ makes the interval wide, or there is none. Where a program has no room
//! (its points, or its multipliers, lie on a plane that rounding leaves), and the program is small,
//! its optimal basis is solved in rational arithmetic instead ([`exact`]).
//!
//! Source: Neumaier & Shcherbina (2004), Jansson (2004); the mixing for walls: the bound theorems
//! of plasticity.

mod exact;
mod inner;
mod polyhedron;
mod system;

use super::crossover;
use super::form::{Form, Point, Problem};
use super::scale::Scaling;
use super::simplex::{Simplex, State, Wide};
use super::{Ended, SolveError, watch};
use crate::model::instance::Instance;
use crate::solve::interval::{Interval, WideSum, two_sum};
use crate::solve::{Budget, Limits, Outcome, Quiet};
use system::System;

/// Why a bound was not proved.
#[derive(Clone, Debug, PartialEq)]
pub struct Unproved {
    /// In the reader's terms; `row` or `column` is named after it.
    pub why: &'static str,
    /// The row to name.
    pub row: Option<usize>,
    /// The column to name.
    pub column: Option<usize>,
}

impl Unproved {
    /// Without a row or column to name.
    pub(in crate::solve) fn new(why: &'static str) -> Self {
        Self {
            why,
            row: None,
            column: None,
        }
    }
}

/// What could be proved about the optimal value of an instance: it is not below `low` and not above
/// `high`.
#[derive(Clone, Debug, PartialEq)]
pub struct Proof {
    /// Lower bound, −∞ if none was proved.
    pub low: f64,
    /// Upper bound, +∞ if none was proved.
    pub high: f64,
    /// Why there is no lower bound.
    pub no_low: Option<Unproved>,
    /// Why there is no upper bound.
    pub no_high: Option<Unproved>,
}

/// A point that is known up to a radius per column, as pairs `high + low`.
pub struct Enclosed {
    high: Vec<f64>,
    low: Vec<f64>,
    radius: Vec<f64>,
    /// What each row must be, if it is one of the equations.
    target: Vec<f64>,
}

impl Enclosed {
    /// Where column j is.
    fn value(&self, j: usize) -> Interval {
        let rest = Interval::point(self.low[j]) + Interval::around_zero(self.radius[j]);
        Interval::point(self.high[j]) + rest
    }

    /// Adds a · x_j to a sum.
    fn add_to(&self, sum: &mut WideSum, a: f64, j: usize) {
        sum.add_product(a, self.high[j]);
        if self.low[j] != 0.0 {
            sum.add_product(a, self.low[j]);
        }
        if self.radius[j] != 0.0 {
            sum.add_interval(Interval::around_zero(self.radius[j]) * a);
        }
    }
}

/// Columns and rows together up to which exact arithmetic is tried first.
const MAX_EXACT_SIZE: usize = 120;

/// Proves what it can about the optimal value of a linear instance, near an outcome.
pub fn certify(
    instance: &Instance,
    outcome: &Outcome,
    budget: &Budget,
) -> Result<Proof, SolveError> {
    certify_by(instance, outcome, budget, true)
}

/// A lower bound of a small program in rational arithmetic, without its offset; −∞ if none was proved.
pub fn exact_low(p: &Problem) -> f64 {
    let mut quiet = Quiet::default();
    let budget = Budget::new(&mut quiet, Limits::default(), false);
    let small = p.m() + p.n() <= MAX_EXACT_SIZE;
    let value = small.then(|| exact::value(p, 2_000_000, &budget));
    let value = value.flatten().and_then(|v| v.lower.ok());
    value.map_or(f64::NEG_INFINITY, |v| v.low)
}

/// The same, with or without exact arithmetic.
pub(super) fn certify_by(
    instance: &Instance,
    outcome: &Outcome,
    budget: &Budget,
    by_basis: bool,
) -> Result<Proof, SolveError> {
    let form = Form::exact(instance)?;
    let scaling = Scaling::new(&form.problem);
    let p = scaling.apply(&form.problem);
    let (mut upper, mut lower) = (Err(Unproved::new("")), Err(Unproved::new("")));
    if !scaling.is_exact(&form.problem, &p) {
        let extreme =
            Unproved::new("the coefficients are so extreme that they cannot be scaled exactly");
        (upper, lower) = (Err(extreme.clone()), Err(extreme));
    } else {
        let small = p.m() + p.n() <= MAX_EXACT_SIZE;
        if by_basis
            && small
            && let Some(value) = exact::value(&p, 2_000_000, budget)
        {
            (upper, lower) = (value.upper, value.lower);
        }
        let near = scaling.carry(form.near(outcome));
        let length = instance.column_count() + instance.row_count();
        let basis = outcome.basis.as_deref().filter(|b| b.len() == length);
        let basis = basis.map(|b| form.basis(b));
        let [x, y] = vertex(&p, near, basis.as_deref(), budget);
        if upper.is_err() {
            upper = side(&p, &p, x, budget, true);
        }
        if lower.is_err() {
            lower = side(&p, &polyhedron::dual(&p), y, budget, false);
        }
        let missing = upper.is_err() || lower.is_err();
        if missing
            && by_basis
            && !small
            && let Some(value) = exact::value(&p, 200_000_000, budget)
        {
            upper = upper.or(value.upper);
            lower = lower.or(value.lower);
        }
    }
    // In the units of the instance: the factors are powers of two.
    let unit = scaling.price * scaling.size;
    let place = |v: Interval| {
        let v = (v * unit + Interval::point(form.problem.offset)) * form.sign;
        [v.low, v.high]
    };
    let name = |u: Unproved| Unproved {
        row: u.row.map(|i| form.rows[i] as usize),
        column: u.column.map(|j| form.columns[j] as usize),
        ..u
    };
    let mut proof = Proof {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
        no_low: None,
        no_high: None,
    };
    let minimise = form.sign > 0.0;
    match upper {
        Ok(v) if minimise => proof.high = place(v)[1],
        Ok(v) => proof.low = place(v)[0],
        Err(u) if minimise => proof.no_high = Some(name(u)),
        Err(u) => proof.no_low = Some(name(u)),
    }
    match lower {
        Ok(v) if minimise => proof.low = place(v)[0],
        Ok(v) => proof.high = place(v)[1],
        Err(u) if minimise => proof.no_low = Some(name(u)),
        Err(u) => proof.no_high = Some(name(u)),
    }
    Ok(proof)
}

/// The vertex at a point (if there are several optimal ones, a vertex of the same value), to nearly
/// twice the working precision: what rounding violates is not in the way then. The point itself
/// where none is found.
fn vertex(p: &Problem, near: Point, basis: Option<&[State]>, budget: &Budget) -> [Wide; 2] {
    let mut simplex = Simplex::new(p);
    // A few pivots settle which of the columns at 0 are basic.
    let most = (p.m() + p.n()) as u64;
    match basis {
        Some(basis) => simplex.set_basis(basis),
        None => {
            let start = crossover::start(p, &near, None);
            let _ = simplex.push(&start, &mut watch(budget, most));
        }
    }
    let solved = simplex.solve(&mut watch(budget, most)) == Ended::Solved;
    if solved {
        // Down to (1e-14, 1e-13) the interval of a wall of 40 courses is 2e-10 wide, not 9e-10, after a hundred times the pivots.
        let tolerances = [(1e-11, 1e-11), (1e-13, 1e-12)];
        simplex.tighten_to(&tolerances, &mut watch(budget, most));
    }
    let wide = simplex.wide_point().filter(|_| solved);
    budget.log(format!("vertex: {} pivots", simplex.iterations));
    wide.unwrap_or_else(|| {
        [near.x, near.y].map(|v| {
            let zero = vec![0.0; v.len()];
            (v, zero)
        })
    })
}

/// A point near `near` that is proved to be in the polyhedron, and its value: with the equations that are written as such,
/// and where inequalities have no room, with those held that have none at a central point.
fn side(
    p: &Problem,
    poly: &Problem,
    near: Wide,
    budget: &Budget,
    primal: bool,
) -> Result<Interval, Unproved> {
    let fail = |why, row: Option<usize>, column: Option<usize>| {
        // A row of the dual side stands for a column, and the other way round.
        let mut priced = (0..p.n()).filter(|&j| polyhedron::is_priced(p, j));
        let (row, column) = match primal {
            true => (row, column),
            false => (column, row.and_then(|i| priced.nth(i))),
        };
        Err(Unproved { why, row, column })
    };
    let value = |x: &Enclosed| match primal {
        true => polyhedron::primal_value(p, x),
        false => polyhedron::dual_value(p, x),
    };
    if let Ok(value) = mixed(poly, near.clone(), None, &value, budget) {
        return Ok(value);
    }
    let Some(inner) = inner::point(poly, &near.0, budget) else {
        let why = match primal {
            true => "no point with room inside the rows and bounds was found",
            false => "no multipliers with room inside their bounds were found",
        };
        return fail(why, None, None);
    };
    mixed(poly, near, Some(inner), &value, budget).or_else(|missed| match missed {
        Missed::Dependent(row) => fail(
            "an equation depends on others: rounding decides whether it holds",
            Some(row),
            None,
        ),
        Missed::Numbers => fail("the equations could not be solved reliably", None, None),
        Missed::Lack(lack) => {
            let worst = (0..lack.len()).max_by(|&a, &b| lack[a].total_cmp(&lack[b]));
            let row = worst.filter(|&k| k < poly.m());
            let column = worst.and_then(|k| k.checked_sub(poly.m()));
            fail("rounding decides whether it holds", row, column)
        }
    })
}

/// Why no point was proved.
enum Missed {
    /// This equation depends on others.
    Dependent(usize),
    /// The equations could not be solved.
    Numbers,
    /// What the rows, then the columns, lack.
    Lack(Vec<f64>),
}

/// The value of a point between `near` and one with room. What has no room at `inner` is held.
fn mixed(
    poly: &Problem,
    (mut near, mut near_low): Wide,
    mut inner: Option<Vec<f64>>,
    value: &dyn Fn(&Enclosed) -> Interval,
    budget: &Budget,
) -> Result<Interval, Missed> {
    let others = inner.as_deref_mut().unwrap_or_default();
    let free = hold(poly, &mut near, &mut near_low, others);
    let (equations, target, unit) = equations(poly, &near, inner.as_deref());
    let mut stop = || budget.is_over();
    let system = System::new(poly, equations, &free, unit, &mut stop);
    let mut system = system.map_err(|row| row.map_or(Missed::Numbers, Missed::Dependent))?;
    budget.log(format!(
        "{} equations verified after {:.2} s",
        system.rows().len(),
        budget.seconds()
    ));
    let mut at = |inner: &[f64], theta: f64| {
        let mut x = Enclosed {
            high: Vec::with_capacity(poly.n()),
            low: Vec::with_capacity(poly.n()),
            radius: vec![0.0; poly.n()],
            target: target.clone(),
        };
        for ((&a, &a_low), &b) in near.iter().zip(&near_low).zip(inner) {
            let (high, low) = two_sum(a, theta * (b - a));
            let (high, low) = two_sum(high, low + a_low);
            x.high.push(high);
            x.low.push(low);
        }
        system.enclose(poly, &mut x).ok_or(Missed::Numbers)?;
        let lack = lack(poly, &x, &system);
        match lack.iter().all(|&v| v == 0.0) {
            true => Ok(value(&x)),
            false => Err(Missed::Lack(lack)),
        }
    };
    let lack = match at(&near, 0.0) {
        Err(Missed::Lack(lack)) => lack,
        other => return other,
    };
    let roomy = inner::room_for(&lack, poly, &near, inner.as_deref(), budget);
    let mut missed = Missed::Lack(lack.clone());
    for inner in [roomy, inner].into_iter().flatten() {
        let mut share = expected(&lack, poly, &inner);
        while share <= 1.0 {
            match at(&inner, share) {
                Ok(value) => return Ok(value),
                Err(now) => missed = now,
            }
            share *= 4.0;
        }
    }
    Err(missed)
}

/// The share of an inner point that gives what is lacking, as far as its room goes, and little more.
fn expected(lack: &[f64], poly: &Problem, inner: &[f64]) -> f64 {
    let rows = (0..poly.m()).map(|i| poly.activity(i, inner));
    let sides = poly.row_lower.iter().zip(&poly.row_upper);
    let sides = sides.chain(poly.lower.iter().zip(&poly.upper));
    let places = rows.chain(inner.iter().copied()).zip(sides).zip(lack);
    let share = places.filter(|e| *e.1 > 0.0).map(|((v, (l, u)), lack)| {
        let room = (v - l).min(u - v).max(inner::SLACK);
        lack / (lack + room)
    });
    1.001 * share.fold(f64::MIN_POSITIVE, f64::max)
}

/// Room of a variable or row between its sides, at two points.
fn room([l, u]: [f64; 2], [a, b]: [f64; 2]) -> f64 {
    (a - l).min(u - a).max((b - l).min(u - b))
}

/// Whether each variable may move; those without room are put to their bound in both points.
fn hold(poly: &Problem, near: &mut [f64], near_low: &mut [f64], inner: &mut [f64]) -> Vec<bool> {
    let sides = poly.lower.iter().zip(&poly.upper).enumerate();
    let moves = |(j, (&l, &u)): (usize, (&f64, &f64))| {
        let has_room = |inner: &f64| room([l, u], [near[j], *inner]) > inner::SLACK;
        if l != u && inner.get(j).is_none_or(has_room) {
            return true;
        }
        let at = if near[j] - l <= u - near[j] { l } else { u };
        (near[j], near_low[j]) = (at, 0.0);
        inner.get_mut(j).into_iter().for_each(|v| *v = at);
        false
    };
    sides.map(moves).collect()
}

/// The rows that are equations or have no room; the value of each row that is to be met; and the size of their terms.
fn equations(
    poly: &Problem,
    near: &[f64],
    inner: Option<&[f64]>,
) -> (Vec<usize>, Vec<f64>, Vec<f64>) {
    let (mut equations, mut unit) = (Vec::new(), Vec::new());
    let mut target = vec![0.0; poly.m()];
    for (i, target) in target.iter_mut().enumerate() {
        let (l, u) = (poly.row_lower[i], poly.row_upper[i]);
        let a = poly.activity(i, near);
        let tight = |inner| room([l, u], [a, poly.activity(i, inner)]) <= inner::SLACK;
        if l == u || inner.is_some_and(tight) {
            *target = if a - l <= u - a { l } else { u };
            equations.push(i);
            let terms = poly.rows.line(i).map(|(j, v)| (v * near[j]).abs());
            unit.push(terms.fold(target.abs().max(1e-3), f64::max));
        }
    }
    (equations, target, unit)
}

/// By how much each row, then each column, of the enclosed point may be outside its sides.
fn lack(poly: &Problem, x: &Enclosed, system: &System) -> Vec<f64> {
    // What is not a number proves nothing.
    let beyond = |low: f64, high: f64| match (low.is_nan(), high.is_nan()) {
        (false, false) => low.max(high).max(0.0),
        _ => f64::INFINITY,
    };
    let mut lack = vec![0.0; poly.m()];
    let mut solved = vec![false; poly.m()];
    system.rows().iter().for_each(|&i| solved[i] = true);
    for i in (0..poly.m()).filter(|&i| !solved[i]) {
        let mut sum = WideSum::default();
        for (j, a) in poly.rows.line(i) {
            x.add_to(&mut sum, a, j);
        }
        let rest = |side: f64| {
            let mut rest = sum;
            rest.add(-side);
            rest.value()
        };
        let (l, u) = (poly.row_lower[i], poly.row_upper[i]);
        let low = if l.is_finite() { -rest(l).low } else { 0.0 };
        let high = if u.is_finite() { rest(u).high } else { 0.0 };
        lack[i] = beyond(low, high);
    }
    lack.extend((0..poly.n()).map(|j| {
        let v = x.value(j);
        beyond(poly.lower[j] - v.low, v.high - poly.upper[j])
    }));
    lack
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::instance::{Relation, Sense};
    use crate::model::problem_type::ProblemType;
    use crate::solve::Settings;
    use crate::solve::backend::{Backend, Task};
    use crate::solve::dense::linear;
    use crate::solve::lp::Clarabel;

    #[test]
    fn intervals_hold_where_data_are_no_fractions_of_two() {
        // max x + y, 3x + y <= 1, x + 3y <= 1: 1/2, were 1/10 of it all not rounded.
        let rows = [
            (vec![0.3, 0.1], Relation::Less, 0.1),
            (vec![0.1, 0.3], Relation::Less, 0.1),
        ];
        let instance = linear(Sense::Maximize, &[1., 1.], &[(0., f64::INFINITY); 2], &rows);
        let mut quiet = Quiet::default();
        let budget = Budget::unlimited(&mut quiet);
        let task = Task::new(ProblemType::Lp, &instance);
        let reply = Clarabel.solve(&task, &Settings::default(), &budget);
        let p = certify(&instance, &reply.expect("linear").outcome, &budget).expect("linear");
        assert!(p.low <= p.high && p.high - p.low < 1e-15 && (p.low - 0.5).abs() < 1e-15);
    }
}
