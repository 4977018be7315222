//! Around the folds of the central path.
//!
//! Where F is not monotone, a path F(x) = w − v + τr, (x − l)w = τp, (u − x)v = τq with given r, p > 0 and q > 0 need not
//! reach τ = 0 with τ falling all the way: it turns back at folds, where the Newton matrix K of
//! [`interior`](super::interior) is singular, rises and turns again, as t does on Lemke's path. With τ a variable and
//! the length of arc for a parameter, folds are points like all others (Keller 1977, Allgower & Georg 1990). r, p and q are those of
//! the point where the interior steps got short, so the path begins there.
//!
//! A step is the tangent (u, 1), K u = r + p/(x − l) − q/(u − x), times a length, and the part of the
//! Newton correction orthogonal to it, and the second order of both. The metric is that of relative
//! changes, of distances, slacks and τ, in which the path is nearly straight far from folds. The tangent's sign is the one
//! that goes on; a step after which that is in doubt is taken back and shortened.
//!
//! Between two folds a path that is followed from infinity to a solution has τ rising. So if τ falling at
//! first leads to infinity, the other direction is the right one.

use super::factor::{Analysis, Factor, combine};
use super::interior::{Bounds, PROX, State};
use super::log;
use super::run::{Point, Run, Stop};

/// Variables per step, and steps at most: where steps cost more than pivots, the paths of the majors do better. Some
/// paths close on themselves.
const SHARE: usize = 20;
const LIMIT: usize = 500;
/// Share of the way to the boundary.
const DAMPING: f64 = 0.9;
/// Relative change along the tangent: at first, least and most.
const CHANGE: (f64, f64, f64) = (0.3, 1e-4, 0.9);
/// Relative correction below which the change grows, and above which it shrinks and waits.
const CORRECTION: (f64, f64) = (0.5, 2.0);
/// Cosine of the angle between tangents below which a step is taken back.
const COSINE: f64 = 0.5;
/// Relative residual of a step.
const ENOUGH: f64 = 1e-9;
/// τ at which a path is taken to lead to infinity.
const INFINITE: f64 = 1e3;
/// τ, and its slope along the tangent, from which interior steps do better.
const DONE: (f64, f64) = (0.5, -0.5);

/// Steps for folds at most.
pub(super) fn fold_limit(n: usize) -> usize {
    (n / SHARE).min(LIMIT)
}

/// The path's point, and what it goes through with τ = 1.
struct Path<'a> {
    bounds: &'a Bounds,
    point: Point,
    state: State,
    tau: f64,
}

/// A direction in x, w, v and τ.
struct Direction {
    x: Vec<f64>,
    w: Vec<f64>,
    v: Vec<f64>,
    tau: f64,
}

/// A right-hand side: of the equations and of both kinds of products.
struct Target {
    r: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
}

impl Direction {
    /// s·self.
    fn times(mut self, s: f64) -> Direction {
        for part in [&mut self.x, &mut self.w, &mut self.v] {
            part.iter_mut().for_each(|d| *d *= s);
        }
        self.tau *= s;
        self
    }

    /// self + s·other.
    fn plus(mut self, s: f64, other: &Direction) -> Direction {
        let add = |a: &mut Vec<f64>, b: &[f64]| a.iter_mut().zip(b).for_each(|(a, b)| *a += s * b);
        add(&mut self.x, &other.x);
        add(&mut self.w, &other.w);
        add(&mut self.v, &other.v);
        self.tau += s * other.tau;
        self
    }
}

impl Path<'_> {
    /// The solution of J dx − dw + dv = r, w dx + a dw = p, −v dx + b dv = q with dτ as given.
    fn solve(&self, factor: &mut Factor, target: &Target, tau: f64) -> Option<Direction> {
        let (s, n) = (&self.state, self.point.x.len());
        let ratio = |is: bool, p: f64, a: f64| if is { p / a } else { 0.0 };
        let (lower, upper) = (&self.bounds.lower, &self.bounds.upper);
        let low = |i: usize, p: f64| ratio(lower[i], p, s.a[i]);
        let high = |i: usize, q: f64| ratio(upper[i], q, s.b[i]);
        let right: Vec<f64> = (0..n)
            .map(|i| target.r[i] + low(i, target.p[i]) - high(i, target.q[i]))
            .collect();
        let x = factor.solve_to(&right, ENOUGH)?;
        let w = (0..n)
            .map(|i| low(i, target.p[i] - s.w[i] * x[i]))
            .collect();
        let v = (0..n)
            .map(|i| high(i, target.q[i] + s.v[i] * x[i]))
            .collect();
        Some(Direction { x, w, v, tau })
    }

    /// Calls `each` with the value and the changes of every distance, every slack, and τ.
    fn relative(&self, d: &Direction, e: &Direction, mut each: impl FnMut(f64, f64, f64)) {
        each(self.tau, d.tau, e.tau);
        let s = &self.state;
        for i in 0..d.x.len() {
            if self.bounds.lower[i] {
                each(s.a[i], d.x[i], e.x[i]);
                each(s.w[i], d.w[i], e.w[i]);
            }
            if self.bounds.upper[i] {
                each(s.b[i], -d.x[i], -e.x[i]);
                each(s.v[i], d.v[i], e.v[i]);
            }
        }
    }

    /// Scalar product of relative changes.
    fn product(&self, d: &Direction, e: &Direction) -> f64 {
        let mut sum = 0.0;
        self.relative(d, e, |value, d, e| sum += (d / value) * (e / value));
        sum
    }

    /// The largest relative change.
    fn largest(&self, d: &Direction) -> f64 {
        let mut most = 0.0f64;
        self.relative(d, d, |value, d, _| most = most.max((d / value).abs()));
        most
    }

    /// How far a direction may be followed, at most 1.
    fn length(&self, d: &Direction) -> f64 {
        let mut longest = 1.0 / DAMPING;
        self.relative(d, d, |value, d, _| {
            if d < 0.0 {
                longest = longest.min(-value / d);
            }
        });
        DAMPING * longest
    }

    /// The part of `d` orthogonal to the tangent.
    fn orthogonal(&self, d: Direction, tangent: &Direction) -> Direction {
        let along = self.product(&d, tangent) / self.product(tangent, tangent);
        d.plus(-along, tangent)
    }

    /// The step with its second order, where that is the smaller part.
    fn second_order(&self, factor: &mut Factor, step: Direction, tangent: &Direction) -> Direction {
        let zip = |d: &[f64], sign: f64| step.x.iter().zip(d).map(|(a, b)| sign * a * b).collect();
        let products = Target {
            r: vec![0.0; step.x.len()],
            p: zip(&step.w, -1.0),
            q: zip(&step.v, 1.0),
        };
        let Some(second) = self.solve(factor, &products, 0.0) else {
            return step;
        };
        let second = self.orthogonal(second, tangent);
        if self.largest(&second) < self.largest(&step) {
            step.plus(1.0, &second)
        } else {
            step
        }
    }

    /// F − w + v.
    fn equations(&self) -> Vec<f64> {
        let s = &self.state;
        let both = s.w.iter().zip(&s.v);
        self.point
            .f
            .iter()
            .zip(both)
            .map(|(f, (w, v))| f - w + v)
            .collect()
    }

    /// The point a step further; None if F is not defined there.
    fn moved(&self, run: &mut Run, step: &Direction, t: f64) -> Option<Self> {
        let add = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + t * b).collect();
        let point = run.point(add(&self.point.x, &step.x))?;
        let mut state = State {
            w: add(&self.state.w, &step.w),
            v: add(&self.state.v, &step.v),
            ..self.state.clone()
        };
        state.distances(run, self.bounds, &point.x);
        let (bounds, tau) = (self.bounds, self.tau + t * step.tau);
        Some(Path {
            bounds,
            point,
            state,
            tau,
        })
    }

    /// The tangent here, and the way back to the path, with the factors for more; None where the matrix is singular.
    fn directions(
        &self,
        run: &mut Run,
        through: &Target,
        analysis: &Analysis,
    ) -> Option<(Factor, Direction, Direction)> {
        let jacobian = run.jacobian(&self.point.x)?;
        let s = &self.state;
        let diagonal = |i: usize| s.w[i] / s.a[i] + s.v[i] / s.b[i] + PROX.0;
        run.factorisations += 1;
        run.crash_iterations += 1;
        let matrix = combine(&jacobian, diagonal, |_| 1.0);
        let mut factor = Factor::analysed(matrix, run.fill, analysis)?;
        let gap = |goal: &[f64], now: Vec<f64>| -> Vec<f64> {
            let each = goal.iter().zip(now);
            each.map(|(g, n)| self.tau * g - n).collect()
        };
        let missing = Target {
            r: gap(&through.r, self.equations()),
            p: gap(&through.p, products(&s.a, &s.w)),
            q: gap(&through.q, products(&s.b, &s.v)),
        };
        let tangent = self.solve(&mut factor, through, 1.0)?;
        let correction = self.solve(&mut factor, &missing, 0.0)?;
        Some((factor, tangent, correction))
    }
}

fn products(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

/// Follows the path through the point until τ falls freely, and returns the point reached; None if it leads to
/// infinity both ways, or too far.
pub(super) fn around(
    run: &mut Run,
    (point, state): (&Point, &State),
    bounds: &Bounds,
    analysis: &Analysis,
) -> Result<Option<(Point, State)>, Stop> {
    let at_start = || Path {
        bounds,
        point: point.clone(),
        state: state.clone(),
        tau: 1.0,
    };
    let mut path = at_start();
    let through = Target {
        r: path.equations(),
        p: products(&state.a, &state.w),
        q: products(&state.b, &state.v),
    };
    // τ falls at first; if that leads to infinity, it rises.
    let (mut sign, mut turned) = (-1.0, false);
    let (mut change, mut shortened) = (CHANGE.0, false);
    // The tangent of the step before, and where that began.
    let (mut before, mut last): (Option<Direction>, Option<(Path, Option<Direction>)>) =
        (None, None);
    log::note(run, log::Part::Crash, || {
        " arc       tau      slope   change     step".into()
    });
    for iteration in 0..fold_limit(run.n) {
        run.check()?;
        let Some((mut factor, tangent, correction)) = path.directions(run, &through, analysis)
        else {
            return Ok(None);
        };
        // Which way goes on, and the cosine of the angle to the tangent before.
        let turn = before.as_ref().map(|before| {
            let between = path.product(before, &tangent);
            let lengths = path.product(before, before) * path.product(&tangent, &tangent);
            (between.signum(), between.abs() / lengths.sqrt())
        });
        let sure = turn.is_none_or(|(_, cosine)| cosine >= COSINE);
        if !sure
            && change > CHANGE.1
            && let Some((from, tangent)) = last.take()
        {
            (path, before) = (from, tangent);
            (change, shortened) = (0.25 * change, true);
            continue;
        }
        sign = turn.map_or(sign, |t| t.0);
        let scale = sign / path.largest(&tangent);
        let tangent = tangent.times(scale);
        let correction = path.orthogonal(correction, &tangent);
        let off = path.largest(&correction);
        // Far from the path the correction comes first.
        let along = if off > CORRECTION.1 { 0.0 } else { change };
        let step = path.second_order(&mut factor, correction.plus(along, &tangent), &tangent);
        if !std::mem::take(&mut shortened) && off < CORRECTION.0 {
            change = (2.0 * change).min(CHANGE.2);
        } else if off > CORRECTION.1 {
            change = (0.5 * change).max(CHANGE.1);
        }
        let (t, slope) = (path.length(&step), tangent.tau / path.tau);
        let tau = path.tau;
        log::note(run, log::Part::Crash, || {
            format!("{iteration:4} {tau:9.3e} {slope:10.2e} {along:8.1e} {t:8.1e}")
        });
        let Some(next) = path.moved(run, &step, t) else {
            return Ok(None);
        };
        let from = std::mem::replace(&mut path, next);
        if path.tau < DONE.0 && slope < DONE.1 {
            return Ok(Some((path.point, path.state)));
        }
        last = Some((from, before.replace(tangent)));
        if path.tau > INFINITE {
            if std::mem::replace(&mut turned, true) {
                return Ok(None);
            }
            (path, sign, change) = (at_start(), 1.0, CHANGE.0);
            (before, last) = (None, None);
        }
    }
    Ok(None)
}
