//! What `bmod dual` and `bmod kkt` share: the run, the page, the model that is written, the comparison.

use super::args::{ChosenArgs, DeriveArgs, EXECUTION, FormulaFormat, ModelArgs, SolveArgs};
use super::commands::{carry_out_silently, name, options};
use super::host::write_whole;
use crate::diag::Diagnostic;
use crate::formulation::check::Comparison;
use crate::formulation::derive::Primal;
use crate::formulation::page::{Format, Page, write};
use crate::formulation::{Formulation, show, study, text};
use crate::run::{Machine, Options, Studied, StudyChoice};
use std::io::{IsTerminal, Write};
use std::path::Path;

/// Characters of a line, where the terminal does not say.
const WIDTH: usize = 100;

/// What a derivation came to.
pub struct Derived {
    /// The page that is shown.
    pub page: Page,
    /// Its title.
    pub title: String,
    /// What is written as a model.
    pub formulation: Formulation,
    /// The comparison, if it was asked for.
    pub check: Option<Result<Comparison, String>>,
    /// What it was compared with, in words.
    pub compared: &'static str,
}

/// How formulas are written.
pub fn format(f: FormulaFormat) -> Format {
    let columns = || std::env::var("COLUMNS").ok().and_then(|c| c.parse().ok());
    match f {
        FormulaFormat::Text => {
            let wide: usize = if std::io::stdout().is_terminal() {
                columns().unwrap_or(WIDTH)
            } else {
                WIDTH
            };
            Format::Text(wide.max(40))
        }
        FormulaFormat::Latex => Format::Latex,
        FormulaFormat::Html => Format::Html,
    }
}

/// What is made of a solve: an exit status, or why it cannot be made.
pub type Derive<'a> = dyn FnMut(&mut Machine, Primal, Studied) -> Result<u8, Box<Diagnostic>> + 'a;

/// Runs a model and hands the solve that is meant on; the exit status.
pub fn studied(model: &ModelArgs, solve: &SolveArgs, chosen: &ChosenArgs, f: &mut Derive) -> u8 {
    let base = match options(solve) {
        Ok(o) => o,
        Err(status) => return status,
    };
    let options = Options {
        quiet: true,
        collect: false,
        study: Some(StudyChoice {
            model: chosen.name.clone(),
            number: chosen.number,
            generate_only: false,
        }),
        ..base
    };
    let mut status = 0;
    let finished = carry_out_silently(model, options, &mut |m| {
        let result = match study::primal(m) {
            Some((primal, studied)) => f(m, primal, studied),
            None => Err(Box::new(no_solve(m, chosen))),
        };
        match result {
            Ok(s) => status = s,
            Err(d) => {
                m.say(*d);
                status = EXECUTION;
            }
        }
    });
    match finished {
        Ok(f) => f.end.exit().max(status),
        Err(status) => status,
    }
}

/// Why there is no solve to look at.
fn no_solve(m: &Machine, chosen: &ChosenArgs) -> Diagnostic {
    let seen = m.solves_seen();
    let message = match (&chosen.name, chosen.number) {
        (Some(name), _) if m.symbols.find(name).is_none() => show::unknown(&m.symbols, name),
        (_, Some(k)) if k > seen => format!("there is no solve {k}: the run has {seen}"),
        (Some(name), _) => format!("the model `{name}` is not solved, or could not be generated"),
        _ if seen == 0 => "nothing is solved".to_string(),
        _ => "the model could not be generated".to_string(),
    };
    Diagnostic::execution("E0430", m.options.at.get(), message)
        .label("the run ends here")
        .help("a derivation needs a solve: it says what is minimised and which data hold")
}

/// Shows a derivation, writes its model, and says what the comparison found; the exit status.
pub fn finish(a: &DeriveArgs, m: &Machine, d: &Derived, primal: &Primal) -> u8 {
    let to_stdout = a.as_model.as_deref() == Some(Path::new("-"));
    let mut status = 0;
    if a.as_model.is_none() {
        tell(&write(&d.page, format(a.format), &d.title));
    }
    let f = &d.formulation;
    let say = |t: String| match to_stdout || a.format != FormulaFormat::Text {
        true => eprintln!("{t}"),
        false => tell(&format!("{t}\n")),
    };
    if !f.by_instance.is_empty() {
        say(format!(
            "\nDerived by instance, not in symbols: {}.",
            f.by_instance.join("; ")
        ));
    }
    match &d.check {
        None => {}
        Some(Ok(c)) if c.passed() => say(format!(
            "\nChecked: {}: {} entries and {} numbers are equal (largest relative difference {:.0e}).",
            d.compared, c.entries, c.numbers, c.largest
        )),
        Some(Ok(c)) => {
            say(format!(
                "\nThe check failed: {} differences.\n  {}",
                c.count,
                c.differences.join("\n  ")
            ));
            status = EXECUTION;
        }
        Some(Err(e)) => {
            say(format!(
                "\nThe check failed: the derived model could not be generated: {e}"
            ));
            status = EXECUTION;
        }
    }
    if let Some(path) = &a.as_model {
        let file = name(&a.model);
        let include = a.include.then_some(file.as_str());
        let head = head(&d.title, &file, primal);
        let text = text::model(&m.symbols, &m.store, f, include, &head, true);
        if to_stdout {
            tell(&text);
        } else {
            match write_whole(path, text.as_bytes()) {
                Ok(()) => say(format!(
                    "{} is written: the model {}",
                    path.display(),
                    f.name
                )),
                Err(e) => {
                    eprintln!("bmod: {} could not be written: {e}", path.display());
                    status = EXECUTION;
                }
            }
        }
    }
    status
}

/// Writes to standard output; a reader that has gone away is no error.
pub fn tell(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// The comment with which a derived model begins.
pub fn head(title: &str, file: &str, primal: &Primal) -> String {
    format!(
        "$title {title}\n* Derived by bmod from the model {} of {file}.\n\n",
        primal.name
    )
}
