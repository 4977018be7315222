//! From a point inside a face of solutions to a vertex of it.
//!
//! Interior and proximal methods end inside the face of solutions, where more variables are off their
//! bounds than columns are independent: the basis B is singular, and without a proximal term no path
//! starts there. Null vectors z of B (inverse iteration with B + εI) leave Mx − w + v as it is, so x
//! moves along z until a variable meets a bound, whose column then makes room for its complement's;
//! that lowers the defect of B by one. It is the primal push of a crossover in linear programming
//! (Bixby & Saltzman 1994).

use super::factor::shifted;
use super::linear::{Kind, LinearProblem, Variable, factorise};
use super::log;
use super::path::Start;
use super::random::Random;
use super::run::{Run, Stop};

/// Makes a singular basis regular; null vectors have this share of residual.
const EPSILON: f64 = 1e-9;
/// A solution (2-norm) longer than this, for a right-hand side with entries of size 1, is a null vector.
const LENGTH: f64 = 2e7;
/// Factorisations for the sake of one update after which the attempt is given up.
const FAILURES: usize = 20;
/// Entries below this share of the largest one do not block.
const ENTRY_MIN: f64 = 1e-6;

/// The state at the vertex, for a path from there; None if there are null vectors without bounds in
/// their way, or no vertex after `limit` moves.
pub(super) fn vertex(
    run: &mut Run,
    problem: &LinearProblem,
    start: &Start,
    limit: usize,
) -> Result<Option<Start>, Stop> {
    let n = problem.q.len();
    let m = shifted(problem.m, EPSILON);
    let regular = LinearProblem { m: &m, ..*problem };
    let (mut kind, mut value) = (start.kind.clone(), values(problem, start));
    let slots = |kind: &[Kind]| -> Vec<Variable> {
        kind.iter()
            .enumerate()
            .map(|(index, &kind)| Variable { index, kind })
            .collect()
    };
    let mut random = Random::new(11);
    let (mut basis, mut failures) = (None, 0);
    let mut direction = Vec::new();
    for moves in 0..limit {
        if moves % 32 == 0 {
            run.check()?;
        }
        if basis.as_ref().is_none_or(super::basis::Basis::is_old) {
            basis = factorise(run, &regular, &slots(&kind));
        }
        let Some(factors) = basis.as_mut() else {
            refused(run, "no factors", moves);
            return Ok(None);
        };
        let mut z: Vec<f64> = (0..n).map(|_| random.between(-1.0, 1.0)).collect();
        if !factors.solve(&mut z) {
            refused(run, "no solution", moves);
            return Ok(None);
        }
        let size = |z: &[f64]| z.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        if z.iter().map(|z| z * z).sum::<f64>().sqrt() < LENGTH {
            log::note(run, log::Part::Paths, || {
                format!("vertex after {moves} moves")
            });
            return Ok((moves > 0).then_some(Start {
                kind,
                x: value,
                cover: false,
                tolerance: start.tolerance,
            }));
        }
        // Once more for a clean null vector.
        let scale = 1.0 / size(&z);
        z.iter_mut().for_each(|z| *z *= scale);
        if !factors.solve(&mut z) {
            return Ok(None);
        }
        let scale = 1.0 / size(&z);
        z.iter_mut().for_each(|z| *z *= scale);
        let Some((k, step, upper)) = block(problem, &kind, &value, &z) else {
            refused(run, "nothing blocks", moves);
            return Ok(None);
        };
        value.iter_mut().zip(&z).for_each(|(v, z)| *v += step * z);
        let entering = match (kind[k], upper) {
            (Kind::Between, false) => Kind::AtLower,
            (Kind::Between, true) => Kind::AtUpper,
            _ => Kind::Between,
        };
        let column = regular.column(Variable {
            index: k,
            kind: entering,
        });
        value[k] = match (entering, kind[k]) {
            (Kind::Between, Kind::AtLower) => problem.lower[k],
            (Kind::Between, _) => problem.upper[k],
            _ => 0.0,
        };
        kind[k] = entering;
        if !factors.solve_sparse(&column, &mut direction) {
            return Ok(None);
        }
        // Columns outside the range of B have directions as long as null vectors; others leave the
        // defect as it is, as happens where the problem is not monotone.
        if direction.iter().map(|d| d.1 * d.1).sum::<f64>().sqrt() < 1e-2 * LENGTH {
            refused(run, "the defect stays", moves);
            return Ok(None);
        }
        if !factors.replace(k, &column, &direction) {
            basis = None;
            failures += 1;
            if failures > FAILURES {
                return Ok(None);
            }
        }
    }
    log::note(run, log::Part::Paths, || "no vertex: too many moves".into());
    Ok(None)
}

/// Every index's value at the start: of x where it is between, else of its slack.
fn values(problem: &LinearProblem, start: &Start) -> Vec<f64> {
    let at = |(k, &x): (usize, &f64)| match start.kind[k] {
        Kind::AtLower => problem.lower[k],
        Kind::AtUpper => problem.upper[k],
        Kind::Between => x,
    };
    let x: Vec<f64> = start.x.iter().enumerate().map(at).collect();
    let mut product = vec![0.0; x.len()];
    problem.m.matvec(&x, &mut product);
    let slack = |k: usize| problem.q[k] + product[k];
    let value = |k: usize| match start.kind[k] {
        Kind::Between => x[k],
        Kind::AtLower => slack(k).max(0.0),
        Kind::AtUpper => (-slack(k)).max(0.0),
    };
    (0..x.len()).map(value).collect()
}

fn refused(run: &mut Run, why: &str, moves: usize) {
    log::note(run, log::Part::Paths, || {
        format!("no vertex: {why} after {moves} moves")
    });
}

/// The index that meets a bound first along z or −z, the step to it, and whether the bound is the upper
/// one of x.
fn block(
    problem: &LinearProblem,
    kind: &[Kind],
    value: &[f64],
    z: &[f64],
) -> Option<(usize, f64, bool)> {
    let mut best: [Option<(usize, f64, bool)>; 2] = [None, None];
    for k in 0..z.len() {
        if z[k].abs() < ENTRY_MIN {
            continue;
        }
        let (low, high) = match kind[k] {
            Kind::Between => (problem.lower[k], problem.upper[k]),
            _ => (0.0, f64::INFINITY),
        };
        for (side, sign) in [(0, 1.0), (1, -1.0)] {
            let rate = sign * z[k];
            let room = if rate < 0.0 {
                value[k] - low
            } else {
                high - value[k]
            };
            let step = room.max(0.0) / rate.abs();
            if step.is_finite() && best[side].is_none_or(|b| step < b.1) {
                best[side] = Some((k, step, rate > 0.0));
            }
        }
    }
    let signed = |side: usize, sign: f64| best[side].map(|(k, s, u)| (k, sign * s, u));
    match (signed(0, 1.0), signed(1, -1.0)) {
        (Some(a), Some(b)) => Some(if a.1.abs() <= b.1.abs() { a } else { b }),
        (a, b) => a.or(b),
    }
}
