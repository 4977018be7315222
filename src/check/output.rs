//! What `display` and `put` write.

use super::node::*;
use super::symbols::SymbolKind;
use super::{Checked, Compiler, Failed, functions};
use crate::diag::Diagnostic;
use crate::source::Span;
use crate::syntax::ast::{DisplayItem, Expr, ExprKind, Ident, PutItem};

/// `` `x`, `y` ``
fn listed(names: &[(Ident, String)]) -> String {
    let names: Vec<String> = names.iter().map(|(n, _)| format!("`{}`", n.name)).collect();
    names.join(", ")
}

impl Compiler {
    pub(super) fn shown(&mut self, items: &[DisplayItem]) -> Checked<Vec<Shown>> {
        let mut out = Vec::new();
        let mut bare: Vec<(Ident, String)> = Vec::new();
        for item in items {
            match item {
                DisplayItem::Text(t, _) => out.push(Shown::Text(t.clone())),
                DisplayItem::Symbol(r) => {
                    let is_known = self.symbols.find(&r.name.name).is_some();
                    if !is_known && !r.indices.is_empty() && is_operation(&r.name.name) {
                        return Diagnostic::error("E0328", r.span)
                            .says("`display` takes symbols, not expressions")
                            .help("assign it first: `parameter total; total = …; display total;`")
                            .fail(self);
                    }
                    let s = self.lookup(&r.name)?;
                    let symbol = self.symbols.get(s).clone();
                    if !r.indices.is_empty() {
                        let (name, attribute) = (&r.name.name, r.attribute.as_ref());
                        let attribute = attribute.map(|a| format!(".{}", a.name));
                        let whole = format!("{name}{}", attribute.unwrap_or_default());
                        return Diagnostic::error("E0328", r.span)
                            .says("`display` takes whole symbols, without indices")
                            .label("indices here")
                            .help(format!(
                                "write `display {whole}`; or copy the part you want into a parameter"
                            ))
                            .fail(self);
                    }
                    let attr = match (&symbol.kind, &r.attribute) {
                        (SymbolKind::Variable(_) | SymbolKind::Equation(_), Some(a)) => {
                            let attribute = functions::display_attribute(&a.name);
                            if attribute.is_none() {
                                let (name, kind) = (&symbol.name, symbol.kind_name());
                                let known = "l, m, lo, up, scale, prior";
                                return self.unknown_attribute(a, name, kind, known);
                            }
                            attribute
                        }
                        (SymbolKind::Variable(_) | SymbolKind::Equation(_), None) => {
                            bare.push((r.name.clone(), symbol.a_kind()));
                            continue;
                        }
                        (SymbolKind::Model(_) | SymbolKind::File(_), Some(a)) => {
                            Some(self.object_attribute(s, a)?)
                        }
                        (_, Some(a)) => {
                            let kind = symbol.a_kind();
                            return Diagnostic::error("E0314", a.span)
                                .says(format!("{kind} has no attribute `.{}`", a.name))
                                .label("not an attribute")
                                .help(format!("write `display {};`", symbol.name))
                                .fail(self);
                        }
                        (_, None) => None,
                    };
                    if attr.is_none() || symbol.has_attributes() {
                        self.used(s, r.span);
                    }
                    out.push(Shown::Symbol(s, attr));
                }
            }
        }
        if let Some((first, kind)) = bare.first() {
            let levels: Vec<String> = bare.iter().map(|(n, _)| format!("{}.l", n.name)).collect();
            let message = match bare.len() {
                1 => format!("`{}` is {kind}; say which number to display", first.name),
                _ => format!(
                    "variables and equations are displayed with an attribute: {} have none",
                    listed(&bare)
                ),
            };
            let d = Diagnostic::error("E0310", first.span)
                .says(message)
                .label("an attribute is expected")
                .help(format!("for instance `display {};`", levels.join(", ")));
            let d = bare[1..]
                .iter()
                .fold(d, |d, (n, _)| d.other(n.span, "here too"));
            return d.fail(self);
        }
        Ok(out)
    }

    pub(super) fn put(
        &mut self,
        keyword: &str,
        items: &[PutItem],
        span: Span,
    ) -> Checked<CodeKind> {
        self.texts_allowed = true;
        let r = self.put_items(items);
        self.texts_allowed = false;
        if let Ok(items) = &r {
            let named = items.iter().rev().find_map(|i| match i {
                PutCode::File(s) => Some(*s),
                _ => None,
            });
            self.put_named = named.or(self.put_named);
            if self.put_named.is_none() && !keyword.starts_with("put_util") {
                if self.lacks_something() {
                    return Err(Failed);
                }
                return Diagnostic::error("E0374", span)
                    .says("no file is named to write to")
                    .label("which file?")
                    .help("declare one, `file out / 'out.txt' /;`, and name it first: `put out 'text' /;`")
                    .fail(self);
            }
        }
        Ok(CodeKind::Put(keyword.into(), r?))
    }

    fn put_items(&mut self, items: &[PutItem]) -> Checked<Vec<PutCode>> {
        let mut out = Vec::new();
        for item in items {
            let code = match item {
                PutItem::NewLine => PutCode::NewLine,
                PutItem::Column(e) => PutCode::Column(self.expr(e)?),
                PutItem::Row(e) => PutCode::Row(self.expr(e)?),
                PutItem::Item(w) => {
                    let apart = self.two_items(&w.value);
                    let last = match &apart {
                        Some((first, last)) => {
                            out.push(self.put_item(first, (None, None, None))?);
                            last
                        }
                        None => &w.value,
                    };
                    let width = self.optional(w.width.as_ref())?;
                    let decimals = self.optional(w.decimals.as_ref())?;
                    self.put_item(last, (w.align, width, decimals))?
                }
            };
            out.push(code);
        }
        Ok(out)
    }

    fn put_item(
        &mut self,
        value: &Expr,
        (align, width, decimals): (Option<char>, Option<Node>, Option<Node>),
    ) -> Checked<PutCode> {
        if let ExprKind::Apply(name, None, None) = &value.kind {
            if let Some(s) = self.file(name) {
                return Ok(PutCode::File(s));
            }
            if let Some(s) = self.symbols.find(&name.name)
                && self.symbols.get(s).is_set()
            {
                let (i, declared) = (&name.name, self.symbols.get(s).declared);
                return Diagnostic::error("E0304", name.span)
                    .says(format!("the set `{i}` has no value to write"))
                    .label("what of it?")
                    .other(declared, "declared here")
                    .help(format!("write its element's label, `{i}.tl`, its text, `{i}.te({i})`, or its position, `ord({i})`"))
                    .fail(self);
            }
        }
        let value = match &value.kind {
            ExprKind::Apply(name, attribute, None) if is_system(name) => {
                let what = attribute.as_ref().map_or("", |a| &*a.name).to_lowercase();
                let text = format!("%system.{what}%").into();
                Node::data(NodeKind::Text(text), value.span)
            }
            _ => match self.record_name(value)? {
                Some(name) => name,
                None => self.expr(value)?,
            },
        };
        Ok(PutCode::Item(Written {
            value,
            align,
            width,
            decimals,
        }))
    }

    /// A variable or an equation without attribute stands for its name: `put x(i) ' ' x.l(i)`.
    fn record_name(&mut self, value: &Expr) -> Checked<Option<Node>> {
        let ExprKind::Apply(name, None, arguments) = &value.kind else {
            return Ok(None);
        };
        let found = self.symbols.find(&name.name).filter(|&s| {
            let kind = &self.symbols.get(s).kind;
            matches!(kind, SymbolKind::Variable(_) | SymbolKind::Equation(_))
        });
        let Some(s) = found.filter(|_| !self.modes.at(value.span).dot_l) else {
            return Ok(None);
        };
        let key = self.key(s, arguments.as_deref().unwrap_or(&[]), value.span)?;
        Ok(Some(Node::data(NodeKind::RecordName(s, key), value.span)))
    }

    /// `put out (a + b)`, `put s (2*s)`, `put i.tl (p(i)*2)`, `put na (s)` read like a name with an index, but there is none to give:
    /// they are two items.
    fn two_items(&self, value: &Expr) -> Option<(Expr, Expr)> {
        if let ExprKind::Dollar(value, condition) = &value.kind {
            let (first, last) = self.two_items(value)?;
            let span = last.span.to(condition.span);
            let kind = ExprKind::Dollar(Box::new(last), condition.clone());
            return Some((first, Expr { kind, span }));
        }
        let ExprKind::Apply(name, attribute, Some(arguments)) = &value.kind else {
            return None;
        };
        let [last] = arguments.as_slice() else {
            return None;
        };
        let is_text = |a: &Ident| matches!(&*a.name.to_lowercase(), "tl" | "ts");
        let symbol = self.symbols.find(&name.name).map(|s| self.symbols.get(s));
        let special = match symbol {
            None => ExprKind::special(&name.name, || self.modes.at(name.span).undf),
            Some(_) => None,
        };
        let without = match (attribute, symbol) {
            _ if is_system(name) => true,
            (Some(a), _) if is_text(a) => true,
            (Some(_), Some(s)) if s.dim() == 0 => true,
            (Some(a), Some(s)) => {
                s.is_set() && LabelAttribute::named(&a.name).is_some() && !self.is_index(last)
            }
            (None, Some(s)) => s.dim() == 0 && !s.is_set(),
            (None, None) => special.is_some(),
            (_, None) => false,
        };
        let first = Expr {
            kind: special.unwrap_or_else(|| ExprKind::Apply(name.clone(), attribute.clone(), None)),
            span: name.span,
        };
        without.then(|| (first, last.clone()))
    }

    /// Whether an argument is an index: a set, a label, a set with a lag.
    fn is_index(&self, e: &Expr) -> bool {
        match &e.kind {
            ExprKind::Text(_) => true,
            ExprKind::Binary(_, a, _) => self.is_index(a),
            ExprKind::Apply(name, _, _) => {
                let set = self.symbols.find(&name.name);
                set.is_some_and(|s| self.symbols.get(s).is_set())
            }
            _ => false,
        }
    }

    /// The file of this name, if it is one.
    fn file(&self, name: &Ident) -> Option<SymbolId> {
        let s = self.symbols.find(&name.name)?;
        matches!(self.symbols.get(s).kind, SymbolKind::File(_)).then_some(s)
    }
}

/// `system.date` and the like.
fn is_system(name: &Ident) -> bool {
    name.name.eq_ignore_ascii_case("system")
}

/// Whether a name is that of a function, or of a sum and its kin.
fn is_operation(name: &str) -> bool {
    let sums = ["sum", "prod", "smin", "smax", "sand", "sor", "ord", "card"];
    functions::names()
        .chain(sums)
        .any(|n| n.eq_ignore_ascii_case(name))
}
