//! The complementarity solver on problems whose answer is known.
//!
//! Problems are written as closures over dense matrices: small, and readable next to the paper
//! they come from. `F` is differentiated here by central differences where it is not linear.

use crate::walls::obstacle;
use bmod::solve::mcp::{
    Data, EvalError, Outcome, Problem, Settings, Status, natural_residual, solve,
};
use bmod::solve::{Budget, Limits, Monitor, Quiet};
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;

type Function = Box<dyn Fn(&[f64], &mut [f64]) -> Result<(), String>>;

/// A problem with a full Jacobian, or a sparse linear one.
struct Model {
    data: Data,
    /// Values of a constant Jacobian and F(0).
    linear: Option<(Vec<f64>, Vec<f64>)>,
    function: Function,
}

impl Model {
    /// Mx + q with M given by rows.
    fn linear(m: &[Vec<f64>], q: &[f64]) -> Model {
        let n = q.len();
        let triplets = (0..n)
            .flat_map(|j| (0..n).map(move |i| (i, j)))
            .filter(|&(i, j)| m[i][j] != 0.0)
            .map(|(i, j)| (i, j, m[i][j]));
        Model::sparse(n, triplets.collect(), q.to_vec())
    }

    /// Mx + q with M given by triplets in column order.
    fn sparse(n: usize, triplets: Vec<(usize, usize, f64)>, q: Vec<f64>) -> Model {
        let mut col_start = vec![0; n + 1];
        triplets.iter().for_each(|t| col_start[t.1 + 1] += 1);
        (0..n).for_each(|j| col_start[j + 1] += col_start[j]);
        Model {
            data: Data {
                lower: vec![0.0; n],
                upper: vec![INF; n],
                start: vec![0.0; n],
                column_start: col_start,
                rows: triplets.iter().map(|t| t.0).collect(),
                is_linear: true,
            },
            linear: Some((triplets.iter().map(|t| t.2).collect(), q)),
            function: Box::new(|_, _| Ok(())),
        }
    }

    fn nonlinear(
        n: usize,
        start: &[f64],
        f: impl Fn(&[f64], &mut [f64]) -> Result<(), String> + 'static,
    ) -> Model {
        Model {
            data: Data {
                lower: vec![0.0; n],
                upper: vec![INF; n],
                start: start.to_vec(),
                column_start: (0..=n).map(|j| j * n).collect(),
                rows: (0..n * n).map(|k| k % n).collect(),
                is_linear: false,
            },
            linear: None,
            function: Box::new(f),
        }
    }

    fn bounds(mut self, lower: &[f64], upper: &[f64]) -> Model {
        (self.data.lower, self.data.upper) = (lower.to_vec(), upper.to_vec());
        self
    }

    fn solve(&mut self) -> Outcome {
        solve(
            self,
            &Settings::default(),
            &Budget::unlimited(&mut Quiet::default()),
            &|i| (i + 1).to_string(),
        )
    }

    /// Solves, and does not believe the status.
    fn solution(&mut self) -> Vec<f64> {
        let outcome = self.solve();
        assert_eq!(outcome.status, Status::Solved, "{outcome:?}");
        let mut f = vec![0.0; self.data.lower.len()];
        self.function(&outcome.x, &mut f)
            .expect("defined at the solution");
        let residual = natural_residual(&outcome.x, &f, &self.data.lower, &self.data.upper).0;
        assert!(
            residual <= 1e-6 && (residual - outcome.residual).abs() <= 1e-12,
            "{residual} {}",
            outcome.residual
        );
        outcome.x
    }
}

impl Problem for Model {
    fn data(&self) -> &Data {
        &self.data
    }
    fn function(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        match &self.linear {
            Some((values, q)) => {
                f.copy_from_slice(q);
                for (j, x) in x.iter().enumerate() {
                    for k in self.data.column_start[j]..self.data.column_start[j + 1] {
                        f[self.data.rows[k]] += values[k] * x;
                    }
                }
                Ok(())
            }
            None => (self.function)(x, f).map_err(|message| EvalError {
                row: Some(0),
                message,
            }),
        }
    }
    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), EvalError> {
        if let Some((constant, _)) = &self.linear {
            values.copy_from_slice(constant);
            return Ok(());
        }
        let n = x.len();
        let (mut low, mut high, mut y) = (vec![0.0; n], vec![0.0; n], x.to_vec());
        for j in 0..n {
            let h = 1e-6 * x[j].abs().max(1.0);
            y[j] = x[j] + h;
            self.function(&y, &mut high)?;
            y[j] = x[j] - h;
            self.function(&y, &mut low)?;
            y[j] = x[j];
            (0..n).for_each(|i| values[j * n + i] = (high[i] - low[i]) / (2.0 * h));
        }
        Ok(())
    }
}

fn assert_near(x: &[f64], y: &[f64], tolerance: f64) {
    assert_eq!(x.len(), y.len());
    assert!(
        x.iter().zip(y).all(|(a, b)| (a - b).abs() <= tolerance),
        "{x:?} is not {y:?}"
    );
}

#[test]
fn a_small_lcp() {
    let m = [
        vec![0.0, 0.0, -1.0, -1.0],
        vec![0.0, 0.0, 1.0, -2.0],
        vec![1.0, -1.0, 2.0, -2.0],
        vec![1.0, 2.0, -2.0, 4.0],
    ];
    let x = Model::linear(&m, &[2.0, 2.0, -2.0, -6.0]).solution();
    assert_near(&x, &[2.8, 0.0, 0.8, 1.2], 1e-12);
}

/// Kojima and Shindo 1986; last = 3 gives Kojima–Shindo, 1 and other constants Josephy.
fn kojima_shindo(x: &[f64], f: &mut [f64]) -> Result<(), String> {
    let (a, b, c, d) = (x[0], x[1], x[2], x[3]);
    f[0] = 3.0 * a * a + 2.0 * a * b + 2.0 * b * b + c + 3.0 * d - 6.0;
    f[1] = 2.0 * a * a + a + b * b + 10.0 * c + 2.0 * d - 2.0;
    f[2] = 3.0 * a * a + a * b + 2.0 * b * b + 2.0 * c + 9.0 * d - 9.0;
    f[3] = a * a + 3.0 * b * b + 2.0 * c + 3.0 * d - 3.0;
    Ok(())
}

fn josephy(x: &[f64], f: &mut [f64]) -> Result<(), String> {
    let (a, b, c, d) = (x[0], x[1], x[2], x[3]);
    f[0] = 3.0 * a * a + 2.0 * a * b + 2.0 * b * b + c + 3.0 * d - 6.0;
    f[1] = 2.0 * a * a + a + b * b + 3.0 * c + 2.0 * d - 2.0;
    f[2] = 3.0 * a * a + a * b + 2.0 * b * b + 2.0 * c + 3.0 * d - 1.0;
    f[3] = a * a + 3.0 * b * b + 2.0 * c + 3.0 * d - 3.0;
    Ok(())
}

const STARTS: [[f64; 4]; 9] = [
    [0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 1.0, 1.0],
    [100.0, 100.0, 100.0, 100.0],
    [1.0, 0.0, 1.0, 0.0],
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 1.0, 0.0],
    [10.0, 10.0, 10.0, 10.0],
    [1.25, 0.0, 0.0, 0.5],
    [2.0, 0.0, 5.0, 0.0],
];

#[test]
fn kojima_shindo_from_nine_starts() {
    let degenerate = [1.5f64.sqrt(), 0.0, 0.0, 0.5];
    let other = [1.0, 0.0, 3.0, 0.0];
    for start in STARTS {
        let x = Model::nonlinear(4, &start, kojima_shindo).solution();
        let near = |y: &[f64]| x.iter().zip(y).all(|(a, b)| (a - b).abs() < 1e-3);
        assert!(near(&degenerate) || near(&other), "{x:?}");
    }
}

#[test]
fn josephy_from_nine_starts() {
    for start in STARTS {
        let x = Model::nonlinear(4, &start, josephy).solution();
        assert_near(&x, &[1.5f64.sqrt(), 0.0, 0.0, 0.5], 1e-7);
    }
}

#[test]
fn billups_has_a_local_minimum_of_the_merit_function() {
    for start in [0.0, 0.5, 1.0, 5.0] {
        let mut model = Model::nonlinear(1, &[start], |x, f| {
            f[0] = (x[0] - 1.0).powi(2) - 1.01;
            Ok(())
        });
        assert_near(&model.solution(), &[1.0 + 1.01f64.sqrt()], 1e-8);
    }
}

#[test]
fn murty_and_fathi() {
    for n in (8..=20).step_by(4) {
        // Murty: upper triangular with twos; Lemke's method with the usual cover takes 2ⁿ pivots.
        let murty: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| {
                        if i == j {
                            1.0
                        } else if j > i {
                            2.0
                        } else {
                            0.0
                        }
                    })
                    .collect()
            })
            .collect();
        let mut exact = vec![0.0; n];
        exact[n - 1] = 1.0;
        assert_near(
            &Model::linear(&murty, &vec![-1.0; n]).solution(),
            &exact,
            1e-10,
        );
        // Fathi: M = UᵀU of Murty's matrix, symmetric positive definite.
        let fathi: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| (0..n).map(|k| murty[k][i] * murty[k][j]).sum())
                    .collect()
            })
            .collect();
        let mut exact = vec![0.0; n];
        exact[0] = 1.0;
        assert_near(
            &Model::linear(&fathi, &vec![-1.0; n]).solution(),
            &exact,
            1e-10,
        );
    }
}

#[test]
fn singular_and_copositive() {
    // Many solutions: x₁ + x₂ = 1.
    let x = Model::linear(&[vec![1.0, 1.0], vec![1.0, 1.0]], &[-1.0, -1.0]).solution();
    assert!((x[0] + x[1] - 1.0).abs() < 1e-8);
    // Copositive, not monotone.
    let m = [
        vec![0.0, 3.0, 1.0],
        vec![1.0, 0.0, 3.0],
        vec![3.0, 1.0, 0.0],
    ];
    Model::linear(&m, &[-1.0, -1.0, -1.0]).solution();
    // The zero matrix.
    let x = Model::linear(&[vec![0.0]], &[0.0]).solution();
    assert!(x[0] >= 0.0);
}

#[test]
fn a_bimatrix_game() {
    let n = 6;
    let entry =
        |i: usize, j: usize, a: usize| 1.0 + ((i * 7 + j * 13 + a * 5 + i * j * 3) % 11) as f64;
    let m: Vec<Vec<f64>> = (0..2 * n)
        .map(|i| {
            (0..2 * n)
                .map(|j| match (i < n, j < n) {
                    (true, false) => entry(i, j - n, 0),
                    (false, true) => entry(j, i - n, 1),
                    _ => 0.0,
                })
                .collect()
        })
        .collect();
    let x = Model::linear(&m, &vec![-1.0; 2 * n]).solution();
    assert!(x[..n].iter().sum::<f64>() > 0.0 && x[n..].iter().sum::<f64>() > 0.0);
}

#[test]
fn no_solution_is_not_solved() {
    // 0·x − 1 ≥ 0 never holds.
    let outcome = Model::linear(&[vec![0.0]], &[-1.0]).solve();
    assert_eq!(outcome.status, Status::NoSolution);
    assert!((outcome.residual - 1.0).abs() < 1e-9);
    let outcome = Model::nonlinear(2, &[1.0, 1.0], |x, f| {
        f[0] = -1.0 - x[0] * x[0];
        f[1] = x[0] + x[1] - 3.0;
        Ok(())
    })
    .solve();
    assert_eq!(outcome.status, Status::NoSolution);
    assert!(outcome.residual >= 1.0 - 1e-9);
    // An equation without a root.
    let outcome = Model::nonlinear(1, &[0.0], |x, f| {
        f[0] = x[0].exp();
        Ok(())
    })
    .bounds(&[-INF], &[INF])
    .solve();
    // exp(x) falls below any tolerance: a root at minus infinity, as good as its residual.
    assert!(outcome.status == Status::NoSolution || outcome.residual <= 1e-6);
}

#[test]
fn undefined_at_the_start() {
    let log = |x: &[f64], f: &mut [f64]| {
        if x[0] <= 0.0 {
            return Err("log of a number that is not positive".to_string());
        }
        f[0] = x[0].ln() - 1.0;
        Ok(())
    };
    assert_near(
        &Model::nonlinear(1, &[0.0], log).solution(),
        &[1f64.exp()],
        1e-8,
    );
    // Undefined everywhere, by error and by value.
    let outcome = Model::nonlinear(2, &[0.0, 0.0], |_, _| Err("never".to_string())).solve();
    assert_eq!(outcome.status, Status::EvaluationFailed);
    assert!(outcome.message.contains("never"));
    let outcome = Model::nonlinear(1, &[0.0], |_, f| {
        f[0] = f64::NAN;
        Ok(())
    })
    .solve();
    assert_eq!(outcome.status, Status::EvaluationFailed);
}

#[test]
fn bounds_of_all_kinds() {
    let crossed = Model::linear(&[vec![1.0]], &[1.0])
        .bounds(&[2.0], &[1.0])
        .solve();
    assert_eq!(crossed.status, Status::InvalidBounds);
    let nan = Model::linear(&[vec![1.0]], &[1.0])
        .bounds(&[f64::NAN], &[1.0])
        .solve();
    assert_eq!(nan.status, Status::InvalidBounds);
    // Lower, upper, both, free and fixed, each at F = x − target.
    let (lower, upper) = (
        [0.0, -INF, 0.0, 0.0, -INF, 3.0],
        [INF, 0.0, 1.0, 1.0, INF, 3.0],
    );
    let identity: Vec<Vec<f64>> = (0..6)
        .map(|i| (0..6).map(|j| f64::from(u8::from(i == j))).collect())
        .collect();
    let x = Model::linear(&identity, &[5.0, -5.0, -5.0, -0.25, 7.0, 1.0])
        .bounds(&lower, &upper)
        .solution();
    assert_near(&x, &[0.0, 0.0, 1.0, 0.25, -7.0, 3.0], 1e-12);
    // 1e20 is infinity.
    let x = Model::linear(&[vec![1.0]], &[4.0])
        .bounds(&[-1e20], &[1e30])
        .solution();
    assert_near(&x, &[-4.0], 1e-12);
}

#[test]
fn sizes_zero_and_one_and_all_fixed() {
    assert!(Model::linear(&[], &[]).solution().is_empty());
    assert_near(
        &Model::linear(&[vec![2.0]], &[-3.0]).solution(),
        &[1.5],
        1e-14,
    );
    let x = Model::linear(&[vec![0.0, 1.0], vec![1.0, 0.0]], &[1.0, 1.0])
        .bounds(&[1.0, 2.0], &[1.0, 2.0])
        .solution();
    assert_near(&x, &[1.0, 2.0], 0.0);
}

#[test]
fn inconsistent_arrays_are_refused() {
    let mut model = Model::linear(&[vec![1.0]], &[-1.0]);
    model.data.rows[0] = 5;
    assert_eq!(model.solve().status, Status::InvalidProblem);
    let mut model = Model::linear(&[vec![1.0]], &[-1.0]);
    model.data.start.clear();
    assert_eq!(model.solve().status, Status::InvalidProblem);
}

#[test]
fn bounds_written_as_rows() {
    // min ½(x−5)² + ½(y+5)² with x ≤ 2 and y ≥ −1 as rows with multipliers.
    let m = [
        vec![1.0, 0.0, 1.0, 0.0],
        vec![0.0, 1.0, 0.0, -1.0],
        vec![-1.0, 0.0, 0.0, 0.0],
        vec![0.0, 1.0, 0.0, 0.0],
    ];
    let q = [-5.0, 5.0, 2.0, 1.0];
    let lower = [-INF, -INF, 0.0, 0.0];
    let x = Model::linear(&m, &q).bounds(&lower, &[INF; 4]).solution();
    assert_near(&x, &[2.0, -1.0, 3.0, 4.0], 1e-10);
}

#[test]
fn many_unknowns_in_a_band() {
    let outcome = solve(
        &mut obstacle(10_000),
        &Settings::default(),
        &Budget::unlimited(&mut Quiet::default()),
        &|i| (i + 1).to_string(),
    );
    assert_eq!(outcome.status, Status::Solved);
    assert!(outcome.residual <= 1e-8 && outcome.x.iter().any(|x| *x > 0.0));
}

/// Stops at once.
struct Impatient;

impl Monitor for Impatient {
    fn log(&mut self, _line: &str) {}
    fn interrupted(&mut self) -> bool {
        true
    }
    fn seconds(&mut self) -> f64 {
        0.0
    }
}

#[test]
fn limits_and_interruption() {
    let mut impatient = Impatient;
    let budget = Budget::new(&mut impatient, Limits::default(), true);
    let interrupted = solve(&mut obstacle(50), &Settings::default(), &budget, &|i| {
        (i + 1).to_string()
    });
    assert_eq!(interrupted.status, Status::Interrupted);
    let mut quiet = Quiet::default();
    let limits = Limits {
        seconds: 0.0,
        ..Limits::default()
    };
    let budget = Budget::new(&mut quiet, limits, false);
    let settings = Settings::default();
    assert_eq!(
        solve(&mut obstacle(50), &settings, &budget, &|i| (i + 1)
            .to_string())
        .status,
        Status::TimeLimit
    );
    let settings = Settings {
        cumulative_iteration_limit: 0,
        ..Settings::default()
    };
    assert_eq!(
        solve(
            &mut obstacle(50),
            &settings,
            &Budget::unlimited(&mut Quiet::default()),
            &|i| (i + 1).to_string()
        )
        .status,
        Status::IterationLimit
    );
}

#[test]
fn the_same_answer_twice() {
    let run = || Model::nonlinear(4, &STARTS[2], kojima_shindo).solve();
    let (a, b) = (run(), run());
    assert_eq!(
        (a.x, a.pivots, a.evaluations),
        (b.x, b.pivots, b.evaluations)
    );
}

/// A random strictly monotone problem: M = AAᵀ + skew part + I.
fn monotone(n: usize, entries: &[f64], q: &[f64]) -> Vec<Vec<f64>> {
    let a = |i: usize, j: usize| entries[(i * n + j) % entries.len()];
    (0..n)
        .map(|i| {
            (0..n)
                .map(|j| {
                    let symmetric: f64 = (0..n).map(|k| a(i, k) * a(j, k)).sum();
                    symmetric + (a(i, j) - a(j, i)) + if i == j { 1.0 } else { 0.0 }
                })
                .collect()
        })
        .take(q.len())
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn permutation_and_scaling_do_not_change_the_answer(
        entries in proptest::collection::vec(-1.0f64..1.0, 64),
        q in proptest::collection::vec(-2.0f64..2.0, 8),
        scale in proptest::collection::vec(-6i32..6, 16),
        shift in 1usize..8,
        has_upper in proptest::collection::vec(any::<bool>(), 8),
    ) {
        let n = q.len();
        let m = monotone(n, &entries, &q);
        let upper: Vec<f64> = has_upper.iter().map(|&b| if b { 0.5 } else { INF }).collect();
        let lower = vec![0.0; n];
        let x = Model::linear(&m, &q).bounds(&lower, &upper).solution();
        // Row and column i of the second problem are p(i) of the first, scaled by r and c.
        let p: Vec<usize> = (0..n).map(|i| (i * 3 + shift) % n).collect();
        let r: Vec<f64> = (0..n).map(|i| 2f64.powi(scale[i])).collect();
        let c: Vec<f64> = (0..n).map(|i| 2f64.powi(scale[n + i])).collect();
        let m2: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| r[i] * m[p[i]][p[j]] * c[j]).collect()).collect();
        let q2: Vec<f64> = (0..n).map(|i| r[i] * q[p[i]]).collect();
        let u2: Vec<f64> = (0..n).map(|i| upper[p[i]] / c[i]).collect();
        let y = Model::linear(&m2, &q2).bounds(&lower, &u2).solution();
        let back: Vec<f64> = (0..n).map(|i| y[i] * c[i]).collect();
        let expected: Vec<f64> = p.iter().map(|&k| x[k]).collect();
        assert_near(&back, &expected, 1e-7);
    }
}

/// A solution that only a random start led to may be one of several: the report says so.
#[test]
fn random_starts_are_named() {
    let file = std::path::Path::new("tests/suite/mcp/multipliers_without_limit.blk");
    let finished = crate::common::run_file(file, &[], crate::common::quiet());
    let solve = crate::common::last_solve(&finished).expect("a solve");
    let message = solve.message.expect("a message");
    assert!(message.starts_with("found from random start "), "{message}");
}
