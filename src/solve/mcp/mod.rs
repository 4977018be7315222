//! Mixed complementarity problems, in the manner of PATH.
//!
//! Given F: ℝⁿ → ℝⁿ and bounds l ≤ u (infinite ones allowed), find x with l ≤ x ≤ u and, for
//! every i, one of
//!
//! ```text
//! xᵢ = lᵢ and Fᵢ(x) ≥ 0,     lᵢ < xᵢ < uᵢ and Fᵢ(x) = 0,     xᵢ = uᵢ and Fᵢ(x) ≤ 0,
//! ```
//!
//! that is x = mid(l, u, x − F(x)); the distance max |x − mid(l, u, x − F(x))| is the *natural
//! residual* and decides what this module calls solved.
//!
//! The method is that of Dirkse & Ferris (1995): a stabilised Newton method on the nonsmooth
//! equation of the problem, whose subproblem, the linear MCP of the linearised F, is solved by
//! following a piecewise linear path with Lemke-type pivots ([`path`]). Around it: fixed variables leave
//! ([`fixed`]), a crash by projected Newton steps ([`crash`]) or, where there are many variables, by interior steps
//! ([`interior`]), a watchdog on the Fischer–Burmeister merit function ([`majors`], [`merit`]), and random restarts
//! ([`portfolio`]). Sources:
//!
//! - S. P. Dirkse, M. C. Ferris: The PATH solver, a non-monotone stabilization scheme for mixed
//!   complementarity problems. Optimization Methods and Software 5 (1995).
//! - M. C. Ferris, T. S. Munson: Complementarity problems in GAMS and the PATH solver. Journal of
//!   Economic Dynamics and Control 24 (2000).
//!
//! The module knows numbers only: no names, no language. It is deterministic: the random numbers
//! it needs come from fixed seeds, and no decision depends on the clock but the time limit.

mod basis;
mod crash;
mod factor;
mod fixed;
mod interior;
mod linear;
mod log;
mod majors;
mod merit;
mod options;
mod path;
mod portfolio;
mod random;
mod run;

use super::Budget;
use super::strategy::Strategies;
pub use merit::natural_residual;
pub use options::OPTIONS;

/// What is known of a problem before it is evaluated.
#[derive(Debug, Clone, Default)]
pub struct Data {
    /// Lower bounds, one per variable; −∞ allowed (−1e20 and less counts as −∞).
    pub lower: Vec<f64>,
    /// Upper bounds, one per variable; +∞ allowed (1e20 and more counts as +∞).
    pub upper: Vec<f64>,
    /// Where to start; need not lie within the bounds.
    pub start: Vec<f64>,
    /// Jacobian pattern, compressed by columns: where each column starts, and where the last one ends.
    pub column_start: Vec<usize>,
    /// Its row indices, sorted within each column.
    pub rows: Vec<usize>,
    /// F is affine: one linearisation is exact.
    pub is_linear: bool,
}

/// Find l ≤ x ≤ u with x = mid(l, u, x − F(x)).
pub trait Problem {
    /// Bounds, start and pattern.
    fn data(&self) -> &Data;
    /// F(x) into `f`; an error if a function cannot be evaluated there.
    fn function(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), EvalError>;
    /// Values of the Jacobian at x, in pattern order.
    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), EvalError>;
}

/// A function or derivative that cannot be evaluated at a point.
#[derive(Debug, Clone)]
pub struct EvalError {
    /// The row it belongs to, if known.
    pub row: Option<usize>,
    /// What went wrong.
    pub message: String,
}

/// What the solver may spend and how exact it shall be. Names are PATH's where the meaning is.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Natural residual at which the problem is solved; one more major iteration is then made and
    /// kept if it lowers the residual. Default 1e-8.
    pub convergence_tolerance: f64,
    /// Natural residual still called solved when no method gets below `convergence_tolerance`
    /// (singular, degenerate solutions). Default 1e-6, PATH's convergence tolerance.
    pub acceptable_tolerance: f64,
    /// Whether the projected Newton crash is made before the first major iteration. Default true
    /// (PATH: `crash_method pnewton`; false: `none`).
    pub crash_method: bool,
    /// Crash iterations at most. Default 50.
    pub crash_iteration_limit: usize,
    /// Major iterations at most, per run of the main method. Default 120.
    pub major_iteration_limit: usize,
    /// Pivots at most over all runs. Default 10 million.
    pub cumulative_iteration_limit: usize,
    /// Pivots at most per linear subproblem; 0 chooses by size. Default 0.
    pub minor_iteration_limit: usize,
    /// Proximal term the first major iteration starts with. Default 0: it comes into play only when
    /// a linear subproblem without it has no solution.
    pub proximal_perturbation: f64,
    /// Memory of the nonmonotone reference value. Default 10.
    pub nms_memory_size: usize,
    /// Random restarts, after all methods failed from the given start. Default: up to 30, while they are cheap or have cost
    /// no more than what was tried before.
    pub restart_limit: Option<usize>,
    /// Seconds. Default: no limit but the budget's.
    pub time_limit: f64,
    /// Which fallbacks and special treatments run. Default: all.
    pub strategies: Strategies,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The natural residual of the returned point, from a fresh F(x) on the given problem, is
    /// within tolerance.
    Solved,
    /// A limit on iterations or pivots ended the run.
    IterationLimit,
    /// The time limit ended the run.
    TimeLimit,
    /// The user asked to stop.
    Interrupted,
    /// All methods from all starts failed. No proof that there is no solution.
    NoSolution,
    /// F or its Jacobian cannot be evaluated at any starting point tried.
    EvaluationFailed,
    /// A lower bound lies above the upper one, or a bound is not a number.
    InvalidBounds,
    /// The problem's arrays contradict each other (lengths, pattern not sorted, index out of range).
    InvalidProblem,
}

/// What [`solve`] returns.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// How the run ended.
    pub status: Status,
    /// The point: the solution, or the best one seen (least natural residual).
    pub x: Vec<f64>,
    /// F at that point (NaN where it could not be evaluated).
    pub f: Vec<f64>,
    /// Natural residual there, unscaled; infinite if F could not be evaluated.
    pub residual: f64,
    /// Major iterations, over all methods.
    pub majors: usize,
    /// Pivots of the path (PATH: minor iterations).
    pub pivots: usize,
    /// Crash iterations.
    pub crash_iterations: usize,
    /// Factorisations of a matrix, all kinds.
    pub factorisations: usize,
    /// Restarts from random points.
    pub restarts: usize,
    /// Evaluations of F.
    pub evaluations: usize,
    /// Why, for a status that wants an explanation; may be empty.
    pub message: String,
}

impl Outcome {
    /// A point of which nothing is known but how the run ended.
    fn at(x: Vec<f64>, status: Status) -> Self {
        Self {
            status,
            f: vec![f64::NAN; x.len()],
            x,
            residual: f64::INFINITY,
            majors: 0,
            pivots: 0,
            crash_iterations: 0,
            factorisations: 0,
            restarts: 0,
            evaluations: 0,
            message: String::new(),
        }
    }
}

/// Names of row i and of its variable, for the log.
pub type Names<'a> = &'a dyn Fn(usize) -> String;

/// Bounds beyond this count as infinite, as in PATH and GAMS.
pub const INFINITY: f64 = 1e20;

/// Solves a mixed complementarity problem.
///
/// Never panics on numbers: bad bounds, functions undefined at the start, singular Jacobians and
/// problems without a solution end in a [`Status`]. `Solved` is said only of a point whose natural
/// residual was recomputed, on the problem as given, from a fresh F.
pub fn solve(
    problem: &mut dyn Problem,
    settings: &Settings,
    budget: &Budget,
    names: Names,
) -> Outcome {
    portfolio::solve(problem, settings, budget, names)
}
