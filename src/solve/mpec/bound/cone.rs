//! Matrices with signs whose part in a tensor product of two spaces is given: by projections alone.
//!
//! With orthonormal P and Q, find Y with
//!
//! ```text
//!     Pᵀ Y Q = C,    every entry of Y in its range,    best for some separable objective .
//! ```
//!
//! These are the multipliers of all products of two linear systems ([`super::products`]), and for an ordinary linear
//! program they are too many: its factors fill up. But to project on either set is cheap, the first by four products of small
//! dense matrices. The Douglas–Rachford method needs no more, and converges linearly in the end on linear programs.
//!
//! Sources: Lions & Mercier (1979); Aspelmeier, Charitha & Luke (2016) for the rate.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par, Scale};

/// The two orthonormal bases.
pub(super) struct Space {
    /// P.
    pub p: Mat<f64>,
    /// Q.
    pub q: Mat<f64>,
}

impl Space {
    /// Pᵀ Y Q.
    pub(super) fn down(&self, y: &Mat<f64>) -> Mat<f64> {
        times(
            times(self.p.transpose(), y.as_ref()).as_ref(),
            self.q.as_ref(),
        )
    }

    /// P C Qᵀ.
    pub(super) fn up(&self, c: &Mat<f64>) -> Mat<f64> {
        times(
            times(self.p.as_ref(), c.as_ref()).as_ref(),
            self.q.transpose(),
        )
    }

    /// Y with its part in the space made C, by changes of the entries with a weight, least in its units. What cannot be
    /// reached stays, and what is left when `stop` says so.
    pub(super) fn corrected(
        &self,
        y: &Mat<f64>,
        c: &Mat<f64>,
        weight: &Mat<f64>,
        stop: &mut dyn FnMut() -> bool,
    ) -> Mat<f64> {
        let mut out = y.clone();
        let mut rest = c - self.down(&out);
        for _ in 0..PASSES {
            let more = self.conjugate(&rest, weight, stop);
            let next = &out + weighted(self.up(&more), weight);
            let left = c - self.down(&next);
            if left.norm_l2() > 0.5 * rest.norm_l2() {
                break;
            }
            (out, rest) = (next, left);
        }
        out
    }

    /// N with Pᵀ (W ∘ P N Qᵀ) Q = C to some digits, by conjugate gradients. Where W is 0 the equations are singular, and
    /// rounding errors dominate in the end: the best on the way counts.
    fn conjugate(
        &self,
        c: &Mat<f64>,
        weight: &Mat<f64>,
        stop: &mut dyn FnMut() -> bool,
    ) -> Mat<f64> {
        let mut sum = Mat::<f64>::zeros(c.nrows(), c.ncols());
        let mut rest = c.clone();
        let mut step = rest.clone();
        let mut size = rest.squared_norm_l2();
        let mut best = (size, sum.clone());
        let enough = DIGITS * size;
        for _ in 0..CORRECTIONS {
            if best.0 <= enough || size > DIVERGENCE * best.0 || stop() {
                break;
            }
            let image = self.down(&weighted(self.up(&step), weight));
            let curvature = inner(&step, &image);
            if curvature <= 0.0 {
                break;
            }
            let length = size / curvature;
            sum += Scale(length) * &step;
            rest -= Scale(length) * &image;
            let next = rest.squared_norm_l2();
            step = &rest + Scale(next / size) * &step;
            size = next;
            if size < best.0 {
                best = (size, sum.clone());
            }
        }
        best.1
    }
}

/// Steps of conjugate gradients at most, what of the residual's square is enough, what is too much after the best.
const CORRECTIONS: usize = 300;
const DIGITS: f64 = 1e-12;
const DIVERGENCE: f64 = 1e6;

/// How often they start again from the residual.
const PASSES: usize = 4;

fn times(a: MatRef<f64>, b: MatRef<f64>) -> Mat<f64> {
    let mut out = Mat::zeros(a.nrows(), b.ncols());
    matmul(&mut out, Accum::Replace, a, b, 1.0, Par::Seq);
    out
}

fn weighted(mut y: Mat<f64>, weight: &Mat<f64>) -> Mat<f64> {
    for l in 0..y.ncols() {
        let weights = weight.col_as_slice(l);
        let column = y.col_as_slice_mut(l).iter_mut();
        column.zip(weights).for_each(|(y, w)| *y *= w);
    }
    y
}

fn inner(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    let columns = (0..a.ncols()).map(|j| a.col(j).transpose() * b.col(j));
    columns.sum()
}

/// The method's state.
pub(super) struct Search<'s> {
    space: &'s Space,
    target: Mat<f64>,
    z: Mat<f64>,
    /// The last Y whose entries are as they should be.
    pub y: Mat<f64>,
    /// How far Y is from the space's equations, by its largest entry.
    pub distance: f64,
}

/// Over-relaxation.
const RELAX: f64 = 1.6;

impl<'s> Search<'s> {
    /// Begins at 0.
    pub(super) fn new(space: &'s Space, target: Mat<f64>) -> Self {
        let (m, n) = (space.p.nrows(), space.q.nrows());
        Self {
            space,
            target,
            z: Mat::zeros(m, n),
            y: Mat::zeros(m, n),
            distance: f64::INFINITY,
        }
    }

    /// One step; `nearest` gives for an entry's number (by columns) and a value y the least of its objective + ½(· − y)².
    pub(super) fn step(&mut self, nearest: impl Fn(usize, f64) -> f64) {
        let move_to = self.space.up(&(&self.target - self.space.down(&self.z)));
        let mut distance = 0.0f64;
        let mut number = 0;
        for l in 0..self.z.ncols() {
            let (z, y) = (self.z.col_as_slice_mut(l), self.y.col_as_slice_mut(l));
            for ((z, y), g) in z.iter_mut().zip(y).zip(move_to.col_as_slice(l)) {
                *y = nearest(number, *z + 2.0 * g);
                number += 1;
                let change = *y - *z - g;
                distance = distance.max(change.abs());
                *z += RELAX * change;
            }
        }
        self.distance = distance;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Y ≥ 0 of order 3 with the given sums of its columns, and as much in a corner as can be: what its column has.
    #[test]
    fn finds_the_best_entry_of_a_transport() {
        let third = 1.0 / 3.0f64.sqrt();
        let space = Space {
            p: Mat::from_fn(3, 1, |_, _| third),
            q: Mat::identity(3, 3),
        };
        let sums = [0.3, 0.5, 0.2];
        let target = Mat::from_fn(1, 3, |_, l| third * sums[l]);
        let mut search = Search::new(&space, target.clone());
        for _ in 0..2000 {
            search.step(|i, y| {
                if i == 0 {
                    (y + 1.0).max(0.0)
                } else {
                    y.max(0.0)
                }
            });
        }
        assert!(search.distance < 1e-12);
        assert!((search.y[(0, 0)] - 0.3).abs() < 1e-12);
        let one = Mat::from_fn(3, 3, |_, _| 1.0);
        let corrected = space.corrected(&Mat::zeros(3, 3), &target, &one, &mut || false);
        assert!((space.down(&corrected) - target).norm_l2() < 1e-14);
    }
}
