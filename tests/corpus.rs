//! Real instances with reference answers, kept beside the project (`../shared/corpus`, or the folder
//! named by BMOD_SHARED): every file compiles, its statistics are the reference's, and the linear
//! programs have the reference's objective. Skipped, visibly, where the folder is not there.

use std::path::{Path, PathBuf};

use crate::common;
use bmod::report::json::SolveReport;
use bmod::run::{ListOptions, Options};
use csv::StringRecord;

/// The folder and the rows of its table.
fn corpus() -> Option<(PathBuf, Vec<StringRecord>)> {
    let folder = common::shared("corpus")?;
    let rows = common::records(&folder.join("reference.csv"));
    Some((folder, rows))
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
    let texts = ["nlp", "dnlp", "qcp"].map(str::to_string);
    let options = Options {
        texts: provider
            .map(|p| texts.into_iter().map(|t| (t, p.to_string())).collect())
            .unwrap_or_default(),
        solver_options: vec![("nlp_search".into(), "yes".into())],
        list: generate_only.then(|| ListOptions {
            limit: 0,
            only: Vec::new(),
        }),
        ..common::quiet()
    };
    common::last_solve(&common::run_file(file, &[], options))
}

#[test]
fn statistics_are_those_of_the_reference() {
    let Some((folder, rows)) = corpus() else {
        return;
    };
    let (mut wrong, mut count) = (Vec::new(), 0);
    for row in &rows {
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
    let Some((folder, rows)) = corpus() else {
        return;
    };
    let mut wrong = Vec::new();
    for row in &rows {
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

/// With the search for better optima at least 95 in 100 reach an objective no worse than the reference's from the start of the file, with a
/// certificate; never is a point called optimal that is not feasible.
#[test]
fn nonlinear_programs_are_no_worse_than_the_reference() {
    let Some((folder, rows)) = corpus() else {
        return;
    };
    for provider in bmod::solve::nlp::providers() {
        let name = provider.name();
        let (mut count, mut worse) = (0, Vec::new());
        for row in &rows {
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
