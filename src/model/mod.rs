//! The sparse model IR.
pub mod certificate;
pub mod instance;
pub mod origin;
pub mod sum;
