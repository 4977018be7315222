//! `bmod test`: runs models and compares what they claim in their comments, `*= x.l('a') 4`.

use std::path::{Path, PathBuf};

use super::args::{EXECUTION, INTERRUPT, ModelArgs, TestArgs, USAGE};
use super::commands::{Status, carry_out_silently, complain, options};
use super::host::say;
use crate::claims::{broken, claims};
use crate::run::Options;

/// Relative tolerance of a claim, unless the command line says another.
pub const TOLERANCE: f64 = 1e-6;

/// Carries out `bmod test`; 0 if every claim of every model holds.
pub(super) fn test(a: &TestArgs) -> Status {
    let mut models = Vec::new();
    for path in &a.paths {
        collect(path, &mut models)
            .map_err(|e| complain(USAGE, format!("{}: {e}", path.display())))?;
    }
    let (mut passed, mut failed, mut silent) = (0, 0, 0);
    for path in models {
        let Ok(text) = std::fs::read_to_string(&path) else {
            continue;
        };
        let claims = claims(&text);
        if claims.is_empty() {
            silent += 1;
            continue;
        }
        let model = ModelArgs {
            file: path.clone(),
            ..a.model()
        };
        let options = Options {
            quiet: true,
            collect: false,
            ..options(&a.solve)?
        };
        let mut wrong = Vec::new();
        let status = carry_out_silently(&model, options, &mut |m| {
            for (claim, is) in broken(m, &claims, a.tolerance) {
                let (line, what, value) = (claim.line, &claim.what, &claim.value);
                wrong.push(format!("  line {line}: {what} is {is}, not {value}"));
            }
        })
        .end
        .exit();
        if status == INTERRUPT {
            return Ok(status);
        }
        let (word, count) = match status == 0 && wrong.is_empty() {
            true => ("ok    ", &mut passed),
            false => ("FAILED", &mut failed),
        };
        *count += 1;
        say!("{word}  {}", path.display());
        wrong.iter().for_each(|w| say!("{w}"));
    }
    say!("{passed} passed, {failed} failed");
    if silent > 0 {
        say!("{silent} without claims");
    }
    Ok(if failed > 0 { EXECUTION } else { 0 })
}

/// The models of a folder and the folders in it, or a model.
fn collect(path: &Path, out: &mut Vec<PathBuf>) -> std::io::Result<()> {
    if !path.is_dir() {
        path.metadata()?;
        out.push(path.to_path_buf());
        return Ok(());
    }
    let mut entries: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(path)? {
        entries.push(entry?.path());
    }
    entries.sort();
    for entry in entries {
        let is_model = entry
            .extension()
            .is_some_and(|e| ["blk", "gms"].iter().any(|m| e.eq_ignore_ascii_case(m)));
        if entry.is_dir() || is_model {
            collect(&entry, out)?;
        }
    }
    Ok(())
}
