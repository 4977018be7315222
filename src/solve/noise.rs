//! Rounding errors in levels and marginals.

/// Rounding error of levels, relative to the largest.
pub(super) const LEVELS: f64 = 1e-14;
/// The same of multipliers, which come from a factorisation.
const MULTIPLIERS: f64 = 1e-13;

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(1.0, |s: f64, v| s.max(v.abs()))
}

/// The rounding error of all levels: that of the largest.
pub(super) fn rounding(x: &[f64]) -> Vec<f64> {
    vec![LEVELS * largest(x); x.len()]
}

/// The same where the rows are known, `row` the entries of one: what moves no row by more than the error of its terms.
pub(super) fn rounding_in_rows<R: Iterator<Item = (usize, f64)>>(
    x: &[f64],
    rows: usize,
    row: impl Fn(usize) -> R,
) -> Vec<f64> {
    let mut most = rounding(x);
    for i in 0..rows {
        let term = row(i).map(|(j, a)| (a * x[j]).abs());
        let error = LEVELS * term.fold(1.0, f64::max);
        row(i).for_each(|(j, a)| most[j] = most[j].min(error / a.abs()));
    }
    most
}

/// Puts levels on the bounds that they are at up to these errors.
pub(super) fn snap(x: &mut [f64], lower: &[f64], upper: &[f64], errors: &[f64]) {
    for ((v, error), (&l, &u)) in x.iter_mut().zip(errors).zip(lower.iter().zip(upper)) {
        for bound in [l, u] {
            if (*v - bound).abs() <= *error {
                *v = bound;
            }
        }
    }
}

/// Whether a multiplier is a rounding error beside the largest term of its dual row.
pub(super) fn is_rounding(value: f64, largest: f64) -> bool {
    value.abs() <= MULTIPLIERS * largest
}

/// Sets marginals to 0 that are rounding errors beside the terms of their dual rows: that of a column in its own, that of a
/// row in those of all its columns. `row`: the entries of a row of the Jacobian; `least`: what terms count for at least.
pub(super) fn clear<R: Iterator<Item = (usize, f64)>>(
    row: impl Fn(usize) -> R,
    least: f64,
    row_marginal: &mut [f64],
    column_marginal: &mut [f64],
) {
    let term = |d: &f64| d.abs().max(least);
    let mut terms: Vec<f64> = column_marginal.iter().map(term).collect();
    for (i, m) in row_marginal.iter().enumerate() {
        for (j, a) in row(i) {
            terms[j] = terms[j].max((a * m).abs());
        }
    }
    for (i, m) in row_marginal.iter_mut().enumerate() {
        if row(i).all(|(j, a)| is_rounding(a * *m, terms[j])) {
            *m = 0.0;
        }
    }
    for (d, &largest) in column_marginal.iter_mut().zip(&terms) {
        if is_rounding(*d, largest) {
            *d = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A penalty of 1e9 in one column leaves a price of 5e-5 alone that another column pays; what is 1e-16 of all terms goes.
    #[test]
    fn noise_is_judged_by_dual_rows() {
        let rows = [
            vec![(0, 1.0), (1, 1e9), (2, 5e-5)],
            vec![(1, 1.0)],
            vec![(2, 1.0)],
            vec![(1, 1.0), (2, 1e-9)],
        ];
        let row = |i: usize| rows[i].iter().copied();
        let (mut y, mut d) = ([1.0, -1e9, -5e-5, 1e-12], [1e-14, 1e-5, 3e-5]);
        clear(row, 5e-5, &mut y, &mut d);
        assert_eq!((y, d), ([1.0, -1e9, -5e-5, 0.0], [0.0, 0.0, 3e-5]));
    }
}
