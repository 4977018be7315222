//! What a solver returns, and the statuses of an answer.

use super::named::named;

named! {
    /// GAMS's model status codes, as far as they can occur, with GAMS's words for them, lower case.
    #[repr(u8)]
    pub enum ModelStatus {
        /// Optimal (for mcp: solved).
        Optimal = 1 "optimal";
        LocallyOptimal = 2 "locally optimal";
        Unbounded = 3 "unbounded";
        Infeasible = 4 "infeasible";
        LocallyInfeasible = 5 "locally infeasible";
        /// Not solved: the last point is infeasible.
        IntermediateInfeasible = 6 "intermediate infeasible";
        /// The last point is feasible, but not shown to be optimal.
        Feasible = 7 "feasible solution";
        /// A solution with all discrete columns right, not shown to be the best.
        IntegerSolution = 8 "integer solution";
        /// Not solved, and the last point is no solution.
        IntermediateNonInteger = 9 "intermediate non-integer";
        /// No point satisfies rows, bounds and discrete columns.
        IntegerInfeasible = 10 "integer infeasible";
        ErrorUnknown = 12 "error unknown";
        ErrorNoSolution = 13 "error no solution";
        NoSolution = 14 "no solution returned";
        /// A square system, solved uniquely.
        SolvedUnique = 15 "solved unique";
        /// A square system, solved.
        Solved = 16 "solved";
        UnboundedNoSolution = 18 "unbounded - no solution";
        InfeasibleNoSolution = 19 "infeasible - no solution";
    }
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
}

named! {
    /// GAMS's solver status codes, as far as they can occur, with GAMS's words for them, lower case.
    #[repr(u8)]
    pub enum SolverStatus {
        /// It ended as it should.
        NormalCompletion = 1 "normal completion";
        /// Iteration limit.
        IterationInterrupt = 2 "iteration interrupt";
        /// Time limit.
        ResourceInterrupt = 3 "resource interrupt";
        /// The solver gave up.
        TerminatedBySolver = 4 "terminated by solver";
        /// Too many evaluation errors.
        EvaluationInterrupt = 5 "evaluation interrupt";
        /// The solver cannot take this model.
        CapabilityProblems = 6 "capability problems";
        /// Ctrl-C.
        UserInterrupt = 8 "user interrupt";
        /// Something failed inside.
        InternalSolverFailure = 11 "internal solver failure";
        /// It was not asked, because of errors before.
        ProcessingSkipped = 12 "solve processing skipped";
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
