//! bmod solves models written in a declarative algebraic language in the GAMS tradition: linear, nonlinear and
//! complementarity programs, equilibrium constraints. This is the library; the command line is a program on top of
//! it.
//!
//! # A model from Rust
//!
//! ```
//! use bmod::{Model, ModelStatus, Options};
//!
//! let mut model = Model::from_text(
//!     "blend.blk",
//!     "Set i 'ingredients' / corn, soy /;
//!      Parameters price(i) / corn 0.30, soy 0.90 /, protein(i) / corn 0.09, soy 0.60 /;
//!      Scalar need 'protein per unit' / 0.30 /;
//!      Positive variable share(i);  Variable cost;
//!      Equations total, enough, whole;
//!      total..   cost =e= sum(i, price(i)*share(i));
//!      enough..  sum(i, protein(i)*share(i)) =g= need;
//!      whole..   sum(i, share(i)) =e= 1;
//!      Model blend / all /;
//!      solve blend using lp minimizing cost;",
//! );
//!
//! // Data come in by name …
//! model.set_parameter("price", [("corn", 0.25), ("soy", 1.0)]);
//! let run = model.run(&Options::default()).ok()?;
//!
//! // … and answers go out by name and labels.
//! assert_eq!(run.solves()[0].model_status, ModelStatus::Optimal);
//! assert!((run.level("share", "soy")? - 0.21 / 0.51).abs() < 1e-9);
//! println!("one more unit of protein costs {:.3}", run.marginal("enough", [])?);
//! # Ok::<(), bmod::Error>(())
//! ```
//!
//! # What is where
//!
//! * [`Model`]: the text, the files it includes, data from outside. A model is a value: change the data and run again.
//! * [`Options`]: limits, options of the solvers; [`Control`] watches and stops a run from another thread.
//! * [`Run`]: [`Run::solves`] (statuses, objective, residuals, times), [`Run::level`] and its kin, [`Run::symbols`]
//!   with their [records](Record), [`Run::figures`] (SVG), [`Run::displays`], [`Run::diagnostics`] with their
//!   [places](Place).
//! * [`Model::show`], [`Model::dual`], [`Model::kkt`]: the model, its dual and its optimality conditions as [`Formulas`]: to
//!   be read, as trees ([`Algebra`]), and as models that run.
//! * [`solver`]: the numbers below a model, as instances that are built in Rust, and backends of one's own.
//! * [`Error`]: what a program that asks for a symbol or a label may get wrong. A mistake in a model is a
//!   [`Diagnostic`], never a panic.
//!
//! # Features
//!
//! * `system` reads files ([`Model::from_file`]), the clock and memory of the system, and runs models on a thread with a
//!   large stack.
//! * `cli`, on by default, is the command line; it implies `system`.
//! * `pounce`, on by default, is the embedded solver for nonlinear programs (EPL-2.0); `ipopt` is the system's Ipopt.
//!
//! Without default features the library does no input or output, and asks for the time only through
//! [`Options::clock`]. `examples/` has programs to start from; the language is described in `docs/language.md`.
#![warn(missing_docs, unreachable_pub)]

mod api;
pub mod autodiff;
pub mod check;
pub mod claims;
#[cfg(feature = "cli")]
pub mod cli;
mod color;
pub mod data;
pub mod diag;
pub mod editor;
pub mod formulation;
pub mod gdx;
pub mod host;
pub mod model;
pub mod report;
pub mod run;
pub mod session;
pub mod solve;
pub mod solver;
pub mod source;
mod span;
pub mod syntax;
#[cfg(feature = "system")]
mod system;

pub use api::{
    Choice, Claim, Columns, Control, Error, Formulas, Labels, Model, Options, OutputFile, Progress,
    Ranges, Record, Records, Run, Sheet, Solve, Special, Symbol, SymbolKind, VariableRecord,
    VariableRecords,
};
pub use data::input::Keys;
pub use diag::Severity;
pub use formulation::algebra::{
    Algebra, AlgebraEquation, AlgebraTerm, AlgebraVariable, Expression, Index, Over,
};
pub use formulation::check::Comparison;
pub use host::{Found, Host, HostError};
pub use model::instance::Sense;
pub use model::outcome::{ModelStatus, SolverStatus};
pub use model::problem_type::ProblemType;
pub use report::diagnostic::{Diagnostic, Place, Related};
pub use report::json::{Display, Number, Residual, RunStatus, Seconds};
pub use solve::range::{CostRange, RowRange};
