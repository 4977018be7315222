//! Rows that contradict each other only because columns must be discrete.
//!
//! The deletion filter (Chinneck & Dravnieks 1991) with a search in place of a linear program: a row is dropped for good if
//! the rest is still without a solution, then the condition on a discrete column.

use super::driver::search_linear;
use super::model::Mip;
use super::relaxation::Control;
use super::tree::{Aim, End};
use crate::model::instance::Instance;
use crate::solve::Budget;
use crate::solve::lp::form::Form;

/// Seconds for all of it.
const MAX_SECONDS: f64 = 30.0;

/// Rows and discrete columns of the instance that, with all bounds, have no solution; and whether it was shown that none
/// can be spared.
#[derive(Clone, Debug, PartialEq)]
pub struct Conflict {
    /// Rows.
    pub rows: Vec<usize>,
    /// Columns that must be discrete.
    pub columns: Vec<usize>,
    /// None can be spared.
    pub shown: bool,
}

/// Finds one; None: the search says that there is a solution, or nothing in time.
pub fn conflict(instance: &Instance, budget: &Budget) -> Option<Conflict> {
    budget.within(MAX_SECONDS, u64::MAX, |budget| {
        budget.silently(|budget| find(instance, budget))
    })
}

fn find(instance: &Instance, budget: &Budget) -> Option<Conflict> {
    let form = Form::new(instance).ok()?;
    let mut mip = Mip::new(form.problem.clone(), instance, &form.columns, false);
    mip.problem.cost.fill(0.0);
    let mut control = Control::new(budget);
    let mut shown = true;
    // Whether there is no solution; not known counts as no.
    let mut empty = |mip: &Mip, control: &mut Control| {
        let aim = Aim {
            nodes: 2000,
            ..Aim::default()
        };
        let found = search_linear(mip, aim, None, control);
        let empty = found.x.is_none() && found.end == End::Complete && !found.incomplete;
        shown &= empty || found.x.is_some();
        empty
    };
    if !empty(&mip, &mut control) {
        return None;
    }
    let mut rows = Vec::new();
    for i in 0..mip.problem.m() {
        let sides = (mip.problem.row_lower[i], mip.problem.row_upper[i]);
        mip.problem.row_lower[i] = f64::NEG_INFINITY;
        mip.problem.row_upper[i] = f64::INFINITY;
        if !empty(&mip, &mut control) {
            (mip.problem.row_lower[i], mip.problem.row_upper[i]) = sides;
            rows.push(i);
        }
    }
    let mut columns = Vec::new();
    for j in 0..mip.problem.n() {
        let (integer, threshold) = (mip.integer[j], mip.threshold[j]);
        if !integer && threshold == 0.0 {
            continue;
        }
        (mip.integer[j], mip.threshold[j]) = (false, 0.0);
        let stands = mip.problem.columns.line(j).any(|(i, _)| rows.contains(&i));
        if stands && !empty(&mip, &mut control) {
            (mip.integer[j], mip.threshold[j]) = (integer, threshold);
            columns.push(form.columns[j] as usize);
        }
    }
    let sets = std::mem::take(&mut mip.sets);
    for set in sets {
        if !empty(&mip, &mut control) {
            columns.extend(
                set.columns
                    .iter()
                    .map(|&j| form.columns[j as usize] as usize),
            );
            mip.sets.push(set);
        }
    }
    Some(Conflict {
        rows: rows.into_iter().map(|i| form.rows[i] as usize).collect(),
        columns,
        shown,
    })
}
