//! Nonlinear programs: problem types nlp, dnlp, qcp and the relaxed ones.
//!
//! [`problem`] puts an instance into the form min f(x), l ≤ x ≤ u, a ≤ g(x) ≤ b; a provider
//! ([`pounce`], or Ipopt with the cargo feature `ipopt`) solves it, or Clarabel where it is a convex
//! quadratic program ([`quadratic`]); [`driver`] judges the point by the
//! KKT residuals of the instance, tries again where they are not small, and says what is known.

pub mod consistent;
pub mod curvature;
pub mod driver;
pub mod elastic;
mod growth;
#[cfg(feature = "ipopt")]
pub mod ipopt;
pub mod polish;
#[cfg(feature = "pounce")]
pub mod pounce;
pub mod problem;
pub mod provider;
pub mod quadratic;
pub mod relaxation;
mod schedule;
mod slp;
mod symmetric;
mod trial;
mod verdict;

use super::answer::Answer;
use super::{Monitor, Outcome, Settings, SolveError, Solver};
use crate::model::instance::Instance;
use provider::Provider;

/// Name of the threads on which providers run that may panic.
pub const THREAD: &str = "nonlinear solver";

/// The solvers that are in this build, the default first.
pub fn providers() -> &'static [&'static dyn Provider] {
    &[
        #[cfg(feature = "ipopt")]
        &ipopt::Ipopt,
        #[cfg(feature = "pounce")]
        &pounce::Pounce,
    ]
}

/// Solves with the solver of that name, or the default one, and certifies the answer.
///
/// Errors: no such solver in this build; crossed bounds; a start point without function values; an
/// option that the solver does not take.
pub fn answer(
    choice: Option<&str>,
    instance: &Instance,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<Answer, SolveError> {
    let all = providers();
    let named = choice.and_then(|c| all.iter().find(|p| p.name().eq_ignore_ascii_case(c)));
    let convexity = match choice {
        Some("clarabel") => Convexity::Asked,
        _ if named.is_some() => Convexity::Ignored,
        // a name that no solver of ours bears is some other solver of the same model type in GAMS
        _ => Convexity::Used,
    };
    match named.or(all.first()) {
        Some(p) => driver::solve(instance, *p, convexity, settings, monitor),
        None => Err(SolveError::new(
            "there is no solver for nonlinear models in this build",
        )),
    }
}

/// What is made of a convex quadratic program.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Convexity {
    /// Nothing: the provider was chosen by name.
    Ignored,
    /// Clarabel solves it.
    Used,
    /// Clarabel solves it, the status is `optimal`, and the person hears if it is not convex.
    Asked,
}

/// A nonlinear solver by name, for callers that want the bare outcome.
#[derive(Clone, Copy, Debug)]
pub struct Nonlinear(pub &'static str);

impl Solver for Nonlinear {
    fn name(&self) -> &'static str {
        self.0
    }

    fn solve(
        &self,
        instance: &Instance,
        settings: &Settings,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, SolveError> {
        answer(Some(self.0), instance, settings, monitor).map(|a| a.outcome)
    }
}
