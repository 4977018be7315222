//! What is known in the end.

use super::Convexity;
use super::driver::Driver;
use super::problem::{Nlp, Problem};
use super::provider::{Ended, lock};
use super::relaxation;
use super::trial::Trial;
use crate::autodiff::Degree;
use crate::model::certificate_nlp::{is_locally_infeasible, violations};
use crate::solve::{Claim, ModelStatus, Outcome, SolverStatus, answer::Answer};

impl Driver<'_> {
    /// Whether it is certain that there is no feasible point; asked where none was found.
    pub(super) fn is_impossible(&mut self) -> bool {
        let lacks_point = !self.best.as_ref().is_some_and(Trial::is_feasible);
        self.impossible = lacks_point
            && self.stopped.is_none()
            && relaxation::is_infeasible(self.instance, self.settings, self.monitor);
        self.impossible
    }

    /// Turns the best trial into an answer.
    pub(super) fn finish(&mut self) -> Answer {
        let best = self.best.take().unwrap_or_else(|| {
            let m = lock(&*self.problem).size().1;
            self.judge(self.start.clone(), vec![0.0; m], Ended::Broken)
        });
        let unbounded = self.is_unbounded(&best);
        let mut problem = lock(&*self.problem);
        let affine = is_affine(&problem);
        let mut proved = |t: &Trial, y: &[f64]| {
            is_locally_infeasible(self.instance, problem.evaluator(), &t.level, y, 1e-4)
        };
        let mut best = best;
        let status = if best.is_optimal() && self.at_saddle {
            ModelStatus::Feasible
        } else if best.is_optimal() {
            match self.convex {
                Some(Convexity::Asked) => ModelStatus::Optimal,
                _ if affine => ModelStatus::Optimal,
                _ => ModelStatus::LocallyOptimal,
            }
        } else if unbounded {
            ModelStatus::Unbounded
        } else if best.is_feasible() {
            ModelStatus::Feasible
        } else if self.impossible {
            ModelStatus::Infeasible
        } else if let Some((t, y)) = self.infeasibility.take()
            && proved(&t, &y)
        {
            best = t;
            ModelStatus::LocallyInfeasible
        } else if proved(&best, &violations(self.instance, &best.at.activity)) {
            ModelStatus::LocallyInfeasible
        } else {
            ModelStatus::IntermediateInfeasible
        };
        let claim = match status {
            ModelStatus::Optimal | ModelStatus::LocallyOptimal => Claim::Solved,
            ModelStatus::Unbounded => Claim::Unbounded,
            ModelStatus::Infeasible | ModelStatus::LocallyInfeasible => Claim::Infeasible,
            _ => Claim::Unfinished,
        };
        let solver_status = match (claim, self.stopped) {
            (Claim::Unfinished, Some(s)) => s,
            (Claim::Unfinished, None) => match best.ended {
                // the limit was the person's, not that of an attempt
                Ended::Iterations if self.settings.option("max_iter").is_some() => {
                    SolverStatus::IterationInterrupt
                }
                Ended::Broken => SolverStatus::InternalSolverFailure,
                _ => SolverStatus::TerminatedBySolver,
            },
            _ => SolverStatus::NormalCompletion,
        };
        let message = match (status, &problem.last_failure) {
            (ModelStatus::Feasible, _) if best.is_optimal() => Some(
                "a saddle: the objective gets better beyond it, and what follows it there diverges"
                    .into(),
            ),
            (ModelStatus::Feasible | ModelStatus::IntermediateInfeasible, Some(f)) => {
                let row = self.monitor.row_name(f.row as usize);
                Some(format!("the last evaluation that failed: {f} in {row}"))
            }
            (ModelStatus::LocallyOptimal, _) if self.convex.is_some() => {
                Some("convex: a local optimum is a global one".into())
            }
            _ => self.message.take(),
        };
        Answer::new(
            Outcome {
                column_marginal: best.at.reduced.clone(),
                level: best.level,
                row_marginal: best.row_marginal,
                claim,
                status: solver_status,
                iterations: self.iterations,
                solver: self.solver,
                ray: Vec::new(),
                message,
                basis: None,
            },
            best.residuals,
            status,
            best.at.activity,
        )
    }
}

/// Whether only linear terms are left once the fixed variables are numbers: what is optimal is so everywhere.
fn is_affine(problem: &Problem) -> bool {
    let polynomial = |d: Degree| d <= Degree::Quadratic;
    problem.size().0 == 0
        || problem.hessian_pattern().0.is_empty() && problem.degrees().all(polynomial)
}
