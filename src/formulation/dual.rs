//! The dual of a linear program, with indices and with GAMS's signs: its levels are the primal's marginals. Of a convex
//! quadratic program Dorn's dual, with quadratic rows Wolfe's: a further variable stands for the point at which the
//! gradients are taken.

use super::columns::Columns;
use super::derive::{ColumnRow, Derivation, Primal, domain_of};
use super::kkt::{start_of_levels, start_of_multiplier};
use super::lower::Equation;
use super::tree::*;
use super::{Formulation, Multiplier, Origin, Row, Scope, Sign};
use crate::check::node::SymbolId;
use crate::check::symbols::attribute;
use crate::data::value::EPS;

/// Derives the dual of a linear or convex quadratic model. `as_in_text`: multipliers have the signs of the variables that
/// the text pairs with their rows. `Err` says why there is none.
pub fn dual(scope: Scope, primal: &Primal, as_in_text: bool) -> Result<Formulation, String> {
    let Some((sense, _)) = primal.objective else {
        return Err("the model has no objective: nothing is minimised or maximised".into());
    };
    let name = format!("dual_{}", primal.name);
    let is_linear = primal.generated.instance.is_linear();
    let using = if is_linear { "lp" } else { "qcp" };
    let mut d = Derivation::new(scope, primal, name.clone(), using)
        .map_err(|(k, why)| format!("`{}`: {why}", scope.get(primal.equations[k].symbol).name))?;
    d.out.name = d.fresh(&name);
    d.multipliers_of_rows(as_in_text);
    let mut objective = Vec::new();
    for k in 0..primal.equations.len() {
        let Some(number) = d.multiplier_number(k) else {
            continue;
        };
        let b = match d.is_linear(k) {
            true => d.right_side(k),
            false => {
                // The product of a multiplier and a quadratic form.
                d.out.using = "nlp".into();
                right_side_at(&primal.equations[k]).map_err(|why| {
                    format!("`{}`: {why}", scope.get(primal.equations[k].symbol).name)
                })?
            }
        };
        let y = d.multiplier(number, primal.equations[k].key.clone());
        objective.push((false, sum_over(d.binders[k].clone(), b * y)));
    }
    for v in d.variables() {
        let mut bounds = column(&mut d, v)?;
        objective.append(&mut bounds);
    }
    if let Some(o) = &d.eliminated {
        objective.push((false, less_slope(&o.function)?));
    }
    let other = match sense {
        Sense::Minimize => Sense::Maximize,
        Sense::Maximize => Sense::Minimize,
    };
    d.out.objective = Some((other, sum(objective)));
    d.out.objective_name = d.fresh("dual_objective");
    if !is_linear {
        points(&mut d);
    }
    if d.out.using == "nlp" {
        // It is not concave in all its variables: it begins at the answer.
        start(&mut d);
    }
    Ok(d.out)
}

/// Levels of multipliers and points as they are at the answer.
fn start(d: &mut Derivation) {
    for k in 0..d.primal.equations.len() {
        if let Some(y) = d.multiplier_number(k) {
            start_of_multiplier(d, k, y);
        }
    }
    for m in d.out.multipliers.clone() {
        if let Origin::Point(v) = m.origin {
            start_of_levels(d, v, &m.name);
        }
    }
}

/// What is on the right side of the tangent of a quadratic row, `b − g + ∇g·x`.
fn right_side_at(e: &Equation) -> Result<Expr, String> {
    if e.relation == Relation::Equal {
        return Err("a quadratic equation is not convex".into());
    }
    let (left, right) = (less_slope(&e.left)?, less_slope(&e.right)?);
    Ok(right - left)
}

/// `f − ∇f·x` of a quadratic function: its constants, less its quadratic terms.
fn less_slope(f: &Expr) -> Result<Expr, String> {
    if !f.has_variable() {
        return Ok(f.clone());
    }
    let unknown = || Err("it is not written as a sum of products and squares".to_string());
    // A product of two linear forms: their constants, less what is left of them.
    let pair = |a: &Expr, b: &Expr, make: &dyn Fn(Expr, Expr) -> Expr| {
        let (a0, b0) = (a.without_variables(), b.without_variables());
        let (a1, b1) = (homogeneous(a), homogeneous(b));
        make(a0, b0) - make(a1, b1)
    };
    let square = |a: &Expr| {
        let sqr = |a: Expr, _: Expr| match a {
            Expr::Number(x) => Expr::Number(x * x),
            Expr::Negate(a) => Expr::Call(Function::Sqr, vec![*a]),
            a => Expr::Call(Function::Sqr, vec![a]),
        };
        Ok(pair(a, a, &sqr))
    };
    match f {
        Expr::Variable(..) => Ok(Expr::Number(0.0)),
        Expr::Negate(a) => Ok(negate(less_slope(a)?)),
        Expr::Sum(t) => {
            let each = t.iter().map(|(m, e)| Ok((*m, less_slope(e)?)));
            Ok(sum(each.collect::<Result<_, String>>()?))
        }
        Expr::Dollar(a, c) => Ok(guarded(less_slope(a)?, vec![(**c).clone()])),
        Expr::Aggregate(AggregateOp::Sum, d, a) => Ok(sum_over((**d).clone(), less_slope(a)?)),
        Expr::Product(t) => {
            let (with, mut factors): (Vec<_>, Vec<_>) =
                t.iter().cloned().partition(|(_, e)| e.has_variable());
            let rest = match with.as_slice() {
                [(false, a)] => less_slope(a)?,
                [(false, a), (false, b)] => pair(a, b, &|a, b| a * b),
                _ => return unknown(),
            };
            factors.push((false, rest));
            Ok(product(factors))
        }
        Expr::Call(Function::Sqr, args) => square(&args[0]),
        Expr::Call(Function::Power, args) if args[1] == Expr::Number(2.0) => square(&args[0]),
        Expr::Binary(BinaryOp::Power, a, n) if **n == Expr::Number(2.0) => square(a),
        _ => unknown(),
    }
}

/// A linear form without its constants.
fn homogeneous(e: &Expr) -> Expr {
    if !e.has_variable() {
        return Expr::Number(0.0);
    }
    match e {
        Expr::Negate(a) => negate(homogeneous(a)),
        Expr::Sum(t) => sum(t.iter().map(|(m, e)| (*m, homogeneous(e))).collect()),
        Expr::Dollar(a, c) => guarded(homogeneous(a), vec![(**c).clone()]),
        Expr::Aggregate(AggregateOp::Sum, d, a) => sum_over((**d).clone(), homogeneous(a)),
        Expr::Product(t) => {
            let one = |(d, e): &(bool, Expr)| match e.has_variable() {
                true => (*d, homogeneous(e)),
                false => (*d, e.clone()),
            };
            product(t.iter().map(one).collect())
        }
        e => e.clone(),
    }
}

/// The user's variables that are left stand for the point at which the gradient is taken: they get names of their own.
fn points(d: &mut Derivation) {
    let mut found: Vec<SymbolId> = Vec::new();
    let mut rows = std::mem::take(&mut d.out.rows);
    let objective = d.out.objective.take();
    let mut all: Vec<&Expr> = rows.iter().flat_map(|r| [&r.left, &r.right]).collect();
    all.extend(objective.as_ref().map(|o| &o.1));
    for e in all {
        e.own_variables(&mut found);
    }
    let first = d.out.multipliers.len();
    for &v in &found {
        let name = d.fresh(&format!("at_{}", d.scope.get(v).name));
        d.out.multipliers.push(Multiplier {
            name,
            domain: domain_of(d.scope.symbols, v),
            sign: Sign::Free,
            origin: Origin::Point(v),
        });
    }
    let replaced = |e: &Expr| {
        e.map_nodes(&|e| match e {
            Expr::Variable(Variable::Own(v), key) => {
                let place = found.iter().position(|f| *f == v).unwrap_or_default();
                Expr::Variable(Variable::Multiplier(first + place), key)
            }
            e => e,
        })
    };
    for r in &mut rows {
        (r.left, r.right) = (replaced(&r.left), replaced(&r.right));
    }
    d.out.objective = objective.map(|(sense, e)| (sense, replaced(&e)));
    d.out.rows = rows;
}

/// The columns of a variable that have the same sign.
struct Class {
    sign: Sign,
    places: Vec<usize>,
}

/// Which bounds of a variable have a multiplier, and the columns that have them.
type Bounds = (Origin, Vec<usize>);

/// How the name of the multiplier of bounds begins, what its columns have, its sign for a minimum, and the data of the
/// bound.
fn about(bounds: Origin) -> (&'static str, &'static str, Sign, Option<u32>) {
    let (lower, upper) = (Some(attribute::LO), Some(attribute::UP));
    match bounds {
        Origin::Lower(_) => ("lo", "a lower bound", Sign::Positive, lower),
        Origin::Upper(_) => ("up", "an upper bound", Sign::Negative, upper),
        Origin::Fixed(_) => ("fx", "a fixed value", Sign::Free, lower),
        _ => ("no", "neither row nor bound", Sign::Free, None),
    }
}

/// The rows of a variable's columns, and what their bounds add to the objective.
fn column(d: &mut Derivation, v: SymbolId) -> Result<Vec<(bool, Expr)>, String> {
    let columns = d.columns(v);
    let row = d.column_row(v)?;
    let classes = classes(&columns);
    let mut left = vec![(false, row.rows.clone())];
    let mut objective = Vec::new();
    for bounds in limits(d, v, &columns, &classes) {
        let (term, worth) = multiplier_of_bounds(d, v, &row, &bounds);
        left.push((false, term));
        objective.extend(worth.map(|w| (false, w)));
    }
    let (left, minimum) = (sum(left), d.is_minimum());
    let name = d.scope.get(v).name.to_string();
    for (n, class) in classes.iter().enumerate() {
        let word = class.sign.name();
        let (suffix, guard) = match classes.len() {
            1 => (String::new(), None),
            _ => {
                let guard = d.membership(
                    &format!("{word}_{name}"),
                    format!("columns of {name} that are {word}"),
                    v,
                    &row,
                    &class.places,
                );
                (format!("_{}", n + 1), guard)
            }
        };
        let relation = match (class.sign, minimum) {
            (Sign::Free, _) => Relation::Equal,
            (Sign::Positive, true) | (Sign::Negative, false) => Relation::Less,
            _ => Relation::Greater,
        };
        let row_name = d.fresh(&format!("dual_{name}{suffix}"));
        d.out.rows.push(Row {
            name: row_name,
            text: format!("dual of {name}"),
            domain: domain_of(d.scope.symbols, v),
            key: row.key(),
            binder: row.binder(guard),
            left: left.clone(),
            relation,
            right: row.cost.clone(),
            pair: Some(Variable::Own(v)),
        });
    }
    Ok(objective)
}

/// The bounds that are not said by the sign, and those that are missed.
fn limits(d: &mut Derivation, v: SymbolId, columns: &Columns, classes: &[Class]) -> Vec<Bounds> {
    let single = (classes.len() == 1).then(|| classes[0].sign);
    let sign_of = |lo: f64, up: f64| single.unwrap_or(SIGNS[class_of(lo, up)]);
    let said_lower = |lo: f64, up: f64| sign_of(lo, up) == Sign::Positive && lo == 0.0;
    let said_upper = |lo: f64, up: f64| sign_of(lo, up) == Sign::Negative && up == 0.0;
    let mut lower = columns.places(|lo, up| lo.is_finite() && lo != up && !said_lower(lo, up));
    let mut upper = columns.places(|lo, up| up.is_finite() && lo != up && !said_upper(lo, up));
    let mut missing = Vec::new();
    let alone = d.unlimited_alone(v);
    if !alone.is_empty() {
        let bounds: Vec<(f64, f64)> = columns.bounds().collect();
        for n in alone {
            match bounds[n] {
                (lo, _) if lo.is_finite() => lower.push(n),
                (_, up) if up.is_finite() => upper.push(n),
                _ => missing.push(n),
            }
        }
        for places in [&mut lower, &mut upper] {
            places.sort_unstable();
            places.dedup();
        }
    }
    if let Some(&n) = missing.first() {
        let name = &d.scope.get(v).name;
        let record = super::text::record(d.scope.store, name, columns.key(n));
        let others = match missing.len() {
            1 => String::new(),
            n => format!(" (and {} more like it)", n - 1),
        };
        d.out.notes.push(format!(
            "{record}{others} is free, stands in no row and makes the objective better without limit: its row here says that \
             its coefficient is 0, and holds nowhere, as the dual of an unbounded program must."
        ));
    }
    let mut all = vec![
        (Origin::Lower(v), lower),
        (Origin::Upper(v), upper),
        (Origin::Fixed(v), columns.places(|lo, up| lo == up)),
        (Origin::Missing(v), missing),
    ];
    all.retain(|b| !b.1.is_empty());
    all
}

/// The multiplier of bounds: its term in the row of the columns, and in the objective.
fn multiplier_of_bounds(
    d: &mut Derivation,
    v: SymbolId,
    row: &ColumnRow,
    (origin, places): &Bounds,
) -> (Expr, Option<Expr>) {
    let name = d.scope.get(v).name.to_string();
    let (which, text, sign, data) = about(*origin);
    let sign = if d.is_minimum() {
        sign
    } else {
        sign.opposite()
    };
    let multiplier = Multiplier {
        name: d.fresh(&format!("y_{which}_{name}")),
        domain: domain_of(d.scope.symbols, v),
        sign: d.flipped(sign),
        origin: *origin,
    };
    let number = d.out.multipliers.len();
    d.out.multipliers.push(multiplier);
    let y = d.multiplier(number, row.key());
    let guard = d.membership(
        &format!("has_{which}_{name}"),
        format!("columns of {name} with {text}"),
        v,
        row,
        places,
    );
    let Some(offset) = data else {
        // It keeps the row in the model.
        let term = Expr::Number(EPS) * y;
        return (guarded(term, guard.into_iter().collect()), None);
    };
    let bound = Expr::Data(Source::Attribute(v, offset), row.key());
    let binder = match &guard {
        // The conditions of the row hold where there is such a column.
        Some(g) => Binder {
            indices: row.target.clone(),
            conditions: vec![g.clone()],
        },
        None => row.binder(None),
    };
    let worth = sum_over(binder, bound * y.clone());
    (guarded(y, guard.into_iter().collect()), Some(worth))
}

const SIGNS: [Sign; 3] = [Sign::Positive, Sign::Negative, Sign::Free];

/// The place in [`SIGNS`] of what bounds say of a sign.
fn class_of(lower: f64, upper: f64) -> usize {
    match (lower, upper) {
        _ if lower >= 0.0 => 0,
        _ if upper <= 0.0 => 1,
        _ => 2,
    }
}

/// Columns that are at least 0, at most 0, and others.
fn classes(columns: &Columns) -> Vec<Class> {
    let of = |(n, sign): (usize, &Sign)| Class {
        sign: *sign,
        places: columns.places(|lo, up| class_of(lo, up) == n),
    };
    let mut out: Vec<Class> = SIGNS.iter().enumerate().map(of).collect();
    out.retain(|c| !c.places.is_empty());
    if let [one] = out.as_mut_slice() {
        // A sign that no column needs is none.
        let mut each = columns.bounds();
        let needed = match one.sign {
            Sign::Positive => each.any(|(lo, up)| lo == 0.0 && up > 0.0),
            Sign::Negative => each.any(|(lo, up)| up == 0.0 && lo < 0.0),
            Sign::Free => true,
        };
        if !needed {
            one.sign = Sign::Free;
        }
    }
    out
}
