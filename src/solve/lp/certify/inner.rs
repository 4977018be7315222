//! A point well inside a polyhedron.
//!
//! ```text
//!     max t,   every inequality with slack ≥ t,   t ≤ 1
//! ```
//!
//! Mixing such a point in costs the difference of the objective, so a point is sought first among
//! those whose objective is at most twice the optimal one.
//!
//! Where that gives t = 0, some inequalities hold with equality at every point. Then each has its
//! own t_i ≤ 1 and their sum is maximised (Freund, Roundy & Todd 1985): what is still without slack
//! is held as an equation.
//!
//! How much must be mixed in depends on the inequalities that do not hold yet, and those are few: a point that has
//! room in proportion to what they lack has often a thousand times as much there ([`room_for`]). It is sought first.

use super::super::barrier::Goal;
use super::super::form::Problem;
use super::super::{Ended, interior_only};
use crate::solve::Budget;

/// Slacks below this are none.
pub(super) const SLACK: f64 = 1e-7;

/// How well a point with room satisfies the equations; and it is found when no point has this part more room.
const RESIDUAL: f64 = 1e-8;
const SHORT: f64 = 0.3;

/// Twice the objective at a point, or 1 more than 0.
fn twice(poly: &Problem, near: &[f64]) -> f64 {
    let value: f64 = poly.cost.iter().zip(near).map(|(c, x)| c * x).sum();
    value + if value == 0.0 { 1.0 } else { value.abs() }
}

/// A point with room around it, as nearly as floating-point numbers go. None: none was found.
/// `near` is a point that is (nearly) optimal.
pub(super) fn point(poly: &Problem, near: &[f64], budget: &Budget) -> Option<Vec<f64>> {
    for limit in [twice(poly, near), f64::INFINITY] {
        if let Some((x, slack)) = search(poly, Room::Equal, limit, budget)
            && slack > SLACK
        {
            return Some(x);
        }
    }
    Some(search(poly, Room::Each, f64::INFINITY, budget)?.0)
}

/// A point that has the most room where `lack` (of the rows, then the columns) is largest, and a part of the way from there to a
/// `central` one, which has room everywhere.
pub(super) fn room_for(
    lack: &[f64],
    poly: &Problem,
    near: &[f64],
    central: Option<&[f64]>,
    budget: &Budget,
) -> Option<Vec<f64>> {
    let most = lack.iter().fold(0.0f64, |t, &v| t.max(v));
    if most <= 0.0 {
        return None;
    }
    let share: Vec<f64> = lack.iter().map(|v| (v / most).max(LEAST)).collect();
    let (mut x, slack) = search(poly, Room::Shares(&share), twice(poly, near), budget)?;
    let mix = |(a, b): (&mut f64, &f64)| *a += CENTRAL * (b - *a);
    if let Some(central) = central {
        x.iter_mut().zip(central).for_each(mix);
    }
    (slack > SLACK).then_some(x)
}

/// The least share of the room that [`room_for`] asks for.
const LEAST: f64 = 1e-4;

/// How much of the central point is in what [`room_for`] returns.
const CENTRAL: f64 = 0.1;

/// What is maximised.
#[derive(Clone, Copy)]
enum Room<'a> {
    /// The smallest slack.
    Equal,
    /// The sum of slacks.
    Each,
    /// The smallest slack over share.
    Shares(&'a [f64]),
}

fn search(poly: &Problem, room: Room<'_>, limit: f64, budget: &Budget) -> Option<(Vec<f64>, f64)> {
    let n = poly.n();
    let mut p = Problem {
        cost: vec![0.0; n],
        ..Problem::default()
    };
    for j in 0..n {
        let fixed = poly.lower[j] == poly.upper[j];
        let side = |b: f64, other: f64| if fixed { b } else { other };
        p.lower.push(side(poly.lower[j], f64::NEG_INFINITY));
        p.upper.push(side(poly.upper[j], f64::INFINITY));
    }
    let mut slack_columns = 0;
    let mut line = |k: usize, entries: Vec<(usize, f64)>, sides: [f64; 2], p: &mut Problem| {
        let [l, u] = sides;
        if l == u {
            p.rows.push(entries);
            p.row_lower.push(l);
            p.row_upper.push(u);
            return;
        }
        for (side, sign) in [(l, -1.0), (u, 1.0)] {
            if side.is_infinite() {
                continue;
            }
            if matches!(room, Room::Each) || slack_columns == 0 {
                p.cost.push(-1.0);
                p.lower.push(0.0);
                p.upper.push(1.0);
                slack_columns += 1;
            }
            // Between two sides there may be less than 1 to share.
            let share = (0.25 * (u - l)).min(1.0)
                * match room {
                    Room::Shares(share) => share[k],
                    _ => 1.0,
                };
            let mut e = entries.clone();
            e.push((p.cost.len() - 1, sign * share));
            p.rows.push(e);
            p.row_lower
                .push(if sign < 0.0 { l } else { f64::NEG_INFINITY });
            p.row_upper.push(if sign < 0.0 { f64::INFINITY } else { u });
        }
    };
    for i in 0..poly.m() {
        let entries = poly.rows.line(i).collect();
        line(i, entries, [poly.row_lower[i], poly.row_upper[i]], &mut p);
    }
    for j in 0..n {
        let sides = [poly.lower[j], poly.upper[j]];
        if sides[0] != sides[1] && sides.iter().any(|s| s.is_finite()) {
            line(poly.m() + j, vec![(j, 1.0)], sides, &mut p);
        }
    }
    if limit.is_finite() {
        let cost = poly.cost.iter().copied().enumerate();
        p.rows.push(cost.filter(|c| c.1 != 0.0));
        p.row_lower.push(f64::NEG_INFINITY);
        p.row_upper.push(limit);
    }
    p.columns = p.rows.transpose(p.cost.len());
    let goal = Goal {
        tolerance: RESIDUAL,
        enough: SLACK,
        share: SHORT,
    };
    let run = interior_only(&p, goal, budget);
    if run.ended != Ended::Solved {
        return None;
    }
    let least = run.point.x[n..].iter().fold(1.0f64, |t, &v| t.min(v));
    let mut x = run.point.x;
    x.truncate(n);
    Some((x, least))
}
