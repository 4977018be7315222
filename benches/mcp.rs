//! The complementarity solver: counts, residuals and times.
//!
//! - `cargo bench --bench mcp -- walls [COURSES×WIDTH…]`: system (7) of growing walls in running bond, from
//!   the zero start, for three friction coefficients, φ₀ = 0 and φ₀ = φ; then the growth exponents.
//! - `cargo bench --bench mcp -- corpus [PATH.csv]`: the corpus beside the project, run through the language:
//!   the table of `docs/lab/mcp.md`, and sums. `PATH.csv` holds lines `file,seconds` of PATH for the ratio of times.
//! - `cargo bench --bench mcp -- obstacle [N…]`: the obstacle problem on a string of N elements;
//!   of one N alone with its log.
//! - `cargo bench --bench mcp -- log COURSES×WIDTH TANPHI 0|phi`: one wall with its log.

use std::time::Instant;

use bmod::solve::mcp::{Outcome, Problem, Settings, Status, solve};
use bmod::solve::{Budget, Limits, Monitor};

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/complementarity/mod.rs"]
mod complementarity;
#[path = "../tests/walls/mod.rs"]
mod walls;

struct Log(Instant);

impl Monitor for Log {
    fn log(&mut self, line: &str) {
        println!("{line}");
    }
    fn interrupted(&mut self) -> bool {
        false
    }
    fn seconds(&mut self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

fn logged(problem: &mut dyn Problem, settings: &Settings, log: bool) -> Outcome {
    let mut monitor = Log(Instant::now());
    let budget = Budget::new(&mut monitor, Limits::default(), log);
    solve(problem, settings, &budget, &|i| (i + 1).to_string())
}

/// Seconds this process has computed, whatever else the machine does; off Linux, seconds of the clock.
fn seconds() -> f64 {
    let spent = std::fs::read_to_string("/proc/self/schedstat").ok();
    let nanoseconds = spent.and_then(|s| s.split(' ').next()?.parse::<f64>().ok());
    static BEGIN: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    nanoseconds.map_or_else(|| BEGIN.elapsed().as_secs_f64(), |n| 1e-9 * n)
}

/// `30x15` or `30×15`.
fn size(text: &str) -> Option<(usize, usize)> {
    let (courses, width) = text.split_once(['x', '×'])?;
    Some((courses.parse().ok()?, width.parse().ok()?))
}

fn one(courses: usize, width: usize, friction: f64, associated: bool, log: bool) -> (Outcome, f64) {
    let mut wall = walls::wall(courses, width, friction, associated);
    let settings = Settings::default();
    let begin = seconds();
    let outcome = logged(&mut wall, &settings, log);
    let seconds = seconds() - begin;
    println!(
        "| {courses} × {width} | {} | {friction:.2}, {} | {:.9} | {} | {} | {} | {} | {:.0e} | {seconds:.2} |{}",
        outcome.x.len(),
        if associated { "φ" } else { "0" },
        outcome.x[0],
        outcome.majors,
        outcome.pivots,
        outcome.crash_iterations,
        outcome.factorisations,
        outcome.residual,
        if outcome.status == Status::Solved {
            String::new()
        } else {
            format!(" {:?}", outcome.status)
        },
    );
    (outcome, seconds)
}

fn sweep(sizes: &[(usize, usize)]) {
    println!(
        "| courses × width | n | tan φ, φ₀ | α | majors | pivots | crash | factorisations | residual | s |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    // Of each case, the logarithms of n and of the seconds.
    let mut growth: Vec<Vec<(f64, f64)>> = vec![Vec::new(); 6];
    for &(courses, width) in sizes {
        for (case, growth) in growth.iter_mut().enumerate() {
            let friction = [0.4, 0.65, 1.0][case / 2];
            let (outcome, seconds) = one(courses, width, friction, case % 2 == 1, false);
            growth.push(((outcome.x.len() as f64).ln(), seconds.ln()));
        }
    }
    if sizes.len() > 1 {
        let exponents: Vec<String> = growth.iter().map(|g| format!("{:.2}", slope(g))).collect();
        println!(
            "\nseconds ~ n^p, p of the six cases: {}",
            exponents.join(", ")
        );
    }
}

fn obstacle(sizes: &[usize]) {
    println!("| n | majors | pivots | crash | factorisations | residual | s |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for &n in sizes {
        let (settings, begin) = (Settings::default(), seconds());
        let outcome = logged(&mut walls::obstacle(n), &settings, sizes.len() == 1);
        println!(
            "| {n} | {} | {} | {} | {} | {:.0e} | {:.2} |",
            outcome.majors,
            outcome.pivots,
            outcome.crash_iterations,
            outcome.factorisations,
            outcome.residual,
            seconds() - begin
        );
    }
}

/// Slope of the line of least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (x, y) = points
        .iter()
        .fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
    let over: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    over / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// The number after a word of the log's last line.
fn count(log: &str, word: &str) -> usize {
    let line = log
        .lines()
        .rev()
        .find(|l| l.contains("; majors "))
        .unwrap_or_default();
    let after = line.split(&format!(" {word} ")).nth(1).unwrap_or_default();
    after
        .split([',', ' '])
        .next()
        .and_then(|n| n.parse().ok())
        .unwrap_or(0)
}

fn corpus(times: Option<&str>) {
    let Some(folder) = complementarity::corpus() else {
        return;
    };
    let times: Vec<(String, f64)> = times
        .and_then(|f| std::fs::read_to_string(f).ok())
        .unwrap_or_default()
        .lines()
        .filter_map(|l| l.split_once(','))
        .filter_map(|(f, t)| Some((f.to_string(), t.parse().ok()?)))
        .collect();
    println!(
        "| problem | n | status | majors | pivots | crash | factorisations | residual | ms | PATH: solved | majors | pivots | crash | ms |"
    );
    println!(
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    );
    let (mut ours, mut theirs, mut ratio, mut solved) = ([0; 4], [0; 3], Vec::new(), [0, 0]);
    for reference in complementarity::references(&folder) {
        let file = folder.join(&reference.file);
        let (report, log) = match complementarity::run(&file, true) {
            Ok(done) => done,
            Err(e) => {
                println!("| {} | {} | {e} |", reference.file, reference.size);
                continue;
            }
        };
        // The time without the log.
        let seconds = (0..5)
            .filter_map(|_| complementarity::run(&file, false).ok())
            .map(|(r, _)| r.seconds.solve)
            .fold(report.seconds.solve, f64::min);
        let counts = ["majors", "pivots", "crash", "factorisations"].map(|w| count(&log, w));
        let path = [reference.majors, reference.minors, reference.crash];
        (0..4).for_each(|k| ours[k] += counts[k]);
        (0..3).for_each(|k| theirs[k] += path[k]);
        solved[0] += usize::from(report.model_status.code == 1);
        solved[1] += usize::from(reference.solved);
        let time = times.iter().find(|t| t.0 == reference.file).map(|t| t.1);
        if let Some(t) = time.filter(|t| *t > 5e-3) {
            ratio.push((seconds / t).ln());
        }
        println!(
            "| {} | {} | {} | {} | {} | {} | {} | {:.0e} | {:.1} | {} | {} | {} | {} | {} |",
            reference.file.trim_end_matches(".gms"),
            reference.size,
            report.model_status.name,
            counts[0],
            counts[1],
            counts[2],
            counts[3],
            report.residual.natural.unwrap_or(f64::NAN),
            1e3 * seconds,
            if reference.solved { "yes" } else { "no" },
            path[0],
            path[1],
            path[2],
            time.map_or(String::new(), |t| format!("{:.1}", 1e3 * t)),
        );
    }
    println!(
        "| sum | | {} solved | {} | {} | {} | {} | | | {} | {} | {} | {} | |",
        solved[0], ours[0], ours[1], ours[2], ours[3], solved[1], theirs[0], theirs[1], theirs[2]
    );
    if !ratio.is_empty() {
        let mean = (ratio.iter().sum::<f64>() / ratio.len() as f64).exp();
        println!(
            "\ntime against PATH's where that is above 5 ms: {mean:.2} ({} problems, geometric mean)",
            ratio.len()
        );
    }
}

fn main() {
    let words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    match words.first().map(String::as_str) {
        Some("walls") => {
            let mut sizes: Vec<_> = words[1..].iter().filter_map(|w| size(w)).collect();
            if sizes.is_empty() {
                sizes = vec![(15, 8), (20, 10), (30, 15), (60, 30)];
            }
            sweep(&sizes);
        }
        Some("obstacle") => {
            let mut sizes: Vec<_> = words[1..].iter().filter_map(|w| w.parse().ok()).collect();
            if sizes.is_empty() {
                sizes = vec![10_000, 100_000];
            }
            obstacle(&sizes);
        }
        Some("corpus") => corpus(words.get(1).map(String::as_str)),
        Some("log") if words.len() == 4 => {
            let (courses, width) = size(&words[1]).expect("a size like 30x15");
            let friction = words[2].parse().expect("tan φ");
            one(courses, width, friction, words[3] == "phi", true);
        }
        _ => println!("see the head of benches/mcp.rs"),
    }
}
