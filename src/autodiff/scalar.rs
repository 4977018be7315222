//! One term, one node at a time: to say what failed where the programs only know that something did.

use super::blocks::Block;
use super::evaluator::{EvalFailure, overflow};
use super::functions::{
    self as fun, DomainError, ErrorKind, Operation, divide, real_power, whole_power,
};
use super::graph::{Element, Graph, Id};
use super::partials::{partials, power_partials};

/// The failure among the terms from `first` on. `order` is 0 for values, 1 and 2 for derivatives.
pub(super) fn diagnose(block: &Block, first: usize, x: &[f64], order: u8) -> EvalFailure {
    let last = (first + 64).min(block.terms());
    for t in first..last {
        let row = block.row[t];
        if let Err((error, culprit)) = evaluate(block, t, x, order) {
            let column = culprit.and_then(|id| match block.graph.elements[id as usize] {
                Element::Var(slot) => Some(block.column(slot, t)),
                _ => None,
            });
            return EvalFailure { row, column, error };
        }
    }
    // every function was fine: a product or a sum left the range of numbers
    for t in first..last {
        if !evaluate(block, t, x, order).is_ok_and(f64::is_finite) {
            return overflow(block.row[t]);
        }
    }
    overflow(block.row[first])
}

/// A value, or what failed and the operand to blame.
type Value = Result<f64, (DomainError, Option<Id>)>;

/// Value of a term without its coefficient; the derivatives of its functions are tried, too.
fn evaluate(block: &Block, t: usize, x: &[f64], order: u8) -> Value {
    let graph = &block.graph;
    let mut value = Vec::with_capacity(graph.elements.len());
    for (id, e) in graph.elements.iter().enumerate() {
        let order = if graph.active[id] { order } else { 0 };
        let v = match e {
            Element::Var(k) => x[block.column(*k, t) as usize],
            Element::Const(k) => block.constant(*k, t),
            _ => node(graph, e, &value, order)?,
        };
        value.push(v);
    }
    Ok(value[graph.root as usize])
}

fn node(graph: &Graph, e: &Element, value: &[f64], order: u8) -> Value {
    let v = |id: Id| value[id as usize];
    let blame = |operands: &[Id], e: DomainError| {
        let culprit = operands.get(usize::from(e.culprit)).copied();
        (e, culprit)
    };
    match e {
        Element::Var(_) | Element::Const(_) => Ok(f64::NAN),
        Element::Number(x) => Ok(*x),
        Element::Linear { constant, terms } => Ok(terms
            .iter()
            .fold(v(*constant), |s, &(c, n)| s + v(c) * v(n))),
        &Element::Add(a, b) => Ok(v(a) + v(b)),
        &Element::Multiply(a, b) => Ok(v(a) * v(b)),
        &Element::Divide(a, b) => divide(v(a), v(b)).map_err(|e| blame(&[a, b], e)),
        &Element::PowerInt(a, n) => whole_power(v(a), n).map_err(|e| blame(&[a], e)),
        &Element::Power(a, b) => {
            let (x, y) = (v(a), v(b));
            let p = real_power(x, y).map_err(|e| blame(&[a, b], e))?;
            if order > 0 {
                let active = [graph.active[a as usize], graph.active[b as usize]];
                let (mut g, mut h) = ([0.0; 2], [0.0; 3]);
                let h = if order > 1 { &mut h[..] } else { &mut [] };
                power_partials(x, y, p, &active, &mut g, h);
                let wanted = |i: usize, d: f64| active[i] && !d.is_finite();
                let failed = wanted(0, g[0])
                    || wanted(1, g[1])
                    || (order > 1 && (wanted(0, h[0]) || wanted(1, h[2])))
                    || (order > 1 && active[0] && wanted(1, h[1]));
                if failed {
                    let kind = ErrorKind::Derivative;
                    let e = DomainError::new(Operation::Power, &[x, y], 0, kind);
                    return Err(blame(&[a, b], e));
                }
            }
            Ok(p)
        }
        Element::Call(f, args) => {
            let numbers: Vec<f64> = args.iter().map(|&a| v(a)).collect();
            let result = if order == 0 {
                fun::function_value(*f, &numbers)
            } else {
                let n = numbers.len();
                let active: Vec<bool> = args.iter().map(|&a| graph.active[a as usize]).collect();
                let mut g = vec![0.0; n];
                let mut h = vec![0.0; if order > 1 { n * (n + 1) / 2 } else { 0 }];
                partials(*f, &numbers, &active, &mut g, &mut h)
            };
            result.map_err(|e| blame(args, e))
        }
    }
}
