//! A program whose pairs couple two systems that share nothing else, as factors of products.
//!
//! x obeys the rows of side A, z those of side B ([`super::super::split`]). With 1 as a further column of each, a row is
//! a linear form: an equation of A is e·(x, 1) = 0, an inequality g·(x, 1) ≥ 0, a pair is one inequality of either side
//! whose product is 0.
//!
//! *Opposite columns* are two of side B without upper bounds whose entries are each other's negatives:
//! the positive and negative part of one quantity. A solution in which both are positive stays one, of the
//! same value, if both are lowered until one is 0; so one of them may be taken to be 0.

use std::collections::{BTreeMap, HashMap};

use super::super::pairs::Program;
use super::super::split::sides;
use crate::model::instance::{INFINITE, Relation};
use crate::solve::lp::form::Problem;

/// Σ terms + constant, over the columns of one side.
#[derive(Clone, Debug, Default)]
pub(super) struct Factor {
    /// Column and coefficient.
    pub terms: Vec<(usize, f64)>,
    /// Of the column 1.
    pub constant: f64,
}

impl Factor {
    /// One column.
    pub(super) fn column(j: usize) -> Self {
        Self {
            terms: vec![(j, 1.0)],
            constant: 0.0,
        }
    }

    /// 1.
    pub(super) fn one() -> Self {
        Self {
            terms: Vec::new(),
            constant: 1.0,
        }
    }

    /// As many times.
    pub(super) fn times(mut self, by: f64) -> Self {
        self.terms.iter_mut().for_each(|t| t.1 *= by);
        self.constant *= by;
        self
    }

    /// Terms with the constant as that of a last column, which is 1.
    pub(super) fn all(&self, one: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let constant = (self.constant != 0.0).then_some((one, self.constant));
        self.terms.iter().copied().chain(constant)
    }
}

/// One side.
pub(super) struct Half {
    /// Columns; the number after the last stands for 1.
    pub count: usize,
    /// Factors that are 0.
    pub equations: Vec<Factor>,
    /// Factors that are not negative; the last is 1.
    pub inequalities: Vec<Factor>,
    /// Per pair, which of the inequalities is its.
    pair: Vec<Option<usize>>,
    /// Of opposite columns: the other one.
    pub opposite: Vec<Option<usize>>,
    /// Columns that are not negative.
    signed: Vec<bool>,
}

/// An equation's columns as found in one side, and the constant of the others.
fn factor(program: &Program, row: usize, place: &[usize]) -> Factor {
    let instance = &program.envelope;
    let mut out = Factor {
        terms: Vec::new(),
        constant: -instance.rows.rhs[row],
    };
    for (j, a) in instance.matrix.row(row) {
        match place[j] {
            usize::MAX => out.constant += a * instance.columns.lower[j],
            k => out.terms.push((k, a)),
        }
    }
    out
}

impl Half {
    fn new(program: &Program, on_a: &[bool], which: bool, place: &[usize]) -> Self {
        let instance = &program.envelope;
        let (m, n) = (instance.row_count(), instance.column_count());
        let columns: Vec<usize> = (0..n).filter(|&j| on_a[j] == which).collect();
        let mut out = Self {
            count: columns.len(),
            equations: Vec::new(),
            inequalities: Vec::new(),
            pair: vec![None; program.pairs.len()],
            opposite: vec![None; columns.len()],
            signed: vec![false; columns.len()],
        };
        let mut of_row = vec![None; m];
        let mut of_column = vec![None; n];
        for i in (0..m).filter(|&i| on_a[n + i] == which) {
            let f = factor(program, i, place);
            match instance.rows.relation[i] {
                Relation::Equal => out.equations.push(f),
                Relation::Greater => {
                    of_row[i] = Some(out.inequalities.len());
                    out.inequalities.push(f);
                }
                Relation::Less => {
                    of_row[i] = Some(out.inequalities.len());
                    out.inequalities.push(f.times(-1.0));
                }
                Relation::Free => {}
            }
        }
        for (k, &j) in columns.iter().enumerate() {
            let (l, u) = (instance.columns.lower[j], instance.columns.upper[j]);
            if l == u {
                let mut f = Factor::column(k);
                f.constant = -l;
                out.equations.push(f);
                continue;
            }
            if u < INFINITE {
                let mut f = Factor::column(k).times(-1.0);
                f.constant = u;
                of_column[j] = Some(out.inequalities.len());
                out.inequalities.push(f);
            }
            if l > -INFINITE {
                let mut f = Factor::column(k);
                f.constant = -l;
                out.signed[k] = l >= 0.0;
                of_column[j] = Some(out.inequalities.len());
                out.inequalities.push(f);
            }
        }
        for (k, p) in program.pairs.iter().enumerate() {
            // With two bounds there are three pieces and no product that is 0.
            if p.lower.is_infinite() || p.upper.is_infinite() {
                out.pair[k] = match on_a[n + p.row] == which {
                    true => of_row[p.row],
                    false => of_column[p.column],
                };
            }
        }
        out
    }
}

/// Marks pairs of opposite columns of a side.
fn opposites(program: &Program, place: &[usize], half: &mut Half) {
    let instance = &program.envelope;
    let mut entries: BTreeMap<usize, Vec<(usize, u64)>> = BTreeMap::new();
    for i in 0..instance.row_count() {
        for (j, a) in instance.matrix.row(i).filter(|e| place[e.0] != usize::MAX) {
            entries.entry(j).or_default().push((i, a.to_bits()));
        }
    }
    // Columns by their entries; a column's opposite has the same with other signs.
    const SIGN: u64 = 1 << 63;
    let mut known: HashMap<Vec<(usize, u64)>, usize> = HashMap::new();
    for (j, list) in entries {
        let ray = instance.columns.lower[j] == 0.0 && instance.columns.upper[j] >= INFINITE;
        if !ray {
            continue;
        }
        let flipped: Vec<(usize, u64)> = list.iter().map(|&(i, a)| (i, a ^ SIGN)).collect();
        match known.remove(&flipped) {
            Some(k) => {
                half.opposite[place[j]] = Some(place[k]);
                half.opposite[place[k]] = Some(place[j]);
            }
            None => {
                known.insert(list, j);
            }
        }
    }
}

/// The two sides of a program.
pub(super) struct Sides {
    /// That of the objective.
    pub a: Half,
    /// The other one.
    pub b: Half,
    columns: [Vec<usize>; 2],
    /// The objective's column on side A.
    target: usize,
    /// Of the objective: 1 if it is minimised, else −1.
    sign: f64,
}

impl Sides {
    /// None: the program does not come apart. Solutions whose (minimised) objective is above `cutoff`
    /// are left out.
    pub(super) fn new(program: &Program, cutoff: f64) -> Option<Self> {
        let on_a = sides(program)?;
        let objective = program.envelope.objective?.column as usize;
        let (mut place_a, mut place_b) =
            (vec![usize::MAX; on_a.len()], vec![usize::MAX; on_a.len()]);
        let (mut count_a, mut count_b) = (0, 0);
        for j in 0..program.envelope.column_count() {
            let (place, count) = match on_a[j] {
                true => (&mut place_a, &mut count_a),
                false => (&mut place_b, &mut count_b),
            };
            place[j] = *count;
            *count += 1;
        }
        let mut a = Half::new(program, &on_a, true, &place_a);
        let mut b = Half::new(program, &on_a, false, &place_b);
        a.inequalities.push(Factor {
            terms: vec![(place_a[objective], -program.sign())],
            constant: cutoff,
        });
        opposites(program, &place_b, &mut b);
        a.inequalities.push(Factor::one());
        b.inequalities.push(Factor::one());
        let count = program.envelope.column_count();
        Some(Self {
            a,
            b,
            columns: [true, false].map(|which| (0..count).filter(|&j| on_a[j] == which).collect()),
            target: place_a[objective],
            sign: program.sign(),
        })
    }

    /// The program of side A alone.
    pub(super) fn first(&self) -> Problem {
        let a = &self.a;
        let mut p = Problem {
            cost: vec![0.0; a.count],
            lower: vec![f64::NEG_INFINITY; a.count],
            upper: vec![f64::INFINITY; a.count],
            ..Problem::default()
        };
        p.cost[self.target] = self.sign;
        let equations = a.equations.iter().map(|f| (f, 0.0));
        let inequalities = a.inequalities.iter().map(|f| (f, f64::INFINITY));
        let inequalities = inequalities.filter(|i| !i.0.terms.is_empty());
        for (f, room) in equations.chain(inequalities) {
            p.rows.push(f.terms.iter().copied());
            p.row_lower.push(-f.constant);
            p.row_upper.push(room - f.constant);
        }
        p.columns = p.rows.transpose(a.count);
        p
    }

    /// Columns of the program that are on side A, or on B.
    pub(super) fn columns(&self, on_a: bool) -> &[usize] {
        &self.columns[usize::from(!on_a)]
    }

    /// What stands there in a vector over all columns.
    pub(super) fn pick(&self, on_a: bool, all: &[f64]) -> Vec<f64> {
        self.columns(on_a).iter().map(|&j| all[j]).collect()
    }

    /// The objective as a linear form of side A, minimised.
    pub(super) fn objective(&self) -> Factor {
        Factor {
            terms: vec![(self.target, self.sign)],
            constant: 0.0,
        }
    }

    /// Inequalities of A and B whose products the pairs make 0.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let both = self.a.pair.iter().zip(&self.b.pair);
        both.filter_map(|(k, l)| Some(((*k)?, (*l)?)))
    }

    /// What the equations of side B say about the size of its columns where that of some is known:
    /// |z_j| ≤ `radius[j]`, infinite where it is not. Only sums of magnitudes are used, so that radii
    /// k times as large give radii at most k times as large, for k ≥ 1.
    pub(super) fn spread(&self, radius: &mut [f64]) {
        let b = &self.b;
        loop {
            let mut better = false;
            for f in &b.equations {
                let open = |t: &&(usize, f64)| radius[t.0].is_infinite();
                let known = f.terms.iter().filter(|t| !open(t));
                let sum =
                    known.fold(f.constant.abs(), |s, t| s + t.1.abs() * radius[t.0]) * 1.000_001;
                let unknown: Vec<(usize, f64)> = f.terms.iter().filter(open).copied().collect();
                let one_sign = |s: f64| unknown.iter().all(|t| b.signed[t.0] && t.1 * s > 0.0);
                let same = unknown.len() == 1 || one_sign(1.0) || one_sign(-1.0);
                // Of two opposite ones, one is 0.
                let two = matches!(unknown[..], [(j, _), (k, _)] if b.opposite[j] == Some(k));
                if same || two {
                    for (j, a) in unknown {
                        radius[j] = sum / a.abs();
                        better = true;
                    }
                }
            }
            if !better {
                return;
            }
        }
    }
}
