//! The optimal basis of a small program, solved in rational arithmetic.
//!
//! A basis names the rows R that are at a side and the columns C between their bounds; there are
//! equally many. A_RC x_C = b gives the point, A_RCᵀ y_R = c_C the multipliers, both exactly. If the
//! point satisfies every row and bound, its value is an upper bound of the minimum; if every
//! multiplier has its sign, theirs is a lower one: the same number. What a basis that is optimal
//! only up to rounding does not satisfy is named.
//!
//! Numbers grow with every elimination, so the work is counted and given up when it is too much.

use std::collections::BTreeMap;

use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

use super::super::form::Problem;
use super::super::simplex::{Simplex, State};
use super::super::{Ended, watch};
use super::Unproved;
use crate::solve::Budget;
use crate::solve::interval::Interval;

/// What the basis proves.
pub(super) struct Value {
    /// The value of the point, if it is feasible.
    pub upper: Result<Interval, Unproved>,
    /// The value of the multipliers, if they are feasible.
    pub lower: Result<Interval, Unproved>,
}

/// A number as it is stored.
fn rational(x: f64) -> BigRational {
    BigRational::from_float(x).unwrap_or_else(BigRational::zero)
}

/// Solves the program and its basis exactly, with at most so much work (word operations, roughly).
/// None: it was not solved, or not within that.
pub(super) fn value(p: &Problem, effort: u64, budget: &Budget) -> Option<Value> {
    let mut simplex = Simplex::new(p);
    let most = 2000 + 20 * (p.m() + p.n()) as u64;
    if simplex.solve(&mut watch(budget, most)) != Ended::Solved {
        return None;
    }
    simplex.tighten(&mut watch(budget, most));
    let basis = simplex.basis();
    let (n, m) = (p.n(), p.m());
    let columns: Vec<usize> = (0..n).filter(|&j| basis[j] == State::Basic).collect();
    let rows: Vec<usize> = (0..m).filter(|&i| basis[n + i] != State::Basic).collect();
    if columns.len() != rows.len() {
        return None;
    }
    let mut work = Work { left: effort };
    let at = |s: State, l: f64, u: f64| match s {
        State::Lower => rational(l),
        State::Upper => rational(u),
        _ => BigRational::zero(),
    };
    // The point.
    let mut x: Vec<BigRational> = (0..n)
        .map(|j| at(basis[j], p.lower[j], p.upper[j]))
        .collect();
    let mut place = vec![usize::MAX; n];
    columns.iter().enumerate().for_each(|(k, &j)| place[j] = k);
    let mut system = Vec::with_capacity(rows.len());
    for &i in &rows {
        let mut right = at(basis[n + i], p.row_lower[i], p.row_upper[i]);
        let mut line = BTreeMap::new();
        for (j, a) in p.rows.line(i).filter(|e| e.1 != 0.0) {
            if place[j] != usize::MAX {
                line.insert(place[j], rational(a));
            } else if !x[j].is_zero() {
                right -= rational(a) * &x[j];
            }
        }
        system.push((line, right));
    }
    let solved = work.solve(system)?;
    for (&j, v) in columns.iter().zip(solved) {
        x[j] = v;
    }
    // The multipliers.
    let mut y = vec![BigRational::zero(); m];
    let mut place = vec![usize::MAX; m];
    rows.iter().enumerate().for_each(|(k, &i)| place[i] = k);
    let mut system = Vec::with_capacity(rows.len());
    for &j in &columns {
        let entries = p.columns.line(j).filter(|e| e.1 != 0.0);
        let entries = entries.filter(|e| place[e.0] != usize::MAX);
        let line = entries.map(|(i, a)| (place[i], rational(a))).collect();
        system.push((line, rational(p.cost[j])));
    }
    let solved = work.solve(system)?;
    for (&i, v) in rows.iter().zip(solved) {
        y[i] = v;
    }
    let mut price = BigRational::zero();
    for j in (0..n).filter(|&j| p.cost[j] != 0.0) {
        work.spend(&x[j], &price)?;
        price += rational(p.cost[j]) * &x[j];
    }
    let price = enclose(&price);
    Some(Value {
        upper: match point_fails(p, &x, &mut work)? {
            None => Ok(price),
            Some(u) => Err(u),
        },
        lower: match multipliers_fail(p, &y, &basis, &mut work)? {
            None => Ok(price),
            Some(u) => Err(u),
        },
    })
}

/// The first row or bound that the point violates.
fn point_fails(p: &Problem, x: &[BigRational], work: &mut Work) -> Option<Option<Unproved>> {
    let beyond = |v: &BigRational, l: f64, u: f64| {
        (l.is_finite() && *v < rational(l)) || (u.is_finite() && *v > rational(u))
    };
    let fails = |row, column| {
        Some(Some(Unproved {
            why: "rounding decides whether it holds",
            row,
            column,
        }))
    };
    for (j, v) in x.iter().enumerate() {
        if beyond(v, p.lower[j], p.upper[j]) {
            return fails(None, Some(j));
        }
    }
    for i in 0..p.m() {
        let mut sum = BigRational::zero();
        for (j, a) in p.rows.line(i).filter(|e| e.1 != 0.0) {
            work.spend(&sum, &x[j])?;
            sum += rational(a) * &x[j];
        }
        if beyond(&sum, p.row_lower[i], p.row_upper[i]) {
            return fails(Some(i), None);
        }
    }
    Some(None)
}

/// The first multiplier of the wrong sign for where its row or column is.
fn multipliers_fail(
    p: &Problem,
    y: &[BigRational],
    basis: &[State],
    work: &mut Work,
) -> Option<Option<Unproved>> {
    let wrong = |v: &BigRational, state: State, fixed: bool| match state {
        _ if fixed => false,
        State::Basic | State::Free => !v.is_zero(),
        State::Lower => v.is_negative(),
        State::Upper => v.is_positive(),
    };
    let fails = |row, column| {
        Some(Some(Unproved {
            why: "rounding decides the sign of its marginal",
            row,
            column,
        }))
    };
    for (i, v) in y.iter().enumerate() {
        if wrong(v, basis[p.n() + i], p.row_lower[i] == p.row_upper[i]) {
            return fails(Some(i), None);
        }
    }
    for (j, &state) in basis.iter().enumerate().take(p.n()) {
        let mut d = rational(p.cost[j]);
        for (i, a) in p.columns.line(j).filter(|e| e.1 != 0.0) {
            work.spend(&d, &y[i])?;
            d -= rational(a) * &y[i];
        }
        if wrong(&d, state, p.lower[j] == p.upper[j]) {
            return fails(None, Some(j));
        }
    }
    Some(None)
}

/// The neighbouring floating-point numbers, or the number itself.
fn enclose(v: &BigRational) -> Interval {
    let near = v
        .to_f64()
        .filter(|x| x.is_finite())
        .unwrap_or(f64::MAX.copysign(if v.is_negative() { -1.0 } else { 1.0 }));
    let (mut low, mut high) = (near, near);
    while low.is_finite() && rational(low) > *v {
        low = low.next_down();
    }
    while high.is_finite() && rational(high) < *v {
        high = high.next_up();
    }
    Interval { low, high }
}

type Line = BTreeMap<usize, BigRational>;

/// How much work is left.
struct Work {
    left: u64,
}

impl Work {
    /// Pays for a product of two numbers and its sum. None: too much.
    fn spend(&mut self, a: &BigRational, b: &BigRational) -> Option<()> {
        let words = |v: &BigRational| (v.numer().bits() + v.denom().bits()) / 64 + 1;
        let cost = 20 + 4 * words(a) * words(b);
        self.left = self.left.checked_sub(cost)?;
        Some(())
    }

    /// Gauss's elimination on a sparse square system, the sparsest pivot first. None: it is
    /// singular, or too much work.
    fn solve(&mut self, mut lines: Vec<(Line, BigRational)>) -> Option<Vec<BigRational>> {
        let n = lines.len();
        let mut users: Vec<std::collections::BTreeSet<usize>> = vec![Default::default(); n];
        for (i, (line, _)) in lines.iter().enumerate() {
            line.keys().for_each(|&j| {
                users[j].insert(i);
            });
        }
        let mut open: std::collections::BTreeSet<(usize, usize)> = lines
            .iter()
            .enumerate()
            .map(|(i, l)| (l.0.len(), i))
            .collect();
        let mut order = Vec::with_capacity(n);
        while let Some((count, i)) = open.pop_first() {
            if count == 0 {
                return None;
            }
            // The shortest line, and in it the column with the fewest others.
            let &j = lines[i].0.keys().min_by_key(|&&j| (users[j].len(), j))?;
            let pivot = lines[i].0[&j].clone();
            let (line, right) = std::mem::take(&mut lines[i]);
            line.keys().for_each(|&k| {
                users[k].remove(&i);
            });
            for other in std::mem::take(&mut users[j]) {
                let (target, target_right) = &mut lines[other];
                open.remove(&(target.len(), other));
                let factor = target.remove(&j)? / &pivot;
                for (&k, v) in line.iter().filter(|e| *e.0 != j) {
                    self.spend(v, &factor)?;
                    let entry = target.entry(k).or_insert_with(BigRational::zero);
                    *entry -= &factor * v;
                    if entry.is_zero() {
                        target.remove(&k);
                        users[k].remove(&other);
                    } else {
                        users[k].insert(other);
                    }
                }
                self.spend(&right, &factor)?;
                *target_right -= &factor * &right;
                open.insert((target.len(), other));
            }
            order.push((j, pivot, line, right));
        }
        let mut x = vec![BigRational::zero(); n];
        for (j, pivot, line, right) in order.into_iter().rev() {
            let mut sum = right;
            for (&k, v) in line.iter().filter(|e| *e.0 != j) {
                self.spend(v, &x[k])?;
                sum -= v * &x[k];
            }
            x[j] = sum / pivot;
        }
        Some(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encloses_a_third() {
        let third = BigRational::new(1.into(), 3.into());
        let v = enclose(&third);
        assert!(v.low < v.high && v.high == v.low.next_up());
        assert_eq!(enclose(&rational(0.1)), Interval::point(0.1));
    }

    #[test]
    fn solves_a_hilbert_system() {
        let n = 8;
        let entry = |i: usize, j: usize| BigRational::new(1.into(), (i + j + 1).into());
        let lines = (0..n)
            .map(|i| {
                let line: Line = (0..n).map(|j| (j, entry(i, j))).collect();
                let right = line.values().fold(BigRational::zero(), |s, v| s + v);
                (line, right)
            })
            .collect();
        let mut work = Work { left: 1_000_000 };
        let one = rational(1.0);
        assert_eq!(work.solve(lines), Some(vec![one; n]));
    }
}
