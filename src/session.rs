//! A whole run: compile, run, report. What the command line, tests and benches call.

use crate::check;
use crate::diag::{Diagnostic, Severity};
use crate::host::Host;
use crate::report::json::{Report, RunStatus};
use crate::run::{Machine, Options};
use crate::solve::registry::OPTION_TABLES;
use crate::source::{PreprocessOptions, SourceMap, Span};

/// What is left of a run.
pub struct Finished {
    /// How it ended.
    pub end: RunStatus,
    /// Solves and displays.
    pub report: Report,
    /// Errors and warnings in the order they came up.
    pub diagnostics: Vec<Diagnostic>,
    /// Where they stand.
    pub map: SourceMap,
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
    let failed = |end, diagnostics, map| Finished {
        end,
        report: Report::default(),
        diagnostics,
        map,
    };
    let mut program = match check::compile(host, path, preprocess, OPTION_TABLES) {
        Ok(p) => p,
        Err(e) => return failed(RunStatus::CompilationError, vec![e.0], e.1),
    };
    let mut diagnostics = std::mem::take(&mut program.diagnostics);
    if diagnostics.iter().any(|d| d.severity == Severity::Error) {
        return failed(RunStatus::CompilationError, diagnostics, program.map);
    }
    if check_only {
        return failed(RunStatus::Ok, diagnostics, program.map);
    }
    if let Some(message) = &options.refused {
        diagnostics.push(Diagnostic::error("E0329", Span::default(), message));
        return failed(RunStatus::CompilationError, diagnostics, program.map);
    }
    let (mut machine, code) = Machine::new(program, host, options);
    machine.run(&code);
    machine.code = code;
    inspect(&mut machine);
    let end = match () {
        () if machine.aborted() => RunStatus::Aborted,
        () if machine.failed() => RunStatus::ExecutionError,
        () => RunStatus::Ok,
    };
    diagnostics.extend(machine.take_diagnostics());
    let report = std::mem::take(&mut *machine.report());
    Finished {
        end,
        report,
        diagnostics,
        map: machine.map,
    }
}
