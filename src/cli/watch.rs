//! `bmod watch`: runs a model again whenever a file of its folder is saved.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::sync::atomic::Ordering;
use std::time::{Duration, SystemTime};

use super::args::{EXECUTION, INTERRUPT, WatchArgs};
use super::commands::{Status, complain};
use super::host::{ENDS_ITSELF, interrupted, say};

/// How often the files are looked at.
const INTERVAL: Duration = Duration::from_millis(200);

/// Carries out `bmod watch`: a run as a process of its own each time, until Ctrl-C.
pub(super) fn watch(a: &WatchArgs) -> Status {
    let program = std::env::current_exe()
        .map_err(|_| complain(EXECUTION, "the program does not find itself"))?;
    let folder = match a.file.parent() {
        Some(p) if !p.as_os_str().is_empty() => p.to_path_buf(),
        _ => PathBuf::from("."),
    };
    ENDS_ITSELF.store(true, Ordering::SeqCst);
    let mut seen = None;
    while !interrupted() {
        let now = stamp(&folder);
        if seen == Some(now) {
            std::thread::sleep(INTERVAL);
            continue;
        }
        // On a terminal the screen is cleared, so that the first error or the answer stands on top.
        if std::io::stdout().is_terminal() {
            print!("\x1b[2J\x1b[H");
            // Before the run writes: it is a process of its own.
            let _ = std::io::stdout().flush();
        }
        let saved = modified(&a.file);
        let mut run = Command::new(&program);
        run.arg("run").arg(&a.file).args(&a.arguments);
        run.spawn()
            .and_then(wait)
            .map_err(|e| complain(EXECUTION, format!("the run could not be started: {e}")))?;
        if interrupted() {
            break;
        }
        let shown = folder.display();
        say!("\nwaiting for a change in {shown} (Ctrl-C ends)");
        // What the run itself wrote is no change; what was saved meanwhile is.
        seen = (modified(&a.file) == saved).then(|| stamp(&folder));
    }
    Ok(INTERRUPT)
}

/// Waits for a run. Ctrl-C reaches it from the terminal; SIGTERM reaches this process alone, and is passed on.
fn wait(mut run: Child) -> std::io::Result<()> {
    let mut told = false;
    while run.try_wait()?.is_none() {
        if interrupted() && !told {
            told = true;
            #[cfg(unix)]
            Command::new("kill")
                .args(["-TERM", &run.id().to_string()])
                .status()?;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    Ok(())
}

fn modified(file: &Path) -> Option<SystemTime> {
    file.metadata().ok()?.modified().ok()
}

/// The latest change of the texts and data of a folder, and how many there are.
fn stamp(folder: &Path) -> (Option<SystemTime>, usize) {
    const SOURCES: [&str; 6] = ["blk", "gms", "inc", "csv", "json", "gdx"];
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let is_source = |p: &PathBuf| {
        p.extension()
            .is_some_and(|x| SOURCES.iter().any(|s| x.eq_ignore_ascii_case(s)))
    };
    let files = entries.map(|e| e.path()).filter(is_source);
    let times: Vec<SystemTime> = files.filter_map(|p| modified(&p)).collect();
    (times.iter().max().copied(), times.len())
}
