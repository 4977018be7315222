//! Checks models without running them and lists what is wrong, one line per mistake, as editors read it.
//!
//!     cargo run --example check -- models/*.blk

use bmod::{Error, Model, Severity};
use std::process::ExitCode;

fn main() -> Result<ExitCode, Error> {
    let mut wrong = 0;
    for path in std::env::args().skip(1) {
        let run = Model::from_file(&path)?.check();
        for d in run.diagnostics() {
            let kind = match d.severity {
                Severity::Warning => "warning",
                _ => "error",
            };
            let at = d.place.as_ref().map_or_else(
                || path.clone(),
                |p| format!("{}:{}:{}", p.file, p.line, p.column),
            );
            println!("{at}: {kind} {}: {}", d.code, d.message);
            if let Some(help) = &d.help {
                println!("    {help}");
            }
            wrong += usize::from(d.severity != Severity::Warning);
        }
        println!("{path}: {} symbols", run.symbols().count());
    }
    Ok(match wrong {
        0 => ExitCode::SUCCESS,
        _ => ExitCode::from(2),
    })
}
