//! Fixed variables leave the problem, and rows of free variables get a sign.
//!
//! Where a variable is free its row is an equation, and F and −F mean the same. Proximal terms, and whatever else is
//! good for monotone problems, ask for one of the two: conditions of optimality whose equations are written
//! "demand − supply" have a saddle there that "supply − demand" has not.

use super::run::bound;
use super::{Data, EvalError, Problem};

/// Sweeps over the rows at most, each of which may turn for the sake of others.
const SIGN_SWEEPS: usize = 10;

/// The reduced problem.
pub(super) struct Reduced<'a> {
    inner: &'a mut dyn Problem,
    /// Of the kept variables.
    pub(super) data: Data,
    /// Index of each kept variable in the inner problem.
    pub(super) kept: Vec<usize>,
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
        let data = inner.data();
        let n = data.lower.len();
        let bounds = |all: &[f64]| -> Vec<f64> { all.iter().map(|&b| bound(b)).collect() };
        let (lower, upper) = (bounds(&data.lower), bounds(&data.upper));
        let x: Vec<f64> = (0..n)
            .map(|i| data.start[i].max(lower[i]).min(upper[i]))
            .collect();
        let keep: Vec<bool> = (0..n).map(|i| lower[i] != upper[i]).collect();
        let kept: Vec<usize> = (0..n).filter(|&i| keep[i]).collect();
        let mut position = vec![usize::MAX; n];
        kept.iter().enumerate().for_each(|(k, &i)| position[i] = k);
        let (mut column_start, mut rows, mut entry) = (vec![0], Vec::new(), Vec::new());
        for &j in &kept {
            for k in data.column_start[j]..data.column_start[j + 1] {
                if keep[data.rows[k]] {
                    rows.push(position[data.rows[k]]);
                    entry.push(k);
                }
            }
            column_start.push(rows.len());
        }
        let pick = |all: &[f64]| kept.iter().map(|&i| all[i]).collect();
        let mut values = vec![0.0; data.rows.len()];
        let mut reduced = Reduced {
            sign: vec![1.0; kept.len()],
            data: Data {
                lower: pick(&lower),
                upper: pick(&upper),
                start: pick(&x),
                column_start,
                rows,
                is_linear: data.is_linear,
            },
            kept,
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
        let data = &self.data;
        let column = |j: usize| data.column_start[j]..data.column_start[j + 1];
        let at = |i: usize, j: usize| {
            let found = data.rows[column(j)].binary_search(&i).ok()?;
            Some(self.values[self.entry[column(j).start + found]])
        };
        for _ in 0..SIGN_SWEEPS {
            let mut changed = false;
            for j in 0..self.kept.len() {
                if data.lower[j] != f64::NEG_INFINITY || data.upper[j] != f64::INFINITY {
                    continue;
                }
                let (mut diagonal, mut alike) = (0.0, 0.0);
                for k in column(j) {
                    let (i, value) = (data.rows[k], self.values[self.entry[k]]);
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

    /// F of the kept rows.
    pub(super) fn function(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        self.scatter(x);
        self.inner.function(&self.x, &mut self.f)?;
        f.iter_mut()
            .zip(self.kept.iter().zip(&self.sign))
            .for_each(|(f, (&i, sign))| *f = sign * self.f[i]);
        Ok(())
    }

    /// The Jacobian of the kept rows and variables.
    pub(super) fn jacobian(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), EvalError> {
        self.scatter(x);
        self.inner.jacobian(&self.x, &mut self.values)?;
        values
            .iter_mut()
            .zip(self.entry.iter().zip(&self.data.rows))
            .for_each(|(v, (&k, &i))| *v = self.sign[i] * self.values[k]);
        Ok(())
    }
}
