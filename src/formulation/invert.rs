//! From the terms of rows to the terms of columns: which rows, and which tuples of their sums, hold `v(j…)`.

use super::gradient::Term;
use super::tree::*;
use crate::check::node::SymbolId;
use crate::check::symbols::{DomainPosition, Symbols, UNIVERSE};

/// What a term adds to the row of its column.
#[derive(Clone, Debug)]
pub struct Inverted {
    /// What must hold of the column's own indices.
    pub conditions: Vec<Expr>,
    /// What is added up, its sums inside.
    pub body: Expr,
}

/// The sets over which the rows of a variable's columns run, by all references to it: where these agree on a set that
/// set, else the variable's domain.
pub fn target_sets(
    symbols: &Symbols,
    indices: &Indices,
    domain: &[DomainPosition],
    references: &[&[Part]],
) -> Vec<SymbolId> {
    let declared = |p: &DomainPosition| match p {
        DomainPosition::Set(s) => *s,
        _ => UNIVERSE,
    };
    let one = |q: usize| {
        let set = |k: &&[Part]| match k.get(q) {
            Some(Part::Index(i)) => Some(indices.set[*i]),
            _ => None,
        };
        let first = set(references.first()?)?;
        let root = |s| symbols.root(s);
        let same = |k: &&[Part]| set(k).is_some_and(|s| root(s) == root(first));
        references.iter().all(same).then_some(first)
    };
    (0..domain.len())
        .map(|q| one(q).unwrap_or_else(|| declared(&domain[q])))
        .collect()
}

/// The state of an inversion.
struct Inversion<'a> {
    symbols: &'a Symbols,
    indices: &'a Indices,
    /// Indices that are still summed.
    open: Vec<IndexId>,
    conditions: Vec<Expr>,
    factors: Vec<(bool, Expr)>,
    key: Vec<Part>,
}

/// The term as seen from its column `v(target…)`. `row` is what the equation runs over, `multiplier` the multiplier of the
/// row that holds the term.
pub fn invert(
    symbols: &Symbols,
    indices: &Indices,
    term: &Term,
    row: &Binder,
    multiplier: Option<&Expr>,
    target: &[IndexId],
) -> Inverted {
    let mut s = Inversion {
        symbols,
        indices,
        open: [row.indices.as_slice(), &term.binder.indices].concat(),
        conditions: Vec::new(),
        factors: term.factors.clone(),
        key: term.key.clone(),
    };
    for c in row.conditions.iter().chain(&term.binder.conditions) {
        s.add(c.clone());
    }
    s.factors.extend(multiplier.map(|m| (false, m.clone())));
    s.plain(target);
    s.others(target);
    s.finish(target, term.negative)
}

impl Inversion<'_> {
    fn add(&mut self, c: Expr) {
        if !self.conditions.contains(&c) {
            self.conditions.push(c);
        }
    }

    /// Indices that stand alone at a position become the column's.
    fn plain(&mut self, target: &[IndexId]) {
        for (q, &j) in target.iter().enumerate() {
            if let Part::Index(k) = self.key[q]
                && self.open.contains(&k)
            {
                let to = Part::Index(j);
                if self.substitute(k, &to) {
                    let (from, over) = (self.indices.set[k], self.indices.set[j]);
                    if !self.symbols.is_subset(over, from) {
                        self.add(Expr::Member(self.symbols.root(from), vec![to]));
                    }
                }
            }
        }
    }

    /// Lags are turned round where that can be written; what is left must be equal.
    fn others(&mut self, target: &[IndexId]) {
        for (q, &j) in target.iter().enumerate() {
            let here = Part::Index(j);
            let part = self.key[q].clone();
            if part == here {
                continue;
            }
            if let Part::Lag(l) = &part
                && let Part::Index(k) = l.base
                && self.open.contains(&k)
                && !l.offset.mentions(k)
                && self.symbols.root(l.set) == self.symbols.root(self.indices.set[j])
                && self.turned(k, l, j)
            {
                continue;
            }
            self.add(Expr::SameAs(here, part));
        }
    }

    /// `k + n = j`: k is `j - n`.
    fn turned(&mut self, k: IndexId, l: &Lag, j: IndexId) -> bool {
        let back = Part::Lag(Box::new(Lag {
            base: Part::Index(j),
            set: l.set,
            offset: negate(l.offset.clone()),
            circular: l.circular,
        }));
        if !self.substitute(k, &back) {
            return false;
        }
        // Where the lag leaves the set there is no such row: a multiplier that has the lag as its index says that.
        let from = self.indices.set[k];
        let same_set = self.symbols.root(from) == self.symbols.root(l.set);
        let told = self.factors.iter().any(|(_, f)| match f {
            Expr::Variable(Variable::Multiplier(_), key) => key.contains(&back),
            _ => false,
        });
        if !(same_set && (l.circular || told)) {
            self.add(Expr::Member(self.symbols.root(from), vec![back]));
        }
        true
    }

    /// Puts `to` for the index k everywhere; false, and nothing is changed, if it cannot stand somewhere.
    fn substitute(&mut self, k: IndexId, to: &Part) -> bool {
        let sets = (self.symbols, self.indices);
        let one = |e: &Expr| substituted(sets, e, k, to);
        let conditions: Option<Vec<Expr>> = self.conditions.iter().map(one).collect();
        let factors: Option<Vec<(bool, Expr)>> = self
            .factors
            .iter()
            .map(|(d, e)| Some((*d, one(e)?)))
            .collect();
        let key: Option<Vec<Part>> = self
            .key
            .iter()
            .map(|p| substituted_part(sets, p, k, to))
            .collect();
        let (Some(conditions), Some(factors), Some(key)) = (conditions, factors, key) else {
            return false;
        };
        self.conditions = conditions;
        self.factors = factors;
        self.key = key;
        self.open.retain(|o| *o != k);
        true
    }

    fn finish(self, target: &[IndexId], negative: bool) -> Inverted {
        let mut outer = Vec::new();
        let mut inner = Vec::new();
        for c in self.conditions {
            if is_implied(self.symbols, self.indices, &c) {
                continue;
            }
            let list = match self.open.iter().any(|&k| c.mentions(k)) {
                true => &mut inner,
                false => &mut outer,
            };
            if !list.contains(&c) {
                list.push(c);
            }
        }
        debug_assert!(target.iter().all(|j| !self.open.contains(j)));
        // What does not depend on what is summed stands before the sum.
        let (opposite, factors) = match product(self.factors) {
            Expr::Negate(e) => (true, *e),
            e => (false, e),
        };
        let factors = match factors {
            Expr::Product(t) => t,
            e => vec![(false, e)],
        };
        let (inside, before): (Vec<_>, Vec<_>) = factors
            .into_iter()
            .partition(|(_, f)| self.open.iter().any(|&k| f.mentions(k)));
        let binder = Binder {
            indices: self.open,
            conditions: inner,
        };
        let mut factors = before;
        match binder.indices.is_empty() {
            true => factors.extend(inside),
            false => factors.push((false, sum_over(binder, product(inside)))),
        }
        let body = product(factors);
        Inverted {
            conditions: outer,
            body: if negative != opposite {
                negate(body)
            } else {
                body
            },
        }
    }
}

/// Whether a condition holds by what its index runs over.
fn is_implied(symbols: &Symbols, indices: &Indices, c: &Expr) -> bool {
    match c {
        Expr::Member(s, parts) => match parts.as_slice() {
            [Part::Index(k)] => symbols.is_subset(indices.set[*k], *s),
            _ => false,
        },
        Expr::SameAs(a, b) => a == b,
        // Positions are those from 1 to the number of elements.
        Expr::Binary(op, a, b) => match (op, &**a, &**b) {
            (BinaryOp::Gt | BinaryOp::Ne, Expr::Ord(..), Expr::Number(x)) => *x < 1.0,
            (BinaryOp::Ge, Expr::Ord(..), Expr::Number(x)) => *x <= 1.0,
            (BinaryOp::Lt | BinaryOp::Le, Expr::Ord(s, _), Expr::Sum(t)) => match t.as_slice() {
                [(false, Expr::Card(all)), (false, Expr::Number(x))] => {
                    symbols.root(*s) == symbols.root(*all) && *x >= 1.0
                }
                _ => false,
            },
            _ => false,
        },
        _ => false,
    }
}

type Sets<'a> = (&'a Symbols, &'a Indices);

fn substituted(sets: Sets, e: &Expr, k: IndexId, to: &Part) -> Option<Expr> {
    let (symbols, indices) = sets;
    if !e.mentions(k) {
        return Some(e.clone());
    }
    let lag = match to {
        Part::Lag(l) => Some(l),
        _ => None,
    };
    let mut part = |p: &Part| substituted_part(sets, p, k, to);
    let mut node = |e: Expr| match (e, lag) {
        // The position in the set of the lag is known; other properties of a label are not.
        (Expr::Ord(s, Part::Lag(l)), Some(back)) if *l == **back => {
            if back.circular || symbols.root(s) != symbols.root(back.set) {
                return None;
            }
            Some(Expr::Ord(s, back.base.clone()) + back.offset.clone())
        }
        (Expr::LabelAttribute(_, _, Part::Lag(_)), Some(_)) => None,
        // A position in one set is none in another.
        (Expr::Ord(s, Part::Index(j)), _) if symbols.root(s) != symbols.root(indices.set[j]) => {
            None
        }
        (Expr::LabelAttribute(a, s, Part::Index(j)), _)
            if symbols.root(s) != symbols.root(indices.set[j]) && of_a_set(a) =>
        {
            None
        }
        (Expr::Binary(op, a, b), Some(_)) if RELATIONS.contains(&op) => Some(balanced(op, *a, *b)),
        (e, _) => Some(e),
    };
    e.map(&mut node, &mut part)
}

const RELATIONS: [BinaryOp; 6] = [
    BinaryOp::Eq,
    BinaryOp::Ne,
    BinaryOp::Lt,
    BinaryOp::Le,
    BinaryOp::Gt,
    BinaryOp::Ge,
];

/// A relation without what stands on both sides, its numbers on the right: `ord(t) - 1 < card(t) - 1` is `ord(t) < card(t)`.
fn balanced(op: BinaryOp, a: Expr, b: Expr) -> Expr {
    let terms = |e: Expr| match e {
        Expr::Sum(t) => t,
        e => vec![(false, e)],
    };
    let (mut left, mut right, mut number) = (terms(a), Vec::new(), 0.0);
    left.retain(|(minus, t)| match t {
        Expr::Number(x) if x.is_finite() => {
            number += if *minus { *x } else { -x };
            false
        }
        _ => true,
    });
    for (minus, t) in terms(b) {
        match (&t, left.iter().position(|l| l.0 == minus && l.1 == t)) {
            (Expr::Number(x), _) if x.is_finite() => number += if minus { -x } else { *x },
            (_, Some(p)) => drop(left.remove(p)),
            _ => right.push((minus, t)),
        }
    }
    right.push((false, Expr::Number(number)));
    Expr::Binary(op, Box::new(sum(left)), Box::new(sum(right)))
}

/// Whether a property of a label depends on the set.
fn of_a_set(a: LabelAttribute) -> bool {
    use LabelAttribute as A;
    matches!(a, A::Pos | A::Ord | A::Off | A::Rev | A::First | A::Last)
}

fn substituted_part(sets: Sets, p: &Part, k: IndexId, to: &Part) -> Option<Part> {
    let (symbols, indices) = sets;
    match p {
        Part::Index(i) if *i == k => Some(to.clone()),
        Part::Lag(l) if p.mentions(k) => {
            let base = substituted_part(sets, &l.base, k, to)?;
            let offset = substituted(sets, &l.offset, k, to)?;
            match base {
                Part::Lag(inner) => {
                    let same = symbols.root(inner.set) == symbols.root(l.set);
                    if !same || inner.circular != l.circular {
                        return None;
                    }
                    let offset = inner.offset.clone() + offset;
                    Some(lagged(inner.base.clone(), l.set, offset, l.circular))
                }
                // The lag counts in the set that its index ran over: another index counts elsewhere.
                Part::Index(j) if symbols.root(indices.set[j]) != symbols.root(l.set) => None,
                base => Some(lagged(base, l.set, offset, l.circular)),
            }
        }
        p => Some(p.clone()),
    }
}

fn lagged(base: Part, set: SymbolId, offset: Expr, circular: bool) -> Part {
    match simplified(&offset) {
        Expr::Number(0.0) => base,
        offset => Part::Lag(Box::new(Lag {
            base,
            set,
            offset,
            circular,
        })),
    }
}

/// Numbers in a sum added up; opposite terms cancel.
fn simplified(e: &Expr) -> Expr {
    let Expr::Sum(terms) = e else {
        return e.clone();
    };
    let mut number = 0.0;
    let mut rest: Vec<(bool, Expr)> = Vec::new();
    for (minus, t) in terms {
        match t {
            Expr::Number(x) => number += if *minus { -x } else { *x },
            t => match rest.iter().position(|(m, r)| m != minus && r == t) {
                Some(p) => {
                    rest.remove(p);
                }
                None => rest.push((*minus, t.clone())),
            },
        }
    }
    rest.push((false, Expr::Number(number)));
    sum(rest)
}
