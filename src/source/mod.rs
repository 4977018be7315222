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
mod marks;
mod modes;
mod preprocess;
mod variables;

pub(crate) use conditions::predefined;
pub(crate) use evaluate::constant;
pub(crate) use map::whole_characters;
pub use map::{FileId, Place, SourceFile, SourceMap};
pub(crate) use marks::Marks;
pub use modes::{Modes, Switches};
pub(crate) use preprocess::{DELIMITED, Preprocessor, outside_quotes, quoted_end};
pub use preprocess::{Ending, Known, NothingKnown, PreprocessOptions, ReadData, SymbolKindName};
pub(crate) use variables::constant as named_constant;

/// What reading a line gives; a diagnostic is boxed because it is large and rare.
pub(crate) type Outcome<T> = Result<T, Box<Diagnostic>>;

/// Code of another language in the model. Only an export gives nothing back; what does not is passed over, as `execute` is.
pub(crate) fn embedded_code(at: Span, gives_back: bool) -> Diagnostic {
    let what = "embedded code of other languages is not run";
    match gives_back {
        true => Diagnostic::error("E0113", at)
            .says(what)
            .label("not run")
            .help("write the computation in the language itself"),
        false => passed_over(at, what),
    }
}

/// An export that is not done.
pub(crate) fn passed_over(at: Span, what: impl Into<String>) -> Diagnostic {
    Diagnostic::warning("E0322", at)
        .says(what)
        .label("passed over: it gives nothing back")
        .help("`execute_unload` and `put` write files; `--json` has everything")
}
