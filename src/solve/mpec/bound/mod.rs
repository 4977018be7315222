//! Lower bounds of the global minimum, where everything but the pairs is linear.
//!
//! Every bound is that of a linear relaxation, and is proved for it in interval arithmetic
//! ([`crate::solve::lp::certify`]): multipliers that are shown to satisfy their own constraints exactly.
//! Nothing about the size of a column is assumed.
//!
//! * [`products`]: where the program comes apart into two [`sides`], products of their rows.

mod cone;
mod products;
mod sides;
pub(crate) mod weak;

use super::pairs::Program;
use super::settings::Bound;
use super::split::shifts;
use super::tree::{self, Lpcc, Prover};
use crate::solve::Budget;
use crate::solve::lp::form::Problem;
use crate::solve::lp::{Ended, certify, watch};
use products::Products;

/// A gap up to this, relative to the objective if that is above 1, is closed.
pub(crate) const GAP: f64 = 1e-6;

/// Whether a lower bound proves a value to be the global minimum.
pub(crate) fn is_closed(low: f64, value: f64) -> bool {
    value - low <= GAP * value.abs().max(1.0)
}

/// What was proved.
pub(crate) struct Proof {
    /// No feasible point has a (minimised) objective below this.
    pub value: Option<f64>,
    /// A point that satisfies all pairs and is better than the one that was given.
    pub better: Option<Vec<f64>>,
    /// What there is to say.
    pub note: Option<String>,
}

/// What products are tried by `quick`, and at all.
const PRODUCTS: [products::Limits; 2] = [
    products::Limits {
        products: 5_000,
        steps: 10_000,
    },
    products::Limits {
        products: 4_000_000,
        steps: usize::MAX,
    },
];

/// How much worse than the best known a solution may be that is thought of, relative to the objective if that is above 1.
const ROOM: f64 = 1e-2;

/// Nodes of the tree for `quick`.
const NODES: usize = 1_000;

/// A lower bound of the (minimised) objective; `level` is the best point known.
pub(crate) fn lower(program: &Program, level: &[f64], wanted: Bound, budget: &Budget) -> Proof {
    let seconds = match wanted {
        Bound::Seconds(s) => s,
        Bound::None | Bound::Quick => f64::INFINITY,
    };
    budget.within(seconds, u64::MAX, |budget| {
        prove(program, level, wanted, budget)
    })
}

fn prove(program: &Program, level: &[f64], wanted: Bound, budget: &Budget) -> Proof {
    let mut proof = Proof {
        value: None,
        better: None,
        note: None,
    };
    if !program.envelope.is_linear() {
        proof.note = Some("no lower bound: the model is not linear without its pairs".into());
        return proof;
    }
    let (limits, nodes) = match wanted {
        Bound::Seconds(_) => (PRODUCTS[1], usize::MAX),
        _ => (PRODUCTS[0], NODES),
    };
    let best = program.objective(level);
    let unit = best.abs().max(1.0);
    // The best point is to be well inside.
    let cutoff = best + GAP * unit;
    let mut products = Products { budget };
    let mut problem = Problem::of(&program.envelope);
    let low = products.bound(program, &mut problem, best + ROOM * unit, level, limits);
    if is_closed(low, best) {
        proof.value = Some(low);
        return proof;
    }
    let limits = tree::Limits {
        nodes,
        cutoff: best,
        enough: f64::NEG_INFINITY,
        gap: 0.5 * GAP * unit,
    };
    budget.spend(weak::derive(
        &mut problem,
        cutoff,
        level,
        &mut watch(budget, u64::MAX),
    ));
    let found = search(
        program,
        &problem,
        &limits,
        Some(&mut prove_node),
        &mut watch(budget, u64::MAX),
    );
    budget.log(format!(
        "branch and bound: {} nodes, bound {}",
        found.nodes, found.bound
    ));
    budget.spend(found.iterations);
    proof.better = found.best.map(|b| b.1);
    let low = low.max(found.bound);
    match low.is_finite() {
        true => proof.value = Some(low),
        false => proof.note = Some("no lower bound was proved".into()),
    }
    proof
}

/// What a search says that is content with any point.
pub(crate) enum Any {
    /// This one satisfies all pairs.
    Point(Vec<f64>),
    /// None does, proved.
    Empty,
    /// Neither was found.
    Unknown,
}

/// A point that satisfies all pairs, where the other methods find none; or a proof that there is none. Rows that are not
/// linear, and their pairs, are left out: such a point is a start, and none of the rest is none of all.
pub(crate) fn any(program: &Program, budget: &Budget) -> Any {
    if !program.envelope.is_linear() {
        let rest = program.linear_rows();
        return Program::new(&rest).map_or(Any::Unknown, |p| any(&p, budget));
    }
    let limits = tree::Limits {
        nodes: NODES,
        cutoff: f64::INFINITY,
        enough: f64::INFINITY,
        gap: 0.0,
    };
    let mut watch = watch(budget, u64::MAX);
    let problem = Problem::of(&program.envelope);
    let found = search(program, &problem, &limits, None, &mut watch);
    if let Some((_, level)) = found.best {
        return Any::Point(level);
    }
    let prover: Option<Prover> = Some(&mut prove_node);
    match found.complete && search(program, &problem, &limits, prover, &mut watch).is_empty() {
        true => Any::Empty,
        false => Any::Unknown,
    }
}

fn search(
    program: &Program,
    problem: &Problem,
    limits: &tree::Limits,
    prover: Option<Prover>,
    stop: &mut dyn FnMut(u64) -> Option<Ended>,
) -> tree::Found {
    let lpcc = Lpcc {
        problem,
        pairs: &program.pairs,
        rhs: &shifts(program),
    };
    lpcc.search(limits, prover, stop)
}

/// Multipliers this small beside the largest may be rounding. They price columns that have no bounds.
const NOISE: f64 = 1e-9;

/// What can be proved about a node: by its multipliers, by those that are not small, or else in rational arithmetic
/// if it is small.
pub(in crate::solve) fn prove_node(p: &Problem, y: &[f64], empty: bool) -> f64 {
    let none = f64::NEG_INFINITY;
    let by = |y: &[f64]| match empty {
        true if weak::is_empty(p, y) => f64::INFINITY,
        true => none,
        false => weak::bound(p, &p.cost, y) + p.offset,
    };
    let mut proved = by(y);
    if proved == none {
        let top = y.iter().fold(0.0f64, |t, v| t.max(v.abs()));
        let large = |&v: &f64| if v.abs() <= NOISE * top { 0.0 } else { v };
        proved = by(&y.iter().map(large).collect::<Vec<_>>());
    }
    if proved > none {
        return proved;
    }
    match empty {
        true if certify::exact_low(&weak::elastic(p)) > 0.0 => f64::INFINITY,
        true => none,
        false => certify::exact_low(p) + p.offset,
    }
}

#[cfg(test)]
mod tests;
