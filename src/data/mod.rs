//! Labels, values and sparse tables. Knows nothing of the language.

pub mod input;
pub mod key_index;
pub mod sort;
pub mod table;
pub mod universe;
pub mod value;
