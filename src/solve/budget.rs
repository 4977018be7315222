//! What a solve may spend: time, iterations, failed evaluations, memory; and the user, who may end it.
//!
//! One [`Budget`] goes through everything that one `solve` statement does. Every loop asks it ([`Budget::stop`]), and
//! what stops there returns the best point it has seen. A part of the work may get less ([`Budget::within`]). The clock, the
//! user and the log are behind the [`Monitor`]: nothing in `solve` looks at the system's clock.

use std::cell::{Cell, RefCell};

use crate::model::outcome::SolverStatus;

/// The line to the outside.
pub trait Monitor {
    /// A line of the log.
    fn log(&mut self, line: &str);
    /// True once the user has asked to stop.
    fn interrupted(&mut self) -> bool;
    /// Seconds since some moment before the solve.
    fn seconds(&mut self) -> f64;
    /// Bytes of memory in use; 0 where unknown.
    fn memory(&mut self) -> usize {
        0
    }
    /// How far a method has come.
    fn progress(&mut self, _progress: &Progress) {}
    /// Name of a row for the log.
    fn row_name(&self, row: usize) -> String {
        format!("row {row}")
    }
    /// Name of a column for the log.
    fn column_name(&self, column: usize) -> String {
        format!("column {column}")
    }
}

/// How far a method has come.
#[derive(Clone, Copy, Debug, Default)]
pub struct Progress {
    /// The method.
    pub method: &'static str,
    /// Its iteration.
    pub iteration: u64,
    /// The objective, in the model's direction.
    pub objective: Option<f64>,
    /// Primal residual, as the method measures it.
    pub primal: Option<f64>,
    /// Dual residual, as the method measures it.
    pub dual: Option<f64>,
    /// Relative gap between the best point and the best bound.
    pub gap: Option<f64>,
    /// Seconds since the solve began.
    pub seconds: f64,
}

impl Progress {
    /// In a line: `pounce 14: objective 3.141593, residuals 1e-3, 2e-5, 1.2 s`.
    pub fn line(&self) -> String {
        let mut out = match self.iteration {
            0 => self.method.to_string(),
            k => format!("{} {k}", self.method),
        };
        let mut parts = Vec::new();
        parts.extend(self.objective.map(|v| format!("objective {v:.7}")));
        let residuals = [self.primal, self.dual].into_iter().flatten();
        let residuals: Vec<String> = residuals.map(|r| format!("{r:.0e}")).collect();
        if !residuals.is_empty() {
            parts.push(format!("residuals {}", residuals.join(", ")));
        }
        parts.extend(self.gap.map(|g| format!("gap {:.2} %", 100.0 * g)));
        parts.push(format!("{:.1} s", self.seconds));
        out.push_str(": ");
        out.push_str(&parts.join(", "));
        out
    }
}

/// Why a method must end.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Stop {
    /// The user asked for it.
    Interrupted,
    /// The time is used up.
    Time,
    /// The iterations are used up.
    Iterations,
    /// Too many evaluations failed.
    Evaluations,
    /// The memory is used up.
    Memory,
}

impl Stop {
    /// What the solver status says.
    pub fn status(self) -> SolverStatus {
        match self {
            Self::Interrupted => SolverStatus::UserInterrupt,
            Self::Time | Self::Memory => SolverStatus::ResourceInterrupt,
            Self::Iterations => SolverStatus::IterationInterrupt,
            Self::Evaluations => SolverStatus::EvaluationInterrupt,
        }
    }
}

/// The limits of a solve.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Seconds: `reslim`, or what `--time-limit` leaves.
    pub seconds: f64,
    /// Iterations: `iterlim`.
    pub iterations: u64,
    /// Evaluations that may fail: `domlim`; 0 is no limit.
    pub evaluation_failures: u64,
    /// Bytes: `--max-memory`, or what the machine has.
    pub memory: Option<usize>,
    /// It was `--max-memory`.
    pub memory_is_requested: bool,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            seconds: f64::INFINITY,
            iterations: 2_147_483_647,
            evaluation_failures: 0,
            memory: None,
            memory_is_requested: false,
        }
    }
}

/// What is left, and who is asked. It is shared: methods that call each other ask the same one.
pub struct Budget<'m> {
    monitor: RefCell<&'m mut dyn Monitor>,
    begin: f64,
    /// Seconds since `begin`.
    deadline: Cell<f64>,
    /// Iterations at which the part at hand ends.
    last: Cell<u64>,
    iterations: Cell<u64>,
    failures: u64,
    memory: Option<usize>,
    memory_is_requested: bool,
    stopped: Cell<Option<Stop>>,
    asked: Cell<u32>,
    log: Cell<bool>,
    /// Seconds at which a method last told how far it has come.
    told: Cell<f64>,
}

/// Seconds between two reports of a method that asks often.
const REPORTS: f64 = 0.1;

impl<'m> Budget<'m> {
    /// From now on.
    pub fn new(monitor: &'m mut dyn Monitor, limits: Limits, log: bool) -> Self {
        let begin = monitor.seconds();
        Self {
            monitor: RefCell::new(monitor),
            begin,
            deadline: Cell::new(limits.seconds),
            last: Cell::new(limits.iterations),
            iterations: Cell::new(0),
            failures: limits.evaluation_failures,
            memory: limits.memory,
            memory_is_requested: limits.memory_is_requested,
            stopped: Cell::new(None),
            asked: Cell::new(0),
            log: Cell::new(log),
            told: Cell::new(0.0),
        }
    }

    /// Without limits.
    pub fn unlimited(monitor: &'m mut dyn Monitor) -> Self {
        Self::new(monitor, Limits::default(), false)
    }

    /// Seconds since the solve began.
    pub fn seconds(&self) -> f64 {
        self.monitor.borrow_mut().seconds() - self.begin
    }

    /// Seconds left, not below 0; may be infinite.
    pub fn seconds_left(&self) -> f64 {
        match self.deadline.get() {
            d if d.is_finite() => (d - self.seconds()).max(0.0),
            d => d,
        }
    }

    /// Iterations so far.
    pub fn iterations(&self) -> u64 {
        self.iterations.get()
    }

    /// Iterations left.
    pub fn iterations_left(&self) -> u64 {
        self.last.get().saturating_sub(self.iterations.get())
    }

    /// Counts iterations that were made.
    pub fn spend(&self, iterations: u64) {
        let all = self.iterations.get().saturating_add(iterations);
        self.iterations.set(all);
    }

    /// Whether, and why, the work at hand must end. The first reason stays.
    pub fn stop(&self) -> Option<Stop> {
        if self.stopped.get().is_none() {
            self.stopped.set(self.reason());
        }
        self.stopped.get()
    }

    fn reason(&self) -> Option<Stop> {
        let monitor = &mut *self.monitor.borrow_mut();
        if monitor.interrupted() {
            Some(Stop::Interrupted)
        } else if self.deadline.get() < f64::INFINITY
            && monitor.seconds() - self.begin >= self.deadline.get()
        {
            Some(Stop::Time)
        } else if self
            .memory
            .is_some_and(|m| self.is_time_to_look() && monitor.memory() > m)
        {
            Some(Stop::Memory)
        } else if self.iterations.get() >= self.last.get() {
            Some(Stop::Iterations)
        } else {
            None
        }
    }

    /// To ask for the memory is dear.
    fn is_time_to_look(&self) -> bool {
        let asked = self.asked.get().wrapping_add(1);
        self.asked.set(asked);
        asked.is_multiple_of(QUESTIONS_PER_LOOK_AT_MEMORY)
    }

    /// Whether the work at hand must end.
    pub fn is_over(&self) -> bool {
        self.stop().is_some()
    }

    /// The same after so many evaluations failed.
    pub fn stop_after_failures(&self, failures: u64) -> Option<Stop> {
        if self.failures > 0 && failures > self.failures && self.stopped.get().is_none() {
            self.stopped.set(Some(Stop::Evaluations));
        }
        self.stop()
    }

    /// Ends the work for a reason that a solver found first.
    pub fn end(&self, stop: Stop) {
        if self.stopped.get().is_none() {
            self.stopped.set(Some(stop));
        }
    }

    /// Why the work ended, if it has; nobody is asked.
    pub fn stopped(&self) -> Option<Stop> {
        self.stopped.get()
    }

    /// A part of the work that may take so many seconds and iterations at most. That it used them up does not end the whole.
    pub fn within<T>(&self, seconds: f64, iterations: u64, work: impl FnOnce(&Self) -> T) -> T {
        let (deadline, last) = (self.deadline.get(), self.last.get());
        if seconds.is_finite() {
            self.deadline.set(deadline.min(self.seconds() + seconds));
        }
        let end = self.iterations.get().saturating_add(iterations);
        self.last.set(last.min(end));
        let before = self.stopped.get();
        let out = work(self);
        self.deadline.set(deadline);
        self.last.set(last);
        if before.is_none() && matches!(self.stopped.get(), Some(Stop::Time | Stop::Iterations)) {
            self.stopped.set(None);
        }
        out
    }

    /// A part of the work whose iterations are not counted, without a log.
    pub fn aside<T>(&self, work: impl FnOnce(&Self) -> T) -> T {
        let (iterations, log) = (self.iterations.get(), self.log.replace(false));
        let out = work(self);
        self.iterations.set(iterations);
        self.log.set(log);
        out
    }

    /// The end of the work, which is done although time or iterations are used up, in so many seconds at most and without a
    /// log. The user may still stop it.
    pub fn after_all<T>(&self, seconds: f64, work: impl FnOnce(&Self) -> T) -> T {
        let stopped = self.stop();
        let (deadline, last) = (self.deadline.get(), self.last.get());
        if matches!(stopped, Some(Stop::Time | Stop::Iterations)) {
            self.stopped.set(None);
            self.deadline.set(self.seconds() + seconds);
            self.last.set(u64::MAX);
        }
        let out = self.aside(work);
        self.deadline.set(deadline);
        self.last.set(last);
        self.stopped.set(stopped.or(self.stopped.get()));
        out
    }

    /// A part of the work without a log.
    pub fn silently<T>(&self, work: impl FnOnce(&Self) -> T) -> T {
        let log = self.log.replace(false);
        let out = work(self);
        self.log.set(log);
        out
    }

    /// Whether there is a log.
    pub fn wants_log(&self) -> bool {
        self.log.get()
    }

    /// A line of the log.
    pub fn log(&self, line: impl AsRef<str>) {
        if self.log.get() {
            self.monitor.borrow_mut().log(line.as_ref());
        }
    }

    /// A line of the log that ends with the seconds so far.
    pub fn log_timed(&self, line: &str) {
        if self.log.get() {
            self.log(format!("{line}, {:.2} s", self.seconds()));
        }
    }

    /// Tells how far a method has come.
    pub fn progress(&self, progress: Progress) {
        let seconds = self.seconds();
        let told = Progress {
            seconds,
            ..progress
        };
        self.monitor.borrow_mut().progress(&told);
    }

    /// The same for loops that ask often: now and then.
    pub(in crate::solve) fn tell(&self, progress: Progress) {
        let seconds = self.seconds();
        if seconds >= self.told.get() + REPORTS {
            self.told.set(seconds);
            self.progress(progress);
        }
    }

    /// Name of a row for the log.
    pub fn row_name(&self, row: usize) -> String {
        self.monitor.borrow().row_name(row)
    }

    /// Name of a column for the log.
    pub fn column_name(&self, column: usize) -> String {
        self.monitor.borrow().column_name(column)
    }

    /// Bytes that may still be taken; None without a limit.
    pub fn memory_left(&self) -> Option<usize> {
        let used = self.monitor.borrow_mut().memory();
        self.memory.map(|m| m.saturating_sub(used))
    }

    /// Whether there is a limit on time or memory, asked for, that a single step may break.
    pub fn is_limited(&self) -> bool {
        self.memory_is_requested || self.deadline.get() < A_DAY
    }

    /// Whether something of this size may be begun that cannot be stopped once it has: a matrix that a library factorises
    /// in one piece. The size is asked for only where there is a limit. Err: why not, with the size.
    pub fn affords(&self, size: impl FnOnce() -> Size) -> Result<(), String> {
        if !self.is_limited() {
            return Ok(());
        }
        let size = size();
        let bytes = size.nonzeros * BYTES_PER_NONZERO;
        if self.memory_left().is_some_and(|left| bytes > left as f64) {
            return Err(format!(
                "{} would have {:.2e} nonzeros ({:.0} MB), more than the memory that is left",
                size.what,
                size.nonzeros,
                bytes / 1048576.0
            ));
        }
        let seconds = size.operations / OPERATIONS_PER_SECOND;
        if seconds > self.seconds_left().max(SHORT) {
            return Err(format!(
                "{} would take {:.2e} operations with {:.2e} nonzeros, about {seconds:.0} s, more than the time that is left",
                size.what, size.operations, size.nonzeros
            ));
        }
        Ok(())
    }
}

/// What a factorisation costs.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// What it is: `the factor of the KKT matrix`.
    pub what: &'static str,
    /// Numbers that it holds.
    pub nonzeros: f64,
    /// Multiplications and additions.
    pub operations: f64,
}

/// What takes no longer than this, in seconds, may always be begun.
const SHORT: f64 = 1.0;
/// Questions between two looks at the memory.
const QUESTIONS_PER_LOOK_AT_MEMORY: u32 = 16;
/// A limit of so many seconds is none for a single step.
const A_DAY: f64 = 86_400.0;
/// Value, index, and what a library copies of them while it works.
const BYTES_PER_NONZERO: f64 = 32.0;
/// What a sparse factorisation reaches on one processor where it fills up (`benches/lp.rs`: 1 to 3·10⁹).
const OPERATIONS_PER_SECOND: f64 = 2e9;

/// A monitor that says nothing, with a clock of its own.
#[derive(Debug)]
pub struct Quiet {
    #[cfg(feature = "system")]
    begin: std::time::Instant,
}

impl Default for Quiet {
    fn default() -> Self {
        Self {
            #[cfg(feature = "system")]
            begin: std::time::Instant::now(),
        }
    }
}

impl Monitor for Quiet {
    fn log(&mut self, _: &str) {}

    fn interrupted(&mut self) -> bool {
        false
    }

    #[cfg(feature = "system")]
    fn seconds(&mut self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    #[cfg(not(feature = "system"))]
    fn seconds(&mut self) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A clock that goes on by a second with every look.
    struct Ticking(f64);

    impl Monitor for Ticking {
        fn log(&mut self, _: &str) {}
        fn interrupted(&mut self) -> bool {
            false
        }
        fn seconds(&mut self) -> f64 {
            self.0 += 1.0;
            self.0
        }
    }

    #[test]
    fn a_part_ends_before_the_whole() {
        let mut clock = Ticking(0.0);
        let limits = Limits {
            seconds: 100.0,
            iterations: 50,
            ..Limits::default()
        };
        let budget = Budget::new(&mut clock, limits, false);
        assert_eq!(budget.stop(), None);
        let inner = budget.within(3.0, 40, |b| {
            let mut asked = 0;
            while b.stop().is_none() {
                asked += 1;
            }
            (asked, b.stop())
        });
        assert!(inner.0 <= 4 && inner.1 == Some(Stop::Time), "{inner:?}");
        assert_eq!(budget.stop(), None);
        budget.within(f64::INFINITY, 10, |b| {
            b.spend(10);
            assert_eq!(b.stop(), Some(Stop::Iterations));
        });
        assert_eq!((budget.iterations(), budget.iterations_left()), (10, 40));
        budget.aside(|b| b.spend(40));
        assert_eq!(budget.stop(), None);
        budget.spend(40);
        assert_eq!(budget.stop(), Some(Stop::Iterations));
    }

    #[test]
    fn what_cannot_fit_is_not_begun() {
        let mut quiet = Quiet::default();
        let limits = Limits {
            seconds: 3.0,
            memory: Some(1 << 20),
            memory_is_requested: true,
            ..Limits::default()
        };
        let budget = Budget::new(&mut quiet, limits, false);
        let size = |nonzeros, operations| {
            move || Size {
                what: "the factor",
                nonzeros,
                operations,
            }
        };
        assert_eq!(budget.affords(size(1e3, 1e6)), Ok(()));
        assert!(budget.affords(size(1e8, 1e6)).is_err());
        assert!(budget.affords(size(1e3, 1e11)).is_err());
    }
}
