//! Nonlinear programs: problem types nlp, dnlp, qcp and the relaxed ones.
//!
//! [`problem`] puts an instance into the form min f(x), l ≤ x ≤ u, a ≤ g(x) ≤ b; an interior-point solver
//! ([`pounce`], or Ipopt with the cargo feature `ipopt`) solves it, or Clarabel where it is a convex
//! quadratic program ([`quadratic`]); [`driver`] judges the point by the
//! KKT residuals of the instance, tries again where they are not small, and says what is known.

mod attempts;
pub mod composition;
pub mod consistent;
pub mod convex;
pub mod curvature;
pub mod driver;
mod fritz_john;
mod growth;
pub mod interior_point;
#[cfg(feature = "ipopt")]
pub mod ipopt;
mod newton;
mod options;
mod path;
pub mod polish;
#[cfg(feature = "pounce")]
pub mod pounce;
pub mod problem;
pub mod quadratic;
pub mod relaxation;
mod runs;
mod saddle;
mod schedule;
mod sequence;
mod slqp;
mod symmetric;
mod trial;
mod truncated;
mod verdict;

use super::backend::{About, Backend, QuadraticEngine, Replied, Supports, Task, Terms, is_called};
use super::registry::BACKENDS;
use super::{Budget, Settings, lp};
use crate::model::instance::Instance;
use interior_point::InteriorPoint;
#[cfg(feature = "ipopt")]
pub use options::IPOPT_OPTIONS;
#[cfg(feature = "pounce")]
pub use options::POUNCE_OPTIONS;
pub use options::SHARED_OPTIONS;

pub(super) use driver::solve_by_products;

/// Name of the threads on which interior-point solvers run that may panic.
pub const THREAD: &str = "nonlinear solver";

/// Levels nearby at which the rows hold, from a point at which they all but do. None where nothing can be evaluated.
pub(super) fn onto_rows(instance: &Instance, level: &[f64], budget: &Budget) -> Option<Vec<f64>> {
    let mut instance = instance.clone();
    instance.columns.level.copy_from_slice(level);
    let mut problem = problem::Problem::new(&instance);
    let run = newton::solve(&mut problem, &mut |_| budget.is_over())?;
    Some(problem.levels(&run.x))
}

/// The solvers that are in this build, the default first.
pub fn interior_point_solvers() -> &'static [&'static dyn InteriorPoint] {
    &[
        #[cfg(feature = "pounce")]
        &pounce::Pounce,
        #[cfg(feature = "ipopt")]
        &ipopt::Ipopt,
    ]
}

/// What is made of a convex quadratic program.
#[derive(Clone, Copy, Debug)]
pub enum Convexity {
    /// Nothing: the interior-point solver was chosen by name.
    Ignored,
    /// Clarabel solves it.
    Used,
    /// This solves it, the status is `optimal`, and the user hears if it is not convex.
    Asked(QuadraticEngine),
}

/// What interior-point solvers take.
#[cfg_attr(not(any(feature = "pounce", feature = "ipopt")), allow(dead_code))]
const SUPPORTS: Supports = Supports {
    linear: false,
    ..Supports::new(lp::TYPES, Terms::Kinks)
};

/// A nonlinear solver as a backend.
#[derive(Clone, Copy)]
pub struct Nonlinear(pub &'static dyn InteriorPoint);

impl Backend for Nonlinear {
    fn about(&self) -> About {
        self.0.about()
    }

    fn solve(&self, task: &Task, settings: &Settings, budget: &Budget) -> Replied {
        let named = |name| BACKENDS.iter().filter(move |b| is_called(**b, name));
        let convexity = match task.choice {
            Some(name) if is_called(self, name) => Convexity::Ignored,
            Some(name) => match named(name).find_map(|b| b.quadratic()) {
                Some(engine) => Convexity::Asked(engine),
                None => Convexity::Used,
            },
            None => Convexity::Used,
        };
        let outcome = driver::solve(task, self.0, convexity, settings, budget)?;
        Ok(outcome.into())
    }
}
