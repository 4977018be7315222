//! Every backend on every problem type that it supports, and with budgets that end at their n-th question.

use bmod::autodiff::Evaluator;
use bmod::model::instance::Instance;
use bmod::model::problem_type::ProblemType;
use bmod::solve::answer::{Answer, answer_with};
use bmod::solve::backend::{Backend, Task};
use bmod::solve::certificate::nonlinear::linearise;
use bmod::solve::certificate::{self, Residuals, TOLERANCE};
use bmod::solve::registry::BACKENDS;
use bmod::solve::{Budget, Limits, ModelStatus, Monitor, Quiet, Settings, SolverStatus};

use crate::common::instances;

/// A model text, and the objective that its solutions have.
const MODELS: &[(&str, Option<f64>)] = &[
    (
        "positive variables x, y; variable z; equations c1, c2, obj;
         c1.. x + 2*y =l= 8;  c2.. 3*x + y =l= 9;  obj.. z =e= 2*x + 3*y;
         model m / all /; solve m using lp maximizing z;",
        Some(13.0),
    ),
    (
        "set i / i1*i40 /; alias (i,j); positive variable x(i); variable z; equations c(j), obj;
         c(j).. sum(i, (1 + mod(ord(i)*ord(j), 7)) * x(i)) =g= 10 + ord(j);
         obj.. z =e= sum(i, (1 + mod(3*ord(i), 11)) * x(i));
         model m / all /; solve m using lp minimizing z;",
        None,
    ),
    (
        "set i / a*h /; binary variable x(i); variable z; equations c, d, obj;
         c.. sum(i, (3 + mod(5*ord(i), 7))*x(i)) =l= 21;  d.. sum(i, x(i)) =g= 2;
         obj.. z =e= sum(i, (4 + mod(3*ord(i), 5))*x(i));
         model m / all /; solve m using mip maximizing z;",
        None,
    ),
    (
        "set i /1*3/; binary variable x(i); variable z; equations c, obj;
         c.. sum(i, (1 + ord(i))*x(i)) =l= 4;  obj.. z =e= sum(i, (3 + ord(i))*x(i));
         model m / all /; solve m using rmip maximizing z;",
        Some(22.0 / 3.0),
    ),
    (
        "set i /1*3/; sos1 variable s(i); semicont variable q; variable z; equations c, obj;
         s.up(i) = 3; q.lo = 2; q.up = 5;  c.. sum(i, s(i)) =l= q + 0.5;  obj.. z =e= sum(i, ord(i)*s(i)) - q;
         model m / all /; m.optcr = 0; solve m using mip maximizing z;",
        Some(6.5),
    ),
    (
        "integer variables x, y; variable z; equation obj; x.up = 5; y.up = 5;
         obj.. z =e= sqr(x - 1.3) + sqr(y - 2.2);
         model m / all /; solve m using miqcp minimizing z;",
        Some(0.13),
    ),
    (
        "binary variable b; positive variable x; variable z; equations c, obj; x.up = 2;
         c.. x =l= 1.5*b;  obj.. z =e= exp(x) - 3*x + 0.1*b;
         model m / all /; solve m using minlp minimizing z;",
        Some(-0.195836866),
    ),
    (
        "set i /1*2/; positive variable x(i); integer variable n; variable z; n.up = 3; equations o, need, a(i);
         a(i).. x(i) =g= n - 0.5;  need.. n =g= 0.3;  o.. z =e= sum(i, x(i)) + 2*n;
         model m / o, need, a.x /; solve m using mpec minimizing z;",
        Some(3.0),
    ),
    (
        "variables x1, x2, x3, x4, z; equations c1, c2, obj;
         x1.lo = 1; x1.up = 5; x2.lo = 1; x2.up = 5; x3.lo = 1; x3.up = 5; x4.lo = 1; x4.up = 5;
         x1.l = 1; x2.l = 5; x3.l = 5; x4.l = 1;
         c1.. x1*x2*x3*x4 =g= 25;  c2.. sqr(x1) + sqr(x2) + sqr(x3) + sqr(x4) =e= 40;
         obj.. z =e= x1*x4*(x1 + x2 + x3) + x3;
         model m / all /; solve m using nlp minimizing z;",
        Some(17.0140173),
    ),
    (
        "variables x, y, z; equations c, obj;  x.l = -1.2; y.l = 1;
         c.. x + y =l= 1.5;  obj.. z =e= 100*sqr(y - sqr(x)) + sqr(1 - x);
         model m / all /; solve m using nlp minimizing z;",
        None,
    ),
    (
        "positive variables x, y; variable z; equations c, obj;
         c.. x + y =g= 2;  obj.. z =e= sqr(x) + 2*sqr(y) + x;
         model m / all /; solve m using qcp minimizing z;",
        Some(141.0 / 36.0),
    ),
    (
        "variables x, y, z; equations c, obj;  x.up = 4;
         c.. x + y =e= 3;  obj.. z =e= abs(x - 1) + sqr(y);
         model m / all /; solve m using dnlp minimizing z;",
        Some(1.75),
    ),
    (
        "positive variables x, y; equations f, g;
         f.. 2*x + y =g= 3;  g.. sqr(y) + x =g= 2;
         model m / f.x, g.y /; solve m using mcp;",
        None,
    ),
    (
        "variables x, y; equations f, g; x.l = 1; y.l = 2;
         f.. sqr(x) + sqr(y) =e= 5;  g.. x*y =e= 2;
         model m / all /; solve m using cns;",
        None,
    ),
    (
        "positive variables x, y, s; variable z; equations f, obj, c;
         f.. y + s - x + 1 =g= 0;  c.. x + y =g= 2;  obj.. z =e= sqr(x - 3) + sqr(y - 1) + s;
         model m / obj, c, f.s /; s.up = 10; solve m using mpec minimizing z;",
        None,
    ),
    (
        "positive variables x, y; variable z; equations f, obj, c;
         f.. x + y =g= 1;  c.. x + 2*y =l= 3;  obj.. z =e= x - 2*y;
         model m / obj, c, f.y /; solve m using mpec minimizing z;",
        None,
    ),
];

/// What an answer must be, however its solve ended.
fn well_formed(using: ProblemType, instance: &Instance, a: &Answer, what: &str) {
    let (m, n) = (instance.row_count(), instance.column_count());
    assert_eq!(a.outcome.level.len(), n, "{what}");
    assert_eq!(a.outcome.column_marginal.len(), n, "{what}");
    assert_eq!(a.outcome.row_marginal.len(), m, "{what}");
    assert_eq!(a.activity.len(), m, "{what}");
    let claims_feasible = a.status.has_solution();
    if claims_feasible {
        let violation = violation(using, instance, &a.outcome.level);
        assert!(
            violation <= TOLERANCE,
            "{what}: {:?} at {violation:e}",
            a.status
        );
    }
}

/// Residuals at a point, computed anew.
fn residuals(using: ProblemType, instance: &Instance, x: &[f64]) -> Option<Residuals> {
    let none = vec![0.0; instance.row_count()];
    let at = linearise(instance, &mut Evaluator::new(instance), x, &none).ok()?;
    Some(match using.has_pairs() {
        true => certificate::complementarity(instance, x, &at),
        false => certificate::primal(instance, x, &at.activity, &at.row_size),
    })
}

/// The relative violation at a point; of models with pairs the natural residual.
fn violation(using: ProblemType, instance: &Instance, x: &[f64]) -> f64 {
    match residuals(using, instance, x) {
        Some(r) if using.has_pairs() => r.natural_relative,
        Some(r) => r.primal_relative,
        None => f64::INFINITY,
    }
}

/// What is checked of a backend: a task, its optimum where there is one, and its name.
type Check<'a> = dyn FnMut(&'static dyn Backend, &Task, Option<f64>, &str) + 'a;

/// Calls `check` with every backend and every model that it takes.
fn each(check: &mut Check) {
    for (k, (text, value)) in MODELS.iter().enumerate() {
        for (using, instance) in instances(text) {
            let task = Task::new(using, &instance);
            let mut taken = 0;
            for &backend in BACKENDS {
                if backend.takes(&task) {
                    taken += 1;
                    let what = format!("{} on model {k} using {using}", backend.about().name);
                    let named = task.by(Some(backend.about().name));
                    check(backend, &named, *value, &what);
                }
            }
            assert!(taken > 0, "no backend takes model {k} using {using}");
        }
    }
}

/// Whether this is an end: of integers with pairs or curves the best found is all there is.
fn is_solved(task: &Task, a: &Answer) -> bool {
    let local = task.has_integers() && (task.has_pairs() || !task.instance.is_linear());
    a.status.is_solution() || local && a.status == ModelStatus::IntegerSolution
}

#[test]
fn every_backend_solves_what_it_supports() {
    each(&mut |backend, task, value, what| {
        let mut quiet = Quiet::default();
        let budget = Budget::unlimited(&mut quiet);
        let a = answer_with(&[backend], task, &Settings::default(), &budget);
        let a = a.unwrap_or_else(|e| panic!("{what}: {}", e.message));
        well_formed(task.using, task.instance, &a, what);
        assert!(is_solved(task, &a), "{what}: {:?}", a.status);
        assert_eq!(a.outcome.status, SolverStatus::NormalCompletion, "{what}");
        if let (Some(v), Some(o)) = (value, task.instance.objective) {
            let z = a.outcome.level[o.column as usize];
            assert!(
                (z - v).abs() <= 1e-6 * v.abs().max(1.0),
                "{what}: {z} for {v}"
            );
        }
    });
}

/// Interrupts at the n-th question.
struct Faulty(usize);

impl Monitor for Faulty {
    fn log(&mut self, _: &str) {}
    fn interrupted(&mut self) -> bool {
        self.0 = self.0.saturating_sub(1);
        self.0 == 0
    }
    fn seconds(&mut self) -> f64 {
        0.0
    }
}

/// What an answer is worth: feasible ones by their objective, others by nothing; of systems the residual that methods reduce.
fn worth(task: &Task, a: &Answer) -> f64 {
    let x = &a.outcome.level;
    match task.instance.objective {
        Some(_) if violation(task.using, task.instance, x) > TOLERANCE => f64::INFINITY,
        Some(o) => task.instance.sign() * x[o.column as usize],
        None => {
            let r = residuals(task.using, task.instance, x);
            r.and_then(|r| r.natural.or(r.primal))
                .unwrap_or(f64::INFINITY)
        }
    }
}

/// Whoever is stopped returns at least what it would have returned if it had been stopped before.
#[test]
fn a_stop_loses_nothing() {
    stopped_everywhere(&|using| !using.has_pairs() || !using.has_objective());
}

#[test]
fn a_stop_loses_nothing_of_an_mpec() {
    stopped_everywhere(&|using| using.has_pairs() && using.has_objective());
}

fn stopped_everywhere(wanted: &dyn Fn(ProblemType) -> bool) {
    let mut lost = Vec::new();
    each(&mut |backend, task, _, what| {
        if !wanted(task.using) {
            return;
        }
        let mut best = f64::INFINITY;
        for n in 1..120 {
            let mut faulty = Faulty(n);
            let budget = Budget::new(&mut faulty, Limits::default(), false);
            let Ok(a) = answer_with(&[backend], task, &Settings::default(), &budget) else {
                continue;
            };
            let stopped = budget.stopped().is_some();
            let what = format!("{what}, stopped at question {n}");
            well_formed(task.using, task.instance, &a, &what);
            if stopped && !is_solved(task, &a) {
                assert_eq!(a.outcome.status, SolverStatus::UserInterrupt, "{what}");
            }
            let now = worth(task, &a);
            if now > best + 1e-6 * best.abs().max(1.0) {
                lost.push(format!("{what}: {now} after {best}"));
            }
            best = best.min(now);
            if !stopped {
                break;
            }
        }
    });
    assert!(lost.is_empty(), "{}", lost.join("\n"));
}
