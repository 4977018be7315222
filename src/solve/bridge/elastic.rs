//! The least violation of linear rows that contradict each other.
//!
//! ```text
//!     min  Σ p + Σ q    subject to    L ≤ A x + p − q ≤ U,   l ≤ x ≤ u,   p, q ≥ 0
//! ```
//!
//! Its solution is what a simplex method ends at that finds no feasible point, and what GAMS reports of an infeasible
//! program: levels within their bounds, and marginals that are derivatives of the sum of violations, whatever the sense of
//! the objective.

use super::Bridge;
use crate::model::instance::{Instance, Objective, Relation, Sense};
use crate::model::problem_type::ProblemType;
use crate::solve::answer::Answer;
use crate::solve::backend::Reply;

/// A linear program with elastic rows; the columns that were added come last.
pub(in crate::solve) struct Elastic(Instance);

impl Elastic {
    /// Every row but that which defines the objective is elastic.
    pub(in crate::solve) fn new(instance: &Instance) -> Self {
        let mut out = Instance {
            columns: instance.columns.clone(),
            ..Instance::default()
        };
        let free = instance
            .objective
            .is_some_and(|o| instance.is_free(o.column as usize));
        let defining = instance
            .objective_row()
            .map(|(row, _)| row)
            .filter(|_| free);
        let mut slacks = Vec::new();
        for i in 0..instance.row_count() {
            let mut row: Vec<(usize, f64)> = instance.matrix.row(i).collect();
            let relation = instance.rows.relation[i];
            let signs: &[f64] = match relation {
                _ if defining == Some(i) => &[],
                Relation::Equal => &[1.0, -1.0],
                Relation::Greater => &[1.0],
                Relation::Less => &[-1.0],
                Relation::Free => &[],
            };
            for &sign in signs {
                let slack = out.columns.push(0.0, f64::INFINITY);
                slacks.push((slack, -1.0));
                row.push((slack, sign));
            }
            out.add_row(row, relation, instance.rows.rhs[i]);
        }
        let sum = out.columns.push(f64::NEG_INFINITY, f64::INFINITY);
        slacks.push((sum, 1.0));
        out.add_row(slacks, Relation::Equal, 0.0);
        out.objective = Some(Objective {
            column: sum as u32,
            sense: Sense::Minimize,
        });
        Self(out)
    }
}

impl Bridge for Elastic {
    fn instance(&self) -> &Instance {
        &self.0
    }

    fn using(&self) -> ProblemType {
        ProblemType::Lp
    }

    fn restore(&self, instance: &Instance, answer: &Answer) -> Option<Reply> {
        let (n, m) = (instance.column_count(), instance.row_count());
        let outcome = || answer.outcome.clone().of_first(n, m);
        answer.status.is_solution().then(|| outcome().into())
    }
}
