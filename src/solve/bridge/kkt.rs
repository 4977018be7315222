//! A linear program as a complementarity problem: `option lp = mcp`.
//!
//! min cᵀx, Ax = | ≥ | ≤ b, l ≤ x ≤ u is optimal at x with multipliers y where
//! l ≤ x ≤ u ⟂ c − Aᵀy and y (free | ≥ 0 | ≤ 0) ⟂ Ax − b. The pivoting solver ends at a basic
//! solution with residuals near the rounding error, where interior points give six digits.

use super::Bridge;
use crate::model::instance::{Instance, Relation};
use crate::model::problem_type::ProblemType;
use crate::solve::answer::Answer;
use crate::solve::backend::{Backend, Reply, Task, is_called};
use crate::solve::{Claim, Outcome, Settings};

/// The optimality conditions of a linear program: its columns, then its multipliers; a row for each.
pub struct Kkt(Instance);

fn conditions(program: &Instance) -> Instance {
    let (m, n) = (program.row_count(), program.column_count());
    let mut out = Instance {
        columns: program.columns.clone(),
        ..Instance::default()
    };
    for relation in &program.rows.relation {
        let (lower, upper) = match relation {
            Relation::Equal => (f64::NEG_INFINITY, f64::INFINITY),
            Relation::Greater => (0.0, f64::INFINITY),
            Relation::Less => (f64::NEG_INFINITY, 0.0),
            Relation::Free => (0.0, 0.0),
        };
        out.columns.push(lower, upper);
    }
    let mut by_column: Vec<Vec<(usize, f64)>> = vec![Vec::new(); n];
    for i in 0..m {
        for (j, a) in program.matrix.row(i) {
            by_column[j].push((n + i, -a));
        }
    }
    for (j, column) in by_column.into_iter().enumerate() {
        let cost = program.objective.filter(|o| o.column as usize == j);
        out.add_row(
            column,
            Relation::Equal,
            cost.map_or(0.0, |o| -o.sense.sign()),
        );
    }
    for i in 0..m {
        out.add_row(program.matrix.row(i), Relation::Equal, program.rows.rhs[i]);
    }
    out.matched = Some((0..(n + m) as u32).map(Some).collect());
    out
}

impl Bridge for Kkt {
    /// Where the user named a backend that takes the conditions and not the program.
    fn build(backends: &[&dyn Backend], task: &Task, _: &Settings) -> Option<Self> {
        let name = task.choice?;
        let program = task.instance;
        program.objective.filter(|_| program.is_linear())?;
        if !task.is_continuous() {
            return None;
        }
        let named = || backends.iter().filter(|b| is_called(**b, name));
        if named().any(|b| b.takes(task)) {
            return None;
        }
        named().find(|b| {
            let supports = b.about().supports;
            supports.pairs && supports.types.contains(&ProblemType::Mcp)
        })?;
        Some(Self(conditions(program)))
    }

    fn instance(&self) -> &Instance {
        &self.0
    }

    fn using(&self) -> ProblemType {
        ProblemType::Mcp
    }

    fn restore(&self, program: &Instance, answer: &Answer) -> Option<Reply> {
        let n = program.column_count();
        let outcome = &answer.outcome;
        let signed = |v: &[f64]| v.iter().map(|v| program.sign() * v).collect();
        let solved = outcome.claim == Claim::Solved;
        let unsolved =
            "the optimality conditions were not solved: the model may be infeasible or unbounded";
        let outcome = Outcome {
            level: outcome.level[..n].to_vec(),
            row_marginal: signed(&outcome.level[n..]),
            column_marginal: signed(&outcome.column_marginal[..n]),
            claim: match solved {
                true => Claim::Solved,
                false => Claim::Unfinished,
            },
            message: (!solved).then(|| unsolved.into()),
            ..outcome.clone()
        };
        Some(outcome.into())
    }
}
