//! What the commands do.

use std::io::{IsTerminal, Write};
use std::path::Path;

use super::args::{
    Cli, Command, EXECUTION, ListArgs, MessageFormat, ModelArgs, RunArgs, USAGE, completions,
};
use super::host::{Output, SystemHost, watch_ctrl_c};
use crate::report::diagnostics::{self, Look};
use crate::report::json::{Report, RunStatus};
use crate::run::{ListOptions, Options};
use crate::session::{self, Finished};
use crate::source::PreprocessOptions;

/// Carries out a command; its exit status.
pub fn execute(cli: &Cli) -> u8 {
    match &cli.command {
        Command::Run(a) => run(a),
        Command::Check(a) => {
            let mut host = SystemHost::new(
                &a.model.file,
                Path::new("."),
                &a.model.allow_read,
                Output::Standard,
            );
            let finished = session::run(
                &mut host,
                &name(&a.model),
                preprocess(&a.model),
                Options::default(),
                true,
                &mut |_| {},
            );
            tell(&finished, a.model.message_format);
            if finished.end == RunStatus::Ok
                && finished.diagnostics.is_empty()
                && a.model.message_format == MessageFormat::Human
            {
                println!("{}: nothing is wrong", a.model.file.display());
            }
            finished.end.exit()
        }
        Command::Bench(a) => super::bench::bench(a),
        Command::Why(a) => super::why::why(a),
        Command::List(a) => list(a),
        Command::Completions { shell } => {
            let _ = std::io::stdout().write_all(&completions(*shell));
            0
        }
    }
}

pub(super) fn name(m: &ModelArgs) -> String {
    m.file.to_string_lossy().into_owned()
}

pub(super) fn preprocess(m: &ModelArgs) -> PreprocessOptions {
    PreprocessOptions {
        defines: m.define.clone(),
        slash_comments: m
            .file
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("blk")),
    }
}

/// Writes diagnostics for the person, or for a program.
pub(super) fn tell(finished: &Finished, format: MessageFormat) {
    if finished.diagnostics.is_empty() {
        return;
    }
    match format {
        MessageFormat::Human => {
            let look = Look::stream(std::io::stderr().is_terminal());
            eprint!(
                "{}",
                diagnostics::render(&finished.diagnostics, &finished.map, look)
            );
            eprintln!("{}", diagnostics::count(&finished.diagnostics));
        }
        MessageFormat::Json => eprint!(
            "{}",
            diagnostics::json_lines(&finished.diagnostics, &finished.map)
        ),
    }
}

/// Options of the command line, as `option` statements before the first statement would set them.
fn options(a: &RunArgs) -> Options {
    let mut options = Options {
        certify: a.certify,
        max_memory: a.max_memory.map(|mb| (mb * 1048576.0) as usize),
        keep_solutions: a.solution.is_some(),
        collect: a.json.is_some(),
        quiet: a.quiet,
        ..Options::default()
    };
    if let Some(s) = a.time_limit {
        options.time_limit = s;
    }
    options.set(&a.option);
    options
}

fn run(a: &RunArgs) -> u8 {
    watch_ctrl_c();
    let json_to_stdout = a.json.as_deref() == Some(Path::new("-"));
    let output = if json_to_stdout {
        Output::Error
    } else {
        Output::Standard
    };
    let mut host = SystemHost::new(&a.model.file, &a.out, &a.model.allow_read, output);
    let mut options = options(a);
    options.color = Look::stream(if json_to_stdout {
        std::io::stderr().is_terminal()
    } else {
        std::io::stdout().is_terminal()
    })
    .color;
    let file = name(&a.model);
    let mut solutions = None;
    let keep = a.solution.is_some();
    let finished = session::run(
        &mut host,
        &file,
        preprocess(&a.model),
        options,
        false,
        &mut |m| {
            if keep {
                solutions = Some(m.solutions(&file));
            }
        },
    );
    host.finish();
    tell(&finished, a.model.message_format);
    let mut status = finished.end.exit();
    if let Some(path) = &a.solution
        && let Some(text) = &solutions
        && let Err(e) = write_whole(path, text.as_bytes())
    {
        eprintln!("bmod: {} could not be written: {e}", path.display());
        status = status.max(EXECUTION);
    }
    if let Some(path) = &a.json {
        status = status.max(write_report(finished, &file, path));
    }
    status
}

/// Writes the report of a run as JSON; the exit status that follows from that.
pub(super) fn write_report(finished: Finished, file: &str, path: &Path) -> u8 {
    let report = Report {
        status: finished.end,
        diagnostics: finished
            .diagnostics
            .iter()
            .map(|d| diagnostics::json(d, &finished.map))
            .collect(),
        solves: finished.report.solves,
        displays: finished.report.displays,
        files: finished.report.files,
        ..Report::new(file)
    };
    let text = report.to_json();
    if path == Path::new("-") {
        let _ = std::io::stdout().write_all(text.as_bytes());
    } else if let Err(e) = write_whole(path, text.as_bytes()) {
        eprintln!("bmod: {} could not be written: {e}", path.display());
        return EXECUTION;
    }
    0
}

/// Writes a file whole or not at all.
pub(super) fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let folder = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(bytes)?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

fn list(a: &ListArgs) -> u8 {
    watch_ctrl_c();
    let mut host = SystemHost::new(
        &a.model.file,
        Path::new("."),
        &a.model.allow_read,
        Output::Standard,
    );
    let options = Options {
        list: Some(ListOptions {
            limit: a.limit,
            only: a.names.clone(),
        }),
        quiet: true,
        collect: false,
        ..Options::default()
    };
    let finished = session::run(
        &mut host,
        &name(&a.model),
        preprocess(&a.model),
        options,
        false,
        &mut |_| {},
    );
    host.finish();
    tell(&finished, a.model.message_format);
    finished.end.exit()
}

/// Runs the command line: the arguments with the program's name first.
pub fn main(arguments: impl IntoIterator<Item = std::ffi::OsString>) -> u8 {
    match super::args::parse(arguments) {
        super::args::Parsed::Exit(status) => status,
        super::args::Parsed::Run(cli) => super::guarded(USAGE, || execute(&cli)),
    }
}
