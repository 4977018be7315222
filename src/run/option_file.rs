//! Option files of solvers: `m.optfile = 1` reads `ipopt.opt` or `path.opt`, `2` reads `ipopt.op2` and so on.
//!
//! A line holds a name and a value, with blanks or `=` between; `*` and `#` begin a comment. The file of
//! a solver that is not in here is not read, and a warning says so.

use super::Machine;
use crate::check::node::SymbolId;
use crate::diag::Diagnostic;
use crate::source::Span;

/// Names of the files that a solver of ours reads, by problem type and chosen solver.
fn solvers(using: &str, choice: Option<&str>) -> &'static [&'static str] {
    match (using, choice) {
        ("mcp" | "cns", None | Some("path" | "bmcp")) => &["path"],
        ("mcp" | "cns", _) => &[],
        (_, None | Some("pounce")) => &["pounce", "ipopt"],
        (_, Some("ipopt" | "ipopth")) => &["ipopt"],
        _ => &[],
    }
}

/// `opt`, `op2` … `op9`, `o10` … `999`, as GAMS names them.
fn extension(number: u32) -> String {
    match number {
        0 | 1 => "opt".into(),
        2..=9 => format!("op{number}"),
        10..=99 => format!("o{number}"),
        n => n.to_string(),
    }
}

/// The options of a file; Err: a line that has no value.
fn parse(text: &str) -> Result<Vec<(String, String)>, String> {
    let mut out = Vec::new();
    for line in text.lines() {
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
        out.push((name.to_string(), value.to_string()));
    }
    Ok(out)
}

/// What says how a solver prints, writes, or which libraries it loads: of no concern here.
fn is_about_the_installation(name: &str) -> bool {
    const NAMES: [&str; 6] = [
        "linear_solver",
        "print_level",
        "hsllib",
        "pardisolib",
        "output_file",
        "file_print_level",
    ];
    NAMES.contains(&name.to_lowercase().as_str())
}

impl Machine<'_> {
    /// Options of the model's option file, if it has one.
    pub(super) fn option_file(
        &mut self,
        model: SymbolId,
        using: &str,
        span: Span,
    ) -> Vec<(String, String)> {
        let number = self.model_option(model, "optfile", 0.0);
        if !(1.0..1000.0).contains(&number) {
            return Vec::new();
        }
        let extension = extension(number as u32);
        let choice = self.options.texts.get(using).cloned();
        let files: Vec<String> = solvers(using, choice.as_deref())
            .iter()
            .map(|s| format!("{s}.{extension}"))
            .collect();
        let warn = |message: String, help: &str| {
            Diagnostic::warning("E0426", span, message)
                .label("at this solve")
                .help(help)
        };
        if files.is_empty() {
            let name = choice.as_deref().unwrap_or(using).to_string();
            self.note(warn(
                format!("the options of `{name}` are not read: another solver runs here"),
                "options of the solvers inside stand in `ipopt.opt` and `path.opt`",
            ));
            return Vec::new();
        }
        for file in &files {
            if !self.file_exists(file, span) {
                continue;
            }
            let text = match self.read_file(file, span) {
                Ok(text) => text,
                Err(d) => {
                    self.note(*d);
                    return Vec::new();
                }
            };
            return match parse(&text) {
                Ok(mut options) => {
                    options.retain(|(name, _)| !is_about_the_installation(name));
                    options
                }
                Err(line) => {
                    self.note(warn(
                        format!("the option file `{file}` is not used: `{line}` has no value"),
                        "a line holds a name and a value",
                    ));
                    Vec::new()
                }
            };
        }
        self.note(warn(
            format!(
                "there is no option file `{}`: the defaults are used",
                files.join("` or `")
            ),
            "it stands beside the model, or in the current folder",
        ));
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_names_and_values() {
        let text = "* how\ntol 1e-9\n\nmax_iter = 50 # few\nmu_strategy=\"adaptive\"\n";
        let want = [
            ("tol", "1e-9"),
            ("max_iter", "50"),
            ("mu_strategy", "adaptive"),
        ];
        let want = want.map(|(a, b)| (a.to_string(), b.to_string()));
        assert_eq!(parse(text), Ok(want.to_vec()));
        assert_eq!(parse("tol\n"), Err("tol".into()));
        assert_eq!(
            [1, 2, 9, 10, 123].map(extension),
            ["opt", "op2", "op9", "o10", "123"]
        );
    }
}
