//! `bmod fmt`: the layout of texts.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::args::{EXECUTION, FmtArgs, USAGE};
use super::commands::{Status, complain};
use super::host::{Output, say, write_whole};
use crate::editor;

/// Carries out `bmod fmt`; with `--check` 1 if a file is not laid out as it would be.
pub(super) fn fmt(a: &FmtArgs) -> u8 {
    let status = |file: &PathBuf| one(file, a.check).unwrap_or_else(|status| status);
    a.files.iter().map(status).max().unwrap_or(0)
}

fn one(file: &Path, check: bool) -> Status {
    let stdin = file == Path::new("-");
    let name = match stdin {
        true => "standard input".into(),
        false => file.display().to_string(),
    };
    let text = read(file, stdin)
        .map_err(|why| complain(EXECUTION, format!("{name} cannot be read: {why}")))?;
    let extension = file.extension();
    let gams = extension.is_some_and(|e| !e.eq_ignore_ascii_case("blk"));
    let new = editor::format(&text, !gams);
    let same = new == text;
    if check && !same {
        say!("{name}: `bmod fmt` would change it");
        return Err(USAGE);
    }
    let written = match stdin {
        _ if check => Ok(()),
        true => {
            Output::Standard.write(&new);
            Ok(())
        }
        false if same => Ok(()),
        false => write_whole(file, new.as_bytes()),
    };
    written
        .map(|()| 0)
        .map_err(|e| complain(EXECUTION, format!("{name} cannot be written: {e}")))
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
