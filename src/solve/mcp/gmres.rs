//! GMRES (Saad & Schultz 1986), preconditioned from the right, without restarts.

use feral::SparseColMatrix;

/// Iterations at most.
const LIMIT: usize = 10;

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// x += factor·y.
fn add(x: &mut [f64], factor: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x += factor * y);
}

/// The x of least |A x − b| in the Krylov space of A M⁻¹, where `precondition` is M⁻¹, until that norm is at most
/// `enough`, or does not fall any more.
pub(super) fn gmres(
    a: &SparseColMatrix,
    b: &[f64],
    enough: f64,
    precondition: impl Fn(&mut [f64]),
) -> Vec<f64> {
    let mut x = vec![0.0; b.len()];
    let norm = dot(b, b).sqrt();
    if !(norm > 0.0 && norm.is_finite()) {
        return x;
    }
    // Orthonormal residuals, their preconditioned images, and A's projection, made triangular by the rotations.
    let mut basis = vec![b.iter().map(|b| b / norm).collect::<Vec<f64>>()];
    let mut images: Vec<Vec<f64>> = Vec::new();
    let mut triangle: Vec<Vec<f64>> = Vec::new();
    let mut rotations: Vec<(f64, f64)> = Vec::new();
    let mut right = vec![norm];
    for k in 0..LIMIT {
        let mut image = basis[k].clone();
        precondition(&mut image);
        let mut next = vec![0.0; b.len()];
        a.matvec(&image, &mut next);
        let mut column: Vec<f64> = Vec::new();
        for v in &basis {
            let along = dot(v, &next);
            add(&mut next, -along, v);
            column.push(along);
        }
        let rest = dot(&next, &next).sqrt();
        for (i, (c, s)) in rotations.iter().enumerate() {
            let (p, q) = (column[i], column[i + 1]);
            (column[i], column[i + 1]) = (c * p + s * q, c * q - s * p);
        }
        let diagonal = column[k].hypot(rest);
        if !(diagonal > 0.0 && diagonal.is_finite()) {
            break;
        }
        let (c, s) = (column[k] / diagonal, rest / diagonal);
        column[k] = diagonal;
        let before = right[k];
        right[k] = c * before;
        right.push(-s * before);
        images.push(image);
        triangle.push(column);
        rotations.push((c, s));
        if (s * before).abs() <= enough || rest == 0.0 {
            break;
        }
        basis.push(next.iter().map(|v| v / rest).collect());
    }
    for k in (0..images.len()).rev() {
        let weight = right[k] / triangle[k][k];
        (0..k).for_each(|i| right[i] -= weight * triangle[k][i]);
        add(&mut x, weight, &images[k]);
    }
    x
}
