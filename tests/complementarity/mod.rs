//! Complementarity problems in GAMS files, run through the language. For tests and benchmarks.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::common::{self, Memory};
use bmod::report::json::SolveReport;
use bmod::run::Options;

/// The folder `corpus/mcp` beside the project, if it is there.
pub fn corpus() -> Option<PathBuf> {
    common::shared("corpus/mcp")
}

/// A line of the corpus's reference: what PATH does.
pub struct Reference {
    pub file: String,
    pub size: usize,
    pub solved: bool,
    pub majors: usize,
    pub minors: usize,
    pub crash: usize,
}

/// The references, in the order of the table.
pub fn references(folder: &Path) -> Vec<Reference> {
    let rows = common::records(&folder.join("reference.csv"));
    rows.iter()
        .map(|row| {
            let number = |k: usize| row[k].parse::<usize>().expect("a count");
            Reference {
                file: row[0].to_string(),
                size: number(1),
                solved: &row[3] == "solution found",
                majors: number(4),
                minors: number(5),
                crash: number(6),
            }
        })
        .collect()
}

/// Runs a file: its last solve, and the log if asked for.
pub fn run(file: &Path, log: bool) -> Result<(SolveReport, String), String> {
    let mut host = Memory::new(BTreeMap::new(), Some(PathBuf::new()));
    let options = Options {
        log,
        ..common::quiet()
    };
    let finished = common::run(&mut host, &file.to_string_lossy(), options);
    Ok((common::last_solve(&finished)?, host.printed.concat()))
}
