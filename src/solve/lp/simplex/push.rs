//! From an interior point to a vertex: the push phase of a crossover (Megiddo 1991; Bixby &
//! Saltzman 1994).
//!
//! Given values for all variables and a basis, the nonbasic variables that are not at a bound move
//! to their nearest ones, all together: most of them have hardly any way to go, and one solve with the basis
//! moves thousands. Where a basic variable reaches its bound first, it leaves the basis for the one of
//! the moving variables that does most of its motion, and the rest goes on. The point stays feasible, and on the
//! optimal face if it was there; in the end it is a vertex.

use super::{NONBASIC, PIVOT, SAFE_PIVOT, Simplex, State};
use crate::solve::lp::Ended;

/// A basic variable that violates its bound by more does not block.
const OUTSIDE: f64 = 1e-6;

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
        let tolerance = self.tolerance;
        self.crossing = (0..self.n + self.m).any(|j| self.way(j).abs() > tolerance);
        let done = self.push_all(stop);
        self.crossing = false;
        done
    }

    fn push_all(&mut self, stop: &mut dyn FnMut(u64) -> Option<Ended>) -> Result<(), Ended> {
        self.refactor().ok_or(Ended::Failed)?;
        loop {
            if self.iterations.is_multiple_of(32)
                && let Some(why) = stop(self.iterations)
            {
                return Err(why);
            }
            if self.push_step().ok_or(Ended::Failed)? {
                return Ok(());
            }
        }
    }

    /// What a nonbasic variable has to go.
    fn way(&self, j: usize) -> f64 {
        match self.slot[j] {
            NONBASIC => self.resting(j, self.x[j]) - self.x[j],
            _ => 0.0,
        }
    }

    /// Moves all as far as the basic variables allow, and pivots there. True: all arrived.
    fn push_step(&mut self) -> Option<bool> {
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
        let (step, blocking) = self.first_block(&rate);
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
        let fresh = self.factor.as_ref().is_some_and(|f| f.updates() == 0);
        let least = if fresh { 100.0 * PIVOT } else { SAFE_PIVOT };
        let mut entering = (0.0, None);
        for &j in &self.row_index {
            let j = j as usize;
            let part = (self.row[j] * self.way(j)).abs();
            if part > entering.0 && self.row[j].abs() > least {
                entering = (part, Some(j));
            }
        }
        let Some(entering) = entering.1 else {
            if fresh {
                return None;
            }
            self.refactor()?;
            return Some(false);
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

    /// How much of the way all can go (Harris's ratio test), and the slot that ends it.
    fn first_block(&self, rate: &[f64]) -> (f64, Option<usize>) {
        let room = |k: usize| {
            let j = self.head[k] as usize;
            match rate[k] > 0.0 {
                true => self.x[j] - self.work_lower[j],
                false => self.work_upper[j] - self.x[j],
            }
        };
        // What is far outside is left to the simplex method.
        let slack = self.tolerance;
        let may = |k: &usize| rate[*k] != 0.0 && room(*k) > -OUTSIDE;
        let limit = (0..self.m)
            .filter(may)
            .map(|k| (room(k).max(0.0) + slack) / rate[k].abs())
            .fold(1.0, f64::min);
        if limit == 1.0 {
            return (1.0, None);
        }
        let first = (0..self.m)
            .filter(|k| may(k) && room(*k) <= limit * rate[*k].abs())
            .max_by(|&a, &b| rate[a].abs().total_cmp(&rate[b].abs()));
        match first {
            Some(k) => ((room(k).max(0.0) / rate[k].abs()).min(1.0), Some(k)),
            None => (1.0, None),
        }
    }
}
