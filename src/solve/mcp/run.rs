//! What all methods share during one call of the solver: the problem, its counted evaluations,
//! the limits, the best point.

use feral::SparseColMatrix;

use super::factor::Fill;
use super::fixed::Reduced;
use super::merit::{merit, natural_residual};
use super::{EvalError, INFINITY, Names, Problem, Settings};
pub(super) use crate::solve::budget::Stop;
use crate::solve::vector::clip;
use crate::solve::{Budget, Progress};

/// A point with its function values.
#[derive(Debug, Clone)]
pub(super) struct Point {
    pub(super) x: Vec<f64>,
    pub(super) f: Vec<f64>,
    /// Natural residual.
    pub(super) residual: f64,
    /// Where the natural residual is attained.
    pub(super) worst: usize,
    /// Ψ.
    pub(super) merit: f64,
}

/// Counts the iterations without a notable fall of what shall become small.
pub(super) struct StallCounter {
    least: f64,
    idle: usize,
}

impl StallCounter {
    pub(super) fn new() -> Self {
        StallCounter {
            least: f64::INFINITY,
            idle: 0,
        }
    }

    /// Iterations, this one included, since a value was below the share of the least before it.
    pub(super) fn idle(&mut self, value: f64, share: f64) -> usize {
        self.idle += 1;
        if value < share * self.least {
            (self.least, self.idle) = (value, 0);
        }
        self.idle
    }
}

/// One call of the solver.
pub(super) struct Run<'a, 'm> {
    pub(super) problem: Reduced<'a>,
    pub(super) settings: &'a Settings,
    pub(super) budget: &'a Budget<'m>,
    pub(super) names: Names<'a>,
    pub(super) n: usize,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    pub(super) majors: usize,
    pub(super) pivots: usize,
    pub(super) crash_iterations: usize,
    pub(super) factorisations: usize,
    pub(super) evaluations: usize,
    /// The point of least natural residual so far.
    pub(super) best: Option<Point>,
    /// The last failure to evaluate, for the message.
    pub(super) last_error: Option<EvalError>,
    /// What to expect of factorisations.
    pub(super) fill: Fill,
}

/// Pivots that cost as much as a factorisation where factors are sparse.
const PIVOTS_PER_FACTORISATION: usize = 20;

/// A bound with PATH's and GAMS's idea of infinity.
pub(super) fn bound(b: f64) -> f64 {
    if b >= INFINITY {
        f64::INFINITY
    } else if b <= -INFINITY {
        f64::NEG_INFINITY
    } else {
        b
    }
}

impl<'a, 'm> Run<'a, 'm> {
    pub(super) fn new(
        problem: &'a mut dyn Problem,
        settings: &'a Settings,
        budget: &'a Budget<'m>,
        names: Names<'a>,
    ) -> Self {
        let problem = Reduced::new(problem);
        let data = &problem.data;
        let n = data.lower.len();
        Run {
            fill: Fill::of(n, &data.column_start, &data.rows),
            lower: data.lower.clone(),
            upper: data.upper.clone(),
            problem,
            settings,
            budget,
            names,
            n,
            majors: 0,
            pivots: 0,
            crash_iterations: 0,
            factorisations: 0,
            evaluations: 0,
            best: None,
            last_error: None,
        }
    }

    /// Time, interruption and the limit on pivots.
    pub(super) fn check(&mut self) -> Result<(), Stop> {
        if self.pivots >= self.settings.cumulative_iteration_limit {
            return Err(Stop::Iterations);
        }
        self.budget.tell(Progress {
            method: "path",
            iteration: (self.majors + self.pivots) as u64,
            ..Progress::default()
        });
        self.budget.stop().map_or(Ok(()), Err)
    }

    /// What was done so far: factorisations and pivots, in terms of factorisations, times unknowns.
    pub(super) fn work(&self) -> usize {
        (self.factorisations + self.pivots / PIVOTS_PER_FACTORISATION) * self.n
    }

    /// x clipped to the bounds.
    pub(super) fn clip(&self, x: &mut [f64]) {
        clip(x, (&self.lower, &self.upper));
    }

    /// Evaluates F at x. None if that is not possible or a value is not finite.
    ///
    /// Keeps the best point of all.
    pub(super) fn point(&mut self, x: Vec<f64>) -> Option<Point> {
        if x.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let mut f = vec![0.0; self.n];
        self.evaluations += 1;
        if let Err(error) = self.problem.function(&x, &mut f) {
            self.last_error = Some(error);
            return None;
        }
        if let Some(row) = f.iter().position(|v| !v.is_finite()) {
            self.last_error = Some(EvalError {
                row: Some(self.problem.kept[row]),
                message: "the function value is not finite".into(),
            });
            return None;
        }
        let (residual, worst) = natural_residual(&x, &f, &self.lower, &self.upper);
        let merit = merit(&x, &f, &self.lower, &self.upper);
        let point = Point {
            x,
            f,
            residual,
            worst,
            merit,
        };
        if self
            .best
            .as_ref()
            .is_none_or(|b| point.residual < b.residual)
        {
            self.best = Some(point.clone());
        }
        Some(point)
    }

    /// The Jacobian at x, or None where it cannot be evaluated.
    pub(super) fn jacobian(&mut self, x: &[f64]) -> Option<SparseColMatrix> {
        let data = &self.problem.data;
        let mut jacobian = SparseColMatrix {
            m: self.n,
            col_ptr: data.column_start.clone(),
            row_idx: data.rows.clone(),
            values: vec![0.0; data.rows.len()],
        };
        if let Err(error) = self.problem.jacobian(x, &mut jacobian.values) {
            self.last_error = Some(error);
            return None;
        }
        if jacobian.values.iter().any(|v| !v.is_finite()) {
            self.last_error = Some(EvalError {
                row: None,
                message: "a derivative is not finite".into(),
            });
            return None;
        }
        Some(jacobian)
    }

    /// Whether a residual ends the search.
    pub(super) fn converged(&self, residual: f64) -> bool {
        residual <= self.settings.convergence_tolerance
    }

    /// Whether a residual leaves nothing to gain from one more iteration.
    pub(super) fn polished(&self, residual: f64) -> bool {
        residual <= 1e-4 * self.settings.convergence_tolerance
    }
}
