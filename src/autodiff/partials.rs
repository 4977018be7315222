//! First and second partial derivatives of every function, by exact formulas.
//!
//! Functions with kinks or jumps (abs, min, floor, …) have the derivative of the piece the argument
//! lies in; at the kink of abs, sign and at a tie of min and max the mean of the two one-sided ones,
//! which is an element of the subdifferential.

use super::functions::{
    self as fun, CENTROPY_SHIFT, DomainError, ErrorKind, HUGE, Operation, in_smoothed_part,
    log_ratio, sigmoid, smoothed_abs, smoothing_base, smoothing_default,
};
use super::special;
use crate::model::instance::Function;
use Function as F;

/// Place of (i, j), i ≥ j, in a lower triangle packed by rows.
#[inline]
pub fn packed(i: usize, j: usize) -> usize {
    debug_assert!(i >= j);
    i * (i + 1) / 2 + j
}

/// Value, gradient and, if wanted, Hessian of `f` at `args`.
///
/// `gradient` has one entry per argument; `hessian` is the lower triangle packed by rows (see
/// [`packed`]) or empty. `active[i]` tells whether derivatives by argument i are wanted: a derivative
/// that does not exist is an error only where it is.
pub fn partials(
    f: Function,
    args: &[f64],
    active: &[bool],
    gradient: &mut [f64],
    hessian: &mut [f64],
) -> Result<f64, DomainError> {
    let value = fun::function_value(f, args)?;
    gradient.fill(0.0);
    hessian.fill(0.0);
    if args.iter().any(|a| !a.is_finite()) {
        return DomainError::fail(Operation::Call(f), args, 0, ErrorKind::Infinite);
    }
    match args.len() {
        1 if !matches!(f, F::EDist | F::LseMax | F::LseMin | F::Min | F::Max) => {
            let (d, dd) = unary(f, args[0], value);
            gradient[0] = d;
            if let Some(h) = hessian.first_mut() {
                *h = dd;
            }
        }
        _ => several(f, args, active, value, gradient, hessian),
    }
    check(f, args, active, gradient, hessian)?;
    Ok(value)
}

/// Reports a derivative that is wanted and not finite.
fn check(
    f: Function,
    args: &[f64],
    active: &[bool],
    gradient: &[f64],
    hessian: &[f64],
) -> Result<(), DomainError> {
    let curved = |i: usize, j: usize| hessian.is_empty() || hessian[packed(i, j)].is_finite();
    let exists =
        |i: usize| gradient[i].is_finite() && (0..=i).filter(|&j| active[j]).all(|j| curved(i, j));
    match (0..args.len()).find(|&i| active[i] && !exists(i)) {
        Some(i) => DomainError::fail(Operation::Call(f), args, i, ErrorKind::Derivative),
        None => Ok(()),
    }
}

/// First and second derivative of a function of one argument, given its value v.
pub(super) fn unary(f: Function, x: f64, v: f64) -> (f64, f64) {
    use std::f64::consts::{LN_2, LN_10, PI};
    match f {
        F::Exp => (v, v),
        F::Log | F::Log2 | F::Log10 => {
            let c = match f {
                F::Log => 1.0,
                F::Log2 => 1.0 / LN_2,
                _ => 1.0 / LN_10,
            };
            (c / x, -c / (x * x))
        }
        F::Sqrt => {
            let d = 0.5 / v;
            (d, -0.5 * d / x)
        }
        F::Sqr => (2.0 * x, 2.0),
        F::Sin => (x.cos(), -v),
        F::Cos => (-x.sin(), -v),
        F::Tan => {
            let d = 1.0 + v * v;
            (d, 2.0 * v * d)
        }
        F::ArcSin | F::ArcCos => {
            let q = (1.0 - x) * (1.0 + x);
            let d = 1.0 / q.sqrt();
            let s = if f == F::ArcSin { 1.0 } else { -1.0 };
            (s * d, s * x * d / q)
        }
        F::ArcTan => {
            let d = 1.0 / (1.0 + x * x);
            (d, -2.0 * x * d * d)
        }
        F::Sinh => (x.cosh().min(HUGE), v),
        F::Cosh => (x.sinh().clamp(-HUGE, HUGE), v),
        F::Tanh => {
            // 1 − tanh² cancels for large |x|; 1/cosh² does not
            let c = 1.0 / x.cosh();
            let d = c * c;
            (d, -2.0 * v * d)
        }
        F::ErrorF => {
            let d = (-0.5 * x * x).exp() / (2.0 * PI).sqrt();
            (d, -x * d)
        }
        F::Gamma => {
            let psi = special::digamma(x);
            (v * psi, v * (psi * psi + special::trigamma(x)))
        }
        F::LogGamma => (special::digamma(x), special::trigamma(x)),
        F::Entropy => (-(x.ln() + 1.0), -1.0 / x),
        F::Sigmoid => {
            let (p, q) = (v, sigmoid(-x));
            let d = p * q;
            // q − p = −tanh(x/2)
            (d, -d * (0.5 * x).tanh())
        }
        F::Logit => {
            let q = x * (1.0 - x);
            (1.0 / q, (2.0 * x - 1.0) / (q * q))
        }
        F::SlExp | F::SlLog10 | F::SlRec | F::SqExp | F::SqLog10 | F::SqRec => {
            let (mut g, mut h) = ([0.0; 2], [0.0; 3]);
            smoothed(f, x, smoothing_default(f), &mut g, &mut h);
            (g[0], h[0])
        }
        F::Abs if x == 0.0 => (0.0, 0.0),
        F::Abs => (x.signum(), 0.0),
        F::Frac => (1.0, 0.0),
        // one-argument min, max and sums, and the piecewise constant functions
        F::Min | F::Max => (1.0, 0.0),
        _ => (0.0, 0.0),
    }
}

fn several(f: Function, args: &[f64], active: &[bool], v: f64, g: &mut [f64], h: &mut [f64]) {
    let second = !h.is_empty();
    let x = args[0];
    let y = args.get(1).copied().unwrap_or(0.0);
    let z = args.get(2).copied().unwrap_or(0.0);
    match f {
        F::Power => {
            // y is a whole number by definition, and no variable
            let n = y.round() as i32;
            let nf = f64::from(n);
            let at = |k: i32| if nf == 0.0 { 0.0 } else { fun::powi(x, n - k) };
            g[0] = nf * at(1);
            g[1] = f64::NAN;
            if second {
                h[0] = if n == 1 { 0.0 } else { nf * (nf - 1.0) * at(2) };
            }
        }
        F::CvPower if x == 0.0 => {}
        F::RPower | F::VcPower | F::CvPower => power_partials(x, y, v, active, g, h),
        F::SignPower => {
            let s = if x < 0.0 { -1.0 } else { 1.0 };
            power_partials(x.abs(), y, v.abs(), active, g, h);
            g[1] *= s;
            if second {
                h[0] *= s;
                h[2] *= s;
            }
        }
        F::ArcTan2 => {
            // arguments (y, x) in the usual notation: r² = x² + y²
            let r = x.hypot(y);
            let (s, c) = (x / r, y / r);
            g[0] = c / r;
            g[1] = -s / r;
            if second {
                let r2 = 1.0 / (r * r);
                h[0] = -2.0 * s * c * r2;
                h[1] = (s - c) * (s + c) * r2;
                h[2] = 2.0 * s * c * r2;
            }
        }
        F::Beta | F::LogBeta => {
            let psi = special::digamma(x + y);
            let (a, b) = (special::digamma(x) - psi, special::digamma(y) - psi);
            (g[0], g[1]) = (a, b);
            if second {
                let psi1 = special::trigamma(x + y);
                h[0] = special::trigamma(x) - psi1;
                h[1] = -psi1;
                h[2] = special::trigamma(y) - psi1;
            }
            if f == F::Beta {
                exponential_of(v, g, h);
            }
        }
        F::Binomial => {
            let (n, k, m) = (x + 1.0, y + 1.0, x - y + 1.0);
            let psi = special::digamma(m);
            (g[0], g[1]) = (special::digamma(n) - psi, psi - special::digamma(k));
            if second {
                let psi1 = special::trigamma(m);
                h[0] = special::trigamma(n) - psi1;
                h[1] = psi1;
                h[2] = -special::trigamma(k) - psi1;
            }
            exponential_of(v, g, h);
        }
        F::BetaReg => beta_reg_partials(x, y, z, active, g, h),
        F::GammaReg => gamma_reg_partials(x, y, active, g, h),
        F::Centropy => {
            let shift = args.get(2).copied().unwrap_or(CENTROPY_SHIFT);
            let (p, q) = (x + shift, y + shift);
            g[0] = log_ratio(p, q) + x / p;
            g[1] = -x / q;
            if second {
                h[0] = (x + 2.0 * shift) / (p * p);
                h[1] = -1.0 / q;
                h[2] = x / (q * q);
            }
            if args.len() == 3 {
                g[2] = x / p - x / q;
                if second {
                    h[3] = shift / (p * p) - 1.0 / q;
                    h[4] = x / (q * q);
                    h[5] = x / (q * q) - x / (p * p);
                }
            }
        }
        F::Poly => {
            let (mut p, mut d, mut dd) = (0.0, 0.0, 0.0);
            for &a in args[1..].iter().rev() {
                dd = dd * x + 2.0 * d;
                d = d * x + p;
                p = p * x + a;
            }
            g[0] = d;
            let mut power = 1.0;
            for d in &mut g[1..] {
                *d = power;
                power *= x;
            }
            if second {
                h[0] = dd;
                let mut power = 1.0;
                for k in 2..args.len() {
                    h[packed(k, 0)] = (k - 1) as f64 * power;
                    power *= x;
                }
            }
        }
        F::SlExp | F::SlLog10 | F::SlRec | F::SqExp | F::SqLog10 | F::SqRec => {
            smoothed(f, x, y, g, h);
        }
        F::NcpCm => {
            let t = (x - y) / z;
            let (p, q) = (sigmoid(t), sigmoid(-t));
            g[0] = q;
            g[1] = p;
            // t σ(t) − log(1 + e^t), an even function of t
            let u = -t.abs();
            g[2] = u * sigmoid(u) - u.exp().ln_1p();
            if second {
                let w = p * q / z;
                h.copy_from_slice(&[-w, w, -w, w * t, -w * t, -w * t * t]);
            }
        }
        F::NcpF => {
            let r = x.hypot(y).hypot((2.0 * z).sqrt());
            // x/r − 1 cancels where x ≈ r
            let slope = |x: f64, y: f64| {
                if x > 0.0 {
                    -(y * y + 2.0 * z) / (r * (r + x))
                } else {
                    x / r - 1.0
                }
            };
            g[0] = slope(x, y);
            g[1] = slope(y, x);
            let with_mu = args.len() == 3;
            if with_mu {
                g[2] = 1.0 / r;
            }
            if second {
                let r3 = r * r * r;
                h[0] = (y * y + 2.0 * z) / r3;
                h[1] = -x * y / r3;
                h[2] = (x * x + 2.0 * z) / r3;
                if with_mu {
                    h[3] = -x / r3;
                    h[4] = -y / r3;
                    h[5] = -1.0 / r3;
                }
            }
        }
        F::NcpVuSin | F::NcpVuPow => {
            if (x - y).abs() >= z {
                let first = if x == y {
                    0.5
                } else {
                    f64::from(u8::from(x < y))
                };
                g[0] = first;
                g[1] = 1.0 - first;
            } else {
                let t = (x - y) / z;
                let (s, ds, dds) = smoothed_abs(f, t);
                g[0] = 0.5 * (1.0 - ds);
                g[1] = 0.5 * (1.0 + ds);
                let w = 0.5 * dds / z;
                if second {
                    h[..3].copy_from_slice(&[-w, w, -w]);
                }
                if args.len() == 3 {
                    g[2] = -0.5 * (s - t * ds);
                    if second {
                        h[3..6].copy_from_slice(&[w * t, -w * t, -w * t * t]);
                    }
                }
            }
        }
        F::EDist => {
            for (d, &a) in g.iter_mut().zip(args) {
                *d = a / v;
            }
            if second {
                for i in 0..args.len() {
                    for j in 0..i {
                        h[packed(i, j)] = -g[i] * g[j] / v;
                    }
                    // (v² − a²)/v³ without cancellation: the other squares
                    let others = args
                        .iter()
                        .enumerate()
                        .filter(|&(j, _)| j != i)
                        .fold(0.0_f64, |s, (_, &a)| s.hypot(a));
                    h[packed(i, i)] = (others / v) * (others / v) / v;
                }
            }
        }
        F::Div => quotient(y, v, g, h),
        F::Div0 if y.abs() > 1e-150 => quotient(y, v, g, h),
        F::LseMax | F::LseMin => {
            let s = if f == F::LseMax { 1.0 } else { -1.0 };
            softmax(args, s, g);
            if second {
                softmax_curvature(g, s, 0, h);
            }
        }
        F::LseMaxSc | F::LseMinSc => {
            let s = if f == F::LseMaxSc { 1.0 } else { -1.0 };
            softmax(&args[1..], s * x, &mut g[1..]);
            let weights = &g[1..];
            let mean: f64 = weights.iter().zip(&args[1..]).map(|(w, a)| w * a).sum();
            let by_t = (mean - v) / x;
            if second {
                softmax_curvature(weights, s * x, 1, h);
                let mut variance = 0.0;
                for (k, (&w, &a)) in weights.iter().zip(&args[1..]).enumerate() {
                    h[packed(k + 1, 0)] = s * w * (a - mean);
                    variance += w * (a - mean) * (a - mean);
                }
                h[0] = (s * variance - 2.0 * by_t) / x;
            }
            g[0] = by_t;
        }
        F::Min | F::Max => {
            let ties = args.iter().filter(|&&a| a == v).count().max(1) as f64;
            for (d, &a) in g.iter_mut().zip(args) {
                *d = if a == v { 1.0 / ties } else { 0.0 };
            }
        }
        // the number of decimals must be constant; the value is piecewise constant
        F::Mod => {
            g[0] = 1.0;
            g[1] = -(x / y).trunc();
        }
        F::IfThen => g[if x != 0.0 { 1 } else { 2 }] = 1.0,
        // piecewise constant
        _ => {}
    }
}

/// From the derivatives of log v to those of v.
fn exponential_of(v: f64, g: &mut [f64], h: &mut [f64]) {
    if !h.is_empty() {
        h[0] = v * (h[0] + g[0] * g[0]);
        h[1] = v * (h[1] + g[0] * g[1]);
        h[2] = v * (h[2] + g[1] * g[1]);
    }
    g[0] *= v;
    g[1] *= v;
}

/// Derivatives of `x ** y`, x ≥ 0. At x = 0 the limits from the right, where they exist.
pub(super) fn power_partials(
    x: f64,
    y: f64,
    v: f64,
    active: &[bool],
    g: &mut [f64],
    h: &mut [f64],
) {
    let second = !h.is_empty();
    if x == 0.0 {
        // 0 ** (y − k) · falling factorial: 0 above, the factorial at, infinite below
        let falling = |k: f64, factor: f64| {
            if factor == 0.0 || y > k {
                0.0
            } else if y == k {
                factor
            } else {
                f64::INFINITY
            }
        };
        g[0] = falling(1.0, y);
        g[1] = if y > 0.0 { 0.0 } else { f64::NEG_INFINITY };
        if second {
            h[0] = falling(2.0, y * (y - 1.0));
            h[1] = if y > 1.0 { 0.0 } else { f64::NEG_INFINITY };
            h[2] = if y > 0.0 { 0.0 } else { f64::INFINITY };
        }
        return;
    }
    let p = match v != 0.0 && v < HUGE {
        true => v / x,
        false => x.powf(y - 1.0),
    };
    g[0] = y * p;
    if second {
        h[0] = y * (y - 1.0) * (p / x);
    }
    if active[1] {
        let l = x.ln();
        g[1] = v * l;
        if second {
            h[1] = p * (1.0 + y * l);
            h[2] = v * l * l;
        }
    }
}

/// Derivatives of v = x / y.
fn quotient(y: f64, v: f64, g: &mut [f64], h: &mut [f64]) {
    let r = 1.0 / y;
    g[0] = r;
    g[1] = -v / y;
    if !h.is_empty() {
        h[1] = -r * r;
        h[2] = 2.0 * (v / y) / y;
    }
}

/// Derivatives of the smoothed functions by the argument and by the place where smoothing begins.
fn smoothed(f: Function, x: f64, place: f64, g: &mut [f64], h: &mut [f64]) {
    let second = !h.is_empty();
    if !in_smoothed_part(f, x, place) {
        let base = smoothing_base(f, x);
        g[0] = base[1];
        if second {
            h[0] = base[2];
        }
        return;
    }
    let b = smoothing_base(f, place);
    let d = x - place;
    let by_place = g.len() > 1;
    if matches!(f, F::SqExp | F::SqLog10 | F::SqRec) {
        g[0] = b[1] + b[2] * d;
        if by_place {
            g[1] = 0.5 * b[3] * d * d;
        }
        if second {
            h[0] = b[2];
            if by_place && h.len() > 2 {
                h[1] = b[3] * d;
                h[2] = 0.5 * b[4] * d * d - b[3] * d;
            }
        }
    } else {
        g[0] = b[1];
        if by_place {
            g[1] = b[2] * d;
        }
        if second && by_place && h.len() > 2 {
            h[1] = b[2];
            h[2] = b[3] * d - b[2];
        }
    }
}

fn softmax(args: &[f64], s: f64, out: &mut [f64]) {
    let m = args
        .iter()
        .map(|&a| s * a)
        .fold(f64::NEG_INFINITY, f64::max);
    let mut sum = 0.0;
    for (w, &a) in out.iter_mut().zip(args) {
        *w = (s * a - m).exp();
        sum += *w;
    }
    for w in out {
        *w /= sum;
    }
}

/// s · (diag(w) − w wᵀ), written from row and column `from` on.
fn softmax_curvature(w: &[f64], s: f64, from: usize, h: &mut [f64]) {
    for i in 0..w.len() {
        for j in 0..i {
            h[packed(i + from, j + from)] = -s * w[i] * w[j];
        }
        let others: f64 = w
            .iter()
            .enumerate()
            .filter(|&(j, _)| j != i)
            .map(|(_, w)| w)
            .sum();
        h[packed(i + from, i + from)] = s * w[i] * others;
    }
}

/// A density like x^(p−1) where x is 0; `one`: its value where p is 1.
fn at_edge(p: f64, one: f64) -> f64 {
    match p {
        _ if p > 1.0 => 0.0,
        1.0 => one,
        _ => f64::INFINITY,
    }
}

/// Its slope there, where p is 2 and where p is 1 these.
fn slope_at_edge(p: f64, two: f64, one: f64) -> f64 {
    match p {
        _ if p > 2.0 => 0.0,
        2.0 => two,
        1.0 => one,
        _ => f64::INFINITY,
    }
}

fn gamma_reg_partials(x: f64, a: f64, active: &[bool], g: &mut [f64], h: &mut [f64]) {
    // by x: x^(a−1) e^−x / Γ(a)
    let density = if x == 0.0 {
        at_edge(a, 1.0)
    } else {
        ((a - 1.0) * x.ln() - x - special::log_gamma(a)).exp()
    };
    g[0] = density;
    let second = !h.is_empty();
    if second {
        h[0] = if x == 0.0 {
            slope_at_edge(a, 1.0, -1.0)
        } else {
            density * ((a - 1.0) / x - 1.0)
        };
    }
    if active[1] {
        let jet = special::gamma_reg(a, x);
        g[1] = jet.d[0];
        if second {
            h[1] = if density == 0.0 {
                0.0
            } else {
                density * (x.ln() - special::digamma(a))
            };
            h[2] = jet.dd[0];
        }
    }
}

fn beta_reg_partials(x: f64, a: f64, b: f64, active: &[bool], g: &mut [f64], h: &mut [f64]) {
    let y = 1.0 - x;
    let second = !h.is_empty();
    // by x: x^(a−1) (1−x)^(b−1) / B(a, b)
    let log_density = (a - 1.0) * x.ln() + (b - 1.0) * (-x).ln_1p() - special::log_beta(a, b);
    let density = if x == 0.0 {
        at_edge(a, b)
    } else if y == 0.0 {
        at_edge(b, a)
    } else {
        log_density.exp()
    };
    g[0] = density;
    if second {
        h[0] = if x == 0.0 || y == 0.0 {
            let (p, q, s) = if x == 0.0 { (a, b, 1.0) } else { (b, a, -1.0) };
            slope_at_edge(p, s * q * (q + 1.0), -s * q * (q - 1.0))
        } else {
            density * ((a - 1.0) / x - (b - 1.0) / y)
        };
    }
    if active[1] || active[2] {
        let jet = special::beta_reg(x, a, b);
        (g[1], g[2]) = (jet.d[0], jet.d[1]);
        if second {
            let psi = special::digamma(a + b);
            let inside = density != 0.0;
            h[1] = if inside {
                density * (x.ln() - special::digamma(a) + psi)
            } else {
                0.0
            };
            h[3] = if inside {
                density * ((-x).ln_1p() - special::digamma(b) + psi)
            } else {
                0.0
            };
            (h[2], h[4], h[5]) = (jet.dd[0], jet.dd[1], jet.dd[2]);
        }
    }
}
