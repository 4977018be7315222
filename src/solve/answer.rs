//! One way for every instance: choose a backend, bridge, solve, restore, certify, and say the status; each once.
//!
//! The status that is reported follows from the residuals recomputed on the unscaled instance, and is never better than
//! what the backend claims.

use super::backend::{Backend, Reply, Task, choose, is_called};
use super::bridge::{
    Bridge, cones::Conic, elastic::Elastic, epigraph::Epigraph, inner_sums::InnerSums, kkt::Kkt,
    least_squares::LeastSquares, pieces, triangular::Triangular,
};
use super::budget::Size;
use super::certificate::{self, Residuals, TOLERANCE, nonlinear};
use super::lp::certify::{Proof, Unproved};
use super::mpec::Stationarity;
use super::mpec::pairs::Program;
use super::registry::BACKENDS;
use super::{
    Budget, Claim, ModelStatus, Outcome, Settings, SolveError, SolverStatus, Strategy, lp, mip,
    nlp, noise,
};
use crate::autodiff::{Evaluator, second_derivatives};
use crate::model::instance::{Instance, Relation};
use crate::model::problem_type::ProblemType;

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
    pub search: Option<mip::Report>,
}

impl Answer {
    /// A search ended without a solution: levels and marginals are as before.
    pub fn is_without_point(&self) -> bool {
        self.search.as_ref().is_some_and(|s| !s.solution)
    }
}

/// Solves an instance of a problem type with the backend chosen for it, if any; what people see.
pub fn answer(
    using: ProblemType,
    choice: Option<&str>,
    instance: &Instance,
    settings: &Settings,
    budget: &Budget,
) -> Result<Answer, SolveError> {
    let task = Task::new(using, instance).by(choice);
    answer_with(BACKENDS, &task, settings, budget)
}

/// The same with these backends.
pub fn answer_with(
    backends: &[&dyn Backend],
    task: &Task,
    settings: &Settings,
    budget: &Budget,
) -> Result<Answer, SolveError> {
    let mut found = solve(backends, task, settings, budget)?;
    // Rows that contradict each other by a rounding error neither hold nor prove that they cannot: the methods give up.
    let gave_up = found.outcome.claim == Claim::Unfinished
        && found.outcome.status == SolverStatus::TerminatedBySolver;
    use ModelStatus::{Infeasible, IntegerInfeasible};
    let contradicts = gave_up || matches!(found.status, Infeasible | IntegerInfeasible);
    if contradicts && is_linear_program(task) {
        found = least_violation(backends, task, found, settings, budget);
    }
    tell_of_rounding(&mut found);
    use ProblemType as P;
    let nonlinear =
        !task.instance.is_linear() || matches!(task.using, P::Nlp | P::Dnlp | P::Rminlp);
    if nonlinear && !task.has_integers() && !task.has_pairs() {
        equations_before_bounds(task.instance, &mut found.outcome);
    }
    if !task.instance.is_linear() || task.using == ProblemType::Mcp {
        without_noise(task, &mut found.outcome);
    }
    Ok(found)
}

/// Marginals without rounding errors; as they are where the point has no derivatives.
fn without_noise(task: &Task, outcome: &mut Outcome) {
    let instance = task.instance;
    let sizes = (outcome.row_marginal.len(), outcome.column_marginal.len());
    if sizes != (instance.row_count(), instance.column_count()) {
        return;
    }
    if task.using == ProblemType::Mcp {
        // marginals of rows are levels, those of columns what their rows are off by
        let (_, at) = point(instance, outcome);
        let matched = instance.matched.iter().flatten();
        for (d, i) in outcome.column_marginal.iter_mut().zip(matched) {
            if i.is_some_and(|i| noise::is_rounding(*d, at.row_size[i as usize].max(1.0))) {
                *d = 0.0;
            }
        }
        return;
    }
    let (y, d) = (&mut outcome.row_marginal, &mut outcome.column_marginal);
    if instance.is_linear() {
        // a column without a cost has no terms but errors
        let costs = instance.objective_row().into_iter().flat_map(|(i, own)| {
            let entries = instance.matrix.row(i);
            entries.map(move |(_, a)| (a / own).abs())
        });
        let least = costs.filter(|c| *c > 0.0).reduce(f64::min).unwrap_or(0.0);
        return noise::clear(|i| instance.matrix.row(i), least, y, d);
    }
    if let Ok(lines) = Evaluator::first_order(instance).jacobian_rows(&outcome.level) {
        // iterations leave errors of this unit, whatever the slopes
        noise::clear(|i| lines[i].iter().copied(), 1.0, y, d);
    }
}

/// A column at a bound that an equation of its own holds there as well has one marginal for both, which methods share out
/// in any way, even to two huge numbers of opposite sign: the equation takes it, whose right side is what a modeller
/// varies (a decomposition reads its cuts there). What the two add up to stays, and with it all residuals.
fn equations_before_bounds(instance: &Instance, outcome: &mut Outcome) {
    let (matrix, columns) = (&instance.matrix, &instance.columns);
    for (i, curved) in instance.nonlinear_rows().into_iter().enumerate() {
        let mut entries = matrix.row(i);
        let (Some((j, a)), None) = (entries.next(), entries.next()) else {
            continue;
        };
        let moves = instance.rows.relation[i] == Relation::Equal
            && !curved
            && columns.lower[j] < columns.upper[j];
        if moves && a != 0.0 {
            outcome.row_marginal[i] += std::mem::take(&mut outcome.column_marginal[j]) / a;
        }
    }
}

/// A program that a backend solves on its way, by any backend.
pub(super) fn subproblem(
    task: &Task,
    settings: &Settings,
    budget: &Budget,
) -> Result<Answer, SolveError> {
    solve(BACKENDS, task, settings, budget)
}

fn solve(
    backends: &[&dyn Backend],
    task: &Task,
    settings: &Settings,
    budget: &Budget,
) -> Result<Answer, SolveError> {
    let by = |way: Way| way(backends, task, settings, budget);
    if let Some(answer) = WAYS.into_iter().find_map(by) {
        return Ok(answer);
    }
    affords_hessian(task, budget)?;
    let backend = choose(backends, task).ok_or_else(|| missing(task))?;
    let reply = backend.solve(task, settings, budget)?;
    let found = certified(task, reply, None);
    Ok(pieces::without_descent(
        task, found, certified, settings, budget,
    ))
}

/// A way to an answer, where it applies and leads to one.
type Way = fn(&[&dyn Backend], &Task, &Settings, &Budget) -> Option<Answer>;

/// What is tried before a task is given to a backend as it is.
const WAYS: [Way; 7] = [
    over::<Kkt>,
    over::<Triangular>,
    over::<Epigraph>,
    by_cones,
    over::<LeastSquares>,
    by_products,
    over::<InnerSums>,
];

fn over<B: Bridge>(
    backends: &[&dyn Backend],
    task: &Task,
    settings: &Settings,
    budget: &Budget,
) -> Option<Answer> {
    let bridge = B::build(backends, task, settings)?;
    across(backends, &bridge, task, settings, budget)
}

/// Whether the user names Clarabel for a program that is not linear.
fn asks_for_clarabel(task: &Task) -> bool {
    let named = task
        .choice
        .is_some_and(|name| is_called(&lp::Clarabel, name));
    named && task.is_continuous() && !task.has_pairs() && !task.instance.is_linear()
}

/// A convex program: a point that has multipliers is optimal, and where no method finds one, Clarabel solves it by cones.
fn by_cones(
    backends: &[&dyn Backend],
    task: &Task,
    settings: &Settings,
    budget: &Budget,
) -> Option<Answer> {
    let instance = task.instance;
    let named = |name: &str| {
        backends
            .iter()
            .any(|b| b.takes(task) && is_called(*b, name))
    };
    let asked = asks_for_clarabel(task);
    if instance.is_linear()
        || !task.is_continuous()
        || !settings.runs(Strategy::Cones) && !asked
        || task.choice.is_some_and(named)
    {
        return None;
    }
    let conic = Conic::new(instance)?;
    let smooth = || {
        let mut without = settings.option("without").unwrap_or_default();
        without.push_str(",cones");
        let mut settings = settings.clone();
        settings.options.push(("without".into(), without));
        solve(backends, task, &settings, budget).ok()
    };
    let mut first = None;
    if !conic.has_apex && !asked {
        let found = convex(smooth()?, &conic);
        let limited = !matches!(
            found.outcome.status,
            SolverStatus::NormalCompletion | SolverStatus::TerminatedBySolver
        );
        use ModelStatus::{Infeasible, Optimal, Unbounded};
        if limited || matches!(found.status, Optimal | Unbounded | Infeasible) {
            return Some(found);
        }
        first = Some(found);
    }
    if let Some(found) = by_clarabel(backends, task, &conic, settings, budget) {
        return Some(found);
    }
    if asked {
        return None;
    }
    first.or_else(|| Some(convex(smooth()?, &conic)))
}

/// A point of a convex program that a method for smooth ones found: with multipliers it is optimal, but at the apex of a
/// squared row, where multipliers as large as they like make any point stationary.
fn convex(mut found: Answer, conic: &Conic) -> Answer {
    let proved = found.residuals.is_feasible(TOLERANCE)
        && found.residuals.dual_relative <= TOLERANCE
        && found.outcome.claim == Claim::LocallySolved;
    if found.status != ModelStatus::LocallyOptimal {
        return found;
    }
    if conic.squares_at_apex(&found.outcome.level).any(|at| at) {
        found.status = ModelStatus::Feasible;
        found.outcome.claim = Claim::Unfinished;
        found.outcome.message = Some(format!(
            "{}, which were not solved; a squared row has no multipliers at its apex, where this point is",
            conic.kinds()
        ));
    } else if proved {
        found.status = ModelStatus::Optimal;
        found.outcome.claim = Claim::Solved;
        if found.residuals.primal_relative <= ROUNDED {
            let said = || format!("convex: {}", conic.kinds());
            found.outcome.message.get_or_insert_with(said);
        }
    }
    found
}

/// The solution of the conic program.
fn by_clarabel(
    backends: &[&dyn Backend],
    task: &Task,
    conic: &Conic,
    settings: &Settings,
    budget: &Budget,
) -> Option<Answer> {
    let instance = task.instance;
    let solution = conic.solve(instance, budget)?;
    let mut reply = Reply::from(solution.outcome);
    let mut found = certified(task, reply.clone(), None);
    if reply.outcome.claim == Claim::Solved && !found.residuals.is_feasible(TOLERANCE) {
        // an error of a cone's coordinates is larger in their squares
        let value = |level: &[f64]| instance.objective.map_or(0.0, |o| level[o.column as usize]);
        let before = value(&reply.outcome.level);
        reply.outcome.level = nlp::onto_rows(instance, &reply.outcome.level, budget)?;
        let moved = (value(&reply.outcome.level) - before).abs();
        if moved > TOLERANCE * before.abs().max(1.0) {
            return None;
        }
        found = certified(task, reply.clone(), None);
    }
    if found.outcome.claim == Claim::Solved
        && solution.at_apex == 0
        && found.residuals.dual_relative > UNPOLISHED_RESIDUAL
        && let Some(polished) = polished(backends, task, &found, settings, budget)
    {
        return Some(polished);
    }
    if found.status != ModelStatus::Feasible || reply.outcome.claim != Claim::Solved {
        let proved = !matches!(found.status, ModelStatus::IntermediateInfeasible);
        return proved.then_some(found);
    }
    let found = certified(task, reply, Some(solution.residuals));
    found.status.is_solution().then_some(found)
}

/// What a program consists of that a solve recognises as convex: its cones, counted by kind. None for a linear one.
pub(crate) fn cones_of(using: ProblemType, instance: &Instance) -> Option<String> {
    if instance.is_linear() {
        return None;
    }
    let (task, settings) = (Task::new(using, instance), Settings::default());
    let there = |b: &dyn Bridge| cones_of(b.using(), b.instance());
    if let Some(b) = Triangular::build(BACKENDS, &task, &settings) {
        return there(&b);
    }
    if let Some(b) = Epigraph::build(BACKENDS, &task, &settings) {
        return match b.instance().is_linear() {
            true => Some("its kinks are rows of a linear program".into()),
            false => there(&b),
        };
    }
    Conic::new(instance).map(|c| c.kinds())
}

/// Cones leave about half of the digits of their gap in the multipliers of rows as they are written: with more residual than
/// this a method that has derivatives goes on from there.
const UNPOLISHED_RESIDUAL: f64 = 1e-9;

/// Iterations of that method.
const POLISH_ITERATIONS: u64 = 30;

/// The solution of a convex program, with better multipliers.
fn polished(
    backends: &[&dyn Backend],
    task: &Task,
    found: &Answer,
    settings: &Settings,
    budget: &Budget,
) -> Option<Answer> {
    let mut instance = task.instance.clone();
    instance.columns.level.clone_from(&found.outcome.level);
    instance
        .columns
        .marginal
        .clone_from(&found.outcome.column_marginal);
    instance
        .rows
        .marginal
        .clone_from(&found.outcome.row_marginal);
    let there = Task {
        instance: &instance,
        ..*task
    };
    let backend = choose(backends, &there)?;
    let reply = budget.within(f64::INFINITY, POLISH_ITERATIONS, |b| {
        backend.solve(&there, settings, b)
    });
    let mut reply = reply.ok()?;
    if !matches!(reply.outcome.claim, Claim::Solved | Claim::LocallySolved) {
        return None;
    }
    reply.outcome.claim = Claim::Solved;
    reply.outcome.iterations += found.outcome.iterations;
    reply.outcome.solver = found.outcome.solver;
    reply.outcome.message.clone_from(&found.outcome.message);
    let better = certified(task, reply, None);
    let proved = better.status == ModelStatus::Optimal
        && better.residuals.dual_relative < found.residuals.dual_relative;
    proved.then_some(better)
}

fn by_products(
    _: &[&dyn Backend],
    task: &Task,
    settings: &Settings,
    budget: &Budget,
) -> Option<Answer> {
    let outcome = nlp::solve_by_products(task, settings, budget)?;
    Some(certified(task, outcome.into(), None))
}

/// Solves the instance of a bridge, and comes back.
fn across(
    backends: &[&dyn Backend],
    bridge: &dyn Bridge,
    task: &Task,
    settings: &Settings,
    budget: &Budget,
) -> Option<Answer> {
    let there = Task {
        using: bridge.using(),
        instance: bridge.instance(),
        seen: None,
        basis: None,
        ..*task
    };
    let answer = match bridge.iterations() {
        u64::MAX => solve(backends, &there, settings, budget),
        most => budget.within(f64::INFINITY, most, |b| {
            solve(backends, &there, settings, b)
        }),
    };
    let answer = answer.ok()?;
    let reply = bridge.restore(task.instance, &answer)?;
    let own = bridge.has_own_multipliers().then_some(answer.residuals);
    Some(certified(task, reply, own))
}

fn missing(task: &Task) -> SolveError {
    let using = task.using;
    SolveError::new(match task.has_integers() {
        true => format!(
            "there is no solver for `{using}` with discrete variables; `using {}` solves the relaxation",
            using.relaxation()
        ),
        false => format!("there is no solver for this `{using}` in this build"),
    })
}

/// A reply with its residuals on the instance and the status that follows. `dual`: the residuals of the instance to which
/// the multipliers belong, if that is another one.
fn certified(task: &Task, reply: Reply, dual: Option<Residuals>) -> Answer {
    let Reply {
        mut outcome,
        stationarity,
        bounds,
        search,
    } = reply;
    if task.instance.is_linear() && task.using != ProblemType::Mcp {
        without_noise(task, &mut outcome);
    }
    let (mut residuals, activity) = measured(task, &outcome, search.as_ref());
    if let Some(dual) = dual {
        let instance = task.instance;
        residuals.dual = dual.dual;
        residuals.dual_relative = dual.dual_relative;
        residuals.complementarity = dual.complementarity;
        residuals.complementarity_sum = dual.complementarity_sum;
        residuals.worst_dual_row = dual.worst_dual_row.filter(|&i| i < instance.row_count());
        residuals.worst_dual_column = dual
            .worst_dual_column
            .filter(|&j| j < instance.column_count());
    }
    let status = match &search {
        Some(search) => status_of_search(task, search, &outcome, &residuals),
        None => status(task, &outcome, &residuals, &activity),
    };
    Answer {
        outcome,
        residuals,
        status,
        activity,
        stationarity,
        bounds,
        search,
    }
}

fn is_linear_program(task: &Task) -> bool {
    let instance = task.instance;
    instance.is_linear() && instance.objective.is_some() && !task.has_pairs()
}

/// A remark where a row of a solution misses more than rounding, which the tolerance allows.
fn tell_of_rounding(found: &mut Answer) {
    let remarkable = found.residuals.primal_relative > ROUNDED;
    if found.status.is_solution() && remarkable && found.outcome.message.is_none() {
        let miss = found.residuals.primal.unwrap_or(0.0);
        found.outcome.message = Some(format!(
            "a row is missed by {miss:.0e}, as rounded data are: that is within the tolerance"
        ));
    }
}

/// Residuals of an outcome, and the levels of the rows.
fn measured(task: &Task, outcome: &Outcome, search: Option<&mip::Report>) -> (Residuals, Vec<f64>) {
    let instance = task.instance;
    let level = &outcome.level;
    match (task.using, search) {
        (_, Some(search)) if !search.solution => {
            (Residuals::default(), nonlinear::activity(instance, level))
        }
        (_, Some(_)) if task.has_pairs() => branch(&mip::fixed(instance, level), outcome),
        (_, Some(_)) => program(&mip::fixed(instance, level), outcome),
        (ProblemType::Mcp, _) => {
            let (_, at) = point(instance, outcome);
            let residuals = certificate::complementarity(instance, level, &at);
            (residuals, at.activity)
        }
        _ if task.has_pairs() => branch(instance, outcome),
        _ => program(instance, outcome),
    }
}

/// Residuals of a program in continuous columns without pairs.
fn program(instance: &Instance, outcome: &Outcome) -> (Residuals, Vec<f64>) {
    let (residuals, at) = match instance.is_linear() && instance.objective.is_some() {
        true => {
            let at = certificate::linearise(instance, outcome);
            (certificate::residuals(instance, outcome, &at), at)
        }
        false => point(instance, outcome),
    };
    (residuals, at.activity)
}

fn point(instance: &Instance, outcome: &Outcome) -> (Residuals, certificate::Linearised) {
    let mut smoothed = nonlinear::beside_kinks(instance);
    let (level, marginal) = (&outcome.level, &outcome.row_marginal);
    nonlinear::measure(
        instance,
        &mut Evaluator::first_order(instance),
        &mut smoothed,
        level,
        marginal,
    )
}

/// Residuals of a program with pairs: primal ones without the products, complementarity of the pairs, and dual ones in the
/// branch to which the marginals belong.
fn branch(instance: &Instance, outcome: &Outcome) -> (Residuals, Vec<f64>) {
    let Ok(pairs) = Program::new(instance) else {
        return program(instance, outcome);
    };
    let judged = pairs.judge(&outcome.level);
    let mut residuals = judged.residuals;
    if outcome.row_marginal.iter().any(|m| *m != 0.0) {
        let pieces = pairs.pieces_with(&outcome.level, &judged.activity, &outcome.row_marginal);
        let (of_branch, _) = program(&pairs.branch(&pieces, &outcome.level), outcome);
        residuals.dual = of_branch.dual;
        residuals.dual_relative = of_branch.dual_relative;
    }
    (residuals, judged.activity)
}

/// What is known of a point: what is claimed, as far as the residuals confirm it.
fn status(task: &Task, outcome: &Outcome, residuals: &Residuals, activity: &[f64]) -> ModelStatus {
    use ModelStatus as S;
    let (instance, claim) = (task.instance, outcome.claim);
    if task.using == ProblemType::Mcp {
        return certificate::complementarity_status(residuals, claim);
    }
    if is_linear_program(task) {
        return certificate::linear_status(instance, outcome, residuals);
    }
    let pairs = task.has_pairs();
    let (level, marginal) = (&outcome.level, &outcome.row_marginal);
    let feasible = residuals.is_feasible(TOLERANCE)
        && (!pairs || residuals.natural_relative <= TOLERANCE)
        && !nonlinear::is_feasible_only_by_scaling(instance, level, marginal, activity);
    // what is proved of a program with pairs is a search for a way down, not its multipliers
    let stationary = feasible && (pairs || residuals.dual_relative <= TOLERANCE);
    let system = instance.objective.is_none() && task.using == ProblemType::Cns;
    match claim {
        _ if system && feasible => S::Solved,
        Claim::Solved if stationary => S::Optimal,
        Claim::LocallySolved if stationary => S::LocallyOptimal,
        Claim::WithoutMultipliers if feasible => S::LocallyOptimal,
        Claim::Unbounded => S::Unbounded,
        _ if feasible => S::Feasible,
        Claim::Infeasible => S::Infeasible,
        Claim::LocallyInfeasible if system || pairs || is_locally_infeasible(instance, outcome) => {
            S::LocallyInfeasible
        }
        _ => S::IntermediateInfeasible,
    }
}

fn is_locally_infeasible(instance: &Instance, outcome: &Outcome) -> bool {
    let (mut evaluator, ray) = (Evaluator::first_order(instance), &outcome.ray);
    ray.len() == instance.row_count()
        && nonlinear::is_locally_infeasible(instance, &mut evaluator, &outcome.level, ray, 1e-4)
}

/// The same of a search over discrete columns.
fn status_of_search(
    task: &Task,
    search: &mip::Report,
    outcome: &Outcome,
    residuals: &Residuals,
) -> ModelStatus {
    use ModelStatus as S;
    let feasible = residuals.is_feasible(TOLERANCE)
        && (!task.has_pairs() || residuals.natural_relative <= TOLERANCE);
    match (search.solution, outcome.claim) {
        (true, _) if !feasible => S::IntermediateNonInteger,
        (true, Claim::Unbounded) => S::Unbounded,
        (true, Claim::Solved) => S::Optimal,
        (true, _) => S::IntegerSolution,
        // The nonlinear solver found no point for the root: this is not due to integers.
        (false, Claim::LocallyInfeasible) if !search.relaxed => S::LocallyInfeasible,
        (false, Claim::Infeasible) if !search.relaxed && !task.instance.is_linear() => {
            S::Infeasible
        }
        (false, Claim::Infeasible | Claim::LocallyInfeasible) => S::IntegerInfeasible,
        (false, Claim::Unbounded) => S::UnboundedNoSolution,
        _ => S::NoSolution,
    }
}

/// To compile the program of a second derivative takes a microsecond or two, several times in a solve.
const OPERATIONS_PER_DERIVATIVE: f64 = 3e3;

/// Err where the second derivatives do not fit into the memory that is left: their pattern is made before anything else.
fn affords_hessian(task: &Task, budget: &Budget) -> Result<(), SolveError> {
    let size = || {
        let (nonzeros, compiled) = second_derivatives(task.instance);
        Size {
            what: "the matrix of second derivatives",
            nonzeros,
            operations: compiled * OPERATIONS_PER_DERIVATIVE,
        }
    };
    budget.affords(size).map_err(SolveError::new)
}

/// A proved interval for the optimal value of a linear instance, near its answer.
pub fn certify(instance: &Instance, answer: &Answer, budget: &Budget) -> Result<Proof, SolveError> {
    // What the status says is the better answer.
    let why = match answer.status {
        ModelStatus::Infeasible | ModelStatus::InfeasibleNoSolution => "the model is infeasible",
        ModelStatus::Unbounded | ModelStatus::UnboundedNoSolution => "the model is unbounded",
        ModelStatus::IntegerInfeasible | ModelStatus::NoSolution => "there is no solution",
        _ if answer.search.is_some() => {
            return super::mip::certified(instance, &answer.outcome, budget);
        }
        _ => return lp::certify::certify(instance, &answer.outcome, budget),
    };
    let nothing = Unproved::new(why);
    Ok(Proof {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
        no_low: Some(nothing.clone()),
        no_high: Some(nothing),
    })
}

/// From here on, relative as the tolerance is, what a row misses is worth a remark.
const ROUNDED: f64 = 1e-8;

/// What a program that is proved to have no point may miss, as after data that were rounded to seven digits: it is solved all
/// the same.
const ROUNDED_DATA_TOLERANCE: f64 = 1e-7;

/// What rows miss by the arithmetic alone.
const ARITHMETIC: f64 = 1e-12;

/// An infeasible linear program at its least violation (with integers: that of its relaxation); where that is within the
/// tolerance, as after data that were rounded, the optimum with the rows moved by it.
fn least_violation(
    backends: &[&dyn Backend],
    task: &Task,
    found: Answer,
    settings: &Settings,
    budget: &Budget,
) -> Answer {
    let instance = task.instance;
    let elastic = Elastic::new(instance);
    let any = task.by(None);
    let Some(near) = across(backends, &elastic, &any, &Settings::default(), budget) else {
        return found;
    };
    let primal = |r: &Residuals| r.primal.unwrap_or(f64::INFINITY);
    let integers = task.has_integers();
    let moves = !integers || primal(&near.residuals) > ARITHMETIC;
    let proved = matches!(
        found.status,
        ModelStatus::Infeasible | ModelStatus::IntegerInfeasible
    );
    let tolerance = if proved {
        ROUNDED_DATA_TOLERANCE
    } else {
        TOLERANCE
    };
    if moves && near.residuals.is_feasible(tolerance) {
        let moved = moved(instance, &near.activity);
        let inner = Task {
            instance: &moved,
            ..*task
        };
        if let Ok(mut there) = solve(backends, &inner, settings, budget) {
            there.outcome.iterations += found.outcome.iterations + near.outcome.iterations;
            let (residuals, activity) = measured(task, &there.outcome, there.search.as_ref());
            if there.status.is_solution() && residuals.is_optimal(TOLERANCE) {
                let most = primal(&residuals);
                there.outcome.message = Some(format!(
                    "the rows contradict each other by a rounding error: they hold to {most:.0e}"
                ));
                return Answer {
                    residuals,
                    activity,
                    ..there
                };
            }
        }
    }
    let nearer = primal(&found.residuals) <= primal(&near.residuals);
    if integers || found.status != ModelStatus::Infeasible && nearer {
        return found;
    }
    Answer {
        outcome: Outcome {
            iterations: found.outcome.iterations + near.outcome.iterations,
            level: near.outcome.level,
            row_marginal: near.outcome.row_marginal,
            column_marginal: near.outcome.column_marginal,
            ..found.outcome
        },
        residuals: near.residuals,
        activity: near.activity,
        ..found
    }
}

/// The program with its rows moved to where these levels satisfy them.
fn moved(instance: &Instance, activity: &[f64]) -> Instance {
    let mut near = instance.clone();
    for (i, &a) in activity.iter().enumerate() {
        let rhs = &mut near.rows.rhs[i];
        *rhs = match instance.rows.relation[i] {
            Relation::Equal => a,
            Relation::Greater => rhs.min(a),
            Relation::Less => rhs.max(a),
            Relation::Free => *rhs,
        };
    }
    near
}
