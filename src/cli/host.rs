//! The real world behind [`Host`]: files, clock, terminal, Ctrl-C.
//!
//! Invariants:
//! * A model reads what its text names; in a sandbox, see [`Files`].
//! * A model writes only inside the output folder, whole files or nothing: a file is written under
//!   a temporary name in the same folder and then renamed.
//! * Progress is shown only on a terminal and only after a second.

use std::io::{IsTerminal, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::args::INTERRUPT;
use crate::host::{Found, Host, HostError};
use crate::system::{self, Files, other, tidy};

/// Set by the first Ctrl-C or SIGTERM.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// Whether the command ends by itself after that.
pub(super) static ENDS_ITSELF: AtomicBool = AtomicBool::new(false);
/// Otherwise it is ended after so long.
pub(super) const GRACE: Duration = Duration::from_millis(1500);

/// Signals that come closer than this are one.
const SAME_SIGNAL: Duration = Duration::from_millis(200);

/// Where text for people goes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Output {
    /// Standard output.
    #[default]
    Standard,
    /// Standard error, because standard output belongs to a program.
    Error,
    /// Nowhere.
    Quiet,
}

impl Output {
    /// Writes; see [`unwritten_output`].
    pub(super) fn write(self, text: &str) {
        let written = match self {
            Self::Standard => std::io::stdout().write_all(text.as_bytes()),
            Self::Error => std::io::stderr().write_all(text.as_bytes()),
            Self::Quiet => Ok(()),
        };
        keep_failure(written);
    }
}

/// What could not be written to standard output or standard error first, in the system's words.
static UNWRITTEN: Mutex<Option<String>> = Mutex::new(None);

fn keep_failure(written: std::io::Result<()>) {
    if let Err(e) = written
        // A reader that has gone away (`| head`) is no error of ours.
        && e.kind() != std::io::ErrorKind::BrokenPipe
    {
        let mut first = UNWRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert(e.to_string());
    }
}

/// At the end: why some of the output is lost, if it is.
pub(super) fn unwritten_output() -> Option<String> {
    keep_failure(std::io::stdout().flush());
    UNWRITTEN
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .take()
}

/// Writes a line to standard output.
macro_rules! say {
    ($($text:tt)*) => {
        $crate::cli::host::Output::Standard.write(&(format!($($text)*) + "\n"))
    };
}
pub(super) use say;

/// Files of this machine, this terminal, this clock.
pub struct SystemHost {
    files: Files,
    out: Option<PathBuf>,
    output: Output,
    start: Instant,
    bar: Option<ProgressBar>,
    last_progress: Option<Instant>,
    terminal: bool,
}

/// A line of progress that looks like this.
pub(super) fn styled(bar: ProgressBar, template: &str) -> ProgressBar {
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// Whether the user (Ctrl-C) or the system (SIGTERM) has asked for the end.
pub fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// From the first Ctrl-C or SIGTERM on [`Host::interrupted`] is true; the second ends the process.
pub(super) fn watch_signals() {
    // Without a handler the system's own way of ending a process is left.
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGINT, SIGTERM};
        if let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) {
            std::thread::spawn(move || signals.forever().for_each(|_| signalled()));
        }
    }
    #[cfg(windows)]
    let _ = ctrlc::set_handler(signalled);
}

fn signalled() {
    /// When the first signal came.
    static FIRST: Mutex<Option<Instant>> = Mutex::new(None);
    let mut first = FIRST.lock().unwrap_or_else(PoisonError::into_inner);
    match *first {
        // Schedulers tell a group of processes and each of them: that is one signal.
        Some(t) if t.elapsed() < SAME_SIGNAL => return,
        Some(_) => end_interrupted(),
        None => *first = Some(Instant::now()),
    }
    INTERRUPTED.store(true, Ordering::SeqCst);
    std::thread::spawn(|| {
        std::thread::sleep(GRACE);
        if !ENDS_ITSELF.load(Ordering::SeqCst) {
            end_interrupted();
        }
    });
}

/// Ends the process, but not while a file is written.
fn end_interrupted() -> ! {
    let _writing = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    eprintln!("bmod: interrupted");
    std::process::exit(i32::from(INTERRUPT))
}

impl SystemHost {
    /// For a model file, an output folder (made when something is written; without one nothing is), and further folders
    /// that may be read.
    pub fn new(model: &Path, out: Option<&Path>, allow_read: &[PathBuf], output: Output) -> Self {
        let files = Files::new(model, allow_read);
        Self {
            out: out.map(|out| files.current.join(out)),
            files,
            output,
            start: Instant::now(),
            bar: None,
            last_progress: None,
            terminal: std::io::stderr().is_terminal(),
        }
    }

    /// Whether reading is restricted to the model's folder, the current one and those that were allowed.
    pub fn sandbox(mut self, sandbox: bool) -> Self {
        self.files = self.files.clone().sandbox(sandbox);
        self
    }

    /// Takes the progress line away.
    pub fn finish(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

/// Held while a file is written: the process does not end in between.
pub(super) static WRITING: Mutex<()> = Mutex::new(());

/// Writes a file whole or not at all, with the permissions that new files have. What is there already and no ordinary
/// file (a pipe, a device, a link) stays what it is and is written to.
pub(super) fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if std::fs::symlink_metadata(path).is_ok_and(|m| !m.is_file()) {
        return std::fs::write(path, bytes);
    }
    let _writing = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    let mut builder = tempfile::Builder::new();
    builder.prefix(".bmod-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder.unwrap_or(Path::new(".")))?;
    file.write_all(bytes)?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

impl Host for SystemHost {
    fn memory(&self) -> usize {
        system::memory()
    }

    fn available_memory(&self) -> Option<usize> {
        system::available_memory()
    }

    fn read(&mut self, path: &str, from: Option<&Path>) -> Found<String> {
        self.files.read(path, from)
    }

    fn read_bytes(&mut self, path: &str, from: Option<&Path>) -> Found<Vec<u8>> {
        self.files.read_bytes(path, from)
    }

    fn exists(&mut self, path: &str, from: Option<&Path>) -> bool {
        self.files.exists(path, from)
    }

    fn folder_exists(&mut self, path: &str, from: Option<&Path>) -> bool {
        self.files.folder_exists(path, from)
    }

    fn write(&mut self, path: &str, bytes: &[u8]) -> Result<PathBuf, HostError> {
        let wanted = tidy(Path::new(path));
        let Some(out) = &self.out else {
            return Ok(wanted);
        };
        let outside = || HostError::Outside(PathBuf::from(path));
        std::fs::create_dir_all(out).map_err(other)?;
        let root = out.canonicalize().map_err(other)?;
        let target = root.join(&wanted);
        let goes_up = |c: Component| matches!(c, Component::ParentDir);
        if wanted.components().any(goes_up) || !target.starts_with(&root) {
            // `a/../b` would be harmless, but no model needs it.
            return Err(outside());
        }
        let folder = target.parent().ok_or_else(outside)?;
        // A link on the way may lead out: ask before making folders behind it.
        let there = folder
            .ancestors()
            .find(|a| a.exists())
            .ok_or_else(outside)?;
        if !there.canonicalize().map_err(other)?.starts_with(&root) {
            return Err(outside());
        }
        std::fs::create_dir_all(folder).map_err(other)?;
        if target.is_dir() {
            return Err(HostError::Other("there is a folder of that name".into()));
        }
        if target.is_symlink() && !target.canonicalize().is_ok_and(|t| t.starts_with(&root)) {
            return Err(outside());
        }
        write_whole(&target, bytes).map_err(other)?;
        Ok(target
            .strip_prefix(&self.files.current)
            .map_or(target.clone(), Path::to_path_buf))
    }

    fn print(&mut self, text: &str) {
        self.finish();
        self.output.write(text);
    }

    fn elapsed(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn now(&self) -> f64 {
        system::now()
    }

    fn interrupted(&self) -> bool {
        interrupted()
    }

    fn progress(&mut self, message: &str) {
        let now = Instant::now();
        let soon = self
            .last_progress
            .is_some_and(|t| now - t < Duration::from_millis(150));
        if !self.terminal || soon || self.start.elapsed() < Duration::from_secs(1) {
            return;
        }
        self.last_progress = Some(now);
        let spinner = || styled(ProgressBar::new_spinner(), "{spinner} {wide_msg}");
        let bar = self.bar.get_or_insert_with(spinner);
        bar.set_message(message.to_string());
        bar.tick();
    }
}

impl Drop for SystemHost {
    fn drop(&mut self) {
        self.finish();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// root/model/m.blk, root/model/lib/a.blk, root/secret.blk, root/out
    fn scene() -> (tempfile::TempDir, SystemHost) {
        let root = tempfile::tempdir().expect("a folder");
        let p = root.path();
        fs::create_dir_all(p.join("model/lib")).expect("made");
        fs::write(p.join("model/m.blk"), "set i;").expect("written");
        fs::write(p.join("model/lib/a.blk"), "\u{feff}set a;").expect("written");
        fs::write(p.join("model/bad.blk"), b"ab\xff").expect("written");
        fs::write(p.join("secret.blk"), "secret").expect("written");
        let model = p.join("model/m.blk");
        let host = SystemHost::new(&model, Some(&p.join("out")), &[], Output::Quiet).sandbox(true);
        (root, host)
    }

    #[test]
    fn reads_inside_only() {
        let (root, mut host) = scene();
        let main = root.path().join("model/m.blk");
        let (known, text) = host
            .read(main.to_str().expect("UTF-8"), None)
            .expect("the model");
        assert_eq!(text, "set i;");
        let (lib, text) = host.read("lib/a.blk", Some(&known)).expect("an include");
        assert_eq!(text, "set a;");
        assert_eq!(
            host.read("a.blk", Some(&lib)).expect("beside it").1,
            "set a;"
        );
        assert_eq!(
            host.read("none.blk", Some(&known)),
            Err(HostError::NotFound)
        );
        assert!(matches!(
            host.read("../secret.blk", Some(&known)),
            Err(HostError::Outside(_))
        ));
        assert!(matches!(
            host.read("lib", Some(&known)),
            Err(HostError::Other(_))
        ));
        // folders of a model from Windows
        assert!(
            host.read(r"lib\a.blk", None)
                .is_ok_and(|(_, text)| text == "set a;")
        );
        assert!(host.exists(r"..\model\lib\a.blk", None));
        assert!(matches!(
            host.read(r"..\secret.blk", Some(&known)),
            Err(HostError::Outside(_))
        ));
        assert_eq!(host.read("bad.blk", None), Err(HostError::NotUtf8(2)));
        assert!(host.exists("./lib/a.blk", None) && !host.exists("../secret.blk", None));
        #[cfg(unix)]
        {
            let link = root.path().join("model/link.blk");
            std::os::unix::fs::symlink(root.path().join("secret.blk"), link).expect("a link");
            assert!(matches!(
                host.read("link.blk", None),
                Err(HostError::Outside(_))
            ));
        }
        let allow = [root.path().to_path_buf()];
        let mut open = SystemHost::new(&main, None, &[], Output::Quiet);
        assert!(open.read("../secret.blk", Some(&known)).is_ok());
        let mut open = SystemHost::new(&main, None, &allow, Output::Quiet).sandbox(true);
        assert_eq!(
            open.read("../secret.blk", Some(&known)).expect("allowed").1,
            "secret"
        );
        assert_eq!(
            open.read("secret.blk", None).expect("found there").1,
            "secret"
        );
    }

    #[test]
    fn writes_inside_only_and_whole() {
        let (root, mut host) = scene();
        let out = root.path().join("out");
        host.write("fig/a.svg", b"one").expect("written");
        host.write("fig/a.svg", b"two").expect("written again");
        assert_eq!(fs::read(out.join("fig/a.svg")).expect("read"), b"two");
        assert_eq!(fs::read_dir(out.join("fig")).expect("listed").count(), 1);
        for path in ["../x", "fig/../../x", "/etc/x", "a/../../x"] {
            assert!(
                matches!(host.write(path, b""), Err(HostError::Outside(_))),
                "{path}"
            );
        }
        assert!(matches!(host.write("fig", b""), Err(HostError::Other(_))));
        let inside = out.join("b.txt");
        host.write(inside.to_str().expect("UTF-8"), b"x")
            .expect("an absolute path inside");
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(root.path(), out.join("way")).expect("a link");
            assert!(matches!(
                host.write("way/x", b""),
                Err(HostError::Outside(_))
            ));
            assert!(matches!(
                host.write("way/new/x", b""),
                Err(HostError::Outside(_))
            ));
            std::os::unix::fs::symlink(root.path().join("secret.blk"), out.join("s"))
                .expect("a link");
            assert!(matches!(
                host.write("s", b"mine"),
                Err(HostError::Outside(_))
            ));
            std::os::unix::fs::symlink(out.join("b.txt"), out.join("t")).expect("a link");
            host.write("t", b"through")
                .expect("written through the link");
            assert!(out.join("t").is_symlink());
            assert_eq!(fs::read(&inside).expect("read"), b"through");
            let secret = fs::read(root.path().join("secret.blk")).expect("read");
            assert_eq!(secret, b"secret");
        }
    }
}
