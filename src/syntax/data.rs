//! Data between slashes: `/ a 1, (b,c).d -3.5, e*h inf, 'x y' some text /`.
//!
//! [`DataReader`] reads one record at a time and borrows from the text: on the simple path (labels,
//! dots, a number) nothing is allocated. What a label means, and whether it is known, is for the
//! caller to say.
//!
//! Invariants: every record has a key with at least one part, except a bare number (`/ 5 /`); the
//! reader always advances, so it ends on any text.

use std::borrow::Cow;

use self::plain::Gap;
use super::constants::Constants;
use super::fields::{Fields, MARK, has_comma};
use crate::data::value::{EPS, NA, UNDF};
use crate::diag::Diagnostic;
use crate::source::{Known, Outcome, Span};

/// What the data belong to: only texts of sets are read to the end of the line.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum DataKind {
    /// Elements, perhaps with explanatory texts.
    #[default]
    Set,
    /// Keys with values; scalars; attributes of variables and equations.
    Values,
}

/// One position of a key.
#[derive(Clone, PartialEq, Debug)]
pub enum KeyPart<'a> {
    /// A label, or the attribute at the end of a variable's key.
    Label {
        /// Without quotes, as spelled.
        text: &'a str,
        /// Written in quotes.
        quoted: bool,
        /// Place.
        span: Span,
    },
    /// `a1*a9`
    Range {
        /// First label.
        from: &'a str,
        /// Last label.
        to: &'a str,
        /// Place.
        span: Span,
    },
    /// `#set` or `set.set`: all elements.
    AllOf {
        /// The set.
        set: &'a str,
        /// Place.
        span: Span,
    },
    /// `(a,b*d,e.f)`: each alternative is itself a key.
    Group(Vec<Vec<KeyPart<'a>>>),
    /// `*`
    Universe(Span),
    /// `key:key`: matched one by one instead of multiplied out.
    Matched(Vec<KeyPart<'a>>, Vec<KeyPart<'a>>),
    /// The number behind an alternative of a group, `a.(x 1, y 2)`: a factor of the record's value. It
    /// takes no position.
    Factor(f64),
}

/// What stands behind a key.
#[derive(Clone, PartialEq, Debug)]
pub enum Tail<'a> {
    /// Nothing.
    None,
    /// A number, with the special values of [`crate::data::value`]; `yes` is 1, `no` 0.
    Number(f64, Span),
    /// An explanatory text, quoted or not.
    Text(Cow<'a, str>, Span),
    /// Another word: an acronym.
    Name(&'a str, Span),
}

/// One record.
#[derive(Debug)]
pub struct Record<'r, 'a> {
    /// The parts between the dots; empty for a bare number.
    pub key: &'r [KeyPart<'a>],
    /// What follows.
    pub value: Tail<'a>,
    /// From the key to the value.
    pub span: Span,
}

/// Reads the records of one body.
#[derive(Default)]
pub struct DataReader<'a> {
    text: &'a str,
    base: u32,
    at: usize,
    kind: DataKind,
    /// `undf` may be written.
    undf: bool,
    /// Positions of a key, if known: then in `a .5` the number is not taken for a label.
    arity: usize,
    key: Vec<KeyPart<'a>>,
    /// The key has factors.
    factors: bool,
    /// What stands before the next record needs no comma, or its error is known.
    excused: bool,
    /// What [`DataReader::ahead`] has given ends here.
    shown: usize,
    constants: Constants,
}

/// Groups inside groups.
const DEEPEST: usize = 50;

/// Positions that the parts of a key take.
pub fn width(key: &[KeyPart<'_>]) -> usize {
    key.iter()
        .map(|p| match p {
            KeyPart::Group(g) => g.first().map_or(1, |k| width(k)),
            KeyPart::Factor(_) => 0,
            KeyPart::Matched(a, b) => width(a) + width(b),
            _ => 1,
        })
        .sum()
}

/// Bytes of unquoted labels.
const fn is_label(b: u8) -> bool {
    b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-' | b'+') || b >= 0x80
}

pub(super) fn is_space(b: u8) -> bool {
    matches!(b, b' ' | b'\t' | b'\r' | b'\n' | 0x0c | 0x0b | 0x1a)
}

impl<'a> DataReader<'a> {
    /// `text` is the body, without its slashes, and begins at `base` in the expanded text.
    pub fn new(text: &'a str, base: u32, kind: DataKind, undf: bool) -> Self {
        Self {
            text,
            base,
            kind,
            undf,
            arity: usize::MAX,
            ..Self::default()
        }
    }

    /// Constant expressions in the text stand for their values.
    pub fn with_constants(mut self, known: &dyn Known) -> Self {
        self.constants = Constants::of(self.text, self.base, known);
        self
    }

    /// Keys have this many positions: what follows them is a value, also if it begins with a dot.
    pub fn with_arity(mut self, positions: usize) -> Self {
        self.arity = positions;
        self
    }

    pub(super) fn set_arity(&mut self, positions: usize) {
        self.arity = positions;
    }

    /// Goes on with another text.
    pub(super) fn restart(&mut self, text: &'a str, base: u32) {
        self.text = text;
        self.base = base;
        self.at = 0;
    }

    /// Bytes read so far.
    pub(super) fn position(&self) -> usize {
        self.at
    }

    /// Passes over blanks; false at the end of the text.
    pub(super) fn more(&mut self) -> bool {
        self.blanks(true);
        self.at < self.text.len()
    }

    fn span(&self, lo: usize, hi: usize) -> Span {
        Span::new(self.base + lo as u32, self.base + hi as u32)
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Passes over blanks; over line ends too if `lines`.
    fn blanks(&mut self, lines: bool) {
        let bytes = self.text.as_bytes();
        while let Some(&b) = bytes.get(self.at) {
            if is_space(b) && (lines || b != b'\n') {
                self.at += 1;
            } else {
                break;
            }
        }
    }

    /// The next record. After an error, reading goes on behind the next comma or line end.
    #[allow(clippy::should_implement_trait)]
    pub fn next(&mut self) -> Option<Result<Record<'_, 'a>, Diagnostic>> {
        let (start, outcome) = loop {
            let gap = Gap::at(self.text.as_bytes(), self.at);
            if !std::mem::take(&mut self.excused)
                && let Some((at, message)) = gap.problem()
            {
                // The record behind it is read by the next call.
                self.excused = true;
                let help = match self.text.as_bytes().get(at) {
                    Some(b'%') => "write 15 percent as `0.15`",
                    _ => "records are separated by one comma or a line end",
                };
                return Some(Err(self.error("E0248", at, at + 1, message).help(help)));
            }
            self.at = gap.end;
            let start = self.at;
            self.key.clear();
            match self.peek()? {
                MARK => {
                    let (lo, hi) = self.marked_line();
                    // Without a comma it is a record like any other.
                    if has_comma(&self.text[lo..hi])
                        || self.lone_label(lo, hi)
                        || self.only_fields(lo, hi)
                    {
                        if let Some(outcome) = self.delimited() {
                            break (start, outcome);
                        }
                    } else {
                        self.at = lo;
                        self.excused = true;
                    }
                }
                _ => break (start, self.record(start)),
            }
        };
        match outcome {
            Ok(value) => {
                let span = self.span(start, self.at);
                Some(Ok(Record {
                    key: &self.key,
                    value,
                    span,
                }))
            }
            Err(d) => {
                let bytes = self.text.as_bytes();
                let from = self.at.max(start + 1).min(bytes.len());
                self.at =
                    memchr::memchr2(b',', b'\n', &bytes[from..]).map_or(bytes.len(), |n| from + n);
                Some(Err(*d))
            }
        }
    }

    /// A line under `$onDelim`: labels, then the value or the text, with commas between. None: empty.
    fn delimited(&mut self) -> Option<Outcome<Tail<'a>>> {
        let (lo, hi) = self.marked_line();
        self.at = hi;
        let mut fields = Fields::new(self.text, lo, hi).peekable();
        fields.peek()?;
        let arity = match self.arity {
            usize::MAX => 1,
            known => known,
        };
        for _ in 0..arity {
            let Some((from, to)) = fields.next() else {
                return Some(Err(self.expected("a comma and a further label", hi)));
            };
            self.key.push(self.field_label(from, to));
        }
        let Some((from, to)) = fields.next() else {
            return Some(Ok(Tail::None));
        };
        Some(match self.kind {
            DataKind::Values => self.field_value(from, to),
            DataKind::Set => {
                // A text without quotes runs to the end of the line.
                let quoted = matches!(self.text.as_bytes()[from - 1], b'\'' | b'"');
                let to = match quoted {
                    true => to,
                    false => from + self.text[from..hi].trim_end().len(),
                };
                let text = &self.text[from..to];
                match text.is_empty() {
                    true => Ok(Tail::None),
                    false => Ok(Tail::Text(Cow::Borrowed(text), self.span(from, to))),
                }
            }
        })
    }

    /// A line under `$onDelim` with one label: whatever stands in it.
    fn lone_label(&self, lo: usize, hi: usize) -> bool {
        let line = self.text[lo..hi].trim();
        self.arity <= 1 && !line.is_empty() && !line.contains([' ', '\t', '\'', '"'])
    }

    /// A line under `$onDelim` with blanks between all labels and the value: `a b 5`.
    fn only_fields(&self, lo: usize, hi: usize) -> bool {
        let mut fields = Fields::new(self.text, lo, hi);
        let labels = fields
            .by_ref()
            .take(self.arity)
            .map(|f| &self.text[f.0..f.1]);
        self.kind == DataKind::Values
            && (2..=20).contains(&self.arity)
            && labels.filter(|l| !l.contains(['.', '(', '#', '*'])).count() == self.arity
            && fields.count() == 1
    }

    /// Behind the mark of a line under `$onDelim`, up to its end.
    pub(super) fn marked_line(&self) -> (usize, usize) {
        let lo = self.at + 1;
        let bytes = self.text.as_bytes();
        let hi = memchr::memchr(b'\n', &bytes[lo..]).map_or(bytes.len(), |n| lo + n);
        (lo, hi)
    }

    pub(super) fn field_label(&self, from: usize, to: usize) -> KeyPart<'a> {
        KeyPart::Label {
            text: &self.text[from..to],
            quoted: true,
            span: self.span(from, to),
        }
    }

    /// A value between commas; nothing is 0.
    pub(super) fn field_value(&self, from: usize, to: usize) -> Outcome<Tail<'a>> {
        let text = &self.text[from..to];
        let span = self.span(from, to);
        if text.is_empty() {
            return Ok(Tail::Number(0.0, span));
        }
        match self.number_of(text) {
            Some(x) => Ok(Tail::Number(x, span)),
            None if text.bytes().all(is_label) => Ok(Tail::Name(text, span)),
            None => Diagnostic::error("E0245", span)
                .says(format!("`{text}` is not a number"))
                .help("under `$onDelim` the value stands behind the last comma")
                .refuse(),
        }
    }

    fn record(&mut self, start: usize) -> Outcome<Tail<'a>> {
        if self.kind == DataKind::Values {
            if let Some(value) = self.bare_number(start) {
                return Ok(value);
            }
            if matches!(self.peek(), Some(b'[' | b'{')) {
                return self.value();
            }
        }
        self.factors = false;
        let mut key = std::mem::take(&mut self.key);
        let outcome = self.whole_key(&mut key, 0);
        self.key = key;
        outcome?;
        match self.kind {
            DataKind::Set => self.element_text(),
            // Factors are value enough.
            DataKind::Values => Ok(match self.value()? {
                Tail::None if self.factors => Tail::Number(1.0, self.span(start, self.at)),
                value => value,
            }),
        }
    }

    /// `5` alone: a scalar's value. Numbers may be labels too, so nothing else may stand there.
    fn bare_number(&mut self, start: usize) -> Option<Tail<'a>> {
        let text = self.text[start..].trim_end_matches(|c: char| c.is_ascii() && is_space(c as u8));
        if text.len() > 40 || !self.text.as_bytes()[..start].iter().all(|b| is_space(*b)) {
            return None;
        }
        let x = match text
            .strip_prefix(['-', '+'])
            .filter(|t| t.starts_with([' ', '\t']))
        {
            // `- 5`
            Some(unsigned) => {
                self.number_of(&format!("{}{}", &text[..1], unsigned.trim_start()))?
            }
            None => self.number_of(text)?,
        };
        self.at = start + text.len();
        Some(Tail::Number(x, self.span(start, self.at)))
    }

    /// The value of a text that is a number and nothing else.
    fn number_of(&self, text: &str) -> Option<f64> {
        let unsigned = text.strip_prefix(['-', '+']).unwrap_or(text);
        let minus = text.starts_with('-');
        let first = *unsigned.as_bytes().first()?;
        if first.is_ascii_digit() || first == b'.' {
            let x = fast_float2::parse::<f64, _>(unsigned).ok()?;
            return Some(ordinary(x, minus, unsigned));
        }
        if unsigned.len() > 4 {
            return None;
        }
        let x = match unsigned.to_ascii_lowercase().as_str() {
            "inf" => {
                return Some(if minus {
                    f64::NEG_INFINITY
                } else {
                    f64::INFINITY
                });
            }
            "eps" => EPS,
            "na" => NA,
            "undf" if self.undf => UNDF,
            "yes" => 1.0,
            "no" => 0.0,
            _ => return None,
        };
        Some(x)
    }

    pub(super) fn key_parts(&mut self, key: &mut Vec<KeyPart<'a>>, depth: usize) -> Outcome<()> {
        loop {
            let part = self.key_part(depth)?;
            key.push(part);
            // A dot, with blanks around it, goes on.
            let before = self.at;
            self.blanks(false);
            if self.peek() != Some(b'.') || depth == 0 && self.is_fraction(before, key) {
                self.at = before;
                return Ok(());
            }
            self.at += 1;
            self.blanks(true);
        }
    }

    /// `r1 .5`: the dot begins a number when the key is complete.
    fn is_fraction(&self, before: usize, key: &[KeyPart<'a>]) -> bool {
        self.at > before
            && self
                .text
                .as_bytes()
                .get(self.at + 1)
                .is_some_and(u8::is_ascii_digit)
            && width(key) >= self.arity
    }

    fn key_part(&mut self, depth: usize) -> Outcome<KeyPart<'a>> {
        let start = self.at;
        match self.peek() {
            Some(b'(') => self.group(depth),
            Some(b'#') => {
                self.at += 1;
                self.blanks(false);
                let from = self.at;
                let set = self.word();
                if set.is_empty() {
                    return Err(self.expected("the name of a set", from));
                }
                Ok(KeyPart::AllOf {
                    set,
                    span: self.span(start, self.at),
                })
            }
            Some(b'*') => {
                self.at += 1;
                Ok(KeyPart::Universe(self.span(start, self.at)))
            }
            // `set#i` is `#i`.
            Some(b's' | b'S') if self.rest_begins("set#") => {
                self.at += 3;
                self.key_part(depth)
            }
            _ => {
                let (text, quoted) = self.label()?;
                let end = self.at;
                self.blanks(false);
                if self.peek() == Some(b'*') {
                    self.at += 1;
                    self.blanks(true);
                    let (to, _) = self.label()?;
                    return Ok(KeyPart::Range {
                        from: text,
                        to,
                        span: self.span(start, self.at),
                    });
                }
                // `set.set` stands for all elements of the set.
                self.at = end;
                if !quoted && let Some(len) = set_suffix(&self.text.as_bytes()[end..]) {
                    self.at = end + len;
                    return Ok(KeyPart::AllOf {
                        set: text,
                        span: self.span(start, self.at),
                    });
                }
                Ok(KeyPart::Label {
                    text,
                    quoted,
                    span: self.span(start, end),
                })
            }
        }
    }

    /// The parts of a key, and what is matched with them behind a colon.
    fn whole_key(&mut self, key: &mut Vec<KeyPart<'a>>, depth: usize) -> Outcome<()> {
        self.key_parts(key, depth)?;
        self.blanks(false);
        if self.peek() == Some(b':') {
            self.at += 1;
            self.blanks(false);
            let mut other = Vec::new();
            self.key_parts(&mut other, depth)?;
            self.blanks(false);
            let first = std::mem::take(key);
            key.push(KeyPart::Matched(first, other));
        }
        Ok(())
    }

    fn rest_begins(&self, word: &str) -> bool {
        let rest = self.text.as_bytes().get(self.at..self.at + word.len());
        rest.is_some_and(|rest| rest.eq_ignore_ascii_case(word.as_bytes()))
    }

    fn group(&mut self, depth: usize) -> Outcome<KeyPart<'a>> {
        let open = self.at;
        if depth >= DEEPEST {
            let message = "groups of labels are nested too deeply";
            return Err(self.error("E0244", open, open + 1, message));
        }
        self.at += 1;
        let mut list = Vec::new();
        // A comma or a line end stands between two alternatives.
        let mut between = true;
        loop {
            let before = self.at;
            self.blanks(true);
            let line_end = self.text[before..self.at].contains('\n');
            match self.peek() {
                Some(b')') if list.is_empty() || !between => {
                    self.at += 1;
                    return Ok(KeyPart::Group(list));
                }
                Some(b',') if !between => {
                    self.at += 1;
                    between = true;
                }
                Some(b',' | b')') => return Err(self.expected("a label", self.at)),
                Some(_) if !between && !line_end => {
                    return Err(self.expected("a comma or `)`", self.at));
                }
                Some(_) => {
                    between = false;
                    let mut key = Vec::new();
                    self.whole_key(&mut key, depth + 1)?;
                    if self.kind == DataKind::Values
                        && !matches!(self.peek(), None | Some(b',' | b')' | b'\n'))
                    {
                        let at = self.at;
                        let Tail::Number(x, _) = self.value()? else {
                            return Err(self.expected("a number", at));
                        };
                        key.push(KeyPart::Factor(x));
                        self.factors = true;
                    }
                    list.push(key);
                }
                None => {
                    let message = "this group of labels is not closed by `)`";
                    return Err(self.error("E0241", open, open + 1, message));
                }
            }
        }
    }

    fn word(&mut self) -> &'a str {
        let bytes = self.text.as_bytes();
        let start = self.at;
        while self.at < bytes.len()
            && (bytes[self.at].is_ascii_alphanumeric() || bytes[self.at] == b'_')
        {
            self.at += 1;
        }
        &self.text[start..self.at]
    }

    fn label(&mut self) -> Outcome<(&'a str, bool)> {
        let bytes = self.text.as_bytes();
        let start = self.at;
        match bytes.get(start) {
            Some(&q @ (b'\'' | b'"')) => {
                let rest = &bytes[start + 1..];
                match memchr::memchr2(q, b'\n', rest) {
                    Some(n) if rest[n] == q => {
                        self.at = start + n + 2;
                        Ok((&self.text[start + 1..start + 1 + n], true))
                    }
                    _ => Err(Box::new(
                        self.error("E0242", start, start + 1, "this quote is not closed on its line")
                            .help("a label or text stands between two quotes of one kind; no sign parts thousands"),
                    )),
                }
            }
            _ => {
                let mut i = start;
                while i < bytes.len() && is_label(bytes[i]) {
                    i += 1;
                }
                if i == start || matches!(bytes[start], b'-' | b'+') {
                    return Err(self.expected("a label", start));
                }
                self.at = i;
                Ok((&self.text[start..i], false))
            }
        }
    }

    /// An element's text: quoted, or to the comma or the end of the line.
    fn element_text(&mut self) -> Outcome<Tail<'a>> {
        let bytes = self.text.as_bytes();
        let start = self.at;
        let mut from = start;
        if bytes.get(from) == Some(&b'=') {
            from += 1;
            self.at = from;
            self.blanks(false);
            from = self.at;
        }
        match bytes.get(from) {
            None | Some(b',' | b'\n') => Ok(Tail::None),
            Some(b'\'' | b'"') => {
                self.at = from;
                let (text, _) = self.label()?;
                Ok(Tail::Text(Cow::Borrowed(text), self.span(from, self.at)))
            }
            Some(_) => {
                if from == start && start > 0 && !is_space(bytes[start - 1]) {
                    let len = self.text[start..].chars().next().map_or(1, char::len_utf8);
                    let sign = &self.text[start..start + len];
                    return Diagnostic::error("E0243", self.span(start, start + len))
                        .says(format!("`{sign}` cannot stand in a label without quotes"))
                        .help("put the label in quotes, or a blank before the text")
                        .refuse();
                }
                let end =
                    memchr::memchr2(b',', b'\n', &bytes[from..]).map_or(bytes.len(), |n| from + n);
                let text = self.text[from..end].trim_end();
                self.at = from + text.len();
                Ok(Tail::Text(Cow::Borrowed(text), self.span(from, self.at)))
            }
        }
    }

    pub(super) fn value(&mut self) -> Outcome<Tail<'a>> {
        // The value may stand on the next line.
        self.blanks(true);
        let bytes = self.text.as_bytes();
        if self.peek() == Some(b'=') {
            self.at += 1;
            self.blanks(true);
        }
        let start = self.at;
        let Some(&b) = bytes.get(start) else {
            return Ok(Tail::None);
        };
        match b {
            b',' => return Ok(Tail::None),
            b'\'' | b'"' => {
                let (text, _) = self.label()?;
                return Ok(Tail::Text(Cow::Borrowed(text), self.span(start, self.at)));
            }
            b'[' | b'{' => {
                let base = self.base as usize;
                if let Some(constant) = self.constants.at(base + start) {
                    let (x, end) = constant?;
                    let end = end - base;
                    self.at = end;
                    return Ok(Tail::Number(x, self.span(start, end)));
                }
            }
            _ => {}
        }
        let mut i = start;
        if matches!(b, b'-' | b'+') {
            i += 1;
            while i < bytes.len() && matches!(bytes[i], b' ' | b'\t') {
                i += 1;
            }
        }
        let minus = b == b'-';
        let first = bytes.get(i).copied().unwrap_or(0);
        if first.is_ascii_digit() || first == b'.' {
            let Ok((x, n)) = fast_float2::parse_partial::<f64, _>(&bytes[i..]) else {
                return Err(self.expected("a number", start));
            };
            let end = i + n;
            let after = bytes.get(end).copied().unwrap_or(b' ');
            if n == 0 || is_label(after) && !matches!(after, b'+' | b'-') || after == b'.' {
                let mut end = end.max(i + 1);
                while end < bytes.len() && (is_label(bytes[end]) || bytes[end] == b'.') {
                    end += 1;
                }
                return Diagnostic::error("E0245", self.span(start, end))
                    .says(format!("`{}` is not a number", &self.text[start..end]))
                    .help("numbers look like `12`, `-3.5`, `1.5e-3`; a comma or a line end comes before the next record")
                    .refuse();
            }
            self.at = end;
            let x = ordinary(x, minus, &self.text[i..end]);
            return Ok(Tail::Number(x, self.span(start, end)));
        }
        let word_start = i;
        self.at = i;
        let word = self.word();
        if word.is_empty() {
            self.at = start;
            return Err(self.expected("a value", start));
        }
        let signed;
        let spelled = if word_start > start {
            signed = format!("{}{word}", b as char);
            signed.as_str()
        } else {
            word
        };
        let span = self.span(start, self.at);
        match self.number_of(spelled) {
            Some(x) => Ok(Tail::Number(x, span)),
            None if word.eq_ignore_ascii_case("undf") => Err(Box::new(undf_refused(span))),
            None if word_start == start => Ok(Tail::Name(word, span)),
            None => Err(self.expected("a number", start)),
        }
    }

    fn error(
        &self,
        code: &'static str,
        lo: usize,
        hi: usize,
        message: impl Into<String>,
    ) -> Box<Diagnostic> {
        Box::new(Diagnostic::error(code, self.span(lo, hi.min(self.text.len()))).says(message))
    }

    fn expected(&self, what: &str, at: usize) -> Box<Diagnostic> {
        let rest = self.text.get(at..).unwrap_or("");
        let found = rest.chars().next();
        let len = found.map_or(0, char::len_utf8);
        let message = match found {
            None => format!("{what} was expected before the closing `/`"),
            Some('\n') => format!("{what} was expected before the end of the line"),
            Some(';') => format!("{what} was expected here, not `;`"),
            Some(c) => format!("{what} was expected here, not `{c}`"),
        };
        let d = Diagnostic::error("E0243", self.span(at, at + len)).says(message);
        Box::new(match found {
            Some(';') => d.help("is the closing `/` of these data missing?"),
            Some('.') => d.help("a range of labels is written `1*5`; a number begins with a digit or with `.` and a digit"),
            Some('%') => d.help("write 15 percent as `0.15`"),
            Some('$' | '€' | '£') => d.help("numbers stand without a unit"),
            Some(',') => d.help("a comma stands between two records; between the columns of a table stand blanks, or commas behind `$onDelim`"),
            Some('|') => d.help("blanks stand between the columns of a table, and no lines"),
            Some('-') if rest.starts_with("->") => d.help("a blank stands between a label and its number: `/ a 1, b 2 /`"),
            Some('^' | '*') => d.help("powers of ten are written with `e`: `1.5e3`"),
            Some('-') => d.help("blanks stand between the columns of a table, and no lines; a label that begins with `-` stands in quotes"),
            _ => d.help(
                "labels with other signs than letters, digits, `_`, `-`, `+` stand in quotes",
            ),
        })
    }
}

/// Numbers as large are `undf` where they are written, as small ones `eps`.
pub(super) const LARGE: f64 = 1e300;
pub(super) const TINY: f64 = 1e-299;

/// The value of a number behind its sign: too large is `undf`, or the least number there is; too small is `eps`.
#[inline]
fn ordinary(x: f64, minus: bool, digits: &str) -> f64 {
    if x >= LARGE {
        if minus { -LARGE } else { UNDF }
    } else if x == 0.0 && is_tiny(digits) || x > 0.0 && x <= TINY {
        EPS
    } else if minus {
        -x
    } else {
        x
    }
}

/// Whether a number's digits are not all zero: then 0 is too small a number.
fn is_tiny(text: &str) -> bool {
    text.bytes()
        .take_while(|b| !matches!(b, b'e' | b'E'))
        .any(|b| (b'1'..=b'9').contains(&b))
}

/// Length of `.set` at the start, if it stands there.
fn set_suffix(bytes: &[u8]) -> Option<usize> {
    let s = bytes.get(..4)?;
    // In `a.set.j` the word belongs to what follows.
    let ends = !bytes.get(4).is_some_and(|b| is_label(*b) || *b == b'.');
    (s.eq_ignore_ascii_case(b".set") && ends).then_some(4)
}

/// `undf` stands in data without `$onUndf`.
pub fn undf_refused(span: Span) -> Diagnostic {
    Diagnostic::error("E0246", span)
        .says("`undf` may be written only after `$onUndf`")
        .help("for a missing value write `na`")
}

mod plain;
pub use plain::likely_labels;
pub(super) use plain::{plain_label, plain_number};
#[cfg(test)]
mod tests;
