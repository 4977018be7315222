//! Time of one evaluation of the rows, the Jacobian and the Hessian of the Lagrangian, per nonlinear
//! nonzero of the Jacobian or nonzero of the Hessian, on models with 10⁴ to 10⁶ of them:
//!
//! * `chain`: min Σ 100 (x_{i+1} − x_i²)² + (1 − x_i)², one objective row;
//! * `rocket`: the discretised Goddard rocket (drag exponential in the altitude, gravity 1/h²),
//!   trapezoidal rule, three rows per interval;
//! * `scalar`: 500 rows of different structure, as in a model written out term by term.
//!
//! `benches/derivatives.py` builds the same models with CasADi. Run: `cargo bench --bench derivatives`.

use bmod::autodiff::Evaluator;
use bmod::model::instance::*;
use std::time::Instant;

struct Builder {
    nonlinear: Vec<KernelTerms>,
    matrix: Vec<(usize, u32, f64)>,
    columns: usize,
    rows: usize,
}

impl Builder {
    fn instance(mut self) -> Instance {
        self.matrix.sort_by_key(|e| (e.0, e.1));
        let mut start = vec![0; self.rows + 1];
        for e in &self.matrix {
            start[e.0 + 1] += 1;
        }
        for i in 0..self.rows {
            start[i + 1] += start[i];
        }
        let n = self.columns;
        Instance {
            columns: Columns {
                lower: vec![NEG_INF; n],
                upper: vec![INF; n],
                level: vec![0.0; n],
                marginal: vec![0.0; n],
                scale: vec![1.0; n],
                kind: vec![ColumnKind::Continuous; n],
            },
            rows: Rows {
                relation: vec![Relation::Equal; self.rows],
                rhs: vec![0.0; self.rows],
                marginal: vec![0.0; self.rows],
                scale: vec![1.0; self.rows],
            },
            matrix: SparseRows {
                start,
                column: self.matrix.iter().map(|e| e.1).collect(),
                value: self.matrix.iter().map(|e| e.2).collect(),
            },
            nonlinear: self.nonlinear,
            objective: None,
            matched: None,
            discrete: Default::default(),
        }
    }
}

fn chain(n: usize) -> Instance {
    // sqr(x1 - sqr(x0))*100 + sqr(1 - x0)
    let ops = vec![
        Op::Const(0),
        Op::Var(1),
        Op::Var(0),
        Op::PowerInt(2),
        Op::Negate,
        Op::Add(2),
        Op::PowerInt(2),
        Op::Multiply(2),
        Op::Const(1),
        Op::Var(0),
        Op::Negate,
        Op::Add(2),
        Op::PowerInt(2),
        Op::Add(2),
    ];
    let mut t = KernelTerms {
        kernel: Kernel {
            ops,
            variables: 2,
            constants: 2,
        },
        ..KernelTerms::default()
    };
    for i in 0..n as u32 - 1 {
        t.row.push(0);
        t.coef.push(1.0);
        t.columns.extend([i, i + 1]);
        t.constants.extend([100.0, 1.0]);
    }
    Builder {
        nonlinear: vec![t],
        matrix: vec![],
        columns: n,
        rows: 1,
    }
    .instance()
}

/// Columns: h, v, m, thrust per node; rows: h' = v, v' = (T − D)/m − 1/h², m' = −T/c.
fn rocket(nodes: usize) -> Instance {
    let drag = |h: u32, v: u32| {
        // 310 v² exp(−500 (h − 1))
        vec![
            Op::Const(0),
            Op::Var(v),
            Op::PowerInt(2),
            Op::Multiply(2),
            Op::Const(1),
            Op::Var(h),
            Op::Const(2),
            Op::Negate,
            Op::Add(2),
            Op::Multiply(2),
            Op::Call(Function::Exp, 1),
            Op::Multiply(2),
        ]
    };
    // (T − D)/m − (1/h)²
    let mut ops = vec![Op::Var(3)];
    ops.extend(drag(0, 1));
    ops.extend([
        Op::Negate,
        Op::Add(2),
        Op::Var(2),
        Op::Divide,
        Op::Const(2),
        Op::Var(0),
        Op::Divide,
        Op::PowerInt(2),
        Op::Negate,
        Op::Add(2),
    ]);
    let mut t = KernelTerms {
        kernel: Kernel {
            ops,
            variables: 4,
            constants: 3,
        },
        ..KernelTerms::default()
    };
    let step = 1.0 / nodes as f64;
    let mut matrix = Vec::new();
    for k in 0..nodes - 1 {
        let row = 3 * k;
        let col = |node: usize, what: usize| (4 * node + what) as u32;
        for node in [k, k + 1] {
            t.row.push(row as u32 + 1);
            t.coef.push(-0.5 * step);
            t.columns.extend((0..4).map(|w| col(node, w)));
            t.constants.extend([310.0, -500.0, 1.0]);
            let sign = if node == k { -1.0 } else { 1.0 };
            matrix.push((row, col(node, 0), sign));
            matrix.push((row, col(node, 1), -0.5 * step));
            matrix.push((row + 1, col(node, 1), sign));
            matrix.push((row + 2, col(node, 2), sign));
            matrix.push((row + 2, col(node, 3), step));
        }
    }
    Builder {
        nonlinear: vec![t],
        matrix,
        columns: 4 * nodes,
        rows: 3 * (nodes - 1),
    }
    .instance()
}

/// Every row a structure of its own: a random tree over a few columns.
fn scalar(rows: usize) -> Instance {
    let mut nonlinear = Vec::new();
    let mut seed = 1u64;
    let mut random = move |n: u64| {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 33) % n
    };
    for row in 0..rows {
        let mut ops = vec![Op::Var(0)];
        for k in 1..8u32 {
            ops.push(Op::Var(k));
            match random(4) {
                0 => ops.push(Op::Add(2)),
                2 => ops.extend([Op::Negate, Op::Add(2)]),
                _ => ops.push(Op::Multiply(2)),
            }
            match random(5) {
                0 => ops.push(Op::Call(Function::Sin, 1)),
                1 => ops.push(Op::PowerInt(2)),
                2 => ops.push(Op::Call(Function::ArcTan, 1)),
                _ => {}
            }
        }
        nonlinear.push(KernelTerms {
            kernel: Kernel {
                ops,
                variables: 8,
                constants: 0,
            },
            row: vec![row as u32],
            coef: vec![1.0],
            columns: (0..8).map(|k| (row + k) as u32).collect(),
            constants: vec![],
        });
    }
    Builder {
        nonlinear,
        matrix: vec![],
        columns: rows + 8,
        rows,
    }
    .instance()
}

/// Best of several runs, in seconds.
fn time(mut f: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    let begin = Instant::now();
    while begin.elapsed().as_secs_f64() < 0.4 {
        let t = Instant::now();
        f();
        best = best.min(t.elapsed().as_secs_f64());
    }
    best
}

fn report(name: &str, instance: &Instance, start: f64) {
    let t = Instant::now();
    let mut e = Evaluator::new(instance);
    let setup = t.elapsed().as_secs_f64();
    let nonlinear = e.nonlinear_nonzeros();
    let jacobian = e.jacobian_pattern().1.len();
    let hessian = e.hessian_pattern().0.len();
    let x = vec![start; instance.column_count()];
    let lambda = vec![1.0; instance.row_count()];
    let mut rows = vec![0.0; instance.row_count()];
    let (mut j, mut h) = (vec![0.0; jacobian], vec![0.0; hessian]);
    let rows_time = time(|| e.rows(&x, &mut rows).expect("the start is in the domain"));
    let jacobian_time = time(|| e.jacobian(&x, &mut j).expect("the start is in the domain"));
    let hessian_time = time(|| {
        e.hessian(&x, &lambda, &mut h)
            .expect("the start is in the domain")
    });
    println!(
        "{name:>8} {nonlinear:>9} {jacobian:>9} {hessian:>9}   {:>9.1} ms   {:>7.2} {:>7.2} {:>7.2}",
        setup * 1e3,
        rows_time / nonlinear as f64 * 1e9,
        jacobian_time / nonlinear as f64 * 1e9,
        hessian_time / hessian as f64 * 1e9,
    );
}

fn main() {
    println!(
        "   model nonlinear  jacobian   hessian       set-up        rows     jac    hess  (ns per nonzero)"
    );
    for n in [10_000, 100_000, 1_000_000] {
        report("chain", &chain(n), 0.5);
        report("rocket", &rocket(n / 8), 1.01);
    }
    report("scalar", &scalar(500), 0.5);
}
