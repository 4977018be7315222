//! From an [`Instance`] to the form the linear solvers work on, and back.
//!
//! ```text
//!     min  cᵀx + offset    subject to    L ≤ A x ≤ U,   l ≤ x ≤ u
//! ```
//!
//! * A maximisation is the minimisation of −c.
//! * The objective variable goes when it is free and stands in one row only, an equation
//!   (`z =e= sum(…)`): its row becomes c. Nothing is lost: z is evaluated at the end. A bounded
//!   objective variable, or one that other rows use, stays a column with cost ±1.
//! * `=n=` rows and empty rows that hold anyway are left out; their marginal is 0.
//! * Bounds of 1e30 and beyond count as infinite.
//!
//! Marginals come back with GAMS's signs, for min and max alike: the derivative of the objective
//! with respect to the right-hand side (rows) or to the bound (columns).

use crate::model::instance::{INFINITE, Instance, Relation};
use crate::model::outcome::{Basis, BasisStatus};
use crate::model::sum::Sum;
use crate::solve::{Outcome, SolveError};

/// A sparse matrix in compressed form; "lines" are columns or rows.
#[derive(Clone, Debug)]
pub struct Sparse {
    /// Line k is `start[k]..start[k+1]`.
    pub start: Vec<usize>,
    /// Position within a line, increasing.
    pub index: Vec<u32>,
    /// Coefficients.
    pub value: Vec<f64>,
}

impl Default for Sparse {
    /// A matrix without lines.
    fn default() -> Self {
        Self {
            start: vec![0],
            index: Vec::new(),
            value: Vec::new(),
        }
    }
}

impl Sparse {
    /// Appends a line.
    pub fn push(&mut self, entries: impl IntoIterator<Item = (usize, f64)>) {
        for (i, v) in entries {
            self.index.push(i as u32);
            self.value.push(v);
        }
        self.start.push(self.index.len());
    }

    /// Entries of a line.
    #[inline]
    pub fn line(&self, k: usize) -> impl ExactSizeIterator<Item = (usize, f64)> + Clone + '_ {
        let r = self.start[k]..self.start[k + 1];
        self.index[r.clone()]
            .iter()
            .map(|&i| i as usize)
            .zip(self.value[r].iter().copied())
    }

    /// Number of lines.
    pub fn lines(&self) -> usize {
        self.start.len() - 1
    }

    /// The same matrix, compressed the other way; `width` is the number of positions.
    pub fn transpose(&self, width: usize) -> Self {
        let mut start = vec![0usize; width + 1];
        for &i in &self.index {
            start[i as usize + 1] += 1;
        }
        for k in 0..width {
            start[k + 1] += start[k];
        }
        let mut next = start.clone();
        let mut index = vec![0u32; self.index.len()];
        let mut value = vec![0.0; self.value.len()];
        for k in 0..self.lines() {
            for (i, v) in self.line(k) {
                index[next[i]] = k as u32;
                value[next[i]] = v;
                next[i] += 1;
            }
        }
        Self {
            start,
            index,
            value,
        }
    }
}

/// A bound, infinite where it counts as such.
fn infinite(b: f64) -> f64 {
    if b.abs() >= INFINITE {
        f64::INFINITY.copysign(b)
    } else {
        b
    }
}

/// `min cᵀx + offset, L ≤ Ax ≤ U, l ≤ x ≤ u`, with A kept both ways.
#[derive(Clone, Debug, Default)]
pub struct Problem {
    /// c.
    pub cost: Vec<f64>,
    /// l, −∞ allowed.
    pub lower: Vec<f64>,
    /// u, +∞ allowed.
    pub upper: Vec<f64>,
    /// L, −∞ allowed.
    pub row_lower: Vec<f64>,
    /// U, +∞ allowed.
    pub row_upper: Vec<f64>,
    /// A by columns.
    pub columns: Sparse,
    /// A by rows.
    pub rows: Sparse,
    /// Constant of the objective.
    pub offset: f64,
}

impl Problem {
    /// The linear part of an instance as a minimum, rows and columns in their order.
    pub fn of(instance: &Instance) -> Self {
        let finite = |bounds: &[f64]| bounds.iter().copied().map(infinite).collect();
        let mut out = Self {
            cost: vec![0.0; instance.column_count()],
            lower: finite(&instance.columns.lower),
            upper: finite(&instance.columns.upper),
            ..Self::default()
        };
        if let Some(o) = instance.objective {
            out.cost[o.column as usize] = instance.sign();
        }
        for (i, &rhs) in instance.rows.rhs.iter().enumerate() {
            let [lo, hi] = instance.rows.relation[i].bounds(rhs);
            out.row_lower.push(lo);
            out.row_upper.push(hi);
            out.rows.push(instance.matrix.row(i));
        }
        out.columns = out.rows.transpose(out.n());
        out
    }

    /// Number of columns.
    pub fn n(&self) -> usize {
        self.cost.len()
    }

    /// Number of rows.
    pub fn m(&self) -> usize {
        self.row_lower.len()
    }

    /// Value of a row at a point.
    pub fn activity(&self, i: usize, x: &[f64]) -> f64 {
        self.rows.line(i).map(|(j, a)| a * x[j]).sum()
    }

    /// The side of a row that a multiplier prices: the lower one if it is positive.
    pub fn priced_side(&self, i: usize, multiplier: f64) -> f64 {
        match multiplier > 0.0 {
            true => self.row_lower[i],
            false => self.row_upper[i],
        }
    }

    /// A value between the bounds of a column: one of them if there is one.
    pub fn at_bound(&self, j: usize) -> f64 {
        let bounds = [self.lower[j], self.upper[j]];
        bounds.into_iter().find(|b| b.is_finite()).unwrap_or(0.0)
    }

    /// The program in some of its columns and rows; other columns stay at these values.
    pub fn part(&self, columns: &[usize], rows: &[usize], values: &[f64]) -> Self {
        let mut number = vec![usize::MAX; self.n()];
        columns.iter().enumerate().for_each(|(k, &j)| number[j] = k);
        let is_kept = |e: &(usize, f64)| number[e.0] != usize::MAX;
        let pick = |all: &[f64]| columns.iter().map(|&j| all[j]).collect();
        let others = (0..self.n()).filter(|&j| number[j] == usize::MAX);
        let mut out = Self {
            cost: pick(&self.cost),
            lower: pick(&self.lower),
            upper: pick(&self.upper),
            offset: self.offset + others.map(|j| self.cost[j] * values[j]).sum::<f64>(),
            ..Self::default()
        };
        for &i in rows {
            let others = self.rows.line(i).filter(|e| !is_kept(e));
            let moved: f64 = others.map(|(j, a)| a * values[j]).sum();
            out.row_lower.push(self.row_lower[i] - moved);
            out.row_upper.push(self.row_upper[i] - moved);
            let kept = self.rows.line(i).filter(|e| e.1 != 0.0 && is_kept(e));
            out.rows.push(kept.map(|(j, a)| (number[j], a)));
        }
        out.columns = out.rows.transpose(columns.len());
        out
    }

    /// Takes what fixed columns add from the sides of the rows, and leaves them fixed at 0: their terms may be far larger than all
    /// others. Their values.
    pub fn move_fixed(&mut self) -> Vec<f64> {
        let mut value = vec![0.0; self.n()];
        for (j, value) in value.iter_mut().enumerate() {
            if self.lower[j] == self.upper[j] {
                *value = self.lower[j];
                (self.lower[j], self.upper[j]) = (0.0, 0.0);
                self.offset += self.cost[j] * *value;
            }
        }
        for i in (0..self.m()).filter(|&i| self.rows.line(i).any(|(j, _)| value[j] != 0.0)) {
            for side in [&mut self.row_lower[i], &mut self.row_upper[i]] {
                let mut left = Sum::new(*side);
                let terms = self.rows.line(i).filter(|e| value[e.0] != 0.0);
                if side.is_finite() {
                    terms.for_each(|(j, a)| left.add_product(-a, value[j]));
                    *side = left.value();
                }
            }
        }
        value
    }

    /// Whether y proves the problem infeasible, clearly: more strictly than
    /// [`crate::solve::certificate`] asks.
    pub fn proves_infeasible(&self, y: &[f64]) -> bool {
        proves_infeasible(
            &self.columns,
            [&self.lower, &self.upper],
            [&self.row_lower, &self.row_upper],
            y,
            [1e-6, 1e-10],
        )
    }
}

/// Whether y has yᵀAx < yᵀs for all x and all activities s within bounds (Farkas). `clear` is the
/// margin asked for, relative to the largest term; entries that meet an infinite bound may be
/// `noise` of their largest term.
pub fn proves_infeasible(
    columns: &Sparse,
    [lower, upper]: [&[f64]; 2],
    [row_lower, row_upper]: [&[f64]; 2],
    y: &[f64],
    [clear, noise]: [f64; 2],
) -> bool {
    let top = y.iter().fold(0.0f64, |t, v| t.max(v.abs()));
    let (mut margin, mut size) = (Sum::default(), 0.0f64);
    let mut used = y.to_vec();
    for (i, &y) in y.iter().enumerate() {
        let side = if y > 0.0 { row_lower[i] } else { row_upper[i] };
        if side.is_finite() {
            margin.add_product(y, side);
            size = size.max((y * side).abs());
        } else if y.abs() > noise * top {
            return false;
        } else {
            used[i] = 0.0;
        }
    }
    for j in 0..columns.lines() {
        let (mut reach, mut largest) = (Sum::default(), 0.0f64);
        for (i, a) in columns.line(j) {
            reach.add_product(a, used[i]);
            largest = largest.max((a * used[i]).abs());
        }
        let reach = reach.value();
        let bound = if reach > 0.0 { upper[j] } else { lower[j] };
        if bound.is_finite() {
            margin.add_product(-reach, bound);
            size = size.max((reach * bound).abs());
        } else if reach.abs() > noise * largest {
            return false;
        }
    }
    let margin = margin.value();
    margin.is_finite() && margin > clear * size
}

/// A point of a [`Problem`] with its multipliers.
#[derive(Clone, Debug, Default)]
pub struct Point {
    /// x.
    pub x: Vec<f64>,
    /// y, the derivative of the minimum with respect to the active side of each row.
    pub y: Vec<f64>,
    /// d = c − Aᵀy.
    pub d: Vec<f64>,
}

/// The row that defines the eliminated objective variable.
#[derive(Clone, Copy, Debug)]
struct Definition {
    row: usize,
    column: usize,
    coefficient: f64,
}

/// How a [`Problem`] was made from an instance.
#[derive(Clone, Debug)]
pub struct Form {
    /// The problem.
    pub problem: Problem,
    /// Instance column of each column.
    pub columns: Vec<u32>,
    /// Instance row of each row.
    pub rows: Vec<u32>,
    /// Multiply the problem's objective and marginals by this to get the instance's.
    pub sign: f64,
    definition: Option<Definition>,
    instance_rows: usize,
    instance_columns: usize,
}

/// Checks what every solver relies on: shapes, order and range of indices, finite data, bounds
/// that do not cross. A solver given anything else may return nonsense without a word (Clarabel
/// does for NaN, infinities and unsorted columns).
pub fn validate(instance: &Instance) -> Result<(), SolveError> {
    let (m, n) = (instance.row_count(), instance.column_count());
    let matrix = &instance.matrix;
    let shapes = instance.columns.upper.len() == n
        && instance.rows.relation.len() == m
        && (matrix.start.len() == m + 1 || (m == 0 && matrix.start.is_empty()))
        && matrix.column.len() == matrix.value.len()
        && matrix.start.last().copied().unwrap_or(0) == matrix.value.len();
    if !shapes {
        return Err(SolveError::new(
            "the generated model is inconsistent (please report this)",
        ));
    }
    for j in 0..n {
        let fail = |message: String| Err(SolveError::at(None, Some(j), message));
        let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
        if l.is_nan() || u.is_nan() {
            return fail("a bound is not a number".into());
        }
        if l > u {
            return fail(format!(
                "the lower bound {l} is greater than the upper bound {u}"
            ));
        }
        if l == f64::INFINITY || u == f64::NEG_INFINITY {
            return fail("the lower bound is +INF or the upper bound is -INF".into());
        }
    }
    for i in 0..m {
        let fail = |column, message: String| Err(SolveError::at(Some(i), column, message));
        let rhs = instance.rows.rhs[i];
        if !rhs.is_finite() {
            let message = format!("the constant of the row is {rhs}, not a finite number");
            return fail(None, message);
        }
        if matrix.start[i] > matrix.start[i + 1] {
            return fail(None, "the row is inconsistent".into());
        }
        let mut last = None;
        for (j, v) in matrix.row(i) {
            if j >= n || last.is_some_and(|k| k >= j) {
                return fail(None, "the row is inconsistent".into());
            }
            if !v.is_finite() {
                let message = format!("the coefficient is {v}, not a finite number");
                return fail(Some(j), message);
            }
            last = Some(j);
        }
    }
    Ok(())
}

impl Form {
    /// Checks an instance and brings it into the solvers' form.
    pub fn new(instance: &Instance) -> Result<Self, SolveError> {
        validate(instance)?;
        Ok(Self::made(instance, definition(instance)))
    }

    /// As [`Form::new`], without rounding: the objective variable goes only where dividing by its
    /// coefficient is exact.
    pub fn exact(instance: &Instance) -> Result<Self, SolveError> {
        validate(instance)?;
        let power = |d: &Definition| d.coefficient.to_bits().trailing_zeros() >= 52;
        Ok(Self::made(instance, definition(instance).filter(power)))
    }

    /// The part of a basis of the instance that belongs to the problem.
    pub fn basis(&self, of_instance: &[BasisStatus]) -> Basis {
        self.places().map(|k| of_instance[k]).collect()
    }

    /// A basis of the problem as one of the instance; what the problem does not have is basic.
    pub fn instance_basis(&self, basis: &[BasisStatus]) -> Basis {
        let mut out = vec![BasisStatus::Basic; self.instance_columns + self.instance_rows];
        let places = self.places().zip(basis);
        places.for_each(|(k, &status)| out[k] = status);
        out
    }

    /// Where the columns, then the rows, are in a basis of the instance.
    fn places(&self) -> impl Iterator<Item = usize> + '_ {
        let columns = self.columns.iter().map(|&j| j as usize);
        let rows = self.rows.iter();
        columns.chain(rows.map(|&i| self.instance_columns + i as usize))
    }

    fn made(instance: &Instance, definition: Option<Definition>) -> Self {
        let (m, n) = (instance.row_count(), instance.column_count());
        let sign = instance.sign();
        let mut number = vec![u32::MAX; n];
        let mut columns = Vec::with_capacity(n);
        let mut problem = Problem::default();
        for (j, number) in number.iter_mut().enumerate() {
            if definition.is_some_and(|d| d.column == j) {
                continue;
            }
            *number = columns.len() as u32;
            columns.push(j as u32);
            problem.lower.push(infinite(instance.columns.lower[j]));
            problem.upper.push(infinite(instance.columns.upper[j]));
        }
        problem.cost = vec![0.0; columns.len()];
        let mut rows = Vec::with_capacity(m);
        for i in 0..m {
            let rhs = instance.rows.rhs[i];
            if let Some(d) = definition.filter(|d| d.row == i) {
                problem.offset = sign * rhs / d.coefficient;
                for (j, v) in instance.matrix.row(i).filter(|&(j, _)| j != d.column) {
                    problem.cost[number[j] as usize] = -sign * v / d.coefficient;
                }
                continue;
            }
            let (lo, hi) = match instance.rows.relation[i] {
                Relation::Equal => (rhs, rhs),
                Relation::Greater => (rhs, f64::INFINITY),
                Relation::Less => (f64::NEG_INFINITY, rhs),
                Relation::Free => continue,
            };
            let empty = instance.matrix.start[i] == instance.matrix.start[i + 1];
            if empty && lo <= 0.0 && hi >= 0.0 {
                continue;
            }
            rows.push(i as u32);
            problem.row_lower.push(lo);
            problem.row_upper.push(hi);
            problem
                .rows
                .push(instance.matrix.row(i).map(|(j, v)| (number[j] as usize, v)));
        }
        if let (Some(o), None) = (instance.objective, definition) {
            problem.cost[number[o.column as usize] as usize] = sign;
        }
        problem.columns = problem.rows.transpose(columns.len());
        Self {
            problem,
            columns,
            rows,
            sign,
            definition,
            instance_rows: m,
            instance_columns: n,
        }
    }

    /// The problem's point for one of the instance.
    pub fn near(&self, outcome: &Outcome) -> Point {
        let pick = |values: &[f64], places: &[u32], sign: f64| -> Vec<f64> {
            let value = |&k: &u32| values.get(k as usize).map_or(0.0, |v| sign * v);
            places.iter().map(value).collect()
        };
        Point {
            x: pick(&outcome.level, &self.columns, 1.0),
            y: pick(&outcome.row_marginal, &self.rows, self.sign),
            d: pick(&outcome.column_marginal, &self.columns, self.sign),
        }
    }

    /// Levels, row marginals and column marginals of the instance for a point of the problem.
    pub fn point(&self, instance: &Instance, p: &Point) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let mut level = vec![0.0; self.instance_columns];
        let mut reduced = vec![0.0; self.instance_columns];
        let mut marginal = vec![0.0; self.instance_rows];
        for (k, &j) in self.columns.iter().enumerate() {
            level[j as usize] = p.x[k];
            reduced[j as usize] = self.sign * p.d[k] + 0.0;
        }
        for (k, &i) in self.rows.iter().enumerate() {
            marginal[i as usize] = self.sign * p.y[k] + 0.0;
        }
        if let Some(d) = self.definition {
            level[d.column] = self.defined(instance, d, &level, instance.rows.rhs[d.row]);
            marginal[d.row] = 1.0 / d.coefficient;
        }
        (level, marginal, reduced)
    }

    /// A direction of the instance's columns for one of the problem's.
    pub fn direction(&self, instance: &Instance, x: &[f64]) -> Vec<f64> {
        let mut ray = vec![0.0; self.instance_columns];
        for (k, &j) in self.columns.iter().enumerate() {
            ray[j as usize] = x[k];
        }
        if let Some(d) = self.definition {
            ray[d.column] = self.defined(instance, d, &ray, 0.0);
        }
        ray
    }

    /// Multipliers of the instance's rows for those of the problem (a proof of infeasibility).
    pub fn multipliers(&self, y: &[f64]) -> Vec<f64> {
        let mut ray = vec![0.0; self.instance_rows];
        for (k, &i) in self.rows.iter().enumerate() {
            ray[i as usize] = y[k];
        }
        ray
    }

    fn defined(&self, instance: &Instance, d: Definition, x: &[f64], rhs: f64) -> f64 {
        let others = instance.matrix.row(d.row).filter(|&(j, _)| j != d.column);
        (rhs - others.map(|(j, v)| v * x[j]).sum::<f64>()) / d.coefficient
    }
}

/// The one equation in which a free objective variable stands, if that is all it does.
fn definition(instance: &Instance) -> Option<Definition> {
    let column = instance.objective?.column as usize;
    let (row, coefficient) = instance.objective_row()?;
    let defines = instance.is_free(column) && instance.rows.relation[row] == Relation::Equal;
    defines.then_some(Definition {
        row,
        column,
        coefficient,
    })
}
/// The smallest and the largest value of a sum: the finite part, how many terms have no end, and the largest size of a
/// term.
#[derive(Clone, Copy, Default)]
pub struct Activity {
    ends: [f64; 2],
    /// How many of the terms have no end.
    pub endless: [u32; 2],
    /// Of the finite ones.
    pub size: f64,
}

impl Activity {
    /// Of terms whose columns are within these bounds.
    pub fn of(terms: impl Iterator<Item = (usize, f64)>, lower: &[f64], upper: &[f64]) -> Self {
        let mut out = Self::default();
        for (j, a) in terms {
            for (k, v) in term(a, [lower[j], upper[j]]).into_iter().enumerate() {
                if v.is_finite() {
                    out.ends[k] += v;
                    out.size = out.size.max(v.abs());
                } else {
                    out.endless[k] += 1;
                }
            }
        }
        out
    }

    /// The smallest value.
    pub fn low(&self) -> f64 {
        if self.endless[0] > 0 {
            f64::NEG_INFINITY
        } else {
            self.ends[0]
        }
    }

    /// The largest value.
    pub fn high(&self) -> f64 {
        if self.endless[1] > 0 {
            f64::INFINITY
        } else {
            self.ends[1]
        }
    }

    /// The smallest and the largest value without a term.
    pub fn without(&self, term: [f64; 2]) -> [f64; 2] {
        let infinite = [f64::NEG_INFINITY, f64::INFINITY];
        std::array::from_fn(|k| {
            let own = u32::from(!term[k].is_finite());
            match self.endless[k] - own {
                0 if own == 1 => self.ends[k],
                0 => self.ends[k] - term[k],
                _ => infinite[k],
            }
        })
    }
}

/// The ends of a·x for x between bounds.
pub fn term(a: f64, [l, u]: [f64; 2]) -> [f64; 2] {
    if a > 0.0 {
        [a * l, a * u]
    } else {
        [a * u, a * l]
    }
}
