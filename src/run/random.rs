//! GAMS's random stream: Knuth's subtractive lagged-Fibonacci generator (lags 55 and 24, modulus
//! 10⁹; The Art of Computer Programming, vol. 2, section 3.6), and the distributions on top of it.

use crate::autodiff::special::log_gamma;
use crate::check::node::DataFunction;

const MODULUS: i64 = 1_000_000_000;

/// The generator.
#[derive(Clone, Debug)]
pub struct Random {
    a: [i64; 56],
    next: usize,
    last: i64,
    /// The second normal of a pair.
    kept: Option<f64>,
}

impl Default for Random {
    fn default() -> Self {
        Self::new(3141)
    }
}

impl Random {
    /// The stream of a seed (0 means the default, 3141).
    pub fn new(seed: i64) -> Self {
        let seed = if seed == 0 { 3141 } else { seed };
        let mut a = [0; 56];
        let modulo = |x: i64| x.rem_euclid(MODULUS);
        a[55] = modulo(seed);
        let (mut j, mut k) = (modulo(seed), 1);
        for i in 1..=54 {
            let ii = 21 * i % 55;
            a[ii] = k;
            k = modulo(j - k);
            j = a[ii];
        }
        let mut r = Self {
            a,
            next: 0,
            last: seed,
            kept: None,
        };
        for _ in 0..3 {
            r.batch();
        }
        r.next = 0;
        r
    }

    fn batch(&mut self) {
        for i in 1..=24 {
            self.a[i] = (self.a[i] - self.a[i + 31]).rem_euclid(MODULUS);
        }
        for i in 25..=55 {
            self.a[i] = (self.a[i] - self.a[i - 24]).rem_euclid(MODULUS);
        }
        self.next = 55;
    }

    fn integer(&mut self) -> i64 {
        if self.next == 0 {
            self.batch();
        }
        self.last = self.a[self.next];
        self.next -= 1;
        self.last
    }

    /// What `execseed` reads: the last integer, from which the stream starts anew.
    pub fn take_seed(&mut self) -> f64 {
        let last = self.last;
        *self = Self::new(last);
        last as f64
    }

    fn unit(&mut self) -> f64 {
        self.integer() as f64 * 1e-9
    }

    /// Uniform on (a, b).
    pub fn uniform(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.unit()
    }

    /// Uniform on the integers l … u.
    pub fn uniform_int(&mut self, l: f64, u: f64) -> f64 {
        l + ((u - l + 1.0) * self.unit()).floor()
    }

    /// Normal with mean and standard deviation: the polar method (Marsaglia).
    pub fn normal(&mut self, mean: f64, deviation: f64) -> f64 {
        if let Some(y) = self.kept.take() {
            return mean + deviation * y;
        }
        loop {
            let (x, y) = (2.0 * self.unit() - 1.0, 2.0 * self.unit() - 1.0);
            let q = x * x + y * y;
            if q > 0.0 && q < 1.0 {
                let f = (-2.0 * q.ln() / q).sqrt();
                self.kept = Some(y * f);
                return mean + deviation * x * f;
            }
        }
    }

    /// Density falling linearly from `low` (slope from low to high).
    pub fn linear(&mut self, low: f64, slope: f64, high: f64) -> f64 {
        // Density c + slope·x, by inversion. As in GAMS its total is 1 only where high − low is.
        let w = high - low;
        let c = 1.0 / w - slope / 2.0;
        let u = self.unit();
        if w == 0.0 {
            return low;
        }
        if slope == 0.0 {
            return low + w * u;
        }
        low + (-c + (c * c + 2.0 * slope * u).max(0.0).sqrt()) / slope
    }

    /// Triangular with mode `mid`.
    pub fn triangle(&mut self, low: f64, mid: f64, high: f64) -> f64 {
        let u = self.unit();
        if low == high {
            return low;
        }
        let split = (mid - low) / (high - low);
        if u < split {
            low + (u * (high - low) * (mid - low)).sqrt()
        } else {
            high - ((1.0 - u) * (high - low) * (high - mid)).sqrt()
        }
    }

    /// Exponential with a rate, by inversion.
    pub fn exponential(&mut self, rate: f64) -> f64 {
        -(1.0 - self.unit()).ln() / rate
    }

    /// Poisson with a mean: how many exponential waits fit into it.
    pub fn poisson(&mut self, mean: f64) -> f64 {
        let (mut count, mut time) = (0.0, self.exponential(1.0));
        while time < mean {
            count += 1.0;
            time += self.exponential(1.0);
        }
        count
    }

    /// Number of successes in `n` trials. As in GAMS by one number: from the most probable count down to 0, then up.
    pub fn binomial(&mut self, n: f64, p: f64) -> f64 {
        if p.min(1.0 - p) <= 1e-4 {
            return if p < 0.5 { 0.0 } else { n };
        }
        let odds = p / (1.0 - p);
        let mode = ((n + 1.0) * p).floor().min(n);
        let likely = (log_gamma(n + 1.0) - log_gamma(mode + 1.0) - log_gamma(n - mode + 1.0)
            + mode * p.ln()
            + (n - mode) * (1.0 - p).ln())
        .exp();
        let mut left = self.unit() - likely;
        let (mut k, mut here) = (mode, likely);
        while left >= 0.0 && k > 0.0 {
            here *= k / ((n - k + 1.0) * odds);
            k -= 1.0;
            left -= here;
        }
        if left < 0.0 {
            return k;
        }
        (k, here) = (mode, likely);
        while left >= 0.0 && k < n {
            here *= (n - k) * odds / (k + 1.0);
            k += 1.0;
            left -= here;
        }
        k
    }
}

/// Whether a function of data has a value at these arguments; why not.
pub(super) fn valid(f: DataFunction, a: &[f64]) -> Result<(), &'static str> {
    use DataFunction as D;
    let whole = |x: f64| x.fract() == 0.0;
    if a.iter().any(|x| x.is_nan()) {
        return Err("undf stands where a number is expected");
    }
    if a.iter().any(|x| x.is_infinite()) {
        return Err("the function does not take an infinite argument");
    }
    match (f, a) {
        (D::Uniform | D::UniformInt, [low, high]) if low > high => {
            Err("the lower end of the interval is above the upper one")
        }
        (D::UniformInt, [low, high]) if !(whole(*low) && whole(*high)) => {
            Err("the ends of the interval must be whole numbers")
        }
        (D::Normal, [_, deviation]) if *deviation < 0.0 => {
            Err("the standard deviation must not be negative")
        }
        (D::RandBinomial, [n, p])
            if !(whole(*n) && (1.0..1e9).contains(n) && (0.0..=1.0).contains(p)) =>
        {
            Err(
                "the number of trials must be a whole number between 1 and 1e9, the probability between 0 and 1",
            )
        }
        (D::RandTriangle, [low, mid, high]) if !(low <= mid && mid <= high) => {
            Err("the mode must be between the ends of the interval")
        }
        (D::RandExponential, [rate]) if *rate <= 0.0 => Err("the rate must be positive"),
        (D::RandPoisson, [mean]) if !(0.0..1e9).contains(mean) => {
            Err("the mean must be between 0 and 1e9")
        }
        (D::RandLinear, [low, slope, high]) if low > high || slope.abs() * (high - low) > 2.0 => {
            Err(
                "a linear density needs low <= high and a slope of at most 2/(high − low) either way",
            )
        }
        _ => Ok(()),
    }
}
