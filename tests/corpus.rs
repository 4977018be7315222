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
    let options = Options {
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

/// Where another certified local optimum is reached by default than the reference's, from the start of the file, or the reference is
/// not an optimum: the objective, and why. Every other nonlinear program reaches the reference's objective or a better one.
const OTHER_OPTIMA: &[(&str, f64, &str)] = &[
    (
        "nlp/ex5_4_4.gms",
        12138.448027,
        "a vertex with large multipliers",
    ),
    (
        "nlp/ex7_3_5.gms",
        1.2068964599,
        "no multipliers at the solution: the reference is as much lower as its rows are violated",
    ),
];

/// Without a search every nonlinear program of the corpus has a certified point, no worse than the reference's or the one above.
#[test]
fn nonlinear_programs_are_no_worse_than_the_reference() {
    let Some((folder, rows)) = corpus() else {
        return;
    };
    let (mut count, mut wrong) = (0, Vec::new());
    for row in &rows {
        if !matches!(&row[2], "NLP" | "DNLP" | "QCP") {
            continue;
        }
        count += 1;
        let other = OTHER_OPTIMA.iter().find(|o| o.0 == &row[0]);
        let reference: f64 = row[4].parse().expect("an objective");
        let want = other.map_or(reference, |o| o.1);
        let sign = if &row[5] == "max" { -1.0 } else { 1.0 };
        let said = match run(&folder.join(&row[0]), false) {
            Ok(s) => {
                let got = s.objective.map_or(f64::NAN, |o| o.0);
                let reached = sign * (got - want) <= 1e-6 * want.abs().max(1.0);
                if reached && matches!(s.model_status.code, 1 | 2) {
                    continue;
                }
                format!("{got} ({})", s.model_status.name)
            }
            Err(e) => e,
        };
        wrong.push(format!("{}: {said}, expected {want}", &row[0]));
    }
    assert!(count > 100, "{count} nonlinear programs");
    assert!(
        wrong.is_empty(),
        "{} of {count}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}
