//! The library's front: a model as a value ([`Model`]), what a run is asked for ([`Options`]), what came of it
//! ([`Run`]).

mod digest;
mod error;
mod formulas;
mod host;
mod kept;
mod labels;
mod options;
mod run;
mod symbols;

pub use error::Error;
pub use formulas::{Choice, Formulas, Ranges, Sheet};
pub use labels::Labels;
pub use options::{Control, Options, Progress};
pub use run::{Claim, OutputFile, Run, Solve};
pub use symbols::{
    Columns, Record, Records, Special, Symbol, SymbolKind, VariableRecord, VariableRecords,
};

use crate::check;
use crate::claims;
use crate::data::input::{Input, InputData, Keys};
use crate::host::Host;
use crate::run::{Bases, Machine, Options as Settings};
use crate::session::{self, Finished};
use crate::solve::registry::SOLVERS;
use crate::source::PreprocessOptions;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Sees the machine when a run is over.
type Inspect<'a> = &'a mut dyn FnMut(&mut Machine);

/// Finds the text of a file that a model includes or loads, by the name it uses.
type Resolver = Arc<dyn Fn(&str) -> Option<String> + Send + Sync>;

/// A model: its text, the files it reads, and data given from outside.
///
/// A model is a value. It can be cloned, changed and run again; each run starts from the text.
///
/// ```
/// use bmod::{Model, Options};
///
/// let mut model = Model::from_text(
///     "diet.blk",
///     "Set f 'foods' / bread, milk /;
///      Parameters cost(f) / bread 2, milk 3 /, protein(f) / bread 4, milk 8 /;
///      Scalar need / 40 /;
///      Positive variable x(f);  Variable z;
///      Equations total, enough;
///      total..   z =e= sum(f, cost(f)*x(f));
///      enough..  sum(f, protein(f)*x(f)) =g= need;
///      Model diet / all /;
///      solve diet using lp minimizing z;",
/// );
/// let run = model.run(&Options::default());
/// assert!(run.succeeded());
/// assert_eq!(run.level("x", ["milk"])?, 5.0);
///
/// model.set_scalar("need", 80.0);
/// let run = model.run(&Options::default());
/// assert_eq!(run.solves()[0].objective, Some(30.0));
/// # Ok::<(), bmod::Error>(())
/// ```
#[derive(Clone)]
pub struct Model {
    name: String,
    /// Files in memory, the model's own among them.
    contents: BTreeMap<String, Vec<u8>>,
    resolver: Option<Resolver>,
    /// Files may be read from disk.
    #[cfg(feature = "system")]
    files: Option<crate::system::Files>,
    defines: Vec<(String, String)>,
    inputs: Vec<Arc<Input>>,
    slash_comments: bool,
    /// Another number after each change of the text, of what it may read, or of what stands for `%name%` in it.
    version: u64,
    kept: Option<Arc<kept::Kept>>,
}

/// A number that no model has.
fn new_version() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

impl fmt::Debug for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Model")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}

impl Model {
    /// A model from its text. `name` stands in messages; `.gms` at its end means that `//` begins no comment, as
    /// in GAMS. Files that the text includes are given with [`Model::file`] or found by [`Model::resolver`].
    pub fn from_text(name: impl Into<String>, text: impl Into<String>) -> Self {
        let name = name.into();
        let gams = std::path::Path::new(&name)
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("gms"));
        Self {
            contents: BTreeMap::from([(name.clone(), text.into().into_bytes())]),
            name,
            resolver: None,
            #[cfg(feature = "system")]
            files: None,
            defines: Vec::new(),
            inputs: Vec::new(),
            slash_comments: !gams,
            version: new_version(),
            kept: None,
        }
    }

    /// A model from a file. What it includes is read from its folder and the current folder; nothing is
    /// written to disk ([`Run::files`] has what the model wrote).
    ///
    /// # Errors
    /// [`Error::File`] if the file cannot be read.
    #[cfg(feature = "system")]
    pub fn from_file(path: impl AsRef<std::path::Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let name = path.to_string_lossy().into_owned();
        let files = crate::system::Files::new(path, &[]);
        match files.read(&name, None) {
            Ok((_, text)) => Ok(Self {
                files: Some(files),
                ..Self::from_text(name, text)
            }),
            Err(reason) => Err(Error::File { path: name, reason }),
        }
    }

    /// Lets the model read only the files in its own folder, the current one and those of
    /// [`allow_read`](Self::allow_read): for models of strangers.
    #[cfg(feature = "system")]
    pub fn sandbox(&mut self) -> &mut Self {
        self.files = self.files.take().map(|f| f.sandbox(true));
        self.changed()
    }

    /// Lets the model read files from this folder too.
    #[cfg(feature = "system")]
    pub fn allow_read(&mut self, folder: impl AsRef<std::path::Path>) -> &mut Self {
        let model = std::path::Path::new(&self.name);
        let files = self.files.take();
        let files = files.unwrap_or_else(|| crate::system::Files::new(model, &[]).sandbox(true));
        self.files = Some(files.and_allow(folder.as_ref()));
        self.changed()
    }

    /// Adds a file that the model may include (`$include`) or load data from (`.csv`, `.json`, `.gdx`): a text, or
    /// bytes.
    pub fn file(&mut self, name: impl Into<String>, content: impl Into<Vec<u8>>) -> &mut Self {
        self.contents.insert(name.into(), content.into());
        self.changed()
    }

    /// Finds the files that were not added: gets the name as the model writes it.
    ///
    /// ```
    /// use bmod::{Model, Options};
    ///
    /// let mut model = Model::from_text("m.blk", "$include sizes.inc\nScalar y; y = 2*n;");
    /// model.resolver(|name| (name == "sizes.inc").then(|| "Scalar n / 21 /;".to_string()));
    /// assert_eq!(model.run(&Options::default()).value("y", [])?, 42.0);
    /// # Ok::<(), bmod::Error>(())
    /// ```
    pub fn resolver(
        &mut self,
        resolver: impl Fn(&str) -> Option<String> + Send + Sync + 'static,
    ) -> &mut Self {
        self.resolver = Some(Arc::new(resolver));
        self.changed()
    }

    /// Defines a text that stands for `%name%` in the model, as `bmod run -D name=value` does.
    pub fn define(&mut self, name: impl Into<String>, value: impl fmt::Display) -> &mut Self {
        let (name, value) = (name.into(), value.to_string());
        self.defines.retain(|d| !d.0.eq_ignore_ascii_case(&name));
        self.defines.push((name, value));
        self.changed()
    }

    fn changed(&mut self) -> &mut Self {
        self.version = new_version();
        self
    }

    /// Keeps the compiled text and the bases of the last solves from run to run: after other numbers were given, a run costs
    /// no compilation, and its linear programs start where the last run ended. Off at first, for it takes the room
    /// of a second copy of the data. A clone shares what is kept.
    ///
    /// Each run still starts from the text. Where the solution of a linear program is not unique, another one may be
    /// found than without (`option bratio = 1` starts anew). A model with a [`resolver`](Self::resolver) is compiled each time.
    pub fn keep(&mut self, on: bool) -> &mut Self {
        self.kept = on.then(Arc::default);
        self
    }

    fn give(&mut self, name: String, data: InputData) -> &mut Self {
        let input = Arc::new(Input { name, data });
        let named = |i: &Arc<Input>| i.name.eq_ignore_ascii_case(&input.name);
        match self.inputs.iter().position(named) {
            Some(at) => self.inputs[at] = input,
            None => self.inputs.push(input),
        }
        self
    }

    /// Gives a scalar its value, in place of the one in the text. Assignments of the text are carried out all the
    /// same.
    ///
    /// Whether the model declares such a symbol is checked when it runs; a mistake is a diagnostic of the run. This
    /// holds for [`Model::set_parameter`] and [`Model::set_members`] too.
    pub fn set_scalar(&mut self, name: impl Into<String>, value: f64) -> &mut Self {
        self.give(
            name.into(),
            InputData::Values(Keys::from_records([Vec::new()]), vec![value]),
        )
    }

    /// Gives a parameter its records, in place of those in its data statement; what is not given is 0. The labels
    /// must belong to the parameter's domain: give the sets first if they change.
    ///
    /// ```
    /// use bmod::{Model, Options};
    ///
    /// let mut model = Model::from_text(
    ///     "m.blk",
    ///     "Set i / a, b /;  Parameter d(i) / a 1, b 2 /;  Scalar total;  total = sum(i, d(i));",
    /// );
    /// model.set_members("i", ["x", "y", "z"]);
    /// model.set_parameter("d", [("x", 10.0), ("z", 30.0)]);
    /// assert_eq!(model.run(&Options::default()).value("total", [])?, 40.0);
    ///
    /// model.set_parameter("d", [("w", 10.0)]);
    /// let run = model.run(&Options::default());
    /// assert!(run.diagnostics()[0].message.contains("`w` is not a member of `i`"));
    /// # Ok::<(), bmod::Error>(())
    /// ```
    pub fn set_parameter<K: Labels>(
        &mut self,
        name: impl Into<String>,
        records: impl IntoIterator<Item = (K, f64)>,
    ) -> &mut Self {
        let records = records.into_iter().map(|(k, v)| (k.labels(), v));
        let (keys, values): (Vec<_>, Vec<_>) = records.unzip();
        self.set_values(name, Keys::from_records(keys), values)
    }

    /// The same for many records: labels and values in columns of the same length.
    ///
    /// # Panics
    /// If there are not as many values as keys.
    pub fn set_values(
        &mut self,
        name: impl Into<String>,
        keys: Keys,
        values: Vec<f64>,
    ) -> &mut Self {
        let odd = keys.unlike(keys.dimension()).is_some();
        assert!(odd || keys.len() == values.len(), "a value for each key");
        self.give(name.into(), InputData::Values(keys, values))
    }

    /// Gives a set its members, in place of those in its data statement.
    pub fn set_members<K: Labels>(
        &mut self,
        name: impl Into<String>,
        members: impl IntoIterator<Item = K>,
    ) -> &mut Self {
        let keys = Keys::from_records(members.into_iter().map(|k| k.labels()));
        self.set_elements(name, keys, Vec::new())
    }

    /// The same with an explanatory text for each member.
    pub fn set_members_with_texts<K: Labels>(
        &mut self,
        name: impl Into<String>,
        members: impl IntoIterator<Item = (K, String)>,
    ) -> &mut Self {
        let members = members.into_iter().map(|(k, t)| (k.labels(), t));
        let (keys, texts): (Vec<_>, Vec<_>) = members.unzip();
        self.set_elements(name, Keys::from_records(keys), texts)
    }

    /// The same for many members: labels in columns, and texts, none or as many.
    pub fn set_elements(
        &mut self,
        name: impl Into<String>,
        keys: Keys,
        texts: Vec<String>,
    ) -> &mut Self {
        self.give(name.into(), InputData::Members(keys, texts))
    }

    /// Takes back the data given for a symbol.
    pub fn forget(&mut self, name: &str) -> &mut Self {
        self.inputs.retain(|i| !i.name.eq_ignore_ascii_case(name));
        self
    }

    /// The model's name: its file, or what [`Model::from_text`] was told.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Compiles the model without running it: the [`Run`] has all diagnostics, and the symbols with the data of
    /// the text.
    pub fn check(&self) -> Run {
        self.carry_out(&Options::default(), true)
    }

    /// Runs the model: compiles its text and carries out its statements.
    ///
    /// This never fails by itself: what went wrong is in [`Run::status`] and [`Run::diagnostics`];
    /// [`Run::ok`] turns it into a `Result`. With the feature `system` the work is done on a thread of its own, because deeply
    /// nested texts need a large stack; without it, on the calling thread.
    pub fn run(&self, options: &Options) -> Run {
        self.carry_out(options, false)
    }

    fn carry_out(&self, options: &Options, check_only: bool) -> Run {
        let run = on_large_stack(|| self.carry_out_here(options, check_only));
        run.unwrap_or_else(|| Run::broken(&self.name))
    }

    fn carry_out_here(&self, options: &Options, check_only: bool) -> Run {
        let mut host = host::RunHost::new(self, options);
        let run = match &self.kept {
            None => self.carry_out_on(&mut host, options, check_only),
            Some(kept) => match kept.program(self, &mut host, self.preprocess(options)) {
                Ok((program, _)) if check_only => Run::checked(&self.name, program),
                Ok((program, bases)) => {
                    let execute = |machine: Settings, inspect: Inspect| {
                        session::execute(program, &mut host, machine, inspect)
                    };
                    let (run, bases) = self.ended(options, bases, execute);
                    kept.ended_at(self, bases);
                    run
                }
                Err(e) => Run::unreadable(&self.name, e.0, e.1),
            },
        };
        host.finish(run)
    }

    /// Runs the model on a host of your own, which answers for files, clock and output. On the calling thread, which
    /// needs a large stack for deeply nested texts.
    pub fn run_on(&self, host: &mut dyn Host, options: &Options) -> Run {
        self.carry_out_on(host, options, false)
    }

    fn carry_out_on(&self, host: &mut dyn Host, options: &Options, check_only: bool) -> Run {
        let preprocess = self.preprocess(options);
        if check_only {
            return match check::compile(host, &self.name, preprocess, &SOLVERS) {
                Ok(program) => Run::checked(&self.name, program),
                Err(e) => Run::unreadable(&self.name, e.0, e.1),
            };
        }
        let execute = |machine: Settings, inspect: Inspect| {
            session::run(host, &self.name, preprocess, machine, false, inspect)
        };
        self.ended(options, Bases::default(), execute).0
    }

    fn preprocess(&self, options: &Options) -> PreprocessOptions {
        PreprocessOptions {
            defines: self.defines.clone(),
            slash_comments: self.slash_comments,
            max_memory: options.max_memory,
            inputs: self.inputs.clone(),
            ..PreprocessOptions::default()
        }
    }

    /// Carries out a run from these bases: what came of it, and the bases that it has left.
    fn ended(
        &self,
        options: &Options,
        bases: Bases,
        execute: impl FnOnce(Settings, Inspect) -> Finished,
    ) -> (Run, Bases) {
        let mut ended = run::Ended::default();
        let mut left = Bases::default();
        let settings = Settings {
            bases,
            ..options.for_machine()
        };
        let finished = execute(settings, &mut |machine| {
            if options.keep_solutions {
                ended.solution = Some(machine.solutions(&self.name));
            }
            if let Some(tolerance) = options.claims {
                ended.claims = self.claims(machine, tolerance);
            }
            ended.stopped = machine.stopped() || options.control.is_cancelled();
            left = std::mem::take(&mut machine.options.bases);
            let symbols = std::mem::take(&mut machine.symbols);
            let store = std::mem::take(&mut machine.store);
            ended.data = symbols::Data::new(&symbols, store);
        });
        (Run::finished(&self.name, finished, ended), left)
    }

    /// What the model's own text claims, compared with what the run left.
    fn claims(&self, machine: &mut Machine, tolerance: f64) -> Vec<Claim> {
        let text = self.contents.get(&self.name);
        let text = text.map_or("".into(), |t| String::from_utf8_lossy(t));
        let all = claims::claims(&text);
        let broken = claims::broken(machine, &all, tolerance);
        let found = |line| broken.iter().find(|b| b.0.line == line).map(|b| &b.1);
        let claim = |c: &claims::Claim| Claim {
            line: c.line,
            what: c.what.clone(),
            value: c.value.clone(),
            holds: found(c.line).is_none(),
            found: found(c.line).cloned(),
        };
        all.iter().map(claim).collect()
    }
}

/// Carries something out on a thread with a large stack, where there are threads; `None` after a panic, which is a bug of
/// bmod.
fn on_large_stack<T: Send>(f: impl FnOnce() -> T + Send + Copy) -> Option<T> {
    #[cfg(feature = "system")]
    return std::thread::scope(|scope| {
        const STACK: usize = 256 << 20;
        let builder = std::thread::Builder::new().name("bmod".into());
        match builder.stack_size(STACK).spawn_scoped(scope, f) {
            Ok(thread) => thread.join().ok(),
            Err(_) => Some(f()),
        }
    });
    #[cfg(not(feature = "system"))]
    Some(f())
}
