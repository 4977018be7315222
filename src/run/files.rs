//! Files that a run writes and reads: through the host, with a diagnostic where that fails.

use super::Machine;
use crate::diag::Diagnostic;
use crate::host::HostError;
use crate::source::{Outcome, Span};

impl Machine<'_> {
    /// Writes a whole file; false, and a diagnostic, if that is not possible.
    pub(super) fn write_file(&mut self, name: &str, bytes: &[u8], span: Span) -> bool {
        if ["/dev/tty", "/dev/stdout", "con:"].contains(&name.to_ascii_lowercase().as_str()) {
            self.print(&String::from_utf8_lossy(bytes));
            return true;
        }
        let written = self.host().write(name, bytes);
        match written {
            Ok(path) => {
                let path = path.display().to_string();
                let stopped = self.stopped();
                let mut report = self.report();
                // A file that is written after the end holds what was there then.
                report.partial.retain(|p| *p != path);
                if stopped {
                    report.partial.push(path.clone());
                }
                if !report.files.contains(&path) {
                    report.files.push(path);
                }
                true
            }
            Err(e) => {
                refused("E0470", "written", name, &e, span).note(self);
                false
            }
        }
    }

    /// Writes what `$echo` and `$unload` said while the text was read. A name outside the output folder is warned of: the
    /// run itself finds the text without it.
    pub(super) fn write_early_files(&mut self) {
        let files: Vec<_> = self.map.written.values().cloned().collect();
        for f in files.iter().filter(|f| !f.name.is_empty()) {
            let written = self.host().write(&f.name, &f.bytes);
            match written {
                Ok(path) => self.report().files.push(path.display().to_string()),
                Err(HostError::Outside(_)) => Diagnostic::warning("E0476", f.span)
                    .says(format!("the file `{}` lies outside the output folder: it is not written, but the model itself may read it", f.name))
                    .help("give a name without `..`, and the folder with `--out`")
                    .note(self),
                Err(e) => refused("E0470", "written", &f.name, &e, f.span).note(self),
            }
        }
    }

    /// Whether there is such a file: written by this run, or one that may be read.
    pub(super) fn file_exists(&self, name: &str, span: Span) -> bool {
        let from = self.asking(span);
        self.map.written(name).is_some() || self.host().exists(name, from.as_deref())
    }

    /// Reads a text; a diagnostic if that is not possible.
    pub(super) fn read_file(&mut self, name: &str, span: Span) -> Outcome<String> {
        if let Some(text) = self.map.written_text(name) {
            return Ok(text.to_owned());
        }
        let from = self.asking(span);
        let read = self.host().read(name, from.as_deref());
        read.map(|f| f.1)
            .map_err(|e| Box::new(refused("E0471", "read", name, &e, span)))
    }

    /// Reads the bytes of a file; a diagnostic if that is not possible.
    pub(super) fn read_bytes(&mut self, name: &str, span: Span) -> Outcome<Vec<u8>> {
        if let Some(bytes) = self.map.written(name) {
            return Ok(bytes.to_owned());
        }
        let from = self.asking(span);
        let read = self.host().read_bytes(name, from.as_deref());
        read.map(|f| f.1)
            .map_err(|e| Box::new(refused("E0471", "read", name, &e, span)))
    }

    /// The file whose text asks for another one.
    fn asking(&self, span: Span) -> Option<std::path::PathBuf> {
        let place = self.map.place(span)?;
        Some(self.map.file(place.file).name.clone().into())
    }
}

fn refused(code: &'static str, what: &str, name: &str, e: &HostError, span: Span) -> Diagnostic {
    let d = |why: String| {
        Diagnostic::execution(code, span).says(format!("the file `{name}` cannot be {what}: {why}"))
    };
    match e {
        HostError::NotFound => {
            d("there is no such file".into()).help("names are relative to the model's folder")
        }
        HostError::Outside(_) if what == "written" => d("it lies outside the output folder".into())
            .help("give a name without `..`, and the folder with `--out`"),
        HostError::Outside(_) => d("it lies outside the folders that may be read".into())
            .help("put the file beside the model, or allow its folder: `--allow-read DIR`"),
        HostError::NotUtf8(at) => {
            d(format!("byte {} is not UTF-8", at + 1)).help("save the file as UTF-8")
        }
        HostError::Compressed => {
            d("it was compressed by GAMS".into()).help("GAMS unpacks it: `$decompress FILE PLAIN`")
        }
        HostError::Other(why) => d(why.clone()),
    }
}
