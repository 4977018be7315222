//! Values and exact sparse derivatives of the nonlinear part of an instance.
//!
//! text of an equation → kernels (`model`) → [`graph`] (equal subexpressions shared) → [`derive`]
//! (reverse mode and edge pushing, symbolic) → [`steps`] (straight-line code, simplified) →
//! [`program`] (registers, many terms at a time) → [`Evaluator`] (rows, Jacobian, Hessian).
//!
//! [`functions`] gives the value of each function as GAMS defines it, [`partials`] its first and
//! second partial derivatives; [`scalar`] repeats a failed evaluation step by step to say why.

mod blocks;
mod derive;
mod evaluator;
mod fixed;
pub mod functions;
mod graph;
pub mod partials;
mod program;
mod scalar;
pub mod special;
mod steps;

pub(crate) use blocks::curved_columns;
pub use blocks::second_derivatives;
pub use evaluator::{Degree, EvalFailure, Evaluator, Kinks, kinks};
pub use functions::{DomainError, ErrorKind, Operation, function_value};
