//! Numbers as `put` writes them: to a width, with decimals, in four forms.
//!
//! Source: GAMS 54.6, observed. What is asked for beyond the digits that tell a double from its
//! neighbours is zeros.

/// The forms of `.nr`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Form {
    /// 0: with an exponent where it would vanish or does not fit.
    AsNeeded,
    /// 1: rounded to the decimals; with an exponent where it does not fit.
    Rounded,
    /// 2: always with an exponent.
    Scientific,
    /// 3: as many digits as fit.
    Widest,
    /// 4: the digits it has, or as many as fit, with an exponent where that is shorter; no decimals are asked.
    General,
}

impl Form {
    /// The form of a value of `.nr`.
    pub fn new(nr: f64) -> Self {
        match nr as i64 {
            0 => Self::AsNeeded,
            2 => Self::Scientific,
            3 => Self::Widest,
            4 => Self::General,
            _ => Self::Rounded,
        }
    }
}

/// Widest number where the width is given as 0.
const OPEN: usize = 24;
/// Most decimals with an exponent, where it is always there.
const SCIENTIFIC: usize = 15;
/// Digits that `.nr = 3` shows.
const WIDEST: usize = 17;

/// The most digits that fit, beginning with all that the number has.
fn general(x: f64, room: usize) -> Option<String> {
    if x == 0.0 {
        return Some("0".into());
    }
    let digits = shortest(x).0.len();
    (1..=digits)
        .rev()
        .map(|n| format!("{:.*e}", n - 1, x.abs()))
        .find_map(|text| fitting(&text, x < 0.0, room))
}

/// `1.25e-4` without an exponent, from 0.001 up to 1e18, or with one: what fits.
fn fitting(scientific: &str, negative: bool, room: usize) -> Option<String> {
    let (mantissa, exponent) = scientific.split_once('e')?;
    let exponent: i32 = exponent.parse().ok()?;
    let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    let digits = match digits.trim_end_matches('0') {
        "" => "0",
        d => d,
    };
    let sign = if negative { "-" } else { "" };
    let (first, rest) = digits.split_at(1);
    let point = if rest.is_empty() { "" } else { "." };
    let with = format!("{sign}{first}{point}{rest}E{exponent}");
    if !(-3..18).contains(&exponent) {
        return Some(with).filter(|t| t.len() <= room);
    }
    let n = digits.len() as i32;
    let without = if exponent < 0 {
        format!("{sign}0.{}{digits}", "0".repeat((-exponent - 1) as usize))
    } else if n <= exponent + 1 {
        format!("{sign}{digits}{}", "0".repeat((exponent + 1 - n) as usize))
    } else {
        let (whole, decimals) = digits.split_at((exponent + 1) as usize);
        format!("{sign}{whole}.{decimals}")
    };
    [without, with].into_iter().find(|t| t.len() <= room)
}

/// A finite number in at most `width` characters (0: as many as it needs), not padded; asterisks where
/// it cannot be shown.
pub fn number(x: f64, width: usize, decimals: usize, form: Form) -> String {
    let room = if width == 0 { OPEN } else { width };
    let negative = usize::from(x.is_sign_negative() && x != 0.0);
    let text = match form {
        Form::Scientific => scientific(x, room, decimals),
        Form::General => general(x, room),
        Form::Widest => widest(x, room, negative).or_else(|| exponential(x, room)),
        Form::AsNeeded | Form::Rounded => {
            let decimals = decimals.min(room.saturating_sub(2 + negative));
            let fixed = Some(fixed(x, decimals)).filter(|t| t.len() <= room);
            let vanishes = |t: &String| x != 0.0 && !t.bytes().any(|b| matches!(b, b'1'..=b'9'));
            match fixed {
                Some(t) if form == Form::AsNeeded && vanishes(&t) => {
                    exponential(x, room).or(Some(t))
                }
                Some(t) => Some(t),
                None => exponential(x, room),
            }
        }
    };
    match text {
        Some(t) => t,
        None if form != Form::Scientific && x.abs() <= 0.5 => "0".into(),
        None => "*".repeat(room),
    }
}

/// The shortest digits that tell a double from its neighbours, and the exponent of the first.
fn shortest(x: f64) -> (Vec<u8>, i64) {
    let text = format!("{:e}", x.abs());
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let digits = mantissa.bytes().filter(u8::is_ascii_digit).collect();
    (digits, exponent.parse().unwrap_or(0))
}

/// With a fixed number of decimals.
fn fixed(x: f64, decimals: usize) -> String {
    let x = if x == 0.0 { 0.0 } else { x };
    // Few digits are always the double's own.
    if x.abs() < 1e6 && decimals < 9 {
        return format!("{x:.decimals$}");
    }
    let (digits, exponent) = shortest(x);
    if exponent + decimals as i64 + 1 < digits.len() as i64 {
        return format!("{x:.decimals$}");
    }
    let mut out = String::from(if x < 0.0 { "-" } else { "" });
    let digit = |place: i64| match usize::try_from(exponent - place) {
        Ok(k) => digits.get(k).map_or('0', |&b| b as char),
        Err(_) => '0',
    };
    for place in (0..=exponent.max(0)).rev() {
        out.push(digit(place));
    }
    if decimals > 0 {
        out.push('.');
        for place in 1..=decimals as i64 {
            out.push(digit(-place));
        }
    }
    out
}

/// Mantissa with `digits` decimals (−1: without a point), and the exponent after rounding.
fn parts(x: f64, digits: i64) -> (String, i64) {
    let shown = digits.max(0) as usize;
    let (all, exponent) = shortest(x);
    if all.len() <= shown + 1 {
        let mut mantissa = String::from(if x < 0.0 { "-" } else { "" });
        mantissa.push(all[0] as char);
        if digits >= 0 {
            mantissa.push('.');
            mantissa.extend((1..=shown).map(|k| all.get(k).map_or('0', |&b| b as char)));
        }
        return (mantissa, exponent);
    }
    let text = format!("{x:.shown$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let point = if digits == 0 { "." } else { "" };
    (format!("{mantissa}{point}"), exponent.parse().unwrap_or(0))
}

/// `1.235E+5`, `1.E+5`, `1E+5`, `1E5`: with as many digits as make the width.
fn exponential(x: f64, width: usize) -> Option<String> {
    // Rounding may lengthen or shorten the exponent: the first that fits, from above.
    let (_, e) = parts(x, 0);
    let taken = i64::from(x < 0.0) + 4 + e.abs().to_string().len() as i64;
    let most = (width as i64).min(width as i64 - taken + 1);
    let mut texts = (-2..=most).rev().map(|digits| {
        let (mantissa, e) = parts(x, digits);
        let sign = match e {
            e if e < 0 => "-",
            _ if digits == -2 => "",
            _ => "+",
        };
        format!("{mantissa}E{sign}{}", e.abs())
    });
    texts.find(|t| t.len() <= width)
}

/// ` 1.23E+05`: a place for the sign, two digits of exponent, no more decimals than asked for.
fn scientific(x: f64, width: usize, decimals: usize) -> Option<String> {
    let most = decimals.min(SCIENTIFIC) as i64;
    let mut texts = (-1..=most).rev().map(|digits| {
        let (mantissa, e) = parts(x, digits);
        let sign = if e < 0 { '-' } else { '+' };
        let blank = if mantissa.starts_with('-') { "" } else { " " };
        format!("{blank}{mantissa}E{sign}{:02}", e.abs())
    });
    texts.find(|t| t.len() <= width)
}

/// All digits that fit, at most seventeen.
fn widest(x: f64, width: usize, negative: usize) -> Option<String> {
    if x == 0.0 {
        return Some("0".into());
    }
    let mut whole = format!("{:.0}", x.abs().trunc()).len();
    loop {
        let room = width.saturating_sub(negative + whole + 1);
        let text = fixed(x, WIDEST.saturating_sub(whole).min(room));
        let now = text.find('.').unwrap_or(text.len()) - negative;
        if now > whole {
            // Rounded up to one digit more.
            whole = now;
            continue;
        }
        return (text.len() <= width).then_some(text);
    }
}
