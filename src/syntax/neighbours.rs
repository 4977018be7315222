//! Equations and constraints as other languages write them: without dots, with comparison signs, with two relations.
//!
//! Only statements that did not parse come here, so nothing legal is refused.

use super::explain::{Failure, closing, is_relation};
use super::words::{self, Class};
use crate::diag::Diagnostic;
use crate::source::outside_quotes;

/// Equations without `..`, without a relation, or with two.
pub(super) fn equation(f: &Failure<'_>) -> Option<Diagnostic> {
    if f.raw.class != Class::Algebra {
        return None;
    }
    let lead = f.text.len() - f.text.trim_start().len();
    let bytes = f.text.as_bytes();
    let dots = top_level(bytes, 0, |b| b.starts_with(b".."));
    let relation = top_level(bytes, dots.map_or(0, |d| d + 2), is_relation);
    if let Some(d) = dots.and_then(|at| after_dots(f, lead, at)) {
        return Some(d);
    }
    match (dots, relation) {
        (None, Some(at)) => without_dots(f, lead, at),
        (None, None) => bound(f, lead),
        (Some(dots), None) => without_relation(f, dots),
        (Some(_), Some(first)) => {
            let relates = |b: &[u8]| is_relation(b) || b.starts_with(b"<=") || b.starts_with(b">=");
            top_level(bytes, first + 3, relates).map(|second| {
                f.error("E0222", second, 3)
                    .says("an equation has one relation")
                    .label("a second one")
                    .help("write two equations, or bounds: `x.lo = 1; x.up = 4;`")
            })
        }
    }
}

/// `e... x =e= 1`, `e..(i) x(i) =l= 1`
fn after_dots(f: &Failure<'_>, lead: usize, dots: usize) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    let name = f.text[lead..dots].trim();
    match bytes.get(dots + 2) {
        Some(b'.') => Some(
            f.error("E0221", dots, 3)
                .says("two dots stand behind the name of an equation, not three")
                .help(format!("write `{name}.. left =e= right;`")),
        ),
        Some(b'(') => {
            let close = closing(bytes, dots + 2)?;
            let indices = &f.text[dots + 3..close];
            let plain = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b',' | b' ' | b'_');
            let begins = |c: char| c.is_ascii_alphanumeric() || c == '(';
            let next = f.text[close + 1..].trim_start().starts_with(begins);
            (indices.bytes().all(plain) && next && !name.ends_with(')')).then(|| {
                f.error("E0221", dots + 2, close - dots - 1)
                    .says("the indices of an equation stand before the dots")
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
    let mut end = word;
    let open = words::behind_blanks(bytes, word);
    if let Some(b'(' | b'[' | b'{') = bytes.get(open) {
        end = closing(bytes, open)? + 1;
    }
    let (name, sign) = (&f.text[lead..end], &f.text[relation..relation + 3]);
    let operation = is_sum(&f.text[lead..word]);
    let next = words::behind_blanks(bytes, end);
    let named = word > lead
        && !operation
        && bytes.get(next).is_some_and(|b| {
            words::is_letter(*b) || matches!(b, b'.' | b':' | b'(' | b'-') || b.is_ascii_digit()
        });
    if !named {
        return Some(
            f.error("E0221", lead, relation + 3 - lead).says("an equation begins with its name and `..`")
                .help(format!("declare `equation e;` and write `e.. left {sign} right;`; a bound is assigned: `x.up = 3;`")),
        );
    }
    let (at, len) = match bytes[next] {
        b'.' | b':' => (next, 1),
        _ => (lead, end - lead),
    };
    let message = format!("two dots stand behind the name of an equation: `{name}..`");
    let d = f.error("E0221", at, len).says(message);
    let d = d.label("`..` is missing here");
    Some(d.help(format!("write `{name}.. left {sign} right;`")))
}

/// `x >= 3;`, `x(i) <= 3;`, `c1: x + y <= 10;`
fn bound(f: &Failure<'_>, lead: usize) -> Option<Diagnostic> {
    let bytes = f.text.as_bytes();
    let equals = top_level(bytes, lead, |b| b[0] == b'=' && !b.starts_with(b"=="));
    if equals.is_some_and(|at| !matches!(bytes[at.saturating_sub(1)], b'<' | b'>')) {
        return None;
    }
    let compares = |b: &[u8]| b[0] == b'<' || b[0] == b'>' || b.starts_with(b"==");
    let at = top_level(bytes, lead, compares)?;
    let left = f.text[lead..at].trim();
    let signs = bytes[at..].iter();
    let len = signs
        .take_while(|b| matches!(b, b'<' | b'>' | b'='))
        .count();
    let (sign, side) = match bytes[at] {
        b'<' => ("=l=", "up"),
        b'>' => ("=g=", "lo"),
        _ => ("=e=", "fx"),
    };
    let word = words::word_end(left.as_bytes(), 0);
    let attribute = left[word..]
        .strip_prefix('.')
        .map_or(0, |r| 1 + words::word_end(r.as_bytes(), 0));
    let indices = left[word + attribute..].trim();
    let simple = word > 0
        && (indices.is_empty()
            || indices.starts_with('(')
                && closing(indices.as_bytes(), 0) == Some(indices.len() - 1));
    let d = f.error("E0222", at, len).says(format!(
        "`{}` compares known numbers; it states no constraint",
        &f.text[at..at + len]
    ));
    let equation = format!("declare `equation e;` and write `e.. left {sign} right;`");
    Some(match simple && !is_sum(&left[..word]) {
        true => d.help(format!(
            "a bound is assigned: `{}.{side}{indices} = …;`; for a constraint {equation}",
            &left[..word]
        )),
        false => d.help(equation),
    })
}

pub(super) fn is_sum(word: &str) -> bool {
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
        return (f.at >= end).then(|| {
            f.error("E0222", end.saturating_sub(1), 1)
                .says("this equation has no relation")
                .help("write `=e=`, `=l=`, `=g=` or `=n=` between its sides")
        });
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
        .error("E0222", at, len)
        .says(format!(
            "an equation relates its sides by `{meant}`, not by `{}`",
            &rest[..len]
        ))
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
pub(super) fn top_level(bytes: &[u8], from: usize, test: impl Fn(&[u8]) -> bool) -> Option<usize> {
    let plain = |b: u8| !b"()[]{}'\"".contains(&b);
    outside_quotes(bytes, from)
        .find(|&(i, b, depth)| depth == 0 && plain(b) && test(&bytes[i..]))
        .map(|(i, ..)| i)
}
