//! The sparse model IR.
pub mod builder;
pub mod function;
pub mod instance;
pub mod language;
pub(crate) mod named;
pub mod option;
pub mod origin;
pub mod outcome;
pub mod problem_type;
pub mod sum;
