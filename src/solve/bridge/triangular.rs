//! Columns that equations give one after the other: before the program is solved, or after.
//!
//! An equation of which all columns but one are known determines that one, where it stands linearly: both leave the program,
//! and others may follow (pre-triangular rows). A free column that stands in one equation only, linearly, is defined by it whatever the others
//! are: both leave it as well (post-triangular rows). Drud 1994: CONOPT.
//!
//! The multiplier of a row of the second kind is 0; that of one of the first is what leaves its column no reduced cost.

use super::Bridge;
use crate::autodiff::Evaluator;
use crate::autodiff::functions::{divide, function_value, real_power, whole_power};
use crate::model::instance::{Instance, KernelTerm, KernelTerms, Op, Relation};
use crate::model::problem_type::ProblemType;
use crate::model::sum::Sum;
use crate::solve::answer::Answer;
use crate::solve::backend::{Backend, Reply, Task};
use crate::solve::certificate::nonlinear::KINK_WIDTH;
use crate::solve::{Claim, Settings, Strategy};
use std::cell::Cell;

/// A coefficient is not rounding if it is above this part of what it is the sum of.
const SMALLEST_PIVOT: f64 = 1e-9;
/// A value beyond this is none.
const FARTHEST: f64 = 1e15;
/// A value is within bounds, and a row without open columns holds, to this part of its size.
const HOLDS: f64 = 1e-9;

/// A row and the column that it determines, with the coefficient of the column.
struct Pivot {
    row: usize,
    column: usize,
    slope: f64,
}

/// A program without its triangular rows.
pub struct Triangular {
    instance: Instance,
    using: ProblemType,
    pattern: Pattern,
    before: Vec<Pivot>,
    after: Vec<Pivot>,
    /// A row has no derivatives, and its multiplier is 0: the original cannot be judged.
    irregular: Cell<bool>,
}

/// The columns of each row, and its terms.
struct Pattern {
    start: Vec<usize>,
    column: Vec<u32>,
    /// Rows of each column.
    rows: Vec<Vec<u32>>,
    /// Terms of each row: group and number.
    terms: Vec<Vec<(u32, u32)>>,
}

impl Pattern {
    fn new(instance: &Instance) -> Self {
        let (m, n) = (instance.row_count(), instance.column_count());
        let mut places = instance.nonlinear_places().into_iter().peekable();
        let (mut start, mut column) = (vec![0], Vec::new());
        let mut rows = vec![Vec::new(); n];
        for i in 0..m {
            let first = column.len();
            column.extend(instance.matrix.row(i).map(|e| e.0 as u32));
            while let Some((_, j)) = places.next_if(|p| p.0 as usize == i) {
                column.push(j);
            }
            column[first..].sort_unstable();
            let mut last = first;
            for k in first..column.len() {
                if k == first || column[k] != column[last - 1] {
                    column[last] = column[k];
                    rows[column[k] as usize].push(i as u32);
                    last += 1;
                }
            }
            column.truncate(last);
            start.push(last);
        }
        let mut terms = vec![Vec::new(); m];
        for (g, group) in instance.nonlinear.iter().enumerate() {
            for (t, &i) in group.row.iter().enumerate() {
                terms[i as usize].push((g as u32, t as u32));
            }
        }
        Self {
            start,
            column,
            rows,
            terms,
        }
    }

    fn columns(&self, i: usize) -> &[u32] {
        &self.column[self.start[i]..self.start[i + 1]]
    }

    fn terms<'i>(
        &self,
        instance: &'i Instance,
        i: usize,
    ) -> impl Iterator<Item = (&'i KernelTerms, KernelTerm<'i>)> {
        self.terms[i].iter().map(|&(g, t)| {
            let group = &instance.nonlinear[g as usize];
            (group, group.term(t as usize))
        })
    }

    /// What is left of a row's right-hand side without column j, the coefficient of j, and the sum of the sizes that it is made of. None where j
    /// does not stand linearly, or functions have no value.
    fn without(
        &self,
        instance: &Instance,
        i: usize,
        j: usize,
        level: &[f64],
    ) -> Option<(f64, f64, f64)> {
        let mut rest = Sum::new(instance.rows.rhs[i]);
        let (mut slope, mut size) = (0.0, 0.0_f64);
        for (k, a) in instance.matrix.row(i) {
            if k == j {
                slope += a;
                size += a.abs();
            } else {
                rest.add_product(-a, level[k]);
            }
        }
        for (group, t) in self.terms(instance, i) {
            let (constant, a) = affine(group, t, j, level)?;
            rest.add_product(-t.coef, constant);
            slope += t.coef * a;
            size += (t.coef * a).abs();
        }
        Some((rest.value(), slope, size))
    }

    /// The value of column j that row i gives, and its coefficient.
    fn solved_for(
        &self,
        instance: &Instance,
        i: usize,
        j: usize,
        level: &[f64],
    ) -> Option<(f64, f64)> {
        let (rest, slope, size) = self.without(instance, i, j, level)?;
        let value = rest / slope;
        let pivots = slope.abs() > SMALLEST_PIVOT * size && value.abs() <= FARTHEST;
        pivots.then_some((value, slope))
    }

    /// Whether a row of which all columns are known holds.
    fn holds(&self, instance: &Instance, i: usize, level: &[f64]) -> bool {
        let room = HOLDS * instance.rows.rhs[i].abs().max(1.0);
        let rest = self.without(instance, i, usize::MAX, level);
        rest.is_some_and(|(rest, ..)| match instance.rows.relation[i] {
            Relation::Equal => rest.abs() <= room,
            Relation::Greater => rest <= room,
            Relation::Less => rest >= -room,
            Relation::Free => true,
        })
    }

    /// Rows that give their column one after the other, whose levels they set. None where rows that are known then contradict each other.
    fn first(&self, instance: &Instance, level: &mut [f64]) -> Option<Vec<Pivot>> {
        let (m, columns) = (instance.row_count(), &instance.columns);
        let mut known = vec![false; level.len()];
        for (j, level) in level.iter_mut().enumerate() {
            known[j] = columns.lower[j] == columns.upper[j];
            if known[j] {
                *level = columns.lower[j];
            }
        }
        let unknown = |i: usize, known: &[bool]| {
            let all = self.columns(i).iter().map(|&j| j as usize);
            all.filter(|&j| !known[j]).collect::<Vec<_>>()
        };
        let mut open: Vec<usize> = (0..m).map(|i| unknown(i, &known).len()).collect();
        let gives =
            |i: usize, open: &[usize]| open[i] == 1 && instance.rows.relation[i] == Relation::Equal;
        let mut next: Vec<usize> = (0..m).filter(|&i| gives(i, &open)).collect();
        let mut pivots = Vec::new();
        while let Some(row) = next.pop() {
            let [column] = unknown(row, &known)[..] else {
                continue;
            };
            let Some((value, slope)) = self.solved_for(instance, row, column, level) else {
                continue;
            };
            let within = value.max(columns.lower[column]).min(columns.upper[column]);
            if (value - within).abs() > HOLDS * value.abs().max(1.0) {
                continue;
            }
            (known[column], level[column]) = (true, within);
            pivots.push(Pivot { row, column, slope });
            for &r in &self.rows[column] {
                open[r as usize] -= 1;
                if gives(r as usize, &open) {
                    next.push(r as usize);
                }
            }
        }
        let all_hold =
            pivots.is_empty() || (0..m).all(|i| open[i] > 0 || self.holds(instance, i, level));
        all_hold.then_some(pivots)
    }

    /// Rows that define a free column which no other row needs, once those of `first` have left.
    fn last(&self, instance: &Instance, z: usize, first: &[Pivot]) -> Vec<Pivot> {
        let mut count: Vec<usize> = self.rows.iter().map(Vec::len).collect();
        let mut left_out = vec![false; instance.row_count()];
        for p in first {
            left_out[p.row] = true;
            for &j in self.columns(p.row) {
                count[j as usize] -= 1;
            }
        }
        // known already
        first.iter().for_each(|p| count[p.column] = usize::MAX);
        let alone = |j: usize, count: &[usize]| count[j] == 1 && instance.is_free(j) && j != z;
        let mut next: Vec<usize> = (0..count.len()).filter(|&j| alone(j, &count)).collect();
        let mut pivots = Vec::new();
        while let Some(column) = next.pop() {
            let row = self.rows[column].iter().find(|&&i| !left_out[i as usize]);
            let Some(row) = row.map(|&i| i as usize) else {
                continue;
            };
            let curved = |t: KernelTerm| t.columns.contains(&(column as u32));
            let linear = !self.terms(instance, row).any(|(_, t)| curved(t));
            let entry = instance.matrix.row(row).find(|e| e.0 == column && linear);
            let (Some((_, slope)), Relation::Equal) = (entry, instance.rows.relation[row]) else {
                continue;
            };
            if self.columns(row).contains(&(z as u32)) {
                continue;
            }
            left_out[row] = true;
            pivots.push(Pivot { row, column, slope });
            for &j in self.columns(row) {
                count[j as usize] -= 1;
                if alone(j as usize, &count) {
                    next.push(j as usize);
                }
            }
        }
        pivots
    }
}

/// A term as a + b·x_j at the levels of its other columns. None where j stands in it otherwise, or it has no value.
fn affine(group: &KernelTerms, term: KernelTerm, j: usize, level: &[f64]) -> Option<(f64, f64)> {
    let value = |k: u32| match term.columns[k as usize] as usize {
        c if c == j => (0.0, 1.0),
        c => (level[c], 0.0),
    };
    let constant = |k: u32| term.constants[k as usize];
    let plus = |(a, b): (f64, f64), (c, d): (f64, f64)| (a + c, b + d);
    let times = |(a, b): (f64, f64), (c, d): (f64, f64)| match b == 0.0 || d == 0.0 {
        true => Some((a * c, a * d + b * c)),
        false => None,
    };
    let number = |(a, b): (f64, f64)| (b == 0.0).then_some(a);
    let mut stack: Vec<(f64, f64)> = Vec::new();
    for op in &group.kernel.ops {
        let at = stack.len().saturating_sub(op.arguments());
        let next = match (*op, &stack[at..]) {
            (Op::Var(k), _) => value(k),
            (Op::Const(k), _) => (constant(k), 0.0),
            (Op::Affine(c, v, n), _) => (0..n).fold((constant(c), 0.0), |s, m| {
                let ((a, b), weight) = (value(v + m), constant(c + 1 + m));
                plus(s, (weight * a, weight * b))
            }),
            (Op::Add(_), all) => all.iter().fold((0.0, 0.0), |s, &t| plus(s, t)),
            (Op::Negate, &[a]) => (-a.0, -a.1),
            (Op::Multiply(_), all) => all.iter().try_fold((1.0, 0.0), |s, &t| times(s, t))?,
            (Op::Divide, &[a, b]) => {
                let by = number(b)?;
                (divide(a.0, by).ok()?, divide(a.1, by).ok()?)
            }
            (Op::Power, &[a, b]) => (real_power(number(a)?, number(b)?).ok()?, 0.0),
            (Op::PowerInt(k), &[a]) => (whole_power(number(a)?, k).ok()?, 0.0),
            (Op::Call(f, _), all) => {
                let numbers: Option<Vec<f64>> = all.iter().map(|&a| number(a)).collect();
                (function_value(f, &numbers?).ok()?, 0.0)
            }
            _ => return None,
        };
        stack.truncate(at);
        stack.push(next);
    }
    stack.pop()
}

impl Triangular {
    /// None where there are no such rows.
    fn new(instance: &Instance, using: ProblemType) -> Option<Self> {
        let z = instance.objective?.column as usize;
        let pattern = Pattern::new(instance);
        let mut level = instance.columns.level.clone();
        let before = pattern.first(instance, &mut level)?;
        let after = pattern.last(instance, z, &before);
        if before.is_empty() && after.is_empty() {
            return None;
        }
        let mut reduced = instance.clone();
        for p in before.iter().chain(&after) {
            let known = Some(level[p.column]).filter(|v| v.is_finite());
            let columns = &mut reduced.columns;
            for side in [&mut columns.lower, &mut columns.upper, &mut columns.level] {
                side[p.column] = known.unwrap_or(0.0);
            }
            reduced.rows.relation[p.row] = Relation::Free;
        }
        let stays = |i: usize| reduced.rows.relation[i] != Relation::Free;
        for (group, original) in reduced.nonlinear.iter_mut().zip(&instance.nonlinear) {
            *group = KernelTerms::new(original.kernel.clone());
            for t in original.terms().filter(|t| stays(t.row)) {
                group.push(t.row as u32, t.coef, t.columns, t.constants);
            }
        }
        Some(Self {
            instance: reduced,
            using,
            pattern,
            before,
            after,
            irregular: Cell::new(false),
        })
    }
}

/// Derivatives of the rows at a point. None where they do not exist.
fn jacobian(evaluator: &mut Evaluator, level: &[f64]) -> Option<Vec<f64>> {
    let mut value = vec![0.0; evaluator.jacobian_pattern().1.len()];
    evaluator.jacobian(level, &mut value).ok()?;
    Some(value)
}

impl Bridge for Triangular {
    /// For nonlinear programs in continuous columns.
    fn build(_: &[&dyn Backend], task: &Task, settings: &Settings) -> Option<Self> {
        let instance = task.instance;
        let other = instance.is_linear() || !task.is_continuous();
        if other || task.seen.is_some() {
            return None;
        }
        let made = Self::new(instance, task.using)?;
        settings.runs(Strategy::TriangularRows).then_some(made)
    }

    fn instance(&self) -> &Instance {
        &self.instance
    }

    fn using(&self) -> ProblemType {
        self.using
    }

    fn has_own_multipliers(&self) -> bool {
        self.irregular.get()
    }

    fn restore(&self, instance: &Instance, answer: &Answer) -> Option<Reply> {
        let mut outcome = answer.outcome.clone();
        for p in self.after.iter().rev() {
            let solved = self
                .pattern
                .solved_for(instance, p.row, p.column, &outcome.level);
            outcome.level[p.column] = solved?.0;
        }
        if matches!(outcome.claim, Claim::Infeasible | Claim::LocallyInfeasible) {
            return Some(outcome.into());
        }
        let mut evaluator = Evaluator::first_order(instance);
        let value = jacobian(&mut evaluator, &outcome.level).or_else(|| {
            self.irregular.set(true);
            evaluator = Evaluator::smoothed_first_order(instance, KINK_WIDTH);
            jacobian(&mut evaluator, &outcome.level)
        })?;
        let (start, column) = evaluator.jacobian_pattern();
        let mut reduced = vec![0.0; instance.column_count()];
        reduced[instance.objective?.column as usize] = 1.0;
        let push = |i: usize, multiplier: f64, reduced: &mut [f64]| {
            for k in start[i]..start[i + 1] {
                reduced[column[k] as usize] -= multiplier * value[k];
            }
        };
        for (i, &m) in outcome
            .row_marginal
            .iter()
            .enumerate()
            .filter(|e| *e.1 != 0.0)
        {
            push(i, m, &mut reduced);
        }
        for p in self.before.iter().rev() {
            let multiplier = reduced[p.column] / p.slope;
            outcome.row_marginal[p.row] = multiplier;
            push(p.row, multiplier, &mut reduced);
            outcome.column_marginal[p.column] = 0.0;
        }
        let columns = &instance.columns;
        for j in (0..reduced.len()).filter(|&j| columns.lower[j] == columns.upper[j]) {
            outcome.column_marginal[j] = reduced[j];
        }
        Some(outcome.into())
    }
}
