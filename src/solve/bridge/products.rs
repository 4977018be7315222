//! Nonlinear programs in place of the pairs.
//!
//! Every pair gets slacks for the positive and the negative part of F, as far as its bounds allow
//! them: F = v − w, v, w ≥ 0. At a solution (x − l)·v = 0 and (u − x)·w = 0. Instead of that each product is at most μ
//! (Scholtes 2001): this satisfies usual constraint qualifications where the program with the products equal to
//! 0 does not, and its solutions tend to stationary points as μ → 0.

use crate::model::instance::{Instance, Kernel, KernelTerms, Op, Relation};
use crate::solve::backend::Seen;
use crate::solve::mpec::pairs::Program;
use std::sync::{Arc, Mutex, PoisonError};

/// The nonlinear program for a μ that may be changed.
pub struct Relaxed {
    /// The instance: the program's columns come first.
    pub instance: Instance,
    /// The rows of the products.
    first: usize,
    columns: usize,
    /// Hears of its points.
    pub exact: Arc<Exact>,
}

/// The best point that satisfies the pairs of those at which a program was evaluated: a relaxed one, or a branch, where all do.
#[derive(Default)]
pub struct Exact {
    /// Column, its bound, and the slack between which there is a product.
    products: Vec<(usize, f64, usize)>,
    best: Mutex<Option<(f64, Vec<f64>)>>,
}

impl Exact {
    fn see(&self, objective: f64, level: &[f64]) {
        let holds = |&(j, bound, slack): &(usize, f64, usize)| {
            (level[j] - bound).abs().min(level[slack].abs()) <= PAIR_TOLERANCE
        };
        let mut best = self.best.lock().unwrap_or_else(PoisonError::into_inner);
        let better = best.as_ref().is_none_or(|b| objective < b.0);
        if better && self.products.iter().all(holds) {
            *best = Some((objective, level.to_vec()));
        }
    }

    /// Who hears of the points of the program.
    pub fn seen(self: &Arc<Self>) -> Seen {
        let exact = Arc::clone(self);
        Arc::new(move |objective, level| exact.see(objective, level))
    }

    /// The point with its objective, once.
    pub fn take(&self) -> Option<(f64, Vec<f64>)> {
        let mut best = self.best.lock().unwrap_or_else(PoisonError::into_inner);
        best.take()
    }
}

/// Natural residual of a pair that counts as satisfied: well within what the certificate asks for.
const PAIR_TOLERANCE: f64 = 1e-8;

/// (c₀ + c₁·x)·s
fn product() -> Kernel {
    Kernel {
        ops: vec![Op::Affine(0, 0, 1), Op::Var(1), Op::Multiply(2)],
        variables: 2,
        constants: 2,
    }
}

impl Relaxed {
    /// For a program; [`Relaxed::tighten`] sets μ and the start.
    pub fn new(program: &Program) -> Self {
        let mut out = program.envelope.clone();
        let n = out.column_count();
        let first = out.row_count();
        let mut extra: Vec<Vec<(usize, f64)>> = vec![Vec::new(); first];
        let mut products = Vec::new();
        let mut terms = KernelTerms {
            kernel: product(),
            ..KernelTerms::default()
        };
        for p in &program.pairs {
            out.rows.relation[p.row] = Relation::Equal;
            let sides = [(p.lower, -1.0), (p.upper, 1.0)];
            for (bound, sign) in sides.into_iter().filter(|s| s.0.is_finite()) {
                let slack = out.columns.push(0.0, f64::INFINITY);
                extra[p.row].push((slack, sign));
                products.push((p.column, bound, slack));
                terms.row.push((first + terms.row.len()) as u32);
                terms.coef.push(1.0);
                terms.columns.extend([p.column as u32, slack as u32]);
                // x − l, or u − x
                terms.constants.extend([sign * bound, -sign]);
            }
        }
        let (matrix, rows) = (
            std::mem::take(&mut out.matrix),
            std::mem::take(&mut out.rows),
        );
        for (i, extra) in extra.into_iter().enumerate() {
            out.add_row(matrix.row(i).chain(extra), rows.relation[i], rows.rhs[i]);
        }
        out.rows.marginal[..first].copy_from_slice(&rows.marginal);
        out.rows.scale[..first].copy_from_slice(&rows.scale);
        for _ in &terms.row {
            out.add_row([], Relation::Less, 0.0);
        }
        if !terms.row.is_empty() {
            out.nonlinear.push(terms);
        }
        Self {
            instance: out,
            first,
            columns: n,
            exact: Arc::new(Exact {
                products,
                best: Mutex::new(None),
            }),
        }
    }

    /// Sets μ, and starts from a point of the program.
    pub fn tighten(&mut self, program: &Program, mu: f64, start: &[f64]) {
        self.instance.rows.rhs[self.first..].fill(mu);
        let level = &mut self.instance.columns.level;
        level[..self.columns].copy_from_slice(start);
        let activity = program.activity(start);
        let mut slack = self.columns;
        for p in &program.pairs {
            let f = program.force(p, &activity);
            let parts = [(p.lower, f), (p.upper, -f)];
            for (_, f) in parts.into_iter().filter(|s| s.0.is_finite()) {
                level[slack] = if f.is_finite() { f.max(0.0) } else { 0.0 };
                slack += 1;
            }
        }
    }
}
