//! Attributes of models and files: `m.modelstat`, `m.iterlim = 100`, `f.nd = 4`.
//!
//! What was never assigned and no solve has set reads as `na`, as in GAMS; the solver's defaults stand
//! elsewhere. Files have defaults of their own.

use super::Machine;
use crate::check::node::SymbolId;
use crate::check::symbols::SymbolKind;
use crate::data::value::NA;
use crate::solve::{ModelStatus, SolverStatus};
use crate::source::Span;

impl Machine<'_> {
    /// The value of an attribute (its name in lower case).
    pub(super) fn object_attribute(&self, s: SymbolId, a: &'static str) -> f64 {
        if let SymbolKind::File(_) = self.symbols.get(s).kind {
            return match self.put.files.get(&s) {
                Some(f) => f.attribute(a),
                None => crate::report::textfile::TextFile::default().get(a),
            };
        }
        match self.models.get(&s).and_then(|m| m.get(a)) {
            Some(v) => v,
            None if matches!(a, "number" | "tolproj" | "handle") => 0.0,
            None => NA,
        }
    }

    /// Assigns an attribute; a text says nothing to those that are numbers.
    pub(super) fn set_object_attribute(
        &mut self,
        s: SymbolId,
        a: &'static str,
        value: f64,
        text: Option<String>,
        span: Span,
    ) {
        if text.is_some() {
            return;
        }
        match self.symbols.get(s).kind {
            SymbolKind::File(_) => {
                let name = format!("`{}.{a}`", self.symbols.get(s).name);
                if let Some(x) = self.finite(value, &name, span) {
                    self.put.files.entry(s).or_default().text.set(a, x);
                }
            }
            _ => {
                self.models
                    .entry(s)
                    .or_default()
                    .attributes
                    .insert(a, value);
            }
        }
    }

    /// `m.tmodstat`, `m.tsolstat`: the status with its name.
    pub(super) fn status_text(&self, s: SymbolId, a: &str) -> String {
        let (of, name_of): (_, fn(f64) -> _) = match a {
            "tmodstat" => ("modelstat", ModelStatus::name_of_code),
            _ => ("solvestat", SolverStatus::name_of_code),
        };
        let code = self.object_attribute(s, of);
        match name_of(code) {
            Some(name) => format!("{code} {}", capitals(name)),
            None => "No Status Available".into(),
        }
    }
}

/// Every word with a capital.
fn capitals(words: &str) -> String {
    let mut out = String::new();
    for (k, w) in words.split(' ').enumerate() {
        if k > 0 {
            out.push(' ');
        }
        let mut chars = w.chars();
        out.extend(chars.next().map(|c| c.to_ascii_uppercase()));
        out.push_str(chars.as_str());
    }
    out
}
