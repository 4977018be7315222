//! The generated rows and columns as readable algebra (`bmod list`).
//!
//! A row shows its terms with the numbers of the instance, then its left side at the current
//! levels and by how much it is violated there; a column its bounds, level and entries.

use std::fmt::Write;

use super::names::Names;
use super::summary::digits;
use crate::model::instance::{Instance, KernelTerms, Op};
use crate::solve::certificate::row_violation;

/// What to list.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Symbols or members (`equil` or `equil('b3','x')`); empty: the first of every block.
    pub names: Vec<String>,
    /// How many of each block, where the names ask for a whole symbol or for nothing.
    pub limit: usize,
}

/// Where terms do not fit, the next line begins with this many blanks.
const INDENT: usize = 6;
/// Width of a line.
const WIDTH: usize = 100;

/// The listing of an instance. `activity` is the left side of each row at the current levels,
/// where it can be evaluated.
pub fn listing(
    instance: &Instance,
    names: &dyn Names,
    activity: &[f64],
    selection: &Selection,
) -> String {
    let mut out = String::new();
    let mut terms_of_row: Vec<Vec<(u32, u32)>> = Vec::new();
    if !instance.is_linear() {
        terms_of_row.resize(instance.row_count(), Vec::new());
        for (k, kernel) in instance.nonlinear.iter().enumerate() {
            for (t, &i) in kernel.row.iter().enumerate() {
                terms_of_row[i as usize].push((k as u32, t as u32));
            }
        }
    }
    let rows = select(
        instance.row_count(),
        |i| names.row_parts(i).0,
        |i| names.row(i),
        selection,
    );
    for block in &rows {
        let _ = writeln!(out, "---- {}  {}\n", block.symbol, range(block, "row"));
        for &i in &block.shown {
            let terms = terms_of_row.get(i).map_or(&[][..], |t| t);
            row(&mut out, instance, names, activity, i, terms);
        }
        out.push('\n');
    }
    let columns = select(
        instance.column_count(),
        |j| names.column_parts(j).0,
        |j| names.column(j),
        selection,
    );
    if columns.is_empty() {
        return out;
    }
    let entries = columns_of(instance, &columns);
    for block in &columns {
        let _ = writeln!(out, "---- {}  {}\n", block.symbol, range(block, "column"));
        for &j in &block.shown {
            column(&mut out, instance, names, j, &entries);
        }
        out.push('\n');
    }
    out
}

/// Consecutive rows or columns of one symbol.
struct Block {
    symbol: String,
    total: usize,
    shown: Vec<usize>,
}

fn range(block: &Block, what: &str) -> String {
    let (n, total) = (block.shown.len(), block.total);
    let s = if total == 1 { "" } else { "s" };
    if n == total {
        format!("{total} {what}{s}")
    } else {
        format!("{n} of {total} {what}{s}")
    }
}

/// The members to show, by block, in the instance's order.
fn select(
    count: usize,
    symbol: impl Fn(usize) -> String,
    name: impl Fn(usize) -> String,
    selection: &Selection,
) -> Vec<Block> {
    let asked = |text: &str| selection.names.iter().any(|n| n.eq_ignore_ascii_case(text));
    let plain = |text: &str| -> String {
        let quote = |c: &char| !matches!(c, '\'' | '"' | ' ');
        text.chars()
            .filter(quote)
            .collect::<String>()
            .to_lowercase()
    };
    let wanted: Vec<String> = selection.names.iter().map(|n| plain(n)).collect();
    let mut blocks: Vec<Block> = Vec::new();
    let mut whole = true;
    for i in 0..count {
        let s = symbol(i);
        if blocks.last().is_none_or(|b| b.symbol != s) {
            whole = selection.names.is_empty() || asked(&s);
            blocks.push(Block {
                symbol: s,
                total: 0,
                shown: Vec::new(),
            });
        }
        let Some(block) = blocks.last_mut() else {
            continue;
        };
        block.total += 1;
        let show = if whole {
            block.shown.len() < selection.limit
        } else {
            let starts = |w: &&String| w.starts_with(&block.symbol.to_lowercase());
            wanted.iter().any(|w| starts(&w)) && wanted.contains(&plain(&name(i)))
        };
        if show {
            block.shown.push(i);
        }
    }
    blocks.retain(|b| !b.shown.is_empty());
    blocks
}

/// Appends pieces, breaking lines between them.
fn flow(out: &mut String, head: &str, pieces: &[String]) {
    let mut width = head.chars().count();
    out.push_str(head);
    for piece in pieces {
        let long = piece.chars().count() + 1;
        if width + long > WIDTH && width > INDENT {
            out.push('\n');
            out.push_str(&" ".repeat(INDENT));
            width = INDENT;
        } else {
            out.push(' ');
        }
        out.push_str(piece);
        width += long;
    }
    out.push('\n');
}

fn row(
    out: &mut String,
    instance: &Instance,
    names: &dyn Names,
    activity: &[f64],
    i: usize,
    terms: &[(u32, u32)],
) {
    let mut pieces: Vec<String> = Vec::new();
    for (j, a) in instance.matrix.row(i) {
        pieces.push(term(a, &names.column(j), pieces.is_empty()));
    }
    for &(k, t) in terms {
        let kernel = &instance.nonlinear[k as usize];
        let text = algebra(kernel, t as usize, names);
        pieces.push(term(kernel.coef[t as usize], &text, pieces.is_empty()));
    }
    if pieces.is_empty() {
        pieces.push("0".into());
    }
    let rhs = instance.rows.rhs[i];
    let relation = instance.rows.relation[i].name().to_uppercase();
    pieces.push(format!("{relation} {} ;", digits(rhs)));
    if let Some(&a) = activity.get(i) {
        let violation = row_violation(instance.rows.relation[i], a, rhs);
        pieces.push(if violation > 1e-9 * rhs.abs().max(a.abs()) {
            format!("(LHS = {}, INFES = {} ****)", digits(a), digits(violation))
        } else {
            format!("(LHS = {})", digits(a))
        });
    }
    flow(out, &format!("{}..", names.row(i)), &pieces);
}

/// `+ 0.5*x('c1')`; the first without its plus.
fn term(a: f64, what: &str, first: bool) -> String {
    let sign = match (a < 0.0, first) {
        (true, true) => "-",
        (true, false) => "- ",
        (false, true) => "",
        (false, false) => "+ ",
    };
    let size = a.abs();
    if size == 1.0 {
        format!("{sign}{what}")
    } else {
        format!("{sign}{}*{what}", digits(size))
    }
}

/// Entries of the columns that are shown: (column, row, coefficient or None), sorted by column.
fn columns_of(instance: &Instance, blocks: &[Block]) -> Vec<(usize, usize, Option<f64>)> {
    let mut shown = vec![false; instance.column_count()];
    for &j in blocks.iter().flat_map(|b| &b.shown) {
        shown[j] = true;
    }
    let mut entries = Vec::new();
    for i in 0..instance.row_count() {
        let linear = instance.matrix.row(i).filter(|&(j, _)| shown[j]);
        entries.extend(linear.map(|(j, a)| (j, i, Some(a))));
    }
    for t in instance.terms() {
        let columns = t.columns.iter().map(|&j| j as usize);
        entries.extend(columns.filter(|&j| shown[j]).map(|j| (j, t.row, None)));
    }
    entries.sort_by_key(|e| (e.0, e.1, e.2.is_none()));
    // A nonlinear entry says all; a column is named once per row.
    entries.dedup_by(|b, a| {
        let same = (a.0, a.1) == (b.0, b.1);
        if same && b.2.is_none() {
            a.2 = None;
        }
        same
    });
    entries
}

fn column(
    out: &mut String,
    instance: &Instance,
    names: &dyn Names,
    j: usize,
    entries: &[(usize, usize, Option<f64>)],
) {
    let c = &instance.columns;
    let _ = writeln!(
        out,
        "{}\n    (.LO, .L, .UP, .M = {}, {}, {}, {})",
        names.column(j),
        digits(c.lower[j]),
        digits(c.level[j]),
        digits(c.upper[j]),
        digits(c.marginal[j])
    );
    let first = entries.partition_point(|e| e.0 < j);
    for &(_, i, a) in entries[first..].iter().take_while(|e| e.0 == j) {
        let a = a.map_or("nonlinear".into(), digits);
        let _ = writeln!(out, "    {a:>14}  {}", names.row(i));
    }
}

/// A kernel's term as one writes it.
fn algebra(terms: &KernelTerms, t: usize, names: &dyn Names) -> String {
    let slots = terms.term(t);
    let variable = |k: u32| names.column(slots.columns[k as usize] as usize);
    let constant = |k: u32| slots.constants[k as usize];
    // Text and how tightly it binds: 1 sum, 2 product, 3 power, 4 atom.
    let mut stack: Vec<(String, u8)> = Vec::new();
    let wrap = |(text, binds): (String, u8), needed: u8| {
        if binds < needed {
            format!("({text})")
        } else {
            text
        }
    };
    for op in &terms.kernel.ops {
        let mut pop = || stack.pop().unwrap_or(("?".into(), 4));
        let made = match *op {
            Op::Var(k) => (variable(k), 4),
            Op::Const(k) => {
                let value = constant(k);
                (digits(value), if value < 0.0 { 1 } else { 4 })
            }
            Op::Affine(first, x, terms) => {
                let mut text = String::new();
                for m in 0..terms {
                    let piece = term(constant(first + 1 + m), &variable(x + m), text.is_empty());
                    let gap = if text.is_empty() { "" } else { " " };
                    text = format!("{text}{gap}{piece}");
                }
                let alone = constant(first);
                if alone != 0.0 || text.is_empty() {
                    let sign = if alone < 0.0 { "-" } else { "+" };
                    text = match text.is_empty() {
                        true => digits(alone),
                        false => format!("{text} {sign} {}", digits(alone.abs())),
                    };
                }
                (text, 1)
            }
            Op::Divide | Op::Power => {
                let (b, a) = (pop(), pop());
                let (sign, left, right, binds) = match op {
                    Op::Divide => ("/", 2, 3, 2),
                    _ => ("**", 4, 4, 3),
                };
                (format!("{}{sign}{}", wrap(a, left), wrap(b, right)), binds)
            }
            Op::Add(n) | Op::Multiply(n) => {
                let (sign, binds) = match op {
                    Op::Add(_) => (" + ", 1),
                    _ => ("*", 2),
                };
                let last = binds + u8::from(n == 2);
                let mut parts: Vec<String> = (0..n)
                    .map(|k| wrap(pop(), if k == 0 { last } else { binds }))
                    .collect();
                parts.reverse();
                (parts.join(sign), binds)
            }
            Op::Negate => (format!("-{}", wrap(pop(), 2)), 1),
            Op::PowerInt(2) => (format!("sqr({})", pop().0), 4),
            Op::PowerInt(k) => (format!("power({},{k})", pop().0), 4),
            Op::Call(f, n) => {
                let mut parts: Vec<String> = (0..n).map(|_| pop().0).collect();
                parts.reverse();
                (format!("{}({})", f.name(), parts.join(",")), 4)
            }
        };
        stack.push(made);
    }
    let whole = stack.pop().unwrap_or(("0".into(), 4));
    wrap(whole, 2)
}
