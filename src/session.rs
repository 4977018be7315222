//! A whole run: compile, run, report. What the command line, tests and benches call.

use crate::check::{self, Program};
use crate::diag::{Diagnostic, Severity};
use crate::host::Host;
use crate::report::json::{Report, RunStatus};
use crate::run::{Machine, Options};
use crate::solve::registry::SOLVERS;
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
    match check::compile(host, path, preprocess, &SOLVERS) {
        Ok(mut p) if check_only && !p.has_errors() => {
            ended(RunStatus::Ok, std::mem::take(&mut p.diagnostics), p.map)
        }
        Ok(p) => execute(p, host, options, inspect),
        Err(e) => ended(RunStatus::CompilationError, vec![e.0], e.1),
    }
}

/// Without solves and displays.
fn ended(end: RunStatus, diagnostics: Vec<Diagnostic>, map: SourceMap) -> Finished {
    Finished {
        end,
        report: Report::default(),
        diagnostics,
        map,
    }
}

/// Runs a program, unless it has errors. `inspect` sees the machine when the run is over.
pub fn execute(
    mut program: Program,
    host: &mut dyn Host,
    options: Options,
    inspect: &mut dyn FnMut(&mut Machine),
) -> Finished {
    let mut diagnostics = std::mem::take(&mut program.diagnostics);
    if diagnostics.iter().any(|d| d.severity == Severity::Error) {
        return ended(RunStatus::CompilationError, diagnostics, program.map);
    }
    if let Some(message) = &options.refused {
        diagnostics.push(Diagnostic::error("E0329", Span::default()).says(message));
        return ended(RunStatus::CompilationError, diagnostics, program.map);
    }
    let (mut machine, code) = Machine::new(program, host, options);
    machine.run(&code);
    machine.code = code;
    inspect(&mut machine);
    let end = match () {
        () if machine.interrupted() => RunStatus::Interrupted,
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
