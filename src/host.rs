//! The one door to the outside world: files, clock, interruption.
//!
//! Invariant: nothing below the command line does input or output except through a [`Host`].

use jiff::Span;
use jiff::civil::{Date, date};
use std::path::{Path, PathBuf};

/// The day with the number 0.
pub(crate) const EPOCH: Date = date(1899, 12, 31);

/// Why the host would not do something.
#[derive(Debug, Clone, PartialEq)]
pub enum HostError {
    /// There is no such file.
    NotFound,
    /// The file lies outside the folders that may be read or written.
    Outside(PathBuf),
    /// The file is not UTF-8: offset of the first bad byte.
    NotUtf8(usize),
    /// The file was compressed by GAMS (`$compress`): its first line begins with `*GAMS*`.
    Compressed,
    /// Anything else, in the system's words.
    Other(String),
}

impl std::fmt::Display for HostError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFound => f.write_str("there is no such file"),
            Self::Outside(_) => f.write_str("it lies outside the folders of the model"),
            Self::NotUtf8(at) => write!(f, "byte {} is not UTF-8", at + 1),
            Self::Compressed => f.write_str("it was compressed by GAMS"),
            Self::Other(why) => f.write_str(why),
        }
    }
}

/// What was read, and the path under which the file is known.
pub type Found<T> = Result<(PathBuf, T), HostError>;

/// What a run may ask of the world.
pub trait Host {
    /// Reads a text. `from` is the file whose text asks (for relative paths).
    /// Returns the path under which it is known, and the text.
    fn read(&mut self, path: &str, from: Option<&Path>) -> Found<String>;
    /// Reads the bytes of a file, as [`Host::read`] finds it. A host that has texts only gives their bytes.
    fn read_bytes(&mut self, path: &str, from: Option<&Path>) -> Found<Vec<u8>> {
        let (known, text) = self.read(path, from)?;
        Ok((known, text.into_bytes()))
    }
    /// Whether a file may be read and is there (`$if exist`).
    fn exists(&mut self, path: &str, from: Option<&Path>) -> bool;
    /// Whether there is a folder whose files may be read (`$if dExist`).
    fn folder_exists(&mut self, _path: &str, _from: Option<&Path>) -> bool {
        false
    }
    /// Writes a whole file inside the output folder, or nothing.
    fn write(&mut self, path: &str, bytes: &[u8]) -> Result<PathBuf, HostError>;
    /// Text for the user who runs the model (display, summaries, logs).
    fn print(&mut self, _text: &str) {}
    /// Seconds since the run began; 0 where there is no clock.
    fn elapsed(&self) -> f64 {
        0.0
    }
    /// Date and time now, as GAMS counts it: days since 1899-12-31 with fraction; 0 where there is no clock.
    fn now(&self) -> f64 {
        0.0
    }
    /// True once the user has asked to stop.
    fn interrupted(&self) -> bool {
        false
    }
    /// Tells what a long step is doing: for a terminal, at most a few times a second.
    fn progress(&mut self, _message: &str) {}
    /// Bytes of memory in use, 0 where unknown.
    fn memory(&self) -> usize {
        0
    }
    /// Bytes that the process may hold before the system ends it, None where unknown.
    fn available_memory(&self) -> Option<usize> {
        None
    }
}

/// The date of a day number.
pub(crate) fn date_of(day: f64) -> Option<Date> {
    let days = Span::new().try_days(day.floor() as i64).ok()?;
    EPOCH.checked_add(days).ok()
}

/// Days since 1899-12-31, as GAMS counts, from seconds since 1970-01-01 UTC (which is day 25568).
pub fn day_number(seconds: f64) -> f64 {
    25568.0 + seconds / 86400.0
}

/// The text of a file: without a byte order mark. Old GAMS files are often Latin-1 in their comments; a `.blk` is UTF-8.
pub(crate) fn text_of(path: &Path, bytes: Vec<u8>) -> Result<String, HostError> {
    if bytes.starts_with(b"*GAMS*") {
        return Err(HostError::Compressed);
    }
    let ending = path.extension();
    let is_gams = ending.is_some_and(|e| ["gms", "inc"].iter().any(|g| e.eq_ignore_ascii_case(g)));
    match String::from_utf8(bytes) {
        Ok(text) => Ok(match text.strip_prefix('\u{feff}') {
            Some(rest) => rest.to_string(),
            None => text,
        }),
        Err(e) if is_gams => Ok(e.into_bytes().into_iter().map(char::from).collect()),
        Err(e) => Err(HostError::NotUtf8(e.utf8_error().valid_up_to())),
    }
}
