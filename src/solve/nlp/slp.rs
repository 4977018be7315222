//! Sequential linear programming: the way from a solution to the next one, and a start where an interior point finds no way.
//!
//! ```text
//!     φ(x) = f(x) + ν Σᵢ max(aᵢ − gᵢ(x), gᵢ(x) − bᵢ, 0)     over l ≤ x ≤ u
//! ```
//!
//! is made small by linear programs in a trust region (Fletcher & Sainz de la Maza 1989): f and g are replaced by
//! their linearisations at x, |dⱼ| ≤ Δ max(1, |xⱼ|), and the step is taken where φ falls by a part of what the program
//! promises; ν is twice the largest multiplier then, if the program can meet its rows. Bounds and linear rows are kept by the
//! simplex method, which moves along them where an interior point is stopped by them; where a solution is a vertex, convergence is quadratic and the multipliers prove it. Elsewhere the
//! steps get short, and what was reached serves as a start.

use super::problem::Nlp;
use super::quadratic::by_rows;
use crate::solve::Budget;
use crate::solve::lp::Ended;
use crate::solve::lp::form::{Point, Problem, Sparse};
use crate::solve::lp::scale::Scaling;
use crate::solve::lp::simplex::{Basis, Simplex, State};

/// What may be spent on it.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Linear programs.
    pub steps: u64,
    /// Pivots of the simplex method, all programs together, by the number of rows and columns.
    pub pivots: u64,
}

impl Effort {
    /// From anywhere.
    pub const FULL: Self = Self {
        steps: 100,
        pivots: 10,
    };
    /// From where an earlier solve ended.
    pub const NEAR: Self = Self {
        steps: 20,
        pivots: 2,
    };
}

/// Variables and constraints at most: the programs start from the last basis, but each is factorised afresh.
const LARGEST: usize = 10_000;
/// The penalty ν grows up to here.
const MOST_PENALTY: f64 = 1e9;
/// A step is taken from this part of the promised decrease on, and the trust region grows from the other on.
const TAKEN: f64 = 0.05;
const GOOD: f64 = 0.75;
/// A point with a larger number is a start for nothing.
const FARTHEST: f64 = 1e15;
/// A trust region this small is none.
const SMALLEST: f64 = 1e-9;

/// Where it ended.
#[derive(Debug)]
pub struct Run {
    /// Point.
    pub x: Vec<f64>,
    /// Multipliers λ of the constraints, L = f + λᵀg.
    pub lambda: Vec<f64>,
    /// Linear programs.
    pub steps: u64,
}

/// Functions at a point.
struct Values {
    f: f64,
    g: Vec<f64>,
}

impl Values {
    fn at(nlp: &mut dyn Nlp, x: &[f64]) -> Option<Self> {
        let mut g = vec![0.0; nlp.size().1];
        let f = nlp.objective(x)?;
        nlp.constraints(x, &mut g)?;
        (f.is_finite() && g.iter().all(|v| v.is_finite())).then_some(Self { f, g })
    }

    fn violation(&self, nlp: &dyn Nlp) -> f64 {
        let (a, b) = nlp.sides();
        let each = self.g.iter().zip(a.iter().zip(b));
        each.map(|(&g, (&a, &b))| (a - g).max(g - b).max(0.0)).sum()
    }
}

/// First derivatives at a point.
struct Slopes {
    gradient: Vec<f64>,
    rows: Sparse,
}

impl Slopes {
    fn at(nlp: &mut dyn Nlp, x: &[f64]) -> Option<Self> {
        let (n, m) = nlp.size();
        let mut gradient = vec![0.0; n];
        nlp.gradient(x, &mut gradient)?;
        let rows = by_rows(m, &nlp.jacobian_entries(x)?);
        let all = gradient.iter().chain(&rows.value);
        all.copied()
            .all(f64::is_finite)
            .then_some(Self { gradient, rows })
    }
}

/// Runs from the start point, with so much effort at most. None where the start has no values or derivatives,
/// where the problem is too large, and where it leads to infinity.
pub fn solve(nlp: &mut dyn Nlp, effort: Effort, budget: &Budget) -> Option<Run> {
    let (n, m) = nlp.size();
    if n + m > LARGEST {
        return None;
    }
    let mut x: Vec<f64> = nlp.start().to_vec();
    into_bounds(nlp, &mut x);
    let mut here = Values::at(nlp, &x)?;
    let mut slopes = Slopes::at(nlp, &x)?;
    let steepest = slopes.gradient.iter().fold(1.0_f64, |s, g| s.max(g.abs()));
    let mut run = Run {
        x: Vec::new(),
        lambda: vec![0.0; m],
        steps: 0,
    };
    let (mut penalty, mut radius) = (10.0 * steepest, 1.0);
    // of the violation in φ: the multipliers say what is enough
    let mut weight = 0.0;
    let mut basis = basis_at(nlp, &x, &here);
    let mut pivots = effort.pivots * (n + m) as u64;
    while run.steps < effort.steps && radius > SMALLEST && !budget.is_over() {
        run.steps += 1;
        let program = linearised(nlp, &x, &here, &slopes, penalty, radius);
        let Some((step, y)) = minimum(&program, &mut basis, &mut pivots, budget) else {
            break;
        };
        run.lambda = y.iter().map(|y| -y).collect();
        let elastic: f64 = step[n..].iter().sum();
        weight = match elastic > 1e-9 {
            true => penalty,
            false => y.iter().fold(weight, |w, y| w.max(2.0 * y.abs())),
        };
        let merit = |v: &Values, nlp: &dyn Nlp| v.f + weight * v.violation(nlp);
        let now = merit(&here, nlp);
        let slope: f64 = slopes.gradient.iter().zip(&step).map(|(g, d)| g * d).sum();
        let promised = now - (here.f + slope + weight * elastic);
        let mut next: Vec<f64> = x.iter().zip(&step).map(|(x, d)| x + d).collect();
        into_bounds(nlp, &mut next);
        let there = Values::at(nlp, &next);
        let small = promised <= 1e-10 * now.abs().max(1.0);
        let closer = |v: &Values| v.violation(nlp) < 0.5 * here.violation(nlp);
        if small && !there.as_ref().is_some_and(closer) {
            if elastic <= 1e-9 || penalty >= MOST_PENALTY {
                break;
            }
            // stationary for this penalty only
            (penalty, radius) = (10.0 * penalty, radius.max(1.0));
            continue;
        }
        let part = match &there {
            None => -1.0,
            // the last digits of the rows
            Some(_) if small => 1.0,
            Some(v) => (now - merit(v, nlp)) / promised,
        };
        let reach = x
            .iter()
            .zip(&step)
            .map(|(x, d)| (d / x.abs().max(1.0)).abs());
        let reach = reach.fold(0.0, f64::max);
        radius = match part {
            GOOD.. if reach > 0.99 * radius => 4.0 * radius,
            TAKEN.. => radius,
            _ => 0.25 * radius.min(reach),
        };
        if part < TAKEN {
            continue;
        }
        let Some((values, derivatives)) = there.zip(Slopes::at(nlp, &next)) else {
            break;
        };
        (x, here, slopes) = (next, values, derivatives);
        if x.iter().any(|x| x.abs() > FARTHEST) {
            return None;
        }
    }
    run.x = x;
    Some(run)
}

/// What lies between its bounds is basic: at a vertex, and near one, that is the basis of the first program.
fn basis_at(nlp: &dyn Nlp, x: &[f64], here: &Values) -> Basis {
    let state = |(&v, (&l, &u)): (&f64, (&f64, &f64))| {
        let near = 1e-9 * v.abs().max(1.0);
        match (v - l > near, u - v > near) {
            (true, true) => State::Basic,
            (true, false) => State::Upper,
            _ => State::Lower,
        }
    };
    let ((lower, upper), (a, b)) = (nlp.bounds(), nlp.sides());
    let columns = x.iter().zip(lower.iter().zip(upper)).map(state);
    let sides = a.iter().chain(b).filter(|v| v.is_finite()).count();
    let rows = here.g.iter().zip(a.iter().zip(b)).map(state);
    columns
        .chain(vec![State::Lower; sides])
        .chain(rows)
        .collect()
}

fn into_bounds(nlp: &dyn Nlp, x: &mut [f64]) {
    let (lower, upper) = nlp.bounds();
    for (x, (&l, &u)) in x.iter_mut().zip(lower.iter().zip(upper)) {
        *x = x.max(l).min(u);
    }
}

/// The linear program for the step: columns d, then what the sides of the rows are violated by.
fn linearised(
    nlp: &dyn Nlp,
    x: &[f64],
    here: &Values,
    slopes: &Slopes,
    penalty: f64,
    radius: f64,
) -> Problem {
    let n = x.len();
    let ((lower, upper), (a, b)) = (nlp.bounds(), nlp.sides());
    let mut program = Problem {
        cost: slopes.gradient.clone(),
        ..Problem::default()
    };
    for (j, &x) in x.iter().enumerate() {
        let reach = radius * x.abs().max(1.0);
        program.lower.push((lower[j] - x).max(-reach));
        program.upper.push((upper[j] - x).min(reach));
    }
    program.rows = Sparse::new();
    let mut k = n;
    for (i, &g) in here.g.iter().enumerate() {
        program.row_lower.push(a[i] - g);
        program.row_upper.push(b[i] - g);
        let sides = [(a[i].is_finite(), 1.0), (b[i].is_finite(), -1.0)];
        let elastic: Vec<(usize, f64)> = sides
            .iter()
            .filter(|s| s.0)
            .enumerate()
            .map(|(e, s)| (k + e, s.1))
            .collect();
        k += elastic.len();
        program.rows.push(slopes.rows.line(i).chain(elastic));
    }
    program.cost.resize(k, penalty);
    program.lower.resize(k, 0.0);
    program.upper.resize(k, f64::INFINITY);
    program.columns = program.rows.transpose(k);
    program
}

/// Solution and multipliers of a program, from a basis, which is renewed, or from that of all logicals. None: not within so
/// many pivots, which are taken off.
fn minimum(
    program: &Problem,
    basis: &mut Basis,
    pivots: &mut u64,
    budget: &Budget,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let scaling = Scaling::new(program);
    let scaled = scaling.apply(program);
    for from in [basis.clone(), Basis::new()] {
        let mut simplex = Simplex::new(&scaled);
        simplex.limit = *pivots;
        let ended = simplex.solve_from_basis(&from, &mut |_| budget.stop().map(Ended::from));
        *pivots = pivots.saturating_sub(simplex.iterations);
        if ended == Ended::Solved {
            let Point { x, y, .. } = scaling.restore(simplex.point()?);
            *basis = simplex.basis();
            return Some((x, y));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::instance::*;
    use crate::solve::Quiet;
    use crate::solve::nlp::problem::Problem;

    /// max 2x + y, x ≤ 3, in a disc of radius 5 around 0, or on its rim.
    fn circle(relation: Relation, start: [f64; 2]) -> Run {
        let square = |k| [Op::Var(k), Op::PowerInt(2)];
        let ops = square(0)
            .into_iter()
            .chain(square(1))
            .chain([Op::Add])
            .collect();
        let instance = Instance {
            columns: Columns {
                lower: vec![f64::NEG_INFINITY; 3],
                upper: vec![f64::INFINITY, 3.0, f64::INFINITY],
                level: vec![0.0, start[0], start[1]],
                marginal: vec![0.0; 3],
                scale: vec![1.0; 3],
                kind: vec![ColumnKind::Continuous; 3],
            },
            rows: Rows {
                relation: vec![Relation::Equal, relation],
                rhs: vec![0.0, 25.0],
                marginal: vec![0.0; 2],
                scale: vec![1.0; 2],
            },
            matrix: SparseRows {
                start: vec![0, 3, 3],
                column: vec![0, 1, 2],
                value: vec![1.0, -2.0, -1.0],
            },
            nonlinear: vec![KernelTerms {
                kernel: Kernel {
                    ops,
                    variables: 2,
                    constants: 0,
                },
                row: vec![1],
                coef: vec![1.0],
                columns: vec![1, 2],
                constants: vec![],
            }],
            objective: Some(Objective {
                column: 0,
                sense: Sense::Maximize,
            }),
            ..Instance::default()
        };
        let mut quiet = Quiet::default();
        let budget = Budget::unlimited(&mut quiet);
        solve(&mut Problem::new(&instance), Effort::FULL, &budget).expect("the problem is small")
    }

    #[test]
    fn a_vertex_is_reached_with_its_multipliers() {
        for relation in [Relation::Less, Relation::Equal] {
            for start in [[0.0, 0.0], [3.0, -40.0], [-1e4, 1e4]] {
                let run = circle(relation, start);
                let (x, y) = (run.x[0], run.x[1]);
                assert!(
                    x == 3.0 && (y.abs() - 4.0).abs() < 1e-12,
                    "{relation:?} {start:?}: {run:?}"
                );
                // 2 x + y is stationary on the lower half of the rim too
                assert!(
                    relation == Relation::Equal || y > 0.0,
                    "{relation:?} {start:?}: {run:?}"
                );
                assert!(
                    (run.lambda[0] - 0.5 / y).abs() < 1e-12,
                    "{relation:?} {start:?}: {run:?}"
                );
            }
        }
    }
}
