//! Cuts the expanded text into statements.
//!
//! A statement ends at its `;`. It also ends before a word that always begins a statement
//! (`display`, `set`, `solve` …), as GAMS has it. In declarations the splitter finds the explanatory
//! texts and the data between slashes, which the grammar does not read, and remembers them as
//! [`Hole`]s.
//!
//! The text arrives in pieces of whole lines, and quoted texts do not run over lines: between two
//! pieces only [`Splitter`]'s few fields are remembered, and no byte is looked at twice.
//!
//! Invariant: spans of successive statements do not overlap, and every statement is finite: an
//! unclosed parenthesis ends at the next `;` outside blocks, an unclosed block at the next
//! declaration.

mod declaration;

use super::words::{self, Class, Word};
use crate::diag::Diagnostic;
use crate::source::{Span, embedded_code};
use std::ops::Range;

/// Parentheses and blocks inside each other.
pub(super) const DEEPEST: usize = 250;

/// What the splitter takes out of a declaration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum HoleKind {
    /// An explanatory text.
    Text,
    /// Data between slashes, a table's lines, a file's name.
    Body,
}

/// A part of a statement that the grammar does not read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hole {
    pub(crate) kind: HoleKind,
    /// What counts: the text without its quotes, the body without its slashes.
    pub(crate) inside: Span,
    /// All that is taken out.
    pub(crate) outside: Span,
}

/// A statement as it was cut out.
#[derive(Debug)]
pub(crate) struct Raw {
    pub(crate) class: Class,
    pub(crate) span: Span,
    pub(crate) holes: Vec<Hole>,
    /// What is wrong already; then there is no use in parsing.
    pub(crate) problems: Vec<Diagnostic>,
}

/// What the splitter says.
pub(super) enum Cut {
    /// The text so far holds no complete statement.
    More,
    /// A statement.
    Statement(Raw),
}

/// Position in a declaration.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
enum Declare {
    /// Before a name.
    #[default]
    Name,
    /// After a name or its domain, on the same line.
    AfterName,
    /// In the parentheses after a name.
    Domain,
    /// After the text, or on a new line.
    AfterText,
    /// Between slashes.
    Body,
    /// In the lines of a table.
    Table,
}

/// An open parenthesis.
#[derive(Clone, Copy, Debug)]
struct Open {
    at: usize,
    byte: u8,
    /// Statements stand inside.
    block: bool,
}

/// See the module.
#[derive(Default)]
pub(super) struct Splitter {
    /// Everything before this has been looked at.
    pos: usize,
    /// Start of the statement being read.
    start: Option<usize>,
    class: Class,
    declare: Declare,
    opens: Vec<Open>,
    /// `loop … endloop` under `$onEnd`.
    blocks: usize,
    holes: Vec<Hole>,
    problems: Vec<Diagnostic>,
    body_start: usize,
    /// The line of the last name has ended.
    new_line: bool,
    /// The last name: for `e..` after a declaration without `;`.
    last_name: usize,
    /// Where the last thing that counts ended.
    last_end: usize,
    /// The keyword has been read (`positive variables`).
    after_dot: bool,
    /// A word was read whose parentheses hold statements.
    control: bool,
    /// The statement is a figure: its braces hold statements.
    figure: bool,
    /// It began with `loop`, `if` …: braces after that are those of another language.
    controls: bool,
    /// Names declared so far in this statement.
    names: usize,
    /// Data up to here hold no `;` that could end the statement.
    searched: usize,
}

/// The declaration that begins at a byte of a whole text, and where to read on.
pub(crate) fn declaration(text: &str, at: usize) -> (Option<Raw>, usize) {
    let mut splitter = Splitter::default();
    splitter.back_to(at);
    match splitter.next(text, false, true) {
        Cut::Statement(raw) => (Some(raw), splitter.pos),
        Cut::More => (None, text.len()),
    }
}

fn span(lo: usize, hi: usize) -> Span {
    Span::new(lo as u32, hi as u32)
}

impl Splitter {
    /// Goes on at a byte that was passed over: a `;` was missing before it.
    pub(super) fn back_to(&mut self, at: usize) {
        self.pos = at;
        self.start = None;
        self.opens.clear();
        self.blocks = 0;
        self.holes.clear();
        self.problems.clear();
    }

    /// Looks for the next statement. `last`: no more text will come.
    pub(super) fn next(&mut self, text: &str, on_end: bool, last: bool) -> Cut {
        let bytes = text.as_bytes();
        if self.start.is_none() && !self.begin(text) {
            return Cut::More;
        }
        let done = match self.class {
            Class::Directive => self.directive(bytes),
            c if c.declares() => self.declaration(text),
            _ => self.code(text, on_end),
        };
        if done {
            return Cut::Statement(self.finish());
        }
        if last && self.start.is_some() {
            self.at_end(text);
            return Cut::Statement(self.finish());
        }
        Cut::More
    }

    /// Skips to the first byte of a statement.
    fn begin(&mut self, text: &str) -> bool {
        let bytes = text.as_bytes();
        while let Some(&b) = bytes.get(self.pos) {
            if b == b';' || words::is_blank(b) {
                self.pos += 1;
            } else if text[self.pos..].starts_with(['\u{a0}', '\u{feff}']) {
                self.pos += text[self.pos..].chars().next().map_or(1, char::len_utf8);
            } else {
                break;
            }
        }
        let Some(&b) = bytes.get(self.pos) else {
            return false;
        };
        let at = self.pos;
        self.start = Some(at);
        self.last_end = at;
        self.declare = Declare::Name;
        self.new_line = false;
        self.after_dot = false;
        self.control = false;
        self.figure = false;
        self.names = 0;
        if b == b'$' && (at == 0 || bytes[at - 1] == b'\n') {
            self.class = Class::Directive;
            return true;
        }
        let (class, end) = words::classify(text, at);
        self.class = class;
        self.controls = words::statement_word(text, at, end.max(at)) == Some(Word::Control);
        self.figure = words::is_figure(&text[at..end.max(at)]);
        if class.declares() {
            self.pos = end;
            self.last_end = end;
        }
        true
    }

    fn finish(&mut self) -> Raw {
        let start = self.start.take().unwrap_or(self.last_end);
        self.opens.clear();
        self.blocks = 0;
        Raw {
            class: self.class,
            span: span(start, self.last_end.max(start)),
            holes: std::mem::take(&mut self.holes),
            problems: std::mem::take(&mut self.problems),
        }
    }

    fn directive(&mut self, bytes: &[u8]) -> bool {
        match memchr::memchr(b';', &bytes[self.pos..]) {
            Some(n) => {
                self.last_end = self.pos + n;
                self.pos += n + 1;
                true
            }
            None => {
                self.pos = bytes.len();
                self.last_end = bytes.len();
                false
            }
        }
    }

    /// The text has ended inside a statement.
    fn at_end(&mut self, text: &str) {
        let bytes = text.as_bytes();
        if self.class.declares() {
            match self.declare {
                Declare::Body => self.unclosed_body(text, self.body_start, bytes.len()),
                Declare::Table => self.end_table(bytes, bytes.len()),
                _ => {}
            }
        } else {
            let block = self.opens.iter().rev().find(|o| o.block);
            let open = block.or(self.opens.last()).copied();
            open.into_iter().for_each(|open| self.unclosed(open));
        }
    }

    fn unclosed(&mut self, open: Open) {
        let close = match open.byte {
            b'(' => ')',
            b'[' => ']',
            _ => '}',
        };
        self.problems.push(
            Diagnostic::error("E0202", span(open.at, open.at + 1))
                .says(format!("this `{}` is never closed", open.byte as char))
                .label(format!("its `{close}` is missing"))
                .help(if open.block {
                    format!("close the block with `{close};` before the next statement")
                } else if open.byte == b'{' {
                    "braces are parentheses here; statements that belong together stand in `loop(i, … );`, `if(c, … );`".to_string()
                } else {
                    format!("write `{close}` before the `;`")
                }),
        );
    }

    fn unclosed_body(&mut self, text: &str, at: usize, end: usize) {
        let digit = |b: Option<&u8>| b.is_some_and(u8::is_ascii_digit);
        let line = text[..at.saturating_sub(1)]
            .rsplit('\n')
            .next()
            .unwrap_or("")
            .trim_end();
        // `/ 1/3 /`
        let fraction = line.rfind('/').is_some_and(|n| {
            let (left, right) = (&line.as_bytes()[..n], &line.as_bytes()[n + 1..]);
            digit(left.last()) && digit(right.first())
        });
        let help = match fraction {
            true => "a `/` ends the data; a fraction stands in brackets: `[1/3]`",
            false => "data stand between two slashes: `/ a 1, b 2 /`",
        };
        self.problems.push(
            Diagnostic::error("E0203", span(at.saturating_sub(1), at))
                .says("the data that begin here are never closed by `/`")
                .label("opened here")
                .help(help),
        );
        self.last_end = end;
    }

    /// `embeddedCode Python: … endEmbeddedCode p`: nothing between is looked at. None for other statements,
    /// else whether the end is there.
    fn embedded(&mut self, text: &str, start: usize) -> Option<bool> {
        const BEGIN: &str = "embeddedcode";
        const END: &str = "endembeddedcode";
        let word = text.get(start..start + BEGIN.len())?;
        if !word.eq_ignore_ascii_case(BEGIN) {
            return None;
        }
        let inside = text[start..].to_ascii_lowercase();
        let Some(end) = inside.find(END).map(|n| start + n + END.len()) else {
            return Some(false);
        };
        let rest = memchr::memchr2(b';', b'\n', &text.as_bytes()[end..]);
        let names = &text[end..rest.map_or(text.len(), |n| end + n)];
        let gives_back = !names.trim().is_empty() || inside[..end - start].contains("gamswriter");
        self.pos = rest.map_or(text.len(), |n| end + n + 1);
        self.last_end = self.pos;
        self.problems
            .push(embedded_code(span(start, start + BEGIN.len()), gives_back));
        Some(true)
    }

    fn code(&mut self, text: &str, on_end: bool) -> bool {
        let bytes = text.as_bytes();
        let start = self.start.unwrap_or(0);
        if let Some(ended) = self.embedded(text, start) {
            return ended;
        }
        let mut i = self.pos;
        while i < bytes.len() {
            let b = bytes[i];
            match b {
                b' ' | b'\t' | b'\r' | b'\n' => {
                    i += 1;
                    continue;
                }
                b'\'' | b'"' => {
                    // In code a quote always opens a text, if its partner stands on the line.
                    let rest = &bytes[i + 1..];
                    i = match memchr::memchr2(b, b'\n', rest) {
                        Some(n) if rest[n] == b => i + n + 2,
                        _ => i + 1,
                    };
                }
                b'a'..=b'z' | b'A'..=b'Z' | b'_' => {
                    let end = words::word_end(bytes, i);
                    let ends = match words::statement_word(text, i, end) {
                        Some(word) => self.word(text, word, i..end, i > start, on_end),
                        None => {
                            self.control = false;
                            false
                        }
                    };
                    if ends {
                        return true;
                    }
                    i = end;
                }
                b'0'..=b'9' => {
                    i += 1;
                    while i < bytes.len()
                        && (bytes[i].is_ascii_alphanumeric()
                            || bytes[i] == b'.' && bytes.get(i + 1) != Some(&b'.'))
                    {
                        i += 1;
                    }
                }
                b'{' if self.controls && self.opens.is_empty() && !self.control => {
                    return self.braces(text, i);
                }
                b'(' | b'[' | b'{' => {
                    let block = self.control || self.figure && b == b'{' && self.opens.is_empty();
                    self.opens.push(Open {
                        at: i,
                        byte: b,
                        block,
                    });
                    self.control = false;
                    i += 1;
                    if self.opens.len() > DEEPEST {
                        return self.too_deep(bytes, i);
                    }
                }
                b')' | b']' | b'}' => {
                    self.opens.pop();
                    i += 1;
                }
                b';' => {
                    let (next, ends) = self.semicolon(text, i);
                    if ends {
                        self.pos = next;
                        return true;
                    }
                    i = next;
                }
                b'$' if i > 0
                    && bytes[i - 1] == b'\n'
                    && self.opens.is_empty()
                    && self.blocks == 0 =>
                {
                    self.pos = i;
                    return true;
                }
                _ => i += 1,
            }
            self.after_dot =
                b == b'.' && bytes.get(i) != Some(&b'.') && (i < 2 || bytes[i - 2] != b'.');
            self.last_end = i;
        }
        self.pos = i;
        false
    }

    /// A word that may begin or end a statement. Whether the statement ends, before it or behind a declaration that cannot stand here.
    fn word(
        &mut self,
        text: &str,
        word: Word,
        at: Range<usize>,
        is_inside: bool,
        on_end: bool,
    ) -> bool {
        let boundary = is_inside && !self.after_dot;
        let outermost = self.opens.is_empty() && self.blocks == 0;
        if boundary && outermost && !word.inside_blocks_only() {
            self.pos = at.start;
            return true;
        }
        if boundary && word == Word::Declaration {
            // No block and no parenthesis holds a declaration.
            self.pos = at.start;
            let block = self.opens.iter().rev().find(|o| o.block);
            if let Some(&open) = block.or(self.opens.last()) {
                match closes(&text[at.start..]) {
                    Some(n) if open.block => {
                        let message = "a declaration cannot stand inside of a loop or an `if`";
                        self.problems.push(
                            Diagnostic::error("E0324", span(at.start, at.end))
                                .says(message)
                                .help("move it before the loop"),
                        );
                        self.pos = at.start + n;
                        self.last_end = self.pos;
                    }
                    _ => self.unclosed(open),
                }
            }
            return true;
        }
        if self.after_dot {
            return false;
        }
        match word {
            Word::Control => {
                self.control = true;
                let bare = !opens_parenthesis(text.as_bytes(), at.end)
                    || on_end && ends_in_word(text, at.end);
                let repeat = text[at].eq_ignore_ascii_case("repeat");
                if bare && (on_end || repeat) {
                    // Inside parentheses a `;` ends nothing anyway.
                    self.blocks += usize::from(self.opens.is_empty());
                    self.control = false;
                }
            }
            Word::EndControl | Word::Until if self.blocks > 0 && self.opens.is_empty() => {
                self.blocks -= 1;
            }
            _ => {}
        }
        false
    }

    /// A `;` at byte `i`: where it goes on, and whether the statement ends.
    fn semicolon(&mut self, text: &str, i: usize) -> (usize, bool) {
        match self.opens.last() {
            None => (i + 1, self.blocks == 0),
            Some(open) if open.block => (i + 1, false),
            Some(_) if stray_semicolon(&text[i + 1..], self.opens.len()) => {
                self.problems.push(
                    Diagnostic::error("E0202", span(i, i + 1))
                        .says("a `;` stands inside of parentheses")
                        .label("a comma is meant?")
                        .help("write `,` between the parts of a sum or the arguments of a function; `;` ends a statement"),
                );
                (i + 1, false)
            }
            Some(_) => {
                // The `;` ends what is inside, closed or not.
                let block = self.opens.iter().rposition(|o| o.block);
                let first = block.map_or(0, |n| n + 1);
                self.unclosed(self.opens[first]);
                self.opens.truncate(first);
                (i + 1, first == 0 && self.blocks == 0)
            }
        }
    }

    /// `loop(i) { p(i) = 1; }`: the statement ends behind the brace that closes.
    fn braces(&mut self, text: &str, i: usize) -> bool {
        let mut depth = 0usize;
        let close = text[i..].bytes().position(|b| {
            match b {
                b'{' => depth += 1,
                b'}' => depth -= 1,
                _ => {}
            }
            depth == 0
        });
        self.problems.push(
            Diagnostic::error("E0231", span(i, i + 1))
                .says("statements are not grouped by braces")
                .help("they stand inside of the parentheses, after a comma: `loop(i, … );`, `if(c, … );`, `while(c, … );`"),
        );
        let end = close.map_or(text.len(), |n| i + n + 1);
        self.last_end = end;
        self.pos = end;
        true
    }

    /// Nested too deeply: reports it and passes over the statement.
    fn too_deep(&mut self, bytes: &[u8], i: usize) -> bool {
        self.problems.push(
            Diagnostic::error("E0204", span(i - 1, i))
                .says(format!(
                    "parentheses are nested more than {DEEPEST} deep here"
                ))
                .help("split the expression: give its parts names of their own"),
        );
        let end = memchr::memchr(b';', &bytes[i..]).map_or(bytes.len(), |n| i + n);
        self.last_end = end;
        self.pos = (end + 1).min(bytes.len());
        true
    }
}

/// Whether behind a `;` inside of parentheses these are closed on the same line, before the next `;`.
fn stray_semicolon(rest: &str, open: usize) -> bool {
    let mut depth = open;
    for b in rest.bytes().take_while(|b| *b != b'\n') {
        match b {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return true;
        }
    }
    false
}

/// The end of the statement in which a block is open here, if it is closed.
fn closes(rest: &str) -> Option<usize> {
    let mut depth = 1usize;
    for (n, b) in rest.bytes().enumerate() {
        match b {
            b'(' => depth += 1,
            b')' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            let behind = &rest[n + 1..];
            let left = behind.trim_start().strip_prefix(';').unwrap_or(behind);
            return Some(rest.len() - left.len());
        }
    }
    None
}

/// Whether the next byte that counts opens a parenthesis.
fn opens_parenthesis(bytes: &[u8], mut i: usize) -> bool {
    while i < bytes.len() && words::is_blank(bytes[i]) {
        i += 1;
    }
    matches!(bytes.get(i), Some(b'(' | b'[' | b'{'))
}

/// Whether `then` or `do` follows what a control word begins with: `if (a + b) > c then … endif`.
fn ends_in_word(text: &str, mut i: usize) -> bool {
    let bytes = text.as_bytes();
    let mut depth = 0usize;
    while let Some(&b) = bytes.get(i) {
        let mut next = i + 1;
        match b {
            b'\'' | b'"' => {
                if let Some(n) = memchr::memchr(b, &bytes[next..]) {
                    next += n + 1;
                }
            }
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            b';' => return false,
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => {
                next = words::word_end(bytes, i);
                let word = &text[i..next];
                if words::statement_word(text, i, next) == Some(Word::Control) {
                    return false;
                }
                if depth == 0 && ["then", "do"].iter().any(|w| word.eq_ignore_ascii_case(w)) {
                    return true;
                }
            }
            _ => {}
        }
        i = next;
    }
    false
}
