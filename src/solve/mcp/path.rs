//! Linear mixed complementarity by a piecewise linear path: Lemke's method generalised to bounds.
//!
//! For the linear problem Mx + q ⟂ l ≤ x ≤ u introduce w ≥ 0 (complementary to x − l) and v ≥ 0
//! (complementary to u − x) and follow, from a start (x⁰, w⁰, v⁰) that satisfies everything but the
//! equation, the solutions of
//!
//! ```text
//! Mx − w + v + t·r = r − q,        r = Mx⁰ + q − w⁰ + v⁰,
//! ```
//!
//! from t = 0 to t = 1, where the covering vector r has vanished. For every index exactly one of
//! x, w, v is *basic* (off its bound); when a basic variable hits a bound it leaves, t holds its
//! place, and its complement enters. Pieces of the path on which t falls are followed too.
//!
//! **Degeneracy.** The start lies strictly inside all its bounds, by random amounts; r absorbs the
//! shift and t = 1 removes it, so it costs no accuracy.
//!
//! **Sparsity.** r is a full column, and a basis matrix that contains it makes every pivot cost n.
//! It is therefore kept out: the slot t occupies (the *hole*) holds a *reference* column instead,
//! one that makes the matrix B regular, and the value of its multiplier is kept at zero:
//!
//! ```text
//! B ξ + t r = b,    ξ = y − t p,    y = B⁻¹b,    p = B⁻¹r,    ξ_hole = 0  ⟹  t = y_hole/p_hole.
//! ```
//!
//! With the direction d = B⁻¹a of the entering column, all of y and p change by multiples of d, which
//! is sparse. After the leaving variable j is known, either the entering column takes slot j (pivot
//! d_j) and the reference stays, or it takes the hole (pivot d_hole) and the leaving column becomes
//! the reference; the larger pivot decides. In skew-symmetric problems (linear programs) every
//! other d_hole is zero, so both moves are needed.

use super::basis::{Basis, Sparse};
use super::linear::{Kind, LinearProblem, Variable, factorise, solve_refined, solves};
use super::random::Random;
use super::run::{Run, Stop};
use crate::model::named::named;

/// How far a bound may be passed in the ratio test, usually and where the solution is close.
pub(super) const HARRIS: f64 = 1e-9;
pub(super) const HARRIS_CLOSE: f64 = 1e-13;
/// A rate of change below this does not block.
const RATE_MIN: f64 = 1e-9;
/// A pivot below this on updated factors asks for fresh ones.
const PIVOT_DOUBTFUL: f64 = 1e-7;
/// A pivot below this is no pivot.
const PIVOT_MIN: f64 = 1e-10;
/// Factorisations for the sake of one doubtful pivot after which a path is given up.
const DOUBTS: usize = 20;
/// Size of the random shift of the start into its bounds.
const SHIFT: f64 = 1e-4;

/// Where a path starts.
#[derive(Debug, Clone)]
pub(super) struct Start {
    pub(super) kind: Vec<Kind>,
    /// Values of the variables that are between their bounds.
    pub(super) x: Vec<f64>,
    /// Cover all slacks by one size, as Lemke's method does, instead of by their own values.
    pub(super) cover: bool,
    /// How far a bound may be passed for the sake of a larger pivot (Harris's ratio test).
    pub(super) tolerance: f64,
}

named! {
    /// How a path ended.
    pub(super) enum PathEnd {
        /// t = 1.
        Solved "solved";
        /// Nothing blocks: a ray.
        Ray "ray";
        /// The path closed on itself.
        Loop "loop";
        /// Too many pivots.
        Limit "limit";
        /// The starting basis is singular.
        Singular "singular";
        /// No acceptable pivot.
        Numerical "numerical";
    }
}

/// The last point of a path.
pub(super) struct PathResult {
    pub(super) end: PathEnd,
    pub(super) x: Vec<f64>,
    pub(super) t: f64,
    pub(super) kind: Vec<Kind>,
    pub(super) pivots: usize,
}

/// What happens first along a direction.
enum Event {
    /// t reaches 1 at this step.
    Target(f64),
    /// The entering variable reaches its other bound.
    Flip(f64),
    /// The variable of a slot reaches a bound (true: the upper one).
    Leave { slot: usize, upper: bool, step: f64 },
    /// Nothing.
    Ray,
}

/// Follows the path. Pivots and factorisations are counted in `run`; `seed` feeds the shifts.
///
/// "Solved" is checked: rounding errors, absorbed on the way, may leave a final basis whose exact
/// solution violates bounds.
pub(super) fn follow(
    run: &mut Run,
    problem: &LinearProblem,
    start: &Start,
    limit: usize,
    seed: u64,
) -> Result<PathResult, Stop> {
    let mut path = Path::new(problem, start, seed);
    let mut end = path.run(run, limit)?;
    let mut x = path.values();
    if end == PathEnd::Solved {
        match path.solution(run) {
            Some(exact) => x = exact,
            None => end = PathEnd::Numerical,
        }
        if end == PathEnd::Solved && !solves(problem, &x) {
            end = PathEnd::Numerical;
        }
    }
    Ok(PathResult {
        end,
        x,
        t: path.t,
        kind: path.kind,
        pivots: path.pivots,
    })
}

/// The state of a path.
struct Path<'a> {
    problem: &'a LinearProblem<'a>,
    n: usize,
    /// The variable in each slot; in the hole, the one whose column is the reference.
    slot: Vec<Variable>,
    /// Bounds of the variable in each slot.
    low: Vec<f64>,
    high: Vec<f64>,
    /// The slot of t, None as long as t = 0.
    hole: Option<usize>,
    kind: Vec<Kind>,
    start_kind: Vec<Kind>,
    /// Number of indices whose kind is not the one they started with.
    moved: usize,
    basis: Option<Basis>,
    r: Vec<f64>,
    y: Vec<f64>,
    p: Vec<f64>,
    t: f64,
    /// Values of the variables x, w, v of each index while they are in no slot: their bounds, but
    /// for what the ratio test let pass. Moving a variable from where it stopped to its bound would
    /// move t by that amount over p_hole, which may be tiny.
    rest: Vec<[f64; 3]>,
    tolerance: f64,
    pivots: usize,
    rate: Vec<f64>,
}

impl<'a> Path<'a> {
    /// Sets up the start: its values, shifted inside, and the covering vector.
    fn new(problem: &'a LinearProblem<'a>, start: &Start, seed: u64) -> Self {
        let n = problem.q.len();
        let mut random = Random::new(seed);
        let mut x0 = vec![0.0; n];
        // Parallel arrays by index, as in the formulas.
        #[allow(clippy::needless_range_loop)]
        for k in 0..n {
            let (l, u) = (problem.lower[k], problem.upper[k]);
            let size = SHIFT * (0.5 + random.uniform());
            x0[k] = match start.kind[k] {
                Kind::AtLower => l,
                Kind::AtUpper => u,
                Kind::Between => {
                    let x = start.x[k].max(l).min(u);
                    let shift = (size * x.abs().clamp(1.0, 10.0)).min(0.25 * (u - l));
                    x.max(l + shift).min(u - shift)
                }
            };
        }
        // r = Mx⁰ + q − w⁰ + v⁰
        let mut r = vec![0.0; n];
        problem.m.matvec(&x0, &mut r);
        r.iter_mut().zip(problem.q).for_each(|(r, q)| *r += q);
        let mut largest = 0.0f64;
        for (k, kind) in start.kind.iter().enumerate() {
            match kind {
                Kind::Between => {}
                Kind::AtLower => largest = largest.max(-r[k]),
                Kind::AtUpper => largest = largest.max(r[k]),
            }
        }
        let cover = (largest + 1.0).max(1.0);
        let mut values = x0;
        #[allow(clippy::needless_range_loop)]
        for k in 0..n {
            let sign = match start.kind[k] {
                Kind::Between => continue,
                Kind::AtLower => 1.0,
                Kind::AtUpper => -1.0,
            };
            let slack = sign * r[k];
            values[k] = if start.cover {
                slack + cover * (1.0 + 0.05 * random.uniform())
            } else {
                slack.max(SHIFT * (0.5 + random.uniform()))
            };
            r[k] = sign * (slack - values[k]);
        }
        let slot: Vec<Variable> = start
            .kind
            .iter()
            .enumerate()
            .map(|(index, &kind)| Variable { index, kind })
            .collect();
        let mut path = Path {
            problem,
            n,
            slot,
            low: vec![0.0; n],
            high: vec![f64::INFINITY; n],
            hole: None,
            kind: start.kind.clone(),
            start_kind: start.kind.clone(),
            moved: 0,
            basis: None,
            r,
            y: values,
            p: vec![0.0; n],
            t: 0.0,
            rest: start
                .kind
                .iter()
                .enumerate()
                .map(|(k, &kind)| {
                    [
                        if kind == Kind::AtUpper {
                            problem.upper[k]
                        } else {
                            problem.lower[k]
                        },
                        0.0,
                        0.0,
                    ]
                })
                .collect(),
            tolerance: start.tolerance,
            pivots: 0,
            rate: vec![0.0; n],
        };
        for k in 0..n {
            path.set_bounds(k);
        }
        path
    }

    /// Copies the bounds of a slot's variable next to its value.
    fn set_bounds(&mut self, slot: usize) {
        let variable = self.slot[slot];
        (self.low[slot], self.high[slot]) = match variable.kind {
            Kind::Between => (
                self.problem.lower[variable.index],
                self.problem.upper[variable.index],
            ),
            _ => (0.0, f64::INFINITY),
        };
    }

    /// Fresh factors, y and p.
    fn refactor(&mut self, run: &mut Run) -> bool {
        self.basis = None;
        let Some(mut basis) = factorise(run, self.problem, &self.slot) else {
            return false;
        };
        // b = r − q − Mx + w − v over the variables that are in no slot.
        let mut rest = self.rest.clone();
        for (s, v) in self.slot.iter().enumerate() {
            if Some(s) != self.hole {
                rest[v.index][v.kind as usize] = 0.0;
            }
        }
        let x: Vec<f64> = rest.iter().map(|r| r[0]).collect();
        let mut b = vec![0.0; self.n];
        self.problem.m.matvec(&x, &mut b);
        for (k, b) in b.iter_mut().enumerate() {
            *b = self.r[k] - self.problem.q[k] - *b + rest[k][1] - rest[k][2];
        }
        let mut p = self.r.clone();
        if !solve_refined(&mut basis, self.problem, &self.slot, &mut b)
            || !solve_refined(&mut basis, self.problem, &self.slot, &mut p)
        {
            return false;
        }
        self.y = b;
        self.p = p;
        if let Some(h) = self.hole {
            // The rounding error goes into the place where the reference rests, not into t.
            let v = self.slot[h];
            self.rest[v.index][v.kind as usize] += self.y[h] - self.t * self.p[h];
            self.y[h] = self.t * self.p[h];
        }
        self.basis = Some(basis);
        true
    }

    /// Pivots until t = 1, a ray, a loop or the limit.
    fn run(&mut self, run: &mut Run, limit: usize) -> Result<PathEnd, Stop> {
        if !self.refactor(run) {
            return Ok(PathEnd::Singular);
        }
        // First t itself enters; nothing is in the hole yet.
        for i in 0..self.n {
            self.rate[i] = -self.p[i];
        }
        let mut leaving = match self.ratio_all(1.0, f64::INFINITY) {
            Event::Target(_) => {
                self.t = 1.0;
                return Ok(PathEnd::Solved);
            }
            Event::Leave { slot, upper, step } => {
                self.t += step;
                self.hole = Some(slot);
                self.come_to_rest(slot);
                (self.slot[slot], upper)
            }
            Event::Flip(_) | Event::Ray => return Ok(PathEnd::Ray),
        };
        let (mut direction, mut doubts) = (Sparse::default(), 0);
        loop {
            run.pivots += 1;
            self.pivots += 1;
            if self.pivots > limit {
                return Ok(PathEnd::Limit);
            }
            if self.pivots.is_multiple_of(32) {
                run.check()?;
            }
            // The complement of what left enters, from its bound.
            let (entering, sign) = self.complement(leaving);
            self.set_kind(entering.index, entering.kind);
            if self.moved == 0 {
                return Ok(PathEnd::Loop);
            }
            let column: Sparse = self.problem.column(entering).collect();
            leaving = loop {
                let old = self.basis.as_ref().is_none_or(Basis::is_old);
                if old && !self.refactor(run) {
                    return Ok(PathEnd::Numerical);
                }
                let (Some(hole), Some(basis)) = (self.hole, self.basis.as_mut()) else {
                    return Ok(PathEnd::Numerical);
                };
                if !basis.solve_sparse(&column, &mut direction) {
                    return Ok(PathEnd::Numerical);
                }
                let fresh = basis.updates() == 0;
                let at = |slot: usize| direction.iter().find(|d| d.0 == slot).map_or(0.0, |d| d.1);
                let at_hole = at(hole);
                let event = self.event(&direction, sign, hole, at_hole, entering);
                match event {
                    Event::Ray => return Ok(PathEnd::Ray),
                    Event::Target(step) => {
                        self.advance(&direction, entering, sign * step);
                        self.t = 1.0;
                        return Ok(PathEnd::Solved);
                    }
                    Event::Flip(step) => {
                        self.advance(&direction, entering, sign * step);
                        break (entering, sign > 0.0);
                    }
                    Event::Leave { slot, upper, step } => {
                        let at_slot = at(slot);
                        let pivot = at_slot.abs().max(at_hole.abs());
                        if pivot < PIVOT_DOUBTFUL && !fresh {
                            doubts += 1;
                            if doubts > DOUBTS || !self.refactor(run) {
                                return Ok(PathEnd::Numerical);
                            }
                            continue;
                        }
                        if pivot < PIVOT_MIN {
                            return Ok(PathEnd::Numerical);
                        }
                        self.advance(&direction, entering, sign * step);
                        let gone = self.slot[slot];
                        self.exchange(
                            &direction,
                            entering,
                            slot,
                            hole,
                            (at_slot, at_hole),
                            &column,
                        );
                        break (gone, upper);
                    }
                }
            };
        }
    }

    /// The variable that enters when another has left, and the direction of its motion.
    fn complement(&self, (left, upper): (Variable, bool)) -> (Variable, f64) {
        let other = |kind| Variable {
            index: left.index,
            kind,
        };
        match (left.kind, upper) {
            (Kind::Between, false) => (other(Kind::AtLower), 1.0),
            (Kind::Between, true) => (other(Kind::AtUpper), 1.0),
            (Kind::AtLower, _) => (other(Kind::Between), 1.0),
            (Kind::AtUpper, _) => (other(Kind::Between), -1.0),
        }
    }

    fn set_kind(&mut self, index: usize, kind: Kind) {
        let home = self.start_kind[index];
        self.moved -= usize::from(self.kind[index] != home);
        self.moved += usize::from(kind != home);
        self.kind[index] = kind;
    }

    /// The first event along the motion of the entering variable.
    fn event(
        &mut self,
        direction: &Sparse,
        sign: f64,
        hole: usize,
        at_hole: f64,
        entering: Variable,
    ) -> Event {
        let range = match entering.kind {
            Kind::Between => {
                self.problem.upper[entering.index] - self.problem.lower[entering.index]
            }
            _ => f64::INFINITY,
        };
        let tau = -sign * at_hole / self.p[hole];
        if tau == 0.0 {
            // t stands still and only what the direction touches moves.
            for &(i, d) in direction {
                self.rate[i] = -sign * d;
            }
            self.rate[hole] = 0.0;
            return self.ratio(direction.iter().map(|d| d.0), 0.0, range);
        }
        for (rate, p) in self.rate.iter_mut().zip(&self.p) {
            *rate = -tau * p;
        }
        for &(i, d) in direction {
            self.rate[i] -= sign * d;
        }
        self.rate[hole] = 0.0;
        self.ratio_all(tau, range)
    }

    fn ratio_all(&self, tau: f64, range: f64) -> Event {
        self.ratio(0..self.n, tau, range)
    }

    /// Two-pass ratio test of Harris over the given slots, whose rates of change are in `rate`.
    fn ratio(&self, slots: impl Iterator<Item = usize> + Clone, tau: f64, range: f64) -> Event {
        // Distance to the bound a slot's variable moves towards.
        let distance = |i: usize, rate: f64| {
            let value = self.y[i] - self.t * self.p[i];
            if rate < 0.0 {
                value - self.low[i]
            } else {
                self.high[i] - value
            }
        };
        let mut longest = f64::INFINITY;
        for i in slots.clone() {
            let rate = self.rate[i];
            if rate.abs() > RATE_MIN {
                let step = (distance(i, rate).max(0.0) + self.tolerance) / rate.abs();
                if step < longest {
                    longest = step;
                }
            }
        }
        if tau > 0.0 {
            let step = (1.0 - self.t) / tau;
            if step <= longest && step <= range {
                return Event::Target(step.max(0.0));
            }
        }
        if range <= longest {
            return if range.is_finite() {
                Event::Flip(range)
            } else {
                Event::Ray
            };
        }
        let (mut best, mut largest) = (None, 0.0f64);
        for i in slots {
            let rate = self.rate[i];
            if rate.abs() > largest.max(RATE_MIN) {
                let step = distance(i, rate) / rate.abs();
                if step <= longest {
                    largest = rate.abs();
                    best = Some((i, rate > 0.0, step.max(0.0)));
                }
            }
        }
        match best {
            Some((slot, upper, step)) => Event::Leave { slot, upper, step },
            None => Event::Ray,
        }
    }

    /// Moves the entering variable, and with it all others.
    fn advance(&mut self, direction: &Sparse, entering: Variable, by: f64) {
        for &(i, d) in direction {
            self.y[i] -= by * d;
        }
        self.rest[entering.index][entering.kind as usize] += by;
        if let Some(h) = self.hole
            && self.p[h] != 0.0
        {
            self.t = self.y[h] / self.p[h];
        }
    }

    /// The variable of a slot comes to rest where it is and its column becomes the reference.
    fn come_to_rest(&mut self, slot: usize) {
        let v = self.slot[slot];
        let reference = self.t * self.p[slot];
        self.rest[v.index][v.kind as usize] = self.y[slot] - reference;
        self.y[slot] = reference;
    }

    /// Brings the entering column into the basis in place of the leaving one (slot) or of the
    /// reference (hole), whichever pivot is larger.
    fn exchange(
        &mut self,
        direction: &Sparse,
        entering: Variable,
        slot: usize,
        hole: usize,
        (at_slot, at_hole): (f64, f64),
        column: &Sparse,
    ) {
        self.come_to_rest(slot);
        let (place, pivot) = if at_slot.abs() >= at_hole.abs() {
            (slot, at_slot)
        } else {
            (hole, at_hole)
        };
        if place == hole {
            self.hole = Some(slot);
        }
        let (fy, fp) = (self.y[place] / pivot, self.p[place] / pivot);
        for &(i, d) in direction {
            self.y[i] -= fy * d;
            self.p[i] -= fp * d;
        }
        self.y[place] = self.rest[entering.index][entering.kind as usize] + fy;
        self.p[place] = fp;
        self.slot[place] = entering;
        self.set_bounds(place);
        if let Some(basis) = self.basis.as_mut()
            && !basis.replace(place, column, direction)
        {
            self.basis = None;
        }
    }

    /// x at the current point of the path.
    fn values(&self) -> Vec<f64> {
        let mut x: Vec<f64> = self.rest.iter().map(|r| r[0]).collect();
        for (s, v) in self.slot.iter().enumerate() {
            if v.kind == Kind::Between && Some(s) != self.hole {
                x[v.index] = self.y[s] - self.t * self.p[s];
            }
        }
        x
    }

    /// The solution from the final basis alone, without the covering vector.
    fn solution(&self, run: &mut Run) -> Option<Vec<f64>> {
        let slot: Vec<Variable> = self
            .kind
            .iter()
            .enumerate()
            .map(|(index, &kind)| Variable { index, kind })
            .collect();
        let mut basis = factorise(run, self.problem, &slot)?;
        let mut x: Vec<f64> = (0..self.n)
            .map(|k| match self.kind[k] {
                Kind::Between => 0.0,
                Kind::AtLower => self.problem.lower[k],
                Kind::AtUpper => self.problem.upper[k],
            })
            .collect();
        let mut b = vec![0.0; self.n];
        self.problem.m.matvec(&x, &mut b);
        for (b, q) in b.iter_mut().zip(self.problem.q) {
            *b = -q - *b;
        }
        if !solve_refined(&mut basis, self.problem, &slot, &mut b) {
            return None;
        }
        for k in 0..self.n {
            if self.kind[k] == Kind::Between {
                x[k] = b[k].max(self.problem.lower[k]).min(self.problem.upper[k]);
            }
        }
        Some(x)
    }
}
