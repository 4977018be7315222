//! The relaxation of a linear program with discrete columns: the simplex method, from basis to basis.

use super::model::{Change, Mip};
use super::propagate::Sum;
use super::relaxation::{Control, Relaxation, Solved};
use crate::solve::lp::Ended;
use crate::solve::lp::form::Problem;
use crate::solve::lp::simplex::{Basis, Simplex, State};
use std::rc::Rc;

/// Pivots that a look at one branch may take.
const PROBE: u64 = 60;

/// The engine with the rows of the program and of cuts.
pub struct Linear {
    /// The program, cuts included.
    pub problem: Problem,
    /// At the basis of the last solve.
    pub simplex: Simplex,
    n: usize,
    /// Multipliers of the rows that show that the last program has no point.
    empty: Option<Vec<f64>>,
}

/// A cut: the sum of its terms is not above `side`.
#[derive(Clone, Debug)]
pub struct Cut {
    /// Columns and coefficients, columns increasing.
    pub terms: Vec<(usize, f64)>,
    /// Right-hand side.
    pub side: f64,
}

impl Linear {
    /// Without cuts.
    pub fn new(mip: &Mip) -> Self {
        let problem = mip.problem.clone();
        Self {
            simplex: Self::engine(&problem),
            n: problem.n(),
            empty: None,
            problem,
        }
    }

    fn engine(problem: &Problem) -> Simplex {
        let mut simplex = Simplex::new(problem);
        simplex.trusted = 60;
        simplex
    }

    /// Appends cuts as rows; the basis grows by their slacks.
    pub fn add(&mut self, cuts: &[Cut]) {
        let mut basis = self.simplex.basis();
        for cut in cuts {
            self.problem.rows.push(cut.terms.iter().copied());
            self.problem.row_lower.push(f64::NEG_INFINITY);
            self.problem.row_upper.push(cut.side);
            basis.push(State::Basic);
        }
        self.rebuild(&basis);
    }

    /// Takes rows from `first` on that do not bind away. Whether there were any: the basis is to be solved from again.
    pub fn drop_idle(&mut self, first: usize) -> bool {
        let mut basis = self.simplex.basis();
        let keep: Vec<bool> = (0..self.problem.m())
            .map(|i| i < first || basis[self.n + i] != State::Basic)
            .collect();
        if keep.iter().all(|k| *k) {
            return false;
        }
        let old = std::mem::take(&mut self.problem.rows);
        self.problem.rows = crate::solve::lp::form::Sparse::default();
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        basis.truncate(self.n);
        let states = self.simplex.basis();
        for i in (0..keep.len()).filter(|&i| keep[i]) {
            self.problem.rows.push(old.line(i));
            lower.push(self.problem.row_lower[i]);
            upper.push(self.problem.row_upper[i]);
            basis.push(states[self.n + i]);
        }
        (self.problem.row_lower, self.problem.row_upper) = (lower, upper);
        self.rebuild(&basis);
        true
    }

    fn rebuild(&mut self, basis: &Basis) {
        self.problem.columns = self.problem.rows.transpose(self.n);
        let iterations = self.simplex.iterations;
        self.simplex = Self::engine(&self.problem);
        self.simplex.iterations = iterations;
        self.simplex.set_basis(basis);
    }
}

impl Relaxation for Linear {
    type Start = Rc<Basis>;

    fn set_bounds(&mut self, change: Change) {
        // The bounds of the program are those of the root, which cuts rely on; the engine's are the node's.
        self.simplex
            .set_bounds(change.column, change.lower, change.upper);
    }

    fn solve(&mut self, cutoff: f64, control: &mut Control) -> Solved {
        self.simplex.cutoff = cutoff + 1e-7 * cutoff.abs().max(1.0);
        let before = self.simplex.iterations;
        let spent = control.iterations;
        let each = control.each;
        let mut stop = |k: u64| match k - before >= each {
            true => Some(Ended::Iterations),
            false => control.stop(spent + k - before),
        };
        let mut ended = self.simplex.resolve(&mut stop);
        if ended == Ended::Failed {
            // Numbers broke down: once more from nothing.
            let mut fresh = Self::engine(&self.problem);
            fresh.copy_data(&self.simplex);
            self.simplex = fresh;
            ended = self.simplex.solve(&mut stop);
        }
        control.iterations = spent + self.simplex.iterations - before;
        self.empty = None;
        match ended {
            Ended::Solved => Solved::Value(self.value()),
            Ended::Infeasible(y) => {
                self.empty = Some(y);
                Solved::Infeasible
            }
            Ended::Unbounded(direction) => Solved::Unbounded(direction),
            Ended::Iterations if self.simplex.is_beyond_cutoff() => Solved::Cutoff,
            Ended::Failed => Solved::Failed,
            ended => Solved::Stopped(ended),
        }
    }

    fn x(&self) -> &[f64] {
        &self.simplex.values()[..self.n]
    }

    fn reduced(&self) -> Option<&[f64]> {
        Some(&self.simplex.reduced()[..self.n])
    }

    fn sum(&self, cutoff: f64) -> Option<Sum> {
        let p = &self.problem;
        let (mut terms, mut side) = match &self.empty {
            Some(_) => (vec![0.0; self.n], 0.0),
            None if cutoff.is_finite() => (p.cost.clone(), cutoff),
            None => return None,
        };
        // the multipliers of rows are the reduced costs of their activities
        let y = match &self.empty {
            Some(y) => y,
            None => &self.simplex.reduced()[self.n..],
        };
        let mut largest: Vec<f64> = terms.iter().map(|t| t.abs()).collect();
        let top = y.iter().fold(0.0f64, |m, y| m.max(y.abs()));
        for (i, &y) in y.iter().enumerate().filter(|y| *y.1 != 0.0) {
            let bound = p.priced_side(i, y);
            if bound.is_finite() {
                side -= y * bound;
                for (j, a) in p.rows.line(i) {
                    terms[j] -= y * a;
                    largest[j] = largest[j].max((y * a).abs());
                }
            } else if y.abs() > 1e-9 * top {
                return None;
            }
        }
        // but for what rounding left
        let terms = terms.into_iter().zip(largest).enumerate();
        let terms = terms.filter(|(_, (a, largest))| a.abs() > 1e-12 * largest);
        Some((terms.map(|(j, (a, _))| (j, a)).collect(), side))
    }

    fn start(&self) -> Self::Start {
        Rc::new(self.simplex.basis())
    }

    fn restart(&mut self, start: &Self::Start) {
        self.simplex.set_basis(start);
    }

    fn probe(&mut self, changes: &[Change], cutoff: f64) -> Option<f64> {
        let mut trial = self.simplex.clone();
        for c in changes {
            trial.set_bounds(c.column, c.lower, c.upper);
        }
        trial.cutoff = cutoff + 1e-7 * cutoff.abs().max(1.0);
        let before = trial.iterations;
        let ended = trial.retry(PROBE);
        self.simplex.iterations += trial.iterations - before;
        let value: f64 = self
            .problem
            .cost
            .iter()
            .zip(trial.values())
            .map(|(c, x)| c * x)
            .sum();
        match ended {
            Ended::Infeasible(_) => Some(f64::INFINITY),
            Ended::Iterations if trial.is_beyond_cutoff() => Some(f64::INFINITY),
            Ended::Solved | Ended::Iterations => Some(value.max(self.value())),
            _ => None,
        }
    }
}

impl Linear {
    /// Value of its point.
    pub(super) fn value(&self) -> f64 {
        self.problem
            .cost
            .iter()
            .zip(self.x())
            .map(|(c, x)| c * x)
            .sum()
    }
}
