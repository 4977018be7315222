//! From pest's errors to diagnostics that say what is wrong and how to mend it.
//!
//! pest says how far it came and what it would have accepted there. That is the last resort: first
//! the text is looked at for a missing `;`, for what other languages write in this place
//! ([`super::neighbours`]), and for the common slips.

use pest::Parser as _;
use pest::error::{Error, ErrorVariant, InputLocation};

use super::build::Condensed;
use super::foreign::{self, Language};
use super::grammar::{Grammar, Rule};
use super::neighbours;
use super::slips;
use super::split::Raw;
use super::words::{self, Class};
use crate::diag::Diagnostic;
use crate::source::{Span, outside_quotes};

/// What is wrong with a statement, and whether it is two.
pub(super) struct Explanation {
    /// None: it was said for a statement before.
    pub(super) diagnostic: Option<Diagnostic>,
    pub(super) go_on: GoOn,
    /// The language that the statement comes from.
    pub(super) language: Language,
}

/// Where to read on after a statement that could not be read (places in the expanded text).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum GoOn {
    /// Behind it.
    Behind,
    /// Here.
    At(u32),
    /// A `;` is missing: the first statement ends here, the second begins there.
    Divided { end: u32, start: u32 },
    /// The text is no model.
    Nowhere,
}

impl Explanation {
    pub(super) fn of(diagnostic: Diagnostic) -> Self {
        Self {
            diagnostic: Some(diagnostic),
            go_on: GoOn::Behind,
            language: Language::Any,
        }
    }

    fn code(&self) -> &'static str {
        self.diagnostic.as_ref().map_or("", |d| d.code)
    }
}

/// A statement that the grammar did not accept.
pub(super) struct Failure<'a> {
    pub(super) raw: &'a Raw,
    pub(super) condensed: &'a Condensed,
    pub(super) expanded: &'a str,
    pub(super) rule: Rule,
    /// The text that the grammar saw.
    pub(super) text: &'a str,
    /// How far it came.
    pub(super) at: usize,
}

impl<'a> Failure<'a> {
    pub(super) fn span(&self, lo: usize, hi: usize) -> Span {
        self.condensed.span(lo, hi.min(self.text.len()))
    }

    /// The token at a byte: a word, a number, or one sign.
    pub(super) fn token(&self, at: usize) -> &'a str {
        let rest = self.text.get(at..).unwrap_or("");
        let bytes = rest.as_bytes();
        match bytes.first() {
            None => "",
            Some(b) if b.is_ascii_alphanumeric() || *b == b'_' => {
                &rest[..words::word_end(bytes, 0)]
            }
            Some(_) => &rest[..rest.chars().next().map_or(0, char::len_utf8)],
        }
    }

    /// An error; its message follows with [`Diagnostic::says`].
    pub(super) fn error(&self, code: &'static str, lo: usize, len: usize) -> Diagnostic {
        Diagnostic::error(code, self.span(lo, lo + len))
    }
}

/// Explains an error of pest.
pub(super) fn explain(
    e: &Error<Rule>,
    raw: &Raw,
    condensed: &Condensed,
    expanded: &str,
    rule: Rule,
) -> Explanation {
    let text = condensed.text(expanded);
    let at = match e.location {
        InputLocation::Pos(p) | InputLocation::Span((p, _)) => p,
    };
    let at = at.min(text.len());
    let f = Failure {
        raw,
        condensed,
        expanded,
        rule,
        text,
        at,
    };
    let found = foreign::statement(&f)
        .or_else(|| missing_semicolon(&f))
        .or_else(|| other_end(&f))
        .or_else(|| neighbours::equation(&f).map(Explanation::of))
        .or_else(|| foreign::keyword_inside(&f));
    if let Some(found) = found {
        return found;
    }
    if let Some(d) = slips::at_token(&f).or_else(|| slip(&f)) {
        let mut found = Explanation::of(d);
        if found.code() == "E0236" && closes_early(&f) {
            // What ends the block in another language is the same mistake.
            found.language = Language::Blocks;
        }
        if found.code() == "E0230" && !f.raw.class.declares() {
            // A comment mark of another language spoils its line, and all of a declaration.
            found.go_on = foreign::line_end(&f, f.at);
        }
        return found;
    }
    Explanation::of(form(&f).unwrap_or_else(|| expected(&f, e)))
}

/// `if(k = 1) …`: the parentheses of a block are closed before the error.
pub(super) fn closes_early(f: &Failure<'_>) -> bool {
    let open = f.text.find('(');
    open.and_then(|o| closing(f.text.as_bytes(), o))
        .is_some_and(|c| c < f.at)
}

/// Two statements with no `;` between them.
fn missing_semicolon(f: &Failure<'_>) -> Option<Explanation> {
    let bytes = f.text.as_bytes();
    // Where the second statement begins: at the error, or at the word before `=`, `(`, `..`.
    let mut second = f.at;
    let is_letter = |at: usize| bytes.get(at).is_some_and(|b| words::is_letter(*b));
    if !is_letter(second) {
        if !matches!(bytes.get(f.at)?, b'=' | b'.' | b'(' | b'$' | b':') {
            return None;
        }
        let before = f.text[..f.at].trim_end();
        let start = before.rfind(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        second = start.map_or(0, |n| n + 1);
    }
    if second == 0 || !is_letter(second) || !begins_statement(f.text, second) {
        return None;
    }
    let first = f.text[..second].trim_end();
    let line_start = f.text[first.len()..second].contains('\n');
    if !line_start && second != f.at {
        return None;
    }
    let complete = Grammar::parse(f.rule, first).is_ok();
    // In a block the first statement does not stand alone.
    let in_block = f.raw.class == Class::Other
        && line_start
        && !first.ends_with([
            '+', '-', '*', '/', '=', '<', '>', ',', '(', '[', '{', '$', ';', ':',
        ]);
    if !complete && !in_block {
        return None;
    }
    let end = f.span(first.len().saturating_sub(1), first.len());
    let start = f.span(second, second + f.token(second).len());
    let missing = Diagnostic::error("E0201", end)
        .says("`;` is missing at the end of this statement")
        .label("missing `;`")
        .other(start, "the next statement begins here");
    let mut found = Explanation::of(missing);
    if complete {
        let (end, start) = (end.hi, start.lo);
        found.go_on = GoOn::Divided { end, start };
    }
    Some(found)
}

/// `,`, `:` or `.` in the place of `;`.
fn other_end(f: &Failure<'_>) -> Option<Explanation> {
    let token = f.token(f.at);
    let first = f.text[..f.at].trim_end();
    if !matches!(token, "," | ":" | ".") || !f.text[f.at..].starts_with(token) {
        return None;
    }
    let rest = &f.text[f.at + 1..];
    let second = f.at + 1 + rest.len() - rest.trim_start().len();
    let ends = rest.trim().is_empty();
    if !(ends || f.text[f.at..second].contains('\n') && begins_statement(f.text, second))
        || Grammar::parse(f.rule, first).is_err()
    {
        return None;
    }
    let missing = f
        .error("E0201", f.at, 1)
        .says(format!("`;` ends a statement, not `{token}`"))
        .label("write `;`");
    let mut found = Explanation::of(missing);
    let end = f.span(first.len().saturating_sub(1), first.len()).hi;
    let start = match ends {
        true => f.raw.span.hi,
        false => f.span(second, second + 1).lo,
    };
    found.go_on = GoOn::Divided { end, start };
    Some(found)
}

/// `x =`, `x(i) =`, `x.l(i)$c =`, `e(i)..` at a byte of a text.
fn begins_statement(text: &str, at: usize) -> bool {
    let bytes = text.as_bytes();
    let mut i = words::word_end(bytes, at);
    if i == at {
        return false;
    }
    if words::statement_word(text, at, i).is_some_and(|w| !w.inside_blocks_only()) {
        return true;
    }
    let begins_line = text[..at].trim_end_matches([' ', '\t']).ends_with('\n');
    let word = &text[at..i];
    if begins_line && (word.eq_ignore_ascii_case("draw") || word.eq_ignore_ascii_case("figure")) {
        return true;
    }
    loop {
        i = words::behind_blanks(bytes, i);
        match bytes.get(i) {
            Some(b'.') if bytes.get(i + 1) == Some(&b'.') => return true,
            Some(b'.') => i = words::word_end(bytes, i + 1).max(i + 1),
            Some(b'=') => return !is_relation(&bytes[i..]),
            Some(b':') => return bytes.get(i + 1) == Some(&b'='),
            Some(b'$') => i = words::word_end(bytes, words::behind_blanks(bytes, i + 1)),
            Some(b'(') => match closing(bytes, i) {
                Some(end) => i = end + 1,
                None => return false,
            },
            _ => return false,
        }
    }
}

/// `=e=` and its kin at the start.
pub(super) fn is_relation(bytes: &[u8]) -> bool {
    bytes.len() >= 3 && bytes[0] == b'=' && bytes[1].is_ascii_alphabetic() && bytes[2] == b'='
}

/// The parenthesis that closes the one at `open`, quotes respected.
pub(super) fn closing(bytes: &[u8], open: usize) -> Option<usize> {
    let mut inside = outside_quotes(bytes, open);
    inside.next().filter(|&(_, _, depth)| depth > 0)?;
    inside.find(|&(_, _, depth)| depth == 0).map(|(at, ..)| at)
}

/// Slips of any writer.
fn slip(f: &Failure<'_>) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    let token = f.token(f.at);
    let rest = f.text.get(f.at + 1..).unwrap_or("");
    let end = words::word_end(bytes, f.at);
    let variable = rest.split_once('%').map_or("", |(name, _)| name);
    Some(match token.chars().next() {
        Some('\'' | '"') if f.raw.class == Class::File => f
            .error("E0210", f.at, 1)
            .says("a file has a name in the text, and one outside of it")
            .help("write `file out / 'out.txt' /;`, and `put out 'text' /;`"),
        Some('\'' | '"') if !rest.split('\n').next().unwrap_or("").contains(token) => f
            .error("E0206", f.at, 1)
            .says("this quote is not closed on its line")
            .help("close it; a text that holds `'` goes in `\"…\"`, and the other way round"),
        Some('\'' | '"') => f
            .error("E0210", f.at, 1)
            .says("a text in quotes cannot stand here")
            .help("is a comma, an operator or a `;` missing before it?"),
        Some(')' | ']' | '}') if unmatched_close(bytes, f.at) => f
            .error("E0207", f.at, 1)
            .says(format!("this `{token}` closes nothing"))
            .help("take it out, or write the opening parenthesis"),
        Some('%') if !variable.is_empty() && !variable.contains(char::is_whitespace) => f
            .error("E0208", f.at, variable.len() + 2)
            .says(format!("`%{variable}%` has no value"))
            .help(format!(
                "set it with `$set {variable} …` before this line, or with `-D {variable}=…`"
            )),
        Some(c) if !c.is_ascii() => {
            let help = match c {
                '\u{2018}' | '\u{2019}' | '\u{201c}' | '\u{201d}' => {
                    "write the plain quotes `'` or `\"`"
                }
                '\u{2212}' | '\u{2013}' | '\u{2014}' => "write the plain minus sign `-`",
                '\u{d7}' => "write `*`",
                '\u{f7}' => "write `/`",
                '\u{221e}' => "write `inf`",
                '\u{2211}' | '\u{3a3}' => "write `sum(i, …)`",
                '\u{221a}' => "write `sqrt(x)`",
                '\u{3c0}' => "write `pi`",
                '\u{b2}' => "write `sqr(x)`",
                '\u{2264}' => "write `=l=` in an equation, `<=` in a condition",
                '\u{2265}' => "write `=g=` in an equation, `>=` in a condition",
                '\u{2260}' => "write `<>`",
                _ => {
                    "names consist of the letters a to z, digits and `_`; other signs may stand in texts and quoted labels"
                }
            };
            let d = f.error("E0209", f.at, c.len_utf8());
            d.says(format!("`{c}` cannot stand here")).help(help)
        }
        // The point may belong to the number.
        Some('0'..='9') if bytes[f.at..end].iter().any(u8::is_ascii_alphabetic) => f
            .error("E0209", f.at, end - f.at)
            .says(format!("`{token}` is neither a number nor a name"))
            .help(match token.contains(['d', 'D']) {
                true => "exponents are written with `e`: `1e3`",
                false => {
                    "names begin with a letter; between a number and a name an operator is missing"
                }
            }),
        Some('_') => f
            .error("E0209", f.at, token.len())
            .says(format!("the name `{token}` begins with `_`"))
            .help("names begin with a letter"),
        _ if f.raw.class.declares() => return in_declaration(f, token),
        _ => return None,
    })
}

/// In the declarations: values without slashes, keywords as names.
fn in_declaration(f: &Failure<'_>, token: &str) -> Option<Diagnostic> {
    let name = f.text[..f.at].trim_end();
    // The last name, with its indices.
    let bare = name
        .rfind(['(', '[', '{'])
        .filter(|_| name.ends_with([')', ']', '}']));
    let head = &name[..bare.unwrap_or(name.len())];
    let last = head.rsplit(|c: char| c.is_whitespace() || c == ',').next();
    let name = &name[head.len() - last.map_or(0, str::len)..];
    let here = f.span(f.at, f.at).lo as usize;
    let class = f.raw.class;
    let number = token.starts_with(|c: char| c.is_ascii_digit());
    let attribute = f.token(f.at + 1).to_ascii_lowercase();
    let is_attribute = matches!(&*attribute, "l" | "lo" | "up" | "fx");
    let in_bounds = || f.text.contains(['<', '>']) || f.text[..f.at].contains(" in ");
    Some(match token {
        _ if class == Class::Equation && f.expanded[here..].starts_with("..") => f
            .error("E0221", f.at, 2)
            .says("an equation is declared in one statement and defined in another")
            .help(format!(
                "write `equation {name};` and then `{name}.. left =e= right;`"
            )),
        // `variable x.lo = 3;`
        "." if class == Class::Variable && is_attribute => f
            .error("E0220", f.at, 1 + attribute.len())
            .says("a declaration gives no bounds")
            .help(format!(
                "declare `variable {name};` and write `{name}.{attribute} = …;` in a statement of its own"
            )),
        "-" | "." if before_is_name(f.text, f.at) => f
            .error("E0209", f.at, 1)
            .says(format!("`{token}` cannot stand in a name"))
            .help("names consist of letters, digits and `_`: `unit_cost`"),
        _ if number && class == Class::Variable && in_bounds() => f
            .error("E0220", f.at, token.len())
            .says("a declaration gives no bounds")
            .help("declare `variable x;` and assign the bounds: `x.lo = 0; x.up = 5;`"),
        _ if number && f.text[..f.at].trim_end().ends_with(['(', ',']) => f
            .error("E0220", f.at, token.len())
            .says("an index position is a set, not a number")
            .help(format!("declare `set i / 1*{token} /;` and write `x(i)`")),
        "=" | ":" => {
            let help = match class {
            Class::Set => "write `set i / a, b, c /;`; a set that is computed is declared first and assigned then".to_owned(),
            Class::Model => "write `model m / all /;`".to_owned(),
            Class::Table => "leave it out: the labels of the columns stand in the next line, the rows below them".to_owned(),
            Class::Variable => {
                let bare = name.split(['(', '[', '{']).next().unwrap_or(name);
                format!("declare it first: `{name};`, and assign a start `{bare}.l = …;` or a fixed value `{bare}.fx = …;` then")
            }
            Class::Equation => format!("declare it first: `{name};`, and write what is equal in a statement of its own"),
            _ if name.ends_with([')', ']', '}']) => format!("declare it, then assign: `parameter {name}; {name} = …;`; or write `/ label 1, … /`"),
            _ => format!("write `scalar {name} / 5 /;`, or declare it first and assign then: `scalar {name}; {name} = 5;`"),
            };
            f.error("E0220", f.at, 1)
                .says("a declaration gives values between slashes")
                .label(format!("`{token}` cannot stand here"))
                .help(help)
        }
        "<" | ">" => {
            let (side, positive) = match token {
                "<" => ("up", ""),
                _ => ("lo", "`positive variable x;`, or "),
            };
            f.error("E0220", f.at, 1).says("a declaration gives no bounds")
                .help(format!("write {positive}the bound in a statement after the declaration: `{name}.{side} = …;`"))
        }
        _ => return None,
    })
}

fn before_is_name(text: &str, at: usize) -> bool {
    text[..at].ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_')
}

/// Whether the parenthesis at `at` closes none before it.
fn unmatched_close(bytes: &[u8], at: usize) -> bool {
    let before = outside_quotes(bytes, 0).take_while(|e| e.0 < at);
    before.last().is_none_or(|(_, _, depth)| depth == 0)
}

/// What a rule is called.
fn called(rule: Rule) -> Option<&'static str> {
    Some(match rule {
        Rule::expression
        | Rule::apply
        | Rule::number
        | Rule::quoted
        | Rule::group
        | Rule::aggregate
        | Rule::prefix => "an expression",
        Rule::infix => "an operator",
        Rule::relation => "a relation `=e=`, `=l=`, `=g=` or `=n=`",
        Rule::definition => "`..`",
        Rule::assignment => "`=`",
        Rule::arguments | Rule::declared_over => "indices in parentheses",
        Rule::name | Rule::reference | Rule::declaration | Rule::model | Rule::domain_item => {
            "a name"
        }
        Rule::attribute => "an attribute",
        Rule::domain => "a set or sets in parentheses",
        Rule::body | Rule::algebra => "a statement",
        Rule::using => "`using` and the type of the model",
        Rule::objective | Rule::sense => "`minimizing` or `maximizing` and a variable",
        Rule::model_items | Rule::model_item | Rule::model_name => "the name of an equation",
        Rule::body_mark => "data between slashes",
        Rule::text_mark => "a text",
        Rule::alias_group => "names in parentheses",
        Rule::direction => "`to` or `downto`",
        _ => return None,
    })
}

/// Statements of one form, where that is not kept: a text behind data, names of an alias, the value of an option.
fn form(f: &Failure<'_>) -> Option<Diagnostic> {
    let token = f.token(f.at);
    let say = |message: &str, help: String| {
        let d = f.error("E0210", f.at, token.len().max(1)).says(message);
        Some(d.help(help))
    };
    if f.raw.class.declares() && token.as_bytes().first() == Some(&1) {
        return say(
            "the text stands before the data",
            "write `parameter p(i) 'price' / a 1, b 2 /;`".into(),
        );
    }
    let first = f.text.trim_start();
    let word = first[..words::word_end(first.as_bytes(), 0)].to_ascii_lowercase();
    match word.as_str() {
        "alias" => {
            let names = first.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            let names: Vec<_> = names.skip(1).filter(|n| !n.is_empty()).collect();
            say(
                "the names of an alias stand in parentheses",
                format!("write `alias({});`", names.join(", ")),
            )
        }
        "option" | "options" if token.starts_with(|c: char| c.is_ascii_digit()) => {
            let before = f.text[..f.at].trim_end();
            let name = before.rsplit([' ', ',', '\n']).next().unwrap_or("reslim");
            say(
                "an option and its value are joined by `=`",
                format!("write `option {name} = {token};`"),
            )
        }
        _ => None,
    }
}

/// The last resort: what pest would have accepted.
fn expected(f: &Failure<'_>, e: &Error<Rule>) -> Diagnostic {
    let mut wanted: Vec<String> = Vec::new();
    if let ErrorVariant::ParsingError { positives, .. } = &e.variant {
        wanted.extend(positives.iter().filter_map(|r| called(*r)).map(Into::into));
    }
    for token in e.parse_attempts().iter().flat_map(|a| a.expected_tokens()) {
        let t = token.to_string();
        let t = t.trim_matches('`');
        if matches!(t, ")" | "]" | "}" | "," | "/" | "=" | "..") {
            wanted.push(format!("`{t}`"));
        }
    }
    let mut seen = Vec::new();
    wanted.retain(|w| {
        !seen.contains(w) && {
            seen.push(w.clone());
            true
        }
    });
    let token = f.token(f.at);
    let d = match token.as_bytes().first() {
        None => {
            let end = f.text.trim_end().len();
            Diagnostic::error("E0210", f.span(end.saturating_sub(1), end))
                .says("the statement ends too early")
        }
        Some(first) => {
            let shown: String = token.chars().filter(|c| !c.is_control()).take(40).collect();
            let what = match first {
                1 => "a text".into(),
                2 => "data".into(),
                _ => format!("`{shown}`"),
            };
            let d = f.error("E0210", f.at, token.len());
            d.says(format!("{what} cannot stand here"))
        }
    };
    wanted.truncate(5);
    match (wanted.pop(), wanted.join(", ")) {
        (None, _) => d,
        (Some(only), before) if before.is_empty() => d.help(format!("expected {only}")),
        (Some(last), before) => d.help(format!("expected {before} or {last}")),
    }
}
