//! Records as most are, read without looking twice, and what stands between records.
//!
//! Invariant: what [`DataReader::plain`] reads, [`DataReader::next`] reads the same way (a property test holds it).

use super::{DataKind, DataReader, is_label, is_space, ordinary};
use crate::source::Span;
use crate::syntax::fields::MARK;

/// What stands between two records: one comma, a line end, or both.
pub(super) struct Gap {
    /// The next record, or the end of the text.
    pub(super) end: usize,
    /// The first comma and the second.
    commas: [Option<usize>; 2],
    line_end: bool,
    /// Nothing stands before it.
    first: bool,
    /// Nothing stands behind it.
    last: bool,
}

impl Gap {
    pub(super) fn at(bytes: &[u8], from: usize) -> Self {
        let mut gap = Self {
            end: from,
            commas: [None; 2],
            line_end: false,
            first: from == 0,
            last: false,
        };
        while let Some(&b) = bytes.get(gap.end) {
            match b {
                b',' if gap.commas[0].is_some() => gap.commas[1] = gap.commas[1].or(Some(gap.end)),
                b',' => gap.commas[0] = Some(gap.end),
                _ if is_space(b) => gap.line_end |= b == b'\n',
                _ => return gap,
            }
            gap.end += 1;
        }
        gap.last = true;
        gap
    }

    /// Where it is not as it must be, and why.
    pub(super) fn problem(&self) -> Option<(usize, &'static str)> {
        match self.commas {
            [_, Some(second)] => Some((second, "a label was expected here, not `,`")),
            [Some(comma), _] if self.first => Some((comma, "a label was expected here, not `,`")),
            [Some(comma), _] if self.last => {
                Some((comma, "a label was expected behind this comma"))
            }
            [None, _] if !self.first && !self.last && !self.line_end => {
                Some((self.end, "a comma is missing before this record"))
            }
            _ => None,
        }
    }
}

/// [`is_label`] of every byte.
const LABEL: [bool; 256] = {
    let mut table = [false; 256];
    let mut b = 0;
    while b < 256 {
        table[b] = is_label(b as u8);
        b += 1;
    }
    table
};

/// Bytes of [`DataReader::ahead`], about.
const AHEAD: usize = 4096;

/// What stands first between commas and line ends: mostly labels of elements. For who can be wrong.
pub fn likely_labels(text: &str) -> impl Iterator<Item = &str> {
    text.split([',', '\n']).map(|record| {
        let record = record.trim_start();
        match record.strip_prefix(['\'', '"']) {
            Some(quoted) => quoted.split(['\'', '"']).next().unwrap_or(quoted),
            None => {
                let bytes = record.bytes();
                let len = bytes.take_while(|b| LABEL[*b as usize]).count();
                &record[..len]
            }
        }
    })
}

impl<'a> DataReader<'a> {
    /// The next record if it is as most are: labels with dots between them (commas under `$onDelim`), and an
    /// ordinary number behind the keys of values. `label` is told each one with its position, and may refuse.
    /// Then, or if the record is another, nothing is read, and [`DataReader::next`] takes it, with the same
    /// outcome. An element has the value 1.
    pub fn plain(&mut self, mut label: impl FnMut(usize, &'a str) -> bool) -> Option<(f64, Span)> {
        let bytes = self.text.as_bytes();
        // The first record may be a bare number.
        if self.at == 0 && self.kind == DataKind::Values {
            return None;
        }
        let is = |i: usize, class: fn(u8) -> bool| bytes.get(i).is_some_and(|&b| class(b));
        let inner_blanks = |mut i: usize| {
            while is(i, |b| is_space(b) && b != b'\n') {
                i += 1;
            }
            i
        };
        let gap = Gap::at(bytes, self.at);
        if gap.problem().is_some() {
            return None;
        }
        let start = gap.end;
        let delimited = bytes.get(start) == Some(&MARK);
        let between = if delimited { b',' } else { b'.' };
        let mut i = start + usize::from(delimited);
        for p in 0..self.arity {
            if p > 0 {
                i = inner_blanks(i);
                if bytes.get(i) != Some(&between) {
                    return None;
                }
                i = inner_blanks(i + 1);
            }
            let end = plain_label(bytes, i, delimited)?;
            let quoted = matches!(bytes[i], b'\'' | b'"');
            let text = &self.text[i + usize::from(quoted)..end - usize::from(quoted)];
            if !label(p, text) {
                return None;
            }
            i = end;
        }
        let key_end = i;
        i = inner_blanks(i);
        let x = match (self.kind, delimited) {
            (DataKind::Set, false) => 1.0,
            (DataKind::Set, true) => return None,
            (DataKind::Values, _) => {
                match (delimited, bytes.get(i)) {
                    (true, Some(b',')) | (false, Some(b'=')) => i = inner_blanks(i + 1),
                    (false, _) if i > key_end => {}
                    _ => return None,
                }
                let (x, end) = plain_number(self.text, i)?;
                i = end;
                if is(i, |b| is_label(b) || b == b'.') {
                    return None;
                }
                x
            }
        };
        // An element has no text, and a line under `$onDelim` ends behind its number.
        if delimited {
            i = inner_blanks(i);
        }
        let ends = match (self.kind, delimited) {
            (DataKind::Values, false) => true,
            (_, true) => bytes.get(i) == Some(&b'\n'),
            (_, false) => is(i, |b| matches!(b, b'\n' | b',')),
        };
        ends.then(|| {
            self.at = i;
            (x, self.span(start, i))
        })
    }

    /// Text that is read soon and was not given yet; None most of the time.
    pub fn ahead(&mut self) -> Option<&'a str> {
        if self.at < self.shown {
            return None;
        }
        let bytes = self.text.as_bytes();
        let least = (self.at + AHEAD).min(bytes.len());
        let line = memchr::memchr(b'\n', &bytes[least..]);
        self.shown = line.map_or(bytes.len(), |n| least + n + 1);
        self.text.get(self.at..self.shown)
    }
}

/// The end of the label at `from`, in quotes or not; None where it needs a second look.
pub(in crate::syntax) fn plain_label(bytes: &[u8], from: usize, delimited: bool) -> Option<usize> {
    let &first = bytes.get(from)?;
    if matches!(first, b'\'' | b'"') {
        let n = memchr::memchr2(first, b'\n', &bytes[from + 1..])?;
        let closed = bytes[from + 1 + n] == first && n > 0;
        return closed.then_some(from + n + 2);
    }
    let len = bytes[from..]
        .iter()
        .take_while(|b| LABEL[**b as usize])
        .count();
    let word = &bytes[from..from + len];
    let signed = matches!(first, b'-' | b'+');
    let special = signed || len == 3 && word.eq_ignore_ascii_case(b"set");
    (len > 0 && (delimited || !special)).then_some(from + len)
}

/// The number at `from`, with a minus before it perhaps, and its end; None where it needs a second look.
#[inline]
pub(in crate::syntax) fn plain_number(text: &str, from: usize) -> Option<(f64, usize)> {
    let bytes = text.as_bytes();
    let minus = bytes.get(from) == Some(&b'-');
    let digits = from + usize::from(minus);
    if !bytes.get(digits)?.is_ascii_digit() {
        return None;
    }
    if let Some((x, n)) = short_decimal(&bytes[digits..]) {
        return Some((if minus { -x } else { x }, digits + n));
    }
    let (x, n) = fast_float2::parse_partial::<f64, _>(&bytes[digits..]).ok()?;
    let end = digits + n;
    Some((ordinary(x, minus, &text[digits..end]), end))
}

/// Powers of ten that are exact.
const TENS: [f64; 16] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
];

/// A number of up to fifteen digits without an exponent, and its length, in half of the library's time: digits and
/// power of ten are exact, so that one division rounds correctly.
#[inline]
fn short_decimal(bytes: &[u8]) -> Option<(f64, usize)> {
    let digits = |from: usize, mut all: u64| {
        let mut i = from;
        while let Some(d @ b'0'..=b'9') = bytes.get(i) {
            all = all.wrapping_mul(10).wrapping_add(u64::from(d - b'0'));
            i += 1;
        }
        (all, i)
    };
    let (mut all, whole) = digits(0, 0);
    let (mut end, mut decimals) = (whole, 0);
    if bytes.get(whole) == Some(&b'.') {
        (all, end) = digits(whole + 1, all);
        decimals = end - whole - 1;
        if decimals == 0 {
            return None;
        }
    }
    if whole + decimals > 15 || matches!(bytes.get(end), Some(b'e' | b'E')) {
        return None;
    }
    Some((all as f64 / TENS[decimals], end))
}
