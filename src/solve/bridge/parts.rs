//! Terms taken apart: a kernel as a weighted sum of constants, variables and what cannot be split further.

use crate::model::builder::Term;
use crate::model::instance::{Function, Instance, Op, Relation};

/// All nonlinear terms: row, coefficient, expression.
pub(in crate::solve) fn expressions(
    instance: &Instance,
) -> impl Iterator<Item = (usize, f64, Term)> {
    instance.nonlinear.iter().flat_map(|t| {
        t.terms().map(|slots| {
            let expression = Term {
                ops: t.kernel.ops.clone(),
                columns: slots.columns.to_vec(),
                constants: slots.constants.to_vec(),
            };
            (slots.row, slots.coef, expression)
        })
    })
}

/// By row: 1 where its left side is to be small, −1 where it is to be large, 0 where it is given. In the row that defines the
/// objective, what makes the objective better makes its other terms larger or smaller.
pub(in crate::solve) fn directions(instance: &Instance) -> Vec<f64> {
    let of = |r: &Relation| match r {
        Relation::Less => 1.0,
        Relation::Greater => -1.0,
        Relation::Equal | Relation::Free => 0.0,
    };
    let mut direction: Vec<f64> = instance.rows.relation.iter().map(of).collect();
    // a z + f(x) = c: what makes z better makes a·sign·f larger
    if let (Some(o), Some((row, a))) = (instance.objective, instance.objective_row())
        && instance.is_free(o.column as usize)
        && instance.rows.relation[row] == Relation::Equal
    {
        direction[row] = -(a * o.sense.sign()).signum();
    }
    direction
}

/// A weighted sum.
#[derive(Debug, Default)]
pub(in crate::solve) struct Parts {
    pub(in crate::solve) constant: f64,
    pub(in crate::solve) linear: Vec<(u32, f64)>,
    /// Anything else, with its weight.
    pub(in crate::solve) nonlinear: Vec<(f64, Term)>,
}

impl Term {
    /// `weight` times the expression, split.
    pub(in crate::solve) fn parts(&self, weight: f64) -> Parts {
        let mut parts = Parts::default();
        let tree = Tree::new(self);
        tree.split(self.ops.len() - 1, weight, &mut parts);
        parts
    }

    /// The expression with a column in place of each sum of `least` or more entries that stands in it, none of them inside
    /// another; `make` gives the column, or refuses.
    pub(in crate::solve) fn without_sums(
        &self,
        least: usize,
        make: &mut dyn FnMut(Parts) -> Option<u32>,
    ) -> Self {
        let mut out = Self::default();
        let tree = Tree::new(self);
        tree.rewrite(self.ops.len() - 1, least, make, &mut out);
        out
    }

    /// The expression with a column in place of each function with kinks; `make` gives the column for a function and its
    /// arguments, the inner one of two first.
    pub(super) fn without_kinks(&self, make: &mut dyn FnMut(Function, Vec<Self>) -> u32) -> Self {
        Tree::new(self).smooth(self.ops.len() - 1, make)
    }

    /// Function and arguments, if a function with kinks comes last.
    pub(in crate::solve) fn kink(&self) -> Option<(Function, Vec<Term>)> {
        let last = self.ops.len() - 1;
        match self.ops[last] {
            Op::Call(f @ (Function::Max | Function::Min | Function::Abs), _) => {
                let tree = Tree::new(self);
                let arguments = tree.arguments(last).into_iter();
                Some((f, arguments.map(|p| tree.cut(p)).collect()))
            }
            _ => None,
        }
    }

    /// How many affine expressions it depends on its columns by.
    pub(in crate::solve) fn sums(&self) -> usize {
        let leaf = |op: &&Op| matches!(op, Op::Var(_) | Op::Affine(..));
        self.ops.iter().filter(leaf).count()
    }

    /// Whether a function with kinks stands anywhere in it.
    pub(in crate::solve) fn has_kink(&self) -> bool {
        has_kink(&self.ops)
    }
}

pub(in crate::solve) fn has_kink(ops: &[Op]) -> bool {
    let kink = |op: &Op| {
        matches!(
            op,
            Op::Call(Function::Max | Function::Min | Function::Abs, _)
        )
    };
    ops.iter().any(kink)
}

/// Where the subexpression that ends at each operation begins.
pub(in crate::solve) struct Tree<'e> {
    pub(in crate::solve) whole: &'e Term,
    pub(in crate::solve) begin: Vec<usize>,
}

impl<'e> Tree<'e> {
    pub(in crate::solve) fn new(whole: &'e Term) -> Self {
        let mut begin: Vec<usize> = Vec::with_capacity(whole.ops.len());
        for (p, op) in whole.ops.iter().enumerate() {
            let first = (0..op.arguments()).fold(p, |end, _| begin[end - 1]);
            begin.push(first);
        }
        Self { whole, begin }
    }

    /// Ends of the arguments of the operation at p, in order.
    pub(in crate::solve) fn arguments(&self, p: usize) -> Vec<usize> {
        let mut ends = Vec::new();
        let mut next = p;
        for _ in 0..self.whole.ops[p].arguments() {
            ends.push(next - 1);
            next = self.begin[next - 1];
        }
        ends.reverse();
        ends
    }

    /// The number that the subexpression ending at p is, if it is one.
    pub(in crate::solve) fn number(&self, p: usize) -> Option<f64> {
        match self.whole.ops[p] {
            Op::Const(k) => Some(self.whole.constants[k as usize]),
            Op::Negate => Some(-self.number(p - 1)?),
            _ => None,
        }
    }

    /// The product of the factors that are numbers, and the ends of the others.
    pub(in crate::solve) fn factors(&self, all: &[usize]) -> (f64, Vec<usize>) {
        let numbers = all.iter().filter_map(|&a| self.number(a));
        let others = all.iter().copied();
        let others = others.filter(|&a| self.number(a).is_none());
        (numbers.product(), others.collect())
    }

    pub(in crate::solve) fn split(&self, p: usize, weight: f64, out: &mut Parts) {
        let (columns, constants) = (&self.whole.columns, &self.whole.constants);
        let arguments = self.arguments(p);
        match (self.whole.ops[p], &arguments[..]) {
            (Op::Const(k), _) => out.constant += weight * constants[k as usize],
            (Op::Var(k), _) => out.linear.push((columns[k as usize], weight)),
            (Op::Affine(constant, variable, terms), _) => {
                let (c, v, n) = (constant as usize, variable as usize, terms as usize);
                out.constant += weight * constants[c];
                let slopes = columns[v..v + n].iter().zip(&constants[c + 1..c + 1 + n]);
                out.linear.extend(slopes.map(|(&j, a)| (j, weight * a)));
            }
            (Op::Add(_), all) => all.iter().for_each(|&a| self.split(a, weight, out)),
            (Op::Negate, &[a]) => self.split(a, -weight, out),
            (Op::Divide, &[a, b]) if self.number(b).is_some_and(|c| c != 0.0) => {
                self.split(a, weight / self.number(b).unwrap_or(1.0), out);
            }
            (Op::Multiply(_), all) => {
                let (number, rest) = self.factors(all);
                match rest[..] {
                    [a] => self.split(a, weight * number, out),
                    _ => out.nonlinear.push((weight, self.cut(p))),
                }
            }
            _ => out.nonlinear.push((weight, self.cut(p))),
        }
    }

    /// The subexpression that ends at p, with slots of its own.
    pub(in crate::solve) fn cut(&self, p: usize) -> Term {
        let mut out = Term::default();
        for q in self.begin[p]..=p {
            out.copy(self.whole, self.whole.ops[q]);
        }
        out
    }

    /// See [`Term::without_sums`].
    fn rewrite(
        &self,
        p: usize,
        least: usize,
        make: &mut dyn FnMut(Parts) -> Option<u32>,
        out: &mut Term,
    ) {
        let op = self.whole.ops[p];
        let size = match op {
            Op::Affine(_, _, terms) => terms as usize,
            Op::Add(_) => p + 1 - self.begin[p],
            _ => 0,
        };
        if size >= least {
            let mut parts = Parts::default();
            self.split(p, 1.0, &mut parts);
            if let Some(column) = make(parts) {
                out.ops.push(Op::Var(out.columns.len() as u32));
                out.columns.push(column);
                return;
            }
        }
        for argument in self.arguments(p) {
            self.rewrite(argument, least, make, out);
        }
        out.copy(self.whole, op);
    }

    /// See [`Term::without_kinks`].
    fn smooth(&self, p: usize, make: &mut dyn FnMut(Function, Vec<Term>) -> u32) -> Term {
        let ends = self.arguments(p).into_iter();
        let arguments: Vec<Term> = ends.map(|a| self.smooth(a, make)).collect();
        match self.whole.ops[p] {
            Op::Call(f @ (Function::Max | Function::Min | Function::Abs), _) => {
                Term::column(make(f, arguments) as usize)
            }
            op => {
                let mut out = Term::default();
                arguments.into_iter().for_each(|a| out.append(a));
                out.copy(self.whole, op);
                out
            }
        }
    }
}
