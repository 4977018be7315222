//! The search of a linear program: presolve, scaling, cuts at the root, tree.

use super::cuts::Separator;
use super::linear::Linear;
use super::model::{Change, Mip, Units};
use super::outer::{Convex, Outer};
use super::presolve;
use super::relaxation::{Control, Relaxation, Solved};
use super::symmetry::Symmetry;
use super::tree::{Aim, End, Record, Search};
use crate::solve::Settings;
use crate::solve::strategy::Strategy;

/// What a search gave, in columns of the instance, for a minimisation.
pub(crate) struct Found {
    /// The best point.
    pub x: Option<Vec<f64>>,
    /// No solution is better.
    pub bound: f64,
    /// Its value.
    pub value: f64,
    /// Nodes solved.
    pub nodes: u64,
    /// Why the search ended.
    pub end: End,
    /// A part of the tree was given up.
    pub incomplete: bool,
    /// Values of relaxations are bounds.
    pub exact: bool,
    /// The relaxation has a point.
    pub relaxed: bool,
    /// What became of the nodes.
    pub records: Vec<Record>,
    /// Nodes made.
    pub made: u32,
    /// A point of an infeasible program, as its relaxation has one.
    pub failed: Option<Vec<f64>>,
}

impl Found {
    /// Of a program without a solution, seen before any search.
    pub(crate) fn empty() -> Self {
        Self {
            x: None,
            bound: f64::INFINITY,
            value: f64::INFINITY,
            nodes: 0,
            end: End::Complete,
            incomplete: false,
            exact: true,
            relaxed: false,
            records: Vec::new(),
            made: 0,
            failed: None,
        }
    }

    /// Of a program that begins with these columns and has more: the others are forgotten.
    pub(super) fn keep(&mut self, columns: usize) {
        if let Some(x) = &mut self.x {
            x.truncate(columns);
        }
        for r in &mut self.records {
            r.change = r.change.filter(|c| c.column < columns);
        }
    }
}

/// What a search of a linear program begins with.
#[derive(Default)]
pub(super) struct Begin<'s> {
    /// A point that may be a solution.
    pub start: Option<Vec<f64>>,
    /// What may be left out.
    pub settings: Option<&'s Settings>,
    /// The squares that the linear program has columns for.
    pub convex: Option<Convex<'s>>,
}

/// The best solution of a linear program with discrete columns.
pub(super) fn search_linear(mip: &Mip, aim: Aim, begin: Begin, control: &mut Control) -> Found {
    let Some(reduced) = presolve::reduce(mip, &[]) else {
        return Found::empty();
    };
    let line = format!(
        "presolve: {} rows, {} columns, {} of them integer",
        reduced.mip.problem.m(),
        reduced.mip.problem.n(),
        reduced.mip.integer.iter().filter(|i| **i).count()
    );
    control.budget.log_timed(&line);
    let (scaled, scaling) = reduced.mip.scaled();
    let units = Units {
        price: scaling.price,
        offset: reduced.mip.problem.offset,
    };
    let mut linear = Linear::new(&scaled);
    if strengthen(&scaled, &mut linear, 30, control) == Solved::Infeasible {
        return Found::empty();
    }
    let inner = |x: Vec<f64>| -> Vec<f64> {
        let x = reduced.reduce(&x);
        x.iter().zip(&scaling.column).map(|(x, c)| x / c).collect()
    };
    let runs = |strategy| begin.settings.is_none_or(|s: &Settings| s.runs(strategy));
    let uses_symmetry = begin.convex.is_none() && runs(Strategy::OrbitalBranching);
    let symmetry = uses_symmetry
        .then(|| Symmetry::find(&reduced.mip))
        .flatten();
    if let Some(symmetry) = &symmetry {
        let line = format!("symmetries: {}", symmetry.count());
        control.budget.log_timed(&line);
    }
    let explore = Explore {
        mip: &scaled,
        symmetry: symmetry.as_ref(),
        learns: runs(Strategy::ClauseLearning),
        aim,
        units,
        start: begin.start.map(inner),
    };
    let mut found = match begin.convex {
        None => explore.run(linear, control),
        Some(convex) => {
            let way = convex.way(&reduced, &scaling.column);
            explore.run(Outer::new(&scaled, linear, convex, way), control)
        }
    };
    if found.end == End::Unbounded && found.x.is_none() {
        // Unbounded, if there is a solution at all.
        let mut anything = mip.clone();
        anything.problem.cost.fill(0.0);
        let some = search_linear(&anything, Aim::default(), Begin::default(), control);
        return Found {
            end: if some.end == End::Complete && some.x.is_none() {
                End::Complete
            } else {
                End::Unbounded
            },
            bound: f64::NEG_INFINITY,
            value: some
                .x
                .as_ref()
                .map_or(f64::INFINITY, |x| mip.value(x) + mip.problem.offset),
            ..some
        };
    }
    if found.end == End::Gap && found.x.is_none() {
        found.end = End::Complete;
    }
    found.x = found.x.map(|x| {
        let x: Vec<f64> = x.iter().zip(&scaling.column).map(|(x, c)| x * c).collect();
        reduced.restore(&x)
    });
    for r in &mut found.records {
        r.value = units.shown(r.value);
        r.solution = r.solution.map(|v| units.shown(v));
        if let Some(c) = &mut r.change {
            let factor = scaling.column[c.column];
            *c = Change {
                column: reduced.columns[c.column] as usize,
                lower: c.lower * factor,
                upper: c.upper * factor,
            };
        }
    }
    found.value = units.shown(found.value);
    found.bound = units.shown(found.bound);
    found
}

/// A search over a program that is presolved and scaled.
struct Explore<'e> {
    mip: &'e Mip,
    aim: Aim,
    units: Units,
    start: Option<Vec<f64>>,
    symmetry: Option<&'e Symmetry>,
    learns: bool,
}

impl Explore<'_> {
    fn run<R: Relaxation>(self, relaxation: R, control: &mut Control) -> Found {
        let near = |mip: &Mip, fixed: &[Change], cutoff: f64, control: &mut Control| {
            nearby(mip, fixed, cutoff, self.learns, control)
        };
        let mut search = Search::new(self.mip, relaxation, self.aim, self.units);
        search.neighbourhood = Some(&near);
        search.symmetry = self.symmetry;
        if self.learns {
            search.learn();
        }
        if let Some(x) = self.start {
            search.offer(&x, control);
        }
        let end = search.run(control);
        search.found(end)
    }
}

/// Adds cuts to the root's relaxation while they help.
fn strengthen(mip: &Mip, linear: &mut Linear, rounds: usize, control: &mut Control) -> Solved {
    let first = mip.problem.m();
    let mut solved = linear.solve(f64::INFINITY, control);
    let Solved::Value(start) = solved else {
        return solved;
    };
    let (mut value, mut idle) = (start, 0);
    let mut separator = Separator::new(mip, &mip.problem.lower, &mip.problem.upper);
    for _ in 0..rounds {
        let x = linear.x().to_vec();
        if mip.is_discrete(&x) || control.stop(control.iterations).is_some() || idle >= 3 {
            break;
        }
        let cuts = separator.separate(linear);
        if cuts.is_empty() {
            break;
        }
        linear.add(&cuts);
        solved = linear.solve(f64::INFINITY, control);
        let Solved::Value(v) = solved else {
            break;
        };
        idle = match v - value > 1e-3 * (v - start).max(1e-9 * v.abs()) + 1e-9 {
            true => 0,
            false => idle + 1,
        };
        value = v;
        if linear.drop_idle(first) {
            solved = linear.solve(f64::INFINITY, control);
        }
    }
    let rows = linear.problem.m() - first;
    let line = format!("cuts: {rows}, bound {start:.10} to {value:.10} (scaled)");
    control.budget.log_timed(&line);
    solved
}

/// A search of a few nodes where some columns are fixed.
fn nearby(
    mip: &Mip,
    fixed: &[Change],
    cutoff: f64,
    learns: bool,
    control: &mut Control,
) -> Option<Vec<f64>> {
    let reduced = presolve::reduce(mip, fixed)?;
    let units = Units {
        price: 1.0,
        offset: reduced.mip.problem.offset - mip.problem.offset,
    };
    let aim = Aim {
        nodes: 100,
        cutoff: cutoff.is_finite().then_some(cutoff),
        relative_gap: 1e-3,
        ..Aim::default()
    };
    let last = control.iterations + 1000 + control.iterations / 5;
    let mut sub = Control {
        budget: control.budget,
        last: control.last.min(last),
        each: control.each,
        iterations: control.iterations,
    };
    let mut linear = Linear::new(&reduced.mip);
    let mut best = None;
    control.budget.silently(|_| {
        if strengthen(&reduced.mip, &mut linear, 5, &mut sub) != Solved::Infeasible {
            let mut search = Search::new(&reduced.mip, linear, aim, units);
            if learns {
                search.learn();
            }
            search.run(&mut sub);
            best = search.best.take();
        }
    });
    control.iterations = sub.iterations;
    best.map(|b| reduced.restore(&b.1))
}
