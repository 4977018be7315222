//! Products of the two sides: a linear relaxation that knows what every solution must obey together.
//!
//! Let the program come apart ([`super::super::split`]): x obeys rows of side A, z rows of side B, and the
//! pairs F_k ⟂ v_k join one of each. Every product of a valid equation or inequality of A with one of B
//! is valid, and linear in the columns of either side and the products W_ij = x_i z_j (the
//! reformulation–linearisation technique of Sherali & Adams, its first level):
//!
//! ```text
//!     e_A(x)·z_j = 0,   x_i·e_B(z) = 0,   g_A(x)·g_B(z) ≥ 0,   F_k·(v_k − l_k) = 0 .
//! ```
//!
//! With W_ij as columns of their own this is a linear program, and its value is a lower bound. The
//! pairs, the only thing that is not linear, have become equations. No bound on any column is needed or
//! assumed, which is what envelopes of products or big numbers M would ask for. Identities that follow
//! from the equations of both sides are contained: in limit analysis, xᵀ(compatibility) −
//! uᵀ(equilibrium) is the work equation α = −f_Dᵀu + Σ tan φ nᵢ|γᵢ|.
//!
//! Left out are e_A·z_j for columns z_j which equations of B determine: they follow from the other
//! products.
//!
//! *Opposite columns* are two of side B without upper bounds whose entries are each other's negatives:
//! the positive and negative part of one quantity. A solution in which both are positive stays one, of the
//! same value, if both are lowered until one is 0; so one of them may be taken to be 0.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::super::pairs::Program;
use super::super::split::sides;
use crate::model::instance::{
    ColumnKind, Columns, Instance, Objective, Relation, Rows, Sense, SparseRows,
};
use crate::solve::lp::form::{Problem, Sparse};

/// Σ terms + constant, over the columns of one side.
#[derive(Clone, Debug, Default)]
struct Factor {
    terms: Vec<(usize, f64)>,
    constant: f64,
}

impl Factor {
    fn column(j: usize) -> Self {
        Self {
            terms: vec![(j, 1.0)],
            constant: 0.0,
        }
    }

    fn one() -> Self {
        Self {
            terms: Vec::new(),
            constant: 1.0,
        }
    }

    /// Terms with the constant as that of a last column, which is 1.
    fn all(&self, one: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let constant = (self.constant != 0.0).then_some((one, self.constant));
        self.terms.iter().copied().chain(constant)
    }
}

/// One side.
struct Half {
    /// Columns; the number after the last stands for 1.
    count: usize,
    /// Factors that are 0.
    equations: Vec<Factor>,
    /// Factors that are not negative.
    inequalities: Vec<Factor>,
    /// Per pair, which of the inequalities is its.
    pair: Vec<Option<usize>>,
    /// Columns that the equations determine by others.
    determined: Vec<bool>,
    /// Of opposite columns: the other one.
    opposite: Vec<Option<usize>>,
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

fn negative(mut f: Factor) -> Factor {
    f.terms.iter_mut().for_each(|t| t.1 = -t.1);
    f.constant = -f.constant;
    f
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
            determined: vec![false; columns.len()],
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
                    out.inequalities.push(negative(f));
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
            if u < 1e30 {
                let mut f = negative(Factor::column(k));
                f.constant = u;
                of_column[j] = Some(out.inequalities.len());
                out.inequalities.push(f);
            }
            if l > -1e30 {
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

    /// Finds what is redundant: equations that follow from others go, and the columns that the rest
    /// determines are marked.
    fn reduce(&mut self) {
        let mut bounded = vec![false; self.count];
        for f in &self.inequalities {
            if let [(j, _)] = f.terms[..] {
                bounded[j] = true;
            }
        }
        // Row echelon form as far as it comes: pivot column and row.
        let mut echelon: Vec<(usize, BTreeMap<usize, f64>)> = Vec::new();
        let determined = &mut self.determined;
        let one = self.count;
        self.equations.retain(|f| {
            let mut row: BTreeMap<usize, f64> = f.all(one).collect();
            let size = row.values().fold(0.0f64, |s, v| s.max(v.abs()));
            for (p, other) in &echelon {
                let Some(&v) = row.get(p) else { continue };
                let ratio = v / other[p];
                for (&j, &a) in other {
                    *row.entry(j).or_default() -= ratio * a;
                }
                row.retain(|j, v| j != p && v.abs() > 1e-12 * size);
            }
            let score = |(j, v): (&usize, &f64)| {
                let preferred = if bounded[*j] { 2.0 } else { 1.0 };
                (v.abs() * preferred, *j)
            };
            let free = row.iter().filter(|e| *e.0 < one);
            let Some((_, pivot)) = free.map(score).max_by(|a, b| a.0.total_cmp(&b.0)) else {
                // Nothing is left, or a contradiction, which is to stay.
                return !row.is_empty();
            };
            determined[pivot] = true;
            echelon.push((pivot, row));
            true
        });
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
        let ray = instance.columns.lower[j] == 0.0 && instance.columns.upper[j] >= 1e30;
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

/// The relaxation, growing.
struct Lifted<'a> {
    a: &'a Half,
    b: &'a Half,
    number: HashMap<(u32, u32), u32>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    rows: Rows,
    matrix: SparseRows,
}

impl<'a> Lifted<'a> {
    fn new(a: &'a Half, b: &'a Half) -> Self {
        Self {
            a,
            b,
            number: HashMap::new(),
            lower: Vec::new(),
            upper: Vec::new(),
            rows: Rows::default(),
            matrix: SparseRows {
                start: vec![0],
                ..SparseRows::default()
            },
        }
    }

    fn column(&mut self, i: usize, j: usize) -> u32 {
        let next = self.lower.len() as u32;
        let number = *self.number.entry((i as u32, j as u32)).or_insert(next);
        if number == next {
            self.lower.push(f64::NEG_INFINITY);
            self.upper.push(f64::INFINITY);
        }
        number
    }

    fn instance(mut self, target: usize, sense: Sense) -> Instance {
        let (count, m) = (self.lower.len(), self.rows.rhs.len());
        self.rows.marginal = vec![0.0; m];
        self.rows.scale = vec![1.0; m];
        Instance {
            columns: Columns {
                lower: self.lower,
                upper: self.upper,
                level: vec![0.0; count],
                marginal: vec![0.0; count],
                scale: vec![1.0; count],
                kind: vec![ColumnKind::Continuous; count],
            },
            rows: self.rows,
            matrix: self.matrix,
            nonlinear: Vec::new(),
            objective: Some(Objective {
                column: target as u32,
                sense,
            }),
            matched: None,
        }
    }

    /// f·g = 0 or ≥ 0.
    fn row(&mut self, f: &Factor, g: &Factor, relation: Relation) {
        let (one_a, one_b) = (self.a.count, self.b.count);
        let mut entries: BTreeMap<u32, f64> = BTreeMap::new();
        let mut rhs = 0.0;
        // A coefficient that would be rounded makes another row than the one that is valid.
        let rounded = |v: f64, w: f64| v.mul_add(w, -(v * w)) != 0.0;
        if f.all(one_a)
            .any(|(_, v)| g.all(one_b).any(|(_, w)| rounded(v, w)))
        {
            return;
        }
        for (i, v) in f.all(one_a) {
            for (j, w) in g.all(one_b) {
                match (i, j) == (one_a, one_b) {
                    true => rhs -= v * w,
                    false => *entries.entry(self.column(i, j)).or_default() += v * w,
                }
            }
        }
        entries.retain(|_, v| *v != 0.0);
        let mut list = entries.iter();
        match (list.next(), list.next()) {
            (None, _) => {}
            (Some((&j, &v)), None) if rhs == 0.0 => {
                let j = j as usize;
                if v > 0.0 || relation == Relation::Equal {
                    self.lower[j] = self.lower[j].max(0.0);
                }
                if v < 0.0 || relation == Relation::Equal {
                    self.upper[j] = self.upper[j].min(0.0);
                }
            }
            _ => {
                self.matrix.column.extend(entries.keys());
                self.matrix.value.extend(entries.values());
                self.matrix.start.push(self.matrix.column.len());
                self.rows.relation.push(relation);
                self.rows.rhs.push(rhs);
            }
        }
    }
}

/// The two sides of a program.
pub struct Sides {
    a: Half,
    b: Half,
    columns: Vec<usize>,
    /// The objective's column on side A.
    target: usize,
    sense: Sense,
}

impl Sides {
    /// None: the program does not come apart. Solutions whose (minimised) objective is above `cutoff`
    /// are left out.
    pub fn new(program: &Program, cutoff: f64) -> Option<Self> {
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
        a.reduce();
        b.reduce();
        Some(Self {
            a,
            b,
            columns: (0..program.envelope.column_count())
                .filter(|&j| on_a[j])
                .collect(),
            target: place_a[objective],
            sense: match program.sign() < 0.0 {
                true => Sense::Maximize,
                false => Sense::Minimize,
            },
        })
    }

    /// The program of side A alone.
    pub fn first(&self) -> Problem {
        let a = &self.a;
        let mut p = Problem {
            cost: vec![0.0; a.count],
            lower: vec![f64::NEG_INFINITY; a.count],
            upper: vec![f64::INFINITY; a.count],
            rows: Sparse::new(),
            ..Problem::default()
        };
        p.cost[self.target] = self.sense.sign();
        let equations = a.equations.iter().map(|f| (f, 0.0));
        let inequalities = a.inequalities.iter().map(|f| (f, f64::INFINITY));
        for (f, room) in equations.chain(inequalities) {
            p.rows.push(f.terms.iter().copied());
            p.row_lower.push(-f.constant);
            p.row_upper.push(room - f.constant);
        }
        p.columns = p.rows.transpose(a.count);
        p
    }

    /// Columns of the program that are on side A.
    pub fn columns(&self) -> &[usize] {
        &self.columns
    }

    /// Number of columns of side B.
    pub fn count(&self) -> usize {
        self.b.count
    }

    /// Products of two columns.
    pub fn products(&self) -> usize {
        (self.a.count + 1) * (self.b.count + 1)
    }

    /// What the equations of side B say about the size of its columns where that of some is known:
    /// |z_j| ≤ `radius[j]`, infinite where it is not. Only sums of magnitudes are used, so that radii
    /// k times as large give radii at most k times as large, for k ≥ 1.
    pub fn spread(&self, radius: &mut [f64]) {
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

    /// Whether the column of side B is not negative.
    pub fn is_signed(&self, j: usize) -> bool {
        self.b.signed[j]
    }

    /// Whether the column is one of two opposite ones.
    pub fn is_opposite(&self, j: usize) -> bool {
        self.b.opposite[j].is_some()
    }

    /// The linear relaxation, and which columns each of its columns is the product of: (i, j), with the
    /// number after the last one for 1.
    pub fn lift(&self) -> (Instance, Vec<(usize, usize)>) {
        let (a, b) = (&self.a, &self.b);
        let mut out = Lifted::new(a, b);
        let target = out.column(self.target, b.count) as usize;
        let one = Factor::one();
        for e in &a.equations {
            for j in (0..b.count).filter(|&j| !b.determined[j]) {
                out.row(e, &Factor::column(j), Relation::Equal);
            }
            out.row(e, &one, Relation::Equal);
        }
        for e in &b.equations {
            for i in 0..a.count {
                out.row(&Factor::column(i), e, Relation::Equal);
            }
            out.row(&one, e, Relation::Equal);
        }
        let pairs = a.pair.iter().zip(&b.pair);
        let pairs: HashSet<(usize, usize)> =
            pairs.filter_map(|(k, l)| Some(((*k)?, (*l)?))).collect();
        for (k, f) in a.inequalities.iter().enumerate() {
            for (l, g) in b.inequalities.iter().enumerate() {
                let relation = match pairs.contains(&(k, l)) {
                    true => Relation::Equal,
                    false => Relation::Greater,
                };
                out.row(f, g, relation);
            }
            out.row(f, &one, Relation::Greater);
        }
        for g in &b.inequalities {
            out.row(&one, g, Relation::Greater);
        }
        let mut products = vec![(0, 0); out.lower.len()];
        for (&(i, j), &k) in &out.number {
            products[k as usize] = (i as usize, j as usize);
        }
        (out.instance(target, self.sense), products)
    }
}
