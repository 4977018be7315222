//! Linear programs whose pairs couple two systems that share nothing else.
//!
//! In limit analysis the pairs join the statics (stresses, load factor) to the kinematics (rates of
//! motion): y(x) ⟂ z, and no equation has both x and z in it. In general: cut the pairs; what still
//! hangs together by rows and columns are components; if every pair joins components of different
//! *sides*, and the objective's component is on the first side A, then for a given point of one side
//! the pairs are nothing but bounds on the other. So
//!
//! * the value is α(S) = min { objective : A, pieces that B's point allows }, a linear program, and it
//!   depends on B's point only through the set S of the pairs that it makes binding (its *support*);
//! * fewer binding pairs give a smaller α.
//!
//! **Stationarity.** Near a point of B the support can only grow. So the optimum of A's program on the
//! support of B's point is a local minimum of the whole (in the topology of both), proved by that
//! one linear program and its multipliers, with no enumeration of the biactive pairs.

use super::pairs::{Pair, Piece, Program};
use crate::solve::lp::Ended;
use crate::solve::lp::form::Problem;
use crate::solve::lp::simplex::{Basis, Simplex};

/// A value this close to a bound is on it. Simplex solutions have their nonbasic variables exactly
/// there; this is for degenerate basic ones.
const ZERO: f64 = 1e-9;

/// One of the two systems.
pub struct Side {
    simplex: Simplex,
    problem: Problem,
    /// Column of the instance of each column.
    pub columns: Vec<usize>,
    /// Row of the instance of each row.
    pub rows: Vec<usize>,
    /// Variable of each pair: a column, or n + a row.
    variable: Vec<usize>,
    /// Whether it is the row of the pair that is on this side.
    has_row: Vec<bool>,
}

/// A solution of one side.
#[derive(Clone, Debug)]
pub struct Point {
    /// Of the side's columns.
    pub x: Vec<f64>,
    /// Cost, without what was added to it.
    pub value: f64,
    /// The variable of each pair: x, or F.
    pub pair: Vec<f64>,
    /// Derivative of the cost with respect to it, where it rests at a bound.
    pub reduced: Vec<f64>,
}

/// What came of a program that was to be solved quickly.
pub enum Retry {
    /// Its solution.
    Solved(Point),
    /// It is infeasible, or its value is above the cut.
    Nothing,
    /// It takes longer.
    Unfinished,
}

/// Both sides.
pub struct Split {
    /// With the objective.
    pub a: Side,
    /// The other one.
    pub b: Side,
    /// The pairs.
    pub pairs: Vec<Pair>,
}

impl Split {
    /// None if the program is not linear or does not come apart.
    pub fn new(program: &Program) -> Option<Self> {
        let place = sides(program)?;
        let make = |which: bool| Side::new(program, &place, which);
        Some(Self {
            a: make(true),
            b: make(false),
            pairs: program.pairs.clone(),
        })
    }

    /// The pieces that a point of a side allows the other one; for a point on several the one that
    /// restricts the other side least.
    pub fn pieces(&self, side: &Side, point: &Point) -> Vec<Piece> {
        let piece = |k: usize| {
            let v = point.pair[k];
            let (l, u) = (self.pairs[k].lower, self.pairs[k].upper);
            if side.has_row[k] {
                if v > ZERO {
                    Piece::Lower
                } else if v < -ZERO {
                    Piece::Upper
                } else {
                    Piece::Inside
                }
            } else if l.is_finite() && v - l <= ZERO * l.abs().max(1.0) {
                Piece::Lower
            } else if u.is_finite() && u - v <= ZERO * u.abs().max(1.0) {
                Piece::Upper
            } else {
                Piece::Inside
            }
        };
        (0..self.pairs.len()).map(piece).collect()
    }

    /// Bounds of side A under which the pairs are on the given pieces.
    pub fn allow(&mut self, pieces: &[Piece], rhs: &[f64]) {
        for (k, &piece) in pieces.iter().enumerate() {
            self.a.restrict(k, Some(piece), &self.pairs[k], rhs[k]);
        }
    }

    /// Pairs whose piece, given by a point of `side`, restricts the other side.
    pub fn binds(&self, side: &Side, k: usize, piece: Piece) -> bool {
        side.has_row[k] != (piece == Piece::Inside)
    }

    /// Weights on the pairs' variables of the other side under which the sum of products with this
    /// side's point is least where it is 0; up to a constant.
    pub fn weights(&self, side: &Side, point: &Point) -> Vec<f64> {
        let weight = |k: usize| {
            let v = point.pair[k];
            let (l, u) = (self.pairs[k].lower, self.pairs[k].upper);
            match side.has_row[k] {
                // F·x
                true if v.abs() > ZERO => v,
                true => 0.0,
                // (x − l)·F, with F ≥ 0; −(u − x)·F, with F ≤ 0
                false if u.is_infinite() && v - l > ZERO => v - l,
                false if l.is_infinite() && u - v > ZERO => v - u,
                false => 0.0,
            }
        };
        (0..self.pairs.len()).map(weight).collect()
    }

    /// Σ |F|·distance over the pairs.
    pub fn gap(&self, a: &Point, b: &Point) -> f64 {
        let product = |k: usize| {
            let (x, f) = match self.a.has_row[k] {
                true => (b.pair[k], a.pair[k]),
                false => (a.pair[k], b.pair[k]),
            };
            let (l, u) = (self.pairs[k].lower, self.pairs[k].upper);
            let room = if f > 0.0 { x - l } else { u - x };
            if f.abs() <= ZERO || room.abs() <= ZERO {
                0.0
            } else {
                (f * room).abs()
            }
        };
        (0..self.pairs.len()).map(product).sum()
    }
}

/// Which columns (0 … n−1) and rows (n … n+m−1) are on the objective's side; None if the program is not
/// linear or does not come apart.
pub fn sides(program: &Program) -> Option<Vec<bool>> {
    let instance = &program.envelope;
    if !instance.is_linear() || program.pairs.is_empty() {
        return None;
    }
    let z = instance.objective?.column as usize;
    let (m, n) = (instance.row_count(), instance.column_count());
    // Components by union of columns (0 … n−1) and rows (n … n+m−1).
    let mut parent: Vec<usize> = (0..n + m).collect();
    for i in 0..m {
        for (j, _) in instance.matrix.row(i) {
            if instance.columns.lower[j] < instance.columns.upper[j] {
                join(&mut parent, j, n + i);
            }
        }
    }
    // Sides by walking along the pairs from the objective's component.
    let mut joined: Vec<Vec<usize>> = vec![Vec::new(); n + m];
    for p in &program.pairs {
        let (a, b) = (root(&mut parent, p.column), root(&mut parent, n + p.row));
        joined[a].push(b);
        joined[b].push(a);
    }
    let mut side: Vec<Option<bool>> = vec![None; n + m];
    let mut queue = Vec::new();
    // What no pair joins to the objective may be anywhere.
    for start in std::iter::once(z).chain(0..n + m) {
        let r = root(&mut parent, start);
        if side[r].is_none() {
            side[r] = Some(true);
            queue.push(r);
        }
        while let Some(c) = queue.pop() {
            for &d in &joined[c] {
                if side[d].is_none() {
                    side[d] = side[c].map(|here| !here);
                    queue.push(d);
                } else if side[d] == side[c] {
                    return None;
                }
            }
        }
    }
    let on_a = |k: usize| side[root(&mut parent, k)] == Some(true);
    Some((0..n + m).map(on_a).collect())
}

/// Unites the sets of two members.
pub(super) fn join(parent: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a] = b;
}

/// The representative of k's set in a union of disjoint sets.
pub(super) fn root(parent: &mut [usize], mut k: usize) -> usize {
    while parent[k] != k {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    k
}

impl Side {
    fn new(program: &Program, on_a: &[bool], which: bool) -> Self {
        let instance = &program.envelope;
        let (m, n) = (instance.row_count(), instance.column_count());
        let columns: Vec<usize> = (0..n).filter(|&j| on_a[j] == which).collect();
        let rows: Vec<usize> = (0..m).filter(|&i| on_a[n + i] == which).collect();
        let mut column_at = vec![usize::MAX; n];
        let mut row_at = vec![usize::MAX; m];
        columns
            .iter()
            .enumerate()
            .for_each(|(k, &j)| column_at[j] = k);
        rows.iter().enumerate().for_each(|(k, &i)| row_at[i] = k);
        // Fixed columns of the other side are constants here.
        let whole = Problem::of(instance);
        let problem = whole.part(&columns, &rows, &whole.lower);
        // F is the activity minus this, which stands in the row's bounds where they are finite.
        let has_row: Vec<bool> = program
            .pairs
            .iter()
            .map(|p| row_at[p.row] != usize::MAX)
            .collect();
        let variable = program
            .pairs
            .iter()
            .zip(&has_row)
            .map(|(p, &row)| match row {
                true => columns.len() + row_at[p.row],
                false => column_at[p.column],
            });
        Self {
            variable: variable.collect(),
            has_row,
            simplex: engine(&problem),
            columns,
            rows,
            problem,
        }
    }
}

/// Updates of a factor after which values are still computed with it. What is sought is a support, and the
/// final branch is solved afresh.
const TRUSTED: usize = 30;

fn engine(problem: &Problem) -> Simplex {
    let mut out = Simplex::new(problem);
    out.trusted = TRUSTED;
    out
}

/// Right-hand sides of the pairs' rows, for [`Side::solve`].
pub fn shifts(program: &Program) -> Vec<f64> {
    let rhs = &program.instance.rows.rhs;
    program.pairs.iter().map(|p| rhs[p.row]).collect()
}

impl Side {
    fn n(&self) -> usize {
        self.problem.n()
    }

    /// The side's part of a point of the program.
    pub fn point_at(&self, level: &[f64], rhs: &[f64]) -> Point {
        let x: Vec<f64> = self.columns.iter().map(|&j| level[j]).collect();
        let value = x.iter().zip(&self.problem.cost).map(|(x, c)| x * c).sum();
        let pair = self.pairs_at(&x, rhs);
        Point {
            reduced: vec![0.0; pair.len()],
            x,
            value,
            pair,
        }
    }

    fn pairs_at(&self, x: &[f64], rhs: &[f64]) -> Vec<f64> {
        let n = self.n();
        let at = |(k, &v): (usize, &usize)| match v < n {
            true => x[v],
            false => {
                let line = self.problem.rows.line(v - n);
                line.map(|(j, a)| a * x[j]).sum::<f64>() - rhs[k]
            }
        };
        self.variable.iter().enumerate().map(at).collect()
    }

    /// The engine with the present bounds and costs, and the basis of all rows.
    fn fresh(&self) -> Simplex {
        let mut out = engine(&self.problem);
        out.copy_data(&self.simplex);
        out
    }

    /// Sets the bounds of pair k to those of a piece, or to the envelope's.
    pub fn restrict(&mut self, k: usize, piece: Option<Piece>, pair: &Pair, rhs: f64) {
        let [x, f] = pair.ranges(piece, (pair.lower, pair.upper), rhs);
        let (lo, hi) = if self.has_row[k] { f } else { x };
        self.simplex.set_bounds(self.variable[k], lo, hi);
    }

    /// Costs: the objective times `weight` plus a cost on each pair's variable.
    pub fn price(&mut self, weight: f64, pairs: &[f64]) {
        for (j, c) in self.problem.cost.iter().enumerate() {
            self.simplex.set_cost(j, weight * c);
        }
        for i in 0..self.problem.m() {
            self.simplex.set_cost(self.problem.n() + i, 0.0);
        }
        for (k, &w) in pairs.iter().enumerate() {
            let v = self.variable[k];
            let own = if v < self.problem.n() {
                weight * self.problem.cost[v]
            } else {
                0.0
            };
            self.simplex.set_cost(v, own + w);
        }
    }

    /// Points with a greater value do not count.
    pub fn cap(&mut self, value: f64) {
        for (j, &c) in self.problem.cost.iter().enumerate().filter(|e| *e.1 != 0.0) {
            let (l, u) = (self.problem.lower[j], self.problem.upper[j]);
            match c > 0.0 {
                true => self.simplex.set_bounds(j, l, u.min(value / c).max(l)),
                false => self.simplex.set_bounds(j, l.max(value / c).min(u), u),
            }
        }
    }

    /// The present basis: states of the columns and of the rows.
    pub fn basis(&self) -> (Basis, Basis) {
        let mut columns = self.simplex.basis();
        let rows = columns.split_off(self.n());
        (columns, rows)
    }

    /// The present state, to come back to.
    pub fn mark(&self) -> Simplex {
        self.simplex.clone()
    }

    /// Comes back to a state; iterations go on counting.
    pub fn back(&mut self, mark: &Simplex) {
        let iterations = self.simplex.iterations;
        self.simplex.clone_from(mark);
        self.simplex.iterations = iterations;
    }

    /// Solves from the present basis. None: infeasible, unbounded, or not solved.
    pub fn solve(
        &mut self,
        rhs: &[f64],
        stop: &mut dyn FnMut(u64) -> Option<Ended>,
    ) -> Option<Point> {
        // A restart takes few iterations. One that does not is not waited for: a fresh start may do.
        let size = (self.problem.m() + self.n()) as u64;
        for (most, again) in [(200 + size / 4, false), (800 + size, true)] {
            if again {
                self.simplex = self.fresh();
            }
            let most = self.simplex.iterations + most;
            let ended = self.simplex.solve(&mut |i| match i > most {
                true => Some(Ended::Iterations),
                false => stop(i),
            });
            let cut = self.simplex.cutoff.is_finite() && self.simplex.iterations <= most;
            match ended {
                Ended::Solved => return Some(self.point(rhs)),
                Ended::Iterations | Ended::Failed if !cut => {}
                _ => return None,
            }
        }
        None
    }

    /// Solves in at most so many iterations after a small change.
    pub fn retry(&mut self, most: u64, rhs: &[f64]) -> Retry {
        let end = self.simplex.iterations + most;
        match self.simplex.retry(most) {
            Ended::Solved => Retry::Solved(self.point(rhs)),
            Ended::Infeasible(_) => Retry::Nothing,
            Ended::Iterations if self.simplex.iterations < end => Retry::Nothing,
            _ => Retry::Unfinished,
        }
    }

    /// The point of the present basis.
    fn point(&self, rhs: &[f64]) -> Point {
        let x = self.simplex.values()[..self.n()].to_vec();
        let reduced = self.simplex.reduced();
        Point {
            value: x.iter().zip(&self.problem.cost).map(|(x, c)| x * c).sum(),
            pair: self.pairs_at(&x, rhs),
            reduced: self.variable.iter().map(|&v| reduced[v]).collect(),
            x,
        }
    }

    /// Programs whose value is above this may be given up.
    pub fn cut_above(&mut self, value: f64) {
        self.simplex.cutoff = value;
    }

    /// Whether it is the row of the pair that is on this side.
    pub fn has_row(&self, k: usize) -> bool {
        self.has_row[k]
    }

    /// Simplex iterations so far.
    pub fn iterations(&self) -> u64 {
        self.simplex.iterations
    }
}
