//! The program at a point, in units: rows divided by their largest entry at the start, the objective by its largest slope.

use crate::solve::lp::form::Sparse;
use crate::solve::nlp::problem::{Entry, Problem};
use crate::solve::nlp::quadratic::by_rows;

/// Units of rows lie between these.
const UNITS: (f64, f64) = (1e-3, 1e12);
/// A row that is violated by less than this, relative to its size, is satisfied.
const MET: f64 = 1e-11;

/// What rounding may make of the sum of a row, relative to its largest term.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// What rows may miss where no point satisfies them all, relative to their size: half of what the certificate allows.
const FORGIVEN: f64 = 5e-7;

/// What stays the same from point to point.
pub(super) struct Frame {
    pub(super) n: usize,
    pub(super) m: usize,
    /// Bounds of the variables.
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    /// Sides of the rows, in units.
    pub(super) below: Vec<f64>,
    pub(super) above: Vec<f64>,
    /// What a row is divided by.
    pub(super) row_unit: Vec<f64>,
    /// What rounding makes of each row where the run is, in units.
    rounding: Vec<f64>,
    /// What the objective is divided by.
    pub(super) price: f64,
    /// Whether a variable has second derivatives.
    pub(super) nonlinear: Vec<bool>,
}

impl Frame {
    /// Units are those of the point, that of the objective with its curvature if wanted. None where it has no values or derivatives.
    pub(super) fn new(nlp: &mut Problem, x: &[f64], curved: bool) -> Option<Self> {
        let (n, m) = nlp.size();
        let size = |j: usize| x[j].abs().max(1.0);
        let mut row_unit = vec![0.0_f64; m];
        for (i, j, a) in nlp.jacobian_entries(x)? {
            row_unit[i] = row_unit[i].max((a * size(j)).abs());
        }
        let mut gradient = vec![0.0; n];
        nlp.gradient(x, &mut gradient)?;
        let mut steepest = (0..n).fold(0.0_f64, |s, j| s.max((gradient[j] * size(j)).abs()));
        if curved {
            steepest = steepest.max(curvature(nlp, x));
        }
        let unit = |u: f64, (low, high): (f64, f64)| match u > 0.0 && u.is_finite() {
            true => u.clamp(low, high),
            false => 1.0,
        };
        row_unit.iter_mut().for_each(|u| *u = unit(*u, UNITS));
        let ((lower, upper), (a, b)) = (nlp.bounds(), nlp.sides());
        let divided = |side: &[f64]| side.iter().zip(&row_unit).map(|(s, u)| s / u).collect();
        let mut nonlinear = vec![false; n];
        let (first, second) = nlp.hessian_pattern();
        for &j in first.iter().chain(second) {
            nonlinear[j as usize] = true;
        }
        Some(Self {
            n,
            m,
            lower: lower.to_vec(),
            upper: upper.to_vec(),
            below: divided(a),
            above: divided(b),
            rounding: vec![0.0; m],
            row_unit,
            price: unit(steepest, (1e-6, 1e15)),
            nonlinear,
        })
    }

    pub(super) fn clip(&self, x: &mut [f64]) {
        for (x, (&l, &u)) in x.iter_mut().zip(self.lower.iter().zip(&self.upper)) {
            *x = x.max(l).min(u);
        }
    }

    /// Shortens a step where it leaves the bounds.
    pub(super) fn keep_inside(&self, x: &[f64], d: &mut [f64]) {
        for (j, d) in d.iter_mut().enumerate() {
            *d = d.max(self.lower[j] - x[j]).min(self.upper[j] - x[j]);
        }
    }

    /// Multipliers of the program from those of the one in units.
    pub(super) fn multipliers(&self, lambda: &[f64]) -> Vec<f64> {
        let all = lambda.iter().zip(&self.row_unit);
        all.map(|(l, u)| l * self.price / u).collect()
    }

    /// The other way round.
    pub(super) fn in_units(&self, lambda: &[f64]) -> Vec<f64> {
        let all = lambda.iter().zip(&self.row_unit);
        all.map(|(l, u)| l * u / self.price).collect()
    }

    /// By how much a row with this value is violated: above 0 too low, below 0 too high, 0 within rounding.
    pub(super) fn missing(&self, i: usize, value: f64) -> f64 {
        let (a, b) = (self.below[i], self.above[i]);
        let missing = (a - value).max(0.0) - (value - b).max(0.0);
        let size = if missing > 0.0 { a.abs() } else { b.abs() };
        match missing.abs() <= (MET * size.max(1.0)).max(self.rounding[i]) {
            true => 0.0,
            false => missing,
        }
    }

    /// What differs by no more than rounding at this point holds: terms may have grown since the units were measured.
    pub(super) fn see_rounding(&mut self, at: &Point) {
        for (i, rounding) in self.rounding.iter_mut().enumerate() {
            let terms = at.rows.line(i).map(|(j, a)| (a * at.x[j]).abs());
            *rounding = ROUNDING * terms.fold(0.0, f64::max);
        }
    }

    pub(super) fn violation(&self, g: &[f64]) -> f64 {
        (0..self.m).map(|i| self.missing(i, g[i]).abs()).sum()
    }

    /// Makes rows of equations.
    pub(super) fn widen(&mut self, width: f64) {
        for i in (0..self.m).filter(|_| width > 0.0) {
            self.below[i] -= width;
            self.above[i] += width;
        }
    }

    /// Moves the sides of violated rows to these values, if all are as near as makes no difference to a person: rows
    /// that contradict each other by less than what they were rounded to.
    pub(super) fn forgive(&mut self, g: &[f64]) -> bool {
        let far = |i: usize| self.missing(i, g[i]).abs() > FORGIVEN * g[i].abs().max(1.0);
        if (0..self.m).any(far) {
            return false;
        }
        for (i, &level) in g.iter().enumerate().take(self.m) {
            let missing = self.missing(i, level);
            if missing != 0.0 && self.is_equation(i) {
                (self.below[i], self.above[i]) = (level, level);
            } else if missing > 0.0 {
                self.below[i] = level;
            } else if missing < 0.0 {
                self.above[i] = level;
            }
        }
        true
    }

    pub(super) fn is_equation(&self, i: usize) -> bool {
        self.below[i] == self.above[i]
    }
}

/// What second derivatives of the objective make of a step as long as its variables.
fn curvature(nlp: &mut Problem, x: &[f64]) -> f64 {
    let none = vec![0.0; nlp.size().1];
    let size = |j: usize| x[j].abs().max(1.0);
    let entries = nlp.hessian_entries(x, &none).unwrap_or_default();
    let each = entries.iter().filter(|e| e.2.is_finite());
    each.fold(0.0, |s, &(i, j, h)| s.max((h * size(i) * size(j)).abs()))
}

/// Values and first derivatives.
pub(super) struct Point {
    pub(super) x: Vec<f64>,
    pub(super) values: Values,
    pub(super) gradient: Vec<f64>,
    pub(super) rows: Sparse,
}

pub(super) struct Values {
    pub(super) f: f64,
    pub(super) g: Vec<f64>,
}

impl Values {
    pub(super) fn at(nlp: &mut Problem, frame: &Frame, x: &[f64]) -> Option<Self> {
        let f = nlp.objective(x)? / frame.price;
        let mut g = vec![0.0; frame.m];
        nlp.constraints(x, &mut g)?;
        g.iter_mut().zip(&frame.row_unit).for_each(|(g, u)| *g /= u);
        (f.is_finite() && g.iter().all(|v| v.is_finite())).then_some(Self { f, g })
    }
}

impl Point {
    pub(super) fn new(
        nlp: &mut Problem,
        frame: &Frame,
        x: Vec<f64>,
        values: Values,
    ) -> Option<Self> {
        let mut gradient = vec![0.0; frame.n];
        nlp.gradient(&x, &mut gradient)?;
        gradient.iter_mut().for_each(|g| *g /= frame.price);
        let mut entries = nlp.jacobian_entries(&x)?;
        for (i, _, a) in &mut entries {
            *a /= frame.row_unit[*i];
        }
        let rows = by_rows(frame.m, &entries);
        let mut all = gradient.iter().chain(&rows.value);
        all.all(|v| v.is_finite()).then_some(Self {
            x,
            values,
            gradient,
            rows,
        })
    }

    /// Lower triangle of the Hessian of the Lagrangian, its zeros too; nothing where it has no value.
    pub(super) fn hessian(&self, nlp: &mut Problem, frame: &Frame, lambda: &[f64]) -> Vec<Entry> {
        let lambda = frame.multipliers(lambda);
        let mut entries = nlp.hessian_entries(&self.x, &lambda).unwrap_or_default();
        entries.iter_mut().for_each(|e| e.2 /= frame.price);
        match entries.iter().all(|e| e.2.is_finite()) {
            true => entries,
            false => Vec::new(),
        }
    }

    /// J d.
    pub(super) fn along(&self, d: &[f64]) -> Vec<f64> {
        let line = |i| self.rows.line(i).map(|(j, a)| a * d[j]).sum();
        (0..self.values.g.len()).map(line).collect()
    }

    /// The unit of a variable.
    pub(super) fn unit(&self, j: usize) -> f64 {
        self.x[j].abs().max(1.0)
    }

    /// Length of a step: what it changes nonlinear variables by, in their units.
    pub(super) fn length(&self, frame: &Frame, d: &[f64]) -> f64 {
        let each = (0..frame.n).filter(|&j| frame.nonlinear[j]);
        each.map(|j| d[j].abs() / self.unit(j)).fold(0.0, f64::max)
    }

    /// Whether a row has become so flat that what it misses would not be seen in its unit.
    pub(super) fn is_flatter(&self, frame: &Frame, part: f64) -> bool {
        let steepest = |i: usize| {
            let entries = self.rows.line(i).map(|(j, a)| (a * self.unit(j)).abs());
            entries.fold(1.0 / frame.row_unit[i], f64::max)
        };
        (0..frame.m).any(|i| steepest(i) < part)
    }

    /// Whether the objective has become so flat that its slope would not be seen in its unit.
    pub(super) fn is_level(&self, nlp: &mut Problem, frame: &Frame, part: f64) -> bool {
        let slopes = self.gradient.iter().enumerate();
        slopes.fold(0.0_f64, |s, (j, g)| s.max((g * self.unit(j)).abs())) < part
            && curvature(nlp, &self.x) < part * frame.price
    }

    /// ∇f + Jᵀλ, and the largest term of each entry.
    fn reduced(&self, lambda: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut sum = self.gradient.clone();
        let mut size: Vec<f64> = sum.iter().map(|g| g.abs()).collect();
        for (i, &l) in lambda.iter().enumerate().filter(|l| *l.1 != 0.0) {
            for (j, a) in self.rows.line(i) {
                sum[j] += l * a;
                size[j] = size[j].max((l * a).abs());
            }
        }
        (sum, size)
    }

    /// What is left of the conditions of first order, relative to the terms they are made of.
    pub(super) fn residual(&self, frame: &Frame, lambda: &[f64]) -> f64 {
        let (sum, size) = self.reduced(lambda);
        let mut worst = 0.0_f64;
        for j in 0..frame.n {
            let (x, unit) = (self.x[j], self.unit(j));
            let room = match sum[j] > 0.0 {
                true => x - frame.lower[j],
                false => frame.upper[j] - x,
            };
            worst = worst.max((sum[j].abs() / size[j].max(1.0)).min(room / unit));
        }
        for (i, &l) in lambda.iter().enumerate() {
            let g = self.values.g[i];
            worst = worst.max(frame.missing(i, g).abs() / g.abs().max(1.0));
            let room = match l > 0.0 {
                true => frame.above[i] - g,
                false => g - frame.below[i],
            };
            if !frame.is_equation(i) {
                worst = worst.max(l.abs().min(room.max(0.0) / g.abs().max(1.0)));
            }
        }
        worst
    }
}
