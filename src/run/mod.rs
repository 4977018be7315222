//! Runs a checked program: statements in order, on sparse data; at `solve` it calls down and stores
//! the answer.
//!
//! As in GAMS an execution error does not stop the run: the value is `undf`, the run goes on, and
//! the next solve is refused and ends it.

pub mod arithmetic;
pub mod plan;
pub mod random;

mod attributes;
mod constant;
mod count;
mod draw;
mod eval;
mod examine;
mod exchange;
mod exec;
mod files;
mod generate;
mod grid;
mod listing;
mod option_file;
mod options;
mod put;
mod put_utility;
mod scan;
mod scenarios;
mod show;
mod solve;
mod study;
mod support;

pub use eval::Frame;
pub use generate::{GenerateOptions, Generated};
pub use options::{Bases, ListOptions, ModelState, Options};
pub use study::{Studied, StudyChoice};

use crate::check::Program;
use crate::check::node::*;
use crate::check::symbols::{Store, SymbolKind, Symbols};
use crate::data::table::Table;
use crate::data::universe::Label;
use crate::diag::{Diagnostic, Severity};
use crate::host::Host;
use crate::report::json::Report;
use crate::source::{SourceMap, Span};
use random::Random;
use rustc_hash::{FxHashMap, FxHashSet};
use std::cell::{Cell, RefCell};
use std::sync::{Arc, MutexGuard};

/// More execution errors than this are counted but not kept.
const MAX_KEPT_ERRORS: usize = 30;
/// What is done where nothing else is said.
const STATEMENTS: &str = "running statements";

/// What the rest of the run does after a statement.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Flow {
    /// Goes on.
    Next,
    /// Leaves so many loops.
    Break(u32),
    /// Next turn of the innermost loop.
    Continue,
    /// Ends the run.
    Stop,
}

/// The state of a run.
pub struct Machine<'h> {
    /// All names.
    pub symbols: Symbols,
    /// All data.
    pub store: Store,
    /// Definitions of equations.
    pub equations: Arc<Vec<EquationDef>>,
    /// Where everything stands.
    pub map: SourceMap,
    /// The statements, when the run is over.
    pub code: Arc<Vec<Code>>,
    /// Options in force.
    pub options: Options,
    /// State of each model.
    pub models: FxHashMap<SymbolId, ModelState>,
    /// Keys of the columns and rows of the last solve, by symbol: they are records until levels or marginals are assigned.
    generated: FxHashMap<SymbolId, Vec<Label>>,
    /// `option p:d:r:c`
    pub formats: FxHashMap<SymbolId, Vec<i64>>,
    /// Ranges of linear programs, where `option ranging` asks for them.
    ranges: FxHashMap<(SymbolId, Derived), Table>,
    /// Solves that are kept for `--solution`.
    kept: Vec<solve::KeptSolve>,
    /// Solves whose solutions wait until they are asked for.
    grid: grid::Grid,
    /// The solve that is looked at when the run is over, and how many there were.
    studied: Option<Box<Studied>>,
    solves_seen: usize,
    /// Files of `put`.
    pub put: options::PutState,
    /// Files that data go to and come from.
    transfer: exchange::ExchangeState,
    /// What `bmod list` leaves out.
    unsolved: listing::Unsolved,
    host: RefCell<&'h mut dyn Host>,
    random: RefCell<Random>,
    diagnostics: RefCell<Vec<Diagnostic>>,
    /// Execution errors, each record's.
    errors: Cell<usize>,
    /// Statements that had some, as `execError` counts them.
    failed_statements: Cell<usize>,
    /// What assigned that number last.
    errors_assigned: Cell<Option<Span>>,
    /// So many of them the run may have and go on: `maxExecError`.
    most_errors: usize,
    /// What is assigned just now, for messages.
    current: RefCell<Option<(SymbolId, Vec<Label>)>>,
    ticks: Cell<u32>,
    /// What takes its time now, for who waits.
    pub(crate) doing: RefCell<String>,
    stop: Cell<bool>,
    interrupted: Cell<bool>,
    /// Bytes that the run may take: what was asked for, or what the machine has.
    memory: Option<usize>,
    /// The text itself shows numbers.
    shows_numbers: bool,
    /// Loops around the statement that runs.
    loops: usize,
    started: f64,
    table_symbols: Vec<SymbolId>,
    slots: usize,
    /// Option files of which it was said what is passed over.
    passed_over: FxHashSet<String>,
}

impl Diagnostic {
    /// Reports it to the user, unless it repeats another.
    pub(crate) fn note(self, m: &Machine) {
        m.keep(self);
    }
}

impl<'h> Machine<'h> {
    /// A machine for a program that compiled.
    pub fn new(
        program: Program,
        host: &'h mut dyn Host,
        options: Options,
    ) -> (Self, Arc<Vec<Code>>) {
        let mut table_symbols = vec![0; program.store.tables.len()];
        for (id, s) in program.symbols.iter() {
            if matches!(s.kind, SymbolKind::Alias(_)) {
                continue;
            }
            let count = match s.kind {
                SymbolKind::Variable(_) | SymbolKind::Equation(_) => {
                    crate::check::symbols::attribute::COUNT
                }
                SymbolKind::Set { .. } | SymbolKind::Parameter { .. } => 1,
                _ => 0,
            };
            for t in s.table..s.table + count {
                table_symbols[t as usize] = id;
            }
        }
        let started = host.now();
        let random = options.random();
        let memory = options.max_memory.or_else(|| host.available_memory());
        let machine = Self {
            symbols: program.symbols,
            store: program.store,
            equations: program.equations,
            map: program.map,
            code: Arc::default(),
            options,
            memory,
            passed_over: FxHashSet::default(),
            models: FxHashMap::default(),
            generated: FxHashMap::default(),
            formats: FxHashMap::default(),
            ranges: FxHashMap::default(),
            kept: Vec::new(),
            grid: grid::Grid::default(),
            studied: None,
            solves_seen: 0,
            put: options::PutState::default(),
            transfer: exchange::ExchangeState::default(),
            unsolved: listing::Unsolved::default(),
            host: RefCell::new(host),
            random: RefCell::new(random),
            diagnostics: RefCell::new(Vec::new()),
            errors: Cell::new(0),
            failed_statements: Cell::new(0),
            errors_assigned: Cell::new(None),
            most_errors: 0,
            current: RefCell::new(None),
            ticks: Cell::new(0),
            doing: RefCell::new(STATEMENTS.into()),
            stop: Cell::new(false),
            interrupted: Cell::new(false),
            shows_numbers: program.shows_numbers,
            loops: 0,
            started,
            table_symbols,
            slots: program.slots,
        };
        (machine, program.code)
    }

    /// Runs all statements.
    pub fn run(&mut self, code: &[Code]) -> Flow {
        let mut frame = vec![0; self.slots];
        self.write_early_files();
        let flow = self.block(code, &mut frame);
        self.interrupted();
        self.close_put_files();
        self.explain_assigned_errors();
        flow
    }

    /// What is reported: solves, displays.
    pub(crate) fn report(&self) -> MutexGuard<'_, Report> {
        self.options.report.get()
    }

    /// Warnings and errors so far.
    pub fn take_diagnostics(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.diagnostics.borrow_mut())
    }

    /// Keeps a diagnostic, unless it repeats another.
    fn keep(&self, d: Diagnostic) {
        let mut list = self.diagnostics.borrow_mut();
        // A loop comes to the same place again; a warning may come from several solves.
        let warning = d.severity == Severity::Warning;
        let again = list
            .iter()
            .any(|e| e.code == d.code && (e.span == d.span || warning && e.message == d.message));
        if d.severity == Severity::Execution {
            self.errors.set(self.errors.get() + 1);
            let failed = self.failed_statements.get();
            // A statement counts once, and again when `execError` was set back.
            if !again || failed == 0 {
                self.failed_statements.set(failed + 1);
            }
        }
        if (list.len() < MAX_KEPT_ERRORS || self.stop.get()) && !again {
            list.push(d);
        }
    }

    /// What follows from the last error stands in its message: one mistake, one message.
    pub(crate) fn consequence(&self, span: Span, text: &str) {
        let mut list = self.diagnostics.borrow_mut();
        let last = list.iter_mut().rfind(|d| d.severity == Severity::Execution);
        if let Some(d) = last.filter(|d| d.others.iter().all(|o| o.text != text)) {
            *d = std::mem::replace(d, Diagnostic::execution(d.code, d.span)).other(span, text);
        }
    }

    /// Whether an `abort` statement ended the run.
    pub fn aborted(&self) -> bool {
        self.diagnostics.borrow().iter().any(|d| d.code == "E0480")
    }

    /// Number of execution errors so far.
    pub fn execution_error_count(&self) -> usize {
        self.errors.get()
    }

    /// Statements that had execution errors, since `execError` was set last.
    pub(crate) fn statements_failed(&self) -> usize {
        self.failed_statements.get()
    }

    /// Whether there were more execution errors than `maxExecError` lets pass.
    pub fn failed(&self) -> bool {
        self.statements_failed() > self.most_errors
    }

    /// A run that fails by what was assigned to `execError` alone says so.
    pub(crate) fn explain_assigned_errors(&self) {
        let list = self.diagnostics.borrow();
        let explained = list.iter().any(|d| d.severity == Severity::Execution);
        drop(list);
        let assigned = self.errors_assigned.take();
        if let (true, false, Some(span)) = (self.failed(), explained, assigned) {
            let (errors, most) = (self.statements_failed(), self.most_errors);
            Diagnostic::execution("E0485", span)
                .says(format!(
                    "`execError` is {errors}, and `maxExecError` {most}: the run fails"
                ))
                .label("assigned here")
                .help("leave the assignment out, or write `execError = 0;` behind it")
                .note(self);
        }
    }

    /// The symbol of a table.
    pub fn table_owner(&self, t: TableId) -> Option<SymbolId> {
        self.table_symbol(t)
    }

    /// The symbol of a table.
    pub(crate) fn table_symbol(&self, t: TableId) -> Option<SymbolId> {
        self.table_symbols.get(t as usize).copied()
    }

    /// After a statement that may take long (a solve, a display, a figure): the next [`Machine::keep_going`] looks.
    pub(crate) fn look_soon(&self) {
        self.ticks.set(self.ticks.get() | 0xffff);
    }

    /// False once the run is to end: Ctrl-C, or a limit. Cheap enough for inner loops.
    #[inline]
    pub(crate) fn keep_going(&self) -> bool {
        let t = self.ticks.get().wrapping_add(1);
        self.ticks.set(t);
        if t & 0xffff != 0 {
            return !self.stop.get();
        }
        self.check_limits()
    }

    #[cold]
    fn check_limits(&self) -> bool {
        if self.stop.get() || self.interrupted() {
            return false;
        }
        let host = self.host.borrow();
        if host.elapsed() > self.options.time_limit {
            self.stop.set(true);
            drop(host);
            Diagnostic::execution("E0490", self.options.at.get())
                .says(format!(
                    "the time limit of {} s is used up",
                    self.options.time_limit
                ))
                .label("stopped here")
                .help("raise it with `--time-limit`, or look for a loop that does not end")
                .note(self);
            return false;
        }
        if let Some(limit) = self.memory
            && host.memory() > limit
        {
            self.stop.set(true);
            drop(host);
            Diagnostic::execution("E0491", self.options.at.get())
                .says(format!("the memory limit of {} MB is used up", limit >> 20))
                .label("stopped here")
                .help("raise it with `--max-memory`, or add a condition that keeps the set sparse")
                .note(self);
            return false;
        }
        drop(host);
        self.host().progress(&self.doing.borrow());
        true
    }

    /// Whether the user has stopped the run: it ends here, and says so.
    pub(crate) fn interrupted(&self) -> bool {
        if !self.stop.get() && self.host.borrow().interrupted() {
            self.stop.set(true);
            self.interrupted.set(true);
            Diagnostic::execution("E0492", self.options.at.get())
                .says("the run was interrupted")
                .label("stopped here")
                .help("what was computed before is kept; nothing behind this place was carried out")
                .note(self);
        }
        self.interrupted.get()
    }

    /// Whether the run was stopped by a limit or by the user.
    pub fn stopped(&self) -> bool {
        self.stop.get()
    }

    pub(crate) fn now(&self) -> f64 {
        self.host.borrow().now()
    }

    pub(crate) fn elapsed(&self) -> f64 {
        self.host.borrow().elapsed()
    }

    /// Prints for the user.
    pub(crate) fn print(&self, text: &str) {
        self.host.borrow_mut().print(text);
    }

    /// The outside world.
    pub(crate) fn host(&self) -> std::cell::RefMut<'_, &'h mut dyn Host> {
        self.host.borrow_mut()
    }

    /// `p('a','x')` of what is assigned just now.
    fn current_record(&self) -> String {
        match &*self.current.borrow() {
            Some((s, key)) if !key.is_empty() => format!("in {}", self.record_name(*s, key)),
            _ => String::new(),
        }
    }

    /// `x('a','b')`.
    pub fn record_name(&self, s: SymbolId, key: &[Label]) -> String {
        let labels = key.iter().map(|&l| self.store.universe.name(l).to_string());
        let labels: Vec<String> = labels.collect();
        crate::report::names::join(&self.symbols.get(s).name, &labels)
    }
}
