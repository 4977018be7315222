//! Residuals and merit functions.
//!
//! *Natural residual* of the pair (x, F): x − mid(l, u, x − F). *Fischer–Burmeister*: with
//! φ(a, b) = a + b − √(a² + b²), zero exactly if a ≥ 0, b ≥ 0, ab = 0, the system Φ(x) = 0 with
//!
//! ```text
//! Φᵢ = F                          free
//!      φ(x − l, F)                lower bound only
//!      −φ(u − x, −F)              upper bound only
//!      φ(x − l, −φ(u − x, −F))    both
//! ```
//!
//! is equivalent to the problem (Billups 1995), and Ψ = ½‖Φ‖² is continuously differentiable.

use std::f64::consts::FRAC_1_SQRT_2;

/// max |x − mid(l, u, x − F)| and where it is attained. Not-a-number counts as infinite.
pub fn natural_residual(x: &[f64], f: &[f64], lower: &[f64], upper: &[f64]) -> (f64, usize) {
    let (mut worst, mut at) = (0.0, 0);
    for i in 0..x.len() {
        let r = natural(x[i], f[i], lower[i], upper[i]);
        let r = if r.is_nan() { f64::INFINITY } else { r };
        if r > worst {
            (worst, at) = (r, i);
        }
    }
    (worst, at)
}

/// |x − mid(l, u, x − F)| of one pair.
///
/// Written so that a large x does not swallow a small F: x − (x − F) is F.
fn natural(x: f64, f: f64, l: f64, u: f64) -> f64 {
    if x < l || x > u {
        // Outside the bounds: the distance to mid is at least the violation.
        return (x - (x - f).max(l).min(u)).abs();
    }
    if f >= 0.0 {
        f.min(x - l)
    } else if f < 0.0 {
        (-f).min(u - x)
    } else {
        f64::NAN
    }
}

/// φ(a, b) = a + b − √(a² + b²).
fn fischer_burmeister(a: f64, b: f64) -> f64 {
    let (sum, root) = (a + b, a.hypot(b));
    // a + b − √… cancels when both are positive and one is small.
    match sum > 0.0 {
        true => 2.0 * (a * b) / (sum + root),
        false => sum - root,
    }
}

/// An element of the generalised gradient of φ at (a, b).
fn slopes(a: f64, b: f64) -> (f64, f64) {
    let root = a.hypot(b);
    match root > 0.0 {
        true => (1.0 - a / root, 1.0 - b / root),
        // At the kink: the element in the direction (1, 1).
        false => (1.0 - FRAC_1_SQRT_2, 1.0 - FRAC_1_SQRT_2),
    }
}

/// Φᵢ of one pair.
pub(super) fn phi(x: f64, f: f64, l: f64, u: f64) -> f64 {
    match (l.is_finite(), u.is_finite()) {
        (false, false) => f,
        (true, false) => fischer_burmeister(x - l, f),
        (false, true) => -fischer_burmeister(u - x, -f),
        (true, true) => fischer_burmeister(x - l, -fischer_burmeister(u - x, -f)),
    }
}

/// (∂Φᵢ/∂xᵢ, ∂Φᵢ/∂Fᵢ): the entries of Da and Db in H = Da + Db·J.
pub(super) fn phi_slopes(x: f64, f: f64, l: f64, u: f64) -> (f64, f64) {
    match (l.is_finite(), u.is_finite()) {
        (false, false) => (0.0, 1.0),
        (true, false) => slopes(x - l, f),
        (false, true) => slopes(u - x, -f),
        (true, true) => {
            let inner = fischer_burmeister(u - x, -f);
            let (ia, ib) = slopes(u - x, -f);
            let (oa, ob) = slopes(x - l, -inner);
            (oa + ob * ia, ob * ib)
        }
    }
}

/// Ψ = ½‖Φ‖².
pub(super) fn merit(x: &[f64], f: &[f64], l: &[f64], u: &[f64]) -> f64 {
    let square = |i: usize| phi(x[i], f[i], l[i], u[i]).powi(2);
    0.5 * (0..x.len()).map(square).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    const INF: f64 = f64::INFINITY;

    #[test]
    fn all_residuals_vanish_at_solutions_and_only_there() {
        // (x, F, l, u, solves)
        let cases = [
            (0.0, 2.0, 0.0, INF, true),
            (3.0, 0.0, 0.0, INF, true),
            (0.0, -1.0, 0.0, INF, false),
            (1.0, 1.0, 0.0, INF, false),
            (5.0, -2.0, -INF, 5.0, true),
            (5.0, 2.0, -INF, 5.0, false),
            (1.0, -2.0, 0.0, 1.0, true),
            (0.5, 0.0, 0.0, 1.0, true),
            (0.5, 0.1, 0.0, 1.0, false),
            (7.0, 0.0, -INF, INF, true),
            (7.0, 1e-3, -INF, INF, false),
            (2.0, 0.0, 2.0, 2.0, true),
            (2.0, 9.0, 2.0, 2.0, true),
        ];
        for (x, f, l, u, solves) in cases {
            let natural = natural(x, f, l, u);
            let phi = phi(x, f, l, u);
            assert_eq!(
                natural < 1e-12,
                solves,
                "natural {natural} at {x} {f} {l} {u}"
            );
            assert_eq!(phi.abs() < 1e-12, solves, "phi {phi} at {x} {f} {l} {u}");
        }
    }

    #[test]
    fn a_violated_bound_counts() {
        assert_eq!(natural(-1.0, 0.0, 0.0, INF), 1.0);
        assert_eq!(natural(3.0, 0.0, 0.0, 2.0), 1.0);
        assert_eq!(natural_residual(&[0.0], &[f64::NAN], &[0.0], &[INF]).0, INF);
    }

    #[test]
    fn slopes_are_derivatives() {
        let points = [(0.3, 0.7), (2.0, -0.4), (-0.5, 0.2), (0.9, 1.5)];
        let bounds = [(-INF, INF), (0.0, INF), (-INF, 1.0), (0.0, 1.0)];
        for (x, f) in points {
            for (l, u) in bounds {
                let (dx, df) = phi_slopes(x, f, l, u);
                let h = 1e-6;
                let numeric = |a: f64, b: f64| (b - a) / (2.0 * h);
                let nx = numeric(phi(x - h, f, l, u), phi(x + h, f, l, u));
                let nf = numeric(phi(x, f - h, l, u), phi(x, f + h, l, u));
                assert!((dx - nx).abs() < 1e-6, "{x} {f} {l} {u}: {dx} {nx}");
                assert!((df - nf).abs() < 1e-6, "{x} {f} {l} {u}: {df} {nf}");
            }
        }
    }
}
