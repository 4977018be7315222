//! What lets an index run: domains of sums, loops, assignments and equations put sets under control.
//!
//! Invariant: every controlled set stands in `scope` with its parts, innermost last; slots are not used
//! twice within a statement.

use super::node::*;
use super::symbols::{DomainPosition, SymbolKind, UNIVERSE};
use super::{Checked, Compiler};
use crate::diag::Diagnostic;
use crate::source::Span;
use crate::syntax::ast::{self, Expr, ExprKind, Ident};

impl Compiler {
    /// What a set that is under control stands for: running indices, or what pins it, `loop(i('a'), …)`.
    pub(super) fn controlled(&self, set: SymbolId) -> Option<&[Part]> {
        let found = self.scope.iter().rev().find(|(s, _)| *s == set);
        found.map(|(_, parts)| parts.as_slice())
    }

    /// An error where a set stands for what its own indices found, as `s` under `loop(s(i), …)`: it does not run.
    pub(super) fn runs(&mut self, set: SymbolId, span: Span, what: &str) -> Checked<()> {
        let found = self.scope.iter().rposition(|(s, _)| *s == set);
        let Some(at) = found.filter(|at| self.maps.contains(at)) else {
            return Ok(());
        };
        let name = self.symbols.get(set).name.clone();
        let same = |p: &[Part]| match (p, self.scope[at].1.as_slice()) {
            ([Part::Slot(a)], [Part::Slot(b)]) => a == b,
            _ => false,
        };
        let index = self.scope[..at].iter().rev().find(|(_, p)| same(p));
        let help = match index.map(|(s, _)| &self.symbols.get(*s).name) {
            Some(i) => format!("use `{i}`, which runs, or let `{name}` run alone"),
            None => format!("let `{name}` run alone, with a condition on its elements"),
        };
        Diagnostic::error("E0309", span)
            .says(format!("{what} needs a set that runs itself; `{name}` stands here for what `{name}(…)` found"))
            .label("not running")
            .help(help)
            .fail(self)
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
        self.maps.retain(|&m| m < scope);
        r
    }

    /// Takes a domain and puts its indices under control (until the caller's scope ends).
    pub(super) fn domain(&mut self, d: &ast::Domain) -> Checked<Domain> {
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
                let set = self.symbols.find(&item.set.name);
                if item.indices.is_some() && set.is_some_and(|s| self.controlled(s).is_some()) {
                    return self.controlled_already(&item.set, item.span);
                }
                self.domain_item(&item.set, item.indices.as_deref(), item.span, &mut out)?;
            }
        }
        if let Some(c) = &d.condition {
            self.condition(c, &mut out)?;
        }
        Ok(out)
    }

    /// Adds the conjuncts of a condition to a domain. Where random numbers are drawn in one, the condition
    /// stays whole: every tuple draws, whatever the others say.
    pub(super) fn condition(&mut self, c: &Expr, out: &mut Domain) -> Checked<()> {
        let before = out.conditions.len();
        self.conjuncts(c, &mut out.conditions)?;
        if out.conditions[before..].iter().any(Node::has_random) {
            let whole = |a, b| Node::binary(BinaryOp::And, a, b, c.span);
            let parts = out.conditions.split_off(before);
            out.conditions.extend(parts.into_iter().reduce(whole));
        }
        Ok(())
    }

    fn conjuncts(&mut self, c: &Expr, out: &mut Vec<Node>) -> Checked<()> {
        if let ExprKind::Binary(BinaryOp::And, a, b) = &c.kind {
            self.conjuncts(a, out)?;
            return self.conjuncts(b, out);
        }
        let node = self.expr(c)?;
        self.no_variable(&node, "a condition")?;
        out.push(node);
        Ok(())
    }

    pub(super) fn no_variable(&mut self, node: &Node, place: &str) -> Checked<()> {
        if !node.has_var {
            return Ok(());
        }
        Diagnostic::error("E0311", node.span)
            .says(format!("{place} may not depend on a variable"))
            .label("a variable stands in it")
            .help("use the level of the last solve (`x.l`), a parameter, or a binary formulation")
            .fail(self)
    }

    /// One item of a domain: controls what is not controlled yet; returns its key parts.
    pub(super) fn domain_item(
        &mut self,
        set: &Ident,
        indices: Option<&[Expr]>,
        span: Span,
        out: &mut Domain,
    ) -> Checked<Vec<Part>> {
        let id = self.lookup_set(set)?;
        self.used(id, set.span);
        match indices {
            Some(i) => self.shape(id, i),
            None => self.symbols.get_mut(id).open = false,
        }
        let symbol = self.symbols.get(id).clone();
        let Some(indices) = indices else {
            if self.controlled(id).is_some() {
                return self.controlled_already(set, span);
            }
            return Ok(self.run_over(id, out));
        };
        let found = self.scope.iter().rposition(|(s, _)| *s == id);
        if found.is_some_and(|at| self.maps.contains(&at)) {
            return self.controlled_already(set, span);
        }
        let parts = self.control_key(indices, id, span, out)?;
        out.members.push(Driver {
            table: symbol.table,
            key: Key {
                parts: parts.clone(),
            },
        });
        if self.controlled(id).is_none() {
            self.maps.push(self.scope.len());
            self.scope.push((id, parts.clone()));
        }
        Ok(parts)
    }

    fn controlled_already<T>(&mut self, set: &Ident, span: Span) -> Checked<T> {
        let i = &set.name;
        Diagnostic::error("E0305", span)
            .says(format!("`{i}` is bound already"))
            .label("bound a second time here")
            .help(format!(
                "use an alias for the inner index: `alias({i},{i}2);` and write `{i}2` here"
            ))
            .fail(self)
    }

    /// `sum(sameas(i,j), …)`: a set that is not under control yet takes the element of the other.
    fn equal_item(&mut self, indices: &[Expr], span: Span, out: &mut Domain) -> Checked<()> {
        let [a, b] = indices else {
            return Diagnostic::error("E0317", span)
                .says("`sameas` compares two single indices")
                .fail(self);
        };
        let free = |c: &Self, e: &Expr| match &e.kind {
            ExprKind::Apply(name, None, None) => c.symbols.find(&name.name).filter(|&s| {
                let set = c.symbols.get(s);
                set.is_set() && set.dim() == 1 && c.controlled(s).is_none()
            }),
            _ => None,
        };
        let (first, second) = match free(self, b) {
            Some(_) => (a, b),
            None => (b, a),
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
                self.run(s, one);
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
            let set = match symbol.domain.get(p) {
                _ if dim == 1 => id,
                Some(&DomainPosition::Set(d)) => d,
                _ => UNIVERSE,
            };
            out.slots.push(s);
            out.sets.push(self.symbols.get(set).table);
            out.names.push(set);
        }
        let parts: Vec<Part> = slots.into_iter().map(Part::Slot).collect();
        out.members.push(Driver {
            table: symbol.table,
            key: Key {
                parts: parts.clone(),
            },
        });
        self.run(id, parts.clone());
        parts
    }

    fn run(&mut self, set: SymbolId, parts: Vec<Part>) {
        if self.in_equation {
            self.running.push(set);
        }
        self.scope.push((set, parts));
    }

    /// An index that is put under control if it is a set that is not yet.
    pub(super) fn control_index(
        &mut self,
        index: &Expr,
        of: SymbolId,
        position: usize,
        out: &mut Domain,
    ) -> Checked<Vec<Part>> {
        match &index.kind {
            ExprKind::Apply(name, Some(a), None) if a.name.eq_ignore_ascii_case("local") => {
                let s = self.lookup_set(name)?;
                self.used(s, name.span);
                self.fits(s, of, position, index.span)?;
                Ok(self.run_over(s, out))
            }
            ExprKind::Apply(name, None, None) => {
                let free = self.symbols.find_set(&name.name).filter(|&s| {
                    let kind = &self.symbols.rooted(s).kind;
                    let singleton = matches!(kind, SymbolKind::Set { singleton: true });
                    !singleton && self.controlled(s).is_none()
                });
                match free {
                    Some(s) => {
                        self.fits(s, of, position, index.span)?;
                        self.domain_item(name, None, index.span, out)
                    }
                    None => self.index(index, of, position),
                }
            }
            ExprKind::Apply(name, None, Some(inner))
                if self.symbols.find_set(&name.name).is_some() =>
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
    ) -> Checked<Vec<Part>> {
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
                    Some((false, base)) => Some(base),
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
                    let base = self.lag_base(base, of, position)?;
                    lags.push((n, base));
                    position += 1;
                    Vec::new()
                }
                None => self.control_index(index, of, position, out)?,
            };
            position += here.len();
            parts.push(here);
        }
        for (n, base) in lags {
            parts[n] = vec![self.lag(&indices[n], base)?];
        }
        let parts = parts.concat();
        if parts.len() != dim {
            return self.wrong_dimension(of, span, parts.len().max(indices.len()));
        }
        Ok(parts)
    }

    fn control_lag_base(&mut self, base: &Expr, out: &mut Domain) -> Checked<()> {
        if let ExprKind::Apply(name, Some(a), None) = &base.kind
            && a.name.eq_ignore_ascii_case("local")
        {
            let s = self.lookup_set(name)?;
            self.used(s, name.span);
            self.run_over(s, out);
        } else if let ExprKind::Apply(name, None, None) = &base.kind {
            let set = self.symbols.find_set(&name.name);
            if set.is_some_and(|s| self.controlled(s).is_none()) {
                self.domain_item(name, None, base.span, out)?;
            }
        }
        Ok(())
    }
}
