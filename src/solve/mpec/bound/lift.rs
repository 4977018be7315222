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
//! **What is left out.** e_A·z_j for columns z_j which equations of B determine: it follows from the other
//! products. And most products with *opposite columns*, two columns without upper bounds whose
//! entries are each other's negatives (the positive and negative part of one quantity): a solution may
//! increase both without end, so that no product with them can say anything where that is possible.
//! Only those with the entries of their own pairs' rows are kept, which the pairs' equations
//! need. Fewer products are a weaker relaxation, never a wrong one.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::super::pairs::Program;
use super::super::split::sides;
use crate::model::instance::{
    ColumnKind, Columns, Instance, Objective, Relation, Rows, Sense, SparseRows,
};

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
    /// Of opposite columns: the other side's columns with which there are products.
    near: Vec<Option<Vec<usize>>>,
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
            near: vec![None; columns.len()],
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

    /// A side without columns.
    fn nothing() -> Self {
        Self {
            count: 0,
            equations: Vec::new(),
            inequalities: Vec::new(),
            pair: Vec::new(),
            determined: Vec::new(),
            near: Vec::new(),
        }
    }

    /// The sum of the inequalities, without its constant.
    fn total(&self) -> Factor {
        let mut sum: BTreeMap<usize, f64> = BTreeMap::new();
        for (j, v) in self.inequalities.iter().flat_map(|f| &f.terms) {
            *sum.entry(*j).or_default() += v;
        }
        Factor {
            terms: sum.into_iter().filter(|e| e.1 != 0.0).collect(),
            constant: 0.0,
        }
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
        let near = &self.near;
        let determined = &mut self.determined;
        let one = self.count;
        self.equations.retain(|f| {
            if f.terms.iter().any(|t| near[t.0].is_some()) {
                return true;
            }
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

/// Marks pairs of opposite columns of a side, with the columns of the other that stand in the rows of
/// their pairs.
fn opposites(
    program: &Program,
    on_a: &[bool],
    which: bool,
    place: [&[usize]; 2],
    half: &mut Half,
    one: usize,
) {
    let instance = &program.envelope;
    let (m, n) = (instance.row_count(), instance.column_count());
    let [own, other] = place;
    let mut entries: BTreeMap<usize, Vec<(usize, u64)>> = BTreeMap::new();
    for i in (0..m).filter(|&i| on_a[n + i] == which) {
        for (j, a) in instance.matrix.row(i) {
            entries.entry(j).or_default().push((i, a.to_bits()));
        }
    }
    // Columns by their entries; a column's opposite has the same with other signs.
    const SIGN: u64 = 1 << 63;
    let mut known: HashMap<Vec<(usize, u64)>, usize> = HashMap::new();
    let mut found = Vec::new();
    for (j, list) in entries {
        let unbounded = instance.columns.lower[j].is_finite() && instance.columns.upper[j] >= 1e30;
        if own[j] == usize::MAX || !unbounded {
            continue;
        }
        let flipped: Vec<(usize, u64)> = list.iter().map(|&(i, a)| (i, a ^ SIGN)).collect();
        match known.remove(&flipped) {
            Some(k) => found.push((k, j)),
            None => {
                known.insert(list, j);
            }
        }
    }
    for (j, k) in found {
        let mut near = Vec::new();
        for p in program
            .pairs
            .iter()
            .filter(|p| p.column == j || p.column == k)
        {
            let f = factor(program, p.row, other);
            near.extend(f.all(one).map(|t| t.0));
        }
        near.sort_unstable();
        near.dedup();
        half.near[own[j]] = Some(near.clone());
        half.near[own[k]] = Some(near);
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

    /// Whether the product of two columns (or 1) is there.
    fn has(&self, i: usize, j: usize) -> bool {
        let near = |half: &Half, own: usize, other: usize| {
            let list = half.near.get(own).and_then(Option::as_ref);
            list.is_none_or(|l| l.binary_search(&other).is_ok())
        };
        near(self.a, i, j) && near(self.b, j, i)
    }

    fn column(&mut self, i: usize, j: usize) -> u32 {
        let next = self.lower.len() as u32;
        let number = *self.number.entry((i as u32, j as u32)).or_insert(next);
        if number == next {
            self.free();
        }
        number
    }

    /// A column that is no product.
    fn free(&mut self) -> usize {
        self.lower.push(f64::NEG_INFINITY);
        self.upper.push(f64::INFINITY);
        self.lower.len() - 1
    }

    /// One more entry of the last row.
    fn also(&mut self, column: usize, value: f64) {
        self.matrix.column.push(column as u32);
        self.matrix.value.push(value);
        if let Some(end) = self.matrix.start.last_mut() {
            *end += 1;
        }
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
        for (i, _) in f.all(one_a) {
            if g.all(one_b).any(|(j, _)| !self.has(i, j)) {
                return;
            }
        }
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
        opposites(program, &on_a, true, [&place_a, &place_b], &mut a, count_b);
        opposites(program, &on_a, false, [&place_b, &place_a], &mut b, count_a);
        a.reduce();
        b.reduce();
        Some(Self {
            a,
            b,
            target: place_a[objective],
            sense: match program.sign() < 0.0 {
                true => Sense::Maximize,
                false => Sense::Minimize,
            },
        })
    }

    fn half(&mut self, first: bool) -> &mut Half {
        match first {
            true => &mut self.a,
            false => &mut self.b,
        }
    }

    /// The linear program of one side alone whose optimum is the largest sum of its inequalities.
    pub fn size(&mut self, first: bool) -> Instance {
        let half = self.half(first);
        let nothing = Half::nothing();
        let total = half.total();
        let mut out = Lifted::new(half, &nothing);
        let one = Factor::one();
        for e in &half.equations {
            out.row(e, &one, Relation::Equal);
        }
        for f in &half.inequalities {
            out.row(f, &one, Relation::Greater);
        }
        let target = out.free();
        out.row(&total, &one, Relation::Equal);
        out.also(target, -1.0);
        out.instance(target, Sense::Maximize)
    }

    /// Takes it as proved that the sum of a side's inequalities is at most this.
    pub fn bound(&mut self, first: bool, size: f64) {
        let half = self.half(first);
        let mut f = negative(half.total());
        f.constant = size;
        half.inequalities.push(f);
    }

    /// Products of two columns, at most.
    pub fn products(&self) -> usize {
        let global = |h: &Half| h.near.iter().filter(|n| n.is_none()).count() + 1;
        global(&self.a) * global(&self.b)
    }

    /// The linear relaxation.
    pub fn lift(&self) -> Instance {
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
        out.instance(target, self.sense)
    }
}
