//! From the checked tree, with its slots and tables, to formulas with named indices.

use super::Row;
use super::tree::*;
use crate::check::node::{self, Domain, EquationDef, Key, Node, NodeKind, Slot, SymbolId, TableId};
use crate::check::symbols::{SymbolKind, Symbols, UNIVERSE};
use rustc_hash::FxHashMap;

/// One equation of a model as a formula.
#[derive(Clone, Debug)]
pub struct Equation {
    /// The equation.
    pub symbol: SymbolId,
    /// What it runs over.
    pub binder: Binder,
    /// Labels of its rows.
    pub key: Vec<Part>,
    /// Left side.
    pub left: Expr,
    /// Relation.
    pub relation: Relation,
    /// Right side.
    pub right: Expr,
}

impl Equation {
    /// Its rows in a formulation.
    pub fn row(&self, symbols: &Symbols, domain: Vec<SymbolId>, pair: Option<Variable>) -> Row {
        let symbol = symbols.get(self.symbol);
        Row {
            name: symbol.name.to_string(),
            text: symbol.text.to_string(),
            domain,
            key: self.key.clone(),
            binder: self.binder.clone(),
            left: self.left.clone(),
            relation: self.relation,
            right: self.right.clone(),
            pair,
        }
    }
}

/// Turns checked trees into formulas.
pub struct Lowering<'a> {
    symbols: &'a Symbols,
    /// The symbol that each table belongs to.
    owner: &'a dyn Fn(TableId) -> Option<SymbolId>,
    /// The indices so far.
    pub indices: Indices,
    slots: FxHashMap<Slot, IndexId>,
}

impl<'a> Lowering<'a> {
    /// `owner` says which symbol a table belongs to.
    pub fn new(symbols: &'a Symbols, owner: &'a dyn Fn(TableId) -> Option<SymbolId>) -> Self {
        Self {
            symbols,
            owner,
            indices: Indices::default(),
            slots: FxHashMap::default(),
        }
    }

    /// An equation.
    pub fn equation(&mut self, e: &EquationDef) -> Equation {
        self.slots.clear();
        let mut binder = self.domain(&e.domain);
        let key = self.key(&e.key);
        // Where a lead in its name leaves the set an equation has no row.
        for p in &key {
            if let Part::Lag(l) = p
                && !l.circular
            {
                let inside = Expr::Member(self.symbols.root(l.set), vec![p.clone()]);
                binder.conditions.push(inside);
            }
        }
        Equation {
            symbol: e.symbol,
            binder,
            key,
            left: self.expr(&e.left),
            relation: e.relation,
            right: self.expr(&e.right),
        }
    }

    /// A domain, its indices known from here on.
    pub fn domain(&mut self, d: &Domain) -> Binder {
        let mut out = Binder::default();
        for (&slot, &set) in d.slots.iter().zip(&d.names) {
            let index = self.indices.add(set);
            self.slots.insert(slot, index);
            out.indices.push(index);
        }
        for m in &d.members {
            let own = match m.key.parts.as_slice() {
                [node::Part::Slot(s)] => {
                    let at = d.slots.iter().position(|x| x == s);
                    at.is_some_and(|p| d.sets[p] == m.table)
                }
                _ => false,
            };
            if own || m.table == self.symbols.get(UNIVERSE).table {
                continue;
            }
            let parts = self.key(&m.key);
            let condition = match (self.owner)(m.table) {
                Some(s) => Expr::Member(s, parts),
                None => Expr::Opaque("a set without a name"),
            };
            if !out.conditions.contains(&condition) {
                out.conditions.push(condition);
            }
        }
        for c in &d.conditions {
            let c = self.expr(c);
            self.conjuncts(c, &mut out.conditions);
        }
        out
    }

    fn conjuncts(&self, c: Expr, out: &mut Vec<Expr>) {
        match c {
            Expr::Binary(BinaryOp::And, a, b) => {
                self.conjuncts(*a, out);
                self.conjuncts(*b, out);
            }
            c if out.contains(&c) => {}
            c => out.push(c),
        }
    }

    fn key(&mut self, key: &Key) -> Vec<Part> {
        key.parts.iter().map(|p| self.part(p)).collect()
    }

    /// Whether positions of an index are those in this set.
    fn counts_in(&self, p: &Part, set: SymbolId) -> bool {
        match p {
            Part::Index(k) => self.symbols.root(self.indices.set[*k]) == self.symbols.root(set),
            _ => true,
        }
    }

    fn set(&self, table: TableId) -> SymbolId {
        (self.owner)(table).unwrap_or(UNIVERSE)
    }

    fn part(&mut self, p: &node::Part) -> Part {
        match p {
            node::Part::Slot(s) => Part::Index(self.slots.get(s).copied().unwrap_or_default()),
            node::Part::Label(l) => Part::Label(*l),
            node::Part::Lag(l) => {
                let (base, set) = (self.part(&l.base), self.set(l.set));
                let offset = match self.counts_in(&base, set) {
                    true => self.expr(&l.offset),
                    false => Expr::Opaque("a lag in a set that its index does not run over"),
                };
                let circular = l.circular;
                Part::Lag(Box::new(Lag {
                    base,
                    set,
                    offset,
                    circular,
                }))
            }
            node::Part::Singleton(t, p) => Part::Singleton(self.set(*t), *p),
        }
    }

    /// An expression whose indices are known.
    pub fn expr(&mut self, n: &Node) -> Expr {
        match &n.kind {
            NodeKind::Const(x) => Expr::Number(*x),
            NodeKind::Data(t, key) => {
                let parts = self.key(key);
                self.record(*t, parts)
            }
            NodeKind::Var(s, key) => Expr::Variable(Variable::Own(*s), self.key(key)),
            NodeKind::Ord(t, p) => match (self.set(*t), self.part(p)) {
                (s, p) if self.counts_in(&p, s) => Expr::Ord(s, p),
                _ => Expr::Opaque("the position in a set that its index does not run over"),
            },
            NodeKind::Card(t) => match (self.owner)(*t) {
                Some(s) if self.symbols.get(s).is_set() => Expr::Card(s),
                _ => Expr::Opaque("the number of records of a symbol that is not a set"),
            },
            NodeKind::SameAs(a, b) => {
                let same = Expr::SameAs(self.part(a), self.part(b));
                match n.member {
                    true => same,
                    false => guarded(Expr::Number(1.0), vec![same]),
                }
            }
            NodeKind::LabelAttribute(a, t, p) => {
                Expr::LabelAttribute(*a, self.set(*t), self.part(p))
            }
            NodeKind::Not(a) => Expr::Not(Box::new(self.expr(a))),
            NodeKind::Sum(t) => sum(t.iter().map(|(m, e)| (*m, self.expr(e))).collect()),
            NodeKind::Product(t) => {
                let mut out = Vec::with_capacity(t.len());
                for (d, e) in t {
                    match e.kind.reciprocal_of() {
                        Some(b) => out.push((!*d, self.expr(b))),
                        None => out.push((*d, self.expr(e))),
                    }
                }
                Expr::Product(out)
            }
            NodeKind::Binary(op, a, b) => {
                Expr::Binary(*op, Box::new(self.expr(a)), Box::new(self.expr(b)))
            }
            NodeKind::Call(f, a) => Expr::Call(*f, a.iter().map(|e| self.expr(e)).collect()),
            NodeKind::DataCall(f, a) => match f {
                DataFunction::Pi | DataFunction::Fact | DataFunction::Mapval => {
                    Expr::DataCall(*f, a.iter().map(|e| self.expr(e)).collect())
                }
                DataFunction::Uniform
                | DataFunction::UniformInt
                | DataFunction::Normal
                | DataFunction::RandBinomial
                | DataFunction::RandLinear
                | DataFunction::RandTriangle
                | DataFunction::RandExponential
                | DataFunction::RandPoisson => Expr::Opaque("a random number"),
                _ => Expr::Opaque("a function of the clock or of the run"),
            },
            NodeKind::Dollar(a, c) => {
                let c = self.expr(c);
                Expr::Dollar(Box::new(self.expr(a)), Box::new(c))
            }
            NodeKind::Aggregate(op, d, e) => {
                let binder = self.domain(d);
                Expr::Aggregate(*op, Box::new(binder), Box::new(self.expr(e)))
            }
            NodeKind::Derived(..) => Expr::Opaque("an attribute that is computed"),
            NodeKind::ObjectAttribute(..) => Expr::Opaque("an attribute of a model or file"),
            _ => Expr::Opaque("a text"),
        }
    }

    /// A record of a table: of a set it is membership.
    fn record(&self, table: TableId, parts: Vec<Part>) -> Expr {
        let Some(s) = (self.owner)(table) else {
            return Expr::Opaque("data without a name");
        };
        let symbol = self.symbols.get(s);
        match symbol.kind {
            SymbolKind::Set { .. } | SymbolKind::Alias(_) => Expr::Member(s, parts),
            SymbolKind::Parameter { .. } => Expr::Data(Source::Parameter(s), parts),
            _ => Expr::Data(Source::Attribute(s, table - symbol.table), parts),
        }
    }
}
