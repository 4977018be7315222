//! An instance as a complementarity problem: `mcp`, and square systems (`cns`).
//!
//! What happens at a solution is decided by the bounds: F is left minus right whatever the relation.

use super::mcp;
use super::pairing::{match_rows, refuse};
use super::{Claim, Monitor, Outcome, Settings, SolveError, SolverStatus};
use crate::autodiff::Evaluator;
use crate::model::instance::Instance;
use crate::solve::noise;

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
struct Line<'a> {
    monitor: &'a mut dyn Monitor,
    names: Names<'a>,
    hopeless: Hopeless<'a>,
    log: bool,
}

/// Whether it can be proved, at the price of a linear program, that there is no solution.
type Hopeless<'a> = &'a dyn Fn(&mut dyn Monitor) -> bool;

/// What index k of a complementarity problem is called.
type Names<'a> = &'a dyn Fn(&dyn Monitor, usize) -> String;

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

    fn hopeless(&mut self) -> bool {
        (self.hopeless)(self.monitor)
    }

    fn name(&self, i: usize) -> String {
        (self.names)(self.monitor, i)
    }
}

/// The value of an option that is a number, none of which may be negative.
fn number(name: &str, value: &str) -> Result<f64, SolveError> {
    match value.parse::<f64>() {
        Ok(number) if number >= 0.0 => Ok(number),
        _ => refuse(
            format!("the option `{name}` needs a number ≥ 0, not `{value}`"),
            None,
            None,
        ),
    }
}

/// Options by PATH's names.
fn options(settings: &Settings) -> Result<mcp::Settings, SolveError> {
    let mut s = mcp::Settings {
        time_limit: settings.time_limit,
        ..mcp::Settings::default()
    };
    s.cumulative_iteration_limit = s
        .cumulative_iteration_limit
        .min(settings.iteration_limit as usize);
    for (name, value) in &settings.options {
        let name = name.to_lowercase();
        let yes = !matches!(value.to_lowercase().as_str(), "no" | "0" | "off" | "false");
        match name.as_str() {
            "crash_method" => s.crash_method = !value.eq_ignore_ascii_case("none"),
            "preprocess" => s.preprocess = yes,
            "output" => {
                s.output_crash_iterations = yes;
                s.output_major_iterations = yes;
                s.output_minor_iterations = yes;
                s.output_final_statistics = yes;
            }
            "output_crash_iterations" => s.output_crash_iterations = yes,
            "output_major_iterations" => s.output_major_iterations = yes,
            "output_minor_iterations" => s.output_minor_iterations = yes,
            "output_final_statistics" => s.output_final_statistics = yes,
            "convergence_tolerance" | "proximal_perturbation" | "time_limit" => {
                let number = number(&name, value)?;
                match name.as_str() {
                    "convergence_tolerance" => s.convergence_tolerance = number,
                    "proximal_perturbation" => s.proximal_perturbation = number,
                    _ => s.time_limit = s.time_limit.min(number),
                }
            }
            _ => {
                let limit = match name.as_str() {
                    "crash_iteration_limit" => &mut s.crash_iteration_limit,
                    "major_iteration_limit" => &mut s.major_iteration_limit,
                    "cumulative_iteration_limit" => &mut s.cumulative_iteration_limit,
                    "minor_iteration_limit" => &mut s.minor_iteration_limit,
                    "nms_memory_size" => &mut s.nms_memory_size,
                    "restart_limit" => s.restart_limit.insert(0),
                    // Options of PATH that mean nothing here.
                    _ => continue,
                };
                *limit = number(&name, value)?.min(1e15) as usize;
            }
        }
    }
    Ok(s)
}

/// Runs the complementarity solver: its outcome, and how it ended in GAMS's terms.
pub(super) fn run(
    problem: &mut dyn mcp::Problem,
    names: Names,
    settings: &Settings,
    monitor: &mut dyn Monitor,
    hopeless: Hopeless,
) -> Result<(mcp::Outcome, SolverStatus), SolveError> {
    let limits = options(settings)?;
    let log = settings.log;
    let out = mcp::solve(
        problem,
        &limits,
        &mut Line {
            monitor,
            names,
            hopeless,
            log,
        },
    );
    let status = match out.status {
        mcp::Status::Solved => SolverStatus::NormalCompletion,
        mcp::Status::IterationLimit => SolverStatus::IterationInterrupt,
        mcp::Status::TimeLimit => SolverStatus::ResourceInterrupt,
        mcp::Status::NoSolution => SolverStatus::TerminatedBySolver,
        mcp::Status::Interrupted => SolverStatus::UserInterrupt,
        mcp::Status::EvaluationFailed
        | mcp::Status::InvalidBounds
        | mcp::Status::InvalidProblem => SolverStatus::InternalSolverFailure,
    };
    Ok((out, status))
}

/// Solves an mcp (or, with `square`, a cns), of which `hopeless` is asked when the main method fails. The outcome's marginals are those of GAMS: of a row the
/// level of its column, of a column F.
pub fn solve(
    instance: &Instance,
    square: bool,
    settings: &Settings,
    monitor: &mut dyn Monitor,
    hopeless: Hopeless,
) -> Result<Outcome, SolveError> {
    let mut problem = Square::new(instance, square)?;
    let row_of = problem.row_of.clone();
    let names = |monitor: &dyn Monitor, j: usize| match row_of[j] {
        Some(r) => format!(
            "{}.{}",
            monitor.row_name(r as usize),
            monitor.column_name(j)
        ),
        None => monitor.column_name(j),
    };
    let (mut out, status) = run(&mut problem, &names, settings, monitor, hopeless)?;
    let (lower, upper) = (&instance.columns.lower, &instance.columns.upper);
    noise::snap(&mut out.x, lower, upper);
    if square && out.status != mcp::Status::Solved {
        // The rows do not hold: the bounds shall.
        for (x, (&l, &u)) in out.x.iter_mut().zip(lower.iter().zip(upper)) {
            *x = x.max(l).min(u);
        }
    }
    if out.status == mcp::Status::EvaluationFailed {
        let mut f = vec![0.0; instance.column_count()];
        let failure = mcp::Problem::function(&mut problem, &instance.columns.level, &mut f).err();
        let (row, what) = failure.map_or((None, out.message.clone()), |e| (e.row, e.message));
        return refuse(format!("the start cannot be evaluated: {what}"), row, None);
    }
    let mut row_marginal = vec![0.0; instance.row_count()];
    let mut column_marginal = vec![0.0; out.x.len()];
    // The marginals of a square system have no meaning.
    if !square {
        column_marginal.copy_from_slice(&out.f);
        for (j, r) in row_of.iter().enumerate() {
            if let Some(r) = r {
                row_marginal[*r as usize] = out.x[j];
            }
        }
    }
    let (claim, status) = match out.status {
        mcp::Status::Solved => (Claim::Solved, status),
        // That all methods from all starts failed is what GAMS calls locally infeasible.
        mcp::Status::NoSolution => (Claim::Infeasible, SolverStatus::NormalCompletion),
        _ => (Claim::Unfinished, status),
    };
    Ok(Outcome {
        level: out.x,
        row_marginal,
        column_marginal,
        claim,
        status,
        iterations: (out.majors + out.pivots) as u64,
        solver: "bmcp",
        ray: Vec::new(),
        message: (!out.message.is_empty()).then_some(out.message),
        basis: None,
    })
}
