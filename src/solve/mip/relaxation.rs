//! What a search asks of a relaxation.

use super::model::Change;
use super::propagate::Sum;
use crate::solve::Budget;
use crate::solve::lp::Ended;

/// How the solution of a relaxation ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Solved {
    /// Solved, with this value.
    Value(f64),
    /// No point satisfies it.
    Infeasible,
    /// Its value is above the cutoff.
    Cutoff,
    /// Unbounded along this direction; empty where it is not known.
    Unbounded(Vec<f64>),
    /// Numbers broke down: nothing is known.
    Failed,
    /// A limit.
    Stopped(Ended),
}

/// What a search may spend.
pub struct Control<'b, 'm> {
    /// Asked for time and the user.
    pub budget: &'b Budget<'m>,
    /// Iterations at which the search ends.
    pub last: u64,
    /// Iterations that one linear program may take.
    pub each: u64,
    /// Iterations so far.
    pub iterations: u64,
}

impl<'b, 'm> Control<'b, 'm> {
    /// With all iterations that are left.
    pub fn new(budget: &'b Budget<'m>) -> Self {
        Self {
            budget,
            last: budget.iterations_left(),
            each: u64::MAX,
            iterations: 0,
        }
    }

    /// Where `iterlim` holds for each linear program, not for all together.
    pub fn for_each_program(budget: &'b Budget<'m>) -> Self {
        Self {
            budget,
            last: u64::MAX,
            each: budget.iterations_left(),
            iterations: 0,
        }
    }

    /// Why to stop after so many iterations.
    pub fn stop(&mut self, iterations: u64) -> Option<Ended> {
        match iterations >= self.last {
            true => Some(Ended::Iterations),
            false => self.budget.stop().map(Ended::from),
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

    /// The best point whose discrete columns are as in this one, where bounds say that.
    fn solve_decided(&mut self, _: &[f64], control: &mut Control) -> Solved {
        self.solve(f64::INFINITY, control)
    }

    /// The last point.
    fn x(&self) -> &[f64];

    /// Reduced costs there, where the value is a bound and these say how it grows.
    fn reduced(&self) -> Option<&[f64]>;

    /// A row that all points with values below the cutoff satisfy: those of the program with the multipliers of the last solve. Where
    /// that left nothing below the cutoff, the present bounds contradict it.
    fn sum(&self, _cutoff: f64) -> Option<Sum> {
        None
    }

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
