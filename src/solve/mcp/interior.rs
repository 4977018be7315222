//! Interior crash: a predictor-corrector method that finds the active set of a large problem.
//!
//! With slacks w, v ≥ 0 for the finite bounds, F(x) = w − v, (x − l)w = μ, (u − x)v = μ, a step towards
//! products p and q solves
//!
//! ```text
//! (J + D + ρI) dx = −(F − w + v) + p/(x−l) − w − q/(u−x) + v,     D = w/(x−l) + v/(u−x),
//! ```
//!
//! with p = q = σμ less the products of the predictor's steps (Mehrotra 1992).
//!
//! Where J is not monotone, steps may get short far from a solution: the central path has folds. Then the proximal
//! term ρ grows with every short step and falls with long ones, so that steps go over the folds. What ρ adds to the
//! equations, ρ dx, vanishes with the steps.
//!
//! For monotone problems the number of steps hardly grows with n, while the path makes at least a pivot
//! for every index that a crash got wrong; for others this is a heuristic like any crash. Its
//! point need not be accurate: a bound is active where the slack is the larger of the two, and the
//! path does the rest.

use super::factor::{Factor, Ordering, combine};
use super::log;
use super::run::{Point, Run, StallCounter, Stop};

/// Steps at most.
const LIMIT: usize = 100;
/// Variables per step over folds, and steps at most: where steps cost more than pivots, the paths of the majors do better.
const FOLDS: (usize, usize) = (20, 500);
/// Share of the way to the boundary.
const DAMPING: f64 = 0.995;
/// A step shorter than this says that a fold is near.
const STEP_BAD: f64 = 0.1;
/// Steps in a row without progress that end the crash.
const STALL_ITERATIONS: usize = 20;
/// Relative residual of a step.
const ENOUGH: f64 = 1e-9;
/// ρ, least and largest.
const PROX: (f64, f64) = (1e-14, 1e-1);
/// ρ with which steps go over folds: at first, and its factors after short and long steps.
const OVER: (f64, f64, f64) = (1e-6, 10.0, 0.3);
/// Products below this are rounding errors.
const PRODUCT_MIN: f64 = 1e-16;

/// Distances from the bounds and the slacks that go with them; 1 and 0 for a bound that is not there.
#[derive(Clone)]
struct State {
    a: Vec<f64>,
    w: Vec<f64>,
    b: Vec<f64>,
    v: Vec<f64>,
}

/// A step: of x, w and v.
struct Step {
    x: Vec<f64>,
    w: Vec<f64>,
    v: Vec<f64>,
    /// How far it may go, at most 1.
    length: f64,
}

/// Which bounds are finite.
struct Bounds {
    lower: Vec<bool>,
    upper: Vec<bool>,
    count: usize,
}

impl Bounds {
    fn of(run: &Run) -> Self {
        let finite = |bounds: &[f64]| bounds.iter().map(|b| b.is_finite()).collect::<Vec<_>>();
        let (lower, upper) = (finite(&run.lower), finite(&run.upper));
        let count = lower.iter().chain(&upper).filter(|b| **b).count();
        Self {
            lower,
            upper,
            count,
        }
    }
}

/// Looks for a better point than `start`. None if there is none, or nothing to do.
pub(super) fn interior(run: &mut Run, start: &Point) -> Result<Option<Point>, Stop> {
    let bounds = Bounds::of(run);
    if bounds.count == 0 {
        return Ok(None);
    }
    let Some((mut point, mut state)) = inside(run, start, &bounds) else {
        return Ok(None);
    };
    log::note(run, || {
        "Interior crash\n iter    product  equations    residual     step     prox".into()
    });
    let mut best = start.clone();
    let mut ordering = Ordering::None;
    let mut prox = PROX.0;
    let mut stall = StallCounter::new();
    // Whether it goes over folds, and the steps that are left.
    let (mut over, mut left) = (false, LIMIT);
    for iteration in 1.. {
        run.check()?;
        state.distances(run, &bounds, &point.x);
        if let Some(found) = run.point(snapped(run, &point.x, &state, &bounds))
            && found.residual < best.residual
        {
            best = found;
        }
        let mu = state.product(&bounds);
        let left_over = |i: usize| point.f[i] - state.w[i] + state.v[i];
        let r: Vec<f64> = (0..run.n).map(left_over).collect();
        let off = r.iter().fold(0.0f64, |m, r| m.max(r.abs()));
        if run.polished(best.residual)
            || mu < PRODUCT_MIN
            || stall.idle(mu + off, 0.5) > STALL_ITERATIONS
            || !(mu + off).is_finite()
            || left == 0
        {
            break;
        }
        left -= 1;
        let Some(jacobian) = run.jacobian(&point.x) else {
            break;
        };
        let matrix = combine(
            &jacobian,
            |i| state.w[i] / state.a[i] + state.v[i] / state.b[i] + prox,
            |_| 1.0,
        );
        run.factorisations += 1;
        let step = Factor::ordered(matrix, run.fill, &mut ordering)
            .and_then(|mut factor| step(&mut factor, &state, &bounds, &r, mu));
        let Some(step) = step else {
            if prox >= PROX.1 {
                break;
            }
            prox = (100.0 * prox).min(PROX.1);
            continue;
        };
        run.crash_iterations += 1;
        let t = step.length;
        let residual = best.residual;
        log::note(run, || {
            format!(
                "{:5} {mu:10.3e} {off:10.3e} {residual:11.4e} {t:8.1e} {prox:8.1e}",
                iteration
            )
        });
        let along = |from: &[f64], d: &[f64]| -> Vec<f64> {
            from.iter().zip(d).map(|(v, d)| v + t * d).collect()
        };
        let Some(next) = run.point(along(&point.x, &step.x)) else {
            break;
        };
        point = next;
        state.w = along(&state.w, &step.w);
        state.v = along(&state.v, &step.v);
        if t < STEP_BAD && !over {
            (over, left) = (true, (run.n / FOLDS.0).min(FOLDS.1));
        }
        if t < STEP_BAD {
            prox = (OVER.1 * prox).clamp(OVER.0, PROX.1);
            stall = StallCounter::new();
        } else if t > 0.5 {
            prox = (OVER.2 * prox).max(PROX.0);
        }
    }
    Ok((best.residual < start.residual).then_some(best))
}

/// The point moved off its bounds, with slacks; None where it has no values.
fn inside(run: &mut Run, start: &Point, bounds: &Bounds) -> Option<(Point, State)> {
    let n = run.n;
    let place = |i: usize| {
        let inside = (0.5 * (run.upper[i] - run.lower[i])).min(1.0);
        // Without a bound on a side the other one decides; max and min ignore NaN.
        start.x[i]
            .max(run.lower[i] + inside)
            .min(run.upper[i] - inside)
    };
    let x = (0..n).map(place).collect();
    let point = run.point(x)?;
    let slack = |is: &[bool], sign: f64| -> Vec<f64> {
        let at = |(&is, f): (&bool, &f64)| if is { (sign * f).max(1.0) } else { 0.0 };
        is.iter().zip(&point.f).map(at).collect()
    };
    let state = State {
        a: vec![1.0; n],
        w: slack(&bounds.lower, 1.0),
        b: vec![1.0; n],
        v: slack(&bounds.upper, -1.0),
    };
    Some((point, state))
}

/// x with the bounds active whose slack is the larger.
fn snapped(run: &Run, x: &[f64], state: &State, bounds: &Bounds) -> Vec<f64> {
    (0..x.len())
        .map(|i| {
            if bounds.lower[i] && state.a[i] < state.w[i] {
                run.lower[i]
            } else if bounds.upper[i] && state.b[i] < state.v[i] {
                run.upper[i]
            } else {
                x[i]
            }
        })
        .collect()
}

impl State {
    /// a and b at x.
    fn distances(&mut self, run: &Run, bounds: &Bounds, x: &[f64]) {
        for (i, x) in x.iter().enumerate() {
            if bounds.lower[i] {
                self.a[i] = x - run.lower[i];
            }
            if bounds.upper[i] {
                self.b[i] = run.upper[i] - x;
            }
        }
    }

    /// Mean of the products.
    fn product(&self, bounds: &Bounds) -> f64 {
        let sum: f64 = (0..self.a.len())
            .map(|i| self.a[i] * self.w[i] + self.b[i] * self.v[i])
            .sum();
        sum / bounds.count as f64
    }

    /// Products after a step of length t, at index i.
    fn products(&self, step: &Step, t: f64, i: usize) -> (f64, f64) {
        (
            (self.a[i] + t * step.x[i]) * (self.w[i] + t * step.w[i]),
            (self.b[i] - t * step.x[i]) * (self.v[i] + t * step.v[i]),
        )
    }

    /// The step towards products p and q; None if the matrix is singular.
    fn newton(
        &self,
        factor: &mut Factor,
        bounds: &Bounds,
        r: &[f64],
        p: &[f64],
        q: &[f64],
    ) -> Option<Step> {
        let n = r.len();
        let to = |i: usize| {
            (
                if bounds.lower[i] {
                    p[i] / self.a[i] - self.w[i]
                } else {
                    0.0
                },
                if bounds.upper[i] {
                    q[i] / self.b[i] - self.v[i]
                } else {
                    0.0
                },
            )
        };
        let right: Vec<f64> = (0..n).map(|i| to(i).0 - to(i).1 - r[i]).collect();
        let x = factor.solve_to(&right, ENOUGH)?;
        let w: Vec<f64> = (0..n)
            .map(|i| to(i).0 - self.w[i] / self.a[i] * x[i])
            .collect();
        let v: Vec<f64> = (0..n)
            .map(|i| to(i).1 + self.v[i] / self.b[i] * x[i])
            .collect();
        let mut longest = 1.0 / DAMPING;
        let mut limit = |value: f64, change: f64| {
            if change < 0.0 {
                longest = f64::min(longest, -value / change);
            }
        };
        for i in 0..n {
            if bounds.lower[i] {
                limit(self.a[i], x[i]);
                limit(self.w[i], w[i]);
            }
            if bounds.upper[i] {
                limit(self.b[i], -x[i]);
                limit(self.v[i], v[i]);
            }
        }
        Some(Step {
            x,
            w,
            v,
            length: DAMPING * longest,
        })
    }
}

/// Predictor and corrector.
fn step(factor: &mut Factor, state: &State, bounds: &Bounds, r: &[f64], mu: f64) -> Option<Step> {
    let n = r.len();
    let zero = vec![0.0; n];
    let predictor = state.newton(factor, bounds, r, &zero, &zero)?;
    let t = predictor.length;
    let after: f64 = (0..n)
        .map(|i| {
            let (p, q) = state.products(&predictor, t, i);
            p * f64::from(u8::from(bounds.lower[i])) + q * f64::from(u8::from(bounds.upper[i]))
        })
        .sum::<f64>()
        / bounds.count as f64;
    let sigma = (after / mu).clamp(0.0, 1.0).powi(3);
    let second = |sign: f64, slack: &[f64]| -> Vec<f64> {
        let product = predictor.x.iter().zip(slack).map(|(x, s)| x * s);
        product.map(|p| sigma * mu + sign * p).collect()
    };
    let (p, q) = (second(-1.0, &predictor.w), second(1.0, &predictor.v));
    state.newton(factor, bounds, r, &p, &q)
}
