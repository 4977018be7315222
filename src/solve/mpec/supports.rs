//! The method `pieces` from its starts to the final branch.
//!
//! Starts are solutions of the complementarity problem in the pairs: the point the solve begins at, where it
//! is one, else the solution that the solver finds from there; and the one at the end of its path from
//! zero, without a crash. The path ends at a basic solution, whose support is small, where an
//! interior crash ends in the middle of all solutions, with the largest support there is, and α falls as
//! supports shrink. From the best of them the alternation, and from random starts the alternation and short
//! swaps; then, where programs are small, many cheap tries below the best; from the best of all several descents
//! by swaps in random order, and then swaps until none improves. All limits are counts of work, so a run can be repeated.

use super::pieces::{Pieces, Round, Solution};
use super::{Found, ModelStatus, Piece, Search, SolveError, Stationarity};
use crate::solve::lp::watch;
use crate::solve::{Budget, Progress, Strategy};

/// Swaps, in simplex iterations.
const SWAPS: u64 = 80_000;

/// Random starts, in simplex iterations times rows and columns. On small programs they cost nothing, and there
/// are more than were asked for; on large ones they seldom lead anywhere, and there are fewer.
const STARTS: u64 = 1_000_000;

/// Tries to get below the best, in simplex iterations times the fourth power of rows and columns (on larger
/// programs a try takes more iterations, these take longer, and fewer tries succeed), and at most so many for
/// each start that was asked for.
const BELOW: (u64, usize) = (3_500_000_000_000_000, 250);

/// Columns of a program of which there is a descent for each start that was asked for, and at most so many for each.
const DESCENTS: [usize; 2] = [250, 6];

/// Share of the time left that the search may take: the branch that it ends on has to be solved in the rest.
const SEARCH: f64 = 0.9;

impl Search<'_, '_> {
    /// False if the method does not apply or finds nothing.
    pub(super) fn supports(&mut self, start: &[f64]) -> Result<bool, SolveError> {
        let Some(mut pieces) = Pieces::new(self.program) else {
            return Ok(false);
        };
        let mut levels = Vec::new();
        if self.program.judge(start).feasible {
            levels.push(start.to_vec());
        } else {
            levels.extend(self.equilibrium(start, &[]));
        }
        if self.settings.runs(Strategy::EquilibriumFromZero) {
            let options = [("crash_method", "none")];
            levels.extend(self.equilibrium(&vec![0.0; start.len()], &options));
        }
        let best = self.best_support(&mut pieces, &levels);
        self.budget.spend(pieces.iterations());
        match best {
            Some(best) => self.settle(&mut pieces, best, start),
            None => Ok(false),
        }
    }

    fn best_support(&mut self, pieces: &mut Pieces, levels: &[Vec<f64>]) -> Option<Solution> {
        let seconds = SEARCH * self.budget.seconds_left();
        self.budget.within(seconds, u64::MAX, |budget| {
            self.search_supports(pieces, levels, budget)
        })
    }

    fn search_supports(
        &self,
        pieces: &mut Pieces,
        levels: &[Vec<f64>],
        budget: &Budget,
    ) -> Option<Solution> {
        let sign = self.program.sign();
        // Each side counts its own iterations.
        let mut stop = watch(budget, u64::MAX);
        let mut best: Option<Solution> = None;
        let keep = |what: &str, found: Option<Solution>, best: &mut Option<Solution>| {
            let Some(s) = found else { return };
            budget.log(format!("{what}: {:.10}", sign * s.a.value));
            budget.progress(Progress {
                method: "pieces",
                objective: Some(sign * s.a.value),
                ..Progress::default()
            });
            // Of points that differ by rounding the first is kept.
            let enough = |b: &Solution| s.a.value < b.a.value - 1e-10 * b.a.value.abs().max(1.0);
            if best.as_ref().is_none_or(enough) {
                *best = Some(s);
            }
        };
        for level in levels {
            keep(
                "piece at an equilibrium",
                pieces.at(level, &mut stop),
                &mut best,
            );
        }
        if !self.options.swaps {
            return best;
        }
        if let Some(b) = best.as_ref().map(|s| s.b.clone()) {
            let next = pieces.alternate(b, 1e-3, &mut stop);
            keep("alternation from there", next, &mut best);
        }
        let starts = self.options.starts;
        let columns = self.program.instance.column_count();
        let size = (columns + self.program.instance.row_count()) as u64;
        let begun = pieces.iterations();
        for _ in 0..100 * starts {
            let work = (pieces.iterations() - begun) * size;
            if work > STARTS || stop(0).is_some() {
                break;
            }
            let next = pieces.random_start(&mut stop);
            let short = [Round::Short];
            let next = next.map(|s| pieces.swaps(s, &short, SWAPS, &mut stop));
            keep("random start", next, &mut best);
        }
        let begun = pieces.iterations();
        for _ in 0..starts * BELOW.1 {
            let work = (pieces.iterations() - begun).saturating_mul(size.saturating_pow(4));
            if work > BELOW.0 || stop(0).is_some() {
                break;
            }
            let value = best.as_ref()?.a.value;
            let next = pieces.below(value, &mut stop);
            keep("below", next.filter(|s| s.a.value < value), &mut best);
        }
        // The larger the program, the fewer of the ways lead on. From a better point fewer do, but further.
        let first = best.clone()?;
        for k in 0..starts * (columns / DESCENTS[0]).min(DESCENTS[1]) {
            let from = if k % 2 == 0 {
                first.clone()
            } else {
                best.clone()?
            };
            let next = pieces.swaps(from, &[Round::Kicked], SWAPS, &mut stop);
            keep("descent", Some(next), &mut best);
        }
        let all = [Round::Short, Round::Kicked, Round::Kicked, Round::Rest];
        let found = pieces.swaps(best.take()?, &all, SWAPS, &mut stop);
        let what = match pieces.exhausted {
            true => "no swap improves",
            false => "swaps",
        };
        keep(what, Some(found), &mut best);
        best
    }

    /// Solves the branch of a solution. Its own point of B may have a smaller support: then there is more to
    /// gain.
    fn settle(
        &mut self,
        pieces: &mut Pieces,
        best: Solution,
        start: &[f64],
    ) -> Result<bool, SolveError> {
        let mut level = start.to_vec();
        pieces.write(&best, &mut level);
        let complete = self.program.complete(level.clone());
        self.keep_point(&complete, best.pieces.clone());
        let mut on: Vec<Piece> = best.pieces;
        for _ in 0..20 {
            if self.is_over() {
                break;
            }
            let basis = pieces.basis(&on, &mut watch(self.budget, u64::MAX));
            let Some(mut found): Option<Found> =
                self.branch_from(basis.as_ref(), on.clone(), &level, u64::MAX)?
            else {
                break;
            };
            level.clone_from(&found.outcome.level);
            let there = pieces.pieces_at(&level);
            let settled = there == on && found.status == ModelStatus::Optimal;
            found.verdict = Some(match settled {
                true => Stationarity::Proved,
                false => Stationarity::NotProved,
            });
            if settled && pieces.exhausted {
                let note = "no single swap of supports improves";
                self.notes.push(note.into());
            }
            self.keep(&found);
            if settled || there == on {
                break;
            }
            on = there;
        }
        Ok(self.best.is_some() || self.is_over())
    }
}
