//! Index expressions: from what stands between the parentheses of a symbol to the parts of its key.

use super::data::meant_range;
use super::expansion::range;
use super::follow::EXCHANGED;
use super::node::*;
use super::symbols::{DomainPosition, SymbolKind, UNIVERSE};
use super::{Checked, Compiler, Failed};
use crate::diag::{Diagnostic, Severity, nearest};
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind, Ident};
use std::sync::Arc;

impl Compiler {
    /// Whether set `a` may stand at a position of symbol `of`; a tuple set at as many as it has.
    pub(super) fn fits(
        &mut self,
        a: SymbolId,
        of: SymbolId,
        position: usize,
        span: Span,
    ) -> Checked<()> {
        if self.modes.at(span).universal {
            return Ok(());
        }
        let over = self.symbols.rooted(a).domain.clone();
        if over.len() == 1 {
            return self.fits_as(a, a, of, position, span);
        }
        let parts = self.controlled(a).unwrap_or_default().to_vec();
        for (k, set) in over.into_iter().enumerate() {
            let named = parts.get(k).and_then(|p| self.named_index(p));
            let s = match (named, set) {
                (Some(s), _) | (None, DomainPosition::Set(s)) => s,
                (None, DomainPosition::Universe) => UNIVERSE,
            };
            self.fits_as(s, a, of, position + k, span)?;
        }
        Ok(())
    }

    /// The set under control that a part is the index of: `i` in `loop(arc(i,j), …)`.
    fn named_index(&self, part: &Part) -> Option<SymbolId> {
        let Part::Slot(slot) = part else { return None };
        let is = |parts: &[Part]| matches!(parts, [Part::Slot(s)] if s == slot);
        let found = self.scope.iter().rev().find(|(_, parts)| is(parts));
        found.map(|(s, _)| *s)
    }

    /// Whether set `s`, which is `a` or runs within it, may stand at a position of symbol `of`.
    fn fits_as(
        &mut self,
        s: SymbolId,
        a: SymbolId,
        of: SymbolId,
        position: usize,
        span: Span,
    ) -> Checked<()> {
        let Some(&DomainPosition::Set(d)) = self.symbols.get(of).domain.get(position) else {
            return Ok(());
        };
        if self.symbols.is_subset(s, d) {
            return Ok(());
        }
        let name = |id| &self.symbols.get(id).name;
        let (an, dn, sn, on) = (name(a), name(d), name(s), name(of));
        let (why, help) = if s != a {
            (
                format!("`{an}` runs over `{sn}` there"),
                format!("declare `{an}` over the sets that `{on}` runs over, or name its indices"),
            )
        } else {
            let why = format!("`{an}` is not a subset of `{dn}`");
            (
                why,
                match self.symbols.is_subset(d, a) {
                    true => format!(
                        "`{dn}` is the smaller set: use an index that runs over `{dn}`, or declare `{on}` over `{an}`"
                    ),
                    false => format!(
                        "declare `{an}` as a subset (`set {an}({dn})`) or as an alias of `{dn}`; equal labels alone do not make it one"
                    ),
                },
            )
        };
        let (declared, a_root) = (
            self.symbols.get(of).declared,
            self.symbols.rooted(a).declared,
        );
        let place = format!("position {} of `{on}`", position + 1);
        Diagnostic::error("E0306", span)
            .says(format!(
                "`{an}` may not stand at {place}, which runs over `{dn}`"
            ))
            .label(why)
            .other(declared, format!("`{on}` is declared here"))
            .other(a_root, format!("`{an}` is declared here"))
            .help(help)
            .fail(self)
    }

    pub(super) fn wrong_dimension<T>(
        &mut self,
        of: SymbolId,
        span: Span,
        given: usize,
    ) -> Checked<T> {
        let s = self.symbols.get(of);
        let plural = |n: usize| match n {
            0 => "no index".to_string(),
            1 => "1 index".to_string(),
            n => format!("{n} indices"),
        };
        let names = self.symbols.domain_names(s).join(",");
        let (name, has) = (&s.name, plural(s.dim()));
        let shape = match names.is_empty() {
            true => name.to_string(),
            false => format!("{name}({names})"),
        };
        let are = match given {
            0 => "none is".to_string(),
            1 => "1 is".to_string(),
            n => format!("{n} are"),
        };
        Diagnostic::error("E0304", span)
            .says(format!("`{name}` has {has}, but {are} given here"))
            .label(format!("{} here", plural(given)))
            .other(s.declared, format!("declared with {has} here"))
            .help(match (s.dim(), &s.kind) {
                (0, SymbolKind::Parameter { .. } | SymbolKind::Variable(_)) if given == 1 => {
                    format!("write `{shape}`; a product is `{shape}*(…)`")
                }
                _ => format!("write `{shape}`"),
            })
            .fail(self)
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
            ExprKind::Apply(name, None, _) => self
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
        self.store.reshape(self.symbols.get_mut(s), dim);
    }

    /// Key of a symbol from its indices, all of which are under control.
    pub(super) fn key(&mut self, of: SymbolId, indices: &[Expr], span: Span) -> Checked<Key> {
        self.shape(of, indices);
        let dim = self.symbols.get(of).dim();
        // A tuple set under control stands for all its positions: `p(arc)`.
        let mut parts = Vec::with_capacity(dim);
        for (n, index) in indices.iter().enumerate() {
            if parts.len() >= dim {
                return self.wrong_dimension(of, span, indices.len());
            }
            let p = parts.len();
            match self.index(index, of, p) {
                Ok(part) => parts.extend(part),
                Err(Failed) => {
                    self.others_bound(&indices[n + 1..]);
                    return Err(Failed);
                }
            }
        }
        if parts.len() != dim {
            return self.wrong_dimension(of, span, parts.len().max(indices.len()));
        }
        Ok(Key { parts })
    }

    /// Behind an index that failed: whether the others are bound.
    fn others_bound(&mut self, indices: &[Expr]) {
        for e in indices {
            if let ExprKind::Apply(name, None, None) = &e.kind
                && let Some(s) = self.symbols.find(&name.name)
                && self.symbols.get(s).is_set()
            {
                let _ = self.set_index(s, name);
            }
        }
    }

    /// One index expression at a position of a symbol.
    pub(super) fn index(&mut self, e: &Expr, of: SymbolId, position: usize) -> Checked<Vec<Part>> {
        match &e.kind {
            ExprKind::Text(label) => Ok(vec![Part::Label(self.label(label, of, position, e.span)?)]),
            ExprKind::Apply(name, None, None) => {
                let Some(s) = self.symbols.find(&name.name) else {
                    return self.unknown_index(name);
                };
                if self.is_torn(s) {
                    return Err(Failed);
                }
                if !self.symbols.get(s).is_set() {
                    self.lookup_set(name)?;
                }
                let part = self.set_index(s, name)?;
                self.fits(s, of, position, e.span)?;
                Ok(part)
            }
            ExprKind::Apply(name, None, Some(inner)) => {
                // p(arc(i,j)): all controlled.
                let s = self.lookup_set(name)?;
                let key = self.key(s, inner, e.span)?;
                Ok(key.parts)
            }
            ExprKind::Sum(terms) => {
                let base = self.lag_base(&terms[0].1, of, position)?;
                Ok(vec![self.lag(e, base)?])
            }
            ExprKind::Binary(BinaryOp::CircularPlus | BinaryOp::CircularMinus, base, _) => {
                let base = self.lag_base(base, of, position)?;
                Ok(vec![self.lag(e, base)?])
            }
            ExprKind::Number(x) => {
                let text = x.to_string();
                Diagnostic::error("E0307", e.span)
                    .says("a number may not stand as an index")
                    .label("an index is expected")
                    .help(format!("if `{text}` is a label, quote it: `'{text}'`"))
                    .fail(self)
            }
            _ => Diagnostic::error("E0307", e.span)
                .says("this is not an index")
                .label("an index is expected")
                .help("an index is a set under control, a quoted label, or a lag such as `t-1` or `t++1`")
                .fail(self),
        }
    }

    pub(super) fn unknown_index<T>(&mut self, name: &Ident) -> Checked<T> {
        if self.store.universe.get(&name.name).is_some() {
            let d = Diagnostic::error("E0301", name.span)
                .says(format!("`{}` is not a set, but it is a label", name.name))
                .label("unknown set")
                .help(format!("quote labels in expressions: `'{}'`", name.name));
            return self.unknown(name, d);
        }
        self.lookup(name).and(Err(Failed))
    }

    /// A set name as an index: its slots, or the element of a singleton.
    pub(super) fn set_index(&mut self, s: SymbolId, name: &Ident) -> Checked<Vec<Part>> {
        if let Some(parts) = self.controlled(s) {
            return Ok(parts.to_vec());
        }
        let root = self.symbols.rooted(s);
        if matches!(root.kind, SymbolKind::Set { singleton: true }) {
            let (t, dim) = (root.table, root.dim());
            return Ok((0..dim).map(|p| Part::Singleton(t, p as u8)).collect());
        }
        let (declared, is_label) = (root.declared, self.store.universe.get(&name.name).is_some());
        let i = &name.name;
        let mut help = match self.in_equation {
            true => format!(
                "sum over it, `sum({i}, …)`, or add it to the equation's domain, `e({i})..`"
            ),
            false => format!(
                "sum over it, `sum({i}, …)`; write it on the left, `p({i}) = …`; or run over it, `loop({i}, … );`"
            ),
        };
        if is_label {
            help.push_str(&format!("; a label is quoted: `'{i}'`"));
        }
        let d = Diagnostic::error("E0303", name.span)
            .says(format!("the index `{i}` is not bound here"))
            .label("nothing says which elements")
            .other(declared, "the set is declared here")
            .help(help);
        self.unbound(name, d)
    }

    /// A quoted label at a position of a symbol.
    pub(super) fn label(
        &mut self,
        text: &str,
        of: SymbolId,
        position: usize,
        span: Span,
    ) -> Checked<u32> {
        let symbol = self.symbols.get(of);
        let Some(DomainPosition::Set(d)) = symbol.domain.get(position) else {
            return self.known_label(text, span);
        };
        let set = self.symbols.rooted(*d);
        let table = self.store.table(set.table);
        let known = self.store.universe.get(text);
        match known.filter(|&l| set.dynamic || table.find(&[l]).is_some()) {
            Some(l) => Ok(l),
            None => self.not_a_member(text, "'", of, position, span),
        }
    }

    /// A label that must be in the universe, unless this place may bring it there.
    pub(super) fn known_label(&mut self, text: &str, span: Span) -> Checked<u32> {
        if let Some(l) = self.store.universe.get(text) {
            return Ok(l);
        }
        if self.new_labels {
            return Ok(self.store.universe.intern(text));
        }
        let labels = self.store.universe.len().min(10_000) as u32;
        let near = nearest(text, (0..labels).map(|l| self.store.universe.name(l)));
        let message = format!("no set has the label `'{text}'`");
        let help = match near {
            Some(n) => format!("did you mean `'{n}'`?"),
            None => "a label must stand in data, or be assigned to, before it is used".into(),
        };
        if self.in_equation {
            // As in GAMS: there is no such record when the model is generated.
            let d = Diagnostic::warning("E0308", span)
                .says(message)
                .label("reads 0");
            d.help(help).report(self);
            return Ok(self.store.universe.intern(text));
        }
        let d = Diagnostic::error("E0308", span).says(message);
        d.label("unknown label").help(help).fail(self)
    }

    /// Runs `f` where labels may be new: on the left of an assignment, in the key of an equation.
    pub(super) fn defining<T>(&mut self, f: impl FnOnce(&mut Self) -> T) -> T {
        let before = std::mem::replace(&mut self.new_labels, true);
        let r = f(self);
        self.new_labels = before;
        r
    }

    /// A label that stands where the domain does not have it; `quote` stands around it.
    pub(super) fn not_a_member(
        &mut self,
        text: &str,
        quote: &str,
        of: SymbolId,
        position: usize,
        span: Span,
    ) -> Checked<u32> {
        let symbol = self.symbols.get(of);
        let set_id = match symbol.domain.get(position) {
            Some(DomainPosition::Set(d)) => self.symbols.root(*d),
            _ => UNIVERSE,
        };
        if self.is_torn(set_id) || self.lost.elements.contains(&set_id) {
            return Err(Failed);
        }
        let set = self.symbols.get(set_id);
        let table = self.store.table(set.table);
        if table.is_empty() && !set.has_data && !set.assigned {
            let name = set.name.clone();
            Diagnostic::error("E0319", span)
                .says(format!("the set `{name}` has no elements"))
                .label("no label is in it")
                .other(set.declared, "declared without elements here")
                .help(format!(
                    "write its elements between slashes: `set {name} / {quote}{text}{quote}, … /;`"
                ))
                .report(self);
            self.lose_declaration(&name);
            return Err(Failed);
        }
        let known =
            (0..table.len().min(10_000) as u32).map(|r| self.store.universe.name(table.key(r)[0]));
        let (name, set_name) = (&symbol.name, &set.name);
        let near = nearest(text, known);
        let (written, mut lost) = (format!("`{quote}{text}{quote}`"), false);
        let help = if let Some(help) = self.misread(set.table, text) {
            help
        } else if let Some(near) = near {
            format!("did you mean `{quote}{near}{quote}`?")
        } else if !quote.is_empty() && self.symbols.find_set(text).is_some() {
            format!("an index stands without quotes: `{text}`; quotes make it one label")
        } else if let Some(elsewhere) = self.member_elsewhere(of, position, text) {
            lost = quote.is_empty();
            elsewhere
        } else {
            let blanks = match quote {
                "" => "; a label with a blank stands in quotes",
                _ => "",
            };
            format!("add {written} to `{set_name}`, or correct the label{blanks}")
        };
        let place = format!("position {} of `{name}`", position + 1);
        let mut d = Diagnostic::error("E0308", span)
            .says(format!("{written} is not a member of the set `{set_name}`"))
            .label(format!("{place} runs over `{set_name}`"))
            .other(set.declared, format!("`{set_name}` is declared here"))
            .help(help);
        self.doubtful.retain(|(s, _)| *s != set_id);
        if self.modes.at(span).warnings {
            d.severity = Severity::Warning;
            d.report(self);
            return Ok(self.store.universe.intern(text));
        }
        // Declared over the wrong set: what its uses show is no news.
        if lost {
            let name = name.clone();
            self.lose_declaration(&name);
        }
        d.fail(self)
    }

    /// A label that another position of the symbol's domain has, or another set alone.
    fn member_elsewhere(&self, of: SymbolId, position: usize, text: &str) -> Option<String> {
        let label = self.store.universe.get(text)?;
        let has = |s: SymbolId| {
            let set = self.symbols.rooted(s);
            set.dim() == 1 && self.store.table(set.table).find(&[label]).is_some()
        };
        let symbol = self.symbols.get(of);
        let other = symbol.domain.iter().enumerate().find_map(|(n, d)| match d {
            DomainPosition::Set(s) if n != position && has(*s) => Some((n, *s)),
            _ => None,
        });
        let of = &symbol.name;
        if let Some((n, set)) = other {
            let (set, n) = (&self.symbols.get(set).name, n + 1);
            return Some(format!(
                "`{text}` is a member of `{set}`, at position {n} of `{of}`: {EXCHANGED}, with dots between them in data"
            ));
        }
        let own = |s: SymbolId| self.symbols.root(s) == s;
        let sets = self.symbols.iter().skip(1);
        let sets = sets.filter(|(s, d)| d.is_set() && own(*s) && has(*s));
        let mut names = sets.map(|(_, d)| &d.name);
        let (name, none) = (names.next()?, names.next().is_none());
        none.then(|| format!("`{text}` is a member of `{name}`: correct the label, or declare `{of}` over `{name}`"))
    }

    /// Where a label went that a set lacks: into the text of an element, or a range with a hyphen.
    fn misread(&self, set: TableId, label: &str) -> Option<String> {
        let table = self.store.table(set);
        let texts = self.store.texts.get(&set);
        (0..table.len().min(10_000) as u32).find_map(|row| {
            let key = table.key(row);
            let element = self.store.universe.name(*key.first()?);
            let text = texts.and_then(|t| t.get(key)).map_or("", |t| t);
            if let Some((from, to)) = meant_range(element, text)
                && range(from, to, 1000).is_ok_and(|all| all.iter().any(|l| l.eq_ignore_ascii_case(label)))
            {
                return Some(format!("`{}` is one element; a range is written `{from}*{to}`", [element, text].join(" ").trim_end()));
            }
            text.split_whitespace().any(|w| w.eq_ignore_ascii_case(label)).then(|| {
                format!("`{text}` is the explanatory text of `{element}`: commas stand between elements, `{element}, {}`", text.split_whitespace().collect::<Vec<_>>().join(", "))
            })
        })
    }

    pub(super) fn lag_base(
        &mut self,
        base: &Expr,
        of: SymbolId,
        position: usize,
    ) -> Checked<(Part, TableId)> {
        match &base.kind {
            ExprKind::Apply(name, attribute, None)
                if attribute
                    .as_ref()
                    // `i.local` was put under control before.
                    .is_none_or(|a| a.name.eq_ignore_ascii_case("local")) =>
            {
                let Some(s) = self.symbols.find(&name.name) else {
                    return self.unknown_index(name);
                };
                if !self.symbols.get(s).is_set() {
                    self.lookup_set(name)?;
                }
                let mut part = self.set_index(s, name)?;
                self.runs(s, name.span, "a lag or lead")?;
                self.ordered(s, name.span, "a lag or lead")?;
                self.fits(s, of, position, base.span)?;
                let table = self.symbols.get(s).table;
                match part.len() {
                    1 => Ok((part.remove(0), table)),
                    _ => Diagnostic::error("E0307", base.span)
                        .says("a lag needs a one-dimensional set")
                        .label("several indices")
                        .fail(self),
                }
            }
            ExprKind::Text(label) => Diagnostic::error("E0309", base.span)
                .says(format!("the label `'{label}'` takes no lag or lead"))
                .label("a label is one element")
                .help("write the label you mean, or use an index that runs")
                .fail(self),
            _ => Diagnostic::error("E0307", base.span)
                .says("this is not an index")
                .label("an index is expected")
                .help("a lag or lead starts from a set under control: `t-1`, `t+k`, `t++1`")
                .fail(self),
        }
    }

    /// `t-1`, `t+k`.
    pub(super) fn lag(&mut self, e: &Expr, (base, set): (Part, TableId)) -> Checked<Part> {
        let (offset, circular) = match &e.kind {
            ExprKind::Binary(op, _, offset) => {
                let offset = self.expr(offset)?;
                let span = offset.span;
                let offset = match op {
                    BinaryOp::CircularMinus => {
                        Node::data(NodeKind::Sum(vec![(true, offset)]), span)
                    }
                    _ => offset,
                };
                (offset, true)
            }
            ExprKind::Sum(terms) => {
                if terms.len() > 2 {
                    return Diagnostic::error("E0309", e.span)
                        .says("an index takes one lag or lead")
                        .label("several")
                        .help("put the sum into parentheses: `t+(k+1)`")
                        .fail(self);
                }
                let mut offset = Vec::new();
                for (minus, t) in &terms[1..] {
                    offset.push((*minus, self.expr(t)?));
                }
                let offset = match offset.len() {
                    1 if !offset[0].0 => offset.remove(0).1,
                    _ => Node::data(NodeKind::Sum(offset), e.span),
                };
                self.no_variable(&offset, "a lag")?;
                (offset, false)
            }
            _ => unreachable!("lags are sums or circular"),
        };
        Ok(Part::Lag(Arc::new(Lag {
            base,
            set,
            offset,
            circular,
        })))
    }

    /// An error unless the set has an order.
    pub(super) fn ordered(&mut self, s: SymbolId, span: Span, what: &str) -> Checked<()> {
        if self.modes.at(span).off_order {
            return Ok(());
        }
        let root = self.symbols.rooted(s);
        let name = &root.name;
        let d = Diagnostic::error("E0309", span).other(root.declared, "declared here");
        let needs = format!("{what} needs an ordered set;");
        if matches!(root.kind, SymbolKind::Set { singleton: true }) {
            d.says(format!("{needs} `{name}` is a singleton"))
        } else if root.dynamic {
            d.says(format!("{needs} `{name}` is changed by an assignment"))
                .label("a dynamic set has no order")
                .help("use the set that it is a subset of, or `$offOrder`")
        } else if root.unordered {
            d.says(format!(
                "{needs} the labels of `{name}` appeared earlier in another order"
            ))
            .label("not ordered")
            .help(
                "declare the set with its labels in the wanted order before they appear elsewhere",
            )
        } else {
            return Ok(());
        }
        .fail(self)
    }
}
