//! Labels, values and sparse tables. Knows nothing of the language.

pub mod table;
pub mod universe;
pub mod value;
