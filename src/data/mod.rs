//! Labels and sparse tables.
pub mod value;
