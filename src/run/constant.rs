//! Kernels that are simpler than they look: numbers (all sums empty, all variables held fixed), products with
//! a 0 that is found only now (a sum over nothing), and affine forms (a product in which all but one variable
//! are held fixed).

use crate::autodiff::functions::{self, DomainError, function_value};
use crate::model::builder::Term;
use crate::model::instance::Op;

/// A value on the stack of [`Term::folded`].
enum Part {
    Number(f64),
    Code(Term),
}

impl Term {
    /// Appends a number.
    pub(super) fn number(&mut self, x: f64) {
        self.ops.push(Op::Const(self.constants.len() as u32));
        self.constants.push(x);
    }

    /// Whether 0 stands in it as a number.
    pub(super) fn has_zero(&self) -> bool {
        let zero = |op: &Op| matches!(*op, Op::Const(k) if self.constants[k as usize] == 0.0);
        self.ops.iter().any(zero)
    }

    /// Appends a number or a program.
    fn append_part(&mut self, part: Part) {
        match part {
            Part::Number(x) => self.number(x),
            Part::Code(part) => self.append(part),
        }
    }

    /// The same with functions of numbers computed, and without products with 0 and 0 divided by something: such
    /// variables do not occur, as in GAMS.
    pub(super) fn folded(&self) -> Result<Self, DomainError> {
        let mut stack: Vec<Part> = Vec::new();
        for &op in &self.ops {
            let args = stack.split_off(stack.len().saturating_sub(op.arguments()));
            let number = |p: &Part| match p {
                Part::Number(x) => Some(*x),
                Part::Code(_) => None,
            };
            let numbers: Option<Vec<f64>> = args.iter().map(number).collect();
            let zero = |p: &Part| number(p) == Some(0.0);
            let value = match (op, numbers) {
                (Op::Const(k), _) => Part::Number(self.constants[k as usize]),
                (Op::Multiply(_), _) if args.iter().any(zero) => Part::Number(0.0),
                (Op::Divide, None) if zero(&args[0]) => Part::Number(0.0),
                (Op::Var(_) | Op::Affine(..), _) => {
                    let mut code = Self::default();
                    code.copy(self, op);
                    Part::Code(code)
                }
                (op, Some(numbers)) => Part::Number(value(op, &numbers)?),
                (op, None) => {
                    let mut code = Self::default();
                    args.into_iter().for_each(|a| code.append_part(a));
                    code.ops.push(op);
                    Part::Code(code)
                }
            };
            stack.push(value);
        }
        let mut out = Self::default();
        stack.into_iter().for_each(|p| out.append_part(p));
        Ok(out)
    }
}

/// What an operation makes of numbers.
fn value(op: Op, a: &[f64]) -> Result<f64, DomainError> {
    Ok(match (op, a) {
        (Op::Divide, &[a, b]) => functions::divide(a, b)?,
        (Op::Power, &[a, b]) => functions::real_power(a, b)?,
        (Op::PowerInt(n), &[a]) => functions::whole_power(a, n)?,
        (Op::Call(f, _), a) => function_value(f, a)?,
        (Op::Negate, &[a]) => -a,
        (Op::Multiply(_), a) => a.iter().product(),
        (_, a) => a.iter().sum(),
    })
}

/// A constant and coefficients of variable slots, in the order in which they were met.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Affine {
    /// What does not depend on variables.
    pub constant: f64,
    /// Variable slot and coefficient.
    pub terms: Vec<(u32, f64)>,
}

impl Affine {
    fn number(constant: f64) -> Self {
        Self {
            constant,
            terms: Vec::new(),
        }
    }

    fn scaled(mut self, by: f64) -> Self {
        self.constant *= by;
        self.terms.iter_mut().for_each(|t| t.1 *= by);
        self
    }

    fn plus(mut self, other: Self) -> Self {
        self.constant += other.constant;
        self.terms.extend(other.terms);
        self
    }

    fn as_number(&self) -> Option<f64> {
        self.terms.is_empty().then_some(self.constant)
    }
}

/// The product, if all factors but one are numbers or one is 0.
fn product(factors: &[Option<Affine>]) -> Option<Affine> {
    let (mut number, mut other, mut several) = (1.0, Some(Affine::number(1.0)), 0);
    for f in factors {
        match f.as_ref().and_then(Affine::as_number) {
            Some(x) => number *= x,
            None => {
                other.clone_from(f);
                several += 1;
            }
        }
    }
    match (number, several) {
        (0.0, _) => Some(Affine::default()),
        (_, 0 | 1) => other.map(|a| a.scaled(number)),
        _ => None,
    }
}

/// The affine form that a program computes by its structure, if it does: sums, products with numbers,
/// and any function of numbers.
pub(super) fn affine(ops: &[Op], constants: &[f64]) -> Result<Option<Affine>, DomainError> {
    // None is anything else.
    let mut stack: Vec<Option<Affine>> = Vec::new();
    for op in ops {
        let args = stack.split_off(stack.len().saturating_sub(op.arguments()));
        let numbers: Option<Vec<f64>> = args
            .iter()
            .map(|a| a.as_ref().and_then(Affine::as_number))
            .collect();
        let value = match (*op, numbers.as_deref()) {
            (Op::Const(k), _) => Some(Affine::number(constants[k as usize])),
            (Op::Var(v), _) => Some(Affine {
                constant: 0.0,
                terms: vec![(v, 1.0)],
            }),
            (Op::Affine(constant, variable, terms), _) => Some(Affine {
                constant: constants[constant as usize],
                terms: (0..terms)
                    .map(|t| (variable + t, constants[(constant + 1 + t) as usize]))
                    .collect(),
            }),
            (Op::Add(_), _) => args
                .into_iter()
                .try_fold(Affine::default(), |s, a| Some(s.plus(a?))),
            (Op::Negate, _) => args.into_iter().flatten().next().map(|a| a.scaled(-1.0)),
            (Op::Multiply(_), _) => product(&args),
            (op @ (Op::Divide | Op::Power | Op::PowerInt(_) | Op::Call(..)), Some(a)) => {
                Some(Affine::number(value(op, a)?))
            }
            (Op::Divide, _) => match <[_; 2]>::try_from(args) {
                Ok([Some(a), Some(b)]) => match b.as_number() {
                    Some(b) => Some(a.scaled(functions::divide(1.0, b)?)),
                    None => None,
                },
                _ => None,
            },
            (Op::Power | Op::PowerInt(_) | Op::Call(..), _) => None,
        };
        stack.push(value);
    }
    Ok(stack.pop().flatten())
}
