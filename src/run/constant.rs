//! Value of a kernel without variables (all of them held fixed, or all sums empty).

use crate::autodiff::functions::{self, DomainError, function_value};
use crate::model::instance::Op;

/// Runs a program that reads constants only.
pub fn evaluate(ops: &[Op], constants: &[f64]) -> Result<f64, DomainError> {
    let mut stack: Vec<f64> = Vec::new();
    for op in ops {
        let mut pop = || stack.pop().unwrap_or(0.0);
        let v = match *op {
            Op::Const(k) => constants[k as usize],
            Op::Affine { constant, .. } => constants[constant as usize],
            Op::Var(_) => 0.0,
            Op::Add => pop() + pop(),
            Op::Subtract => {
                let b = pop();
                pop() - b
            }
            Op::Multiply => pop() * pop(),
            Op::Divide => {
                let b = pop();
                functions::divide(pop(), b)?
            }
            Op::Negate => -pop(),
            Op::Power => {
                let b = pop();
                functions::real_power(pop(), b)?
            }
            Op::PowerInt(n) => functions::whole_power(pop(), n)?,
            Op::AddN(n) => (0..n).map(|_| pop()).sum(),
            Op::MultiplyN(n) => (0..n).map(|_| pop()).product(),
            Op::Call(f, n) => {
                let at = stack.len().saturating_sub(n as usize);
                let v = function_value(f, &stack[at..])?;
                stack.truncate(at);
                v
            }
        };
        stack.push(v);
    }
    Ok(stack.pop().unwrap_or(0.0))
}
