//! max, min and abs where they stand convexly: columns and rows in their place.
//!
//! ```text
//!     … + w max(a, b, …) ≤ …,  w > 0      ⟺      … + w v ≤ …,   a ≤ v,  b ≤ v,  …
//! ```
//!
//! and likewise min with w < 0, |a| = max(a, −a), the other direction, an argument that contains one of them again, and an
//! equation that may be relaxed ([`Directions`]). What is left is smooth, often linear; its multipliers say with
//! which weights the pieces that meet at a kink count, so that the conditions of first order can be checked there. A program in
//! which one max, min or abs stands otherwise is left as it is.
//!
//! The columns and rows that are added come last: levels and marginals of the program itself come first. Where an equation
//! was relaxed and does not bind, the variable that makes up for it is moved; the point is given back only if it satisfies the
//! program itself, to the same value of the objective.

use super::Bridge;
use super::builder::Builder;
use super::direction::{Directions, make_up};
use super::parts::{Parts, expressions, has_kink};
use crate::autodiff::Evaluator;
use crate::model::builder::Term;
use crate::model::instance::{Function, Instance, KernelTerms, Relation};
use crate::solve::answer::Answer;
use crate::solve::backend::{Backend, Reply, Task};
use crate::solve::certificate::{TOLERANCE, nonlinear::linearise, primal};
use crate::solve::{Claim, ModelStatus, Settings, Strategy};
use std::collections::BTreeMap;

/// A program without kinks in place of one with some.
pub struct Epigraph {
    /// The program without kinks.
    instance: Instance,
    /// By equation: the column that makes it hold.
    makes_up: BTreeMap<usize, usize>,
}

impl Epigraph {
    /// None where there is nothing to replace, or something that does not stand convexly.
    fn new(instance: &Instance) -> Option<Self> {
        instance.objective?;
        let columns = &instance.columns;
        let varies = |&j: &u32| columns.lower[j as usize] != columns.upper[j as usize];
        let has_kinks = |t: &KernelTerms| has_kink(&t.kernel.ops) && t.columns.iter().any(varies);
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
}

impl Bridge for Epigraph {
    /// For nonlinear programs in continuous columns.
    fn build(_: &[&dyn Backend], task: &Task, settings: &Settings) -> Option<Self> {
        let other = task.instance.is_linear() || !task.is_continuous();
        if other || !settings.runs(Strategy::ConvexEpigraph) {
            return None;
        }
        Self::new(task.instance)
    }

    fn instance(&self) -> &Instance {
        &self.instance
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
        let mut outcome = answer.outcome.clone().of_first(n, m);
        let objective = instance.objective?.column as usize;
        let level = &mut outcome.level;
        let value = level[objective];
        let mut evaluator = Evaluator::first_order(instance);
        make_up(instance, &self.makes_up, level)?;
        let mut activity = vec![0.0; m];
        evaluator.rows(level, &mut activity).ok()?;
        let at = linearise(instance, &mut evaluator, level, &outcome.row_marginal).ok()?;
        let own = primal(instance, level, &activity, &at.row_size);
        let same = (level[objective] - value).abs() <= TOLERANCE * value.abs().max(1.0);
        if proved && !(same && own.is_feasible(TOLERANCE)) {
            return None;
        }
        outcome.ray.clear();
        outcome.claim = match answer.status {
            // by its cones
            ModelStatus::Optimal if !self.instance.is_linear() => Claim::Solved,
            _ if proved => Claim::LocallySolved,
            _ => Claim::Infeasible,
        };
        if self.instance.is_linear() && proved {
            outcome.message = Some("convex: a local optimum is a global one".into());
        }
        Some(outcome.into())
    }
}

fn is_convex(f: Function) -> bool {
    f != Function::Min
}

impl Builder {
    /// Puts parts into the left side of a row.
    fn place(&mut self, row: usize, parts: Parts) -> Option<()> {
        for (weight, part) in self.place_linear(row, parts) {
            match part.kink() {
                Some((f, arguments)) => self.lift(row, weight, f, arguments)?,
                None if part.has_kink() => return None,
                None => self.push_term(row, weight, part),
            }
        }
        Some(())
    }

    fn lift(&mut self, row: usize, weight: f64, f: Function, arguments: Vec<Term>) -> Option<()> {
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
            self.push_row(relation);
        }
        self.lifted
            .push((v, first..first + sides.len(), is_convex(f)));
        for (i, side) in sides.into_iter().enumerate() {
            self.entries.push((first + i, v as u32, -1.0));
            self.place(first + i, side)?;
        }
        Some(())
    }
}
