//! What can be seen at the point itself: coefficients far apart, violations, where the error of the
//! objective comes from, the direction in which nothing stops it.

use super::{FEW, Finding};
use crate::autodiff::Evaluator;
use crate::model::instance::Instance;
use crate::solve::answer::Answer;
use crate::solve::certificate;

/// Coefficients further apart than this are worth a word.
const WIDE: f64 = 1e8;

/// The largest few by `size`, those of size 0 never.
pub(super) fn largest<T: Clone>(items: &[T], size: impl Fn(&T) -> f64) -> Vec<T> {
    let mut order: Vec<&T> = items.iter().filter(|t| size(t) > 0.0).collect();
    // Stable: equal ones stay in the model's order.
    order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    order.into_iter().take(FEW).cloned().collect()
}

/// The direction's components: the objective's, then the largest.
pub(super) fn ray(instance: &Instance, ray: &[f64]) -> Option<Finding> {
    let objective = instance.objective?.column as usize;
    let others = || ray.iter().enumerate().filter(|e| e.0 != objective);
    let top = others().fold(0.0f64, |t, e| t.max(e.1.abs()));
    let top = if top > 0.0 {
        top
    } else {
        ray.get(objective)?.abs()
    };
    let all: Vec<(usize, f64)> = others()
        .filter(|(_, v)| v.abs() > 1e-9 * top)
        .map(|(j, v)| (j, v / top))
        .collect();
    let mut parts = vec![(objective, ray.get(objective)? / top)];
    parts.extend(largest(&all, |p| p.1.abs()));
    Some(Finding::Ray(parts))
}

/// Coefficients (derivatives, at the point) that are more than [`WIDE`] apart.
pub(super) fn scaling(instance: &Instance, x: &[f64]) -> Option<Finding> {
    let slopes = Evaluator::first_order(instance).jacobian_rows(x).ok()?;
    let (m, n) = (instance.row_count(), instance.column_count());
    let mut rows = vec![(f64::INFINITY, 0.0f64); m];
    let mut columns = vec![(f64::INFINITY, 0.0f64); n];
    let mut high = (0, 0, 0.0f64);
    let mut low = (0, 0, f64::INFINITY);
    for (i, row) in slopes.into_iter().enumerate() {
        for (j, v) in row {
            let a = v.abs();
            if a == 0.0 || !a.is_finite() {
                continue;
            }
            for range in [&mut rows[i], &mut columns[j]] {
                *range = (range.0.min(a), range.1.max(a));
            }
            if a > high.2.abs() {
                high = (i, j, v);
            }
            if a < low.2.abs() {
                low = (i, j, v);
            }
        }
    }
    if high.2 == 0.0 || high.2.abs() / low.2.abs() < WIDE {
        return None;
    }
    let wide = |ranges: &[(f64, f64)]| {
        let all: Vec<(usize, f64, f64)> = ranges
            .iter()
            .enumerate()
            .filter(|(_, r)| r.1 > 0.0 && r.1 / r.0 >= 1e4)
            .map(|(i, r)| (i, r.0, r.1))
            .collect();
        largest(&all, |r| r.2 / r.1)
    };
    Some(Finding::Scaling {
        largest: high,
        smallest: low,
        rows: wide(&rows),
        columns: wide(&columns),
    })
}

/// The rows and columns that are violated most.
pub(super) fn violated(instance: &Instance, answer: &Answer) -> Option<Finding> {
    let rows: Vec<(usize, f64)> = (0..instance.row_count())
        .map(|i| {
            let a = answer.activity[i];
            let v = certificate::row_violation(instance.rows.relation[i], a, instance.rows.rhs[i]);
            (i, if v.is_nan() { f64::INFINITY } else { v })
        })
        .collect();
    let columns: Vec<(usize, f64)> = answer
        .outcome
        .level
        .iter()
        .enumerate()
        .map(|(j, &x)| {
            let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
            (j, (l - x).max(x - u).max(0.0))
        })
        .collect();
    let noise = |v: &(usize, f64)| if v.1 > 1e-9 { v.1 } else { 0.0 };
    let (rows, columns) = (largest(&rows, noise), largest(&columns, noise));
    (!rows.is_empty() || !columns.is_empty()).then_some(Finding::Violated { rows, columns })
}

/// Which rows and columns carry the error of the objective: a residual counts as much as its
/// multiplier says.
pub(super) fn inaccurate(instance: &Instance, answer: &Answer) -> Option<Finding> {
    let outcome = &answer.outcome;
    let at = certificate::linearise(instance, outcome);
    let rows: Vec<(usize, f64, f64)> = (0..instance.row_count())
        .map(|i| {
            let rest = at.activity[i] - instance.rows.rhs[i];
            let m = outcome.row_marginal[i];
            (i, rest, if m == 0.0 { 0.0 } else { (m * rest).abs() })
        })
        .collect();
    let columns: Vec<(usize, f64, f64)> = (0..instance.column_count())
        .map(|j| {
            let r = at.reduced[j];
            let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
            let x = outcome.level[j];
            let away = (x - l).abs().min((u - x).abs());
            let away = if away.is_finite() {
                away
            } else {
                x.abs().max(1.0)
            };
            (j, r, if r == 0.0 { 0.0 } else { (r * away).abs() })
        })
        .collect();
    let (rows, columns) = (largest(&rows, |r| r.2), largest(&columns, |c| c.2));
    (!rows.is_empty() || !columns.is_empty()).then_some(Finding::Inaccurate { rows, columns })
}

/// Whether some function has no value or derivative at the point.
pub(super) fn no_value(instance: &Instance, x: &[f64]) -> Option<Finding> {
    let failure = Evaluator::first_order(instance).linearised(x).err()?;
    Some(Finding::NoValue {
        row: failure.row as usize,
        column: failure.column.map(|c| c as usize),
        what: failure.to_string(),
    })
}
