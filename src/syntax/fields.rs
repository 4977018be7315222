//! Lines of data under `$onDelim`: fields with commas between them.

use super::data::is_space;

/// Marks a line of data under `$onDelim`.
pub(super) const MARK: u8 = crate::source::DELIMITED.as_bytes()[0];

/// The fields of a line with commas between them: without blanks around them and without quotes.
pub(super) struct Fields<'t> {
    text: &'t str,
    at: Option<usize>,
    end: usize,
    /// Blanks separate where no comma does.
    blanks: bool,
}

/// Whether commas separate the fields of a line.
pub(super) fn has_comma(line: &str) -> bool {
    let bytes = line.as_bytes();
    let mut i = 0;
    while i < bytes.len() {
        match bytes[i] {
            b',' => return true,
            q @ (b'\'' | b'"') => {
                i += memchr::memchr(q, &bytes[i + 1..]).map_or(0, |n| n + 1);
            }
            _ => {}
        }
        i += 1;
    }
    false
}

impl<'t> Fields<'t> {
    /// The fields of `lo..hi`; none if nothing stands there.
    pub(super) fn new(text: &'t str, lo: usize, hi: usize) -> Self {
        let empty = text[lo..hi].trim().is_empty();
        Self {
            text,
            at: (!empty).then_some(lo),
            end: hi,
            blanks: !has_comma(&text[lo..hi]),
        }
    }
}

impl Iterator for Fields<'_> {
    type Item = (usize, usize);

    fn next(&mut self) -> Option<(usize, usize)> {
        let mut from = self.at?;
        let bytes = self.text.as_bytes();
        while from < self.end && is_space(bytes[from]) {
            from += 1;
        }
        let (mut field, mut after) = ((from, from), from);
        if let Some(&q @ (b'\'' | b'"')) = bytes[..self.end].get(from)
            && let Some(n) = memchr::memchr(q, &bytes[from + 1..self.end])
        {
            field = (from + 1, from + 1 + n);
            after = from + n + 2;
        }
        let comma = if self.blanks {
            let rest = &bytes[after..self.end];
            let n = rest.iter().position(|&b| is_space(b));
            n.map(|n| after + n)
                .filter(|&n| !self.text[n..self.end].trim().is_empty())
        } else {
            memchr::memchr(b',', &bytes[after..self.end]).map(|n| after + n)
        };
        if after == from {
            let mut to = comma.unwrap_or(self.end);
            while to > from && is_space(bytes[to - 1]) {
                to -= 1;
            }
            field = (from, to);
        }
        self.at = comma.map(|c| c + 1);
        Some(field)
    }
}
