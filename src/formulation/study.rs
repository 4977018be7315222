//! From a run to a primal with formulas and numbers.

use super::derive::{Primal, Values, domain_of};
use super::lower::{Equation, Lowering};
use super::numbers::left_side;
use super::tree::{Binder, Expr, IndexId, Indices, Part, Variable, guarded, sum};
use crate::autodiff::Evaluator;
use crate::check::symbols::{Symbols, UNIVERSE};
use crate::diag::Diagnostic;
use crate::model::origin::{Blocks, Origin};
use crate::run::{Generated, Machine, Studied};
use crate::solve::answer::Answer;
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
    let label = match end == Span::default() {
        true => "",
        false => "the run ends here",
    };
    Diagnostic::execution("E0430", end)
        .says(message)
        .label(label)
        .help("a derivation needs a solve: it says what is minimised and which data hold")
        .refuse()
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
                guarded(Expr::Variable(Variable::Own(s), key), vec![inside])
            }
            e => e,
        };
        for e in &mut equations {
            (e.left, e.right) = (e.left.map_nodes(&limited), e.right.map_nodes(&limited));
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
    let answer = studied.answer.as_ref();
    let answer = answer.map(|(origin, a)| values(&generated, origin, a));
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

/// The answer of a solve by the rows and columns of the whole instance, of which the solve may have held some fixed
/// (`holdFixed`): activities and reduced costs are then those of the whole.
fn values(g: &Generated, origin: &Origin, a: &Answer) -> Values {
    let p = &g.instance;
    let columns = |v: &[f64]| moved(&origin.columns, v, &g.origin.columns);
    let rows = |v: &[f64]| moved(&origin.rows, v, &g.origin.rows);
    let plain = |v: Vec<Option<f64>>| v.into_iter().map(|x| x.unwrap_or(0.0)).collect();
    let levels = columns(&a.outcome.level);
    let held: Vec<usize> = (0..levels.len()).filter(|&j| levels[j].is_none()).collect();
    let fixed = p.columns.lower.iter().map(|x| x.max(f64::MIN));
    let mut out = Values {
        level: levels
            .iter()
            .zip(fixed)
            .map(|(x, lo)| x.unwrap_or(lo))
            .collect(),
        column_marginal: plain(columns(&a.outcome.column_marginal)),
        activity: plain(rows(&a.activity)),
        row_marginal: plain(rows(&a.outcome.row_marginal)),
    };
    if held.is_empty() {
        return out;
    }
    let mut e = Evaluator::new(p);
    let mut activity = vec![0.0; p.row_count()];
    if e.rows(&out.level, &mut activity).is_ok() {
        out.activity = activity;
    }
    let z = p.objective.map(|o| o.column as usize);
    if z.is_some()
        && let Ok(slope) = e.jacobian_rows(&out.level)
    {
        let mut reduced = vec![0.0; p.column_count()];
        for (row, y) in slope.iter().zip(&out.row_marginal) {
            row.iter().for_each(|(j, a)| reduced[*j] -= y * a);
        }
        held.iter()
            .for_each(|&j| out.column_marginal[j] = reduced[j]);
    }
    out
}

/// Values by the rows or columns of another instance of the model; None where there was none.
fn moved(from: &Blocks, values: &[f64], to: &Blocks) -> Vec<Option<f64>> {
    let mut out = Vec::new();
    for b in &to.list {
        let old = from.symbol(b.symbol);
        for i in b.start..b.start + b.len {
            let at = old.and_then(|o| o.find(b.key(i)));
            out.push(at.and_then(|at| values.get(at as usize)).copied());
        }
    }
    out
}
