//! Values and exact sparse derivatives of the nonlinear part of an instance.
//!
//! [`functions`] gives the value of each function as GAMS defines it, [`partials`] its first and
//! second partial derivatives.

pub mod functions;
pub mod partials;
pub mod special;

pub use functions::{DomainError, ErrorKind, Operation, function_value};
