//! Real instances with reference answers, kept beside the project (`../shared/corpus`, or the folder
//! named by BMOD_SHARED): every file compiles, its statistics are the reference's, and the linear
//! programs have the reference's objective. Skipped, visibly, where the folder is not there.

use std::path::{Path, PathBuf};

use bmod::cli::host::{Output, SystemHost};
use bmod::report::json::{RunStatus, SolveReport};
use bmod::run::{ListOptions, Options};
use bmod::session;
use bmod::source::PreprocessOptions;

fn corpus() -> Option<PathBuf> {
    let shared = std::env::var_os("BMOD_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"),
        PathBuf::from,
    );
    let folder = shared.join("corpus");
    if folder.join("reference.csv").exists() {
        return Some(folder);
    }
    println!("SKIPPED: {} is not there", folder.display());
    None
}

/// Runs a file; with `generate_only`, nothing is solved.
fn run(file: &Path, generate_only: bool) -> Result<SolveReport, String> {
    run_with(file, generate_only, None)
}

/// Runs a file with the nonlinear solver of that name.
fn run_with(
    file: &Path,
    generate_only: bool,
    provider: Option<&str>,
) -> Result<SolveReport, String> {
    let mut host = SystemHost::new(file, Path::new("."), &[], Output::Quiet);
    let texts = ["nlp", "dnlp", "qcp"].map(str::to_string);
    let options = Options {
        quiet: true,
        collect: false,
        texts: provider
            .map(|p| texts.into_iter().map(|t| (t, p.to_string())).collect())
            .unwrap_or_default(),
        list: generate_only.then(|| ListOptions {
            limit: 0,
            only: Vec::new(),
        }),
        ..Options::default()
    };
    let finished = session::run(
        &mut host,
        &file.to_string_lossy(),
        PreprocessOptions::default(),
        options,
        false,
        &mut |_| {},
    );
    match finished.report.solves.last() {
        Some(s) if finished.end == RunStatus::Ok => Ok(s.clone()),
        _ => Err(finished.diagnostics.first().map_or_else(
            || "no solve".to_string(),
            |d| format!("line {}: {}", finished.map.line(d.span), d.message),
        )),
    }
}

#[test]
fn statistics_are_those_of_the_reference() {
    let Some(folder) = corpus() else { return };
    let mut reader =
        csv::Reader::from_path(folder.join("reference.csv")).expect("the reference can be read");
    let (mut wrong, mut count) = (Vec::new(), 0);
    for row in reader.records() {
        let row = row.expect("a row of the reference");
        let number = |k: usize| row[k].parse::<usize>().expect("a count");
        let want = [number(6), number(7), number(8), number(9)];
        count += 1;
        match run(&folder.join(&row[0]), true) {
            Ok(s) => {
                let got = [s.rows, s.columns, s.nonzeros, s.nonlinear_nonzeros];
                if got != want {
                    wrong.push(format!("{}: {got:?}, the reference has {want:?}", &row[0]));
                }
            }
            Err(e) => wrong.push(format!("{}: {e}", &row[0])),
        }
    }
    assert!(count > 100, "{count} rows in the reference");
    assert!(
        wrong.is_empty(),
        "{} of {count}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

#[test]
fn linear_programs_have_the_objective_of_the_reference() {
    let Some(folder) = corpus() else { return };
    let mut reader =
        csv::Reader::from_path(folder.join("reference.csv")).expect("the reference can be read");
    let mut wrong = Vec::new();
    for row in reader.records() {
        let row = row.expect("a row of the reference");
        if &row[2] != "LP" {
            continue;
        }
        let want: f64 = row[4].parse().expect("an objective");
        match run(&folder.join(&row[0]), false) {
            Ok(s) => {
                let got = s.objective.map_or(f64::NAN, |o| o.0);
                if (got - want).abs() > 1e-7 * want.abs().max(1.0) || s.model_status.code != 1 {
                    wrong.push(format!(
                        "{}: {got} ({}), the reference has {want}",
                        &row[0], s.model_status.name
                    ));
                }
            }
            Err(e) => wrong.push(format!("{}: {e}", &row[0])),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// At least 95 in 100 reach an objective no worse than the reference's from the start of the file, with a
/// certificate; never is a point called optimal that is not feasible.
#[test]
fn nonlinear_programs_are_no_worse_than_the_reference() {
    let Some(folder) = corpus() else { return };
    for provider in bmod::solve::nlp::providers() {
        let name = provider.name();
        let mut reader = csv::Reader::from_path(folder.join("reference.csv"))
            .expect("the reference can be read");
        let (mut count, mut worse) = (0, Vec::new());
        for row in reader.records() {
            let row = row.expect("a row of the reference");
            if !matches!(&row[2], "NLP" | "DNLP" | "QCP") {
                continue;
            }
            count += 1;
            let want: f64 = row[4].parse().expect("an objective");
            let sign = if &row[5] == "max" { -1.0 } else { 1.0 };
            match run_with(&folder.join(&row[0]), false, Some(name)) {
                Ok(s) => {
                    let got = s.objective.map_or(f64::NAN, |o| o.0);
                    let reached = sign * (got - want) <= 1e-6 * want.abs().max(1.0);
                    if !(reached && matches!(s.model_status.code, 1 | 2)) {
                        worse.push(format!(
                            "{}: {got} ({}), the reference has {want}",
                            &row[0], s.model_status.name
                        ));
                    }
                }
                Err(e) => worse.push(format!("{}: {e}", &row[0])),
            }
        }
        println!(
            "{name}: {} of {count}; the rest:\n{}",
            count - worse.len(),
            worse.join("\n")
        );
        assert!(
            worse.len() * 20 <= count,
            "{name}: {} of {count} are worse:\n{}",
            worse.len(),
            worse.join("\n")
        );
    }
}
