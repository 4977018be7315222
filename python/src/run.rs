//! A run: carried out beside Python, and what came of it.

use super::{data, raise};
use bmod::{Control, Diagnostic, Options, Place, Severity, Solve};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes, PyDict, PyList};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// How often the calling thread looks for signals.
const POLL: Duration = Duration::from_millis(50);

enum Message {
    Printed(String),
    Done,
}

/// Runs a model on another thread; the calling one waits without the interpreter, looks for signals, and calls
/// back. Ctrl-C stops the run, which then gives the best point it has.
pub fn carry_out(
    py: Python<'_>,
    model: &bmod::Model,
    options: Options,
    on_print: Option<Py<PyAny>>,
    on_progress: Option<Py<PyAny>>,
) -> PyResult<(Run, bool)> {
    let control = Control::new();
    let (tell, told) = channel();
    let done = tell.clone();
    let mut options = options.control(&control);
    if on_print.is_some() {
        options = options.on_print(move |text| {
            // The receiver lives as long as the run.
            let _ = tell.send(Message::Printed(text.to_string()));
        });
    }
    let (run, interrupted, raised) = py.detach(move || {
        std::thread::scope(|scope| {
            let options = &options;
            let worker = scope.spawn(move || {
                let run = model.run(options);
                let _ = done.send(Message::Done);
                run
            });
            let (mut interrupted, mut raised) = (false, None);
            let mut message = String::new();
            let mut looked = Instant::now();
            let mut stop = |e: PyErr, py: Python<'_>| {
                control.cancel();
                if e.is_instance_of::<PyKeyboardInterrupt>(py) && !interrupted {
                    interrupted = true;
                } else {
                    raised = Some(e);
                }
            };
            loop {
                match told.recv_timeout(POLL) {
                    Ok(Message::Done) | Err(RecvTimeoutError::Disconnected) => break,
                    Ok(Message::Printed(text)) => {
                        Python::attach(|py| {
                            let called = on_print.as_ref().map(|f| f.call1(py, (text,)));
                            if let Some(Err(e)) = called {
                                stop(e, py);
                            }
                        });
                    }
                    Err(RecvTimeoutError::Timeout) if worker.is_finished() => break,
                    Err(RecvTimeoutError::Timeout) => {}
                }
                // A model that prints without pause leaves no timeout.
                if looked.elapsed() < POLL {
                    continue;
                }
                looked = Instant::now();
                let progress = control.progress();
                Python::attach(|py| {
                    if let Err(e) = py.check_signals() {
                        stop(e, py);
                    }
                    // Who has stopped it is told nothing more: another signal from there would lose the answer.
                    if let Some(f) = on_progress.as_ref().filter(|_| !control.is_cancelled())
                        && progress.message != message
                    {
                        let arguments = (&progress.message, progress.seconds);
                        if let Err(e) = f.call1(py, arguments) {
                            stop(e, py);
                        }
                    }
                });
                message = progress.message;
            }
            (worker.join(), interrupted, raised)
        })
    });
    match (raised, run) {
        (Some(e), _) => Err(e),
        (None, Ok(run)) => Ok((Run::new(run), interrupted)),
        (None, Err(_)) => Err(pyo3::exceptions::PyRuntimeError::new_err(
            "bmod itself failed; this is a bug in bmod, not in the model",
        )),
    }
}

/// What came of a run.
#[pyclass(frozen, module = "bmod._bmod")]
pub struct Run {
    run: bmod::Run,
}

impl Run {
    pub fn new(run: bmod::Run) -> Self {
        Self { run }
    }
}

/// Name, kind, index sets, text; of an alias its set.
type Symbol = (String, String, Vec<String>, String, Option<String>);

/// Labels and codes of each position, names and numbers of each column, texts of a set's members.
type Records<'py> = (
    Vec<(Vec<String>, Bound<'py, PyByteArray>)>,
    Vec<(&'static str, Bound<'py, PyByteArray>)>,
    Option<Vec<String>>,
);

#[pymethods]
impl Run {
    /// `ok`, `compilation_error`, `execution_error`, `aborted` or `interrupted`.
    #[getter]
    fn status(&self) -> &'static str {
        match self.run.status() {
            bmod::RunStatus::Ok => "ok",
            bmod::RunStatus::CompilationError => "compilation_error",
            bmod::RunStatus::ExecutionError => "execution_error",
            bmod::RunStatus::Aborted => "aborted",
            bmod::RunStatus::Interrupted => "interrupted",
        }
    }

    #[getter]
    fn stopped(&self) -> bool {
        self.run.was_stopped()
    }

    #[getter]
    fn messages(&self) -> &str {
        self.run.messages()
    }

    #[getter]
    fn printed(&self) -> &str {
        self.run.printed()
    }

    /// What the run read, for `Model.still_reads`.
    #[getter]
    fn reads(&self) -> &str {
        self.run.reads()
    }

    /// Defined names that the text never asks for.
    #[getter]
    fn unused_defines(&self) -> Vec<String> {
        self.run.unused_defines().to_vec()
    }

    /// All symbols in order of declaration.
    fn symbols(&self) -> Vec<Symbol> {
        let one = |s: bmod::Symbol<'_>| {
            let (name, text) = (s.name().to_string(), s.text().to_string());
            let alias_of = s.alias_of().map(String::from);
            (
                name,
                s.kind().to_string(),
                s.domain().to_vec(),
                text,
                alias_of,
            )
        };
        self.run.symbols().map(one).collect()
    }

    /// The files that the model wrote.
    fn files<'py>(&self, py: Python<'py>) -> Vec<(String, Bound<'py, PyBytes>)> {
        let files = self.run.files().iter();
        files
            .map(|f| (f.name.clone(), PyBytes::new(py, &f.bytes)))
            .collect()
    }

    fn figures(&self) -> Vec<(String, String)> {
        let figures = self.run.figures();
        figures.map(|(n, t)| (n.into(), t.into())).collect()
    }

    /// The records of a symbol as columns.
    fn records<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Records<'py>> {
        let symbol = self.run.symbol(name).map_err(raise)?;
        let columns = symbol.columns();
        if columns.values.is_empty() && columns.texts.is_none() {
            let kind = symbol.kind();
            return Err(pyo3::exceptions::PyValueError::new_err(format!(
                "`{name}` is a {kind}; it has no records"
            )));
        }
        let position = |p: usize| {
            let codes = data::code_bytes(py, columns.keys.codes(p))?;
            Ok((columns.keys.labels(p).to_vec(), codes))
        };
        let keys = (0..columns.keys.dimension()).map(position);
        let values = columns.values.iter();
        let values = values.map(|(n, v)| Ok((*n, data::float_bytes(py, v)?)));
        Ok((
            keys.collect::<PyResult<_>>()?,
            values.collect::<PyResult<_>>()?,
            columns.texts,
        ))
    }

    /// Level, marginal, lower and upper bound of what is not stored of a variable or an equation.
    fn defaults(&self, name: &str) -> PyResult<[f64; 4]> {
        let symbol = self.run.symbol(name).map_err(raise)?;
        symbol.defaults().map_err(raise)
    }

    fn solves<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.run.solves().iter().map(|s| solve(py, s)).collect()
    }

    fn diagnostics<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let all = self.run.diagnostics().iter();
        all.map(|d| diagnostic(py, d)).collect()
    }

    fn to_json(&self) -> String {
        self.run.to_json()
    }
}

fn solve<'py>(py: Python<'py>, s: &Solve) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    d.set_item("model", &s.model)?;
    d.set_item("using", s.using.name())?;
    d.set_item("sense", s.sense.map(|sense| sense.name()))?;
    d.set_item("solver", &s.solver)?;
    d.set_item("model_status", s.model_status as u8)?;
    d.set_item("solver_status", s.solver_status as u8)?;
    d.set_item("objective_variable", &s.objective_variable)?;
    d.set_item("objective", s.objective)?;
    d.set_item("bounds", s.bounds.map(|b| (b[0], b[1])))?;
    d.set_item("rows", s.rows)?;
    d.set_item("columns", s.columns)?;
    d.set_item("nonzeros", s.nonzeros)?;
    d.set_item("nonlinear_nonzeros", s.nonlinear_nonzeros)?;
    d.set_item("iterations", s.iterations)?;
    d.set_item("seconds", s.seconds.total)?;
    let residuals = PyDict::new(py);
    residuals.set_item("primal", s.residuals.primal)?;
    residuals.set_item("dual", s.residuals.dual)?;
    residuals.set_item("complementarity", s.residuals.complementarity)?;
    residuals.set_item("natural", s.residuals.natural)?;
    d.set_item("residuals", residuals)?;
    d.set_item("stationarity", s.stationarity)?;
    d.set_item("message", &s.message)?;
    d.set_item("explanation", PyList::new(py, &s.explanation)?)?;
    Ok(d)
}

/// A diagnostic as a dict.
pub fn diagnostic<'py>(py: Python<'py>, d: &Diagnostic) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    out.set_item("code", d.code)?;
    let severity = match d.severity {
        Severity::Warning => "warning",
        _ => "error",
    };
    out.set_item("severity", severity)?;
    out.set_item("message", &d.message)?;
    out.set_item("label", &d.label)?;
    out.set_item("help", &d.help)?;
    let place = |p: &Option<Place>| {
        p.as_ref()
            .map(|p| (p.file.clone(), p.line, p.column, p.end_line, p.end_column))
    };
    out.set_item("place", place(&d.place))?;
    let related: Vec<_> = d
        .related
        .iter()
        .map(|r| (place(&r.place), r.text.clone()))
        .collect();
    out.set_item("related", related)?;
    Ok(out)
}
