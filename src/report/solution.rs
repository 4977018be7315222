//! Everything about the solves of a run, as JSON (`--solution`): enough for a stranger to recompute
//! every residual and bound.
//!
//! Numbers are written with as many digits as identify them (17 at most), so reading them gives
//! the same numbers; infinities as `"+INF"` and `"-INF"`. The shape is documented in
//! `docs/json.md`.

use serde::{Serialize, Serializer, ser::SerializeSeq};

use super::json::{FORMAT, Number};
use super::names::Names;
use crate::model::instance::{Instance, Sense};
use crate::model::outcome::Outcome;
use crate::model::problem_type::ProblemType;

/// One solve: what was solved, and the answer.
pub struct Solved<'a> {
    /// The model.
    pub model: &'a str,
    /// The problem type.
    pub using: ProblemType,
    /// What was solved.
    pub instance: &'a Instance,
    /// The answer.
    pub outcome: &'a Outcome,
    /// Left side of each row at the levels, without its constant.
    pub activity: &'a [f64],
    /// Names of rows and columns.
    pub names: &'a dyn Names,
}

#[derive(Serialize)]
struct File<'a> {
    bmod: &'static str,
    format: u32,
    file: &'a str,
    solves: Vec<Solve<'a>>,
}

#[derive(Serialize)]
struct Solve<'a> {
    model: &'a str,
    using: &'a str,
    sense: Option<&'static str>,
    objective: Option<u32>,
    rows: Rows<'a>,
    columns: Columns<'a>,
    /// `[row, column, coefficient]`
    coefficients: Coefficients<'a>,
    /// Rows with terms that are not linear (their coefficients are not in the list).
    nonlinear_rows: Vec<u32>,
    /// `[row, column]`
    pairs: Vec<[u32; 2]>,
}

#[derive(Serialize)]
struct Line {
    symbol: String,
    labels: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    relation: Option<&'static str>,
    lower: Number,
    level: Number,
    upper: Number,
    marginal: Number,
}

struct Rows<'a>(&'a Solved<'a>);
struct Columns<'a>(&'a Solved<'a>);
struct Coefficients<'a>(&'a Instance);

impl Serialize for Rows<'_> {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        let rows = &self.0.instance.rows;
        let mut list = s.serialize_seq(Some(rows.rhs.len()))?;
        for (i, &rhs) in rows.rhs.iter().enumerate() {
            let (symbol, labels) = self.0.names.row_parts(i);
            let [lower, upper] = rows.relation[i].bounds(rhs);
            list.serialize_element(&Line {
                symbol,
                labels,
                relation: Some(rows.relation[i].sign()),
                lower: Number(lower),
                level: Number(self.0.activity[i]),
                upper: Number(upper),
                marginal: Number(self.0.outcome.row_marginal[i]),
            })?;
        }
        list.end()
    }
}

impl Serialize for Columns<'_> {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        let columns = &self.0.instance.columns;
        let mut list = s.serialize_seq(Some(columns.lower.len()))?;
        for j in 0..columns.lower.len() {
            let (symbol, labels) = self.0.names.column_parts(j);
            list.serialize_element(&Line {
                symbol,
                labels,
                relation: None,
                lower: Number(columns.lower[j]),
                level: Number(self.0.outcome.level[j]),
                upper: Number(columns.upper[j]),
                marginal: Number(self.0.outcome.column_marginal[j]),
            })?;
        }
        list.end()
    }
}

impl Serialize for Coefficients<'_> {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        let mut list = s.serialize_seq(Some(self.0.matrix.value.len()))?;
        for i in 0..self.0.row_count() {
            for (j, a) in self.0.matrix.row(i) {
                list.serialize_element(&(i, j, Number(a)))?;
            }
        }
        list.end()
    }
}

/// The solves of a run as JSON.
pub fn to_json(file: &str, solves: &[Solved<'_>]) -> String {
    let solves = solves.iter().map(|solved| {
        let instance = solved.instance;
        let is_nonlinear = instance.nonlinear_rows();
        let rows = 0..instance.row_count() as u32;
        let nonlinear_rows = rows.filter(|&i| is_nonlinear[i as usize]).collect();
        let matched = instance.matched.iter().flatten().enumerate();
        Solve {
            model: solved.model,
            using: solved.using.name(),
            sense: instance.objective.map(|o| match o.sense {
                Sense::Minimize => "min",
                Sense::Maximize => "max",
            }),
            objective: instance.objective.map(|o| o.column),
            rows: Rows(solved),
            columns: Columns(solved),
            coefficients: Coefficients(instance),
            nonlinear_rows,
            pairs: matched
                .filter_map(|(j, row)| row.map(|i| [i, j as u32]))
                .collect(),
        }
    });
    let file = File {
        bmod: env!("CARGO_PKG_VERSION"),
        format: FORMAT,
        file,
        solves: solves.collect(),
    };
    // Texts and numbers only: this cannot fail.
    let mut text = serde_json::to_string(&file).unwrap_or_default();
    text.push('\n');
    text
}
