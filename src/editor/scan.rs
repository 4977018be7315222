//! What each word of a text is: keyword, name, label, number, text; and where statements begin and end.
//!
//! It reads the text as it stands, half-typed or not, without files and without knowing any symbol. It never fails: what
//! it does not understand is still a token. The parser (`syntax`) decides what is right; this says what is where.

use super::lines::{LineKind, Lines};
use crate::source::quoted_end;
use crate::syntax::words::{self, Class, Word};

/// What a token is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Role {
    /// A comment, whole line or part of one.
    Comment,
    /// `$include`: the name of a directive with its `$`.
    Directive,
    /// What stands behind a directive, word by word.
    Argument,
    /// A line that is not read.
    Raw,
    /// A word of the language.
    Keyword,
    /// A name: symbol, function, attribute, option.
    Name,
    /// The name that a declaration declares.
    Declared,
    /// The name of the equation that is defined.
    Defined,
    /// An attribute behind a point, and the keys of a figure's elements.
    Attribute,
    /// A number.
    Number,
    /// A text or label in quotes.
    Quoted,
    /// An explanatory text without quotes.
    Text,
    /// A label in data.
    Label,
    /// An operator, and any sign that is nothing else.
    Operator,
    /// `(`, `[`, `{`
    Open,
    /// `)`, `]`, `}`
    Close,
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// `/` before and behind data.
    Slash,
    /// `.` before an attribute, or between labels.
    Dot,
}

/// A word or a sign.
#[derive(Clone, Copy, Debug)]
pub struct Token {
    /// First byte.
    pub lo: usize,
    /// Behind the last byte.
    pub hi: usize,
    /// What it is.
    pub role: Role,
    /// In the data or the table of a declaration.
    pub data: bool,
    /// In the lines of a table, whose columns count.
    pub table: bool,
}

/// A statement; those inside of a `loop` follow it in the list.
#[derive(Clone, Copy, Debug)]
pub struct Statement {
    /// Its first token.
    pub first: usize,
    /// Behind its last token.
    pub end: usize,
    /// What kind it is.
    pub class: Class,
    /// Blocks around it.
    pub depth: usize,
    /// The token that opened the innermost of these.
    pub block: Option<usize>,
    /// Ended by its `;`, and every parenthesis closed.
    pub whole: bool,
}

/// A text, taken apart.
#[derive(Debug)]
pub struct Scan {
    /// Its lines.
    pub lines: Lines,
    /// All tokens in order of the text.
    pub tokens: Vec<Token>,
    /// All statements in order of their beginning.
    pub statements: Vec<Statement>,
}

/// Words of the language inside of statements, beside those that begin one.
pub const INNER_WORDS: &[&str] = &[
    "sum", "prod", "smin", "smax", "sand", "sor", "and", "or", "xor", "not", "imp", "eqv", "eq",
    "ne", "lt", "le", "gt", "ge", "inf", "eps", "na", "undf", "yes", "no", "then", "do", "until",
    "else", "elseif", "endif", "endloop", "endwhile", "endfor",
];

/// Words of the language in some statements only.
fn is_word_here(word: &str, first: &str) -> bool {
    let starts = |list: &[&str]| list.iter().any(|p| word.starts_with(p));
    match first {
        "solve" => starts(&["us", "min", "max"]) || word == "scenario",
        "for" => matches!(word, "to" | "downto" | "by"),
        "model" | "models" => word == "all",
        _ => false,
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Phase {
    /// Between statements.
    Start,
    /// Code.
    Code,
    /// In a declaration: before a name.
    Name,
    /// Behind a name, on its line.
    AfterName,
    /// In the parentheses behind a name.
    Domain,
    /// Behind the text, or on a new line.
    AfterText,
    /// Between slashes.
    Body,
    /// In the lines of a table.
    Table,
}

/// What is open.
#[derive(Clone, Copy, Debug)]
struct Frame {
    token: usize,
    /// Statements stand inside.
    block: bool,
    /// … behind a comma that has not come.
    header: bool,
    /// Closed by a word: `endloop`, `until`.
    by_word: bool,
    /// Open statements outside of it.
    outside: usize,
}

struct Scanner<'a> {
    text: &'a str,
    code: &'a str,
    scan: Scan,
    phase: Phase,
    class: Class,
    frames: Vec<Frame>,
    /// Statements that are open, outermost first.
    open: Vec<usize>,
    /// The next word begins a statement inside of a block.
    expects: bool,
    /// A word was read whose parentheses hold statements.
    control: bool,
    /// First word of the statement.
    word: String,
    new_line: bool,
    /// At the beginning of a record of data.
    record: bool,
    depth: usize,
    names: usize,
    /// Up to here the text is read: the words of a declaration may stand on two lines.
    read: usize,
}

impl Scan {
    /// Takes a text apart; `slashes`: `//` begins a comment.
    pub fn of(text: &str, slashes: bool) -> Self {
        let mut lines = Lines::of(text, slashes);
        let code = std::mem::take(&mut lines.code);
        let mut s = Scanner {
            text,
            code: &code,
            scan: Scan {
                lines,
                tokens: Vec::new(),
                statements: Vec::new(),
            },
            phase: Phase::Start,
            class: Class::Other,
            frames: Vec::new(),
            open: Vec::new(),
            expects: false,
            control: false,
            word: String::new(),
            new_line: false,
            record: false,
            depth: 0,
            names: 0,
            read: 0,
        };
        for line in 0..s.scan.lines.kinds.len() {
            s.line(line);
        }
        s.end(false);
        let mut scan = s.scan;
        scan.lines.code = code;
        scan
    }

    /// The token at a byte, or the one that ends there.
    pub fn token_at(&self, at: usize) -> Option<usize> {
        let n = self.tokens.partition_point(|t| t.lo <= at).checked_sub(1)?;
        let covers = |n: usize| at < self.tokens[n].hi;
        let wordy = |n: usize| {
            !matches!(
                self.tokens[n].role,
                Role::Open
                    | Role::Close
                    | Role::Comma
                    | Role::Semicolon
                    | Role::Operator
                    | Role::Dot
                    | Role::Slash
            )
        };
        // Between `x` and `(` the word is meant.
        let before = n.checked_sub(1).filter(|b| {
            self.tokens[*b].hi == at && self.tokens[n].lo == at && wordy(*b) && !wordy(n)
        });
        before.or_else(|| (covers(n) || self.tokens[n].hi == at).then_some(n))
    }

    /// The innermost statement around a byte: begun before it, and not ended.
    pub fn statement_at(&self, at: usize) -> Option<&Statement> {
        let before = self.statements.iter().rev();
        before
            .filter(|s| self.tokens[s.first].lo <= at)
            .find(|s| !s.whole || self.tokens[s.end - 1].hi > at)
    }

    /// The text of a token.
    pub fn text_of<'t>(&self, token: usize, text: &'t str) -> &'t str {
        self.tokens.get(token).map_or("", |t| &text[t.lo..t.hi])
    }
}

impl Scanner<'_> {
    fn push(&mut self, lo: usize, hi: usize, role: Role) -> usize {
        self.scan.tokens.push(Token {
            lo,
            hi,
            role,
            data: matches!(self.phase, Phase::Body | Phase::Table),
            table: self.phase == Phase::Table,
        });
        self.scan.tokens.len() - 1
    }

    fn line(&mut self, line: usize) {
        let kind = self.scan.lines.kinds[line];
        let range = self.scan.lines.range(line, self.text);
        match kind {
            LineKind::Comment => {
                self.push(range.lo, range.hi, Role::Comment);
            }
            LineKind::Raw => {
                if range.hi > range.lo {
                    self.push(range.lo, range.hi, Role::Raw);
                }
            }
            LineKind::Directive => self.directive(range.lo, range.hi),
            LineKind::Code | LineKind::Fixed => {
                self.new_line = true;
                self.record = true;
                if self.class == Class::Table && self.phase == Phase::AfterName && self.names > 0
                    || self.class == Class::Table && self.phase == Phase::AfterText
                {
                    self.phase = Phase::Table;
                }
                let comments: Vec<_> = {
                    let all = &self.scan.lines.comments;
                    let from = all.partition_point(|c| c.lo < range.lo);
                    all[from..]
                        .iter()
                        .take_while(|c| c.lo < range.hi)
                        .copied()
                        .collect()
                };
                let mut at = range.lo;
                for c in comments {
                    self.code_of(at, c.lo);
                    self.push(c.lo, c.hi, Role::Comment);
                    at = c.hi;
                }
                self.code_of(at, range.hi);
            }
        }
    }

    /// A line with a directive: its name, and the words behind it.
    fn directive(&mut self, lo: usize, hi: usize) {
        // What follows a table is no row of it.
        if self.phase == Phase::Table {
            self.end(true);
        }
        let text = self.text;
        let bytes = text.as_bytes();
        let mut i = lo;
        let signs = bytes[lo..hi]
            .iter()
            .take_while(|b| !b.is_ascii_alphanumeric())
            .count();
        let name = lo + signs;
        let end = words::word_end(bytes, name).min(hi);
        if signs > 0 && text[lo..name].contains('$') {
            let from = lo + text[lo..name].find('$').unwrap_or(0);
            self.push(from, end, Role::Directive);
            i = end;
            let word = text[name..end].to_ascii_lowercase();
            let rest = text[end..hi].trim();
            if !names_symbols(&word) {
                if !rest.is_empty() {
                    let lo = hi - text[end..hi].trim_start().len();
                    self.push(lo, lo + rest.len(), Role::Raw);
                }
                return;
            }
        }
        while i < hi {
            if words::is_blank(bytes[i]) {
                i += 1;
                continue;
            }
            let end = match quoted_end(bytes, i) {
                Some(end) if end <= hi => end,
                _ if words::is_letter(bytes[i]) => words::word_end(bytes, i).min(hi),
                _ => i + text[i..].chars().next().map_or(1, char::len_utf8),
            };
            self.push(i, end, Role::Argument);
            i = end;
        }
    }

    /// Ends all statements that are open.
    fn end(&mut self, whole: bool) {
        let end = self.scan.tokens.len();
        let whole = whole && self.frames.is_empty();
        for s in self.open.drain(..) {
            self.scan.statements[s].end = end;
            self.scan.statements[s].whole = whole;
        }
        self.frames.clear();
        self.expects = false;
        self.control = false;
        self.phase = Phase::Start;
        self.class = Class::Other;
    }

    /// Ends the statements inside of the innermost block.
    fn end_inner(&mut self) {
        let keep = self
            .frames
            .iter()
            .rev()
            .find(|f| f.block)
            .map_or(0, |f| f.outside);
        let end = self.scan.tokens.len();
        for s in self.open.drain(keep.min(self.open.len())..) {
            self.scan.statements[s].end = end;
            self.scan.statements[s].whole = true;
        }
    }

    /// A statement begins with the next token.
    fn begin(&mut self, class: Class) {
        let block = self.frames.iter().rev().find(|f| f.block).map(|f| f.token);
        let first = self.scan.tokens.len();
        self.open.push(self.scan.statements.len());
        self.scan.statements.push(Statement {
            first,
            end: first + 1,
            class,
            depth: self.frames.iter().filter(|f| f.block).count(),
            block,
            whole: false,
        });
    }

    fn code_of(&mut self, lo: usize, hi: usize) {
        let mut i = lo.max(self.read);
        while i < hi {
            let b = self.code.as_bytes()[i];
            if words::is_blank(b) || !self.code.is_char_boundary(i) {
                i += 1;
                continue;
            }
            i = match self.phase {
                Phase::Start => self.start(i),
                Phase::Code => self.code(i, hi),
                Phase::Body => self.body(i, hi),
                Phase::Table => self.table(i, hi),
                _ => self.declaration(i, hi),
            }
            .max(i);
            self.read = i;
            self.new_line = false;
        }
    }

    /// At the first byte of a statement; nothing is read yet, unless it is a `;` alone or the words of a declaration.
    fn start(&mut self, i: usize) -> usize {
        if self.code.as_bytes()[i] == b';' {
            self.push(i, i + 1, Role::Semicolon);
            return i + 1;
        }
        let (class, end) = words::classify(self.code, i);
        self.class = class;
        self.names = 0;
        self.begin(class);
        let first = words::word_end(self.code.as_bytes(), i);
        self.word = self.code[i..first].to_ascii_lowercase();
        if !class.declares() {
            self.phase = Phase::Code;
            return i;
        }
        // `positive variables`: each word by itself; they may stand on two lines.
        let mut at = i;
        while at < end {
            let to = words::word_end(self.code.as_bytes(), at);
            if to == at {
                at += 1;
                continue;
            }
            self.push(at, to, Role::Keyword);
            at = to;
        }
        self.phase = Phase::Name;
        end
    }

    fn declaration(&mut self, i: usize, hi: usize) -> usize {
        let bytes = self.code.as_bytes();
        let b = bytes[i];
        if self.new_line && matches!(self.phase, Phase::AfterName) {
            self.phase = Phase::AfterText;
        }
        if self.phase == Phase::Domain {
            return self.domain(i);
        }
        match b {
            b';' => {
                self.push(i, i + 1, Role::Semicolon);
                self.end(true);
                i + 1
            }
            b',' => {
                self.push(i, i + 1, Role::Comma);
                self.phase = Phase::Name;
                i + 1
            }
            b'/' if self.class != Class::Acronym => {
                self.push(i, i + 1, Role::Slash);
                self.phase = Phase::Body;
                self.record = true;
                self.depth = 0;
                i + 1
            }
            b'(' | b'[' | b'{' if self.phase != Phase::Name => {
                self.push(i, i + 1, Role::Open);
                self.phase = Phase::Domain;
                i + 1
            }
            b'\'' | b'"' => match memchr::memchr2(b, b'\n', &bytes[i + 1..]) {
                Some(n) if bytes[i + 1 + n] == b => {
                    let end = i + n + 2;
                    self.push(i, end, Role::Quoted);
                    self.phase = Phase::AfterText;
                    end
                }
                _ => {
                    self.push(i, hi, Role::Text);
                    hi
                }
            },
            _ if self.phase == Phase::AfterName
                && !matches!(b, b'=' | b'$' | b':' | b'.' | b'<') =>
            {
                let data = if self.class == Class::Table {
                    b','
                } else {
                    b'/'
                };
                let end = memchr::memchr3(b',', data, b';', &bytes[i..hi]).map_or(hi, |n| i + n);
                let end = i + self.code[i..end].trim_end().len();
                self.push(i, end.max(i + 1), Role::Text);
                self.phase = Phase::AfterText;
                end.max(i + 1)
            }
            _ if words::is_letter(b) => {
                let end = words::word_end(bytes, i);
                if words::statement_word(self.code, i, end).is_some() {
                    self.end(true);
                    return i;
                }
                // `e..` or `x = 5` where a `;` is missing: the next statement.
                let rest = self.code[end..hi].trim_start();
                if self.new_line
                    && self.names > 0
                    && (rest.starts_with("..") || rest.starts_with('='))
                {
                    self.end(false);
                    return i;
                }
                let role = match self.class {
                    Class::Alias => Role::Name,
                    _ => Role::Declared,
                };
                self.push(i, end, role);
                self.names += 1;
                self.phase = Phase::AfterName;
                end
            }
            _ => {
                let end = i + self.code[i..].chars().next().map_or(1, char::len_utf8);
                let role = match b {
                    b')' | b']' | b'}' => Role::Close,
                    _ => Role::Operator,
                };
                self.push(i, end, role);
                end
            }
        }
    }

    fn domain(&mut self, i: usize) -> usize {
        let bytes = self.code.as_bytes();
        match bytes[i] {
            b')' | b']' | b'}' => {
                self.push(i, i + 1, Role::Close);
                self.phase = Phase::AfterName;
                i + 1
            }
            b',' => {
                self.push(i, i + 1, Role::Comma);
                i + 1
            }
            b';' => {
                self.push(i, i + 1, Role::Semicolon);
                self.end(false);
                i + 1
            }
            _ => self.plain(i, Role::Name),
        }
    }

    /// A word, number, quoted text or sign.
    fn plain(&mut self, i: usize, word: Role) -> usize {
        let bytes = self.code.as_bytes();
        let b = bytes[i];
        let (end, role) = if let Some(end) = quoted_end(bytes, i) {
            (end, Role::Quoted)
        } else if words::is_letter(b)
            || b == b'%' && words::is_letter(*bytes.get(i + 1).unwrap_or(&b' '))
        {
            (self.wordlike(i), word)
        } else if b.is_ascii_digit() {
            (number_end(bytes, i), Role::Number)
        } else {
            let end = i + self.code[i..].chars().next().map_or(1, char::len_utf8);
            (end, if b == b'.' { Role::Dot } else { Role::Operator })
        };
        self.push(i, end, role);
        end
    }

    /// The end of a name, `%names%` inside of it included.
    fn wordlike(&self, i: usize) -> usize {
        let bytes = self.code.as_bytes();
        let mut end = i;
        loop {
            let next = words::word_end(bytes, end);
            if bytes.get(next) == Some(&b'%') {
                let name = words::word_end(bytes, next + 1);
                if name > next + 1 && bytes.get(name) == Some(&b'%') {
                    end = name + 1;
                    continue;
                }
            }
            return next.max(end).max(i + 1);
        }
    }

    /// Inside `/ … /`.
    fn body(&mut self, i: usize, hi: usize) -> usize {
        let bytes = self.code.as_bytes();
        let b = bytes[i];
        let set = self.class == Class::Set;
        if self.class == Class::Model {
            return self.model_list(i);
        }
        match b {
            b'/' => {
                let na = i > 0
                    && bytes[i - 1].eq_ignore_ascii_case(&b'n')
                    && bytes
                        .get(i + 1)
                        .is_some_and(|b| b.eq_ignore_ascii_case(&b'a'));
                let role = if na { Role::Operator } else { Role::Slash };
                let n = self.push(i, i + 1, role);
                if !na {
                    self.scan.tokens[n].data = false;
                    self.phase = Phase::AfterText;
                }
                i + 1
            }
            b';' if !set
                || self.code[i + 1..].trim_start().get(..3).is_none_or(|_| {
                    let rest = self.code[i + 1..].trim_start();
                    let at = self.code.len() - rest.len();
                    words::statement_word(self.code, at, words::word_end(bytes, at)).is_some()
                }) =>
            {
                // The slash was forgotten.
                self.push(i, i + 1, Role::Semicolon);
                self.end(false);
                i + 1
            }
            b',' => {
                self.push(i, i + 1, Role::Comma);
                self.record |= self.depth == 0;
                i + 1
            }
            b'(' => {
                self.depth += 1;
                self.push(i, i + 1, Role::Open);
                i + 1
            }
            b')' => {
                self.depth = self.depth.saturating_sub(1);
                self.push(i, i + 1, Role::Close);
                i + 1
            }
            b'.' if self.record => {
                self.push(i, i + 1, Role::Dot);
                i + 1
            }
            b'*' | b':' | b'=' => {
                self.push(i, i + 1, Role::Operator);
                i + 1
            }
            b'[' | b'{' if !set => {
                let end = memchr::memchr2(b']', b'}', &bytes[i..hi]).map_or(hi, |n| i + n + 1);
                self.push(i, end, Role::Number);
                end
            }
            _ => self.datum(i, hi),
        }
    }

    /// A label, a number or a text in data.
    fn datum(&mut self, i: usize, hi: usize) -> usize {
        let bytes = self.code.as_bytes();
        if let Some(end) = quoted_end(bytes, i) {
            self.push(i, end, Role::Quoted);
            self.record = self.record && self.joins(end);
            return end;
        }
        if self.class == Class::File {
            let end = memchr::memchr(b'/', &bytes[i..hi]).map_or(hi, |n| i + n);
            let end = i + self.code[i..end].trim_end().len().max(1);
            self.push(i, end, Role::Text);
            return end;
        }
        if self.class == Class::Set && !self.record {
            // An element's text runs to the comma.
            let end = memchr::memchr3(b',', b'/', b';', &bytes[i..hi]).map_or(hi, |n| i + n);
            let end = i + self.code[i..end].trim_end().len().max(1);
            self.push(i, end, Role::Text);
            return end;
        }
        let mut end = i;
        while end < hi
            && !words::is_blank(bytes[end])
            && !matches!(bytes[end], b',' | b'/' | b';' | b'(' | b')' | b':' | b'=')
        {
            let b = bytes[end];
            if end > i && b == b'*'
                || b == b'.'
                    && self.record
                    && !self.code[i..end].bytes().all(|b| b.is_ascii_digit())
            {
                break;
            }
            end += self.code[end..].chars().next().map_or(1, char::len_utf8);
        }
        let end = end.max(i + 1);
        let number = !self.record && self.class.has_values();
        self.push(i, end, if number { Role::Number } else { Role::Label });
        self.record = self.record && (self.depth > 0 || self.joins(end));
        end
    }

    /// Whether a label goes on behind `at`: `a.b`, `a*b`, `a:b`.
    fn joins(&self, at: usize) -> bool {
        matches!(
            self.code[at..]
                .trim_start_matches([' ', '\t'])
                .as_bytes()
                .first(),
            Some(b'.' | b'*' | b':')
        )
    }

    fn model_list(&mut self, i: usize) -> usize {
        let bytes = self.code.as_bytes();
        match bytes[i] {
            b'/' => {
                let n = self.push(i, i + 1, Role::Slash);
                self.scan.tokens[n].data = false;
                self.phase = Phase::AfterText;
                i + 1
            }
            b';' => {
                self.push(i, i + 1, Role::Semicolon);
                self.end(false);
                i + 1
            }
            b',' => {
                self.push(i, i + 1, Role::Comma);
                i + 1
            }
            b'(' | b')' => {
                self.push(
                    i,
                    i + 1,
                    if bytes[i] == b'(' {
                        Role::Open
                    } else {
                        Role::Close
                    },
                );
                i + 1
            }
            _ => {
                let end = words::word_end(bytes, i);
                if end > i && words::statement_word(self.code, i, end).is_some() && self.new_line {
                    // The slash was forgotten.
                    self.end(false);
                    return i;
                }
                let all = self.code[i..end].eq_ignore_ascii_case("all");
                let end = self.plain(i, if all { Role::Keyword } else { Role::Name });
                let last = self.scan.tokens.len() - 1;
                self.scan.tokens[last].data = false;
                end
            }
        }
    }

    /// The lines of a table.
    fn table(&mut self, i: usize, hi: usize) -> usize {
        let bytes = self.code.as_bytes();
        let end = words::word_end(bytes, i);
        if self.new_line && words::begins_statement_in_table(self.code, i, end) {
            self.end(true);
            return i;
        }
        match bytes[i] {
            b';' => {
                self.phase = Phase::Start;
                self.push(i, i + 1, Role::Semicolon);
                let last = self.scan.tokens.len() - 1;
                self.scan.tokens[last].table = true;
                self.end(true);
                i + 1
            }
            b'.' | b'(' | b')' | b',' | b'+' | b'*' | b':'
                if !bytes.get(i + 1).is_some_and(u8::is_ascii_digit) || bytes[i] != b'.' =>
            {
                self.push(i, i + 1, Role::Operator);
                i + 1
            }
            _ => {
                if let Some(end) = quoted_end(bytes, i) {
                    self.push(i, end, Role::Quoted);
                    return end;
                }
                let stops = |b: u8| words::is_blank(b) || matches!(b, b';' | b'(' | b')' | b',');
                let end = (i..hi).find(|n| stops(bytes[*n])).unwrap_or(hi).max(i + 1);
                let word = &self.code[i..end];
                let number = word.parse::<f64>().is_ok();
                self.push(i, end, if number { Role::Number } else { Role::Label });
                end
            }
        }
    }

    fn code(&mut self, i: usize, hi: usize) -> usize {
        let bytes = self.code.as_bytes();
        let b = bytes[i];
        let blocky = self.frames.last().is_some_and(|f| f.block && !f.header);
        if self.expects && blocky && !matches!(b, b';' | b')' | b']' | b'}' | b',') {
            let word = self.code[i..words::word_end(bytes, i)].to_ascii_lowercase();
            if !matches!(
                word.as_str(),
                "else" | "elseif" | "until" | "endif" | "endloop" | "endwhile" | "endfor"
            ) {
                self.expects = false;
                let class = words::classify(self.code, i).0;
                self.begin(class);
                self.word = word;
            }
        }
        if words::is_letter(b) {
            return self.code_word(i, hi);
        }
        let end = match b {
            b'\'' | b'"' => match memchr::memchr2(b, b'\n', &bytes[i + 1..]) {
                Some(n) if bytes[i + 1 + n] == b => {
                    self.push(i, i + n + 2, Role::Quoted);
                    i + n + 2
                }
                _ => {
                    // Half-typed: to the end of the line.
                    let end = i + self.code[i..hi].trim_end().len();
                    self.push(i, end, Role::Quoted);
                    end
                }
            },
            b'0'..=b'9' => self.plain(i, Role::Name),
            b'.' if bytes.get(i + 1).is_some_and(u8::is_ascii_digit) && !self.behind_word(i) => {
                let end = number_end(bytes, i);
                self.push(i, end, Role::Number);
                end
            }
            b'%' => self.plain(i, Role::Name),
            b'(' | b'[' | b'{' => {
                let figure = b == b'{' && self.frames.is_empty() && self.word == "figure";
                let block = self.control || figure;
                let header = block && !figure && self.word_before(i) != "repeat";
                let token = self.push(i, i + 1, Role::Open);
                self.frames.push(Frame {
                    token,
                    block,
                    header,
                    by_word: false,
                    outside: self.open.len(),
                });
                self.expects = block && !header;
                self.control = false;
                i + 1
            }
            b')' | b']' | b'}' => {
                if self.frames.last().is_some_and(|f| f.block) {
                    self.end_inner();
                }
                self.frames.pop();
                self.expects = false;
                self.push(i, i + 1, Role::Close);
                i + 1
            }
            b',' => {
                self.push(i, i + 1, Role::Comma);
                if let Some(f) = self.frames.last_mut().filter(|f| f.block && f.header) {
                    f.header = false;
                    self.expects = true;
                }
                i + 1
            }
            b';' => {
                self.push(i, i + 1, Role::Semicolon);
                let block = self.frames.iter().rposition(|f| f.block);
                let unclosed = self.frames.len() > block.map_or(0, |n| n + 1);
                self.frames.truncate(block.map_or(0, |n| n + 1));
                if block.is_none() {
                    self.end(!unclosed);
                } else {
                    self.end_inner();
                    self.expects = true;
                }
                i + 1
            }
            b'.' if bytes.get(i + 1) == Some(&b'.') => {
                self.defines();
                self.push(i, i + 2, Role::Operator);
                i + 2
            }
            b'.' => {
                self.push(i, i + 1, Role::Dot);
                i + 1
            }
            _ => {
                let end = operator_end(self.code, i);
                self.push(i, end, Role::Operator);
                end
            }
        };
        self.control = false;
        end
    }

    /// Whether a word has a meaning in this statement only. Behind one of them a name stands: `min minz`.
    fn is_word_here(&self, word: &str, at: usize) -> bool {
        let last = self.word_before(at);
        is_word_here(word, &self.word)
            && !(self.word == "solve" && (last == "solve" || is_word_here(&last, "solve")))
    }

    fn in_figure(&self) -> bool {
        let outermost = self.open.first().map(|s| self.scan.statements[*s].first);
        let token = outermost.and_then(|t| self.scan.tokens.get(t));
        token.is_some_and(|t| self.code[t.lo..t.hi].eq_ignore_ascii_case("figure"))
    }

    /// The name at the beginning of the statement is an equation that is defined.
    fn defines(&mut self) {
        if let Some(&s) = self.open.last() {
            let first = self.scan.statements[s].first;
            if let Some(t) = self
                .scan
                .tokens
                .get_mut(first)
                .filter(|t| t.role == Role::Name)
            {
                t.role = Role::Defined;
                self.scan.statements[s].class = Class::Equation;
            }
        }
    }

    fn behind_word(&self, i: usize) -> bool {
        let last = self.scan.tokens.last();
        last.is_some_and(|t| t.hi == i && matches!(t.role, Role::Name | Role::Close | Role::Number))
    }

    fn word_before(&self, i: usize) -> String {
        let last = self.scan.tokens.last().filter(|t| t.hi <= i);
        last.map_or(String::new(), |t| {
            self.code[t.lo..t.hi].to_ascii_lowercase()
        })
    }

    fn code_word(&mut self, i: usize, _hi: usize) -> usize {
        let bytes = self.code.as_bytes();
        let end = words::word_end(bytes, i);
        let after_dot = self
            .scan
            .tokens
            .last()
            .is_some_and(|t| t.role == Role::Dot && t.hi == i);
        let first = self
            .open
            .last()
            .is_some_and(|s| self.scan.statements[*s].first == self.scan.tokens.len());
        let lower = self.code[i..end].to_ascii_lowercase();
        let statement = if after_dot {
            None
        } else {
            words::statement_word(self.code, i, end)
        };
        if let Some(word) = statement {
            let outermost = self.frames.is_empty();
            if !first && (outermost && !word.inside_blocks_only() || word == Word::Declaration) {
                // A `;` or a parenthesis is missing.
                let whole = self.frames.is_empty();
                self.end(whole);
                return i;
            }
        }
        let wordlike = self.wordlike(i);
        if wordlike > end {
            self.push(i, wordlike, Role::Name);
            return wordlike;
        }
        let inner =
            !after_dot && (INNER_WORDS.contains(&lower.as_str()) || self.is_word_here(&lower, i));
        let begins = !after_dot
            && first
            && (statement.is_some() || words::classify(self.code, i).0 == Class::Other);
        let keyword = statement.is_some() || inner || begins;
        if keyword {
            self.block_word(&lower, end, i);
        }
        let key = self.word == "figure" || self.in_figure();
        let behind = self.code[end..].trim_start();
        let role = match () {
            () if keyword => Role::Keyword,
            // The kind of an element, and what is given of it.
            () if key
                && !self.frames.is_empty()
                && (first || self.frames.len() == 1 && behind.starts_with('=')) =>
            {
                Role::Attribute
            }
            () if after_dot => Role::Attribute,
            () => Role::Name,
        };
        let token = self.push(i, end, role);
        if keyword {
            self.after_block_word(&lower, token, end);
        }
        end
    }

    /// Before `else`, `until`, `endloop`: what is inside ends.
    fn block_word(&mut self, word: &str, _end: usize, _i: usize) {
        match word {
            "else" | "elseif" => {
                self.end_inner();
                if let Some(f) = self.frames.iter_mut().rev().find(|f| f.block) {
                    f.header = word == "elseif" && !f.by_word;
                }
                self.expects = word == "else";
            }
            "until" => {
                self.end_inner();
                match self.frames.last_mut() {
                    Some(f) if f.by_word => {
                        self.frames.pop();
                    }
                    Some(f) => f.header = true,
                    None => {}
                }
                self.expects = false;
            }
            "endif" | "endloop" | "endwhile" | "endfor" => {
                self.end_inner();
                if let Some(n) = self.frames.iter().rposition(|f| f.by_word) {
                    self.frames.truncate(n);
                }
                self.expects = false;
            }
            _ => {}
        }
    }

    fn after_block_word(&mut self, word: &str, token: usize, end: usize) {
        let by_word = |s: &mut Self, header| {
            let outside = s.open.len();
            s.frames.push(Frame {
                token,
                block: true,
                header,
                by_word: true,
                outside,
            });
            s.expects = true;
        };
        match word {
            "loop" | "while" | "for" | "if" | "repeat" => {
                let opens = matches!(
                    self.code[end..].trim_start().as_bytes().first(),
                    Some(b'(' | b'[' | b'{')
                );
                self.control = opens;
                if word == "repeat" && !opens {
                    by_word(self, false);
                }
            }
            "then" | "do" => {
                // Behind `elseif c` the block is open already.
                match self.frames.last() {
                    Some(f) if f.by_word => self.expects = true,
                    _ => by_word(self, false),
                }
            }
            _ => self.control = false,
        }
    }
}

/// Whether symbols may stand behind a directive.
fn names_symbols(directive: &str) -> bool {
    const WORDS: &[&str] = &["macro", "kill", "clear", "onput"];
    const BEGINNINGS: &[&str] = &[
        "if",
        "elseif",
        "eval",
        "load",
        "unload",
        "gdxload",
        "gdxunload",
    ];
    WORDS.contains(&directive) || BEGINNINGS.iter().any(|b| directive.starts_with(b))
}

/// The end of a number that begins at `i`: `12`, `1.5e-3`, not the points of `1..`.
fn number_end(bytes: &[u8], i: usize) -> usize {
    let digits = |mut n: usize| {
        while bytes.get(n).is_some_and(u8::is_ascii_digit) {
            n += 1;
        }
        n
    };
    let mut end = digits(i);
    if bytes.get(end) == Some(&b'.') && bytes.get(end + 1) != Some(&b'.') {
        end = digits(end + 1);
    }
    if bytes
        .get(end)
        .is_some_and(|b| b.eq_ignore_ascii_case(&b'e'))
    {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let to = digits(end + 1 + sign);
        if to > end + 1 + sign {
            end = to;
        }
    }
    words::word_end(bytes, end).max(i + 1)
}

/// The end of the operator at `i`.
fn operator_end(code: &str, i: usize) -> usize {
    let rest = &code[i..];
    let bytes = rest.as_bytes();
    if bytes.len() > 2 && bytes[0] == b'=' && bytes[1].is_ascii_alphabetic() && bytes[2] == b'=' {
        return i + 3;
    }
    for sign in ["<=>", "<=", ">=", "<>", "->", "**", "++", "--", ":=", "$="] {
        if rest.starts_with(sign) {
            return i + sign.len();
        }
    }
    i + rest.chars().next().map_or(1, char::len_utf8)
}
