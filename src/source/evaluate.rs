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
    let mut e = Evaluator {
        text,
        at: 0,
        depth: 0,
        words: true,
        known,
    };
    let value = e.level(0)?;
    Ok((value, e.at))
}

/// Evaluates the expression between the bracket or brace that opens `text` and its partner; the same.
pub(crate) fn constant(text: &str, known: &dyn Known) -> Result<(f64, usize), String> {
    let mut e = Evaluator {
        text,
        at: 0,
        depth: 0,
        words: false,
        known,
    };
    let value = e.primary()?;
    Ok((value, e.at))
}

/// A number as `$eval` writes it into a name: up to 15 digits, `1E20` where it is long.
pub(super) fn number_text(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    if !x.is_finite() {
        return if x.is_nan() {
            "UNDF".into()
        } else if x > 0.0 {
            "+INF".into()
        } else {
            "-INF".into()
        };
    }
    let s = format!("{:.14e}", x.abs());
    let (mantissa, exponent) = s.split_once('e').unwrap_or((&s, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    let digits = digits.trim_end_matches('0');
    let sign = if x < 0.0 { "-" } else { "" };
    let n = digits.len() as i32;
    if (0..15).contains(&exponent) {
        let whole = exponent + 1;
        if n <= whole {
            return format!("{sign}{digits}{}", "0".repeat((whole - n) as usize));
        }
        return format!(
            "{sign}{}.{}",
            &digits[..whole as usize],
            &digits[whole as usize..]
        );
    }
    if (-4..0).contains(&exponent) {
        return format!("{sign}0.{}{digits}", "0".repeat((-exponent - 1) as usize));
    }
    let (first, rest) = digits.split_at(1);
    let point = if rest.is_empty() { "" } else { "." };
    format!("{sign}{first}{point}{rest}E{exponent}")
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

impl<'a> Evaluator<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn blanks(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
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
        if level == 3 {
            // `not` is looser than relations, tighter than `and`.
            self.blanks();
            let rest = self.rest();
            let not = rest.get(..3).is_some_and(|w| w.eq_ignore_ascii_case("not"))
                && !rest
                    .as_bytes()
                    .get(3)
                    .is_some_and(u8::is_ascii_alphanumeric);
            if not {
                self.at += 3;
                self.enter()?;
                let x = self.level(level)?;
                self.depth -= 1;
                return Ok(f64::from(x == 0.0));
            }
        }
        if level == 4 {
            self.blanks();
            if self.rest().starts_with('-') {
                self.at += 1;
                let x = -self.level(5)?;
                return self.chain(level, x);
            }
            if self.rest().starts_with('+') {
                self.at += 1;
            }
        }
        let x = self.level(level + 1)?;
        self.chain(level, x)
    }

    fn chain(&mut self, level: usize, mut x: f64) -> Result<f64, String> {
        let truth = |b: bool| f64::from(u8::from(b));
        while let Some(op) = self.operator(level) {
            let y = match level {
                // A sign may stand on the right of a relation or a power.
                3 => self.level(4)?,
                2 => self.level(3)?,
                4..=6 => {
                    self.blanks();
                    if self.rest().starts_with('-') && level == 6 {
                        self.at += 1;
                        -self.level(level + 1)?
                    } else {
                        self.level(level + 1)?
                    }
                }
                _ => self.level(level + 1)?,
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
            Some(&open @ (b'(' | b'[' | b'{')) => {
                self.enter()?;
                self.at += 1;
                let x = self.level(0)?;
                self.depth -= 1;
                self.close(open)?;
                Ok(x)
            }
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

    fn close(&mut self, open: u8) -> Result<(), String> {
        let close = match open {
            b'(' => ')',
            b'[' => ']',
            _ => '}',
        };
        self.blanks();
        if self.rest().starts_with(close) {
            self.at += 1;
            Ok(())
        } else {
            Err(format!("`{close}` is missing"))
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
        let open = self
            .rest()
            .bytes()
            .next()
            .filter(|c| matches!(c, b'(' | b'[' | b'{'));
        let Some(open) = open else {
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
        };
        self.enter()?;
        self.at += 1;
        if lower == "card" {
            self.blanks();
            let set = self.name();
            self.depth -= 1;
            self.close(open)?;
            return self
                .known
                .card(set)
                .map(|n| n as f64)
                .ok_or_else(|| format!("`{set}` has no known number of elements here"));
        }
        if lower == "sameas" {
            let a = self.text();
            self.blanks();
            if !self.rest().starts_with(',') {
                return Err("`sameas` compares two texts".into());
            }
            self.at += 1;
            let b = self.text();
            self.depth -= 1;
            self.close(open)?;
            return Ok(f64::from(u8::from(a.eq_ignore_ascii_case(b))));
        }
        let mut args = Vec::new();
        self.blanks();
        while !matches!(self.rest().bytes().next(), None | Some(b')' | b']' | b'}')) {
            args.push(self.level(0)?);
            self.blanks();
            if self.rest().starts_with(',') {
                self.at += 1;
            } else {
                break;
            }
        }
        self.depth -= 1;
        self.close(open)?;
        function(&lower, &args)
            .or_else(|| self.known.date(&lower, &args))
            .ok_or_else(|| format!("`{name}` with {} argument(s) is not known here", args.len()))
    }
}

fn first_word(text: &str) -> &str {
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    &text[..end]
}

fn function(name: &str, a: &[f64]) -> Option<f64> {
    Some(match (name, a) {
        ("abs", [x]) => x.abs(),
        ("ceil", [x]) => x.ceil(),
        ("floor", [x]) => x.floor(),
        ("trunc", [x]) => x.trunc(),
        ("frac", [x]) => x.fract(),
        ("round", [x]) => x.round(),
        ("round", [x, d]) => {
            let scale = 10f64.powf(*d);
            (x * scale).round() / scale
        }
        ("sign", [x]) => {
            if *x == 0.0 {
                0.0
            } else {
                x.signum()
            }
        }
        ("sqrt", [x]) => x.sqrt(),
        ("sqr", [x]) => x * x,
        ("exp", [x]) => x.exp(),
        ("log", [x]) => x.ln(),
        ("log2", [x]) => x.log2(),
        ("log10", [x]) => x.log10(),
        ("sin", [x]) => x.sin(),
        ("cos", [x]) => x.cos(),
        ("tan", [x]) => x.tan(),
        ("arctan", [x]) => x.atan(),
        ("fact", [x]) if *x >= 0.0 && *x <= 170.0 => (1..=*x as u32).map(f64::from).product(),
        ("power" | "rpower", [x, y]) => x.powf(*y),
        ("mod", [x, y]) => x % y,
        ("div", [x, y]) => x / y,
        ("ifthen", [c, x, y]) => {
            if *c != 0.0 {
                *x
            } else {
                *y
            }
        }
        ("min", [first, rest @ ..]) => rest.iter().fold(*first, |m, x| m.min(*x)),
        ("max", [first, rest @ ..]) => rest.iter().fold(*first, |m, x| m.max(*x)),
        _ => return None,
    })
}
