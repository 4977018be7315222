//! Linear programs: form, scaling, interior point, and the way back.
//!
//! [`Form`] takes an instance apart, [`Scaling`] changes the units, Clarabel finds the optimum,
//! and the point returns the same way. See the modules for the mathematics.

pub mod form;
pub mod interior;
pub mod scale;

use std::time::Instant;

use super::{Claim, Monitor, Outcome, Settings, SolveError, Solver, SolverStatus};
use crate::model::instance::Instance;
use form::{Form, Point, Problem};
use scale::Scaling;

/// How a method ended, in the units of the problem it was given.
#[derive(Clone, Debug, PartialEq)]
pub enum Ended {
    /// Solved to its tolerance.
    Solved,
    /// Infeasible; multipliers y of the rows with yᵀAx > sup over all x within bounds.
    Infeasible(Vec<f64>),
    /// Unbounded; a direction of the columns.
    Unbounded(Vec<f64>),
    /// Iteration limit.
    Iterations,
    /// Time limit.
    Time,
    /// The person asked to stop.
    Interrupted,
    /// Numerical trouble.
    Failed,
}

/// Limits of a method.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// When the solve began.
    pub start: Instant,
    /// Seconds from then on.
    pub seconds: f64,
    /// Iterations.
    pub iterations: u64,
}

impl Limits {
    /// Seconds left.
    pub fn seconds_left(&self) -> f64 {
        (self.seconds - self.start.elapsed().as_secs_f64()).max(0.0)
    }
}

/// The solver of linear programs, `option lp = clarabel`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clarabel;

impl Solver for Clarabel {
    fn name(&self) -> &'static str {
        "clarabel"
    }

    fn solve(
        &self,
        instance: &Instance,
        settings: &Settings,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, SolveError> {
        if !instance.is_linear() {
            return Err(SolveError {
                message: "the model has nonlinear terms; this solver takes linear models".into(),
                row: None,
                column: None,
            });
        }
        let limits = Limits {
            start: Instant::now(),
            seconds: settings.time_limit,
            iterations: settings.iteration_limit,
        };
        let form = Form::new(instance)?;
        let scaling = Scaling::new(&form.problem);
        let scaled = scaling.apply(&form.problem);
        let run = match trivial(&scaled) {
            Some(run) => run,
            None => interior::solve(&scaled, 1e-10, &limits, &mut || monitor.interrupted()),
        };
        let (claim, status) = match run.ended {
            Ended::Solved if run.almost => (Claim::Unfinished, SolverStatus::TerminatedBySolver),
            Ended::Solved => (Claim::Solved, SolverStatus::NormalCompletion),
            Ended::Infeasible(_) => (Claim::Infeasible, SolverStatus::NormalCompletion),
            Ended::Unbounded(_) => (Claim::Unbounded, SolverStatus::NormalCompletion),
            Ended::Iterations => (Claim::Unfinished, SolverStatus::IterationInterrupt),
            Ended::Time => (Claim::Unfinished, SolverStatus::ResourceInterrupt),
            Ended::Interrupted => (Claim::Unfinished, SolverStatus::UserInterrupt),
            Ended::Failed => (Claim::Unfinished, SolverStatus::TerminatedBySolver),
        };
        let ray = match run.ended {
            Ended::Infeasible(mut y) => {
                scaling.restore_multipliers(&mut y);
                form.multipliers(&y)
            }
            Ended::Unbounded(mut x) => {
                scaling.restore_direction(&mut x);
                form.direction(instance, &x)
            }
            _ => Vec::new(),
        };
        let point = scaling.restore(run.point);
        let (level, row_marginal, column_marginal) = form.point(instance, &point);
        Ok(Outcome {
            level,
            row_marginal,
            column_marginal,
            claim,
            status,
            iterations: run.iterations,
            solver: "clarabel",
            ray,
            message: None,
        })
    }
}

/// Problems without a free column or without a constraint, which Clarabel does not take.
fn trivial(p: &Problem) -> Option<interior::Run> {
    let all_fixed = (0..p.n()).all(|j| p.lower[j] == p.upper[j]);
    let unconstrained =
        p.m() == 0 && (0..p.n()).all(|j| p.lower[j].is_infinite() && p.upper[j].is_infinite());
    if !all_fixed && !unconstrained {
        return None;
    }
    let x: Vec<f64> = p
        .lower
        .iter()
        .map(|&l| if l.is_finite() { l } else { 0.0 })
        .collect();
    let mut ended = Ended::Solved;
    for i in 0..p.m() {
        let terms = p.rows.line(i).map(|(j, a)| a * x[j]);
        let (value, size) = terms.fold((0.0, 1.0), |(v, s): (f64, f64), t| (v + t, s + t.abs()));
        let mut y = vec![0.0; p.m()];
        if value < p.row_lower[i] - 1e-9 * size {
            y[i] = 1.0;
            ended = Ended::Infeasible(y);
        } else if value > p.row_upper[i] + 1e-9 * size {
            y[i] = -1.0;
            ended = Ended::Infeasible(y);
        }
    }
    if ended == Ended::Solved && !all_fixed && p.cost.iter().any(|&c| c != 0.0) {
        ended = Ended::Unbounded(p.cost.iter().map(|&c| -c).collect());
    }
    let point = Point {
        x,
        y: vec![0.0; p.m()],
        d: p.cost.clone(),
    };
    Some(interior::Run {
        point,
        ended,
        iterations: 0,
        almost: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::conformance;

    #[test]
    fn interior_point_conforms() {
        conformance::suite(&Clarabel, 2e-7);
    }
}
