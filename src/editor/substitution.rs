//! What the preprocessor puts in the place of a word: `%name%`, and macros.

use super::Editor;
use super::lines::{LineKind, directive};
use super::place::{Location, Position, Range};
use super::project::Document;
use crate::source::Marks;
use crate::syntax::words;

/// A directive that says what stands for a word.
struct Given<'a> {
    location: Location,
    /// `$set name text`, as it stands.
    text: &'a str,
}

/// The name at a place, and whether it stands between `%`.
fn name_at(d: &Document, at: usize) -> Option<(usize, usize, bool)> {
    let bytes = d.text.as_bytes();
    let part = |b: u8| b.is_ascii_alphanumeric() || b == b'_';
    let mut at = at;
    if bytes.get(at) == Some(&b'%') && !at.checked_sub(1).is_some_and(|b| part(bytes[b])) {
        at += 1;
    }
    let lo = at
        - bytes[..at.min(bytes.len())]
            .iter()
            .rev()
            .take_while(|b| part(**b))
            .count();
    let hi = words::word_end(bytes, lo);
    let between = lo > 0 && bytes[lo - 1] == b'%' && bytes.get(hi) == Some(&b'%');
    (lo < hi).then_some((lo, hi, between))
}

impl Document {
    /// The directives of a text that say what stands for a name, in their order.
    fn givers<'a>(
        &'a self,
        name: &'a str,
        between: bool,
    ) -> impl Iterator<Item = (usize, usize)> + 'a {
        let lines = &self.scan.lines;
        let directives = (0..lines.kinds.len()).filter(|n| lines.kinds[*n] == LineKind::Directive);
        directives.flat_map(move |n| {
            let r = lines.range(n, &self.text);
            let line = &self.text[r.lo..r.hi];
            // `$if not set name $set name text`: each `$` may begin one.
            line.match_indices('$').filter_map(move |(at, _)| {
                let (word, rest) = directive(&line[at..], &Marks::new(false))?;
                let rest = rest.strip_prefix(".set").unwrap_or(rest).trim_start();
                let given = &rest[..words::word_end(rest.as_bytes(), 0)];
                let gives = match between {
                    true => word.starts_with("set") || word.starts_with("eval"),
                    false => word == "macro",
                };
                (gives && given.eq_ignore_ascii_case(name)).then_some((r.lo + at, r.hi))
            })
        })
    }
}

impl Editor {
    /// The directives that say what stands for the `%name%` or macro at a place, in the order of the files.
    fn givers<'a>(&'a self, file: &'a str, at: Position) -> Option<(Range, Vec<Given<'a>>)> {
        let d = self.document(file)?;
        let (lo, hi, between) = name_at(d, d.offset(at))?;
        let name = &d.text[lo..hi];
        let mut out = Vec::new();
        for (file, d) in self.project(file) {
            out.extend(d.givers(name, between).map(|(lo, hi)| Given {
                location: Location {
                    file: file.to_owned(),
                    range: d.range(lo, hi),
                },
                text: d.text[lo..hi].trim_end(),
            }));
        }
        let wide = usize::from(between);
        (!out.is_empty()).then(|| (d.range(lo - wide, hi + wide), out))
    }

    /// Where the `%name%` or macro at a place is given.
    pub(super) fn substitution(&self, file: &str, at: Position) -> Vec<Location> {
        let found = self.givers(file, at).map(|f| f.1).unwrap_or_default();
        found.into_iter().map(|g| g.location).collect()
    }

    /// The directives that give the `%name%` or macro at a place, the word's place first.
    pub(super) fn substitution_text(&self, file: &str, at: Position) -> Option<(Range, String)> {
        let (range, found) = self.givers(file, at)?;
        let lines: Vec<&str> = found.iter().map(|g| g.text).collect();
        Some((range, format!("```bmod\n{}\n```", lines.join("\n"))))
    }
}
