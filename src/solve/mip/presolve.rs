//! A smaller program with the same best solutions: bounds that follow, rows that say nothing, columns that are
//! decided or that an equation makes of another, coefficients of binaries no larger than they need be.
//!
//! Values of columns alone lead back: marginals come from a linear program with the discrete columns fixed.

use super::model::{Change, FEASIBLE, Mip};
use super::propagate::Propagator;
use crate::model::instance::OrderedSet;
use crate::solve::lp::form::Problem;
use std::collections::HashMap;

/// The way back from a presolved program.
pub struct Reduced {
    /// The smaller program.
    pub mip: Mip,
    /// Its columns' numbers in the program before.
    pub columns: Vec<u32>,
    /// Values of all columns before; those of `columns` are put in.
    values: Vec<f64>,
    /// Columns that others give, in the order in which they were found.
    given: Vec<Given>,
}

/// A column that is a constant and multiples of others.
struct Given {
    column: usize,
    constant: f64,
    terms: Vec<(usize, f64)>,
}

impl Reduced {
    /// The point before, of one after.
    pub fn restore(&self, x: &[f64]) -> Vec<f64> {
        let mut out = self.values.clone();
        for (&j, &x) in self.columns.iter().zip(x) {
            out[j as usize] = x;
        }
        for g in self.given.iter().rev() {
            let terms = g.terms.iter().map(|&(k, factor)| factor * out[k]);
            out[g.column] = g.constant + terms.sum::<f64>();
        }
        out
    }

    /// A point after, of one before.
    pub fn reduce(&self, x: &[f64]) -> Vec<f64> {
        self.columns.iter().map(|&j| x[j as usize]).collect()
    }
}

/// The program that is left where these columns are fixed besides and cost times columns is not above `cutoff`;
/// None: it has no solution.
pub fn reduce(mip: &Mip, fixed: &[Change]) -> Option<Reduced> {
    let mut work = mip.clone();
    for c in fixed {
        (work.problem.lower[c.column], work.problem.upper[c.column]) = (c.lower, c.upper);
    }
    let mut stays = vec![false; work.problem.n()];
    work.held.iter().for_each(|&j| stays[j as usize] = true);
    for set in &work.sets {
        set.columns.iter().for_each(|&j| stays[j as usize] = true);
    }
    if (0..work.problem.m()).any(|i| is_indivisible(&work, i)) {
        return None;
    }
    let mut idle = vec![false; work.problem.m()];
    // Before bounds follow from rows: what is free now is not kept free by a row that bounds make superfluous.
    let mut given = match work.held.is_empty() {
        true => definitions(&mut work, &mut idle, &stays),
        false => Vec::new(),
    };
    let mut enumerated = false;
    for round in 0..6 {
        let (mut lower, mut upper) = (work.problem.lower.clone(), work.problem.upper.clone());
        let mut propagator = Propagator::new(&work);
        propagator.continuous = round < 2;
        if !propagator.run(&work, None, &mut lower, &mut upper) {
            return None;
        }
        let mut changed = !propagator.moved.is_empty();
        if (round == 1 || enumerated) && fixed.is_empty() {
            changed |= propagator.probe(&work, &mut lower, &mut upper)?;
        }
        let mut alike = Alike::new(&work, &stays);
        if round > 0 && fixed.is_empty() {
            let mut tell = |k, by, opposite| alike.add(k, by, opposite);
            enumerated = propagator.enumerate(&work, &mut lower, &mut upper, &mut tell)?;
            changed |= enumerated;
        }
        (work.problem.lower, work.problem.upper) = (lower, upper);
        if work.held.is_empty() {
            let more = alike.put_in(&mut work);
            changed |= !more.is_empty();
            given.extend(more);
        }
        changed |= rows(&mut work, &mut idle);
        // Rows that come later know the program's columns.
        if work.held.is_empty() {
            let more = pairs(&mut work, &mut idle, &stays)?;
            changed |= !more.is_empty();
            given.extend(more);
            let more = twins(&mut work, &mut idle, &stays);
            changed |= !more.is_empty();
            given.extend(more);
        }
        // The first round leaves probing to the second.
        if !changed && round > 0 {
            break;
        }
    }
    Some(Reduced {
        given,
        ..assemble(&work, &idle, &stays)
    })
}

/// Columns that are the same as others, or opposite, wherever rows are satisfied.
struct Alike {
    given: Vec<Given>,
    /// By column: it may go, and it may be what another is given by.
    may: Vec<[bool; 2]>,
}

impl Alike {
    fn new(mip: &Mip, stays: &[bool]) -> Self {
        let is_free = |j: usize| !stays[j] && mip.threshold[j] == 0.0;
        Self {
            given: Vec::new(),
            may: (0..stays.len()).map(|j| [is_free(j); 2]).collect(),
        }
    }

    fn add(&mut self, column: usize, by: usize, opposite: bool) {
        if self.may[column][0] && self.may[by][1] {
            (self.may[column], self.may[by][0]) = ([false; 2], false);
            let (constant, factor) = if opposite { (1.0, -1.0) } else { (0.0, 1.0) };
            self.given.push(Given {
                column,
                constant,
                terms: vec![(by, factor)],
            });
        }
    }

    /// What is still open is put in.
    fn put_in(mut self, mip: &mut Mip) -> Vec<Given> {
        let p = &mip.problem;
        let is_open = |j: usize| p.lower[j] < p.upper[j];
        self.given
            .retain(|g| is_open(g.column) && is_open(g.terms[0].0));
        put_in(mip, &self.given);
        self.given
    }
}

/// Whether a row asks for a number that no sum of integers times its coefficients is.
fn is_indivisible(mip: &Mip, row: usize) -> bool {
    let p = &mip.problem;
    let side = p.row_lower[row];
    let whole = |(j, a): (usize, f64)| mip.integer[j] && a == a.trunc() && a.abs() < 1e9;
    if side != p.row_upper[row] || side.abs() > 1e9 || !p.rows.line(row).all(whole) {
        return false;
    }
    let greatest = |mut a: u64, mut b: u64| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let coefficients = p.rows.line(row).map(|(_, a)| a.abs() as u64);
    let divisor = coefficients.fold(0, greatest) as f64;
    divisor > 0.0 && (side - (side / divisor).round() * divisor).abs() > 1e-6
}

/// Equations of two columns: one of them is put in for the other. None: their bounds contradict each other.
fn pairs(mip: &mut Mip, idle: &mut [bool], stays: &[bool]) -> Option<Vec<Given>> {
    let mut given: Vec<Given> = Vec::new();
    let mut taken = vec![false; mip.problem.n()];
    for (i, idle) in idle.iter_mut().enumerate() {
        let p = &mut mip.problem;
        if *idle || p.row_lower[i] != p.row_upper[i] {
            continue;
        }
        let open = |&(j, a): &(usize, f64)| a != 0.0 && p.lower[j] < p.upper[j];
        let mut entries = p.rows.line(i).filter(open);
        let (Some(a), Some(b), None) = (entries.next(), entries.next(), entries.next()) else {
            continue;
        };
        let decided = p.rows.line(i).filter(|e| e.0 != a.0 && e.0 != b.0);
        let side = p.row_lower[i] - decided.map(|(j, v)| v * p.lower[j]).sum::<f64>();
        // An integer column is given by an integer one, and at the same step.
        let (gone, by) = if mip.integer[b.0] && !mip.integer[a.0] {
            (a, b)
        } else {
            (b, a)
        };
        let (constant, factor) = (side / gone.1, -by.1 / gone.1);
        let whole = factor.abs() == 1.0 && constant == constant.round();
        let free = |j: usize| !taken[j] && !stays[j] && mip.threshold[j] == 0.0;
        if !free(gone.0)
            || !free(by.0)
            || !(1e-3..=1e3).contains(&factor.abs())
            || mip.integer[gone.0] && !(mip.integer[by.0] && whole)
        {
            continue;
        }
        let ends = [p.lower[gone.0], p.upper[gone.0]].map(|v| (v - constant) / factor);
        let (mut l, mut u) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        if mip.integer[by.0] {
            (l, u) = ((l - FEASIBLE).ceil(), (u + FEASIBLE).floor());
        }
        let (l, u) = (l.max(p.lower[by.0]), u.min(p.upper[by.0]));
        if l > u + FEASIBLE * l.abs().max(1.0) {
            return None;
        }
        (p.lower[by.0], p.upper[by.0]) = if l > u { (u, u) } else { (l, u) };
        (taken[gone.0], taken[by.0], *idle) = (true, true, true);
        given.push(Given {
            column: gone.0,
            constant,
            terms: vec![(by.0, factor)],
        });
    }
    put_in(mip, &given);
    Some(given)
}

/// Free columns in one row only: an equation defines them, or an inequality that their costs make tight. What they cost is
/// what the others in that row cost: models name parts of their objective so, and chains of such names end here.
fn definitions(mip: &mut Mip, idle: &mut [bool], stays: &[bool]) -> Vec<Given> {
    let p = &mut mip.problem;
    let mut given = Vec::new();
    let free =
        |p: &Problem, j: usize| p.lower[j] == f64::NEG_INFINITY && p.upper[j] == f64::INFINITY;
    let mut open: Vec<usize> = (0..p.n())
        .filter(|&j| free(p, j) && !mip.integer[j] && !stays[j] && mip.threshold[j] == 0.0)
        .collect();
    loop {
        let before = given.len();
        open.retain(|&j| {
            let mut rows = p.columns.line(j).filter(|e| e.1 != 0.0 && !idle[e.0]);
            let (Some((i, a)), None) = (rows.next(), rows.next()) else {
                return true;
            };
            let cost = p.cost[j];
            let sides = [p.row_lower[i], p.row_upper[i]];
            let side = match cost * a {
                v if v > 0.0 => sides[0],
                v if v < 0.0 => sides[1],
                _ if sides[0].is_finite() => sides[0],
                _ => sides[1],
            };
            if !side.is_finite() {
                return true;
            }
            let others = p.rows.line(i).filter(|e| e.0 != j && e.1 != 0.0);
            let terms: Vec<(usize, f64)> = others.map(|(k, b)| (k, -b / a)).collect();
            for &(k, factor) in &terms {
                p.cost[k] += factor * cost;
            }
            p.offset += side / a * cost;
            p.cost[j] = 0.0;
            (p.lower[j], p.upper[j], idle[i]) = (0.0, 0.0, true);
            (p.row_lower[i], p.row_upper[i]) = (f64::NEG_INFINITY, f64::INFINITY);
            given.push(Given {
                column: j,
                constant: side / a,
                terms,
            });
            false
        });
        if given.len() == before {
            return given;
        }
    }
}

/// Multiples of coefficients and sides that agree to this part are the same.
const SAME: f64 = 1e-12;

/// Entries of rows that are compared for twins, at most.
const COMPARED: usize = 10_000_000;

/// Columns without a common row, with costs of one sign, whose rows are the same but for them: whatever the other columns
/// are, the same values are open to both, and what is best for one is best for the other. One of them is put in for the other.
fn twins(mip: &mut Mip, idle: &mut [bool], stays: &[bool]) -> Vec<Given> {
    let p = &mip.problem;
    let hash = |v: u64| (v ^ v >> 29).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let hash = |v: u64| hash(hash(v.wrapping_add(1)));
    let rows = |j: usize| p.columns.line(j).filter(|e| e.1 != 0.0 && !idle[e.0]);
    let row_key: Vec<u64> = (0..p.m())
        .map(|i| others(p, i, usize::MAX).fold(0, |k: u64, e| k.wrapping_add(hash(e.0 as u64))))
        .collect();
    let mut seen: HashMap<u64, Vec<usize>> = HashMap::new();
    let mut touched = vec![false; p.n()];
    let mut given = Vec::new();
    let (mut left, mut gone_rows) = (COMPARED, Vec::new());
    for j in 0..p.n() {
        if p.lower[j] >= p.upper[j] || stays[j] || mip.threshold[j] > 0.0 {
            continue;
        }
        let own = hash(j as u64);
        let key = rows(j).fold(0, |k: u64, (i, _)| {
            k.wrapping_add(hash(row_key[i].wrapping_sub(own)))
        });
        let group = seen.entry(key).or_default();
        let alike = |k: &&usize| {
            let bounds = p.lower[j] == p.lower[**k] && p.upper[j] == p.upper[**k];
            let cost = p.cost[j] * p.cost[**k] > 0.0 || p.cost[j] == p.cost[**k];
            bounds && cost && mip.integer[j] == mip.integer[**k]
        };
        let twin = group.iter().filter(alike).copied().find(|&k| {
            let mut free: Vec<(usize, f64)> = rows(k).collect();
            let mut same = |(i, a): (usize, f64)| {
                let size = p.rows.line(i).len() * free.len();
                left = left.saturating_sub(size);
                let like = |&(r, b): &(usize, f64)| is_multiple(p, [i, r], [j, k], [a, b]);
                let found = free.iter().position(like).filter(|_| left > 0);
                found.map(|f| free.swap_remove(f)).is_some()
            };
            !touched[j] && !touched[k] && rows(j).all(&mut same) && free.is_empty()
        });
        let Some(by) = twin else {
            group.push(j);
            continue;
        };
        for i in rows(j).chain(rows(by)).map(|e| e.0) {
            p.rows.line(i).for_each(|e| touched[e.0] = true);
        }
        (touched[j], touched[by]) = (true, true);
        gone_rows.extend(rows(j).map(|e| e.0));
        given.push(Given {
            column: j,
            constant: 0.0,
            terms: vec![(by, 1.0)],
        });
    }
    gone_rows.into_iter().for_each(|i| idle[i] = true);
    put_in(mip, &given);
    given
}

/// The entries of a row in columns that are not decided, without one column.
fn others(p: &Problem, row: usize, but: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
    let open = move |e: &(usize, f64)| e.1 != 0.0 && e.0 != but && p.lower[e.0] < p.upper[e.0];
    p.rows.line(row).filter(open)
}

/// Whether the second row is a multiple of the first, with the second column, whose coefficients are these, for the first.
fn is_multiple(p: &Problem, rows: [usize; 2], columns: [usize; 2], own: [f64; 2]) -> bool {
    let close = |x: f64, y: f64| (x - y).abs() <= SAME * x.abs().max(y.abs());
    let same = |x: f64, y: f64| x == y || (x - y).is_finite() && close(x, y);
    let mut one = others(p, rows[0], columns[0]);
    let mut two = others(p, rows[1], columns[1]);
    let ratio = own[1] / own[0];
    loop {
        match (one.next(), two.next()) {
            (None, None) => break,
            (Some(a), Some(b)) if a.0 == b.0 && same(b.1, ratio * a.1) => {}
            _ => return false,
        }
    }
    let decided = |row: usize, but: usize| {
        let line = p.rows.line(row);
        let decided = line.filter(|e| e.0 != but && p.lower[e.0] >= p.upper[e.0]);
        decided.map(|(k, a)| a * p.lower[k]).sum::<f64>()
    };
    let sides = |n: usize| {
        let moved = decided(rows[n], columns[n]);
        [p.row_lower[rows[n]] - moved, p.row_upper[rows[n]] - moved]
    };
    let (first, second) = (sides(0), sides(1));
    let [low, high] = first.map(|s| s * ratio);
    let [low, high] = if ratio < 0.0 {
        [high, low]
    } else {
        [low, high]
    };
    same(second[0], low) && same(second[1], high)
}

/// Columns in terms of the one that gives each, in rows and costs, and in the order of branching.
fn put_in(mip: &mut Mip, given: &[Given]) {
    if given.is_empty() {
        return;
    }
    for g in given {
        if let Some(&first) = mip.priority.get(g.column) {
            let by = g.terms[0].0;
            mip.priority[by] = mip.priority[by].min(first);
        }
    }
    let p = &mut mip.problem;
    let mut of = vec![None; p.n()];
    for g in given {
        of[g.column] = Some((g, g.terms[0]));
        p.offset += g.constant * p.cost[g.column];
        p.cost[g.terms[0].0] += g.terms[0].1 * p.cost[g.column];
        p.cost[g.column] = 0.0;
        (p.lower[g.column], p.upper[g.column]) = (0.0, 0.0);
    }
    let old = std::mem::take(&mut p.rows);
    for i in 0..old.lines() {
        let mut entries: Vec<(usize, f64)> = Vec::new();
        for (j, a) in old.line(i) {
            let Some((g, (by, factor))) = of[j] else {
                entries.push((j, a));
                continue;
            };
            entries.push((by, a * factor));
            p.row_lower[i] -= a * g.constant;
            p.row_upper[i] -= a * g.constant;
        }
        entries.sort_by_key(|e| e.0);
        entries.dedup_by(|next, first| {
            let sum = next.1 + first.1;
            let is_same = next.0 == first.0;
            if is_same {
                let nothing = sum.abs() <= 1e-12 * first.1.abs();
                first.1 = if nothing { 0.0 } else { sum };
            }
            is_same
        });
        entries.retain(|e| e.1 != 0.0);
        p.rows.push(entries);
    }
    p.columns = p.rows.transpose(p.cost.len());
}

/// Drops sides that bounds imply, and tightens coefficients of binaries.
fn rows(mip: &mut Mip, idle: &mut [bool]) -> bool {
    let mut changed = false;
    let Mip {
        problem: p,
        integer,
        ..
    } = mip;
    let mut new: Vec<(usize, usize, f64)> = Vec::new();
    for (i, idle) in idle.iter_mut().enumerate() {
        if *idle {
            continue;
        }
        // rows as borrowed by Activity
        let (mut low, mut high) = (0.0, 0.0);
        // The rounding of either end is that of its own terms: the other may be far off.
        let finite = |v: f64| if v.is_finite() { v.abs() } else { 0.0 };
        let mut size = [finite(p.row_lower[i]), finite(p.row_upper[i])];
        for (j, a) in p.rows.line(i) {
            let ends = [a * p.lower[j], a * p.upper[j]];
            let (least, most) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            low += least;
            high += most;
            size = [size[0].max(finite(least)), size[1].max(finite(most))];
        }
        let slack = size.map(|s| (1e-9 * s.min(1.0)).max(4.0 * f64::EPSILON * s));
        if p.row_lower[i].is_finite() && low >= p.row_lower[i] - slack[0] {
            p.row_lower[i] = f64::NEG_INFINITY;
            changed = true;
        }
        if p.row_upper[i].is_finite() && high <= p.row_upper[i] + slack[1] {
            p.row_upper[i] = f64::INFINITY;
            changed = true;
        }
        if p.row_lower[i].is_infinite() && p.row_upper[i].is_infinite() {
            *idle = true;
            continue;
        }
        // One side, of either direction, as a ≤ row.
        let sign = match (p.row_lower[i].is_finite(), p.row_upper[i].is_finite()) {
            (false, true) if high.is_finite() => 1.0,
            (true, false) if low.is_finite() => -1.0,
            _ => continue,
        };
        let mut most = if sign > 0.0 { high } else { -low };
        let mut side = if sign > 0.0 {
            p.row_upper[i]
        } else {
            -p.row_lower[i]
        };
        for (j, a) in p.rows.line(i) {
            let a = sign * a;
            if !integer[j] || p.lower[j] != 0.0 || p.upper[j] != 1.0 {
                continue;
            }
            // How much is left where the column does not use its share.
            let spare = side - (most - a.abs());
            let slack = slack[usize::from(sign > 0.0)];
            if spare <= slack || spare >= a.abs() - slack {
                continue;
            }
            let smaller = a.abs() - spare;
            if a > 0.0 {
                new.push((i, j, sign * smaller));
                side -= spare;
                most -= spare;
            } else {
                new.push((i, j, -sign * smaller));
            }
            changed = true;
        }
        if sign > 0.0 {
            p.row_upper[i] = side;
        } else {
            p.row_lower[i] = -side;
        }
    }
    if !new.is_empty() {
        for (i, j, a) in new {
            let r = p.rows.start[i]..p.rows.start[i + 1];
            if let Ok(k) = p.rows.index[r.clone()].binary_search(&(j as u32)) {
                p.rows.value[r.start + k] = a;
            }
        }
        p.columns = p.rows.transpose(p.cost.len());
    }
    changed
}

/// Columns that are fixed go, and rows that say nothing; members of sets stay.
fn assemble(work: &Mip, idle: &[bool], stays: &[bool]) -> Reduced {
    let p = &work.problem;
    let n = p.n();
    let open = |j: usize| p.lower[j] < p.upper[j] || stays[j];
    let mut number = vec![u32::MAX; n];
    let mut columns = Vec::new();
    for j in (0..n).filter(|&j| open(j)) {
        number[j] = columns.len() as u32;
        columns.push(j as u32);
    }
    let values: Vec<f64> = (0..n)
        .map(|j| if open(j) { 0.0 } else { p.lower[j] })
        .collect();
    let kept: Vec<usize> = columns.iter().map(|&j| j as usize).collect();
    let says = |i: &usize| p.rows.line(*i).any(|e| open(e.0) && e.1 != 0.0);
    let rows: Vec<usize> = (0..p.m()).filter(|&i| !idle[i]).filter(says).collect();
    let problem = p.part(&kept, &rows, &values);
    let pick = |v: &[f64]| kept.iter().map(|&j| v[j]).collect::<Vec<f64>>();
    let mut sets = Vec::new();
    for set in &work.sets {
        sets.push(OrderedSet {
            neighbours: set.neighbours,
            columns: set.columns.iter().map(|&j| number[j as usize]).collect(),
        });
    }
    let mip = Mip {
        integer: columns.iter().map(|&j| work.integer[j as usize]).collect(),
        threshold: pick(&work.threshold),
        priority: match work.priority.is_empty() {
            true => Vec::new(),
            false => pick(&work.priority),
        },
        sets,
        held: Vec::new(),
        problem,
    };
    Reduced {
        mip,
        columns,
        values,
        given: Vec::new(),
    }
}
