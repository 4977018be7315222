//! Option files of solvers: `m.optfile = 1` reads `ipopt.opt` or `path.opt`, `2` reads `ipopt.op2` and so on.
//!
//! A line holds a name and a value, with blanks or `=` between; `*` and `#` begin a comment.

use super::Machine;
use crate::check::node::SymbolId;
use crate::diag::Diagnostic;
use crate::model::option::{Accepted, OptionTable, check};
use crate::solve::backend::Task;
use crate::solve::registry;
use crate::source::Span;

/// `opt`, `op2` … `op9`, `o10` … `999`, as GAMS names them.
fn extension(number: u32) -> String {
    match number {
        0 | 1 => "opt".into(),
        2..=9 => format!("op{number}"),
        10..=99 => format!("o{number}"),
        n => n.to_string(),
    }
}

/// The options of a file, with the numbers of their lines; Err: a line that has no value.
fn parse(text: &str) -> Result<Vec<(usize, String, String)>, String> {
    let mut out = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() || line.starts_with('*') {
            continue;
        }
        let mut words = line.splitn(2, |c: char| c.is_whitespace() || c == '=');
        let name = words.next().unwrap_or_default();
        let value = words.next().unwrap_or_default();
        let value = value.trim_start_matches(|c: char| c.is_whitespace() || c == '=');
        let value = value.trim().trim_matches(['"', '\'']);
        if value.is_empty() {
            return Err(line.to_string());
        }
        out.push((number + 1, name.to_string(), value.to_string()));
    }
    Ok(out)
}

impl Machine<'_> {
    /// Options of the model's option file, if it has one. None: one of them is refused, which was said.
    pub(super) fn option_file(
        &mut self,
        model: SymbolId,
        task: &Task,
        span: Span,
    ) -> Option<Vec<(String, String)>> {
        let number = self.model_option(model, "optfile", 0.0);
        if !(1.0..1000.0).contains(&number) {
            return Some(Vec::new());
        }
        let (names, tables) = registry::option_file(task);
        let extension = extension(number as u32);
        let files: Vec<String> = names.iter().map(|s| format!("{s}.{extension}")).collect();
        let warn = |message: String, help: &str| {
            Diagnostic::warning("E0426", span)
                .says(message)
                .label("at this solve")
                .help(help)
        };
        for file in &files {
            if !self.file_exists(file, span) {
                continue;
            }
            let text = match self.read_file(file, span) {
                Ok(text) => text,
                Err(d) => {
                    d.note(self);
                    return Some(Vec::new());
                }
            };
            return match parse(&text) {
                Ok(options) => self.checked(file, options, &tables, span),
                Err(line) => {
                    warn(
                        format!("the option file `{file}` is not used: `{line}` has no value"),
                        "a line holds a name and a value",
                    )
                    .note(self);
                    Some(Vec::new())
                }
            };
        }
        warn(
            format!(
                "there is no option file `{}`: the defaults are used",
                files.join("` or `")
            ),
            "it stands beside the model, or in the current folder",
        )
        .note(self);
        Some(Vec::new())
    }

    /// Those of a file's options that count; None if one is refused.
    fn checked(
        &mut self,
        file: &str,
        options: Vec<(usize, String, String)>,
        tables: &[&OptionTable],
        span: Span,
    ) -> Option<Vec<(String, String)>> {
        let (mut taken, mut ignored) = (Vec::new(), Vec::new());
        for (line, name, value) in options {
            match check(tables, &name, &value) {
                Ok(Accepted::Taken) => taken.push((name, value)),
                Ok(Accepted::Ignored) => ignored.push(name),
                Err(refused) => {
                    let (message, help) = refused.words(&name, &value);
                    let help = help.unwrap_or_else(|| {
                        let backend = tables.first().map_or("", |t| t.backend);
                        format!("`bmod help options {backend}` lists the options")
                    });
                    Diagnostic::execution("E0426", span)
                        .says(format!("`{file}`, line {line}: {message}"))
                        .label("at this solve")
                        .help(help)
                        .note(self);
                    return None;
                }
            }
        }
        if !ignored.is_empty() && self.passed_over.insert(file.to_string()) {
            let names = ignored.join("`, `");
            Diagnostic::warning("E0426", span)
                .says(format!(
                    "`{file}`: `{names}` mean nothing here and are passed over"
                ))
                .label("at this solve")
                .note(self);
        }
        Some(taken)
    }
}
