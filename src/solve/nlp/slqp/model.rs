//! The quadratic model of φ, and how far it is worth going.

use super::equality::{Equality, Working};
use super::point::{Frame, Point};
use crate::solve::nlp::problem::Entry;

/// The quadratic model of φ.
#[derive(Clone, Copy)]
pub(super) struct Model<'a> {
    pub(super) frame: &'a Frame,
    pub(super) at: &'a Point,
    pub(super) hessian: &'a [Entry],
    pub(super) weight: f64,
}

impl Model<'_> {
    /// Change of φ along d.
    pub(super) fn change(&self, d: &[f64]) -> f64 {
        let slope: f64 = self.at.gradient.iter().zip(d).map(|(g, d)| g * d).sum();
        let twice = |&(i, j, h): &Entry| h * d[i] * d[j] * if i == j { 1.0 } else { 2.0 };
        let curvature: f64 = self.hessian.iter().map(twice).sum();
        let along = self.at.along(d);
        let violation = |i: usize| {
            let g = self.at.values.g[i];
            self.frame.missing(i, g + along[i]).abs() - self.frame.missing(i, g).abs()
        };
        let violation: f64 = (0..self.frame.m).map(violation).sum();
        slope + 0.5 * curvature + self.weight * violation
    }

    /// Along the solution of the linear program as far as this model falls: the step, and the part of that solution.
    pub(super) fn cauchy(&self, d: &[f64], radius: f64) -> (Vec<f64>, f64) {
        let linear = Model {
            hessian: &[],
            ..*self
        };
        let promise = linear.change(d);
        let mut part = match self.at.length(self.frame, d) {
            l if l > radius => radius / l,
            _ => 1.0,
        };
        let scaled = |t: f64| -> Vec<f64> { d.iter().map(|d| t * d).collect() };
        while part > 1e-12 && self.change(&scaled(part)) > 0.1 * part * promise {
            part *= 0.5;
        }
        (scaled(part), part)
    }

    /// From there towards the solution of the quadratic program on the working set: the step, and whether it gets there.
    pub(super) fn onwards(
        &self,
        cauchy: &[f64],
        q: &Equality,
        working: &Working,
        radius: f64,
    ) -> (Vec<f64>, bool) {
        let (mut d, mut full) = (cauchy.to_vec(), false);
        // where the model curves downwards beyond what the shift allows
        let reach = if q.shifted { 16.0 } else { 1.0 };
        let on = sum(&q.d, -1.0, cauchy);
        let far: Vec<f64> = on.iter().map(|v| reach * v).collect();
        let mut t = reach * self.longest(cauchy, &far, working, radius);
        let mut best = self.change(cauchy);
        for _ in 0..8 {
            let mut there = sum(cauchy, t, &on);
            self.frame.keep_inside(&self.at.x, &mut there);
            let change = self.change(&there);
            if change > best && d != cauchy {
                break;
            }
            if change <= best {
                full = t >= 1.0;
                (d, best) = (there, change);
                if !q.shifted {
                    break;
                }
            }
            t *= 0.5;
        }
        (d, full)
    }

    /// The part of a direction that can be gone from a step, within bounds, rows that do not hold already, and the trust region.
    pub(super) fn longest(
        &self,
        from: &[f64],
        direction: &[f64],
        working: &Working,
        radius: f64,
    ) -> f64 {
        let mut part = 1.0_f64;
        let mut meet = |room: f64, rate: f64| {
            if rate > 0.0 && room < rate * part {
                part = (room / rate).max(0.0);
            }
        };
        let frame = self.frame;
        for j in 0..frame.n {
            let (x, rate) = (self.at.x[j] + from[j], direction[j]);
            if working.column[j].is_none() {
                meet(frame.upper[j] - x, rate);
                meet(x - frame.lower[j], -rate);
            }
            if frame.nonlinear[j] {
                let most = radius * self.at.unit(j);
                meet(most - from[j], rate);
                meet(most + from[j], -rate);
            }
        }
        let (start, along) = (self.at.along(from), self.at.along(direction));
        for i in (0..frame.m).filter(|&i| working.row[i].is_none()) {
            let value = self.at.values.g[i] + start[i];
            let missing = frame.missing(i, value);
            if missing >= 0.0 {
                meet(frame.above[i] - value, along[i]);
            }
            if missing <= 0.0 {
                meet(value - frame.below[i], -along[i]);
            }
        }
        part
    }
}

/// a + t b
pub(super) fn sum(a: &[f64], t: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + t * b).collect()
}
