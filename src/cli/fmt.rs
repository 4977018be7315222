//! `bmod fmt`: the layout of texts.

use std::io::{Read, Write};
use std::path::Path;

use super::args::{EXECUTION, FmtArgs, USAGE};
use super::host::write_whole;
use crate::editor;

/// Carries out `bmod fmt`; with `--check` 1 if a file is not laid out as it would be.
pub(super) fn fmt(a: &FmtArgs) -> u8 {
    let status = a.files.iter().map(|file| one(file, a.check)).max();
    status.unwrap_or(0)
}

fn one(file: &Path, check: bool) -> u8 {
    let stdin = file == Path::new("-");
    let name = if stdin {
        "standard input".into()
    } else {
        file.display().to_string()
    };
    let text = match read(file, stdin) {
        Ok(text) => text,
        Err(why) => {
            eprintln!("bmod: {name} cannot be read: {why}");
            return EXECUTION;
        }
    };
    let gams = file
        .extension()
        .is_some_and(|e| !e.eq_ignore_ascii_case("blk"));
    let new = editor::format(&text, !gams);
    let same = new == text;
    if check {
        if !same {
            println!("{name}: `bmod fmt` would change it");
        }
        return if same { 0 } else { USAGE };
    }
    let written = match stdin {
        true => std::io::stdout().write_all(new.as_bytes()),
        false if same => Ok(()),
        false => write_whole(file, new.as_bytes()),
    };
    match written {
        Ok(()) => 0,
        Err(e) => {
            eprintln!("bmod: {name} cannot be written: {e}");
            EXECUTION
        }
    }
}

fn read(file: &Path, stdin: bool) -> Result<String, String> {
    let mut bytes = Vec::new();
    let read = match stdin {
        true => std::io::stdin().read_to_end(&mut bytes).map(|_| ()),
        false => std::fs::read(file).map(|b| bytes = b),
    };
    read.map_err(|e| e.to_string())?;
    String::from_utf8(bytes)
        .map_err(|e| format!("byte {} is not UTF-8", e.utf8_error().valid_up_to() + 1))
}
