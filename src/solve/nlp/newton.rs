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
//!
//! A step that is too long is halved until the residual is less. Where that creeps, or ends, the method begins anew and follows the path on
//! which a part of the first residual is left ([`super::path`]). A path may lead nowhere: then steps with next to no damping are halved until
//! the next one with the same matrix is shorter. |J⁻¹r|, unlike |r|, does not depend on the units of the equations (Deuflhard, Newton Methods
//! for Nonlinear Problems, 2004, 3.3). A flowsheet of 87 equations is solved so.
//!
//! Where as many rows count as variables are free, and these are many, J itself is factorised: that takes a third of the time, without damping.

use super::path::end_of_path;
use super::problem::{Entry, Problem};
use super::symmetric::{Lower, Places, Symmetric};
use crate::solve::vector::{clip, sum};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Lu;
use faer::sparse::{SparseColMat, Triplet};

/// Steps at most, of each kind: to lessen the residual, or the next step, and half of those along the path.
pub(super) const STEPS: u64 = 50;
/// δ at a residual of 1.
const DAMPING: f64 = 1e-8;
/// δ never falls below this, which makes a system with dependent columns, and that of the multipliers, regular.
pub(super) const LEAST_DAMPING: f64 = 1e-14;
/// A step is halved so often.
const HALVINGS: u32 = 12;
/// The residual, in its units, that is rounding.
const EXACT: f64 = 1e-14;

/// A residual, in its units, at which the equations are all but satisfied.
pub(super) const NEARLY: f64 = 1e-9;
/// Steps that do not halve it.
const MOST_CREEPING: u64 = 10;

/// Variables from which on J is factorised, where rows and variables are as many; and nonzeros of JᵀJ, which bound its factors.
const MANY: usize = 500;
const MOST_NONZEROS: f64 = 2e8;
/// The part of variables and rows that counts from which on the other matrix has them all.
const MOST: f64 = 0.5;
/// What may be left of a right-hand side of ones.
const SOUND: f64 = 1e-6;

/// What is less at the end of a step.
#[derive(Clone, Copy, PartialEq)]
enum Less {
    /// The residual.
    Residual,
    /// The next step with the same matrix.
    NextStep,
}

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
pub(super) fn solve(nlp: &mut Problem, stop: &mut dyn FnMut(u64) -> bool) -> Option<Run> {
    let start = nlp.start.clone();
    let (mut end, mut steps) = iterate(nlp, start.clone(), Less::Residual, stop)?;
    let (a, b) = nlp.sides();
    let equations = a.iter().zip(b).filter(|(a, b)| a == b).count();
    if end.1.size > NEARLY && equations >= nlp.size().0 {
        let (x, taken) = end_of_path(nlp, stop);
        steps += taken;
        let others = [
            x.map(|x| (x, Less::Residual)),
            Some((start, Less::NextStep)),
        ];
        for (x, less) in others.into_iter().flatten() {
            let (other, taken) = iterate(nlp, x, less, stop)?;
            steps += taken;
            if other.1.size < end.1.size {
                end = other;
            }
            if end.1.size <= NEARLY {
                break;
            }
        }
    }
    let (x, there) = end;
    let lambda = there.multipliers(nlp, &x)?;
    Some(Run { x, lambda, steps })
}

/// Steps from a point while they lead on: the last point, and how many.
fn iterate(
    nlp: &mut Problem,
    mut x: Vec<f64>,
    less: Less,
    stop: &mut dyn FnMut(u64) -> bool,
) -> Option<((Vec<f64>, System), u64)> {
    let mut here = System::at(nlp, &x)?;
    let mut order = None;
    let (mut steps, mut halved) = (0, (0, here.size));
    while steps < STEPS && here.size > EXACT {
        let creeps = less == Less::Residual && steps - halved.0 >= MOST_CREEPING;
        if creeps || stop(nlp.failure_count) {
            break;
        }
        steps += 1;
        let damped = (DAMPING * here.size.min(1.0).powi(2)).max(LEAST_DAMPING);
        // Where columns are dependent, only damped steps lead on.
        let light = (less == Less::NextStep).then_some(LEAST_DAMPING);
        let next = light.into_iter().chain([damped]).find_map(|damping| {
            let (d, factors) = here.step(nlp, &x, damping, &mut order)?;
            let next = light.and_then(|_| nearer(nlp, &x, &d, &here, &factors));
            order = factors.symmetric();
            next.or_else(|| match damping == damped {
                true => shortened(nlp, &x, &d, &here),
                false => None,
            })
        });
        let Some((next, there)) = next else { break };
        (x, here) = (next, there);
        if here.size <= 0.5 * halved.1 {
            halved = (steps, here.size);
        }
    }
    Some(((x, here), steps))
}

/// The first point along the step, halved again and again, where the residual is less.
fn shortened(nlp: &mut Problem, x: &[f64], d: &[f64], here: &System) -> Option<(Vec<f64>, System)> {
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

/// The first point along the step, halved again and again, from which the next step with the same matrix would be shorter.
fn nearer(
    nlp: &mut Problem,
    x: &[f64],
    d: &[f64],
    here: &System,
    factors: &Factors,
) -> Option<(Vec<f64>, System)> {
    let size = here.length(d);
    let mut length = 1.0;
    for _ in 0..HALVINGS {
        let next = moved(nlp, x, d, length);
        let again = residuals(nlp, &next).and_then(|r| here.again(factors, &r));
        if again.is_some_and(|d| here.length(&d) <= (1.0 - 0.25 * length) * size)
            && let Some(there) = System::at(nlp, &next)
        {
            return Some((next, there));
        }
        length *= 0.5;
    }
    None
}

/// x + t d, put into the bounds.
pub(super) fn moved(nlp: &Problem, x: &[f64], d: &[f64], t: f64) -> Vec<f64> {
    let mut there = sum(x, t, d);
    clip(&mut there, nlp.bounds());
    there
}

/// What the constraints are violated by: positive above, negative below.
pub(super) fn residuals(nlp: &mut Problem, x: &[f64]) -> Option<Vec<f64>> {
    let mut g = vec![0.0; nlp.size().1];
    nlp.constraints(x, &mut g)?;
    let (a, b) = nlp.sides();
    for (g, (&a, &b)) in g.iter_mut().zip(a.iter().zip(b)) {
        *g -= g.max(a).min(b);
    }
    g.iter().all(|r| r.is_finite()).then_some(g)
}

/// The equations at a point.
pub(super) struct System {
    /// Jacobian in the units of rows and columns.
    jacobian: Vec<Entry>,
    pub(super) residual: Vec<f64>,
    row_unit: Vec<f64>,
    column_unit: Vec<f64>,
    /// Largest residual in its units.
    size: f64,
}

impl System {
    pub(super) fn at(nlp: &mut Problem, x: &[f64]) -> Option<Self> {
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

    /// Length of a step in the units of the variables.
    pub(super) fn length(&self, d: &[f64]) -> f64 {
        self.product(d, d).sqrt()
    }

    /// Inner product of two steps in the units of the variables.
    pub(super) fn product(&self, d: &[f64], e: &[f64]) -> f64 {
        let each = d.iter().zip(e).zip(&self.column_unit);
        each.map(|((d, e), u)| d / u * (e / u)).sum()
    }

    /// The step with the same factors at another residual; none where other rows would count there.
    pub(super) fn again(&self, factors: &Factors, residual: &[f64]) -> Option<Vec<f64>> {
        let counted = |(r, row): (&f64, &Option<usize>)| *r == 0.0 || row.is_some();
        if !residual.iter().zip(&factors.places.row).all(counted) {
            return None;
        }
        self.by(factors, residual)
    }

    /// The step by these factors.
    fn by(&self, factors: &Factors, residual: &[f64]) -> Option<Vec<f64>> {
        let right = |i: usize| -residual[i] / self.row_unit[i];
        Some(factors.solve(self, |_| 0.0, right)?.0)
    }

    /// The step, none of it out of the bounds that the point is at, and the factors that gave it; `order`: factors whose order may
    /// serve again.
    pub(super) fn step(
        &self,
        nlp: &Problem,
        x: &[f64],
        damping: f64,
        order: &mut Option<Symmetric>,
    ) -> Option<(Vec<f64>, Factors)> {
        let (lower, upper) = nlp.bounds();
        let (a, b) = nlp.sides();
        let counts = |i: usize| a[i] == b[i] || self.residual[i] != 0.0;
        let mut stays = vec![false; x.len()];
        loop {
            let factors = self.factors([damping, 1.0], &stays, counts, order.take())?;
            let d = self.by(&factors, &self.residual)?;
            let leaves =
                |j: usize| d[j] < 0.0 && x[j] <= lower[j] || d[j] > 0.0 && x[j] >= upper[j];
            let out: Vec<usize> = (0..x.len()).filter(|&j| !stays[j] && leaves(j)).collect();
            if out.is_empty() {
                return Some((d, factors));
            }
            *order = factors.symmetric();
            out.into_iter().for_each(|j| stays[j] = true);
        }
    }

    /// Multipliers for which as little as possible of ∇f + Jᵀλ is left, variables at a bound aside.
    fn multipliers(&self, nlp: &mut Problem, x: &[f64]) -> Option<Vec<f64>> {
        let mut gradient = vec![0.0; x.len()];
        nlp.gradient(x, &mut gradient)?;
        let (lower, upper) = nlp.bounds();
        let all = x.iter().zip(lower.iter().zip(upper));
        let at_bound: Vec<bool> = all.map(|(x, (l, u))| x <= l || x >= u).collect();
        let (a, b) = nlp.sides();
        let left = |j: usize| -gradient[j] * self.column_unit[j];
        let diagonal = [1.0, LEAST_DAMPING];
        let factors = self.factors(diagonal, &at_bound, |i| a[i] == b[i], None)?;
        let y = factors.solve(self, left, |_| 0.0)?.1;
        Some(y.iter().zip(&self.row_unit).map(|(y, u)| y / u).collect())
    }

    /// Factors of \[δI Jᵀ; J −γI\] for the variables that do not stay and the rows that count, in their units.
    fn factors(
        &self,
        [delta, gamma]: [f64; 2],
        stays: &[bool],
        counts: impl Fn(usize) -> bool,
        order: Option<Symmetric>,
    ) -> Option<Factors> {
        let free: Vec<bool> = stays.iter().map(|s| !s).collect();
        let held: Vec<bool> = (0..self.row_unit.len()).map(counts).collect();
        // for a square matrix only what counts has a place
        let places = Places::new(&free, &held, f64::INFINITY);
        if places.is_square() && places.variables >= MANY {
            let entries = self.jacobian.iter();
            let entries =
                entries.filter_map(|&(i, j, a)| Some((places.row[i]?, places.column[j]?, a)));
            if let Some(lu) = lu(places.variables, entries) {
                let kind = Kind::Lu(Box::new(lu));
                return Some(Factors { places, kind });
            }
        }
        let places = Places::new(&free, &held, MOST);
        let mut matrix = Lower::default();
        places.diagonal(&mut matrix, |_| delta, -gamma);
        for &(i, j, a) in &self.jacobian {
            places.slope(&mut matrix, i, j, a);
        }
        let mut factors = order.unwrap_or_else(Symmetric::empty);
        let regular = factors.factor(places.total(), &matrix);
        let kind = Kind::Symmetric(Box::new(factors));
        regular.then_some(Factors { places, kind })
    }
}

/// Factors of a square matrix; none where they would take much memory, and where a solution shows that it is singular, or nearly.
fn lu(n: usize, entries: impl Iterator<Item = Entry> + Clone) -> Option<Lu<usize, f64>> {
    let mut in_row = vec![0.0; n];
    entries.clone().for_each(|e| in_row[e.0] += 1.0);
    let product: f64 = in_row.iter().map(|r| r * r).sum();
    if product.min((n * n) as f64) > MOST_NONZEROS {
        return None;
    }
    let triplets: Vec<_> = entries
        .clone()
        .map(|(i, j, a)| Triplet::new(i, j, a))
        .collect();
    let matrix = SparseColMat::try_new_from_triplets(n, n, &triplets).ok()?;
    let lu = matrix.sp_lu().ok()?;
    let mut x = vec![1.0; n];
    lu.solve_in_place(faer::ColMut::from_slice_mut(&mut x));
    let mut residual = vec![1.0; n];
    entries.for_each(|(i, j, a)| residual[i] -= a * x[j]);
    residual.iter().all(|r| r.abs() <= SOUND).then_some(lu)
}

/// Factors, and the place of each variable and row.
pub(super) struct Factors {
    pub(super) places: Places,
    kind: Kind,
}

/// What is factorised: the whole system, or J.
enum Kind {
    Symmetric(Box<Symmetric>),
    Lu(Box<Lu<usize, f64>>),
}

impl Factors {
    /// Factors whose order may serve again.
    pub(super) fn symmetric(self) -> Option<Symmetric> {
        match self.kind {
            Kind::Symmetric(factors) => Some(*factors),
            Kind::Lu(_) => None,
        }
    }

    /// The solution for right-hand sides in the units of the system: a step, and multipliers of the rows in their units.
    fn solve(
        &self,
        system: &System,
        left: impl Fn(usize) -> f64,
        right: impl Fn(usize) -> f64,
    ) -> Option<(Vec<f64>, Vec<f64>)> {
        let places = &self.places;
        let mut side = vec![0.0; places.total()];
        for (j, p) in places.column.iter().enumerate() {
            p.iter().for_each(|p| side[*p] = left(j));
        }
        for (i, p) in places.row.iter().enumerate() {
            p.iter().for_each(|p| side[places.variables + p] = right(i));
        }
        let s = match &self.kind {
            Kind::Symmetric(factors) => factors.solve(&side)?,
            // Jᵀy = left, J d = right
            Kind::Lu(lu) => {
                let (y, d) = side.split_at_mut(places.variables);
                lu.solve_transpose_in_place(faer::ColMut::from_slice_mut(y));
                lu.solve_in_place(faer::ColMut::from_slice_mut(d));
                [d, y].concat()
            }
        };
        let d = places.column.iter().zip(&system.column_unit);
        let d = d.map(|(p, u)| p.map_or(0.0, |p| s[p] * u)).collect();
        let y = places.row.iter();
        let y = y
            .map(|p| p.map_or(0.0, |p| s[places.variables + p]))
            .collect();
        Some((d, y))
    }
}
