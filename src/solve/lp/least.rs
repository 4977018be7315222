//! The least violation of rows that contradict each other.
//!
//! ```text
//!     min  Σ p + Σ q    subject to    L ≤ A x + p − q ≤ U,   l ≤ x ≤ u,   p, q ≥ 0
//! ```
//!
//! Its solution is what a simplex method ends at that finds no feasible point, and what GAMS reports of an infeasible
//! program: levels within their bounds, and marginals that are derivatives of the sum of violations, whatever the sense of
//! the objective.

use super::form::{Form, Point, Problem, Sparse};
use super::scale::Scaling;
use super::{Accuracy, Ended, auto};
use crate::model::instance::Instance;
use crate::solve::{Budget, Outcome};

/// Replaces levels and marginals of an infeasible program by those of the least violation, if that is found.
pub fn report_least_violation(instance: &Instance, budget: &Budget, outcome: &mut Outcome) {
    let Ok(form) = Form::new(instance) else {
        return;
    };
    let elastic = elastic(&form.problem);
    let scaling = Scaling::new(&elastic);
    let scaled = scaling.apply(&elastic);
    let answer = auto(&scaled, Accuracy::Standard, budget);
    budget.spend(answer.iterations);
    outcome.iterations += answer.iterations;
    if answer.ended != Ended::Solved {
        return;
    }
    let Point { mut x, y, mut d } = scaling.restore(answer.point);
    x.truncate(form.problem.n());
    d.truncate(form.problem.n());
    d.iter_mut().for_each(|v| *v *= form.sign);
    outcome.row_marginal = form.multipliers(&y);
    let point = Point { x, y, d };
    (outcome.level, _, outcome.column_marginal) = form.point(instance, &point);
}

fn elastic(p: &Problem) -> Problem {
    let mut e = p.clone();
    e.cost.fill(0.0);
    e.offset = 0.0;
    for i in 0..p.m() {
        let sides = [(p.row_lower[i], 1.0), (p.row_upper[i], -1.0)];
        for (_, sign) in sides.into_iter().filter(|(side, _)| side.is_finite()) {
            e.columns.push([(i, sign)]);
            e.cost.push(1.0);
            e.lower.push(0.0);
            e.upper.push(f64::INFINITY);
        }
    }
    e.rows = Sparse::transpose(&e.columns, p.m());
    e
}
