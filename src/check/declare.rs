//! Declarations.

use super::node::{SymbolId, TableId};
use super::symbols::{DomainPosition, ModelInfo, Symbol, SymbolKind, UNIVERSE, attribute};
use super::{Checked, Compiler, Failed, functions};
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
            let (name, declared) = (&d.name.name, symbol.declared);
            if symbol.dim() != 1 {
                return Diagnostic::error("E0334", d.name.span)
                    .says(format!("`{name}` has several positions; a domain is one-dimensional"))
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
                return Diagnostic::error("E0339", d.name.span)
                    .says(format!(
                        "`{name}` is changed by an assignment; it cannot be a domain"
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
        let (dim, name) = (domain.len(), &d.name.name);
        if dim > 20 {
            return Diagnostic::error("E0336", d.name.span)
                .says(format!(
                    "`{name}` has {dim} index positions; there may be 20"
                ))
                .fail(self);
        }
        let table = tables(self, dim);
        let most = match kind {
            SymbolKind::Set { .. } => Some(1),
            SymbolKind::Parameter { scalar: false }
            | SymbolKind::Variable(_)
            | SymbolKind::Equation(_) => Some(0),
            _ => None,
        };
        let universal = d.domain.iter().flatten().all(|n| &*n.name.name == "*");
        let open = universal && most.is_some_and(|most| dim <= most);
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
            let shape = match (unlike, old.dim()) {
                (true, _) => String::new(),
                (false, 0) => " without an index".into(),
                (false, 1) => " with 1 index".into(),
                (false, n) => format!(" with {n} indices"),
            };
            let (name, what) = (&d.name.name, old.a_kind());
            return Diagnostic::error("E0333", d.name.span)
                .says(format!("`{name}` is declared already, as {what}{shape}"))
                .label("declared again")
                .other(old.declared, "first declared here")
                .help(match (kind, &old.kind) {
                    (SymbolKind::Model(_), SymbolKind::Equation(_)) => {
                        "the equations of a model stand between slashes: `model m / e, f /;`".into()
                    }
                    _ => format!("choose another name{capitals}"),
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
                let name = &d.name.name;
                return Diagnostic::error("E0335", d.name.span)
                    .says(format!("`{name}` is declared already over other sets"))
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
                let name = &set.symbol.name.name;
                let names: Vec<&str> = over.iter().map(|n| &*n.name.name).collect();
                let names = names.join(", ");
                let at = over[0].name.span.to(over[over.len() - 1].name.span);
                Diagnostic::error("E0302", at)
                    .says("none of these is a set")
                    .label("in parentheses stand the sets that it runs over")
                    .help(format!(
                        "elements stand between slashes: `set {name} / {names} /;`"
                    ))
                    .report(self);
                self.lose_declaration(name);
                continue;
            }
            let mut d = set.symbol.clone();
            let new = self.symbols.find(&d.name.name).is_none();
            let explicit = d.domain.is_some();
            if d.domain.is_none() && new {
                let (name, span) = ("*".into(), d.name.span);
                let name = Ident { name, span };
                let defines = false;
                d.domain = Some(vec![DomainName { name, defines }]);
            }
            let singleton = set.singleton;
            let kind = SymbolKind::Set { singleton };
            let Ok(s) = self.declare(&d, kind, |c, n| c.store.add_table(n, 0.0)) else {
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
            let known = group.iter().find_map(|n| match &*n.name {
                "*" => Some(UNIVERSE),
                name => self.symbols.find_set(name),
            });
            let Some(root) = known.map(|s| self.symbols.root(s)) else {
                if group.iter().any(|n| self.is_lost(&n.name)) {
                    group.iter().for_each(|n| self.lose(&n.name));
                    continue;
                }
                let span = group[0].span.to(group[group.len() - 1].span);
                return Diagnostic::error("E0337", span)
                    .says("none of these names is a set")
                    .label("`alias` gives a set another name")
                    .help("declare the set first: `set i / … /; alias(i, j);`")
                    .fail(self);
            };
            if let [alone] = &group[..] {
                Diagnostic::warning("E0380", alone.span)
                    .says(format!(
                        "`alias({0})` gives `{0}` no other name",
                        alone.name
                    ))
                    .help(format!(
                        "name the other one too: `alias({}, j);`",
                        alone.name
                    ))
                    .report(self);
            }
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
            let mut domain = p.symbol.domain.iter().flatten();
            if let Some(first) = domain.next().filter(|_| p.scalar) {
                let (name, index) = (&p.symbol.name.name, &first.name.name);
                Diagnostic::error("E0336", first.name.span)
                    .says(format!("`{name}` is a scalar: it has no index"))
                    .label("no index here")
                    .help(format!("write `parameter {name}({index}) …`"))
                    .report(self);
                self.lose_declaration(name);
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
            let unstated = SymbolKind::Variable(VariableKind::Unstated);
            let Ok(s) = self.declare(d, unstated, Self::record_tables) else {
                continue;
            };
            if kind != VariableKind::Unstated {
                if self.other_kind(s, kind, d.name.span).is_err() {
                    continue;
                }
                self.symbols.get_mut(s).kind = SymbolKind::Variable(kind);
                let lo = match kind {
                    VariableKind::Free | VariableKind::Negative => f64::NEG_INFINITY,
                    VariableKind::SemiContinuous | VariableKind::SemiInteger => 1.0,
                    _ => 0.0,
                };
                let up = match kind {
                    VariableKind::Negative => 0.0,
                    VariableKind::Binary => 1.0,
                    _ => f64::INFINITY,
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
                let mut equations = self.equations.iter();
                let used =
                    symbol.assigned || equations.any(|e| e.left.mentions(s) || e.right.mentions(s));
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
            let Ok(s) = self.declare(d, SymbolKind::Equation(None), Self::record_tables) else {
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
            let mut failed = false;
            for item in m.items.iter().flatten() {
                failed |= self.check_model_item(item).is_err();
            }
            let old = self.symbols.find(&m.name.name);
            let old = old.and_then(|s| match &self.symbols.get(s).kind {
                SymbolKind::Model(info) => info.items.clone(),
                _ => None,
            });
            let given = m.items.as_ref().map(|i| self.expand_all(i));
            let items = match (given, old) {
                // Known all the same, so that its solve is not a second error.
                _ if failed => None,
                (Some(new), Some(mut old)) if self.modes.at(m.name.span).multi => {
                    old.extend(new);
                    Some(old)
                }
                (given, old) => given.or(old),
            };
            let kind = SymbolKind::Model(Arc::new(ModelInfo { items }));
            let _ = self.declare_plain(&m.name, kind, m.text.as_deref());
        }
        Ok(())
    }

    /// `all` means the equations declared so far (their definitions may come later).
    fn expand_all(&self, items: &[ModelItem]) -> Vec<ModelItem> {
        let mut out = Vec::new();
        for item in items {
            let ModelItem::All(span) = *item else {
                out.push(item.clone());
                continue;
            };
            let all = self.symbols.iter().map(|(_, s)| s);
            let equations = all.filter(|s| matches!(s.kind, SymbolKind::Equation(_)));
            let names = equations.map(|s| s.name.clone());
            out.extend(names.map(|name| ModelItem::Add(Ident { name, span })));
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
            let symbol = c.symbols.get(s);
            let what = symbol.a_kind();
            match symbol.kind {
                SymbolKind::Equation(_) => Ok(()),
                SymbolKind::Model(_) if model_too => Ok(()),
                _ => Diagnostic::error("E0338", n.span)
                    .says(format!("`{}` is {what}; a model is made of equations", n.name))
                    .label("not an equation")
                    .other(symbol.declared, "declared here")
                    .help("list equations, or `model m / all /;` for all of them; variables are found in them; a pair of a complementarity problem is `e.x`")
                    .fail(c),
            }
        };
        match item {
            ModelItem::All(_) => Ok(()),
            ModelItem::Add(n) | ModelItem::Remove(n) => is_equation(self, n, true),
            ModelItem::Limit(variable, sets) => self.check_limit(variable, sets),
            ModelItem::Pair { rows, column } => {
                for r in rows {
                    is_equation(self, r, false)?;
                }
                let v = self.lookup(column)?;
                let symbol = self.symbols.get(v);
                if !matches!(symbol.kind, SymbolKind::Variable(_)) {
                    let (name, what) = (&column.name, symbol.a_kind());
                    return Diagnostic::error("E0338", column.span)
                        .says(format!(
                            "`{name}` is {what}; an equation is paired with a variable"
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
        let symbol = self.symbols.get(v);
        let (name, dim) = (&symbol.name, symbol.dim());
        if !matches!(symbol.kind, SymbolKind::Variable(_)) {
            let kind = symbol.kind_name();
            return Diagnostic::error("E0338", variable.span)
                .says(format!("the {kind} `{name}` stands here without indices"))
                .label("only variables are limited to a set")
                .other(symbol.declared, "declared here")
                .help(format!(
                    "write `{name}` alone; which rows there are is said where the equation is defined: `e(i)$s(i)..`"
                ))
                .fail(self);
        }
        let [set] = sets else {
            return Diagnostic::error("E0338", variable.span)
                .says("one set says which columns there are")
                .label("not one set")
                .help(format!(
                    "write `{name}(s)` with a set `s` of the dimension of `{name}`"
                ))
                .fail(self);
        };
        let s = self.lookup_set(set)?;
        match self.symbols.get(s).dim() == dim {
            true => Ok(()),
            false => self.wrong_dimension(s, set.span, dim),
        }
    }

    pub(super) fn declare_acronyms(&mut self, list: &[SymbolDecl]) -> Checked<()> {
        for d in list {
            let known = self.symbols.find(&d.name.name);
            let is_one = |s| matches!(self.symbols.get(s).kind, SymbolKind::Acronym(_));
            if known.is_some_and(is_one) {
                continue;
            }
            let n = self.store.acronyms.len() as u32;
            self.store.acronyms.push(d.name.name.clone());
            let _ = self.declare_plain(&d.name, SymbolKind::Acronym(n), d.text.as_deref());
        }
        Ok(())
    }

    /// `function f /stolib.dnormal/;`
    pub(super) fn declare_functions(&mut self, list: &[FileDecl]) -> Checked<()> {
        for f in list {
            let path = f.path.as_deref().unwrap_or_default().to_lowercase();
            let Some(found) = functions::of_library(&path) else {
                let known = functions::names_in_library();
                return Diagnostic::error("E0301", f.name.span)
                    .says(format!("the library function `{path}` is not in bmod"))
                    .help(format!("there are, of `stolib`: {}", known.join(", ")))
                    .fail(self);
            };
            self.library.insert(f.name.name.to_lowercase(), found);
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
