//! The sparse model IR.
pub mod certificate;
pub mod instance;
pub mod sum;
