//! bmod for a page (and for Node.js): a request in JSON goes in, an answer in JSON comes out.
//!
//! The module is a WASI reactor; of WASI it needs the clock, random numbers and standard error. What a run prints and how far
//! it is comes while it runs, through `bmod.print` and `bmod.progress`. A page that stops a run ends its worker.

mod edit;

use bmod::{Choice, Diagnostic, Model, Options, Run, Symbol, SymbolKind};
use serde::{Deserialize, Serialize};
use serde_json::value::{RawValue, Value};
use std::cell::RefCell;
use std::collections::BTreeMap;

#[link(wasm_import_module = "bmod")]
unsafe extern "C" {
    safe fn print(text: *const u8, bytes: usize);
    safe fn progress(text: *const u8, bytes: usize);
}

/// Relative tolerance for claims in comments: that of `bmod test`.
const TOLERANCE: f64 = 1e-6;
/// Rows and columns of each symbol that a listing shows.
const LISTED: usize = 20;

/// What the page asks for.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "lowercase")]
enum Request {
    /// A question of the editor.
    Edit(edit::Edit),
    /// A run.
    Run(Project),
    /// Another view of a model: `formulas`, `dual`, `kkt`, `words`, `prices`, `rows`, `steps`.
    View {
        view: String,
        #[serde(flatten)]
        project: Project,
    },
    /// The records of a symbol of the last run.
    Records { name: String },
}

/// A model with the files that it reads, and what is set from outside.
#[derive(Deserialize)]
struct Project {
    /// The file to run, one of `files`.
    file: String,
    /// Texts by name.
    files: BTreeMap<String, String>,
    /// Seconds that a run may take.
    time_limit: Option<f64>,
    /// Bytes that it may hold.
    max_memory: Option<usize>,
    /// Why a solve ended as it did.
    #[serde(default)]
    explain: bool,
    /// Options as `bmod run --option` takes them.
    #[serde(default)]
    options: Vec<(String, String)>,
    /// Values of scalars, in place of those in the text: sliders.
    #[serde(default)]
    scalars: Vec<(String, f64)>,
    /// Texts that stand for `%NAME%`: sliders too.
    #[serde(default)]
    defines: Vec<(String, String)>,
}

/// What a run gives.
#[derive(Serialize)]
struct Answer<'a> {
    /// What `bmod run --json` writes.
    report: Box<RawValue>,
    /// Diagnostics as text.
    messages: &'a str,
    /// What the model printed.
    printed: &'a str,
    /// Files that the model wrote, those that are texts.
    files: BTreeMap<&'a str, &'a str>,
    symbols: Vec<About<'a>>,
    claims: Vec<Claim<'a>>,
    /// Bytes that the module holds.
    memory: usize,
}

/// A symbol without its records.
#[derive(Serialize)]
struct About<'a> {
    name: &'a str,
    kind: &'static str,
    text: &'a str,
    domain: &'a [String],
    records: usize,
}

/// A view: a part of a page in HTML, or a text.
#[derive(Default, Serialize)]
struct Page {
    html: String,
    text: String,
    /// Sentences beside it.
    remarks: Vec<String>,
    /// The same as a model that runs.
    model: String,
    /// Why there is none.
    diagnostics: Vec<Diagnostic>,
}

#[derive(Serialize)]
struct Claim<'a> {
    what: &'a str,
    holds: bool,
}

/// The records of a symbol: a table.
#[derive(Serialize)]
struct Table<'a> {
    name: &'a str,
    head: Vec<&'a str>,
    rows: Vec<Vec<Value>>,
}

thread_local! {
    static LAST: RefCell<Option<Run>> = const { RefCell::new(None) };
}

fn carry_out(request: Request) -> String {
    match request {
        Request::Edit(question) => edit::answer(question),
        Request::Run(project) => match project.model() {
            Ok(model) => {
                let run = model.run(&project.run_options());
                let answer = answer(&run);
                LAST.set(Some(run));
                answer
            }
            Err(why) => error(why),
        },
        Request::View { view, project } => match project.model() {
            Ok(model) => view_of(&view, &model, &project.run_options()),
            Err(why) => error(why),
        },
        Request::Records { name } => LAST.with_borrow(|run| {
            let symbol = run.as_ref().and_then(|r| r.symbol(&name).ok());
            symbol.map_or_else(|| error("there is no such symbol"), |s| written(&table(s)))
        }),
    }
}

impl Project {
    fn model(&self) -> Result<Model, &'static str> {
        let text = self.files.get(&self.file);
        let text = text.ok_or("the request names no file of its own")?;
        let mut model = Model::from_text(&self.file, text);
        for (name, text) in &self.files {
            model.file(name, text.as_str());
        }
        for (name, value) in &self.scalars {
            model.set_scalar(name, *value);
        }
        for (name, value) in &self.defines {
            model.define(name, value);
        }
        Ok(model)
    }

    fn run_options(&self) -> Options {
        let mut options = Options::default()
            .clock(clock)
            .claims(TOLERANCE)
            .explain(self.explain)
            .on_print(|t| print(t.as_ptr(), t.len()))
            .on_progress(|t| progress(t.as_ptr(), t.len()));
        if let Some(seconds) = self.time_limit {
            options = options.time_limit(seconds);
        }
        if let Some(bytes) = self.max_memory {
            options = options.max_memory(bytes);
        }
        for (name, value) in &self.options {
            options = options.option(name, value);
        }
        options
    }
}

fn view_of(view: &str, model: &Model, options: &Options) -> String {
    let choice = Choice::default().check(true);
    let formulas = match view {
        "formulas" => model.show(&Choice::default()),
        "dual" => model.dual(&choice, options),
        "kkt" => model.kkt(&choice, options),
        "words" => return sheet(model.explain(&choice, options)),
        "prices" => return sheet(model.ranges(&choice, options).map(|r| r.sheet)),
        "rows" => return printed(model, &options.clone().list(LISTED)),
        "steps" => return printed(model, &options.clone().option("log", "1")),
        _ => return error("there is no such view"),
    };
    match formulas {
        Ok(f) => written(&Page {
            html: f.html_body(),
            remarks: f.remarks().to_vec(),
            model: f.as_model().into(),
            ..Page::default()
        }),
        Err(e) => refused(e),
    }
}

/// What a run prints.
fn printed(model: &Model, options: &Options) -> String {
    let run = model.run(options);
    written(&Page {
        text: run.printed().into(),
        diagnostics: run.diagnostics().to_vec(),
        ..Page::default()
    })
}

fn sheet(sheet: Result<bmod::Sheet, bmod::Error>) -> String {
    match sheet {
        Ok(s) => written(&Page {
            html: s.html_body(),
            ..Page::default()
        }),
        Err(e) => refused(e),
    }
}

fn refused(e: bmod::Error) -> String {
    match e {
        bmod::Error::Model { diagnostics, .. } => written(&Page {
            diagnostics,
            ..Page::default()
        }),
        e => error(&e.to_string()),
    }
}

fn answer(run: &Run) -> String {
    let files = run.files().iter();
    written(&Answer {
        report: RawValue::from_string(run.to_json()).unwrap_or_default(),
        messages: run.messages(),
        printed: run.printed(),
        files: files.filter_map(|f| Some((&*f.name, f.text()?))).collect(),
        symbols: run.symbols().filter_map(about).collect(),
        claims: run
            .claims()
            .iter()
            .map(|c| Claim {
                what: &c.what,
                holds: c.holds,
            })
            .collect(),
        memory: memory(),
    })
}

fn about(s: Symbol<'_>) -> Option<About<'_>> {
    let (kind, records) = match s.kind() {
        SymbolKind::Set if s.alias_of().is_none() => ("set", s.records().count()),
        SymbolKind::Parameter => ("parameter", s.records().count()),
        SymbolKind::Variable => ("variable", s.variable_records().count()),
        SymbolKind::Equation => ("equation", s.variable_records().count()),
        _ => return None,
    };
    Some(About {
        name: s.name(),
        kind,
        text: s.text(),
        domain: s.domain(),
        records,
    })
}

fn table(s: Symbol<'_>) -> Table<'_> {
    let mut head: Vec<&str> = s.domain().iter().map(String::as_str).collect();
    let labels = |l: Vec<&str>| l.into_iter().map(Value::from).collect::<Vec<_>>();
    let rows = match s.kind() {
        SymbolKind::Set => {
            head.push("text");
            s.records()
                .map(|r| [labels(r.labels), vec![r.text.into()]].concat())
                .collect()
        }
        SymbolKind::Parameter => {
            head.push("value");
            s.records()
                .map(|r| [labels(r.labels), vec![number(r.value)]].concat())
                .collect()
        }
        _ => {
            head.extend(["lower", "level", "upper", "marginal"]);
            let row = |r: bmod::VariableRecord<'_>| {
                let numbers = [r.lower, r.level, r.upper, r.marginal].map(number);
                [labels(r.labels), numbers.to_vec()].concat()
            };
            s.variable_records().map(row).collect()
        }
    };
    Table {
        name: s.name(),
        head,
        rows,
    }
}

/// JSON has no infinities: they are written as in the report.
fn number(x: f64) -> Value {
    match x {
        f64::INFINITY => "+INF".into(),
        f64::NEG_INFINITY => "-INF".into(),
        x if x.is_nan() => "NA".into(),
        x => x.into(),
    }
}

fn written(answer: &impl Serialize) -> String {
    serde_json::to_string(answer).unwrap_or_else(|e| error(&e.to_string()))
}

fn error(text: &str) -> String {
    serde_json::json!({ "error": text }).to_string()
}

fn clock() -> f64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    since.map_or(0.0, |d| d.as_secs_f64())
}

fn memory() -> usize {
    #[cfg(target_arch = "wasm32")]
    return core::arch::wasm32::memory_size(0) * 65536;
    #[cfg(not(target_arch = "wasm32"))]
    0
}

/// Memory for a request of `n` bytes.
#[unsafe(no_mangle)]
pub extern "C" fn bmod_alloc(n: usize) -> *mut u8 {
    Box::leak(vec![0; n].into_boxed_slice()).as_mut_ptr()
}

/// Takes a request of `n` bytes that [`bmod_alloc`] gave, and frees it; the address of the answer: its length in four
/// bytes, then itself.
///
/// # Safety
/// `p` comes from `bmod_alloc(n)` and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bmod_call(p: *mut u8, n: usize) -> *mut u8 {
    // SAFETY: the caller's promise.
    let bytes = unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(p, n)) };
    let answer = match serde_json::from_slice(&bytes) {
        Ok(request) => carry_out(request),
        Err(e) => error(&e.to_string()),
    };
    let mut out = Vec::with_capacity(4 + answer.len());
    out.extend((answer.len() as u32).to_le_bytes());
    out.extend(answer.as_bytes());
    Box::leak(out.into_boxed_slice()).as_mut_ptr()
}

/// Frees an answer.
///
/// # Safety
/// `p` comes from [`bmod_call`] and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bmod_free(p: *mut u8) {
    // SAFETY: the caller's promise; the length stands in the first four bytes.
    unsafe {
        let mut n = [0; 4];
        n.copy_from_slice(std::slice::from_raw_parts(p, 4));
        let n = u32::from_le_bytes(n) as usize + 4;
        drop(Box::from_raw(std::ptr::slice_from_raw_parts_mut(p, n)));
    }
}
