//! A sum of as many squares as there are variables: equations in its place.
//!
//! ```text
//!     min Σᵢ wᵢ rᵢ(x)²  subject to  g(x) = 0      ⟹      rᵢ(x) = 0,   g(x) = 0
//! ```
//!
//! As many squares and equations as variables all vanish as a rule. Newton's method on the equations knows nothing of the second
//! derivatives, which fill a square where squares are long, and converges where that on the sum creeps. Where they do not
//! vanish, nothing was learnt: the sum is minimised.

use super::Bridge;
use super::builder::Builder;
use super::parts::{Parts, expressions};
use crate::autodiff::Evaluator;
use crate::model::builder::Term;
use crate::model::instance::{Instance, Op, Relation};
use crate::model::outcome::ModelStatus;
use crate::solve::answer::Answer;
use crate::solve::backend::{Backend, Reply, Task};
use crate::solve::factor_size::symmetric_size;
use crate::solve::{Claim, Settings, Strategy};

/// Newton's method alone, whose steps are counted at its end: other methods know more of the sum.
const MOST_ITERATIONS: u64 = 1;

/// Operations of a factorisation of the equations from which on nothing is gained.
const MOST_OPERATIONS: f64 = 5e10;

/// The slope of the sum, relative to the size of the variable, at a point where squares vanish.
const FLAT: f64 = 1e-7;

/// The equations.
pub struct LeastSquares {
    instance: Instance,
    /// The row that defines the objective, and its coefficient there.
    row: usize,
    coefficient: f64,
}

impl LeastSquares {
    /// None unless the objective is a sum of squares, and these and the equations are as many as the variables.
    fn new(instance: &Instance) -> Option<Self> {
        let z = instance.objective?.column as usize;
        let (row, coefficient) = instance.objective_row()?;
        let defined = instance.rows.relation[row] == Relation::Equal && instance.is_free(z);
        if !defined || instance.matrix.row(row).count() > 1 {
            return None;
        }
        let equal = |r: &&Relation| **r == Relation::Equal;
        let equations = instance.rows.relation.iter().filter(equal).count() - 1;
        let columns = instance.columns.lower.iter().zip(&instance.columns.upper);
        let free = columns.filter(|(l, u)| l != u).count() - 1;
        let weight = -instance.sign() / coefficient;
        let mut squares = Vec::new();
        for (_, coefficient, whole) in expressions(instance).filter(|e| e.0 == row) {
            squares.extend(roots(whole.parts(weight * coefficient))?);
            if squares.len() + equations > free {
                return None;
            }
        }
        if squares.is_empty() || squares.len() + equations != free {
            return None;
        }
        let mut builder = Builder::new(instance);
        builder.rows.relation[row] = Relation::Free;
        for (i, coefficient, term) in expressions(instance).filter(|e| e.0 != row) {
            builder.push_term(i, coefficient, term);
        }
        for square in squares {
            let i = builder.push_row(Relation::Equal);
            for (weight, part) in builder.place_linear(i, square.parts(1.0)) {
                builder.push_term(i, weight, part);
            }
        }
        let mut system = builder.finish(instance);
        if system.is_linear() {
            // a convex quadratic program
            return None;
        }
        system.objective = None;
        (system.columns.lower[z], system.columns.upper[z]) = (0.0, 0.0);
        system.columns.level[z] = 0.0;
        system.rows.marginal.fill(0.0);
        if operations(&system) > MOST_OPERATIONS {
            return None;
        }
        Some(Self {
            instance: system,
            row,
            coefficient,
        })
    }
}

/// What factors of a step on the equations cost, [I Jᵀ; J −I].
fn operations(system: &Instance) -> f64 {
    let evaluator = Evaluator::first_order(system);
    let (start, column) = evaluator.jacobian_pattern();
    let (m, n) = (system.row_count(), system.column_count());
    let row = |i: usize| {
        column[start[i]..start[i + 1]]
            .iter()
            .map(move |&j| (n + i, j as usize))
    };
    let fixed = |j: usize| system.columns.lower[j] == system.columns.upper[j];
    let counted = (0..m).filter(|&i| system.rows.relation[i] != Relation::Free);
    let entries = counted.flat_map(row).filter(|e| !fixed(e.1));
    symmetric_size("the factor of the equations", n + m, entries).operations
}

/// What is squared in a sum of squares; none where anything else stands in it.
fn roots(parts: Parts) -> Option<Vec<Term>> {
    let root = |(weight, mut term): (f64, Term)| match term.ops.pop() {
        Some(Op::PowerInt(p)) if weight > 0.0 && p > 0 && p % 2 == 0 => Some(term),
        _ => None,
    };
    match parts.linear.is_empty() {
        true => parts.nonlinear.into_iter().map(root).collect(),
        false => None,
    }
}

impl Bridge for LeastSquares {
    /// For nonlinear programs in continuous columns of which no solver is asked for.
    fn build(_: &[&dyn Backend], task: &Task, settings: &Settings) -> Option<Self> {
        let instance = task.instance;
        let other = instance.objective.is_none() || !task.is_continuous();
        if other || task.choice.is_some() || task.seen.is_some() {
            return None;
        }
        let made = Self::new(instance)?;
        settings.runs(Strategy::VanishingSquares).then_some(made)
    }

    fn instance(&self) -> &Instance {
        &self.instance
    }

    fn iterations(&self) -> u64 {
        MOST_ITERATIONS
    }

    fn restore(&self, instance: &Instance, answer: &Answer) -> Option<Reply> {
        let solved = [ModelStatus::Optimal, ModelStatus::LocallyOptimal];
        if !solved.contains(&answer.status) {
            return None;
        }
        let z = instance.objective?.column as usize;
        let mut outcome = answer.outcome.clone();
        let level = &mut outcome.level;
        let (activity, slopes) = Evaluator::first_order(instance).linearised(level).ok()?;
        let steep = slopes[self.row].iter().any(|&(j, slope)| {
            let fixed = instance.columns.lower[j] == instance.columns.upper[j];
            let slope = slope / self.coefficient * level[j].abs().max(1.0);
            j != z && !fixed && slope.abs() > FLAT
        });
        if steep {
            return None;
        }
        level[z] = (instance.rows.rhs[self.row] - activity[self.row]) / self.coefficient;
        outcome.row_marginal = vec![0.0; instance.row_count()];
        outcome.row_marginal[self.row] = 1.0 / self.coefficient;
        outcome.column_marginal = vec![0.0; instance.column_count()];
        outcome.claim = Claim::LocallySolved;
        outcome.basis = None;
        outcome.ray.clear();
        Some(outcome.into())
    }
}
