//! The one way to walk the checked program: what stands directly in a statement, a domain, an expression,
//! a key. A walk is a [`Visitor`]; it overrides what it asks about and calls `walk` to go on below.
//!
//! Every `match` here names all kinds, so that a new one cannot be forgotten.

use super::node::*;

/// How a table is read.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Reading {
    /// The value or the text of a record, or whether there is one.
    Record,
    /// Records in their order: places of labels, lags, the element of a singleton set.
    Order,
    /// The number of records.
    Count,
}

/// What is done at each piece of the program; by default, what is below is visited.
pub trait Visitor<'a> {
    /// A statement.
    fn code(&mut self, c: &'a Code) {
        c.walk(self);
    }

    /// An expression.
    fn node(&mut self, n: &'a Node) {
        n.walk(self);
    }

    /// The condition of a `$`, a domain or a statement.
    fn guard(&mut self, n: &'a Node) {
        self.node(n);
    }

    /// What a sum, a loop, an assignment or an equation runs over.
    fn domain(&mut self, d: &'a Domain) {
        d.walk(self);
    }

    /// One label of a key.
    fn part(&mut self, p: &'a Part) {
        p.walk(self);
    }

    /// A table that is read.
    fn table(&mut self, _t: TableId, _how: Reading) {}
}

impl Key {
    /// Visits the parts.
    pub fn walk<'a, V: Visitor<'a> + ?Sized>(&'a self, v: &mut V) {
        self.parts.iter().for_each(|p| v.part(p));
    }
}

impl Part {
    /// Visits what a part is made of.
    pub fn walk<'a, V: Visitor<'a> + ?Sized>(&'a self, v: &mut V) {
        match self {
            Self::Slot(_) | Self::Label(_) => {}
            Self::Lag(lag) => {
                v.table(lag.set, Reading::Order);
                v.part(&lag.base);
                v.node(&lag.offset);
            }
            Self::Singleton(t, _) => v.table(*t, Reading::Order),
        }
    }
}

impl Domain {
    /// Visits members, then conditions.
    pub fn walk<'a, V: Visitor<'a> + ?Sized>(&'a self, v: &mut V) {
        for m in &self.members {
            v.table(m.table, Reading::Order);
            m.key.walk(v);
        }
        self.sets.iter().for_each(|&t| v.table(t, Reading::Order));
        self.conditions.iter().for_each(|c| v.guard(c));
    }
}

impl Node {
    /// Visits children, in the order of the text.
    pub fn walk<'a, V: Visitor<'a> + ?Sized>(&'a self, v: &mut V) {
        match &self.kind {
            NodeKind::Const(_)
            | NodeKind::ObjectAttribute(..)
            | NodeKind::Text(_)
            | NodeKind::SymbolText(_) => {}
            NodeKind::Data(t, key) | NodeKind::ElementText(t, key) => {
                v.table(*t, Reading::Record);
                key.walk(v);
            }
            NodeKind::Var(_, key) | NodeKind::Derived(_, _, key) | NodeKind::RecordName(_, key) => {
                key.walk(v);
            }
            NodeKind::Ord(t, p) | NodeKind::LabelAttribute(_, t, p) => {
                v.table(*t, Reading::Order);
                v.part(p);
            }
            NodeKind::Card(t) => v.table(*t, Reading::Count),
            NodeKind::SameAs(a, b) => {
                v.part(a);
                v.part(b);
            }
            NodeKind::LabelText(p) => v.part(p),
            NodeKind::Not(a) => v.node(a),
            NodeKind::Sum(list) | NodeKind::Product(list) => {
                list.iter().for_each(|(_, x)| v.node(x));
            }
            NodeKind::Binary(_, a, b) => {
                v.node(a);
                v.node(b);
            }
            NodeKind::Call(_, list) | NodeKind::DataCall(_, list) => {
                list.iter().for_each(|x| v.node(x));
            }
            NodeKind::Dollar(a, c) => {
                v.node(a);
                v.guard(c);
            }
            NodeKind::Aggregate(_, d, body) => {
                v.domain(d);
                v.node(body);
            }
            NodeKind::OfText(text, at) => {
                v.node(text);
                at.iter().for_each(|n| v.node(n));
            }
        }
    }
}

impl Node {
    /// Calls a function for this expression and all below (not those inside keys) that may change them.
    pub fn change(&mut self, f: &mut dyn FnMut(&mut Node)) {
        f(self);
        match &mut self.kind {
            NodeKind::Const(_)
            | NodeKind::ObjectAttribute(..)
            | NodeKind::Text(_)
            | NodeKind::SymbolText(_)
            | NodeKind::Data(..)
            | NodeKind::ElementText(..)
            | NodeKind::Var(..)
            | NodeKind::Derived(..)
            | NodeKind::RecordName(..)
            | NodeKind::Ord(..)
            | NodeKind::LabelAttribute(..)
            | NodeKind::Card(_)
            | NodeKind::SameAs(..)
            | NodeKind::LabelText(_) => {}
            NodeKind::Not(a) => a.change(f),
            NodeKind::Sum(list) | NodeKind::Product(list) => {
                list.iter_mut().for_each(|(_, x)| x.change(f));
            }
            NodeKind::Binary(_, a, b) | NodeKind::Dollar(a, b) => {
                a.change(f);
                b.change(f);
            }
            NodeKind::Call(_, list) | NodeKind::DataCall(_, list) => {
                list.iter_mut().for_each(|x| x.change(f));
            }
            NodeKind::Aggregate(_, d, body) => {
                d.conditions.iter_mut().for_each(|c| c.change(f));
                body.change(f);
            }
            NodeKind::OfText(text, at) => {
                text.change(f);
                at.iter_mut().for_each(|n| n.change(f));
            }
        }
    }
}

impl Code {
    /// Visits expressions and statements inside.
    pub fn walk<'a, V: Visitor<'a> + ?Sized>(&'a self, v: &mut V) {
        match &self.kind {
            CodeKind::Assign(a) => {
                v.domain(&a.domain);
                a.key.walk(v);
                v.node(&a.value);
            }
            CodeKind::Loop(d, anew, body) => {
                v.domain(d);
                anew.iter().for_each(|c| v.guard(c));
                body.iter().for_each(|c| v.code(c));
            }
            CodeKind::While(condition, body) | CodeKind::Repeat(body, condition) => {
                v.guard(condition);
                body.iter().for_each(|c| v.code(c));
            }
            CodeKind::For(f) => {
                v.node(&f.from);
                v.node(&f.to);
                f.by.iter().for_each(|n| v.node(n));
                f.body.iter().for_each(|c| v.code(c));
            }
            CodeKind::If(arms, otherwise) => {
                for (condition, body) in arms {
                    v.guard(condition);
                    body.iter().for_each(|c| v.code(c));
                }
                otherwise.iter().for_each(|c| v.code(c));
            }
            CodeKind::Put(_, items) => items.iter().for_each(|i| i.walk(v)),
            CodeKind::Break(_)
            | CodeKind::Continue
            | CodeKind::Display(_)
            | CodeKind::Abort(..)
            | CodeKind::Solve(_)
            | CodeKind::Option(..)
            | CodeKind::Clear(..)
            | CodeKind::Format(..)
            | CodeKind::Project { .. }
            | CodeKind::Match(..)
            | CodeKind::Permute(..)
            | CodeKind::Shuffle(..)
            | CodeKind::Exchange(_)
            | CodeKind::Draw(..) => {}
        }
    }
}

impl PutCode {
    fn walk<'a, V: Visitor<'a> + ?Sized>(&'a self, v: &mut V) {
        match self {
            Self::NewLine | Self::File(_) => {}
            Self::Column(n) | Self::Row(n) => v.node(n),
            Self::Item(w) => {
                v.node(&w.value);
                w.width.iter().chain(&w.decimals).for_each(|n| v.node(n));
            }
        }
    }
}

/// Calls a function for an expression and all below.
struct Each<F>(F);

impl<'a, F: FnMut(&'a Node)> Visitor<'a> for Each<F> {
    fn node(&mut self, n: &'a Node) {
        (self.0)(n);
        n.walk(self);
    }
}

/// Calls a function for each statement and those in its blocks, with how many blocks are around it.
pub fn each_statement<'a>(code: &'a [Code], f: &mut dyn FnMut(&'a Code, usize)) {
    struct Statements<'f, 'a>(&'f mut dyn FnMut(&'a Code, usize), usize);
    impl<'a> Visitor<'a> for Statements<'_, 'a> {
        fn code(&mut self, c: &'a Code) {
            (self.0)(c, self.1);
            self.1 += 1;
            c.walk(self);
            self.1 -= 1;
        }
        fn node(&mut self, _: &'a Node) {}
        fn domain(&mut self, _: &'a Domain) {}
    }
    let mut v = Statements(f, 0);
    code.iter().for_each(|c| v.code(c));
}

impl Node {
    /// Calls `f` for the node and all below: operands, conditions, offsets of lags.
    pub fn each<'a>(&'a self, f: impl FnMut(&'a Node)) {
        Each(f).node(self);
    }

    /// Whether `f` holds for the node or one below.
    pub fn any(&self, f: impl Fn(&Node) -> bool) -> bool {
        let mut hit = false;
        self.each(|n| hit |= f(n));
        hit
    }

    /// Whether a variable stands in it as an unknown.
    pub fn mentions(&self, variable: SymbolId) -> bool {
        self.any(|n| matches!(&n.kind, NodeKind::Var(s, _) if *s == variable))
    }

    /// Whether evaluating it draws random numbers: then order and number of evaluations matter.
    pub fn has_random(&self) -> bool {
        self.any(|n| matches!(&n.kind, NodeKind::DataCall(f, _) if f.is_random()))
    }

    /// Whether what stands directly in it is linear in the variables: if the node is not, it is where linearity
    /// ends.
    pub fn children_are_linear(&self) -> bool {
        struct Children(bool);
        impl<'a> Visitor<'a> for Children {
            fn node(&mut self, n: &'a Node) {
                self.0 &= n.linear;
            }
        }
        let mut children = Children(true);
        self.walk(&mut children);
        children.0
    }
}

impl DataFunction {
    /// Whether it takes from the stream of random numbers.
    fn is_random(self) -> bool {
        use DataFunction as D;
        matches!(
            self,
            D::Uniform
                | D::UniformInt
                | D::Normal
                | D::RandBinomial
                | D::RandLinear
                | D::RandTriangle
                | D::RandExponential
                | D::RandPoisson
                | D::SetSeed
                | D::ExecSeed
        )
    }
}
