//! Accuracy and time of the linear solver on MPS files.
//!
//! `cargo bench --bench lp -- FILE.mps…` prints, per file, the size, the objective with all its
//! digits, the largest residuals, iterations and seconds. Without files it solves nothing.

use std::collections::HashMap;
use std::time::Instant;

use bmod::model::instance::{Columns, Instance, Objective, Relation, Rows, Sense, SparseRows};
use bmod::model::problem_type::ProblemType;
use bmod::solve::answer::{Answer, answer_with};
use bmod::solve::backend::Task;
use bmod::solve::lp::Clarabel;
use bmod::solve::{Budget, Limits, Monitor, Settings};

struct Log(Instant);

impl Monitor for Log {
    fn log(&mut self, line: &str) {
        println!("{line}");
    }
    fn interrupted(&mut self) -> bool {
        false
    }
    fn seconds(&mut self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

/// Reads free-format MPS (no ranges): enough for a benchmark.
fn read_mps(text: &str) -> Instance {
    let mut section = "";
    let (mut rows, mut relation) = (HashMap::new(), Vec::new());
    let mut columns: HashMap<String, usize> = HashMap::new();
    let mut entries: Vec<Vec<(u32, f64)>> = Vec::new();
    let (mut lower, mut upper, mut rhs) = (Vec::new(), Vec::new(), Vec::new());
    for line in text.lines().filter(|l| !l.starts_with('*')) {
        let words: Vec<&str> = line.split_whitespace().collect();
        if !line.starts_with(' ') {
            section = words.first().copied().unwrap_or("");
            continue;
        }
        match section {
            "ROWS" => {
                rows.insert(words[1].to_string(), relation.len());
                relation.push(match words[0] {
                    "N" | "E" => Relation::Equal,
                    "G" => Relation::Greater,
                    _ => Relation::Less,
                });
                entries.push(Vec::new());
                rhs.push(0.0);
            }
            "COLUMNS" => {
                let next = columns.len();
                let j = *columns.entry(words[0].to_string()).or_insert(next);
                if j == next {
                    lower.push(0.0);
                    upper.push(f64::INFINITY);
                }
                for pair in words[1..].chunks(2) {
                    entries[rows[pair[0]]].push((j as u32, pair[1].parse().expect("number")));
                }
            }
            "RHS" => {
                for pair in words[1..].chunks(2) {
                    rhs[rows[pair[0]]] = pair[1].parse().expect("number");
                }
            }
            "BOUNDS" => {
                let j = columns[words[2]];
                let value = words.get(3).map_or(0.0, |v| v.parse().expect("number"));
                match words[0] {
                    "FR" => lower[j] = f64::NEG_INFINITY,
                    "LO" => lower[j] = value,
                    "UP" => upper[j] = value,
                    "FX" => (lower[j], upper[j]) = (value, value),
                    "MI" => lower[j] = f64::NEG_INFINITY,
                    _ => {}
                }
            }
            _ => {}
        }
    }
    // The first N row becomes  c'x - z =e= 0.
    let z = columns.len() as u32;
    entries[0].push((z, -1.0));
    lower.push(f64::NEG_INFINITY);
    upper.push(f64::INFINITY);
    let mut matrix = SparseRows {
        start: vec![0],
        ..SparseRows::default()
    };
    for row in &mut entries {
        row.sort_unstable_by_key(|e| e.0);
        matrix.column.extend(row.iter().map(|e| e.0));
        matrix.value.extend(row.iter().map(|e| e.1));
        matrix.start.push(matrix.column.len());
    }
    let (m, n) = (rhs.len(), lower.len());
    Instance {
        columns: Columns {
            lower,
            upper,
            level: vec![0.0; n],
            marginal: vec![0.0; n],
            scale: vec![1.0; n],
            kind: vec![Default::default(); n],
        },
        rows: Rows {
            relation,
            rhs,
            marginal: vec![0.0; m],
            scale: vec![1.0; m],
        },
        matrix,
        nonlinear: Vec::new(),
        objective: Some(Objective {
            column: z,
            sense: Sense::Minimize,
        }),
        matched: None,
        discrete: Default::default(),
    }
}

/// Model status and largest residuals.
fn status(a: &Answer) -> String {
    let (r, status) = (&a.residuals, a.status);
    let size = |v: Option<f64>| v.unwrap_or(f64::NAN);
    format!(
        "{}, primal {:.0e}, dual {:.0e}, gap {:.0e}",
        status.name(),
        size(r.primal),
        size(r.dual),
        size(r.gap)
    )
}

fn main() {
    let (options, files): (Vec<String>, Vec<String>) = std::env::args()
        .skip(1)
        .partition(|a| a.contains('=') || a.starts_with('-'));
    let mut settings = Settings::default();
    for option in options.iter().filter_map(|o| o.split_once('=')) {
        settings.options.push((option.0.into(), option.1.into()));
    }
    let log = options.iter().any(|o| o == "--log");
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a readable file");
        let instance = read_mps(&text);
        let start = Instant::now();
        let mut monitor = Log(start);
        let budget = Budget::new(&mut monitor, Limits::default(), log);
        let task = Task::new(ProblemType::Lp, &instance);
        let answer = answer_with(&[&Clarabel], &task, &settings, &budget);
        let seconds = start.elapsed().as_secs_f64();
        match answer {
            Ok(a) => println!(
                "{file}: {} x {}, {:?}, {} {} iterations, {seconds:.3} s, objective {:.13} {}",
                instance.row_count(),
                instance.column_count(),
                a.outcome.claim,
                a.outcome.solver,
                a.outcome.iterations,
                a.outcome.level[instance.column_count() - 1],
                status(&a),
            ),
            Err(e) => println!("{file}: {}", e.message),
        }
    }
}
