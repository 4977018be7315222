//! Models as formulas: as they are written, their duals, their optimality conditions; ranges and answers in words.

use super::host::RunHost;
use super::{Error, Model, Options, on_large_stack};
use crate::check;
use crate::diag;
use crate::formulation::algebra::{Algebra, algebra};
use crate::formulation::check::Comparison;
use crate::formulation::derive::Primal;
use crate::formulation::derived::Kind;
use crate::formulation::page::{Block, Format, Page, body, write};
use crate::formulation::{Formulation, Scope, explain, range, show, study};
use crate::report::diagnostic::Diagnostic;
use crate::report::diagnostics::{self, Look};
use crate::run::{self, Machine, Studied, StudyChoice};
use crate::session;
use crate::solve::range::{CostRange, RowRange};
use crate::solve::registry::SOLVERS;
use crate::source::SourceMap;

/// Which model of a text is meant, and what is made of it besides formulas. The default is the model that is solved last.
///
/// ```
/// let choice = bmod::Choice::default().model("transport").check(true);
/// ```
#[derive(Clone, Debug, Default)]
#[must_use]
pub struct Choice {
    model: Option<String>,
    solve: Option<usize>,
    check: bool,
    numbers: bool,
}

impl Choice {
    /// The model of this name.
    pub fn model(mut self, name: impl Into<String>) -> Self {
        self.model = Some(name.into());
        self
    }

    /// The solve with this number, counted from 1.
    pub fn solve(mut self, number: usize) -> Self {
        self.solve = Some(number);
        self
    }

    /// Writes one row of each equation with its numbers beside the formula, and the coefficients of a small model. For
    /// [`Model::show`], which then runs the model.
    pub fn numbers(mut self, on: bool) -> Self {
        self.numbers = on;
        self
    }

    /// Generates what is derived and compares it with the model it comes from ([`Formulas::check`]).
    pub fn check(mut self, on: bool) -> Self {
        self.check = on;
        self
    }
}

/// A model as formulas, to be read ([`Formulas::text`], [`Formulas::latex`], [`Formulas::html`]) and as trees
/// ([`Formulas::algebra`]).
///
/// ```
/// use bmod::{Choice, Model, Options};
///
/// let model = Model::from_text(
///     "diet.blk",
///     "Set f 'foods' / bread, milk /;
///      Parameters cost(f) / bread 2, milk 3 /, protein(f) / bread 4, milk 8 /;
///      Positive variable x(f);  Variable z;
///      Equations total, enough;
///      total..   z =e= sum(f, cost(f)*x(f));
///      enough..  sum(f, protein(f)*x(f)) =g= 40;
///      Model diet / all /;
///      solve diet using lp minimizing z;",
/// );
/// let shown = model.show(&Choice::default())?;
/// assert!(shown.text(80).contains("∑{f} protein(f)·x(f) ≥ 40"));
///
/// let dual = model.dual(&Choice::default().check(true), &Options::default())?;
/// assert!(dual.check().is_some_and(|c| c.passed()));
/// assert!(dual.text(80).contains("dual_x  protein(f)·y_enough ≤ cost(f)"));
///
/// // It is a model as well: its levels are the marginals of the first.
/// let run = Model::from_text("dual.blk", dual.as_model()).run(&Options::default());
/// assert_eq!(run.level("y_enough", [])?, 0.375);
/// # Ok::<(), bmod::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Formulas {
    title: String,
    page: Page,
    algebra: Algebra,
    model: String,
    remarks: Vec<String>,
    check: Option<Comparison>,
}

impl Formulas {
    fn shown(m: &Machine, page: Page, f: &Formulation) -> Self {
        Self {
            title: f.name.clone(),
            page,
            algebra: algebra(Scope::of(m), f),
            model: String::new(),
            remarks: Vec::new(),
            check: None,
        }
    }

    /// Its title.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// For a terminal of so many characters, in Unicode.
    pub fn text(&self, width: usize) -> String {
        self.write(Format::Text(width))
    }

    /// A document in LaTeX, which needs `amsmath`.
    pub fn latex(&self) -> String {
        self.write(Format::Latex)
    }

    /// A page in HTML with MathML, which needs nothing else.
    pub fn html(&self) -> String {
        self.write(Format::Html)
    }

    /// The same as a part of a page: no head, no style.
    pub fn html_body(&self) -> String {
        body(&self.page)
    }

    fn write(&self, format: Format) -> String {
        write(&self.page, format, &self.title)
    }

    /// Its equations and variables as trees; `serde` makes JSON of them.
    pub fn algebra(&self) -> &Algebra {
        &self.algebra
    }

    /// The derived model as a text that stands alone: the sets and data it needs have their values at the solve. Empty
    /// for a model that is only shown.
    pub fn as_model(&self) -> &str {
        &self.model
    }

    /// What the comparison found, if [`Choice::check`] asked for it.
    pub fn check(&self) -> Option<&Comparison> {
        self.check.as_ref()
    }

    /// Sentences to be read beside it: what could not be derived in symbols, what the comparison found.
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }
}

/// Tables and sentences: [`Ranges::sheet`], [`Model::explain`].
#[derive(Clone, Debug)]
pub struct Sheet(Page);

impl Sheet {
    /// For a terminal of so many characters, in Unicode.
    pub fn text(&self, width: usize) -> String {
        write(&self.0, Format::Text(width), "")
    }

    /// A part of a page in HTML.
    pub fn html_body(&self) -> String {
        body(&self.0)
    }
}

/// In which intervals the prices and the solution of a linear program hold: [`Model::ranges`].
#[derive(Clone, Debug)]
pub struct Ranges {
    /// By name of a row.
    pub rows: Vec<(String, RowRange)>,
    /// By name of a column.
    pub columns: Vec<(String, CostRange)>,
    /// Some are missing: their time is used up, or they are lost in rounding.
    pub unfinished: bool,
    /// All of it to be read.
    pub sheet: Sheet,
}

/// What is asked of a solve that has run: what it answers, or why it cannot.
type Question<'a, T> =
    &'a (dyn Fn(&Machine, &Primal, &Studied) -> Result<T, Box<diag::Diagnostic>> + Sync);

impl Model {
    /// A model as formulas. Nothing is run, unless [`Choice::numbers`] asks for it.
    ///
    /// # Errors
    /// [`Error::Model`] if the text does not compile or has no such model.
    pub fn show(&self, choice: &Choice) -> Result<Formulas, Error> {
        if !choice.numbers {
            return on_large_stack(|| self.show_here(choice)).unwrap_or_else(broken);
        }
        self.study(choice, &Options::default(), &|m, primal, studied| {
            let chosen = show::Chosen::of(studied);
            let (page, f) = show::page(m, &m.code, &chosen, Some(primal));
            Ok(Formulas::shown(m, page, &f))
        })
    }

    /// The dual of a linear model, with its indices; the levels are the marginals of the model. The model is run: data and
    /// answer are those of the solve that is meant.
    ///
    /// # Errors
    /// [`Error::Model`] if the run fails, if there is no such solve, or if its model has no dual.
    pub fn dual(&self, choice: &Choice, options: &Options) -> Result<Formulas, Error> {
        self.derive(Kind::Dual, choice, options)
    }

    /// The optimality conditions (Karush, Kuhn, Tucker) of a smooth model, with its indices; as a model, a complementarity
    /// problem that begins at the answer of the solve. The model is run.
    ///
    /// # Errors
    /// [`Error::Model`] if the run fails, if there is no such solve, or if its model is not smooth.
    pub fn kkt(&self, choice: &Choice, options: &Options) -> Result<Formulas, Error> {
        self.derive(Kind::Kkt, choice, options)
    }

    fn derive(&self, kind: Kind, choice: &Choice, options: &Options) -> Result<Formulas, Error> {
        self.study(choice, options, &|m, primal, studied| {
            let d = kind.derive(m, primal, studied, choice.check, true)?;
            Ok(Formulas {
                model: d.model(m, primal, &self.name, None),
                remarks: d.remarks(),
                check: d.check,
                title: d.title,
                ..Formulas::shown(m, d.page, &d.formulation)
            })
        })
    }

    fn show_here(&self, choice: &Choice) -> Result<Formulas, Error> {
        let options = Options::default();
        let mut host = RunHost::new(self, &options);
        let preprocess = self.preprocess(&options);
        let program = check::compile(&mut host, &self.name, preprocess, &SOLVERS)
            .map_err(|e| refused(&[e.0], &e.1))?;
        if program.has_errors() {
            return Err(refused(&program.diagnostics, &program.map));
        }
        let (m, code) = Machine::new(program, &mut host, run::Options::default());
        let chosen = show::choose(&m, &code, choice.model.as_deref()).map_err(|why| {
            let d = diag::Diagnostic::execution("E0430", crate::source::Span::default()).says(why);
            refused(&[d], &m.map)
        })?;
        let (page, f) = show::page(&m, &code, &chosen, None);
        Ok(Formulas::shown(&m, page, &f))
    }

    /// The ranges of a linear program: in which intervals of the right-hand sides the prices hold, in which intervals of the
    /// objective's coefficients the solution stays optimal. The model is run.
    ///
    /// ```
    /// # use bmod::{Choice, Model, Options};
    /// let text = "Positive variable x; Variable z; Equations o, e; o.. z =e= 3*x; e.. 2*x =l= 8; Model m / all /;
    ///             solve m using lp maximizing z;";
    /// let ranges = Model::from_text("m.blk", text).ranges(&Choice::default(), &Options::default())?;
    /// let (name, e) = &ranges.rows[0];
    /// assert_eq!((&**name, e.price, e.interval), ("e", [1.5, 1.5], [0.0, f64::INFINITY]));
    /// # Ok::<(), bmod::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Model`] if the run fails, if there is no such solve, if it is not linear or has no optimal answer.
    pub fn ranges(&self, choice: &Choice, options: &Options) -> Result<Ranges, Error> {
        self.study(choice, options, &|m, primal, studied| {
            let found = range::of(m, primal, studied, &[])?;
            let o = &primal.generated.origin;
            let sheet = Sheet(range::page(m, primal, &found));
            let rows = found.rows.into_iter();
            let columns = found.costs.into_iter();
            Ok(Ranges {
                rows: rows.map(|r| (range::named(m, &o.rows, r.row), r)).collect(),
                columns: columns
                    .map(|c| (range::named(m, &o.columns, c.column), c))
                    .collect(),
                unfinished: found.unfinished,
                sheet,
            })
        })
    }

    /// What a model decides, what its answer is and what binds, in words. The model is run.
    ///
    /// ```
    /// # use bmod::{Choice, Model, Options};
    /// let text = "Positive variable x; Variable z; Equation e; e.. z =e= 3*x; x.up = 4; Model m / e /;
    ///             solve m using lp maximizing z;";
    /// let words = Model::from_text("m.blk", text).explain(&Choice::default(), &Options::default())?;
    /// assert!(words.text(80).contains("12"), "{}", words.text(80));
    /// # Ok::<(), bmod::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Model`] if the run fails or there is no such solve.
    pub fn explain(&self, choice: &Choice, options: &Options) -> Result<Sheet, Error> {
        self.study(choice, options, &|m, primal, studied| {
            let words = explain::of(m, primal, studied).0;
            Ok(Sheet(words.into_iter().map(Block::Words).collect()))
        })
    }

    /// Runs the model and looks at the solve that is meant.
    fn study<T: Send>(
        &self,
        choice: &Choice,
        options: &Options,
        f: Question<'_, T>,
    ) -> Result<T, Error> {
        on_large_stack(|| self.study_here(choice, options, f)).unwrap_or_else(broken)
    }

    fn study_here<T>(
        &self,
        choice: &Choice,
        options: &Options,
        f: Question<'_, T>,
    ) -> Result<T, Error> {
        let mut host = RunHost::new(self, options);
        let study = StudyChoice {
            model: choice.model.clone(),
            number: choice.solve,
            generate_only: false,
        };
        let machine_options = run::Options {
            quiet: true,
            study: Some(study),
            ..options.for_machine()
        };
        let preprocess = self.preprocess(options);
        let mut formulas = None;
        let mut look = |m: &mut Machine| match study::chosen(m)
            .and_then(|(primal, studied)| f(m, &primal, &studied))
        {
            Ok(f) => formulas = Some(f),
            Err(d) => m.say(*d),
        };
        let finished = session::run(
            &mut host,
            &self.name,
            preprocess,
            machine_options,
            false,
            &mut look,
        );
        formulas.ok_or_else(|| refused(&finished.diagnostics, &finished.map))
    }
}

fn broken<T>() -> Result<T, Error> {
    Err(refused(&[super::run::broken()], &SourceMap::default()))
}

fn refused(found: &[diag::Diagnostic], map: &SourceMap) -> Error {
    Error::Model {
        diagnostics: Diagnostic::all(found, map),
        messages: diagnostics::render(found, map, Look::plain()),
    }
}
