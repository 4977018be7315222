//! bmod: a declarative algebraic modeling language in the GAMS tradition.
//!
//! Text in, numbers and pictures out, one stage after the other:
//! `source` → `syntax` → `check` → `run` → `model` → `solve` → `report`.
//! See `docs/architecture.md`.
#![warn(missing_docs)]

pub mod autodiff;
pub mod check;
pub mod cli;
pub mod data;
pub mod diag;
pub mod gdx;
pub mod host;
pub mod model;
pub mod report;
pub mod run;
pub mod session;
pub mod solve;
pub mod source;
pub mod syntax;
