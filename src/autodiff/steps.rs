//! Straight-line code: scalar steps in the order in which they are computed, equal steps shared.
//!
//! A [`Steps`] is built symbolically (values first, then derivatives) with the simplifications that
//! derivatives need (0·x, 1·x, x + 0, −(−x), numbers folded). [`super::program`] then drops what no
//! output needs and assigns registers.

use crate::model::instance::Function;
use rustc_hash::FxHashMap;

/// Number of a step; also the name of its result.
pub(super) type Step = u32;

/// What a step computes from its operands a, b, c.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Action {
    /// A number.
    Number(f64),
    /// The variable in a slot.
    Var(u32),
    /// The constant in a slot.
    Const(u32),
    /// a + b.
    Add,
    /// a − b.
    Subtract,
    /// a · b.
    Multiply,
    /// a · b + c. Only made by the last pass.
    MultiplyAdd,
    /// a / b.
    Divide,
    /// −a.
    Negate,
    /// a².
    Square,
    /// 1/a.
    Reciprocal,
    /// a to a whole power.
    PowerInt(i32),
    /// a ** b for a ≥ 0.
    Power,
    /// ∂a of a ** b, given c = a ** b: b c/a, or its limit at a = 0.
    PowerSlope,
    /// ∂aa of a ** b, given c = ∂a: (b − 1) c/a, or its limit at a = 0.
    PowerCurvature,
    /// exp a, at most 1e299.
    Exp,
    /// log a.
    Log,
    /// log₂ a.
    Log2,
    /// log₁₀ a.
    Log10,
    /// √a.
    Sqrt,
    /// sin a.
    Sin,
    /// cos a.
    Cos,
    /// tan a.
    Tan,
    /// arctan a.
    ArcTan,
    /// |a|.
    Abs,
    /// Sign of a, 0 at 0.
    Sign,
    /// Output number `part` of a call (see [`Call`]); all parts of a call are computed together.
    Part {
        /// Number of the call.
        call: u32,
        /// 0 is the value; then the gradient; then the lower triangle of the Hessian by rows.
        part: u32,
    },
    /// Fails where a ≤ 0.
    CheckPositive,
    /// Fails where a < 0.
    CheckNonNegative,
    /// Fails where a = 0.
    CheckNonZero,
    /// Fails where |a| is so large that trigonometric functions have no correct digit.
    CheckModerate,
}

/// A function that is computed lane by lane, with its derivatives.
#[derive(Clone, Debug)]
pub(super) struct Call {
    /// The function.
    pub function: Function,
    /// Steps of the arguments.
    pub args: Vec<Step>,
    /// Which arguments depend on a variable.
    pub active: Vec<bool>,
    /// 0: value, 1: and gradient, 2: and Hessian.
    pub order: u8,
}

/// One step.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepInfo {
    /// What is computed.
    pub action: Action,
    /// Operands; unused ones are [`NONE`].
    pub operands: [Step; 3],
    /// Whether the result depends on a variable.
    pub active: bool,
}

/// No operand.
pub(super) const NONE: Step = u32::MAX;

/// Straight-line code under construction.
#[derive(Default, Debug)]
pub(super) struct Steps {
    /// The steps.
    pub list: Vec<StepInfo>,
    /// The calls that [`Action::Part`] refers to.
    pub calls: Vec<Call>,
    known: FxHashMap<(u64, u64, [Step; 3]), Step>,
}

impl Steps {
    fn push(&mut self, action: Action, operands: [Step; 3], active: bool) -> Step {
        let (tag, data) = word(action);
        let next = self.list.len() as Step;
        let id = *self.known.entry((tag, data, operands)).or_insert(next);
        if id == next {
            self.list.push(StepInfo {
                action,
                operands,
                active,
            });
        }
        id
    }

    fn is_active(&self, a: Step) -> bool {
        self.list[a as usize].active
    }

    /// The number, if the step is one.
    pub(super) fn as_number(&self, a: Step) -> Option<f64> {
        match self.list[a as usize].action {
            Action::Number(v) => Some(v),
            _ => None,
        }
    }

    fn negated(&self, a: Step) -> Option<Step> {
        let s = &self.list[a as usize];
        (s.action == Action::Negate).then_some(s.operands[0])
    }

    /// A number.
    pub(super) fn number(&mut self, v: f64) -> Step {
        self.push(Action::Number(v), [NONE; 3], false)
    }

    /// The variable in slot k.
    pub(super) fn var(&mut self, k: u32) -> Step {
        self.push(Action::Var(k), [NONE; 3], true)
    }

    /// The constant in slot k.
    pub(super) fn constant(&mut self, k: u32) -> Step {
        self.push(Action::Const(k), [NONE; 3], false)
    }

    /// A step with one operand, no simplification.
    pub(super) fn unary(&mut self, action: Action, a: Step) -> Step {
        let active = self.is_active(a);
        self.push(action, [a, NONE, NONE], active)
    }

    /// A step with several operands, no simplification.
    pub(super) fn plain(&mut self, action: Action, operands: &[Step]) -> Step {
        let mut o = [NONE; 3];
        o[..operands.len()].copy_from_slice(operands);
        let active = operands.iter().any(|&a| self.is_active(a));
        self.push(action, o, active)
    }

    /// a + b.
    pub(super) fn add(&mut self, a: Step, b: Step) -> Step {
        match (self.as_number(a), self.as_number(b)) {
            (Some(x), Some(y)) => return self.number(x + y),
            (Some(0.0), _) => return b,
            (_, Some(0.0)) => return a,
            _ => {}
        }
        if a == b {
            let two = self.number(2.0);
            return self.multiply(two, a);
        }
        if let Some(n) = self.negated(b) {
            return self.subtract(a, n);
        }
        if let Some(n) = self.negated(a) {
            return self.subtract(b, n);
        }
        self.plain(Action::Add, &[a.min(b), a.max(b)])
    }

    /// a − b.
    pub(super) fn subtract(&mut self, a: Step, b: Step) -> Step {
        match (self.as_number(a), self.as_number(b)) {
            (Some(x), Some(y)) => return self.number(x - y),
            (_, Some(0.0)) => return a,
            (Some(0.0), _) => return self.negate(b),
            _ => {}
        }
        if a == b {
            return self.number(0.0);
        }
        if let Some(n) = self.negated(b) {
            return self.add(a, n);
        }
        self.plain(Action::Subtract, &[a, b])
    }

    /// −a.
    pub(super) fn negate(&mut self, a: Step) -> Step {
        if let Some(x) = self.as_number(a) {
            return self.number(-x);
        }
        if let Some(n) = self.negated(a) {
            return n;
        }
        self.unary(Action::Negate, a)
    }

    /// a · b.
    pub(super) fn multiply(&mut self, a: Step, b: Step) -> Step {
        let (x, y) = (self.as_number(a), self.as_number(b));
        match (x, y) {
            (Some(x), Some(y)) => return self.number(x * y),
            (Some(0.0), _) => return a,
            (_, Some(0.0)) => return b,
            (Some(1.0), _) => return b,
            (_, Some(1.0)) => return a,
            (Some(-1.0), _) => return self.negate(b),
            (_, Some(-1.0)) => return self.negate(a),
            // number · (number · z)
            (Some(x), None) => return self.times_number(x, b),
            (None, Some(y)) => return self.times_number(y, a),
            (None, None) => {}
        }
        if a == b {
            return self.square(a);
        }
        match (self.negated(a), self.negated(b)) {
            (Some(p), Some(q)) => return self.multiply(p, q),
            (Some(p), None) => {
                let m = self.multiply(p, b);
                return self.negate(m);
            }
            (None, Some(q)) => {
                let m = self.multiply(a, q);
                return self.negate(m);
            }
            (None, None) => {}
        }
        self.plain(Action::Multiply, &[a.min(b), a.max(b)])
    }

    fn times_number(&mut self, x: f64, a: Step) -> Step {
        let s = self.list[a as usize];
        match s.action {
            Action::Negate => {
                let x = self.number(-x);
                return self.multiply(x, s.operands[0]);
            }
            Action::Multiply => {
                for (i, j) in [(0, 1), (1, 0)] {
                    if let Some(y) = self.as_number(s.operands[i]) {
                        let xy = self.number(x * y);
                        return self.multiply(xy, s.operands[j]);
                    }
                }
            }
            _ => {}
        }
        let x = self.number(x);
        self.plain(Action::Multiply, &[a.min(x), a.max(x)])
    }

    /// a / b.
    pub(super) fn divide(&mut self, a: Step, b: Step) -> Step {
        match (self.as_number(a), self.as_number(b)) {
            (Some(x), Some(y)) if y != 0.0 => return self.number(x / y),
            (Some(0.0), _) => return a,
            (Some(1.0), _) => return self.reciprocal(b),
            (_, Some(1.0)) => return a,
            _ => {}
        }
        if a == b {
            return self.number(1.0);
        }
        self.plain(Action::Divide, &[a, b])
    }

    /// 1/a.
    pub(super) fn reciprocal(&mut self, a: Step) -> Step {
        match self.as_number(a) {
            Some(x) if x != 0.0 => self.number(1.0 / x),
            _ => self.unary(Action::Reciprocal, a),
        }
    }

    /// a².
    pub(super) fn square(&mut self, a: Step) -> Step {
        if let Some(x) = self.as_number(a) {
            return self.number(x * x);
        }
        let a = self.negated(a).unwrap_or(a);
        self.unary(Action::Square, a)
    }

    /// aⁿ without checks, by products where n is small.
    pub(super) fn power_int(&mut self, a: Step, n: i32) -> Step {
        match n {
            0 => self.number(1.0),
            1 => a,
            2 => self.square(a),
            3 => {
                let q = self.square(a);
                self.multiply(q, a)
            }
            4 => {
                let q = self.square(a);
                self.square(q)
            }
            -1 => self.reciprocal(a),
            _ => self.unary(Action::PowerInt(n), a),
        }
    }

    /// All outputs of a function up to derivatives of the given order.
    pub(super) fn call(
        &mut self,
        function: Function,
        args: &[Step],
        active: &[bool],
        order: u8,
    ) -> u32 {
        let id = self.calls.len() as u32;
        self.calls.push(Call {
            function,
            args: args.to_vec(),
            active: active.to_vec(),
            order,
        });
        id
    }

    /// One output of a call.
    pub(super) fn part(&mut self, call: u32, part: u32) -> Step {
        let active = self.calls[call as usize].active.iter().any(|&a| a);
        self.push(Action::Part { call, part }, [NONE; 3], active)
    }
}

/// An action as a tag and a data word, to find equal steps.
fn word(a: Action) -> (u64, u64) {
    use Action::*;
    match a {
        Number(v) => (0, v.to_bits()),
        Var(k) => (1, u64::from(k)),
        Const(k) => (2, u64::from(k)),
        Part { call, part } => (3, (u64::from(call) << 32) | u64::from(part)),
        PowerInt(n) => (4, u64::from(n as u32)),
        Add => (5, 0),
        Subtract => (6, 0),
        Multiply => (7, 0),
        MultiplyAdd => (8, 0),
        Divide => (9, 0),
        Negate => (10, 0),
        Square => (11, 0),
        Reciprocal => (12, 0),
        Power => (13, 0),
        PowerSlope => (14, 0),
        PowerCurvature => (15, 0),
        Exp => (16, 0),
        Log => (17, 0),
        Log2 => (18, 0),
        Log10 => (19, 0),
        Sqrt => (20, 0),
        Sin => (21, 0),
        Cos => (22, 0),
        Tan => (23, 0),
        ArcTan => (25, 0),
        Abs => (26, 0),
        Sign => (27, 0),
        CheckPositive => (28, 0),
        CheckNonNegative => (29, 0),
        CheckNonZero => (30, 0),
        CheckModerate => (31, 0),
    }
}
