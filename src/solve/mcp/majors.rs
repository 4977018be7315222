//! The main method: a stabilised Newton method whose steps are paths.
//!
//! Each *major iteration* linearises F and solves the linear problem with [`path`](super::path).
//! A step to its solution is accepted
//!
//! - as **M** if Ψ falls below a nonmonotone reference (the largest of the last ten accepted values),
//!   which moves the *checkpoint*;
//! - as **O**, without any test, at most ten times in a row (the *watchdog*): on the way to a
//!   solution Ψ often has to rise;
//! - otherwise the run goes back to the checkpoint and searches along its direction (**B**), and if
//!   that gives nothing takes a projected gradient step from the best point (**G**).
//!
//! If the linear problem has no solution, a *proximal term* v·(y − x) is added to F, first small,
//! then larger. With it every linear problem tends to have a solution, of length 1/v if it stands
//! for a ray; in linear problems such a solution is only taken in reserve.

use feral::SparseColMatrix;

use super::crash::{active_set, crash};
use super::factor::shifted;
use super::interior::interior;
use super::linear::{Kind, LinearProblem};
use super::log;
use super::merit::{phi, phi_slopes};
use super::path::{HARRIS, HARRIS_CLOSE, PathEnd, PathResult, Start, follow};
use super::run::{Point, Run, StallCounter, Stop};
use crate::solve::vector::{dot, sum};

/// Armijo constant of the M test and of the line search.
const ARMIJO: f64 = 1e-4;
/// Number of variables up to which the slack start is tried early.
const SLACK_START: usize = 1000;
/// Number of variables from which the crash is interior: one step of it replaces many pivots.
pub(super) const INTERIOR: usize = 600;
/// Number of variables from which long paths are avoided near a solution.
const LARGE: usize = 1000;
/// The least proximal term that is tried on a singular basis; steps that succeed make it smaller, down
/// to the least that counts.
const PROX_FIRST: f64 = 1e-7;
const PROX_MIN: f64 = 1e-12;
/// Full steps accepted in a row without a test on the merit function.
const WATCHDOG: usize = 10;
/// Major iterations without a notable fall of the residual before the run is called stuck.
const STAGNATION: usize = 15;
/// The same without any change of it: only the paths differ.
const STILL: usize = 2;
/// Pivots without that, at least and times n: problems without a solution have many and long paths.
const STAGNATION_PIVOTS: (usize, usize) = (10_000, 40);
/// Pivots on a path near a solution, or a share 1/10 of n.
const NEAR_LIMIT: usize = 200;
/// Pivots on a path from a solution to a better one, times n: a second or so where directions are full.
const POLISH_WORK: usize = 6_000_000;
/// Major iterations spent on that, as long as each takes a digit off the residual.
const POLISH_STEPS: usize = 5;
/// Gradient steps before the run is called stuck.
const GRADIENT_LIMIT: usize = 6;

/// What comes before the first major iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Crash {
    None,
    /// Projected Newton steps.
    Newton,
    /// Interior steps; if they lead nowhere, nothing follows.
    Interior,
}

/// Runs a crash and major iterations from `start`.
pub(super) fn majors(run: &mut Run, start: Point, before: Crash) -> Result<(), Stop> {
    let mut history = vec![start.merit];
    let mut point = start;
    if before != Crash::None && !run.polished(point.residual) {
        let crashed = if before == Crash::Interior {
            match interior(run, &point)?.filter(|p| p.residual < 1e-2 * point.residual) {
                Some(found) => found,
                None => return Ok(()),
            }
        } else {
            crash(run, point.clone(), &mut history)?
        };
        // A start that is good enough is left only for a better one.
        if !run.converged(point.residual) || crashed.residual < point.residual {
            point = crashed;
        }
        // What the crash passed through is no measure for what follows.
        history = vec![point.merit];
    }
    Majors::new(run, point, history).run(run)
}

/// A point to go back to, and the direction that was taken from it.
struct Checkpoint {
    point: Point,
    direction: Option<Vec<f64>>,
}

/// The next point, found on the path or otherwise.
struct Candidate {
    y: Vec<f64>,
    /// Final state of the path, a warm start.
    kind: Vec<Kind>,
    prox: f64,
}

struct Majors {
    point: Point,
    checkpoint: Checkpoint,
    best: Point,
    history: Vec<f64>,
    prox: f64,
    warm: Option<Vec<Kind>>,
    untested: usize,
    /// Major iterations without any change of the residual.
    still: usize,
    gradient_steps: usize,
    seed: u64,
}

impl Majors {
    fn new(run: &Run, point: Point, history: Vec<f64>) -> Self {
        Majors {
            checkpoint: Checkpoint {
                point: point.clone(),
                direction: None,
            },
            best: point.clone(),
            point,
            history,
            prox: run.settings.proximal_perturbation,
            warm: None,
            untested: 0,
            still: 0,
            gradient_steps: 0,
            seed: 1,
        }
    }

    fn reference(&self, run: &Run) -> f64 {
        let memory = run.settings.nms_memory_size.max(1);
        self.history
            .iter()
            .rev()
            .take(memory)
            .fold(0.0, |a, &b| f64::max(a, b))
    }

    fn run(mut self, run: &mut Run) -> Result<(), Stop> {
        log::major_header(run, &self.point);
        // More iterations after convergence: Newton's method doubles the digits.
        let mut polishing = 0;
        let mut stall = StallCounter::new();
        let most = STAGNATION_PIVOTS.0.max(STAGNATION_PIVOTS.1 * run.n);
        let mut pivots_then = run.pivots;
        for _ in 0..run.settings.major_iteration_limit {
            let idle = stall.idle(self.best.residual, 0.9);
            if idle == 0 {
                pivots_then = run.pivots;
            }
            let stuck = idle > STAGNATION || self.still > STILL;
            if stuck || run.pivots - pivots_then > most {
                return Ok(());
            }
            if run.converged(self.point.residual) {
                if polishing == POLISH_STEPS || run.polished(self.point.residual) {
                    return Ok(());
                }
                polishing += 1;
            }
            run.check()?;
            let Some(jacobian) = run.jacobian(&self.point.x) else {
                if polishing > 0 {
                    return Ok(());
                }
                if !self.back(run, None)? {
                    return Ok(());
                }
                continue;
            };
            run.majors += 1;
            let pivots = run.pivots;
            let polish = polishing > 0;
            let (candidate, tries) = self.linear_solution(run, &jacobian, polish)?;
            if polish {
                match self.keep_if_better(run, candidate, run.pivots - pivots, tries) {
                    true => continue,
                    false => return Ok(()),
                }
            }
            let Some(candidate) = candidate else {
                let (end, pivots) = (PathEnd::Numerical, run.pivots - pivots);
                log::major_line(run, &self.point, pivots, end, self.prox, '-', tries);
                if !self.back(run, Some(&jacobian))? {
                    return Ok(());
                }
                continue;
            };
            if !self.accept(run, candidate, &jacobian, run.pivots - pivots, tries)? {
                return Ok(());
            }
        }
        Ok(())
    }

    /// After convergence: keeps the step only if it is better. Whether another may follow.
    fn keep_if_better(
        &mut self,
        run: &mut Run,
        candidate: Option<Candidate>,
        pivots: usize,
        tries: usize,
    ) -> bool {
        let better = candidate.and_then(|c| Some((run.point(c.y.clone())?, c)));
        let Some((next, candidate)) = better else {
            return false;
        };
        let kind = match next.residual {
            r if r <= 0.1 * self.point.residual => 'M',
            _ => '-',
        };
        let (end, prox) = (PathEnd::Solved, candidate.prox);
        log::major_line(run, &next, pivots, end, prox, kind, tries);
        if kind == '-' {
            return false;
        }
        (self.warm, self.point) = (Some(candidate.kind), next);
        self.reduce_prox(prox);
        true
    }

    /// Tries proximal terms and starting states until the linear problem is solved.
    fn linear_solution(
        &mut self,
        run: &mut Run,
        jacobian: &SparseColMatrix,
        polish: bool,
    ) -> Result<(Option<Candidate>, usize), Stop> {
        let r = (2.0 * self.point.merit).sqrt();
        let prox = self.proximal_terms(run, r);
        // Large, and close to a solution: long paths are not worth their pivots any more.
        let near = run.n > LARGE && self.point.residual <= run.settings.acceptable_tolerance;
        let limit = match run.settings.minor_iteration_limit {
            // A solution is at hand: not worth many pivots.
            0 if polish => (POLISH_WORK / run.n).min(NEAR_LIMIT.max(run.n / 10)),
            0 if near => NEAR_LIMIT.max(run.n / 10),
            0 => pivot_limit(run.n),
            given => given,
        };
        let mut reserve: Option<(Candidate, f64)> = None;
        let mut tries = 0;
        for (level, &v) in prox.iter().enumerate() {
            let Some((m, q)) = self.linearised(jacobian, v) else {
                continue;
            };
            for mut start in self.starts(run, level) {
                if polish {
                    start.tolerance = HARRIS_CLOSE;
                }
                if (polish || near) && (start.cover || level > 2) {
                    continue;
                }
                tries += 1;
                self.seed += 1;
                let (lower, upper) = (run.lower.clone(), run.upper.clone());
                let linear = LinearProblem {
                    m: &m,
                    q: &q,
                    lower: &lower,
                    upper: &upper,
                };
                let result = follow(run, &linear, &start, limit, self.seed)?;
                let PathResult {
                    end,
                    x,
                    t,
                    kind,
                    pivots,
                } = result;
                log::try_line(run, end, t, v, pivots, start.cover);
                if end != PathEnd::Solved {
                    continue;
                }
                let off = x.iter().zip(&self.point.x).map(|(a, b)| (a - b).powi(2));
                let length = off.sum::<f64>().sqrt();
                // a solution of a linear problem for v > 0 that may stand for a ray
                let doubtful = run.problem.data.is_linear && v > 0.0 && v * length > 0.7 * r;
                let found = Candidate {
                    y: x,
                    kind,
                    prox: v,
                };
                if !doubtful {
                    return Ok((Some(found), tries));
                }
                // Of several, the one with the least merit.
                if let Some(point) = run.point(found.y.clone())
                    && reserve
                        .as_ref()
                        .is_none_or(|(_, merit)| point.merit < *merit)
                {
                    reserve = Some((found, point.merit));
                }
            }
        }
        Ok((reserve.map(|r| r.0), tries))
    }

    /// The proximal terms to try, from the last one upwards, at a point of residual r.
    fn proximal_terms(&self, run: &Run, r: f64) -> Vec<f64> {
        let mut prox = vec![self.prox];
        // Where one linearisation is exact, a small term saves the iterations that remove it again.
        let small = if run.problem.data.is_linear {
            1e-5
        } else {
            1e-3
        };
        for v in [
            (small * r.min(1.0)).max(10.0 * self.prox).max(PROX_FIRST),
            (0.1 * r.min(1.0)).max(100.0 * self.prox),
            1.0,
            10.0,
        ] {
            if v > *prox.last().unwrap_or(&0.0) {
                prox.push(v);
            }
        }
        prox
    }

    /// M and q of F(x) + J(y − x) with a proximal term. None where a number is not finite.
    fn linearised(
        &self,
        jacobian: &SparseColMatrix,
        prox: f64,
    ) -> Option<(SparseColMatrix, Vec<f64>)> {
        let m = if prox > 0.0 {
            shifted(jacobian, prox)
        } else {
            jacobian.clone()
        };
        let mut q = vec![0.0; self.point.x.len()];
        m.matvec(&self.point.x, &mut q);
        for (q, f) in q.iter_mut().zip(&self.point.f) {
            *q = f - *q;
        }
        let finite = m.values.iter().chain(&q).all(|v| v.is_finite());
        finite.then_some((m, q))
    }

    /// Starting states for the path, the likeliest first.
    fn starts(&self, run: &Run, level: usize) -> Vec<Start> {
        let x = &self.point.x;
        let start = |kind, cover| Start {
            kind,
            x: x.clone(),
            cover,
            tolerance: HARRIS,
        };
        let kinds = |of: &dyn Fn(usize) -> Kind| (0..run.n).map(of).collect::<Vec<_>>();
        let near = match &self.warm {
            Some(kind) => kind.clone(),
            None => {
                let sets = active_set(x, &self.point.f, &run.lower, &run.upper);
                kinds(&|i| match sets[i] {
                    -1 => Kind::AtLower,
                    1 => Kind::AtUpper,
                    _ => Kind::Between,
                })
            }
        };
        let mut starts = vec![start(near.clone(), false)];
        if level == 0 {
            // The state of the normal map's variable z = x − F.
            let kind = kinds(&|i| match x[i] - self.point.f[i] {
                z if z <= run.lower[i] => Kind::AtLower,
                z if z >= run.upper[i] => Kind::AtUpper,
                _ => Kind::Between,
            });
            if kind != near {
                starts.push(start(kind, false));
            }
        }
        // From the slacks the path is as long as the solution has variables off their bounds: the way
        // out where n is small, and the last resort where it is large.
        let from_slacks = match run.n <= SLACK_START {
            true => level <= 1,
            false => level == 4,
        };
        if from_slacks {
            let kind = kinds(
                &|i| match (run.lower[i].is_finite(), run.upper[i].is_finite()) {
                    (true, _) => Kind::AtLower,
                    (false, true) => Kind::AtUpper,
                    (false, false) => Kind::Between,
                },
            );
            starts.push(start(kind, true));
        }
        starts
    }

    /// Takes the step to the candidate, or another one. False if there is none.
    fn accept(
        &mut self,
        run: &mut Run,
        candidate: Candidate,
        jacobian: &SparseColMatrix,
        pivots: usize,
        tries: usize,
    ) -> Result<bool, Stop> {
        let reference = self.reference(run);
        let direction = sum(&candidate.y, -1.0, &self.point.x);
        if self.checkpoint.direction.is_none() {
            self.checkpoint.direction = Some(direction);
        }
        let (end, prox) = (PathEnd::Solved, candidate.prox);
        let next = run.point(candidate.y);
        if let Some(next) = next {
            let monotone = next.merit <= (1.0 - ARMIJO) * reference;
            let watched = self.untested < WATCHDOG && next.merit <= 1e8 * reference;
            if monotone || watched {
                let kind = if monotone { 'M' } else { 'O' };
                log::major_line(run, &next, pivots, end, prox, kind, tries);
                let (r, before) = (next.residual, self.point.residual);
                self.still = match (r - before).abs() <= 1e-3 * before {
                    true => self.still + 1,
                    false => 0,
                };
                self.warm = Some(candidate.kind);
                self.point = next;
                if self.point.residual < self.best.residual {
                    self.best = self.point.clone();
                }
                if monotone {
                    self.new_checkpoint();
                    self.gradient_steps = 0;
                } else {
                    self.untested += 1;
                }
                self.reduce_prox(prox);
                return Ok(true);
            }
        }
        log::major_line(run, &self.point, pivots, end, prox, '-', tries);
        self.back(run, Some(jacobian))
    }

    /// The proximal term of the next iteration, after a step with `used`.
    fn reduce_prox(&mut self, used: f64) {
        let cap = 1e-2 * (2.0 * self.point.merit).sqrt();
        self.prox = (0.4 * used.max(self.prox)).min(cap);
        if self.prox < PROX_MIN {
            self.prox = 0.0;
        }
    }

    fn new_checkpoint(&mut self) {
        self.history.push(self.point.merit);
        self.checkpoint = Checkpoint {
            point: self.point.clone(),
            direction: None,
        };
        self.untested = 0;
    }

    /// Back to the checkpoint: line search along its direction, else a gradient step.
    fn back(&mut self, run: &mut Run, jacobian: Option<&SparseColMatrix>) -> Result<bool, Stop> {
        self.warm = None;
        let reference = self.reference(run);
        if let Some(direction) = self.checkpoint.direction.take() {
            let mut step = 0.5;
            while step >= 1e-3 {
                let mut x = sum(&self.checkpoint.point.x, step, &direction);
                run.clip(&mut x);
                if let Some(next) = run.point(x)
                    && next.merit <= (1.0 - ARMIJO * step) * reference
                {
                    log::step_line(run, &next, step, 'B');
                    self.point = next;
                    self.new_checkpoint();
                    return Ok(true);
                }
                step *= 0.5;
            }
        }
        self.gradient_step(run, jacobian)
    }

    /// A step on the projected gradient arc of Ψ from the best point.
    fn gradient_step(
        &mut self,
        run: &mut Run,
        jacobian: Option<&SparseColMatrix>,
    ) -> Result<bool, Stop> {
        if self.gradient_steps >= GRADIENT_LIMIT {
            return Ok(false);
        }
        self.gradient_steps += 1;
        let from = self.best.clone();
        let jacobian = match jacobian {
            Some(j) if from.x == self.point.x => Some(j.clone()),
            _ => run.jacobian(&from.x),
        };
        let Some(jacobian) = jacobian else {
            return Ok(false);
        };
        let gradient = merit_gradient(run, &from, &jacobian);
        let norm = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        if !(norm.is_finite() && norm > 0.0) {
            return Ok(false);
        }
        let mut step = 1.0;
        while step > 1e-12 {
            let mut x = sum(&from.x, -step, &gradient);
            run.clip(&mut x);
            let fall = dot(&sum(&from.x, -1.0, &x), &gradient);
            if let Some(next) = run.point(x)
                && next.merit <= from.merit - ARMIJO * fall
                && fall > 0.0
            {
                log::step_line(run, &next, step, 'G');
                self.point = next;
                if self.point.residual < self.best.residual {
                    self.best = self.point.clone();
                }
                self.new_checkpoint();
                return Ok(true);
            }
            step *= 0.3;
        }
        Ok(false)
    }
}

/// Pivots allowed on one path.
pub(super) fn pivot_limit(n: usize) -> usize {
    (n / 4).max(1000)
}

/// Gradient of ½‖Φ‖²: DaΦ + Jᵀ(DbΦ).
fn merit_gradient(run: &Run, point: &Point, jacobian: &SparseColMatrix) -> Vec<f64> {
    let n = run.n;
    let (mut along_x, mut along_f) = (vec![0.0; n], vec![0.0; n]);
    for i in 0..n {
        let (x, f, l, u) = (point.x[i], point.f[i], run.lower[i], run.upper[i]);
        let (value, (a, b)) = (phi(x, f, l, u), phi_slopes(x, f, l, u));
        along_x[i] = a * value;
        along_f[i] = b * value;
    }
    let mut gradient = vec![0.0; n];
    jacobian.matvec_transpose(&along_f, &mut gradient);
    gradient.iter_mut().zip(&along_x).for_each(|(g, a)| *g += a);
    gradient
}
