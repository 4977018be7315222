//! The iteration planner: every "for each tuple such that …" runs over nonzeros.
//!
//! Sums, assignments, loops and equation domains are all a set of free slots, tables in which the
//! tuple must be (index sets, tuple sets), and conjuncts of a condition. The planner adds tables
//! whose zero makes the condition false or the term vanish, picks for each step the cheapest table
//! given what is bound, and tests the rest as soon as it can be tested.
//!
//! Invariant: a plan never changes *which* tuples count, only how they are found; the order of the
//! indices in the text does not matter for speed. Where a person sees the order, tuples come in
//! label order ([`Plan::ordered`], or sorted after).

use super::Machine;
use super::exec::has_random;
use crate::check::node::*;
use crate::check::symbols::DomainPosition;
use crate::data::sort::sort_tuples;
use crate::data::universe::Label;
use crate::model::instance::Function;
use std::rc::Rc;

/// How to enumerate a domain.
#[derive(Debug)]
pub struct Plan {
    /// Steps, outermost first.
    pub steps: Vec<Step>,
    /// Whether tuples come in label order of the domain's slots.
    pub ordered: bool,
    /// Sizes of the tables when the plan was made.
    sizes: Vec<(TableId, usize)>,
}

/// A step of a plan.
#[derive(Debug)]
pub enum Step {
    /// For each record of a table that agrees with what is bound.
    Scan {
        /// The table.
        table: TableId,
        /// Its key.
        key: Box<[Part]>,
        /// Positions that are bound.
        mask: u32,
        /// Position and slot of what it binds.
        bind: Box<[(u8, Slot)]>,
        /// Positions that must equal a slot bound by the same record.
        equal: Box<[(u8, Slot)]>,
    },
    /// A record must be there.
    Member(TableId, Key),
    /// A conjunct of the condition (by number) must be true.
    Filter(usize),
}

/// A table whose record must be nonzero for the tuple to count.
struct Candidate {
    table: TableId,
    key: Key,
    /// Must be tested if it is not scanned.
    required: bool,
    done: bool,
}

/// Alternatives, each a conjunction of drivers; None: anything may be nonzero.
pub type Support = Option<Vec<Vec<Driver>>>;

/// Which table is scanned next.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Pick {
    /// The one with the smallest fan-out.
    Cheapest,
    /// One that keeps the tuples in the order of the slots: where random numbers are drawn.
    InOrder,
}

/// More alternatives than this are not followed.
const MAX_ALTERNATIVES: usize = 8;

impl Machine<'_> {
    /// The plan of a domain; `body` is what is summed, if a zero of it does not matter.
    pub(super) fn plan(&self, d: &Domain, body: Option<&Node>) -> Rc<Plan> {
        self.plan_for(d, body, body.is_some_and(has_random))
    }

    /// The plan of a domain; `drawing`: what is done for each tuple draws random numbers.
    pub(super) fn plan_for(&self, d: &Domain, body: Option<&Node>, drawing: bool) -> Rc<Plan> {
        if let Some(p) = &*d.plan.borrow() {
            let stale = p.sizes.iter().any(|&(t, n)| {
                let now = self.store.table(t).len();
                now > 4 * n + 64 || n > 4 * now + 64
            });
            if !stale {
                return p.clone();
            }
        }
        let pick = if drawing || d.conditions.iter().any(has_random) {
            Pick::InOrder
        } else {
            Pick::Cheapest
        };
        let p = Rc::new(self.make_plan(d, body, &[], pick));
        *d.plan.borrow_mut() = Some(p.clone());
        p
    }

    /// Plans a domain with additional drivers (and perhaps additional slots that those bind).
    pub(super) fn make_plan(
        &self,
        d: &Domain,
        body: Option<&Node>,
        extra: &[Driver],
        pick: Pick,
    ) -> Plan {
        let mut free: Vec<Slot> = d.slots.clone();
        let mut candidates: Vec<Candidate> = d
            .members
            .iter()
            .map(|m| Candidate {
                table: m.table,
                key: m.key.clone(),
                required: true,
                done: false,
            })
            .collect();
        let soft = |candidates: &mut Vec<Candidate>, drivers: &[Driver], inner_too: bool| {
            for m in drivers {
                // A driver that mentions an index of a sum inside cannot be scanned out here.
                let inner = |p: &Part| matches!(p, Part::Slot(s) if self.is_inner(*s, d));
                if inner_too || !m.key.parts.iter().any(inner) {
                    candidates.push(Candidate {
                        table: m.table,
                        key: m.key.clone(),
                        required: false,
                        done: false,
                    });
                }
            }
        };
        for c in &d.conditions {
            if let Some(alternatives) = self.support(c, false)
                && let [one] = alternatives.as_slice()
            {
                soft(&mut candidates, one, false);
            }
        }
        if let Some(b) = body
            && let Some(alternatives) = self.support(b, b.has_var)
            && let [one] = alternatives.as_slice()
        {
            soft(&mut candidates, one, false);
        }
        soft(&mut candidates, extra, true);
        // Slots that only the extra drivers know are enumerated too.
        for m in extra {
            for p in &m.key.parts {
                if let Part::Slot(s) = p
                    && !free.contains(s)
                    && self.is_inner(*s, d)
                {
                    free.push(*s);
                }
            }
        }
        candidates.retain(|c| c.key.is_plain() || c.required);
        let mut steps = Vec::new();
        let mut order: Vec<Slot> = Vec::new();
        // What a slot's label is known to be a member of, by the tables that bound it.
        let mut known: Vec<(Slot, TableId)> = Vec::new();
        let mut filters: Vec<(usize, Vec<Slot>)> = d
            .conditions
            .iter()
            .enumerate()
            .map(|(i, c)| {
                let mut used = Vec::new();
                slots_of(c, &mut used);
                used.retain(|s| free.contains(s));
                if has_random(c) {
                    // Drawn once per tuple.
                    used = free.clone();
                }
                (i, used)
            })
            .collect();
        let settle = |free: &[Slot],
                      candidates: &mut Vec<Candidate>,
                      filters: &mut Vec<(usize, Vec<Slot>)>,
                      known: &[(Slot, TableId)],
                      steps: &mut Vec<Step>| {
            for c in candidates.iter_mut().filter(|c| !c.done && c.required) {
                let mut used = Vec::new();
                c.key.parts.iter().for_each(|p| slots_of_part(p, &mut used));
                if used.iter().any(|s| free.contains(s)) {
                    continue;
                }
                c.done = true;
                let implied = match c.key.parts.as_slice() {
                    [Part::Slot(s)] => known
                        .iter()
                        .any(|&(k, t)| k == *s && self.within(t, c.table)),
                    _ => false,
                };
                if !implied {
                    steps.push(Step::Member(c.table, c.key.clone()));
                }
            }
            filters.retain(|(i, used)| {
                if used.iter().any(|s| free.contains(s)) {
                    return true;
                }
                if !self.scanned_by(&d.conditions[*i], steps) {
                    steps.push(Step::Filter(*i));
                }
                false
            });
        };
        settle(&free, &mut candidates, &mut filters, &known, &mut steps);
        while !free.is_empty() {
            let mut best: Option<(f64, usize)> = None;
            for (i, c) in candidates.iter().enumerate() {
                if c.done
                    || !c.key.is_plain()
                    || !c
                        .key
                        .parts
                        .iter()
                        .any(|p| matches!(p, Part::Slot(s) if free.contains(s)))
                {
                    continue;
                }
                let t = self.store.table(c.table);
                let rows = t.len() as f64;
                let mut groups = 1.0;
                if t.dim() > 1 {
                    let distinct = t.distinct();
                    for (p, part) in c.key.parts.iter().enumerate() {
                        if !matches!(part, Part::Slot(s) if free.contains(s)) {
                            groups *= f64::from(distinct[p]);
                        }
                    }
                }
                let mut new = Vec::new();
                c.key.parts.iter().for_each(|p| {
                    if let Part::Slot(s) = p
                        && free.contains(s)
                        && !new.contains(s)
                    {
                        new.push(*s);
                    }
                });
                if pick == Pick::InOrder && new != free[..new.len()] {
                    continue;
                }
                // Fan-out per slot that it binds.
                let fan = (rows / groups.clamp(1.0, rows.max(1.0))).max(1e-3);
                let cost = fan.powf(1.0 / new.len() as f64);
                if best.is_none_or(|(b, _)| cost < b * 0.999) {
                    best = Some((cost, i));
                }
            }
            let Some((_, i)) = best else {
                // A slot that no table binds: cannot happen, since every controlled index has its set.
                debug_assert!(false, "a slot without a driver");
                break;
            };
            let c = &mut candidates[i];
            c.done = true;
            let (mut mask, mut bind, mut equal) = (0u32, Vec::new(), Vec::new());
            for (p, part) in c.key.parts.iter().enumerate() {
                match part {
                    Part::Slot(s) if free.contains(s) => {
                        if bind.iter().any(|&(_, b)| b == *s) {
                            equal.push((p as u8, *s));
                        } else {
                            bind.push((p as u8, *s));
                        }
                    }
                    _ => mask |= 1 << p,
                }
            }
            free.retain(|s| !bind.iter().any(|(_, b)| b == s));
            for &(p, s) in &bind {
                order.push(s);
                if self.store.table(c.table).dim() == 1 {
                    known.push((s, c.table));
                }
                if let Some(t) = self.position_set(c.table, p as usize) {
                    known.push((s, t));
                }
            }
            steps.push(Step::Scan {
                table: c.table,
                key: c.key.parts.clone().into(),
                mask,
                bind: bind.into(),
                equal: equal.into(),
            });
            settle(&free, &mut candidates, &mut filters, &known, &mut steps);
        }
        let mut sizes: Vec<(TableId, usize)> = candidates
            .iter()
            .map(|c| (c.table, self.store.table(c.table).len()))
            .collect();
        sizes.dedup();
        Plan {
            steps,
            ordered: order == d.slots,
            sizes,
        }
    }

    /// Whether a condition is "this record is not 0" of a record that a step scans: then it holds.
    fn scanned_by(&self, condition: &Node, steps: &[Step]) -> bool {
        let NodeKind::Data(t, wanted) = &condition.kind else {
            return false;
        };
        let same = |(a, b): (&Part, &Part)| match (a, b) {
            (Part::Slot(a), Part::Slot(b)) => a == b,
            (Part::Label(a), Part::Label(b)) => a == b,
            _ => false,
        };
        self.store.table(*t).default_value() == 0.0
            && steps.iter().any(|s| match s {
                Step::Scan { table, key, .. } => {
                    table == t && key.iter().zip(&wanted.parts).all(same)
                }
                _ => false,
            })
    }

    /// Whether a slot belongs to a sum inside the expression, not to the statement around.
    fn is_inner(&self, slot: Slot, d: &Domain) -> bool {
        d.slots.iter().max().is_some_and(|&m| slot > m)
    }

    /// The set that a table's position runs over, by its declaration.
    fn position_set(&self, table: TableId, position: usize) -> Option<TableId> {
        let symbol = self.symbols.get(self.table_symbol(table)?);
        match symbol.domain.get(position)? {
            DomainPosition::Set(d) => Some(self.symbols.get(*d).table),
            _ => None,
        }
    }

    /// Whether every member of set table `a` is in `b`.
    fn within(&self, a: TableId, b: TableId) -> bool {
        if a == b {
            return true;
        }
        match (self.table_symbol(a), self.table_symbol(b)) {
            (Some(x), Some(y)) => {
                let y_set = self.symbols.get(y);
                // Declared subsets are checked on the way in; a set that assignments shrink is no bound.
                self.symbols.get(x).is_set() && !y_set.dynamic && self.symbols.is_subset(x, y)
            }
            _ => false,
        }
    }

    /// When can an expression be nonzero? With `symbolic`, in an equation: a zero factor removes the term.
    pub(super) fn support(&self, n: &Node, symbolic: bool) -> Support {
        match &n.kind {
            NodeKind::Const(x) if *x == 0.0 => Some(Vec::new()),
            NodeKind::Data(t, key) => {
                let table = self.store.table(*t);
                (table.default_value() == 0.0 && !key.parts.is_empty() && key.is_plain()).then(
                    || {
                        vec![vec![Driver {
                            table: *t,
                            key: key.clone(),
                        }]]
                    },
                )
            }
            NodeKind::Negate(a) => self.support(a, symbolic),
            NodeKind::Sum(terms) => {
                let mut out = Vec::new();
                for (_, t) in terms {
                    out.extend(self.support(t, symbolic)?);
                    if out.len() > MAX_ALTERNATIVES {
                        return None;
                    }
                }
                Some(out)
            }
            NodeKind::Product(factors) => {
                let mut out: Support = None;
                for (i, (divide, f)) in factors.iter().enumerate() {
                    if *divide {
                        continue;
                    }
                    let Some(s) = self.support(f, symbolic) else {
                        continue;
                    };
                    let others_safe = symbolic
                        || factors.iter().enumerate().all(|(k, (d, g))| {
                            k == i
                                || if *d {
                                    self.safe_divisor(g)
                                } else {
                                    self.safe(g)
                                }
                        });
                    if others_safe {
                        out = both(out, Some(s));
                    }
                }
                out
            }
            NodeKind::Dollar(a, c) => both(self.support(c, false), self.support(a, symbolic)),
            NodeKind::Aggregate(AggregateOp::Sum | AggregateOp::Sor, d, body) => {
                let members: Vec<Driver> = d
                    .members
                    .iter()
                    .filter(|m| m.key.is_plain())
                    .cloned()
                    .collect();
                let mut out: Support = Some(vec![members]);
                for c in &d.conditions {
                    out = both(out, self.support(c, false));
                }
                out = both(out, self.support(body, symbolic));
                // Members alone say nothing about the slots outside unless they mention one.
                let outside = out.as_ref().is_some_and(|o| {
                    o.iter().all(|conj| {
                        conj.iter().any(|m| {
                            m.key
                                .parts
                                .iter()
                                .any(|p| matches!(p, Part::Slot(s) if !d.slots.contains(s)))
                        })
                    })
                });
                if outside { out } else { None }
            }
            NodeKind::Binary(BinaryOp::And, a, b) => {
                both(self.support(a, false), self.support(b, false))
            }
            NodeKind::Binary(BinaryOp::Or, a, b) => {
                let (mut a, b) = (self.support(a, false)?, self.support(b, false)?);
                a.extend(b);
                (a.len() <= MAX_ALTERNATIVES).then_some(a)
            }
            NodeKind::Binary(
                op @ (BinaryOp::Gt
                | BinaryOp::Ge
                | BinaryOp::Lt
                | BinaryOp::Le
                | BinaryOp::Ne
                | BinaryOp::Eq),
                a,
                b,
            ) => {
                // Is the relation false when the data side is 0?
                let (data, c, op) = match (&a.kind, &b.kind) {
                    (_, NodeKind::Const(c)) => (a, *c, *op),
                    (NodeKind::Const(c), _) => (b, *c, mirror(*op)),
                    _ => return None,
                };
                let false_at_zero = match op {
                    BinaryOp::Gt => 0.0 <= c,
                    BinaryOp::Ge => 0.0 < c,
                    BinaryOp::Lt => 0.0 >= c,
                    BinaryOp::Le => 0.0 > c,
                    BinaryOp::Ne => c == 0.0,
                    BinaryOp::Eq => c != 0.0,
                    _ => false,
                };
                if false_at_zero {
                    self.support(data, false)
                } else {
                    None
                }
            }
            NodeKind::Call(
                Function::Abs
                | Function::Sqr
                | Function::Sign
                | Function::Floor
                | Function::Ceil
                | Function::Round
                | Function::Trunc,
                a,
            ) if a.len() == 1 && !symbolic => self.support(&a[0], false),
            _ => None,
        }
    }

    /// Whether an expression is always an ordinary number, so that 0 times it is 0.
    fn safe(&self, n: &Node) -> bool {
        match &n.kind {
            NodeKind::Const(x) => x.is_finite(),
            NodeKind::Data(t, key) => {
                let t = self.store.table(*t);
                !t.has_special()
                    && t.default_value() == 0.0
                    && key.parts.iter().all(|p| !matches!(p, Part::Singleton(..)))
            }
            NodeKind::Ord(..) | NodeKind::Card(_) | NodeKind::SameAs(..) => true,
            NodeKind::Negate(a) => self.safe(a),
            NodeKind::Sum(t) => t.iter().all(|(_, x)| self.safe(x)),
            NodeKind::Product(t) => t.iter().all(|(d, x)| {
                if *d {
                    self.safe_divisor(x)
                } else {
                    self.safe(x)
                }
            }),
            NodeKind::Dollar(a, c) => self.safe(a) && self.safe(c),
            NodeKind::Binary(op, a, b) => *op != BinaryOp::Power && self.safe(a) && self.safe(b),
            NodeKind::Not(a) => self.safe(a),
            NodeKind::Aggregate(AggregateOp::Sum, d, b) => {
                self.safe(b) && d.conditions.iter().all(|c| self.safe(c))
            }
            NodeKind::Call(
                Function::Abs
                | Function::Sqr
                | Function::Sign
                | Function::Min
                | Function::Max
                | Function::Floor
                | Function::Ceil,
                a,
            ) => a.iter().all(|x| self.safe(x)),
            _ => false,
        }
    }

    /// Whether dividing by it is always fine: a number or scalar that is not 0.
    fn safe_divisor(&self, n: &Node) -> bool {
        match &n.kind {
            NodeKind::Const(x) => x.is_finite() && *x != 0.0,
            NodeKind::Data(t, key) if key.parts.is_empty() => {
                let v = self.store.table(*t).get(&[]);
                v.is_finite() && v != 0.0
            }
            NodeKind::Card(t) => !self.store.table(*t).is_empty(),
            _ => false,
        }
    }

    /// Runs a plan: `f` is called for each tuple with the frame filled in; it returns false to stop.
    pub(super) fn run_plan(
        &self,
        d: &Domain,
        plan: &Plan,
        frame: &mut Vec<Label>,
        f: &mut dyn FnMut(&mut Vec<Label>) -> bool,
    ) -> bool {
        self.run_steps(d, &plan.steps, frame, f)
    }

    fn run_steps(
        &self,
        d: &Domain,
        steps: &[Step],
        frame: &mut Vec<Label>,
        f: &mut dyn FnMut(&mut Vec<Label>) -> bool,
    ) -> bool {
        let Some((step, rest)) = steps.split_first() else {
            return f(frame);
        };
        match step {
            Step::Filter(i) => {
                if !crate::data::value::truth(self.eval(&d.conditions[*i], frame)) {
                    return true;
                }
                self.run_steps(d, rest, frame, f)
            }
            Step::Member(t, key) => {
                if !self.is_member(*t, key, frame) {
                    return true;
                }
                self.run_steps(d, rest, frame, f)
            }
            Step::Scan {
                table,
                key,
                mask,
                bind,
                equal,
            } => {
                let t = self.store.table(*table);
                let order;
                let rows = if *mask == 0 {
                    t.all()
                } else {
                    let mut k = [0; 20];
                    for (p, part) in key.iter().enumerate() {
                        k[p] = match part {
                            Part::Slot(s) => frame[*s as usize],
                            Part::Label(l) => *l,
                            _ => 0,
                        };
                    }
                    order = t.order(*mask);
                    t.group(&order, &k[..key.len()])
                };
                let last = rest.is_empty();
                for r in 0..rows.len() {
                    let record = t.key(rows.get(r));
                    for &(p, s) in bind.iter() {
                        frame[s as usize] = record[p as usize];
                    }
                    if !equal
                        .iter()
                        .all(|&(p, s)| frame[s as usize] == record[p as usize])
                    {
                        continue;
                    }
                    let go_on = if last {
                        f(frame)
                    } else {
                        self.run_steps(d, rest, frame, f)
                    };
                    if !go_on {
                        return false;
                    }
                }
                true
            }
        }
    }

    /// All tuples of a domain, flat, in label order.
    pub(super) fn tuples(&self, d: &Domain, frame: &mut Vec<Label>) -> Vec<Label> {
        let plan = self.plan(d, None);
        let mut out = Vec::new();
        self.run_plan(d, &plan, frame, &mut |f| {
            out.extend(d.slots.iter().map(|&s| f[s as usize]));
            self.keep_going()
        });
        if plan.ordered {
            out
        } else {
            sort_tuples(out, d.slots.len(), false)
        }
    }
}

fn mirror(op: BinaryOp) -> BinaryOp {
    match op {
        BinaryOp::Gt => BinaryOp::Lt,
        BinaryOp::Ge => BinaryOp::Le,
        BinaryOp::Lt => BinaryOp::Gt,
        BinaryOp::Le => BinaryOp::Ge,
        other => other,
    }
}

/// Both must be nonzero: pairs of alternatives.
fn both(a: Support, b: Support) -> Support {
    match (a, b) {
        (None, x) | (x, None) => x,
        (Some(a), Some(b)) => {
            if a.len() * b.len() > MAX_ALTERNATIVES {
                return Some(if a.len() <= b.len() { a } else { b });
            }
            let mut out = Vec::new();
            for x in &a {
                for y in &b {
                    let mut z = x.clone();
                    z.extend(y.iter().cloned());
                    out.push(z);
                }
            }
            Some(out)
        }
    }
}

/// Slots that an expression reads from outside of its own sums.
pub(super) fn slots_of(n: &Node, out: &mut Vec<Slot>) {
    let mut part = |p: &Part| slots_of_part(p, out);
    match &n.kind {
        NodeKind::Data(_, k)
        | NodeKind::Var(_, k)
        | NodeKind::Derived(_, _, k)
        | NodeKind::ElementText(_, k)
        | NodeKind::RecordName(_, k) => {
            k.parts.iter().for_each(part);
        }
        NodeKind::Ord(_, p) | NodeKind::LabelAttribute(_, _, p) | NodeKind::LabelText(p) => part(p),
        NodeKind::SameAs(a, b) => {
            part(a);
            part(b);
        }
        NodeKind::OfText(t, n) => {
            slots_of(t, out);
            n.iter().for_each(|n| slots_of(n, out));
        }
        NodeKind::Dollar(a, c) => {
            slots_of(a, out);
            slots_of(c, out);
        }
        NodeKind::Aggregate(_, d, b) => {
            for m in &d.members {
                m.key.parts.iter().for_each(|p| slots_of_part(p, out));
            }
            d.conditions.iter().for_each(|c| slots_of(c, out));
            slots_of(b, out);
        }
        NodeKind::Negate(a) | NodeKind::Not(a) => slots_of(a, out),
        NodeKind::Sum(t) | NodeKind::Product(t) => t.iter().for_each(|(_, x)| slots_of(x, out)),
        NodeKind::Binary(_, a, b) => {
            slots_of(a, out);
            slots_of(b, out);
        }
        NodeKind::Call(_, a) | NodeKind::DataCall(_, a) => a.iter().for_each(|x| slots_of(x, out)),
        _ => {}
    }
}

fn slots_of_part(p: &Part, out: &mut Vec<Slot>) {
    match p {
        Part::Slot(s) => out.push(*s),
        Part::Lag(l) => {
            slots_of_part(&l.base, out);
            slots_of(&l.offset, out);
        }
        _ => {}
    }
}
