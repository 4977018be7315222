//! The text of `display`, in GAMS's layout: numbers, lists, tables, planes.
//!
//! A number is shown with the wanted decimals if it fits in eleven characters (`option dispWidth`: in more)
//! and does not vanish, with an exponent otherwise. A list holds as many items of equal width as fit on the
//! page; a table's columns are one wider than a number, its row labels as wide as the longest of the plane.
//! What is not stored is blank.
//!
//! Source of the layout: GAMS 54.6, observed. Invariant: time and text are proportional to the records
//! and to the blanks between them.

use crate::data::table::Table;
use crate::data::universe::{Label, Universe};
use crate::data::value::special_text;
use rustc_hash::FxHashMap;
use std::borrow::Cow;
use std::fmt::Write;

/// Characters on a line.
pub const PAGE: usize = 32767;
/// Items of a list on a line.
const ITEMS: usize = 127;
/// Between items of a list.
const GAP: &str = ",    ";

/// The places of a display that `option p:d:r:c` sets.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Layout {
    /// Index positions that label a row; 0: a list.
    pub rows: usize,
    /// Index positions that label a column; of a list the most items on a line.
    pub columns: usize,
}

impl Layout {
    /// The layout of what nothing was said about: a list for one index, else a table with two positions
    /// for its rows (one, of two), and one plane per label of the others.
    pub fn usual(dim: usize) -> Self {
        let (rows, columns) = match dim {
            0 | 1 => (0, usize::MAX),
            2 => (1, 1),
            _ => (2, 1),
        };
        Self { rows, columns }
    }
}

/// What is shown of a record.
#[derive(Clone, Copy)]
pub enum Cells<'a> {
    /// Numbers.
    Numbers,
    /// Membership; the text of an element where there is one.
    Members(Option<&'a FxHashMap<Box<[Label]>, Box<str>>>),
}

/// An indexed symbol to be shown.
pub struct Sheet<'a> {
    /// Its records; tidy.
    pub table: &'a Table,
    /// Names of labels.
    pub universe: &'a Universe,
    /// Numbers or members.
    pub cells: Cells<'a>,
    /// How numbers look.
    pub numbers: Numbers<'a>,
    /// Rows and columns, if they were asked for.
    pub layout: Option<Layout>,
    /// Characters on a line.
    pub page: usize,
}

/// How numbers look.
#[derive(Clone, Copy)]
pub struct Numbers<'a> {
    /// Digits after the point.
    pub decimals: usize,
    /// `option dispWidth`: a column heading of one label is cut at this length.
    pub heading: usize,
    /// Names of acronyms.
    pub acronyms: &'a [Box<str>],
}

impl<'a> Numbers<'a> {
    /// Where nothing was said.
    pub fn usual(acronyms: &'a [Box<str>]) -> Self {
        Self {
            decimals: 3,
            heading: 10,
            acronyms,
        }
    }

    /// Widest number.
    fn width(&self) -> usize {
        self.heading + 1
    }

    /// Width of a table's column.
    fn column(&self) -> usize {
        self.heading + 2
    }

    /// A number as wide as one may be (acronyms: as long as they are), not padded.
    pub fn text(&self, x: f64) -> String {
        if let Some(name) = special_text(x, self.acronyms) {
            return name.to_string();
        }
        // Longer than this it cannot fit; formatting 300 digits would only take time.
        if x.abs() < 1e32 {
            let fixed = format!("{:.*}", self.decimals, x);
            let vanishes = || x != 0.0 && !fixed.bytes().any(|b| matches!(b, b'1'..=b'9'));
            if fixed.len() <= self.width() && !vanishes() {
                return if x == 0.0 {
                    fixed.trim_start_matches('-').to_string()
                } else {
                    fixed
                };
            }
        }
        exponential(x, self.width())
    }

    /// The line of a scalar, from `PARAMETER` on.
    pub fn scalar(&self, kind: &str, name: &str, value: f64, text: &str) -> String {
        let head = format!("{kind} {name}");
        let column = self.column();
        let line = format!("{head:30} = {:>column$}  {text}", self.text(value));
        line.trim_end().to_string()
    }

    /// The line that stands for an indexed symbol whose records all have the default value.
    pub fn all_default(&self, default: f64) -> String {
        let column = self.column();
        format!("{:22}( ALL{:>column$} )", "", self.text(default))
    }
}

/// A number with an exponent and as many digits as fill the width.
fn exponential(x: f64, width: usize) -> String {
    let most = width - 5;
    let mut digits = most;
    loop {
        let text = format!("{x:.digits$E}");
        let (mantissa, exponent) = text.split_once('E').unwrap_or((&text, "0"));
        let exponent = match exponent.strip_prefix('-') {
            Some(e) => format!("E-{e}"),
            None => format!("E+{exponent}"),
        };
        let spare = (width + 1).saturating_sub(mantissa.len() + exponent.len());
        if spare > 0 || digits == 0 {
            // Rounding up to a power of ten may have made room for a digit: it is a zero.
            let zeros = (spare.saturating_sub(1)).min(most - digits);
            return format!("{mantissa}{}{exponent}", "0".repeat(zeros));
        }
        digits -= 1;
    }
}

/// The line that stands for an empty set.
pub fn empty_set() -> String {
    format!("{:54}( EMPTY )", "")
}

fn width(s: &str) -> usize {
    if s.is_ascii() {
        s.len()
    } else {
        s.chars().count()
    }
}

fn pad(out: &mut String, blanks: usize) {
    out.extend(std::iter::repeat_n(' ', blanks));
}

fn push_right(out: &mut String, text: &str, to: usize) {
    pad(out, to.saturating_sub(width(text)));
    out.push_str(text);
}

fn trim(out: &mut String) {
    let end = out.trim_end_matches(' ').len();
    out.truncate(end);
}

/// Texts one after another in one buffer.
#[derive(Default)]
struct Texts {
    text: String,
    ends: Vec<usize>,
}

impl Texts {
    fn push(&mut self, s: &str) {
        self.text.push_str(s);
        self.ends.push(self.text.len());
    }

    fn get(&self, k: usize) -> &str {
        let lo = if k == 0 { 0 } else { self.ends[k - 1] };
        &self.text[lo..self.ends[k]]
    }
}

impl Sheet<'_> {
    /// The lines between the header and the blank line that follows; each ends with a line feed.
    /// The table must have records.
    pub fn write(&self, out: &mut String) {
        let dim = self.table.dim();
        let layout = self.layout.unwrap_or_else(|| Layout::usual(dim));
        if layout.rows == 0 || dim < 2 {
            return self.list(layout.columns.max(1), out);
        }
        let rows = layout.rows.min(dim - 1);
        let columns = layout.columns.clamp(1, dim - rows);
        self.planes(rows, columns, out);
    }

    fn name(&self, l: Label) -> &str {
        self.universe.name(l)
    }

    fn cell(&self, v: f64) -> String {
        match self.cells {
            Cells::Numbers => self.numbers.text(v),
            Cells::Members(_) => "YES".into(),
        }
    }

    /// The longest label at each of the positions.
    fn widths<'k>(&self, keys: impl Iterator<Item = &'k [Label]>, n: usize) -> Vec<usize> {
        let mut w = vec![0; n];
        let mut last: Option<&[Label]> = None;
        for k in keys {
            for (p, w) in w.iter_mut().enumerate() {
                if last.is_none_or(|l| l[p] != k[p]) {
                    *w = (*w).max(width(self.name(k[p])));
                }
            }
            last = Some(k);
        }
        w
    }

    /// `a .x  .long`: labels of equal width at each position.
    fn push_labels(&self, key: &[Label], widths: &[usize], out: &mut String) {
        for (p, (&l, &w)) in key.iter().zip(widths).enumerate() {
            if p > 0 {
                out.push('.');
            }
            let name = self.name(l);
            out.push_str(name);
            pad(out, w - width(name));
        }
    }

    fn list(&self, most: usize, out: &mut String) {
        let t = self.table;
        let dim = t.dim();
        let widths = self.widths(t.iter().map(|(k, _)| k), dim);
        let label_width = widths.iter().sum::<usize>() + dim.saturating_sub(1);
        if let (Cells::Members(texts), 1) = (self.cells, most) {
            for (k, _) in t.iter() {
                self.push_labels(k, &widths, out);
                if let Some(text) = texts.and_then(|m| m.get(k)) {
                    out.push_str("  ");
                    out.push_str(text);
                }
                trim(out);
                out.push('\n');
            }
            return;
        }
        let members = matches!(self.cells, Cells::Members(_));
        let mut cells = Texts::default();
        let mut cell_width = 0;
        if !members {
            for (_, v) in t.iter() {
                let c = self.cell(v);
                cell_width = cell_width.max(width(&c));
                cells.push(&c);
            }
        }
        let item = label_width + if members { 0 } else { 1 + cell_width };
        let fitting = (self.page + GAP.len()) / (item + GAP.len());
        let per_line = most.min(fitting).clamp(1, ITEMS);
        for (n, (k, _)) in t.iter().enumerate() {
            if n % per_line > 0 {
                out.push_str(GAP);
            }
            self.push_labels(k, &widths, out);
            if !members {
                out.push(' ');
                push_right(out, cells.get(n), cell_width);
            }
            if n % per_line == per_line - 1 || n + 1 == t.len() {
                trim(out);
                out.push('\n');
            }
        }
    }

    /// One table for each combination of the labels before the rows'.
    fn planes(&self, rows: usize, columns: usize, out: &mut String) {
        let records: Vec<(&[Label], f64)> = self.table.iter().collect();
        let lead = self.table.dim() - rows - columns;
        // Headings of several labels stand in one line as long as they fit.
        let fits = |(k, _): &(&[Label], f64)| {
            let labels = &k[lead + rows..];
            let length = labels.iter().map(|&l| width(self.name(l))).sum::<usize>();
            length + labels.len() - 1 <= self.numbers.width()
        };
        let mut joined = columns > 1;
        let mut from = 0;
        while from < records.len() {
            let plane = &records[from].0[..lead];
            let to = from + records[from..].partition_point(|(k, _)| k[..lead] == *plane);
            if from > 0 {
                out.push('\n');
            }
            if lead > 0 {
                for (p, &l) in plane.iter().enumerate() {
                    let _ = write!(
                        out,
                        "{}INDEX {} = {}",
                        if p > 0 { "  " } else { "" },
                        p + 1,
                        self.name(l)
                    );
                }
                out.push_str("\n\n");
            }
            joined = joined && records[from..to].iter().all(fits);
            self.plane(&records[from..to], lead, rows, joined, out);
            from = to;
        }
    }

    fn plane(
        &self,
        records: &[(&[Label], f64)],
        lead: usize,
        rows: usize,
        joined: bool,
        out: &mut String,
    ) {
        let row_of = |k: usize| &records[k].0[lead..lead + rows];
        let column_of = |k: usize| &records[k].0[lead + rows..];
        let column_width = self.numbers.column();
        let widths = self.widths((0..records.len()).map(row_of), rows);
        let label_width = widths.iter().sum::<usize>() + rows - 1;

        let mut columns: Vec<&[Label]> = (0..records.len()).map(column_of).collect();
        columns.sort_unstable();
        columns.dedup();
        let place: FxHashMap<&[Label], usize> =
            columns.iter().enumerate().map(|(i, &c)| (c, i)).collect();

        // Records by the block of columns they fall in, otherwise in their order.
        let per_block = (self.page.saturating_sub(label_width) / column_width).max(1);
        let blocks = columns.len().div_ceil(per_block);
        let places: Vec<usize> = (0..records.len()).map(|k| place[column_of(k)]).collect();
        let mut start = vec![0usize; blocks + 1];
        for p in &places {
            start[p / per_block + 1] += 1;
        }
        for b in 0..blocks {
            start[b + 1] += start[b];
        }
        let mut order = vec![0usize; records.len()];
        let mut next = start.clone();
        for (k, p) in places.iter().enumerate() {
            order[next[p / per_block]] = k;
            next[p / per_block] += 1;
        }

        for b in 0..blocks {
            if b > 0 {
                out.push('\n');
            }
            let first = b * per_block;
            let shown = &columns[first..columns.len().min(first + per_block)];
            self.headings(shown, joined, label_width, b > 0, out);
            out.push('\n');
            let block = &order[start[b]..start[b + 1]];
            for (i, &k) in block.iter().enumerate() {
                let new_row = i == 0 || row_of(block[i - 1]) != row_of(k);
                let before = if new_row {
                    if i > 0 {
                        out.push('\n');
                    }
                    self.push_labels(row_of(k), &widths, out);
                    0
                } else {
                    places[block[i - 1]] - first + 1
                };
                pad(out, column_width * (places[k] - first - before));
                let cell = self.cell(records[k].1);
                let length = width(&cell);
                if length > column_width {
                    // A long acronym is cut, and says so.
                    out.push_str("****");
                    out.extend(cell.chars().take(column_width).skip(4));
                } else {
                    push_right(out, &cell, column_width);
                }
            }
            out.push('\n');
        }
    }

    fn headings(
        &self,
        columns: &[&[Label]],
        joined: bool,
        label_width: usize,
        continued: bool,
        out: &mut String,
    ) {
        let (heading, column) = (self.numbers.heading, self.numbers.column());
        let lines = if joined { 1 } else { columns[0].len() };
        for line in 0..lines {
            if line == 0 && continued {
                push_right(out, "+", label_width);
            } else {
                pad(out, label_width);
            }
            for c in columns {
                let name = self.name(c[line]);
                let shown: Cow<str> = if joined {
                    let names: Vec<&str> = c.iter().map(|&l| self.name(l)).collect();
                    names.join(".").into()
                } else if width(name) > heading {
                    name.chars().take(heading - 1).chain(['~']).collect()
                } else {
                    name.into()
                };
                push_right(out, &shown, column);
            }
            out.push('\n');
        }
    }
}
