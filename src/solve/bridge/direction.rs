//! Which equations may be relaxed: those in which a variable can make up for what is lost, at no harm elsewhere.
//!
//! In `y =e= abs(x)`, with y only in `y =l= z` and z minimised, `y =g= abs(x)` will do: whoever has a solution of this may
//! lower y until the equation holds.

use crate::autodiff::Evaluator;
use crate::model::builder::Term;
use crate::model::instance::{ColumnKind, Function, Instance, Op, Relation};
use crate::solve::bridge::parts::expressions;
use std::collections::BTreeMap;

/// How far the chain of variables that make up for each other is followed.
const DEPTH: usize = 8;

/// Equations that are looked at for one: their number grows with the depth as that of ways through a network does.
const LOOKS: usize = 1000;

/// Rounds in which variables make up for each other.
const SWEEPS: usize = 20;

/// Moves the columns that make up for equations until these hold. None where a row has no value.
pub(in crate::solve) fn make_up(
    instance: &Instance,
    makes_up: &BTreeMap<usize, usize>,
    level: &mut [f64],
) -> Option<()> {
    let mut evaluator = Evaluator::first_order(instance);
    let mut activity = vec![0.0; instance.row_count()];
    for _ in 0..SWEEPS {
        evaluator.rows(level, &mut activity).ok()?;
        let mut moved = false;
        for (&i, &j) in makes_up {
            let a = instance.matrix.row(i).find(|e| e.0 == j)?.1;
            let gap = instance.rows.rhs[i] - activity[i];
            moved |= gap != 0.0;
            level[j] += gap / a;
        }
        if !moved {
            break;
        }
    }
    Some(())
}

/// How a value depends on a variable.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Slope {
    None,
    Up,
    Down,
    Unknown,
}

impl Slope {
    fn of(coefficient: f64) -> Self {
        match coefficient {
            c if c > 0.0 => Self::Up,
            c if c < 0.0 => Self::Down,
            0.0 => Self::None,
            _ => Self::Unknown,
        }
    }

    fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::None, s) | (s, Self::None) => s,
            (a, b) if a == b => a,
            _ => Self::Unknown,
        }
    }

    fn times(self, factor: f64) -> Self {
        match (self, Self::of(factor)) {
            (Self::None, _) | (_, Self::None) => Self::None,
            (s, Self::Up) => s,
            (Self::Up, Self::Down) => Self::Down,
            (Self::Down, Self::Down) => Self::Up,
            _ => Self::Unknown,
        }
    }
}

/// The rows that a column stands in, with its coefficients and terms.
pub(in crate::solve) struct Directions<'i> {
    instance: &'i Instance,
    /// By column: linear entries (row, coefficient).
    linear: Vec<Vec<(usize, f64)>>,
    /// By column: nonlinear terms (row, coefficient, number).
    nonlinear: Vec<Vec<(usize, f64, usize)>>,
    terms: Vec<Term>,
    /// By row: columns in its nonlinear terms.
    inside: Vec<Vec<u32>>,
    /// By equation: the column that makes it hold.
    pub(in crate::solve) makes_up: BTreeMap<usize, usize>,
    /// Looks that are left.
    looks: usize,
}

impl<'i> Directions<'i> {
    pub(in crate::solve) fn new(instance: &'i Instance) -> Self {
        let (n, m) = (instance.column_count(), instance.row_count());
        let mut out = Self {
            instance,
            linear: vec![Vec::new(); n],
            nonlinear: vec![Vec::new(); n],
            terms: Vec::new(),
            inside: vec![Vec::new(); m],
            makes_up: BTreeMap::new(),
            looks: 0,
        };
        for i in 0..m {
            for (j, a) in instance.matrix.row(i) {
                out.linear[j].push((i, a));
            }
        }
        for (row, coefficient, term) in expressions(instance) {
            let mut columns = term.columns.clone();
            columns.sort_unstable();
            columns.dedup();
            for &j in &columns {
                out.nonlinear[j as usize].push((row, coefficient, out.terms.len()));
            }
            out.inside[row].extend(columns);
            out.terms.push(term);
        }
        out
    }

    /// Whether what the left side of this equation lacks (or has too much of) can be made up for; by what is noted.
    pub(in crate::solve) fn can_relax(&mut self, row: usize, lacks: bool) -> bool {
        self.looks = LOOKS;
        self.compensator(row, lacks, DEPTH)
    }

    fn compensator(&mut self, row: usize, lacks: bool, depth: usize) -> bool {
        if depth == 0 || self.looks == 0 {
            return false;
        }
        self.looks -= 1;
        let instance = self.instance;
        let c = &instance.columns;
        let free = |j: usize| c.kind[j] == ColumnKind::Continuous && c.lower[j] != c.upper[j];
        let linear = instance.matrix.row(row).filter(|e| free(e.0));
        let mut columns: Vec<(usize, f64)> = linear
            .filter(|e| !self.inside[row].contains(&(e.0 as u32)))
            .collect();
        // one that stands in few other rows is likely to do
        columns.sort_by_key(|e| self.linear[e.0].len() + self.nonlinear[e.0].len());
        for (j, a) in columns {
            let noted = self.makes_up.clone();
            if noted.get(&row).is_none_or(|&k| k == j)
                && self.is_harmless(j, (a > 0.0) == lacks, row, depth)
            {
                self.makes_up.insert(row, j);
                return true;
            }
            self.makes_up = noted;
        }
        false
    }

    /// Whether a column may grow (or fall) without harm to the objective and to all rows but one.
    fn is_harmless(&mut self, column: usize, grows: bool, except: usize, depth: usize) -> bool {
        let objective = self.instance.objective;
        if objective.is_some_and(|o| o.column as usize == column && (o.sense.sign() > 0.0) == grows)
        {
            return false;
        }
        let mut effect: BTreeMap<usize, Slope> = BTreeMap::new();
        let mut see = |row: usize, slope: Slope| {
            let entry = effect.entry(row).or_insert(Slope::None);
            *entry = entry.and(slope);
        };
        for &(row, a) in &self.linear[column] {
            see(row, Slope::of(a));
        }
        for &(row, coefficient, term) in &self.nonlinear[column] {
            see(
                row,
                slope(&self.terms[term], column as u32).times(coefficient),
            );
        }
        let step = if grows { 1.0 } else { -1.0 };
        effect.remove(&except);
        effect.into_iter().all(|(row, slope)| {
            match (self.instance.rows.relation[row], slope.times(step)) {
                (_, Slope::None) | (Relation::Free, _) => true,
                (Relation::Less, Slope::Down) | (Relation::Greater, Slope::Up) => true,
                (Relation::Equal, Slope::Down) => self.compensator(row, true, depth - 1),
                (Relation::Equal, Slope::Up) => self.compensator(row, false, depth - 1),
                _ => false,
            }
        })
    }
}

/// How an expression depends on a column.
fn slope(e: &Term, column: u32) -> Slope {
    // with the number that a value is, if it is one
    let mut stack: Vec<(Slope, Option<f64>)> = Vec::new();
    for &op in &e.ops {
        let a = stack.split_off(stack.len().saturating_sub(op.arguments()));
        let all = a.iter().fold(Slope::None, |s, a| s.and(a.0));
        let of_variable = |k: u32| match e.columns[k as usize] == column {
            true => Slope::Up,
            false => Slope::None,
        };
        stack.push(match (op, &a[..]) {
            (Op::Var(k), _) => (of_variable(k), None),
            (Op::Const(k), _) => (Slope::None, Some(e.constants[k as usize])),
            (Op::Affine(constant, variable, terms), _) => {
                let each = (0..terms).map(|m| {
                    of_variable(variable + m).times(e.constants[(constant + 1 + m) as usize])
                });
                (each.fold(Slope::None, Slope::and), None)
            }
            (Op::Add(_) | Op::Call(Function::Max | Function::Min, _), _) => (all, None),
            (Op::Call(Function::Exp | Function::Log | Function::Sqrt, _), _) => (all, None),
            (Op::Negate, [a]) => (a.0.times(-1.0), a.1.map(|v| -v)),
            (Op::Multiply(_), &[(s, None), (_, Some(c))] | &[(_, Some(c)), (s, None)]) => {
                (s.times(c), None)
            }
            (Op::Divide, &[(s, None), (_, Some(c))]) => (s.times(c), None),
            _ if all == Slope::None => (Slope::None, None),
            _ => (Slope::Unknown, None),
        });
    }
    stack.pop().map_or(Slope::Unknown, |s| s.0)
}
