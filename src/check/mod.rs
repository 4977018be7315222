//! From trees to a checked program: names resolved, dimensions, domains and index control checked,
//! data statements carried out.
//!
//! Statements are taken one at a time, in the order of the text, so that what `$if declared` and
//! `$eval card(i)` ask can be answered at their place. Several errors are reported per run.

pub mod calendar;
pub mod exchange;
pub mod functions;
pub mod node;
pub mod symbols;
pub mod visit;

mod assign;
mod control;
mod data;
mod declare;
mod driver;
mod effects;
pub(crate) mod expansion;
mod expr;
pub(crate) mod figure;
mod follow;
mod index;
mod input;
pub mod model;
pub(crate) mod option;
pub(crate) mod output;
mod statement;
mod table;

pub(crate) use figure::kinds as figure_kinds;

use crate::autodiff::{function_value, special::factorial};
use crate::diag::{Diagnostic, Severity};
use crate::host::Host;
use crate::model::option::{Refused, Solvers};
use crate::source::{
    Ending, Known, PreprocessOptions, ReadData, SourceMap, Span, Switches, predefined,
};
use crate::syntax::Parser;
use crate::syntax::ast::StmtKind;
use functions::Callee;
use node::{Code, DataFunction, EquationDef, Part, Slot, SymbolId};
use std::cell::Cell;
use std::sync::Arc;
use symbols::{DomainPosition, Store, Symbol, SymbolKind, Symbols, UNIVERSE};

/// An error was reported; there is nothing more to say.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Failed;

/// What is checked, unless an error was reported.
type Checked<T> = Result<T, Failed>;

/// More errors than this are not reported.
const MAX_ERRORS: usize = 30;

/// A checked program, ready to run. A clone shares the code and has its own data.
#[derive(Clone, Debug)]
pub struct Program {
    /// All names.
    pub symbols: Symbols,
    /// Data as the data statements left it.
    pub store: Store,
    /// Definitions of equations.
    pub equations: Arc<Vec<EquationDef>>,
    /// Statements.
    pub code: Arc<Vec<Code>>,
    /// Whether the text itself shows numbers: a `display`, `put`, `draw` or `execute_unload`.
    pub shows_numbers: bool,
    /// Number of slots the frame needs.
    pub slots: usize,
    /// Where everything stands.
    pub map: SourceMap,
    /// Errors and warnings, in the order of the text.
    pub diagnostics: Vec<Diagnostic>,
    /// The text asked for data while it was read (`$eval card(i)`): with other data it may be another program.
    pub asked_for_data: bool,
    /// Names that `-D` defined and the text never asks for.
    pub unused_defines: Vec<String>,
}

impl Program {
    /// Whether it may run.
    pub fn has_errors(&self) -> bool {
        self.diagnostics
            .iter()
            .any(|d| d.severity == Severity::Error)
    }
}

/// The state of checking.
#[derive(Default)]
pub(crate) struct Compiler {
    symbols: Symbols,
    store: Store,
    equations: Vec<EquationDef>,
    /// Sets and parameters without data that the equation at hand reads, where it does; and each of the equations.
    reads: Vec<(SymbolId, Span)>,
    without_data: Vec<Vec<(SymbolId, Span)>>,
    /// Sets that run in the equation at hand.
    running: Vec<SymbolId>,
    diagnostics: Vec<Diagnostic>,
    /// Sets under control, innermost last.
    scope: Vec<(SymbolId, Vec<Part>)>,
    /// Which of them stand for what their indices found: `s` under `loop(s(i), …)`.
    maps: Vec<usize>,
    /// Symbols declared with `<` behind an index: their data define those sets.
    defining: rustc_hash::FxHashMap<SymbolId, Vec<bool>>,
    /// What `function f /stolib.dnormal/` named, in lower case.
    library: rustc_hash::FxHashMap<String, (Callee, usize, usize)>,
    /// The file that `$gdxIn` named.
    input: Option<(String, Span)>,
    /// The file that `$gdxOut` named, and what `$unload` asked for.
    output: Option<(String, Span, Vec<exchange::Wanted>)>,
    shows_numbers: bool,
    next_slot: Slot,
    /// Symbols whose `$load` failed.
    not_loaded: rustc_hash::FxHashSet<SymbolId>,
    /// Indices of the loop that is read and of those around it that hold nothing else.
    nest: Vec<(Slot, node::TableId)>,
    slots: usize,
    in_equation: bool,
    /// Labels that are new may stand here.
    new_labels: bool,
    texts_allowed: bool,
    /// Sets whose elements look like something else: said, unless an error about the set does.
    doubtful: Vec<(SymbolId, Diagnostic)>,
    /// Depth of loops and ifs.
    nesting: usize,
    /// The file that a `put` above names last.
    put_named: Option<SymbolId>,
    /// What data may take, and what they took so far, in bytes.
    max_memory: Option<usize>,
    taken: usize,
    /// Data from outside the text.
    inputs: input::Inputs,
    /// [`Program::asked_for_data`]
    asked_for_data: Cell<bool>,
    /// What options are there.
    solvers: &'static Solvers,
    /// Options that mean nothing here, and that were said to.
    passed_over: rustc_hash::FxHashSet<String>,
    modes: Switches,
    lost: follow::Lost,
}

/// Compiles a file: parses, checks and carries out its data statements. The `option` statement takes the options of
/// these solvers besides the language's.
pub fn compile(
    host: &mut dyn Host,
    path: &str,
    mut options: PreprocessOptions,
    solvers: &'static Solvers,
) -> Result<Program, Box<(Diagnostic, SourceMap)>> {
    let (max_memory, warns_of_unused) = (options.max_memory, options.warns_of_unused);
    let inputs = std::mem::take(&mut options.inputs);
    let mut parser =
        Parser::new(host, path, options).map_err(|u| Box::new((u.diagnostic, u.map)))?;
    let mut c = Compiler::new();
    c.max_memory = max_memory;
    c.inputs = input::Inputs::new(inputs);
    c.solvers = solvers;
    let mut code = Vec::new();
    loop {
        let next = parser.next(&c);
        c.diagnostics.extend(parser.warnings());
        match next {
            Ok(None) => break,
            Ok(Some(stmt)) => {
                c.modes = stmt.modes.clone();
                if let StmtKind::Exchange(x) = &stmt.kind
                    && !matches!(c.exchange_now(x, stmt.span, &mut parser), Ok(false))
                {
                    continue;
                }
                let mut one = Vec::new();
                // What is wrong is not run, should `$clearError` let the rest run.
                if c.statement(&stmt, parser.map(), &mut one).is_ok() {
                    code.append(&mut one);
                }
            }
            Err(errors) => {
                c.begin_statement();
                errors.into_iter().for_each(|d| d.report(&mut c));
                if let Some(text) = parser.refused() {
                    c.lose_statement(text);
                }
            }
        }
        if c.errors() - parser.cleared_errors() >= MAX_ERRORS {
            let at = c.diagnostics.last().map_or_else(Span::default, |d| d.span);
            c.diagnostics
                .push(Diagnostic::error("E0300", at).says(format!(
                    "more than {MAX_ERRORS} errors; the rest of the text was not checked"
                )));
            break;
        }
    }
    if let Err(d) = c.finish_unload(&mut parser) {
        d.as_error().report(&mut c);
    }
    c.unused_inputs();
    if warns_of_unused {
        c.diagnostics.extend(parser.warnings_of_unused());
    }
    c.clear_errors(parser.cleared_errors());
    c.declared_below(parser.map());
    let doubtful = std::mem::take(&mut c.doubtful);
    c.diagnostics.extend(doubtful.into_iter().map(|(_, d)| d));
    c.store.refresh_universe();
    // `$terminate`: nothing is run, which is no failure.
    if parser.ending() != Ending::Regular {
        code.clear();
    }
    Ok(Program {
        symbols: c.symbols,
        store: c.store,
        equations: Arc::new(c.equations),
        code: Arc::new(code),
        shows_numbers: c.shows_numbers,
        slots: c.slots,
        unused_defines: parser.unused_defines(),
        map: parser.into_map(),
        diagnostics: c.diagnostics,
        asked_for_data: c.asked_for_data.get(),
    })
}

impl Compiler {
    fn new() -> Self {
        let mut store = Store::default();
        let table = store.add_table(1, 0.0);
        let mut symbols = Symbols::default();
        let universe = symbols.add(Symbol {
            name: "*".into(),
            kind: SymbolKind::Set { singleton: false },
            domain: vec![DomainPosition::Universe],
            text: "Universe".into(),
            declared: Span::default(),
            table,
            has_data: true,
            assigned: true,
            dynamic: false,
            is_domain: false,
            unordered: false,
            open: false,
        });
        debug_assert_eq!(universe, UNIVERSE);
        Self {
            symbols,
            store,
            ..Self::default()
        }
    }
}

impl Compiler {
    /// Takes memory for data, estimated from what they say: the same text ends at the same place
    /// everywhere.
    fn take(&mut self, records: usize, bytes: usize, span: Span) -> Checked<()> {
        self.taken = self.taken.saturating_add(records.saturating_mul(bytes));
        match self.max_memory {
            Some(limit) if self.taken > limit => Diagnostic::error("E0491", span)
                .says(format!("the memory limit of {} MB is used up", limit >> 20))
                .label("by the data up to here")
                .help("raise it with `--max-memory`, or make the set by an assignment with a condition")
                .fail(self),
            _ => Ok(()),
        }
    }

    /// `$clearError`: the first `count` errors are warnings from now on.
    fn clear_errors(&mut self, count: usize) {
        let errors = self.diagnostics.iter_mut();
        let errors = errors.filter(|d| d.severity == Severity::Error);
        errors
            .take(count)
            .for_each(|d| d.severity = Severity::Warning);
    }

    /// Notes that a symbol's data are read; an error if it never got any.
    fn used(&mut self, id: SymbolId, span: Span) {
        let root = self.symbols.root(id);
        let s = self.symbols.get(root);
        if self.modes.at(span).implicit_assign || s.has_data || s.assigned {
            return;
        }
        if self.in_equation {
            // They are needed when it is solved.
            if matches!(
                s.kind,
                SymbolKind::Set { .. } | SymbolKind::Parameter { .. }
            ) {
                self.reads.push((root, span));
            }
            return;
        }
        // A statement with an error may be the one that gives it values.
        let solved_for = s.has_attributes();
        let hides = |d: &Diagnostic| d.severity == Severity::Error && d.code != "E0319";
        if self.is_lost(&s.name) || solved_for && self.diagnostics.iter().any(hides) {
            return;
        }
        let (name, kind, declared) = (s.name.clone(), s.kind_name(), s.declared);
        // `p(i) price, in EUR / a 1 /`: the rest of the text is taken for the next name.
        let next = self.symbols.iter().nth(root as usize + 1).map(|(_, n)| n);
        let next = next.filter(|n| {
            let anywhere = |d: &DomainPosition| matches!(d, DomainPosition::Universe);
            !s.text.is_empty() && n.has_data && n.domain.iter().all(anywhere)
        });
        let next = next.map(|n| n.name.clone());
        let d = Diagnostic::error("E0319", span);
        let d = if solved_for {
            d.says(format!("the {kind} `{name}` has no values yet"))
                .label(follow::NOTHING_SOLVED)
                .other(declared, "declared here")
                .help(format!(
                    "solve a model with `{name}` first, or assign `{name}.l`"
                ))
        } else {
            let what = if kind == "set" { "elements" } else { "values" };
            let help = match (&s.kind, next) {
                (SymbolKind::Set { .. }, _) => {
                    format!("give it elements: `{name} / a, b /`, or `{name}(…) = yes;`")
                }
                (_, Some(next)) => format!(
                    "the data stand behind `{next}`: a comma ends a text without quotes; quote the text"
                ),
                (_, None) => format!("give it data: `{name} / … /`, or assign it before"),
            };
            d.says(format!("the {kind} `{name}` has no {what}"))
                .label("never assigned above")
                .other(declared, "declared without data here")
                .help(help)
        };
        d.report(self);
        // One such message per symbol.
        self.symbols.get_mut(root).assigned = true;
    }
}

impl Known for Compiler {
    fn errors(&self) -> usize {
        let errors = self.diagnostics.iter();
        errors.filter(|d| d.severity == Severity::Error).count()
    }

    fn set_text(&self, name: &str, what: &str) -> Option<String> {
        self.asked_for_data.set(true);
        let s = self
            .symbols
            .get(self.symbols.root(self.symbols.find(name)?));
        let what = what.to_lowercase();
        if what == "ts" {
            return Some(s.text.to_string());
        }
        let table = self.store.table(s.table);
        if !s.is_set() || table.is_empty() {
            return None;
        }
        let (record, what) = match what.strip_prefix("last") {
            Some(what) => (table.len() as u32 - 1, what),
            None => (0, what.strip_prefix("first").unwrap_or(&what)),
        };
        let key = table.key(record);
        match what {
            "tl" => {
                let labels = key.iter().map(|&l| self.store.universe.name(l));
                Some(labels.collect::<Vec<_>>().join("."))
            }
            "te" => {
                let texts = self.store.texts.get(&s.table);
                let text = texts.and_then(|t| t.get(key));
                Some(text.map(|t| t.to_string()).unwrap_or_default())
            }
            _ => None,
        }
    }

    fn in_data_file(
        &self,
        name: &str,
        read: ReadData<'_>,
    ) -> Result<Option<(&str, usize)>, String> {
        let (file, at) = self
            .input
            .as_ref()
            .ok_or("no file is open; write `$gdxIn data.gdx` before")?;
        let bytes = read(file, *at).map_err(|d| d.message.to_string())?;
        let gdx = crate::gdx::File::open(&bytes).map_err(|e| e.to_string())?;
        let symbol = gdx.find(name).map(|s| &gdx.symbols[s]);
        Ok(symbol.map(|s| (s.kind.name(), s.domain.len())))
    }

    fn put_open(&self) -> bool {
        self.put_named.is_some()
    }

    fn is_label(&self, text: &str) -> bool {
        self.store.universe.get(text).is_some()
    }

    fn is_function(&self, name: &str) -> bool {
        functions::callee(&name.to_lowercase()).is_some()
    }

    fn is_solver(&self, name: &str) -> bool {
        !matches!(self.solvers.check("lp", name), Err(Refused::Solver(..)))
    }

    fn function_value(&self, function: &str, arguments: &[f64]) -> Option<f64> {
        match (functions::callee(function)?, arguments) {
            ((Callee::Math(f), least, most), a) if (least..=most).contains(&a.len()) => {
                Some(function_value(f, a).unwrap_or(f64::NAN))
            }
            ((Callee::Data(DataFunction::JDate), ..), &[year, month, day]) => {
                calendar::jdate(year, month, day)
            }
            ((Callee::Data(DataFunction::Fact), ..), &[n]) => {
                (0.0..=170.0).contains(&n).then(|| factorial(n as u32))
            }
            ((Callee::Data(f), ..), &[day]) => calendar::part(f, day),
            _ => None,
        }
    }

    fn kind(&self, name: &str) -> Option<&'static str> {
        match self.symbols.find(name) {
            Some(s) => Some(self.symbols.get(s).kind_name()),
            None => predefined(name),
        }
    }

    fn is_defined(&self, name: &str) -> bool {
        let Some(s) = self.symbols.find(name) else {
            return predefined(name).is_some();
        };
        let s = self.symbols.get(s);
        s.has_data
            || s.assigned
            || matches!(s.kind, SymbolKind::Equation(Some(_)) | SymbolKind::Alias(_))
    }

    fn dimension(&self, name: &str) -> Option<usize> {
        match self.symbols.find(name) {
            Some(s) => Some(self.symbols.get(s).dim()),
            None => predefined(name).map(|_| 2),
        }
    }

    fn card(&self, name: &str) -> Option<usize> {
        self.asked_for_data.set(true);
        let s = self.symbols.get(self.symbols.find(name)?);
        match s.kind {
            SymbolKind::Set { .. } | SymbolKind::Alias(_) | SymbolKind::Parameter { .. } => {
                Some(self.store.table(s.table).len())
            }
            _ => None,
        }
    }

    fn scalar_value(&self, name: &str) -> Option<f64> {
        self.asked_for_data.set(true);
        let s = self.symbols.get(self.symbols.find(name)?);
        match s.kind {
            SymbolKind::Parameter { .. } if s.dim() == 0 => {
                Some(self.store.table(s.table).get(&[]))
            }
            _ => None,
        }
    }
}
