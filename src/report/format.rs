//! Texts with places for values, as `printf` has them: `%8.5f`, `%g`, `%d`, `%s`, `%%`.

use std::fmt::Write;

/// A value for a place.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number; special values by name where they are shown.
    Number(f64, Option<String>),
    /// A text.
    Text(String),
}

impl Value {
    /// An ordinary number.
    pub fn number(x: f64) -> Self {
        Self::Number(x, None)
    }
}

/// A place: flags, width, precision, letter.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    left: bool,
    plus: bool,
    zero: bool,
    width: usize,
    precision: Option<usize>,
    letter: char,
}

/// Fills the places of a text in order. Values that are left over follow after a blank each. The error
/// is a sentence.
pub fn fill(template: &str, values: &[Value]) -> Result<String, String> {
    let mut out = String::new();
    let mut rest = values.iter();
    let mut chars = template.chars().peekable();
    while let Some(c) = chars.next() {
        if c != '%' {
            out.push(c);
            continue;
        }
        let mut p = Place::default();
        let mut spelled = String::from("%");
        while let Some(&f) = chars.peek().filter(|f| matches!(f, '-' | '+' | '0' | ' ')) {
            p.left |= f == '-';
            p.plus |= f == '+';
            p.zero |= f == '0';
            spelled.push(f);
            chars.next();
        }
        let digits = |spelled: &mut String,
                      chars: &mut std::iter::Peekable<std::str::Chars<'_>>| {
            let mut n = 0;
            while let Some(d) = chars.peek().and_then(|d| d.to_digit(10)) {
                n = (n * 10 + d as usize).min(200);
                spelled.extend(chars.next());
            }
            n
        };
        p.width = digits(&mut spelled, &mut chars);
        if chars.peek() == Some(&'.') {
            spelled.extend(chars.next());
            p.precision = Some(digits(&mut spelled, &mut chars));
        }
        match chars.next() {
            Some('%') if spelled == "%" => out.push('%'),
            Some(letter @ ('f' | 'e' | 'g' | 'd' | 'i' | 's')) => {
                p.letter = letter;
                let Some(v) = rest.next() else {
                    return Err(format!("there is no value for `{spelled}{letter}`"));
                };
                out.push_str(&p.show(v).map_err(|what| {
                    format!("`{spelled}{letter}` takes a number, not the text `{what}`")
                })?);
            }
            Some(other) => {
                return Err(format!(
                    "`{spelled}{other}` is not a format; `%8.5f`, `%g`, `%d`, `%s` and `%%` are"
                ));
            }
            None => return Err("a format ends after `%`; a percent sign is written `%%`".into()),
        }
    }
    for v in rest {
        if !out.is_empty() {
            out.push(' ');
        }
        let _ = write!(out, "{}", plain(v));
    }
    Ok(out)
}

/// A value without a format.
pub fn plain(v: &Value) -> String {
    Place {
        letter: 'g',
        ..Place::default()
    }
    .show(v)
    .unwrap_or_else(|t| t)
}

impl Place {
    fn show(&self, v: &Value) -> Result<String, String> {
        let text = match v {
            Value::Text(t) if self.letter == 's' => match self.precision {
                Some(n) => t.chars().take(n).collect(),
                None => t.clone(),
            },
            Value::Text(t) => return Err(t.clone()),
            Value::Number(_, Some(name)) => name.clone(),
            Value::Number(x, None) => {
                let t = match self.letter {
                    'f' => format!("{:.*}", self.precision.unwrap_or(6), x),
                    'e' => exponent(*x, self.precision.unwrap_or(6)),
                    'd' | 'i' => format!("{:.0}", x.round()),
                    _ => general(*x, self.precision.unwrap_or(6)),
                };
                let t = if is_zero(&t) {
                    t.replacen('-', "", 1)
                } else {
                    t
                };
                if self.plus && !t.starts_with('-') {
                    format!("+{t}")
                } else {
                    t
                }
            }
        };
        let n = text.chars().count();
        let blanks = self.width.saturating_sub(n);
        Ok(if self.left {
            format!("{text}{:blanks$}", "")
        } else if self.zero && matches!(v, Value::Number(_, None)) {
            let sign = usize::from(text.starts_with(['-', '+']));
            format!("{}{}{}", &text[..sign], "0".repeat(blanks), &text[sign..])
        } else {
            format!("{:blanks$}{text}", "")
        })
    }
}

fn is_zero(t: &str) -> bool {
    !t.bytes().any(|b| b.is_ascii_digit() && b != b'0')
}

/// `1.500000e+03`
fn exponent(x: f64, digits: usize) -> String {
    let t = format!("{x:.digits$e}");
    match t.split_once('e') {
        Some((m, e)) => {
            let e: i32 = e.parse().unwrap_or(0);
            format!("{m}e{}{:02}", if e < 0 { '-' } else { '+' }, e.abs())
        }
        None => t,
    }
}

/// `1 row`, `2 rows`.
pub fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// The shorter of the two forms, without trailing zeros.
fn general(x: f64, digits: usize) -> String {
    let digits = digits.max(1);
    let rounded = format!("{:.*e}", digits - 1, x);
    let e: i32 = rounded
        .split_once('e')
        .and_then(|(_, e)| e.parse().ok())
        .unwrap_or(0);
    let strip = |t: &str| {
        if t.contains('.') {
            t.trim_end_matches('0').trim_end_matches('.').to_string()
        } else {
            t.to_string()
        }
    };
    if e < -4 || e >= digits as i32 {
        let t = exponent(x, digits - 1);
        match t.split_once('e') {
            Some((m, e)) => format!("{}e{e}", strip(m)),
            None => t,
        }
    } else {
        strip(&format!(
            "{:.*}",
            (digits as i32 - 1 - e).max(0) as usize,
            x
        ))
    }
}
