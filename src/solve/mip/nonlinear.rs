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
use crate::solve::nlp::convex::{Shape, shape};
use crate::solve::{ModelStatus, Settings, SolverStatus};
use std::rc::Rc;

/// The instance under a node's bounds.
pub struct Nonlinear {
    /// Relaxed type.
    using: ProblemType,
    instance: Instance,
    choice: Option<String>,
    settings: Settings,
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
}

/// Infeasible nodes that are tried from the start point as well.
const AGAIN: u32 = 50;

impl Nonlinear {
    /// For an instance.
    pub fn new(
        instance: &Instance,
        using: ProblemType,
        choice: Option<&str>,
        settings: &Settings,
    ) -> Self {
        let mut relaxed = instance.clone();
        relaxed.columns.kind.fill(ColumnKind::Continuous);
        relaxed.discrete = Default::default();
        let level = &instance.columns.level;
        Self {
            using,
            instance: relaxed,
            // of a convex quadratic program it says that its answer is a global one
            choice: Some(choice.unwrap_or("clarabel").to_string()),
            settings: settings.clone(),
            first: level.clone(),
            point: Rc::new(level.clone()),
            known: matches!(shape(instance), Shape::ConvexQuadratic { .. }),
            convex: true,
            rooted: false,
            again: 0,
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

    /// Solves from a point; None: a limit.
    pub fn answer(&mut self, from: &[f64], control: &mut Control) -> Option<Answer> {
        let columns = &mut self.instance.columns;
        for (j, x) in columns.level.iter_mut().enumerate() {
            *x = from[j].max(columns.lower[j]).min(columns.upper[j]);
        }
        let task = Task::new(self.using, &self.instance).by(self.choice.as_deref());
        let answer = control
            .budget
            .aside(|budget| subproblem(&task, &self.settings, budget));
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
        let mut starts = vec![self.point.clone(), Rc::new(self.first.clone())];
        if !self.rooted {
            starts.extend([1.0, f64::INFINITY].map(|most| Rc::new(self.inside(most))));
        }
        for from in starts {
            let Some(answer) = self.answer(&from, control) else {
                continue;
            };
            let stopped = match answer.outcome.status {
                SolverStatus::UserInterrupt => Some(Ended::Interrupted),
                SolverStatus::ResourceInterrupt => Some(Ended::Time),
                _ => None,
            };
            if let Some(why) = stopped {
                return Solved::Stopped(why);
            }
            use ModelStatus as S;
            let global = match answer.status {
                S::Optimal | S::Infeasible => true,
                S::Feasible => false,
                _ => self.known,
            };
            self.convex &= global && !self.using.has_pairs();
            match answer.status {
                S::Optimal | S::LocallyOptimal | S::Feasible => {
                    let value = self.instance.objective.map_or(0.0, |o| {
                        o.sense.sign() * answer.outcome.level[o.column as usize]
                    });
                    self.point = Rc::new(answer.outcome.level);
                    self.rooted = true;
                    return Solved::Value(value);
                }
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
        solved
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
