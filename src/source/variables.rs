//! Compile-time variables: what `%name%` stands for.
//!
//! Three scopes, as in GAMS: `$setLocal` lives in its file, `$set` in its file and the files that it
//! includes, `$setGlobal` everywhere. The innermost wins. Names are compared without regard to case.

use crate::diag::nearest;
use rustc_hash::{FxHashMap, FxHashSet};
use std::cell::RefCell;

/// One level of names.
type Scope = FxHashMap<String, String>;

/// All names, one pair of scopes per open file.
#[derive(Default)]
pub(crate) struct Variables {
    global: Scope,
    /// `(scoped, local)` per open file, the innermost last.
    files: Vec<(Scope, Scope)>,
    /// Names from outside that nothing has asked for yet.
    unused: RefCell<FxHashSet<String>>,
    /// Names that the text has asked for, while there are unused ones.
    asked: RefCell<FxHashSet<String>>,
}

/// The three ways of defining a name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Reach {
    /// `$setLocal`
    Local,
    /// `$set`
    Scoped,
    /// `$setGlobal`
    Global,
}

impl Variables {
    /// A file is opened.
    pub(super) fn enter(&mut self) {
        self.files.push(Default::default());
    }

    /// The innermost file ends: its names are forgotten.
    pub(super) fn leave(&mut self) {
        self.files.pop();
    }

    /// Defines a name.
    pub(super) fn set(&mut self, reach: Reach, name: &str, value: String) {
        let name = name.to_ascii_lowercase();
        match (reach, self.files.last_mut()) {
            (Reach::Local, Some((_, local))) => local.insert(name, value),
            (Reach::Scoped, Some((scoped, _))) => scoped.insert(name, value),
            _ => self.global.insert(name, value),
        };
    }

    /// Defines a name from outside the text.
    pub(super) fn define(&mut self, name: &str, value: String) {
        self.set(Reach::Global, name, value);
        self.unused.get_mut().insert(name.to_ascii_lowercase());
    }

    fn asks(&self, name: &str) {
        let mut unused = self.unused.borrow_mut();
        unused.remove(name);
        let mut asked = self.asked.borrow_mut();
        if !unused.is_empty() && !asked.contains(name) {
            asked.insert(name.to_string());
        }
    }

    /// The name most like another among those that the text has asked for.
    pub(crate) fn nearest(&self, name: &str) -> Option<String> {
        let asked = self.asked.borrow();
        nearest(name, asked.iter().map(String::as_str)).map(String::from)
    }

    /// Names from outside that nothing has asked for, in alphabetical order.
    pub(crate) fn unused(&self) -> Vec<String> {
        let mut names: Vec<String> = self.unused.borrow().iter().cloned().collect();
        names.sort();
        names
    }

    /// Forgets a name.
    pub(super) fn drop(&mut self, reach: Reach, name: &str) {
        let name = name.to_ascii_lowercase();
        match (reach, self.files.last_mut()) {
            (Reach::Local, Some((_, local))) => local.remove(&name),
            (Reach::Scoped, Some(_)) => self
                .files
                .iter_mut()
                .rev()
                .find_map(|(scoped, _)| scoped.remove(&name)),
            _ => self.global.remove(&name),
        };
    }

    /// What a name stands for.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        let name = name.to_ascii_lowercase();
        self.asks(&name);
        let local = self.files.last().and_then(|(_, local)| local.get(&name));
        local
            .or_else(|| self.files.iter().rev().find_map(|(s, _)| s.get(&name)))
            .or_else(|| self.global.get(&name))
            .map(String::as_str)
    }

    /// Whether a name is defined in one scope (`$if setLocal x`).
    pub(super) fn has(&self, reach: Reach, name: &str) -> bool {
        let name = name.to_ascii_lowercase();
        self.asks(&name);
        match reach {
            Reach::Local => self
                .files
                .last()
                .is_some_and(|(_, l)| l.contains_key(&name)),
            Reach::Scoped => self.files.iter().any(|(s, _)| s.contains_key(&name)),
            Reach::Global => self.global.contains_key(&name),
        }
    }
}

/// The number behind a named constant such as `%modelStat.optimal%`; blanks, `-` and `_` in it say
/// nothing (`%modelStat.Infeasible-No Solution%`).
pub(crate) fn constant(name: &str) -> Option<usize> {
    #[rustfmt::skip]
    const MODEL_STATUS: &[&str] = &[
        "optimal", "locallyoptimal", "unbounded", "infeasible", "locallyinfeasible", "intermediateinfeasible",
        "feasiblesolution", "integersolution", "intermediatenoninteger", "integerinfeasible",
        "licensingproblem", "errorunknown", "errornosolution", "nosolutionreturned", "solvedunique", "solved",
        "solvedsingular", "unboundednosolution", "infeasiblenosolution",
    ];
    #[rustfmt::skip]
    const SOLVE_STATUS: &[&str] = &[
        "normalcompletion", "iterationinterrupt", "resourceinterrupt", "terminatedbysolver",
        "evaluationinterrupt", "capabilityproblems", "licensingproblems", "userinterrupt", "setuperr",
        "solvererr", "internalerr", "skipped", "systemerr",
    ];
    const SOLVE_PRINT: &[&str] = &["summary", "report", "quiet"];
    #[rustfmt::skip]
    const SOLVE_LINK: &[&str] = &[
        "chainscript", "callscript", "callmodule", "asyncgrid", "asyncsimulate", "loadlibrary",
        "asyncthreads", "threadssimulate",
    ];
    const SOLVE_OPT: &[&str] = &["replace", "merge", "clear"];
    const HANDLE_STATUS: &[&str] = &["unknown", "running", "ready", "failure"];
    let name = name.to_ascii_lowercase().replace([' ', '-', '_'], "");
    let (group, member) = name.split_once('.')?;
    let (list, first) = match group {
        "modelstat" => (MODEL_STATUS, 1),
        "solvestat" => (SOLVE_STATUS, 1),
        "solprint" => (SOLVE_PRINT, 0),
        "solvelink" => (SOLVE_LINK, 0),
        "solveopt" => (SOLVE_OPT, 0),
        "handlestatus" => (HANDLE_STATUS, 0),
        _ => return None,
    };
    let member = match member {
        "intermediatenonoptimal" => "feasiblesolution",
        "evaluationerrorlimit" => "evaluationinterrupt",
        "setupfailure" => "setuperr",
        "solverfailure" => "solvererr",
        "internalsolverfailure" => "internalerr",
        "solveprocessingskipped" => "skipped",
        "systemfailure" => "systemerr",
        "off" if group == "solprint" => "summary",
        "on" if group == "solprint" => "report",
        "silent" if group == "solprint" => "quiet",
        m => m,
    };
    let i = list.iter().position(|&m| m == member)?;
    Some(i + first)
}
