//! The nonlinear programs of the corpus with every solver in the build, side by side, as Markdown: iterations,
//! seconds, the certificate's residuals in the units of the model, and whether the reference's objective is reached.
//!
//! `cargo bench --bench nlp`, or `cargo bench --bench nlp --features ipopt` for both solvers. Needs `../shared`
//! (or BMOD_SHARED).

use bmod::cli::host::{Output, SystemHost};
use bmod::run::Options;
use bmod::session;
use bmod::source::PreprocessOptions;
use std::path::{Path, PathBuf};

struct Line {
    status: u32,
    objective: f64,
    iterations: u64,
    seconds: f64,
    residual: f64,
}

fn solve(file: &Path, provider: &str) -> Option<Line> {
    let mut host = SystemHost::new(file, Path::new("."), &[], Output::Quiet);
    let texts = ["nlp", "dnlp", "qcp"].map(|t| (t.to_string(), provider.to_string()));
    let options = Options {
        quiet: true,
        collect: false,
        texts: texts.into_iter().collect(),
        ..Options::default()
    };
    let done = session::run(
        &mut host,
        &file.to_string_lossy(),
        PreprocessOptions::default(),
        options,
        false,
        &mut |_| {},
    );
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
    let shared = std::env::var_os("BMOD_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"),
        PathBuf::from,
    );
    let folder = shared.join("corpus");
    let Ok(mut reader) = csv::Reader::from_path(folder.join("reference.csv")) else {
        println!("SKIPPED: {} is not there", folder.display());
        return;
    };
    let names: Vec<&str> = bmod::solve::nlp::providers()
        .iter()
        .map(|p| p.name())
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
    for row in reader.records() {
        let row = row.expect("a row of the reference");
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
