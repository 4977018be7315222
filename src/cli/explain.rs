//! `bmod explain`: a model and its answer in words.

use super::args::{ExplainArgs, INTERRUPT, WhyArgs};
use super::commands::Status;
use super::derive::{studied, tell, width};
use crate::formulation::explain::of;
use crate::formulation::page::filled;
use crate::solve::ModelStatus;

/// Carries out `bmod explain`; its exit status.
pub(super) fn run(a: &ExplainArgs) -> Status {
    let mut unsolved = false;
    let status = studied(&a.model, &a.solve, &a.chosen, &mut |m, primal, studied| {
        let status = studied
            .answer
            .as_ref()
            .map_or(ModelStatus::NoSolution, |a| a.1.status);
        unsolved = !matches!(
            status,
            ModelStatus::Optimal | ModelStatus::LocallyOptimal | ModelStatus::Solved
        );
        let (paragraphs, _) = of(m, &primal, &studied);
        for p in paragraphs {
            tell(&format!("{}\n", filled(&p, width())));
        }
        Ok(0)
    })?;
    if !unsolved || status == INTERRUPT {
        return Ok(status);
    }
    // What contradicts what, and what is unbounded.
    tell("\n");
    let why = super::why::why(&WhyArgs {
        model: a.model.clone(),
        json: None,
        solve: a.solve.clone(),
    });
    why.map(|why| status.max(why))
}
