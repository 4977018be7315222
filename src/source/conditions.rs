//! `$if`, `$ifThen … $elseIf … $else … $endIf`: conditions and the lines they leave out.

use super::directives::quoted;
use super::evaluate::evaluate;
use super::preprocess::{Known, Preprocessor};
use super::variables::Reach;
use super::{Outcome, Span, line::Line};

/// An open `$ifThen`.
pub(super) struct If {
    /// Where it stands.
    pub(super) span: Span,
    /// `.tag` behind it, in lower case.
    pub(super) tag: String,
    /// A branch was taken.
    pub(super) taken: bool,
}

/// How a condition is read.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Flavour {
    /// `$if`: texts, with regard to case.
    Exact,
    /// `$ifI`: texts, without regard to case.
    NoCase,
    /// `$ifE`: numbers.
    Numeric,
}

/// The kind of the symbols that are there from the start.
pub(crate) fn predefined(name: &str) -> Option<&'static str> {
    match name.to_ascii_lowercase().as_str() {
        "sameas" => Some("set"),
        "diag" => Some("parameter"),
        _ => None,
    }
}

/// A text in a condition: quoted, or up to a blank or an operator.
fn term(text: &str, stop_at_equals: bool) -> (&str, usize) {
    let t = text.trim_start();
    let skipped = text.len() - t.len();
    if let Some((inside, behind)) = quoted(t) {
        return (inside, text.len() - behind.len());
    }
    let blank = t.find([' ', '\t']).unwrap_or(t.len());
    let end = if stop_at_equals {
        t.find("==").map_or(blank, |n| n.min(blank))
    } else {
        blank
    };
    (&t[..end], skipped + end)
}

impl Preprocessor<'_> {
    /// Evaluates the condition at the start of `text`; gives its truth and its length.
    pub(super) fn condition(
        &mut self,
        text: &str,
        flavour: Flavour,
        known: &dyn Known,
    ) -> Result<(bool, usize), String> {
        let mut at = text.len() - text.trim_start().len();
        let mut negate = false;
        while let Some(word) = text.get(at..at + 3)
            && word.eq_ignore_ascii_case("not")
            && text[at + 3..].starts_with([' ', '\t', '('])
        {
            negate = !negate;
            at += 3;
            at += text[at..].len() - text[at..].trim_start().len();
        }
        let rest = &text[at..];
        // `not ==x` has an empty text on the left; with a blank behind `==` it may be the text `not`.
        let ambiguous = |right: &str| right.is_empty() || right.starts_with([' ', '\t']);
        if negate && rest.strip_prefix("==").is_some_and(ambiguous) {
            return Err(
                "`not ==` may mean the operator or the text `not`; put it in quotes".into(),
            );
        }
        let (truth, len) = match self.question(rest, known) {
            Some(found) => found?,
            None if flavour == Flavour::Numeric => numeric(rest, known)?,
            None => comparison(rest, flavour)?,
        };
        Ok((truth != negate, at + len))
    }

    /// `exist file`, `set name`, `declared x` …: None where the text is not such a question.
    fn question(&mut self, text: &str, known: &dyn Known) -> Option<Result<(bool, usize), String>> {
        let len = text
            .find(|c: char| !c.is_ascii_alphanumeric() && c != '_')
            .unwrap_or(text.len());
        let word = text[..len].to_ascii_lowercase();
        let after = &text[len..];
        // A word directly followed by `==` is a text to compare.
        if after.trim_start().starts_with("==")
            || (!after.is_empty() && !after.starts_with([' ', '\t']))
        {
            return None;
        }
        let one = |f: &mut dyn FnMut(&str) -> bool| {
            let (name, n) = term(after, false);
            if name.is_empty() {
                return Some(Err(format!("`$if {word}` needs a name")));
            }
            Some(Ok((f(name), len + n)))
        };
        let of_kind = |kinds: &[&str]| {
            let (name, n) = term(after, false);
            let kind = known.kind(name);
            Some(Ok((kind.is_some_and(|k| kinds.contains(&k)), len + n)))
        };
        match word.as_str() {
            "dexist" => {
                let (name, n) = term(after, false);
                let from = self.frames.last().map(|f| f.path.clone());
                Some(Ok((
                    self.host.folder_exists(name, from.as_deref()),
                    len + n,
                )))
            }
            "exist" | "readable" => {
                let (name, n) = term(after, false);
                let from = self.frames.last().map(|f| f.path.clone());
                let found = self.map.written(name).is_some()
                    || !name.is_empty() && self.host.exists(name, from.as_deref());
                Some(Ok((found, len + n)))
            }
            "set" => one(&mut |n| self.names.get(n).is_some()),
            "setlocal" => one(&mut |n| self.names.has(Reach::Local, n)),
            "setglobal" => one(&mut |n| self.names.has(Reach::Global, n)),
            "setenv" => one(&mut |n| self.environment.contains_key(&n.to_lowercase())),
            "declared" => one(&mut |n| known.kind(n).is_some()),
            "defined" => one(&mut |n| known.is_defined(n)),
            "dimension" => {
                let (number, n) = term(after, false);
                let (name, m) = term(&after[n..], false);
                let Some(dimension) = known.dimension(name) else {
                    return Some(Err(format!("`{name}` is not declared")));
                };
                Some(Ok((number.parse() == Ok(dimension), len + n + m)))
            }
            "settype" => of_kind(&["set", "alias"]),
            "partype" => of_kind(&["parameter", "scalar"]),
            "vartype" => of_kind(&["variable"]),
            "equtype" => of_kind(&["equation"]),
            "modtype" => of_kind(&["model"]),
            "filtype" => of_kind(&["file"]),
            "acrtype" => of_kind(&["acronym"]),
            "xxxtype" | "protype" => of_kind(&[]),
            "mactype" | "macro" => one(&mut |n| self.macros.contains(n)),
            "funtype" => one(&mut |n| known.is_function(n)),
            "pretype" => one(&mut |n| predefined(n).is_some()),
            "decla_ok" => Some(Ok((true, len))),
            "gamsversion" => {
                let (number, n) = term(after, false);
                let asked: f64 = number.parse().unwrap_or(f64::INFINITY);
                Some(Ok((asked <= 540.0, len + n)))
            }
            "errorfree" => Some(Ok((known.errors() == self.cleared_errors, len))),
            "warnings" => Some(Ok((!self.warnings.is_empty(), len))),
            "errorlevel" => {
                let (_, n) = term(after, false);
                Some(Ok((false, len + n)))
            }
            "putopen" => Some(Ok((known.put_open(), len))),
            "uelexist" => one(&mut |n| known.is_label(n)),
            "solver" => one(&mut |n| known.is_solver(n)),
            _ => {
                let found = self.of_data_file(word.strip_prefix("gdx")?, after, known)?;
                Some(found.map(|(truth, n)| (truth, len + n)))
            }
        }
    }

    /// `gdxSetType name`, `gdxDimension n name` …: asked of the file that `$gdxIn` opened.
    fn of_data_file(
        &mut self,
        asked: &str,
        after: &str,
        known: &dyn Known,
    ) -> Option<Result<(bool, usize), String>> {
        let kinds: &[&str] = match asked {
            "settype" => &["set", "singleton set", "alias"],
            "partype" => &["parameter"],
            "vartype" => &["variable"],
            "equtype" => &["equation"],
            "dimension" => &[],
            _ => return None,
        };
        let (number, n) = match kinds {
            [] => term(after, false),
            _ => ("", 0),
        };
        let (name, m) = term(&after[n..], false);
        let found = known.in_data_file(name, &mut |file, at| self.read(file, at));
        Some(found.map(|symbol| {
            let fits = |(kind, dimension)| match kinds {
                [] => number.parse() == Ok(dimension),
                _ => kinds.contains(&kind),
            };
            (symbol.is_some_and(fits), n + m)
        }))
    }

    /// `$ifThen`: opens a branch or leaves it out.
    pub(super) fn if_then(
        &mut self,
        line: &Line,
        tag: String,
        truth: bool,
        known: &dyn Known,
    ) -> Outcome<()> {
        let (lo, hi) = line.origin(0, line.text.len());
        let span = self.place(lo, hi);
        if let Some(frame) = self.frames.last_mut() {
            frame.ifs.push(If {
                span,
                tag,
                taken: truth,
            });
        }
        if truth { Ok(()) } else { self.leave_out(known) }
    }

    /// `$else` and `$elseIf` after a taken branch, `$ifThen` with a false condition: passes over the
    /// lines up to the next branch that is taken, or to `$endIf`.
    pub(super) fn leave_out(&mut self, known: &dyn Known) -> Outcome<()> {
        let mut depth = 0usize;
        let listed = self.listed();
        loop {
            let Some(frame) = self.frames.last() else {
                return Ok(());
            };
            if frame.pos >= frame.len {
                // `leave` reports the open `$ifThen`.
                return Ok(());
            }
            let pos = frame.pos;
            let end = self.line_end(pos);
            let raw = self.raw(pos, end);
            let Some((word, _)) = self.marks.directive_name(raw) else {
                self.advance(end);
                continue;
            };
            let word = word.to_ascii_lowercase();
            match word.as_str() {
                "ontext" => {
                    let line = self.take_line();
                    self.comment_block(&line)?;
                }
                "ifthen" | "ifthene" | "iftheni" => {
                    depth += 1;
                    self.advance(end);
                }
                "endif" if depth > 0 => {
                    depth -= 1;
                    self.advance(end);
                }
                "else" | "elseif" | "elseife" | "elseifi" | "endif" if depth == 0 => {
                    let taken = self
                        .frames
                        .last()
                        .and_then(|f| f.ifs.last())
                        .is_none_or(|i| i.taken);
                    if word != "endif" && taken {
                        self.advance(end);
                        continue;
                    }
                    // Let the directive itself decide.
                    let line = self.take_line();
                    let line = self.directive_text(line)?;
                    self.set_listed(listed);
                    if self.branch(&line, known)? {
                        return Ok(());
                    }
                }
                _ => self.advance(end),
            }
        }
    }
}

/// `expression`, or `expression == expression` up to rounding; each may stand in quotes.
fn numeric(text: &str, known: &dyn Known) -> Result<(bool, usize), String> {
    let side = |text: &str| -> Result<(f64, usize), String> {
        let quoted = text.trim_start().starts_with(['\'', '"']);
        let (inside, n) = term(text, false);
        match quoted {
            true => Ok((evaluate(inside, known)?.0, n)),
            false => evaluate(text, known),
        }
    };
    let (x, n) = side(text)?;
    let rest = text[n..].trim_start();
    let Some(right) = rest.strip_prefix("==") else {
        return Ok((x != 0.0, n));
    };
    let (y, m) = side(right)?;
    let same = x == y || (x - y).abs() / (1.0 + y.abs()) < 1e-12;
    Ok((same, text.len() - right.len() + m))
}

/// `a == b`, with quotes or without.
fn comparison(text: &str, flavour: Flavour) -> Result<(bool, usize), String> {
    let (left, n) = term(text, true);
    let rest = &text[n..];
    let blanks = rest.len() - rest.trim_start().len();
    let Some(after) = rest.trim_start().strip_prefix("==") else {
        // A text in quotes that stands alone is compared with the empty text.
        if text.trim_start().starts_with(['\'', '"']) {
            return Ok((left.is_empty(), n));
        }
        return Err(format!(
            "`{}` is no condition: `==` or a word like `set`, `exist`, `declared` was expected",
            text.trim()
        ));
    };
    let (right, m) = term(after, false);
    if after.trim().is_empty() {
        // `$ifThen %x% == %y%` with nothing on both sides is false, as in GAMS.
        if n > 0 {
            return Err("nothing stands behind `==`; the empty text is `''`".into());
        }
        return Ok((false, text.len()));
    }
    let same = match flavour {
        Flavour::NoCase => left.eq_ignore_ascii_case(right),
        _ => left == right,
    };
    Ok((same, n + blanks + 2 + m))
}
