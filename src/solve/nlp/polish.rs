//! The last digits: Newton's method on the KKT equations of the active set.
//!
//! An interior point stops at its tolerance. With the variables at bounds fixed and the binding rows
//! as equations, the remaining conditions ∇f + Jᵀλ = 0, g = b are a square system in (x, λ); a few
//! Newton steps with \[H Jᵀ; J 0\] solve it to rounding, if the active set is right and regular. Where
//! it is not, the steps do not reduce the residual and nothing is changed.

use super::problem::Problem;
use super::symmetric::{Lower, Symmetric};

/// Steps at most.
const STEPS: usize = 6;
/// What makes a system with dependent rows regular: small beside its entries, large beside rounding.
const REGULARISATION: f64 = 1e-8;

/// What is active at a point.
pub struct Active {
    /// Variables that stay where they are.
    pub fixed: Vec<bool>,
    /// Constraints that bind.
    pub binding: Vec<bool>,
}

/// Improves x and λ. `target` gives the value of each binding constraint. Returns whether the residual
/// of the system went down.
pub fn polish(
    nlp: &mut Problem,
    active: &Active,
    target: &[f64],
    x: &mut [f64],
    lambda: &mut [f64],
) -> bool {
    let mut improved = false;
    let Some(mut residual) = System::new(nlp, active, target, x, lambda) else {
        return false;
    };
    let mut regular = true;
    for _ in 0..STEPS {
        let next = residual.step(regular).and_then(|(dx, dl)| {
            let x: Vec<f64> = x.iter().zip(&dx).map(|(a, b)| a + b).collect();
            let lambda: Vec<f64> = lambda.iter().zip(&dl).map(|(a, b)| a + b).collect();
            let next = System::new(nlp, active, target, &x, &lambda)?;
            // also the first step must help; later ones may stall at the rounding level
            (next.size < 0.5 * residual.size).then_some((x, lambda, next))
        });
        match next {
            Some((next_x, next_lambda, next)) => {
                x.copy_from_slice(&next_x);
                lambda.copy_from_slice(&next_lambda);
                improved = true;
                residual = next;
            }
            None if regular && !improved => regular = false,
            None => break,
        }
    }
    improved
}

/// The KKT system at a point.
struct System {
    matrix: Lower,
    right: Vec<f64>,
    /// Largest component of the right-hand side.
    size: f64,
    variables: Vec<Option<usize>>,
    rows: Vec<Option<usize>>,
    free: usize,
}

/// Numbers those that are kept, in order; and how many there are.
pub(super) fn number(keep: impl Fn(usize) -> bool, count: usize) -> (Vec<Option<usize>>, usize) {
    let mut next = 0;
    let mut place = Vec::with_capacity(count);
    for k in 0..count {
        place.push(keep(k).then_some(next));
        next += usize::from(keep(k));
    }
    (place, next)
}

impl System {
    fn new(
        nlp: &mut Problem,
        active: &Active,
        target: &[f64],
        x: &[f64],
        lambda: &[f64],
    ) -> Option<Self> {
        let (n, m) = nlp.size();
        let (variables, free) = number(|j| !active.fixed[j], n);
        let (rows, bound) = number(|i| active.binding[i], m);
        let mut gradient = vec![0.0; n];
        nlp.gradient(x, &mut gradient)?;
        let mut g = vec![0.0; m];
        nlp.constraints(x, &mut g)?;
        let mut matrix = Lower::default();
        for (i, v, a) in nlp.jacobian_entries(x)? {
            gradient[v] += lambda[i] * a;
            if let (Some(p), Some(q)) = (rows[i], variables[v]) {
                matrix.push(free + p, q, a);
            }
        }
        for (i, j, a) in nlp.hessian_entries(x, lambda)? {
            if let (Some(p), Some(q)) = (variables[i], variables[j]) {
                matrix.push(p, q, a);
            }
        }
        let total = free + bound;
        let mut right = vec![0.0; total];
        for (v, place) in variables.iter().enumerate() {
            if let Some(p) = place {
                right[*p] = -gradient[v];
            }
        }
        for (i, place) in rows.iter().enumerate() {
            if let Some(p) = place {
                right[free + p] = target[i] - g[i];
            }
        }
        let size = right.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        Some(Self {
            matrix,
            right,
            size,
            variables,
            rows,
            free,
        })
    }

    /// Newton's step; or, where the active rows are dependent, that of the regularised system.
    fn step(&self, regular: bool) -> Option<(Vec<f64>, Vec<f64>)> {
        let total = self.right.len();
        if self.size == 0.0 || total == 0 || regular && total > 2 * self.free {
            return None;
        }
        let mut matrix = self.matrix.clone();
        if !regular {
            for k in 0..total {
                let sign = if k < self.free { 1.0 } else { -1.0 };
                matrix.push(k, k, sign * REGULARISATION);
            }
        }
        let s = Symmetric::new(total, &matrix)?.solve(&self.right)?;
        let pick = |place: &[Option<usize>], offset: usize| -> Vec<f64> {
            place
                .iter()
                .map(|p| p.map_or(0.0, |p| s[offset + p]))
                .collect()
        };
        Some((pick(&self.variables, 0), pick(&self.rows, self.free)))
    }
}
