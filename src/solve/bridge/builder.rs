//! An instance in the making: the rows and columns of another, and those that take the place of what stood in its terms.

use super::parts::Parts;
use crate::autodiff::Evaluator;
use crate::model::builder::Term;
use crate::model::instance::{Columns, Instance, Kernel, KernelTerms, Relation, Rows, SparseRows};
use rustc_hash::FxHashMap;
use std::ops::Range;

/// Depth to which one stands in another and the start is still exact.
const NESTED: usize = 4;

/// The program in the making.
pub(super) struct Builder {
    pub(super) columns: Columns,
    pub(super) rows: Rows,
    pub(super) entries: Vec<(usize, u32, f64)>,
    nonlinear: Vec<KernelTerms>,
    known: FxHashMap<Kernel, usize>,
    /// What was put in place of something: column, its rows, in which it has the coefficient −1, and whether it is above them.
    pub(super) lifted: Vec<(usize, Range<usize>, bool)>,
}

impl Builder {
    pub(super) fn new(instance: &Instance) -> Self {
        let linear = (0..instance.row_count())
            .flat_map(|i| instance.matrix.row(i).map(move |(j, a)| (i, j as u32, a)));
        Self {
            columns: instance.columns.clone(),
            rows: instance.rows.clone(),
            entries: linear.collect(),
            nonlinear: Vec::new(),
            known: FxHashMap::default(),
            lifted: Vec::new(),
        }
    }

    pub(super) fn push_term(&mut self, row: usize, coefficient: f64, e: Term) {
        let (next, kernel) = (self.nonlinear.len(), e.kernel());
        let place = *self.known.entry(kernel).or_insert_with_key(|kernel| {
            self.nonlinear.push(KernelTerms::new(kernel.clone()));
            next
        });
        self.nonlinear[place].push(row as u32, coefficient, &e.columns, &e.constants);
    }

    /// Appends an empty row with right-hand side 0; its number.
    pub(super) fn push_row(&mut self, relation: Relation) -> usize {
        self.rows.relation.push(relation);
        self.rows.rhs.push(0.0);
        self.rows.marginal.push(0.0);
        self.rows.scale.push(1.0);
        self.rows.rhs.len() - 1
    }

    /// Puts what is constant or linear into the left side of a row; the rest.
    pub(super) fn place_linear(&mut self, row: usize, parts: Parts) -> Vec<(f64, Term)> {
        self.rows.rhs[row] -= parts.constant;
        let linear = parts.linear.into_iter().map(|(j, a)| (row, j, a));
        self.entries.extend(linear);
        parts.nonlinear
    }

    /// The program in continuous columns, started where the new columns have the values of what they stand for.
    pub(super) fn finish(mut self, original: &Instance) -> Instance {
        self.entries.sort_by_key(|e| (e.0, e.1));
        let mut matrix = SparseRows {
            start: vec![0],
            ..SparseRows::default()
        };
        let mut entries = self
            .entries
            .chunk_by(|a, b| (a.0, a.1) == (b.0, b.1))
            .peekable();
        for i in 0..self.rows.rhs.len() {
            while let Some(same) = entries.next_if(|e| e[0].0 == i) {
                let sum: f64 = same.iter().map(|e| e.2).sum();
                if sum != 0.0 {
                    matrix.column.push(same[0].1);
                    matrix.value.push(sum);
                }
            }
            matrix.start.push(matrix.column.len());
        }
        let mut instance = Instance {
            columns: self.columns,
            rows: self.rows,
            matrix,
            nonlinear: self.nonlinear,
            objective: original.objective,
            matched: None,
            discrete: Default::default(),
        };
        // the start of an outer one depends on that of an inner one
        let mut evaluator = Evaluator::first_order(&instance);
        let mut activity = vec![0.0; instance.row_count()];
        for _ in 0..NESTED {
            let level = &mut instance.columns.level;
            if evaluator.rows(level, &mut activity).is_err() {
                break;
            }
            for (v, rows, above) in &self.lifted {
                let values = rows
                    .clone()
                    .map(|i| activity[i] - instance.rows.rhs[i] + level[*v]);
                level[*v] = match above {
                    true => values.fold(f64::NEG_INFINITY, f64::max),
                    false => values.fold(f64::INFINITY, f64::min),
                };
            }
        }
        instance
    }

    /// The same with what is discrete in the original; new columns are branched on last.
    pub(super) fn finish_discrete(self, original: &Instance) -> Instance {
        let mut instance = self.finish(original);
        instance.discrete = original.discrete.clone();
        if !instance.discrete.priorities.is_empty() {
            let all = instance.column_count();
            instance.discrete.priorities.resize(all, f64::MAX);
        }
        instance
    }
}
