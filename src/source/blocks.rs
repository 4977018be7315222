//! Directives that concern several lines: comments, `$goto`, `$onEcho`, `$onPut`.

use super::directives::{file_name, tag_of};
use super::line::Line;
use super::preprocess::Preprocessor;
use super::{FileId, Outcome};
use crate::diag::Diagnostic;
use crate::source::Span;

impl Preprocessor<'_> {
    /// `$onText … $offText`: what stands between is not read.
    pub(super) fn comment_block(&mut self, line: &Line) -> Outcome<()> {
        if self.collect_to("offtext", "", &mut |_, _| {}) {
            return Ok(());
        }
        let (lo, hi) = line.origin(0, line.text.len());
        let span = self.place(lo, hi);
        Diagnostic::error("E0101", span)
            .says("`$onText` without its `$offText`")
            .help("the rest of the file is a comment: close it with `$offText` in the first column")
            .refuse()
    }

    /// Passes over lines up to the one that begins with a directive and its tag, and shows each.
    pub(super) fn collect_to(
        &mut self,
        word: &str,
        tag: &str,
        each: &mut dyn FnMut(&str, u32),
    ) -> bool {
        loop {
            let Some(frame) = self.frames.last() else {
                return false;
            };
            let (pos, len) = (frame.pos, frame.len);
            if pos >= len {
                return false;
            }
            let end = self.line_end(pos);
            let raw = self.raw(pos, end);
            let name = self.marks.directive_name(raw);
            let found = name.is_some_and(|(name, at)| {
                name.eq_ignore_ascii_case(word) && tag_of(raw, at).0.eq_ignore_ascii_case(tag)
            });
            if !found {
                each(raw.trim_end_matches(['\n', '\r']), pos as u32);
            }
            self.advance(end);
            if found {
                return true;
            }
        }
    }

    pub(super) fn goto(&mut self, rest: &str, lo: u32, hi: u32) -> Outcome<()> {
        let label = rest.split_whitespace().next().unwrap_or("");
        let label = label.to_ascii_lowercase();
        let marks = self.marks.clone();
        let limit = self.max_jumps;
        let listed = self.listed();
        let Some(frame) = self.frames.last_mut() else {
            return Ok(());
        };
        let jumps = frame.jumps.entry(label.clone()).or_default();
        *jumps += 1;
        if *jumps > limit {
            frame.pos = frame.len;
            frame.ifs.clear();
            let span = self.place(lo, hi);
            return Diagnostic::error("E0116", span)
                .says(format!(
                    "`$goto {label}` was followed {limit} times: it does not end"
                ))
                .help("`$maxGoto n` allows more")
                .refuse();
        }
        let text = &self.map.file(frame.file).text;
        let mut pos = 0;
        while pos < text.len() {
            let end =
                memchr::memchr(b'\n', &text.as_bytes()[pos..]).map_or(text.len(), |n| pos + n + 1);
            let line = &text[pos..end];
            if let Some((name, at)) = marks.directive_name(line)
                && name.eq_ignore_ascii_case("label")
                && let Some(l) = line[at..].split_whitespace().next()
                && l.eq_ignore_ascii_case(&label)
            {
                // A label that ends the skipping is not listed.
                let ends = i64::from(pos >= frame.pos);
                frame.pos = pos;
                frame.forget_marks();
                self.set_listed(listed - ends);
                return Ok(());
            }
            pos = end;
        }
        let span = self.place(lo, hi);
        Diagnostic::error("E0116", span)
            .says(format!("there is no `$label {label}` in this file"))
            .help("labels are looked for in the file of the `$goto` only")
            .refuse()
    }

    /// Remembers what `$echo` writes: a later `$include`, and the run, may read it; the run writes it.
    pub(super) fn echo(&mut self, file: &str, text: &str, append: bool, span: Span) {
        let name = file.trim();
        let written = self.map.written.entry(name.to_lowercase()).or_default();
        if written.name.is_empty() {
            written.name = name.to_owned();
        }
        if !append {
            written.bytes.clear();
        }
        written.bytes.extend_from_slice(text.as_bytes());
        written.span = span;
    }

    pub(super) fn echo_block(
        &mut self,
        line: &Line,
        word: &str,
        tag: &str,
        rest: &str,
        lo: u32,
        hi: u32,
    ) -> Outcome<()> {
        let append = rest.trim_start().starts_with(">>");
        let file = file_name(rest.trim_start().trim_start_matches('>')).to_owned();
        let mut lines: Vec<(String, u32)> = Vec::new();
        let closed = self.collect_to("offecho", tag, &mut |t, at| lines.push((t.to_owned(), at)));
        let mut text = String::new();
        for (t, at) in lines {
            if word == "onechov" {
                text.push_str(&t);
            } else {
                let file = line.file();
                text.push_str(&self.substituted(Line::new(file, at, &t))?.text);
            }
            text.push('\n');
        }
        let span = self.place(lo, hi);
        self.echo(&file, &text, append, span);
        if closed {
            return Ok(());
        }
        self.unclosed(word, "$offEcho", tag, (lo, hi))
    }

    /// `$onPut … $offPut`: each line becomes a `put` of its text.
    pub(super) fn put_block(&mut self, word: &str, tag: &str, lo: u32, hi: u32) -> Outcome<()> {
        let mut lines: Vec<(String, u32)> = Vec::new();
        let closed = self.collect_to("offput", tag, &mut |t, at| lines.push((t.to_owned(), at)));
        let file = self.frames.last().map_or(FileId(0), |f| f.file);
        for (t, at) in lines {
            let len = t.len() as u32;
            let line = Line::new(file, at, &t);
            let t = match word {
                "onputs" => self.substituted(line)?.text,
                _ => t,
            };
            let mut put = String::from("put ");
            let mut rest = t.as_str();
            while !rest.is_empty() {
                // A text holds one kind of quote at most.
                let q = if rest.starts_with('\'') { '"' } else { '\'' };
                let n = rest.find(q).unwrap_or(rest.len());
                put.push(q);
                put.push_str(&rest[..n]);
                put.push(q);
                put.push(' ');
                rest = &rest[n..];
            }
            put.push_str("/;\n");
            self.map.push_substitute(&put, file, at, at + len);
        }
        if closed {
            return Ok(());
        }
        self.unclosed(word, "$offPut", tag, (lo, hi))
    }

    fn unclosed(&mut self, word: &str, end: &str, tag: &str, at: (u32, u32)) -> Outcome<()> {
        let span = self.place(at.0, at.1);
        let end = match tag {
            "" => end.to_owned(),
            _ => format!("{end}.{tag}"),
        };
        Diagnostic::error("E0101", span)
            .says(format!("`${word}` without its `{end}`"))
            .help(format!("close it with `{end}` in the first column"))
            .refuse()
    }
}
