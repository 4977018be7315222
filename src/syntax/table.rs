//! Tables: a value belongs to the column whose label it stands under.
//!
//! The first line holds the labels of the columns, each further line a row: its label, then values.
//! A line that begins with `+` is a new line of column labels, and rows begin anew. As in GAMS a
//! value must share a character position with one column, and with one only; a column is as wide as
//! its label and the values already read under it. The label of a row must not reach under the first
//! column. Tabs go to the next multiple of eight.
//!
//! Invariant: the reader always advances, so it ends on any text.

use super::data::{DataKind, DataReader, KeyPart, Tail, width};
use super::fields::{Fields, MARK};
use crate::diag::Diagnostic;
use crate::source::{Known, Outcome, Span};

mod plain;
pub use plain::PlainCell;

/// What comes next in a table.
#[derive(Debug)]
pub enum TableItem<'r, 'a> {
    /// A new line of column labels, see [`TableReader::columns`].
    Headings,
    /// The label of a row without values, and its place.
    EmptyRow(&'r [KeyPart<'a>], Span),
    /// A value.
    Cell(Cell<'r, 'a>),
}

/// One value of a table.
#[derive(Debug)]
pub struct Cell<'r, 'a> {
    /// Key of the row.
    pub row: &'r [KeyPart<'a>],
    /// Place of the row's label.
    pub row_span: Span,
    /// The first value of its row.
    pub first: bool,
    /// Key of the column.
    pub column: &'r [KeyPart<'a>],
    /// Which of the present columns that is.
    pub place: usize,
    /// The value: a number or an acronym.
    pub value: Tail<'a>,
    /// Place of the value.
    pub span: Span,
}

/// A column: its key and the positions of its label.
#[derive(Debug)]
struct Column<'a> {
    key: Vec<KeyPart<'a>>,
    from: usize,
    to: usize,
    span: Span,
}

/// Reads the values of a table, row by row.
#[derive(Default)]
pub struct TableReader<'a> {
    text: &'a str,
    /// Next byte to read as a line.
    at: usize,
    end: usize,
    columns: Vec<Column<'a>>,
    /// The next line that is not blank holds column labels.
    header: bool,
    row: Vec<KeyPart<'a>>,
    row_span: Span,
    /// Column position of the first byte of the present line.
    offset: usize,
    /// The present line has a byte a position.
    even: bool,
    /// Columns up to here lie before the next value.
    passed: usize,
    /// Columns up to here have their value in the present row.
    filled: usize,
    line: &'a str,
    line_base: u32,
    /// Byte and column position last computed in the present line.
    known: (usize, usize),
    reader: DataReader<'a>,
    /// In a row, behind its label.
    in_row: bool,
    /// The row had no value so far.
    empty: bool,
    /// Column labels were read that were not given yet.
    headings: bool,
    /// No row stands below the present columns.
    bare: bool,
    /// Index positions of rows and columns together.
    dim: usize,
    /// Cells of a line under `$onDelim` that are still to be given: column and bytes, last first.
    fields: Vec<(usize, usize, usize)>,
}

impl<'a> TableReader<'a> {
    /// `expanded` is the whole expanded text, `body` the table's lines in it, `dim` the number of indices.
    pub fn new(expanded: &'a str, body: Span, dim: usize, undf: bool) -> Self {
        let (lo, hi) = (body.lo as usize, (body.hi as usize).min(expanded.len()));
        Self {
            text: expanded,
            at: lo.min(hi),
            end: hi,
            header: true,
            row_span: body,
            even: true,
            reader: DataReader::new(&expanded[lo.min(hi)..hi], body.lo, DataKind::Values, undf),
            bare: true,
            dim,
            ..Self::default()
        }
    }

    /// Constant expressions in the table stand for their values.
    pub fn with_constants(self, known: &dyn Known) -> Self {
        let reader = self.reader.with_constants(known);
        Self { reader, ..self }
    }

    /// Keys of the columns of the present block, in order, and their places.
    pub fn columns(&self) -> impl Iterator<Item = (&[KeyPart<'a>], Span)> {
        self.columns.iter().map(|c| (c.key.as_slice(), c.span))
    }

    /// The next item. After an error, reading goes on with the next value or line.
    #[allow(clippy::should_implement_trait)]
    pub fn next(&mut self) -> Option<Outcome<TableItem<'_, 'a>>> {
        loop {
            if std::mem::take(&mut self.headings) {
                return Some(Ok(TableItem::Headings));
            }
            if let Some((column, from, to)) = self.fields.pop() {
                return Some(match self.reader.field_value(from, to) {
                    Ok(value) => Ok(self.item(column, value, self.span(from, to))),
                    Err(d) => Err(d),
                });
            }
            if self.in_row && self.reader.more() {
                return Some(match self.cell() {
                    Ok((column, value, span)) => Ok(self.item(column, value, span)),
                    Err(d) => Err(d),
                });
            }
            self.in_row = false;
            if std::mem::take(&mut self.empty) {
                return Some(Ok(TableItem::EmptyRow(&self.row, self.row_span)));
            }
            if self.at >= self.end {
                return None;
            }
            if let Err(d) = self.begin_line() {
                return Some(Err(d));
            }
        }
    }

    fn item(&mut self, column: usize, value: Tail<'a>, span: Span) -> TableItem<'_, 'a> {
        TableItem::Cell(Cell {
            row: &self.row,
            row_span: self.row_span,
            first: std::mem::take(&mut self.empty),
            column: &self.columns[column].key,
            place: column,
            value,
            span,
        })
    }

    /// Takes the next line: column labels, or the label of a row.
    fn begin_line(&mut self) -> Outcome<()> {
        let bytes = self.text.as_bytes();
        let start = self.at;
        let line_end = |from: usize| {
            memchr::memchr(b'\n', &bytes[from..self.end]).map_or(self.end, |n| from + n)
        };
        let mut stop = line_end(start);
        // A group of labels may go on in the next line.
        while !self.header && stop < self.end && in_group(&bytes[start..stop]) {
            stop = line_end(stop + 1);
        }
        self.at = stop + 1;
        // The first line may begin behind the table's text.
        let line_start = memchr::memrchr(b'\n', &bytes[..start]).map_or(0, |n| n + 1);
        self.offset = column_after(&self.text[line_start..start], 0);
        let mut from = start;
        let line = self.text[start..stop].trim_start();
        if line.is_empty() {
            return Ok(());
        }
        if line.as_bytes()[0] == MARK {
            self.delimited_line(stop - line.len(), stop);
            return Ok(());
        }
        if line.starts_with('+') {
            let plus = stop - line.len();
            if self.bare {
                let at = Span::new(plus as u32, plus as u32 + 1);
                let d =
                    Diagnostic::error("E0254", at).says("a table goes on here that has no rows");
                self.at = self.end;
                return Err(Box::new(match self.columns.first() {
                    Some(c) => d.other(c.span, "these columns have no row").help(
                        "a line that begins with `+` holds further columns, below the rows of those before",
                    ),
                    None => d.help("its first line holds the labels of its columns"),
                }));
            }
            self.offset = column_after(&self.text[line_start..plus + 1], 0);
            from = plus + 1;
            self.header = true;
            if self.text[from..stop].trim().is_empty() {
                return Ok(());
            }
        }
        self.line = &self.text[from..stop];
        self.line_base = from as u32;
        self.known = (0, self.offset);
        self.even = even(self.line);
        self.passed = 0;
        self.filled = 0;
        self.reader.restart(self.line, self.line_base);
        if self.header {
            self.header = false;
            self.read_header()
        } else {
            self.read_row_label()
        }
    }

    /// A line under `$onDelim`: the labels of the row, or what stands above them, come first.
    fn delimited_line(&mut self, start: usize, stop: usize) {
        self.line = &self.text[start..stop];
        self.line_base = start as u32;
        self.reader.restart(self.line, self.line_base);
        let (lo, hi) = self.reader.marked_line();
        let mut fields = Fields::new(self.line, lo, hi);
        let rows = self.dim.saturating_sub(1).max(1);
        if self.header {
            if fields.by_ref().take(rows).count() == 0 {
                return;
            }
            self.header = false;
            self.columns.clear();
            for (from, to) in fields {
                self.columns.push(Column {
                    key: vec![self.reader.field_label(from, to)],
                    from,
                    to,
                    span: self.span(from, to),
                });
            }
            self.headings = true;
            self.bare = true;
            return;
        }
        self.bare = false;
        self.row.clear();
        let mut first = None;
        while self.row.len() < rows {
            let Some((mut from, to)) = fields.next() else {
                return;
            };
            self.row_span = self.span(*first.get_or_insert(from), to);
            // Labels may have dots between as well: `a1.b1,5`.
            let quoted = from > 0 && matches!(self.line.as_bytes()[from - 1], b'\'' | b'"');
            while !quoted
                && self.row.len() + 1 < rows
                && let Some(n) = self.line[from..to].find('.')
            {
                self.row.push(self.reader.field_label(from, from + n));
                from += n + 1;
            }
            self.row.push(self.reader.field_label(from, to));
        }
        let cells = fields.enumerate().take(self.columns.len());
        self.fields.extend(
            cells
                .filter(|(_, (from, to))| to > from)
                .map(|(c, (from, to))| (c, from, to)),
        );
        self.fields.reverse();
        self.empty = true;
    }

    fn read_header(&mut self) -> Outcome<()> {
        self.columns.clear();
        self.bare = true;
        self.reader.set_arity(usize::MAX);
        while self.reader.more() {
            let from = self.reader.position();
            let mut key = Vec::new();
            self.reader.key_parts(&mut key, 0)?;
            let to = self.reader.position().max(from + 1);
            let span = self.span(from, to);
            let (from, to) = (self.column(from), self.column(to));
            self.columns.push(Column {
                key,
                from,
                to,
                span,
            });
        }
        self.headings = true;
        Ok(())
    }

    fn read_row_label(&mut self) -> Outcome<()> {
        self.bare = false;
        self.row.clear();
        self.reader.more();
        let columns = self.columns.first().map_or(1, |c| width(&c.key));
        self.reader
            .set_arity(self.dim.saturating_sub(columns).max(1));
        let from = self.reader.position();
        self.reader.key_parts(&mut self.row, 0)?;
        let mut to = self.reader.position();
        self.row_span = self.span(from, to);
        if let Some(n) = memchr::memrchr(b'\n', &self.line.as_bytes()[..to]) {
            // Values stand in the last line of the label.
            self.line = &self.line[n + 1..];
            self.line_base += n as u32 + 1;
            self.offset = 0;
            self.known = (0, 0);
            self.even = even(self.line);
            to -= n + 1;
            self.skip(to);
            to = 0;
        }
        let reach = self.column(to);
        if let Some(first) = self.columns.first()
            && reach > first.from
        {
            let span = first.span;
            return Diagnostic::error("E0252", self.row_span)
                .says("the label of this row reaches under a column")
                .other(span, "the first column begins here")
                .help("move the columns to the right, or shorten the label; is a row's label missing?")
                .refuse();
        }
        self.in_row = true;
        self.empty = true;
        Ok(())
    }

    fn cell(&mut self) -> Outcome<(usize, Tail<'a>, Span)> {
        let from = self.reader.position();
        let value = match self.reader.value() {
            Ok(v) => v,
            Err(d) => {
                // Behind the word that is no value.
                let rest = &self.line[from..];
                let len = rest.find([' ', '\t']).unwrap_or(rest.len()).max(1);
                self.skip(from + len);
                return Err(d);
            }
        };
        let to = self.reader.position();
        let span = self.span(from, to);
        if to == from {
            self.skip(from + 1);
            return Diagnostic::error("E0243", span)
                .says("a number was expected here")
                .help("numbers look like `12`, `-3.5`, `1.5e-3`; decimals stand behind a point")
                .refuse();
        }
        let (left, right) = (self.column(from), self.column(to));
        let mut first = self.passed;
        while self.columns.get(first).is_some_and(|c| c.to <= left) {
            first += 1;
        }
        self.passed = first;
        let under = self.columns[first..]
            .iter()
            .take_while(|c| c.from < right)
            .count();
        match under {
            1 if first < self.filled => Diagnostic::error("E0253", span)
                .says("a second value stands under this column")
                .other(self.columns[first].span, "the column")
                .help("move it under the label of its own column")
                .refuse(),
            1 => {
                self.filled = first + 1;
                // As in GAMS a column is as wide as its label and the values under it so far.
                let column = &mut self.columns[first];
                column.from = column.from.min(left);
                column.to = column.to.max(right);
                Ok((first, value, span))
            }
            0 => {
                let mut d = Diagnostic::error("E0250", span)
                    .says("this value stands under no column")
                    .help(match value {
                        Tail::Name(..) => "a value must stand under a part of its column's label; dots stand between the labels of a row: `a.b`",
                        _ => "a value must stand under a part of its column's label",
                    });
                for near in [first.wrapping_sub(1), first] {
                    if let Some(c) = self.columns.get(near) {
                        d = d.other(c.span, "a column near it");
                    }
                }
                Err(Box::new(d))
            }
            _ => {
                let d = Diagnostic::error("E0251", span)
                    .says("this value stands under more than one column")
                    .other(self.columns[first].span, "one")
                    .other(self.columns[first + 1].span, "another")
                    .help("write the column labels further apart");
                Err(Box::new(d))
            }
        }
    }

    /// Goes on at a byte of the present line.
    fn skip(&mut self, to: usize) {
        let mut to = to.min(self.line.len());
        while !self.line.is_char_boundary(to) {
            to += 1;
        }
        self.offset = self.column(to);
        self.known = (0, self.offset);
        self.line = &self.line[to..];
        self.line_base += to as u32;
        self.reader.restart(self.line, self.line_base);
    }

    fn span(&self, from: usize, to: usize) -> Span {
        Span::new(self.line_base + from as u32, self.line_base + to as u32)
    }

    /// Column position of a byte of the present line.
    fn column(&mut self, byte: usize) -> usize {
        if self.even {
            return self.offset + byte;
        }
        let (at, column) = if self.known.0 <= byte {
            self.known
        } else {
            (0, self.offset)
        };
        let column = column_after(self.line.get(at..byte).unwrap_or(""), column);
        self.known = (byte, column);
        column
    }
}

/// Whether a parenthesis is open at the end of a text.
fn in_group(bytes: &[u8]) -> bool {
    if memchr::memchr(b'(', bytes).is_none() {
        return false;
    }
    let (mut depth, mut quote) = (0, None);
    for &b in bytes {
        match (quote, b) {
            (Some(q), _) if b == q => quote = None,
            (Some(_), _) => {}
            (None, b'\'' | b'"') => quote = Some(b),
            (None, b'(') => depth += 1,
            (None, b')') => depth -= 1,
            _ => {}
        }
    }
    depth > 0
}

/// Whether each byte of a text takes one position.
fn even(text: &str) -> bool {
    text.is_ascii() && memchr::memchr(b'\t', text.as_bytes()).is_none()
}

/// The column position behind a text that begins at `column`.
fn column_after(text: &str, column: usize) -> usize {
    if even(text) {
        return column + text.len();
    }
    text.chars().fold(column, |c, ch| match ch {
        '\t' => (c / 8 + 1) * 8,
        _ => c + 1,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows as text, with places; `plainly`: those that can be read by [`TableReader::plain_row`] are.
    fn rows(text: &str, dim: usize, plainly: bool) -> Vec<String> {
        let mut t = TableReader::new(text, Span::new(0, text.len() as u32), dim, false);
        let (mut out, mut cells) = (Vec::new(), Vec::new());
        loop {
            let mut labels: Vec<&str> = Vec::new();
            let row = t.plain_row(&mut cells, |p, text| {
                labels.truncate(p);
                labels.push(text);
                plainly && text != "b"
            });
            if let Some(row) = row {
                out.extend(cells.iter().enumerate().map(|(n, c)| {
                    let (first, x) = (n == 0, c.value.to_bits());
                    format!("{labels:?} {row:?} {first} {} {x:x} {:?}", c.place, c.span)
                }));
                continue;
            }
            match t.next() {
                None => return out,
                Some(Ok(TableItem::Cell(c))) => {
                    let label = |p: &KeyPart<'_>| match p {
                        KeyPart::Label { text, .. } => (*text).to_owned(),
                        p => format!("{p:?}"),
                    };
                    let row: Vec<String> = c.row.iter().map(label).collect();
                    let value = match &c.value {
                        Tail::Number(x, _) => format!("{:x}", x.to_bits()),
                        value => format!("{value:?}"),
                    };
                    let at = c.row_span;
                    out.push(format!(
                        "{row:?} {at:?} {} {} {value} {:?}",
                        c.first, c.place, c.span
                    ));
                }
                Some(other) => out.push(format!("{other:?}")),
            }
        }
    }

    proptest::proptest! {
        #![proptest_config(proptest::prelude::ProptestConfig::with_cases(4000))]
        /// The short way reads what the long way reads.
        #[test]
        fn plain_rows_are_rows(
            headings in proptest::sample::select(vec![
                "     c1   c2  c3\n", "\n   c   d\n", "     a.x  b.y\n", "   c1 c2 c3 c4\n", "\u{1e}r,c1,c2,c3\n",
                "\u{1e}r,q,c1,'c 2'\n",
            ]),
            rest in proptest::collection::vec(
                proptest::sample::select(vec![
                    "a", "b", "r1", "set", ".", " ", " ", "  ", "   ", "    ", "1", "2.5", "-3", "0", "1e400", "eps", "-", "+",
                    ",", "\n", "\n", "\n", "'q r'", "(", "*", "#", "inf", "é", "\t", "\r\n", "\u{1e}", "r1   1    2   3\n",
                    "r2        4\n", "a.r1 1    -2\n", "\u{1e}r1,5,,7\n", "\u{1e}'a b',1,2\n", "\u{1e}a,r1,1,2.5\r\n", "+   c5 c6\n",
                    "r3 12345678 9\n",
                ]),
                0..16,
            ),
            dim in 2usize..4,
        ) {
            let text = headings.to_owned() + &rest.concat();
            proptest::prop_assert_eq!(rows(&text, dim, true), rows(&text, dim, false));
        }
    }
}
