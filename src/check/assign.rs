//! Assignments: what is written, where, and in which order.

use super::functions;
use super::node::*;
use super::symbols::{DomainPosition, Symbol, SymbolKind, attribute};
use super::visit::{Reading, Visitor};
use super::{Checked, Compiler};
use crate::diag::Diagnostic;
use crate::source::Span;
use crate::syntax::ast::{self, Assign, Expr, ExprKind, Reference};

impl Compiler {
    /// An assignment; several statements where GAMS does more than one thing.
    pub(super) fn assign(&mut self, a: &Assign, span: Span, out: &mut Vec<Code>) -> Checked<()> {
        let t = &a.target;
        if let Some(target) = of_the_run(&t.name.name)
            && self.symbols.find(&t.name.name).is_none()
        {
            let value = self.expr(&a.value)?;
            let assignment = Assignment {
                domain: Domain::default(),
                target,
                key: Key::default(),
                value,
                covers: false,
                nonzero: a.nonzero,
                in_turn: false,
            };
            out.push(Code::new(CodeKind::Assign(assignment), span));
            return Ok(());
        }
        let s = self.lookup(&t.name)?;
        self.shape(s, &t.indices);
        let target = self.target(s, t)?;
        if matches!(target, Target::Set(_) | Target::Singleton(_)) {
            self.changes_control(s, t.span)?;
        }
        let symbol = self.symbols.get(s).clone();
        let root = self.symbols.root(s);
        let (domain, key, value, covers) = self.scoped(|c| {
            let mut domain = Domain::default();
            let parts = match target {
                Target::Object(..) => Vec::new(),
                _ => c.defining(|c| c.control_key(&t.indices, s, t.span, &mut domain))?,
            };
            if let Some(cond) = &a.condition {
                c.condition(cond, &mut domain)?;
            }
            let is_file = matches!(symbol.kind, SymbolKind::File(_));
            c.texts_allowed = is_file && matches!(target, Target::Object(..));
            let value = c.expr(&a.value);
            c.texts_allowed = false;
            let value = value?;
            if matches!(target, Target::Table(_) | Target::Fix(_)) {
                c.index_as_number(&value);
                c.loose_condition(&a.value);
            }
            let covers = !a.nonzero && c.covers(&symbol, &domain, &parts);
            Ok((domain, Key { parts }, value, covers))
        })?;
        let sym = self.symbols.get_mut(root);
        sym.assigned = true;
        if matches!(target, Target::Set(_) | Target::Singleton(_)) {
            sym.dynamic = true;
        }
        let mut reading = SelfReading {
            tables: self.tables(target),
            ..SelfReading::default()
        };
        domain.conditions.iter().for_each(|c| reading.node(c));
        reading.node(&value);
        // GAMS empties what is assigned anew and only counted, before it counts it.
        let whole = symbol.dim() > 0 && !symbol.has_attributes();
        if covers && whole && reading.counted && !reading.read {
            out.push(Code::new(CodeKind::Clear(root, None), span));
        }
        let assignment = Assignment {
            in_turn: reading.is_recurrence(&key),
            domain,
            target,
            value,
            covers,
            nonzero: a.nonzero,
            key,
        };
        out.push(Code::new(CodeKind::Assign(assignment), span));
        Ok(())
    }

    /// Whether a domain runs over all records of a symbol.
    fn covers(&self, symbol: &Symbol, domain: &Domain, parts: &[Part]) -> bool {
        domain.conditions.is_empty()
            && domain.slots.len() == symbol.dim()
            && domain.members.len() == symbol.dim()
            && parts.iter().enumerate().all(|(p, part)| {
                let Part::Slot(slot) = part else { return false };
                domain.slots.get(p) == Some(slot)
                    && match symbol.domain[p] {
                        DomainPosition::Set(d) => domain.sets[p] == self.symbols.get(d).table,
                        _ => false,
                    }
            })
    }

    /// `s(t) = s(t-1) + 1 $ t > 1`: `$` takes `t` alone.
    fn loose_condition(&mut self, value: &Expr) {
        use ast::BinaryOp::{Eq, Ge, Gt, Le, Lt, Ne};
        let ExprKind::Binary(Eq | Ne | Lt | Le | Gt | Ge, left, _) = &value.kind else {
            return;
        };
        let last = match &left.kind {
            ExprKind::Sum(terms) => terms.last().map(|(_, t)| t),
            _ => Some(&**left),
        };
        if let Some(ExprKind::Dollar(_, c)) = last.map(|l| &l.kind)
            && let ExprKind::Apply(_, _, _) = &c.kind
        {
            let message = "`$` takes only what stands directly behind it; the comparison is made with all that stands on the left";
            Diagnostic::warning("E0379", c.span)
                .says(message)
                .label("the condition ends here")
                .help("put the condition in parentheses: `1$(ord(t) > 1)`")
                .report(self);
        }
    }

    /// What is written to.
    fn target(&mut self, s: SymbolId, t: &Reference) -> Checked<Target> {
        let symbol = self.symbols.get(s).clone();
        let (name, declared) = (&symbol.name, symbol.declared);
        let target = match &symbol.kind {
            SymbolKind::Parameter { .. } if t.attribute.is_none() => Target::Table(symbol.table),
            SymbolKind::Set { singleton } if t.attribute.is_none() => match singleton {
                true => Target::Singleton(symbol.table),
                false => Target::Set(symbol.table),
            },
            SymbolKind::Alias(root) if t.attribute.is_none() => {
                Target::Set(self.symbols.get(*root).table)
            }
            SymbolKind::Variable(_)
                if t.attribute.is_none() && self.modes.at(t.name.span).dot_l =>
            {
                Target::Table(symbol.table + attribute::L)
            }
            SymbolKind::Variable(_) | SymbolKind::Equation(_) => {
                let Some(attr) = &t.attribute else {
                    let what = symbol.kind_name();
                    // `z = 3*x;` is meant as the definition of an equation, which is missing then.
                    self.lose_definition();
                    let d = Diagnostic::error("E0310", t.span)
                        .says(format!("the {what} `{name}` cannot be assigned itself"))
                        .label("which of its numbers?")
                        .other(declared, "declared here");
                    let name = &t.name.name;
                    let help = if what == "equation" {
                        self.lose(name);
                        format!("an equation is defined with two dots: `{name}.. left =e= right;`")
                    } else {
                        format!(
                            "assign `{name}.l`, `{name}.lo`, `{name}.up` or `{name}.fx`; what it must be equal to is said by an equation: `e.. {name} =e= …;`"
                        )
                    };
                    return d.help(help).fail(self);
                };
                self.suits(&symbol, attr)?;
                match functions::record_attribute(&attr.name) {
                    Some(functions::RecordAttribute::Stored(o)) => Target::Table(symbol.table + o),
                    Some(functions::RecordAttribute::Fix) => Target::Fix(s),
                    Some(functions::RecordAttribute::Derived(_)) => {
                        return Diagnostic::error("E0314", attr.span)
                            .says(format!(
                                "`.{}` is computed and cannot be assigned",
                                attr.name
                            ))
                            .label("read only")
                            .fail(self);
                    }
                    None => {
                        let known = "l, m, lo, up, fx, scale, prior";
                        return self.unknown_attribute(attr, name, symbol.kind_name(), known);
                    }
                }
            }
            SymbolKind::Model(_) | SymbolKind::File(_) if t.attribute.is_some() => {
                let attr = t.attribute.as_ref().expect("tested above");
                Target::Object(s, self.object_attribute(s, attr)?)
            }
            _ => {
                let kind = symbol.a_kind();
                return Diagnostic::error("E0325", t.span)
                    .says(format!("`{name}` is {kind} and cannot be assigned"))
                    .label("not assignable")
                    .other(declared, "declared here")
                    .fail(self);
            }
        };
        let is_set = matches!(target, Target::Set(_) | Target::Singleton(_));
        let root = self.symbols.root(s);
        if is_set && (self.symbols.get(root).is_domain || root == super::symbols::UNIVERSE) {
            return Diagnostic::error("E0320", t.span)
                .says(format!(
                    "the set `{name}` cannot be assigned: it is the domain of other symbols"
                ))
                .label("a domain must stay as it is")
                .other(declared, "declared here")
                .help(format!(
                    "declare a subset, `set sub({name});`, and assign that"
                ))
                .fail(self);
        }
        Ok(target)
    }

    /// An error where a set that a loop around runs over is changed.
    pub(super) fn changes_control(&mut self, s: SymbolId, span: Span) -> Checked<()> {
        let root = self.symbols.root(s);
        let mut running = self.scope.iter().map(|(c, _)| self.symbols.root(*c));
        if running.all(|r| r != root) {
            return Ok(());
        }
        let name = &self.symbols.get(root).name;
        Diagnostic::error("E0320", span)
            .says(format!(
                "the loop runs over `{name}`, which is changed here"
            ))
            .label("bound by the loop")
            .help(format!(
                "run over the set it is part of: `loop(i$({name}(i)), …)`; or change a copy"
            ))
            .fail(self)
    }

    /// The tables that a target writes to.
    fn tables(&self, target: Target) -> Vec<TableId> {
        match target {
            Target::Table(t) | Target::Set(t) | Target::Singleton(t) => vec![t],
            Target::Fix(s) => {
                let t = self.symbols.get(s).table;
                vec![t + attribute::L, t + attribute::LO, t + attribute::UP]
            }
            _ => Vec::new(),
        }
    }
}

/// What is assigned under a name that belongs to the run.
fn of_the_run(name: &str) -> Option<Target> {
    Some(match name.to_lowercase().as_str() {
        "execseed" => Target::Seed,
        "execerror" => Target::Errors,
        "maxexecerror" => Target::MostErrors,
        "heaplimit" => Target::Ignored,
        _ => return None,
    })
}

/// How an assignment reads what it writes to.
#[derive(Default)]
struct SelfReading<'a> {
    tables: Vec<TableId>,
    keys: Vec<&'a Key>,
    counted: bool,
    /// Other than by its number of records, sums over it included.
    read: bool,
}

impl<'a> Visitor<'a> for SelfReading<'a> {
    fn node(&mut self, n: &'a Node) {
        if let NodeKind::Data(t, key) = &n.kind
            && self.tables.contains(t)
        {
            self.keys.push(key);
        }
        n.walk(self);
    }

    fn table(&mut self, t: TableId, how: Reading) {
        let own = self.tables.contains(&t);
        match how {
            Reading::Count => self.counted |= own,
            Reading::Record | Reading::Order => self.read |= own,
        }
    }
}

impl SelfReading<'_> {
    /// Whether the assignment goes element by element, each reading what those before have written: GAMS does
    /// where the left side has a lag, and all that is read has the same indices, behind the first position with lags
    /// as far: `p(t+1) = p(t-1)`, `p(t--1,i+1) = p(t,i++1)`, not `p(t+1,i) = p(t,i+1)`. Records named by their labels
    /// do not matter; they, and in other assignments all, have their values from before.
    fn is_recurrence(&self, written: &Key) -> bool {
        let lagged = written.parts.iter().any(|p| matches!(p, Part::Lag(_)));
        let moving = || self.keys.iter().filter(|k| !k.is_fixed());
        lagged
            && moving().next().is_some()
            && moving().all(|k| {
                let mut pairs = k.parts.iter().zip(&written.parts).enumerate();
                pairs.all(|(position, (a, b))| {
                    same_index(a, b) && (position == 0 || as_far(distance(a), distance(b)))
                })
            })
    }
}

/// How far an index is moved.
fn distance(p: &Part) -> Option<&Node> {
    match p {
        Part::Lag(lag) => Some(&lag.offset),
        _ => None,
    }
}

/// Whether two indices are moved as far, in whatever direction: by the same number, scalar or form.
fn as_far(a: Option<&Node>, b: Option<&Node>) -> bool {
    let unsigned = |n: &'_ Node| match &n.kind {
        NodeKind::Sum(terms) if terms.len() == 1 => terms[0].1.clone(),
        _ => n.clone(),
    };
    let (Some(a), Some(b)) = (a.map(unsigned), b.map(unsigned)) else {
        return a.is_none() && b.is_none();
    };
    match (&a.kind, &b.kind) {
        (NodeKind::Const(a), NodeKind::Const(b)) => a.abs() == b.abs(),
        (NodeKind::Data(a, k), NodeKind::Data(b, l)) => {
            a == b && k.parts.iter().zip(&l.parts).all(|(a, b)| same_index(a, b))
        }
        (NodeKind::Sum(a), NodeKind::Sum(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| as_far(Some(&a.1), Some(&b.1)))
        }
        (a, b) => std::mem::discriminant(a) == std::mem::discriminant(b),
    }
}

/// Whether two parts are the same index, wherever lags lead.
fn same_index(a: &Part, b: &Part) -> bool {
    match (a, b) {
        (Part::Slot(a), Part::Slot(b)) => a == b,
        (Part::Label(a), Part::Label(b)) => a == b,
        (Part::Lag(a), Part::Lag(b)) => a.set == b.set && same_index(&a.base, &b.base),
        (Part::Singleton(a, p), Part::Singleton(b, q)) => (a, p) == (b, q),
        _ => false,
    }
}
