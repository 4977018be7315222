//! From an instance to a certified answer, with any interior-point solver.
//!
//! A convex quadratic program goes to Clarabel, and a certified point is then a global optimum. The
//! status says so where Clarabel was asked for; a model that asks for no solver expects, as in GAMS,
//! a local optimum, and the message says that it is global.
//! Otherwise, or where that point is not good enough, the interior-point solver is asked first with ordinary options from the user's own start point. What comes
//! back is judged by the KKT residuals of the instance, not by the interior-point solver's word:
//!
//! * a point that satisfies them is looked at once more: negative curvature on the tangent space of
//!   what is active shows a saddle, which is left along that direction and solved again;
//! * anything else is tried again from the best point;
//! * a claim of infeasibility or unboundedness must show in the point.
//!
//! The first certified point wins. Where there is none, the best point that was seen is returned, and
//! called what it is.

use super::Convexity;
use super::consistent::consistent_start;
use super::growth::Growth;
use super::interior_point::{Ended, InteriorPoint, lock};
use super::interior_point_solvers;
use super::problem::Problem;
use super::quadratic::Quadratic;
use super::schedule::{
    AGREEMENT, CHEAP, ELSEWHERE, ENOUGH, FIRST_ATTEMPT_ITERATIONS, From, MAX_ATTEMPT_ITERATIONS,
    MIN_ATTEMPT_ITERATIONS, NEAR, OVERHEAD, TIMES,
};
use super::slqp::Effort;
use super::trial::{Trial, clean, polished, residuals_at, tidy, without_noise};
use crate::autodiff::{
    Degree, ErrorKind, EvalFailure, Evaluator, Kinks, curved_columns, kinks, second_derivatives,
};
use crate::model::instance::{Instance, KernelTerms, Op};
use crate::solve::backend::Task;
use crate::solve::budget::{Budget, Size};
use crate::solve::certificate::nonlinear::beside_kinks;
use crate::solve::factor_size::symmetric_size;
use crate::solve::random::Random;
use crate::solve::{Outcome, Settings, SolveError, Strategy, lp};
use std::cell::OnceCell;
use std::sync::{Arc, Mutex};

/// An objective better than this, at a feasible point, is called unbounded (GAMS's solvers: 1e15).
pub(super) const UNBOUNDED: f64 = 1e15;
/// A point is unbounded evidence from here on, if the interior-point solver stopped with diverging iterates.
const LARGE: f64 = 1e10;

/// How often derivatives are evaluated to find a start that has some.
const MAX_START_EVALUATIONS: u32 = 100;

/// Nonlinear equations from which on the interior point may go first.
const MANY_CURVED: usize = 50;

/// Entries of a Hessian, and operations of a step with its factors, up to which products with it are not thought of.
const MANY_ENTRIES: f64 = 1e6;
const DEAR: f64 = 1e8;
/// Addends of so many variables are few where there are so many times more columns.
const LONG: usize = 500;
const FEW: usize = 10;
/// Products that a step with factors must cost at least, and steps that all products may cost.
const CHEAPER: f64 = 200.0;
const STEPS_WORTH: f64 = 20.0;

/// Solves an instance and certifies the answer.
pub fn solve(
    task: &Task,
    interior_point: &dyn InteriorPoint,
    convexity: Convexity,
    settings: &Settings,
    budget: &Budget,
) -> Result<Outcome, SolveError> {
    let instance = task.instance;
    lp::form::validate(instance)?;
    let mut problem = Problem::new(instance);
    problem.seen = task.seen.cloned();
    if settings.switch("warm_start_init_point") == Some(true) {
        problem.use_marginals(instance);
    }
    let start = problem.start.clone();
    check_start(instance, &mut problem, &start)?;
    let mut was_moved = false;
    if settings.runs(Strategy::DifferentiableStart)
        && let Some(start) = differentiable(&mut problem, &start)
    {
        problem.start = start;
        was_moved = true;
    }
    let quadratic = match convexity {
        Convexity::Ignored => None,
        Convexity::Used => Quadratic::new(&mut problem, lp::QUADRATIC, budget),
        Convexity::Asked(engine) => Quadratic::new(&mut problem, engine, budget),
    };
    let quadratic = quadratic.filter(|_| settings.runs(Strategy::ConvexQuadratic));
    let refused = match (convexity, &quadratic) {
        (Convexity::Asked(engine), None) => Some(engine.name),
        _ => None,
    };
    if let Some(name) = refused.filter(|n| *n == lp::QUADRATIC.name) {
        return Err(SolveError::new(format!(
            "`option {} = {name}`: {name} takes convex programs, and this one is not known to be convex; `default` leaves the \
             choice to the program",
            task.using
        )));
    }
    let mut driver = Driver::new(instance, problem, interior_point, settings, budget);
    driver.message = refused.map(|name| {
        let own = interior_point.about().name;
        format!("not a convex quadratic program with linear rows: solved by {own}, not by {name}")
    });
    driver.was_moved = was_moved;
    driver.is_convex = quadratic.is_some();
    driver.named = matches!(convexity, Convexity::Ignored);
    driver.run(quadratic)
}

/// A program with bounds alone, each step on which would cost far more with the entries of its Hessian than by products with it. None
/// for all others, and where conjugate gradients do not settle it.
pub fn solve_by_products(task: &Task, settings: &Settings, budget: &Budget) -> Option<Outcome> {
    let instance = task.instance;
    let columns = &instance.columns;
    let ordered = columns
        .lower
        .iter()
        .zip(&columns.upper)
        .all(|(l, u)| l <= u);
    let free = task.choice.is_none() && task.seen.is_none() && task.is_continuous();
    let many = (columns.lower.len() as f64).powi(2) > MANY_ENTRIES;
    let applies = free && ordered && many && instance.row_count() == 1;
    if !applies || kinks(instance) == Some(Kinks::Anywhere) {
        return None;
    }
    if !settings.runs(Strategy::TruncatedNewton) {
        return None;
    }
    let most = most_products(instance)?;
    let mut problem = Problem::with_products(instance);
    let start = problem.start.clone();
    if problem.size().1 > 0 || problem.without_derivatives(&start).is_some() {
        return None;
    }
    let interior_point = *interior_point_solvers().first()?;
    let mut driver = Driver::new(instance, problem, interior_point, settings, budget);
    driver.products = Some(most);
    let settled = driver.settle_by_products().ok()?;
    settled.then(|| driver.finish())
}

/// How often the Hessian may be multiplied before [`STEPS_WORTH`] steps with its factors would have cost the same; none where these
/// are no dearer than [`CHEAPER`] products.
fn most_products(instance: &Instance) -> Option<u64> {
    let (entries, _) = second_derivatives(instance);
    if entries < MANY_ENTRIES {
        return None;
    }
    let n = instance.column_count();
    let sets = curved_columns(instance);
    let long = sets.iter().filter(|s| s.len() >= LONG).count();
    if long > 0 && FEW * long < n {
        // columns in their place leave few second derivatives
        return None;
    }
    let longest = sets.iter().map(Vec::len).max().unwrap_or(0);
    let factors = match 4 * longest >= n {
        true => (n as f64).powi(3) / 3.0,
        false => {
            symmetric_size("the factor of the Hessian", n, pairs(n, &sets).into_iter()).operations
        }
    };
    let size = |op: &Op| match op {
        Op::Affine(_, _, terms) => *terms as usize,
        _ => 1,
    };
    let each = |t: &KernelTerms| t.row.len() * t.kernel.ops.iter().map(size).sum::<usize>();
    let product = instance.nonlinear.iter().map(each).sum::<usize>() as f64;
    let step = entries + factors;
    (step > CHEAPER * product && step > DEAR).then_some((STEPS_WORTH * step / product) as u64)
}

/// Pairs of columns that stand in a set together.
fn pairs(n: usize, sets: &[Vec<u32>]) -> Vec<(usize, usize)> {
    let mut with = vec![Vec::new(); n];
    for set in sets {
        set.iter().for_each(|&j| with[j as usize].push(set));
    }
    let (mut seen, mut out) = (vec![usize::MAX; n], Vec::new());
    for (i, with) in with.into_iter().enumerate() {
        for &j in with.into_iter().flatten() {
            let j = j as usize;
            if j < i && seen[j] != i {
                seen[j] = i;
                out.push((i, j));
            }
        }
    }
    out
}

/// x moved by up to this fraction of its size (at least by this much), inwards from its bounds; or, where that is asked for, anywhere
/// between near bounds. With `by` 0 halfway between them, and where they are not near a unit away from where a variable without a level is.
fn placed(nlp: &Problem, x: &[f64], by: f64, anywhere: bool, seed: u64) -> Vec<f64> {
    let (lower, upper) = nlp.bounds();
    let mut random = Random(seed);
    let place = |(&x, (&l, &u)): (&f64, (&f64, &f64))| {
        let r = if by > 0.0 { random.uniform() } else { 0.5 };
        if anywhere && u - l <= 1e4 {
            return l + r * (u - l);
        }
        let there = match by {
            0.0 if x == 0.0_f64.max(l).min(u) => x + 1.0,
            _ => x + (2.0 * r - 1.0) * by * x.abs().max(1.0),
        };
        let inside = match there {
            y if y < l => 2.0 * l - y,
            y if y > u => 2.0 * u - y,
            y => y,
        };
        inside.max(l).min(u)
    };
    x.iter().zip(lower.iter().zip(upper)).map(place).collect()
}

/// Where rows have values at the start but no derivatives, as √x at 0: the start with the variables of these rows moved, by up to
/// their size or 1: where slopes are all but endless steps lead nowhere.
/// None: there are derivatives, or there are none nearby either.
fn differentiable(problem: &mut Problem, start: &[f64]) -> Option<Vec<f64>> {
    let mut variables = problem.without_derivatives(start)?;
    let moved = placed(problem, start, 1.0, false, 1);
    let mut x = start.to_vec();
    for _ in 1..MAX_START_EVALUATIONS {
        if variables.iter().all(|&j| x[j] == moved[j]) {
            break;
        }
        variables.iter().for_each(|&j| x[j] = moved[j]);
        match problem.without_derivatives(&x) {
            Some(others) => variables = others,
            None => return Some(x),
        }
    }
    None
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
    match problem.evaluator.rows(&level, &mut activity) {
        Err(e) if e.error.kind != ErrorKind::Overflow => Err(start_failure(&e)),
        _ => Ok(()),
    }
}

fn start_failure(e: &EvalFailure) -> SolveError {
    let (row, column) = (e.row as usize, e.column.map(|j| j as usize));
    let message = format!("a function cannot be evaluated at the start point: {e}");
    SolveError::at(Some(row), column, message)
}

pub(super) struct Driver<'a, 'm> {
    /// For instances with kinks: derivatives at slightly perturbed points.
    pub(super) kinks: Option<Evaluator>,
    /// A minimum of the violations, and multipliers of all rows that may prove it.
    pub(super) infeasibility: Option<(Trial, Vec<f64>)>,
    pub(super) instance: &'a Instance,
    pub(super) interior_point: &'a dyn InteriorPoint,
    pub(super) settings: &'a Settings,
    pub(super) budget: &'a Budget<'m>,
    /// A point that satisfies the KKT conditions is a global optimum.
    pub(super) is_convex: bool,
    /// The model asks for this interior-point solver.
    pub(super) named: bool,
    /// Name of who found the answer.
    pub(super) solver: &'static str,
    /// What the user is to hear in any case.
    pub(super) message: Option<String>,
    pub(super) start: Vec<f64>,
    /// The start had no derivatives, and was moved.
    pub(super) was_moved: bool,
    pub(super) problem: Arc<Mutex<Problem>>,
    pub(super) iterations: u64,
    pub(super) best: Option<Trial>,
    /// How the last run of the interior-point solver ended.
    pub(super) ended: Ended,
    /// The best point is a saddle from which a run diverged.
    pub(super) at_saddle: bool,
    /// There is no feasible point.
    pub(super) impossible: bool,
    /// How often negative curvature of the violation was followed.
    pub(super) violation_escapes: u32,
    /// Work after which no further attempt is begun.
    pub(super) enough: f64,
    /// What factors of the KKT matrix cost, once that is known.
    factors: OnceCell<Size>,
    /// Factors are too dear: the Hessian is only multiplied.
    pub(super) multiplies: bool,
    /// It has no entries, and may be multiplied so often.
    pub(super) products: Option<u64>,
    /// Iterations one attempt may take.
    pub(super) attempt_iterations: u64,
    /// What is done about runs that lead far away.
    pub(super) growth: Growth,
}

impl<'a, 'm> Driver<'a, 'm> {
    pub(super) fn new(
        instance: &'a Instance,
        problem: Problem,
        interior_point: &'a dyn InteriorPoint,
        settings: &'a Settings,
        budget: &'a Budget<'m>,
    ) -> Self {
        Self {
            kinks: beside_kinks(instance),
            infeasibility: None,
            instance,
            interior_point,
            settings,
            budget,
            is_convex: false,
            named: false,
            solver: interior_point.about().name,
            message: None,
            start: problem.start.clone(),
            was_moved: false,
            problem: Arc::new(Mutex::new(problem)),
            iterations: 0,
            best: None,
            ended: Ended::Broken,
            at_saddle: false,
            impossible: false,
            violation_escapes: 0,
            enough: f64::INFINITY,
            factors: OnceCell::new(),
            multiplies: false,
            products: None,
            attempt_iterations: FIRST_ATTEMPT_ITERATIONS,
            growth: Growth::Watched(0),
        }
    }
}

impl Driver<'_, '_> {
    fn run(&mut self, quadratic: Option<Quadratic>) -> Result<Outcome, SolveError> {
        let (n, m) = lock(&self.problem).size();
        if n == 0 || m == 0 && self.is_constant() {
            let x = self.start.clone();
            let trial = self.judge(x, vec![0.0; m], Ended::Solved);
            self.keep(trial);
            self.is_impossible();
            return Ok(self.finish());
        }
        if let Some(quadratic) = quadratic {
            self.attempt_quadratic(&quadratic);
            if self.is_settled() {
                self.solver = quadratic.name();
                return Ok(self.finish());
            }
        }
        if m == 0 && self.settle_by_products()? {
            return Ok(self.finish());
        }
        let again = self.attempt_again();
        if self.settle_at_once()? {
            return Ok(self.finish());
        }
        let interior_first = !self.named
            && self.is_mostly_nonlinear()
            && self.settings.runs(Strategy::InteriorFirst);
        let effort = if interior_first {
            Effort::AGAIN
        } else {
            Effort::FULL
        };
        let sequence_first = !self.named && (!interior_first || again);
        if sequence_first && (self.settle_by_sequence(again, effort)? || self.impossible) {
            return Ok(self.finish());
        }
        if self.infeasibility.is_some() {
            return Ok(self.finish());
        }
        let before = self.iterations;
        self.attempt(From::Start, &[])?;
        if self.enough > 0.0 {
            self.enough = ENOUGH.max(TIMES * self.work());
        }
        if self.is_settled() {
            // there is an answer: to look for a better one may not take much longer
            self.attempt_iterations = (4 * (self.iterations - before))
                .clamp(MIN_ATTEMPT_ITERATIONS, MAX_ATTEMPT_ITERATIONS);
        }
        self.leave_saddles()?;
        if self.is_settled() {
            self.growth = Growth::Ignored;
            self.search()?;
            return Ok(self.finish());
        }
        // whoever was named goes first, not alone
        let postponed = self.named || interior_first;
        let lacks_point = !self.best.as_ref().is_some_and(Trial::is_feasible);
        if postponed && lacks_point && self.settle_by_sequence(again, Effort::FULL)? {
            return Ok(self.finish());
        }
        if self.is_impossible() {
            return Ok(self.finish());
        }
        self.attempt_iterations = MAX_ATTEMPT_ITERATIONS;
        if self.kinks.is_some() && self.settings.runs(Strategy::KinkSmoothing) {
            self.round_kinks()?;
        }
        let lacks_point = !self.best.as_ref().is_some_and(Trial::is_feasible);
        let proved = self.infeasibility.is_some() && lacks_point;
        let goes_on = !self.is_settled() && !proved && self.work() <= self.enough;
        if goes_on && self.settings.runs(Strategy::RestartFromBest) {
            self.sequential(self.start_point(From::Best), None, Effort::FULL);
            self.leave_saddles()?;
            if !self.is_settled() {
                self.attempt(From::Best, NEAR)?;
                self.leave_saddles()?;
            }
        }
        Ok(self.finish())
    }

    /// Iterations times nonzeros so far: what decides how much is tried. Time would make the answer
    /// depend on the machine.
    pub(super) fn work(&self) -> f64 {
        self.iterations as f64 * self.work_of_iteration()
    }

    pub(super) fn work_of_iteration(&self) -> f64 {
        let problem = lock(&self.problem);
        let (n, m) = problem.size();
        let size = n + m + problem.jacobian_pattern().0.len() + problem.hessian_pattern().0.len();
        size as f64 + OVERHEAD
    }

    /// Looks for a better local optimum where that is cheap.
    pub(super) fn search(&mut self) -> Result<(), SolveError> {
        let optimal = |me: &Self| {
            me.best
                .as_ref()
                .filter(|t| t.is_optimal())
                .map(|t| t.objective)
        };
        let Some(first) = optimal(self) else {
            return Ok(());
        };
        if self.is_convex || self.work() > CHEAP || !self.wants_search() {
            return Ok(());
        }
        let mut agreed = true;
        for (k, from) in ELSEWHERE.into_iter().enumerate() {
            if self.is_stopped() || (k >= AGREEMENT && agreed) || self.work() > 5.0 * CHEAP {
                break;
            }
            let before = optimal(self);
            let found = self.attempt(from, NEAR)?;
            let same = found.is_none_or(|f| (f - first).abs() <= 1e-6 * first.abs().max(1.0));
            agreed &= same;
            if optimal(self) != before {
                self.leave_saddles()?;
            }
        }
        Ok(())
    }

    /// As many equations as variables, as in a general equilibrium that is written as a nonlinear program: linear
    /// programs would have nothing to choose.
    pub(super) fn is_square(&self) -> bool {
        let problem = lock(&self.problem);
        let (lower, upper) = problem.sides();
        let equations = lower.iter().zip(upper).filter(|(l, u)| l == u).count();
        equations >= problem.size().0
    }

    /// A discretised system, say: linear programs would see little of it, and their pivots would take longer than factors.
    fn is_mostly_nonlinear(&self) -> bool {
        let problem = lock(&self.problem);
        let degrees = problem.evaluator.degrees();
        let (lower, upper) = problem.sides();
        let sides = problem.rows.iter().zip(lower.iter().zip(upper));
        let (mut equations, mut inequalities) = (0, 0);
        for (_, (l, u)) in sides.filter(|s| degrees[*s.0 as usize] > Degree::Linear) {
            match l == u {
                true => equations += 1,
                false => inequalities += 1,
            }
        }
        let curved = equations + inequalities;
        // most inequalities do not hold as equations
        equations + inequalities / 10 >= MANY_CURVED && 4 * curved >= problem.rows.len()
    }

    /// Whether there may be several local optima, and the user lets us look for them.
    fn wants_search(&self) -> bool {
        self.settings.switch("nlp_search").unwrap_or(false)
    }

    fn is_constant(&self) -> bool {
        use super::problem::ObjectiveForm::{Constant, Nothing};
        matches!(lock(&self.problem).form, Nothing | Constant)
    }

    /// Nothing more needs to be tried.
    pub(super) fn is_settled(&self) -> bool {
        self.is_stopped()
            || self
                .best
                .as_ref()
                .is_some_and(|t| t.is_optimal() || self.is_unbounded(t))
    }

    pub(super) fn is_unbounded(&self, t: &Trial) -> bool {
        t.unbounded
            || t.is_feasible() && !t.is_optimal() && t.objective < -LARGE && {
                t.objective < -UNBOUNDED / 10.0 || t.ended == Ended::Diverging
            }
    }

    /// Whether no further attempt may be made.
    pub(super) fn is_stopped(&self) -> bool {
        self.budget.is_over()
    }

    /// Whether the budget leaves room for factors of the KKT matrix, which solvers make in one piece.
    pub(super) fn affords_factors(&mut self) -> bool {
        if self.multiplies {
            return false;
        }
        match self.budget.affords(|| self.size_of_factors()) {
            Ok(()) => true,
            Err(why) => {
                self.budget.log(&why);
                self.message = Some(why);
                // no further attempt
                self.enough = 0.0;
                false
            }
        }
    }

    /// What factors of the KKT matrix cost.
    pub(super) fn size_of_factors(&self) -> Size {
        *self.factors.get_or_init(|| {
            let problem = lock(&self.problem);
            let (n, m) = problem.size();
            let (rows, columns) = problem.jacobian_pattern();
            let jacobian = rows.iter().zip(columns);
            let jacobian = jacobian.map(|(&i, &j)| (n + i as usize, j as usize));
            let (rows, columns) = problem.hessian_pattern();
            let hessian = rows.iter().zip(columns);
            let hessian = hessian.map(|(&i, &j)| (i as usize, j as usize));
            let off_diagonal = jacobian.chain(hessian).filter(|(i, j)| i != j);
            symmetric_size("the factor of the KKT matrix", n + m, off_diagonal)
        })
    }

    /// Counts iterations.
    pub(super) fn spend(&mut self, iterations: u64) {
        self.iterations += iterations;
        self.budget.spend(iterations);
    }

    /// The point where an attempt starts.
    pub(super) fn start_point(&self, from: From) -> Vec<f64> {
        let (seed, by, anywhere) = match (from, &self.best) {
            (From::Best, Some(best)) => return best.x.clone(),
            (From::Best, None) | (From::Start, _) => return self.start.clone(),
            (From::Moved(by), _) => (12345, by, false),
            (From::Anywhere(seed), _) => (seed.wrapping_mul(7919), 1.0, true),
            (From::Middle, _) => (0, 0.0, true),
        };
        let problem = lock(&self.problem);
        placed(&problem, &self.start, by, anywhere, seed)
    }

    /// The start, with the variables that definitions give a value.
    pub(super) fn consistent(&self) -> Vec<f64> {
        let found = self.settings.runs(Strategy::ConsistentStart).then(|| {
            let problem = lock(&self.problem);
            let mut evaluator = Evaluator::first_order(self.instance);
            consistent_start(self.instance, &problem, &mut evaluator, &self.start)
        });
        found.flatten().unwrap_or_else(|| self.start.clone())
    }

    /// Puts a point into the bounds and computes its residuals.
    pub(super) fn judge(&mut self, mut x: Vec<f64>, lambda: Vec<f64>, ended: Ended) -> Trial {
        let affords = self.affords_factors();
        let mut problem = lock(&self.problem);
        let kinks = &mut self.kinks;
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
        let plain = residuals_at(self.instance, &mut problem, kinks, x, lambda, ended);
        let mut best = match tidy(self.instance, &mut problem, kinks, &plain) {
            Some(t) if t.is_optimal() || !plain.is_optimal() => t,
            _ => plain,
        };
        // who was stopped has no time for more factors, and chance would decide what they are worth
        let leaves_it = !affords || self.budget.stopped().is_some();
        let nearly = !leaves_it && best.residual() < 1e-2 && best.residual() > 1e-13;
        if nearly
            && self.settings.runs(Strategy::ActiveSetPolish)
            && let Some(t) = polished(self.instance, &mut problem, kinks, &best, 1e-6)
            && t.residual() < best.residual()
        {
            best = t;
        }
        if let Some(t) = without_noise(self.instance, &mut problem, kinks, &best) {
            best = t;
        }
        clean(self.instance, &mut best);
        if self.budget.wants_log() {
            self.budget.log(format!(
                "{ended:?}: objective {:.10e}, residuals of the model: primal {:.2e}, dual {:.2e}",
                best.objective, best.residuals.primal_relative, best.residuals.dual_relative
            ));
        }
        best
    }

    pub(super) fn keep(&mut self, trial: Trial) {
        let better = match &self.best {
            None => true,
            // a local optimum stays one, whatever lies elsewhere
            Some(old) if old.is_optimal() && self.growth == Growth::Ignored => {
                trial.is_optimal() && trial.better(old)
            }
            // a proof of unboundedness is not replaced by a worse point
            Some(old) => {
                !self.is_unbounded(old) && (self.is_unbounded(&trial) || trial.better(old))
            }
        };
        if better {
            self.best = Some(trial);
        }
    }
}
