//! From the graph of a kernel to straight-line code for its value, gradient and Hessian.
//!
//! Gradient: reverse mode, w̄_j = Σ_i w̄_i ∂φ_i/∂w_j, symbolically, so that only the operations that
//! depend on the data are left for run time.
//!
//! Hessian: edge pushing (Gower & Mello, "A new framework for the computation of Hessians",
//! Optimization Methods and Software 27, 2012). Nodes are visited in reverse; a nonlinear node
//! creates edges w̄_i ∂²φ_i/∂w_j∂w_k between its operands, and existing edges {i, p} are pushed to the
//! operands of i: {j, p} gains ∂φ_i/∂w_j · w_ip, doubled when j = p; {i, i} spreads over all pairs of
//! operands. What is left on the variables is the lower triangle of the Hessian, no more and no less
//! than its structural nonzeros.

use super::functions::TINY;
use super::graph::{Element, Graph, Id};
use super::partials::packed;
use super::steps::{Action, NONE, Step, Steps};
use crate::model::instance::Function;
use Function as F;
use rustc_hash::FxHashMap;

/// One output of a [`Code`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Output {
    /// Variable slots: unused for a value, the first for a gradient, both (first ≥ second) for a Hessian.
    pub slots: [u32; 2],
    /// The step that computes it.
    pub step: Step,
}

/// Straight-line code with its outputs.
#[derive(Default)]
pub(super) struct Code {
    /// The steps.
    pub steps: Steps,
    /// What is wanted.
    pub outputs: Vec<Output>,
    /// Steps that must run although nothing depends on them: domain checks and calls.
    pub checks: Vec<Step>,
}

/// First and second partial derivatives of a node by its distinct active operands.
#[derive(Default)]
struct Local {
    first: Vec<(Id, Step)>,
    second: Vec<(Id, Id, Step)>,
}

struct Derivation<'g> {
    graph: &'g Graph,
    order: u8,
    steps: Steps,
    checks: Vec<Step>,
    value: Vec<Step>,
    local: Vec<Local>,
}

/// Code for the value.
pub(super) fn value(graph: &Graph) -> Code {
    let mut d = Derivation::new(graph, 0);
    d.forward();
    let step = d.value[graph.root as usize];
    d.finish(vec![Output {
        slots: [NONE; 2],
        step,
    }])
}

/// Code for the gradient: one output per slot with a derivative that is not identically 0.
pub(super) fn gradient(graph: &Graph) -> Code {
    let mut d = Derivation::new(graph, 1);
    d.forward();
    let adjoint = d.adjoints();
    d.finish_slots(&adjoint)
}

/// Code for the lower triangle of the Hessian.
pub(super) fn hessian(graph: &Graph) -> Code {
    let mut d = Derivation::new(graph, 2);
    d.forward();
    let edges = d.push_edges();
    let mut outputs: Vec<Output> = edges
        .into_iter()
        .map(|(i, j, step)| Output {
            slots: [i.max(j), i.min(j)],
            step,
        })
        .collect();
    outputs.sort_by_key(|o| o.slots);
    d.finish(outputs)
}

/// Code for the product of the Hessian and a vector, whose entries are in the slots after those of the variables: the derivative of
/// the gradient along it.
pub(super) fn product(graph: &Graph, variables: u32) -> Code {
    let mut d = Derivation::new(graph, 2);
    d.forward();
    let adjoint = d.adjoints();
    let n = graph.elements.len();
    let (mut along, mut change): (Vec<Option<Step>>, Vec<Option<Step>>) =
        (vec![None; n], vec![None; n]);
    for (id, e) in graph.elements.iter().enumerate() {
        if let Element::Var(k) = e {
            along[id] = Some(d.steps.var(variables + k));
        }
        for (j, slope) in &d.local[id].first {
            if let Some(v) = along[*j as usize] {
                let t = d.steps.multiply(*slope, v);
                accumulate(&mut d.steps, &mut along[id], t);
            }
        }
    }
    for i in (0..n).rev() {
        let local = std::mem::take(&mut d.local[i]);
        for &(j, slope) in &local.first {
            if let Some(c) = change[i] {
                let t = d.steps.multiply(c, slope);
                accumulate(&mut d.steps, &mut change[j as usize], t);
            }
        }
        let Some(a) = adjoint[i] else { continue };
        for &(j, k, curvature) in &local.second {
            let h = d.steps.multiply(a, curvature);
            let both = [(j, k), (k, j)];
            for &(to, from) in &both[..1 + usize::from(j != k)] {
                if let Some(v) = along[from as usize] {
                    let t = d.steps.multiply(h, v);
                    accumulate(&mut d.steps, &mut change[to as usize], t);
                }
            }
        }
    }
    d.finish_slots(&change)
}

impl<'g> Derivation<'g> {
    fn new(graph: &'g Graph, order: u8) -> Self {
        Self {
            graph,
            order,
            steps: Steps::default(),
            checks: Vec::new(),
            value: Vec::with_capacity(graph.elements.len()),
            local: Vec::with_capacity(graph.elements.len()),
        }
    }

    /// One output per slot whose variable has such a step.
    fn finish_slots(self, of: &[Option<Step>]) -> Code {
        let output = |(e, step): (&Element, &Option<Step>)| match (e, step) {
            (Element::Var(k), &Some(step)) => Some(Output {
                slots: [*k, NONE],
                step,
            }),
            _ => None,
        };
        let mut outputs: Vec<Output> = self
            .graph
            .elements
            .iter()
            .zip(of)
            .filter_map(output)
            .collect();
        outputs.sort_by_key(|o| o.slots);
        self.finish(outputs)
    }

    fn finish(self, outputs: Vec<Output>) -> Code {
        let zero = |s: Step| self.steps.as_number(s) == Some(0.0);
        let derivative = self.order > 0;
        let outputs = outputs
            .into_iter()
            .filter(|o| !(derivative && zero(o.step)))
            .collect();
        Code {
            steps: self.steps,
            outputs,
            checks: self.checks,
        }
    }

    fn check(&mut self, action: Action, a: Step) {
        let fine = self.steps.as_number(a).is_some_and(|x| match action {
            Action::CheckPositive => x > TINY,
            Action::CheckNonNegative => x >= 0.0,
            Action::CheckNonZero => x.abs() > TINY,
            _ => x.abs() <= 1e12,
        });
        if !fine {
            let s = self.steps.unary(action, a);
            self.checks.push(s);
        }
    }

    /// Values and local derivatives of all nodes.
    fn forward(&mut self) {
        let graph = self.graph;
        for (id, e) in graph.elements.iter().enumerate() {
            let mut local = Local::default();
            let v = self.node(e, graph.active[id], &mut local);
            self.value.push(v);
            self.local.push(local);
        }
    }

    fn is_active(&self, id: Id) -> bool {
        self.graph.active[id as usize]
    }

    fn node(&mut self, e: &Element, active: bool, local: &mut Local) -> Step {
        let order = if active { self.order } else { 0 };
        let val = |me: &Self, id: Id| me.value[id as usize];
        match e {
            Element::Var(k) => self.steps.var(*k),
            Element::Const(k) => self.steps.constant(*k),
            Element::Number(v) => self.steps.number(*v),
            Element::Add(a, b) => {
                let (a, b) = (val(self, *a), val(self, *b));
                self.steps.add(a, b)
            }
            Element::Linear { constant, terms } => {
                let mut sum = val(self, *constant);
                for &(c, n) in terms {
                    let (c, x) = (val(self, c), val(self, n));
                    let m = self.steps.multiply(c, x);
                    sum = self.steps.add(m, sum);
                    if order > 0 {
                        local.first.push((n, c));
                    }
                }
                sum
            }
            &Element::Multiply(a, b) => {
                let (x, y) = (val(self, a), val(self, b));
                if order > 0 {
                    local.first = vec![(a, y), (b, x)];
                }
                if order > 1 {
                    let one = self.steps.number(1.0);
                    local.second.push((a, b, one));
                }
                self.steps.multiply(x, y)
            }
            &Element::Divide(a, b) => self.quotient(a, b, order, local),
            &Element::PowerInt(a, n) => {
                let x = val(self, a);
                if n < 0 {
                    self.check(Action::CheckNonZero, x);
                }
                self.whole_power(a, x, n, order, local)
            }
            &Element::Power(a, b) => self.power(a, b, order, local),
            Element::Call(f, args) => match args[..] {
                [a] => self.unary(*f, a, order, local),
                _ => self.call(*f, args, order, local),
            },
        }
    }

    fn quotient(&mut self, a: Id, b: Id, order: u8, local: &mut Local) -> Step {
        let (x, y) = (self.value[a as usize], self.value[b as usize]);
        self.check(Action::CheckNonZero, y);
        let s = &mut self.steps;
        let v = s.divide(x, y);
        if order == 0 {
            return v;
        }
        let (in_a, in_b) = (self.graph.active[a as usize], self.graph.active[b as usize]);
        let r = s.reciprocal(y);
        let vr = s.multiply(v, r);
        if in_a {
            local.first.push((a, r));
        }
        if in_b {
            let d = s.negate(vr);
            local.first.push((b, d));
        }
        if order > 1 && in_b {
            let vrr = s.multiply(vr, r);
            let two = s.number(2.0);
            let h = s.multiply(two, vrr);
            local.second.push((b, b, h));
            if in_a {
                let rr = s.square(r);
                let h = s.negate(rr);
                local.second.push((a, b, h));
            }
        }
        v
    }

    /// xⁿ with its derivatives; domain already checked.
    fn whole_power(&mut self, a: Id, x: Step, n: i32, order: u8, local: &mut Local) -> Step {
        let s = &mut self.steps;
        let v = s.power_int(x, n);
        if order == 0 || n == 0 {
            return v;
        }
        let nf = f64::from(n);
        let (p1, p2) = if n > 0 {
            let p1 = s.power_int(x, n - 1);
            let p2 = if n > 1 {
                s.power_int(x, n - 2)
            } else {
                s.number(0.0)
            };
            (p1, p2)
        } else {
            let r = s.reciprocal(x);
            let p1 = s.multiply(v, r);
            let p2 = s.multiply(p1, r);
            (p1, p2)
        };
        let c = s.number(nf);
        let d = s.multiply(c, p1);
        local.first.push((a, d));
        if order > 1 {
            let c = s.number(nf * (nf - 1.0));
            let h = s.multiply(c, p2);
            local.second.push((a, a, h));
        }
        v
    }

    fn power(&mut self, a: Id, b: Id, order: u8, local: &mut Local) -> Step {
        if order > 0 && self.is_active(b) {
            return self.call(F::RPower, &[a, b], order, local);
        }
        let (x, y) = (self.value[a as usize], self.value[b as usize]);
        if let Some(exponent) = self.steps.as_number(y) {
            if exponent == 0.5 {
                return self.unary(F::Sqrt, a, order, local);
            }
            let check = if exponent < 0.0 {
                Action::CheckPositive
            } else {
                Action::CheckNonNegative
            };
            self.check(check, x);
            if exponent == exponent.round() && exponent.abs() <= 8.0 {
                return self.whole_power(a, x, exponent as i32, order, local);
            }
        } else {
            self.check(Action::CheckNonNegative, x);
        }
        let s = &mut self.steps;
        let v = s.plain(Action::Power, &[x, y]);
        if order > 0 {
            let d = s.plain(Action::PowerSlope, &[x, y, v]);
            local.first.push((a, d));
            if order > 1 {
                let h = s.plain(Action::PowerCurvature, &[x, y, d]);
                local.second.push((a, a, h));
            }
        }
        v
    }

    fn unary(&mut self, f: Function, a: Id, order: u8, local: &mut Local) -> Step {
        let x = self.value[a as usize];
        match f {
            F::Log | F::Log2 | F::Log10 => self.check(Action::CheckPositive, x),
            F::Sqrt => self.check(Action::CheckNonNegative, x),
            F::Sin | F::Cos | F::Tan => self.check(Action::CheckModerate, x),
            _ => {}
        }
        let s = &mut self.steps;
        // (value, first, second)
        let (v, d, h) = match f {
            F::Exp => {
                let v = s.unary(Action::Exp, x);
                (v, v, v)
            }
            F::Log | F::Log2 | F::Log10 => {
                let (action, c) = match f {
                    F::Log => (Action::Log, 1.0),
                    F::Log2 => (Action::Log2, std::f64::consts::LOG2_E),
                    _ => (Action::Log10, std::f64::consts::LOG10_E),
                };
                let v = s.unary(action, x);
                let c = s.number(c);
                let r = s.reciprocal(x);
                let d = s.multiply(c, r);
                let rr = s.multiply(d, r);
                (v, d, s.negate(rr))
            }
            F::Sqrt => {
                let v = s.unary(Action::Sqrt, x);
                let half = s.number(0.5);
                let d = s.divide(half, v);
                let q = s.divide(d, x);
                let minus = s.number(-0.5);
                (v, d, s.multiply(minus, q))
            }
            F::Sin => {
                let v = s.unary(Action::Sin, x);
                (v, s.unary(Action::Cos, x), s.negate(v))
            }
            F::Cos => {
                let v = s.unary(Action::Cos, x);
                let sine = s.unary(Action::Sin, x);
                (v, s.negate(sine), s.negate(v))
            }
            F::Tan => {
                let v = s.unary(Action::Tan, x);
                let q = s.square(v);
                let one = s.number(1.0);
                let d = s.add(one, q);
                let vd = s.multiply(v, d);
                let two = s.number(2.0);
                (v, d, s.multiply(two, vd))
            }
            F::ArcTan => {
                let v = s.unary(Action::ArcTan, x);
                let q = s.square(x);
                let one = s.number(1.0);
                let p = s.add(one, q);
                let d = s.reciprocal(p);
                let dd = s.square(d);
                let xdd = s.multiply(x, dd);
                let minus = s.number(-2.0);
                (v, d, s.multiply(minus, xdd))
            }
            F::Abs => {
                let v = s.unary(Action::Abs, x);
                (v, s.unary(Action::Sign, x), s.number(0.0))
            }
            _ => return self.call(f, &[a], order, local),
        };
        if order > 0 {
            local.first.push((a, d));
        }
        if order > 1 {
            local.second.push((a, a, h));
        }
        v
    }

    /// A function computed lane by lane.
    fn call(&mut self, f: Function, args: &[Id], order: u8, local: &mut Local) -> Step {
        let steps: Vec<Step> = args.iter().map(|&a| self.value[a as usize]).collect();
        let active: Vec<bool> = args.iter().map(|&a| self.is_active(a)).collect();
        let call = self.steps.call(f, &steps, &active, order);
        let v = self.steps.part(call, 0);
        self.checks.push(v);
        if order == 0 {
            return v;
        }
        let n = args.len();
        for i in (0..n).filter(|&i| active[i]) {
            let d = self.steps.part(call, 1 + i as u32);
            // equal operands share an entry
            match local.first.iter_mut().find(|e| e.0 == args[i]) {
                Some(e) => e.1 = self.steps.add(e.1, d),
                None => local.first.push((args[i], d)),
            }
            if order < 2 || f.is_nonsmooth() {
                continue;
            }
            for j in (0..=i).filter(|&j| active[j]) {
                let mut h = self.steps.part(call, (1 + n + packed(i, j)) as u32);
                if args[i] == args[j] && i != j {
                    let two = self.steps.number(2.0);
                    h = self.steps.multiply(two, h);
                }
                local.second.push((args[i], args[j], h));
            }
        }
        v
    }

    /// Reverse sweep. The adjoint of each node; None where it is identically 0.
    fn adjoints(&mut self) -> Vec<Option<Step>> {
        let n = self.graph.elements.len();
        let mut adjoint: Vec<Option<Step>> = vec![None; n];
        adjoint[self.graph.root as usize] = Some(self.steps.number(1.0));
        for i in (0..n).rev() {
            let Some(a) = adjoint[i] else { continue };
            let first = std::mem::take(&mut self.local[i].first);
            for &(j, d) in &first {
                let t = self.steps.multiply(a, d);
                accumulate(&mut self.steps, &mut adjoint[j as usize], t);
            }
            self.local[i].first = first;
        }
        adjoint
    }

    /// Edge pushing. The edges left between variable slots.
    fn push_edges(&mut self) -> Vec<(u32, u32, Step)> {
        let graph = self.graph;
        let adjoint = self.adjoints();
        // leaves rank below all other nodes, so that an edge is kept at its inner end
        let (mut rank, mut order) = (vec![u32::MAX; graph.elements.len()], Vec::new());
        for leaves in [true, false] {
            for (id, e) in graph.elements.iter().enumerate() {
                if graph.active[id] && matches!(e, Element::Var(_)) == leaves {
                    rank[id] = order.len() as u32;
                    order.push(id);
                }
            }
        }
        let mut edges = Edges(vec![FxHashMap::default(); order.len()]);
        for i in (0..order.len()).rev() {
            let id = order[i];
            if matches!(graph.elements[id], Element::Var(_)) {
                break;
            }
            let local = std::mem::take(&mut self.local[id]);
            let s = &mut self.steps;
            let mut pending: Vec<(u32, Step)> =
                std::mem::take(&mut edges.0[i]).into_iter().collect();
            pending.sort_unstable_by_key(|e| e.0);
            for (p, w) in pending {
                if p as usize == i {
                    for (u, &(j, d)) in local.first.iter().enumerate() {
                        let t = s.multiply(d, w);
                        for &(k, e) in &local.first[..=u] {
                            let t = s.multiply(t, e);
                            edges.add(s, rank[j as usize], rank[k as usize], t);
                        }
                    }
                    continue;
                }
                for &(j, d) in &local.first {
                    let mut t = s.multiply(d, w);
                    if rank[j as usize] == p {
                        let two = s.number(2.0);
                        t = s.multiply(two, t);
                    }
                    edges.add(s, rank[j as usize], p, t);
                }
            }
            if let Some(a) = adjoint[id] {
                for &(j, k, c) in &local.second {
                    let t = s.multiply(a, c);
                    edges.add(s, rank[j as usize], rank[k as usize], t);
                }
            }
        }
        let slot = |r: u32| match graph.elements[order[r as usize]] {
            Element::Var(k) => k,
            _ => NONE,
        };
        let mut left = Vec::new();
        for (i, map) in edges.0.iter().enumerate() {
            for (&p, &w) in map {
                left.push((slot(i as u32), slot(p), w));
            }
        }
        left
    }
}

/// Weights of edges, kept at the end of higher rank.
struct Edges(Vec<FxHashMap<u32, Step>>);

impl Edges {
    fn add(&mut self, s: &mut Steps, i: u32, j: u32, t: Step) {
        if s.as_number(t) == Some(0.0) {
            return;
        }
        let (hi, lo) = (i.max(j), i.min(j));
        match self.0[hi as usize].entry(lo) {
            std::collections::hash_map::Entry::Occupied(mut e) => {
                let sum = s.add(*e.get(), t);
                e.insert(sum);
            }
            std::collections::hash_map::Entry::Vacant(e) => {
                e.insert(t);
            }
        }
    }
}

fn accumulate(s: &mut Steps, target: &mut Option<Step>, t: Step) {
    if s.as_number(t) == Some(0.0) {
        return;
    }
    *target = Some(match *target {
        Some(old) => s.add(old, t),
        None => t,
    });
}
