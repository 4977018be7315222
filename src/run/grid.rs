//! Solves in the background (`solveLink` 3 and 6): here they are over at once, and what they gave is kept under a
//! number, `m.handle`, until `handleCollect` asks for it.

use super::generate::Generated;
use super::{Flow, Machine};
use crate::check::node::{SolveCode, SymbolId};
use crate::solve::answer::Answer;
use crate::source::Span;
use std::cell::RefCell;
use std::sync::Arc;

/// What a solve gave.
struct Submitted {
    solve: SolveCode,
    generated: Generated,
    answer: Answer,
    span: Span,
}

/// The solves that wait.
#[derive(Default)]
pub(super) struct Grid {
    /// By handle less one; none: deleted.
    submitted: RefCell<Vec<Option<Arc<Submitted>>>>,
    /// Asked for in the statement that runs, with their handles: the next one sees them.
    asked: RefCell<Vec<(f64, Arc<Submitted>)>>,
}

impl Grid {
    fn place(handle: f64) -> Option<usize> {
        (handle >= 1.0 && handle.fract() == 0.0).then(|| handle as usize - 1)
    }

    /// `handleCollect`: 1 where there is a solution of this handle, otherwise 0.
    pub(super) fn collect(&self, handle: f64) -> f64 {
        let submitted = self.submitted.borrow();
        let found = Self::place(handle).and_then(|k| submitted.get(k)?.clone());
        let there = f64::from(u8::from(found.is_some()));
        self.asked.borrow_mut().extend(found.map(|s| (handle, s)));
        there
    }

    /// `handleStatus`: 2 for a solution that is there, 0 for none.
    pub(super) fn status(&self, handle: f64) -> f64 {
        let submitted = self.submitted.borrow();
        match Self::place(handle).and_then(|k| submitted.get(k)?.as_ref()) {
            Some(_) => 2.0,
            None => 0.0,
        }
    }

    /// `handleSubmit`: 0 where it is there, 2 for one that is not.
    pub(super) fn submit_again(&self, handle: f64) -> f64 {
        2.0 - self.status(handle)
    }

    /// `handleDelete`: 0 where it was there, 1 for what is no handle or before any solve, 2 for one that is gone.
    pub(super) fn delete(&self, handle: f64) -> f64 {
        let mut submitted = self.submitted.borrow_mut();
        if submitted.is_empty() {
            return 1.0;
        }
        match Self::place(handle).map(|k| submitted.get_mut(k).and_then(Option::take)) {
            Some(Some(_)) => 0.0,
            Some(None) => 2.0,
            None => 1.0,
        }
    }
}

impl Machine<'_> {
    /// Whether a solve's solution waits until it is asked for.
    pub(super) fn is_submitted(&self, s: &SolveCode) -> bool {
        let link = self.model_option(s.model, "solvelink", 2.0);
        s.scenario.is_none() && [3.0, 4.0, 6.0, 7.0].contains(&link)
    }

    /// Keeps what a solve gave, and gives its model the handle; its status stays that of the last solution taken.
    pub(super) fn submit(
        &mut self,
        s: &SolveCode,
        generated: Generated,
        answer: Answer,
        span: Span,
    ) -> Flow {
        self.report_solve(s, &generated, &answer);
        let submitted = Submitted {
            solve: s.clone(),
            generated,
            answer,
            span,
        };
        let handle = {
            let mut all = self.grid.submitted.borrow_mut();
            all.push(Some(Arc::new(submitted)));
            all.len() as f64
        };
        let state = self.models.entry(s.model).or_default();
        state.attributes.insert("handle", handle);
        match self.interrupted() {
            true => Flow::Stop,
            false => Flow::Next,
        }
    }

    /// Stores the solutions that were asked for.
    pub(super) fn take_collected(&mut self) {
        if self.grid.asked.borrow().is_empty() {
            return;
        }
        for (handle, s) in self.grid.asked.take() {
            self.store_answer(&s.solve, &s.generated, &s.answer, s.span);
            let state = self.models.entry(s.solve.model).or_default();
            state.attributes.insert("handle", handle);
        }
    }

    /// `execute_loadhandle m`
    pub(super) fn load_handle(&mut self, model: SymbolId) {
        self.grid.collect(self.object_attribute(model, "handle"));
        self.take_collected();
    }
}
