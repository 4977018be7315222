//! Sums in twice the working precision.
//!
//! A [`Sum`] keeps the rounding errors of additions (Knuth's two-sum) and of products (by fused
//! multiply-add) in a second number, so residuals of a point that is right to the last digit come
//! out right too. Source: Ogita, Rump & Oishi, "Accurate sum and dot product" (2005).

/// An unevaluated sum of two floating-point numbers.
#[derive(Clone, Copy, Default, Debug)]
pub struct Sum {
    high: f64,
    low: f64,
}

impl Sum {
    /// Starts at `x`.
    pub fn new(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }

    /// Adds `x`.
    #[inline]
    pub fn add(&mut self, x: f64) {
        let s = self.high + x;
        let t = s - self.high;
        self.low += (self.high - (s - t)) + (x - t);
        self.high = s;
    }

    /// Adds `a · b`.
    #[inline]
    pub fn add_product(&mut self, a: f64, b: f64) {
        let p = a * b;
        self.low += a.mul_add(b, -p);
        self.add(p);
    }

    /// The sum, rounded.
    #[inline]
    pub fn value(self) -> f64 {
        self.high + self.low
    }
}

#[cfg(test)]
mod tests {
    use super::Sum;

    #[test]
    fn keeps_what_plain_sums_lose() {
        let mut s = Sum::new(1e16);
        s.add(1.0);
        s.add(-1e16);
        assert_eq!(s.value(), 1.0);
        let mut s = Sum::default();
        let a = 1.0 + 2f64.powi(-30);
        s.add_product(a, a);
        s.add(-1.0);
        s.add(-2f64.powi(-29));
        assert_eq!(s.value(), 2f64.powi(-60));
    }
}
