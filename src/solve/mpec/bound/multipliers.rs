//! Multipliers of a linear program for any objective, from one solution that has room.
//!
//! Multipliers y of `min cᵀx, L ≤ Ax ≤ U, l ≤ x ≤ u` prove something for *every* c as soon as some prove that
//! the program is bounded. With d the multipliers of the bounds, what is asked of v = (y, d) is
//!
//! ```text
//!     Aᵀy + d = c,   y_i, d_j of the sign that their side has.            M v = c,  σv ≥ 0
//! ```
//!
//! Let h satisfy M h = 0 with as many signs strict as can be ([`Multipliers::new`]: a linear program, Freund,
//! Roundy & Todd 1985), and let M w = c, its signs whatever they are. Then v = w + K h will do, with K large
//! enough. One sparse Cholesky factor of M H Mᵀ, H = diag |h|, gives the w that is least in the units of h for any c.
//! What h has none of is 0 in w too.
//!
//! All are pairs of numbers, refined with residuals in twice the working precision; what they prove is for
//! [`super::weak::bound`] to say, which trusts none of this.

use faer::Side;
use faer::prelude::{ColMut, Solve};
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};

use crate::solve::interval::{WideSum, two_sum};
use crate::solve::lp::form::{Problem, Sparse};
use crate::solve::lp::interior::{self, Aim};
use crate::solve::lp::simplex::Wide;
use crate::solve::lp::{Ended, Limits};

/// What a component of h must be to count.
const LEAST: f64 = 1e-6;

/// What is added to the diagonal, in units of its largest entry: equations may depend on each other.
const SHIFT: f64 = 1e-12;

/// One component of v.
#[derive(Clone, Copy)]
struct Entry {
    /// Row, or m + column.
    of: usize,
    /// +1: not negative, −1: not positive, 0: any.
    sign: f64,
}

/// See the module's text.
pub struct Multipliers<'p> {
    problem: &'p Problem,
    entries: Vec<Entry>,
    /// Mᵀ: for each component the equations it is in.
    terms: Sparse,
    /// M.
    equations: Sparse,
    /// Column of each equation.
    columns: Vec<usize>,
    /// What a unit of each component is worth: its side.
    price: Vec<f64>,
    /// h.
    room: Wide,
    /// |h|, 1 for components that may have any sign, 0 for those that are held at 0.
    weight: Vec<f64>,
    factor: Llt<usize, f64>,
}

impl<'p> Multipliers<'p> {
    /// None: no such h was found.
    pub fn new(
        p: &'p Problem,
        limits: &Limits,
        interrupted: &mut dyn FnMut() -> bool,
    ) -> Option<Self> {
        let sign = |low: f64, high: f64| match (low.is_finite(), high.is_finite()) {
            (true, false) => 1.0,
            (false, true) => -1.0,
            _ => 0.0,
        };
        let columns: Vec<usize> = (0..p.n())
            .filter(|&j| !(p.lower[j].is_finite() && p.upper[j].is_finite()))
            .collect();
        let mut place = vec![usize::MAX; p.n()];
        columns.iter().enumerate().for_each(|(e, &j)| place[j] = e);
        let mut entries = Vec::new();
        let mut terms = Sparse::new();
        for i in 0..p.m() {
            let (low, high) = (p.row_lower[i], p.row_upper[i]);
            if low.is_finite() || high.is_finite() {
                let sign = sign(low, high);
                entries.push(Entry { of: i, sign });
                let known = p.rows.line(i).filter(|e| place[e.0] != usize::MAX);
                terms.push(known.map(|(j, a)| (place[j], a)));
            }
        }
        for (e, &j) in columns.iter().enumerate() {
            let sign = sign(p.lower[j], p.upper[j]);
            if sign != 0.0 {
                let of = p.m() + j;
                entries.push(Entry { of, sign });
                terms.push([(e, 1.0)]);
            }
        }
        let equations = terms.transpose(columns.len());
        let price: Vec<f64> = entries.iter().map(|e| side(p, e.of)).collect();
        let room = central(&entries, &price, &terms, columns.len(), limits, interrupted)?;
        let weight: Vec<f64> = entries
            .iter()
            .zip(&room)
            .map(|(e, h)| match e.sign != 0.0 {
                true if h.abs() < LEAST => 0.0,
                true => h.abs(),
                false => 1.0,
            })
            .collect();
        let factor = normal(&terms, &equations, &weight)?;
        let mut out = Self {
            problem: p,
            entries,
            terms,
            equations,
            columns,
            price,
            room: (Vec::new(), Vec::new()),
            weight,
            factor,
        };
        let nothing = vec![0.0; p.n()];
        out.room = out.refined(&nothing, room)?;
        Some(out)
    }

    /// Columns of the program.
    pub fn columns(&self) -> usize {
        self.problem.n()
    }

    /// Multipliers y of the rows for an objective, from `near` if there are any that are nearly right; and the lower
    /// bound that they promise. None: there are none without the components that h has no room in.
    pub fn for_cost(&self, cost: &[f64], near: Option<&[f64]>) -> Option<(Wide, f64)> {
        let start = self.entries.iter().map(|e| match near {
            Some(y) if e.of < y.len() => y[e.of],
            Some(y) => {
                let j = e.of - y.len();
                let line = self.problem.columns.line(j);
                cost[j] - line.map(|(i, a)| a * y[i]).sum::<f64>()
            }
            None => 0.0,
        });
        let (mut high, mut low) = self.refined(cost, start.collect())?;
        let lacks = |(k, e): (usize, &Entry)| match e.sign == 0.0 || self.weight[k] == 0.0 {
            true => 0.0,
            false => -e.sign * high[k] / (e.sign * self.room.0[k]).max(f64::MIN_POSITIVE),
        };
        let lack = self.entries.iter().enumerate().map(lacks);
        let share = lack.fold(0.0f64, f64::max) * 1.001;
        for k in 0..high.len() {
            let (a, a_low) = two_product(share, self.room.0[k]);
            let (s, e) = two_sum(high[k], a);
            let rest = e + low[k] + a_low + share * self.room.1[k];
            (high[k], low[k]) = two_sum(s, rest);
        }
        let value = high.iter().zip(&self.price).map(|(v, p)| v * p).sum();
        let m = self.problem.m();
        let mut y = (vec![0.0; m], vec![0.0; m]);
        for (k, e) in self.entries.iter().enumerate().filter(|(_, e)| e.of < m) {
            (y.0[e.of], y.1[e.of]) = (high[k], low[k]);
        }
        Some((y, value))
    }

    /// M v = c, from a v that nearly does; None if that does not come to hold.
    fn refined(&self, cost: &[f64], mut high: Vec<f64>) -> Option<Wide> {
        let mut low = vec![0.0; high.len()];
        for (k, e) in self.entries.iter().enumerate() {
            if e.sign != 0.0 && self.weight[k] == 0.0 {
                high[k] = 0.0;
            }
        }
        let mut before = f64::INFINITY;
        for _ in 0..12 {
            let mut rest: Vec<f64> = (0..self.columns.len())
                .map(|e| {
                    let mut sum = WideSum::new(cost[self.columns[e]]);
                    for (k, a) in self.equations.line(e) {
                        sum.add_product(-a, high[k]);
                        sum.add_product(-a, low[k]);
                    }
                    sum.value().middle()
                })
                .collect();
            let size = rest.iter().fold(0.0f64, |s, r| s.max(r.abs()));
            if size == 0.0 || size > 0.5 * before {
                break;
            }
            before = size;
            self.factor
                .solve_in_place(ColMut::from_slice_mut(&mut rest).as_mat_mut());
            for k in 0..high.len() {
                let w: f64 = self.terms.line(k).map(|(e, a)| a * rest[e]).sum();
                let (s, e) = two_sum(high[k], w * self.weight[k]);
                (high[k], low[k]) = two_sum(s, e + low[k]);
            }
        }
        let size = high.iter().fold(1.0f64, |s, v| s.max(v.abs()));
        (before <= SOLVED * size).then_some((high, low))
    }
}

/// Residuals up to this, relative to the largest component, are none.
const SOLVED: f64 = 1e-14;

/// The finite side of a row, or (from m on) of a column.
fn side(p: &Problem, of: usize) -> f64 {
    let (low, high) = match of.checked_sub(p.m()) {
        None => (p.row_lower[of], p.row_upper[of]),
        Some(j) => (p.lower[j], p.upper[j]),
    };
    if low.is_finite() { low } else { high }
}

fn two_product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    (p, a.mul_add(b, -p))
}

/// M h = 0: as many components with room as can be, none needing more than 1; and as cheap as that is.
fn central(
    entries: &[Entry],
    price: &[f64],
    terms: &Sparse,
    equations: usize,
    limits: &Limits,
    interrupted: &mut dyn FnMut() -> bool,
) -> Option<Vec<f64>> {
    let mut by_column = Sparse::new();
    let mut q = Problem {
        row_lower: vec![0.0; equations],
        row_upper: vec![0.0; equations],
        ..Problem::default()
    };
    for (k, e) in entries.iter().enumerate() {
        let signed = e.sign != 0.0;
        let scale = if signed { e.sign } else { 1.0 };
        for share in if signed { &[true, false][..] } else { &[false] } {
            by_column.push(terms.line(k).map(|(e, a)| (e, scale * a)));
            q.cost
                .push(-PRICE * scale * price[k] - f64::from(u8::from(*share)));
            q.lower.push(if signed { 0.0 } else { f64::NEG_INFINITY });
            q.upper.push(if *share { 1.0 } else { f64::INFINITY });
        }
    }
    q.rows = by_column.transpose(equations);
    q.columns = by_column;
    let run = interior::solve(&q, None, Aim::Tolerance(1e-8), limits, interrupted);
    if run.ended != Ended::Solved {
        return None;
    }
    let mut x = run.point.x.into_iter();
    let out = entries.iter().map(|e| match e.sign == 0.0 {
        true => x.next(),
        false => Some(e.sign * (x.next()? + x.next()?)),
    });
    out.collect()
}

/// What a unit of −bᵀh costs beside a unit of room.
const PRICE: f64 = 1e-2;

/// The Cholesky factor of M diag(weight) Mᵀ.
fn normal(terms: &Sparse, equations: &Sparse, weight: &[f64]) -> Option<Llt<usize, f64>> {
    let n = equations.lines();
    let mut triplets = Vec::new();
    let mut row = vec![0.0; n];
    let mut top = 0.0f64;
    for e in 0..n {
        let mut touched = Vec::new();
        for (k, a) in equations.line(e) {
            for (f, b) in terms.line(k).filter(|t| t.0 >= e) {
                if row[f] == 0.0 {
                    touched.push(f);
                }
                row[f] += weight[k] * a * b;
            }
        }
        top = top.max(row[e]);
        touched.sort_unstable();
        touched.dedup();
        for f in touched {
            triplets.push(Triplet::new(f, e, row[f]));
            row[f] = 0.0;
        }
    }
    triplets.extend((0..n).map(|e| Triplet::new(e, e, SHIFT * top)));
    let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &triplets).ok()?;
    let symbolic = SymbolicLlt::try_new(matrix.symbolic(), Side::Lower).ok()?;
    Llt::try_new_with_symbolic(symbolic, matrix.as_ref(), Side::Lower).ok()
}
