//! Linear programs: form, scaling, simplex method or interior point with crossover, and the way back.
//!
//! [`Form`] takes an instance apart, [`Scaling`] changes the units, the simplex method finds the optimum, from an interior
//! point where it takes long, and the point returns the same way. See the modules for the mathematics.

mod barrier;
pub mod certify;
pub mod crossover;
pub mod form;
pub mod interior;
mod options;
mod presolve;
pub mod scale;
pub mod simplex;

use super::backend::{About, Backend, QuadraticEngine, Replied, Supports, Task, Terms};
use super::noise;
use super::strategy::{Strategies, Strategy};
use super::{Budget, Claim, Outcome, Progress, Settings, SolveError, SolverStatus, Stop};
use crate::model::instance::Instance;
use crate::model::problem_type::ProblemType;
use form::{Form, Point, Problem};
pub use options::OPTIONS;
use scale::Scaling;
use simplex::{Basis, Pivot, Simplex, State};
use std::cell::RefCell;
use std::rc::Rc;

/// Clarabel's interior-point method for convex quadratic programs; the active set found there is solved for afterwards.
pub(super) const QUADRATIC: QuadraticEngine = QuadraticEngine {
    name: "clarabel",
    solve: |linear, hessian, tolerance, budget| {
        interior::solve(linear, Some(hessian), tolerance, budget)
    },
};

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
    /// The user asked to stop.
    Interrupted,
    /// Numerical trouble.
    Failed,
    /// Not begun: why.
    TooLarge(String),
}

impl Ended {
    /// What the solver status says.
    pub(super) fn status(&self) -> SolverStatus {
        match self {
            Self::Solved | Self::Infeasible(_) | Self::Unbounded(_) => {
                SolverStatus::NormalCompletion
            }
            Self::Iterations => SolverStatus::IterationInterrupt,
            Self::Time | Self::TooLarge(_) => SolverStatus::ResourceInterrupt,
            Self::Interrupted => SolverStatus::UserInterrupt,
            Self::Failed => SolverStatus::TerminatedBySolver,
        }
    }

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
            Self::TooLarge(_) => "too large",
        }
    }
}

/// The solver of linear programs, `option lp = clarabel`: the simplex method, and where that takes long
/// an interior-point method and a finish by the simplex method. As `option lp = simplex` the simplex method alone.
///
/// Its options: [`OPTIONS`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Clarabel;

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
    fn new(settings: &Settings) -> Self {
        let text = settings.option("lp_accuracy").unwrap_or_default();
        match (text.as_str(), text.parse::<f64>()) {
            ("fast", _) => Self::Fast(1e-8),
            ("high", _) => Self::High,
            (_, Ok(t)) if t > 1e-9 => Self::Fast(t),
            (_, Ok(t)) if t < 1e-12 => Self::High,
            _ => Self::Standard,
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
    Restart(&'a Basis),
}

impl Backend for Clarabel {
    fn about(&self) -> About {
        About {
            name: "clarabel",
            aliases: &["simplex"],
            version: "lp: interior point on faer 0.24.4, then Clarabel 0.11.1, with a simplex finish on feral 0.22.0",
            supports: Supports::new(TYPES, Terms::Linear),
            options: &OPTIONS,
            option_files: &["clarabel"],
        }
    }

    fn quadratic(&self) -> Option<QuadraticEngine> {
        Some(QUADRATIC)
    }

    fn solve(&self, task: &Task, settings: &Settings, budget: &Budget) -> Replied {
        let method = match (settings.option("method").as_deref(), task.basis) {
            _ if task.choice == Some("simplex") => Method::Simplex,
            (_, Some(basis)) => Method::Restart(basis),
            (Some("interior"), _) => Method::Interior,
            (Some("crossover"), _) => Method::Crossover,
            (Some("simplex"), _) => Method::Simplex,
            _ => Method::Auto,
        };
        Ok(solve(task.instance, settings, budget, method)?.into())
    }
}

/// The problem types whose linear instances are linear programs, and whose smooth ones are nonlinear programs.
pub(super) const TYPES: &[ProblemType] = &[
    ProblemType::Lp,
    ProblemType::Rmip,
    ProblemType::Mip,
    ProblemType::Nlp,
    ProblemType::Dnlp,
    ProblemType::Rminlp,
    ProblemType::Minlp,
    ProblemType::Qcp,
    ProblemType::Rmiqcp,
    ProblemType::Miqcp,
    ProblemType::Mpec,
    ProblemType::Rmpec,
];

/// What a way gave, in the units of the scaled problem.
struct Gave {
    point: Point,
    ended: Ended,
    iterations: u64,
    solver: &'static str,
    almost: bool,
    /// The engine that gave it, at its last basis.
    engine: Option<Simplex>,
}

impl Gave {
    /// Of a vertex.
    fn basis(&self) -> Option<Basis> {
        let engine = self.engine.as_ref().filter(|_| self.ended == Ended::Solved);
        engine.map(Simplex::basis)
    }

    /// What is not unique about the solution.
    fn remark(&mut self) -> Option<&'static str> {
        let engine = self.engine.as_mut().filter(|_| self.ended == Ended::Solved);
        match engine?.others() {
            (true, true) => Some("neither the solution nor its marginals are unique"),
            (true, false) => Some("the solution is not unique"),
            (false, true) => Some("the marginals are not unique"),
            (false, false) => None,
        }
    }
}

fn solve(
    instance: &Instance,
    settings: &Settings,
    budget: &Budget,
    method: Method,
) -> Result<Outcome, SolveError> {
    if !instance.is_linear() {
        return Err(SolveError::new(
            "the model has nonlinear terms; this solver takes linear models",
        ));
    }
    let accuracy = Accuracy::new(settings);
    let strategies = settings.strategies();
    let tolerance = settings.number("tolerance");
    let mut form = Form::new(instance)?;
    let fixed = form.problem.move_fixed();
    let scaling = Scaling::new(&form.problem);
    let scaled = scaling.apply(&form.problem);
    budget.log_timed("scaling");
    let small = scaled.m() + scaled.n() <= MAX_SMALL_SIZE;
    let mut answer = match (method, accuracy) {
        (Method::Interior, _) => {
            interior_only(&scaled, [tolerance.unwrap_or(1e-10); 2].into(), budget)
        }
        (Method::Auto, Accuracy::Fast(t)) if !small => {
            let answer = interior_only(&scaled, [t; 2].into(), budget);
            match answer.ended {
                // Whatever is no solution is looked at more closely.
                Ended::Solved | Ended::Time | Ended::Interrupted => answer,
                _ => finished(&scaled, None, accuracy, strategies, budget),
            }
        }
        (Method::Crossover, _) => finished(&scaled, None, accuracy, strategies, budget),
        (Method::Simplex, _) => simplex_only(&scaled, accuracy, budget),
        (Method::Auto, _) if !small && strategies.run(Strategy::Presolve) => presolved(
            &form.problem,
            &scaling,
            &scaled,
            accuracy,
            strategies,
            budget,
        ),
        (Method::Auto, _) => auto(&scaled, accuracy, strategies, budget),
        (Method::Restart(from), _) => {
            let basis = form.basis(from);
            restarted(&scaled, &basis, accuracy, strategies, budget)
        }
    };
    let (basis, remark) = (answer.basis(), answer.remark());
    let pivots = answer.engine.take().and_then(|e| e.pivots);
    log_pivots(&pivots.unwrap_or_default(), &form, &scaling, budget);
    budget.spend(answer.iterations);
    let (claim, status) = match &answer.ended {
        Ended::Solved if answer.almost => (Claim::Unfinished, SolverStatus::TerminatedBySolver),
        Ended::Solved => (Claim::Solved, answer.ended.status()),
        Ended::Infeasible(_) => (Claim::Infeasible, answer.ended.status()),
        Ended::Unbounded(_) => (Claim::Unbounded, answer.ended.status()),
        other => (Claim::Unfinished, other.status()),
    };
    let message = match &answer.ended {
        Ended::TooLarge(why) => Some(why.clone()),
        _ => remark.map(str::to_string),
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
    let p = &form.problem;
    let errors = noise::rounding_in_rows(&point.x, p.m(), |i| p.rows.line(i));
    noise::snap(&mut point.x, &p.lower, &p.upper, &errors);
    point.x.iter_mut().zip(&fixed).for_each(|(x, v)| *x += v);
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
        message,
        basis: basis.map(|b| form.instance_basis(&b)),
    })
}

impl From<Stop> for Ended {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::Interrupted => Self::Interrupted,
            Stop::Time | Stop::Memory => Self::Time,
            Stop::Iterations | Stop::Evaluations => Self::Iterations,
        }
    }
}

/// Whether the simplex method must stop after so many iterations of its own: at this many at most.
pub fn watch<'a>(budget: &'a Budget, most: u64) -> impl FnMut(u64) -> Option<Ended> + 'a {
    let most = most.min(budget.iterations_left());
    move |iterations| match iterations >= most {
        true => Some(Ended::Iterations),
        false => {
            budget.tell(Progress {
                method: "simplex",
                iteration: iterations,
                ..Progress::default()
            });
            budget.stop().map(Ended::from)
        }
    }
}

fn simplex_only(p: &Problem, accuracy: Accuracy, budget: &Budget) -> Gave {
    let mut simplex = Simplex::new(p);
    simplex.flips = p.m() + p.n() > MAX_SMALL_SIZE;
    simplex.pivots = logged(p, budget);
    let ended = simplex.solve(&mut watch(budget, u64::MAX));
    concluded(simplex, ended, accuracy, budget)
}

/// What the simplex method gave, a solution with the digits that are wanted.
fn concluded(mut simplex: Simplex, ended: Ended, accuracy: Accuracy, budget: &Budget) -> Gave {
    if ended == Ended::Solved
        && let infeasible @ Ended::Infeasible(_) = tighten(&mut simplex, accuracy, budget)
    {
        return simplex_answer(simplex, infeasible);
    }
    simplex_answer(simplex, ended)
}

fn restarted(
    p: &Problem,
    basis: &Basis,
    accuracy: Accuracy,
    strategies: Strategies,
    budget: &Budget,
) -> Gave {
    let most = (100 + p.m() + p.n()) as u64;
    let mut simplex = Simplex::new(p);
    let ended = simplex.solve_from_basis(basis, &mut watch(budget, most));
    if matches!(ended, Ended::Failed | Ended::Iterations) {
        return auto(p, accuracy, strategies, budget);
    }
    let word = ended.word();
    budget.log_timed(&format!(
        "simplex: {word} after {} iterations",
        simplex.iterations
    ));
    concluded(simplex, ended, accuracy, budget)
}

/// The smaller program first; then on from its basis in the program as it was given.
fn presolved(
    given: &Problem,
    scaling: &Scaling,
    scaled: &Problem,
    accuracy: Accuracy,
    strategies: Strategies,
    budget: &Budget,
) -> Gave {
    let Some(reduced) = presolve::presolve(given) else {
        return auto(scaled, accuracy, strategies, budget);
    };
    let p = &reduced.problem;
    let line = format!("presolve: {} rows and {} columns are left", p.m(), p.n());
    budget.log_timed(&line);
    let units = Scaling::new(p);
    let mut gave = match reduced.proof.clone() {
        Some(mut y) => {
            units.carry_multipliers(&mut y);
            Gave {
                point: Point::default(),
                ended: Ended::Infeasible(y),
                iterations: 0,
                solver: "clarabel",
                almost: false,
                engine: None,
            }
        }
        None => auto(&units.apply(p), Accuracy::Fast(0.0), strategies, budget),
    };
    match (gave.ended.clone(), gave.basis()) {
        (Ended::Solved, Some(basis)) => {
            let (_, basis) = reduced.restore(&units.restore(gave.point), &basis);
            let mut done = restarted(scaled, &basis, accuracy, strategies, budget);
            if matches!(done.ended, Ended::Infeasible(_) | Ended::Unbounded(_)) {
                // contradicts the smaller program
                return auto(scaled, accuracy, strategies, budget);
            }
            done.iterations += gave.iterations;
            if gave.solver == "clarabel" {
                done.solver = gave.solver;
            }
            done
        }
        (Ended::Infeasible(mut y), _) => {
            units.restore_multipliers(&mut y);
            let mut y = reduced.restore_ray(&y);
            scaling.carry_multipliers(&mut y);
            if !scaled.proves_infeasible(&y) {
                return auto(scaled, accuracy, strategies, budget);
            }
            gave.ended = Ended::Infeasible(y);
            gave.point = Point {
                x: (0..given.n()).map(|j| scaled.at_bound(j)).collect(),
                y: vec![0.0; given.m()],
                d: vec![0.0; given.n()],
            };
            gave
        }
        (Ended::Iterations | Ended::Time | Ended::Interrupted, _)
            if gave.point.x.len() == p.n() && gave.point.y.len() == p.m() =>
        {
            let basis = vec![State::Basic; p.n() + p.m()];
            let (point, _) = reduced.restore(&units.restore(gave.point), &basis);
            gave.point = scaling.carry(point);
            gave
        }
        _ => auto(scaled, accuracy, strategies, budget),
    }
}

/// A place for the pivots, if they are to be seen.
fn logged(p: &Problem, budget: &Budget) -> Option<Vec<Pivot>> {
    (budget.wants_log() && p.m() + p.n() <= MAX_SMALL_SIZE).then(Vec::new)
}

/// A line for each pivot.
fn log_pivots(pivots: &[Pivot], form: &Form, scaling: &Scaling, budget: &Budget) {
    let name = |k: usize| match form.columns.get(k) {
        Some(&j) => budget.column_name(j as usize),
        None => budget.row_name(form.rows[k - form.columns.len()] as usize),
    };
    for (k, p) in pivots.iter().enumerate() {
        let value = form.sign * (p.objective * scaling.price * scaling.size + form.problem.offset);
        let (enters, leaves) = (name(p.entering), name(p.leaving));
        budget.log(format!(
            "pivot {}: {enters} enters the basis, {leaves} leaves, objective {value:.6}",
            k + 1
        ));
    }
}

/// How that ends: a proof that there is no point outweighs one to the usual tolerances.
fn tighten(simplex: &mut Simplex, accuracy: Accuracy, budget: &Budget) -> Ended {
    if matches!(accuracy, Accuracy::Fast(_)) {
        return Ended::Solved;
    }
    let before = simplex.iterations;
    let mut tight = simplex.tighten(&mut watch(budget, u64::MAX));
    if accuracy == Accuracy::High && tight == Ended::Solved {
        let finest = [(1e-14, 1e-13), (1e-14, 1e-14)];
        tight = simplex.tighten_to(&finest, &mut watch(budget, u64::MAX));
    }
    let pivots = simplex.iterations - before;
    let word = if tight == Ended::Solved { "" } else { "not " };
    let line = format!("tightened after {pivots} pivots: {word}to rounding");
    budget.log_timed(&line);
    tight
}

fn simplex_answer(mut simplex: Simplex, ended: Ended) -> Gave {
    let point = simplex.point();
    Gave {
        ended: if point.is_none() {
            Ended::Failed
        } else {
            ended
        },
        point: point.unwrap_or_default(),
        iterations: simplex.iterations,
        solver: "simplex",
        almost: false,
        engine: Some(simplex),
    }
}

/// The interior point of a program, and how good it is: as [`barrier::solve`] has it, and where that fails as Clarabel has it, which
/// tells programs without a solution.
fn interior_only(p: &Problem, goal: barrier::Goal, budget: &Budget) -> Gave {
    if is_trivial(p) {
        return simplex_only(p, Accuracy::Standard, budget);
    }
    let own = barrier::solve(p, None, None, goal, budget);
    if own.ended != Ended::Failed {
        return given(own);
    }
    // Clarabel takes a hundred iterations more for a digit beyond these.
    let tolerance = goal.tolerance.max(1e-10).min(goal.enough);
    given(interior::solve(p, None, tolerance, budget))
}

fn given(run: interior::Run) -> Gave {
    Gave {
        point: run.point,
        ended: run.ended,
        iterations: run.iterations,
        solver: "clarabel",
        almost: run.almost,
        engine: None,
    }
}

/// Columns and rows together up to which the simplex method is all that is needed, as a rule, and a presolve does not pay.
const MAX_SMALL_SIZE: usize = 200;

/// When the simplex method has touched so many numbers for each product in the Newton system, and for each row and column, or is likely to
/// do so as it goes on, an interior point is sooner there.
const WORK: [f64; 2] = [12.0, 1200.0];

/// The same for each product in its factorisation and each nonzero of the factor, once the order of its pivots is known: in networks the factor is
/// a hundred times the system.
const FACTOR_WORK: [f64; 2] = [0.5, 50.0];

/// The interior point from which a crossover begins: its tolerance, each digit of which saves pushes, and where none can be had that good, the least.
const FINE: f64 = 1e-11;
const USEFUL: f64 = 1e-7;

/// Pushes and pivots of a crossover, for each row and column, where another method is at hand.
const CLEAN_UP: u64 = 2;
/// One in so many of these is a push at most: what takes more goes round in circles, and the simplex method gets on better.
const PUSHES: u64 = 8;

/// Products of entries in the Newton system of an interior point: every entry of A meets those of its row, or of its column if these are fewer.
fn products(p: &Problem) -> f64 {
    let lines = (0..p.m()).map(|i| p.rows.line(i));
    let met = lines.flat_map(|l| {
        let row = l.len();
        l.map(move |(j, _)| row.min(p.columns.line(j).len()))
    });
    met.sum::<usize>() as f64
}

/// Numbers that the simplex method may touch before an interior point is likely to be there.
pub(in crate::solve) fn simplex_work(p: &Problem) -> f64 {
    match p.m() + p.n() {
        ..=MAX_SMALL_SIZE => f64::INFINITY,
        size => WORK[0] * products(p) + WORK[1] * size as f64,
    }
}

/// The simplex method where it is likely to be the faster one; the interior point and its finish for large programs and for
/// those that take it long.
fn auto(p: &Problem, accuracy: Accuracy, strategies: Strategies, budget: &Budget) -> Gave {
    let size = p.m() + p.n();
    let work = simplex_work(p);
    let effort = match size {
        ..=MAX_SMALL_SIZE => 1000 + 20 * size as u64,
        _ if strategies.run(Strategy::SimplexFirst) => u64::MAX,
        _ => return finished(p, None, accuracy, strategies, budget),
    };
    let mut simplex = Simplex::new(p);
    (simplex.most_work, simplex.flips) = (work, size > MAX_SMALL_SIZE);
    simplex.pivots = logged(p, budget);
    let layout = Rc::new(RefCell::new(None));
    let known = layout.clone();
    simplex.appeal = Some(Rc::new(move |simplex| {
        let layout = barrier::Layout::new(&simplex.problem_by_rows());
        let factor = layout
            .as_ref()
            .map(|l| FACTOR_WORK[0] * l.operations + FACTOR_WORK[1] * l.nonzeros);
        known.replace(layout);
        work.max(factor.unwrap_or(0.0) + WORK[1] * size as f64)
    }));
    let left = budget.iterations_left();
    let ended = simplex.solve(&mut watch(budget, effort));
    simplex.most_work = f64::INFINITY;
    let given_up = ended == Ended::Iterations && simplex.iterations < left;
    let stuck = ended == Ended::Failed || given_up;
    let word = if given_up { "given up" } else { ended.word() };
    let line = format!("simplex: {word} after {} iterations", simplex.iterations);
    budget.log_timed(&line);
    simplex.appeal = None;
    if stuck {
        return finished(p, layout.take(), accuracy, strategies, budget);
    }
    concluded(simplex, ended, accuracy, budget)
}

/// Interior point, then a basis from it, then the simplex method. Clarabel's point comes second: where none of the first leads to a
/// vertex, as in ill-conditioned programs and those without a solution.
fn finished(
    p: &Problem,
    layout: Option<barrier::Layout>,
    accuracy: Accuracy,
    strategies: Strategies,
    budget: &Budget,
) -> Gave {
    if is_trivial(p) {
        return simplex_only(p, accuracy, budget);
    }
    let goal = [FINE, USEFUL].into();
    let mut first = given(barrier::solve(p, None, layout, goal, budget));
    if first.ended != Ended::Failed {
        let (done, over) = finished_from(p, first, u64::MAX, accuracy, strategies, budget);
        if over {
            return done;
        }
        first = done;
    }
    let mut answer = given(interior::solve(p, None, 1e-10, budget));
    answer.iterations += first.iterations;
    let (second, _) = finished_from(p, answer, u64::MAX, accuracy, strategies, budget);
    match (&second.ended, &first.ended) {
        (Ended::Failed | Ended::TooLarge(_), Ended::Solved) => first,
        _ => second,
    }
}

/// A vertex and its basis, from an interior point, with so many pushes and pivots at most; false: the interior point is all there is.
fn finished_from(
    p: &Problem,
    mut answer: Gave,
    mut most: u64,
    accuracy: Accuracy,
    strategies: Strategies,
    budget: &Budget,
) -> (Gave, bool) {
    let mut simplex = Simplex::new(p);
    match answer.ended {
        Ended::Solved => {
            let wide = crossover::is_wide(p, &answer.point) && strategies.run(Strategy::FaceVertex);
            let of_face = wide.then(|| {
                let (face, centre) = crossover::face(p, &answer.point);
                barrier::solve(&face, Some(&centre), None, [FINE, USEFUL].into(), budget)
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
            budget.log_timed(&line);
            let of_face = of_face.as_ref().map(|f| &f.point);
            let start = crossover::start(p, &answer.point, of_face);
            let end = simplex.push(&start, &mut watch(budget, most / PUSHES));
            let count = simplex.iterations;
            let word = if end.is_ok() { "" } else { ", incomplete" };
            let outside = simplex.violation();
            let line = format!("crossover: {count} pushes{word}, bounds hold to {outside:.0e}");
            budget.log_timed(&line);
        }
        // A direction is no point: the simplex method finds one from which it leads on.
        Ended::Unbounded(_) | Ended::Failed | Ended::TooLarge(_) => {}
        Ended::Infeasible(ref y) if p.proves_infeasible(y) => return (answer, true),
        // An exact proof is worth some effort.
        Ended::Infeasible(_) => {
            most = most.min(1000 + 2 * (p.m() + p.n()) as u64);
        }
        _ => return (answer, true),
    }
    let ended = simplex.solve(&mut watch(budget, most));
    let pivots = simplex.iterations;
    let line = format!("simplex: {} after {pivots} iterations in all", ended.word());
    budget.log_timed(&line);
    let useful = matches!(
        ended,
        Ended::Solved | Ended::Infeasible(_) | Ended::Unbounded(_)
    );
    if !useful {
        let cut_short = matches!(ended, Ended::Interrupted | Ended::Time | Ended::Iterations);
        if answer.ended == Ended::Solved && cut_short {
            // The interior point is still the best there is.
            answer.ended = ended;
            return (answer, true);
        }
        return (answer, false);
    }
    let mut done = concluded(simplex, ended, accuracy, budget);
    if done.ended == Ended::Failed {
        return (answer, false);
    }
    done.iterations += answer.iterations;
    done.solver = "clarabel";
    (done, true)
}

/// The simplex method at the optimal vertex to which an interior point and a crossover lead, if they do within a
/// number of pivots.
pub(in crate::solve) fn crossed_over(
    p: &Problem,
    strategies: Strategies,
    budget: &Budget,
) -> Option<Simplex> {
    let goal = [FINE, USEFUL].into();
    let interior = given(barrier::solve(p, None, None, goal, budget));
    if interior.ended != Ended::Solved {
        return None;
    }
    let most = CLEAN_UP * (p.m() + p.n()) as u64;
    let accuracy = Accuracy::Fast(1e-9);
    let (gave, _) = finished_from(p, interior, most, accuracy, strategies, budget);
    gave.engine.filter(|_| gave.ended == Ended::Solved)
}

/// Whether a program has no free column, or no constraint: the simplex method ends at once, and Clarabel does not take it.
fn is_trivial(p: &Problem) -> bool {
    let all_fixed = (0..p.n()).all(|j| p.lower[j] == p.upper[j]);
    let mut sides = p.lower.iter().chain(&p.upper);
    all_fixed || p.m() == 0 && sides.all(|b| b.is_infinite())
}

#[cfg(test)]
mod random;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::instance::Sense;
    use crate::solve::Quiet;
    use crate::solve::dense::linear;

    #[test]
    fn numbers_that_are_none_are_refused() {
        let place = |instance: &Instance| {
            let mut quiet = Quiet::default();
            let task = Task::new(ProblemType::Lp, instance);
            let reply = Clarabel.solve(&task, &Settings::default(), &Budget::unlimited(&mut quiet));
            let error = reply.expect_err("an invalid instance");
            (error.row, error.column)
        };
        let valid = linear(Sense::Minimize, &[1., 1.], &[(0., 1.), (0., 2.)], &[]);
        for upper in [-1.0, f64::NAN] {
            let mut crossed = valid.clone();
            crossed.columns.upper[1] = upper;
            assert_eq!(place(&crossed), (None, Some(1)));
        }
        let (mut endless, mut entry) = (valid.clone(), valid);
        endless.rows.rhs[0] = f64::INFINITY;
        entry.matrix.value[0] = f64::NAN;
        assert_eq!(place(&endless).0, Some(0));
        assert_eq!(place(&entry).0, Some(0));
    }
}
