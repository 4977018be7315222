//! The evaluator against an independent second-order forward mode and against differences.

use bmod::autodiff::partials::{packed, partials};
use bmod::autodiff::{Degree, ErrorKind, Evaluator, function_value};
use bmod::model::instance::*;
use proptest::prelude::*;

/// A small generator, so that a seed is a whole case.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
    fn below(&mut self, n: u64) -> u64 {
        (self.next() >> 11) % n
    }
    fn uniform(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Value, gradient and full Hessian.
#[derive(Clone)]
struct Second {
    v: f64,
    g: Vec<f64>,
    h: Vec<f64>,
}

impl Second {
    fn constant(n: usize, v: f64) -> Self {
        Self {
            v,
            g: vec![0.0; n],
            h: vec![0.0; n * n],
        }
    }

    /// φ(a_1 … a_k) given φ's value, gradient and packed Hessian.
    fn compose(args: &[Self], v: f64, d: &[f64], dd: &[f64]) -> Self {
        let n = args[0].g.len();
        let mut r = Self::constant(n, v);
        for (p, a) in args.iter().enumerate() {
            for i in 0..n {
                r.g[i] += d[p] * a.g[i];
            }
            for k in 0..n * n {
                r.h[k] += d[p] * a.h[k];
            }
            for (q, b) in args.iter().enumerate() {
                let c = dd[packed(p.max(q), p.min(q))];
                for i in 0..n {
                    for j in 0..n {
                        r.h[i * n + j] += c * a.g[i] * b.g[j];
                    }
                }
            }
        }
        r
    }
}

/// The value with its derivatives, and the greatest value, first and second derivative on the way to it: what rounding
/// errors are measured by.
fn reference(kernel: &Kernel, x: &[f64], c: &[f64]) -> Option<(Second, [f64; 3])> {
    let n = x.len();
    let var = |k: u32| {
        let mut s = Second::constant(n, x[k as usize]);
        s.g[k as usize] = 1.0;
        s
    };
    let sum = |items: &[Second]| {
        Second::compose(
            items,
            items.iter().map(|a| a.v).sum(),
            &vec![1.0; items.len()],
            &vec![0.0; items.len() * (items.len() + 1) / 2],
        )
    };
    let product = |a: &Second, b: &Second| {
        Second::compose(
            &[a.clone(), b.clone()],
            a.v * b.v,
            &[b.v, a.v],
            &[0.0, 1.0, 0.0],
        )
    };
    let mut stack: Vec<Second> = Vec::new();
    let mut scale = [0.0_f64; 3];
    let largest = |values: &[f64], s: f64| values.iter().fold(s, |s, d| s.max(d.abs()));
    for op in &kernel.ops {
        let top = match *op {
            Op::Var(k) => var(k),
            Op::Const(k) => Second::constant(n, c[k as usize]),
            Op::Affine(constant, variable, terms) => {
                let mut s = Second::constant(n, c[constant as usize]);
                for m in 0..terms {
                    s.v += c[(constant + 1 + m) as usize] * x[(variable + m) as usize];
                    s.g[(variable + m) as usize] += c[(constant + 1 + m) as usize];
                }
                s
            }
            Op::Add(k) => {
                let items = stack.split_off(stack.len() - k as usize);
                sum(&items)
            }
            Op::Multiply(k) => {
                let items = stack.split_off(stack.len() - k as usize);
                items[1..]
                    .iter()
                    .fold(items[0].clone(), |p, a| product(&p, a))
            }
            Op::Divide => {
                let (b, a) = (stack.pop()?, stack.pop()?);
                let r = 1.0 / b.v;
                Second::compose(
                    &[a.clone(), b.clone()],
                    a.v / b.v,
                    &[r, -a.v * r * r],
                    &[0.0, -r * r, 2.0 * a.v * r * r * r],
                )
            }
            Op::Negate => {
                let a = stack.pop()?;
                Second::compose(std::slice::from_ref(&a), -a.v, &[-1.0], &[0.0])
            }
            Op::Power => {
                let (b, a) = (stack.pop()?, stack.pop()?);
                let (mut g, mut h) = ([0.0; 2], [0.0; 3]);
                let active = [true, b.g.iter().any(|&d| d != 0.0)];
                let v = partials(Function::RPower, &[a.v, b.v], &active, &mut g, &mut h).ok()?;
                Second::compose(&[a, b], v, &g, &h)
            }
            Op::PowerInt(k) => {
                let a = stack.pop()?;
                let kf = f64::from(k);
                Second::compose(
                    std::slice::from_ref(&a),
                    a.v.powi(k),
                    &[kf * a.v.powi(k - 1)],
                    &[kf * (kf - 1.0) * a.v.powi(k - 2)],
                )
            }
            Op::Call(f, k) => {
                let items = stack.split_off(stack.len() - k as usize);
                let args: Vec<f64> = items.iter().map(|a| a.v).collect();
                let k = k as usize;
                let (mut g, mut h) = (vec![0.0; k], vec![0.0; k * (k + 1) / 2]);
                let active: Vec<bool> = items
                    .iter()
                    .map(|a| a.g.iter().any(|&d| d != 0.0))
                    .collect();
                let v = partials(f, &args, &active, &mut g, &mut h).ok()?;
                Second::compose(&items, v, &g, &h)
            }
        };
        scale[0] = scale[0].max(top.v.abs());
        scale[1] = largest(&top.g, scale[1]);
        scale[2] = largest(&top.h, scale[2]);
        stack.push(top);
    }
    Some((stack.pop()?, scale))
}

/// A random kernel over n variables and m constants, its values kept in a harmless range.
fn random_kernel(r: &mut Random, n: u32, m: u32) -> Kernel {
    let mut ops = Vec::new();
    expression(r, n, m, 4, &mut ops);
    Kernel {
        ops,
        variables: n,
        constants: m,
    }
}

fn expression(r: &mut Random, n: u32, m: u32, depth: u32, ops: &mut Vec<Op>) {
    use Function::*;
    if depth == 0 || r.below(12) == 0 {
        match r.below(5) {
            0 => ops.push(Op::Const(r.below(u64::from(m)) as u32)),
            1 if n >= 2 && m >= 3 => ops.push(Op::Affine(0, r.below(u64::from(n) - 1) as u32, 2)),
            _ => ops.push(Op::Var(r.below(u64::from(n)) as u32)),
        }
        return;
    }
    let sub = |r: &mut Random, ops: &mut Vec<Op>| expression(r, n, m, depth - 1, ops);
    // 1.5 + tanh-like squashing keeps arguments of log, sqrt and powers inside (0.5, 2.5)
    let squash = |ops: &mut Vec<Op>| ops.extend([Op::Call(Sigmoid, 1), Op::Const(m), Op::Add(2)]);
    match r.below(19) {
        0 | 1 => {
            sub(r, ops);
            sub(r, ops);
            ops.push(Op::Add(2));
        }
        2 => {
            sub(r, ops);
            sub(r, ops);
            ops.extend([Op::Negate, Op::Add(2)]);
        }
        3 | 4 => {
            sub(r, ops);
            sub(r, ops);
            ops.push(Op::Multiply(2));
        }
        5 => {
            sub(r, ops);
            sub(r, ops);
            squash(ops);
            ops.push(Op::Divide);
        }
        6 => {
            sub(r, ops);
            ops.push(Op::Negate);
        }
        7 => {
            for _ in 0..3 {
                sub(r, ops);
            }
            ops.push(if r.below(2) == 0 {
                Op::Add(3)
            } else {
                Op::Multiply(3)
            });
        }
        8 => {
            sub(r, ops);
            let k = [2, 3, 5, 7][r.below(4) as usize];
            ops.push(Op::PowerInt(k));
        }
        9 => {
            sub(r, ops);
            squash(ops);
            let k = [-1, -2, -3][r.below(3) as usize];
            ops.push(Op::PowerInt(k));
        }
        10 => {
            sub(r, ops);
            squash(ops);
            ops.push(Op::Const(r.below(u64::from(m)) as u32));
            ops.push(Op::Power);
        }
        11 => {
            sub(r, ops);
            squash(ops);
            sub(r, ops);
            ops.push(Op::Power);
        }
        12 | 13 => {
            sub(r, ops);
            let f = [Sin, Cos, ArcTan, Tanh, ErrorF, Sigmoid, Abs][r.below(7) as usize];
            ops.push(Op::Call(f, 1));
        }
        14 | 15 => {
            sub(r, ops);
            squash(ops);
            let f = [
                Exp, Log, Log2, Log10, Sqrt, Gamma, LogGamma, Entropy, Sqr, Sinh,
            ][r.below(10) as usize];
            ops.push(Op::Call(f, 1));
        }
        16 => {
            sub(r, ops);
            sub(r, ops);
            let f = [Max, Min, LseMax, ArcTan2][r.below(4) as usize];
            squash(ops);
            ops.push(Op::Call(f, 2));
        }
        17 => {
            sub(r, ops);
            squash(ops);
            sub(r, ops);
            squash(ops);
            ops.push(Op::Call([Centropy, Beta, EDist][r.below(3) as usize], 2));
        }
        _ => {
            // the same subexpression twice
            let at = ops.len();
            sub(r, ops);
            let copy: Vec<Op> = ops[at..].to_vec();
            ops.extend(copy);
            ops.push(if r.below(2) == 0 {
                Op::Multiply(2)
            } else {
                Op::Add(2)
            });
        }
    }
}

fn instance_of(columns: usize, rows: usize, nonlinear: Vec<KernelTerms>) -> Instance {
    let mut start = vec![0];
    start.extend(std::iter::repeat_n(0, rows));
    Instance {
        columns: Columns {
            lower: vec![NEG_INF; columns],
            upper: vec![INF; columns],
            level: vec![0.0; columns],
            marginal: vec![0.0; columns],
            scale: vec![1.0; columns],
            kind: vec![ColumnKind::Continuous; columns],
        },
        rows: Rows {
            relation: vec![Relation::Equal; rows],
            rhs: vec![0.0; rows],
            marginal: vec![0.0; rows],
            scale: vec![1.0; rows],
        },
        matrix: SparseRows {
            start,
            column: vec![],
            value: vec![],
        },
        nonlinear,
        objective: None,
        matched: None,
        discrete: Default::default(),
    }
}

fn close(got: f64, want: f64, scale: f64) -> bool {
    (got - want).abs() <= 1e-11 * (want.abs() + scale)
}

/// Many terms of one random kernel, with repeated columns and repeated rows.
fn compare(seed: u64) -> Result<(), TestCaseError> {
    let mut r = Random(seed | 1);
    let (n, m) = (1 + r.below(4) as u32, 3);
    let kernel = random_kernel(&mut r, n, m);
    let kernel = Kernel {
        constants: m + 1,
        ..kernel
    };
    let terms = [1, 3, 7, 70][r.below(4) as usize];
    let columns = 1 + r.below(u64::from(n) + 3) as usize;
    let rows = 1 + r.below(3) as usize;
    let shared: Vec<bool> = (0..=m).map(|_| r.below(2) == 0).collect();
    let base: Vec<f64> = (0..=m).map(|_| r.uniform(-2.0, 2.0)).collect();
    let mut t = KernelTerms {
        kernel: kernel.clone(),
        ..KernelTerms::default()
    };
    for _ in 0..terms {
        t.row.push(r.below(rows as u64) as u32);
        t.coef.push(r.uniform(-2.0, 2.0));
        for _ in 0..n {
            t.columns.push(r.below(columns as u64) as u32);
        }
        for k in 0..m as usize {
            t.constants.push(if shared[k] {
                base[k]
            } else {
                r.uniform(-2.0, 2.0)
            });
        }
        t.constants.push(1.0);
    }
    let x: Vec<f64> = (0..columns).map(|_| r.uniform(-1.5, 1.5)).collect();
    let lambda: Vec<f64> = (0..rows).map(|_| r.uniform(-1.0, 1.0)).collect();
    // reference
    let mut value = vec![0.0; rows];
    let mut jacobian = vec![0.0; rows * columns];
    let mut hessian = vec![0.0; columns * columns];
    let mut scale = [0.0_f64; 3];
    let mut failed = false;
    for k in 0..terms {
        let (v, c) = (n as usize, m as usize + 1);
        let at: Vec<usize> = t.columns[k * v..(k + 1) * v]
            .iter()
            .map(|&j| j as usize)
            .collect();
        let xs: Vec<f64> = at.iter().map(|&j| x[j]).collect();
        let Some((s, on_the_way)) = reference(&kernel, &xs, &t.constants[k * c..(k + 1) * c])
        else {
            failed = true;
            break;
        };
        if !s.v.is_finite() || s.g.iter().chain(&s.h).any(|d| !d.is_finite()) {
            return Ok(());
        }
        let row = t.row[k] as usize;
        value[row] += t.coef[k] * s.v;
        for (scale, s) in scale.iter_mut().zip(on_the_way) {
            *scale = scale.max(s);
        }
        for i in 0..v {
            jacobian[row * columns + at[i]] += t.coef[k] * s.g[i];
            for j in 0..v {
                hessian[at[i] * columns + at[j]] += lambda[row] * t.coef[k] * s.h[i * v + j];
            }
        }
    }
    if scale.iter().any(|&s| s > 1e6) {
        return Ok(());
    }
    let instance = instance_of(columns, rows, vec![t]);
    let mut e = Evaluator::new(&instance);
    let mut got = vec![0.0; rows];
    let (start, column) = e.jacobian_pattern();
    let (start, column) = (start.to_vec(), column.to_vec());
    let (hr, hc) = e.hessian_pattern();
    let (hr, hc) = (hr.to_vec(), hc.to_vec());
    let mut jv = vec![0.0; column.len()];
    let mut hv = vec![0.0; hr.len()];
    let results = [
        e.rows(&x, &mut got).is_ok(),
        e.jacobian(&x, &mut jv).is_ok(),
        e.hessian(&x, &lambda, &mut hv).is_ok(),
    ];
    if failed {
        // the reference wants all derivatives; the code only those that are not identically 0
        return Ok(());
    }
    prop_assert_eq!(results, [true; 3]);
    for i in 0..rows {
        prop_assert!(
            close(got[i], value[i], scale[0]),
            "value {} {}",
            got[i],
            value[i]
        );
        let mut dense = vec![0.0; columns];
        for k in start[i]..start[i + 1] {
            prop_assert!(k == start[i] || column[k] > column[k - 1]);
            dense[column[k] as usize] = jv[k];
        }
        for j in 0..columns {
            prop_assert!(
                close(dense[j], jacobian[i * columns + j], scale[1]),
                "J {} {}",
                dense[j],
                jacobian[i * columns + j]
            );
        }
    }
    // Second derivatives are sums of products of values and first derivatives, each rounded.
    let rounding = f64::EPSILON * (scale[0] + scale[1]) / 1e-11;
    let mut dense = vec![0.0; columns * columns];
    for k in 0..hr.len() {
        prop_assert!(hr[k] >= hc[k]);
        prop_assert!(k == 0 || (hr[k], hc[k]) > (hr[k - 1], hc[k - 1]));
        dense[hr[k] as usize * columns + hc[k] as usize] = hv[k];
    }
    for i in 0..columns {
        for j in 0..=i {
            prop_assert!(
                close(
                    dense[i * columns + j],
                    hessian[i * columns + j],
                    scale[2].max(rounding)
                ),
                "H {i} {j}: {} {}",
                dense[i * columns + j],
                hessian[i * columns + j]
            );
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn evaluator_agrees_with_forward_mode(seed in any::<u64>()) {
        compare(seed)?;
    }

    /// The Hessian is the derivative of the gradient: central differences.
    #[test]
    fn hessian_is_the_difference_of_gradients(seed in any::<u64>()) {
        let mut r = Random(seed | 1);
        let n = 1 + r.below(4) as u32;
        let kernel = Kernel { constants: 4, ..random_kernel(&mut r, n, 3) };
        if kernel.ops.iter().any(|o| matches!(o, Op::Call(Function::Abs | Function::Max | Function::Min, _))) {
            return Ok(());
        }
        let t = KernelTerms {
            kernel,
            row: vec![0],
            coef: vec![1.0],
            columns: (0..n).collect(),
            constants: vec![r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0), 1.0],
        };
        let n = n as usize;
        let instance = instance_of(n, 1, vec![t]);
        let mut e = Evaluator::new(&instance);
        let x: Vec<f64> = (0..n).map(|_| r.uniform(-1.0, 1.0)).collect();
        let (hr, hc) = e.hessian_pattern();
        let (hr, hc) = (hr.to_vec(), hc.to_vec());
        let mut hv = vec![0.0; hr.len()];
        if e.hessian(&x, &[1.0], &mut hv).is_err() {
            return Ok(());
        }
        let vector: Vec<f64> = (0..n).map(|_| r.uniform(-1.0, 1.0)).collect();
        let mut product = vec![0.0; n];
        for ((&i, &j), h) in hr.iter().zip(&hc).zip(&hv) {
            let (i, j) = (i as usize, j as usize);
            product[i] += h * vector[j];
            if i != j {
                product[j] += h * vector[i];
            }
        }
        let mut multiplied = vec![0.0; n];
        Evaluator::with_products(&instance).product(&x, &vector, &[1.0], &mut multiplied).expect("the Hessian has a value");
        let largest = hv.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
        for (a, b) in product.iter().zip(&multiplied) {
            prop_assert!((a - b).abs() <= 1e-10 * largest, "{} {}", a, b);
        }
        let columns = e.jacobian_pattern().1.to_vec();
        let mut gradient = |x: &[f64]| {
            let mut v = vec![0.0; columns.len()];
            e.jacobian(x, &mut v).ok()?;
            let mut dense = vec![0.0; n];
            for (&j, d) in columns.iter().zip(v) {
                dense[j as usize] = d;
            }
            Some(dense)
        };
        for i in 0..n {
            let step = |h: f64| {
                let mut y = x.clone();
                y[i] += h;
                y
            };
            let h = 1e-4;
            let parts: Option<Vec<Vec<f64>>> = [h, -h, 2.0 * h, -2.0 * h].iter().map(|&h| gradient(&step(h))).collect();
            let Some(p) = parts else { return Ok(()) };
            for j in 0..n {
                let difference = (8.0 * (p[0][j] - p[1][j]) - (p[2][j] - p[3][j])) / (12.0 * h);
                let (a, b) = (i.max(j) as u32, i.min(j) as u32);
                let exact = (0..hr.len()).find(|&k| (hr[k], hc[k]) == (a, b)).map_or(0.0, |k| hv[k]);
                let scale = hv.iter().chain(&p[0]).fold(1.0_f64, |m, v| m.max(v.abs()));
                if scale < 1e3 {
                    prop_assert!((difference - exact).abs() < 1e-5 * scale, "{} {}", difference, exact);
                }
            }
        }
    }
}

/// A chain of Rosenbrock terms, three structures in all; sizes must be linear.
#[test]
fn long_sums_are_linear_in_size() {
    // sqrt(1 + Σ x²) has a dense Hessian, Σ x³ inside a linear context has a diagonal one
    let n = 20_000u32;
    let mut ops: Vec<Op> = Vec::new();
    for k in 0..n {
        ops.extend([Op::Var(k), Op::PowerInt(3), Op::Const(k), Op::Multiply(2)]);
    }
    ops.push(Op::Add(n));
    let t = KernelTerms {
        kernel: Kernel {
            ops,
            variables: n,
            constants: n,
        },
        row: vec![0],
        coef: vec![1.0],
        columns: (0..n).collect(),
        constants: (0..n).map(f64::from).collect(),
    };
    let instance = instance_of(n as usize, 1, vec![t]);
    let mut e = Evaluator::new(&instance);
    assert_eq!(e.hessian_pattern().0.len(), n as usize - 1 + 1);
    let x = vec![2.0; n as usize];
    let mut out = [0.0];
    e.rows(&x, &mut out).unwrap();
    assert_eq!(out[0], 8.0 * f64::from(n) * f64::from(n - 1) / 2.0);
    assert_eq!(e.nonlinear_nonzeros(), n as usize);
}

/// Both slots of a product on one column: x·x.
#[test]
fn repeated_columns_count_twice_on_the_diagonal() {
    let t = KernelTerms {
        kernel: Kernel {
            ops: vec![Op::Var(0), Op::Var(1), Op::Multiply(2)],
            variables: 2,
            constants: 0,
        },
        row: vec![0, 0, 1],
        coef: vec![1.0, 3.0, 1.0],
        columns: vec![0, 0, 0, 1, 1, 1],
        constants: vec![],
    };
    let instance = instance_of(2, 2, vec![t]);
    let mut e = Evaluator::new(&instance);
    assert_eq!(e.hessian_pattern(), (&[0, 1, 1][..], &[0, 0, 1][..]));
    let mut h = [0.0; 3];
    e.hessian(&[5.0, 7.0], &[1.0, 10.0], &mut h).unwrap();
    assert_eq!(h, [2.0, 3.0, 20.0]);
    assert_eq!(e.degrees(), [Degree::Quadratic; 2]);
    let mut j = [0.0; 3];
    e.jacobian(&[5.0, 7.0], &mut j).unwrap();
    assert_eq!(j, [10.0 + 21.0, 15.0, 14.0]);
}

fn one_term(ops: Vec<Op>, variables: u32, constants: Vec<f64>) -> Instance {
    let t = KernelTerms {
        kernel: Kernel {
            ops,
            variables,
            constants: constants.len() as u32,
        },
        row: vec![0],
        coef: vec![1.0],
        columns: (0..variables).collect(),
        constants,
    };
    instance_of(variables as usize, 1, vec![t])
}

#[test]
fn failures_name_function_argument_and_column() {
    use Function::*;
    let cases: Vec<(Instance, Vec<f64>, &str, Option<u32>)> = vec![
        (
            one_term(vec![Op::Var(0), Op::Call(Log, 1)], 1, vec![]),
            vec![-1.0],
            "log of -1",
            Some(0),
        ),
        (
            one_term(vec![Op::Const(0), Op::Var(0), Op::Divide], 1, vec![1.0]),
            vec![0.0],
            "1 divided by 0",
            Some(0),
        ),
        (
            one_term(vec![Op::Var(0), Op::Const(0), Op::Power], 1, vec![0.3]),
            vec![-2.0],
            "(-2) ** 0.3: the base of a real power must not be negative",
            Some(0),
        ),
        (
            one_term(vec![Op::Var(0), Op::Const(0), Op::Power], 1, vec![2.0]),
            vec![-2.0],
            "(-2) ** 2: the base of a real power must not be negative",
            Some(0),
        ),
        (
            one_term(
                vec![
                    Op::Var(0),
                    Op::Var(1),
                    Op::Negate,
                    Op::Add(2),
                    Op::Call(Sqrt, 1),
                ],
                2,
                vec![],
            ),
            vec![1.0, 3.0],
            "sqrt of -2",
            None,
        ),
        (
            one_term(
                vec![Op::Var(0), Op::Call(ArcSin, 1), Op::Call(Exp, 1)],
                1,
                vec![],
            ),
            vec![2.0],
            "arcsin of 2",
            Some(0),
        ),
        // exp(−1/x): the infinity in between must not be swallowed
        (
            one_term(
                vec![
                    Op::Const(0),
                    Op::Var(0),
                    Op::Divide,
                    Op::Negate,
                    Op::Call(Exp, 1),
                ],
                1,
                vec![1.0],
            ),
            vec![0.0],
            "1 divided by 0",
            Some(0),
        ),
        (
            one_term(
                vec![Op::Var(0), Op::PowerInt(7), Op::PowerInt(7)],
                1,
                vec![],
            ),
            vec![1e30],
            "a term: the result is too large",
            None,
        ),
    ];
    for (instance, x, words, column) in cases {
        let mut e = Evaluator::new(&instance);
        let f = e.rows(&x, &mut [0.0]).expect_err(words);
        assert_eq!(
            (f.to_string().as_str(), f.column, f.row),
            (words, column, 0)
        );
        let mut j = vec![0.0; e.jacobian_pattern().1.len()];
        assert_eq!(e.jacobian(&x, &mut j).expect_err(words).to_string(), words);
        let mut h = vec![0.0; e.hessian_pattern().0.len()];
        if !h.is_empty() {
            assert_eq!(
                e.hessian(&x, &[1.0], &mut h).expect_err(words).to_string(),
                words
            );
        }
    }
    // the value exists, the derivative does not
    for ops in [
        vec![Op::Var(0), Op::Call(Sqrt, 1)],
        vec![Op::Var(0), Op::Const(0), Op::Power],
    ] {
        let instance = one_term(ops, 1, vec![0.4]);
        let mut e = Evaluator::new(&instance);
        e.rows(&[0.0], &mut [0.0]).unwrap();
        let f = e.jacobian(&[0.0], &mut [0.0]).unwrap_err();
        assert_eq!(
            (f.error.kind, f.column),
            (ErrorKind::Derivative, Some(0)),
            "{f}"
        );
        // and the evaluator is as good as new
        e.rows(&[4.0], &mut [0.0]).unwrap();
    }
}

#[test]
fn degrees_are_found() {
    use Function::*;
    let degree = |ops: Vec<Op>| Evaluator::new(&one_term(ops, 2, vec![2.0, 3.0])).degrees()[0];
    assert_eq!(
        degree(vec![
            Op::Var(0),
            Op::Const(0),
            Op::Multiply(2),
            Op::Var(1),
            Op::Add(2)
        ]),
        Degree::Linear
    );
    assert_eq!(
        degree(vec![Op::Var(0), Op::Const(0), Op::Divide]),
        Degree::Linear
    );
    assert_eq!(
        degree(vec![
            Op::Var(0),
            Op::Var(1),
            Op::Multiply(2),
            Op::Const(0),
            Op::Divide
        ]),
        Degree::Quadratic
    );
    assert_eq!(
        degree(vec![
            Op::Var(0),
            Op::Var(1),
            Op::Negate,
            Op::Add(2),
            Op::Call(Sqr, 1)
        ]),
        Degree::Quadratic
    );
    assert_eq!(degree(vec![Op::Var(0), Op::PowerInt(3)]), Degree::Nonlinear);
    assert_eq!(
        degree(vec![Op::Var(0), Op::Var(1), Op::Divide]),
        Degree::Nonlinear
    );
    // a square with a domain is no quadratic
    assert_eq!(
        degree(vec![Op::Var(0), Op::Const(0), Op::Power]),
        Degree::Nonlinear
    );
    assert_eq!(function_value(Sqr, &[3.0]), Ok(9.0));
}
