//! `bmod explain`: a model and its answer in words.

use super::args::ExplainArgs;
use super::derive::{studied, tell};
use super::range;
use crate::formulation::explain::{Explained, explain};
use crate::formulation::page::filled;
use crate::solve::ModelStatus;

/// Rows and columns up to which ranges are found for the explanation.
const MAX_RANGES: usize = 200;

/// Carries out `bmod explain`; its exit status.
pub fn run(a: &ExplainArgs) -> u8 {
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
        let i = &primal.generated.instance;
        let small = i.row_count() + i.column_count() <= MAX_RANGES;
        let ranges = (small && i.is_linear() && status == ModelStatus::Optimal)
            .then(|| range::of(m, &primal, &[]));
        let ranges = ranges.flatten();
        let paragraphs = explain(&Explained {
            symbols: &m.symbols,
            store: &m.store,
            primal: &primal,
            status,
            ranges: ranges.as_ref(),
        });
        for p in paragraphs {
            tell(&format!("{}\n", filled(&p, 100)));
        }
        Ok(0)
    });
    if !unsolved {
        return status;
    }
    // What contradicts what, and what is unbounded.
    tell("\n");
    status.max(super::why::why(&super::args::WhyArgs {
        model: a.model.clone(),
        json: None,
        solve: a.solve.clone(),
    }))
}
