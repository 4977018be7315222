//! A complementarity problem (or a square system) without a solution: where it is stuck.
//!
//! At the point where the solver gave up, columns that are held at a bound leave; the rows of the
//! others are equations in them. They have a solution nearby unless their Jacobian is singular:
//! *structurally*, if some rows share too few columns whatever the numbers are (found by a maximum
//! matching and alternating paths from a row without partner; Dulmage & Mendelsohn 1958), or
//! *numerically*, found by a sparse LU. A pair is wrong-way if its row falls where its own variable
//! grows: pushing a variable off its bound then makes matters worse.

use super::point::{largest, no_value};
use super::{FEW, Finding};
use crate::autodiff::Evaluator;
use crate::model::instance::Instance;
use crate::solve::lp::form::Sparse;
use crate::solve::lp::simplex::factor::{Entries, Factor, Failure};
use crate::solve::pairing::match_rows;
use crate::solve::structure::deficient;

/// All findings about pairs at a point.
pub(super) fn findings(instance: &Instance, square: bool, x: &[f64]) -> Vec<Finding> {
    if let Some(f) = no_value(instance, x) {
        return vec![f];
    }
    let Ok(row_of) = match_rows(instance, square) else {
        return Vec::new();
    };
    let Ok((activity, slopes)) = Evaluator::first_order(instance).linearised(x) else {
        return Vec::new();
    };
    let n = instance.column_count();
    let mut out = Vec::new();
    let mut worst = Vec::new();
    // Columns whose row must hold as an equation.
    let mut open = Vec::new();
    for j in 0..n {
        let (mut l, mut u) = (instance.columns.lower[j], instance.columns.upper[j]);
        if square && l < u {
            (l, u) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        let row = row_of[j].map(|i| i as usize);
        let f = row.map_or(0.0, |i| activity[i] - instance.rows.rhs[i]);
        let mid = (x[j] - f).max(l).min(u);
        worst.push((row, j, (x[j] - mid).abs()));
        let held = (x[j] <= l && f >= 0.0) || (x[j] >= u && f <= 0.0);
        if let (Some(i), false) = (row, held || l == u) {
            open.push((i, j));
        }
    }
    let worst = largest(&worst, |w| if w.2 > 1e-9 { w.2 } else { 0.0 });
    if !worst.is_empty() {
        out.push(Finding::Pairs(worst));
    }
    // The Jacobian of the open pairs, by rows.
    let mut place = vec![usize::MAX; n];
    for (k, &(_, j)) in open.iter().enumerate() {
        place[j] = k;
    }
    let mut lines = Sparse::default();
    for &(i, _) in &open {
        let entries = slopes[i].iter().map(|&(j, v)| (place[j], v));
        lines.push(entries.filter(|e| e.0 != usize::MAX && e.1 != 0.0));
    }
    let all: Vec<usize> = (0..open.len()).collect();
    if let Some((rows, columns)) = deficient(&lines, &all, open.len(), |_| true) {
        out.push(Finding::Structural {
            rows: rows.iter().take(FEW).map(|&k| open[k].0).collect(),
            columns: columns.iter().take(FEW).map(|&k| open[k].1).collect(),
        });
    } else if !open.is_empty() {
        let mut by_column: Vec<Entries> = vec![Vec::new(); open.len()];
        for r in 0..open.len() {
            let top = lines.line(r).fold(0.0f64, |t, e| t.max(e.1.abs()));
            lines
                .line(r)
                .for_each(|(c, v)| by_column[c].push((r, v / top)));
        }
        if let Err(Failure::Dependent(list)) = Factor::new(open.len(), &by_column) {
            out.push(Finding::Singular {
                rows: list.iter().take(FEW).map(|&(_, r)| open[r].0).collect(),
                columns: list.iter().take(FEW).map(|&(s, _)| open[s].1).collect(),
            });
        }
    }
    let mut wrong = Vec::new();
    for (j, row) in row_of.iter().enumerate() {
        let Some(i) = row.map(|i| i as usize) else {
            continue;
        };
        let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
        let bounded = l.is_finite() || u.is_finite();
        let own = slopes[i].iter().find(|e| e.0 == j);
        if let (true, Some(&(_, slope))) = (bounded && l < u && !square, own)
            && slope < 0.0
        {
            wrong.push((i, j, slope));
        }
    }
    let wrong = largest(&wrong, |w| -w.2);
    if !wrong.is_empty() {
        out.push(Finding::WrongWay(wrong));
    }
    out
}
