//! From an interior point to a vertex: the push phase of a crossover (Megiddo 1991; Bixby &
//! Saltzman 1994).
//!
//! Given values for all variables and a basis, each nonbasic variable that is not at a bound moves
//! to its nearest one. Where a basic variable reaches its bound first, the two change places. The
//! point stays feasible, and on the optimal face if it was there; in the end it is a vertex.

use super::{NONBASIC, PIVOT, SAFE_PIVOT, Simplex, State};
use crate::solve::lp::Ended;

impl Simplex {
    /// Starts from a basis and values of all variables, and pushes. Err: it could not be done.
    pub fn push(
        &mut self,
        basis: &[State],
        values: &[f64],
        stop: &mut dyn FnMut(u64) -> Option<Ended>,
    ) -> Result<(), Ended> {
        self.set_basis(basis);
        self.work_cost.copy_from_slice(&self.cost);
        self.work_lower.copy_from_slice(&self.lower);
        self.work_upper.copy_from_slice(&self.upper);
        for (j, &v) in values.iter().enumerate() {
            self.x[j] = v.max(self.lower[j]).min(self.upper[j]);
        }
        self.keep_values = true;
        let done = self.push_all(stop);
        self.keep_values = false;
        done
    }

    fn push_all(&mut self, stop: &mut dyn FnMut(u64) -> Option<Ended>) -> Result<(), Ended> {
        self.refactor().ok_or(Ended::Failed)?;
        // The nearest to their bounds first: they are the likeliest to belong there.
        let mut pending: Vec<(f64, u32)> = (0..self.n + self.m)
            .filter(|&j| self.slot[j] == NONBASIC)
            .map(|j| {
                let down = self.x[j] - self.lower[j];
                let up = self.upper[j] - self.x[j];
                (down.min(up), j as u32)
            })
            .filter(|p| p.0 > 0.0)
            .collect();
        pending.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (k, &(_, j)) in pending.iter().enumerate() {
            if k.is_multiple_of(32)
                && let Some(why) = stop(self.iterations)
            {
                return Err(why);
            }
            let j = j as usize;
            if self.slot[j] == NONBASIC {
                self.push_one(j).ok_or(Ended::Failed)?;
            }
        }
        Ok(())
    }

    /// Moves one variable to a bound, or into the basis.
    fn push_one(&mut self, j: usize) -> Option<()> {
        // Every round either arrives or pivots; a second round only follows a fresh factor.
        for _ in 0..3 {
            let target = self.resting(j, self.x[j]);
            let way = target - self.x[j];
            if way == 0.0 {
                return Some(());
            }
            let sigma = way.signum();
            let a_q = self.column(j);
            let column = self.factor.as_mut()?.forward(&a_q)?.clone();
            let distance = |k: usize, rate: f64| {
                let b = self.head[k] as usize;
                let room = if rate > 0.0 {
                    self.x[b] - self.work_lower[b]
                } else {
                    self.work_upper[b] - self.x[b]
                };
                room.max(0.0) / rate.abs()
            };
            let mut limit = way.abs();
            let slack = self.tolerance;
            for &(k, a) in &column {
                let rate = sigma * a;
                if rate.abs() > PIVOT {
                    limit = limit.min(distance(k, rate) + slack / rate.abs());
                }
            }
            let mut best = (0.0, 0);
            if limit < way.abs() {
                for &(k, a) in &column {
                    let rate = sigma * a;
                    if rate.abs() > best.0 && rate.abs() > PIVOT && distance(k, rate) <= limit {
                        best = (rate.abs(), k);
                    }
                }
            }
            let (size, slot) = best;
            if size == 0.0 {
                for &(k, a) in &column {
                    self.x[self.head[k] as usize] -= way * a;
                }
                self.x[j] = target;
                return Some(());
            }
            let fresh = self.factor.as_ref().is_some_and(|f| f.updates() == 0);
            if size < SAFE_PIVOT && !fresh {
                self.refactor()?;
                continue;
            }
            let rate = sigma * column.iter().find(|e| e.0 == slot)?.1;
            let step = distance(slot, rate).min(way.abs());
            for &(k, a) in &column {
                self.x[self.head[k] as usize] -= sigma * step * a;
            }
            self.x[j] += sigma * step;
            let leaving = self.head[slot] as usize;
            self.x[leaving] = if rate > 0.0 {
                self.work_lower[leaving]
            } else {
                self.work_upper[leaving]
            };
            self.iterations += 1;
            return self.exchange(slot, j);
        }
        Some(())
    }
}
