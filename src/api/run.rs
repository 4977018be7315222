//! What came of a run.

use super::symbols::{Data, Symbol};
use super::{Error, Labels};
use crate::check::Program;
use crate::diag;
use crate::model::instance::Sense;
use crate::model::problem_type::ProblemType;
use crate::report::diagnostic::{Diagnostic, Severity};
use crate::report::diagnostics::{self, Look};
use crate::report::json::{Display, Report, Residual, RunStatus, Seconds, SolveReport};
use crate::session::Finished;
use crate::solve::{ModelStatus, SolverStatus};
use crate::source::SourceMap;

/// What came of a run: solves, data by name and labels, texts and pictures, diagnostics.
///
/// ```
/// use bmod::{Model, ModelStatus, Options};
///
/// let model = Model::from_text(
///     "m.blk",
///     "Set i / a, b /;  Positive variable x(i);  Variable z;
///      Parameter price(i) / a 3, b 5 /;
///      Equations value, most(i), room;
///      value..    z =e= sum(i, price(i)*x(i));
///      most(i)..  x(i) =l= 4;
///      room..     sum(i, x(i)) =l= 6;
///      Model shop / all /;  solve shop using lp maximizing z;",
/// );
/// let run = model.run(&Options::default()).ok()?;
///
/// let solve = &run.solves()[0];
/// assert_eq!(solve.model_status, ModelStatus::Optimal);
/// assert_eq!(solve.objective, Some(26.0));
/// assert_eq!(run.level("x", "b")?, 4.0);
/// assert_eq!(run.marginal("room", [])?, 3.0);
/// for x in run.symbol("x")?.variable_records() {
///     println!("{:?} {} (at most {})", x.labels, x.level, x.upper);
/// }
/// # Ok::<(), bmod::Error>(())
/// ```
#[derive(Debug)]
pub struct Run {
    status: RunStatus,
    solves: Vec<Solve>,
    diagnostics: Vec<Diagnostic>,
    messages: String,
    printed: String,
    files: Vec<OutputFile>,
    data: Data,
    report: Report,
    solution: Option<String>,
    stopped: bool,
    claims: Vec<Claim>,
    reads: String,
    unused_defines: Vec<String>,
}

/// What a comment of the text claims about the run: `*= total.l 285`.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// Its line in the text, from 1.
    pub line: usize,
    /// What it is about: `total.l`, `x.l('a')`, `m.modelstat`.
    pub what: String,
    /// The value that it claims.
    pub value: String,
    /// Whether it holds.
    pub holds: bool,
    /// The value that is there, if it does not.
    pub found: Option<String>,
}

/// A file that a model wrote: a figure, a `put` file, data. Nothing is written to disk.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputFile {
    /// Its name, relative, with `/` between folders.
    pub name: String,
    /// What is in it.
    pub bytes: Vec<u8>,
}

impl OutputFile {
    /// Its text; `None` for a picture in PNG.
    pub fn text(&self) -> Option<&str> {
        std::str::from_utf8(&self.bytes).ok()
    }

    /// Whether it is a figure in SVG.
    pub fn is_svg(&self) -> bool {
        let ending = self.name.rsplit_once('.').map(|n| n.1);
        ending.is_some_and(|e| e.eq_ignore_ascii_case("svg"))
    }
}

/// One solve of a run.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Solve {
    /// The model.
    pub model: String,
    /// The problem type.
    pub using: ProblemType,
    /// The direction, none for a model without objective.
    pub sense: Option<Sense>,
    /// The solver that ran.
    pub solver: String,
    /// What the point proves.
    pub model_status: ModelStatus,
    /// How the solver ended.
    pub solver_status: SolverStatus,
    /// The objective variable.
    pub objective_variable: Option<String>,
    /// Its level.
    pub objective: Option<f64>,
    /// A proved interval for the optimal value ([`super::Options::certify`]).
    pub bounds: Option<[f64; 2]>,
    /// Rows, the objective's included.
    pub rows: usize,
    /// Columns, the objective variable included.
    pub columns: usize,
    /// Entries of the rows.
    pub nonzeros: usize,
    /// Nonlinear ones among them.
    pub nonlinear_nonzeros: usize,
    /// Iterations of the solver.
    pub iterations: u64,
    /// Times.
    pub seconds: Seconds,
    /// Largest violations on the unscaled model.
    pub residuals: Residual,
    /// Sum of the violations of complementarity (mpec).
    pub complementarity_sum: Option<f64>,
    /// `proved`, `refuted` or `not proved` (mpec).
    pub stationarity: Option<&'static str>,
    /// What else the solver has to say.
    pub message: Option<String>,
    /// Why it ended so, a list of paragraphs ([`super::Options::explain`]).
    pub explanation: Vec<String>,
}

impl Solve {
    fn new(s: &SolveReport) -> Self {
        Self {
            model: s.model.clone(),
            using: s.using,
            sense: s.sense,
            solver: s.solver.clone(),
            model_status: s.model_status.status,
            solver_status: s.solver_status.status,
            objective_variable: s.objective_name.clone(),
            objective: s.objective.map(|v| v.0),
            bounds: s.bounds.map(|b| b.map(|v| v.0)),
            rows: s.rows,
            columns: s.columns,
            nonzeros: s.nonzeros,
            nonlinear_nonzeros: s.nonlinear_nonzeros,
            iterations: s.iterations,
            seconds: s.seconds,
            residuals: s.residual,
            complementarity_sum: s.complementarity_sum,
            stationarity: s.stationarity,
            message: s.message.clone(),
            explanation: s.why.as_ref().map_or_else(Vec::new, |w| w.text.clone()),
        }
    }
}

/// What the machine leaves.
#[derive(Default)]
pub(super) struct Ended {
    pub data: Data,
    pub solution: Option<String>,
    pub stopped: bool,
    pub claims: Vec<Claim>,
}

/// What is said after a panic: a bug of bmod.
pub(super) fn broken() -> diag::Diagnostic {
    diag::Diagnostic::execution("E0499", crate::source::Span::default())
        .says("something went wrong inside bmod; this is a bug in bmod, not in the model")
        .help("please report it with the model that caused it")
}

impl Run {
    fn new(name: &str, status: RunStatus, found: &[diag::Diagnostic], map: &SourceMap) -> Self {
        let diagnostics = Diagnostic::all(found, map);
        Self {
            status,
            solves: Vec::new(),
            messages: diagnostics::render(found, map, Look::plain()),
            printed: String::new(),
            files: Vec::new(),
            data: Data::default(),
            report: Report {
                status,
                diagnostics: diagnostics.clone(),
                ..Report::new(name)
            },
            diagnostics,
            solution: None,
            stopped: false,
            claims: Vec::new(),
            reads: String::new(),
            unused_defines: Vec::new(),
        }
    }

    pub(super) fn checked(name: &str, program: Program) -> Self {
        let status = match program.has_errors() {
            true => RunStatus::CompilationError,
            false => RunStatus::Ok,
        };
        Self {
            data: Data::new(&program.symbols, program.store),
            unused_defines: program.unused_defines,
            ..Self::new(name, status, &program.diagnostics, &program.map)
        }
    }

    pub(super) fn unreadable(name: &str, found: diag::Diagnostic, map: SourceMap) -> Self {
        Self::new(name, RunStatus::CompilationError, &[found], &map)
    }

    /// After a panic.
    pub(super) fn broken(name: &str) -> Self {
        let none = SourceMap::default();
        Self::new(name, RunStatus::ExecutionError, &[broken()], &none)
    }

    pub(super) fn finished(name: &str, finished: Finished, ended: Ended) -> Self {
        let mut run = Self::new(name, finished.end, &finished.diagnostics, &finished.map);
        run.solves = finished.report.solves.iter().map(Solve::new).collect();
        run.report = Report {
            status: run.report.status,
            diagnostics: run.report.diagnostics,
            ..finished.report.of(name)
        };
        Self {
            data: ended.data,
            solution: ended.solution,
            stopped: ended.stopped,
            claims: ended.claims,
            ..run
        }
    }

    pub(super) fn take_output(&mut self, files: Vec<OutputFile>, printed: String, reads: String) {
        (self.files, self.printed, self.reads) = (files, printed, reads);
    }

    /// The files that the run read, and digests of what is in them: a text for [`Model::still_reads`](crate::Model::still_reads).
    /// Of a model that [keeps](crate::Model::keep) its text only those that were read behind its compilation.
    pub fn reads(&self) -> &str {
        &self.reads
    }

    /// After [`Model::check`](crate::Model::check): the names that were [defined](crate::Model::define) for nothing, in small
    /// letters; the text never asks for them.
    pub fn unused_defines(&self) -> &[String] {
        &self.unused_defines
    }

    /// How the run ended.
    pub fn status(&self) -> RunStatus {
        self.status
    }

    /// Whether it compiled and ran without errors. A solve may still have ended without a solution: see
    /// [`Solve::model_status`].
    pub fn succeeded(&self) -> bool {
        self.status == RunStatus::Ok
    }

    /// Whether a limit or [`super::Control::cancel`] stopped it.
    pub fn was_stopped(&self) -> bool {
        self.stopped
    }

    /// The run itself if it [succeeded](Run::succeeded).
    ///
    /// # Errors
    /// [`Error::Model`] with all diagnostics otherwise.
    ///
    /// ```
    /// use bmod::{Model, Options};
    ///
    /// let run = Model::from_text("m.blk", "Scalar a;\na = b + 1;").run(&Options::default());
    /// let error = run.ok().expect_err("there is no b");
    /// assert!(error.to_string().contains("m.blk:2:5"), "{error}");
    /// ```
    pub fn ok(self) -> Result<Self, Error> {
        match self.succeeded() {
            true => Ok(self),
            false => Err(Error::Model {
                diagnostics: self.diagnostics,
                messages: self.messages,
            }),
        }
    }

    /// The solves, in order.
    pub fn solves(&self) -> &[Solve] {
        &self.solves
    }

    /// Errors and warnings in the order in which they came up.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Only the errors.
    pub fn errors(&self) -> impl Iterator<Item = &Diagnostic> {
        let is_error = |d: &&Diagnostic| d.severity != Severity::Warning;
        self.diagnostics.iter().filter(is_error)
    }

    /// The diagnostics as text, with the lines of the source.
    pub fn messages(&self) -> &str {
        &self.messages
    }

    /// What the model printed: displays, summaries of solves.
    pub fn printed(&self) -> &str {
        &self.printed
    }

    /// What `display` showed, in order.
    pub fn displays(&self) -> &[Display] {
        &self.report.displays
    }

    /// The files that the model wrote, in order.
    pub fn files(&self) -> &[OutputFile] {
        &self.files
    }

    /// The figures that it drew: names and SVG texts.
    pub fn figures(&self) -> impl Iterator<Item = (&str, &str)> {
        let pictures = self.files.iter().filter(|f| f.is_svg());
        pictures.filter_map(|f| Some((&*f.name, f.text()?)))
    }

    /// What the comments of the text claim, and whether it is so; with [`super::Options::claims`]. Empty if the text
    /// does not compile.
    pub fn claims(&self) -> &[Claim] {
        &self.claims
    }

    /// All symbols in order of declaration.
    pub fn symbols(&self) -> impl Iterator<Item = Symbol<'_>> {
        self.data.symbols()
    }

    /// The symbol of this name, in any case.
    ///
    /// # Errors
    /// [`Error::UnknownSymbol`]
    pub fn symbol(&self, name: &str) -> Result<Symbol<'_>, Error> {
        self.data.symbol(name)
    }

    /// A value of a parameter or set: [`Symbol::value`].
    ///
    /// # Errors
    /// If there is no such symbol, it has no values, or the labels do not fit. So for the next four.
    pub fn value(&self, name: &str, labels: impl Labels) -> Result<f64, Error> {
        self.symbol(name)?.value(labels)
    }

    /// Level of a variable or an equation.
    pub fn level(&self, name: &str, labels: impl Labels) -> Result<f64, Error> {
        self.symbol(name)?.level(labels)
    }

    /// Marginal of a variable (reduced cost) or an equation (dual value).
    pub fn marginal(&self, name: &str, labels: impl Labels) -> Result<f64, Error> {
        self.symbol(name)?.marginal(labels)
    }

    /// Lower bound of a variable or an equation.
    pub fn lower(&self, name: &str, labels: impl Labels) -> Result<f64, Error> {
        self.symbol(name)?.lower(labels)
    }

    /// Upper bound of a variable or an equation.
    pub fn upper(&self, name: &str, labels: impl Labels) -> Result<f64, Error> {
        self.symbol(name)?.upper(labels)
    }

    /// The report that `bmod run --json` writes (`docs/json.md`).
    pub fn to_json(&self) -> String {
        self.report.to_json()
    }

    /// Instances and solutions of all solves, as `bmod run --solution` writes them; with
    /// [`super::Options::keep_solutions`].
    pub fn solution_json(&self) -> Option<&str> {
        self.solution.as_deref()
    }
}
