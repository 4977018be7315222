//! Attempts other than a plain run of the interior-point solver: from where an earlier solve ended, Newton's method on the equations, Clarabel
//! for convex quadratic programs, and rounded kinks.

use super::driver::Driver;
use super::interior_point::Ended;
use super::interior_point::lock;
use super::newton;
use super::problem::Problem;
use super::quadratic::{Quadratic, TOLERANCES};
use super::schedule::{FINEST, NEARER, ROUNDING};
use super::trial::{Trial, polished};
use super::truncated;
use crate::solve::{SolveError, Strategy};
use std::sync::{Arc, Mutex};

/// Residuals of a point that is taken without a run.
const SHARPLY: f64 = 1e-9;

/// The part of a right-hand side by which such a point may miss it: one that has become smaller is meant so, however small it is.
const SHARE: f64 = 1e-3;

/// Operations of a factorisation from which on the Hessian is only multiplied: some seconds for each.
const FILLED: f64 = 5e9;

impl Driver<'_, '_> {
    /// Without constraints and with a Hessian whose factors fill up: conjugate gradients. Whether that settles it.
    pub(super) fn settle_by_products(&mut self) -> Result<bool, SolveError> {
        let filled = || self.size_of_factors().operations > FILLED;
        if self.named
            || self.products.is_none() && !filled()
            || !self.settings.runs(Strategy::TruncatedNewton)
        {
            return Ok(false);
        }
        self.multiplies = true;
        let run = truncated::solve(&mut lock(&self.problem), self.products, self.budget);
        if let Some(run) = run {
            self.spend(run.steps);
            let trial = self.judge(run.x, Vec::new(), Ended::Acceptable);
            self.keep(trial);
        }
        let settled = self.is_settled_by("truncated")?;
        self.multiplies = false;
        Ok(settled)
    }

    /// Where an earlier solve ended, and Newton's method where there is nothing to choose. Whether that settles it.
    pub(super) fn settle_at_once(&mut self) -> Result<bool, SolveError> {
        self.leave_saddles()?;
        if self.is_settled() {
            return Ok(true);
        }
        if self.is_square() && self.settings.runs(Strategy::SquareNewton) {
            self.attempt_newton();
            return self.is_settled_by("newton");
        }
        Ok(false)
    }

    /// Whether the best point is an answer, of the method of that name if it is no saddle.
    pub(super) fn is_settled_by(&mut self, method: &'static str) -> Result<bool, SolveError> {
        let before = self.iterations;
        self.leave_saddles()?;
        if self.is_settled() && self.iterations == before {
            self.solver = method;
        }
        Ok(self.is_settled())
    }

    /// The start with the marginals that an earlier solve left: where little or nothing has changed since, that is the answer,
    /// perhaps after a Newton step on its active set. Whether there are such marginals.
    pub(super) fn attempt_again(&mut self) -> bool {
        let lambda = lock(&self.problem).marginals_of(self.instance);
        if lambda.iter().all(|&l| l == 0.0) || !self.settings.runs(Strategy::WarmStart) {
            return false;
        }
        let trial = self.judge(self.start.clone(), lambda, Ended::Solved);
        let sharp = trial.residual() <= SHARPLY && trial.relative_miss(self.instance) <= SHARE;
        if trial.is_optimal() && sharp {
            self.keep(trial);
        }
        true
    }

    /// Newton's method on the equations, where they leave nothing to choose, from where definitions hold.
    pub(super) fn attempt_newton(&mut self) {
        if !self.affords_factors() {
            return;
        }
        let budget = self.budget;
        let start = self.consistent();
        lock(&self.problem).start = start;
        let run = newton::solve(&mut lock(&self.problem), &mut |failures| {
            budget.stop_after_failures(failures).is_some()
        });
        if let Some(run) = run {
            self.spend(run.steps);
            budget.log(format!("{} steps of Newton's method", run.steps));
            let trial = self.judge(run.x, run.lambda, Ended::Acceptable);
            self.keep(trial);
        }
    }

    pub(super) fn attempt_quadratic(&mut self, quadratic: &Quadratic) {
        for tolerance in TOLERANCES {
            let solution = quadratic.solve(tolerance, self.budget);
            let ended = solution.ended;
            self.spend(solution.iterations);
            self.note_end(ended);
            let trial = self.judge(solution.x, solution.lambda, ended);
            self.keep(trial);
            if ended != Ended::Solved || self.is_settled() {
                break;
            }
        }
    }

    /// Solves with rounded kinks, each time from the last point.
    pub(super) fn round_kinks(&mut self) -> Result<(), SolveError> {
        let mut x = self.start.clone();
        for (k, delta) in ROUNDING.into_iter().enumerate() {
            if self.is_settled() || self.ended == Ended::TooFewDegrees {
                break;
            }
            let mut problem = Problem::smoothed(self.instance, delta);
            problem.start = x.clone();
            let options = if k == 0 { &[][..] } else { NEARER };
            let solution = self.call(Arc::new(Mutex::new(problem)), options)?;
            if solution.x.iter().all(|v| v.is_finite()) {
                x.clone_from(&solution.x);
                let trial = self.judge(solution.x, solution.lambda, solution.ended);
                self.keep(trial.clone());
                self.finish_rounded(&trial, delta);
            }
            // what is not solved with this parameter is not with a smaller one
            if self.ended == Ended::Iterations {
                break;
            }
        }
        Ok(())
    }

    /// The last digits of a solution with rounded kinks, which are not smooth enough for a solver's last steps.
    fn finish_rounded(&mut self, trial: &Trial, delta: f64) {
        if delta > FINEST || trial.is_optimal() || !trial.is_feasible() {
            return;
        }
        let mut rounded = Problem::smoothed(self.instance, delta);
        if let Some(t) = polished(self.instance, &mut rounded, &mut None, trial, 1e-6) {
            let trial = self.judge(t.x, t.lambda, t.ended);
            self.keep(trial);
        }
    }
}
