//! What the driver and the solvers of nonlinear programs say to each other.

use super::problem::Problem;
use crate::solve::backend::About;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// How an interior-point solver says it ended, in Ipopt's distinctions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Ended {
    /// Converged to its tolerance.
    Solved,
    /// Converged to its acceptable tolerance, or to a feasible point of a square system.
    Acceptable,
    /// Converged to a point of local infeasibility.
    Infeasible,
    /// The step became too small.
    SmallStep,
    /// The iterates diverge.
    Diverging,
    /// Stopped by the driver (Ctrl-C or time).
    Stopped,
    /// Iteration limit.
    Iterations,
    /// Time limit.
    Time,
    /// Restoration failed, or a step could not be computed.
    Failed,
    /// More equations than variables.
    TooFewDegrees,
    /// An evaluation gave an invalid number where that is fatal (at the start).
    InvalidNumber,
    /// An option was refused.
    InvalidOption,
    /// Not begun: its factors do not fit.
    TooLarge,
    /// Anything else.
    Broken,
}

/// An interior-point solver's answer, in the variables of the [`Problem`].
#[derive(Clone, Debug)]
pub struct Solution {
    /// How it ended.
    pub ended: Ended,
    /// Point.
    pub x: Vec<f64>,
    /// Multipliers λ of the constraints, L = f + λᵀg.
    pub lambda: Vec<f64>,
    /// Iterations.
    pub iterations: u64,
}

impl Solution {
    /// A point without multipliers.
    pub(super) fn without_multipliers(ended: Ended, x: Vec<f64>, nlp: &Problem) -> Self {
        Self {
            ended,
            x,
            lambda: vec![0.0; nlp.size().1],
            iterations: 0,
        }
    }
}

/// Numbers of one iteration.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Number of the iteration.
    pub iteration: u64,
    /// Objective, minimised.
    pub objective: f64,
    /// Primal infeasibility.
    pub primal: f64,
    /// Dual infeasibility.
    pub dual: f64,
    /// Barrier parameter.
    pub mu: f64,
    /// Primal step length.
    pub step: f64,
    /// In the restoration phase.
    pub restoration: bool,
}

/// Limits, and the driver's ear.
pub struct Control<'c> {
    /// Options by Ipopt's names, later ones overriding earlier ones.
    pub options: Vec<(String, String)>,
    /// Iterations.
    pub iterations: u64,
    /// Seconds left, if there is a limit.
    pub seconds: Option<f64>,
    /// Factors fill up: the order of the elimination is worth some search.
    pub fills: bool,
    /// Called once per iteration; false stops.
    pub watch: &'c mut dyn FnMut(&Progress) -> bool,
}

impl Control<'_> {
    /// What is to be set: silence, the iteration limit, and what was asked for.
    pub fn all_options(&self) -> Vec<(String, String)> {
        let limit = self.iterations.min(1_000_000_000).to_string();
        let own = [("print_level", "0"), ("sb", "yes"), ("max_iter", &limit)];
        let own = own.map(|(k, v)| (k.to_string(), v.to_string()));
        own.into_iter().chain(self.options.clone()).collect()
    }
}

/// A problem that an interior-point solver may take to another thread.
pub type Shared = Arc<Mutex<Problem>>;

/// Locks the problem, also after a panic of an interior-point solver: it holds numbers only.
pub fn lock<T>(nlp: &Mutex<T>) -> MutexGuard<'_, T> {
    nlp.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A solver of nonlinear programs.
pub trait InteriorPoint: Sync {
    /// What it is and what it takes.
    fn about(&self) -> About;
    /// Solves. Err: an option that the interior-point solver does not take, in words.
    fn solve(&self, nlp: Shared, control: &mut Control<'_>) -> Result<Solution, String>;
}
