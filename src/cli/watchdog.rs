//! The last resort of the command line: a run that does not stop at its limits is ended from outside, with a report
//! of what is known.
//!
//! Loops ask for the time themselves, and a solver that is stopped gives the best point it has seen. What asks for nothing (one
//! factorisation in a library, one huge allocation) is ended here.

use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::host::{GRACE, Output, WRITING, interrupted};
use crate::report::diagnostic::{Diagnostic, Severity};
use crate::report::json::{RunStatus, SharedReport, SolveReport};
use crate::report::summary;
use crate::solve::{ModelStatus, SolverStatus};
use crate::system;

/// The same for memory: times the limit that ends a run at once, and seconds beyond the limit that do.
const MEMORY_GRACE: (f64, f64) = (1.1, 1.0);
/// Between two looks at the memory. A process takes up about 20 MB in this time.
const LOOK: Duration = Duration::from_millis(10);

/// What is watched, and where the report goes.
pub(super) struct Watch {
    /// Seconds from now.
    pub time_limit: f64,
    /// Bytes.
    pub max_memory: Option<usize>,
    /// The report of the run.
    pub report: SharedReport,
    /// The model, as it was given.
    pub file: String,
    /// Where the report is written as JSON: a file, `-`, or nowhere.
    pub json: Option<PathBuf>,
    /// Where text for people goes.
    pub output: Output,
}

/// Watches until it is dropped.
pub(super) struct Watchdog(Arc<(Mutex<bool>, Condvar)>);

impl Watchdog {
    /// None where there are no threads.
    pub(super) fn new(watch: Watch) -> Option<Self> {
        let state = Arc::new((Mutex::new(false), Condvar::new()));
        let seen = Arc::clone(&state);
        let thread = std::thread::Builder::new().name("watchdog".into());
        thread.spawn(move || watch.until_over(&seen)).ok()?;
        Some(Self(state))
    }
}

impl Drop for Watchdog {
    fn drop(&mut self) {
        *self.0.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.0.1.notify_all();
    }
}

impl Watch {
    /// Returns when the run is over, or ends the process.
    fn until_over(&self, (over, changed): &(Mutex<bool>, Condvar)) {
        let start = Instant::now();
        let deadline = self.time_limit + GRACE.as_secs_f64();
        let (mut above_since, mut interrupted_since) = (None, None);
        let mut is_over = over.lock().unwrap_or_else(PoisonError::into_inner);
        while !*is_over {
            is_over = changed
                .wait_timeout(is_over, LOOK)
                .unwrap_or_else(PoisonError::into_inner)
                .0;
            // The lock is held from here on: a run that is over now waits, and the report is written once.
            if *is_over {
                return;
            }
            if start.elapsed().as_secs_f64() >= deadline {
                self.end(
                    "E0490",
                    RunStatus::ExecutionError,
                    &format!("the time limit of {} s is used up", self.time_limit),
                );
            }
            if interrupted()
                && interrupted_since.get_or_insert_with(Instant::now).elapsed() >= GRACE
            {
                self.end("E0492", RunStatus::Interrupted, "the run was interrupted");
            }
            if let Some(limit) = self.max_memory {
                let held = system::memory();
                let above = (held > limit).then(|| *above_since.get_or_insert_with(Instant::now));
                let (factor, seconds) = MEMORY_GRACE;
                let long = above.is_some_and(|a| a.elapsed().as_secs_f64() > seconds);
                if above.is_none() {
                    above_since = None;
                }
                if long || held as f64 > factor * limit as f64 {
                    let limit = limit >> 20;
                    self.end(
                        "E0491",
                        RunStatus::ExecutionError,
                        &format!("the memory limit of {limit} MB is used up"),
                    );
                }
            }
        }
    }

    /// Writes what is known and ends the process.
    fn end(&self, code: &'static str, status: RunStatus, message: &str) -> ! {
        let mut known = std::mem::take(&mut *self.report.get());
        let left_out = known.shorten();
        let solving = known.solving.take().map(|s| SolveReport {
            model_status: ModelStatus::NoSolution.into(),
            solver_status: match status {
                RunStatus::Interrupted => SolverStatus::UserInterrupt.into(),
                _ => SolverStatus::ResourceInterrupt.into(),
            },
            message: Some("ended from outside; its point is not known".into()),
            ..s
        });
        let doing = match &solving {
            Some(s) => format!("while `{}` was being solved", s.model),
            None => "while a statement was being carried out".into(),
        };
        let diagnostic = Diagnostic {
            code,
            severity: Severity::Execution,
            message: format!("{message}; the run was ended {doing}"),
            place: None,
            label: String::new(),
            related: Vec::new(),
            help: Some(format!("what was solved before is in the report{left_out}")),
        };
        eprintln!("{code}\n\n  x {}", diagnostic.message);
        if let Some(solve) = &solving {
            self.output.write(&summary::solve(solve, false));
        }
        let mut report = known.of(&self.file);
        report.status = status;
        report.solves.extend(solving);
        report.diagnostics.push(diagnostic);
        if let Some(path) = &self.json {
            super::commands::write_json(&report, path);
        }
        // No file is half written: whoever writes one holds this.
        let _writing = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
        std::process::exit(i32::from(status.exit()))
    }
}
