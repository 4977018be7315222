//! Straight-line code made ready to run, many terms at a time.
//!
//! Steps that no output needs are dropped, a product that is only added becomes one
//! multiply-and-add, and registers are assigned in one linear scan. A register holds W lanes: the
//! same quantity of W terms. Each instruction is a loop over lanes, so the cost of finding out what to
//! do is paid once per W terms, and the loops are vectorised.
//!
//! Invariant: the register an instruction writes is none of those it reads.

use super::derive::Code;
use super::functions::{HUGE, TINY, function_value, powi};
use super::partials::partials;
use super::steps::{Action, NONE, Step};
use crate::model::instance::Function;

/// Number of a register.
type Register = u32;

#[derive(Clone, Copy, Debug)]
enum Instruction {
    Compute {
        action: Action,
        to: Register,
        from: [Register; 3],
    },
    Call(u32),
    Store {
        entry: u32,
        from: Register,
    },
}

#[derive(Clone, Debug)]
struct CallSite {
    function: Function,
    args: Vec<Register>,
    active: Vec<bool>,
    order: u8,
    /// (part, register) of the outputs that are needed.
    parts: Vec<(u32, Register)>,
}

/// Code ready to run.
#[derive(Clone, Debug, Default)]
pub(super) struct Program {
    numbers: Vec<(Register, f64)>,
    instructions: Vec<Instruction>,
    calls: Vec<CallSite>,
    registers: usize,
}

/// The terms a program runs on, slot by slot: `columns[slot · terms + t]`.
#[derive(Clone, Copy)]
pub(super) struct Operands<'a> {
    /// The point.
    pub x: &'a [f64],
    /// Column of each variable slot of each term.
    pub columns: &'a [u32],
    /// Value of each constant slot of each term.
    pub constants: &'a [f64],
    /// Number of terms.
    pub terms: usize,
}

/// Where the outputs of a program go.
pub(super) trait Sink {
    /// Takes output number `entry` of the terms from `first` on.
    fn store(&mut self, entry: usize, first: usize, values: &[f64]);
}

/// Memory for running programs.
#[derive(Default, Debug)]
pub(super) struct Workspace {
    registers: Vec<f64>,
    args: Vec<f64>,
    gradient: Vec<f64>,
    hessian: Vec<f64>,
}

impl Program {
    /// Drops dead steps, fuses, assigns registers.
    pub(super) fn new(code: &Code) -> Self {
        Assembler::new(code).assemble()
    }

    /// Runs on all terms.
    ///
    /// Errors: some term could not be evaluated, or an output is not finite; it is among the 64 terms
    /// from the one returned on.
    pub(super) fn run(
        &self,
        operands: Operands<'_>,
        work: &mut Workspace,
        sink: &mut impl Sink,
    ) -> Result<(), usize> {
        if self.instructions.is_empty() {
            return Ok(());
        }
        if operands.terms >= 48 && self.registers <= 128 {
            self.run_width::<64>(operands, work, sink)
        } else if operands.terms >= 5 {
            self.run_width::<8>(operands, work, sink)
        } else {
            self.run_width::<1>(operands, work, sink)
        }
    }

    fn run_width<const W: usize>(
        &self,
        operands: Operands<'_>,
        work: &mut Workspace,
        sink: &mut impl Sink,
    ) -> Result<(), usize> {
        let mut memory = std::mem::take(&mut work.registers);
        if memory.len() < self.registers * W {
            memory.resize(self.registers * W, 0.0);
        }
        let (registers, _) = memory.as_chunks_mut::<W>();
        for &(r, v) in &self.numbers {
            registers[r as usize] = [v; W];
        }
        let mut result = Ok(());
        let mut first = 0;
        while first < operands.terms {
            let n = W.min(operands.terms - first);
            if !self.run_lanes::<W>(registers, first, n, operands, work, sink) {
                result = Err(first);
                break;
            }
            first += n;
        }
        work.registers = memory;
        result
    }

    /// Runs on the terms `first .. first + n`, n ≤ W. False if an evaluation failed.
    fn run_lanes<const W: usize>(
        &self,
        registers: &mut [[f64; W]],
        first: usize,
        n: usize,
        operands: Operands<'_>,
        work: &mut Workspace,
        sink: &mut impl Sink,
    ) -> bool {
        let terms = operands.terms;
        let mut fine = true;
        // 0 as long as all outputs are finite
        let mut not_finite = 0.0;
        for instruction in &self.instructions {
            let (action, to, from) = match *instruction {
                Instruction::Compute { action, to, from } => (action, to as usize, from),
                Instruction::Store { entry, from } => {
                    let values = &registers[from as usize][..n];
                    let mut probe = 0.0;
                    for v in values {
                        probe += v * 0.0;
                    }
                    not_finite += probe;
                    sink.store(entry as usize, first, values);
                    continue;
                }
                Instruction::Call(k) => {
                    fine &= run_call(&self.calls[k as usize], registers, n, work);
                    continue;
                }
            };
            let [a, b, c] = from.map(|r| r as usize);
            match action {
                Action::Var(slot) => {
                    let at = slot as usize * terms + first;
                    let columns = &operands.columns[at..at + n];
                    let to = &mut registers[to];
                    for (v, &j) in to.iter_mut().zip(columns) {
                        *v = operands.x[j as usize];
                    }
                    pad(to, n);
                }
                Action::Const(slot) => {
                    let at = slot as usize * terms + first;
                    let to = &mut registers[to];
                    to[..n].copy_from_slice(&operands.constants[at..at + n]);
                    pad(to, n);
                }
                // numbers were written before the first block
                Action::Number(_) | Action::Part { .. } => {}
                Action::Add => binary(registers, to, a, b, |a, b| a + b),
                Action::Subtract => binary(registers, to, a, b, |a, b| a - b),
                Action::Multiply => binary(registers, to, a, b, |a, b| a * b),
                Action::Divide => binary(registers, to, a, b, |a, b| a / b),
                Action::MultiplyAdd => {
                    let [to, a, b, c] = registers
                        .get_disjoint_mut([to, a, b, c])
                        .expect("an instruction's registers are distinct");
                    for l in 0..W {
                        to[l] = a[l] * b[l] + c[l];
                    }
                }
                Action::Negate => unary(registers, to, a, |a| -a),
                Action::Square => unary(registers, to, a, |a| a * a),
                Action::Reciprocal => unary(registers, to, a, |a| 1.0 / a),
                Action::PowerInt(p) => unary(registers, to, a, |a| powi(a, p)),
                Action::Sqrt => unary(registers, to, a, f64::sqrt),
                Action::Abs => unary(registers, to, a, f64::abs),
                Action::Sign => unary(registers, to, a, sign),
                Action::Exp => some(registers, to, a, n, |a| a.exp().min(HUGE)),
                Action::Log => some(registers, to, a, n, f64::ln),
                Action::Log2 => some(registers, to, a, n, f64::log2),
                Action::Log10 => some(registers, to, a, n, f64::log10),
                Action::Sin => some(registers, to, a, n, f64::sin),
                Action::Cos => some(registers, to, a, n, f64::cos),
                Action::Tan => some(registers, to, a, n, f64::tan),
                Action::ArcTan => some(registers, to, a, n, f64::atan),
                Action::Power => {
                    let (a, b) = (registers[a], registers[b]);
                    for l in 0..n {
                        let v = a[l].powf(b[l]);
                        fine &= v.is_finite();
                        registers[to][l] = v;
                    }
                    pad(&mut registers[to], n);
                }
                Action::PowerSlope => {
                    ternary(registers, to, [a, b, c], n, power_slope);
                }
                Action::PowerCurvature => {
                    ternary(registers, to, [a, b, c], n, power_curvature);
                }
                Action::CheckPositive => fine &= all(&registers[a][..n], |v| v > TINY),
                Action::CheckNonNegative => fine &= all(&registers[a][..n], |v| v >= 0.0),
                Action::CheckNonZero => fine &= all(&registers[a][..n], |v| v.abs() > TINY),
                Action::CheckModerate => fine &= all(&registers[a][..n], |v| v.abs() <= 1e12),
            }
        }
        fine && not_finite == 0.0
    }
}

/// Fills the lanes beyond n with the value of lane n − 1, so that they compute nothing strange.
#[inline]
fn pad<const W: usize>(to: &mut [f64; W], n: usize) {
    if n < W {
        let last = to[n - 1];
        to[n..].fill(last);
    }
}

fn sign(a: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a.signum() }
}

/// First derivative of a ** b by a, given the value v.
fn power_slope(a: f64, b: f64, v: f64) -> f64 {
    if a > 0.0 && v > 0.0 {
        b * v / a
    } else if a > 0.0 {
        b * a.powf(b - 1.0)
    } else if b == 0.0 || b > 1.0 {
        0.0
    } else if b == 1.0 {
        1.0
    } else {
        f64::INFINITY
    }
}

/// Second derivative of a ** b by a, given the first.
fn power_curvature(a: f64, b: f64, slope: f64) -> f64 {
    if a > 0.0 {
        (b - 1.0) * slope / a
    } else if b == 0.0 || b == 1.0 || b > 2.0 {
        0.0
    } else if b == 2.0 {
        2.0
    } else {
        f64::INFINITY
    }
}

#[inline]
fn all(values: &[f64], test: impl Fn(f64) -> bool) -> bool {
    values.iter().fold(true, |ok, &v| ok & test(v))
}

#[inline]
fn unary<const W: usize>(registers: &mut [[f64; W]], to: usize, a: usize, f: impl Fn(f64) -> f64) {
    let [to, a] = registers
        .get_disjoint_mut([to, a])
        .expect("an instruction's registers are distinct");
    for l in 0..W {
        to[l] = f(a[l]);
    }
}

/// As [`unary`], for functions so expensive that only the lanes in use are computed.
#[inline]
fn some<const W: usize>(
    registers: &mut [[f64; W]],
    to: usize,
    a: usize,
    n: usize,
    f: impl Fn(f64) -> f64,
) {
    let [to, a] = registers
        .get_disjoint_mut([to, a])
        .expect("an instruction's registers are distinct");
    for l in 0..n {
        to[l] = f(a[l]);
    }
    pad(to, n);
}

#[inline]
fn binary<const W: usize>(
    registers: &mut [[f64; W]],
    to: usize,
    a: usize,
    b: usize,
    f: impl Fn(f64, f64) -> f64,
) {
    let [to, a, b] = registers
        .get_disjoint_mut([to, a, b])
        .expect("an instruction's registers are distinct");
    for l in 0..W {
        to[l] = f(a[l], b[l]);
    }
}

fn ternary<const W: usize>(
    registers: &mut [[f64; W]],
    to: usize,
    [a, b, c]: [usize; 3],
    n: usize,
    f: impl Fn(f64, f64, f64) -> f64,
) {
    let (a, b, c) = (registers[a], registers[b], registers[c]);
    let to = &mut registers[to];
    for l in 0..n {
        to[l] = f(a[l], b[l], c[l]);
    }
    pad(to, n);
}

/// Computes a function lane by lane. False if it failed in some lane.
fn run_call<const W: usize>(
    call: &CallSite,
    registers: &mut [[f64; W]],
    n: usize,
    work: &mut Workspace,
) -> bool {
    let k = call.args.len();
    work.args.resize(k, 0.0);
    work.gradient.resize(k, 0.0);
    let packed = if call.order == 2 { k * (k + 1) / 2 } else { 0 };
    work.hessian.resize(packed, 0.0);
    let mut fine = true;
    #[allow(clippy::needless_range_loop)] // a lane, not a register
    for l in 0..n {
        for (v, &r) in work.args.iter_mut().zip(&call.args) {
            *v = registers[r as usize][l];
        }
        let value = if call.order == 0 {
            function_value(call.function, &work.args)
        } else {
            partials(
                call.function,
                &work.args,
                &call.active,
                &mut work.gradient,
                &mut work.hessian,
            )
        };
        let Ok(value) = value else {
            fine = false;
            continue;
        };
        for &(part, r) in &call.parts {
            let part = part as usize;
            registers[r as usize][l] = if part == 0 {
                value
            } else if part <= k {
                work.gradient[part - 1]
            } else {
                work.hessian[part - 1 - k]
            };
        }
    }
    for &(_, r) in &call.parts {
        pad(&mut registers[r as usize], n);
    }
    fine
}

/// Turns a [`Code`] into a [`Program`].
struct Assembler<'c> {
    code: &'c Code,
    live: Vec<bool>,
    /// Products that are computed as part of the sum that uses them.
    fused: Vec<bool>,
    /// Position of the last use of each step.
    last_use: Vec<usize>,
    register: Vec<Register>,
    free: Vec<Register>,
    program: Program,
}

impl<'c> Assembler<'c> {
    fn new(code: &'c Code) -> Self {
        let n = code.steps.list.len();
        Self {
            code,
            live: vec![false; n],
            fused: vec![false; n],
            last_use: vec![0; n],
            register: vec![NONE; n],
            free: Vec::new(),
            program: Program::default(),
        }
    }

    /// Operands of a step, those of the call for the parts of a call.
    fn operands(&self, s: usize) -> &[Step] {
        let info = &self.code.steps.list[s];
        match info.action {
            Action::Part { call, .. } => &self.code.steps.calls[call as usize].args,
            _ => {
                let n = info.operands.iter().take_while(|&&o| o != NONE).count();
                &info.operands[..n]
            }
        }
    }

    fn assemble(mut self) -> Program {
        let code = self.code;
        let n = code.steps.list.len();
        for &s in code.outputs.iter().map(|o| &o.step).chain(&code.checks) {
            self.live[s as usize] = true;
        }
        let mut uses = vec![0_u32; n];
        for o in &code.outputs {
            uses[o.step as usize] += 1;
        }
        for s in (0..n).rev() {
            if self.live[s] {
                for i in 0..self.operands(s).len() {
                    let o = self.operands(s)[i] as usize;
                    self.live[o] = true;
                    uses[o] += 1;
                }
            }
        }
        let actions = self.fuse(&uses);
        self.find_last_uses(&actions);
        self.emit(&actions);
        self.program.registers = self.program.registers.max(1);
        self.program
    }

    /// Sums of a product that is used nowhere else become multiply-and-add.
    fn fuse(&mut self, uses: &[u32]) -> Vec<(Action, [Step; 3])> {
        let list = &self.code.steps.list;
        let mut actions: Vec<(Action, [Step; 3])> =
            list.iter().map(|s| (s.action, s.operands)).collect();
        for s in 0..list.len() {
            if !self.live[s] || list[s].action != Action::Add {
                continue;
            }
            let [p, q, _] = list[s].operands;
            for (m, c) in [(q, p), (p, q)] {
                let product = &list[m as usize];
                let [a, b, _] = product.operands;
                if product.action == Action::Multiply
                    && uses[m as usize] == 1
                    && c != a
                    && c != b
                    && !self.fused[m as usize]
                {
                    self.fused[m as usize] = true;
                    actions[s] = (Action::MultiplyAdd, [a, b, c]);
                    break;
                }
            }
        }
        actions
    }

    fn find_last_uses(&mut self, actions: &[(Action, [Step; 3])]) {
        for (s, &(action, operands)) in actions.iter().enumerate() {
            if !self.live[s] || self.fused[s] {
                continue;
            }
            self.last_use[s] = self.last_use[s].max(s);
            if let Action::Part { call, .. } = action {
                for &a in &self.code.steps.calls[call as usize].args {
                    self.last_use[a as usize] = s;
                }
            }
            for o in operands.into_iter().filter(|&o| o != NONE) {
                self.last_use[o as usize] = s;
            }
        }
    }

    fn allocate(&mut self) -> Register {
        self.free.pop().unwrap_or_else(|| {
            self.program.registers += 1;
            (self.program.registers - 1) as Register
        })
    }

    fn emit(&mut self, actions: &[(Action, [Step; 3])]) {
        let code = self.code;
        let n = actions.len();
        // outputs by the step that computes them
        let mut entries: Vec<(Step, u32)> = code
            .outputs
            .iter()
            .enumerate()
            .map(|(k, o)| (o.step, k as u32))
            .collect();
        entries.sort_unstable();
        let mut next_entry = 0;
        // parts of each call, in order of their steps
        let mut parts: Vec<Vec<(u32, Step)>> = vec![Vec::new(); code.steps.calls.len()];
        for s in (0..n).filter(|&s| self.live[s]) {
            if let Action::Part { call, part } = actions[s].0 {
                parts[call as usize].push((part, s as Step));
            }
        }
        let mut site: Vec<bool> = vec![false; code.steps.calls.len()];
        for (s, &(action, operands)) in actions.iter().enumerate() {
            if !self.live[s] || self.fused[s] {
                continue;
            }
            match action {
                Action::Number(v) => {
                    // numbers live in registers of their own, written once per run
                    let r = self.program.registers as Register;
                    self.program.registers += 1;
                    self.register[s] = r;
                    self.program.numbers.push((r, v));
                }
                Action::Part { call, .. } => {
                    if !site[call as usize] {
                        site[call as usize] = true;
                        self.emit_call(call, &parts[call as usize]);
                    }
                }
                Action::CheckPositive
                | Action::CheckNonNegative
                | Action::CheckNonZero
                | Action::CheckModerate => {
                    let from = self.register[operands[0] as usize];
                    self.program.instructions.push(Instruction::Compute {
                        action,
                        to: NONE,
                        from: [from, NONE, NONE],
                    });
                }
                _ => {
                    let to = self.allocate();
                    self.register[s] = to;
                    let from = operands.map(|o| {
                        if o == NONE {
                            NONE
                        } else {
                            self.register[o as usize]
                        }
                    });
                    self.program
                        .instructions
                        .push(Instruction::Compute { action, to, from });
                }
            }
            while let Some(&(step, entry)) = entries.get(next_entry)
                && step as usize == s
            {
                self.program.instructions.push(Instruction::Store {
                    entry,
                    from: self.register[s],
                });
                next_entry += 1;
            }
            self.release(s, action, operands);
        }
    }

    /// Frees the registers whose last use is step s.
    fn release(&mut self, s: usize, action: Action, operands: [Step; 3]) {
        let code = self.code;
        let args: &[Step] = match action {
            Action::Part { call, .. } => &code.steps.calls[call as usize].args,
            _ => &operands,
        };
        for o in args
            .iter()
            .copied()
            .chain([s as Step])
            .filter(|&o| o != NONE)
        {
            let o = o as usize;
            let number = matches!(code.steps.list[o].action, Action::Number(_));
            if self.last_use[o] == s && !number && self.register[o] != NONE {
                self.free.push(self.register[o]);
                // an operand that occurs twice is freed once
                self.last_use[o] = usize::MAX;
            }
        }
    }

    fn emit_call(&mut self, call: u32, parts: &[(u32, Step)]) {
        let source = &self.code.steps.calls[call as usize];
        let args = source
            .args
            .iter()
            .map(|&a| self.register[a as usize])
            .collect();
        let mut outputs = Vec::with_capacity(parts.len());
        for &(part, step) in parts {
            let r = self.allocate();
            self.register[step as usize] = r;
            outputs.push((part, r));
        }
        let site = CallSite {
            function: source.function,
            args,
            active: source.active.clone(),
            order: source.order,
            parts: outputs,
        };
        self.program.calls.push(site);
        let k = self.program.calls.len() as u32 - 1;
        self.program.instructions.push(Instruction::Call(k));
    }
}
