//! stubs
use super::*;
#[allow(missing_docs, clippy::all)]
impl Machine<'_> {
    pub(super) fn display(&mut self, _: &[Shown], _: crate::source::Span) {}
    pub(super) fn put(&mut self, _: &str, _: &[PutCode], _: &mut Frame, _: crate::source::Span) {}
    pub(super) fn close_put_files(&mut self) {}
    pub(super) fn exchange(&mut self, _: &crate::syntax::ast::Exchange, _: crate::source::Span) {}
    pub(super) fn draw(
        &mut self,
        _: SymbolId,
        _: Option<&str>,
        _: &mut Frame,
        _: crate::source::Span,
    ) {
    }
    pub(super) fn object_attribute(&self, _: SymbolId, _: &'static str) -> f64 {
        0.0
    }
    pub(super) fn set_object_attribute(
        &mut self,
        _: SymbolId,
        _: &'static str,
        _: f64,
        _: Option<String>,
    ) {
    }
}
