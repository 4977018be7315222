//! Switches that directives set.

use super::Span;
use std::sync::Arc;

/// Switches set by `$on…`/`$off…` directives.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Modes {
    /// `$onMulti`: a symbol may get data more than once (merged).
    pub multi: bool,
    /// `$onMultiR`: a second data statement replaces the first.
    pub multi_replace: bool,
    /// `$onEmpty`: empty data statements are allowed.
    pub empty: bool,
    /// `$onEps`: zeros in data are stored as `eps`.
    pub eps: bool,
    /// `$onUndf`: `undf` may be written.
    pub undf: bool,
    /// `$offOrder`: lags and `ord` on unordered sets are allowed.
    pub off_order: bool,
    /// `$onImplicitAssign`: a symbol may be read that was never assigned.
    pub implicit_assign: bool,
    /// `$onUni`: any set may stand at any position.
    pub universal: bool,
    /// `$onDotL`: a variable in an assignment means its level.
    pub dot_l: bool,
    /// `$onWarning`: a label outside the domain is kept, with a warning.
    pub warnings: bool,
    /// `$offStrictSingleton`: of several elements a singleton keeps the first.
    pub loose_singleton: bool,
}

/// The switches over the text of a statement: directives may stand inside it.
#[derive(Clone, Debug)]
pub struct Switches(Arc<[(u32, Modes)]>);

impl Switches {
    /// From where in the expanded text which switches are in force; the first holds from the start.
    pub fn new(changes: &[(u32, Modes)]) -> Self {
        Self(changes.into())
    }

    /// The switches where something begins.
    pub fn at(&self, place: Span) -> Modes {
        let later = self.0.partition_point(|(from, _)| *from <= place.lo);
        self.0
            .get(later.saturating_sub(1))
            .map_or(Modes::default(), |m| m.1)
    }
}

impl Default for Switches {
    fn default() -> Self {
        Self::new(&[(0, Modes::default())])
    }
}
