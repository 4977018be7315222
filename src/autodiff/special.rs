//! Special functions that the standard library lacks, with the parameter derivatives that exact
//! Hessians need.
//!
//! * ψ and ψ' (digamma, trigamma): recurrence into [1, 2] and a polynomial with the root of ψ
//!   split off, or recurrence upwards and the asymptotic series
//!   (Abramowitz & Stegun 6.3.18, 6.4.12); reflection for negative arguments.
//! * log B(a, b): Stirling differences where plain log Γ would cancel (Didonato & Morris,
//!   TOMS 708).
//! * regularised incomplete gamma P(a, x) and beta I_x(a, b): power series and continued fraction
//!   (A&S 6.5.29, 6.5.31, 26.5.8), carried out on second-order [`Jet`]s in the parameters, so the
//!   derivatives with respect to a and b are those of the same convergent expansion.

use std::f64::consts::PI;

/// Γ(x). Whole numbers up to 171 come from a table of factorials, exact where f64 is.
pub fn gamma(x: f64) -> f64 {
    if x == x.trunc() && (1.0..=171.0).contains(&x) {
        return factorial(x as u32 - 1);
    }
    libm::tgamma(x)
}

/// n! for n ≤ 170.
pub fn factorial(n: u32) -> f64 {
    // Two-term products keep the rounding of large factorials to one unit in the last place.
    let (mut hi, mut lo) = (1.0_f64, 0.0_f64);
    for k in 2..=n {
        let k = f64::from(k);
        let p = hi * k;
        let e = hi.mul_add(k, -p) + lo * k;
        hi = p + e;
        lo = e - (hi - p);
    }
    hi
}

/// log Γ(x) for x > 0.
pub fn log_gamma(x: f64) -> f64 {
    libm::lgamma(x)
}

/// Standard normal distribution function Φ(x).
pub fn normal_cdf(x: f64) -> f64 {
    // erfc amplifies the rounding of x/√2 by x²: the second term restores the lost part.
    let h = -x * std::f64::consts::FRAC_1_SQRT_2;
    // 1/√2 = FRAC_1_SQRT_2 + δ
    const DELTA: f64 = -4.833_646_656_726_457e-17;
    let lost = (-x).mul_add(std::f64::consts::FRAC_1_SQRT_2, -h) - x * DELTA;
    let slope = -(2.0 / PI.sqrt()) * (-h * h).exp();
    0.5 * (libm::erfc(h) + slope * lost)
}

/// ψ(x) = Γ'(x)/Γ(x).
pub fn digamma(x: f64) -> f64 {
    if x <= 0.0 {
        // ψ(x) = ψ(1 − x) − π/tan(πx)
        return digamma(1.0 - x) - PI / tan_pi(x);
    }
    if x >= 10.0 {
        let r = 1.0 / (x * x);
        // Bernoulli numbers B_2k / 2k
        const C: [f64; 8] = [
            1.0 / 12.0,
            -1.0 / 120.0,
            1.0 / 252.0,
            -1.0 / 240.0,
            1.0 / 132.0,
            -691.0 / 32760.0,
            1.0 / 12.0,
            -3617.0 / 8160.0,
        ];
        let series = C.iter().rev().fold(0.0, |s, c| s * r + c) * r;
        return x.ln() - 0.5 / x - series;
    }
    let (mut x, mut shift) = (x, 0.0);
    while x > 2.0 {
        x -= 1.0;
        shift += 1.0 / x;
    }
    if x < 1.0 {
        shift -= 1.0 / x;
        x += 1.0;
    }
    shift + digamma_1_2(x)
}

/// ψ on [1, 2] as (x − x₀)·q(x − 3/2): x₀ is the root of ψ in two parts, q a Chebyshev fit.
fn digamma_1_2(x: f64) -> f64 {
    const ROOT: f64 = 1.4616321449683622;
    const ROOT_REST: f64 = 9.549995429965697e-17;
    const Q: [f64; 24] = [
        0.9510558760318328,
        -0.42362742128146047,
        0.24054248424078736,
        -0.14840492305391761,
        0.09498872445283,
        -0.06192213327165706,
        0.04076083394462657,
        -0.02697579684427536,
        0.017907248195969127,
        -0.011908215172584002,
        0.007927024067961237,
        -0.00528001782089874,
        0.0035180800751066694,
        -0.002344650082351321,
        0.0015635679757533885,
        -0.001042261556504223,
        0.0006899717801166841,
        -0.0004599625144612576,
        0.0003268068044141764,
        -0.0002178682145501451,
        9.173383289174792e-05,
        -6.11554261750751e-05,
        0.00012230983055406747,
        -8.153978973309418e-05,
    ];
    let t = x - 1.5;
    let q = Q.iter().rev().fold(0.0, |s, c| s * t + c);
    ((x - ROOT) - ROOT_REST) * q
}

/// ψ'(x).
pub fn trigamma(x: f64) -> f64 {
    if x <= 0.0 {
        // ψ'(x) = −ψ'(1 − x) + (π/sin(πx))²
        let s = PI / sin_pi(x);
        return s * s - trigamma(1.0 - x);
    }
    let (mut x, mut shift) = (x, 0.0);
    while x < 15.0 {
        shift += 1.0 / (x * x);
        x += 1.0;
    }
    let r = 1.0 / (x * x);
    const B: [f64; 8] = [
        1.0 / 6.0,
        -1.0 / 30.0,
        1.0 / 42.0,
        -1.0 / 30.0,
        5.0 / 66.0,
        -691.0 / 2730.0,
        7.0 / 6.0,
        -3617.0 / 510.0,
    ];
    let series = B.iter().rev().fold(0.0, |s, b| s * r + b) * r;
    shift + (1.0 + 0.5 / x + series) / x
}

fn sin_pi(x: f64) -> f64 {
    let r = x - 2.0 * (0.5 * x).round();
    // |r| ≤ 1; the nearer of r and ±1 − r keeps the digits near whole numbers
    if r > 0.5 {
        (PI * (1.0 - r)).sin()
    } else if r < -0.5 {
        -(PI * (1.0 + r)).sin()
    } else {
        (PI * r).sin()
    }
}

fn tan_pi(x: f64) -> f64 {
    (PI * (x - x.round())).tan()
}

/// Stirling's remainder log Γ(x) − [(x − ½) log x − x + ½ log 2π], x ≥ 10.
fn stirling_remainder(x: f64) -> f64 {
    const C: [f64; 8] = [
        1.0 / 12.0,
        -1.0 / 360.0,
        1.0 / 1260.0,
        -1.0 / 1680.0,
        1.0 / 1188.0,
        -691.0 / 360_360.0,
        1.0 / 156.0,
        -3617.0 / 122_400.0,
    ];
    let r = 1.0 / (x * x);
    C.iter().rev().fold(0.0, |s, c| s * r + c) / x
}

/// log B(a, b) for a, b > 0.
pub fn log_beta(a: f64, b: f64) -> f64 {
    let (a, b) = if a <= b { (a, b) } else { (b, a) };
    if a <= 1e-150 {
        // B = (a + b)/(a b) · (1 + O(ab))
        return if b > 1e-10 {
            -a.ln()
        } else {
            (a + b).ln() - a.ln() - b.ln()
        };
    }
    if b < 10.0 {
        return beta(a, b).ln();
    }
    let correction = stirling_remainder(b) - stirling_remainder(a + b);
    let ratio = -(a + b - 0.5) * (a / b).ln_1p() + a - a * b.ln() + correction;
    if a < 10.0 {
        return log_gamma(a) + ratio;
    }
    // both large: B = √(2π) a^(a−½) b^(b−½) / (a+b)^(a+b−½) · e^corrections
    0.5 * (2.0 * PI / b).ln() - (a - 0.5) * (b / a).ln_1p() - b * (a / b).ln_1p()
        + correction
        + stirling_remainder(a)
}

/// B(a, b) for a, b > 0.
pub fn beta(a: f64, b: f64) -> f64 {
    if a + b < 160.0 && a > 1e-150 && b > 1e-150 {
        let (small, large) = if a <= b { (a, b) } else { (b, a) };
        return gamma(small) * (gamma(large) / gamma(a + b));
    }
    log_beta(a, b).exp()
}

/// Binomial coefficient Γ(n+1)/(Γ(k+1)Γ(n−k+1)) for n, k > −1, n − k > −1.
pub fn binomial(n: f64, k: f64) -> f64 {
    let k = k.min(n - k);
    if n == n.trunc() && k == k.trunc() && (0.0..=1e3).contains(&k) && n < 9e15 {
        // exact while the partial products are
        let mut v = 1.0;
        for i in 1..=(k as u32) {
            let i = f64::from(i);
            v = v * (n - k + i) / i;
            if v < 9e15 {
                v = v.round();
            }
        }
        return v;
    }
    if n < 160.0 {
        gamma(n + 1.0) / (gamma(k + 1.0) * gamma(n - k + 1.0))
    } else {
        (-log_beta(n - k + 1.0, k + 1.0)).exp() / (n + 1.0)
    }
}

/// A value with its first and second partial derivatives in two parameters (a, b).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Value.
    pub v: f64,
    /// ∂a, ∂b.
    pub d: [f64; 2],
    /// ∂aa, ∂ab, ∂bb.
    pub dd: [f64; 3],
}

impl Jet {
    const fn constant(v: f64) -> Self {
        Self::parameter(v, [0.0; 2])
    }

    /// A parameter itself: the first or the second.
    const fn parameter(v: f64, d: [f64; 2]) -> Self {
        Self { v, d, dd: [0.0; 3] }
    }

    fn chain(self, f: f64, df: f64, ddf: f64) -> Self {
        let [a, b] = self.d;
        Self {
            v: f,
            d: [df * a, df * b],
            dd: [
                df * self.dd[0] + ddf * a * a,
                df * self.dd[1] + ddf * a * b,
                df * self.dd[2] + ddf * b * b,
            ],
        }
    }

    fn exp(self) -> Self {
        let e = self.v.exp();
        self.chain(e, e, e)
    }

    fn recip(self) -> Self {
        let r = 1.0 / self.v;
        self.chain(r, -r * r, 2.0 * r * r * r)
    }

    fn scale(self, s: f64) -> Self {
        Self {
            v: self.v * s,
            d: self.d.map(|x| x * s),
            dd: self.dd.map(|x| x * s),
        }
    }

    /// 1 − self.
    fn complement(self) -> Self {
        let mut j = self.scale(-1.0);
        j.v += 1.0;
        j
    }

    /// The parameters exchanged.
    fn swap(self) -> Self {
        Self {
            v: self.v,
            d: [self.d[1], self.d[0]],
            dd: [self.dd[2], self.dd[1], self.dd[0]],
        }
    }

    /// Whether adding (or multiplying by 1 plus) `step` changes `self` no more.
    fn settled(self, step: Self) -> bool {
        let small = |s: f64, x: f64| s.abs() <= 1e-17 * x.abs() || s.abs() < 1e-290;
        small(step.v, self.v)
            && step.d.iter().zip(self.d).all(|(&s, x)| small(s, x))
            && step.dd.iter().zip(self.dd).all(|(&s, x)| small(s, x))
    }
}

impl std::ops::Add for Jet {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            v: self.v + o.v,
            d: std::array::from_fn(|i| self.d[i] + o.d[i]),
            dd: std::array::from_fn(|i| self.dd[i] + o.dd[i]),
        }
    }
}

impl std::ops::Mul for Jet {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let ([a, b], [p, q]) = (self.d, o.d);
        Self {
            v: self.v * o.v,
            d: [self.v * p + o.v * a, self.v * q + o.v * b],
            dd: [
                self.v * o.dd[0] + 2.0 * a * p + o.v * self.dd[0],
                self.v * o.dd[1] + a * q + b * p + o.v * self.dd[1],
                self.v * o.dd[2] + 2.0 * b * q + o.v * self.dd[2],
            ],
        }
    }
}

const MAX_TERMS: usize = 1_000_000;

/// Up to here the expansions of the incomplete gamma and beta function converge within the limit
/// (they take some multiple of √a terms).
pub const LARGEST_PARAMETER: f64 = 1e10;

/// P(a, x) with derivatives in a (first parameter), for x ≥ 0, a > 0.
pub fn gamma_reg(a: f64, x: f64) -> Jet {
    if x == 0.0 {
        return Jet::constant(0.0);
    }
    let lnx = x.ln();
    if x < a + 1.0 {
        // x^a e^−x / Γ(a+1) · Σ x^n / ((a+1)…(a+n))
        let front = Jet {
            v: a * lnx - x - log_gamma(a + 1.0),
            d: [lnx - digamma(a + 1.0), 0.0],
            dd: [-trigamma(a + 1.0), 0.0, 0.0],
        }
        .exp();
        let mut term = Jet::constant(1.0);
        let mut sum = term;
        for n in 1..MAX_TERMS {
            let shifted = Jet::parameter(a + n as f64, [1.0, 0.0]);
            term = term * shifted.recip().scale(x);
            sum = sum + term;
            if sum.settled(term) {
                break;
            }
        }
        return front * sum;
    }
    // 1 − x^a e^−x / Γ(a) · continued fraction (modified Lentz)
    let front = Jet {
        v: a * lnx - x - log_gamma(a),
        d: [lnx - digamma(a), 0.0],
        dd: [-trigamma(a), 0.0, 0.0],
    }
    .exp();
    let jet_a = Jet::parameter(a, [1.0, 0.0]);
    let mut b = jet_a.complement() + Jet::constant(x);
    let mut c = Jet::constant(1e280);
    let mut d = b.recip();
    let mut h = d;
    let mut rest = Settling::default();
    for i in 1..MAX_TERMS {
        let i = i as f64;
        let an = (Jet::constant(i) + jet_a.scale(-1.0)).scale(-i);
        b.v += 2.0;
        d = an * d + b;
        if d.v == 0.0 {
            d.v = 1e-280;
        }
        d = d.recip();
        // the first c is infinite: a_1/c_0 = 0
        c = if i == 1.0 { b } else { b + an * c.recip() };
        if c.v == 0.0 {
            c.v = 1e-280;
        }
        let next = h * (d * c);
        let done = rest.after(h, next);
        h = next;
        if done {
            break;
        }
    }
    (front * h).complement()
}

/// Watches a continued fraction: once its value stands still, the derivatives get a few more terms
/// (they converge at the same rate, a constant later, and may flicker in the last place for ever).
#[derive(Default)]
struct Settling {
    quiet: u32,
}

impl Settling {
    fn after(&mut self, old: Jet, new: Jet) -> bool {
        let small = |s: f64, x: f64| (s - x).abs() <= 4e-16 * x.abs() || x.abs() < 1e-290;
        if !small(old.v, new.v) {
            self.quiet = 0;
            return false;
        }
        self.quiet += 1;
        self.quiet > 40
            || (old.d.iter().zip(new.d).all(|(&s, x)| small(s, x))
                && old.dd.iter().zip(new.dd).all(|(&s, x)| small(s, x)))
    }
}

/// I_x(a, b) with derivatives in a and b, for 0 ≤ x ≤ 1, a, b > 0.
pub fn beta_reg(x: f64, a: f64, b: f64) -> Jet {
    if x <= 0.0 {
        return Jet::constant(0.0);
    }
    if x >= 1.0 {
        return Jet::constant(1.0);
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return beta_fraction(1.0 - x, x, b, a).swap().complement();
    }
    beta_fraction(x, 1.0 - x, a, b)
}

/// I_x(a, b) by the continued fraction; y = 1 − x.
fn beta_fraction(x: f64, y: f64, a: f64, b: f64) -> Jet {
    let ja = Jet::parameter(a, [1.0, 0.0]);
    let jb = Jet::parameter(b, [0.0, 1.0]);
    let lny = if x < 0.5 { (-x).ln_1p() } else { y.ln() };
    let (psi, psi1) = (digamma(a + b), trigamma(a + b));
    let front = Jet {
        v: a * x.ln() + b * lny - log_beta(a, b),
        d: [x.ln() - digamma(a) + psi, lny - digamma(b) + psi],
        dd: [-trigamma(a) + psi1, psi1, -trigamma(b) + psi1],
    }
    .exp()
        * ja.recip();
    let plus = |j: Jet, c: f64| j + Jet::constant(c);
    let sum = ja + jb;
    let mut c = Jet::constant(1.0);
    let mut d = (sum * plus(ja, 1.0).recip()).scale(-x);
    d.v += 1.0;
    let mut d = d.recip();
    let mut h = d;
    let mut rest = Settling::default();
    for m in 1..MAX_TERMS {
        let m = m as f64;
        let even =
            (plus(jb, -m) * (plus(ja, 2.0 * m - 1.0) * plus(ja, 2.0 * m)).recip()).scale(m * x);
        d = plus(even * d, 1.0).recip();
        c = plus(even * c.recip(), 1.0);
        h = h * (d * c);
        let odd =
            (plus(ja, m) * plus(sum, m) * (plus(ja, 2.0 * m) * plus(ja, 2.0 * m + 1.0)).recip())
                .scale(-x);
        d = plus(odd * d, 1.0).recip();
        c = plus(odd * c.recip(), 1.0);
        let next = h * (d * c);
        let done = rest.after(h, next);
        h = next;
        if done {
            break;
        }
    }
    front * h
}
