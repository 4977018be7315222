//! Expressions, indices and domains: from names to slots and tables.

use super::functions::{self, Callee};
use super::node::*;
use super::symbols::{DomainPosition, SymbolKind, UNIVERSE, attribute};
use super::{Compiler, Failed};
use crate::data::value;
use crate::diag::{Diagnostic, nearest};
use crate::source::Span;
use crate::syntax::ast::{self, Expr, ExprKind, Factor, Ident, Sign, UnaryOp};
use std::rc::Rc;

impl Node {
    /// A node without variables.
    pub fn data(kind: NodeKind, span: Span) -> Node {
        Node {
            kind,
            span,
            has_var: false,
            linear: true,
        }
    }

    /// A number.
    pub fn number(x: f64, span: Span) -> Node {
        Node::data(NodeKind::Const(x), span)
    }
}

/// Builds a node of children: whether variables stand in it, and whether it is linear if they do.
fn combine(kind: NodeKind, span: Span, has_var: bool, linear: bool) -> Node {
    Node {
        kind,
        span,
        has_var,
        linear: linear || !has_var,
    }
}

impl Compiler {
    pub(super) fn fail<T>(&mut self, d: Diagnostic) -> Result<T, Failed> {
        self.report(d);
        Err(Failed)
    }

    /// The symbol of a name, or an "unknown symbol" error with the nearest name.
    pub(super) fn lookup(&mut self, id: &Ident) -> Result<SymbolId, Failed> {
        if let Some(s) = self.symbols.find(&id.name) {
            return Ok(s);
        }
        let near = nearest(&id.name, self.symbols.iter().skip(1).map(|(_, s)| &*s.name))
            .map(str::to_string);
        let d = Diagnostic::error("E0301", id.span, format!("`{}` is not known", id.name))
            .label("unknown symbol");
        self.fail(match near {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d.help(
                "declare it first: names must be declared above the place where they are used",
            ),
        })
    }

    /// A set by name.
    pub(super) fn lookup_set(&mut self, id: &Ident) -> Result<SymbolId, Failed> {
        if &*id.name == "*" {
            return Ok(UNIVERSE);
        }
        let s = self.lookup(id)?;
        if self.symbols.get(s).is_set() {
            return Ok(s);
        }
        let (kind, declared) = (
            self.symbols.get(s).kind_name(),
            self.symbols.get(s).declared,
        );
        self.fail(
            Diagnostic::error("E0302", id.span, format!("`{}` is a {kind}; a set is expected here", id.name))
                .label("not a set")
                .other(declared, format!("declared as a {kind} here"))
                .help("an index position takes a set that is under control, a quoted label, or a lag such as `t-1`"),
        )
    }

    /// What a set that is under control stands for: running indices, or what pins it, `loop(i('a'), …)`.
    pub(super) fn controlled(&self, set: SymbolId) -> Option<&[Part]> {
        self.scope
            .iter()
            .rev()
            .find(|(s, _)| *s == set)
            .map(|(_, parts)| parts.as_slice())
    }

    pub(super) fn new_slot(&mut self) -> Slot {
        let s = self.next_slot;
        self.next_slot += 1;
        self.slots = self.slots.max(self.next_slot as usize);
        s
    }

    /// Runs `f` and forgets what it put under control. Slots are not used again within a statement:
    /// the planner relies on different sums having different slots.
    pub(super) fn scoped<T>(&mut self, f: impl FnOnce(&mut Self) -> T) -> T {
        let scope = self.scope.len();
        let r = f(self);
        self.scope.truncate(scope);
        r
    }

    /// Takes a domain and puts its indices under control (until the caller's scope ends).
    pub(super) fn domain(&mut self, d: &ast::Domain) -> Result<Domain, Failed> {
        let mut out = Domain::default();
        for item in &d.items {
            if item.local {
                let id = self.lookup_set(&item.set)?;
                self.used(id, item.set.span);
                self.run_over(id, &mut out);
            } else if let Some(indices) = &item.indices
                && item.set.name.eq_ignore_ascii_case("sameas")
            {
                self.equal_item(indices, item.span, &mut out)?;
            } else {
                self.domain_item(&item.set, item.indices.as_deref(), item.span, &mut out)?;
            }
        }
        if let Some(c) = &d.condition {
            self.condition(c, &mut out)?;
        }
        Ok(out)
    }

    /// Adds the conjuncts of a condition to a domain.
    pub(super) fn condition(&mut self, c: &Expr, out: &mut Domain) -> Result<(), Failed> {
        if let ExprKind::Binary(BinaryOp::And, a, b) = &c.kind {
            self.condition(a, out)?;
            return self.condition(b, out);
        }
        let node = self.expr(c)?;
        self.no_variable(&node, "a condition")?;
        out.conditions.push(node);
        Ok(())
    }

    fn no_variable(&mut self, node: &Node, place: &str) -> Result<(), Failed> {
        if !node.has_var {
            return Ok(());
        }
        self.fail(
            Diagnostic::error(
                "E0311",
                node.span,
                format!("{place} may not depend on a variable"),
            )
            .label("a variable stands in it")
            .help("use the level of the last solve (`x.l`), a parameter, or a binary formulation"),
        )
    }

    /// One item of a domain: controls what is not controlled yet; returns its key parts.
    pub(super) fn domain_item(
        &mut self,
        set: &Ident,
        indices: Option<&[Expr]>,
        span: Span,
        out: &mut Domain,
    ) -> Result<Vec<Part>, Failed> {
        let id = self.lookup_set(set)?;
        self.used(id, set.span);
        match indices {
            Some(i) => self.shape(id, i),
            None => self.symbols.get_mut(id).open = false,
        }
        let symbol = self.symbols.get(id).clone();
        let Some(indices) = indices else {
            if self.controlled(id).is_some() {
                return self.fail(
                    Diagnostic::error("E0305", span, format!("`{}` is under control already", set.name))
                        .label("controlled a second time here")
                        .help(format!(
                            "use an alias for the inner index: `alias({0},{0}2);` and write `{0}2` here",
                            symbol.name
                        )),
                );
            }
            return Ok(self.run_over(id, out));
        };
        let parts = self.control_key(indices, id, span, out)?;
        out.members.push(Driver {
            table: symbol.table,
            key: Key {
                parts: parts.clone(),
            },
        });
        if self.controlled(id).is_none() {
            self.scope.push((id, parts.clone()));
        }
        Ok(parts)
    }

    /// `sum(sameas(i,j), …)`: a set that is not under control yet takes the element of the other.
    fn equal_item(&mut self, indices: &[Expr], span: Span, out: &mut Domain) -> Result<(), Failed> {
        let [a, b] = indices else {
            return self.fail(Diagnostic::error(
                "E0317",
                span,
                "`sameas` compares two single indices",
            ));
        };
        let free = |c: &Self, e: &Expr| match &e.kind {
            ExprKind::Apply {
                name,
                attribute: None,
                arguments: None,
            } => c.symbols.find(&name.name).filter(|&s| {
                let set = c.symbols.get(s);
                set.is_set() && set.dim() == 1 && c.controlled(s).is_none()
            }),
            _ => None,
        };
        let (first, second) = if free(self, b).is_some() {
            (a, b)
        } else {
            (b, a)
        };
        let one = match &first.kind {
            ExprKind::Text(t) => vec![Part::Label(self.store.universe.intern(t))],
            _ => self.control_index(first, UNIVERSE, 0, out)?,
        };
        match free(self, second) {
            Some(s) => {
                self.used(s, second.span);
                out.members.push(Driver {
                    table: self.symbols.get(s).table,
                    key: Key { parts: one.clone() },
                });
                self.scope.push((s, one));
            }
            None => {
                let other = self.index(second, UNIVERSE, 0)?;
                if let ([p], [q]) = (one.as_slice(), other.as_slice()) {
                    let same = NodeKind::SameAs(p.clone(), q.clone());
                    out.conditions.push(Node::data(same, span));
                }
            }
        }
        Ok(())
    }

    /// Puts a set under control with indices of its own, whether or not it is under control outside.
    fn run_over(&mut self, id: SymbolId, out: &mut Domain) -> Vec<Part> {
        let symbol = self.symbols.get(id).clone();
        let dim = symbol.dim();
        let slots: Vec<Slot> = (0..dim).map(|_| self.new_slot()).collect();
        for (p, &s) in slots.iter().enumerate() {
            out.slots.push(s);
            out.sets.push(if dim == 1 {
                symbol.table
            } else {
                match symbol.domain[p] {
                    DomainPosition::Set(d) => self.symbols.get(d).table,
                    _ => self.symbols.get(UNIVERSE).table,
                }
            });
        }
        let parts: Vec<Part> = slots.into_iter().map(Part::Slot).collect();
        out.members.push(Driver {
            table: symbol.table,
            key: Key {
                parts: parts.clone(),
            },
        });
        self.scope.push((id, parts.clone()));
        parts
    }

    /// An index that is put under control if it is a set that is not yet.
    pub(super) fn control_index(
        &mut self,
        index: &Expr,
        of: SymbolId,
        position: usize,
        out: &mut Domain,
    ) -> Result<Vec<Part>, Failed> {
        match &index.kind {
            ExprKind::Apply {
                name,
                attribute: Some(a),
                arguments: None,
            } if a.name.eq_ignore_ascii_case("local") => {
                let s = self.lookup_set(name)?;
                self.used(s, name.span);
                if self.symbols.get(s).dim() == 1 {
                    self.fits(s, of, position, index.span)?;
                }
                Ok(self.run_over(s, out))
            }
            ExprKind::Apply {
                name,
                attribute: None,
                arguments: None,
            } => {
                let free = self.symbols.find(&name.name).filter(|&s| {
                    let singleton = matches!(
                        self.symbols.get(self.symbols.root(s)).kind,
                        SymbolKind::Set { singleton: true }
                    );
                    self.symbols.get(s).is_set() && !singleton && self.controlled(s).is_none()
                });
                match free {
                    Some(s) => {
                        self.fits(s, of, position, index.span)?;
                        self.domain_item(name, None, index.span, out)
                    }
                    None => self.index(index, of, position),
                }
            }
            ExprKind::Apply {
                name,
                attribute: None,
                arguments: Some(inner),
            } if self
                .symbols
                .find(&name.name)
                .is_some_and(|s| self.symbols.get(s).is_set()) =>
            {
                let s = self.lookup_set(name)?;
                if self.symbols.get(s).dim() == 1 {
                    self.fits(s, of, position, index.span)?;
                }
                self.domain_item(name, Some(inner), index.span, out)
            }
            _ => self.index(index, of, position),
        }
    }

    /// The key of a symbol whose indices are put under control if they are not yet: `f(t+1)..`,
    /// `w(m+k(n),n) = …`. Lags come last: how far one goes may depend on any of the indices.
    pub(super) fn control_key(
        &mut self,
        indices: &[Expr],
        of: SymbolId,
        span: Span,
        out: &mut Domain,
    ) -> Result<Vec<Part>, Failed> {
        let dim = self.symbols.get(of).dim();
        let mut parts: Vec<Vec<Part>> = Vec::with_capacity(indices.len());
        let mut lags = Vec::new();
        let mut position = 0;
        for (n, index) in indices.iter().enumerate() {
            if position >= dim {
                return self.wrong_dimension(of, span, indices.len());
            }
            let base = match &index.kind {
                ExprKind::Sum(terms) => match terms.first() {
                    Some((Sign::Plus, base)) => Some(base),
                    _ => None,
                },
                ExprKind::Binary(BinaryOp::CircularPlus | BinaryOp::CircularMinus, base, _) => {
                    Some(&**base)
                }
                _ => None,
            };
            let here = match base {
                Some(base) => {
                    self.control_lag_base(base, out)?;
                    lags.push((n, position));
                    position += 1;
                    Vec::new()
                }
                None => self.control_index(index, of, position, out)?,
            };
            position += here.len();
            parts.push(here);
        }
        for (n, position) in lags {
            parts[n] = self.index(&indices[n], of, position)?;
        }
        let parts = parts.concat();
        if parts.len() != dim {
            return self.wrong_dimension(of, span, parts.len().max(indices.len()));
        }
        Ok(parts)
    }

    fn control_lag_base(&mut self, base: &Expr, out: &mut Domain) -> Result<(), Failed> {
        if let ExprKind::Apply {
            name,
            attribute: None,
            arguments: None,
        } = &base.kind
        {
            let free = self
                .symbols
                .find(&name.name)
                .filter(|&s| self.symbols.get(s).is_set() && self.controlled(s).is_none());
            if free.is_some() {
                self.domain_item(name, None, base.span, out)?;
            }
        }
        Ok(())
    }

    /// Whether set `a` may stand at a position of symbol `of`.
    fn fits(
        &mut self,
        a: SymbolId,
        of: SymbolId,
        position: usize,
        span: Span,
    ) -> Result<(), Failed> {
        let DomainPosition::Set(d) = self.symbols.get(of).domain[position] else {
            return Ok(());
        };
        if self.modes.universal || self.symbols.is_subset(a, d) || self.symbols.get(a).dim() > 1 {
            return Ok(());
        }
        let (an, dn) = (
            self.symbols.get(a).name.clone(),
            self.symbols.get(d).name.clone(),
        );
        let (on, declared) = (
            self.symbols.get(of).name.clone(),
            self.symbols.get(of).declared,
        );
        let a_root = self.symbols.get(self.symbols.root(a)).declared;
        let same = self.symbols.is_subset(d, a);
        let help = if same {
            format!(
                "`{dn}` is the smaller set: use an index that runs over `{dn}`, or declare `{on}` over `{an}`"
            )
        } else {
            format!(
                "declare `{an}` as a subset (`set {an}({dn})`) or as an alias of `{dn}`; equal labels alone do not make it one"
            )
        };
        self.fail(
            Diagnostic::error(
                "E0306",
                span,
                format!(
                    "`{an}` may not stand at position {} of `{on}`, which runs over `{dn}`",
                    position + 1
                ),
            )
            .label(format!("`{an}` is not a subset of `{dn}`"))
            .other(declared, format!("`{on}` is declared here"))
            .other(a_root, format!("`{an}` is declared here"))
            .help(help),
        )
    }

    pub(super) fn wrong_dimension<T>(
        &mut self,
        of: SymbolId,
        span: Span,
        given: usize,
    ) -> Result<T, Failed> {
        let s = self.symbols.get(of).clone();
        let plural = |n: usize| match n {
            0 => "no index".to_string(),
            1 => "1 index".to_string(),
            n => format!("{n} indices"),
        };
        let names: Vec<String> = s
            .domain
            .iter()
            .map(|d| match d {
                DomainPosition::Universe => "*".to_string(),
                DomainPosition::Set(i) => self.symbols.get(*i).name.to_string(),
                DomainPosition::Relaxed(n) => n.to_string(),
            })
            .collect();
        let shape = if names.is_empty() {
            s.name.to_string()
        } else {
            format!("{}({})", s.name, names.join(","))
        };
        self.fail(
            Diagnostic::error(
                "E0304",
                span,
                format!(
                    "`{}` has {}, but {} given here",
                    s.name,
                    plural(s.dim()),
                    match given {
                        0 => "none is".to_string(),
                        1 => "1 is".to_string(),
                        n => format!("{n} are"),
                    }
                ),
            )
            .label(format!("{} here", plural(given)))
            .other(
                s.declared,
                format!("declared with {} here", plural(s.dim())),
            )
            .help(format!("write `{shape}`")),
        )
    }

    /// A symbol that was declared without a domain gets as many indices as its first use has.
    pub(super) fn shape(&mut self, s: SymbolId, indices: &[Expr]) {
        if !self.symbols.get(s).open {
            return;
        }
        if indices.is_empty() {
            // The first use says that it has none.
            self.symbols.get_mut(s).open = false;
            return;
        }
        // A tuple set stands for all its positions.
        let positions = |e: &Expr| match &e.kind {
            ExprKind::Apply {
                name,
                attribute: None,
                ..
            } => self
                .symbols
                .find(&name.name)
                .map(|i| self.symbols.get(i))
                .filter(|i| i.is_set())
                .map_or(1, |i| i.dim()),
            _ => 1,
        };
        let dim: usize = indices.iter().map(positions).sum();
        self.symbols.get_mut(s).open = false;
        if dim <= 20 {
            self.reshape(s, dim);
        }
    }

    /// Gives a symbol without data another number of indices.
    pub(super) fn reshape(&mut self, s: SymbolId, dim: usize) {
        let symbol = self.symbols.get_mut(s);
        symbol.domain = vec![DomainPosition::Universe; dim];
        let first = symbol.table;
        let tables = match symbol.kind {
            SymbolKind::Variable(_) | SymbolKind::Equation(_) => attribute::COUNT,
            _ => 1,
        };
        for t in first..first + tables {
            let default = self.store.table(t).default_value();
            *self.store.table_mut(t) = crate::data::table::Table::new(dim, default);
        }
    }

    /// Key of a symbol from its indices, all of which are under control.
    pub(super) fn key(
        &mut self,
        of: SymbolId,
        indices: &[Expr],
        span: Span,
    ) -> Result<Key, Failed> {
        self.shape(of, indices);
        let dim = self.symbols.get(of).dim();
        // A tuple set under control stands for all its positions: `p(arc)`.
        let mut parts = Vec::with_capacity(dim);
        for index in indices {
            if parts.len() >= dim {
                return self.wrong_dimension(of, span, indices.len());
            }
            let p = parts.len();
            parts.extend(self.index(index, of, p)?);
        }
        if parts.len() != dim {
            return self.wrong_dimension(of, span, parts.len().max(indices.len()));
        }
        Ok(Key { parts })
    }

    /// One index expression at a position of a symbol.
    pub(super) fn index(
        &mut self,
        e: &Expr,
        of: SymbolId,
        position: usize,
    ) -> Result<Vec<Part>, Failed> {
        match &e.kind {
            ExprKind::Text(label) => Ok(vec![Part::Label(self.label(label, of, position, e.span)?)]),
            ExprKind::Apply { name, attribute: None, arguments: None } => {
                let Some(s) = self.symbols.find(&name.name) else {
                    return self.unknown_index(name);
                };
                if !self.symbols.get(s).is_set() {
                    self.lookup_set(name)?;
                }
                let part = self.set_index(s, name)?;
                if self.symbols.get(s).dim() == 1 {
                    self.fits(s, of, position, e.span)?;
                }
                Ok(part)
            }
            ExprKind::Apply { name, attribute: None, arguments: Some(inner) } => {
                // p(arc(i,j)): all controlled.
                let s = self.lookup_set(name)?;
                let key = self.key(s, inner, e.span)?;
                Ok(key.parts)
            }
            ExprKind::Sum(terms) => self.lag(e, terms, of, position),
            ExprKind::Binary(op @ (BinaryOp::CircularPlus | BinaryOp::CircularMinus), base, offset) => {
                let (base_part, set) = self.lag_base(base, of, position)?;
                let mut offset = self.expr(offset)?;
                if *op == BinaryOp::CircularMinus {
                    let span = offset.span;
                    offset = Node::data(NodeKind::Negate(Box::new(offset)), span);
                }
                Ok(vec![Part::Lag(Rc::new(Lag { base: base_part, set, offset, circular: true }))])
            }
            ExprKind::Number(x) => {
                let text = x.to_string();
                self.fail(
                    Diagnostic::error("E0307", e.span, "a number may not stand as an index")
                        .label("an index is expected")
                        .help(format!("if `{text}` is a label, quote it: `'{text}'`")),
                )
            }
            _ => self.fail(
                Diagnostic::error("E0307", e.span, "this is not an index")
                    .label("an index is expected")
                    .help("an index is a set under control, a quoted label, or a lag such as `t-1` or `t++1`"),
            ),
        }
    }

    fn unknown_index<T>(&mut self, name: &Ident) -> Result<T, Failed> {
        if self.store.universe.get(&name.name).is_some() {
            return self.fail(
                Diagnostic::error(
                    "E0301",
                    name.span,
                    format!("`{}` is not a set, but it is a label", name.name),
                )
                .label("unknown set")
                .help(format!("quote labels in expressions: `'{}'`", name.name)),
            );
        }
        self.lookup(name).and(Err(Failed))
    }

    /// A set name as an index: its slots, or the element of a singleton.
    fn set_index(&mut self, s: SymbolId, name: &Ident) -> Result<Vec<Part>, Failed> {
        if let Some(parts) = self.controlled(s) {
            return Ok(parts.to_vec());
        }
        let root = self.symbols.get(self.symbols.root(s));
        if matches!(root.kind, SymbolKind::Set { singleton: true }) {
            let (t, dim) = (root.table, root.dim());
            return Ok((0..dim).map(|p| Part::Singleton(t, p as u8)).collect());
        }
        let (declared, is_label) = (root.declared, self.store.universe.get(&name.name).is_some());
        let mut help = format!(
            "let it run: in a sum, `sum({0}, …)`; on the left of an assignment; in the equation's domain; or in `loop({0}, …)`",
            name.name
        );
        if is_label {
            help.push_str(&format!("; a label is quoted: `'{}'`", name.name));
        }
        self.fail(
            Diagnostic::error(
                "E0303",
                name.span,
                format!("the index `{}` is not under control here", name.name),
            )
            .label("nothing lets it run")
            .other(declared, "the set is declared here")
            .help(help),
        )
    }

    /// A quoted label at a position of a symbol.
    pub(super) fn label(
        &mut self,
        text: &str,
        of: SymbolId,
        position: usize,
        span: Span,
    ) -> Result<u32, Failed> {
        let symbol = self.symbols.get(of);
        let DomainPosition::Set(d) = symbol
            .domain
            .get(position)
            .cloned()
            .unwrap_or(DomainPosition::Universe)
        else {
            return Ok(self.store.universe.intern(text));
        };
        let set = self.symbols.get(self.symbols.root(d));
        let known = self.store.universe.get(text);
        if let Some(l) = known
            && (set.dynamic || self.store.table(set.table).find(&[l]).is_some())
        {
            return Ok(l);
        }
        let (name, set_name, declared) = (symbol.name.clone(), set.name.clone(), set.declared);
        let table = self.store.table(set.table);
        let near = {
            let all = table.len().min(10_000) as u32;
            nearest(
                text,
                (0..all).map(|r| self.store.universe.name(table.key(r)[0])),
            )
            .map(str::to_string)
        };
        let d = Diagnostic::error(
            "E0308",
            span,
            format!("`'{text}'` is not a member of the set `{set_name}`"),
        )
        .label(format!(
            "position {} of `{name}` runs over `{set_name}`",
            position + 1
        ))
        .other(declared, format!("`{set_name}` is declared here"));
        self.fail(match near {
            Some(n) => d.help(format!("did you mean `'{n}'`?")),
            None => d.help(format!(
                "add it to the set, or use a label that `{set_name}` has"
            )),
        })
    }

    fn lag_base(
        &mut self,
        base: &Expr,
        of: SymbolId,
        position: usize,
    ) -> Result<(Part, TableId), Failed> {
        match &base.kind {
            ExprKind::Apply {
                name,
                attribute: None,
                arguments: None,
            } => {
                let Some(s) = self.symbols.find(&name.name) else {
                    return self.unknown_index(name);
                };
                if !self.symbols.get(s).is_set() {
                    self.lookup_set(name)?;
                }
                let mut part = self.set_index(s, name)?;
                self.ordered(s, name.span, "a lag or lead")?;
                self.fits(s, of, position, base.span)?;
                let table = self.symbols.get(s).table;
                match part.len() {
                    1 => Ok((part.remove(0), table)),
                    _ => self.fail(
                        Diagnostic::error("E0307", base.span, "a lag needs a one-dimensional set")
                            .label("several indices"),
                    ),
                }
            }
            ExprKind::Text(label) => self.fail(
                Diagnostic::error(
                    "E0309",
                    base.span,
                    format!("the label `'{label}'` takes no lag or lead"),
                )
                .label("a label is one element")
                .help("write the label you mean, or use an index that runs"),
            ),
            _ => self.fail(
                Diagnostic::error("E0307", base.span, "this is not an index")
                    .label("an index is expected")
                    .help("a lag or lead starts from a set under control: `t-1`, `t+k`, `t++1`"),
            ),
        }
    }

    /// `t-1`, `t+k`.
    fn lag(
        &mut self,
        e: &Expr,
        terms: &[(Sign, Expr)],
        of: SymbolId,
        position: usize,
    ) -> Result<Vec<Part>, Failed> {
        let (base, set) = self.lag_base(&terms[0].1, of, position)?;
        if terms.len() > 2 {
            return self.fail(
                Diagnostic::error("E0309", e.span, "an index takes one lag or lead")
                    .label("several")
                    .help("put the sum into parentheses: `t+(k+1)`"),
            );
        }
        let mut offset = Vec::new();
        for (sign, t) in &terms[1..] {
            offset.push((*sign == Sign::Minus, self.expr(t)?));
        }
        let offset = match offset.len() {
            1 if !offset[0].0 => offset.remove(0).1,
            _ => Node::data(NodeKind::Sum(offset), e.span),
        };
        self.no_variable(&offset, "a lag")?;
        Ok(vec![Part::Lag(Rc::new(Lag {
            base,
            set,
            offset,
            circular: false,
        }))])
    }

    /// An error unless the set has an order.
    fn ordered(&mut self, s: SymbolId, span: Span, what: &str) -> Result<(), Failed> {
        if self.modes.off_order {
            return Ok(());
        }
        let root = self.symbols.get(self.symbols.root(s));
        let (declared, name) = (root.declared, root.name.clone());
        if matches!(root.kind, SymbolKind::Set { singleton: true }) {
            return self.fail(
                Diagnostic::error(
                    "E0309",
                    span,
                    format!("{what} needs an ordered set; `{name}` is a singleton"),
                )
                .other(declared, "declared here"),
            );
        }
        if root.dynamic {
            return self.fail(
                Diagnostic::error(
                    "E0309",
                    span,
                    format!("{what} needs an ordered set; `{name}` is changed by an assignment"),
                )
                .label("a dynamic set has no order")
                .other(declared, "declared here")
                .help("use the set that it is a subset of, or `$offOrder`"),
            );
        }
        if root.unordered {
            return self.fail(
                Diagnostic::error(
                    "E0309",
                    span,
                    format!("{what} needs an ordered set; the labels of `{name}` appeared earlier in another order"),
                )
                .label("not ordered")
                .other(declared, "declared here")
                .help("declare the set with its labels in the wanted order before they appear elsewhere"),
            );
        }
        Ok(())
    }

    /// An expression.
    pub(super) fn expr(&mut self, e: &Expr) -> Result<Node, Failed> {
        let span = e.span;
        match &e.kind {
            ExprKind::Number(x) => Ok(Node::number(*x, span)),
            ExprKind::Text(t) => {
                if !self.texts_allowed {
                    return self.fail(
                        Diagnostic::error("E0312", span, "a text may not stand in an expression")
                            .label("a number is expected")
                            .help("texts belong into `display`, `put`, `abort`, or in quotes as an index"),
                    );
                }
                Ok(Node::data(NodeKind::Text(t.clone()), span))
            }
            ExprKind::Apply {
                name,
                attribute,
                arguments,
            } => self.apply(name, attribute.as_ref(), arguments.as_deref(), span),
            ExprKind::Unary(op, a) => {
                let a = self.expr(a)?;
                Ok(match (op, &a.kind) {
                    (UnaryOp::Plus, _) => a,
                    (UnaryOp::Minus, NodeKind::Const(x)) if !x.is_nan() => Node::number(-x, span),
                    (UnaryOp::Minus, _) => {
                        let (v, l) = (a.has_var, a.linear);
                        combine(NodeKind::Negate(Box::new(a)), span, v, l)
                    }
                    (UnaryOp::Not, _) => {
                        let v = a.has_var;
                        combine(NodeKind::Not(Box::new(a)), span, v, false)
                    }
                })
            }
            ExprKind::Sum(terms) => {
                let mut out = Vec::with_capacity(terms.len());
                let mut failed = false;
                for (sign, t) in terms {
                    match self.expr(t) {
                        Ok(n) => out.push((*sign == Sign::Minus, n)),
                        Err(Failed) => failed = true,
                    }
                }
                if failed {
                    return Err(Failed);
                }
                let v = out.iter().any(|(_, n)| n.has_var);
                let l = out.iter().all(|(_, n)| n.linear);
                Ok(combine(NodeKind::Sum(out), span, v, l))
            }
            ExprKind::Product(factors) => {
                let mut out = Vec::with_capacity(factors.len());
                for (f, x) in factors {
                    let node = self.expr(x)?;
                    out.push(match f {
                        Factor::Divide => divisor(x, node),
                        Factor::Multiply => (false, node),
                    });
                }
                Ok(product(out, span))
            }
            ExprKind::Binary(BinaryOp::Divide, a, right) => {
                let (Ok(x), Ok(y)) = (self.expr(a), self.expr(right)) else {
                    return Err(Failed);
                };
                Ok(product(vec![(false, x), divisor(right, y)], span))
            }
            ExprKind::Binary(op, a, b) => {
                let (a, b) = match (self.expr(a), self.expr(b)) {
                    (Ok(a), Ok(b)) => (a, b),
                    _ => return Err(Failed),
                };
                Ok(match op {
                    BinaryOp::Add | BinaryOp::Subtract => {
                        let (v, l) = (a.has_var || b.has_var, a.linear && b.linear);
                        combine(
                            NodeKind::Sum(vec![(false, a), (*op == BinaryOp::Subtract, b)]),
                            span,
                            v,
                            l,
                        )
                    }
                    BinaryOp::Multiply => product(vec![(false, a), (false, b)], span),
                    BinaryOp::CircularPlus | BinaryOp::CircularMinus => {
                        return self.fail(
                            Diagnostic::error(
                                "E0313",
                                span,
                                "`++` and `--` stand between an index and a number only",
                            )
                            .label("not in an index position")
                            .help("two operators in a row need parentheses: `a - (-b)`"),
                        );
                    }
                    _ => {
                        let v = a.has_var || b.has_var;
                        combine(
                            NodeKind::Binary(*op, Box::new(a), Box::new(b)),
                            span,
                            v,
                            false,
                        )
                    }
                })
            }
            ExprKind::Dollar(a, c) => {
                let c = self.expr(c)?;
                self.no_variable(&c, "a `$` condition")?;
                let a = self.expr(a)?;
                let (v, l) = (a.has_var, a.linear);
                Ok(combine(
                    NodeKind::Dollar(Box::new(a), Box::new(c)),
                    span,
                    v,
                    l,
                ))
            }
            ExprKind::Aggregate(op, d, body) => self.scoped(|c| {
                let domain = c.domain(d)?;
                let body = c.expr(body)?;
                let (v, l) = (body.has_var, body.linear && *op == AggregateOp::Sum);
                Ok(combine(
                    NodeKind::Aggregate(*op, Box::new(domain), Box::new(body)),
                    span,
                    v,
                    l,
                ))
            }),
        }
    }

    /// A name with attribute and arguments: symbol or function.
    fn apply(
        &mut self,
        name: &Ident,
        attr: Option<&Ident>,
        arguments: Option<&[Expr]>,
        span: Span,
    ) -> Result<Node, Failed> {
        let Some(s) = self.symbols.find(&name.name) else {
            return self.function(name, attr, arguments, span);
        };
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
                    None => {
                        let parts = self.set_index(s, name)?;
                        Key { parts }
                    }
                    Some(_) => self.key(s, indices, span)?,
                };
                Ok(Node::data(NodeKind::Data(symbol.table, key), span))
            }
            SymbolKind::Parameter { .. } => {
                if let Some(attr) = attr {
                    return self.fail(
                        Diagnostic::error(
                            "E0314",
                            attr.span,
                            format!("a parameter has no attribute `.{}`", attr.name),
                        )
                        .label("not there")
                        .other(
                            symbol.declared,
                            format!("`{}` is a {}", symbol.name, symbol.kind_name()),
                        ),
                    );
                }
                self.used(s, span);
                let key = self.key(s, indices, span)?;
                Ok(Node::data(NodeKind::Data(symbol.table, key), span))
            }
            SymbolKind::Variable(_) | SymbolKind::Equation(_) => {
                let is_variable = matches!(symbol.kind, SymbolKind::Variable(_));
                match attr {
                    Some(a) => self.record_attribute(s, a, indices, span),
                    None if is_variable && self.in_equation => {
                        let key = self.key(s, indices, span)?;
                        Ok(Node {
                            kind: NodeKind::Var(s, key),
                            span,
                            has_var: true,
                            linear: true,
                        })
                    }
                    None if is_variable && self.modes.dot_l => {
                        let key = self.key(s, indices, span)?;
                        Ok(Node::data(
                            NodeKind::Data(symbol.table + attribute::L, key),
                            span,
                        ))
                    }
                    None => self.fail(
                        Diagnostic::error(
                            "E0310",
                            name.span,
                            format!(
                                "`{}` is a {}; outside equations it needs an attribute",
                                symbol.name,
                                symbol.kind_name()
                            ),
                        )
                        .label("which of its numbers?")
                        .other(symbol.declared, "declared here")
                        .help(format!(
                            "its level is `{0}.l`, its marginal `{0}.m`",
                            name.name
                        )),
                    ),
                }
            }
            SymbolKind::Model(_) | SymbolKind::File(_) => {
                let Some(a) = attr else {
                    return self.fail(
                        Diagnostic::error(
                            "E0315",
                            name.span,
                            format!("a {} is not a number", symbol.kind_name()),
                        )
                        .label("an attribute is expected")
                        .other(symbol.declared, "declared here")
                        .help(format!("for instance `{}.modelstat`", name.name)),
                    );
                };
                let attribute = self.object_attribute(s, a)?;
                Ok(Node::data(NodeKind::ObjectAttribute(s, attribute), span))
            }
            SymbolKind::Acronym(n) => Ok(Node::number(value::acronym(*n), span)),
            SymbolKind::Figure(_) => self.fail(
                Diagnostic::error("E0315", name.span, "a figure is not a number")
                    .other(symbol.declared, "declared here"),
            ),
        }
    }

    /// `x.l(i)` of a variable or equation.
    fn record_attribute(
        &mut self,
        s: SymbolId,
        a: &Ident,
        indices: &[Expr],
        span: Span,
    ) -> Result<Node, Failed> {
        let symbol = self.symbols.get(s).clone();
        let Some(which) = functions::record_attribute(&a.name) else {
            return self.unknown_attribute(
                a,
                &symbol.name,
                symbol.kind_name(),
                "l, m, lo, up, fx, scale, prior, slack, range",
            );
        };
        let key = self.key(s, indices, span)?;
        match which {
            functions::RecordAttribute::Stored(offset) => {
                if offset == attribute::L || offset == attribute::M {
                    self.used(s, span);
                }
                Ok(Node::data(NodeKind::Data(symbol.table + offset, key), span))
            }
            functions::RecordAttribute::Derived(d) => {
                Ok(Node::data(NodeKind::Derived(d, s, key), span))
            }
            functions::RecordAttribute::Fix => self.fail(
                Diagnostic::error("E0314", a.span, "`.fx` can be assigned, not read")
                    .label("write only")
                    .help("read `.l`, or `.lo` and `.up`"),
            ),
        }
    }

    pub(super) fn unknown_attribute<T>(
        &mut self,
        a: &Ident,
        name: &str,
        kind: &str,
        known: &str,
    ) -> Result<T, Failed> {
        let near = nearest(&a.name, known.split(", ")).map(str::to_string);
        let d = Diagnostic::error(
            "E0314",
            a.span,
            format!("the {kind} `{name}` has no attribute `.{}`", a.name),
        )
        .label("not an attribute");
        self.fail(match near {
            Some(n) => d.help(format!("did you mean `.{n}`?")),
            None => d.help(format!("there are: {known}")),
        })
    }

    pub(super) fn object_attribute(
        &mut self,
        s: SymbolId,
        a: &Ident,
    ) -> Result<&'static str, Failed> {
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
    ) -> Result<Node, Failed> {
        let symbol = self.symbols.get(s).clone();
        let lower = attr.name.to_lowercase();
        match lower.as_str() {
            "te" if self.texts_allowed && !indices.is_empty() => {
                let key = self.key(s, indices, span)?;
                return Ok(Node::data(NodeKind::ElementText(symbol.table, key), span));
            }
            "te" | "tl" if self.texts_allowed => {
                let parts = self.set_index(s, name)?;
                return Ok(Node::data(
                    if lower == "tl" && parts.len() == 1 {
                        NodeKind::LabelText(parts[0].clone())
                    } else {
                        NodeKind::ElementText(symbol.table, Key { parts })
                    },
                    span,
                ));
            }
            _ => {}
        }
        let Some(which) = functions::label_attribute(&lower) else {
            let known = "val, pos, ord, off, rev, uel, len, tlen, first, last";
            return self.unknown_attribute(attr, &symbol.name, "set", known);
        };
        self.used(s, span);
        if which == LabelAttribute::Ord {
            self.ordered(s, span, "`.ord`")?;
        }
        let mut parts = if indices.is_empty() {
            self.set_index(s, name)?
        } else {
            self.key(s, indices, span)?.parts
        };
        if parts.len() != 1 {
            return self.wrong_dimension(s, span, parts.len());
        }
        Ok(Node::data(
            NodeKind::LabelAttribute(which, symbol.table, parts.remove(0)),
            span,
        ))
    }

    /// A function call.
    fn function(
        &mut self,
        name: &Ident,
        attr: Option<&Ident>,
        arguments: Option<&[Expr]>,
        span: Span,
    ) -> Result<Node, Failed> {
        let lower = name.name.to_lowercase();
        let args = arguments.unwrap_or(&[]);
        let Some((callee, low, high)) = functions::callee(&lower).filter(|_| attr.is_none()) else {
            return self.unknown_name(name, arguments.is_some());
        };
        if args.len() < low || args.len() > high {
            let count = |n: usize| {
                if n == 1 {
                    "1 argument".to_string()
                } else {
                    format!("{n} arguments")
                }
            };
            let wanted = match (low, high) {
                (l, h) if l == h => count(l),
                (l, usize::MAX) => format!("{l} or more arguments"),
                (l, h) => format!("{l} to {}", count(h)),
            };
            return self.fail(
                Diagnostic::error(
                    "E0316",
                    span,
                    format!("`{lower}` takes {wanted}, not {}", args.len()),
                )
                .label("wrong number of arguments"),
            );
        }
        match callee {
            Callee::Ord | Callee::Card => {
                if let Some(text) = self.text_argument(&args[0])? {
                    let at = match (callee, args.get(1)) {
                        (Callee::Card, _) => None,
                        (_, Some(n)) => Some(Box::new(self.expr(n)?)),
                        _ => Some(Box::new(Node::number(1.0, span))),
                    };
                    return Ok(Node::data(NodeKind::OfText(Box::new(text), at), span));
                }
                if let Some(second) = args.get(1) {
                    return self.fail(
                        Diagnostic::error("E0316", second.span, "`ord` of a set takes 1 argument")
                            .label("only `ord('text', n)` has a position"),
                    );
                }
                let ExprKind::Apply {
                    name: n,
                    attribute: None,
                    arguments: None,
                } = &args[0].kind
                else {
                    return self.fail(
                        Diagnostic::error(
                            "E0317",
                            args[0].span,
                            format!("`{lower}` takes the name of a set"),
                        )
                        .label("not a name")
                        .help(format!("for instance `{lower}(i)`")),
                    );
                };
                let s = self.lookup(n)?;
                if callee == Callee::Card {
                    self.used(s, n.span);
                    let symbol = self.symbols.get(s);
                    if matches!(
                        symbol.kind,
                        SymbolKind::Model(_)
                            | SymbolKind::File(_)
                            | SymbolKind::Acronym(_)
                            | SymbolKind::Figure(_)
                    ) {
                        return self.lookup_set(n).and(Err(Failed));
                    }
                    return Ok(Node::data(NodeKind::Card(symbol.table), span));
                }
                self.lookup_set(n)?;
                self.used(s, n.span);
                self.ordered(s, n.span, "`ord`")?;
                let mut parts = self.set_index(s, n)?;
                if parts.len() != 1 {
                    return self.wrong_dimension(s, n.span, 1);
                }
                Ok(Node::data(
                    NodeKind::Ord(self.symbols.get(s).table, parts.remove(0)),
                    span,
                ))
            }
            Callee::SameAs => {
                let mut parts = Vec::new();
                for a in args {
                    parts.extend(match &a.kind {
                        ExprKind::Text(t) => vec![Part::Label(self.store.universe.intern(t))],
                        _ => self.index(a, UNIVERSE, 0)?,
                    });
                }
                if parts.len() != 2 {
                    return self.fail(Diagnostic::error(
                        "E0317",
                        span,
                        "`sameas` compares two single indices",
                    ));
                }
                let b = parts.remove(1);
                Ok(Node::data(NodeKind::SameAs(parts.remove(0), b), span))
            }
            Callee::Math(f) => {
                let mut nodes = Vec::with_capacity(args.len());
                for a in args {
                    nodes.push(self.expr(a)?);
                }
                let v = nodes.iter().any(|n| n.has_var);
                if v && functions::first_argument_must_be_data(f) && nodes[0].has_var {
                    return self.fail(Diagnostic::error(
                        "E0318",
                        nodes[0].span,
                        format!("the first argument of `{lower}` may not depend on a variable"),
                    ));
                }
                Ok(combine(NodeKind::Call(f, nodes), span, v, false))
            }
            Callee::Data(f) => {
                let mut nodes = Vec::with_capacity(args.len());
                for a in args {
                    let n = self.expr(a)?;
                    if n.has_var {
                        return self.fail(
                            Diagnostic::error(
                                "E0318",
                                n.span,
                                format!("`{lower}` may not depend on a variable"),
                            )
                            .label("a variable stands in it"),
                        );
                    }
                    nodes.push(n);
                }
                Ok(Node::data(NodeKind::DataCall(f, nodes), span))
            }
        }
    }

    /// A text where `card` and `ord` may have one: `'abc'`, `i.tl`, `i.te(i)`, `p.ts`.
    fn text_argument(&mut self, e: &Expr) -> Result<Option<Node>, Failed> {
        let is_text = match &e.kind {
            ExprKind::Text(_) => true,
            ExprKind::Apply {
                attribute: Some(a), ..
            } => ["tl", "te", "ts", "tn"]
                .iter()
                .any(|t| a.name.eq_ignore_ascii_case(t)),
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

    fn unknown_name<T>(&mut self, name: &Ident, called: bool) -> Result<T, Failed> {
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
            _ => None,
        };
        let near = instead.map(str::to_string).or_else(|| {
            let mut known: Vec<&str> = self.symbols.iter().skip(1).map(|(_, s)| &*s.name).collect();
            for n in functions::names() {
                known.push(n);
            }
            nearest(&name.name, known).map(str::to_string)
        });
        let what = if called {
            "symbol or function"
        } else {
            "symbol"
        };
        let mut d = Diagnostic::error("E0301", name.span, format!("`{}` is not known", name.name))
            .label(format!("unknown {what}"));
        d = match near {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None if self.store.universe.get(&name.name).is_some() => {
                d.help(format!("`{0}` is a label: quote it, `'{0}'`", name.name))
            }
            None => d.help(
                "declare it first: names must be declared above the place where they are used",
            ),
        };
        self.fail(d)
    }

    /// A set expression: `+` is union, `*` intersection, `-` difference.
    pub(super) fn set_expr(&mut self, e: &Expr) -> Result<Node, Failed> {
        let node = self.expr(e)?;
        Ok(set_algebra(node))
    }
}

/// Turns sums of memberships into union and difference.
fn set_algebra(node: Node) -> Node {
    let span = node.span;
    match node.kind {
        NodeKind::Sum(terms) => {
            let mut acc: Option<Node> = None;
            for (minus, t) in terms {
                let t = set_algebra(t);
                acc = Some(match (acc, minus) {
                    (None, false) => t,
                    (None, true) => Node::data(NodeKind::Not(Box::new(t)), span),
                    (Some(a), false) => Node::data(
                        NodeKind::Binary(BinaryOp::Or, Box::new(a), Box::new(t)),
                        span,
                    ),
                    (Some(a), true) => {
                        let no = Node::data(NodeKind::Not(Box::new(t)), span);
                        Node::data(
                            NodeKind::Binary(BinaryOp::And, Box::new(a), Box::new(no)),
                            span,
                        )
                    }
                });
            }
            acc.unwrap_or_else(|| Node::number(0.0, span))
        }
        NodeKind::Product(factors) => Node::data(
            NodeKind::Product(
                factors
                    .into_iter()
                    .map(|(d, f)| (d, set_algebra(f)))
                    .collect(),
            ),
            span,
        ),
        NodeKind::Dollar(a, c) => Node::data(NodeKind::Dollar(Box::new(set_algebra(*a)), c), span),
        kind => Node {
            kind,
            span,
            has_var: node.has_var,
            linear: node.linear,
        },
    }
}

/// A product; flattened one level so that `a*b*c` and `a*b` are alike.
fn product(factors: Vec<(bool, Node)>, span: Span) -> Node {
    let v = factors.iter().filter(|(_, n)| n.has_var).count();
    let l = v <= 1
        && factors
            .iter()
            .all(|(div, n)| n.linear && !(*div && n.has_var));
    combine(NodeKind::Product(factors), span, v > 0, l)
}

/// A factor that divides. GAMS divides by a number or a scalar parameter `b` as it multiplies by `1/b`,
/// which shows in the last digit: such a factor multiplies, and is a product of one divisor.
fn divisor(written: &Expr, node: Node) -> (bool, Node) {
    let once = match (&written.kind, &node.kind) {
        (ExprKind::Number(_), NodeKind::Const(_)) => true,
        (
            ExprKind::Apply {
                attribute: None, ..
            },
            NodeKind::Data(_, key),
        ) => key.parts.is_empty(),
        _ => false,
    };
    if !once {
        return (true, node);
    }
    let span = node.span;
    (
        false,
        Node::data(NodeKind::Product(vec![(true, node)]), span),
    )
}
