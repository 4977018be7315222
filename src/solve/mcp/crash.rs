//! Crash: projected Newton steps towards the right active set.
//!
//! With L = {i: xᵢ ≤ lᵢ, Fᵢ ≥ 0}, U = {i: xᵢ ≥ uᵢ, Fᵢ ≤ 0} and B the rest, solve
//! (J_BB + ρI) d = −F_B and take x_B = clip(x_B + t·d) with t halved until Ψ falls. One
//! factorisation brings many changes of the active set, where the path makes one per pivot
//! (Dirkse & Ferris, Crash techniques for large-scale complementarity problems, 1997). The crash
//! need not converge: it ends when the sets do not change any more.

use feral::SparseColMatrix;

use super::factor::{Builder, Factor};
use super::log;
use super::run::{Point, Run, Stop};

/// Least step length worth taking.
const STEP_MIN: f64 = 1e-5;
/// A step shorter than this ends the crash: the direction is no good.
const STEP_STOP: f64 = 1e-2;
/// A short step must change a share 1/this of the active set: the path makes so few changes sooner.
const PIVOTS_PER_FACTORISATION: usize = 500;
/// Merit values a step is compared with: their largest.
const MEMORY: usize = 3;
/// Directions longer than this come from a singular matrix.
const DIRECTION_MAX: f64 = 1e10;
/// Armijo constant of the crash (sufficient decrease).
const CRASH_DECREASE: f64 = 2e-4;

/// Index sets of a point: −1 at the lower bound, 1 at the upper, 0 between (and to be solved for).
pub(super) fn active_set(x: &[f64], f: &[f64], lower: &[f64], upper: &[f64]) -> Vec<i8> {
    (0..x.len())
        .map(|i| {
            if x[i] <= lower[i] && f[i] >= 0.0 {
                -1
            } else if x[i] >= upper[i] && f[i] <= 0.0 {
                1
            } else {
                0
            }
        })
        .collect()
}

/// Improves `start` and returns the best iterate; merit values of the iterates are appended to `history`.
pub(super) fn crash(run: &mut Run, start: Point, history: &mut Vec<f64>) -> Result<Point, Stop> {
    let mut best = start.clone();
    let mut point = start;
    let mut sets = active_set(&point.x, &point.f, &run.lower, &run.upper);
    log::crash_header(run);
    for iteration in 0..run.settings.crash_iteration_limit {
        run.check()?;
        let norm = (2.0 * point.merit).sqrt();
        if norm < 1e-15 {
            break;
        }
        let basic: Vec<usize> = (0..run.n).filter(|&i| sets[i] == 0).collect();
        if basic.is_empty() {
            break;
        }
        let Some(jacobian) = run.jacobian(&point.x) else {
            break;
        };
        let mut prox = (1e-2 * norm).min(0.1);
        let Some(direction) = direction(run, &jacobian, &basic, &point.f, &mut prox)? else {
            break;
        };
        let reference = history
            .iter()
            .rev()
            .take(MEMORY)
            .fold(point.merit, |a, &b| f64::max(a, b));
        let Some((next, step)) = search(run, &point, &basic, &direction, reference) else {
            break;
        };
        let new_sets = active_set(&next.x, &next.f, &run.lower, &run.upper);
        let changes = sets.iter().zip(&new_sets).filter(|(a, b)| a != b).count();
        run.crash_iterations += 1;
        history.push(next.merit);
        log::crash_line(run, iteration + 1, &next, basic.len(), changes, prox, step);
        point = next;
        sets = new_sets;
        if point.merit < best.merit {
            best = point.clone();
        }
        if changes == 0
            || step < STEP_STOP
            || step < 0.3 && changes * PIVOTS_PER_FACTORISATION <= run.n
        {
            break;
        }
    }
    Ok(best)
}

/// Solves (J_BB + ρI) d = −F_B, with a larger ρ as long as the matrix is singular.
fn direction(
    run: &mut Run,
    jacobian: &SparseColMatrix,
    basic: &[usize],
    f: &[f64],
    prox: &mut f64,
) -> Result<Option<Vec<f64>>, Stop> {
    for _ in 0..6 {
        run.check()?;
        if let Some(d) = newton(run, jacobian, basic, f, *prox) {
            return Ok(Some(d));
        }
        *prox = (10.0 * *prox).max(1e-4);
    }
    Ok(None)
}

/// Solves (J_BB + ρI) d = −F_B; None if the matrix is singular, or empty.
fn newton(
    run: &mut Run,
    jacobian: &SparseColMatrix,
    basic: &[usize],
    f: &[f64],
    prox: f64,
) -> Option<Vec<f64>> {
    let mut position = vec![usize::MAX; run.n];
    for (k, &i) in basic.iter().enumerate() {
        position[i] = k;
    }
    let right: Vec<f64> = basic.iter().map(|&i| -f[i]).collect();
    run.factorisations += 1;
    Factor::new(submatrix(jacobian, basic, &position, prox), run.fill)
        .and_then(|mut a| a.solve(&right))
        .filter(|d| d.iter().all(|v| v.abs() <= DIRECTION_MAX))
}

/// J_BB + ρI.
fn submatrix(
    jacobian: &SparseColMatrix,
    basic: &[usize],
    position: &[usize],
    prox: f64,
) -> SparseColMatrix {
    let mut b = Builder::new(basic.len());
    for (k, &j) in basic.iter().enumerate() {
        let (rows, values) = jacobian.column(j);
        let mut diagonal = false;
        for (&i, &v) in rows.iter().zip(values) {
            let row = position[i];
            if row == usize::MAX {
                continue;
            }
            if row >= k && !diagonal {
                diagonal = true;
                if row == k {
                    b.push(k, v + prox);
                    continue;
                }
                b.push(k, prox);
            }
            b.push(row, v);
        }
        if !diagonal {
            b.push(k, prox);
        }
        b.end_column();
    }
    b.finish()
}

/// Halves the step until the merit falls.
fn search(
    run: &mut Run,
    point: &Point,
    basic: &[usize],
    direction: &[f64],
    reference: f64,
) -> Option<(Point, f64)> {
    let mut step = 1.0;
    while step > STEP_MIN {
        let mut x = point.x.clone();
        for (&i, &d) in basic.iter().zip(direction) {
            x[i] += step * d;
        }
        run.clip(&mut x);
        if let Some(next) = run.point(x)
            && next.merit <= (1.0 - CRASH_DECREASE * step) * reference
        {
            return Some((next, step));
        }
        step *= 0.5;
    }
    None
}
