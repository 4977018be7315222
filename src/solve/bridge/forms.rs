//! Convex forms: a column in place of each, bounded by tangents.
//!
//! ```text
//!     c + gᵀx + Σₖ fₖ(x) ≤ 0      ⟺      c + gᵀx + Σₖ wₖ ≤ 0,    wₖ ≥ fₖ(x)
//! ```
//!
//! The terms of a row are such forms where the rules of composition say that they are convex ([`composed`]). What is
//! quadratic in it, ½ xᵀHx, falls apart into blocks of columns that no entry of H joins. Each gets a column of its own: tangents of many
//! small forms say far more than one of their sum (Hijazi, Bonami & Ouorou 2014). Where the columns of a form are 0 whenever a binary
//! u is, the tangents are those of u·f(x/u) (Frangioni & Gentile 2006); where it is one integer column, lines through neighbouring
//! integers. An equation that may be relaxed is an inequality here ([`Directions`]), and so is a second-order cone (Lobo et al. 1998):
//!
//! ```text
//!     q(x) ≤ y z,   y, z ≥ 0      ⟺      w ≤ y + z,    w ≥ (4 q(x) + (y − z)²)^½
//! ```
//!
//! where q is quadratic, convex and nowhere below 0, and y and z may be the same column.
//! The new columns come last, so that a point begins with that of the program itself.

use super::builder::Builder;
use super::direction::Directions;
use super::parts::{directions, expressions};
use crate::autodiff::{Degree, Evaluator};
use crate::model::builder::Term;
use crate::model::instance::{ColumnKind, Instance, Relation};
use crate::solve::nlp::composition::{Composed, composed};
use crate::solve::nlp::convex::{Shape, hessian, is_convex, shape};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// Of a column that is this near to 0 its switch says nothing.
const OFF: f64 = 1e-6;

/// Columns of a form without a switch, or sums of them, at most.
const MAX_COLUMNS: usize = 3;

/// Forms that are not quadratic, at most: each has an evaluator of its own.
const MAX_OTHERS: usize = 2000;

/// Where a form has no tangent, it is tried these parts of the way to a point where it has one.
const TOWARDS: [f64; 6] = [0.0, 1e-6, 1e-3, 0.1, 0.5, 1.0];

/// A convex program as a linear one, but for its forms.
pub(in crate::solve) struct WithForms {
    /// The linear program.
    pub(in crate::solve) instance: Instance,
    /// What its last columns stand for, in order.
    pub(in crate::solve) forms: Vec<Form>,
    /// The program with inequalities in place of equations, if there are such.
    pub(in crate::solve) relaxed: Option<Instance>,
    /// Some forms are norms: of the program's own rows there may be points that satisfy the conditions of first order and are
    /// not the best, where a square is 0.
    pub(in crate::solve) has_cones: bool,
}

/// Entries of a matrix, by positions among the columns of its form.
type Entries = Vec<(u32, u32, f64)>;

/// A convex function of some columns.
enum Function {
    /// ½ xᵀHx; both triangles of H.
    Quadratic(Entries),
    /// (½ x̃ᵀHx̃)^½, where x̃ is x and a 1 behind it; both triangles of H.
    Norm(Entries),
    /// The only row of an instance in these columns.
    Other(Box<RefCell<Evaluator>>),
}

/// A convex form, and the column that is not below it.
pub(in crate::solve) struct Form {
    pub(in crate::solve) column: u32,
    /// The columns of x.
    columns: Vec<u32>,
    function: Function,
    /// Its value at 0.
    at_zero: f64,
    /// A binary column; x is 0 where it is.
    switch: Option<u32>,
    /// x is one integer column.
    whole: bool,
    /// How many affine expressions it depends on its columns by, at most.
    sums: usize,
    /// Values of its columns where it has a tangent.
    inside: Option<Vec<f64>>,
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

impl Function {
    /// Its value; None where it has none.
    fn value(&self, x: &[f64]) -> Option<f64> {
        match self {
            Self::Quadratic(entries) => {
                let terms = entries.iter();
                let sum: f64 = terms
                    .map(|&(i, j, h)| h * x[i as usize] * x[j as usize])
                    .sum();
                Some(0.5 * sum)
            }
            Self::Norm(entries) => {
                let one = |i: u32| x.get(i as usize).unwrap_or(&1.0);
                let terms = entries.iter().map(|&(i, j, h)| h * one(i) * one(j));
                Some((0.5 * terms.sum::<f64>()).max(0.0).sqrt())
            }
            Self::Other(evaluator) => {
                let mut value = [0.0];
                evaluator.borrow_mut().rows(x, &mut value).ok()?;
                value[0].is_finite().then_some(value[0])
            }
        }
    }

    /// Its gradient; None where it has none.
    fn gradient(&self, x: &[f64]) -> Option<Vec<f64>> {
        let mut slope = vec![0.0; x.len()];
        match self {
            Self::Quadratic(entries) => {
                for &(i, j, h) in entries {
                    slope[i as usize] += h * x[j as usize];
                }
            }
            Self::Norm(entries) => {
                let value = self.value(x)?;
                for &(i, j, h) in entries.iter().filter(|e| (e.0 as usize) < x.len()) {
                    slope[i as usize] += 0.5 * h * x.get(j as usize).unwrap_or(&1.0) / value;
                }
            }
            Self::Other(evaluator) => {
                let mut evaluator = evaluator.borrow_mut();
                let column = evaluator.jacobian_pattern().1.to_vec();
                let mut values = vec![0.0; column.len()];
                evaluator.jacobian(x, &mut values).ok()?;
                for (j, v) in column.into_iter().zip(values) {
                    slope[j as usize] = v;
                }
            }
        }
        slope.iter().all(|v| v.is_finite()).then_some(slope)
    }
}

impl Form {
    /// Of a term, times its weight.
    fn new(
        instance: &Instance,
        column: usize,
        term: &Term,
        weight: f64,
        switches: &Switches,
    ) -> Self {
        let mut columns = term.columns.clone();
        columns.sort_unstable();
        columns.dedup();
        let mut alone = Instance::default();
        for &j in &columns {
            let c = &instance.columns;
            alone.columns.push(c.lower[j as usize], c.upper[j as usize]);
        }
        let mut own = term.clone();
        for j in &mut own.columns {
            *j = columns.partition_point(|k| *k < *j) as u32;
        }
        alone.add_row([], Relation::Free, 0.0);
        alone.add_term(0, weight, own);
        let function = Function::Other(Box::new(RefCell::new(Evaluator::first_order(&alone))));
        let at_zero = function.value(&vec![0.0; columns.len()]);
        Self {
            column: column as u32,
            switch: at_zero.and_then(|_| common_switch(switches, &columns)),
            whole: is_whole(instance, &columns),
            sums: term.sums(),
            columns,
            function,
            at_zero: at_zero.unwrap_or(0.0),
            inside: None,
        }
    }

    /// Goes into a row of a program in the making, and starts at its value.
    fn put(self, row: usize, direction: f64, builder: &mut Builder, forms: &mut Vec<Self>) {
        let level = self.value(&builder.columns.level);
        builder.columns.level[self.column as usize] = level.unwrap_or(0.0);
        builder.entries.push((row, self.column, direction));
        forms.push(self);
    }

    /// All columns that its tangents have.
    pub(in crate::solve) fn all_columns(&self) -> impl Iterator<Item = u32> + '_ {
        let own = self.columns.iter().copied();
        own.chain(self.switch).chain([self.column])
    }

    /// Whether few tangents say what it is: of a form of many columns the nonlinear solver knows more.
    pub(in crate::solve) fn is_small(&self) -> bool {
        self.sums.min(self.columns.len()) <= MAX_COLUMNS || self.switch.is_some()
    }

    fn own(&self, x: &[f64]) -> Vec<f64> {
        self.columns.iter().map(|&j| x[j as usize]).collect()
    }

    /// Its value; None where it has none.
    pub(in crate::solve) fn value(&self, x: &[f64]) -> Option<f64> {
        self.function.value(&self.own(x))
    }

    /// A point where it has a tangent, if it has one there.
    pub(in crate::solve) fn stay_inside(&mut self, x: &[f64]) {
        let own = self.own(x);
        if self.function.gradient(&own).is_some() {
            self.inside = Some(own);
        }
    }

    /// Lines through its values at the integers around the value of its only column.
    fn lines(&self, x: f64) -> Option<Vec<Tangent>> {
        let line = |k: i64| {
            let [low, high] = [k as f64, (k + 1) as f64];
            let (f, next) = (self.function.value(&[low])?, self.function.value(&[high])?);
            Some(Tangent {
                terms: vec![(self.columns[0], next - f), (self.column, -1.0)],
                side: (next - f) * low - f,
            })
        };
        ((x - OFF).floor() as i64..=(x + OFF).floor() as i64)
            .map(line)
            .collect()
    }

    /// Tangents that are near at a point.
    pub(in crate::solve) fn tangents(&self, x: &[f64]) -> Vec<Tangent> {
        let own = self.own(x);
        if self.whole
            && let Some(lines) = self.lines(own[0])
        {
            return lines;
        }
        let on = self.switch.map_or(1.0, |u| x[u as usize]);
        if on < OFF {
            return Vec::new();
        }
        let there = |part: f64| {
            let moved = |(x, to): (&f64, &f64)| x / on + part * (to - x / on);
            let own: Vec<f64> = match (&self.inside, part > 0.0) {
                (Some(inside), true) => own.iter().zip(inside).map(moved).collect(),
                _ => own.iter().map(|x| x / on).collect(),
            };
            let value = self.function.value(&own)?;
            Some((value, self.function.gradient(&own)?, own))
        };
        let Some((value, slope, at)) = TOWARDS.into_iter().find_map(there) else {
            return Vec::new();
        };
        // slope·x − w ≤ slope·at − value
        let side = slope.iter().zip(&at).map(|(a, x)| a * x).sum::<f64>() - value;
        let mut terms: Vec<(u32, f64)> = self.columns.iter().copied().zip(slope).collect();
        terms.retain(|t| t.1 != 0.0);
        terms.push((self.column, -1.0));
        let side = match self.switch {
            Some(u) => {
                let steep = -side - self.at_zero;
                match terms.iter_mut().find(|t| t.0 == u) {
                    Some(own) => own.1 += steep,
                    None => terms.push((u, steep)),
                }
                -self.at_zero
            }
            None => side,
        };
        vec![Tangent { terms, side }]
    }
}

/// Terms of a program that are no quadratic ones, as forms, and what is left.
struct Split {
    /// The program with columns in their place.
    rest: Instance,
    forms: Vec<Form>,
    /// What rows are where equations are relaxed, if there are such.
    relations: Option<Vec<Relation>>,
}

impl Split {
    /// None: a term is not known to be convex, or there are too many. The last columns stand for these forms already.
    fn new(instance: &Instance, mut forms: Vec<Form>, switches: &Switches) -> Option<Self> {
        let mut builder = Builder::new(instance);
        let mut parts: BTreeMap<usize, Vec<(f64, Term)>> = BTreeMap::new();
        for (row, coefficient, term) in expressions(instance) {
            if instance.rows.relation[row] == Relation::Free {
                continue;
            }
            let nonlinear = builder.place_linear(row, term.parts(coefficient));
            parts.entry(row).or_default().extend(nonlinear);
        }
        let (mut direction, mut relations) = (directions(instance), None);
        for (row, parts) in parts {
            let known: Vec<_> = parts
                .iter()
                .map(|p| composed(&p.1, &instance.columns))
                .collect();
            let fits = |way: f64| {
                let fit =
                    |(p, k): (&(f64, Term), &Composed)| k.degree <= 2 || k.times(way * p.0).convex;
                parts.iter().zip(&known).all(fit)
            };
            if direction[row] == 0.0 {
                let (directions, relaxed) = relations.get_or_insert_with(|| {
                    (Directions::new(instance), instance.rows.relation.clone())
                });
                let may = |way: &f64| fits(*way) && directions.can_relax(row, *way > 0.0);
                direction[row] = [1.0, -1.0].into_iter().find(may)?;
                relaxed[row] = match direction[row] > 0.0 {
                    true => Relation::Less,
                    false => Relation::Greater,
                };
                builder.rows.relation[row] = relaxed[row];
            } else if !fits(direction[row]) {
                return None;
            }
            for ((weight, term), known) in parts.into_iter().zip(known) {
                if known.degree <= 2 {
                    builder.push_term(row, weight, term);
                    continue;
                }
                if forms.len() == MAX_OTHERS {
                    return None;
                }
                let weight = direction[row] * weight;
                let least = known.times(weight).range.low;
                let column = builder.columns.push(least, f64::INFINITY);
                let form = Form::new(instance, column, &term, weight, switches);
                form.put(row, direction[row], &mut builder, &mut forms);
            }
        }
        Some(Self {
            rest: builder.finish_discrete(instance),
            forms,
            relations: relations.map(|r| r.1),
        })
    }
}

/// Whether it is one integer column.
fn is_whole(instance: &Instance, columns: &[u32]) -> bool {
    matches!(columns, &[j] if instance.columns.kind[j as usize] == ColumnKind::Integer)
}

/// The linear program of a convex one and its forms. None: it is not known to be convex, or cannot be evaluated.
pub(in crate::solve) fn with_forms(instance: &Instance) -> Option<WithForms> {
    let all_switches = switches(instance, &instance.nonlinear_rows());
    let known = shape(instance);
    let (without, forms) = match known {
        Shape::Linear => return None,
        Shape::ConvexQuadratic { .. } => return with_squares(instance, Vec::new(), &all_switches),
        _ => without_cones(instance).unzip(),
    };
    let (has_cones, program) = (without.is_some(), without.as_ref().unwrap_or(instance));
    let split = Split::new(program, forms.unwrap_or_default(), &all_switches)?;
    let out = match shape(&split.rest) {
        Shape::Linear => WithForms {
            instance: split.rest,
            forms: split.forms,
            relaxed: None,
            has_cones: false,
        },
        Shape::ConvexQuadratic { .. } => with_squares(&split.rest, split.forms, &all_switches)?,
        _ => return None,
    };
    let relaxed = split.relations.map(|relation| {
        let mut relaxed = instance.clone();
        relaxed.rows.relation = relation;
        relaxed
    });
    Some(WithForms {
        relaxed,
        has_cones,
        ..out
    })
}

/// A program with columns of norms in place of its second-order cones, if it has some and no other row that is quadratic and
/// not convex.
fn without_cones(instance: &Instance) -> Option<(Instance, Vec<Form>)> {
    let mut evaluator = Evaluator::new(instance);
    let degrees = evaluator.degrees();
    let origin = vec![0.0; instance.column_count()];
    let (activity, slopes) = evaluator.linearised(&origin).ok()?;
    let direction = directions(instance);
    let mut builder = Builder::new(instance);
    let mut cones = BTreeMap::new();
    for row in (0..degrees.len()).filter(|&i| degrees[i] == Degree::Quadratic) {
        let sign = direction[row];
        let all = hessian(instance, &mut evaluator, row, sign)?;
        if sign == 0.0 || is_convex(origin.len(), &all, 1.0) {
            continue;
        }
        let constant = sign * (activity[row] - instance.rows.rhs[row]);
        let linear = slopes[row].iter().map(|&(j, v)| (j, sign * v));
        cones.insert(row, cone(instance, &all, linear, constant)?);
    }
    builder.entries.retain(|e| !cones.contains_key(&e.0));
    for (row, coefficient, term) in expressions(instance) {
        if !cones.contains_key(&row) {
            builder.push_term(row, coefficient, term);
        }
    }
    let mut forms = Vec::new();
    for (row, ([y, z], mut form)) in cones {
        let sign = direction[row];
        form.column = builder.columns.push(0.0, f64::INFINITY) as u32;
        builder.entries.extend([(row, y, -sign), (row, z, -sign)]);
        builder.rows.rhs[row] = 0.0;
        form.put(row, sign, &mut builder, &mut forms);
    }
    (!forms.is_empty()).then(|| (builder.finish_discrete(instance), forms))
}

/// A cone ½ xᵀHx + gᵀx + c ≤ a y z, all on the left side: y and z, and the norm that is not above y + z.
fn cone(
    instance: &Instance,
    hessian: &[(usize, usize, f64)],
    linear: impl Iterator<Item = (usize, f64)>,
    constant: f64,
) -> Option<([u32; 2], Form)> {
    let diagonal = hessian.iter().filter(|e| e.0 == e.1 && e.2 > 0.0);
    let mut curved: BTreeSet<usize> = diagonal.map(|e| e.0).collect();
    let all: BTreeSet<usize> = hessian.iter().map(|e| e.0).collect();
    let sides = &all - &curved;
    let (y, z) = (*sides.first()?, *sides.last()?);
    let of_sides: Vec<_> = hessian.iter().filter(|e| sides.contains(&e.0)).collect();
    let a = match of_sides[..] {
        [e] if e.1 == y => -0.5 * e.2,
        [e, f] if (e.0, e.1) == (f.1, f.0) => -e.2,
        _ => return None,
    };
    let linear: Vec<(usize, f64)> = linear.filter(|s| s.1 != 0.0).collect();
    let lower = &instance.columns.lower;
    let fits = linear.iter().all(|s| curved.contains(&s.0));
    if !fits || a <= 0.0 || lower[y] < 0.0 || lower[z] < 0.0 {
        return None;
    }
    let sums = curved.len();
    if y != z {
        curved.extend([y, z]);
    }
    let columns: Vec<usize> = curved.into_iter().collect();
    let one = columns.len();
    let place = |j: usize| columns.partition_point(|&k| k < j);
    let of_x = hessian.iter().filter(|e| !sides.contains(&e.0));
    let mut entries: Vec<_> = of_x
        .map(|e| (place(e.0), place(e.1), e.2 * 4.0 / a))
        .collect();
    for (j, v) in linear {
        let v = v * 4.0 / a;
        entries.extend([(place(j), one, v), (one, place(j), v)]);
    }
    entries.push((one, one, 2.0 * constant * 4.0 / a));
    if !is_convex(one + 1, &entries, 1.0) {
        return None;
    }
    if y != z {
        let (y, z) = (place(y), place(z));
        entries.extend([(y, y, 2.0), (z, z, 2.0), (y, z, -2.0), (z, y, -2.0)]);
    }
    let narrow = |(i, j, v): (usize, usize, f64)| (i as u32, j as u32, v);
    let form = Form {
        column: 0,
        sums,
        columns: columns.into_iter().map(|j| j as u32).collect(),
        function: Function::Norm(entries.into_iter().map(narrow).collect()),
        at_zero: 0.0,
        switch: None,
        whole: false,
        inside: None,
    };
    Some(([y as u32, z as u32], form))
}

/// The linear program of a convex quadratic one and its forms, after those that stand in it already. None: it cannot be evaluated.
fn with_squares(
    instance: &Instance,
    mut forms: Vec<Form>,
    switches: &Switches,
) -> Option<WithForms> {
    let mut evaluator = Evaluator::new(instance);
    let origin = vec![0.0; instance.column_count()];
    let (activity, slopes) = evaluator.linearised(&origin).ok()?;
    let (direction, nonlinear) = (directions(instance), instance.nonlinear_rows());
    let mut builder = Builder::new(instance);
    builder.entries.retain(|e| !nonlinear[e.0]);
    for row in (0..nonlinear.len()).filter(|&i| nonlinear[i]) {
        builder.rows.rhs[row] -= activity[row];
        let linear = slopes[row].iter().map(|&(j, v)| (row, j as u32, v));
        builder.entries.extend(linear);
        let all = hessian(instance, &mut evaluator, row, direction[row])?;
        for (columns, entries) in blocks(&all) {
            let column = builder.columns.push(0.0, f64::INFINITY);
            let form = Form {
                column: column as u32,
                switch: common_switch(switches, &columns),
                whole: is_whole(instance, &columns),
                sums: columns.len(),
                columns,
                function: Function::Quadratic(entries),
                at_zero: 0.0,
                inside: None,
            };
            form.put(row, direction[row], &mut builder, &mut forms);
        }
    }
    Some(WithForms {
        instance: builder.finish_discrete(instance),
        forms,
        relaxed: None,
        has_cones: false,
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
