//! Which solver for which problem, and what its answer is worth.
//!
//! The status that is reported follows from the residuals recomputed on the unscaled instance, not
//! from the solver's word.

use std::cell::OnceCell;

use super::backend::{Backend, Task, choose};
use super::budget::Size;
use super::lp::certify::{Proof, Unproved};
use super::lp::least;
use super::mpec::Stationarity;
use super::mpec::pairs::Program;
use super::nlp::relaxation::is_infeasible;
use super::registry::BACKENDS;
use super::{
    Budget, Claim, ModelStatus, Outcome, Settings, SolveError, Solver, complementarity, lp, noise,
};
use crate::autodiff::Evaluator;
use crate::model::certificate::{self, Linearised, Residuals, TOLERANCE};
use crate::model::certificate_nlp::{kkt_residual, linearise};
use crate::model::instance::{Instance, Relation};
use crate::model::problem_type::ProblemType;

/// A solver's point with its certificate.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Point, marginals and how the solver ended.
    pub outcome: Outcome,
    /// Residuals on the unscaled instance.
    pub residuals: Residuals,
    /// What is known.
    pub status: ModelStatus,
    /// Level of each row: its left side.
    pub activity: Vec<f64>,
    /// For an mpec: whether no direction leads downhill.
    pub stationarity: Option<Stationarity>,
    /// A proved interval for the optimal value.
    pub bounds: Option<[f64; 2]>,
    /// For a program with discrete columns: bound and nodes.
    pub search: Option<super::mip::Report>,
}

impl Answer {
    /// An outcome with its residuals on the instance, and the status that follows from them and from its rays: all that a
    /// backend without knowledge of its own needs. A stationary point of a nonlinear program is called locally optimal.
    pub fn certified(instance: &Instance, outcome: Outcome) -> Self {
        if instance.is_linear() && instance.objective.is_some() {
            let at = certificate::linearise(instance, &outcome);
            let residuals = certificate::residuals(instance, &outcome, &at);
            let status = certificate::linear_status(instance, &outcome, &residuals);
            return Self::new(outcome, residuals, status, at.activity);
        }
        let mut evaluator = Evaluator::new(instance);
        let (level, marginal) = (&outcome.level, &outcome.row_marginal);
        match kkt_residual(instance, &mut evaluator, level, marginal) {
            Ok((residuals, at)) => {
                let status = match residuals.is_feasible(TOLERANCE) {
                    true if residuals.dual_relative <= TOLERANCE => ModelStatus::LocallyOptimal,
                    true => ModelStatus::Feasible,
                    false => ModelStatus::IntermediateInfeasible,
                };
                Self::new(outcome, residuals, status, at.activity)
            }
            Err(_) => {
                let activity = activity(instance, level);
                let sizes = vec![1.0; activity.len()];
                let residuals = certificate::primal(instance, level, &activity, &sizes);
                let status = ModelStatus::IntermediateInfeasible;
                Self::new(outcome, residuals, status, activity)
            }
        }
    }

    /// Without anything that is particular to a problem type.
    pub fn new(
        outcome: Outcome,
        residuals: Residuals,
        status: ModelStatus,
        activity: Vec<f64>,
    ) -> Self {
        Self {
            outcome,
            residuals,
            status,
            activity,
            stationarity: None,
            bounds: None,
            search: None,
        }
    }
}

impl Answer {
    /// A search ended without a solution: levels and marginals are as before.
    pub fn is_without_point(&self) -> bool {
        use ModelStatus as S;
        self.search.is_some()
            && matches!(
                self.status,
                S::IntegerInfeasible | S::NoSolution | S::UnboundedNoSolution
            )
    }
}

/// Solves an instance of a problem type with the backend chosen for it, if any.
pub fn answer(
    using: ProblemType,
    choice: Option<&str>,
    instance: &Instance,
    settings: &Settings,
    budget: &Budget,
) -> Result<Answer, SolveError> {
    let task = Task {
        using,
        choice,
        instance,
    };
    answer_with(BACKENDS, &task, settings, budget)
}

/// The same with these backends.
pub fn answer_with(
    backends: &[&dyn Backend],
    task: &Task,
    settings: &Settings,
    budget: &Budget,
) -> Result<Answer, SolveError> {
    let Some(backend) = choose(backends, task) else {
        let using = task.using;
        let message = match task.has_integers() {
            true => format!(
                "there is no solver for `{using}` with discrete variables; `using {}` solves the relaxation",
                using.relaxation()
            ),
            false => format!("there is no solver for this `{using}` in this build"),
        };
        return Err(SolveError::new(message));
    };
    affords_hessian(task, budget)?;
    let mut found = backend.solve(task, settings, budget)?;
    noise::quiet(&mut found.outcome.column_marginal);
    if task.using != ProblemType::Mcp {
        // there they are levels
        noise::quiet(&mut found.outcome.row_marginal);
    }
    Ok(found)
}

/// To compile the program of a second derivative takes a microsecond or two, several times in a solve.
const OPERATIONS_PER_DERIVATIVE: f64 = 3e3;

/// Err where the second derivatives do not fit into the memory that is left: their pattern is made before anything else.
fn affords_hessian(task: &Task, budget: &Budget) -> Result<(), SolveError> {
    let entries = || {
        let of_terms = task.instance.nonlinear.iter().map(|t| {
            let v = f64::from(t.kernel.variables);
            t.row.len() as f64 * v * (v + 1.0) / 2.0
        });
        of_terms.sum()
    };
    let size = || {
        let nonzeros = entries();
        Size {
            what: "the matrix of second derivatives",
            nonzeros,
            operations: nonzeros * OPERATIONS_PER_DERIVATIVE,
        }
    };
    budget.affords(size).map_err(SolveError::new)
}

/// A proved interval for the optimal value of a linear instance, near its answer.
pub fn certify(instance: &Instance, answer: &Answer, budget: &Budget) -> Result<Proof, SolveError> {
    // What the status says is the better answer.
    let why = match answer.status {
        ModelStatus::Infeasible | ModelStatus::InfeasibleNoSolution => "the model is infeasible",
        ModelStatus::Unbounded | ModelStatus::UnboundedNoSolution => "the model is unbounded",
        ModelStatus::IntegerInfeasible | ModelStatus::NoSolution => "there is no solution",
        _ if answer.search.is_some() => {
            return super::mip::certified(instance, &answer.outcome, budget);
        }
        _ => return lp::certify::certify(instance, &answer.outcome, budget),
    };
    let nothing = Unproved {
        why,
        row: None,
        column: None,
    };
    Ok(Proof {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
        no_low: Some(nothing.clone()),
        no_high: Some(nothing),
    })
}

pub(super) fn linear(
    solver: &dyn Solver,
    instance: &Instance,
    settings: &Settings,
    budget: &Budget,
) -> Result<Answer, SolveError> {
    let outcome = solver.solve(instance, settings, budget)?;
    Ok(Answer::certified(instance, outcome))
}

/// The same for what people see: an infeasible program at its least violation; where that is within the tolerance, as after
/// data that were rounded, the optimum with the rows moved by it.
pub(super) fn linear_shown(
    solver: &dyn Solver,
    instance: &Instance,
    settings: &Settings,
    budget: &Budget,
) -> Result<Answer, SolveError> {
    let mut found = linear(solver, instance, settings, budget)?;
    if found.status == ModelStatus::Infeasible {
        least::report_least_violation(instance, budget, &mut found.outcome);
        let at = certificate::linearise(instance, &found.outcome);
        found.residuals = certificate::residuals(instance, &found.outcome, &at);
        found.activity = at.activity;
        if found.residuals.is_feasible(TOLERANCE)
            && let Some(near) = moved(solver, instance, &found, settings, budget)
        {
            return Ok(near);
        }
    }
    Ok(found)
}

/// The optimum of the program whose violated rows are moved to where a point has them, if it is one of the program itself to
/// the tolerance.
fn moved(
    solver: &dyn Solver,
    instance: &Instance,
    found: &Answer,
    settings: &Settings,
    budget: &Budget,
) -> Option<Answer> {
    let mut near = instance.clone();
    for (i, &a) in found.activity.iter().enumerate() {
        let rhs = &mut near.rows.rhs[i];
        *rhs = match instance.rows.relation[i] {
            Relation::Equal => a,
            Relation::Greater => rhs.min(a),
            Relation::Less => rhs.max(a),
            Relation::Free => *rhs,
        };
    }
    let mut outcome = solver.solve(&near, settings, budget).ok()?;
    let at = certificate::linearise(instance, &outcome);
    let residuals = certificate::residuals(instance, &outcome, &at);
    if !residuals.is_optimal(TOLERANCE) {
        return None;
    }
    let most = residuals.primal.unwrap_or(0.0);
    outcome.message = Some(format!(
        "the rows contradict each other by a rounding error: they hold to {most:.0e}"
    ));
    outcome.iterations += found.outcome.iterations;
    let status = ModelStatus::Optimal;
    Some(Answer::new(outcome, residuals, status, at.activity))
}

/// Levels of the rows; not a number where a function has no value.
fn activity(instance: &Instance, x: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; instance.row_count()];
    if Evaluator::new(instance).rows(x, &mut out).is_err() {
        out.fill(f64::NAN);
    }
    out
}

/// Levels of the rows at a point, and what is violated there.
pub(super) fn primal(instance: &Instance, x: &[f64]) -> (Vec<f64>, Residuals) {
    let activity = activity(instance, x);
    let size: Vec<f64> = activity.iter().map(|a| a.abs().max(1.0)).collect();
    let residuals = certificate::primal(instance, x, &activity, &size);
    (activity, residuals)
}

pub(super) fn complementary(
    instance: &Instance,
    settings: &Settings,
    budget: &Budget,
) -> Result<Answer, SolveError> {
    let known = OnceCell::new();
    let hopeless =
        |budget: &Budget| *known.get_or_init(|| is_impossible(instance, budget).unwrap_or(false));
    let outcome = complementarity::solve(instance, false, settings, budget, &hopeless)?;
    let at = linearised(instance, &outcome);
    let residuals = certificate::complementarity(instance, &outcome.level, &at);
    let status = match certificate::complementarity_status(&residuals, outcome.claim) {
        ModelStatus::LocallyInfeasible if hopeless(budget) => ModelStatus::Infeasible,
        status => status,
    };
    Ok(Answer::new(outcome, residuals, status, at.activity))
}

/// The instance at an outcome's point; without derivatives where they have no value.
fn linearised(instance: &Instance, outcome: &Outcome) -> Linearised {
    let (x, marginal) = (&outcome.level, &outcome.row_marginal);
    linearise(instance, &mut Evaluator::new(instance), x, marginal).unwrap_or_else(|_| Linearised {
        activity: activity(instance, x),
        row_size: vec![1.0; instance.row_count()],
        ..Linearised::default()
    })
}

/// Whether the linear rows and the bounds alone, what the pairs imply without their products, have no solution.
/// That is what GAMS's solvers call infeasible; a nonlinear row that cannot hold is locally infeasible there.
fn is_impossible(instance: &Instance, budget: &Budget) -> Result<bool, SolveError> {
    let mut rows = Program::new(instance)?.envelope;
    for (relation, nonlinear) in rows.rows.relation.iter_mut().zip(instance.nonlinear_rows()) {
        if nonlinear {
            *relation = Relation::Free;
        }
    }
    Ok(is_infeasible(&rows, budget))
}

pub(super) fn square(
    instance: &Instance,
    settings: &Settings,
    budget: &Budget,
) -> Result<Answer, SolveError> {
    let outcome = complementarity::solve(instance, true, settings, budget, &|_| false)?;
    let at = linearised(instance, &outcome);
    let residuals = certificate::primal(instance, &outcome.level, &at.activity, &at.row_size);
    let status = if residuals.is_feasible(TOLERANCE) {
        ModelStatus::Solved
    } else if certificate::is_beyond_bounds(instance)
        || outcome.claim != Claim::Unfinished && is_impossible(instance, budget)?
    {
        ModelStatus::Infeasible
    } else if outcome.claim != Claim::Unfinished {
        // Either the rows hold and the point they determine is beyond a bound, or no method from any start
        // found a point where they hold.
        ModelStatus::LocallyInfeasible
    } else {
        ModelStatus::IntermediateInfeasible
    };
    Ok(Answer::new(outcome, residuals, status, at.activity))
}
