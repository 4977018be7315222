//! From text to tree.
//!
//! [`Parser`] gives one statement at a time, because `$if declared x` and `$eval n card(i)` ask what
//! the statements before them declared. The preprocessor (`source`) makes the expanded text, the
//! splitter (`split`) cuts it into statements, pest parses each by `grammar/bmod.pest`, and `build`
//! makes the tree. Data between slashes and the lines of tables stay text in the tree; [`data`] and
//! [`table`] read them when they are wanted.
//!
//! Invariants: every span in a tree or diagnostic is a place in the expanded text of the parser's
//! [`SourceMap`]; after an error the parser goes on with the next statement; no text makes it panic.

pub mod ast;
mod build;
mod constants;
pub mod data;
mod explain;
mod fields;
mod foreign;
mod grammar;
mod neighbours;
mod slips;
pub(crate) mod split;
pub mod table;
pub(crate) mod words;

use pest::Parser as _;

use crate::diag::Diagnostic;
use crate::host::Host;
use crate::source::{Ending, Known, Outcome, PreprocessOptions, Preprocessor, SourceMap, Span};
use ast::Stmt;
use build::{Builder, Condensed};
use explain::{Explanation, GoOn};
use foreign::Language;
use grammar::{Grammar, Rule};
use split::{Cut, Raw, Splitter};
use words::Class;

/// The text could not be read at all: why, and the map that says where.
#[derive(Debug)]
pub struct Unreadable {
    /// The file that was asked for.
    pub map: SourceMap,
    /// What is wrong with it.
    pub diagnostic: Diagnostic,
}

/// Reads a model statement by statement.
pub struct Parser<'h> {
    text: Preprocessor<'h>,
    splitter: Splitter,
    /// No more text will come.
    ended: bool,
    /// Errors so far.
    errors: usize,
    /// Statements that were cut at a missing `;`.
    pending: Option<Raw>,
    /// Words of the language that were taken for names.
    reserved: Vec<String>,
    /// Other languages that a message was about.
    languages: Vec<Language>,
    /// The statement that could not be read, when the last call ended with errors.
    refused: Option<Span>,
}

/// Problems of declarations that leave them legible.
const LEGIBLE: [&str; 3] = ["E0201", "E0206", "E0223"];

/// Errors after which a text is given up: it is no model.
const MOST_ERRORS: usize = 100;

impl<'h> Parser<'h> {
    /// Opens the main file.
    pub fn new(
        host: &'h mut dyn Host,
        path: &str,
        options: PreprocessOptions,
    ) -> Result<Self, Box<Unreadable>> {
        match Preprocessor::new(host, path, options) {
            Ok(text) => Ok(Self {
                text,
                splitter: Splitter::default(),
                ended: false,
                errors: 0,
                pending: None,
                reserved: Vec::new(),
                languages: Vec::new(),
                refused: None,
            }),
            Err(e) => Err(Box::new(Unreadable {
                map: e.0,
                diagnostic: e.1,
            })),
        }
    }

    /// The next statement; `Ok(None)` at the end. After an error the next call goes on behind it.
    pub fn next(&mut self, known: &dyn Known) -> Result<Option<Stmt>, Vec<Diagnostic>> {
        if self.errors > MOST_ERRORS {
            return Ok(None);
        }
        self.refused = None;
        if let Some(raw) = self.pending.take() {
            return self.take(raw).map(Some);
        }
        loop {
            let cut = self
                .splitter
                .next(self.text.map.expanded(), self.text.on_end, self.ended);
            match cut {
                Cut::Statement(raw) => return self.take(raw).map(Some),
                Cut::More if self.ended => return Ok(None),
                Cut::More => match self.text.fill(known) {
                    Ok(true) => {}
                    Ok(false) => self.ended = true,
                    Err(list) => {
                        self.fail(&list);
                        return Err(list);
                    }
                },
            }
        }
    }

    fn fail(&mut self, list: &[Diagnostic]) {
        self.errors += list.len();
    }

    /// Parses a statement; where a `;` is missing, the rest is kept for the next calls.
    fn take(&mut self, mut raw: Raw) -> Result<Stmt, Vec<Diagnostic>> {
        let problem = std::mem::take(&mut raw.problems).into_iter().next();
        let line = || foreign::line(self.text.map.expanded(), raw.span);
        // What a statement of another language looks like once it is cut is of no interest.
        let outcome = match problem.as_ref().and_then(|_| line()) {
            Some(found) => Err(Box::new(found)),
            None => self.parse(&raw),
        };
        let outcome = match (problem, outcome) {
            (None, outcome) => outcome.map_err(|e| self.refuse(raw, *e)),
            (Some(problem), Ok(_)) if LEGIBLE.contains(&problem.code) => {
                // What is declared beside a stray name may have lost its data.
                self.refused = (problem.code == "E0223").then_some(raw.span);
                self.pending = Some(raw);
                Err(vec![problem])
            }
            // The grammar knows better why a declaration is spoiled.
            (Some(problem), Err(e)) if problem.code == "E0223" || e.language != Language::Any => {
                Err(self.refuse(raw, *e))
            }
            (Some(problem), _) => Err(self.refuse(raw, Explanation::of(problem))),
        };
        if let Err(list) = &outcome {
            self.fail(list);
        }
        outcome
    }

    /// A statement that cannot be read: what is said, and where to read on.
    fn refuse(&mut self, mut raw: Raw, e: Explanation) -> Vec<Diagnostic> {
        self.refused = Some(raw.span);
        match e.go_on {
            GoOn::Behind => {}
            GoOn::At(at) => {
                self.refused = Some(Span::new(raw.span.lo, at.max(raw.span.lo)));
                self.splitter.back_to(at as usize);
            }
            GoOn::Divided { end, start } => {
                self.refused = None;
                raw.span.hi = end;
                self.splitter.back_to(start as usize);
                self.pending = Some(raw);
            }
            GoOn::Nowhere => self.errors = MOST_ERRORS + 1,
        }
        // A text in another language is one mistake, and so is a name that is a word of the language.
        let again = match e.language {
            Language::Any => false,
            Language::Blocks => !self.languages.is_empty(),
            other => self.languages.contains(&other),
        };
        if e.language != Language::Any && !again {
            self.languages.push(e.language);
        }
        let Some(d) = e.diagnostic.filter(|_| !again) else {
            return Vec::new();
        };
        let word = self.text.map.text(d.span).to_ascii_lowercase();
        match d.code {
            "E0205" => self.reserved.push(word),
            "E0210" | "E0235" if self.reserved.contains(&word) => return Vec::new(),
            _ => {}
        }
        vec![d]
    }

    /// `variable x >= 0;` is legal, but the bound is a text.
    fn suspicious_texts(&mut self, stmt: &Stmt) {
        if let ast::StmtKind::Set(list) = &stmt.kind {
            let texts = list
                .iter()
                .filter(|s| s.symbol.data.is_none())
                .filter_map(|s| Some((&s.symbol.name, s.symbol.text.as_deref()?)));
            for (name, text) in
                texts.filter(|(_, t)| t.contains(":=") || t.contains("..") && t.contains('='))
            {
                let message = format!(
                    "`{text}` behind `{}` is read as an explanatory text, not as elements",
                    name.name
                );
                let help =
                    "the elements stand between slashes: `set i / a, b, c /;`, `set t / 1*10 /;`";
                self.text.warnings.push(
                    Diagnostic::warning("E0234", name.span)
                        .says(message)
                        .help(help),
                );
            }
        }
        let ast::StmtKind::Variable(stated, list) = &stmt.kind else {
            return;
        };
        for d in list {
            let Some(text) = d.text.as_deref() else {
                continue;
            };
            let name = &d.name.name;
            let word = &text[..words::word_end(text.as_bytes(), 0)];
            let behind = text[word.len()..].trim_start();
            let number = behind.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '='));
            let bound =
                text.starts_with(['<', '>']) || number && matches!(word, "lo" | "up" | "fx");
            let quoted = || {
                let written = self.text.map.text(stmt.span);
                ["'", "\""]
                    .iter()
                    .any(|q| written.contains(&format!("{q}{text}{q}")))
            };
            let kind = foreign::variable_kind(word)
                .filter(|_| behind.is_empty() || behind.starts_with(['<', '>']))
                .filter(|_| *stated == ast::VariableKind::Unstated && !quoted());
            let (what, help) = match kind {
                Some(kind) => {
                    let sets: Vec<&str> =
                        d.domain.iter().flatten().map(|s| &*s.name.name).collect();
                    let over = match sets.is_empty() {
                        true => String::new(),
                        false => format!("({})", sets.join(",")),
                    };
                    ("kind", format!("write `{kind} variable {name}{over};`"))
                }
                None if !bound => continue,
                None if text.starts_with('>') => (
                    "bound",
                    format!(
                        "declare `positive variable {name};`, or assign `{name}.lo = …;` after the declaration"
                    ),
                ),
                None => (
                    "bound",
                    format!("assign the bound after the declaration: `{name}.up = …;`"),
                ),
            };
            let message =
                format!("`{text}` behind `{name}` is read as an explanatory text, not as a {what}");
            self.text.warnings.push(
                Diagnostic::warning("E0234", d.name.span)
                    .says(message)
                    .help(help),
            );
        }
    }

    fn parse(&mut self, raw: &Raw) -> Result<Stmt, Box<Explanation>> {
        let expanded = self.text.map.expanded();
        let condensed = Condensed::new(expanded, raw.span, &raw.holes);
        let text = condensed.text(expanded);
        let rule = match raw.class {
            Class::Set => Rule::whole_set,
            Class::Parameter => Rule::whole_parameter,
            Class::Variable => Rule::whole_variable,
            Class::Equation => Rule::whole_equation,
            Class::Acronym => Rule::whole_acronym,
            Class::File => Rule::whole_file,
            Class::Model => Rule::whole_model,
            Class::Table => Rule::whole_table,
            Class::Alias => Rule::whole_alias,
            Class::Algebra => Rule::whole_algebra,
            Class::Directive | Class::Other => Rule::whole_other,
        };
        let modes = self.text.switches(raw.span);
        let builder = Builder {
            condensed: &condensed,
            expanded,
            holes: &raw.holes,
            modes: modes.clone(),
        };
        let built = match Grammar::parse(rule, text) {
            Ok(mut pairs) => match pairs.next() {
                Some(pair) => builder.statement(pair),
                None => Ok(ast::StmtKind::Empty),
            },
            Err(e) => {
                // What would have been accepted is collected only now: it doubles the time.
                pest::set_error_detail(true);
                let e = Grammar::parse(rule, text).err().unwrap_or(e);
                pest::set_error_detail(false);
                return Err(Box::new(explain::explain(
                    &e, raw, &condensed, expanded, rule,
                )));
            }
        };
        let stmt = Stmt {
            kind: built.map_err(|d| Box::new(Explanation::of(*d)))?,
            span: raw.span,
            modes,
        };
        self.suspicious_texts(&stmt);
        Ok(stmt)
    }

    /// The statement that could not be read, after errors that leave nothing of it.
    pub fn refused(&self) -> Option<&str> {
        self.refused.map(|span| self.text.map.text(span))
    }

    /// The text of a data file that the statement at `at` asks for.
    pub fn read(&mut self, name: &str, at: Span) -> Outcome<Vec<u8>> {
        self.text.read(name, at)
    }

    /// Keeps a file that the run writes; what follows may read it.
    pub fn remember(&mut self, name: &str, bytes: Vec<u8>, span: Span) {
        self.text.map.remember(name, bytes, span);
    }

    /// The files and the expanded text so far.
    pub fn map(&self) -> &SourceMap {
        &self.text.map
    }

    /// Names that `-D` defined and the text never asked for.
    pub fn unused_defines(&self) -> Vec<String> {
        self.text.names.unused()
    }

    /// A warning of each of them.
    pub(crate) fn warnings_of_unused(&self) -> impl Iterator<Item = Diagnostic> {
        self.unused_defines().into_iter().map(|name| {
            let d = Diagnostic::warning("E0117", Span::NOWHERE).says(format!(
                "`-D {name}` has no effect: nothing in the text reads `%{name}%`"
            ));
            let nearest = self.text.names.nearest(&name);
            let otherwise = "a name that the text reads stands in it as `%name%`";
            d.did_you_mean(nearest.map(|n| format!("-D {n}")), otherwise)
        })
    }

    /// The files and the expanded text, when parsing is done.
    pub fn into_map(self) -> SourceMap {
        self.text.map
    }

    /// How many of the errors so far `$clearError` made warnings.
    pub fn cleared_errors(&self) -> usize {
        self.text.cleared_errors
    }

    /// Warnings since the last call.
    pub fn warnings(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.text.warnings)
    }

    /// How the text ended: whether it is to be run.
    pub fn ending(&self) -> Ending {
        self.text.ending
    }

    /// A statement's text, as expanded.
    pub fn text(&self, span: Span) -> &str {
        self.text.map.text(span)
    }
}
