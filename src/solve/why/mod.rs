//! Why a solve ended as it did: what to look at, by row and column.
//!
//! Nothing here trusts the solver: every finding is computed from the instance and the point.
//! [`findings`] chooses by the status; each module says how its finding is made.

mod contradiction;
mod infeasible;
mod pairs;
mod point;

use super::answer::Answer;
use super::mip::conflict::{Conflict, conflict};
use super::{Budget, ModelStatus};
use crate::model::instance::Instance;
use crate::model::problem_type::ProblemType;

pub use infeasible::{Member, irreducible};

/// One thing that was found, in indices.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// Rows and bounds that contradict each other, with the multipliers that show it. `shown`: with
    /// any one of them dropped the rest can be satisfied.
    Irreducible {
        /// The members with their multipliers.
        members: Vec<(Member, f64)>,
        /// By how much they contradict each other when added up.
        excess: f64,
        /// Whether that none can be spared was shown.
        shown: bool,
    },
    /// The same of a program with nonlinear rows, whose proof has no multipliers of rows and bounds.
    Contradiction {
        /// The members.
        members: Vec<Member>,
        /// Whether that none can be spared was shown.
        shown: bool,
    },
    /// Rows that contradict each other because these columns must be discrete.
    Discrete(Conflict),
    /// A direction of columns along which the objective improves without end.
    Ray(Vec<(usize, f64)>),
    /// The rows and columns with the largest violations: index, violation, level asked for.
    Violated {
        /// Rows: violation and right-hand side.
        rows: Vec<(usize, f64)>,
        /// Columns.
        columns: Vec<(usize, f64)>,
    },
    /// What carries the error of the objective: residual times multiplier.
    Inaccurate {
        /// Rows: residual, share of the objective's error.
        rows: Vec<(usize, f64, f64)>,
        /// Columns: wrong reduced cost, share.
        columns: Vec<(usize, f64, f64)>,
    },
    /// Coefficients far apart: the largest and the smallest with their places.
    Scaling {
        /// Row, column, coefficient.
        largest: (usize, usize, f64),
        /// Row, column, coefficient.
        smallest: (usize, usize, f64),
        /// Rows with the widest range of coefficients: smallest, largest.
        rows: Vec<(usize, f64, f64)>,
        /// Columns with the widest range.
        columns: Vec<(usize, f64, f64)>,
    },
    /// Pairs with the largest natural residuals: row, column, residual.
    Pairs(Vec<(Option<usize>, usize, f64)>),
    /// More rows than columns to satisfy them with (or the other way round), whatever the numbers.
    Structural {
        /// The rows that share too few columns.
        rows: Vec<usize>,
        /// Those columns.
        columns: Vec<usize>,
    },
    /// At this point the rows depend on each other.
    Singular {
        /// Rows without a pivot.
        rows: Vec<usize>,
        /// Columns that depend on others.
        columns: Vec<usize>,
    },
    /// Pairs whose row falls where its own variable grows: row, column, derivative.
    WrongWay(Vec<(usize, usize, f64)>),
    /// A function has no value, or no derivative, here.
    NoValue {
        /// The row.
        row: usize,
        /// The column that is its argument.
        column: Option<usize>,
        /// What failed.
        what: String,
    },
}

/// How many rows or columns a finding names.
const FEW: usize = 5;

/// What explains the status of an answer.
pub fn findings(
    using: ProblemType,
    instance: &Instance,
    answer: &Answer,
    budget: &Budget,
) -> Vec<Finding> {
    let mut out = Vec::new();
    let x = &answer.outcome.level;
    let linear = instance.is_linear() && instance.objective.is_some();
    let solved = answer.status.is_solution();
    let scaling = point::scaling(instance, x);
    match answer.status {
        ModelStatus::Infeasible | ModelStatus::InfeasibleNoSolution if linear => {
            out.extend(irreducible(instance, &answer.outcome.ray, budget));
        }
        ModelStatus::IntegerInfeasible => {
            // The relaxation may be infeasible already.
            let relaxed = linear.then(|| irreducible(instance, &[], budget));
            let discrete = || conflict(using, instance, budget).map(Finding::Discrete);
            out.extend(relaxed.flatten().or_else(discrete));
            if out.is_empty() && !linear {
                out.extend(point::violated(instance, answer));
            }
        }
        ModelStatus::Unbounded | ModelStatus::UnboundedNoSolution => {
            out.extend(point::ray(instance, &answer.outcome.ray));
        }
        _ if using.is_system() => {
            let square = using == ProblemType::Cns;
            let found = (!solved).then(|| pairs::findings(instance, square, x));
            out.extend(found.into_iter().flatten());
        }
        _ if linear => {
            // Also where the solver gave up: an infeasible program is infeasible.
            if !solved && !answer.residuals.is_feasible(1e-6) {
                out.extend(irreducible(instance, &[], budget));
            }
            if !solved && out.is_empty() {
                out.extend(point::inaccurate(instance, answer));
            }
        }
        _ if !solved => {
            let proved = answer.status == ModelStatus::Infeasible;
            let found = proved.then(|| contradiction::contradiction(using, instance, budget));
            out.extend(found.flatten());
            if out.is_empty() {
                out.extend(point::no_value(instance, x));
                out.extend(point::violated(instance, answer));
            }
        }
        _ => {}
    }
    // there the derivatives at the last point say nothing about units
    if !matches!(out[..], [Finding::Contradiction { .. }]) {
        out.extend(scaling);
    }
    out
}
