//! Arithmetic with GAMS's special values. Source: GAMS 54.6, observed.

use crate::check::node::BinaryOp;
use crate::data::value::{EPS, NA, UNDF, as_acronym, is_eps, is_na, is_undf, number, truth};

/// Why an operation has no value.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ArithmeticError {
    /// Division by zero or eps.
    DivisionByZero,
    /// `inf*0` and the like.
    Indefinite,
    /// Ordinary numbers whose result is too large.
    Overflow,
}

/// Results of this size and more are not numbers any more.
const HUGE: f64 = 1e300;

/// Whether a number cannot be computed with: `undf` or an acronym.
pub fn is_undefined(x: f64) -> bool {
    x.is_nan() && !is_eps(x) && !is_na(x)
}

/// a + b
#[inline]
pub fn add(a: f64, b: f64) -> f64 {
    let r = a + b;
    if r.abs() < HUGE { r } else { add_special(a, b) }
}

#[cold]
fn add_special(a: f64, b: f64) -> f64 {
    if is_undefined(a) || is_undefined(b) {
        return UNDF;
    }
    if is_na(a) || is_na(b) {
        return NA;
    }
    match (is_eps(a), is_eps(b)) {
        (true, true) => return EPS,
        (true, false) => return if b == 0.0 { EPS } else { b },
        (false, true) => return if a == 0.0 { EPS } else { a },
        _ => {}
    }
    match (a.is_infinite(), b.is_infinite()) {
        (true, true) if a != b => 0.0,
        (true, _) => a,
        (_, true) => b,
        _ => UNDF,
    }
}

/// −a
#[inline]
pub fn negate(a: f64) -> f64 {
    match a {
        a if !a.is_nan() => -a,
        a if as_acronym(a).is_some() => UNDF,
        a => a,
    }
}

/// a · b
#[inline]
pub fn multiply(a: f64, b: f64) -> Result<f64, ArithmeticError> {
    let r = a * b;
    if r.abs() < HUGE {
        Ok(r)
    } else {
        multiply_special(a, b)
    }
}

#[cold]
fn multiply_special(a: f64, b: f64) -> Result<f64, ArithmeticError> {
    if is_undefined(a) || is_undefined(b) {
        return Ok(UNDF);
    }
    if is_na(a) || is_na(b) {
        return Ok(NA);
    }
    let (za, zb) = (a == 0.0 || is_eps(a), b == 0.0 || is_eps(b));
    if (za && b.is_infinite()) || (zb && a.is_infinite()) {
        return Err(ArithmeticError::Indefinite);
    }
    if za || zb {
        return Ok(if a == 0.0 || b == 0.0 { 0.0 } else { EPS });
    }
    if a.is_infinite() || b.is_infinite() {
        Ok(a * b)
    } else {
        Err(ArithmeticError::Overflow)
    }
}

/// a / b
#[inline]
pub fn divide(a: f64, b: f64) -> Result<f64, ArithmeticError> {
    let r = a / b;
    if r.abs() < HUGE && b != 0.0 && b.is_finite() {
        Ok(r)
    } else {
        divide_special(a, b)
    }
}

/// a / b as a · (1/b), the way GAMS divides by numbers and scalars.
#[inline]
pub fn divide_by_scalar(a: f64, b: f64) -> Result<f64, ArithmeticError> {
    let r = 1.0 / b;
    if r.is_normal() && b.is_finite() {
        multiply(a, r)
    } else {
        divide(a, b)
    }
}

#[cold]
fn divide_special(a: f64, b: f64) -> Result<f64, ArithmeticError> {
    if is_undefined(a) || is_undefined(b) {
        return Ok(UNDF);
    }
    if b == 0.0 || is_eps(b) {
        return Err(ArithmeticError::DivisionByZero);
    }
    if is_na(a) || is_na(b) {
        return Ok(NA);
    }
    match (a.is_infinite(), b.is_infinite()) {
        (true, true) => Ok(a.signum() * b.signum()),
        (false, true) => Ok(0.0),
        (false, false) if is_eps(a) => Ok(EPS),
        (true, false) => Ok(if b > 0.0 { a } else { -a }),
        _ if (a / b).abs() < HUGE => Ok(a / b),
        _ => Err(ArithmeticError::Overflow),
    }
}

/// A relation or logical operation: 1, 0, `na` or `undf`.
pub fn relate(op: BinaryOp, a: f64, b: f64) -> f64 {
    let yes = |c: bool| f64::from(u8::from(c));
    match op {
        BinaryOp::And | BinaryOp::Or | BinaryOp::Xor | BinaryOp::Implies | BinaryOp::Equivalent => {
            if is_undf(a) || is_undf(b) {
                return UNDF;
            }
            if is_na(a) || is_na(b) {
                return NA;
            }
            let (x, y) = (truth(a), truth(b));
            yes(match op {
                BinaryOp::And => x && y,
                BinaryOp::Or => x || y,
                BinaryOp::Xor => x != y,
                BinaryOp::Implies => !x || y,
                _ => x == y,
            })
        }
        _ => {
            if a.is_nan() || b.is_nan() {
                return relate_special(op, a, b);
            }
            yes(compare(op, a, b))
        }
    }
}

/// `not a`
pub fn not(a: f64) -> f64 {
    if is_undf(a) || is_na(a) {
        return a;
    }
    f64::from(u8::from(!truth(a)))
}

fn compare(op: BinaryOp, a: f64, b: f64) -> bool {
    // Numbers from 1e299 on are as good as infinite.
    let (a, b) = (a.clamp(-1e299, 1e299), b.clamp(-1e299, 1e299));
    match op {
        BinaryOp::Eq => a == b,
        BinaryOp::Ne => a != b,
        BinaryOp::Lt => a < b,
        BinaryOp::Le => a <= b,
        BinaryOp::Gt => a > b,
        BinaryOp::Ge => a >= b,
        _ => false,
    }
}

#[cold]
fn relate_special(op: BinaryOp, a: f64, b: f64) -> f64 {
    let (a, b) = (number(a), number(b));
    let yes = |c: bool| f64::from(u8::from(c));
    if !a.is_nan() && !b.is_nan() {
        return yes(compare(op, a, b));
    }
    // na, undf and acronyms are equal to themselves only.
    let same = a.to_bits() == b.to_bits();
    match op {
        BinaryOp::Eq => yes(same),
        BinaryOp::Ne => yes(!same),
        _ if is_undefined(a) || is_undefined(b) => UNDF,
        _ => NA,
    }
}
