//! The linear program for the working set: the linearisation, nonlinear variables within |dⱼ| ≤ ρ max(1, |xⱼ|).
//!
//! What is violated is elastic, at a price ν; what is satisfied stays so, which d = 0 does. A basis goes on from one program to
//! the next.

use super::MOST_PENALTY;
use super::equality::Working;
use super::point::{Frame, Point};
use crate::solve::Budget;
use crate::solve::lp::Ended;
use crate::solve::lp::form::{self, Problem};
use crate::solve::lp::scale::Scaling;
use crate::solve::lp::simplex::{Basis, Simplex, State};
use crate::solve::lp::{crossed_over, simplex_work};
use crate::solve::strategy::Strategies;

/// A program that takes so many times as much from the last basis as an interior point would is left to one, and to a crossover; where these
/// fail it goes on to the second number.
const MOST_WORK: [f64; 2] = [2.0, 20.0];

/// Of the program, in its units; and where that is not to be had, of derivatives that differ by many orders of magnitude. What is left of the
/// rows is left to later steps.
const TOLERANCES: [f64; 2] = [1e-7, 1e-5];

/// What is left of a violation counts from here on.
const SHORT: f64 = 1e-9;

/// States of the columns, of the two elastic variables of each row, and of the rows.
pub(super) struct Linear {
    columns: Basis,
    elastic: Vec<[State; 2]>,
    rows: Basis,
    /// Pivots that are left.
    pub(super) pivots: u64,
    /// Linear variables have a trust region too.
    pub(super) confined: bool,
    strategies: Strategies,
}

/// What a program is made of.
#[derive(Clone, Copy)]
pub(super) struct Aim {
    /// Price of what is violated.
    pub(super) penalty: f64,
    /// 0: nothing but the violations counts.
    pub(super) weight: f64,
    /// ρ.
    pub(super) radius: f64,
}

/// A solution.
pub(super) struct Step {
    pub(super) d: Vec<f64>,
    /// Multipliers of the rows.
    pub(super) lambda: Vec<f64>,
    /// The sum of what stays violated.
    pub(super) short: f64,
    pub(super) working: Working,
    /// Some variable is at the trust region.
    pub(super) confined: bool,
    /// Price of what is violated: what was asked for, or more where that left the program without a minimum.
    pub(super) penalty: f64,
}

impl Linear {
    /// What lies between its bounds is basic: at a vertex, and near one, that is the basis of the first program.
    pub(super) fn new(frame: &Frame, at: &Point, pivots: u64, strategies: Strategies) -> Self {
        let state = |v: f64, l: f64, u: f64| {
            let near = 1e-9 * v.abs().max(1.0);
            match (v - l > near, u - v > near) {
                (true, true) => State::Basic,
                (true, false) => State::Upper,
                _ => State::Lower,
            }
        };
        let column = |j: usize| state(at.x[j], frame.lower[j], frame.upper[j]);
        let row = |i: usize| state(at.values.g[i], frame.below[i], frame.above[i]);
        Self {
            columns: (0..frame.n).map(column).collect(),
            elastic: vec![[State::Lower; 2]; frame.m],
            rows: (0..frame.m).map(row).collect(),
            pivots,
            confined: false,
            strategies,
        }
    }

    /// None: not within the pivots that are left, or numbers broke down.
    pub(super) fn solve(
        &mut self,
        frame: &Frame,
        at: &Point,
        mut aim: Aim,
        budget: &Budget,
    ) -> Option<Step> {
        for everything in [false, true] {
            let mut program = Program::new(frame, at, aim, everything, self.confined);
            let mut ended = self.minimum(&program, budget);
            while let Ok(Err(Ended::Unbounded(_))) = &ended
                && !self.confined
            {
                // what is violated may be too cheap
                if aim.weight > 0.0 && aim.penalty < MOST_PENALTY && !program.elastic.is_empty() {
                    aim.penalty *= 10.0;
                } else {
                    self.confined = true;
                }
                program = Program::new(frame, at, aim, everything, self.confined);
                ended = self.minimum(&program, budget);
            }
            match ended {
                Ok(Ok((point, states))) => {
                    return Some(self.step(frame, at, aim, &program, &point, &states));
                }
                // Rounding only: then everything is elastic.
                Ok(Err(_)) if !everything => {}
                _ => return None,
            }
        }
        None
    }

    /// Err: no pivots are left. Ok(Err): there is no solution.
    fn minimum(
        &mut self,
        p: &Program,
        budget: &Budget,
    ) -> Result<Result<(form::Point, Basis), Ended>, ()> {
        let scaled = p.scaling.apply(&p.problem);
        let elastic = p.elastic.iter().map(|&(i, k)| self.elastic[i][k]);
        let columns = self.columns.iter().copied();
        let from = columns.chain(elastic).chain(self.rows.clone());
        let lower = p.problem.lower.iter().chain(&p.problem.row_lower);
        let upper = p.problem.upper.iter().chain(&p.problem.row_upper);
        // What was at its lower bound is where it has the shorter way to.
        let from: Basis = from
            .zip(lower.zip(upper))
            .map(|(state, (l, u))| match state {
                State::Lower if u.abs() < l.abs() => State::Upper,
                state => state,
            })
            .collect();
        let mut simplex = Simplex::new(&scaled);
        simplex.limit = self.pivots;
        simplex.warm = true;
        simplex.set_basis(&from);
        let work = simplex_work(&scaled);
        let limited = |simplex: &mut Simplex, most: f64| {
            simplex.most_work = most * work;
            let mut last = Ended::Failed;
            for tolerance in TOLERANCES {
                (simplex.tolerance, simplex.dual_tolerance) = (tolerance, tolerance);
                last = simplex.solve(&mut |_| budget.stop().map(Ended::from));
                if last != Ended::Failed {
                    break;
                }
            }
            last
        };
        let mut last = limited(&mut simplex, MOST_WORK[0]);
        if last == Ended::Iterations && simplex.iterations < self.pivots {
            match crossed_over(&scaled, self.strategies, budget) {
                Some(engine) => (last, simplex) = (Ended::Solved, engine),
                None => last = limited(&mut simplex, MOST_WORK[1]),
            }
        }
        self.pivots = self.pivots.saturating_sub(simplex.iterations);
        match last {
            Ended::Solved => Ok(match simplex.point() {
                Some(point) => Ok((p.scaling.restore(point), simplex.basis())),
                None => Err(Ended::Failed),
            }),
            Ended::Iterations | Ended::Time | Ended::Interrupted => Err(()),
            other => Ok(Err(other)),
        }
    }

    /// Reads a solution, and keeps its basis.
    fn step(
        &mut self,
        frame: &Frame,
        at: &Point,
        aim: Aim,
        program: &Program,
        point: &form::Point,
        states: &Basis,
    ) -> Step {
        let (n, e) = (frame.n, program.elastic.len());
        self.columns.copy_from_slice(&states[..n]);
        self.rows.copy_from_slice(&states[n + e..]);
        let mut pull = vec![0.0; frame.m];
        let mut short = 0.0;
        for (k, &(i, side)) in program.elastic.iter().enumerate() {
            self.elastic[i][side] = states[n + k];
            if point.x[n + k] > SHORT * at.values.g[i].abs().max(1.0) {
                short += point.x[n + k];
                pull[i] = aim.penalty * if side == 0 { -1.0 } else { 1.0 };
            }
        }
        let mut confined = false;
        let column = |j: usize| {
            let (l, u) = (program.problem.lower[j], program.problem.upper[j]);
            let (bound, to, here) = match states[j] {
                State::Lower => (frame.lower[j], frame.lower[j] - at.x[j], l),
                State::Upper => (frame.upper[j], frame.upper[j] - at.x[j], u),
                State::Basic | State::Free => return None,
            };
            confined |= to != here;
            (to == here).then_some(bound)
        };
        let column = (0..n).map(column).collect();
        let row = |i: usize| {
            let side = match states[n + e + i] {
                State::Lower => frame.below[i],
                State::Upper => frame.above[i],
                State::Basic | State::Free => return None,
            };
            (pull[i] == 0.0 && side.is_finite()).then_some(side)
        };
        let row = (0..frame.m).map(row).collect();
        Step {
            d: point.x[..n].to_vec(),
            lambda: point.y.iter().map(|y| -y).collect(),
            short,
            working: Working { column, row, pull },
            confined,
            penalty: aim.penalty,
        }
    }
}

/// The program: columns d, then what rows are violated by.
struct Program {
    problem: Problem,
    /// Row and side of each elastic variable: 0 for what is too low.
    elastic: Vec<(usize, usize)>,
    /// Columns in the units of the variables, bounds in that of the trust region: an entry that changes nothing there stays small, where
    /// geometric means would make it count.
    scaling: Scaling,
}

impl Program {
    fn new(frame: &Frame, at: &Point, aim: Aim, everything: bool, confined: bool) -> Self {
        let n = frame.n;
        let mut problem = Problem {
            cost: at.gradient.iter().map(|g| aim.weight * g).collect(),
            ..Problem::default()
        };
        for j in 0..n {
            let reach = match confined || frame.nonlinear[j] {
                true => aim.radius * at.unit(j),
                false => f64::INFINITY,
            };
            problem.lower.push((frame.lower[j] - at.x[j]).max(-reach));
            problem.upper.push((frame.upper[j] - at.x[j]).min(reach));
        }
        let mut elastic = Vec::new();
        for (i, &g) in at.values.g.iter().enumerate() {
            let missing = frame.missing(i, g);
            let (mut low, mut high) = (frame.below[i] - g, frame.above[i] - g);
            if missing == 0.0 && !frame.is_equation(i) {
                (low, high) = (low.min(0.0), high.max(0.0));
            }
            problem.row_lower.push(low);
            problem.row_upper.push(high);
            let sides = [
                (low.is_finite() && (everything || missing > 0.0), 0),
                (high.is_finite() && (everything || missing < 0.0), 1),
            ];
            let first = n + elastic.len();
            elastic.extend(sides.iter().filter(|s| s.0).map(|s| (i, s.1)));
            let sign = |side: usize| if side == 0 { 1.0 } else { -1.0 };
            let columns = (first..).zip(&elastic[first - n..]);
            let columns = columns.map(|(k, &(_, side))| (k, sign(side)));
            problem.rows.push(at.rows.line(i).chain(columns));
        }
        let total = n + elastic.len();
        problem.cost.resize(total, aim.penalty);
        problem.lower.resize(total, 0.0);
        problem.upper.resize(total, f64::INFINITY);
        problem.columns = problem.rows.transpose(total);
        let units: Vec<f64> = (0..n).map(|j| at.unit(j)).collect();
        Self {
            scaling: Scaling::of_steps(&problem, &units, aim.radius),
            problem,
            elastic,
        }
    }
}
