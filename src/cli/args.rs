//! The arguments of the command line, and what `clap` does not do by itself: GAMS's
//! `--NAME=VALUE`, and exit status 1 for a wrong command line.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::LazyLock;

use crate::model::option::{self, OptionTable};
use crate::solve::registry::{BACKENDS, OPTION_TABLES};
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum, ValueHint};

/// Exit status: the command line is wrong.
pub const USAGE: u8 = 1;
/// Exit status: the text does not compile.
pub const COMPILE: u8 = 2;
/// Exit status: an execution error or an abort.
pub const EXECUTION: u8 = 3;
/// Exit status: interrupted, as shells say it.
pub const INTERRUPT: u8 = 130;

/// Solve algebraic models written in the GAMS tradition.
#[derive(Parser, Debug, Clone)]
#[command(
    name = "bmod",
    version,
    long_version = LONG_VERSION.as_str(),
    subcommand_required = true,
    arg_required_else_help = true,
    after_help = "Exit status: 0 it ran; 1 the command line is wrong; 2 the text does not compile; \
                  3 an execution error or an abort; 130 it was \
                  interrupted (Ctrl-C, SIGTERM).\nA model that is solved to \"infeasible\" is an \
                  answer, not a failure: 0."
)]
pub struct Cli {
    /// Colours: on a terminal unless `NO_COLOR` is set, always, or never.
    #[arg(
        long,
        global = true,
        value_enum,
        default_value_t,
        hide_possible_values = true,
        value_name = "auto|always|never"
    )]
    pub color: Color,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Subcommand, Debug, Clone)]
pub enum Command {
    /// Runs a model: its assignments, solves, displays and figures.
    Run(RunArgs),
    /// Reports everything that is wrong with a model, without running it.
    Check(ModelArgs),
    /// Runs a model and explains how each solve ended: what contradicts what, what is unbounded, where
    /// the error comes from.
    Why(WhyArgs),
    /// Solves a model in many ways and shows how long each takes and how large its error is.
    Bench(BenchArgs),
    /// Shows a model as formulas: sets, data, variables, objective, equations, bounds. Nothing is run.
    Show(ShowArgs),
    /// Derives the dual of a linear model, with its indices.
    Dual(DeriveArgs),
    /// Derives the optimality conditions of a smooth model, with its indices.
    Kkt(DeriveArgs),
    /// Shows in which intervals the prices and the solution of a linear model hold.
    Range(RangeArgs),
    /// Says in words what a model decides, what its answer is, and what binds.
    Explain(ExplainArgs),
    /// Writes formulas, data, solution, ranges and figures on one page.
    Report(ReportArgs),
    /// Shows the generated rows and columns as readable algebra, with names and numbers.
    List(ListArgs),
    /// Shows what is in a GDX file, the data files of GAMS: all symbols, or the records of one.
    Gdx(GdxArgs),
    /// Runs a model for every combination of values, on several cores or as a job array; what is there is not
    /// repeated.
    ///
    /// `-D NAME=A,B,C` lists values, `-D NAME=FIRST:LAST:STEP` is a range of numbers; NAME is a %NAME% of the text, or a
    /// scalar of the model. With several -D all combinations are run. The status is 0 if all have a row and one of them ran
    /// without an error.
    Sweep(SweepArgs),
    /// Runs a model again at each save of a file in its folder.
    Watch(WatchArgs),
    /// Writes a model to begin with.
    New(NewArgs),
    /// Runs models and compares what they claim in comments: `*= x.l('a') 4`.
    Test(TestArgs),
    /// Lays texts out: indentation, blanks, capitals of keywords. What stands under one another still does; comments stay.
    Fmt(FmtArgs),
    /// Serves editors: what is wrong, hover, completion, definition, rename, layout (language server protocol over standard
    /// input and output).
    Lsp {
        /// Accepted because editors give it: standard input and output are all there is.
        #[arg(long, hide = true)]
        stdio: bool,
    },
    /// Writes the manual pages (`bmod.1`, `bmod-run.1` …) into a folder.
    Man {
        /// The folder.
        #[arg(value_name = "DIR", value_hint = ValueHint::DirPath)]
        folder: PathBuf,
    },
    /// Prints a script that completes bmod's commands in a shell.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
}

/// `bmod gdx`
#[derive(Args, Debug, Clone)]
pub struct GdxArgs {
    /// The file.
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// The symbol whose records are shown.
    #[arg(value_name = "SYMBOL")]
    pub symbol: Option<String>,
    /// As comma-separated values.
    #[arg(long)]
    pub csv: bool,
}

/// Whether there are colours.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Color {
    /// As the terminal and `NO_COLOR` are.
    #[default]
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

/// Arguments of `bmod fmt`.
#[derive(Args, Debug, Clone)]
pub struct FmtArgs {
    /// The files, which are rewritten; - reads standard input and writes standard output.
    #[arg(value_name = "FILE|-", value_hint = ValueHint::FilePath, required = true)]
    pub files: Vec<PathBuf>,
    /// Changes nothing; names the files that would change, and ends with status 1 if there are any.
    #[arg(long)]
    pub check: bool,
}

/// How diagnostics are written.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MessageFormat {
    /// For people: the text with the place marked.
    #[default]
    Human,
    /// For programs: one JSON object per line.
    Json,
}

/// The model and what all commands share.
#[derive(Args, Debug, Clone)]
pub struct ModelArgs {
    /// The model.
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// Sets %NAME% to VALUE, as GAMS's --NAME=VALUE (accepted as well).
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = pair)]
    pub define: Vec<(String, String)>,
    /// The model reads only inside its own folder, the current one, and those of --allow-read.
    #[arg(long)]
    pub sandbox: bool,
    /// A further folder in which files are looked for, and which a model in the sandbox may read.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub allow_read: Vec<PathBuf>,
    /// How diagnostics are written.
    #[arg(long, value_enum, default_value_t)]
    pub message_format: MessageFormat,
}

/// What the commands that solve share.
#[derive(Args, Debug, Clone)]
pub struct SolveArgs {
    /// Sets an option before the first statement, as the statement `option K = V`.
    #[arg(long, value_name = "K=V", value_parser = pair)]
    pub option: Vec<(String, String)>,
    /// Seconds that the run may take (`bench`: one solve).
    #[arg(long, value_name = "S", value_parser = positive)]
    pub time_limit: Option<f64>,
}

/// Arguments of `bmod run`.
#[derive(Args, Debug, Clone)]
pub struct RunArgs {
    /// The model and what all commands share.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Folder for the files that the model writes; nothing is written elsewhere.
    #[arg(long, value_name = "DIR", default_value = ".", value_hint = ValueHint::DirPath)]
    pub out: PathBuf,
    /// Writes the report as JSON; - is standard output, and everything else then goes to standard error.
    #[arg(long, value_name = "FILE|-", value_hint = ValueHint::FilePath)]
    pub json: Option<PathBuf>,
    /// Writes all rows and columns of every solve as JSON, with all digits; - is standard output.
    #[arg(long, value_name = "FILE|-", value_hint = ValueHint::FilePath)]
    pub solution: Option<PathBuf>,
    /// Shows every level and marginal after each solve.
    #[arg(long, conflicts_with = "quiet")]
    pub all: bool,
    /// No summaries and no displays; diagnostics only.
    #[arg(long, short)]
    pub quiet: bool,
    /// How it is solved.
    #[command(flatten)]
    pub solve: SolveArgs,
    /// Memory that the run may take (default: nine tenths of what is free).
    #[arg(long, value_name = "MB", value_parser = positive)]
    pub max_memory: Option<f64>,
    /// Proves an interval for the objective of every lp and mip.
    #[arg(long)]
    pub certify: bool,
}

/// Arguments of `bmod why`.
#[derive(Args, Debug, Clone)]
pub struct WhyArgs {
    /// The model and what all commands share.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Writes the report, with the explanations, as JSON; - is standard output.
    #[arg(long, value_name = "FILE|-", value_hint = ValueHint::FilePath)]
    pub json: Option<PathBuf>,
    /// How it is solved.
    #[command(flatten)]
    pub solve: SolveArgs,
}

/// How formulas are written.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FormulaFormat {
    /// For the terminal.
    #[default]
    Text,
    /// For LaTeX with amsmath.
    Latex,
    /// A page with MathML.
    Html,
}

/// Arguments of `bmod show`.
#[derive(Args, Debug, Clone)]
pub struct ShowArgs {
    /// The model and what all commands share.
    #[command(flatten)]
    pub model: ModelArgs,
    /// The model; without, the one that is solved last.
    #[arg(long = "model", value_name = "M")]
    pub name: Option<String>,
    /// How formulas are written.
    #[arg(long, value_enum, default_value_t)]
    pub format: FormulaFormat,
    /// Runs the model and writes one row of each equation with its numbers, and the coefficients of a small model.
    #[arg(long)]
    pub numbers: bool,
    /// How the model is solved.
    #[command(flatten)]
    pub solve: SolveArgs,
}

/// Which model of a text is meant.
#[derive(Args, Debug, Clone)]
pub struct ChosenArgs {
    /// The model; without, the one that is solved last.
    #[arg(long = "model", value_name = "M")]
    pub name: Option<String>,
    /// The solve whose data and answer are taken, counted from 1; without, the last one.
    #[arg(long = "solve", value_name = "K")]
    pub number: Option<usize>,
}

/// How tables are written.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TableFormat {
    /// For the terminal.
    #[default]
    Text,
    /// Comma-separated values, with all digits.
    Csv,
    /// JSON, with all digits.
    Json,
}

/// Arguments of `bmod range`.
#[derive(Args, Debug, Clone)]
pub struct RangeArgs {
    /// The model and what all commands share.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Rows and columns to look at: a symbol, or one of its members. Without, all.
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
    /// Which model is meant.
    #[command(flatten)]
    pub chosen: ChosenArgs,
    /// How the tables are written.
    #[arg(long, value_enum, default_value_t)]
    pub format: TableFormat,
    /// How the model is solved.
    #[command(flatten)]
    pub solve: SolveArgs,
}

/// Arguments of `bmod explain`.
#[derive(Args, Debug, Clone)]
pub struct ExplainArgs {
    /// The model and what all commands share.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Which model is meant.
    #[command(flatten)]
    pub chosen: ChosenArgs,
    /// How the model is solved.
    #[command(flatten)]
    pub solve: SolveArgs,
}

/// Arguments of `bmod report`.
#[derive(Args, Debug, Clone)]
pub struct ReportArgs {
    /// The model and what all commands share.
    #[command(flatten)]
    pub model: ModelArgs,
    /// The page; it needs no other file.
    #[arg(long, value_name = "OUT.html", value_hint = ValueHint::FilePath)]
    pub html: PathBuf,
    /// Which model is meant.
    #[command(flatten)]
    pub chosen: ChosenArgs,
    /// How the model is solved.
    #[command(flatten)]
    pub solve: SolveArgs,
}

/// Arguments of `bmod dual` and `bmod kkt`.
#[derive(Args, Debug, Clone)]
pub struct DeriveArgs {
    /// The model and what all commands share.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Which model is meant.
    #[command(flatten)]
    pub chosen: ChosenArgs,
    /// How formulas are written.
    #[arg(long, value_enum, default_value_t)]
    pub format: FormulaFormat,
    /// Writes it as a model that runs by itself; - is standard output.
    #[arg(long, value_name = "OUT.blk", value_hint = ValueHint::FilePath)]
    pub as_model: Option<PathBuf>,
    /// The model that is written includes the text instead of its data.
    #[arg(long, requires = "as_model")]
    pub include: bool,
    /// Generates it and compares it entry by entry with the model it comes from.
    #[arg(long)]
    pub check: bool,
    /// How the model is solved.
    #[command(flatten)]
    pub solve: SolveArgs,
}

/// Arguments of `bmod bench`.
#[derive(Args, Debug, Clone)]
pub struct BenchArgs {
    /// The model and what all commands share.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Solves per way; their median time counts.
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub repeat: usize,
    /// Only this solve of the model, counted from 1.
    #[arg(long = "solve", value_name = "K")]
    pub only: Option<usize>,
    /// Writes the table as CSV.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub csv: Option<PathBuf>,
    /// Draws error over time, both logarithmic.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub svg: Option<PathBuf>,
    /// The same as a PNG.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub png: Option<PathBuf>,
    /// How it is solved.
    #[command(flatten)]
    pub solve: SolveArgs,
}

/// Arguments of `bmod list`.
#[derive(Args, Debug, Clone)]
pub struct ListArgs {
    /// The model and what all commands share.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Rows or columns to show: a symbol, or one of its members as it is listed. Without, the first
    /// few of every block.
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
    /// How many of each block are shown.
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub limit: usize,
}

/// Arguments of `bmod sweep`: `-D NAME=FIRST:LAST:STEP` and `-D NAME=A,B` have several values; a name is a `%NAME%` of the
/// text, or a scalar.
#[derive(Args, Debug, Clone)]
pub struct SweepArgs {
    /// The model and what all commands share.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Folder of the results: rows-*.jsonl while they come, results.csv at the end.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: PathBuf,
    /// Runs at the same time.
    #[arg(short, long, value_name = "N", default_value_t = cores(), value_parser = count)]
    pub jobs: usize,
    /// A parameter, variable or equation whose values (levels) become columns.
    #[arg(long, short, value_name = "NAME")]
    pub output: Vec<String>,
    /// How each is solved; the time limit is that of one run.
    #[command(flatten)]
    pub solve: SolveArgs,
    /// Runs only every N-th point, beginning with the K-th.
    #[arg(long, value_name = "K/N", value_parser = part)]
    pub part: Option<(usize, usize)>,
    /// Runs nothing, but writes DIR/sweep.sh, a script for Slurm that does it as an array of so many jobs.
    #[arg(long, value_name = "JOBS", value_parser = count)]
    pub slurm: Option<usize>,
}

/// Arguments of `bmod watch`.
#[derive(Args, Debug, Clone)]
pub struct WatchArgs {
    /// The model.
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// Arguments of `bmod run`.
    #[arg(
        value_name = "ARGUMENT",
        trailing_var_arg = true,
        allow_hyphen_values = true
    )]
    pub arguments: Vec<OsString>,
}

/// What `bmod new` can begin with.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Template {
    /// A linear program with its data in a CSV file.
    #[default]
    Lp,
    /// A nonlinear program with a start and a figure.
    Nlp,
    /// A complementarity problem: an equilibrium of supply and demand.
    Mcp,
    /// A wall of blocks and how it falls.
    Wall,
}

/// Arguments of `bmod new`.
#[derive(Args, Debug, Clone)]
pub struct NewArgs {
    /// Name of the model, with a folder if wanted.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// What it is.
    #[arg(long = "kind", value_enum, default_value_t)]
    pub template: Template,
}

/// Arguments of `bmod test`.
#[derive(Args, Debug, Clone)]
pub struct TestArgs {
    /// Models, and folders of them.
    #[arg(value_name = "FILE|FOLDER", required = true, value_hint = ValueHint::AnyPath)]
    pub paths: Vec<PathBuf>,
    /// Relative tolerance of a claim; below 1 absolute.
    #[arg(long, value_name = "T", default_value_t = super::test::TOLERANCE)]
    pub tolerance: f64,
    /// Sets %NAME% to VALUE in all of them.
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = pair)]
    pub define: Vec<(String, String)>,
    /// How they are solved.
    #[command(flatten)]
    pub solve: SolveArgs,
}

impl TestArgs {
    /// What the runs share; the model is still to be named.
    pub(super) fn model(&self) -> ModelArgs {
        ModelArgs {
            file: PathBuf::new(),
            define: self.define.clone(),
            sandbox: false,
            allow_read: Vec::new(),
            message_format: MessageFormat::Human,
        }
    }
}

fn pair(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_string(), value.to_string()))
        }
        _ => Err("write NAME=VALUE".into()),
    }
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

fn count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n @ 1..=100_000) => Ok(n),
        _ => Err("write a number from 1 on".into()),
    }
}

fn part(text: &str) -> Result<(usize, usize), String> {
    let parts = text.split_once('/');
    let parts = parts.and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    match parts {
        Some((k, n)) if 1 <= k && k <= n => Ok((k, n)),
        _ => Err("write K/N, with K from 1 to N".into()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if v > 0.0 && v.is_finite() => Ok(v),
        _ => Err("write a positive number".into()),
    }
}

/// The version, and the solvers inside with theirs.
static LONG_VERSION: LazyLock<String> = LazyLock::new(|| {
    let mut text = env!("CARGO_PKG_VERSION").to_string();
    text.push_str("\nsolvers:");
    for backend in BACKENDS {
        let (name, what) = (backend.about().name, backend.about().version);
        text.push_str(&format!("\n  {name:<10} {what}"));
    }
    text
});

/// What became of the arguments.
#[derive(Debug)]
pub enum Parsed {
    /// A command.
    Run(Box<Cli>),
    /// Nothing to do but to end with this status: help was printed, or what is wrong.
    Exit(u8),
}

/// Reads the arguments (the program's name first) and prints help or usage errors itself.
pub fn parse(arguments: impl IntoIterator<Item = OsString>) -> Parsed {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    if let [_, help, options, backend @ ..] = &arguments[..]
        && help == "help"
        && options == "options"
    {
        return solver_options(backend.first().and_then(|b| b.to_str()));
    }
    match Cli::try_parse_from(accept_gams(arguments)) {
        Ok(cli) => Parsed::Run(Box::new(cli)),
        Err(e) => {
            use clap::error::{ContextKind, ContextValue};
            match e.get(ContextKind::InvalidSubcommand) {
                Some(ContextValue::String(file)) if file.contains('.') => {
                    eprintln!("bmod: `{file}` is no command; `bmod run {file}` runs a model");
                }
                // A reader that has gone away is no error of ours.
                _ => e.print().unwrap_or_default(),
            }
            Parsed::Exit(if e.use_stderr() { USAGE } else { 0 })
        }
    }
}

/// `bmod help options [BACKEND]`: the options of the solvers.
fn solver_options(backend: Option<&str>) -> Parsed {
    let of = |t: &&OptionTable| backend.is_none_or(|b| t.backend.eq_ignore_ascii_case(b));
    let tables: Vec<&OptionTable> = OPTION_TABLES.iter().copied().filter(of).collect();
    if tables.is_empty() {
        let names: Vec<&str> = OPTION_TABLES.iter().map(|t| t.backend).collect();
        eprintln!("bmod: there are options of {}", names.join(", "));
        return Parsed::Exit(USAGE);
    }
    // A reader that has gone away is no error of ours.
    super::host::Output::Standard.write(&option::text(&tables, backend.is_some()));
    Parsed::Exit(0)
}

/// GAMS's own `key=value` arguments that say how its log, its listing and its processes look: nothing here to set.
#[rustfmt::skip]
const GAMS_KEYS: &[&str] = &[
    "lo", "logoption", "o", "output", "pw", "pagewidth", "ps", "pagesize", "lf", "logfile", "gdx",
    "scrdir", "curdir", "idir", "ll", "loglevel", "suppress", "appendlog", "appendout", "errmsg",
    "license", "procdir", "ide", "profile", "stepsum",
];

/// What GAMS's `key=value` on the command line means here: an option of the run (`reslim=5`), a definition (`user1=x`), or
/// nothing (`lo=3`). None: it is no such argument.
fn gams_argument(text: &str) -> Option<Option<[OsString; 2]>> {
    let (key, value) = text.trim_start_matches('-').split_once('=')?;
    let key = key.to_lowercase();
    if GAMS_KEYS.contains(&key.as_str()) {
        return Some(None);
    }
    let is_option = crate::model::language::is_option(&key);
    let pair = OsString::from(format!("{key}={value}"));
    is_option.then(|| Some(["--option".into(), pair]))
}

/// Turns GAMS's `--NAME=VALUE` into `-D NAME=VALUE` wherever NAME is no option of the command.
fn accept_gams(mut arguments: Vec<OsString>) -> Vec<OsString> {
    let command = Cli::command();
    let chosen = arguments.get(1).and_then(|a| a.to_str());
    let Some(sub) = chosen.and_then(|name| command.find_subcommand(name)) else {
        return arguments;
    };
    let known: Vec<&str> = sub.get_arguments().filter_map(|a| a.get_long()).collect();
    let takes_value = |argument: &OsString| {
        let text = argument.to_str().unwrap_or_default();
        let is_it = |a: &&clap::Arg| {
            a.get_long()
                .is_some_and(|l| text.strip_prefix("--") == Some(l))
                || a.get_short().is_some_and(|s| text == format!("-{s}"))
        };
        sub.get_arguments()
            .find(is_it)
            .is_some_and(|a| a.get_action().takes_values())
    };
    let solves = known.contains(&"option");
    let mut k = 2;
    while k < arguments.len() && arguments[k] != "--" {
        let text = arguments[k].to_str();
        if let Some(meant) = text
            .filter(|t| !t.starts_with("--"))
            .and_then(gams_argument)
            && !takes_value(&arguments[k - 1])
        {
            let meant: Vec<OsString> = meant.filter(|_| solves).into_iter().flatten().collect();
            let count = meant.len();
            arguments.splice(k..=k, meant);
            k += count;
            continue;
        }
        let text = text.and_then(|t| t.strip_prefix("--"));
        if let Some((name, _)) = text.and_then(|t| t.split_once('='))
            && !name.is_empty()
            && !known.contains(&name)
            && name != "help"
        {
            let value = OsString::from(text.unwrap_or_default());
            arguments.splice(k..=k, ["-D".into(), value]);
            k += 1;
        }
        k += 1;
    }
    arguments
}

/// Writes a manual page for bmod and one for each command into a folder.
///
/// # Errors
/// If they cannot be written.
pub fn manual(folder: &std::path::Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    clap_mangen::generate_to(Cli::command(), folder)
}

/// The completion script for a shell.
pub fn completions(shell: clap_complete::Shell) -> Vec<u8> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "bmod", &mut script);
    script
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
        assert!(!completions(clap_complete::Shell::Bash).is_empty());
    }

    #[test]
    fn versions_are_those_of_the_lock_file() {
        let lock = include_str!("../../Cargo.lock").to_lowercase();
        let mut count = 0;
        for what in BACKENDS.iter().map(|b| b.about().version) {
            let words: Vec<String> = what.split([' ', ',']).map(str::to_lowercase).collect();
            let numbered = |w: &&[String]| w[1].starts_with(|c: char| c.is_ascii_digit());
            for w in words.windows(2).filter(numbered) {
                let name = w[0].replace("pounce", "pounce-algorithm");
                let entry = format!("name = \"{name}\"\nversion = \"{}", w[1]);
                assert!(lock.contains(&entry), "{what}: {entry}");
                count += 1;
            }
        }
        assert!(count >= 4, "{count} versions");
    }

    #[test]
    fn wrong_command_lines_end_with_1() {
        for line in [
            "bmod",
            "bmod walk w.blk",
            "bmod run",
            "bmod run w.blk --nonsense",
            "bmod run w.blk -D x",
            "bmod run w.blk --time-limit -3",
            "bmod run w.blk --time-limit x",
            "bmod check w.blk --out x",
            "bmod completions fishy",
        ] {
            let parsed = parse(line.split(' ').map(OsString::from));
            assert!(matches!(parsed, Parsed::Exit(USAGE)), "{line}: {parsed:?}");
        }
        for line in [
            "bmod --help",
            "bmod help run",
            "bmod --version",
            "bmod run --help",
        ] {
            let parsed = parse(line.split(' ').map(OsString::from));
            assert!(matches!(parsed, Parsed::Exit(0)), "{line}: {parsed:?}");
        }
    }
}
