//! Declarations, as the parser cuts them: names, domains, texts, data between slashes, lists of models, the lines of tables.

use super::{Class, LineKind, Role, Scanner, quoted_end, words};
use crate::source::Span;
use crate::syntax::split::{self, HoleKind};

/// What separates; other blanks of Unicode are part of a text.
const BLANKS: [char; 3] = [' ', '\t', '\r'];

impl Scanner<'_> {
    /// The declaration that begins at `i`, the words of its kind before `names`; where to read on.
    pub(super) fn declaration(&mut self, class: Class, i: usize, names: usize) -> usize {
        let bytes = self.code.as_bytes();
        // `positive variables`: each word by itself; they may stand on two lines.
        let mut at = i;
        while at < names {
            let to = words::word_end(bytes, at);
            match to == at {
                true => at += 1,
                false => drop(self.push(at, to, Role::Keyword)),
            }
            at = at.max(to);
        }
        let (Some(raw), mut next) = split::declaration(self.code, i) else {
            return self.code.len();
        };
        let mut end = (raw.span.hi as usize).min(next);
        let mut holes = raw.holes.iter().peekable();
        let (mut domain, mut list, mut closed) = (false, false, true);
        while at < end {
            let b = bytes[at];
            if words::is_blank(b) {
                at += 1;
                continue;
            }
            if let Some(h) = holes.next_if(|h| h.outside.lo as usize <= at) {
                at = h.outside.hi as usize;
                match h.kind {
                    HoleKind::Text => self.explanation(h.outside),
                    HoleKind::Body if h.inside == h.outside => {
                        let rows = self.code[h.inside.lo as usize..at].trim_start();
                        let first = at - rows.len();
                        // What follows a directive is no row.
                        let lines = &self.scan.lines;
                        let directive = (lines.line_of(first)..=lines.line_of(at))
                            .find(|&l| lines.kinds[l] == LineKind::Directive);
                        if let Some(line) = directive {
                            at = lines.starts[line];
                            (end, next) = (at, at);
                        }
                        self.table(first, at);
                    }
                    HoleKind::Body => {
                        self.push(h.outside.lo as usize, h.inside.lo as usize, Role::Slash);
                        self.body(class, h.inside.lo as usize, h.inside.hi as usize);
                        self.push(h.inside.hi as usize, at, Role::Slash);
                    }
                }
                continue;
            }
            at = match b {
                b'/' if class == Class::Model => {
                    list = !list;
                    self.sign(at, Role::Slash)
                }
                // Never closed.
                b'/' if class != Class::Acronym => {
                    closed = false;
                    self.sign(at, Role::Slash);
                    self.body(class, at + 1, end);
                    end
                }
                b',' => self.sign(at, Role::Comma),
                b'(' | b'[' | b'{' => {
                    domain = true;
                    self.sign(at, Role::Open)
                }
                b')' | b']' | b'}' => {
                    domain = false;
                    self.sign(at, Role::Close)
                }
                _ if list
                    && self.code[at..words::word_end(bytes, at)].eq_ignore_ascii_case("all") =>
                {
                    self.plain(at, Role::Keyword)
                }
                _ if domain || list => self.plain(at, Role::Name),
                _ if words::is_letter(b) || self.begins_with_percent(at) => {
                    self.plain(at, Role::Declared)
                }
                b'\'' | b'"' => self.plain(at, Role::Name),
                _ => self.sign(at, Role::Operator),
            };
        }
        let semicolon = self.code.get(end..next).and_then(|t| t.find(';'));
        if let Some(n) = semicolon {
            self.table = class == Class::Table && self.scan.tokens.last().is_some_and(|t| t.table);
            self.sign(end + n, Role::Semicolon);
            self.table = false;
        }
        let missing = raw.problems.iter().any(|p| p.code == "E0201");
        let last = next >= self.code.len() && semicolon.is_none();
        self.end(closed && !domain && !missing && !last);
        next.max(end)
    }

    fn sign(&mut self, i: usize, role: Role) -> usize {
        let end = i + self.code[i..].chars().next().map_or(1, char::len_utf8);
        self.push(i, end, role);
        end
    }

    /// An explanatory text, in quotes or without.
    fn explanation(&mut self, at: Span) {
        let (mut lo, hi) = (at.lo as usize, at.hi as usize);
        if quoted_end(self.code.as_bytes(), lo) == Some(hi) {
            self.push(lo, hi, Role::Quoted);
            return;
        }
        while lo < hi {
            let end = hi.min(self.line_end(lo));
            let text = self.code[lo..end].trim_matches(BLANKS);
            lo += self.code[lo..end].len() - self.code[lo..end].trim_start_matches(BLANKS).len();
            if !text.is_empty() {
                self.push(lo, lo + text.len(), Role::Text);
            }
            lo = end + usize::from(end < hi);
        }
    }

    /// Data between slashes.
    fn body(&mut self, class: Class, lo: usize, hi: usize) {
        let bytes = self.code.as_bytes();
        let (mut at, mut depth, mut record) = (lo, 0usize, true);
        self.data = true;
        while at < hi {
            let b = bytes[at];
            if words::is_blank(b) {
                record |= b == b'\n';
                at += 1;
                continue;
            }
            let line = hi.min(self.line_end(at));
            at = match b {
                b',' => {
                    record |= depth == 0;
                    self.sign(at, Role::Comma)
                }
                b'(' => {
                    depth += 1;
                    self.sign(at, Role::Open)
                }
                b')' => {
                    depth = depth.saturating_sub(1);
                    self.sign(at, Role::Close)
                }
                b'.' if record => self.sign(at, Role::Dot),
                b'*' | b':' | b'=' | b'/' => self.sign(at, Role::Operator),
                b'[' | b'{' if class != Class::Set => {
                    let close = memchr::memchr2(b']', b'}', &bytes[at..line]);
                    let end = close.map_or(line, |n| at + n + 1);
                    self.push(at, end, Role::Number);
                    end
                }
                _ => {
                    let (role, end) = self.datum(class, at, line, record);
                    self.push(at, end, role);
                    // A label goes on: `a.b`, `a*b`, `a:b`.
                    let rest = self.code[end..].trim_start_matches([' ', '\t']);
                    let quoted = role == Role::Quoted;
                    record = record && (depth > 0 && !quoted || rest.starts_with(['.', '*', ':']));
                    end
                }
            };
        }
        self.data = false;
    }

    /// A label, a number or a text in data; labels stand at the beginning of a record.
    fn datum(&self, class: Class, i: usize, hi: usize, record: bool) -> (Role, usize) {
        let bytes = self.code.as_bytes();
        if let Some(end) = quoted_end(bytes, i) {
            return (Role::Quoted, end);
        }
        // An element's text runs to the comma.
        if class == Class::File || class == Class::Set && !record {
            let stop = |b: &u8| *b == b'/' || class == Class::Set && matches!(b, b',' | b';');
            let end = bytes[i..hi].iter().position(stop).map_or(hi, |n| i + n);
            let text = self.code[i..end].trim_end_matches(BLANKS);
            return (Role::Text, i + text.len().max(1));
        }
        let mut end = i;
        while end < hi
            && !words::is_blank(bytes[end])
            && !matches!(bytes[end], b',' | b'/' | b';' | b'(' | b')' | b':' | b'=')
        {
            let joined = bytes[end] == b'.' && record;
            if end > i && bytes[end] == b'*'
                || joined && !self.code[i..end].bytes().all(|b| b.is_ascii_digit())
            {
                break;
            }
            end += self.code[end..].chars().next().map_or(1, char::len_utf8);
        }
        let role = match !record && class.has_values() {
            true => Role::Number,
            false => Role::Label,
        };
        (role, end.max(i + 1))
    }

    /// The lines of a table.
    fn table(&mut self, lo: usize, hi: usize) {
        let bytes = self.code.as_bytes();
        (self.data, self.table) = (true, true);
        let mut at = lo;
        while at < hi {
            let b = bytes[at];
            if words::is_blank(b) {
                at += 1;
                continue;
            }
            let number = b == b'.' && bytes.get(at + 1).is_some_and(u8::is_ascii_digit);
            if matches!(b, b'.' | b'(' | b')' | b',' | b'+' | b'*' | b':') && !number {
                at = self.sign(at, Role::Operator);
                continue;
            }
            let stops = |b: u8| words::is_blank(b) || matches!(b, b';' | b'(' | b')' | b',');
            let (role, end) = match quoted_end(bytes, at) {
                Some(end) => (Role::Quoted, end),
                None => {
                    let line = hi.min(self.line_end(at));
                    let end = (at..line).find(|n| stops(bytes[*n])).unwrap_or(line);
                    match self.code[at..end].parse::<f64>().is_ok() {
                        true => (Role::Number, end.max(at + 1)),
                        false => (Role::Label, end.max(at + 1)),
                    }
                }
            };
            self.push(at, end, role);
            at = end;
        }
        (self.data, self.table) = (false, false);
    }
}
