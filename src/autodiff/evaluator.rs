//! Row activities, Jacobian and Hessian of the Lagrangian of an instance.
//!
//! Both patterns are found once: the Jacobian by rows, linear coefficients included, columns
//! increasing; the Hessian as the lower triangle of Σ λ_i ∇²row_i, by rows, columns increasing, no
//! entry twice. Each entry of each term knows its place, so an evaluation is a run of the programs
//! with one addition per nonzero.
//!
//! Invariant: a pattern depends on the instance alone, never on the point.

use super::blocks::{Block, Second, Wanted, compile};
use super::fixed::without_fixed;
use super::functions::{DomainError, ErrorKind, Operation};
use super::program::{Sink, Workspace};
use super::scalar;
use crate::model::instance::Instance;
use std::fmt;

/// An evaluation that failed: where and why.
#[derive(Clone, PartialEq, Debug)]
pub struct EvalFailure {
    /// The row that could not be evaluated.
    pub row: u32,
    /// The column whose level is the argument to blame, where the argument is a plain variable.
    pub column: Option<u32>,
    /// What failed.
    pub error: DomainError,
}

impl fmt::Display for EvalFailure {
    /// `log of -1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.error.fmt(f)
    }
}

impl std::error::Error for EvalFailure {}

/// What [`Evaluator::smoothed`] rounds.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Kinks {
    /// Roots, which have one at 0 only.
    Roots,
    /// abs, min, max.
    Anywhere,
}

/// The worst kinks in the terms of an instance.
pub fn kinks(instance: &Instance) -> Option<Kinks> {
    use crate::model::instance::{Function::*, Op};
    let kink = |op: &Op| match op {
        Op::Call(Abs | Max | Min, _) => Some(Kinks::Anywhere),
        Op::Call(Sqrt | EDist, _) => Some(Kinks::Roots),
        _ => None,
    };
    let used = instance.nonlinear.iter().filter(|t| !t.row.is_empty());
    used.flat_map(|t| &t.kernel.ops).filter_map(kink).max()
}

/// How a row depends on the columns.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Degree {
    /// Affine.
    Linear,
    /// A polynomial of degree two.
    Quadratic,
    /// Anything else, and anything whose domain is not the whole space.
    Nonlinear,
}

/// Places of the entries of the terms of a block in a pattern: `place[entry · terms + term]`.
#[derive(Default, Debug)]
struct Places {
    place: Vec<u32>,
    /// Hessian only: (entry, term) where two different slots hold the same column, so that the entry
    /// counts twice on the diagonal. Sorted.
    twice: Vec<(u32, u32)>,
}

/// Entries of a matrix, row by row.
pub(crate) type Lines = Vec<Vec<(usize, f64)>>;

/// Values and exact derivatives of an instance. It keeps what it needs of the instance.
#[derive(Debug, Default)]
pub struct Evaluator {
    columns: usize,
    blocks: Vec<Block>,
    work: Workspace,
    jacobian_start: Vec<usize>,
    jacobian_column: Vec<u32>,
    /// Values of the linear part in the places of the Jacobian.
    jacobian_linear: Vec<f64>,
    jacobian_places: Vec<Places>,
    hessian_row: Vec<u32>,
    hessian_column: Vec<u32>,
    hessian_places: Vec<Places>,
    /// For points where a derivative with respect to a fixed column does not exist.
    unfixed: Unfixed,
}

/// The terms without their fixed columns.
#[derive(Debug, Default)]
enum Unfixed {
    /// Not needed: there are none.
    #[default]
    None,
    /// Not compiled yet, and how they are to be.
    Terms(Box<Instance>, Wanted),
    /// Ready.
    Ready(Box<Part>),
}

/// An evaluator of a part of an instance's derivatives.
#[derive(Debug)]
struct Part {
    evaluator: Evaluator,
    /// Place in the whole Jacobian, and in the whole Hessian, of each entry.
    jacobian: Vec<usize>,
    hessian: Vec<usize>,
}

impl Evaluator {
    /// Compiles the kernels and finds the patterns.
    pub fn new(instance: &Instance) -> Self {
        Self::smoothed(instance, 0.0)
    }

    /// The same without second derivatives: its Hessian has no entries, and [`Self::degrees`] knows linear rows only.
    pub fn first_order(instance: &Instance) -> Self {
        Self::smoothed_first_order(instance, 0.0)
    }

    /// [`Self::smoothed`] without second derivatives.
    pub fn smoothed_first_order(instance: &Instance, delta: f64) -> Self {
        Self::made(instance, delta, Second::None)
    }

    /// The same with [`Self::product`].
    pub fn with_products(instance: &Instance) -> Self {
        Self::made(instance, 0.0, Second::Products)
    }

    /// The same with √(a² + δ²) for |a|, and min and max made from it: differentiable everywhere.
    pub fn smoothed(instance: &Instance, delta: f64) -> Self {
        Self::made(instance, delta, Second::Entries)
    }

    fn made(instance: &Instance, smoothing: f64, second: Second) -> Self {
        let wanted = Wanted {
            smoothing,
            second,
            columns: instance.column_count() as u32,
        };
        let mut e = Self::plain(instance, wanted);
        if let Some(i) = without_fixed(instance) {
            e.unfixed = Unfixed::Terms(Box::new(i), wanted);
        }
        e
    }

    /// The part without fixed columns.
    fn part(&mut self) -> Option<&mut Part> {
        if let Unfixed::Terms(instance, wanted) = &self.unfixed {
            let part = Part::new(self, Self::plain(instance, *wanted));
            self.unfixed = Unfixed::Ready(Box::new(part));
        }
        match &mut self.unfixed {
            Unfixed::Ready(part) => Some(part),
            _ => None,
        }
    }

    fn plain(instance: &Instance, wanted: Wanted) -> Self {
        let blocks = compile(instance, wanted);
        let mut e = Self {
            columns: instance.column_count(),
            blocks,
            ..Self::default()
        };
        e.find_jacobian(instance);
        e.find_hessian();
        e
    }

    /// Row activities, right-hand sides left out.
    ///
    /// Errors: a function that cannot be evaluated at x, or a value that is not finite.
    pub fn rows(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), EvalFailure> {
        for (i, v) in out.iter_mut().enumerate() {
            let range = self.jacobian_start[i]..self.jacobian_start[i + 1];
            let columns = &self.jacobian_column[range.clone()];
            let linear = &self.jacobian_linear[range];
            *v = columns
                .iter()
                .zip(linear)
                .map(|(&j, a)| a * x[j as usize])
                .sum();
        }
        for b in &self.blocks {
            let mut sink = RowSink {
                out,
                row: &b.row,
                coef: &b.coef,
            };
            b.value
                .run(b.operands(x), &mut self.work, &mut sink)
                .map_err(|first| scalar::diagnose(b, first, x, 0))?;
        }
        Ok(())
    }

    /// Pattern of the Jacobian by rows: starts of the rows, columns.
    pub fn jacobian_pattern(&self) -> (&[usize], &[u32]) {
        (&self.jacobian_start, &self.jacobian_column)
    }

    /// The entries of the Jacobian at a point, row by row.
    ///
    /// Errors: as [`Self::jacobian`].
    pub(crate) fn jacobian_rows(&mut self, x: &[f64]) -> Result<Lines, EvalFailure> {
        let mut values = vec![0.0; self.jacobian_column.len()];
        self.jacobian(x, &mut values)?;
        let entry = |k: usize| (self.jacobian_column[k] as usize, values[k]);
        let rows = self.jacobian_start.windows(2);
        Ok(rows.map(|r| (r[0]..r[1]).map(entry).collect()).collect())
    }

    /// The activities of the rows at a point, and the entries of the Jacobian, row by row.
    ///
    /// Errors: as [`Self::jacobian`].
    pub(crate) fn linearised(&mut self, x: &[f64]) -> Result<(Vec<f64>, Lines), EvalFailure> {
        let mut activity = vec![0.0; self.jacobian_start.len() - 1];
        self.rows(x, &mut activity)?;
        Ok((activity, self.jacobian_rows(x)?))
    }

    /// Values of the Jacobian in the order of its pattern.
    ///
    /// Errors: as [`Self::rows`]; also a derivative with respect to a column that is not fixed that does not exist.
    pub fn jacobian(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), EvalFailure> {
        let result = self.whole_jacobian(x, values);
        if result.is_ok() {
            return result;
        }
        values.copy_from_slice(&self.jacobian_linear);
        let Some(part) = self.part() else {
            return result;
        };
        let mut entries = vec![0.0; part.jacobian.len()];
        if part.evaluator.whole_jacobian(x, &mut entries).is_err() {
            return result;
        }
        scatter(&part.jacobian, &entries, values);
        Ok(())
    }

    fn whole_jacobian(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), EvalFailure> {
        values.copy_from_slice(&self.jacobian_linear);
        for (b, places) in self.blocks.iter().zip(&self.jacobian_places) {
            let mut sink = PlaceSink {
                values,
                place: &places.place,
                weight: &b.coef,
                terms: b.terms(),
            };
            b.gradient
                .run(b.operands(x), &mut self.work, &mut sink)
                .map_err(|first| scalar::diagnose(b, first, x, 1))?;
        }
        Ok(())
    }

    /// Pattern of the lower triangle of the Hessian: rows, columns (row ≥ column).
    pub fn hessian_pattern(&self) -> (&[u32], &[u32]) {
        (&self.hessian_row, &self.hessian_column)
    }

    /// Lower triangle of Σ λ_i ∇²row_i in the order of its pattern.
    ///
    /// Errors: as [`Self::jacobian`].
    pub fn hessian(
        &mut self,
        x: &[f64],
        lambda: &[f64],
        values: &mut [f64],
    ) -> Result<(), EvalFailure> {
        let result = self.whole_hessian(x, lambda, values);
        if result.is_ok() {
            return result;
        }
        let Some(part) = self.part() else {
            return result;
        };
        let mut entries = vec![0.0; part.hessian.len()];
        let again = part.evaluator.whole_hessian(x, lambda, &mut entries);
        if again.is_err() {
            return result;
        }
        values.fill(0.0);
        scatter(&part.hessian, &entries, values);
        Ok(())
    }

    fn whole_hessian(
        &mut self,
        x: &[f64],
        lambda: &[f64],
        values: &mut [f64],
    ) -> Result<(), EvalFailure> {
        values.fill(0.0);
        let mut weight = Vec::new();
        for (b, places) in self.blocks.iter().zip(&self.hessian_places) {
            if b.hessian_slots.is_empty() {
                continue;
            }
            weight.clear();
            weight.extend(
                b.coef
                    .iter()
                    .zip(&b.row)
                    .map(|(c, &i)| c * lambda[i as usize]),
            );
            if weight.iter().all(|&w| w == 0.0) {
                continue;
            }
            let terms = b.terms();
            let operands = b.operands(x);
            let result = if places.twice.is_empty() {
                let mut sink = PlaceSink {
                    values,
                    place: &places.place,
                    weight: &weight,
                    terms,
                };
                b.hessian.run(operands, &mut self.work, &mut sink)
            } else {
                let mut sink = TwiceSink {
                    plain: PlaceSink {
                        values,
                        place: &places.place,
                        weight: &weight,
                        terms,
                    },
                    twice: &places.twice,
                };
                b.hessian.run(operands, &mut self.work, &mut sink)
            };
            result.map_err(|first| scalar::diagnose(b, first, x, 2))?;
        }
        Ok(())
    }

    /// Σ λ_i ∇²row_i times a vector, of an evaluator that was made for it.
    ///
    /// Errors: as [`Self::jacobian`].
    pub fn product(
        &mut self,
        x: &[f64],
        vector: &[f64],
        lambda: &[f64],
        out: &mut [f64],
    ) -> Result<(), EvalFailure> {
        out.fill(0.0);
        let both = [x, vector].concat();
        for b in &self.blocks {
            let weight: Vec<f64> = b
                .row
                .iter()
                .zip(&b.coef)
                .map(|(&i, c)| c * lambda[i as usize])
                .collect();
            let mut sink = PlaceSink {
                values: out,
                place: &b.product_columns,
                weight: &weight,
                terms: b.terms(),
            };
            b.product
                .run(b.operands(&both), &mut self.work, &mut sink)
                .map_err(|first| scalar::diagnose(b, first, x, 2))?;
        }
        Ok(())
    }

    /// How each row depends on the columns.
    pub fn degrees(&self) -> Vec<Degree> {
        let mut degree = vec![Degree::Linear; self.jacobian_start.len() - 1];
        for b in &self.blocks {
            let d = if b.linear {
                Degree::Linear
            } else if b.quadratic {
                Degree::Quadratic
            } else {
                Degree::Nonlinear
            };
            for &i in &b.row {
                let old = &mut degree[i as usize];
                *old = d.max(*old);
            }
        }
        degree
    }

    /// Number of entries of the Jacobian that depend on the point or belong to a nonlinear term: one per
    /// row and column, as GAMS counts nonlinear nonzeros.
    pub fn nonlinear_nonzeros(&self) -> usize {
        let mut nonlinear = vec![false; self.jacobian_column.len()];
        for p in &self.jacobian_places {
            for &k in &p.place {
                nonlinear[k as usize] = true;
            }
        }
        nonlinear.into_iter().filter(|&b| b).count()
    }

    fn find_jacobian(&mut self, instance: &Instance) {
        let (m, n) = (instance.row_count(), instance.column_count());
        let mut finder = PatternFinder::new(m, n);
        for i in 0..instance.matrix.rows().min(m) {
            finder.count(i, instance.matrix.start[i + 1] - instance.matrix.start[i]);
        }
        for b in &self.blocks {
            for &i in &b.row {
                finder.count(i as usize, b.gradient_slots.len());
            }
        }
        finder.ready();
        let mut linear = Vec::with_capacity(instance.matrix.column.len());
        for i in 0..instance.matrix.rows().min(m) {
            for (j, a) in instance.matrix.row(i) {
                linear.push((finder.enter(i, j), a));
            }
        }
        let first_nonlinear = linear.len();
        for b in &self.blocks {
            for &slot in &b.gradient_slots {
                for (t, &i) in b.row.iter().enumerate() {
                    finder.enter(i as usize, b.column(slot, t) as usize);
                }
            }
        }
        let (start, column, place) = finder.finish();
        self.jacobian_linear = vec![0.0; column.len()];
        for (contribution, a) in linear {
            self.jacobian_linear[place[contribution] as usize] += a;
        }
        let mut rest = &place[first_nonlinear..];
        for b in &self.blocks {
            let (mine, others) = rest.split_at(b.gradient_slots.len() * b.terms());
            self.jacobian_places.push(Places {
                place: mine.to_vec(),
                twice: Vec::new(),
            });
            rest = others;
        }
        self.jacobian_start = start;
        self.jacobian_column = column;
    }

    fn find_hessian(&mut self) {
        let n = self.columns;
        let mut finder = PatternFinder::new(n, n);
        let ends = |b: &Block, [p, q]: [u32; 2], t: usize| {
            let (i, j) = (b.column(p, t) as usize, b.column(q, t) as usize);
            (i.max(j), i.min(j))
        };
        for b in &self.blocks {
            for &slots in &b.hessian_slots {
                for t in 0..b.terms() {
                    finder.count(ends(b, slots, t).0, 1);
                }
            }
        }
        finder.ready();
        for b in &self.blocks {
            for &slots in &b.hessian_slots {
                for t in 0..b.terms() {
                    let (i, j) = ends(b, slots, t);
                    finder.enter(i, j);
                }
            }
        }
        let (start, column, place) = finder.finish();
        let mut rest = &place[..];
        for b in &self.blocks {
            let (mine, others) = rest.split_at(b.hessian_slots.len() * b.terms());
            let mut twice = Vec::new();
            for (k, &slots) in b.hessian_slots.iter().enumerate() {
                for t in 0..b.terms() {
                    let (i, j) = ends(b, slots, t);
                    if i == j && slots[0] != slots[1] {
                        twice.push((k as u32, t as u32));
                    }
                }
            }
            self.hessian_places.push(Places {
                place: mine.to_vec(),
                twice,
            });
            rest = others;
        }
        for i in 0..n {
            self.hessian_row
                .extend(std::iter::repeat_n(i as u32, start[i + 1] - start[i]));
        }
        self.hessian_column = column;
    }
}

impl Part {
    fn new(whole: &Evaluator, part: Evaluator) -> Self {
        // columns are sorted in each line
        let find = |columns: &[u32], line: std::ops::Range<usize>, j: u32| {
            line.start + columns[line].partition_point(|&k| k < j)
        };
        let line = |i: usize| whole.jacobian_start[i]..whole.jacobian_start[i + 1];
        let rows = part.jacobian_start.windows(2).enumerate();
        let rows = rows.flat_map(|(i, range)| (range[0]..range[1]).map(move |k| (i, k)));
        let jacobian =
            rows.map(|(i, k)| find(&whole.jacobian_column, line(i), part.jacobian_column[k]));
        let entries = part.hessian_row.iter().zip(&part.hessian_column);
        let hessian = entries.map(|(&i, &j)| {
            let rows = &whole.hessian_row;
            let line = rows.partition_point(|&r| r < i)..rows.partition_point(|&r| r <= i);
            find(&whole.hessian_column, line, j)
        });
        Self {
            jacobian: jacobian.collect(),
            hessian: hessian.collect(),
            evaluator: part,
        }
    }
}

/// Adds entries at their places.
fn scatter(place: &[usize], entries: &[f64], values: &mut [f64]) {
    for (&k, v) in place.iter().zip(entries) {
        values[k] += *v;
    }
}

/// Merges contributions (row, column) into a pattern by rows, in linear time: contributions are put
/// into buckets by row, and a mark per column finds the repeated ones.
struct PatternFinder {
    start: Vec<usize>,
    next: Vec<usize>,
    /// (column, number of the contribution), bucket by bucket.
    bucket: Vec<(u32, u32)>,
    entered: u32,
    columns: usize,
}

impl PatternFinder {
    fn new(rows: usize, columns: usize) -> Self {
        Self {
            start: vec![0; rows + 1],
            next: Vec::new(),
            bucket: Vec::new(),
            entered: 0,
            columns,
        }
    }

    /// First pass: `more` contributions to a row.
    fn count(&mut self, row: usize, more: usize) {
        self.start[row + 1] += more;
    }

    fn ready(&mut self) {
        for i in 1..self.start.len() {
            self.start[i] += self.start[i - 1];
        }
        self.next = self.start.clone();
        let total = self.start.last().copied().unwrap_or(0);
        self.bucket = vec![(0, 0); total];
    }

    /// Second pass: a contribution. Its number.
    fn enter(&mut self, row: usize, column: usize) -> usize {
        let at = self.next[row];
        self.next[row] += 1;
        self.bucket[at] = (column as u32, self.entered);
        self.entered += 1;
        self.entered as usize - 1
    }

    /// Starts of the rows, columns, place of each contribution.
    fn finish(self) -> (Vec<usize>, Vec<u32>, Vec<u32>) {
        let rows = self.start.len() - 1;
        let mut start = Vec::with_capacity(rows + 1);
        start.push(0);
        let mut column: Vec<u32> = Vec::with_capacity(self.bucket.len());
        let mut place = vec![0_u32; self.bucket.len()];
        let mut mark = vec![u32::MAX; self.columns];
        for i in 0..rows {
            let bucket = &self.bucket[self.start[i]..self.start[i + 1]];
            let first = column.len();
            for &(j, _) in bucket {
                // a mark below `first` belongs to an earlier row
                let m = mark[j as usize];
                if m == u32::MAX || (m as usize) < first {
                    mark[j as usize] = column.len() as u32;
                    column.push(j);
                }
            }
            column[first..].sort_unstable();
            for (k, &j) in column[first..].iter().enumerate() {
                mark[j as usize] = (first + k) as u32;
            }
            for &(j, contribution) in bucket {
                place[contribution as usize] = mark[j as usize];
            }
            start.push(column.len());
        }
        column.shrink_to_fit();
        (start, column, place)
    }
}

struct RowSink<'s> {
    out: &'s mut [f64],
    row: &'s [u32],
    coef: &'s [f64],
}

impl Sink for RowSink<'_> {
    fn store(&mut self, _entry: usize, first: usize, values: &[f64]) {
        let (row, coef) = (&self.row[first..], &self.coef[first..]);
        for ((v, &i), c) in values.iter().zip(row).zip(coef) {
            self.out[i as usize] += c * v;
        }
    }
}

struct PlaceSink<'s> {
    values: &'s mut [f64],
    place: &'s [u32],
    weight: &'s [f64],
    terms: usize,
}

impl Sink for PlaceSink<'_> {
    fn store(&mut self, entry: usize, first: usize, values: &[f64]) {
        let place = &self.place[entry * self.terms + first..];
        let weight = &self.weight[first..];
        for ((v, &k), w) in values.iter().zip(place).zip(weight) {
            self.values[k as usize] += w * v;
        }
    }
}

struct TwiceSink<'s> {
    plain: PlaceSink<'s>,
    twice: &'s [(u32, u32)],
}

impl Sink for TwiceSink<'_> {
    fn store(&mut self, entry: usize, first: usize, values: &[f64]) {
        self.plain.store(entry, first, values);
        let p = &mut self.plain;
        let (low, high) = (first as u32, (first + values.len()) as u32);
        let at = self.twice.partition_point(|&e| e < (entry as u32, low));
        for &(k, t) in &self.twice[at..] {
            if k != entry as u32 || t >= high {
                break;
            }
            let place = p.place[entry * p.terms + t as usize] as usize;
            p.values[place] += p.weight[t as usize] * values[(t - low) as usize];
        }
    }
}

/// A term overflowed although no function of it failed.
pub(super) fn overflow(row: u32) -> EvalFailure {
    EvalFailure {
        row,
        column: None,
        error: DomainError::new(Operation::Term, &[], 0, ErrorKind::Overflow),
    }
}
