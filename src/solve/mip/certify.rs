//! A proved interval for the best value of a linear program with discrete columns.
//!
//! The search is done again without anything that rounds: no presolve, no cuts, no propagation, only the program's own
//! rows and bounds, branched on discrete columns. Every node's bound is proved from the multipliers of its relaxation, in
//! interval arithmetic, and where that fails and the node is small in rational arithmetic; so is that a node is empty. A
//! node is left when its proved bound reaches the solution. The solution is proved as any linear program's is, with the
//! discrete columns fixed. What was not reached in time counts with its parent's bound: the interval is then wider, but
//! right.

use super::model::{Change, Mip};
use super::relaxation::Control;
use crate::model::instance::Instance;
use crate::solve::lp::certify::{Proof, Unproved};
use crate::solve::lp::form::{Form, Point, Problem};
use crate::solve::lp::simplex::{Basis, Simplex};
use crate::solve::lp::{self, Ended};
use crate::solve::mpec::bound::prove_node;
use crate::solve::{Budget, Outcome, SolveError};
use std::rc::Rc;

/// Bounds of a node, all of them, and where to start.
struct Open {
    changes: Rc<Vec<Change>>,
    basis: Rc<Basis>,
    bound: f64,
}

/// How many nodes a proof may take.
const NODES: usize = 200_000;

/// Seconds it may take.
const MAX_SECONDS: f64 = 600.0;

/// Proves a bound of a node, for its solution, with more effort.
type Slowly<'s> = &'s dyn Fn(&Problem, &Point) -> Option<f64>;

/// Proves what it can of the lower bound (of a maximum: the upper one); the other side of `proof` is the
/// solution's, whose value is about `value`.
pub(super) fn certify(
    instance: &Instance,
    proof: Proof,
    value: f64,
    budget: &Budget,
) -> Result<Proof, SolveError> {
    budget.within(MAX_SECONDS, u64::MAX, |budget| {
        prove(instance, proof, value, budget)
    })
}

fn prove(
    instance: &Instance,
    mut proof: Proof,
    value: f64,
    budget: &Budget,
) -> Result<Proof, SolveError> {
    let form = Form::exact(instance)?;
    let mip = Mip::new(form.problem.clone(), instance, &form.columns, false);
    let mut control = Control::new(budget);
    // As a minimum.
    let mut reached = match form.sign > 0.0 {
        true => proof.high,
        false => -proof.low,
    };
    if !reached.is_finite() {
        reached = form.sign * value;
    }
    // Where multipliers alone prove nothing (columns without bounds), the way of linear programs is gone.
    let slowly = |p: &Problem, at: &Point| {
        let mut node = instance.clone();
        for (k, &j) in form.columns.iter().enumerate() {
            node.columns.lower[j as usize] = p.lower[k];
            node.columns.upper[j as usize] = p.upper[k];
        }
        let (level, row_marginal, column_marginal) = form.point(&node, at);
        let outcome = Outcome {
            level,
            row_marginal,
            column_marginal,
            ..super::nothing(&node, None)
        };
        let proof = budget.aside(|budget| lp::certify::certify(&node, &outcome, budget));
        let proof = proof.ok()?;
        Some(if form.sign > 0.0 {
            proof.low
        } else {
            -proof.high
        })
    };
    let bound = lowest(&mip, reached, &slowly, &mut control);
    let why = "the search for a proof was cut short, or numbers broke down in it";
    let missing = (bound == f64::NEG_INFINITY).then(|| Unproved::new(why));
    if form.sign > 0.0 {
        (proof.low, proof.no_low) = (bound, missing);
    } else {
        (proof.high, proof.no_high) = (-bound, missing);
    }
    Ok(proof)
}

/// A number that no solution's value is below, constant included; about `reached` if the search comes to its end.
fn lowest(mip: &Mip, reached: f64, slowly: Slowly, control: &mut Control) -> f64 {
    let step = whole_values(mip);
    // What is enough: the solution's value, or more than the next smaller value.
    let enough = match step {
        true if reached.is_finite() => reached - 1.0 + 1e-6,
        _ => reached - 1e-9 * reached.abs().max(1e-6),
    };
    let mut p = mip.problem.clone();
    let mut simplex = Simplex::new(&p);
    simplex.trusted = 40;
    let mut lowest = reached;
    let mut stack = vec![Open {
        changes: Rc::new(Vec::new()),
        basis: Rc::new(simplex.basis()),
        bound: f64::NEG_INFINITY,
    }];
    let mut nodes = 0;
    while let Some(open) = stack.pop() {
        nodes += 1;
        if nodes > NODES || control.stop(0).is_some() {
            let left = stack.iter().map(|o| o.bound).fold(open.bound, f64::min);
            return lowest.min(left);
        }
        let known = narrow(mip, &mut p, &mut simplex, &open.changes);
        if !known {
            continue; // a set asks for 0 where the bounds exclude it
        }
        simplex.set_basis(&open.basis);
        let ended = simplex.resolve(&mut |_| control.stop(0));
        let proved = match &ended {
            Ended::Solved => simplex
                .point()
                .map(|at| match prove_node(&p, &at.y, false) {
                    f64::NEG_INFINITY => slowly(&p, &at).unwrap_or(f64::NEG_INFINITY),
                    bound => bound,
                }),
            Ended::Infeasible(y) => Some(prove_node(&p, y, true)),
            _ => None,
        };
        let mut bound = proved.unwrap_or(f64::NEG_INFINITY).max(open.bound);
        if step && bound.is_finite() {
            // Of whole values the next one counts; the constant is one of them.
            bound = bound.ceil();
        }
        if bound >= enough {
            lowest = lowest.min(bound);
            continue;
        }
        let x = simplex.values()[..p.n()].to_vec();
        let children = branches(mip, &p, &x, ended == Ended::Solved);
        if children.is_empty() {
            lowest = lowest.min(bound);
            continue;
        }
        let basis = Rc::new(simplex.basis());
        for child in children {
            let changes = open.changes.iter().copied().chain(child).collect();
            stack.push(Open {
                changes: Rc::new(changes),
                basis: basis.clone(),
                bound,
            });
        }
    }
    lowest
}

/// Whether every value of the objective is an integer, exactly.
fn whole_values(mip: &Mip) -> bool {
    let p = &mip.problem;
    let whole = |v: f64| v == v.trunc() && v.abs() < 1e9;
    let cost = |j: usize| p.cost[j] == 0.0 || mip.integer[j] && whole(p.cost[j]);
    whole(p.offset) && (0..p.n()).all(cost)
}

/// The bounds of a node. False: they cross.
fn narrow(mip: &Mip, p: &mut Problem, simplex: &mut Simplex, changes: &[Change]) -> bool {
    p.lower.copy_from_slice(&mip.problem.lower);
    p.upper.copy_from_slice(&mip.problem.upper);
    for c in changes {
        p.lower[c.column] = p.lower[c.column].max(c.lower);
        p.upper[c.column] = p.upper[c.column].min(c.upper);
        if p.lower[c.column] > p.upper[c.column] {
            return false;
        }
    }
    for j in 0..p.n() {
        simplex.set_bounds(j, p.lower[j], p.upper[j]);
    }
    true
}

/// Parts that together hold all discrete points of a node; none where it cannot be divided.
fn branches(mip: &Mip, p: &Problem, x: &[f64], solved: bool) -> Vec<Vec<Change>> {
    let open = |j: &usize| p.lower[*j] < p.upper[*j];
    let threshold = |j: &usize| mip.threshold[*j] > 0.0 && p.lower[*j] < mip.threshold[*j];
    // How undecided a column is: by its value, or, where that says nothing, by its bounds.
    let doubt = |j: &usize| match solved {
        true if threshold(j) && x[*j] < mip.threshold[*j] => x[*j].min(mip.threshold[*j] - x[*j]),
        true => (x[*j] - x[*j].round()).abs(),
        false => p.upper[*j] - p.lower[*j],
    };
    let discrete = |j: &usize| mip.integer[*j] || threshold(j);
    let all = (0..x.len()).filter(open).filter(discrete);
    let best = all.max_by(|a, b| doubt(a).total_cmp(&doubt(b)));
    if let Some(j) = best.filter(|j| doubt(j) > 1e-9) {
        if threshold(&j) && (x[j] < mip.threshold[j] || !mip.integer[j]) {
            let low = Change::new(j, 0.0, 0.0);
            let high = Change::new(j, mip.threshold[j], p.upper[j]);
            return vec![vec![low], vec![high]];
        }
        if mip.integer[j] {
            let at = x[j].max(p.lower[j]).min(p.upper[j] - 1.0).floor();
            let low = Change::new(j, p.lower[j], at);
            let high = Change::new(j, at + 1.0, p.upper[j]);
            return vec![vec![low], vec![high]];
        }
    }
    // Of the sets that bounds leave undecided the one that the point violates most.
    let undecided = mip.sets.iter().filter_map(|set| {
        let open = |j: &u32| p.lower[*j as usize] != 0.0 || p.upper[*j as usize] != 0.0;
        let first = set.columns.iter().position(open)?;
        let last = set.columns.iter().rposition(open)?;
        let weight = || {
            set.columns
                .iter()
                .map(|&j| x[j as usize].abs())
                .sum::<f64>()
        };
        let doubt = mip.spread(set, x).map_or(-1.0, |_| weight());
        (last - first > usize::from(set.neighbours)).then_some((doubt, set, first, last))
    });
    let worst = undecided.max_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((_, set, first, last)) = worst {
        let zero = |&j: &u32| Change::new(j as usize, 0.0, 0.0);
        let middle = (first + last) / 2;
        // Two neighbours share their middle: both parts keep it.
        let middle = middle.max(first + usize::from(set.neighbours));
        let (low, high) = match set.neighbours {
            true => (middle + 1, middle),
            false => (middle + 1, middle + 1),
        };
        return vec![
            set.columns[low..].iter().map(zero).collect(),
            set.columns[..high].iter().map(zero).collect(),
        ];
    }
    Vec::new()
}
