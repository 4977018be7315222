//! The terms of a row: linear ones by column, the rest as programs.
//!
//! A program is the postfix form of one nonlinear term; terms that differ in columns and constants
//! only share their kernel.

use super::{Builder, EPS_COEFFICIENT, Row, without_eps};
use crate::autodiff::functions::DomainError;
use crate::check::node::*;
use crate::data::value::{is_eps, truth};
use crate::model::builder::Term;
use crate::model::instance::*;
use crate::run::Frame;
use crate::run::constant::{self, Affine};
use crate::run::plan::Wanted;

impl Builder<'_, '_> {
    fn add(&mut self, column: u32, coef: f64, row: &mut Row) {
        if row.part {
            row.terms.push((column, coef));
            return;
        }
        let p = &mut self.place[column as usize];
        if *p == 0 {
            row.terms.push((column, coef));
            *p = row.terms.len() as u32;
        } else {
            row.terms[*p as usize - 1].1 += coef;
        }
    }

    /// A value that goes into the instance: eps is 0.
    fn value(&self, n: &Node, frame: &mut Frame) -> f64 {
        let v = self.m.eval(n, frame);
        if is_eps(v) { 0.0 } else { v }
    }

    /// Adds `coef · n` to the row.
    pub(super) fn emit(&mut self, n: &Node, coef: f64, frame: &mut Frame, row: &mut Row) {
        if !n.has_var {
            row.constant += coef * self.value(n, frame);
            return;
        }
        match &n.kind {
            NodeKind::Var(s, key) => match self.reference(*s, key, frame) {
                Some(Ok(c)) => self.add(c, coef, row),
                Some(Err(x)) => row.constant += coef * x,
                None => {}
            },
            NodeKind::Sum(terms) => {
                for (minus, t) in terms {
                    self.emit(t, if *minus { -coef } else { coef }, frame, row);
                }
            }
            NodeKind::Product(factors) => {
                let Some((c, var)) = self.split(factors, frame) else {
                    return;
                };
                let c = coef * c;
                if c == 0.0 {
                    return;
                }
                match var {
                    Some(f) => self.emit(f, c, frame, row),
                    None => self.emit_nonlinear(n, coef, frame, row),
                }
            }
            NodeKind::Dollar(a, c) => {
                if truth(self.m.eval(c, frame)) {
                    self.emit(a, coef, frame, row);
                }
            }
            NodeKind::Aggregate(AggregateOp::Sum, d, body) => {
                let m = self.m;
                let plan = m.plan(d, Wanted::nonzero(Some(body)));
                m.run_plan(d, &plan, frame, &mut |f| {
                    self.emit(body, coef, f, row);
                    !self.failed && m.keep_going()
                });
            }
            _ => self.emit_nonlinear(n, coef, frame, row),
        }
    }

    /// Splits a product into its data and the one linear factor with variables, if there is just one
    /// and it does not divide. None: the data part is not a number (an error was noted).
    fn split<'n>(
        &self,
        factors: &'n [(bool, Node)],
        frame: &mut Frame,
    ) -> Option<(f64, Option<&'n Node>)> {
        let mut c = 1.0;
        let mut var = None;
        let mut several = false;
        for (divide, f) in factors {
            if f.has_var {
                several |= var.is_some() || *divide;
                var = Some(f);
                continue;
            }
            let v = self.m.eval(f, frame);
            let v = match (is_eps(v), divide) {
                (true, false) => EPS_COEFFICIENT,
                (true, true) => 0.0,
                _ => v,
            };
            if *divide {
                if v == 0.0 {
                    self.m.execution_error(
                        "E0401",
                        f.span,
                        "division by zero".into(),
                        "guard it with a condition, `(x/b)$b`",
                    );
                    return None;
                }
                c /= v;
            } else {
                c *= v;
            }
        }
        Some((c, if several { None } else { var }))
    }

    fn emit_nonlinear(&mut self, n: &Node, mut coef: f64, frame: &mut Frame, row: &mut Row) {
        if coef == 0.0 {
            return;
        }
        let mut tape = Term::default();
        self.build(n, frame, &mut tape);
        // With zeros in it, or with variables held fixed, it may be a number or linear after all. A
        // kernel that is there already is neither.
        let zero = tape.has_zero();
        let mut known = self.kernels.get(&tape.ops).copied();
        if zero || self.options.hold_fixed || known.is_none() {
            match simplified(tape, zero) {
                Ok((Some(a), tape)) => {
                    row.constant += coef * a.constant;
                    for (v, c) in a.terms {
                        self.add(tape.columns[v as usize], coef * c, row);
                    }
                    return;
                }
                Ok((None, simpler)) => {
                    known = self.kernels.get(&simpler.ops).copied();
                    tape = simpler;
                }
                Err(e) => {
                    self.m.execution_error(
                        "E0403",
                        n.span,
                        e.to_string(),
                        "guard it with a condition",
                    );
                    return;
                }
            }
        }
        let k = match known {
            Some(k) => k,
            None => {
                let k = self.instance.nonlinear.len();
                let kernel = tape.kernel();
                self.kernels.insert(tape.ops, k);
                self.instance.nonlinear.push(KernelTerms::new(kernel));
                k
            }
        };
        self.nonlinear_terms += 1;
        for c in tape.constants.iter_mut().chain([&mut coef]) {
            *c = without_eps(*c);
            self.not_a_number |= c.is_nan();
        }
        self.instance.nonlinear[k].push(self.row, coef, &tape.columns, &tape.constants);
    }

    /// Appends an affine expression.
    fn affine(&mut self, part: Row, tape: &mut Term) {
        let terms: Vec<(u32, f64)> = part.terms.iter().copied().filter(|t| t.1 != 0.0).collect();
        match terms.as_slice() {
            [] => tape.number(part.constant),
            [(c, v)] if *v == 1.0 && part.constant == 0.0 => {
                tape.ops.push(Op::Var(tape.columns.len() as u32));
                tape.columns.push(*c);
            }
            _ => {
                tape.ops.push(Op::Affine(
                    tape.constants.len() as u32,
                    tape.columns.len() as u32,
                    terms.len() as u32,
                ));
                tape.constants.push(part.constant);
                for (c, v) in terms {
                    tape.constants.push(v);
                    tape.columns.push(c);
                }
            }
        }
    }

    fn linear(&mut self, n: &Node, frame: &mut Frame, tape: &mut Term) {
        let mut part = Row::part();
        self.emit(n, 1.0, frame, &mut part);
        merge_terms(&mut part.terms);
        self.affine(part, tape);
    }

    /// Appends the program of an expression: leaves one value.
    fn build(&mut self, n: &Node, frame: &mut Frame, tape: &mut Term) {
        if !n.has_var {
            let v = self.value(n, frame);
            tape.number(v);
            return;
        }
        if n.linear {
            self.linear(n, frame, tape);
            return;
        }
        match &n.kind {
            NodeKind::Not(a) => {
                self.build(a, frame, tape);
                tape.ops.push(Op::Call(Function::BoolNot, 1));
            }
            NodeKind::Sum(terms) => {
                let (mut part, mut count) = (Row::part(), 0u32);
                for (minus, t) in terms {
                    if t.linear {
                        self.emit(t, if *minus { -1.0 } else { 1.0 }, frame, &mut part);
                        continue;
                    }
                    self.build(t, frame, tape);
                    if *minus {
                        tape.ops.push(Op::Negate);
                    }
                    count += 1;
                }
                merge_terms(&mut part.terms);
                if !part.terms.is_empty() || part.constant != 0.0 || count == 0 {
                    self.affine(part, tape);
                    count += 1;
                }
                add_n(count, tape);
            }
            NodeKind::Product(factors) => self.build_product(factors, frame, tape),
            NodeKind::Dollar(a, c) => {
                if truth(self.m.eval(c, frame)) {
                    self.build(a, frame, tape);
                } else {
                    tape.number(0.0);
                }
            }
            NodeKind::Binary(op, a, b) => self.build_binary(*op, a, b, frame, tape),
            NodeKind::Call(f, args) => match (f, args.as_slice()) {
                (Function::Sqr, [a]) => {
                    self.build(a, frame, tape);
                    tape.ops.push(Op::PowerInt(2));
                }
                (Function::Power, [a, b]) if !b.has_var => {
                    let p = self.value(b, frame);
                    if p.fract() != 0.0 || p.abs() > 1e6 {
                        self.m.execution_error(
                            "E0403",
                            b.span,
                            format!("the exponent of `power` is {p}; it must be a whole number"),
                            "use `**` or `rpower` for real exponents",
                        );
                    }
                    self.build(a, frame, tape);
                    tape.ops.push(Op::PowerInt(p as i32));
                }
                _ => {
                    for a in args {
                        self.build(a, frame, tape);
                    }
                    tape.ops.push(Op::Call(*f, args.len() as u32));
                }
            },
            NodeKind::Aggregate(op, d, body) => self.build_aggregate(*op, d, body, frame, tape),
            _ => tape.number(0.0),
        }
    }

    fn build_product(&mut self, factors: &[(bool, Node)], frame: &mut Frame, tape: &mut Term) {
        let Some((c, _)) = self.split(factors, frame) else {
            tape.number(0.0);
            return;
        };
        if c == 0.0 {
            tape.number(0.0);
            return;
        }
        let mut count = 0;
        for (_, f) in factors.iter().filter(|(d, f)| f.has_var && !d) {
            self.build(f, frame, tape);
            count += 1;
        }
        if c != 1.0 || count == 0 {
            tape.number(c);
            count += 1;
        }
        multiply_n(count, tape);
        let mut below = 0;
        for (_, f) in factors.iter().filter(|(d, f)| f.has_var && *d) {
            self.build(f, frame, tape);
            below += 1;
        }
        if below > 0 {
            multiply_n(below, tape);
            tape.ops.push(Op::Divide);
        }
    }

    fn build_binary(
        &mut self,
        op: BinaryOp,
        a: &Node,
        b: &Node,
        frame: &mut Frame,
        tape: &mut Term,
    ) {
        self.build(a, frame, tape);
        self.build(b, frame, tape);
        tape.ops.push(match op {
            BinaryOp::Power => Op::Power,
            BinaryOp::Eq => Op::Call(Function::RelEq, 2),
            BinaryOp::Ne => Op::Call(Function::RelNe, 2),
            BinaryOp::Lt => Op::Call(Function::RelLt, 2),
            BinaryOp::Le => Op::Call(Function::RelLe, 2),
            BinaryOp::Gt => Op::Call(Function::RelGt, 2),
            BinaryOp::Ge => Op::Call(Function::RelGe, 2),
            BinaryOp::And => Op::Call(Function::BoolAnd, 2),
            BinaryOp::Or => Op::Call(Function::BoolOr, 2),
            BinaryOp::Xor => Op::Call(Function::BoolXor, 2),
            BinaryOp::Implies => Op::Call(Function::BoolImp, 2),
            BinaryOp::Equivalent => Op::Call(Function::BoolEqv, 2),
            _ => Op::Add(2),
        });
    }

    fn build_aggregate(
        &mut self,
        op: AggregateOp,
        d: &Domain,
        body: &Node,
        frame: &mut Frame,
        tape: &mut Term,
    ) {
        let m = self.m;
        let sum = op == AggregateOp::Sum;
        let plan = m.plan(d, Wanted::nonzero(sum.then_some(body)));
        let mut count = 0u32;
        m.run_plan(d, &plan, frame, &mut |f| {
            self.build(body, f, tape);
            count += 1;
            m.keep_going()
        });
        if count == 0 {
            tape.number(op.of_nothing());
        }
        let pairs = count.saturating_sub(1) as usize;
        let each = |f| std::iter::repeat_n(Op::Call(f, 2), pairs);
        match op {
            AggregateOp::Sum => add_n(count, tape),
            AggregateOp::Prod => multiply_n(count, tape),
            AggregateOp::Smin if count > 1 => tape.ops.push(Op::Call(Function::Min, count)),
            AggregateOp::Smax if count > 1 => tape.ops.push(Op::Call(Function::Max, count)),
            AggregateOp::Smin | AggregateOp::Smax => {}
            AggregateOp::Sand => tape.ops.extend(each(Function::BoolAnd)),
            AggregateOp::Sor => tape.ops.extend(each(Function::BoolOr)),
        }
    }
}

/// The tape, folded if there is a zero in it, and its affine form if it has one.
fn simplified(tape: Term, zero: bool) -> Result<(Option<Affine>, Term), DomainError> {
    let tape = if zero { tape.folded()? } else { tape };
    Ok((constant::affine(&tape.ops, &tape.constants)?, tape))
}

fn add_n(n: u32, tape: &mut Term) {
    match n {
        0 | 1 => {}
        n => tape.ops.push(Op::Add(n)),
    }
}

fn multiply_n(n: u32, tape: &mut Term) {
    match n {
        0 | 1 => {}
        n => tape.ops.push(Op::Multiply(n)),
    }
}

/// Sorts terms by column and adds up those of the same.
fn merge_terms(terms: &mut Vec<(u32, f64)>) {
    if terms.windows(2).all(|w| w[0].0 < w[1].0) {
        return;
    }
    terms.sort_by_key(|t| t.0);
    terms.dedup_by(|b, a| {
        let same = a.0 == b.0;
        if same {
            a.1 += b.1;
        }
        same
    });
}
