//! A solver of one's own beside those inside: compass search for programs whose only row defines the objective.
//!
//!     cargo run --example toy_backend
//!
//! To have it in bmod, this file would be a folder in `src/solve/`, and a line in `src/solve/registry.rs`.

use bmod::autodiff::Evaluator;
use bmod::model::instance::{
    Instance, Kernel, KernelTerms, Objective, Op, Relation, Rows, Sense, SparseRows,
};
use bmod::model::option::{Kind, OptionTable, row};
use bmod::model::outcome::{Claim, Outcome, SolverStatus};
use bmod::model::problem_type::ProblemType;
use bmod::solve::answer::answer_with;
use bmod::solve::backend::{Backend, Reply, Supports, Task, Terms};
use bmod::solve::budget::{Budget, Quiet, Stop};
use bmod::solve::registry::BACKENDS;
use bmod::solve::{Settings, SolveError};

const OPTIONS: OptionTable = OptionTable {
    backend: "compass",
    title: "nlp, dnlp without constraints: compass search",
    rows: &[row(
        "compass_step",
        Kind::Inside(0.0, f64::INFINITY),
        "1e-7",
        "step at which the search ends",
    )],
    more: None,
    ignored: &[],
};

/// From the start along each coordinate, with steps that are halved where none leads down.
struct Compass;

impl Backend for Compass {
    fn name(&self) -> &'static str {
        "compass"
    }

    fn version(&self) -> &'static str {
        "nlp, dnlp: an example"
    }

    fn supports(&self) -> Supports {
        Supports {
            linear: false,
            largest: 50,
            only_by_name: true,
            ..Supports::new(&[ProblemType::Nlp, ProblemType::Dnlp], Terms::Kinks)
        }
    }

    fn options(&self) -> &'static OptionTable {
        &OPTIONS
    }

    fn solve(
        &self,
        task: &Task,
        settings: &Settings,
        budget: &Budget,
    ) -> Result<Reply, SolveError> {
        let instance = task.instance;
        let Some(objective) = instance.objective.filter(|_| instance.row_count() == 1) else {
            return Err(SolveError::new(
                "compass takes programs without constraints",
            ));
        };
        let z = objective.column as usize;
        let mut search = Search {
            instance,
            evaluator: Evaluator::new(instance),
            z,
            coefficient: instance
                .matrix
                .row(0)
                .find(|e| e.0 == z)
                .map_or(1.0, |e| e.1),
        };
        let last = settings.number("compass_step").unwrap_or(1e-7);
        let mut x = instance.columns.level.clone();
        let (mut value, mut step, mut steps) = (search.value(&mut x), 1.0, 0);
        // Every loop asks the budget; what it has then is the answer.
        while step > last && !budget.is_over() {
            let mut moved = false;
            for j in (0..x.len()).filter(|&j| j != z) {
                for direction in [step, -step] {
                    let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
                    let mut y = x.clone();
                    y[j] = (y[j] + direction).max(l).min(u);
                    let there = search.value(&mut y);
                    if there < value {
                        (x, value, moved) = (y, there, true);
                    }
                }
            }
            steps += 1;
            budget.spend(1);
            step *= if moved { 1.0 } else { 0.5 };
        }
        let stopped = budget.stopped().map(Stop::status);
        let outcome = Outcome {
            level: x,
            row_marginal: vec![1.0 / search.coefficient],
            column_marginal: vec![0.0; instance.column_count()],
            claim: match stopped {
                Some(_) => Claim::Unfinished,
                None => Claim::LocallySolved,
            },
            status: stopped.unwrap_or(SolverStatus::NormalCompletion),
            iterations: steps,
            solver: "compass",
            ray: Vec::new(),
            message: None,
            basis: None,
        };
        Ok(outcome.into())
    }
}

struct Search<'a> {
    instance: &'a Instance,
    evaluator: Evaluator,
    /// The objective column, and its coefficient in the row.
    z: usize,
    coefficient: f64,
}

impl Search<'_> {
    /// The objective, minimised, which also becomes the level of its column; infinite where it has no value.
    fn value(&mut self, x: &mut [f64]) -> f64 {
        let mut activity = [0.0];
        x[self.z] = 0.0;
        if self.evaluator.rows(x, &mut activity).is_err() {
            return f64::INFINITY;
        }
        x[self.z] = (self.instance.rows.rhs[0] - activity[0]) / self.coefficient;
        self.instance.sign() * x[self.z]
    }
}

/// min z, z = (x − 1)² + 10 (y − x²)², from (−1, 1).
fn valley() -> Instance {
    use Op::{Add, Const, Multiply, PowerInt, Subtract, Var};
    let mut instance = Instance::default();
    for start in [0.0, -1.0, 1.0] {
        let j = instance.columns.push(f64::NEG_INFINITY, f64::INFINITY);
        instance.columns.level[j] = start;
    }
    instance.rows = Rows {
        relation: vec![Relation::Equal],
        rhs: vec![0.0],
        marginal: vec![0.0],
        scale: vec![1.0],
    };
    instance.matrix = SparseRows {
        start: vec![0, 1],
        column: vec![0],
        value: vec![1.0],
    };
    let first = [Var(0), Const(0), Subtract, PowerInt(2)];
    let second = [Var(1), Var(0), PowerInt(2), Subtract, PowerInt(2)];
    let ops = first
        .into_iter()
        .chain(second)
        .chain([Const(1), Multiply, Add]);
    instance.nonlinear.push(KernelTerms {
        kernel: Kernel {
            ops: ops.collect(),
            variables: 2,
            constants: 2,
        },
        row: vec![0],
        coef: vec![-1.0],
        columns: vec![1, 2],
        constants: vec![1.0, 10.0],
    });
    instance.objective = Some(Objective {
        column: 0,
        sense: Sense::Minimize,
    });
    instance
}

fn main() {
    let mut backends: Vec<&dyn Backend> = vec![&Compass];
    backends.extend(BACKENDS);
    let instance = valley();
    for choice in ["compass", "pounce"] {
        let task = Task::new(ProblemType::Nlp, &instance).by(Some(choice));
        let mut quiet = Quiet::default();
        let budget = Budget::unlimited(&mut quiet);
        match answer_with(&backends, &task, &Settings::default(), &budget) {
            Ok(a) => println!(
                "{:>8}: {}, objective {:.2e}, {} iterations",
                a.outcome.solver,
                a.status.name(),
                a.outcome.level[0],
                a.outcome.iterations
            ),
            Err(e) => println!("{choice:>8}: {}", e.message),
        }
    }
}
