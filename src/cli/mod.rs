//! The edge of the program: arguments, files, terminal.

pub mod args;
pub mod bench;
pub mod commands;
pub mod derive;
pub mod explain;
mod fmt;
mod gdx;
pub mod host;
mod lsp;
pub mod new;
pub mod range;
pub mod report;
pub mod show;
mod sweep;
pub mod test;
pub mod watch;
mod watchdog;
pub mod why;

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs `work`; a panic in it becomes an honest message on standard error and `status`.
///
/// Nothing a user writes should lead here: it is a bug of bmod, and says so.
pub fn guarded(status: u8, work: impl FnOnce() -> u8) -> u8 {
    std::panic::set_hook(Box::new(|info| {
        // a solver that runs on a thread of its own is given up quietly, and another way is tried
        if std::thread::current().name() == Some(crate::solve::nlp::THREAD) {
            return;
        }
        let place = info
            .location()
            .map_or(String::new(), |l| format!(" ({}:{})", l.file(), l.line()));
        eprintln!(
            "bmod: something went wrong inside bmod{place}. This is a bug in bmod, not in your \
             model.\nPlease report it with the model that caused it."
        );
    }));
    catch_unwind(AssertUnwindSafe(work)).unwrap_or(status)
}
