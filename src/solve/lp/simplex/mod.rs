//! A bounded-variable revised simplex method, restartable from any basis.
//!
//! ```text
//!     min cᵀx   subject to   A x − s = 0,   l ≤ (x, s) ≤ u
//! ```
//!
//! Variables 0 … n−1 are the columns ("structurals"), n … n+m−1 the rows' activities s
//! ("logicals", column −eᵢ). A basis names m of them; every other variable is at a bound, or at a
//! given value if it is free.
//!
//! Two algorithms share the data: the **dual** simplex ([`dual`]) makes a dual feasible basis
//! primal feasible, the **primal** simplex ([`primal`]) makes a primal feasible basis dual
//! feasible. [`Simplex::solve`] alternates them: what a method needs is made true by shifting
//! costs (dual) or is left by the other (primal); shifts and the perturbations against
//! degeneracy are taken back, and the other method repairs what that breaks, until nothing is
//! left to repair. Both use Harris's two-pass ratio test with the largest pivot (Harris 1973), the
//! dual one steepest-edge pricing (Forrest & Goldfarb 1992) and bound flipping (Maros 2003), the
//! primal one Devex pricing (Harris 1973).
//!
//! Accuracy: after every factorisation basic values and multipliers are computed afresh, with one
//! step of iterative refinement whose residuals are summed in twice the working precision. What
//! [`Simplex::point`] returns is refined until it stands still.

mod dual;
pub(in crate::solve) mod factor;
mod primal;
pub mod push;
mod unique;

use super::Ended;
use super::form::{Point, Problem, Sparse};
pub use crate::model::outcome::{Basis, BasisStatus as State};
use crate::model::sum::Sum;
use crate::solve::interval::{WideSum, two_sum};
use factor::{Entries, Factor, Failure, ZERO};
use std::rc::Rc;

/// Numbers as pairs `high + low`.
pub type Wide = (Vec<f64>, Vec<f64>);

/// Position in the basis of a variable that is in none.
const NONBASIC: u32 = u32::MAX;

/// Entries of the pivot row or column smaller than this are noise.
const PIVOT: f64 = 1e-9;

/// A pivot smaller than this is taken only on a fresh factor.
const SAFE_PIVOT: f64 = 1e-6;

/// Pivots for each row that a solution takes, at most, mostly, and after how many of them their work tells that of the others.
const AHEAD: f64 = 2.0;
const TELLING: u64 = 50;

/// What a pivot costs beside the numbers that it touches, in these: always, and for each row.
const PIVOT_WORK: [usize; 2] = [2000, 3];

/// How a method ended.
#[derive(Clone, Debug, PartialEq)]
enum Stop {
    /// What it was to achieve is achieved.
    Done,
    /// Proved that no point satisfies the bounds: multipliers y.
    Infeasible(Vec<f64>),
    /// Proved unbounded: direction of all variables.
    Unbounded(Vec<f64>),
    /// A limit, or numbers broke down.
    Ended(Ended),
}

/// A change of the basis, for the log. Variables are counted as everywhere here: columns, then rows.
#[derive(Clone, Copy, Debug)]
pub struct Pivot {
    /// The variable that leaves.
    pub leaving: usize,
    /// The variable that enters.
    pub entering: usize,
    /// The objective afterwards, in the units of the scaled problem.
    pub objective: f64,
}

/// How much work is the most after all.
type Appeal = dyn Fn(&Simplex) -> f64;

/// The engine. A clone is a state to come back to: it costs far less than to factorise again.
#[derive(Clone, Default)]
pub struct Simplex {
    m: usize,
    n: usize,
    columns: Rc<Sparse>,
    rows: Rc<Sparse>,
    cost: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// Costs with shifts and perturbations.
    work_cost: Vec<f64>,
    /// Bounds with perturbations.
    work_lower: Vec<f64>,
    work_upper: Vec<f64>,
    /// Values of all variables.
    x: Vec<f64>,
    /// Reduced costs of all variables for `work_cost`; 0 for basic ones.
    d: Vec<f64>,
    /// Variable in each slot of the basis.
    head: Vec<u32>,
    /// Slot of each variable, or [`NONBASIC`].
    slot: Vec<u32>,
    factor: Option<Factor>,
    /// Steepest-edge weights of the slots.
    edge: Vec<f64>,
    /// Devex weights of the variables.
    devex: Vec<f64>,
    /// Pivot row, kept zero between uses.
    row: Vec<f64>,
    row_index: Vec<u32>,
    /// Its largest entry.
    row_top: f64,
    /// Where the nonbasic variables are for the dual method: 1 at the lower bound, −1 at the upper one, 2 free, 0 fixed.
    side: Vec<i8>,
    /// Slots whose values a pivot of the dual method has changed.
    touched: Vec<u32>,
    /// How often the basis was factorised.
    renewals: u64,
    /// Pivots since the last one that an update of the factor took.
    refused_updates: u32,
    /// Room for the solutions of a dual pivot.
    solutions: [Entries; 3],
    /// Largest violation of a bound that counts as none.
    pub tolerance: f64,
    /// Largest violation of a reduced cost's sign that counts as none.
    pub dual_tolerance: f64,
    /// Iterations so far.
    pub iterations: u64,
    /// The dual method may give up (as if at an iteration limit) once the value is above this. The
    /// perturbation of the costs makes that inexact: leave a margin.
    pub cutoff: f64,
    /// The methods give up (as at an iteration limit) when [`Self::iterations`] is this.
    pub limit: u64,
    /// The dual method goes first where flips alone make the reduced costs right, which is sooner there in large programs.
    pub flips: bool,
    /// Gives up, as at an iteration limit, when [`Simplex::work`] is more than this, or is likely to be.
    pub most_work: f64,
    /// Asked once, when that is reached: what the most is.
    pub appeal: Option<Rc<Appeal>>,
    /// The basis is near an optimal one, as a rule: only work that was done counts.
    pub warm: bool,
    /// Numbers that the pivots have touched, about.
    work: f64,
    /// The part of the sum of violations that is left of the largest in the dual method.
    left: f64,
    /// A factor that was updated at most so often counts as fresh.
    pub trusted: usize,
    /// The pivots, where they are asked for.
    pub pivots: Option<Vec<Pivot>>,
    perturb: bool,
    /// A crossover is under way: variables that leave the basis in a repair stay where they are, and
    /// columns with a smaller pivot than this leave it.
    crossing: Option<f64>,
}

impl Simplex {
    /// For a problem, with the basis of all logicals.
    pub fn new(p: &Problem) -> Self {
        let (m, n) = (p.m(), p.n());
        let total = m + n;
        let mut cost = p.cost.clone();
        cost.resize(total, 0.0);
        let lower: Vec<f64> = p.lower.iter().chain(&p.row_lower).copied().collect();
        let upper: Vec<f64> = p.upper.iter().chain(&p.row_upper).copied().collect();
        let mut s = Self {
            m,
            n,
            columns: Rc::new(p.columns.clone()),
            rows: Rc::new(p.rows.clone()),
            work_cost: cost.clone(),
            work_lower: lower.clone(),
            work_upper: upper.clone(),
            cost,
            lower,
            upper,
            x: vec![0.0; total],
            d: vec![0.0; total],
            head: (n as u32..total as u32).collect(),
            slot: vec![NONBASIC; total],
            edge: vec![1.0; m],
            devex: vec![1.0; total],
            row: vec![0.0; total],
            side: vec![0; total],
            tolerance: 1e-9,
            dual_tolerance: 1e-9,
            cutoff: f64::INFINITY,
            limit: u64::MAX,
            most_work: f64::INFINITY,
            left: 1.0,
            perturb: true,
            ..Self::default()
        };
        for i in 0..m {
            s.slot[n + i] = i as u32;
        }
        for j in 0..n {
            s.x[j] = s.resting(j, 0.0);
        }
        s
    }

    /// Changes the bounds of a variable (a column, or n + row).
    pub fn set_bounds(&mut self, variable: usize, lower: f64, upper: f64) {
        self.lower[variable] = lower;
        self.upper[variable] = upper;
    }

    /// Changes the cost of a column.
    pub fn set_cost(&mut self, column: usize, cost: f64) {
        self.cost[column] = cost;
    }

    /// Takes bounds, costs and the count of iterations from another engine for the same rows.
    pub fn copy_data(&mut self, other: &Self) {
        self.lower.copy_from_slice(&other.lower);
        self.upper.copy_from_slice(&other.upper);
        self.cost.copy_from_slice(&other.cost);
        self.iterations = other.iterations;
        self.cutoff = other.cutoff;
    }

    /// The basis, to start from again.
    pub fn basis(&self) -> Basis {
        (0..self.n + self.m)
            .map(|j| {
                let (l, u) = (self.lower[j], self.upper[j]);
                if self.slot[j] != NONBASIC {
                    State::Basic
                } else if l.is_infinite() && u.is_infinite() {
                    State::Free
                } else if u.is_infinite() || (self.x[j] - l).abs() <= (u - self.x[j]).abs() {
                    State::Lower
                } else {
                    State::Upper
                }
            })
            .collect()
    }

    /// Starts from a basis. Too few or too many basic variables are made up for with logicals, and
    /// so are dependent columns.
    pub fn set_basis(&mut self, basis: &[State]) {
        self.slot.fill(NONBASIC);
        self.head.clear();
        let basic = |j: &usize| basis.get(*j) == Some(&State::Basic);
        for j in (0..self.n + self.m).filter(basic).take(self.m) {
            self.slot[j] = self.head.len() as u32;
            self.head.push(j as u32);
        }
        for i in 0..self.m {
            let logical = self.n + i;
            if self.head.len() < self.m && self.slot[logical] == NONBASIC {
                self.slot[logical] = self.head.len() as u32;
                self.head.push(logical as u32);
            }
        }
        for j in 0..self.n + self.m {
            self.x[j] = match basis.get(j) {
                Some(State::Upper) if self.upper[j].is_finite() => self.upper[j],
                Some(State::Lower) if self.lower[j].is_finite() => self.lower[j],
                _ => self.resting(j, 0.0),
            };
        }
        self.edge.fill(1.0);
        self.devex.fill(1.0);
        self.factor = None;
    }

    /// Where a nonbasic variable rests that would like to be at `near`.
    fn resting(&self, j: usize, near: f64) -> f64 {
        let (l, u) = (self.work_lower[j], self.work_upper[j]);
        match (l.is_finite(), u.is_finite()) {
            (true, true) if (near - l).abs() <= (u - near).abs() => l,
            (true, true) => u,
            (true, false) => l,
            (false, true) => u,
            (false, false) => 0.0,
        }
    }

    /// Column of a variable.
    fn column(&self, j: usize) -> Entries {
        if j < self.n {
            self.columns.line(j).collect()
        } else {
            vec![(j - self.n, -1.0)]
        }
    }

    /// Factorises the basis, replacing dependent columns by logicals, and computes values and
    /// reduced costs afresh. None: numbers broke down.
    fn refactor(&mut self) -> Option<()> {
        self.renewals += 1;
        for _ in 0..20 {
            let columns: Vec<Entries> =
                self.head.iter().map(|&j| self.column(j as usize)).collect();
            let zero = self.crossing.unwrap_or(ZERO);
            match Factor::without_pivots_below(zero, self.m, &columns) {
                Ok(f) => {
                    self.factor = Some(f);
                    match self.crossing {
                        Some(_) => self.compute_good_values(),
                        None => self.compute_values()?,
                    }
                    return self.compute_reduced();
                }
                Err(Failure::Numbers) => return None,
                Err(Failure::Dependent(list)) => {
                    for (slot, row) in list {
                        let out = self.head[slot] as usize;
                        let logical = self.n + row;
                        if self.slot[logical] != NONBASIC {
                            return None;
                        }
                        self.slot[out] = NONBASIC;
                        if self.crossing.is_none() {
                            self.x[out] = self.resting(out, self.x[out]);
                        }
                        self.slot[logical] = slot as u32;
                        self.head[slot] = logical as u32;
                        self.edge[slot] = 1.0;
                    }
                }
            }
        }
        None
    }

    /// Residuals of A x − s = 0, in twice the working precision.
    fn row_residuals(&self) -> Vec<f64> {
        let mut residuals = Vec::with_capacity(self.m);
        for i in 0..self.m {
            let mut sum = Sum::new(self.x[self.n + i]);
            for (j, a) in self.rows.line(i) {
                sum.add_product(-a, self.x[j]);
            }
            residuals.push(sum.value());
        }
        residuals
    }

    /// Values of the basic variables from those of the others.
    fn compute_values(&mut self) -> Option<()> {
        for _ in 0..2 {
            let mut residuals = self.row_residuals();
            let factor = self.factor.as_mut()?;
            factor.forward_dense(&mut residuals)?;
            for (k, &j) in self.head.iter().enumerate() {
                self.x[j as usize] += residuals[k];
            }
        }
        self.x.iter().all(|v| v.is_finite()).then_some(())
    }

    /// The same on the way of a crossover: the values at hand satisfy the equations, and stay where the
    /// basis is so ill-conditioned that computed ones would not satisfy the bounds.
    fn compute_good_values(&mut self) {
        let before = self.x.clone();
        let violation = self.violation();
        if self.compute_values().is_none() || self.violation() > violation.max(1e-7) {
            self.x = before;
        }
    }

    /// Multipliers y with Bᵀy = c_B.
    fn multipliers(&mut self) -> Option<Vec<f64>> {
        let mut y = vec![0.0; self.m];
        for _ in 0..2 {
            let mut residuals: Vec<f64> = self
                .head
                .iter()
                .map(|&j| self.price(j as usize, &y))
                .collect();
            self.factor.as_mut()?.backward_dense(&mut residuals)?;
            y.iter_mut().zip(&residuals).for_each(|(y, r)| *y += r);
        }
        y.iter().all(|v| v.is_finite()).then_some(y)
    }

    /// c_j − a_jᵀy for the working costs, in twice the working precision.
    fn price(&self, j: usize, y: &[f64]) -> f64 {
        let mut sum = Sum::new(self.work_cost[j]);
        if j < self.n {
            for (i, a) in self.columns.line(j) {
                sum.add_product(-a, y[i]);
            }
        } else {
            sum.add(y[j - self.n]);
        }
        sum.value()
    }

    /// Reduced costs of all variables.
    fn compute_reduced(&mut self) -> Option<()> {
        let y = self.multipliers()?;
        for j in 0..self.n + self.m {
            self.d[j] = match self.slot[j] {
                NONBASIC => self.price(j, &y),
                _ => 0.0,
            };
        }
        Some(())
    }

    /// Whether a variable is nearer to its lower bound.
    fn is_low(&self, j: usize) -> bool {
        let (l, u, x) = (self.work_lower[j], self.work_upper[j], self.x[j]);
        u.is_infinite() || (l.is_finite() && x - l <= u - x)
    }

    /// Whether the basis is factorised, and was not changed since.
    fn is_fresh(&self) -> bool {
        self.factor.as_ref().is_some_and(|f| f.updates() == 0)
    }

    /// By how much a reduced cost has the wrong sign for where its variable is.
    fn dual_violation(&self, j: usize) -> f64 {
        let (l, u, d) = (self.work_lower[j], self.work_upper[j], self.d[j]);
        if l == u {
            0.0
        } else if l.is_infinite() && u.is_infinite() {
            d.abs()
        } else if self.is_low(j) {
            (-d).max(0.0)
        } else {
            d.max(0.0)
        }
    }

    /// Largest violation of a bound by a basic variable.
    pub fn violation(&self) -> f64 {
        self.head.iter().fold(0.0, |worst: f64, &j| {
            let (j, x) = (j as usize, self.x[j as usize]);
            worst
                .max(self.work_lower[j] - x)
                .max(x - self.work_upper[j])
        })
    }

    /// Largest wrong-signed reduced cost.
    fn dual_infeasibility(&self) -> f64 {
        (0..self.n + self.m)
            .filter(|&j| self.slot[j] == NONBASIC)
            .fold(0.0, |worst, j| self.dual_violation(j).max(worst))
    }

    /// Takes back shifts and perturbations; nonbasic variables return to their bounds. Only what these or a
    /// new bound or cost change is computed afresh, unless the factor is worn.
    fn restore(&mut self) -> Option<()> {
        let new_costs = self.work_cost != self.cost;
        self.work_cost.copy_from_slice(&self.cost);
        self.work_lower.copy_from_slice(&self.lower);
        self.work_upper.copy_from_slice(&self.upper);
        let mut moved = false;
        for j in 0..self.n + self.m {
            if self.slot[j] == NONBASIC {
                let rest = self.resting(j, self.x[j]);
                moved |= rest != self.x[j];
                self.x[j] = rest;
            }
        }
        if !self.is_trusted() {
            return self.refactor();
        }
        if moved {
            self.compute_values()?;
        }
        if new_costs {
            self.compute_reduced()?;
        }
        Some(())
    }

    /// Whether values and reduced costs need no fresh factor.
    fn is_trusted(&self) -> bool {
        let updates = self.factor.as_ref().map(Factor::updates);
        updates.is_some_and(|u| u <= self.trusted)
    }

    /// Solves from a basis.
    pub fn solve_from_basis(
        &mut self,
        basis: &[State],
        stop: &mut dyn FnMut(u64) -> Option<Ended>,
    ) -> Ended {
        self.set_basis(basis);
        self.solve(stop)
    }

    /// Solves from the present basis. `stop` is asked now and then, with the iterations so far.
    pub fn solve(&mut self, stop: &mut dyn FnMut(u64) -> Option<Ended>) -> Ended {
        self.rounds(2, stop)
    }

    /// Solves after small changes from the present basis, without perturbations, in at most `most` iterations.
    pub fn retry(&mut self, most: u64) -> Ended {
        self.limit = self.iterations + most;
        let ended = self.rounds(0, &mut |_| None);
        self.limit = u64::MAX;
        ended
    }

    /// Solves after bounds have changed, as in a search: without perturbations first, with them where that takes long.
    pub fn resolve(&mut self, stop: &mut dyn FnMut(u64) -> Option<Ended>) -> Ended {
        let most = self.limit;
        self.limit = most.min(self.iterations + 500);
        let ended = self.rounds(0, stop);
        self.limit = most;
        let cut = self.is_beyond_cutoff() || self.iterations >= most;
        match ended {
            Ended::Iterations if !cut => self.rounds(2, stop),
            Ended::Failed => self.rounds(2, stop),
            ended => ended,
        }
    }

    /// Whether the dual method gave up because the value, for the costs it worked with, is above the cutoff.
    pub fn is_beyond_cutoff(&self) -> bool {
        let terms = self.work_cost.iter().zip(&self.x).map(|(c, x)| c * x);
        self.cutoff.is_finite() && terms.sum::<f64>() > self.cutoff
    }

    /// Multipliers of the rows that give the row of the tableau in which this variable is basic.
    pub fn tableau_multipliers(&mut self, variable: usize) -> Option<Entries> {
        let slot = self.slot[variable];
        match slot {
            NONBASIC => None,
            _ => self
                .factor
                .as_mut()?
                .backward(&[(slot as usize, 1.0)])
                .cloned(),
        }
    }

    /// The row of the tableau in which this variable is basic: the others in it with their entries.
    pub fn tableau_row(&mut self, variable: usize) -> Option<Entries> {
        let rho = self.tableau_multipliers(variable)?;
        self.pivot_row(&rho);
        let entry = |j: &u32| (*j as usize, self.row[*j as usize]);
        Some(self.row_index.iter().map(entry).collect())
    }

    /// What the basic variables change by when a nonbasic one grows by 1.
    pub fn direction(&mut self, variable: usize) -> Option<Entries> {
        let column = self.column(variable);
        let moved = self.factor.as_mut()?.forward(&column)?;
        let of = |&(k, a): &(usize, f64)| (self.head[k] as usize, -a);
        Some(moved.iter().map(of).collect())
    }

    /// Whether a variable (a column, or n + row) is basic.
    pub fn is_basic(&self, variable: usize) -> bool {
        self.slot[variable] != NONBASIC
    }

    /// Values of columns and rows at the present basis.
    pub fn values(&self) -> &[f64] {
        &self.x
    }

    /// Reduced costs of columns and rows at the present basis; 0 for basic ones.
    pub fn reduced(&self) -> &[f64] {
        &self.d
    }

    /// Solves again from the basis of a first solution, with tolerances near rounding: what a
    /// violation of δ at every bound does to the objective is δ times the sum of all multipliers,
    /// and on walls that sum is in the thousands. Where the numbers do not allow it, the first
    /// basis stays. Returns whether they did.
    pub fn tighten(&mut self, stop: &mut dyn FnMut(u64) -> Option<Ended>) -> Ended {
        self.tighten_to(&[(1e-11, 1e-11), (1e-13, 1e-12)], stop)
    }

    /// The same for a sequence of primal and dual tolerances. Without perturbations, and with reduced costs that are rounding
    /// errors, pivots may go round in a circle: as many are made as there were before, and one for each row.
    pub fn tighten_to(
        &mut self,
        tolerances: &[(f64, f64)],
        stop: &mut dyn FnMut(u64) -> Option<Ended>,
    ) -> Ended {
        let usual = (self.tolerance, self.dual_tolerance, self.limit);
        let most = usual.2.min(2 * self.iterations + self.m as u64);
        for &(primal, dual) in tolerances {
            let basis = self.basis();
            (self.tolerance, self.dual_tolerance, self.limit) = (primal, dual, most);
            let ended = self.rounds(0, stop);
            (self.tolerance, self.dual_tolerance, self.limit) = usual;
            if ended != Ended::Solved {
                self.set_basis(&basis);
                return ended;
            }
        }
        Ended::Solved
    }

    /// Alternates the methods; the first `perturbed` rounds with perturbations.
    fn rounds(&mut self, perturbed: u32, stop: &mut dyn FnMut(u64) -> Option<Ended>) -> Ended {
        let mut before = None;
        self.refused_updates = 0;
        for round in 0..12 {
            self.perturb = round < perturbed;
            if self.restore().is_none() {
                return Ended::Failed;
            }
            let here = (self.iterations, self.violation(), self.dual_infeasibility());
            if before.replace(here) == Some(here) && round > perturbed {
                return Ended::Failed;
            }
            let primal = self.violation() <= self.tolerance;
            // From the basis of all logicals flips alone may make the reduced costs right.
            let by_flips = || round == 0 && self.flips && !self.is_endless_infeasible();
            let end = if primal && self.dual_infeasibility() <= self.dual_tolerance {
                return Ended::Solved;
            } else if primal && !by_flips() {
                self.primal(stop)
            } else {
                self.dual(stop)
            };
            match end {
                Stop::Done => {}
                Stop::Infeasible(y) => return Ended::Infeasible(y),
                Stop::Unbounded(direction) => {
                    return Ended::Unbounded(direction[..self.n].to_vec());
                }
                Stop::Ended(why) => return why,
            }
        }
        Ended::Failed
    }

    /// Multipliers of the rows at the present basis, for the true costs.
    pub fn prices(&mut self) -> Option<Vec<f64>> {
        self.restore()?;
        self.multipliers()
    }

    /// Values of columns and rows at the present basis, for the true bounds, computed anew.
    pub fn fresh_values(&mut self) -> Option<&[f64]> {
        self.restore()?;
        self.compute_values()?;
        Some(&self.x)
    }

    /// The point of the present basis for the true costs and bounds, refined.
    pub fn point(&mut self) -> Option<Point> {
        self.restore()?;
        for _ in 0..3 {
            self.compute_values()?;
        }
        let y = self.multipliers()?;
        let d = (0..self.n)
            .map(|j| match self.slot[j] {
                NONBASIC => self.price(j, &y),
                _ => 0.0,
            })
            .collect();
        Some(Point {
            x: self.x[..self.n].to_vec(),
            y,
            d,
        })
    }

    /// The point of the present basis for the true costs and bounds, x and y as pairs of numbers,
    /// right to nearly twice the working precision.
    pub fn wide_point(&mut self) -> Option<[Wide; 2]> {
        self.restore()?;
        let total = self.n + self.m;
        let mut low = vec![0.0; total];
        let shift = |high: &mut f64, low: &mut f64, step: f64| {
            let (s, e) = two_sum(*high, step);
            (*high, *low) = two_sum(s, *low + e);
        };
        for _ in 0..4 {
            let mut residuals = Vec::with_capacity(self.m);
            for i in 0..self.m {
                let logical = self.n + i;
                let mut sum = WideSum::new(self.x[logical]);
                sum.add(low[logical]);
                for (j, a) in self.rows.line(i) {
                    sum.add_product(-a, self.x[j]);
                    sum.add_product(-a, low[j]);
                }
                residuals.push(sum.value().middle());
            }
            self.factor.as_mut()?.forward_dense(&mut residuals)?;
            for (k, &j) in self.head.iter().enumerate() {
                let j = j as usize;
                shift(&mut self.x[j], &mut low[j], residuals[k]);
            }
        }
        let (mut y, mut y_low) = (vec![0.0; self.m], vec![0.0; self.m]);
        for _ in 0..5 {
            let mut residuals = Vec::with_capacity(self.m);
            for &j in &self.head {
                let j = j as usize;
                let mut sum = WideSum::new(self.cost[j]);
                if j < self.n {
                    for (i, a) in self.columns.line(j) {
                        sum.add_product(-a, y[i]);
                        sum.add_product(-a, y_low[i]);
                    }
                } else {
                    sum.add(y[j - self.n]);
                    sum.add(y_low[j - self.n]);
                }
                residuals.push(sum.value().middle());
            }
            self.factor.as_mut()?.backward_dense(&mut residuals)?;
            for (i, &r) in residuals.iter().enumerate() {
                shift(&mut y[i], &mut y_low[i], r);
            }
        }
        low.truncate(self.n);
        Some([(self.x[..self.n].to_vec(), low), (y, y_low)])
    }

    /// Pivot row of a slot: `row[j]` = ρᵀa_j for all nonbasic j, with ρ the row of the inverse.
    fn pivot_row(&mut self, rho: &[(usize, f64)]) {
        for &j in &self.row_index {
            self.row[j as usize] = 0.0;
        }
        self.row_index.clear();
        let lengths = rho.iter().map(|e| self.rows.line(e.0).len());
        let length: usize = lengths.sum();
        self.work += length as f64;
        match length > self.n {
            true => self.full_pivot_row(rho),
            false => self.sparse_pivot_row(rho),
        }
        let entries = self.row_index.iter().map(|&j| self.row[j as usize].abs());
        self.row_top = entries.fold(0.0, f64::max);
    }

    fn sparse_pivot_row(&mut self, rho: &[(usize, f64)]) {
        let (row, slot) = (&mut self.row[..], &self.slot[..]);
        for &(i, r) in rho {
            for (j, a) in self.rows.line(i) {
                if slot[j] == NONBASIC {
                    let before = row[j];
                    if before == 0.0 {
                        self.row_index.push(j as u32);
                    }
                    // What cancels stays marked as listed.
                    let v = before + r * a;
                    row[j] = if v == 0.0 { f64::MIN_POSITIVE } else { v };
                }
            }
            let logical = self.n + i;
            if slot[logical] == NONBASIC {
                self.row_index.push(logical as u32);
                row[logical] = -r;
            }
        }
    }

    /// The same where most entries of the row are met several times.
    fn full_pivot_row(&mut self, rho: &[(usize, f64)]) {
        let row = &mut self.row[..];
        for &(i, r) in rho {
            self.rows.line(i).for_each(|(j, a)| row[j] += r * a);
            row[self.n + i] = -r;
        }
        for (j, (v, &slot)) in row.iter_mut().zip(&self.slot).enumerate() {
            if slot != NONBASIC {
                *v = 0.0;
            } else if *v != 0.0 {
                self.row_index.push(j as u32);
            }
        }
    }

    /// Whether this is as far as it may go.
    fn is_spent(&mut self) -> bool {
        let pivots = self.iterations.max(TELLING) as f64;
        let ahead = match self.warm {
            true => 0.0,
            false => (AHEAD * self.m as f64 / pivots - 1.0).max(0.0),
        };
        let work = self.work * (1.0 + ahead * self.left);
        if work > self.most_work
            && let Some(appeal) = self.appeal.take()
        {
            self.most_work = appeal(self);
        }
        self.iterations >= self.limit || work > self.most_work
    }

    /// The program that it is for, by rows alone.
    pub fn problem_by_rows(&self) -> Problem {
        let part = |v: &[f64]| v.split_at(self.n).0.to_vec();
        let rest = |v: &[f64]| v.split_at(self.n).1.to_vec();
        Problem {
            cost: part(&self.cost),
            lower: part(&self.lower),
            upper: part(&self.upper),
            row_lower: rest(&self.lower),
            row_upper: rest(&self.upper),
            rows: (*self.rows).clone(),
            ..Problem::default()
        }
    }

    /// Adds the work of a pivot: `passed` numbers, and sparse solves whose solutions have so many `entries`.
    fn add_work(&mut self, passed: usize, entries: usize) {
        let factor = self.factor.as_ref().map_or(0, Factor::nonzeros) as f64;
        let solves = entries as f64 * (1.0 + factor / self.m as f64);
        let passed = passed + PIVOT_WORK[0] + PIVOT_WORK[1] * self.m;
        self.work += (passed + self.row_index.len()) as f64 + solves;
    }

    /// Replaces the variable in a slot; `column` is the entering one's. Factorises afresh when that
    /// is due. None: numbers broke down.
    fn exchange(&mut self, slot: usize, entering: usize) -> Option<()> {
        let leaving = self.head[slot] as usize;
        self.slot[leaving] = NONBASIC;
        self.slot[entering] = slot as u32;
        self.head[slot] = entering as u32;
        self.d[entering] = 0.0;
        if let Some(pivots) = &mut self.pivots {
            let terms = self.cost.iter().zip(&self.x).map(|(c, x)| c * x);
            pivots.push(Pivot {
                leaving,
                entering,
                objective: terms.sum(),
            });
        }
        let column = self.column(entering);
        let factor = self.factor.as_mut()?;
        let updated = factor.replace(slot, &column);
        self.refused_updates = if updated { 0 } else { self.refused_updates + 1 };
        if !updated || factor.is_worn() {
            return self.refactor();
        }
        Some(())
    }
}

/// A fixed pseudo-random number in [0.5, 1) for each variable.
pub(super) fn jitter(j: usize) -> f64 {
    let mut h = (j as u64).wrapping_add(0x9e37_79b9_7f4a_7c15);
    h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    h ^= h >> 31;
    0.5 + (h >> 12) as f64 / (1u64 << 53) as f64
}
