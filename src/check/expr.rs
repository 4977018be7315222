//! Expressions: from names to numbers, memberships and variables.

use super::functions::{self, Callee};
use super::node::*;
use super::symbols::{Symbol, SymbolKind, UNIVERSE, attribute};
use super::{Checked, Compiler, Failed};
use crate::data::value;
use crate::diag::{Diagnostic, nearest};
use crate::model::instance::Function;
use crate::source::Span;
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Ident, UnaryOp};

/// Builds a node of children: whether variables stand in it, and whether it is linear if they do.
fn combine(kind: NodeKind, span: Span, has_var: bool, linear: bool) -> Node {
    Node {
        kind,
        span,
        has_var,
        linear: linear || !has_var,
        member: false,
    }
}

impl Compiler {
    /// The symbol of a name, or an "unknown symbol" error with the nearest name.
    pub(super) fn lookup(&mut self, id: &Ident) -> Checked<SymbolId> {
        if let Some(s) = self.named(id) {
            return if self.is_torn(s) { Err(Failed) } else { Ok(s) };
        }
        let near = nearest(&id.name, self.symbols.iter().skip(1).map(|(_, s)| &*s.name))
            .map(str::to_string);
        let d = Diagnostic::error("E0301", id.span)
            .says(format!("`{}` is not known", id.name))
            .label("unknown symbol");
        let label = self.store.universe.get(&id.name).map(|_| {
            format!(
                "`{0}` is a label of a set, not a set: quote it, `'{0}'`, or name the set",
                id.name
            )
        });
        let help = label.unwrap_or_else(|| DECLARE_FIRST.into());
        self.unknown(id, d.did_you_mean(near, help))
    }

    /// The equation that a definition is for.
    pub(super) fn lookup_equation(&mut self, id: &Ident, indices: &[Expr]) -> Checked<SymbolId> {
        if self.named(id).is_some() {
            return self.lookup(id);
        }
        // A declared equation that nothing defines is meant, if its name is like this one.
        let open = self
            .symbols
            .iter()
            .filter(|(_, s)| matches!(s.kind, SymbolKind::Equation(None)));
        let near = nearest(&id.name, open.map(|(_, s)| &*s.name)).map(str::to_string);
        let d = Diagnostic::error("E0301", id.span)
            .says(format!("the equation `{}` is not declared", id.name))
            .label("unknown equation");
        let (name, over) = (&id.name, named_indices(indices));
        let declare = format!("declare it before: `equation {name}{over};`");
        let d = d.did_you_mean(near.as_ref(), declare);
        near.iter().for_each(|n| self.lose(n));
        self.unknown(id, d)
    }

    /// A symbol by name; `file` stands for the file that `put` named last.
    pub(super) fn named(&self, id: &Ident) -> Option<SymbolId> {
        let file = || {
            let last = self.put_named;
            last.filter(|_| id.name.eq_ignore_ascii_case("file"))
        };
        self.symbols.find(&id.name).or_else(file)
    }

    /// A set by name.
    pub(super) fn lookup_set(&mut self, id: &Ident) -> Checked<SymbolId> {
        if &*id.name == "*" {
            return Ok(UNIVERSE);
        }
        let s = self.lookup(id)?;
        if self.symbols.get(s).is_set() {
            return Ok(s);
        }
        let (kind, declared) = (self.symbols.get(s).a_kind(), self.symbols.get(s).declared);
        Diagnostic::error("E0302", id.span)
            .says(format!("`{}` is {kind}; a set is expected here", id.name))
            .label("not a set")
            .other(declared, format!("declared as {kind} here"))
            .help("an index position takes a set that is under control, a quoted label, or a lag such as `t-1`")
            .fail(self)
    }

    /// An expression.
    pub(super) fn expr(&mut self, e: &Expr) -> Checked<Node> {
        let span = e.span;
        match &e.kind {
            ExprKind::Number(x) => Ok(Node::number(*x, span)),
            ExprKind::Membership(yes) => {
                let x = f64::from(u8::from(*yes));
                Ok(Node::membership(NodeKind::Const(x), span))
            }
            ExprKind::Text(t) => {
                if !self.texts_allowed {
                    return Diagnostic::error("E0312", span)
                        .says("a text may not stand in an expression")
                        .label("a number is expected")
                        .help(
                            "texts belong into `display`, `put`, `abort`, or in quotes as an index",
                        )
                        .fail(self);
                }
                Ok(Node::data(NodeKind::Text(t.clone()), span))
            }
            ExprKind::Apply(name, attribute, arguments) => {
                self.apply(name, attribute.as_ref(), arguments.as_deref(), span)
            }
            ExprKind::Unary(op, a) => {
                let a = self.expr(a)?;
                let member = a.member;
                let node = match (op, &a.kind) {
                    (UnaryOp::Plus, _) => a,
                    (UnaryOp::Minus, NodeKind::Const(x)) if !x.is_nan() => Node::number(-x, span),
                    (UnaryOp::Minus, _) => {
                        let (v, l) = (a.has_var, a.linear);
                        combine(NodeKind::Sum(vec![(true, a)]), span, v, l)
                    }
                    (UnaryOp::Not, _) => {
                        let v = a.has_var;
                        combine(NodeKind::Not(Box::new(a)), span, v, false)
                    }
                };
                Ok(Node { member, ..node })
            }
            // All of them are checked, even behind one that fails.
            ExprKind::Sum(terms) => {
                let nodes: Vec<_> = terms.iter().map(|(_, t)| self.expr(t)).collect();
                let signed = terms.iter().zip(nodes);
                let signed = signed.map(|((minus, _), n)| Ok((*minus, n?)));
                self.sum(signed.collect::<Checked<_>>()?, span)
            }
            ExprKind::Product(factors) => {
                let nodes: Vec<_> = factors.iter().map(|(_, x)| self.expr(x)).collect();
                let factors = factors
                    .iter()
                    .zip(nodes)
                    .map(|((divides, x), node)| match divides {
                        true => Ok(divisor(x, node?)),
                        false => Ok((false, node?)),
                    });
                self.product(factors.collect::<Checked<_>>()?, span)
            }
            ExprKind::Binary(BinaryOp::Divide, a, right) => {
                let (Ok(x), Ok(y)) = (self.expr(a), self.expr(right)) else {
                    return Err(Failed);
                };
                self.product(vec![(false, x), divisor(right, y)], span)
            }
            ExprKind::Binary(op, a, b) => {
                if matches!(op, BinaryOp::Eq | BinaryOp::Ne) {
                    self.labels_compared(a, b, span)?;
                }
                let (a, b) = match (self.expr(a), self.expr(b)) {
                    (Ok(a), Ok(b)) => (a, b),
                    _ => return Err(Failed),
                };
                match op {
                    BinaryOp::Add | BinaryOp::Subtract => {
                        self.sum(vec![(false, a), (*op == BinaryOp::Subtract, b)], span)
                    }
                    BinaryOp::Multiply => self.product(vec![(false, a), (false, b)], span),
                    BinaryOp::CircularPlus | BinaryOp::CircularMinus => {
                        Diagnostic::error("E0313", span)
                            .says("`++` and `--` stand between an index and a number only")
                            .label("not in an index position")
                            .help("two operators in a row need parentheses: `a - (-b)`")
                            .fail(self)
                    }
                    _ => {
                        use BinaryOp::{And, Equivalent, Implies, Or, Xor};
                        if !matches!(op, And | Or | Xor | Implies | Equivalent) {
                            self.number(&a)?;
                            self.number(&b)?;
                        }
                        let v = a.has_var || b.has_var;
                        let kind = NodeKind::Binary(*op, Box::new(a), Box::new(b));
                        Ok(combine(kind, span, v, false))
                    }
                }
            }
            ExprKind::Dollar(value, c) => {
                let c = self.expr(c)?;
                self.no_variable(&c, "a `$` condition")?;
                let a = self.expr(value)?;
                let (v, l, member) = (a.has_var, a.linear, a.member);
                let open = matches!(&value.kind, ExprKind::Dollar(first, _) if first.span.lo == value.span.lo);
                let kind = match a.kind {
                    // GAMS draws for `b` in `a$b$c` where `c` is false, too, as in `a$((b$1) and c)`.
                    NodeKind::Dollar(a, b) if open && b.has_random() => {
                        let one = Box::new(Node::number(1.0, b.span));
                        let b = Node::data(NodeKind::Dollar(b, one), span);
                        let both = NodeKind::Binary(BinaryOp::And, Box::new(b), Box::new(c));
                        NodeKind::Dollar(a, Box::new(Node::data(both, span)))
                    }
                    _ => NodeKind::Dollar(Box::new(a), Box::new(c)),
                };
                let node = combine(kind, span, v, l);
                Ok(Node { member, ..node })
            }
            ExprKind::Aggregate(op, d, body) => self.scoped(|c| {
                let domain = c.domain(d)?;
                let body = c.expr(body)?;
                let (v, l) = (body.has_var, body.linear && *op == AggregateOp::Sum);
                let member = body.member;
                // A sum of memberships is their union.
                let op = match op {
                    AggregateOp::Sum if member => AggregateOp::Sor,
                    op => *op,
                };
                let kind = NodeKind::Aggregate(op, Box::new(domain), Box::new(body));
                let node = combine(kind, span, v, l);
                Ok(Node { member, ..node })
            }),
        }
    }

    /// `t = '2023'`, `i = j`: an index is no number.
    fn labels_compared(&mut self, a: &Expr, b: &Expr, span: Span) -> Checked<()> {
        let set = |e: &Expr| {
            let name = &bare(e)?.name;
            self.symbols.find_set(name).map(|_| name.to_string())
        };
        let side = |e: &Expr| match &e.kind {
            ExprKind::Text(t) => Some(format!("'{t}'")),
            _ => set(e),
        };
        let (Some(left), Some(right)) = (side(a), side(b)) else {
            return Ok(());
        };
        if self.texts_allowed || set(a).is_none() && set(b).is_none() {
            return Ok(());
        }
        Diagnostic::error("E0312", span)
            .says("labels are not compared as numbers are")
            .label("no numbers")
            .help(format!("write `sameas({left},{right})`; `ord` is the position of an element, `.val` its label as a number"))
            .fail(self)
    }

    /// An error if a membership stands where a number must.
    pub(super) fn number(&mut self, n: &Node) -> Checked<()> {
        if !n.member {
            return Ok(());
        }
        let help = self.always_member(n).map_or_else(
            || "`1$(…)` makes a number of it; with another membership, `+` is union, `*` intersection, `-` difference".into(),
            |set| number_of_element(&set),
        );
        Diagnostic::error("E0375", n.span)
            .says("a membership stands where a number is expected")
            .label("in the set or not: no number")
            .help(help)
            .fail(self)
    }

    /// The set whose index stands for a membership that is always true: `t` in `p(t) = t`.
    fn always_member(&self, n: &Node) -> Option<Box<str>> {
        let NodeKind::Data(table, key) = &n.kind else {
            return None;
        };
        let running = self.scope.iter().find(|(s, parts)| {
            self.symbols.get(*s).table == *table
                && n.member
                && matches!((parts.as_slice(), key.parts.as_slice()), ([Part::Slot(a)], [Part::Slot(b)]) if a == b)
        });
        running.map(|(s, _)| self.symbols.get(*s).name.clone())
    }

    /// A warning where an index stands for a number: it is 1 for every element.
    pub(super) fn index_as_number(&mut self, n: &Node) {
        if let Some(set) = self.always_member(n) {
            let message = format!("`{set}` is no number here: it is 1 for every element");
            Diagnostic::warning("E0378", n.span)
                .says(message)
                .label("always 1")
                .help(number_of_element(&set))
                .report(self);
        }
    }

    /// Terms added up. Of memberships, `+` is the union and `-` the difference.
    fn sum(&mut self, terms: Vec<(bool, Node)>, span: Span) -> Checked<Node> {
        if !terms.iter().all(|(_, n)| n.member) {
            for (_, n) in &terms {
                self.number(n)?;
            }
            let v = terms.iter().any(|(_, n)| n.has_var);
            let l = terms.iter().all(|(_, n)| n.linear);
            return Ok(combine(NodeKind::Sum(terms), span, v, l));
        }
        let terms = terms.into_iter().map(|(minus, n)| match minus {
            true => (
                BinaryOp::And,
                Node::membership(NodeKind::Not(Box::new(n)), span),
            ),
            false => (BinaryOp::Or, n),
        });
        let all = terms.reduce(|(_, a), (op, n)| {
            let both = NodeKind::Binary(op, Box::new(a), Box::new(n));
            (op, Node::membership(both, span))
        });
        Ok(all.map_or_else(|| Node::number(0.0, span), |(_, n)| n))
    }

    /// Factors multiplied. Of memberships, it is the intersection.
    fn product(&mut self, factors: Vec<(bool, Node)>, span: Span) -> Checked<Node> {
        let divides = factors
            .iter()
            .any(|(divide, n)| *divide || n.kind.reciprocal_of().is_some());
        if divides {
            for (_, n) in factors.iter().filter(|(divide, _)| !divide) {
                self.number(n)?;
            }
        }
        let member = factors.iter().all(|(_, n)| n.member);
        if !member {
            factors.iter().for_each(|(_, n)| self.index_as_number(n));
        }
        let v = factors.iter().filter(|(_, n)| n.has_var).count();
        let linear = |(divide, n): &(bool, Node)| n.linear && !(*divide && n.has_var);
        let l = v <= 1 && factors.iter().all(linear);
        let node = combine(NodeKind::Product(factors), span, v > 0, l);
        Ok(Node { member, ..node })
    }

    /// A name with attribute and arguments: symbol or function.
    fn apply(
        &mut self,
        name: &Ident,
        attr: Option<&Ident>,
        arguments: Option<&[Expr]>,
        span: Span,
    ) -> Checked<Node> {
        let Some(s) = self.named(name) else {
            // `system.gamsRelease` is the function of that name.
            return match attr {
                Some(a) if name.name.eq_ignore_ascii_case("system") => {
                    self.function(a, None, arguments, span)
                }
                _ => self.function(name, attr, arguments, span),
            };
        };
        if self.is_torn(s) {
            return Err(Failed);
        }
        let symbol = self.symbols.get(s).clone();
        let indices = arguments.unwrap_or(&[]);
        if self.texts_allowed
            && let Some(a) = attr
        {
            if a.name.eq_ignore_ascii_case("ts") {
                return Ok(Node::data(NodeKind::SymbolText(s), span));
            }
            if a.name.eq_ignore_ascii_case("tn") {
                let key = self.key(s, indices, span)?;
                return Ok(Node::data(NodeKind::RecordName(s, key), span));
            }
        }
        match &symbol.kind {
            SymbolKind::Set { .. } | SymbolKind::Alias(_) => {
                if let Some(attr) = attr {
                    return self.set_attribute(s, name, attr, indices, span);
                }
                self.used(s, span);
                let key = match arguments {
                    None => Key {
                        parts: self.set_index(s, name)?,
                    },
                    Some(_) => self.key(s, indices, span)?,
                };
                Ok(Node::membership(NodeKind::Data(symbol.table, key), span))
            }
            SymbolKind::Parameter { .. } => {
                if let Some(attr) = attr {
                    let (name, kind) = (&symbol.name, symbol.a_kind());
                    return Diagnostic::error("E0314", attr.span)
                        .says(format!("a parameter has no attribute `.{}`", attr.name))
                        .help(format!("a parameter is its values: write `{name}`"))
                        .label("not there")
                        .other(symbol.declared, format!("`{name}` is {kind}"))
                        .fail(self);
                }
                let key = self.key(s, indices, span)?;
                self.used(s, span);
                Ok(Node::data(NodeKind::Data(symbol.table, key), span))
            }
            SymbolKind::Variable(_) | SymbolKind::Equation(_) => {
                let is_variable = matches!(symbol.kind, SymbolKind::Variable(_));
                let kind = symbol.a_kind();
                match attr {
                    Some(a) => self.record_attribute(s, a, indices, span),
                    None if is_variable && self.in_equation => {
                        let key = self.key(s, indices, span)?;
                        Ok(combine(NodeKind::Var(s, key), span, true, true))
                    }
                    None if is_variable && self.modes.at(span).dot_l => {
                        let key = self.key(s, indices, span)?;
                        let level = NodeKind::Data(symbol.table + attribute::L, key);
                        Ok(Node::data(level, span))
                    }
                    None => Diagnostic::error("E0310", name.span)
                        .says(format!(
                            "`{}` is {kind}; outside equations it needs an attribute",
                            symbol.name
                        ))
                        .label("which of its numbers?")
                        .other(symbol.declared, "declared here")
                        .help(format!(
                            "its level is `{0}.l`, its marginal `{0}.m`",
                            name.name
                        ))
                        .fail(self),
                }
            }
            SymbolKind::Model(_) | SymbolKind::File(_) => {
                let Some(a) = attr else {
                    return Diagnostic::error("E0315", name.span)
                        .says(format!("{} is not a number", symbol.a_kind()))
                        .label("an attribute is expected")
                        .other(symbol.declared, "declared here")
                        .help(format!("for instance `{}.modelstat`", name.name))
                        .fail(self);
                };
                let attribute = self.object_attribute(s, a)?;
                Ok(Node::data(NodeKind::ObjectAttribute(s, attribute), span))
            }
            SymbolKind::Acronym(n) => Ok(Node::number(value::acronym(*n), span)),
            SymbolKind::Figure(_) => Diagnostic::error("E0315", name.span)
                .says("a figure is not a number")
                .other(symbol.declared, "declared here")
                .fail(self),
        }
    }

    /// `x.l(i)` of a variable or equation.
    fn record_attribute(
        &mut self,
        s: SymbolId,
        a: &Ident,
        indices: &[Expr],
        span: Span,
    ) -> Checked<Node> {
        let symbol = self.symbols.get(s).clone();
        let Some(which) = functions::record_attribute(&a.name) else {
            let known = "l, m, lo, up, fx, scale, prior, slack, range";
            return self.unknown_attribute(a, &symbol.name, symbol.kind_name(), known);
        };
        self.suits(&symbol, a)?;
        let key = self.key(s, indices, span)?;
        self.used(s, span);
        match which {
            functions::RecordAttribute::Stored(offset) => {
                Ok(Node::data(NodeKind::Data(symbol.table + offset, key), span))
            }
            functions::RecordAttribute::Derived(d) => {
                Ok(Node::data(NodeKind::Derived(d, s, key), span))
            }
            functions::RecordAttribute::Fix => Diagnostic::error("E0314", a.span)
                .says("`.fx` can be assigned, not read")
                .label("write only")
                .help("read `.l`, or `.lo` and `.up`")
                .fail(self),
        }
    }

    /// Priorities are for discrete variables, scales for the others.
    pub(super) fn suits(&mut self, symbol: &Symbol, a: &Ident) -> Checked<()> {
        let SymbolKind::Variable(kind) = symbol.kind else {
            return Ok(());
        };
        let message = match (a.name.to_lowercase().as_str(), kind.is_discrete()) {
            ("prior", false) => "only discrete variables have a priority",
            ("scale", true) => "a discrete variable is not scaled",
            _ => return Ok(()),
        };
        Diagnostic::error("E0314", a.span)
            .says(message)
            .label(format!("`{}` is {}", symbol.name, symbol.a_kind()))
            .other(symbol.declared, "declared here")
            .fail(self)
    }

    pub(super) fn unknown_attribute<T>(
        &mut self,
        a: &Ident,
        name: &str,
        kind: &str,
        known: &str,
    ) -> Checked<T> {
        let meant = functions::meant_attribute(&a.name, kind);
        let near = meant.or_else(|| nearest(&a.name, known.split(", ")));
        let near = near.map(|n| format!(".{n}"));
        let known = match known.match_indices(", ").nth(11) {
            Some((at, _)) => format!("{}, …", &known[..at]),
            None => known.to_string(),
        };
        let d = Diagnostic::error("E0314", a.span)
            .says(format!(
                "the {kind} `{name}` has no attribute `.{}`",
                a.name
            ))
            .label("not an attribute");
        match a.name.to_lowercase().as_str() {
            "type" | "kind" | "binary" | "integer" | "positive" | "free" | "bin"
                if kind == "variable" =>
            {
                d.help(format!(
                    "the kind stands in the declaration: `binary variable {name};`"
                ))
            }
            _ => d.did_you_mean(near, format!("there are: {known}")),
        }
        .fail(self)
    }

    pub(super) fn object_attribute(&mut self, s: SymbolId, a: &Ident) -> Checked<&'static str> {
        let symbol = self.symbols.get(s).clone();
        let known = match symbol.kind {
            SymbolKind::Model(_) => functions::MODEL_ATTRIBUTES,
            _ => functions::FILE_ATTRIBUTES,
        };
        match known.iter().find(|k| k.eq_ignore_ascii_case(&a.name)) {
            Some(k) => Ok(k),
            None => self.unknown_attribute(a, &symbol.name, symbol.kind_name(), &known.join(", ")),
        }
    }

    /// `i.val`, `i.tl`, `i.te(i)`, `i.ts`.
    fn set_attribute(
        &mut self,
        s: SymbolId,
        name: &Ident,
        attr: &Ident,
        indices: &[Expr],
        span: Span,
    ) -> Checked<Node> {
        let symbol = self.symbols.get(s).clone();
        let lower = attr.name.to_lowercase();
        match lower.as_str() {
            "te" if self.texts_allowed && !indices.is_empty() => {
                let key = self.key(s, indices, span)?;
                return Ok(Node::data(NodeKind::ElementText(symbol.table, key), span));
            }
            "te" | "tl" if self.texts_allowed => {
                let parts = self.set_index(s, name)?;
                let kind = match parts.as_slice() {
                    [one] if lower == "tl" => NodeKind::LabelText(one.clone()),
                    _ => NodeKind::ElementText(symbol.table, Key { parts }),
                };
                return Ok(Node::data(kind, span));
            }
            _ => {}
        }
        let Some(which) = LabelAttribute::named(&lower) else {
            let known = "val, pos, ord, off, rev, uel, len, tlen, first, last";
            return self.unknown_attribute(attr, &symbol.name, "set", known);
        };
        self.used(s, span);
        if which == LabelAttribute::Ord {
            self.ordered(s, span, "`.ord`")?;
        }
        let mut parts = if indices.is_empty() {
            if !matches!(which, LabelAttribute::TextLen | LabelAttribute::TextVal) {
                self.runs(s, span, &format!("`.{lower}`"))?;
            }
            self.set_index(s, name)?
        } else {
            self.key(s, indices, span)?.parts
        };
        if parts.len() != 1 {
            let (name, n) = (&symbol.name, parts.len());
            return Diagnostic::error("E0304", span)
                .says(format!(
                    "`.{lower}` is of sets with one index; `{name}` has {n}"
                ))
                .label(format!("{n} indices here"))
                .other(symbol.declared, "declared here")
                .help(format!("ask one of its indices: `i.{lower}`"))
                .fail(self);
        }
        let kind = NodeKind::LabelAttribute(which, symbol.table, parts.remove(0));
        Ok(Node::data(kind, span))
    }

    /// A function call.
    fn function(
        &mut self,
        name: &Ident,
        attr: Option<&Ident>,
        arguments: Option<&[Expr]>,
        span: Span,
    ) -> Checked<Node> {
        let lower = name.name.to_lowercase();
        let args = arguments.unwrap_or(&[]);
        let known = self.library.get(&lower).copied();
        let known = known.or_else(|| functions::callee(&lower));
        let Some((callee, low, high)) = known.filter(|_| attr.is_none()) else {
            return self.unknown_name(name, arguments);
        };
        if args.len() < low || args.len() > high {
            let count = |n: usize| format!("{n} argument{}", if n == 1 { "" } else { "s" });
            let wanted = match (low, high) {
                (l, h) if l == h => count(l),
                (l, usize::MAX) => format!("{l} or more arguments"),
                (l, h) => format!("{l} to {}", count(h)),
            };
            return Diagnostic::error("E0316", span)
                .says(format!("`{lower}` takes {wanted}, not {}", args.len()))
                .label("wrong number of arguments")
                .help(self.arguments_help(callee, &lower, low, args))
                .fail(self);
        }
        match callee {
            Callee::Ord | Callee::Card => self.ord_or_card(callee == Callee::Card, args, span),
            Callee::SameAs => self.same_as(lower == "sameas", args, span),
            Callee::Math(f) => {
                let mut nodes = Vec::with_capacity(args.len());
                for (n, a) in args.iter().enumerate() {
                    let node = self.expr(a)?;
                    if f != Function::IfThen || n > 0 {
                        self.number(&node)?;
                    }
                    nodes.push(node);
                }
                let v = nodes.iter().any(|n| n.has_var);
                if v && functions::first_argument_must_be_data(f) && nodes[0].has_var {
                    let message = "may not depend on a variable";
                    return Diagnostic::error("E0318", nodes[0].span)
                        .says(format!("the first argument of `{lower}` {message}"))
                        .fail(self);
                }
                Ok(combine(NodeKind::Call(f, nodes), span, v, false))
            }
            Callee::NormalCurve { density } => self.normal_curve(density, args, span),
            // Its argument is a symbol without its indices.
            Callee::Data(DataFunction::ReadyCollect) => Ok(Node::number(0.0, span)),
            Callee::Data(f) => {
                let mut nodes = Vec::with_capacity(args.len());
                for a in args {
                    let n = self.expr(a)?;
                    if n.has_var {
                        return Diagnostic::error("E0318", n.span)
                            .says(format!("`{lower}` may not depend on a variable"))
                            .label("a variable stands in it")
                            .fail(self);
                    }
                    nodes.push(n);
                }
                Ok(Node::data(NodeKind::DataCall(f, nodes), span))
            }
        }
    }

    /// The normal distribution at `x, mean, deviation`: Φ(z), or its density exp(−z²/2)/(√2π·deviation).
    fn normal_curve(&mut self, density: bool, args: &[Expr], span: Span) -> Checked<Node> {
        let binary = |op, a, b| Expr {
            kind: ExprKind::Binary(op, Box::new(a), Box::new(b)),
            span,
        };
        let less = binary(BinaryOp::Subtract, args[0].clone(), args[1].clone());
        let z = self.expr(&binary(BinaryOp::Divide, less, args[2].clone()))?;
        let call = |f, of: Node| {
            let v = of.has_var;
            combine(NodeKind::Call(f, vec![of]), span, v, false)
        };
        if !density {
            return Ok(call(Function::ErrorF, z));
        }
        let divisor = |x| (true, Node::number(x, span));
        let half = vec![(false, call(Function::Sqr, z)), divisor(-2.0)];
        let bell = call(Function::Exp, self.product(half, span)?);
        let scale = divisor((2.0 * std::f64::consts::PI).sqrt());
        let deviation = (true, self.expr(&args[2])?);
        self.product(vec![(false, bell), scale, deviation], span)
    }

    /// `ord(i)`, `card(s)`, and both of a text.
    fn ord_or_card(&mut self, card: bool, args: &[Expr], span: Span) -> Checked<Node> {
        let name = if card { "card" } else { "ord" };
        if let Some(text) = self.text_argument(&args[0])? {
            let at = match (card, args.get(1)) {
                (true, _) => None,
                (_, Some(n)) => Some(Box::new(self.expr(n)?)),
                _ => Some(Box::new(Node::number(1.0, span))),
            };
            return Ok(Node::data(NodeKind::OfText(Box::new(text), at), span));
        }
        if let Some(second) = args.get(1) {
            return Diagnostic::error("E0316", second.span)
                .says("`ord` of a set takes 1 argument")
                .label("only `ord('text', n)` has a position")
                .fail(self);
        }
        let ExprKind::Apply(n, None, None) = &args[0].kind else {
            return Diagnostic::error("E0317", args[0].span)
                .says(format!("`{name}` takes the name of a set"))
                .label("not a name")
                .help(format!("for instance `{name}(i)`"))
                .fail(self);
        };
        let s = self.lookup(n)?;
        if card {
            self.used(s, n.span);
            let symbol = self.symbols.get(s);
            use SymbolKind::{Acronym, Figure, File, Model};
            if matches!(symbol.kind, Model(_) | File(_) | Acronym(_) | Figure(_)) {
                return self.lookup_set(n).and(Err(Failed));
            }
            return Ok(Node::data(NodeKind::Card(symbol.table), span));
        }
        self.lookup_set(n)?;
        self.used(s, n.span);
        self.runs(s, n.span, "`ord`")?;
        self.ordered(s, n.span, "`ord`")?;
        let mut parts = self.set_index(s, n)?;
        if parts.len() != 1 {
            return self.wrong_dimension(s, n.span, 1);
        }
        let kind = NodeKind::Ord(self.symbols.get(s).table, parts.remove(0));
        Ok(Node::data(kind, span))
    }

    /// `sameas`, and `diag`, which is the same as a number.
    fn same_as(&mut self, member: bool, args: &[Expr], span: Span) -> Checked<Node> {
        let mut parts = Vec::new();
        for a in args {
            parts.extend(match &a.kind {
                ExprKind::Text(t) => vec![Part::Label(self.known_label(t, a.span)?)],
                _ => self.index(a, UNIVERSE, 0)?,
            });
        }
        if parts.len() != 2 {
            return Diagnostic::error("E0317", span)
                .says("`sameas` compares two single indices")
                .fail(self);
        }
        let b = parts.remove(1);
        let kind = NodeKind::SameAs(parts.remove(0), b);
        let node = Node::data(kind, span);
        Ok(Node { member, ..node })
    }

    /// A text where `card` and `ord` may have one: `'abc'`, `i.tl`, `i.te(i)`, `p.ts`.
    fn text_argument(&mut self, e: &Expr) -> Checked<Option<Node>> {
        let is_text = match &e.kind {
            ExprKind::Text(_) => true,
            ExprKind::Apply(_, Some(a), _) => {
                matches!(a.name.to_lowercase().as_str(), "tl" | "te" | "ts" | "tn")
            }
            _ => false,
        };
        if !is_text {
            return Ok(None);
        }
        let allowed = std::mem::replace(&mut self.texts_allowed, true);
        let text = self.expr(e);
        self.texts_allowed = allowed;
        text.map(Some)
    }

    /// What a function is given, for one with too few or too many arguments.
    fn arguments_help(&self, callee: Callee, lower: &str, low: usize, args: &[Expr]) -> String {
        // `max(p)`: over which sets `p` runs.
        let over = args.first().and_then(|e| {
            let ExprKind::Apply(n, _, _) = &e.kind else {
                return None;
            };
            let s = self.symbols.get(self.symbols.find(&n.name)?);
            let sets = self.symbols.domain_names(s).join(",");
            let index = match s.dim() {
                0 => return None,
                1 => sets.clone(),
                _ => format!("({sets})"),
            };
            (!s.is_set()).then(|| format!("{index}, {}({sets})", n.name))
        });
        match (callee, over) {
            (Callee::Math(Function::Min | Function::Max), Some(over)) => {
                format!("over the elements of a set, write `s{lower}({over})`")
            }
            (Callee::Ord | Callee::Card, _) => {
                format!("write `{lower}(i)` with the name of a set")
            }
            _ => {
                let some = ["x", "y", "z"][..low.min(3)].join(", ");
                format!("write `{lower}({some})`")
            }
        }
    }

    fn unknown_name<T>(&mut self, name: &Ident, arguments: Option<&[Expr]>) -> Checked<T> {
        let instead = match name.name.to_lowercase().as_str() {
            "asin" => Some("arcsin"),
            "acos" => Some("arccos"),
            "atan" => Some("arctan"),
            "atan2" => Some("arctan2"),
            "ln" => Some("log"),
            "pow" => Some("power"),
            "erf" => Some("errorf"),
            "maximum" => Some("max"),
            "minimum" => Some("min"),
            "int" => Some("trunc"),
            "size" | "length" | "len" | "count" | "cardinality" => Some("card"),
            "true" => Some("yes"),
            "false" => Some("no"),
            "none" | "null" | "nan" => Some("na"),
            "infinity" => Some("inf"),
            "if" | "iif" => Some("ifThen"),
            "average" | "mean" => Some("sum(i, p(i))/card(i)"),
            "sumproduct" | "dot" => Some("sum(i, p(i)*q(i))"),
            "pos" | "index" => Some("ord"),
            "last" | "end" => Some("card(t)"),
            "rand" | "random" | "rnd" => Some("uniform(0,1)"),
            "randn" => Some("normal(0,1)"),
            "square" => Some("sqr"),
            "sgn" => Some("sign"),
            "fabs" => Some("abs"),
            "roundup" => Some("ceil"),
            "rounddown" => Some("floor"),
            _ => None,
        };
        let indexed = name.name.rsplit_once('_').filter(|(symbol, set)| {
            let set = self.symbols.find(set).map(|s| self.symbols.get(s));
            set.is_some_and(Symbol::is_set) && self.symbols.find(symbol).is_some()
        });
        let indexed = indexed.map(|(symbol, set)| format!("{symbol}({set})"));
        let near = instead.map(str::to_string).or(indexed).or_else(|| {
            let mut known: Vec<&str> = self.symbols.iter().skip(1).map(|(_, s)| &*s.name).collect();
            // A function is meant only where numbers are its arguments.
            let index =
                |e: &Expr| bare(e).is_some_and(|n| self.symbols.find_set(&n.name).is_some());
            if arguments.is_some_and(|list| !list.iter().any(index)) {
                for n in functions::names() {
                    known.push(n);
                }
            }
            nearest(&name.name, known).map(str::to_string)
        });
        let what = match arguments {
            Some(_) => "symbol or function",
            None => "symbol",
        };
        let mut d = Diagnostic::error("E0301", name.span)
            .says(format!("`{}` is not known", name.name))
            .label(format!("unknown {what}"));
        d = match near {
            Some(n) if n == "ifThen" => d.help(
                "write `ifThen(c, a, b)`; a condition on data stands behind `$`: `x(i)$(c(i) > 1)`",
            ),
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None if self.store.universe.get(&name.name).is_some() => {
                d.help(format!("`{0}` is a label: quote it, `'{0}'`", name.name))
            }
            None => d.help(DECLARE_FIRST),
        };
        self.unknown(name, d)
    }
}

/// How a number is made of an element.
fn number_of_element(set: &str) -> String {
    format!("`ord({set})` is the position of the element, `{set}.val` its label as a number")
}

/// A name and nothing else.
fn bare(e: &Expr) -> Option<&Ident> {
    match &e.kind {
        ExprKind::Apply(name, None, None) => Some(name),
        _ => None,
    }
}

/// `(i,j)`, if that is what stands there.
fn named_indices(indices: &[Expr]) -> String {
    let name = |e: &Expr| bare(e).map(|n| n.name.to_string());
    match indices.iter().map(name).collect::<Option<Vec<_>>>() {
        Some(names) if !names.is_empty() => format!("({})", names.join(",")),
        _ => String::new(),
    }
}

const DECLARE_FIRST: &str =
    "declare it first: names must be declared above the place where they are used";

/// A factor that divides. GAMS divides by a number or a scalar parameter `b` as it multiplies by `1/b`,
/// which shows in the last digit: such a factor multiplies, and is a product of one divisor.
fn divisor(written: &Expr, node: Node) -> (bool, Node) {
    let once = match (&written.kind, &node.kind) {
        (ExprKind::Number(_), NodeKind::Const(_)) => true,
        (ExprKind::Apply(_, None, _), NodeKind::Data(_, key)) => key.parts.is_empty(),
        _ => false,
    };
    if !once {
        return (true, node);
    }
    let span = node.span;
    let once = NodeKind::Product(vec![(true, node)]);
    (false, Node::data(once, span))
}
