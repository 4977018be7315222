//! Random convex programs with second-order cones, as squares and as roots: all are solved, none beside the optimum.
//!
//! The reference is a bundle of tangents: `min Σ wₖ tₖ + cᵀx` over the rows and the tangents of `tₖ ≥ ‖Aₖ x − bₖ‖` at all
//! points so far, a linear program, until no tangent is violated. It bounds the optimum from below; its last point, with
//! tₖ moved up to the norms, from above.

use bmod::model::outcome::ModelStatus;
use bmod::model::problem_type::ProblemType;
use bmod::solve::answer::answer;
use bmod::solve::{Budget, Quiet, Settings};
use bmod::solver::{Function, Instance, Relation, Sense, Term};

/// Distance of the two bounds of the reference, relative to the value.
const REFERENCE_GAP: f64 = 1e-7;
/// Answers are at most this far from it.
const TOLERANCE: f64 = 1e-6;
/// Rounds of tangents.
const MAX_ROUNDS: usize = 400;
/// Bound of the columns x, never active.
const BOX: f64 = 100.0;

struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    /// A number from −size to size, with two decimals.
    fn number(&mut self, size: f64) -> f64 {
        (self.below(2001) as f64 / 1000.0 - 1.0) * size
    }
}

/// ‖A x − b‖, by rows of A.
struct Norm {
    rows: Vec<(Vec<f64>, f64)>,
}

impl Norm {
    fn residual(&self, x: &[f64]) -> Vec<f64> {
        let dot = |a: &[f64]| a.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
        self.rows.iter().map(|(a, b)| dot(a) - b).collect()
    }

    fn value(&self, x: &[f64]) -> f64 {
        self.residual(x).iter().map(|r| r * r).sum::<f64>().sqrt()
    }

    fn gradient(&self, x: &[f64]) -> Vec<f64> {
        let (r, value) = (self.residual(x), self.value(x));
        let mut out = vec![0.0; x.len()];
        for ((a, _), r) in self.rows.iter().zip(r) {
            for (g, a) in out.iter_mut().zip(a) {
                *g += a * r / value.max(1e-12);
            }
        }
        out
    }
}

/// min Σ wₖ ‖Aₖ x − bₖ‖ + cᵀx, D x ≤ e, −100 ≤ x ≤ 100.
struct Program {
    cost: Vec<f64>,
    norms: Vec<(f64, Norm)>,
    rows: Vec<(Vec<f64>, f64)>,
}

impl Program {
    /// Places to be near to, or residuals to be small, some of them weighty; bounded from below as Σ w ‖·‖ outgrows cᵀx.
    fn random(random: &mut Random) -> Self {
        let n = 2 + random.below(3) as usize;
        let near = random.below(2) == 0;
        let norm = |random: &mut Random| {
            let rows = if near {
                n
            } else {
                1 + random.below(4) as usize
            };
            let row = |random: &mut Random, i: usize| {
                let a = (0..n).map(|j| match near {
                    true => f64::from(u8::from(i == j)),
                    false => random.number(2.0),
                });
                (a.collect(), random.number(5.0))
            };
            Norm {
                rows: (0..rows).map(|i| row(random, i)).collect(),
            }
        };
        let count = 3 + random.below(5) as usize;
        let weight = |random: &mut Random| match random.below(6) {
            0 => 20.0,
            _ => 0.5 + random.below(100) as f64 / 50.0,
        };
        let norms = (0..count).map(|_| (weight(random), norm(random)));
        let norms = norms.collect();
        let rows = (0..random.below(3)).map(|_| {
            let a: Vec<f64> = (0..n).map(|_| random.number(1.0)).collect();
            (a, random.below(100) as f64 / 20.0)
        });
        let rows = rows.collect();
        let small = |random: &mut Random| if near { random.number(0.2) } else { 0.0 };
        Self {
            cost: (0..n).map(|_| small(random)).collect(),
            norms,
            rows,
        }
    }

    fn n(&self) -> usize {
        self.cost.len()
    }

    fn value(&self, x: &[f64]) -> f64 {
        let norms: f64 = self.norms.iter().map(|(w, f)| w * f.value(x)).sum();
        norms + self.cost.iter().zip(x).map(|(c, x)| c * x).sum::<f64>()
    }

    /// Columns x, t and z, the objective and the linear rows.
    fn linear(&self) -> (Instance, usize) {
        let mut out = Instance::default();
        for _ in 0..self.n() {
            out.add_column(-BOX, BOX, 0.0);
        }
        let mut objective: Vec<(usize, f64)> = self.cost.iter().copied().enumerate().collect();
        for (w, _) in &self.norms {
            let t = out.add_column(0.0, f64::INFINITY, 0.0);
            objective.push((t, *w));
        }
        let z = out.add_column(f64::NEG_INFINITY, f64::INFINITY, 0.0);
        objective.push((z, -1.0));
        out.add_row(objective, Relation::Equal, 0.0);
        for (a, e) in &self.rows {
            let entries: Vec<(usize, f64)> = a.iter().copied().enumerate().collect();
            out.add_row(entries, Relation::Less, *e);
        }
        out.set_objective(z, Sense::Minimize);
        (out, z)
    }

    /// Bounds of the optimum.
    fn reference(&self) -> [f64; 2] {
        let (mut instance, z) = self.linear();
        let mut high = f64::INFINITY;
        for _ in 0..MAX_ROUNDS {
            let found = solved(ProblemType::Lp, &instance);
            assert_eq!(found.0, ModelStatus::Optimal);
            let (x, low) = (&found.1[..self.n()], found.1[z]);
            high = high.min(self.value(x));
            if high - low <= REFERENCE_GAP * high.abs().max(1.0) {
                return [low, high];
            }
            for (k, (_, norm)) in self.norms.iter().enumerate() {
                let (value, slope) = (norm.value(x), norm.gradient(x));
                let at: f64 = slope.iter().zip(x).map(|(g, x)| g * x).sum();
                let mut entries: Vec<(usize, f64)> = slope.into_iter().enumerate().collect();
                entries.push((self.n() + k, -1.0));
                instance.add_row(entries, Relation::Less, at - value);
            }
        }
        panic!("the bundle of tangents ends with a gap");
    }

    /// As a model: t² ≥ Σ (a x − b)², t ≥ √Σ, or t ≥ eDist.
    fn conic(&self, form: u64) -> (Instance, usize) {
        let (mut out, z) = self.linear();
        for (k, (_, norm)) in self.norms.iter().enumerate() {
            let t = self.n() + k;
            let affine = |(a, b): &(Vec<f64>, f64)| {
                let terms = a.iter().enumerate().filter(|e| *e.1 != 0.0);
                terms.fold(Term::constant(-b), |s, (j, a)| s + *a * Term::column(j))
            };
            let all: Vec<Term> = norm.rows.iter().map(affine).collect();
            if form == 0 {
                let row = out.add_row([], Relation::Less, 0.0);
                for e in all {
                    out.add_term(row, 1.0, e.powi(2));
                }
                out.add_term(row, -1.0, Term::column(t).powi(2));
                continue;
            }
            let row = out.add_row([(t, -1.0)], Relation::Less, 0.0);
            let term = match form {
                1 => {
                    let squares = all.into_iter().map(|e| e.powi(2));
                    let sum = squares.reduce(|a, b| a + b).expect("a norm has rows");
                    Term::call(Function::Sqrt, [sum])
                }
                _ => Term::call(Function::EDist, all),
            };
            out.add_term(row, 1.0, term);
        }
        (out, z)
    }
}

fn solved(using: ProblemType, instance: &Instance) -> (ModelStatus, Vec<f64>) {
    let mut quiet = Quiet::default();
    let budget = Budget::unlimited(&mut quiet);
    let found = answer(using, None, instance, &Settings::default(), &budget);
    let found = found.expect("it is solved");
    (found.status, found.outcome.level)
}

#[test]
fn random_cone_programs_are_solved() {
    let mut random = Random(1);
    for case in 0..100 {
        let program = Program::random(&mut random);
        let [low, high] = program.reference();
        for form in 0..3 {
            let (instance, z) = program.conic(form);
            let using = if form == 0 {
                ProblemType::Qcp
            } else {
                ProblemType::Nlp
            };
            let (status, level) = solved(using, &instance);
            let near = TOLERANCE * high.abs().max(1.0);
            assert_eq!(status, ModelStatus::Optimal, "program {case}, form {form}");
            assert!(
                (low - near..=high + near).contains(&level[z]),
                "program {case}, form {form}: {} is not from {low} to {high}",
                level[z]
            );
        }
    }
}
