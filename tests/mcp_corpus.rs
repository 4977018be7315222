//! The corpus of complementarity problems (`../shared/corpus/mcp`, or beside the folder BMOD_SHARED
//! names), each file run as it is: all are solved, the seven that PATH stops at included.

use crate::complementarity::{corpus, references, run};

/// Problems whose solutions are singular and degenerate: the residual converges linearly.
const SINGULAR: [&str; 3] = ["rsingdeg0", "rsingdeg1", "rsingdeg2"];

#[test]
fn every_problem_is_solved() {
    let Some(folder) = corpus() else { return };
    let (mut wrong, mut count, mut majors, mut minors) = (Vec::new(), 0, 0, 0);
    for reference in references(&folder) {
        count += 1;
        majors += reference.majors;
        minors += reference.minors + reference.crash;
        let singular = SINGULAR.iter().any(|s| reference.file.contains(s));
        let tolerance = if singular { 1e-6 } else { 1e-8 };
        match run(&folder.join(&reference.file), false) {
            Ok((s, _)) => {
                let residual = s.residual.natural.unwrap_or(f64::INFINITY);
                if s.model_status.code != 1 || residual > tolerance {
                    wrong.push(format!(
                        "{} ({} variables, PATH solves it: {}): {} rows, status {}, residual {residual:e}",
                        reference.file, reference.size, reference.solved, s.rows, s.model_status.code
                    ));
                }
            }
            Err(e) => wrong.push(format!("{}: {e}", reference.file)),
        }
    }
    assert!(
        count >= 100 && majors > 100 && minors > 100,
        "{count} rows in the reference"
    );
    assert!(
        wrong.is_empty(),
        "{} of {count}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}
