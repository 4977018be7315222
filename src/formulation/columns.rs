//! The columns of a variable as a derivation reads them: which of them are as others are.

use super::derive::{Derivation, mentions};
use super::tree::Variable;
use crate::check::node::SymbolId;
use crate::data::universe::Label;
use crate::model::instance::{KernelTerm, Relation};
use crate::model::origin::Block;

/// The columns of a variable, by their places in its block.
#[derive(Clone, Copy)]
pub struct Columns<'a> {
    block: Option<&'a Block>,
    lower: &'a [f64],
    upper: &'a [f64],
    /// The bounds, where all have the same.
    pub alike: Option<(f64, f64)>,
}

impl<'a> Columns<'a> {
    /// How many.
    pub fn len(&self) -> usize {
        self.lower.len()
    }

    /// Lower and upper bounds.
    pub fn bounds(&self) -> impl Iterator<Item = (f64, f64)> + 'a {
        self.lower.iter().copied().zip(self.upper.iter().copied())
    }

    /// The places of the columns with bounds of a kind.
    pub fn places(&self, test: impl Fn(f64, f64) -> bool) -> Vec<usize> {
        if let Some((lower, upper)) = self.alike {
            let all = if test(lower, upper) { self.len() } else { 0 };
            return (0..all).collect();
        }
        let each = self.bounds().enumerate();
        let those = each.filter(|(_, (lower, upper))| test(*lower, *upper));
        those.map(|(n, _)| n).collect()
    }

    /// The key of a column.
    pub fn key(&self, place: usize) -> &'a [Label] {
        let key = |b: &'a Block| b.key(b.start + place as u32);
        self.block.map_or(&[], key)
    }

    /// Keys of columns.
    pub fn keys(&self, places: &[usize]) -> Vec<Vec<Label>> {
        places.iter().map(|n| self.key(*n).to_vec()).collect()
    }
}

impl<'a> Derivation<'a> {
    /// The columns of a variable.
    pub fn columns(&self, v: SymbolId) -> Columns<'a> {
        let g = &self.primal.generated;
        let block = g.origin.columns.symbol(v);
        let of = block.map_or(0..0, |b| b.start as usize..(b.start + b.len) as usize);
        let (lower, upper) = (
            &g.instance.columns.lower[of.clone()],
            &g.instance.columns.upper[of],
        );
        let same = |all: &[f64]| {
            let one = *all.first()?;
            all.iter().all(|b| *b == one).then_some(one)
        };
        Columns {
            block,
            lower,
            upper,
            alike: same(lower).zip(same(upper)),
        }
    }

    /// The columns of a variable that stand in no row with a multiplier, and in the objective at most linearly.
    pub fn without_row(&self, v: SymbolId) -> Vec<usize> {
        let Some(b) = self.primal.generated.origin.columns.symbol(v) else {
            return Vec::new();
        };
        if self.is_in_rows(v) {
            return Vec::new();
        }
        let in_rows = self.in_rows.get_or_init(|| self.columns_in_rows());
        let all = 0..b.len as usize;
        all.filter(|n| !in_rows[b.start as usize + n]).collect()
    }

    /// Whether the text says that all columns of a variable stand in rows: a column is there because a row has it.
    fn is_in_rows(&self, v: SymbolId) -> bool {
        self.all_bind
            && match (&self.eliminated, self.primal.objective) {
                (Some(o), _) => !mentions(&o.function, v),
                (None, Some((_, z))) => z != v || self.is_mentioned(Variable::Own(v)),
                (None, None) => true,
            }
    }

    /// By column: whether it stands in a row with a multiplier, or in a nonlinear term.
    fn columns_in_rows(&self) -> Vec<bool> {
        let g = &self.primal.generated;
        let gone = self.eliminated.as_ref().and_then(|o| {
            let symbol = self.primal.equations[o.equation].symbol;
            let rows = g.origin.rows.symbol(symbol);
            rows.map(|b| b.start as usize)
        });
        let mut out = vec![false; g.instance.column_count()];
        let relation = &g.instance.rows.relation;
        let m = &g.instance.matrix;
        for i in (0..relation.len()).filter(|&i| Some(i) != gone && relation[i] != Relation::Free) {
            m.row(i).for_each(|(j, _)| out[j] = true);
        }
        let bound = |t: &KernelTerm<'_>| relation[t.row] != Relation::Free;
        for t in g.instance.terms().filter(bound) {
            t.columns.iter().for_each(|j| out[*j as usize] = true);
        }
        out
    }

    /// The columns of a variable that stand in no row and make the objective better without limit: their rows in the dual
    /// hold nowhere, and need a multiplier all the same to be rows.
    pub fn unlimited_alone(&self, v: SymbolId) -> Vec<usize> {
        let g = &self.primal.generated;
        let mut alone = self.without_row(v);
        let (Some(b), Some((row, a))) = (
            g.origin.columns.symbol(v).filter(|_| !alone.is_empty()),
            g.instance.objective_row(),
        ) else {
            return Vec::new();
        };
        let mut better = vec![false; b.len as usize];
        for (j, c) in g.instance.matrix.row(row) {
            let place = j
                .checked_sub(b.start as usize)
                .filter(|n| *n < better.len());
            let Some(n) = place else { continue };
            let cost = -c / a * g.instance.sign();
            let bounds = &g.instance.columns;
            better[n] = cost < 0.0 && bounds.upper[j] == f64::INFINITY
                || cost > 0.0 && bounds.lower[j] == f64::NEG_INFINITY;
        }
        alone.retain(|n| better[*n]);
        alone
    }
}
