//! The log, in the columns of PATH's. A residual stands with the row and the column that it is largest in.

use super::path::PathEnd;
use super::run::{Point, Run};

fn worst(run: &Run, point: &Point) -> String {
    (run.names)(run.problem.kept[point.worst])
}

/// Free text.
pub(super) fn note(run: &Run, text: impl FnOnce() -> String) {
    if run.budget.wants_log() {
        run.budget.log(text());
    }
}

pub(super) fn crash_header(run: &Run) {
    note(run, || {
        "Crash\n iter    residual     |B|  changes     prox     step".into()
    });
}

pub(super) fn crash_line(
    run: &Run,
    iteration: usize,
    point: &Point,
    basic: usize,
    changes: usize,
    prox: f64,
    step: f64,
) {
    note(run, || {
        format!(
            "{iteration:5} {:11.4e} {basic:7} {changes:8} {prox:8.1e} {step:8.1e}",
            point.residual
        )
    });
}

pub(super) fn major_header(run: &Run, point: &Point) {
    note(run, || {
        format!(
            "Major iterations\nmajor   minor  path        t     prox    residual     step  type tries  (worst row)\n    \
             0                                  {:11.4e}                    ({})",
            point.residual,
            worst(run, point)
        )
    });
}

/// A major iteration; `-`: without a step.
pub(super) fn major_line(
    run: &Run,
    point: &Point,
    pivots: usize,
    end: PathEnd,
    prox: f64,
    kind: char,
    tries: usize,
) {
    let t = if end == PathEnd::Solved { 1.0 } else { 0.0 };
    let step = if kind == '-' { 0.0 } else { 1.0 };
    note(run, || {
        format!(
            "{:5} {pivots:7}  {:<9} {t:5.3} {prox:8.1e} {:11.4e} {step:8.1e}   {kind} {tries:4}   ({})",
            run.majors,
            end.name(),
            point.residual,
            worst(run, point)
        )
    });
}

pub(super) fn step_line(run: &Run, point: &Point, step: f64, kind: char) {
    note(run, || {
        format!(
            "                                       {:11.4e} {step:8.1e}   {kind}        ({})",
            point.residual,
            worst(run, point)
        )
    });
}

/// A path that was tried.
pub(super) fn try_line(run: &Run, end: PathEnd, t: f64, prox: f64, pivots: usize, cover: bool) {
    note(run, || {
        format!(
            "      {pivots:7}  {:<9} {t:5.3} {prox:8.1e}{}",
            end.name(),
            if cover { " (from slacks)" } else { "" }
        )
    });
}
