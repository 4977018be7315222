//! Diagnostics as people read them (with miette).
//!
//! What is shown of the source is an *excerpt*: the lines of the places with one line around them,
//! long lines clipped about the place. So a message about one number in a line of 50 MB is as short
//! and as fast as any other.

use std::fmt;
use std::fmt::Write;

use miette::{
    GraphicalReportHandler, GraphicalTheme, LabeledSpan, MietteError, MietteSpanContents, Severity,
    SourceCode, SourceSpan, SpanContents,
};

use super::format::counted;
use crate::diag::{self, Diagnostic, Severity as Serious};
use crate::source::{FileId, SourceFile, SourceMap, whole_characters};

/// How diagnostics are drawn.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// With colours.
    pub color: bool,
    /// With box-drawing characters; otherwise ASCII.
    pub unicode: bool,
    /// Columns of the screen.
    pub width: usize,
}

impl Look {
    /// ASCII without colours: for files, pipes and tests.
    pub fn plain() -> Self {
        Self {
            color: false,
            unicode: false,
            width: 100,
        }
    }

    /// For a stream: colours and box drawing on a terminal, unless `NO_COLOR` is set or the terminal
    /// is a dumb one; or as [`set_color`] says.
    #[cfg(feature = "cli")]
    pub fn stream(is_terminal: bool) -> Self {
        let set = |name| std::env::var_os(name).is_some_and(|v| !v.is_empty());
        let dumb = std::env::var_os("TERM").is_some_and(|v| v == "dumb");
        let fancy = is_terminal && !dumb && !set("NO_COLOR");
        let fancy = COLOR.get().copied().flatten().unwrap_or(fancy);
        Self {
            color: fancy,
            unicode: fancy,
            width: columns(is_terminal).unwrap_or(100).min(140),
        }
    }
}

/// What `--color` said: always, never, or as the terminal is.
#[cfg(feature = "cli")]
static COLOR: std::sync::OnceLock<Option<bool>> = std::sync::OnceLock::new();

/// Colours always (true) or never (false), whatever the stream: once, before anything is written.
#[cfg(feature = "cli")]
pub fn set_color(always: Option<bool>) {
    // A second time is another run in one process, with the same command line.
    let _ = COLOR.set(always);
}

/// Columns of the screen, 40 at least: `COLUMNS`, or what the terminal says.
#[cfg(feature = "cli")]
pub fn columns(is_terminal: bool) -> Option<usize> {
    let said = std::env::var("COLUMNS").ok().and_then(|c| c.parse().ok());
    let terminal = || Some(usize::from(terminal_size::terminal_size()?.0.0));
    let columns = said.or_else(|| is_terminal.then(terminal).flatten());
    columns.map(|c: usize| c.max(40))
}

/// Columns of a source line that are shown.
const LINE: usize = 160;
/// Lines of a place that are shown; a longer one is shown at its first line.
const LINES: usize = 6;

/// All diagnostics as text, in order, a blank line after each.
pub fn render(diagnostics: &[Diagnostic], map: &SourceMap, look: Look) -> String {
    let theme = match (look.unicode, look.color) {
        (true, true) => GraphicalTheme::unicode(),
        (true, false) => GraphicalTheme::unicode_nocolor(),
        (false, _) => GraphicalTheme::none(),
    };
    let handler = GraphicalReportHandler::new_themed(theme)
        .with_width(look.width)
        .with_context_lines(1)
        .with_links(false);
    let mut out = String::new();
    for d in diagnostics {
        let report = Report::new(d, map);
        if handler.render_report(&mut out, &report).is_err() {
            let _ = writeln!(out, "{}: {}", d.code, d.message);
        }
        out.push('\n');
    }
    out
}

/// "2 errors, 1 warning"; empty where there is none.
pub fn count(diagnostics: &[Diagnostic]) -> String {
    let kinds = [
        (Serious::Error, "error"),
        (Serious::Execution, "execution error"),
        (Serious::Warning, "warning"),
    ];
    let count = |s: Serious| diagnostics.iter().filter(|d| d.severity == s).count();
    let counts = kinds.map(|(severity, what)| (count(severity), what));
    let there = counts.into_iter().filter(|c| c.0 > 0);
    let parts: Vec<String> = there.map(|(n, what)| counted(n, what)).collect();
    parts.join(", ")
}

/// A piece of a file: whole lines, perhaps clipped.
#[derive(Debug)]
struct Chunk {
    /// Where it begins in the excerpt's text.
    start: usize,
    /// One past its last byte.
    end: usize,
    /// Line of its first byte, from 0.
    line: usize,
    /// Number of its lines.
    lines: usize,
}

/// What is shown of one file.
#[derive(Debug)]
struct Excerpt {
    name: String,
    text: String,
    chunks: Vec<Chunk>,
    /// Line and column (from 0) in the file of the place that begins here in the excerpt.
    heads: Vec<(usize, usize, usize)>,
}

impl Excerpt {
    /// The lines of these places (byte ranges of the file, in order) and where the places are in
    /// the excerpt.
    fn new(file: &SourceFile, places: &[(u32, u32)]) -> (Self, Vec<(usize, usize)>) {
        let mut excerpt = Self {
            name: file.name.clone(),
            text: String::new(),
            chunks: Vec::new(),
            heads: Vec::new(),
        };
        // What stands behind the last line end is no line.
        let lines = file.line(file.text.len() as u32) - usize::from(file.text.ends_with('\n'));
        let lines = lines.max(1);
        // Lines to show: each place with one line around it, merged where they touch.
        let mut wanted: Vec<(usize, usize)> = Vec::new();
        for &(lo, hi) in places {
            let first = file.line(lo).max(1) - 1;
            let last = file.line(hi.max(lo + 1) - 1).max(1) - 1;
            let last = if last - first >= LINES { first } else { last };
            let (from, to) = (
                first.saturating_sub(1),
                (last + 2).min(lines).max(first + 1),
            );
            match wanted.iter_mut().find(|w| from <= w.1 && to >= w.0) {
                Some(w) => *w = (w.0.min(from), w.1.max(to)),
                None => wanted.push((from, to)),
            }
        }
        // The first place is what the message is about: its lines come first.
        let about = places.first().map_or(0, |p| file.line(p.0).max(1) - 1);
        wanted.sort_unstable_by_key(|w| (!(w.0..w.1).contains(&about), *w));
        let mut shown: Vec<(usize, usize, usize)> = Vec::new(); // file offsets lo..hi, excerpt offset
        for (from, to) in wanted {
            let start = excerpt.text.len();
            for line in from..to {
                let (lo, hi) = file.line_range(line);
                let at = places
                    .iter()
                    .map(|p| p.0 as usize)
                    .find(|p| (lo..=hi).contains(p));
                let (a, b) = clip(&file.text, lo, hi, at.unwrap_or(lo));
                if a > lo {
                    excerpt.text.push_str("... ");
                }
                shown.push((a, b, excerpt.text.len()));
                excerpt.text.push_str(file.text.get(a..b).unwrap_or(""));
                if b < hi {
                    excerpt.text.push_str(" ...");
                }
                excerpt.text.push('\n');
            }
            excerpt.chunks.push(Chunk {
                start,
                end: excerpt.text.len(),
                line: from,
                lines: to - from,
            });
        }
        let find = |p: usize| {
            let before = shown.iter().filter(|s| s.0 <= p);
            let line = before.max_by_key(|s| s.0).or(shown.first());
            line.map_or(0, |s| s.2 + p.clamp(s.0, s.1) - s.0)
        };
        let found = places.iter().map(|&(lo, hi)| {
            let (lo, hi) = (lo as usize, hi as usize);
            let a = find(lo);
            let many = file.line(hi as u32).saturating_sub(file.line(lo as u32)) >= LINES;
            let b = if many {
                let end = excerpt.text[a..].find('\n').unwrap_or(0);
                a + end
            } else {
                find(hi)
            };
            (a, b.max(a) - a)
        });
        let found: Vec<(usize, usize)> = found.collect();
        for (&(at, _), &(lo, _)) in found.iter().zip(places) {
            let (line, column) = file.line_column(lo);
            excerpt.heads.push((at, line - 1, column - 1));
        }
        (excerpt, found)
    }
}

/// The part of a line `lo..hi` that is shown: all of it, or [`LINE`] bytes about `at`.
fn clip(text: &str, lo: usize, hi: usize, at: usize) -> (usize, usize) {
    if hi - lo <= LINE {
        return (lo, hi);
    }
    let start = at.saturating_sub(LINE / 4).max(lo);
    whole_characters(text, start, (start + LINE).min(hi))
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let (lo, hi) = (span.offset(), span.offset() + span.len());
        let chunk = self
            .chunks
            .iter()
            .find(|c| c.start <= lo && hi <= c.end)
            .ok_or(MietteError::OutOfBounds)?;
        // Asked without context, miette wants to know where the place itself begins.
        let head = self.heads.iter().find(|h| h.0 == lo);
        let (line, column) = match head {
            Some(&(_, line, column)) if before == 0 && after == 0 => (line, column),
            _ => (chunk.line, 0),
        };
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            self.text
                .as_bytes()
                .get(chunk.start..chunk.end)
                .unwrap_or(b""),
            (chunk.start, chunk.end - chunk.start).into(),
            line,
            column,
            chunk.lines,
        )))
    }
}

/// A diagnostic in miette's terms.
#[derive(Debug)]
struct Report {
    message: String,
    code: Option<&'static str>,
    severity: Severity,
    help: Option<String>,
    source: Option<Excerpt>,
    labels: Vec<LabeledSpan>,
    related: Vec<Report>,
}

impl Report {
    fn bare(message: &str, severity: Severity) -> Self {
        Self {
            message: message.into(),
            code: None,
            severity,
            help: None,
            source: None,
            labels: Vec::new(),
            related: Vec::new(),
        }
    }

    fn new(d: &Diagnostic, map: &SourceMap) -> Self {
        let severity = match d.severity {
            Serious::Warning => Severity::Warning,
            Serious::Error | Serious::Execution => Severity::Error,
        };
        let mut report = Self {
            code: Some(d.code),
            help: d.help.clone(),
            ..Self::bare(&d.message, severity)
        };
        let Some(place) = map.place(d.span) else {
            return report;
        };
        let mut here = vec![(place.lo, place.hi, d.label.as_str())];
        let mut elsewhere: Vec<(FileId, u32, u32, &str)> = Vec::new();
        for diag::Label { span, text } in &d.others {
            match map.place(*span) {
                Some(p) if p.file == place.file => here.push((p.lo, p.hi, text)),
                Some(p) => elsewhere.push((p.file, p.lo, p.hi, text)),
                None => {}
            }
        }
        report.show(map.file(place.file), &here);
        for (file, lo, hi, text) in elsewhere {
            let text = if text.is_empty() { "see also" } else { text };
            let mut other = Self::bare(text, Severity::Advice);
            other.show(map.file(file), &[(lo, hi, "")]);
            report.related.push(other);
        }
        report
    }

    fn show(&mut self, file: &SourceFile, places: &[(u32, u32, &str)]) {
        let spans: Vec<(u32, u32)> = places.iter().map(|p| (p.0, p.1)).collect();
        let (excerpt, found) = Excerpt::new(file, &spans);
        let of = |((k, &(at, len)), &(_, _, text)): ((usize, _), &(u32, u32, &str))| {
            let text = (!text.is_empty()).then(|| text.to_string());
            match k {
                0 => LabeledSpan::new_primary_with_span(text, (at, len)),
                _ => LabeledSpan::new_with_span(text, (at, len)),
            }
        };
        self.labels = found.iter().enumerate().zip(places).map(of).collect();
        self.source = Some(excerpt);
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Report {}

impl miette::Diagnostic for Report {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.code.map(|c| Box::new(c) as Box<dyn fmt::Display>)
    }
    fn severity(&self) -> Option<Severity> {
        Some(self.severity)
    }
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help
            .as_ref()
            .map(|h| Box::new(h) as Box<dyn fmt::Display>)
    }
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|s| s as &dyn SourceCode)
    }
    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.labels.iter().cloned()))
    }
    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn miette::Diagnostic> + 'a>> {
        if self.related.is_empty() {
            return None;
        }
        Some(Box::new(
            self.related.iter().map(|r| r as &dyn miette::Diagnostic),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::diagnostic::json_lines;
    use crate::source::Span;

    fn map(name: &str, text: &str) -> (SourceMap, Span) {
        let mut map = SourceMap::default();
        let file = map.add_file(name, text.to_string());
        let span = map.push_copy(file, 0, text.len() as u32);
        (map, span)
    }

    fn at(map: &SourceMap, what: &str) -> Span {
        let lo = map.expanded().find(what).expect("it is there") as u32;
        Span::new(lo, lo + what.len() as u32)
    }

    #[test]
    fn long_lines_and_long_places_are_clipped() {
        let text = format!(
            "parameter p / {} oops 3 {} /;",
            "a 1,".repeat(100_000),
            "ä 2,".repeat(9)
        );
        let (map, all) = map("big.blk", &text);
        let d = Diagnostic::error("E0102", at(&map, "oops")).says("no value for the label");
        let shown = render(&[d], &map, Look::plain());
        assert!(shown.len() < 600 && shown.contains("oops"), "{shown}");
        assert!(shown.contains("big.blk:1:400016"), "{shown}");
        let d = Diagnostic::error("E0102", all).says("the whole of it");
        assert!(render(&[d], &map, Look::plain()).len() < 1000);
        let lines = "x\n".repeat(10_000);
        let (map, all) = super::tests::map("tall.blk", &lines);
        let d = Diagnostic::error("E0102", all).says("the whole of it");
        assert!(render(&[d], &map, Look::plain()).lines().count() < 12);
    }

    #[test]
    fn no_place_no_harm() {
        let map = SourceMap::default();
        let d = Diagnostic::execution("E0490", Span::default()).says("nothing was read");
        assert!(render(std::slice::from_ref(&d), &map, Look::plain()).contains("nothing was read"));
        assert!(json_lines(&[d], &map).contains("\"execution\""));
        let (map, _) = super::tests::map("empty.blk", "");
        let d = Diagnostic::warning("E0109", Span::default()).says("the file is empty");
        assert!(render(&[d], &map, Look::plain()).contains("the file is empty"));
    }
}
