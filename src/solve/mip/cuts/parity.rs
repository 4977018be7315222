//! Sums of rows with an odd right-hand side and few odd coefficients: halved and rounded they are cuts with the coefficients 0
//! and ½ (Caprara & Fischetti 1996). They are found by elimination modulo 2 (Koster, Zymolka & Kutschka 2009).

use super::{Separator, near_whole};
use crate::solve::lp::simplex::factor::Entries;
use crate::solve::mip::linear::Linear;
use std::collections::BTreeSet;

/// Rows looked at, and sums given, at most.
const ROWS: usize = 500;
const SUMS: usize = 200;

/// A column nearer to a bound than this does not count.
const AT_BOUND: f64 = 1e-6;

/// By how much a sum must be violated before it is halved.
const VIOLATION: f64 = 1e-2;

/// A sum of rows modulo 2, in columns counted from the nearest bound.
#[derive(Clone)]
struct Parity {
    /// The rows added.
    rows: BTreeSet<usize>,
    /// Columns with an odd coefficient that are not at a bound.
    columns: BTreeSet<usize>,
    /// Whether the right-hand side is odd.
    odd: bool,
    /// What its rows leave.
    slack: f64,
}

impl Parity {
    fn add(&mut self, other: &Self) {
        self.rows = &self.rows ^ &other.rows;
        self.columns = &self.columns ^ &other.columns;
        self.odd ^= other.odd;
        self.slack += other.slack;
    }

    /// An odd sum is at least 1.
    fn is_violated(&self, distance: &[f64]) -> bool {
        let sum: f64 = self.columns.iter().map(|j| distance[*j]).sum();
        self.odd && sum + self.slack < 1.0 - VIOLATION
    }
}

/// Weights of rows whose sum, halved and rounded, cuts a point off; `values`: of columns and rows.
pub(super) fn odd_sums(separator: &Separator, linear: &Linear, values: &[f64]) -> Vec<Entries> {
    let n = separator.n();
    let distance: Vec<f64> = (0..n)
        .map(|j| (values[j] - separator.lower[j]).min(separator.upper[j] - values[j]))
        .collect();
    let mut active: Vec<Parity> = (0..separator.step.len())
        .filter_map(|i| parity(separator, linear, i, values, &distance))
        .collect();
    active.sort_by(|a, b| a.slack.total_cmp(&b.slack));
    active.truncate(ROWS);
    let columns: BTreeSet<usize> = active.iter().flat_map(|p| &p.columns).copied().collect();
    let mut columns: Vec<usize> = columns.into_iter().collect();
    columns.sort_by(|a, b| distance[*b].total_cmp(&distance[*a]));
    let violated = active.iter().filter(|p| p.is_violated(&distance));
    let mut found: BTreeSet<BTreeSet<usize>> = violated.map(|p| p.rows.clone()).collect();
    for j in columns {
        // The row with the least slack takes the column out of the others.
        let Some(pivot) = active.iter().position(|p| p.columns.contains(&j)) else {
            continue;
        };
        let pivot = active.remove(pivot);
        for p in active.iter_mut().filter(|p| p.columns.contains(&j)) {
            p.add(&pivot);
            if p.is_violated(&distance) {
                found.insert(p.rows.clone());
            }
        }
        active.retain(|p| p.slack < 1.0);
        active.sort_by(|a, b| a.slack.total_cmp(&b.slack));
        if found.len() >= SUMS {
            break;
        }
    }
    let weights = |i: usize| (i, 1.0 / separator.step[i]);
    found
        .into_iter()
        .map(|rows| rows.into_iter().map(weights).collect())
        .collect()
}

/// A row of integers modulo 2, on the side that it is nearer to. None: it has others, or is far from both sides.
fn parity(
    separator: &Separator,
    linear: &Linear,
    i: usize,
    values: &[f64],
    distance: &[f64],
) -> Option<Parity> {
    let p = &linear.problem;
    let step = separator.step[i];
    if step == 0.0 {
        return None;
    }
    let activity = values[p.n() + i];
    let (below, above) = (activity - p.row_lower[i], p.row_upper[i] - activity);
    let (side, slack) = match below <= above {
        true => (p.row_lower[i], below),
        false => (p.row_upper[i], above),
    };
    let (side, slack) = (side / step, (slack / step).max(0.0));
    let is_odd = |x: f64| x.round().rem_euclid(2.0) == 1.0;
    let mut out = Parity {
        rows: BTreeSet::from([i]),
        columns: BTreeSet::new(),
        odd: is_odd(side),
        slack,
    };
    if slack >= 1.0 || !near_whole(side) {
        return None;
    }
    for (j, a) in p.rows.line(i).filter(|(_, a)| is_odd(a / step)) {
        let (lower, upper) = (separator.lower[j], separator.upper[j]);
        let bound = match values[j] - lower <= upper - values[j] {
            true => lower,
            false => upper,
        };
        debug_assert!(near_whole(a / step), "such is the step of a row");
        if bound.is_infinite() {
            return None;
        }
        out.odd ^= is_odd(bound);
        if distance[j] > AT_BOUND {
            out.columns.insert(j);
        }
    }
    Some(out)
}
