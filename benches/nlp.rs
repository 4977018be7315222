//! The nonlinear programs of the corpus with every solver in the build, side by side, as Markdown: iterations,
//! seconds, the certificate's residuals in the units of the model, and whether the reference's objective is reached.
//!
//! `cargo bench --bench nlp`, or `cargo bench --bench nlp --features ipopt` for both solvers. Needs `../shared`
//! (or BMOD_SHARED).

#[path = "../tests/common/mod.rs"]
mod common;

use bmod::run::Options;
use std::path::Path;

struct Line {
    status: u32,
    objective: f64,
    iterations: u64,
    seconds: f64,
    residual: f64,
}

fn solve(file: &Path, provider: &str) -> Option<Line> {
    let texts = ["nlp", "dnlp", "qcp"].map(|t| (t.to_string(), provider.to_string()));
    let options = Options {
        texts: texts.into_iter().collect(),
        ..common::quiet()
    };
    let done = common::run_file(file, &[], options);
    let s = done.report.solves.last()?;
    Some(Line {
        status: s.model_status.code as u32,
        objective: s.objective.map_or(f64::NAN, |o| o.0),
        iterations: s.iterations,
        seconds: s.seconds.solve,
        residual: [s.residual.primal, s.residual.dual]
            .iter()
            .filter_map(|r| *r)
            .fold(0.0, f64::max),
    })
}

fn main() {
    let Some(folder) = common::shared("corpus") else {
        return;
    };
    let names: Vec<&str> = bmod::solve::nlp::interior_point_solvers()
        .iter()
        .map(|p| p.about().name)
        .collect();
    let heads: Vec<String> = names
        .iter()
        .map(|n| format!("{n}: status | iterations | seconds | residual | reached"))
        .collect();
    println!("| problem | {} |", heads.join(" | "));
    println!(
        "| --- |{}",
        " --- | --- | --- | --- | --- |".repeat(names.len())
    );
    let mut sums = vec![(0u64, 0.0, 0usize); names.len()];
    let mut count = 0;
    for row in common::records(&folder.join("reference.csv")) {
        if !matches!(&row[2], "NLP" | "DNLP" | "QCP") {
            continue;
        }
        count += 1;
        let want: f64 = row[4].parse().expect("an objective");
        let sign = if &row[5] == "max" { -1.0 } else { 1.0 };
        print!("| {} |", &row[0]);
        for (name, sum) in names.iter().zip(&mut sums) {
            let Some(l) = solve(&folder.join(&row[0]), name) else {
                print!(" – | – | – | – | no |");
                continue;
            };
            let reached = matches!(l.status, 1 | 2)
                && sign * (l.objective - want) <= 1e-6 * want.abs().max(1.0);
            sum.0 += l.iterations;
            sum.1 += l.seconds;
            sum.2 += usize::from(reached);
            print!(
                " {} | {} | {:.3} | {:.0e} | {} |",
                l.status,
                l.iterations,
                l.seconds,
                l.residual,
                if reached { "yes" } else { "no" }
            );
        }
        println!();
    }
    print!("| sum of {count} |");
    for s in sums {
        print!(" | {} | {:.1} | | {} |", s.0, s.1, s.2);
    }
    println!();
}
