//! A model and its dual side by side, and complementary slackness in numbers.

use super::bounds::{self, Assigned};
use super::derive::{Derivation, Primal};
use super::math::{Math, name as name_of, relation_sign, symbol_name};
use super::page::{Block, Formula, Page, Setter, formulas, over_domain, signed};
use super::tree::*;
use super::{Formulation, Multiplier, Origin, Row, Scope, Sign};
use crate::check::node::SymbolId;
use crate::check::symbols::Symbols;
use crate::solve::nlp::convex::{Shape, shape};

/// More lines of numbers than this are not shown.
const MAX_LINES: usize = 40;

/// The model itself as a formulation, its objective variable eliminated where a derivation does that.
pub fn own(d: &Derivation) -> Formulation {
    let primal = d.primal;
    let rows = primal.equations.iter().enumerate();
    let rows = rows.filter(|(k, _)| !d.is_eliminated(*k));
    let rows = rows.map(|(_, e)| e.row(d.scope.symbols, Vec::new(), None));
    let objective = primal.objective.map(|(sense, z)| match &d.eliminated {
        Some(o) => (sense, o.function.clone()),
        None => (sense, Expr::Variable(Variable::Own(z), Vec::new())),
    });
    Formulation {
        name: primal.name.clone(),
        using: primal.using.clone(),
        objective,
        own: d.variables(),
        rows: rows.collect(),
        indices: d.out.indices.clone(),
        ..Formulation::default()
    }
}

/// Primal, dual, and what is paired with what.
pub fn page(scope: Scope, primal: &Formulation, bounds: &[Assigned], dual: &Formulation) -> Page {
    let mut out = vec![Block::Heading(format!("Primal: {}", primal.name))];
    let mut s = Setter::new(scope, primal);
    out.extend(formulas(&mut s, primal));
    let known = bounds::known(&mut s, primal, bounds, true);
    let mut lines = Vec::new();
    for &v in &primal.own {
        let before = lines.len();
        let mine = known.iter().filter(|k| k.variable == v);
        lines.extend(mine.map(|k| k.formula.clone()));
        if lines.len() == before {
            lines.push(Formula::of(sign(scope.symbols, dual, v)));
        }
    }
    out.push(Block::Words("with".into()));
    out.push(Block::Formulas(lines));
    out.push(Block::Heading(format!("Dual: {}", dual.name)));
    let mut t = Setter::new(scope, dual);
    out.extend(formulas(&mut t, dual));
    out.extend(dual.notes.iter().map(|n| Block::Words(n.clone())));
    out.push(Block::Heading("What is paired with what".into()));
    let mut pairs = Vec::new();
    // `limit_i ≤ …`
    let open = |name: &str, domain: &[SymbolId], relation: Relation| {
        let left = over_domain(scope.symbols, Math::Name(name_of(name)), domain);
        let relation = Math::Operator(relation_sign(relation));
        Math::Row(vec![left, relation, Math::Words("…".into())])
    };
    for (n, m) in dual.multipliers.iter().enumerate() {
        let Origin::Row(e) = m.origin else { continue };
        let name = &*scope.get(e).name;
        let row = primal.rows.iter().find(|r| r.name == name);
        let left = open(name, &m.domain, row.map_or(Relation::Equal, |r| r.relation));
        let right = over_domain(
            scope.symbols,
            t.variable(Variable::Multiplier(n)),
            &m.domain,
        );
        pairs.push((left, signed(right, m.sign)));
    }
    for v in &primal.own {
        let left = sign(scope.symbols, dual, *v);
        for r in rows_of(dual, *v) {
            pairs.push((left.clone(), open(&r.name, &r.domain, r.relation)));
        }
        for (n, m) in dual.multipliers.iter().enumerate() {
            let (relation, upper) = match m.origin {
                Origin::Lower(of) if of == *v => ("≥", false),
                Origin::Upper(of) if of == *v => ("≤", true),
                Origin::Fixed(of) if of == *v => ("=", false),
                _ => continue,
            };
            let mut mine = known.iter().filter(|k| k.origin == Some(m.origin));
            let left = match (mine.next(), mine.next()) {
                (Some(one), None) => one.formula.math.clone(),
                _ => {
                    let base = Math::Name(symbol_name(scope.symbols, *v));
                    let bound = Math::Bar(Box::new(base), upper);
                    let bound = over_domain(scope.symbols, bound, &m.domain);
                    let variable = bounds::variable(scope.symbols, *v);
                    Math::Row(vec![variable, Math::Operator(relation), bound])
                }
            };
            let right = over_domain(
                scope.symbols,
                t.variable(Variable::Multiplier(n)),
                &m.domain,
            );
            pairs.push((left, signed(right, m.sign)));
        }
    }
    out.push(Block::Pairs(["primal".into(), "dual".into()], pairs));
    out
}

fn rows_of(dual: &Formulation, v: SymbolId) -> impl Iterator<Item = &Row> {
    let of_v = move |r: &&Row| r.pair == Some(Variable::Own(v));
    dual.rows.iter().filter(of_v)
}

/// A variable with the sign that its rows in the dual give it; free only without bounds.
fn sign(symbols: &Symbols, dual: &Formulation, v: SymbolId) -> Math {
    let maximum = matches!(dual.objective, Some((Sense::Maximize, _)));
    let rows: Vec<&Row> = rows_of(dual, v).collect();
    let sign = match rows.as_slice() {
        [one] => match (one.relation, maximum) {
            (Relation::Less, true) | (Relation::Greater, false) => Sign::Positive,
            (Relation::Greater, true) | (Relation::Less, false) => Sign::Negative,
            _ => Sign::Free,
        },
        _ => Sign::Free,
    };
    let base = bounds::variable(symbols, v);
    let limits = |m: &Multiplier| {
        let all = [Origin::Lower(v), Origin::Upper(v), Origin::Fixed(v)];
        all.contains(&m.origin)
    };
    match sign {
        Sign::Free if rows.len() != 1 || dual.multipliers.iter().any(limits) => base,
        sign => signed(base, sign),
    }
}

/// A number as people read it: seven digits.
pub fn short(x: f64) -> String {
    if x == 0.0 || x.abs() < 1e-12 {
        return "0".into();
    }
    if !x.is_finite() {
        return if x > 0.0 { "∞" } else { "−∞" }.into();
    }
    let digits = 6 - x.abs().log10().floor() as i32;
    let text = match (-3..=12).contains(&digits) {
        true => format!("{x:.*}", digits.max(0) as usize),
        false => format!("{x:.6e}"),
    };
    let text = match text.contains('.') && !text.contains('e') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    text.replace('-', "−")
}

/// Complementary slackness in numbers; empty without an answer.
pub fn slackness(scope: Scope, primal: &Primal, flipped: bool) -> Page {
    let Some(a) = &primal.answer else {
        return Vec::new();
    };
    let g = &primal.generated;
    let p = &g.instance;
    let z = p.objective.map(|o| o.column as usize);
    let mut lines = Vec::new();
    let near = |x: f64, size: f64| x.abs() <= 1e-7 * (1.0 + size.abs());
    for b in &g.origin.rows.list {
        for i in b.start..b.start + b.len {
            let k = i as usize;
            if !matches!(p.rows.relation[k], Relation::Greater | Relation::Less) {
                continue;
            }
            let sign = relation_sign(p.rows.relation[k]);
            let flip = if flipped { -1.0 } else { 1.0 };
            let (left, right) = (a.activity[k], p.rows.rhs[k]);
            let y = flip * a.row_marginal[k];
            let slack = (left - right).abs();
            let mut line = format!(
                "{}: {} {sign} {}",
                scope.called(&g.origin.rows, k),
                short(left),
                short(right)
            );
            line.push_str(&match near(slack, right) {
                true if near(y, 0.0) => ", tight, and its multiplier is 0".to_string(),
                true => format!(", tight: its multiplier is {}", short(y)),
                false => format!(", slack {}, so its multiplier is 0", short(slack)),
            });
            lines.push(line);
        }
    }
    // A column's reduced cost is what its row in the dual leaves.
    let (gone, mut cost) = costs(p);
    if let Shape::ConvexQuadratic { objective: f, .. } = shape(p) {
        cost.clone_from(&f.gradient);
        let hessian = f.hessian.iter();
        hessian.for_each(|&(i, j, v)| cost[i] += v * a.level[j]);
    }
    let maximum = p.sign() < 0.0;
    for b in &g.origin.columns.list {
        for j in b.start..b.start + b.len {
            let k = j as usize;
            let (lo, up) = (p.columns.lower[k], p.columns.upper[k]);
            if gone && Some(k) == z || !lo.is_finite() && !up.is_finite() {
                continue;
            }
            let (x, d) = (a.level[k], a.column_marginal[k]);
            let at_lower = near(x - lo, x);
            let sign = if at_lower != maximum { "≤" } else { "≥" };
            let bound = if at_lower { lo } else { up };
            let name = scope.called(&g.origin.columns, j as usize);
            let [x_text, right] = [x, cost[k]].map(short);
            let relation = match () {
                () if lo == up => "=",
                () if at_lower => "≥",
                () => "≤",
            };
            lines.push(match near(d, 0.0) {
                true => format!("{name}: {right} = {right}, tight; its level is {x_text}"),
                // A bound other than 0 has a multiplier, and the row in the dual is tight.
                false if bound != 0.0 || lo == up => {
                    let (bound, y) = (short(bound), short(if flipped { -d } else { d }));
                    format!("{name}: {x_text} {relation} {bound}, tight: its multiplier is {y}")
                }
                false => {
                    let (left, slack) = (short(cost[k] - d), short(d.abs()));
                    let side = if at_lower { "lower" } else { "upper" };
                    format!("{name}: {left} {sign} {right}, slack {slack}, so it is at its {side} bound, {x_text}")
                }
            });
        }
    }
    if lines.len() > MAX_LINES {
        let tight = lines.iter().filter(|l| l.contains(", tight")).count();
        lines = vec![format!(
            "{} pairs of a row or column with its multiplier: {tight} are tight, {} have a slack and a multiplier of 0.",
            lines.len(),
            lines.len() - tight
        )];
    }
    if lines.is_empty() {
        return Vec::new();
    }
    let mut out = vec![Block::Heading("Complementary slackness in numbers".into())];
    out.extend(lines.into_iter().map(|l| Block::Words(format!("  {l}"))));
    out
}

/// Whether one row defines the objective variable, and the costs of the columns.
pub fn costs(p: &crate::model::instance::Instance) -> (bool, Vec<f64>) {
    let mut cost = vec![0.0; p.column_count()];
    let Some(z) = p.objective.map(|o| o.column as usize) else {
        return (false, cost);
    };
    let mut rows = (0..p.row_count()).filter(|&i| p.matrix.row(i).any(|(j, v)| j == z && v != 0.0));
    match (rows.next(), rows.next()) {
        (Some(i), None) if p.rows.relation[i] == Relation::Equal => {
            let a = p.matrix.row(i).find(|t| t.0 == z).map_or(1.0, |t| t.1);
            p.matrix.row(i).for_each(|(j, v)| cost[j] = -v / a);
            (true, cost)
        }
        _ => {
            cost[z] = 1.0;
            (false, cost)
        }
    }
}
