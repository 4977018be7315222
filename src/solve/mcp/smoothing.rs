//! Smoothing Newton method: Newton's method on Φ with √(a² + b² + 2μ) for the root, μ → 0.
//!
//! The smoothed system is that of the central path xᵢFᵢ = μ, so far from a solution it behaves
//! like an interior point method and does not see the kinks that trap descent methods on Ψ.

use feral::SparseColMatrix;

use super::factor::{Factor, combine};
use super::log;
use super::majors::merit_gradient;
use super::merit::Phi;
use super::run::{End, Point, Run, StallCounter, Stop};

/// Iterations at most.
const LIMIT: usize = 200;
/// Iterations after which the merit function must have halved.
const STALL_ITERATIONS: usize = 20;
/// First smoothing parameter.
const MU: f64 = 1.0;
/// Armijo constant.
const ARMIJO: f64 = 1e-4;

/// Runs the method.
pub(super) fn smoothing(run: &mut Run, start: Point) -> Result<End, Stop> {
    let mut phi = Phi {
        lambda: 1.0,
        mu: MU,
    };
    let mut point = start;
    log::note(run, log::Part::Majors, || {
        "Smoothing Newton\n iter        mu    residual     step".into()
    });
    let mut stall = StallCounter::new();
    for iteration in 0..LIMIT {
        if run.converged(point.residual) {
            return Ok(End::Solved);
        }
        run.check()?;
        let mut merit = phi.merit(&point.x, &point.f, &run.lower, &run.upper);
        while merit <= 0.1 * phi.mu && phi.mu > 1e-30 {
            phi.mu = (0.1 * phi.mu)
                .min(0.2 * Phi::PLAIN.merit(&point.x, &point.f, &run.lower, &run.upper));
            merit = phi.merit(&point.x, &point.f, &run.lower, &run.upper);
        }
        if stall.idle(merit + phi.mu, 0.5) > STALL_ITERATIONS {
            return Ok(End::Stuck);
        }
        let Some(jacobian) = run.jacobian(&point.x) else {
            return Ok(End::Stuck);
        };
        let gradient = merit_gradient(run, phi, &point, &jacobian);
        let (h, right) = newton_system(run, phi, &point, &jacobian);
        run.factorisations += 1;
        let newton = Factor::new(h, run.fill).and_then(|mut a| a.solve(&right));
        let (direction, kind) = match newton {
            Some(d) => (d, 'N'),
            None => (gradient.iter().map(|g| -g).collect(), 'G'),
        };
        let slope: f64 = gradient.iter().zip(&direction).map(|(g, d)| g * d).sum();
        let Some((next, step)) = search(run, &point, &direction, |run, p, t| {
            phi.merit(&p.x, &p.f, &run.lower, &run.upper) <= merit + ARMIJO * t * slope.min(0.0)
        }) else {
            return Ok(End::Stuck);
        };
        point = next;
        log::newton_line(run, iteration + 1, &point, phi.mu, step, kind);
    }
    Ok(End::Limit)
}

/// H = Da + Db·J and −Φ.
fn newton_system(
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

/// Halves the step until `accept` is content.
fn search(
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
