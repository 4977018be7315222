//! Numbers of the language that become a position, a width or a count: looked at once, here.

use super::Machine;
use crate::data::value::{number, special_text};
use crate::diag::Diagnostic;
use crate::source::Span;

impl Machine<'_> {
    /// A finite number (`eps` is 0); None, and a diagnostic, for `na`, `undf`, an infinity and acronyms.
    pub(super) fn finite(&self, value: f64, what: &str, span: Span) -> Option<f64> {
        let x = number(value);
        if x.is_finite() {
            return Some(x);
        }
        let word = special_text(value, &self.store.acronyms).unwrap_or_default();
        Diagnostic::execution("E0400", span)
            .says(format!("{what} is {word}"))
            .label("must be a finite number")
            .help("give it a value before, or guard the statement with a condition")
            .note(self);
        None
    }

    /// The whole number next to a value, the nearest that lies between `low` and `high`.
    pub(super) fn whole(
        &self,
        value: f64,
        what: &str,
        [low, high]: [usize; 2],
        span: Span,
    ) -> Option<usize> {
        let x = self.finite(value, what, span)?;
        Some(x.round().clamp(low as f64, high as f64) as usize)
    }
}
