//! Slips inside of statements, many from other languages: operators, sums, heads of blocks, lists, missing operands.
//!
//! Only statements that did not parse come here, so nothing legal is refused.

use super::explain::{Failure, closes_early, closing, is_relation};
use super::foreign::no_comment;
use super::neighbours::{is_sum, top_level};
use super::words::{self, Class};
use crate::diag::Diagnostic;
use crate::model::problem_type::ProblemType;

/// The innermost open parenthesis before a byte, and the word before it.
fn enclosing(text: &str, at: usize) -> Option<(usize, &str)> {
    let bytes = text.as_bytes();
    let mut depth = 0usize;
    let open = (0..at).rev().find(|&i| {
        match bytes[i] {
            b')' | b']' | b'}' => depth += 1,
            b'(' | b'[' | b'{' if depth == 0 => return true,
            b'(' | b'[' | b'{' => depth -= 1,
            _ => {}
        }
        false
    })?;
    Some((open, last_word(text[..open].trim_end())))
}

/// The word that a text ends with.
fn last_word(text: &str) -> &str {
    let between = |c: char| !c.is_ascii_alphanumeric() && c != '_';
    text.rsplit(between).next().unwrap_or("")
}

/// Slips inside of sums: `sum(i, j, …)`, `sum(i in I, …)`, `sum(c(i)*x(i))`.
fn sum(f: &Failure<'_>) -> Option<Diagnostic> {
    let token = f.token(f.at);
    let (open, word) = enclosing(f.text, f.at)?;
    // `sum((i in I, j in J), …)`
    let (open, word) = match word.is_empty() {
        true => enclosing(f.text, open).unwrap_or((open, word)),
        false => (open, word),
    };
    if !is_sum(word) {
        return None;
    }
    let inside = &f.text[open + 1..f.at];
    let first = inside
        .split([',', ' ', '('])
        .find(|w| !w.is_empty())
        .unwrap_or("i");
    let lower = token.to_ascii_lowercase();
    let say = |message: &str, help: String| {
        let d = f.error("E0235", f.at, token.len().max(1)).says(message);
        Some(d.help(help))
    };
    let over =
        |index| format!("write `{word}({index}, …)`, or `{word}((i,j), …)` for several indices");
    match lower.as_str() {
        "in" => say("a sum names its index alone, without `in`", over(first)),
        "for" => say("a sum names its index first", over("i")),
        "," if inside.contains(['<', '>', '=']) => {
            let condition = inside.split_once(',').map_or("", |(_, c)| c.trim());
            say(
                "the condition of a sum stands behind its index and `$`",
                format!("write `{word}({first}$({condition}), …)`"),
            )
        }
        "if" | "where" | "when" if !top_comma(inside) => say(
            "the condition of a sum stands behind its index and `$`",
            format!("write `{word}({first}$(a({first}) > 0), …)`"),
        ),
        "," => say(
            "several indices of a sum stand in parentheses of their own",
            format!("write `{word}((i,j), …)`"),
        ),
        ":" | "|" => say(
            "a comma stands between the index of a sum and its term",
            format!(
                "write `{word}({first}, …)`; a condition follows the index behind `$`: `{word}({first}$(a({first}) > 0), …)`"
            ),
        ),
        _ if !top_comma(inside) => say("a sum names its index first, then its term", over("i")),
        _ => None,
    }
}

/// `sum(i$a(i)>1, …)`
fn sum_condition(f: &Failure<'_>) -> Option<Diagnostic> {
    let (mut open, mut word) = enclosing(f.text, f.at)?;
    while !is_sum(word) {
        (open, word) = enclosing(f.text, open)?;
    }
    let close = closing(f.text.as_bytes(), open).unwrap_or(f.text.len());
    let inside = &f.text.as_bytes()[..close];
    let dollar = top_level(inside, open + 1, |b| b[0] == b'$')?;
    let end = top_level(inside, dollar, |b| b[0] == b',')?;
    top_level(&inside[..end], dollar, |b| {
        matches!(b[0], b'<' | b'>' | b'=')
    })?;
    let index = f.text[open + 1..dollar].trim();
    let condition = f.text[dollar + 1..end].trim();
    let d = f.error("E0235", dollar, end - dollar).says(IN_PARENTHESES);
    Some(d.help(format!("write `{word}({index}$({condition}), …)`")))
}

const IN_PARENTHESES: &str = "a condition with an operator stands in parentheses";

/// Whether a comma stands outside of parentheses.
fn top_comma(text: &str) -> bool {
    top_level(text.as_bytes(), 0, |b| b[0] == b',').is_some()
}

/// Signs of other languages, what is said about them, and what is written here.
#[rustfmt::skip]
const OPERATORS: &[(&str, &str)] = &[
    ("!=", "<>"), ("&&", "and"), ("||", "or"), ("/\\", "and"), ("\\/", "or"), (".*", "*"), (".^", "**"), ("./", "/"), (".+", "+"),
    ("^", "**"), ("=<", "<="), ("=>", "->"), ("~=", "<>"), ("∈", "sum(i, …)"), ("&", "and"), ("|", "or"),
    ("!", "not"), ("~", "not"), ("·", "*"), ("\\", "sum(i, …)"),
];

/// Operators of other languages.
#[rustfmt::skip]
pub(super) fn at_token(f: &Failure<'_>) -> Option<Diagnostic> {
    let known = [display, sum_condition, sum, solve, control, parts, no_name, operand, bars, operator, sign];
    known.iter().find_map(|slip| slip(f))
}

/// Whether a text stands where parsing stopped.
fn is_here(f: &Failure<'_>, op: &str) -> bool {
    f.text.as_bytes().get(f.at..f.at + op.len()) == Some(op.as_bytes())
}

fn not_an_operator(f: &Failure<'_>, at: usize, op: &str, help: impl Into<String>) -> Diagnostic {
    f.error("E0232", at, op.len())
        .says(format!("`{op}` is not an operator"))
        .help(help)
}

/// `==`, `&&`, `//`
fn operator(f: &Failure<'_>) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    // pest may stop at the second sign of an operator.
    let found = |op: &str| {
        let starts = [f.at, f.at.saturating_sub(1)];
        starts
            .into_iter()
            .find(|&i| bytes.get(i..i + op.len()) == Some(op.as_bytes()))
    };
    if let Some(at) = found("==") {
        let help = "write `=` in assignments and conditions, `=e=` in equations";
        return Some(not_an_operator(f, at, "==", help).label("write `=`"));
    }
    if let Some(at) = found("<-") {
        return Some(not_an_operator(f, at, "<-", "write `=`").label("write `=`"));
    }
    if is_here(f, "...") {
        let message = "a statement goes over several lines without a sign";
        let d = f.error("E0232", f.at, 3).says(message);
        return Some(d.help("leave `...` out"));
    }
    if let Some(at) = found("//") {
        let message = "`//` does not begin a comment in this file";
        let help = "`$eolCom //` makes it one; files named `.blk` have it from the start";
        return Some(f.error("E0230", at, 2).says(message).help(help));
    }
    let (at, op, write) = OPERATORS.iter().find_map(|(op, write)| {
        let at = match op.len() {
            2 => found(op),
            _ => is_here(f, op).then_some(f.at),
        };
        Some((at?, op, format!("write `{write}`")))
    })?;
    let base = last_word(f.text[..at].trim_end());
    if *op == "^" && ["e", "exp"].iter().any(|w| base.eq_ignore_ascii_case(w)) {
        return Some(not_an_operator(f, at, op, "write `exp(x)`"));
    }
    Some(not_an_operator(f, at, op, write.clone()).label(write))
}

/// `5 %`, `+=`, `#`, `? :`, two operators in a row, none where one is missing.
fn sign(f: &Failure<'_>) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    let say = |op: &str, help: &str| not_an_operator(f, f.at, op, help);
    let before = f.text[..f.at].trim_end();
    let behind = f.text.get(f.at + 1..).unwrap_or("");
    let arithmetic = matches!(bytes.get(f.at), Some(b'-' | b'+' | b'*' | b'/'));
    Some(match f.token(f.at) {
        "%" if !behind.contains('%') => {
            let next = behind.trim_start().chars().next();
            let ends = next.is_none_or(|c| !c.is_ascii_alphanumeric() && c != '(');
            say(
                "%",
                match before.ends_with(|c: char| c.is_ascii_digit()) && ends {
                    true => "write 5 percent as `0.05`",
                    false => {
                        "write `mod(x, y)` for the remainder; a comment is a line with `*` in its first column"
                    }
                },
            )
        }
        sign if arithmetic && behind.starts_with('=') => {
            let help = format!("write the left side again: `a = a {sign} b`");
            say(&f.text[f.at..f.at + 2], &help)
        }
        mark @ "*" if f.raw.class.declares() => no_comment(f, f.at, mark),
        mark @ "#" => no_comment(f, f.at, mark),
        ":" if f.raw.class == Class::Algebra => f
            .error("E0221", f.at, 1)
            .says("`:` does not begin an equation")
            .label("write `..`")
            .help("an equation is defined as `e(i).. left =e= right;`"),
        "?" => say("?", "write `ifThen(c, a, b)`, or `a$c + b$(not c)`"),
        _ if arithmetic && before.ends_with(['+', '-', '*', '/', '$', '=']) => f
            .error("E0212", f.at, 1)
            .says("two operators in a row")
            .label("this one needs parentheses")
            .help("write `a*(-b)`, `$(-c)`"),
        _ => return missing_operator(f),
    })
}

/// `|x|`, `5!`
fn bars(f: &Failure<'_>) -> Option<Diagnostic> {
    let before = f.text[..f.at].trim_end();
    let behind_operand = before.ends_with(|c: char| c.is_ascii_alphanumeric() || c == ')');
    let (sign, next) = (f.token(f.at), f.token(f.at + 1));
    let write = match sign {
        "|" if !behind_operand && next != "|" => "write `abs(x)`",
        "!" if behind_operand && next != "=" => "write `fact(n)`",
        _ => return None,
    };
    Some(not_an_operator(f, f.at, sign, write))
}

/// `2 x`, `f d(i,j)`, `3(x + y)`, `1,5`, `a where b`.
fn missing_operator(f: &Failure<'_>) -> Option<Diagnostic> {
    let token = f.token(f.at);
    let before = f.text[..f.at].trim_end();
    let operand =
        before.ends_with(|c: char| c.is_ascii_alphanumeric() || matches!(c, ')' | ']' | '}' | '_'));
    if f.raw.class != Class::Algebra || !operand {
        return None;
    }
    if let Some(d) = direction(f, before) {
        return Some(d);
    }
    let name = last_word(before);
    let help = match token.to_ascii_lowercase().as_str() {
        "where" | "if" | "for" | "when" => {
            "a condition stands behind `$`: `e(i)$(a(i) > 0).. …`, `x$(a > 0)`"
        }
        "in" => "write `a >= 0 and a <= 2`; whether an element is in a set says `s(i)`",
        "mod" => "write `mod(x, y)`",
        "div" => "write `floor(x/y)`",
        "," if before.ends_with(|c: char| c.is_ascii_digit())
            && f.text[f.at + 1..].starts_with(|c: char| c.is_ascii_digit()) =>
        {
            let d = f.error("E0209", f.at, 1);
            return Some(d.says("decimals stand behind a point").label("write `.`"));
        }
        t if t != "(" && is_function(name) => {
            let d = f.error("E0212", f.at, token.len());
            let d = d.says(format!("`{name}` takes its argument in parentheses"));
            return Some(d.help(format!("write `{name}({token})`")));
        }
        t if t == "(" || t.starts_with(|c: char| c.is_ascii_alphanumeric()) => {
            return (f.at > 0 && (before.contains('=') || before.contains(".."))).then(|| {
                f.error("E0212", f.at, token.len())
                    .says(format!("an operator is missing before `{token}`"))
                    .label("missing operator")
                    .help("write `*` between factors, `+` or `-` between terms")
            });
        }
        _ => return None,
    };
    Some(not_an_operator(f, f.at, token, help))
}

/// `o.. min z =e= …`
fn direction(f: &Failure<'_>, before: &str) -> Option<Diagnostic> {
    let word = last_word(before);
    let at = before.len() - word.len();
    let directs = ["min", "max", "minimize", "maximize", "minimise", "maximise"]
        .iter()
        .any(|w| word.eq_ignore_ascii_case(w));
    (directs && before[..at].trim_end().ends_with("..")).then(|| {
        f.error("E0231", at, word.len())
            .says("the direction stands in the `solve`")
            .help("write `o.. z =e= …;` and `solve m using lp minimizing z;`")
    })
}

fn is_function(word: &str) -> bool {
    const WORDS: [&str; 10] = [
        "ord", "card", "sqrt", "exp", "log", "abs", "sqr", "sin", "cos", "floor",
    ];
    WORDS.iter().any(|w| word.eq_ignore_ascii_case(w))
}

/// `3 = a`, `(a) = b`: nothing begins like this.
fn no_name(f: &Failure<'_>) -> Option<Diagnostic> {
    let lead = f.text.len() - f.text.trim_start().len();
    let first = f.token(lead);
    let sign = first.starts_with(|c: char| {
        c.is_ascii_digit() || matches!(c, '(' | '[' | '=' | '\'' | '"' | '+' | '-')
    });
    (f.raw.class == Class::Algebra && f.at == lead && sign).then(|| {
        f.error("E0210", lead, first.len())
            .says(
                "a statement begins with a keyword, or with the name of what it assigns or defines",
            )
            .help("write `a = 3;` for an assignment, `e.. x =l= 3;` for an equation")
    })
}

/// Parts in the wrong order or without their sign: attributes, conditions, declarations behind a `;`.
fn parts(f: &Failure<'_>) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    let token = f.token(f.at);
    let before = f.text[..f.at].trim_end();
    let lead = f.text.len() - f.text.trim_start().len();
    let algebra = f.raw.class == Class::Algebra;
    let say = |at, len, message: &str, help: String| {
        Some(f.error("E0210", at, len).says(message).help(help))
    };
    // Behind the name and indices that the statement begins with.
    let word = words::word_end(bytes, lead);
    let named = match bytes.get(word) {
        Some(b'(' | b'[' | b'{') => closing(bytes, word).map_or(word, |c| c + 1),
        _ => word,
    };
    let dots = top_level(bytes, f.at, |b| b.starts_with(b".."));
    match token {
        "." if before.ends_with([')', ']', '}']) && bytes.get(f.at + 1).is_some_and(u8::is_ascii_alphabetic) => {
            let open = (0..f.at).rev().find(|&o| closing(bytes, o) == Some(before.len() - 1))?;
            let name = last_word(f.text[..open].trim_end());
            let attribute = &f.text[f.at + 1..words::word_end(bytes, f.at + 1)];
            let help = match f.text[lead..word].eq_ignore_ascii_case("display") {
                true => format!("`display` takes whole symbols: write `display {name}.{attribute};`"),
                false => format!("write `{name}.{attribute}{}`", &before[open..]),
            };
            say(f.at, attribute.len() + 1, "an attribute stands before the indices", help)
        }
        "/" | "'" | "\"" if algebra && word > lead && before.len() == named => say(
            lead,
            word - lead,
            "a declaration begins with its keyword",
            format!("the `;` before it has ended the declaration above: write `,` there, or `set {} / … /;`", &f.text[lead..named]),
        ),
        "in" if algebra && enclosing(f.text, f.at).is_some_and(|(open, _)| open == word) => say(
            f.at,
            2,
            "an index stands alone, without `in`",
            format!("for some elements of a set write a condition, `{}(i)$s(i)`, with a subset, `set s(i) / a, b /;`", &f.text[lead..word]),
        ),
        "+" | "-" if algebra && before.len() == named && bytes.get(f.at + 1) == bytes.get(f.at) => Some(
            f.error("E0232", f.at, 2).says(format!("nothing stands behind `{token}{token}`"))
                .help(format!("write `a = a {token} 1;`")),
        ),
        "" | ")" | "]" | "}" if before.ends_with("++") || before.ends_with("--") => {
            let (sign, index) = (&before[before.len() - 2..], enclosing(f.text, f.at).map(|(open, _)| &f.text[open + 1..before.len() - 2]));
            Some(
                f.error("E0232", before.len() - 2, 2).says(format!("nothing stands behind `{sign}`"))
                    .help(match index {
                        Some(index) => format!("a circular lead or lag needs its number: `{index}{sign}1`"),
                        None => format!("write `a = a {} 1;`", &sign[..1]),
                    }),
            )
        }
        "," if algebra && before.len() == named && dots.is_some() => say(
            f.at,
            1,
            "a condition stands behind `$`",
            format!("write `{before}$({})..`", f.text[f.at + 1..dots?].trim()),
        ),
        "," if algebra && enclosing(f.text, f.at).is_none() && (before.contains('=') || before.contains("..")) && !before.ends_with(|c: char| c.is_ascii_digit()) | (bytes.get(f.at + 1) == Some(&b' ')) => say(
            f.at,
            1,
            "a statement ends with `;`, not with `,`",
            "write `;` between two statements; an equation holds for all elements of the index behind its name, `e(i).. …`".into(),
        ),
        _ if is_sum(token) && !f.text[f.at + token.len()..].trim_start().starts_with(['(', '[', '{']) => Some(
            f.error("E0235", f.at, token.len()).says(format!("`{token}` takes its index and its term in parentheses"))
                .help(format!("write `{token}(i, …)`, or `{token}((i,j), …)` for several indices")),
        ),
        _ if matches!(token.to_ascii_lowercase().as_str(), "else" | "elseif") && before.ends_with(',') => say(
            before.len() - 1,
            1,
            "`;` ends the statement before `else`, not `,`",
            "write `if(c, … ; else … );`".into(),
        ),
        _ if algebra => condition(f, lead, token),
        _ => None,
    }
}

/// `e(i)$a(i)>1..`, `p(i)$a(i)>1 = 2`: a condition of several parts without parentheses.
fn condition(f: &Failure<'_>, lead: usize, token: &str) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    let dollar = top_level(bytes, lead, |b| b[0] == b'$').filter(|d| *d < f.at)?;
    let ends = |b: &[u8]| b.starts_with(b"..") || b[0] == b'=' && !is_relation(b);
    let operator = matches!(token, "<" | ">" | "+" | "-" | "*" | "/" | "=")
        || ["and", "or", "xor", "eq", "ne", "lt", "gt", "le", "ge"]
            .iter()
            .any(|w| token.eq_ignore_ascii_case(w));
    let early = top_level(bytes, dollar, ends).filter(|e| *e < f.at);
    let dots = top_level(bytes, f.at, |b| b.starts_with(b".."));
    let end = match (operator, early) {
        (true, None) => dots.or_else(|| top_level(bytes, f.at + 1, ends))?,
        // `$a = 1..`
        (_, Some(_)) if dots == Some(f.at) => f.at,
        _ => return None,
    };
    let condition = f.text[dollar + 1..end].trim();
    let head = f.text[lead..dollar].trim_end();
    let d = f.error("E0210", dollar, end - dollar).says(IN_PARENTHESES);
    Some(d.help(format!("write `{head}$({condition})`")))
}

/// Directives that are often written behind a statement.
#[rustfmt::skip]
const DIRECTIVES: [&str; 8] = [
    "gdxIn", "load", "loadDC", "include", "set", "setGlobal", "onText", "call",
];

/// What stands where an operand should, or where one is missing.
fn operand(f: &Failure<'_>) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    let token = f.token(f.at);
    let before = f.text[..f.at].trim_end();
    let enclosing = enclosing(f.text, f.at);
    let open = enclosing.map(|(at, _)| bytes[at]);
    let list = enclosing.is_some_and(|(at, word)| bytes[at] != b'(' && word.is_empty());
    let algebra = f.raw.class == Class::Algebra;
    let next = f.token(f.at + 1);
    let here = |code| f.error(code, f.at, 1);
    Some(match token {
        "[" | "("
            if before.ends_with([']', ')'])
                && before[..before.len() - 1].ends_with(|c: char| c.is_ascii_alphanumeric())
                && algebra =>
        {
            here("E0210")
                .says("all indices stand in one pair of parentheses")
                .help("write `x(i,j)`; between factors stands `*`")
        }
        "@" => here("E0231")
            .says("`@` cannot stand in an expression")
            .help("functions and sums have no mark: `sum(i, x(i))`, `exp(x)`; a formula that is used often can be a `$macro f(x) (…)`"),
        "$" if DIRECTIVES.iter().any(|d| next.eq_ignore_ascii_case(d)) => f
            .error("E0210", f.at, 1 + next.len())
            .says("a directive begins its line")
            .help("write it on a line of its own, `$` in the first column"),
        "$" if bytes.get(f.at + 1).is_some_and(u8::is_ascii_alphabetic)
            && !before.ends_with(|c: char| c.is_ascii_alphanumeric() || c == ')') =>
        {
            here("E0231")
                .says("a cell of a spreadsheet has no value here")
                .help("give the number a name: `scalar price / 2.5 /;`, and use the name")
        }
        "," if list => here("E0231")
            .says("a list of numbers is no value")
            .help("numbers belong to labels: `set i / a, b, c /; parameter p(i) / a 1, b 2, c 3 /;`"),
        "," if open.is_none()
            && algebra
            && before.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') =>
        {
            here("E0210")
                .says("an assignment has one name on its left")
                .help("write `a = 1; b = 2;`")
        }
        ")" | "]" | "}" => {
            let (at, _) = enclosing?;
            if matches!((bytes[at], token), (b'(', ")") | (b'[', "]") | (b'{', "}")) {
                return None;
            }
            f.error("E0202", f.at, 1)
                .says(format!("`{}` is closed by `{token}`", bytes[at] as char))
                .other(f.span(at, at + 1), "opened here")
                .help("the closing parenthesis is of the kind of the opening one")
        }
        "=" if is_relation(&bytes[f.at..]) && before.ends_with(['+', '-', '*', '/']) => f
            .error("E0212", before.len() - 1, 1)
            .says("an operand is missing behind this operator")
            .help("write what is added or multiplied, or take the operator out"),
        "" if before.len() > 2 && is_relation(&bytes[before.len() - 3..]) => f
            .error("E0210", before.len() - 3, 3)
            .says("the right side of the equation is missing")
            .help("write an expression behind the relation, at least `0`"),
        "" if algebra && !before.contains('=') && !before.contains("..") => {
            let lead = f.text.len() - f.text.trim_start().len();
            let d = f.error("E0210", lead, before.len() - lead);
            match !before.contains('.') && behind_declaration(f, lead) {
                true => d
                    .says("a declaration begins with its keyword")
                    .help("the `;` before it has ended the declaration above: write `,` there, or repeat the keyword"),
                false => d
                    .says("this is not a statement")
                    .help("values are shown with `display x.l;`, assigned with `p = …;`, related in equations with `e.. … =e= …;`; models are solved with `solve m using lp minimizing z;`"),
            }
        }
        _ => return None,
    })
}

/// Whether the statement above is a declaration.
fn behind_declaration(f: &Failure<'_>, lead: usize) -> bool {
    let above = &f.expanded[..f.span(lead, lead).lo as usize];
    let above = above.trim_end().trim_end_matches(';');
    let above = above[above.rfind(';').map_or(0, |n| n + 1)..].trim_start();
    !above.is_empty() && words::classify(above, 0).0.declares()
}

/// Letters, digits and `_`, and nothing else.
fn is_name(text: &str) -> bool {
    !text.is_empty() && words::word_end(text.as_bytes(), 0) == text.len()
}

/// `i, j` of `i, j, statement`, the head of a loop without parentheses around its indices.
fn second_index(head: &str) -> Option<String> {
    let mut parts = head.splitn(3, ',').map(str::trim);
    let (first, second) = (parts.next()?, parts.next()?);
    parts.next()?;
    (is_name(first) && is_name(second)).then(|| format!("{first},{second}"))
}

/// Slips in the heads of `loop`, `for`, `if` and `while`.
fn control(f: &Failure<'_>) -> Option<Diagnostic> {
    if f.raw.class != Class::Other {
        return None;
    }
    let text = f.text.trim_start();
    let word = text[..words::word_end(text.as_bytes(), 0)].to_ascii_lowercase();
    let open = f.text.find('(')?;
    if f.at < open || !matches!(word.as_str(), "loop" | "for" | "if" | "while") {
        return None;
    }
    let token = f.token(f.at);
    let head = &f.text[open + 1..f.at];
    let say = |message: &str, help: &str| {
        let d = f.error("E0236", f.at, token.len().max(1)).says(message);
        Some(d.help(help))
    };
    let lower = f.text[..f.at].to_ascii_lowercase();
    let split = ["else if ", "elif ", "elsif "]
        .iter()
        .find_map(|w| Some((lower.rfind(w)?, w.trim_end())));
    if let Some((at, written)) = split.filter(|(at, _)| word == "if" && !lower[*at..].contains(';'))
    {
        return Some(
            f.error("E0236", at, written.len())
                .says(format!("`elseif` is written for `{written}`"))
                .help("write `if(a > 0, … ; elseif a < 0, … ; else … );`"),
        );
    }
    match word.as_str() {
        "loop" if head.contains('=') && !top_comma(head) => say(
            "`loop` runs over the elements of a set",
            "write `for(k = 1 to 3, … );` to count with a scalar, `loop(i, … );` to run over a set",
        ),
        "loop" if token.eq_ignore_ascii_case("in") => say(
            "a loop names its set alone, without `in`",
            "write `loop(i, … );`",
        ),
        "loop" if second_index(head).is_some() => {
            let indices = second_index(head)?;
            say(
                "several indices of a loop stand in parentheses of their own",
                &format!("write `loop(({indices}), … );`"),
            )
        }
        // Further on the head is not to blame.
        _ if top_comma(head) && word != "for" => None,
        "for" if head.contains(';') => None,
        "for"
            if ![" to ", "downto"]
                .iter()
                .any(|w| lower[open + 1..].contains(w)) =>
        {
            say(
                "`for` counts with a scalar from one number to another",
                "write `for(k = 1 to 5, … );`; over the elements of a set runs `loop(i, … );`",
            )
        }
        _ if closes_early(f) => say(
            "the statements of a block stand inside of its parentheses",
            "write `if(a > 0, b = 2; );`, `loop(i, … );`",
        ),
        _ if token.starts_with(|c: char| c.is_ascii_alphabetic()) && word != "for" => say(
            "a comma is missing before the first statement of the block",
            "write `loop(i, … );`, `if(a > 0, … );`",
        ),
        _ => None,
    }
}

/// `display sum(…)`, `display 2*x.l`, `display(x)`
fn display(f: &Failure<'_>) -> Option<Diagnostic> {
    let text = f.text.trim_start();
    let lead = f.text.len() - text.len();
    let word = words::word_end(text.as_bytes(), 0);
    if !text[..word].eq_ignore_ascii_case("display") {
        return None;
    }
    let rest = text[word..].trim_start();
    let lo = f.text.len() - rest.len();
    let len = rest.trim_end().len();
    if rest.starts_with('(') && closing(rest.as_bytes(), 0) == Some(len - 1) {
        let message = "`display` takes its symbols without parentheses";
        let write = format!("write `display {};`", rest[1..len - 1].trim());
        return Some(f.error("E0328", lo, len).says(message).help(write));
    }
    if rest.starts_with(['\'', '"']) && f.token(f.at) == "+" {
        let message = "`display` takes texts and symbols, with commas between them";
        let write = "write `display 'total', z.l;`";
        return Some(f.error("E0328", f.at, 1).says(message).help(write));
    }
    let expression = is_sum(&rest[..words::word_end(rest.as_bytes(), 0)])
        || matches!(f.token(f.at), "*" | "+" | "-" | "/" | "(")
        || rest.starts_with(|c: char| c.is_ascii_digit());
    expression.then(|| {
        f.error("E0328", lo.max(lead), len)
            .says("`display` takes symbols, not expressions")
            .help("assign it first: `parameter total; total = …; display total;`")
    })
}

/// `minimizing sum(…)`, `minimizing (z)`
fn solve(f: &Failure<'_>) -> Option<Diagnostic> {
    let first = &f.text.trim_start()[..words::word_end(f.text.trim_start().as_bytes(), 0)];
    if !first.eq_ignore_ascii_case("solve") {
        return None;
    }
    let lower = f.text.to_ascii_lowercase();
    let token = f.token(f.at);
    let said = |message: &str, help: &str| {
        Some(f.error("E0218", f.at, token.len()).says(message).help(help))
    };
    if ProblemType::named(token).is_some() {
        let write = format!("write `solve m using {token} minimizing z;`");
        return said("`using` stands before the type of the model", &write);
    }
    match token.to_ascii_lowercase().as_str() {
        "," => {
            let write = "write `solve m using lp minimizing z;`";
            return said("a `solve` has no commas", write);
        }
        "with" => {
            let write = "write `option lp = simplex;` before the `solve`";
            return said("the solver is chosen by an option", write);
        }
        "subject" | "st" | "such" | "where" => {
            let message = "the equations are listed where the model is declared";
            return said(message, "write `model m / o, r /;` or `model m / all /;`");
        }
        _ => {}
    }
    let at = ["minimi", "maximi"].iter().find_map(|w| lower.find(w))?;
    let from = words::word_end(f.text.as_bytes(), at);
    let rest = f.text[from..].trim();
    let lo = from + f.text[from..].len() - f.text[from..].trim_start().len();
    let d = f
        .error("E0357", lo, rest.len())
        .says("the objective is the name of a variable");
    Some(match rest.strip_prefix('(').and_then(|r| r.strip_suffix(')')) {
        Some(name) if is_name(name.trim()) => d.help(format!("write `minimizing {}`", name.trim())),
        _ if rest.starts_with(|c: char| c.is_ascii_alphabetic() || c == '(' || c.is_ascii_digit()) && rest.contains(['(', '*', '+', '-']) => {
            d.help("declare `variable z; equation obj;`, write `obj.. z =e= …;` and `minimizing z`")
        }
        _ => return None,
    })
}
