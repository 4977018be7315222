//! From an interior point to a vertex: the push phase of a crossover (Megiddo 1991; Bixby &
//! Saltzman 1994).
//!
//! Two pushes lead from a point on the optimal face and multipliers for it to an optimal basis. Near a vertex
//! of the face they are short if all that is strictly between its bounds is basic, so that comes first.
//!
//! *Values*: the nonbasic variables that are not at a bound move to their nearest ones, all together: most
//! of them have hardly any way to go, and one solve with the basis moves thousands. Where a basic variable
//! reaches its bound first, it leaves the basis for the one of the moving variables that does most of its motion,
//! and the rest goes on; after some steps of this kind each of those with a way to go moves for itself, which
//! takes as many pivots but a solve with one column each. Variables that the multipliers hold at a bound do not move, or the point would leave
//! the optimal face; in the end it is a vertex of that face.
//!
//! *Multipliers*: the reduced costs of the basic variables go to 0, again all together. Where that of a
//! nonbasic variable would change its sign first, the variable enters the basis for one of them, which is at
//! its bound: the vertex stays where it is. After some steps, again, one after the other.

use super::factor::{Entries, Factor, ZERO};
use super::{Basis, NONBASIC, PIVOT, SAFE_PIVOT, Simplex};
use crate::solve::lp::Ended;
use std::collections::HashSet;

/// What violates its bound, or its sign, by more does not block: it is left to the simplex method.
const OUTSIDE: f64 = 1e-6;

/// Weight of a row whose logical may well be basic.
const UNHELD: f64 = 1.0 / 4096.0;

/// Where a crossover begins: one entry per column, then one per row.
#[derive(Clone, Debug)]
pub struct Start {
    /// The basis.
    pub basis: Basis,
    /// What is between its bounds, and should be basic if it can.
    pub inside: Vec<bool>,
    /// The point is a vertex of a wide face, and the rest of the basis stems from the face.
    pub of_face: bool,
    /// Values, near a solution of the equations.
    pub value: Vec<f64>,
    /// What stays at its nearest bound.
    pub held: Vec<bool>,
    /// Multipliers of the rows.
    pub y: Vec<f64>,
}

impl Simplex {
    /// Pushes the values, then the multipliers. Err: it could not be done.
    pub fn push(
        &mut self,
        start: &Start,
        stop: &mut dyn FnMut(u64) -> Option<Ended>,
    ) -> Result<(), Ended> {
        self.set_basis(&start.basis);
        self.work_cost.copy_from_slice(&self.cost);
        self.work_lower.copy_from_slice(&self.lower);
        self.work_upper.copy_from_slice(&self.upper);
        for (j, &v) in start.value.iter().enumerate() {
            self.x[j] = v.max(self.lower[j]).min(self.upper[j]);
            if start.held[j] {
                let bound = self.resting(j, self.x[j]);
                (self.work_lower[j], self.work_upper[j]) = (bound, bound);
            }
        }
        // Where there is far to go, a nearly dependent basis gives wrong values.
        let far = self.far().next().is_some();
        self.crossing = Some(if far { SAFE_PIVOT } else { ZERO });
        let ready = self.bring_inside(start);
        let mut done = ready.ok_or(Ended::Failed);
        if done.is_ok() {
            done = self.push_values(stop);
        }
        self.work_lower.copy_from_slice(&self.lower);
        self.work_upper.copy_from_slice(&self.upper);
        if done.is_ok() {
            done = self.push_multipliers(&start.y, stop);
        }
        self.crossing = None;
        // On the way values may have been kept that the basis does not have.
        done.and_then(|()| self.compute_values().ok_or(Ended::Failed))
    }

    /// Factorises the first basis. Where variables at their bounds have displaced some from inside, which depend on
    /// them, those from inside take the basis alone, and the logicals of the rows that they leave complete it: what is
    /// out of the basis has far to go otherwise, and every step of its way is blocked.
    fn bring_inside(&mut self, start: &Start) -> Option<()> {
        let all = (0..self.n + self.m).filter(|&j| start.inside[j]);
        let inside: Vec<u32> = all.map(|j| j as u32).collect();
        if inside.len() >= self.m {
            return self.refactor();
        }
        // At a vertex of a wide face some always are.
        if !start.of_face {
            self.refactor()?;
            if inside.iter().all(|&j| self.slot[j as usize] != NONBASIC) {
                return Some(());
            }
        }
        // A row is left the rather if no multiplier holds its logical at a bound: its pivots look small.
        let weight = |i: usize| if start.held[self.n + i] { 1.0 } else { UNHELD };
        let weighted = |&j: &u32| -> Entries {
            let column = self.column(j as usize).into_iter();
            column.map(|(i, a)| (i, a * weight(i))).collect()
        };
        let columns: Vec<Entries> = inside.iter().map(weighted).collect();
        let (rows, dependent) = Factor::without_pivots(self.m, columns)?;
        let dependent: HashSet<usize> = dependent.into_iter().collect();
        let mut basic: Vec<u32> = (inside.into_iter().enumerate())
            .filter_map(|(k, j)| (!dependent.contains(&k)).then_some(j))
            .collect();
        basic.extend(rows.into_iter().map(|row| (self.n + row) as u32));
        let different: HashSet<u32> = basic.iter().copied().collect();
        if different.len() != self.m || basic.len() != self.m {
            return self.refactor();
        }
        self.head = basic;
        self.slot.fill(NONBASIC);
        for (slot, &j) in self.head.iter().enumerate() {
            self.slot[j as usize] = slot as u32;
        }
        self.refactor()
    }

    fn push_values(&mut self, stop: &mut dyn FnMut(u64) -> Option<Ended>) -> Result<(), Ended> {
        let steps = together(self.far().count());
        if self.until_arrived(steps, stop, Self::push_values_step)? {
            return Ok(());
        }
        let far: Vec<usize> = self.far().collect();
        for (count, j) in far.into_iter().enumerate() {
            ask(stop, count, self.iterations)?;
            self.push_value(j).ok_or(Ended::Failed)?;
        }
        self.finish_push(stop, Self::push_values_step)
    }

    fn push_multipliers(
        &mut self,
        y: &[f64],
        stop: &mut dyn FnMut(u64) -> Option<Ended>,
    ) -> Result<(), Ended> {
        let mut d: Vec<f64> = (0..self.n + self.m).map(|j| self.price(j, y)).collect();
        // What is inside its bounds stays basic; its reduced cost is what the interior point left.
        let inside = self.head.iter().map(|&j| match d[j as usize] {
            v if self.may_rest(j as usize, v) => 0.0,
            v => v,
        });
        let rate = self.rates(inside.collect()).ok_or(Ended::Failed)?;
        d.iter_mut().zip(&rate).for_each(|(d, r)| *d += r);
        let basic = self.head.clone();
        let far = basic.iter().filter(|&&j| self.must_rest(j as usize, &d));
        let steps = together(far.count());
        if self.until_arrived(steps, stop, |s| s.push_multipliers_step(&mut d))? {
            return Ok(());
        }
        for (count, &j) in basic.iter().enumerate() {
            ask(stop, count, self.iterations)?;
            self.push_multiplier(j as usize, &mut d)
                .ok_or(Ended::Failed)?;
        }
        self.finish_push(stop, |s| s.push_multipliers_step(&mut d))
    }

    /// At most so many steps of a push: whether all arrived.
    fn until_arrived(
        &mut self,
        steps: usize,
        stop: &mut dyn FnMut(u64) -> Option<Ended>,
        mut step: impl FnMut(&mut Self) -> Option<bool>,
    ) -> Result<bool, Ended> {
        for count in 0..steps {
            ask(stop, count, self.iterations)?;
            if step(self).ok_or(Ended::Failed)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// A push that takes more steps than there are variables goes round in circles: pivots on the border of
    /// being none.
    fn finish_push(
        &mut self,
        stop: &mut dyn FnMut(u64) -> Option<Ended>,
        step: impl FnMut(&mut Self) -> Option<bool>,
    ) -> Result<(), Ended> {
        match self.until_arrived(self.n + self.m, stop, step)? {
            true => Ok(()),
            false => Err(Ended::Failed),
        }
    }

    /// What a nonbasic variable has to go.
    fn way(&self, j: usize) -> f64 {
        match self.slot[j] {
            NONBASIC => self.resting(j, self.x[j]) - self.x[j],
            _ => 0.0,
        }
    }

    /// The nonbasic variables that have a way to go.
    fn far(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.n + self.m).filter(|&j| self.way(j).abs() > self.tolerance)
    }

    /// Moves all as far as the basic variables allow, and pivots there. True: all arrived.
    fn push_values_step(&mut self) -> Option<bool> {
        let moving: Vec<(usize, f64)> = (0..self.n + self.m)
            .map(|j| (j, self.way(j)))
            .filter(|w| w.1 != 0.0)
            .collect();
        let mut rate = vec![0.0; self.m];
        for &(j, way) in &moving {
            if j < self.n {
                self.columns.line(j).for_each(|(i, a)| rate[i] += a * way);
            } else {
                rate[j - self.n] -= way;
            }
        }
        self.factor.as_mut()?.forward_dense(&mut rate)?;
        let rates = rate.iter().copied().enumerate();
        let (step, blocking) = self.first_block(rates.filter(|e| e.1 != 0.0));
        for (k, r) in rate.iter().enumerate() {
            self.x[self.head[k] as usize] -= step * r;
        }
        for &(j, way) in &moving {
            self.x[j] = match blocking {
                None => self.resting(j, self.x[j]),
                Some(_) => self.x[j] + step * way,
            };
        }
        let Some(slot) = blocking else {
            return Some(true);
        };
        let rho = self.factor.as_mut()?.backward(&[(slot, 1.0)])?.clone();
        self.pivot_row(&rho);
        let least = self.least_pivot();
        let mut entering = (0.0, None);
        for &j in &self.row_index {
            let j = j as usize;
            let part = (self.row[j] * self.way(j)).abs();
            if part > entering.0 && self.row[j].abs() > least {
                entering = (part, Some(j));
            }
        }
        let Some(entering) = entering.1 else {
            return self.refreshed();
        };
        let leaving = self.head[slot] as usize;
        self.x[leaving] = match rate[slot] > 0.0 {
            true => self.work_lower[leaving],
            false => self.work_upper[leaving],
        };
        self.iterations += 1;
        self.exchange(slot, entering)?;
        Some(false)
    }

    /// Moves one variable to its bound, or into the basis for what stops it.
    fn push_value(&mut self, entering: usize) -> Option<()> {
        let way = self.way(entering);
        if way == 0.0 {
            return Some(());
        }
        let a_q = self.column(entering);
        let column = self.factor.as_mut()?.forward(&a_q)?.clone();
        let rates = column.iter().filter(|e| e.1.abs() > PIVOT);
        let rates = rates.map(|&(k, a)| (k, a * way));
        let (step, blocking) = self.first_block(rates);
        if let Some(slot) = blocking {
            let pivot = column.iter().find(|e| e.0 == slot).map_or(0.0, |e| e.1);
            if pivot.abs() <= self.least_pivot() {
                self.refreshed()?;
                return self.push_value(entering);
            }
        }
        for &(k, a) in &column {
            self.x[self.head[k] as usize] -= step * way * a;
        }
        self.x[entering] = match blocking {
            None => self.resting(entering, self.x[entering]),
            Some(_) => self.x[entering] + step * way,
        };
        let Some(slot) = blocking else {
            return Some(());
        };
        let leaving = self.head[slot] as usize;
        self.x[leaving] = self.resting(leaving, self.x[leaving]);
        self.iterations += 1;
        self.exchange(slot, entering)
    }

    /// How much of the way slots with these rates can go, and the one that ends it.
    fn first_block(
        &self,
        rates: impl Iterator<Item = (usize, f64)> + Clone,
    ) -> (f64, Option<usize>) {
        let room = |k: usize, rate: f64| {
            let j = self.head[k] as usize;
            match rate > 0.0 {
                true => self.x[j] - self.work_lower[j],
                false => self.work_upper[j] - self.x[j],
            }
        };
        first(rates.map(|(k, r)| (k, room(k, r), r.abs())), self.tolerance)
    }

    /// Moves the reduced costs of all basic variables as far as the others allow, and pivots there. True:
    /// all arrived.
    fn push_multipliers_step(&mut self, d: &mut [f64]) -> Option<bool> {
        let part = self.head.iter().map(|&j| d[j as usize]).collect();
        let rate = self.rates(part)?;
        let rates = rate.iter().copied().enumerate();
        let (step, blocking) = self.first_sign(d, rates.filter(|e| e.1 != 0.0));
        d.iter_mut().zip(&rate).for_each(|(d, r)| *d += step * r);
        let Some(entering) = blocking else {
            return Some(true);
        };
        let a_q = self.column(entering);
        let column = self.factor.as_mut()?.forward(&a_q)?.clone();
        let least = self.least_pivot();
        let mut leaving = (0.0, None);
        for &(slot, a) in &column {
            let j = self.head[slot] as usize;
            let part = (a * d[j]).abs();
            if part > leaving.0 && a.abs() > least && self.may_rest(j, d[j]) {
                leaving = (part, Some(slot));
            }
        }
        let Some(slot) = leaving.1 else {
            return self.refreshed();
        };
        let leaving = self.head[slot] as usize;
        self.x[leaving] = self.resting(leaving, self.x[leaving]);
        d[entering] = 0.0;
        self.iterations += 1;
        self.exchange(slot, entering)?;
        Some(false)
    }

    /// Moves the reduced cost of one basic variable at its bound to 0, or the variable out of the basis for the one
    /// whose sign stops it.
    fn push_multiplier(&mut self, leaving: usize, d: &mut [f64]) -> Option<()> {
        if !self.must_rest(leaving, d) {
            return Some(());
        }
        let (way, slot) = (d[leaving], self.slot[leaving] as usize);
        let rho = self.factor.as_mut()?.backward(&[(slot, 1.0)])?.clone();
        self.pivot_row(&rho);
        let entries = self
            .row_index
            .iter()
            .map(|&j| (j as usize, self.row[j as usize]));
        let entries = entries.filter(|e| e.1.abs() > PIVOT);
        let (step, blocking) = self.first_sign(d, entries.clone().map(|(j, a)| (j, -a * way)));
        if blocking.is_some_and(|j| self.row[j].abs() <= self.least_pivot()) {
            self.refreshed()?;
            return self.push_multiplier(leaving, d);
        }
        entries.for_each(|(j, a)| d[j] -= step * way * a);
        d[leaving] -= step * way;
        let Some(entering) = blocking else {
            return Some(());
        };
        d[entering] = 0.0;
        self.x[leaving] = self.resting(leaving, self.x[leaving]);
        self.iterations += 1;
        self.exchange(slot, entering)
    }

    /// How the reduced costs of all variables change while those of the slots change by −`part`.
    fn rates(&mut self, mut part: Vec<f64>) -> Option<Vec<f64>> {
        self.factor.as_mut()?.backward_dense(&mut part)?;
        let mut rate = vec![0.0; self.n + self.m];
        for (i, &y) in part.iter().enumerate().filter(|e| *e.1 != 0.0) {
            self.rows.line(i).for_each(|(j, a)| rate[j] -= a * y);
            rate[self.n + i] += y;
        }
        Some(rate)
    }

    /// Whether a variable is at a bound where it may have this reduced cost.
    fn may_rest(&self, j: usize, d: f64) -> bool {
        let (l, u, x) = (self.work_lower[j], self.work_upper[j], self.x[j]);
        (d > 0.0 && x - l <= OUTSIDE) || (d < 0.0 && u - x <= OUTSIDE)
    }

    /// Whether a variable is basic at a bound with a reduced cost that holds it there.
    fn must_rest(&self, j: usize, d: &[f64]) -> bool {
        self.slot[j] != NONBASIC && d[j].abs() > self.dual_tolerance && self.may_rest(j, d[j])
    }

    /// How much of their way reduced costs with these rates can go, and the variable whose sign ends it.
    fn first_sign(
        &self,
        d: &[f64],
        rates: impl Iterator<Item = (usize, f64)> + Clone,
    ) -> (f64, Option<usize>) {
        let candidates = rates.filter_map(|(j, rate)| {
            let (l, u) = (self.work_lower[j], self.work_upper[j]);
            if self.slot[j] != NONBASIC || l == u {
                return None;
            }
            let free = l.is_infinite() && u.is_infinite();
            let low = self.is_low(j);
            let room = match low {
                _ if free => -d[j].abs(),
                true => d[j],
                false => -d[j],
            };
            let blocks = free || (rate < 0.0) == low;
            blocks.then_some((j, room, rate.abs()))
        });
        first(candidates, self.dual_tolerance)
    }

    /// The smallest pivot that is taken now.
    fn least_pivot(&self) -> f64 {
        match self.is_fresh() {
            true => 100.0 * PIVOT,
            false => SAFE_PIVOT,
        }
    }

    /// No pivot was good enough: perhaps one is on a fresh factor.
    fn refreshed(&mut self) -> Option<bool> {
        if self.is_fresh() {
            return None;
        }
        self.refactor()?;
        Some(false)
    }
}

/// Steps that all make together, of so many with a way to go, before one after the other makes its own. Where all are
/// near their ends some of these lead there; else each costs a dense solve and hardly leads on.
fn together(far: usize) -> usize {
    (far / 64).max(8)
}

/// Asks now and then whether to stop.
fn ask(
    stop: &mut dyn FnMut(u64) -> Option<Ended>,
    count: usize,
    iterations: u64,
) -> Result<(), Ended> {
    match count.is_multiple_of(32).then(|| stop(iterations)).flatten() {
        Some(why) => Err(why),
        None => Ok(()),
    }
}

/// Harris's ratio test over things with room and a rate at which they use it: how much of a step of 1 can be
/// gone, and the thing that ends it.
fn first(
    things: impl Iterator<Item = (usize, f64, f64)> + Clone,
    slack: f64,
) -> (f64, Option<usize>) {
    let things = things.filter(|t| t.1 > -OUTSIDE);
    let limit = things
        .clone()
        .map(|(_, room, rate)| (room.max(0.0) + slack) / rate)
        .fold(1.0, f64::min);
    if limit == 1.0 {
        return (1.0, None);
    }
    let first = things
        .filter(|&(_, room, rate)| room <= limit * rate)
        .max_by(|a, b| a.2.total_cmp(&b.2));
    match first {
        Some((k, room, rate)) => ((room.max(0.0) / rate).min(1.0), Some(k)),
        None => (1.0, None),
    }
}
