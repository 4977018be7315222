//! Texts, `$` directives, and the places in them.
//!
//! The preprocessor (`directives`) turns files into one *expanded text*; every later stage
//! speaks of places in it as a [`Span`]. A [`SourceMap`] leads from there back to the file the
//! user wrote, through `$include` and `%name%` substitution.
//!
//! Invariant: a span that leaves this crate in a diagnostic is in the *original* text.

use crate::diag::Diagnostic;
pub use crate::span::Span;

mod blocks;
mod conditions;
mod directive_names;
mod directives;
mod evaluate;
mod line;
mod macros;
mod map;
mod modes;
mod preprocess;
mod variables;

pub(crate) use conditions::predefined;
pub(crate) use evaluate::constant;
pub use map::{FileId, Place, SourceFile, SourceMap};
pub use modes::{Modes, Switches};
pub(crate) use preprocess::{DELIMITED, Preprocessor, quoted_end};
pub use preprocess::{Ending, Known, NothingKnown, PreprocessOptions, SymbolKindName};
pub(crate) use variables::constant as named_constant;

/// What reading a line gives; a diagnostic is boxed because it is large and rare.
pub(crate) type Outcome<T> = Result<T, Box<Diagnostic>>;

/// A diagnostic as the outcome.
pub(crate) fn refuse<T>(d: Diagnostic) -> Outcome<T> {
    Err(Box::new(d))
}

/// Code of another language in the model.
pub(crate) fn embedded_code(at: Span) -> Diagnostic {
    Diagnostic::error("E0113", at, "embedded code of other languages is not run")
        .label("not run")
        .help("write the computation in the language itself")
}
