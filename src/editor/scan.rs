//! What each word of a text is: keyword, name, label, number, text; and where statements begin and end.
//!
//! It reads the text as it stands, half-typed or not, without files and without knowing any symbol. It never fails: what
//! it does not understand is still a token. The parser (`syntax`) decides what is right; this says what is where.

mod code;
mod declaration;

use super::lines::{LineKind, Lines};
use crate::source::quoted_end;
use crate::syntax::words::{self, Class, Word};

/// What a token is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Role {
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
pub(super) struct Token {
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
pub(super) struct Statement {
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
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// Its lines.
    pub lines: Lines,
    /// All tokens in order of the text.
    pub tokens: Vec<Token>,
    /// All statements in order of their beginning.
    pub statements: Vec<Statement>,
}

/// Words of the language inside of statements, beside those that begin one.
pub(super) const INNER_WORDS: &[&str] = &[
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

#[derive(Default)]
struct Scanner<'a> {
    text: &'a str,
    code: &'a str,
    scan: Scan,
    frames: Vec<Frame>,
    /// Statements that are open, outermost first.
    open: Vec<usize>,
    /// The next word begins a statement inside of a block.
    expects: bool,
    /// A word was read whose parentheses hold statements.
    control: bool,
    /// First word of the statement.
    word: String,
    /// In data; in the lines of a table.
    data: bool,
    table: bool,
}

impl Scan {
    /// Takes a text apart; `slashes`: `//` begins a comment.
    pub(super) fn of(text: &str, slashes: bool) -> Self {
        let mut lines = Lines::of(text, slashes);
        let code = std::mem::take(&mut lines.code);
        let mut s = Scanner {
            text,
            code: &code,
            scan: Scan {
                lines,
                ..Scan::default()
            },
            ..Scanner::default()
        };
        let mut at = 0;
        while at < code.len() {
            let blank = words::is_blank(code.as_bytes()[at]) || !code.is_char_boundary(at);
            at = match (blank, s.open.is_empty()) {
                (true, _) => at + 1,
                (_, true) => s.start(at),
                _ => s.code(at),
            };
        }
        s.end(false);
        s.lines();
        let mut scan = s.scan;
        scan.lines.code = code;
        // A statement without a word is none.
        scan.statements.retain(|s| s.first < s.end);
        scan
    }

    /// The token at a byte, or the one that ends there.
    pub(super) fn token_at(&self, at: usize) -> Option<usize> {
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
    pub(super) fn statement_at(&self, at: usize) -> Option<&Statement> {
        let before = self.statements.iter().rev();
        before
            .filter(|s| self.tokens[s.first].lo <= at)
            .find(|s| !s.whole || self.tokens[s.end - 1].hi > at)
    }

    /// The text of a token.
    pub(super) fn text_of<'t>(&self, token: usize, text: &'t str) -> &'t str {
        self.tokens.get(token).map_or("", |t| &text[t.lo..t.hi])
    }
}

impl Scanner<'_> {
    fn push(&mut self, lo: usize, hi: usize, role: Role) -> usize {
        self.scan.tokens.push(Token {
            lo,
            hi,
            role,
            data: self.data,
            table: self.table,
        });
        self.scan.tokens.len() - 1
    }

    /// Puts comments, directives and what is not read between the words.
    fn lines(&mut self) {
        let lines = std::mem::take(&mut self.scan.lines);
        let words = self.scan.tokens.len();
        for c in &lines.comments {
            self.push(c.lo, c.hi, Role::Comment);
        }
        for (line, kind) in lines.kinds.iter().enumerate() {
            let range = lines.range(line, self.text);
            match kind {
                LineKind::Comment => drop(self.push(range.lo, range.hi, Role::Comment)),
                LineKind::Raw if range.hi > range.lo => {
                    self.push(range.lo, range.hi, Role::Raw);
                }
                LineKind::Directive => self.directive(range.lo, range.hi),
                _ => {}
            }
        }
        self.scan.lines = lines;
        let mut order: Vec<usize> = (0..self.scan.tokens.len()).collect();
        order.sort_by_key(|&t| self.scan.tokens[t].lo);
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(n, &t)| place[t] = n);
        self.scan.tokens = order.iter().map(|&t| self.scan.tokens[t]).collect();
        for s in &mut self.scan.statements {
            let last = s.end.min(words).checked_sub(1).filter(|l| *l >= s.first);
            s.end = last.map_or(0, |l| place[l] + 1);
            s.first = place.get(s.first).copied().unwrap_or(s.end);
            s.block = s.block.map(|b| place[b]);
        }
    }

    /// Where the line ends that a byte stands in, or a comment begins.
    fn line_end(&self, at: usize) -> usize {
        let end =
            memchr::memchr(b'\n', &self.code.as_bytes()[at..]).map_or(self.code.len(), |n| at + n);
        let comments = &self.scan.lines.comments;
        let next = comments.get(comments.partition_point(|c| c.lo <= at));
        next.map_or(end, |c| c.lo.min(end))
    }

    /// A line with a directive: its name, and the words behind it.
    fn directive(&mut self, lo: usize, hi: usize) {
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

    /// At the first byte of a statement: a `;` alone, a declaration, or the code that is to be read.
    fn start(&mut self, i: usize) -> usize {
        if self.code.as_bytes()[i] == b';' {
            self.push(i, i + 1, Role::Semicolon);
            return i + 1;
        }
        let (class, end) = words::classify(self.code, i);
        self.begin(class);
        if class.declares() {
            return self.declaration(class, i, end);
        }
        let first = words::word_end(self.code.as_bytes(), i);
        self.word = self.code[i..first].to_ascii_lowercase();
        i
    }
}

/// Whether symbols may stand behind a directive.
fn names_symbols(directive: &str) -> bool {
    const WORDS: &[&str] = &["macro", "kill", "clear", "onput"];
    #[rustfmt::skip]
    const BEGINNINGS: &[&str] = &[
        "if", "elseif", "eval", "load", "unload", "gdxload", "gdxunload",
    ];
    WORDS.contains(&directive) || BEGINNINGS.iter().any(|b| directive.starts_with(b))
}
