//! What bounds imply for other bounds: rows, thresholds and ordered sets, followed until nothing moves.

pub use super::learn::Sum;
use super::learn::{Said, Trail};
use super::model::{FEASIBLE, INTEGRAL, Mip};
use crate::solve::lp::form::{Activity, term};
use std::collections::{BTreeMap, VecDeque};

/// How much either value of every binary may cost, in entries of rows for every entry of the program.
const PROBING: usize = 100;

/// How much the points of rows may cost without a gain, in the same unit.
const ENUMERATION: usize = 100;

/// Points of a row that are looked at, at most; a column's values at them are the bits of a number.
const POINTS: u32 = 64;

/// What columns are at the points of a row.
struct Points {
    count: u32,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// By column: not decided at a point.
    is_open: Vec<bool>,
    /// By column: the points at which it is 1.
    ones: Vec<u64>,
}

impl Points {
    fn new(columns: usize) -> Self {
        Self {
            count: 0,
            lower: vec![f64::INFINITY; columns],
            upper: vec![f64::NEG_INFINITY; columns],
            is_open: vec![false; columns],
            ones: vec![0; columns],
        }
    }

    /// The bits of all points.
    fn all(&self) -> u64 {
        u64::MAX >> (POINTS - self.count)
    }

    /// One more; false: there are too many.
    fn add(&mut self, lower: &[f64], upper: &[f64]) -> bool {
        if self.count == POINTS {
            return false;
        }
        for (k, (&l, &u)) in lower.iter().zip(upper).enumerate() {
            self.lower[k] = self.lower[k].min(l);
            self.upper[k] = self.upper[k].max(u);
            self.is_open[k] |= l < u;
            self.ones[k] |= u64::from(l == 1.0) << self.count;
        }
        self.count += 1;
        true
    }
}

/// Rows that are to be looked at, each once.
#[derive(Default)]
pub(super) struct Queue {
    rows: VecDeque<u32>,
    is_queued: Vec<bool>,
}

impl Queue {
    pub(super) fn push(&mut self, row: usize) {
        if row >= self.is_queued.len() {
            self.is_queued.resize(row + 1, false);
        }
        if !std::mem::replace(&mut self.is_queued[row], true) {
            self.rows.push_back(row as u32);
        }
    }

    fn pop(&mut self) -> Option<usize> {
        let row = self.rows.pop_front()? as usize;
        self.is_queued[row] = false;
        Some(row)
    }

    pub(super) fn clear(&mut self) {
        while self.pop().is_some() {}
    }
}

/// Works on one program.
pub struct Propagator {
    pub(super) queue: Queue,
    /// The objective, as a row behind the others.
    objective: Vec<(usize, f64)>,
    /// How bounds came about, and clauses, rows behind that, where these are learned.
    pub(super) trail: Option<Trail>,
    /// The row that the last run ended at, and whether its upper side.
    pub(super) contradicted: Option<(usize, bool)>,
    /// Only points count whose objective is not above this.
    pub(super) cutoff: f64,
    /// Bounds of continuous columns are tightened as well, where they were infinite or shrink to a half.
    pub continuous: bool,
    /// Columns whose bounds the last run moved.
    pub moved: Vec<usize>,
    /// Entries of rows that were looked at so far.
    work: usize,
    has_thresholds: bool,
}

impl Propagator {
    /// For a program.
    pub fn new(mip: &Mip) -> Self {
        Self {
            queue: Queue::default(),
            objective: mip.costs().collect(),
            trail: None,
            contradicted: None,
            cutoff: f64::INFINITY,
            continuous: false,
            moved: Vec::new(),
            work: 0,
            has_thresholds: mip.threshold.iter().any(|t| *t > 0.0),
        }
    }

    fn enqueue(&mut self, mip: &Mip, column: usize) {
        for (i, _) in mip.problem.columns.line(column) {
            self.queue.push(i);
        }
        if mip.problem.cost[column] != 0.0 {
            self.enqueue_objective(mip);
        }
        for &k in self.trail.iter().flat_map(|t| t.learned.watching(column)) {
            self.queue.push(mip.problem.m() + 1 + k as usize);
        }
    }

    pub(super) fn enqueue_objective(&mut self, mip: &Mip) {
        if self.cutoff.is_finite() {
            self.queue.push(mip.problem.m());
        }
    }

    /// Only points count whose objective is not above this.
    pub fn limit(&mut self, mip: &Mip, cutoff: f64) {
        if cutoff != self.cutoff {
            self.cutoff = cutoff;
            self.enqueue_objective(mip);
        }
    }

    /// Tightens bounds that follow from those of `columns` (None: from all rows). False: nothing satisfies them.
    pub fn run(
        &mut self,
        mip: &Mip,
        columns: Option<&[usize]>,
        lower: &mut [f64],
        upper: &mut [f64],
    ) -> bool {
        self.moved.clear();
        self.contradicted = None;
        match columns {
            Some(columns) => columns.iter().for_each(|&j| self.enqueue(mip, j)),
            None => (0..mip.problem.m()).for_each(|i| self.queue.push(i)),
        }
        let mut fine = true;
        let most = self.work + 50 * mip.problem.rows.value.len() + 1000;
        loop {
            while let Some(i) = self.queue.pop() {
                let p = &mip.problem;
                match i.checked_sub(p.m()) {
                    None => {
                        let (row, sides) = (p.rows.line(i), [p.row_lower[i], p.row_upper[i]]);
                        self.work += row.len();
                        fine &= self.work > most || self.row(mip, i, row, sides, lower, upper);
                    }
                    Some(0) => {
                        self.work += self.objective.len();
                        let objective = std::mem::take(&mut self.objective);
                        let (row, sides) =
                            (objective.iter().copied(), [f64::NEG_INFINITY, self.cutoff]);
                        fine &= self.work > most || self.row(mip, i, row, sides, lower, upper);
                        self.objective = objective;
                    }
                    Some(k) => {
                        self.work += 2;
                        let say = |t: &mut Trail| t.learned.say(k - 1, lower, upper);
                        fine &= match self.trail.as_mut().map(say) {
                            None | Some(Said::Nothing) => true,
                            Some(Said::Implied(j, v)) => {
                                let own = 1.0 - 2.0 * v;
                                self.set(mip, j, [v, v], Some((i, own)), lower, upper)
                            }
                            Some(Said::Contradiction) => {
                                self.contradicted = Some((i, true));
                                false
                            }
                        };
                    }
                }
                if !fine || self.work > most {
                    self.queue.clear();
                }
            }
            let before = self.moved.len();
            if !fine || !self.thresholds_and_sets(mip, lower, upper) {
                self.queue.clear();
                return false;
            }
            if self.moved.len() == before || self.work > most {
                self.queue.clear();
                return true;
            }
        }
    }

    /// Tightens bounds by what either value of every binary column implies. None: nothing satisfies them;
    /// otherwise whether bounds moved.
    pub fn probe(&mut self, mip: &Mip, lower: &mut [f64], upper: &mut [f64]) -> Option<bool> {
        let most = self.work + PROBING * (mip.problem.rows.value.len() + 1000);
        let (mut l, mut u) = (lower.to_vec(), upper.to_vec());
        let mut changed = false;
        for j in 0..lower.len() {
            if !mip.is_binary(j, lower, upper) || self.work > most {
                continue;
            }
            let mut sides = [None, None];
            for (side, found) in [0.0, 1.0].into_iter().zip(&mut sides) {
                (l[j], u[j]) = (side, side);
                if self.run(mip, Some(&[j]), &mut l, &mut u) {
                    let moved = self.moved.iter().map(|&k| (k, (l[k], u[k])));
                    *found = Some(moved.collect::<BTreeMap<_, _>>());
                }
                for &k in self.moved.iter().chain([&j]) {
                    (l[k], u[k]) = (lower[k], upper[k]);
                }
            }
            let implied: Vec<(usize, f64, f64)> = match sides {
                [None, None] => return None,
                [None, Some(_)] => vec![(j, 1.0, 1.0)],
                [Some(_), None] => vec![(j, 0.0, 0.0)],
                [Some(zero), Some(one)] => {
                    let both = |(k, a): (usize, (f64, f64))| {
                        let b = one.get(&k)?;
                        Some((k, a.0.min(b.0), a.1.max(b.1)))
                    };
                    zero.into_iter().filter_map(both).collect()
                }
            };
            let mut columns = Vec::new();
            for (k, low, high) in implied {
                if low > lower[k] || high < upper[k] {
                    (lower[k], upper[k]) = (low.max(lower[k]), high.min(upper[k]));
                    columns.push(k);
                }
            }
            if columns.is_empty() {
                continue;
            }
            changed = true;
            if !self.run(mip, Some(&columns), lower, upper) {
                return None;
            }
            for &k in self.moved.iter().chain(&columns) {
                (l[k], u[k]) = (lower[k], upper[k]);
            }
        }
        Some(changed)
    }

    /// Tightens bounds by what all points of an equation of binaries have in common, equation by equation, and tells
    /// columns that are the same at all of them, or opposite. None: nothing satisfies them; otherwise whether bounds moved.
    pub fn enumerate(
        &mut self,
        mip: &Mip,
        lower: &mut [f64],
        upper: &mut [f64],
        alike: &mut dyn FnMut(usize, usize, bool),
    ) -> Option<bool> {
        let p = &mip.problem;
        let worth = ENUMERATION * (p.rows.value.len() + 1000);
        let mut most = self.work + worth;
        let mut changed = false;
        for i in (0..p.m()).filter(|&i| p.row_lower[i] == p.row_upper[i]) {
            let columns = p.rows.line(i).map(|e| e.0);
            let open: Vec<usize> = columns.filter(|&j| lower[j] < upper[j]).collect();
            let are_binary = open.iter().all(|&j| mip.is_binary(j, lower, upper));
            if open.len() < 3 || !are_binary || self.work > most {
                continue;
            }
            let mut points = Points::new(lower.len());
            if !self.points(mip, &open, lower, upper, most, &mut points) {
                continue;
            }
            if points.count == 0 {
                return None;
            }
            let mut columns = Vec::new();
            let mut same: BTreeMap<u64, (usize, u64)> = BTreeMap::new();
            for k in 0..lower.len() {
                if points.lower[k] > lower[k] || points.upper[k] < upper[k] {
                    (lower[k], upper[k]) = (points.lower[k], points.upper[k]);
                    columns.push(k);
                } else if mip.is_binary(k, lower, upper) && !points.is_open[k] {
                    let (ones, opposite) = (points.ones[k], points.all() & !points.ones[k]);
                    match same.get(&ones.min(opposite)) {
                        Some(&(by, of)) => {
                            alike(k, by, of != ones);
                            most = self.work + worth;
                        }
                        None => drop(same.insert(ones.min(opposite), (k, ones))),
                    }
                }
            }
            if columns.is_empty() {
                continue;
            }
            (changed, most) = (true, self.work + worth);
            if !self.run(mip, Some(&columns), lower, upper) {
                return None;
            }
        }
        Some(changed)
    }

    /// Collects what follows from each assignment of these columns. False: there are too many.
    fn points(
        &mut self,
        mip: &Mip,
        open: &[usize],
        lower: &[f64],
        upper: &[f64],
        most: usize,
        points: &mut Points,
    ) -> bool {
        self.work += lower.len();
        if self.work > most {
            return false;
        }
        let Some(next) = open.iter().position(|&j| lower[j] < upper[j]) else {
            return points.add(lower, upper);
        };
        let (column, rest) = (open[next], &open[next + 1..]);
        [1.0, 0.0].into_iter().all(|value| {
            let (mut l, mut u) = (lower.to_vec(), upper.to_vec());
            (l[column], u[column]) = (value, value);
            !self.run(mip, Some(&[column]), &mut l, &mut u)
                || self.points(mip, rest, &l, &u, most, points)
        })
    }

    /// Tightens bounds by row i. False: nothing satisfies it.
    fn row(
        &mut self,
        mip: &Mip,
        i: usize,
        row: impl Iterator<Item = (usize, f64)> + Clone,
        [least, most]: [f64; 2],
        lower: &mut [f64],
        upper: &mut [f64],
    ) -> bool {
        let at = Activity::of(row.clone(), lower, upper);
        // What rounding may have done.
        let slack = FEASIBLE * at.size.max(1.0);
        if at.low() > most + slack || at.high() < least - slack {
            self.contradicted = Some((i, at.low() > most + slack));
            return false;
        }
        let idle_high = most.is_infinite() || at.high() <= most || at.endless[0] > 1;
        let idle_low = least.is_infinite() || at.low() >= least || at.endless[1] > 1;
        if idle_high && idle_low {
            return true;
        }
        for (j, a) in row {
            let (l, u) = (lower[j], upper[j]);
            if l == u || a == 0.0 || !(mip.integer[j] || self.continuous) {
                continue;
            }
            let (mut new_l, mut new_u) = (l, u);
            let mut limit = |value: f64, above: bool| {
                if above {
                    new_u = new_u.min(value);
                } else {
                    new_l = new_l.max(value);
                }
            };
            let [low, high] = at.without(term(a, [l, u]));
            if !idle_high && low.is_finite() {
                limit((most - low) / a, a > 0.0);
            }
            if !idle_low && high.is_finite() {
                limit((least - high) / a, a < 0.0);
            }
            if mip.integer[j] {
                new_l = (new_l - INTEGRAL).ceil();
                new_u = (new_u + INTEGRAL).floor();
            } else {
                // Widened by the tolerance, and only where it tightens much: such a bound is as good as its row.
                let slack = |v: f64| 1e-7 * v.abs().max(1.0);
                let much = |new: f64, old: f64, range: f64| {
                    new.abs() < 1e7 && (old.is_infinite() || (new - old).abs() > 0.5 * range)
                };
                let range = u - l;
                new_l = if new_l > l && much(new_l, l, range) {
                    new_l - slack(new_l)
                } else {
                    l
                };
                new_u = if new_u < u && much(new_u, u, range) {
                    new_u + slack(new_u)
                } else {
                    u
                };
            }
            if !self.set(mip, j, [new_l, new_u], Some((i, a)), lower, upper) {
                self.contradicted = Some((i, (a > 0.0) == (new_u < lower[j])));
                return false;
            }
        }
        true
    }

    /// Bounds that follow from a row, in which the column has this coefficient. False: they cross.
    fn set(
        &mut self,
        mip: &Mip,
        j: usize,
        [l, u]: [f64; 2],
        row: Option<(usize, f64)>,
        lower: &mut [f64],
        upper: &mut [f64],
    ) -> bool {
        let (l, u) = (l.max(lower[j]), u.min(upper[j]));
        if l > u + FEASIBLE * l.abs().max(1.0) {
            return false;
        }
        if l > lower[j] || u < upper[j] {
            let before = [lower[j], upper[j]];
            (lower[j], upper[j]) = if l > u { (u, u) } else { (l, u) };
            if let Some(trail) = &mut self.trail {
                let now = [lower[j], upper[j]];
                for side in (0..2).filter(|&side| now[side] != before[side]) {
                    trail.push(j, side, now[side], row);
                }
            }
            self.moved.push(j);
            self.enqueue(mip, j);
        }
        true
    }

    fn thresholds_and_sets(&mut self, mip: &Mip, lower: &mut [f64], upper: &mut [f64]) -> bool {
        let thresholds = if self.has_thresholds { lower.len() } else { 0 };
        for j in 0..thresholds {
            let t = mip.threshold[j];
            if t > 0.0 && lower[j] < t {
                if upper[j] < t - FEASIBLE * t.max(1.0) && upper[j] > 0.0 {
                    if !self.set(mip, j, [lower[j], 0.0], None, lower, upper) {
                        return false;
                    }
                } else if lower[j] > FEASIBLE
                    && !self.set(mip, j, [t, upper[j]], None, lower, upper)
                {
                    return false;
                }
            }
        }
        for set in &mip.sets {
            let held = |j: &u32| lower[*j as usize] > 0.0 || upper[*j as usize] < 0.0;
            let Some(first) = set.columns.iter().position(held) else {
                continue;
            };
            let last = set.columns.iter().rposition(held).unwrap_or(first);
            let reach = usize::from(set.neighbours);
            if last - first > reach {
                return false;
            }
            for (k, &j) in set.columns.iter().enumerate() {
                let j = j as usize;
                let far = k + reach < last || k > first + reach;
                if far
                    && (lower[j] != 0.0 || upper[j] != 0.0)
                    && !self.set(mip, j, [0.0; 2], None, lower, upper)
                {
                    return false;
                }
            }
        }
        true
    }
}
