//! What the commands do.

use std::io::IsTerminal;
use std::path::Path;

use super::args::{
    Cli, Color, Command, EXECUTION, ListArgs, MessageFormat, ModelArgs, RunArgs, SolveArgs, USAGE,
    completions, manual,
};
use super::host::{
    ENDS_ITSELF, Output, SystemHost, say, unwritten_output, watch_signals, write_whole,
};
use super::watchdog::{Watch, Watchdog};
use crate::formulation::derived::Kind;
use crate::report::diagnostic::{Diagnostic, json_lines};
use crate::report::diagnostics::{self, Look, columns};
use crate::report::json::{Report, RunStatus};
use crate::run::{ListOptions, Machine, Options};
use crate::session::{self, Finished};
use crate::solve::registry::SOLVERS;
use crate::source::PreprocessOptions;
use crate::source::SourceMap;

/// An exit status; as an error after what is wrong was said.
pub(super) type Status = Result<u8, u8>;

/// Says what is wrong; gives the exit status.
pub(super) fn complain(status: u8, message: impl std::fmt::Display) -> u8 {
    Output::Error.write(&format!("bmod: {message}\n"));
    status
}

/// Carries out a command; its exit status.
pub fn execute(cli: &Cli) -> u8 {
    diagnostics::set_color(match cli.color {
        Color::Auto => None,
        Color::Always => Some(true),
        Color::Never => Some(false),
    });
    // An editor's server ends as the system ends processes.
    if !matches!(cli.command, Command::Lsp { .. }) {
        watch_signals();
    }
    let status = match &cli.command {
        Command::Run(a) => run(a),
        Command::Check(a) => Ok(check(a)),
        Command::Bench(a) => super::bench::bench(a),
        Command::Show(a) => super::show::show(a),
        Command::Dual(a) => super::derive::derive(a, Kind::Dual),
        Command::Kkt(a) => super::derive::derive(a, Kind::Kkt),
        Command::Range(a) => super::range::range(a),
        Command::Explain(a) => super::explain::run(a),
        Command::Report(a) => super::report::report(a),
        Command::Why(a) => super::why::why(a),
        Command::List(a) => Ok(list(a)),
        Command::Gdx(a) => super::gdx::show(a),
        Command::Sweep(a) => super::sweep::sweep(a),
        Command::Watch(a) => super::watch::watch(a),
        Command::New(a) => super::new::new(a),
        Command::Test(a) => super::test::test(a),
        Command::Fmt(a) => Ok(super::fmt::fmt(a)),
        Command::Lsp { stdio: _ } => Ok(super::lsp::lsp()),
        Command::Man { folder } => manual(folder).map(|()| 0).map_err(|e| {
            complain(
                EXECUTION,
                format!("{} cannot be written: {e}", folder.display()),
            )
        }),
        Command::Completions { shell } => {
            Output::Standard.write(&String::from_utf8_lossy(&completions(*shell)));
            Ok(0)
        }
    };
    status.unwrap_or_else(|status| status)
}

fn check(a: &ModelArgs) -> u8 {
    let task = Task {
        check_only: true,
        ..Task::new(a, Output::Standard)
    };
    let finished = carry_out(task, Options::default(), &mut |_| {});
    let silent = finished.end == RunStatus::Ok && finished.diagnostics.is_empty();
    if silent && a.message_format == MessageFormat::Human {
        say!("{}: nothing is wrong", a.file.display());
    }
    finished.end.exit()
}

pub(super) fn name(m: &ModelArgs) -> String {
    m.file.to_string_lossy().into_owned()
}

/// The name of a model's file, without folder and ending.
pub(super) fn stem(m: &ModelArgs) -> std::borrow::Cow<'_, str> {
    m.file.file_stem().unwrap_or_default().to_string_lossy()
}

/// A model to be run or checked.
pub(super) struct Task<'a> {
    pub model: &'a ModelArgs,
    /// Folder for the files that the model writes; without one they are not written.
    pub out: Option<&'a Path>,
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
            out: None,
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
    ENDS_ITSELF.store(true, std::sync::atomic::Ordering::SeqCst);
    let model = task.model;
    let mut host = SystemHost::new(&model.file, task.out, &model.allow_read, task.output)
        .sandbox(model.sandbox);
    let preprocess = preprocess(model, options.max_memory);
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
    tell(&finished.diagnostics, &finished.map, model.message_format);
    finished
}

fn preprocess(model: &ModelArgs, max_memory: Option<usize>) -> PreprocessOptions {
    let extension = model.file.extension();
    PreprocessOptions {
        defines: model.define.clone(),
        warns_of_unused: true,
        slash_comments: extension.is_some_and(|e| e.eq_ignore_ascii_case("blk")),
        max_memory,
        ..PreprocessOptions::default()
    }
}

/// The same for the answers only: what the model prints is not shown.
pub(super) fn carry_out_silently(
    model: &ModelArgs,
    options: Options,
    after: &mut dyn FnMut(&mut Machine),
) -> Finished {
    carry_out(Task::new(model, Output::Quiet), options, after)
}

/// Compiles a model, tells what is wrong with it, and hands it on if nothing is; the exit status.
pub(super) fn compiled(
    model: &ModelArgs,
    f: &mut dyn FnMut(crate::check::Program, &mut dyn crate::host::Host) -> Status,
) -> Status {
    let mut host = SystemHost::new(&model.file, None, &model.allow_read, Output::Quiet);
    let preprocess = preprocess(model, None);
    let (found, map) = match crate::check::compile(&mut host, &name(model), preprocess, &SOLVERS) {
        Err(e) => (vec![e.0], e.1),
        Ok(p) if p.has_errors() => (p.diagnostics, p.map),
        Ok(p) => return f(p, &mut host),
    };
    tell(&found, &map, model.message_format);
    Err(RunStatus::CompilationError.exit())
}

/// Writes diagnostics for the user, or for a program.
fn tell(list: &[crate::diag::Diagnostic], map: &SourceMap, format: MessageFormat) {
    if list.is_empty() {
        return;
    }
    let text = match format {
        MessageFormat::Human => {
            let look = Look::stream(std::io::stderr().is_terminal());
            diagnostics::render(list, map, look) + &diagnostics::count(list) + "\n"
        }
        MessageFormat::Json => json_lines(list, map),
    };
    Output::Error.write(&text);
}

/// Options as the command line has them; Err: the exit status, after what is wrong was said.
pub(super) fn options(a: &SolveArgs) -> Result<Options, u8> {
    let mut options = Options {
        time_limit: a.time_limit.unwrap_or(f64::INFINITY),
        ..Options::default()
    };
    let ignored = options.set(&a.option);
    for name in ignored.map_err(|why| complain(USAGE, format!("--option: {why}")))? {
        eprintln!("bmod: --option {name}: it means nothing here and is passed over");
    }
    Ok(options)
}

fn run(a: &RunArgs) -> Status {
    let json_to_stdout = a.json.as_deref() == Some(Path::new("-"));
    let solution_to_stdout = a.solution.as_deref() == Some(Path::new("-"));
    let (output, is_terminal) = match json_to_stdout || solution_to_stdout {
        true => (Output::Error, std::io::stderr().is_terminal()),
        false => (Output::Standard, std::io::stdout().is_terminal()),
    };
    let options = Options {
        certify: a.certify,
        max_memory: a.max_memory.map(|mb| (mb * 1048576.0) as usize),
        keep_solutions: a.solution.is_some(),
        collect: a.json.is_some(),
        quiet: a.quiet,
        all: a.all,
        color: Look::stream(is_terminal).color,
        line: columns(is_terminal),
        ..options(&a.solve)?
    };
    let file = name(&a.model);
    let mut solutions = None;
    let task = Task {
        out: Some(&a.out),
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
        let Report { files, partial, .. } = &finished.report;
        let mark = |f: &String| match partial.contains(f) {
            true => format!("{f} (partial)"),
            false => f.clone(),
        };
        let files: Vec<String> = files.iter().map(mark).collect();
        output.write(&format!("written: {}\n", files.join(", ")));
    }
    if let (Some(path), Some(text)) = (&a.solution, &solutions) {
        status = status.max(write_to(path, text));
    }
    if let Some(path) = &a.json {
        status = status.max(write_report(finished, &file, path));
    }
    Ok(status)
}

/// Writes a file, or standard output for `-`; a reader that has gone away is no error of ours.
fn write_to(path: &Path, text: &str) -> u8 {
    if path == Path::new("-") {
        Output::Standard.write(text);
        return 0;
    }
    write_file(path, text.as_bytes()).err().unwrap_or(0)
}

/// Writes a file whole or not at all.
pub(super) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), u8> {
    write_whole(path, bytes).map_err(|e| unwritten(path, e))
}

pub(super) fn unwritten(path: &Path, why: impl std::fmt::Display) -> u8 {
    complain(
        EXECUTION,
        format!("{} could not be written: {why}", path.display()),
    )
}

/// Writes the report of a run as JSON; the exit status that follows from that.
pub(super) fn write_report(finished: Finished, file: &str, path: &Path) -> u8 {
    let mut report = Report {
        status: finished.end,
        diagnostics: Diagnostic::all(&finished.diagnostics, &finished.map),
        ..finished.report.of(file)
    };
    if let Some(k) = report
        .diagnostics
        .iter()
        .position(|d| ["E0490", "E0492"].contains(&d.code))
    {
        let left_out = report.shorten();
        report.diagnostics[k].message.push_str(&left_out);
    }
    write_json(&report, path)
}

/// Writes a report as JSON; the exit status.
pub(super) fn write_json(report: &Report, path: &Path) -> u8 {
    write_to(path, &report.to_json())
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
    let status = match super::args::parse(arguments) {
        super::args::Parsed::Exit(status) => status,
        super::args::Parsed::Run(cli) => super::guarded(USAGE, || execute(&cli)),
    };
    match unwritten_output() {
        None => status,
        Some(why) => {
            let message = format!("the output could not be written: {why}");
            complain(status.max(EXECUTION), message)
        }
    }
}
