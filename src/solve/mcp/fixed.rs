//! Fixed variables leave the problem, and rows of free variables get a sign.
//!
//! Where a variable is free its row is an equation, and F and −F mean the same. Proximal terms, and whatever else is
//! good for monotone problems, ask for one of the two: conditions of optimality whose equations are written
//! "demand − supply" have a saddle there that "supply − demand" has not.

use super::run::bound;
use super::{EvalError, Problem};

/// Sweeps over the rows at most, each of which may turn for the sake of others.
const SIGN_SWEEPS: usize = 10;

/// The reduced problem.
pub(super) struct Reduced<'a> {
    inner: &'a mut dyn Problem,
    /// Index of each kept variable in the inner problem.
    pub(super) kept: Vec<usize>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    start: Vec<f64>,
    col_start: Vec<usize>,
    rows: Vec<usize>,
    /// Position in the inner pattern of each kept entry.
    entry: Vec<usize>,
    /// The sign of each row.
    sign: Vec<f64>,
    /// A full point whose fixed variables have their values.
    x: Vec<f64>,
    f: Vec<f64>,
    values: Vec<f64>,
}

impl<'a> Reduced<'a> {
    /// Analyses the problem. Bounds must not cross.
    pub(super) fn new(inner: &'a mut dyn Problem) -> Self {
        let n = inner.n();
        let lower: Vec<f64> = inner.lower().iter().map(|&b| bound(b)).collect();
        let upper: Vec<f64> = inner.upper().iter().map(|&b| bound(b)).collect();
        let x: Vec<f64> = (0..n)
            .map(|i| inner.start()[i].max(lower[i]).min(upper[i]))
            .collect();
        let keep: Vec<bool> = (0..n).map(|i| lower[i] != upper[i]).collect();
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
        let mut values = vec![0.0; inner.pattern().1.len()];
        let mut reduced = Reduced {
            sign: vec![1.0; kept.len()],
            lower: kept.iter().map(|&i| lower[i]).collect(),
            upper: kept.iter().map(|&i| upper[i]).collect(),
            start: kept.iter().map(|&i| x[i]).collect(),
            kept,
            col_start,
            rows,
            entry,
            x,
            f: vec![0.0; n],
            values: Vec::new(),
            inner,
        };
        let known = reduced.inner.jacobian(&reduced.x, &mut values).is_ok();
        reduced.values = values;
        if known {
            reduced.choose_signs();
        }
        reduced
    }

    /// In a positive semidefinite matrix no diagonal is negative, and where it is zero, what two variables have in each other's
    /// rows is opposite in sign. A row is turned round where neither speaks against it.
    fn choose_signs(&mut self) {
        let column = |j: usize| self.col_start[j]..self.col_start[j + 1];
        let at = |i: usize, j: usize| {
            let found = self.rows[column(j)].binary_search(&i).ok()?;
            Some(self.values[self.entry[column(j).start + found]])
        };
        for _ in 0..SIGN_SWEEPS {
            let mut changed = false;
            for j in 0..self.kept.len() {
                if self.lower[j] != f64::NEG_INFINITY || self.upper[j] != f64::INFINITY {
                    continue;
                }
                let (mut diagonal, mut alike) = (0.0, 0.0);
                for k in column(j) {
                    let (i, value) = (self.rows[k], self.values[self.entry[k]]);
                    match i == j {
                        true => diagonal = self.sign[j] * value,
                        false => {
                            alike += self.sign[j] * self.sign[i] * value * at(j, i).unwrap_or(0.0)
                        }
                    }
                }
                if diagonal <= 0.0 && alike >= 0.0 && diagonal < alike {
                    (self.sign[j], changed) = (-self.sign[j], true);
                }
            }
            if !changed {
                break;
            }
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

    fn scatter(&mut self, x: &[f64]) {
        self.kept.iter().zip(x).for_each(|(&i, &v)| self.x[i] = v);
    }

    /// The point of the inner problem that belongs to a point of the reduced one.
    pub(super) fn postsolve(mut self, x: &[f64]) -> Vec<f64> {
        self.scatter(x);
        self.x
    }
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
            .zip(self.kept.iter().zip(&self.sign))
            .for_each(|(f, (&i, sign))| *f = sign * self.f[i]);
        Ok(())
    }
    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), EvalError> {
        self.scatter(x);
        self.inner.jacobian(&self.x, &mut self.values)?;
        values
            .iter_mut()
            .zip(self.entry.iter().zip(&self.rows))
            .for_each(|(v, (&k, &i))| *v = self.sign[i] * self.values[k]);
        Ok(())
    }
    fn is_linear(&self) -> bool {
        self.inner.is_linear()
    }
}
