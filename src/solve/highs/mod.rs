//! HiGHS (cargo feature `highs`): the backend for programs with discrete columns that are more than small, and, where it is
//! named, for linear programs and convex quadratic ones.
//!
//! It gets the problem in the form of [`crate::solve::lp::form`], in the instance's units: what it says of a point is
//! checked on the instance, as with every other backend.

mod engine;

use super::backend::{About, Backend, QuadraticEngine, Replied, Supports, Task, Terms};
use super::discrete::Mip;
use super::lp::form::{Form, Point, Problem, Sparse};
use super::lp::{self, Ended, interior};
use super::mip::{self, Aim, End, Found};
use super::{Budget, Claim, Outcome, Settings, SolveError, SolverStatus, nlp};
use crate::model::instance::Instance;
use crate::model::option::{Kind, OptionTable, row};
use crate::model::problem_type::ProblemType;
use engine::{Engine, Run, Status};
use highs_sys::{
    VAR_TYPE_CONTINUOUS, VAR_TYPE_INTEGER, VAR_TYPE_SEMI_CONTINUOUS, VAR_TYPE_SEMI_INTEGER,
};

/// Name of this solver.
pub const NAME: &str = "highs";

/// Its options.
#[rustfmt::skip]
pub const OPTIONS: OptionTable = OptionTable {
    backend: NAME,
    title: "mip; lp, rmip and convex quadratic programs where it is named: HiGHS",
    rows: &[
        row("highs_threads", Kind::Whole(0.0, 1024.0), "0", "threads; 0: as many as HiGHS thinks right"),
        row("highs_seed", Kind::Whole(0.0, 2147483647.0), "0", "start of HiGHS's random numbers"),
        row("highs_presolve", Kind::Switch, "yes", "makes the program smaller first"),
        row("highs_method", Kind::Words(&["choose", "simplex", "ipm"]), "choose", "of linear programs: simplex method, or interior point with crossover"),
        row("highs_heuristics", Kind::Real(0.0, 1.0), "0.05", "share of a search's effort that heuristics get"),
    ],
    more: None,
    ignored: &[],
};

/// Programs with discrete columns.
#[derive(Clone, Copy, Debug, Default)]
pub struct Highs;

impl Backend for Highs {
    fn about(&self) -> About {
        About {
            name: NAME,
            aliases: &[],
            version: "mip: HiGHS, by highs-sys 1.15.0",
            supports: Supports {
                integers: true,
                ..Supports::new(&[ProblemType::Mip], Terms::Linear)
            },
            options: &OPTIONS,
            option_files: &[NAME],
        }
    }

    /// Ordered sets and semicontinuous columns with large or tiny bounds are left to the own search.
    fn takes(&self, task: &Task) -> bool {
        let columns = &task.instance.columns;
        let within = |&(j, least): &(u32, f64)| {
            columns.upper[j as usize] <= MOST_SEMICONTINUOUS
                && (least == 0.0 || least >= LEAST_SEMICONTINUOUS)
        };
        self.about().supports.takes(task)
            && task.has_integers()
            && task.instance.discrete.sets.is_empty()
            && task.instance.discrete.thresholds.iter().all(within)
    }

    fn solve(&self, task: &Task, settings: &Settings, budget: &Budget) -> Replied {
        let instance = task.instance;
        let aim = settings.search.minimizing(instance.sign());
        let form = Form::new(instance)?;
        let mip = Mip::new(form.problem.clone(), instance, &form.columns, false);
        let levels: Vec<f64> = form
            .columns
            .iter()
            .map(|&j| instance.columns.level[j as usize])
            .collect();
        let task = task.by(Some(NAME));
        let mut iterations = 0;
        let mut solve = |tolerance: f64| {
            let (mut found, spent) =
                search(&mip, aim, tolerance, &levels, form.sign, settings, budget);
            iterations += spent;
            budget.spend(spent);
            if let Some(x) = found.x.take() {
                let point = Point {
                    x,
                    ..zero(&form.problem)
                };
                found.x = Some(form.point(instance, &point).0);
            }
            let solved = matches!(found.end, End::Gap | End::Complete) && found.x.is_some();
            let gap = aim.relative_gap * found.value.abs() + aim.absolute_gap;
            let claimed = found.value + gap.max(1e-6 * found.value.abs().max(1.0));
            let reply = mip::concluded(&task, found, settings, budget);
            let o = instance.objective.map(|o| o.column as usize);
            let value = o.map_or(claimed, |o| form.sign * reply.outcome.level[o]);
            (reply, solved && value > claimed)
        };
        let (mut reply, lost) = solve(TOLERANCE);
        if lost {
            // Integers that were none: rounded they are a worse solution than HiGHS had.
            let (finer, lost) = solve(FINE);
            reply = finer;
            if lost && reply.outcome.claim == Claim::Solved {
                reply.outcome.claim = Claim::Unfinished;
            }
        }
        reply.outcome.iterations = iterations;
        reply.outcome.solver = NAME;
        Ok(reply)
    }
}

/// How far an integer may be from one for HiGHS.
const TOLERANCE: f64 = 1e-6;
/// The same where that was too far.
const FINE: f64 = 1e-9;

/// HiGHS turns a semicontinuous column into a binary and a row with its upper bound, and refuses larger ones.
const MOST_SEMICONTINUOUS: f64 = 1e5;

/// Smaller ones are not told from 0 by its tolerance of 1e-6.
const LEAST_SEMICONTINUOUS: f64 = 1e-3;

/// The search, and its iterations.
fn search(
    mip: &Mip,
    aim: Aim,
    tolerance: f64,
    levels: &[f64],
    sign: f64,
    settings: &Settings,
    budget: &Budget,
) -> (Found, u64) {
    let p = &mip.problem;
    if p.lower.iter().zip(&p.upper).any(|(l, u)| l > u) {
        return (Found::empty(), 0);
    }
    let kind = |j: usize| match (mip.integer[j], mip.threshold[j] > 0.0) {
        (false, false) => VAR_TYPE_CONTINUOUS,
        (true, false) => VAR_TYPE_INTEGER,
        (false, true) => VAR_TYPE_SEMI_CONTINUOUS,
        (true, true) => VAR_TYPE_SEMI_INTEGER,
    };
    let kinds: Vec<_> = (0..p.n()).map(kind).collect();
    let mut problem = p.clone();
    for (lower, &t) in problem.lower.iter_mut().zip(&mip.threshold) {
        *lower = if t > 0.0 { t } else { *lower };
    }
    let Some(engine) = Engine::new(&problem, &kinds, None) else {
        return (nothing(Status::Failed), 0);
    };
    engine.set(settings);
    engine.number(c"mip_feasibility_tolerance", tolerance);
    engine.number(c"mip_rel_gap", aim.relative_gap);
    engine.number(c"mip_abs_gap", aim.absolute_gap);
    if aim.nodes > 0 {
        engine.whole(c"mip_max_nodes", aim.nodes);
    }
    if let Some(cutoff) = aim.cutoff {
        engine.number(c"objective_bound", cutoff);
    }
    if levels.iter().any(|&x| x != 0.0) && mip.is_discrete(levels) {
        engine.start(levels);
    }
    let run = engine.run(budget, true, &|v| sign * v);
    let iterations = run.iterations;
    if run.status == Status::Unbounded {
        // Unbounded, if there is a solution at all.
        problem.cost.fill(0.0);
        let any = Engine::new(&problem, &kinds, None).map(|engine| {
            engine.set(settings);
            engine.run(budget, true, &|v| v)
        });
        let mut found = any.map_or(nothing(Status::Failed), |any| found(mip, None, any));
        if found.x.is_some() || found.end != End::Complete {
            found.end = End::Unbounded;
        }
        found.bound = f64::NEG_INFINITY;
        return (found, iterations);
    }
    (found(mip, aim.cutoff, run), iterations)
}

/// No point, and why.
fn nothing(status: Status) -> Found {
    Found {
        bound: f64::NEG_INFINITY,
        end: end(status),
        ..Found::empty()
    }
}

fn end(status: Status) -> End {
    match status {
        Status::Optimal => End::Gap,
        Status::Infeasible => End::Complete,
        Status::Unbounded => End::Unbounded,
        Status::Nodes => End::Nodes,
        Status::Stopped(stop) => End::Stopped(stop.into()),
        Status::Failed => End::Stopped(Ended::Failed),
    }
}

/// What a search gave. That nothing is left is known to a tolerance of HiGHS's, which the bound shows.
fn found(mip: &Mip, cutoff: Option<f64>, run: Run) -> Found {
    let mut found = nothing(run.status);
    found.nodes = run.nodes;
    found.bound = match run.status {
        Status::Infeasible => f64::INFINITY,
        _ => run.bound,
    };
    let worth = |x: &[f64]| mip.value(x) + mip.problem.offset;
    found.x = run.point.map(|p| p.x);
    found.value = found.x.as_deref().map_or(f64::INFINITY, worth);
    let rest = found.value - found.bound;
    if run.status == Status::Optimal && rest <= TOLERANCE * found.value.abs().max(1.0) {
        (found.bound, found.end) = (found.value, End::Complete);
    }
    if cutoff.is_some_and(|c| found.value > c + TOLERANCE * c.abs().max(1.0)) {
        // A start that is no better than what was asked for.
        (found.x, found.value) = (None, f64::INFINITY);
        if run.status == Status::Optimal {
            found.end = End::Complete;
        }
    }
    found
}

/// Linear programs, and convex quadratic ones.
#[derive(Clone, Copy, Debug, Default)]
pub struct Continuous;

impl Backend for Continuous {
    fn about(&self) -> About {
        About {
            name: NAME,
            aliases: &[],
            version: "lp, rmip, convex qcp where it is named",
            supports: Supports {
                only_by_name: true,
                ..Supports::new(lp::TYPES, Terms::Smooth)
            },
            options: &OPTIONS,
            option_files: &[NAME],
        }
    }

    fn quadratic(&self) -> Option<QuadraticEngine> {
        Some(QuadraticEngine {
            name: NAME,
            solve: quadratic,
        })
    }

    fn solve(&self, task: &Task, settings: &Settings, budget: &Budget) -> Replied {
        match (
            task.instance.is_linear(),
            nlp::interior_point_solvers().first(),
        ) {
            (false, Some(&p)) => nlp::Nonlinear(p).solve(task, settings, budget),
            _ => Ok(linear(task.instance, settings, budget)?.into()),
        }
    }
}

/// A linear program.
fn linear(
    instance: &Instance,
    settings: &Settings,
    budget: &Budget,
) -> Result<Outcome, SolveError> {
    let form = Form::new(instance)?;
    let failed = || SolveError::new("HiGHS does not take these numbers");
    let engine = Engine::new(&form.problem, &[], None).ok_or_else(failed)?;
    engine.set(settings);
    let shown = |v: f64| form.sign * v;
    let mut run = engine.run(budget, false, &shown);
    let mut iterations = run.iterations;
    if run.status == Status::Unbounded {
        // which of the two it is, and a direction
        engine.word(c"presolve", "off");
        engine.word(c"solver", "simplex");
        run = engine.run(budget, false, &shown);
        iterations += run.iterations;
    }
    budget.spend(iterations);
    let (claim, status) = match run.status {
        Status::Optimal => (Claim::Solved, SolverStatus::NormalCompletion),
        Status::Infeasible => (Claim::Infeasible, SolverStatus::NormalCompletion),
        Status::Unbounded => (Claim::Unbounded, SolverStatus::NormalCompletion),
        Status::Stopped(stop) => (Claim::Unfinished, stop.status()),
        Status::Nodes | Status::Failed => (Claim::Unfinished, SolverStatus::TerminatedBySolver),
    };
    let ray = match claim {
        Claim::Infeasible => engine.infeasibility().map(|y| form.multipliers(&y)),
        Claim::Unbounded => engine.direction().map(|x| form.direction(instance, &x)),
        _ => None,
    };
    let point = run.point.unwrap_or_else(|| zero(&form.problem));
    let (level, row_marginal, column_marginal) = form.point(instance, &point);
    Ok(Outcome {
        level,
        row_marginal,
        column_marginal,
        claim,
        status,
        iterations,
        solver: NAME,
        ray: ray.unwrap_or_default(),
        message: None,
        basis: None,
    })
}

/// A convex quadratic program; of its Hessian the upper triangle by columns.
fn quadratic(problem: &Problem, hessian: &Sparse, _: f64, budget: &Budget) -> interior::Run {
    let engine = Engine::new(problem, &[], Some(hessian));
    let run = engine.map(|engine| engine.run(budget, false, &|v| v));
    let ended = match run.as_ref().map_or(Status::Failed, |run| run.status) {
        Status::Optimal => Ended::Solved,
        Status::Infeasible => Ended::Infeasible(Vec::new()),
        Status::Unbounded => Ended::Unbounded(Vec::new()),
        Status::Stopped(stop) => stop.into(),
        Status::Nodes | Status::Failed => Ended::Failed,
    };
    interior::Run {
        ended,
        iterations: run.as_ref().map_or(0, |run| run.iterations),
        point: run
            .and_then(|run| run.point)
            .unwrap_or_else(|| zero(problem)),
        almost: false,
    }
}

fn zero(problem: &Problem) -> Point {
    Point {
        x: vec![0.0; problem.n()],
        y: vec![0.0; problem.m()],
        d: vec![0.0; problem.n()],
    }
}
