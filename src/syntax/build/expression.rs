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

fn infix(text: &str) -> BinaryOp {
    use BinaryOp as B;
    match text {
        "+" => B::Add,
        "-" => B::Subtract,
        "*" => B::Multiply,
        "/" => B::Divide,
        "**" => B::Power,
        "++" => B::CircularPlus,
        "--" => B::CircularMinus,
        "=" => B::Eq,
        "<>" => B::Ne,
        "<" => B::Lt,
        "<=" => B::Le,
        ">" => B::Gt,
        ">=" => B::Ge,
        "->" => B::Implies,
        "<=>" => B::Equivalent,
        word => match word.to_ascii_lowercase().as_str() {
            "and" => B::And,
            "or" => B::Or,
            "xor" => B::Xor,
            "imp" => B::Implies,
            "eqv" => B::Equivalent,
            "eq" => B::Eq,
            "ne" => B::Ne,
            "lt" => B::Lt,
            "le" => B::Le,
            "gt" => B::Gt,
            _ => B::Ge,
        },
    }
}

/// An expression on the way, with its depth.
struct Node {
    expr: Expr,
    depth: usize,
    /// Stands without parentheses: a chain may grow.
    open: bool,
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
            Op::Prefix(p) => Node {
                depth: right.depth + 1,
                expr: Expr {
                    span: at.to(right.expr.span),
                    kind: ExprKind::Unary(p, Box::new(right.expr)),
                },
                open: true,
            },
            Op::Infix(b) => {
                let Some(left) = self.nodes.pop() else {
                    return Ok(());
                };
                join(left, b, right)
            }
        };
        if node.depth > DEEPEST {
            return Err(Box::new(too_deep(at)));
        }
        self.nodes.push(node);
        Ok(())
    }
}

fn too_deep(at: Span) -> Diagnostic {
    Diagnostic::error("E0204", at)
        .says(format!(
            "this expression is nested more than {DEEPEST} levels deep"
        ))
        .help("give its parts names of their own; long sums and products are no problem")
}

fn join(left: Node, op: BinaryOp, right: Node) -> Node {
    use BinaryOp as B;
    let span = left.expr.span.to(right.expr.span);
    let depth = left.depth.max(right.depth + 1);
    let grown = |kind| Node {
        expr: Expr { kind, span },
        depth,
        open: true,
    };
    let sign = match op {
        B::Add => Some(Sign::Plus),
        B::Subtract => Some(Sign::Minus),
        _ => None,
    };
    if let Some(sign) = sign {
        return match left.expr.kind {
            ExprKind::Sum(mut terms) if left.open => {
                terms.push((sign, right.expr));
                grown(ExprKind::Sum(terms))
            }
            kind => {
                let first = Expr {
                    kind,
                    span: left.expr.span,
                };
                Node {
                    expr: Expr {
                        kind: ExprKind::Sum(vec![(Sign::Plus, first), (sign, right.expr)]),
                        span,
                    },
                    depth: left.depth.max(right.depth) + 1,
                    open: true,
                }
            }
        };
    }
    let factor = |op| match op {
        B::Multiply => Some(Factor::Multiply),
        B::Divide => Some(Factor::Divide),
        _ => None,
    };
    let mut left = left;
    if let (Some(second), true) = (factor(op), left.open) {
        match left.expr.kind {
            ExprKind::Product(mut factors) => {
                factors.push((second, right.expr));
                return grown(ExprKind::Product(factors));
            }
            ExprKind::Binary(first, a, b) if factor(first).is_some() => {
                let first = factor(first).unwrap_or(Factor::Multiply);
                return grown(ExprKind::Product(vec![
                    (Factor::Multiply, *a),
                    (first, *b),
                    (second, right.expr),
                ]));
            }
            kind => left.expr.kind = kind,
        }
    }
    Node {
        depth: left.depth.max(right.depth) + 1,
        expr: Expr {
            kind: ExprKind::Binary(op, Box::new(left.expr), Box::new(right.expr)),
            span,
        },
        open: true,
    }
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
                    let op = infix(pair.as_str());
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
                            if depth > DEEPEST {
                                return Err(Box::new(too_deep(node.expr.span)));
                            }
                            let span = value.expr.span.to(node.expr.span);
                            let kind = ExprKind::Dollar(Box::new(value.expr), Box::new(node.expr));
                            s.nodes.push(Node {
                                expr: Expr { kind, span },
                                depth,
                                open: false,
                            });
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
        let leaf = |kind| Node {
            expr: Expr { kind, span },
            depth: 1,
            open: false,
        };
        match pair.as_rule() {
            Rule::number | Rule::signed => Ok(leaf(ExprKind::Number(number(pair.as_str())))),
            Rule::quoted => Ok(leaf(ExprKind::Text(Self::unquote(&pair)))),
            Rule::group => {
                let inner = need(&mut pair.into_inner(), span, "an expression")?;
                let mut node = self.chain(inner)?;
                node.expr.span = span;
                node.depth += 1;
                node.open = false;
                self.not_too_deep(node)
            }
            Rule::aggregate => self.aggregate(pair),
            Rule::expression => self.chain(pair),
            _ => self.apply(pair),
        }
    }

    fn not_too_deep(&self, node: Node) -> Outcome<Node> {
        if node.depth > DEEPEST {
            return Err(Box::new(too_deep(node.expr.span)));
        }
        Ok(node)
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
                Rule::attribute => attribute = p.into_inner().next().map(|n| self.ident(&n)),
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
            return Ok(Node {
                expr: Expr { kind, span },
                depth: 1,
                open: false,
            });
        }
        self.not_too_deep(Node {
            expr: Expr {
                kind: ExprKind::Apply(name, attribute, arguments),
                span,
            },
            depth: depth + 1,
            open: false,
        })
    }

    fn aggregate(&self, pair: Pair<'_, Rule>) -> Outcome<Node> {
        let span = self.span(&pair);
        let (mut op, mut domain, mut body) = (AggregateOp::Sum, None, None);
        for p in pair.into_inner() {
            match p.as_rule() {
                Rule::aggregate_op => {
                    op = match p.as_str().to_ascii_lowercase().as_str() {
                        "prod" => AggregateOp::Prod,
                        "smin" => AggregateOp::Smin,
                        "smax" => AggregateOp::Smax,
                        "sand" => AggregateOp::Sand,
                        "sor" => AggregateOp::Sor,
                        _ => AggregateOp::Sum,
                    }
                }
                Rule::domain => domain = Some(self.domain(p)?),
                _ => body = Some(self.chain(p)?),
            }
        }
        match (domain, body) {
            (Some(domain), Some(body)) => self.not_too_deep(Node {
                depth: body.depth + 1,
                expr: Expr {
                    kind: ExprKind::Aggregate(op, Box::new(domain), Box::new(body.expr)),
                    span,
                },
                open: false,
            }),
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
