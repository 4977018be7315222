//! Weak duality with directed rounding: what multipliers prove, whatever they are.
//!
//! For every y, with d = c − Aᵀy,
//!
//! ```text
//!     cᵀx ≥ Σ_i inf y_i [L_i, U_i] + Σ_j inf d_j [l_j, u_j]      for all feasible x .
//! ```
//!
//! No solver's word is needed: y may come from anywhere. Where a column has no bound on the side
//! that the sign of d_j asks for, rounding alone makes the sum −∞; so bounds are derived for such
//! columns first ([`derive`]).
//!
//! Source: Neumaier & Shcherbina (2004).

use crate::solve::interval::{Interval, WideSum};
use crate::solve::lp::Ended;
use crate::solve::lp::form::{Problem, Sparse};
use crate::solve::lp::simplex::Simplex;

/// A lower bound of costᵀx over the rows and bounds of a problem.
pub(crate) fn bound(p: &Problem, cost: &[f64], y: &[f64]) -> f64 {
    let none = f64::NEG_INFINITY;
    let mut sum = WideSum::default();
    let mut used = y.to_vec();
    for (i, y) in used.iter_mut().enumerate() {
        let side = p.priced_side(i, *y);
        // A multiplier without a side to price is left out.
        if side.is_finite() {
            sum.add_product(*y, side);
        } else {
            *y = 0.0;
        }
    }
    for (j, &c) in cost.iter().enumerate() {
        let mut d = WideSum::new(c);
        for (i, a) in p.columns.line(j) {
            d.add_product(-a, used[i]);
        }
        let d = d.value();
        let (l, u) = (p.lower[j], p.upper[j]);
        if (d.low < 0.0 && u.is_infinite()) || (d.high > 0.0 && l.is_infinite()) {
            return none;
        }
        // Where d has one sign, the other bound may be infinite.
        let at = |d: f64, b: f64| (Interval::point(d) * b).low;
        let low = match (d.low < 0.0, d.high > 0.0) {
            (false, false) => 0.0,
            (true, false) => at(d.low, u).min(at(d.high, u)),
            (false, true) => at(d.low, l).min(at(d.high, l)),
            (true, true) => at(d.low, u).min(at(d.high, l)),
        };
        sum.add_interval(Interval::point(low));
    }
    let low = sum.value().low;
    if low.is_nan() { none } else { low }
}

/// The program that asks by how much rows must be relaxed to have a point within the bounds: min t.
pub(crate) fn elastic(p: &Problem) -> Problem {
    let n = p.n();
    let mut q = Problem {
        cost: vec![0.0; n],
        lower: p.lower.clone(),
        upper: p.upper.clone(),
        ..Problem::default()
    };
    q.cost.push(1.0);
    q.lower.push(0.0);
    q.upper.push(f64::INFINITY);
    for i in 0..p.m() {
        let sides = [(p.row_lower[i], 1.0), (p.row_upper[i], -1.0)];
        for (side, sign) in sides.into_iter().filter(|s| s.0.is_finite()) {
            q.rows
                .push(p.rows.line(i).chain([(n, sign)]).collect::<Vec<_>>());
            let inf = f64::INFINITY;
            q.row_lower.push(if sign > 0.0 { side } else { -inf });
            q.row_upper.push(if sign > 0.0 { inf } else { side });
        }
    }
    q.columns = q.rows.transpose(n + 1);
    q
}

/// Whether multipliers prove that there is no feasible point.
pub(crate) fn is_empty(p: &Problem, y: &[f64]) -> bool {
    bound(p, &vec![0.0; p.n()], y) > 0.0
}

/// Gives columns without a bound one where linear programs prove it: for solutions with costᵀx ≤ `cutoff`,
/// and if `known` is one of them.
///
/// The largest value of each such column is computed, and twice that (and a little more) is tried as
/// its bound. Within the box of all bounds tried, multipliers prove that no column comes near them.
/// The feasible set is convex and has a point in the box; had it a point outside, it would have one on
/// the box's boundary too. So all of it is inside, and the bounds are proved.
pub(crate) fn derive(
    p: &mut Problem,
    cutoff: f64,
    known: &[f64],
    stop: &mut dyn FnMut(u64) -> Option<Ended>,
) -> u64 {
    let mut rows = Sparse::default();
    (0..p.m()).for_each(|i| rows.push(p.rows.line(i).collect::<Vec<_>>()));
    let costs = p.cost.iter().copied().enumerate();
    rows.push(costs.filter(|c| c.1 != 0.0));
    let mut q = Problem {
        rows,
        cost: vec![0.0; p.n()],
        ..p.clone()
    };
    q.row_lower.push(f64::NEG_INFINITY);
    q.row_upper.push(cutoff - p.offset);
    q.columns = q.rows.transpose(p.n());
    let mut simplex = Simplex::new(&q);
    let mut tried: Vec<(usize, f64, Vec<f64>)> = Vec::new();
    for j in 0..p.n() {
        for (open, sign) in [
            (p.lower[j].is_infinite(), 1.0),
            (p.upper[j].is_infinite(), -1.0),
        ] {
            if !open {
                continue;
            }
            simplex.set_cost(j, sign);
            let ended = simplex.solve(stop);
            let point = simplex.point();
            simplex.set_cost(j, 0.0);
            match (ended, point) {
                (Ended::Solved, Some(point)) => {
                    let reach = point.x[j].abs().max(known[j].abs());
                    let bound = -sign * (2.0 * reach + 1.0);
                    let side = if sign > 0.0 {
                        &mut q.lower
                    } else {
                        &mut q.upper
                    };
                    side[j] = bound;
                    tried.push((j, sign, point.y));
                }
                (Ended::Time | Ended::Interrupted, _) => return simplex.iterations,
                _ => {}
            }
        }
    }
    let inside = |(j, sign, y): &(usize, f64, Vec<f64>)| {
        let mut cost = vec![0.0; q.n()];
        cost[*j] = *sign;
        let side = if *sign > 0.0 {
            -q.lower[*j]
        } else {
            q.upper[*j]
        };
        // bound ≤ sign·x_j
        bound(&q, &cost, y) > -side
    };
    if tried.iter().all(inside) {
        p.lower = q.lower;
        p.upper = q.upper;
    }
    simplex.iterations
}
