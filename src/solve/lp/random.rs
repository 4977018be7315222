//! Random linear programs: the ways agree, the certificate confirms, the order of rows and
//! columns does not matter.

use proptest::prelude::*;

use super::certify;
use crate::model::instance::{Instance, Relation, Sense};
use crate::model::problem_type::ProblemType;
use crate::solve::Budget;
use crate::solve::answer::subproblem;
use crate::solve::backend::Task;
use crate::solve::certificate;
use crate::solve::conformance::{Quiet, Row, linear};
use crate::solve::{Claim, ModelStatus, Outcome, Settings};

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
}
