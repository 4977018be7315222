//! Jobs of which one comes before the other, written with a large number: `s_a − s_b + M·y ≥ d_b` and
//! `s_b − s_a − M·y ≥ d_a − M`. Of jobs Q that exclude each other, and a besides, what comes before a takes its time:
//! `s_a ≥ min r + Σ_Q d_b [b before a]`; and what comes after it, before anything that all precede ends:
//! `C ≥ s_a + d_a + Σ_Q d_b [a before b] + min (q − d)` (Applegate & Cook 1991; Queyranne 1993).
//!
//! d is the least time from the start of one job to that of another of them, r the least start, q the least time from a
//! start to C. The relaxation knows next to nothing of this: with y between its bounds both rows are slack.

use super::{Separator, Terms};
use crate::solve::lp::form::Problem;
use crate::solve::mip::model::Mip;
use std::collections::{BTreeMap, HashMap};

/// Disjunctions that are looked at, at least and at most.
const LEAST: usize = 3;
const MOST: usize = 20_000;

/// Starts from which those before a job are taken, at most.
const RELEASES: usize = 8;

/// Rounds in which times to a last column spread along rows.
const ROUNDS: usize = 50;

/// Which of two values of a binary column, and the least time between two starts if it has it.
#[derive(Clone, Copy)]
struct Before {
    column: usize,
    is_one: bool,
    time: f64,
}

impl Before {
    /// How much of it a point has.
    fn share(&self, x: &[f64]) -> f64 {
        match self.is_one {
            true => x[self.column],
            false => 1.0 - x[self.column],
        }
    }
}

/// What is known of jobs.
pub(super) struct Sequences {
    /// By column: its unit of time is so many of the common unit; 0: not a start.
    unit: Vec<f64>,
    /// First and second job: when one is before the other.
    before: HashMap<(usize, usize), Before>,
    /// By job: those that exclude it.
    others: BTreeMap<usize, Vec<usize>>,
    /// Columns with a cost, and the least time from starts to them.
    last: Vec<(usize, HashMap<usize, f64>)>,
}

/// A row `first − second ≥ least`, in the common unit, where a binary column, if there is one, has this value.
struct Apart {
    first: usize,
    second: usize,
    least: f64,
    given: Option<(usize, bool)>,
}

impl Sequences {
    /// Of a program; None: it has none.
    pub(super) fn find(mip: &Mip, lower: &[f64], upper: &[f64]) -> Option<Self> {
        let p = &mip.problem;
        let rows: Vec<usize> = (0..p.m()).filter(|&i| is_difference(mip, i)).collect();
        if rows.len() < LEAST {
            return None;
        }
        let unit = units(mip, &rows);
        let apart: Vec<Apart> = rows
            .iter()
            .flat_map(|&i| differences(p, i, mip, &unit))
            .collect();
        let mut all: HashMap<(usize, usize), Before> = HashMap::new();
        for a in &apart {
            if let Some((column, is_one)) = a.given
                && a.least > 0.0
                && (lower[column], upper[column]) == (0.0, 1.0)
                && all.len() < MOST
            {
                let time = a.least;
                all.entry((a.second, a.first)).or_insert(Before {
                    column,
                    is_one,
                    time,
                });
            }
        }
        let excludes = |(&(a, b), one): (&(usize, usize), &Before)| {
            let other = all.get(&(b, a));
            other.is_some_and(|o| o.column == one.column && o.is_one != one.is_one)
        };
        let before: HashMap<(usize, usize), Before> = all
            .iter()
            .filter(|e| excludes(*e))
            .map(|e| (*e.0, *e.1))
            .collect();
        if before.len() < 2 * LEAST {
            return None;
        }
        let mut others: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for &(a, b) in before.keys() {
            others.entry(a).or_default().push(b);
        }
        others.values_mut().for_each(|list| list.sort_unstable());
        let with_cost = (0..p.n()).filter(|&j| p.cost[j] > 0.0 && unit[j] > 0.0);
        let last = with_cost
            .map(|j| (j, times_to(j, &apart)))
            .filter(|(_, times)| times.len() > LEAST)
            .collect();
        Some(Self {
            unit,
            before,
            others,
            last,
        })
    }

    /// Inequalities that a point violates.
    pub(super) fn separate(&self, s: &Separator, values: &[f64]) -> Vec<Inequality> {
        let mut cuts = Vec::new();
        for (&a, others) in &self.others {
            let release = |j: usize| self.unit[j] * s.lower[j];
            let first = |b: usize| self.before.get(&(b, a));
            // those before a, also only of those that are released as late as a given one
            let mut releases: Vec<f64> = others.iter().map(|&b| release(b)).collect();
            releases.push(release(a));
            releases.sort_by(f64::total_cmp);
            releases.dedup();
            releases.retain(|r| *r <= release(a));
            let step = releases.len().div_ceil(RELEASES).max(1);
            for r in releases.into_iter().step_by(step) {
                let some = others.iter().copied().filter(|&b| release(b) >= r);
                let (set, times) = self.exclusive(a, some, first, values);
                let mut cut = Inequality {
                    terms: vec![(a, -self.unit[a])],
                    side: -r,
                };
                for (b, time) in set.iter().zip(times) {
                    cut.add(first(*b), time);
                }
                cuts.extend(cut.violated(values));
            }
            for (c, to_last) in &self.last {
                let Some(own) = to_last.get(&a) else { continue };
                let second = |b: usize| self.before.get(&(a, b));
                let some = others.iter().copied().filter(|b| to_last.contains_key(b));
                let (set, times) = self.exclusive(a, some, second, values);
                let follows = |b: &usize| self.before.get(&(a, *b)).map_or(0.0, |f| f.time);
                let wait = set.iter().map(follows).fold(*own, f64::min);
                let rest = set.iter().zip(&times).map(|(b, t)| to_last[b] - t);
                let fixed = wait + rest.fold(own - wait, f64::min);
                let mut cut = Inequality {
                    terms: vec![(a, self.unit[a]), (*c, -self.unit[*c])],
                    side: -fixed,
                };
                for (b, time) in set.iter().zip(times) {
                    cut.add(second(*b), time);
                }
                cuts.extend(cut.violated(values));
            }
        }
        cuts
    }

    /// Jobs that exclude each other and a, those first of which a point has most, and the least time that each takes.
    fn exclusive<'b>(
        &self,
        a: usize,
        some: impl Iterator<Item = usize>,
        with: impl Fn(usize) -> Option<&'b Before>,
        values: &[f64],
    ) -> (Vec<usize>, Vec<f64>) {
        let share = |b: usize| with(b).map_or(0.0, |w| w.time * w.share(values));
        let mut some: Vec<(f64, usize)> = some.map(|b| (share(b), b)).collect();
        some.retain(|e| e.0 > 1e-9);
        some.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
        let mut set: Vec<usize> = Vec::new();
        for (_, b) in some {
            if set.iter().all(|&c| self.before.contains_key(&(b, c))) {
                set.push(b);
            }
        }
        let time = |b: usize| {
            let next = set.iter().copied().chain([a]).filter(|&c| c != b);
            next.filter_map(|c| self.before.get(&(b, c)))
                .fold(f64::INFINITY, |t, w| t.min(w.time))
        };
        let times = set.iter().map(|&b| time(b)).collect();
        (set, times)
    }
}

/// `Σ terms ≤ side`.
pub(super) struct Inequality {
    pub(super) terms: Terms,
    pub(super) side: f64,
}

impl Inequality {
    /// Adds `time` on the left where one job is before another.
    fn add(&mut self, before: Option<&Before>, time: f64) {
        match before {
            Some(b) if b.is_one => self.terms.push((b.column, time)),
            Some(b) => {
                self.terms.push((b.column, -time));
                self.side -= time;
            }
            None => {}
        }
    }

    /// Itself, if a point violates it.
    fn violated(self, values: &[f64]) -> Option<Self> {
        let sum: f64 = self.terms.iter().map(|&(j, a)| a * values[j]).sum();
        (sum > self.side + 1e-6 * self.side.abs().max(1.0)).then_some(self)
    }
}

/// Whether a row is the difference of two continuous columns, with a binary one or without.
fn is_difference(mip: &Mip, row: usize) -> bool {
    let line = || mip.problem.rows.line(row);
    let real: Vec<f64> = line().filter(|e| !mip.integer[e.0]).map(|e| e.1).collect();
    matches!(real[..], [a, b] if a * b < 0.0) && line().len() <= 3
}

/// Units of columns in which the rows are differences: that of the first of those which hang together is 1.
fn units(mip: &Mip, rows: &[usize]) -> Vec<f64> {
    let p = &mip.problem;
    let pair = |i: usize| {
        let mut real = p.rows.line(i).filter(|e| !mip.integer[e.0]);
        real.next().zip(real.next())
    };
    let mut with: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
    for ((a, x), (b, y)) in rows.iter().filter_map(|&i| pair(i)) {
        with.entry(a).or_default().push((b, -y / x));
        with.entry(b).or_default().push((a, -x / y));
    }
    let mut unit = vec![0.0; p.n()];
    for &first in with.keys() {
        if unit[first] > 0.0 {
            continue;
        }
        unit[first] = 1.0;
        let mut open = vec![first];
        while let Some(a) = open.pop() {
            for &(b, ratio) in &with[&a] {
                if unit[b] == 0.0 {
                    unit[b] = unit[a] * ratio;
                    open.push(b);
                }
            }
        }
    }
    unit
}

/// What a row says of two starts; nothing if it is no difference in these units.
fn differences(p: &Problem, row: usize, mip: &Mip, unit: &[f64]) -> Vec<Apart> {
    let mut real: Vec<(usize, f64)> = p.rows.line(row).collect();
    let binary = real.iter().position(|e| mip.integer[e.0]);
    let binary = binary.map(|k| real.remove(k));
    let [(a, x), (b, y)] = real[..] else {
        return Vec::new();
    };
    let factor = x / unit[a];
    if (y / unit[b] + factor).abs() > 1e-9 * factor.abs() {
        return Vec::new();
    }
    let mut out = Vec::new();
    // first − second + (w / factor) y is between the sides
    for is_one in [false, true] {
        let w = binary.map_or(0.0, |e| e.1);
        if is_one && binary.is_none() {
            break;
        }
        let shift = if is_one { w } else { 0.0 };
        let given = binary.map(|e| (e.0, is_one));
        let ends = [p.row_lower[row], p.row_upper[row]].map(|s| (s - shift) / factor);
        let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        for (first, second, least) in [(a, b, low), (b, a, -high)] {
            if least.is_finite() {
                out.push(Apart {
                    first,
                    second,
                    least,
                    given,
                });
            }
        }
    }
    out
}

/// The least times from starts to a column, along rows without a binary column.
fn times_to(last: usize, apart: &[Apart]) -> HashMap<usize, f64> {
    let mut times = HashMap::from([(last, 0.0)]);
    for _ in 0..ROUNDS {
        let mut changed = false;
        for a in apart.iter().filter(|a| a.given.is_none()) {
            if let Some(&t) = times.get(&a.first) {
                let time = t + a.least;
                let known = times.get(&a.second).copied();
                if a.second != last && known.is_none_or(|k| time > k + 1e-9) {
                    times.insert(a.second, time);
                    changed = true;
                }
            }
        }
        if !changed {
            break;
        }
    }
    times.remove(&last);
    times
}
