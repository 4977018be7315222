//! `put_utility`: what a model asks of the system by `put`.
//!
//! The items are lines: a command, its argument, the next command … A page that has begun ends first, as in
//! GAMS. What would start a program is not done.

use super::{Frame, Machine};
use crate::check::node::PutCode;
use crate::diag::Diagnostic;
use crate::report::textfile::{Part, TextFile};
use crate::source::Span;

impl Machine<'_> {
    /// A statement.
    pub(super) fn put_utility(&mut self, items: &[PutCode], frame: &mut Frame, span: Span) {
        let mut lines = TextFile::default();
        for item in items {
            match item {
                PutCode::File(s) => self.open_put_file(*s),
                PutCode::NewLine => lines.new_line(Part::Body),
                PutCode::Column(_) | PutCode::Row(_) => {}
                PutCode::Item(w) => {
                    if let Some((item, format)) = self.put_formatted(w, frame) {
                        // What does not fit is marked in the text.
                        let _ = lines.item(Part::Body, &item, format);
                    }
                }
            }
        }
        if self.put.current.is_some()
            && let Some(f) = self.put_file(span)
        {
            f.text.end_page();
        }
        let text = lines.finish();
        // Blank lines count for nothing, wherever they stand.
        let mut lines = text.lines().filter(|line| !line.trim().is_empty());
        while let Some(command) = lines.next() {
            let command = command.trim().to_lowercase();
            self.utility(&command, lines.next().unwrap_or(""), span);
        }
    }

    fn utility(&mut self, command: &str, argument: &str, span: Span) {
        match command {
            "log" | "msg" | "msglog" | "stdout" => {
                if !self.options.quiet {
                    self.print(&format!("{argument}\n"));
                }
            }
            "ren" => {
                let Some(s) = self.put.current else { return };
                self.close_put_file(s, span);
                if let Some(f) = self.put.files.get_mut(&s) {
                    f.name = Some(argument.trim().into());
                }
                self.open_put_file(s);
            }
            "inc" => match self.read_file(argument.trim(), span) {
                Ok(text) => {
                    if let Some(f) = self.put_file(span) {
                        f.text.insert(&text);
                    }
                }
                Err(d) => d.note(self),
            },
            "gdxout" => self.transfer.unload_to = Some(argument.trim().into()),
            "gdxin" => self.transfer.load_from = Some(argument.trim().into()),
            _ => Diagnostic::warning("E0474", span)
                .says(format!("`{command}` of `put_utility` is not carried out"))
                .label("asks for what is outside of the model")
                .help("`log`, `msg`, `ren`, `inc`, `gdxOut` and `gdxIn` are known")
                .note(self),
        }
    }
}
