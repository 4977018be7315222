//! Expressions: precedence is applied here, to the flat list of operands and operators that the
//! grammar gives, without recursion over the length of a chain.

use pest::iterators::Pair;

use super::{Builder, DEEPEST, Outcome, expected, need};
use crate::data::value;
use crate::diag::Diagnostic;
use crate::source::Span;
use crate::syntax::ast::*;
use crate::syntax::data::{LARGE, TINY};
use crate::syntax::grammar::Rule;

/// An operator on the stack.
#[derive(Clone, Copy)]
enum Op {
    Prefix(UnaryOp),
    Infix(BinaryOp),
}

/// How tightly an operator binds.
fn level(op: Op) -> u8 {
    use BinaryOp as B;
    match op {
        Op::Infix(B::Implies | B::Equivalent) => 1,
        Op::Infix(B::Or | B::Xor) => 2,
        Op::Infix(B::And) => 3,
        Op::Prefix(UnaryOp::Not) => 4,
        Op::Infix(B::Eq | B::Ne | B::Lt | B::Le | B::Gt | B::Ge) => RELATION,
        Op::Infix(B::Add | B::Subtract | B::CircularPlus | B::CircularMinus) => 6,
        Op::Infix(B::Multiply | B::Divide) => 7,
        Op::Prefix(_) => 8,
        Op::Infix(B::Power) => 9,
    }
}

const RELATION: u8 = 5;

/// An expression on the way, with its depth.
struct Node {
    expr: Expr,
    depth: usize,
    /// Stands without parentheses: a chain may grow.
    open: bool,
}

impl Node {
    fn new(kind: ExprKind, span: Span, depth: usize, open: bool) -> Self {
        let expr = Expr { kind, span };
        Self { expr, depth, open }
    }

    /// An error at a place if it is nested too deeply.
    fn not_too_deep(self, at: Span) -> Outcome<Self> {
        if self.depth > DEEPEST {
            return Diagnostic::error("E0204", at)
                .says(format!(
                    "this expression is nested more than {DEEPEST} levels deep"
                ))
                .help("give its parts names of their own; long sums and products are no problem")
                .refuse();
        }
        Ok(self)
    }
}

/// Expressions being put together.
#[derive(Default)]
struct Stack {
    nodes: Vec<Node>,
    ops: Vec<(Op, Span)>,
}

impl Stack {
    /// Applies the operator on top.
    fn reduce(&mut self) -> Outcome<()> {
        let Some((op, at)) = self.ops.pop() else {
            return Ok(());
        };
        let Some(right) = self.nodes.pop() else {
            return Ok(());
        };
        let node = match op {
            Op::Prefix(p) => {
                let span = at.to(right.expr.span);
                let kind = ExprKind::Unary(p, Box::new(right.expr));
                Node::new(kind, span, right.depth + 1, true)
            }
            Op::Infix(b) => {
                let Some(left) = self.nodes.pop() else {
                    return Ok(());
                };
                join(left, b, right)
            }
        };
        self.nodes.push(node.not_too_deep(at)?);
        Ok(())
    }
}

fn join(left: Node, op: BinaryOp, right: Node) -> Node {
    use BinaryOp as B;
    let first = left.expr.span;
    let span = first.to(right.expr.span);
    // Of a chain that grows, and of a new operation.
    let grown = left.depth.max(right.depth + 1);
    let deeper = left.depth.max(right.depth) + 1;
    let one_of = |op, plain, inverse| [plain, inverse].iter().position(|o| *o == op);
    let sign = one_of(op, B::Add, B::Subtract).map(|n| n == 1);
    let factor = |op| one_of(op, B::Multiply, B::Divide).map(|n| n == 1);
    let (kind, depth) = match (left.expr.kind, sign, factor(op)) {
        (ExprKind::Sum(mut terms), Some(sign), _) if left.open => {
            terms.push((sign, right.expr));
            (ExprKind::Sum(terms), grown)
        }
        (kind, Some(sign), _) => {
            let first = (false, Expr { kind, span: first });
            (ExprKind::Sum(vec![first, (sign, right.expr)]), deeper)
        }
        (ExprKind::Product(mut factors), _, Some(second)) if left.open => {
            factors.push((second, right.expr));
            (ExprKind::Product(factors), grown)
        }
        (ExprKind::Binary(op, a, b), _, Some(second)) if left.open && factor(op).is_some() => {
            let first = factor(op) == Some(true);
            let factors = vec![(false, *a), (first, *b), (second, right.expr)];
            (ExprKind::Product(factors), grown)
        }
        (kind, ..) => {
            let left = Box::new(Expr { kind, span: first });
            (ExprKind::Binary(op, left, Box::new(right.expr)), deeper)
        }
    };
    Node::new(kind, span, depth, true)
}

impl Builder<'_> {
    /// An `expression`.
    pub(super) fn expression(&self, pair: Pair<'_, Rule>) -> Outcome<Expr> {
        Ok(self.chain(pair)?.expr)
    }

    fn chain(&self, pair: Pair<'_, Rule>) -> Outcome<Node> {
        let place = self.span(&pair);
        let mut s = Stack::default();
        // What stands before the next token.
        let mut after_prefix: Option<UnaryOp> = None;
        let mut after_infix: Option<BinaryOp> = None;
        let mut dollar = false;
        for pair in pair.into_inner() {
            match pair.as_rule() {
                Rule::prefix => {
                    let op = match pair.as_str().as_bytes()[0] {
                        b'-' => UnaryOp::Minus,
                        b'+' => UnaryOp::Plus,
                        _ => UnaryOp::Not,
                    };
                    let at = self.span(&pair);
                    let arithmetic = after_infix.is_some_and(|b| level(Op::Infix(b)) > RELATION);
                    let doubled = match after_prefix {
                        Some(UnaryOp::Not) => op == UnaryOp::Not,
                        Some(_) => true,
                        None => arithmetic,
                    };
                    if doubled {
                        return Err(Box::new(two_operators(at)));
                    }
                    s.ops.push((Op::Prefix(op), at));
                    after_prefix = Some(op);
                }
                Rule::infix => {
                    let op = BinaryOp::named(pair.as_str()).unwrap_or(BinaryOp::Ge);
                    let at = self.span(&pair);
                    let new = level(Op::Infix(op));
                    while s.ops.last().is_some_and(|(top, _)| level(*top) > new) {
                        s.reduce()?;
                    }
                    if new == RELATION
                        && s.ops.last().is_some_and(|(top, _)| level(*top) == RELATION)
                    {
                        return Diagnostic::error("E0213", at)
                            .says("relations cannot be chained")
                            .label("a second relation")
                            .help("write `a < b and b < c`, or put one comparison in parentheses")
                            .refuse();
                    }
                    while s.ops.last().is_some_and(|(top, _)| level(*top) == new) {
                        s.reduce()?;
                    }
                    s.ops.push((Op::Infix(op), at));
                    after_infix = Some(op);
                    after_prefix = None;
                }
                Rule::dollar => dollar = true,
                Rule::not_sign => return Err(Box::new(two_operators(self.span(&pair)))),
                _ => {
                    let node = self.primary(pair)?;
                    after_infix = None;
                    after_prefix = None;
                    match s.nodes.pop() {
                        Some(value) if dollar => {
                            let depth = value.depth.max(node.depth) + 1;
                            let (span, at) = (value.expr.span.to(node.expr.span), node.expr.span);
                            let kind = ExprKind::Dollar(Box::new(value.expr), Box::new(node.expr));
                            let node = Node::new(kind, span, depth, false);
                            s.nodes.push(node.not_too_deep(at)?);
                        }
                        before => {
                            s.nodes.extend(before);
                            s.nodes.push(node);
                        }
                    }
                    dollar = false;
                }
            }
        }
        while !s.ops.is_empty() {
            s.reduce()?;
        }
        let node = s.nodes.pop();
        node.ok_or_else(|| expected(place, "an expression"))
    }

    /// One operand.
    fn primary(&self, pair: Pair<'_, Rule>) -> Outcome<Node> {
        let span = self.span(&pair);
        let leaf = |kind| Node::new(kind, span, 1, false);
        match pair.as_rule() {
            Rule::number | Rule::signed => Ok(leaf(ExprKind::Number(number(pair.as_str())))),
            Rule::quoted => Ok(leaf(ExprKind::Text(Self::unquote(&pair)))),
            Rule::group => {
                let inner = need(&mut pair.into_inner(), span, "an expression")?;
                let node = self.chain(inner)?;
                Node::new(node.expr.kind, span, node.depth + 1, false).not_too_deep(span)
            }
            Rule::aggregate => self.aggregate(pair),
            Rule::expression => self.chain(pair),
            _ => self.apply(pair),
        }
    }

    /// Any single operand as an expression (`put` items, what `$` takes).
    pub(super) fn operand(&self, pair: Pair<'_, Rule>) -> Outcome<Expr> {
        Ok(self.primary(pair)?.expr)
    }

    /// The arguments between parentheses, and their greatest depth.
    fn argument_list(&self, pair: Pair<'_, Rule>) -> Outcome<(Vec<Expr>, usize)> {
        let mut depth = 0;
        let mut list = Vec::new();
        for e in pair.into_inner() {
            let node = self.chain(e)?;
            depth = depth.max(node.depth);
            list.push(node.expr);
        }
        Ok((list, depth))
    }

    /// The arguments between parentheses.
    pub(super) fn arguments(&self, pair: Pair<'_, Rule>) -> Outcome<Vec<Expr>> {
        Ok(self.argument_list(pair)?.0)
    }

    fn apply(&self, pair: Pair<'_, Rule>) -> Outcome<Node> {
        let span = self.span(&pair);
        let mut inner = pair.into_inner();
        let name = need(&mut inner, span, "a name")?;
        let name = self.ident(&name);
        let (mut attribute, mut arguments, mut depth) = (None, None, 0);
        for p in inner {
            match p.as_rule() {
                Rule::attribute => attribute = self.first_ident(p),
                _ => {
                    let (list, d) = self.argument_list(p)?;
                    depth = d;
                    arguments = Some(list);
                }
            }
        }
        if attribute.is_none()
            && arguments.is_none()
            && let Some(kind) = ExprKind::special(&name.name, || self.modes.at(name.span).undf)
        {
            return Ok(Node::new(kind, span, 1, false));
        }
        let kind = ExprKind::Apply(name, attribute, arguments);
        Node::new(kind, span, depth + 1, false).not_too_deep(span)
    }

    fn aggregate(&self, pair: Pair<'_, Rule>) -> Outcome<Node> {
        let span = self.span(&pair);
        let (mut op, mut domain, mut body) = (AggregateOp::Sum, None, None);
        for p in pair.into_inner() {
            match p.as_rule() {
                Rule::aggregate_op => op = AggregateOp::named(p.as_str()).unwrap_or(op),
                Rule::domain => domain = Some(self.domain(p)?),
                _ => body = Some(self.chain(p)?),
            }
        }
        match (domain, body) {
            (Some(domain), Some(body)) => {
                let kind = ExprKind::Aggregate(op, Box::new(domain), Box::new(body.expr));
                Node::new(kind, span, body.depth + 1, false).not_too_deep(span)
            }
            _ => Err(expected(span, "an index and an expression")),
        }
    }

    /// What a sum or a loop runs over.
    pub(super) fn domain(&self, pair: Pair<'_, Rule>) -> Outcome<Domain> {
        let span = self.span(&pair);
        let mut items = Vec::new();
        let mut condition = None;
        for p in pair.into_inner() {
            match p.as_rule() {
                Rule::condition => condition = Some(self.condition(p)?),
                _ => items.push(self.domain_item(p)?),
            }
        }
        Ok(Domain {
            items,
            condition,
            span,
        })
    }

    pub(super) fn domain_item(&self, pair: Pair<'_, Rule>) -> Outcome<DomainItem> {
        let node = self.apply(pair)?;
        let span = node.expr.span;
        match node.expr.kind {
            ExprKind::Apply(name, attribute, arguments)
                if attribute.as_ref().is_none_or(|a| {
                    a.name.eq_ignore_ascii_case("local") && arguments.is_none()
                }) =>
            {
                Ok(DomainItem {
                    set: name,
                    local: attribute.is_some(),
                    indices: arguments,
                    span,
                })
            }
            _ => Diagnostic::error("E0214", span)
                .says("a set was expected here")
                .help("sums and loops run over sets: `sum((i,j), …)`, `sum(arc(i,j), …)`")
                .refuse(),
        }
    }

    /// `$c`
    pub(super) fn condition(&self, pair: Pair<'_, Rule>) -> Outcome<Expr> {
        let span = self.span(&pair);
        let mut operand = None;
        for p in pair.into_inner() {
            if p.as_rule() == Rule::not_sign {
                return Err(Box::new(two_operators(self.span(&p))));
            }
            operand = Some(self.operand(p)?);
        }
        operand.ok_or_else(|| expected(span, "a condition"))
    }
}

fn two_operators(at: Span) -> Diagnostic {
    Diagnostic::error("E0212", at)
        .says("two operators in a row")
        .label("this one needs parentheses")
        .help("write `a*(-b)`, `$(not c)`")
}

/// A number as written: too large is `undf`, too small is `eps`.
pub(super) fn number(text: &str) -> f64 {
    let x: f64 = fast_float2::parse(text).unwrap_or(value::UNDF);
    if x >= LARGE {
        return value::UNDF;
    }
    if x > 0.0 && x <= TINY {
        return value::EPS;
    }
    if x == 0.0
        && text
            .bytes()
            .take_while(|b| !matches!(b, b'e' | b'E'))
            .any(|b| (b'1'..=b'9').contains(&b))
    {
        return value::EPS;
    }
    x
}
