//! An instance as a complementarity problem: `mcp`, and square systems (`cns`).
//!
//! Each column has one row: its partner. Equality rows without a partner are given, in order, to
//! the free columns without one (any order gives the same solutions); a fixed column needs no row.
//! What happens at a solution is decided by the bounds: F is left minus right whatever the relation.

use super::mcp;
use super::{Claim, Monitor, Outcome, Settings, SolveError, SolverStatus};
use crate::autodiff::Evaluator;
use crate::model::instance::{Instance, Relation};
use std::time::Instant;

/// Rows and columns put side by side.
struct Square<'a> {
    instance: &'a Instance,
    evaluator: Evaluator,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// Row of each column; None for a fixed column without one.
    row_of: Vec<Option<u32>>,
    activity: Vec<f64>,
    jacobian: Vec<f64>,
    /// Pattern by columns of the matrix whose row k is the row of column k.
    start: Vec<usize>,
    index: Vec<usize>,
    /// Where each entry of the pattern stands in the evaluator's Jacobian.
    from: Vec<usize>,
    constant: Vec<bool>,
}

fn refuse<T>(
    message: impl Into<String>,
    row: Option<usize>,
    column: Option<usize>,
) -> Result<T, SolveError> {
    Err(SolveError {
        message: message.into(),
        row,
        column,
    })
}

/// A pair whose row's relation contradicts the bounds of its column.
pub(super) fn refuse_relation(
    relation: Relation,
    lower: f64,
    upper: f64,
    row: usize,
    column: usize,
) -> Result<(), SolveError> {
    let (below, above) = (lower > f64::NEG_INFINITY, upper < f64::INFINITY);
    let what = match relation {
        Relation::Greater if above && !below => {
            "a =g= row may not be paired with a variable that has an upper bound only"
        }
        Relation::Less if below && !above => {
            "a =l= row may not be paired with a variable that has a lower bound only"
        }
        _ => return Ok(()),
    };
    refuse(what, Some(row), Some(column))
}

/// Gives every column its row. `square`: a cns, where bounds do not count.
#[allow(clippy::needless_range_loop)] // rows, bounds and partners side by side
pub(super) fn match_rows(
    instance: &Instance,
    square: bool,
) -> Result<Vec<Option<u32>>, SolveError> {
    let n = instance.column_count();
    let mut row_of: Vec<Option<u32>> = match &instance.matched {
        Some(m) if !square => m.clone(),
        _ => vec![None; n],
    };
    let mut taken = vec![false; instance.row_count()];
    for r in row_of.iter().flatten() {
        taken[*r as usize] = true;
    }
    let columns = &instance.columns;
    let mut free = Vec::new();
    for j in 0..n {
        let (l, u) = (columns.lower[j], columns.upper[j]);
        match row_of[j] {
            Some(i) => refuse_relation(instance.rows.relation[i as usize], l, u, i as usize, j)?,
            None if l == u => {}
            None if square || (l == f64::NEG_INFINITY && u == f64::INFINITY) => free.push(j),
            None => {
                return refuse(
                    "a variable without a row must be free or fixed",
                    None,
                    Some(j),
                );
            }
        }
    }
    let mut left: Vec<usize> = (0..instance.row_count()).filter(|&i| !taken[i]).collect();
    for &i in &left {
        if instance.rows.relation[i] != Relation::Equal {
            let what = if square {
                "a square system has equations (=e=) only"
            } else {
                "an inequality without a variable is left over"
            };
            return refuse(what, Some(i), None);
        }
    }
    if left.len() != free.len() {
        let what = if square {
            "the system is not square"
        } else {
            "the counts do not match"
        };
        let (r, c) = (left.len(), free.len());
        let (row, column) = (left.get(c).copied(), free.get(r).copied());
        let which = if square { "" } else { "unmatched " };
        return refuse(
            format!("{what}: {r} {which}equations, {c} {which}variables that are not fixed"),
            row,
            column,
        );
    }
    left.reverse();
    for j in free {
        row_of[j] = left.pop().map(|i| i as u32);
    }
    Ok(row_of)
}

impl<'a> Square<'a> {
    fn new(instance: &'a Instance, square: bool) -> Result<Self, SolveError> {
        let row_of = match_rows(instance, square)?;
        let n = instance.column_count();
        let evaluator = Evaluator::new(instance);
        let columns = &instance.columns;
        // A square system's bounds do not act; they are checked at the solution.
        let bounds = |b: &[f64], infinite: f64| -> Vec<f64> {
            (0..n)
                .map(|j| {
                    if square && columns.lower[j] < columns.upper[j] {
                        infinite
                    } else {
                        b[j]
                    }
                })
                .collect()
        };
        let (lower, upper) = (
            bounds(&columns.lower, f64::NEG_INFINITY),
            bounds(&columns.upper, f64::INFINITY),
        );
        let mut at = vec![usize::MAX; instance.row_count()];
        for (j, r) in row_of.iter().enumerate() {
            if let Some(r) = r {
                at[*r as usize] = j;
            }
        }
        let (row_start, row_column) = evaluator.jacobian_pattern();
        let (row_start, row_column) = (row_start.to_vec(), row_column.to_vec());
        let mut nonlinear: Vec<u64> = Vec::new();
        for k in &instance.nonlinear {
            let v = k.kernel.variables as usize;
            for (t, &r) in k.row.iter().enumerate() {
                nonlinear.extend(
                    k.columns[t * v..(t + 1) * v]
                        .iter()
                        .map(|&c| u64::from(r) << 32 | u64::from(c)),
                );
            }
        }
        nonlinear.sort_unstable();
        nonlinear.dedup();
        let mut entries: Vec<(u32, u32, usize)> = Vec::with_capacity(row_column.len());
        for i in 0..instance.row_count() {
            if at[i] != usize::MAX {
                entries.extend(
                    (row_start[i]..row_start[i + 1]).map(|k| (row_column[k], at[i] as u32, k)),
                );
            }
        }
        entries.sort_unstable();
        let mut start = vec![0; n + 1];
        for e in &entries {
            start[e.0 as usize + 1] += 1;
        }
        for j in 0..n {
            start[j + 1] += start[j];
        }
        let constant = entries
            .iter()
            .map(|e| {
                let row = row_of[e.1 as usize].expect("an entry's row has a column");
                nonlinear
                    .binary_search(&(u64::from(row) << 32 | u64::from(e.0)))
                    .is_err()
            })
            .collect();
        Ok(Self {
            instance,
            evaluator,
            lower,
            upper,
            row_of,
            activity: vec![0.0; instance.row_count()],
            jacobian: vec![0.0; row_column.len()],
            start,
            index: entries.iter().map(|e| e.1 as usize).collect(),
            from: entries.iter().map(|e| e.2).collect(),
            constant,
        })
    }
}

impl mcp::Problem for Square<'_> {
    fn n(&self) -> usize {
        self.lower.len()
    }

    fn lower(&self) -> &[f64] {
        &self.lower
    }

    fn upper(&self) -> &[f64] {
        &self.upper
    }

    fn start(&self) -> &[f64] {
        &self.instance.columns.level
    }

    fn pattern(&self) -> (&[usize], &[usize]) {
        (&self.start, &self.index)
    }

    fn function(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), mcp::EvalError> {
        self.evaluator
            .rows(x, &mut self.activity)
            .map_err(|e| mcp::EvalError {
                row: Some(e.row as usize),
                message: e.to_string(),
            })?;
        for (j, r) in self.row_of.iter().enumerate() {
            f[j] = r.map_or(0.0, |r| {
                self.activity[r as usize] - self.instance.rows.rhs[r as usize]
            });
        }
        Ok(())
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), mcp::EvalError> {
        self.evaluator
            .jacobian(x, &mut self.jacobian)
            .map_err(|e| mcp::EvalError {
                row: Some(e.row as usize),
                message: e.to_string(),
            })?;
        for (v, &k) in values.iter_mut().zip(&self.from) {
            *v = self.jacobian[k];
        }
        Ok(())
    }

    fn is_linear(&self) -> bool {
        self.instance.is_linear()
    }

    fn is_constant(&self, k: usize) -> bool {
        self.constant[k]
    }
}

/// The run's monitor, as the complementarity solver wants it.
pub(super) struct Line<'a> {
    pub(super) monitor: &'a mut dyn Monitor,
    pub(super) log: bool,
}

impl mcp::Monitor for Line<'_> {
    fn log(&mut self, line: &str) {
        self.monitor.log(line);
    }

    fn interrupted(&mut self) -> bool {
        self.monitor.interrupted()
    }

    fn wants_log(&self) -> bool {
        self.log
    }

    fn name(&self, i: usize) -> String {
        self.monitor.column_name(i)
    }
}

/// Options by PATH's names.
pub(super) fn options(settings: &Settings) -> Result<mcp::Settings, SolveError> {
    let mut s = mcp::Settings {
        time_limit: settings.time_limit,
        ..mcp::Settings::default()
    };
    s.cumulative_iteration_limit = s
        .cumulative_iteration_limit
        .min(settings.iteration_limit as usize);
    for (name, value) in &settings.options {
        let number = value.parse::<f64>();
        let count = |limit: f64| limit.clamp(0.0, 1e15) as usize;
        match (name.to_lowercase().as_str(), number) {
            ("convergence_tolerance", Ok(v)) => s.convergence_tolerance = v,
            ("crash_method", _) => s.crash_method = !value.eq_ignore_ascii_case("none"),
            ("crash_iteration_limit", Ok(v)) => s.crash_iteration_limit = count(v),
            ("major_iteration_limit", Ok(v)) => s.major_iteration_limit = count(v),
            ("cumulative_iteration_limit", Ok(v)) => s.cumulative_iteration_limit = count(v),
            ("minor_iteration_limit", Ok(v)) => s.minor_iteration_limit = count(v),
            ("proximal_perturbation", Ok(v)) => s.proximal_perturbation = v,
            ("nms_memory_size", Ok(v)) => s.nms_memory_size = count(v),
            ("restart_limit", Ok(v)) => s.restart_limit = count(v),
            ("preprocess", _) => {
                s.preprocess = !matches!(value.to_lowercase().as_str(), "no" | "0" | "off")
            }
            (
                "convergence_tolerance"
                | "crash_iteration_limit"
                | "major_iteration_limit"
                | "cumulative_iteration_limit"
                | "minor_iteration_limit"
                | "proximal_perturbation"
                | "nms_memory_size"
                | "restart_limit",
                Err(_),
            ) => {
                return refuse(
                    format!("the option `{name}` needs a number, not `{value}`"),
                    None,
                    None,
                );
            }
            _ => {}
        }
    }
    Ok(s)
}

/// Solves an mcp (or, with `square`, a cns). The outcome's marginals are those of GAMS: of a row the
/// level of its column, of a column F.
pub fn solve(
    instance: &Instance,
    square: bool,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<Outcome, SolveError> {
    let begin = Instant::now();
    let mut problem = Square::new(instance, square)?;
    let limits = options(settings)?;
    let out = mcp::solve(
        &mut problem,
        &limits,
        &mut Line {
            monitor,
            log: settings.log,
        },
    );
    let _ = begin;
    if out.status == mcp::Status::EvaluationFailed {
        let mut f = vec![0.0; instance.column_count()];
        let failure = mcp::Problem::function(&mut problem, &instance.columns.level, &mut f).err();
        let (row, what) = failure.map_or((None, out.message.clone()), |e| (e.row, e.message));
        return refuse(format!("the start cannot be evaluated: {what}"), row, None);
    }
    let mut row_marginal = vec![0.0; instance.row_count()];
    for (j, r) in problem.row_of.iter().enumerate() {
        if let Some(r) = r {
            row_marginal[*r as usize] = out.x[j];
        }
    }
    let (claim, status) = match out.status {
        mcp::Status::Solved => (Claim::Solved, SolverStatus::NormalCompletion),
        mcp::Status::IterationLimit => (Claim::Unfinished, SolverStatus::IterationInterrupt),
        mcp::Status::TimeLimit => (Claim::Unfinished, SolverStatus::ResourceInterrupt),
        mcp::Status::Interrupted => (Claim::Unfinished, SolverStatus::UserInterrupt),
        mcp::Status::NoSolution => (Claim::Unfinished, SolverStatus::TerminatedBySolver),
        mcp::Status::EvaluationFailed
        | mcp::Status::InvalidBounds
        | mcp::Status::InvalidProblem => (Claim::Unfinished, SolverStatus::InternalSolverFailure),
    };
    if square {
        // The marginals of a square system have no meaning.
        row_marginal.iter_mut().for_each(|m| *m = 0.0);
    }
    Ok(Outcome {
        column_marginal: if square {
            vec![0.0; out.x.len()]
        } else {
            out.f.clone()
        },
        level: out.x,
        row_marginal,
        claim,
        status,
        iterations: (out.majors + out.pivots) as u64,
        solver: "bmcp",
        ray: Vec::new(),
        message: (!out.message.is_empty()).then_some(out.message),
    })
}
