//! Values of the functions that may stand in an expression, with the numbers GAMS gives.
//!
//! Source of domains, limits and special cases: GAMS 54.6, observed. In short: results beyond 1e299
//! are ±1e299 without an error; arguments below 1e-299 in magnitude count as 0 where there is a pole;
//! |x| > 1e12 has lost its digits for sin, cos and tan; a real power wants a base ≥ 0.
//!
//! Arguments are ordinary numbers or ±∞; `eps`, `na` and `undf` are the caller's business (a NaN
//! argument gives a NaN).

use super::special;
use crate::model::instance::Function;
use Function as F;
use std::fmt;

/// The largest result of a function; anything beyond becomes this.
pub const HUGE: f64 = 1e299;
/// Below this magnitude a number counts as 0 at a pole.
pub const TINY: f64 = 1e-299;

/// What was being computed when an evaluation failed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Operation {
    /// `a / b`.
    Divide,
    /// `a ** b`, and `power(a, n)` with a fixed n.
    Power,
    /// A function.
    Call(Function),
    /// A sum, a product or a whole term: nothing of the above overflowed by itself.
    Term,
}

/// `gammareg` is 0 below this, which is e^−88.
const GAMMA_REG_LEAST: f64 = 6.054601895401186e-39;

/// Why an evaluation failed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ErrorKind {
    /// The argument is outside the domain: log of −1.
    Domain,
    /// A pole: log of 0, division by zero.
    Singular,
    /// The value exists but its derivative does not: sqrt at 0.
    Derivative,
    /// An exponent or a count that must be a whole number is none.
    NotWhole,
    /// The argument is so large that the result has no correct digit.
    Precision,
    /// The function does not take ±∞.
    Infinite,
    /// The result is beyond the range of numbers.
    Overflow,
    /// Wrong number of arguments.
    Arguments,
}

/// An evaluation that failed: operation, arguments and reason.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct DomainError {
    /// What was being computed.
    pub operation: Operation,
    /// The first arguments, up to three.
    pub arguments: [f64; 3],
    /// How many of `arguments` count.
    pub count: u8,
    /// Which argument is to blame.
    pub culprit: u8,
    /// Why.
    pub kind: ErrorKind,
}

impl DomainError {
    /// An error of `operation` at `args`; `culprit` is the place of the argument to blame.
    pub fn new(operation: Operation, args: &[f64], culprit: usize, kind: ErrorKind) -> Self {
        let mut arguments = [0.0; 3];
        let count = args.len().min(3);
        arguments[..count].copy_from_slice(&args[..count]);
        Self {
            operation,
            arguments,
            count: count as u8,
            culprit: culprit as u8,
            kind,
        }
    }

    /// The same as an outcome.
    pub(super) fn fail<T>(
        operation: Operation,
        args: &[f64],
        culprit: usize,
        kind: ErrorKind,
    ) -> Result<T, Self> {
        Err(Self::new(operation, args, culprit, kind))
    }

    /// The argument to blame.
    pub fn argument(&self) -> f64 {
        self.arguments[usize::from(self.culprit).min(2)]
    }
}

impl fmt::Display for DomainError {
    /// `log of -1`, `1 divided by 0`, `-2 ** 0.5: the base of a real power must not be negative`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b, _] = self.arguments;
        if self.kind == ErrorKind::Derivative {
            f.write_str("derivative of ")?;
        }
        match self.operation {
            Operation::Divide => write!(f, "{a} divided by {b}")?,
            Operation::Power if a < 0.0 => write!(f, "({a}) ** {b}")?,
            Operation::Power => write!(f, "{a} ** {b}")?,
            Operation::Term => f.write_str("a term")?,
            Operation::Call(function) => {
                let shown = &self.arguments[..usize::from(self.count)];
                if let [x] = shown {
                    write!(f, "{} of {x}", function.name())?;
                } else {
                    write!(f, "{}(", function.name())?;
                    for (i, x) in shown.iter().enumerate() {
                        write!(f, "{}{x}", if i > 0 { ", " } else { "" })?;
                    }
                    f.write_str(")")?;
                }
            }
        }
        match self.kind {
            ErrorKind::Domain if self.operation == Operation::Power => {
                f.write_str(": the base of a real power must not be negative")
            }
            ErrorKind::Domain | ErrorKind::Singular | ErrorKind::Derivative => Ok(()),
            ErrorKind::NotWhole => write!(f, ": {} is not a whole number", self.argument()),
            ErrorKind::Precision => f.write_str(": no digit of the result would be right"),
            ErrorKind::Infinite => f.write_str(": the function does not take an infinite argument"),
            ErrorKind::Overflow => f.write_str(": the result is too large"),
            ErrorKind::Arguments => f.write_str(": wrong number of arguments"),
        }
    }
}

impl std::error::Error for DomainError {}

/// Where the smoothed exp, log10 and 1/x of `sl…` and `sq…` begin when no place is given.
pub(super) fn smoothing_default(f: Function) -> f64 {
    match f {
        F::SlExp | F::SqExp => 150.0,
        F::SlLog10 | F::SqLog10 => 1e-150,
        _ => 1e-10,
    }
}

/// The shift of `centropy` when none is given.
pub(super) const CENTROPY_SHIFT: f64 = 1e-20;

fn truth(x: f64) -> bool {
    x != 0.0
}

fn indicator(b: bool) -> f64 {
    f64::from(u8::from(b))
}

fn clamp(v: f64) -> f64 {
    v.clamp(-HUGE, HUGE)
}

/// `a / b` as GAMS divides.
pub fn divide(a: f64, b: f64) -> Result<f64, DomainError> {
    match b.abs() <= TINY {
        true => DomainError::fail(Operation::Divide, &[a, b], 1, ErrorKind::Singular),
        false => Ok(a / b),
    }
}

/// `a ** b`: real power.
pub fn real_power(a: f64, b: f64) -> Result<f64, DomainError> {
    let fail = |culprit, kind| DomainError::fail(Operation::Power, &[a, b], culprit, kind);
    if a < 0.0 {
        return fail(0, ErrorKind::Domain);
    }
    if b.is_infinite() {
        return fail(1, ErrorKind::Infinite);
    }
    if a.is_infinite() {
        return Ok(match b {
            _ if b > 0.0 => a,
            _ if b < 0.0 => 0.0,
            _ => 1.0,
        });
    }
    if a <= 1e-150 && b < 0.0 && (a <= TINY || a.powf(b) > HUGE) {
        return fail(0, ErrorKind::Singular);
    }
    Ok(clamp(a.powf(b)))
}

/// `power(a, n)` for a whole n.
pub fn whole_power(a: f64, n: i32) -> Result<f64, DomainError> {
    let fail = |kind| DomainError::fail(Operation::Power, &[a, f64::from(n)], 0, kind);
    if n < 0 && a.abs() <= 1e-150 {
        return fail(ErrorKind::Singular);
    }
    if a == f64::NEG_INFINITY {
        return fail(ErrorKind::Infinite);
    }
    if a == f64::INFINITY {
        return Ok(if n > 0 { a } else { indicator(n == 0) });
    }
    Ok(clamp(powi(a, n)))
}

/// aⁿ: repeated squaring is fast, but loses a digit or two when n is large; `powf` does not.
#[inline]
pub(super) fn powi(a: f64, n: i32) -> f64 {
    if n.unsigned_abs() <= 8 {
        a.powi(n)
    } else {
        a.powf(f64::from(n))
    }
}

/// Value of `f` at `args`, as GAMS computes it.
///
/// Errors: an argument outside the domain, at a pole, infinite where the function takes no infinite
/// argument, or a wrong number of arguments. NaN arguments give NaN.
pub fn function_value(f: Function, args: &[f64]) -> Result<f64, DomainError> {
    let (least, most) = f.arity();
    let fail = |culprit: usize, kind| DomainError::fail(Operation::Call(f), args, culprit, kind);
    if args.len() < least || args.len() > most {
        return fail(0, ErrorKind::Arguments);
    }
    if args.iter().any(|a| a.is_nan()) {
        return Ok(f64::NAN);
    }
    if let Some(i) = args.iter().position(|a| a.is_infinite())
        && !(takes_infinity(f, args[i]) && (args.len() == 1 || !is_smoothed(f)))
    {
        return fail(i, ErrorKind::Infinite);
    }
    // To these infinity is a large number.
    let x = match f {
        F::LogGamma | F::Entropy => clamp(args[0]),
        F::Round if args.len() == 1 => clamp(args[0]),
        f if is_smoothed(f) => clamp(args[0]),
        _ => args[0],
    };
    let y = args.get(1).copied().unwrap_or(0.0);
    let z = args.get(2).copied().unwrap_or(0.0);
    use ErrorKind::{Domain, NotWhole, Precision, Singular};
    let v = match f {
        F::Exp if x == f64::INFINITY => return Ok(x),
        F::Exp => x.exp(),
        F::Log | F::Log2 | F::Log10 => {
            if x < 0.0 {
                return fail(0, Domain);
            }
            if x <= TINY {
                return fail(0, Singular);
            }
            match f {
                F::Log => x.ln(),
                F::Log2 => x.log2(),
                _ => x.log10(),
            }
        }
        F::Sqrt if x < 0.0 => return fail(0, Domain),
        F::Sqrt => x.sqrt(),
        F::Sqr => return Ok(if x.is_finite() { clamp(x * x) } else { x.abs() }),
        F::Power => {
            let n = y.round();
            if (y - n).abs() > 1e-5 || n.abs() > 2e9 {
                return fail(1, NotWhole);
            }
            return whole_power(x, n as i32);
        }
        F::RPower => return real_power(x, y),
        F::CvPower if x < 0.0 => return fail(0, Domain),
        F::CvPower if x == 0.0 => 0.0,
        F::CvPower => x.powf(y),
        F::VcPower | F::SignPower => {
            if x < 0.0 && f == F::VcPower {
                return fail(0, Domain);
            }
            if x.abs() <= TINY && y < 0.0 {
                return fail(0, Singular);
            }
            let v = x.abs().powf(y);
            if x < 0.0 { -v } else { v }
        }
        F::Sin | F::Cos | F::Tan if x.abs() > 1e12 => return fail(0, Precision),
        F::Sin => x.sin(),
        F::Cos => x.cos(),
        F::Tan => x.tan(),
        F::ArcSin | F::ArcCos if x.abs() > 1.0 => return fail(0, Domain),
        F::ArcSin => x.asin(),
        F::ArcCos => x.acos(),
        F::ArcTan => x.atan(),
        F::ArcTan2 if x.abs() <= TINY && y.abs() <= TINY => return fail(0, Singular),
        F::ArcTan2 => x.atan2(y),
        F::Sinh => x.sinh(),
        F::Cosh => x.cosh(),
        F::Tanh => x.tanh(),
        F::ErrorF if x.is_infinite() => indicator(x > 0.0),
        F::ErrorF => special::normal_cdf(x),
        F::Gamma if x.abs() <= TINY || (x < 0.0 && x == x.round()) => return fail(0, Singular),
        F::Gamma => special::gamma(x),
        F::LogGamma if x < 0.0 => return fail(0, Domain),
        F::LogGamma if x <= TINY => return fail(0, Singular),
        F::LogGamma => special::log_gamma(x),
        F::Beta | F::LogBeta => {
            for (i, &a) in args.iter().enumerate() {
                if a <= TINY {
                    return fail(i, if a < 0.0 { Domain } else { Singular });
                }
            }
            if f == F::Beta {
                special::beta(x, y)
            } else {
                special::log_beta(x, y)
            }
        }
        F::BetaReg => {
            if !(0.0..=1.0).contains(&x) {
                return fail(0, Domain);
            }
            if y <= 0.0 || z <= 0.0 {
                return fail(if y <= 0.0 { 1 } else { 2 }, Domain);
            }
            if y.max(z) > special::LARGEST_PARAMETER && x > 0.0 && x < 1.0 {
                return fail(if y > z { 1 } else { 2 }, Precision);
            }
            special::beta_reg(x, y, z).v
        }
        F::GammaReg => {
            if x < 0.0 || y <= 0.0 {
                return fail(usize::from(x >= 0.0), Domain);
            }
            if y > special::LARGEST_PARAMETER {
                return fail(1, Precision);
            }
            let v = special::gamma_reg(y, x).v;
            if v < GAMMA_REG_LEAST { 0.0 } else { v }
        }
        F::Binomial => {
            if x <= -1.0 || y <= -1.0 {
                return fail(usize::from(x > -1.0), Domain);
            }
            if x - y <= -1.0 {
                return fail(1, Singular);
            }
            special::binomial(x, y)
        }
        F::Entropy if x < 0.0 => return fail(0, Domain),
        F::Entropy if x == 0.0 => 0.0,
        F::Entropy => -x * x.ln(),
        F::Centropy => {
            let shift = args.get(2).copied().unwrap_or(CENTROPY_SHIFT);
            if let Some(i) = [x, y, shift].iter().position(|&a| a < 0.0) {
                return fail(i, Domain);
            }
            if y <= TINY {
                return fail(1, Singular);
            }
            if x == 0.0 {
                0.0
            } else {
                x * log_ratio(x + shift, y + shift)
            }
        }
        F::Sigmoid => sigmoid(x),
        F::Logit => {
            if !(0.0..=1.0).contains(&x) {
                return fail(0, Domain);
            }
            if x <= TINY || x == 1.0 {
                return fail(0, Singular);
            }
            if (0.25..=0.75).contains(&x) {
                2.0 * (2.0 * x - 1.0).atanh()
            } else {
                x.ln() - (-x).ln_1p()
            }
        }
        F::Poly => args[1..].iter().rev().fold(0.0, |s, a| s * x + a),
        F::SlExp | F::SlLog10 | F::SlRec | F::SqExp | F::SqLog10 | F::SqRec => {
            let place = args.get(1).copied().unwrap_or(smoothing_default(f));
            let least = match f {
                F::SlLog10 | F::SqLog10 => 1e-150,
                F::SlRec | F::SqRec => 1e-10,
                _ => f64::NEG_INFINITY,
            };
            if place < least {
                return fail(1, Domain);
            }
            smoothed(f, x, place)
        }
        F::NcpCm if z <= 0.0 => return fail(2, Domain),
        // As GAMS computes it, to the last digit.
        F::NcpCm => match ((x - y) / z).exp() {
            f64::INFINITY => y,
            e => x - z * (1.0 + e).ln(),
        },
        F::NcpF if z < 0.0 => return fail(2, Domain),
        F::NcpF => {
            // √(x² + y² + 2μ) − x − y without cancellation where x + y > 0
            let root = x.hypot(y).hypot((2.0 * z).sqrt());
            if x + y > 0.0 {
                2.0 * (z - x * y) / (root + x + y)
            } else {
                root - x - y
            }
        }
        F::NcpVuSin | F::NcpVuPow if z < 0.0 => return fail(2, Domain),
        F::NcpVuSin | F::NcpVuPow => {
            if (x - y).abs() >= z {
                x.min(y)
            } else {
                0.5 * (x + y - z * smoothed_abs(f, (x - y) / z).0)
            }
        }
        F::EDist => args.iter().fold(0.0_f64, |s, &a| s.hypot(a)),
        F::Div if y.abs() <= 1e-150 => return fail(1, Singular),
        F::Div => x / y,
        F::Div0 if y.abs() <= 1e-150 => {
            if x < 0.0 {
                -HUGE
            } else {
                HUGE
            }
        }
        F::Div0 => x / y,
        F::LseMax => log_sum_exp(args, 1.0),
        F::LseMin => -log_sum_exp(args, -1.0),
        F::LseMaxSc | F::LseMinSc if x <= 0.0 => return fail(0, Domain),
        F::LseMaxSc => log_sum_exp(&args[1..], x) / x,
        F::LseMinSc => -log_sum_exp(&args[1..], -x) / x,
        F::Abs => return Ok(x.abs()),
        F::Sign if x == 0.0 => 0.0,
        F::Sign => x.signum(),
        F::Min => return Ok(args.iter().copied().fold(f64::INFINITY, f64::min)),
        F::Max => return Ok(args.iter().copied().fold(f64::NEG_INFINITY, f64::max)),
        F::Floor => return Ok(x.floor()),
        F::Ceil => return Ok(x.ceil()),
        F::Trunc => return Ok(x.trunc()),
        F::Round if x.is_infinite() => return Ok(x),
        F::Round => {
            let n = y.round();
            if (y - n).abs() > 1e-5 {
                return fail(1, NotWhole);
            }
            round_to(x, n)
        }
        F::Frac if x.is_infinite() => 0.0,
        F::Frac => x - x.trunc(),
        F::Mod if y.abs() < 1e-30 => return fail(1, Singular),
        // As GAMS computes it: the exact remainder differs where the quotient is rounded to a whole number.
        F::Mod => x - (x / y).trunc() * y,
        F::IfThen => return Ok(if truth(x) { y } else { z }),
        F::BoolAnd => indicator(truth(x) && truth(y)),
        F::BoolOr => indicator(truth(x) || truth(y)),
        F::BoolNot => indicator(!truth(x)),
        F::BoolXor => indicator(truth(x) != truth(y)),
        F::BoolEqv => indicator(truth(x) == truth(y)),
        F::BoolImp => indicator(!truth(x) || truth(y)),
        F::RelEq => indicator(x == y),
        F::RelNe => indicator(x != y),
        F::RelLt => indicator(x < y),
        F::RelLe => indicator(x <= y),
        F::RelGt => indicator(x > y),
        F::RelGe => indicator(x >= y),
    };
    if v.is_infinite() && matches!(f, F::Log | F::Log2 | F::Log10 | F::Sqrt) {
        return Ok(v);
    }
    Ok(clamp(v))
}

/// exp, log10 and 1/x that go on as polynomials.
fn is_smoothed(f: Function) -> bool {
    use F::*;
    matches!(f, SlExp | SlLog10 | SlRec | SqExp | SqLog10 | SqRec)
}

/// Whether a function with so many arguments is `na` where one of them is; the others refuse it.
pub fn takes_na(f: Function, arguments: usize) -> bool {
    arguments < 3 || matches!(f, F::Min | F::Max | F::IfThen)
}

/// Which functions take +∞ or −∞ (`x` is the infinite argument).
fn takes_infinity(f: Function, x: f64) -> bool {
    use F::*;
    match f {
        Log | Log2 | Log10 | Sqrt | Power | RPower => x > 0.0,
        Exp | Sqr | Abs | Sign | Min | Max | Floor | Ceil | Round | Trunc | Frac | ErrorF
        | Sigmoid | ArcTan | Tanh | Sinh | Cosh => true,
        Gamma | LogGamma | Entropy => x > 0.0,
        f if is_smoothed(f) => true,
        IfThen | BoolAnd | BoolOr | BoolNot | BoolXor | BoolEqv | BoolImp | RelEq | RelNe
        | RelLt | RelLe | RelGt | RelGe => true,
        // outside the domain in any case
        ArcSin | ArcCos => true,
        _ => false,
    }
}

/// x rounded to n decimals, halves away from zero: ⌊|x|·10ⁿ + ½⌋/10ⁿ in doubles (like GAMS: 2.345 gives 2.35,
/// 1.005 gives 1.00, 0.35 gives 0.4).
fn round_to(x: f64, n: f64) -> f64 {
    let power = 10f64.powi(n.abs().min(300.0) as i32);
    let times = |v: f64, up: bool| if up { v * power } else { v / power };
    let scaled = times(x.abs(), n >= 0.0);
    if !scaled.is_finite() || scaled > 4.5e15 {
        return x;
    }
    times((scaled + 0.5).floor(), n < 0.0).copysign(x)
}

/// log(a / b) for a, b > 0, accurate where a ≈ b.
pub(super) fn log_ratio(a: f64, b: f64) -> f64 {
    let r = a / b;
    if r > 0.5 && r < 2.0 {
        ((a - b) / b).ln_1p()
    } else if r.is_finite() && r > 0.0 {
        r.ln()
    } else {
        a.ln() - b.ln()
    }
}

/// 1/(1 + e^−x).
pub(super) fn sigmoid(x: f64) -> f64 {
    if x >= 0.0 {
        1.0 / (1.0 + (-x).exp())
    } else {
        let e = x.exp();
        e / (1.0 + e)
    }
}

/// log Σ e^(s·x).
fn log_sum_exp(args: &[f64], s: f64) -> f64 {
    let m = args
        .iter()
        .map(|&a| s * a)
        .fold(f64::NEG_INFINITY, f64::max);
    let mut peaks = -1.0;
    let mut rest = 0.0;
    for &a in args {
        let e = (s * a - m).exp();
        if e == 1.0 {
            peaks += 1.0;
        } else {
            rest += e;
        }
    }
    m + (peaks + rest).ln_1p()
}

/// The function that `sl…`/`sq…` smooth, and its first four derivatives, at s.
pub(super) fn smoothing_base(f: Function, s: f64) -> [f64; 5] {
    match f {
        F::SlExp | F::SqExp => [s.exp(); 5],
        F::SlLog10 | F::SqLog10 => {
            let c = std::f64::consts::LOG10_E;
            let r = 1.0 / s;
            [
                s.log10(),
                c * r,
                -c * r * r,
                2.0 * c * r * r * r,
                -6.0 * c * r * r * r * r,
            ]
        }
        _ => {
            let r = 1.0 / s;
            let cube = 2.0 * r * r * r;
            [r, -r * r, cube, -6.0 * r.powi(4), 24.0 * r.powi(5)]
        }
    }
}

/// Whether x lies where `sl…`/`sq…` replace the function by its Taylor polynomial.
pub(super) fn in_smoothed_part(f: Function, x: f64, place: f64) -> bool {
    match f {
        F::SlExp | F::SqExp => x > place,
        _ => x < place,
    }
}

fn smoothed(f: Function, x: f64, place: f64) -> f64 {
    if !in_smoothed_part(f, x, place) {
        return match f {
            F::SlExp | F::SqExp => x.exp(),
            F::SlLog10 | F::SqLog10 => x.log10(),
            _ => 1.0 / x,
        };
    }
    // Taylor in t = (x − s)/s where the derivatives scale with 1/s: nothing overflows on the way
    let (value, t, first, second) = match f {
        F::SlExp | F::SqExp => {
            let e = place.exp();
            (e, x - place, e, e)
        }
        F::SlLog10 | F::SqLog10 => {
            let c = std::f64::consts::LOG10_E;
            (place.log10(), (x - place) / place, c, -c)
        }
        _ => {
            let r = 1.0 / place;
            (r, (x - place) / place, -r, 2.0 * r)
        }
    };
    let quadratic = matches!(f, F::SqExp | F::SqLog10 | F::SqRec);
    value + first * t + if quadratic { 0.5 * second * t * t } else { 0.0 }
}

/// θ, θ' and θ'' of Veelken and Ulbrich's smoothing of |t| on [−1, 1].
pub(super) fn smoothed_abs(f: Function, t: f64) -> (f64, f64, f64) {
    use std::f64::consts::FRAC_PI_2;
    if f == F::NcpVuSin {
        let (s, c) = (FRAC_PI_2 * t).sin_cos();
        (1.0 - c / FRAC_PI_2, s, FRAC_PI_2 * c)
    } else {
        let q = t * t;
        (
            0.125 * (3.0 + q * (6.0 - q)),
            0.5 * t * (3.0 - q),
            1.5 * (1.0 - q),
        )
    }
}
