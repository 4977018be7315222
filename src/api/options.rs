//! What a run is asked for, and the line to it while it runs.

use crate::run;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Receives a text.
pub(super) type Listener = Arc<dyn Fn(&str) + Send + Sync>;
/// Tells seconds since 1970-01-01 UTC.
pub(super) type Clock = Arc<dyn Fn() -> f64 + Send + Sync>;

/// What a run is asked for: limits, options of solvers, a line to the running run.
///
/// ```
/// use bmod::Options;
///
/// let options = Options::default()
///     .time_limit(10.0)
///     .option("lp", "simplex")
///     .option("decimals", 6);
/// ```
#[derive(Clone, Default)]
#[must_use]
pub struct Options {
    time_limit: Option<f64>,
    pub(super) max_memory: Option<usize>,
    pairs: Vec<(String, String)>,
    certify: bool,
    explain: bool,
    pub(super) keep_solutions: bool,
    pub(super) control: Control,
    pub(super) listener: Option<Listener>,
    pub(super) watcher: Option<Listener>,
    pub(super) claims: Option<f64>,
    list: Option<usize>,
    pub(super) clock: Option<Clock>,
}

impl fmt::Debug for Options {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Options")
            .field("time_limit", &self.time_limit)
            .field("max_memory", &self.max_memory)
            .field("options", &self.pairs)
            .finish_non_exhaustive()
    }
}

impl Options {
    /// Seconds for the whole run. A solve that it stops keeps the best point it has seen.
    pub fn time_limit(mut self, seconds: f64) -> Self {
        self.time_limit = Some(seconds);
        self
    }

    /// Bytes that the process may hold while the model runs.
    pub fn max_memory(mut self, bytes: usize) -> Self {
        self.max_memory = Some(bytes);
        self
    }

    /// An option of the language or of a solver, as `bmod run --option name=value` sets it.
    pub fn option(mut self, name: impl Into<String>, value: impl fmt::Display) -> Self {
        self.pairs.push((name.into(), value.to_string()));
        self
    }

    /// Computes a proved interval for each optimal value ([`super::Solve::bounds`]).
    pub fn certify(mut self, on: bool) -> Self {
        self.certify = on;
        self
    }

    /// Explains how each solve ended, as `bmod why` does ([`super::Solve::explanation`]).
    pub fn explain(mut self, on: bool) -> Self {
        self.explain = on;
        self
    }

    /// Keeps instances and solutions ([`super::Run::solution_json`]).
    pub fn keep_solutions(mut self, on: bool) -> Self {
        self.keep_solutions = on;
        self
    }

    /// Watches and stops the run from another thread.
    pub fn control(mut self, control: &Control) -> Self {
        self.control = control.clone();
        self
    }

    /// Gets what the model prints (`display`, summaries of solves) while it runs. [`super::Run::printed`] has it too.
    pub fn on_print(mut self, listener: impl Fn(&str) + Send + Sync + 'static) -> Self {
        self.listener = Some(Arc::new(listener));
        self
    }

    /// Gets what a long step is doing, while it runs, on the thread that runs. [`Control::progress`] tells another thread.
    pub fn on_progress(mut self, listener: impl Fn(&str) + Send + Sync + 'static) -> Self {
        self.watcher = Some(Arc::new(listener));
        self
    }

    /// Looks whether what the comments of the text claim (`*= total.l 285`) is so, within a relative tolerance:
    /// [`super::Run::claims`].
    pub fn claims(mut self, tolerance: f64) -> Self {
        self.claims = Some(tolerance);
        self
    }

    /// Writes the generated rows and columns, so many of each symbol, into [`super::Run::printed`], as `bmod list` does; what else
    /// the model prints is left out.
    pub fn list(mut self, records: usize) -> Self {
        self.list = Some(records);
        self
    }

    /// Tells the time, in seconds since 1970-01-01 UTC; it must not go back. The default is the system's clock,
    /// with the feature `system`; without it the time stands still and no time limit holds.
    pub fn clock(mut self, clock: impl Fn() -> f64 + Send + Sync + 'static) -> Self {
        self.clock = Some(Arc::new(clock));
        self
    }

    /// What of them a result may depend on.
    pub(super) fn describe(&self, add: &mut dyn FnMut(&str)) {
        let mut pairs = self.pairs.clone();
        pairs.sort();
        for (name, value) in &pairs {
            add(&name.to_lowercase());
            add(value);
        }
        add(&format!(
            "{:?} {:?} {} {}",
            self.time_limit, self.max_memory, self.certify, self.explain
        ));
    }

    pub(super) fn for_machine(&self) -> run::Options {
        let mut options = run::Options {
            time_limit: self.time_limit.unwrap_or(f64::INFINITY),
            max_memory: self.max_memory,
            certify: self.certify,
            why: self.explain,
            keep_solutions: self.keep_solutions,
            quiet: self.list.is_some(),
            list: self.list.map(|limit| run::ListOptions {
                limit,
                only: Vec::new(),
            }),
            ..run::Options::default()
        };
        options.refused = options.set(&self.pairs).err();
        options
    }
}

/// A line to a run from another thread. Clones belong to the same run.
///
/// ```
/// use bmod::{Control, Model, Options};
///
/// let control = Control::new();
/// let options = Options::default().control(&control);
/// let runner = std::thread::spawn(move || {
///     let model = Model::from_text("m.blk", "Scalar n / 0 /;  while(1, n = n + 1);");
///     model.run(&options)
/// });
/// std::thread::sleep(std::time::Duration::from_millis(50));
/// control.cancel();
/// let run = runner.join().expect("it ends");
/// assert!(run.was_stopped());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Control(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    cancelled: AtomicBool,
    progress: Mutex<Progress>,
}

/// How far a run is.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// What it is doing: `solving wall: 431 rows, 250 columns`. Empty before the first solve.
    pub message: String,
    /// Seconds since the run began, when it said so.
    pub seconds: f64,
}

impl Control {
    /// A line to no run yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks the run to stop; it ends soon, with what it has found. A run that is given a cancelled control ends at
    /// once.
    pub fn cancel(&self) {
        self.0.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether the run was asked to stop.
    pub fn is_cancelled(&self) -> bool {
        self.0.cancelled.load(Ordering::Relaxed)
    }

    /// How far the run is.
    pub fn progress(&self) -> Progress {
        let progress = self.0.progress.lock();
        progress.unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(super) fn tell(&self, message: &str, seconds: f64) {
        let progress = self.0.progress.lock();
        *progress.unwrap_or_else(PoisonError::into_inner) = Progress {
            message: message.to_string(),
            seconds,
        };
    }
}
