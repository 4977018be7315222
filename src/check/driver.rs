//! What drives a loop around assignments: turns that GAMS passes over.

use super::Compiler;
use super::node::*;
use super::symbols::UNIVERSE;
use super::visit::Visitor;
use crate::model::instance::Function;
use crate::source::Span;

impl Compiler {
    /// What drives a loop around nothing but assignments to parameters and sets, as GAMS runs it: turns in which the
    /// right sides are 0 whatever the assignments' own indices are passed over, and nothing is assigned in them. Only
    /// where each turn assigns whole symbols: `p(i)`, not `p(i,j)` with j of the loop, `p(i,'a')`, `p(i+1)`, a
    /// subset, or `p(*)`.
    /// What the right side reads is searched by its first positions, up to the first that the loop does not
    /// control: of `loop(j, p(i) = q(j,i))` the turns are those for which q has a record with this j.
    /// An index over a set of one element does not drive.
    /// A loop that is all that another holds counts as one with it; indices of others around do not drive.
    /// An assignment under a `$`, its own or that of a loop within, counts by the condition, whatever it assigns and to
    /// what: `b(j)$q(i) = 5`, `b(j) $= q(i)`, `loop(k$q(i), s = 5)`.
    /// `break`, `continue` and `option` among the assignments are passed over with the turn; under the `$` of a loop
    /// within they count by its condition.
    pub(super) fn driver(&mut self, body: &[Code]) -> Option<Node> {
        let mut found = Found::default();
        if !driven(body, &Around::default(), &mut found) {
            return None;
        }
        let assigned = found.assigned;
        let tables: Vec<TableId> = assigned.iter().filter_map(|a| a.table).collect();
        let (mut unless, mut all_guarded) = (Vec::new(), true);
        for a in &assigned {
            let guard = self.meeting(&a.guards, &a.own);
            let by_value = guard.is_none();
            let value = a.value.filter(|v| self.holds_data(a) && !v.has_random());
            let decides = match by_value {
                true => std::slice::from_ref(value?),
                false => &a.guards,
            };
            let mut reading = LateReading {
                compiler: self,
                table: a.table.filter(|_| by_value),
                tables: &tables,
                own: &a.own,
                inner: Vec::new(),
                guarded: by_value && a.set,
                early: false,
            };
            decides.iter().for_each(|n| reading.node(n));
            if reading.early || decides.iter().any(Node::has_random) {
                return None;
            }
            all_guarded &= !by_value;
            unless.extend(match guard {
                Some(guard) => guard,
                None => self.resting(value?, &a.own)?,
            });
        }
        // Where nothing comes of a turn it need not be passed over.
        let passing_shows = !all_guarded || found.others;
        unless.into_iter().reduce(either).filter(|_| passing_shows)
    }

    fn holds_data(&self, a: &Assigned) -> bool {
        a.table.is_some_and(|t| self.is_data(t))
    }

    /// Where no record of the loop's indices is read an expression is 0, whatever its own indices are: the conditions of
    /// which one holds elsewhere. None if it need not be 0 there, or if GAMS does not see it: it looks at the form,
    /// `q(k)/2`, `q(k)/s`, not `q(k)/w(k)`.
    fn resting(&mut self, n: &Node, own: &[Slot]) -> Option<Vec<Node>> {
        match &n.kind {
            NodeKind::Const(0.0) => Some(Vec::new()),
            NodeKind::Data(table, key) => self.begins_with(*table, key, own, n.span),
            NodeKind::SameAs(a, b)
                if [a, b].iter().all(|p| is_fixed(p, own)) && (self.turns(a) || self.turns(b)) =>
            {
                let same = NodeKind::SameAs(a.clone(), b.clone());
                let mut unless = vec![Node::membership(same, n.span)];
                unless.extend(self.one_turn(&[a.clone(), b.clone()], n.span));
                Some(unless)
            }
            NodeKind::Sum(list) => self.together(list.iter().map(|(_, t)| t), own),
            NodeKind::Product(list) => {
                let special =
                    |n: &Node| matches!(n.kind, NodeKind::Const(x) if !x.is_normal() && x != 0.0);
                if list.iter().any(|(_, f)| special(f)) {
                    return None;
                }
                let negative = |n: &Node| matches!(n.kind, NodeKind::Const(x) if x < 0.0);
                let hides =
                    |(divides, f): &(bool, Node)| *divides && (!self.is_number(f) || negative(f));
                let from = list.iter().rposition(hides).map_or(0, |n| n + 1);
                let factors = list[from..].iter().filter(|(divides, _)| !divides);
                self.meeting(factors.map(|(_, f)| f), own)
            }
            NodeKind::Dollar(a, c) => self.meeting([&**a, c], own),
            NodeKind::Binary(BinaryOp::And, a, b) => self.meeting([&**a, b], own),
            NodeKind::Binary(BinaryOp::Or | BinaryOp::Xor, a, b) => self.together([&**a, b], own),
            NodeKind::Binary(BinaryOp::Power, a, b) => self.power(a, b, own),
            NodeKind::Binary(
                op @ (BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge | BinaryOp::Ne),
                a,
                b,
            ) => {
                let right = self.is_number(b);
                let (side, number) = if right { (a, b) } else { (b, a) };
                let mut unless = self.resting(side, own)?;
                unless.extend(self.compared(*op, number, right)?);
                Some(unless)
            }
            NodeKind::Call(Function::Max | Function::Min, list) => self.together(list, own),
            NodeKind::Call(Function::Power, list) => match list.as_slice() {
                [base, exponent] => self.power(base, exponent, own),
                _ => None,
            },
            // Others do not count, though some are 0 at 0.
            NodeKind::Call(f, list) if is_seen_at_zero(*f) => match list.as_slice() {
                [argument] => self.resting(argument, own),
                _ => None,
            },
            NodeKind::Aggregate(AggregateOp::Sum | AggregateOp::Sor, d, body) => {
                let own: Vec<Slot> = own.iter().chain(&d.slots).copied().collect();
                let members: Vec<Node> = d.members.iter().map(|m| record(m, n.span)).collect();
                let parts = members.iter().chain(&d.conditions).chain([&**body]);
                self.meeting(parts, &own)
            }
            _ => None,
        }
    }

    /// A power is 0 with its base, if the exponent is positive.
    fn power(&mut self, base: &Node, exponent: &Node, own: &[Slot]) -> Option<Vec<Node>> {
        let mut unless = self.resting(base, own)?;
        unless.extend(self.compared(BinaryOp::Le, exponent, false)?);
        Some(unless)
    }

    /// A number of the text, or a scalar.
    fn is_number(&self, n: &Node) -> bool {
        match &n.kind {
            NodeKind::Const(x) => x.is_normal() || *x == 0.0,
            NodeKind::Data(t, key) => key.parts.is_empty() && self.is_data(*t),
            _ => false,
        }
    }

    /// Whether a table holds the values of a parameter or the members of a set, not an attribute.
    fn is_data(&self, table: TableId) -> bool {
        let mut symbols = self.symbols.iter();
        symbols.any(|(_, s)| s.table == table && !s.has_attributes())
    }

    /// When a comparison of 0 with a number holds: never (no condition), or where a scalar says so. `zero_first`: the
    /// 0 stands on the left. None if it always holds, or with what is no number.
    fn compared(&self, op: BinaryOp, number: &Node, zero_first: bool) -> Option<Option<Node>> {
        if !self.is_number(number) {
            return None;
        }
        if let NodeKind::Const(x) = number.kind {
            let (a, b) = if zero_first { (0.0, x) } else { (x, 0.0) };
            let holds = match op {
                BinaryOp::Lt => a < b,
                BinaryOp::Le => a <= b,
                BinaryOp::Gt => a > b,
                BinaryOp::Ge => a >= b,
                _ => a != b,
            };
            return (!holds).then_some(None);
        }
        let (zero, scalar) = (Node::number(0.0, number.span), number.clone());
        Some(Some(match zero_first {
            true => Node::binary(op, zero, scalar, number.span),
            false => Node::binary(op, scalar, zero, number.span),
        }))
    }

    /// Of several expressions: 0 where all are.
    fn together<'n>(
        &mut self,
        parts: impl IntoIterator<Item = &'n Node>,
        own: &[Slot],
    ) -> Option<Vec<Node>> {
        let mut unless = Vec::new();
        for n in parts {
            unless.extend(self.resting(n, own)?);
        }
        Some(unless)
    }

    /// Of a product: 0 where any factor is.
    fn meeting<'n>(
        &mut self,
        factors: impl IntoIterator<Item = &'n Node>,
        own: &[Slot],
    ) -> Option<Vec<Node>> {
        let zero = factors.into_iter().filter_map(|f| self.resting(f, own));
        let all = zero.filter_map(|unless| unless.into_iter().reduce(either));
        Some(vec![all.reduce(both)?])
    }

    /// Whether it is an index that turns the loop.
    fn turns(&self, p: &Part) -> bool {
        matches!(p, Part::Slot(s) if self.nest.iter().any(|(t, _)| t == s))
    }

    /// Whether none of these indices turns in fact: a set of one element counts as its label.
    fn one_turn(&self, parts: &[Part], span: Span) -> Option<Node> {
        let turning = |p: &Part| match p {
            Part::Slot(s) => self.nest.iter().find(|(t, _)| t == s).map(|(_, set)| *set),
            _ => None,
        };
        let single = parts.iter().filter_map(turning).map(|set| {
            let count = Node::data(NodeKind::Card(set), span);
            Node::binary(BinaryOp::Eq, count, Node::number(1.0, span), span)
        });
        single.reduce(both)
    }

    /// Whether there is a record with these first positions, up to the first that the loop does not control.
    fn begins_with(
        &mut self,
        table: TableId,
        key: &Key,
        own: &[Slot],
        span: Span,
    ) -> Option<Vec<Node>> {
        // An index that comes again behind one that turns the loop is not searched for.
        let mut seen: Vec<Slot> = Vec::new();
        let mut turned = false;
        let searched = |p: &&Part| {
            let again = matches!(p, Part::Slot(s) if seen.contains(s));
            if let Part::Slot(s) = p {
                seen.push(*s);
            }
            let goes_on = !(again && turned) && is_fixed(p, own);
            turned |= self.turns(p);
            goes_on
        };
        let fixed = key.parts.iter().take_while(searched).count();
        if !key.parts[..fixed].iter().any(|p| self.turns(p)) {
            return None;
        }
        let one_turn = self.one_turn(&key.parts[..fixed], span);
        let mut unless: Vec<Node> = one_turn.into_iter().collect();
        let mut parts = key.parts.clone();
        if fixed == parts.len() {
            let kind = NodeKind::Data(table, Key { parts });
            unless.push(Node::data(kind, span));
            return Some(unless);
        }
        let mut domain = Domain::default();
        for part in &mut parts[fixed..] {
            let slot = self.new_slot();
            *part = Part::Slot(slot);
            domain.slots.push(slot);
            domain.sets.push(self.symbols.get(UNIVERSE).table);
            domain.names.push(UNIVERSE);
        }
        let key = Key { parts };
        domain.members.push(Driver { table, key });
        let one = Box::new(Node::number(1.0, span));
        let any = NodeKind::Aggregate(AggregateOp::Sor, Box::new(domain), one);
        unless.push(Node::data(any, span));
        Some(unless)
    }
}

/// Loops around an assignment, within the one that is looked at.
#[derive(Clone, Default)]
struct Around {
    slots: Vec<Slot>,
    /// What must hold or be there for a turn.
    guards: Vec<Node>,
    /// One of them has a `$`.
    conditional: bool,
}

/// What drives a loop, perhaps.
#[derive(Default)]
struct Found<'b> {
    assigned: Vec<Assigned<'b>>,
    /// There is a `break` or an option besides.
    others: bool,
}

/// An assignment that may count.
struct Assigned<'b> {
    /// The right side, where a whole symbol is assigned under no `$` of its own.
    value: Option<&'b Node>,
    /// What must hold for anything to come of it.
    guards: Vec<Node>,
    /// Its own indices, and those of loops within.
    own: Vec<Slot>,
    table: Option<TableId>,
    set: bool,
}

/// Whether these are nothing but assignments, `break`, `continue` and options, in `if` and in loops or not; adds them.
fn driven<'b>(body: &'b [Code], around: &Around, out: &mut Found<'b>) -> bool {
    body.iter().all(|c| match &c.kind {
        CodeKind::If(arms, otherwise) => {
            arms.iter().all(|(_, body)| driven(body, around, out)) && driven(otherwise, around, out)
        }
        CodeKind::While(_, body) | CodeKind::Repeat(body, _) => driven(body, around, out),
        CodeKind::Loop(domain, late, body) => {
            let mut around = around.clone();
            around.slots.extend(&domain.slots);
            let members = domain.members.iter().map(|m| record(m, c.span));
            let conditions = domain.conditions.iter().chain(late).cloned();
            around.guards.extend(members.chain(conditions));
            around.conditional |= !domain.conditions.is_empty() || !late.is_empty();
            driven(body, &around, out)
        }
        CodeKind::Assign(a) => {
            let conditional = a.nonzero || !a.domain.conditions.is_empty();
            let mut guards = around.guards.clone();
            guards.extend(a.domain.conditions.iter().cloned());
            guards.extend(a.nonzero.then(|| a.value.clone()));
            let whole = a.covers && !conditional && !a.domain.slots.is_empty();
            out.assigned.push(Assigned {
                value: whole.then_some(&a.value),
                guards,
                own: [&around.slots[..], &a.domain.slots].concat(),
                table: match a.target {
                    Target::Table(t) | Target::Set(t) => Some(t),
                    _ => None,
                },
                set: matches!(a.target, Target::Set(_)),
            });
            true
        }
        CodeKind::Break(..)
        | CodeKind::Continue
        | CodeKind::Option(..)
        | CodeKind::Format(..)
        | CodeKind::Clear(..)
        | CodeKind::Match(..)
        | CodeKind::Project { .. } => {
            out.others |= !matches!(c.kind, CodeKind::Continue);
            if around.conditional {
                out.assigned.push(Assigned {
                    value: None,
                    guards: around.guards.clone(),
                    own: around.slots.clone(),
                    table: None,
                    set: false,
                });
            }
            true
        }
        _ => false,
    })
}

/// Whether a loop's assignment reads what it writes to so that no turn may be passed over: GAMS passes over turns
/// where no such reading is at the record that is written or at labels alone, and, of a parameter, all is under a `$`
/// whose other side drives the loop: `p(i,j) = q(k)$p(i++1,j)`, but not `q(k)*p(i++1,j)`, `q(k)$p(i,j)`, `q(k)$p('a','b')`.
/// What other assignments of the loop write to need only be so guarded.
struct LateReading<'c> {
    compiler: &'c mut Compiler,
    /// Of an assignment that is under no `$`.
    table: Option<TableId>,
    tables: &'c [TableId],
    own: &'c [Slot],
    /// Indices of the sums around.
    inner: Vec<Slot>,
    guarded: bool,
    early: bool,
}

impl LateReading<'_> {
    /// Whether it is 0 where no record of the loop's index is.
    fn drives(&mut self, n: &Node) -> bool {
        let own = [self.own, &self.inner].concat();
        self.compiler.resting(n, &own).is_some()
    }

    /// Both sides of a `$`.
    fn sides(&mut self, a: &Node, b: &Node) {
        for (n, other) in [(a, b), (b, a)] {
            let before = self.guarded;
            self.guarded |= self.drives(other);
            self.node(n);
            self.guarded = before;
        }
    }
}

impl<'a> Visitor<'a> for LateReading<'_> {
    fn node(&mut self, n: &'a Node) {
        match &n.kind {
            NodeKind::Data(t, key) if self.tables.contains(t) => {
                let own = |p: (&Part, &Slot)| matches!(p.0, Part::Slot(s) if s == p.1);
                let same = key.parts.iter().zip(self.own).all(own);
                let fixed = key.parts.iter().all(|p| matches!(p, Part::Label(_)));
                let scalar = key.parts.is_empty();
                self.early |=
                    !scalar && (!self.guarded || Some(*t) == self.table && (same || fixed));
                n.walk(self);
            }
            NodeKind::Dollar(a, c) => self.sides(a, c),
            NodeKind::Aggregate(_, d, body) => {
                let outside = self.inner.len();
                self.inner.extend(&d.slots);
                let before = self.guarded;
                self.guarded |= d.members.iter().any(|m| self.drives(&record(m, n.span)));
                for c in &d.conditions {
                    self.sides(body, c);
                }
                if d.conditions.is_empty() {
                    self.node(body);
                }
                self.guarded = before;
                self.inner.truncate(outside);
            }
            _ => n.walk(self),
        }
    }
}

/// Whether an index is a label or one that runs outside.
fn is_fixed(p: &Part, own: &[Slot]) -> bool {
    match p {
        Part::Slot(s) => !own.contains(s),
        Part::Label(_) => true,
        Part::Lag(_) | Part::Singleton(..) => false,
    }
}

/// Whether GAMS sees that a function of one argument is 0 at 0.
fn is_seen_at_zero(f: Function) -> bool {
    use Function::*;
    matches!(
        f,
        Sqr | Sqrt | Abs | Sign | Round | Floor | Ceil | Trunc | Frac
    ) || matches!(f, Sin | Tan | ArcSin | ArcTan | Sinh | Tanh)
}

/// What a domain runs over, as what is asked of a turn.
fn record(m: &Driver, span: Span) -> Node {
    Node::data(NodeKind::Data(m.table, m.key.clone()), span)
}

/// `a and b`
fn both(a: Node, b: Node) -> Node {
    let span = a.span;
    Node::binary(BinaryOp::And, a, b, span)
}

/// `a or b`
fn either(a: Node, b: Node) -> Node {
    let span = a.span;
    Node::binary(BinaryOp::Or, a, b, span)
}
