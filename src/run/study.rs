//! A solve that is looked at when the run is over: its code, the data as they were, the answer.

use super::random::Random;
use super::{Frame, GenerateOptions, Generated, Machine};
use crate::check::node::{SolveCode, TableId};
use crate::data::table::Table;
use crate::model::origin::Origin;
use crate::solve::answer::Answer;
use crate::source::Span;

/// Which solve of a run is looked at: the last that fits.
#[derive(Clone, Debug, Default)]
pub struct StudyChoice {
    /// Of this model.
    pub model: Option<String>,
    /// The one with this number, counted from 1.
    pub number: Option<usize>,
    /// Models are generated only.
    pub generate_only: bool,
}

/// A solve as it was.
pub struct Studied {
    /// The statement.
    pub code: SolveCode,
    /// Its place.
    pub span: Span,
    /// Its number in the run, counted from 1.
    pub number: usize,
    /// All data before it; once it is taken, those of the end.
    tables: Vec<Table>,
    /// Random numbers before it.
    random: Random,
    /// What the instance was made of, and the answer.
    pub answer: Option<(Origin, Answer)>,
}

impl Studied {
    /// A table as it was when the run ended.
    pub fn at_end(&self, table: TableId) -> Option<&Table> {
        self.tables.get(table as usize)
    }
}

impl Machine<'_> {
    /// Keeps the data of a solve that is to be looked at; whether it is not to be solved.
    pub(super) fn study(&mut self, s: &SolveCode, span: Span) -> bool {
        let Some(choice) = self.options.study.clone() else {
            return false;
        };
        self.solves_seen += 1;
        let name = &self.symbols.get(s.model).name;
        let model = choice.model.as_ref();
        let fits = model.is_none_or(|m| m.eq_ignore_ascii_case(name))
            && choice.number.is_none_or(|n| n == self.solves_seen);
        if fits {
            self.studied = Some(Box::new(Studied {
                code: s.clone(),
                span,
                number: self.solves_seen,
                tables: self.store.tables.clone(),
                random: self.random.borrow().clone(),
                answer: None,
            }));
        }
        choice.generate_only
    }

    /// Keeps the answer of the solve that is looked at.
    pub(super) fn study_answer(&mut self, g: &Generated, a: &Answer) {
        let number = self.solves_seen;
        if let Some(s) = &mut self.studied
            && s.number == number
        {
            s.answer = Some((g.origin.clone(), a.clone()));
        }
    }

    /// How many tuples a definition runs over.
    pub fn tuple_count(&self, definition: usize) -> usize {
        let equations = self.equations.clone();
        let d = &equations[definition].domain;
        match d.slots.len() {
            0 => 1,
            n => self.tuples(d, &[], &mut vec![0; self.slots]).len() / n,
        }
    }

    /// Adds what a command has to say to what the run had.
    pub fn say(&self, d: crate::diag::Diagnostic) {
        d.note(self);
    }

    /// How many solves a run with a study had.
    pub fn solves_seen(&self) -> usize {
        self.solves_seen
    }

    /// The solve that is looked at, and its instance without what options left out; the data are again as they were then.
    pub fn take_study(&mut self) -> Option<(Studied, Option<Generated>)> {
        let mut s = *self.studied.take()?;
        std::mem::swap(&mut self.store.tables, &mut s.tables);
        self.random.replace(s.random.clone());
        self.store.refresh_universe();
        self.store.tables.iter_mut().for_each(Table::tidy);
        let options = GenerateOptions {
            keep_paired: s.code.using.has_pairs(),
            ..GenerateOptions::default()
        };
        let mut frame: Frame = vec![0; self.slots];
        let g = self.generate(&s.code, options, &mut frame);
        Some((s, g))
    }
}
