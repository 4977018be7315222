//! A kernel as a graph of elementary operations, equal subexpressions shared.
//!
//! The program of a kernel is a tree in postfix order. Building the graph
//!
//! * gives every distinct subexpression one number (children before parents),
//! * gathers sums, differences, negations and multiples by constants into n-ary [`Element::Linear`]
//!   nodes in linear time, however long the chain,
//! * folds numbers and tells which nodes depend on a variable (*active* nodes).

use super::functions::{divide, function_value, real_power, whole_power};
use crate::model::instance::{Function, Kernel, Op};
use rustc_hash::FxHashMap;

/// Number of a node.
pub(super) type Id = u32;

/// An elementary operation. Operands have smaller numbers.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Element {
    /// The variable in a slot.
    Var(u32),
    /// The constant in a slot.
    Const(u32),
    /// A number that is the same in all terms.
    Number(f64),
    /// Σ coefficient · node + constant; coefficients and constant are inactive nodes, the others active
    /// and distinct.
    Linear {
        /// Constant term.
        constant: Id,
        /// (coefficient, node).
        terms: Vec<(Id, Id)>,
    },
    /// a + b of inactive nodes.
    Add(Id, Id),
    /// a · b; both active or both inactive.
    Multiply(Id, Id),
    /// a / b.
    Divide(Id, Id),
    /// a to a whole power.
    PowerInt(Id, i32),
    /// a ** b.
    Power(Id, Id),
    /// A function.
    Call(Function, Vec<Id>),
}

/// The graph of a kernel.
#[derive(Clone, Debug)]
pub(super) struct Graph {
    /// Nodes, operands first.
    pub elements: Vec<Element>,
    /// Whether a node depends on a variable.
    pub active: Vec<bool>,
    /// The node of the kernel's value.
    pub root: Id,
}

/// What lies on the stack while the postfix program is read: a node, or a sum still growing.
enum Item {
    Node(Id),
    Sum { terms: Vec<(Id, Id)>, constant: Id },
}

struct Builder<'a> {
    smoothing: f64,
    elements: Vec<Element>,
    active: Vec<bool>,
    known: FxHashMap<Box<[u32]>, Id>,
    uniform: &'a [Option<f64>],
}

impl Graph {
    /// Builds the graph. `uniform[k]` is the value of constant slot k where all terms agree on it.
    ///
    /// A kernel that is no well-formed program (the stack runs empty) gives a graph whose value is
    /// undefined (NaN), so that its evaluation fails instead of the process.
    ///
    /// With a smoothing δ > 0, |a| becomes √(a² + δ²), √a √(a + δ²), and min and max follow from |a|.
    pub(super) fn new(kernel: &Kernel, uniform: &[Option<f64>], smoothing: f64) -> Self {
        let mut b = Builder {
            smoothing,
            elements: Vec::new(),
            active: Vec::new(),
            known: FxHashMap::default(),
            uniform,
        };
        let root = b.read(&kernel.ops).unwrap_or_else(|| b.number(f64::NAN));
        Self {
            elements: b.elements,
            active: b.active,
            root,
        }
    }
}

impl Builder<'_> {
    fn read(&mut self, ops: &[Op]) -> Option<Id> {
        let mut stack: Vec<Item> = Vec::new();
        for op in ops {
            let at = stack.len().checked_sub(op.arguments())?;
            let mut items = stack.split_off(at).into_iter();
            let item = match *op {
                Op::Var(k) => Item::Node(self.node(Element::Var(k))),
                Op::Const(k) => Item::Node(self.constant(k)),
                Op::Affine(constant, variable, terms) => {
                    let base = self.constant(constant);
                    let mut sum = Vec::with_capacity(terms as usize);
                    for m in 0..terms {
                        let coefficient = self.constant(constant + 1 + m);
                        let var = self.node(Element::Var(variable + m));
                        sum.push((coefficient, var));
                    }
                    Item::Sum {
                        terms: sum,
                        constant: base,
                    }
                }
                Op::Add(_) => items.reduce(|a, b| self.sum(a, b))?,
                Op::Negate => self.multiple(items.next()?, -1.0),
                Op::Multiply(_) => items.reduce(|a, b| {
                    let (a, b) = (self.settle(a), self.settle(b));
                    self.product(a, b)
                })?,
                Op::Call(f, _) => {
                    let args = items.map(|i| self.settle(i)).collect();
                    Item::Node(self.call(f, args))
                }
                Op::Divide | Op::Power | Op::PowerInt(_) => {
                    let args: Vec<Id> = items.map(|i| self.settle(i)).collect();
                    Item::Node(match (*op, &args[..]) {
                        (Op::PowerInt(n), &[a]) => self.power_int(a, n),
                        (Op::Power, &[a, b]) => self.power(a, b),
                        (_, &[a, b]) => self.quotient(a, b),
                        _ => return None,
                    })
                }
            };
            stack.push(item);
        }
        let last = stack.pop()?;
        Some(self.settle(last))
    }

    fn node(&mut self, e: Element) -> Id {
        let key = key(&e);
        if let Some(&id) = self.known.get(&key) {
            return id;
        }
        let active = match &e {
            Element::Var(_) => true,
            Element::Const(_) | Element::Number(_) => false,
            Element::Linear { .. } => true,
            Element::Add(a, b)
            | Element::Multiply(a, b)
            | Element::Divide(a, b)
            | Element::Power(a, b) => self.active[*a as usize] || self.active[*b as usize],
            Element::PowerInt(a, _) => self.active[*a as usize],
            Element::Call(_, args) => args.iter().any(|&a| self.active[a as usize]),
        };
        let id = self.elements.len() as Id;
        self.elements.push(e);
        self.active.push(active);
        self.known.insert(key, id);
        id
    }

    fn number(&mut self, v: f64) -> Id {
        self.node(Element::Number(v))
    }

    fn constant(&mut self, slot: u32) -> Id {
        match self.uniform.get(slot as usize) {
            Some(Some(v)) => self.number(*v),
            _ => self.node(Element::Const(slot)),
        }
    }

    fn as_number(&self, id: Id) -> Option<f64> {
        match self.elements[id as usize] {
            Element::Number(v) => Some(v),
            _ => None,
        }
    }

    fn is_active(&self, id: Id) -> bool {
        self.active[id as usize]
    }

    /// a + b of inactive nodes.
    fn add_inactive(&mut self, a: Id, b: Id) -> Id {
        match (self.as_number(a), self.as_number(b)) {
            (Some(x), Some(y)) => self.number(x + y),
            (Some(0.0), _) => b,
            (_, Some(0.0)) => a,
            _ => self.node(Element::Add(a, b)),
        }
    }

    fn multiply_inactive(&mut self, a: Id, b: Id) -> Id {
        match (self.as_number(a), self.as_number(b)) {
            (Some(x), Some(y)) => self.number(x * y),
            (Some(1.0), _) => b,
            (_, Some(1.0)) => a,
            _ => self.node(Element::Multiply(a, b)),
        }
    }

    fn parts(&mut self, item: Item) -> (Vec<(Id, Id)>, Id) {
        match item {
            Item::Sum { terms, constant } => (terms, constant),
            Item::Node(id) if self.is_active(id) => {
                let (one, zero) = (self.number(1.0), self.number(0.0));
                (vec![(one, id)], zero)
            }
            Item::Node(id) => (Vec::new(), id),
        }
    }

    /// a + b; the shorter list is appended to the longer, so a chain of n costs O(n log n).
    fn sum(&mut self, a: Item, b: Item) -> Item {
        let (mut p, c) = self.parts(a);
        let (mut q, d) = self.parts(b);
        if p.len() < q.len() {
            std::mem::swap(&mut p, &mut q);
        }
        p.append(&mut q);
        Item::Sum {
            terms: p,
            constant: self.add_inactive(c, d),
        }
    }

    fn multiple(&mut self, item: Item, factor: f64) -> Item {
        let factor = self.number(factor);
        self.scaled(item, factor)
    }

    /// factor · item, factor inactive.
    fn scaled(&mut self, item: Item, factor: Id) -> Item {
        // a long sum is settled first: scaling it term by term again and again would be quadratic
        let item = match item {
            Item::Sum { ref terms, .. } if terms.len() > 8 => Item::Node(self.settle(item)),
            other => other,
        };
        let (mut terms, constant) = self.parts(item);
        for t in &mut terms {
            t.0 = self.multiply_inactive(factor, t.0);
        }
        Item::Sum {
            terms,
            constant: self.multiply_inactive(factor, constant),
        }
    }

    /// Turns an item into a node: merges equal terms of a sum.
    fn settle(&mut self, item: Item) -> Id {
        let (mut terms, constant) = match item {
            Item::Node(id) => return id,
            Item::Sum { terms, constant } => (terms, constant),
        };
        terms.sort_by_key(|t| t.1);
        let mut merged: Vec<(Id, Id)> = Vec::with_capacity(terms.len());
        for (c, n) in terms {
            match merged.last_mut() {
                Some(last) if last.1 == n => last.0 = self.add_inactive(last.0, c),
                _ => merged.push((c, n)),
            }
        }
        merged.retain(|t| self.as_number(t.0) != Some(0.0));
        if merged.is_empty() {
            return constant;
        }
        if let [(c, n)] = merged[..]
            && self.as_number(c) == Some(1.0)
            && self.as_number(constant) == Some(0.0)
        {
            return n;
        }
        self.node(Element::Linear {
            constant,
            terms: merged,
        })
    }

    fn product(&mut self, a: Id, b: Id) -> Item {
        match (self.is_active(a), self.is_active(b)) {
            (false, false) => Item::Node(self.multiply_inactive(a, b)),
            (false, true) => self.scaled(Item::Node(b), a),
            (true, false) => self.scaled(Item::Node(a), b),
            (true, true) => {
                let ((p, a), (q, b)) = (self.factor(a), self.factor(b));
                let node = if a == b {
                    self.node(Element::PowerInt(a, 2))
                } else {
                    self.node(Element::Multiply(a.min(b), a.max(b)))
                };
                let factor = self.multiply_inactive(p, q);
                match self.as_number(factor) {
                    Some(1.0) => Item::Node(node),
                    _ => self.scaled(Item::Node(node), factor),
                }
            }
        }
    }

    /// A node as (inactive factor, node).
    fn factor(&mut self, a: Id) -> (Id, Id) {
        if let Element::Linear { constant, terms } = &self.elements[a as usize]
            && let [(c, n)] = terms[..]
            && self.as_number(*constant) == Some(0.0)
        {
            return (c, n);
        }
        (self.number(1.0), a)
    }

    fn quotient(&mut self, a: Id, b: Id) -> Id {
        if let (Some(x), Some(y)) = (self.as_number(a), self.as_number(b))
            && let Ok(v) = divide(x, y)
        {
            return self.number(v);
        }
        if self.as_number(b) == Some(1.0) {
            return a;
        }
        self.node(Element::Divide(a, b))
    }

    fn power_int(&mut self, a: Id, n: i32) -> Id {
        if let Some(x) = self.as_number(a)
            && let Ok(v) = whole_power(x, n)
        {
            return self.number(v);
        }
        match n {
            0 => self.number(1.0),
            1 => a,
            _ => self.node(Element::PowerInt(a, n)),
        }
    }

    fn power(&mut self, a: Id, b: Id) -> Id {
        if let (Some(x), Some(y)) = (self.as_number(a), self.as_number(b))
            && let Ok(v) = real_power(x, y)
        {
            return self.number(v);
        }
        self.node(Element::Power(a, b))
    }

    fn call(&mut self, f: Function, args: Vec<Id>) -> Id {
        match (f, &args[..]) {
            (Function::Sqr, &[a]) => return self.power_int(a, 2),
            (Function::RPower | Function::VcPower, &[a, b]) => return self.power(a, b),
            (Function::Power, &[a, b]) => {
                if let Some(n) = self.as_number(b)
                    && (n - n.round()).abs() <= 1e-5
                    && n.abs() <= 2e9
                {
                    return self.power_int(a, n.round() as i32);
                }
            }
            (Function::Div, &[a, b]) if self.as_number(b).is_some_and(|v| v != 0.0) => {
                return self.quotient(a, b);
            }
            (Function::IfThen, &[c, a, b]) => match self.as_number(c) {
                Some(0.0) => return b,
                Some(_) => return a,
                None => {}
            },
            _ => {}
        }
        if self.smoothing > 0.0 && args.iter().any(|&a| self.is_active(a)) {
            match f {
                Function::Abs => return self.smooth_abs(args[0]),
                Function::Sqrt => return self.smooth_root(args[0]),
                Function::EDist => return self.smooth_distance(args),
                Function::Max | Function::Min => return self.smooth_extreme(f, &args),
                _ => {}
            }
        }
        let numbers: Option<Vec<f64>> = args.iter().map(|&a| self.as_number(a)).collect();
        if let Some(numbers) = numbers
            && let Ok(v) = function_value(f, &numbers)
        {
            return self.number(v);
        }
        self.node(Element::Call(f, args))
    }

    /// √(a² + δ²)
    fn smooth_abs(&mut self, a: Id) -> Id {
        self.smooth_distance(vec![a])
    }

    /// √(a² + b² + … + δ²)
    fn smooth_distance(&mut self, mut args: Vec<Id>) -> Id {
        args.push(self.number(self.smoothing));
        self.node(Element::Call(Function::EDist, args))
    }

    /// √(a + δ²): the root of a sum of squares is a distance.
    fn smooth_root(&mut self, a: Id) -> Id {
        let square = self.number(self.smoothing * self.smoothing);
        let sum = self.sum(Item::Node(a), Item::Node(square));
        let sum = self.settle(sum);
        self.node(Element::Call(Function::Sqrt, vec![sum]))
    }

    /// max(a, b) = (a + b + |a − b|)/2, min with the other sign; several arguments one after the other.
    fn smooth_extreme(&mut self, f: Function, args: &[Id]) -> Id {
        let sign = if f == Function::Max { 0.5 } else { -0.5 };
        let mut best = args[0];
        for &b in &args[1..] {
            let negative = self.multiple(Item::Node(b), -1.0);
            let difference = self.sum(Item::Node(best), negative);
            let difference = self.settle(difference);
            let distance = self.smooth_abs(difference);
            let distance = self.multiple(Item::Node(distance), sign);
            let total = self.sum(Item::Node(best), Item::Node(b));
            let half = self.multiple(total, 0.5);
            let total = self.sum(half, distance);
            best = self.settle(total);
        }
        best
    }
}

/// An element as a sequence of words, to find equal ones.
fn key(e: &Element) -> Box<[u32]> {
    let bits = |v: f64| {
        let b = v.to_bits();
        [b as u32, (b >> 32) as u32]
    };
    match e {
        Element::Var(k) => Box::new([0, *k]),
        Element::Const(k) => Box::new([1, *k]),
        Element::Number(v) => {
            let [lo, hi] = bits(*v);
            Box::new([2, lo, hi])
        }
        Element::Linear { constant, terms } => {
            let mut w = vec![3, *constant];
            w.extend(terms.iter().flat_map(|t| [t.0, t.1]));
            w.into()
        }
        Element::Add(a, b) => Box::new([4, *a, *b]),
        Element::Multiply(a, b) => Box::new([5, *a, *b]),
        Element::Divide(a, b) => Box::new([6, *a, *b]),
        Element::PowerInt(a, n) => Box::new([7, *a, *n as u32]),
        Element::Power(a, b) => Box::new([8, *a, *b]),
        Element::Call(f, args) => {
            let mut w = vec![9, *f as u32];
            w.extend(args);
            w.into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_subexpressions_are_one_node() {
        // sin(xy) · y / sin(xy), where slots 0 and 1 are x and y
        let product = [Op::Var(0), Op::Var(1), Op::Multiply(2)];
        let sine = [Op::Call(Function::Sin, 1)];
        let mut ops: Vec<Op> = product.iter().chain(&sine).copied().collect();
        ops.extend([Op::Var(1), Op::Multiply(2)]);
        ops.extend(product.iter().chain(&sine));
        ops.push(Op::Divide);
        let kernel = Kernel {
            ops,
            variables: 2,
            constants: 0,
        };
        let graph = Graph::new(&kernel, &[], 0.0);
        let count = |of: fn(&Element) -> bool| graph.elements.iter().filter(|e| of(e)).count();
        assert_eq!(count(|e| matches!(e, Element::Call(Function::Sin, _))), 1);
        assert_eq!(count(|e| matches!(e, Element::Multiply(..))), 2);
        assert_eq!(count(|e| matches!(e, Element::Var(_))), 2);
    }
}
