//! Presolve: fixed variables go, and rows that only bound a variable become bounds.
//!
//! A pair (row i, variable xᵢ) whose row is a·xⱼ + b with a constant a, and whose variable, with
//! lᵢ finite and uᵢ infinite, appears in row j alone, with a constant entry c, a·c < 0, is the
//! multiplier of the bound a·xⱼ + b ≥ 0 in row j. The bound is laid on xⱼ and the pair dropped;
//! afterwards xᵢ = lᵢ − Fⱼ/c if that bound is active, else lᵢ.
//!
//! Without this, bounds written as constraints hide the structure from the crash and make the
//! path pivot through them one by one.

use super::run::bound;
use super::{EvalError, Problem};

/// A dropped pair.
struct Dropped {
    /// The pair.
    i: usize,
    /// The variable it bounds.
    j: usize,
    /// Entry of xᵢ in row j.
    c: f64,
    /// The bound it implies on xⱼ.
    value: f64,
    /// Whether it is an upper bound.
    upper: bool,
}

/// The reduced problem.
pub(super) struct Reduced<'a> {
    inner: &'a mut dyn Problem,
    /// Index of each kept variable in the inner problem.
    pub(super) kept: Vec<usize>,
    dropped: Vec<Dropped>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    start: Vec<f64>,
    col_start: Vec<usize>,
    rows: Vec<usize>,
    /// Position in the inner pattern of each kept entry.
    entry: Vec<usize>,
    /// A full point whose fixed and dropped variables have their values.
    x: Vec<f64>,
    f: Vec<f64>,
    values: Vec<f64>,
}

impl<'a> Reduced<'a> {
    /// Analyses the problem. Bounds must not cross. With `simplify` false only fixed variables go.
    pub(super) fn new(inner: &'a mut dyn Problem, simplify: bool) -> Self {
        let n = inner.n();
        let mut lower: Vec<f64> = inner.lower().iter().map(|&b| bound(b)).collect();
        let mut upper: Vec<f64> = inner.upper().iter().map(|&b| bound(b)).collect();
        let mut x: Vec<f64> = (0..n)
            .map(|i| inner.start()[i].max(lower[i]).min(upper[i]))
            .collect();
        let mut keep: Vec<bool> = (0..n).map(|i| lower[i] != upper[i]).collect();
        let dropped = match simplify {
            true => bound_rows(inner, &keep, &mut lower, &mut upper, &mut x),
            false => Vec::new(),
        };
        for d in &dropped {
            keep[d.i] = false;
        }
        let kept: Vec<usize> = (0..n).filter(|&i| keep[i]).collect();
        let mut position = vec![usize::MAX; n];
        kept.iter().enumerate().for_each(|(k, &i)| position[i] = k);
        let (col_start, rows, entry) = {
            let (start, index) = inner.pattern();
            let (mut col_start, mut rows, mut entry) = (vec![0], Vec::new(), Vec::new());
            for &j in &kept {
                for k in start[j]..start[j + 1] {
                    if keep[index[k]] {
                        rows.push(position[index[k]]);
                        entry.push(k);
                    }
                }
                col_start.push(rows.len());
            }
            (col_start, rows, entry)
        };
        let nonzeros = inner.pattern().1.len();
        Reduced {
            inner,
            lower: kept.iter().map(|&i| lower[i]).collect(),
            upper: kept.iter().map(|&i| upper[i]).collect(),
            start: kept
                .iter()
                .map(|&i| x[i].max(lower[i]).min(upper[i]))
                .collect(),
            kept,
            dropped,
            col_start,
            rows,
            entry,
            x,
            f: vec![0.0; n],
            values: vec![0.0; nonzeros],
        }
    }

    /// Variables of the problem as given.
    pub(super) fn total(&self) -> usize {
        self.x.len()
    }

    /// Nonzeros of the problem as given.
    pub(super) fn total_nonzeros(&self) -> usize {
        self.values.len()
    }

    /// Pairs turned into bounds.
    pub(super) fn dropped(&self) -> usize {
        self.dropped.len()
    }

    fn scatter(&mut self, x: &[f64]) {
        self.kept.iter().zip(x).for_each(|(&i, &v)| self.x[i] = v);
    }

    /// The point of the inner problem that belongs to a point of the reduced one.
    pub(super) fn postsolve(&mut self, x: &[f64]) -> Vec<f64> {
        self.scatter(x);
        let mut full = self.x.clone();
        if !self.dropped.is_empty() && self.inner.function(&self.x, &mut self.f).is_ok() {
            let mut taken = vec![false; full.len()];
            for d in &self.dropped {
                // Fⱼ pushes against this bound: its multiplier carries it.
                let push = -self.f[d.j] / d.c;
                let active = if d.upper {
                    full[d.j] >= d.value
                } else {
                    full[d.j] <= d.value
                };
                if active && push > 0.0 && !taken[d.j] {
                    taken[d.j] = true;
                    full[d.i] += push;
                }
            }
        }
        full
    }
}

/// Finds the pairs that only bound a variable and tightens the bounds.
fn bound_rows(
    inner: &mut dyn Problem,
    stays: &[bool],
    lower: &mut [f64],
    upper: &mut [f64],
    x: &mut [f64],
) -> Vec<Dropped> {
    let n = inner.n();
    // Entries that count: fixed variables are constants.
    let mut row_count = vec![0usize; n];
    let mut row_entry = vec![(usize::MAX, usize::MAX); n];
    let mut column_entry = vec![None; n];
    {
        let (start, index) = inner.pattern();
        for j in (0..n).filter(|&j| stays[j]) {
            let mut entries = (start[j]..start[j + 1]).filter(|&k| stays[index[k]]);
            if let (Some(k), None) = (entries.next(), entries.next()) {
                column_entry[j] = Some((index[k], k));
            }
            for k in start[j]..start[j + 1] {
                row_count[index[k]] += 1;
                row_entry[index[k]] = (j, k);
            }
        }
    }
    let candidates: Vec<(usize, usize, usize, usize)> = (0..n)
        .filter(|&i| {
            stays[i] && row_count[i] == 1 && lower[i].is_finite() && upper[i] == f64::INFINITY
        })
        .filter_map(|i| {
            let (j, a) = row_entry[i];
            let (row, c) = column_entry[i]?;
            (row == j && j != i && inner.is_constant(a) && inner.is_constant(c))
                .then_some((i, j, a, c))
        })
        .collect();
    if candidates.is_empty() {
        return Vec::new();
    }
    let (mut f, mut values) = (vec![0.0; n], vec![0.0; inner.pattern().1.len()]);
    if inner.function(x, &mut f).is_err() || inner.jacobian(x, &mut values).is_err() {
        return Vec::new();
    }
    let mut dropped = Vec::new();
    let mut taken = vec![false; n];
    let mut bounded = vec![false; n];
    for (i, j, a, c) in candidates {
        let (a, c) = (values[a], values[c]);
        if taken[j] || bounded[i] || a * c >= 0.0 || (a * c).is_nan() || !f[i].is_finite() {
            continue;
        }
        // a·t + b ≥ 0 with b = Fᵢ − a·xⱼ.
        let value = x[j] - f[i] / a;
        let is_upper = a < 0.0;
        let (l, u) = if is_upper {
            (lower[j], upper[j].min(value))
        } else {
            (lower[j].max(value), upper[j])
        };
        if !(value.is_finite() && l < u) {
            continue;
        }
        (lower[j], upper[j]) = (l, u);
        (taken[i], bounded[j]) = (true, true);
        x[i] = lower[i];
        dropped.push(Dropped {
            i,
            j,
            c,
            value,
            upper: is_upper,
        });
    }
    dropped
}

impl Problem for Reduced<'_> {
    fn n(&self) -> usize {
        self.kept.len()
    }
    fn lower(&self) -> &[f64] {
        &self.lower
    }
    fn upper(&self) -> &[f64] {
        &self.upper
    }
    fn start(&self) -> &[f64] {
        &self.start
    }
    fn pattern(&self) -> (&[usize], &[usize]) {
        (&self.col_start, &self.rows)
    }
    fn function(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        self.scatter(x);
        self.inner.function(&self.x, &mut self.f)?;
        f.iter_mut()
            .zip(&self.kept)
            .for_each(|(f, &i)| *f = self.f[i]);
        Ok(())
    }
    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), EvalError> {
        self.scatter(x);
        self.inner.jacobian(&self.x, &mut self.values)?;
        values
            .iter_mut()
            .zip(&self.entry)
            .for_each(|(v, &k)| *v = self.values[k]);
        Ok(())
    }
    fn is_linear(&self) -> bool {
        self.inner.is_linear()
    }
}
