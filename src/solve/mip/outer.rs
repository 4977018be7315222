//! The relaxation of a convex program by tangents: linear programs at the nodes (Quesada & Grossmann 1992).
//!
//! A node's point gets the tangents that it violates. Where its discrete columns have values that they may have, that is
//! repeated until it violates none; and as that may take long, tangents at the best point with these values, from the nonlinear
//! solver, are added: with them the linear program has its value.

use super::linear::{Cut, Linear};
use super::model::{Change, Mip};
use super::nonlinear::Nonlinear;
use super::presolve::Reduced;
use super::relaxation::{Control, Relaxation, Solved};
use crate::solve::ModelStatus;
use crate::solve::bridge::forms::{Form, Tangent};
use crate::solve::lp::Ended;
use crate::solve::lp::simplex::{Basis, State};
use std::rc::Rc;

/// A violation up to this, relative to the form's value, is none.
const EXACT: f64 = 1e-7;

/// The best value with the discrete columns of a point is reached, relative.
const SAME: f64 = 5e-8;

/// Where discrete columns are not decided, up to this.
const NEAR: f64 = 1e-4;

/// Rounds of tangents at the root.
const ROOT_ROUNDS: usize = 30;

/// Rounds where all discrete columns are decided; from the fourth on the nonlinear solver helps.
const ROUNDS: usize = 100;
const OWN_ROUNDS: usize = 3;

/// Rows for each form, on average, from which on only points with decided columns get more.
const MAX_TANGENTS: usize = 12;

/// From the columns of a search to those of the linear instance that it began with, and back.
pub(super) struct Way {
    /// By column of the search: its number there, and what it is multiplied by.
    column: Vec<(u32, f64)>,
    /// Values of the columns there that the search does not have.
    fixed: Vec<f64>,
}

impl Way {
    fn back(&self, x: &[f64]) -> Vec<f64> {
        let mut out = self.fixed.clone();
        for (&(j, factor), x) in self.column.iter().zip(x) {
            out[j as usize] = x * factor;
        }
        out
    }

    fn forth(&self, x: &[f64]) -> Vec<f64> {
        let entry = |&(j, factor): &(u32, f64)| x[j as usize] / factor;
        self.column.iter().map(entry).collect()
    }
}

/// What a search over tangents knows of the program.
pub(super) struct Convex<'s> {
    /// The program itself.
    pub nonlinear: Nonlinear,
    /// By column of it: discrete.
    pub discrete: Vec<bool>,
    pub forms: &'s mut [Form],
    /// What the nonlinear solver says of the program may be wrong where a square is 0.
    pub has_cones: bool,
    /// Columns of the linear instance, of those of the linear program.
    pub numbers: &'s [u32],
}

impl<'s> Convex<'s> {
    /// The way from a search over what presolve left.
    pub(super) fn way(&self, reduced: &Reduced, scale: &[f64]) -> Way {
        let mut fixed = vec![0.0; self.discrete.len() + self.forms.len()];
        let values = reduced.restore(&vec![0.0; scale.len()]);
        for (&j, v) in self.numbers.iter().zip(values) {
            fixed[j as usize] = v;
        }
        let number = |&k: &u32| self.numbers[k as usize];
        let columns = reduced.columns.iter().map(number);
        Way {
            column: columns.zip(scale.iter().copied()).collect(),
            fixed,
        }
    }

    /// The best point of the program for the present bounds, with the values of the forms; Some(None): there is none, None:
    /// the nonlinear solver has no answer, as at kinks.
    pub(super) fn best(
        &mut self,
        level: &[f64],
        control: &mut Control,
    ) -> Option<Option<Vec<f64>>> {
        use ModelStatus as S;
        let answer = self.nonlinear.answer(level, u64::MAX, control)?;
        match answer.status {
            S::Optimal | S::LocallyOptimal => Some(Some(self.with_values(answer.outcome.level))),
            S::Infeasible | S::LocallyInfeasible => Some(None),
            _ => None,
        }
    }

    /// A point of the program with the values of the forms.
    pub(super) fn with_values(&self, mut level: Vec<f64>) -> Vec<f64> {
        level.resize(self.discrete.len() + self.forms.len(), 0.0);
        for f in self.forms.iter() {
            // of a point that satisfies the program it has a value
            level[f.column as usize] = f.value(&level).unwrap_or(0.0);
        }
        level
    }

    /// Tangents at a point become rows, and presolve is told which columns will stand in more of them.
    pub(super) fn tighten(&mut self, mip: &mut Mip, at: &[f64]) {
        self.forms.iter_mut().for_each(|f| f.stay_inside(at));
        let mut place = vec![usize::MAX; at.len()];
        for (k, &j) in self.numbers.iter().enumerate() {
            place[j as usize] = k;
        }
        let p = &mut mip.problem;
        for tangent in self.forms.iter().flat_map(|s| s.tangents(at)) {
            let entry = |(j, a): (u32, f64)| (place[j as usize], a);
            let mut terms: Vec<(usize, f64)> = tangent.terms.into_iter().map(entry).collect();
            terms.sort_unstable_by_key(|t| t.0);
            p.rows.push(terms);
            p.row_lower.push(f64::NEG_INFINITY);
            p.row_upper.push(tangent.side);
        }
        p.columns = p.rows.transpose(p.n());
        let all = self.forms.iter().flat_map(Form::all_columns);
        mip.held = all.map(|j| place[j as usize] as u32).collect();
    }
}

/// The linear program with the tangents so far.
pub(super) struct Outer<'s> {
    mip: &'s Mip,
    linear: Linear,
    convex: Convex<'s>,
    way: Way,
    /// By column of the program: its number in the search.
    place: Vec<usize>,
    /// Bounds of the present node.
    bounds: Vec<[f64; 2]>,
    point: Vec<f64>,
    first_rows: usize,
    rooted: bool,
    exact: bool,
    /// Values of the discrete columns and the best point with them; None: there is none.
    decided: Option<(Vec<f64>, Option<Vec<f64>>)>,
}

impl<'s> Outer<'s> {
    /// Over a linear program with some tangents.
    pub(super) fn new(mip: &'s Mip, linear: Linear, mut convex: Convex<'s>, way: Way) -> Self {
        let mut place = vec![usize::MAX; way.fixed.len()];
        for (k, c) in way.column.iter().enumerate() {
            place[c.0 as usize] = k;
        }
        // what presolve has decided
        for (column, _) in convex.discrete.iter().enumerate().filter(|d| *d.1) {
            if place[column] == usize::MAX {
                let [lower, upper] = [way.fixed[column]; 2];
                convex.nonlinear.set_bounds(Change {
                    column,
                    lower,
                    upper,
                });
            }
        }
        let (lower, upper) = (mip.problem.lower.iter(), mip.problem.upper.iter());
        Self {
            bounds: lower.zip(upper).map(|(l, u)| [*l, *u]).collect(),
            point: linear.x().to_vec(),
            first_rows: linear.problem.m(),
            mip,
            linear,
            convex,
            way,
            place,
            rooted: false,
            exact: true,
            decided: None,
        }
    }

    /// A tangent in columns of the search.
    fn cut(&self, tangent: Tangent) -> Cut {
        let mut cut = Cut {
            terms: Vec::new(),
            side: tangent.side,
        };
        for (j, a) in tangent.terms {
            match self.place[j as usize] {
                usize::MAX => cut.side -= a * self.way.fixed[j as usize],
                k => cut.terms.push((k, a * self.way.column[k].1)),
            }
        }
        cut.terms.sort_unstable_by_key(|t| t.0);
        cut
    }

    /// Tangents at a point of the program that the relaxation's point violates by more than a part of the form's value.
    fn violated(&self, at: &[f64], x: &[f64], tolerance: f64) -> Vec<Cut> {
        let forms = &self.convex.forms;
        let values: Vec<f64> = forms
            .iter()
            .map(|f| f.value(x).map_or(0.0, f64::abs))
            .collect();
        let largest = values.iter().copied().fold(1e-6, f64::max);
        let mut cuts = Vec::new();
        for (form, value) in forms.iter().zip(values) {
            let least = tolerance * value.max(1e-3 * largest);
            let tangents = form.tangents(at).into_iter();
            let new = tangents.filter(|t| t.violation(x) > least);
            cuts.extend(new.map(|t| self.cut(t)));
        }
        cuts
    }

    /// The best point whose discrete columns are as in this one, of the program; Some(None) and None as for [`Convex::best`].
    fn decided(&mut self, x: &[f64], control: &mut Control) -> Option<Option<Vec<f64>>> {
        let mip = self.mip;
        let mut key = x.to_vec();
        for (j, v) in key.iter_mut().enumerate() {
            *v = match mip.integer[j] {
                true => v.round(),
                false => 0.0,
            };
        }
        if let Some((known, point)) = &self.decided
            && mip.has_integers_only()
            && *known == key
        {
            return Some(point.clone());
        }
        for j in (0..key.len()).filter(|&j| mip.integer[j]) {
            self.bound(j, [key[j]; 2]);
        }
        let from = self.way.back(x);
        let point = self.convex.best(&from, control);
        for j in (0..key.len()).filter(|&j| mip.integer[j]) {
            self.bound(j, self.bounds[j]);
        }
        self.decided = point.clone().map(|point| (key, point));
        point
    }

    /// Bounds of a discrete column of the search go to the program as well.
    fn bound(&mut self, j: usize, [lower, upper]: [f64; 2]) {
        let (column, factor) = self.way.column[j];
        let discrete = self.convex.discrete.get(column as usize);
        if discrete != Some(&true) {
            return;
        }
        let change = Change {
            column: column as usize,
            lower: lower * factor,
            upper: upper * factor,
        };
        self.convex.nonlinear.set_bounds(change);
    }
}

impl Relaxation for Outer<'_> {
    type Start = Rc<Basis>;

    fn set_bounds(&mut self, change: Change) {
        self.linear.set_bounds(change);
        self.bounds[change.column] = [change.lower, change.upper];
        self.bound(change.column, [change.lower, change.upper]);
    }

    fn solve(&mut self, cutoff: f64, control: &mut Control) -> Solved {
        let (mut rounds, mut before) = (0, f64::NEG_INFINITY);
        loop {
            let solved = self.linear.solve(cutoff, control);
            let value = match solved {
                Solved::Value(value) => value,
                // tangents have become too much alike
                Solved::Failed => return Solved::Stopped(Ended::Failed),
                _ => return solved,
            };
            self.point = self.linear.x().to_vec();
            let whole = self.mip.is_discrete(&self.point);
            let rows = self.linear.problem.m() - self.first_rows;
            let most = match (whole, self.rooted) {
                (true, _) => ROUNDS,
                (_, false) => ROOT_ROUNDS,
                _ if rows > MAX_TANGENTS * self.convex.forms.len() => 0,
                _ => 1,
            };
            let slow = !whole && value - before <= 1e-5 * value.abs();
            if rounds >= most || slow {
                self.exact &= !whole;
                break;
            }
            let x = self.way.back(&self.point);
            let tolerance = if whole { EXACT } else { NEAR };
            let mut cuts = self.violated(&x, &x, tolerance);
            if !cuts.is_empty() && whole && rounds >= OWN_ROUNDS {
                let point = self.point.clone();
                if let Some(Some(best)) = self.decided(&point, control) {
                    let reached = self.mip.value(&self.way.forth(&best));
                    if value >= reached - SAME * reached.abs().max(0.1) {
                        break;
                    }
                    cuts.extend(self.violated(&best, &x, EXACT));
                }
            }
            if cuts.is_empty() || control.stop(control.iterations).is_some() {
                break;
            }
            self.linear.add(&cuts);
            for (column, &[lower, upper]) in self.bounds.iter().enumerate() {
                self.linear.simplex.set_bounds(column, lower, upper);
            }
            (rounds, before) = (rounds + 1, value);
        }
        self.rooted = true;
        Solved::Value(self.linear.value())
    }

    fn solve_decided(&mut self, x: &[f64], control: &mut Control) -> Solved {
        let decided = self.decided(x, control);
        let is_infeasible = decided == Some(None);
        let best = decided.flatten().map(|level| self.way.forth(&level));
        let (own, at) = (self.mip.value(x), self.way.back(x));
        let is_doubtful = match &best {
            Some(p) => self.convex.has_cones && self.mip.value(p) - own > SAME * own.abs().max(0.1),
            None => self.convex.has_cones || !is_infeasible,
        };
        if is_doubtful && self.mip.is_feasible(x) && self.violated(&at, &at, EXACT).is_empty() {
            self.point = x.to_vec();
            return Solved::Value(own);
        }
        let Some(point) = best else {
            self.exact &= is_infeasible;
            return match is_infeasible {
                true => Solved::Infeasible,
                false => Solved::Failed,
            };
        };
        self.point = point;
        Solved::Value(self.mip.value(&self.point))
    }

    fn x(&self) -> &[f64] {
        &self.point
    }

    fn reduced(&self) -> Option<&[f64]> {
        self.linear.reduced()
    }

    fn start(&self) -> Self::Start {
        self.linear.start()
    }

    fn restart(&mut self, start: &Self::Start) {
        let mut basis = Basis::clone(start);
        let all = self.mip.problem.n() + self.linear.problem.m();
        basis.resize(all, State::Basic);
        self.linear.restart(&Rc::new(basis));
    }

    fn probe(&mut self, changes: &[Change], cutoff: f64) -> Option<f64> {
        self.linear.probe(changes, cutoff)
    }

    fn is_linear(&self) -> bool {
        false
    }

    fn is_exact(&self) -> bool {
        self.exact
    }
}
