//! The log, in the columns of PATH's. A residual stands with the row and the column that it is largest in.

use super::path::PathEnd;
use super::run::{Point, Run};

fn worst(run: &Run, point: &Point) -> String {
    let index = run
        .original
        .get(point.worst)
        .copied()
        .unwrap_or(point.worst);
    (run.names)(index)
}

/// Parts of the log that can be left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Crash,
    Majors,
    Paths,
}

/// Whether a part of the log is wanted.
fn wants(run: &Run, part: Part) -> bool {
    run.budget.wants_log()
        && match part {
            Part::Crash => run.settings.output_crash_iterations,
            Part::Majors => run.settings.output_major_iterations,
            Part::Paths => run.settings.output_minor_iterations,
        }
}

/// Free text.
pub(super) fn note(run: &mut Run, part: Part, text: impl FnOnce() -> String) {
    if wants(run, part) {
        let line = text();
        run.budget.log(&line);
    }
}

pub(super) fn crash_header(run: &mut Run) {
    note(run, Part::Crash, || {
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
    note(run, Part::Crash, || {
        format!(
            "{iteration:5} {:11.4e} {basic:7} {changes:8} {prox:8.1e} {step:8.1e}",
            point.residual
        )
    });
}

pub(super) fn major_header(run: &mut Run, point: &Point) {
    if wants(run, Part::Majors) {
        let name = worst(run, point);
        note(run, Part::Majors, || {
            "Major iterations\nmajor   minor  path        t     prox    residual     step  type tries  (worst row)".into()
        });
        note(run, Part::Majors, || {
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
    if wants(run, Part::Majors) {
        let (name, major) = (worst(run, point), run.majors);
        note(run, Part::Majors, || {
            format!(
                "{major:5} {pivots:7}  {:<9} {t:5.3} {prox:8.1e} {:11.4e} {step:8.1e}   {kind} {tries:4}   ({name})",
                end.word(),
                point.residual
            )
        });
    }
}

pub(super) fn step_line(run: &mut Run, point: &Point, step: f64, kind: char) {
    if wants(run, Part::Majors) {
        let name = worst(run, point);
        note(run, Part::Majors, || {
            format!(
                "                                       {:11.4e} {step:8.1e}   {kind}        ({name})",
                point.residual
            )
        });
    }
}

/// A path that was tried.
pub(super) fn try_line(run: &mut Run, end: PathEnd, t: f64, prox: f64, pivots: usize, cover: bool) {
    note(run, Part::Paths, || {
        format!(
            "      {pivots:7}  {:<9} {t:5.3} {prox:8.1e}{}",
            end.word(),
            if cover { " (from slacks)" } else { "" }
        )
    });
}
