//! Places as editors count them.

use serde::{Deserialize, Serialize};

/// A place in a text: line and column from 0; columns count UTF-16 units, as the language server protocol and JavaScript do.
#[derive(
    Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default, Serialize, Deserialize,
)]
pub struct Position {
    /// Line from 0.
    pub line: u32,
    /// UTF-16 units before it in its line.
    pub character: u32,
}

/// A piece of a text; the end is not part of it.
#[derive(
    Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default, Serialize, Deserialize,
)]
pub struct Range {
    /// Its first character.
    pub start: Position,
    /// Behind its last.
    pub end: Position,
}

/// A piece of a file.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug, Serialize)]
pub struct Location {
    /// The file, as the project knows it.
    pub file: String,
    /// The piece.
    pub range: Range,
}

/// Where the lines of a text begin.
#[derive(Debug)]
pub(super) struct LineIndex(Vec<usize>);

impl LineIndex {
    /// Of a text.
    pub(super) fn new(text: &str) -> Self {
        let mut starts = vec![0];
        starts.extend(memchr::memchr_iter(b'\n', text.as_bytes()).map(|n| n + 1));
        Self(starts)
    }

    /// The place of a byte.
    pub(super) fn position(&self, text: &str, at: usize) -> Position {
        let mut at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        let line = self.0.partition_point(|s| *s <= at).max(1) - 1;
        let before = &text[self.0[line]..at];
        let units = before.chars().map(char::len_utf16).sum::<usize>();
        Position {
            line: line as u32,
            character: units as u32,
        }
    }

    /// The byte at a place; behind the end of a line that end, behind the last line the end of the text.
    pub(super) fn offset(&self, text: &str, p: Position) -> usize {
        let Some(&lo) = self.0.get(p.line as usize) else {
            return text.len();
        };
        let hi = self
            .0
            .get(p.line as usize + 1)
            .map_or(text.len(), |n| n - 1);
        let mut units = 0;
        for (n, c) in text[lo..hi].char_indices() {
            if units >= p.character as usize {
                return lo + n;
            }
            units += c.len_utf16();
        }
        hi
    }

    /// The piece between two bytes.
    pub(super) fn range(&self, text: &str, lo: usize, hi: usize) -> Range {
        Range {
            start: self.position(text, lo),
            end: self.position(text, hi),
        }
    }
}
