//! Which solver for which problem, and what its answer is worth.
//!
//! The status that is reported follows from the residuals recomputed on the unscaled instance, not
//! from the solver's word.

use std::cell::OnceCell;

use super::lp::certify::{Proof, Unproved};
use super::lp::least;
use super::mpec::Stationarity;
use super::mpec::pairs::Program;
use super::nlp::relaxation::is_infeasible;
use super::{
    Claim, ModelStatus, Monitor, Outcome, Settings, SolveError, Solver, complementarity, lp, noise,
};
use crate::autodiff::Evaluator;
use crate::model::certificate::{self, Linearised, Residuals, TOLERANCE};
use crate::model::certificate_nlp::linearise;
use crate::model::instance::{Instance, Relation};

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

/// Solves an instance of a problem type (`lp`, `mcp` …) with the solver chosen for it, if any.
pub fn answer(
    using: &str,
    choice: Option<&str>,
    instance: &Instance,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<Answer, SolveError> {
    let discrete = matches!(using, "mip" | "miqcp" | "minlp");
    let undecided = discrete && instance.columns.first_undecided().is_some();
    let has_pairs = instance.matched.iter().flatten().any(Option::is_some);
    let mut found = match using {
        "mcp" => complementary(instance, settings, monitor),
        "cns" => square(instance, settings, monitor),
        _ if undecided => super::mip::answer(choice, instance, settings, monitor),
        "mpec" | "rmpec" if has_pairs => super::mpec::answer(choice, instance, settings, monitor),
        _ if instance.is_linear() && instance.objective.is_some() => match choice {
            Some("mcp" | "bmcp") => linear_shown(&super::kkt::Kkt, instance, settings, monitor),
            _ => linear_shown(&lp::Clarabel, instance, settings, monitor),
        },
        _ => super::nlp::answer(choice, instance, settings, monitor),
    }?;
    noise::quiet(&mut found.outcome.column_marginal);
    if using != "mcp" {
        // there they are levels
        noise::quiet(&mut found.outcome.row_marginal);
    }
    Ok(found)
}

/// A proved interval for the optimal value of a linear instance, near its answer.
pub fn certify(
    instance: &Instance,
    answer: &Answer,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<Proof, SolveError> {
    // What the status says is the better answer.
    let why = match answer.status {
        ModelStatus::Infeasible | ModelStatus::InfeasibleNoSolution => "the model is infeasible",
        ModelStatus::Unbounded | ModelStatus::UnboundedNoSolution => "the model is unbounded",
        ModelStatus::IntegerInfeasible | ModelStatus::NoSolution => "there is no solution",
        _ if answer.search.is_some() => {
            return super::mip::certified(instance, &answer.outcome, settings, monitor);
        }
        _ => return lp::certify::certify(instance, &answer.outcome, settings, monitor),
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
    monitor: &mut dyn Monitor,
) -> Result<Answer, SolveError> {
    let outcome = solver.solve(instance, settings, monitor)?;
    let at = certificate::linearise(instance, &outcome);
    let residuals = certificate::residuals(instance, &outcome, &at);
    let status = certificate::linear_status(instance, &outcome, &residuals);
    Ok(Answer::new(outcome, residuals, status, at.activity))
}

/// The same for what people see: an infeasible program at its least violation.
pub(super) fn linear_shown(
    solver: &dyn Solver,
    instance: &Instance,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<Answer, SolveError> {
    let mut found = linear(solver, instance, settings, monitor)?;
    if found.status == ModelStatus::Infeasible {
        least::report_least_violation(instance, settings, monitor, &mut found.outcome);
        let at = certificate::linearise(instance, &found.outcome);
        found.residuals = certificate::residuals(instance, &found.outcome, &at);
        found.activity = at.activity;
    }
    Ok(found)
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

fn complementary(
    instance: &Instance,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<Answer, SolveError> {
    let known = OnceCell::new();
    let hopeless = |monitor: &mut dyn Monitor| {
        *known.get_or_init(|| is_impossible(instance, settings, monitor).unwrap_or(false))
    };
    let outcome = complementarity::solve(instance, false, settings, monitor, &hopeless)?;
    let at = linearised(instance, &outcome);
    let residuals = certificate::complementarity(instance, &outcome.level, &at);
    let status = match certificate::complementarity_status(&residuals, outcome.claim) {
        ModelStatus::LocallyInfeasible if hopeless(monitor) => ModelStatus::Infeasible,
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
fn is_impossible(
    instance: &Instance,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<bool, SolveError> {
    let mut rows = Program::new(instance)?.envelope;
    for (relation, nonlinear) in rows.rows.relation.iter_mut().zip(instance.nonlinear_rows()) {
        if nonlinear {
            *relation = Relation::Free;
        }
    }
    Ok(is_infeasible(&rows, settings, monitor))
}

fn square(
    instance: &Instance,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<Answer, SolveError> {
    let outcome = complementarity::solve(instance, true, settings, monitor, &|_| false)?;
    let at = linearised(instance, &outcome);
    let residuals = certificate::primal(instance, &outcome.level, &at.activity, &at.row_size);
    let status = if residuals.is_feasible(TOLERANCE) {
        ModelStatus::Solved
    } else if certificate::is_beyond_bounds(instance)
        || outcome.claim != Claim::Unfinished && is_impossible(instance, settings, monitor)?
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
