//! `bmod why` in sentences: findings of [`crate::solve::why`] with names and numbers.

use std::collections::BTreeMap;

use serde::Serialize;

use super::format::counted;
use super::names::Names;
use super::summary::digits;
use crate::model::instance::Instance;
use crate::solve::why::{Finding, Member};

/// What explains how a solve ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Explanation {
    /// One paragraph per finding.
    pub text: Vec<String>,
    /// Rows that are named.
    pub rows: Vec<String>,
    /// Columns that are named.
    pub columns: Vec<String>,
}

/// Puts findings into words.
pub fn explain(findings: &[Finding], instance: &Instance, names: &dyn Names) -> Explanation {
    let mut out = Explanation::default();
    for f in findings {
        let text = out.finding(f, instance, names);
        out.text.push(text);
    }
    out
}

fn short(v: f64) -> String {
    let exponential = || format!("{v:.2e}");
    if v != 0.0 && !(1e-4..1e7).contains(&v.abs()) {
        return exponential();
    }
    if v.fract().abs() <= 1e-9 {
        return digits(v.round());
    }
    match digits((v * 1e6).round() / 1e6) {
        short if short == "0" => exponential(),
        short => short,
    }
}

/// Notes a name in a list.
fn noted(list: &mut Vec<String>, name: String) -> String {
    if !list.contains(&name) {
        list.push(name.clone());
    }
    name
}

impl Explanation {
    fn row(&mut self, i: usize, names: &dyn Names) -> String {
        noted(&mut self.rows, names.row(i))
    }

    fn column(&mut self, j: usize, names: &dyn Names) -> String {
        noted(&mut self.columns, names.column(j))
    }

    fn finding(&mut self, f: &Finding, instance: &Instance, names: &dyn Names) -> String {
        match f {
            Finding::Irreducible {
                members,
                excess,
                shown,
            } => {
                let weights: Vec<f64> = members.iter().map(|m| m.1).collect();
                let members: Vec<Member> = members.iter().map(|m| m.0).collect();
                let mut text = self.irreducible(&members, &weights, *shown, instance, names);
                if *excess > 0.0 && excess.is_finite() {
                    text.push_str(&format!(
                        "\n  Added up with these multipliers they ask for 0 >= {}.",
                        short(*excess)
                    ));
                }
                text
            }
            Finding::Contradiction { members, shown } => {
                self.irreducible(members, &[], *shown, instance, names)
            }
            Finding::Discrete(found) => {
                let rest = match found.shown {
                    true => "without any one of them there is a solution",
                    false => "it was not shown that all of them are needed",
                };
                let rows = found
                    .rows
                    .iter()
                    .map(|&i| format!("row {} {}", self.row(i, names), relation(instance, i)));
                let rows: Vec<String> = rows.collect();
                let columns = found.columns.iter();
                let columns = columns.map(|&j| format!("{} is discrete", self.column(j, names)));
                let head = "These rows contradict each other, with all bounds, because of the discrete variables named";
                over(format!("{head}; {rest}:"), rows.into_iter().chain(columns))
            }
            Finding::Ray(parts) => {
                let head = "The objective improves without end: from any feasible point one may go on and \
                     on in this direction (the largest steps are shown), and no row and no bound \
                     stops it. A bound or a row that limits one of these is missing.";
                let one = |&(j, v): &(usize, f64)| {
                    format!("{} changes by {}", self.column(j, names), short(v))
                };
                over(head, parts.iter().map(one))
            }
            Finding::Violated { rows, columns } => {
                let rows = rows.iter().map(|&(i, v)| {
                    let name = self.row(i, names);
                    format!("{name} {}: by {}", relation(instance, i), short(v))
                });
                let rows: Vec<String> = rows.collect();
                let columns = columns
                    .iter()
                    .map(|&(j, v)| format!("bounds of {}: by {}", self.column(j, names), short(v)));
                let head = "The last point violates these most, and nothing near it is better:";
                over(head, rows.into_iter().chain(columns))
            }
            Finding::Inaccurate { rows, columns } => {
                let worth =
                    |rest: f64, share: f64| format!("{rest:.1e}, which is worth {share:.1e}");
                let rows = rows.iter().map(|&(i, rest, share)| {
                    format!("row {}: off by {}", self.row(i, names), worth(rest, share))
                });
                let rows: Vec<String> = rows.collect();
                let columns = columns.iter().map(|&(j, rest, share)| {
                    let name = self.column(j, names);
                    format!("column {name}: reduced cost {}", worth(rest, share))
                });
                let head = "The point is not accurate. A residual changes the objective by itself times \
                     its multiplier; these carry the error:";
                over(head, rows.into_iter().chain(columns))
            }
            Finding::Scaling {
                largest,
                smallest,
                rows,
                columns,
            } => {
                let mut at = |&(i, j, v): &(usize, usize, f64)| {
                    let (row, column) = (self.row(i, names), self.column(j, names));
                    format!("{v:.1e} (of {column} in {row})")
                };
                let (high, low) = (at(largest), at(smallest));
                let head = format!(
                    "The coefficients lie far apart: from {low} to {high}. Other units for these \
                     variables or equations would bring them together."
                );
                let rows = rows.iter().map(|&(i, low, high)| {
                    format!("row {}: {low:.1e} to {high:.1e}", self.row(i, names))
                });
                let rows: Vec<String> = rows.collect();
                let columns = columns.iter().map(|&(j, low, high)| {
                    format!("column {}: {low:.1e} to {high:.1e}", self.column(j, names))
                });
                over(head, rows.into_iter().chain(columns))
            }
            Finding::Pairs(pairs) => {
                let one = |&(i, j, r): &(Option<usize>, usize, f64)| {
                    let column = self.column(j, names);
                    let row = i.map_or(String::new(), |i| format!("{} with ", self.row(i, names)));
                    format!("{row}{column}: residual {}", short(r))
                };
                over(
                    "These pairs are farthest from a solution:",
                    pairs.iter().map(one),
                )
            }
            Finding::Structural { rows, columns } => {
                let rows: Vec<String> = rows.iter().map(|&i| self.row(i, names)).collect();
                let columns: Vec<String> = columns.iter().map(|&j| self.column(j, names)).collect();
                let only = match columns.len() {
                    0 => "no variable that is not at a bound".to_string(),
                    _ => format!("only {}", columns.join(", ")),
                };
                format!(
                    "The system is structurally singular here: the rows {} have {only} to satisfy \
                     them with, whatever the numbers are.",
                    rows.join(", ")
                )
            }
            Finding::Singular { rows, columns } => {
                let rows: Vec<String> = rows.iter().map(|&i| self.row(i, names)).collect();
                let columns: Vec<String> = columns.iter().map(|&j| self.column(j, names)).collect();
                format!(
                    "The system is singular at the last point: {} changes with no variable \
                     independently of other rows ({} has no effect of its own).",
                    rows.join(", "),
                    columns.join(", ")
                )
            }
            Finding::WrongWay(pairs) => {
                let head = "In these pairs the row falls where its own variable grows, so that moving the \
                     variable off its bound makes matters worse; is the sign right, or the pair?";
                let one = |&(i, j, v): &(usize, usize, f64)| {
                    let (row, column) = (self.row(i, names), self.column(j, names));
                    format!("{row} with {column}: derivative {}", short(v))
                };
                over(head, pairs.iter().map(one))
            }
            Finding::NoValue { row, column, what } => {
                let row = self.row(*row, names);
                let argument = column.map_or(String::new(), |j| {
                    format!(", whose argument is {}", self.column(j, names))
                });
                format!("At the last point {row} has no value or no derivative: {what}{argument}.")
            }
        }
    }

    /// Rows and bounds that contradict each other, with their multipliers, if there are any.
    fn irreducible(
        &mut self,
        members: &[Member],
        weights: &[f64],
        shown: bool,
        instance: &Instance,
        names: &dyn Names,
    ) -> String {
        let is_row = |m: &&Member| matches!(m, Member::Row(_));
        let rows = members.iter().filter(is_row).count();
        let counts = [(rows, "row"), (members.len() - rows, "bound")].into_iter();
        let counts = counts.filter(|(n, _)| *n > 0);
        let what: Vec<String> = counts.map(|(n, one)| counted(n, one)).collect();
        let alone = match (members.len(), shown) {
            (1, _) => "cannot be satisfied",
            (_, true) => {
                "contradict each other; with any one of them dropped, the others can be satisfied"
            }
            (_, false) => "contradict each other; perhaps not all of them are needed for that",
        };
        let mut text = format!("{} {alone}:", what.join(" and "));
        // Many bounds of one symbol that are alike take one line.
        let mut alike: BTreeMap<String, usize> = BTreeMap::new();
        let key = |m: Member| match m {
            Member::Row(_) => None,
            Member::Lower(j) => Some((names.column_parts(j).0, "least", instance.columns.lower[j])),
            Member::Upper(j) => Some((names.column_parts(j).0, "most", instance.columns.upper[j])),
        };
        let key = |m: Member| key(m).map(|(s, side, v)| format!("{s}, at {side} {}", digits(v)));
        for k in members.iter().filter_map(|m| key(*m)) {
            *alike.entry(k).or_default() += 1;
        }
        for (n, &m) in members.iter().enumerate() {
            if let Some(k) = key(m)
                && let Some(count) = alike.get_mut(&k).filter(|c| **c > 4 || **c == 0)
            {
                let (Member::Row(j) | Member::Lower(j) | Member::Upper(j)) = m;
                let name = self.column(j, names);
                if *count > 0 {
                    text.push_str(&format!("\n    {k}: {count} of them, as {name}"));
                    *count = 0;
                }
                continue;
            }
            let line = match m {
                Member::Row(i) => format!("{} {}", self.row(i, names), relation(instance, i)),
                Member::Lower(j) => {
                    let l = instance.columns.lower[j];
                    format!("{}, at least {}", self.column(j, names), digits(l))
                }
                Member::Upper(j) => {
                    let u = instance.columns.upper[j];
                    format!("{}, at most {}", self.column(j, names), digits(u))
                }
            };
            text.push_str(&format!("\n    {line}"));
            if let Some(v) = weights.get(n) {
                text.push_str(&format!("    (times {})", short(*v)));
            }
        }
        text
    }
}

/// A heading over indented lines.
fn over(head: impl Into<String>, lines: impl Iterator<Item = String>) -> String {
    lines.fold(head.into(), |text, line| text + "\n    " + &line)
}

/// `=g= 30`
fn relation(instance: &Instance, i: usize) -> String {
    let sign = instance.rows.relation[i].name();
    format!("{sign} {}", digits(instance.rows.rhs[i]))
}
