//! Options of a run, and what models and files remember.

use crate::check::node::{OptionCode, SymbolId};
use crate::check::option::is_statement_option;
use crate::report::textfile::TextFile;
use crate::solve::OWN_OPTIONS;
use crate::source::{Span, named_constant};
use rustc_hash::FxHashMap;
use std::cell::Cell;

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
    /// `--option K=V` for the solvers: what no `option` statement takes.
    pub solver_options: Vec<(String, String)>,
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
    /// `bmod list`: generate, print rows and columns, do not solve: how many per block.
    pub list: Option<ListOptions>,
    /// Keep a solve, to be looked at when the run is over.
    pub study: Option<super::StudyChoice>,
    /// The statement that runs just now.
    pub at: Cell<Span>,
}

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
            log: false,
            certify: false,
            why: false,
            collect: true,
            keep_solutions: false,
            quiet: false,
            all: false,
            color: false,
            list: None,
            study: None,
            at: Cell::default(),
        }
    }
}

impl Options {
    /// `--option K=V`: what the language knows as an `option` statement before the first statement would
    /// set it, the rest for the solvers.
    pub fn set(&mut self, pairs: &[(String, String)]) {
        for (name, value) in pairs {
            let name = name.to_lowercase();
            if name == "log" {
                self.log = value != "0";
            } else if is_statement_option(&name) || OWN_OPTIONS.contains(&name.as_str()) {
                let number = value.parse().map(OptionCode::Number);
                let value = number.unwrap_or_else(|_| OptionCode::Text(value.as_str().into()));
                self.assign(&name, &value);
            } else {
                self.solver_options.push((name, value.clone()));
            }
        }
    }

    /// What an `option` statement does; `name` in lower case.
    pub fn assign(&mut self, name: &str, value: &OptionCode) {
        let (number, text) = match value {
            OptionCode::Flag => return,
            OptionCode::Number(x) => (Some(*x), None),
            OptionCode::Text(t) => match t.to_lowercase() {
                t if t == "on" || t == "yes" => (Some(1.0), Some(t)),
                t if t == "off" || t == "no" => (Some(0.0), Some(t)),
                t if t == "default" => (None, None),
                t => {
                    let code = named_constant(&format!("{name}.{t}"));
                    (code.and_then(|c| c.parse().ok()), Some(t))
                }
            },
        };
        self.numbers.remove(name);
        self.texts.remove(name);
        self.numbers.extend(number.map(|x| (name.to_string(), x)));
        self.texts.extend(text.map(|t| (name.to_string(), t)));
    }

    /// Options of other solvers, from the command line, and bmod's own, as the `option` statements
    /// left them.
    pub fn for_solvers(&self) -> Vec<(String, String)> {
        let own = OWN_OPTIONS.iter().filter_map(|&name| {
            let text = self.texts.get(name).cloned();
            let value = text.or_else(|| Some(self.number(name)?.to_string()))?;
            Some((name.to_string(), value))
        });
        self.solver_options.iter().cloned().chain(own).collect()
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
    /// What was written and closed before.
    pub closed: String,
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
