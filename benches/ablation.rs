//! What each strategy of the solvers is worth: the corpora and `models/` are solved without each in turn, and what is lost is printed as a
//! Markdown table (`docs/strategies.md` lists the strategies).
//!
//! ```text
//! cargo bench --bench ablation -- [--type lp,mcp,nlp,mpec,models] [--strategy NAME,…] [--only TEXT] [--limit SECONDS]
//! ```
//!
//! `--type` chooses the instances, `--strategy` the rows (default: all), `--only` instances with TEXT in their name, `--limit` the time limit
//! of an instance (default 20 s). A strategy is left out only for the instances that asked for it. Needs `../shared` (or BMOD_SHARED).
//! Columns: instances that asked for it; of these no longer solved, solved with a worse objective (relative difference above 1e-6), solved
//! only without it, solved with a better objective; processor time without it by that with it, on these instances.

#[path = "../tests/common/mod.rs"]
mod common;

use bmod::run::Options;
use bmod::solve::strategy::{STRATEGIES, Strategy, take_asked};
use std::collections::BTreeSet;
use std::ffi::c_long;
use std::path::PathBuf;

unsafe extern "C" {
    /// Processor time of the process, in microseconds (POSIX).
    safe fn clock() -> c_long;
}

struct Case {
    name: String,
    kind: String,
    file: PathBuf,
    /// 1, −1 for a maximum, or 0 where the sense is that of each solve.
    sign: f64,
}

/// How the solves of a file ended.
struct Ended {
    /// Status is that of a solution, and the objective; by solve.
    solves: Vec<(bool, f64)>,
    seconds: f64,
    asked: Vec<Strategy>,
}

fn run(case: &Case, without: Option<&str>, limit: f64) -> Ended {
    take_asked();
    let mut options = Options {
        time_limit: limit,
        ..common::quiet()
    };
    let pairs = without.map(|name| ("without".to_string(), name.to_string()));
    let pairs: Vec<_> = pairs.into_iter().collect();
    options.set(&pairs).expect("a strategy of the table");
    let before = clock();
    let done = common::run_file(&case.file, &[PathBuf::from("models")], options);
    let seconds = (clock() - before) as f64 / 1e6;
    let solves = done.report.solves.iter().map(|s| {
        let code = s.model_status.code;
        let solved = matches!(code, 1 | 2 | 8 | 16) && s.solver_status.code == 1;
        let sign = match (case.sign, s.sense) {
            (0.0, Some(bmod::Sense::Maximize)) => -1.0,
            (0.0, _) => 1.0,
            (sign, _) => sign,
        };
        (solved, sign * s.objective.map_or(0.0, |o| o.0))
    });
    Ended {
        solves: solves.collect(),
        seconds,
        asked: take_asked(),
    }
}

fn cases(types: &[String], only: &str) -> Vec<Case> {
    let mut out = Vec::new();
    let wanted = |kind: &str| types.is_empty() || types.iter().any(|t| t == kind);
    if let Some(folder) = common::shared("corpus") {
        for row in common::records(&folder.join("reference.csv")) {
            let kind = match &row[2] {
                "NLP" | "DNLP" | "QCP" => "nlp".to_string(),
                other => other.to_lowercase(),
            };
            out.push(Case {
                name: row[0].to_string(),
                kind,
                file: folder.join(&row[0]),
                sign: if &row[5] == "max" { -1.0 } else { 1.0 },
            });
        }
        for row in common::records(&folder.join("mcp/reference.csv")) {
            out.push(Case {
                name: format!("mcp/{}", &row[0]),
                kind: "mcp".into(),
                file: folder.join("mcp").join(&row[0]),
                sign: 0.0,
            });
        }
    }
    for file in common::files("models".as_ref(), &["blk"]) {
        out.push(Case {
            name: file.display().to_string(),
            kind: "models".into(),
            file,
            sign: 0.0,
        });
    }
    out.retain(|c| wanted(&c.kind) && c.name.contains(only));
    out
}

/// What is different: lost, worse, gained, better.
fn compare(with: &Ended, without: &Ended) -> [bool; 4] {
    let mut out = [false; 4];
    for (k, &(solved, value)) in with.solves.iter().enumerate() {
        let (now, other) = without.solves.get(k).copied().unwrap_or_default();
        let margin = 1e-6 * value.abs().max(1.0);
        match (solved, now) {
            (true, false) => out[0] = true,
            (false, true) => out[2] = true,
            (true, true) => {
                out[1] |= other > value + margin;
                out[3] |= other < value - margin;
            }
            (false, false) => {}
        }
    }
    out
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let value = |name: &str| {
        let at = arguments.iter().position(|a| a == name)?;
        arguments.get(at + 1).cloned()
    };
    let list = |name: &str| -> Vec<String> {
        let text = value(name).unwrap_or_default();
        let parts = text.split(',').map(str::trim).filter(|p| !p.is_empty());
        parts.map(str::to_string).collect()
    };
    let limit: f64 = value("--limit").map_or(20.0, |l| l.parse().expect("seconds"));
    let cases = cases(&list("--type"), &value("--only").unwrap_or_default());
    let chosen = list("--strategy");
    let with: Vec<Ended> = cases.iter().map(|c| run(c, None, limit)).collect();
    let solved = with.iter().filter(|e| e.solves.iter().all(|s| s.0));
    let seconds: f64 = with.iter().map(|e| e.seconds).sum();
    println!(
        "{} instances, {} solved, {seconds:.1} s\n",
        cases.len(),
        solved.count()
    );
    println!("| strategy | area | asked | lost | worse | gained | better | time | which |");
    println!("| --- | --- | --: | --: | --: | --: | --: | --: | --- |");
    for row in STRATEGIES {
        if !chosen.is_empty() && !chosen.iter().any(|c| c == row.name) {
            continue;
        }
        let (mut count, mut times, mut which) = ([0; 4], [0.0, 0.0], BTreeSet::new());
        let asked = cases
            .iter()
            .zip(&with)
            .filter(|(_, e)| e.asked.contains(&row.strategy));
        let mut number = 0;
        for (case, with) in asked {
            number += 1;
            let without = run(case, Some(row.name), limit);
            times[0] += with.seconds;
            times[1] += without.seconds;
            for (k, is) in compare(with, &without).into_iter().enumerate() {
                count[k] += usize::from(is);
                if is {
                    which.insert(format!("{}{}", ["−", "↓", "+", "↑"][k], case.name));
                }
            }
        }
        let ratio = match number {
            0 => "–".to_string(),
            _ => format!("{:.2}", times[1] / times[0]),
        };
        let which: Vec<String> = which.into_iter().collect();
        println!(
            "| `{}` | {} | {number} | {} | {} | {} | {} | {ratio} | {} |",
            row.name,
            row.area,
            count[0],
            count[1],
            count[2],
            count[3],
            which.join(" ")
        );
    }
}
