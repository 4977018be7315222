//! Programs whose equations leave nothing to choose: Newton's method on the equations.
//!
//! A general equilibrium that is written as a nonlinear program has as many equations as variables, or more where some
//! of them follow from others; the objective only names one of its results. An interior point refuses more equations
//! than variables, and dependent ones make it stumble. Here the step d is that of Levenberg and Marquardt,
//!
//! ```text
//!     min  |J d + r|² + δ |d|²     ⟺     ⎡ δI  Jᵀ ⎤ ⎡ d ⎤   ⎡  0 ⎤
//!                                        ⎣ J   −I ⎦ ⎣ y ⎦ = ⎣ −r ⎦
//! ```
//!
//! on the free variables, with the residuals r of the equations and of the inequalities that are violated, columns in units of
//! max(1, |xⱼ|) and rows in units of their largest entry. It has one solution whatever the rank of J; where the equations agree with
//! each other convergence is quadratic, as δ falls with |r|². Variables at a bound that the step would leave stay there. The
//! multipliers are those of least |∇f + Jᵀλ|. (Nocedal & Wright, Numerical Optimization, 2006, chapter 10.)

use super::polish::number;
use super::problem::{Entry, Nlp};
use super::symmetric::{Lower, Symmetric};

/// Steps at most.
const STEPS: u64 = 50;
/// δ at a residual of 1.
const DAMPING: f64 = 1e-8;
/// δ never falls below this, which makes a system with dependent columns, and that of the multipliers, regular.
const LEAST_DAMPING: f64 = 1e-14;
/// A step is halved so often.
const HALVINGS: u32 = 12;
/// The residual, in its units, that is rounding.
const EXACT: f64 = 1e-14;

/// Where it ended.
#[derive(Debug)]
pub(super) struct Run {
    /// Point.
    pub x: Vec<f64>,
    /// Multipliers λ of the constraints, L = f + λᵀg.
    pub lambda: Vec<f64>,
    /// Steps.
    pub steps: u64,
}

/// Runs from the start point until told to stop, by the number of evaluations that failed. None where the start has no values
/// or derivatives.
pub(super) fn solve(nlp: &mut dyn Nlp, stop: &mut dyn FnMut(u64) -> bool) -> Option<Run> {
    let mut x = nlp.start().to_vec();
    let mut here = System::at(nlp, &x)?;
    let mut steps = 0;
    while steps < STEPS && here.size > EXACT && !stop(nlp.failures()) {
        steps += 1;
        let Some(d) = here.step(nlp, &x) else { break };
        let Some((next, there)) = shortened(nlp, &x, &d, &here) else {
            break;
        };
        (x, here) = (next, there);
    }
    let lambda = here.multipliers(nlp, &x)?;
    Some(Run { x, lambda, steps })
}

/// The first point along the step, halved again and again, where the residual is less.
fn shortened(nlp: &mut dyn Nlp, x: &[f64], d: &[f64], here: &System) -> Option<(Vec<f64>, System)> {
    let mut length = 1.0;
    for _ in 0..HALVINGS {
        let next = moved(nlp, x, d, length);
        let residual = residuals(nlp, &next).map(|r| here.norm(&r));
        if residual.is_some_and(|r| r < (1.0 - 1e-4 * length) * here.norm(&here.residual))
            && let Some(there) = System::at(nlp, &next)
        {
            return Some((next, there));
        }
        length *= 0.5;
    }
    None
}

/// x + t d, put into the bounds.
fn moved(nlp: &dyn Nlp, x: &[f64], d: &[f64], t: f64) -> Vec<f64> {
    let (lower, upper) = nlp.bounds();
    let all = x.iter().zip(d).zip(lower.iter().zip(upper));
    all.map(|((x, d), (&l, &u))| (x + t * d).max(l).min(u))
        .collect()
}

/// What the constraints are violated by: positive above, negative below.
fn residuals(nlp: &mut dyn Nlp, x: &[f64]) -> Option<Vec<f64>> {
    let mut g = vec![0.0; nlp.size().1];
    nlp.constraints(x, &mut g)?;
    let (a, b) = nlp.sides();
    for (g, (&a, &b)) in g.iter_mut().zip(a.iter().zip(b)) {
        *g -= g.max(a).min(b);
    }
    g.iter().all(|r| r.is_finite()).then_some(g)
}

/// The equations at a point.
struct System {
    /// Jacobian in the units of rows and columns.
    jacobian: Vec<Entry>,
    residual: Vec<f64>,
    row_unit: Vec<f64>,
    column_unit: Vec<f64>,
    /// Largest residual in its units.
    size: f64,
}

impl System {
    fn at(nlp: &mut dyn Nlp, x: &[f64]) -> Option<Self> {
        let residual = residuals(nlp, x)?;
        let mut jacobian = nlp.jacobian_entries(x)?;
        let column_unit: Vec<f64> = x.iter().map(|x| x.abs().max(1.0)).collect();
        let mut row_unit = vec![0.0_f64; residual.len()];
        for (i, j, a) in &mut jacobian {
            if !a.is_finite() {
                return None;
            }
            *a *= column_unit[*j];
            row_unit[*i] = row_unit[*i].max(a.abs());
        }
        row_unit
            .iter_mut()
            .filter(|u| **u == 0.0)
            .for_each(|u| *u = 1.0);
        for (i, _, a) in &mut jacobian {
            *a /= row_unit[*i];
        }
        let mut system = Self {
            jacobian,
            residual,
            row_unit,
            column_unit,
            size: 0.0,
        };
        system.size = system
            .scaled(&system.residual)
            .fold(0.0, |s, r| s.max(r.abs()));
        Some(system)
    }

    fn scaled<'s>(&'s self, residual: &'s [f64]) -> impl Iterator<Item = f64> {
        residual.iter().zip(&self.row_unit).map(|(r, u)| r / u)
    }

    fn norm(&self, residual: &[f64]) -> f64 {
        self.scaled(residual).map(|r| r * r).sum::<f64>().sqrt()
    }

    /// The step, none of it out of the bounds that the point is at.
    fn step(&self, nlp: &dyn Nlp, x: &[f64]) -> Option<Vec<f64>> {
        let (lower, upper) = nlp.bounds();
        let (a, b) = nlp.sides();
        let counts = |i: usize| a[i] == b[i] || self.residual[i] != 0.0;
        let mut stays = vec![false; x.len()];
        let damping = (DAMPING * self.size * self.size).clamp(LEAST_DAMPING, DAMPING);
        loop {
            let right = |i: usize| -self.residual[i] / self.row_unit[i];
            let d = self
                .least_squares([damping, 1.0], &stays, counts, |_| 0.0, right)?
                .0;
            let leaves =
                |j: usize| d[j] < 0.0 && x[j] <= lower[j] || d[j] > 0.0 && x[j] >= upper[j];
            let out: Vec<usize> = (0..x.len()).filter(|&j| !stays[j] && leaves(j)).collect();
            if out.is_empty() {
                return Some(d);
            }
            out.into_iter().for_each(|j| stays[j] = true);
        }
    }

    /// Multipliers for which as little as possible of ∇f + Jᵀλ is left, variables at a bound aside.
    fn multipliers(&self, nlp: &mut dyn Nlp, x: &[f64]) -> Option<Vec<f64>> {
        let mut gradient = vec![0.0; x.len()];
        nlp.gradient(x, &mut gradient)?;
        let (lower, upper) = nlp.bounds();
        let all = x.iter().zip(lower.iter().zip(upper));
        let at_bound: Vec<bool> = all.map(|(x, (l, u))| x <= l || x >= u).collect();
        let (a, b) = nlp.sides();
        let left = |j: usize| -gradient[j] * self.column_unit[j];
        let diagonal = [1.0, LEAST_DAMPING];
        let y = self
            .least_squares(diagonal, &at_bound, |i| a[i] == b[i], left, |_| 0.0)?
            .1;
        Some(y.iter().zip(&self.row_unit).map(|(y, u)| y / u).collect())
    }

    /// Solves \[δI Jᵀ; J −γI\] for the variables that do not stay and the rows that count, in their units.
    fn least_squares(
        &self,
        [delta, gamma]: [f64; 2],
        stays: &[bool],
        counts: impl Fn(usize) -> bool,
        left: impl Fn(usize) -> f64,
        right: impl Fn(usize) -> f64,
    ) -> Option<(Vec<f64>, Vec<f64>)> {
        let (n, m) = (self.column_unit.len(), self.row_unit.len());
        let (columns, free) = number(|j| !stays[j], n);
        let (rows, kept) = number(counts, m);
        let mut matrix = Lower::default();
        let mut side = vec![0.0; free + kept];
        for (j, p) in columns
            .iter()
            .enumerate()
            .filter_map(|(j, p)| Some((j, (*p)?)))
        {
            matrix.push(p, p, delta);
            side[p] = left(j);
        }
        for (i, p) in rows
            .iter()
            .enumerate()
            .filter_map(|(i, p)| Some((i, (*p)?)))
        {
            matrix.push(free + p, free + p, -gamma);
            side[free + p] = right(i);
        }
        for &(i, j, a) in &self.jacobian {
            if let (Some(p), Some(q)) = (rows[i], columns[j]) {
                matrix.push(free + p, q, a);
            }
        }
        let s = Symmetric::new(free + kept, &matrix)?.solve(&side)?;
        let d = columns.iter().zip(&self.column_unit);
        let d = d.map(|(p, u)| p.map_or(0.0, |p| s[p] * u)).collect();
        let y = rows
            .iter()
            .map(|p| p.map_or(0.0, |p| s[free + p]))
            .collect();
        Some((d, y))
    }
}
