//! Kernels that are simpler than they look: numbers (all sums empty, all variables held fixed) and
//! affine forms (a product in which all but one variable are held fixed).

use crate::autodiff::functions::{self, DomainError, function_value};
use crate::model::instance::Op;

/// A constant and coefficients of variable slots, in the order in which they were met.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Affine {
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
pub fn affine(ops: &[Op], constants: &[f64]) -> Result<Option<Affine>, DomainError> {
    // None is anything else.
    let mut stack: Vec<Option<Affine>> = Vec::new();
    for op in ops {
        let count = match *op {
            Op::Const(_) | Op::Affine { .. } | Op::Var(_) => 0,
            Op::Negate | Op::PowerInt(_) => 1,
            Op::AddN(n) | Op::MultiplyN(n) | Op::Call(_, n) => n as usize,
            Op::Add | Op::Subtract | Op::Multiply | Op::Divide | Op::Power => 2,
        };
        let args = stack.split_off(stack.len().saturating_sub(count));
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
            (
                Op::Affine {
                    constant,
                    variable,
                    terms,
                },
                _,
            ) => Some(Affine {
                constant: constants[constant as usize],
                terms: (0..terms)
                    .map(|t| (variable + t, constants[(constant + 1 + t) as usize]))
                    .collect(),
            }),
            (Op::Add | Op::AddN(_), _) => args
                .into_iter()
                .try_fold(Affine::default(), |s, a| Some(s.plus(a?))),
            (Op::Subtract, _) => match <[_; 2]>::try_from(args) {
                Ok([Some(a), Some(b)]) => Some(a.plus(b.scaled(-1.0))),
                _ => None,
            },
            (Op::Negate, _) => args.into_iter().flatten().next().map(|a| a.scaled(-1.0)),
            (Op::Multiply | Op::MultiplyN(_), _) => product(&args),
            (Op::Divide, Some(&[a, b])) => Some(Affine::number(functions::divide(a, b)?)),
            (Op::Divide, _) => match <[_; 2]>::try_from(args) {
                Ok([Some(a), Some(b)]) => match b.as_number() {
                    Some(b) => Some(a.scaled(functions::divide(1.0, b)?)),
                    None => None,
                },
                _ => None,
            },
            (Op::Power, Some(&[a, b])) => Some(Affine::number(functions::real_power(a, b)?)),
            (Op::PowerInt(n), Some(&[a])) => Some(Affine::number(functions::whole_power(a, n)?)),
            (Op::Call(f, _), Some(a)) => Some(Affine::number(function_value(f, a)?)),
            (Op::Power | Op::PowerInt(_) | Op::Call(..), _) => None,
        };
        stack.push(value);
    }
    Ok(stack.pop().flatten())
}
