//! Solvers. They see an [`Instance`] of indices and numbers, never names.
//!
//! A solver's word is not believed: [`crate::model::certificate`] recomputes the residuals of the
//! point on the unscaled instance, and that decides the reported status.

pub mod answer;
pub mod complementarity;
#[cfg(test)]
pub mod conformance;
pub mod interval;
pub mod kkt;
pub mod lp;
pub mod mcp;
pub mod mip;
pub mod mpec;
pub mod nlp;
mod noise;
pub mod pairing;
pub mod random;
pub mod structure;
pub mod study;
pub mod why;

use crate::model::instance::Instance;

/// GAMS's model status codes, as far as they can occur.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum ModelStatus {
    /// Optimal (for mcp: solved).
    Optimal = 1,
    /// Locally optimal.
    LocallyOptimal = 2,
    /// Unbounded.
    Unbounded = 3,
    /// Infeasible.
    Infeasible = 4,
    /// Locally infeasible.
    LocallyInfeasible = 5,
    /// Not solved: the last point is infeasible.
    IntermediateInfeasible = 6,
    /// The last point is feasible, but not shown to be optimal.
    Feasible = 7,
    /// A solution with all discrete columns right, not shown to be the best.
    IntegerSolution = 8,
    /// Not solved, and the last point is no solution.
    IntermediateNonInteger = 9,
    /// No point satisfies rows, bounds and discrete columns.
    IntegerInfeasible = 10,
    /// Error, unknown.
    ErrorUnknown = 12,
    /// Error, no solution.
    ErrorNoSolution = 13,
    /// No solution returned.
    NoSolution = 14,
    /// A square system, solved uniquely.
    SolvedUnique = 15,
    /// A square system, solved.
    Solved = 16,
    /// Unbounded, no solution.
    UnboundedNoSolution = 18,
    /// Infeasible, no solution.
    InfeasibleNoSolution = 19,
}

impl ModelStatus {
    /// Whether the point that comes with it satisfies the rows and bounds, so that its numbers mean something.
    pub fn has_solution(self) -> bool {
        matches!(
            self,
            Self::Optimal
                | Self::LocallyOptimal
                | Self::Feasible
                | Self::SolvedUnique
                | Self::Solved
        )
    }

    /// GAMS's words for it, lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Optimal => "optimal",
            Self::LocallyOptimal => "locally optimal",
            Self::Unbounded => "unbounded",
            Self::Infeasible => "infeasible",
            Self::LocallyInfeasible => "locally infeasible",
            Self::IntermediateInfeasible => "intermediate infeasible",
            Self::Feasible => "feasible solution",
            Self::IntegerSolution => "integer solution",
            Self::IntermediateNonInteger => "intermediate non-integer",
            Self::IntegerInfeasible => "integer infeasible",
            Self::ErrorUnknown => "error unknown",
            Self::ErrorNoSolution => "error no solution",
            Self::NoSolution => "no solution returned",
            Self::SolvedUnique => "solved unique",
            Self::Solved => "solved",
            Self::UnboundedNoSolution => "unbounded - no solution",
            Self::InfeasibleNoSolution => "infeasible - no solution",
        }
    }
}

/// GAMS's solver status codes, as far as they can occur.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum SolverStatus {
    /// It ended as it should.
    NormalCompletion = 1,
    /// Iteration limit.
    IterationInterrupt = 2,
    /// Time limit.
    ResourceInterrupt = 3,
    /// The solver gave up.
    TerminatedBySolver = 4,
    /// Too many evaluation errors.
    EvaluationInterrupt = 5,
    /// The solver cannot take this model.
    CapabilityProblems = 6,
    /// Ctrl-C.
    UserInterrupt = 8,
    /// Something failed inside.
    InternalSolverFailure = 11,
    /// It was not asked, because of errors before.
    ProcessingSkipped = 12,
}

impl SolverStatus {
    /// GAMS's words for it, lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::NormalCompletion => "normal completion",
            Self::IterationInterrupt => "iteration interrupt",
            Self::ResourceInterrupt => "resource interrupt",
            Self::TerminatedBySolver => "terminated by solver",
            Self::EvaluationInterrupt => "evaluation interrupt",
            Self::CapabilityProblems => "capability problems",
            Self::UserInterrupt => "user interrupt",
            Self::InternalSolverFailure => "internal solver failure",
            Self::ProcessingSkipped => "solve processing skipped",
        }
    }
}

/// What a solver claims, besides the point.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Claim {
    /// Solved to tolerance.
    Solved,
    /// Proved (to tolerance) infeasible, with a certificate in `Outcome::ray` where there is one.
    Infeasible,
    /// Proved (to tolerance) unbounded, with a direction in `Outcome::ray` where there is one.
    Unbounded,
    /// Stopped early or stuck: the point is the best there is.
    Unfinished,
}

/// What a solver returns: a point in the instance's own units.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Level of each column.
    pub level: Vec<f64>,
    /// Marginal of each row: d objective / d right-hand side (mcp: level of the matched column).
    pub row_marginal: Vec<f64>,
    /// Marginal (reduced cost) of each column: d objective / d bound (mcp: F).
    pub column_marginal: Vec<f64>,
    /// What the solver claims.
    pub claim: Claim,
    /// How it ended.
    pub status: SolverStatus,
    /// Iterations.
    pub iterations: u64,
    /// Name of the solver that ran, lower case.
    pub solver: &'static str,
    /// For `Infeasible`: row multipliers; for `Unbounded`: column direction. May be empty.
    pub ray: Vec<f64>,
    /// One line for the person where there is more to say.
    pub message: Option<String>,
    /// For linear programs solved to a vertex: the basis, a state per column and row of [`lp::form::Problem`].
    pub basis: Option<lp::simplex::Basis>,
}

/// Limits and switches common to all solvers.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Seconds, `reslim` / `--time-limit`.
    pub time_limit: f64,
    /// `iterlim`.
    pub iteration_limit: u64,
    /// `domlim`: evaluation errors allowed.
    pub evaluation_error_limit: u64,
    /// Solver options by name, from an option file or `--option`.
    pub options: Vec<(String, String)>,
    /// Whether a log is wanted.
    pub log: bool,
    /// What a search over discrete columns is to reach.
    pub search: mip::Aim,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            time_limit: 1e10,
            iteration_limit: 2_147_483_647,
            evaluation_error_limit: 0,
            options: Vec::new(),
            log: false,
            search: mip::Aim::default(),
        }
    }
}

/// Options of bmod's own methods. The `option` statement takes them as well, and no other solver sees them.
pub const OWN_OPTIONS: &[&str] = &[
    "lp_accuracy",
    "mpec_bound",
    "mpec_factor",
    "mpec_method",
    "mpec_mu",
    "mpec_mu_end",
    "mpec_nodes",
    "mpec_relaxation",
    "mpec_starts",
    "mpec_swaps",
    "nlp_attempts",
    "nlp_search",
];

impl Settings {
    /// A solver option's text, lower case: what was said last counts.
    pub fn option(&self, name: &str) -> Option<String> {
        let mut asked = self.options.iter().rev();
        let of = asked.find(|(k, _)| k.eq_ignore_ascii_case(name));
        of.map(|(_, v)| v.to_lowercase())
    }
}

/// The solver's line to the outside.
pub trait Monitor {
    /// A line of the log.
    fn log(&mut self, line: &str);
    /// True once the person has asked to stop.
    fn interrupted(&mut self) -> bool;
    /// Name of a row for the log.
    fn row_name(&self, row: usize) -> String;
    /// Name of a column for the log.
    fn column_name(&self, column: usize) -> String;
}

/// A monitor that says nothing.
pub struct Quiet;

impl Monitor for Quiet {
    fn log(&mut self, _: &str) {}
    fn interrupted(&mut self) -> bool {
        false
    }
    fn row_name(&self, row: usize) -> String {
        format!("row {row}")
    }
    fn column_name(&self, column: usize) -> String {
        format!("column {column}")
    }
}

/// Why a solver did not run at all.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveError {
    /// In the reader's terms; names are put in by the caller.
    pub message: String,
    /// The row to name, if one is to blame.
    pub row: Option<usize>,
    /// The column to name, if one is to blame.
    pub column: Option<usize>,
}

impl SolveError {
    /// With no row or column to blame.
    pub fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            row: None,
            column: None,
        }
    }
}

/// A solver for some problem types.
pub trait Solver {
    /// Lower-case name, as in `option lp = name`.
    fn name(&self) -> &'static str;
    /// Solves. Err only for an instance that it cannot take.
    fn solve(
        &self,
        instance: &Instance,
        settings: &Settings,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, SolveError>;
}
