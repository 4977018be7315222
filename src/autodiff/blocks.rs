//! Kernels made ready: compiled once per structure, their terms stored slot by slot.
//!
//! Kernel terms with equal programs are merged, whatever equation they come from. A constant slot on
//! which all terms agree becomes a number of the program (so `x ** c` with c = 2 everywhere is a
//! square). Long sums at the root of a kernel with few terms are taken apart into terms of their own:
//! the addends usually have few shapes.

use super::derive;
use super::graph::Graph;
use super::program::{Operands, Program};
use crate::model::instance::{Function, Instance, Kernel, KernelTerms, Op};
use rustc_hash::{FxHashMap, FxHasher};
use std::hash::{Hash, Hasher};

/// How kernels are compiled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// δ, as in [`Graph::new`].
    pub smoothing: f64,
    /// What is asked for of second derivatives.
    pub second: Second,
    /// Number of columns.
    pub columns: u32,
}

/// Of second derivatives.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Second {
    /// Nothing.
    None,
    /// Each of them.
    Entries,
    /// Products of the Hessian and a vector.
    Products,
}

/// A compiled kernel and its terms.
#[derive(Debug)]
pub(super) struct Block {
    /// The expression.
    pub graph: Graph,
    /// Code for the value.
    pub value: Program,
    /// Code for the gradient.
    pub gradient: Program,
    /// Code for the Hessian.
    pub hessian: Program,
    /// Variable slots of the entries of the gradient.
    pub gradient_slots: Vec<u32>,
    /// Variable slots of the entries of the Hessian.
    pub hessian_slots: Vec<[u32; 2]>,
    /// Whether all second derivatives are numbers or constants, and nothing has a domain.
    pub quadratic: bool,
    /// Whether all first derivatives are numbers or constants, and nothing has a domain.
    pub linear: bool,
    /// Row of each term.
    pub row: Vec<u32>,
    /// Coefficient of each term.
    pub coef: Vec<f64>,
    /// Code for the product of the Hessian and a vector, and the columns of its entries, one after the other.
    pub product: Program,
    pub product_columns: Vec<u32>,
    /// Columns, slot by slot; for products the places of the vector's entries, behind those of the point, follow.
    pub columns: Vec<u32>,
    /// Constants, slot by slot.
    pub constants: Vec<f64>,
}

impl Block {
    /// Number of terms.
    pub(super) fn terms(&self) -> usize {
        self.row.len()
    }

    /// The operands of the programs at x.
    pub(super) fn operands<'a>(&'a self, x: &'a [f64]) -> Operands<'a> {
        Operands {
            x,
            columns: &self.columns,
            constants: &self.constants,
            terms: self.terms(),
        }
    }

    /// Column in a slot of a term.
    pub(super) fn column(&self, slot: u32, term: usize) -> u32 {
        self.columns[slot as usize * self.terms() + term]
    }

    /// Constant in a slot of a term.
    pub(super) fn constant(&self, slot: u32, term: usize) -> f64 {
        self.constants[slot as usize * self.terms() + term]
    }

    fn new(kernel: &Kernel, parts: &[KernelTerms], wanted: Wanted) -> Self {
        let (v, c) = (kernel.variables as usize, kernel.constants as usize);
        let terms: usize = parts.iter().map(|p| p.row.len()).sum();
        let mut row = Vec::with_capacity(terms);
        let mut coef = Vec::with_capacity(terms);
        let mut columns = vec![0; v * terms];
        let mut constants = vec![0.0; c * terms];
        for part in parts {
            for t in 0..part.row.len() {
                let at = row.len();
                for k in 0..v {
                    columns[k * terms + at] = part.columns[t * v + k];
                }
                for k in 0..c {
                    constants[k * terms + at] = part.constants[t * c + k];
                }
                row.push(part.row[t]);
                coef.push(part.coef[t]);
            }
        }
        let uniform: Vec<Option<f64>> = (0..c)
            .map(|k| {
                let values = &constants[k * terms..(k + 1) * terms];
                let first = *values.first()?;
                values
                    .iter()
                    .all(|v| v.to_bits() == first.to_bits())
                    .then_some(first)
            })
            .collect();
        let graph = Graph::new(kernel, &uniform, wanted.smoothing);
        let (value, gradient, hessian) = (
            derive::value(&graph),
            derive::gradient(&graph),
            match wanted.second {
                Second::Entries => derive::hessian(&graph),
                _ => derive::Code::default(),
            },
        );
        let product = match wanted.second {
            Second::Products => derive::product(&graph, kernel.variables),
            _ => derive::Code::default(),
        };
        if wanted.second == Second::Products {
            columns.extend_from_within(..);
            let vector = columns[v * terms..].iter_mut();
            vector.for_each(|j| *j += wanted.columns);
        }
        let constant = |code: &derive::Code| {
            let inactive = |o: &derive::Output| !code.steps.list[o.step as usize].active;
            code.checks.is_empty() && code.outputs.iter().all(inactive)
        };
        // its Hessian is 0, and it is no polynomial
        let kink = |op: &Op| matches!(op, Op::Call(Function::Abs, _));
        let kinked = kernel.ops.iter().any(kink);
        Self {
            value: Program::new(&value),
            gradient: Program::new(&gradient),
            hessian: Program::new(&hessian),
            gradient_slots: gradient.outputs.iter().map(|o| o.slots[0]).collect(),
            hessian_slots: hessian.outputs.iter().map(|o| o.slots).collect(),
            product: Program::new(&product),
            product_columns: product
                .outputs
                .iter()
                .flat_map(|o| &columns[o.slots[0] as usize * terms..][..terms])
                .copied()
                .collect(),
            quadratic: wanted.second == Second::Entries && !kinked && constant(&hessian),
            linear: constant(&gradient),
            graph,
            row,
            coef,
            columns,
            constants,
        }
    }
}

/// Compiles the nonlinear part of an instance.
pub(super) fn compile(instance: &Instance, wanted: Wanted) -> Vec<Block> {
    groups(instance)
        .into_iter()
        .map(|(kernel, parts)| Block::new(&kernel, &parts, wanted))
        .collect()
}

/// How many second derivatives there are at most: in all terms, and in programs, which are compiled.
pub fn second_derivatives(instance: &Instance) -> (f64, f64) {
    let of_groups = groups(instance).into_iter().map(|(kernel, parts)| {
        let terms: usize = parts.iter().map(|p| p.row.len()).sum();
        let triangle = |set: Vec<u32>| (set.len() * (set.len() + 1)) as f64 / 2.0;
        let each: f64 = curved(&kernel).into_iter().map(triangle).sum();
        (terms as f64 * each, each)
    });
    of_groups.fold((0.0, 0.0), |all, (a, b)| (all.0 + a, all.1 + b))
}

/// The columns of each addend that is not linear: there are second derivatives for pairs of them at most.
pub(crate) fn curved_columns(instance: &Instance) -> Vec<Vec<u32>> {
    let mut out = Vec::new();
    for (kernel, parts) in groups(instance) {
        let sets = curved(&kernel);
        for slots in parts.iter().flat_map(KernelTerms::terms) {
            let columns = |set: &Vec<u32>| set.iter().map(|&k| slots.columns[k as usize]).collect();
            out.extend(sets.iter().map(columns));
        }
    }
    out
}

/// The variables of each addend of an expression that is not linear.
fn curved(kernel: &Kernel) -> Vec<Vec<u32>> {
    let ops = &kernel.ops;
    let begin = begins(ops);
    let mut seen = vec![usize::MAX; kernel.variables as usize];
    let (mut rest, mut sets) = (vec![ops.len() - 1], Vec::new());
    while let Some(end) = rest.pop() {
        match ops[end] {
            Op::Const(_) | Op::Var(_) | Op::Affine(..) => {}
            Op::Add(_) | Op::Negate => {
                let mut next = end;
                for _ in 0..ops[end].arguments() {
                    rest.push(next - 1);
                    next = begin[next - 1];
                }
            }
            _ => {
                let mut set = Vec::new();
                let mut see = |k: u32| {
                    if seen[k as usize] != end {
                        seen[k as usize] = end;
                        set.push(k);
                    }
                };
                for op in &ops[begin[end]..end] {
                    match *op {
                        Op::Var(k) => see(k),
                        Op::Affine(_, variable, terms) => {
                            (variable..variable + terms).for_each(&mut see)
                        }
                        _ => {}
                    }
                }
                sets.push(set);
            }
        }
    }
    sets
}

/// Where the subexpression that ends at each operation begins.
fn begins(ops: &[Op]) -> Vec<usize> {
    let mut begin: Vec<usize> = Vec::with_capacity(ops.len());
    for (p, op) in ops.iter().enumerate() {
        let first = (0..op.arguments()).fold(p, |end, _| begin[end - 1]);
        begin.push(first);
    }
    begin
}

/// Terms by their programs.
fn groups(instance: &Instance) -> Vec<(Kernel, Vec<KernelTerms>)> {
    let mut groups: Vec<(Kernel, Vec<KernelTerms>)> = Vec::new();
    let mut known: FxHashMap<u64, Vec<usize>> = FxHashMap::default();
    for terms in instance.nonlinear.iter().filter(|t| !t.row.is_empty()) {
        for part in split_sum(terms).unwrap_or_else(|| vec![terms.clone()]) {
            let candidates = known.entry(hash(&part.kernel)).or_default();
            match candidates.iter().find(|&&g| groups[g].0 == part.kernel) {
                Some(&g) => groups[g].1.push(part),
                None => {
                    candidates.push(groups.len());
                    groups.push((part.kernel.clone(), vec![part]));
                }
            }
        }
    }
    groups
}

/// Operations of one addend: a range of the program.
type Addend = std::ops::Range<usize>;

/// Takes a kernel that is a long sum apart; None where that does not pay.
fn split_sum(terms: &KernelTerms) -> Option<Vec<KernelTerms>> {
    const LONG: usize = 16;
    let kernel = &terms.kernel;
    let Some(&Op::Add(n @ 3..)) = kernel.ops.last() else {
        return None;
    };
    if (n as usize) < LONG || terms.row.len() > LONG {
        return None;
    }
    let addends = addends(&kernel.ops[..kernel.ops.len() - 1], n as usize)?;
    let mut out: Vec<KernelTerms> = Vec::with_capacity(addends.len());
    for range in addends {
        let (piece, variables, constants) = renumber(&kernel.ops[range]);
        let mut part = KernelTerms {
            kernel: piece,
            row: terms.row.clone(),
            coef: terms.coef.clone(),
            ..KernelTerms::default()
        };
        let (v, c) = (kernel.variables as usize, kernel.constants as usize);
        for t in 0..terms.row.len() {
            let slots = |s: &u32| terms.columns[t * v + *s as usize];
            part.columns.extend(variables.iter().map(slots));
            let slots = |s: &u32| terms.constants[t * c + *s as usize];
            part.constants.extend(constants.iter().map(slots));
        }
        out.push(part);
    }
    Some(out)
}

/// The n subprograms that a sequence of operations leaves on the stack.
fn addends(ops: &[Op], n: usize) -> Option<Vec<Addend>> {
    let mut starts: Vec<usize> = Vec::new();
    for (i, op) in ops.iter().enumerate() {
        let keep = starts.len().checked_sub(op.arguments())?;
        let start = starts.get(keep).copied().unwrap_or(i);
        starts.truncate(keep);
        starts.push(start);
    }
    if starts.len() != n {
        return None;
    }
    let ends = starts.iter().skip(1).copied().chain([ops.len()]);
    Some(
        starts
            .iter()
            .copied()
            .zip(ends)
            .map(|(a, b)| a..b)
            .collect(),
    )
}

/// A subprogram with slots numbered by first occurrence, and the old slots in the new order.
fn renumber(ops: &[Op]) -> (Kernel, Vec<u32>, Vec<u32>) {
    let (mut variables, mut constants) = (Slots::default(), Slots::default());
    let ops: Vec<Op> = ops
        .iter()
        .map(|op| match *op {
            Op::Var(k) => Op::Var(variables.place(k)),
            Op::Const(k) => Op::Const(constants.place(k)),
            // an affine form needs its slots in sequence
            Op::Affine(constant, variable, terms) => Op::Affine(
                constants.sequence(constant, terms + 1),
                variables.sequence(variable, terms),
                terms,
            ),
            other => other,
        })
        .collect();
    let kernel = Kernel {
        ops,
        variables: variables.old.len() as u32,
        constants: constants.old.len() as u32,
    };
    (kernel, variables.old, constants.old)
}

#[derive(Default)]
struct Slots {
    old: Vec<u32>,
    new: FxHashMap<u32, u32>,
}

impl Slots {
    fn place(&mut self, k: u32) -> u32 {
        *self.new.entry(k).or_insert_with(|| {
            self.old.push(k);
            self.old.len() as u32 - 1
        })
    }

    fn sequence(&mut self, first: u32, count: u32) -> u32 {
        let start = self.old.len() as u32;
        for k in first..first + count {
            self.new.insert(k, self.old.len() as u32);
            self.old.push(k);
        }
        start
    }
}

fn hash(kernel: &Kernel) -> u64 {
    let mut h = FxHasher::default();
    (kernel.variables, kernel.constants).hash(&mut h);
    for op in &kernel.ops {
        std::mem::discriminant(op).hash(&mut h);
        match *op {
            Op::Var(k) | Op::Const(k) | Op::Add(k) | Op::Multiply(k) => k.hash(&mut h),
            Op::Affine(constant, variable, terms) => (constant, variable, terms).hash(&mut h),
            Op::PowerInt(n) => n.hash(&mut h),
            Op::Call(f, n) => (f, n).hash(&mut h),
            Op::Divide | Op::Negate | Op::Power => {}
        }
    }
    h.finish()
}
