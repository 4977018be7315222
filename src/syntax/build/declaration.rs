//! Declarations: names, domains, texts, data.

use pest::iterators::Pair;

use super::{Builder, Outcome, bare, need, parts};
use crate::diag::Diagnostic;
use crate::syntax::ast::*;
use crate::syntax::grammar::Rule;
use crate::syntax::words;

impl Builder<'_> {
    /// A whole statement, given its top rule.
    pub(crate) fn statement(&self, pair: Pair<'_, Rule>) -> Outcome<StmtKind> {
        match pair.as_rule() {
            Rule::set_statement => {
                let (mut singleton, mut list) = (false, Vec::new());
                for p in parts(pair) {
                    match p.as_rule() {
                        Rule::set_word => {
                            let first = p.as_str().get(..9);
                            singleton = first.is_some_and(|w| w.eq_ignore_ascii_case("singleton"));
                        }
                        _ => list.push(SetDecl {
                            symbol: self.declaration(p)?,
                            singleton,
                        }),
                    }
                }
                Ok(StmtKind::Set(list))
            }
            Rule::parameter_statement => {
                let mut scalar = false;
                let mut list = Vec::new();
                for p in parts(pair) {
                    match p.as_rule() {
                        Rule::parameter_word => {
                            scalar = p.as_str().as_bytes()[0].eq_ignore_ascii_case(&b's')
                        }
                        _ => list.push(ParameterDecl {
                            symbol: self.declaration(p)?,
                            scalar,
                        }),
                    }
                }
                Ok(StmtKind::Parameter(list))
            }
            Rule::variable_statement => {
                let mut kind = VariableKind::Unstated;
                let mut list = Vec::new();
                for p in parts(pair) {
                    match p.as_rule() {
                        Rule::variable_kind => {
                            kind = VariableKind::named(p.as_str()).unwrap_or(kind)
                        }
                        _ => list.push(self.declaration(p)?),
                    }
                }
                Ok(StmtKind::Variable(kind, list))
            }
            Rule::equation_statement => Ok(StmtKind::Equation(self.declarations(pair)?)),
            Rule::acronym_statement => Ok(StmtKind::Acronym(self.declarations(pair)?)),
            Rule::file_statement => {
                let mut list = Vec::new();
                let function = pair.as_str().as_bytes()[1].eq_ignore_ascii_case(&b'u');
                for p in parts(pair) {
                    let d = self.declaration(p)?;
                    let path = d.data.map(|s| {
                        let t = self.expanded.get(s.lo as usize..s.hi as usize);
                        bare(t.unwrap_or("").trim()).trim().into()
                    });
                    list.push(FileDecl {
                        name: d.name,
                        text: d.text,
                        path,
                    });
                }
                Ok(if function {
                    StmtKind::Function(list)
                } else {
                    StmtKind::File(list)
                })
            }
            Rule::table_statement => {
                let (mut of, mut kind) = (TableOf::Parameter, VariableKind::Unstated);
                let mut symbols = Vec::new();
                for p in parts(pair) {
                    match p.as_rule() {
                        Rule::set_word => of = TableOf::Set,
                        Rule::parameter_word => {}
                        Rule::variable_kind => {
                            kind = VariableKind::named(p.as_str()).unwrap_or(kind)
                        }
                        Rule::variable_word => of = TableOf::Variable(kind),
                        _ => symbols.push(self.declaration(p)?),
                    }
                }
                Ok(StmtKind::Table(TableDecl { of, symbols }))
            }
            Rule::alias_statement => {
                let names =
                    |group: Pair<'_, Rule>| group.into_inner().map(|n| self.ident(&n)).collect();
                Ok(StmtKind::Alias(parts(pair).map(names).collect()))
            }
            Rule::model_statement => {
                let list = parts(pair).map(|p| self.model(p));
                Ok(StmtKind::Model(list.collect::<Outcome<_>>()?))
            }
            _ => self.action(pair),
        }
    }

    fn declarations(&self, pair: Pair<'_, Rule>) -> Outcome<Vec<SymbolDecl>> {
        parts(pair).map(|p| self.declaration(p)).collect()
    }

    fn declaration(&self, pair: Pair<'_, Rule>) -> Outcome<SymbolDecl> {
        let span = self.span(&pair);
        let mut inner = parts(pair);
        let name = need(&mut inner, span, "a name")?;
        let mut d = SymbolDecl {
            name: self.free_name(&name)?,
            domain: None,
            text: None,
            data: None,
        };
        for p in inner {
            match p.as_rule() {
                Rule::declared_over => d.domain = Some(self.domain_names(p)),
                Rule::text_mark => d.text = self.text_in(&p),
                _ => d.data = self.hole(&p).map(|h| h.inside),
            }
        }
        Ok(d)
    }

    /// A name that is declared: no word of the language.
    fn free_name(&self, pair: &Pair<'_, Rule>) -> Outcome<Ident> {
        let name = self.ident(pair);
        match words::is_reserved(&name.name) {
            true => Err(Box::new(words::reserved(&name.name, name.span))),
            false => Ok(name),
        }
    }

    fn domain_names(&self, pair: Pair<'_, Rule>) -> Vec<DomainName> {
        parts(pair)
            .map(|p| {
                // `*` leaves no pair.
                let mut name = Ident {
                    name: "*".into(),
                    span: self.span(&p),
                };
                let mut defines = false;
                for q in p.into_inner() {
                    match q.as_rule() {
                        Rule::defines => defines = true,
                        Rule::quoted => {
                            (name.name, name.span) = (Self::unquote(&q), self.span(&q));
                        }
                        _ => name = self.ident(&q),
                    }
                }
                DomainName { name, defines }
            })
            .collect()
    }

    fn model(&self, pair: Pair<'_, Rule>) -> Outcome<ModelDecl> {
        let span = self.span(&pair);
        let mut inner = parts(pair);
        let name = need(&mut inner, span, "a name")?;
        let mut model = ModelDecl {
            name: self.free_name(&name)?,
            text: None,
            items: None,
        };
        for p in inner {
            match p.as_rule() {
                Rule::text_mark => model.text = self.text_in(&p),
                Rule::model_items => {
                    let mut items = Vec::new();
                    for item in p.into_inner() {
                        self.model_item(item, &mut items)?;
                    }
                    model.items = Some(items);
                }
                _ => {}
            }
        }
        Ok(model)
    }

    fn model_item(&self, pair: Pair<'_, Rule>, items: &mut Vec<ModelItem>) -> Outcome<()> {
        let mut minus = false;
        for p in parts(pair) {
            let place = self.span(&p);
            match p.as_rule() {
                Rule::model_sign => minus = p.as_str() == "-",
                Rule::model_name => {
                    let mut inner = p.into_inner();
                    let Some(name) = inner.next() else { continue };
                    let name = self.ident(&name);
                    let over = inner.next().map(|a| self.plain_names(a)).transpose()?;
                    items.push(match over {
                        _ if minus => ModelItem::Remove(name),
                        Some(sets) => ModelItem::Limit(name, sets),
                        None if name.name.eq_ignore_ascii_case("all") => ModelItem::All(name.span),
                        None => ModelItem::Add(name),
                    });
                }
                Rule::model_group => {
                    for rows in p.into_inner() {
                        for n in rows.into_inner() {
                            let n = self.ident(&n);
                            items.push(if minus {
                                ModelItem::Remove(n)
                            } else {
                                ModelItem::Add(n)
                            });
                        }
                    }
                }
                _ => {
                    let mut rows = Vec::new();
                    let mut columns = Vec::new();
                    for (n, q) in p.into_inner().enumerate() {
                        let to = if n == 0 || q.as_rule() == Rule::arguments {
                            &mut rows
                        } else {
                            &mut columns
                        };
                        match q.as_rule() {
                            Rule::model_rows => to.extend(q.into_inner().map(|r| self.ident(&r))),
                            Rule::name => to.push(self.ident(&q)),
                            _ => {}
                        }
                    }
                    if minus {
                        return Diagnostic::error("E0215", place)
                            .says("a pair cannot be taken out of a model")
                            .help("write `- equation` to take an equation out")
                            .refuse();
                    }
                    // `f.(x,y)`: each by itself; which is legal is decided later.
                    items.extend(columns.into_iter().map(|column| ModelItem::Pair {
                        rows: rows.clone(),
                        column,
                    }));
                }
            }
        }
        Ok(())
    }

    /// Arguments that are bare names.
    pub(super) fn plain_names(&self, pair: Pair<'_, Rule>) -> Outcome<Vec<Ident>> {
        let mut names = Vec::new();
        for e in self.arguments(pair)? {
            match e.kind {
                ExprKind::Apply(name, None, None) => names.push(name),
                _ => {
                    return Diagnostic::error("E0214", e.span)
                        .says("a set was expected here")
                        .refuse();
                }
            }
        }
        Ok(names)
    }
}
