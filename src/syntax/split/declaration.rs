//! Declarations: names, domains, explanatory texts, data between slashes, and the lines of tables.

use super::{Declare, Hole, HoleKind, Splitter, span};
use crate::diag::Diagnostic;
use crate::source::{Span, quoted_end};
use crate::syntax::constants::end_of_constant;
use crate::syntax::words::{self, Class, Word};

impl Splitter {
    pub(super) fn declaration(&mut self, text: &str) -> bool {
        let bytes = text.as_bytes();
        loop {
            match self.declare {
                Declare::Body => {
                    if !self.body(text) {
                        return false;
                    }
                    if self.start.is_some() && self.problems.iter().any(|p| p.code == "E0203") {
                        return true;
                    }
                    continue;
                }
                Declare::Table => return self.table(text),
                _ => {}
            }
            let i = self.pos;
            let Some(&b) = bytes.get(i) else { return false };
            match b {
                b' ' | b'\t' | b'\r' => {
                    self.pos += 1;
                    continue;
                }
                b'\n' => {
                    self.pos += 1;
                    self.new_line = true;
                    let named = matches!(self.declare, Declare::AfterName | Declare::AfterText);
                    if named && self.class == Class::Table {
                        self.begin_table(i);
                    } else if named {
                        self.declare = Declare::AfterText;
                    }
                    continue;
                }
                b'$' if i > 0 && bytes[i - 1] == b'\n' => return true,
                _ => {}
            }
            if self.declare == Declare::Domain {
                match b {
                    b')' | b']' | b'}' => self.declare = Declare::AfterName,
                    b';' => {
                        // The parser says what is missing.
                        self.pos += 1;
                        return true;
                    }
                    _ => {}
                }
                self.read_to(quoted_end(bytes, i).unwrap_or(i + 1));
                continue;
            }
            match b {
                b';' => {
                    self.trailing_comma();
                    self.pos += 1;
                    return true;
                }
                b',' => {
                    if self.declare == Declare::Name {
                        let message = "a name was expected here, not `,`";
                        self.stray(i, i + 1, message, "one comma stands between two names");
                    }
                    self.declare = Declare::Name;
                    self.read_to(i + 1);
                }
                b'/' if self.class == Class::Acronym => self.read_to(i + 1),
                b'/' => {
                    if self.class == Class::Table && self.declare != Declare::Name {
                        let help = "leave both out: the labels of the columns stand in the next line, and `;` ends the last row";
                        self.stray(i, i + 1, "a table has no slashes", help);
                    }
                    self.declare = Declare::Body;
                    self.body_start = i + 1;
                    self.searched = i + 1;
                    self.pos = i + 1;
                }
                b'(' | b'[' | b'{' if self.declare != Declare::Name && !self.has_domain(bytes) => {
                    self.declare = Declare::Domain;
                    self.read_to(i + 1);
                }
                b'\'' | b'"'
                    if self.declare == Declare::Name
                        && self.class != Class::File
                        && line_quote(bytes, i).is_some() =>
                {
                    let end = line_quote(bytes, i).unwrap_or(i + 1);
                    self.problems.push(
                        Diagnostic::error("E0220", span(i, end))
                            .says("the name stands before its text")
                            .help("write `set i 'plants' / a, b /;`, `parameter p(i) 'price';`"),
                    );
                    self.read_to(end);
                }
                b'{' if self.declare == Declare::AfterText
                    && memchr::memchr(b'}', &bytes[i..]).is_some() =>
                {
                    self.problems.push(
                        Diagnostic::error("E0220", span(i, i + 1))
                            .says("data stand between two slashes")
                            .help("write `/ a 1, b 2 /`"),
                    );
                    self.read_to(i + memchr::memchr(b'}', &bytes[i..]).map_or(1, |n| n + 1));
                }
                b'\'' | b'"' if self.declare != Declare::Name => match line_quote(bytes, i) {
                    Some(end) => {
                        self.hole(HoleKind::Text, span(i + 1, end - 1), span(i, end));
                        self.read_to(end);
                        self.declare = Declare::AfterText;
                        self.new_line = false;
                    }
                    None => {
                        self.problems.push(unclosed_quote(i));
                        self.unquoted_text(text, i)
                    }
                },
                _ if self.declare == Declare::AfterName && !text_cannot_start(bytes, i) => {
                    if i == self.last_end {
                        let (message, help) = match b {
                            b'(' | b'[' | b'{' => (
                                "all indices stand in one pair of parentheses",
                                "write `p(i,j)`",
                            ),
                            _ => (
                                "a blank is missing before the text",
                                "or is this a sign too many?",
                            ),
                        };
                        self.stray(i, i + 1, message, help);
                    }
                    self.unquoted_text(text, i)
                }
                _ if words::is_letter(b) => {
                    let end = words::word_end(bytes, i);
                    if words::statement_word(text, i, end).is_some() {
                        // A keyword: the next statement.
                        self.trailing_comma();
                        return true;
                    }
                    if self.declare == Declare::AfterText && !self.new_line && self.names > 0 {
                        if let Some((body, next)) = self.swallowed_declaration(text) {
                            self.unclosed_body(text, body, next);
                            self.pos = next;
                            return true;
                        }
                        let message = "a comma is missing before this name";
                        self.stray(i, end, message, "on one line commas stand between names");
                    }
                    self.name(bytes, i, end);
                }
                b'.' | b'=' | b'$' | b':'
                    if self.declare == Declare::AfterText || self.declare == Declare::AfterName =>
                {
                    if self.missing_semicolon(text, i) {
                        return true;
                    }
                    if b == b'=' && !matches!(self.class, Class::File | Class::Model) {
                        // No data follow; a `/` divides.
                        let end = memchr::memchr(b';', &bytes[i..]).map(|n| i + n);
                        let line =
                            memchr::memchr(b'\n', &bytes[i..]).map_or(bytes.len(), |n| i + n);
                        self.read_to(end.filter(|e| *e < line).unwrap_or(i + 1));
                        continue;
                    }
                    self.read_to(i + 1);
                }
                _ => self.read_to(i + text[i..].chars().next().map_or(1, char::len_utf8)),
            }
        }
    }

    /// Goes on at a byte: what stands before it counts.
    fn read_to(&mut self, at: usize) {
        self.pos = at;
        self.last_end = at;
    }

    /// Something that does not belong between the parts of a declaration; its names can be read.
    fn stray(&mut self, lo: usize, hi: usize, message: &str, help: &str) {
        self.problems.push(
            Diagnostic::error("E0223", span(lo, hi))
                .says(message)
                .help(help),
        );
    }

    /// The declaration ends: behind a comma a name is expected.
    fn trailing_comma(&mut self) {
        if self.declare == Declare::Name && self.names > 0 {
            let comma = self.last_end - 1;
            let message = "a name was expected behind this comma";
            self.stray(comma, comma + 1, message, "leave it out before the `;`");
        }
    }

    fn name(&mut self, bytes: &[u8], i: usize, end: usize) {
        self.last_name = i;
        self.names += 1;
        self.declare = Declare::AfterName;
        self.read_to(end);
        self.new_line = false;
        // `scalar x.l /1/`, `set i-j` and the like are left to the parser, in one piece.
        while let Some(&b) = bytes.get(self.pos) {
            if words::is_blank(b)
                || matches!(
                    b,
                    b',' | b';' | b'/' | b'(' | b'[' | b'{' | b'\'' | b'"' | b'=' | b'.' | b'$'
                )
            {
                break;
            }
            self.read_to(self.pos + 1);
        }
    }

    /// Between the last name and here stands a closed domain already.
    fn has_domain(&self, bytes: &[u8]) -> bool {
        matches!(
            bytes.get(self.last_end.wrapping_sub(1)),
            Some(b')' | b']' | b'}')
        ) || self.declare == Declare::AfterText && !self.new_line
    }

    fn hole(&mut self, kind: HoleKind, inside: Span, outside: Span) {
        self.holes.push(Hole {
            kind,
            inside,
            outside,
        });
    }

    /// A text without quotes: to the end of the line, `,`, `;`, or `/` where data may stand.
    fn unquoted_text(&mut self, text: &str, i: usize) {
        let bytes = text.as_bytes();
        let line = memchr::memchr(b'\n', &bytes[i..]).map_or(bytes.len(), |n| i + n);
        let data = if self.class == Class::Table {
            b','
        } else {
            b'/'
        };
        let end = memchr::memchr3(b',', data, b';', &bytes[i..line]).map_or(line, |n| i + n);
        let trimmed = i + text[i..end].trim_end().len();
        self.hole(HoleKind::Text, span(i, trimmed), span(i, trimmed));
        self.pos = end;
        self.last_end = trimmed;
        self.declare = Declare::AfterText;
        self.new_line = false;
    }

    /// `e..` or `x =` on a new line after a declaration: the `;` before it is missing.
    fn missing_semicolon(&mut self, text: &str, i: usize) -> bool {
        let bytes = text.as_bytes();
        let definition = bytes[i..].starts_with(b"..");
        let assignment = bytes[i] == b'='
            || bytes[i] == b':'
            || bytes[i] == b'$'
            || bytes[i] == b'.' && bytes.get(i + 1).is_some_and(|b| words::is_letter(*b));
        if !definition && !assignment || self.names < 2 {
            return false;
        }
        let line_start = memchr::memrchr(b'\n', &bytes[..self.last_name]).map_or(0, |n| n + 1);
        let first_on_line = bytes[line_start..self.last_name]
            .iter()
            .all(|b| words::is_blank(*b));
        let start = self.start.unwrap_or(0);
        if !first_on_line || line_start <= start {
            return false;
        }
        let before = text[start..self.last_name].trim_end_matches([' ', '\t', '\r', '\n']);
        let end = start + before.len();
        let name_end = words::word_end(bytes, self.last_name);
        self.problems.push(
            Diagnostic::error("E0201", span(end.saturating_sub(1).max(start), end))
                .says("`;` is missing at the end of this declaration")
                .label("missing `;`")
                .other(
                    span(self.last_name, name_end),
                    "the next statement begins here",
                ),
        );
        self.pos = self.last_name;
        self.last_end = end;
        true
    }

    /// Inside `/ … /`. True once it is closed.
    fn body(&mut self, text: &str) -> bool {
        let bytes = text.as_bytes();
        let mut i = self.pos;
        loop {
            let Some(n) = memchr::memchr3(b'/', b'\'', b'"', &bytes[i..]) else {
                i = bytes.len();
                break;
            };
            let at = i + n;
            if bytes[at] == b'/' {
                if not_available(bytes, at) {
                    i = at + 1;
                    continue;
                }
                if self.class.has_values()
                    && let Some(end) = end_of_constant(bytes, self.body_start, at)
                {
                    i = end;
                    continue;
                }
                // A `;` in numbers, or before a keyword: the slash was forgotten.
                if self.ends_unclosed(text, at) {
                    return true;
                }
                let body = span(self.body_start, at);
                if self.class == Class::File
                    && let Some(quote) = lone_quote(&text[self.body_start..at])
                {
                    self.problems.push(unclosed_quote(self.body_start + quote));
                }
                // The grammar reads a model's list.
                if self.class != Class::Model {
                    self.hole(HoleKind::Body, body, span(self.body_start - 1, at + 1));
                }
                self.read_to(at + 1);
                self.declare = Declare::AfterText;
                self.new_line = false;
                return true;
            }
            i = quoted_end(bytes, at).unwrap_or(at + 1);
        }
        if self.ends_unclosed(text, i) {
            return true;
        }
        self.pos = i;
        false
    }

    /// Whether data are left behind that no slash closes: where the next statement begins, or at its `;`.
    fn ends_unclosed(&mut self, text: &str, to: usize) -> bool {
        let Some(stop) = self.forgotten_slash(text, to) else {
            return false;
        };
        self.unclosed_body(text, self.body_start, stop);
        self.pos = next_declaration(text, self.body_start, stop).unwrap_or(stop + 1);
        true
    }

    /// Data whose slash was forgotten, and the declaration whose slash was taken for it.
    fn swallowed_declaration(&self, text: &str) -> Option<(usize, usize)> {
        let data = self
            .holes
            .last()
            .filter(|h| h.kind == HoleKind::Body)?
            .inside;
        let (from, to) = (data.lo as usize, data.hi as usize);
        Some((from, next_declaration(text, from, to)?))
    }

    /// The `;` that ends the statement inside data, if one does.
    fn forgotten_slash(&mut self, text: &str, to: usize) -> Option<usize> {
        let bytes = text.as_bytes();
        let from = self.body_start;
        let mut i = self.searched;
        self.searched = to;
        while let Some(n) = memchr::memchr(b';', &bytes[i..to]) {
            let at = i + n;
            i = at + 1;
            let line = memchr::memrchr(b'\n', &bytes[..at])
                .map_or(0, |n| n + 1)
                .max(from);
            let mut q = line;
            let mut quoted = false;
            while q < at {
                match quoted_end(bytes, q) {
                    Some(end) if end > at => {
                        quoted = true;
                        break;
                    }
                    Some(end) => q = end,
                    None => q += 1,
                }
            }
            if quoted {
                continue;
            }
            if self.class != Class::Set {
                if separates_records(&text[at + 1..]) {
                    if self.problems.is_empty() {
                        self.problems.push(
                            Diagnostic::error("E0248", span(at, at + 1))
                                .says("`;` ends a statement; it cannot stand between records")
                                .help("write a comma or a line end between records, a blank between a label and its number"),
                        );
                    }
                    continue;
                }
                return Some(at);
            }
            // In a set it may belong to a text: only a statement after it tells.
            let rest = text[at + 1..to].trim_start();
            if rest.is_empty() {
                // More text may come.
                self.searched = at;
                return None;
            }
            let word_at = to - rest.len();
            let end = words::word_end(bytes, word_at);
            if end > word_at && words::statement_word(text, word_at, end).is_some() {
                return Some(at);
            }
        }
        None
    }

    fn begin_table(&mut self, at: usize) {
        self.declare = Declare::Table;
        self.body_start = at;
        self.pos = at;
    }

    pub(super) fn end_table(&mut self, bytes: &[u8], end: usize) {
        let end = end.max(self.body_start);
        let trimmed = bytes[self.body_start..end]
            .iter()
            .rposition(|b| !words::is_blank(*b))
            .map_or(self.body_start, |n| self.body_start + n + 1);
        let body = span(self.body_start, trimmed);
        self.hole(HoleKind::Body, body, body);
        self.last_end = trimmed;
    }

    /// In the lines of a table, up to `;` or a line that begins with a statement's keyword.
    fn table(&mut self, text: &str) -> bool {
        let bytes = text.as_bytes();
        let next_mark = |from: usize| {
            memchr::memchr3(b';', b'\'', b'"', &bytes[from..]).map_or(bytes.len(), |n| from + n)
        };
        let mut at = next_mark(self.pos);
        while self.pos < bytes.len() {
            let line = self.pos;
            let end = memchr::memchr(b'\n', &bytes[line..]).map_or(bytes.len(), |n| line + n + 1);
            if line > self.body_start {
                if bytes[line] == b'$' {
                    self.end_table(bytes, line);
                    return true;
                }
                let first = line
                    + bytes[line..end]
                        .iter()
                        .take_while(|b| words::is_blank(**b))
                        .count();
                if first < end && bytes[first].is_ascii_alphabetic() {
                    let word_end = words::word_end(bytes, first);
                    if words::begins_statement_in_table(text, first, word_end) {
                        self.end_table(bytes, line);
                        self.pos = first;
                        return true;
                    }
                }
            }
            while at < end {
                if bytes[at] == b';'
                    && memchr::memchr_iter(b';', &bytes[at..end]).count() > 1
                    && !text[line..end].contains('=')
                    && !begins_statement(text, at + 1)
                {
                    self.problems.push(
                        Diagnostic::error("E0248", span(at, at + 1))
                            .says("`;` ends a table; it cannot stand between its columns")
                            .help("lay the columns out with blanks; or replace `;` by `,` and write `$onDelim` before the table and `$offDelim` behind it"),
                    );
                    // To the line that ends it.
                    let rest = text[end..].split_inclusive('\n').scan(end, |to, l| {
                        *to += l.len();
                        Some((*to, l.trim()))
                    });
                    let last = rest.take_while(|(_, l)| *l != ";" && !l.is_empty()).last();
                    self.end_table(bytes, last.map_or(end, |(to, _)| to));
                    self.pos = self.last_end;
                    return true;
                }
                let rows: usize = match bytes[at] == b';' && text[at + 1..end].trim().is_empty() {
                    true => text[end..]
                        .split_inclusive('\n')
                        .take_while(|l| is_row(l))
                        .map(str::len)
                        .sum(),
                    false => 0,
                };
                if rows > 0 {
                    self.problems.push(
                        Diagnostic::error("E0248", span(at, at + 1))
                            .says("`;` ends a table; rows follow behind it")
                            .label("the table ends here")
                            .help("write `;` behind the last row only"),
                    );
                    self.end_table(bytes, end + rows);
                    self.pos = self.last_end;
                    return true;
                }
                if bytes[at] == b';' {
                    self.end_table(bytes, at);
                    self.pos = at + 1;
                    return true;
                }
                at = next_mark(quoted_end(bytes, at).unwrap_or(at + 1).min(end));
            }
            self.pos = end;
        }
        false
    }
}

/// `n/a`, as spreadsheets write it.
fn not_available(bytes: &[u8], at: usize) -> bool {
    let is = |k: usize, letter: u8| {
        bytes
            .get(k)
            .is_some_and(|b| b.eq_ignore_ascii_case(&letter))
    };
    at > 1
        && is(at - 1, b'n')
        && !bytes[at - 2].is_ascii_alphanumeric()
        && is(at + 1, b'a')
        && !bytes.get(at + 2).is_some_and(u8::is_ascii_alphanumeric)
}

/// A label and a number behind it, as the rows of a table begin.
fn is_row(line: &str) -> bool {
    let line = line.trim();
    let word = words::word_end(line.as_bytes(), 0);
    let number = line[word..]
        .trim_start()
        .trim_start_matches(['-', '+', '.']);
    word > 0
        && line[word..].starts_with([' ', '\t'])
        && number.starts_with(|c: char| c.is_ascii_digit())
        && words::statement_word(line, 0, word).is_none()
}

/// Whether a statement's keyword comes next.
fn begins_statement(text: &str, at: usize) -> bool {
    let bytes = text.as_bytes();
    let first = at
        + bytes[at..]
            .iter()
            .take_while(|b| words::is_blank(**b))
            .count();
    let end = words::word_end(bytes, first);
    end > first && words::statement_word(text, first, end).is_some()
}

/// Whether a `;` separates records, as in a file of a spreadsheet: text follows on its line, and the slash comes
/// before anything that only a statement has.
fn separates_records(text: &str) -> bool {
    let line = text.split('\n').next().unwrap_or("").trim();
    let Some(slash) = text.find('/') else {
        return false;
    };
    let between = &text[..slash];
    let word = words::word_end(line.as_bytes(), 0);
    // `a=1; b=2 /;`
    let records = between.split(';').all(|r| {
        r.split_once('=')
            .is_some_and(|(_, x)| x.trim().parse::<f64>().is_ok())
    }) && text[slash + 1..]
        .trim_start_matches([' ', '\t'])
        .starts_with([';', ',', '\n']);
    !line.is_empty()
        && !line.starts_with('/')
        && (records || !between.contains(['=', '\'', '"']))
        && words::statement_word(line, 0, word).is_none()
        && between.lines().all(|l| {
            let l = l.trim_start();
            words::statement_word(l, 0, words::word_end(l.as_bytes(), 0)).is_none()
        })
}

/// A text's quote that has no partner on its line.
fn unclosed_quote(at: usize) -> Diagnostic {
    Diagnostic::error("E0206", span(at, at + 1))
        .says("this quote is not closed on its line")
        .label("opened here")
        .help("a text stands between two quotes of one kind: `'text'`, `\"it's\"`")
}

/// The first line that begins a declaration: with its keyword, and a name behind.
fn next_declaration(text: &str, from: usize, to: usize) -> Option<usize> {
    let bytes = text.as_bytes();
    let ends = memchr::memchr_iter(b'\n', &bytes[from..to]).map(|n| from + n + 1);
    ends.map(|line| line + text[line..to].len() - text[line..to].trim_start().len())
        .find(|&at| {
            let end = words::word_end(bytes, at);
            let name = text[end..].trim_start_matches([' ', '\t']);
            words::statement_word(text, at, end) == Some(Word::Declaration)
                && name.starts_with(|c: char| c.is_alphabetic())
        })
}

/// A quote that begins a file's name and does not end it.
fn lone_quote(name: &str) -> Option<usize> {
    let inside = name.trim();
    let quote = inside.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    let closed = inside.len() > 1 && inside.ends_with(quote);
    (!closed).then(|| name.len() - name.trim_start().len())
}

/// The end of a quoted text that closes on its line.
fn line_quote(bytes: &[u8], i: usize) -> Option<usize> {
    let rest = &bytes[i + 1..];
    let n = memchr::memchr2(bytes[i], b'\n', rest)?;
    (rest[n] == bytes[i]).then_some(i + n + 2)
}

/// An explanatory text does not begin with `=`, `..` or `$`.
fn text_cannot_start(bytes: &[u8], i: usize) -> bool {
    match bytes[i] {
        b'=' | b'$' => true,
        b':' => bytes.get(i + 1) == Some(&b'='),
        b'.' => bytes.get(i + 1).is_some_and(|b| {
            *b == b'.' || words::is_letter(*b) && i > 0 && !words::is_blank(bytes[i - 1])
        }),
        _ => false,
    }
}
