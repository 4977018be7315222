//! From an interior point to a basis.
//!
//! At an optimum that is not degenerate the basic variables are those strictly between their
//! bounds. An interior point blurs that: a variable counts as basic the more, the farther it is
//! from its bounds compared with its reduced cost. The m best are offered as a basis; dependent
//! ones among them are replaced when it is factorised.

use super::form::{Point, Problem};
use super::simplex::{Basis, State};

/// A basis suggested by an interior point, and the values of all variables.
pub fn basis(p: &Problem, point: &Point) -> (Basis, Vec<f64>) {
    let (m, n) = (p.m(), p.n());
    let mut states = Vec::with_capacity(m + n);
    let mut values = Vec::with_capacity(m + n);
    let mut order: Vec<(f64, usize)> = Vec::with_capacity(m + n);
    for j in 0..n + m {
        let (l, u, x, d) = if j < n {
            (p.lower[j], p.upper[j], point.x[j], point.d[j])
        } else {
            let i = j - n;
            let activity = p.rows.line(i).map(|(k, a)| a * point.x[k]).sum::<f64>();
            (p.row_lower[i], p.row_upper[i], activity, point.y[i])
        };
        values.push(x);
        let (down, up) = (x - l, u - x);
        let (state, distance) = if l.is_infinite() && u.is_infinite() {
            (State::Free, f64::INFINITY)
        } else if down <= up {
            (State::Lower, down)
        } else {
            (State::Upper, up)
        };
        states.push(state);
        let score = if l == u {
            -f64::INFINITY
        } else {
            distance.max(1e-300) / d.abs().max(1e-300)
        };
        order.push((score, j));
    }
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    for &(_, j) in order.iter().take(m) {
        states[j] = State::Basic;
    }
    (states, values)
}
