//! The quadratic program on a working set,
//!
//! ```text
//!     min  ½ dᵀH d + cᵀd     subject to    aᵢᵀd = tᵢ for the rows of the set,  dⱼ given for its columns
//! ```
//!
//! by one factorisation of [H + τD, Aᵀ; A, 0]; τ grows until the matrix has as many negative eigenvalues as rows, so that the
//! solution is a minimum.

use super::point::{Frame, Point};
use crate::solve::nlp::polish::number;
use crate::solve::nlp::problem::Entry;
use crate::solve::nlp::symmetric::{Lower, Symmetric};

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

/// What one program leaves to the next.
#[derive(Default)]
pub(super) struct Memory {
    /// The number of the shift that was enough.
    pub(super) shift: usize,
    /// Factors whose order may serve again.
    pub(super) factors: Option<Symmetric>,
}

/// A solution, and the factors for a correction of it.
pub(super) struct Equality {
    pub(super) d: Vec<f64>,
    /// Multipliers of all rows.
    pub(super) lambda: Vec<f64>,
    pub(super) factors: Option<Symmetric>,
    column: Vec<Option<usize>>,
    row: Vec<Option<usize>>,
    free: usize,
    held: usize,
    /// The shift that it took.
    pub(super) shifted: bool,
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
        let (column, free) = number(|j| working.column[j].is_none(), frame.n);
        let (row, held) = number(|i| working.row[i].is_some(), frame.m);
        let mut d = vec![0.0; frame.n];
        let mut cost = at.gradient.clone();
        for (j, bound) in working.column.iter().enumerate() {
            d[j] = bound.map_or(0.0, |b| b - at.x[j]);
        }
        let mut base = Lower::default();
        let mut largest = 0.0_f64;
        for &(i, j, h) in hessian {
            largest = largest.max((h * at.unit(i) * at.unit(j)).abs());
            match (column[i], column[j]) {
                (Some(p), Some(q)) => base.push(p, q, h),
                (Some(_), None) => cost[i] += h * d[j],
                (None, Some(_)) => cost[j] += h * d[i],
                (None, None) => {}
            }
        }
        let mut right = vec![0.0; free + held];
        for (i, &place) in row.iter().enumerate().take(frame.m) {
            if let (Some(p), Some(side)) = (place, working.row[i]) {
                let mut rest = side - at.values.g[i];
                for (j, a) in at.rows.line(i) {
                    match column[j] {
                        Some(q) => base.push(free + p, q, a),
                        None => rest -= a * d[j],
                    }
                }
                right[free + p] = rest;
            } else if working.pull[i] != 0.0 {
                for (j, a) in at.rows.line(i) {
                    cost[j] += working.pull[i] * a;
                }
            }
        }
        for (j, p) in column.iter().enumerate() {
            if let Some(p) = p {
                right[*p] = -cost[j];
            }
        }
        let mut out = Self {
            d,
            lambda: working.pull.clone(),
            factors: None,
            column,
            row,
            free,
            held,
            shifted: false,
        };
        if free == 0 {
            return (held == 0).then_some(out);
        }
        let largest = if largest > 0.0 { largest } else { 1.0 };
        let before = memory.shift.saturating_sub(1).max(1);
        for k in std::iter::once(0).chain(before..=most) {
            let tau = SHIFTS[k] * largest;
            let mut matrix = base.clone();
            for (j, p) in out.column.iter().enumerate() {
                if let Some(p) = p {
                    matrix.push(*p, *p, tau / at.unit(j).powi(2));
                }
            }
            for k in free..free + held {
                matrix.push(k, k, 0.0);
            }
            let factors = match memory.factors.take() {
                Some(last) => last.again(free + held, &matrix),
                None => Symmetric::new(free + held, &matrix),
            };
            let Some(factors) = factors else { continue };
            let minimum = factors.inertia() == Some((free, held));
            let Some(s) = minimum.then(|| factors.solve(&right)).flatten() else {
                memory.factors = Some(factors);
                continue;
            };
            for (d, p) in out.d.iter_mut().zip(&out.column) {
                *d = p.map_or(*d, |p| s[p]);
            }
            for (l, p) in out.lambda.iter_mut().zip(&out.row) {
                *l = p.map_or(*l, |p| s[free + p]);
            }
            out.factors = Some(factors);
            out.shifted = k > 0;
            if k > 0 {
                memory.shift = k;
            }
            return Some(out);
        }
        None
    }

    /// The step that takes so much off the held rows besides: what their curvature added on the way.
    pub(super) fn correction(&self, curvature: &[f64]) -> Option<Vec<f64>> {
        let factors = self.factors.as_ref().filter(|_| self.held > 0)?;
        let mut right = vec![0.0; self.free + self.held];
        for (c, p) in curvature.iter().zip(&self.row) {
            if let Some(p) = p {
                right[self.free + p] = -c;
            }
        }
        let s = factors.solve(&right)?;
        Some(
            self.column
                .iter()
                .map(|p| p.map_or(0.0, |p| s[p]))
                .collect(),
        )
    }
}
