//! Linear programs: form, scaling, interior point, simplex finish, and the way back.
//!
//! [`Form`] takes an instance apart, [`Scaling`] changes the units, Clarabel finds the optimum,
//! and the point returns the same way. See the modules for the mathematics.

pub mod certify;
pub mod crossover;
pub mod form;
pub mod interior;
pub mod least;
pub mod scale;
pub mod simplex;

use std::time::Instant;

use super::noise;
use super::{Claim, Monitor, Outcome, Settings, SolveError, Solver, SolverStatus};
use crate::model::instance::Instance;
use form::{Form, Point, Problem};
use interior::Aim;
use scale::Scaling;
use simplex::{Basis, Simplex};

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

impl Ended {
    /// For the log.
    fn word(&self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Infeasible(_) => "infeasible",
            Self::Unbounded(_) => "unbounded",
            Self::Iterations => "iteration limit",
            Self::Time => "time limit",
            Self::Interrupted => "interrupted",
            Self::Failed => "stuck",
        }
    }
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
    /// Those that the settings give a solve that began then.
    pub fn of(settings: &Settings, start: Instant) -> Self {
        Self {
            start,
            seconds: settings.time_limit,
            iterations: settings.iteration_limit,
        }
    }

    /// Seconds left.
    pub fn seconds_left(&self) -> f64 {
        (self.seconds - self.start.elapsed().as_secs_f64()).max(0.0)
    }

    /// A line of the log that ends with the seconds so far.
    pub(super) fn log(&self, monitor: &mut dyn Monitor, line: &str) {
        let seconds = self.start.elapsed().as_secs_f64();
        monitor.log(&format!("{line}, {seconds:.2} s"));
    }
}

/// The solver of linear programs, `option lp = clarabel`: small programs by the simplex method,
/// larger ones by Clarabel's interior-point method and a finish by the simplex method.
///
/// Options: `method` = `auto`, `interior`, `simplex`, `crossover`; `tolerance` of the interior point;
/// `lp_accuracy` = `fast`, `standard`, `high` or a tolerance (see [`Accuracy`]).
#[derive(Clone, Copy, Debug, Default)]
pub struct Clarabel;

/// The simplex method from a basis that may be optimal: states of the instance's columns and rows. Where it
/// leads nowhere, as [`Clarabel`].
pub struct Restart {
    /// A state for each column.
    pub columns: Basis,
    /// A state for each row.
    pub rows: Basis,
}

/// How many digits are wanted, `option lp_accuracy`.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Accuracy {
    /// An interior point of this tolerance, or a vertex to the usual tolerances of 1e-9: digits that
    /// a residual times the sum of all multipliers leaves.
    Fast(f64),
    /// A vertex whose bounds and signs hold to 1e-13: a relative error of the objective ≤ 1e-9.
    Standard,
    /// As near to rounding as the basis allows.
    High,
}

impl Accuracy {
    /// From the options; a tolerance above 1e-9 is fast, below 1e-12 high.
    fn new(settings: &Settings) -> Result<Self, SolveError> {
        let Some(text) = settings.option("lp_accuracy") else {
            return Ok(Self::Standard);
        };
        match (text.as_str(), text.parse::<f64>()) {
            ("fast", _) => Ok(Self::Fast(1e-8)),
            ("standard", _) => Ok(Self::Standard),
            ("high", _) => Ok(Self::High),
            (_, Ok(t)) if t > 1e-9 && t < 1.0 => Ok(Self::Fast(t)),
            (_, Ok(t)) if (1e-12..=1e-9).contains(&t) => Ok(Self::Standard),
            (_, Ok(t)) if t > 0.0 && t < 1e-12 => Ok(Self::High),
            _ => Err(SolveError::new(format!(
                "the option `lp_accuracy` takes `fast`, `standard`, `high` or a tolerance, not \
                     `{text}`"
            ))),
        }
    }
}

/// Which way to go.
#[derive(Clone, Copy)]
enum Method<'a> {
    Auto,
    Interior,
    Crossover,
    Simplex,
    Restart(&'a Restart),
}

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
        let method = match settings.option("method").as_deref() {
            Some("interior") => Method::Interior,
            Some("crossover") => Method::Crossover,
            Some("simplex") => Method::Simplex,
            _ => Method::Auto,
        };
        solve(instance, settings, monitor, method)
    }
}

impl Solver for Restart {
    fn name(&self) -> &'static str {
        "simplex"
    }

    fn solve(
        &self,
        instance: &Instance,
        settings: &Settings,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, SolveError> {
        solve(instance, settings, monitor, Method::Restart(self))
    }
}

/// What a way gave, in the units of the scaled problem.
struct Answer {
    point: Point,
    ended: Ended,
    iterations: u64,
    solver: &'static str,
    almost: bool,
    /// What is not unique about the solution.
    remark: Option<&'static str>,
    /// Of a vertex.
    basis: Option<Basis>,
}

fn solve(
    instance: &Instance,
    settings: &Settings,
    monitor: &mut dyn Monitor,
    method: Method,
) -> Result<Outcome, SolveError> {
    if !instance.is_linear() {
        return Err(SolveError::new(
            "the model has nonlinear terms; this solver takes linear models",
        ));
    }
    let limits = Limits::of(settings, Instant::now());
    let accuracy = Accuracy::new(settings)?;
    let tolerance = settings
        .option("tolerance")
        .and_then(|t| t.parse::<f64>().ok());
    let tolerance = tolerance.filter(|t| *t > 0.0 && *t < 1.0);
    let form = Form::new(instance)?;
    let scaling = Scaling::new(&form.problem);
    let scaled = scaling.apply(&form.problem);
    limits.log(monitor, "scaling");
    let small = scaled.m() + scaled.n() <= SMALL;
    let answer = match (method, accuracy) {
        (Method::Interior, _) => {
            let aim = Aim::Tolerance(tolerance.unwrap_or(1e-10));
            interior_only(&scaled, aim, &limits, monitor)
        }
        (Method::Auto, Accuracy::Fast(t)) if !small => {
            let answer = interior_only(&scaled, Aim::Tolerance(t), &limits, monitor);
            match answer.ended {
                // Whatever is no solution is looked at more closely.
                Ended::Solved | Ended::Time | Ended::Interrupted => answer,
                _ => finished(&scaled, accuracy, &limits, monitor),
            }
        }
        (Method::Crossover, _) => finished(&scaled, accuracy, &limits, monitor),
        (Method::Simplex, _) => simplex_only(&scaled, accuracy, &limits, monitor),
        (Method::Auto, _) => auto(&scaled, accuracy, &limits, monitor),
        (Method::Restart(from), _) => {
            let columns = form.columns.iter().map(|&j| from.columns[j as usize]);
            let rows = form.rows.iter().map(|&i| from.rows[i as usize]);
            let basis = columns.chain(rows).collect();
            restarted(&scaled, &basis, accuracy, &limits, monitor)
        }
    };
    let (claim, status) = match answer.ended {
        Ended::Solved if answer.almost => (Claim::Unfinished, SolverStatus::TerminatedBySolver),
        Ended::Solved => (Claim::Solved, SolverStatus::NormalCompletion),
        Ended::Infeasible(_) => (Claim::Infeasible, SolverStatus::NormalCompletion),
        Ended::Unbounded(_) => (Claim::Unbounded, SolverStatus::NormalCompletion),
        Ended::Iterations => (Claim::Unfinished, SolverStatus::IterationInterrupt),
        Ended::Time => (Claim::Unfinished, SolverStatus::ResourceInterrupt),
        Ended::Interrupted => (Claim::Unfinished, SolverStatus::UserInterrupt),
        Ended::Failed => (Claim::Unfinished, SolverStatus::TerminatedBySolver),
    };
    let ray = match answer.ended {
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
    let mut point = scaling.restore(answer.point);
    noise::snap(&mut point.x, &form.problem.lower, &form.problem.upper);
    let (level, row_marginal, column_marginal) = form.point(instance, &point);
    Ok(Outcome {
        level,
        row_marginal,
        column_marginal,
        claim,
        status,
        iterations: answer.iterations,
        solver: answer.solver,
        ray,
        message: answer.remark.map(str::to_string),
        basis: answer.basis,
    })
}

/// Whether the simplex method must stop.
fn watch<'a>(
    limits: &'a Limits,
    monitor: &'a mut dyn Monitor,
) -> impl FnMut(u64) -> Option<Ended> + 'a {
    move |iterations| {
        if monitor.interrupted() {
            Some(Ended::Interrupted)
        } else if iterations >= limits.iterations {
            Some(Ended::Iterations)
        } else if limits.seconds_left() <= 0.0 {
            Some(Ended::Time)
        } else {
            None
        }
    }
}

fn simplex_only(
    p: &Problem,
    accuracy: Accuracy,
    limits: &Limits,
    monitor: &mut dyn Monitor,
) -> Answer {
    let mut simplex = Simplex::new(p);
    let ended = simplex.solve(&mut watch(limits, monitor));
    if ended == Ended::Solved {
        tighten(&mut simplex, accuracy, limits, monitor);
    }
    simplex_answer(simplex, ended)
}

fn restarted(
    p: &Problem,
    basis: &Basis,
    accuracy: Accuracy,
    limits: &Limits,
    monitor: &mut dyn Monitor,
) -> Answer {
    let cut = Limits {
        iterations: limits.iterations.min((100 + p.m() + p.n()) as u64),
        ..*limits
    };
    let mut simplex = Simplex::new(p);
    let ended = simplex.solve_from_basis(basis, &mut watch(&cut, monitor));
    if ended != Ended::Solved {
        return auto(p, accuracy, limits, monitor);
    }
    let line = format!("simplex: solved after {} iterations", simplex.iterations);
    limits.log(monitor, &line);
    tighten(&mut simplex, accuracy, limits, monitor);
    simplex_answer(simplex, ended)
}

fn tighten(simplex: &mut Simplex, accuracy: Accuracy, limits: &Limits, monitor: &mut dyn Monitor) {
    if matches!(accuracy, Accuracy::Fast(_)) {
        return;
    }
    let before = simplex.iterations;
    let mut tight = simplex.tighten(&mut watch(limits, monitor));
    if accuracy == Accuracy::High {
        let finest = [(1e-14, 1e-13), (1e-14, 1e-14)];
        tight &= simplex.tighten_to(&finest, &mut watch(limits, monitor));
    }
    let pivots = simplex.iterations - before;
    let word = if tight { "" } else { "not " };
    let line = format!("tightened after {pivots} pivots: {word}to rounding");
    limits.log(monitor, &line);
}

fn simplex_answer(mut simplex: Simplex, ended: Ended) -> Answer {
    let point = simplex.point();
    let others = match (&ended, &point) {
        (Ended::Solved, Some(_)) => simplex.others(),
        _ => (false, false),
    };
    let basis = (ended == Ended::Solved).then(|| simplex.basis());
    Answer {
        ended: if point.is_none() {
            Ended::Failed
        } else {
            ended
        },
        point: point.unwrap_or_default(),
        iterations: simplex.iterations,
        solver: "simplex",
        almost: false,
        basis,
        remark: match others {
            (true, true) => Some("neither the solution nor its marginals are unique"),
            (true, false) => Some("the solution is not unique"),
            (false, true) => Some("the marginals are not unique"),
            (false, false) => None,
        },
    }
}

fn interior_only(p: &Problem, aim: Aim, limits: &Limits, monitor: &mut dyn Monitor) -> Answer {
    let run = match trivial(p) {
        Some(run) => run,
        None => interior::solve(p, None, aim, limits, &mut || monitor.interrupted()),
    };
    Answer {
        point: run.point,
        ended: run.ended,
        iterations: run.iterations,
        solver: "clarabel",
        almost: run.almost,
        remark: None,
        basis: None,
    }
}

/// Columns and rows together up to which the simplex method is tried first.
const SMALL: usize = 600;

/// Columns and rows together from which an interior point of many digits saves more pivots than it costs.
const LARGE: usize = 3000;

/// Small programs by the simplex method, others by the interior point and its finish; where one
/// fails the other is tried.
fn auto(p: &Problem, accuracy: Accuracy, limits: &Limits, monitor: &mut dyn Monitor) -> Answer {
    if p.m() + p.n() > SMALL {
        return finished(p, accuracy, limits, monitor);
    }
    let mut simplex = Simplex::new(p);
    let effort = 1000 + 20 * (p.m() + p.n()) as u64;
    let cut = Limits {
        iterations: limits.iterations.min(effort),
        ..*limits
    };
    let ended = simplex.solve(&mut watch(&cut, monitor));
    let stuck =
        ended == Ended::Failed || (ended == Ended::Iterations && effort < limits.iterations);
    if stuck {
        return finished(p, accuracy, limits, monitor);
    }
    if ended == Ended::Solved {
        tighten(&mut simplex, accuracy, limits, monitor);
    }
    simplex_answer(simplex, ended)
}

/// Interior point, then a basis from it, then the simplex method.
fn finished(p: &Problem, accuracy: Accuracy, limits: &Limits, monitor: &mut dyn Monitor) -> Answer {
    let aim = match p.m() + p.n() > LARGE {
        true => Aim::Digits,
        false => Aim::Tolerance(1e-10),
    };
    let mut answer = interior_only(p, aim, limits, monitor);
    let mut simplex = Simplex::new(p);
    let mut cut = *limits;
    match answer.ended {
        Ended::Solved => {
            let wide = crossover::is_wide(p, &answer.point);
            let of_face = wide.then(|| {
                let face = crossover::face(p, &answer.point);
                interior_only(&face, Aim::Tolerance(1e-10), limits, monitor)
            });
            let of_face = of_face.filter(|f| f.ended == Ended::Solved);
            if let Some(f) = &of_face {
                answer.iterations += f.iterations;
            }
            let word = if of_face.is_some() {
                ", face included"
            } else {
                ""
            };
            let line = format!("interior point: {} iterations{word}", answer.iterations);
            limits.log(monitor, &line);
            let of_face = of_face.as_ref().map(|f| &f.point);
            let start = crossover::start(p, &answer.point, of_face);
            let end = simplex.push(&start, &mut watch(limits, monitor));
            let count = simplex.iterations;
            let word = if end.is_ok() { "" } else { ", incomplete" };
            let outside = simplex.violation();
            let line = format!("crossover: {count} pushes{word}, bounds hold to {outside:.0e}");
            limits.log(monitor, &line);
        }
        // A direction is no point: the simplex method finds one from which it leads on.
        Ended::Unbounded(_) | Ended::Failed => {}
        Ended::Infeasible(ref y) if p.proves_infeasible(y) => return answer,
        // An exact proof is worth some effort.
        Ended::Infeasible(_) => {
            cut.iterations = cut.iterations.min(1000 + 2 * (p.m() + p.n()) as u64);
        }
        _ => return answer,
    }
    let ended = simplex.solve(&mut watch(&cut, monitor));
    let pivots = simplex.iterations;
    let line = format!("simplex: {} after {pivots} iterations in all", ended.word());
    limits.log(monitor, &line);
    let useful = matches!(
        ended,
        Ended::Solved | Ended::Infeasible(_) | Ended::Unbounded(_)
    );
    if !useful {
        let cut_short = matches!(ended, Ended::Interrupted | Ended::Time | Ended::Iterations);
        if answer.ended == Ended::Solved && cut_short {
            // The interior point is still the best there is.
            answer.ended = ended;
        }
        return answer;
    }
    if ended == Ended::Solved {
        tighten(&mut simplex, accuracy, limits, monitor);
    }
    let mut done = simplex_answer(simplex, ended);
    if done.ended == Ended::Failed {
        return answer;
    }
    done.iterations += answer.iterations;
    done.solver = "clarabel";
    done
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
mod random;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::conformance;

    fn conforms(method: &str, tolerance: f64) {
        let mut settings = Settings::default();
        settings.options.push(("method".into(), method.into()));
        conformance::suite_with(&Clarabel, &settings, tolerance);
    }

    #[test]
    fn interior_point_conforms() {
        conforms("interior", 2e-7);
    }

    #[test]
    fn simplex_conforms() {
        conforms("simplex", 1e-12);
    }

    #[test]
    fn crossover_conforms() {
        conforms("crossover", 1e-12);
    }

    #[test]
    fn default_conforms() {
        conformance::suite(&Clarabel, 1e-12);
    }
}
