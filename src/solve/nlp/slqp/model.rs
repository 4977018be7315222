//! The quadratic model of φ, and how far it is worth going.

use super::equality::{Equality, Met, Working};
use super::point::{Frame, Point};
use crate::solve::nlp::problem::Entry;
use crate::solve::vector::sum;

/// The quadratic model of φ.
#[derive(Clone, Copy)]
pub(super) struct Model<'a> {
    pub(super) frame: &'a Frame,
    pub(super) at: &'a Point,
    pub(super) hessian: &'a [Entry],
    pub(super) weight: f64,
}

/// Bounds and rows that are added to a working set at most.
const MOST_MET: u32 = 10;
/// What is met within this part of the way is met at once.
const AT_ONCE: f64 = 1e-6;

/// A step, and the working set that it ends on.
pub(super) struct Course {
    pub(super) d: Vec<f64>,
    /// It is the solution of the quadratic program.
    pub(super) full: bool,
    pub(super) working: Working,
    pub(super) quadratic: Option<Equality>,
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

    /// From the first step towards the solution of the quadratic program on the working set. Where a bound or a row is met on the
    /// way, it joins the set, as in an active-set method for quadratic programs (Nocedal & Wright 2006, 16.5): left to the
    /// next linear program, the same would be met again.
    pub(super) fn course(
        &self,
        cauchy: &[f64],
        quadratic: Option<Equality>,
        working: Working,
        radius: f64,
    ) -> Course {
        let (d, full) = match &quadratic {
            Some(q) => self.onwards(cauchy, q, &working, radius),
            None => (cauchy.to_vec(), false),
        };
        let mut course = Course {
            d,
            full,
            working,
            quadratic,
        };
        for _ in 0..MOST_MET {
            let Some(q) = course.quadratic.as_mut().filter(|_| !course.full) else {
                break;
            };
            let rest = sum(&q.d, -1.0, &course.d);
            let (part, met) = self.blocked(&course.d, &rest, &course.working, radius);
            let Some(met) = met.filter(|_| part <= AT_ONCE) else {
                break;
            };
            let Some(before) = q.join(self.at, met) else {
                break;
            };
            let mut working = course.working.clone();
            match met {
                Met::Column(j, bound) => working.column[j] = Some(bound),
                Met::Row(i, side) => working.row[i] = Some(side),
            }
            let (d, full) = self.onwards(&course.d, q, &working, radius);
            if self.change(&d) > self.change(&course.d) {
                q.leave(before);
                break;
            }
            (course.d, course.full, course.working) = (d, full, working);
        }
        course
    }

    /// From a step towards the solution of the quadratic program on the working set: the step, and whether it gets there.
    fn onwards(
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
        self.blocked(from, direction, working, radius).0
    }

    /// The same, and what is met there, if that is not the trust region.
    fn blocked(
        &self,
        from: &[f64],
        direction: &[f64],
        working: &Working,
        radius: f64,
    ) -> (f64, Option<Met>) {
        let (mut part, mut met) = (1.0_f64, None);
        let mut meet = |room: f64, rate: f64, what: Option<Met>| {
            if rate > 0.0 && room < rate * part {
                part = (room / rate).max(0.0);
                met = what;
            }
        };
        let frame = self.frame;
        for j in 0..frame.n {
            let (x, rate) = (self.at.x[j] + from[j], direction[j]);
            if working.column[j].is_none() {
                let (l, u) = (frame.lower[j], frame.upper[j]);
                meet(u - x, rate, Some(Met::Column(j, u)));
                meet(x - l, -rate, Some(Met::Column(j, l)));
            }
            if frame.nonlinear[j] {
                let most = radius * self.at.unit(j);
                meet(most - from[j], rate, None);
                meet(most + from[j], -rate, None);
            }
        }
        let (start, along) = (self.at.along(from), self.at.along(direction));
        for i in (0..frame.m).filter(|&i| working.row[i].is_none()) {
            let value = self.at.values.g[i] + start[i];
            let missing = frame.missing(i, value);
            if missing >= 0.0 {
                let side = frame.above[i];
                meet(side - value, along[i], Some(Met::Row(i, side)));
            }
            if missing <= 0.0 {
                let side = frame.below[i];
                meet(value - side, -along[i], Some(Met::Row(i, side)));
            }
        }
        (part, met)
    }
}
