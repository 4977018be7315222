//! Programs with discrete columns: `mip`, `miqcp`, `minlp`, `mpec`.
//!
//! [`presolve`] makes a linear program smaller, [`cuts`] tighten its relaxation, and [`tree`] searches, by branch and
//! bound over the simplex method ([`linear`]), or a nonlinear solver or that of programs with pairs ([`nonlinear`]). The answer is that of the program
//! with the discrete columns fixed at the best solution: so there are marginals, and the point is checked like any other.
//!
//! It is made for teaching and for small and middling models.

mod branching;
mod certify;
pub mod conflict;
pub mod cuts;
mod driver;
mod heuristics;
pub mod linear;
pub mod nonlinear;
mod outer;
pub mod presolve;
mod relaxation;
mod symmetry;
pub mod tree;

pub use tree::{Aim, Record};

use super::answer::subproblem;
use super::backend::{About, Backend, Replied, Reply, Supports, Task, Terms};
use super::bridge::binaries::{Replaced, without_binary_products};
use super::bridge::forms::{WithForms, with_forms};
use super::discrete::{Mip, model, propagate};
use super::lp;
use super::lp::Ended;
use super::lp::form::Form;
use super::nlp::convex::{Shape, shape};
use super::strategy::Strategy;
use super::{Budget, Claim, Outcome, Settings, SolveError, SolverStatus};
use crate::model::instance::{ColumnKind, Instance};
use crate::model::option::OptionTable;
use crate::model::problem_type::ProblemType;
pub(super) use driver::Found;
use driver::{Begin, search_linear};
use model::Units;
use nonlinear::Nonlinear;
use outer::Convex;
use relaxation::Control;
pub(super) use tree::End;
use tree::{PROVED, Search};

/// Name of this solver.
pub const NAME: &str = "bmip";

/// What a search found out besides a point.
#[derive(Clone, Debug)]
pub struct Report {
    /// Whether the point is a solution; without one levels and marginals are as before.
    pub solution: bool,
    /// No solution is better than this, if that is known.
    pub bound: Option<f64>,
    /// Nodes solved.
    pub nodes: u64,
    /// The relaxation has a point: if there is no solution, this is due to discrete columns.
    pub relaxed: bool,
    /// What became of the nodes, where that was asked for; columns are the instance's.
    pub records: Vec<Record>,
    /// Nodes that are not among them.
    pub left_out: usize,
}

/// Its options: none but those of the `option` statement (`optcr`, `nodlim` …).
pub const OPTIONS: OptionTable = OptionTable {
    backend: NAME,
    title: "mip, miqcp, minlp: bmod's own; `optcr`, `optca`, `nodlim`, `cutoff`, `cheat`, `tryint`, `prioropt` are options or attributes of the model",
    rows: &[],
    more: None,
    ignored: &[],
};

/// The types in which columns may be discrete.
const TYPES: &[ProblemType] = &[
    ProblemType::Mip,
    ProblemType::Miqcp,
    ProblemType::Minlp,
    ProblemType::Mpec,
];

/// Branch and bound as a backend.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bmip;

impl Backend for Bmip {
    fn about(&self) -> About {
        About {
            name: NAME,
            aliases: &[],
            version: "mip, miqcp, minlp, mpec with discrete variables: bmod's own, on the simplex method and the nonlinear solver",
            supports: Supports {
                integers: true,
                pairs: true,
                ..Supports::new(TYPES, Terms::Kinks)
            },
            options: &OPTIONS,
            option_files: &[NAME],
        }
    }

    fn takes(&self, task: &Task) -> bool {
        self.about().supports.takes(task) && task.has_integers()
    }

    fn solve(&self, task: &Task, settings: &Settings, budget: &Budget) -> Replied {
        search(task, settings, budget)
    }
}

/// Solves an instance with discrete columns.
fn search(task: &Task, settings: &Settings, budget: &Budget) -> Result<Reply, SolveError> {
    let aim = settings.search.minimizing(task.instance.sign());
    let replaced = replaced(task, aim, settings, budget);
    let instance = replaced.as_ref().map_or(task.instance, |r| &r.instance);
    let asked = aim.nodes;
    let aim = match &replaced {
        Some(r) => Aim {
            try_start: 1.0,
            nodes: match r.has_bits() && (asked == 0 || asked > BIT_NODES) {
                true => BIT_NODES,
                false => asked,
            },
            ..aim
        },
        None => aim,
    };
    let (mut found, iterations) = match instance.is_linear() && !task.has_pairs() {
        true => {
            let mut control = Control::for_each_program(budget);
            let begin = Begin {
                settings: Some(settings),
                ..Begin::default()
            };
            let found = linear_search(instance, aim, begin, &mut control)?;
            (found, control.iterations)
        }
        false => {
            let mut control = Control::new(budget);
            let inner = Task { instance, ..*task };
            let convex = match task.has_pairs() {
                true => None,
                false => with_forms(instance),
            };
            let found = match convex {
                Some(convex) => convex_search(&inner, convex, aim, settings, &mut control)?,
                None => nonlinear_search(&inner, false, aim, settings, &mut control)?,
            };
            budget.spend(control.iterations);
            (found, control.iterations)
        }
    };
    if found.end == End::Nodes && aim.nodes != asked {
        found.end = End::Gap;
    }
    if replaced.is_some() {
        found.keep(task.instance.column_count());
    }
    let mut reply = concluded(task, found, settings, budget);
    reply.outcome.iterations = iterations;
    Ok(reply)
}

/// Nodes of the nonlinear program that are solved for a first solution: without integers that are written in bits, and with
/// such, whose linear program is often a worse guide.
const FIRST_NODES: [u64; 2] = [5, 500];

/// Nodes of the linear program with integers in bits, at most: its bounds may rise slowly.
const BIT_NODES: u64 = 20_000;

/// A gap of the linear program's relaxation, relative to a solution, with which no tree over so many columns ends: the
/// nonlinear one is searched.
const HOPELESS: f64 = 10.0;
const MANY_COLUMNS: usize = 300;

/// The program without products that have a binary factor, where it is linear or convex quadratic without them and was neither
/// before. It starts at the best point of a few nodes of the nonlinear program.
fn replaced(task: &Task, aim: Aim, settings: &Settings, budget: &Budget) -> Option<Replaced> {
    let instance = task.instance;
    if instance.is_linear() || task.has_pairs() {
        return None;
    }
    if let Shape::ConvexQuadratic { .. } = shape(instance) {
        return None;
    }
    let mut replaced = without_binary_products(instance)?;
    if !settings.runs(Strategy::BinaryProducts) {
        return None;
    }
    match shape(&replaced.instance) {
        Shape::Linear => {}
        Shape::ConvexQuadratic { .. } => return Some(replaced),
        _ => return None,
    }
    let aim = Aim {
        nodes: FIRST_NODES[usize::from(replaced.has_bits())],
        record: false,
        ..aim
    };
    let seconds = budget.seconds_left() / 4.0;
    let first = budget.within(seconds, u64::MAX, |budget| {
        nonlinear_search(task, false, aim, settings, &mut Control::new(budget))
    });
    if let Ok(Found {
        x: Some(x), value, ..
    }) = first
    {
        let relaxed = Task::new(ProblemType::Rmip, &replaced.instance);
        let many = replaced.instance.column_count() > MANY_COLUMNS;
        let answer = many.then(|| budget.aside(|budget| subproblem(&relaxed, settings, budget)));
        if let (Some(Ok(answer)), Some(o)) = (answer, instance.objective)
            && answer.status.is_solution()
        {
            let bound = o.sense.sign() * answer.outcome.level[o.column as usize];
            if value - bound > HOPELESS * value.abs().max(1.0) {
                return None;
            }
        }
        replaced.start_at(&x);
    }
    Some(replaced)
}

/// The reply after a search.
pub(super) fn concluded(task: &Task, found: Found, settings: &Settings, budget: &Budget) -> Reply {
    let instance = task.instance;
    let (mut outcome, complete) = match &found.x {
        Some(x) => (solution(task, x, settings, budget), true),
        None => (nothing(instance, found.failed.as_ref()), false),
    };
    // With integers rounded it may be another than the search had.
    let value = match (complete, instance.objective) {
        (true, Some(o)) => instance.sign() * outcome.level[o.column as usize],
        _ => found.value,
    };
    let bound = if found.x.is_some() && found.exact {
        found.bound.min(value)
    } else {
        found.bound
    };
    let proved = match found.end {
        End::Complete => !found.incomplete && is_same(value, found.value),
        _ => value - bound <= PROVED * value.abs().max(1e-9),
    };
    outcome.claim = match (complete, &found.end) {
        (_, End::Unbounded) => Claim::Unbounded,
        (true, _) if proved && found.exact => Claim::Solved,
        (false, End::Complete) if found.incomplete => Claim::Unfinished,
        (false, End::Complete) if found.exact => Claim::Infeasible,
        (false, End::Complete) => Claim::LocallyInfeasible,
        _ => Claim::Unfinished,
    };
    let empty = !complete && found.end == End::Complete;
    let endless = matches!(found.end, End::Stopped(_)) && !found.incomplete;
    for values in [
        &mut outcome.level,
        &mut outcome.row_marginal,
        &mut outcome.column_marginal,
    ] {
        // no -0
        values.iter_mut().for_each(|v| *v += 0.0);
    }
    outcome.solver = NAME;
    outcome.basis = None;
    outcome.message = match () {
        () if outcome.claim == Claim::LocallyInfeasible => {
            Some("not convex: the nonlinear solver found no point, which proves nothing".into())
        }
        () if outcome.claim == Claim::Infeasible && found.nodes == 0 && !found.relaxed => {
            Some("the bounds and rows contradict each other before any search".into())
        }
        () if found.incomplete => {
            Some("parts of the tree were given up: the numbers broke down there".into())
        }
        () if complete && !found.exact && matches!(found.end, End::Complete | End::Gap) => {
            Some("not shown to be convex: a better solution is possible".into())
        }
        () if endless && is_unlimited(instance) => Some(
            "an integer variable has no finite bounds: the search may never end without them"
                .into(),
        ),
        () => None,
    };
    outcome.status = match &found.end {
        End::Complete if found.incomplete => SolverStatus::TerminatedBySolver,
        End::Complete | End::Gap | End::Unbounded => SolverStatus::NormalCompletion,
        End::Stopped(why) => why.status(),
        End::Nodes => SolverStatus::TerminatedBySolver,
    };
    let shown = match (outcome.claim, instance.objective) {
        (Claim::Solved, Some(o)) => outcome.level[o.column as usize],
        _ => instance.sign() * bound,
    };
    let report = Report {
        solution: complete,
        bound: Some(shown).filter(|b| b.is_finite() && found.exact && !empty),
        nodes: found.nodes,
        relaxed: found.relaxed,
        left_out: (found.made as usize).saturating_sub(found.records.len()),
        records: found.records,
    };
    Reply {
        search: Some(report),
        ..outcome.into()
    }
}

/// Whether an integer column may take any number of values.
fn is_unlimited(instance: &Instance) -> bool {
    let c = &instance.columns;
    let integer = |j: &usize| matches!(c.kind[*j], ColumnKind::Integer | ColumnKind::SemiInteger);
    let mut integers = (0..c.kind.len()).filter(integer);
    integers.any(|j| c.lower[j].is_infinite() || c.upper[j].is_infinite())
}

/// The search of a linear program: presolve, cuts, tree.
fn linear_search(
    instance: &Instance,
    aim: Aim,
    begin: Begin,
    control: &mut Control,
) -> Result<Found, SolveError> {
    let form = Form::new(instance)?;
    let mip = Mip::new(
        form.problem.clone(),
        instance,
        &form.columns,
        aim.priorities,
    );
    Ok(searched(instance, &form, &mip, aim, begin, control))
}

/// The search of the linear program that an instance has become, from its levels where they may be a solution.
fn searched(
    instance: &Instance,
    form: &Form,
    mip: &Mip,
    aim: Aim,
    mut begin: Begin,
    control: &mut Control,
) -> Found {
    let start: Vec<f64> = form
        .columns
        .iter()
        .map(|&j| instance.columns.level[j as usize])
        .collect();
    let near = |k: usize| (start[k] - start[k].round()).abs() <= aim.try_start;
    let mut whole = (0..mip.integer.len()).filter(|&k| mip.integer[k]);
    if aim.try_start > 0.0 && whole.all(near) {
        begin.start = Some(start);
    }
    let mut found = search_linear(mip, aim, begin, control);
    // In columns of the instance; the objective's follows from the others.
    if let Some(x) = found.x.take() {
        let point = lp::form::Point {
            x,
            y: vec![0.0; form.problem.m()],
            d: vec![0.0; form.problem.n()],
        };
        found.x = Some(form.point(instance, &point).0);
    }
    for c in found.records.iter_mut().filter_map(|r| r.change.as_mut()) {
        c.column = form.columns[c.column] as usize;
    }
    found
}

/// The search of a convex program: by tangents where that is of use, or else with the nonlinear solver at every node.
fn convex_search(
    task: &Task,
    mut convex: WithForms,
    aim: Aim,
    settings: &Settings,
    control: &mut Control,
) -> Result<Found, SolveError> {
    let relaxed = convex.relaxed.take();
    let instance = relaxed.as_ref().unwrap_or(task.instance);
    let inner = Task { instance, ..*task };
    let found = match tangent_search(&inner, &mut convex, aim, settings, control)? {
        Some(found) => found,
        None => nonlinear_search(&inner, !convex.has_cones, aim, settings, control)?,
    };
    // what a relaxed equation lacks is made up for
    if let (Some(_), Some(x)) = (&relaxed, &found.x) {
        let outcome = solution(task, x, settings, control.budget);
        let value = instance
            .objective
            .map_or(0.0, |o| o.sense.sign() * outcome.level[o.column as usize]);
        if outcome.claim == Claim::Unfinished || !is_same(value, found.value) {
            return nonlinear_search(task, false, aim, settings, control);
        }
    }
    Ok(found)
}

/// The search of a convex program by tangents. None: tangents would be many, its relaxation has no best point, or that of
/// another search is likely to be better.
fn tangent_search(
    task: &Task,
    convex: &mut WithForms,
    aim: Aim,
    settings: &Settings,
    control: &mut Control,
) -> Result<Option<Found>, SolveError> {
    let small = convex.forms.iter().all(|f| f.is_small());
    if !small || !settings.runs(Strategy::OuterApproximation) {
        return Ok(None);
    }
    let instance = task.instance;
    let (linear, forms) = (&convex.instance, &mut convex.forms);
    let (_, nonlinear) = relaxed(task, true, aim, settings, control)?;
    let form = Form::new(linear)?;
    let mut tangents = Convex {
        nonlinear,
        discrete: instance
            .columns
            .kind
            .iter()
            .map(|k| *k != ColumnKind::Continuous)
            .collect(),
        forms,
        has_cones: convex.has_cones,
        numbers: &form.columns,
    };
    let level = &instance.columns.level;
    let (root, begun) = match tangents.best(level, control) {
        Some(Some(root)) => (root, true),
        Some(None) if !tangents.has_cones => return Ok(None),
        // tangents where the nonlinear solver began
        _ => (tangents.with_values(level.clone()), false),
    };
    let mut mip = Mip::new(form.problem.clone(), linear, &form.columns, aim.priorities);
    tangents.tighten(&mut mip, &root);
    let begin = Begin {
        settings: Some(settings),
        convex: Some(tangents),
        ..Begin::default()
    };
    let mut found = searched(linear, &form, &mip, aim, begin, control);
    // degenerate: the nonlinear solver at every node may know more
    let given_up = match found.end {
        End::Complete | End::Gap => found.incomplete || !found.exact,
        End::Stopped(Ended::Failed) => true,
        _ => !begun && found.x.is_none(),
    };
    if given_up {
        return Ok(None);
    }
    found.keep(instance.column_count());
    found.relaxed = true;
    Ok(Some(found))
}

/// The linear rows of a nonlinear program that is known to be convex or not, and its relaxation.
fn relaxed(
    task: &Task,
    known: bool,
    aim: Aim,
    settings: &Settings,
    control: &mut Control,
) -> Result<(Mip, Nonlinear), SolveError> {
    let (instance, relaxed) = (task.instance, task.using.relaxation());
    let mip = Mip::of_nonlinear(instance, aim.priorities)?;
    let mut first = instance.clone();
    first.columns.lower.copy_from_slice(&mip.problem.lower);
    first.columns.upper.copy_from_slice(&mip.problem.upper);
    // What keeps the solver from starting is said before anything else.
    control.budget.aside(|budget| {
        budget.within(f64::INFINITY, 1, |budget| {
            subproblem(
                &Task::new(relaxed, &first).by(task.choice),
                settings,
                budget,
            )
        })
    })?;
    let mut relaxation = Nonlinear::new(&first, relaxed, task.choice, settings, known);
    relaxation.convex = !task.has_pairs();
    Ok((mip, relaxation))
}

/// The search of a nonlinear program, which is known to be convex or not.
fn nonlinear_search(
    task: &Task,
    known: bool,
    aim: Aim,
    settings: &Settings,
    control: &mut Control,
) -> Result<Found, SolveError> {
    let (mip, relaxation) = relaxed(task, known, aim, settings, control)?;
    let units = Units {
        price: 1.0,
        offset: 0.0,
    };
    let mut search = Search::new(&mip, relaxation, aim, units);
    let end = search.run(control);
    let failed = search.relaxation.failed.take();
    Ok(Found {
        failed,
        ..search.found(end)
    })
}

/// The program with its discrete columns fixed where a point has them.
pub fn fixed(instance: &Instance, x: &[f64]) -> Instance {
    let mut out = instance.clone();
    let c = &mut out.columns;
    for (j, &value) in x.iter().enumerate() {
        match c.kind[j] {
            ColumnKind::Integer | ColumnKind::SemiInteger => {
                (c.lower[j], c.upper[j]) = (value.round(), value.round());
            }
            ColumnKind::SemiContinuous | ColumnKind::OrderedSet if value == 0.0 => {
                (c.lower[j], c.upper[j]) = (0.0, 0.0);
            }
            _ => {}
        }
        c.kind[j] = ColumnKind::Continuous;
        c.level[j] = value;
    }
    for &(j, lower) in &instance.discrete.thresholds {
        let j = j as usize;
        if c.lower[j] < c.upper[j] {
            c.lower[j] = lower;
        }
    }
    out.discrete = Default::default();
    out
}

/// A proved interval for the best value of a linear program with discrete columns, near its answer.
pub fn certified(
    instance: &Instance,
    outcome: &Outcome,
    budget: &Budget,
) -> Result<lp::certify::Proof, SolveError> {
    let solution = fixed(instance, &outcome.level);
    let proof = lp::certify::certify(&solution, outcome, budget)?;
    let value = instance
        .objective
        .map_or(0.0, |o| outcome.level[o.column as usize]);
    certify::certify(instance, proof, value, budget)
}

/// The answer at a solution of the search.
fn solution(task: &Task, x: &[f64], settings: &Settings, budget: &Budget) -> Outcome {
    let rows = task.instance.row_count();
    let fixed = fixed(task.instance, x);
    let task = Task::new(task.using.relaxation(), &fixed).by(task.choice);
    let answer = budget.after_all(GRACE, |budget| subproblem(&task, settings, budget));
    if let Ok(a) = answer
        && a.status.is_solution()
    {
        return a.outcome;
    }
    // The point of the search, without marginals.
    Outcome::unfinished(NAME, x.to_vec(), rows)
}

/// Whether the value of a solution with its integers rounded is not above the search's, but for 1e-6 of it.
fn is_same(value: f64, searched: f64) -> bool {
    value - searched <= 1e-6 * value.abs().max(1.0)
}

/// Seconds for the marginals of a solution when the time is used up.
const GRACE: f64 = 1.5;

/// Without a solution levels and marginals stay as they were; levels are those of an infeasible relaxation that has a point.
fn nothing(instance: &Instance, failed: Option<&Vec<f64>>) -> Outcome {
    let level = failed.unwrap_or(&instance.columns.level).clone();
    Outcome {
        row_marginal: instance.rows.marginal.clone(),
        column_marginal: instance.columns.marginal.clone(),
        ..Outcome::unfinished(NAME, level, instance.row_count())
    }
}
