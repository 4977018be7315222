//! Slips inside equations and expressions that come from other languages: comparison signs, operators, sums.
//!
//! Only statements that did not parse come here, so nothing legal is refused.

use super::explain::{Failure, closing, is_relation};
use super::words::{self, Class};
use crate::diag::Diagnostic;

/// Equations without `..`, without a relation, or with two.
pub(super) fn equation(f: &Failure<'_>) -> Option<Diagnostic> {
    if f.raw.class != Class::Algebra {
        return None;
    }
    let lead = f.text.len() - f.text.trim_start().len();
    let bytes = f.text.as_bytes();
    let dots = top_level(bytes, 0, |b| b.starts_with(b".."));
    let relation = top_level(bytes, dots.map_or(0, |d| d + 2), is_relation);
    if let Some(at) = dots
        && let Some(d) = after_dots(f, lead, at)
    {
        return Some(d);
    }
    match (dots, relation) {
        (None, Some(at)) => without_dots(f, lead, at),
        (None, None) => bound(f, lead),
        (Some(dots), None) => without_relation(f, dots),
        (Some(_), Some(first)) => {
            let second = top_level(bytes, first + 3, |b| {
                is_relation(b) || b.starts_with(b"<=") || b.starts_with(b">=")
            })?;
            Some(
                f.error("E0222", second, 3, "an equation has one relation")
                    .label("a second one")
                    .help("write two equations, or bounds: `x.lo = 1; x.up = 4;`"),
            )
        }
    }
}

/// `e... x =e= 1`, `e..(i) x(i) =l= 1`
fn after_dots(f: &Failure<'_>, lead: usize, dots: usize) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    let name = f.text[lead..dots].trim();
    match bytes.get(dots + 2) {
        Some(b'.') => Some(
            f.error(
                "E0221",
                dots,
                3,
                "two dots stand behind the name of an equation, not three",
            )
            .help(format!("write `{name}.. left =e= right;`")),
        ),
        Some(b'(') => {
            let close = closing(bytes, dots + 2)?;
            let indices = &f.text[dots + 3..close];
            let simple = indices
                .bytes()
                .all(|b| b.is_ascii_alphanumeric() || matches!(b, b',' | b' ' | b'_'));
            let next = f.text[close + 1..]
                .trim_start()
                .starts_with(|c: char| c.is_ascii_alphanumeric() || c == '(');
            (simple && next && !name.ends_with(')')).then(|| {
                f.error(
                    "E0221",
                    dots + 2,
                    close - dots - 1,
                    "the indices of an equation stand before the dots",
                )
                .help(format!("write `{name}({indices}).. left =e= right;`"))
            })
        }
        _ => None,
    }
}

/// `cost z =e= …`, `supply(i): … =l= …`, `sum(j, x(j)) =l= 3`.
fn without_dots(f: &Failure<'_>, lead: usize, relation: usize) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    let word = words::word_end(bytes, lead);
    let blanks = |from: usize| {
        from + bytes[from..]
            .iter()
            .take_while(|b| words::is_blank(**b))
            .count()
    };
    let mut end = word;
    if let Some(b'(' | b'[' | b'{') = bytes.get(blanks(word)) {
        end = closing(bytes, blanks(word))? + 1;
    }
    let (name, sign) = (&f.text[lead..end], &f.text[relation..relation + 3]);
    let operation = is_sum(&f.text[lead..word]);
    let next = blanks(end);
    let named = word > lead
        && !operation
        && bytes.get(next).is_some_and(|b| {
            words::is_letter(*b) || matches!(b, b'.' | b':' | b'(' | b'-') || b.is_ascii_digit()
        });
    if !named {
        return Some(
            f.error("E0221", lead, relation + 3 - lead, "an equation begins with its name and `..`")
                .help(format!("declare `equation e;` and write `e.. left {sign} right;`; a bound is assigned: `x.up = 3;`")),
        );
    }
    let (at, len) = match bytes[next] {
        b'.' | b':' => (next, 1),
        _ => (lead, end - lead),
    };
    Some(
        f.error(
            "E0221",
            at,
            len,
            format!("two dots stand behind the name of an equation: `{name}..`"),
        )
        .label("`..` is missing here")
        .help(format!("write `{name}.. left {sign} right;`")),
    )
}

/// `x >= 3;`, `x(i) <= 3;`, `c1: x + y <= 10;`
fn bound(f: &Failure<'_>, lead: usize) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    if top_level(bytes, lead, |b| b[0] == b'=' && !b.starts_with(b"=="))
        .is_some_and(|at| !matches!(bytes[at.saturating_sub(1)], b'<' | b'>'))
    {
        return None;
    }
    let at = top_level(bytes, lead, |b| {
        b[0] == b'<' || b[0] == b'>' || b.starts_with(b"==")
    })?;
    let left = f.text[lead..at].trim();
    let len = bytes[at..]
        .iter()
        .take_while(|b| matches!(b, b'<' | b'>' | b'='))
        .count();
    let (sign, side) = match bytes[at] {
        b'<' => ("=l=", "up"),
        b'>' => ("=g=", "lo"),
        _ => ("=e=", "fx"),
    };
    let word = words::word_end(left.as_bytes(), 0);
    let indices = left[word..].trim();
    let simple = word > 0
        && (indices.is_empty()
            || indices.starts_with('(')
                && closing(indices.as_bytes(), 0) == Some(indices.len() - 1));
    let d = f.error(
        "E0222",
        at,
        len,
        format!(
            "`{}` compares known numbers; it states no constraint",
            &f.text[at..at + len]
        ),
    );
    let equation = format!("declare `equation e;` and write `e.. left {sign} right;`");
    Some(match simple && !is_sum(&left[..word]) {
        true => d.help(format!(
            "a bound is assigned: `{}.{side}{indices} = …;`; for a constraint {equation}",
            &left[..word]
        )),
        false => d.help(equation),
    })
}

fn is_sum(word: &str) -> bool {
    ["sum", "prod", "smin", "smax"]
        .iter()
        .any(|s| word.eq_ignore_ascii_case(s))
}

/// `e.. x <= 3`, `e.. x =ge= 3`, `e.. x;`
fn without_relation(f: &Failure<'_>, dots: usize) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    let compare = top_level(bytes, dots + 2, |b| {
        matches!(b[0], b'<' | b'>' | b'=' | b':')
            || b.starts_with(b"~=")
            || b.starts_with("≤".as_bytes())
            || b.starts_with("≥".as_bytes())
    });
    let Some(at) = compare else {
        let end = f.text.trim_end().len();
        let said = f.error(
            "E0222",
            end.saturating_sub(1),
            1,
            "this equation has no relation",
        );
        return (f.at >= end)
            .then(|| said.help("write `=e=`, `=l=`, `=g=` or `=n=` between its sides"));
    };
    let rest = &f.text[at..];
    // `=ge=`, `= l =`
    let spelled = rest.strip_prefix('=').and_then(|r| r.split_once('='));
    let word = |w: &&str| !w.is_empty() && w.trim().bytes().all(|b| b.is_ascii_alphabetic());
    let spelled = spelled.map(|(w, _)| w).filter(word);
    let (len, meant) = match spelled {
        Some(word) => {
            let meant = match word.trim().to_ascii_lowercase().as_bytes() {
                [b'l', ..] => "=l=",
                [b'g', ..] => "=g=",
                _ => "=e=",
            };
            (word.len() + 2, meant)
        }
        None => {
            let signs = rest
                .chars()
                .take_while(|c| matches!(c, '<' | '>' | '=' | '~' | ':' | '≤' | '≥'));
            let len = signs.map(char::len_utf8).sum::<usize>();
            let meant = match rest.chars().next() {
                Some('<' | '≤') => "=l=",
                Some('>' | '≥') => "=g=",
                _ if rest[..len].contains('<') => "=l=",
                _ if rest[..len].contains('>') => "=g=",
                _ => "=e=",
            };
            (len, meant)
        }
    };
    let twice = top_level(bytes, at + len, |b| matches!(b[0], b'<' | b'>')).is_some();
    let d = f
        .error(
            "E0222",
            at,
            len,
            format!(
                "an equation relates its sides by `{meant}`, not by `{}`",
                &rest[..len]
            ),
        )
        .label(format!("write `{meant}`"));
    Some(match twice {
        true => d.help(
            "an equation has one relation: write two equations, or bounds: `x.lo = 0; x.up = 4;`",
        ),
        false => d.help(
            "`=`, `<=`, `>=` compare known numbers; `=e=`, `=l=`, `=g=` state what must hold",
        ),
    })
}

/// The first byte from `from` on, outside parentheses and quotes, where `test` holds.
fn top_level(bytes: &[u8], from: usize, test: impl Fn(&[u8]) -> bool) -> Option<usize> {
    let mut depth = 0usize;
    let mut i = from;
    while i < bytes.len() {
        match bytes[i] {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            q @ (b'\'' | b'"') => {
                i += memchr::memchr(q, &bytes[i + 1..]).map_or(1, |n| n + 2);
                continue;
            }
            _ if depth == 0 && test(&bytes[i..]) => return Some(i),
            _ => {}
        }
        i += 1;
    }
    None
}

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
    let before = text[..open].trim_end();
    let start = before
        .rfind(|c: char| !c.is_ascii_alphanumeric() && c != '_')
        .map_or(0, |n| n + 1);
    Some((open, &before[start..]))
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
        Some(
            f.error("E0235", f.at, token.len().max(1), message)
                .help(help),
        )
    };
    match lower.as_str() {
        "in" => say(
            "a sum names its index alone, without `in`",
            format!("write `{word}({first}, …)`, or `{word}((i,j), …)` for several indices"),
        ),
        "for" => say(
            "a sum names its index first",
            format!("write `{word}(i, …)`, or `{word}((i,j), …)` for several indices"),
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
        _ if !top_comma(inside) => say(
            "a sum names its index first, then its term",
            format!("write `{word}(i, …)`, or `{word}((i,j), …)` for several indices"),
        ),
        _ => None,
    }
}

/// Whether a comma stands outside of parentheses.
fn top_comma(text: &str) -> bool {
    top_level(text.as_bytes(), 0, |b| b[0] == b',').is_some()
}

/// Signs of other languages, what is said about them, and what is written here.
#[rustfmt::skip]
const OPERATORS: &[(&str, &str)] = &[
    ("!=", "<>"), ("&&", "and"), ("||", "or"), ("/\\", "and"), ("\\/", "or"), (".*", "*"), (".^", "**"), ("./", "/"), (".+", "+"),
    ("^", "**"), ("=<", "<="), ("=>", "->"), ("~=", "<>"), ("∈", "sum(i, …)"), ("&", "and"), ("|", "or"),
    ("!", "not"), ("~", "not"), ("·", "*"),
];

/// Operators of other languages.
pub(super) fn at_token(f: &Failure<'_>) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    if let Some(d) = sum(f)
        .or_else(|| display(f))
        .or_else(|| solve(f))
        .or_else(|| control(f))
        .or_else(|| no_name(f))
    {
        return Some(d);
    }
    let here = |op: &str| bytes.get(f.at..f.at + op.len()) == Some(op.as_bytes());
    // pest may stop at the second sign of an operator.
    let found = |op: &str| {
        let starts = [f.at, f.at.saturating_sub(1)];
        starts
            .into_iter()
            .find(|&i| bytes.get(i..i + op.len()) == Some(op.as_bytes()))
    };
    let say = |at: usize, op: &str, help: String| {
        f.error("E0232", at, op.len(), format!("`{op}` is not an operator"))
            .help(help)
    };
    if let Some(at) = found("==") {
        return Some(
            say(
                at,
                "==",
                "write `=` in assignments and conditions, `=e=` in equations".into(),
            )
            .label("write `=`"),
        );
    }
    if here("...") {
        return Some(
            f.error(
                "E0232",
                f.at,
                3,
                "a statement goes over several lines without a sign",
            )
            .help("leave `...` out"),
        );
    }
    if let Some(at) = found("//") {
        return Some(
            f.error("E0230", at, 2, "`//` does not begin a comment in this file")
                .help("`$eolCom //` makes it one; files named `.blk` have it from the start"),
        );
    }
    for (op, write) in OPERATORS {
        let at = if op.len() == 2 {
            found(op)
        } else {
            here(op).then_some(f.at)
        };
        if let Some(at) = at {
            return Some(say(at, op, format!("write `{write}`")).label(format!("write `{write}`")));
        }
    }
    if here("%") && !f.text[f.at + 1..].contains('%') {
        let number = f.text[..f.at]
            .trim_end()
            .ends_with(|c: char| c.is_ascii_digit());
        let ends = f.text[f.at + 1..]
            .trim_start()
            .starts_with(|c: char| !c.is_ascii_alphanumeric() && c != '(')
            || f.text[f.at + 1..].trim().is_empty();
        return Some(match number && ends {
            true => say(f.at, "%", "write 5 percent as `0.05`".into()),
            false => say(f.at, "%", "write `mod(x, y)` for the remainder; a comment is a line with `*` in its first column".into()),
        });
    }
    if bytes.get(f.at + 1) == Some(&b'=')
        && matches!(bytes.get(f.at), Some(b'+' | b'-' | b'*' | b'/'))
    {
        let op = &f.text[f.at..f.at + 2];
        return Some(say(
            f.at,
            op,
            format!("write the left side again: `a = a {} b`", &op[..1]),
        ));
    }
    if here("#") {
        return Some(
            f.error("E0230", f.at, 1, "`#` does not begin a comment")
                .help("a comment is a line with `*` in its first column; in a `.blk` file also `//`; `$onEolCom` allows `!!` to the end of the line"),
        );
    }
    if here(":") && f.raw.class == Class::Algebra {
        return Some(
            f.error("E0221", f.at, 1, "`:` does not begin an equation")
                .label("write `..`")
                .help("an equation is defined as `e(i).. left =e= right;`"),
        );
    }
    if here("?") {
        return Some(say(
            f.at,
            "?",
            "write `ifThen(c, a, b)`, or `a$c + b$(not c)`".into(),
        ));
    }
    let unary = matches!(bytes.get(f.at), Some(b'-' | b'+' | b'*' | b'/'));
    if unary
        && f.text[..f.at]
            .trim_end()
            .ends_with(['+', '-', '*', '/', '$', '='])
    {
        return Some(
            f.error("E0212", f.at, 1, "two operators in a row")
                .label("this one needs parentheses")
                .help("write `a*(-b)`, `$(-c)`"),
        );
    }
    missing_operator(f)
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
    match token.to_ascii_lowercase().as_str() {
        "where" | "if" | "for" | "when" => Some(
            f.error(
                "E0232",
                f.at,
                token.len(),
                format!("`{token}` is not an operator"),
            )
            .help("a condition stands behind `$`: `e(i)$(a(i) > 0).. …`, `x$(a > 0)`"),
        ),
        "div" | "mod" => Some(
            f.error(
                "E0232",
                f.at,
                token.len(),
                format!("`{token}` is not an operator"),
            )
            .help(match token.len() {
                3 if token.eq_ignore_ascii_case("mod") => "write `mod(x, y)`",
                _ => "write `floor(x/y)`",
            }),
        ),
        "," if before.ends_with(|c: char| c.is_ascii_digit())
            && f.text[f.at + 1..].starts_with(|c: char| c.is_ascii_digit()) =>
        {
            Some(
                f.error("E0209", f.at, 1, "decimals stand behind a point")
                    .label("write `.`"),
            )
        }
        t if t != "("
            && is_function(
                &before[before
                    .rfind(|c: char| !c.is_ascii_alphanumeric())
                    .map_or(0, |n| n + 1)..],
            ) =>
        {
            let name = &before[before
                .rfind(|c: char| !c.is_ascii_alphanumeric())
                .map_or(0, |n| n + 1)..];
            Some(
                f.error(
                    "E0212",
                    f.at,
                    token.len(),
                    format!("`{name}` takes its argument in parentheses"),
                )
                .help(format!("write `{name}({token})`")),
            )
        }
        t if t == "(" || t.starts_with(|c: char| c.is_ascii_alphanumeric()) => {
            let help = "write `*` between factors, `+` or `-` between terms";
            (f.at > 0 && (before.contains('=') || before.contains(".."))).then(|| {
                f.error(
                    "E0212",
                    f.at,
                    token.len(),
                    format!("an operator is missing before `{token}`"),
                )
                .label("missing operator")
                .help(help)
            })
        }
        _ => None,
    }
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
        f.error(
            "E0210",
            lead,
            first.len(),
            "a statement begins with a keyword, or with the name of what it assigns or defines",
        )
        .help("write `a = 3;` for an assignment, `e.. x =l= 3;` for an equation")
    })
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
        Some(
            f.error("E0236", f.at, token.len().max(1), message)
                .help(help),
        )
    };
    match word.as_str() {
        // Further on the head is not to blame.
        _ if top_comma(head) && word != "for" => None,
        "for"
            if head.contains(';')
                || top_level(head.as_bytes(), 0, |b| b.starts_with(b","))
                    .is_some_and(|at| head[at..].contains(';')) =>
        {
            None
        }
        "for"
            if !head.to_ascii_lowercase().contains(" to ")
                && !head.to_ascii_lowercase().contains("downto") =>
        {
            say(
                "`for` counts with a scalar from one number to another",
                "write `for(k = 1 to 5, … );`; over the elements of a set runs `loop(i, … );`",
            )
        }
        _ if closing(f.text.as_bytes(), open).is_some_and(|c| c < f.at) => say(
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
        let inside = rest[1..len - 1].trim();
        return Some(
            f.error(
                "E0328",
                lo,
                len,
                "`display` takes its symbols without parentheses",
            )
            .help(format!("write `display {inside};`")),
        );
    }
    let expression = is_sum(&rest[..words::word_end(rest.as_bytes(), 0)])
        || matches!(f.token(f.at), "*" | "+" | "-" | "/" | "(")
        || rest.starts_with(|c: char| c.is_ascii_digit());
    expression.then(|| {
        f.error(
            "E0328",
            lo.max(lead),
            len,
            "`display` takes symbols, not expressions",
        )
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
    let at = ["minimi", "maximi"].iter().find_map(|w| lower.find(w))?;
    let from = words::word_end(f.text.as_bytes(), at);
    let rest = f.text[from..].trim();
    let lo = from + f.text[from..].len() - f.text[from..].trim_start().len();
    let d = f.error(
        "E0357",
        lo,
        rest.len(),
        "the objective is the name of a variable",
    );
    Some(match rest.strip_prefix('(').and_then(|r| r.strip_suffix(')')) {
        Some(name) if name.trim().bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') => d.help(format!("write `minimizing {}`", name.trim())),
        _ if rest.starts_with(|c: char| c.is_ascii_alphabetic() || c == '(' || c.is_ascii_digit()) && rest.contains(['(', '*', '+', '-']) => {
            d.help("declare `variable z; equation obj;`, write `obj.. z =e= …;` and `minimizing z`")
        }
        _ => return None,
    })
}
