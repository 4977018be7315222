//! Rounding errors in levels and marginals.

/// Rounding error of levels, relative to the largest.
pub(super) const LEVELS: f64 = 1e-14;
/// The same of multipliers, which come from a factorisation.
const MULTIPLIERS: f64 = 1e-13;

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(1.0, |s: f64, v| s.max(v.abs()))
}

/// Puts levels on the bounds that they are at up to rounding.
pub(super) fn snap(x: &mut [f64], lower: &[f64], upper: &[f64]) {
    let rounding = LEVELS * largest(x);
    for (v, (&l, &u)) in x.iter_mut().zip(lower.iter().zip(upper)) {
        for bound in [l, u] {
            if (*v - bound).abs() <= rounding {
                *v = bound;
            }
        }
    }
}

/// Sets marginals to 0 that are below the rounding error of the largest.
pub(super) fn zero_below_roundoff(marginals: &mut [f64]) {
    let rounding = MULTIPLIERS * largest(marginals);
    for v in marginals.iter_mut().filter(|v| v.abs() <= rounding) {
        *v = 0.0;
    }
}
