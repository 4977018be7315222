//! The path on which a part of the first residual is left, F(x) = t F(x₀), from t = 1 to 0 (Allgower & Georg, Introduction to Numerical
//! Continuation Methods, 2003): each of its systems is near to one that is solved, however ill-conditioned both are.
//!
//! It is followed by its length, in x and t together, for it may turn back on its way: that of a driven cavity with Reynolds number 4500 on a
//! grid of 71 × 71 comes to t = 0.57, goes back to 0.61, and leads to the end from there. Each stride goes along the tangent, and steps across
//! it, with one matrix, lead back to the path; where it may reach the end it is aimed there, and the matrix is new in each step: the first
//! stride, which is aimed at once, is Newton's method without any regard to residuals.

use super::newton::{Factors, LEAST_DAMPING, NEARLY, STEPS, System, moved, residuals};
use super::problem::Problem;
use super::symmetric::Symmetric;

/// Strides shorter than this, in units of the first step or of a variable, lead nowhere.
const SHORTEST: f64 = 1e-3;
/// A point is on the path where steps to it have become shorter by this; after fewer than so many the next stride is twice as long; steps at
/// most.
const CONTRACTED: f64 = 0.1;
const FEW: u64 = 3;
const MOST_CORRECTIONS: u64 = 8;
/// What the next stride is of one that failed.
const SHORTER: f64 = 0.4;

/// A point on the path, and the way on.
struct Path {
    x: Vec<f64>,
    /// t
    left: f64,
    /// The tangent in x and t; its length is 1.
    ahead: Vec<f64>,
    rate: f64,
}

/// The matrix at a point.
struct Matrix {
    here: System,
    factors: Factors,
    /// What x changes by with t where all residuals change with it.
    slope: Vec<f64>,
    /// What x is measured in beside t.
    unit: f64,
}

/// The end of the path from the start point, if it is reached, and how many matrices that took.
pub(super) fn end_of_path(
    nlp: &mut Problem,
    stop: &mut dyn FnMut(u64) -> bool,
) -> (Option<Vec<f64>>, u64) {
    let x = nlp.start.clone();
    let first = residuals(nlp, &x);
    let order = &mut None;
    let begin = first.and_then(|r| Some((Matrix::at(nlp, &x, (1.0, &r), 1.0, order)?, r)));
    let Some((begin, first)) = begin else {
        return (None, 1);
    };
    let unit = begin.here.length(&begin.slope).max(1.0);
    let mut path = Matrix { unit, ..begin }.onwards(x, 1.0, -1.0, order);
    let (mut stride, mut matrices) = (f64::INFINITY, 1);
    while path.left > 0.0 {
        if stop(nlp.failure_count) || stride < SHORTEST || matrices >= 2 * STEPS {
            return (None, matrices);
        }
        let aims = path.left + stride * path.rate <= 0.0;
        if aims {
            stride = -path.left / path.rate;
        }
        let (next, taken) = path.next(nlp, &first, (stride, aims), unit, order);
        matrices += taken;
        stride *= match next {
            Some((_, FEW..)) => 1.0,
            Some(_) => 2.0,
            None => SHORTER,
        };
        path = next.map_or(path, |n| n.0);
    }
    (Some(path.x), matrices)
}

impl Path {
    /// The point that a stride leads to and the steps across the path that it took, if it is found; and the number of matrices.
    fn next(
        &self,
        nlp: &mut Problem,
        first: &[f64],
        (stride, aims): (f64, bool),
        unit: f64,
        order: &mut Option<Symmetric>,
    ) -> (Option<(Self, u64)>, u64) {
        let mut x = moved(nlp, &self.x, &self.ahead, stride);
        let mut left = match aims {
            true => 0.0,
            false => self.left + stride * self.rate,
        };
        let (mut largest, mut last, mut matrices) = (0.0, f64::INFINITY, 0);
        let mut matrix = None;
        for taken in 0..MOST_CORRECTIONS {
            let known = match matrix.take() {
                Some(known) => Some(known),
                None => {
                    matrices += 1;
                    Matrix::at(nlp, &x, (left, first), unit, order)
                }
            };
            let step = known.and_then(|known| {
                let (d, rate) = known.step(nlp, &x, (left, first), self, aims)?;
                let length = known.product((&d, rate), (&d, rate)).sqrt();
                (length <= last).then_some((known, d, rate, length))
            });
            let Some((known, d, rate, length)) = step else {
                return (None, matrices);
            };
            (x, left) = (moved(nlp, &x, &d, 1.0), left + rate);
            (largest, last) = (length.max(largest), length);
            if length <= CONTRACTED * largest || length <= NEARLY {
                let sign = known.product((&self.ahead, self.rate), (&known.slope, 1.0));
                let on = known.onwards(x, left, sign.signum(), order);
                return (Some((on, taken)), matrices);
            }
            matrix = match aims {
                true => {
                    *order = known.factors.symmetric();
                    None
                }
                false => Some(known),
            };
        }
        (None, matrices)
    }
}

impl Matrix {
    /// At a point where a part of the first residual is to be left.
    fn at(
        nlp: &mut Problem,
        x: &[f64],
        (left, first): (f64, &[f64]),
        unit: f64,
        order: &mut Option<Symmetric>,
    ) -> Option<Self> {
        let mut here = System::at(nlp, x)?;
        let residual = here.residual.iter_mut().zip(first);
        residual.for_each(|(r, f)| *r -= left * f);
        let (_, factors) = here.step(nlp, x, LEAST_DAMPING, order)?;
        // a variable that stays at a bound leaves more equations than variables: no path
        factors.places.is_square().then_some(())?;
        let back = here.again(&factors, first)?;
        Some(Self {
            slope: back.into_iter().map(|d| -d).collect(),
            here,
            factors,
            unit,
        })
    }

    /// The inner product of two changes of x and t.
    fn product(&self, (d, rate): (&[f64], f64), (e, other): (&[f64], f64)) -> f64 {
        self.here.product(d, e) / self.unit.powi(2) + rate * other
    }

    /// The step across a path, or one that leaves t as it is.
    fn step(
        &self,
        nlp: &mut Problem,
        x: &[f64],
        (left, first): (f64, &[f64]),
        path: &Path,
        aims: bool,
    ) -> Option<(Vec<f64>, f64)> {
        let mut residual = residuals(nlp, x)?;
        let all = residual.iter_mut().zip(first);
        all.for_each(|(r, f)| *r -= left * f);
        let mut d = self.here.again(&self.factors, &residual)?;
        let mut rate = 0.0;
        if !aims {
            let along = (&path.ahead[..], path.rate);
            rate = -self.product(along, (&d, 0.0)) / self.product(along, (&self.slope, 1.0));
            let all = d.iter_mut().zip(&self.slope);
            all.for_each(|(d, s)| *d += rate * s);
        }
        Some((d, rate))
    }

    /// The path at this point, t growing with a positive sign.
    fn onwards(self, x: Vec<f64>, left: f64, sign: f64, order: &mut Option<Symmetric>) -> Path {
        let all = (&self.slope[..], 1.0);
        let rate = sign / self.product(all, all).sqrt();
        *order = self.factors.symmetric();
        Path {
            ahead: self.slope.iter().map(|s| rate * s).collect(),
            x,
            left,
            rate,
        }
    }
}
