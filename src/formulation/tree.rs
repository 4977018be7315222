//! Formulas as data: expressions with named indices instead of slots, sums as binders.

use crate::check::node::SymbolId;
pub use crate::check::node::{
    AggregateOp, BinaryOp, DataFunction, LabelAttribute, Relation, Sense,
};
use crate::data::universe::Label;
pub use crate::model::instance::Function;
use std::ops;

/// An index that runs: its number in [`Indices`].
pub type IndexId = usize;

/// The indices of a formulation.
#[derive(Clone, Debug, Default)]
pub struct Indices {
    /// The set, or the alias of one, that each index runs over, as it was written.
    pub set: Vec<SymbolId>,
}

impl Indices {
    /// A new index over a set.
    pub fn add(&mut self, set: SymbolId) -> IndexId {
        self.set.push(set);
        self.set.len() - 1
    }
}

/// A variable of a formulation.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Variable {
    /// One of the user's text.
    Own(SymbolId),
    /// One that the derivation introduces: its number among the multipliers.
    Multiplier(usize),
}

/// What has values.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Source {
    /// A parameter.
    Parameter(SymbolId),
    /// An attribute of a variable or equation (`x.up`): the offset behind the symbol's first table.
    Attribute(SymbolId, u32),
    /// Data that the derivation introduces: their number.
    New(usize),
}

/// How one label of a key is made.
#[derive(Clone, PartialEq, Debug)]
pub enum Part {
    /// An index.
    Index(IndexId),
    /// A label.
    Label(Label),
    /// `t+1`, `t--k`.
    Lag(Box<Lag>),
    /// The one element of a singleton set, at a position of it.
    Singleton(SymbolId, u8),
}

/// A lag or lead; lags have a negative offset.
#[derive(Clone, PartialEq, Debug)]
pub struct Lag {
    /// Where to start.
    pub base: Part,
    /// The ordered set.
    pub set: SymbolId,
    /// How far.
    pub offset: Expr,
    /// `++`, `--`.
    pub circular: bool,
}

/// What a sum, a product or a row runs over.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Binder {
    /// The indices.
    pub indices: Vec<IndexId>,
    /// What must hold: membership of tuple sets, and `$` conditions.
    pub conditions: Vec<Expr>,
}

/// An expression.
#[derive(Clone, PartialEq, Debug)]
pub enum Expr {
    /// A number.
    Number(f64),
    /// A record of data.
    Data(Source, Vec<Part>),
    /// Membership of a set.
    Member(SymbolId, Vec<Part>),
    /// Membership of a set that the derivation introduces.
    NewMember(usize, Vec<Part>),
    /// A variable.
    Variable(Variable, Vec<Part>),
    /// `ord(i)`
    Ord(SymbolId, Part),
    /// `card(s)`
    Card(SymbolId),
    /// `sameas(i,j)`: a condition.
    SameAs(Part, Part),
    /// `i.val`, `i.pos` …
    LabelAttribute(LabelAttribute, SymbolId, Part),
    /// `-a`
    Negate(Box<Expr>),
    /// `not a`
    Not(Box<Expr>),
    /// Terms; true for those that are subtracted.
    Sum(Vec<(bool, Expr)>),
    /// Factors; true for those that divide.
    Product(Vec<(bool, Expr)>),
    /// Relations, logic, `**`.
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// A mathematical function.
    Call(Function, Vec<Expr>),
    /// A function of data.
    DataCall(DataFunction, Vec<Expr>),
    /// `a $ c`
    Dollar(Box<Expr>, Box<Expr>),
    /// `sum(d, e)` and its kin.
    Aggregate(AggregateOp, Box<Binder>, Box<Expr>),
    /// A part of the text that has no symbol here (a random number, a property of a model): why.
    Opaque(&'static str),
}

impl Expr {
    /// Calls `f` for each direct child, conditions included.
    pub fn each(&self, f: &mut dyn FnMut(&Expr)) {
        match self {
            Expr::Negate(a) | Expr::Not(a) => f(a),
            Expr::Sum(t) | Expr::Product(t) => t.iter().for_each(|(_, e)| f(e)),
            Expr::Binary(_, a, b) | Expr::Dollar(a, b) => {
                f(a);
                f(b);
            }
            Expr::Call(_, a) | Expr::DataCall(_, a) => a.iter().for_each(f),
            Expr::Aggregate(_, d, e) => {
                d.conditions.iter().for_each(&mut *f);
                f(e);
            }
            _ => {}
        }
    }

    /// Calls `f` for each part of a key directly in this node.
    pub fn parts(&self, f: &mut dyn FnMut(&Part)) {
        match self {
            Expr::Data(_, k)
            | Expr::Member(_, k)
            | Expr::NewMember(_, k)
            | Expr::Variable(_, k) => {
                k.iter().for_each(f);
            }
            Expr::Ord(_, p) | Expr::LabelAttribute(_, _, p) => f(p),
            Expr::SameAs(a, b) => {
                f(a);
                f(b);
            }
            _ => {}
        }
    }

    /// Calls `f` for this node and all below, the offsets of lags included.
    pub fn walk(&self, f: &mut dyn FnMut(&Expr)) {
        f(self);
        self.parts(&mut |p| p.walk_offsets(f));
        self.each(&mut |e| e.walk(f));
    }

    /// Whether something below satisfies a test.
    pub fn any(&self, test: &dyn Fn(&Expr) -> bool) -> bool {
        let mut hit = false;
        self.walk(&mut |e| hit = hit || test(e));
        hit
    }

    /// Whether a variable stands in it.
    pub fn has_variable(&self) -> bool {
        self.any(&|e| matches!(e, Expr::Variable(..)))
    }

    /// Why it cannot be written in symbols, if it cannot.
    pub fn opaque(&self) -> Option<&'static str> {
        let mut found = None;
        self.walk(&mut |e| {
            if let Expr::Opaque(why) = e {
                found = Some(*why);
            }
        });
        found
    }

    /// Whether an index stands in it (free or bound).
    pub fn mentions(&self, index: IndexId) -> bool {
        let mut hit = false;
        self.walk(&mut |e| e.parts(&mut |p| hit |= p.mentions(index)));
        hit
    }
}

impl Part {
    fn walk_offsets(&self, f: &mut dyn FnMut(&Expr)) {
        if let Part::Lag(l) = self {
            l.base.walk_offsets(f);
            l.offset.walk(f);
        }
    }

    /// Whether an index stands in it.
    pub fn mentions(&self, index: IndexId) -> bool {
        match self {
            Part::Index(k) => *k == index,
            Part::Lag(l) => l.base.mentions(index) || l.offset.mentions(index),
            _ => false,
        }
    }
}

/// `-a`
pub fn negate(a: Expr) -> Expr {
    match a {
        Expr::Number(x) => Expr::Number(if x == 0.0 { 0.0 } else { -x }),
        Expr::Negate(a) => *a,
        Expr::Sum(mut t) => {
            t.iter_mut().for_each(|(minus, _)| *minus = !*minus);
            Expr::Sum(t)
        }
        a => Expr::Negate(Box::new(a)),
    }
}

/// `a + b − …`; zeros are left out, sums in sums are opened.
pub fn sum(terms: Vec<(bool, Expr)>) -> Expr {
    let mut out: Vec<(bool, Expr)> = Vec::new();
    for (minus, t) in terms {
        match t {
            Expr::Number(0.0) => {}
            Expr::Number(x) if x < 0.0 => out.push((!minus, Expr::Number(-x))),
            Expr::Sum(inner) => out.extend(inner.into_iter().map(|(m, e)| (m != minus, e))),
            Expr::Negate(e) => out.push((!minus, *e)),
            t => out.push((minus, t)),
        }
    }
    match out.len() {
        0 => Expr::Number(0.0),
        1 if !out[0].0 => out.remove(0).1,
        1 => negate(out.remove(0).1),
        _ => Expr::Sum(out),
    }
}

/// `a · b / …`; ones are left out, products in products are opened, signs go in front, numbers are gathered.
pub fn product(factors: Vec<(bool, Expr)>) -> Expr {
    let mut out: Vec<(bool, Expr)> = Vec::new();
    let (mut minus, mut number, mut zero) = (false, 1.0, false);
    let mut todo: Vec<(bool, Expr)> = factors.into_iter().rev().collect();
    while let Some((divide, f)) = todo.pop() {
        match f {
            Expr::Number(0.0) if !divide => zero = true,
            Expr::Number(x) if x.is_finite() && !divide => number *= x,
            Expr::Number(x) if x.is_finite() && (x == 1.0 || x == -1.0) => number *= x,
            Expr::Negate(e) => {
                minus = !minus;
                todo.push((divide, *e));
            }
            Expr::Product(inner) => {
                todo.extend(inner.into_iter().rev().map(|(d, e)| (d != divide, e)));
            }
            // What divides and multiplies cancels, of a square once.
            f => {
                let opposite = |e: &Expr| out.iter().position(|o| o.0 != divide && o.1 == *e);
                let square = Expr::Call(Function::Sqr, vec![f.clone()]);
                let root = match &f {
                    Expr::Call(Function::Sqr, args) => {
                        opposite(&args[0]).map(|p| (p, args[0].clone()))
                    }
                    _ => None,
                };
                if let Some(p) = opposite(&f) {
                    out.remove(p);
                } else if let Some(p) = opposite(&square) {
                    out[p].1 = f;
                } else if let Some((p, root)) = root {
                    out[p] = (divide, root);
                } else {
                    out.push((divide, f));
                }
            }
        }
    }
    if zero {
        return Expr::Number(0.0);
    }
    if number < 0.0 {
        (minus, number) = (!minus, -number);
    }
    if number != 1.0 || out.iter().all(|(d, _)| *d) {
        out.insert(0, (false, Expr::Number(number)));
    }
    let all = match out.len() {
        1 => out.remove(0).1,
        _ => Expr::Product(out),
    };
    if minus { negate(all) } else { all }
}

impl ops::Neg for Expr {
    type Output = Self;
    fn neg(self) -> Self {
        negate(self)
    }
}

impl ops::Add for Expr {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        sum(vec![(false, self), (false, b)])
    }
}

impl ops::Sub for Expr {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        sum(vec![(false, self), (true, b)])
    }
}

impl ops::Mul for Expr {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        product(vec![(false, self), (false, b)])
    }
}

impl ops::Div for Expr {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        product(vec![(false, self), (true, b)])
    }
}

/// a to the power b.
pub fn power(a: Expr, b: Expr) -> Expr {
    Expr::Binary(BinaryOp::Power, Box::new(a), Box::new(b))
}

/// `a $ (c and …)`
pub fn guarded(a: Expr, conditions: Vec<Expr>) -> Expr {
    match (a, conjunction(conditions)) {
        (Expr::Number(0.0), _) => Expr::Number(0.0),
        (a, None) => a,
        (Expr::Negate(a), Some(c)) => negate(Expr::Dollar(a, Box::new(c))),
        (a, Some(c)) => Expr::Dollar(Box::new(a), Box::new(c)),
    }
}

/// All of them.
pub fn conjunction(conditions: Vec<Expr>) -> Option<Expr> {
    conditions
        .into_iter()
        .reduce(|a, b| Expr::Binary(BinaryOp::And, Box::new(a), Box::new(b)))
}

/// `sum(binder, a)`; only the condition where there is no index.
pub fn sum_over(binder: Binder, a: Expr) -> Expr {
    match a {
        Expr::Number(0.0) => Expr::Number(0.0),
        a if binder.indices.is_empty() => guarded(a, binder.conditions),
        Expr::Negate(a) => negate(sum_over(binder, *a)),
        Expr::Aggregate(AggregateOp::Sum, inner, a) => {
            let mut binder = binder;
            binder.indices.extend(inner.indices);
            binder.conditions.extend(inner.conditions);
            Expr::Aggregate(AggregateOp::Sum, Box::new(binder), a)
        }
        a => Expr::Aggregate(AggregateOp::Sum, Box::new(binder), Box::new(a)),
    }
}

impl Expr {
    /// The expression with another node for each; children first. `part` changes the parts of keys. None where one of
    /// them says that it cannot be.
    pub fn map(
        &self,
        node: &mut dyn FnMut(Expr) -> Option<Expr>,
        part: &mut dyn FnMut(&Part) -> Option<Part>,
    ) -> Option<Expr> {
        let mut keyed = |k: &[Part]| k.iter().map(&mut *part).collect::<Option<Vec<_>>>();
        let e = match self {
            Expr::Data(s, k) => Expr::Data(*s, keyed(k)?),
            Expr::Member(s, k) => Expr::Member(*s, keyed(k)?),
            Expr::NewMember(s, k) => Expr::NewMember(*s, keyed(k)?),
            Expr::Variable(v, k) => Expr::Variable(*v, keyed(k)?),
            Expr::Ord(s, p) => Expr::Ord(*s, part(p)?),
            Expr::LabelAttribute(a, s, p) => Expr::LabelAttribute(*a, *s, part(p)?),
            Expr::SameAs(a, b) => Expr::SameAs(part(a)?, part(b)?),
            Expr::Negate(a) => negate(a.map(node, part)?),
            Expr::Not(a) => Expr::Not(Box::new(a.map(node, part)?)),
            Expr::Sum(t) => {
                let t = t.iter().map(|(m, e)| Some((*m, e.map(node, part)?)));
                sum(t.collect::<Option<_>>()?)
            }
            Expr::Product(t) => {
                let t = t.iter().map(|(d, e)| Some((*d, e.map(node, part)?)));
                product(t.collect::<Option<_>>()?)
            }
            Expr::Binary(op, a, b) => {
                let (a, b) = (a.map(node, part)?, b.map(node, part)?);
                Expr::Binary(*op, Box::new(a), Box::new(b))
            }
            Expr::Call(f, a) => {
                let a = a.iter().map(|e| e.map(node, part));
                Expr::Call(*f, a.collect::<Option<_>>()?)
            }
            Expr::DataCall(f, a) => {
                let a = a.iter().map(|e| e.map(node, part));
                Expr::DataCall(*f, a.collect::<Option<_>>()?)
            }
            Expr::Dollar(a, c) => guarded(a.map(node, part)?, vec![c.map(node, part)?]),
            Expr::Aggregate(op, d, e) => {
                let c = d.conditions.iter().map(|c| c.map(node, part));
                let binder = Binder {
                    indices: d.indices.clone(),
                    conditions: c.collect::<Option<_>>()?,
                };
                let body = e.map(node, part)?;
                match op {
                    AggregateOp::Sum => sum_over(binder, body),
                    _ => Expr::Aggregate(*op, Box::new(binder), Box::new(body)),
                }
            }
            Expr::Number(_) | Expr::Card(_) | Expr::Opaque(_) => self.clone(),
        };
        node(e)
    }

    /// The expression with another node for each; children first.
    pub fn map_nodes(&self, node: &dyn Fn(Expr) -> Expr) -> Expr {
        self.map(&mut |e| Some(node(e)), &mut |p| Some(p.clone()))
            .unwrap_or_else(|| self.clone())
    }

    /// The expression at the point where all variables are 0 (of a linear one, its constant).
    pub fn without_variables(&self) -> Expr {
        self.map_nodes(&|e| match e {
            Expr::Variable(..) => Expr::Number(0.0),
            e => e,
        })
    }

    /// Adds the user's variables that stand in it to a list that has them once.
    pub fn own_variables(&self, out: &mut Vec<SymbolId>) {
        self.walk(&mut |e| {
            if let Expr::Variable(Variable::Own(v), _) = e
                && !out.contains(v)
            {
                out.push(*v);
            }
        });
    }
}

/// The expression with new indices for those that its sums bind.
pub fn renamed(e: &Expr, indices: &mut Indices) -> Expr {
    let mut bound = Vec::new();
    e.walk(&mut |e| {
        if let Expr::Aggregate(_, d, _) = e {
            bound.extend(d.indices.iter().copied());
        }
    });
    let map = bound.into_iter().map(|k| (k, indices.add(indices.set[k])));
    let map: Vec<(IndexId, IndexId)> = map.collect();
    rename(e, &map)
}

/// The expression with other indices.
pub fn rename(e: &Expr, map: &[(IndexId, IndexId)]) -> Expr {
    if map.is_empty() {
        return e.clone();
    }
    fn new(k: IndexId, map: &[(IndexId, IndexId)]) -> IndexId {
        map.iter().find(|m| m.0 == k).map_or(k, |m| m.1)
    }
    fn part(p: &Part, map: &[(IndexId, IndexId)]) -> Part {
        match p {
            Part::Index(k) => Part::Index(new(*k, map)),
            Part::Lag(l) => Part::Lag(Box::new(Lag {
                base: part(&l.base, map),
                set: l.set,
                offset: rename(&l.offset, map),
                circular: l.circular,
            })),
            p => p.clone(),
        }
    }
    let node = |e| match e {
        Expr::Aggregate(op, mut d, b) => {
            d.indices.iter_mut().for_each(|k| *k = new(*k, map));
            Some(Expr::Aggregate(op, d, b))
        }
        e => Some(e),
    };
    e.map(&mut { node }, &mut |p| Some(part(p, map)))
        .unwrap_or_else(|| e.clone())
}
