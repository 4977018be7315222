//! Smoothing Newton method: Newton's method on Φ with √(a² + b² + 2μ) for the root, μ → 0.
//!
//! The smoothed system is that of the central path xᵢFᵢ = μ, so far from a solution it behaves
//! like an interior point method and does not see the kinks that trap descent methods on Ψ.

use super::factor::Factor;
use super::log;
use super::majors::merit_gradient;
use super::merit::Phi;
use super::run::{End, Patience, Point, Run, Stop};
use super::semismooth::{PATIENCE, levenberg_marquardt, newton_system, search};

/// Iterations at most.
const LIMIT: usize = 200;
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
    let mut patience = Patience::new();
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
        if patience.idle(merit + phi.mu, 0.5) > PATIENCE {
            return Ok(End::Stuck);
        }
        let Some(jacobian) = run.jacobian(&point.x) else {
            return Ok(End::Stuck);
        };
        let gradient = merit_gradient(run, phi, &point, &jacobian);
        let (h, right) = newton_system(run, phi, &point, &jacobian);
        run.factorisations += 1;
        let newton = Factor::new(h.clone(), run.fill).and_then(|mut a| a.solve(&right));
        let (direction, kind) = match newton {
            Some(d) => (d, 'N'),
            None => {
                run.factorisations += 1;
                let nu = (1e-2 * (2.0 * merit).sqrt()).clamp(1e-8, 1.0);
                match levenberg_marquardt(&h, &right, nu, run.fill) {
                    Some(d) => (d, 'L'),
                    None => (gradient.iter().map(|g| -g).collect(), 'G'),
                }
            }
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
