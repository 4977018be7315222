//! The system's files, clock and memory. What needs none of them is built without this module.
//!
//! Invariant: in a sandbox a model reads only inside its own folder, the current folder, and folders that the user
//! allowed; symbolic links and `..` are resolved before that is decided.

use std::path::{Component, Path, PathBuf};
use std::time::SystemTime;

use crate::host::{Found, HostError, text_of};

/// Which files a model may read, and where they are looked for.
#[derive(Clone, Debug)]
pub(crate) struct Files {
    model: Option<PathBuf>,
    model_folder: PathBuf,
    /// The current folder.
    pub current: PathBuf,
    allowed: Vec<PathBuf>,
    sandbox: bool,
}

impl Files {
    /// For a model file, and further folders in which files are looked for. Any file may be read.
    pub(crate) fn new(model: &Path, allow_read: &[PathBuf]) -> Self {
        let current = std::env::current_dir()
            .and_then(|d| d.canonicalize())
            .unwrap_or_else(|_| PathBuf::from("."));
        let folder = match model.parent() {
            Some(p) if !p.as_os_str().is_empty() => p.to_path_buf(),
            _ => PathBuf::from("."),
        };
        Self {
            model: model.canonicalize().ok(),
            model_folder: folder,
            allowed: allow_read
                .iter()
                .filter_map(|d| d.canonicalize().ok())
                .collect(),
            current,
            sandbox: false,
        }
    }

    /// Whether only the model's folder, the current one and those that were allowed may be read.
    pub(crate) fn sandbox(self, sandbox: bool) -> Self {
        Self { sandbox, ..self }
    }

    /// The same, and another folder that may be read.
    pub(crate) fn and_allow(mut self, folder: &Path) -> Self {
        self.allowed.extend(folder.canonicalize());
        self
    }

    fn may_read(&self, real: &Path) -> bool {
        let folder = self.model_folder.canonicalize();
        !self.sandbox
            || self.model.as_deref() == Some(real)
            || folder.is_ok_and(|f| real.starts_with(f))
            || real.starts_with(&self.current)
            || self.allowed.iter().any(|d| real.starts_with(d))
    }

    /// The file that `path` means: relative to the asking file, the model, the current folder, or
    /// an allowed folder, whichever has it first.
    fn find(&self, path: &str, from: Option<&Path>) -> Result<(PathBuf, PathBuf), HostError> {
        let mut outside = None;
        for known in self.places(path, from) {
            let Ok(real) = known.canonicalize() else {
                continue;
            };
            if !self.may_read(&real) {
                outside.get_or_insert(known);
                continue;
            }
            if real.is_file() {
                return Ok((known, real));
            }
            if real.is_dir() {
                return Err(HostError::Other("it is a folder".into()));
            }
        }
        Err(outside.map_or(HostError::NotFound, HostError::Outside))
    }

    /// Where a file may be, in the order in which it is looked for. Models from Windows part folders by `\`: where
    /// the system does not, and no file has that name, they are understood all the same.
    fn places(&self, path: &str, from: Option<&Path>) -> Vec<PathBuf> {
        let folders = [from.and_then(Path::parent), Some(&*self.model_folder)];
        let folders = folders.into_iter().flatten();
        let folders = folders
            .chain([Path::new("")])
            .chain(self.allowed.iter().map(|d| &**d));
        let foreign = path.contains('\\') && !std::path::is_separator('\\');
        let slashed = foreign.then(|| path.replace('\\', "/"));
        [Some(path), slashed.as_deref()]
            .into_iter()
            .flatten()
            .flat_map(|path| folders.clone().map(move |f| tidy(&f.join(path))))
            .collect()
    }

    /// Reads a text, as [`crate::host::Host::read`] does.
    pub(crate) fn read(&self, path: &str, from: Option<&Path>) -> Found<String> {
        let (known, bytes) = self.read_bytes(path, from)?;
        let text = text_of(&known, bytes)?;
        Ok((known, text))
    }

    /// Reads a file, as [`crate::host::Host::read_bytes`] does.
    pub(crate) fn read_bytes(&self, path: &str, from: Option<&Path>) -> Found<Vec<u8>> {
        let (known, real) = self.find(path, from)?;
        let size = real.metadata().map_err(other)?.len();
        if size > u64::from(u32::MAX / 2) {
            return Err(HostError::Other("it is larger than 2 GB".into()));
        }
        Ok((known, std::fs::read(&real).map_err(other)?))
    }

    /// Whether a file may be read and is there.
    pub(crate) fn exists(&self, path: &str, from: Option<&Path>) -> bool {
        self.find(path, from).is_ok()
    }

    /// Whether there is a folder whose files may be read.
    pub(crate) fn folder_exists(&self, path: &str, from: Option<&Path>) -> bool {
        let places = self.places(path, from).into_iter();
        let mut real = places.filter_map(|p| p.canonicalize().ok());
        real.any(|p| p.is_dir() && self.may_read(&p))
    }
}

/// A path without `.` parts, which say nothing.
pub(crate) fn tidy(path: &Path) -> PathBuf {
    let parts = path.components().filter(|c| *c != Component::CurDir);
    let tidy: PathBuf = parts.collect();
    if tidy.as_os_str().is_empty() {
        PathBuf::from(".")
    } else {
        tidy
    }
}

/// What the system says, in plain words.
pub(crate) fn other(e: std::io::Error) -> HostError {
    match e.kind() {
        std::io::ErrorKind::NotFound => HostError::NotFound,
        std::io::ErrorKind::PermissionDenied => {
            HostError::Other("you do not have the right to do that".into())
        }
        _ => HostError::Other(e.to_string()),
    }
}

/// Seconds since 1970-01-01 UTC.
pub(crate) fn clock() -> f64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    since.map_or(0.0, |d| d.as_secs_f64())
}

/// Date and time now, as [`crate::host::Host::now`] counts it.
pub(crate) fn now() -> f64 {
    crate::host::day_number(clock())
}

/// Bytes of memory that the process holds, 0 where the system does not say.
pub(crate) fn memory() -> usize {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = statm
        .split(' ')
        .nth(1)
        .and_then(|p| p.parse::<usize>().ok());
    pages.unwrap_or(0) * 4096
}

/// Bytes that the process may hold before the system ends it: nine tenths of what it holds and what is free now, of the
/// machine or of its control group. None where the system does not say.
pub(crate) fn available_memory() -> Option<usize> {
    let told = std::fs::read_to_string("/proc/meminfo").ok()?;
    let available = told.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let free: usize = available.trim().strip_suffix(" kB")?.parse().ok()?;
    let number = |file: &str| {
        let told = std::fs::read_to_string(format!("/sys/fs/cgroup/memory.{file}")).ok()?;
        told.trim().parse::<usize>().ok()
    };
    let group = number("max").map(|max| max.saturating_sub(number("current").unwrap_or(0)));
    let free = (free << 10).min(group.unwrap_or(usize::MAX));
    Some((memory() + free) / 10 * 9)
}
