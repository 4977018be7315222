//! What a search asks of a relaxation.

use super::model::Change;
use crate::solve::Monitor;
use crate::solve::lp::{Ended, Limits};

/// How the solution of a relaxation ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Solved {
    /// Solved, with this value.
    Value(f64),
    /// No point satisfies it.
    Infeasible,
    /// Its value is above the cutoff.
    Cutoff,
    /// Unbounded.
    Unbounded,
    /// Numbers broke down: nothing is known.
    Failed,
    /// A limit.
    Stopped(Ended),
}

/// Passes on that the person wants to stop, and no lines of the many small solves.
pub struct Muted<'m>(pub &'m mut dyn Monitor);

impl Monitor for Muted<'_> {
    fn log(&mut self, _: &str) {}
    fn interrupted(&mut self) -> bool {
        self.0.interrupted()
    }
    fn row_name(&self, row: usize) -> String {
        self.0.row_name(row)
    }
    fn column_name(&self, column: usize) -> String {
        self.0.column_name(column)
    }
}

/// Limits of a search, and the person.
pub struct Control<'m> {
    /// For the log, and Ctrl-C.
    pub monitor: &'m mut dyn Monitor,
    /// Time and iterations.
    pub limits: Limits,
    /// Iterations so far.
    pub iterations: u64,
}

impl Control<'_> {
    /// Why to stop after so many iterations.
    pub fn stop(&mut self, iterations: u64) -> Option<Ended> {
        if self.monitor.interrupted() {
            Some(Ended::Interrupted)
        } else if iterations >= self.limits.iterations {
            Some(Ended::Iterations)
        } else if self.limits.seconds_left() <= 0.0 {
            Some(Ended::Time)
        } else {
            None
        }
    }
}

/// A program without the conditions on discrete columns, solved again and again under other bounds.
pub trait Relaxation {
    /// From where a node's relaxation starts.
    type Start: Clone;

    /// Changes bounds.
    fn set_bounds(&mut self, change: Change);

    /// Solves for the present bounds; may give up above the cutoff.
    fn solve(&mut self, cutoff: f64, control: &mut Control) -> Solved;

    /// The last point.
    fn x(&self) -> &[f64];

    /// Reduced costs there, where the value is a bound and these say how it grows.
    fn reduced(&self) -> Option<&[f64]>;

    /// Where it is now, to start from again.
    fn start(&self) -> Self::Start;

    /// Goes there; bounds stay.
    fn restart(&mut self, start: &Self::Start);

    /// About what the value would be under these bounds, with little effort; +∞ where they leave nothing below the
    /// cutoff for certain. None: not known.
    fn probe(&mut self, _: &[Change], _: f64) -> Option<f64> {
        None
    }

    /// Whether bounds and the program's rows are all there is.
    fn is_linear(&self) -> bool {
        true
    }

    /// Whether a node's value is a bound for all below it.
    fn is_exact(&self) -> bool {
        true
    }
}
