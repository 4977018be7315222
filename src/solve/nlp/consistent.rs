//! A start that agrees with the definitions in the model.
//!
//! Many models name intermediate quantities: `flow =e= rate·area`, with start levels for the main
//! variables only. An equation in which a variable without a start level (its level is 0, put into its
//! bounds) occurs linearly, and in which it is the only such variable, gives it a value; that may
//! make the next one known. Equations are used in waves, each evaluated once.

use super::problem::Problem;
use crate::autodiff::Evaluator;
use crate::model::instance::{Instance, Relation};

/// Waves at most: chains of definitions are short.
const WAVES: usize = 50;

/// The start point with defined variables computed; None if nothing changed.
pub fn consistent_start(
    instance: &Instance,
    problem: &Problem,
    evaluator: &mut Evaluator,
    start: &[f64],
) -> Option<Vec<f64>> {
    let n = instance.column_count();
    let columns = &instance.columns;
    let mut level: Vec<f64> = (0..n)
        .map(|j| columns.level[j].max(columns.lower[j]).min(columns.upper[j]))
        .collect();
    for (&j, &x) in problem.columns.iter().zip(start) {
        level[j as usize] = x;
    }
    // columns in nonlinear terms, row by row
    let mut nonlinear: Vec<Vec<u32>> = vec![Vec::new(); instance.row_count()];
    for t in &instance.nonlinear {
        let v = t.kernel.variables as usize;
        for (k, &i) in t.row.iter().enumerate() {
            nonlinear[i as usize].extend_from_slice(&t.columns[k * v..(k + 1) * v]);
        }
    }
    let unset = |j: usize| columns.level[j] == 0.0 && columns.lower[j] != columns.upper[j];
    // a variable is open if some equation could define it
    let mut open = vec![false; n];
    let mut candidates = Vec::new();
    for (i, nonlinear) in nonlinear.iter_mut().enumerate() {
        if instance.rows.relation[i] != Relation::Equal {
            continue;
        }
        nonlinear.sort_unstable();
        let mut any = false;
        for (j, _) in instance.matrix.row(i) {
            if unset(j) && nonlinear.binary_search(&(j as u32)).is_err() {
                open[j] = true;
                any = true;
            }
        }
        if any {
            candidates.push(i);
        }
    }
    let mut activity = vec![0.0; instance.row_count()];
    let mut changed = false;
    for _ in 0..WAVES {
        if evaluator.rows(&level, &mut activity).is_err() {
            break;
        }
        let mut found: Vec<(usize, f64)> = Vec::new();
        candidates.retain(|&i| {
            let linear = instance.matrix.row(i).map(|(j, _)| j);
            let all = linear.chain(nonlinear[i].iter().map(|&j| j as usize));
            let mut unknown: Vec<usize> = all.filter(|&j| open[j]).collect();
            unknown.sort_unstable();
            unknown.dedup();
            let [j] = unknown[..] else {
                return !unknown.is_empty();
            };
            if nonlinear[i].binary_search(&(j as u32)).is_err()
                && let Some((_, a)) = instance.matrix.row(i).find(|&(k, _)| k == j)
            {
                let v = level[j] + (instance.rows.rhs[i] - activity[i]) / a;
                found.push((j, v));
            }
            false
        });
        if found.is_empty() {
            break;
        }
        for (j, v) in found {
            let v = v.max(columns.lower[j]).min(columns.upper[j]);
            if open[j] && v.is_finite() && v.abs() < 1e10 {
                changed |= v != level[j];
                level[j] = v;
            }
            open[j] = false;
        }
    }
    changed.then(|| problem.columns.iter().map(|&j| level[j as usize]).collect())
}
