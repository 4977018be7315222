//! The contract between the pipeline and the solvers: what a backend says of itself, and what it is asked for.
//!
//! A backend is a folder with a type that implements [`Backend`], and a line in [`super::registry`]. It sees an
//! [`Instance`] of numbers, asks the [`Budget`] in every loop, and returns the best point that it has seen, with a claim. What
//! that point is worth is measured on the instance as it was given ([`super::answer`]), whatever the backend claims.

use super::lp::form::{Problem, Sparse};
use super::lp::interior::Run;
use super::mip::Report;
use super::mpec::Stationarity;
use super::{Budget, Settings, SolveError};
use crate::model::instance::Instance;
use crate::model::option::OptionTable;
use crate::model::outcome::{Basis, Outcome};
use crate::model::problem_type::{Discrete, ProblemType};
use std::sync::Arc;

/// The hardest terms that a backend takes; each kind includes those before it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Terms {
    /// Linear rows only.
    Linear,
    /// Smooth nonlinear functions.
    Smooth,
    /// Functions with kinks.
    Kinks,
}

/// What a backend takes.
#[derive(Clone, Copy, Debug)]
pub struct Supports {
    /// Problem types.
    pub types: &'static [ProblemType],
    /// Terms of the rows.
    pub terms: Terms,
    /// Whether instances that have linear rows only are solved as well.
    pub linear: bool,
    /// Whether rows may be paired with columns.
    pub pairs: bool,
    /// Whether columns may have to take discrete values.
    pub integers: bool,
    /// Rows and columns together at most.
    pub largest: usize,
    /// Only where it is named: another backend is the better choice.
    pub only_by_name: bool,
}

/// Who hears of points: their objective, and the levels of all columns but that of the objective.
pub type Seen = Arc<dyn Fn(f64, &[f64]) + Send + Sync>;

/// What is to be solved.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The problem type of the `solve` statement.
    pub using: ProblemType,
    /// The solver that the user named for the type, lower case.
    pub choice: Option<&'a str>,
    /// The numbers.
    pub instance: &'a Instance,
    /// Hears of every point that satisfies the constraints of a nonlinear program, with its objective (minimised): for who solves
    /// it in place of a program that asks for more.
    pub seen: Option<&'a Seen>,
    /// For linear programs: a basis that may be optimal, one status per column, then one per row.
    pub basis: Option<&'a Basis>,
}

impl<'a> Task<'a> {
    /// An instance for the backend that this type prefers.
    pub fn new(using: ProblemType, instance: &'a Instance) -> Self {
        Self {
            using,
            choice: None,
            instance,
            seen: None,
            basis: None,
        }
    }

    /// The same for the solver of this name.
    pub fn by(self, choice: Option<&'a str>) -> Self {
        Self { choice, ..self }
    }

    /// Whether a column is left to take a discrete value.
    pub fn has_integers(&self) -> bool {
        self.using.discrete() == Discrete::Decided
            && self.instance.columns.first_undecided().is_some()
    }

    /// Whether a row is paired with a column, and the type makes something of it.
    pub fn has_pairs(&self) -> bool {
        let pairs = self.instance.matched.iter().flatten();
        self.using.has_pairs() && pairs.into_iter().any(Option::is_some)
    }

    /// Whether all columns are continuous, and no row is paired with one.
    pub(super) fn is_continuous(&self) -> bool {
        !self.has_pairs() && !self.has_integers()
    }
}

impl Supports {
    /// Programs of these types in continuous columns, without pairs and of any size, with terms up to these.
    pub const fn new(types: &'static [ProblemType], terms: Terms) -> Self {
        Self {
            types,
            terms,
            linear: true,
            pairs: false,
            integers: false,
            largest: usize::MAX,
            only_by_name: false,
        }
    }

    /// Whether it takes a task.
    pub fn takes(&self, task: &Task) -> bool {
        let instance = task.instance;
        self.types.contains(&task.using)
            && match instance.is_linear() {
                true => self.linear,
                false => self.terms > Terms::Linear,
            }
            && (self.pairs || !task.has_pairs())
            && (self.integers || !task.has_integers())
            && instance.row_count() + instance.column_count() <= self.largest
    }
}

/// What a backend replies: an outcome, and what only it can know.
#[derive(Clone, Debug)]
pub struct Reply {
    /// The point and what is claimed of it.
    pub outcome: Outcome,
    /// For programs with pairs: whether a direction leads downhill.
    pub stationarity: Option<Stationarity>,
    /// A proved interval for the optimal value.
    pub bounds: Option<[f64; 2]>,
    /// For programs with discrete columns: bound and nodes.
    pub search: Option<Report>,
}

impl From<Outcome> for Reply {
    fn from(outcome: Outcome) -> Self {
        Self {
            outcome,
            stationarity: None,
            bounds: None,
            search: None,
        }
    }
}

/// What a backend says of itself.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// Lower-case name, as in `option lp = name`.
    pub name: &'static str,
    /// Other names that the user may call it by.
    pub aliases: &'static [&'static str],
    /// What it is made of, with versions, for `bmod --version`.
    pub version: &'static str,
    /// What it takes.
    pub supports: Supports,
    /// Its options.
    pub options: &'static OptionTable,
    /// Option files that `m.optfile = 1` reads for it, the first that is there: `path` for `path.opt`.
    pub option_files: &'static [&'static str],
}

/// What came of a solve. Err: the instance cannot be solved as it is, with the row or column to blame.
pub type Replied = Result<Reply, SolveError>;

/// What solves convex quadratic programs for a backend.
#[derive(Clone, Copy, Debug)]
pub struct QuadraticEngine {
    /// Its name.
    pub name: &'static str,
    /// Takes linear rows, the Hessian's upper triangle by columns, and a tolerance.
    pub solve: fn(&Problem, &Sparse, f64, &Budget) -> Run,
}

/// A solver.
pub trait Backend: Sync {
    /// What it is and what it takes.
    fn about(&self) -> About;
    /// Whether it takes a task, where there is more to say than [`Supports`] does.
    fn takes(&self, task: &Task) -> bool {
        self.about().supports.takes(task)
    }
    /// What solves convex quadratic programs where the user names this backend for them.
    fn quadratic(&self) -> Option<QuadraticEngine> {
        None
    }
    /// Solves a task that it takes.
    fn solve(&self, task: &Task, settings: &Settings, budget: &Budget) -> Replied;
}

/// Whether a backend has this name.
pub fn is_called(backend: &dyn Backend, name: &str) -> bool {
    let About {
        name: own, aliases, ..
    } = backend.about();
    let mut names = aliases.iter().chain([&own]);
    names.any(|n| n.eq_ignore_ascii_case(name))
}

/// The backend for a task: the one that the user named if it takes the task, else the first in the list that does.
pub fn choose<'b>(backends: &[&'b dyn Backend], task: &Task) -> Option<&'b dyn Backend> {
    let able = || backends.iter().copied().filter(|b| b.takes(task));
    let named = |name: &str| able().find(|b| is_called(*b, name));
    task.choice
        .and_then(named)
        .or_else(|| able().find(|b| !b.about().supports.only_by_name))
}
