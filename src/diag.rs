//! Diagnostics: what is wrong, where, why, and how to fix it.
//!
//! Invariant: every error has a place. A message speaks in the reader's terms, with labels and
//! numbers of the instance; a help line says how to fix it. No Rust type name, no internal index.

pub mod codes;

use crate::span::Span;

/// How serious a diagnostic is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Legal, but unlikely to be meant.
    Warning,
    /// The text does not compile (exit status 2).
    Error,
    /// Something went wrong while running (exit status 3).
    Execution,
}

/// A second place that belongs to the story ("declared here with 2 indices").
#[derive(Clone, PartialEq, Debug)]
pub struct Label {
    /// Where.
    pub span: Span,
    /// What is there; may be empty for the main place.
    pub text: String,
}

/// One thing to tell the user.
#[derive(Clone, PartialEq, Debug)]
pub struct Diagnostic {
    /// A code of [`codes::CODES`], `E0101`.
    pub code: &'static str,
    /// How serious.
    pub severity: Severity,
    /// The problem, with its values.
    pub message: String,
    /// The main place.
    pub span: Span,
    /// What to write at the main place; may be empty.
    pub label: String,
    /// Other places.
    pub others: Vec<Label>,
    /// How to fix it.
    pub help: Option<String>,
}

impl Diagnostic {
    fn new(severity: Severity, code: &'static str, span: Span) -> Self {
        debug_assert!(codes::find(code).is_some(), "{code} is not in diag::codes");
        Self {
            code,
            severity,
            message: String::new(),
            span,
            label: String::new(),
            others: Vec::new(),
            help: None,
        }
    }

    /// A compile error; its message follows with [`Diagnostic::says`].
    pub fn error(code: &'static str, span: Span) -> Self {
        Self::new(Severity::Error, code, span)
    }

    /// A warning; its message follows with [`Diagnostic::says`].
    pub fn warning(code: &'static str, span: Span) -> Self {
        Self::new(Severity::Warning, code, span)
    }

    /// An execution error; its message follows with [`Diagnostic::says`].
    pub fn execution(code: &'static str, span: Span) -> Self {
        Self::new(Severity::Execution, code, span)
    }

    /// The problem, with its values.
    pub fn says(mut self, message: impl Into<String>) -> Self {
        self.message = message.into();
        self
    }

    /// The same found while the text is read.
    pub fn as_error(mut self) -> Self {
        self.severity = Severity::Error;
        self
    }

    /// Adds the text at the main place.
    pub fn label(mut self, text: impl Into<String>) -> Self {
        self.label = text.into();
        self
    }

    /// Adds another place.
    pub fn other(mut self, span: Span, text: impl Into<String>) -> Self {
        self.others.push(Label {
            span,
            text: text.into(),
        });
        self
    }

    /// Adds how to fix it.
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }

    /// Adds the name that may have been meant as help, or else another help.
    pub fn did_you_mean(
        self,
        near: Option<impl std::fmt::Display>,
        otherwise: impl Into<String>,
    ) -> Self {
        match near {
            Some(n) => self.help(format!("did you mean `{n}`?")),
            None => self.help(otherwise),
        }
    }

    /// The diagnostic as an outcome; boxed because it is large and rare.
    pub(crate) fn refuse<T>(self) -> Result<T, Box<Self>> {
        Err(Box::new(self))
    }
}

/// The name among `known` that is most like `name`, if any is like enough to suggest.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    known
        .into_iter()
        .map(|k| (strsim::damerau_levenshtein(&name, &k.to_lowercase()), k))
        // Of two names of one letter none is like the other.
        .filter(|&(d, k)| d <= 1 + name.len().min(k.len()) / 4 && d < name.len().max(k.len()))
        .min()
        .map(|(_, k)| k)
}
