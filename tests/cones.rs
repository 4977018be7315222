//! Random convex programs of six families, their norms as squares and as roots: all are solved, none beside the optimum.
//!
//! The reference is a bundle of tangents: `min Σ wₖ tₖ + cᵀx` over the rows and the tangents of `tₖ ≥ fₖ(x)` at all
//! points so far, a linear program, until no tangent is violated. It bounds the optimum from below; its last point, with
//! tₖ moved up to the functions, from above.

use crate::common::Random;
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
/// Bound of the columns x in most families, never active.
const BOX: f64 = 100.0;

/// A number from −size to size, in thousandths of it.
fn number(random: &mut Random, size: f64) -> f64 {
    random.whole(1000) / 1000.0 * size
}

/// ‖A x − b‖, by rows of A.
struct Norm {
    rows: Vec<(Vec<f64>, f64)>,
}

impl Norm {
    fn residual(&self, x: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|(a, b)| dot(a, x) - b).collect()
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

/// A convex function.
enum Convex {
    Norm(Norm),
    /// Σ (a x − b)².
    Squares(Norm),
    /// log(1 + exp(a x − b)).
    Logistic(Vec<f64>, f64),
    /// exp(a x − b).
    Exponential(Vec<f64>, f64),
    /// x log x of a column above 0.
    Entropy(usize),
}

impl Convex {
    fn value(&self, x: &[f64]) -> f64 {
        match self {
            Self::Norm(f) => f.value(x),
            Self::Squares(f) => f.value(x).powi(2),
            Self::Logistic(a, b) => (dot(a, x) - b).exp().ln_1p(),
            Self::Exponential(a, b) => (dot(a, x) - b).exp(),
            Self::Entropy(j) => x[*j] * x[*j].ln(),
        }
    }

    fn gradient(&self, x: &[f64]) -> Vec<f64> {
        let along = |a: &[f64], by: f64| a.iter().map(|a| a * by).collect();
        match self {
            Self::Norm(f) => f.gradient(x),
            Self::Squares(f) => along(&f.gradient(x), 2.0 * f.value(x)),
            Self::Logistic(a, b) => along(a, 1.0 / (1.0 + (b - dot(a, x)).exp())),
            Self::Exponential(a, b) => along(a, (dot(a, x) - b).exp()),
            Self::Entropy(j) => {
                let mut out = vec![0.0; x.len()];
                out[*j] = x[*j].ln() + 1.0;
                out
            }
        }
    }
}

fn dot(a: &[f64], x: &[f64]) -> f64 {
    a.iter().zip(x).map(|(a, x)| a * x).sum()
}

/// min Σ wₖ fₖ(x) + cᵀx, D x ≤ e, l ≤ x ≤ u.
struct Program {
    cost: Vec<f64>,
    functions: Vec<(f64, Convex)>,
    rows: Vec<(Vec<f64>, f64)>,
    bounds: [f64; 2],
}

impl Program {
    /// Places to be near to, or residuals to be small, some of them weighty, beside other functions in four of the families;
    /// bounded from below as Σ w ‖·‖ outgrows cᵀx.
    fn random(random: &mut Random, family: Family) -> Self {
        let n = 2 + random.below(3) as usize;
        let near = family != Family::Residuals;
        let norm = |random: &mut Random| {
            let rows = if near {
                n
            } else {
                1 + random.below(4) as usize
            };
            let row = |random: &mut Random, i: usize| {
                let a = (0..n).map(|j| match near {
                    true => f64::from(u8::from(i == j)),
                    false => number(random, 2.0),
                });
                (a.collect(), number(random, 5.0))
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
        let mut functions: Vec<(f64, Convex)> = Vec::new();
        for _ in 0..count {
            let weight = weight(random);
            functions.push((weight, Convex::Norm(norm(random))));
        }
        for k in 0..2 + random.below(3) as usize {
            let a = (0..n).map(|_| number(random, 0.3)).collect();
            let (b, weight) = (number(random, 2.0), weight(random));
            functions.push(match family {
                Family::Places | Family::Residuals => break,
                Family::Risks => (0.1 * weight, Convex::Squares(norm(random))),
                Family::Logistic => (weight, Convex::Logistic(a, b)),
                Family::Exponential => (weight, Convex::Exponential(a, b)),
                Family::Entropy => (weight, Convex::Entropy(k % n)),
            });
        }
        let rows = (0..random.below(3)).map(|_| {
            let a: Vec<f64> = (0..n).map(|_| number(random, 1.0)).collect();
            (a, random.below(100) as f64 / 20.0)
        });
        let rows = rows.collect();
        let small = |random: &mut Random| if near { number(random, 0.2) } else { 0.0 };
        Self {
            cost: (0..n).map(|_| small(random)).collect(),
            functions,
            rows,
            bounds: match family {
                Family::Entropy => [0.01, BOX],
                Family::Exponential | Family::Logistic => [-10.0, 10.0],
                _ => [-BOX, BOX],
            },
        }
    }

    fn n(&self) -> usize {
        self.cost.len()
    }

    fn value(&self, x: &[f64]) -> f64 {
        let functions: f64 = self.functions.iter().map(|(w, f)| w * f.value(x)).sum();
        functions + dot(&self.cost, x)
    }

    /// Columns x, t and z, the objective and the linear rows.
    fn linear(&self) -> (Instance, usize) {
        let mut out = Instance::default();
        for _ in 0..self.n() {
            out.add_column(self.bounds[0], self.bounds[1], self.bounds[0].max(0.0));
        }
        let mut objective: Vec<(usize, f64)> = self.cost.iter().copied().enumerate().collect();
        for (w, f) in &self.functions {
            let least = match f {
                Convex::Entropy(_) => -1.0,
                _ => 0.0,
            };
            let t = out.add_column(least, f64::INFINITY, 0.0);
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
        for round in 0..MAX_ROUNDS {
            let found = solved(ProblemType::Lp, &instance);
            assert_eq!(found.0, ModelStatus::Optimal, "round {round}");
            let (x, low) = (&found.1[..self.n()], found.1[z]);
            high = high.min(self.value(x));
            if high - low <= REFERENCE_GAP * high.abs().max(1.0) {
                return [low, high];
            }
            for (k, (_, f)) in self.functions.iter().enumerate() {
                let (value, slope) = (f.value(x), f.gradient(x));
                let at = dot(&slope, x);
                let mut entries: Vec<(usize, f64)> = slope.into_iter().enumerate().collect();
                entries.push((self.n() + k, -1.0));
                instance.add_row(entries, Relation::Less, at - value);
            }
        }
        panic!("the bundle of tangents ends with a gap");
    }

    /// As a model; norms as t² ≥ Σ (a x − b)², t ≥ √Σ, or t ≥ eDist.
    fn conic(&self, form: u64) -> (Instance, usize) {
        let (mut out, z) = self.linear();
        for (k, (_, f)) in self.functions.iter().enumerate() {
            let t = self.n() + k;
            let affine = |a: &[f64], b: f64| {
                let terms = a.iter().enumerate().filter(|e| *e.1 != 0.0);
                terms.fold(Term::constant(-b), |s, (j, a)| s + *a * Term::column(j))
            };
            let all =
                |f: &Norm| -> Vec<Term> { f.rows.iter().map(|(a, b)| affine(a, *b)).collect() };
            let squares = |f: &Norm| {
                let squares = all(f).into_iter().map(|e| e.powi(2));
                squares.reduce(|a, b| a + b).expect("a norm has rows")
            };
            if let (Convex::Norm(f), 0) = (f, form) {
                let row = out.add_row([], Relation::Less, 0.0);
                for e in all(f) {
                    out.add_term(row, 1.0, e.powi(2));
                }
                out.add_term(row, -1.0, Term::column(t).powi(2));
                continue;
            }
            let row = out.add_row([(t, -1.0)], Relation::Less, 0.0);
            let term = match f {
                Convex::Norm(f) if form == 1 => Term::call(Function::Sqrt, [squares(f)]),
                Convex::Norm(f) => Term::call(Function::EDist, all(f)),
                Convex::Squares(f) => squares(f),
                Convex::Logistic(a, b) => {
                    let exp = Term::call(Function::Exp, [affine(a, *b)]);
                    Term::call(Function::Log, [Term::constant(1.0) + exp])
                }
                Convex::Exponential(a, b) => Term::call(Function::Exp, [affine(a, *b)]),
                Convex::Entropy(j) if form == 1 => {
                    Term::column(*j) * Term::call(Function::Log, [Term::column(*j)])
                }
                Convex::Entropy(j) => -1.0 * Term::call(Function::Entropy, [Term::column(*j)]),
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

#[derive(Clone, Copy, Debug, PartialEq)]
enum Family {
    Places,
    Residuals,
    Risks,
    Logistic,
    Exponential,
    Entropy,
}

const FAMILIES: [Family; 6] = [
    Family::Places,
    Family::Residuals,
    Family::Risks,
    Family::Logistic,
    Family::Exponential,
    Family::Entropy,
];

/// Programs of each family; `BMOD_CASES` asks for more.
const CASES: usize = 70;

#[test]
fn random_cone_programs_are_solved() {
    let asked = std::env::var("BMOD_CASES")
        .ok()
        .and_then(|n| n.parse().ok());
    let (mut random, mut wrong) = (Random(1), Vec::new());
    for family in FAMILIES {
        for case in 0..asked.unwrap_or(CASES) {
            let program = Program::random(&mut random, family);
            let [low, high] = program.reference();
            for form in 0..3 {
                let (instance, z) = program.conic(form);
                let quadratic = form == 0
                    && matches!(family, Family::Places | Family::Residuals | Family::Risks);
                let using = match quadratic {
                    true => ProblemType::Qcp,
                    false => ProblemType::Nlp,
                };
                let (status, level) = solved(using, &instance);
                let near = TOLERANCE * high.abs().max(1.0);
                let right = (low - near..=high + near).contains(&level[z]);
                if status != ModelStatus::Optimal || !right {
                    let which = format!("{family:?} {case}, form {form}: {status:?}");
                    wrong.push(format!(
                        "{which}, {} where {low} to {high} is right",
                        level[z]
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
