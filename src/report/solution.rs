//! Everything about the solves of a run, as JSON (`--solution`): enough for a stranger to recompute
//! every residual and bound.
//!
//! Numbers are written with as many digits as identify them (17 at most), so reading them gives
//! the same numbers; infinities as `"+INF"` and `"-INF"`. The shape is documented in
//! `docs/json.md`.

use serde::Serialize;

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
    sense: Option<Sense>,
    objective: Option<u32>,
    rows: Vec<Line>,
    columns: Vec<Line>,
    /// `[row, column, coefficient]`
    coefficients: Vec<(usize, usize, Number)>,
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

/// The rows of a solve.
fn rows(solved: &Solved) -> Vec<Line> {
    let rows = &solved.instance.rows;
    let row = |i: usize| {
        let (symbol, labels) = solved.names.row_parts(i);
        let [lower, upper] = rows.relation[i].bounds(rows.rhs[i]);
        Line {
            symbol,
            labels,
            relation: Some(rows.relation[i].name()),
            lower: Number(lower),
            level: Number(solved.activity[i]),
            upper: Number(upper),
            marginal: Number(solved.outcome.row_marginal[i]),
        }
    };
    (0..rows.rhs.len()).map(row).collect()
}

/// The columns of a solve.
fn columns(solved: &Solved) -> Vec<Line> {
    let columns = &solved.instance.columns;
    let column = |j: usize| {
        let (symbol, labels) = solved.names.column_parts(j);
        Line {
            symbol,
            labels,
            relation: None,
            lower: Number(columns.lower[j]),
            level: Number(solved.outcome.level[j]),
            upper: Number(columns.upper[j]),
            marginal: Number(solved.outcome.column_marginal[j]),
        }
    };
    (0..columns.lower.len()).map(column).collect()
}

/// The solves of a run as JSON.
pub fn to_json(file: &str, solves: &[Solved<'_>]) -> String {
    let solves = solves.iter().map(|solved| {
        let instance = solved.instance;
        let is_nonlinear = instance.nonlinear_rows();
        let all = 0..instance.row_count();
        let nonlinear = all.clone().filter(|&i| is_nonlinear[i]);
        let coefficients =
            all.flat_map(|i| instance.matrix.row(i).map(move |(j, a)| (i, j, Number(a))));
        let matched = instance.matched.iter().flatten().enumerate();
        Solve {
            model: solved.model,
            using: solved.using.name(),
            sense: instance.objective.map(|o| o.sense),
            objective: instance.objective.map(|o| o.column),
            rows: rows(solved),
            columns: columns(solved),
            coefficients: coefficients.collect(),
            nonlinear_rows: nonlinear.map(|i| i as u32).collect(),
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
