//! A linear program as a complementarity problem: `option lp = mcp`.
//!
//! min cᵀx, Ax = | ≥ | ≤ b, l ≤ x ≤ u is optimal at x with multipliers y where
//! l ≤ x ≤ u ⟂ c − Aᵀy and y (free | ≥ 0 | ≤ 0) ⟂ Ax − b. The pivoting solver ends at a basic
//! solution with residuals near the rounding error, where interior points give six digits.

use super::answer::{Answer, linear_shown};
use super::backend::{Backend, Supports, Task};
use super::complementarity::run;
use super::{Budget, Claim, Outcome, Settings, SolveError, Solver, lp, mcp};
use crate::model::instance::{Instance, Relation};
use crate::model::option::OptionTable;

/// The optimality conditions of a linear program.
struct Conditions<'a> {
    instance: &'a Instance,
    cost: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    start: Vec<f64>,
    column_start: Vec<usize>,
    row_index: Vec<usize>,
    values: Vec<f64>,
}

impl<'a> Conditions<'a> {
    fn new(instance: &'a Instance) -> Self {
        let (m, n) = (instance.row_count(), instance.column_count());
        let mut cost = vec![0.0; n];
        if let Some(o) = instance.objective {
            cost[o.column as usize] = o.sense.sign();
        }
        let multiplier = |r: &Relation| match r {
            Relation::Equal => (f64::NEG_INFINITY, f64::INFINITY),
            Relation::Greater => (0.0, f64::INFINITY),
            Relation::Less => (f64::NEG_INFINITY, 0.0),
            Relation::Free => (0.0, 0.0),
        };
        let columns = &instance.columns;
        let rows = &instance.rows;
        let mut lower = columns.lower.clone();
        let mut upper = columns.upper.clone();
        lower.extend(rows.relation.iter().map(|r| multiplier(r).0));
        upper.extend(rows.relation.iter().map(|r| multiplier(r).1));
        let mut start = columns.level.clone();
        start.resize(n + m, 0.0);
        // Column j of x holds A's column in the rows of y; column i of y holds −A's row.
        let mut by_column: Vec<Vec<(usize, f64)>> = vec![Vec::new(); n];
        for i in 0..m {
            for (j, a) in instance.matrix.row(i) {
                by_column[j].push((n + i, a));
            }
        }
        let (mut column_start, mut row_index, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in by_column {
            for (i, a) in column {
                row_index.push(i);
                values.push(a);
            }
            column_start.push(row_index.len());
        }
        for i in 0..m {
            for (j, a) in instance.matrix.row(i) {
                row_index.push(j);
                values.push(-a);
            }
            column_start.push(row_index.len());
        }
        Self {
            instance,
            cost,
            lower,
            upper,
            start,
            column_start,
            row_index,
            values,
        }
    }
}

impl mcp::Problem for Conditions<'_> {
    fn n(&self) -> usize {
        self.lower.len()
    }

    fn lower(&self) -> &[f64] {
        &self.lower
    }

    fn upper(&self) -> &[f64] {
        &self.upper
    }

    fn start(&self) -> &[f64] {
        &self.start
    }

    fn pattern(&self) -> (&[usize], &[usize]) {
        (&self.column_start, &self.row_index)
    }

    fn function(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), mcp::EvalError> {
        let n = self.cost.len();
        f[..n].copy_from_slice(&self.cost);
        for (i, b) in self.instance.rows.rhs.iter().enumerate() {
            f[n + i] = -b;
        }
        for (k, &x) in x.iter().enumerate() {
            for e in self.column_start[k]..self.column_start[k + 1] {
                f[self.row_index[e]] += self.values[e] * x;
            }
        }
        Ok(())
    }

    fn jacobian(&mut self, _x: &[f64], values: &mut [f64]) -> Result<(), mcp::EvalError> {
        values.copy_from_slice(&self.values);
        Ok(())
    }

    fn is_linear(&self) -> bool {
        true
    }
}

/// Linear programs through the complementarity solver.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kkt;

impl Solver for Kkt {
    fn name(&self) -> &'static str {
        "bmcp"
    }

    fn solve(
        &self,
        instance: &Instance,
        settings: &Settings,
        budget: &Budget,
    ) -> Result<Outcome, SolveError> {
        let n = instance.column_count();
        let mut problem = Conditions::new(instance);
        let names = |k: usize| match k.checked_sub(n) {
            None => budget.column_name(k),
            Some(row) => budget.row_name(row),
        };
        let (out, status) = run(&mut problem, &names, settings, budget, &|_| false)?;
        let sign = instance.sign();
        let solved = out.status == mcp::Status::Solved;
        Ok(Outcome {
            level: out.x[..n].to_vec(),
            row_marginal: out.x[n..].iter().map(|y| sign * y).collect(),
            column_marginal: out.f[..n].iter().map(|r| sign * r).collect(),
            claim: if solved { Claim::Solved } else { Claim::Unfinished },
            status,
            iterations: (out.majors + out.pivots) as u64,
            solver: "bmcp",
            ray: Vec::new(),
            message: (!solved)
                .then(|| "the optimality conditions were not solved: the model may be infeasible or unbounded".into()),
            basis: None,
        })
    }
}

impl Backend for Kkt {
    fn name(&self) -> &'static str {
        "bmcp"
    }

    fn aliases(&self) -> &'static [&'static str] {
        &["mcp"]
    }

    fn version(&self) -> &'static str {
        "lp: the optimality conditions as an mcp"
    }

    fn supports(&self) -> Supports {
        Supports {
            only_by_name: true,
            ..lp::SUPPORTS
        }
    }

    fn options(&self) -> &'static OptionTable {
        &mcp::OPTIONS
    }

    fn solve(
        &self,
        task: &Task,
        settings: &Settings,
        budget: &Budget,
    ) -> Result<Answer, SolveError> {
        linear_shown(self, task.instance, settings, budget)
    }
}
