//! Diagnostics as programs read them: values, and JSON with one object per line.

use serde::Serialize;

use crate::diag;
pub use crate::diag::Severity;
use crate::source::{SourceMap, Span};

/// A place in a file: lines and columns from 1, columns in characters; the end is exclusive.
#[derive(Clone, Debug, Serialize, PartialEq)]
pub struct Place {
    /// The file, as the user wrote it.
    pub file: String,
    /// Line of its first character.
    pub line: usize,
    /// Column of its first character.
    pub column: usize,
    /// Line behind its last character.
    pub end_line: usize,
    /// Column behind its last character.
    pub end_column: usize,
    /// Offset of its first byte in the file. Not in the JSON.
    #[serde(skip)]
    pub start: usize,
    /// Offset behind its last byte in the file. Not in the JSON.
    #[serde(skip)]
    pub end: usize,
}

/// Another place that belongs to a diagnostic.
#[derive(Clone, Debug, Serialize, PartialEq)]
pub struct Related {
    /// Where.
    #[serde(flatten)]
    pub place: Option<Place>,
    /// What is there.
    pub text: String,
}

/// An error or a warning: what is wrong, where, and how to fix it.
#[derive(Clone, Debug, Serialize, PartialEq)]
pub struct Diagnostic {
    /// Its code, which stays the same from version to version: `E0101`. `docs/errors.md` lists them.
    pub code: &'static str,
    /// How serious it is.
    pub severity: Severity,
    /// The problem, with its values.
    pub message: String,
    /// The main place; absent where there is none.
    #[serde(flatten)]
    pub place: Option<Place>,
    /// What is at the main place; perhaps empty.
    pub label: String,
    /// Other places.
    #[serde(rename = "labels")]
    pub related: Vec<Related>,
    /// How to fix it.
    pub help: Option<String>,
}

/// A span of the expanded text as a place in a file.
pub fn place(span: Span, map: &SourceMap) -> Option<Place> {
    let p = map.place(span)?;
    let file = map.file(p.file);
    let (line, column) = file.line_column(p.lo);
    let (end_line, end_column) = file.line_column(p.hi);
    Some(Place {
        file: file.name.clone(),
        line,
        column,
        end_line,
        end_column,
        start: p.lo as usize,
        end: p.hi as usize,
    })
}

impl Diagnostic {
    /// With places in the files.
    pub(crate) fn new(d: &diag::Diagnostic, map: &SourceMap) -> Self {
        let related = |o: &diag::Label| Related {
            place: place(o.span, map),
            text: o.text.clone(),
        };
        Self {
            code: d.code,
            severity: d.severity,
            message: d.message.clone(),
            place: place(d.span, map),
            label: d.label.clone(),
            related: d.others.iter().map(related).collect(),
            help: d.help.clone(),
        }
    }

    /// The same for a list.
    pub(crate) fn all(list: &[diag::Diagnostic], map: &SourceMap) -> Vec<Self> {
        list.iter().map(|d| Self::new(d, map)).collect()
    }
}

/// All diagnostics as JSON, one object per line.
pub fn json_lines(diagnostics: &[diag::Diagnostic], map: &SourceMap) -> String {
    let mut out = String::new();
    for d in diagnostics {
        // Strings and numbers only: this cannot fail.
        out.push_str(&serde_json::to_string(&Diagnostic::new(d, map)).unwrap_or_default());
        out.push('\n');
    }
    out
}
