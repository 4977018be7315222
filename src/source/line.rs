//! One line on its way into the expanded text.
//!
//! Most lines are copied in runs and never become a [`Line`]. A line with `%name%`, a macro or a
//! comment in the middle is taken apart here: its text changes, and every piece remembers the bytes
//! of the file that it stands for.
//!
//! Invariant: the pieces cover the text without gaps, in order.

use super::map::{FileId, SourceMap};

/// A piece of a line.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// Where it begins in the line's text.
    start: usize,
    /// What it stands for in the file.
    lo: u32,
    hi: u32,
    /// The text is the file's own.
    copied: bool,
}

/// The text of a line with the origin of each piece.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// The text as it stands now, without its line end.
    pub(super) text: String,
    file: FileId,
    pieces: Vec<Piece>,
}

impl Line {
    /// The bytes `lo..hi` of a file.
    pub(super) fn new(file: FileId, lo: u32, text: &str) -> Self {
        Self {
            text: text.to_owned(),
            file,
            pieces: vec![Piece {
                start: 0,
                lo,
                hi: lo + text.len() as u32,
                copied: true,
            }],
        }
    }

    /// The file that it stands in.
    pub(super) fn file(&self) -> FileId {
        self.file
    }

    fn piece_at(&self, at: usize) -> Piece {
        let i = self.pieces.partition_point(|p| p.start <= at);
        self.pieces[i.saturating_sub(1)]
    }

    /// What `from..to` of the text stands for in the file.
    pub(super) fn origin(&self, from: usize, to: usize) -> (u32, u32) {
        let a = self.piece_at(from);
        let b = self.piece_at(to.saturating_sub(1).max(from));
        let lo = if a.copied {
            a.lo + (from - a.start) as u32
        } else {
            a.lo
        };
        let hi = if b.copied {
            b.lo + (to.max(b.start) - b.start) as u32
        } else {
            b.hi
        };
        (lo, hi.max(lo))
    }

    /// Puts other text in the place of several ranges, which are in order and do not overlap.
    pub(super) fn replace(&mut self, changes: &[(usize, usize, String)]) {
        if changes.is_empty() {
            return;
        }
        let old = std::mem::take(&mut self.text);
        let mut pieces = Vec::new();
        let mut text = String::with_capacity(old.len());
        let mut at = 0;
        for (from, to, new) in changes {
            self.keep(&old, at, *from, &mut text, &mut pieces);
            let (lo, hi) = self.origin(*from, *to);
            if !new.is_empty() {
                pieces.push(Piece {
                    start: text.len(),
                    lo,
                    hi,
                    copied: false,
                });
                text.push_str(new);
            }
            at = *to;
        }
        self.keep(&old, at, old.len(), &mut text, &mut pieces);
        if pieces.is_empty() {
            let (lo, hi) = self.origin(0, old.len());
            pieces.push(Piece {
                start: 0,
                lo,
                hi,
                copied: false,
            });
        }
        self.text = text;
        self.pieces = pieces;
    }

    fn keep(&self, old: &str, from: usize, to: usize, text: &mut String, out: &mut Vec<Piece>) {
        for (end, piece) in self.within(old, from, to) {
            out.push(Piece {
                start: text.len(),
                ..piece
            });
            text.push_str(&old[piece.start..end]);
        }
    }

    /// The pieces of `from..to` of a text, cut there, each with its end.
    fn within<'l>(
        &'l self,
        text: &'l str,
        from: usize,
        to: usize,
    ) -> impl Iterator<Item = (usize, Piece)> + 'l {
        let mut at = from;
        std::iter::from_fn(move || {
            let i = self.pieces.partition_point(|p| p.start <= at);
            let mut piece = *self.pieces.get(i.saturating_sub(1)).filter(|_| at < to)?;
            let end = self.pieces.get(i).map_or(text.len(), |p| p.start).min(to);
            if piece.copied {
                piece.lo += (at - piece.start) as u32;
                piece.hi = piece.lo + (end - at) as u32;
            }
            piece.start = std::mem::replace(&mut at, end);
            Some((end, piece))
        })
    }

    /// Appends `from..to` to the expanded text.
    pub(super) fn emit(&self, map: &mut SourceMap, from: usize, to: usize) {
        for (end, piece) in self.within(&self.text, from, to) {
            match piece.copied {
                true => map.push_copy(self.file, piece.lo, piece.hi),
                false => {
                    let text = &self.text[piece.start..end];
                    map.push_substitute(text, self.file, piece.lo, piece.hi)
                }
            };
        }
    }
}
