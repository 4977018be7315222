//! The sparse model IR.
pub mod instance;
