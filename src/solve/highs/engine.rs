//! One run of HiGHS: a problem goes in, a point comes out, and the budget is asked on the way.
//!
//! All of the C interface that is used is in this file. HiGHS may call back from threads of its own; only calls from the
//! thread that started it reach the budget, the others are told what was answered last.

use crate::solve::lp::form::{Point, Problem, Sparse};
use crate::solve::{Budget, Progress, Settings, Stop};
use highs_sys::*;
use std::cell::Cell;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::null;
use std::sync::atomic::{AtomicBool, Ordering};

/// How a run ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Status {
    /// Solved to its tolerances.
    Optimal,
    /// No point satisfies rows, bounds and kinds.
    Infeasible,
    /// Unbounded, or infeasible.
    Unbounded,
    /// The number of nodes.
    Nodes,
    /// The budget.
    Stopped(Stop),
    /// Something else; the point is what there is.
    Failed,
}

/// What a run gave.
pub(crate) struct Run {
    /// How it ended.
    pub status: Status,
    /// Point that satisfies the rows, with multipliers; of a search without them.
    pub point: Option<Point>,
    /// Of a search: no solution is better than this, with the offset.
    pub bound: f64,
    /// Nodes.
    pub nodes: u64,
    /// Iterations of all kinds.
    pub iterations: u64,
}

/// HiGHS with a problem.
pub(crate) struct Engine {
    raw: *mut c_void,
    columns: usize,
    rows: usize,
}

impl Drop for Engine {
    fn drop(&mut self) {
        // SAFETY: made by `Highs_create`, and destroyed once.
        unsafe { Highs_destroy(self.raw) }
    }
}

/// An array of HiGHS's integers; None where a number is too large for them.
fn integers<T: Copy + TryInto<HighsInt>>(of: impl IntoIterator<Item = T>) -> Option<Vec<HighsInt>> {
    of.into_iter().map(|i| i.try_into().ok()).collect()
}

impl Engine {
    /// With a problem, the kinds of its columns (none: all continuous), and the upper triangle of a Hessian by columns. None:
    /// HiGHS does not take it.
    pub(crate) fn new(p: &Problem, kinds: &[HighsInt], hessian: Option<&Sparse>) -> Option<Self> {
        let empty = Sparse::default();
        let hessian = hessian.unwrap_or(&empty);
        // what is the upper triangle by columns is the lower one by rows, and HiGHS wants that by columns
        let lower = match hessian.lines() {
            0 => empty.clone(),
            n => hessian.transpose(n),
        };
        let (start, index) = (integers(p.rows.start.iter().copied())?, &p.rows.index);
        let index = integers(index.iter().copied())?;
        let (q_start, q_index) = (
            integers(lower.start.iter().copied())?,
            integers(lower.index.iter().copied())?,
        );
        let or_null = |v: &[HighsInt]| if v.is_empty() { null() } else { v.as_ptr() };
        // SAFETY: every array has the length that the interface asks for, and HiGHS copies them.
        unsafe {
            let engine = Self {
                raw: Highs_create(),
                columns: p.n(),
                rows: p.m(),
            };
            engine.switch(c"output_flag", false);
            let status = Highs_passModel(
                engine.raw,
                p.n() as HighsInt,
                p.m() as HighsInt,
                index.len() as HighsInt,
                q_index.len() as HighsInt,
                MATRIX_FORMAT_ROW_WISE,
                kHighsHessianFormatTriangular,
                OBJECTIVE_SENSE_MINIMIZE,
                p.offset,
                p.cost.as_ptr(),
                p.lower.as_ptr(),
                p.upper.as_ptr(),
                p.row_lower.as_ptr(),
                p.row_upper.as_ptr(),
                start.as_ptr(),
                index.as_ptr(),
                p.rows.value.as_ptr(),
                or_null(&q_start[..q_start.len().min(lower.lines())]),
                or_null(&q_index),
                lower.value.as_ptr(),
                or_null(kinds),
            );
            (status != STATUS_ERROR).then_some(engine)
        }
    }

    /// Sets a switch.
    pub(crate) fn switch(&self, name: &CStr, value: bool) {
        // SAFETY: the name ends with 0. What is not an option is refused with a status.
        unsafe { Highs_setBoolOptionValue(self.raw, name.as_ptr(), value.into()) };
    }

    /// Sets a whole number, no larger than HiGHS's integers.
    pub(crate) fn whole(&self, name: &CStr, value: u64) {
        let value = HighsInt::try_from(value).unwrap_or(HighsInt::MAX);
        // SAFETY: as above.
        unsafe { Highs_setIntOptionValue(self.raw, name.as_ptr(), value) };
    }

    /// Sets a number.
    pub(crate) fn number(&self, name: &CStr, value: f64) {
        // SAFETY: as above.
        unsafe { Highs_setDoubleOptionValue(self.raw, name.as_ptr(), value) };
    }

    /// Sets a word.
    pub(crate) fn word(&self, name: &CStr, value: &str) {
        if let Ok(value) = CString::new(value) {
            // SAFETY: as above.
            unsafe { Highs_setStringOptionValue(self.raw, name.as_ptr(), value.as_ptr()) };
        }
    }

    /// The options of the table, as far as they are set.
    pub(crate) fn set(&self, settings: &Settings) {
        if let Some(threads) = settings.number("highs_threads") {
            self.whole(c"threads", threads as u64);
        }
        if let Some(seed) = settings.number("highs_seed") {
            self.whole(c"random_seed", seed as u64);
        }
        if let Some(on) = settings.switch("highs_presolve") {
            self.word(c"presolve", if on { "choose" } else { "off" });
        }
        if let Some(method) = settings.option("highs_method") {
            self.word(c"solver", &method);
        }
        if let Some(effort) = settings.number("highs_heuristics") {
            self.number(c"mip_heuristic_effort", effort);
        }
    }

    /// Offers a point to start from.
    pub(crate) fn start(&self, x: &[f64]) {
        assert_eq!(x.len(), self.columns);
        // SAFETY: the length was compared; the others may be missing.
        unsafe { Highs_setSolution(self.raw, x.as_ptr(), null(), null(), null()) };
    }

    /// Solves, at most as long as the budget allows.
    pub(crate) fn run(&self, budget: &Budget, searches: bool, shown: &dyn Fn(f64) -> f64) -> Run {
        if let Some(stop) = budget.stop() {
            return self.gave(Status::Stopped(stop));
        }
        if budget.seconds_left().is_finite() {
            self.number(c"time_limit", budget.seconds_left().max(1e-3));
        }
        for name in [
            c"simplex_iteration_limit",
            c"ipm_iteration_limit",
            c"qp_iteration_limit",
        ] {
            if !searches {
                self.whole(name, budget.iterations_left());
            }
        }
        self.switch(c"output_flag", budget.wants_log());
        self.switch(c"log_to_console", false);
        let mut watch = Watch {
            budget,
            shown,
            stop: AtomicBool::new(false),
            heard: Cell::new(0.0),
        };
        let outside = RUNS_HERE.replace(true);
        // SAFETY: `watch` outlives the run, after which HiGHS forgets it.
        let ended = unsafe {
            let data: *mut Watch = &mut watch;
            Highs_setCallback(self.raw, Some(called), data.cast());
            for kind in [
                kHighsCallbackLogging,
                kHighsCallbackSimplexInterrupt,
                kHighsCallbackIpmInterrupt,
                kHighsCallbackMipImprovingSolution,
                kHighsCallbackMipInterrupt,
            ] {
                Highs_startCallback(self.raw, kind);
            }
            let ended = Highs_run(self.raw);
            Highs_setCallback(self.raw, None, std::ptr::null_mut());
            ended
        };
        RUNS_HERE.set(outside);
        // SAFETY: the engine is alive.
        let status = match unsafe { Highs_getModelStatus(self.raw) } {
            _ if ended == STATUS_ERROR => Status::Failed,
            MODEL_STATUS_OPTIMAL | MODEL_STATUS_MODEL_EMPTY => Status::Optimal,
            MODEL_STATUS_INFEASIBLE => Status::Infeasible,
            MODEL_STATUS_UNBOUNDED | MODEL_STATUS_UNBOUNDED_OR_INFEASIBLE => Status::Unbounded,
            MODEL_STATUS_REACHED_SOLUTION_LIMIT => Status::Nodes,
            MODEL_STATUS_REACHED_TIME_LIMIT => Status::Stopped(Stop::Time),
            MODEL_STATUS_REACHED_MEMORY_LIMIT => Status::Stopped(Stop::Memory),
            MODEL_STATUS_REACHED_ITERATION_LIMIT => Status::Stopped(Stop::Iterations),
            MODEL_STATUS_REACHED_INTERRUPT => {
                Status::Stopped(budget.stop().unwrap_or(Stop::Iterations))
            }
            _ => Status::Failed,
        };
        if let Status::Stopped(stop) = status {
            budget.end(stop);
        }
        self.gave(status)
    }

    fn info(&self, name: &CStr) -> HighsInt {
        let mut value = 0;
        // SAFETY: the name ends with 0, the value has the type of what is asked for, else it stays as it is.
        unsafe { Highs_getIntInfoValue(self.raw, name.as_ptr(), &mut value) };
        value
    }

    fn gave(&self, status: Status) -> Run {
        let mut p = Point {
            x: vec![0.0; self.columns],
            y: vec![0.0; self.rows],
            d: vec![0.0; self.columns],
        };
        let mut activity = vec![0.0; self.rows];
        let (mut bound, mut nodes) = (f64::NEG_INFINITY, 0i64);
        // SAFETY: the arrays have as many numbers as the problem has columns and rows.
        unsafe {
            let (x, d) = (p.x.as_mut_ptr(), p.d.as_mut_ptr());
            Highs_getSolution(self.raw, x, d, activity.as_mut_ptr(), p.y.as_mut_ptr());
            Highs_getDoubleInfoValue(self.raw, c"mip_dual_bound".as_ptr(), &mut bound);
            Highs_getInt64InfoValue(self.raw, c"mip_node_count".as_ptr(), &mut nodes);
        }
        let feasible = self.info(c"primal_solution_status") == SOLUTION_STATUS_FEASIBLE;
        let counts = [
            c"simplex_iteration_count",
            c"ipm_iteration_count",
            c"crossover_iteration_count",
            c"qp_iteration_count",
        ];
        let iterations = counts.iter().map(|c| self.info(c).max(0) as u64).sum();
        let fine = p.x.iter().all(|x| x.is_finite());
        Run {
            status,
            point: (feasible && fine).then_some(p),
            bound,
            nodes: nodes.max(0) as u64,
            iterations,
        }
    }

    /// Multipliers of the rows that prove a linear program infeasible, as far as HiGHS finds some.
    pub(crate) fn infeasibility(&self) -> Option<Vec<f64>> {
        let (mut there, mut ray) = (0, vec![0.0; self.rows]);
        // SAFETY: as long as the problem has rows.
        unsafe { Highs_getDualRay(self.raw, &mut there, ray.as_mut_ptr()) };
        (there != 0).then_some(ray)
    }

    /// A direction in which a linear program is unbounded.
    pub(crate) fn direction(&self) -> Option<Vec<f64>> {
        let (mut there, mut ray) = (0, vec![0.0; self.columns]);
        // SAFETY: as long as the problem has columns.
        unsafe { Highs_getPrimalRay(self.raw, &mut there, ray.as_mut_ptr()) };
        (there != 0).then_some(ray)
    }
}

thread_local! {
    /// Whether this thread started a run that has not ended.
    static RUNS_HERE: Cell<bool> = const { Cell::new(false) };
}

/// What a run asks.
struct Watch<'r, 'm> {
    budget: &'r Budget<'m>,
    shown: &'r dyn Fn(f64) -> f64,
    stop: AtomicBool,
    /// Seconds of the last line of progress.
    heard: Cell<f64>,
}

/// Seconds between two lines of progress.
const PAUSE: f64 = 0.2;

/// What HiGHS calls.
unsafe extern "C" fn called(
    kind: c_int,
    message: *const c_char,
    out: *const HighsCallbackDataOut,
    answer: *mut HighsCallbackDataIn,
    data: *mut c_void,
) {
    // SAFETY: `Engine::run` keeps the watch alive; what does not belong to this thread is not touched in others.
    let watch = unsafe { &*data.cast::<Watch>() };
    if RUNS_HERE.get() {
        if kind == kHighsCallbackLogging && !message.is_null() {
            // SAFETY: a text that ends with 0.
            let line = unsafe { CStr::from_ptr(message) }.to_string_lossy();
            watch.budget.log(line.trim_end());
            return;
        }
        // SAFETY: given by HiGHS for this call.
        if let Some(out) = unsafe { out.as_ref() } {
            watch.tell(kind, out);
            let spent = out.mip_total_lp_iterations.max(0) as u64;
            if kind == kHighsCallbackMipInterrupt && spent >= watch.budget.iterations_left() {
                watch.budget.end(Stop::Iterations);
            }
        }
        if watch.budget.is_over() {
            watch.stop.store(true, Ordering::Relaxed);
        }
    }
    // SAFETY: given by HiGHS for this call, or null.
    if let Some(answer) = unsafe { answer.as_mut() } {
        answer.user_interrupt = watch.stop.load(Ordering::Relaxed).into();
    }
}

impl Watch<'_, '_> {
    /// A line of progress, now and then, and for every better solution.
    fn tell(&self, kind: c_int, out: &HighsCallbackDataOut) {
        let better = kind == kHighsCallbackMipImprovingSolution;
        let due =
            kind == kHighsCallbackMipInterrupt && out.running_time >= self.heard.get() + PAUSE;
        if !better && !due {
            return;
        }
        self.heard.set(out.running_time);
        let finite = |v: f64| Some(v).filter(|v| v.abs() < 1e100);
        let best = finite(out.mip_primal_bound);
        let bound = finite(out.mip_dual_bound);
        self.budget.progress(Progress {
            method: "highs",
            iteration: out.mip_node_count.max(0) as u64,
            objective: best.map(self.shown),
            gap: best.zip(bound).map(|(v, b)| (v - b) / v.abs().max(1e-10)),
            ..Progress::default()
        });
    }
}
