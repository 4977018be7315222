//! Sums, products and bounds of vectors.

/// The size of the largest entry.
pub(super) fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |t: f64, v| t.max(v.abs()))
}

/// aᵀb
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// a + t b
pub(super) fn sum(a: &[f64], t: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + t * b).collect()
}

/// Puts a point into bounds.
pub(super) fn clip(x: &mut [f64], (lower, upper): (&[f64], &[f64])) {
    for (x, (&l, &u)) in x.iter_mut().zip(lower.iter().zip(upper)) {
        *x = x.max(l).min(u);
    }
}
