//! Where an expression is anything but its *rest*: the number that it has nearly everywhere.
//!
//! A table rests at its default value, away from its records. A function of resting arguments rests where
//! all of them do; a product rests at 0 where any factor does, `and` and `$` likewise. What remains, the
//! *support*, is written as alternatives, each a conjunction of records that must be there; the planner
//! scans those instead of the whole domain.
//!
//! Invariant: where no alternative holds, evaluation gives exactly the rest and reports no error. One
//! exception is GAMS's: a division inside a factor is not carried out where another factor has no record
//! (`a(i)*(1/b(i))`); such a support is [`Sparse::forced`], that is, used even where it saves nothing.
//!
//! What is said of an expression can change with the data: [`Premise`]s tell when.

use super::plan::slots_of_key;
use super::{Machine, arithmetic};
use crate::autodiff::functions::function_value;
use crate::check::node::*;
use crate::check::symbols::DomainPosition;
use crate::data::value::is_eps;
use crate::model::instance::Function;

/// Alternatives, each a conjunction of records that must be there.
pub(super) type Alternatives = Vec<Vec<Driver>>;

/// Stands for a table in a [`Driver`]: both labels of the key are the same one (`sameas`).
pub(super) const SAME: TableId = TableId::MAX;

/// More alternatives than this are not followed.
const MAX_ALTERNATIVES: usize = 32;

/// What is known about the values of an expression.
pub(super) struct Sparse {
    /// Its value away from the support.
    pub rest: f64,
    /// Where it may have another.
    pub support: Alternatives,
    /// Evaluation elsewhere could fail although the value is the rest.
    pub forced: bool,
}

/// What a plan takes for granted.
#[derive(Debug, PartialEq)]
pub(super) enum Premise {
    /// About so many records: the choice of the plan rests on it, not its result.
    Size(TableId, usize),
    /// No value is infinite, `na`, `eps` or `undf`.
    Plain(TableId),
    /// No value is `na`, `undf` or an acronym.
    Defined(TableId),
    /// There is a record.
    Filled(TableId),
    /// There is a record for every key of the domain.
    Full(TableId),
    /// A scalar has this value (its bits).
    Scalar(TableId, u64),
    /// So many are counted by `card`.
    Count(TableId, usize),
}

/// How a factor behaves where another one is 0.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Care {
    /// An ordinary number, always.
    Total,
    /// An ordinary number, or a division by zero.
    MayFail,
}

/// Finds supports, and notes what they rest on.
pub(super) struct Analysis<'m, 'h> {
    m: &'m Machine<'h>,
    pub premises: Vec<Premise>,
    /// Indices that are run over.
    indices: Vec<Slot>,
    /// Random numbers are drawn: as in GAMS, records that lags find, an index that comes twice, `not`, and comparisons
    /// of two things that vary do not tell where; the same labels do.
    pub draws: bool,
}

impl Machine<'_> {
    /// Whether a premise still holds.
    pub(super) fn holds_still(&self, p: &Premise) -> bool {
        match *p {
            Premise::Size(t, n) => {
                let now = self.store.table(t).len();
                now <= 4 * n + 64 && n <= 4 * now + 64
            }
            Premise::Plain(t) => !self.store.table(t).has_special(),
            Premise::Defined(t) => !self.store.table(t).has_undefined(),
            Premise::Filled(t) => !self.store.table(t).is_empty(),
            Premise::Full(t) => self.is_full(t),
            Premise::Scalar(t, bits) => self.store.table(t).get(&[]).to_bits() == bits,
            Premise::Count(t, n) => self.count(t) == n,
        }
    }

    /// Whether a table has a record for every key that its declaration allows.
    fn is_full(&self, table: TableId) -> bool {
        let Some(symbol) = self.table_symbol(table).map(|s| self.symbols.get(s)) else {
            return false;
        };
        let size = symbol.domain.iter().try_fold(1usize, |n, p| match p {
            DomainPosition::Set(d) => {
                let set = self.store.table(self.symbols.get(*d).table);
                (set.dim() == 1).then(|| n.saturating_mul(set.len()))
            }
            _ => None,
        });
        size == Some(self.store.table(table).len())
    }
}

impl<'m, 'h> Analysis<'m, 'h> {
    /// Over the tuples of these indices.
    pub(super) fn new(m: &'m Machine<'h>, indices: &[Slot], draws: bool) -> Self {
        Self {
            draws,
            m,
            premises: Vec::new(),
            indices: indices.to_vec(),
        }
    }

    /// What is taken for granted so far and from now on.
    fn premise(&mut self, p: Premise) {
        if !self.premises.contains(&p) {
            self.premises.push(p);
        }
    }

    /// The support of an expression that rests at 0.
    pub(super) fn nonzero(&mut self, n: &Node, symbolic: bool) -> Option<Sparse> {
        let found = self.resting_at(0.0, n, symbolic);
        // A number that is 0 keeps nothing from being drawn beside it.
        found.filter(|s| !self.draws || !s.support.is_empty())
    }

    /// The support of an expression that rests at a value.
    pub(super) fn resting_at(&mut self, rest: f64, n: &Node, symbolic: bool) -> Option<Sparse> {
        let before = self.premises.len();
        let found = self.sparse(n, symbolic).filter(|s| s.rest == rest);
        if found.is_none() {
            // Nothing is concluded from what was looked at.
            self.premises.truncate(before);
        }
        found
    }

    /// Supports of conditions that must all hold.
    pub(super) fn conjuncts(&mut self, conditions: &[Node]) -> Vec<Sparse> {
        if self.are_joint(conditions) {
            return Vec::new();
        }
        let safe = conditions.len() < 2 || conditions.iter().all(|c| self.is_safe(c));
        let support = |c: &Node| {
            let mut s = self.nonzero(c, false)?;
            s.forced |= self.draws && c.has_random();
            Some(s)
        };
        let mut supports: Vec<Sparse> = conditions.iter().filter_map(support).collect();
        // A number that is 0 stops nothing: errors in the others are reported.
        supports.retain(|s| safe || !s.support.is_empty());
        supports
    }

    /// Whether a condition is evaluated without an error: then it need not be where another one is false.
    pub(super) fn is_safe(&mut self, n: &Node) -> bool {
        self.is_quiet(n)
            || self.is_defined(n)
                && !n.any(|n| match &n.kind {
                    NodeKind::Product(_)
                    | NodeKind::Binary(BinaryOp::Power, ..)
                    | NodeKind::Call(..)
                    | NodeKind::DataCall(..)
                    | NodeKind::Aggregate(AggregateOp::Prod, ..) => true,
                    NodeKind::LabelAttribute(which, ..) => {
                        matches!(which, LabelAttribute::Val | LabelAttribute::TextVal)
                    }
                    _ => false,
                })
    }

    /// Whether conditions must be evaluated together: `na and 0` is `na`, which counts as true.
    fn are_joint(&mut self, conditions: &[Node]) -> bool {
        conditions.len() > 1 && self.any_undefined(conditions)
    }

    /// Whether some condition may be `na`, or `undf` without an error.
    pub(super) fn any_undefined(&mut self, conditions: &[Node]) -> bool {
        !conditions.iter().all(|c| self.is_defined(c))
    }

    /// Whether a value is never `na`, nor `undf` unless an error is reported.
    fn is_defined(&mut self, n: &Node) -> bool {
        let mut tables = Vec::new();
        let mut defined = true;
        n.each(|n| match &n.kind {
            NodeKind::Data(t, _) => tables.push(*t),
            NodeKind::Const(x) => defined &= !x.is_nan() || is_eps(*x),
            NodeKind::ObjectAttribute(..) => defined = false,
            _ => {}
        });
        defined &= tables
            .iter()
            .all(|&t| !self.m.store.table(t).has_undefined());
        if defined {
            tables
                .into_iter()
                .for_each(|t| self.premise(Premise::Defined(t)));
        }
        defined
    }

    /// Rest and support; with `symbolic`, in an equation: a zero factor removes the term.
    fn sparse(&mut self, n: &Node, symbolic: bool) -> Option<Sparse> {
        match &n.kind {
            NodeKind::Const(x) => Some(at_rest(*x)),
            NodeKind::Data(t, key) => self.data(*t, key),
            NodeKind::SameAs(a, b) if self.draws => {
                let parts = vec![a.clone(), b.clone()];
                self.record(0.0, SAME, &Key { parts })
            }
            NodeKind::Card(t) => {
                let count = self.m.count(*t);
                self.premise(Premise::Count(*t, count));
                Some(at_rest(count as f64))
            }
            NodeKind::Not(_) if self.draws => None,
            NodeKind::Not(a) => self.together(&[(false, a)], |v| arithmetic::not(v[0])),
            NodeKind::Sum(terms) => {
                let parts: Vec<(bool, &Node)> = terms.iter().map(|(_, t)| (symbolic, t)).collect();
                self.together(&parts, |v| {
                    let signed =
                        v.iter().zip(terms).map(
                            |(&x, (minus, _))| {
                                if *minus { arithmetic::negate(x) } else { x }
                            },
                        );
                    signed.reduce(arithmetic::add).unwrap_or(0.0)
                })
            }
            NodeKind::Product(factors) => self.product(factors, symbolic),
            NodeKind::Dollar(a, c) => {
                let condition = self.nonzero(c, false);
                let value = self.nonzero(a, symbolic);
                match (condition, value) {
                    (Some(c), Some(v)) => Some(meet(c, v)),
                    (Some(c), None) => Some(c),
                    (None, Some(v)) if c.has_random() => Some(v),
                    (None, Some(v)) => Some(Sparse {
                        forced: v.forced || self.care(c) != Some(Care::Total),
                        ..v
                    }),
                    (None, None) => None,
                }
            }
            NodeKind::Binary(BinaryOp::And, a, b) => self.both(n, a, b),
            NodeKind::Binary(BinaryOp::Power, a, b) => {
                self.call(Function::RPower, &[(symbolic, a), (symbolic, b)])
            }
            NodeKind::Binary(op, a, b) => {
                let or = matches!(op, BinaryOp::Or);
                if self.draws && !or && !self.is_fixed(a) && !self.is_fixed(b) {
                    return None;
                }
                self.together(&[(false, a), (false, b)], |v| {
                    arithmetic::relate(*op, v[0], v[1])
                })
            }
            NodeKind::Call(f, args) => {
                let total = matches!(f, Function::Min | Function::Max) && self.draws;
                let mut at_0 = |a| self.sparse(a, symbolic).is_some_and(|s| s.rest == 0.0);
                if total && !args.iter().all(&mut at_0) {
                    return None;
                }
                let args: Vec<(bool, &Node)> = args.iter().map(|a| (symbolic, a)).collect();
                self.call(*f, &args)
            }
            NodeKind::Aggregate(op, d, body) => self.aggregate(*op, d, body, symbolic),
            _ => None,
        }
    }

    fn data(&mut self, t: TableId, key: &Key) -> Option<Sparse> {
        let table = self.m.store.table(t);
        if key.parts.is_empty() {
            let value = table.get(&[]);
            self.premise(Premise::Scalar(t, value.to_bits()));
            return Some(at_rest(value));
        }
        self.record(table.default_value(), t, key)
    }

    /// Something that is other than its rest only where there is a record.
    fn record(&self, rest: f64, table: TableId, key: &Key) -> Option<Sparse> {
        let key = key.clone();
        let tells = !self.draws || key.is_plain() && !key.repeats();
        tells.then(|| Sparse {
            rest,
            support: vec![vec![Driver { table, key }]],
            forced: false,
        })
    }

    /// Something of several expressions that rests where all of them do.
    fn together(
        &mut self,
        parts: &[(bool, &Node)],
        value: impl Fn(&[f64]) -> f64,
    ) -> Option<Sparse> {
        let mut out = at_rest(0.0);
        let mut rests = Vec::with_capacity(parts.len());
        for &(symbolic, n) in parts {
            let s = self.sparse(n, symbolic)?;
            rests.push(s.rest);
            out.support.extend(s.support);
            out.forced |= s.forced;
            if out.support.len() > MAX_ALTERNATIVES {
                return None;
            }
        }
        out.rest = value(&rests);
        Some(out)
    }

    fn call(&mut self, f: Function, args: &[(bool, &Node)]) -> Option<Sparse> {
        let value = |v: &[f64]| {
            let finite = v.iter().all(|x| x.is_finite());
            let value = finite.then(|| function_value(f, v).ok()).flatten();
            value.filter(|x| x.is_finite()).unwrap_or(f64::NAN)
        };
        self.together(args, value).filter(|s| !s.rest.is_nan())
    }

    fn product(&mut self, factors: &[(bool, Node)], symbolic: bool) -> Option<Sparse> {
        // A term of an equation whose coefficient is 0 is not looked at; else a divisor must not be 0.
        let mut divisors = factors
            .iter()
            .filter_map(|(divide, f)| match f.kind.reciprocal_of() {
                Some(b) => Some(b),
                None => divide.then_some(f),
            });
        if !symbolic && !divisors.all(|b| self.is_divisor(b)) {
            return None;
        }
        let mut out: Option<Sparse> = None;
        for (i, (_, f)) in factors
            .iter()
            .enumerate()
            .filter(|(_, (divide, _))| !divide)
        {
            let Some(mut s) = self.nonzero(f, symbolic) else {
                continue;
            };
            if !symbolic {
                let others = factors
                    .iter()
                    .enumerate()
                    .filter(|(k, (d, _))| *k != i && !d);
                let care = others.map(|(_, (_, g))| self.care(g)).min_by_key(careless);
                match care.unwrap_or(Some(Care::Total)) {
                    Some(Care::Total) => {}
                    Some(Care::MayFail) if self.drives(&s) => s.forced = true,
                    _ => continue,
                }
            }
            out = Some(match out {
                Some(o) => meet(o, s),
                None => s,
            });
        }
        out
    }

    /// Whether an expression has the same ordinary value everywhere.
    fn is_fixed(&mut self, n: &Node) -> bool {
        self.sparse(n, false).is_some_and(|s| s.support.is_empty()) && self.care(n).is_some()
    }

    /// Whether tuples can be found by its records: a scalar or `q('a')` that is 0 leaves out none, and what
    /// stands beside it is evaluated.
    fn drives(&self, s: &Sparse) -> bool {
        let finds = |d: &Driver| {
            slots_of_key(&d.key)
                .iter()
                .any(|s| self.indices.contains(s))
        };
        !s.support.is_empty() && s.support.iter().all(|a| a.iter().any(finds))
    }

    /// `a and b`
    fn both(&mut self, n: &Node, a: &Node, b: &Node) -> Option<Sparse> {
        let mut out: Option<Sparse> = None;
        for (x, y) in [(a, b), (b, a)] {
            if let Some(mut s) = self.nonzero(x, false)
                && let Some(care) = self.care(y)
            {
                s.forced |= care == Care::MayFail;
                out = Some(match out {
                    Some(o) => meet(o, s),
                    None => s,
                });
            }
        }
        if out.is_some() || self.draws {
            return out;
        }
        let NodeKind::Binary(op, ..) = &n.kind else {
            return None;
        };
        self.together(&[(false, a), (false, b)], |v| {
            arithmetic::relate(*op, v[0], v[1])
        })
    }

    fn aggregate(
        &mut self,
        op: AggregateOp,
        d: &Domain,
        body: &Node,
        symbolic: bool,
    ) -> Option<Sparse> {
        if !matches!(op, AggregateOp::Sum | AggregateOp::Sor) {
            // Over nothing these are not 0.
            let whole = d.conditions.is_empty()
                && !body.has_random()
                && d.members.iter().all(|m| {
                    matches!(m.key.parts.as_slice(), [Part::Slot(s)] if d.slots.contains(s))
                        && !self.m.store.table(m.table).is_empty()
                });
            if !whole || symbolic && body.has_var {
                return None;
            }
            for m in &d.members {
                self.premise(Premise::Filled(m.table));
            }
        }
        if self.draws && !matches!(op, AggregateOp::Sum | AggregateOp::Sor) {
            return None;
        }
        let mut out = Sparse {
            rest: 0.0,
            support: vec![d.members.clone()],
            forced: false,
        };
        for s in self.conjuncts(&d.conditions) {
            out = meet(out, s);
        }
        let outside = self.indices.len();
        self.indices.extend(&d.slots);
        let inside = self.nonzero(body, symbolic);
        self.indices.truncate(outside);
        if let Some(s) = inside {
            out = meet(out, s);
        } else if !matches!(op, AggregateOp::Sum | AggregateOp::Sor) {
            return None;
        }
        Some(out)
    }

    /// How an expression behaves where nobody wants its value; None: it may be infinite, `na` or `undf`.
    fn care(&mut self, n: &Node) -> Option<Care> {
        match &n.kind {
            NodeKind::Const(x) => x.is_finite().then_some(Care::Total),
            NodeKind::Data(t, _) => {
                let table = self.m.store.table(*t);
                if table.has_special() || !table.default_value().is_finite() {
                    return None;
                }
                self.premise(Premise::Plain(*t));
                Some(Care::Total)
            }
            NodeKind::Ord(..) | NodeKind::Card(_) | NodeKind::SameAs(..) => Some(Care::Total),
            NodeKind::Not(a) => self.care(a),
            NodeKind::Sum(t) => self.cares(t.iter().map(|(_, x)| x)),
            NodeKind::Product(t) => {
                let mut worst = Care::Total;
                for (divide, x) in t {
                    if *divide && !self.is_divisor(x) {
                        worst = Care::MayFail;
                    }
                    worst = worst.max(self.care(x)?);
                }
                Some(worst)
            }
            NodeKind::Binary(BinaryOp::Power, a, b) => {
                Some(self.cares([&**a, &**b])?.max(Care::MayFail))
            }
            NodeKind::Binary(_, a, b) => self.cares([&**a, &**b]),
            // What is drawn under a condition does not count, a drawn condition does.
            NodeKind::Dollar(_, c) if self.draws => self.care(c),
            NodeKind::Dollar(a, b) => self.cares([&**a, &**b]),
            NodeKind::Aggregate(op, d, b)
                if !matches!(op, AggregateOp::Smin | AggregateOp::Smax) =>
            {
                let known = |c: &&Node| !self.draws || !c.has_random();
                let conditions: Vec<&Node> = d.conditions.iter().filter(known).collect();
                self.cares(conditions.into_iter().chain([&**b]))
            }
            NodeKind::Call(
                Function::Abs
                | Function::Sqr
                | Function::Sign
                | Function::Min
                | Function::Max
                | Function::Floor
                | Function::Ceil
                | Function::Round
                | Function::Trunc
                | Function::Frac
                | Function::Exp
                | Function::ArcTan
                | Function::Tanh
                | Function::ErrorF
                | Function::Sigmoid
                | Function::IfThen,
                a,
            ) => self.cares(a),
            NodeKind::Call(Function::Mod, a) if self.is_divisor(&a[1]) => self.care(&a[0]),
            NodeKind::LabelAttribute(which, ..) => Some(match which {
                LabelAttribute::Val | LabelAttribute::TextVal => Care::MayFail,
                _ => Care::Total,
            }),
            // GAMS passes over these where another factor is 0, but not over `log`, `sqrt`, `power` and others.
            NodeKind::Call(
                Function::Mod
                | Function::Log2
                | Function::Sin
                | Function::Cos
                | Function::Tan
                | Function::ArcSin
                | Function::ArcCos
                | Function::Gamma
                | Function::LogGamma
                | Function::Entropy
                | Function::Logit
                | Function::BetaReg,
                a,
            ) => Some(self.cares(a)?.max(Care::MayFail)),
            _ => None,
        }
    }

    fn cares<'n>(&mut self, list: impl IntoIterator<Item = &'n Node>) -> Option<Care> {
        list.into_iter()
            .try_fold(Care::Total, |worst, n| Some(worst.max(self.care(n)?)))
    }

    /// Whether evaluation never reports an error and never gives `undf`.
    pub(super) fn is_quiet(&mut self, n: &Node) -> bool {
        self.care(n) == Some(Care::Total)
    }

    /// Whether dividing by it is always fine.
    fn is_divisor(&mut self, n: &Node) -> bool {
        match &n.kind {
            NodeKind::Const(x) => x.is_finite() && *x != 0.0,
            NodeKind::Data(t, key) if key.parts.is_empty() => {
                let v = self.m.store.table(*t).get(&[]);
                self.premise(Premise::Scalar(*t, v.to_bits()));
                v.is_finite() && v != 0.0
            }
            NodeKind::Data(t, key) if key.is_plain() => {
                let table = self.m.store.table(*t);
                let full =
                    table.default_value() == 0.0 && !table.has_special() && self.m.is_full(*t);
                if full {
                    self.premise(Premise::Full(*t));
                    self.premise(Premise::Plain(*t));
                }
                full
            }
            NodeKind::Card(t) => {
                self.premise(Premise::Filled(*t));
                !self.m.store.table(*t).is_empty()
            }
            _ => false,
        }
    }
}

fn careless(c: &Option<Care>) -> u8 {
    match c {
        None => 0,
        Some(Care::MayFail) => 1,
        Some(Care::Total) => 2,
    }
}

/// The same value everywhere.
fn at_rest(rest: f64) -> Sparse {
    Sparse {
        rest,
        support: Vec::new(),
        forced: false,
    }
}

/// Both must be away from rest.
fn meet(a: Sparse, b: Sparse) -> Sparse {
    Sparse {
        rest: 0.0,
        support: product(&a.support, &b.support).unwrap_or(if a.support.len() <= b.support.len() {
            a.support
        } else {
            b.support
        }),
        forced: a.forced || b.forced,
    }
}

/// Pairs of alternatives; None when they are too many.
pub(super) fn product<T: Clone>(a: &[Vec<T>], b: &[Vec<T>]) -> Option<Vec<Vec<T>>> {
    let pairs = a
        .iter()
        .flat_map(|x| b.iter().map(|y| [&x[..], &y[..]].concat()));
    (a.len() * b.len() <= MAX_ALTERNATIVES).then(|| pairs.collect())
}
