//! Programs without constraints but bounds, where factors of the Hessian would fill up: a trust region, and conjugate gradients in it.
//!
//! ```text
//!     min f(x)   over l ≤ x ≤ u
//! ```
//!
//! In each step the model f + gᵀs + ½ sᵀHs is first made smaller along the projected gradient, which says which bounds hold; on the
//! other variables conjugate gradients go on until the residual is a part of what it was, the trust region is left, or the
//! model curves downwards, which is then followed to the end of the region (Steihaug 1983; Lin & Moré, Newton's method for large
//! bound-constrained optimization problems, 1999). H is only multiplied: a step costs its nonzeros times the products, or, where even
//! its entries are dear, some gradients for each product.

use super::problem::{Entry, Problem};
use crate::solve::random::Random;
use crate::solve::vector::{clip, dot, largest, sum};
use crate::solve::{Budget, Progress};
use std::cell::Cell;

/// Steps at most, and products of one step by the number of variables.
const STEPS: u64 = 1000;
const MOST_PRODUCTS: usize = 2;
/// The slope that is none, in units of a variable.
const FLAT: f64 = 1e-9;
/// A promise below this, relative to the value, is rounding.
const ROUNDING: f64 = 1e-16;
/// A step is taken from this part of the promised decrease on.
const TAKEN: f64 = 1e-3;
/// The part of the slope that a first step must be worth.
const ENOUGH: f64 = 0.01;
/// How often a saddle is left, conjugate gradients that look for the way, and its first steps, relative to the size of the point.
const MOST_SADDLES: u32 = 3;
const LOOKS: usize = 60;
const FIRST_STEPS: [f64; 4] = [0.3, 0.1, 1e-2, 1e-3];
/// Curvature, relative to the largest, and a gain, relative to the value, that are rounding.
const STRAIGHT: f64 = 1e-6;
const NOTICEABLE: f64 = 1e-12;
/// A trust region this small is none.
const SMALLEST: f64 = 1e-12;

/// Where it ended.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) x: Vec<f64>,
    pub(super) steps: u64,
}

/// Runs from the start point. None where it has no value or derivatives. `products`: where the Hessian has no entries, how often it is
/// multiplied at most.
pub(super) fn solve(nlp: &mut Problem, products: Option<u64>, budget: &Budget) -> Option<Run> {
    let (lower, upper) = (nlp.bounds().0.to_vec(), nlp.bounds().1.to_vec());
    let bounds = (&lower[..], &upper[..]);
    let mut x = clipped(&nlp.start, bounds);
    let mut f = nlp.objective(&x).filter(|f| f.is_finite())?;
    let (mut steps, mut radius, mut saddles) = (0, 1.0_f64, 0);
    let mut model = Model::at(nlp, &x, products)?;
    while steps < STEPS
        && radius > SMALLEST
        && model.left.get() != Some(0)
        && budget.stop_after_failures(nlp.failure_count).is_none()
    {
        let slope = model.slope(bounds);
        budget.tell(Progress {
            method: "truncated Newton",
            iteration: steps,
            dual: Some(slope),
            ..Progress::default()
        });
        if slope <= FLAT {
            let on = match saddles < MOST_SADDLES {
                true => model.beyond(nlp, bounds, f),
                false => None,
            };
            let Some((next, value)) = on else { break };
            let Some(there) = Model::at(nlp, &next, model.left.get()) else {
                break;
            };
            (x, f, model) = (next, value, there);
            (radius, saddles) = (1.0, saddles + 1);
            continue;
        }
        steps += 1;
        let s = model.step(nlp, bounds, radius, budget);
        let promised = -model.change(nlp, &s);
        if promised <= ROUNDING * f.abs() {
            break;
        }
        let next = clipped(&sum(&x, 1.0, &s), bounds);
        let value = nlp.objective(&next).filter(|f| f.is_finite());
        let gain = value.map_or(-1.0, |v| (f - v) / promised);
        let length = model.length(&s);
        radius = match gain {
            0.75.. => radius.max(3.0 * length),
            0.25.. => radius,
            _ => 0.25 * length.min(radius),
        };
        if budget.wants_log() {
            budget.log(format!(
                "{steps:>6}  {f:>16.9e}  slope {slope:.2e}  length {length:.1e}  gain {gain:.2}"
            ));
        }
        if gain >= TAKEN
            && let (Some(v), Some(there)) = (value, Model::at(nlp, &next, model.left.get()))
        {
            (x, f, model) = (next, v, there);
        } else {
            radius = radius.min(0.25 * length);
        }
    }
    Some(Run { x, steps })
}

/// The quadratic model of f at a point.
struct Model {
    x: Vec<f64>,
    gradient: Vec<f64>,
    /// Lower triangle of the Hessian. None: the problem multiplies it.
    hessian: Option<Vec<Entry>>,
    /// Products that are left for that.
    left: Cell<Option<u64>>,
    /// What a variable is measured in.
    unit: Vec<f64>,
    /// Size of the diagonal, which conditions the gradients.
    diagonal: Vec<f64>,
}

impl Model {
    fn at(nlp: &mut Problem, x: &[f64], products: Option<u64>) -> Option<Self> {
        let mut gradient = vec![0.0; x.len()];
        nlp.gradient(x, &mut gradient)?;
        let hessian = match products {
            Some(_) => None,
            None => Some(nlp.hessian_entries(x, &[])?),
        };
        let mut diagonal = vec![0.0_f64; x.len()];
        for &(i, j, h) in hessian.iter().flatten() {
            if i == j {
                diagonal[i] += h;
            }
        }
        let size = largest(&diagonal);
        let least = if size > 0.0 { 1e-8 * size } else { 1.0 };
        diagonal.iter_mut().for_each(|d| *d = d.abs().max(least));
        let finite = gradient.iter().all(|g| g.is_finite()) && size.is_finite();
        finite.then(|| Self {
            x: x.to_vec(),
            gradient,
            hessian,
            left: Cell::new(products),
            unit: x.iter().map(|x| x.abs().max(1.0)).collect(),
            diagonal,
        })
    }

    /// H s.
    fn product(&self, nlp: &mut Problem, s: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; s.len()];
        let Some(hessian) = &self.hessian else {
            self.left.set(self.left.get().map(|l| l.saturating_sub(1)));
            return nlp.product(&self.x, s).unwrap_or(out);
        };
        for &(i, j, h) in hessian {
            out[i] += h * s[j];
            if i != j {
                out[j] += h * s[i];
            }
        }
        out
    }

    /// Change of the model.
    fn change(&self, nlp: &mut Problem, s: &[f64]) -> f64 {
        dot(&self.gradient, s) + 0.5 * dot(&self.product(nlp, s), s)
    }

    /// Length of a step in units.
    fn length(&self, s: &[f64]) -> f64 {
        let each = s.iter().zip(&self.unit).map(|(s, u)| (s / u).powi(2));
        each.sum::<f64>().sqrt()
    }

    /// The steepest way down that the bounds leave.
    fn slope(&self, (lower, upper): (&[f64], &[f64])) -> f64 {
        let x = &self.x;
        let each = self
            .gradient
            .iter()
            .enumerate()
            .map(|(j, &g)| match g > 0.0 {
                true => g.min(x[j] - lower[j]),
                false => (-g).min(upper[j] - x[j]),
            });
        each.fold(0.0, f64::max)
    }

    /// A step within the bounds that is worth as much as one along the projected gradient, and on from there by conjugate gradients.
    fn step(
        &self,
        nlp: &mut Problem,
        bounds: (&[f64], &[f64]),
        radius: f64,
        budget: &Budget,
    ) -> Vec<f64> {
        let x = &self.x;
        let direction: Vec<f64> = (self.gradient.iter().zip(&self.diagonal))
            .map(|(g, d)| -g / d)
            .collect();
        let along = |from: &[f64], d: &[f64], t: f64| {
            let there = clipped(&sum(&sum(x, 1.0, from), t, d), bounds);
            sum(&there, -1.0, x)
        };
        let zero = vec![0.0; x.len()];
        let (mut first, mut t) = (along(&zero, &direction, 1.0), 1.0);
        while t > 1e-20
            && (self.length(&first) > radius
                || self.change(nlp, &first) > ENOUGH * dot(&self.gradient, &first))
        {
            t *= 0.25;
            first = along(&zero, &direction, t);
        }
        let free: Vec<bool> = (0..x.len())
            .map(|j| {
                let y = x[j] + first[j];
                y > bounds.0[j] && y < bounds.1[j]
            })
            .collect();
        let on = self.conjugate(nlp, &first, &free, radius, budget);
        let here = self.change(nlp, &first);
        let mut t = 1.0;
        while t > 1e-3 {
            let s = along(&first, &on, t);
            if self.change(nlp, &s) < here {
                return s;
            }
            t *= 0.25;
        }
        first
    }

    /// From a step by conjugate gradients on the free variables, within the trust region: what is added to it.
    fn conjugate(
        &self,
        nlp: &mut Problem,
        first: &[f64],
        free: &[bool],
        radius: f64,
        budget: &Budget,
    ) -> Vec<f64> {
        let n = first.len();
        let masked = |v: &mut [f64]| {
            v.iter_mut()
                .zip(free)
                .filter(|(_, free)| !**free)
                .for_each(|(v, _)| *v = 0.0);
        };
        let conditioned =
            |r: &[f64]| -> Vec<f64> { r.iter().zip(&self.diagonal).map(|(r, d)| r / d).collect() };
        let mut residual = sum(&self.gradient, 1.0, &self.product(nlp, first));
        residual.iter_mut().for_each(|r| *r = -*r);
        masked(&mut residual);
        let begin = dot(&residual, &residual).sqrt();
        let until = begin * begin.sqrt().min(0.1);
        let mut z = conditioned(&residual);
        let (mut p, mut rz) = (z.clone(), dot(&residual, &z));
        let mut w = vec![0.0; n];
        for _ in 0..MOST_PRODUCTS * n {
            if dot(&residual, &residual).sqrt() <= until
                || budget.is_over()
                || self.left.get() == Some(0)
            {
                break;
            }
            let mut hp = self.product(nlp, &p);
            masked(&mut hp);
            let curvature = dot(&p, &hp);
            let t = rz / curvature;
            let next = sum(&w, t, &p);
            if curvature <= 0.0 || self.length(&sum(first, 1.0, &next)) > radius {
                let room = self.room(&sum(first, 1.0, &w), &p, radius);
                return sum(&w, room, &p);
            }
            w = next;
            residual = sum(&residual, -t, &hp);
            z = conditioned(&residual);
            let rz_next = dot(&residual, &z);
            p = sum(&z, rz_next / rz, &p);
            rz = rz_next;
        }
        w
    }

    /// From a point without slope: one where f is less along a direction in which it curves downwards.
    fn beyond(
        &self,
        nlp: &mut Problem,
        bounds: (&[f64], &[f64]),
        f: f64,
    ) -> Option<(Vec<f64>, f64)> {
        let d = self.downwards(nlp, bounds)?;
        let unit = largest(&self.x).max(1.0) / largest(&d);
        let ways = FIRST_STEPS.into_iter().flat_map(|t| [t, -t]);
        let mut ends = ways.filter_map(|t| {
            let y = clipped(&sum(&self.x, t * unit, &d), bounds);
            let value = nlp.objective(&y)?;
            (value < f - NOTICEABLE * f.abs().max(1.0)).then_some((y, value))
        });
        ends.next()
    }

    /// A direction of negative curvature in the variables that no slope holds at a bound, as conjugate gradients for any right-hand
    /// side come across one.
    fn downwards(&self, nlp: &mut Problem, (lower, upper): (&[f64], &[f64])) -> Option<Vec<f64>> {
        let held = |j: usize| {
            let at_bound = self.x[j] <= lower[j] || self.x[j] >= upper[j];
            at_bound && self.gradient[j].abs() > FLAT
        };
        let mut random = Random(1);
        let each = (0..self.x.len()).map(|j| match (random.uniform(), held(j)) {
            (_, true) => 0.0,
            (u, false) => u - 0.5,
        });
        let mut r: Vec<f64> = each.collect();
        let (mut p, mut rr, mut largest) = (r.clone(), dot(&r, &r), 0.0_f64);
        for _ in 0..LOOKS {
            let mut hp = self.product(nlp, &p);
            (0..hp.len()).filter(|&j| held(j)).for_each(|j| hp[j] = 0.0);
            let (curvature, pp) = (dot(&p, &hp), dot(&p, &p));
            largest = largest.max(curvature.abs() / pp);
            if curvature < -STRAIGHT * largest * pp {
                return Some(p);
            }
            if curvature <= STRAIGHT * STRAIGHT * largest * pp {
                break;
            }
            let t = rr / curvature;
            r = sum(&r, -t, &hp);
            let next = dot(&r, &r);
            p = sum(&r, next / rr, &p);
            rr = next;
        }
        None
    }

    /// How far a direction can be gone from a step within the trust region.
    fn room(&self, from: &[f64], d: &[f64], radius: f64) -> f64 {
        let (mut a, mut b, mut c) = (0.0, 0.0, -radius * radius);
        for ((s, d), u) in from.iter().zip(d).zip(&self.unit) {
            let (s, d) = (s / u, d / u);
            a += d * d;
            b += s * d;
            c += s * s;
        }
        match a > 0.0 {
            true => ((b * b - a * c).max(0.0).sqrt() - b).max(0.0) / a,
            false => 0.0,
        }
    }
}

fn clipped(x: &[f64], bounds: (&[f64], &[f64])) -> Vec<f64> {
    let mut x = x.to_vec();
    clip(&mut x, bounds);
    x
}
