//! `bmod why`: a run that keeps quiet but for how its solves ended, and explains that.

use std::path::Path;

use super::args::WhyArgs;
use super::commands::{name, preprocess, tell, write_report};
use super::host::{Output, SystemHost, watch_ctrl_c};
use crate::report::summary;
use crate::run::Options;
use crate::session;

/// Carries out `bmod why`; its exit status.
pub fn why(a: &WhyArgs) -> u8 {
    watch_ctrl_c();
    // The model's own output and files are not wanted here.
    let Ok(out) = tempfile::tempdir() else {
        eprintln!("bmod: no folder for temporary files");
        return super::args::EXECUTION;
    };
    let mut host = SystemHost::new(
        &a.model.file,
        out.path(),
        &a.model.allow_read,
        Output::Quiet,
    );
    let mut options = Options {
        why: true,
        quiet: true,
        collect: a.json.is_some(),
        ..Options::default()
    };
    if let Some(s) = a.time_limit {
        options.time_limit = s;
    }
    options.set(&a.option);
    let file = name(&a.model);
    let finished = session::run(
        &mut host,
        &file,
        preprocess(&a.model),
        options,
        false,
        &mut |_| {},
    );
    host.finish();
    tell(&finished, a.model.message_format);
    let status = finished.end.exit();
    match &a.json {
        Some(path) if path == Path::new("-") => {}
        _ => print!("{}", text(&finished)),
    }
    match &a.json {
        Some(path) => status.max(write_report(finished, &file, path)),
        None => status,
    }
}

fn text(finished: &session::Finished) -> String {
    let mut out = String::new();
    for s in &finished.report.solves {
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
