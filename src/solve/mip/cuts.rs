//! Cuts: inequalities that all discrete points satisfy and the relaxation's solution does not.
//!
//! One rule makes nearly all of them, mixed-integer rounding (Nemhauser & Wolsey 1990; Marchand & Wolsey 2001). For
//! `Σ a_j t_j + Σ g_k s_k ≤ b` with integers t ≥ 0 and reals s ≥ 0, and f the fraction of b,
//! `Σ (⌊a_j⌋ + max(0, f_j − f)/(1 − f)) t_j + Σ min(0, g_k)/(1 − f) s_k ≤ ⌊b⌋`. A row of the optimal tableau gives
//! Gomory's mixed-integer cut (1960); single rows, and rows added so that continuous columns between their bounds cancel,
//! with variable bounds `x ≤ u·y` put in, give those that lot sizing and fixed charges need. Knapsack rows give extended
//! covers besides; rows of integers alone, added so that what is odd cancels, cuts of halves; jobs in sequence the times of
//! those before and after; binaries of which any two exclude each other cliques.

use super::linear::{Cut, Linear};
use super::model::Mip;
use crate::solve::lp::simplex::factor::Entries;

mod clique;
mod parity;
mod sequence;

/// Fractions nearer to 0 or 1 give nothing but numerical trouble.
const FRACTION: f64 = 0.01;

/// Rows that are added up at most.
const AGGREGATED: usize = 5;

/// How many cuts a round keeps at most.
const KEPT: usize = 60;

/// What separation knows of a program.
pub struct Separator<'a> {
    mip: &'a Mip,
    /// Upper bounds of continuous columns by integer ones: column y and u in x ≤ u·y.
    variable_upper: Vec<Option<(usize, f64)>>,
    /// The step of a row's activities, where it has integer columns only; 0 for others. Of the cuts so far, too.
    step: Vec<f64>,
    sequences: Option<sequence::Sequences>,
    conflicts: clique::Conflicts,
    lower: &'a [f64],
    upper: &'a [f64],
}

/// One variable, a column or n + row, in an aggregated row.
type Terms = Vec<(usize, f64)>;

/// An integer variable: number, coefficient and value in its units from a bound, that bound, its unit.
type Whole = (usize, f64, f64, Shift, f64);

/// A row Σ aᵢ tᵢ ≤ b in variables that are counted from a bound.
struct Shifted {
    whole: Vec<Whole>,
    /// Number, coefficient, value, bound.
    real: Vec<(usize, f64, f64, Shift)>,
    b: f64,
}

impl Shifted {
    /// How far the rounding of the row, divided by d, cuts the point off.
    fn efficacy(&self, d: f64) -> f64 {
        let (side, f) = (floor(self.b / d), fraction(self.b / d));
        if !(FRACTION..=1.0 - FRACTION).contains(&f) {
            return f64::NEG_INFINITY;
        }
        let (mut sum, mut norm) = (-side, 1e-12);
        for e in &self.whole {
            let g = rounded(e.1 / d, f);
            sum += g * e.2;
            norm += g * g;
        }
        for e in self.real.iter().filter(|e| e.1 < 0.0) {
            let g = e.1 / d / (1.0 - f);
            sum += g * e.2;
            norm += g * g;
        }
        sum / norm.sqrt()
    }

    /// The best of these divisors, or of coefficients that suggest themselves.
    fn divisor(&self, divisors: &[f64]) -> Option<f64> {
        let mut tried: Vec<f64> = divisors.to_vec();
        if divisors.is_empty() {
            let mut inside: Vec<&Whole> = self
                .whole
                .iter()
                .filter(|e| e.2 > 1e-6 && e.1.abs() > 1e-6)
                .collect();
            inside.sort_by(|a, b| b.2.total_cmp(&a.2));
            for e in inside {
                if tried.len() < 6 && tried.iter().all(|d| (d - e.1.abs()).abs() > 1e-9 * d) {
                    tried.push(e.1.abs());
                }
            }
        }
        let best = |list: &[f64]| {
            list.iter()
                .copied()
                .max_by(|x, y| self.efficacy(*x).total_cmp(&self.efficacy(*y)))
        };
        let mut d = best(&tried)?;
        if divisors.is_empty() {
            d = best(&[d, d / 2.0, d / 4.0, d / 8.0])?;
        }
        (self.efficacy(d) >= 1e-4).then_some(d)
    }
}

/// How a variable is written by one that is not negative.
#[derive(Clone, Copy)]
enum Shift {
    /// v = bound + t.
    Up(f64),
    /// v = bound − t.
    Down(f64),
    /// v = u·y − t.
    Below(usize, f64),
}

impl<'a> Separator<'a> {
    /// For bounds that hold everywhere.
    pub fn new(mip: &'a Mip, lower: &'a [f64], upper: &'a [f64]) -> Self {
        let p = &mip.problem;
        let mut variable_upper = vec![None; p.n()];
        let mut step = vec![0.0; p.m()];
        for (i, step) in step.iter_mut().enumerate() {
            let entries: Vec<(usize, f64)> = p.rows.line(i).collect();
            *step = step_of(mip, &entries);
            if let [first, second] = entries[..] {
                let (x, y) = if mip.integer[first.0] {
                    (second, first)
                } else {
                    (first, second)
                };
                let at_most = match x.1 > 0.0 {
                    true => p.row_upper[i],
                    false => -p.row_lower[i],
                };
                let u = -y.1 / x.1;
                if !mip.integer[x.0]
                    && mip.integer[y.0]
                    && at_most == 0.0
                    && u > 0.0
                    && lower[y.0] == 0.0
                {
                    variable_upper[x.0] = Some((y.0, u));
                }
            }
        }
        Self {
            mip,
            variable_upper,
            step,
            sequences: sequence::Sequences::find(mip, lower, upper),
            conflicts: clique::Conflicts::find(mip, lower, upper),
            lower,
            upper,
        }
    }

    fn n(&self) -> usize {
        self.mip.problem.n()
    }

    /// Violated cuts at the relaxation's solution, the best first.
    pub fn separate(&mut self, linear: &mut Linear) -> Vec<Cut> {
        let values = linear.simplex.values().to_vec();
        let (n, m) = (self.n(), linear.problem.m());
        self.step.truncate(self.mip.problem.m());
        for i in self.step.len()..m {
            let entries: Vec<(usize, f64)> = linear.problem.rows.line(i).collect();
            self.step.push(step_of(self.mip, &entries));
        }
        let mut found: Vec<(f64, Cut)> = Vec::new();
        let mut add = |made: Option<(f64, Cut)>| found.extend(made);
        // Gomory
        let away = |x: f64| (x - x.round()).abs();
        let fractional = |j: &usize| {
            self.mip.integer[*j] && linear.simplex.is_basic(*j) && away(values[*j]) > FRACTION
        };
        let mut basic: Vec<usize> = (0..n).filter(fractional).collect();
        basic.sort_by(|&a, &b| away(values[b]).total_cmp(&away(values[a])));
        for j in basic.into_iter().take(200) {
            if let Some(weights) = linear.simplex.tableau_multipliers(j) {
                let row = self.aggregate(linear, &weights);
                for sign in [1.0, -1.0] {
                    add(self.round(linear, &row, sign, &values, &[1.0]));
                }
            }
        }
        let sequences = self.sequences.iter();
        let sequences = sequences.flat_map(|s| s.separate(self, &values));
        for cut in sequences.chain(self.conflicts.separate(self, &values)) {
            let mut out = vec![0.0; n];
            cut.terms.iter().for_each(|&(j, a)| out[j] += a);
            add(self.clean(out, cut.side, &values));
        }
        // single and aggregated rows
        for i in (0..self.mip.problem.m()).take(3000) {
            self.path(linear, i, &values, &mut add);
            add(self.cover(i, &values));
        }
        for weights in parity::odd_sums(self, linear, &values) {
            let row = self.aggregate(linear, &weights);
            for sign in [1.0, -1.0] {
                add(self.round(linear, &row, sign, &values, &[2.0]));
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut kept: Vec<Cut> = Vec::new();
        for (_, cut) in found {
            if kept.len() < KEPT && kept.iter().all(|k| parallel(k, &cut) < 0.9) {
                kept.push(cut);
            }
        }
        kept
    }

    /// Σ of rows with weights: coefficients of columns and of the rows' activities; it is 0.
    fn aggregate(&self, linear: &Linear, weights: &Entries) -> Terms {
        let n = self.n();
        let mut sum = vec![0.0; n];
        let mut terms = Terms::new();
        for &(i, w) in weights {
            linear
                .problem
                .rows
                .line(i)
                .for_each(|(j, a)| sum[j] += w * a);
            terms.push((n + i, -w));
        }
        terms.extend((0..n).map(|j| (j, sum[j])));
        let top = terms.iter().fold(0.0f64, |t, e| t.max(e.1.abs()));
        terms.retain(|e| e.1.abs() > 1e-11 * top);
        terms
    }

    /// Aggregates rows from one on until a cut is found.
    fn path(
        &self,
        linear: &Linear,
        first: usize,
        values: &[f64],
        add: &mut dyn FnMut(Option<(f64, Cut)>),
    ) {
        let n = self.n();
        let p = &linear.problem;
        let binds = |i: usize| {
            let s = values[n + i];
            (s - p.row_lower[i]).min(p.row_upper[i] - s).abs() < 1e-6 * s.abs().max(1.0)
        };
        if !binds(first) {
            return;
        }
        let mut weights: Entries = vec![(first, 1.0)];
        for _ in 0..AGGREGATED {
            let row = self.aggregate(linear, &weights);
            let mut any = false;
            for sign in [1.0, -1.0] {
                let cut = self.round(linear, &row, sign, values, &[]);
                any |= cut.is_some();
                add(cut);
            }
            if any {
                return;
            }
            // The continuous column that is farthest from its bounds cancels.
            let room = |j: usize| {
                let x = values[j];
                let above = match self.variable_upper[j] {
                    Some((y, u)) => (u * values[y]).min(self.upper[j]) - x,
                    None => self.upper[j] - x,
                };
                above.min(x - self.lower[j])
            };
            let inner = row
                .iter()
                .filter(|e| e.0 < n && !self.mip.integer[e.0] && room(e.0) > 1e-6);
            let Some(&(j, a)) = inner.max_by(|a, b| room(a.0).total_cmp(&room(b.0))) else {
                return;
            };
            let fits = |e: &(usize, f64)| weights.iter().all(|w| w.0 != e.0) && binds(e.0);
            let short = |i: usize| p.rows.start[i + 1] - p.rows.start[i];
            let next = p
                .columns
                .line(j)
                .filter(fits)
                .min_by_key(|e| (!is_equation(linear, e.0), short(e.0)));
            let Some((i, b)) = next else {
                return;
            };
            weights.push((i, -a / b));
        }
    }

    fn bounds(&self, linear: &Linear, v: usize) -> (f64, f64) {
        match v.checked_sub(self.n()) {
            None => (self.lower[v], self.upper[v]),
            Some(i) => (linear.problem.row_lower[i], linear.problem.row_upper[i]),
        }
    }

    /// The unit in which a variable is an integer; 0 for none.
    fn unit(&self, v: usize) -> f64 {
        match v.checked_sub(self.n()) {
            None => f64::from(u8::from(self.mip.integer[v])),
            Some(i) => self.step[i],
        }
    }

    /// The best rounding of `sign · row ≤ 0`, divided by one of these numbers or by coefficients that suggest themselves.
    fn round(
        &self,
        linear: &Linear,
        row: &Terms,
        sign: f64,
        values: &[f64],
        divisors: &[f64],
    ) -> Option<(f64, Cut)> {
        let s = self.shifted(linear, row, sign, values)?;
        let d = s.divisor(divisors)?;
        let n = self.n();
        let (mut side, f) = (floor(s.b / d), fraction(s.b / d));
        let mut out = vec![0.0; n];
        let mut put = |v: usize, g: f64, shift: Shift, side: &mut f64| {
            let mut add = |v: usize, g: f64| match v.checked_sub(n) {
                None => out[v] += g,
                Some(i) => linear
                    .problem
                    .rows
                    .line(i)
                    .for_each(|(j, a)| out[j] += g * a),
            };
            match shift {
                Shift::Up(l) => {
                    add(v, g);
                    *side += g * l;
                }
                Shift::Down(u) => {
                    add(v, -g);
                    *side -= g * u;
                }
                Shift::Below(y, most) => {
                    add(v, -g);
                    add(y, g * most);
                }
            }
        };
        for e in &s.whole {
            let g = rounded(e.1 / d, f);
            if g != 0.0 {
                put(e.0, g / e.4, e.3, &mut side);
            }
        }
        for e in s.real.iter().filter(|e| e.1 < 0.0) {
            put(e.0, e.1 / d / (1.0 - f), e.3, &mut side);
        }
        self.clean(out, side, values)
    }

    /// `sign · row ≤ 0` in variables that are counted from a bound. None: one has no bound.
    fn shifted(&self, linear: &Linear, row: &Terms, sign: f64, values: &[f64]) -> Option<Shifted> {
        let n = self.n();
        let (mut whole, mut real) = (Vec::new(), Vec::new());
        let mut by_integer: Vec<(usize, f64)> = Vec::new();
        let mut b = 0.0;
        for &(v, a) in row {
            let a = sign * a;
            let (l, u) = self.bounds(linear, v);
            let unit = self.unit(v);
            if l == u {
                b -= a * l;
                continue;
            }
            let x = values[v];
            let (below, above) = (x - l, u - x);
            if unit == 0.0
                && v < n
                && let Some((y, most)) = self.variable_upper[v]
                && most * values[y] - x <= above.min(below)
            {
                by_integer.push((y, a * most));
                real.push((
                    v,
                    -a,
                    (most * values[y] - x).max(0.0),
                    Shift::Below(y, most),
                ));
                continue;
            }
            let (shift, t) = match below <= above {
                true => (Shift::Up(l), below),
                false => (Shift::Down(u), above),
            };
            let (bound, turned) = match shift {
                Shift::Up(l) => (l, a),
                Shift::Down(u) => (u, -a),
                Shift::Below(..) => unreachable!("made above"),
            };
            if bound.is_infinite() {
                return None;
            }
            b -= a * bound;
            match unit > 0.0 && near_whole(bound / unit) {
                true => whole.push((v, turned * unit, (t / unit).max(0.0), shift, unit)),
                false => real.push((v, turned, t.max(0.0), shift)),
            }
        }
        for (y, a) in by_integer {
            match whole.iter_mut().find(|e: &&mut Whole| e.0 == y) {
                Some(e) => match e.3 {
                    Shift::Up(l) => {
                        e.1 += a;
                        b -= a * l;
                    }
                    Shift::Down(u) => {
                        e.1 -= a;
                        b -= a * u;
                    }
                    Shift::Below(..) => return None,
                },
                None => {
                    let (l, u) = (self.lower[y], self.upper[y]);
                    if l == u {
                        b -= a * l;
                        continue;
                    }
                    let x = values[y];
                    let up = x - l <= u - x;
                    b -= a * if up { l } else { u };
                    whole.push(match up {
                        true => (y, a, x - l, Shift::Up(l), 1.0),
                        false => (y, -a, u - x, Shift::Down(u), 1.0),
                    });
                }
            }
        }
        Some(Shifted { whole, real, b })
    }

    /// A cut with neither tiny nor very different coefficients, and by how much it is violated.
    fn clean(&self, mut out: Vec<f64>, mut side: f64, values: &[f64]) -> Option<(f64, Cut)> {
        let top = out.iter().fold(0.0f64, |t, a| t.max(a.abs()));
        if !(top > 1e-9 && top < 1e9 && side.is_finite()) {
            return None;
        }
        let scale = 2f64.powi(-(top.log2().round() as i32));
        side *= scale;
        let mut terms = Terms::new();
        let (mut activity, mut norm) = (0.0, 0.0);
        for (j, a) in out.iter_mut().enumerate().filter(|e| *e.1 != 0.0) {
            let a = *a * scale;
            if a.abs() < 1e-6 {
                let bound = if a > 0.0 {
                    self.lower[j]
                } else {
                    self.upper[j]
                };
                if bound.is_infinite() {
                    return None;
                }
                side -= a * bound;
                continue;
            }
            terms.push((j, a));
            activity += a * values[j];
            norm += a * a;
        }
        let most = 100 + self.n() / 3;
        side += 1e-9 * side.abs().max(1.0);
        let step = step_of(self.mip, &terms);
        if step > 0.0 {
            side = step * (side / step + 1e-6).floor();
        }
        let efficacy = (activity - side) / f64::max(norm, 1e-12).sqrt();
        (efficacy > 1e-4 && terms.len() <= most && !terms.is_empty())
            .then_some((efficacy, Cut { terms, side }))
    }

    /// Of binaries that do not fit into a row together all but one fit at most, and so with larger ones besides.
    fn cover(&self, i: usize, values: &[f64]) -> Option<(f64, Cut)> {
        let p = &self.mip.problem;
        let (l, u) = (p.row_lower[i], p.row_upper[i]);
        let sign = match (l.is_finite(), u.is_finite()) {
            (false, true) => 1.0,
            (true, false) => -1.0,
            _ => return None,
        };
        let mut capacity = if sign > 0.0 { u } else { -l };
        // Items with weight, value and whether they stand for 1 − x.
        let mut items: Vec<(usize, f64, f64, bool)> = Vec::new();
        for (j, a) in p.rows.line(i) {
            let a = sign * a;
            if !self.mip.integer[j] || self.lower[j] < 0.0 || self.upper[j] > 1.0 {
                return None;
            }
            let x = values[j];
            if a > 0.0 {
                items.push((j, a, x, false));
            } else {
                capacity -= a;
                items.push((j, -a, 1.0 - x, true));
            }
        }
        let total: f64 = items.iter().map(|e| e.1).sum();
        if items.len() < 2 || capacity < 0.0 || total <= capacity {
            return None;
        }
        items.sort_by(|a, b| ((1.0 - a.2) / a.1).total_cmp(&((1.0 - b.2) / b.1)));
        let mut cover = Vec::new();
        let (mut weight, margin) = (0.0, 1e-6 * capacity.abs().max(1.0));
        for &e in &items {
            if weight > capacity + margin {
                break;
            }
            weight += e.1;
            cover.push(e);
        }
        if weight <= capacity + margin {
            return None;
        }
        // Minimal: what can go without it fitting goes, the least used first.
        cover.sort_by(|a, b| a.2.total_cmp(&b.2));
        cover.retain(|e| {
            let goes = weight - e.1 > capacity + margin;
            weight -= if goes { e.1 } else { 0.0 };
            !goes
        });
        let heaviest = cover.iter().fold(0.0f64, |t, e| t.max(e.1));
        let side = cover.len() as f64 - 1.0;
        let members: Vec<usize> = cover.iter().map(|e| e.0).collect();
        let extension = items
            .iter()
            .filter(|e| e.1 >= heaviest && !members.contains(&e.0));
        let (mut out, mut side) = (vec![0.0; self.n()], side);
        for e in cover.iter().chain(extension) {
            out[e.0] = if e.3 { -1.0 } else { 1.0 };
            side -= f64::from(u8::from(e.3));
        }
        self.clean(out, side, values)
    }
}

/// The number that all coefficients are multiples of, where all columns are integers; 0 for none.
fn step_of(mip: &Mip, entries: &[(usize, f64)]) -> f64 {
    let steps = [1.0, 0.5, 0.25, 0.125, 0.0625, 0.1, 0.01];
    let divides = |s: &f64| entries.iter().all(|e| near_whole(e.1 / s));
    match entries.iter().all(|e| mip.integer[e.0]) {
        true => steps.into_iter().find(divides).unwrap_or(0.0),
        false => 0.0,
    }
}

fn is_equation(linear: &Linear, i: usize) -> bool {
    linear.problem.row_lower[i] == linear.problem.row_upper[i]
}

fn near_whole(v: f64) -> bool {
    (v - v.round()).abs() < 1e-9 * v.abs().max(1.0)
}

fn floor(v: f64) -> f64 {
    (v + 1e-9).floor()
}

fn fraction(v: f64) -> f64 {
    (v - floor(v)).max(0.0)
}

/// The coefficient of an integer in a rounded row whose right-hand side has the fraction f.
fn rounded(a: f64, f: f64) -> f64 {
    floor(a) + (fraction(a) - f).max(0.0) / (1.0 - f)
}

/// Cosine of the angle between two cuts.
fn parallel(a: &Cut, b: &Cut) -> f64 {
    let norm = |c: &Cut| c.terms.iter().map(|t| t.1 * t.1).sum::<f64>().sqrt();
    let (mut i, mut k, mut sum) = (0, 0, 0.0);
    while i < a.terms.len() && k < b.terms.len() {
        let (s, t) = (a.terms[i], b.terms[k]);
        match s.0.cmp(&t.0) {
            std::cmp::Ordering::Less => i += 1,
            std::cmp::Ordering::Greater => k += 1,
            std::cmp::Ordering::Equal => {
                sum += s.1 * t.1;
                (i, k) = (i + 1, k + 1);
            }
        }
    }
    sum / (norm(a) * norm(b)).max(1e-12)
}
