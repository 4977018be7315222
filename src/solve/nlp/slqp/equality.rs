//! The quadratic program on a working set,
//!
//! ```text
//!     min  ½ dᵀH d + cᵀd     subject to    aᵢᵀd = tᵢ for the rows of the set,  dⱼ given for its columns
//! ```
//!
//! by one factorisation of [H + τD, Aᵀ; A, 0]; τ grows until the matrix has as many negative eigenvalues as rows, so that the
//! solution is a minimum. A bound or a row that a step meets joins the set by a Schur complement: what is a minimum on a space is one on a
//! part of it.

use super::point::{Frame, Point};
use crate::solve::nlp::problem::Entry;
use crate::solve::nlp::symmetric::{Lower, Places, Symmetric};
use crate::solve::strategy::{Strategies, Strategy};
use faer::Mat;
use faer::linalg::solvers::Solve;

/// A bound of a variable or a side of a row that a step meets, and its value.
#[derive(Clone, Copy)]
pub(super) enum Met {
    Column(usize, f64),
    Row(usize, f64),
}

/// What is held: bounds of variables and sides of rows.
#[derive(Clone, PartialEq)]
pub(super) struct Working {
    /// Bound that a variable stays at.
    pub(super) column: Vec<Option<f64>>,
    /// Side that a row is held at.
    pub(super) row: Vec<Option<f64>>,
    /// By row: what a row that stays violated pulls with, as a multiplier.
    pub(super) pull: Vec<f64>,
}

/// Shifts of the diagonal, relative to the largest entry of H, until the solution is a minimum.
const SHIFTS: [f64; 10] = [0.0, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0];
/// The number of the last one.
pub(super) const ANY: usize = SHIFTS.len() - 1;

/// The part of variables and rows that is free or held from which on the matrix has them all.
const MOST: f64 = 0.75;

/// The squared sine of the angle to what is held from which on something may join.
const INDEPENDENT: f64 = 1e-10;
/// What dependent rows give way by, in units, for a multiplier of 1.
const YIELDING: f64 = 1e-7;

/// What one program leaves to the next.
#[derive(Default)]
pub(super) struct Memory {
    /// The number of the shift that was enough.
    pub(super) shift: usize,
    /// Factors whose order may serve again.
    pub(super) factors: Option<Symmetric>,
    /// What of it runs.
    pub(super) strategies: Strategies,
}

/// What joined the set after the factorisation: its entries in the matrix, what they add up to, and A⁻¹ times the entries.
struct Joined {
    met: Met,
    entries: Vec<(usize, f64)>,
    to: f64,
    solved: Vec<f64>,
}

/// A solution, and the factors for a correction of it.
pub(super) struct Equality {
    pub(super) d: Vec<f64>,
    /// Multipliers of all rows.
    pub(super) lambda: Vec<f64>,
    pub(super) factors: Option<Symmetric>,
    /// What rows that stay violated pull with.
    pull: Vec<f64>,
    places: Places,
    /// The solution of the factorised system alone.
    alone: Vec<f64>,
    /// The largest entry of H + τD in units.
    curvature: f64,
    joined: Vec<Joined>,
    /// The shift that it took.
    pub(super) shifted: bool,
    /// The rows depend on each other, nearly, and give way a little: the multipliers are worth nothing.
    pub(super) yields: bool,
}

impl Equality {
    /// None where the matrix is singular with every shift up to the number `most`.
    pub(super) fn new(
        frame: &Frame,
        at: &Point,
        hessian: &[Entry],
        working: &Working,
        most: usize,
        memory: &mut Memory,
    ) -> Option<Self> {
        let free: Vec<bool> = working.column.iter().map(Option::is_none).collect();
        let held: Vec<bool> = working.row.iter().map(Option::is_some).collect();
        let places = Places::new(&free, &held, MOST);
        let mut d = vec![0.0; frame.n];
        let mut cost = at.gradient.clone();
        for (j, bound) in working.column.iter().enumerate() {
            d[j] = bound.map_or(0.0, |b| b - at.x[j]);
        }
        let mut base = Lower::default();
        let mut largest = 0.0_f64;
        for &(i, j, h) in hessian {
            largest = largest.max((h * at.unit(i) * at.unit(j)).abs());
            match (free[i], free[j]) {
                (true, false) => cost[i] += h * d[j],
                (false, true) => cost[j] += h * d[i],
                _ => {}
            }
            places.curve(&mut base, i, j, h);
        }
        let mut right = vec![0.0; places.total()];
        for (i, &pull) in working.pull.iter().enumerate() {
            for (j, a) in at.rows.line(i) {
                places.slope(&mut base, i, j, a);
            }
            if let (Some(p), Some(side)) = (places.row[i], working.row[i]) {
                let line = at.rows.line(i).filter(|e| !free[e.0]);
                let known: f64 = line.map(|(j, a)| a * d[j]).sum();
                right[places.variables + p] = side - at.values.g[i] - known;
            } else if pull != 0.0 {
                for (j, a) in at.rows.line(i) {
                    cost[j] += pull * a;
                }
            }
        }
        for (j, p) in places.column.iter().enumerate() {
            if let Some(p) = p {
                right[*p] = -cost[j];
            }
        }
        let mut out = Self {
            d,
            lambda: working.pull.clone(),
            factors: None,
            pull: working.pull.clone(),
            places,
            alone: Vec::new(),
            curvature: 0.0,
            joined: Vec::new(),
            shifted: false,
            yields: false,
        };
        if !free.contains(&true) {
            return (!held.contains(&true)).then_some(out);
        }
        let largest = if largest > 0.0 { largest } else { 1.0 };
        let before = memory.shift.saturating_sub(1).max(1);
        for k in std::iter::once(0).chain(before..=most) {
            let tau = SHIFTS[k] * largest;
            let mut matrix = base.clone();
            let mut factors = memory.factors.take().unwrap_or_else(Symmetric::empty);
            let give = if out.yields { YIELDING } else { 0.0 };
            let places = &out.places;
            places.diagonal(&mut matrix, |j| tau / at.unit(j).powi(2), -give);
            let regular = factors.factor(places.total(), &matrix);
            let inertia = factors.inertia().filter(|_| regular);
            let solution = match inertia == Some((places.variables, places.rows)) {
                true => factors.solve(&right),
                false => None,
            };
            let Some(s) = solution else {
                // fewer negative eigenvalues than rows: these are dependent whatever the shift
                let dependent = out.yields || inertia.is_some_and(|i| i.1 < places.rows);
                out.yields = dependent && memory.strategies.run(Strategy::DependentRows);
                memory.factors = Some(factors);
                continue;
            };
            out.spread(&s, &[]);
            out.alone = s;
            out.curvature = largest + tau;
            out.factors = Some(factors);
            out.shifted = k > 0 || out.yields;
            if k > 0 {
                memory.shift = k;
            }
            return Some(out);
        }
        None
    }

    /// Reads d and λ from the solution of the system and the multipliers of what joined.
    fn spread(&mut self, s: &[f64], joined: &[f64]) {
        for (d, p) in self.d.iter_mut().zip(&self.places.column) {
            *d = p.map_or(*d, |p| s[p]);
        }
        for (l, p) in self.lambda.iter_mut().zip(&self.places.row) {
            *l = p.map_or(*l, |p| s[self.places.variables + p]);
        }
        for (joined, multiplier) in self.joined.iter().zip(joined) {
            if let Met::Row(i, _) = joined.met {
                self.lambda[i] = self.pull[i] + multiplier;
            }
        }
    }

    /// Solves \[A C; Cᵀ 0\] for the columns C of what joined, given A⁻¹ times the first part of the right-hand side: by the Schur complement,
    /// without a factorisation. The first part of the solution, and the multipliers of what joined.
    fn bordered(&self, mut s: Vec<f64>, to: impl Fn(&Joined) -> f64) -> (Vec<f64>, Vec<f64>) {
        let joined = &self.joined;
        let k = joined.len();
        let complement = Mat::from_fn(k, k, |i, j| along(&joined[i].entries, &joined[j].solved));
        let right = Mat::from_fn(k, 1, |i, _| along(&joined[i].entries, &s) - to(&joined[i]));
        let solution = complement.partial_piv_lu().solve(&right);
        let multipliers: Vec<f64> = (0..k).map(|i| solution[(i, 0)]).collect();
        for (joined, multiplier) in joined.iter().zip(&multipliers) {
            for (s, z) in s.iter_mut().zip(&joined.solved) {
                *s -= multiplier * z;
            }
        }
        (s, multipliers)
    }

    /// A bound or a row joins the set: what d and λ were before. None if it depends on what is held: then nothing changes.
    pub(super) fn join(&mut self, at: &Point, met: Met) -> Option<(Vec<f64>, Vec<f64>)> {
        let (mut entries, mut to, mut size) = (Vec::new(), 0.0, 0.0);
        let mut add = |j: usize, a: f64| match self.places.column[j] {
            Some(p) => {
                entries.push((p, a));
                size += (a * at.unit(j)).powi(2);
            }
            None => to -= a * self.d[j],
        };
        match met {
            Met::Column(j, _) => add(j, 1.0),
            Met::Row(i, _) => at.rows.line(i).for_each(|(j, a)| add(j, a)),
        }
        to += match met {
            Met::Column(j, bound) => bound - at.x[j],
            Met::Row(i, side) => side - at.values.g[i],
        };
        let mut dense = vec![0.0; self.places.total()];
        entries.iter().for_each(|&(p, a)| dense[p] += a);
        let solved = self.factors.as_ref()?.solve(&dense)?;
        let (own, _) = self.bordered(solved.clone(), |_| 0.0);
        // cᵀ Z (ZᵀHZ)⁻¹ Zᵀ c, Z the null space of what is held
        let independent = along(&entries, &own) * self.curvature > INDEPENDENT * size;
        if !independent {
            return None;
        }
        self.joined.push(Joined {
            met,
            entries,
            to,
            solved,
        });
        let (s, multipliers) = self.bordered(self.alone.clone(), |j| j.to);
        let before = (self.d.clone(), self.lambda.clone());
        self.spread(&s, &multipliers);
        Some(before)
    }

    /// The last that joined leaves again.
    pub(super) fn leave(&mut self, (d, lambda): (Vec<f64>, Vec<f64>)) {
        self.joined.pop();
        (self.d, self.lambda) = (d, lambda);
    }

    /// All that joined leave again.
    pub(super) fn leave_all(&mut self) {
        let alone = std::mem::take(&mut self.alone);
        self.joined.clear();
        self.lambda.clone_from(&self.pull);
        self.spread(&alone, &[]);
        self.alone = alone;
    }

    /// The step that takes so much off the held rows besides: what their curvature added on the way.
    pub(super) fn correction(&self, curvature: &[f64]) -> Option<Vec<f64>> {
        let factors = self.factors.as_ref()?;
        let mut right = vec![0.0; self.places.total()];
        for (c, p) in curvature.iter().zip(&self.places.row) {
            if let Some(p) = p {
                right[self.places.variables + p] = -c;
            }
        }
        let (s, _) = self.bordered(factors.solve(&right)?, |j| match j.met {
            Met::Column(..) => 0.0,
            Met::Row(i, _) => -curvature[i],
        });
        Some(
            self.places
                .column
                .iter()
                .map(|p| p.map_or(0.0, |p| s[p]))
                .collect(),
        )
    }
}

/// The product of a sparse and a dense vector.
fn along(entries: &[(usize, f64)], v: &[f64]) -> f64 {
    entries.iter().map(|&(p, a)| a * v[p]).sum()
}
