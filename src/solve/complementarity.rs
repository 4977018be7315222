//! An instance as a complementarity problem: `mcp`, and square systems (`cns`).
//!
//! What happens at a solution is decided by the bounds: F is left minus right whatever the relation.

use super::answer;
use super::backend::{About, Backend, Replied, Supports, Task, Terms};
use super::certificate::{self, TOLERANCE, nonlinear::linearise};
use super::mcp;
use super::mpec::pairs::Program;
use super::nlp::relaxation::is_infeasible;
use super::pairing::{match_rows, refuse};
use super::vector::clip;
use super::{Budget, Claim, Outcome, Settings, SolveError, SolverStatus, Strategy};
use crate::autodiff::{EvalFailure, Evaluator};
use crate::model::instance::{Instance, Relation};
use crate::model::problem_type::ProblemType;
use crate::solve::noise;

/// Rows and columns put side by side.
struct Square<'a> {
    instance: &'a Instance,
    evaluator: Evaluator,
    /// The pattern is that of the matrix whose row k is the row of column k.
    data: mcp::Data,
    /// Row of each column; None for a fixed column without one.
    row_of: Vec<Option<u32>>,
    activity: Vec<f64>,
    jacobian: Vec<f64>,
    /// Where each entry of the pattern stands in the evaluator's Jacobian.
    from: Vec<usize>,
}

impl<'a> Square<'a> {
    fn new(instance: &'a Instance, square: bool) -> Result<Self, SolveError> {
        let row_of = match_rows(instance, square)?;
        let n = instance.column_count();
        let evaluator = Evaluator::first_order(instance);
        let columns = &instance.columns;
        // A square system's bounds do not act; they are checked at the solution.
        let bounds = |b: &[f64], infinite: f64| -> Vec<f64> {
            (0..n)
                .map(|j| {
                    if square && columns.lower[j] < columns.upper[j] {
                        infinite
                    } else {
                        b[j]
                    }
                })
                .collect()
        };
        let (lower, upper) = (
            bounds(&columns.lower, f64::NEG_INFINITY),
            bounds(&columns.upper, f64::INFINITY),
        );
        let mut at = vec![usize::MAX; instance.row_count()];
        for (j, r) in row_of.iter().enumerate() {
            if let Some(r) = r {
                at[*r as usize] = j;
            }
        }
        let (row_start, row_column) = evaluator.jacobian_pattern();
        let (row_start, row_column) = (row_start.to_vec(), row_column.to_vec());
        let mut entries: Vec<(u32, u32, usize)> = Vec::with_capacity(row_column.len());
        for i in 0..instance.row_count() {
            if at[i] != usize::MAX {
                entries.extend(
                    (row_start[i]..row_start[i + 1]).map(|k| (row_column[k], at[i] as u32, k)),
                );
            }
        }
        entries.sort_unstable();
        let mut column_start = vec![0; n + 1];
        for e in &entries {
            column_start[e.0 as usize + 1] += 1;
        }
        for j in 0..n {
            column_start[j + 1] += column_start[j];
        }
        Ok(Self {
            instance,
            evaluator,
            data: mcp::Data {
                lower,
                upper,
                start: columns.level.clone(),
                column_start,
                rows: entries.iter().map(|e| e.1 as usize).collect(),
                is_linear: instance.is_linear(),
            },
            row_of,
            activity: vec![0.0; instance.row_count()],
            jacobian: vec![0.0; row_column.len()],
            from: entries.iter().map(|e| e.2).collect(),
        })
    }
}

impl From<EvalFailure> for mcp::EvalError {
    fn from(failure: EvalFailure) -> Self {
        Self {
            row: Some(failure.row as usize),
            message: failure.to_string(),
        }
    }
}

impl mcp::Problem for Square<'_> {
    fn data(&self) -> &mcp::Data {
        &self.data
    }

    fn function(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), mcp::EvalError> {
        self.evaluator.rows(x, &mut self.activity)?;
        for (j, r) in self.row_of.iter().enumerate() {
            f[j] = r.map_or(0.0, |r| {
                self.activity[r as usize] - self.instance.rows.rhs[r as usize]
            });
        }
        Ok(())
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), mcp::EvalError> {
        self.evaluator.jacobian(x, &mut self.jacobian)?;
        for (v, &k) in values.iter_mut().zip(&self.from) {
            *v = self.jacobian[k];
        }
        Ok(())
    }
}

/// The complementarity solver as a backend; by name also for linear programs, whose optimality conditions it solves
/// ([`super::bridge::kkt`]).
#[derive(Clone, Copy, Debug, Default)]
pub struct Bmcp;

impl Backend for Bmcp {
    fn about(&self) -> About {
        About {
            name: "bmcp",
            aliases: &["path", "mcp"],
            version: "mcp, cns: bmod's own, on feral 0.22.0 and faer 0.24",
            supports: Supports {
                pairs: true,
                ..Supports::new(&[ProblemType::Mcp, ProblemType::Cns], Terms::Kinks)
            },
            options: &mcp::OPTIONS,
            option_files: &["path", "bmcp"],
        }
    }

    fn solve(&self, task: &Task, settings: &Settings, budget: &Budget) -> Replied {
        let instance = task.instance;
        let square = task.using == ProblemType::Cns;
        if square
            && task.choice.is_none()
            && match_rows(instance, square).is_ok()
            && settings.runs(Strategy::SquareNewton)
            && let Some(found) = by_newton(task, settings, budget)
        {
            return Ok(found.into());
        }
        let mut outcome = solve(instance, square, settings, budget)?;
        if square && !is_solved(instance, &outcome.level) {
            // Either the rows hold and the point they determine is beyond a bound, or no method from any start
            // found a point where they hold.
            outcome.claim = match outcome.claim {
                _ if certificate::is_beyond_bounds(instance) => Claim::Infeasible,
                Claim::Unfinished => Claim::Unfinished,
                _ => Claim::LocallyInfeasible,
            };
        }
        let proved = || is_proved_infeasible(instance, budget).unwrap_or(false);
        if outcome.claim == Claim::LocallyInfeasible && proved() {
            outcome.claim = Claim::Infeasible;
            outcome.message = None;
        }
        Ok(outcome.into())
    }
}

/// A point where the rows of a square system hold, by Newton's method alone ([`super::nlp`]).
fn by_newton(task: &Task, settings: &Settings, budget: &Budget) -> Option<Outcome> {
    let system = Task {
        using: ProblemType::Nlp,
        ..*task
    };
    // its steps are counted at its end: no other method begins
    let found = budget.within(f64::INFINITY, 1, |b| {
        answer::subproblem(&system, settings, b)
    });
    let mut outcome = found.ok().map(|a| a.outcome)?;
    // they have no meaning
    outcome.row_marginal.fill(0.0);
    outcome.column_marginal.fill(0.0);
    is_solved(task.instance, &outcome.level).then_some(outcome)
}

/// Whether rows and bounds hold.
fn is_solved(instance: &Instance, level: &[f64]) -> bool {
    let none = vec![0.0; instance.row_count()];
    let at = linearise(
        instance,
        &mut Evaluator::first_order(instance),
        level,
        &none,
    );
    at.is_ok_and(|at| {
        let residuals = certificate::primal(instance, level, &at.activity, &at.row_size);
        residuals.is_feasible(TOLERANCE)
    })
}

/// Whether the linear rows and the bounds alone, what the pairs imply without their products, have no solution.
/// That is what GAMS's solvers call infeasible; a nonlinear row that cannot hold is locally infeasible there.
fn is_proved_infeasible(instance: &Instance, budget: &Budget) -> Result<bool, SolveError> {
    let mut rows = Program::new(instance)?.envelope;
    for (relation, nonlinear) in rows.rows.relation.iter_mut().zip(instance.nonlinear_rows()) {
        if nonlinear {
            *relation = Relation::Free;
        }
    }
    Ok(is_infeasible(&rows, budget))
}

/// Runs the complementarity solver: its outcome, and how it ended in GAMS's terms.
fn run(
    problem: &mut dyn mcp::Problem,
    names: mcp::Names,
    settings: &Settings,
    budget: &Budget,
) -> Result<(mcp::Outcome, SolverStatus), SolveError> {
    let mut limits = mcp::Settings::new(settings);
    let left = usize::try_from(budget.iterations_left()).unwrap_or(usize::MAX);
    limits.cumulative_iteration_limit = limits.cumulative_iteration_limit.min(left);
    let seconds = limits.time_limit;
    let out = budget.within(seconds, u64::MAX, |budget| {
        mcp::solve(problem, &limits, budget, names)
    });
    budget.spend((out.majors + out.pivots) as u64);
    let status = match out.status {
        mcp::Status::Solved => SolverStatus::NormalCompletion,
        mcp::Status::IterationLimit => SolverStatus::IterationInterrupt,
        mcp::Status::TimeLimit => SolverStatus::ResourceInterrupt,
        mcp::Status::NoSolution => SolverStatus::TerminatedBySolver,
        mcp::Status::Interrupted => SolverStatus::UserInterrupt,
        mcp::Status::EvaluationFailed
        | mcp::Status::InvalidBounds
        | mcp::Status::InvalidProblem => SolverStatus::InternalSolverFailure,
    };
    Ok((out, status))
}

/// Solves an mcp (or, with `square`, a cns). The outcome's marginals are those of GAMS: of a row the level of its column, of a column F.
fn solve(
    instance: &Instance,
    square: bool,
    settings: &Settings,
    budget: &Budget,
) -> Result<Outcome, SolveError> {
    let mut problem = Square::new(instance, square)?;
    let row_of = problem.row_of.clone();
    let names = |j: usize| match row_of[j] {
        Some(r) => format!("{}.{}", budget.row_name(r as usize), budget.column_name(j)),
        None => budget.column_name(j),
    };
    let (mut out, status) = run(&mut problem, &names, settings, budget)?;
    let (lower, upper) = (&instance.columns.lower, &instance.columns.upper);
    if let Ok(lines) = Evaluator::first_order(instance).jacobian_rows(&out.x) {
        let row = |i: usize| lines[i].iter().copied();
        let errors = noise::rounding_in_rows(&out.x, instance.row_count(), row);
        noise::snap(&mut out.x, lower, upper, &errors);
    }
    if square && out.status != mcp::Status::Solved {
        // The rows do not hold: the bounds shall.
        clip(&mut out.x, (lower, upper));
    }
    if out.status == mcp::Status::EvaluationFailed {
        let mut f = vec![0.0; instance.column_count()];
        let failure = mcp::Problem::function(&mut problem, &instance.columns.level, &mut f).err();
        let (row, what) = failure.map_or((None, out.message.clone()), |e| (e.row, e.message));
        return refuse(format!("the start cannot be evaluated: {what}"), row, None);
    }
    let mut row_marginal = vec![0.0; instance.row_count()];
    let mut column_marginal = vec![0.0; out.x.len()];
    // The marginals of a square system have no meaning.
    if !square {
        column_marginal.copy_from_slice(&out.f);
        for (j, r) in row_of.iter().enumerate() {
            if let Some(r) = r {
                row_marginal[*r as usize] = out.x[j];
            }
        }
    }
    if out.status == mcp::Status::Solved
        && let Some(j) = running_away(&mut problem, &out.x)
    {
        out.message = format!(
            "the residual is small, but {} = {:.1e} runs away: twice as far it is smaller still, so the solution may lie at infinity only",
            budget.column_name(j),
            out.x[j]
        );
    }
    if out.restarts > 0 && out.message.is_empty() {
        let n = out.restarts;
        out.message = match out.status {
            mcp::Status::Solved => {
                format!("found from random start {n}: nothing led on from the given one")
            }
            _ => format!("nothing led on from the given start, nor from {n} random ones"),
        };
    }
    let (claim, status) = match out.status {
        mcp::Status::Solved => (Claim::Solved, status),
        // That all methods from all starts failed is what GAMS calls locally infeasible.
        mcp::Status::NoSolution => (Claim::LocallyInfeasible, SolverStatus::NormalCompletion),
        _ => (Claim::Unfinished, status),
    };
    Ok(Outcome {
        level: out.x,
        row_marginal,
        column_marginal,
        claim,
        status,
        iterations: (out.majors + out.pivots) as u64,
        solver: "bmcp",
        ray: Vec::new(),
        message: (!out.message.is_empty()).then_some(out.message),
        basis: None,
    })
}

/// A level beyond this may be on its way to infinity.
const FAR: f64 = 1e6;

/// The largest variable without a bound ahead if the residual falls where all that are so far out go twice as far.
fn running_away(problem: &mut Square, x: &[f64]) -> Option<usize> {
    let mcp::Data { lower, upper, .. } = problem.data.clone();
    let endless = |j: usize| {
        if x[j] > 0.0 {
            upper[j] >= mcp::INFINITY
        } else {
            lower[j] <= -mcp::INFINITY
        }
    };
    let far = (0..x.len()).filter(|&j| x[j].abs() > FAR && endless(j));
    let largest = far.max_by(|&a, &b| x[a].abs().total_cmp(&x[b].abs()))?;
    let mut residual = |x: &[f64]| {
        let mut f = vec![0.0; x.len()];
        mcp::Problem::function(problem, x, &mut f).ok()?;
        Some(mcp::natural_residual(x, &f, &lower, &upper).0)
    };
    let farther = |(j, &v): (usize, &f64)| {
        if v.abs() > FAR && endless(j) {
            2.0 * v
        } else {
            v
        }
    };
    let twice: Vec<f64> = x.iter().enumerate().map(farther).collect();
    let (here, there) = (residual(x)?, residual(&twice)?);
    (here > 0.0 && there < 0.75 * here).then_some(largest)
}
