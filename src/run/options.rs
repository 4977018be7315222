//! Options of a run, and what models and files remember.

use super::random::Random;
use crate::check::node::SymbolId;
use crate::model::language::is_option;
use crate::model::option::{Accepted, Refused, switch};
use crate::model::outcome::Basis;
use crate::report::json::SharedReport;
use crate::report::textfile::TextFile;
use crate::solve::registry::SOLVERS;
use crate::source::{Span, named_constant};
use rustc_hash::FxHashMap;
use std::cell::Cell;
use std::sync::Arc;

/// Options of a run: from the command line, and from `option` statements.
#[derive(Clone, Debug)]
pub struct Options {
    /// Seconds for the whole run.
    pub time_limit: f64,
    /// Bytes for the whole run.
    pub max_memory: Option<usize>,
    /// Solver by problem type (`lp` → `clarabel`), and every other text option, lower case.
    pub texts: FxHashMap<String, String>,
    /// Numeric options, lower case.
    pub numbers: FxHashMap<String, f64>,
    /// Options of solvers, from `--option K=V` and from `option` statements; what was said last counts.
    pub solver_options: Vec<(String, String)>,
    /// What is wrong with an option that was asked for from outside: the run does not begin.
    pub refused: Option<String>,
    /// `--option log=1`: print the solver's log.
    pub log: bool,
    /// `--certify`
    pub certify: bool,
    /// `bmod why`: explain how each solve ended.
    pub why: bool,
    /// Keep displays for the JSON report.
    pub collect: bool,
    /// Keep instances and solutions for `--solution`.
    pub keep_solutions: bool,
    /// Do not print displays and summaries.
    pub quiet: bool,
    /// After a solve show every level and marginal, also where the text displays something.
    pub all: bool,
    /// Summaries in colour.
    pub color: bool,
    /// Characters on a line of a display, where it is read on a screen.
    pub line: Option<usize>,
    /// `bmod list`: generate, print rows and columns, do not solve: how many per block.
    pub list: Option<ListOptions>,
    /// Keep a solve, to be looked at when the run is over.
    pub study: Option<super::StudyChoice>,
    /// What the run reports, while it does.
    pub report: SharedReport,
    /// The statement that runs just now.
    pub at: Cell<Span>,
    /// Where earlier solves of each model ended; the next one starts there.
    pub bases: Bases,
}

/// By model: the basis of its last solve as a linear program.
pub type Bases = FxHashMap<SymbolId, Arc<Basis>>;

/// What `bmod list` prints.
#[derive(Clone, Debug)]
pub struct ListOptions {
    /// Rows and columns per block.
    pub limit: usize,
    /// Only these symbols or records (empty: all).
    pub only: Vec<String>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            time_limit: f64::INFINITY,
            max_memory: None,
            texts: FxHashMap::default(),
            numbers: FxHashMap::default(),
            solver_options: Vec::new(),
            refused: None,
            log: false,
            certify: false,
            why: false,
            collect: true,
            keep_solutions: false,
            quiet: false,
            all: false,
            color: false,
            line: None,
            list: None,
            study: None,
            report: SharedReport::default(),
            at: Cell::default(),
            bases: Bases::default(),
        }
    }
}

impl Options {
    /// `--option K=V`, as the statement `option K = V` before the first statement would set it. Gives those that mean
    /// nothing here; Err: what is wrong with one of them, in a sentence.
    pub fn set(&mut self, pairs: &[(String, String)]) -> Result<Vec<String>, String> {
        let mut ignored = Vec::new();
        for (name, value) in pairs {
            let name = name.to_lowercase();
            match SOLVERS.check(&name, value) {
                Ok(Accepted::Taken) => self.assign(&name, value),
                Ok(Accepted::Ignored) => ignored.push(format!("{name}={value}")),
                Err(refused) => {
                    let (message, help) = refused.words(&name, value);
                    return Err(match (help, refused) {
                        (Some(help), _) => format!("{message}; {help}"),
                        (None, Refused::Unknown(_)) => {
                            format!("{message}; `bmod help options` lists them")
                        }
                        (None, _) => message,
                    });
                }
            }
        }
        Ok(ignored)
    }

    /// What an `option` statement does; `name` in lower case.
    pub fn assign(&mut self, name: &str, value: &str) {
        self.numbers.remove(name);
        self.texts.remove(name);
        self.solver_options.retain(|(k, _)| k != name);
        let is_default = value.eq_ignore_ascii_case("default");
        if name == "log" {
            self.log = switch(value).unwrap_or(false);
        }
        if is_default {
            return;
        }
        if !is_option(name) {
            self.solver_options
                .push((name.to_string(), value.to_string()));
            return;
        }
        let value = value.to_lowercase();
        let code = || Some(named_constant(&format!("{name}.{value}"))? as f64);
        let number = value.parse().ok().or_else(|| match value.as_str() {
            "silent" => Some(2.0),
            word => switch(word).map(f64::from).or_else(code),
        });
        self.numbers.extend(number.map(|x| (name.to_string(), x)));
        self.texts.insert(name.to_string(), value);
    }

    /// Where random numbers begin.
    pub(super) fn random(&self) -> Random {
        self.number("seed")
            .map_or_else(Random::default, |s| Random::new(s as i64))
    }

    /// `option gams_power = on`: `x**y` is exp(y·log x), with its rounding, as GAMS computes it.
    pub fn gams_power(&self) -> bool {
        self.number("gams_power") == Some(1.0)
    }

    /// A numeric option.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.numbers.get(name).copied()
    }
}

/// What a model remembers.
#[derive(Clone, Debug, Default)]
pub struct ModelState {
    /// Attributes that were assigned, and results of the last solve.
    pub attributes: FxHashMap<&'static str, f64>,
}

impl ModelState {
    /// An attribute, if it was set.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.attributes.get(name).copied()
    }
}

/// The files of `put`.
#[derive(Clone, Debug, Default)]
pub struct PutState {
    /// The files that were named so far, by symbol.
    pub files: FxHashMap<SymbolId, PutFile>,
    /// The file that `put` writes to.
    pub current: Option<SymbolId>,
}

/// A file of `put`.
#[derive(Clone, Debug, Default)]
pub struct PutFile {
    /// What is being written, and the attributes.
    pub text: TextFile,
    /// Its name since `put_utility 'ren'`.
    pub name: Option<String>,
    /// What is written comes behind what the run has written into the file before (`.ap`).
    pub appends: bool,
    /// Selected since it was last closed.
    pub open: bool,
    /// The last statement that wrote to it.
    pub span: Span,
    /// Column and row at the beginning of the statement that runs: what `.cc` and `.cr` are in it.
    pub cursor: Option<(f64, f64)>,
}

impl PutFile {
    /// An attribute.
    pub fn attribute(&self, a: &str) -> f64 {
        match (a, self.cursor) {
            ("cc", Some((column, _))) => column,
            ("cr", Some((_, row))) => row,
            _ => self.text.get(a),
        }
    }

    /// Keeps the cursor as it is now, until the statement ends.
    pub fn hold_cursor(&mut self) {
        self.cursor = Some((self.text.get("cc"), self.text.get("cr")));
    }
}
