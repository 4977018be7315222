//! What people bring along from other languages: AMPL, MiniZinc, Pyomo, C, textbooks.
//!
//! Only statements that did not parse come here, so nothing legal is refused.

use super::explain::{Failure, is_relation};
use super::words::{self, Class};
use crate::diag::Diagnostic;

/// The words of a text, in lower case, up to a few.
fn first_words(text: &str) -> Vec<String> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_')
        .filter(|w| !w.is_empty())
        .take(4)
        .map(str::to_ascii_lowercase)
        .collect()
}

/// Statements that other languages begin with other words.
pub(super) fn whole_statement(f: &Failure<'_>) -> Option<Diagnostic> {
    let text = f.text.trim_start();
    let lead = f.text.len() - text.len();
    if text.starts_with('#') {
        return Some(
            f.error("E0230", lead, 1, "`#` does not begin a comment")
                .help("a comment is a line with `*` in its first column; in a `.blk` file also `//` to the end of the line"),
        );
    }
    if text.starts_with("//") || text.starts_with("/*") {
        return Some(
            f.error("E0230", lead, 2, format!("`{}` does not begin a comment here", &text[..2]))
                .help("begin the line with `*` in its first column, or switch other comments on with `$eolCom //` or `$inlineCom /* */`"),
        );
    }
    let words = first_words(text);
    let word = |n: usize| words.get(n).map_or("", String::as_str);
    let say =
        |message: &str, help: &str| Some(f.error("E0231", lead, word(0).len(), message).help(help));
    let rest = text.get(word(0).len()..).unwrap_or("").trim_start();
    // A parameter may be called `var`: then `=`, `(` or `.` follows.
    let is_name = rest.starts_with(['=', '(', '.', '$']) && !rest.starts_with("==");
    match (word(0), word(1)) {
        ("subject", "to") | ("s", "t") => say(
            "`subject to` is not written",
            "declare `equation e;`, define it with `e.. a*x =l= b;` and list it in a model",
        ),
        ("such", "that") | ("constraint", _) if !is_name => say(
            "constraints are equations here",
            "declare `equation e;` and define it: `e.. a*x =l= b;`",
        ),
        ("var" | "dvar", _) if !is_name => say(
            "variables are declared with `variable`",
            "write `positive variable x(i);`; bounds are set afterwards: `x.up(i) = 5;`",
        ),
        ("param" | "par", _) if !is_name => say(
            "parameters are declared with `parameter` or `scalar`",
            "write `parameter p(i) / a 1, b 2 /;` or `scalar n / 5 /;`",
        ),
        (
            "minimize" | "minimise" | "maximize" | "maximise" | "min" | "max" | "minimizing"
            | "maximizing",
            _,
        ) if !is_name => say(
            "the objective is a variable that an equation defines",
            "write `variable z; equation obj; obj.. z =e= …; model m / all /; solve m using lp minimizing z;`",
        ),
        (
            "int" | "float" | "double" | "bool" | "string" | "array" | "let" | "const" | "auto",
            _,
        ) if !is_name => say(
            "this is not a declaration of this language",
            "numbers are declared with `scalar` or `parameter`, sets with `set`, unknowns with `variable`",
        ),
        (
            "def" | "import" | "from" | "print" | "println" | "printf" | "return" | "class"
            | "function",
            _,
        ) if !is_name || word(0).starts_with("print") => say(
            "this looks like a program, not a model",
            "values are shown with `display`; formulas that are used often can be a `$macro`",
        ),
        ("end", "") if ends_block(f) => Some(
            Diagnostic::error("E0233", f.span(lead, lead + 3), "blocks end with `);`")
                .help("write `for(k = 1 to n, … );` and `if(c, … );`"),
        ),
        ("end", "for" | "if" | "while" | "loop" | "repeat") => say(
            "blocks end with `);`",
            "write `for(k = 1 to n, … );` and `if(c, … );`",
        ),
        ("for" | "forall", _) if words.iter().any(|w| w == "in") => say(
            "a loop over a set is written with `loop`",
            "write `loop(i, … );`; in an equation the index stands behind its name: `e(i).. …`",
        ),
        ("for" | "while" | "if" | "loop", _) if body_in_braces(rest) => say(
            "statements are not grouped by braces",
            "they stand inside of the parentheses, after a comma: `if(c, … );`, `while(c, … );`",
        ),
        ("for" | "while" | "if" | "loop", _) if !rest.starts_with(['(', '[', '{']) => say(
            &format!(
                "`{}` needs parentheses around its condition and its statements",
                word(0)
            ),
            "write `for(k = 1 to n, … );`, `if(c, … );`, `loop(i, … );`",
        ),
        ("endif" | "endfor" | "endwhile" | "endloop", _) => say(
            "blocks end with `);`",
            "`$onEnd` allows `if c then … endif;`",
        ),
        ("solve", _)
            if text.contains("minimize") && !text.contains("using") && word(1) == "minimize" =>
        {
            say(
                "`solve` names a model first",
                "write `solve m using lp minimizing z;`",
            )
        }
        ("set" | "sets", _) if text.contains(":=") => say(
            "the elements of a set stand between slashes",
            "write `set i / a, b, c /;` or `set t / 1*10 /;`",
        ),
        ("set" | "sets", _) if text.contains('{') && !text.contains('/') => say(
            "the elements of a set stand between slashes",
            "write `set i / a, b, c /;`",
        ),
        _ => equation(f, lead),
    }
}

/// `(a < 3) { …`
fn body_in_braces(rest: &str) -> bool {
    let mut depth = 0usize;
    for (k, c) in rest.char_indices() {
        match c {
            '(' => depth += 1,
            ')' if depth == 1 => return rest[k + 1..].trim_start().starts_with('{'),
            ')' => depth = depth.saturating_sub(1),
            _ if depth == 0 => return false,
            _ => {}
        }
    }
    false
}

/// `end if`: the splitter has cut before `if`.
fn ends_block(f: &Failure<'_>) -> bool {
    let after = f
        .expanded
        .get(f.raw.span.hi as usize..)
        .unwrap_or("")
        .trim_start();
    let word = first_words(&after[..after.len().min(after.find(';').unwrap_or(0))]);
    word.len() == 1 && matches!(word[0].as_str(), "for" | "if" | "while" | "loop" | "repeat")
}

/// Equations without `..` or without their relation.
fn equation(f: &Failure<'_>, lead: usize) -> Option<Diagnostic> {
    if f.raw.class != Class::Algebra {
        return None;
    }
    let bytes = f.text.as_bytes();
    let dots = top_level(bytes, |b| b.starts_with(b".."));
    let relation = top_level(bytes, is_relation);
    match (dots, relation) {
        (None, Some(at)) => {
            let name_end = words::word_end(bytes, lead);
            if name_end == lead {
                return None;
            }
            Some(
                f.error("E0221", at, 3, format!("`{}` belongs to an equation, but this one has no `..`", &f.text[at..at + 3]))
                    .help(format!("write `{}.. left {} right;` with two points after the equation's name and indices", &f.text[lead..name_end], &f.text[at..at + 3])),
            )
        }
        (Some(dots), None) => {
            let compare = top_level_from(bytes, dots + 2, |b| {
                b.starts_with(b"<")
                    || b.starts_with(b">")
                    || b.starts_with(b"=")
                    || b.starts_with(b"~=")
                    || b.starts_with(b":")
            });
            if let Some(at) = compare {
                let len = bytes[at..]
                    .iter()
                    .take_while(|b| matches!(b, b'<' | b'>' | b'=' | b'~' | b':'))
                    .count()
                    .max(1);
                let written = &f.text[at..at + len];
                let meant = if written.contains('<') {
                    "=l="
                } else if written.contains('>') {
                    "=g="
                } else {
                    "=e="
                };
                return Some(
                    f.error("E0222", at, len, format!("an equation relates its sides by `{meant}`, not by `{written}`"))
                        .label(format!("write `{meant}`"))
                        .help("`=`, `<=`, `>=` compare known numbers; `=e=`, `=l=`, `=g=` state what must hold"),
                );
            }
            if f.at >= f.text.trim_end().len() {
                return Some(
                    f.error(
                        "E0222",
                        f.text.trim_end().len().saturating_sub(1),
                        1,
                        "this equation has no relation",
                    )
                    .help("write `=e=`, `=l=`, `=g=` or `=n=` between its sides"),
                );
            }
            None
        }
        _ => None,
    }
}

/// The first byte outside parentheses and quotes where `test` holds.
fn top_level(bytes: &[u8], test: impl Fn(&[u8]) -> bool) -> Option<usize> {
    top_level_from(bytes, 0, test)
}

fn top_level_from(bytes: &[u8], from: usize, test: impl Fn(&[u8]) -> bool) -> Option<usize> {
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

/// Operators of other languages.
pub(super) fn at_token(f: &Failure<'_>) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    // pest may stop at the second sign of an operator.
    let starts = [f.at, f.at.saturating_sub(1)];
    let found = |op: &str| {
        starts
            .into_iter()
            .find(|&i| bytes.get(i..i + op.len()) == Some(op.as_bytes()))
    };
    let say = |at: usize, op: &str, write: &str| {
        Some(
            f.error("E0232", at, op.len(), format!("`{op}` is not an operator"))
                .label(format!("write `{write}`")),
        )
    };
    if let Some(at) = found("==") {
        let help = "`=` compares in conditions; equations use `=e=`; assignments use one `=`";
        return Some(
            f.error("E0232", at, 2, "`==` is not an operator")
                .label("write `=`")
                .help(help),
        );
    }
    for (op, write) in [
        ("!=", "<>"),
        ("&&", "and"),
        ("||", "or"),
        ("^", "**"),
        ("=<", "<="),
        ("=>", ">="),
        ("~=", "<>"),
        ("%", "mod(x,y)"),
    ] {
        if op == "%" && f.text[f.at..].get(1..).is_some_and(|r| r.contains('%')) {
            continue;
        }
        if let Some(at) = found(op) {
            return say(at, op, write);
        }
    }
    if bytes.get(f.at + 1) == Some(&b'=')
        && matches!(bytes.get(f.at), Some(b'+' | b'-' | b'*' | b'/'))
    {
        let op = &f.text[f.at..f.at + 2];
        return Some(
            f.error("E0232", f.at, 2, format!("`{op}` is not an operator"))
                .help(format!("write the left side again: `a = a {} b`", &op[..1])),
        );
    }
    if bytes.get(f.at) == Some(&b'!') {
        return say(f.at, "!", "not");
    }
    if bytes.get(f.at) == Some(&b'#') {
        return Some(
            f.error("E0230", f.at, 1, "`#` does not begin a comment")
                .help("a comment is a line with `*` in its first column; `$onEolCom` allows `!!` to the end of the line"),
        );
    }
    if let Some(at) = found("//") {
        return Some(
            f.error("E0230", at, 2, "`//` does not begin a comment in this file")
                .help("`$eolCom //` makes it one; files named `.blk` have it from the start"),
        );
    }
    if bytes.get(f.at) == Some(&b':') && f.raw.class == Class::Algebra {
        return Some(
            f.error("E0221", f.at, 1, "`:` does not begin an equation")
                .label("write `..`")
                .help("an equation is defined as `e(i).. left =e= right;`"),
        );
    }
    if bytes.get(f.at) == Some(&b'?') {
        return Some(
            f.error("E0232", f.at, 1, "`?` is not an operator")
                .help("write `ifThen(c, a, b)`, or `a$c + b$(not c)`"),
        );
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
    None
}
