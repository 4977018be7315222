//! The library's front: a model as a value ([`Model`]), what a run is asked for ([`Options`]), what came of it
//! ([`Run`]).

mod error;
mod formulas;
mod host;
mod labels;
mod options;
mod run;
pub mod solver;
mod symbols;

pub use error::Error;
pub use formulas::{Choice, Formulas, Sheet};
pub use labels::Labels;
pub use options::{Control, Options, Progress};
pub use run::{Claim, OutputFile, Run, Solve};
pub use symbols::{Record, Records, Special, Symbol, SymbolKind, VariableRecord, VariableRecords};

use crate::check;
use crate::claims;
use crate::data::input::{Input, InputData};
use crate::host::Host;
use crate::run::Machine;
use crate::session;
use crate::solve::registry::OPTION_TABLES;
use crate::source::PreprocessOptions;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

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
    inputs: Vec<Input>,
    slash_comments: bool,
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
        self
    }

    /// Lets the model read files from this folder too.
    #[cfg(feature = "system")]
    pub fn allow_read(&mut self, folder: impl AsRef<std::path::Path>) -> &mut Self {
        let model = std::path::Path::new(&self.name);
        let files = self.files.take();
        let files = files.unwrap_or_else(|| crate::system::Files::new(model, &[]).sandbox(true));
        self.files = Some(files.and_allow(folder.as_ref()));
        self
    }

    /// Adds a file that the model may include (`$include`) or load data from (`.csv`, `.json`, `.gdx`): a text, or
    /// bytes.
    pub fn file(&mut self, name: impl Into<String>, content: impl Into<Vec<u8>>) -> &mut Self {
        self.contents.insert(name.into(), content.into());
        self
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
        self
    }

    /// Defines a text that stands for `%name%` in the model, as `bmod run -D name=value` does.
    pub fn define(&mut self, name: impl Into<String>, value: impl fmt::Display) -> &mut Self {
        let (name, value) = (name.into(), value.to_string());
        self.defines.retain(|d| !d.0.eq_ignore_ascii_case(&name));
        self.defines.push((name, value));
        self
    }

    fn give(&mut self, name: String, data: InputData) -> &mut Self {
        self.forget(&name);
        self.inputs.push(Input { name, data });
        self
    }

    /// Gives a scalar its value, in place of the one in the text. Assignments of the text are carried out all the
    /// same.
    ///
    /// Whether the model declares such a symbol is checked when it runs; a mistake is a diagnostic of the run. This
    /// holds for [`Model::set_parameter`] and [`Model::set_members`] too.
    pub fn set_scalar(&mut self, name: impl Into<String>, value: f64) -> &mut Self {
        self.give(name.into(), InputData::Values(vec![(Vec::new(), value)]))
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
        self.give(name.into(), InputData::Values(records.collect()))
    }

    /// Gives a set its members, in place of those in its data statement.
    pub fn set_members<K: Labels>(
        &mut self,
        name: impl Into<String>,
        members: impl IntoIterator<Item = K>,
    ) -> &mut Self {
        let members = members.into_iter().map(|k| (k.labels(), String::new()));
        self.give(name.into(), InputData::Members(members.collect()))
    }

    /// The same with an explanatory text for each member.
    pub fn set_members_with_texts<K: Labels>(
        &mut self,
        name: impl Into<String>,
        members: impl IntoIterator<Item = (K, String)>,
    ) -> &mut Self {
        let members = members.into_iter().map(|(k, t)| (k.labels(), t));
        self.give(name.into(), InputData::Members(members.collect()))
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
        let run = self.carry_out_on(&mut host, options, check_only);
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
            return match check::compile(host, &self.name, preprocess, OPTION_TABLES) {
                Ok(program) => Run::checked(&self.name, program),
                Err(e) => Run::unreadable(&self.name, e.0, e.1),
            };
        }
        let mut ended = run::Ended::default();
        let finished = session::run(
            host,
            &self.name,
            preprocess,
            options.for_machine(),
            false,
            &mut |machine| {
                if options.keeps_solutions() {
                    ended.solution = Some(machine.solutions(&self.name));
                }
                if let Some(tolerance) = options.claim_tolerance() {
                    ended.claims = self.claims(machine, tolerance);
                }
                ended.stopped = machine.stopped() || options.control.is_cancelled();
                let symbols = std::mem::take(&mut machine.symbols);
                let store = std::mem::take(&mut machine.store);
                ended.data = symbols::Data::new(&symbols, store);
            },
        );
        Run::finished(&self.name, finished, ended)
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

    fn preprocess(&self, options: &Options) -> PreprocessOptions {
        PreprocessOptions {
            defines: self.defines.clone(),
            slash_comments: self.slash_comments,
            max_memory: options.memory_limit(),
            inputs: self.inputs.clone(),
        }
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
