//! From a run to a primal with formulas and numbers.

use super::derive::{Primal, Values, domain_of};
use super::lower::{Equation, Lowering};
use super::numbers::left_side;
use super::tree::{Binder, Expr, IndexId, Indices, Part, Variable, guarded, sum};
use crate::check::symbols::{Symbols, UNIVERSE};
use crate::diag::Diagnostic;
use crate::model::origin::Blocks;
use crate::run::{Generated, Machine, Studied};
use crate::source::Span;

/// The model of the solve that a run was asked to look at.
///
/// # Errors
/// Why there is none.
pub fn chosen(m: &mut Machine) -> Result<(Primal, Studied), Box<Diagnostic>> {
    if let Some(found) = primal(m) {
        return Ok(found);
    }
    let seen = m.solves_seen();
    let choice = m.options.study.clone().unwrap_or_default();
    let message = match (&choice.model, choice.number) {
        (Some(name), _) if m.symbols.find(name).is_none() => super::show::unknown(&m.symbols, name),
        (_, Some(k)) if k > seen => format!("there is no solve {k}: the run has {seen}"),
        (Some(name), _) => format!("the model `{name}` is not solved, or could not be generated"),
        _ if seen == 0 => "nothing is solved".to_string(),
        _ => "the model could not be generated".to_string(),
    };
    let end = m.options.at.get();
    let label = if end == Span::default() {
        ""
    } else {
        "the run ends here"
    };
    let d = Diagnostic::execution("E0430", end, message)
        .label(label)
        .help("a derivation needs a solve: it says what is minimised and which data hold");
    Err(Box::new(d))
}

/// The model of the solve that a run was asked to look at; None where there was none.
pub fn primal(m: &mut Machine) -> Option<(Primal, Studied)> {
    let (studied, generated) = m.take_study()?;
    let generated = generated?;
    let owner = |t| m.table_owner(t);
    let mut lowering = Lowering::new(&m.symbols, &owner);
    let mut equations: Vec<Equation> = studied
        .code
        .equations
        .iter()
        .map(|r| lowering.equation(&m.equations[r.definition]))
        .collect();
    let mut indices: Indices = lowering.indices;
    for &(v, set) in &studied.code.limits {
        // The model has the variable in this set only.
        let limited = |e| match e {
            Expr::Variable(Variable::Own(s), key) if s == v => {
                let inside = Expr::Member(set, key.clone());
                Some(guarded(Expr::Variable(Variable::Own(s), key), vec![inside]))
            }
            e => Some(e),
        };
        let change = |e: &Expr| e.map(&mut { limited }, &mut |p| Some(p.clone()));
        for e in &mut equations {
            e.left = change(&e.left).unwrap_or(Expr::Number(0.0));
            e.right = change(&e.right).unwrap_or(Expr::Number(0.0));
        }
    }
    for e in &mut equations {
        // Where a lead in its name leaves the set an equation has no row.
        for p in &e.key {
            if let Part::Lag(l) = p
                && !l.circular
            {
                let inside = Expr::Member(m.symbols.root(l.set), vec![p.clone()]);
                e.binder.conditions.push(inside);
            }
        }
    }
    let tuples = studied.code.equations.iter();
    let mut tuples: Vec<usize> = tuples.map(|r| m.tuple_count(r.definition)).collect();
    let mut by_instance = Vec::new();
    for (e, tuples) in equations.iter_mut().zip(&mut tuples) {
        if let Some(why) = dark(e) {
            by_instance.push(format!("{}: {why}", m.symbols.get(e.symbol).name));
            *e = by_rows(&m.symbols, &generated, e, &mut indices);
            if !e.key.is_empty() {
                // Not all tuples are rows.
                *tuples = usize::MAX;
            }
        }
    }
    let answer = studied.answer.as_ref().map(|(origin, a)| {
        let columns = |v: &[f64]| moved(&origin.columns, v, &generated.origin.columns);
        let rows = |v: &[f64]| moved(&origin.rows, v, &generated.origin.rows);
        Values {
            level: columns(&a.outcome.level),
            column_marginal: columns(&a.outcome.column_marginal),
            activity: rows(&a.activity),
            row_marginal: rows(&a.outcome.row_marginal),
        }
    });
    let primal = Primal {
        name: m.symbols.get(studied.code.model).name.to_string(),
        using: studied.code.using.to_string(),
        objective: studied.code.objective,
        equations,
        tuples,
        indices,
        by_instance,
        generated,
        answer,
    };
    Some((primal, studied))
}

/// Why an equation cannot be written in symbols, if it cannot.
fn dark(e: &Equation) -> Option<&'static str> {
    let key = Expr::Member(UNIVERSE, e.key.clone());
    let all = e.binder.conditions.iter().chain([&e.left, &e.right, &key]);
    all.filter_map(Expr::opaque).next()
}

/// An equation by its rows as they were generated, each under the condition that its labels are meant.
fn by_rows(symbols: &Symbols, g: &Generated, e: &Equation, indices: &mut Indices) -> Equation {
    let domain = domain_of(symbols, e.symbol);
    let running: Vec<IndexId> = domain.iter().map(|s| indices.add(*s)).collect();
    let key: Vec<Part> = running.iter().map(|k| Part::Index(*k)).collect();
    let (mut left, mut right) = (Vec::new(), Vec::new());
    if let Some(b) = g.origin.rows.symbol(e.symbol) {
        for i in b.start..b.start + b.len {
            let labels = b.key(i).iter().map(|l| Part::Label(*l));
            let same = key.iter().cloned().zip(labels);
            let here: Vec<Expr> = same.map(|(k, l)| Expr::SameAs(k, l)).collect();
            let side = left_side(g, i as usize, &Expr::Number);
            left.push((false, guarded(side, here.clone())));
            let rhs = Expr::Number(g.instance.rows.rhs[i as usize]);
            right.push((false, guarded(rhs, here)));
        }
    }
    Equation {
        binder: Binder {
            indices: running,
            conditions: Vec::new(),
        },
        key,
        left: sum(left),
        right: sum(right),
        ..e.clone()
    }
}

/// Values by the rows or columns of another instance of the model; 0 where there was none.
fn moved(from: &Blocks, values: &[f64], to: &Blocks) -> Vec<f64> {
    let mut out = Vec::new();
    for b in &to.list {
        let old = from.symbol(b.symbol);
        for i in b.start..b.start + b.len {
            let at = old.and_then(|o| o.find(b.key(i)));
            let value = at.and_then(|at| values.get(at as usize));
            out.push(value.copied().unwrap_or(0.0));
        }
    }
    out
}
