//! What follows a first local solution, where [`super::pieces`] does not apply: single swaps of pieces, and
//! random starts.
//!
//! A B-stationary point is as good as its neighbourhood, but a better branch may be one pair away: no direction
//! leads there, since its piece is not active at the point. So every piece that no pair is on is tried, the
//! pair with the largest gain by its multipliers first: the branch with that piece, solved from the point; where it is better,
//! downhill from there, and start again. At the end no single swap improves, as far as the branches' own
//! (local) solutions say. Random starts (from a fixed seed) lead to other points, of which the best
//! is treated likewise. All limits are counts of work, so a run can be repeated.

use super::pairs::Piece;
use super::{Found, ModelStatus, Search, SolveError};
use crate::solve::random::Random;

/// Swaps, and random starts, each in iterations times rows and columns.
const WORK: u64 = 100_000;

/// Iterations of a branch that a swap leads to.
const SHORT: u64 = 100;

impl Search<'_, '_> {
    /// Swaps and starts from what was found first.
    pub(super) fn explore(&mut self, start: &[f64]) -> Result<(), SolveError> {
        let exhausted = self.swaps()?;
        let before = self.best.as_ref().map(|b| b.objective);
        self.random_starts(start)?;
        let improved = before != self.best.as_ref().map(|b| b.objective);
        if if improved { self.swaps()? } else { exhausted } {
            self.notes.push("no single swap of pieces improves".into());
        }
        Ok(())
    }

    /// Swaps from the best point until none improves; false if the work was done before.
    fn swaps(&mut self) -> Result<bool, SolveError> {
        self.allow(WORK);
        'again: while let Some(best) = self.best.clone() {
            if best.status == ModelStatus::Unbounded {
                break;
            }
            for (k, piece) in self.order(&best) {
                if self.is_spent() {
                    return Ok(false);
                }
                let mut pieces = best.pieces.clone();
                pieces[k] = piece;
                let level = &best.outcome.level;
                if let Some(found) = self.branch_from(None, pieces, level, SHORT)?
                    && found.objective < best.objective - 1e-9 * best.objective.abs().max(1.0)
                {
                    self.descend(found)?;
                    continue 'again;
                }
            }
            return Ok(true);
        }
        Ok(false)
    }

    /// Pieces that pairs are not on, by what the objective gains to first order if the piece they are on
    /// does not bind.
    fn order(&self, at: &Found) -> Vec<(usize, Piece)> {
        let outcome = &at.outcome;
        let gain = |k: usize| {
            let p = &self.program.pairs[k];
            match at.pieces[k] {
                Piece::Inside => outcome.row_marginal[p.row].abs(),
                _ => outcome.column_marginal[p.column].abs(),
            }
        };
        let mut out: Vec<(f64, usize, Piece)> = Vec::new();
        for (k, p) in self.program.pairs.iter().enumerate() {
            for piece in [Piece::Lower, Piece::Inside, Piece::Upper] {
                if piece != at.pieces[k] && p.allows(piece) {
                    out.push((gain(k), k, piece));
                }
            }
        }
        out.sort_by(|a, b| b.0.total_cmp(&a.0));
        out.into_iter().map(|(_, k, piece)| (k, piece)).collect()
    }

    /// The relaxation from points around the start.
    fn random_starts(&mut self, start: &[f64]) -> Result<(), SolveError> {
        self.allow(WORK);
        let mut random = Random(0x5eed);
        let columns = &self.program.instance.columns;
        for _ in 0..self.options.starts {
            if self.is_spent() {
                break;
            }
            let spread = 10f64.powf(1.5 * random.uniform());
            let near = |(j, &x): (usize, &f64)| {
                let (l, u) = (columns.lower[j], columns.upper[j]);
                let step = spread * x.abs().max(1.0) * (2.0 * random.uniform() - 1.0);
                (x + step).max(l).min(u)
            };
            let x: Vec<f64> = start.iter().enumerate().map(near).collect();
            match self.relax(&x) {
                Ok(()) => {}
                // A function without a value there, say.
                Err(e) => self.log(&format!("start: {}", e.message)),
            }
        }
        Ok(())
    }
}
