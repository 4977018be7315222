//! The language suite: every file of `tests/suite` runs, and every claim in its comments holds (their
//! form: `tests/suite/README.md`).
//!
//! `SUITE=put cargo test --test all suite::` runs the files whose path contains `put`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::{Memory, files};
use bmod::claims::{same, spelled, value_of};
use bmod::diag::Severity;
use bmod::report::json::SolveReport;
use bmod::report::why::Explanation;
use bmod::run::Options;
use bmod::session;
use bmod::source::PreprocessOptions;

/// What the comments of a file claim.
#[derive(Default)]
struct Claims {
    values: Vec<(usize, String)>,
    display: Vec<String>,
    statistics: Vec<String>,
    errors: BTreeSet<usize>,
    executions: BTreeSet<usize>,
    exit: Option<u8>,
    files: BTreeMap<String, Vec<String>>,
    defines: Vec<(String, String)>,
    nonlinear: bool,
    /// What `bmod why` must name.
    why: Vec<String>,
    /// Members of an irreducible infeasible set.
    irreducible: Option<usize>,
    /// Largest relative width of the last solve's proved interval.
    width: Option<f64>,
    /// Runs only when it is asked for.
    slow: bool,
}

fn claims(text: &str) -> Claims {
    let mut c = Claims::default();
    let lower = text.to_lowercase();
    c.nonlinear = ["nlp", "mcp", "cns", "mpec", "qcp"]
        .iter()
        .any(|t| lower.contains(&format!("using {t}")) || lower.contains(&format!("using dn{t}")));
    for (n, line) in text.lines().enumerate() {
        let rest = |mark: &str| {
            line.strip_prefix(mark)
                .map(|r| r.strip_prefix(' ').unwrap_or(r))
        };
        if let Some(r) = rest("*=") {
            c.values.push((n + 1, r.trim().to_string()));
        } else if let Some(r) = rest("*>") {
            c.display.push(r.trim_end().to_string());
        } else if let Some(r) = rest("*#") {
            c.statistics.push(r.trim().to_string());
        } else if let Some(r) = rest("*!") {
            let words: Vec<&str> = r.split_whitespace().collect();
            match words[..] {
                ["error", l, ..] => drop(c.errors.insert(l.parse().expect("a line"))),
                ["execution", l, ..] => drop(c.executions.insert(l.parse().expect("a line"))),
                ["gams", ..] => {}
                ["slow"] => c.slow = true,
                ["exit", e, ..] => c.exit = Some(e.parse().expect("a status")),
                _ => panic!("line {}: {line}", n + 1),
            }
        } else if let Some(r) = rest("*?") {
            let (what, of) = r.trim().split_once(' ').expect("a claim and its value");
            match what {
                "why" => c.why.push(of.to_string()),
                "irreducible" => c.irreducible = Some(of.parse().expect("a number")),
                "width" => c.width = Some(of.parse().expect("a number")),
                _ => panic!("line {}: {line}", n + 1),
            }
        } else if let Some(r) = line.strip_prefix("*|") {
            let (file, text) = r.split_once('|').expect("a file name between bars");
            let text = text.strip_prefix(' ').unwrap_or(text);
            let lines = c.files.entry(file.to_string()).or_default();
            lines.push(text.trim_end().to_string());
        } else if let Some(r) = rest("*@") {
            let words: Vec<&str> = r.split_whitespace().collect();
            let ["-D", define] = words[..] else {
                panic!("line {}: {line}", n + 1);
            };
            let (name, value) = define.split_once('=').expect("NAME=VALUE");
            c.defines.push((name.into(), value.into()));
        }
    }
    c
}

/// Lines without blanks at their ends, several empty ones as one, none at the ends.
fn tidy<'a>(lines: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for l in lines.map(str::trim_end) {
        if !l.is_empty() || out.last().is_some_and(|o| !o.is_empty()) {
            out.push(l.to_string());
        }
    }
    while out.last().is_some_and(String::is_empty) {
        out.pop();
    }
    out
}

/// The first line in which two texts differ.
fn difference(actual: &[String], claimed: &[String]) -> Option<String> {
    let n = actual.len().max(claimed.len());
    let k = (0..n).find(|&k| actual.get(k) != claimed.get(k))?;
    let line = |l: &[String]| {
        l.get(k)
            .map_or("(nothing)".to_string(), |t| format!("|{t}|"))
    };
    Some(format!(
        "line {}:\n        is {}\n    should {}",
        k + 1,
        line(actual),
        line(claimed)
    ))
}

/// What is wrong with a file.
fn check(path: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(path).expect("the file can be read");
    let name = path.file_name().expect("a name").to_string_lossy();
    let folder = path.parent().expect("a folder").to_path_buf();
    check_text(&name, &text, folder, BTreeMap::new())
}

/// What is wrong with a text; `files` are there besides those of the folder.
fn check_text(
    name: &str,
    text: &str,
    folder: PathBuf,
    files: BTreeMap<String, String>,
) -> Vec<String> {
    let c = claims(text);
    let mut host = Memory::new(files, Some(folder));
    let preprocess = PreprocessOptions {
        defines: c.defines.clone(),
        slash_comments: true,
        ..PreprocessOptions::default()
    };
    let options = Options {
        time_limit: 600.0, // a guard: how fast the machine is decides nothing
        collect: false,
        why: !c.why.is_empty() || c.irreducible.is_some(),
        certify: c.width.is_some(),
        ..Options::default()
    };
    let mut wrong = Vec::new();
    let mut values = Vec::new();
    let finished = session::run(&mut host, name, preprocess, options, false, &mut |m| {
        for (line, claim) in &c.values {
            let (what, claimed) = claim
                .rsplit_once(char::is_whitespace)
                .expect("a name and a value");
            values.push((
                *line,
                what.trim().to_string(),
                claimed.to_string(),
                value_of(m, what),
            ));
        }
    });
    let lines = |severity: Severity| -> BTreeSet<usize> {
        let of = finished
            .diagnostics
            .iter()
            .filter(|d| d.severity == severity);
        of.map(|d| finished.map.line(d.span)).collect()
    };
    let exit = match c.exit {
        Some(e) => e,
        None if !c.errors.is_empty() => 2,
        None if !c.executions.is_empty() => 3,
        None => 0,
    };
    let (errors, executions) = (lines(Severity::Error), lines(Severity::Execution));
    if finished.end.exit() != exit || (exit == 2 && !c.errors.is_empty() && errors != c.errors) {
        wrong.push(format!(
            "exit status {} (errors at {errors:?}), should be {exit} (at {:?})",
            finished.end.exit(),
            c.errors
        ));
        for d in finished.diagnostics.iter().take(3) {
            wrong.push(format!(
                "    {} line {}: {}",
                d.code,
                finished.map.line(d.span),
                d.message
            ));
        }
        if exit != 2 && finished.end.exit() == 2 {
            return wrong;
        }
    }
    if !c.executions.is_subset(&executions) {
        wrong.push(format!(
            "execution errors at {executions:?}, should be at {:?}",
            c.executions
        ));
    }
    let tolerance = if c.nonlinear { 1e-6 } else { 1e-9 };
    for (line, what, claimed, actual) in values {
        match actual {
            Some(a) if same(a, &claimed, tolerance) => {}
            Some(a) => wrong.push(format!(
                "line {line}: {what} is {}, should be {claimed}",
                spelled(a)
            )),
            None => wrong.push(format!("line {line}: there is no {what}")),
        }
    }
    if !c.display.is_empty() {
        let displays = host.printed.iter().filter(|t| t.starts_with("----"));
        let displays: String = displays.map(String::as_str).collect();
        let actual = tidy(displays.lines());
        let claimed = tidy(c.display.iter().map(String::as_str));
        wrong.extend(difference(&actual, &claimed).map(|d| format!("display, {d}")));
    }
    for (file, claimed) in &c.files {
        match host.files.get(file) {
            None => wrong.push(format!("the file {file} was not written")),
            Some(text) => {
                let actual: Vec<String> = text.lines().map(|l| l.trim_end().to_string()).collect();
                wrong.extend(difference(&actual, claimed).map(|d| format!("{file}, {d}")));
            }
        }
    }
    wrong.extend(explained(&c, &finished.report.solves));
    for (k, claimed) in c.statistics.iter().enumerate() {
        let actual = finished.report.solves.get(k).map(|s| {
            format!(
                "rows {} columns {} nonzeros {} nonlinear {}",
                s.rows, s.columns, s.nonzeros, s.nonlinear_nonzeros
            )
        });
        let actual = actual.unwrap_or_else(|| "no solve".into());
        if actual != *claimed {
            wrong.push(format!("solve {}: {actual}, should be {claimed}", k + 1));
        }
    }
    wrong
}

/// What is wrong with the explanations and the proved interval.
fn explained(c: &Claims, solves: &[SolveReport]) -> Vec<String> {
    let mut wrong = Vec::new();
    let whys = || solves.iter().filter_map(|s| s.why.as_ref());
    for name in &c.why {
        let named = |w: &Explanation| w.rows.contains(name) || w.columns.contains(name);
        let said = |w: &Explanation| w.text.iter().any(|t| t.contains(name.as_str()));
        if !whys().any(|w| named(w) || said(w)) {
            let all: Vec<&Explanation> = whys().collect();
            wrong.push(format!("no explanation names {name}: {all:?}"));
        }
    }
    if let Some(count) = c.irreducible {
        let shown = |w: &&Explanation| {
            let text = w.text.first().map_or("", String::as_str);
            text.contains("with any one of them dropped") || text.contains("cannot be satisfied")
        };
        let found: Vec<usize> = whys()
            .filter(shown)
            .map(|w| {
                let first = w.text[0].split(':').next().unwrap_or("");
                let counts = first.split_whitespace().take_while(|t| *t != "with");
                counts.filter_map(|t| t.parse::<usize>().ok()).sum()
            })
            .collect();
        if !found.contains(&count) {
            wrong.push(format!("irreducible sets of {found:?}, should be {count}"));
        }
    }
    if let Some(width) = c.width {
        let solve = solves.last().and_then(|s| Some((s, s.objective?.0)));
        match solve.and_then(|(s, v)| Some((s.bounds?.map(|b| b.0), v))) {
            Some(([lo, hi], v)) => {
                let size = v.abs().max(f64::MIN_POSITIVE);
                // The objective itself is rounded.
                let slack = 1e-12 * size + width * size;
                let holds = lo - slack <= v && v <= hi + slack && lo <= hi;
                if !holds || (hi - lo) > width * size {
                    wrong.push(format!("proved [{lo}, {hi}], objective {v}, width {width}"));
                }
            }
            None => {
                let said = solves.last().and_then(|s| s.message.clone());
                wrong.push(format!("no interval was proved: {said:?}"));
            }
        }
    }
    wrong
}

#[test]
fn every_claim_of_the_suite_holds() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    hold(files(&root.join("tests/suite"), &["blk", "gms"]));
}

#[test]
fn the_models_have_their_known_answers() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = vec![root.join("models/wall.blk")];
    for folder in [
        "tests/models",
        "models/teaching",
        "models/walls",
        "models/structures",
        "models/hard",
    ] {
        all.extend(files(&root.join(folder), &["blk"]));
    }
    let slow = |p: &PathBuf| claims(&std::fs::read_to_string(p).expect("readable")).slow;
    if std::env::var("SUITE").is_err() {
        for p in all.iter().filter(|p| slow(p)) {
            crate::common::skipped(&format!("{}, slow: SUITE=name runs it", p.display()));
        }
        all.retain(|p| !slow(p));
    }
    hold(all);
}

/// The examples of a page: the fenced blocks marked `gams`, with the line where each begins.
fn examples(page: &str) -> Vec<(usize, String)> {
    let mut out: Vec<(usize, String)> = Vec::new();
    let mut inside = false;
    for (n, line) in page.lines().enumerate() {
        match (inside, line.trim_end()) {
            (false, "```gams") => {
                inside = true;
                out.push((n + 2, String::new()));
            }
            (true, "```") => inside = false,
            (true, line) => {
                let text = &mut out.last_mut().expect("a block has begun").1;
                text.push_str(line);
                text.push('\n');
            }
            _ => {}
        }
    }
    assert!(!inside, "the last example is not closed");
    out
}

/// Every example of the pages for users runs, claims something, and every claim holds.
#[test]
fn the_examples_of_the_reference_hold() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let mut wrong = Vec::new();
    for page in ["language.md", "gams.md"] {
        let text = std::fs::read_to_string(docs.join(page)).expect("the page is there");
        let all = examples(&text);
        assert!(all.len() > 3, "{page} has {} examples", all.len());
        for (line, example) in all {
            let claims = example
                .lines()
                .any(|l| l.starts_with('*') && !l.starts_with("* "));
            if !claims {
                wrong.push(format!("{page} line {line}: the example claims nothing"));
            }
            let name = "example.blk".to_string();
            let files = BTreeMap::from([(name.clone(), example.clone())]);
            for w in check_text(&name, &example, docs.clone(), files) {
                wrong.push(format!("{page} line {line}: {w}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Every claim of every file holds.
fn hold(mut all: Vec<PathBuf>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    if let Ok(only) = std::env::var("SUITE") {
        all.retain(|p| p.to_string_lossy().contains(&only));
    }
    assert!(!all.is_empty(), "no file to run");
    let next = AtomicUsize::new(0);
    let failures = Mutex::new(BTreeMap::new());
    let workers = std::thread::available_parallelism()
        .map_or(1, usize::from)
        .min(4);
    std::thread::scope(|s| {
        for _ in 0..workers {
            // Nested expressions need room on the stack.
            let worker = || {
                while let Some(path) = all.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let result = std::panic::catch_unwind(|| check(path));
                    let wrong = result.unwrap_or_else(|p| {
                        let text = p.downcast_ref::<String>().cloned();
                        let text =
                            text.or_else(|| p.downcast_ref::<&str>().map(|s| (*s).to_string()));
                        vec![format!("panic: {}", text.unwrap_or_default())]
                    });
                    if !wrong.is_empty() {
                        failures
                            .lock()
                            .expect("no worker panics")
                            .insert(path.clone(), wrong);
                    }
                }
            };
            std::thread::Builder::new()
                .stack_size(64 << 20)
                .spawn_scoped(s, worker)
                .expect("a thread");
        }
    });
    let failures = failures.into_inner().expect("no worker panics");
    for (path, wrong) in &failures {
        println!("{}", path.strip_prefix(folder).unwrap_or(path).display());
        for w in wrong.iter().take(6) {
            println!("    {w}");
        }
    }
    assert!(
        failures.is_empty(),
        "{} of {} files fail",
        failures.len(),
        all.len()
    );
}
