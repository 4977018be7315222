//! Convex quadratic forms: a column in place of each, bounded by tangents.
//!
//! ```text
//!     c + gᵀx + ½ xᵀHx ≤ 0      ⟺      c + gᵀx + Σₖ wₖ ≤ 0,    wₖ ≥ ½ xᵀHₖx
//! ```
//!
//! H falls apart into blocks of columns that no entry joins. Each gets a column of its own: tangents of many small forms say far
//! more than one of their sum (Hijazi, Bonami & Ouorou 2014). Where the columns of a block are 0 whenever a binary u is, the
//! tangents are those of u·q(x/u) (Frangioni & Gentile 2006); where it is one integer column, lines through neighbouring integers.
//! The new columns come last, so that a point begins with that of the program itself.

use super::builder::Builder;
use super::parts::directions;
use crate::autodiff::Evaluator;
use crate::model::instance::{ColumnKind, Instance, Relation};
use crate::solve::nlp::convex::hessian;
use std::collections::{BTreeMap, BTreeSet};

/// Of a column that is this near to 0 its switch says nothing.
const OFF: f64 = 1e-6;

/// Columns of a form without a switch, at most.
const MAX_COLUMNS: usize = 3;

/// A convex quadratic program as a linear one, but for its squares.
pub(in crate::solve) struct Squared {
    /// The linear program.
    pub(in crate::solve) instance: Instance,
    /// What its last columns stand for, in order.
    pub(in crate::solve) squares: Vec<Square>,
}

/// Entries of a matrix, by positions among the columns of its form.
type Entries = Vec<(u32, u32, f64)>;

/// A form ½ xᵀHx, and the column that is not below it.
#[derive(Debug)]
pub(in crate::solve) struct Square {
    pub(in crate::solve) column: u32,
    /// The columns of x.
    pub(in crate::solve) columns: Vec<u32>,
    /// H, both triangles.
    entries: Entries,
    /// A binary column; x is 0 where it is.
    switch: Option<u32>,
    /// x is one integer column.
    whole: bool,
}

/// A tangent: the sum of its terms is not above `side`.
#[derive(Debug)]
pub(in crate::solve) struct Tangent {
    pub(in crate::solve) terms: Vec<(u32, f64)>,
    pub(in crate::solve) side: f64,
}

impl Tangent {
    /// By how much a point violates it.
    pub(in crate::solve) fn violation(&self, x: &[f64]) -> f64 {
        let terms = self.terms.iter().map(|&(j, a)| a * x[j as usize]);
        terms.sum::<f64>() - self.side
    }
}

impl Square {
    /// All columns that its tangents have.
    pub(in crate::solve) fn all_columns(&self) -> impl Iterator<Item = u32> + '_ {
        let own = self.columns.iter().copied();
        own.chain(self.switch).chain([self.column])
    }

    /// Whether few tangents say what it is: of a form of many columns the nonlinear solver knows more.
    pub(in crate::solve) fn is_small(&self) -> bool {
        self.columns.len() <= MAX_COLUMNS || self.switch.is_some()
    }

    /// Its value.
    pub(in crate::solve) fn value(&self, x: &[f64]) -> f64 {
        let x = |k: u32| x[self.columns[k as usize] as usize];
        let sum: f64 = self.entries.iter().map(|&(i, j, h)| h * x(i) * x(j)).sum();
        0.5 * sum
    }

    /// Tangents that are near at a point.
    pub(in crate::solve) fn tangents(&self, x: &[f64]) -> Vec<Tangent> {
        if self.whole {
            let (j, h) = (self.columns[0], self.entries[0].2);
            let (low, high) = (x[j as usize] - OFF, x[j as usize] + OFF);
            let first = low.floor() as i64..=high.floor() as i64;
            let line = |k: f64| Tangent {
                terms: vec![(j, 0.5 * h * (2.0 * k + 1.0)), (self.column, -1.0)],
                side: 0.5 * h * k * (k + 1.0),
            };
            return first.map(|k| line(k as f64)).collect();
        }
        let on = self.switch.map_or(1.0, |u| x[u as usize]);
        if on < OFF {
            return Vec::new();
        }
        let mut slope = vec![0.0; self.columns.len()];
        for &(i, j, h) in &self.entries {
            slope[i as usize] += h * x[self.columns[j as usize] as usize] / on;
        }
        let value = self.value(x) / (on * on);
        let mut terms: Vec<(u32, f64)> = self.columns.iter().copied().zip(slope).collect();
        terms.retain(|t| t.1 != 0.0);
        terms.push((self.column, -1.0));
        let side = match self.switch {
            Some(u) => {
                match terms.iter_mut().find(|t| t.0 == u) {
                    Some(own) => own.1 -= value,
                    None => terms.push((u, -value)),
                }
                0.0
            }
            None => value,
        };
        vec![Tangent { terms, side }]
    }
}

/// The linear program of a convex quadratic one and its squares. None: it cannot be evaluated.
pub(in crate::solve) fn with_squares(instance: &Instance) -> Option<Squared> {
    let mut evaluator = Evaluator::new(instance);
    let origin = vec![0.0; instance.column_count()];
    let mut activity = vec![0.0; instance.row_count()];
    evaluator.rows(&origin, &mut activity).ok()?;
    let (start, column) = evaluator.jacobian_pattern();
    let (start, column) = (start.to_vec(), column.to_vec());
    let mut slope = vec![0.0; column.len()];
    evaluator.jacobian(&origin, &mut slope).ok()?;
    let (direction, nonlinear) = (directions(instance), instance.nonlinear_rows());
    let switches = switches(instance, &nonlinear);
    let mut builder = Builder::new(instance);
    builder.entries.retain(|e| !nonlinear[e.0]);
    let mut squares = Vec::new();
    for row in (0..nonlinear.len()).filter(|&i| nonlinear[i]) {
        builder.rows.rhs[row] -= activity[row];
        let linear = (start[row]..start[row + 1]).map(|k| (row, column[k], slope[k]));
        builder.entries.extend(linear);
        let all = hessian(instance, &mut evaluator, row, direction[row])?;
        for (columns, entries) in blocks(&all) {
            let column = builder.columns.push(0.0, f64::INFINITY);
            let integer = |&j: &u32| instance.columns.kind[j as usize] == ColumnKind::Integer;
            let square = Square {
                column: column as u32,
                switch: common_switch(&switches, &columns),
                whole: columns.len() == 1 && columns.iter().all(integer),
                columns,
                entries,
            };
            builder.columns.level[column] = square.value(&instance.columns.level);
            builder.entries.push((row, column as u32, direction[row]));
            squares.push(square);
        }
    }
    Some(Squared {
        instance: builder.finish_discrete(instance),
        squares,
    })
}

/// Columns that entries join, with their entries.
fn blocks(hessian: &[(usize, usize, f64)]) -> Vec<(Vec<u32>, Entries)> {
    let mut leader: BTreeMap<usize, usize> = hessian.iter().map(|e| (e.0, e.0)).collect();
    fn find(leader: &BTreeMap<usize, usize>, mut j: usize) -> usize {
        while leader[&j] != j {
            j = leader[&j];
        }
        j
    }
    for &(i, j, _) in hessian {
        let (a, b) = (find(&leader, i), find(&leader, j));
        leader.insert(a.max(b), a.min(b));
    }
    let mut columns: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    for &j in leader.keys() {
        columns.entry(find(&leader, j)).or_default().push(j as u32);
    }
    let mut entries: BTreeMap<usize, Entries> = BTreeMap::new();
    for &(i, j, h) in hessian {
        let block = find(&leader, i);
        let place = |j: usize| columns[&block].partition_point(|&k| (k as usize) < j) as u32;
        let entry = (place(i), place(j), h);
        entries.entry(block).or_default().push(entry);
    }
    columns.into_values().zip(entries.into_values()).collect()
}

/// By column: binaries at whose 0 it is not above 0, and not below.
type Switches = BTreeMap<u32, [BTreeSet<u32>; 2]>;

/// What linear rows say of columns where a binary is 0: a row a x − b u ≤ 0, also with more columns that are not below 0.
fn switches(instance: &Instance, nonlinear: &[bool]) -> Switches {
    let columns = &instance.columns;
    let binary = |j: u32| {
        let j = j as usize;
        let inside = columns.lower[j] >= 0.0 && columns.upper[j] <= 1.0;
        columns.kind[j] == ColumnKind::Integer && inside
    };
    let mut switches = Switches::new();
    for j in (0..instance.column_count() as u32).filter(|&j| binary(j)) {
        switches.insert(j, [[j].into(), [j].into()]);
    }
    for row in (0..instance.row_count()).filter(|&i| !nonlinear[i]) {
        let signs: &[f64] = match instance.rows.relation[row] {
            Relation::Less => &[1.0],
            Relation::Greater => &[-1.0],
            Relation::Equal => &[1.0, -1.0],
            Relation::Free => &[],
        };
        for sign in signs.iter().filter(|s| *s * instance.rows.rhs[row] <= 0.0) {
            let entries = || instance.matrix.row(row).map(|(j, a)| (j as u32, sign * a));
            let least_is_zero = |&(j, a): &(u32, f64)| match a > 0.0 {
                true => columns.lower[j as usize] >= 0.0,
                false => columns.upper[j as usize] <= 0.0,
            };
            let others: Vec<(u32, f64)> = entries().filter(|e| !least_is_zero(e)).take(3).collect();
            let mut held = |(j, a): (u32, f64), u: u32| {
                let side = usize::from(a < 0.0);
                switches.entry(j).or_default()[side].insert(u);
            };
            match others[..] {
                [(u, _)] if binary(u) => entries().filter(|e| e.0 != u).for_each(|e| held(e, u)),
                [(u, b), e] if binary(u) && b < 0.0 => held(e, u),
                [e, (u, b)] if binary(u) && b < 0.0 => held(e, u),
                _ => {}
            }
        }
    }
    for (&j, [above, below]) in &mut switches {
        let (l, u) = (columns.lower[j as usize], columns.upper[j as usize]);
        if l >= 0.0 {
            below.extend(above.iter());
        }
        if u <= 0.0 {
            above.extend(below.iter());
        }
    }
    switches
}

/// A binary at whose 0 all columns are.
fn common_switch(switches: &Switches, columns: &[u32]) -> Option<u32> {
    let off = |j: &u32, u: &u32| {
        switches
            .get(j)
            .is_some_and(|s| s.iter().all(|s| s.contains(u)))
    };
    let (first, rest) = columns.split_first()?;
    let candidates = switches.get(first)?[0].iter().filter(|u| off(first, u));
    candidates.copied().find(|u| rest.iter().all(|j| off(j, u)))
}
