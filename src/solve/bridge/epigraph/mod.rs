//! max, min and abs where they stand convexly: columns and rows in their place.
//!
//! ```text
//!     … + w max(a, b, …) ≤ …,  w > 0      ⟺      … + w v ≤ …,   a ≤ v,  b ≤ v,  …
//! ```
//!
//! and likewise min with w < 0, |a| = max(a, −a), the other direction, an argument that contains one of them again, and an
//! equation that may be relaxed ([`direction`]). What is left is smooth, often linear; its multipliers say with
//! which weights the pieces that meet at a kink count, so that the conditions of first order can be checked there. A program in
//! which one max, min or abs stands otherwise is left as it is.
//!
//! The columns and rows that are added come last: levels and marginals of the program itself come first. Where an equation
//! was relaxed and does not bind, the variable that makes up for it is moved; the point is given back only if it satisfies the
//! program itself, to the same value of the objective.

mod direction;
mod parts;

use super::Bridge;
use crate::autodiff::Evaluator;
use crate::model::instance::{
    Columns, Function, Instance, Kernel, KernelTerms, Relation, Rows, SparseRows,
};
use crate::model::problem_type::ProblemType;
use crate::solve::answer::Answer;
use crate::solve::backend::{Backend, Reply, Task};
use crate::solve::certificate::{TOLERANCE, nonlinear::linearise, primal};
use crate::solve::{Claim, ModelStatus, Outcome, Settings, Strategy};
use direction::Directions;
use parts::{Expression, Parts, has_kink};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;
use std::ops::Range;

/// Times that variables make up for each other, at most.
const SWEEPS: usize = 20;

/// Depth to which one stands in another and the start is still exact.
const NESTED: usize = 4;

/// A program without kinks in place of one with some.
pub(super) struct Epigraph {
    /// The program without kinks.
    instance: Instance,
    /// By equation: the column that makes it hold.
    makes_up: BTreeMap<usize, usize>,
}

/// All nonlinear terms: row, coefficient, expression.
fn expressions(instance: &Instance) -> impl Iterator<Item = (usize, f64, Expression)> {
    instance.nonlinear.iter().flat_map(|t| {
        let (v, c) = (t.kernel.variables as usize, t.kernel.constants as usize);
        (0..t.row.len()).map(move |k| {
            let expression = Expression {
                kernel: t.kernel.clone(),
                columns: t.columns[k * v..(k + 1) * v].to_vec(),
                constants: t.constants[k * c..(k + 1) * c].to_vec(),
            };
            (t.row[k] as usize, t.coef[k], expression)
        })
    })
}

impl Epigraph {
    /// None where there is nothing to replace, or something that does not stand convexly.
    fn new(instance: &Instance) -> Option<Self> {
        instance.objective?;
        let columns = &instance.columns;
        let varies = |&j: &u32| columns.lower[j as usize] != columns.upper[j as usize];
        let has_kinks = |t: &KernelTerms| has_kink(&t.kernel) && t.columns.iter().any(varies);
        if !instance.nonlinear.iter().any(has_kinks) {
            return None;
        }
        let mut builder = Builder::new(instance);
        let mut directions = None;
        for (row, coefficient, term) in expressions(instance) {
            if !term.has_kink() || !term.columns.iter().any(varies) {
                builder.push_term(row, coefficient, term);
                continue;
            }
            let parts = term.parts(coefficient);
            if builder.rows.relation[row] == Relation::Equal {
                let (weight, kink) = parts.nonlinear.iter().find(|p| p.1.kink().is_some())?;
                let less = is_convex(kink.kink()?.0) == (*weight > 0.0);
                let directions = directions.get_or_insert_with(|| Directions::new(instance));
                // where it is relaxed to ≤, something is lacking
                if !directions.can_relax(row, less) {
                    return None;
                }
                builder.rows.relation[row] = if less {
                    Relation::Less
                } else {
                    Relation::Greater
                };
            }
            builder.place(row, parts)?;
        }
        let mut makes_up = directions.map(|d| d.makes_up).unwrap_or_default();
        makes_up.retain(|_, j| *j < instance.column_count());
        Some(Self {
            instance: builder.finish(instance),
            makes_up,
        })
    }

    /// For nonlinear programs in continuous columns.
    pub(super) fn bridge(
        _: &[&dyn Backend],
        task: &Task,
        settings: &Settings,
    ) -> Option<Box<dyn Bridge>> {
        let other = task.instance.is_linear() || task.has_pairs() || task.has_integers();
        if other || !settings.runs(Strategy::ConvexEpigraph) {
            return None;
        }
        Some(Box::new(Self::new(task.instance)?))
    }
}

impl Bridge for Epigraph {
    fn instance(&self) -> &Instance {
        &self.instance
    }

    fn using(&self) -> ProblemType {
        ProblemType::Nlp
    }

    /// The multipliers say with which weights the pieces that meet at a kink count: only there are they to be judged.
    fn has_own_multipliers(&self) -> bool {
        true
    }

    fn restore(&self, instance: &Instance, answer: &Answer) -> Option<Reply> {
        let (n, m) = (instance.column_count(), instance.row_count());
        let proved = match answer.status {
            ModelStatus::Optimal | ModelStatus::LocallyOptimal => true,
            ModelStatus::Infeasible => false,
            _ => return None,
        };
        let outcome = answer.outcome.clone();
        let objective = instance.objective?.column as usize;
        let value = outcome.level[objective];
        let mut level = outcome.level;
        level.truncate(n);
        let mut evaluator = Evaluator::new(instance);
        let mut activity = vec![0.0; m];
        evaluator.rows(&level, &mut activity).ok()?;
        for _ in 0..SWEEPS {
            let mut moved = false;
            for (&i, &j) in &self.makes_up {
                let a = instance.matrix.row(i).find(|e| e.0 == j)?.1;
                let gap = instance.rows.rhs[i] - activity[i];
                moved |= gap != 0.0;
                level[j] += gap / a;
            }
            evaluator.rows(&level, &mut activity).ok()?;
            if !moved {
                break;
            }
        }
        let mut row_marginal = outcome.row_marginal;
        row_marginal.truncate(m);
        let at = linearise(instance, &mut evaluator, &level, &row_marginal).ok()?;
        let own = primal(instance, &level, &activity, &at.row_size);
        let same = (level[objective] - value).abs() <= TOLERANCE * value.abs().max(1.0);
        if proved && !(same && own.is_feasible(TOLERANCE)) {
            return None;
        }
        let mut column_marginal = outcome.column_marginal;
        column_marginal.truncate(n);
        let message = match self.instance.is_linear() && proved {
            true => Some("convex: a local optimum is a global one".into()),
            false => outcome.message,
        };
        let outcome = Outcome {
            level,
            row_marginal,
            column_marginal,
            claim: if proved {
                Claim::LocallySolved
            } else {
                Claim::Infeasible
            },
            ray: Vec::new(),
            basis: None,
            message,
            ..outcome
        };
        Some(outcome.into())
    }
}

fn is_convex(f: Function) -> bool {
    f != Function::Min
}

/// The program in the making.
struct Builder {
    columns: Columns,
    rows: Rows,
    entries: Vec<(usize, u32, f64)>,
    nonlinear: Vec<KernelTerms>,
    known: FxHashMap<Kernel, usize>,
    /// What was put in place of kinks: column, its rows, whether it is above them.
    lifted: Vec<(usize, Range<usize>, bool)>,
}

impl Builder {
    fn new(instance: &Instance) -> Self {
        let linear = (0..instance.row_count())
            .flat_map(|i| instance.matrix.row(i).map(move |(j, a)| (i, j as u32, a)));
        Self {
            columns: instance.columns.clone(),
            rows: instance.rows.clone(),
            entries: linear.collect(),
            nonlinear: Vec::new(),
            known: FxHashMap::default(),
            lifted: Vec::new(),
        }
    }

    fn push_term(&mut self, row: usize, coefficient: f64, e: Expression) {
        let next = self.nonlinear.len();
        let place = *self.known.entry(e.kernel.clone()).or_insert(next);
        if place == next {
            self.nonlinear.push(KernelTerms {
                kernel: e.kernel,
                ..KernelTerms::default()
            });
        }
        let terms = &mut self.nonlinear[place];
        terms.row.push(row as u32);
        terms.coef.push(coefficient);
        terms.columns.extend(e.columns);
        terms.constants.extend(e.constants);
    }

    /// Puts parts into the left side of a row.
    fn place(&mut self, row: usize, parts: Parts) -> Option<()> {
        self.rows.rhs[row] -= parts.constant;
        let linear = parts.linear.into_iter().map(|(j, a)| (row, j, a));
        self.entries.extend(linear);
        for (weight, part) in parts.nonlinear {
            match part.kink() {
                Some((f, arguments)) => self.lift(row, weight, f, arguments)?,
                None if part.has_kink() => return None,
                None => self.push_term(row, weight, part),
            }
        }
        Some(())
    }

    fn lift(
        &mut self,
        row: usize,
        weight: f64,
        f: Function,
        arguments: Vec<Expression>,
    ) -> Option<()> {
        if weight == 0.0 {
            return Some(());
        }
        let needs = match is_convex(f) == (weight > 0.0) {
            true => Relation::Less,
            false => Relation::Greater,
        };
        if self.rows.relation[row] != needs && self.rows.relation[row] != Relation::Free {
            return None;
        }
        let v = self.columns.push(f64::NEG_INFINITY, f64::INFINITY);
        self.entries.push((row, v as u32, weight));
        let signs: &[f64] = if f == Function::Abs {
            &[1.0, -1.0]
        } else {
            &[1.0]
        };
        let sides: Vec<Parts> = arguments
            .iter()
            .flat_map(|a| signs.iter().map(|&s| a.parts(s)))
            .collect();
        let first = self.rows.rhs.len();
        let relation = if is_convex(f) {
            Relation::Less
        } else {
            Relation::Greater
        };
        for _ in &sides {
            self.rows.relation.push(relation);
            self.rows.rhs.push(0.0);
            self.rows.marginal.push(0.0);
            self.rows.scale.push(1.0);
        }
        self.lifted
            .push((v, first..first + sides.len(), is_convex(f)));
        for (i, side) in sides.into_iter().enumerate() {
            self.entries.push((first + i, v as u32, -1.0));
            self.place(first + i, side)?;
        }
        Some(())
    }

    fn finish(mut self, original: &Instance) -> Instance {
        self.entries.sort_by_key(|e| (e.0, e.1));
        let mut matrix = SparseRows {
            start: vec![0],
            ..SparseRows::default()
        };
        let mut entries = self
            .entries
            .chunk_by(|a, b| (a.0, a.1) == (b.0, b.1))
            .peekable();
        for i in 0..self.rows.rhs.len() {
            while let Some(same) = entries.next_if(|e| e[0].0 == i) {
                let sum: f64 = same.iter().map(|e| e.2).sum();
                if sum != 0.0 {
                    matrix.column.push(same[0].1);
                    matrix.value.push(sum);
                }
            }
            matrix.start.push(matrix.column.len());
        }
        let mut instance = Instance {
            columns: self.columns,
            rows: self.rows,
            matrix,
            nonlinear: self.nonlinear,
            objective: original.objective,
            matched: None,
            discrete: Default::default(),
        };
        // the start of an outer one depends on that of an inner one
        let mut evaluator = Evaluator::new(&instance);
        let mut activity = vec![0.0; instance.row_count()];
        for _ in 0..NESTED {
            let level = &mut instance.columns.level;
            if evaluator.rows(level, &mut activity).is_err() {
                break;
            }
            for (v, rows, above) in &self.lifted {
                let values = rows
                    .clone()
                    .map(|i| activity[i] - instance.rows.rhs[i] + level[*v]);
                level[*v] = match above {
                    true => values.fold(f64::NEG_INFINITY, f64::max),
                    false => values.fold(f64::INFINITY, f64::min),
                };
            }
        }
        instance
    }
}
