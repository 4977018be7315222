//! Intervals with outward rounding, and sums of products in twice the working precision with a
//! proved error.
//!
//! An [`Interval`] holds every value that the exact computation can have. Rust has no directed
//! rounding, so each operation rounds to nearest, finds out by an error-free transformation
//! (Knuth's two-sum, products by fused multiply-add) on which side of the exact result it is, and
//! moves that end by one unit in the last place where it must. Near underflow, where the error of
//! a product is no floating-point number, the ends are always moved.
//!
//! Source: Ogita, Rump & Oishi, "Accurate sum and dot product" (2005); Rump, "Verification methods"
//! (2010), section 1 and 2.

use std::ops::{Add, Mul, Neg, Sub};

/// All numbers from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Below this the error of a product may not be a floating-point number.
const TINY: f64 = 1e-290;

/// `a + b` rounded, and the rounding error exactly.
#[inline]
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// The sum, rounded down and up.
#[inline]
fn add(a: f64, b: f64) -> (f64, f64) {
    let (s, e) = two_sum(a, b);
    if e == 0.0 || !s.is_finite() {
        (s, s)
    } else if e > 0.0 {
        (s, s.next_up())
    } else if e < 0.0 {
        (s.next_down(), s)
    } else {
        (f64::NEG_INFINITY, f64::INFINITY)
    }
}

/// The product, rounded down and up; 0 · ∞ = 0, as is right for bounds.
#[inline]
fn product(a: f64, b: f64) -> (f64, f64) {
    if a == 0.0 || b == 0.0 {
        return (0.0, 0.0);
    }
    let p = a * b;
    if p.is_infinite() {
        // Overflow of finite factors is not infinite.
        return match (a.is_finite() && b.is_finite(), p > 0.0) {
            (true, true) => (f64::MAX, p),
            (true, false) => (p, f64::MIN),
            _ => (p, p),
        };
    }
    let e = a.mul_add(b, -p);
    if p.abs() < TINY {
        (p.next_down(), p.next_up())
    } else if e > 0.0 {
        (p, p.next_up())
    } else if e < 0.0 {
        (p.next_down(), p)
    } else {
        (p, p)
    }
}

impl Interval {
    /// Everything.
    pub const ALL: Self = Self {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };

    /// One number.
    pub fn point(x: f64) -> Self {
        Self { low: x, high: x }
    }

    /// From −r to r.
    pub fn around_zero(r: f64) -> Self {
        Self { low: -r, high: r }
    }

    /// Largest magnitude.
    pub fn magnitude(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// A number near the middle.
    pub fn middle(self) -> f64 {
        0.5 * self.low + 0.5 * self.high
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let sum = Self {
            low: add(self.low, other.low).0,
            high: add(self.high, other.high).1,
        };
        // ∞ − ∞ says nothing.
        if sum.low.is_nan() || sum.high.is_nan() {
            Self::ALL
        } else {
            sum
        }
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
        }
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let ends = [
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ];
        Self {
            low: ends.iter().fold(f64::INFINITY, |t, e| t.min(e.0)),
            high: ends.iter().fold(f64::NEG_INFINITY, |t, e| t.max(e.1)),
        }
    }
}

impl Mul<f64> for Interval {
    type Output = Self;
    fn mul(self, k: f64) -> Self {
        self * Self::point(k)
    }
}

/// A sum of numbers and products: the rounded part without error, what it loses as an interval.
#[derive(Clone, Copy, Debug, Default)]
pub struct WideSum {
    high: f64,
    rest: Interval,
}

impl WideSum {
    /// Starts at `x`.
    pub fn new(x: f64) -> Self {
        Self {
            high: x,
            rest: Interval::default(),
        }
    }

    /// Adds a number.
    #[inline]
    pub fn add(&mut self, x: f64) {
        let (s, e) = two_sum(self.high, x);
        self.high = s;
        self.rest = self.rest + Interval::point(e);
    }

    /// Adds a · b.
    #[inline]
    pub fn add_product(&mut self, a: f64, b: f64) {
        let p = a * b;
        if p.abs() < TINY || !p.is_finite() {
            self.rest = self.rest + Interval::point(a) * Interval::point(b);
            return;
        }
        self.rest = self.rest + Interval::point(a.mul_add(b, -p));
        self.add(p);
    }

    /// Adds an interval.
    pub fn add_interval(&mut self, x: Interval) {
        self.rest = self.rest + x;
    }

    /// Holds the exact sum.
    pub fn value(self) -> Interval {
        Interval::point(self.high) + self.rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_the_exact_result() {
        let third = Interval {
            low: 1.0 / 3.0,
            high: (1.0f64 / 3.0).next_up(),
        };
        let one = third + third + third;
        assert!(one.low <= 1.0 && one.high >= 1.0 && one.low > 1.0 - 1e-15);
        let tenth = Interval::point(0.1) * Interval::point(0.1);
        assert!(tenth.low < tenth.high && tenth.high == tenth.low.next_up());
        assert_eq!(
            Interval::point(0.5) * Interval::point(3.0),
            Interval::point(1.5)
        );
        let square = Interval {
            low: -2.0,
            high: 3.0,
        } * Interval {
            low: -5.0,
            high: 1.0,
        };
        assert_eq!((square.low, square.high), (-15.0, 10.0));
        assert_eq!(Interval::ALL * 0.0, Interval::point(0.0));
        assert_eq!(Interval::ALL - Interval::ALL, Interval::ALL);
        let small = Interval::point(1e-200) * Interval::point(1e-200);
        assert!(small.low < 0.0 && small.high > 0.0);
        let large = Interval::point(1e200) * Interval::point(1e200);
        assert!(large.low == f64::MAX && large.high == f64::INFINITY);
    }

    #[test]
    fn wide_sums_keep_what_plain_sums_lose() {
        let mut s = WideSum::new(1e10);
        s.add_product(0.1, 10.0);
        s.add(-1e10);
        s.add(-1.0);
        // 10 times the double next to 0.1 is a little more than 1.
        let v = s.value();
        let exact = 0.1f64.mul_add(10.0, -1.0);
        assert!(v.low <= exact && exact <= v.high && v.high - v.low < 1e-30);
    }
}
