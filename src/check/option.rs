//! The `option` statement: switches and limits, formats, `clear`, projections.

use super::functions;
use super::node::*;
use super::symbols::{DomainPosition, SymbolKind, UNIVERSE};
use super::{Checked, Compiler};
use crate::diag::Diagnostic;
use crate::model::language;
use crate::model::option::{Accepted, Refused};
use crate::source::Span;
use crate::syntax::ast::{Ident, OptionForm, OptionItem, OptionValue};

/// Options without a value.
#[rustfmt::skip]
const FLAGS: &[&str] = &[
    "dmpopt", "dmpsym", "dmpusersym", "eject", "measure", "memorystat", "oldname", "shut", "stat",
    "subsystems",
];

impl Compiler {
    pub(super) fn option(&mut self, item: &OptionItem) -> Checked<Option<CodeKind>> {
        let lower = item.name.name.to_lowercase();
        match &item.form {
            OptionForm::Format(numbers) => {
                let s = self.lookup(&item.name)?;
                self.fitting_format(s, numbers, item.name.span)?;
                Ok(Some(CodeKind::Format(s, numbers.clone())))
            }
            OptionForm::Permute(set) => self.permute(item, set),
            OptionForm::Project {
                from_left,
                source,
                indices,
            } => self.project(item, *from_left, source, indices.as_deref()),
            OptionForm::Match(sets) => self.matching(item, sets),
            OptionForm::Assign(OptionValue::Text(t, span))
                if lower == "clear" || lower == "kill" =>
            {
                let (name, attribute) = match t.split_once('.') {
                    Some((name, a)) => (name, Some(a)),
                    None => (&**t, None),
                };
                let ident = |name: &str| Ident {
                    name: name.into(),
                    span: *span,
                };
                let s = self.lookup(&ident(name))?;
                let symbol = self.symbols.get(s);
                let offset = attribute.and_then(functions::stored_attribute);
                let offset = offset.filter(|_| symbol.has_attributes());
                if let (Some(a), None) = (attribute, offset) {
                    let (kind, name) = (symbol.kind_name(), symbol.name.clone());
                    let known = "l, m, lo, up, scale, prior";
                    return self.unknown_attribute(&ident(a), &name, kind, known);
                }
                if self.symbols.get(s).is_set() {
                    self.changes_control(s, *span)?;
                }
                let root = self.symbols.root(s);
                self.symbols.get_mut(root).assigned = true;
                Ok(Some(CodeKind::Clear(s, offset)))
            }
            OptionForm::Assign(OptionValue::Text(t, span)) if lower == "shuffle" => {
                self.shuffled(t, *span)
            }
            OptionForm::Assign(v) => self.value(item, lower, v),
            OptionForm::Flag => {
                if FLAGS.contains(&lower.as_str()) {
                    return Ok(None);
                }
                if let Err(refused @ Refused::Unknown(_)) = self.solvers.check(&lower, "") {
                    return self.refused_option(item, &lower, "", item.name.span, &refused);
                }
                Diagnostic::error("E0330", item.name.span)
                    .says(format!("the option `{}` needs a value", item.name.name))
                    .label("no value")
                    .help(format!("write `option {} = …;`", item.name.name))
                    .fail(self)
            }
        }
    }

    /// `option name = value`
    fn value(
        &mut self,
        item: &OptionItem,
        name: String,
        value: &OptionValue,
    ) -> Checked<Option<CodeKind>> {
        let (text, span) = match value {
            OptionValue::Number(x) => (x.to_string(), item.name.span),
            OptionValue::Text(t, span) => (t.to_string(), *span),
        };
        match self.solvers.check(&name, &text) {
            Ok(Accepted::Taken) => Ok(Some(CodeKind::Option(name.into(), text.into()))),
            Ok(Accepted::Ignored) if !language::chooses_solver(&name) => {
                if self.passed_over.insert(name.clone()) {
                    Diagnostic::warning("E0329", item.name.span)
                        .says(format!("the option `{name}` means nothing here"))
                        .label("passed over")
                        .help("leave it out, or keep it for other systems: no result depends on it")
                        .report(self);
                }
                Ok(None)
            }
            Ok(Accepted::Ignored) => {
                let own = self.solvers.all_names();
                Diagnostic::warning("E0349", span)
                    .says(format!(
                        "the solver `{text}` is not in bmod, which takes its own"
                    ))
                    .label("passed over")
                    .help(format!("there are: {own}"))
                    .report(self);
                Ok(Some(CodeKind::Option(name.into(), "default".into())))
            }
            Err(refused) => self.refused_option(item, &name, &text, span, &refused),
        }
    }

    /// An error, or a warning where GAMS takes the statement and its solve fails or has a meaning for any number.
    fn refused_option(
        &mut self,
        item: &OptionItem,
        name: &str,
        value: &str,
        span: Span,
        refused: &Refused,
    ) -> Checked<Option<CodeKind>> {
        let (code, span, label) = match refused {
            Refused::Unknown(_) => ("E0329", item.name.span, "unknown option"),
            Refused::Solver(..) | Refused::Unsuited(_) => ("E0349", span, "passed over"),
            _ => ("E0329", span, "not such a value"),
        };
        let (message, help) = refused.words(name, value);
        let lenient = match refused {
            Refused::Range(_) => language::is_option(name) && name != "decimals",
            _ => code == "E0349",
        };
        let d = match lenient {
            true => Diagnostic::warning(code, span).label("passed over"),
            false => Diagnostic::error(code, span).label(label),
        };
        let d = Diagnostic { help, ..d }.says(message);
        if !lenient {
            return d.fail(self);
        }
        d.report(self);
        let default = || CodeKind::Option(name.into(), "default".into());
        Ok((code == "E0349").then(default))
    }

    /// An error for decimals, row indices or column indices that a display cannot have.
    fn fitting_format(&mut self, s: SymbolId, numbers: &[i64], span: Span) -> Checked<()> {
        let symbol = self.symbols.get(s);
        let dim = symbol.dim() as i64;
        let fits = match numbers {
            [d, ..] if !(0..=8).contains(d) => false,
            // A scalar and a single list have no table.
            [_, 0, list, ..] => *list >= 1,
            [_, rows, columns, ..] => *rows < dim && (1..=dim - rows).contains(columns),
            [_, _] => false,
            _ => true,
        };
        if fits {
            return Ok(());
        }
        let message = "`option p:d:r:c` takes decimals d from 0 to 8, fewer row indices r than `p` has indices, \
                       and at most the rest as columns c";
        Diagnostic::error("E0329", span)
            .says(message)
            .label(format!("has {dim} indices"))
            .help("r = 0 displays a list, c records to a line")
            .fail(self)
    }

    fn matching(&mut self, item: &OptionItem, sets: &[(bool, Ident)]) -> Checked<Option<CodeKind>> {
        let target = self.lookup_set(&item.name)?;
        let (mut tables, mut position) = (Vec::new(), 0);
        for (matched, name) in sets {
            let s = self.lookup_set(name)?;
            self.used(s, name.span);
            let symbol = self.symbols.get(s);
            let dim = symbol.dim();
            tables.push((*matched, symbol.table));
            if position + dim > self.symbols.get(target).dim() {
                return self.wrong_dimension(target, item.name.span, position + dim);
            }
            if dim == 1 {
                self.fits(s, target, position, name.span)?;
            }
            position += dim;
        }
        if position != self.symbols.get(target).dim() {
            return self.wrong_dimension(target, item.name.span, position);
        }
        self.changes_set(target);
        Ok(Some(CodeKind::Match(target, tables)))
    }

    fn permute(&mut self, item: &OptionItem, set: &Ident) -> Checked<Option<CodeKind>> {
        let (target, s) = (self.lookup_set(&item.name)?, self.lookup_set(set)?);
        self.used(s, set.span);
        let (symbol, source) = (self.symbols.get(target), self.symbols.get(s));
        let tables = match symbol.domain[..] {
            [DomainPosition::Set(numbers), _, _] if source.dim() == 1 => {
                [self.symbols.get(numbers).table, source.table]
            }
            _ => {
                let message = "`option p > s` takes a set `p(n,s,s)`: a number, an element of `s`, and what takes its place";
                return Diagnostic::error("E0331", item.name.span)
                    .says(message)
                    .other(symbol.declared, "declared here")
                    .fail(self);
            }
        };
        for position in 1..3 {
            self.fits(s, target, position, set.span)?;
        }
        self.changes_set(target);
        Ok(Some(CodeKind::Permute(target, tables)))
    }

    /// A statement gives a symbol its values; a set has no order of its own then.
    fn changes_set(&mut self, s: SymbolId) {
        let root = self.symbols.root(s);
        let symbol = self.symbols.get_mut(root);
        symbol.assigned = true;
        symbol.dynamic |= symbol.is_set();
    }

    /// `option shuffle = p`
    fn shuffled(&mut self, name: &str, span: Span) -> Checked<Option<CodeKind>> {
        let name = name.into();
        let p = self.lookup(&Ident { name, span })?;
        let symbol = self.symbols.get(p);
        let (SymbolKind::Parameter { .. }, [index]) = (&symbol.kind, symbol.domain.as_slice())
        else {
            let (declared, kind) = (symbol.declared, symbol.a_kind());
            return Diagnostic::error("E0330", span)
                .says("`option shuffle` takes a parameter with one index")
                .label(format!("this is {kind}"))
                .other(declared, "declared here")
                .help("declare `parameter p(i);` for it: it gets the positions of the elements, shuffled")
                .fail(self);
        };
        let set = match index {
            DomainPosition::Set(s) => *s,
            DomainPosition::Universe => UNIVERSE,
        };
        let set = self.symbols.get(set).table;
        self.symbols.get_mut(p).assigned = true;
        Ok(Some(CodeKind::Shuffle(p, set)))
    }

    fn project(
        &mut self,
        item: &OptionItem,
        from_left: bool,
        source: &Ident,
        source_indices: Option<&[Ident]>,
    ) -> Checked<Option<CodeKind>> {
        let (t, s) = (self.lookup(&item.name)?, self.lookup(source)?);
        self.used(s, source.span);
        let (target, from) = (self.symbols.get(t).clone(), self.symbols.get(s).clone());
        if !target.is_set() && !matches!(target.kind, SymbolKind::Parameter { .. }) {
            let (name, kind) = (&item.name.name, target.a_kind());
            return Diagnostic::error("E0331", item.name.span)
                .says(format!(
                    "`{name}` is {kind}: only sets and parameters are projected to"
                ))
                .other(target.declared, "declared here")
                .fail(self);
        }
        let mut positions = Vec::new();
        if let (Some(a), Some(b)) = (&item.indices, source_indices) {
            for Ident { name, span } in a {
                let Some(i) = b.iter().position(|x| x.name.eq_ignore_ascii_case(name)) else {
                    return Diagnostic::error("E0331", *span)
                        .says(format!("`{name}` is not an index of the right side"))
                        .fail(self);
                };
                positions.push(i);
            }
        } else {
            // Each position of the target takes an unused position of the source with the same set,
            // looked for from the right, or with `<=` from the left.
            let mut free: Vec<usize> = (0..from.dim()).collect();
            if !from_left {
                free.reverse();
            }
            for d in &target.domain {
                let found = free.iter().position(|&i| from.domain[i] == *d);
                positions.extend(found.map(|i| free.remove(i)));
            }
        }
        if positions.len() != target.dim() {
            return Diagnostic::error("E0331", item.name.span)
                .says("the right side does not have the index sets of the left")
                .other(target.declared, "left side declared here")
                .other(from.declared, "right side declared here")
                .fail(self);
        }
        self.changes_set(t);
        Ok(Some(CodeKind::Project {
            target: self.symbols.root(t),
            source: s,
            positions,
        }))
    }
}
