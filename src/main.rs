//! The command line: see `bmod --help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    // Deeply nested texts need more stack than the main thread has.
    let worker = std::thread::Builder::new()
        .stack_size(256 << 20)
        .spawn(|| bmod::cli::commands::main(std::env::args_os()));
    match worker.map(std::thread::JoinHandle::join) {
        Ok(Ok(status)) => ExitCode::from(status),
        _ => ExitCode::from(bmod::cli::args::EXECUTION),
    }
}
