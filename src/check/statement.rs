//! Statements other than declarations.

use super::effects::Effects;
use super::functions;
use super::node::*;
use super::symbols::{DomainPosition, SymbolKind, attribute};
use super::{Compiler, Failed};
use crate::diag::{Diagnostic, nearest};
use crate::solve::OWN_OPTIONS;
use crate::source::{SourceMap, Span};
use crate::syntax::ast::{
    self, Assign, DisplayItem, Equate, Expr, ExprKind, Ident, OptionForm, OptionItem, OptionValue,
    Put, PutItem, Stmt, StmtKind,
};
use std::rc::Rc;

/// Options of the `option` statement that are numbers or switches, besides solver choices.
const OPTIONS: &[&str] = &[
    "limrow",
    "limcol",
    "iterlim",
    "reslim",
    "decimals",
    "optcr",
    "optca",
    "domlim",
    "bratio",
    "seed",
    "sysout",
    "solprint",
    "solveopt",
    "solvelink",
    "savepoint",
    "threads",
    "profile",
    "profiletol",
    "eject",
    "dispwidth",
    "forcework",
    "measure",
    "memorystat",
    "strictsingleton",
    "intvarup",
    "sys10",
    "sys11",
    "sys12",
    "dmpsym",
    "dmpopt",
    "dualcheck",
    "real1",
    "real2",
    "real3",
    "real4",
    "real5",
    "integer1",
    "integer2",
    "integer3",
    "integer4",
    "integer5",
    "subsystems",
    "on115",
    "zerores",
    "zeroresrep",
    "solslack",
    "cheat",
    "cutoff",
    "work",
    "oldname",
    "solver",
    "asyncsollst",
    "fddelta",
    "fdopt",
    "threadsasync",
    "bratio",
    "ejectx",
    "mcprholdfx",
    "gdxuels",
    "shuffle",
    "certify",
    "checkerrorlevel",
    "dmpuserSym",
    "resLim",
    "holdfixedasync",
    "prefixloadpath",
    "debugtask",
    "validation",
    "format",
    "hessscale",
    "ecimplicitload",
];

/// Whether an option is the language's and not a solver's: a problem type (`nlp = ipopt`), a limit, a
/// switch.
pub fn is_statement_option(name: &str) -> bool {
    let mut known = [OPTIONS, functions::PROBLEM_TYPES].into_iter().flatten();
    known.any(|o| o.eq_ignore_ascii_case(name))
}

impl Compiler {
    /// Checks a statement and appends its code.
    pub(super) fn statement(
        &mut self,
        stmt: &Stmt,
        map: &SourceMap,
        out: &mut Vec<Code>,
    ) -> Result<(), Failed> {
        let slot = self.next_slot;
        let r = self.one_statement(stmt, map, out);
        self.next_slot = slot;
        r
    }

    fn one_statement(
        &mut self,
        stmt: &Stmt,
        map: &SourceMap,
        out: &mut Vec<Code>,
    ) -> Result<(), Failed> {
        self.modes = stmt.modes;
        let span = stmt.span;
        if self.nesting > 0 {
            self.no_declaration(stmt)?;
        }
        let kind = match &stmt.kind {
            StmtKind::Set(list) => return self.declare_sets(list, map),
            StmtKind::Alias(groups) => return self.declare_aliases(groups),
            StmtKind::Parameter(list) => return self.declare_parameters(list, map),
            StmtKind::Table(t) => return self.declare_table(t, map),
            StmtKind::Variable(kind, list) => return self.declare_variables(*kind, list, map),
            StmtKind::Equation(list) => return self.declare_equations(list, map),
            StmtKind::Model(list) => return self.declare_models(list),
            StmtKind::Acronym(list) => return self.declare_acronyms(list),
            StmtKind::File(list) => return self.declare_files(list),
            StmtKind::Figure(f) => return self.declare_figure(f),
            StmtKind::Empty => return Ok(()),
            StmtKind::Assign(a) => {
                let code = self.assign(a);
                if code.is_err()
                    && let Some(s) = self.symbols.find(&a.target.name.name)
                {
                    // It is meant to get values: no second message where it is used.
                    let root = self.symbols.root(s);
                    self.symbols.get_mut(root).assigned = true;
                }
                code?
            }
            StmtKind::Equate(e) => return self.equate(e, span),
            StmtKind::Solve(s) => self.solve(s, span)?,
            StmtKind::Loop(d, body) => self.scoped(|c| {
                let mut domain = c.domain(d)?;
                let body = c.body(body, map)?;
                // What the body changes is asked at every turn, not before the first.
                let effects = Effects::of(&body, &c.symbols);
                let mut late = Vec::new();
                for cond in std::mem::take(&mut domain.conditions) {
                    if effects.touch(&cond) {
                        late.push(cond);
                    } else {
                        domain.conditions.push(cond);
                    }
                }
                let body = late.into_iter().rev().fold(body, |body, cond| {
                    let span = cond.span;
                    vec![Code::new(
                        CodeKind::If(vec![(cond, body)], Vec::new()),
                        span,
                    )]
                });
                Ok(CodeKind::Loop(domain, body))
            })?,
            StmtKind::While(cond, body) => CodeKind::While(self.expr(cond)?, self.body(body, map)?),
            StmtKind::Repeat(body, until) => {
                CodeKind::Repeat(self.body(body, map)?, self.expr(until)?)
            }
            StmtKind::For {
                variable,
                from,
                down,
                to,
                by,
                body,
            } => {
                let s = self.lookup(&variable.name)?;
                let symbol = self.symbols.get(s);
                if !matches!(symbol.kind, SymbolKind::Parameter { .. })
                    || symbol.dim() != 0
                    || variable.attribute.is_some()
                {
                    let (declared, kind) = (symbol.declared, symbol.kind_name());
                    return self.fail(
                        Diagnostic::error("E0321", variable.span, "`for` counts with a scalar")
                            .label(format!("this is a {kind}"))
                            .other(declared, "declared here")
                            .help("declare `scalar k;`, or run over a set with `loop(i, …)`"),
                    );
                }
                let table = symbol.table;
                let (from, to) = (self.expr(from)?, self.expr(to)?);
                let by = by.as_ref().map(|b| self.expr(b)).transpose()?;
                self.symbols.get_mut(s).assigned = true;
                CodeKind::For {
                    table,
                    from,
                    down: *down,
                    to,
                    by,
                    body: self.body(body, map)?,
                }
            }
            StmtKind::If(arms, otherwise) => {
                let mut checked = Vec::new();
                for (cond, body) in arms {
                    checked.push((self.expr(cond)?, self.body(body, map)?));
                }
                CodeKind::If(checked, self.body(otherwise, map)?)
            }
            StmtKind::Break(c, loops) => CodeKind::Break(self.optional(c.as_ref())?, *loops),
            StmtKind::Continue(c) => CodeKind::Continue(self.optional(c.as_ref())?),
            StmtKind::Display(c, items) => {
                CodeKind::Display(self.optional(c.as_ref())?, self.shown(items)?)
            }
            StmtKind::Abort {
                condition,
                items,
                no_error,
            } => CodeKind::Abort {
                condition: self.optional(condition.as_ref())?,
                items: self.shown(items)?,
                no_error: *no_error,
            },
            StmtKind::Option(items) => {
                for item in items {
                    if let Ok(Some(kind)) = self.option(item) {
                        out.push(Code::new(kind, span));
                    }
                }
                return Ok(());
            }
            StmtKind::Put(p) => self.put(p, span)?,
            StmtKind::Exchange(x) => {
                for (name, _) in &x.items {
                    let s = self.lookup(name)?;
                    if x.keyword.name.to_lowercase().contains("load")
                        && !x.keyword.name.to_lowercase().contains("unload")
                    {
                        self.symbols.get_mut(s).assigned = true;
                    }
                }
                CodeKind::Exchange(x.clone())
            }
            StmtKind::Refused(what) => {
                return self.fail(
                    Diagnostic::error("E0322", what.span, format!("`{}` is refused", what.name))
                        .label("runs another program")
                        .help("a model run by bmod reads and writes only its own files; prepare the data before, or use `$include`"),
                );
            }
            StmtKind::Draw(name, file) => {
                let s = self.lookup(name)?;
                if !matches!(self.symbols.get(s).kind, SymbolKind::Figure(_)) {
                    let declared = self.symbols.get(s).declared;
                    return self.fail(
                        Diagnostic::error(
                            "E0323",
                            name.span,
                            format!("`{}` is not a figure", name.name),
                        )
                        .label("a figure is expected")
                        .other(declared, "declared here"),
                    );
                }
                let file = match file.as_ref().map(|f| (&f.kind, f.span)) {
                    None => None,
                    Some((ExprKind::Text(t), _)) => Some(t.clone()),
                    Some((_, span)) => {
                        return self.fail(Diagnostic::error(
                            "E0323",
                            span,
                            "`draw` takes a file name in quotes",
                        ));
                    }
                };
                CodeKind::Draw(s, file)
            }
        };
        out.push(Code::new(kind, span));
        Ok(())
    }

    fn no_declaration(&mut self, stmt: &Stmt) -> Result<(), Failed> {
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
            | StmtKind::Figure(_) => "declaration",
            StmtKind::Equate(_) => "definition of an equation",
            _ => return Ok(()),
        };
        self.fail(
            Diagnostic::error(
                "E0324",
                stmt.span,
                format!("a {what} may not stand inside a loop or an if"),
            )
            .label("inside a loop or an if")
            .help("move it before the loop"),
        )
    }

    fn body(&mut self, body: &[Stmt], map: &SourceMap) -> Result<Vec<Code>, Failed> {
        self.nesting += 1;
        let mut out = Vec::new();
        let mut failed = false;
        for s in body {
            failed |= self.statement(s, map, &mut out).is_err();
        }
        self.nesting -= 1;
        if failed { Err(Failed) } else { Ok(out) }
    }

    fn optional(&mut self, e: Option<&Expr>) -> Result<Option<Node>, Failed> {
        e.map(|e| self.expr(e)).transpose()
    }

    fn assign(&mut self, a: &Assign) -> Result<CodeKind, Failed> {
        let t = &a.target;
        let counter = match t.name.name.to_lowercase().as_str() {
            "execseed" => Some(Target::Seed),
            "execerror" => Some(Target::Errors),
            "maxexecerror" | "heaplimit" => Some(Target::Ignored),
            _ => None,
        };
        if let Some(target) = counter
            && self.symbols.find(&t.name.name).is_none()
        {
            let value = self.expr(&a.value)?;
            return Ok(CodeKind::Assign {
                domain: Domain::default(),
                target,
                key: Key::default(),
                value,
                covers: false,
            });
        }
        let s = self.lookup(&t.name)?;
        self.shape(s, &t.indices);
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
            SymbolKind::Variable(_) | SymbolKind::Equation(_) => {
                let Some(attr) = &t.attribute else {
                    let what = symbol.kind_name();
                    let d = Diagnostic::error(
                        "E0310",
                        t.span,
                        format!(
                            "`{}` is a {what}; it cannot be assigned itself",
                            symbol.name
                        ),
                    )
                    .label("which of its numbers?")
                    .other(symbol.declared, "declared here");
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
                            "`{}` is a {} and cannot be assigned",
                            symbol.name,
                            symbol.kind_name()
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
        let r = self.scoped(|c| {
            let mut domain = Domain::default();
            let parts = match target {
                Target::Object(..) => Vec::new(),
                _ => c.control_key(&t.indices, s, t.span, &mut domain)?,
            };
            if let Some(cond) = &a.condition {
                c.condition(cond, &mut domain)?;
            }
            c.texts_allowed = matches!(target, Target::Object(..));
            let value = if is_set {
                c.set_expr(&a.value)
            } else {
                c.expr(&a.value)
            };
            c.texts_allowed = false;
            let value = value?;
            let covers = domain.conditions.is_empty()
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
            Ok(CodeKind::Assign {
                domain,
                target,
                key: Key { parts },
                value,
                covers,
            })
        })?;
        let sym = self.symbols.get_mut(root);
        sym.assigned = true;
        if is_set {
            sym.dynamic = true;
        }
        Ok(r)
    }

    fn equate(&mut self, e: &Equate, span: Span) -> Result<(), Failed> {
        let s = self.lookup(&e.name)?;
        self.shape(s, &e.indices);
        let symbol = self.symbols.get(s).clone();
        let SymbolKind::Equation(defined) = symbol.kind else {
            return self.fail(
                Diagnostic::error(
                    "E0326",
                    e.name.span,
                    format!(
                        "`{}` is a {}, not an equation",
                        symbol.name,
                        symbol.kind_name()
                    ),
                )
                .label("an equation is expected before `..`")
                .other(symbol.declared, "declared here")
                .help(format!("declare it: `equation {};`", e.name.name)),
            );
        };
        if let Some(d) = defined {
            let first = self.equations[d].span;
            if !self.modes.multi {
                return self.fail(
                    Diagnostic::error(
                        "E0327",
                        e.name.span,
                        format!("the equation `{}` is defined twice", symbol.name),
                    )
                    .label("second definition")
                    .other(first, "first definition")
                    .help("give the second one another name"),
                );
            }
        }
        self.in_equation = true;
        let r = self.scoped(|c| {
            let mut domain = Domain::default();
            let parts = c.control_key(&e.indices, s, e.name.span, &mut domain)?;
            if let Some(cond) = &e.condition {
                c.condition(cond, &mut domain)?;
            }
            let (left, right) = match (c.expr(&e.left), c.expr(&e.right)) {
                (Ok(l), Ok(r)) => (l, r),
                _ => return Err(Failed),
            };
            Ok(EquationDef {
                symbol: s,
                domain,
                key: Key { parts },
                left,
                relation: e.relation,
                right,
                span,
            })
        });
        self.in_equation = false;
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
        match r {
            Ok(def) => {
                self.equations.push(def);
                Ok(())
            }
            Err(Failed) => {
                let zero = || Node::number(0.0, span);
                self.equations.push(EquationDef {
                    symbol: s,
                    domain: Domain::default(),
                    key: Key::default(),
                    left: zero(),
                    relation: e.relation,
                    right: zero(),
                    span,
                });
                Err(Failed)
            }
        }
    }

    fn shown(&mut self, items: &[DisplayItem]) -> Result<Vec<Shown>, Failed> {
        let mut out = Vec::new();
        for item in items {
            match item {
                DisplayItem::Text(t, _) => out.push(Shown::Text(t.clone())),
                DisplayItem::Symbol(r) => {
                    let s = self.lookup(&r.name)?;
                    let symbol = self.symbols.get(s).clone();
                    if !r.indices.is_empty() {
                        return self.fail(
                            Diagnostic::error(
                                "E0328",
                                r.span,
                                "`display` takes whole symbols, without indices",
                            )
                            .label("indices here")
                            .help(format!(
                                "write `display {}`; or copy the part you want into a parameter",
                                r.name.name
                            )),
                        );
                    }
                    let attr = match (&symbol.kind, &r.attribute) {
                        (SymbolKind::Variable(_) | SymbolKind::Equation(_), Some(a)) => {
                            match display_attribute(&a.name) {
                                Some(a) => Some(a),
                                None => {
                                    return self.unknown_attribute(
                                        a,
                                        &symbol.name,
                                        symbol.kind_name(),
                                        "l, m, lo, up, scale, prior",
                                    );
                                }
                            }
                        }
                        (SymbolKind::Variable(_) | SymbolKind::Equation(_), None) => {
                            return self.fail(
                                Diagnostic::error(
                                    "E0310",
                                    r.span,
                                    format!(
                                        "`{}` is a {}; say which number to display",
                                        symbol.name,
                                        symbol.kind_name()
                                    ),
                                )
                                .label("an attribute is expected")
                                .help(format!("for instance `{}.l`", r.name.name)),
                            );
                        }
                        (SymbolKind::Model(_) | SymbolKind::File(_), Some(a)) => {
                            Some(self.object_attribute(s, a)?)
                        }
                        (_, Some(a)) => {
                            return self.unknown_attribute(
                                a,
                                &symbol.name,
                                symbol.kind_name(),
                                "none",
                            );
                        }
                        (_, None) => None,
                    };
                    if matches!(attr, None | Some("L" | "M")) {
                        self.used(s, r.span);
                    }
                    out.push(Shown::Symbol(s, attr));
                }
            }
        }
        Ok(out)
    }

    fn option(&mut self, item: &OptionItem) -> Result<Option<CodeKind>, Failed> {
        let lower = item.name.name.to_lowercase();
        match &item.form {
            OptionForm::Format(numbers) => {
                let s = self.lookup(&item.name)?;
                Ok(Some(CodeKind::Format(s, numbers.clone())))
            }
            OptionForm::Project {
                last,
                source,
                indices,
            } => self.project(item, *last, source, indices.as_deref()),
            OptionForm::Assign(OptionValue::Text(t, span))
                if lower == "clear" || lower == "kill" =>
            {
                let s = self.lookup(&Ident {
                    name: t.clone(),
                    span: *span,
                })?;
                Ok(Some(CodeKind::Clear(s)))
            }
            OptionForm::Assign(v) => {
                if !is_statement_option(&lower) && !OWN_OPTIONS.contains(&lower.as_str()) {
                    return self.unknown_option(item);
                }
                if let OptionValue::Text(t, span) = v
                    && functions::PROBLEM_TYPES.contains(&lower.as_str())
                    && !functions::SOLVERS.iter().any(|s| s.eq_ignore_ascii_case(t))
                {
                    let near = nearest(t, functions::SOLVERS.iter().copied()).map(str::to_string);
                    let d = Diagnostic::error("E0349", *span, format!("there is no solver `{t}`"))
                        .label("unknown solver");
                    return self.fail(match near {
                        Some(n) => d.help(format!("did you mean `{n}`?")),
                        None => d.help(
                            "bmod's own are clarabel (lp), pounce and ipopt (nlp), bmcp (mcp)",
                        ),
                    });
                }
                let value = match v {
                    OptionValue::Number(x) => OptionCode::Number(*x),
                    OptionValue::Text(t, _) => OptionCode::Text(t.clone()),
                };
                Ok(Some(CodeKind::Option(lower.into(), value)))
            }
            OptionForm::Flag => {
                if !OPTIONS.iter().any(|o| o.eq_ignore_ascii_case(&lower))
                    && !matches!(lower.as_str(), "dmpsym" | "eject" | "shut" | "stat")
                {
                    return self.unknown_option(item);
                }
                Ok(None)
            }
        }
    }

    fn unknown_option<T>(&mut self, item: &OptionItem) -> Result<T, Failed> {
        let known = [OPTIONS, OWN_OPTIONS, functions::PROBLEM_TYPES];
        let near = nearest(&item.name.name, known.into_iter().flatten().copied());
        let near = near.map(str::to_string);
        let d = Diagnostic::error(
            "E0329",
            item.name.span,
            format!("there is no option `{}`", item.name.name),
        )
        .label("unknown option");
        self.fail(match near {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d,
        })
    }

    fn project(
        &mut self,
        item: &OptionItem,
        last: bool,
        source: &Ident,
        source_indices: Option<&[Ident]>,
    ) -> Result<Option<CodeKind>, Failed> {
        let (t, s) = (self.lookup(&item.name)?, self.lookup(source)?);
        self.used(s, source.span);
        let (target, from) = (self.symbols.get(t).clone(), self.symbols.get(s).clone());
        let positions: Vec<usize> = match (&item.indices, source_indices) {
            (Some(a), Some(b)) => {
                let mut p = Vec::new();
                for name in a {
                    match b
                        .iter()
                        .position(|x| x.name.eq_ignore_ascii_case(&name.name))
                    {
                        Some(i) => p.push(i),
                        None => {
                            return self.fail(Diagnostic::error(
                                "E0331",
                                name.span,
                                format!("`{}` is not an index of the right side", name.name),
                            ));
                        }
                    }
                }
                p
            }
            _ => {
                // By domain: each position of the target takes the first unused position of the source with the
                // same set; by place, from the right, where the sets do not tell.
                let mut taken = vec![false; from.dim()];
                let mut p = Vec::new();
                for d in &target.domain {
                    let hit = (0..from.dim()).find(|&i| {
                        !taken[i] && from.domain[i] == *d && *d != DomainPosition::Universe
                    });
                    match hit {
                        Some(i) => {
                            taken[i] = true;
                            p.push(i);
                        }
                        None => {
                            p.clear();
                            break;
                        }
                    }
                }
                if p.len() != target.dim() {
                    let extra = from.dim().saturating_sub(target.dim());
                    p = (0..target.dim()).map(|i| i + extra).collect();
                }
                p
            }
        };
        if positions.len() != target.dim() || positions.iter().any(|&p| p >= from.dim()) {
            return self.fail(
                Diagnostic::error(
                    "E0331",
                    item.name.span,
                    "the right side has fewer positions than the left",
                )
                .other(target.declared, "left side declared here")
                .other(from.declared, "right side declared here"),
            );
        }
        let root = self.symbols.root(t);
        let symbol = self.symbols.get_mut(root);
        symbol.assigned = true;
        if symbol.is_set() {
            symbol.dynamic = true;
        }
        Ok(Some(CodeKind::Project {
            target: root,
            source: s,
            positions,
            count: !last,
        }))
    }

    fn put(&mut self, p: &Put, span: Span) -> Result<CodeKind, Failed> {
        let condition = self.optional(p.condition.as_ref())?;
        self.texts_allowed = true;
        let r = self.put_items(&p.items);
        self.texts_allowed = false;
        if let Ok(items) = &r {
            self.put_named |= items.iter().any(|i| matches!(i, PutCode::File(_)));
            if !self.put_named && !p.keyword.starts_with("put_util") {
                self.put_named = true;
                return self.fail(
                    Diagnostic::error("E0374", span, "no file is named to write to")
                        .label("which file?")
                        .help("declare one, `file out / 'out.txt' /;`, and name it first: `put out 'text' /;`"),
                );
            }
        }
        Ok(CodeKind::Put(p.keyword.clone(), condition, r?))
    }

    fn put_items(&mut self, items: &[PutItem]) -> Result<Vec<PutCode>, Failed> {
        let mut out = Vec::new();
        for item in items {
            let code = match item {
                PutItem::NewLine => PutCode::NewLine,
                PutItem::Column(e) => PutCode::Column(self.expr(e)?),
                PutItem::Row(e) => PutCode::Row(self.expr(e)?),
                PutItem::Item {
                    value,
                    align,
                    width,
                    decimals,
                } => {
                    if let ExprKind::Apply {
                        name,
                        attribute,
                        arguments: None,
                    } = &value.kind
                    {
                        if name.name.eq_ignore_ascii_case("system") {
                            let what = attribute.as_ref().map_or("", |a| &*a.name).to_lowercase();
                            let value = Node::data(
                                NodeKind::Text(format!("%system.{what}%").into()),
                                value.span,
                            );
                            out.push(PutCode::Item {
                                value,
                                align: *align,
                                width: self.optional(width.as_ref())?,
                                decimals: self.optional(decimals.as_ref())?,
                            });
                            continue;
                        }
                        if let (Some(s), None) = (self.file(name), attribute) {
                            out.push(PutCode::File(s));
                            continue;
                        }
                    }
                    let mut value = value;
                    // `put out (a + b)` reads like a symbol with an index.
                    if let ExprKind::Apply {
                        name,
                        attribute: None,
                        arguments: Some(arguments),
                    } = &value.kind
                        && let [one] = arguments.as_slice()
                        && let Some(s) = self.file(name)
                    {
                        out.push(PutCode::File(s));
                        value = one;
                    }
                    PutCode::Item {
                        value: self.expr(value)?,
                        align: *align,
                        width: self.optional(width.as_ref())?,
                        decimals: self.optional(decimals.as_ref())?,
                    }
                }
            };
            out.push(code);
        }
        Ok(out)
    }

    /// The file of this name, if it is one.
    fn file(&self, name: &Ident) -> Option<SymbolId> {
        let s = self.symbols.find(&name.name)?;
        matches!(self.symbols.get(s).kind, SymbolKind::File(_)).then_some(s)
    }

    fn declare_figure(&mut self, f: &ast::Figure) -> Result<(), Failed> {
        self.texts_allowed = true;
        let mut elements = Vec::new();
        let mut failed = false;
        for e in &f.elements {
            match self.scoped(|c| c.figure_element(e)) {
                Ok(x) => elements.push(x),
                Err(Failed) => failed = true,
            }
        }
        self.texts_allowed = false;
        let kind = SymbolKind::Figure(Rc::new(FigureCode {
            title: f.title.clone(),
            elements,
        }));
        self.declare_plain(&f.name, kind, f.title.as_deref())?;
        if failed { Err(Failed) } else { Ok(()) }
    }

    fn figure_element(&mut self, e: &ast::FigureElement) -> Result<FigureElementCode, Failed> {
        let kind = e.kind.name.to_lowercase();
        if !super::figure::kinds().any(|k| k == kind) {
            let d = Diagnostic::error(
                "E0332",
                e.kind.span,
                format!("a figure has no element `{}`", e.kind.name),
            )
            .label("unknown element");
            return self.fail(match nearest(&kind, super::figure::kinds()) {
                Some(n) => d.help(format!("did you mean `{n}`?")),
                None => d.help(format!(
                    "there are: {}",
                    super::figure::kinds().collect::<Vec<_>>().join(", ")
                )),
            });
        }
        // The levels and data that a figure shows need not be there when it is declared.
        self.in_equation = true;
        let r = (|| {
            let domain = e.domain.as_ref().map(|d| self.domain(d)).transpose()?;
            let mut arguments = Vec::new();
            for (name, value) in &e.arguments {
                // A bare word that names nothing is a word: `fill = none`.
                let node = match &value.kind {
                    ExprKind::Apply {
                        name: word,
                        attribute: None,
                        arguments: None,
                    } if self.symbols.find(&word.name).is_none() => {
                        Node::data(NodeKind::Text(word.name.clone()), value.span)
                    }
                    _ => self.expr(value)?,
                };
                if node.has_var {
                    return self.fail(
                        Diagnostic::error(
                            "E0310",
                            node.span,
                            "a variable is not a number; a figure shows its level",
                        )
                        .label("which of its numbers?")
                        .help("write `.l` behind the variable's name"),
                    );
                }
                arguments.push((name.as_ref().map(|n| n.name.to_lowercase().into()), node));
            }
            let code = FigureElementCode {
                kind: kind.into(),
                domain,
                arguments,
                span: e.span,
            };
            self.figure_arguments(e, &code)?;
            Ok(code)
        })();
        self.in_equation = false;
        r
    }
}

/// Attribute as `display` shows it.
fn display_attribute(name: &str) -> Option<&'static str> {
    Some(match name.to_lowercase().as_str() {
        "l" => "L",
        "m" => "M",
        "lo" => "Lo",
        "up" => "Up",
        "scale" => "Scale",
        "prior" => "Prior",
        "stage" => "Stage",
        "slack" => "Slack",
        "slacklo" => "SlackLo",
        "slackup" => "SlackUp",
        "infeas" => "Infeas",
        "range" => "Range",
        _ => return None,
    })
}

/// Offset of an attribute table by the name that `display` shows.
pub fn shown_offset(attr: &str) -> Option<u32> {
    Some(match attr {
        "L" => attribute::L,
        "M" => attribute::M,
        "Lo" => attribute::LO,
        "Up" => attribute::UP,
        "Scale" => attribute::SCALE,
        "Prior" => attribute::PRIOR,
        "Stage" => attribute::STAGE,
        _ => return None,
    })
}
