//! The report of a run as JSON (`--json`). The shape is documented in `docs/json.md`; a change of
//! it that can break a reader changes [`FORMAT`].
//!
//! JSON has no infinities and no special values: they are written as the texts `"+INF"`, `"-INF"`,
//! `"EPS"`, `"NA"`, `"UNDF"`.

use serde::{Serialize, Serializer};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::diagnostic::Diagnostic;
use crate::data::value;
use crate::model::instance::Sense;
use crate::model::outcome::{ModelStatus, SolverStatus};
use crate::model::problem_type::ProblemType;
use crate::solve::certificate::Residuals;

/// Number of the report's format.
pub const FORMAT: u32 = 1;

/// A number as the language has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number(pub f64);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        match value::special_text(self.0, &[]) {
            Some(name) => s.serialize_str(name),
            None => s.serialize_f64(self.0 + 0.0),
        }
    }
}

/// The whole report.
#[derive(Clone, Debug, Serialize, Default)]
pub struct Report {
    /// Version of bmod.
    pub bmod: String,
    /// Number of the format: [`FORMAT`].
    pub format: u32,
    /// The model, as it was given.
    pub file: String,
    /// How the run ended.
    pub status: RunStatus,
    /// The solves, in order.
    pub solves: Vec<SolveReport>,
    /// What `display` showed, in order.
    pub displays: Vec<Display>,
    /// Files written: figures, put files, data.
    pub files: Vec<String>,
    /// Those among them that were still being written when the run was stopped.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub partial: Vec<String>,
    /// What was wrong.
    pub diagnostics: Vec<Diagnostic>,
    /// The solve that runs just now. Not in the JSON.
    #[serde(skip)]
    pub solving: Option<SolveReport>,
}

/// The report of a run that goes on: another thread may read it.
#[derive(Clone, Debug, Default)]
pub struct SharedReport(Arc<Mutex<Report>>);

impl SharedReport {
    /// The report, for as long as it is held.
    pub fn get(&self) -> MutexGuard<'_, Report> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, Serialize, Default, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum RunStatus {
    /// Exit status 0.
    #[default]
    Ok,
    /// Exit status 2: the text does not compile.
    CompilationError,
    /// Exit status 3: an execution error.
    ExecutionError,
    /// Exit status 3: an `abort` statement.
    Aborted,
    /// Exit status 130: Ctrl-C, or the system asked for the end (SIGTERM).
    Interrupted,
}

impl RunStatus {
    /// The exit status of the program.
    pub fn exit(self) -> u8 {
        match self {
            Self::Ok => 0,
            Self::CompilationError => 2,
            Self::ExecutionError | Self::Aborted => 3,
            Self::Interrupted => 130,
        }
    }
}

/// A status with GAMS's code.
#[derive(Clone, Copy, Debug, Serialize, PartialEq)]
pub struct Status<S> {
    /// The status itself. Not in the JSON.
    #[serde(skip)]
    pub status: S,
    /// GAMS's number.
    pub code: u8,
    /// GAMS's words, lower case.
    pub name: &'static str,
}

macro_rules! statuses {
    ($($of:ty),*) => {$(
        impl From<$of> for Status<$of> {
            fn from(status: $of) -> Self {
                let (code, name) = (status as u8, status.name());
                Self { status, code, name }
            }
        }
    )*};
}

statuses!(ModelStatus, SolverStatus);

/// A search over discrete columns.
#[derive(Clone, Debug, Serialize)]
pub struct Search {
    /// No solution is better than this; null where nothing of the kind is known.
    pub bound: Option<Number>,
    /// Distance of objective and bound, relative to the objective; null without both.
    pub gap: Option<Number>,
    /// Nodes solved.
    pub nodes: u64,
    /// The tree: node 0 is the root.
    pub tree: Vec<TreeNode>,
    /// How many nodes the list leaves out: it ends after 100 000.
    pub left_out: usize,
}

/// A node of a search tree.
#[derive(Clone, Debug, Serialize)]
pub struct TreeNode {
    /// Number of the parent; null for the root.
    pub parent: Option<u32>,
    /// The column whose bounds make the node (the first, where an ordered set was split).
    pub column: Option<String>,
    /// Its bounds.
    pub bounds: Option<[Number; 2]>,
    /// Value of the relaxation.
    pub value: Number,
    /// `branched`, `infeasible`, `bound`, `solution` or `open`.
    pub fate: &'static str,
    /// Value of the best solution that was found here, by the relaxation or a heuristic; null where none was.
    pub solution: Option<Number>,
}

/// One solve.
#[derive(Clone, Debug, Serialize)]
pub struct SolveReport {
    /// The model.
    pub model: String,
    /// `lp`, `mcp` …
    pub using: ProblemType,
    /// `min`, `max`, or null for a model without objective.
    pub sense: Option<Sense>,
    /// The objective variable, null for a model without one. Not in the JSON.
    #[serde(skip)]
    pub objective_name: Option<String>,
    /// The solver that ran.
    pub solver: String,
    /// What the point and the rays prove.
    pub model_status: Status<ModelStatus>,
    /// How the solver ended.
    pub solver_status: Status<SolverStatus>,
    /// Level of the objective variable.
    pub objective: Option<Number>,
    /// Rows, the objective's included.
    pub rows: usize,
    /// Columns, the objective variable included.
    pub columns: usize,
    /// Entries of the rows.
    pub nonzeros: usize,
    /// Nonlinear ones among them.
    pub nonlinear_nonzeros: usize,
    /// Iterations.
    pub iterations: u64,
    /// Times.
    pub seconds: Seconds,
    /// Largest violations on the unscaled model.
    pub residual: Residual,
    /// Of a search over discrete columns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub search: Option<Search>,
    /// Sum of the violations of complementarity (mpec).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub complementarity_sum: Option<f64>,
    /// A proved interval for the optimal value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<[Number; 2]>,
    /// `proved`, `refuted` or `not proved` (mpec).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stationarity: Option<&'static str>,
    /// One more line from the solver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// What the reader can do about it, for the terminal. Not in the JSON.
    #[serde(skip)]
    pub hint: Option<String>,
    /// Why it ended so (`bmod why`).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<super::why::Explanation>,
}

impl SolveReport {
    /// Of a model that was not solved.
    pub fn new(model: &str, using: ProblemType) -> Self {
        Self {
            model: model.into(),
            using,
            sense: None,
            objective_name: None,
            solver: String::new(),
            model_status: ModelStatus::NoSolution.into(),
            solver_status: SolverStatus::NormalCompletion.into(),
            objective: None,
            rows: 0,
            columns: 0,
            nonzeros: 0,
            nonlinear_nonzeros: 0,
            iterations: 0,
            seconds: Seconds::default(),
            residual: Residual::default(),
            complementarity_sum: None,
            bounds: None,
            search: None,
            stationarity: None,
            message: None,
            hint: None,
            why: None,
        }
    }
}

/// Times of a solve, in seconds.
#[derive(Clone, Copy, Debug, Serialize, Default)]
pub struct Seconds {
    /// Generating the rows and columns.
    pub generate: f64,
    /// Solving.
    pub solve: f64,
    /// Everything.
    pub total: f64,
}

/// Largest violations, null where one does not apply.
#[derive(Clone, Copy, Debug, Serialize, Default)]
pub struct Residual {
    /// Of a row or a bound.
    pub primal: Option<f64>,
    /// Wrong-signed multipliers.
    pub dual: Option<f64>,
    /// max |yᵢzᵢ|
    pub complementarity: Option<f64>,
    /// max |x − mid(l, u, x − F)|
    pub natural: Option<f64>,
}

impl From<&Residuals> for Residual {
    fn from(r: &Residuals) -> Self {
        let finite = |v: Option<f64>| v.filter(|v| v.is_finite());
        Self {
            primal: finite(r.primal),
            dual: finite(r.dual),
            complementarity: finite(r.complementarity),
            natural: finite(r.natural),
        }
    }
}

/// One item of a `display`.
#[derive(Clone, Debug, Serialize, PartialEq)]
#[serde(untagged)]
pub enum Display {
    /// A text.
    Text {
        /// Line of the statement.
        line: usize,
        /// The text.
        text: String,
    },
    /// A symbol without indices.
    Scalar {
        /// Line of the statement.
        line: usize,
        /// The symbol, perhaps with its attribute: `alpha.l`.
        symbol: String,
        /// Its value.
        value: Number,
    },
    /// A symbol with indices.
    Indexed {
        /// Line of the statement.
        line: usize,
        /// The symbol, perhaps with its attribute: `x.l`.
        symbol: String,
        /// Its index sets.
        domain: Vec<String>,
        /// Labels and value of each record; for a set the value is 1.
        records: Vec<(Vec<String>, Number)>,
    },
}

/// Records of displays in the report of a run that a limit ended: as many as are written in a quarter of a second.
const MAX_RECORDS_AFTER_LIMIT: usize = 100_000;

impl Report {
    /// An empty report.
    pub fn new(file: &str) -> Self {
        Self::default().of(file)
    }

    /// The report of this model.
    pub fn of(self, file: &str) -> Self {
        Self {
            bmod: env!("CARGO_PKG_VERSION").into(),
            format: FORMAT,
            file: file.into(),
            ..self
        }
    }

    /// Leaves out the displays that take too long to write after a limit; in words how many, or nothing.
    pub fn shorten(&mut self) -> String {
        let mut records = 0;
        let fits = self.displays.iter().take_while(|d| {
            records += match d {
                Display::Indexed { records, .. } => 1 + records.len(),
                Display::Text { .. } | Display::Scalar { .. } => 1,
            };
            records <= MAX_RECORDS_AFTER_LIMIT
        });
        let rest = self.displays.split_off(fits.count());
        let left_out = rest.len();
        // to free millions of labels takes as long as to write them, and the process ends soon
        std::mem::forget(rest);
        match left_out {
            0 => String::new(),
            n => format!("; its last {n} displays are left out"),
        }
    }

    /// The report as indented JSON with a line end.
    pub fn to_json(&self) -> String {
        // Texts and numbers only: this cannot fail.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }
}
