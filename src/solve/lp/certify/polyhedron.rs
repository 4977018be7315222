//! The two sides of a linear program as polyhedra of one form, `l ≤ x ≤ u, L ≤ Ax ≤ U`.
//!
//! The dual side of `min cᵀx, L ≤ Ax ≤ U, l ≤ x ≤ u` lives in the multipliers y of the rows: y_i ≥ 0
//! without an upper side, ≤ 0 without a lower one, and d = c − Aᵀy has the sign that the bounds of
//! its column ask for: nothing where both are finite, d_j ≥ 0 without an upper bound, d_j ≤ 0
//! without a lower one, d_j = 0 without any. Its value, a lower bound of the minimum for *every*
//! such y, is Σ_i inf y_i [L_i, U_i] + Σ_j inf d_j [l_j, u_j].

use super::super::form::Problem;
use super::Enclosed;
use crate::solve::interval::{Interval, WideSum};

/// Whether a row of the dual side stands for a column.
pub(super) fn is_priced(p: &Problem, j: usize) -> bool {
    p.lower[j].is_infinite() || p.upper[j].is_infinite()
}

/// The feasible multipliers of a program; their cost is −b as far as that is linear, for choosing a point that costs little.
pub(super) fn dual(p: &Problem) -> Problem {
    let side = |finite: bool, value: f64| if finite { 0.0 } else { value };
    let mut d = Problem::default();
    for i in 0..p.m() {
        let (l, u) = (p.row_lower[i].is_finite(), p.row_upper[i].is_finite());
        let (low, high) = (p.row_lower[i], p.row_upper[i]);
        d.cost.push(match (l, u) {
            (true, true) if low < high => 0.0,
            (true, _) => -low,
            (_, true) => -high,
            _ => 0.0,
        });
        // Only the side that is there may be priced.
        d.lower.push(side(!u && l, f64::NEG_INFINITY));
        d.upper.push(side(!l && u, f64::INFINITY));
        if !l && !u {
            d.lower[i] = 0.0;
            d.upper[i] = 0.0;
        }
    }
    for j in 0..p.n() {
        let (l, u) = (p.lower[j].is_finite(), p.upper[j].is_finite());
        if !is_priced(p, j) {
            continue;
        }
        d.row_lower
            .push(if l { f64::NEG_INFINITY } else { p.cost[j] });
        d.row_upper.push(if u { f64::INFINITY } else { p.cost[j] });
        d.rows.push(p.columns.line(j));
    }
    d.columns = d.rows.transpose(p.m());
    d
}

/// cᵀx over the enclosed point: an upper bound of the minimum is its upper end.
pub(super) fn primal_value(p: &Problem, x: &Enclosed) -> Interval {
    let mut sum = WideSum::default();
    for j in 0..p.n() {
        x.add_to(&mut sum, p.cost[j], j);
    }
    sum.value()
}

/// The dual value at the enclosed multipliers: a lower bound of the minimum is its lower end.
pub(super) fn dual_value(p: &Problem, y: &Enclosed) -> Interval {
    let mut sum = WideSum::default();
    for i in 0..p.m() {
        let (l, u) = (p.row_lower[i], p.row_upper[i]);
        if l == u || l.is_infinite() || u.is_infinite() {
            let side = if l.is_finite() { l } else { u };
            if side.is_finite() {
                y.add_to(&mut sum, side, i);
            }
        } else {
            let sides = Interval { low: l, high: u };
            sum.add_interval(Interval::point((y.value(i) * sides).low));
        }
    }
    for j in 0..p.n() {
        let (l, u) = (p.lower[j], p.upper[j]);
        if l.is_infinite() && u.is_infinite() {
            // d_j = 0 was proved.
            continue;
        }
        let mut d = WideSum::new(p.cost[j]);
        for (i, a) in p.columns.line(j) {
            y.add_to(&mut d, -a, i);
        }
        let d = d.value();
        // The sign of d_j is proved where a bound is missing: the other one counts.
        let priced = match (l.is_finite(), u.is_finite()) {
            (true, true) => Interval::point((d * Interval { low: l, high: u }).low),
            (true, false) => d * l,
            _ => d * u,
        };
        sum.add_interval(Interval::point(priced.low));
    }
    sum.value()
}
