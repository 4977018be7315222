//! What a dual costs: symbols do not grow with the data, and the comparison takes about as long as generating twice, and what
//! reading the derived text takes (2.6 million instructions, a millisecond), which does not grow either.
//! `cargo bench --bench derivation`
//!
//! Medians of interleaved runs, in milliseconds of processor time, for a wall of n courses of n blocks.

use bmod::cli::host::{Output, SystemHost};
use bmod::formulation::{Scope, check, dual, study};
use bmod::run::{Options, StudyChoice};
use bmod::session;
use bmod::source::PreprocessOptions;
use std::path::Path;

const SIZES: [usize; 3] = [2, 10, 40];
const RUNS: usize = 5;

/// Nanoseconds that this thread has had a processor.
fn processor() -> f64 {
    // The kernel counts when a thread is put aside.
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    let first = text.split_whitespace().next().expect("three numbers");
    first.parse().expect("a number")
}

/// Milliseconds of generating the model, deriving the dual, and deriving and comparing it; nonzeros.
fn wall(n: usize) -> ([f64; 3], usize) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = root.join("benches/models/wall.blk");
    let mut host = SystemHost::new(&path, None, &[root.into()], Output::Quiet);
    let options = Options {
        quiet: true,
        collect: false,
        study: Some(StudyChoice {
            generate_only: true,
            ..StudyChoice::default()
        }),
        ..Options::default()
    };
    let preprocess = PreprocessOptions {
        defines: vec![
            ("courses".into(), n.to_string()),
            ("blocks".into(), n.to_string()),
        ],
        slash_comments: true,
        ..PreprocessOptions::default()
    };
    let mut out = ([0.0; 3], 0);
    let file = path.to_string_lossy();
    session::run(&mut host, &file, preprocess, options, false, &mut |m| {
        let mut times = vec![processor()];
        let (primal, _) = study::primal(m).expect("it is generated");
        times.push(processor());
        dual::dual(Scope::of(m), &primal, false).expect("a dual");
        times.push(processor());
        let (_, c) = check::checked_dual(Scope::of(m), &primal).expect("a dual");
        times.push(processor());
        assert!(c.passed(), "{:?}", c.differences);
        let spent = |k: usize| (times[k + 1] - times[k]) / 1e6;
        out = ([spent(0), spent(1), spent(2)], c.entries);
    });
    out
}

fn main() {
    let mut runs = SIZES.map(|_| Vec::new());
    for _ in 0..RUNS {
        for (n, runs) in SIZES.iter().zip(&mut runs) {
            runs.push(wall(*n));
        }
    }
    println!("wall    entries  generate    derive     check  check/generate");
    for (n, runs) in SIZES.iter().zip(&mut runs) {
        let median = |k: usize| {
            let mut all: Vec<f64> = runs.iter().map(|r| r.0[k]).collect();
            all.sort_by(f64::total_cmp);
            all[RUNS / 2]
        };
        let (generate, derive, check) = (median(0), median(1), median(2));
        println!(
            "{n:>2} × {n:<2} {:>8} {generate:>9.3} {derive:>9.3} {check:>9.3} {:>15.2}",
            runs[0].1,
            check / generate
        );
    }
}
