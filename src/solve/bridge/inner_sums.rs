//! Long sums inside a function: a column and a row in their place.
//!
//! ```text
//!     f(Σᵢ gᵢ(x))      ⟺      f(s),   Σᵢ gᵢ(x) − s = 0
//! ```
//!
//! The second derivatives of f(Σᵢ gᵢ(x)) fill a square as large as the sum is long, f″ ∇g ∇gᵀ; those of f(s) and of the gᵢ are
//! few (Griewank & Toint 1982: partial separability). Levels and marginals of the program itself come first, and are its own:
//! the multiplier of the new row is what f′ is in the chain rule.

use super::Bridge;
use super::builder::Builder;
use super::parts::{Parts, expressions};
use crate::autodiff::second_derivatives;
use crate::model::instance::{Instance, KernelTerms, Relation};
use crate::solve::answer::Answer;
use crate::solve::backend::{Backend, Reply, Task};
use crate::solve::{Claim, Settings, Strategy};
use rustc_hash::FxHashSet;

/// Variables of a linear sum from which on it is replaced: a factor of its square would take 4·10⁷ operations. The new row
/// stays satisfied, so that nothing else changes.
const LEAST: usize = 500;

/// The same of other sums: behind a curved row a method may make shorter steps, so there must be more to gain.
const LEAST_CURVED: usize = 1000;

/// How many times fewer second derivatives there must be.
const GAIN: usize = 4;

/// Second derivatives from which on sums so many times shorter are replaced; one in a program, which is compiled, takes
/// the memory of so many that the program is run for.
const MANY: f64 = 2e8;
const SHORTER: usize = 10;
const COMPILED: f64 = 200.0;

/// A program without long sums inside functions in place of one with some.
pub struct InnerSums {
    instance: Instance,
}

impl InnerSums {
    /// None where there is nothing to replace.
    fn new(instance: &Instance) -> Option<Self> {
        let shorter = match has_many(instance) {
            true => SHORTER,
            false => 1,
        };
        let is_long = |t: &KernelTerms| t.kernel.variables as usize * shorter >= LEAST;
        if !instance.nonlinear.iter().any(is_long) {
            return None;
        }
        let mut builder = Builder::new(instance);
        for (row, coefficient, term) in expressions(instance) {
            match term.columns.len() * shorter >= LEAST {
                true => place(&mut builder, row, term.parts(coefficient), shorter),
                false => builder.push_term(row, coefficient, term),
            }
        }
        let replaced = !builder.lifted.is_empty();
        replaced.then(|| Self {
            instance: builder.finish(instance),
        })
    }
}

/// Whether the second derivatives fill the memory, or their programs do.
fn has_many(instance: &Instance) -> bool {
    let most = |t: &KernelTerms| {
        let square = 0.5 * f64::from(t.kernel.variables).powi(2);
        square * (t.row.len() as f64 + COMPILED)
    };
    if instance.nonlinear.iter().map(most).sum::<f64>() <= MANY {
        return false;
    }
    let (all, compiled) = second_derivatives(instance);
    all + COMPILED * compiled > MANY
}

/// Puts parts into the left side of a row, and the long sums inside them into rows of their own.
fn place(builder: &mut Builder, row: usize, parts: Parts, shorter: usize) {
    for (weight, part) in builder.place_linear(row, parts) {
        let part = part.without_sums(LEAST / shorter, &mut |sum| {
            if !pays(&sum, shorter) {
                return None;
            }
            let column = builder.columns.push(f64::NEG_INFINITY, f64::INFINITY) as u32;
            let row = builder.push_row(Relation::Equal);
            builder.entries.push((row, column, -1.0));
            builder.lifted.push((column as usize, row..row + 1, true));
            place(builder, row, sum, shorter);
            Some(column)
        });
        builder.push_term(row, weight, part);
    }
}

/// Whether the terms of a sum have few second derivatives beside the square of its variables.
fn pays(sum: &Parts, shorter: usize) -> bool {
    let mut all: FxHashSet<u32> = sum.linear.iter().map(|l| l.0).collect();
    let mut after = 0;
    for (_, part) in &sum.nonlinear {
        let inside: FxHashSet<u32> = part.columns.iter().copied().collect();
        after += inside.len() * inside.len();
        all.extend(inside);
    }
    let all = all.len();
    let least = match sum.nonlinear[..] {
        [] => LEAST,
        _ => LEAST_CURVED,
    };
    all * shorter >= least && GAIN * after <= all * all
}

impl Bridge for InnerSums {
    /// For nonlinear programs in continuous columns.
    fn build(_: &[&dyn Backend], task: &Task, settings: &Settings) -> Option<Self> {
        let instance = task.instance;
        let other = instance.objective.is_none() || !task.is_continuous();
        if other || !settings.runs(Strategy::InnerSums) {
            return None;
        }
        Self::new(instance)
    }

    fn instance(&self) -> &Instance {
        &self.instance
    }

    fn restore(&self, instance: &Instance, answer: &Answer) -> Option<Reply> {
        let (n, m) = (instance.column_count(), instance.row_count());
        let mut outcome = answer.outcome.clone().of_first(n, m);
        match outcome.claim {
            Claim::LocallyInfeasible => outcome.ray.truncate(m),
            _ => outcome.ray.clear(),
        }
        Some(outcome.into())
    }
}
