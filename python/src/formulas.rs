//! Models as formulas.

use super::run::diagnostic;
use bmod::{Choice, Error, Formulas};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Characters of a line of text.
const WIDTH: usize = 100;

/// Formulas in all their forms, or none; messages, diagnostics.
pub type Made<'py> = (Option<Bound<'py, PyDict>>, String, Vec<Bound<'py, PyDict>>);

/// Which model and which solve is meant.
pub fn choice(model: Option<String>, solve: Option<usize>, check: bool) -> Choice {
    let mut choice = Choice::default().check(check);
    if let Some(name) = model {
        choice = choice.model(name);
    }
    if let Some(number) = solve {
        choice = choice.solve(number);
    }
    choice
}

/// What a derivation came to.
pub fn made<'py>(py: Python<'py>, found: Result<Formulas, Error>) -> PyResult<Made<'py>> {
    let f = match found {
        Ok(f) => f,
        Err(Error::Model {
            diagnostics,
            messages,
        }) => {
            let all = diagnostics.iter().map(|d| diagnostic(py, d));
            return Ok((None, messages, all.collect::<PyResult<_>>()?));
        }
        Err(e) => return Err(super::raise(e)),
    };
    let d = PyDict::new(py);
    d.set_item("title", f.title())?;
    d.set_item("text", f.text(WIDTH))?;
    d.set_item("latex", f.latex())?;
    d.set_item("html", f.html())?;
    d.set_item("body", f.html_body())?;
    d.set_item("remarks", f.remarks().to_vec())?;
    d.set_item("passed", f.check().map(|c| c.passed()))?;
    let source = Some(f.as_model()).filter(|t| !t.is_empty());
    d.set_item("source", source)?;
    Ok((Some(d), String::new(), Vec::new()))
}
