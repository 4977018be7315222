//! What a solver returns, and the statuses of an answer.

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
    /// Whether the point is a solution: optimal, locally optimal, or a solved system.
    pub fn is_solution(self) -> bool {
        matches!(
            self,
            Self::Optimal | Self::LocallyOptimal | Self::Solved | Self::SolvedUnique
        )
    }

    /// Whether the point that comes with it satisfies the rows and bounds, so that its numbers mean something.
    pub fn has_solution(self) -> bool {
        self.is_solution() || matches!(self, Self::Feasible | Self::IntegerSolution)
    }

    /// GAMS's words for them, lower case.
    const NAMES: &[(Self, &str)] = &[
        (Self::Optimal, "optimal"),
        (Self::LocallyOptimal, "locally optimal"),
        (Self::Unbounded, "unbounded"),
        (Self::Infeasible, "infeasible"),
        (Self::LocallyInfeasible, "locally infeasible"),
        (Self::IntermediateInfeasible, "intermediate infeasible"),
        (Self::Feasible, "feasible solution"),
        (Self::IntegerSolution, "integer solution"),
        (Self::IntermediateNonInteger, "intermediate non-integer"),
        (Self::IntegerInfeasible, "integer infeasible"),
        (Self::ErrorUnknown, "error unknown"),
        (Self::ErrorNoSolution, "error no solution"),
        (Self::NoSolution, "no solution returned"),
        (Self::SolvedUnique, "solved unique"),
        (Self::Solved, "solved"),
        (Self::UnboundedNoSolution, "unbounded - no solution"),
        (Self::InfeasibleNoSolution, "infeasible - no solution"),
    ];

    /// GAMS's words for it, lower case.
    pub fn name(self) -> &'static str {
        Self::name_of(f64::from(self as u8)).unwrap_or_default()
    }

    /// The words for a code, if it is one.
    pub(crate) fn name_of(code: f64) -> Option<&'static str> {
        let mut rows = Self::NAMES.iter();
        rows.find(|r| f64::from(r.0 as u8) == code).map(|r| r.1)
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
    /// GAMS's words for them, lower case.
    const NAMES: &[(Self, &str)] = &[
        (Self::NormalCompletion, "normal completion"),
        (Self::IterationInterrupt, "iteration interrupt"),
        (Self::ResourceInterrupt, "resource interrupt"),
        (Self::TerminatedBySolver, "terminated by solver"),
        (Self::EvaluationInterrupt, "evaluation interrupt"),
        (Self::CapabilityProblems, "capability problems"),
        (Self::UserInterrupt, "user interrupt"),
        (Self::InternalSolverFailure, "internal solver failure"),
        (Self::ProcessingSkipped, "solve processing skipped"),
    ];

    /// GAMS's words for it, lower case.
    pub fn name(self) -> &'static str {
        Self::name_of(f64::from(self as u8)).unwrap_or_default()
    }

    /// The words for a code, if it is one.
    pub(crate) fn name_of(code: f64) -> Option<&'static str> {
        let mut rows = Self::NAMES.iter();
        rows.find(|r| f64::from(r.0 as u8) == code).map(|r| r.1)
    }
}

/// What a solver claims, besides the point.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Claim {
    /// Solved to tolerance: a global optimum, or a solution of the system.
    Solved,
    /// A local optimum, to tolerance.
    LocallySolved,
    /// The same where the rows have no multipliers, so that the conditions of first order say nothing.
    WithoutMultipliers,
    /// Proved (to tolerance) infeasible, with a certificate in `Outcome::ray` where there is one.
    Infeasible,
    /// No point nearby satisfies the rows, with multipliers in `Outcome::ray` where they prove it; of a system: no method
    /// solved it.
    LocallyInfeasible,
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
    /// One line for the user where there is more to say.
    pub message: Option<String>,
    /// For linear programs solved to a vertex: the basis.
    pub basis: Option<Basis>,
}

impl Outcome {
    /// A point without marginals, of which nothing is claimed.
    pub fn unfinished(solver: &'static str, level: Vec<f64>, rows: usize) -> Self {
        Self {
            row_marginal: vec![0.0; rows],
            column_marginal: vec![0.0; level.len()],
            level,
            claim: Claim::Unfinished,
            status: SolverStatus::NormalCompletion,
            iterations: 0,
            solver,
            ray: Vec::new(),
            message: None,
            basis: None,
        }
    }

    /// That of a program to which columns and rows were added: so many were there before.
    pub(crate) fn of_first(mut self, columns: usize, rows: usize) -> Self {
        self.level.truncate(columns);
        self.column_marginal.truncate(columns);
        self.row_marginal.truncate(rows);
        self.basis = None;
        self
    }
}

/// Where a variable of a linear program is at a vertex.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BasisStatus {
    /// In the basis.
    Basic,
    /// At its lower bound.
    Lower,
    /// At its upper bound.
    Upper,
    /// Without bounds, at 0.
    Free,
}

/// A basis: one status per column, then one per row.
pub type Basis = Vec<BasisStatus>;
