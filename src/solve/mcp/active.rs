//! Primal–dual active sets: Newton steps on the face of the bounds that are active at a solution.
//!
//! With B the variables off their bounds, solve J_BB d = −F_B and step; variables beyond a bound go onto it, those
//! whose F has the wrong sign leave it; until the sets stay (Hintermüller, Ito & Kunisch 2003). A few
//! indices that a crash got wrong are put right for one factorisation each time, however many there are, and putting
//! variables onto their bounds, which moves the equations of others, is put right as well.

use super::crash::{active_set, newton};
use super::run::{Point, Run, Stop};

/// Steps at most.
const STEPS: usize = 10;
/// Times more changes than at best, and more than so many, with which the steps are given up.
const DIVERGED: usize = 10;
/// ρ added to J_BB where it is singular.
const PROX: f64 = 1e-9;

/// Newton steps from `start` until the sets stay, or change ever more; the best point, in its bounds.
pub(super) fn active_sets(run: &mut Run, start: &Point) -> Result<Point, Stop> {
    let mut sets = active_set(&start.x, &start.f, &run.lower, &run.upper);
    let (mut best, mut point, mut fewest) = (start.clone(), start.clone(), run.n);
    for _ in 0..STEPS {
        run.check()?;
        let basic: Vec<usize> = (0..run.n).filter(|&i| sets[i] == 0).collect();
        let Some(jacobian) = run.jacobian(&point.x) else {
            return Ok(best);
        };
        let step = newton(run, &jacobian, &basic, &point.f, 0.0)
            .or_else(|| newton(run, &jacobian, &basic, &point.f, PROX));
        let Some(step) = step else {
            return Ok(best);
        };
        let (mut x, mut f) = (point.x, point.f);
        basic.iter().zip(step).for_each(|(&i, d)| x[i] += d);
        run.evaluations += 1;
        if run.problem.function(&x, &mut f).is_err() || f.iter().any(|f| !f.is_finite()) {
            return Ok(best);
        }
        let mut changes = 0;
        for i in 0..run.n {
            let next = match sets[i] {
                0 if x[i] < run.lower[i] => -1,
                0 if x[i] > run.upper[i] => 1,
                -1 if f[i] < 0.0 => 0,
                1 if f[i] > 0.0 => 0,
                same => same,
            };
            changes += usize::from(next != sets[i]);
            sets[i] = next;
        }
        run.clip(&mut x);
        let Some(next) = run.point(x) else {
            return Ok(best);
        };
        point = next;
        if point.residual < best.residual {
            best = point.clone();
        }
        if changes == 0 || changes > DIVERGED.max(DIVERGED * fewest) {
            break;
        }
        fewest = fewest.min(changes);
    }
    Ok(best)
}
