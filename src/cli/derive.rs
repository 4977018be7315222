//! What `bmod dual` and `bmod kkt` share: the run, the page, the model that is written, the comparison.

use super::args::{ChosenArgs, DeriveArgs, EXECUTION, FormulaFormat, ModelArgs, SolveArgs};
use super::commands::{Status, carry_out_silently, name, options, write_file};
use super::host::Output;
use crate::diag::Diagnostic;
use crate::formulation::derive::Primal;
use crate::formulation::derived::{Derived, Kind};
use crate::formulation::page::{Format, write};
use crate::formulation::study;
use crate::run::{Machine, Options, Studied, StudyChoice};
use std::io::IsTerminal;
use std::path::{Component, Path};

/// Characters of a line, where the terminal does not say.
const WIDTH: usize = 100;

/// Characters of a line.
pub fn width() -> usize {
    let said = crate::report::diagnostics::columns(std::io::stdout().is_terminal());
    said.unwrap_or(WIDTH)
}

/// How formulas are written.
pub fn format(f: FormulaFormat) -> Format {
    match f {
        FormulaFormat::Text => Format::Text(width()),
        FormulaFormat::Latex => Format::Latex,
        FormulaFormat::Html => Format::Html,
    }
}

/// What is made of a solve: an exit status, or why it cannot be made.
pub type Derive<'a> = dyn FnMut(&mut Machine, Primal, Studied) -> Result<u8, Box<Diagnostic>> + 'a;

/// Runs a model and hands the solve that is meant on; the exit status.
pub(super) fn studied(
    model: &ModelArgs,
    solve: &SolveArgs,
    chosen: &ChosenArgs,
    f: &mut Derive,
) -> Status {
    let options = Options {
        collect: false,
        ..study_options(solve, chosen)?
    };
    let mut status = 0;
    let finished = carry_out_silently(model, options, &mut |m| {
        // Of half a run nothing is said.
        if m.interrupted() {
            return;
        }
        match study::chosen(m).and_then(|(primal, studied)| f(m, primal, studied)) {
            Ok(s) => status = s,
            Err(d) => {
                m.say(*d);
                status = EXECUTION;
            }
        }
    });
    Ok(finished.end.exit().max(status))
}

/// Options of a run whose solve is studied.
pub(super) fn study_options(solve: &SolveArgs, chosen: &ChosenArgs) -> Result<Options, u8> {
    Ok(Options {
        quiet: true,
        study: Some(StudyChoice {
            model: chosen.name.clone(),
            number: chosen.number,
            generate_only: false,
        }),
        ..options(solve)?
    })
}

/// Carries out `bmod dual` and `bmod kkt`; the exit status.
pub(super) fn derive(a: &DeriveArgs, kind: Kind) -> Status {
    studied(&a.model, &a.solve, &a.chosen, &mut |m, primal, studied| {
        let d = kind.derive(m, &primal, &studied, a.check, a.as_model.is_some())?;
        Ok(finish(a, m, &d, &primal, &studied))
    })
}

/// Shows a derivation, writes its model, and says what the comparison found; the exit status.
fn finish(a: &DeriveArgs, m: &Machine, d: &Derived, primal: &Primal, studied: &Studied) -> u8 {
    let to_stdout = a.as_model.as_deref() == Some(Path::new("-"));
    let status = if d.failed() { EXECUTION } else { 0 };
    if a.as_model.is_none() {
        tell(&write(&d.page, format(a.format), &d.title));
    }
    let say = |t: String| match to_stdout || a.format != FormulaFormat::Text {
        true => eprintln!("{t}"),
        false => tell(&format!("{t}\n")),
    };
    d.remarks().into_iter().for_each(|r| say(format!("\n{r}")));
    let Some(path) = &a.as_model else {
        return status;
    };
    let include = a.include.then(|| seen_from(path, &a.model.file));
    if include.is_some() {
        d.changed_later(m, studied).into_iter().for_each(&say);
    }
    let text = d.model(m, primal, &name(&a.model), include.as_deref());
    if to_stdout {
        tell(&text);
        return status;
    }
    if let Err(failed) = write_file(path, text.as_bytes()) {
        return failed;
    }
    let model = &d.formulation.name;
    say(format!("{} is written: the model {model}", path.display()));
    status
}

/// The path of a file as a text that is written to `out` names it.
fn seen_from(out: &Path, file: &Path) -> String {
    let folder = out
        .parent()
        .filter(|p| *p != Path::new(""))
        .unwrap_or(Path::new("."));
    let path = match (folder.canonicalize(), file.canonicalize()) {
        (Ok(folder), Ok(file)) => {
            let both = folder.components().zip(file.components());
            let shared = both.take_while(|(a, b)| a == b).count();
            let up = folder
                .components()
                .skip(shared)
                .map(|_| Component::ParentDir);
            up.chain(file.components().skip(shared)).collect()
        }
        _ => file.to_path_buf(),
    };
    path.to_string_lossy().into_owned()
}

/// Writes to standard output.
pub(super) fn tell(text: &str) {
    Output::Standard.write(text);
}
