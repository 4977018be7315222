//! The relaxation of a nonlinear program with discrete columns: a nonlinear solver at every node, from the parent's point.
//!
//! Where the relaxation is known to be convex its values are bounds, and the search proves its answer. Elsewhere they are local optima:
//! the search is then a good guess, as any of this kind.

use super::model::Change;
use super::relaxation::{Control, Relaxation, Solved};
use crate::model::instance::{ColumnKind, Instance};
use crate::model::problem_type::ProblemType;
use crate::solve::answer::{Answer, subproblem};
use crate::solve::backend::Task;
use crate::solve::lp::Ended;
use crate::solve::{ModelStatus, Settings, SolverStatus};
use std::rc::Rc;

/// The instance under a node's bounds.
pub struct Nonlinear {
    /// Relaxed type.
    using: ProblemType,
    instance: Instance,
    choice: Option<String>,
    settings: Settings,
    /// Columns that are to be whole in the end.
    integer: Vec<bool>,
    first: Vec<f64>,
    point: Rc<Vec<f64>>,
    /// The program is convex: a local optimum is a global one.
    known: bool,
    /// Every value so far was a global one.
    pub convex: bool,
    /// The root is solved: below it, what is infeasible is tried from elsewhere only so often.
    rooted: bool,
    /// How often that was done.
    again: u32,
    /// Where the nonlinear solver stopped at an infeasible root.
    pub failed: Option<Vec<f64>>,
}

/// Infeasible nodes that are tried from the start point as well.
const AGAIN: u32 = 50;

/// Iterations times columns after which no better whole point is looked for at the root: only where that is cheap.
const ELSEWHERE: u64 = 10_000;

impl Nonlinear {
    /// For an instance that is known to be convex or not.
    pub fn new(
        instance: &Instance,
        using: ProblemType,
        choice: Option<&str>,
        settings: &Settings,
        known: bool,
    ) -> Self {
        let mut relaxed = instance.clone();
        relaxed.columns.kind.fill(ColumnKind::Continuous);
        relaxed.discrete = Default::default();
        let level = &instance.columns.level;
        let kinds = instance.columns.kind.iter();
        let whole = |k: &ColumnKind| *k == ColumnKind::Integer;
        Self {
            integer: kinds.map(whole).collect(),
            using,
            instance: relaxed,
            choice: choice.map(str::to_string),
            settings: settings.clone(),
            first: level.clone(),
            point: Rc::new(level.clone()),
            known,
            convex: true,
            rooted: false,
            again: 0,
            failed: None,
        }
    }

    /// A point inside of the bounds, halfway between them or `most` from the lower one, a unit from one alone: at 0, where
    /// many models start, products have no slopes.
    fn inside(&self, most: f64) -> Vec<f64> {
        let c = &self.instance.columns;
        let within = |(&l, &u): (&f64, &f64)| match (l.is_finite(), u.is_finite()) {
            (true, true) => l + (0.5 * (u - l)).min(most),
            (true, false) => l + 1.0,
            (false, true) => u - 1.0,
            (false, false) => 0.0,
        };
        c.lower.iter().zip(&c.upper).map(within).collect()
    }

    fn is_whole(&self, x: &[f64]) -> bool {
        let mut all = x.iter().zip(&self.integer);
        all.all(|(x, &integer)| !integer || (x - x.round()).abs() < 1e-6)
    }

    /// Solves from a point in so many iterations at most; None: a limit.
    pub fn answer(&mut self, from: &[f64], most: u64, control: &mut Control) -> Option<Answer> {
        let columns = &mut self.instance.columns;
        for (j, x) in columns.level.iter_mut().enumerate() {
            *x = from[j].max(columns.lower[j]).min(columns.upper[j]);
        }
        let task = Task::new(self.using, &self.instance).by(self.choice.as_deref());
        let settings = &self.settings;
        let answer = control
            .budget
            .aside(|b| b.within(f64::INFINITY, most, |b| subproblem(&task, settings, b)));
        let answer = answer.ok()?;
        control.iterations += answer.outcome.iterations;
        Some(answer)
    }
}

impl Relaxation for Nonlinear {
    type Start = Rc<Vec<f64>>;

    fn set_bounds(&mut self, c: Change) {
        self.instance.columns.lower[c.column] = c.lower;
        self.instance.columns.upper[c.column] = c.upper;
    }

    fn solve(&mut self, _: f64, control: &mut Control) -> Solved {
        if let Some(why) = control.stop(control.iterations) {
            return Solved::Stopped(why);
        }
        let mut solved = Solved::Failed;
        let (began, columns) = (control.iterations, self.integer.len() as u64);
        let elsewhere = ELSEWHERE / columns.max(10);
        let mut best: Option<(f64, Rc<Vec<f64>>)> = None;
        let mut starts = vec![self.point.clone(), Rc::new(self.first.clone())];
        if !self.rooted {
            starts.extend([1.0, f64::INFINITY].map(|most| Rc::new(self.inside(most))));
        }
        starts.dedup();
        for from in starts {
            let left = match best {
                Some(_) => elsewhere.saturating_sub(control.iterations - began),
                None => u64::MAX,
            };
            let Some(answer) = self.answer(&from, left, control) else {
                continue;
            };
            let stopped = match answer.outcome.status {
                SolverStatus::UserInterrupt => Some(Ended::Interrupted),
                SolverStatus::ResourceInterrupt => Some(Ended::Time),
                _ => None,
            };
            match stopped {
                Some(_) if best.is_some() => break,
                Some(why) => return Solved::Stopped(why),
                None => {}
            }
            use ModelStatus as S;
            let global = match answer.status {
                S::Optimal | S::Infeasible => true,
                S::Feasible => false,
                _ => self.known,
            };
            self.convex &= global && !self.using.has_pairs();
            if !self.rooted && matches!(answer.status, S::Infeasible | S::LocallyInfeasible) {
                self.failed
                    .get_or_insert_with(|| answer.outcome.level.clone());
            }
            match answer.status {
                S::Optimal | S::LocallyOptimal | S::Feasible => {
                    let value = self.instance.objective.map_or(0.0, |o| {
                        o.sense.sign() * answer.outcome.level[o.column as usize]
                    });
                    let point = Rc::new(answer.outcome.level);
                    if self.rooted || self.convex || !self.is_whole(&point) {
                        self.point = point;
                        self.rooted = true;
                        return Solved::Value(value);
                    }
                    // The search would end here, at a local optimum: from elsewhere there may be a better one.
                    if best.as_ref().is_none_or(|b| value < b.0) {
                        best = Some((value, point));
                    }
                }
                _ if best.is_some() => {}
                S::Infeasible | S::InfeasibleNoSolution => return Solved::Infeasible,
                S::Unbounded | S::UnboundedNoSolution => return Solved::Unbounded(Vec::new()),
                // from elsewhere it may be feasible
                S::LocallyInfeasible if self.rooted && self.again >= AGAIN => {
                    return Solved::Infeasible;
                }
                S::LocallyInfeasible => {
                    self.again += u32::from(self.rooted && solved == Solved::Failed);
                    solved = Solved::Infeasible;
                }
                _ => {}
            }
        }
        let Some((value, point)) = best else {
            return solved;
        };
        self.point = point;
        self.rooted = true;
        Solved::Value(value)
    }

    fn x(&self) -> &[f64] {
        &self.point
    }

    fn reduced(&self) -> Option<&[f64]> {
        None
    }

    fn start(&self) -> Self::Start {
        self.point.clone()
    }

    fn restart(&mut self, start: &Self::Start) {
        self.point = start.clone();
    }

    fn is_linear(&self) -> bool {
        false
    }

    fn is_exact(&self) -> bool {
        self.convex
    }
}
