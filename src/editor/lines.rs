//! The lines of a text: which are comments, directives, or lines that nobody reads, and the text with all of that blanked
//! out, byte for byte, so that what is left can be read as statements.
//!
//! This looks at one file as it stands. It knows the directives that change the marks of comments and those that take
//! lines out; it follows no condition and reads no other file.

use crate::source::Marks;

/// What a line is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum LineKind {
    /// Statements, or blank.
    Code,
    /// Statements whose columns or blanks count: `$onDelim`, `$minCol`. A formatter leaves them.
    Fixed,
    /// A comment.
    Comment,
    /// A `$` directive, or the lines that continue one.
    Directive,
    /// Not read as statements: `$onText`, `$onEcho`, embedded code, what follows `$exit`.
    Raw,
}

/// A piece of a text, in bytes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Piece {
    /// First byte.
    pub lo: usize,
    /// Behind the last.
    pub hi: usize,
}

/// A text taken apart into lines.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// The text with blanks in the place of what is no statement.
    pub code: String,
    /// First byte of each line, and the length of the text at the end.
    pub starts: Vec<usize>,
    /// What each line is.
    pub kinds: Vec<LineKind>,
    /// Comments behind or inside code.
    pub comments: Vec<Piece>,
}

/// The directive that a line begins with, in lower case, and what stands behind it.
pub(super) fn directive<'t>(line: &'t str, marks: &Marks) -> Option<(String, &'t str)> {
    let (word, end) = marks.directive_name(line)?;
    Some((word.to_ascii_lowercase(), &line[end..]))
}

/// The directive that ends the lines which this one takes out.
fn taken_out_up_to(word: &str) -> Option<&'static str> {
    Some(match word {
        "ontext" => "offtext",
        "onput" | "onputs" | "onputv" => "offput",
        _ if word.starts_with("onecho") => "offecho",
        _ if word.starts_with("onembeddedcode") => "offembeddedcode",
        _ => return None,
    })
}

impl Lines {
    /// Takes a text apart; `slashes`: `//` begins a comment, as in a `.blk`.
    pub(super) fn of(text: &str, slashes: bool) -> Self {
        let mut lines = Self::default();
        let (mut marks, mut columns) = (Marks::new(slashes), false);
        let mut code = text.as_bytes().to_vec();
        let mut raw_up_to: Option<&'static str> = None;
        let mut continued = false;
        let mut depth = 0;
        let mut lo = 0;
        for line in text.split_inclusive('\n') {
            let hi = lo + line.len();
            let body = line.trim_end_matches(['\n', '\r']);
            let kind = if let Some(end) = raw_up_to {
                match directive(body, &marks) {
                    Some((word, _)) if word == end => {
                        raw_up_to = None;
                        LineKind::Directive
                    }
                    _ if end == EMBEDDED && body.to_ascii_lowercase().contains(EMBEDDED) => {
                        raw_up_to = None;
                        LineKind::Raw
                    }
                    _ => LineKind::Raw,
                }
            } else if continued {
                continued = body.trim_end().ends_with('\\');
                LineKind::Directive
            } else if depth > 0 {
                lines.comments_of(&mut code, lo, body, &marks, &mut depth);
                LineKind::Fixed
            } else if body.as_bytes().first() == Some(&marks.comment) {
                LineKind::Comment
            } else if let Some((word, rest)) = directive(body, &marks) {
                match (word.strip_prefix("on"), word.strip_prefix("off")) {
                    (Some(w), _) => drop(marks.switch(w, true)),
                    (_, Some(w)) => drop(marks.switch(w, false)),
                    _ => drop(marks.set(&word, rest)),
                }
                columns |= matches!(word.as_str(), "mincol" | "maxcol");
                raw_up_to = taken_out_up_to(&word);
                if matches!(word.as_str(), "exit" | "stop" | "terminate") {
                    raw_up_to = Some("");
                }
                continued = word == "macro" && body.trim_end().ends_with('\\');
                LineKind::Directive
            } else {
                lines.comments_of(&mut code, lo, body, &marks, &mut depth);
                let first = body.trim_start();
                if first.len() >= 12
                    && first.is_char_boundary(12)
                    && first[..12].eq_ignore_ascii_case("embeddedcode")
                {
                    raw_up_to = Some(EMBEDDED);
                    LineKind::Raw
                } else if marks.delimited || columns || depth > 0 {
                    LineKind::Fixed
                } else {
                    LineKind::Code
                }
            };
            if !matches!(kind, LineKind::Code | LineKind::Fixed) {
                blank(&mut code, lo, hi);
            }
            lines.starts.push(lo);
            lines.kinds.push(kind);
            lo = hi;
        }
        lines.starts.push(lo);
        // Only whole characters were blanked out.
        lines.code = String::from_utf8(code).unwrap_or_else(|_| text.to_owned());
        lines
    }

    /// The line that a byte stands in, from 0.
    pub(super) fn line_of(&self, at: usize) -> usize {
        let n = self.starts.partition_point(|s| *s <= at);
        n.saturating_sub(1).min(self.kinds.len().saturating_sub(1))
    }

    /// The bytes of a line without its end.
    pub(super) fn range(&self, line: usize, text: &str) -> Piece {
        let lo = self.starts.get(line).copied().unwrap_or(text.len());
        let hi = self.starts.get(line + 1).copied().unwrap_or(text.len());
        let body = text.get(lo..hi).unwrap_or("");
        Piece {
            lo,
            hi: lo + body.trim_end_matches(['\n', '\r']).len(),
        }
    }

    /// Blanks out the comments of a line of code.
    fn comments_of(
        &mut self,
        code: &mut [u8],
        lo: usize,
        body: &str,
        marks: &Marks,
        depth: &mut usize,
    ) {
        let found = marks.comments(body.as_bytes(), 0, false, depth);
        let to_end = (found.end, body.len());
        let pieces = found.pieces.into_iter().chain([to_end]);
        for (from, to) in pieces.filter(|p| p.0 < p.1) {
            let (lo, hi) = (lo + from, lo + to);
            blank(code, lo, hi);
            self.comments.push(Piece { lo, hi });
        }
    }
}

/// Puts blanks in the place of a piece, line ends aside.
fn blank(code: &mut [u8], lo: usize, hi: usize) {
    code[lo..hi]
        .iter_mut()
        .filter(|b| **b != b'\n')
        .for_each(|b| *b = b' ');
}

const EMBEDDED: &str = "endembeddedcode";
