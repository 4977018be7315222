//! Constant expressions in data: `/ a [1/3], b [card(i)*2] /`.
//!
//! They stand for a number, between brackets or braces on one line. The numbers are worked out before the
//! data are read, because only the checker knows what `card(i)` is.

use crate::diag::Diagnostic;
use crate::source::{Known, Outcome, Span, constant, quoted_end};

/// The constant expressions of one body of data, by their places in the expanded text.
#[derive(Clone, Default)]
pub(super) struct Constants(Vec<Constant>);

#[derive(Clone)]
struct Constant {
    lo: usize,
    hi: usize,
    value: Result<f64, String>,
}

impl Constants {
    /// Evaluates all of them in a body that begins at `base`.
    pub(super) fn of(text: &str, base: u32, known: &dyn Known) -> Self {
        let bytes = text.as_bytes();
        let mut found = Vec::new();
        let mut i = 0;
        while let Some(n) = memchr::memchr2(b'[', b'{', &bytes[i..]) {
            let lo = i + n;
            let line = memchr::memrchr(b'\n', &bytes[..lo]).map_or(0, |n| n + 1);
            if let Some(end) = quote_over(bytes, line, lo) {
                i = end;
                continue;
            }
            let end = memchr::memchr(b'\n', &bytes[lo..]).map_or(bytes.len(), |n| lo + n);
            let (value, hi) = match constant(&text[lo..end], known) {
                Ok((x, n)) if x.is_nan() => (Err("it has no value".into()), lo + n),
                Ok((x, n)) => (Ok(x), lo + n),
                Err(why) => (Err(why), closing(bytes, lo, end).unwrap_or(end)),
            };
            found.push(Constant {
                lo: base as usize + lo,
                hi: base as usize + hi,
                value,
            });
            i = hi;
        }
        Self(found)
    }

    /// The value of the one that begins at `at`, and where it ends.
    pub(super) fn at(&self, at: usize) -> Option<Outcome<(f64, usize)>> {
        let n = self.0.binary_search_by_key(&at, |c| c.lo).ok()?;
        let c = &self.0[n];
        Some(match &c.value {
            Ok(x) => Ok((*x, c.hi)),
            Err(why) => Diagnostic::error("E0247", Span::new(c.lo as u32, c.hi as u32))
                .says(format!("this constant expression cannot be evaluated: {why}"))
                .help("numbers, operators, functions, `card(set)` and scalars with data can stand here, on one line")
                .refuse(),
        })
    }
}

/// The end of the quoted text that `at` stands in, on the line that begins at `line`.
fn quote_over(bytes: &[u8], line: usize, at: usize) -> Option<usize> {
    let mut q = line;
    while q < at {
        match quoted_end(bytes, q) {
            Some(end) if end > at => return Some(end),
            Some(end) => q = end,
            None => q += 1,
        }
    }
    None
}

/// Where the bracket that opens at `lo` is closed.
fn closing(bytes: &[u8], lo: usize, end: usize) -> Option<usize> {
    let mut depth = 0;
    for (i, b) in bytes[lo..end].iter().enumerate() {
        match b {
            b'[' | b'{' => depth += 1,
            b']' | b'}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(lo + i + 1);
        }
    }
    None
}

/// If the slash at `at` divides within a constant expression of the data that begin at `from`, where
/// that expression ends.
pub(super) fn end_of_constant(bytes: &[u8], from: usize, at: usize) -> Option<usize> {
    let line = memchr::memrchr(b'\n', &bytes[from..at]).map_or(from, |n| from + n + 1);
    memchr::memrchr2(b'[', b'{', &bytes[line..at])?;
    let end = memchr::memchr(b'\n', &bytes[at..]).map_or(bytes.len(), |n| at + n);
    let mut i = line;
    while i < at {
        i = match bytes[i] {
            b'[' | b'{' => closing(bytes, i, end)?,
            _ => quoted_end(bytes, i).unwrap_or(i + 1),
        };
    }
    (i > at).then_some(i)
}
