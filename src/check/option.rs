//! The `option` statement: switches and limits, formats, `clear`, projections.

use super::functions;
use super::node::*;
use super::symbols::SymbolKind;
use super::{Compiler, Failed};
use crate::diag::{Diagnostic, nearest};
use crate::model::option::{Accepted, OptionRow, Refused, check};
use crate::source::Span;
use crate::syntax::ast::{Ident, OptionForm, OptionItem, OptionValue};

/// Options of the `option` statement that are numbers or switches, besides solver choices.
#[rustfmt::skip]
pub(crate) const OPTIONS: &[&str] = &[
    "limrow", "limcol", "iterlim", "reslim", "decimals", "optcr", "optca", "domlim", "bratio", "seed",
    "sysout", "solprint", "solveopt", "solvelink", "savepoint", "threads", "profile", "profiletol", "eject",
    "dispwidth", "forcework", "measure", "memorystat", "strictsingleton", "intvarup", "sys10", "sys11",
    "sys12", "dmpsym", "dmpopt", "dualcheck", "real1", "real2", "real3", "real4", "real5", "integer1",
    "integer2", "integer3", "integer4", "integer5", "subsystems", "sparserun", "sparseval", "on115",
    "zerores", "zeroresrep", "solslack", "cheat", "cutoff", "work", "oldname", "solver", "asyncsollst",
    "fddelta", "fdopt", "threadsasync", "ejectx", "mcprholdfx", "gdxuels", "shuffle", "certify", "ranging",
    "gams_power", "checkerrorlevel", "dmpusersym", "holdfixedasync", "prefixloadpath", "debugtask",
    "validation", "format", "hessscale", "ecimplicitload", "eclogline", "epstozero", "filtered", "replace",
    "zerotoeps", "forlim", "idcprotect", "maxgenericfiles", "reform", "requestmarginals", "sys15", "sys16",
    "sys17", "sys18", "sys19",
];

/// Options without a value.
#[rustfmt::skip]
const FLAGS: &[&str] = &[
    "dmpopt", "dmpsym", "dmpusersym", "eject", "measure", "memorystat", "shut", "stat", "subsystems",
];

/// Options whose value is a whole number.
const WHOLE: &[&str] = &["decimals", "domlim", "iterlim", "limcol", "limrow", "seed"];

/// Whether an option is the language's and not a solver's: a problem type (`nlp = ipopt`), a limit, a
/// switch.
pub(crate) fn is_statement_option(name: &str) -> bool {
    let mut known = [OPTIONS, functions::PROBLEM_TYPES].into_iter().flatten();
    known.any(|o| o.eq_ignore_ascii_case(name))
}

impl Compiler {
    pub(super) fn option(&mut self, item: &OptionItem) -> Result<Option<CodeKind>, Failed> {
        let lower = item.name.name.to_lowercase();
        match &item.form {
            OptionForm::Format(numbers) => {
                let s = self.lookup(&item.name)?;
                self.fitting_format(s, numbers, item.name.span)?;
                Ok(Some(CodeKind::Format(s, numbers.clone())))
            }
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
                let s = self.lookup(&Ident {
                    name: name.into(),
                    span: *span,
                })?;
                let offset = match attribute {
                    None => None,
                    Some(a) => match functions::stored_attribute(a) {
                        Some(o) if self.symbols.get(s).has_attributes() => Some(o),
                        _ => {
                            let symbol = self.symbols.get(s);
                            let (kind, name) = (symbol.kind_name(), symbol.name.clone());
                            let a = Ident {
                                name: a.into(),
                                span: *span,
                            };
                            return self.unknown_attribute(
                                &a,
                                &name,
                                kind,
                                "l, m, lo, up, scale, prior",
                            );
                        }
                    },
                };
                if self.symbols.get(s).is_set() {
                    self.changes_control(s, *span)?;
                }
                let root = self.symbols.root(s);
                self.symbols.get_mut(root).assigned = true;
                Ok(Some(CodeKind::Clear(s, offset)))
            }
            OptionForm::Assign(v) => {
                if !is_statement_option(&lower) {
                    return self.solver_option(item, lower, v);
                }
                if let OptionValue::Text(t, span) = v
                    && functions::PROBLEM_TYPES.contains(&lower.as_str())
                    && !functions::OWN_SOLVERS
                        .iter()
                        .any(|s| s.eq_ignore_ascii_case(t))
                {
                    self.other_solver(t, *span);
                    let own = OptionCode::Text("default".into());
                    return Ok(Some(CodeKind::Option(lower.into(), own)));
                }
                self.fitting_value(item, &lower, v)?;
                let value = match v {
                    OptionValue::Number(x) => OptionCode::Number(*x),
                    OptionValue::Text(t, _) => OptionCode::Text(t.clone()),
                };
                Ok(Some(CodeKind::Option(lower.into(), value)))
            }
            OptionForm::Flag => {
                if FLAGS.contains(&lower.as_str()) {
                    return Ok(None);
                }
                if !is_statement_option(&lower) {
                    return self.unknown_option(item);
                }
                let message = format!("the option `{}` needs a value", item.name.name);
                self.fail(
                    Diagnostic::error("E0330", item.name.span, message)
                        .label("no value")
                        .help(format!("write `option {} = …;`", item.name.name)),
                )
            }
        }
    }

    /// An option that a solver takes.
    fn solver_option(
        &mut self,
        item: &OptionItem,
        name: String,
        value: &OptionValue,
    ) -> Result<Option<CodeKind>, Failed> {
        let (text, code, span) = match value {
            OptionValue::Number(x) => (x.to_string(), OptionCode::Number(*x), item.name.span),
            OptionValue::Text(t, span) => (t.to_string(), OptionCode::Text(t.clone()), *span),
        };
        if text.eq_ignore_ascii_case("default") && self.solver_row(&name).is_some() {
            return Ok(Some(CodeKind::Option(name.into(), code)));
        }
        match check(self.solver_options, &name, &text) {
            Ok(Accepted::Taken) => Ok(Some(CodeKind::Option(name.into(), code))),
            Ok(Accepted::Ignored) => {
                self.report(
                    Diagnostic::warning(
                        "E0329",
                        item.name.span,
                        format!("the option `{name}` means nothing here"),
                    )
                    .label("passed over"),
                );
                Ok(None)
            }
            Err(Refused::Unknown(_)) => self.unknown_option(item),
            Err(refused) => {
                let (message, help) = refused.words(&name, &text);
                let refusal = Diagnostic::error("E0329", span, message).label("not such a value");
                self.fail(match help {
                    Some(help) => refusal.help(help),
                    None => refusal,
                })
            }
        }
    }

    fn solver_row(&self, name: &str) -> Option<&'static OptionRow> {
        self.solver_options.iter().find_map(|t| t.find(name))
    }

    /// A warning for a solver that is not there: bmod takes its own.
    fn other_solver(&mut self, name: &str, span: Span) {
        let known = functions::SOLVERS
            .iter()
            .any(|s| s.eq_ignore_ascii_case(name));
        let near = nearest(name, functions::OWN_SOLVERS.iter().copied()).filter(|_| !known);
        let own = functions::OWN_SOLVERS.join(", ");
        let message = match known {
            true => format!("the solver `{name}` is not in bmod, which takes its own"),
            false => format!("there is no solver `{name}`; bmod takes its own"),
        };
        let d = Diagnostic::warning("E0349", span, message).label("passed over");
        self.report(match near {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d.help(format!("there are: {own}")),
        });
    }

    /// An error for decimals, row indices or column indices that a display cannot have.
    fn fitting_format(&mut self, s: SymbolId, numbers: &[i64], span: Span) -> Result<(), Failed> {
        let symbol = self.symbols.get(s);
        let dim = symbol.dim() as i64;
        let fits = match numbers {
            [d, ..] if !(0..=8).contains(d) => false,
            // A scalar and a single list have no table.
            [_, 0, list, ..] => *list >= 1,
            [_, rows, columns, ..] => *rows < dim && (1..=dim - rows).contains(columns),
            _ => true,
        };
        if fits {
            return Ok(());
        }
        let message = "`option p:d:r:c` takes decimals d from 0 to 8, fewer row indices r than `p` has indices, \
                       and at most the rest as columns c";
        self.fail(
            Diagnostic::error("E0329", span, message)
                .label(format!("has {dim} indices"))
                .help("r = 0 displays a list, c records to a line"),
        )
    }

    /// An error for a value that the option cannot have.
    fn fitting_value(
        &mut self,
        item: &OptionItem,
        option: &str,
        value: &OptionValue,
    ) -> Result<(), Failed> {
        let expected = match (option, value) {
            ("decimals", OptionValue::Number(x)) if !(0.0..=8.0).contains(x) => {
                "a whole number from 0 to 8"
            }
            (o, OptionValue::Number(x)) if WHOLE.contains(&o) && x.fract() != 0.0 => {
                "a whole number"
            }
            (o, OptionValue::Text(..)) if WHOLE.contains(&o) => "a whole number",
            _ => return Ok(()),
        };
        let span = match value {
            OptionValue::Text(_, span) => *span,
            OptionValue::Number(_) => item.name.span,
        };
        let message = format!("the value of `option {option}` is {expected}");
        self.fail(Diagnostic::error("E0329", span, message).label("not such a value"))
    }

    fn unknown_option<T>(&mut self, item: &OptionItem) -> Result<T, Failed> {
        let statement = [OPTIONS, functions::PROBLEM_TYPES].into_iter().flatten();
        let solver = self.solver_options.iter().flat_map(|t| t.all());
        let known = statement.copied().chain(solver.map(|r| r.name));
        let near = nearest(&item.name.name, known).map(str::to_string);
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

    fn matching(
        &mut self,
        item: &OptionItem,
        sets: &[(bool, Ident)],
    ) -> Result<Option<CodeKind>, Failed> {
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

    /// A statement gives a symbol its values; a set has no order of its own then.
    fn changes_set(&mut self, s: SymbolId) {
        let root = self.symbols.root(s);
        let symbol = self.symbols.get_mut(root);
        symbol.assigned = true;
        symbol.dynamic |= symbol.is_set();
    }

    fn project(
        &mut self,
        item: &OptionItem,
        from_left: bool,
        source: &Ident,
        source_indices: Option<&[Ident]>,
    ) -> Result<Option<CodeKind>, Failed> {
        let (t, s) = (self.lookup(&item.name)?, self.lookup(source)?);
        self.used(s, source.span);
        let (target, from) = (self.symbols.get(t).clone(), self.symbols.get(s).clone());
        if !target.is_set() && !matches!(target.kind, SymbolKind::Parameter { .. }) {
            return self.fail(
                Diagnostic::error(
                    "E0331",
                    item.name.span,
                    format!(
                        "`{}` is {}: only sets and parameters are projected to",
                        item.name.name,
                        target.a_kind()
                    ),
                )
                .other(target.declared, "declared here"),
            );
        }
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
                // Each position of the target takes an unused position of the source with the same set,
                // looked for from the right, or with `<=` from the left.
                let mut free: Vec<usize> = (0..from.dim()).collect();
                if !from_left {
                    free.reverse();
                }
                let mut p = Vec::new();
                for d in &target.domain {
                    if let Some(i) = free.iter().position(|&i| from.domain[i] == *d) {
                        p.push(free.remove(i));
                    }
                }
                p
            }
        };
        if positions.len() != target.dim() {
            return self.fail(
                Diagnostic::error(
                    "E0331",
                    item.name.span,
                    "the right side does not have the index sets of the left",
                )
                .other(target.declared, "left side declared here")
                .other(from.declared, "right side declared here"),
            );
        }
        self.changes_set(t);
        Ok(Some(CodeKind::Project {
            target: self.symbols.root(t),
            source: s,
            positions,
        }))
    }
}
