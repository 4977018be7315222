//! Statements other than declarations.

use super::effects::Effects;
use super::node::*;
use super::symbols::{SymbolKind, attribute};
use super::{Checked, Compiler, Failed};
use crate::diag::Diagnostic;
use crate::source::{SourceMap, Span};
use crate::syntax::ast::{self, DisplayItem, Equate, Expr, ExprKind, Stmt, StmtKind};

impl Compiler {
    /// Checks a statement and appends its code.
    pub(super) fn statement(
        &mut self,
        stmt: &Stmt,
        map: &SourceMap,
        out: &mut Vec<Code>,
    ) -> Checked<()> {
        let slot = self.next_slot;
        let r = self.one_statement(stmt, map, out);
        self.next_slot = slot;
        if r.is_err() {
            self.meant(stmt);
        }
        r
    }

    /// What a statement with an error is meant to give values to: no second message where it is used.
    fn meant(&mut self, stmt: &Stmt) {
        let mut bodies: Vec<&[Stmt]> = Vec::new();
        match &stmt.kind {
            StmtKind::Assign(a) => {
                if let Some(s) = self.symbols.find(&a.target.name.name) {
                    let root = self.symbols.root(s);
                    self.symbols.get_mut(root).assigned = true;
                }
            }
            StmtKind::Loop(_, body)
            | StmtKind::While(_, body)
            | StmtKind::Repeat(body, _)
            | StmtKind::For(For { body, .. }) => bodies.push(body),
            StmtKind::If(arms, otherwise) => {
                bodies.extend(arms.iter().map(|(_, body)| &body[..]));
                bodies.push(otherwise);
            }
            _ => {}
        }
        bodies.into_iter().flatten().for_each(|s| self.meant(s));
    }

    fn one_statement(&mut self, stmt: &Stmt, map: &SourceMap, out: &mut Vec<Code>) -> Checked<()> {
        self.modes = stmt.modes.clone();
        self.begin_statement();
        let mut span = stmt.span;
        if self.nesting > 0 {
            self.no_declaration(stmt)?;
        }
        let kind = match &stmt.kind {
            StmtKind::Set(list) => return self.declare_sets(list, map),
            StmtKind::Alias(groups) => return self.declare_aliases(groups),
            StmtKind::Parameter(list) => return self.declare_parameters(list, map),
            StmtKind::Table(t) => return self.declare_tables(t, map),
            StmtKind::Variable(kind, list) => return self.declare_variables(*kind, list, map),
            StmtKind::Equation(list) => return self.declare_equations(list, map),
            StmtKind::Model(list) => return self.declare_models(list),
            StmtKind::Acronym(list) => return self.declare_acronyms(list),
            StmtKind::File(list) => return self.declare_files(list),
            StmtKind::Function(list) => return self.declare_functions(list),
            StmtKind::Figure(f) => return self.declare_figure(f),
            StmtKind::Clear { kill, names } => return self.forget(*kill, names),
            StmtKind::Empty => return Ok(()),
            StmtKind::Assign(a) => return self.assign(a, span, out),
            StmtKind::Equate(e) => return self.equate(e, span),
            StmtKind::Solve(s) => self.solve(s, span)?,
            StmtKind::Loop(d, body) => self.scoped(|c| {
                let mut domain = c.domain(d)?;
                let mut nest = std::mem::take(&mut c.nest);
                nest.extend(domain.slots.iter().copied().zip(domain.sets.clone()));
                if holds_one_loop(body) {
                    c.nest.clone_from(&nest);
                }
                let body = c.body(body, map)?;
                c.nest = nest;
                domain.conditions.extend(c.driver(&body));
                c.nest.clear();
                // What the body changes is asked at every turn, not before the first.
                let effects = Effects::of(&body, &c.symbols);
                let conditions = std::mem::take(&mut domain.conditions).into_iter();
                let (late, first) = conditions.partition(|cond| effects.touch(cond));
                domain.conditions = first;
                Ok(CodeKind::Loop(domain, late, body))
            })?,
            StmtKind::While(cond, body) => CodeKind::While(self.expr(cond)?, self.body(body, map)?),
            StmtKind::Repeat(body, until) => {
                CodeKind::Repeat(self.body(body, map)?, self.expr(until)?)
            }
            StmtKind::For(f) => {
                let variable = &f.variable;
                let s = self.lookup(&variable.name)?;
                let symbol = self.symbols.get(s);
                if !matches!(symbol.kind, SymbolKind::Parameter { .. })
                    || symbol.dim() != 0
                    || variable.attribute.is_some()
                {
                    let (declared, kind) = (symbol.declared, symbol.a_kind());
                    return Diagnostic::error("E0321", variable.span)
                        .says("`for` counts with a scalar")
                        .label(format!("this is {kind}"))
                        .other(declared, "declared here")
                        .help("declare `scalar k;`, or run over a set with `loop(i, …)`")
                        .fail(self);
                }
                let table = symbol.table;
                let (from, to) = (self.expr(&f.from)?, self.expr(&f.to)?);
                let by = self.optional(f.by.as_ref())?;
                self.symbols.get_mut(s).assigned = true;
                CodeKind::For(For {
                    variable: table,
                    from,
                    down: f.down,
                    to,
                    by,
                    body: self.body(&f.body, map)?,
                })
            }
            StmtKind::If(arms, otherwise) => {
                let mut checked = Vec::new();
                for (cond, body) in arms {
                    checked.push((self.expr(cond)?, self.body(body, map)?));
                }
                CodeKind::If(checked, self.body(otherwise, map)?)
            }
            StmtKind::Break(loops) => CodeKind::Break(*loops),
            StmtKind::Continue => CodeKind::Continue,
            StmtKind::Display(items) => {
                span = from_first_item(items, span);
                CodeKind::Display(self.shown(items)?)
            }
            StmtKind::Abort(items, no_error) => {
                span = from_first_item(items, span);
                CodeKind::Abort(self.shown(items)?, *no_error)
            }
            StmtKind::Option(items) => {
                for item in items {
                    if let Ok(Some(kind)) = self.option(item) {
                        out.push(Code::new(kind, span));
                    }
                }
                return Ok(());
            }
            StmtKind::Put(keyword, items) => self.put(keyword, items, span)?,
            StmtKind::Exchange(x) => {
                let keyword = x.keyword.name.to_lowercase();
                let loads = keyword.contains("load") && !keyword.contains("unload");
                for item in &x.items {
                    let s = self.lookup(&item.name)?;
                    self.symbols.get_mut(s).assigned |= loads;
                }
                CodeKind::Exchange(x.clone())
            }
            // In GAMS too the run goes on when a program cannot be started: what comes after, and the
            // results before, do not depend on a viewer or an export.
            StmtKind::Refused(what) => {
                Diagnostic::warning("E0322", what.span)
                    .says(format!("`{}` is refused", what.name))
                    .label("would run another program; passed over")
                    .help("a model run by bmod reads and writes only its own files; prepare the data before, or use `$include`")
                    .report(self);
                return Ok(());
            }
            StmtKind::Draw(name, file) => {
                let s = self.lookup(name)?;
                if !matches!(self.symbols.get(s).kind, SymbolKind::Figure(_)) {
                    let declared = self.symbols.get(s).declared;
                    return Diagnostic::error("E0323", name.span)
                        .says(format!("`{}` is not a figure", name.name))
                        .label("a figure is expected")
                        .other(declared, "declared here")
                        .fail(self);
                }
                let file = match file.as_ref().map(|f| (&f.kind, f.span)) {
                    None => None,
                    Some((ExprKind::Text(t), _)) => Some(t.clone()),
                    Some((_, span)) => {
                        return Diagnostic::error("E0323", span)
                            .says("`draw` takes a file name in quotes")
                            .fail(self);
                    }
                };
                CodeKind::Draw(s, file)
            }
        };
        self.shows_numbers |= matches!(
            kind,
            CodeKind::Display(..) | CodeKind::Put(..) | CodeKind::Draw(..) | CodeKind::Exchange(_)
        );
        out.push(Code::new(kind, span));
        Ok(())
    }

    fn no_declaration(&mut self, stmt: &Stmt) -> Checked<()> {
        let what = match &stmt.kind {
            StmtKind::Set(_)
            | StmtKind::Alias(_)
            | StmtKind::Parameter(_)
            | StmtKind::Table(_)
            | StmtKind::Variable(..)
            | StmtKind::Equation(_)
            | StmtKind::Model(_)
            | StmtKind::Acronym(_)
            | StmtKind::File(_)
            | StmtKind::Function(_)
            | StmtKind::Figure(_) => "declaration",
            StmtKind::Equate(_) => "definition of an equation",
            _ => return Ok(()),
        };
        Diagnostic::error("E0324", stmt.span)
            .says(format!("a {what} may not stand inside a loop or an if"))
            .label("inside a loop or an if")
            .help("move it before the loop")
            .fail(self)
    }

    fn body(&mut self, body: &[Stmt], map: &SourceMap) -> Checked<Vec<Code>> {
        self.nesting += 1;
        let mut out = Vec::new();
        let mut failed = false;
        for s in body {
            failed |= self.statement(s, map, &mut out).is_err();
        }
        self.nesting -= 1;
        if failed { Err(Failed) } else { Ok(out) }
    }

    pub(super) fn optional(&mut self, e: Option<&Expr>) -> Checked<Option<Node>> {
        e.map(|e| self.expr(e)).transpose()
    }

    fn equate(&mut self, e: &Equate, span: Span) -> Checked<()> {
        let s = self.lookup_equation(&e.name, &e.indices)?;
        self.shape(s, &e.indices);
        let symbol = self.symbols.get(s).clone();
        let SymbolKind::Equation(defined) = symbol.kind else {
            let (name, kind) = (&symbol.name, symbol.a_kind());
            return Diagnostic::error("E0326", e.name.span)
                .says(format!("`{name}` is {kind}, not an equation"))
                .label("an equation is expected before `..`")
                .other(symbol.declared, "declared here")
                .help(format!("declare it: `equation {};`", e.name.name))
                .fail(self);
        };
        if let Some(d) = defined
            && !self.modes.at(e.name.span).multi_replace
        {
            return Diagnostic::error("E0327", e.name.span)
                .says(format!("the equation `{}` is defined twice", symbol.name))
                .label("second definition")
                .other(self.equations[d].span, "first definition")
                .help("give the second one another name")
                .fail(self);
        }
        self.in_equation = true;
        let r = self.scoped(|c| {
            let mut domain = Domain::default();
            let parts = c.defining(|c| c.control_key(&e.indices, s, e.name.span, &mut domain))?;
            if let Some(cond) = &e.condition {
                c.condition(cond, &mut domain)?;
            }
            let (left, right) = match (c.expr(&e.left), c.expr(&e.right)) {
                (Ok(l), Ok(r)) => (l, r),
                _ => return Err(Failed),
            };
            c.number(&left)?;
            c.number(&right)?;
            Ok(EquationDef {
                symbol: s,
                domain,
                key: Key { parts },
                left,
                relation: e.relation,
                right,
                running: std::mem::take(&mut c.running),
                span,
            })
        });
        self.in_equation = false;
        self.running.clear();
        self.without_data.push(std::mem::take(&mut self.reads));
        // Defined, even if wrongly: one mistake, one message.
        let index = self.equations.len();
        let sym = self.symbols.get_mut(s);
        sym.kind = SymbolKind::Equation(Some(index));
        // A side that the relation bounds is 0 where there is no row.
        let table = sym.table;
        let bounded: &[u32] = match e.relation {
            ast::Relation::Equal => &[attribute::LO, attribute::UP],
            ast::Relation::Greater => &[attribute::LO],
            ast::Relation::Less => &[attribute::UP],
            ast::Relation::Free => &[],
        };
        for o in bounded {
            self.store.table_mut(table + o).set_default(0.0);
        }
        let done = r.as_ref().map(|_| ()).map_err(|_| Failed);
        self.equations.push(r.unwrap_or_else(|Failed| {
            self.lost.definitions.insert(index);
            EquationDef {
                symbol: s,
                domain: Domain::default(),
                key: Key::default(),
                left: Node::number(0.0, span),
                relation: e.relation,
                right: Node::number(0.0, span),
                running: Vec::new(),
                span,
            }
        }));
        done
    }
}

/// What is displayed stands in the line of the first item.
fn from_first_item(items: &[DisplayItem], span: Span) -> Span {
    let first = match items.first() {
        Some(DisplayItem::Text(_, at)) => *at,
        Some(DisplayItem::Symbol(r)) => r.span,
        None => span,
    };
    Span::new(first.lo, span.hi)
}

/// Whether these are a loop and nothing else, under conditions or not.
fn holds_one_loop(body: &[Stmt]) -> bool {
    let mut rest = body.iter().filter(|s| !matches!(s.kind, StmtKind::Empty));
    let (Some(only), None) = (rest.next(), rest.next()) else {
        return false;
    };
    match &only.kind {
        StmtKind::Loop(..) => true,
        StmtKind::If(arms, otherwise) => {
            otherwise.is_empty() && matches!(arms.as_slice(), [(_, body)] if holds_one_loop(body))
        }
        _ => false,
    }
}
