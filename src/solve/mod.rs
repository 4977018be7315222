//! Solvers. They see an [`Instance`](crate::model::instance::Instance) of indices and numbers, never names.
//!
//! A solver's word is not believed: [`crate::solve::certificate`] recomputes the residuals of the
//! point on the unscaled instance, and that decides the reported status.

pub mod answer;
pub mod backend;
pub mod bridge;
pub mod budget;
pub mod certificate;
pub mod complementarity;
#[cfg(test)]
pub(crate) mod dense;
pub mod discrete;
pub(crate) mod factor_size;
#[cfg(feature = "highs")]
pub mod highs;
pub mod interval;
pub mod lp;
pub mod mcp;
pub mod mip;
pub mod mpec;
pub mod nlp;
mod noise;
pub mod pairing;
pub mod random;
pub mod range;
pub mod registry;
pub mod strategy;
pub mod structure;
pub mod study;
mod vector;
pub mod why;

pub use budget::{Budget, Limits, Monitor, Progress, Quiet, Stop};

use crate::model::option::{self, OptionTable};
pub use crate::model::outcome::{Claim, ModelStatus, Outcome, SolverStatus};
pub use strategy::Strategy;

/// What a solve is asked for beside its limits.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Solver options by name, from an option file, `--option` or an `option` statement; what was said last counts.
    pub options: Vec<(String, String)>,
    /// What a search over discrete columns is to reach.
    pub search: mip::Aim,
}

impl Settings {
    /// A solver option's text, lower case: what was said last counts.
    pub fn option(&self, name: &str) -> Option<String> {
        let mut asked = self.options.iter().rev();
        let of = asked.find(|(k, _)| k.eq_ignore_ascii_case(name));
        of.map(|(_, v)| v.to_lowercase())
    }

    /// The same as a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.option(name)?.parse().ok()
    }

    /// The same of a table's option, which has the default.
    pub(crate) fn number_of(&self, table: &OptionTable, name: &str) -> f64 {
        let default = || table.find(name)?.default.parse().ok();
        self.number(name).or_else(default).unwrap_or(0.0)
    }

    /// The same as a switch.
    pub fn switch(&self, name: &str) -> Option<bool> {
        option::switch(&self.option(name)?)
    }

    /// Those that a table has.
    pub fn of<'a>(&'a self, table: &'a OptionTable) -> impl Iterator<Item = &'a (String, String)> {
        let known = |(name, _): &&(String, String)| table.find(name).is_some();
        self.options.iter().filter(known)
    }
}

/// Why a solver did not run at all.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveError {
    /// In the reader's terms; names are put in by the caller.
    pub message: String,
    /// The row to name, if one is to blame.
    pub row: Option<usize>,
    /// The column to name, if one is to blame.
    pub column: Option<usize>,
}

impl SolveError {
    /// With no row or column to blame.
    pub fn new(message: impl Into<String>) -> Self {
        Self::at(None, None, message)
    }

    /// With the row, the column or both to blame.
    pub(crate) fn at(
        row: Option<usize>,
        column: Option<usize>,
        message: impl Into<String>,
    ) -> Self {
        Self {
            message: message.into(),
            row,
            column,
        }
    }
}
