//! A whole run: compile, run, report. What the command line, tests and benches call.

use crate::check;
use crate::diag::{Diagnostic, Severity};
use crate::host::Host;
use crate::report::json::Report;
use crate::run::{Machine, Options};
use crate::source::{PreprocessOptions, SourceMap};

/// How a run ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum End {
    /// It ran (exit status 0).
    Ran,
    /// The text does not compile (2).
    NotCompiled,
    /// An execution error or an abort (3).
    Failed,
}

impl End {
    /// Exit status of the process.
    pub fn exit_status(self) -> u8 {
        match self {
            End::Ran => 0,
            End::NotCompiled => 2,
            End::Failed => 3,
        }
    }
}

/// What is left of a run.
pub struct Finished {
    /// How it ended.
    pub end: End,
    /// Solves and displays.
    pub report: Report,
    /// Errors and warnings in the order they came up.
    pub diagnostics: Vec<Diagnostic>,
    /// Where they stand.
    pub map: SourceMap,
    /// JSON of `--solution`, if it was asked for.
    pub solutions: Vec<serde_json::Value>,
}

/// Compiles and, unless `check_only`, runs a file. `inspect` sees the machine when the run is over.
pub fn run(
    host: &mut dyn Host,
    path: &str,
    preprocess: PreprocessOptions,
    options: Options,
    check_only: bool,
    inspect: &mut dyn FnMut(&mut Machine),
) -> Finished {
    let failed = |end, diagnostics, map| Finished { end, report: Report::default(), diagnostics, map, solutions: Vec::new() };
    let mut program = match check::compile(host, path, preprocess) {
        Ok(p) => p,
        Err((d, map)) => return failed(End::NotCompiled, vec![d], map),
    };
    let mut diagnostics = std::mem::take(&mut program.diagnostics);
    if diagnostics.iter().any(|d| d.severity == Severity::Error) {
        return failed(End::NotCompiled, diagnostics, program.map);
    }
    if check_only {
        return failed(End::Ran, diagnostics, program.map);
    }
    let (mut machine, code) = Machine::new(program, host, options);
    machine.run(&code);
    inspect(&mut machine);
    let end = if machine.execution_error_count() > 0 { End::Failed } else { End::Ran };
    diagnostics.extend(machine.take_diagnostics());
    let report = std::mem::take(&mut machine.report);
    let solutions = std::mem::take(&mut machine.solutions);
    Finished { end, report, diagnostics, map: machine.map, solutions }
}
