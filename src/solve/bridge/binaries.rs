//! Products with a binary factor: a column and linear rows in their place.
//!
//! ```text
//!     w = b y,  b ∈ {0, 1},  l ≤ y ≤ u      ⟺      l b ≤ w ≤ u b,    y − u (1 − b) ≤ w ≤ y − l (1 − b)
//!     w = b₁ b₂ … bₖ                        ⟺      0 ≤ w ≤ bᵢ,       w ≥ Σ bᵢ − (k − 1)
//! ```
//!
//! (Fortet 1960; McCormick 1976.) An equation of binaries times another binary is an equation of such products: where half of
//! them are there, it is added, which is much of what is known of the others (Adams & Sherali 1986; for assignments it is what
//! makes bounds worth something). Of a product of integers all but one are written in bits, x = l + Σ 2ᵏ bₖ, where their ranges are
//! short (Watters 1967). Powers and products of sums are multiplied out first. Functions stay, and products without
//! a binary factor. Where a row gains only from a product that is too small, or only from one that is too large, the rows that
//! forbid the other are left out. The new columns and rows come last, so that a point begins with that of the program itself.

use super::builder::Builder;
use super::parts::{directions, expressions};
use crate::model::builder::Term;
use crate::model::instance::{ColumnKind, Function, Instance, Op, Relation};
use crate::solve::discrete::Mip;
use crate::solve::discrete::propagate::Propagator;
use std::collections::BTreeMap;

/// Columns of a product, in order; a binary one stands there once.
type Monomial = Vec<u32>;

/// Coefficients of products.
type Polynomial = BTreeMap<Monomial, f64>;

/// Products that are multiplied out of one term, at most.
const MAX_TERM_PRODUCTS: usize = 10_000;

/// New columns, at most: a search over more of them is no better than one over the nonlinear program.
const MAX_NEW_COLUMNS: usize = 20_000;

/// Values of an integer column that is written in bits, at most, less one: a longer one has a bound worth little.
const MAX_RANGE: f64 = 255.0;

/// Bounds of the other factor, at most: what is multiplied by a binary that is 0 to a tolerance is to be 0, too.
const MAX_FACTOR_BOUND: f64 = 1e6;

/// A program without products that have a binary factor.
pub(in crate::solve) struct Replaced {
    /// The program.
    pub(in crate::solve) instance: Instance,
    /// The first new columns, bits: of what, from where, and their units.
    written: Vec<(u32, f64, f64)>,
    /// Products in whose place the columns behind them stand, in order.
    products: Vec<Monomial>,
}

impl Replaced {
    /// Starts where a point of the program itself is.
    pub(in crate::solve) fn start_at(&mut self, x: &[f64]) {
        let level = &mut self.instance.columns.level;
        level[..x.len()].copy_from_slice(x);
        let bits = self.written.iter();
        let bits = bits.map(|&(j, l, unit)| bit_of(x[j as usize], l, unit));
        for (k, bit) in (x.len()..).zip(bits) {
            level[k] = bit;
        }
        let first = x.len() + self.written.len();
        for (w, product) in self.products.iter().enumerate() {
            level[first + w] = product.iter().map(|&j| level[j as usize]).product();
        }
    }

    /// Whether integer columns were written in bits.
    pub(in crate::solve) fn has_bits(&self) -> bool {
        !self.written.is_empty()
    }
}

/// The program without products that have a binary factor; None where there is none.
pub(in crate::solve) fn without_binary_products(instance: &Instance) -> Option<Replaced> {
    let mut products = Products::new(instance)?;
    let mut terms = Vec::new();
    for (row, coefficient, term) in expressions(instance) {
        let parts = products.builder.place_linear(row, term.parts(coefficient));
        for (weight, part) in parts {
            let multiplied = products.known.multiplied_out(&part);
            terms.push((row, weight, part, multiplied));
        }
    }
    let all = || terms.iter().flat_map(|t| &t.3).flat_map(Polynomial::keys);
    products.write_in_bits(all());
    let mut changed = false;
    for (row, weight, part, multiplied) in terms {
        let known = &products.known;
        let multiplied = multiplied.and_then(|p| known.in_bits(p));
        let replaced = |p: &Polynomial| {
            let linear = p.keys().all(|m| m.len() < 2);
            linear || p.keys().any(|m| known.is_replaced(m))
        };
        match multiplied.filter(replaced) {
            Some(p) => {
                changed = true;
                p.into_iter()
                    .for_each(|(m, a)| products.place(row, m, weight * a));
            }
            None => products.builder.push_term(row, weight, part),
        }
        if products.made.len() > MAX_NEW_COLUMNS {
            return None;
        }
    }
    products.multiply_equations(instance);
    (changed && products.made.len() <= MAX_NEW_COLUMNS).then(|| products.finish(instance))
}

/// What is known of the columns.
struct Known {
    lower: Vec<f64>,
    upper: Vec<f64>,
    integer: Vec<bool>,
    binary: Vec<bool>,
    /// Bits of integer columns that are written in them, lowest first.
    bits: BTreeMap<u32, Vec<u32>>,
}

impl Known {
    /// Bounds with what linear rows imply for them. None: they contradict each other.
    fn new(instance: &Instance) -> Option<Self> {
        let mip = Mip::of_nonlinear(instance, false).ok()?;
        let (mut lower, mut upper) = (mip.problem.lower.clone(), mip.problem.upper.clone());
        let mut propagator = Propagator::new(&mip);
        propagator.continuous = true;
        if !propagator.run(&mip, None, &mut lower, &mut upper) {
            return None;
        }
        let is_binary = |j: usize| mip.integer[j] && lower[j] >= 0.0 && upper[j] <= 1.0;
        Some(Self {
            binary: (0..lower.len()).map(is_binary).collect(),
            bits: BTreeMap::new(),
            integer: mip.integer,
            lower,
            upper,
        })
    }

    /// Whether a product gets a column.
    fn is_replaced(&self, product: &[u32]) -> bool {
        let mut others = product.iter().filter(|&&j| !self.binary[j as usize]);
        let bounded = |&j: &u32| {
            let (l, u) = (self.lower[j as usize], self.upper[j as usize]);
            l.abs().max(u.abs()) <= MAX_FACTOR_BOUND
        };
        match (others.next(), others.next()) {
            (None, _) => product.len() > 1,
            (Some(j), None) => product.len() > 1 && bounded(j),
            _ => false,
        }
    }

    /// Columns of a product that are not binary, but for one: it would have a column in place of each with a binary in place of
    /// one of these. None: one of them cannot be written in binaries.
    fn to_write(&self, product: &[u32]) -> Option<Vec<u32>> {
        let others = product.iter().filter(|&&j| !self.binary[j as usize]);
        let mut others: Vec<u32> = others.copied().collect();
        let range = |j: u32| self.upper[j as usize] - self.lower[j as usize];
        let rank = |j: u32| {
            (
                self.integer[j as usize],
                self.bits.contains_key(&j),
                range(j),
            )
        };
        others.sort_by(|&i, &j| {
            let (i, j) = (rank(i), rank(j));
            (i.0, i.1).cmp(&(j.0, j.1)).then(j.2.total_cmp(&i.2))
        });
        let rest = others.split_off(others.len().min(1));
        let short = |&j: &u32| self.integer[j as usize] && range(j) <= MAX_RANGE;
        rest.iter().all(short).then_some(rest)
    }

    /// A polynomial with bits in place of the columns that are written in them, as far as each product needs it.
    fn in_bits(&self, p: Polynomial) -> Option<Polynomial> {
        let mut out = Polynomial::new();
        for (product, a) in p {
            let mut rest = product.clone();
            let mut factors = Vec::new();
            for j in self.to_write(&product).unwrap_or_default() {
                let Some(bits) = self.bits.get(&j) else {
                    continue;
                };
                rest.remove(rest.iter().position(|&k| k == j)?);
                let mut number = constant(self.lower[j as usize]);
                for (k, &bit) in bits.iter().enumerate() {
                    number = sum(number, &self.column(bit, 1.0), (1u64 << k) as f64);
                }
                factors.push(number);
            }
            factors.push(Polynomial::from([(rest, a)]));
            out = sum(out, &self.product(factors.iter())?, 1.0);
        }
        Some(out)
    }

    /// A term as a polynomial, if it is one of moderate length.
    fn multiplied_out(&self, term: &Term) -> Option<Polynomial> {
        let number = |p: &Polynomial| match p.len() {
            0 => Some(0.0),
            1 => p.get(&Vec::new()).copied(),
            _ => None,
        };
        let whole = |p: &Polynomial| {
            let k = number(p).filter(|k| *k == k.trunc() && (0.0..=8.0).contains(k))?;
            Some(k as usize)
        };
        let mut stack: Vec<Polynomial> = Vec::new();
        for &op in &term.ops {
            let arguments = stack.split_off(stack.len() - op.arguments());
            stack.push(match (op, &arguments[..]) {
                (Op::Var(k), _) => self.column(term.columns[k as usize], 1.0),
                (Op::Const(k), _) => constant(term.constants[k as usize]),
                (Op::Affine(c, v, n), _) => {
                    let (c, v, n) = (c as usize, v as usize, n as usize);
                    let slopes = term.constants[c + 1..c + 1 + n].iter();
                    let terms = term.columns[v..v + n].iter().zip(slopes);
                    let first = constant(term.constants[c]);
                    terms.fold(first, |p, (&j, &a)| sum(p, &self.column(j, a), 1.0))
                }
                (Op::Add(_), all) => all.iter().fold(Polynomial::new(), |p, q| sum(p, q, 1.0)),
                (Op::Negate, [a]) => sum(Polynomial::new(), a, -1.0),
                (Op::Multiply(_), all) => self.product(all.iter())?,
                (Op::Divide, [a, b]) => {
                    let b = number(b).filter(|b| *b != 0.0)?;
                    sum(Polynomial::new(), a, 1.0 / b)
                }
                (Op::PowerInt(k @ 0..=8), [a]) => self.product((0..k).map(|_| a))?,
                (Op::Call(Function::Sqr, _), [a]) => self.product([a, a].into_iter())?,
                (Op::Power | Op::Call(Function::Power, _), [a, b]) => {
                    self.product((0..whole(b)?).map(|_| a))?
                }
                _ => return None,
            });
        }
        stack.pop()
    }

    /// A column with a coefficient; a number where the column is fixed.
    fn column(&self, j: u32, a: f64) -> Polynomial {
        let (l, u) = (self.lower[j as usize], self.upper[j as usize]);
        match l == u {
            true => constant(a * l),
            false => Polynomial::from([(vec![j], a)]),
        }
    }

    fn product<'p>(&self, factors: impl Iterator<Item = &'p Polynomial>) -> Option<Polynomial> {
        let mut out = constant(1.0);
        for factor in factors {
            if out.len() * factor.len() > MAX_TERM_PRODUCTS {
                return None;
            }
            let mut next = Polynomial::new();
            for (m, a) in &out {
                for (n, b) in factor {
                    let mut both = [&m[..], &n[..]].concat();
                    both.sort_unstable();
                    both.dedup_by(|i, j| i == j && self.binary[*i as usize]);
                    *next.entry(both).or_default() += a * b;
                }
            }
            out = next;
        }
        out.retain(|_, a| *a != 0.0);
        Some(out)
    }
}

fn constant(value: f64) -> Polynomial {
    let one = (value != 0.0).then_some((Monomial::new(), value));
    one.into_iter().collect()
}

/// p + a q
fn sum(mut p: Polynomial, q: &Polynomial, a: f64) -> Polynomial {
    for (m, b) in q {
        *p.entry(m.clone()).or_default() += a * b;
    }
    p.retain(|_, a| *a != 0.0);
    p
}

/// A column in place of a product, its factors (one of them may be the column of another), and whether it has to be kept from
/// being too small, or too large.
struct Made {
    column: u32,
    factors: Vec<u32>,
    kept: [bool; 2],
}

/// The program in the making.
struct Products {
    known: Known,
    builder: Builder,
    /// By row: 1 where its left side is to be small, −1 where it is to be large, 0 where it is given.
    direction: Vec<f64>,
    /// The first new columns, bits: of what, from where, and their units.
    written: Vec<(u32, f64, f64)>,
    made: Vec<Made>,
    number: BTreeMap<Monomial, usize>,
}

/// The bit of this unit in the binary number x − l.
fn bit_of(x: f64, l: f64, unit: f64) -> f64 {
    ((x - l).round().max(0.0) / unit).floor() % 2.0
}

impl Products {
    fn new(instance: &Instance) -> Option<Self> {
        Some(Self {
            known: Known::new(instance)?,
            builder: Builder::new(instance),
            direction: directions(instance),
            written: Vec::new(),
            made: Vec::new(),
            number: BTreeMap::new(),
        })
    }

    /// Integer columns of which products need it get bits, x = l + Σ 2ᵏ bₖ.
    fn write_in_bits<'p>(&mut self, products: impl Iterator<Item = &'p Monomial>) {
        for product in products {
            for j in self.known.to_write(product).unwrap_or_default() {
                if self.known.bits.contains_key(&j) {
                    continue;
                }
                let (l, u) = (self.known.lower[j as usize], self.known.upper[j as usize]);
                let row = self.builder.push_row(Relation::Equal);
                self.builder.rows.rhs[row] = l;
                self.builder.entries.push((row, j, 1.0));
                let mut bits = Vec::new();
                while ((1u64 << bits.len()) as f64) <= u - l {
                    let bit = self.builder.columns.push(0.0, 1.0);
                    self.builder.columns.kind[bit] = ColumnKind::Integer;
                    let unit = (1u64 << bits.len()) as f64;
                    self.builder.entries.push((row, bit as u32, -unit));
                    bits.push(bit as u32);
                    self.known.lower.push(0.0);
                    self.known.upper.push(1.0);
                    self.known.integer.push(true);
                    self.known.binary.push(true);
                    self.written.push((j, l, unit));
                    self.builder.columns.level[bit] =
                        bit_of(self.builder.columns.level[j as usize], l, unit);
                }
                self.known.bits.insert(j, bits);
            }
        }
    }

    /// Puts a product into the left side of a row.
    fn place(&mut self, row: usize, product: Monomial, a: f64) {
        match product[..] {
            [] => self.builder.rows.rhs[row] -= a,
            [j] => self.builder.entries.push((row, j, a)),
            _ if self.known.is_replaced(&product) => {
                let gain = a * self.direction[row];
                let w = self.column(product, [gain >= 0.0, gain <= 0.0]);
                self.builder.entries.push((row, w, a));
            }
            _ => {
                let count = product.len() as u32;
                let mut term = Term::default();
                for j in product {
                    term.append(Term::column(j as usize));
                }
                term.ops.push(Op::Multiply(count));
                self.builder.push_term(row, a, term);
            }
        }
    }

    /// The column of a product.
    fn column(&mut self, product: Monomial, kept: [bool; 2]) -> u32 {
        if let Some(&k) = self.number.get(&product) {
            let made = &mut self.made[k];
            made.kept = [made.kept[0] || kept[0], made.kept[1] || kept[1]];
            return made.column;
        }
        let known = &self.known;
        let (binaries, others): (Monomial, Monomial) =
            product.iter().partition(|&&j| known.binary[j as usize]);
        let (l, u) = match others[..] {
            [y] => (known.lower[y as usize], known.upper[y as usize]),
            _ => (0.0, 1.0),
        };
        let whole = others.iter().all(|&j| known.integer[j as usize]);
        // first what the binaries are together
        let factors = match others[..] {
            [y] if binaries.len() > 1 => vec![self.column(binaries, [true; 2]), y],
            [y] => vec![binaries[0], y],
            _ => binaries,
        };
        let columns = &mut self.builder.columns;
        let w = columns.push(l.min(0.0), u.max(0.0));
        columns.level[w] = product.iter().map(|&j| columns.level[j as usize]).product();
        if whole {
            columns.kind[w] = ColumnKind::Integer;
        }
        self.number.insert(product, self.made.len());
        self.made.push(Made {
            column: w as u32,
            factors,
            kept,
        });
        w as u32
    }

    /// w + Σ terms ≤ or ≥ rhs
    fn row(&mut self, relation: Relation, w: u32, terms: &[(u32, f64)], rhs: f64) {
        let row = self.builder.push_row(relation);
        self.builder.rows.rhs[row] = rhs;
        self.builder.entries.push((row, w, 1.0));
        let terms = terms.iter().filter(|t| t.1 != 0.0);
        self.builder
            .entries
            .extend(terms.map(|&(j, a)| (row, j, a)));
    }

    /// Equations of binaries times a binary with which at least half of theirs stand in products.
    fn multiply_equations(&mut self, original: &Instance) {
        let mut partners: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for product in self.number.keys() {
            if let [i, j] = product[..]
                && [i, j].iter().all(|&j| self.known.binary[j as usize])
            {
                partners.entry(i).or_default().push(j);
                partners.entry(j).or_default().push(i);
            }
        }
        let nonlinear = original.nonlinear_rows();
        for i in (0..original.row_count()).filter(|&i| !nonlinear[i]) {
            let entries: Vec<(u32, f64)> =
                original.matrix.row(i).map(|(j, a)| (j as u32, a)).collect();
            let binary = entries.iter().all(|e| self.known.binary[e.0 as usize]);
            if original.rows.relation[i] != Relation::Equal || !binary {
                continue;
            }
            let mut count: BTreeMap<u32, usize> = BTreeMap::new();
            for j in entries.iter().flat_map(|e| partners.get(&e.0)).flatten() {
                *count.entry(*j).or_default() += 1;
            }
            for (x, count) in count {
                let inside = entries.iter().any(|e| e.0 == x);
                if inside || 2 * count < entries.len() || self.made.len() > MAX_NEW_COLUMNS {
                    continue;
                }
                let row = self.builder.push_row(Relation::Equal);
                for &(j, a) in &entries {
                    let product = vec![j.min(x), j.max(x)];
                    let w = self.column(product, [false; 2]);
                    self.builder.entries.push((row, w, a));
                }
                let rhs = original.rows.rhs[i];
                self.builder.entries.push((row, x, -rhs));
            }
        }
    }

    fn finish(mut self, original: &Instance) -> Replaced {
        use Relation::{Greater, Less};
        let mut products = vec![Monomial::new(); self.made.len()];
        for (product, k) in std::mem::take(&mut self.number) {
            products[k] = product;
        }
        let n = original.column_count() as u32;
        for Made {
            column: w,
            factors: product,
            kept: [low, high],
        } in std::mem::take(&mut self.made)
        {
            let other = match product[..] {
                [b, y] if y < n && !self.known.binary[y as usize] => Some((b, y)),
                _ => None,
            };
            if let Some((b, y)) = other {
                let (l, u) = (self.known.lower[y as usize], self.known.upper[y as usize]);
                if low {
                    self.row(Greater, w, &[(b, -l)], 0.0);
                    self.row(Greater, w, &[(y, -1.0), (b, -u)], -u);
                }
                if high {
                    self.row(Less, w, &[(b, -u)], 0.0);
                    self.row(Less, w, &[(y, -1.0), (b, -l)], -l);
                }
                continue;
            }
            if low {
                let all: Vec<(u32, f64)> = product.iter().map(|&b| (b, -1.0)).collect();
                self.row(Greater, w, &all, 1.0 - product.len() as f64);
            }
            if high {
                for &b in &product {
                    self.row(Less, w, &[(b, -1.0)], 0.0);
                }
            }
        }
        Replaced {
            instance: self.builder.finish_discrete(original),
            written: self.written,
            products,
        }
    }
}
