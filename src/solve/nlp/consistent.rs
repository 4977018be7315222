//! A start that agrees with the definitions in the model.
//!
//! Many models name intermediate quantities: `flow =e= rate·area`, with start levels for the main
//! variables only. An equation in which one variable has no start level (its level is 0, put into its
//! bounds) gives it a value, by Newton's method in this variable; that may make the next one known. Equations are used
//! in waves, each evaluated once.

use super::problem::Problem;
use crate::autodiff::Evaluator;
use crate::model::instance::{Instance, Relation};

/// Waves at most: chains of definitions are short.
const WAVES: usize = 100;
/// Newton steps for one variable: one is enough where it occurs linearly.
const STEPS: u32 = 3;
/// An equation holds, relative to its right-hand side.
const HOLDS: f64 = 1e-10;
/// A slope or a value beyond these defines nothing.
const FLATTEST: f64 = 1e-8;
const FARTHEST: f64 = 1e10;

/// The start point with defined variables computed; None if nothing changed.
pub fn consistent_start(
    instance: &Instance,
    problem: &Problem,
    evaluator: &mut Evaluator,
    start: &[f64],
) -> Option<Vec<f64>> {
    let (n, m) = (instance.column_count(), instance.row_count());
    let columns = &instance.columns;
    let mut level: Vec<f64> = (0..n)
        .map(|j| columns.level[j].max(columns.lower[j]).min(columns.upper[j]))
        .collect();
    for (&j, &x) in problem.columns.iter().zip(start) {
        level[j as usize] = x;
    }
    let (first, column) = evaluator.jacobian_pattern();
    let (first, column) = (first.to_vec(), column.to_vec());
    let entries = |i: usize| (first[i]..first[i + 1]).map(|k| (k, column[k] as usize));
    let unset = |j: usize| columns.level[j] == 0.0 && columns.lower[j] != columns.upper[j];
    let mut open = vec![false; n];
    let is_equation = |&i: &usize| instance.rows.relation[i] == Relation::Equal;
    let mut candidates: Vec<usize> = (0..m).filter(is_equation).collect();
    candidates.retain(|&i| {
        let mut any = false;
        for (_, j) in entries(i).filter(|e| unset(e.1)) {
            open[j] = true;
            any = true;
        }
        any
    });
    let (mut activity, mut slope) = (vec![0.0; m], vec![0.0; column.len()]);
    let mut steps = vec![0; n];
    let mut changed = false;
    for _ in 0..WAVES {
        if evaluator.rows(&level, &mut activity).is_err()
            || evaluator.jacobian(&level, &mut slope).is_err()
        {
            break;
        }
        // column, and the value that its equation gives it, if it is not what it has
        let mut found: Vec<(usize, Option<f64>)> = Vec::new();
        candidates.retain(|&i| {
            let mut unknown = entries(i).filter(|e| open[e.1]);
            let (Some((k, j)), None) = (unknown.next(), unknown.next()) else {
                return entries(i).any(|e| open[e.1]);
            };
            let rest = instance.rows.rhs[i] - activity[i];
            if rest.abs() <= HOLDS * instance.rows.rhs[i].abs().max(1.0) || steps[j] == STEPS {
                found.push((j, None));
                return false;
            }
            if slope[k].abs() < FLATTEST {
                return false;
            }
            steps[j] += 1;
            found.push((j, Some(level[j] + rest / slope[k])));
            true
        });
        if found.is_empty() {
            break;
        }
        for (j, value) in found {
            let value = value.map(|v| v.max(columns.lower[j]).min(columns.upper[j]));
            match value.filter(|v| v.is_finite() && v.abs() < FARTHEST && *v != level[j]) {
                Some(v) if open[j] => {
                    changed = true;
                    level[j] = v;
                }
                _ => open[j] = false,
            }
        }
    }
    changed.then(|| problem.columns.iter().map(|&j| level[j as usize]).collect())
}
