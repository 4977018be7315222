//! The optimality conditions of a smooth program (Karush, Kuhn, Tucker) as a complementarity problem, with indices.
//!
//! Of a minimum, `∇f − Σ y ∇g ⟂ l ≤ x ≤ u` and each row with its multiplier; of a maximum the same with opposite signs, so
//! that the multipliers are GAMS's marginals.

use super::derive::{Derivation, Primal, domain_of};
use super::tree::*;
use super::{Assignment, Formulation, NewData, Row, Scope};
use crate::check::node::SymbolId;
use crate::data::table::Table;
use crate::data::universe::Label;
use crate::data::value::EPS;
use crate::syntax::ast::VariableKind;

/// Why there are no optimality conditions, and the equation that is to blame.
pub type Refusal = (Option<usize>, String);

/// Derives the optimality conditions of a model. `keep`: each row holds its partner, with a coefficient eps, so that rows
/// whose terms cancel are not empty. `as_in_text`: multipliers have the signs of the variables that the text pairs with
/// their rows.
pub fn kkt(
    scope: Scope,
    primal: &Primal,
    keep: bool,
    as_in_text: bool,
) -> Result<Formulation, Refusal> {
    if primal.objective.is_none() {
        let why = "the model has no objective: nothing is minimised or maximised";
        return Err((None, why.into()));
    }
    let name = format!("kkt_{}", primal.name);
    let mut d =
        Derivation::new(scope, primal, name.clone(), "mcp").map_err(|(k, why)| (Some(k), why))?;
    d.out.name = d.fresh(&name);
    d.multipliers_of_rows(as_in_text);
    for v in d.variables() {
        d.out.own.push(v);
        stationarity(&mut d, v, keep).map_err(|why| (None, why))?;
    }
    for k in 0..primal.equations.len() {
        feasibility(&mut d, k, keep);
    }
    // A variable whose terms cancel has no column, and stands in the text all the same.
    let mut own = std::mem::take(&mut d.out.own);
    for e in d.out.rows.iter().flat_map(|r| [&r.left, &r.right]) {
        e.own_variables(&mut own);
    }
    d.out.own = own;
    for v in d.variables() {
        start_of_columns(&mut d, v);
    }
    Ok(d.out)
}

/// `∇f − Σ y ∇g ⟂ x`
fn stationarity(d: &mut Derivation, v: SymbolId, keep: bool) -> Result<(), String> {
    let row = d.column_row(v)?;
    let columns = d.columns(v);
    let name = d.scope.get(v).name.to_string();
    let each = |test: &dyn Fn(f64, f64) -> bool| match columns.alike {
        Some((lower, upper)) => test(lower, upper),
        None => columns.bounds().all(|(lower, upper)| test(lower, upper)),
    };
    let relation = match () {
        () if each(&|lo, up| !lo.is_finite() && !up.is_finite()) => Relation::Equal,
        () if each(&|lo, up| lo.is_finite() && !up.is_finite()) => Relation::Greater,
        () if each(&|lo, up| !lo.is_finite() && up.is_finite()) => Relation::Less,
        () => Relation::Free,
    };
    let guard = match is_exact(d, &row.conditions, &row.sets, &row.target, columns.len()) {
        true => None,
        false => d.membership(
            &format!("in_{name}"),
            format!("columns of {name}"),
            v,
            &row,
            &columns.places(|_, _| true),
        ),
    };
    let left = match d.is_minimum() {
        true => row.cost.clone() - row.rows.clone(),
        false => row.rows.clone() - row.cost.clone(),
    };
    // A variable that stands in no row is kept in the model by a coefficient eps.
    let left = match keep || !d.without_row(v).is_empty() {
        true => left + Expr::Number(EPS) * Expr::Variable(Variable::Own(v), row.key()),
        false => left,
    };
    let row_name = d.fresh(&format!("stat_{name}"));
    d.out.rows.push(Row {
        name: row_name,
        text: format!("stationarity in {name}"),
        domain: domain_of(d.scope.symbols, v),
        key: row.key(),
        binder: row.binder(guard),
        left,
        relation,
        right: Expr::Number(0.0),
        pair: Some(Variable::Own(v)),
    });
    Ok(())
}

/// Whether conditions leave as many tuples of these sets as there are columns; false where that is not easily seen.
fn is_exact(
    d: &Derivation,
    conditions: &[Expr],
    sets: &[SymbolId],
    target: &[IndexId],
    columns: usize,
) -> bool {
    let table = |s: SymbolId| -> &Table { d.scope.store.table(d.scope.symbols.rooted(s).table) };
    let mut tests: Vec<(&Table, Vec<usize>)> = Vec::new();
    for c in conditions {
        let Expr::Member(s, key) = c else {
            return false;
        };
        let place = |p: &Part| match p {
            Part::Index(k) => target.iter().position(|j| j == k),
            _ => None,
        };
        match key.iter().map(place).collect::<Option<Vec<usize>>>() {
            Some(places) => tests.push((table(*s), places)),
            None => return false,
        }
    }
    let all = |t: &(&Table, Vec<usize>)| (0..target.len()).all(|q| t.1.contains(&q));
    let Some((driver, places)) = tests.iter().find(|t| all(t)) else {
        let size: usize = sets.iter().map(|s| table(*s).len()).product();
        return tests.is_empty() && size == columns
            || matches!(tests.as_slice(), [(t, p)] if t.len() * size
                / p.iter().map(|&q| table(sets[q]).len()).product::<usize>().max(1) == columns
                && p.iter().enumerate().all(|(n, q)| !p[..n].contains(q)));
    };
    let count = (0..driver.len() as u32).filter(|&r| {
        let key = driver.key(r);
        let mut tuple = vec![0; target.len()];
        places.iter().zip(key).for_each(|(&q, l)| tuple[q] = *l);
        let repeated = places.iter().zip(key).all(|(&q, l)| tuple[q] == *l);
        let inside = sets
            .iter()
            .zip(&tuple)
            .all(|(s, l)| table(*s).find(&[*l]).is_some());
        let others = tests.iter().all(|(t, places)| {
            let key: Vec<Label> = places.iter().map(|&q| tuple[q]).collect();
            t.find(&key).is_some()
        });
        repeated && inside && others
    });
    count.count() == columns
}

/// A row of the model, with its multiplier.
fn feasibility(d: &mut Derivation, k: usize, keep: bool) {
    let Some(y) = d.multiplier_number(k) else {
        return;
    };
    let e = &d.primal.equations[k];
    let name = d.scope.get(e.symbol).name.to_string();
    let Some(block) = d.primal.generated.origin.rows.symbol(e.symbol) else {
        // All its rows are empty: there is nothing to hold.
        return;
    };
    let rows: Vec<u32> = (block.start..block.start + block.len).collect();
    let mut binder = d.binders[k].clone();
    if d.primal.tuples[k] != rows.len() {
        let text = format!("rows of {name} that hold a variable");
        let keys = rows.iter().map(|&i| block.key(i).to_vec()).collect();
        let inside = d.new_set(&format!("rows_{name}"), text, e.symbol, keys, &e.key);
        binder.conditions.push(inside);
    }
    // Of a maximum the function of the row is what is left over, unless the multiplier has the opposite sign.
    let (left, right, relation) = match d.is_minimum() != d.out.flipped {
        true => (e.left.clone(), e.right.clone(), e.relation),
        false => (
            e.right.clone(),
            e.left.clone(),
            match e.relation {
                Relation::Greater => Relation::Less,
                Relation::Less => Relation::Greater,
                r => r,
            },
        ),
    };
    let left = match keep {
        true => {
            let y = Expr::Variable(Variable::Multiplier(y), e.key.clone());
            left + Expr::Number(EPS) * y
        }
        false => left,
    };
    let row_name = d.fresh(&format!("row_{name}"));
    d.out.rows.push(Row {
        name: row_name,
        text: d.scope.get(e.symbol).text.to_string(),
        domain: domain_of(d.scope.symbols, e.symbol),
        key: e.key.clone(),
        binder,
        left,
        relation,
        right,
        pair: Some(Variable::Multiplier(y)),
    });
    start_of_multiplier(d, k, y);
}

/// The level of the multiplier of an equation is its marginal.
pub fn start_of_multiplier(d: &mut Derivation, equation: usize, multiplier: usize) {
    let symbol = d.primal.equations[equation].symbol;
    let block = d.primal.generated.origin.rows.symbol(symbol);
    let (Some(a), Some(block)) = (&d.primal.answer, block) else {
        return;
    };
    let records: Vec<(Vec<Label>, f64)> = (block.start..block.start + block.len)
        .map(|i| (block.key(i).to_vec(), a.row_marginal[i as usize]))
        .collect();
    let name = d.scope.get(symbol).name.to_string();
    let target = d.out.multipliers[multiplier].name.clone();
    let domain = domain_of(d.scope.symbols, symbol);
    assign(d, &format!("m_{name}"), &target, "l", domain, records);
}

/// Levels and bounds of a variable as they were at the solve.
fn start_of_columns(d: &mut Derivation, v: SymbolId) {
    let columns = d.columns(v);
    let name = d.scope.get(v).name.to_string();
    let domain = domain_of(d.scope.symbols, v);
    let (lower, upper) = match d.kind(v) {
        VariableKind::Positive => (0.0, f64::INFINITY),
        VariableKind::Negative => (f64::NEG_INFINITY, 0.0),
        _ => (f64::NEG_INFINITY, f64::INFINITY),
    };
    // What is 0 is stored as eps, so that the record is there.
    let stored = |x: f64| if x == 0.0 { EPS } else { x };
    let mut differing = |bound: f64, side: usize, word: &'static str| {
        let pick = |lower: f64, upper: f64| [lower, upper][side];
        let those = columns.places(|lower, upper| pick(lower, upper) != bound);
        let bounds: Vec<(f64, f64)> = columns.bounds().collect();
        let records = those.iter().map(|&n| {
            let (lower, upper) = bounds[n];
            (columns.key(n).to_vec(), stored(pick(lower, upper)))
        });
        let records: Vec<(Vec<Label>, f64)> = records.collect();
        assign(
            d,
            &format!("{word}_{name}"),
            &name,
            word,
            domain.clone(),
            records,
        );
    };
    differing(lower, 0, "lo");
    differing(upper, 1, "up");
    start_of_levels(d, v, &name);
}

/// The levels of `target` are those of a variable.
pub fn start_of_levels(d: &mut Derivation, v: SymbolId, target: &str) {
    let block = d.primal.generated.origin.columns.symbol(v);
    let (Some(a), Some(b)) = (&d.primal.answer, block) else {
        return;
    };
    let levels = (b.start..b.start + b.len).map(|j| (b.key(j).to_vec(), a.level[j as usize]));
    let records: Vec<(Vec<Label>, f64)> = levels.collect();
    let name = d.scope.get(v).name.to_string();
    let domain = domain_of(d.scope.symbols, v);
    assign(d, &format!("l_{name}"), target, "l", domain, records);
}

/// `target.attribute(…)$data(…) = data(…);`
fn assign(
    d: &mut Derivation,
    name: &str,
    target: &str,
    attribute: &'static str,
    domain: Vec<SymbolId>,
    mut records: Vec<(Vec<Label>, f64)>,
) {
    records.retain(|r| r.1 != 0.0);
    if records.is_empty() {
        return;
    }
    let name = d.fresh(name);
    let indices = domain.iter().map(|s| d.out.indices.add(*s)).collect();
    d.out.start.push(Assignment {
        target: target.to_string(),
        attribute,
        indices,
        data: NewData {
            name,
            text: format!("{target}.{attribute} at the solve"),
            domain,
            is_set: false,
            records,
        },
    });
}
