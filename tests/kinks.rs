//! Random programs with kinks: no claim of an optimum where a direction leads down.
//!
//! The slope f'(x; d) is linear in d on each cell of the arrangement of hyperplanes on which two pieces that meet at x grow
//! alike. With the coordinate planes added every cell is pointed: f'(x; ·) is nowhere negative if it is not on the edges of the
//! cells, which are enumerated. Sampled directions are tried besides, and steps along all of them.

use crate::common::Random;
use bmod::model::outcome::ModelStatus;
use bmod::model::problem_type::ProblemType;
use bmod::solve::answer::answer;
use bmod::solve::{Budget, Quiet, Settings};
use bmod::solver::{Function, Instance, Relation, Sense, Term};

/// A slope below this is a descent.
const DESCENT: f64 = -1e-3;
/// Pieces that are equal at a point so near to x meet there: a level counts to 1e-6 of its size, which is at most 3.
const NEAR: f64 = 3e-6;
/// A step along a direction: what curves adds little to the slope.
const STEP: f64 = 1e-4;

/// c + g·x + Σ q_j x_j².
struct Piece {
    constant: f64,
    linear: Vec<f64>,
    square: Vec<f64>,
}

impl Piece {
    fn random(random: &mut Random, n: usize) -> Self {
        let curved = random.below(3) == 0;
        Self {
            constant: random.whole(2) * random.below(2) as f64,
            linear: (0..n).map(|_| random.whole(3)).collect(),
            square: (0..n)
                .map(|_| if curved { random.whole(2) / 2.0 } else { 0.0 })
                .collect(),
        }
    }

    fn value(&self, x: &[f64]) -> f64 {
        let terms = x.iter().zip(self.linear.iter().zip(&self.square));
        terms.fold(self.constant, |s, (x, (g, q))| s + g * x + q * x * x)
    }

    fn gradient(&self, x: &[f64]) -> Vec<f64> {
        let terms = x.iter().zip(self.linear.iter().zip(&self.square));
        terms.map(|(x, (g, q))| g + 2.0 * q * x).collect()
    }

    fn term(&self) -> Term {
        let squares = (0..self.linear.len()).filter(|&j| self.square[j] != 0.0);
        let linear = (0..self.linear.len()).fold(Term::constant(self.constant), |s, j| {
            s + self.linear[j] * Term::column(j)
        });
        squares.fold(linear, |s, j| s + self.square[j] * Term::column(j).powi(2))
    }
}

/// weight · max, min or |·|; a single piece is smooth.
struct Part {
    weight: f64,
    function: Function,
    pieces: Vec<Piece>,
}

impl Part {
    fn values(&self, x: &[f64]) -> (Vec<f64>, f64) {
        let values: Vec<f64> = self.pieces.iter().map(|p| p.value(x)).collect();
        let value = match self.function {
            Function::Abs => values[0].abs(),
            Function::Min => values.iter().copied().fold(f64::INFINITY, f64::min),
            _ => values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        };
        (values, value)
    }

    /// Gradients of the pieces that meet.
    fn active(&self, x: &[f64]) -> Vec<Vec<f64>> {
        let (values, value) = self.values(x);
        let gradients: Vec<Vec<f64>> = self.pieces.iter().map(|p| p.gradient(x)).collect();
        // how much two gradients change a difference by
        let tie = |a: &[f64], b: &[f64]| {
            let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            NEAR * differences.sum::<f64>() + 1e-9
        };
        match self.function {
            Function::Abs => {
                let gradient = gradients[0].clone();
                let negative: Vec<f64> = gradient.iter().map(|g| -g).collect();
                match values[0] {
                    v if 2.0 * v.abs() <= tie(&gradient, &negative) => vec![gradient, negative],
                    v if v > 0.0 => vec![gradient],
                    _ => vec![negative],
                }
            }
            _ => {
                let taken = values.iter().position(|v| *v == value).unwrap_or(0);
                let all = gradients.iter().zip(&values);
                all.filter(|(g, v)| (*v - value).abs() <= tie(g, &gradients[taken]))
                    .map(|(g, _)| g.clone())
                    .collect()
            }
        }
    }

    fn slope(&self, active: &[Vec<f64>], d: &[f64]) -> f64 {
        let slopes = active.iter().map(|g| dot(g, d));
        self.weight
            * match self.function {
                Function::Min => slopes.fold(f64::INFINITY, f64::min),
                _ => slopes.fold(f64::NEG_INFINITY, f64::max),
            }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn value(parts: &[Part], x: &[f64]) -> f64 {
    parts.iter().map(|p| p.weight * p.values(x).1).sum()
}

/// Edges of the cells, both ways, and sampled directions, of length 1 in the largest component.
fn directions(random: &mut Random, n: usize, active: &[Vec<Vec<f64>>]) -> Vec<Vec<f64>> {
    let mut normals: Vec<Vec<f64>> = (0..n)
        .map(|j| (0..n).map(|k| f64::from(u8::from(j == k))).collect())
        .collect();
    for gradients in active {
        for (k, a) in gradients.iter().enumerate() {
            let differences = gradients[..k].iter();
            normals.extend(differences.map(|b| a.iter().zip(b).map(|(a, b)| a - b).collect()));
        }
    }
    let mut edges: Vec<Vec<f64>> = Vec::new();
    for (k, a) in normals.iter().enumerate() {
        if n == 2 {
            edges.push(vec![-a[1], a[0]]);
            continue;
        }
        edges.extend(normals[..k].iter().map(|b| {
            vec![
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ]
        }));
    }
    for _ in 0..200 {
        edges.push((0..n).map(|_| random.whole(1000)).collect());
    }
    let both = edges
        .into_iter()
        .flat_map(|d| [d.iter().map(|v| -v).collect(), d]);
    both.filter_map(|d: Vec<f64>| {
        let size = d.iter().fold(0.0_f64, |s, v| s.max(v.abs()));
        (size > 1e-9).then(|| d.iter().map(|v| v / size).collect())
    })
    .collect()
}

fn random_program(random: &mut Random) -> (usize, Vec<Part>) {
    let n = 2 + random.below(2) as usize;
    let parts = (0..2 + random.below(4)).map(|_| {
        let (function, count) = match random.below(4) {
            0 => (Function::Abs, 1),
            1 => (Function::Min, 2 + random.below(2)),
            2 => (Function::Max, 2 + random.below(2)),
            _ => (Function::Max, 1),
        };
        let weight = [-2.0, -1.0, 1.0, 1.0, 2.0][random.below(5) as usize];
        Part {
            weight,
            function,
            pieces: (0..count).map(|_| Piece::random(random, n)).collect(),
        }
    });
    (n, parts.collect())
}

#[test]
fn no_optimum_is_claimed_where_a_direction_leads_down() {
    let mut random = Random(52);
    let (mut claimed, mut at_kinks) = (0, 0);
    let mut wrong = Vec::new();
    for program in 0..500 {
        let (n, parts) = random_program(&mut random);
        let mut instance = Instance::default();
        for _ in 0..n {
            instance.add_column(-3.0, 3.0, random.whole(2) * random.below(2) as f64);
        }
        let z = instance.add_column(f64::NEG_INFINITY, f64::INFINITY, 0.0);
        let row = instance.add_row([(z, 1.0)], Relation::Equal, 0.0);
        for part in &parts {
            let pieces = part.pieces.iter().map(Piece::term);
            let term = match (part.function, part.pieces.len()) {
                (Function::Max, 1) => part.pieces[0].term(),
                (function, _) => Term::call(function, pieces),
            };
            instance.add_term(row, -part.weight, term);
        }
        instance.set_objective(z, Sense::Minimize);
        let settings = Settings::default();
        let mut quiet = Quiet::default();
        let budget = Budget::unlimited(&mut quiet);
        let found = answer(ProblemType::Dnlp, None, &instance, &settings, &budget)
            .unwrap_or_else(|e| panic!("{program}: {e:?}"));
        if !matches!(
            found.status,
            ModelStatus::Optimal | ModelStatus::LocallyOptimal
        ) {
            continue;
        }
        claimed += 1;
        let x = &found.outcome.level[..n];
        let active: Vec<_> = parts.iter().map(|p| p.active(x)).collect();
        at_kinks += usize::from(active.iter().any(|a| a.len() > 1));
        let here = value(&parts, x);
        assert!((here - found.outcome.level[z]).abs() <= 1e-5 * here.abs().max(1.0));
        let inside = |d: &&Vec<f64>| {
            let ends = x.iter().zip(d.iter());
            ends.into_iter()
                .all(|(x, &d)| d == 0.0 || (x + 1e-6 * d.signum()).abs() <= 3.0)
        };
        for d in directions(&mut random, n, &active).iter().filter(inside) {
            let slope: f64 = parts.iter().zip(&active).map(|(p, a)| p.slope(a, d)).sum();
            let there: Vec<f64> = x
                .iter()
                .zip(d)
                .map(|(x, d)| (x + STEP * d).clamp(-3.0, 3.0))
                .collect();
            let gain = (value(&parts, &there) - here) / STEP;
            if slope < DESCENT || gain < -0.1 {
                wrong.push(format!(
                    "{program}: {x:?}, value {here}: slope {slope}, by a step {gain}, along {d:?}"
                ));
                break;
            }
        }
    }
    assert!(wrong.is_empty(), "{}\n{}", wrong.len(), wrong.join("\n"));
    println!("{claimed} claimed, {at_kinks} at kinks");
    assert!(claimed >= 490, "{claimed} of 500 have an answer");
    assert!(at_kinks >= 100, "{at_kinks} of them at kinks");
}
