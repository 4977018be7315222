//! What the commands do.

use std::io::{IsTerminal, Write};
use std::path::Path;

use super::args::{
    Cli, Color, Command, EXECUTION, ListArgs, MessageFormat, ModelArgs, RunArgs, SolveArgs, USAGE,
    completions, manual,
};
use super::host::{Output, SystemHost, watch_ctrl_c, write_whole};
use super::watchdog::{Watch, Watchdog};
use crate::formulation::derived::Kind;
use crate::report::diagnostic::{Diagnostic, json_lines};
use crate::report::diagnostics::{self, Look};
use crate::report::json::{Report, RunStatus};
use crate::run::{ListOptions, Machine, Options};
use crate::session::{self, Finished};
use crate::solve::registry::SOLVERS;
use crate::source::PreprocessOptions;

/// Carries out a command; its exit status.
pub fn execute(cli: &Cli) -> u8 {
    diagnostics::set_color(match cli.color {
        Color::Auto => None,
        Color::Always => Some(true),
        Color::Never => Some(false),
    });
    match &cli.command {
        Command::Run(a) => run(a),
        Command::Check(a) => {
            let task = Task {
                check_only: true,
                ..Task::new(&a.model, Output::Standard)
            };
            let finished = carry_out(task, Options::default(), &mut |_| {});
            if finished.end == RunStatus::Ok
                && finished.diagnostics.is_empty()
                && a.model.message_format == MessageFormat::Human
            {
                println!("{}: nothing is wrong", a.model.file.display());
            }
            finished.end.exit()
        }
        Command::Bench(a) => super::bench::bench(a),
        Command::Show(a) => super::show::show(a),
        Command::Dual(a) => super::derive::derive(a, Kind::Dual),
        Command::Kkt(a) => super::derive::derive(a, Kind::Kkt),
        Command::Range(a) => super::range::range(a),
        Command::Explain(a) => super::explain::run(a),
        Command::Report(a) => super::report::report(a),
        Command::Why(a) => super::why::why(a),
        Command::List(a) => list(a),
        Command::Gdx(a) => super::gdx::show(a),
        Command::Sweep(a) => super::sweep::sweep(a),
        Command::Watch(a) => super::watch::watch(a),
        Command::New(a) => super::new::new(a),
        Command::Test(a) => super::test::test(a),
        Command::Fmt(a) => super::fmt::fmt(a),
        Command::Lsp { stdio: _ } => super::lsp::lsp(),
        Command::Man { folder } => match manual(folder) {
            Ok(()) => 0,
            Err(e) => {
                eprintln!("bmod: {} cannot be written: {e}", folder.display());
                EXECUTION
            }
        },
        Command::Completions { shell } => {
            let _ = std::io::stdout().write_all(&completions(*shell));
            0
        }
    }
}

pub(super) fn name(m: &ModelArgs) -> String {
    m.file.to_string_lossy().into_owned()
}

/// A model to be run or checked.
pub(super) struct Task<'a> {
    pub model: &'a ModelArgs,
    /// Folder for the files that the model writes.
    pub out: &'a Path,
    /// Where what it prints goes.
    pub output: Output,
    /// Nothing is carried out.
    pub check_only: bool,
    /// Where the report goes should a limit end the process.
    pub json: Option<&'a Path>,
}

impl<'a> Task<'a> {
    pub(super) fn new(model: &'a ModelArgs, output: Output) -> Self {
        Self {
            model,
            out: Path::new("."),
            output,
            check_only: false,
            json: None,
        }
    }
}

/// Runs a model as the arguments say, and tells what is wrong with it; `after` sees the machine at the
/// end.
pub(super) fn carry_out(
    task: Task,
    options: Options,
    after: &mut dyn FnMut(&mut Machine),
) -> Finished {
    watch_ctrl_c();
    let model = task.model;
    let mut host = SystemHost::new(&model.file, task.out, &model.allow_read, task.output)
        .sandbox(model.sandbox);
    let extension = model.file.extension();
    let preprocess = PreprocessOptions {
        defines: model.define.clone(),
        slash_comments: extension.is_some_and(|e| e.eq_ignore_ascii_case("blk")),
        max_memory: options.max_memory,
        ..PreprocessOptions::default()
    };
    let file = name(model);
    let watchdog = Watchdog::new(Watch {
        time_limit: options.time_limit,
        max_memory: options.max_memory.or_else(crate::system::available_memory),
        report: options.report.clone(),
        file: file.clone(),
        json: task.json.map(Path::to_path_buf),
        output: task.output,
    });
    let finished = session::run(
        &mut host,
        &file,
        preprocess,
        options,
        task.check_only,
        after,
    );
    drop(watchdog);
    host.finish();
    tell(&finished, model.message_format);
    finished
}

/// The same for the answers only: what the model prints and writes is not kept.
pub(super) fn carry_out_silently(
    model: &ModelArgs,
    options: Options,
    after: &mut dyn FnMut(&mut Machine),
) -> Result<Finished, u8> {
    let Ok(out) = tempfile::tempdir() else {
        eprintln!("bmod: no folder for temporary files");
        return Err(EXECUTION);
    };
    let task = Task {
        out: out.path(),
        ..Task::new(model, Output::Quiet)
    };
    Ok(carry_out(task, options, after))
}

/// Compiles a model, tells what is wrong with it, and hands it on if nothing is; the exit status.
pub(super) fn compiled(
    model: &ModelArgs,
    f: &mut dyn FnMut(crate::check::Program, &mut dyn crate::host::Host) -> u8,
) -> u8 {
    let mut host = SystemHost::new(
        &model.file,
        Path::new("."),
        &model.allow_read,
        Output::Quiet,
    );
    let extension = model.file.extension();
    let preprocess = PreprocessOptions {
        defines: model.define.clone(),
        slash_comments: extension.is_some_and(|e| e.eq_ignore_ascii_case("blk")),
        ..PreprocessOptions::default()
    };
    let (diagnostics, map, program) =
        match crate::check::compile(&mut host, &name(model), preprocess, &SOLVERS) {
            Err(e) => (vec![e.0], e.1, None),
            Ok(mut p) => {
                let found = std::mem::take(&mut p.diagnostics);
                match found
                    .iter()
                    .any(|d| d.severity == crate::diag::Severity::Error)
                {
                    true => (found, p.map, None),
                    false => (Vec::new(), crate::source::SourceMap::default(), Some(p)),
                }
            }
        };
    let Some(program) = program else {
        let finished = Finished {
            end: RunStatus::CompilationError,
            report: Report::default(),
            diagnostics,
            map,
        };
        tell(&finished, model.message_format);
        return finished.end.exit();
    };
    f(program, &mut host)
}

/// Writes diagnostics for the user, or for a program.
fn tell(finished: &Finished, format: MessageFormat) {
    if finished.diagnostics.is_empty() {
        return;
    }
    let Finished {
        diagnostics: list,
        map,
        ..
    } = finished;
    let text = match format {
        MessageFormat::Human => {
            let look = Look::stream(std::io::stderr().is_terminal());
            diagnostics::render(list, map, look) + &diagnostics::count(list) + "\n"
        }
        MessageFormat::Json => json_lines(list, map),
    };
    // Who reads may have gone: `bmod check m.blk 2>&1 | head`.
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// Options as the command line has them; Err: the exit status, after what is wrong was said.
pub(super) fn options(a: &SolveArgs) -> Result<Options, u8> {
    let mut options = Options {
        time_limit: a.time_limit.unwrap_or(f64::INFINITY),
        ..Options::default()
    };
    match options.set(&a.option) {
        Ok(ignored) => {
            for name in ignored {
                eprintln!("bmod: --option {name}: it means nothing here and is passed over");
            }
            Ok(options)
        }
        Err(message) => {
            eprintln!("bmod: --option: {message}");
            Err(USAGE)
        }
    }
}

fn run(a: &RunArgs) -> u8 {
    let json_to_stdout = a.json.as_deref() == Some(Path::new("-"));
    let solution_to_stdout = a.solution.as_deref() == Some(Path::new("-"));
    let (output, is_terminal) = match json_to_stdout || solution_to_stdout {
        true => (Output::Error, std::io::stderr().is_terminal()),
        false => (Output::Standard, std::io::stdout().is_terminal()),
    };
    let base = match options(&a.solve) {
        Ok(o) => o,
        Err(status) => return status,
    };
    let options = Options {
        certify: a.certify,
        max_memory: a.max_memory.map(|mb| (mb * 1048576.0) as usize),
        keep_solutions: a.solution.is_some(),
        collect: a.json.is_some(),
        quiet: a.quiet,
        all: a.all,
        color: Look::stream(is_terminal).color,
        ..base
    };
    let file = name(&a.model);
    let mut solutions = None;
    let task = Task {
        out: &a.out,
        json: a.json.as_deref(),
        ..Task::new(&a.model, output)
    };
    let finished = carry_out(task, options, &mut |m| {
        if a.solution.is_some() {
            solutions = Some(m.solutions(&file));
        }
    });
    let mut status = finished.end.exit();
    if !a.quiet && !finished.report.files.is_empty() {
        let line = format!("written: {}\n", finished.report.files.join(", "));
        let _ = match output {
            Output::Error => std::io::stderr().write_all(line.as_bytes()),
            _ => std::io::stdout().write_all(line.as_bytes()),
        };
    }
    if let Some(path) = &a.solution
        && let Some(text) = &solutions
        && let Err(e) = write_to(path, text.as_bytes())
    {
        eprintln!("bmod: {} could not be written: {e}", path.display());
        status = status.max(EXECUTION);
    }
    if let Some(path) = &a.json {
        status = status.max(write_report(finished, &file, path));
    }
    status
}

/// Writes a file, or standard output for `-`; a reader that has gone away is no error of ours.
fn write_to(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if path == Path::new("-") {
        let _ = std::io::stdout().write_all(bytes);
        return Ok(());
    }
    write_whole(path, bytes)
}

/// Writes the report of a run as JSON; the exit status that follows from that.
pub(super) fn write_report(finished: Finished, file: &str, path: &Path) -> u8 {
    let mut report = Report {
        status: finished.end,
        diagnostics: Diagnostic::all(&finished.diagnostics, &finished.map),
        solves: finished.report.solves,
        displays: finished.report.displays,
        files: finished.report.files,
        ..Report::new(file)
    };
    if let Some(k) = report.diagnostics.iter().position(|d| d.code == "E0490") {
        let left_out = report.shorten();
        report.diagnostics[k].message.push_str(&left_out);
    }
    write_json(&report, path)
}

/// Writes a report as JSON, whole or not at all.
pub(super) fn write_json(report: &Report, path: &Path) -> u8 {
    let text = report.to_json();
    if let Err(e) = write_to(path, text.as_bytes()) {
        eprintln!("bmod: {} could not be written: {e}", path.display());
        return EXECUTION;
    }
    0
}

fn list(a: &ListArgs) -> u8 {
    let options = Options {
        list: Some(ListOptions {
            limit: a.limit,
            only: a.names.clone(),
        }),
        quiet: true,
        collect: false,
        ..Options::default()
    };
    let task = Task::new(&a.model, Output::Standard);
    carry_out(task, options, &mut |_| {}).end.exit()
}

/// Runs the command line: the arguments with the program's name first.
pub fn main(arguments: impl IntoIterator<Item = std::ffi::OsString>) -> u8 {
    match super::args::parse(arguments) {
        super::args::Parsed::Exit(status) => status,
        super::args::Parsed::Run(cli) => super::guarded(USAGE, || execute(&cli)),
    }
}
