//! Arithmetic of `$eval`, `$ifE` and their kin: numbers, operators, functions, `card(i)`, scalars.
//!
//! Invariant: depth is bounded, and text that is no expression is an error with the place where it
//! stops being one.

use super::directives::quoted;
use super::preprocess::Known;

/// Parentheses inside parentheses.
const DEEPEST: usize = 100;

/// Evaluates the longest expression at the start of `text`; gives its value and its length.
pub(super) fn evaluate(text: &str, known: &dyn Known) -> Result<(f64, usize), String> {
    Evaluator::read(text, known, true, |e| e.level(0))
}

/// Evaluates the expression between the bracket or brace that opens `text` and its partner; the same.
pub(crate) fn constant(text: &str, known: &dyn Known) -> Result<(f64, usize), String> {
    Evaluator::read(text, known, false, Evaluator::primary)
}

/// A number as `$eval` writes it into a name: up to 15 digits, `1E20` where it is long.
pub(super) fn number_text(x: f64) -> String {
    let x: f64 = format!("{x:.14e}").parse().unwrap_or(x);
    match x.abs() {
        size if size.is_nan() => "UNDF".into(),
        f64::INFINITY if x > 0.0 => "+INF".into(),
        f64::INFINITY => "-INF".into(),
        0.0 => "0".into(),
        size if (1e-4..1e15).contains(&size) => x.to_string(),
        _ => format!("{x:E}"),
    }
}

struct Evaluator<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
    /// `inf`, `pi` and their kin are numbers.
    words: bool,
    known: &'a dyn Known,
}

/// Operators by level, loosest first; words are those that need a word boundary.
const LEVELS: &[&[&str]] = &[
    &["<=>", "->", "eqv", "imp"],
    &["or", "xor"],
    &["and"],
    &[
        "<=", ">=", "<>", "=", "<", ">", "eq", "ne", "lt", "le", "gt", "ge",
    ],
    &["+", "-"],
    &["*", "/"],
    &["**", "^"],
];

/// The levels of relations, sums and powers.
const RELATION: usize = 3;
const SUM: usize = 4;
const POWER: usize = 6;

impl<'a> Evaluator<'a> {
    fn read(
        text: &'a str,
        known: &'a dyn Known,
        words: bool,
        what: impl FnOnce(&mut Self) -> Result<f64, String>,
    ) -> Result<(f64, usize), String> {
        let mut e = Self {
            text,
            at: 0,
            depth: 0,
            words,
            known,
        };
        Ok((what(&mut e)?, e.at))
    }

    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn blanks(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
    }

    /// Whether a sign stands behind the blanks here; it is passed over.
    fn sign(&mut self, sign: u8) -> bool {
        self.blanks();
        let here = self.rest().as_bytes().first() == Some(&sign);
        self.at += usize::from(here);
        here
    }

    /// The operator of this level that stands here, passed over.
    fn operator(&mut self, level: usize) -> Option<&'static str> {
        let before = self.at;
        self.blanks();
        let rest = self.rest();
        for &op in LEVELS[level] {
            let Some(head) = rest.get(..op.len()) else {
                continue;
            };
            if !head.eq_ignore_ascii_case(op) {
                continue;
            }
            let next = rest.as_bytes().get(op.len()).copied().unwrap_or(b' ');
            let word = op.as_bytes()[0].is_ascii_alphabetic();
            if word && (next.is_ascii_alphanumeric() || next == b'_') {
                continue;
            }
            // `*` is not the first half of `**`, `<` not of `<=>`.
            if op == "=" && next == b'='
                || op == "*" && next == b'*'
                || op == "-" && next == b'>'
                || op == "<=" && next == b'>'
            {
                continue;
            }
            self.at += op.len();
            return Some(op);
        }
        self.at = before;
        None
    }

    fn level(&mut self, level: usize) -> Result<f64, String> {
        if level == LEVELS.len() {
            let mut x = self.primary()?;
            // `x$c`; behind a blank `$` begins a directive.
            while self.rest().starts_with('$') {
                self.at += 1;
                if self.primary()? == 0.0 {
                    x = 0.0;
                }
            }
            return Ok(x);
        }
        if level == RELATION {
            // `not` is looser than relations, tighter than `and`.
            self.blanks();
            let rest = self.rest();
            let not = rest.get(..3).is_some_and(|w| w.eq_ignore_ascii_case("not"));
            let next = rest.as_bytes().get(3);
            if not && !next.is_some_and(u8::is_ascii_alphanumeric) {
                self.at += 3;
                self.enter()?;
                let x = self.level(level)?;
                self.depth -= 1;
                return Ok(f64::from(x == 0.0));
            }
        }
        let x = match level == SUM && self.sign(b'-') {
            true => -self.level(level + 1)?,
            false => {
                let _ = level == SUM && self.sign(b'+');
                self.level(level + 1)?
            }
        };
        self.chain(level, x)
    }

    fn chain(&mut self, level: usize, mut x: f64) -> Result<f64, String> {
        let truth = |b: bool| f64::from(u8::from(b));
        while let Some(op) = self.operator(level) {
            let y = match level == POWER && self.sign(b'-') {
                true => -self.level(level + 1)?,
                false => self.level(level + 1)?,
            };
            x = match op {
                "<=>" | "eqv" => truth((x != 0.0) == (y != 0.0)),
                "->" | "imp" => truth(x == 0.0 || y != 0.0),
                "or" => truth(x != 0.0 || y != 0.0),
                "xor" => truth((x != 0.0) != (y != 0.0)),
                "and" => truth(x != 0.0 && y != 0.0),
                "=" | "eq" => truth(x == y),
                "<>" | "ne" => truth(x != y),
                "<" | "lt" => truth(x < y),
                "<=" | "le" => truth(x <= y),
                ">" | "gt" => truth(x > y),
                ">=" | "ge" => truth(x >= y),
                "+" => x + y,
                "-" => x - y,
                "*" => x * y,
                "/" => x / y,
                _ => x.powf(y),
            };
        }
        Ok(x)
    }

    fn enter(&mut self) -> Result<(), String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err("the expression is nested too deeply".into());
        }
        Ok(())
    }

    fn primary(&mut self) -> Result<f64, String> {
        self.blanks();
        let rest = self.rest();
        let bytes = rest.as_bytes();
        match bytes.first() {
            Some(b'(' | b'[' | b'{') => self.inside(|e| e.level(0)),
            Some(c) if c.is_ascii_digit() || *c == b'.' => {
                match fast_float2::parse_partial::<f64, _>(rest) {
                    Ok((x, n)) if n > 0 => {
                        self.at += n;
                        Ok(x)
                    }
                    _ => Err(format!("`{}` is not a number", first_word(rest))),
                }
            }
            Some(c) if c.is_ascii_alphabetic() => self.word(),
            Some(_) => Err(format!("a number was expected at `{}`", first_word(rest))),
            None => Err("a number was expected at the end".into()),
        }
    }

    /// What stands between the parenthesis here and its partner.
    fn inside<T>(
        &mut self,
        read: impl FnOnce(&mut Self) -> Result<T, String>,
    ) -> Result<T, String> {
        let close = match self.rest().as_bytes()[0] {
            b'(' => b')',
            b'[' => b']',
            _ => b'}',
        };
        self.enter()?;
        self.at += 1;
        let found = read(self)?;
        self.depth -= 1;
        match self.sign(close) {
            true => Ok(found),
            false => Err(format!("`{}` is missing", char::from(close))),
        }
    }

    fn name(&mut self) -> &'a str {
        let rest = self.rest();
        let len = rest
            .bytes()
            .position(|c| !c.is_ascii_alphanumeric() && c != b'_')
            .unwrap_or(rest.len());
        self.at += len;
        &rest[..len]
    }

    /// A text, in quotes or a word.
    fn text(&mut self) -> &'a str {
        self.blanks();
        let rest = self.rest();
        match quoted(rest) {
            Some((inside, behind)) => {
                self.at += rest.len() - behind.len();
                inside
            }
            None => {
                let len = rest.find([',', ')', ']', '}']).unwrap_or(rest.len());
                self.at += len;
                rest[..len].trim_end()
            }
        }
    }

    fn scalar(&self, name: &str) -> Result<f64, String> {
        let value = self.known.scalar_value(name);
        value.ok_or_else(|| format!("`{name}` has no value here"))
    }

    fn word(&mut self) -> Result<f64, String> {
        let name = self.name();
        let lower = name.to_ascii_lowercase();
        let before = self.at;
        self.blanks();
        if !self.rest().starts_with(['(', '[', '{']) {
            self.at = before;
            return match lower.as_str() {
                _ if !self.words => self.scalar(name),
                "inf" => Ok(f64::INFINITY),
                "undf" => Ok(f64::NAN),
                "pi" => Ok(std::f64::consts::PI),
                "yes" | "true" => Ok(1.0),
                "no" | "false" | "eps" => Ok(0.0),
                _ => self.scalar(name),
            };
        }
        if lower == "card" {
            let set = self.inside(|e| {
                e.blanks();
                Ok(e.name())
            })?;
            let card = self.known.card(set).map(|n| n as f64);
            return card.ok_or_else(|| format!("`{set}` has no known number of elements here"));
        }
        if lower == "sameas" {
            let same = self.inside(|e| {
                let a = e.text();
                match e.sign(b',') {
                    true => Ok(a.eq_ignore_ascii_case(e.text())),
                    false => Err("`sameas` compares two texts".into()),
                }
            })?;
            return Ok(f64::from(u8::from(same)));
        }
        let args = self.inside(|e| {
            let mut args = Vec::new();
            e.blanks();
            while !e.rest().is_empty() && !e.rest().starts_with([')', ']', '}']) {
                args.push(e.level(0)?);
                if !e.sign(b',') {
                    break;
                }
                e.blanks();
            }
            Ok(args)
        })?;
        let value = self.known.function_value(&lower, &args);
        value.ok_or_else(|| format!("`{name}` with {} argument(s) is not known here", args.len()))
    }
}

fn first_word(text: &str) -> &str {
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    &text[..end]
}
