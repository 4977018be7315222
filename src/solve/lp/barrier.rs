//! A primal-dual interior-point method for linear programs: Mehrotra's predictor and corrector (Mehrotra 1992).
//!
//! ```text
//!     min cᵀx   subject to   A x − s = 0,   l ≤ (x, s) ≤ u
//! ```
//!
//! Columns that are fixed are left out; an equation has a constant s. Every bound has a distance w > 0 and a
//! multiplier z > 0. Each Newton step is one quasi-definite system
//!
//! ```text
//!     [ −D − ρ   Aᵀ        ] [ Δx ]
//!     [  A       D_s⁻¹ + δ ] [ Δy ]        D = Σ z/w over the bounds of a variable
//! ```
//!
//! in the columns and the rows alone, whose factors exist for every order of the pivots (Vanderbei 1995): free and dense columns
//! need no care. The corrector has the weights, primal and dual, with which the step goes farthest (Colombo & Gondzio 2008). ρ and δ
//! shorten the steps, but move no solution: what is solved for is a step, not the point.

use super::Ended;
use super::form::{Point, Problem, Sparse};
use super::interior::Run;
use crate::solve::budget::Size;
use crate::solve::vector::{dot, largest};
use crate::solve::{Budget, Progress};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::amd::{self, FlopCount};
use faer::sparse::linalg::cholesky::simplicial::{
    prefactorize_symbolic_cholesky, prefactorize_symbolic_cholesky_scratch,
};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// ρ and δ where primal and dual variables are alike.
const REGULAR: f64 = 1e-9;

/// Else ρ is this divided by a power of the variables' ratio, 10⁴ at most, and δ times the same power of that. (At a power of 0 the points on walls are
/// right to 8 digits, at 1 to 10, at 1.5 to 11. With a ratio below 1, which makes ρ larger, D2Q06C of Netlib keeps dual residuals of 3e-7. With δ times
/// 10⁴ only, the reduced costs on a wall of 80 courses are right to 4e-12, else to 7e-13, and 1 700 pivots mend their signs, else 8.)
const STEEPER: f64 = 1.5;
const STEEPEST: f64 = 1e4;

/// What is left of a right-hand side, against its largest entry, when a solution is refined no more: as many iterations as with 1e-12, and half the
/// solves.
const SOLVED: f64 = 1e-8;

/// How often ρ and δ are taken 100 times as large where a factor breaks down.
const STABLER: usize = 3;

/// Iterations at most, and those that may pass until residuals and gap are halved: of a point that is good, and of others.
const MOST: u64 = 200;
const PATIENCE: [u64; 2] = [4, 12];
const GOOD: f64 = 1e-9;

/// A gap of so much of the tolerance is none: the residuals that are left stay.
const NOTHING: f64 = 1e-4;

/// Entries of a column that is long.
const LONG: usize = 100;

/// Operations for each entry from which on a second order of pivots is looked for. (Below, the search takes longer than what it saves: a fifth of the time on
/// MAROS-R7 and PILOT87 of Netlib, which have 1400.)
const DEAR: f64 = 10_000.0;

/// Lines with more entries than this times the root of their number come last, unsorted, as a rule; none where they make most of what is left.
const DENSE: f64 = 10.0;

/// The system without its short columns may have so many entries for each of the whole one: its factor has longer blocks, and takes half to three quarters of
/// the time (DFL001 and MAROS-R7 of Netlib, walls).
const LARGER: usize = 2;

/// A factor with at least so many operations for each entry, in faer's unit, is made in blocks.
const BLOCKS: SupernodalThreshold = SupernodalThreshold(0.7);

/// The least distance to a bound of a point that is inside.
const LEAST: f64 = 1e-10;

/// The part of the way to the next bound that a step goes, least and most.
const SHORT: [f64; 2] = [0.9, 1.0 - 1e-9];

/// What the product at that bound is to be, of the mean of all.
const LATE: f64 = 0.01;

/// Weights of the corrector that are tried.
const WEIGHTS: u32 = 9;

/// The program without its fixed columns: variables are the columns that are left, then the rows.
struct Program {
    n: usize,
    m: usize,
    rows: Sparse,
    columns: Sparse,
    cost: Vec<f64>,
    /// Within the bounds, as near to 0 as they allow.
    value: Vec<f64>,
    /// The variable of each bound, +1 for a lower and −1 for an upper one, and where it is.
    of: Vec<usize>,
    sign: Vec<f64>,
    side: Vec<f64>,
    /// Whether a variable is constant: the rows that are equations.
    constant: Vec<bool>,
}

impl Program {
    fn new(p: &Problem) -> (Self, Vec<usize>) {
        let kept: Vec<usize> = (0..p.n()).filter(|&j| p.lower[j] < p.upper[j]).collect();
        let all: Vec<usize> = (0..p.m()).collect();
        let part = p.part(&kept, &all, &p.lower);
        let (n, m) = (kept.len(), p.m());
        let mut cost = part.cost;
        cost.resize(n + m, 0.0);
        let columns = part.lower.iter().zip(&part.upper);
        let limits = columns.chain(part.row_lower.iter().zip(&part.row_upper));
        let mut out = Self {
            n,
            m,
            columns: part.columns,
            rows: part.rows,
            cost,
            value: Vec::with_capacity(n + m),
            of: Vec::new(),
            sign: Vec::new(),
            side: Vec::new(),
            constant: Vec::with_capacity(n + m),
        };
        for (k, (&l, &u)) in limits.enumerate() {
            out.value.push(0.0f64.max(l).min(u));
            out.constant.push(l == u);
            for (side, sign) in [(l, 1.0), (u, -1.0)] {
                if side.is_finite() && l < u {
                    out.of.push(k);
                    out.sign.push(sign);
                    out.side.push(side);
                }
            }
        }
        (out, kept)
    }

    fn bounds(&self) -> usize {
        self.of.len()
    }

    /// s − A x.
    fn primal_residuals(&self, value: &[f64]) -> Vec<f64> {
        let (x, s) = value.split_at(self.n);
        let of = |i: usize| s[i] - self.rows.line(i).map(|(j, a)| a * x[j]).sum::<f64>();
        (0..self.m).map(of).collect()
    }

    /// D = Σ z/w.
    fn curvature(&self, at: &Iterate) -> Vec<f64> {
        let mut d = vec![0.0; self.n + self.m];
        for (b, &k) in self.of.iter().enumerate() {
            d[k] += at.z[b] / at.w[b];
        }
        d
    }

    /// c − (A, −I)ᵀy − Σ ±z.
    fn dual_residuals(&self, y: &[f64], z: &[f64]) -> Vec<f64> {
        let mut r = self.cost.clone();
        for (i, &y) in y.iter().enumerate() {
            self.rows.line(i).for_each(|(j, a)| r[j] -= a * y);
            r[self.n + i] += y;
        }
        for (b, &k) in self.of.iter().enumerate() {
            r[k] -= self.sign[b] * z[b];
        }
        for (r, &constant) in r.iter_mut().zip(&self.constant) {
            if constant {
                *r = 0.0;
            }
        }
        r
    }
}

/// Where the method is, or a step from there.
#[derive(Clone)]
struct Iterate {
    value: Vec<f64>,
    y: Vec<f64>,
    /// Of each bound: distance and multiplier.
    w: Vec<f64>,
    z: Vec<f64>,
}

impl Iterate {
    /// Goes so much of a step, primal and dual.
    fn advance(&mut self, step: &Self, ways: [f64; 2]) {
        self.combine(step, ways, |v, s, way| v + way * s);
    }

    /// The mean of this step and another one, with so much weight, primal and dual.
    fn weigh(&mut self, other: &Self, weights: [f64; 2]) {
        self.combine(other, weights, mean);
    }

    fn combine(&mut self, other: &Self, [primal, dual]: [f64; 2], by: fn(f64, f64, f64) -> f64) {
        let parts = [
            (&mut self.value, &other.value, primal),
            (&mut self.w, &other.w, primal),
            (&mut self.y, &other.y, dual),
            (&mut self.z, &other.z, dual),
        ];
        for (v, other, factor) in parts {
            v.iter_mut()
                .zip(other)
                .for_each(|(v, o)| *v = by(*v, *o, factor));
        }
    }
}

/// Of a value, with this weight, and another.
fn mean(value: f64, other: f64, weight: f64) -> f64 {
    other + weight * (value - other)
}

/// The order of pivots by approximate minimum degree (Amestoy, Davis & Duff 1996), and what it costs.
fn minimum_degree(
    pattern: SymbolicSparseColMatRef<usize>,
    dense: f64,
) -> Option<(Vec<usize>, FlopCount)> {
    let order = pattern.ncols();
    let (mut fwd, mut inv) = (vec![0; order], vec![0; order]);
    let nonzeros = pattern.compute_nnz();
    let mut memory = MemBuffer::new(amd::order_maybe_unsorted_scratch::<usize>(order, nonzeros));
    let stack = MemStack::new(&mut memory);
    let control = amd::Control {
        dense,
        ..amd::Control::default()
    };
    let count = amd::order_maybe_unsorted(&mut fwd, &mut inv, pattern, control, stack);
    Some((fwd, count.ok()?))
}

/// The order of pivots by nested dissection (Karypis & Kumar 1998), and what it costs.
fn nested_dissection(pattern: SymbolicSparseColMatRef<usize>) -> Option<(Vec<usize>, FlopCount)> {
    let order = pattern.ncols();
    let pairs = || (0..order).flat_map(|k| pattern.row_idx_of_col(k).map(move |i| (i, k)));
    let both = |&(i, k): &(usize, usize)| i != k;
    let mut start = vec![0i32; order + 1];
    for (i, k) in pairs().filter(both) {
        start[i + 1] += 1;
        start[k + 1] += 1;
    }
    (0..order).for_each(|k| start[k + 1] += start[k]);
    let mut next = start.clone();
    let mut index = vec![0i32; start[order] as usize];
    for (i, k) in pairs().filter(both) {
        for (i, k) in [(i, k), (k, i)] {
            index[next[k] as usize] = i as i32;
            next[k] += 1;
        }
    }
    (0..order).for_each(|k| index[start[k] as usize..start[k + 1] as usize].sort_unstable());
    let whole = feral_metis::CscPattern::new(order, &start, &index)?;
    let fwd: Vec<usize> = feral_metis::metis_order(&whole)
        .ok()?
        .into_iter()
        .map(|i| i as usize)
        .collect();
    let mut inv = vec![0; order];
    fwd.iter().enumerate().for_each(|(k, &i)| inv[i] = k);
    let mut upper = vec![Vec::new(); order];
    for (i, k) in pairs() {
        upper[inv[i].max(inv[k])].push(inv[i].min(inv[k]));
    }
    let (mut start, mut index) = (vec![0], Vec::new());
    for mut column in upper {
        column.sort_unstable();
        index.extend(column);
        start.push(index.len());
    }
    let permuted = SymbolicSparseColMatRef::new_checked(order, order, &start, None, &index);
    let (mut tree, mut counts) = (vec![0isize; order], vec![0usize; order]);
    let scratch = prefactorize_symbolic_cholesky_scratch::<usize>(order, index.len());
    let mut memory = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut memory);
    prefactorize_symbolic_cholesky(&mut tree, &mut counts, permuted, stack);
    let below = counts.iter().map(|c| (c - 1) as f64);
    let count = FlopCount {
        n_div: below.clone().sum(),
        n_mult_subs_ldl: below.map(|c| c * (c + 1.0) / 2.0).sum(),
        n_mult_subs_lu: 0.0,
    };
    Some((fwd, count))
}

/// The cheaper of both orders, where the search for the second one may pay.
fn pivots(pattern: SymbolicSparseColMatRef<usize>, dense: f64) -> Option<(Vec<usize>, FlopCount)> {
    let first = minimum_degree(pattern, dense)?;
    let nonzeros = pattern.compute_nnz();
    // The search counts in 32 bits, and looks at a clock, which a browser lacks.
    let able = nonzeros < 1 << 30 && cfg!(not(target_family = "wasm"));
    if !able || first.1.n_mult_subs_ldl < DEAR * nonzeros as f64 {
        return Some(first);
    }
    let second = nested_dissection(pattern);
    let second = second.filter(|s| s.1.n_mult_subs_ldl < first.1.n_mult_subs_ldl);
    Some(second.unwrap_or(first))
}

/// Columns that can be eliminated one by one, before the factor is begun: those with bounds and few entries.
fn short(p: &Program) -> Vec<bool> {
    let mut short: Vec<bool> = (0..p.n).map(|j| p.columns.line(j).len() < LONG).collect();
    let mut bounded = vec![false; p.n + p.m];
    p.of.iter().for_each(|&k| bounded[k] = true);
    short.iter_mut().zip(bounded).for_each(|(s, b)| *s &= b);
    short
}

/// Where the entries of a program's Newton system are, the order of its pivots, and what a factor costs.
pub(super) struct Layout {
    /// The variables that are not eliminated before, how many of them are columns, and whether a column is eliminated.
    kept: Vec<usize>,
    long: usize,
    short: Option<Vec<bool>>,
    start: Vec<usize>,
    index: Vec<usize>,
    entries: Vec<f64>,
    pivots: Vec<usize>,
    /// Of a factor.
    pub(super) nonzeros: f64,
    pub(super) operations: f64,
}

impl Layout {
    pub(super) fn new(problem: &Problem) -> Option<Self> {
        Self::of(&Program::new(problem).0)
    }

    fn of(p: &Program) -> Option<Self> {
        let whole = p.rows.index.len() + p.n + p.m;
        let condensed = Self::without(p, Some(short(p)), LARGER * whole);
        condensed.or_else(|| Self::without(p, None, usize::MAX))
    }

    /// The layout without these columns. None: it would have more entries, or no order was found.
    fn without(p: &Program, short: Option<Vec<bool>>, most: usize) -> Option<Self> {
        let short = short.filter(|s| s.contains(&true));
        let is_kept = |k: &usize| short.as_ref().is_none_or(|s| *k >= p.n || !s[*k]);
        let kept: Vec<usize> = (0..p.n + p.m).filter(is_kept).collect();
        let (order, long) = (kept.len(), kept.len() - p.m);
        let mut place = vec![usize::MAX; p.n];
        kept[..long]
            .iter()
            .enumerate()
            .for_each(|(k, &j)| place[j] = k);
        let (mut start, mut index, mut entries) = (vec![0], Vec::new(), Vec::new());
        let mut met = vec![false; p.m];
        let mut operations = 0.0;
        for (k, &v) in kept.iter().enumerate() {
            if v >= p.n {
                let line = p.rows.line(v - p.n);
                for (j, a) in line.clone().filter(|e| place[e.0] != usize::MAX) {
                    index.push(place[j]);
                    entries.push(a);
                }
                let first = index.len();
                for (j, _) in line.filter(|e| place[e.0] == usize::MAX) {
                    for (i, _) in p.columns.line(j).take_while(|e| e.0 < v - p.n) {
                        operations += 1.0;
                        if !met[i] {
                            met[i] = true;
                            index.push(long + i);
                        }
                    }
                }
                index[first..].sort_unstable();
                index[first..].iter().for_each(|&i| met[i - long] = false);
            }
            index.push(k);
            entries.resize(index.len(), 0.0);
            start.push(index.len());
        }
        if index.len() > most {
            return None;
        }
        let pattern = SymbolicSparseColMatRef::new_checked(order, order, &start, None, &index);
        let mut length = vec![0usize; order];
        for k in 0..order {
            for &i in &index[start[k]..start[k + 1]] {
                length[i] += 1;
                length[k] += 1;
            }
        }
        let long_lines = length
            .iter()
            .filter(|&&c| c as f64 > DENSE * (order as f64).sqrt());
        let dense = match 2 * long_lines.count() > order {
            true => -1.0,
            false => DENSE,
        };
        let (fwd, count) = pivots(pattern, dense)?;
        Some(Self {
            operations: operations + count.n_mult_subs_ldl,
            nonzeros: count.n_div + order as f64,
            pivots: fwd,
            kept,
            long,
            short,
            start,
            index,
            entries,
        })
    }
}

/// The Newton system: the upper triangle by columns, and its factors, without the columns that are eliminated before: −D x + Aᵀy = b gives them, and what
/// they leave is A D⁻¹Aᵀ in the rows, D with ρ.
struct System {
    layout: Layout,
    /// 1/(D + ρ) of the columns, and room for a row.
    inverse: Vec<f64>,
    room: Vec<f64>,
    signs: Vec<i8>,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    memory: MemBuffer,
    /// D of the columns, 1/D of the rows (0 for equations).
    diagonal: Vec<f64>,
    /// ρ and δ where primal and dual variables are alike.
    regular: f64,
    /// Added to D of the columns, and to the diagonal of the rows.
    rho: f64,
    delta: f64,
    /// A refined solution was worse than none: the factor has broken down.
    unsound: bool,
}

impl System {
    fn new(p: &Program, known: Option<Layout>, budget: &Budget) -> Result<Self, Ended> {
        let known = known.or_else(|| Layout::of(p));
        let layout = known.ok_or(Ended::Failed)?;
        let (order, nonzeros) = (layout.kept.len(), layout.nonzeros);
        let size = || Size {
            what: "the factor of the Newton system",
            nonzeros,
            operations: 2.0 * layout.operations,
        };
        budget.affords(size).map_err(Ended::TooLarge)?;
        let (start, index) = (&layout.start, &layout.index);
        let pattern = SymbolicSparseColMatRef::new_checked(order, order, start, None, index);
        let mut inverse = vec![0; order];
        (layout.pivots.iter().enumerate()).for_each(|(k, &i)| inverse[i] = k);
        let by = PermRef::new_checked(&layout.pivots, &inverse, order);
        let by = SymmetricOrdering::Custom(by);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: BLOCKS,
            ..CholeskySymbolicParams::default()
        };
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Upper, by, params)
            .map_err(|_| Ended::Failed)?;
        let numeric = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
        let solve = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let memory = MemBuffer::try_new(numeric.or(solve)).map_err(|_| Ended::Failed)?;
        let mut signs = vec![-1; layout.long];
        signs.resize(order, 1);
        Ok(Self {
            signs,
            factor: vec![0.0; symbolic.len_val()],
            symbolic,
            memory,
            diagonal: Vec::new(),
            regular: REGULAR,
            rho: REGULAR,
            delta: REGULAR,
            layout,
            unsound: false,
            inverse: Vec::new(),
            room: vec![0.0; p.m],
        })
    }

    /// Takes ρ and δ in the units of a point. Where primal and dual variables differ by orders of magnitude, as forces and displacements of a
    /// wall do, one of the terms would drown the other equations.
    fn suit(&mut self, at: &Iterate) {
        let steep = largest(&at.value) / largest(&at.y).max(1e-10);
        let steep = steep.powf(STEEPER).clamp(1.0, STEEPEST);
        (self.rho, self.delta) = (self.regular / steep, self.regular * steep.powf(STEEPER));
    }

    /// Factorises for D of all variables.
    fn factorise(&mut self, p: &Program, d: &[f64]) -> Option<()> {
        self.unsound = false;
        self.diagonal.clear();
        for (k, &d) in d.iter().enumerate() {
            let entry = match (k < p.n, p.constant[k]) {
                (true, _) => d,
                (_, true) => 0.0,
                _ => 1.0 / d.max(1e-20),
            };
            self.diagonal.push(entry);
        }
        for (k, &v) in self.layout.kept.iter().enumerate() {
            self.layout.entries[self.layout.start[k + 1] - 1] = match v < p.n {
                true => -self.diagonal[v] - self.rho,
                false => self.diagonal[v] + self.delta,
            };
        }
        self.add_short(p);
        let order = self.layout.kept.len();
        let (start, index) = (&self.layout.start, &self.layout.index);
        let pattern = SymbolicSparseColMatRef::new_checked(order, order, start, None, index);
        let matrix = SparseColMatRef::new(pattern, &self.layout.entries);
        let regularization = LdltRegularization {
            dynamic_regularization_signs: Some(&self.signs),
            dynamic_regularization_delta: REGULAR,
            dynamic_regularization_epsilon: 1e-13,
        };
        let done = self.symbolic.factorize_numeric_ldlt(
            &mut self.factor,
            matrix,
            Side::Upper,
            regularization,
            Par::Seq,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
        done.ok().map(|_| ())
    }

    /// Adds what the eliminated columns leave in the rows.
    fn add_short(&mut self, p: &Program) {
        let Some(short) = &self.layout.short else {
            return;
        };
        let inverse = self.diagonal[..p.n].iter().map(|d| 1.0 / (d + self.rho));
        self.inverse = inverse.collect();
        for i in 0..p.m {
            for (j, a) in p.rows.line(i).filter(|e| short[e.0]) {
                let factor = a * self.inverse[j];
                let column = p.columns.line(j).take_while(|e| e.0 <= i);
                column.for_each(|(i, a)| self.room[i] += factor * a);
            }
            let line = self.layout.start[self.layout.long + i]
                ..self.layout.start[self.layout.long + i + 1];
            self.layout.entries[line.end - 1] += std::mem::take(&mut self.room[i]);
            for e in line.start..line.end - 1 {
                if self.layout.index[e] >= self.layout.long {
                    self.layout.entries[e] =
                        std::mem::take(&mut self.room[self.layout.index[e] - self.layout.long]);
                }
            }
        }
    }

    fn back(&mut self, p: &Program, b: &mut [f64]) {
        let order = self.layout.kept.len();
        let short = self.layout.short.as_ref();
        let short = short.map_or(Vec::new(), |s| (0..p.n).filter(|&j| s[j]).collect());
        for &j in &short {
            let by = b[j] * self.inverse[j];
            p.columns.line(j).for_each(|(i, a)| b[p.n + i] += a * by);
        }
        let mut x: Vec<f64> = self.layout.kept.iter().map(|&k| b[k]).collect();
        LdltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut x, order, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
        self.layout
            .kept
            .iter()
            .zip(&x)
            .for_each(|(&k, x)| b[k] = *x);
        for &j in &short {
            let terms = p.columns.line(j).map(|(i, a)| a * b[p.n + i]);
            b[j] = (terms.sum::<f64>() - b[j]) * self.inverse[j];
        }
    }

    /// b − K x without the regularisation.
    fn residual(&self, p: &Program, b: &[f64], x: &[f64]) -> Vec<f64> {
        let mut r = b.to_vec();
        let columns = r.iter_mut().zip(&self.diagonal[..p.n]);
        columns.zip(x).for_each(|((r, d), x)| *r += d * x);
        for i in 0..p.m {
            let (k, y) = (p.n + i, x[p.n + i]);
            let mut sum = self.diagonal[k] * y;
            for (j, a) in p.rows.line(i) {
                sum += a * x[j];
                r[j] -= a * y;
            }
            r[k] -= sum;
        }
        r
    }

    /// K x = b, refined.
    fn solve(&mut self, p: &Program, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        self.back(p, &mut x);
        let top = largest(b);
        let mut left = f64::INFINITY;
        for _ in 0..3 {
            let mut r = self.residual(p, b, &x);
            let now = largest(&r);
            self.unsound |= now > top && left < f64::INFINITY;
            if now <= SOLVED * top || now > 0.5 * left {
                break;
            }
            left = now;
            self.back(p, &mut r);
            x.iter_mut().zip(&r).for_each(|(x, r)| *x += r);
        }
        x
    }

    /// The step for residuals of the rows and columns and for what products of distance and multiplier are to change by.
    fn step(&mut self, p: &Program, at: &Iterate, rp: &[f64], rd: &[f64], rc: &[f64]) -> Iterate {
        let mut g = rd.to_vec();
        for (b, &k) in p.of.iter().enumerate() {
            g[k] -= p.sign[b] * rc[b] / at.w[b];
        }
        let mut right = g[..p.n].to_vec();
        let rows = rp.iter().zip(&g[p.n..]).zip(&self.diagonal[p.n..]);
        right.extend(rows.map(|((r, g), inverse)| r - g * inverse));
        let mut value = self.solve(p, &right);
        let y = value.split_off(p.n);
        for (i, y) in y.iter().enumerate() {
            let k = p.n + i;
            value.push(-(y + g[k]) * self.diagonal[k]);
        }
        let w: Vec<f64> =
            p.of.iter()
                .zip(&p.sign)
                .map(|(&k, s)| s * value[k])
                .collect();
        let z = (0..p.bounds()).map(|b| (rc[b] - at.z[b] * w[b]) / at.w[b]);
        let z = z.collect();
        Iterate { value, y, w, z }
    }
}

/// How much of steps from these values keeps all positive, 1 at most.
fn reach(steps: impl Iterator<Item = (f64, f64)>) -> f64 {
    let negative = steps.filter(|e| e.1 < 0.0);
    negative.map(|(at, step)| -at / step).fold(1.0, f64::min)
}

/// How far a step goes, at most 1, and the bound that stops it before.
type Way = (f64, Option<usize>);

/// The way of a step that keeps all positive, and its weight, not below `least`, against another one with which that is longest.
fn farthest(at: &[f64], step: &[f64], other: &[f64], least: f64) -> (Way, f64) {
    // what neither step takes to its bound no mean of them does
    let blocks = |b: &usize| at[*b] + step[*b].min(other[*b]) < 0.0;
    let blocking: Vec<usize> = (0..at.len()).filter(blocks).collect();
    let weights = (0..=WEIGHTS).map(|k| mean(1.0, least, f64::from(k) / f64::from(WEIGHTS)));
    let far = |weight: f64| {
        let mut way: Way = (1.0, None);
        for &b in &blocking {
            let step = mean(step[b], other[b], weight);
            if step < 0.0 && -at[b] / step < way.0 {
                way = (-at[b] / step, Some(b));
            }
        }
        (way, weight)
    };
    let farthest = weights
        .map(far)
        .max_by(|(a, _), (b, _)| a.0.total_cmp(&b.0));
    farthest.unwrap_or(((1.0, None), 1.0))
}

/// How much of a step is gone where its way leads to a bound: until the product there is as wanted (Mehrotra 1992).
fn before_bound(
    (way, stops): Way,
    [at, step]: [&[f64]; 2],
    factor: impl Fn(usize) -> f64,
    wanted: f64,
) -> f64 {
    let Some(b) = stops else {
        return way;
    };
    let distance = wanted / factor(b).max(f64::MIN_POSITIVE);
    ((distance - at[b]) / step[b]).clamp(SHORT[0] * way, SHORT[1] * way)
}

/// Mehrotra's first point: the least changes that satisfy the equations, moved inside the bounds.
fn begin(p: &Program, system: &mut System) -> Option<Iterate> {
    let count = p.bounds();
    let ones = Iterate {
        value: p.value.clone(),
        y: vec![0.0; p.m],
        w: vec![1.0; count],
        z: vec![1.0; count],
    };
    system.factorise(p, &vec![1.0; p.n + p.m])?;
    let none = vec![0.0; p.n + p.m];
    let rc = vec![0.0; count];
    let primal = system.step(p, &ones, &p.primal_residuals(&p.value), &none, &rc);
    let mut g = p.cost.clone();
    g.iter_mut()
        .zip(&p.constant)
        .filter(|e| *e.1)
        .for_each(|e| *e.0 = 0.0);
    let dual = system.step(p, &ones, &none[..p.m], &g, &rc);
    let mut at = ones;
    at.y = dual.y;
    at.value
        .iter_mut()
        .zip(&primal.value)
        .for_each(|(v, s)| *v += s);
    let wanted = p.dual_residuals(&at.y, &rc);
    let mut boxed = vec![0u8; p.n + p.m];
    p.of.iter().for_each(|&k| boxed[k] += 1);
    let (mut low, mut down) = (0.0f64, 0.0f64);
    for b in 0..count {
        let k = p.of[b];
        at.w[b] = p.sign[b] * (at.value[k] - p.side[b]);
        at.z[b] = p.sign[b] * wanted[k];
        if boxed[k] == 2 {
            at.z[b] = at.z[b].max(0.0);
        } else {
            low = low.max(-1.5 * at.w[b]);
        }
        down = down.max(-1.5 * at.z[b]);
    }
    let shift = |at: &mut Iterate, low: f64, down: f64| {
        for b in 0..count {
            if boxed[p.of[b]] == 1 {
                at.w[b] += low;
            }
            at.z[b] += down;
        }
    };
    shift(&mut at, low.max(1e-3), down.max(1e-3));
    let single = |b: &usize| boxed[p.of[*b]] == 1;
    let product: f64 = (0..count).filter(single).map(|b| at.w[b] * at.z[b]).sum();
    let low = 0.5 * product
        / (0..count)
            .filter(single)
            .map(|b| at.z[b])
            .sum::<f64>()
            .max(1e-10);
    let down = 0.5 * product
        / (0..count)
            .filter(single)
            .map(|b| at.w[b])
            .sum::<f64>()
            .max(1e-10);
    shift(&mut at, low, down);
    for b in 0..count {
        let k = p.of[b];
        if boxed[k] == 1 {
            at.value[k] = p.side[b] + p.sign[b] * at.w[b];
        } else if p.sign[b] > 0.0 {
            // the upper bound of this variable is the next one
            let width = p.side[b + 1] - p.side[b];
            let room = (0.25 * width).min(low.max(1e-3));
            at.w[b] = at.w[b].clamp(room, width - room);
            at.w[b + 1] = width - at.w[b];
            at.value[k] = p.side[b] + at.w[b];
        }
    }
    Some(at)
}

/// A given point that is inside the bounds, with multipliers of the rows for which reduced costs draw columns and rows to their nearest bounds.
fn centre(p: &Program, point: &Point, kept: &[usize]) -> Iterate {
    let mut value: Vec<f64> = kept.iter().map(|&j| point.x[j]).collect();
    value.resize(p.n + p.m, 0.0);
    let (x, s) = value.split_at_mut(p.n);
    for (i, s) in s.iter_mut().enumerate() {
        *s = match p.constant[p.n + i] {
            true => p.value[p.n + i],
            false => p.rows.line(i).map(|(j, a)| a * x[j]).sum(),
        };
    }
    let none = vec![0.0; p.bounds()];
    let mut left = p.dual_residuals(&point.y, &none);
    let distance = |b: usize| (p.sign[b] * (value[p.of[b]] - p.side[b])).max(LEAST);
    let w: Vec<f64> = (0..p.bounds()).map(distance).collect();
    let mut z = none;
    let drawn = |b: usize, left: &[f64]| p.sign[b] * left[p.of[b]] > 0.0;
    let pushed: Vec<usize> = (0..p.bounds()).filter(|&b| !drawn(b, &left)).collect();
    for b in pushed {
        z[b] = 1.0 / w[b];
        left[p.of[b]] -= p.sign[b] * z[b];
    }
    for b in 0..p.bounds() {
        if z[b] == 0.0 {
            z[b] = p.sign[b] * left[p.of[b]];
        }
    }
    Iterate {
        value,
        y: point.y.clone(),
        w,
        z,
    }
}

/// What a solution is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    /// For residuals and gap, relative to the sizes of sides, costs and objective.
    pub tolerance: f64,
    /// The same for a point that will do where no iteration brings them down.
    pub enough: f64,
    /// A gap of this part of the objective is none.
    pub share: f64,
}

impl From<[f64; 2]> for Goal {
    fn from([tolerance, enough]: [f64; 2]) -> Self {
        Self {
            tolerance,
            enough,
            share: 0.0,
        }
    }
}

/// Solves a program, from a point inside if there is one, which is [`centre`]d, until the goal is reached, or until no
/// iteration comes nearer to it. The layout of its system may be known. Nothing is said about programs without one: [`Ended::Failed`].
pub(super) fn solve(
    problem: &Problem,
    from: Option<&Point>,
    layout: Option<Layout>,
    Goal {
        tolerance,
        enough,
        share,
    }: Goal,
    budget: &Budget,
) -> Run {
    let (p, kept) = Program::new(problem);
    let mut run = Run {
        point: Point {
            x: problem.lower.clone(),
            y: vec![0.0; problem.m()],
            d: problem.cost.clone(),
        },
        ended: Ended::Failed,
        iterations: 0,
        almost: false,
    };
    let mut system = match System::new(&p, layout, budget) {
        Ok(system) => system,
        Err(ended) => return Run { ended, ..run },
    };
    let first = from.map(|point| centre(&p, point, &kept));
    let Some(mut at) = first.or_else(|| begin(&p, &mut system)) else {
        return run;
    };
    let sides = p
        .side
        .iter()
        .chain(&p.value)
        .fold(1.0f64, |t, v| t.max(v.abs()));
    let costs = 1.0 + largest(&p.cost);
    let mut best = (f64::INFINITY, at.clone());
    let mut halved = (f64::INFINITY, 0);
    for iteration in 0..MOST {
        run.iterations = iteration;
        let rp = p.primal_residuals(&at.value);
        let rd = p.dual_residuals(&at.y, &at.z);
        let product = dot(&at.w, &at.z);
        let objective = dot(&p.cost, &at.value);
        let primal = largest(&rp) / sides;
        let dual = largest(&rd) / costs;
        let gap = match product <= share * objective.abs() {
            true => 0.0,
            false => product / (1.0 + objective.abs()),
        };
        let worst = primal.max(dual).max(gap);
        budget.tell(Progress {
            method: "interior point",
            iteration,
            primal: Some(primal),
            dual: Some(dual),
            ..Progress::default()
        });
        if worst < 0.5 * halved.0 {
            halved = (worst, iteration);
        }
        if worst < best.0 {
            best = (worst, at.clone());
        }
        let patience = match gap > NOTHING * tolerance {
            true => PATIENCE[usize::from(best.0 > GOOD)],
            false => 1,
        };
        if worst <= tolerance || iteration > halved.1 + patience || !worst.is_finite() {
            break;
        }
        if let Some(stop) = budget.stop() {
            run.ended = stop.into();
            break;
        }
        let d = p.curvature(&at);
        let mu = product / p.bounds().max(1) as f64;
        let step = (0..STABLER).find_map(|_| {
            system.suit(&at);
            let step = system.factorise(&p, &d);
            let step = step.and_then(|()| whole_step(&p, &mut system, &at, &rp, &rd, mu));
            system.regular *= if step.is_some() { 1.0 } else { 100.0 };
            step
        });
        let Some((step, ways)) = step else {
            break;
        };
        at.advance(&step, ways);
    }
    if run.ended == Ended::Failed && best.0 <= enough {
        run.ended = Ended::Solved;
    }
    let at = best.1;
    for (k, &j) in kept.iter().enumerate() {
        run.point.x[j] = at.value[k];
    }
    run.point.y = at.y;
    for j in 0..problem.n() {
        let terms = problem.columns.line(j).map(|(i, a)| a * run.point.y[i]);
        run.point.d[j] = problem.cost[j] - terms.sum::<f64>();
    }
    run
}

/// Predictor and corrector; the step and how much of it to go, primal and dual.
fn whole_step(
    p: &Program,
    system: &mut System,
    at: &Iterate,
    rp: &[f64],
    rd: &[f64],
    mu: f64,
) -> Option<(Iterate, [f64; 2])> {
    let count = p.bounds();
    let full: Vec<f64> = (0..count).map(|b| -at.w[b] * at.z[b]).collect();
    let affine = system.step(p, at, rp, rd, &full);
    let steps = |at: &[f64], step: &[f64]| reach(at.iter().copied().zip(step.iter().copied()));
    let (first, second) = (steps(&at.w, &affine.w), steps(&at.z, &affine.z));
    let product = |step: &Iterate, [primal, dual]: [f64; 2]| {
        let of = |b| (at.w[b] + primal * step.w[b]) * (at.z[b] + dual * step.z[b]);
        (0..count).map(of).sum::<f64>() / count.max(1) as f64
    };
    let left = product(&affine, [first, second]) / mu;
    let sigma = left.powi(3).clamp(1e-8, 1.0);
    let target = if count == 0 { 0.0 } else { sigma * mu };
    let rc = (0..count).map(|b| target + full[b] - affine.w[b] * affine.z[b]);
    let rc: Vec<f64> = rc.collect();
    let mut step = system.step(p, at, rp, rd, &rc);
    let (primal, weight) = farthest(&at.w, &step.w, &affine.w, first * second);
    let (dual, other) = farthest(&at.z, &step.z, &affine.z, first * second);
    step.weigh(&affine, [weight, other]);
    let finite = step.y.iter().chain(&step.value).all(|v| v.is_finite());
    (finite && !system.unsound).then_some(())?;
    let wanted = LATE * product(&step, [primal.0, dual.0]);
    let z = |b: usize| at.z[b] + dual.0 * step.z[b];
    let w = |b: usize| at.w[b] + primal.0 * step.w[b];
    let ways = [
        before_bound(primal, [&at.w, &step.w], z, wanted),
        before_bound(dual, [&at.z, &step.z], w, wanted),
    ];
    Some((step, ways))
}
