//! The elastic form: min f(x) + ρ Σ (p + q), a ≤ g(x) + p − q ≤ b, p, q ≥ 0.
//!
//! It always has feasible points, whatever the numbers of equations and variables and however
//! dependent they are. An exact penalty: where the elastic variables end at 0, x and the multipliers
//! (|λ| ≤ ρ) satisfy the conditions of the problem itself; where they do not, x is a point of local
//! infeasibility in the sum norm once ρ dominates f.

// Rows, bounds and slacks stand side by side.
#![allow(clippy::needless_range_loop)]

use super::interior_point::{Shared, lock};
use super::problem::Nlp;

/// A problem with elastic constraints.
pub struct Elastic {
    inner: Shared,
    n: usize,
    m: usize,
    rho: f64,
    bounds: (Vec<f64>, Vec<f64>),
    sides: (Vec<f64>, Vec<f64>),
    start: Vec<f64>,
    jacobian: (Vec<u32>, Vec<u32>),
    hessian: (Vec<u32>, Vec<u32>),
}

impl Elastic {
    /// Wraps a problem; the elastic variables start at the violations.
    pub fn new(inner: Shared, rho: f64) -> Self {
        let mut guard = lock(&inner);
        let (n, m) = guard.size();
        let x = guard.start().to_vec();
        let mut g = vec![0.0; m];
        let known = guard.constraints(&x, &mut g).is_some();
        let sides = (guard.sides().0.to_vec(), guard.sides().1.to_vec());
        let mut start = x;
        for i in 0..m {
            let short = if known {
                (sides.0[i] - g[i]).max(0.0)
            } else {
                1.0
            };
            start.push(short);
        }
        for i in 0..m {
            let long = if known {
                (g[i] - sides.1[i]).max(0.0)
            } else {
                1.0
            };
            start.push(long);
        }
        let mut bounds = (guard.bounds().0.to_vec(), guard.bounds().1.to_vec());
        bounds.0.resize(n + 2 * m, 0.0);
        bounds.1.resize(n + 2 * m, f64::INFINITY);
        let (jr, jc) = guard.jacobian_pattern();
        let mut jacobian = (jr.to_vec(), jc.to_vec());
        for k in 0..2 * m {
            jacobian.0.push((k % m) as u32);
            jacobian.1.push((n + k) as u32);
        }
        let (hr, hc) = guard.hessian_pattern();
        let hessian = (hr.to_vec(), hc.to_vec());
        drop(guard);
        Self {
            inner,
            n,
            m,
            rho,
            bounds,
            sides,
            start,
            jacobian,
            hessian,
        }
    }

    /// Number of variables of the problem itself.
    pub fn original_variables(&self) -> usize {
        self.n
    }
}

impl Nlp for Elastic {
    fn size(&self) -> (usize, usize) {
        (self.n + 2 * self.m, self.m)
    }

    fn bounds(&self) -> (&[f64], &[f64]) {
        (&self.bounds.0, &self.bounds.1)
    }

    fn sides(&self) -> (&[f64], &[f64]) {
        (&self.sides.0, &self.sides.1)
    }

    fn start(&self) -> &[f64] {
        &self.start
    }

    fn start_multipliers(&self) -> Option<&[f64]> {
        None
    }

    fn start_reduced(&self) -> Option<&[f64]> {
        None
    }

    fn jacobian_pattern(&self) -> (&[u32], &[u32]) {
        (&self.jacobian.0, &self.jacobian.1)
    }

    fn hessian_pattern(&self) -> (&[u32], &[u32]) {
        (&self.hessian.0, &self.hessian.1)
    }

    fn objective(&mut self, x: &[f64]) -> Option<f64> {
        let (x, slack) = x.split_at(self.n);
        let penalty = self.rho * slack.iter().sum::<f64>();
        let f = lock(&self.inner).objective(x)?;
        Some(f + penalty)
    }

    fn gradient(&mut self, x: &[f64], out: &mut [f64]) -> Option<()> {
        let (own, elastic) = out.split_at_mut(self.n);
        elastic.fill(self.rho);
        lock(&self.inner).gradient(&x[..self.n], own)?;
        Some(())
    }

    fn constraints(&mut self, x: &[f64], out: &mut [f64]) -> Option<()> {
        let (x, slack) = x.split_at(self.n);
        lock(&self.inner).constraints(x, out)?;
        for (i, v) in out.iter_mut().enumerate() {
            *v += slack[i] - slack[self.m + i];
        }
        Some(())
    }

    fn jacobian(&mut self, x: &[f64], out: &mut [f64]) -> Option<()> {
        let own = out.len() - 2 * self.m;
        lock(&self.inner).jacobian(&x[..self.n], &mut out[..own])?;
        out[own..own + self.m].fill(1.0);
        out[own + self.m..].fill(-1.0);
        Some(())
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, lambda: &[f64], out: &mut [f64]) -> Option<()> {
        lock(&self.inner).hessian(&x[..self.n], sigma, lambda, out)
    }

    fn failures(&self) -> u64 {
        lock(&self.inner).failures()
    }
}
