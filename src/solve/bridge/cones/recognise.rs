//! Which cones the rows of a program are.

use super::Multiplier;
use super::quadratic::{
    affine, affine_of, column, constant, plus, quadratic, sum_of, sum_of_squares, times,
};
use crate::model::builder::Term;
use crate::model::instance::{Columns, Function, Instance, Op};
use crate::solve::bridge::parts::{Parts, Tree};
use crate::solve::interval::Interval;
use crate::solve::lp::form::{Activity, Problem, Sparse, term};
use crate::solve::lp::interior::{Affine, Cone, ConeKind};
use crate::solve::nlp::composition::composed;

/// Rounds in which linear rows tighten the bounds by which signs are judged.
const PROPAGATION_ROUNDS: usize = 5;

/// A conic program in the making.
pub(super) struct Compiler<'i> {
    pub(super) instance: &'i Instance,
    /// Bounds; new columns come last.
    pub(super) columns: Columns,
    /// Bounds that linear rows imply.
    pub(super) implied: Option<Columns>,
    pub(super) cones: Vec<Cone>,
    pub(super) rows: Vec<(Affine, [f64; 2])>,
    pub(super) has_apex: bool,
}

impl Compiler<'_> {
    pub(super) fn finish(self) -> Problem {
        let n = self.columns.lower.len();
        let mut out = Problem {
            cost: vec![0.0; n],
            rows: Sparse::default(),
            ..Problem::of(&Instance {
                columns: self.columns,
                ..Instance::default()
            })
        };
        if let Some(o) = self.instance.objective {
            out.cost[o.column as usize] = self.instance.sign();
        }
        for (left, [low, high]) in self.rows {
            let left = sum_of([left]);
            out.row_lower.push(low - left.constant);
            out.row_upper.push(high - left.constant);
            out.rows
                .push(left.terms.into_iter().map(|(j, a)| (j as usize, a)));
        }
        out.columns = out.rows.transpose(n);
        out
    }

    fn cone(&mut self, kind: ConeKind, expressions: Vec<Affine>) -> usize {
        self.cones.push(Cone { kind, expressions });
        self.cones.len() - 1
    }

    /// A second-order cone, which may end at its apex where no coordinate is a number other than 0.
    fn with_apex(&mut self, coordinates: Vec<Affine>) -> usize {
        let away = |e: &Affine| e.terms.is_empty() && e.constant != 0.0;
        self.has_apex |= !coordinates.iter().any(away);
        self.cone(ConeKind::SecondOrder, coordinates)
    }

    fn new_column(&mut self) -> Affine {
        column(self.columns.push(f64::NEG_INFINITY, f64::INFINITY) as u32)
    }

    /// A nonlinear row, `way (left + Σ terms) ≤ 0`.
    pub(super) fn row(
        &mut self,
        left: &Affine,
        terms: &[(f64, Term)],
        way: f64,
    ) -> Option<Multiplier> {
        let left = times(left, way);
        let mut all = Parts::default();
        for (weight, term) in terms {
            let tree = Tree::new(term);
            tree.split(term.ops.len() - 1, way * weight, &mut all);
        }
        if let Some(found) = self.quadratic_row(&left, &all, way) {
            return Some(found);
        }
        let mut parts = vec![left, affine_of(&all)];
        for (weight, term) in &all.nonlinear {
            let tree = Tree::new(term);
            parts.push(self.above(&tree, term.ops.len() - 1, *weight)?);
        }
        self.rows.push((sum_of(parts), [f64::NEG_INFINITY, 0.0]));
        Some(Multiplier::Row(self.rows.len() - 1, way))
    }

    fn quadratic_row(&mut self, left: &Affine, parts: &Parts, way: f64) -> Option<Multiplier> {
        let mut q = quadratic(parts)?;
        q.rest = plus(q.rest, left, 1.0);
        if q.negative() > 0 {
            let is_cone = q.negative() == 1 && q.rest.terms.is_empty() && q.rest.constant >= 0.0;
            if !is_cone {
                let convex = q.diagonal(false).filter(|q| q.negative() == 0);
                q = match convex {
                    Some(convex) => convex,
                    None => q.diagonal(true)?,
                };
            }
        }
        let root = |(w, p): &(f64, Affine), by: f64| times(p, by * w.abs().sqrt());
        if q.negative() == 0 {
            let minus_one = |sign: f64| plus(constant(1.0), &q.rest, sign);
            let mut coordinates = vec![minus_one(-1.0), minus_one(1.0)];
            coordinates.extend(q.squares.iter().map(|s| root(s, 2.0)));
            let k = self.cone(ConeKind::SecondOrder, coordinates);
            return Some(Multiplier::Quadratic(k, -way));
        }
        if q.negative() > 1 || !q.rest.terms.is_empty() || q.rest.constant < 0.0 {
            return None;
        }
        let negative = q.squares.iter().position(|s| s.0 < 0.0)?;
        let (w, p) = q.squares.swap_remove(negative);
        let sign = [1.0, -1.0]
            .into_iter()
            .find(|&s| self.is_nonnegative(&times(&p, s)))?;
        let mut coordinates = vec![times(&p, sign * w.abs().sqrt())];
        coordinates.extend(q.squares.iter().map(|s| root(s, 1.0)));
        if q.rest.constant > 0.0 {
            coordinates.push(constant(q.rest.constant.sqrt()));
        }
        let k = self.with_apex(coordinates);
        Some(Multiplier::Square(k, -0.5 * way))
    }

    /// Whether bounds and linear rows imply that an expression is not below 0.
    fn is_nonnegative(&mut self, e: &Affine) -> bool {
        let least = |c: &Columns| {
            let terms = e.terms.iter().map(|&(j, a)| (j as usize, a));
            e.constant + Activity::of(terms, &c.lower, &c.upper).low()
        };
        if least(&self.columns) >= 0.0 {
            return true;
        }
        let implied = self
            .implied
            .get_or_insert_with(|| implied_bounds(self.instance));
        let known = e.terms.iter().all(|t| (t.0 as usize) < implied.lower.len());
        known && least(implied) >= -1e-12 * e.constant.abs().max(1.0)
    }

    fn range(&self, tree: &Tree, p: usize) -> Interval {
        composed(&tree.cut(p), &self.columns).range
    }

    /// An expression that is not below `weight` times the one that ends at p, and equal to it at its least.
    fn above(&mut self, tree: &Tree, p: usize, weight: f64) -> Option<Affine> {
        if let Some(affine) = affine(tree, p) {
            return Some(times(&affine, weight));
        }
        let arguments = tree.arguments(p);
        let number = |k: usize| arguments.get(k).and_then(|&a| tree.number(a));
        let convex = weight > 0.0;
        match (tree.whole.ops[p], &arguments[..]) {
            (Op::Add(_), all) => {
                let above = all.iter().map(|&a| self.above(tree, a, weight));
                Some(sum_of(above.collect::<Option<Vec<_>>>()?))
            }
            (Op::Negate, &[a]) => self.above(tree, a, -weight),
            (Op::Divide, &[a, b]) => {
                if let Some(c) = tree.number(b) {
                    return self.above(tree, a, weight / c);
                }
                // a / b = Σ squares / b
                let b = affine(tree, b).filter(|b| self.is_nonnegative(b))?;
                let squares = sum_of_squares(tree, a, weight)?;
                let v = self.new_column();
                let mut coordinates = vec![plus(v.clone(), &b, 1.0), plus(v.clone(), &b, -1.0)];
                coordinates.extend(squares.iter().map(|s| times(s, 2.0)));
                self.with_apex(coordinates);
                Some(v)
            }
            (Op::Multiply(_), all) => {
                let (number, rest) = tree.factors(all);
                let weight = weight * number;
                match rest[..] {
                    [a] => self.above(tree, a, weight),
                    [a, b] => self.product(tree, a, b, weight),
                    _ => None,
                }
            }
            (Op::PowerInt(k), &[a]) => self.power(tree, a, f64::from(k), true, weight),
            (Op::Call(Function::Sqr, _), &[a]) => self.power(tree, a, 2.0, true, weight),
            (Op::Call(Function::Power, _), &[a, _]) => {
                self.power(tree, a, number(1)?, true, weight)
            }
            (Op::Power | Op::Call(Function::RPower | Function::VcPower, _), &[a, _]) => {
                self.power(tree, a, number(1)?, false, weight)
            }
            (Op::Call(Function::Sqrt, _), &[a]) => self.power(tree, a, 0.5, false, weight),
            (Op::Call(Function::EDist, _), all) if convex => {
                let all: Option<Vec<Affine>> = all.iter().map(|&a| affine(tree, a)).collect();
                Some(self.norm(all?, weight))
            }
            (Op::Call(Function::Exp, _), &[a]) if convex => {
                let a = self.above(tree, a, 1.0)?;
                let v = self.new_column();
                self.cone(ConeKind::Exponential, vec![a, constant(1.0), v.clone()]);
                Some(times(&v, weight))
            }
            (Op::Call(f @ (Function::Log | Function::Log2 | Function::Log10), _), &[a]) => {
                let base = match f {
                    Function::Log2 => std::f64::consts::LN_2,
                    Function::Log10 => std::f64::consts::LN_10,
                    _ => 1.0,
                };
                let v = self.new_column();
                if convex {
                    self.exponentials(tree, a, &v)?;
                } else {
                    let a = times(&self.above(tree, a, -1.0)?, -1.0);
                    self.cone(ConeKind::Exponential, vec![v.clone(), constant(1.0), a]);
                }
                Some(times(&v, weight / base))
            }
            (Op::Call(Function::LseMax, _), all) if convex => {
                let v = self.new_column();
                let mut parts = vec![constant(-1.0)];
                for &a in all {
                    let a = self.above(tree, a, 1.0)?;
                    parts.push(self.below_exponential(&a, &v));
                }
                self.rows.push((sum_of(parts), [f64::NEG_INFINITY, 0.0]));
                Some(times(&v, weight))
            }
            // −x log x
            (Op::Call(Function::Entropy, _), &[a]) if !convex => {
                let x = affine(tree, a)?;
                Some(times(&self.relative_entropy(x, constant(1.0)), -weight))
            }
            _ => None,
        }
    }

    /// A column that is not below `weight` ‖all‖, times nothing more.
    fn norm(&mut self, all: Vec<Affine>, weight: f64) -> Affine {
        let v = self.new_column();
        let mut coordinates = vec![v.clone()];
        coordinates.extend(all);
        self.with_apex(coordinates);
        times(&v, weight)
    }

    /// A column that is not below x log(x/y).
    fn relative_entropy(&mut self, x: Affine, y: Affine) -> Affine {
        let v = self.new_column();
        self.cone(ConeKind::Exponential, vec![times(&v, -1.0), x, y]);
        v
    }

    /// A column that is not below exp(a − v).
    fn below_exponential(&mut self, a: &Affine, v: &Affine) -> Affine {
        let u = self.new_column();
        let difference = plus(a.clone(), v, -1.0);
        self.cone(
            ConeKind::Exponential,
            vec![difference, constant(1.0), u.clone()],
        );
        u
    }

    /// v ≥ log of a sum of exponentials and positive numbers.
    fn exponentials(&mut self, tree: &Tree, p: usize, v: &Affine) -> Option<()> {
        let mut parts = Parts::default();
        tree.split(p, 1.0, &mut parts);
        if !parts.linear.is_empty() || parts.constant < 0.0 {
            return None;
        }
        let mut all = vec![constant(-1.0)];
        if parts.constant > 0.0 {
            let a = constant(parts.constant.ln());
            all.push(self.below_exponential(&a, v));
        }
        for (weight, term) in &parts.nonlinear {
            let (tree, last) = (Tree::new(term), term.ops.len() - 1);
            match (term.ops[last], &tree.arguments(last)[..]) {
                (Op::Call(Function::Exp, _), &[a]) if *weight > 0.0 => {
                    let mut a = self.above(&tree, a, 1.0)?;
                    a.constant += weight.ln();
                    all.push(self.below_exponential(&a, v));
                }
                _ => return None,
            }
        }
        self.rows.push((sum_of(all), [f64::NEG_INFINITY, 0.0]));
        Some(())
    }

    /// `weight · a^power`; where `signed`, of arguments below 0 too.
    fn power(
        &mut self,
        tree: &Tree,
        a: usize,
        power: f64,
        signed: bool,
        weight: f64,
    ) -> Option<Affine> {
        let convex = weight > 0.0;
        if convex && power == 0.5 {
            let squares = sum_of_squares(tree, a, 1.0)?;
            return Some(self.norm(squares, weight));
        }
        let range = self.range(tree, a);
        let even = signed && power.rem_euclid(2.0) == 0.0;
        // a real power has no value below 0, which its cone must say or the bounds
        let right = range.low >= 0.0;
        let rising = power > 0.0;
        let x = match affine(tree, a) {
            Some(x) => x,
            // convex and rising of convex, convex and falling of concave, concave and rising of concave
            None if convex && rising && range.low >= 0.0 => self.above(tree, a, 1.0)?,
            None if rising != convex || !convex => times(&self.above(tree, a, -1.0)?, -1.0),
            None => return None,
        };
        let v = self.new_column();
        let one = constant(1.0);
        let (kind, coordinates) = match power {
            2.0 if convex && (even || right) => {
                let both = [plus(one.clone(), &v, 1.0), plus(one, &v, -1.0)];
                let mut all = both.to_vec();
                all.push(times(&x, 2.0));
                (ConeKind::SecondOrder, all)
            }
            p if p > 1.0 && convex && (even || right) => {
                (ConeKind::Power(1.0 / p), vec![v.clone(), one, x])
            }
            p if p < 0.0 && convex && (right || !signed) => {
                (ConeKind::Power(1.0 / (1.0 - p)), vec![v.clone(), x, one])
            }
            p if p > 0.0 && p < 1.0 && !convex => (ConeKind::Power(p), vec![x, one, v.clone()]),
            _ => return None,
        };
        self.cone(kind, coordinates);
        Some(times(&v, weight))
    }

    /// `weight · a · b`: a square, x log(x/y), y exp(x/y), or a geometric mean.
    fn product(&mut self, tree: &Tree, a: usize, b: usize, weight: f64) -> Option<Affine> {
        let convex = weight > 0.0;
        let (terms, last) = ([tree.cut(a), tree.cut(b)], |t: &Term| t.ops.len() - 1);
        if terms[0] == terms[1] {
            return self.power(tree, a, 2.0, true, weight);
        }
        for (x, f) in [(0, 1), (1, 0)] {
            let whole = |t: &Term| affine(&Tree::new(t), last(t));
            let Some(x) = whole(&terms[x]) else { continue };
            let inner = Tree::new(&terms[f]);
            let end = last(&terms[f]);
            let (op, arguments) = (terms[f].ops[end], inner.arguments(end));
            let quotient = |p: usize| match (inner.whole.ops[p], &inner.arguments(p)[..]) {
                (Op::Divide, &[a, b]) => Some((affine(&inner, a)?, affine(&inner, b)?)),
                _ => None,
            };
            match (op, &arguments[..]) {
                (Op::Call(Function::Log, _), &[p]) => {
                    let (over, under) =
                        quotient(p).or_else(|| Some((affine(&inner, p)?, constant(1.0))))?;
                    // x log(a x/y) and, concave, x log(y/(a x))
                    let (own, other, sign) = match convex {
                        true => (&over, &under, 1.0),
                        false => (&under, &over, -1.0),
                    };
                    if let Some(a) = multiple(own, &x) {
                        let y = times(other, 1.0 / a);
                        return Some(times(&self.relative_entropy(x, y), sign * weight));
                    }
                }
                (Op::Call(Function::Exp, _), &[p]) if convex => {
                    if let Some((over, under)) = quotient(p).filter(|q| q.1 == x) {
                        let v = self.new_column();
                        self.cone(ConeKind::Exponential, vec![over, under, v.clone()]);
                        return Some(times(&v, weight));
                    }
                }
                _ => {}
            }
        }
        let [a, b] = [0, 1].map(|k| root_of(&terms[k]));
        let ((x, p), (y, q)) = (a?, b?);
        if convex || p <= 0.0 || q <= 0.0 || (p + q - 1.0).abs() > 1e-12 {
            return None;
        }
        let v = self.new_column();
        self.cone(ConeKind::Power(p), vec![x, y, v.clone()]);
        Some(times(&v, weight))
    }
}

/// A real power of an affine expression, with its exponent.
fn root_of(term: &Term) -> Option<(Affine, f64)> {
    let (tree, last) = (Tree::new(term), term.ops.len() - 1);
    let power = match (term.ops[last], &tree.arguments(last)[..]) {
        (Op::Call(Function::Sqrt, _), &[a]) => (a, 0.5),
        (Op::Power | Op::Call(Function::RPower | Function::VcPower, _), &[a, p]) => {
            (a, tree.number(p)?)
        }
        _ => return None,
    };
    Some((affine(&tree, power.0)?, power.1))
}

/// The positive number that makes the one of the other, rounding aside.
fn multiple(of: &Affine, one: &Affine) -> Option<f64> {
    let a = of.terms.first()?.1 / one.terms.first()?.1;
    let rest = plus(of.clone(), one, -a);
    let near = |v: f64, of: f64| v.abs() <= 4.0 * f64::EPSILON * of.abs();
    let size = of
        .terms
        .iter()
        .fold(of.constant.abs(), |t, e| t.max(e.1.abs()));
    let same = near(rest.constant, size) && rest.terms.iter().all(|e| near(e.1, size));
    (a > 0.0 && same).then_some(a)
}

/// Bounds of the columns that linear rows imply.
fn implied_bounds(instance: &Instance) -> Columns {
    let mut c = instance.columns.clone();
    let nonlinear = instance.nonlinear_rows();
    for _ in 0..PROPAGATION_ROUNDS {
        let mut changed = false;
        for i in (0..instance.row_count()).filter(|&i| !nonlinear[i]) {
            let sides = instance.rows.relation[i].bounds(instance.rows.rhs[i]);
            let activity = Activity::of(instance.matrix.row(i), &c.lower, &c.upper);
            // a x_j is what the sides leave to it
            let left = |(j, a): (usize, f64)| {
                let others = activity.without(term(a, [c.lower[j], c.upper[j]]));
                let ends = [(sides[0] - others[1]) / a, (sides[1] - others[0]) / a];
                (j, if a > 0.0 { ends } else { [ends[1], ends[0]] })
            };
            let entries = instance.matrix.row(i).filter(|e| e.1 != 0.0);
            let tighter: Vec<(usize, [f64; 2])> = entries.map(left).collect();
            for (j, [low, high]) in tighter {
                changed |= low > c.lower[j] || high < c.upper[j];
                c.lower[j] = c.lower[j].max(low);
                c.upper[j] = c.upper[j].min(high);
            }
        }
        if !changed {
            break;
        }
    }
    c
}
