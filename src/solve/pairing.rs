//! Which row goes with which column: the rules of matching for complementarity models and square systems.
//!
//! Each column has one row: its partner. Equality rows without a partner are given, in order, to
//! the free columns without one (any order gives the same solutions); a fixed column needs no row.

use super::SolveError;
use crate::model::instance::{Instance, Relation};

pub(super) fn refuse<T>(
    message: impl Into<String>,
    row: Option<usize>,
    column: Option<usize>,
) -> Result<T, SolveError> {
    Err(SolveError::at(row, column, message))
}

/// A pair whose row's relation contradicts the bounds of its column.
pub(super) fn refuse_relation(
    relation: Relation,
    lower: f64,
    upper: f64,
    row: usize,
    column: usize,
) -> Result<(), SolveError> {
    let (below, above) = (lower > f64::NEG_INFINITY, upper < f64::INFINITY);
    let what = match relation {
        Relation::Greater if above && !below => {
            "a =g= row may not be paired with a variable that has an upper bound only: at that bound \
             the left side is at most the right one; write the row as =l=, or give the variable a lower bound"
        }
        Relation::Less if below && !above => {
            "a =l= row may not be paired with a variable that has a lower bound only: at that bound \
             the left side is at least the right one; write the row as =g=, or give the variable an upper bound"
        }
        _ => return Ok(()),
    };
    refuse(what, Some(row), Some(column))
}

/// Gives every column its row. `square`: a cns, where bounds do not count.
#[allow(clippy::needless_range_loop)] // rows, bounds and partners side by side
pub fn match_rows(instance: &Instance, square: bool) -> Result<Vec<Option<u32>>, SolveError> {
    let n = instance.column_count();
    let mut row_of: Vec<Option<u32>> = match &instance.matched {
        Some(m) if !square => m.clone(),
        _ => vec![None; n],
    };
    let mut taken = vec![false; instance.row_count()];
    for r in row_of.iter().flatten() {
        taken[*r as usize] = true;
    }
    let columns = &instance.columns;
    let mut free = Vec::new();
    for j in 0..n {
        let (l, u) = (columns.lower[j], columns.upper[j]);
        match row_of[j] {
            Some(i) => refuse_relation(instance.rows.relation[i as usize], l, u, i as usize, j)?,
            None if l == u => {}
            None if square || (l == f64::NEG_INFINITY && u == f64::INFINITY) => free.push(j),
            None => {
                return refuse(
                    "a variable without a row must be free or fixed: pair it with an equation \
                     (`equation.variable` in the model statement), or fix it",
                    None,
                    Some(j),
                );
            }
        }
    }
    let mut left: Vec<usize> = (0..instance.row_count()).filter(|&i| !taken[i]).collect();
    for &i in &left {
        if instance.rows.relation[i] != Relation::Equal {
            let what = if square {
                "a square system has equations (=e=) only"
            } else {
                "an inequality without a variable: only equations (=e=) may go without a partner"
            };
            return refuse(what, Some(i), None);
        }
    }
    if left.len() != free.len() {
        let what = if square {
            "the system is not square"
        } else {
            "the counts do not match"
        };
        let (r, c) = (left.len(), free.len());
        let (row, column) = (left.get(c).copied(), free.get(r).copied());
        let which = if square { "" } else { "unmatched " };
        return refuse(
            format!("{what}: {r} {which}equations, {c} {which}variables that are not fixed"),
            row,
            column,
        );
    }
    left.reverse();
    for j in free {
        row_of[j] = left.pop().map(|i| i as u32);
    }
    Ok(row_of)
}
