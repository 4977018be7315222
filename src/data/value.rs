//! Numbers with GAMS's special values.
//!
//! A value is an `f64`. `eps` (a zero that is stored), `na` (not available) and `undf` (undefined,
//! the result of an error) are NaNs that carry a payload, so ordinary arithmetic needs no test as
//! long as its result is finite. `inf` and `-inf` are the IEEE infinities.
//! Source of the rules: GAMS 54.6, observed.

const EPS_BITS: u64 = 0x7ff8_0000_0000_0e95;
const NA_BITS: u64 = 0x7ff8_0000_0000_0a0a;
const UNDF_BITS: u64 = 0x7ff8_0000_0000_0df0;

/// A zero that is stored and counts as true.
pub const EPS: f64 = f64::from_bits(EPS_BITS);
/// Not available.
pub const NA: f64 = f64::from_bits(NA_BITS);
/// Undefined.
pub const UNDF: f64 = f64::from_bits(UNDF_BITS);

/// Whether `x` is `eps`.
#[inline]
pub fn is_eps(x: f64) -> bool {
    x.to_bits() == EPS_BITS
}

/// Whether `x` is `na`.
#[inline]
pub fn is_na(x: f64) -> bool {
    x.to_bits() == NA_BITS
}

/// Whether `x` is undefined: `undf`, or any NaN that is neither `eps` nor `na`.
#[inline]
pub fn is_undf(x: f64) -> bool {
    x.is_nan() && !is_eps(x) && !is_na(x) && as_acronym(x).is_none()
}

/// Numeric truth: everything but 0 is true, `eps` too.
#[inline]
pub fn truth(x: f64) -> bool {
    x != 0.0
}

/// The number itself; `eps` becomes 0.
#[inline]
pub fn number(x: f64) -> f64 {
    if is_eps(x) { 0.0 } else { x }
}

const ACRONYM_BITS: u64 = 0x7ff8_0001_0000_0000;

/// The value of acronym number `n`.
pub fn acronym(n: u32) -> f64 {
    f64::from_bits(ACRONYM_BITS | u64::from(n))
}

/// The number of the acronym, if `x` is one.
pub fn as_acronym(x: f64) -> Option<u32> {
    (x.to_bits() & 0xffff_ffff_0000_0000 == ACRONYM_BITS).then_some(x.to_bits() as u32)
}

/// How a value that is no number is written, an acronym by its name; none for numbers.
pub fn special_text(x: f64, acronyms: &[Box<str>]) -> Option<&str> {
    Some(match x {
        x if x.is_finite() => return None,
        f64::INFINITY => "+INF",
        f64::NEG_INFINITY => "-INF",
        x if is_eps(x) => "EPS",
        x if is_na(x) => "NA",
        x => match as_acronym(x).and_then(|n| acronyms.get(n as usize)) {
            Some(name) => name,
            None => "UNDF",
        },
    })
}
