//! Nonlinear programs: problem types nlp, dnlp, qcp and the relaxed ones.
//!
//! [`problem`] puts an instance into the form min f(x), l ≤ x ≤ u, a ≤ g(x) ≤ b; a provider
//! ([`pounce`], or Ipopt with the cargo feature `ipopt`) solves it; [`driver`] judges the point by the
//! KKT residuals of the instance, tries again where they are not small, and says what is known.

pub mod consistent;
pub mod curvature;
pub mod driver;
pub mod elastic;
#[cfg(feature = "ipopt")]
pub mod ipopt;
pub mod polish;
#[cfg(feature = "pounce")]
pub mod pounce;
pub mod problem;
pub mod provider;
mod schedule;
mod trial;

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
    let provider = choose(choice)?;
    driver::solve(instance, provider, settings, monitor)
}

fn choose(choice: Option<&str>) -> Result<&'static dyn Provider, SolveError> {
    let all = providers();
    let found = match choice {
        Some(name) => all.iter().find(|p| p.name().eq_ignore_ascii_case(name)),
        None => all.first(),
    };
    // a name that no nonlinear solver bears is some other solver of the same model type in GAMS
    found
        .or(all.first())
        .copied()
        .ok_or_else(|| SolveError::new("there is no solver for nonlinear models in this build"))
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
