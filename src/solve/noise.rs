//! Numbers that differ from what is meant by rounding only.

/// Relative to the largest number beside it: by so much what was computed is wrong at least.
pub const LEVELS: f64 = 1e-14;
/// The same of multipliers, which a factorisation gave.
const MULTIPLIERS: f64 = 1e-13;

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(1.0, |s: f64, v| s.max(v.abs()))
}

/// Puts levels on their bounds that are there up to rounding.
pub fn snap(x: &mut [f64], lower: &[f64], upper: &[f64]) {
    let rounding = LEVELS * largest(x);
    for (v, (&l, &u)) in x.iter_mut().zip(lower.iter().zip(upper)) {
        for bound in [l, u] {
            if (*v - bound).abs() <= rounding {
                *v = bound;
            }
        }
    }
}

/// Turns marginals into 0 that are nothing else beside the others.
pub fn quiet(marginals: &mut [f64]) {
    let rounding = MULTIPLIERS * largest(marginals);
    for v in marginals.iter_mut().filter(|v| v.abs() <= rounding) {
        *v = 0.0;
    }
}
