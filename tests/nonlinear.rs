//! One suite for all solvers of nonlinear programs: hand-built instances with known answers, each run
//! with every solver of the build. What is checked is what is reported, not what the solver claims.

use ModelStatus::*;
use bmod::model::instance::*;
use bmod::model::problem_type::ProblemType;
use bmod::solve::answer::{Answer, answer};
use bmod::solve::nlp::interior_point_solvers;
use bmod::solve::{
    Budget, Limits, ModelStatus, Monitor, Quiet, Settings, SolveError, SolverStatus,
};

/// Builds instances; column 0 is the objective.
struct Model(Instance);

const FREE: (f64, f64) = (NEG_INF, INF);

impl Model {
    fn new(sense: Sense) -> Self {
        let mut m = Self(Instance {
            objective: Some(Objective { column: 0, sense }),
            matrix: SparseRows {
                start: vec![0],
                ..SparseRows::default()
            },
            ..Instance::default()
        });
        m.var(FREE, 0.0);
        m
    }

    fn var(&mut self, bounds: (f64, f64), level: f64) -> u32 {
        let c = &mut self.0.columns;
        c.lower.push(bounds.0);
        c.upper.push(bounds.1);
        c.level.push(level);
        c.marginal.push(0.0);
        c.scale.push(1.0);
        c.kind.push(ColumnKind::Continuous);
        c.lower.len() as u32 - 1
    }

    /// linear + Σ terms (coefficient, program over columns) relation rhs. A program's `Var` is a column.
    fn row(
        &mut self,
        linear: &[(u32, f64)],
        terms: &[(f64, &[Op])],
        relation: Relation,
        rhs: f64,
    ) -> usize {
        let i = self.0.rows.rhs.len();
        self.0.rows.relation.push(relation);
        self.0.rows.rhs.push(rhs);
        self.0.rows.marginal.push(0.0);
        self.0.rows.scale.push(1.0);
        let mut linear = linear.to_vec();
        linear.sort_by_key(|e| e.0);
        for (j, a) in linear {
            self.0.matrix.column.push(j);
            self.0.matrix.value.push(a);
        }
        self.0.matrix.start.push(self.0.matrix.column.len());
        for &(coef, ops) in terms {
            let mut columns = Vec::new();
            let ops: Vec<Op> = ops
                .iter()
                .map(|op| match *op {
                    Op::Var(j) => {
                        let slot = columns.iter().position(|&c| c == j).unwrap_or_else(|| {
                            columns.push(j);
                            columns.len() - 1
                        });
                        Op::Var(slot as u32)
                    }
                    other => other,
                })
                .collect();
            self.0.nonlinear.push(KernelTerms {
                kernel: Kernel {
                    ops,
                    variables: columns.len() as u32,
                    constants: 0,
                },
                row: vec![i as u32],
                coef: vec![coef],
                columns,
                constants: vec![],
            });
        }
        i
    }

    /// z − linear − terms = rhs
    fn objective(&mut self, linear: &[(u32, f64)], terms: &[(f64, &[Op])], constant: f64) -> usize {
        let mut l = vec![(0, 1.0)];
        l.extend(linear.iter().map(|&(j, a)| (j, -a)));
        let t: Vec<(f64, &[Op])> = terms.iter().map(|&(c, ops)| (-c, ops)).collect();
        self.row(&l, &t, Relation::Equal, constant)
    }
}

fn run(solver: &str, instance: &Instance) -> Result<Answer, SolveError> {
    answer(
        ProblemType::Nlp,
        Some(solver),
        instance,
        &Settings::default(),
        &Budget::unlimited(&mut Quiet::default()),
    )
}

/// Every solver must report this status; the objective, if it is given, to 1e-7.
fn expect(m: &Model, status: ModelStatus, objective: Option<f64>) -> Vec<Answer> {
    let mut all = Vec::new();
    for p in interior_point_solvers() {
        let a = run(p.about().name, &m.0)
            .unwrap_or_else(|e| panic!("{}: {}", p.about().name, e.message));
        let z = a.outcome.level[0];
        assert_eq!(
            a.status,
            status,
            "{}: z = {z}, {:?}",
            p.about().name,
            a.residuals
        );
        if let Some(want) = objective {
            assert!(
                (z - want).abs() <= 1e-7 * want.abs().max(1.0),
                "{}: {z} instead of {want}",
                p.about().name
            );
        }
        if matches!(status, Optimal | LocallyOptimal) {
            assert!(a.residuals.primal_relative <= 1e-6 && a.residuals.dual_relative <= 1e-6);
            assert_eq!(a.outcome.status, SolverStatus::NormalCompletion);
        }
        all.push(a);
    }
    assert!(!all.is_empty());
    all
}

fn near(a: f64, b: f64) {
    assert!(
        (a - b).abs() <= 1e-6 * b.abs().max(1.0),
        "{a} instead of {b}"
    );
}

use Op::{Call, Divide, Negate, PowerInt, Var};

const PLUS: Op = Op::Add(2);
const TIMES: Op = Op::Multiply(2);

fn hs71() -> Model {
    let mut m = Model::new(Sense::Minimize);
    let x: Vec<u32> = [1.0, 5.0, 5.0, 1.0]
        .iter()
        .map(|&l| m.var((1.0, 5.0), l))
        .collect();
    let v = |k: usize| Var(x[k]);
    m.objective(
        &[(x[2], 1.0)],
        &[(
            1.0,
            &[v(0), v(3), TIMES, v(0), v(1), PLUS, v(2), PLUS, TIMES],
        )],
        0.0,
    );
    m.row(
        &[],
        &[(1.0, &[v(0), v(1), TIMES, v(2), TIMES, v(3), TIMES])],
        Relation::Greater,
        25.0,
    );
    let squares: Vec<[Op; 2]> = (0..4).map(|k| [v(k), PowerInt(2)]).collect();
    let terms: Vec<(f64, &[Op])> = squares.iter().map(|s| (1.0, &s[..])).collect();
    m.row(&[], &terms, Relation::Equal, 40.0);
    m
}

#[test]
fn hock_schittkowski_71() {
    for a in expect(&hs71(), LocallyOptimal, Some(17.014_017_289_156_33)) {
        near(a.outcome.level[1], 1.0);
        near(a.outcome.level[2], 4.742_999_643_60);
        near(a.outcome.level[3], 3.821_149_978_85);
        near(a.outcome.level[4], 1.379_408_293_17);
        // GAMS's signs: a tighter product costs, the reduced cost of x1 at its lower bound is positive
        near(a.outcome.row_marginal[0], 1.0);
        near(a.outcome.row_marginal[1], 0.552_293_66);
        near(a.outcome.row_marginal[2], -0.161_468_564);
        near(a.outcome.column_marginal[1], 1.087_871_2);
        assert_eq!(a.outcome.column_marginal[2], 0.0);
        assert_eq!(a.outcome.level[1], 1.0, "on the bound exactly");
    }
}

/// The same as a maximum of −f: the same point, all marginals with the other sign.
#[test]
fn maximum_has_marginals_of_the_other_sign() {
    let mut m = hs71();
    let c = m.0.matrix.start[0]..m.0.matrix.start[1];
    for k in c {
        if m.0.matrix.column[k] != 0 {
            m.0.matrix.value[k] *= -1.0;
        }
    }
    m.0.nonlinear[0].coef[0] *= -1.0;
    m.0.objective = Some(Objective {
        column: 0,
        sense: Sense::Maximize,
    });
    for a in expect(&m, LocallyOptimal, Some(-17.014_017_289_156_33)) {
        near(a.outcome.row_marginal[0], 1.0);
        near(a.outcome.row_marginal[1], -0.552_293_66);
        near(a.outcome.row_marginal[2], 0.161_468_564);
        near(a.outcome.column_marginal[1], -1.087_871_2);
    }
}

/// Section 9 of the observed facts: linear examples, sent through the nonlinear solvers by a term that
/// vanishes at the solution.
#[test]
fn marginals_have_the_signs_of_gams() {
    // min x + 2y + (x − 5)²(y − 5)²·0 …: the nonlinear term is sqr(x + y − 10), 0 at the solution
    let mut m = Model::new(Sense::Minimize);
    let x = m.var((0.0, 5.0), 0.0);
    let y = m.var((0.0, INF), 0.0);
    let square: &[Op] = &[Var(x), Var(y), PLUS, PowerInt(2)];
    // (x + y)² − 20 (x + y) + 100
    m.objective(&[(x, 1.0 - 20.0), (y, 2.0 - 20.0)], &[(1.0, square)], 100.0);
    m.row(&[(x, 1.0), (y, 1.0)], &[], Relation::Greater, 10.0);
    for a in expect(&m, LocallyOptimal, Some(15.0)) {
        near(a.outcome.row_marginal[1], 2.0);
        near(a.outcome.column_marginal[x as usize], -1.0);
        assert_eq!(a.outcome.column_marginal[0], 0.0);
        near(a.outcome.row_marginal[0], 1.0);
    }
}

#[test]
fn rosenbrock() {
    let mut m = Model::new(Sense::Minimize);
    let (x, y) = (m.var(FREE, -1.2), m.var(FREE, 1.0));
    m.objective(
        &[(x, -2.0)],
        &[
            (
                100.0,
                &[Var(y), Var(x), PowerInt(2), Negate, PLUS, PowerInt(2)],
            ),
            (1.0, &[Var(x), PowerInt(2)]),
        ],
        1.0,
    );
    for a in expect(&m, LocallyOptimal, Some(0.0)) {
        near(a.outcome.level[1], 1.0);
        near(a.outcome.level[2], 1.0);
    }
}

/// The trap: min x·y. The start is a saddle, and a stationary point.
#[test]
fn product_of_free_variables_is_unbounded() {
    for start in [(0.0, 0.0), (1.0, 1.0), (1.0, -1.0), (0.0, 1.0)] {
        let mut m = Model::new(Sense::Minimize);
        let (x, y) = (m.var(FREE, start.0), m.var(FREE, start.1));
        m.objective(&[], &[(1.0, &[Var(x), Var(y), TIMES])], 0.0);
        expect(&m, Unbounded, None);
    }
}

#[test]
fn maximum_of_an_exponential_is_unbounded() {
    let mut m = Model::new(Sense::Maximize);
    let x = m.var(FREE, 0.0);
    m.objective(&[], &[(1.0, &[Var(x), PowerInt(3), Var(x), PLUS])], 0.0);
    expect(&m, Unbounded, None);
}

/// max x² on [−1, 1] from 0: a stationary point that is a minimum.
#[test]
fn saddles_are_left() {
    let mut m = Model::new(Sense::Maximize);
    let x = m.var((-1.0, 1.0), 0.0);
    m.objective(&[], &[(1.0, &[Var(x), PowerInt(2)])], 0.0);
    expect(&m, LocallyOptimal, Some(1.0));
    // x·y on the unit disk from its centre
    let mut m = Model::new(Sense::Minimize);
    let (x, y) = (m.var(FREE, 0.0), m.var(FREE, 0.0));
    m.objective(&[], &[(1.0, &[Var(x), Var(y), TIMES])], 0.0);
    m.row(
        &[],
        &[(1.0, &[Var(x), PowerInt(2)]), (1.0, &[Var(y), PowerInt(2)])],
        Relation::Less,
        1.0,
    );
    expect(&m, LocallyOptimal, Some(-0.5));
}

#[test]
fn infeasible_models_are_called_infeasible() {
    // x² + y² ≤ 1, x + y ≥ 3
    let mut m = Model::new(Sense::Minimize);
    let (x, y) = (m.var(FREE, 0.5), m.var(FREE, 0.1));
    m.objective(&[(x, 1.0)], &[], 0.0);
    m.row(
        &[],
        &[(1.0, &[Var(x), PowerInt(2)]), (1.0, &[Var(y), PowerInt(2)])],
        Relation::Less,
        1.0,
    );
    m.row(&[(x, 1.0), (y, 1.0)], &[], Relation::Greater, 3.0);
    expect(&m, LocallyInfeasible, None);
    // sqr(x) = −1
    let mut m = Model::new(Sense::Minimize);
    let x = m.var(FREE, 3.0);
    m.objective(&[(x, 1.0)], &[], 0.0);
    m.row(&[], &[(1.0, &[Var(x), PowerInt(2)])], Relation::Equal, -1.0);
    expect(&m, Infeasible, None);
}

#[test]
fn crossed_bounds_are_refused() {
    let mut m = Model::new(Sense::Minimize);
    let x = m.var((2.0, 1.0), 0.0);
    m.objective(&[], &[(1.0, &[Var(x), PowerInt(2)])], 0.0);
    for p in interior_point_solvers() {
        let e = run(p.about().name, &m.0).unwrap_err();
        assert_eq!(e.column, Some(x as usize));
    }
}

/// Fixed columns are numbers; their marginals come from stationarity.
#[test]
fn fixed_variables_have_marginals() {
    let mut m = Model::new(Sense::Minimize);
    let (x, y) = (m.var((2.0, 2.0), 7.0), m.var(FREE, 0.0));
    m.objective(
        &[],
        &[
            (1.0, &[Var(x), Var(y), Negate, PLUS, PowerInt(2)]),
            (1.0, &[Var(x), PowerInt(3)]),
        ],
        0.0,
    );
    m.row(&[(x, 1.0), (y, 1.0)], &[], Relation::Equal, 5.0);
    for a in expect(&m, Optimal, Some(9.0)) {
        // x is a number, and then y one: z = (2x − 5)² + x³ with y = 5 − x: dz/dx = 4(2x − 5) + 3x² = 8
        near(a.outcome.column_marginal[x as usize], 8.0);
        near(a.outcome.level[x as usize], 2.0);
    }
    // everything fixed
    let mut m = Model::new(Sense::Minimize);
    let x = m.var((3.0, 3.0), 0.0);
    m.objective(&[], &[(1.0, &[Var(x), PowerInt(2)])], 0.0);
    expect(&m, Optimal, Some(9.0));
    // everything fixed, and a row that cannot hold
    m.row(&[], &[(1.0, &[Var(x), PowerInt(2)])], Relation::Less, 8.0);
    expect(&m, Infeasible, None);
}

/// As many equations as variables, and more.
#[test]
fn square_and_overdetermined_systems() {
    let system = |extra: bool| {
        let mut m = Model::new(Sense::Minimize);
        let (x, y) = (m.var(FREE, 1.0), m.var(FREE, 1.0));
        m.objective(&[(x, 1.0), (y, 1.0)], &[], 0.0);
        m.row(
            &[],
            &[(1.0, &[Var(x), PowerInt(2)]), (1.0, &[Var(y), PowerInt(2)])],
            Relation::Equal,
            25.0,
        );
        m.row(
            &[],
            &[(1.0, &[Var(x), Var(y), TIMES])],
            Relation::Equal,
            12.0,
        );
        if extra {
            m.row(&[(x, 1.0), (y, 1.0)], &[], Relation::Equal, 7.0);
            m.row(
                &[],
                &[(1.0, &[Var(x), Var(y), PLUS, PowerInt(2)])],
                Relation::Equal,
                49.0,
            );
        }
        m
    };
    for a in expect(&system(false), LocallyOptimal, None) {
        near(a.outcome.level[0].abs(), 7.0);
    }
    expect(&system(true), LocallyOptimal, Some(7.0));
}

/// Dependent and degenerate constraints.
#[test]
fn degenerate_constraints() {
    // the same equation twice
    let mut m = Model::new(Sense::Minimize);
    let (x, y) = (m.var(FREE, 0.0), m.var(FREE, 0.0));
    m.objective(
        &[],
        &[(1.0, &[Var(x), PowerInt(2)]), (1.0, &[Var(y), PowerInt(2)])],
        0.0,
    );
    m.row(&[(x, 1.0), (y, 1.0)], &[], Relation::Equal, 2.0);
    m.row(&[(x, 2.0), (y, 2.0)], &[], Relation::Equal, 4.0);
    expect(&m, LocallyOptimal, Some(2.0));
    // an inequality pair that is an equation: no interior
    let mut m = Model::new(Sense::Minimize);
    let (x, y) = (m.var(FREE, 4.0), m.var(FREE, 0.0));
    m.objective(
        &[],
        &[(1.0, &[Var(x), PowerInt(2)]), (1.0, &[Var(y), PowerInt(2)])],
        0.0,
    );
    m.row(&[(x, 1.0), (y, 1.0)], &[], Relation::Less, 2.0);
    m.row(&[(x, 1.0), (y, 1.0)], &[], Relation::Greater, 2.0);
    expect(&m, LocallyOptimal, Some(2.0));
    // complementarity as a constraint: x y ≤ 0, x, y ≥ 0 (no constraint qualification)
    let mut m = Model::new(Sense::Minimize);
    let (x, y) = (m.var((0.0, INF), 1.0), m.var((0.0, INF), 1.0));
    m.objective(
        &[(x, -2.0), (y, -4.0)],
        &[(1.0, &[Var(x), PowerInt(2)]), (1.0, &[Var(y), PowerInt(2)])],
        5.0,
    );
    m.row(&[], &[(1.0, &[Var(x), Var(y), TIMES])], Relation::Less, 0.0);
    for p in interior_point_solvers() {
        let a = run(p.about().name, &m.0).unwrap();
        assert!(
            matches!(a.status, LocallyOptimal | Feasible),
            "{:?}",
            a.status
        );
        assert!(
            (a.outcome.level[0] - 1.0).abs() < 1e-3,
            "{}",
            a.outcome.level[0]
        );
    }
}

#[test]
fn a_start_without_value_is_explained() {
    let mut m = Model::new(Sense::Maximize);
    let (x, y) = (m.var((-1.0, 10.0), -1.0), m.var(FREE, 0.0));
    m.objective(&[(y, 1.0)], &[], 0.0);
    let row = m.row(
        &[(y, 1.0)],
        &[(-1.0, &[Var(x), Call(Function::Log, 1)])],
        Relation::Less,
        0.0,
    );
    for p in interior_point_solvers() {
        let e = run(p.about().name, &m.0).unwrap_err();
        assert_eq!(
            e.message,
            "a function cannot be evaluated at the start point: log of -1"
        );
        assert_eq!((e.row, e.column), (Some(row), Some(x as usize)));
    }
    // outside in between is fine
    m.0.columns.level[x as usize] = 0.001;
    for a in expect(&m, LocallyOptimal, Some(10f64.ln())) {
        near(a.outcome.level[x as usize], 10.0);
    }
    // a value without a derivative is no obstacle
    let mut m = Model::new(Sense::Maximize);
    let x = m.var((0.0, 4.0), 0.0);
    m.objective(&[], &[(1.0, &[Var(x), Call(Function::Sqrt, 1)])], 0.0);
    expect(&m, LocallyOptimal, Some(2.0));
}

/// The objective column in a nonlinear term, in two rows, with bounds, in an inequality: no elimination.
#[test]
fn objective_columns_that_cannot_be_eliminated() {
    let square = |m: &mut Model, x: u32, relation: Relation| {
        m.row(
            &[(0, 1.0), (x, 4.0)],
            &[(-1.0, &[Var(x), PowerInt(2)])],
            relation,
            0.0,
        );
    };
    // z ≥ x² − 4x
    let mut m = Model::new(Sense::Minimize);
    let x = m.var(FREE, 0.0);
    square(&mut m, x, Relation::Greater);
    for a in expect(&m, LocallyOptimal, Some(-4.0)) {
        near(a.outcome.row_marginal[0], 1.0);
    }
    // z = x² − 4x with z ≥ −3
    let mut m = Model::new(Sense::Minimize);
    let x = m.var(FREE, 0.0);
    square(&mut m, x, Relation::Equal);
    m.0.columns.lower[0] = -3.0;
    for a in expect(&m, LocallyOptimal, Some(-3.0)) {
        near(a.outcome.column_marginal[0], 1.0);
    }
    // z² = x − 2 … with z in a nonlinear term
    let mut m = Model::new(Sense::Maximize);
    let x = m.var((0.0, 11.0), 3.0);
    m.row(
        &[(x, -1.0)],
        &[(1.0, &[Var(0), PowerInt(2)])],
        Relation::Equal,
        -2.0,
    );
    m.0.columns.level[0] = 1.0;
    expect(&m, LocallyOptimal, Some(3.0));
}

#[test]
fn options_and_limits() {
    for p in interior_point_solvers() {
        let mut settings = Settings::default();
        let limits = Limits {
            iterations: 3,
            ..Limits::default()
        };
        let mut quiet = Quiet::default();
        let budget = Budget::new(&mut quiet, limits, false);
        let a = answer(
            ProblemType::Nlp,
            Some(p.about().name),
            &hs71().0,
            &settings,
            &budget,
        )
        .unwrap();
        assert_eq!(a.outcome.status, SolverStatus::IterationInterrupt);
        assert!(!matches!(a.status, LocallyOptimal | Optimal));
        settings.options = vec![
            ("mu_strategy".into(), "adaptive".into()),
            ("tol".into(), "1e-7".into()),
        ];
        let a = answer(
            ProblemType::Nlp,
            Some(p.about().name),
            &hs71().0,
            &settings,
            &Budget::unlimited(&mut Quiet::default()),
        )
        .unwrap();
        assert_eq!(a.status, LocallyOptimal);
    }
}

/// Started at the answer with its multipliers, a solver has little left to do.
#[test]
fn warm_start() {
    for p in interior_point_solvers() {
        let options = |pairs: &[(&str, &str)]| Settings {
            options: pairs
                .iter()
                .map(|&(k, v)| (k.to_string(), v.to_string()))
                .collect(),
            ..Settings::default()
        };
        let mut m = hs71().0;
        let cold = options(&[("nlp_search", "no")]);
        let first = answer(
            ProblemType::Nlp,
            Some(p.about().name),
            &m,
            &cold,
            &Budget::unlimited(&mut Quiet::default()),
        )
        .unwrap();
        m.columns.level = first.outcome.level;
        m.rows.marginal = first.outcome.row_marginal;
        m.columns.marginal = first.outcome.column_marginal;
        let warm = options(&[
            ("nlp_search", "no"),
            ("warm_start_init_point", "yes"),
            ("mu_init", "1e-6"),
            ("warm_start_bound_push", "1e-8"),
            ("warm_start_bound_frac", "1e-8"),
        ]);
        let second = answer(
            ProblemType::Nlp,
            Some(p.about().name),
            &m,
            &warm,
            &Budget::unlimited(&mut Quiet::default()),
        )
        .unwrap();
        assert_eq!(second.status, LocallyOptimal);
        let (a, b) = (first.outcome.iterations, second.outcome.iterations);
        assert!(b < a, "{}: {a}, then {b} iterations", p.about().name);
    }
}

#[test]
fn limit_of_time() {
    for p in interior_point_solvers() {
        let limits = Limits {
            seconds: 0.0,
            ..Limits::default()
        };
        let mut quiet = Quiet::default();
        let budget = Budget::new(&mut quiet, limits, false);
        let a = answer(
            ProblemType::Nlp,
            Some(p.about().name),
            &hs71().0,
            &Settings::default(),
            &budget,
        )
        .unwrap();
        assert_eq!(a.outcome.status, SolverStatus::ResourceInterrupt);
        assert!(!matches!(a.status, LocallyOptimal | Optimal));
    }
}

struct Impatient(u32, Vec<String>);

impl Monitor for Impatient {
    fn log(&mut self, line: &str) {
        self.1.push(line.to_string());
    }
    fn interrupted(&mut self) -> bool {
        self.0 += 1;
        self.0 > 20
    }
    fn seconds(&mut self) -> f64 {
        0.0
    }
}

#[test]
fn interruption_and_log() {
    // long enough to be interrupted: a chain
    let mut m = Model::new(Sense::Minimize);
    let x: Vec<u32> = (0..400)
        .map(|k| m.var(FREE, if k % 2 == 0 { -1.2 } else { 1.0 }))
        .collect();
    let terms: Vec<Vec<Op>> = x
        .windows(2)
        .map(|w| vec![Var(w[1]), Var(w[0]), PowerInt(2), Negate, PLUS, PowerInt(2)])
        .collect();
    let ones: Vec<Vec<Op>> = x
        .iter()
        .map(|&j| vec![Var(j), PowerInt(4), Var(j), Negate, PLUS])
        .collect();
    let all: Vec<(f64, &[Op])> = terms
        .iter()
        .map(|t| (100.0, &t[..]))
        .chain(ones.iter().map(|t| (1.0, &t[..])))
        .collect();
    m.objective(&[], &all, 0.0);
    for p in interior_point_solvers() {
        let mut monitor = Impatient(0, vec![]);
        let budget = Budget::new(&mut monitor, Limits::default(), true);
        let a = answer(
            ProblemType::Nlp,
            Some(p.about().name),
            &m.0,
            &Settings::default(),
            &budget,
        )
        .unwrap();
        assert_eq!(
            a.outcome.status,
            SolverStatus::UserInterrupt,
            "{}",
            p.about().name
        );
        assert_eq!(monitor.1[0], p.about().name);
        assert!(monitor.1[1].contains("objective"));
        assert!(
            monitor
                .1
                .last()
                .is_some_and(|l| l.contains("residuals of the model"))
        );
        assert!(!matches!(a.status, LocallyOptimal));
    }
}

/// A quotient and a kink: dnlp.
#[test]
fn kinks() {
    // min |x − 1| + |x + 2|/2 … at x = 1
    let mut m = Model::new(Sense::Minimize);
    let x = m.var((-10.0, 10.0), 5.0);
    let one = m.var((1.0, 1.0), 1.0);
    m.objective(
        &[],
        &[
            (
                1.0,
                &[Var(x), Var(one), Negate, PLUS, Call(Function::Abs, 1)],
            ),
            (0.5, &[Var(x), Var(one), PLUS, Call(Function::Abs, 1)]),
            (0.0, &[Var(x), Var(one), Divide]),
        ],
        0.0,
    );
    for p in interior_point_solvers() {
        let a = run(p.about().name, &m.0).unwrap();
        assert!(
            (a.outcome.level[0] - 1.0).abs() < 1e-4,
            "{}",
            a.outcome.level[0]
        );
    }
}
