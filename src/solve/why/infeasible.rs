//! An irreducible set of rows and bounds that contradict each other.
//!
//! A proof of infeasibility names multipliers (Farkas); the rows and bounds with a multiplier are
//! already infeasible. The deletion filter (Chinneck & Dravnieks 1991) then drops one member at a
//! time: if the rest is still infeasible it is dropped for good (and with it what the new proof
//! does not use), otherwise it is needed. Since what is left only shrinks, a member that was needed
//! once is needed in the end: with any one dropped, the rest can be satisfied.

use std::collections::BTreeSet;

use super::Finding;
use crate::model::instance::Instance;
use crate::solve::Budget;
use crate::solve::lp::form::{Form, Problem};
use crate::solve::lp::scale::Scaling;
use crate::solve::lp::simplex::Simplex;
use crate::solve::lp::{Ended, watch};

/// A member of the set.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Member {
    /// A row.
    Row(usize),
    /// A column's lower bound.
    Lower(usize),
    /// A column's upper bound.
    Upper(usize),
}

/// Seconds for the search.
const MAX_SECONDS: f64 = 60.0;

/// What a set of members is when it is asked.
enum Tested {
    /// Infeasible: the members with a multiplier.
    Infeasible(Vec<(Member, f64)>, f64),
    Feasible,
    Unknown,
}

/// Finds one such set, from a proof's multipliers for the instance's rows (or from none). None: no
/// contradiction was found.
pub fn irreducible(instance: &Instance, ray: &[f64], budget: &Budget) -> Option<Finding> {
    budget.within(MAX_SECONDS, u64::MAX, |budget| {
        members(instance, ray, budget)
    })
}

fn members(instance: &Instance, ray: &[f64], budget: &Budget) -> Option<Finding> {
    let form = Form::new(instance).ok()?;
    let scaling = Scaling::new(&form.problem);
    let p = scaling.apply(&form.problem);
    let mut set: BTreeSet<Member> = BTreeSet::new();
    if ray.len() == instance.row_count() {
        let y: Vec<f64> = form
            .rows
            .iter()
            .zip(&scaling.row)
            .map(|(&i, r)| ray[i as usize] / r)
            .collect();
        set.extend(support(&p, &y).0.iter().map(|m| m.0));
    }
    let all = || -> BTreeSet<Member> {
        let rows = (0..p.m()).map(Member::Row);
        let lower = (0..p.n()).filter(|&j| p.lower[j].is_finite());
        let upper = (0..p.n()).filter(|&j| p.upper[j].is_finite());
        rows.chain(lower.map(Member::Lower))
            .chain(upper.map(Member::Upper))
            .collect()
    };
    // A proof that holds up to rounding may miss a member: then everything is looked at.
    let mut tested = Tested::Unknown;
    if !set.is_empty() {
        tested = test(&p, &set, budget);
    }
    if !matches!(tested, Tested::Infeasible(..)) {
        set = all();
        tested = test(&p, &set, budget);
    }
    let Tested::Infeasible(mut members, mut excess) = tested else {
        return None;
    };
    set = members.iter().map(|m| m.0).collect();
    let mut shown = true;
    let mut needed: BTreeSet<Member> = BTreeSet::new();
    while let Some(&member) = set.iter().find(|m| !needed.contains(m)) {
        let mut rest = set.clone();
        rest.remove(&member);
        match test(&p, &rest, budget) {
            Tested::Infeasible(fewer, by) => {
                set = fewer.iter().map(|m| m.0).collect();
                // What was needed before is needed still; a proof has it.
                shown &= needed.is_subset(&set);
                needed.retain(|m| set.contains(m));
                (members, excess) = (fewer, by);
            }
            Tested::Feasible => {
                needed.insert(member);
            }
            Tested::Unknown => {
                shown = false;
                needed.insert(member);
            }
        }
    }
    // In the instance's units and numbers, the largest multiplier 1.
    let in_units = |m: Member, v: f64| match m {
        Member::Row(i) => (Member::Row(form.rows[i] as usize), v * scaling.row[i]),
        Member::Lower(j) => (
            Member::Lower(form.columns[j] as usize),
            v / scaling.column[j],
        ),
        Member::Upper(j) => (
            Member::Upper(form.columns[j] as usize),
            v / scaling.column[j],
        ),
    };
    let mut members: Vec<(Member, f64)> = members.iter().map(|&(m, v)| in_units(m, v)).collect();
    let top = members.iter().fold(0.0f64, |t, m| t.max(m.1.abs()));
    members.iter_mut().for_each(|m| m.1 /= top);
    members.sort_by_key(|m| m.0);
    Some(Finding::Irreducible {
        members,
        excess: excess * scaling.size / top,
        shown,
    })
}

/// The members that a proof uses with their multipliers, and by how much it misses.
fn support(p: &Problem, y: &[f64]) -> (Vec<(Member, f64)>, f64) {
    let top = y.iter().fold(0.0f64, |t, v| t.max(v.abs()));
    let mut members = Vec::new();
    let mut excess = 0.0;
    for (i, &v) in y.iter().enumerate() {
        if v.abs() > 1e-9 * top {
            members.push((Member::Row(i), v));
            excess += v * p.priced_side(i, v);
        }
    }
    for j in 0..p.n() {
        let terms = p.columns.line(j).map(|(i, a)| a * y[i]);
        let (reach, size) = terms.fold((0.0, 0.0f64), |(r, s), t| (r + t, s.max(t.abs())));
        if reach.abs() > 1e-9 * size {
            let (member, bound) = if reach > 0.0 {
                (Member::Upper(j), p.upper[j])
            } else {
                (Member::Lower(j), p.lower[j])
            };
            members.push((member, -reach));
            excess -= reach * bound;
        }
    }
    (members, excess)
}

/// Whether the members alone can be satisfied.
fn test(p: &Problem, set: &BTreeSet<Member>, budget: &Budget) -> Tested {
    if budget.is_over() {
        return Tested::Unknown;
    }
    // Only what the members touch.
    let rows: Vec<usize> = set
        .iter()
        .filter_map(|m| match *m {
            Member::Row(i) => Some(i),
            _ => None,
        })
        .collect();
    let bounded = set.iter().filter_map(|m| match *m {
        Member::Lower(j) | Member::Upper(j) => Some(j),
        Member::Row(_) => None,
    });
    let of_rows = rows.iter().flat_map(|&i| p.rows.line(i).map(|e| e.0));
    let mut known = vec![false; p.n()];
    let mut columns: Vec<usize> = of_rows.chain(bounded).collect();
    columns.retain(|&j| !std::mem::replace(&mut known[j], true));
    let mut sub = p.part(&columns, &rows, &p.lower);
    sub.cost.fill(0.0);
    for (k, &j) in columns.iter().enumerate() {
        if !set.contains(&Member::Lower(j)) {
            sub.lower[k] = f64::NEG_INFINITY;
        }
        if !set.contains(&Member::Upper(j)) {
            sub.upper[k] = f64::INFINITY;
        }
    }
    let mut simplex = Simplex::new(&sub);
    let most = 5000 + 50 * (sub.m() + sub.n()) as u64;
    let ended = simplex.solve(&mut watch(budget, most));
    match ended {
        Ended::Solved => Tested::Feasible,
        Ended::Infeasible(y) => {
            let (members, excess) = support(&sub, &y);
            let back = |m: Member| match m {
                Member::Row(i) => Member::Row(rows[i]),
                Member::Lower(j) => Member::Lower(columns[j]),
                Member::Upper(j) => Member::Upper(columns[j]),
            };
            Tested::Infeasible(
                members.into_iter().map(|(m, v)| (back(m), v)).collect(),
                excess,
            )
        }
        _ => Tested::Unknown,
    }
}
