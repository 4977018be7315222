//! Declarations.

use super::node::{SymbolId, TableId};
use super::symbols::{DomainPosition, ModelInfo, Symbol, SymbolKind, UNIVERSE, attribute};
use super::{Checked, Compiler, Failed};
use crate::diag::Diagnostic;
use crate::source::{SourceMap, Span};
use crate::syntax::ast::{
    DomainName, FileDecl, Ident, ModelDecl, ModelItem, ParameterDecl, SetDecl, SymbolDecl,
    VariableKind,
};
use std::sync::Arc;

impl Compiler {
    fn positions(&mut self, domain: &[DomainName]) -> Checked<Vec<DomainPosition>> {
        let mut out = Vec::new();
        for d in domain {
            if &*d.name.name == "*" {
                out.push(DomainPosition::Universe);
                continue;
            }
            let s = self.lookup_set(&d.name)?;
            let root = self.symbols.root(s);
            let symbol = self.symbols.get(root);
            if symbol.dim() != 1 {
                let declared = symbol.declared;
                return Diagnostic::error("E0334", d.name.span)
                    .says(format!(
                        "`{}` has several positions; a domain is one-dimensional",
                        d.name.name
                    ))
                    .label("not one-dimensional")
                    .other(declared, "declared here")
                    .help("name a set for each index; in the data of a set a range is written `1*5`, and `1:5` or `1.5` is a pair")
                    .fail(self);
            }
            if root == UNIVERSE {
                out.push(DomainPosition::Universe);
                continue;
            }
            if symbol.dynamic {
                let declared = symbol.declared;
                return Diagnostic::error("E0339", d.name.span)
                    .says(format!(
                        "`{}` is changed by an assignment; it cannot be a domain",
                        d.name.name
                    ))
                    .label("a domain must stay as it is")
                    .other(declared, "declared here")
                    .help("use the set that it is a subset of as the domain")
                    .fail(self);
            }
            self.symbols.get_mut(root).is_domain = true;
            self.symbols.get_mut(root).open = false;
            out.push(DomainPosition::Set(s));
        }
        Ok(out)
    }

    /// Declares a symbol, or finds it declared with the same kind and dimension.
    pub(super) fn declare(
        &mut self,
        d: &SymbolDecl,
        kind: SymbolKind,
        tables: impl FnOnce(&mut Self, usize) -> TableId,
    ) -> Checked<SymbolId> {
        let declared = self.declare_new(d, kind, tables);
        match (declared, &d.domain) {
            (Ok(s), Some(_)) => {
                self.defining.insert(s, d.defines());
            }
            (Ok(_), None) => {}
            (Err(Failed), _) => self.lose_declaration(&d.name.name),
        }
        declared
    }

    fn declare_new(
        &mut self,
        d: &SymbolDecl,
        kind: SymbolKind,
        tables: impl FnOnce(&mut Self, usize) -> TableId,
    ) -> Checked<SymbolId> {
        let mut names = std::borrow::Cow::Borrowed(d.domain.as_deref().unwrap_or(&[]));
        if matches!(kind, SymbolKind::Set { .. }) && self.symbols.find(&d.name.name).is_none() {
            // `set e(e)`: a set over itself is over the universe.
            let itself = |n: &DomainName| n.name.name.eq_ignore_ascii_case(&d.name.name);
            if names.iter().any(itself) {
                let own = names.to_mut().iter_mut();
                own.filter(|n| itself(n))
                    .for_each(|n| n.name.name = "*".into());
            }
        }
        let domain = self.positions(&names)?;
        if let Some(s) = self.symbols.find(&d.name.name) {
            // `alias(i,j); set j / … /;` gives i its elements.
            let s = match kind {
                SymbolKind::Set { .. } => self.symbols.root(s),
                _ => s,
            };
            return self.declare_again(s, d, &kind, domain);
        }
        let dim = domain.len();
        if dim > 20 {
            return Diagnostic::error("E0336", d.name.span)
                .says(format!(
                    "`{}` has {dim} index positions; there may be 20",
                    d.name.name
                ))
                .fail(self);
        }
        let table = tables(self, dim);
        let open = d
            .domain
            .as_ref()
            .is_none_or(|l| l.iter().all(|n| &*n.name.name == "*"))
            && dim <= usize::from(matches!(kind, SymbolKind::Set { .. }))
            && matches!(
                kind,
                SymbolKind::Set { .. }
                    | SymbolKind::Parameter { scalar: false }
                    | SymbolKind::Variable(_)
                    | SymbolKind::Equation(_)
            );
        Ok(self.symbols.add(Symbol {
            name: d.name.name.clone(),
            open,
            kind,
            domain,
            text: d.text.clone().unwrap_or_default(),
            declared: d.name.span,
            table,
            has_data: false,
            assigned: false,
            dynamic: false,
            is_domain: false,
            unordered: false,
        }))
    }

    /// A further declaration of a symbol, which may give it its indices and its text.
    fn declare_again(
        &mut self,
        s: SymbolId,
        d: &SymbolDecl,
        kind: &SymbolKind,
        domain: Vec<DomainPosition>,
    ) -> Checked<SymbolId> {
        let old = self.symbols.get(s).clone();
        let reshaped = !old.open && d.domain.is_some() && domain.len() != old.dim();
        let unlike = std::mem::discriminant(&old.kind) != std::mem::discriminant(kind);
        if unlike || reshaped || s == UNIVERSE {
            let capitals = match *old.name == *d.name.name {
                true => "",
                false => ": capitals do not distinguish names",
            };
            let listed =
                matches!(kind, SymbolKind::Model(_)) && matches!(old.kind, SymbolKind::Equation(_));
            let shape = match (unlike, old.dim()) {
                (true, _) => String::new(),
                (false, 0) => " without an index".into(),
                (false, n) => format!(" with {n} ind{}", if n == 1 { "ex" } else { "ices" }),
            };
            return Diagnostic::error("E0333", d.name.span)
                .says(format!(
                    "`{}` is declared already, as {}{shape}",
                    d.name.name,
                    old.a_kind()
                ))
                .label("declared again")
                .other(old.declared, "first declared here")
                .help(match listed {
                    true => {
                        "the equations of a model stand between slashes: `model m / e, f /;`".into()
                    }
                    false => format!("choose another name{capitals}"),
                })
                .fail(self);
        }
        if old.open && d.domain.is_some() && domain.len() <= 20 {
            self.reshape(s, domain.len());
            let symbol = self.symbols.get_mut(s);
            symbol.domain = domain;
            symbol.open = false;
        } else if d.domain.is_some()
            && domain != old.domain
            && !matches!(old.kind, SymbolKind::Equation(Some(_)))
        {
            let compatible = domain.iter().zip(&old.domain).all(|(a, b)| match (a, b) {
                (DomainPosition::Set(a), DomainPosition::Set(b)) => {
                    self.symbols.root(*a) == self.symbols.root(*b)
                }
                _ => true,
            });
            if !compatible {
                return Diagnostic::error("E0335", d.name.span)
                    .says(format!(
                        "`{}` is declared already over other sets",
                        d.name.name
                    ))
                    .label("declared again")
                    .other(old.declared, "first declared here")
                    .fail(self);
            }
        }
        let symbol = self.symbols.get_mut(s);
        if let Some(t) = &d.text
            && symbol.text.is_empty()
        {
            symbol.text = t.clone();
        }
        Ok(s)
    }

    pub(super) fn declare_plain(
        &mut self,
        name: &Ident,
        kind: SymbolKind,
        text: Option<&str>,
    ) -> Checked<SymbolId> {
        let d = SymbolDecl {
            name: name.clone(),
            domain: None,
            text: text.map(Into::into),
            data: None,
        };
        let s = self.declare(&d, kind.clone(), |_, _| 0)?;
        self.symbols.get_mut(s).kind = kind;
        Ok(s)
    }

    pub(super) fn declare_sets(&mut self, list: &[SetDecl], map: &SourceMap) -> Checked<()> {
        for set in list {
            if let (Some(over), None) = (&set.symbol.domain, set.symbol.data)
                && over.len() > 1
                && over.iter().all(|n| {
                    &*n.name.name != "*"
                        && self.symbols.find(&n.name.name).is_none()
                        && !self.is_lost(&n.name.name)
                })
            {
                let names: Vec<&str> = over.iter().map(|n| &*n.name.name).collect();
                let (name, at) = (
                    &set.symbol.name.name,
                    over[0].name.span.to(over[over.len() - 1].name.span),
                );
                let d = Diagnostic::error("E0302", at)
                    .says("none of these is a set")
                    .label("in parentheses stand the sets that it runs over")
                    .help(format!(
                        "elements stand between slashes: `set {name} / {} /;`",
                        names.join(", ")
                    ));
                d.report(self);
                self.lose_declaration(name);
                continue;
            }
            let mut d = set.symbol.clone();
            let new = self.symbols.find(&d.name.name).is_none();
            let explicit = d.domain.is_some();
            if d.domain.is_none() && new {
                d.domain = Some(vec![DomainName {
                    name: Ident {
                        name: "*".into(),
                        span: d.name.span,
                    },
                    defines: false,
                }]);
            }
            let Ok(s) = self.declare(
                &d,
                SymbolKind::Set {
                    singleton: set.singleton,
                },
                |c, n| c.store.add_table(n, 0.0),
            ) else {
                continue;
            };
            if explicit {
                self.symbols.get_mut(s).open = false;
            }
            if !self.take_input(s, d.name.span)
                && let Some(body) = d.data
            {
                if !explicit && new && map.text(body).trim().is_empty() {
                    Diagnostic::error("E0334", d.name.span)
                        .says(format!("how many indices has `{}`?", d.name.name))
                        .label("neither a domain nor data say")
                        .help(format!("write `{}(*)`, or leave the data out", d.name.name))
                        .report(self);
                    continue;
                }
                let _ = self.set_data(s, body, d.name.span, map);
            }
        }
        Ok(())
    }

    pub(super) fn declare_aliases(&mut self, groups: &[Vec<Ident>]) -> Checked<()> {
        for group in groups {
            let known = group.iter().find_map(|n| {
                if &*n.name == "*" {
                    Some(UNIVERSE)
                } else {
                    self.symbols.find_set(&n.name)
                }
            });
            let Some(root) = known.map(|s| self.symbols.root(s)) else {
                let span = group[0].span.to(group[group.len() - 1].span);
                return Diagnostic::error("E0337", span)
                    .says("none of these names is a set")
                    .label("`alias` gives a set another name")
                    .help("declare the set first: `set i / … /; alias(i, j);`")
                    .fail(self);
            };
            for n in group {
                if &*n.name == "*" {
                    continue;
                }
                match self.symbols.find(&n.name) {
                    Some(s) if self.symbols.root(s) == root => {}
                    Some(s) => {
                        let declared = self.symbols.get(s).declared;
                        Diagnostic::error("E0333", n.span)
                            .says(format!("`{}` is declared already", n.name))
                            .label("declared again")
                            .other(declared, "first declared here")
                            .report(self);
                    }
                    None => {
                        self.symbols.get_mut(root).open = false;
                        let set = self.symbols.get(root).clone();
                        self.symbols.add(Symbol {
                            name: n.name.clone(),
                            kind: SymbolKind::Alias(root),
                            declared: n.span,
                            ..set
                        });
                    }
                }
            }
        }
        Ok(())
    }

    pub(super) fn declare_parameters(
        &mut self,
        list: &[ParameterDecl],
        map: &SourceMap,
    ) -> Checked<()> {
        for p in list {
            if let Some(first) = p
                .symbol
                .domain
                .as_ref()
                .and_then(|d| d.first())
                .filter(|_| p.scalar)
            {
                let name = &p.symbol.name;
                Diagnostic::error("E0336", first.name.span)
                    .says(format!("`{}` is a scalar: it has no index", name.name))
                    .label("no index here")
                    .help(format!(
                        "write `parameter {}({}) …`",
                        name.name, first.name.name
                    ))
                    .report(self);
                self.lose_declaration(&name.name);
                continue;
            }
            let kind = SymbolKind::Parameter { scalar: p.scalar };
            let Ok(s) = self.declare(&p.symbol, kind, |c, n| c.store.add_table(n, 0.0)) else {
                continue;
            };
            if !self.take_input(s, p.symbol.name.span)
                && let Some(body) = p.symbol.data
            {
                let _ = self.parameter_data(s, body, p.symbol.name.span, map);
            }
        }
        Ok(())
    }

    pub(super) fn declare_variables(
        &mut self,
        kind: VariableKind,
        list: &[SymbolDecl],
        map: &SourceMap,
    ) -> Checked<()> {
        for d in list {
            let Ok(s) = self.declare(d, SymbolKind::Variable(VariableKind::Unstated), |c, n| {
                c.record_tables(n)
            }) else {
                continue;
            };
            if kind != VariableKind::Unstated {
                if self.other_kind(s, kind, d.name.span).is_err() {
                    continue;
                }
                self.symbols.get_mut(s).kind = SymbolKind::Variable(kind);
                let (lo, up) = match kind {
                    VariableKind::Unstated | VariableKind::Free => {
                        (f64::NEG_INFINITY, f64::INFINITY)
                    }
                    VariableKind::Negative => (f64::NEG_INFINITY, 0.0),
                    VariableKind::Binary => (0.0, 1.0),
                    VariableKind::SemiContinuous | VariableKind::SemiInteger => {
                        (1.0, f64::INFINITY)
                    }
                    _ => (0.0, f64::INFINITY),
                };
                let t = self.symbols.get(s).table;
                self.store.table_mut(t + attribute::LO).set_default(lo);
                self.store.table_mut(t + attribute::UP).set_default(up);
            }
            if let Some(body) = d.data {
                let _ = self.record_data(s, body, map);
            }
        }
        Ok(())
    }

    /// An error for a variable that has another kind, or was used as one without.
    fn other_kind(&mut self, s: SymbolId, kind: VariableKind, at: Span) -> Checked<()> {
        let symbol = self.symbols.get(s);
        let (message, label) = match symbol.kind {
            SymbolKind::Variable(before) if before == kind => return Ok(()),
            SymbolKind::Variable(VariableKind::Unstated) => {
                let used = symbol.assigned
                    || self
                        .equations
                        .iter()
                        .any(|e| e.left.mentions(s) || e.right.mentions(s));
                if !used || kind == VariableKind::Free {
                    return Ok(());
                }
                ("gets its kind after it was used", "too late for a kind")
            }
            _ => ("has another kind already", "a second kind"),
        };
        let d = Diagnostic::error("E0348", at)
            .says(format!("the variable `{}` {message}", symbol.name))
            .label(label)
            .other(symbol.declared, "declared here")
            .help("a variable has one kind from its first use on; assign its bounds `.lo` and `.up` to narrow it");
        d.fail(self)
    }

    fn record_tables(&mut self, dim: usize) -> TableId {
        let t = self.store.add_table(dim, 0.0);
        self.store.add_table(dim, 0.0);
        self.store.add_table(dim, f64::NEG_INFINITY);
        self.store.add_table(dim, f64::INFINITY);
        for _ in attribute::SCALE..attribute::COUNT {
            self.store.add_table(dim, 1.0);
        }
        t
    }

    pub(super) fn declare_equations(
        &mut self,
        list: &[SymbolDecl],
        map: &SourceMap,
    ) -> Checked<()> {
        for d in list {
            let Ok(s) = self.declare(d, SymbolKind::Equation(None), |c, n| c.record_tables(n))
            else {
                continue;
            };
            if let Some(body) = d.data {
                let _ = self.record_data(s, body, map);
            }
        }
        Ok(())
    }

    pub(super) fn declare_models(&mut self, list: &[ModelDecl]) -> Checked<()> {
        for m in list {
            if let Some(items) = &m.items {
                let mut failed = false;
                for item in items {
                    failed |= self.check_model_item(item).is_err();
                }
                if failed {
                    // Known all the same, so that its solve is not a second error.
                    let _ = self.declare_plain(
                        &m.name,
                        SymbolKind::Model(Arc::new(ModelInfo::default())),
                        m.text.as_deref(),
                    );
                    continue;
                }
            }
            let old =
                self.symbols
                    .find(&m.name.name)
                    .and_then(|s| match &self.symbols.get(s).kind {
                        SymbolKind::Model(info) => Some(info.items.clone()),
                        _ => None,
                    });
            let given = m.items.as_ref().map(|i| self.expand_all(i));
            let items = match (&given, old.flatten()) {
                (Some(new), Some(mut old)) if self.modes.at(m.name.span).multi => {
                    old.extend(new.iter().cloned());
                    Some(old)
                }
                (Some(new), _) => Some(new.clone()),
                (None, old) => old,
            };
            let _ = self.declare_plain(
                &m.name,
                SymbolKind::Model(Arc::new(ModelInfo { items })),
                m.text.as_deref(),
            );
        }
        Ok(())
    }

    /// `all` means the equations declared so far (their definitions may come later).
    fn expand_all(&self, items: &[ModelItem]) -> Vec<ModelItem> {
        let mut out = Vec::new();
        for item in items {
            match item {
                ModelItem::All(span) => out.extend(
                    self.symbols
                        .iter()
                        .filter(|(_, s)| matches!(s.kind, SymbolKind::Equation(_)))
                        .map(|(_, s)| {
                            ModelItem::Add(Ident {
                                name: s.name.clone(),
                                span: *span,
                            })
                        }),
                ),
                other => out.push(other.clone()),
            }
        }
        out
    }

    fn check_model_item(&mut self, item: &ModelItem) -> Checked<()> {
        let is_equation = |c: &mut Self, n: &Ident, model_too: bool| {
            let perpendicular = ["perp", "complements", "complement"];
            if perpendicular.iter().any(|w| n.name.eq_ignore_ascii_case(w)) && c.named(n).is_none()
            {
                return Diagnostic::error("E0338", n.span)
                    .says("an equation and its variable are paired with a dot")
                    .help("write `model m / e.x /;`")
                    .fail(c);
            }
            let s = c.lookup(n)?;
            let symbol = c.symbols.get(s).clone();
            match symbol.kind {
                SymbolKind::Equation(_) => Ok(()),
                SymbolKind::Model(_) if model_too => Ok(()),
                _ => Diagnostic::error("E0338", n.span)
                    .says(format!(
                        "`{}` is {}; a model is made of equations",
                        n.name,
                        symbol.a_kind()
                    ))
                    .label("not an equation")
                    .other(symbol.declared, "declared here")
                    .help("list equations, or `model m / all /;` for all of them; variables are found in them; a pair of a complementarity problem is `e.x`")
                    .fail(c),
            }
        };
        match item {
            ModelItem::All(_) => Ok(()),
            ModelItem::Add(n) => is_equation(self, n, true),
            ModelItem::Limit(variable, sets) => self.check_limit(variable, sets),
            ModelItem::Remove(n) => is_equation(self, n, true),
            ModelItem::Pair { rows, column } => {
                for r in rows {
                    is_equation(self, r, false)?;
                }
                let v = self.lookup(column)?;
                let symbol = self.symbols.get(v).clone();
                if !matches!(symbol.kind, SymbolKind::Variable(_)) {
                    return Diagnostic::error("E0338", column.span)
                        .says(format!(
                            "`{}` is {}; an equation is paired with a variable",
                            column.name,
                            symbol.a_kind()
                        ))
                        .label("not a variable")
                        .other(symbol.declared, "declared here")
                        .fail(self);
                }
                Ok(())
            }
        }
    }

    /// `x(s)` in the list of a model.
    fn check_limit(&mut self, variable: &Ident, sets: &[Ident]) -> Checked<()> {
        let v = self.lookup(variable)?;
        let symbol = self.symbols.get(v).clone();
        if !matches!(symbol.kind, SymbolKind::Variable(_)) {
            let kind = symbol.kind_name();
            return Diagnostic::error("E0338", variable.span)
                .says(format!("the {kind} `{}` stands here without indices", symbol.name))
                .label("only variables are limited to a set")
                .other(symbol.declared, "declared here")
                .help(format!(
                    "write `{}` alone; which rows there are is said where the equation is defined: `e(i)$s(i)..`",
                    symbol.name
                ))
                .fail(self);
        }
        let [set] = sets else {
            return Diagnostic::error("E0338", variable.span)
                .says("one set says which columns there are")
                .label("not one set")
                .help(format!(
                    "write `{}(s)` with a set `s` of the dimension of `{0}`",
                    symbol.name
                ))
                .fail(self);
        };
        let s = self.lookup_set(set)?;
        match self.symbols.get(s).dim() == symbol.dim() {
            true => Ok(()),
            false => self.wrong_dimension(s, set.span, symbol.dim()),
        }
    }

    pub(super) fn declare_acronyms(&mut self, list: &[SymbolDecl]) -> Checked<()> {
        for d in list {
            if self
                .symbols
                .find(&d.name.name)
                .is_some_and(|s| matches!(self.symbols.get(s).kind, SymbolKind::Acronym(_)))
            {
                continue;
            }
            let n = self.store.acronyms.len() as u32;
            self.store.acronyms.push(d.name.name.clone());
            let _ = self.declare_plain(&d.name, SymbolKind::Acronym(n), d.text.as_deref());
        }
        Ok(())
    }

    pub(super) fn declare_files(&mut self, list: &[FileDecl]) -> Checked<()> {
        for f in list {
            let path = f.path.clone();
            let path = path.unwrap_or_else(|| format!("{}.put", f.name.name).into());
            let _ = self.declare_plain(&f.name, SymbolKind::File(path), f.text.as_deref());
        }
        Ok(())
    }
}
