//! Random linear programs: the ways agree, the certificate confirms, the order of rows and
//! columns does not matter.

use proptest::prelude::*;

use super::form::Form;
use super::presolve::presolve;
use super::simplex::{Simplex, State};
use super::{Ended, certify};
use crate::model::instance::{Instance, Relation, Sense};
use crate::model::problem_type::ProblemType;
use crate::solve::Budget;
use crate::solve::answer::subproblem;
use crate::solve::backend::Task;
use crate::solve::certificate;
use crate::solve::dense::{Row, linear};
use crate::solve::range::{CostRange, Ranges, ranges};
use crate::solve::{Claim, ModelStatus, Outcome, Quiet, Settings};

/// What a random program is made of.
#[derive(Clone, Debug)]
struct Parts {
    sense: Sense,
    cost: Vec<f64>,
    bounds: Vec<(f64, f64)>,
    rows: Vec<Row>,
}

/// Small whole numbers, mostly zeros: degenerate, infeasible and unbounded programs are common.
fn parts() -> impl Strategy<Value = Parts> {
    let entry = prop_oneof![3 => Just(0.0), 2 => (-4i32..=4).prop_map(f64::from)];
    let bounds = prop_oneof![
        Just((0.0, f64::INFINITY)),
        Just((f64::NEG_INFINITY, f64::INFINITY)),
        Just((f64::NEG_INFINITY, 0.0)),
        (-3i32..=3, 0i32..=3).prop_map(|(l, w)| (f64::from(l), f64::from(l + w))),
    ];
    let relation = prop_oneof![
        Just(Relation::Less),
        Just(Relation::Greater),
        Just(Relation::Equal)
    ];
    (1usize..7, 0usize..7).prop_flat_map(move |(n, m)| {
        let row = (
            prop::collection::vec(entry.clone(), n),
            relation.clone(),
            (-6i32..=6).prop_map(f64::from),
        );
        (
            any::<bool>(),
            prop::collection::vec((-4i32..=4).prop_map(f64::from), n),
            prop::collection::vec(bounds.clone(), n),
            prop::collection::vec(row, m),
        )
            .prop_map(|(min, cost, bounds, rows)| Parts {
                sense: if min {
                    Sense::Minimize
                } else {
                    Sense::Maximize
                },
                cost,
                bounds,
                rows,
            })
    })
}

impl Parts {
    fn instance(&self) -> Instance {
        linear(self.sense, &self.cost, &self.bounds, &self.rows)
    }
}

fn run(method: &str, instance: &Instance) -> (ModelStatus, Outcome) {
    let mut settings = Settings::default();
    settings.options.push(("method".into(), method.into()));
    let mut quiet = Quiet::default();
    let budget = Budget::unlimited(&mut quiet);
    let a = subproblem(&Task::new(ProblemType::Lp, instance), &settings, &budget);
    let a = a.expect("a valid instance");
    (a.status, a.outcome)
}

fn value(o: &Outcome) -> f64 {
    *o.level.last().expect("an objective")
}

/// Ranges of an optimal program, if it is one, and its value.
fn ranged(p: &Parts) -> Option<(Ranges, Outcome)> {
    let instance = p.instance();
    let (status, o) = run("simplex", &instance);
    let dot = |i| instance.matrix.row(i).map(|(j, a)| a * o.level[j]).sum();
    let activity: Vec<f64> = (0..instance.row_count()).map(dot).collect();
    let found = || {
        ranges(
            &instance,
            &o.level,
            &activity,
            &|_| true,
            &|_| true,
            &|| true,
        )
    };
    (status == ModelStatus::Optimal).then(|| (found(), o.clone()))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn every_way_gives_the_same(p in parts()) {
        let instance = p.instance();
        let (status, o) = run("simplex", &instance);
        let decided = [ModelStatus::Optimal, ModelStatus::Infeasible, ModelStatus::Unbounded];
        prop_assert!(decided.contains(&status), "{status:?} {o:?}");
        let (other, q) = run("crossover", &instance);
        if status == ModelStatus::Optimal {
            prop_assert_eq!(other, status);
            prop_assert!((value(&o) - value(&q)).abs() <= 1e-9, "{:?} {:?}", o, q);
        } else {
            // A program may be infeasible and have an unbounded direction as well.
            prop_assert!(other != ModelStatus::Optimal, "{:?} {:?}", o, q);
        }
        // At a vertex with whole data nothing is off by more than rounding.
        if status == ModelStatus::Optimal {
            let r = certificate::linear(&instance, &o);
            prop_assert!(r.primal.expect("there") <= 1e-12, "{r:?}");
            prop_assert!(r.dual.expect("there") <= 1e-12, "{r:?}");
        }
    }

    #[test]
    fn order_does_not_matter(p in parts(), seed in any::<u64>()) {
        let n = p.cost.len();
        let mut order: Vec<usize> = (0..n).collect();
        let mut state = seed | 1;
        for k in (1..n).rev() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            order.swap(k, (state >> 33) as usize % (k + 1));
        }
        let mut q = p.clone();
        q.cost = order.iter().map(|&j| p.cost[j]).collect();
        q.bounds = order.iter().map(|&j| p.bounds[j]).collect();
        for row in &mut q.rows {
            row.0 = order.iter().map(|&j| row.0[j]).collect();
        }
        q.rows.reverse();
        let (a, x) = run("auto", &p.instance());
        let (b, y) = run("auto", &q.instance());
        prop_assert_eq!(a, b);
        if a == ModelStatus::Optimal {
            prop_assert!((value(&x) - value(&y)).abs() <= 1e-10);
        }
        prop_assert!(x.claim != Claim::Unfinished);
    }

    /// Exact arithmetic gives the value of every optimal program; intervals hold it, if there are any.
    #[test]
    fn proofs_hold_the_value(p in parts()) {
        let instance = p.instance();
        let (status, o) = run("simplex", &instance);
        let proof = |exact| {
            certify::certify_by(&instance, &o, &Budget::unlimited(&mut Quiet::default()), exact).expect("valid")
        };
        let (exact, wide) = (proof(true), proof(false));
        if status == ModelStatus::Optimal {
            prop_assert!(exact.high - exact.low <= 1e-14 * value(&o).abs(), "{exact:?}");
            prop_assert!((exact.low - value(&o)).abs() <= 1e-9);
            prop_assert!(wide.low <= exact.low && wide.high >= exact.high, "{wide:?} {exact:?}");
        } else {
            let minimise = p.sense == Sense::Minimize;
            let open = |p: &certify::Proof| if minimise { p.low == f64::NEG_INFINITY } else { p.high == f64::INFINITY };
            let shut = |p: &certify::Proof| if minimise { p.high == f64::INFINITY } else { p.low == f64::NEG_INFINITY };
            // Unbounded: no dual bound; infeasible: no point.
            prop_assert!(open(&wide) || shut(&wide), "{wide:?}");
        }
    }

    /// What is left of a program after the presolve has its value, and the way back ends at an optimal basis, or at a proof that there is no point.
    #[test]
    fn smaller_programs_lead_back(p in parts()) {
        let p = Form::new(&p.instance()).expect("valid").problem;
        let Some(reduced) = presolve(&p) else { return Ok(()) };
        if let Some(y) = &reduced.proof {
            prop_assert!(p.proves_infeasible(&reduced.restore_ray(y)));
            return Ok(());
        }
        let [mut direct, mut smaller] = [&p, &reduced.problem].map(Simplex::new);
        let ended = smaller.solve(&mut |_| None);
        if let Ended::Infeasible(y) = &ended {
            prop_assert!(p.proves_infeasible(&reduced.restore_ray(y)));
        }
        prop_assert_eq!(direct.solve(&mut |_| None) == Ended::Solved, ended == Ended::Solved);
        if ended == Ended::Solved {
            let (point, basis) = reduced.restore(&smaller.point().expect("a point"), &smaller.basis());
            prop_assert_eq!(basis.iter().filter(|s| **s == State::Basic).count(), p.m());
            let mut again = Simplex::new(&p);
            prop_assert_eq!(again.solve_from_basis(&basis, &mut |_| None), Ended::Solved);
            prop_assert_eq!(again.iterations, 0);
            let value = |x: &[f64]| p.cost.iter().zip(x).map(|(c, x)| c * x).sum::<f64>();
            let best = value(&direct.point().expect("a point").x);
            prop_assert!((value(&point.x) - best).abs() < 1e-9);
        }
    }

    /// A price holds to the end of its interval and no farther, on either side: the program is solved again there.
    #[test]
    fn prices_are_those_of_solving_again(p in parts()) {
        let Some((r, o)) = ranged(&p) else { return Ok(()) };
        prop_assert!(!r.unfinished);
        // The objective's row is the last.
        prop_assert_eq!(r.rows.iter().filter(|r| r.row < p.rows.len()).count(), r.rows.len());
        for row in &r.rows {
            let moved = |to: f64| {
                let mut q = p.clone();
                q.rows[row.row].2 = to;
                let (status, o) = run("simplex", &q.instance());
                (status == ModelStatus::Optimal).then(|| value(&o))
            };
            for (side, direction) in [-1.0, 1.0].into_iter().enumerate() {
                let (price, end) = (row.price[side], row.interval[side]);
                if price.is_infinite() {
                    prop_assert_eq!(moved(row.value + direction / 16.0), None, "{:?}", row);
                    continue;
                }
                let (near, far) = match end.is_finite() {
                    true => ([(row.value + end) / 2.0, end - direction * 1e-8], Some(end + direction)),
                    false => ([row.value + direction, row.value + 100.0 * direction], None),
                };
                let told = |to: f64| value(&o) + price * (to - row.value);
                for to in near {
                    let at = moved(to);
                    prop_assert!(at.is_some_and(|v| (v - told(to)).abs() <= 1e-6), "{row:?} at {to}: {at:?} for {}", told(to));
                }
                if let Some(to) = far {
                    let beyond = moved(to);
                    prop_assert!(beyond.is_none_or(|v| (v - told(to)).abs() > 1e-6), "{row:?} at {to}: {beyond:?}");
                }
            }
        }
    }

    /// Levels far from 0 move the ends and nothing else: rows that differ by 1e-8 of their size are told apart.
    #[test]
    fn ranges_move_with_the_levels(p in parts(), by in prop::collection::vec(-4i32..=4, 7)) {
        let Some((r, _)) = ranged(&p) else { return Ok(()) };
        let far = |j: usize| 1e5 * f64::from(by[j]);
        let mut q = p.clone();
        for (j, b) in q.bounds.iter_mut().enumerate() {
            *b = (b.0 + far(j), b.1 + far(j));
        }
        let moved = |row: &Row| row.0.iter().enumerate().map(|(j, a)| a * far(j)).sum::<f64>();
        q.rows.iter_mut().for_each(|row| row.2 += moved(row));
        let (there, _) = ranged(&q).expect("optimal as well");
        // what is far is now and then too far from a vertex, which is said
        prop_assume!(!there.unfinished);
        let near = |a: f64, b: f64, by: f64| a == b || (a - b).abs() <= by;
        prop_assert_eq!(there.rows.len(), r.rows.len());
        for (a, b) in r.rows.iter().zip(&there.rows) {
            let far = moved(&p.rows[a.row]);
            for side in 0..2 {
                prop_assert!(near(a.price[side], b.price[side], 1e-6), "{a:?} {b:?}");
                prop_assert!(near(a.interval[side] + far, b.interval[side], 0.1), "{a:?} {b:?}");
            }
        }
        // of several optima, each has its own
        let same = |(a, b): (&CostRange, &CostRange)| (a.level + far(a.column) - b.level).abs() <= 1e-6;
        if !r.costs.iter().zip(&there.costs).all(same) {
            return Ok(());
        }
        for (a, b) in r.costs.iter().zip(&there.costs) {
            let all = a.interval.iter().zip(&b.interval);
            prop_assert!(all.into_iter().all(|(a, b)| near(*a, *b, 1e-6)), "{a:?} {b:?}");
        }
    }

    /// The point stays optimal for costs in their intervals, and for none outside: the program is solved again there.
    #[test]
    fn costs_are_those_of_solving_again(p in parts()) {
        let Some((r, o)) = ranged(&p) else { return Ok(()) };
        prop_assert_eq!(r.costs.len(), p.cost.len());
        for c in &r.costs {
            // How much the program with another cost has over the point.
            let over = |to: f64| {
                let mut q = p.clone();
                q.cost[c.column] = to;
                let (status, best) = run("simplex", &q.instance());
                let at = value(&o) + (to - p.cost[c.column]) * o.level[c.column];
                (status == ModelStatus::Optimal).then(|| (value(&best) - at).abs())
            };
            for (end, direction) in c.interval.into_iter().zip([-1.0, 1.0]) {
                let (inside, outside) = match end.is_finite() {
                    true => (c.value + 0.999 * (end - c.value), Some(end + direction)),
                    false => (c.value + 100.0 * direction, None),
                };
                let best = over(inside);
                prop_assert!(best.is_some_and(|v| v <= 1e-5), "{c:?} at {inside}: {best:?}");
                if let Some(to) = outside {
                    let best = over(to);
                    prop_assert!(best.is_none_or(|v| v > 1e-6), "{c:?} at {to}: {best:?}");
                }
            }
        }
    }
}
