//! What a model keeps from run to run: its compiled text, and where its last solves ended.

use super::Model;
use super::host::{Question, RunHost};
use crate::check::{self, Program};
use crate::data::input::Input;
use crate::diag::Diagnostic;
use crate::run::Bases;
use crate::solve::registry::SOLVERS;
use crate::source::{PreprocessOptions, SourceMap};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Shared by the clones of a model until one of them changes its text.
#[derive(Default)]
pub(super) struct Kept(Mutex<Option<Compiled>>);

/// A program and what it was compiled from.
struct Compiled {
    version: u64,
    /// What was asked of the disk, and the answers.
    questions: Vec<Question>,
    inputs: Vec<Arc<Input>>,
    program: Program,
    bases: Bases,
}

impl Kept {
    fn lock(&self) -> MutexGuard<'_, Option<Compiled>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The model's program with the data it has now; compiled again only where they or its files make another one of it.
    pub(super) fn program(
        &self,
        model: &Model,
        host: &mut RunHost,
        preprocess: PreprocessOptions,
    ) -> Result<(Program, Bases), Box<(Diagnostic, SourceMap)>> {
        let mut bases = Bases::default();
        let same_text = |c: &&Compiled| c.version == model.version;
        if let Some(c) = self.lock().as_ref().filter(same_text) {
            bases.clone_from(&c.bases);
            if c.questions.iter().all(|q| host.answers_again(q)) {
                let mut program = c.program.clone();
                if program.replace_numbers(&c.inputs, &model.inputs) {
                    return Ok((program, bases));
                }
            }
        }
        let program = check::compile(host, &model.name, preprocess, &SOLVERS)?;
        if let (false, Some(questions)) = (program.has_errors(), host.questions()) {
            *self.lock() = Some(Compiled {
                version: model.version,
                questions,
                inputs: model.inputs.clone(),
                program: program.clone(),
                bases: bases.clone(),
            });
        }
        Ok((program, bases))
    }

    /// What the disk said while the model's text was compiled.
    pub(super) fn answers(&self, model: &Model) -> Option<Vec<u64>> {
        let kept = self.lock();
        let c = kept.as_ref().filter(|c| c.version == model.version)?;
        Some(c.questions.iter().map(|q| q.answer).collect())
    }

    /// Notes where the solves of a run ended.
    pub(super) fn ended_at(&self, model: &Model, bases: Bases) {
        if let Some(c) = self.lock().as_mut().filter(|c| c.version == model.version) {
            c.bases = bases;
        }
    }
}
