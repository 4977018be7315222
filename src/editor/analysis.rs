//! Compiling a model for an editor: the program, and what is wrong with it, file by file.

use super::Editor;
use super::navigate::Edit;
use super::place::{LineIndex, Location, Range};
use super::project::{Document, ProjectHost, has_slashes};
use crate::check::{self, Program};
use crate::diag::{self, Severity};
use crate::solve::registry::SOLVERS;
use crate::source::{PreprocessOptions, SourceMap, Span};
use rustc_hash::FxHashMap;
use serde::Serialize;
use std::path::PathBuf;

/// What data in a text may take while it is being written: a slip of the pen must not fill the memory.
const MAX_MEMORY: usize = 512 << 20;

/// What `$maxGoto` may allow there: a tenth of what it may in a run.
const MOST_JUMPS: usize = 100_000;

/// What is known about a main file.
pub(super) struct Analysis {
    /// The files that it consists of, in the order in which they were read; itself first.
    pub files: Vec<String>,
    /// What compiled, as far as it did.
    pub program: Option<Program>,
    /// The last program without errors, if that is another.
    pub good: Option<Program>,
    /// Files that diagnostics were given for.
    told: Vec<String>,
}

/// What is wrong in a file.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct FileDiagnostics {
    /// The file.
    pub file: String,
    /// In the order of the text; empty if nothing is wrong any more.
    pub diagnostics: Vec<Diagnostic>,
}

/// An error or a warning.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Diagnostic {
    /// Where.
    pub range: Range,
    /// 1 an error, 2 a warning.
    pub severity: u8,
    /// `E0301`; `docs/errors.md` has them all.
    pub code: &'static str,
    /// The problem, what is at its place, and how to fix it.
    pub message: String,
    /// Other places that belong to it.
    pub related: Vec<Related>,
    /// Changes that mend it.
    pub fixes: Vec<Fix>,
}

/// A second place of a diagnostic.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Related {
    /// Where.
    pub location: Location,
    /// What is there.
    pub message: String,
}

/// A change that mends what is wrong.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Fix {
    /// What it does, for a menu.
    pub title: String,
    /// The changes.
    pub edits: Vec<Edit>,
}

impl Analysis {
    /// The programs that may know an answer, the newest first.
    pub(super) fn programs(&self) -> impl Iterator<Item = &Program> {
        self.program.iter().chain(&self.good)
    }

    /// A place of the newest program as one in a file.
    pub(super) fn location(&self, map: &SourceMap, span: Span) -> Option<Location> {
        let p = map.place(span)?;
        let file = self.files.get(p.file.0 as usize)?.clone();
        let text = &map.file(p.file).text;
        let index = LineIndex::new(text);
        Some(Location {
            file,
            range: index.range(text, p.lo as usize, p.hi as usize),
        })
    }
}

/// A program with what is wrong with it; or what is wrong, and with which texts.
type Compiled = (Option<Program>, Vec<diag::Diagnostic>, Option<SourceMap>);

impl Editor {
    /// Compiles a model from open texts and others; with the names in it, and the paths they stand for.
    fn compile(
        &self,
        open: &FxHashMap<String, Document>,
        main: &str,
    ) -> (Compiled, Vec<(String, PathBuf)>) {
        let mut host = ProjectHost {
            open,
            files: self.files.as_deref(),
            known: Vec::new(),
        };
        let options = PreprocessOptions {
            slash_comments: has_slashes(main),
            max_memory: Some(MAX_MEMORY),
            most_jumps: Some(MOST_JUMPS),
            ..PreprocessOptions::default()
        };
        let compiled = match check::compile(&mut host, main, options, &SOLVERS) {
            Ok(mut p) => {
                let found = std::mem::take(&mut p.diagnostics);
                (Some(p), found, None)
            }
            Err(e) => (None, vec![e.0], Some(e.1)),
        };
        (compiled, host.known)
    }

    /// What keeps a model from running, with these texts open.
    pub(super) fn errors(&self, open: &FxHashMap<String, Document>, main: &str) -> Vec<String> {
        let found = self.compile(open, main).0.1.into_iter();
        found
            .filter(|d| d.severity != Severity::Warning)
            .map(|d| d.message)
            .collect()
    }

    /// Compiles the model that a file belongs to, and says what is wrong in each of its files: those where something is, the
    /// file itself, and those where something was.
    pub fn check(&mut self, file: &str) -> Vec<FileDiagnostics> {
        let main = self.main_of(file);
        if main != file {
            // It was checked by itself before anything included it.
            self.analyses.remove(file);
        }
        let (compiled, known) = self.compile(&self.open, &main);
        let before = self.analyses.remove(&main);
        let (told_before, last, good) = match before {
            Some(a) => (a.told, a.program, a.good),
            None => (Vec::new(), None, None),
        };
        let (program, found, map) = compiled;
        let wrong = found.iter().any(|d| d.severity != Severity::Warning);
        let path_of = |name: &str| {
            let known = known.iter().find(|k| k.0 == name);
            known.map_or_else(|| name.to_owned(), |k| k.1.to_string_lossy().into_owned())
        };
        let empty = SourceMap::default();
        let map = match (&program, &map) {
            (Some(p), _) => &p.map,
            (None, Some(m)) => m,
            _ => &empty,
        };
        let files: Vec<String> = map.files().iter().map(|f| path_of(&f.name)).collect();
        for (path, f) in files.iter().zip(map.files()) {
            let same = self.included.get(path).is_some_and(|d| d.text == f.text);
            if !self.open.contains_key(path) && !same {
                self.included
                    .insert(path.clone(), Document::new(path, f.text.clone()));
            }
        }
        let mut analysis = Analysis {
            files,
            program: None,
            good: None,
            told: Vec::new(),
        };
        let mut out: Vec<FileDiagnostics> = Vec::new();
        let mut all: Vec<String> = vec![main.clone(), file.to_owned()];
        for d in &found {
            let (file, d) = analysis.diagnostic(d, map, &main);
            all.push(file.clone());
            diagnostics_of(&mut out, file).push(d);
        }
        analysis.told = out.iter().map(|f| f.file.clone()).collect();
        all.extend(told_before);
        for file in all {
            diagnostics_of(&mut out, file);
        }
        // The last program without errors stays until there is another.
        analysis.good = match wrong {
            true => good.or(last),
            false => None,
        };
        analysis.program = program;
        self.analyses.insert(main.clone(), analysis);
        // A file that this model does not include after all is checked with another one, or alone.
        if self.main_of(file) != main {
            for f in self.check(file) {
                diagnostics_of(&mut out, f.file).extend(f.diagnostics);
            }
        }
        out
    }
}

/// What is wrong in a file of the list, which gets it if it has not.
fn diagnostics_of(list: &mut Vec<FileDiagnostics>, file: String) -> &mut Vec<Diagnostic> {
    let at = list.iter().position(|f| f.file == file);
    let at = at.unwrap_or(list.len());
    if at == list.len() {
        let diagnostics = Vec::new();
        list.push(FileDiagnostics { file, diagnostics });
    }
    &mut list[at].diagnostics
}

impl Analysis {
    /// A diagnostic as an editor shows it, and the file it is in.
    fn diagnostic(
        &self,
        d: &diag::Diagnostic,
        map: &SourceMap,
        main: &str,
    ) -> (String, Diagnostic) {
        let location = self.location(map, d.span).unwrap_or_else(|| Location {
            file: main.to_owned(),
            range: Range::default(),
        });
        let mut message = d.message.clone();
        if !d.label.is_empty() {
            message += &format!(": {}", d.label);
        }
        if let Some(help) = &d.help {
            message += &format!("\n{help}");
        }
        let related = d.others.iter().filter_map(|o| {
            Some(Related {
                location: self.location(map, o.span)?,
                message: o.text.clone(),
            })
        });
        let out = Diagnostic {
            range: location.range,
            severity: if d.severity == Severity::Warning {
                2
            } else {
                1
            },
            code: d.code,
            message,
            related: related.collect(),
            fixes: self.fix(d, map).into_iter().collect(),
        };
        (location.file, out)
    }

    /// Whether a file may belong to this model: it is one of its files, or not known to be none (data are no text of the model,
    /// and a text that could not be read to its end says nothing).
    pub(super) fn may_include(&self, file: &str) -> bool {
        let is_text = ["blk", "gms", "inc"].iter().any(|e| {
            let extension = std::path::Path::new(file).extension();
            extension.is_some_and(|f| f.eq_ignore_ascii_case(e))
        });
        !is_text || self.program.is_none() || self.files.iter().any(|f| f == file)
    }

    /// What the help of a message says, as a change of the text.
    fn fix(&self, d: &diag::Diagnostic, map: &SourceMap) -> Option<Fix> {
        let place = map.place(d.span)?;
        let text = &map.file(place.file).text;
        let (lo, hi) = (place.lo as usize, place.hi as usize);
        let (lo, hi, new) = if d.code == "E0201" {
            // Another mark that stands there is what is wrong.
            if text[lo..hi].ends_with([',', ':', '.']) || text[hi..].starts_with([',', ':', '.']) {
                return None;
            }
            (hi, hi, ";".to_owned())
        } else {
            let new = to_write(d)?;
            let (lo, hi, new) = replacement(text, lo, hi, new)?;
            // A sign beside it is part of what is wrong: `=<`, `l=`.
            let sign = |c: char| "<>=!&|:".contains(c);
            let part = new.starts_with('=')
                && (text[..lo].ends_with(sign)
                    || text[hi..].starts_with(sign)
                    || [" l", " g", " e"].iter().any(|w| text[..lo].ends_with(w)));
            // `:` and `&` have no counterpart of one sign.
            let part = part || matches!(&text[lo..hi], ":" | "&");
            if part || new.eq_ignore_ascii_case(&text[lo..hi]) {
                return None;
            }
            (lo, hi, new)
        };
        let file = self.files.get(place.file.0 as usize)?.clone();
        let index = LineIndex::new(text);
        let title = match lo == hi {
            true => format!("Insert `{new}`"),
            false => format!("Replace `{}` by `{new}`", &text[lo..hi]),
        };
        Some(Fix {
            title,
            edits: vec![Edit {
                file,
                range: index.range(text, lo, hi),
                new_text: new,
            }],
        })
    }
}

/// What a message says to write at its place: a nearer name, or a word or sign. More than that is an example.
fn to_write(d: &diag::Diagnostic) -> Option<&str> {
    let help = d.help.as_deref().unwrap_or_default();
    let (_, behind) = d.label.rsplit_once("write `").unwrap_or_default();
    let new = match help.strip_prefix("did you mean `") {
        Some(rest) => &rest[..rest.find('`')?],
        None => {
            let whole = help
                .strip_prefix("write `")
                .and_then(|w| w.strip_suffix('`'));
            let new = behind.strip_suffix('`').or(whole)?;
            if new.contains([' ', '`', ';']) && new != ";" {
                return None;
            }
            new
        }
    };
    (!new.contains(['(', '…'])).then_some(new)
}

/// The piece that a suggestion stands for, and what stands there instead: the place may hold quotes, or a word among others.
fn replacement(text: &str, lo: usize, hi: usize, new: &str) -> Option<(usize, usize, String)> {
    let old = text.get(lo..hi)?;
    let is_word = |s: &str| !s.is_empty() && !s.contains(char::is_whitespace);
    let quoted = |s: &str| s.len() > 1 && s.starts_with(['\'', '"']) && s.ends_with(['\'', '"']);
    if let Some(name) = new.strip_prefix('$') {
        // The word behind the `$` of a line.
        let from = lo + old.find('$')? + 1;
        let len = text[from..hi]
            .find(|c: char| !c.is_ascii_alphanumeric())
            .unwrap_or(hi - from);
        return Some((from, from + len, name.to_owned()));
    }
    if let Some(name) = new.strip_prefix('.') {
        let from = old.rfind('.').map_or(lo, |n| lo + n + 1);
        return is_word(&text[from..hi]).then(|| (from, hi, name.to_owned()));
    }
    match (quoted(old), quoted(new)) {
        (true, false) => Some((lo + 1, hi - 1, new.to_owned())),
        _ if quoted(old) || is_word(old) => Some((lo, hi, new.to_owned())),
        _ => None,
    }
}
