//! Mathematical programs with equilibrium constraints (`mpec`): an objective, ordinary constraints,
//! and pairs l ≤ x ≤ u ⟂ F(x).
//!
//! With a piece chosen for every pair ([`pairs`]) the program is an ordinary one. Every method ends
//! on such a *branch*, solved by the solvers of linear or nonlinear programs: there x is exactly on
//! its bound or F = 0 to rounding, so complementarity is exact, whatever the accuracy of what
//! led there. What differs is how the branch is found:
//!
//! * [`super::bridge::products`]: nonlinear programs in which the products are bounded by μ → 0;
//! * [`pieces`]: where everything is linear and the pairs couple two otherwise separate systems,
//!   linear programs on supports.
//!
//! From there [`stationarity`] looks for a direction that leads downhill in some piece; while there is
//! one the search continues in its branch. What is reported follows from residuals recomputed on the
//! instance as it was generated, and from that check.
//!
//! Marginals are those of the final branch: the derivative of the optimal value as long as the pairs
//! stay on their pieces.

pub(in crate::solve) mod bound;
pub mod pairs;
pub mod pieces;
pub mod settings;
pub mod split;
pub mod stationarity;
mod supports;
mod swaps;
mod tree;

use super::answer::{Answer, answer_with, subproblem};
use super::backend::{About, Backend, Replied, Reply, Seen, Supports, Task, Terms};
use super::bridge::products::{Exact, Relaxed};
use super::certificate::TOLERANCE;
use super::lp::Ended;
use super::registry::BACKENDS;
use super::{
    Budget, Claim, ModelStatus, Outcome, Settings, SolveError, SolverStatus, Stop, Strategy,
};
use crate::model::instance::Instance;
use crate::model::named::named;
use crate::model::outcome::Basis;
use crate::model::problem_type::ProblemType;
use pairs::{Judged, Piece, Program};
pub use settings::OPTIONS;
use settings::{Method, Options};
use stationarity::Verdict;
use std::collections::HashSet;
use std::sync::Arc;

named! {
    /// What is known about stationarity, for the report.
    pub enum Stationarity {
        /// B-stationary.
        Proved "proved";
        /// Not B-stationary, and no way down was found.
        Refuted "refuted";
        /// Not known.
        NotProved "not proved";
    }
}

/// The solver of programs with pairs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bmpec;

impl Backend for Bmpec {
    fn about(&self) -> About {
        About {
            name: "bmpec",
            aliases: &[],
            version: "mpec, rmpec: bmod's own, on the nonlinear solver and the simplex method",
            supports: Supports {
                pairs: true,
                ..Supports::new(&[ProblemType::Mpec, ProblemType::Rmpec], Terms::Smooth)
            },
            options: &OPTIONS,
            option_files: &["bmpec"],
        }
    }

    fn solve(&self, task: &Task, settings: &Settings, budget: &Budget) -> Replied {
        let program = Program::new(task.instance)?;
        super::lp::form::validate(&program.envelope)?;
        let mut search = Search {
            program: &program,
            options: Options::new(settings),
            choice: task.choice,
            settings,
            budget,
            enough: u64::MAX,
            best: None,
            reserve: None,
            fallback: None,
            passed: Vec::new(),
            empty: false,
            seen: HashSet::new(),
            notes: Vec::new(),
        };
        search.run()
    }
}

/// Until there is a feasible point: in iterations times rows and columns, and iterations in any case.
const FIRST_WORK: u64 = 300_000;
const FIRST_ITERATIONS: u64 = 3_000;

/// Rows and columns up to which a relaxed program goes to the sequential method.
const LARGEST_SEQUENTIAL: u64 = 120;

/// First μ, and what it is multiplied by: for the interior point, which leaves the start whatever μ is, and for the sequential
/// method, which stays near it.
const STRIDES: [f64; 2] = [1.0, 1e-3];
const STEPS: [f64; 2] = [1e-2, 0.1];

/// From this μ on the solution of a relaxed program names a branch.
const LAST_PHASE: f64 = 1.01e-4;

/// Relaxed programs in a row that lead to no point; one without a feasible point counts for as many.
const MOST_MISSED: u32 = 2;

/// The option that leaves strategies out.
const WITHOUT: &str = "without";

/// What a relaxed program is solved with.
const RELAXED: [(&str, &str); 2] = [("bound_relax_factor", "0"), ("mu_strategy", "adaptive")];

/// By the interior point in one run, coarsely, in so many iterations at most, and no more than half as many as rows and columns: it only says
/// which branch to solve.
const MOST_COARSE: u64 = 150;
const COARSE: [(&str, &str); 5] = [
    ("tol", "1e-3"),
    ("dual_inf_tol", "1e-2"),
    ("compl_inf_tol", "1e-4"),
    ("constr_viol_tol", "1e-6"),
    (
        WITHOUT,
        "restart_from_best,saddle_escape,active_set_polish,interval_proof",
    ),
];

/// A feasible point: the solution of a branch.
#[derive(Clone)]
struct Found {
    pieces: Vec<Piece>,
    outcome: Outcome,
    /// Of the branch.
    status: ModelStatus,
    judged: Judged,
    /// Minimised.
    objective: f64,
    verdict: Option<Stationarity>,
}

struct Search<'a, 'm> {
    program: &'a Program<'a>,
    options: Options,
    choice: Option<&'a str>,
    settings: &'a Settings,
    budget: &'a Budget<'m>,
    /// Iterations after which no further nonlinear program of the present phase is begun or continued.
    enough: u64,
    best: Option<Found>,
    /// The least infeasible of the points that are not feasible.
    reserve: Option<Found>,
    /// A point that satisfies everything, in case that nothing better is found: its branch was not solved.
    fallback: Option<Found>,
    /// The start, and points of programs on the way that satisfy the pairs: none of them may be lost; without the objective's level.
    passed: Vec<Vec<f64>>,
    /// No point satisfies all pairs, proved.
    empty: bool,
    /// Branches that were solved.
    seen: HashSet<Vec<Piece>>,
    notes: Vec<String>,
}

impl Search<'_, '_> {
    fn run(&mut self) -> Result<Reply, SolveError> {
        let start: Vec<f64> = {
            let c = &self.program.instance.columns;
            let finite = |x: f64| if x.is_finite() { x } else { 0.0 };
            let clip = |j: usize| finite(c.level[j]).max(c.lower[j]).min(c.upper[j]);
            (0..c.level.len()).map(clip).collect()
        };
        self.passed.push(start.clone());
        let method = self.options.method;
        if matches!(method, Method::Auto | Method::Pieces) && self.supports(&start)? {
            return self.finish();
        }
        match method {
            Method::Check => {
                let start = self.program.complete(start);
                let pieces = self.program.nearest(&start);
                self.check_start(&start, pieces)?;
            }
            _ => {
                if method == Method::Pieces {
                    self.improve(&self.program.complete(start.clone()))?;
                }
                self.allow(FIRST_WORK.max(FIRST_ITERATIONS * self.size()));
                if self.best.is_none() && !self.is_over() {
                    self.relax(&start)?;
                }
                if self.options.swaps {
                    self.explore(&start)?;
                }
            }
        }
        self.finish()
    }

    fn is_over(&self) -> bool {
        self.budget.is_over()
    }

    /// Limits the phase that begins, in iterations times rows and columns.
    fn allow(&mut self, work: u64) {
        self.enough = self.budget.iterations() + work / self.size();
    }

    /// Rows and columns, what an iteration costs.
    fn size(&self) -> u64 {
        let instance = self.program.instance;
        (instance.row_count() + instance.column_count()).max(1) as u64
    }

    fn is_spent(&self) -> bool {
        self.left() == 0 || self.is_over()
    }

    /// Iterations that are left for the present phase.
    fn left(&self) -> u64 {
        self.enough.saturating_sub(self.budget.iterations())
    }

    /// Options of a program that is solved on the way: the user's come last and win, and what he leaves out is left out besides.
    fn sub_settings(&self, extra: &[(&str, &str)]) -> Settings {
        let own = |(k, v): &(&str, &str)| (k.to_string(), v.to_string());
        let mut options: Vec<(String, String)> = extra.iter().map(own).collect();
        options.extend(self.settings.options.iter().cloned());
        if let Some((name, ours)) = extra.iter().find(|e| e.0 == WITHOUT)
            && let Some(theirs) = self.settings.option(WITHOUT)
        {
            options.push((name.to_string(), format!("{theirs},{ours}")));
        }
        Settings {
            options,
            ..self.settings.clone()
        }
    }

    /// A nonlinear program on the way, within the present phase and so many iterations.
    fn program(
        &self,
        choice: Option<&str>,
        instance: &Instance,
        extra: &[(&str, &str)],
        most: u64,
        seen: Option<&Seen>,
    ) -> Result<Answer, SolveError> {
        let settings = self.sub_settings(&[&[("nlp_search", "no")][..], extra].concat());
        let most = most.min(self.left());
        self.budget.silently(|budget| {
            budget.within(f64::INFINITY, most, |budget| {
                let task = Task::new(ProblemType::Nlp, instance).by(choice);
                subproblem(&Task { seen, ..task }, &settings, budget)
            })
        })
    }

    /// Solves a branch and keeps what it gives. None if it was solved before or is not feasible.
    fn branch(&mut self, pieces: Vec<Piece>, start: &[f64]) -> Result<Option<Found>, SolveError> {
        self.branch_from(None, pieces, start, u64::MAX)
    }

    /// The same in so many iterations, and for a linear program whose optimal basis may be known.
    fn branch_from(
        &mut self,
        basis: Option<&Basis>,
        pieces: Vec<Piece>,
        start: &[f64],
        most: u64,
    ) -> Result<Option<Found>, SolveError> {
        if !self.seen.insert(pieces.clone()) || self.is_over() {
            return Ok(None);
        }
        let instance = self.program.branch(&pieces, start);
        let before = self.budget.iterations();
        let passed = Arc::new(Exact::default());
        let answer = match instance.is_linear() {
            true => self.budget.silently(|budget| {
                budget.within(f64::INFINITY, most, |budget| {
                    let task = Task::new(ProblemType::Lp, &instance);
                    subproblem(&Task { basis, ..task }, self.settings, budget)
                })
            }),
            false => self.program(self.choice, &instance, &[], most, Some(&passed.seen())),
        };
        let answer = match answer {
            Ok(a) => a,
            // A function without a value at this start, say: not the end of the search.
            Err(e) if self.best.is_some() || self.reserve.is_some() => {
                self.log(&format!("branch: {}", e.message));
                return Ok(None);
            }
            Err(e) => return Err(e),
        };
        let judged = self.program.judge(&answer.outcome.level);
        let objective = self.program.objective(&answer.outcome.level);
        let worse = |p: &(f64, Vec<f64>)| !judged.feasible || p.0 < objective;
        self.passed.extend(passed.take().filter(worse).map(|p| p.1));
        self.log(&format!(
            "branch: {} after {} iterations, objective {:.10}, primal {:.1e}, complementarity {:.1e}",
            answer.status.name(),
            self.budget.iterations() - before,
            self.program.sign() * objective,
            judged.residuals.primal.unwrap_or(f64::NAN),
            judged.residuals.complementarity_sum.unwrap_or(f64::NAN),
        ));
        let found = Found {
            pieces,
            outcome: answer.outcome,
            status: answer.status,
            judged,
            objective,
            verdict: None,
        };
        let worth = |f: &Found| f.judged.residuals.primal_relative;
        if !found.judged.feasible {
            let better = |r: &Found| worth(&found) < worth(r);
            if self.reserve.as_ref().is_none_or(better) {
                self.reserve = Some(found);
            }
            return Ok(None);
        }
        self.keep(&found);
        Ok(Some(found))
    }

    fn keep(&mut self, found: &Found) {
        let better = match &self.best {
            None => true,
            Some(old) => {
                let margin = 1e-9 * old.objective.abs().max(1.0);
                let optimal = |f: &Found| f.verdict == Some(Stationarity::Proved);
                let unbounded = |f: &Found| f.status == ModelStatus::Unbounded;
                !unbounded(old) && (unbounded(found) || found.objective < old.objective - margin)
                    || (found.objective <= old.objective + margin
                        && optimal(found)
                        && !optimal(old))
            }
        };
        if better {
            self.best = Some(found.clone());
        }
    }

    /// From a feasible point downhill through the branches, until no direction leads on.
    fn descend(&mut self, mut found: Found) -> Result<Found, SolveError> {
        for _ in 0..1000 {
            if self.is_over() || found.status == ModelStatus::Unbounded {
                break;
            }
            match self.check(&found.outcome.level) {
                Verdict::Proved => {
                    found.verdict = Some(Stationarity::Proved);
                    break;
                }
                Verdict::NotProved => {
                    found.verdict = Some(Stationarity::NotProved);
                    break;
                }
                Verdict::Refuted {
                    direction,
                    slope,
                    pieces,
                } => {
                    let what = self.describe(&direction);
                    self.log(&format!("not stationary: slope {slope:.3e} along {what}"));
                    found.verdict = Some(Stationarity::Refuted);
                    let level = found.outcome.level.clone();
                    let margin = 1e-10 * found.objective.abs().max(1.0);
                    match self.branch(pieces, &level)? {
                        Some(next) if next.objective < found.objective - margin => found = next,
                        _ => {
                            // Downhill to first order only, or not at all.
                            if !self.program.instance.is_linear() {
                                found.verdict = Some(Stationarity::NotProved);
                            }
                            break;
                        }
                    }
                }
            }
        }
        self.keep(&found);
        if let Some(best) = &mut self.best
            && best.pieces == found.pieces
        {
            best.verdict = found.verdict;
        }
        Ok(found)
    }

    /// Keeps a point that satisfies everything, for the case that nothing is left to solve its branch with.
    fn keep_point(&mut self, level: &[f64], pieces: Vec<Piece>) {
        let judged = self.program.judge(level);
        if !judged.feasible {
            return;
        }
        let found = self.as_found(level, pieces, judged);
        let better = |old: &Found| found.objective < old.objective;
        if self.fallback.as_ref().is_none_or(better) {
            self.fallback = Some(found);
        }
    }

    /// A feasible point that no program has led to.
    fn as_found(&self, level: &[f64], pieces: Vec<Piece>, judged: Judged) -> Found {
        let rows = self.program.instance.row_count();
        let outcome = Outcome::unfinished("bmpec", level.to_vec(), rows);
        Found {
            pieces,
            outcome,
            status: ModelStatus::Feasible,
            objective: self.program.objective(level),
            judged,
            verdict: None,
        }
    }

    /// A point that satisfies the pairs, from a start, by the complementarity solver: where the rows and
    /// columns without partners are equally many equations and free columns.
    fn equilibrium(&mut self, start: &[f64], options: &[(&str, &str)]) -> Option<Vec<f64>> {
        let mut instance = self.program.instance.clone();
        instance.objective = None;
        instance.columns.level.copy_from_slice(start);
        let settings = self.sub_settings(options);
        let out = self.budget.silently(|budget| {
            subproblem(&Task::new(ProblemType::Mcp, &instance), &settings, budget)
        });
        let out = out.ok()?.outcome;
        let judged = self.program.judge(&out.level);
        let value = self.program.sign() * self.program.objective(&out.level);
        self.log(&format!(
            "equilibrium: objective {value:.10}, natural residual {:.1e}",
            judged.residuals.natural.unwrap_or(f64::NAN)
        ));
        if !judged.feasible {
            return None;
        }
        let pieces = self.program.nearest(&out.level);
        self.keep_point(&out.level, pieces);
        Some(out.level)
    }

    fn check(&mut self, level: &[f64]) -> Verdict {
        let mut stop = |_| self.budget.stop().map(Ended::from);
        stationarity::check(self.program, level, self.options.nodes, &mut stop)
    }

    /// The largest entries of a direction, by name.
    fn describe(&mut self, direction: &[f64]) -> String {
        let objective = self.program.instance.objective.map(|o| o.column as usize);
        let mut order: Vec<usize> = (0..direction.len())
            .filter(|&j| Some(j) != objective && direction[j].abs() > 1e-9)
            .collect();
        order.sort_by(|&a, &b| direction[b].abs().total_cmp(&direction[a].abs()));
        let more = if order.len() > 4 { ", …" } else { "" };
        let parts: Vec<String> = order
            .iter()
            .take(4)
            .map(|&j| format!("{} {:+.3}", self.budget.column_name(j), direction[j]))
            .collect();
        format!("{}{more}", parts.join(", "))
    }

    fn check_start(&mut self, start: &[f64], pieces: Vec<Piece>) -> Result<(), SolveError> {
        let judged = self.program.judge(start);
        if !judged.feasible {
            self.notes
                .push("the start is not feasible: its branch was solved".into());
            if let Some(f) = self.branch(pieces, start)? {
                let verdict = self.check(&f.outcome.level);
                self.conclude(f, verdict);
            }
            return Ok(());
        }
        let found = self.as_found(start, pieces, judged);
        let verdict = self.check(start);
        self.conclude(found, verdict);
        Ok(())
    }

    fn conclude(&mut self, mut found: Found, verdict: Verdict) {
        found.verdict = Some(match &verdict {
            Verdict::Proved => Stationarity::Proved,
            Verdict::NotProved => Stationarity::NotProved,
            Verdict::Refuted {
                direction, slope, ..
            } => {
                let what = self.describe(direction);
                let text = format!("the objective falls with slope {slope:.3e} along {what}");
                self.notes.push(text);
                Stationarity::Refuted
            }
        });
        self.best = Some(found);
    }

    /// A sequence of nonlinear programs with μ → 0; the branches that its points suggest are solved.
    fn relax(&mut self, start: &[f64]) -> Result<(), SolveError> {
        let mut relaxed = Relaxed::new(self.program);
        let mut x = start.to_vec();
        let n = x.len();
        let mut missed = 0;
        // next to the products' bounds there are no vertices that a sequential method could go along
        let interior = self.choice.is_none()
            && self.size() > LARGEST_SEQUENTIAL
            && self.settings.runs(Strategy::InteriorRelaxation);
        let first = super::nlp::interior_point_solvers().first();
        let solver = first.map(|p| p.about().name).filter(|_| interior);
        let (stride, most) = match interior {
            true => (STRIDES, MOST_COARSE.min(self.size() / 2)),
            false => (STEPS, u64::MAX),
        };
        let coarse = if interior { &COARSE[..] } else { &[] };
        let extra = [&RELAXED[..], coarse].concat();
        let mut mu = self.options.mu.unwrap_or(stride[0]);
        let factor = self.options.factor.unwrap_or(stride[1]);
        loop {
            relaxed.tighten(self.program, mu, &x);
            let seen = relaxed.exact.seen();
            let before = self.budget.iterations();
            let by = self.choice.or(solver);
            let a = self.program(by, &relaxed.instance, &extra, most, Some(&seen));
            self.passed
                .extend(relaxed.exact.take().map(|(_, mut level)| {
                    level.truncate(n);
                    level
                }));
            let a = a?;
            let y = &a.outcome.level[..n];
            let judged = self.program.judge(y);
            self.log(&format!(
                "relaxed, μ = {mu:.0e}: {} after {} iterations, objective {:.10}, complementarity {:.1e}",
                a.status.name(),
                self.budget.iterations() - before,
                self.program.sign() * self.program.objective(y),
                judged.residuals.complementarity_sum.unwrap_or(f64::NAN),
            ));
            if judged.feasible {
                let level = y.to_vec();
                let pieces = self.program.nearest(&level);
                self.keep_point(&level, pieces);
            }
            let usable = a.residuals.is_feasible(1e-4) && y.iter().all(|v| v.is_finite());
            let infeasible = matches!(
                a.status,
                ModelStatus::Infeasible | ModelStatus::LocallyInfeasible
            );
            missed = match usable {
                true => 0,
                false if infeasible => MOST_MISSED,
                false => missed + 1,
            };
            // where a program was given up, the next begins where this one began
            let given_up = self.budget.iterations() - before >= most;
            if usable && (!given_up || mu <= LAST_PHASE) {
                x.copy_from_slice(y);
            }
            if usable && mu <= LAST_PHASE {
                let pieces = self.program.nearest(&x);
                if self.seen.contains(&pieces) {
                    return Ok(());
                }
                // What it leads to may be much worse: then it is not what this point is near to.
                let value = self.program.objective(&x);
                let settled = |f: &Found| {
                    f.verdict == Some(Stationarity::Proved)
                        && f.objective <= value + 1e-2 * f.objective.abs().max(1.0)
                };
                if let Some(f) = self.branch(pieces, &x)?
                    && settled(&self.descend(f)?)
                {
                    return Ok(());
                }
            }
            // With a smaller μ it only becomes harder.
            if missed >= MOST_MISSED || self.is_spent() || mu <= self.options.last {
                break;
            }
            mu = (mu * factor).max(self.options.last);
        }
        if self.best.is_none() {
            let pieces = self.program.nearest(&x);
            if let Some(f) = self.branch(pieces, &x)? {
                self.descend(f)?;
            }
        }
        Ok(())
    }

    fn log(&self, line: &str) {
        self.budget.log(line);
    }

    /// What was found, and what is claimed of it.
    fn finish(&mut self) -> Result<Reply, SolveError> {
        for level in std::mem::take(&mut self.passed) {
            let level = self.program.complete(level);
            let pieces = self.program.nearest(&level);
            self.keep_point(&level, pieces);
        }
        if let Some(found) = self.fallback.take() {
            let better =
                |b: &Found| found.objective < b.objective - TOLERANCE * b.objective.abs().max(1.0);
            let goes_on = self.options.method != Method::Check && !self.is_over();
            if goes_on && self.best.as_ref().is_none_or(better) {
                // passed on the way to a worse local solution, or to none
                self.seen.remove(&found.pieces);
                self.improve(&found.outcome.level)?;
            }
            if self.best.is_none() || self.budget.stopped().is_some() {
                self.keep(&found);
            }
        }
        let searched = self.options.method != Method::Check;
        if searched
            && self.best.is_none()
            && !self.is_over()
            && self.settings.runs(Strategy::FeasibleByBranching)
        {
            match bound::any(self.program, self.budget) {
                bound::Any::Point(level) => self.improve(&level)?,
                bound::Any::Empty => self.empty = true,
                bound::Any::Unknown => {}
            }
        }
        let low = self.lower_bound()?;
        let Some(found) = self.best.take() else {
            return self.infeasible();
        };
        let claim = match (found.status, found.verdict) {
            (ModelStatus::Unbounded, _) => Claim::Unbounded,
            _ if low.is_some_and(|l| bound::is_closed(l, found.objective)) => Claim::Solved,
            (_, Some(Stationarity::Proved)) => Claim::LocallySolved,
            _ => Claim::Unfinished,
        };
        let status = match (claim, self.budget.stopped().map(Stop::status)) {
            (Claim::Unfinished, Some(s)) => s,
            (_, Some(SolverStatus::UserInterrupt)) => SolverStatus::UserInterrupt,
            _ => SolverStatus::NormalCompletion,
        };
        let low = low.map(|l| l.min(found.objective));
        let bounds = low.map(|low| match self.program.sign() > 0.0 {
            true => [low, found.objective],
            false => [-found.objective, -low],
        });
        Ok(Reply {
            stationarity: found.verdict,
            bounds,
            ..self.reply(found.outcome, claim, status)
        })
    }

    fn reply(&self, outcome: Outcome, claim: Claim, status: SolverStatus) -> Reply {
        let outcome = Outcome {
            claim,
            status,
            iterations: self.budget.iterations(),
            solver: "bmpec",
            message: (!self.notes.is_empty()).then(|| self.notes.join("; ")),
            ..outcome
        };
        outcome.into()
    }

    /// A lower bound of the (minimised) objective, if one is wanted and there is one; and the better point
    /// that the search for it may come by.
    fn lower_bound(&mut self) -> Result<Option<f64>, SolveError> {
        let bounded = |f: &&Found| f.status != ModelStatus::Unbounded;
        let Some(found) = self.best.as_ref().filter(bounded).cloned() else {
            return Ok(None);
        };
        if self.options.bound == settings::Bound::None || self.is_over() {
            return Ok(None);
        }
        let (program, bound) = (self.program, self.options.bound);
        let level = &found.outcome.level;
        let proof = bound::lower(program, level, bound, self.budget);
        self.notes.extend(proof.note);
        if let Some(level) = proof.better {
            self.improve(&level)?;
        }
        Ok(proof.value)
    }

    /// Goes on from a point that satisfies the pairs.
    fn improve(&mut self, level: &[f64]) -> Result<(), SolveError> {
        let pieces = self.program.nearest(level);
        if let Some(f) = self.branch(pieces, level)? {
            self.descend(f)?;
        }
        Ok(())
    }

    /// No feasible point was found: is there none?
    fn infeasible(&mut self) -> Result<Reply, SolveError> {
        self.allow(FIRST_WORK.max(FIRST_ITERATIONS * self.size()));
        let stopped = self.budget.stop();
        let envelope = &self.program.envelope;
        let a = match envelope.is_linear() {
            true => {
                let task = Task::new(ProblemType::Lp, envelope);
                answer_with(BACKENDS, &task, self.settings, self.budget)?
            }
            false => self.program(self.choice, envelope, &[], u64::MAX, None)?,
        };
        let mut outcome = a.outcome;
        let status = stopped.map_or(SolverStatus::NormalCompletion, Stop::status);
        if self.program.judge(&outcome.level).feasible {
            // the pairs hold where the program without them was stopped
            return Ok(self.reply(outcome, Claim::Unfinished, status));
        }
        let claim = match a.status {
            ModelStatus::Infeasible => Claim::Infeasible,
            ModelStatus::LocallyInfeasible => Claim::LocallyInfeasible,
            _ => {
                if let Some(r) = self.reserve.take() {
                    outcome = r.outcome;
                }
                let note = match self.empty {
                    true => "no point satisfies all pairs, proved by branch and bound",
                    false => "no point that satisfies all pairs was found",
                };
                self.notes.push(note.into());
                match stopped {
                    _ if self.empty => Claim::Infeasible,
                    Some(_) => Claim::Unfinished,
                    None => Claim::LocallyInfeasible,
                }
            }
        };
        Ok(self.reply(outcome, claim, status))
    }
}
