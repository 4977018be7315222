//! From pest's errors to diagnostics that say what is wrong and how to mend it.

use pest::error::{Error, InputLocation};

use super::build::Condensed;
use super::grammar::Rule;
use super::split::Raw;
use crate::diag::Diagnostic;

/// Diagnostics for a statement that the grammar does not accept.
pub(super) fn explain(
    e: &Error<Rule>,
    raw: &Raw,
    condensed: &Condensed,
    expanded: &str,
) -> Vec<Diagnostic> {
    let at = match e.location {
        InputLocation::Pos(p) => p,
        InputLocation::Span((p, _)) => p,
    };
    let text = condensed.text(expanded);
    let rest = text.get(at..).unwrap_or("");
    let word = rest.split_whitespace().next().unwrap_or("");
    let len = word.len().max(1);
    let span = condensed.span(at, (at + len).min(text.len()));
    let _ = raw;
    vec![Diagnostic::error(
        "E0210",
        span,
        format!("this is not understood: `{word}`"),
    )]
}
