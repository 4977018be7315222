//! From files to the expanded text: comments, `%name%`, macros, and the lines that begin with `$`.
//!
//! The text is made piece by piece, because directives may ask what the statements before them
//! declared: [`Preprocessor::fill`] stops before every directive line, and the caller takes all
//! finished statements out of the text before it fills again.
//!
//! Runs of plain lines are found with `memchr` and copied whole; only a line with a directive, a
//! comment mark, `%` or a macro is looked at by itself (`line`).
//!
//! Invariants: the expanded text consists of whole lines; a `$` in its first column is a directive
//! that is left to the parser (`$load …;`); every byte of it leads back to a file through the
//! [`SourceMap`]; includes, macros and `$goto` are bounded.

use std::path::{Path, PathBuf};

use rustc_hash::FxHashMap;

use super::conditions::If;
use super::line::Line;
use super::macros::Macros;
use super::marks::Marks;
use super::variables::{self, Variables};
use super::{FileId, Modes, Outcome, SourceMap, Span, Switches};
use crate::data::input::Input;
use crate::diag::Diagnostic;
use crate::host::{Host, HostError};
use std::sync::Arc;

/// Files included by files.
const DEEPEST_INCLUDE: usize = 40;
/// Bytes of expanded text: places are 32-bit numbers.
const LONGEST: usize = 3 << 30;
/// Bytes of a line that `%name%` is filled in.
const LONGEST_LINE: usize = 4 << 20;
/// Bytes copied before the parser is asked to look.
const CHUNK: usize = 4 << 20;
/// Bytes looked through and copied at once: they are in the cache for the second.
const WINDOW: usize = 512 << 10;

/// Kind of a symbol, as `$if setType x` and its kin name it: `set`, `parameter`, `variable`,
/// `equation`, `model`, `file`, `acronym`, `alias`, `macro`.
pub type SymbolKindName = &'static str;

/// Options from the command line.
#[derive(Clone, Debug, Default)]
pub struct PreprocessOptions {
    /// `-D name=value`.
    pub defines: Vec<(String, String)>,
    /// A define that nothing reads is warned of.
    pub warns_of_unused: bool,
    /// The file is a `.blk`: `//` begins a comment.
    pub slash_comments: bool,
    /// What the data in the text may take, in bytes.
    pub max_memory: Option<usize>,
    /// Data from outside the text.
    pub inputs: Vec<Arc<Input>>,
    /// What `$maxGoto` may allow.
    pub most_jumps: Option<usize>,
}

/// Brings the bytes of a data file for the place that asks for it.
pub type ReadData<'a> = &'a mut dyn FnMut(&str, Span) -> Outcome<Vec<u8>>;

/// What a directive may ask about the symbols known so far.
pub trait Known {
    /// The kind of a declared symbol.
    fn kind(&self, _name: &str) -> Option<SymbolKindName> {
        None
    }
    /// Whether it has data.
    fn is_defined(&self, _name: &str) -> bool {
        false
    }
    /// Its number of indices.
    fn dimension(&self, _name: &str) -> Option<usize> {
        None
    }
    /// Number of elements of a set or of records of a parameter.
    fn card(&self, _name: &str) -> Option<usize> {
        None
    }
    /// Value of a scalar.
    fn scalar_value(&self, _name: &str) -> Option<f64> {
        None
    }
    /// Whether the language has a function of this name.
    fn is_function(&self, _name: &str) -> bool {
        false
    }
    /// Whether a solver has this name, here or in GAMS.
    fn is_solver(&self, _name: &str) -> bool {
        false
    }
    /// Whether a text is a label of some data.
    fn is_label(&self, _text: &str) -> bool {
        false
    }
    /// Whether a `put` has named a file.
    fn put_open(&self) -> bool {
        false
    }
    /// Value of a function (its name in small letters); `undf` where it has none.
    fn function_value(&self, _function: &str, _arguments: &[f64]) -> Option<f64> {
        None
    }
    /// Errors reported so far, cleared or not.
    fn errors(&self) -> usize {
        0
    }
    /// Kind and number of indices of a symbol in the file that `$gdxIn` opened, which `read` brings.
    fn in_data_file(
        &self,
        _name: &str,
        _read: ReadData<'_>,
    ) -> Result<Option<(&str, usize)>, String> {
        Err("no file is open".into())
    }
    /// What `$eval.set` asks of a set: the label (`tl`) or the text (`te`) of its first or last element,
    /// its own text (`ts`).
    fn set_text(&self, _name: &str, _what: &str) -> Option<String> {
        None
    }
}

/// For texts that stand alone: no symbol is known.
pub struct NothingKnown;

impl Known for NothingKnown {}

/// How the text ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Ending {
    /// At its end, or at `$exit`, `$stop`.
    #[default]
    Regular,
    /// `$terminate`, `$abort.noError`: nothing is run, which is no failure.
    NoRun,
    /// `$abort`, `$error`: the diagnostic was given.
    Aborted,
}

/// Stands before each line of data under `$onDelim`.
pub(crate) const DELIMITED: &str = "\u{1e}";

/// A file being read.
pub(super) struct Frame {
    pub(super) file: FileId,
    pub(super) path: PathBuf,
    pub(super) pos: usize,
    pub(super) len: usize,
    /// `$ifThen` not yet closed.
    pub(super) ifs: Vec<If>,
    /// Arguments of `$batInclude`, None for other files.
    pub(super) arguments: Option<Vec<String>>,
    /// Jumps to a label.
    pub(super) jumps: FxHashMap<String, usize>,
    /// None of these stands before: `%` or a line of a directive or a comment, end-of-line mark, inline mark, slash mark.
    ahead: [usize; 4],
    /// Where the file was asked for.
    pub(super) asked: Span,
}

impl Frame {
    /// The next marks are looked for again: reading goes on elsewhere.
    pub(super) fn forget_marks(&mut self) {
        self.ahead = [0; 4];
    }
}

/// See the module.
pub(crate) struct Preprocessor<'h> {
    pub(super) host: &'h mut dyn Host,
    pub(crate) map: SourceMap,
    pub(super) frames: Vec<Frame>,
    pub(crate) names: Variables,
    /// What `$setEnv` said, in lower case; the machine's environment is nobody's business.
    pub(super) environment: FxHashMap<String, String>,
    pub(super) macros: Macros,
    pub(super) marks: Marks,
    /// Switches and where in the expanded text they came into force; never empty.
    pub(super) modes: Vec<(u32, Modes)>,
    /// `$onEnd`: `endif`, `endloop` … close blocks.
    pub(crate) on_end: bool,
    /// Inside an inline comment that runs over lines.
    in_comment: Option<Span>,
    /// Inline comments that are open.
    comment_depth: usize,
    pub(crate) warnings: Vec<Diagnostic>,
    pub(crate) ending: Ending,
    pub(super) max_jumps: usize,
    /// What `$maxGoto` may allow.
    pub(super) most_jumps: usize,
    /// How many of the errors so far `$clearError` made warnings.
    pub(crate) cleared_errors: usize,
    /// `$if`s followed in the present line.
    pub(super) conditions_on_line: usize,
}

impl<'h> Preprocessor<'h> {
    /// Opens the main file.
    pub(crate) fn new(
        host: &'h mut dyn Host,
        path: &str,
        options: PreprocessOptions,
    ) -> Result<Self, Box<(SourceMap, Diagnostic)>> {
        let mut p = Self {
            host,
            map: SourceMap::default(),
            frames: Vec::new(),
            names: Variables::default(),
            environment: FxHashMap::default(),
            macros: Macros::default(),
            marks: Marks::new(options.slash_comments),
            modes: vec![(0, Modes::default())],
            on_end: false,
            in_comment: None,
            comment_depth: 0,
            warnings: Vec::new(),
            ending: Ending::Regular,
            max_jumps: 100,
            most_jumps: options.most_jumps.unwrap_or(1_000_000),
            cleared_errors: 0,
            conditions_on_line: 0,
        };
        p.names.set(variables::Reach::Global, "bmod", "1".into());
        for (name, value) in &options.defines {
            p.names.define(name, value.clone());
        }
        match p.host.read(path, None) {
            Ok((known_as, text)) => {
                let empty = text.trim().is_empty();
                p.open(known_as, path, text, None, Span::default());
                if empty {
                    let span = p.map.push_substitute("\n", FileId(0), 0, 0);
                    p.warnings.push(
                        Diagnostic::warning("E0109", span)
                            .says(format!("the file `{path}` is empty"))
                            .help("nothing is declared and nothing is solved"),
                    );
                }
                Ok(p)
            }
            Err(e) => {
                let file = p.map.add_file(path, String::new());
                let span = p.map.push_substitute("\n", file, 0, 0);
                let d = unreadable(path, &e, span);
                Err(Box::new((p.map, d)))
            }
        }
    }

    /// Begins to read a text.
    pub(super) fn open(
        &mut self,
        path: PathBuf,
        name: &str,
        text: String,
        arguments: Option<Vec<String>>,
        asked: Span,
    ) {
        // Files of old machines end their lines with a carriage return alone.
        let has = |byte| memchr::memchr(byte, text.as_bytes()).is_some();
        let text = if !has(b'\n') && has(b'\r') {
            text.replace('\r', "\n")
        } else {
            text
        };
        let len = text.len();
        let bom = if text.starts_with('\u{feff}') { 3 } else { 0 };
        let listed = self.listed();
        let file = self.map.add_file(name, text);
        self.names.enter();
        self.frames.push(Frame {
            file,
            path,
            pos: bom,
            len,
            ifs: Vec::new(),
            arguments,
            jumps: FxHashMap::default(),
            ahead: [0; 4],
            asked,
        });
        self.set_listed(listed);
    }

    /// Lines that a listing shows up to here.
    pub(super) fn listed(&self) -> i64 {
        let Some(frame) = self.frames.last() else {
            return 0;
        };
        let file = self.map.file(frame.file);
        let last_without_end = frame.pos == frame.len && !file.text.ends_with('\n');
        let read = file.line(frame.pos as u32) - 1 + usize::from(last_without_end);
        read as i64 + self.map.listing_shift()
    }

    /// Reading goes on elsewhere: a listing numbers the next line behind the `listed`th.
    pub(super) fn set_listed(&mut self, listed: i64) {
        let ahead = listed - self.listed();
        if ahead != 0 {
            self.map.shift_listing(self.map.listing_shift() + ahead);
        }
    }

    /// `$include` and its kin: opens a file from the present one. `lo..hi` is the directive's place.
    pub(super) fn include(
        &mut self,
        name: &str,
        arguments: Option<Vec<String>>,
        lo: u32,
        hi: u32,
    ) -> Outcome<()> {
        let asked = self.place(lo, hi);
        if name.is_empty() {
            return Diagnostic::error("E0103", asked)
                .says("the name of the file is missing")
                .help("write `$include 'file.gms'`")
                .refuse();
        }
        // The name as it is, then with GAMS's ending.
        let bare = Path::new(name).extension().is_none();
        let longer = bare.then(|| format!("{name}.gms"));
        let names = || [Some(name), longer.as_deref()].into_iter().flatten();
        let written = names().find_map(|n| self.map.written_text(n));
        let mut read = match written {
            Some(text) => Ok((PathBuf::from(name), text.to_owned())),
            None => Err(HostError::NotFound),
        };
        let from = self.frames.last().map(|f| f.path.clone());
        for n in names() {
            if !matches!(read, Err(HostError::NotFound)) {
                break;
            }
            read = self.host.read(n, from.as_deref());
        }
        let (path, text) = match read {
            Ok(found) => found,
            Err(e) => return unreadable(name, &e, asked).refuse(),
        };
        // A batch file may call itself with other arguments: that is bounded by the depth.
        let is_open = |f: &Frame| f.path == path && f.arguments.is_none();
        let itself = arguments.is_none() && self.frames.iter().any(is_open);
        if itself || self.frames.len() >= DEEPEST_INCLUDE {
            let message = match itself {
                true => format!("the file `{name}` includes itself"),
                false => format!("files are included more than {DEEPEST_INCLUDE} deep"),
            };
            let mut d = Diagnostic::error("E0105", asked)
                .says(message)
                .help("take the `$include` out, or guard it with `$if not set`");
            for frame in self.frames.iter().skip(1).take(3) {
                d = d.other(frame.asked, "included from here");
            }
            return d.refuse();
        }
        self.open(path, name, text, arguments, asked);
        Ok(())
    }

    /// The bytes of a data file, looked for beside the file that asks for it.
    pub(crate) fn read(&mut self, name: &str, at: Span) -> Outcome<Vec<u8>> {
        if let Some(bytes) = self.map.written(name) {
            return Ok(bytes.to_owned());
        }
        let place = self.map.place(at);
        let asking = place.map(|p| self.map.file(p.file).name.clone());
        let read = self.host.read_bytes(name, asking.as_deref().map(Path::new));
        read.map(|(_, bytes)| bytes)
            .map_err(|e| Box::new(unreadable(name, &e, at)))
    }

    /// A place in the present file that is not copied, as a span: a blank line stands for it.
    pub(super) fn place(&mut self, lo: u32, hi: u32) -> Span {
        let file = self.frames.last().map_or(FileId(0), |f| f.file);
        let span = self.map.push_substitute(" ", file, lo, hi);
        self.map.push_substitute("\n", file, hi, hi);
        span
    }

    /// Appends text to the expanded text, up to the next directive line. False at the end.
    pub(crate) fn fill(&mut self, known: &dyn Known) -> Result<bool, Vec<Diagnostic>> {
        let before = self.map.expanded().len();
        if before > LONGEST {
            let at = self.frames.last().map_or(0, |f| f.pos) as u32;
            self.frames.clear();
            let file = FileId(0);
            let span = self.map.push_substitute("\n", file, at, at);
            return Err(vec![
                Diagnostic::error("E0108", span)
                    .says("the text is longer than 3 GB with all its includes")
                    .help("split the model, or read the data with `execute_load`"),
            ]);
        }
        let alone = |d: Box<Diagnostic>| vec![*d];
        loop {
            let grown = self.map.expanded().len() - before;
            let Some(frame) = self.frames.last() else {
                return Ok(grown > 0);
            };
            if grown > CHUNK {
                return Ok(true);
            }
            if frame.pos >= frame.len {
                self.leave().map_err(alone)?;
                continue;
            }
            let (file, pos) = (frame.file, frame.pos);
            let first = self.map.file(file).text.as_bytes()[pos];
            if self.in_comment.is_none() {
                if first == self.marks.comment {
                    let end = self.line_end(pos);
                    self.advance(end);
                    continue;
                }
                if first == self.marks.dollar {
                    if grown > 0 {
                        return Ok(true);
                    }
                    let line = self.take_line();
                    self.directive_text(line)
                        .and_then(|l| self.directive_line(l, known))
                        .map_err(alone)?;
                    continue;
                }
                let end = self.plain_end(pos);
                if end > pos {
                    match self.marks.delimited {
                        true => self.map.push_marked(file, pos as u32, end as u32),
                        false => _ = self.map.push_copy(file, pos as u32, end as u32),
                    }
                    self.advance(end);
                    self.end_line(end);
                    continue;
                }
            }
            let line = self.take_line();
            let l = self.substituted(line).map_err(alone)?;
            let first = l.text.as_bytes().first();
            if self.in_comment.is_none() && first == Some(&self.marks.comment) {
                continue;
            }
            let directive = self.in_comment.is_none() && self.marks.directive(&l.text).is_some();
            if directive && grown > 0 {
                // Statements before it come first.
                self.advance(pos);
                return Ok(true);
            }
            let outcome = match directive {
                true => {
                    let l = self.without_comments(l);
                    self.directive_line(l, known)
                }
                false => self.finish_text(l, 0),
            };
            outcome.map_err(alone)?;
        }
    }

    /// The switches in force over a part of the expanded text.
    pub(crate) fn switches(&self, part: Span) -> Switches {
        let first = self.modes.partition_point(|(from, _)| *from <= part.lo);
        let end = self.modes.partition_point(|(from, _)| *from < part.hi);
        let first = first.max(1) - 1;
        Switches::new(&self.modes[first..end.max(first + 1)])
    }

    /// Goes on reading the present file at `pos`.
    pub(super) fn advance(&mut self, pos: usize) {
        if let Some(frame) = self.frames.last_mut() {
            frame.pos = pos.min(frame.len);
        }
    }

    /// The byte after the line end that follows `pos` in the present file.
    pub(super) fn line_end(&self, pos: usize) -> usize {
        let Some(frame) = self.frames.last() else {
            return pos;
        };
        let bytes = self.map.file(frame.file).text.as_bytes();
        memchr::memchr(b'\n', &bytes[pos..]).map_or(bytes.len(), |n| pos + n + 1)
    }

    /// The text of `from..to` of the present file.
    pub(super) fn raw(&self, from: usize, to: usize) -> &str {
        let text = self
            .frames
            .last()
            .map_or("", |f| &self.map.file(f.file).text);
        text.get(from..to).unwrap_or("")
    }

    /// Makes sure that the expanded text ends with a line end.
    fn end_line(&mut self, pos: usize) {
        if !self.map.expanded().is_empty() && !self.map.expanded().ends_with('\n') {
            let file = self.frames.last().map_or(FileId(0), |f| f.file);
            self.map.push_substitute("\n", file, pos as u32, pos as u32);
        }
    }

    /// Takes the next line of the present file, without its end.
    pub(super) fn take_line(&mut self) -> Line {
        let (file, pos) = match self.frames.last() {
            Some(f) => (f.file, f.pos),
            None => (FileId(0), 0),
        };
        let end = self.line_end(pos);
        let text = self.raw(pos, end);
        let text = text.strip_suffix('\n').unwrap_or(text);
        let text = text.strip_suffix('\r').unwrap_or(text);
        let line = Line::new(file, pos as u32, text);
        self.advance(end);
        line
    }

    /// End of the run of lines from `pos` on that can be copied as they are.
    fn plain_end(&mut self, pos: usize) -> usize {
        if !self.macros.is_empty() || self.marks.columns != (1, usize::MAX) {
            return pos;
        }
        let Some(frame) = self.frames.last_mut() else {
            return pos;
        };
        let bytes = self.map.file(frame.file).text.as_bytes();
        let marks = &self.marks;
        let far = bytes.len().min(pos + WINDOW);
        let end = memchr::memchr(b'\n', &bytes[far..]).map_or(bytes.len(), |n| far + n + 1);
        let find =
            |needle: &[u8]| memchr::memmem::find(&bytes[pos..end], needle).map_or(end, |n| pos + n);
        for (i, at) in frame.ahead.iter_mut().enumerate() {
            if *at > pos {
                continue;
            }
            *at = match i {
                0 => memchr::memchr3_iter(b'%', marks.dollar, marks.comment, &bytes[pos..end])
                    .map(|n| pos + n)
                    .find(|&at| {
                        let doubled = || bytes.get(at + 1) == Some(&marks.dollar);
                        bytes[at] == b'%'
                            || bytes[at] == marks.dollar && doubled()
                            || at > pos && bytes[at - 1] == b'\n'
                    })
                    .unwrap_or(end),
                1 if marks.eol_on => find(&marks.eol),
                2 if marks.inline_on => find(&marks.inline.0),
                3 if marks.slashes => find(b"//"),
                _ => end,
            };
        }
        let mark = frame.ahead.into_iter().min().unwrap_or(end);
        if mark >= bytes.len() {
            return bytes.len();
        }
        memchr::memrchr(b'\n', &bytes[pos..mark]).map_or(pos, |n| pos + n + 1)
    }

    /// Forgets where the next marks are: the marks have changed.
    pub(super) fn marks_changed(&mut self) {
        self.frames.iter_mut().for_each(Frame::forget_marks);
    }

    /// The present file ends.
    fn leave(&mut self) -> Outcome<()> {
        let Some(frame) = self.frames.last() else {
            return Ok(());
        };
        let pos = frame.len;
        self.end_line(pos);
        let open = self.frames.last_mut().and_then(|f| f.ifs.drain(..).next());
        let comment = self.in_comment.take();
        self.comment_depth = 0;
        let listed = self.listed();
        self.frames.pop();
        self.set_listed(listed);
        self.names.leave();
        if let Some(open) = open {
            return Diagnostic::error("E0106", open.span)
                .says("this `$ifThen` is never closed")
                .help("every `$ifThen` needs its `$endIf` in the same file")
                .refuse();
        }
        if let Some(span) = comment {
            return Diagnostic::error("E0101", span)
                .says("this comment is never closed")
                .help("close it with the mark that `$inlineCom` set")
                .refuse();
        }
        Ok(())
    }

    /// Ends the text here, whatever files are open.
    pub(super) fn stop(&mut self, ending: Ending) {
        self.ending = ending;
        while self.frames.pop().is_some() {
            self.names.leave();
        }
    }

    /// Puts what they stand for in the place of `%name%` and `%1`.
    pub(super) fn substituted(&mut self, mut line: Line) -> Outcome<Line> {
        if !line.text.contains('%') {
            return Ok(line);
        }
        let mut changes = Vec::new();
        let bytes = line.text.as_bytes();
        let mut at = 0;
        while let Some(n) = memchr::memchr(b'%', &bytes[at..]) {
            let from = at + n;
            if self.marks.escape.is_some() && bytes.get(from + 1).copied() == self.marks.escape {
                changes.push((from, from + 2, "%".to_owned()));
                at = from + 2;
                continue;
            }
            let ends = |c: &u8| !c.is_ascii_alphanumeric() && !b"_. -".contains(c);
            let name_end = bytes[from + 1..].iter().position(ends);
            let name_end = name_end.map_or(bytes.len(), |n| from + 1 + n);
            if bytes.get(name_end) == Some(&b'%') && name_end > from + 1 {
                let (lo, _) = line.origin(from, name_end);
                if let Some(value) = self.value(&line.text[from + 1..name_end], lo) {
                    changes.push((from, name_end + 1, value));
                    at = name_end + 1;
                    continue;
                }
            }
            let behind = bytes[from + 1..].iter();
            let digits = behind.take_while(|c| c.is_ascii_digit()).count();
            if digits > 0
                && let Some(frame) = self.frames.last()
                && !(frame.arguments.is_none() && in_text(&line.text, from, self.marks.dollar))
            {
                // What `$batInclude` did not give is empty; `%0` is the file itself.
                let end = from + 1 + digits;
                let number: usize = line.text[from + 1..end].parse().unwrap_or(usize::MAX);
                let value = match (number.checked_sub(1), &frame.arguments) {
                    (None, _) => frame.path.display().to_string(),
                    (Some(n), Some(args)) => args.get(n).cloned().unwrap_or_default(),
                    _ => String::new(),
                };
                changes.push((from, end, value));
                at = end;
                continue;
            }
            at = from + 1;
        }
        let grown: usize = changes.iter().map(|c| c.2.len()).sum();
        if grown > LONGEST_LINE {
            let (lo, hi) = line.origin(0, line.text.len());
            let span = self.place(lo, hi);
            return Diagnostic::error("E0108", span)
                .says("with its `%name%` filled in, this line is longer than 4 MB")
                .help("a name that stands for itself twice doubles with each `$set`")
                .refuse();
        }
        line.replace(&changes);
        Ok(line)
    }

    /// What `%name%` stands for at byte `lo` of the present file.
    fn value(&mut self, name: &str, lo: u32) -> Option<String> {
        let constant = || variables::constant(name).map(|n| n.to_string());
        if name.contains([' ', '-']) {
            // `%solveStat.Capability Problems%`, `%modelStat.Infeasible-No Solution%`
            return constant();
        }
        if let Some(v) = self.names.get(name).map(str::to_owned).or_else(constant) {
            return Some(v);
        }
        let lower = name.to_ascii_lowercase();
        if let Some(item) = lower.strip_prefix("system.") {
            return self.system(item, lo);
        }
        if let Some(item) = lower.strip_prefix("gams.") {
            return Some(match item {
                "workdir" | "wdir" | "curdir" | "scrdir" | "sdir" => "./".into(),
                "limrow" | "limcol" => "3".into(),
                "pw" | "pagewidth" => "255".into(),
                "input" => self.system("fn", lo)? + &self.system("fe", lo)?,
                "ps" | "pagesize" | "errmsg" | "error" | "optfile" | "logoption" | "lo"
                | "optca" | "savepoint" | "profile" | "domlim" | "holdfixed" | "workspace"
                | "sysout" | "forcework" | "tracelevel" => "0".into(),
                "solprint" | "solveopt" | "threads" | "appendout" => "1".into(),
                "solvelink" => "2".into(),
                "optcr" => "0.0001".into(),
                "seed" => "3141".into(),
                "reslim" => "10000000000".into(),
                "iterlim" => "2147483647".into(),
                _ => String::new(),
            });
        }
        if let Some(name) = lower.strip_prefix("sysenv.") {
            return self.environment.get(name).cloned();
        }
        None
    }

    fn system(&mut self, item: &str, lo: u32) -> Option<String> {
        let main = self.frames.first()?.path.clone();
        let text =
            |p: Option<&std::ffi::OsStr>| p.unwrap_or_default().to_string_lossy().into_owned();
        let dotted = |p: Option<&std::ffi::OsStr>| {
            p.map_or(String::new(), |s| format!(".{}", s.to_string_lossy()))
        };
        let now = self.host.now();
        Some(match item {
            "fn" => text(main.file_stem()),
            "fe" => dotted(main.extension()),
            "fp" => match main.parent() {
                Some(p) if !p.as_os_str().is_empty() => format!("{}/", p.display()),
                _ => "./".into(),
            },
            "ifile" | "sfile" | "incname" => self.frames.last()?.path.display().to_string(),
            "incparentl" => self.map.line(self.frames.last()?.asked).to_string(),
            "incparent" => {
                let parent = self.frames.iter().rev().nth(1);
                parent.map_or(String::new(), |f| f.path.display().to_string())
            }
            "line" | "incline" | "listline" | "prline" => {
                self.map.file(self.frames.last()?.file).line(lo).to_string()
            }
            "date" | "rdate" | "date1" => super::directives::date_text(now),
            "time" | "rtime" => super::directives::time_text(now),
            "title" => self.map.title.clone().unwrap_or_default(),
            "filesys" => "UNIX".into(),
            "dirsep" => "/".into(),
            "tab" => "\t".into(),
            "nullfile" => "/dev/null".into(),
            "platform" | "hostplatform" => "LEX".into(),
            "version" => "GAMS Rev 546".into(),
            "gamsversion" => "546".into(),
            "gamsrelease" => "54.6".into(),
            "gamsreleasemaint" => "54.6.1".into(),
            "verid" => "LEX546-546".into(),
            "buildcode" => "LEG".into(),
            "errorlevel" | "page" | "redirlog" | "licenselevel" | "isalphabeta" => "0".into(),
            "memory" | "tstart" | "tcomp" | "texec" | "tclose" | "elapsed" => "0".into(),
            "username" | "computername" | "prpage" | "opage" | "gstring" | "sstring" | "pfile" => {
                String::new()
            }
            "lp" | "nlp" | "mcp" | "rmip" | "qcp" | "dnlp" | "cns" | "mpec" | "mip" | "minlp"
            | "rminlp" | "rmiqcp" | "miqcp" => "bmod".into(),
            _ => return None,
        })
    }

    /// The rest of a line from `from` on: comments and macros, then into the expanded text.
    pub(super) fn finish_text(&mut self, mut line: Line, from: usize) -> Outcome<()> {
        let mut end = self.strip_comments(&mut line, from, false);
        let (first, last) = self.marks.columns;
        if (first, last) != (1, usize::MAX) {
            end = end.min(byte_of_column(&line.text, last.saturating_add(1)));
            let start = byte_of_column(&line.text, first).min(end);
            if start > 0 {
                line.replace(&[(0, start, " ".repeat(start))]);
            }
        }
        if !self.macros.is_empty() {
            match self.macros.calls(&line.text[..end]) {
                Ok(calls) => {
                    let tail = line.text.len() - end;
                    line.replace(&calls);
                    end = line.text.len() - tail;
                }
                Err(e) => {
                    let (lo, hi) = line.origin(e.from, e.to);
                    let span = self.place(lo, hi);
                    return Diagnostic::error("E0111", span)
                        .says(e.message)
                        .help(e.help)
                        .refuse();
                }
            }
        }
        if self.marks.delimited && !line.text[from..end].trim().is_empty() {
            let (lo, _) = line.origin(from, end);
            let file = line.file();
            self.map.push_substitute(DELIMITED, file, lo, lo);
        }
        line.emit(&mut self.map, from, end);
        let (_, hi) = line.origin(0, line.text.len());
        let file = self.frames.last().map_or(FileId(0), |f| f.file);
        self.map.push_substitute("\n", file, hi, hi);
        Ok(())
    }

    /// A line of directives with its names filled in, and without its comments.
    pub(super) fn directive_text(&mut self, line: Line) -> Outcome<Line> {
        let line = self.without_comments(line);
        self.substituted(line)
    }

    /// A line of directives without its comments: a `//` in the value of a `%name%` is none. Where marks of comments
    /// are named, they stay.
    pub(super) fn without_comments(&mut self, mut line: Line) -> Line {
        let lower = line.text.to_ascii_lowercase();
        if !lower.contains("eolcom") && !lower.contains("inlinecom") {
            let end = self.strip_comments(&mut line, 0, true);
            line.replace(&[(end, line.text.len(), String::new())]);
        }
        line
    }

    /// Blanks comments out; gives the end of what counts.
    fn strip_comments(&mut self, line: &mut Line, from: usize, directive: bool) -> usize {
        let m = &self.marks;
        if !m.eol_on && !m.inline_on && !m.slashes && self.in_comment.is_none() {
            return line.text.len();
        }
        let bytes = line.text.as_bytes();
        let found = m.comments(bytes, from, directive, &mut self.comment_depth);
        let mut end = found.end;
        if let Some(at) = found.opened {
            let (lo, hi) = line.origin(at, at + m.inline.0.len());
            self.in_comment = Some(self.place(lo, hi));
        } else if self.comment_depth == 0 {
            self.in_comment = None;
        }
        let inline = found.pieces.into_iter();
        let changes: Vec<_> = inline
            .map(|(a, b)| (a, b, " ".repeat(line.text[a..b].chars().count())))
            .collect();
        if !changes.is_empty() {
            let tail = line.text.len() - end;
            line.replace(&changes);
            end = line.text.len() - tail;
        }
        end
    }
}

/// If a quoted text begins at `i`, the byte after its end. An apostrophe inside a word and a quote
/// without its partner on the line begin nothing.
pub(crate) fn quoted_end(bytes: &[u8], i: usize) -> Option<usize> {
    let q = bytes[i];
    let in_word = i > 0 && bytes[i - 1].is_ascii_alphanumeric();
    if !matches!(q, b'\'' | b'"') || in_word {
        return None;
    }
    let rest = &bytes[i + 1..];
    let n = memchr::memchr2(q, b'\n', rest)?;
    (rest[n] == q).then_some(i + n + 2)
}

/// The bytes from a place on that are outside of quotes: each with its place and the number of parentheses around it, of
/// which an opening one counts itself, a closing one not.
pub(crate) fn outside_quotes(
    bytes: &[u8],
    from: usize,
) -> impl Iterator<Item = (usize, u8, usize)> + '_ {
    let (mut next, mut depth) = (from, 0usize);
    std::iter::from_fn(move || {
        let at = next;
        let b = *bytes.get(at)?;
        next += 1;
        match b {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            b'\'' | b'"' => next += memchr::memchr(b, &bytes[next..]).map_or(0, |n| n + 1),
            _ => {}
        }
        Some((at, b, depth))
    })
}

/// Whether a byte stands in a quoted text of a line that is no directive: there `%1` is text, such as `'%8.5f'`,
/// unless the file got arguments.
fn in_text(line: &str, at: usize, dollar: u8) -> bool {
    if line.as_bytes().first() == Some(&dollar) {
        return false;
    }
    let mut quote = None;
    for b in line.bytes().take(at) {
        match quote {
            Some(q) if b == q => quote = None,
            None if matches!(b, b'\'' | b'"') => quote = Some(b),
            _ => {}
        }
    }
    quote.is_some()
}

fn byte_of_column(text: &str, column: usize) -> usize {
    text.char_indices()
        .nth(column.saturating_sub(1))
        .map_or(text.len(), |(i, _)| i)
}

/// The diagnostic for a file that cannot be read.
fn unreadable(name: &str, e: &HostError, span: Span) -> Diagnostic {
    match e {
        HostError::NotFound => Diagnostic::error("E0103", span)
            .says(format!("the file `{name}` is not there"))
            .help("paths are relative to the file that asks, then to the current directory"),
        HostError::Outside(p) => Diagnostic::error("E0104", span)
            .says(format!(
                "the file `{name}` lies outside the folders that may be read ({})",
                p.display()
            ))
            .help("put it beside the model, or allow its folder: `--allow-read DIR`"),
        HostError::NotUtf8(at) => Diagnostic::error("E0102", span)
            .says(format!(
                "the file `{name}` is not UTF-8 text: byte {at} is not part of a character"
            ))
            .help("save it as UTF-8, for example with `iconv -f LATIN1 -t UTF-8`"),
        HostError::Compressed => Diagnostic::error("E0102", span)
            .says(format!("the file `{name}` was compressed by GAMS"))
            .help("GAMS unpacks it: `$decompress FILE PLAIN`; bmod reads the plain text"),
        HostError::Other(why) => Diagnostic::error("E0103", span)
            .says(format!("the file `{name}` cannot be read: {why}"))
            .help("check the path and the permissions"),
    }
}
