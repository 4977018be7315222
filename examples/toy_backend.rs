//! A solver of one's own beside those inside: compass search for programs whose only row defines the objective.
//!
//!     cargo run --example toy_backend
//!
//! To have it in bmod, this file would be a folder in `src/solve/`, and a line in `src/solve/registry.rs`.

use bmod::SolverStatus;
use bmod::solver::{
    About, BACKENDS, Backend, Budget, Claim, Evaluator, Instance, Kind, OptionTable, Outcome,
    ProblemType, Quiet, Relation, Replied, Sense, Settings, SolveError, Stop, Supports, Task, Term,
    Terms, answer_with, row,
};

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
    fn about(&self) -> About {
        About {
            name: "compass",
            aliases: &[],
            version: "nlp, dnlp: an example",
            supports: Supports {
                linear: false,
                largest: 50,
                only_by_name: true,
                ..Supports::new(&[ProblemType::Nlp, ProblemType::Dnlp], Terms::Kinks)
            },
            options: &OPTIONS,
            option_files: &["compass"],
        }
    }

    fn solve(&self, task: &Task, settings: &Settings, budget: &Budget) -> Replied {
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
            row_marginal: vec![1.0 / search.coefficient],
            claim: match stopped {
                Some(_) => Claim::Unfinished,
                None => Claim::LocallySolved,
            },
            status: stopped.unwrap_or(SolverStatus::NormalCompletion),
            iterations: steps,
            ..Outcome::unfinished("compass", x, 1)
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
    let mut instance = Instance::default();
    let free = (f64::NEG_INFINITY, f64::INFINITY);
    let [z, x, y] = [0.0, -1.0, 1.0].map(|start| instance.add_column(free.0, free.1, start));
    let row = instance.add_row([(z, 1.0)], Relation::Equal, 0.0);
    let (x, y) = (Term::column(x), Term::column(y));
    let value = (x.clone() - 1.0).powi(2) + 10.0 * (y - x.powi(2)).powi(2);
    instance.add_term(row, -1.0, value);
    instance.set_objective(z, Sense::Minimize);
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
