//! Infeasible for certain: a linear relaxation has no solution.
//!
//! A nonlinear solver sees one neighbourhood, and says at best that nothing near its last point is feasible. Where the
//! linear rows and the bounds contradict each other, or keep a nonlinear term from the values it would need, there is a proof: the sum
//! of the nonlinear terms of a row becomes a column of its own, between the numbers that interval arithmetic over the
//! bounds of the variables gives; if this linear program is infeasible (by multipliers that are checked), so is the program.

use crate::model::instance::{Function, Instance, KernelTerms, Op, Relation};
use crate::model::problem_type::ProblemType;
use crate::solve::answer::subproblem;
use crate::solve::backend::Task;
use crate::solve::certificate::proves_infeasible;
use crate::solve::interval::Interval;
use crate::solve::{Budget, Claim, Settings};

/// What a function value may be off by, relative to its size.
const ROUNDING: f64 = 1e-14;

/// Whether the linear relaxation is infeasible.
pub fn is_infeasible(instance: &Instance, budget: &Budget) -> bool {
    let relaxed = relax(instance);
    let task = Task::new(ProblemType::Lp, &relaxed);
    let answer = budget.aside(|budget| subproblem(&task, &Settings::default(), budget));
    answer.is_ok_and(|a| {
        a.outcome.claim == Claim::Infeasible && proves_infeasible(&relaxed, &a.outcome.ray)
    })
}

/// The relaxation, without an objective.
fn relax(instance: &Instance) -> Instance {
    let columns = &instance.columns;
    let mut sums: Vec<Option<Interval>> = vec![None; instance.row_count()];
    for terms in &instance.nonlinear {
        for t in terms.terms() {
            let place = |&j: &u32| Interval {
                low: columns.lower[j as usize],
                high: columns.upper[j as usize],
            };
            let at: Vec<Interval> = t.columns.iter().map(place).collect();
            let value = range(terms, &at, t.constants) * t.coef;
            let sum = &mut sums[t.row];
            *sum = Some(sum.map_or(value, |s| s + value));
        }
    }
    let mut relaxed = Instance {
        columns: columns.clone(),
        ..Instance::default()
    };
    for (i, sum) in sums.into_iter().enumerate() {
        let mut relation = instance.rows.relation[i];
        let value = sum.map(|Interval { low, high }| {
            if low == f64::NEG_INFINITY && high == f64::INFINITY {
                relation = Relation::Free;
            }
            (relaxed.columns.push(low, high), 1.0)
        });
        let row = instance.matrix.row(i).chain(value);
        relaxed.add_row(row, relation, instance.rows.rhs[i]);
    }
    relaxed
}

/// Bounds of a term over bounds of its variables.
fn range(terms: &KernelTerms, at: &[Interval], constants: &[f64]) -> Interval {
    let mut stack: Vec<Interval> = Vec::new();
    for op in &terms.kernel.ops {
        let a = stack.split_off(stack.len().saturating_sub(op.arguments()));
        stack.push(operation(*op, &a, at, constants));
    }
    stack.pop().unwrap_or(Interval::ALL)
}

/// Bounds of an operation over bounds of its arguments and of the variables.
pub(super) fn operation(op: Op, a: &[Interval], at: &[Interval], constants: &[f64]) -> Interval {
    let value = match (op, a) {
        (Op::Const(k), _) => Interval::point(constants[k as usize]),
        (Op::Var(v), _) => at[v as usize],
        (Op::Affine(constant, variable, terms), _) => {
            let (c, v) = (constant as usize, variable as usize);
            let each = (0..terms as usize).map(|m| at[v + m] * constants[c + 1 + m]);
            each.fold(Interval::point(constants[c]), |s, t| s + t)
        }
        (Op::Add(_), a) => a.iter().fold(Interval::point(0.0), |s, &t| s + t),
        (Op::Multiply(_), a) => a.iter().fold(Interval::point(1.0), |s, &t| s * t),
        (Op::Negate, &[a]) => -a,
        (Op::PowerInt(k), &[a]) => power(a, k),
        (Op::Divide, &[a, b]) => a * power(b, -1),
        (Op::Power | Op::Call(Function::RPower | Function::VcPower, _), &[a, b])
            if b.low == b.high =>
        {
            real_power(a, b.low)
        }
        (Op::Call(f, _), &[a]) => function(f, a),
        _ => Interval::ALL,
    };
    match value.low.is_nan() || value.high.is_nan() {
        true => Interval::ALL,
        false => value,
    }
}

/// From the one value to the other, and what rounding may have taken off.
fn between(low: f64, high: f64) -> Interval {
    Interval {
        low: low - ROUNDING * low.abs(),
        high: high + ROUNDING * high.abs(),
    }
}

/// a to a whole power.
fn power(a: Interval, k: i32) -> Interval {
    let contains_zero = a.low <= 0.0 && a.high >= 0.0;
    let at = |x: f64| x.powi(k);
    match (k, k % 2 == 0) {
        (0, _) => Interval::point(1.0),
        (..0, _) if contains_zero => Interval::ALL,
        // the error grows with the exponent
        (_, false) if k.abs() > 100 => Interval::ALL,
        (_, true) if k.abs() > 100 => between(0.0, f64::INFINITY),
        (0.., true) if contains_zero => Interval {
            low: 0.0,
            ..between(0.0, at(a.magnitude()))
        },
        _ => {
            let ends = [at(a.low), at(a.high)];
            between(ends[0].min(ends[1]), ends[0].max(ends[1]))
        }
    }
}

/// a to a real power, for a ≥ 0.
fn real_power(a: Interval, p: f64) -> Interval {
    if a.high < 0.0 {
        return Interval::ALL;
    }
    let ends = [a.low.max(0.0).powf(p), a.high.powf(p)];
    Interval {
        low: between(ends[0].min(ends[1]), 0.0).low.max(0.0),
        high: between(0.0, ends[0].max(ends[1])).high,
    }
}

/// Functions whose range is simple.
fn function(f: Function, a: Interval) -> Interval {
    let unit = Interval::around_zero(1.0);
    match f {
        Function::Exp => Interval {
            low: between(a.low.exp(), 0.0).low.max(0.0),
            high: between(0.0, a.high.exp()).high,
        },
        Function::Log if a.high > 0.0 => between(a.low.max(0.0).ln(), a.high.ln()),
        Function::Sqrt => real_power(a, 0.5),
        Function::Sqr => power(a, 2),
        Function::Abs => Interval {
            low: a.low.max(-a.high).max(0.0),
            high: a.magnitude(),
        },
        Function::Sin | Function::Cos => unit,
        _ => Interval::ALL,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_every_value() {
        let samples = [-3.0, -1.5, -0.25, 0.0, 0.5, 1.0, 2.0, 7.0];
        for low in samples {
            for high in samples.into_iter().filter(|h| *h >= low) {
                let a = Interval { low, high };
                for step in 0..=10 {
                    let x = (low + (high - low) * f64::from(step) / 10.0).min(high);
                    let holds = |r: Interval, v: f64| v.is_nan() || r.low <= v && v <= r.high;
                    for k in [-3, -2, -1, 0, 1, 2, 3, 4] {
                        let v = x.powi(k);
                        assert!(!v.is_finite() || holds(power(a, k), v), "{a:?} {x} {k}");
                    }
                    for p in [-0.5, 0.5, 1.7] {
                        let v = x.powf(p);
                        assert!(
                            !v.is_finite() || holds(real_power(a, p), v),
                            "{a:?} {x} {p}"
                        );
                    }
                    let values = [
                        (Function::Exp, x.exp()),
                        (Function::Log, x.ln()),
                        (Function::Abs, x.abs()),
                        (Function::Cos, x.cos()),
                    ];
                    for (f, v) in values {
                        assert!(
                            !v.is_finite() || holds(function(f, a), v),
                            "{f:?} {a:?} {x}"
                        );
                    }
                }
            }
        }
    }
}
