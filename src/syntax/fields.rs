//! Lines of data under `$onDelim`: fields with a comma or blanks between them.

use super::data::is_space;
use crate::source::outside_quotes;

/// Marks a line of data under `$onDelim`.
pub(super) const MARK: u8 = crate::source::DELIMITED.as_bytes()[0];

/// The fields of a line, without blanks around them and without quotes; between two commas an empty one.
pub(super) struct Fields<'t> {
    text: &'t str,
    at: Option<usize>,
    end: usize,
}

/// Whether commas separate the fields of a line.
pub(super) fn has_comma(line: &str) -> bool {
    outside_quotes(line.as_bytes(), 0).any(|(_, b, _)| b == b',')
}

impl<'t> Fields<'t> {
    /// The fields of `lo..hi`; none if nothing stands there.
    pub(super) fn new(text: &'t str, lo: usize, hi: usize) -> Self {
        let empty = text[lo..hi].trim().is_empty();
        Self {
            text,
            at: (!empty).then_some(lo),
            end: hi,
        }
    }
}

impl Iterator for Fields<'_> {
    type Item = (usize, usize);

    fn next(&mut self) -> Option<Self::Item> {
        let bytes = &self.text.as_bytes()[..self.end];
        let blanks = |mut at: usize| {
            while bytes.get(at).is_some_and(|b| is_space(*b)) {
                at += 1;
            }
            at
        };
        let from = blanks(self.at?);
        let quoted = match bytes.get(from) {
            Some(&q @ (b'\'' | b'"')) => memchr::memchr(q, &bytes[from + 1..]),
            _ => None,
        };
        let (field, after) = match quoted {
            Some(n) => ((from + 1, from + 1 + n), from + n + 2),
            None => {
                let rest = &bytes[from..];
                let n = rest.iter().position(|&b| is_space(b) || b == b',');
                let to = from + n.unwrap_or(rest.len());
                ((from, to), to)
            }
        };
        let next = blanks(after);
        self.at = match bytes.get(next) {
            Some(b',') => Some(next + 1),
            Some(_) => Some(next),
            None => None,
        };
        Some(field)
    }
}
