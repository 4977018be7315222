//! Bounds against the global minimum, which enumeration of all pieces finds.

use super::super::pairs::{Piece, Program};
use super::products::{Limits, Products};
use crate::model::instance::{INF, Instance, Relation, Sense};
use crate::model::problem_type::ProblemType;
use crate::solve::answer::{Answer, subproblem};
use crate::solve::backend::Task;
use crate::solve::dense::{self, Row};
use crate::solve::lp::form::Problem;
use crate::solve::{Budget, ModelStatus, Quiet, Settings};

/// Small whole numbers from a fixed seed.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, low: i32, high: i32) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        let span = (high - low + 1) as u64;
        (low + ((self.0 >> 33) % span) as i32) as f64
    }

    fn line(&mut self, n: usize, low: i32, high: i32) -> Vec<f64> {
        (0..n).map(|_| self.roll(low, high)).collect()
    }
}

/// The least value over all branches; None: all are infeasible. An unbounded one makes it −∞.
fn by_enumeration(instance: &Instance) -> Option<f64> {
    let program = Program::new(instance).expect("pairs");
    let mut pieces: Vec<Vec<Piece>> = vec![Vec::new()];
    for pair in &program.pairs {
        let longer = |p: &Vec<Piece>| -> Vec<Vec<Piece>> {
            let all = [Piece::Lower, Piece::Inside, Piece::Upper];
            let allowed = all.iter().filter(|&&c| pair.allows(c));
            allowed.map(|&c| [&p[..], &[c]].concat()).collect()
        };
        pieces = pieces.iter().flat_map(longer).collect();
    }
    let start = vec![0.0; instance.column_count()];
    let mut least: Option<f64> = None;
    for p in pieces {
        let branch = program.branch(&p, &start);
        let mut quiet = Quiet::default();
        let budget = Budget::unlimited(&mut quiet);
        let task = Task::new(ProblemType::Lp, &branch);
        let a = subproblem(&task, &Settings::default(), &budget).expect("linear");
        let value = match a.status {
            ModelStatus::Optimal => program.objective(&a.outcome.level),
            ModelStatus::Unbounded => f64::NEG_INFINITY,
            ModelStatus::Infeasible => continue,
            other => panic!("{other:?}"),
        };
        least = Some(least.map_or(value, |l| l.min(value)));
    }
    least
}

fn solve(instance: &Instance) -> Answer {
    let mut settings = Settings::default();
    settings.options.push(("mpec_bound".into(), "quick".into()));
    let mut quiet = Quiet::default();
    let budget = Budget::unlimited(&mut quiet);
    subproblem(&Task::new(ProblemType::Mpec, instance), &settings, &budget).expect("an answer")
}

/// Whether the gap was closed; None where there is no finite minimum.
fn judge(instance: &Instance, what: &str) -> Option<bool> {
    let truth = by_enumeration(instance);
    let a = solve(instance);
    let Some(truth) = truth else {
        let infeasible = [ModelStatus::Infeasible, ModelStatus::LocallyInfeasible];
        assert!(infeasible.contains(&a.status), "{what}: {:?}", a.status);
        return None;
    };
    if truth.is_infinite() {
        assert_ne!(a.status, ModelStatus::Optimal, "{what}");
        return None;
    }
    let sign = match instance.objective.map(|o| o.sense) {
        Some(Sense::Maximize) => -1.0,
        _ => 1.0,
    };
    if let Some([lo, hi]) = a.bounds {
        let truth = sign * truth;
        let near = 1e-9 * truth.abs().max(1.0);
        let encloses = lo <= truth + near && hi >= truth - near;
        assert!(encloses, "{what}: {truth} in [{lo}, {hi}]");
    }
    if a.status == ModelStatus::Optimal {
        let z = instance.objective.expect("an objective").column as usize;
        let value = sign * a.outcome.level[z];
        let unit = truth.abs().max(1.0);
        assert!(
            (value - truth).abs() <= 2e-6 * unit,
            "{what}: {value}, not {truth}"
        );
        assert!(a.bounds.is_some(), "{what}: optimal without bounds");
    }
    Some(a.status == ModelStatus::Optimal)
}

/// min cᵀx, F(x) = Mx + q ⟂ x, and some rows more.
fn joined(dice: &mut Dice) -> Instance {
    let n = 5;
    let pairs = 4;
    let mut rows: Vec<Row> = Vec::new();
    let mut bounds = Vec::new();
    for k in 0..n {
        let upper = if dice.roll(0, 2) == 0.0 {
            dice.roll(1, 6)
        } else {
            INF
        };
        bounds.push((0.0, upper));
        if k < pairs {
            let mut line = dice.line(n, -2, 2);
            line[k] += 2.0;
            let relation = if upper < INF {
                Relation::Free
            } else {
                Relation::Greater
            };
            rows.push((line, relation, dice.roll(-4, 4)));
        }
    }
    rows.push((dice.line(n, 0, 3), Relation::Less, dice.roll(6, 20)));
    if dice.roll(0, 1) == 1.0 {
        rows.push((dice.line(n, -1, 2), Relation::Greater, dice.roll(-2, 2)));
    }
    let sense = match dice.roll(0, 1) == 0.0 {
        true => Sense::Minimize,
        false => Sense::Maximize,
    };
    let cost = dice.line(n, -3, 3);
    let mut instance = dense::linear(sense, &cost, &bounds, &rows);
    let matched = |j: usize| (j < pairs).then_some(j as u32);
    instance.matched = Some((0..=n).map(matched).collect());
    instance
}

/// Rows on a, pairs' columns on b: two sides.
fn apart(dice: &mut Dice) -> Instance {
    let (n, pairs) = (3, 4);
    let width = n + pairs;
    let mut rows: Vec<Row> = Vec::new();
    let mut bounds = vec![(-INF, INF); n];
    bounds.extend(vec![(0.0, INF); pairs]);
    for _ in 0..pairs {
        let mut line = dice.line(n, -2, 2);
        line.resize(width, 0.0);
        rows.push((line, Relation::Greater, dice.roll(-5, 1)));
    }
    for sign in [1.0, -1.0] {
        for k in 0..n {
            let mut line = vec![0.0; width];
            line[k] = sign;
            rows.push((line, Relation::Less, dice.roll(2, 6)));
        }
    }
    for _ in 0..2 {
        let mut line = vec![0.0; n];
        line.extend(dice.line(pairs, -1, 2));
        rows.push((line, Relation::Equal, dice.roll(0, 2)));
    }
    let mut cost = dice.line(n, -3, 3);
    cost.resize(width, 0.0);
    let mut instance = dense::linear(Sense::Minimize, &cost, &bounds, &rows);
    let matched = |j: usize| (j >= n && j < width).then(|| (j - n) as u32);
    instance.matched = Some((0..=width).map(matched).collect());
    instance
}

/// Draws instances; most bounds meet the global minimum.
fn bounds_enclose(draw: fn(&mut Dice) -> Instance, seed: u64, count: usize) {
    let mut dice = Dice(seed);
    let judged = (0..count).filter_map(|k| judge(&draw(&mut dice), &format!("{k} of {seed}")));
    let closed: Vec<bool> = judged.collect();
    let (closed, all) = (closed.iter().filter(|c| **c).count(), closed.len());
    assert!(2 * closed > all, "{closed} of {all}");
}

#[test]
fn bounds_enclose_the_global_minimum() {
    bounds_enclose(joined, 6, 24);
}

#[test]
fn bounds_of_two_sides_enclose_the_global_minimum() {
    bounds_enclose(apart, 7, 16);
}

#[test]
fn products_alone_are_below_the_global_minimum() {
    let mut dice = Dice(11);
    let (mut closed, mut all) = (0, 0);
    for k in 0..12 {
        let instance = apart(&mut dice);
        let Some(truth) = by_enumeration(&instance).filter(|t| t.is_finite()) else {
            continue;
        };
        let program = Program::new(&instance).expect("pairs");
        let level = solve(&instance).outcome.level;
        let mut quiet = Quiet::default();
        let budget = Budget::unlimited(&mut quiet);
        let mut products = Products { budget: &budget };
        let limits = Limits {
            products: 1_000,
            steps: 2_000,
        };
        let cutoff = truth + 0.1 * truth.abs().max(1.0);
        let low = products.bound(
            &program,
            &mut Problem::of(&program.envelope),
            cutoff,
            &level,
            limits,
        );
        assert!(
            low <= truth + 1e-9 * truth.abs().max(1.0),
            "{k}: {low} > {truth}"
        );
        closed += usize::from(super::is_closed(low, truth));
        all += 1;
    }
    assert!(4 * closed > all, "{closed} of {all}");
}
