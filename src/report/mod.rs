//! What people see: figures, diagnostics, summaries, JSON, listings.

pub mod diagnostic;
pub mod diagnostics;
pub mod display;
pub mod figure;
pub mod format;
pub mod json;
pub mod levels;
pub mod listing;
pub mod names;
pub mod number;
pub mod solution;
pub mod study;
pub mod summary;
pub mod textfile;
pub mod why;
