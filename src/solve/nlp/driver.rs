//! From an instance to a certified answer, with any provider.
//!
//! The provider is asked first with ordinary options from the person's own start point. What comes
//! back is judged by the KKT residuals of the instance, not by the provider's word:
//!
//! * a point that satisfies them is looked at once more: negative curvature on the tangent space of
//!   what is active shows a saddle, which is left along that direction and solved again;
//! * anything else is tried again with other options and starts (see [`SCHEDULE`]), at last in
//!   elastic form, which copes with dependent equations and with more equations than variables;
//! * a claim of infeasibility or unboundedness must show in the point.
//!
//! The first certified point wins. Where there is none, the best point that was seen is returned, and
//! called what it is.

use super::curvature::negative_curvature;
use super::elastic::Elastic;
use super::problem::{Nlp, Problem};
use super::provider::{Control, Ended, Progress, Provider, Shared, Solution, lock};
use crate::autodiff::{ErrorKind, EvalFailure};
use crate::model::certificate::{Linearised, Residuals, TOLERANCE};
use crate::model::certificate_nlp::{is_locally_infeasible, kkt_residual};
use crate::model::instance::{Instance, Relation, Sense};
use crate::solve::{
    Claim, ModelStatus, Monitor, Outcome, Settings, SolveError, SolverStatus, answer::Answer,
};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// An objective better than this, at a feasible point, is called unbounded (GAMS's solvers: 1e15).
const UNBOUNDED: f64 = 1e15;
/// A point is unbounded evidence from here on, if the provider stopped with diverging iterates.
const LARGE: f64 = 1e10;

/// Options of every attempt; the person's own come after them.
const BASE: [(&str, &str); 8] = [
    ("tol", "1e-9"),
    ("constr_viol_tol", "1e-9"),
    ("dual_inf_tol", "1e-6"),
    ("compl_inf_tol", "1e-8"),
    ("acceptable_tol", "1e-7"),
    ("acceptable_dual_inf_tol", "1e-4"),
    ("honor_original_bounds", "yes"),
    ("diverging_iterates_tol", "1e18"),
];

/// Where an attempt starts.
#[derive(Clone, Copy, PartialEq, Debug)]
enum From {
    /// The person's start point.
    Start,
    /// The best point so far.
    Best,
    /// The person's start, moved by this fraction of its size (and at least by this much).
    Moved(f64),
}

/// What to try when an attempt has not led to a certified point.
const SCHEDULE: [(From, &[(&str, &str)]); 5] = [
    (
        From::Start,
        &[("mu_strategy", "adaptive"), ("bound_relax_factor", "0")],
    ),
    (From::Moved(0.1), &[]),
    (
        From::Best,
        &[
            ("nlp_scaling_method", "none"),
            ("bound_push", "1e-6"),
            ("bound_frac", "1e-6"),
            ("mu_init", "1e-4"),
        ],
    ),
    (
        From::Start,
        &[
            ("bound_push", "1e-4"),
            ("bound_frac", "1e-4"),
            ("mu_init", "1e-2"),
            ("alpha_for_y", "safer-min-dual-infeas"),
        ],
    ),
    (From::Moved(1.0), &[("mu_strategy", "adaptive")]),
];

/// A point that was judged.
#[derive(Clone)]
struct Trial {
    x: Vec<f64>,
    lambda: Vec<f64>,
    level: Vec<f64>,
    row_marginal: Vec<f64>,
    at: Linearised,
    residuals: Residuals,
    ended: Ended,
    /// Minimised.
    objective: f64,
}

impl Trial {
    fn is_optimal(&self) -> bool {
        self.residuals.is_feasible(TOLERANCE) && self.residuals.dual_relative <= TOLERANCE
    }

    fn is_feasible(&self) -> bool {
        self.residuals.is_feasible(TOLERANCE)
    }

    /// Whether this one is worth more than the other.
    fn better(&self, other: &Self) -> bool {
        let rank = |t: &Self| u8::from(t.is_optimal()) + u8::from(t.is_feasible());
        let (a, b) = (rank(self), rank(other));
        if a != b {
            return a > b;
        }
        if a == 0 {
            return self.residuals.primal_relative < other.residuals.primal_relative;
        }
        self.objective < other.objective
    }
}

/// Solves an instance and certifies the answer.
pub fn solve(
    instance: &Instance,
    provider: &dyn Provider,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<Answer, SolveError> {
    let columns = &instance.columns;
    for j in 0..instance.column_count() {
        let (l, u) = (columns.lower[j], columns.upper[j]);
        if l > u || l.is_nan() || u.is_nan() {
            return Err(SolveError {
                message: format!("the lower bound {l} is above the upper bound {u}"),
                row: None,
                column: Some(j),
            });
        }
    }
    let mut problem = Problem::new(instance);
    let wants_marginals = settings
        .options
        .iter()
        .any(|(k, v)| k.eq_ignore_ascii_case("warm_start_init_point") && v == "yes");
    if wants_marginals {
        problem.use_marginals(instance);
    }
    let start = problem.start().to_vec();
    check_start(instance, &mut problem, &start)?;
    let mut driver = Driver {
        instance,
        provider,
        settings,
        monitor,
        start,
        problem: Arc::new(Mutex::new(problem)),
        begin: Instant::now(),
        iterations: 0,
        stopped: None,
        best: None,
    };
    driver.run()
}

/// The start point must have values; derivatives may be missing there.
fn check_start(
    instance: &Instance,
    problem: &mut Problem,
    start: &[f64],
) -> Result<(), SolveError> {
    let mut level = problem.levels(start);
    // `levels` computes the objective column from the rows: it may have failed already
    let mut activity = vec![0.0; instance.row_count()];
    if let Some(o) = instance.objective
        && !level[o.column as usize].is_finite()
    {
        level[o.column as usize] = 0.0;
    }
    match problem.evaluator().rows(&level, &mut activity) {
        Err(e) if e.error.kind != ErrorKind::Overflow => Err(start_failure(&e)),
        _ => Ok(()),
    }
}

fn start_failure(e: &EvalFailure) -> SolveError {
    SolveError {
        message: format!("a function cannot be evaluated at the start point: {e}"),
        row: Some(e.row as usize),
        column: e.column.map(|j| j as usize),
    }
}

struct Driver<'a> {
    instance: &'a Instance,
    provider: &'a dyn Provider,
    settings: &'a Settings,
    monitor: &'a mut dyn Monitor,
    start: Vec<f64>,
    problem: Arc<Mutex<Problem>>,
    begin: Instant,
    iterations: u64,
    /// Why no further attempt may be made.
    stopped: Option<SolverStatus>,
    best: Option<Trial>,
}

impl Driver<'_> {
    fn run(&mut self) -> Result<Answer, SolveError> {
        let (n, m) = lock(&*self.problem).size();
        if n == 0 || m == 0 && self.is_constant() {
            let x = self.start.clone();
            let trial = self.judge(x, vec![0.0; m], Ended::Solved);
            self.keep(trial);
            return Ok(self.finish());
        }
        let first = Instant::now();
        self.attempt(From::Start, &[])?;
        let spent = first.elapsed();
        self.leave_saddles()?;
        if !self.is_settled() {
            for (from, options) in SCHEDULE {
                if self.is_settled() || self.out_of_patience(spent) {
                    break;
                }
                self.attempt(from, options)?;
                self.leave_saddles()?;
            }
        }
        if !self.is_settled() && !self.out_of_patience(spent) {
            self.attempt_elastic()?;
            self.leave_saddles()?;
        }
        Ok(self.finish())
    }

    fn is_constant(&self) -> bool {
        use super::problem::ObjectiveForm::{Constant, Nothing};
        matches!(lock(&*self.problem).form(), Nothing | Constant)
    }

    /// Nothing more needs to be tried.
    fn is_settled(&self) -> bool {
        self.stopped.is_some()
            || self
                .best
                .as_ref()
                .is_some_and(|t| t.is_optimal() || self.is_unbounded(t))
    }

    fn is_unbounded(&self, t: &Trial) -> bool {
        t.is_feasible() && !t.is_optimal() && t.objective < -LARGE && {
            t.objective < -UNBOUNDED / 10.0 || t.ended == Ended::Diverging
        }
    }

    /// Long problems are not tried as often as short ones.
    fn out_of_patience(&self, first: Duration) -> bool {
        let spent = self.begin.elapsed();
        spent > Duration::from_secs(60) && spent > 4 * first
    }

    fn deadline(&self) -> Option<Instant> {
        (self.settings.time_limit < 1e9)
            .then(|| self.begin + Duration::from_secs_f64(self.settings.time_limit.max(0.0)))
    }

    fn start_point(&self, from: From) -> Vec<f64> {
        match (from, &self.best) {
            (From::Best, Some(best)) => best.x.clone(),
            (From::Moved(by), _) => {
                let problem = lock(&*self.problem);
                let (lower, upper) = problem.bounds();
                let mut seed = 12345u64;
                self.start
                    .iter()
                    .zip(lower.iter().zip(upper))
                    .map(|(&x, (&l, &u))| {
                        seed = seed
                            .wrapping_mul(6_364_136_223_846_793_005)
                            .wrapping_add(1_442_695_040_888_963_407);
                        let r = (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
                        (x + 2.0 * r * by * x.abs().max(1.0)).max(l).min(u)
                    })
                    .collect()
            }
            _ => self.start.clone(),
        }
    }

    /// One run of the provider, judged and kept if it is the best so far.
    fn attempt(&mut self, from: From, extra: &[(&str, &str)]) -> Result<(), SolveError> {
        let x = self.start_point(from);
        self.attempt_from(x, extra)
    }

    fn attempt_from(&mut self, x: Vec<f64>, extra: &[(&str, &str)]) -> Result<(), SolveError> {
        lock(&*self.problem).set_start(x);
        let shared: Shared = self.problem.clone();
        let solution = self.call(shared, extra)?;
        if solution.ended == Ended::TooFewDegrees && self.stopped.is_none() {
            return self.attempt_elastic();
        }
        let trial = self.judge(solution.x, solution.lambda, solution.ended);
        self.keep(trial);
        Ok(())
    }

    fn attempt_elastic(&mut self) -> Result<(), SolveError> {
        let start = self.start.clone();
        for (rho, weight) in [(1e3, 1.0), (1e6, 1.0), (1.0, 0.0)] {
            lock(&*self.problem).set_start(start.clone());
            let elastic = Elastic::new(self.problem.clone(), rho, weight);
            let n = elastic.original_variables();
            let solution = self.call(Arc::new(Mutex::new(elastic)), &[])?;
            if self.stopped.is_some() {
                break;
            }
            let mut x = solution.x;
            x.truncate(n);
            let ended = if weight == 0.0 && solution.ended == Ended::Solved {
                // a minimum of the violation: a point of local infeasibility, unless it is 0
                Ended::Infeasible
            } else {
                solution.ended
            };
            let trial = self.judge(x, solution.lambda, ended);
            let optimal = trial.is_optimal();
            self.keep(trial);
            if optimal {
                break;
            }
        }
        Ok(())
    }

    fn call(&mut self, nlp: Shared, extra: &[(&str, &str)]) -> Result<Solution, SolveError> {
        let mut options: Vec<(String, String)> = Vec::new();
        let mut put = |k: &str, v: &str| {
            options.retain(|(old, _)| !old.eq_ignore_ascii_case(k));
            options.push((k.to_string(), v.to_string()));
        };
        for (k, v) in BASE.iter().chain(extra) {
            put(k, v);
        }
        for (k, v) in &self.settings.options {
            if !is_for_others(k) {
                put(k, v);
            }
        }
        let left = self
            .settings
            .iteration_limit
            .saturating_sub(self.iterations);
        let cap = if options.iter().any(|(k, _)| k == "max_iter") {
            u64::MAX
        } else {
            3000
        };
        let deadline = self.deadline();
        let (monitor, log) = (&mut *self.monitor, self.settings.log);
        let limit = self.settings.evaluation_error_limit;
        let mut stopped = None;
        let mut header = log;
        let mut watch = |p: &Progress| {
            if header {
                header = false;
                monitor.log("   iter       objective     primal       dual         mu      step");
            }
            if log {
                monitor.log(&format!(
                    "{:>7}{} {:>15.8e} {:>10.2e} {:>10.2e} {:>10.2e} {:>9.2e}",
                    p.iteration,
                    if p.restoration { 'r' } else { ' ' },
                    p.objective,
                    p.primal,
                    p.dual,
                    p.mu,
                    p.step
                ));
            }
            if monitor.interrupted() {
                stopped = Some(SolverStatus::UserInterrupt);
            } else if deadline.is_some_and(|d| Instant::now() > d) {
                stopped = Some(SolverStatus::ResourceInterrupt);
            } else if limit > 0 && lock(&*nlp).failures() > limit {
                stopped = Some(SolverStatus::EvaluationInterrupt);
            }
            let unbounded = p.objective < -UNBOUNDED && p.primal < 1e-3 && !p.restoration;
            stopped.is_none() && !unbounded
        };
        let mut control = Control {
            options,
            iterations: left.min(cap),
            deadline,
            watch: &mut watch,
        };
        let result = self.provider.solve(nlp.clone(), &mut control);
        let solution = result.map_err(|message| SolveError {
            message,
            row: None,
            column: None,
        })?;
        self.iterations += solution.iterations;
        self.stopped = match solution.ended {
            _ if stopped.is_some() => stopped,
            Ended::Time => Some(SolverStatus::ResourceInterrupt),
            Ended::Iterations if self.iterations >= self.settings.iteration_limit => {
                Some(SolverStatus::IterationInterrupt)
            }
            _ => self.stopped,
        };
        if let Ended::InvalidOption = solution.ended {
            return Err(SolveError {
                message: format!("{} does not take one of the options", self.provider.name()),
                row: None,
                column: None,
            });
        }
        Ok(solution)
    }

    /// Puts a point into the bounds and computes its residuals.
    fn judge(&mut self, mut x: Vec<f64>, lambda: Vec<f64>, ended: Ended) -> Trial {
        let mut problem = lock(&*self.problem);
        {
            let (lower, upper) = problem.bounds();
            for (v, (&l, &u)) in x.iter_mut().zip(lower.iter().zip(upper)) {
                *v = if v.is_nan() {
                    0.0_f64.max(l).min(u)
                } else {
                    v.max(l).min(u)
                };
            }
        }
        let plain = residuals_at(self.instance, &mut problem, x, lambda, ended);
        let tidied = tidy(self.instance, &mut problem, &plain);
        match tidied {
            Some(t) if t.is_optimal() || !plain.is_optimal() => t,
            _ => plain,
        }
    }

    fn keep(&mut self, trial: Trial) {
        let better = match &self.best {
            None => true,
            // a proof of unboundedness is not replaced by a worse point
            Some(old) => {
                !self.is_unbounded(old) && (self.is_unbounded(&trial) || trial.better(old))
            }
        };
        if better {
            self.best = Some(trial);
        }
    }

    /// While the best point is a saddle: follow the negative curvature and solve again.
    fn leave_saddles(&mut self) -> Result<(), SolveError> {
        for _ in 0..3 {
            let Some(best) = self.best.clone().filter(Trial::is_optimal) else {
                return Ok(());
            };
            if self.stopped.is_some() {
                return Ok(());
            }
            let Some(x) = self.beyond_saddle(&best) else {
                return Ok(());
            };
            let before = best.objective;
            self.attempt_from(
                x,
                &[
                    ("mu_init", "1e-3"),
                    ("bound_push", "1e-6"),
                    ("bound_frac", "1e-6"),
                ],
            )?;
            let now = self.best.as_ref().map_or(before, |t| t.objective);
            if now >= before - 1e-9 * before.abs().max(1.0) {
                return Ok(());
            }
        }
        Ok(())
    }

    /// A point beyond the saddle, if the trial is one.
    fn beyond_saddle(&mut self, t: &Trial) -> Option<Vec<f64>> {
        let mut problem = lock(&*self.problem);
        let (lower, upper) = (problem.bounds().0.to_vec(), problem.bounds().1.to_vec());
        let near = |x: f64, b: f64| (x - b).abs() <= 1e-6 * b.abs().max(1.0);
        let fixed: Vec<bool> =
            t.x.iter()
                .zip(lower.iter().zip(&upper))
                .map(|(&x, (&l, &u))| near(x, l) || near(x, u))
                .collect();
        let binding: Vec<bool> = problem
            .rows
            .iter()
            .map(|&i| {
                let (a, b) = (
                    t.at.activity[i as usize],
                    self.instance.rows.rhs[i as usize],
                );
                let size = t.at.row_size[i as usize].max(b.abs()).max(1.0);
                self.instance.rows.relation[i as usize] == Relation::Equal
                    || (a - b).abs() <= 1e-6 * size
            })
            .collect();
        let d = negative_curvature(&mut *problem, &t.x, &t.lambda, &fixed, &binding)?;
        let unit = d.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        let scale = t.x.iter().fold(1.0f64, |s, v| s.max(v.abs()));
        // the first point along ±d that can be evaluated, has a lower objective and is nearly feasible
        for length in [0.1, 0.01, 1e-3] {
            let mut best: Option<(f64, Vec<f64>)> = None;
            for sign in [1.0, -1.0] {
                let y: Vec<f64> = (0..d.len())
                    .map(|j| {
                        let v = t.x[j] + sign * length * scale * d[j] / unit;
                        v.max(lower[j]).min(upper[j])
                    })
                    .collect();
                if let Some(f) = problem.objective(&y)
                    && best.as_ref().is_none_or(|b| f < b.0)
                {
                    best = Some((f, y));
                }
            }
            if let Some((_, y)) = best {
                return Some(y);
            }
        }
        None
    }

    /// Turns the best trial into an answer.
    fn finish(&mut self) -> Answer {
        let best = self.best.take().unwrap_or_else(|| {
            let m = lock(&*self.problem).size().1;
            self.judge(self.start.clone(), vec![0.0; m], Ended::Broken)
        });
        let unbounded = self.is_unbounded(&best);
        let mut problem = lock(&*self.problem);
        let status = if best.is_optimal() {
            ModelStatus::LocallyOptimal
        } else if unbounded {
            ModelStatus::Unbounded
        } else if best.is_feasible() {
            ModelStatus::Feasible
        } else if is_locally_infeasible(self.instance, problem.evaluator(), &best.level, 1e-4) {
            ModelStatus::LocallyInfeasible
        } else {
            ModelStatus::IntermediateInfeasible
        };
        let claim = match status {
            ModelStatus::LocallyOptimal => Claim::Solved,
            ModelStatus::Unbounded => Claim::Unbounded,
            ModelStatus::LocallyInfeasible => Claim::Infeasible,
            _ => Claim::Unfinished,
        };
        let solver_status = match (claim, self.stopped) {
            (Claim::Unfinished, Some(s)) => s,
            (Claim::Unfinished, None) => match best.ended {
                Ended::Iterations => SolverStatus::IterationInterrupt,
                Ended::Broken => SolverStatus::InternalSolverFailure,
                _ => SolverStatus::TerminatedBySolver,
            },
            _ => SolverStatus::NormalCompletion,
        };
        let message = match (status, &problem.last_failure) {
            (ModelStatus::Feasible | ModelStatus::IntermediateInfeasible, Some(f)) => {
                let row = self.monitor.row_name(f.row as usize);
                Some(format!("the last evaluation that failed: {f} in {row}"))
            }
            _ => None,
        };
        Answer {
            outcome: Outcome {
                column_marginal: best.at.reduced.clone(),
                level: best.level,
                row_marginal: best.row_marginal,
                claim,
                status: solver_status,
                iterations: self.iterations,
                solver: if self.provider.name() == "ipopt" {
                    "ipopt"
                } else {
                    "pounce"
                },
                ray: Vec::new(),
                message,
            },
            residuals: best.residuals,
            status,
            activity: best.at.activity,
        }
    }
}

/// Options of other solvers that may stand in the same list.
fn is_for_others(option: &str) -> bool {
    option.eq_ignore_ascii_case("log")
}

fn residuals_at(
    instance: &Instance,
    problem: &mut Problem,
    x: Vec<f64>,
    lambda: Vec<f64>,
    ended: Ended,
) -> Trial {
    let level = problem.levels(&x);
    let row_marginal = problem.row_marginals(&lambda);
    let sign = match instance.objective.map(|o| o.sense) {
        Some(Sense::Maximize) => -1.0,
        _ => 1.0,
    };
    let objective = instance
        .objective
        .map_or(0.0, |o| sign * level[o.column as usize]);
    let (residuals, at) = match kkt_residual(instance, problem.evaluator(), &level, &row_marginal) {
        Ok(both) => both,
        Err(_) => failed(instance, problem, &level),
    };
    Trial {
        x,
        lambda,
        level,
        row_marginal,
        at,
        residuals,
        ended,
        objective,
    }
}

/// Residuals of a point without values or derivatives.
fn failed(instance: &Instance, problem: &mut Problem, level: &[f64]) -> (Residuals, Linearised) {
    let (m, n) = (instance.row_count(), instance.column_count());
    let mut activity = vec![0.0; m];
    let known = problem.evaluator().rows(level, &mut activity).is_ok();
    if !known {
        activity.fill(f64::NAN);
    }
    let row_size = activity
        .iter()
        .map(|a| a.abs().max(1.0))
        .collect::<Vec<_>>();
    let mut residuals = crate::model::certificate::primal(instance, level, &activity, &row_size);
    residuals.dual = None;
    residuals.dual_relative = f64::INFINITY;
    if !known {
        residuals.primal_relative = f64::INFINITY;
    }
    let at = Linearised {
        activity,
        reduced: vec![0.0; n],
        row_size,
        column_size: vec![1.0; n],
    };
    (residuals, at)
}

/// An interior point stops short of the bounds by a hair. Puts such variables on their bounds, and
/// multipliers of slack rows and reduced costs of variables between their bounds to 0.
fn tidy(instance: &Instance, problem: &mut Problem, t: &Trial) -> Option<Trial> {
    let (lower, upper) = (problem.bounds().0.to_vec(), problem.bounds().1.to_vec());
    let mut x = t.x.clone();
    for (k, v) in x.iter_mut().enumerate() {
        let r = t.at.reduced[problem.columns[k] as usize];
        for b in [lower[k], upper[k]] {
            let distance = (*v - b).abs();
            // on the bound if it is near, and nearer than the reduced cost is to 0
            if distance <= 1e-6 * b.abs().max(1.0) && distance <= 1e3 * r.abs() {
                *v = b;
            }
        }
    }
    let mut lambda = t.lambda.clone();
    for (k, l) in lambda.iter_mut().enumerate() {
        let i = problem.rows[k] as usize;
        if instance.rows.relation[i] == Relation::Equal {
            continue;
        }
        let slack = (t.at.activity[i] - instance.rows.rhs[i]).abs();
        if slack > 1e-6 * t.at.row_size[i].max(1.0)
            && l.abs() * t.at.row_size[i].max(1.0) <= 1e-5 * slack
        {
            *l = 0.0;
        }
    }
    let mut tidied = residuals_at(instance, problem, x, lambda, t.ended);
    for j in 0..instance.column_count() {
        let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
        let v = tidied.level[j];
        let inside = v > l && v < u;
        if inside && tidied.at.reduced[j].abs() <= TOLERANCE * tidied.at.column_size[j].max(1.0) {
            tidied.at.reduced[j] = 0.0;
        }
    }
    let fine = tidied.residuals.primal_relative <= t.residuals.primal_relative.max(1e-9)
        && tidied.residuals.dual_relative <= t.residuals.dual_relative.max(1e-9);
    fine.then_some(tidied)
}
