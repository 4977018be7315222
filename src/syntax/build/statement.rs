//! Assignments, equations, and the statements that do something.

use pest::iterators::Pair;

use super::expression::number;
use super::{Builder, Outcome, bare, expected, need, parts};
use crate::diag::Diagnostic;
use crate::source::Span;
use crate::syntax::ast::*;
use crate::syntax::grammar::Rule;

impl Builder<'_> {
    /// A statement that is no declaration.
    pub(super) fn action(&self, pair: Pair<'_, Rule>) -> Outcome<StmtKind> {
        let at = self.span(&pair);
        match pair.as_rule() {
            Rule::algebra => self.algebra(pair),
            Rule::loop_statement => {
                let mut inner = parts(pair);
                let domain = self.domain(need(&mut inner, at, "an index")?)?;
                let body = self.body(need(&mut inner, at, "a statement")?)?;
                Ok(StmtKind::Loop(domain, body))
            }
            Rule::while_statement => {
                let mut inner = parts(pair);
                let condition = self.expression(need(&mut inner, at, "a condition")?)?;
                let body = self.body(need(&mut inner, at, "a statement")?)?;
                Ok(StmtKind::While(condition, body))
            }
            Rule::for_statement => self.for_statement(pair),
            Rule::repeat_statement => {
                let mut inner = parts(pair);
                let body = self.body(need(&mut inner, at, "a statement")?)?;
                let condition = self.expression(need(&mut inner, at, "a condition")?)?;
                Ok(StmtKind::Repeat(body, condition))
            }
            Rule::if_statement => {
                let mut branches = Vec::new();
                let mut otherwise = Vec::new();
                let mut condition = None;
                for p in parts(pair) {
                    match p.as_rule() {
                        Rule::expression => condition = Some(self.expression(p)?),
                        Rule::else_body => {
                            for b in p.into_inner() {
                                otherwise = self.body(b)?;
                            }
                        }
                        _ => {
                            let body = self.body(p)?;
                            if let Some(c) = condition.take() {
                                branches.push((c, body));
                            }
                        }
                    }
                }
                Ok(StmtKind::If(branches, otherwise))
            }
            Rule::break_statement | Rule::continue_statement => self.jump(pair),
            Rule::display_statement | Rule::abort_statement => self.display(pair),
            Rule::option_statement => {
                let items = parts(pair).map(|p| self.option_item(p));
                Ok(StmtKind::Option(items.collect::<Outcome<_>>()?))
            }
            Rule::solve_statement => self.solve(pair),
            Rule::put_statement => self.put(pair),
            Rule::execute_statement => {
                let mut inner = parts(pair);
                let word = need(&mut inner, at, "a name")?;
                Ok(StmtKind::Refused(self.ident(&word)))
            }
            Rule::exchange_statement => self.exchange(pair),
            Rule::directive_statement => self.directive(pair),
            Rule::figure_statement => self.figure(pair),
            Rule::draw_statement => {
                let mut inner = parts(pair);
                let name = self.ident(&need(&mut inner, at, "a figure")?);
                let file = inner.next().map(|e| self.expression(e)).transpose()?;
                Ok(StmtKind::Draw(name, file))
            }
            _ => Diagnostic::error("E0210", at)
                .says("a declaration cannot stand here")
                .help("declare it before the block")
                .refuse(),
        }
    }

    /// Statements inside a block.
    fn body(&self, pair: Pair<'_, Rule>) -> Outcome<Vec<Stmt>> {
        let stmt = |p: Pair<'_, Rule>| {
            let span = self.span(&p);
            Ok(self.stmt(self.action(p)?, span))
        };
        parts(pair).map(stmt).collect()
    }

    fn stmt(&self, kind: StmtKind, span: Span) -> Stmt {
        let modes = self.modes.clone();
        Stmt { kind, span, modes }
    }

    /// A statement, under a condition if there is one: `display$c x;` is `if(c, display x);`.
    fn under(&self, condition: Option<Expr>, kind: StmtKind, at: Span) -> StmtKind {
        match condition {
            None => kind,
            Some(c) => StmtKind::If(vec![(c, vec![self.stmt(kind, at)])], Vec::new()),
        }
    }

    pub(super) fn reference(&self, pair: Pair<'_, Rule>) -> Outcome<Reference> {
        let span = self.span(&pair);
        let mut inner = parts(pair);
        let name = self.ident(&need(&mut inner, span, "a name")?);
        let (mut attribute, mut indices) = (None, Vec::new());
        for p in inner {
            match p.as_rule() {
                Rule::attribute => attribute = self.first_ident(p),
                _ => indices = self.arguments(p)?,
            }
        }
        Ok(Reference {
            name,
            attribute,
            indices,
            span,
        })
    }

    fn algebra(&self, pair: Pair<'_, Rule>) -> Outcome<StmtKind> {
        let at = self.span(&pair);
        let mut inner = parts(pair);
        let target = self.reference(need(&mut inner, at, "a name")?)?;
        let mut condition = None;
        for p in inner {
            match p.as_rule() {
                Rule::condition => condition = Some(self.condition(p)?),
                Rule::definition => {
                    let mut sides = parts(p);
                    let left = self.expression(need(&mut sides, at, "an expression")?)?;
                    let relation = self.relation(&need(&mut sides, at, "a relation")?)?;
                    let right = self.expression(need(&mut sides, at, "an expression")?)?;
                    if let Some(a) = target.attribute {
                        return Diagnostic::error("E0211", a.span)
                            .says("an equation is defined by its name, without an attribute")
                            .help(format!("write `{}..`", target.name.name))
                            .refuse();
                    }
                    return Ok(StmtKind::Equate(Equate {
                        name: target.name,
                        indices: target.indices,
                        condition,
                        left,
                        relation,
                        right,
                    }));
                }
                _ => {
                    let nonzero = p.as_str().starts_with("$=");
                    let Some(e) = p.into_inner().next() else {
                        break;
                    };
                    let value = self.expression(e)?;
                    return Ok(StmtKind::Assign(Assign {
                        target,
                        condition,
                        value,
                        nonzero,
                    }));
                }
            }
        }
        Err(expected(at, "`=` or `..`"))
    }

    fn relation(&self, pair: &Pair<'_, Rule>) -> Outcome<Relation> {
        let at = self.span(pair);
        let refused = |what: &str, help: &str| {
            Diagnostic::error("E0216", at)
                .says(what.to_owned())
                .help(help)
                .refuse()
        };
        if let Some(relation) = Relation::named(pair.as_str()) {
            return Ok(relation);
        }
        match pair.as_str().as_bytes()[1].to_ascii_lowercase() {
            b'x' => refused(
                "`=x=` equations call functions of an external program, which is refused",
                "write the function in the language",
            ),
            b'c' => refused(
                "`=c=` (conic) equations are not supported",
                "write the cone as a quadratic inequality",
            ),
            b'b' => refused(
                "`=b=` (logic) equations are not supported",
                "write the logic with binary variables",
            ),
            _ => refused(
                &format!("`{}` is no relation", pair.as_str()),
                "relations are `=e=`, `=g=`, `=l=`, `=n=`",
            ),
        }
    }

    fn for_statement(&self, pair: Pair<'_, Rule>) -> Outcome<StmtKind> {
        let at = self.span(&pair);
        let mut inner = parts(pair);
        let variable = self.reference(need(&mut inner, at, "a scalar")?)?;
        let from = self.expression(need(&mut inner, at, "a number")?)?;
        let down = need(&mut inner, at, "`to`")?.as_str().len() > 2;
        let to = self.expression(need(&mut inner, at, "a number")?)?;
        let mut by = None;
        let mut body = Vec::new();
        for p in inner {
            match p.as_rule() {
                Rule::expression => by = Some(self.expression(p)?),
                _ => body = self.body(p)?,
            }
        }
        Ok(StmtKind::For(For {
            variable,
            from,
            down,
            to,
            by,
            body,
        }))
    }

    /// `break` and `continue`.
    fn jump(&self, pair: Pair<'_, Rule>) -> Outcome<StmtKind> {
        let (at, rule) = (self.span(&pair), pair.as_rule());
        let mut condition = None;
        let mut loops = 1;
        for p in parts(pair) {
            match p.as_rule() {
                Rule::condition => condition = Some(self.condition(p)?),
                _ => {
                    let count = p.as_str().parse().ok().filter(|n| *n > 0);
                    let Some(count) = count else {
                        return Diagnostic::error("E0217", self.span(&p))
                            .says("the number of loops to leave is a whole number from 1 on")
                            .help("`break;` leaves one loop, `break 2;` two")
                            .refuse();
                    };
                    loops = count;
                }
            }
        }
        let kind = match rule {
            Rule::break_statement => StmtKind::Break(loops),
            _ => StmtKind::Continue,
        };
        Ok(self.under(condition, kind, at))
    }

    /// `display` and `abort`.
    fn display(&self, pair: Pair<'_, Rule>) -> Outcome<StmtKind> {
        let (at, rule) = (self.span(&pair), pair.as_rule());
        let mut condition = None;
        let mut items = Vec::new();
        let mut no_error = false;
        for p in parts(pair) {
            match p.as_rule() {
                Rule::condition => condition = Some(self.condition(p)?),
                Rule::no_error => no_error = true,
                Rule::quoted => items.push(DisplayItem::Text(Self::unquote(&p), self.span(&p))),
                _ => items.push(DisplayItem::Symbol(self.reference(p)?)),
            }
        }
        let kind = match rule {
            Rule::display_statement => StmtKind::Display(items),
            _ => StmtKind::Abort(items, no_error),
        };
        Ok(self.under(condition, kind, at))
    }

    fn option_item(&self, pair: Pair<'_, Rule>) -> Outcome<OptionItem> {
        let at = self.span(&pair);
        let mut inner = parts(pair);
        let name = self.ident(&need(&mut inner, at, "an option")?);
        let mut indices = None;
        let form = match inner.next() {
            None => OptionForm::Flag,
            Some(p) => match p.as_rule() {
                Rule::option_value => {
                    let span = self.span(&p);
                    match p.into_inner().next() {
                        None => OptionForm::Flag,
                        Some(v) => {
                            let span = self.span(&v).to(Span::new(span.hi, span.hi));
                            let text = v.as_str();
                            OptionForm::Assign(match v.as_rule() {
                                Rule::signed => OptionValue::Number(signed(text)),
                                Rule::quoted => OptionValue::Text(Self::unquote(&v), span),
                                _ => OptionValue::Text(text.into(), span),
                            })
                        }
                    }
                }
                Rule::option_format => {
                    OptionForm::Format(p.into_inner().map(|n| number(n.as_str()) as i64).collect())
                }
                Rule::option_match => {
                    let (mut sets, mut matched) = (Vec::new(), false);
                    for q in p.into_inner() {
                        if q.as_rule() == Rule::matched {
                            matched = true;
                        } else {
                            sets.push((std::mem::take(&mut matched), self.ident(&q)));
                        }
                    }
                    OptionForm::Match(sets)
                }
                Rule::option_permute => match p.into_inner().next() {
                    Some(set) => OptionForm::Permute(self.ident(&set)),
                    None => OptionForm::Flag,
                },
                _ => {
                    let (mut from_left, mut source, mut from) = (false, None, None);
                    for q in p.into_inner() {
                        match q.as_rule() {
                            Rule::option_names if source.is_none() => indices = Some(self.names(q)),
                            Rule::option_names => from = Some(self.names(q)),
                            Rule::from_left => from_left = true,
                            Rule::from_right => {}
                            _ => source = Some(self.ident(&q)),
                        }
                    }
                    match source {
                        Some(source) => OptionForm::Project {
                            from_left,
                            source,
                            indices: from,
                        },
                        None => OptionForm::Flag,
                    }
                }
            },
        };
        Ok(OptionItem {
            name,
            indices,
            form,
        })
    }

    fn names(&self, pair: Pair<'_, Rule>) -> Vec<Ident> {
        parts(pair).map(|p| self.ident(&p)).collect()
    }

    fn solve(&self, pair: Pair<'_, Rule>) -> Outcome<StmtKind> {
        let at = self.span(&pair);
        let mut inner = parts(pair);
        let model = self.ident(&need(&mut inner, at, "a model")?);
        let (mut using, mut objective, mut scenario) = (None, None, None);
        for p in inner {
            let place = self.span(&p);
            match p.as_rule() {
                Rule::using if using.is_some() => {
                    return Diagnostic::error("E0218", place)
                        .says("`using` stands here twice")
                        .refuse();
                }
                Rule::using => using = self.first_ident(p),
                Rule::scenario => scenario = self.first_ident(p),
                _ if objective.is_some() => {
                    return Diagnostic::error("E0218", place)
                        .says("a second direction stands here")
                        .help("a solve has one objective: `solve m using lp minimizing z;`")
                        .refuse();
                }
                _ => {
                    let mut sides = parts(p);
                    let word = need(&mut sides, place, "a direction")?.as_str().get(..3);
                    let sense = match word.is_some_and(|w| w.eq_ignore_ascii_case("min")) {
                        true => Sense::Minimize,
                        false => Sense::Maximize,
                    };
                    let variable = self.ident(&need(&mut sides, place, "a variable")?);
                    objective = Some((sense, variable));
                }
            }
        }
        let Some(using) = using else {
            let name = &model.name;
            return Diagnostic::error("E0218", at)
                .says(format!(
                    "`solve {name}` does not say which type of model it is"
                ))
                .help(format!("write `solve {name} using lp minimizing z;`"))
                .refuse();
        };
        Ok(StmtKind::Solve(Solve {
            model,
            using,
            objective,
            scenario,
        }))
    }

    fn put(&self, pair: Pair<'_, Rule>) -> Outcome<StmtKind> {
        let at = self.span(&pair);
        let mut inner = parts(pair);
        let keyword = self.keyword(&need(&mut inner, at, "`put`")?).name;
        let mut condition = None;
        let mut items = Vec::new();
        for p in inner {
            let place = self.span(&p);
            match p.as_rule() {
                Rule::condition => condition = Some(self.condition(p)?),
                Rule::new_line => items.push(PutItem::NewLine),
                Rule::put_column | Rule::put_row => {
                    let of = match p.as_rule() {
                        Rule::put_column => PutItem::Column,
                        _ => PutItem::Row,
                    };
                    let Some(e) = parts(p).next() else { continue };
                    items.push(of(self.operand(e)?));
                }
                _ => items.push(self.put_value(p, place)?),
            }
        }
        Ok(self.under(condition, StmtKind::Put(keyword, items), at))
    }

    fn put_value(&self, pair: Pair<'_, Rule>, at: Span) -> Outcome<PutItem> {
        let mut inner = parts(pair);
        let first = need(&mut inner, at, "something to write")?;
        let mut value = self.operand(first)?;
        let (mut align, mut width, mut decimals) = (None, None, None);
        let mut condition = None;
        for p in inner {
            match p.as_rule() {
                Rule::condition => condition = Some(self.condition(p)?),
                Rule::align => {
                    align = match p.as_str() {
                        "<>" => Some('='),
                        sign => sign.chars().next(),
                    }
                }
                Rule::width => width = Some(self.put_number(p)?),
                _ => {
                    let d = self.put_number(p)?;
                    decimals = decimals.or(Some(d));
                }
            }
        }
        if let Some(c) = condition {
            let span = value.span.to(c.span);
            value = Expr {
                kind: ExprKind::Dollar(Box::new(value), Box::new(c)),
                span,
            };
        }
        Ok(PutItem::Item(Written {
            value,
            align,
            width,
            decimals,
        }))
    }

    /// A width or decimals: digits, a scalar, or an expression in parentheses.
    fn put_number(&self, pair: Pair<'_, Rule>) -> Outcome<Expr> {
        let span = self.span(&pair);
        let inner = need(&mut parts(pair), span, "a width")?;
        if inner.as_rule() == Rule::digits {
            return Ok(Expr {
                kind: ExprKind::Number(inner.as_str().parse().map_or(0.0, f64::round)),
                span,
            });
        }
        self.operand(inner)
    }

    fn exchange(&self, pair: Pair<'_, Rule>) -> Outcome<StmtKind> {
        let at = self.span(&pair);
        let mut inner = parts(pair);
        let keyword = self.keyword(&need(&mut inner, at, "a keyword")?);
        let (mut file, mut items, mut condition) = (None, Vec::new(), None);
        for p in inner {
            let span = self.span(&p);
            match p.as_rule() {
                Rule::condition => condition = Some(self.condition(p)?),
                Rule::exchange_file => {
                    file = p.into_inner().next().map(|q| (Self::unquote(&q), span))
                }
                _ => items.extend(self.exchange_item(p)),
            }
        }
        let statement = StmtKind::Exchange(Exchange {
            keyword,
            file,
            items,
        });
        Ok(self.under(condition, statement, at))
    }

    /// `x`, `x = y`, `p = x.l`, `x.l = p`, `i < p.dim1`.
    fn exchange_item(&self, pair: Pair<'_, Rule>) -> Option<ExchangeItem> {
        let (mut name, mut into, mut other, mut suffix) = (None, None, None, None);
        let mut by = ExchangeBy::Name;
        for p in pair.into_inner() {
            match p.as_rule() {
                Rule::name if name.is_none() => name = Some(self.ident(&p)),
                Rule::name | Rule::any_label => other = Some(self.ident(&p)),
                Rule::attribute => {
                    let attribute = self.first_ident(p);
                    match other {
                        Some(_) => suffix = attribute,
                        None => into = attribute,
                    }
                }
                Rule::load_from => {
                    by = match p.as_str() {
                        "<" => ExchangeBy::LastPosition,
                        "<=" => ExchangeBy::FirstPosition,
                        _ => ExchangeBy::Name,
                    };
                }
                _ => {}
            }
        }
        Some(ExchangeItem {
            name: name?,
            into,
            other,
            suffix,
            by,
        })
    }

    fn directive(&self, pair: Pair<'_, Rule>) -> Outcome<StmtKind> {
        let at = self.span(&pair);
        let mut inner = parts(pair);
        let word = need(&mut inner, at, "a directive")?;
        let keyword = self.keyword(&word);
        if word.as_rule() == Rule::clear_word {
            return Ok(StmtKind::Clear {
                kill: &*keyword.name == "kill",
                names: inner.map(|p| self.ident(&p)).collect(),
            });
        }
        let (mut file, mut items) = (None, Vec::new());
        for p in inner {
            let span = self.span(&p);
            match p.as_rule() {
                Rule::gdx_file | Rule::gdx_name => {
                    let t = bare(p.as_str().trim());
                    if !t.is_empty() {
                        file = Some((t.into(), span));
                    }
                }
                _ => items.extend(self.exchange_item(p)),
            }
        }
        Ok(StmtKind::Exchange(Exchange {
            keyword,
            file,
            items,
        }))
    }

    fn figure(&self, pair: Pair<'_, Rule>) -> Outcome<StmtKind> {
        let at = self.span(&pair);
        let mut inner = parts(pair);
        let name = self.ident(&need(&mut inner, at, "a name")?);
        let (mut title, mut elements) = (None, Vec::new());
        for p in inner {
            match p.as_rule() {
                Rule::quoted => title = Some(Self::unquote(&p)),
                Rule::figure_element => elements.push(self.figure_element(p)?),
                _ => {}
            }
        }
        Ok(StmtKind::Figure(Figure {
            name,
            title,
            elements,
        }))
    }

    fn figure_element(&self, pair: Pair<'_, Rule>) -> Outcome<FigureElement> {
        let span = self.span(&pair);
        let mut inner = parts(pair);
        let kind = self.ident(&need(&mut inner, span, "an element")?);
        let (mut domain, mut condition, mut arguments) = (None, None, Vec::new());
        for p in inner {
            let place = self.span(&p);
            match p.as_rule() {
                Rule::domain_of_element => {
                    let items = p.into_inner().map(|i| self.domain_item(i));
                    domain = Some(Domain {
                        items: items.collect::<Outcome<_>>()?,
                        condition: None,
                        span: place,
                    });
                }
                Rule::condition => condition = Some(self.condition(p)?),
                _ => {
                    let mut name = None;
                    for q in p.into_inner() {
                        match q.as_rule() {
                            Rule::name => name = Some(self.ident(&q)),
                            _ => arguments.push((name.take(), self.expression(q)?)),
                        }
                    }
                }
            }
        }
        if let Some(c) = condition {
            let d = domain.get_or_insert(Domain {
                items: Vec::new(),
                span: c.span,
                condition: None,
            });
            d.span = d.span.to(c.span);
            d.condition = Some(c);
        }
        Ok(FigureElement {
            kind,
            domain,
            arguments,
            span,
        })
    }
}

fn signed(text: &str) -> f64 {
    match text.strip_prefix('-') {
        Some(t) => match number(t.trim_start()) {
            // `eps` and `undf` have no sign.
            x if x.is_nan() => x,
            x => -x,
        },
        None => number(text.trim_start_matches('+')),
    }
}
