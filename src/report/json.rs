//! The report of a run, as `--json` writes it. Documented in `docs/json.md`.

use serde::Serialize;

/// A code of GAMS's and its name.
#[derive(Clone, Serialize, Debug)]
pub struct Status {
    /// GAMS's number.
    pub code: u8,
    /// GAMS's words, lower case.
    pub name: &'static str,
}

/// Wall-clock seconds of a solve.
#[derive(Clone, Copy, Default, Serialize, Debug)]
pub struct Seconds {
    /// Generating the instance.
    pub generate: f64,
    /// In the solver.
    pub solve: f64,
    /// Both, and the certificate.
    pub total: f64,
}

/// Largest violations on the unscaled model; null where one does not apply.
#[derive(Clone, Copy, Default, Serialize, Debug)]
pub struct Residual {
    /// Of a row or bound.
    pub primal: Option<f64>,
    /// Of stationarity and the signs of marginals.
    pub dual: Option<f64>,
    /// max |yᵢzᵢ|; for mpec over the pairs.
    pub complementarity: Option<f64>,
    /// max |x − mid(l, u, x − F)|, for mcp.
    pub natural: Option<f64>,
}

/// One solve.
#[derive(Clone, Serialize, Debug)]
pub struct Solve {
    /// Name of the model.
    pub model: String,
    /// Problem type.
    pub using: &'static str,
    /// `min`, `max`, or null for mcp and cns.
    pub sense: Option<&'static str>,
    /// The solver that ran.
    pub solver: String,
    /// What is known of the answer.
    pub model_status: Status,
    /// How the solver ended.
    pub solver_status: Status,
    /// Level of the objective variable; null for mcp and cns.
    pub objective: Option<f64>,
    /// As GAMS counts, the objective's row and column included.
    pub rows: usize,
    /// Columns.
    pub columns: usize,
    /// Nonzeros.
    pub nonzeros: usize,
    /// Nonzeros whose column stands in a nonlinear term of the row.
    pub nonlinear_nonzeros: usize,
    /// Iterations of the solver.
    pub iterations: u64,
    /// Times.
    pub seconds: Seconds,
    /// The certificate.
    pub residual: Residual,
    /// Σ |yᵢzᵢ| over the pairs, for mpec.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub complementarity_sum: Option<f64>,
    /// Proved interval of the optimal value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<[f64; 2]>,
    /// B-stationarity of an mpec: `proved`, `refuted`, `not proved`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stationarity: Option<&'static str>,
    /// More for the person, where there is more to say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Line of the solve statement.
    pub line: usize,
    /// Name of the row or column with the largest violation, where it matters.
    #[serde(skip)]
    pub worst: Option<String>,
}

/// A number, or the name of a special value.
#[derive(Clone, Serialize, Debug, PartialEq)]
#[serde(untagged)]
pub enum Value {
    /// An ordinary number.
    Number(f64),
    /// `eps`, `na`, `inf`, `-inf`, `undf`, or an acronym.
    Special(String),
}

/// One displayed symbol.
#[derive(Clone, Serialize, Debug)]
pub struct Display {
    /// Line of the display statement.
    pub line: usize,
    /// Symbol with attribute, `x.l`.
    pub symbol: String,
    /// Value of a scalar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<Value>,
    /// Index sets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub domain: Option<Vec<String>>,
    /// Labels and value of each record.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub records: Option<Vec<(Vec<String>, Value)>>,
}

/// What a run reports while it runs; the command line adds file, status and diagnostics.
#[derive(Clone, Default, Serialize, Debug)]
pub struct Report {
    /// Solves in order.
    pub solves: Vec<Solve>,
    /// Displays in order.
    pub displays: Vec<Display>,
    /// Files written, in order.
    pub files: Vec<String>,
}
