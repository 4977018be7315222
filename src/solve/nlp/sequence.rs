//! Sequential programs ([`slqp`]) from a point: what they prove, and what is made of rows without multipliers.

use super::driver::Driver;
use super::fritz_john::is_without_descent;
use super::growth::Growth;
use super::interior_point::{Ended, lock};
use super::newton;
use super::quadratic::nearest;
use super::schedule::From;
use super::slqp::{self, Effort};
use super::trial::{Trial, active_set};
use crate::solve::certificate::TOLERANCE;
use crate::solve::certificate::nonlinear::is_locally_infeasible;
use crate::solve::{SolveError, Strategy};

/// How often negative curvature of the violation is followed.
const MOST_ESCAPES: u32 = 3;

/// Rows without multipliers are violated by less than this where the sequential method ends.
const NEARLY: f64 = 1e-4;

/// Where so much less is violated than at a point of least violation, that point says nothing.
const NEARER: f64 = 0.1;

/// What rows without multipliers are widened by, in units of their largest entry.
const WIDTH: f64 = 1e-8;

impl Driver<'_, '_> {
    /// Sequential programs, from where an earlier solve ended if there was one. Whether that settles it.
    pub(super) fn settle_by_sequence(
        &mut self,
        again: bool,
        effort: Effort,
    ) -> Result<bool, SolveError> {
        let marginals = again.then(|| lock(&self.problem).marginals_of(self.instance));
        // Newton's method may have come to a feasible point that is no optimum
        let found = self.best.as_ref().filter(|t| t.is_feasible());
        let start = match found {
            Some(found) if !again => found.x.clone(),
            None if !again => self.consistent(),
            _ => self.start.clone(),
        };
        self.sequential(start, marginals.as_deref(), effort);
        if self.was_moved && !again && self.is_settled() {
            // slopes without limit may hold variables near 0
            self.sequential(self.start_point(From::Middle), None, effort);
        }
        let settled = self.is_settled_by("slqp")?;
        if settled {
            self.growth = Growth::Ignored;
            self.search()?;
        } else if self.infeasibility.is_some()
            && !self.is_impossible()
            && self.settings.runs(Strategy::InfeasibilityDoubt)
        {
            return self.doubt();
        }
        Ok(settled)
    }

    /// Where nothing near the start is feasible: from where the linear rows hold, near the middle between the bounds. Whether that
    /// settles it.
    fn doubt(&mut self) -> Result<bool, SolveError> {
        let middle = self.start_point(From::Middle);
        let near = nearest(&mut lock(&self.problem), &middle, self.budget);
        self.sequential(near.unwrap_or(middle), None, Effort::FULL);
        if self.best.as_ref().is_some_and(Trial::is_feasible) {
            return self.is_settled_by("slqp");
        }
        let violation = |t: &Trial| t.residuals.primal_relative;
        let least = self.best.as_ref().map_or(f64::INFINITY, violation);
        let far = |proof: &Trial| least <= NEARER * violation(proof);
        self.infeasibility = self.infeasibility.take().filter(|p| !far(&p.0));
        Ok(false)
    }

    /// Sequential programs from a point, judged and kept; with multipliers, from the active set that they name.
    pub(super) fn sequential(&mut self, x: Vec<f64>, multipliers: Option<&[f64]>, effort: Effort) {
        if !self.settings.runs(Strategy::SequentialQuadratic) || !self.affords_factors() {
            return;
        }
        let mut problem = lock(&self.problem);
        problem.start = x;
        let own = self.settings.number("max_iter");
        let own = own.map_or(u64::MAX, |n| n as u64);
        let effort = Effort {
            steps: effort.steps.min(self.budget.iterations_left()).min(own),
            ..effort
        };
        let request = slqp::Request {
            multipliers,
            effort,
            width: 0.0,
            strategies: self.settings.strategies(),
        };
        let run = slqp::solve(&mut problem, request, self.budget);
        let failures = problem.failure_count;
        drop(problem);
        self.budget.stop_after_failures(failures);
        let Some(run) = run else { return };
        self.spend(run.steps);
        let (steps, end) = (run.steps, run.end);
        self.budget
            .log(format!("slqp: {end:?} after {steps} steps"));
        let ended = match run.end {
            slqp::End::Solved => Ended::Solved,
            slqp::End::Infeasible => Ended::Infeasible,
            slqp::End::Diverging => Ended::Diverging,
            slqp::End::Spent => Ended::Iterations,
            slqp::End::Stuck | slqp::End::Outgrown => Ended::SmallStep,
        };
        if run.end == slqp::End::Infeasible
            && self.violation_escapes < MOST_ESCAPES
            && let Some(x) = self.beyond_least_violation(&run.x, &run.lambda)
        {
            self.violation_escapes += 1;
            return self.sequential(x, None, effort);
        }
        let trial = self.judge(run.x, run.lambda, ended);
        if run.end == slqp::End::Infeasible {
            self.note_infeasibility(&trial);
        }
        let ended = !matches!(run.end, slqp::End::Infeasible | slqp::End::Diverging);
        let regular = self.kinks.is_some() || trial.lambda.is_empty() || trial.is_optimal();
        let near = match run.heavy {
            true => trial.residuals.primal_relative <= NEARLY,
            false => trial.is_feasible() && run.end != slqp::End::Spent,
        };
        let set = active_set(self.instance, &lock(&self.problem), &trial, NEARLY);
        let irregular = ended && !regular && near && set.binding.contains(&true);
        let trial = match irregular && self.settings.runs(Strategy::WidenedRows) {
            true => self.without_multipliers(trial),
            false => trial,
        };
        self.keep(trial);
    }

    /// Where rows have no multipliers, as a square that is to be 0: those of the same rows, a little wider, name the rows whose
    /// curvature keeps the point from going down.
    fn without_multipliers(&mut self, mut trial: Trial) -> Trial {
        let mut problem = lock(&self.problem);
        problem.start = trial.x.clone();
        if !trial.is_feasible() {
            let budget = self.budget;
            let run = newton::solve(&mut problem, &mut |_| budget.is_over());
            drop(problem);
            if let Some(run) = run {
                self.spend(run.steps);
                trial = self.judge(run.x, trial.lambda, trial.ended);
            }
            problem = lock(&self.problem);
            problem.start = trial.x.clone();
        }
        let request = slqp::Request {
            multipliers: None,
            effort: Effort::FULL,
            width: WIDTH,
            strategies: self.settings.strategies(),
        };
        let run = slqp::solve(&mut problem, request, self.budget);
        drop(problem);
        let Some(run) = run else { return trial };
        self.spend(run.steps);
        let wide = self.judge(run.x, run.lambda, Ended::Solved);
        let difference = (wide.objective - trial.objective).abs();
        let near = difference <= 1e-3 * trial.objective.abs().max(1.0);
        let (primal, dual) = (wide.residuals.primal_relative, wide.residuals.dual_relative);
        let solved = run.end == slqp::End::Solved && primal <= NEARLY && dual <= TOLERANCE;
        if near && trial.is_feasible() && solved {
            let (instance, budget) = (self.instance, self.budget);
            trial.irregular =
                is_without_descent(instance, &trial.level, &wide.row_marginal, budget);
            return trial;
        }
        match wide.is_optimal() {
            true => wide,
            false => trial,
        }
    }

    /// Keeps a point whose multipliers prove that there is no feasible one nearby.
    pub(super) fn note_infeasibility(&mut self, trial: &Trial) {
        let mut problem = lock(&self.problem);
        // the constraints push with −λ
        let mut y = vec![0.0; self.instance.row_count()];
        for (&i, l) in problem.rows.iter().zip(&trial.lambda) {
            y[i as usize] = -l;
        }
        let evaluator = &mut problem.evaluator;
        let proved = is_locally_infeasible(self.instance, evaluator, &trial.level, &y, 1e-4);
        if !trial.is_feasible() && self.infeasibility.is_none() && proved {
            self.infeasibility = Some((trial.clone(), y));
        }
    }
}
