//! First-order descent at kinks: no point is called optimal while a direction leads down across the pieces that meet there.
//!
//! Each max, min and abs becomes a column v with a row for each argument, g_k(x) ≤ v (≥ for min), as in
//! [`super::epigraph`]; that of the piece taken is an equation. The function is piecewise smooth, so that f'(x; d) is linear in
//! d on finitely many cones, one for each choice among the pieces that meet at x (Scholtes 2012). The least slope over
//! all of them is found by branch and bound: a linear program in d, in which v may exceed all its pieces, bounds them from below.
//! Where kinks are convex its multipliers are a common subgradient, and it is the only one; only a kink whose v does exceed
//! its pieces is branched on. If no program descends, x is B-stationary. If one does, the search goes on in its pieces.

use super::builder::Builder;
use super::parts::expressions;
use crate::autodiff::{Evaluator, Kinks, kinks};
use crate::model::builder::Term;
use crate::model::instance::{Function, Instance, Relation};
use crate::model::problem_type::ProblemType;
use crate::solve::answer::{Answer, subproblem};
use crate::solve::backend::{Reply, Task};
use crate::solve::certificate::nonlinear::{binding_rows, steps_within_bounds};
use crate::solve::certificate::{Residuals, TOLERANCE};
use crate::solve::{Budget, Claim, ModelStatus, Settings};
use std::ops::Range;

/// How often the search goes on in other pieces.
const MAX_DESCENTS: usize = 100;
/// Linear programs for one point.
const MAX_LINEAR_PROGRAMS: usize = 1000;
/// The least slope that counts, relative to the largest entry of the rows of the objective: residuals of several columns,
/// each within its tolerance, add up.
const LEAST_SLOPE: f64 = 10.0 * TOLERANCE;
/// What a descent must gain, relative to the value.
const LEAST_GAIN: f64 = 1e-8;
/// The cost of all columns of kinks together, so that none exceeds its pieces where it costs nothing else.
const TIE_BREAK: f64 = 1e-7;
/// How far a column exceeds its pieces, relative to what it can change by, where they are met.
const LOOSE: f64 = 1e-7;

/// A kink: its column, the rows of its arguments, and those of the pieces that meet at the point.
struct Kink {
    column: usize,
    is_max: bool,
    active: Vec<usize>,
}

/// The program with columns in place of kinks, at a point.
struct Pieces {
    instance: Instance,
    kinks: Vec<Kink>,
    lines: Vec<Vec<(usize, f64)>>,
    /// By row: whether it holds as an equation at the point.
    binding: Vec<bool>,
}

/// What is known of the slopes at a point.
enum Slopes {
    /// One piece of each kink: the program is smooth there.
    Smooth,
    /// None leads down.
    Stationary,
    /// One does, in the pieces whose rows are given: its slope.
    Descent(Vec<usize>, f64),
    /// Too many pieces meet, or a linear program failed.
    Unknown,
}

/// The answer, or one from further down where a direction of descent leads on from it. Without the claim of an optimum where
/// the last point has such a direction, or is not known to have none.
pub fn without_descent(
    task: &Task,
    mut found: Answer,
    certified: fn(&Task, Reply, Option<Residuals>) -> Answer,
    settings: &Settings,
    budget: &Budget,
) -> Answer {
    let applies = task.is_continuous() && kinks(task.instance) == Some(Kinks::Anywhere);
    let Some(objective) = task.instance.objective.filter(|_| applies) else {
        return found;
    };
    let sign = objective.sense.sign();
    let value = |a: &Answer| sign * a.outcome.level[objective.column as usize];
    let mut slope = None;
    for _ in 0..MAX_DESCENTS {
        let claims = matches!(
            found.status,
            ModelStatus::Optimal | ModelStatus::LocallyOptimal
        );
        if !claims && (found.status != ModelStatus::Feasible || budget.is_over()) {
            return found;
        }
        let pieces = Pieces::new(task.instance, &found.outcome.level);
        let slopes = match &pieces {
            Some(p) => p.slopes(settings, budget),
            None => Slopes::Unknown,
        };
        let (selected, descends) = match slopes {
            Slopes::Smooth => return found,
            Slopes::Stationary if claims => return found,
            Slopes::Stationary => (Vec::new(), false),
            Slopes::Descent(selected, by) => {
                slope = Some(by);
                (selected, true)
            }
            Slopes::Unknown => break,
        };
        let next = pieces.and_then(|p| p.search(&selected, task, &found, settings, budget));
        let Some((reply, dual)) = next else { break };
        let next = certified(task, reply, Some(dual));
        if next.status == ModelStatus::Unbounded {
            return next;
        }
        let margin = LEAST_GAIN * value(&found).abs().max(1.0);
        let better = match descends {
            true => value(&next) < value(&found) - margin,
            false => next.status.is_solution() && value(&next) <= value(&found) + margin,
        };
        if !better || !next.residuals.is_feasible(TOLERANCE) {
            break;
        }
        slope = None;
        found = next;
    }
    if found.status.is_solution() {
        found.outcome.claim = Claim::Unfinished;
        found.status = ModelStatus::Feasible;
        found.outcome.message = Some(match slope {
            Some(_) => "a direction leads down from this kink: it is no local optimum".into(),
            None => "it is not known whether a direction leads down from this kink".into(),
        });
        if let Some(slope) = slope {
            found.residuals.dual = found.residuals.dual.map(|d| d.max(-slope));
            found.residuals.dual_relative = found.residuals.dual_relative.max(-slope);
        }
    }
    found
}

impl Pieces {
    /// None where a function has no value or no derivative.
    fn new(instance: &Instance, level: &[f64]) -> Option<Self> {
        let mut builder = Builder::new(instance);
        builder.columns.level.copy_from_slice(level);
        builder.columns.marginal.fill(0.0);
        builder.rows.marginal.fill(0.0);
        for (row, coefficient, term) in expressions(instance) {
            match term.has_kink() {
                false => builder.push_term(row, coefficient, term),
                true => {
                    let smooth = term.without_kinks(&mut |f, a| builder.column_of(f, a));
                    builder.place_smooth(row, coefficient, &smooth);
                }
            }
        }
        let lifted = std::mem::take(&mut builder.lifted);
        builder.lifted.clone_from(&lifted);
        let instance = builder.finish(instance);
        let x = &instance.columns.level;
        let (activity, lines) = Evaluator::first_order(&instance).linearised(x).ok()?;
        let binding = binding_rows(&instance, x, &activity, &lines);
        let kink = |(column, rows, is_max): (usize, Range<usize>, bool)| Kink {
            column,
            is_max,
            active: rows.filter(|&i| binding[i]).collect(),
        };
        let kinks: Vec<Kink> = lifted.into_iter().map(kink).collect();
        let known = kinks.iter().all(|k| !k.active.is_empty());
        known.then_some(Self {
            instance,
            kinks,
            lines,
            binding,
        })
    }

    /// Rows of the only piece of each kink that has one.
    fn single(&self) -> impl Iterator<Item = usize> + '_ {
        let one = |k: &Kink| (k.active.len() == 1).then_some(k.active[0]);
        self.kinks.iter().filter_map(one)
    }

    /// Looks for a direction of descent.
    fn slopes(&self, settings: &Settings, budget: &Budget) -> Slopes {
        if self.kinks.iter().all(|k| k.active.len() == 1) {
            return Slopes::Smooth;
        }
        let Some(objective) = self.instance.objective else {
            return Slopes::Unknown;
        };
        let (z, sign) = (objective.column as usize, objective.sense.sign());
        let (mut program, scale, reach) = self.program(z);
        let relations = program.rows.relation.clone();
        let mut open = vec![Vec::new()];
        for _ in 0..MAX_LINEAR_PROGRAMS {
            let Some(selected) = open.pop() else {
                return Slopes::Stationary;
            };
            program.rows.relation.clone_from(&relations);
            for &i in self.single().collect::<Vec<_>>().iter().chain(&selected) {
                program.rows.relation[i] = Relation::Equal;
            }
            let task = Task::new(ProblemType::Lp, &program);
            let Ok(answer) = subproblem(&task, settings, budget) else {
                return Slopes::Unknown;
            };
            if answer.status != ModelStatus::Optimal {
                return Slopes::Unknown;
            }
            let d = &answer.outcome.level;
            let slope = sign * d[z];
            if slope >= -LEAST_SLOPE * scale {
                continue;
            }
            let slope_of = |i: usize| self.lines[i].iter().map(|&(j, a)| a * d[j]).sum::<f64>();
            let excess = |k: &Kink| {
                let least = k.active.iter().map(|&i| slope_of(i).abs());
                least.fold(f64::INFINITY, f64::min) / reach[k.column].max(1.0)
            };
            let loose = self.kinks.iter().map(|k| (excess(k), k));
            match loose.max_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((excess, kink)) if excess > LOOSE => {
                    open.extend(kink.active.iter().map(|&i| {
                        let mut more = selected.clone();
                        more.push(i);
                        more
                    }))
                }
                _ => return Slopes::Descent(selected, slope),
            }
        }
        Slopes::Unknown
    }

    /// The linear program in the direction, its rows those of the instance, all pieces of a kink below (above) its column; the
    /// size of a slope; and by column how far it can go.
    fn program(&self, z: usize) -> (Instance, f64, Vec<f64>) {
        let (instance, x) = (&self.instance, &self.instance.columns.level);
        let mut reach = vec![1.0; x.len()];
        for k in &self.kinks {
            let others = |i: &usize| {
                let entries = self.lines[*i].iter().filter(|e| e.0 != k.column);
                entries.map(|&(j, a)| a.abs() * reach[j]).sum::<f64>()
            };
            reach[k.column] = k.active.iter().map(others).fold(0.0, f64::max);
        }
        reach[z] = f64::INFINITY;
        let mut program = Instance::default();
        for (j, &reach) in reach.iter().enumerate() {
            let [down, up] = steps_within_bounds(instance, x, j, reach);
            program.add_column(down, up, 0.0);
        }
        let mut scale = 1.0_f64;
        for (i, line) in self.lines.iter().enumerate() {
            let line = if self.binding[i] { &line[..] } else { &[] };
            if line.iter().any(|e| e.0 == z) {
                scale = line.iter().fold(scale, |s, e| s.max(e.1.abs()));
            }
            program.add_row(line.iter().copied(), instance.rows.relation[i], 0.0);
        }
        let sign = instance.sign();
        let cost = TIE_BREAK * sign / self.kinks.len() as f64;
        let value = program.add_column(f64::NEG_INFINITY, f64::INFINITY, 0.0);
        let costs = self.kinks.iter().map(|k| match k.is_max {
            true => (k.column, -cost),
            false => (k.column, cost),
        });
        let entries = costs.chain([(value, 1.0), (z, -1.0)]);
        program.add_row(entries, Relation::Equal, 0.0);
        if let Some(o) = instance.objective {
            program.set_objective(value, o.sense);
        }
        (program, scale, reach)
    }

    /// Solves the program in the given pieces from the point, those of other kinks as they are there: the reply, and the
    /// residuals that belong to its multipliers.
    fn search(
        mut self,
        selected: &[usize],
        task: &Task,
        found: &Answer,
        settings: &Settings,
        budget: &Budget,
    ) -> Option<(Reply, Residuals)> {
        let equations: Vec<usize> = self.single().chain(selected.iter().copied()).collect();
        for &i in &equations {
            self.instance.rows.relation[i] = Relation::Equal;
        }
        let there = Task {
            using: ProblemType::Nlp,
            instance: &self.instance,
            seen: None,
            basis: None,
            ..*task
        };
        let answer = subproblem(&there, settings, budget).ok()?;
        let (n, m) = (task.instance.column_count(), task.instance.row_count());
        let mut outcome = answer.outcome.of_first(n, m);
        outcome.ray.clear();
        outcome.iterations += found.outcome.iterations;
        outcome.solver = found.outcome.solver;
        // in pieces that are all given, every point is one of the program itself
        let exact = equations.len() == self.kinks.len();
        outcome.claim = match answer.status {
            ModelStatus::Optimal | ModelStatus::LocallyOptimal => Claim::LocallySolved,
            ModelStatus::Unbounded if exact => Claim::Unbounded,
            _ => Claim::Unfinished,
        };
        Some((outcome.into(), answer.residuals))
    }
}

impl Builder {
    /// A column in place of a kink, with a row for each argument.
    fn column_of(&mut self, f: Function, arguments: Vec<Term>) -> u32 {
        let is_max = f != Function::Min;
        let v = self.columns.push(f64::NEG_INFINITY, f64::INFINITY);
        let signs: &[f64] = match f {
            Function::Abs => &[1.0, -1.0],
            _ => &[1.0],
        };
        let first = self.rows.rhs.len();
        for argument in &arguments {
            for &sign in signs {
                let row = self.push_row(match is_max {
                    true => Relation::Less,
                    false => Relation::Greater,
                });
                self.entries.push((row, v as u32, -1.0));
                self.place_smooth(row, sign, argument);
            }
        }
        self.lifted.push((v, first..self.rows.rhs.len(), is_max));
        v as u32
    }

    /// Puts a term without kinks into the left side of a row.
    fn place_smooth(&mut self, row: usize, weight: f64, term: &Term) {
        for (weight, part) in self.place_linear(row, term.parts(weight)) {
            self.push_term(row, weight, part);
        }
    }
}
