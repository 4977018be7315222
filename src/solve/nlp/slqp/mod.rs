//! Sequential linear and quadratic programming: the active set of a linear program, then Newton's method on it.
//!
//! ```text
//!     φ(x) = f(x) + ν Σᵢ max(aᵢ − gᵢ(x), gᵢ(x) − bᵢ, 0)     over l ≤ x ≤ u
//! ```
//!
//! is made small (Fletcher & Sainz de la Maza 1989; Byrd, Gould, Nocedal & Waltz 2004). A linear program in a trust region says which
//! rows and bounds hold as equations ([`linear`]): our simplex method, from the last basis; the nonbasic
//! rows and bounds are independent whatever is degenerate or redundant. A quadratic program with the exact Hessian on these ([`equality`])
//! gives the step and its multipliers. Variables that occur linearly have no trust region: mostly linear programs take a
//! few steps from anywhere. While the multipliers have the right signs and no other row or bound is met,
//! the working set stays and there is no linear program: that is Newton's method. Where no step lessens what is violated, the multipliers
//! of the linear program prove that the program is infeasible nearby.

mod equality;
mod linear;
mod model;
mod point;

use super::problem::{Entry, Problem};
use crate::solve::strategy::{Strategies, Strategy};
use crate::solve::vector::sum;
use crate::solve::{Budget, Progress};
use equality::{ANY, Equality, Memory, Working};
use linear::{Aim, Linear, Step};
use model::{Course, Model};
use point::{Frame, Point, Values};

/// What may be spent on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Steps.
    pub steps: u64,
    /// Pivots of the simplex method, all programs together, by the number of rows and columns.
    pub pivots: u64,
}

impl Effort {
    /// Where a program is only solved again if little has changed.
    pub(super) const AGAIN: Self = Self {
        steps: 10,
        pivots: 30,
    };

    /// From anywhere.
    pub(super) const FULL: Self = Self {
        steps: 100,
        pivots: 30,
    };
}

/// Variables and constraints at most: each program is factorised afresh.
const LARGEST: usize = 10_000;
/// The penalty ν at first, and at most.
const FIRST_PENALTY: f64 = 10.0;
const MOST_PENALTY: f64 = 1e9;
/// Where no row is violated by more, so many steps without half the residual are a zigzag: another method goes on.
/// Steps in few variables cost next to nothing.
const NEARLY: f64 = 1e-6;
const PATIENCE: u64 = 25;
const FEW: usize = 10;
/// Multipliers, in units, that rows of an ordinary program do not have.
const HEAVY: f64 = 1e3;
/// A step is taken from this part of the promised decrease on.
const TAKEN: f64 = 0.05;
/// After so many steps that were not taken, along a curved valley say, φ may rise for a few: a step is measured from so many earlier points
/// as well (Toint 1996).
const REFUSALS: u32 = 6;
const EARLIER: usize = 3;
/// A step that keeps less than this of its promise is corrected, so many times at most.
const KEPT: f64 = 0.5;
const CORRECTIONS: u32 = 4;
/// A row or an objective this much flatter, in units, than where its unit was measured is measured anew.
const FLATTER: f64 = 1e-4;
/// A point with a larger number is a start for nothing.
const FARTHEST: f64 = 1e15;
/// A trust region this small is none.
const SMALLEST: f64 = 1e-10;
/// The conditions of first order hold.
const SOLVED: f64 = 1e-11;
/// A decrease of φ below this, relative to its size, is rounding.
const ROUNDING: f64 = 1e-13;

/// How it ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum End {
    /// At a point that satisfies the conditions of first order, as far as numbers say.
    Solved,
    /// Where no step lessens what is violated: the multipliers may prove it.
    Infeasible,
    /// Far away.
    Diverging,
    /// The effort was spent.
    Spent,
    /// Steps get short.
    Stuck,
    /// Where rows or the objective are much flatter than their units say.
    Outgrown,
}

/// What is asked for besides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Request<'a> {
    /// Start from the active set that these multipliers name.
    pub multipliers: Option<&'a [f64]>,
    /// What is spent at most.
    pub effort: Effort,
    /// Equations are met by so much, in units of their largest entry: 0, but where they have no multipliers.
    pub width: f64,
    /// What of it runs.
    pub strategies: Strategies,
}

/// Where it ended.
#[derive(Debug)]
pub(super) struct Run {
    /// Point.
    pub x: Vec<f64>,
    /// Multipliers λ of the constraints, L = f + λᵀg.
    pub lambda: Vec<f64>,
    /// They are so large that the rows may have none.
    pub heavy: bool,
    /// Steps.
    pub steps: u64,
    /// How.
    pub end: End,
}

/// Runs from the start point. None where the start has no values or derivatives, and where the problem is too large.
pub(super) fn solve(nlp: &mut Problem, request: Request<'_>, budget: &Budget) -> Option<Run> {
    let (n, m) = nlp.size();
    if n + m > LARGEST {
        return None;
    }
    let mut start = nlp.start.clone();
    for (x, (&l, &u)) in start
        .iter_mut()
        .zip(nlp.bounds().0.iter().zip(nlp.bounds().1))
    {
        *x = x.max(l).min(u);
    }
    solve_from(nlp, start, request, false, budget)
}

/// The same from a point within the bounds; from the second time on, curvature counts for the unit of the objective.
fn solve_from(
    nlp: &mut Problem,
    start: Vec<f64>,
    request: Request<'_>,
    again: bool,
    budget: &Budget,
) -> Option<Run> {
    let (n, m) = nlp.size();
    let mut frame = Frame::new(nlp, &start, again)?;
    frame.widen(request.width);
    let values = Values::at(nlp, &frame, &start)?;
    let at = Point::new(nlp, &frame, start, values)?;
    let pivots = request.effort.pivots * (n + m) as u64;
    let linear = Linear::new(&frame, &at, pivots, request.strategies);
    let lambda = request.multipliers.map(|l| frame.in_units(l));
    let mut method = Method {
        nlp,
        lambda: lambda.clone().unwrap_or_else(|| vec![0.0; m]),
        linear,
        frame,
        at,
        penalty: FIRST_PENALTY,
        weight: 0.0,
        radius: 1.0,
        linear_radius: 1.0,
        budget,
        lowered: 0,
        recent: Vec::new(),
        refusals: 0,
        memory: Memory {
            strategies: request.strategies,
            ..Memory::default()
        },
        refused: None,
        strategies: request.strategies,
    };
    let working = lambda.and_then(|l| method.named_by(&l));
    let (steps, mut end) = method.run(working, request.effort.steps);
    if !again && end == End::Solved && method.at.is_level(method.nlp, &method.frame, FLATTER) {
        end = End::Outgrown;
    }
    if end == End::Outgrown {
        let effort = Effort {
            steps: request.effort.steps - steps,
            ..request.effort
        };
        let request = Request {
            multipliers: None,
            effort,
            ..request
        };
        let mut run = solve_from(method.nlp, method.at.x, request, true, budget)?;
        run.steps += steps;
        return Some(run);
    }
    let violated = method.frame.violation(&method.at.values.g) > 0.0;
    if violated && matches!(end, End::Solved | End::Stuck) {
        end = method.prove();
    }
    let largest = method.lambda.iter().fold(0.0_f64, |s, l| s.max(l.abs()));
    budget.log(format!("largest multiplier {largest:.1e}"));
    Some(Run {
        heavy: largest > HEAVY,
        lambda: method.frame.multipliers(&method.lambda),
        x: method.at.x,
        steps,
        end,
    })
}

struct Method<'a, 'm> {
    nlp: &'a mut Problem,
    frame: Frame,
    at: Point,
    lambda: Vec<f64>,
    linear: Linear,
    /// ν in the linear programs.
    penalty: f64,
    /// ν in φ: the multipliers say what is enough.
    weight: f64,
    /// Trust region of a step, and that of the linear programs.
    radius: f64,
    linear_radius: f64,
    /// How often the weight was lowered.
    lowered: u32,
    /// Objective, violation and promise of the last steps that were taken, from where they began.
    recent: Vec<[f64; 3]>,
    /// Steps that were not taken.
    refusals: u32,
    memory: Memory,
    /// What a step that was refused was made of: the next is made of the same if its working set is.
    refused: Option<Refused>,
    strategies: Strategies,
    budget: &'a Budget<'m>,
}

/// What a refused step was made of.
struct Refused {
    working: Working,
    lambda: Vec<f64>,
    hessian: Vec<Entry>,
    quadratic: Equality,
}

/// What the linear program says about going on.
enum Found {
    Step(Step),
    End(End),
}

impl Method<'_, '_> {
    fn run(&mut self, mut working: Option<Working>, most: u64) -> (u64, End) {
        let mut steps = 0;
        let mut halved = (0, f64::INFINITY);
        let mut tried = f64::INFINITY;
        while steps < most && !self.budget.is_over() {
            self.frame.see_rounding(&self.at);
            let residual = self.at.residual(&self.frame, &self.lambda);
            if residual <= SOLVED {
                return (steps, End::Solved);
            }
            let violated = self.frame.violation(&self.at.values.g) > NEARLY;
            if self.at.x.len() < FEW || violated || residual < 0.5 * halved.1 {
                halved = (steps, residual);
            } else if steps - halved.0 >= PATIENCE {
                break;
            }
            if self.radius.min(self.linear_radius) <= SMALLEST {
                return (steps, End::Stuck);
            }
            steps += 1;
            self.note(steps);
            if working.is_none() && residual < 0.5 * tried {
                (working, tried) = (self.at_hand(), residual);
            }
            if let Some(held) = working.take() {
                working = self.newton(held);
                if working.is_some() {
                    continue;
                }
            }
            let step = match self.program() {
                Found::Step(step) => step,
                Found::End(end) => return (steps, end),
            };
            match self.step(step) {
                Ok(next) => working = next,
                Err(end) => return (steps, end),
            }
            if self.at.is_flatter(&self.frame, FLATTER) {
                return (steps, End::Outgrown);
            }
            if self.at.x.iter().any(|x| x.abs() > FARTHEST) {
                return (steps, End::Diverging);
            }
        }
        (steps, End::Spent)
    }

    fn note(&self, step: u64) {
        self.budget.tell(Progress {
            method: "sequential quadratic programming",
            iteration: step,
            ..Progress::default()
        });
        if self.budget.wants_log() {
            self.budget.log(format!(
                "{step:>6}  {:>16.9e}  violation {:.2e}  residual {:.2e}  trust {:.1e} {:.1e}  penalty {:.0e}",
                self.at.values.f * self.frame.price,
                self.frame.violation(&self.at.values.g),
                self.at.residual(&self.frame, &self.lambda),
                self.radius,
                self.linear_radius,
                self.weight,
            ));
        }
    }

    /// Whether anything lessens the violations from here, with the multipliers that say no.
    fn prove(&mut self) -> End {
        if self.forgive() {
            return End::Stuck;
        }
        let aim = Aim {
            penalty: 1.0,
            weight: 0.0,
            radius: 1.0,
        };
        match self.linear.solve(&self.frame, &self.at, aim, self.budget) {
            Some(best) if best.short > 0.0 => {
                self.lambda = best.lambda;
                End::Infeasible
            }
            _ => End::Stuck,
        }
    }

    /// Whether the violated rows differ by rounding only from rows that hold, which they then become.
    fn forgive(&mut self) -> bool {
        self.strategies.run(Strategy::RoundedData) && self.frame.forgive(&self.at.values.g)
    }

    /// The working set that multipliers name.
    fn named_by(&self, lambda: &[f64]) -> Option<Working> {
        let (frame, at) = (&self.frame, &self.at);
        let row = |i: usize| match lambda[i] {
            _ if frame.is_equation(i) => Some(frame.below[i]),
            l if l > 0.0 => Some(frame.above[i]).filter(|v| v.is_finite()),
            l if l < 0.0 => Some(frame.below[i]).filter(|v| v.is_finite()),
            _ => None,
        };
        let column = |j: usize| {
            let bounds = [frame.lower[j], frame.upper[j]];
            bounds.into_iter().find(|&b| at.x[j] == b)
        };
        Some(Working {
            column: (0..frame.n).map(column).collect(),
            row: (0..frame.m).map(row).collect(),
            pull: vec![0.0; frame.m],
        })
    }

    /// Where there are equations only: these, and the bounds that variables do not want to leave.
    fn at_hand(&self) -> Option<Working> {
        let known = (0..self.frame.m).all(|i| self.frame.is_equation(i))
            && self.strategies.run(Strategy::ActiveSetNewton);
        let mut working = known.then(|| self.named_by(&self.lambda)).flatten()?;
        let reduced = self.reduced();
        for (j, bound) in working.column.iter_mut().enumerate() {
            *bound = bound.filter(|&b| self.keeps(j, b, reduced[j]));
        }
        Some(working)
    }

    /// The gradient of the Lagrangian.
    fn reduced(&self) -> Vec<f64> {
        let mut reduced = self.at.gradient.clone();
        for (i, &l) in self.lambda.iter().enumerate().filter(|l| *l.1 != 0.0) {
            for (j, a) in self.at.rows.line(i) {
                reduced[j] += l * a;
            }
        }
        reduced
    }

    /// Whether a variable with this reduced cost stays at a bound.
    fn keeps(&self, j: usize, bound: f64, reduced: f64) -> bool {
        let (lower, upper) = (self.frame.lower[j], self.frame.upper[j]);
        match lower == upper {
            true => true,
            false if bound == lower => reduced >= -SOLVED,
            false => reduced <= SOLVED,
        }
    }

    /// Newton's step on a working set, which is returned if it may stay. Otherwise nothing has changed, or a step was taken
    /// that needs another set.
    fn newton(&mut self, working: Working) -> Option<Working> {
        let hessian = self.at.hessian(self.nlp, &self.frame, &self.lambda);
        let (frame, memory) = (&self.frame, &mut self.memory);
        let quadratic = Equality::new(frame, &self.at, &hessian, &working, 0, memory)?;
        let zero = vec![0.0; self.frame.n];
        let model = Model {
            frame: &self.frame,
            at: &self.at,
            hessian: &hessian,
            weight: self.weight,
        };
        let reaches = model.longest(&zero, &quadratic.d, &working, self.radius) >= 1.0;
        self.memory.factors = quadratic.factors;
        if !reaches {
            return None;
        }
        let mut next = sum(&self.at.x, 1.0, &quadratic.d);
        self.frame.clip(&mut next);
        let values = Values::at(self.nlp, &self.frame, &next)?;
        let there = Point::new(self.nlp, &self.frame, next, values)?;
        let before = self.at.residual(&self.frame, &self.lambda);
        let after = there.residual(&self.frame, &quadratic.lambda);
        // of Newton's method only what converges
        if after > 0.5 * before {
            return None;
        }
        self.at = there;
        self.lambda = quadratic.lambda;
        self.signs_are_right(&working).then_some(working)
    }

    /// Whether no row or bound of the set would rather be left, and no other row is violated.
    fn signs_are_right(&self, working: &Working) -> bool {
        let frame = &self.frame;
        let reduced = self.reduced();
        let rows = (0..frame.m).all(|i| match working.row[i] {
            _ if working.pull[i] != 0.0 => false,
            Some(_) if frame.is_equation(i) => true,
            Some(side) if side == frame.above[i] => self.lambda[i] >= -SOLVED,
            Some(_) => self.lambda[i] <= SOLVED,
            None => frame.missing(i, self.at.values.g[i]) == 0.0,
        });
        let columns =
            (0..frame.n).all(|j| working.column[j].is_none_or(|b| self.keeps(j, b, reduced[j])));
        rows && columns
    }

    /// The linear program, with a penalty that lets it lessen the violations if anything does.
    fn program(&mut self) -> Found {
        let mut radius = self.linear_radius;
        let mut now = self.frame.violation(&self.at.values.g);
        let mut least: Option<f64> = None;
        loop {
            let aim = Aim {
                penalty: self.penalty,
                weight: 1.0,
                radius,
            };
            let Some(step) = self.linear.solve(&self.frame, &self.at, aim, self.budget) else {
                return Found::End(End::Stuck);
            };
            self.penalty = step.penalty;
            if self.linear.confined {
                self.frame.nonlinear.fill(true);
            }
            if step.short == 0.0 || now == 0.0 {
                return Found::Step(step);
            }
            // what is possible at most
            let most = match least {
                Some(l) => l,
                None => {
                    let aim = Aim {
                        penalty: 1.0,
                        weight: 0.0,
                        radius,
                    };
                    let Some(best) = self.linear.solve(&self.frame, &self.at, aim, self.budget)
                    else {
                        return Found::Step(step);
                    };
                    if best.short > (1.0 - 1e-7) * now {
                        if best.confined && radius < 1.0 {
                            radius = (10.0 * radius).min(1.0);
                            continue;
                        }
                        if self.forgive() {
                            now = 0.0;
                            continue;
                        }
                        self.lambda = best.lambda;
                        return Found::End(End::Infeasible);
                    }
                    *least.insert(best.short)
                }
            };
            if now - step.short >= 0.1 * (now - most) || self.penalty >= MOST_PENALTY {
                return Found::Step(step);
            }
            self.penalty *= 10.0;
        }
    }

    /// Multipliers to begin with: of rows that are new the linear program knows more.
    fn expected(&self, linear: &Step) -> Vec<f64> {
        let working = &linear.working;
        (0..self.frame.m)
            .map(|i| match (working.row[i], self.lambda[i]) {
                (None, _) => working.pull[i],
                (Some(_), 0.0) => linear.lambda[i],
                (Some(_), l) => l,
            })
            .collect()
    }

    /// The Hessian with these multipliers, and the quadratic program on a working set: those of a refused step where it was made of
    /// the same.
    fn quadratic(&mut self, working: &Working, lambda: &[f64]) -> (Vec<Entry>, Option<Equality>) {
        match self.refused.take() {
            Some(r) if r.working == *working && r.lambda == lambda => {
                (r.hessian, Some(r.quadratic))
            }
            refused => {
                if let Some(refused) = refused {
                    self.memory.factors = refused.quadratic.factors;
                }
                let hessian = self.at.hessian(self.nlp, &self.frame, lambda);
                let (frame, memory) = (&self.frame, &mut self.memory);
                let new = Equality::new(frame, &self.at, &hessian, working, ANY, memory);
                (hessian, new)
            }
        }
    }

    /// A step from the solution of the linear program, if it lessens φ; the working set if that may stay.
    fn step(&mut self, linear: Step) -> Result<Option<Working>, End> {
        let working = &linear.working;
        let largest = |l: &[f64]| l.iter().fold(0.0_f64, |t, v| t.max(v.abs()));
        let mut needed = 2.0 * largest(&linear.lambda);
        let lambda = self.expected(&linear);
        let (hessian, quadratic) = self.quadratic(working, &lambda);
        if let Some(q) = &quadratic
            && !q.shifted
        {
            needed = needed.max(2.0 * largest(&q.lambda));
        }
        self.reweigh(linear.short, needed.min(MOST_PENALTY));
        let model = Model {
            frame: &self.frame,
            at: &self.at,
            hessian: &hessian,
            weight: self.weight,
        };
        let phi = |v: &Values, weight: f64, frame: &Frame| v.f + weight * frame.violation(&v.g);
        let now = phi(&self.at.values, self.weight, &self.frame);
        let (cauchy, part) = model.cauchy(&linear.d, self.radius);
        let Course {
            d,
            full,
            working,
            quadratic,
        } = model.course(&cauchy, quadratic, linear.working.clone(), self.radius);
        let promised = -model.change(&d);
        let small = promised <= ROUNDING * now.abs().max(1.0);
        if small && self.at.residual(&self.frame, &linear.lambda) <= SOLVED {
            // other vertices are as good: the point stays
            self.lambda = linear.lambda;
            return Err(End::Solved);
        }
        let mut next = sum(&self.at.x, 1.0, &d);
        self.frame.clip(&mut next);
        let mut there = Values::at(self.nlp, &self.frame, &next);
        let weight = self.weight;
        let ratio = |v: &Option<Values>, frame: &Frame| match v {
            Some(v) => (now - phi(v, weight, frame)) / promised,
            None => -1.0,
        };
        let mut gain = if small {
            1.0
        } else {
            ratio(&there, &self.frame)
        };
        let along = self.at.along(&d);
        for _ in 0..CORRECTIONS {
            let (Some(v), Some(q)) = (&there, &quadratic) else {
                break;
            };
            let Some(other) = self.corrected(&next, v, &along, q).filter(|_| gain < KEPT) else {
                break;
            };
            let values = Values::at(self.nlp, &self.frame, &other);
            let corrected = ratio(&values, &self.frame);
            if corrected <= gain {
                break;
            }
            (next, there, gain) = (other, values, corrected);
        }
        if gain < TAKEN
            && self.refusals >= REFUSALS
            && linear.short == 0.0
            && let Some(v) = &there
        {
            let phi = phi(v, weight, &self.frame);
            let mut sum = promised;
            for [f, violation, p] in self.recent.iter().rev() {
                sum += p;
                gain = gain.max((f + weight * violation - phi) / sum);
            }
        }
        let length = self.at.length(&self.frame, &d);
        let first = self.at.length(&self.frame, &cauchy);
        self.resize(gain, length, first, part >= 1.0);
        if gain < TAKEN {
            self.refusals += 1;
            self.refused = quadratic.map(|mut quadratic| {
                quadratic.leave_all();
                Refused {
                    working: linear.working,
                    lambda,
                    hessian,
                    quadratic,
                }
            });
            return Ok(None);
        }
        let lambda = match (&quadratic, full) {
            (Some(q), true) if !q.yields => q.lambda.clone(),
            _ => linear.lambda.clone(),
        };
        let point = there.and_then(|v| Point::new(self.nlp, &self.frame, next, v));
        let Some(point) = point else {
            // values without derivatives: a kink, beside which there are some
            self.radius = 0.5 * self.radius.min(length);
            self.linear_radius = self.linear_radius.min(self.radius);
            return Ok(None);
        };
        if small
            && point.residual(&self.frame, &lambda) >= self.at.residual(&self.frame, &self.lambda)
        {
            if linear.short > 0.0 && self.penalty < MOST_PENALTY {
                // stationary for this penalty only
                self.penalty *= 100.0;
                return Ok(None);
            }
            self.at = point;
            let (frame, memory) = (&self.frame, &mut self.memory);
            let again = Equality::new(frame, &self.at, &hessian, &working, ANY, memory);
            let last = [again, quadratic].into_iter().flatten().map(|q| q.lambda);
            self.choose(last.chain([lambda, linear.lambda]));
            return Err(End::Solved);
        }
        if self.recent.len() >= EARLIER {
            self.recent.remove(0);
        }
        let values = &self.at.values;
        self.recent
            .push([values.f, self.frame.violation(&values.g), promised]);
        self.at = point;
        self.lambda = lambda;
        self.memory.factors = quadratic.and_then(|q| q.factors);
        let stays = full
            && self.signs_are_right(&working)
            && self.strategies.run(Strategy::ActiveSetNewton);
        Ok(stays.then_some(working))
    }

    /// Where a step had ended, without what the curvature of the held rows added to what they change by along it.
    fn corrected(
        &self,
        next: &[f64],
        there: &Values,
        along: &[f64],
        q: &Equality,
    ) -> Option<Vec<f64>> {
        if !self.strategies.run(Strategy::SecondOrderCorrection) {
            return None;
        }
        let held = |i: usize| there.g[i] - self.at.values.g[i] - along[i];
        let curvature: Vec<f64> = (0..self.frame.m).map(held).collect();
        let mut other = sum(next, 1.0, &q.correction(&curvature)?);
        self.frame.clip(&mut other);
        Some(other)
    }

    /// Of these multipliers and those there are the ones that leave least of the conditions of first order.
    fn choose(&mut self, others: impl Iterator<Item = Vec<f64>>) {
        let mut worth = self.at.residual(&self.frame, &self.lambda);
        for other in others {
            let left = self.at.residual(&self.frame, &other);
            if left < worth {
                (self.lambda, worth) = (other, left);
            }
        }
    }

    /// The weight of violations in φ: somewhat above the multipliers. Where it was far above them, it becomes less, for a
    /// heavy one makes steps short; but not for ever, so that φ is the same in the end.
    fn reweigh(&mut self, short: f64, needed: f64) {
        if short > 0.0 {
            self.weight = self.penalty.max(needed);
        } else if self.weight < needed {
            self.weight = needed;
        } else if self.weight > 8.0 * needed && self.lowered < 30 {
            self.lowered += 1;
            self.weight = 2.0 * needed;
        }
        if short == 0.0 {
            self.penalty = (5.0 * needed).clamp(FIRST_PENALTY, self.penalty.max(FIRST_PENALTY));
        }
    }

    /// Trust regions after a step: as far as a parabola through what was promised and what came says.
    fn resize(&mut self, gain: f64, length: f64, cauchy: f64, whole: bool) {
        let part = 0.5 / (1.0 - gain).abs();
        self.radius = match part >= 1.0 {
            true => self.radius.max(part.min(7.0) * length),
            false => part.max(0.2) * self.radius.min(length),
        };
        let near = (1.2 * length)
            .max(1.2 * cauchy)
            .max(0.1 * self.linear_radius);
        self.linear_radius = match (gain >= TAKEN, whole) {
            (true, true) if gain >= 0.9 && cauchy >= 0.5 * length => 7.0 * self.linear_radius,
            (true, true) => near.min(7.0 * self.linear_radius),
            _ => (near / 2.4).min(self.linear_radius),
        };
        self.linear_radius = self.linear_radius.min(self.radius).max(SMALLEST);
    }
}
