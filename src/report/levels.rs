//! Levels and marginals after a solve, for a text that displays nothing itself.

use std::fmt::Write;

use super::names::{Names, join};
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

/// Two tables, of variables and of equations. The short form leaves out columns where level and marginal are 0, rows
/// whose marginal is 0, and what is beyond the first few of a symbol; it says how many those are. The
/// objective variable is left out: the summary shows it.
pub fn levels(instance: &Instance, names: &dyn Names, values: &Values, all: bool) -> String {
    let objective = instance.objective.map(|o| o.column as usize);
    let columns = (0..instance.column_count()).filter(|j| Some(*j) != objective);
    let columns = columns.map(|j| {
        let of = (values.column_level[j], values.column_marginal[j]);
        (names.column_parts(j), of)
    });
    // The row that defines the objective has the marginal 1: nothing to read there.
    let defines = |i: usize| instance.matrix.row(i).any(|(j, _)| Some(j) == objective);
    let rows = (0..instance.row_count()).filter(|&i| all || !defines(i));
    let rows = rows.map(|i| {
        let of = (values.row_level[i], values.row_marginal[i]);
        (names.row_parts(i), of)
    });
    let mut out = String::new();
    table(&mut out, "variable", columns, |of| of != (0.0, 0.0), all);
    table(&mut out, "equation", rows, |of| of.1 != 0.0, all);
    out
}

/// A table of members, which are symbol and labels, level and marginal.
fn table(
    out: &mut String,
    heading: &str,
    members: impl Iterator<Item = ((String, Vec<String>), (f64, f64))>,
    says_something: impl Fn((f64, f64)) -> bool,
    all: bool,
) {
    let mut text: Vec<[String; 3]> = Vec::new();
    let (mut symbol, mut of_symbol, mut left_out) = (String::new(), 0, 0);
    for ((s, labels), of) in members {
        if s != symbol {
            (symbol, of_symbol) = (s, 0);
        }
        if !all && (!says_something(of) || of_symbol >= SHORT) {
            left_out += 1;
            continue;
        }
        of_symbol += 1;
        text.push([join(&symbol, &labels), digits(of.0), digits(of.1)]);
    }
    if text.is_empty() {
        return;
    }
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
