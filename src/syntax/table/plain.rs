//! Rows of tables as most are, read without looking twice.
//!
//! Invariant: what [`TableReader::plain_row`] reads, [`TableReader::next`] reads the same way (a property test holds it).

use super::TableReader;
use crate::source::Span;
use crate::syntax::data::{plain_label, plain_number, width};
use crate::syntax::fields::MARK;

/// A value in a row.
#[derive(Clone, Copy, Debug)]
pub struct PlainCell {
    /// Which of the present columns it stands under.
    pub place: usize,
    /// An ordinary number.
    pub value: f64,
    /// Its place.
    pub span: Span,
}

impl<'a> TableReader<'a> {
    /// The next row if it is as most are: a label at each of its positions with dots between them, then ordinary
    /// numbers, each under a column of its own (or a field each, under `$onDelim`). `label` is told each label with
    /// its position, and may refuse. Then, or if the row is another, nothing is read, and [`TableReader::next`] takes
    /// it, with the same outcome. The place is that of the label.
    pub fn plain_row(
        &mut self,
        cells: &mut Vec<PlainCell>,
        label: impl FnMut(usize, &'a str) -> bool,
    ) -> Option<Span> {
        cells.clear();
        let between_rows = !(self.header || self.in_row || self.empty || self.headings);
        if !between_rows || !self.fields.is_empty() || self.at >= self.end {
            return None;
        }
        let delimited = self.text().as_bytes().get(self.at) == Some(&MARK);
        let (row, end) = match delimited {
            true => self.fields_row(cells, label)?,
            false => self.aligned_row(cells, label)?,
        };
        if cells.is_empty() {
            return None;
        }
        self.at = end + 1;
        self.bare = false;
        Some(row)
    }

    /// What the table's lines are in, up to their end.
    fn text(&self) -> &'a str {
        &self.text[..self.end]
    }

    /// Calls `label` with the labels of a row; where they end.
    fn plain_labels(
        &self,
        from: usize,
        count: usize,
        delimited: bool,
        mut label: impl FnMut(usize, &'a str) -> bool,
    ) -> Option<usize> {
        let text = self.text();
        let bytes = text.as_bytes();
        let mut i = from;
        for p in 0..count {
            if p > 0 {
                let between = if delimited { b',' } else { b'.' };
                if bytes.get(i) != Some(&between) {
                    return None;
                }
                i += 1;
            }
            let end = plain_label(bytes, i, delimited)?;
            let quoted = usize::from(matches!(bytes[i], b'\'' | b'"'));
            if !label(p, &text[i + quoted..end - quoted]) {
                return None;
            }
            i = end;
        }
        Some(i)
    }

    /// A row under headings, and the end of its line.
    fn aligned_row(
        &mut self,
        cells: &mut Vec<PlainCell>,
        label: impl FnMut(usize, &'a str) -> bool,
    ) -> Option<(Span, usize)> {
        let text = self.text();
        let bytes = text.as_bytes();
        let start = self.at;
        // It begins where a line does, and each byte takes one position.
        if start > 0 && bytes[start - 1] != b'\n' {
            return None;
        }
        let blanks = |mut i: usize| {
            while bytes.get(i) == Some(&b' ') {
                i += 1;
            }
            i
        };
        let columns = self.columns.first().map_or(1, |c| width(&c.key));
        let count = self.dim.saturating_sub(columns).max(1);
        let from = blanks(start);
        let to = self.plain_labels(from, count, false, label)?;
        let first = self.columns.first()?;
        if to - start > first.from || !text[from..to].is_ascii() {
            return None;
        }
        let (mut i, mut passed, mut filled) = (to, 0, 0);
        let end = loop {
            let value = blanks(i);
            match bytes.get(value) {
                None | Some(b'\n') => break value,
                Some(b'\r') if matches!(bytes.get(value + 1), None | Some(b'\n')) => {
                    break value + 1;
                }
                Some(_) if value == i => return None,
                Some(_) => {}
            }
            let (x, behind) = plain_number(text, value)?;
            let (left, right) = (value - start, behind - start);
            while self.columns.get(passed).is_some_and(|c| c.to <= left) {
                passed += 1;
            }
            let under = self.columns.get(passed)?;
            let next = self.columns.get(passed + 1);
            let alone = under.from < right && next.is_none_or(|c| c.from >= right);
            if !alone || passed < filled {
                return None;
            }
            filled = passed + 1;
            cells.push(PlainCell {
                place: passed,
                value: x,
                span: Span::new(value as u32, behind as u32),
            });
            i = behind;
        };
        for cell in &*cells {
            // As in GAMS a column is as wide as its label and the values under it so far.
            let column = &mut self.columns[cell.place];
            column.from = column.from.min(cell.span.lo as usize - start);
            column.to = column.to.max(cell.span.hi as usize - start);
        }
        Some((Span::new(from as u32, to as u32), end))
    }

    /// A line under `$onDelim`, and its end.
    fn fields_row(
        &self,
        cells: &mut Vec<PlainCell>,
        label: impl FnMut(usize, &'a str) -> bool,
    ) -> Option<(Span, usize)> {
        let text = self.text();
        let bytes = text.as_bytes();
        let from = self.at + 1;
        let count = self.dim.saturating_sub(1).max(1);
        let to = self.plain_labels(from, count, true, label)?;
        let mut i = to;
        for place in 0.. {
            match bytes.get(i) {
                Some(b',') => i += 1,
                _ => break,
            }
            if matches!(bytes.get(i), None | Some(b',' | b'\n')) {
                continue;
            }
            if place >= self.columns.len() {
                return None;
            }
            let (value, behind) = plain_number(text, i)?;
            cells.push(PlainCell {
                place,
                value,
                span: Span::new(i as u32, behind as u32),
            });
            i = behind;
        }
        let end = match (bytes.get(i), bytes.get(i + 1)) {
            (None | Some(b'\n'), _) => i,
            (Some(b'\r'), None | Some(b'\n')) => i + 1,
            _ => return None,
        };
        // Without the quotes around.
        let quote = |i: usize| usize::from(matches!(bytes[i], b'\'' | b'"'));
        let (lo, hi) = (from + quote(from), to - quote(to - 1));
        Some((Span::new(lo as u32, hi as u32), end))
    }
}
