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
//! [`Phi`] adds the two variants the fallbacks use: penalised, λφ(a, b) + (1 − λ)a₊b₊ (Chen, Chen
//! and Kanzow), and smoothed, √(a² + b² + 2μ) in place of the root (Kanzow).

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

/// Which function of the Fischer–Burmeister family.
#[derive(Debug, Clone, Copy)]
pub(super) struct Phi {
    /// Weight λ of φ against the penalty a₊b₊; 1 is plain Fischer–Burmeister.
    pub(super) lambda: f64,
    /// Smoothing μ under the root; 0 is exact.
    pub(super) mu: f64,
}

impl Phi {
    /// The function the main method's merit is made of.
    pub(super) const PLAIN: Phi = Phi {
        lambda: 1.0,
        mu: 0.0,
    };

    /// φ(a, b).
    fn value(self, a: f64, b: f64) -> f64 {
        let root = if self.mu > 0.0 {
            (a * a + b * b + 2.0 * self.mu).sqrt()
        } else {
            a.hypot(b)
        };
        let s = a + b;
        // a + b − √… cancels when both are positive and one is small.
        let fb = if s > 0.0 {
            2.0 * (a * b - self.mu) / (s + root)
        } else {
            s - root
        };
        if self.lambda == 1.0 {
            fb
        } else {
            self.lambda * fb + (1.0 - self.lambda) * a.max(0.0) * b.max(0.0)
        }
    }

    /// An element of the generalised gradient of φ at (a, b).
    fn slopes(self, a: f64, b: f64) -> (f64, f64) {
        let root = if self.mu > 0.0 {
            (a * a + b * b + 2.0 * self.mu).sqrt()
        } else {
            a.hypot(b)
        };
        let (mut da, mut db) = if root > 0.0 {
            (1.0 - a / root, 1.0 - b / root)
        } else {
            // At the kink: the element in the direction (1, 1).
            (
                1.0 - std::f64::consts::FRAC_1_SQRT_2,
                1.0 - std::f64::consts::FRAC_1_SQRT_2,
            )
        };
        if self.lambda != 1.0 {
            da *= self.lambda;
            db *= self.lambda;
            if a > 0.0 && b > 0.0 {
                da += (1.0 - self.lambda) * b;
                db += (1.0 - self.lambda) * a;
            }
        }
        (da, db)
    }

    /// Φᵢ of one pair.
    pub(super) fn pair(self, x: f64, f: f64, l: f64, u: f64) -> f64 {
        match (l.is_finite(), u.is_finite()) {
            (false, false) => f,
            (true, false) => self.value(x - l, f),
            (false, true) => -self.value(u - x, -f),
            (true, true) => self.value(x - l, -self.value(u - x, -f)),
        }
    }

    /// (∂Φᵢ/∂xᵢ, ∂Φᵢ/∂Fᵢ): the entries of Da and Db in H = Da + Db·J.
    pub(super) fn pair_slopes(self, x: f64, f: f64, l: f64, u: f64) -> (f64, f64) {
        match (l.is_finite(), u.is_finite()) {
            (false, false) => (0.0, 1.0),
            (true, false) => self.slopes(x - l, f),
            (false, true) => self.slopes(u - x, -f),
            (true, true) => {
                let inner = self.value(u - x, -f);
                let (ia, ib) = self.slopes(u - x, -f);
                let (oa, ob) = self.slopes(x - l, -inner);
                (oa + ob * ia, ob * ib)
            }
        }
    }

    /// Ψ = ½‖Φ‖².
    pub(super) fn merit(self, x: &[f64], f: &[f64], l: &[f64], u: &[f64]) -> f64 {
        0.5 * (0..x.len())
            .map(|i| self.pair(x[i], f[i], l[i], u[i]).powi(2))
            .sum::<f64>()
    }
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
            let phi = Phi::PLAIN.pair(x, f, l, u);
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
        for phi in [
            Phi::PLAIN,
            Phi {
                lambda: 0.9,
                mu: 0.0,
            },
            Phi {
                lambda: 1.0,
                mu: 0.1,
            },
        ] {
            for (x, f) in points {
                for (l, u) in bounds {
                    let (dx, df) = phi.pair_slopes(x, f, l, u);
                    let h = 1e-6;
                    let numeric = |a: f64, b: f64| (b - a) / (2.0 * h);
                    let nx = numeric(phi.pair(x - h, f, l, u), phi.pair(x + h, f, l, u));
                    let nf = numeric(phi.pair(x, f - h, l, u), phi.pair(x, f + h, l, u));
                    assert!((dx - nx).abs() < 1e-6, "{phi:?} {x} {f} {l} {u}: {dx} {nx}");
                    assert!((df - nf).abs() < 1e-6, "{phi:?} {x} {f} {l} {u}: {df} {nf}");
                }
            }
        }
    }
}
