//! Linear problems: single paths from many starts.
//!
//! Where M is not monotone, a path may end in a ray or close on itself, but which ones do depends
//! on the start. A start with few, large variables off their bounds is the way into games, whose M
//! has no negative entry: far out all slacks are positive, the path comes in from a ray and, as in
//! the method of Lemke and Howson, has nowhere else to go than a solution.

use super::linear::{Kind, LinearProblem};
use super::log;
use super::majors::pivot_limit;
use super::path::{HARRIS, PathEnd, Start, follow};
use super::random::Random;
use super::run::{End, Point, Run, Stop};

/// Paths tried.
const ATTEMPTS: u64 = 40;

/// Follows paths of the linearisation at `start` until the end of one solves the problem.
pub(super) fn starts(run: &mut Run, start: Point) -> Result<End, Stop> {
    let Some(m) = run.jacobian(&start.x) else {
        return Ok(End::Stuck);
    };
    let mut q = vec![0.0; run.n];
    m.matvec(&start.x, &mut q);
    q.iter_mut().zip(&start.f).for_each(|(q, f)| *q = f - *q);
    if q.iter().any(|v| !v.is_finite()) {
        return Ok(End::Stuck);
    }
    log::note(run, log::Part::Majors, || "Paths from random starts".into());
    let (lower, upper) = (run.lower.clone(), run.upper.clone());
    let linear = LinearProblem {
        m: &m,
        q: &q,
        lower: &lower,
        upper: &upper,
    };
    let mut random = Random::new(11);
    for attempt in 0..ATTEMPTS {
        run.check()?;
        // Ever more variables off their bounds: two at first, a share of all of them later.
        let share = match attempt % 4 {
            0 => 0.0,
            1 => 0.1,
            2 => 0.3,
            _ => 0.6,
        };
        let size = 10f64.powf(random.between(-1.0, 2.0));
        let mut kind = Vec::with_capacity(run.n);
        let mut x = Vec::with_capacity(run.n);
        for i in 0..run.n {
            let (l, u) = (lower[i], upper[i]);
            let inside = random.uniform() < share || !(l.is_finite() || u.is_finite());
            let distance = size * random.uniform();
            let (k, value) = match (inside, l.is_finite()) {
                (true, true) => (
                    Kind::Between,
                    (l + distance).min(0.5 * l + 0.5 * u.min(1e300)),
                ),
                (true, false) if u.is_finite() => (Kind::Between, u - distance),
                (true, false) => (Kind::Between, start.x[i]),
                (false, true) => (Kind::AtLower, l),
                (false, false) => (Kind::AtUpper, u),
            };
            kind.push(k);
            x.push(value);
        }
        if share == 0.0 {
            push_off(&mut random, &m, &lower, &upper, &mut kind, &mut x);
        }
        let limit = pivot_limit(run.n);
        let path = follow(
            run,
            &linear,
            &Start {
                kind,
                x,
                cover: false,
                tolerance: HARRIS,
            },
            limit,
            100 + attempt,
        )?;
        log::try_line(run, path.end, path.t, 0.0, path.pivots, false);
        if path.end == PathEnd::Solved
            && let Some(point) = run.point(path.x)
            && run.converged(point.residual)
        {
            return Ok(End::Solved);
        }
    }
    Ok(End::Limit)
}

/// Takes one variable far off its bound, and the one whose row it pushes up most.
fn push_off(
    random: &mut Random,
    m: &feral::SparseColMatrix,
    lower: &[f64],
    upper: &[f64],
    kind: &mut [Kind],
    x: &mut [f64],
) {
    let n = kind.len();
    let mut index = (random.uniform() * n as f64) as usize % n;
    for _ in 0..2 {
        if lower[index].is_finite() && upper[index] == f64::INFINITY {
            kind[index] = Kind::Between;
            x[index] = lower[index] + 1e3;
        }
        let (rows, values) = m.column(index);
        let entries = rows.iter().zip(values).filter(|(r, _)| **r != index);
        let Some((row, _)) = entries.max_by(|a, b| a.1.total_cmp(b.1)) else {
            return;
        };
        index = *row;
    }
}
