//! Programs without a finite optimum.
//!
//! An interior point that is led to infinity loses the rows on the way: where x y = 1 and x grows, y falls below
//! every tolerance. What its last point says is then worth nothing, but a program confined to a box,
//! |xⱼ| ≤ R for what has no nearer bound, is solved like any other. So where a run diverges, or ends where the objective
//! still changes ([`Trial::diverging`]), the program is solved in two boxes:
//!
//! * an optimum that the box does not touch is one of the program itself;
//! * an objective that is considerably better in the larger box (or that has no optimum in the smaller one), and would change
//!   beyond it, has no limit that a number in a model stands for: the program is called unbounded;
//! * otherwise nothing was found out.

use super::driver::Driver;
use super::interior_point::{Ended, lock};
use super::problem::{ObjectiveForm, Problem};
use super::schedule::From;
use super::slqp::Effort;
use super::trial::{CONSIDERABLE, FAR, Trial};
use crate::model::instance::Instance;
use crate::solve::vector::clip;
use crate::solve::{SolveError, Strategy};

/// Half the widths R of the boxes.
const BOXES: [f64; 2] = [1e5, 1e8];
/// The rows hold to this relative to their terms where growth is shown.
const EXACT: f64 = 1e-8;
/// How often it is looked for.
const TIMES: u8 = 2;

/// What is done about runs that lead far away.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Growth {
    /// Boxes are tried; so often they were.
    Watched(u8),
    /// Nothing: there is a local optimum already, or a box.
    Ignored,
}

impl Driver<'_, '_> {
    /// What a run from a start led to, or what was found out about where it was going.
    pub(super) fn follow(&mut self, start: Vec<f64>, trial: Trial) -> Result<Trial, SolveError> {
        let Growth::Watched(times) = self.growth else {
            return Ok(trial);
        };
        let is_far = |reach| is_far(self.instance, self.eliminated(), &trial.level, reach);
        let far = trial.is_feasible() && is_far(FAR);
        let diverged = trial.ended == Ended::Diverging || trial.diverging || far;
        // a second time only for points that the rows allow
        let tried = times == TIMES || times > 0 && !trial.is_feasible();
        if trial.is_optimal()
            || !diverged
            || tried
            || self.is_stopped()
            || !self.settings.runs(Strategy::UnboundedBoxes)
        {
            return Ok(trial);
        }
        let beyond = is_far(BOXES[1]);
        self.growth = Growth::Watched(times + 1);
        let found = self.boxes(start)?;
        let better = |t: &Trial| t.unbounded || t.better(&trial);
        Ok(match found.filter(better) {
            Some(found) => found,
            // it is as good as stationary, if it is not beyond all boxes
            None => Trial {
                diverging: trial.diverging && beyond,
                ..trial
            },
        })
    }

    /// The optimum, or a point that shows that there is none, if one of them is found.
    fn boxes(&mut self, start: Vec<f64>) -> Result<Option<Trial>, SolveError> {
        let mut before: Option<f64> = None;
        let mut start = start;
        for reach in BOXES {
            if self.is_stopped() {
                break;
            }
            let Some(inside) = self.confined(&start, reach)? else {
                continue;
            };
            let trial = self.judge(inside.x.clone(), inside.lambda, inside.ended);
            if trial.is_optimal() || self.is_unbounded(&trial) {
                return Ok(Some(trial));
            }
            let exact = trial.residuals.is_feasible(EXACT);
            let considerable = |f: f64| trial.objective < f - CONSIDERABLE * f.abs().max(1.0);
            if exact && trial.diverging && before.is_none_or(considerable) {
                return Ok(Some(Trial {
                    unbounded: true,
                    ..trial
                }));
            }
            if exact {
                before = Some(trial.objective);
            }
            // further along the way that it went
            start = inside.x.iter().map(|x| x * BOXES[1] / BOXES[0]).collect();
        }
        Ok(None)
    }

    /// The objective variable, if the solver does not see it.
    fn eliminated(&self) -> Option<usize> {
        match lock(&self.problem).form {
            ObjectiveForm::Row { column, .. } => Some(column),
            _ => None,
        }
    }

    /// A certified point of the program in a box.
    fn confined(&mut self, start: &[f64], reach: f64) -> Result<Option<Trial>, SolveError> {
        self.budget.log(format!("within ±{reach:e}"));
        let eliminated = self.eliminated();
        let mut instance = self.instance.clone();
        let columns = &mut instance.columns;
        for j in (0..columns.lower.len()).filter(|&j| Some(j) != eliminated) {
            if columns.lower[j] < -reach && columns.upper[j] > -reach {
                columns.lower[j] = -reach;
            }
            if columns.upper[j] > reach && columns.lower[j] < reach {
                columns.upper[j] = reach;
            }
        }
        let mut problem = Problem::new(&instance);
        let mut start = start.to_vec();
        clip(&mut start, problem.bounds());
        problem.start = start;
        let (interior_point, settings) = (self.interior_point, self.settings);
        let mut inner = Driver::new(&instance, problem, interior_point, settings, self.budget);
        inner.growth = Growth::Ignored;
        inner.iterations = self.iterations;
        inner.sequential(inner.start.clone(), None, Effort::FULL);
        inner.leave_saddles()?;
        if !inner.is_settled() {
            inner.attempt(From::Start, &[])?;
            inner.leave_saddles()?;
        }
        let best = inner.best.take();
        let found = best.filter(|t| t.is_stationary() || inner.is_unbounded(t));
        self.iterations = inner.iterations;
        Ok(found)
    }
}

/// Whether a variable is this far out, and not because of its bounds; the eliminated one may be.
fn is_far(instance: &Instance, eliminated: Option<usize>, level: &[f64], reach: f64) -> bool {
    let columns = &instance.columns;
    let beyond = |j: usize| {
        let x = level[j];
        let bound = if x > 0.0 {
            columns.upper[j]
        } else {
            columns.lower[j]
        };
        x.abs() >= reach && (x - bound).abs() > 1e-6 * x.abs() && Some(j) != eliminated
    };
    (0..level.len()).any(beyond)
}
