//! Complementarity problems in GAMS files, run through the language. For tests and benchmarks.

use std::path::{Path, PathBuf};
use std::time::Instant;

use bmod::host::{Host, HostError};
use bmod::report::json::{RunStatus, SolveReport};
use bmod::run::Options;
use bmod::session;
use bmod::source::PreprocessOptions;

/// The folder `corpus/mcp` beside the project, if it is there.
pub fn corpus() -> Option<PathBuf> {
    let shared = std::env::var_os("BMOD_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"),
        PathBuf::from,
    );
    let folder = shared.join("corpus/mcp");
    if folder.join("reference.csv").exists() {
        return Some(folder);
    }
    println!("SKIPPED: {} is not there", folder.display());
    None
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
    let mut reader =
        csv::Reader::from_path(folder.join("reference.csv")).expect("the reference can be read");
    reader
        .records()
        .map(|row| {
            let row = row.expect("a row of the reference");
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

/// Reads files, keeps what is printed.
struct Listener {
    printed: String,
    begin: Instant,
}

impl Host for Listener {
    fn read(&mut self, path: &str, _: Option<&Path>) -> Result<(PathBuf, String), HostError> {
        std::fs::read_to_string(path)
            .map(|text| (path.into(), text))
            .map_err(|_| HostError::NotFound)
    }
    fn exists(&mut self, path: &str, _: Option<&Path>) -> bool {
        Path::new(path).is_file()
    }
    fn write(&mut self, path: &str, _: &[u8]) -> Result<PathBuf, HostError> {
        Err(HostError::Outside(path.into()))
    }
    fn print(&mut self, text: &str) {
        self.printed.push_str(text);
    }
    fn elapsed(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }
    fn now(&self) -> f64 {
        46000.5
    }
    fn interrupted(&self) -> bool {
        false
    }
}

/// Runs a file: its last solve, and the log if asked for.
pub fn run(file: &Path, log: bool) -> Result<(SolveReport, String), String> {
    let mut host = Listener {
        printed: String::new(),
        begin: Instant::now(),
    };
    let options = Options {
        quiet: true,
        collect: false,
        solver_options: if log {
            vec![("log".into(), "1".into())]
        } else {
            Vec::new()
        },
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
        Some(s) if finished.end == RunStatus::Ok => Ok((s.clone(), host.printed)),
        _ => Err(finished.diagnostics.first().map_or_else(
            || "no solve".to_string(),
            |d| format!("line {}: {}", finished.map.line(d.span), d.message),
        )),
    }
}
