//! From pest's pairs to the tree.
//!
//! Invariants: spans are places in the expanded text; recursion is bounded by the splitter's limit on
//! nesting and by [`DEEPEST`]; text that the grammar accepts either becomes a tree or a diagnostic.

mod declaration;
mod expression;
mod statement;

use pest::iterators::Pair;

use super::ast::*;
use super::grammar::Rule;
use super::split::{Hole, HoleKind};
use crate::diag::Diagnostic;
use crate::source::{Outcome, Span, Switches};

/// Depth of an expression, operators and parentheses counted: later stages recurse over it.
pub(super) const DEEPEST: usize = 1000;

/// A statement's text as the grammar reads it, and where its parts stand in the expanded text.
pub(super) struct Condensed {
    /// `(here, there)`: from this byte on, the text is that of the expanded text from there on.
    pieces: Vec<(usize, usize)>,
    /// Marks: bytes here, and what they stand for.
    marks: Vec<(usize, usize, Span)>,
    /// The text, where it differs from the expanded text.
    text: Option<String>,
    whole: Span,
}

impl Condensed {
    /// Puts marks in the place of holes.
    pub(super) fn new(expanded: &str, whole: Span, holes: &[Hole]) -> Self {
        let (lo, hi) = (whole.lo as usize, whole.hi as usize);
        if holes.is_empty() {
            return Self {
                pieces: vec![(0, lo)],
                marks: Vec::new(),
                text: None,
                whole,
            };
        }
        let mut text = String::new();
        let mut pieces = Vec::with_capacity(holes.len() + 1);
        let mut marks = Vec::with_capacity(holes.len());
        let mut at = lo;
        for (n, hole) in holes.iter().enumerate() {
            pieces.push((text.len(), at));
            text.push_str(&expanded[at..hole.outside.lo as usize]);
            let from = text.len();
            let mark = match hole.kind {
                HoleKind::Text => '\u{1}',
                HoleKind::Body => '\u{2}',
            };
            // Blanks keep the mark from joining a word.
            text.push(' ');
            text.push(mark);
            text.push_str(&n.to_string());
            text.push(mark);
            text.push(' ');
            marks.push((from, text.len(), hole.outside));
            at = hole.outside.hi as usize;
        }
        pieces.push((text.len(), at));
        text.push_str(&expanded[at..hi.max(at)]);
        Self {
            pieces,
            marks,
            text: Some(text),
            whole,
        }
    }

    /// The text for the grammar.
    pub(super) fn text<'a>(&'a self, expanded: &'a str) -> &'a str {
        match &self.text {
            Some(t) => t,
            None => &expanded[self.whole.lo as usize..self.whole.hi as usize],
        }
    }

    fn byte(&self, at: usize, end: bool) -> u32 {
        if self.text.is_none() {
            return self.whole.lo + at as u32;
        }
        let m = self.marks.partition_point(|m| m.0 < at + usize::from(!end));
        if m > 0 {
            let (_, to, span) = self.marks[m - 1];
            if at < to || end && at == to {
                return if end { span.hi } else { span.lo };
            }
        }
        let p = self.pieces.partition_point(|p| p.0 <= at).max(1) - 1;
        let (here, there) = self.pieces[p];
        (there + (at - here)) as u32
    }

    /// The place of `lo..hi` in the expanded text.
    pub(super) fn span(&self, lo: usize, hi: usize) -> Span {
        let a = self.byte(lo, false);
        let b = if hi > lo { self.byte(hi, true) } else { a };
        Span::new(a, b.max(a))
    }
}

/// The next pair, which the grammar promises.
fn need<'i>(
    pairs: &mut impl Iterator<Item = Pair<'i, Rule>>,
    at: Span,
    what: &str,
) -> Outcome<Pair<'i, Rule>> {
    pairs.next().ok_or_else(|| expected(at, what))
}

/// Something is missing.
fn expected(at: Span, what: &str) -> Box<Diagnostic> {
    Box::new(Diagnostic::error("E0210", at).says(format!("{what} was expected")))
}

/// The pairs inside a pair, without those of bare keywords.
fn parts<'i>(pair: Pair<'i, Rule>) -> impl Iterator<Item = Pair<'i, Rule>> {
    pair.into_inner().filter(|p| !is_keyword(p.as_rule()))
}

fn is_keyword(rule: Rule) -> bool {
    use Rule::*;
    matches!(
        rule,
        kw_equation
            | kw_acronym
            | kw_file
            | kw_table
            | kw_model
            | kw_variable
            | kw_alias
            | kw_option
            | kw_loop
            | kw_while
            | kw_for
            | kw_repeat
            | kw_if
            | kw_do
            | kw_then
            | kw_endloop
            | kw_endwhile
            | kw_endfor
            | kw_endif
            | kw_elseif
            | kw_else
            | kw_until
            | kw_by
            | kw_break
            | kw_continue
            | kw_display
            | kw_abort
            | kw_solve
            | kw_figure
            | kw_draw
            | kw_using
            | kw_scenario
    )
}

/// Makes trees from the pairs of one statement.
pub(super) struct Builder<'a> {
    pub(super) condensed: &'a Condensed,
    pub(super) expanded: &'a str,
    pub(super) holes: &'a [Hole],
    /// Switches in force over the statement.
    pub(super) modes: Switches,
}

impl Builder<'_> {
    fn span(&self, pair: &Pair<'_, Rule>) -> Span {
        let s = pair.as_span();
        self.condensed.span(s.start(), s.end())
    }

    fn ident(&self, pair: &Pair<'_, Rule>) -> Ident {
        Ident {
            name: pair.as_str().into(),
            span: self.span(pair),
        }
    }

    /// The name inside of a pair.
    fn first_ident(&self, pair: Pair<'_, Rule>) -> Option<Ident> {
        parts(pair).next().map(|n| self.ident(&n))
    }

    /// A keyword in small letters.
    fn keyword(&self, pair: &Pair<'_, Rule>) -> Ident {
        Ident {
            name: pair.as_str().to_ascii_lowercase().into(),
            span: self.span(pair),
        }
    }

    /// The text inside of the hole that a mark stands for.
    fn text_in(&self, pair: &Pair<'_, Rule>) -> Option<Box<str>> {
        let inside = self.hole(pair)?.inside;
        let text = self.expanded.get(inside.lo as usize..inside.hi as usize);
        text.map(Into::into)
    }

    /// The hole that a mark stands for.
    fn hole(&self, pair: &Pair<'_, Rule>) -> Option<&Hole> {
        let digits = pair.as_str().trim_matches(['\u{1}', '\u{2}']);
        self.holes.get(digits.parse::<usize>().ok()?)
    }

    /// A text between quotes.
    fn unquote(pair: &Pair<'_, Rule>) -> Box<str> {
        let s = pair.as_str();
        s.get(1..s.len().saturating_sub(1)).unwrap_or("").into()
    }
}

/// A text without the quotes around it.
fn bare(text: &str) -> &str {
    let inside = |q: &char| text.strip_prefix(*q)?.strip_suffix(*q);
    ['\'', '"'].iter().find_map(inside).unwrap_or(text)
}
