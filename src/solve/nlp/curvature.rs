//! Is a stationary point a minimum? The necessary condition of second order.
//!
//! On the tangent space of the active constraints (equations, binding inequalities, variables at a
//! bound) the Hessian of the Lagrangian must have no negative curvature; where it has, a direction of
//! negative curvature leads to better points, and the point was a saddle: min x·y at 0.
//!
//! First the inertia of \[H Jᵀ; J −δI\] is looked at: with as many negative eigenvalues as binding
//! constraints H is positive definite on the tangent space, and there is nothing to find. Otherwise
//! the smallest eigenvalue of P H P is found by Lanczos's method with full reorthogonalisation, P
//! being the orthogonal projection onto the tangent space by the augmented system
//! \[I Jᵀ; J −δI\]: one factorisation, then products only, so the cost is that of a few iterations of
//! the solver at any size.

use super::polish::number;
use super::problem::{Entry, Problem};
use super::symmetric::{Lower, Symmetric};
use crate::solve::random::Random;
use crate::solve::vector::dot;

/// Steps of Lanczos's method at most.
const STEPS: usize = 60;

/// A direction of negative curvature of σ f + λᵀg at x, tangent to what is active; None if there
/// is none, or nothing could be computed. `fixed` tells the variables that stay where they are, `binding`
/// the constraints that bind.
pub fn negative_curvature(
    nlp: &mut Problem,
    x: &[f64],
    (sigma, lambda): (f64, &[f64]),
    fixed: &[bool],
    binding: &[bool],
) -> Option<Vec<f64>> {
    let (n, m) = nlp.size();
    let hessian = nlp.hessian_entries_of(x, sigma, lambda)?;
    let size = hessian.iter().fold(0.0f64, |s, e| s.max(e.2.abs()));
    if size == 0.0 || !size.is_finite() {
        return None;
    }
    // free variables and binding constraints, renumbered
    let (variable, free) = number(|j| !fixed[j], n);
    let (row, bound) = number(|i| binding[i], m);
    if free == 0 {
        return None;
    }
    let within = |(i, j, a): Entry, rows: &[Option<usize>]| Some((rows[i]?, variable[j]?, a));
    let jacobian = nlp.jacobian_entries(x)?.into_iter();
    let jacobian = jacobian
        .filter(|e| e.2 != 0.0)
        .filter_map(|e| within(e, &row));
    let jacobian = unit_rows(jacobian.collect(), bound);
    let entries = hessian.into_iter().filter_map(|e| within(e, &variable));
    let entries: Vec<Entry> = entries.collect();
    if is_convex(free, bound, &jacobian, &entries) {
        return None;
    }
    let projection = Projection::new(free, bound, &jacobian)?;
    let (value, largest, direction) = lanczos(free, &projection, &entries)?;
    if value > -1e-6 * largest || value > -1e-9 {
        return None;
    }
    let mut out = vec![0.0; n];
    for (j, place) in variable.iter().enumerate() {
        if let Some(p) = place {
            out[j] = direction[*p];
        }
    }
    Some(out)
}

/// J with rows of unit size, so that δ means the same for all.
fn unit_rows(mut jacobian: Vec<Entry>, m: usize) -> Vec<Entry> {
    let mut norm = vec![0.0f64; m];
    for &(i, _, a) in &jacobian {
        norm[i] = norm[i].max(a.abs());
    }
    for (i, _, a) in &mut jacobian {
        *a /= norm[*i];
    }
    jacobian
}

/// The factors of \[D Jᵀ; J −δI\] of order n + m, D by its entries.
fn augmented(
    n: usize,
    m: usize,
    jacobian: &[Entry],
    d: impl Iterator<Item = Entry>,
) -> Option<Symmetric> {
    let mut matrix = Lower::default();
    for (i, j, v) in d {
        matrix.push(i, j, v);
    }
    for i in 0..m {
        matrix.push(n + i, n + i, -1e-12);
    }
    for &(i, j, a) in jacobian {
        matrix.push(n + i, j, a);
    }
    Symmetric::new(n + m, &matrix)
}

/// Whether the Hessian is clearly positive definite on the null space of J.
fn is_convex(n: usize, m: usize, jacobian: &[Entry], hessian: &[Entry]) -> bool {
    // every diagonal entry is there, so that the pattern is that of a nonsingular matrix
    let diagonal = (0..n).map(|j| (j, j, 0.0));
    let d = hessian.iter().copied().chain(diagonal);
    let factors = augmented(n, m, jacobian, d);
    factors.and_then(|f| f.inertia()) == Some((n, m))
}

/// The orthogonal projection onto the null space of J.
struct Projection {
    n: usize,
    total: usize,
    /// None where there is nothing to project on.
    factors: Option<Symmetric>,
}

impl Projection {
    fn new(n: usize, m: usize, jacobian: &[Entry]) -> Option<Self> {
        let factors = match m {
            0 => None,
            _ => Some(augmented(n, m, jacobian, (0..n).map(|j| (j, j, 1.0)))?),
        };
        Some(Self {
            n,
            total: n + m,
            factors,
        })
    }

    /// Whether it could be applied.
    fn apply(&self, v: &mut [f64]) -> Option<()> {
        let Some(factors) = &self.factors else {
            return Some(());
        };
        // twice: the second pass removes what rounding left in the first
        for _ in 0..2 {
            let mut b = vec![0.0; self.total];
            b[..self.n].copy_from_slice(v);
            v.copy_from_slice(&factors.solve(&b)?[..self.n]);
        }
        Some(())
    }
}

/// Smallest Ritz value, largest magnitude of a Ritz value, and the vector of the smallest.
fn lanczos(n: usize, projection: &Projection, entries: &[Entry]) -> Option<(f64, f64, Vec<f64>)> {
    // a fixed start without symmetry
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut q: Vec<f64> = (0..n).map(|_| random.uniform() - 0.5).collect();
    projection.apply(&mut q)?;
    let norm = dot(&q, &q).sqrt();
    if norm.is_nan() || norm < 1e-8 {
        return None;
    }
    q.iter_mut().for_each(|v| *v /= norm);
    let (mut basis, mut alpha, mut beta): (Vec<Vec<f64>>, Vec<f64>, Vec<f64>) =
        (vec![q], Vec::new(), Vec::new());
    for k in 0..STEPS.min(n) {
        let q = &basis[k];
        let mut w = vec![0.0; n];
        for &(i, j, a) in entries {
            w[i] += a * q[j];
            if i != j {
                w[j] += a * q[i];
            }
        }
        projection.apply(&mut w)?;
        alpha.push(dot(q, &w));
        for _ in 0..2 {
            for b in &basis {
                let c = dot(b, &w);
                w.iter_mut().zip(b).for_each(|(v, b)| *v -= c * b);
            }
        }
        let norm = dot(&w, &w).sqrt();
        let scale = alpha
            .iter()
            .chain(&beta)
            .fold(0.0f64, |s, v| s.max(v.abs()));
        if !norm.is_finite() {
            return None;
        }
        if norm <= 1e-10 * scale || norm == 0.0 {
            break;
        }
        w.iter_mut().for_each(|v| *v /= norm);
        beta.push(norm);
        basis.push(w);
    }
    let k = alpha.len();
    let mut t = faer::Mat::<f64>::zeros(k, k);
    for i in 0..k {
        t[(i, i)] = alpha[i];
        if i + 1 < k {
            t[(i + 1, i)] = beta[i];
            t[(i, i + 1)] = beta[i];
        }
    }
    let eigen = t.self_adjoint_eigen(faer::Side::Lower).ok()?;
    let (values, vectors) = (eigen.S(), eigen.U());
    let mut least = 0;
    let mut largest = 0.0f64;
    for i in 0..k {
        largest = largest.max(values[i].abs());
        if values[i] < values[least] {
            least = i;
        }
    }
    let mut direction = vec![0.0; n];
    for (i, b) in basis.iter().take(k).enumerate() {
        let c = vectors[(i, least)];
        direction.iter_mut().zip(b).for_each(|(v, b)| *v += c * b);
    }
    Some((values[least], largest, direction))
}
