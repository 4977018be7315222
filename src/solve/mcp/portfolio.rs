//! The start, the restarts, and the verdict.
//!
//! Where the path from the given start fails, it is followed from random ones: problems that are linear and not monotone
//! (bimatrix games) often yield to one path from the right start.

use super::log;
use super::majors::{Crash, INTERIOR, majors};
use super::merit::natural_residual;
use super::random::Random;
use super::run::{Point, Run, Stop, bound};
use super::{Names, Outcome, Problem, Settings, Status};
use crate::solve::Budget;
use crate::solve::strategy::Strategy;

/// See [`super::solve`].
pub(super) fn solve(
    problem: &mut dyn Problem,
    settings: &Settings,
    budget: &Budget,
    names: Names,
) -> Outcome {
    if let Some(outcome) = invalid(problem) {
        return outcome;
    }
    let statistics = budget.wants_log();
    let mut run = Run::new(problem, settings, budget, names);
    if statistics {
        let line = format!(
            "{} variables, {} nonzeros; {} variables are not fixed",
            run.problem.total(),
            run.problem.total_nonzeros(),
            run.n
        );
        budget.log(&line);
    }
    let mut restarts = 0;
    let end = search(&mut run, &mut restarts);
    let mut outcome = Outcome {
        majors: run.majors,
        pivots: run.pivots,
        crash_iterations: run.crash_iterations,
        factorisations: run.factorisations,
        restarts,
        evaluations: run.evaluations + 1,
        ..Outcome::at(Vec::new(), Status::NoSolution)
    };
    let evaluated = run.best.is_some();
    let error = run.last_error.take();
    let start = &run.problem.data.start;
    let mut x = run.best.take().map_or_else(|| start.clone(), |best| best.x);
    run.clip(&mut x);
    let x = run.problem.postsolve(&x);
    let worst = judge(problem, x, settings, end, evaluated, &mut outcome);
    if let (Some(error), true) = (error, outcome.status == Status::EvaluationFailed) {
        let at = error
            .row
            .map_or(String::new(), |row| format!("row {}: ", names(row)));
        outcome.message = format!("{at}{}", error.message);
    }
    if statistics {
        let at = worst.map_or(String::new(), |i| format!(" ({})", names(i)));
        let line = format!(
            "{:?}: residual {:.2e}{at}; majors {}, pivots {}, crash {}, factorisations {}",
            outcome.status,
            outcome.residual,
            outcome.majors,
            outcome.pivots,
            outcome.crash_iterations,
            outcome.factorisations
        );
        budget.log(&line);
    }
    outcome
}

/// Random restarts at most.
const RESTARTS: usize = 30;
/// Work ([`Run::work`]) up to which they are made in any case: 0.6 s or so.
const CHEAP: usize = 200_000;
/// Otherwise all work may become this multiple of that from the given start.
const MULTIPLE: usize = 2;

/// The verdict: a fresh F at x on the problem as given. Returns where the residual is largest.
fn judge(
    problem: &mut dyn Problem,
    x: Vec<f64>,
    settings: &Settings,
    end: Result<(), Stop>,
    evaluated: bool,
    outcome: &mut Outcome,
) -> Option<usize> {
    let mut f = vec![f64::NAN; x.len()];
    let mut worst = None;
    if problem.function(&x, &mut f).is_ok() {
        let bounds = |all: &[f64]| -> Vec<f64> { all.iter().map(|&b| bound(b)).collect() };
        let data = problem.data();
        let (lower, upper) = (bounds(&data.lower), bounds(&data.upper));
        let (residual, at) = natural_residual(&x, &f, &lower, &upper);
        outcome.residual = residual;
        worst = (residual > 0.0).then_some(at);
    }
    let tolerance = settings
        .acceptable_tolerance
        .max(settings.convergence_tolerance);
    outcome.status = if outcome.residual <= tolerance {
        Status::Solved
    } else {
        match end {
            Err(Stop::Time | Stop::Memory) => Status::TimeLimit,
            Err(Stop::Interrupted) => Status::Interrupted,
            Err(Stop::Iterations | Stop::Evaluations) => Status::IterationLimit,
            Ok(()) if !evaluated => Status::EvaluationFailed,
            Ok(()) => Status::NoSolution,
        }
    };
    (outcome.x, outcome.f) = (x, f);
    worst
}

/// Runs the methods until one succeeds; the best point is left in the run. Counts the restarts made.
fn search(run: &mut Run, restarts: &mut usize) -> Result<(), Stop> {
    if run.n == 0 {
        run.point(Vec::new());
        return Ok(());
    }
    run.check()?;
    if let Some(start) = first_point(run) {
        let crashes: &[Crash] = match run.settings.crash_method {
            true if run.n > INTERIOR && run.settings.strategies.run(Strategy::InteriorCrash) => {
                &[Crash::Interior, Crash::Newton]
            }
            true => &[Crash::Newton],
            false => &[Crash::None],
        };
        for &crash in crashes {
            if succeeds(run, crash, start.clone())? {
                return Ok(());
            }
        }
    }
    let acceptable = run.settings.acceptable_tolerance;
    if run.best.as_ref().is_some_and(|b| b.residual <= acceptable)
        || !run.settings.strategies.run(Strategy::RandomRestarts)
    {
        return Ok(());
    }
    let budget = match run.settings.restart_limit {
        Some(_) => usize::MAX,
        None => CHEAP.max(MULTIPLE * run.work()),
    };
    let mut random = Random::new(20);
    for k in 0..run.settings.restart_limit.unwrap_or(RESTARTS) {
        *restarts += 1;
        let spread = 10f64.powf(random.between(-2.0, 1.0));
        let x = random_point(run, &mut random, spread);
        log::note(run, || format!("Restart {} from a random point", k + 1));
        let Some(start) = run.point(x) else { continue };
        if run.work() > budget || succeeds(run, Crash::Newton, start)? {
            return Ok(());
        }
    }
    Ok(())
}

/// Follows the path from a start. Whether it ended at a solution.
fn succeeds(run: &mut Run, crash: Crash, start: Point) -> Result<bool, Stop> {
    majors(run, start, crash)?;
    let Some(best) = run.best.clone() else {
        return Ok(false);
    };
    if !run.converged(best.residual) {
        return Ok(false);
    }
    // Slightly outside of the bounds the residual may be small though it is not within them (where multipliers grow without
    // limit). Only a point inside counts.
    let mut x = best.x;
    run.clip(&mut x);
    run.best = None;
    Ok(run.point(x).is_some_and(|p| run.converged(p.residual)))
}

/// The start within the bounds, or a point near it where F is defined.
fn first_point(run: &mut Run) -> Option<Point> {
    let mut x = run.problem.data.start.clone();
    // A start that is no number says nothing.
    x.iter_mut()
        .filter(|v| !v.is_finite())
        .for_each(|v| *v = 0.0);
    run.clip(&mut x);
    let defined = |run: &mut Run, x: Vec<f64>| {
        let point = run.point(x)?;
        run.jacobian(&point.x).map(|_| point)
    };
    if let Some(point) = defined(run, x.clone()) {
        return Some(point);
    }
    let mut random = Random::new(3);
    for k in 0..8 {
        let size = 10f64.powf(-3.0 + 0.5 * f64::from(k));
        let mut y: Vec<f64> = x.iter().map(|x| x + size * random.uniform()).collect();
        run.clip(&mut y);
        if let Some(point) = defined(run, y) {
            log::note(run, || {
                "F is not defined at the start; starting near it".into()
            });
            return Some(point);
        }
    }
    None
}

/// l + s·random where l is finite, u − s·random where only u is, else about the start.
fn random_point(run: &Run, random: &mut Random, spread: f64) -> Vec<f64> {
    let start = &run.problem.data.start;
    let mut x: Vec<f64> = (0..run.n)
        .map(|i| {
            let (l, u) = (run.lower[i], run.upper[i]);
            if l.is_finite() {
                l + spread * random.uniform()
            } else if u.is_finite() {
                u - spread * random.uniform()
            } else {
                start[i] + spread * random.between(-1.0, 1.0)
            }
        })
        .collect();
    run.clip(&mut x);
    x
}

/// An outcome for problems that make no sense.
fn invalid(problem: &dyn Problem) -> Option<Outcome> {
    let data = problem.data();
    let n = data.lower.len();
    let (start, rows) = (&data.column_start, &data.rows);
    let consistent = data.upper.len() == n
        && data.start.len() == n
        && start.len() == n + 1
        && start.first() == Some(&0)
        && start.last() == Some(&rows.len())
        && start
            .windows(2)
            .all(|w| w[0] <= w[1] && rows[w[0]..w[1].max(w[0])].windows(2).all(|r| r[0] < r[1]))
        && rows.iter().all(|&i| i < n);
    let crossed = || {
        (0..n).find(|&i| {
            let (l, u) = (bound(data.lower[i]), bound(data.upper[i]));
            l.is_nan() || u.is_nan() || l > u || l == f64::INFINITY || u == f64::NEG_INFINITY
        })
    };
    let (status, message) = if !consistent {
        (
            Status::InvalidProblem,
            "the problem's arrays contradict each other".to_string(),
        )
    } else if let Some(i) = crossed() {
        let (l, u) = (data.lower[i], data.upper[i]);
        (
            Status::InvalidBounds,
            format!("variable {}: lower bound {l} and upper bound {u}", i + 1),
        )
    } else {
        return None;
    };
    Some(Outcome {
        message,
        ..Outcome::at(data.start.clone(), status)
    })
}
