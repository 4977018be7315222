//! `bmod why`: a run that keeps quiet but for how its solves ended, and explains that.

use std::path::Path;

use super::args::WhyArgs;
use super::commands::{Status, Task, carry_out, name, options, write_report};
use super::host::Output;
use crate::report::summary;
use crate::run::Options;
use crate::session;

/// Carries out `bmod why`; its exit status.
pub(super) fn why(a: &WhyArgs) -> Status {
    let options = Options {
        why: true,
        quiet: true,
        collect: a.json.is_some(),
        ..options(&a.solve)?
    };
    // The model's own output and files are not wanted here.
    let task = Task {
        json: a.json.as_deref(),
        ..Task::new(&a.model, Output::Quiet)
    };
    let finished = carry_out(task, options, &mut |_| {});
    let status = finished.end.exit();
    if a.json.as_deref() != Some(Path::new("-")) {
        Output::Standard.write(&text(&finished));
    }
    Ok(match &a.json {
        Some(path) => status.max(write_report(finished, &name(&a.model), path)),
        None => status,
    })
}

fn text(finished: &session::Finished) -> String {
    let mut out = String::new();
    for s in &finished.report.solves {
        if s.solver.is_empty() {
            out.push_str(&format!(
                "  {} using {}: not solved; the messages say why\n\n",
                s.model, s.using
            ));
            continue;
        }
        out.push_str(&summary::solve(s, false));
        if s.why.as_ref().is_none_or(|w| w.text.is_empty()) {
            out.push_str("  Nothing is wrong with this solve.\n");
        }
        out.push('\n');
    }
    if finished.report.solves.is_empty() {
        out.push_str("Nothing was solved.\n");
    }
    out
}
