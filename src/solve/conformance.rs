//! Linear programs with known answers, written once and run against every solver that takes
//! them: primal, infeasible and unbounded variants, degenerate and badly scaled ones, every kind
//! of bound, no rows, no columns.

use super::backend::{Backend, Task};
use super::{Budget, Claim, ModelStatus, Monitor, Outcome, Progress, Settings, SolveError};
use crate::model::instance::{Columns, Instance, Relation, Sense};
use crate::model::problem_type::ProblemType;
use crate::solve::certificate;
use Relation::{Equal, Free, Greater, Less};

const INF: f64 = f64::INFINITY;

pub use super::Quiet;

/// A row: dense coefficients, relation, right-hand side.
pub type Row = (Vec<f64>, Relation, f64);

/// An instance whose last column z is the objective, defined by the last row `z - c'x =e= 0`.
pub fn linear(sense: Sense, cost: &[f64], bounds: &[(f64, f64)], rows: &[Row]) -> Instance {
    let mut instance = Instance {
        columns: columns(bounds),
        ..Instance::default()
    };
    let z = instance.add_column(-INF, INF, 0.0);
    instance.set_objective(z, sense);
    let definition: Vec<f64> = cost.iter().map(|&c| -c).chain([1.0]).collect();
    let all = rows.iter().cloned().chain([(definition, Equal, 0.0)]);
    for (coefficients, relation, rhs) in all {
        push_row(&mut instance, &coefficients, relation, rhs);
    }
    instance
}

/// Columns with these bounds, at level 0.
pub fn columns(bounds: &[(f64, f64)]) -> Columns {
    let mut out = Columns::default();
    for &(lower, upper) in bounds {
        out.push(lower, upper);
    }
    out
}

/// Appends a row given densely.
pub fn push_row(instance: &mut Instance, coefficients: &[f64], relation: Relation, rhs: f64) {
    instance.add_row(coefficients.iter().copied().enumerate(), relation, rhs);
}

/// A backend with its settings.
type Solve<'a> = &'a dyn Fn(&Instance) -> Result<Outcome, SolveError>;

/// Solves, and checks that the certificate confirms the claim.
fn run(solver: Solve, instance: &Instance) -> Outcome {
    let o = solver(instance).expect("a valid instance");
    let residuals = certificate::linear(instance, &o);
    let status = certificate::linear_status(instance, &o, &residuals);
    let confirmed = match o.claim {
        Claim::Solved => status == ModelStatus::Optimal,
        Claim::Infeasible => status == ModelStatus::Infeasible,
        Claim::Unbounded => matches!(
            status,
            ModelStatus::Unbounded | ModelStatus::UnboundedNoSolution
        ),
        _ => false,
    };
    assert!(confirmed, "{status:?} {residuals:?}\n{o:?}");
    o
}

#[track_caller]
fn near(a: f64, b: f64, tolerance: f64) {
    let error = (a - b).abs() / b.abs().max(1.0);
    assert!(error <= tolerance, "{a} instead of {b}");
}

#[track_caller]
fn optimum(o: &Outcome, value: f64, tolerance: f64) {
    assert_eq!(o.claim, Claim::Solved, "{o:?}");
    near(*o.level.last().expect("an objective"), value, tolerance);
}

/// Runs all of it. `tolerance`: relative, on levels and marginals.
pub fn suite(backend: &dyn Backend, settings: &Settings, tolerance: f64) {
    let solver: Solve = &|instance| {
        let mut quiet = Quiet::default();
        let task = Task::new(ProblemType::Lp, instance);
        let reply = backend.solve(&task, settings, &Budget::unlimited(&mut quiet))?;
        Ok(reply.outcome)
    };
    textbook(solver, tolerance);
    signs(solver, tolerance);
    shapes(solver, tolerance);
    degenerate(solver, tolerance);
    infeasible(solver);
    unbounded(solver);
    refused(solver);
    tells(backend, settings);
}

/// A clock that goes on by a second with every look, and what was told.
#[derive(Default)]
struct Told {
    clock: f64,
    methods: Vec<&'static str>,
}

impl Monitor for Told {
    fn log(&mut self, _: &str) {}
    fn interrupted(&mut self) -> bool {
        false
    }
    fn seconds(&mut self) -> f64 {
        self.clock += 1.0;
        self.clock
    }
    fn progress(&mut self, progress: &Progress) {
        self.methods.push(progress.method);
    }
}

/// Who waits sees what the method does.
fn tells(backend: &dyn Backend, settings: &Settings) {
    let rows = [(vec![1., 1.], Less, 4.), (vec![1., 3.], Less, 6.)];
    let instance = linear(Sense::Maximize, &[3., 2.], &[(0., INF); 2], &rows);
    let mut told = Told::default();
    let task = Task::new(ProblemType::Lp, &instance);
    let reply = backend.solve(&task, settings, &Budget::unlimited(&mut told));
    reply.expect("a valid instance");
    assert!(!told.methods.is_empty());
}

fn textbook(solver: Solve, tol: f64) {
    // Dantzig's transport problem, rounded: 2 plants, 3 markets.
    let cost = [0.225, 0.153, 0.162, 0.225, 0.162, 0.126];
    let rows = [
        (vec![1., 1., 1., 0., 0., 0.], Less, 350.),
        (vec![0., 0., 0., 1., 1., 1.], Less, 600.),
        (vec![1., 0., 0., 1., 0., 0.], Greater, 325.),
        (vec![0., 1., 0., 0., 1., 0.], Greater, 300.),
        (vec![0., 0., 1., 0., 0., 1.], Greater, 275.),
    ];
    let instance = linear(Sense::Minimize, &cost, &[(0., INF); 6], &rows);
    let o = run(solver, &instance);
    optimum(&o, 153.675, tol);
    near(o.row_marginal[0], 0.0, 10.0 * tol);
    near(o.row_marginal[2], 0.225, tol);
    near(o.row_marginal[3], 0.153, tol);
    near(o.row_marginal[4], 0.126, tol);
    near(o.row_marginal[5], 1.0, tol);
    near(o.column_marginal[2], 0.036, tol);
    near(o.column_marginal[6], 0.0, tol);
    // Klee–Minty, n = 8.
    let n = 8;
    let rows: Vec<Row> = (0..n)
        .map(|i| {
            let mut a = vec![0.0; n];
            for (j, a) in a.iter_mut().enumerate().take(i) {
                *a = 2f64.powi((i - j + 1) as i32);
            }
            a[i] = 1.0;
            (a, Less, 5f64.powi(i as i32 + 1))
        })
        .collect();
    let cost: Vec<f64> = (0..n).map(|j| 2f64.powi((n - 1 - j) as i32)).collect();
    let instance = linear(Sense::Maximize, &cost, &vec![(0., INF); n], &rows);
    optimum(&run(solver, &instance), 5f64.powi(n as i32), tol);
}

/// Signs of marginals as GAMS gives them, for min and max alike.
fn signs(solver: Solve, tol: f64) {
    let xy = vec![1., 1.];
    let rows = [(xy.clone(), Greater, 10.)];
    let instance = linear(Sense::Minimize, &[1., 2.], &[(0., 5.), (0., INF)], &rows);
    let o = run(solver, &instance);
    optimum(&o, 15.0, tol);
    near(o.row_marginal[0], 2.0, tol);
    near(o.column_marginal[0], -1.0, tol);
    near(o.row_marginal[1], 1.0, tol);

    let rows = [(xy.clone(), Less, 10.), (vec![0., 1.], Greater, 4.)];
    let bounds = [(0., INF), (0., INF)];
    let instance = linear(Sense::Maximize, &[3., 2.], &bounds, &rows);
    let o = run(solver, &instance);
    optimum(&o, 26.0, tol);
    near(o.row_marginal[0], 3.0, tol);
    near(o.row_marginal[1], -1.0, tol);

    let rows = [(xy.clone(), Less, 10.)];
    let instance = linear(Sense::Maximize, &[3., 2.], &[(0., 8.), (0., INF)], &rows);
    let o = run(solver, &instance);
    optimum(&o, 28.0, tol);
    near(o.row_marginal[0], 2.0, tol);
    near(o.column_marginal[0], 1.0, tol);

    let instance = linear(Sense::Minimize, &[3., 2.], &[(0., INF), (0., INF)], &[]);
    let o = run(solver, &instance);
    optimum(&o, 0.0, tol);
    near(o.column_marginal[0], 3.0, tol);
    near(o.column_marginal[1], 2.0, tol);
}

fn shapes(solver: Solve, tol: f64) {
    // Fixed column, free column, range by two rows, =n= row, empty rows that hold.
    let rows = [
        (vec![1., 1., 1.], Greater, -2.),
        (vec![1., 1., 1.], Less, 3.),
        (vec![5., 0., 1.], Free, 77.),
        (vec![0., 0., 0.], Less, 1.),
        (vec![0., 1., -1.], Equal, 0.),
    ];
    let bounds = [(2., 2.), (-INF, INF), (-INF, 4.)];
    let instance = linear(Sense::Minimize, &[7., 1., 1.], &bounds, &rows);
    let o = run(solver, &instance);
    optimum(&o, 10.0, tol);
    near(o.level[1], -2.0, tol);
    near(o.column_marginal[0], 6.0, tol);
    near(o.row_marginal[0], 1.0, tol);
    near(o.row_marginal[2], 0.0, 0.0);
    near(o.row_marginal[3], 0.0, 0.0);
    // A negative variable, an upper bound only.
    let rows = [(vec![1.], Greater, -9.)];
    let instance = linear(Sense::Minimize, &[1.], &[(-INF, 0.)], &rows);
    optimum(&run(solver, &instance), -9.0, tol);
    // All columns fixed.
    let rows = [(vec![1., 1.], Less, 3.)];
    let instance = linear(Sense::Maximize, &[1., 1.], &[(1., 1.), (2., 2.)], &rows);
    optimum(&run(solver, &instance), 3.0, tol);
    // Nothing at all but the objective.
    let instance = linear(Sense::Minimize, &[], &[], &[]);
    optimum(&run(solver, &instance), 0.0, tol);
    // No rows: the objective variable itself is bounded.
    let mut bare = Instance {
        columns: columns(&[(-1.0, 6.0)]),
        ..Instance::default()
    };
    bare.set_objective(0, Sense::Maximize);
    bare.matrix.start.push(0);
    let o = run(solver, &bare);
    optimum(&o, 6.0, tol);
    near(o.column_marginal[0], 1.0, tol);
    // The objective variable bounded, and used by two rows.
    let mut shared = linear(Sense::Maximize, &[1., 1.], &[(0., 8.), (0., INF)], &[]);
    push_row(&mut shared, &[0., 1., 0.], Less, 5.);
    push_row(&mut shared, &[0., 1., 1.], Less, 14.);
    let o = run(solver, &shared);
    assert_eq!(o.claim, Claim::Solved);
    near(o.level[2], 11.0, tol);
    shared.columns.upper[2] = 9.0;
    let o = run(solver, &shared);
    assert_eq!(o.claim, Claim::Solved);
    near(o.level[2], 9.0, tol);
    near(o.column_marginal[2], 1.0, tol);
    // A constant in the objective row, and its coefficient not 1: 2z - x = 6.
    let mut scaled = linear(Sense::Minimize, &[0.5], &[(4., INF)], &[]);
    scaled.matrix.value = vec![-1.0, 2.0];
    scaled.rows.rhs[0] = 6.0;
    let o = run(solver, &scaled);
    optimum(&o, 5.0, tol);
    near(o.row_marginal[0], 0.5, tol);
    near(o.column_marginal[0], 0.5, tol);
    // Units far apart: the same program in millionths and in thousands of millions.
    for unit in [1e-6, 1.0, 1e9] {
        let rows = [(vec![1., 1.], Greater, 10. * unit)];
        let bounds = [(0., 5. * unit), (0., INF)];
        let o = run(solver, &linear(Sense::Minimize, &[1., 2.], &bounds, &rows));
        assert_eq!(o.claim, Claim::Solved);
        near(o.level[2] / unit, 15.0, tol);
    }
}

fn degenerate(solver: Solve, tol: f64) {
    // Beale's example, on which textbook simplex cycles.
    let rows = [
        (vec![0.25, -60., -0.04, 9.], Less, 0.),
        (vec![0.5, -90., -0.02, 3.], Less, 0.),
        (vec![0., 0., 1., 0.], Less, 1.),
    ];
    let cost = [-0.75, 150., -0.02, 6.];
    let instance = linear(Sense::Minimize, &cost, &[(0., INF); 4], &rows);
    optimum(&run(solver, &instance), -0.05, tol);
    // Redundant equations: the matrix has dependent rows.
    let rows = [
        (vec![1., 1., 0.], Equal, 2.),
        (vec![0., 1., 1.], Equal, 2.),
        (vec![1., 2., 1.], Equal, 4.),
    ];
    let instance = linear(Sense::Minimize, &[1., 1., 3.], &[(0., INF); 3], &rows);
    optimum(&run(solver, &instance), 2.0, tol);
    // An assignment problem: every basis is highly degenerate.
    let n = 6;
    let mut rows = Vec::new();
    for i in 0..n {
        let mut a = vec![0.0; n * n];
        let mut b = vec![0.0; n * n];
        for j in 0..n {
            a[i * n + j] = 1.0;
            b[j * n + i] = 1.0;
        }
        rows.push((a, Equal, 1.0));
        rows.push((b, Equal, 1.0));
    }
    let cost: Vec<f64> = (0..n * n)
        .map(|k| ((k * 7 + k / n * 3) % 11) as f64)
        .collect();
    let instance = linear(Sense::Minimize, &cost, &vec![(0., INF); n * n], &rows);
    let o = run(solver, &instance);
    assert_eq!(o.claim, Claim::Solved);
    let value = *o.level.last().expect("an objective");
    near(value, value.round(), tol);
}

/// Whether `ray` proves that no x within bounds satisfies the rows.
fn proves_infeasible(instance: &Instance, y: &[f64]) -> bool {
    let mut reach = vec![0.0; instance.column_count()];
    let mut needed = 0.0;
    for (i, &y) in y.iter().enumerate() {
        let wrong = match instance.rows.relation[i] {
            Greater => y < -1e-9,
            Less => y > 1e-9,
            Equal => false,
            Free => y.abs() > 1e-9,
        };
        if wrong {
            return false;
        }
        needed += y * instance.rows.rhs[i];
        instance.matrix.row(i).for_each(|(j, a)| reach[j] += y * a);
    }
    let mut most = 0.0;
    for (j, &r) in reach.iter().enumerate() {
        if r.abs() > 1e-9 {
            most += r * if r > 0.0 {
                instance.columns.upper[j]
            } else {
                instance.columns.lower[j]
            };
        }
    }
    most < needed
}

fn infeasible(solver: Solve) {
    let cases = [
        linear(
            Sense::Minimize,
            &[1., 1.],
            &[(0., INF); 2],
            &[(vec![1., 1.], Greater, 5.), (vec![1., 1.], Less, 4.)],
        ),
        linear(
            Sense::Maximize,
            &[1., 0.],
            &[(0., 1.), (0., 1.)],
            &[(vec![1., 1.], Equal, 3.)],
        ),
        linear(
            Sense::Minimize,
            &[1., 1., 1.],
            &[(-INF, INF); 3],
            &[
                (vec![1., 1., 0.], Equal, 1.),
                (vec![0., 1., 1.], Equal, 1.),
                (vec![1., 2., 1.], Equal, 3.),
            ],
        ),
        // An empty row that cannot hold; all columns fixed.
        linear(
            Sense::Minimize,
            &[1.],
            &[(0., INF)],
            &[(vec![0.], Greater, 1.)],
        ),
        linear(Sense::Minimize, &[1.], &[(2., 2.)], &[(vec![1.], Less, 1.)]),
        // Infeasible and with an unbounded objective.
        linear(
            Sense::Maximize,
            &[0., 1.],
            &[(0., INF); 2],
            &[(vec![1., 0.], Less, -1.)],
        ),
    ];
    for (k, instance) in cases.iter().enumerate() {
        let o = run(solver, instance);
        assert_eq!(o.claim, Claim::Infeasible, "case {k}: {o:?}");
        assert!(proves_infeasible(instance, &o.ray), "case {k}: {o:?}");
    }
}

fn unbounded(solver: Solve) {
    let cases = [
        linear(
            Sense::Maximize,
            &[1., 1.],
            &[(0., INF); 2],
            &[(vec![1., -1.], Less, 4.)],
        ),
        linear(Sense::Minimize, &[1.], &[(-INF, INF)], &[]),
        linear(Sense::Minimize, &[1., 0.], &[(-INF, 3.), (0., 1.)], &[]),
        linear(
            Sense::Minimize,
            &[1., -1.],
            &[(-INF, INF), (0., INF)],
            &[(vec![1., 1.], Equal, 2.)],
        ),
    ];
    for (k, instance) in cases.iter().enumerate() {
        let o = run(solver, instance);
        assert_eq!(o.claim, Claim::Unbounded, "case {k}: {o:?}");
        let sense = instance.objective.expect("an objective").sense;
        let gain = *o.ray.last().expect("a direction");
        assert!(
            if sense == Sense::Maximize {
                gain > 0.
            } else {
                gain < 0.
            },
            "case {k}: {o:?}"
        );
        let size = o.ray.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        for j in 0..instance.column_count() {
            let wrong = (instance.columns.lower[j].is_finite() && o.ray[j] < -1e-8 * size)
                || (instance.columns.upper[j].is_finite() && o.ray[j] > 1e-8 * size);
            assert!(!wrong, "case {k}: {o:?}");
        }
        for i in 0..instance.row_count() {
            let move_: f64 = instance.matrix.row(i).map(|(j, a)| a * o.ray[j]).sum();
            let wrong = match instance.rows.relation[i] {
                Equal => move_.abs(),
                Greater => -move_,
                Less => move_,
                Free => 0.0,
            };
            assert!(wrong <= 1e-8 * size, "case {k} row {i}: {o:?}");
        }
    }
}

fn refused(solver: Solve) {
    let refuse = |instance: &Instance| solver(instance).expect_err("an invalid instance");
    let mut crossed = linear(Sense::Minimize, &[1., 1.], &[(0., 1.), (3., 2.)], &[]);
    assert_eq!(refuse(&crossed).column, Some(1));
    crossed.columns.upper[1] = f64::NAN;
    assert_eq!(refuse(&crossed).column, Some(1));
    crossed.columns.upper[1] = 4.0;
    crossed.rows.rhs[0] = f64::INFINITY;
    assert_eq!(refuse(&crossed).row, Some(0));
    crossed.rows.rhs[0] = 0.0;
    crossed.matrix.value[0] = f64::NAN;
    assert_eq!(refuse(&crossed).row, Some(0));
}
