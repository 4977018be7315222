//! B-stationarity: no direction leads downhill, to first order, without leaving the pieces.
//!
//! At a feasible point the pairs with F ≠ 0 or x off its bounds are on one piece only; the others
//! are *biactive*. With everything linearised and only what is active kept, the directions d form a
//! linear program with complementarity constraints over the biactive pairs (LPEC; Luo, Pang & Ralph
//! 1996; Nurkanović & Leyffer 2025):
//!
//! ```text
//!     min ∇fᵀd,   active rows and bounds,   0 ≤ dₓ ⟂ ∇Fᵀd ≥ 0 for biactive pairs,   |dⱼ| ≤ max(1, |xⱼ|)
//! ```
//!
//! Its value is 0 (d = 0) if and only if the point is B-stationary. Often already the relaxation
//! without the products has the value 0: the point is then strongly stationary, and one linear program
//! proves it. Otherwise branch and bound over the biactive pairs decides, up to a number of nodes. A
//! direction with a negative value refutes, and names the branch in which the search continues.
//!
//! With the objective written in terms of the other columns the LPEC often comes apart: what no active row
//! and no pair joins is searched by itself, for the value is the sum of the parts' values, and no part's is
//! above 0. Ten pairs that do not meet then cost ten times three nodes, not 2¹⁰.

use super::pairs::{Pair, Piece, Program};
use super::split::{join, root};
use super::tree::{Limits, Lpcc};
use crate::autodiff::Evaluator;
use crate::model::instance::Relation;
use crate::solve::lp::Ended;
use crate::solve::lp::form::Problem;

/// What is closer to a bound than this, relative to its size, is on it.
const ACTIVE: f64 = 1e-6;

/// A slope up to this, relative to the size of the objective, is rounding.
const SLOPE: f64 = 1e-6;

/// What is known about a point.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// No direction leads downhill.
    Proved,
    /// This one does.
    Refuted {
        /// One entry per column; |dⱼ| ≤ max(1, |xⱼ|).
        direction: Vec<f64>,
        /// Change of the (minimised) objective along it.
        slope: f64,
        /// The branch it leads into.
        pieces: Vec<Piece>,
    },
    /// The search was not finished.
    NotProved,
}

/// Checks a feasible point.
pub fn check(
    program: &Program,
    level: &[f64],
    nodes: usize,
    stop: &mut dyn FnMut(u64) -> Option<Ended>,
) -> Verdict {
    let Some((problem, pairs, index)) = linearise(program, level) else {
        return Verdict::NotProved;
    };
    let scale = problem.cost.iter().fold(1.0f64, |s, c| s.max(c.abs()))
        * program.objective(level).abs().max(1.0);
    let tolerance = SLOPE * scale;
    let objective = program.instance.objective.map(|o| o.column as usize);
    let defined = objective.and_then(|z| Defined::new(&problem, z));
    let (mut slope, mut direction) = (0.0, vec![0.0; problem.n()]);
    let (mut complete, mut left) = (true, nodes);
    for part in Part::all(&problem, &pairs, defined.as_ref()) {
        let rhs = vec![0.0; part.pairs.len()];
        let lpcc = Lpcc {
            problem: &part.problem,
            pairs: &part.pairs,
            rhs: &rhs,
        };
        let limits = Limits {
            nodes: left,
            cutoff: -tolerance,
            enough: -tolerance,
            gap: 0.0,
        };
        let found = lpcc.search(&limits, None, stop);
        left = left.saturating_sub(found.nodes).max(1);
        match found.best {
            Some((value, d)) => {
                slope += value;
                let entries = part.columns.iter().zip(d);
                entries.for_each(|(&j, d)| direction[j] = d);
            }
            None => complete &= found.complete,
        }
    }
    if slope < 0.0 {
        if let Some(defined) = defined {
            direction[defined.column] = defined.value(&problem, &direction);
        }
        let pieces = pieces(program, level, &problem, &index, &direction);
        return Verdict::Refuted {
            direction,
            slope,
            pieces,
        };
    }
    match complete {
        true => Verdict::Proved,
        false => Verdict::NotProved,
    }
}

/// The objective's column, where one equation says what it is and its bounds are far.
struct Defined {
    column: usize,
    row: usize,
    coefficient: f64,
}

impl Defined {
    fn new(problem: &Problem, column: usize) -> Option<Self> {
        let mut rows = problem.columns.line(column);
        let (row, coefficient) = rows.next()?;
        let defines = rows.next().is_none()
            && problem.row_lower[row] == problem.row_upper[row]
            && problem.lower[column] < 0.0
            && problem.upper[column] > 0.0;
        defines.then_some(Self {
            column,
            row,
            coefficient,
        })
    }

    /// Its entry of a direction, from the others.
    fn value(&self, problem: &Problem, d: &[f64]) -> f64 {
        let others = problem.rows.line(self.row).filter(|e| e.0 != self.column);
        -others.map(|(j, a)| a * d[j]).sum::<f64>() / self.coefficient
    }
}

/// A part of the LPEC that no active row and no pair joins to the rest.
struct Part {
    problem: Problem,
    pairs: Vec<Pair>,
    /// Its columns in the whole.
    columns: Vec<usize>,
}

impl Part {
    /// The parts in which the objective can fall.
    fn all(problem: &Problem, pairs: &[Pair], defined: Option<&Defined>) -> Vec<Self> {
        let (m, n) = (problem.m(), problem.n());
        let mut problem = problem.clone();
        if let Some(z) = defined {
            let price = problem.cost[z.column];
            for (j, a) in problem.rows.line(z.row) {
                problem.cost[j] -= price * a / z.coefficient;
            }
        }
        let leaves = |j: usize| problem.lower[j] == problem.upper[j];
        // Rows of pairs count whatever their own bounds.
        let finite =
            |i: usize| problem.row_lower[i].is_finite() || problem.row_upper[i].is_finite();
        let mut active: Vec<bool> = (0..m).map(finite).collect();
        pairs.iter().for_each(|p| active[p.row] = true);
        defined.iter().for_each(|z| active[z.row] = false);
        let mut parent: Vec<usize> = (0..n + m).collect();
        for i in (0..m).filter(|&i| active[i]) {
            let moving = problem.rows.line(i).filter(|e| !leaves(e.0));
            moving.for_each(|(j, _)| join(&mut parent, j, n + i));
        }
        pairs
            .iter()
            .for_each(|p| join(&mut parent, p.column, n + p.row));
        let mut number = vec![usize::MAX; n + m];
        let mut parts: Vec<(Vec<usize>, Vec<usize>)> = Vec::new();
        for j in (0..n).filter(|&j| problem.cost[j] != 0.0 && !leaves(j)) {
            let r = root(&mut parent, j);
            if number[r] == usize::MAX {
                number[r] = parts.len();
                parts.push((Vec::new(), Vec::new()));
            }
        }
        for k in (0..n + m).filter(|&k| k >= n || !leaves(k)) {
            if let Some((columns, rows)) = parts.get_mut(number[root(&mut parent, k)]) {
                if k < n {
                    columns.push(k)
                } else {
                    rows.push(k - n)
                }
            }
        }
        let mut place = vec![usize::MAX; n + m];
        for (columns, rows) in &parts {
            columns.iter().enumerate().for_each(|(k, &j)| place[j] = k);
            rows.iter().enumerate().for_each(|(k, &i)| place[n + i] = k);
        }
        let mut out: Vec<Self> = Vec::new();
        for (columns, rows) in parts {
            out.push(Self {
                // what leaves is fixed at 0, and what is in other parts costs nothing here
                problem: problem.part(&columns, &rows, &vec![0.0; n]),
                pairs: Vec::new(),
                columns,
            });
        }
        for p in pairs {
            if let Some(part) = out.get_mut(number[root(&mut parent, p.column)]) {
                part.pairs.push(Pair {
                    column: place[p.column],
                    row: place[n + p.row],
                    ..*p
                });
            }
        }
        out
    }
}

/// The linearised program in d, the biactive pairs, and which pairs of the program they are.
fn linearise(program: &Program, level: &[f64]) -> Option<(Problem, Vec<Pair>, Vec<usize>)> {
    let instance = program.instance;
    let n = instance.column_count();
    let activity = program.activity(level);
    let slopes = Evaluator::first_order(instance).jacobian_rows(level).ok()?;
    let values = slopes.iter().flatten().map(|(_, v)| v);
    if values.chain(&activity).any(|v| !v.is_finite()) {
        return None;
    }
    let inf = f64::INFINITY;
    let mut p = Problem {
        cost: vec![0.0; n],
        ..Problem::default()
    };
    let objective = instance.objective.map(|o| o.column as usize);
    for (j, &x) in level.iter().enumerate() {
        let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
        let size = x.abs().max(1.0);
        let room = if Some(j) == objective {
            1e6 * size
        } else {
            size
        };
        let near = |b: f64| (x - b).abs() <= ACTIVE * size;
        p.lower.push(if near(l) { 0.0 } else { -room });
        p.upper.push(if near(u) { 0.0 } else { room });
    }
    if let Some(z) = objective {
        p.cost[z] = program.sign();
    }
    for (i, mut entries) in slopes.into_iter().enumerate() {
        entries.sort_unstable_by_key(|e| e.0);
        p.rows.push(entries);
        let b = instance.rows.rhs[i];
        let slack = activity[i] - b;
        let binds = slack.abs() <= ACTIVE * activity[i].abs().max(b.abs()).max(1.0);
        let (lo, hi) = match program.envelope.rows.relation[i] {
            Relation::Equal => (0.0, 0.0),
            Relation::Greater if binds => (0.0, inf),
            Relation::Less if binds => (-inf, 0.0),
            _ => (-inf, inf),
        };
        p.row_lower.push(lo);
        p.row_upper.push(hi);
    }
    p.columns = p.rows.transpose(n);
    let (mut pairs, mut index) = (Vec::new(), Vec::new());
    for (k, pair) in program.pairs.iter().enumerate() {
        let x = level[pair.column];
        let f = program.force(pair, &activity);
        let size = x.abs().max(1.0);
        let at_lower = (x - pair.lower).abs() <= ACTIVE * size;
        let at_upper = (pair.upper - x).abs() <= ACTIVE * size;
        let row_size = activity[pair.row].abs().max(1.0);
        let zero = f.abs() <= ACTIVE * row_size;
        match (zero, at_lower || at_upper) {
            // F = 0 and x between its bounds
            (true, false) => (p.row_lower[pair.row], p.row_upper[pair.row]) = (0.0, 0.0),
            // x at a bound
            (false, _) => {
                (p.lower[pair.column], p.upper[pair.column]) = (0.0, 0.0);
                (p.row_lower[pair.row], p.row_upper[pair.row]) = (-inf, inf);
            }
            (true, true) => {
                index.push(k);
                let (lower, upper) = (p.lower[pair.column], p.upper[pair.column]);
                pairs.push(Pair {
                    column: pair.column,
                    row: pair.row,
                    lower: if at_lower { lower } else { -inf },
                    upper: if at_upper { upper } else { inf },
                });
            }
        }
    }
    Some((p, pairs, index))
}

/// The branch that a direction leads into.
fn pieces(
    program: &Program,
    level: &[f64],
    problem: &Problem,
    biactive: &[usize],
    d: &[f64],
) -> Vec<Piece> {
    let mut out = program.nearest(level);
    for &k in biactive {
        let p = &program.pairs[k];
        let x = level[p.column];
        let df: f64 = problem.rows.line(p.row).map(|(j, a)| a * d[j]).sum();
        out[k] = if df.abs() > 1e-9 {
            if df > 0.0 { Piece::Lower } else { Piece::Upper }
        } else if d[p.column].abs() > 1e-9 {
            Piece::Inside
        } else if (x - p.lower).abs() <= (p.upper - x).abs() {
            Piece::Lower
        } else {
            Piece::Upper
        };
    }
    out
}
