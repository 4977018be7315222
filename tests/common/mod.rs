//! What tests and benchmarks share: a host in memory, runs of files, the folder beside the project.

// Every test is a crate of its own and uses a part of this.
#![allow(dead_code)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use bmod::cli::host::{Output, SystemHost};
use bmod::host::{Found, Host, HostError};
use bmod::model::instance::Instance;
use bmod::model::problem_type::ProblemType;
use bmod::report::json::{RunStatus, SolveReport};
use bmod::run::Options;
use bmod::session::{self, Finished};
use bmod::source::PreprocessOptions;

/// A part of the folder `../shared` beside the project, or of the folder that BMOD_SHARED names. Says
/// so where it is not there.
pub fn shared(part: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let folder = std::env::var_os("BMOD_SHARED").map_or_else(beside, PathBuf::from);
    let found = folder.join(part);
    if found.exists() {
        return Some(found);
    }
    skipped(&format!(
        "{} is not there (set BMOD_SHARED)",
        found.display()
    ));
    None
}

/// Says that something was not tested, also where the output of tests that pass is not shown.
pub fn skipped(what: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "SKIPPED: {what}");
}

/// Rows of a table of reference answers.
pub fn records(csv: &Path) -> Vec<csv::StringRecord> {
    let reader = csv::Reader::from_path(csv).expect("the reference can be read");
    let rows = reader.into_records();
    rows.map(|r| r.expect("a row of the reference")).collect()
}

/// All files below a folder with one of these extensions, in order.
pub fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let is_wanted = |e: &str| path.extension().is_some_and(|x| x == e);
        if path.is_dir() {
            found.extend(files(&path, extensions));
        } else if extensions.iter().any(|e| is_wanted(e)) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Files in memory, over those of a folder; what is written and printed is kept.
pub struct Memory {
    pub files: BTreeMap<String, String>,
    pub folder: Option<PathBuf>,
    /// Each text that was printed.
    pub printed: Vec<String>,
    start: Instant,
}

impl Memory {
    pub fn new(files: BTreeMap<String, String>, folder: Option<PathBuf>) -> Self {
        Self {
            files,
            folder,
            printed: Vec::new(),
            start: Instant::now(),
        }
    }

    /// One text, called `m.blk`.
    pub fn text(text: &str) -> Self {
        Self::new(BTreeMap::from([("m.blk".into(), text.into())]), None)
    }

    fn on_disk(&self, path: &str) -> Option<PathBuf> {
        self.folder.as_ref().map(|f| f.join(path))
    }
}

impl Host for Memory {
    fn read(&mut self, path: &str, _: Option<&Path>) -> Found<String> {
        if let Some(text) = self.files.get(path) {
            return Ok((path.into(), text.clone()));
        }
        let real = self.on_disk(path).ok_or(HostError::NotFound)?;
        let text = std::fs::read_to_string(&real).map_err(|_| HostError::NotFound)?;
        Ok((real, text))
    }
    fn read_bytes(&mut self, path: &str, from: Option<&Path>) -> Found<Vec<u8>> {
        match self.on_disk(path).map(|p| (std::fs::read(&p), p)) {
            Some((Ok(bytes), real)) if !self.files.contains_key(path) => Ok((real, bytes)),
            _ => self.read(path, from).map(|(p, t)| (p, t.into_bytes())),
        }
    }
    fn exists(&mut self, path: &str, _: Option<&Path>) -> bool {
        self.files.contains_key(path) || self.on_disk(path).is_some_and(|p| p.is_file())
    }
    fn write(&mut self, path: &str, bytes: &[u8]) -> Result<PathBuf, HostError> {
        if path.contains("..") {
            return Err(HostError::Outside(path.into()));
        }
        let text = String::from_utf8_lossy(bytes).into_owned();
        self.files.insert(path.into(), text);
        Ok(path.into())
    }
    fn print(&mut self, text: &str) {
        self.printed.push(text.into());
    }
    fn elapsed(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
    fn now(&self) -> f64 {
        46000.5
    }
    /// What the whole test holds, where the system says so.
    fn memory(&self) -> usize {
        let pages = std::fs::read_to_string("/proc/self/statm").ok();
        let resident = pages.and_then(|p| p.split_whitespace().nth(1)?.parse::<usize>().ok());
        resident.map_or(0, |r| r * 4096)
    }
}

/// As for a `.blk` file.
pub fn blk() -> PreprocessOptions {
    PreprocessOptions {
        slash_comments: true,
        ..PreprocessOptions::default()
    }
}

/// Nothing for people.
pub fn quiet() -> Options {
    Options {
        quiet: true,
        collect: false,
        ..Options::default()
    }
}

/// Runs a file of a host.
pub fn run(host: &mut dyn Host, file: &str, options: Options) -> Finished {
    let preprocess = PreprocessOptions {
        slash_comments: file.ends_with(".blk"),
        max_memory: options.max_memory,
        ..PreprocessOptions::default()
    };
    session::run(host, file, preprocess, options, false, &mut |_| {})
}

/// Runs a file on disk; it may read what is below `allowed` besides its own folder.
pub fn run_file(file: &Path, allowed: &[PathBuf], options: Options) -> Finished {
    let mut host = SystemHost::new(file, None, allowed, Output::Quiet);
    run(&mut host, &file.to_string_lossy(), options)
}

/// The last solve of a run that went well, or its first complaint.
pub fn last_solve(finished: &Finished) -> Result<SolveReport, String> {
    match finished.report.solves.last() {
        Some(s) if finished.end == RunStatus::Ok => Ok(s.clone()),
        _ => Err(finished.diagnostics.first().map_or_else(
            || "no solve".to_string(),
            |d| format!("line {}: {}", finished.map.line(d.span), d.message),
        )),
    }
}

/// The problem types and instances of a text's solves, as they were before them.
pub fn instances(text: &str) -> Vec<(ProblemType, Instance)> {
    let mut host = Memory::text(text);
    let options = Options {
        keep_solutions: true,
        ..quiet()
    };
    let mut out = Vec::new();
    let finished = session::run(&mut host, "m.blk", blk(), options, false, &mut |m| {
        let kept = m.kept().iter().map(|k| k.parts());
        out = kept.map(|(_, using, i)| (using, i.clone())).collect();
    });
    let said: Vec<&String> = finished.diagnostics.iter().map(|d| &d.message).collect();
    assert!(!out.is_empty(), "{said:?}\n{text}");
    out
}

/// Numbers that look random and are the same in every run: D. E. Knuth's linear congruential generator (MMIX).
pub struct Random(pub u64);

impl Random {
    /// A whole number from 0 below n.
    pub fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    /// A whole number from −most to most.
    pub fn whole(&mut self, most: i64) -> f64 {
        (self.below(2 * most as u64 + 1) as i64 - most) as f64
    }
}
