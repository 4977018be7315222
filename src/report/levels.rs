//! Levels and marginals after a solve, for a text that displays nothing itself.

use std::fmt::Write;

use super::names::Names;
use super::summary::digits;
use crate::model::instance::Instance;

/// How many members of a symbol a short table shows.
const SHORT: usize = 10;

/// The numbers of a solution, one value per column or row.
pub struct Values<'a> {
    /// Level of each column.
    pub column_level: &'a [f64],
    /// Reduced cost of each column.
    pub column_marginal: &'a [f64],
    /// Level of each row: its left side.
    pub row_level: &'a [f64],
    /// Marginal of each row.
    pub row_marginal: &'a [f64],
}

/// A member of a symbol: its name, level and marginal.
struct Line {
    name: String,
    level: f64,
    marginal: f64,
}

/// Two tables, of variables and of equations. The short form leaves out columns where level and marginal are 0, rows
/// whose marginal is 0, and what is beyond the first few of a symbol; it says how many those are. The
/// objective variable is left out: the summary shows it.
pub fn levels(instance: &Instance, names: &dyn Names, values: &Values, all: bool) -> String {
    let objective = instance.objective.map(|o| o.column as usize);
    let columns = (0..instance.column_count()).filter(|j| Some(*j) != objective);
    let column = |j: usize| Line {
        name: String::new(),
        level: values.column_level[j],
        marginal: values.column_marginal[j],
    };
    let row = |i: usize| Line {
        name: String::new(),
        level: values.row_level[i],
        marginal: values.row_marginal[i],
    };
    let mut out = String::new();
    let is_shown = |l: &Line| all || l.level != 0.0 || l.marginal != 0.0;
    let of_columns = columns.map(|j| (names.column_parts(j).0, j, column(j)));
    table(
        &mut out,
        "variable",
        of_columns,
        is_shown,
        &|j| names.column(j),
        all,
    );
    // The row that defines the objective has the marginal 1: nothing to read there.
    let defines = |i: usize| instance.matrix.row(i).any(|(j, _)| Some(j) == objective);
    let rows = (0..instance.row_count()).filter(|&i| all || !defines(i));
    let of_rows = rows.map(|i| (names.row_parts(i).0, i, row(i)));
    let is_shown = |l: &Line| all || l.marginal != 0.0;
    table(
        &mut out,
        "equation",
        of_rows,
        is_shown,
        &|i| names.row(i),
        all,
    );
    out
}

fn table(
    out: &mut String,
    heading: &str,
    members: impl Iterator<Item = (String, usize, Line)>,
    is_shown: impl Fn(&Line) -> bool,
    name: &dyn Fn(usize) -> String,
    all: bool,
) {
    let mut lines: Vec<Line> = Vec::new();
    let (mut symbol, mut of_symbol, mut left_out) = (String::new(), 0, 0);
    for (s, k, line) in members {
        if s != symbol {
            (symbol, of_symbol) = (s, 0);
        }
        if !is_shown(&line) || of_symbol >= SHORT && !all {
            left_out += 1;
            continue;
        }
        of_symbol += 1;
        lines.push(Line {
            name: name(k),
            ..line
        });
    }
    if lines.is_empty() {
        return;
    }
    let text: Vec<[String; 3]> = lines
        .into_iter()
        .map(|l| [l.name, digits(l.level), digits(l.marginal)])
        .collect();
    let width = |c: usize, least: &str| {
        let longest = text.iter().map(|l| l[c].chars().count()).max();
        longest.unwrap_or(0).max(least.len())
    };
    let (n, l, m) = (width(0, heading), width(1, "level"), width(2, "marginal"));
    let _ = writeln!(
        out,
        "    {heading:<n$}  {:>l$}  {:>m$}",
        "level", "marginal"
    );
    for [name, level, marginal] in text {
        let _ = writeln!(out, "    {name:<n$}  {level:>l$}  {marginal:>m$}");
    }
    if left_out > 0 {
        let _ = writeln!(out, "    … {left_out} more: `--all` shows them");
    }
}
