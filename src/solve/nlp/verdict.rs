//! What is known in the end.

use super::driver::Driver;
use super::interior_point::{Ended, lock};
use super::relaxation;
use super::trial::Trial;
use crate::autodiff::{Degree, Evaluator};
use crate::model::instance::Instance;
use crate::solve::certificate::nonlinear::{is_locally_infeasible, violations};
use crate::solve::{Claim, Outcome, SolverStatus, Stop, Strategy};

impl Driver<'_, '_> {
    /// Whether it is certain that there is no feasible point; asked where none was found.
    pub(super) fn is_impossible(&mut self) -> bool {
        let lacks_point = !self.best.as_ref().is_some_and(Trial::is_feasible);
        self.impossible = lacks_point
            && !self.is_stopped()
            && self.settings.runs(Strategy::IntervalProof)
            && relaxation::is_infeasible(self.instance, self.budget);
        self.impossible
    }

    /// The best trial, and what is claimed of it.
    pub(super) fn finish(&mut self) -> Outcome {
        let lacks_optimum = !self.best.as_ref().is_some_and(Trial::is_optimal);
        if self.best.is_none() || lacks_optimum && self.is_stopped() {
            // what was stopped may have left a feasible point for worse ones
            let m = lock(&self.problem).size().1;
            let seen = lock(&self.problem).best_seen.take().map(|b| b.1);
            for x in [Some(self.start.clone()), seen].into_iter().flatten() {
                let trial = self.judge(x, vec![0.0; m], Ended::Broken);
                self.keep(trial);
            }
        }
        let best = self.best.take().expect("a point was kept");
        let unbounded = self.is_unbounded(&best);
        let mut problem = lock(&self.problem);
        let affine = is_affine(self.instance, &mut problem.evaluator);
        let mut proved = |t: &Trial, y: &[f64]| {
            is_locally_infeasible(self.instance, &mut problem.evaluator, &t.level, y, 1e-4)
        };
        let mut best = best;
        let mut ray = Vec::new();
        let claim = if best.is_optimal() && self.at_saddle {
            Claim::Unfinished
        } else if best.irregular {
            Claim::WithoutMultipliers
        } else if best.is_optimal() {
            match self.is_convex || affine {
                true => Claim::Solved,
                false => Claim::LocallySolved,
            }
        } else if unbounded {
            Claim::Unbounded
        } else if best.is_feasible() {
            Claim::Unfinished
        } else if self.impossible {
            Claim::Infeasible
        } else if self.is_stopped() {
            // further attempts would have begun elsewhere
            Claim::Unfinished
        } else {
            let violations = violations(self.instance, &best.at.activity);
            let all = self.infeasibility.take().into_iter();
            match all
                .chain([(best.clone(), violations)])
                .find(|(t, y)| proved(t, y))
            {
                Some((t, y)) => {
                    (best, ray) = (t, y);
                    Claim::LocallyInfeasible
                }
                None => Claim::Unfinished,
            }
        };
        let solver_status = match (claim, self.budget.stopped().map(Stop::status)) {
            (Claim::Unfinished, Some(s)) => s,
            (Claim::Unfinished, None) => match best.ended {
                // the limit was the user's, not that of an attempt
                Ended::Iterations if self.settings.option("max_iter").is_some() => {
                    SolverStatus::IterationInterrupt
                }
                Ended::TooLarge => SolverStatus::ResourceInterrupt,
                Ended::Broken if self.message.is_some() => SolverStatus::ResourceInterrupt,
                Ended::Broken => SolverStatus::InternalSolverFailure,
                Ended::Failed if problem.last_failure.is_some() => {
                    SolverStatus::EvaluationInterrupt
                }
                _ => SolverStatus::TerminatedBySolver,
            },
            _ => SolverStatus::NormalCompletion,
        };
        let message = match (claim, &problem.last_failure) {
            (Claim::Unfinished, _) if best.is_optimal() => Some(
                "a saddle: the objective gets better beyond it, and what follows it there diverges"
                    .into(),
            ),
            (Claim::Unfinished, Some(f)) => {
                let row = self.budget.row_name(f.row as usize);
                Some(format!("the last evaluation that failed: {f} in {row}"))
            }
            (Claim::WithoutMultipliers, _) => Some(
                "rows have no multipliers at the solution (a square that is to be 0, say): their curvature leaves no \
                 direction that leads down"
                    .into(),
            ),
            _ => self.message.take(),
        };
        Outcome {
            column_marginal: best.at.reduced,
            level: best.level,
            row_marginal: best.row_marginal,
            claim,
            status: solver_status,
            iterations: self.iterations,
            solver: self.solver,
            ray,
            message,
            basis: None,
        }
    }
}

/// Whether only linear terms are left once the fixed variables are numbers: what is optimal is so everywhere.
fn is_affine(instance: &Instance, evaluator: &mut Evaluator) -> bool {
    let columns = &instance.columns;
    let known = |j: &u32| columns.lower[*j as usize] == columns.upper[*j as usize];
    let (first, second) = evaluator.hessian_pattern();
    let degrees = evaluator.degrees();
    first.iter().zip(second).all(|(i, j)| known(i) || known(j))
        && instance
            .terms()
            .all(|t| degrees[t.row] <= Degree::Quadratic || t.columns.iter().all(known))
}
