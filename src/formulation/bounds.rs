//! The bounds of variables as the text assigns them, and what else their declarations say of their values.

use super::Formulation;
use super::derive::{domain_of, kind};
use super::lower::Lowering;
use super::math::{Math, Name, listed, name, symbol_name};
use super::page::{Block, Formula, Page, Setter, over_domain, signed};
use super::tree::*;
use super::{Origin, Sign};
use crate::check::node::{Code, CodeKind, Node, NodeKind, SymbolId, Target};
use crate::check::symbols::{Symbols, attribute};
use crate::check::visit::each_statement;
use crate::run::Machine;
use crate::source::Span;
use crate::syntax::ast::VariableKind;

/// A bound as the text assigns it.
pub struct Assigned {
    variable: SymbolId,
    offset: u32,
    binder: Binder,
    key: Vec<Part>,
    value: Expr,
    /// It holds for all records.
    covers: bool,
}

impl Assigned {
    /// The expressions in it.
    pub fn expressions(&self) -> impl Iterator<Item = &Expr> {
        self.binder.conditions.iter().chain([&self.value])
    }
}

/// What is known of the values of a variable.
pub struct Known {
    /// The variable.
    pub variable: SymbolId,
    /// The multipliers that belong to it have this origin, if any do.
    pub origin: Option<Origin>,
    /// As a formula.
    pub formula: Formula,
}

/// The assignments to bounds of a formulation's variables that hold at a solve, or at the end; those that cannot be told
/// without running are the attribute itself.
pub fn assigned(
    m: &Machine,
    code: &[Code],
    f: &mut Formulation,
    solve: Option<Span>,
) -> Vec<Assigned> {
    let symbols = &m.symbols;
    let owner = |t| m.table_owner(t);
    let mut out: Vec<Assigned> = Vec::new();
    let own = f.own.clone();
    let mut lowering = Lowering::new(symbols, &owner);
    lowering.indices = std::mem::take(&mut f.indices);
    let mut each = |c: &Code, depth: usize| {
        let CodeKind::Assign(a) = &c.kind else {
            return;
        };
        let (v, offsets) = match a.target {
            Target::Fix(s) => (s, vec![attribute::LO, attribute::UP]),
            Target::Table(t) => {
                let Some(s) = owner(t) else { return };
                (s, vec![t - symbols.get(s).table])
            }
            _ => return,
        };
        let is_bound = |o: &u32| matches!(*o, attribute::LO | attribute::UP);
        if !own.contains(&v) || !offsets.iter().all(is_bound) {
            return;
        }
        let covers = depth > 0 || a.covers || symbols.get(v).dim() == 0;
        let (binder, key, value) = if depth == 0 {
            let binder = lowering.domain(&a.domain);
            let node = Node::data(NodeKind::Var(v, a.key.clone()), c.span);
            let Expr::Variable(_, key) = lowering.expr(&node) else {
                return;
            };
            (binder, key, Some(lowering.expr(&a.value)))
        } else {
            let domain = domain_of(symbols, v);
            let indices = domain.iter().map(|s| lowering.indices.add(*s));
            let indices: Vec<IndexId> = indices.collect();
            let key = indices.iter().map(|k| Part::Index(*k)).collect();
            let conditions = Vec::new();
            (
                Binder {
                    indices,
                    conditions,
                },
                key,
                None,
            )
        };
        for offset in offsets {
            let itself = || Expr::Data(Source::Attribute(v, offset), key.clone());
            out.retain(|a| !(covers && (a.variable, a.offset) == (v, offset)));
            out.push(Assigned {
                variable: v,
                offset,
                binder: binder.clone(),
                key: key.clone(),
                value: value.clone().unwrap_or_else(itself),
                covers,
            });
        }
    };
    for c in code {
        let here = std::slice::from_ref(c);
        each_statement(here, &mut each);
        // What is assigned behind the solve does not hold at it.
        let mut reached = false;
        each_statement(here, &mut |c, _| {
            reached |= matches!(c.kind, CodeKind::Solve(_)) && Some(c.span) == solve;
        });
        if reached {
            break;
        }
    }
    f.indices = lowering.indices;
    out
}

/// Kinds, signs and bounds of a formulation's variables; `relaxed`: discrete ones are not.
pub fn known(s: &mut Setter, f: &Formulation, bounds: &[Assigned], relaxed: bool) -> Vec<Known> {
    let symbols = s.scope.symbols;
    let mut out = Vec::new();
    for &v in &f.own {
        let mine: Vec<&Assigned> = bounds.iter().filter(|b| b.variable == v).collect();
        let covered = |o: u32| mine.iter().any(|b| b.offset == o && b.covers);
        let base = variable(symbols, v);
        let mut say = |origin, formula| {
            out.push(Known {
                variable: v,
                origin,
                formula,
            });
        };
        let kind = kind(symbols, v);
        let sign = match kind {
            VariableKind::Binary if !relaxed => Sign::Free,
            VariableKind::Negative if !covered(attribute::UP) => Sign::Negative,
            VariableKind::Unstated | VariableKind::Free | VariableKind::Negative => Sign::Free,
            _ if covered(attribute::LO) => Sign::Free,
            _ => Sign::Positive,
        };
        if sign != Sign::Free {
            say(None, Formula::of(signed(base.clone(), sign)));
        }
        for b in &mine {
            // What fixes says both.
            let twin =
                |o: &&&Assigned| o.offset != b.offset && o.value == b.value && o.key == b.key;
            let (relation, origin) = match (mine.iter().any(|o| twin(&o)), b.offset) {
                (true, attribute::UP) => continue,
                (true, _) => ("=", Origin::Fixed(v)),
                (false, attribute::LO) => ("≥", Origin::Lower(v)),
                (false, _) => ("≤", Origin::Upper(v)),
            };
            if matches!(b.value, Expr::Number(x) if x.is_infinite()) {
                continue;
            }
            let before = s.names.enter(&b.binder.indices);
            let left = s.expr(&Expr::Variable(Variable::Own(v), b.key.clone()));
            let right = s.expr(&b.value);
            let runs = (b.binder != Binder::default()).then(|| s.domain(&b.binder));
            s.names.leave(before);
            let mut row = vec![left.clone(), Math::Operator(relation), right];
            let semi = matches!(
                kind,
                VariableKind::SemiContinuous | VariableKind::SemiInteger
            );
            if semi && relation == "≥" && !relaxed {
                let zero = [left, Math::Operator("="), Math::Number("0".into())];
                row.splice(0..0, zero.into_iter().chain([Math::Words(" or ".into())]));
            }
            let formula = Formula {
                runs,
                ..Formula::of(Math::Row(row))
            };
            say(Some(origin), formula);
        }
        if let Some(values) = values(symbols, v, kind, relaxed) {
            say(None, Formula::of(Math::Row([vec![base], values].concat())));
        }
    }
    out
}

/// What a declaration says of the values of a variable besides its bounds.
fn values(symbols: &Symbols, v: SymbolId, kind: VariableKind, relaxed: bool) -> Option<Vec<Math>> {
    let set = |m: Math| Some(vec![Math::Operator("∈"), m]);
    let number = |t: &str| Math::Number(t.into());
    let brackets = |o, m: Math, c| Math::Row(vec![Math::Prefix(o), m, Math::Prefix(c)]);
    let ordered = |which: &str| {
        let along = symbols.domain_names(symbols.get(v)).pop();
        let along = along.map_or(String::new(), |a| format!(" along {a}"));
        Some(vec![Math::Words(format!(" {which}{along}"))])
    };
    match kind {
        VariableKind::Binary if relaxed => Some(vec![Math::Operator("≤"), number("1")]),
        _ if relaxed => None,
        VariableKind::Binary => set(brackets("{", listed(vec![number("0"), number("1")]), "}")),
        VariableKind::Integer | VariableKind::SemiInteger => set(Math::Name(Name {
            latex: Some("\\mathbf{Z}".into()),
            ..name("ℤ")
        })),
        VariableKind::Sos1 => ordered("SOS1: at most one is not 0"),
        VariableKind::Sos2 => ordered("SOS2: at most two, side by side, are not 0"),
        _ => None,
    }
}

/// What is known, under "with"; `open`: what stands before is under it already.
pub fn with(known: Vec<Known>, open: bool) -> Page {
    if known.is_empty() {
        return Vec::new();
    }
    let lines = known.into_iter().map(|k| k.formula).collect();
    let mut out = vec![Block::Formulas(lines)];
    if !open {
        out.insert(0, Block::Words("with".into()));
    }
    out
}

/// A variable over its domain.
pub fn variable(symbols: &Symbols, v: SymbolId) -> Math {
    let base = Math::Name(symbol_name(symbols, v));
    over_domain(symbols, base, &domain_of(symbols, v))
}
