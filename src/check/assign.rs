//! Assignments: what is written, where, and in which order.

use super::functions;
use super::node::*;
use super::symbols::{DomainPosition, SymbolKind, UNIVERSE, attribute};
use super::visit::Visitor;
use super::{Compiler, Failed};
use crate::autodiff::functions::function_value;
use crate::diag::Diagnostic;
use crate::model::instance::Function;
use crate::source::Span;
use crate::syntax::ast::{self, Assign, Expr, ExprKind, Reference};

impl Compiler {
    /// An assignment; several statements where GAMS does more than one thing.
    pub(super) fn assign(
        &mut self,
        a: &Assign,
        span: Span,
        out: &mut Vec<Code>,
    ) -> Result<(), Failed> {
        let t = &a.target;
        let counter = match t.name.name.to_lowercase().as_str() {
            "execseed" => Some(Target::Seed),
            "execerror" => Some(Target::Errors),
            "maxexecerror" => Some(Target::MostErrors),
            "heaplimit" => Some(Target::Ignored),
            _ => None,
        };
        if let Some(target) = counter
            && self.symbols.find(&t.name.name).is_none()
        {
            let value = self.expr(&a.value)?;
            let kind = CodeKind::Assign {
                domain: Domain::default(),
                target,
                key: Key::default(),
                value,
                covers: false,
                nonzero: a.nonzero,
            };
            out.push(Code::new(kind, span));
            return Ok(());
        }
        let s = self.lookup(&t.name)?;
        self.shape(s, &t.indices);
        let target = self.target(s, t)?;
        if matches!(target, Target::Set(_) | Target::Singleton(_)) {
            self.changes_control(s, t.span)?;
        }
        let symbol = self.symbols.get(s).clone();
        let root = self.symbols.root(s);
        let (domain, key, value, covers) = self.scoped(|c| {
            let mut domain = Domain::default();
            let parts = match target {
                Target::Object(..) => Vec::new(),
                _ => c.defining(|c| c.control_key(&t.indices, s, t.span, &mut domain))?,
            };
            if let Some(cond) = &a.condition {
                c.condition(cond, &mut domain)?;
            }
            c.texts_allowed = matches!(target, Target::Object(..));
            let value = c.expr(&a.value);
            c.texts_allowed = false;
            let value = value?;
            if matches!(target, Target::Table(_) | Target::Fix(_)) {
                c.index_as_number(&value);
                c.loose_condition(&a.value);
            }
            let covers = domain.conditions.is_empty()
                && !a.nonzero
                && domain.slots.len() == symbol.dim()
                && domain.members.len() == symbol.dim()
                && parts.iter().enumerate().all(|(p, part)| {
                    let Part::Slot(slot) = part else { return false };
                    domain.slots.get(p) == Some(slot)
                        && match symbol.domain[p] {
                            DomainPosition::Set(d) => domain.sets[p] == c.symbols.get(d).table,
                            _ => false,
                        }
                });
            Ok((domain, Key { parts }, value, covers))
        })?;
        let sym = self.symbols.get_mut(root);
        sym.assigned = true;
        if matches!(target, Target::Set(_) | Target::Singleton(_)) {
            sym.dynamic = true;
        }
        let mut reading = SelfReading {
            tables: self.tables(target),
            ..SelfReading::default()
        };
        domain.conditions.iter().for_each(|c| reading.node(c));
        reading.node(&value);
        // GAMS empties what is assigned anew before it counts it.
        let whole = symbol.dim() > 0 && !symbol.has_attributes();
        if covers && whole && reading.counted && reading.keys.is_empty() {
            out.push(Code::new(CodeKind::Clear(root, None), span));
        }
        let recurrence = reading.is_recurrence(&key);
        let code = |domain| {
            let kind = CodeKind::Assign {
                domain,
                target,
                value,
                covers,
                nonzero: a.nonzero,
                key,
            };
            Code::new(kind, span)
        };
        out.push(if recurrence {
            let (conditions, outer) = (
                domain.conditions,
                Domain {
                    conditions: Vec::new(),
                    ..domain
                },
            );
            let inner = Domain {
                conditions,
                ..Domain::default()
            };
            Code::new(CodeKind::Loop(outer, vec![code(inner)]), span)
        } else {
            code(domain)
        });
        Ok(())
    }

    /// `s(t) = s(t-1) + 1 $ t > 1`: `$` takes `t` alone.
    fn loose_condition(&mut self, value: &Expr) {
        use ast::BinaryOp::{Eq, Ge, Gt, Le, Lt, Ne};
        let ExprKind::Binary(Eq | Ne | Lt | Le | Gt | Ge, left, _) = &value.kind else {
            return;
        };
        let last = match &left.kind {
            ExprKind::Sum(terms) => terms.last().map(|(_, t)| t),
            _ => Some(&**left),
        };
        if let Some(ExprKind::Dollar(_, c)) = last.map(|l| &l.kind)
            && let ExprKind::Apply { .. } = &c.kind
        {
            let message = "`$` takes only what stands directly behind it; the comparison is made with all that stands on the left";
            let d = Diagnostic::warning("E0379", c.span, message)
                .label("the condition ends here")
                .help("put the condition in parentheses: `1$(ord(t) > 1)`");
            self.report(d);
        }
    }

    /// What is written to.
    fn target(&mut self, s: SymbolId, t: &Reference) -> Result<Target, Failed> {
        let symbol = self.symbols.get(s).clone();
        let target = match &symbol.kind {
            SymbolKind::Parameter { .. } if t.attribute.is_none() => Target::Table(symbol.table),
            SymbolKind::Set { singleton } if t.attribute.is_none() => {
                if *singleton {
                    Target::Singleton(symbol.table)
                } else {
                    Target::Set(symbol.table)
                }
            }
            SymbolKind::Alias(root) if t.attribute.is_none() => {
                Target::Set(self.symbols.get(*root).table)
            }
            SymbolKind::Variable(_)
                if t.attribute.is_none() && self.modes.at(t.name.span).dot_l =>
            {
                Target::Table(symbol.table + attribute::L)
            }
            SymbolKind::Variable(_) | SymbolKind::Equation(_) => {
                let Some(attr) = &t.attribute else {
                    let what = symbol.kind_name();
                    let d = Diagnostic::error(
                        "E0310",
                        t.span,
                        format!("the {what} `{}` cannot be assigned itself", symbol.name),
                    )
                    .label("which of its numbers?")
                    .other(symbol.declared, "declared here");
                    if what == "equation" {
                        self.lose(&t.name.name);
                    }
                    return self.fail(if what == "equation" {
                        d.help(format!(
                            "an equation is defined with two dots: `{}.. left =e= right;`",
                            t.name.name
                        ))
                    } else {
                        d.help(format!(
                            "assign `{0}.l`, `{0}.lo`, `{0}.up` or `{0}.fx`",
                            t.name.name
                        ))
                    });
                };
                self.suits(&symbol, attr)?;
                match functions::record_attribute(&attr.name) {
                    Some(functions::RecordAttribute::Stored(o)) => Target::Table(symbol.table + o),
                    Some(functions::RecordAttribute::Fix) => Target::Fix(s),
                    Some(functions::RecordAttribute::Derived(_)) => {
                        return self.fail(
                            Diagnostic::error(
                                "E0314",
                                attr.span,
                                format!("`.{}` is computed and cannot be assigned", attr.name),
                            )
                            .label("read only"),
                        );
                    }
                    None => {
                        return self.unknown_attribute(
                            attr,
                            &symbol.name,
                            symbol.kind_name(),
                            "l, m, lo, up, fx, scale, prior",
                        );
                    }
                }
            }
            SymbolKind::Model(_) | SymbolKind::File(_) if t.attribute.is_some() => {
                let attr = t.attribute.as_ref().expect("tested above");
                Target::Object(s, self.object_attribute(s, attr)?)
            }
            _ => {
                return self.fail(
                    Diagnostic::error(
                        "E0325",
                        t.span,
                        format!(
                            "`{}` is {} and cannot be assigned",
                            symbol.name,
                            symbol.a_kind()
                        ),
                    )
                    .label("not assignable")
                    .other(symbol.declared, "declared here"),
                );
            }
        };
        let is_set = matches!(target, Target::Set(_) | Target::Singleton(_));
        let root = self.symbols.root(s);
        if is_set && (self.symbols.get(root).is_domain || root == super::symbols::UNIVERSE) {
            return self.fail(
                Diagnostic::error(
                    "E0320",
                    t.span,
                    format!(
                        "the set `{}` cannot be assigned: it is the domain of other symbols",
                        symbol.name
                    ),
                )
                .label("a domain must stay as it is")
                .other(symbol.declared, "declared here")
                .help(format!(
                    "declare a subset, `set sub({});`, and assign that",
                    symbol.name
                )),
            );
        }
        Ok(target)
    }

    /// An error where a set that a loop around runs over is changed.
    pub(super) fn changes_control(&mut self, s: SymbolId, span: Span) -> Result<(), Failed> {
        let root = self.symbols.root(s);
        if !self
            .scope
            .iter()
            .any(|(c, _)| self.symbols.root(*c) == root)
        {
            return Ok(());
        }
        let name = self.symbols.get(root).name.clone();
        let message = format!("the loop runs over `{name}`, which is changed here");
        self.fail(
            Diagnostic::error("E0320", span, message)
                .label("bound by the loop")
                .help(format!(
                    "run over the set it is part of: `loop(i$({name}(i)), …)`; or change a copy"
                )),
        )
    }

    /// What drives a loop around a single assignment to a parameter or set, as GAMS runs it: turns in which the
    /// right side is 0 whatever the assignment's own indices are passed over, and nothing is assigned in them. Only
    /// where each turn assigns the whole symbol: `p(i)`, not `p(i,j)` with j of the loop, `p(i,'a')`, `p(i+1)`, a
    /// subset, or `p(*)`.
    /// What the right side reads is searched by its first positions, up to the first that the loop does not
    /// control: of `loop(j, p(i) = q(j,i))` the turns are those for which q has a record with this j.
    pub(super) fn driver(&mut self, body: &[Code]) -> Option<Node> {
        let (value, own, target) = self.driven(body)?;
        let (table, set) = match target {
            Target::Set(t) => (t, true),
            Target::Table(t) => (t, false),
            _ => return None,
        };
        let mut reading = LateReading {
            compiler: self,
            table,
            own,
            inner: Vec::new(),
            guarded: set,
            early: false,
        };
        reading.node(value);
        if reading.early {
            return None;
        }
        match self.resting(value, own)? {
            (0.0, unless) => unless.into_iter().reduce(either),
            _ => None,
        }
    }

    /// What an expression is where no record of the loop's indices is read, and the conditions of which one holds
    /// elsewhere, whatever its own indices are.
    fn resting(&mut self, n: &Node, own: &[Slot]) -> Option<(f64, Vec<Node>)> {
        match &n.kind {
            NodeKind::Const(x) if x.is_finite() => Some((*x, Vec::new())),
            NodeKind::Data(table, key) => {
                let found = self.begins_with(*table, key, own, n.span)?;
                Some((0.0, vec![found]))
            }
            NodeKind::SameAs(a, b) if [a, b].iter().all(|p| is_fixed(p, own)) => {
                let same = NodeKind::SameAs(a.clone(), b.clone());
                Some((0.0, vec![Node::membership(same, n.span)]))
            }
            NodeKind::Negate(a) => self.together(&[a], own, |v| Some(-v[0])),
            NodeKind::Sum(list) => {
                let terms: Vec<&Node> = list.iter().map(|(_, t)| t).collect();
                let signed = |v: &[f64]| {
                    let terms = v.iter().zip(list);
                    Some(
                        terms
                            .map(|(x, (minus, _))| if *minus { -x } else { *x })
                            .sum(),
                    )
                };
                self.together(&terms, own, signed)
            }
            NodeKind::Product(list) => {
                let factors = list.iter().filter(|(divides, _)| !divides);
                self.meeting(factors.map(|(_, f)| f), own)
            }
            NodeKind::Dollar(a, c) => self.meeting([&**a, c], own),
            NodeKind::Binary(BinaryOp::And, a, b) => self.meeting([&**a, b], own),
            NodeKind::Binary(BinaryOp::Power, a, _) => {
                self.resting(a, own).filter(|(base, _)| *base == 0.0)
            }
            NodeKind::Binary(op, a, b) => self.together(&[a, b], own, |v| {
                let holds = match op {
                    BinaryOp::Or => v[0] != 0.0 || v[1] != 0.0,
                    BinaryOp::Lt => v[0] < v[1],
                    BinaryOp::Le => v[0] <= v[1],
                    BinaryOp::Gt => v[0] > v[1],
                    BinaryOp::Ge => v[0] >= v[1],
                    BinaryOp::Eq => v[0] == v[1],
                    BinaryOp::Ne => v[0] != v[1],
                    _ => return None,
                };
                Some(f64::from(u8::from(holds)))
            }),
            // Others do not count, though some are 0 at 0.
            NodeKind::Call(
                f @ (Function::Sqr
                | Function::Sqrt
                | Function::Power
                | Function::Abs
                | Function::Max
                | Function::Sign
                | Function::Round
                | Function::Floor
                | Function::Ceil
                | Function::Trunc
                | Function::Sin
                | Function::ArcTan
                | Function::Tanh),
                arguments,
            ) => {
                let arguments: Vec<&Node> = arguments.iter().collect();
                self.together(&arguments, own, |v| function_value(*f, v).ok())
            }
            NodeKind::Aggregate(AggregateOp::Sum | AggregateOp::Sor, d, body) => {
                let own: Vec<Slot> = own.iter().chain(&d.slots).copied().collect();
                let members = d.members.iter().map(|m| {
                    let kind = NodeKind::Data(m.table, m.key.clone());
                    Node::data(kind, n.span)
                });
                let members: Vec<Node> = members.collect();
                let parts = members.iter().chain(&d.conditions).chain([&**body]);
                self.meeting(parts, &own)
            }
            _ => None,
        }
    }

    /// Of several expressions that rest together.
    fn together(
        &mut self,
        parts: &[&Node],
        own: &[Slot],
        value: impl Fn(&[f64]) -> Option<f64>,
    ) -> Option<(f64, Vec<Node>)> {
        let mut rests = Vec::new();
        let mut unless = Vec::new();
        for n in parts {
            let (rest, here) = self.resting(n, own)?;
            rests.push(rest);
            unless.extend(here);
        }
        Some((value(&rests)?, unless))
    }

    /// Of a product: 0 where any factor is.
    fn meeting<'n>(
        &mut self,
        factors: impl IntoIterator<Item = &'n Node>,
        own: &[Slot],
    ) -> Option<(f64, Vec<Node>)> {
        let zero = factors.into_iter().filter_map(|f| self.resting(f, own));
        let zero = zero.filter(|(rest, _)| *rest == 0.0);
        let both = |a: Node, b: Node| {
            let span = a.span;
            Node::data(
                NodeKind::Binary(BinaryOp::And, Box::new(a), Box::new(b)),
                span,
            )
        };
        let all = zero.filter_map(|(_, unless)| unless.into_iter().reduce(either));
        Some((0.0, vec![all.reduce(both)?]))
    }

    /// Whether there is a record with these first positions, up to the first that the loop does not control.
    fn begins_with(&mut self, table: TableId, key: &Key, own: &[Slot], span: Span) -> Option<Node> {
        let fixed = key.parts.iter().take_while(|p| is_fixed(p, own)).count();
        let runs = |p: &Part| matches!(p, Part::Slot(_));
        if !key.parts[..fixed].iter().any(runs) {
            return None;
        }
        let mut parts = key.parts.clone();
        if fixed == parts.len() {
            let kind = NodeKind::Data(table, Key { parts });
            return Some(Node::data(kind, span));
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
        let one = Box::new(Node::data(NodeKind::Const(1.0), span));
        let any = NodeKind::Aggregate(AggregateOp::Sor, Box::new(domain), one);
        Some(Node::data(any, span))
    }

    /// The right side of such an assignment, its own indices, and what it writes to.
    fn driven<'b>(&self, body: &'b [Code]) -> Option<(&'b Node, &'b [Slot], Target)> {
        let [only] = body else { return None };
        match &only.kind {
            CodeKind::If(arms, otherwise) if otherwise.is_empty() => match arms.as_slice() {
                [(_, body)] => self.driven(body),
                _ => None,
            },
            CodeKind::Assign {
                domain,
                target: target @ (Target::Table(t) | Target::Set(t)),
                value,
                nonzero: false,
                covers: true,
                ..
            } if !domain.slots.is_empty() => {
                let mut symbols = self.symbols.iter();
                let whole = symbols.any(|(_, s)| s.table == *t && !s.has_attributes());
                (whole && !value.has_random()).then_some((value, &domain.slots, *target))
            }
            _ => None,
        }
    }

    /// The tables that a target writes to.
    fn tables(&self, target: Target) -> Vec<TableId> {
        match target {
            Target::Table(t) | Target::Set(t) | Target::Singleton(t) => vec![t],
            Target::Fix(s) => {
                let t = self.symbols.get(s).table;
                [attribute::L, attribute::LO, attribute::UP]
                    .map(|o| t + o)
                    .into()
            }
            Target::Object(..)
            | Target::Seed
            | Target::Errors
            | Target::MostErrors
            | Target::Ignored => Vec::new(),
        }
    }
}

/// Whether a loop's assignment reads what it writes to so that no turn may be passed over: GAMS passes over turns
/// where no such reading is at the record that is written or at labels alone, and, of a parameter, all is under a `$`
/// whose other side drives the loop: `p(i,j) = q(k)$p(i++1,j)`, but not `q(k)*p(i++1,j)`, `q(k)$p(i,j)`, `q(k)$p('a','b')`.
struct LateReading<'c> {
    compiler: &'c mut Compiler,
    table: TableId,
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
        let rests = self.compiler.resting(n, &own);
        rests.is_some_and(|(rest, _)| rest == 0.0)
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
            NodeKind::Data(t, key) if *t == self.table => {
                let own = |p: (&Part, &Slot)| matches!(p.0, Part::Slot(s) if s == p.1);
                let same = key.parts.iter().zip(self.own).all(own);
                let fixed = key.parts.iter().all(|p| matches!(p, Part::Label(_)));
                self.early |= !self.guarded || same || fixed;
                n.walk(self);
            }
            NodeKind::Dollar(a, c) => self.sides(a, c),
            NodeKind::Aggregate(_, d, body) => {
                let outside = self.inner.len();
                self.inner.extend(&d.slots);
                let before = self.guarded;
                self.guarded |= d.members.iter().any(|m| {
                    let kind = NodeKind::Data(m.table, m.key.clone());
                    self.drives(&Node::data(kind, n.span))
                });
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

/// How an assignment reads what it writes to.
#[derive(Default)]
struct SelfReading<'a> {
    tables: Vec<TableId>,
    keys: Vec<&'a Key>,
    counted: bool,
}

impl<'a> Visitor<'a> for SelfReading<'a> {
    fn node(&mut self, n: &'a Node) {
        match &n.kind {
            NodeKind::Data(t, key) if self.tables.contains(t) => self.keys.push(key),
            NodeKind::Card(t) => self.counted |= self.tables.contains(t),
            _ => {}
        }
        n.walk(self);
    }
}

impl SelfReading<'_> {
    /// Whether the assignment goes element by element, each reading what those before have written: GAMS does
    /// where the left side has a lag, and all that is read has lags of the same indices (`p(t+1) = p(t-1)`).
    /// Else the right side sees the values from before.
    fn is_recurrence(&self, written: &Key) -> bool {
        let lagged = written.parts.iter().any(|p| matches!(p, Part::Lag(_)));
        lagged
            && !self.keys.is_empty()
            && self.keys.iter().all(|k| {
                k.parts
                    .iter()
                    .zip(&written.parts)
                    .all(|(a, b)| same_index(a, b))
            })
    }
}

/// Whether two parts are the same index, wherever lags lead.
fn same_index(a: &Part, b: &Part) -> bool {
    match (a, b) {
        (Part::Slot(a), Part::Slot(b)) => a == b,
        (Part::Label(a), Part::Label(b)) => a == b,
        (Part::Lag(a), Part::Lag(b)) => a.set == b.set && same_index(&a.base, &b.base),
        (Part::Singleton(a, p), Part::Singleton(b, q)) => (a, p) == (b, q),
        _ => false,
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

/// `a or b`
fn either(a: Node, b: Node) -> Node {
    let span = a.span;
    Node::data(
        NodeKind::Binary(BinaryOp::Or, Box::new(a), Box::new(b)),
        span,
    )
}
