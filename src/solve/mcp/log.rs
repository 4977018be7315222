//! The log, in the columns of PATH's.

use super::path::PathEnd;
use super::run::{Point, Run};

fn worst(run: &Run, point: &Point) -> String {
    let index = run
        .original
        .get(point.worst)
        .copied()
        .unwrap_or(point.worst);
    run.monitor.name(index)
}

/// Free text.
pub(super) fn note(run: &mut Run, text: impl FnOnce() -> String) {
    if run.monitor.wants_log() {
        let line = text();
        run.monitor.log(&line);
    }
}

pub(super) fn crash_header(run: &mut Run) {
    note(run, || {
        "Crash\n iter    residual     |B|  changes     prox     step".into()
    });
}

pub(super) fn crash_line(
    run: &mut Run,
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

pub(super) fn major_header(run: &mut Run, point: &Point) {
    if run.monitor.wants_log() {
        let name = worst(run, point);
        note(run, || {
            "Major iterations\nmajor   minor  path        t     prox    residual     step  type tries  (worst row)".into()
        });
        note(run, || {
            format!(
                "    0                                  {:11.4e}                    ({name})",
                point.residual
            )
        });
    }
}

#[allow(clippy::too_many_arguments)]
pub(super) fn major_line(
    run: &mut Run,
    point: &Point,
    pivots: usize,
    end: PathEnd,
    t: f64,
    prox: f64,
    step: f64,
    kind: char,
    tries: usize,
) {
    if run.monitor.wants_log() {
        let (name, major) = (worst(run, point), run.majors);
        note(run, || {
            format!(
                "{major:5} {pivots:7}  {:<9} {t:5.3} {prox:8.1e} {:11.4e} {step:8.1e}   {kind} {tries:4}   ({name})",
                end.word(),
                point.residual
            )
        });
    }
}

pub(super) fn step_line(run: &mut Run, point: &Point, step: f64, kind: char) {
    if run.monitor.wants_log() {
        let name = worst(run, point);
        note(run, || {
            format!(
                "                                       {:11.4e} {step:8.1e}   {kind}        ({name})",
                point.residual
            )
        });
    }
}

/// A line of one of the other Newton methods.
pub(super) fn newton_line(
    run: &mut Run,
    iteration: usize,
    point: &Point,
    parameter: f64,
    step: f64,
    kind: char,
) {
    if run.monitor.wants_log() {
        let name = worst(run, point);
        note(run, || {
            format!(
                "{iteration:5} {parameter:9.2e} {:11.4e} {step:8.1e}   {kind}   ({name})",
                point.residual
            )
        });
    }
}

/// A path that was tried.
pub(super) fn try_line(run: &mut Run, end: PathEnd, t: f64, prox: f64, pivots: usize, cover: bool) {
    note(run, || {
        format!(
            "      {pivots:7}  {:<9} {t:5.3} {prox:8.1e}{}",
            end.word(),
            if cover { " (from slacks)" } else { "" }
        )
    });
}
