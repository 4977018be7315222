//! The host of a run of the library: texts in memory, perhaps files on disk to read, nothing written to disk.

use super::{Model, Options, OutputFile, Run};
use crate::host::{Found, Host, HostError, day_number};
use serde::{Deserialize, Serialize};
use std::cell::{Cell, RefCell};
use std::path::{Component, Path, PathBuf};

pub(super) struct RunHost<'a> {
    model: &'a Model,
    options: &'a Options,
    written: Vec<OutputFile>,
    printed: String,
    start: f64,
    /// What was asked of the disk.
    questions: RefCell<Vec<Question>>,
    /// Something was asked that may be different every time.
    uncertain: Cell<bool>,
}

/// What was asked of the disk, and a digest of the answer.
#[derive(Serialize, Deserialize)]
pub(super) struct Question {
    what: What,
    path: String,
    from: Option<PathBuf>,
    pub(super) answer: u64,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
enum What {
    File,
    IsFile,
    IsFolder,
}

/// `a/../b/./c` as `b/c`: names of files in memory.
fn plain(path: &Path) -> String {
    let mut parts: Vec<String> = Vec::new();
    for c in path.components() {
        match c {
            Component::Normal(part) => parts.push(part.to_string_lossy().into_owned()),
            Component::ParentDir => {
                parts.pop();
            }
            _ => {}
        }
    }
    parts.join("/")
}

impl<'a> RunHost<'a> {
    pub(super) fn new(model: &'a Model, options: &'a Options) -> Self {
        let mut host = Self {
            model,
            options,
            written: Vec::new(),
            printed: String::new(),
            start: 0.0,
            questions: RefCell::default(),
            uncertain: Cell::new(false),
        };
        host.start = host.clock();
        host
    }

    /// The run with what it wrote and printed.
    pub(super) fn finish(self, mut run: Run) -> Run {
        let reads = serde_json::to_string(&self.questions.take()).unwrap_or_default();
        run.take_output(self.written, self.printed, reads);
        run
    }

    /// What was asked of the disk since the last call; `None` if something was asked that may be different every time.
    pub(super) fn questions(&self) -> Option<Vec<Question>> {
        let questions = self.questions.take();
        (!self.uncertain.get()).then_some(questions)
    }

    /// The answers to them.
    pub(super) fn answers(&self) -> Option<Vec<u64>> {
        self.questions()
            .map(|q| q.iter().map(|q| q.answer).collect())
    }

    /// Whether a question has the same answer now.
    pub(super) fn answers_again(&self, q: &Question) -> bool {
        self.answer(q.what, &q.path, q.from.as_deref()) == q.answer
    }

    /// A digest of what the disk says.
    #[cfg(feature = "system")]
    fn answer(&self, what: What, path: &str, from: Option<&Path>) -> u64 {
        use std::hash::{BuildHasher, BuildHasherDefault};
        let Some(files) = &self.model.files else {
            return 0;
        };
        match what {
            What::File => {
                let hasher = BuildHasherDefault::<rustc_hash::FxHasher>::default();
                let read = files.read_bytes(path, from);
                read.map_or(0, |found| hasher.hash_one(found))
            }
            What::IsFile => u64::from(files.exists(path, from)),
            What::IsFolder => u64::from(files.folder_exists(path, from)),
        }
    }

    #[cfg(not(feature = "system"))]
    fn answer(&self, _: What, _: &str, _: Option<&Path>) -> u64 {
        0
    }

    #[cfg_attr(not(feature = "system"), expect(dead_code))]
    fn asked(&self, what: What, path: &str, from: Option<&Path>) {
        self.questions.borrow_mut().push(Question {
            what,
            path: path.into(),
            from: from.map(Path::to_path_buf),
            answer: self.answer(what, path, from),
        });
    }

    fn clock(&self) -> f64 {
        match &self.options.clock {
            Some(clock) => clock(),
            #[cfg(feature = "system")]
            None => crate::system::clock(),
            #[cfg(not(feature = "system"))]
            None => 0.0,
        }
    }

    /// A file in memory: by the name as it stands, beside the file that asks, or as it stands without `.` and `..`.
    fn in_memory(&self, path: &str, from: Option<&Path>) -> Option<(PathBuf, Vec<u8>)> {
        let contents = &self.model.contents;
        let beside = from.and_then(Path::parent).map(|f| plain(&f.join(path)));
        let names = [Some(path.to_string()), beside, Some(plain(Path::new(path)))];
        let mut found = names
            .into_iter()
            .flatten()
            .filter_map(|n| contents.get(&n).map(|t| (PathBuf::from(n), t.clone())));
        found.next().or_else(|| {
            let resolver = self.model.resolver.as_ref()?;
            self.uncertain.set(true);
            let text = resolver(path)?;
            Some((path.into(), text.into_bytes()))
        })
    }
}

impl Host for RunHost<'_> {
    fn read(&mut self, path: &str, from: Option<&Path>) -> Found<String> {
        if let Some((known, bytes)) = self.in_memory(path, from) {
            let text = String::from_utf8(bytes);
            let text = text.map_err(|e| HostError::NotUtf8(e.utf8_error().valid_up_to()))?;
            return Ok((known, text));
        }
        #[cfg(feature = "system")]
        if let Some(files) = &self.model.files {
            self.asked(What::File, path, from);
            return files.read(path, from);
        }
        Err(HostError::NotFound)
    }

    fn read_bytes(&mut self, path: &str, from: Option<&Path>) -> Found<Vec<u8>> {
        #[cfg(feature = "system")]
        if let (None, Some(files)) = (self.in_memory(path, from), &self.model.files) {
            self.asked(What::File, path, from);
            return files.read_bytes(path, from);
        }
        self.in_memory(path, from).ok_or(HostError::NotFound)
    }

    fn exists(&mut self, path: &str, from: Option<&Path>) -> bool {
        #[cfg(feature = "system")]
        if let Some(files) = &self.model.files {
            self.asked(What::IsFile, path, from);
            if files.exists(path, from) {
                return true;
            }
        }
        self.in_memory(path, from).is_some()
    }

    #[cfg(feature = "system")]
    fn folder_exists(&mut self, path: &str, from: Option<&Path>) -> bool {
        self.asked(What::IsFolder, path, from);
        let files = self.model.files.as_ref();
        files.is_some_and(|f| f.folder_exists(path, from))
    }

    fn write(&mut self, path: &str, bytes: &[u8]) -> Result<PathBuf, HostError> {
        let outside = Path::new(path).components().any(|c| {
            matches!(
                c,
                Component::ParentDir | Component::RootDir | Component::Prefix(_)
            )
        });
        if outside {
            return Err(HostError::Outside(path.into()));
        }
        let name = plain(Path::new(path));
        self.written.retain(|f| f.name != name);
        self.written.push(OutputFile {
            name: name.clone(),
            bytes: bytes.to_vec(),
        });
        Ok(name.into())
    }

    fn print(&mut self, text: &str) {
        if let Some(listener) = &self.options.listener {
            listener(text);
        }
        self.printed.push_str(text);
    }

    fn elapsed(&self) -> f64 {
        (self.clock() - self.start).max(0.0)
    }

    fn now(&self) -> f64 {
        self.uncertain.set(true);
        day_number(self.clock())
    }

    fn interrupted(&self) -> bool {
        self.options.control.is_cancelled()
    }

    fn progress(&mut self, message: &str) {
        self.options.control.tell(message, self.elapsed());
        if let Some(watcher) = &self.options.watcher {
            watcher(message);
        }
    }

    fn memory(&self) -> usize {
        #[cfg(feature = "system")]
        return crate::system::memory();
        #[cfg(all(not(feature = "system"), target_arch = "wasm32"))]
        return core::arch::wasm32::memory_size(0) * 65536;
        #[cfg(all(not(feature = "system"), not(target_arch = "wasm32")))]
        0
    }

    fn available_memory(&self) -> Option<usize> {
        #[cfg(feature = "system")]
        return crate::system::available_memory();
        // Of the 4 GiB that addresses of 32 bits reach: growing a vector holds it twice.
        #[cfg(not(feature = "system"))]
        cfg!(target_arch = "wasm32").then_some(3 << 30)
    }
}
