//! Instances of numbers, and solvers for them: what stands below models and names.
//!
//! An [`Instance`] is built column by column and row by row, and [`answer`] solves it with the [`Backend`] that its type
//! prefers; [`answer_with`] with backends of one's own. Whatever a backend claims, the residuals and the status of an
//! [`Answer`] are computed from its point.
//!
//! ```
//! use bmod::ModelStatus;
//! use bmod::solver::{Budget, Term, Instance, ProblemType, Quiet, Relation, Sense, Settings, answer};
//!
//! // min z, z = exp(x) − 2x
//! let free = (f64::NEG_INFINITY, f64::INFINITY);
//! let mut instance = Instance::default();
//! let z = instance.add_column(free.0, free.1, 0.0);
//! let x = instance.add_column(free.0, free.1, 0.0);
//! let row = instance.add_row([(z, 1.0), (x, 2.0)], Relation::Equal, 0.0);
//! let exp = Term::call(bmod::solver::Function::Exp, [Term::column(x)]);
//! instance.add_term(row, -1.0, exp);
//! instance.set_objective(z, Sense::Minimize);
//!
//! let mut monitor = Quiet::default();
//! let budget = Budget::unlimited(&mut monitor);
//! let answer = answer(ProblemType::Nlp, None, &instance, &Settings::default(), &budget).expect("a solver");
//! assert_eq!(answer.status, ModelStatus::Optimal); // all terms are known to be convex
//! assert!((answer.outcome.level[x] - 2f64.ln()).abs() < 1e-6);
//! ```
//!
//! `examples/toy_backend.rs` is a backend from outside.

pub use crate::autodiff::{EvalFailure, Evaluator};
pub use crate::model::builder::Term;
pub use crate::model::function::Function;
pub use crate::model::instance::{ColumnKind, Instance, Relation, Sense};
pub use crate::model::option::{Kind, OptionTable, row};
pub use crate::model::outcome::{Claim, Outcome};
pub use crate::model::problem_type::ProblemType;
pub use crate::solve::answer::{Answer, answer, answer_with};
pub use crate::solve::backend::{About, Backend, Replied, Reply, Supports, Task, Terms};
pub use crate::solve::certificate::Residuals;
pub use crate::solve::registry::BACKENDS;
pub use crate::solve::{Budget, Limits, Monitor, Quiet, Settings, SolveError, Stop};
