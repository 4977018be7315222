//! Runs of the interior-point solver: their options, what is watched, and when one is given up.

use super::driver::{Driver, UNBOUNDED};
use super::interior_point::{Control, Ended, Progress, Shared, Solution, lock};
use super::schedule::{BASE, From};
use crate::solve::SolveError;
use crate::solve::budget::{self, Stop};

/// A run whose objective is worse than this has lost its way.
const LOST: f64 = 1e17;

/// A step that is shortened to this part, and changes the objective by this part at most, goes nowhere; that many in a window of
/// 20 iterations are a standstill.
const SHORT: f64 = 1e-2;
const UNCHANGED: f64 = 1e-5;
const MOST_SHORT: u32 = 10;
const WINDOW: u32 = 20;

/// So near to the end Newton's method takes two or three iterations more; where the dual residual stays above its tolerance for
/// longer, multipliers are not unique, and the point is as good as it gets.
const LAST_MU: f64 = 1e-8;
const STALL_PRIMAL: f64 = 1e-5;
const STALL_DUAL: [f64; 2] = [1e-6, 1e-4];
const STALL_ITERATIONS: u32 = 10;

/// Whether a run stands still: at a kink, where rounding refuses every step, or where it does not come to an end.
#[derive(Default)]
struct Standstill {
    before: f64,
    /// One bit an iteration: whether it went nowhere.
    short: u32,
    /// Iterations in a row that all but satisfied the conditions.
    nearly: u32,
}

impl Standstill {
    fn stands_still(&mut self, p: &Progress) -> bool {
        let change = (p.objective - self.before).abs();
        let nowhere = p.step <= SHORT && change <= UNCHANGED * p.objective.abs().max(1.0);
        self.before = p.objective;
        let dual = STALL_DUAL[0] < p.dual && p.dual <= STALL_DUAL[1];
        let nearly = p.mu <= LAST_MU && p.primal <= STALL_PRIMAL && dual;
        self.nearly = if nearly { self.nearly + 1 } else { 0 };
        self.short = (self.short << 1 | u32::from(nowhere)) & ((1 << WINDOW) - 1);
        !p.restoration && (self.short.count_ones() >= MOST_SHORT || self.nearly >= STALL_ITERATIONS)
    }
}

/// Operations of a factorisation from which on some search for a better order pays: a tenth of a second.
const FILLS: f64 = 2e8;
/// Variables and constraints up to which it does not, whatever they take.
const SMALL: usize = 2000;

impl Driver<'_, '_> {
    /// One run of the interior-point solver, judged and kept if it is the best so far. The objective of the point if
    /// it is optimal.
    pub(super) fn attempt(
        &mut self,
        from: From,
        extra: &[(&str, &str)],
    ) -> Result<Option<f64>, SolveError> {
        self.attempt_from(self.start_point(from), extra)
    }

    pub(super) fn attempt_from(
        &mut self,
        x: Vec<f64>,
        extra: &[(&str, &str)],
    ) -> Result<Option<f64>, SolveError> {
        lock(&self.problem).start = x.clone();
        let solution = self.call(self.problem.clone(), extra)?;
        if solution.ended == Ended::TooFewDegrees && !self.is_stopped() {
            return Ok(None);
        }
        let trial = self.judge(solution.x, solution.lambda, solution.ended);
        let trial = self.follow(x, trial)?;
        let objective = trial.is_optimal().then_some(trial.objective);
        self.keep(trial);
        Ok(objective)
    }

    /// Whether how a solver ended leaves room for a further attempt.
    pub(super) fn note_end(&mut self, ended: Ended) {
        if ended == Ended::Time {
            self.budget.end(Stop::Time);
        }
    }

    pub(super) fn call(
        &mut self,
        nlp: Shared,
        extra: &[(&str, &str)],
    ) -> Result<Solution, SolveError> {
        if !self.affords_factors() {
            let nlp = lock(&nlp);
            let start = nlp.start.clone();
            return Ok(Solution::without_multipliers(Ended::TooLarge, start, &nlp));
        }
        let mut options: Vec<(String, String)> = Vec::new();
        let mut put = |k: &str, v: &str| {
            options.retain(|(old, _)| !old.eq_ignore_ascii_case(k));
            options.push((k.to_string(), v.to_string()));
        };
        for (k, v) in BASE.iter().chain(extra) {
            put(k, v);
        }
        for (k, v) in self.settings.of(self.interior_point.about().options) {
            put(k, v);
        }
        let (n, m) = lock(&self.problem).size();
        let fills = n + m > SMALL && self.size_of_factors().operations > FILLS;
        let left = self.budget.iterations_left();
        let cap = if options.iter().any(|(k, _)| k == "max_iter") {
            u64::MAX
        } else {
            // an attempt begun late is not cut off at once
            let affordable = (self.enough - self.work()) / self.work_of_iteration();
            self.attempt_iterations.min(affordable.max(100.0) as u64)
        };
        let (budget, log) = (self.budget, self.budget.wants_log());
        let name = self.interior_point.about().name;
        if log {
            let extra: Vec<String> = extra.iter().map(|(k, v)| format!(", {k} {v}")).collect();
            budget.log(format!("{name}{}", extra.concat()));
        }
        let sign = self.instance.sign();
        let mut header = log;
        let (mut progress, mut still) = (Standstill::default(), false);
        let mut watch = |p: &Progress| {
            if header {
                header = false;
                budget.log("   iter       objective     primal       dual         mu      step");
            }
            if log {
                budget.log(format!(
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
            budget.progress(budget::Progress {
                method: name,
                iteration: p.iteration,
                objective: Some(sign * p.objective),
                primal: Some(p.primal),
                dual: Some(p.dual),
                ..budget::Progress::default()
            });
            let failures = lock(&nlp).failure_count;
            let unbounded = p.objective < -UNBOUNDED && p.primal < 1e-3;
            let diverged = unbounded || p.objective > LOST;
            let stopped = budget.stop_after_failures(failures).is_some();
            still = progress.stands_still(p);
            !stopped && !still && (p.restoration || !diverged)
        };
        let seconds = Some(budget.seconds_left()).filter(|s| *s < 1e9);
        let mut control = Control {
            options,
            iterations: left.min(cap),
            seconds: seconds.map(|s| s.max(1e-3)),
            fills,
            watch: &mut watch,
        };
        let result = self.interior_point.solve(nlp.clone(), &mut control);
        let mut solution = result.map_err(SolveError::new)?;
        if still {
            solution.ended = Ended::SmallStep;
        }
        self.spend(solution.iterations);
        self.note_end(solution.ended);
        self.ended = solution.ended;
        if let Ended::InvalidOption = solution.ended {
            return Err(SolveError::new(format!(
                "{} does not take one of the options",
                self.interior_point.about().name
            )));
        }
        Ok(solution)
    }
}
