//! Clarabel on a scaled [`Problem`]: quadratic programs, and linear ones that [`super::barrier`] does not solve, as those without a solution.
//!
//! Clarabel solves `min ½xᵀPx + qᵀx, Ax + s = b, s ∈ K` with multipliers z ∈ K*, Px + q + Aᵀz = 0. Here
//! P = 0 for linear programs, and K is a zero cone (equations), a nonnegative orthant (sides of rows, then
//! bounds), and the cones of a conic program; fixed columns are equations. With y the derivative of the optimum with
//! respect to a row's side: y = −z for an equation and an upper side, +z for a lower side; likewise for d.
//!
//! Clarabel trusts its input: a problem comes from [`super::form`], which has checked it.

#[cfg(feature = "system")]
use std::sync::{Mutex, mpsc};

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultInfo, DefaultSettings, DefaultSolution, DefaultSolver, ExponentialConeT, IPSolver,
    NonnegativeConeT, PowerConeT, SecondOrderConeT, SolverStatus, SupportedConeT, ZeroConeT,
};

use super::Ended;
use super::form::{Point, Problem, Sparse};
use crate::solve::budget::Size;
use crate::solve::factor_size::symmetric_size;
use crate::solve::{Budget, Progress, Stop};

/// Whether to stop: asked in each iteration, with how far the method has come.
type Question = Box<dyn FnMut(Progress) -> bool + Send + Sync>;

/// What one run gave.
#[derive(Debug)]
pub struct Run {
    /// Last iterate; for a proof of infeasibility or unboundedness see `ended`.
    pub point: Point,
    /// How it ended.
    pub ended: Ended,
    /// Iterations.
    pub iterations: u64,
    /// Clarabel met its own tolerance only in a reduced form.
    pub almost: bool,
}

/// `constant + Σ a_j x_j`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Affine {
    /// The constant.
    pub constant: f64,
    /// Columns and coefficients.
    pub terms: Vec<(u32, f64)>,
}

impl Affine {
    /// Its value.
    pub fn value(&self, x: &[f64]) -> f64 {
        let terms = self.terms.iter().map(|&(j, a)| a * x[j as usize]);
        self.constant + terms.sum::<f64>()
    }
}

/// The cones of Clarabel that a program's nonlinear rows become.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum ConeKind {
    /// `e₀ ≥ ‖(e₁, …)‖₂`.
    SecondOrder,
    /// `e₁ exp(e₀/e₁) ≤ e₂`, e₁ > 0.
    Exponential,
    /// `e₀^p e₁^(1−p) ≥ |e₂|`, e₀, e₁ ≥ 0.
    Power(f64),
}

/// Affine expressions that are to lie in a cone.
#[derive(Clone, Debug)]
pub struct Cone {
    /// Which cone.
    pub kind: ConeKind,
    /// Its coordinates.
    pub expressions: Vec<Affine>,
}

/// One inequality or equation of Clarabel's.
#[derive(Clone, Copy)]
enum Source {
    /// Row i, `A x = U`.
    Equation(usize),
    /// Column j, `x = u`.
    Fixed(usize),
    /// Row i, `A x ≤ U`.
    RowUpper(usize),
    /// Row i, `−A x ≤ −L`.
    RowLower(usize),
    /// Column j, `x ≤ u`.
    Upper(usize),
    /// Column j, `−x ≤ −l`.
    Lower(usize),
}

/// Runs Clarabel, on ½xᵀPx + cᵀx where the upper triangle of a positive semidefinite P is given by
/// columns. The budget is asked every few milliseconds; a factorisation that it does not afford is not begun.
pub fn solve(p: &Problem, hessian: Option<&Sparse>, tolerance: f64, budget: &Budget) -> Run {
    solve_conic(p, hessian, &[], tolerance, budget).0
}

/// The same with cones; also the dual point of each cone's coordinates, one after the other.
pub fn solve_conic(
    p: &Problem,
    hessian: Option<&Sparse>,
    conic: &[Cone],
    tolerance: f64,
    budget: &Budget,
) -> (Run, Vec<f64>) {
    let n = p.n();
    let sources = sources(p);
    let is_equation = |s: &&Source| matches!(s, Source::Equation(_) | Source::Fixed(_));
    let equations = sources.iter().take_while(is_equation).count();
    let (mut matrix, mut b) = stack(p, &sources);
    for e in conic.iter().flat_map(|c| &c.expressions) {
        matrix.push(e.terms.iter().map(|&(j, a)| (j as usize, -a)));
        b.push(e.constant);
    }
    let a = compressed(b.len(), matrix.transpose(n));
    let linear = [
        ZeroConeT(equations),
        NonnegativeConeT(sources.len() - equations),
    ];
    let curved = conic.iter().map(|c| match c.kind {
        ConeKind::SecondOrder => SecondOrderConeT(c.expressions.len()),
        ConeKind::Exponential => ExponentialConeT(),
        ConeKind::Power(p) => PowerConeT(p),
    });
    let cones: Vec<SupportedConeT<f64>> = linear
        .into_iter()
        .filter(|c| !matches!(c, ZeroConeT(0) | NonnegativeConeT(0)))
        .chain(curved)
        .collect();
    let settings = settings(tolerance, budget);
    let mut point = Point {
        x: (0..n).map(|j| p.at_bound(j)).collect(),
        y: vec![0.0; p.m()],
        d: vec![0.0; n],
    };
    let without = |point, ended, iterations| {
        let run = Run {
            point,
            ended,
            iterations,
            almost: false,
        };
        (run, vec![0.0; b.len() - sources.len()])
    };
    if let Err(why) = budget.affords(|| kkt_size(&a, hessian)) {
        budget.log(format!("clarabel: {why}"));
        return without(point, Ended::TooLarge(why), 0);
    }
    let objective = match hessian {
        None => CscMatrix::zeros((n, n)),
        Some(h) => compressed(n, h.clone()),
    };
    let run = |mut stop: Question| {
        let mut solver = DefaultSolver::new(&objective, &p.cost, &a, &b, &cones, settings).ok()?;
        solver.set_termination_callback(move |info: &DefaultInfo<f64>| {
            stop(Progress {
                method: "interior point",
                iteration: u64::from(info.iterations),
                primal: Some(info.res_primal),
                dual: Some(info.res_dual),
                ..Progress::default()
            })
        });
        solver.solve();
        Some(solver.solution)
    };
    let solution = asking(budget, run);
    let Some(solution) = solution else {
        return without(point, Ended::Failed, 0);
    };
    let iterations = u64::from(solution.iterations);
    if !solution.x.iter().chain(&solution.z).all(|v| v.is_finite()) {
        return without(point, Ended::Failed, iterations);
    }
    for j in (0..n).filter(|&j| p.lower[j] < p.upper[j]) {
        point.x[j] = solution.x[j];
    }
    point.y = row_multipliers(&sources, &solution.z, p.m());
    let (ended, almost) = ended(solution.status, &point, p, budget);
    let duals = solution.z[sources.len()..].to_vec();
    point.d = reduced_costs(p, hessian, &point);
    let expressions = conic.iter().flat_map(|c| &c.expressions);
    for (e, dual) in expressions.zip(&duals) {
        for &(j, a) in &e.terms {
            point.d[j as usize] -= a * dual;
        }
    }
    let run = Run {
        point,
        ended,
        iterations,
        almost,
    };
    (run, duals)
}

/// Multipliers of the rows from those of the inequalities and equations.
fn row_multipliers(sources: &[Source], z: &[f64], rows: usize) -> Vec<f64> {
    let mut y = vec![0.0; rows];
    for (&source, &z) in sources.iter().zip(z) {
        match source {
            Source::Equation(i) | Source::RowUpper(i) => y[i] -= z,
            Source::RowLower(i) => y[i] += z,
            Source::Fixed(_) | Source::Upper(_) | Source::Lower(_) => {}
        }
    }
    y
}

/// A matrix of so many rows by columns, as Clarabel takes it.
fn compressed(rows: usize, columns: Sparse) -> CscMatrix<f64> {
    let index = columns.index.iter().map(|&i| i as usize).collect();
    CscMatrix::new(rows, columns.lines(), columns.start, index, columns.value)
}

/// What is asked of Clarabel.
fn settings(tolerance: f64, budget: &Budget) -> DefaultSettings<f64> {
    DefaultSettings {
        tol_gap_abs: tolerance,
        tol_gap_rel: tolerance,
        tol_feas: tolerance,
        verbose: false,
        max_iter: u32::try_from(budget.iterations_left().min(500)).unwrap_or(500),
        time_limit: budget.seconds_left(),
        direct_solve_method: "auto".into(),
        max_threads: 1,
        // Clarabel's own presolve drops rows with |b| ≥ 1e20; infinite sides are not sent.
        presolve_enable: false,
        ..DefaultSettings::default()
    }
}

/// Runs Clarabel on a thread of its own where there are threads: its callback must own what it sees, so this thread asks the
/// budget for it, once in each iteration.
fn asking(
    budget: &Budget,
    run: impl FnOnce(Question) -> Option<DefaultSolution<f64>> + Send,
) -> Option<DefaultSolution<f64>> {
    #[cfg(not(feature = "system"))]
    {
        let is_over = budget.is_over();
        run(Box::new(move |_| is_over))
    }
    #[cfg(feature = "system")]
    std::thread::scope(|scope| {
        let (question, questions) = mpsc::channel();
        let (answer, answers) = mpsc::channel();
        let answers = Mutex::new(answers);
        let reply = move || answers.lock().ok()?.recv().ok();
        let stop = move |p| question.send(p).is_err() || reply().unwrap_or(true);
        let worker = scope.spawn(move || run(Box::new(stop)));
        for progress in questions {
            budget.tell(progress);
            let _ = answer.send(budget.is_over());
        }
        worker.join().ok().flatten()
    })
}

/// What Clarabel's status means, and whether it is nearly so only.
fn ended(status: SolverStatus, point: &Point, p: &Problem, budget: &Budget) -> (Ended, bool) {
    match status {
        SolverStatus::Solved => (Ended::Solved, false),
        SolverStatus::AlmostSolved => (Ended::Solved, true),
        SolverStatus::PrimalInfeasible => (Ended::Infeasible(point.y.clone()), false),
        SolverStatus::AlmostPrimalInfeasible => (Ended::Infeasible(point.y.clone()), true),
        SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => {
            let moves = |j: usize| p.lower[j] < p.upper[j];
            let ray = point.x.iter().enumerate();
            let ray = ray.map(|(j, &x)| if moves(j) { x } else { 0.0 }).collect();
            let almost = status == SolverStatus::AlmostDualInfeasible;
            (Ended::Unbounded(ray), almost)
        }
        SolverStatus::MaxIterations => (Ended::Iterations, false),
        SolverStatus::MaxTime => (Ended::Time, false),
        SolverStatus::CallbackTerminated => {
            let stop = budget.stopped().unwrap_or(Stop::Interrupted);
            (Ended::from(stop), false)
        }
        SolverStatus::Unsolved
        | SolverStatus::NumericalError
        | SolverStatus::InsufficientProgress => (Ended::Failed, false),
    }
}

/// d = c + Px − Aᵀy.
fn reduced_costs(p: &Problem, hessian: Option<&Sparse>, point: &Point) -> Vec<f64> {
    let price = |j: usize| p.columns.line(j).map(|(i, a)| a * point.y[i]).sum::<f64>();
    let mut d: Vec<f64> = (0..p.n()).map(|j| p.cost[j] - price(j)).collect();
    for (j, i, v) in hessian.into_iter().flat_map(entries) {
        d[j] += v * point.x[i];
        if i != j {
            d[i] += v * point.x[j];
        }
    }
    d
}

/// What the factors of Clarabel's KKT matrix [P Aᵀ; A −I] cost.
fn kkt_size(a: &CscMatrix<f64>, hessian: Option<&Sparse>) -> Size {
    let constraint = (0..a.n).flat_map(|j| {
        let rows = &a.rowval[a.colptr[j]..a.colptr[j + 1]];
        rows.iter().map(move |&i| (a.n + i, j))
    });
    let objective = hessian.into_iter().flat_map(entries);
    let all = constraint.chain(objective.map(|(j, i, _)| (i, j)));
    symmetric_size("the factor of the KKT matrix", a.n + a.m, all)
}

fn entries(h: &Sparse) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
    (0..h.lines()).flat_map(|j| h.line(j).map(move |(i, v)| (j, i, v)))
}

/// The constraints in the order of Clarabel's cones.
fn sources(p: &Problem) -> Vec<Source> {
    let fixed = |j: &usize| p.lower[*j] == p.upper[*j];
    let mut s: Vec<Source> = (0..p.m())
        .filter(|&i| p.row_lower[i] == p.row_upper[i])
        .map(Source::Equation)
        .chain((0..p.n()).filter(fixed).map(Source::Fixed))
        .collect();
    for i in (0..p.m()).filter(|&i| p.row_lower[i] != p.row_upper[i]) {
        if p.row_upper[i].is_finite() {
            s.push(Source::RowUpper(i));
        }
        if p.row_lower[i].is_finite() {
            s.push(Source::RowLower(i));
        }
    }
    for j in (0..p.n()).filter(|j| !fixed(j)) {
        if p.upper[j].is_finite() {
            s.push(Source::Upper(j));
        }
        if p.lower[j].is_finite() {
            s.push(Source::Lower(j));
        }
    }
    s
}

/// Rows and right-hand sides of Clarabel's constraints.
fn stack(p: &Problem, sources: &[Source]) -> (Sparse, Vec<f64>) {
    let mut matrix = Sparse::default();
    let mut b = Vec::with_capacity(sources.len());
    for &source in sources {
        let (sign, side) = match source {
            Source::Equation(i) | Source::RowUpper(i) => (1.0, p.row_upper[i]),
            Source::RowLower(i) => (-1.0, p.row_lower[i]),
            Source::Fixed(j) | Source::Upper(j) => (1.0, p.upper[j]),
            Source::Lower(j) => (-1.0, p.lower[j]),
        };
        b.push(sign * side);
        match source {
            Source::Equation(i) | Source::RowUpper(i) | Source::RowLower(i) => {
                matrix.push(p.rows.line(i).map(|(j, v)| (j, sign * v)));
            }
            Source::Fixed(j) | Source::Upper(j) | Source::Lower(j) => matrix.push([(j, sign)]),
        }
    }
    (matrix, b)
}
