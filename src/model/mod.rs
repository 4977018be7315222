//! The sparse model IR.
pub mod certificate;
pub mod certificate_nlp;
pub mod instance;
pub mod origin;
pub mod sum;
