//! Terms with fixed columns, as terms of the other columns only.
//!
//! √x has no derivative at 0, and a model that fixes x there does not need it. Where a derivative cannot be computed, it is
//! computed once more with the values of the fixed columns put in as constants; derivatives with respect to
//! these columns then count as 0.

use crate::model::instance::{Instance, Kernel, KernelTerms, Op, SparseRows};
use rustc_hash::FxHashMap;

/// The nonlinear part of an instance without its fixed columns; None where these are in polynomials only.
pub(super) fn without_fixed(instance: &Instance) -> Option<Instance> {
    let columns = &instance.columns;
    let fixed = |j: u32| columns.lower[j as usize] == columns.upper[j as usize];
    let may_fail = |op: &Op| matches!(op, Op::Call(..) | Op::Power | Op::Divide | Op::PowerInt(_));
    let mut open = instance
        .nonlinear
        .iter()
        .filter(|t| t.kernel.ops.iter().any(may_fail));
    if !open.any(|t| t.columns.iter().any(|&j| fixed(j))) {
        return None;
    }
    let mut nonlinear = Vec::new();
    for terms in &instance.nonlinear {
        // terms by which of their variables are fixed, in order of appearance
        let mut groups: Vec<(Vec<bool>, Vec<usize>)> = Vec::new();
        let mut known: FxHashMap<Vec<bool>, usize> = FxHashMap::default();
        let mut mask = Vec::new();
        for (t, slots) in terms.terms().enumerate() {
            mask.clear();
            mask.extend(slots.columns.iter().map(|&j| fixed(j)));
            match known.get(&mask) {
                Some(&g) => groups[g].1.push(t),
                None => {
                    known.insert(mask.clone(), groups.len());
                    groups.push((mask.clone(), vec![t]));
                }
            }
        }
        for (mask, members) in groups {
            nonlinear.push(put_in(terms, &mask, &members, &columns.lower));
        }
    }
    Some(Instance {
        columns: columns.clone(),
        rows: instance.rows.clone(),
        matrix: SparseRows {
            start: vec![0; instance.row_count() + 1],
            ..SparseRows::default()
        },
        nonlinear,
        ..Instance::default()
    })
}

/// Some of the terms, with values in place of the masked variables.
fn put_in(terms: &KernelTerms, mask: &[bool], members: &[usize], value: &[f64]) -> KernelTerms {
    let c = terms.kernel.constants as usize;
    // slots of variables keep their order, so that affine forms without fixed ones stay together
    let (mut masked, mut free) = (0, 0);
    let place: Vec<u32> = mask
        .iter()
        .map(|&m| {
            let (next, first) = if m { (&mut masked, c) } else { (&mut free, 0) };
            *next += 1;
            (first + *next - 1) as u32
        })
        .collect();
    let variable = |k: u32| match mask[k as usize] {
        true => Op::Const(place[k as usize]),
        false => Op::Var(place[k as usize]),
    };
    let mut ops = Vec::with_capacity(terms.kernel.ops.len());
    for op in &terms.kernel.ops {
        match *op {
            Op::Var(k) => ops.push(variable(k)),
            Op::Affine(constant, first, n) => {
                let slots = first..first + n;
                if slots.clone().any(|k| mask[k as usize]) {
                    ops.push(Op::Const(constant));
                    for (m, k) in slots.enumerate() {
                        ops.extend([
                            Op::Const(constant + 1 + m as u32),
                            variable(k),
                            Op::Multiply(2),
                        ]);
                    }
                    ops.push(Op::Add(n + 1));
                } else {
                    let variable = place.get(first as usize).copied().unwrap_or(0);
                    ops.push(Op::Affine(constant, variable, n));
                }
            }
            other => ops.push(other),
        }
    }
    let mut out = KernelTerms {
        kernel: Kernel {
            ops,
            variables: free as u32,
            constants: (c + masked) as u32,
        },
        ..KernelTerms::default()
    };
    for &t in members {
        let slots = terms.term(t);
        out.push(terms.row[t], slots.coef, &[], slots.constants);
        for (&j, &masked) in slots.columns.iter().zip(mask) {
            match masked {
                true => out.constants.push(value[j as usize]),
                false => out.columns.push(j),
            }
        }
    }
    out
}
