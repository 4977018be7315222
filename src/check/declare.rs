//! Declarations and data statements.

use super::expansion::{MAX_EXPANSION, NoRange, Tuples, range};
use super::node::{SymbolId, TableId};
use super::symbols::{DomainPosition, ModelInfo, Symbol, SymbolKind, UNIVERSE, attribute};
use super::{Compiler, Failed};
use crate::data::universe::Label;
use crate::data::value::{self, EPS};
use crate::diag::{Diagnostic, nearest};
use crate::source::{SourceMap, Span};
use crate::syntax::ast::{
    DomainName, Ident, ModelDecl, ModelItem, ParameterDecl, SetDecl, SymbolDecl, VariableKind,
};
use crate::syntax::data::{DataKind, DataReader, KeyPart, Tail, width};
use std::rc::Rc;

impl Compiler {
    fn positions(&mut self, domain: &[DomainName]) -> Result<Vec<DomainPosition>, Failed> {
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
                return self.fail(
                    Diagnostic::error(
                        "E0334",
                        d.name.span,
                        format!(
                            "`{}` has several positions; a domain is one-dimensional",
                            d.name.name
                        ),
                    )
                    .label("not one-dimensional")
                    .other(declared, "declared here"),
                );
            }
            if root == UNIVERSE {
                out.push(DomainPosition::Universe);
                continue;
            }
            if symbol.dynamic {
                let declared = symbol.declared;
                return self.fail(
                    Diagnostic::error(
                        "E0339",
                        d.name.span,
                        format!(
                            "`{}` is changed by an assignment; it cannot be a domain",
                            d.name.name
                        ),
                    )
                    .label("a domain must stay as it is")
                    .other(declared, "declared here")
                    .help("use the set that it is a subset of as the domain"),
                );
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
    ) -> Result<SymbolId, Failed> {
        let domain = self.positions(d.domain.as_deref().unwrap_or(&[]))?;
        if let Some(s) = self.symbols.find(&d.name.name) {
            let old = self.symbols.get(s).clone();
            if std::mem::discriminant(&old.kind) != std::mem::discriminant(&kind) || s == UNIVERSE {
                return self.fail(
                    Diagnostic::error(
                        "E0333",
                        d.name.span,
                        format!(
                            "`{}` is declared already, as a {}",
                            d.name.name,
                            old.kind_name()
                        ),
                    )
                    .label("declared again")
                    .other(old.declared, "first declared here")
                    .help("choose another name"),
                );
            }
            if old.open && d.domain.is_some() && domain.len() <= 20 {
                self.reshape(s, domain.len());
                let symbol = self.symbols.get_mut(s);
                symbol.domain = domain;
                symbol.open = false;
                return Ok(s);
            }
            if d.domain.is_some() && domain.len() != old.dim() {
                return self.wrong_dimension(s, d.name.span, domain.len());
            }
            if d.domain.is_some()
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
                    return self.fail(
                        Diagnostic::error(
                            "E0335",
                            d.name.span,
                            format!("`{}` is declared already over other sets", d.name.name),
                        )
                        .label("declared again")
                        .other(old.declared, "first declared here"),
                    );
                }
            }
            let symbol = self.symbols.get_mut(s);
            if let Some(t) = &d.text
                && symbol.text.is_empty()
            {
                symbol.text = t.clone();
            }
            return Ok(s);
        }
        let dim = domain.len();
        if dim > 20 {
            return self.fail(Diagnostic::error(
                "E0336",
                d.name.span,
                format!(
                    "`{}` has {dim} index positions; there may be 20",
                    d.name.name
                ),
            ));
        }
        let table = tables(self, dim);
        let open = d
            .domain
            .as_ref()
            .is_none_or(|l| l.iter().all(|n| &*n.name.name == "*"))
            && dim == usize::from(matches!(kind, SymbolKind::Set { .. }))
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

    pub(super) fn declare_plain(
        &mut self,
        name: &Ident,
        kind: SymbolKind,
        text: Option<&str>,
    ) -> Result<SymbolId, Failed> {
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

    pub(super) fn declare_sets(&mut self, list: &[SetDecl], map: &SourceMap) -> Result<(), Failed> {
        for set in list {
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
            if let Some(body) = d.data {
                let _ = self.set_data(s, body, d.name.span, map);
            }
        }
        Ok(())
    }

    pub(super) fn declare_aliases(&mut self, groups: &[Vec<Ident>]) -> Result<(), Failed> {
        for group in groups {
            let known = group.iter().find_map(|n| {
                if &*n.name == "*" {
                    Some(UNIVERSE)
                } else {
                    self.symbols
                        .find(&n.name)
                        .filter(|&s| self.symbols.get(s).is_set())
                }
            });
            let Some(root) = known.map(|s| self.symbols.root(s)) else {
                let span = group[0].span.to(group[group.len() - 1].span);
                return self.fail(
                    Diagnostic::error("E0337", span, "none of these names is a set")
                        .label("`alias` gives a set another name")
                        .help("declare the set first: `set i / … /; alias(i, j);`"),
                );
            };
            for n in group {
                if &*n.name == "*" {
                    continue;
                }
                match self.symbols.find(&n.name) {
                    Some(s) if self.symbols.root(s) == root => {}
                    Some(s) => {
                        let declared = self.symbols.get(s).declared;
                        let _ = self.fail::<()>(
                            Diagnostic::error(
                                "E0333",
                                n.span,
                                format!("`{}` is declared already", n.name),
                            )
                            .label("declared again")
                            .other(declared, "first declared here"),
                        );
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
    ) -> Result<(), Failed> {
        for p in list {
            let kind = SymbolKind::Parameter { scalar: p.scalar };
            let Ok(s) = self.declare(&p.symbol, kind, |c, n| c.store.add_table(n, 0.0)) else {
                continue;
            };
            if let Some(body) = p.symbol.data {
                let defines = p.symbol.defines();
                let _ = self.parameter_data(s, body, p.symbol.name.span, &defines, map);
            }
        }
        Ok(())
    }

    pub(super) fn declare_variables(
        &mut self,
        kind: VariableKind,
        list: &[SymbolDecl],
        map: &SourceMap,
    ) -> Result<(), Failed> {
        for d in list {
            let Ok(s) = self.declare(d, SymbolKind::Variable(VariableKind::Unstated), |c, n| {
                c.record_tables(n)
            }) else {
                continue;
            };
            if kind != VariableKind::Unstated {
                let symbol = self.symbols.get(s);
                if let SymbolKind::Variable(before) = symbol.kind
                    && before != VariableKind::Unstated
                    && before != kind
                {
                    let d = Diagnostic::error(
                        "E0348",
                        d.name.span,
                        format!("the variable `{}` has another kind already", symbol.name),
                    )
                    .label("a second kind")
                    .other(symbol.declared, "declared here")
                    .help(
                        "a variable has one kind; assign its bounds `.lo` and `.up` to narrow it",
                    );
                    self.report(d);
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
    ) -> Result<(), Failed> {
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

    pub(super) fn declare_models(&mut self, list: &[ModelDecl]) -> Result<(), Failed> {
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
                        SymbolKind::Model(Rc::new(ModelInfo::default())),
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
                (Some(new), Some(mut old)) if self.modes.multi => {
                    old.extend(new.iter().cloned());
                    Some(old)
                }
                (Some(new), _) => Some(new.clone()),
                (None, old) => old,
            };
            let _ = self.declare_plain(
                &m.name,
                SymbolKind::Model(Rc::new(ModelInfo { items })),
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
                            ModelItem::Add(
                                Ident {
                                    name: s.name.clone(),
                                    span: *span,
                                },
                                None,
                            )
                        }),
                ),
                other => out.push(other.clone()),
            }
        }
        out
    }

    fn check_model_item(&mut self, item: &ModelItem) -> Result<(), Failed> {
        let is_equation = |c: &mut Self, n: &Ident, model_too: bool| {
            let s = c.lookup(n)?;
            let symbol = c.symbols.get(s).clone();
            match symbol.kind {
                SymbolKind::Equation(_) => Ok(()),
                SymbolKind::Model(_) if model_too => Ok(()),
                _ => c.fail(
                    Diagnostic::error(
                        "E0338",
                        n.span,
                        format!(
                            "`{}` is a {}; a model is made of equations",
                            n.name,
                            symbol.kind_name()
                        ),
                    )
                    .label("not an equation")
                    .other(symbol.declared, "declared here"),
                ),
            }
        };
        match item {
            ModelItem::All(_) => Ok(()),
            ModelItem::Add(n, sub) => {
                is_equation(self, n, true)?;
                for s in sub.iter().flatten() {
                    self.lookup_set(s)?;
                }
                Ok(())
            }
            ModelItem::Remove(n) => is_equation(self, n, true),
            ModelItem::Pair { rows, column } => {
                for r in rows {
                    is_equation(self, r, false)?;
                }
                let v = self.lookup(column)?;
                let symbol = self.symbols.get(v).clone();
                if !matches!(symbol.kind, SymbolKind::Variable(_)) {
                    return self.fail(
                        Diagnostic::error(
                            "E0338",
                            column.span,
                            format!(
                                "`{}` is a {}; an equation is paired with a variable",
                                column.name,
                                symbol.kind_name()
                            ),
                        )
                        .label("not a variable")
                        .other(symbol.declared, "declared here"),
                    );
                }
                Ok(())
            }
        }
    }

    pub(super) fn declare_acronyms(&mut self, list: &[SymbolDecl]) -> Result<(), Failed> {
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

    pub(super) fn declare_files(
        &mut self,
        list: &[(Ident, Option<Box<str>>)],
    ) -> Result<(), Failed> {
        for (name, outside) in list {
            let outside = outside
                .clone()
                .unwrap_or_else(|| format!("{}.put", name.name).into());
            let _ = self.declare_plain(name, SymbolKind::File(outside), None);
        }
        Ok(())
    }

    /// Whether a symbol may get data now; clears it for `$onMultiR`.
    pub(super) fn open_data(&mut self, s: SymbolId, span: Span) -> Result<(), Failed> {
        self.symbols.get_mut(s).open = false;
        let symbol = self.symbols.get(s);
        let (had, declared, name, table) = (
            symbol.has_data,
            symbol.declared,
            symbol.name.clone(),
            symbol.table,
        );
        if had && !self.modes.multi && !self.modes.multi_replace {
            return self.fail(
                Diagnostic::error("E0340", span, format!("`{name}` has data already"))
                    .label("second data statement")
                    .other(declared, "first declared here")
                    .help("assign instead (`p(i) = …;`), or allow merging with `$onMulti`"),
            );
        }
        if had && self.modes.multi_replace {
            self.store.table_mut(table).clear();
            self.store.texts.remove(&table);
        }
        self.symbols.get_mut(s).has_data = true;
        Ok(())
    }

    /// A symbol declared without a domain has as many indices as its first record. A dot behind a
    /// blank begins a number there.
    fn shape_by_data(&mut self, s: SymbolId, text: &str, kind: DataKind) {
        let mut reader = DataReader::new(text, 0, kind, true).with_arity(1);
        if let Some(Ok(r)) = reader.next()
            && (kind == DataKind::Set || !matches!(r.value, Tail::None))
        {
            let spelled_out = set_prefix(r.key);
            let key = spelled_out.as_deref().unwrap_or(r.key);
            let dim = width(key) + r.matched.map_or(0, width);
            self.set_dimension(s, dim);
        }
    }

    /// Takes the number of indices that data show.
    pub(super) fn set_dimension(&mut self, s: SymbolId, dim: usize) {
        if dim > 0 && dim <= 20 && dim != self.symbols.get(s).dim() {
            self.reshape(s, dim);
        }
    }

    fn set_data(
        &mut self,
        s: SymbolId,
        body: Span,
        name: Span,
        map: &SourceMap,
    ) -> Result<(), Failed> {
        let open = self.symbols.get(s).open;
        self.open_data(s, name)?;
        if open {
            self.shape_by_data(s, map.text(body), DataKind::Set);
        }
        let symbol = self.symbols.get(s).clone();
        let (table, dim) = (symbol.table, symbol.dim());
        let mut reader = DataReader::new(map.text(body), body.lo, DataKind::Set, self.modes.undf)
            .with_arity(dim);
        let mut last: Option<Label> = self.last_label(table, dim);
        let mut unordered = symbol.unordered;
        while let Some(record) = reader.next() {
            let record = match record {
                Ok(r) => r,
                Err(d) => {
                    self.report(d);
                    break;
                }
            };
            let text: Option<Box<str>> = match &record.value {
                Tail::None => None,
                Tail::Text(t, _) => Some((&**t).into()),
                Tail::Number(_, span) => Some(map.text(*span).into()),
                Tail::Name(n, _) => Some((*n).into()),
            };
            let (mut keys, span) = (Vec::new(), record.span);
            if self
                .expand(s, record.key, record.matched, span, &[], &mut keys)
                .is_err()
            {
                continue;
            }
            for key in keys.chunks_exact(dim) {
                if self.store.table(table).find(key).is_some() {
                    if !self.modes.multi {
                        let label = self.key_text(key);
                        self.report(
                            Diagnostic::error(
                                "E0341",
                                span,
                                format!("the element {label} of `{}` appears twice", symbol.name),
                            )
                            .label("second time"),
                        );
                    }
                    continue;
                }
                if matches!(symbol.kind, SymbolKind::Set { singleton: true })
                    && !self.store.table(table).is_empty()
                {
                    self.report(
                        Diagnostic::error(
                            "E0342",
                            span,
                            format!("`{}` is a singleton: it has one element", symbol.name),
                        )
                        .label("second element"),
                    );
                    continue;
                }
                if dim == 1 {
                    unordered |= last.is_some_and(|l| l > key[0]);
                    last = Some(key[0]);
                }
                self.store.table_mut(table).set(key, 1.0);
                if let Some(t) = &text {
                    self.store
                        .texts
                        .entry(table)
                        .or_default()
                        .insert(key.into(), t.clone());
                }
            }
        }
        self.store.table_mut(table).tidy();
        self.symbols.get_mut(s).unordered = unordered;
        Ok(())
    }

    fn last_label(&self, table: TableId, dim: usize) -> Option<Label> {
        let t = self.store.table(table);
        (dim == 1 && !t.is_empty()).then(|| t.key(t.len() as u32 - 1)[0])
    }

    /// `'a'.'x'`, for messages.
    fn key_text(&self, key: &[Label]) -> String {
        let names: Vec<String> = key
            .iter()
            .map(|&l| format!("'{}'", self.store.universe.name(l)))
            .collect();
        names.join(".")
    }

    /// All keys a record of data stands for, flat.
    pub(super) fn expand(
        &mut self,
        s: SymbolId,
        parts: &[KeyPart],
        matched: Option<&[KeyPart]>,
        span: Span,
        defines: &[bool],
        out: &mut Vec<Label>,
    ) -> Result<(), Failed> {
        let dim = self.symbols.get(s).dim();
        // `set.i` stands for all elements of i.
        let spelled_out = [parts].into_iter().find_map(set_prefix);
        let parts = spelled_out.as_deref().unwrap_or(parts);
        // One label per position is what data mostly are.
        if matched.is_none() && parts.iter().all(|p| matches!(p, KeyPart::Label { .. })) {
            if parts.len() != dim {
                return self.wrong_dimension(s, span, parts.len());
            }
            for (p, part) in parts.iter().enumerate() {
                let KeyPart::Label { text, span, .. } = part else {
                    unreachable!("tested above")
                };
                out.push(self.data_label(s, p, text, *span, defines)?);
            }
            return Ok(());
        }
        let mut rows = self.products(s, 0, parts, span, defines)?;
        if let Some(other) = matched {
            let behind = self.products(s, rows.width, other, span, defines)?;
            if rows.len() != behind.len() {
                self.report(
                    Diagnostic::warning("E0347", span, format!("`:` matches one by one, but there are {} on the left and {} on the right", rows.len(), behind.len()))
                        .label("what is left over on one side is dropped")
                        .help("a dot instead of the colon makes all combinations"),
                );
            }
            rows = rows.beside(&behind);
        }
        if rows.len() > 0 && rows.width != dim {
            return self.wrong_dimension(s, span, rows.width);
        }
        out.append(&mut rows.labels);
        Ok(())
    }

    /// All combinations of the parts of a key that begins at a position.
    pub(super) fn products(
        &mut self,
        s: SymbolId,
        position: usize,
        parts: &[KeyPart],
        span: Span,
        defines: &[bool],
    ) -> Result<Tuples, Failed> {
        let mut rows: Option<Tuples> = None;
        for part in parts {
            let at = position + rows.as_ref().map_or(0, |r| r.width);
            let choices = self.choices(s, at, part, span, defines)?;
            let before = rows.as_ref().map_or(1, Tuples::len);
            if before.saturating_mul(choices.len()) > MAX_EXPANSION {
                return self.fail(
                    Diagnostic::error(
                        "E0343",
                        span,
                        format!("this stands for more than {MAX_EXPANSION} records"),
                    )
                    .label("too many")
                    .help("make the set by an assignment with a condition"),
                );
            }
            rows = Some(match rows {
                Some(before) => before.times(&choices),
                None => choices,
            });
        }
        Ok(rows.unwrap_or_default())
    }

    /// The tuples one part of a key stands for.
    fn choices(
        &mut self,
        s: SymbolId,
        position: usize,
        part: &KeyPart,
        whole: Span,
        defines: &[bool],
    ) -> Result<Tuples, Failed> {
        match part {
            KeyPart::Label { text, span, .. } => {
                let label = self.data_label(s, position, text, *span, defines)?;
                Ok(Tuples::single(vec![label]))
            }
            KeyPart::Range { from, to, span } => {
                let labels = match range(from, to) {
                    Ok(labels) => labels,
                    Err(NoRange::TooLong(n)) => {
                        let d =
                            Diagnostic::error("E0343", *span, format!("this range has {n} labels"))
                                .label("too many")
                                .help(format!("{MAX_EXPANSION} are the most"));
                        return self.fail(d);
                    }
                    Err(NoRange::Unlike) => {
                        return self.fail(
                            Diagnostic::error(
                                "E0344",
                                *span,
                                format!("`{from}*{to}` is not a range"),
                            )
                            .label("the labels must differ in one number")
                            .help("for instance `i1*i10` or `1990*2000`"),
                        );
                    }
                };
                let labels = labels
                    .iter()
                    .map(|l| self.data_label(s, position, l, *span, defines));
                Ok(Tuples::single(labels.collect::<Result<_, _>>()?))
            }
            KeyPart::AllOf { set, span } => {
                let id = self.lookup_set(&Ident {
                    name: (*set).into(),
                    span: *span,
                })?;
                let t = self.symbols.get(id).table;
                if id == UNIVERSE {
                    self.store.refresh_universe();
                }
                Ok(Tuples::of(self.store.table(t)))
            }
            KeyPart::Universe(_) => {
                self.store.refresh_universe();
                let t = match self.symbols.get(s).domain.get(position) {
                    Some(DomainPosition::Set(d)) => self.symbols.get(*d).table,
                    _ => UNIVERSE,
                };
                Ok(Tuples::of(self.store.table(t)))
            }
            KeyPart::Group(alternatives) => {
                let mut out = Tuples::default();
                for alternative in alternatives {
                    let more = self.products(s, position, alternative, whole, defines)?;
                    if out.len() > 0 && more.len() > 0 && out.width != more.width {
                        return self.wrong_dimension(s, whole, position + more.width);
                    }
                    if more.len() > 0 {
                        out.width = more.width;
                    }
                    out.labels.extend(more.labels);
                }
                Ok(out)
            }
        }
    }

    /// A label in data at a position of a symbol; checked against the domain.
    fn data_label(
        &mut self,
        s: SymbolId,
        position: usize,
        text: &str,
        span: Span,
        defines: &[bool],
    ) -> Result<Label, Failed> {
        let symbol = self.symbols.get(s);
        let Some(DomainPosition::Set(d)) = symbol.domain.get(position) else {
            return Ok(self.store.universe.intern(text));
        };
        let set_id = self.symbols.root(*d);
        let set = self.symbols.get(set_id);
        let table = set.table;
        if let Some(l) = self.store.universe.get(text)
            && self.store.table(table).find(&[l]).is_some()
        {
            return Ok(l);
        }
        if defines.get(position) == Some(&true) {
            let l = self.store.universe.intern(text);
            self.store.table_mut(table).set(&[l], 1.0);
            self.symbols.get_mut(set_id).has_data = true;
            return Ok(l);
        }
        let (name, set_name, declared) = (symbol.name.clone(), set.name.clone(), set.declared);
        let t = self.store.table(table);
        let near = nearest(
            text,
            (0..t.len().min(10_000) as u32).map(|r| self.store.universe.name(t.key(r)[0])),
        )
        .map(str::to_string);
        let d = Diagnostic::error(
            "E0308",
            span,
            format!("`{text}` is not a member of the set `{set_name}`"),
        )
        .label(format!(
            "position {} of `{name}` runs over `{set_name}`",
            position + 1
        ))
        .other(declared, format!("`{set_name}` is declared here"));
        self.fail(match near {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d.help(format!(
                "add `{text}` to `{set_name}`, or correct the label"
            )),
        })
    }

    fn parameter_data(
        &mut self,
        s: SymbolId,
        body: Span,
        name: Span,
        defines: &[bool],
        map: &SourceMap,
    ) -> Result<(), Failed> {
        let open = self.symbols.get(s).open;
        self.open_data(s, name)?;
        let text = map.text(body);
        if open {
            self.shape_by_data(s, text, DataKind::Values);
        }
        let symbol = self.symbols.get(s).clone();
        let (table, dim) = (symbol.table, symbol.dim());
        let mut reader =
            DataReader::new(text, body.lo, DataKind::Values, self.modes.undf).with_arity(dim);
        let mut keys = Vec::new();
        while let Some(record) = reader.next() {
            let record = match record {
                Ok(r) => r,
                Err(d) => {
                    self.report(d);
                    break;
                }
            };
            let v = match (&record.value, record.key) {
                (Tail::Number(v, _), _) => *v,
                (Tail::Name(n, at), _) => match self.acronym(n, *at) {
                    Ok(v) => v,
                    Err(Failed) => continue,
                },
                // `/ 5 /` of a scalar comes as a lone label.
                (Tail::None, [KeyPart::Label { text, span, .. }]) if dim == 0 => match number(text)
                {
                    Some(v) => {
                        self.put_value(s, table, &[], v, *span);
                        continue;
                    }
                    None => match self.acronym(text, *span) {
                        Ok(v) => {
                            self.put_value(s, table, &[], v, *span);
                            continue;
                        }
                        Err(Failed) => continue,
                    },
                },
                (tail, _) => {
                    let at = if let Tail::Text(..) = tail {
                        "a text stands where a number is expected"
                    } else {
                        "no number follows the label"
                    };
                    self.report(
                        Diagnostic::error(
                            "E0345",
                            record.span,
                            format!(
                                "the data of `{}` need a number for each record",
                                symbol.name
                            ),
                        )
                        .label(at),
                    );
                    continue;
                }
            };
            keys.clear();
            let (span, key) = (record.span, record.key);
            if self
                .expand(s, key, record.matched, span, defines, &mut keys)
                .is_err()
            {
                if self.error_count() >= super::MAX_ERRORS {
                    break;
                }
                continue;
            }
            if dim == 0 {
                self.put_value(s, table, &[], v, span);
                continue;
            }
            for k in keys.chunks_exact(dim) {
                self.put_value(s, table, k, v, span);
            }
        }
        self.store.table_mut(table).tidy();
        Ok(())
    }

    pub(super) fn acronym(&mut self, name: &str, span: Span) -> Result<f64, Failed> {
        if let Some(s) = self.symbols.find(name)
            && let SymbolKind::Acronym(n) = self.symbols.get(s).kind
        {
            return Ok(value::acronym(n));
        }
        self.fail(
            Diagnostic::error("E0345", span, format!("`{name}` is not a number"))
                .label("a number is expected")
                .help("numbers are `1.5`, `-2e3`, `inf`, `eps`, `na`; other words must be declared as acronyms"),
        )
    }

    /// Stores a value of a data statement; an error if the record is there already.
    pub(super) fn put_value(
        &mut self,
        s: SymbolId,
        table: TableId,
        key: &[Label],
        v: f64,
        span: Span,
    ) {
        let v = if v == 0.0 && self.modes.eps { EPS } else { v };
        let t = &mut self.store.tables[table as usize];
        if !self.modes.multi && !t.is_after_last(key) && t.find(key).is_some() {
            let label = self.key_text(key);
            let name = self.symbols.get(s).name.clone();
            let what = if key.is_empty() {
                format!("`{name}` gets two values")
            } else {
                format!("the record {label} of `{name}` appears twice")
            };
            self.report(Diagnostic::error("E0341", span, what).label("second time"));
            return;
        }
        t.set(key, v);
    }

    /// `variable x(i) / a.lo 5 /`.
    fn record_data(&mut self, s: SymbolId, body: Span, map: &SourceMap) -> Result<(), Failed> {
        let symbol = self.symbols.get(s).clone();
        let mut reader =
            DataReader::new(map.text(body), body.lo, DataKind::Values, self.modes.undf);
        while let Some(record) = reader.next() {
            let record = match record {
                Ok(r) => r,
                Err(d) => {
                    self.report(d);
                    break;
                }
            };
            let Some((KeyPart::Label { text, span, .. }, key)) = record.key.split_last() else {
                continue;
            };
            let (attr, at) = (text.to_lowercase(), *span);
            let Tail::Number(v, _) = record.value else {
                self.report(
                    Diagnostic::error(
                        "E0345",
                        record.span,
                        "a number is expected behind the attribute",
                    )
                    .label("no number"),
                );
                continue;
            };
            let (span, mut keys) = (record.span, Vec::new());
            if symbol.dim() > 0 && self.expand(s, key, None, span, &[], &mut keys).is_err() {
                continue;
            }
            let offsets: &[u32] = match attr.as_str() {
                "l" => &[attribute::L],
                "m" => &[attribute::M],
                "lo" => &[attribute::LO],
                "up" => &[attribute::UP],
                "fx" => &[attribute::L, attribute::LO, attribute::UP],
                "scale" => &[attribute::SCALE],
                "prior" => &[attribute::PRIOR],
                _ => {
                    let _ = self.unknown_attribute::<()>(
                        &Ident {
                            name: attr.into(),
                            span: at,
                        },
                        &symbol.name,
                        symbol.kind_name(),
                        "l, m, lo, up, fx, scale, prior",
                    );
                    continue;
                }
            };
            for &o in offsets {
                let t = self.store.table_mut(symbol.table + o);
                if symbol.dim() == 0 {
                    t.set(&[], v);
                }
                for k in keys.chunks_exact(symbol.dim().max(1)) {
                    t.set(k, v);
                }
            }
            self.symbols.get_mut(s).assigned = true;
        }
        for o in 0..attribute::COUNT {
            self.store.table_mut(symbol.table + o).tidy();
        }
        Ok(())
    }
}

/// Replaces `set` and the name behind it by all elements of that set.
pub(super) fn set_prefix<'a>(parts: &[KeyPart<'a>]) -> Option<Vec<KeyPart<'a>>> {
    let is_set = |p: &KeyPart| matches!(p, KeyPart::Label { text, quoted: false, .. } if text.eq_ignore_ascii_case("set"));
    if !parts.iter().any(is_set) {
        return None;
    }
    let mut out = Vec::with_capacity(parts.len());
    let mut rest = parts.iter();
    while let Some(p) = rest.next() {
        match (is_set(p), rest.clone().next()) {
            (true, Some(KeyPart::Label { text, span, .. })) => {
                out.push(KeyPart::AllOf {
                    set: text,
                    span: *span,
                });
                rest.next();
            }
            _ => out.push(p.clone()),
        }
    }
    Some(out)
}

/// A number as it may stand in data.
fn number(text: &str) -> Option<f64> {
    let t = text.to_lowercase();
    Some(match t.as_str() {
        "inf" | "+inf" => f64::INFINITY,
        "-inf" => f64::NEG_INFINITY,
        "eps" => EPS,
        "na" => value::NA,
        "undf" => value::UNDF,
        "yes" => 1.0,
        "no" => 0.0,
        _ => fast_float2::parse(t.strip_prefix('+').unwrap_or(&t)).ok()?,
    })
}
