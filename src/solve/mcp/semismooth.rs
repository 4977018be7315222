//! Semismooth Newton method on the (penalised) Fischer–Burmeister system Φ(x) = 0.
//!
//! With H = Da + Db·J, an element of the generalised Jacobian, solve Hd = −Φ; where that fails or
//! does not descend (gᵀd > −ρ‖d‖^p), the Levenberg–Marquardt step (HᵀH + νI) d = −HᵀΦ, which
//! always does. Nonmonotone Armijo search on Ψ. After De Luca, Facchinei and Kanzow (1996).

use feral::SparseColMatrix;

use super::factor::{Builder, Factor, Fill, combine};
use super::log;
use super::majors::merit_gradient;
use super::merit::Phi;
use super::run::{End, Patience, Point, Run, Stop};

/// Iterations at most.
const LIMIT: usize = 200;
/// Iterations after which the merit function must have halved.
pub(super) const PATIENCE: usize = 20;
/// Descent test of the Newton direction: gᵀd ≤ −ρ‖d‖^p.
const RHO: f64 = 1e-8;
const POWER: f64 = 2.1;
/// Weight of the Fischer–Burmeister function against the penalty.
const LAMBDA: f64 = 0.95;
/// Memory of the nonmonotone search.
const MEMORY: usize = 8;
/// Armijo constant.
const ARMIJO: f64 = 1e-4;

/// Runs the method.
pub(super) fn semismooth(run: &mut Run, start: Point) -> Result<End, Stop> {
    let phi = Phi {
        lambda: LAMBDA,
        mu: 0.0,
    };
    let mut point = start;
    let mut merit = phi.merit(&point.x, &point.f, &run.lower, &run.upper);
    let mut history = vec![merit];
    log::note(run, log::Part::Majors, || {
        "Semismooth Newton\n iter        nu    residual     step".into()
    });
    let mut patience = Patience::new();
    for iteration in 0..LIMIT {
        if run.converged(point.residual) {
            return Ok(End::Solved);
        }
        if patience.idle(merit, 0.5) > PATIENCE {
            return Ok(End::Stuck);
        }
        run.check()?;
        let Some(jacobian) = run.jacobian(&point.x) else {
            return Ok(End::Stuck);
        };
        let gradient = merit_gradient(run, phi, &point, &jacobian);
        let (h, right) = newton_system(run, phi, &point, &jacobian);
        run.factorisations += 1;
        let newton = Factor::new(h.clone(), run.fill)
            .and_then(|mut a| a.solve(&right))
            .filter(|d| {
                let length = d.iter().map(|d| d * d).sum::<f64>().sqrt();
                slope(&gradient, d) <= -RHO * length.powf(POWER)
            });
        let (direction, nu) = match newton {
            Some(d) => (d, 0.0),
            None => {
                let nu = (1e-2 * (2.0 * merit).sqrt()).clamp(1e-8, 1.0);
                run.factorisations += 1;
                match levenberg_marquardt(&h, &right, nu, run.fill) {
                    Some(d) => (d, nu),
                    None => (gradient.iter().map(|g| -g).collect(), f64::INFINITY),
                }
            }
        };
        let reference = history
            .iter()
            .rev()
            .take(MEMORY)
            .fold(0.0, |a, &b| f64::max(a, b));
        let Some((next, step)) = search(run, &point, &direction, |run, p, t| {
            phi.merit(&p.x, &p.f, &run.lower, &run.upper)
                <= reference + ARMIJO * t * slope(&gradient, &direction)
        }) else {
            return Ok(End::Stuck);
        };
        point = next;
        merit = phi.merit(&point.x, &point.f, &run.lower, &run.upper);
        history.push(merit);
        log::newton_line(
            run,
            iteration + 1,
            &point,
            nu,
            step,
            if nu == 0.0 { 'N' } else { 'L' },
        );
    }
    Ok(End::Limit)
}

fn slope(gradient: &[f64], direction: &[f64]) -> f64 {
    gradient.iter().zip(direction).map(|(g, d)| g * d).sum()
}

/// H = Da + Db·J and −Φ.
pub(super) fn newton_system(
    run: &Run,
    phi: Phi,
    point: &Point,
    jacobian: &SparseColMatrix,
) -> (SparseColMatrix, Vec<f64>) {
    let slopes: Vec<(f64, f64)> = (0..run.n)
        .map(|i| phi.pair_slopes(point.x[i], point.f[i], run.lower[i], run.upper[i]))
        .collect();
    let right = (0..run.n)
        .map(|i| -phi.pair(point.x[i], point.f[i], run.lower[i], run.upper[i]))
        .collect();
    (combine(jacobian, |i| slopes[i].0, |i| slopes[i].1), right)
}

/// d from (HᵀH + νI) d = −HᵀΦ, as the sparse system s + Hd = −Φ, Hᵀs − νd = 0.
pub(super) fn levenberg_marquardt(
    h: &SparseColMatrix,
    right: &[f64],
    nu: f64,
    fill: Fill,
) -> Option<Vec<f64>> {
    let n = h.m;
    // Column i of the upper half needs row i of H.
    let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); n];
    for j in 0..n {
        let (index, values) = h.column(j);
        for (&i, &v) in index.iter().zip(values) {
            rows[i].push((j, v));
        }
    }
    let mut b = Builder::new(2 * n);
    for (i, row) in rows.iter().enumerate() {
        b.push(i, 1.0);
        row.iter().for_each(|&(j, v)| b.push(n + j, v));
        b.end_column();
    }
    for j in 0..n {
        let (index, values) = h.column(j);
        index.iter().zip(values).for_each(|(&i, &v)| b.push(i, v));
        b.push(n + j, -nu);
        b.end_column();
    }
    let mut long = right.to_vec();
    long.resize(2 * n, 0.0);
    let solution = Factor::new(b.finish(), fill)?.solve(&long)?;
    Some(solution[n..].to_vec())
}

/// Halves the step until `accept` is content.
pub(super) fn search(
    run: &mut Run,
    point: &Point,
    direction: &[f64],
    accept: impl Fn(&Run, &Point, f64) -> bool,
) -> Option<(Point, f64)> {
    let mut step = 1.0;
    while step > 1e-12 {
        let x = point
            .x
            .iter()
            .zip(direction)
            .map(|(x, d)| x + step * d)
            .collect();
        if let Some(next) = run.point(x)
            && accept(run, &next, step)
        {
            return Some((next, step));
        }
        step *= 0.5;
    }
    None
}
