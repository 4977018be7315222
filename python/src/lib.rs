//! What Python sees of bmod: models, runs, the command line. Data go in and out as columns of numbers and codes of
//! labels; the package `bmod` around this makes pandas objects of them.
//!
//! The interpreter is released while a model runs. The calling thread waits, and looks for signals meanwhile.

mod data;
mod formulas;
mod run;

use bmod::Error;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;

/// An exception for what a program asked wrongly.
fn raise(e: Error) -> PyErr {
    match e {
        Error::File { .. } => PyOSError::new_err(e.to_string()),
        _ => PyValueError::new_err(e.to_string()),
    }
}

/// A model: text, files, data from outside.
#[pyclass(module = "bmod._bmod")]
struct Model {
    /// Shared with the runs that are under way: what they use does not change.
    model: Arc<bmod::Model>,
}

impl Model {
    fn change(&mut self) -> &mut bmod::Model {
        Arc::make_mut(&mut self.model)
    }
}

#[pymethods]
impl Model {
    #[staticmethod]
    fn from_text(name: String, text: String) -> Self {
        let mut model = bmod::Model::from_text(name, text);
        model.keep(true);
        Self {
            model: Arc::new(model),
        }
    }

    #[staticmethod]
    fn from_file(path: PathBuf) -> PyResult<Self> {
        let mut model = bmod::Model::from_file(path).map_err(raise)?;
        model.keep(true);
        Ok(Self {
            model: Arc::new(model),
        })
    }

    fn copy(&self) -> Self {
        Self {
            model: Arc::clone(&self.model),
        }
    }

    /// Whether compiled text and bases are kept from run to run.
    fn keep(&mut self, on: bool) {
        self.change().keep(on);
    }

    fn name(&self) -> String {
        self.model.name().to_string()
    }

    fn define(&mut self, name: String, value: String) {
        self.change().define(name, value);
    }

    fn file(&mut self, name: String, content: Vec<u8>) {
        self.change().file(name, content);
    }

    fn allow_read(&mut self, folder: PathBuf) {
        self.change().allow_read(folder);
    }

    fn forget(&mut self, name: &str) {
        self.change().forget(name);
    }

    /// Records of a parameter: the labels of each index position, their codes per record (int32), values (float64).
    fn set_values(
        &mut self,
        name: String,
        labels: Vec<Vec<String>>,
        codes: Vec<Bound<'_, PyBytes>>,
        values: &Bound<'_, PyBytes>,
    ) -> PyResult<()> {
        let values = data::floats(values.as_bytes());
        let not_a_number = |shown: String| {
            PyValueError::new_err(format!(
                "`{name}`: the value of {shown} is not a number (NaN)"
            ))
        };
        let nan = values.iter().position(|v| v.is_nan());
        if labels.is_empty() {
            if nan.is_some() {
                return Err(not_a_number(data::shown(&[])));
            }
            let value = values.first().copied().unwrap_or(0.0);
            self.change().set_scalar(name, value);
            return Ok(());
        }
        let keys = data::keys(&name, labels, &codes, values.len())?;
        if let Some(r) = nan {
            return Err(not_a_number(data::shown(&keys.key(r))));
        }
        self.change().set_values(name, keys, values);
        Ok(())
    }

    /// Members of a set in the same form, with their texts (none: no texts).
    fn set_members(
        &mut self,
        name: String,
        labels: Vec<Vec<String>>,
        codes: Vec<Bound<'_, PyBytes>>,
        texts: Option<Vec<String>>,
    ) -> PyResult<()> {
        let count = codes.first().map_or(0, |c| c.as_bytes().len() / 4);
        let keys = data::keys(&name, labels, &codes, count)?;
        let texts = texts.unwrap_or_default();
        self.change().set_elements(name, keys, texts);
        Ok(())
    }

    /// Whether the files that a run read are as they were.
    fn still_reads(slf: &Bound<'_, Self>, py: Python<'_>, reads: &str) -> bool {
        let model = shared(slf);
        py.detach(|| model.still_reads(reads))
    }

    /// Compiles only.
    fn check(slf: &Bound<'_, Self>, py: Python<'_>) -> run::Run {
        let model = shared(slf);
        run::Run::new(py.detach(move || model.check()))
    }

    /// Runs the model; whether Ctrl-C stopped it.
    #[allow(clippy::too_many_arguments)]
    fn run(
        slf: &Bound<'_, Self>,
        py: Python<'_>,
        options: Vec<(String, String)>,
        time_limit: Option<f64>,
        max_memory: Option<usize>,
        certify: bool,
        explain: bool,
        on_print: Option<Py<PyAny>>,
        on_progress: Option<Py<PyAny>>,
    ) -> PyResult<(run::Run, bool)> {
        let all = all_options(options, time_limit, max_memory, certify, explain);
        let model = shared(slf);
        run::carry_out(py, &model, all, on_print, on_progress)
    }

    /// A text that is the same for the same run.
    #[allow(clippy::too_many_arguments)]
    fn digest(
        slf: &Bound<'_, Self>,
        py: Python<'_>,
        options: Vec<(String, String)>,
        time_limit: Option<f64>,
        max_memory: Option<usize>,
        certify: bool,
        explain: bool,
        with: Vec<String>,
    ) -> String {
        let all = all_options(options, time_limit, max_memory, certify, explain);
        let model = shared(slf);
        let with: Vec<&str> = with.iter().map(String::as_str).collect();
        py.detach(|| model.digest(&all, &with))
    }

    /// The model as formulas; where there are none, messages and diagnostics.
    fn show<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        model: Option<String>,
        solve: Option<usize>,
        check: bool,
    ) -> PyResult<formulas::Made<'py>> {
        let choice = formulas::choice(model, solve, check);
        let of = shared(slf);
        formulas::made(py, py.detach(|| of.show(&choice)))
    }

    /// Its dual.
    fn dual<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        model: Option<String>,
        solve: Option<usize>,
        check: bool,
    ) -> PyResult<formulas::Made<'py>> {
        let choice = formulas::choice(model, solve, check);
        let of = shared(slf);
        formulas::made(py, py.detach(|| of.dual(&choice, &Default::default())))
    }

    /// Its optimality conditions.
    fn kkt<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        model: Option<String>,
        solve: Option<usize>,
        check: bool,
    ) -> PyResult<formulas::Made<'py>> {
        let choice = formulas::choice(model, solve, check);
        let of = shared(slf);
        formulas::made(py, py.detach(|| of.kkt(&choice, &Default::default())))
    }
}

/// The model of a run. It is borrowed no longer than that: a callback, or another thread, may give it other data.
fn shared(model: &Bound<'_, Model>) -> Arc<bmod::Model> {
    Arc::clone(&model.borrow().model)
}

fn all_options(
    options: Vec<(String, String)>,
    time_limit: Option<f64>,
    max_memory: Option<usize>,
    certify: bool,
    explain: bool,
) -> bmod::Options {
    let mut all = bmod::Options::default().certify(certify).explain(explain);
    for (name, value) in options {
        all = all.option(name, value);
    }
    if let Some(seconds) = time_limit {
        all = all.time_limit(seconds);
    }
    if let Some(bytes) = max_memory {
        all = all.max_memory(bytes);
    }
    all
}

/// The command line: the arguments with the program's name first; the exit status.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    const STACK: usize = 256 << 20;
    const FAILED: u8 = 3;
    py.detach(|| {
        let thread = std::thread::Builder::new().stack_size(STACK);
        let work = thread.spawn(|| bmod::cli::commands::main(arguments));
        work.map_or(FAILED, |t| t.join().unwrap_or(FAILED))
    })
}

#[pymodule]
fn _bmod(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    m.add_class::<Model>()?;
    m.add_class::<run::Run>()?;
    m.add_function(wrap_pyfunction!(main, m)?)
}
