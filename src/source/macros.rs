//! `$macro name(a,b) body`: textual abbreviations.
//!
//! A call is a name that stands alone, with its arguments on the same line. Arguments replace the
//! names of the parameters in the body, inside quotes too; `&` joins what stands left and right of
//! it; the result is looked through again.
//!
//! Invariant: expansion ends. Nesting deeper than [`DEEPEST`] or a line longer than [`LONGEST`] is
//! reported, not followed.

use std::cell::Cell;

use super::directives::{unquoted, word_len};
use super::preprocess::outside_quotes;
use rustc_hash::FxHashMap;

/// Calls inside calls.
const DEEPEST: usize = 100;
/// Bytes of one expanded line.
const LONGEST: usize = 4 << 20;
/// Calls in one line, those inside calls included.
const MOST_CALLS: usize = 1_000_000;

/// A macro.
#[derive(Clone, Debug)]
struct Macro {
    /// Parameters; None where no parentheses stand after the name.
    parameters: Option<Vec<String>>,
    body: String,
}

/// All macros, by lower-case name.
#[derive(Default)]
pub(super) struct Macros {
    known: FxHashMap<String, Macro>,
    /// Calls followed in the present line.
    followed: Cell<usize>,
}

/// Why a line could not be expanded: where in it, and what is wrong.
#[derive(Debug)]
pub(super) struct MacroError {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) message: String,
    pub(super) help: String,
}

impl Macros {
    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.known.is_empty()
    }

    /// Whether a name is one.
    pub(super) fn contains(&self, name: &str) -> bool {
        self.known.contains_key(&name.to_ascii_lowercase())
    }

    /// `name(a,b) body`, the text after `$macro`. A name that is one already needs leave to be replaced.
    pub(super) fn define(&mut self, text: &str, replace: bool) -> Result<(), String> {
        let text = text.trim_start();
        let len = name_len(text);
        if len == 0 {
            return Err("a macro needs a name: `$macro name(a,b) text`".into());
        }
        let name = text[..len].to_ascii_lowercase();
        if !replace && self.known.contains_key(&name) {
            return Err(format!(
                "the macro `{name}` exists already; `$onMultiR` lets it be replaced"
            ));
        }
        let mut rest = &text[len..];
        let mut parameters = None;
        // Behind a blank the parenthesis belongs to the text.
        if let Some(inside) = rest.strip_prefix('(') {
            let Some(close) = inside.find(')') else {
                return Err("the parameters of the macro are not closed by `)`".into());
            };
            let list = &inside[..close];
            rest = &inside[close + 1..];
            let names: Vec<String> = if list.trim().is_empty() {
                Vec::new()
            } else {
                list.split(',')
                    .map(|p| p.trim().to_ascii_lowercase())
                    .collect()
            };
            if names.iter().any(|p| name_len(p) != p.len() || p.is_empty()) {
                return Err(format!(
                    "the parameters `({list})` of the macro are not names"
                ));
            }
            parameters = Some(names);
        }
        let body = rest.trim().to_owned();
        self.known.insert(name, Macro { parameters, body });
        Ok(())
    }

    /// The ranges of a line that are calls, with what they stand for.
    pub(super) fn calls(&self, line: &str) -> Result<Vec<(usize, usize, String)>, MacroError> {
        let mut out = Vec::new();
        self.followed.set(0);
        self.scan(line, 0, &mut |from, to, text| out.push((from, to, text)))?;
        Ok(out)
    }

    fn scan(
        &self,
        line: &str,
        depth: usize,
        found: &mut dyn FnMut(usize, usize, String),
    ) -> Result<(), MacroError> {
        let bytes = line.as_bytes();
        let mut i = 0;
        let mut total = 0;
        while i < bytes.len() {
            let b = bytes[i];
            if b == b'\'' || b == b'"' {
                i = match memchr::memchr(b, &bytes[i + 1..]) {
                    Some(n) => i + n + 2,
                    None => i + 1,
                };
            } else if b.is_ascii_alphabetic() || b == b'_' {
                let len = word_len(&line[i..]);
                let name = line[i..i + len].to_ascii_lowercase();
                let end = i + len;
                // `p.name` is an attribute or an element, not a call.
                let after_dot = i > 0 && bytes[i - 1] == b'.' && !(i > 1 && bytes[i - 2] == b'.');
                match self.known.get(&name) {
                    Some(m) if !after_dot => {
                        let (to, text) = self.call(line, i, end, &name, m, depth)?;
                        match to {
                            Some(to) => {
                                total += text.len();
                                if total > LONGEST {
                                    return Err(endless(i, to, &name));
                                }
                                found(i, to, text);
                                i = to;
                            }
                            None => i = end,
                        }
                    }
                    _ => i = end,
                }
            } else if b.is_ascii_digit() {
                i += word_len(&line[i..]);
            } else {
                i += 1;
            }
        }
        Ok(())
    }

    /// The call that begins at `from`: its end (None where it is no call) and its meaning.
    fn call(
        &self,
        line: &str,
        from: usize,
        end: usize,
        name: &str,
        m: &Macro,
        depth: usize,
    ) -> Result<(Option<usize>, String), MacroError> {
        let error = |to: usize, message: String, help: &str| MacroError {
            from,
            to,
            message,
            help: help.into(),
        };
        self.followed.set(self.followed.get() + 1);
        if depth >= DEEPEST || self.followed.get() > MOST_CALLS {
            let message = format!(
                "the macro `{name}` calls itself, or calls are nested more than {DEEPEST} deep"
            );
            return Err(error(end, message, ITSELF));
        }
        let (to, text) = match &m.parameters {
            None => (end, m.body.clone()),
            Some(parameters) => {
                let open = end + line[end..].len() - line[end..].trim_start().len();
                if line.as_bytes().get(open) != Some(&b'(') {
                    return Ok((None, String::new()));
                }
                let Some((arguments, to)) = arguments(line, open) else {
                    return Err(error(
                        line.len(),
                        format!("the arguments of the macro `{name}` are not closed on this line"),
                        "write the whole call on one line",
                    ));
                };
                let arguments =
                    if parameters.is_empty() && arguments.iter().all(|a| a.trim().is_empty()) {
                        Vec::new()
                    } else {
                        arguments
                    };
                if arguments.len() != parameters.len() {
                    return Err(error(
                        to,
                        format!(
                            "the macro `{name}` has {} parameter(s), but {} argument(s) are given",
                            parameters.len(),
                            arguments.len()
                        ),
                        "check the commas; an argument with a comma goes in parentheses",
                    ));
                }
                (to, substitute(&m.body, parameters, &arguments))
            }
        };
        if text.len() > LONGEST {
            return Err(endless(from, to, name));
        }
        // What comes out may hold calls again.
        let mut out = String::with_capacity(text.len());
        let mut at = 0;
        let mut inner = Vec::new();
        self.scan(&text, depth + 1, &mut |f, t, s| inner.push((f, t, s)))
            .map_err(|e| error(to, e.message, &e.help))?;
        for (f, t, s) in inner {
            out.push_str(&text[at..f]);
            out.push_str(&s);
            at = t;
            if out.len() > LONGEST {
                return Err(endless(from, to, name));
            }
        }
        out.push_str(&text[at..]);
        Ok((Some(to), out))
    }
}

const ITSELF: &str = "a macro must not stand in its own body";

/// The error of a call that makes too long a text.
fn endless(from: usize, to: usize, name: &str) -> MacroError {
    MacroError {
        from,
        to,
        message: format!("the macro `{name}` grows without end"),
        help: ITSELF.into(),
    }
}

/// Length of the name at the start of a text.
fn name_len(text: &str) -> usize {
    match text.starts_with(|c: char| c.is_ascii_digit()) {
        true => 0,
        false => word_len(text),
    }
}

/// The arguments from the parenthesis at `open` on, and the place after the closing one.
fn arguments(line: &str, open: usize) -> Option<(Vec<String>, usize)> {
    let mut list = Vec::new();
    let mut start = open + 1;
    for (i, b, depth) in outside_quotes(line.as_bytes(), open) {
        if depth == 0 || (b == b',' && depth == 1) {
            list.push(line[start..i].trim().to_owned());
            start = i + 1;
        }
        if depth == 0 {
            return Some((list, start));
        }
    }
    None
}

/// The body with arguments in the place of parameters.
fn substitute(body: &str, parameters: &[String], arguments: &[String]) -> String {
    let bytes = body.as_bytes();
    let mut out = String::with_capacity(body.len());
    let mut i = 0;
    while i < bytes.len() {
        let b = bytes[i];
        if b == b'&' {
            // `&` only joins.
            i += 1;
        } else if b.is_ascii_alphabetic() || b == b'_' {
            let len = word_len(&body[i..]);
            let word = &body[i..i + len];
            match parameters.iter().position(|p| p.eq_ignore_ascii_case(word)) {
                // `&&name` takes the quotes off: they held an argument with commas together.
                Some(n) if body[..i].ends_with("&&") => out.push_str(unquoted(&arguments[n])),
                Some(n) => out.push_str(&arguments[n]),
                None => out.push_str(word),
            }
            i += len;
        } else if b.is_ascii_digit() {
            let len = bytes[i..]
                .iter()
                .position(|c| !c.is_ascii_alphanumeric())
                .unwrap_or(bytes.len() - i);
            out.push_str(&body[i..i + len]);
            i += len;
        } else {
            let len = body[i..].chars().next().map_or(1, char::len_utf8);
            out.push_str(&body[i..i + len]);
            i += len;
        }
    }
    out
}
