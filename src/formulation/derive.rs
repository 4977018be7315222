//! What the dual and the optimality conditions share: the primal with its formulas and its numbers, names, and rows of
//! columns.

use super::gradient::{Term, gradient};
use super::invert::{Inverted, invert, target_sets};
use super::lower::Equation;
use super::tree::*;
use super::{Formulation, Multiplier, NewData, Origin, Scope, Sign};
use crate::check::node::SymbolId;
use crate::check::symbols::{DomainPosition, SymbolKind, Symbols, UNIVERSE};
use crate::data::universe::Label;
use crate::model::problem_type::ProblemType;
use crate::run::Generated;
use crate::solve::answer::cones_of;
use crate::solve::nlp::convex::{Shape, shape};
use crate::syntax::ast::{ModelItem, VariableKind};
use rustc_hash::FxHashSet;
use std::cell::OnceCell;

/// A model of the user at one of its solves.
pub struct Primal {
    /// Its name.
    pub name: String,
    /// Problem type.
    pub using: String,
    /// Direction and objective variable.
    pub objective: Option<(Sense, SymbolId)>,
    /// Its equations, as formulas.
    pub equations: Vec<Equation>,
    /// The indices of its formulas.
    pub indices: Indices,
    /// Equations that could not be written in symbols and stand as their rows, and why.
    pub by_instance: Vec<String>,
    /// How many tuples each equation runs over; more than it has rows where some of these are empty.
    pub tuples: Vec<usize>,
    /// Its instance with the data of the solve.
    pub generated: Generated,
    /// The answer of the solve, by the columns and rows of the instance.
    pub answer: Option<Values>,
}

impl Primal {
    /// Its cones, counted by kind, where a solve recognises that it is convex by them and not by its Hessians.
    pub fn cones(&self) -> Option<String> {
        let instance = &self.generated.instance;
        instance.objective?;
        match shape(instance) {
            Shape::Linear | Shape::ConvexQuadratic { .. } => None,
            _ => cones_of(ProblemType::named(&self.using)?, instance),
        }
    }
}

/// Levels and marginals.
#[derive(Clone, Debug, Default)]
pub struct Values {
    /// Levels by column.
    pub level: Vec<f64>,
    /// Marginals by column.
    pub column_marginal: Vec<f64>,
    /// Levels by row, constants on the right side.
    pub activity: Vec<f64>,
    /// Marginals by row.
    pub row_marginal: Vec<f64>,
}

/// The objective function after its variable was eliminated.
pub struct Eliminated {
    /// The equation that defined it.
    pub equation: usize,
    /// The objective function.
    pub function: Expr,
}

/// A derivation at work.
pub struct Derivation<'a> {
    /// Names, and data as they were at the solve.
    pub scope: Scope<'a>,
    /// The model.
    pub primal: &'a Primal,
    /// What comes out.
    pub out: Formulation,
    /// The objective function, where its variable could be eliminated.
    pub eliminated: Option<Eliminated>,
    /// What each equation runs over: only the rows that can bind.
    pub binders: Vec<Binder>,
    /// Terms by equation.
    terms: Vec<Vec<Term>>,
    /// The multiplier of each equation.
    multipliers: Vec<Option<usize>>,
    /// Whether all rows of all equations bind, so that each has a multiplier.
    pub(super) all_bind: bool,
    /// By column, once it was asked for: whether it stands in a row with a multiplier, or in a nonlinear term.
    pub(super) in_rows: OnceCell<Vec<bool>>,
    /// Multipliers are those of the text with the opposite sign.
    flip: bool,
    taken: FxHashSet<String>,
}

impl<'a> Derivation<'a> {
    /// Begins; `Err` says which equation has no derivatives, and why.
    pub fn new(
        scope: Scope<'a>,
        primal: &'a Primal,
        name: String,
        using: &str,
    ) -> Result<Self, (usize, String)> {
        let taken = scope
            .symbols
            .iter()
            .map(|(_, s)| s.name.to_lowercase())
            .collect();
        let mut indices = primal.indices.clone();
        let mut terms = Vec::new();
        for (k, e) in primal.equations.iter().enumerate() {
            terms.push(gradient(&e.left, &e.right, &mut indices).map_err(|why| (k, why))?);
        }
        let mut d = Self {
            scope,
            primal,
            out: Formulation {
                name,
                using: using.into(),
                indices,
                by_instance: primal.by_instance.clone(),
                ..Formulation::default()
            },
            eliminated: None,
            binders: primal.equations.iter().map(|e| e.binder.clone()).collect(),
            multipliers: vec![None; terms.len()],
            all_bind: true,
            in_rows: OnceCell::new(),
            terms,
            flip: false,
            taken,
        };
        d.eliminated = d.eliminate();
        d.leave_out_unlimited();
        Ok(d)
    }

    /// Rows whose right side is infinite never bind: their multipliers are left out.
    fn leave_out_unlimited(&mut self) {
        let g = &self.primal.generated;
        for (k, e) in self.primal.equations.iter().enumerate() {
            let Some(b) = g.origin.rows.symbol(e.symbol) else {
                continue;
            };
            let rows = b.start as usize..(b.start + b.len) as usize;
            let binds = |r: &Relation| *r == e.relation;
            self.all_bind &= e.relation != Relation::Free;
            if g.instance.rows.relation[rows].iter().all(binds) {
                continue;
            }
            self.all_bind = false;
            let relation = |i: &u32| &g.instance.rows.relation[*i as usize];
            let binding = (b.start..b.start + b.len).filter(|i| binds(relation(i)));
            let name = self.scope.get(e.symbol).name.to_string();
            let text = format!("rows of {name} with a finite right side");
            let keys = binding.map(|i| b.key(i).to_vec()).collect();
            let inside = self.new_set(&format!("binding_{name}"), text, e.symbol, keys, &e.key);
            self.binders[k].conditions.push(inside);
        }
    }

    /// Introduces a set of records of a symbol (a number where it has no indices): the condition that a key is in it.
    pub(super) fn new_set(
        &mut self,
        name: &str,
        text: String,
        of: SymbolId,
        keys: Vec<Vec<Label>>,
        key: &[Part],
    ) -> Expr {
        let name = self.fresh(name);
        self.out.data.push(NewData {
            name,
            text,
            domain: domain_of(self.scope.symbols, of),
            is_set: !key.is_empty(),
            records: keys.into_iter().map(|k| (k, 1.0)).collect(),
        });
        let number = self.out.data.len() - 1;
        match key {
            [] => Expr::Data(Source::New(number), Vec::new()),
            key => Expr::NewMember(number, key.to_vec()),
        }
    }

    /// A name that is not in use yet.
    pub fn fresh(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_string();
        let mut n = 2;
        while !self.taken.insert(name.to_lowercase()) {
            name = format!("{wanted}_{n}");
            n += 1;
        }
        name
    }

    /// The objective function, where one `=e=` row without indices defines its variable and nothing else holds it.
    fn eliminate(&self) -> Option<Eliminated> {
        let (_, z) = self.primal.objective?;
        let of_z = |t: &&Term| t.variable == Variable::Own(z);
        let mut found = None;
        for (k, e) in self.primal.equations.iter().enumerate() {
            let mut mine = self.terms[k].iter().filter(of_z);
            let Some(t) = mine.next() else { continue };
            let alone = mine.next().is_none() && found.is_none();
            let scalar = e.binder == Binder::default() && e.key.is_empty();
            let free = t.binder == Binder::default();
            if !alone || !scalar || !free || e.relation != Relation::Equal {
                return None;
            }
            let a = t.coefficient();
            let by_others = self.terms[k]
                .iter()
                .filter(|o| o.variable != t.variable)
                .any(|o| o.factors.iter().any(|(_, f)| mentions(f, z)));
            if a.has_variable() || by_others {
                return None;
            }
            found = Some((k, a));
        }
        let (k, a) = found?;
        let columns = &self.primal.generated.instance.columns;
        let origin = &self.primal.generated.origin;
        let at = origin.columns.symbol(z)?.start as usize;
        if columns.lower[at].is_finite() || columns.upper[at].is_finite() {
            return None;
        }
        let e = &self.primal.equations[k];
        let whole = -e.left.clone() + e.right.clone();
        let rest = whole.map_nodes(&|e| match e {
            Expr::Variable(Variable::Own(s), _) if s == z => Expr::Number(0.0),
            e => e,
        });
        Some(Eliminated {
            equation: k,
            function: rest / a,
        })
    }

    /// Whether an equation is the one that defines the objective, and is gone.
    pub fn is_eliminated(&self, equation: usize) -> bool {
        self.eliminated
            .as_ref()
            .is_some_and(|o| o.equation == equation)
    }

    /// The objective variable, where it was eliminated.
    pub fn eliminated_variable(&self) -> Option<SymbolId> {
        self.eliminated.as_ref()?;
        self.primal.objective.map(|o| o.1)
    }

    /// Where the text pairs an equation with a variable that is not in this model, that variable is its multiplier's name.
    fn names_of_text(&self) -> Vec<Option<SymbolId>> {
        let mut pairs: Vec<(SymbolId, SymbolId)> = Vec::new();
        for (_, s) in self.scope.symbols.iter() {
            let SymbolKind::Model(m) = &s.kind else {
                continue;
            };
            for item in m.items.iter().flatten() {
                if let ModelItem::Pair { rows, column } = item
                    && let Some(v) = self.scope.symbols.find(&column.name)
                {
                    let rows = rows.iter().filter_map(|r| self.scope.symbols.find(&r.name));
                    pairs.extend(rows.map(|r| (r, v)));
                }
            }
        }
        let used = |v: SymbolId| {
            let columns = &self.primal.generated.origin.columns;
            columns.symbol(v).is_some()
        };
        let mut names: Vec<Option<SymbolId>> = Vec::new();
        for e in &self.primal.equations {
            let dim = self.scope.get(e.symbol).dim();
            let of = |p: &&(SymbolId, SymbolId)| {
                p.0 == e.symbol && !used(p.1) && self.scope.get(p.1).dim() == dim
            };
            let name = pairs.iter().find(of).map(|p| p.1);
            let name = name.filter(|v| !names.contains(&Some(*v)));
            names.push(name);
        }
        names
    }

    /// Introduces the multipliers of the rows, with the sign that GAMS's marginals have, or, if `as_in_text`, with the one
    /// that the text gives to the variables it pairs with these rows.
    pub fn multipliers_of_rows(&mut self, as_in_text: bool) {
        let minimum = self.is_minimum();
        let names = self.names_of_text();
        let sign = |e: &Equation| match (e.relation, minimum) {
            (Relation::Equal, _) => Some(Sign::Free),
            (Relation::Greater, true) | (Relation::Less, false) => Some(Sign::Positive),
            (Relation::Less, true) | (Relation::Greater, false) => Some(Sign::Negative),
            (Relation::Free, _) => None,
        };
        let equations = &self.primal.equations;
        let opposite = equations.iter().zip(&names).any(|(e, name)| {
            let kind = name.map(|v| &self.scope.get(v).kind);
            matches!(
                (kind, sign(e)),
                (
                    Some(SymbolKind::Variable(VariableKind::Positive)),
                    Some(Sign::Negative)
                ) | (
                    Some(SymbolKind::Variable(VariableKind::Negative)),
                    Some(Sign::Positive)
                )
            )
        });
        self.flip = as_in_text && opposite;
        self.out.flipped = self.flip;
        for (k, e) in equations.iter().enumerate() {
            let Some(sign) = sign(e).filter(|_| !self.is_eliminated(k)) else {
                continue;
            };
            let name = match names[k] {
                Some(v) => self.scope.get(v).name.to_string(),
                None => self.fresh(&format!("y_{}", self.scope.get(e.symbol).name)),
            };
            let domain = domain_of(self.scope.symbols, e.symbol);
            self.multipliers[k] = Some(self.out.multipliers.len());
            self.out.multipliers.push(Multiplier {
                name,
                domain,
                sign: self.flipped(sign),
                origin: Origin::Row(e.symbol),
            });
        }
        if self.flip {
            self.out.notes.push(
                "The text pairs these rows with variables of the opposite sign: the multipliers here are the marginals times -1."
                    .into(),
            );
        }
    }

    /// The sign of a multiplier as it is shown.
    pub fn flipped(&self, sign: Sign) -> Sign {
        if self.flip { sign.opposite() } else { sign }
    }

    /// A multiplier with its key, as an expression with GAMS's sign.
    pub fn multiplier(&self, number: usize, key: Vec<Part>) -> Expr {
        let y = Expr::Variable(Variable::Multiplier(number), key);
        if self.flip { negate(y) } else { y }
    }

    /// The number of the multiplier of an equation.
    pub fn multiplier_number(&self, equation: usize) -> Option<usize> {
        self.multipliers[equation]
    }

    /// The declared kind of a variable.
    pub fn kind(&self, v: SymbolId) -> VariableKind {
        kind(self.scope.symbols, v)
    }

    /// Whether an equation is linear in the variables.
    pub fn is_linear(&self, equation: usize) -> bool {
        let of = |t: &Term| t.factors.iter().any(|(_, f)| f.has_variable());
        !self.terms[equation].iter().any(of)
    }

    /// The multiplier of an equation with its key.
    pub fn multiplier_of(&self, equation: usize) -> Option<Expr> {
        let key = self.primal.equations[equation].key.clone();
        Some(self.multiplier(self.multipliers[equation]?, key))
    }

    /// Whether the objective is to be small.
    pub fn is_minimum(&self) -> bool {
        !matches!(self.primal.objective, Some((Sense::Maximize, _)))
    }

    /// The user's variables with columns, but for an eliminated objective.
    pub fn variables(&self) -> Vec<SymbolId> {
        let gone = self.eliminated_variable();
        let blocks = self.primal.generated.origin.columns.list.iter();
        blocks
            .map(|b| b.symbol)
            .filter(|s| Some(*s) != gone)
            .collect()
    }

    /// Whether an equation holds a variable.
    pub(super) fn is_mentioned(&self, v: Variable) -> bool {
        self.terms.iter().flatten().any(|t| t.variable == v)
    }

    /// The row of a variable's columns: its indices, what the equations add to it (with their multipliers), and what the
    /// objective adds.
    pub fn column_row(&mut self, v: SymbolId) -> Result<ColumnRow, String> {
        let me = Variable::Own(v);
        let mut cost_terms = Vec::new();
        if let Some(o) = &self.eliminated {
            let f = o.function.clone();
            cost_terms = gradient(&f, &Expr::Number(0.0), &mut self.out.indices)?;
            cost_terms.retain(|t| t.variable == me);
        }
        let terms: Vec<(usize, Term)> = self
            .terms
            .iter()
            .enumerate()
            .filter(|(k, _)| self.multipliers[*k].is_some())
            .flat_map(|(k, t)| {
                t.iter()
                    .filter(|t| t.variable == me)
                    .map(move |t| (k, t.clone()))
            })
            .collect();
        let references: Vec<&[Part]> = terms
            .iter()
            .map(|t| t.1.key.as_slice())
            .chain(cost_terms.iter().map(|t| t.key.as_slice()))
            .collect();
        let sets = target_sets(
            self.scope.symbols,
            &self.out.indices,
            &self.scope.get(v).domain,
            &references,
        );
        let target: Vec<IndexId> = sets.iter().map(|s| self.out.indices.add(*s)).collect();
        let turned = |t: &Term, binder: &Binder, y: Option<&Expr>| {
            invert(self.scope.symbols, &self.out.indices, t, binder, y, &target)
        };
        let rows = terms.iter().map(|(k, t)| {
            let y = self.multiplier_of(*k);
            turned(t, &self.binders[*k], y.as_ref())
        });
        let mut rows: Vec<Inverted> = rows.collect();
        let cost = cost_terms.iter();
        let mut cost: Vec<Inverted> = cost.map(|t| turned(t, &Binder::default(), None)).collect();
        if self.eliminated.is_none() && self.primal.objective.is_some_and(|o| o.1 == v) {
            cost.push(Inverted {
                conditions: Vec::new(),
                body: Expr::Number(1.0),
            });
        }
        // A column that stands in no row has one of its own all the same.
        let common = match self.without_row(v).is_empty() {
            true => common(&mut rows, &mut cost),
            false => Vec::new(),
        };
        let add = |list: Vec<Inverted>| {
            sum(list
                .into_iter()
                .map(|i| (false, guarded(i.body, i.conditions)))
                .collect())
        };
        Ok(ColumnRow {
            sets,
            target,
            conditions: common,
            rows: add(rows),
            cost: add(cost),
        })
    }

    /// The columns of a variable at these places as data, guarded by it; no condition where these are all tuples.
    pub fn membership(
        &mut self,
        name: &str,
        text: String,
        v: SymbolId,
        row: &ColumnRow,
        places: &[usize],
    ) -> Option<Expr> {
        let size = |s: &SymbolId| self.scope.store.table(self.scope.get(*s).table).len();
        let all: usize = row.sets.iter().map(size).product();
        if places.len() == all {
            return None;
        }
        let keys = self.columns(v).keys(places);
        Some(self.new_set(name, text, v, keys, &row.key()))
    }

    /// The constants of an equation on its right side.
    pub fn right_side(&self, equation: usize) -> Expr {
        let e = &self.primal.equations[equation];
        let (left, right) = (e.left.without_variables(), e.right.without_variables());
        right - left
    }
}

/// The row of a variable's columns.
pub struct ColumnRow {
    /// The sets it runs over.
    pub sets: Vec<SymbolId>,
    /// Its indices.
    pub target: Vec<IndexId>,
    /// What holds of all its terms.
    pub conditions: Vec<Expr>,
    /// `Σ coefficient · multiplier` over the equations.
    pub rows: Expr,
    /// The derivative of the objective.
    pub cost: Expr,
}

impl ColumnRow {
    /// Its key.
    pub fn key(&self) -> Vec<Part> {
        self.target.iter().map(|j| Part::Index(*j)).collect()
    }

    /// What it runs over, with one more condition.
    pub fn binder(&self, more: Option<Expr>) -> Binder {
        let mut conditions = self.conditions.clone();
        conditions.extend(more);
        Binder {
            indices: self.target.clone(),
            conditions,
        }
    }
}

/// Takes the conditions out that all terms share.
fn common(rows: &mut [Inverted], cost: &mut [Inverted]) -> Vec<Expr> {
    let mut all = rows.iter().chain(cost.iter());
    let Some(first) = all.next() else {
        return Vec::new();
    };
    let mut common = first.conditions.clone();
    common.retain(|c| all.clone().all(|i| i.conditions.contains(c)));
    for i in rows.iter_mut().chain(cost) {
        i.conditions.retain(|c| !common.contains(c));
    }
    common
}

pub(super) fn mentions(e: &Expr, v: SymbolId) -> bool {
    e.any(&|e| matches!(e, Expr::Variable(Variable::Own(s), _) if *s == v))
}

/// The declared kind of a variable.
pub fn kind(symbols: &Symbols, v: SymbolId) -> VariableKind {
    match symbols.get(v).kind {
        SymbolKind::Variable(k) => k,
        _ => VariableKind::Free,
    }
}

/// The sets that a symbol is declared over; the universe where none is known.
pub fn domain_of(symbols: &Symbols, s: SymbolId) -> Vec<SymbolId> {
    let set = |p: &DomainPosition| match p {
        DomainPosition::Set(s) => symbols.root(*s),
        _ => UNIVERSE,
    };
    symbols.get(s).domain.iter().map(set).collect()
}
