//! Affine expressions, and quadratic ones as weighted squares of them.

use crate::model::instance::{Function, Op};
use crate::solve::bridge::parts::{Parts, Tree};
use crate::solve::lp::interior::Affine;

/// Columns of a quadratic row whose matrix is taken apart by its eigenvalues.
const MAX_EIGEN_COLUMNS: usize = 300;

/// An eigenvalue below this, relative to the largest, is 0.
const EIGENVALUE_TOLERANCE: f64 = 1e-13;

pub(super) fn constant(constant: f64) -> Affine {
    Affine {
        constant,
        terms: Vec::new(),
    }
}

pub(super) fn column(j: u32) -> Affine {
    Affine {
        constant: 0.0,
        terms: vec![(j, 1.0)],
    }
}

/// A sum, each column once.
pub(super) fn sum_of(all: impl IntoIterator<Item = Affine>) -> Affine {
    let mut out = Affine::default();
    for a in all {
        out.constant += a.constant;
        out.terms.extend(a.terms);
    }
    out.terms.sort_by_key(|t| t.0);
    out.terms.dedup_by(|t, kept| {
        let same = t.0 == kept.0;
        if same {
            kept.1 += t.1;
        }
        same
    });
    out.terms.retain(|t| t.1 != 0.0);
    out
}

pub(super) fn times(a: &Affine, weight: f64) -> Affine {
    let terms = a.terms.iter().map(|&(j, v)| (j, weight * v));
    sum_of([Affine {
        constant: weight * a.constant,
        terms: terms.collect(),
    }])
}

/// `a + weight b`.
pub(super) fn plus(a: Affine, b: &Affine, weight: f64) -> Affine {
    sum_of([a, times(b, weight)])
}

/// A quadratic expression: weighted squares and an affine rest.
#[derive(Default)]
pub(super) struct Quadratic {
    pub(super) squares: Vec<(f64, Affine)>,
    pub(super) rest: Affine,
}

impl Quadratic {
    /// Squares of a form whose matrix has these eigenvalues; None where it has too many columns.
    pub(super) fn diagonal(&self, homogeneous: bool) -> Option<Self> {
        let all = self.squares.iter().flat_map(|s| &s.1.terms);
        let mut columns: Vec<u32> = all.map(|t| t.0).collect();
        if homogeneous {
            columns.extend(self.rest.terms.iter().map(|t| t.0));
        }
        columns.sort_unstable();
        columns.dedup();
        if columns.len() > MAX_EIGEN_COLUMNS {
            return None;
        }
        let one = columns.len();
        let place = |j: u32| columns.partition_point(|&k| k < j);
        let size = one + usize::from(homogeneous);
        let mut matrix = faer::Mat::<f64>::zeros(size, size);
        let mut rest = self.rest.clone();
        for (w, p) in &self.squares {
            let own = || p.terms.iter().map(|&(j, a)| (place(j), a));
            for (i, a) in own() {
                own().for_each(|(j, b)| matrix[(i, j)] += w * a * b);
            }
            let linear = times(p, 2.0 * w * p.constant);
            rest = plus(rest, &linear, 1.0);
            rest.constant -= w * p.constant * p.constant;
        }
        if homogeneous {
            for &(j, a) in &rest.terms {
                matrix[(place(j), one)] += 0.5 * a;
                matrix[(one, place(j))] += 0.5 * a;
            }
            matrix[(one, one)] += rest.constant;
            rest = Affine::default();
        }
        let eigen = matrix.self_adjoint_eigen(faer::Side::Lower).ok()?;
        let (values, vectors) = (eigen.S(), eigen.U());
        let largest = (0..size).fold(0.0f64, |t, k| t.max(values[k].abs()));
        let mut squares = Vec::new();
        for k in (0..size).filter(|&k| values[k].abs() > EIGENVALUE_TOLERANCE * largest) {
            let terms = columns.iter().enumerate();
            let p = Affine {
                constant: if homogeneous { vectors[(one, k)] } else { 0.0 },
                terms: terms.map(|(i, &j)| (j, vectors[(i, k)])).collect(),
            };
            squares.push((values[k], p));
        }
        Some(Self { squares, rest })
    }

    pub(super) fn negative(&self) -> usize {
        self.squares.iter().filter(|s| s.0 < 0.0).count()
    }
}

pub(super) fn affine_of(parts: &Parts) -> Affine {
    sum_of([Affine {
        constant: parts.constant,
        terms: parts.linear.clone(),
    }])
}

/// The affine expression that ends at p.
pub(super) fn affine(tree: &Tree, p: usize) -> Option<Affine> {
    let mut parts = Parts::default();
    tree.split(p, 1.0, &mut parts);
    parts.nonlinear.is_empty().then(|| affine_of(&parts))
}

/// A sum as weighted squares of affine expressions and an affine rest.
pub(super) fn quadratic(parts: &Parts) -> Option<Quadratic> {
    let mut out = Quadratic {
        squares: Vec::new(),
        rest: affine_of(parts),
    };
    for (weight, term) in &parts.nonlinear {
        let (tree, last) = (Tree::new(term), term.ops.len() - 1);
        match (term.ops[last], &tree.arguments(last)[..]) {
            (Op::PowerInt(2) | Op::Call(Function::Sqr, _), &[a]) => {
                out.squares.push((*weight, affine(&tree, a)?));
            }
            (Op::Call(Function::Power, _), &[a, k]) if tree.number(k) == Some(2.0) => {
                out.squares.push((*weight, affine(&tree, a)?));
            }
            (Op::Multiply(_), all) => {
                let (number, rest) = tree.factors(all);
                let [a, b] = rest[..] else { return None };
                let (a, b) = (affine(&tree, a)?, affine(&tree, b)?);
                let weight = weight * number;
                if a == b {
                    out.squares.push((weight, a));
                } else {
                    out.squares.push((0.25 * weight, plus(a.clone(), &b, 1.0)));
                    out.squares.push((-0.25 * weight, plus(a, &b, -1.0)));
                }
            }
            _ => return None,
        }
    }
    Some(out)
}

/// Affine expressions whose squares add up to `weight` times the expression that ends at p.
pub(super) fn sum_of_squares(tree: &Tree, p: usize, weight: f64) -> Option<Vec<Affine>> {
    let mut parts = Parts::default();
    tree.split(p, weight, &mut parts);
    let mut q = quadratic(&parts)?;
    if q.negative() > 0 || !q.rest.terms.is_empty() {
        q = q.diagonal(true)?;
    }
    if q.negative() > 0 || !q.rest.terms.is_empty() || q.rest.constant < 0.0 {
        return None;
    }
    let roots = q.squares.iter().map(|(w, p)| times(p, w.sqrt()));
    let mut all: Vec<Affine> = roots.collect();
    if q.rest.constant > 0.0 {
        all.push(constant(q.rest.constant.sqrt()));
    }
    Some(all)
}
