//! The files of a project: texts that are open in an editor, and others that a host can read.

use super::place::{LineIndex, Position, Range};
use super::scan::Scan;
use crate::host::{Found, Host, HostError, text_of};
use rustc_hash::FxHashMap;
use std::path::{Component, Path, PathBuf};

/// Files beside those that are open: on disk, say.
pub trait Files {
    /// Reads a file, by its name in a model and the file that asks for it; gives the path under which it is known.
    ///
    /// # Errors
    /// If there is no such file.
    fn read(&self, path: &str, from: Option<&Path>) -> Found<Vec<u8>>;
    /// Whether there is such a file.
    fn exists(&self, path: &str, from: Option<&Path>) -> bool {
        self.read(path, from).is_ok()
    }
}

/// A text, taken apart.
#[derive(Debug)]
pub(super) struct Document {
    /// The text.
    pub text: String,
    /// What each word is.
    pub scan: Scan,
    /// Its lines.
    pub index: LineIndex,
}

impl Document {
    /// Takes a text apart; the ending of the file's name says which language it is in.
    pub(super) fn new(path: &str, text: String) -> Self {
        let scan = Scan::of(&text, has_slashes(path));
        let index = LineIndex::new(&text);
        Self { text, scan, index }
    }

    pub(super) fn range(&self, lo: usize, hi: usize) -> Range {
        self.index.range(&self.text, lo, hi)
    }

    pub(super) fn token_range(&self, token: usize) -> Range {
        let t = &self.scan.tokens[token];
        self.range(t.lo, t.hi)
    }

    pub(super) fn offset(&self, p: Position) -> usize {
        self.index.offset(&self.text, p)
    }

    pub(super) fn word(&self, token: usize) -> &str {
        self.scan.text_of(token, &self.text)
    }
}

/// Whether `//` begins a comment in a file: in all but GAMS's own.
pub(super) fn has_slashes(path: &str) -> bool {
    let extension = Path::new(path).extension();
    !extension.is_some_and(|e| {
        ["gms", "inc", "dat"]
            .iter()
            .any(|g| e.eq_ignore_ascii_case(g))
    })
}

/// `a/../b/./c` as `b/c`.
pub(super) fn plain(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for c in path.components() {
        match c {
            Component::CurDir => {}
            Component::ParentDir
                if matches!(out.components().next_back(), Some(Component::Normal(_))) =>
            {
                out.pop();
            }
            c => out.push(c),
        }
    }
    out
}

/// What a compilation may read.
pub(super) struct ProjectHost<'a> {
    pub open: &'a FxHashMap<String, Document>,
    pub files: Option<&'a dyn Files>,
    /// Names in models, and the paths they stand for.
    pub known: Vec<(String, PathBuf)>,
}

impl ProjectHost<'_> {
    fn find(&self, path: &str, from: Option<&Path>) -> Option<(PathBuf, &Document)> {
        let beside = from.and_then(Path::parent).map(|f| plain(&f.join(path)));
        let names = [beside, Some(plain(Path::new(path))), Some(path.into())];
        let mut names = names.into_iter().flatten();
        names.find_map(|n| Some((n.clone(), self.open.get(&*n.to_string_lossy())?)))
    }
}

impl Host for ProjectHost<'_> {
    fn read(&mut self, path: &str, from: Option<&Path>) -> Found<String> {
        let (known, text) = match self.find(path, from) {
            Some((known, d)) => (known, d.text.clone()),
            None => {
                let files = self.files.ok_or(HostError::NotFound)?;
                let (known, bytes) = files.read(path, from)?;
                let text = text_of(&known, bytes)?;
                (plain(&known), text)
            }
        };
        self.known.push((path.to_owned(), known.clone()));
        Ok((known, text))
    }

    fn read_bytes(&mut self, path: &str, from: Option<&Path>) -> Found<Vec<u8>> {
        match self.find(path, from) {
            Some((known, d)) => Ok((known, d.text.clone().into_bytes())),
            None => self.files.ok_or(HostError::NotFound)?.read(path, from),
        }
    }

    fn exists(&mut self, path: &str, from: Option<&Path>) -> bool {
        self.find(path, from).is_some() || self.files.is_some_and(|f| f.exists(path, from))
    }

    fn write(&mut self, path: &str, _: &[u8]) -> Result<PathBuf, HostError> {
        Ok(path.into())
    }
}
