//! The complementarity solver: counts, residuals and times.
//!
//! - `cargo bench --bench mcp -- walls [COURSES×WIDTH…]`: system (7) of growing walls in running bond, from
//!   the zero start, for three friction coefficients, φ₀ = 0 and φ₀ = φ; then the growth exponents.
//! - `cargo bench --bench mcp -- log COURSES×WIDTH TANPHI 0|phi`: one wall with its log.

use std::time::Instant;

use bmod::solve::mcp::{Monitor, Outcome, Settings, Status, solve};

#[path = "../tests/walls/mod.rs"]
mod walls;

struct Log(bool);

impl Monitor for Log {
    fn log(&mut self, line: &str) {
        println!("{line}");
    }
    fn interrupted(&mut self) -> bool {
        false
    }
    fn wants_log(&self) -> bool {
        self.0
    }
}

/// `30x15` or `30×15`.
fn size(text: &str) -> Option<(usize, usize)> {
    let (courses, width) = text.split_once(['x', '×'])?;
    Some((courses.parse().ok()?, width.parse().ok()?))
}

fn one(courses: usize, width: usize, friction: f64, associated: bool, log: bool) -> (Outcome, f64) {
    let mut wall = walls::wall(courses, width, friction, associated);
    let clock = Instant::now();
    let settings = Settings::default();
    let outcome = solve(&mut wall, &settings, &mut Log(log));
    let seconds = clock.elapsed().as_secs_f64();
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
    for &(courses, width) in sizes {
        for friction in [0.4, 0.65, 1.0] {
            for associated in [false, true] {
                one(courses, width, friction, associated, false);
            }
        }
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
        Some("log") if words.len() == 4 => {
            let (courses, width) = size(&words[1]).expect("a size like 30x15");
            let friction = words[2].parse().expect("tan φ");
            one(courses, width, friction, words[3] == "phi", true);
        }
        _ => println!("see the head of benches/mcp.rs"),
    }
}
