//! From the expanded text back to the files.

use super::{DELIMITED, Span};
use std::collections::BTreeMap;

/// Number of a file in a [`SourceMap`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct FileId(pub u32);

/// One file as it was read.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// Path as the user wrote it.
    pub name: String,
    /// Whole text.
    pub text: String,
    /// Line ends before each block of [`BLOCK`] bytes.
    ends_before: Vec<u32>,
}

/// Bytes of a text whose line ends are counted at once: to find a line takes the time for one block.
const BLOCK: usize = 16 << 10;

/// A place in an original file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Place {
    /// The file.
    pub file: FileId,
    /// First byte in the file.
    pub lo: u32,
    /// One past the last byte.
    pub hi: u32,
}

/// A piece of the expanded text: `len` bytes from `expanded` on stand for the original at `origin`.
#[derive(Clone, Copy, Debug)]
struct Segment {
    expanded: u32,
    len: u32,
    file: FileId,
    origin: u32,
    /// Bytes in the original. Equal to `len` where the text was copied; otherwise the whole
    /// segment stands for the whole original range (a substituted `%name%`, a macro call).
    origin_len: u32,
    /// Marks stand in the copy that the original does not have.
    marked: bool,
}

/// A file that the run has written.
#[derive(Clone, Default, Debug)]
pub(crate) struct Written {
    /// Its name, as spelled.
    pub name: String,
    pub bytes: Vec<u8>,
    /// What wrote it.
    pub span: Span,
}

/// All files of a run, and where each piece of the expanded text came from.
#[derive(Clone, Default, Debug)]
pub struct SourceMap {
    files: Vec<SourceFile>,
    expanded: String,
    segments: Vec<Segment>,
    /// From which byte of the expanded text on how many lines a listing counts more than the file.
    listing: Vec<(u32, i64)>,
    /// Files that the run has written, `$echo` and `$unload` first, by lower-case name.
    pub(crate) written: BTreeMap<String, Written>,
    /// What `$title` said last.
    pub(crate) title: Option<String>,
    /// The label of `$phantom`: data leave out the records that have it.
    pub(crate) phantom: Option<Box<str>>,
}

fn line_ends(text: &[u8]) -> u32 {
    memchr::memchr_iter(b'\n', text).count() as u32
}

/// The bytes `lo..hi` of a text, widened to whole characters.
pub(crate) fn whole_characters(text: &str, mut lo: usize, mut hi: usize) -> (usize, usize) {
    while !text.is_char_boundary(lo) {
        lo -= 1;
    }
    while !text.is_char_boundary(hi) {
        hi += 1;
    }
    (lo, hi)
}

impl SourceMap {
    /// The bytes of a file that the run has written.
    pub fn written(&self, name: &str) -> Option<&[u8]> {
        let found = self.written.get(&name.to_lowercase());
        found.map(|w| w.bytes.as_slice())
    }

    /// The text of a file that the run has written.
    pub fn written_text(&self, name: &str) -> Option<&str> {
        std::str::from_utf8(self.written(name)?).ok()
    }

    /// Keeps a file that the run writes: it may be read again.
    pub fn remember(&mut self, name: &str, bytes: Vec<u8>, span: Span) {
        let name = name.to_owned();
        let file = Written { name, bytes, span };
        self.written.insert(file.name.to_lowercase(), file);
    }

    /// Adds a file.
    pub fn add_file(&mut self, name: impl Into<String>, text: String) -> FileId {
        // Mostly all of it is copied, under `$onDelim` with a mark a line: with room at once the copy never moves.
        self.expanded.reserve(text.len() + text.len() / 16);
        let blocks = text.as_bytes().chunks(BLOCK);
        let ends_before = blocks.scan(0, |ends, block| {
            let before = *ends;
            *ends += line_ends(block);
            Some(before)
        });
        self.files.push(SourceFile {
            name: name.into(),
            ends_before: ends_before.collect(),
            text,
        });
        FileId(self.files.len() as u32 - 1)
    }

    /// The file with this number.
    pub fn file(&self, id: FileId) -> &SourceFile {
        &self.files[id.0 as usize]
    }

    /// All files, in the order in which they were read.
    pub fn files(&self) -> &[SourceFile] {
        &self.files
    }

    /// The expanded text so far.
    pub fn expanded(&self) -> &str {
        &self.expanded
    }

    /// The expanded text of a span.
    pub fn text(&self, span: Span) -> &str {
        self.expanded
            .get(span.lo as usize..span.hi as usize)
            .unwrap_or("")
    }

    /// Appends a copy of `lo..hi` of a file to the expanded text and returns where it stands.
    pub fn push_copy(&mut self, file: FileId, lo: u32, hi: u32) -> Span {
        let start = self.expanded.len() as u32;
        self.expanded
            .push_str(&self.files[file.0 as usize].text[lo as usize..hi as usize]);
        self.push_segment(Segment {
            expanded: start,
            len: hi - lo,
            file,
            origin: lo,
            origin_len: hi - lo,
            marked: false,
        });
        Span::new(start, start + hi - lo)
    }

    /// Appends a copy of the lines `lo..hi` of a file, with [`DELIMITED`] before each that is not blank.
    pub(super) fn push_marked(&mut self, file: FileId, lo: u32, hi: u32) {
        let start = self.expanded.len() as u32;
        let lines = &self.files[file.0 as usize].text[lo as usize..hi as usize];
        let ends = memchr::memchr_iter(b'\n', lines.as_bytes()).map(|n| n + 1);
        let mut from = 0;
        for end in ends.chain([lines.len()]) {
            let line = &lines[from..end];
            if !line.trim_start().is_empty() {
                self.expanded.push_str(DELIMITED);
            }
            self.expanded.push_str(line);
            from = end;
        }
        self.segments.push(Segment {
            expanded: start,
            len: self.expanded.len() as u32 - start,
            file,
            origin: lo,
            origin_len: hi - lo,
            marked: true,
        });
    }

    /// Appends a text that stands for `lo..hi` of a file (a substitution).
    pub fn push_substitute(&mut self, text: &str, file: FileId, lo: u32, hi: u32) -> Span {
        let start = self.expanded.len() as u32;
        self.expanded.push_str(text);
        let len = text.len() as u32;
        self.segments.push(Segment {
            expanded: start,
            len,
            file,
            origin: lo,
            origin_len: hi - lo,
            marked: false,
        });
        Span::new(start, start + len)
    }

    fn push_segment(&mut self, s: Segment) {
        if let Some(last) = self.segments.last_mut() {
            let contiguous = last.len == last.origin_len
                && !last.marked
                && last.file == s.file
                && last.expanded + last.len == s.expanded
                && last.origin + last.origin_len == s.origin;
            if contiguous {
                last.len += s.len;
                last.origin_len += s.origin_len;
                return;
            }
        }
        self.segments.push(s);
    }

    /// Where a span of the expanded text stands in the original. None for an empty map.
    pub fn place(&self, span: Span) -> Option<Place> {
        if span == Span::NOWHERE {
            return None;
        }
        let at = |pos: u32| {
            let i = self
                .segments
                .partition_point(|s| s.expanded <= pos)
                .checked_sub(1)?;
            Some(self.segments[i])
        };
        let a = at(span.lo)?;
        let last = if span.hi > span.lo {
            span.hi - 1
        } else {
            span.lo
        };
        let b = at(last)?;
        let copied = |s: Segment| s.marked || s.len == s.origin_len;
        let origin = |s: Segment, pos: u32| {
            let pos = pos.min(s.expanded + s.len);
            let before = &self.expanded.as_bytes()[s.expanded as usize..pos as usize];
            let marks = match s.marked {
                true => memchr::memchr_iter(DELIMITED.as_bytes()[0], before).count(),
                false => 0,
            };
            s.origin + ((before.len() - marks) as u32).min(s.origin_len)
        };
        let lo = if copied(a) {
            origin(a, span.lo)
        } else {
            a.origin
        };
        let hi = if copied(b) {
            origin(b, last) + u32::from(span.hi > span.lo)
        } else {
            b.origin + b.origin_len
        };
        // A span that runs over two files is shown at its beginning.
        let hi = if a.file == b.file && hi >= lo {
            hi
        } else {
            a.origin + a.origin_len
        };
        let text = &self.files[a.file.0 as usize].text;
        let lo = text.len().min(lo as usize);
        let (lo, hi) = whole_characters(text, lo, (hi as usize).clamp(lo, text.len()));
        Some(Place {
            file: a.file,
            lo: lo as u32,
            hi: hi as u32,
        })
    }

    /// From here on a listing, which counts lines as they are read, is this many lines ahead of the file.
    pub(super) fn shift_listing(&mut self, shift: i64) {
        self.listing.push((self.expanded.len() as u32, shift));
    }

    /// How far a listing is ahead of the file at the end of the expanded text.
    pub(super) fn listing_shift(&self) -> i64 {
        self.listing.last().map_or(0, |l| l.1)
    }

    /// Line of a listing in which a span begins: lines of included files count, lines left out do not.
    pub fn listing_line(&self, span: Span) -> usize {
        let n = self.listing.partition_point(|l| l.0 <= span.lo);
        let shift = n.checked_sub(1).map_or(0, |n| self.listing[n].1);
        usize::try_from(self.line(span) as i64 + shift).unwrap_or(0)
    }

    /// Line (from 1) of the original text in which a span begins.
    pub fn line(&self, span: Span) -> usize {
        self.place(span).map_or(0, |p| self.file(p.file).line(p.lo))
    }
}

impl SourceFile {
    /// Line (from 1) of a byte offset.
    pub fn line(&self, offset: u32) -> usize {
        let offset = self.text.len().min(offset as usize);
        let block = (offset / BLOCK).min(self.ends_before.len().saturating_sub(1));
        let before = self.ends_before.get(block).map_or(0, |&n| n as usize);
        let behind = &self.text.as_bytes()[block * BLOCK..offset];
        1 + before + line_ends(behind) as usize
    }

    /// Where a line (from 0) begins; the end of the text, if there is none.
    fn line_start(&self, line: usize) -> usize {
        let Some(end_before) = line.checked_sub(1) else {
            return 0;
        };
        // The last block with fewer line ends before it.
        let blocks = self.ends_before.partition_point(|&n| (n as usize) < line);
        let Some(block) = blocks.checked_sub(1) else {
            return self.text.len();
        };
        let inside = end_before - self.ends_before[block] as usize;
        let text = &self.text.as_bytes()[block * BLOCK..];
        let end = memchr::memchr_iter(b'\n', text).nth(inside);
        end.map_or(self.text.len(), |n| block * BLOCK + n + 1)
    }

    /// Bytes of a line (from 0) without its line end.
    pub fn line_range(&self, line: usize) -> (usize, usize) {
        let lo = self.line_start(line);
        let rest = &self.text.as_bytes()[lo..];
        let hi = memchr::memchr(b'\n', rest).map_or(self.text.len(), |n| lo + n);
        let cr = hi > lo && rest[hi - lo - 1] == b'\r';
        (lo, hi - usize::from(cr))
    }

    /// Line and column (both from 1, column in characters) of a byte offset.
    pub fn line_column(&self, offset: u32) -> (usize, usize) {
        let line = self.line(offset).max(1);
        let start = self.line_start(line - 1);
        let upto = self.text.get(start..offset as usize).unwrap_or("");
        (line, upto.chars().count() + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines of a text of several blocks, with blocks that end at a line end, in a line and between `\r` and `\n`.
    #[test]
    fn lines_are_found_in_blocks() {
        for last in ["", "\n", "end", "\r\n\r\n"] {
            for shift in 0..3 {
                let line = |n: usize| "x".repeat(n * n % 800) + ["\n", "\r\n"][n % 2];
                let text: String = (0..200).map(line).collect();
                let text = "-".repeat(shift) + &text + last;
                assert!(text.len() > 3 * BLOCK);
                let mut map = SourceMap::default();
                let id = map.add_file("f", text.clone());
                let (mut at, mut count) = (0, 0);
                for (n, line) in text.split_inclusive('\n').enumerate() {
                    let shown = line.trim_end_matches('\n').trim_end_matches('\r');
                    assert_eq!(map.file(id).line_range(n), (at, at + shown.len()));
                    for offset in [at, at + line.len() - 1] {
                        assert_eq!(map.file(id).line(offset as u32), n + 1);
                        let column = offset - at + 1;
                        let found = map.file(id).line_column(offset as u32);
                        assert_eq!(found, (n + 1, column));
                    }
                    (at, count) = (at + line.len(), n + 1);
                }
                let end = count + usize::from(text.ends_with('\n'));
                assert_eq!(map.file(id).line(at as u32), end);
                assert_eq!(map.file(id).line_range(end + 1), (at, at));
            }
        }
    }
}
