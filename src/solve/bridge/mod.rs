//! Reformulations: an instance in place of another, and the way back. Each stands here once, whoever uses it.
//!
//! * [`binaries`]: products with a binary factor, as columns and rows, for programs with discrete columns;
//! * [`cones`]: convex rows as second-order, exponential and power cones;
//! * [`elastic`]: rows that may be violated at a price;
//! * [`epigraph`]: max, min and abs where they stand convexly, as columns and rows;
//! * [`forms`]: convex terms as columns, for programs with discrete columns;
//! * [`inner_sums`]: long sums inside functions, as columns and rows;
//! * [`least_squares`]: a sum of as many squares as there are variables as equations;
//! * [`kkt`]: the optimality conditions of a linear program as a complementarity problem;
//! * [`pieces`]: the pieces that meet at a kink, to find a direction of descent;
//! * [`products`]: pairs as nonlinear rows, for programs with equilibrium constraints;
//! * [`triangular`]: columns that equations give one after the other, as numbers.

pub mod binaries;
mod builder;
pub mod cones;
pub(super) mod direction;
pub mod elastic;
pub mod epigraph;
pub mod forms;
pub mod inner_sums;
pub mod kkt;
pub mod least_squares;
pub(super) mod parts;
pub mod pieces;
pub mod products;
pub mod triangular;

use super::Settings;
use super::answer::Answer;
use super::backend::{Backend, Reply, Task};
use crate::model::instance::Instance;
use crate::model::problem_type::ProblemType;

/// An instance in place of another.
pub(super) trait Bridge {
    /// The bridge where it applies by itself.
    fn build(_: &[&dyn Backend], _: &Task, _: &Settings) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

    /// The instance to solve; the columns and rows of the original come first.
    fn instance(&self) -> &Instance;

    /// Its problem type.
    fn using(&self) -> ProblemType {
        ProblemType::Nlp
    }

    /// What an answer to it says about the original. None: nothing.
    fn restore(&self, original: &Instance, answer: &Answer) -> Option<Reply>;

    /// Whether the reduced costs and multipliers are to be judged in the instance, not in the original.
    fn has_own_multipliers(&self) -> bool {
        false
    }

    /// Iterations after which the original is solved as it is.
    fn iterations(&self) -> u64 {
        u64::MAX
    }
}
