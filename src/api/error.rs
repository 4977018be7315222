//! What can go wrong for a program that uses the library.

use super::symbols::SymbolKind;
use crate::host::HostError;
use crate::report::diagnostic::Diagnostic;
use std::fmt;

/// What can go wrong for a program that uses the library.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read.
    File {
        /// The file.
        path: String,
        /// Why not.
        reason: HostError,
    },
    /// The model does not compile, or its run ended with errors ([`super::Run::ok`]).
    Model {
        /// Everything that was said, warnings included.
        diagnostics: Vec<Diagnostic>,
        /// The same as text, with the places in the source.
        messages: String,
    },
    /// The model has no symbol of this name.
    UnknownSymbol {
        /// The name that was asked for.
        name: String,
        /// A symbol with a similar name.
        similar: Option<String>,
    },
    /// The symbol has no such data: a level of a parameter, members of a variable.
    WrongKind {
        /// The symbol.
        name: String,
        /// What it is.
        kind: SymbolKind,
        /// What was asked for.
        wanted: &'static str,
    },
    /// The symbol has another number of indices.
    WrongDimension {
        /// The symbol.
        name: String,
        /// How many it has.
        expected: usize,
        /// How many labels were given.
        given: usize,
    },
    /// The model has no such label.
    UnknownLabel {
        /// The label that was asked for.
        label: String,
        /// A similar label among those of the model.
        similar: Option<String>,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let similar = |s: &Option<String>| match s {
            Some(s) => format!("; did you mean `{s}`?"),
            None => String::new(),
        };
        match self {
            Self::File { path, reason } => write!(f, "{path}: {reason}"),
            Self::Model { messages, .. } => f.write_str(messages.trim_end()),
            Self::UnknownSymbol { name, similar: s } => {
                write!(f, "the model has no symbol `{name}`{}", similar(s))
            }
            Self::WrongKind { name, kind, wanted } => {
                write!(f, "`{name}` is a {kind}; it has no {wanted}")
            }
            Self::WrongDimension {
                name,
                expected,
                given,
            } => write!(
                f,
                "`{name}` has {expected} indices, {given} labels were given"
            ),
            Self::UnknownLabel { label, similar: s } => {
                write!(f, "the model has no label `{label}`{}", similar(s))
            }
        }
    }
}

impl std::error::Error for Error {}
