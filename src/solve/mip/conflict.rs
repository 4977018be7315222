//! Rows that contradict each other only because columns must be discrete.
//!
//! The deletion filter (Chinneck & Dravnieks 1991) with a search in place of a linear program: a row is dropped for good if
//! the rest is still without a solution, then the condition on a discrete column. So for linear programs and for those
//! that are convex, where a search proves that there is none.

use super::Aim;
use crate::model::instance::{ColumnKind, Instance, Relation, Sense};
use crate::model::problem_type::ProblemType;
use crate::solve::answer::subproblem;
use crate::solve::backend::Task;
use crate::solve::nlp::convex::{Shape, shape};
use crate::solve::{Budget, ModelStatus, Settings};

/// Seconds for all of it.
const MAX_SECONDS: f64 = 30.0;

/// Rows and discrete columns of the instance that, with all bounds, have no solution; and whether it was shown that none
/// can be spared.
#[derive(Clone, Debug, PartialEq)]
pub struct Conflict {
    /// Rows.
    pub rows: Vec<usize>,
    /// Columns that must be discrete.
    pub columns: Vec<usize>,
    /// None can be spared.
    pub shown: bool,
}

/// Finds one; None: the search says that there is a solution, or nothing in time.
pub fn conflict(using: ProblemType, instance: &Instance, budget: &Budget) -> Option<Conflict> {
    budget.within(MAX_SECONDS, u64::MAX, |budget| {
        budget.silently(|budget| find(using, instance, budget))
    })
}

fn find(using: ProblemType, instance: &Instance, budget: &Budget) -> Option<Conflict> {
    let mut p = instance.clone();
    // Any point will do.
    if let (Some((row, _)), Some(z)) = (p.objective_row(), p.objective)
        && p.is_free(z.column as usize)
    {
        p.rows.relation[row] = Relation::Free;
    }
    let nothing = p.add_column(0.0, 0.0, 0.0);
    p.set_objective(nothing, Sense::Minimize);
    p.discrete.priorities.clear();
    let convex = matches!(shape(&p), Shape::Linear | Shape::ConvexQuadratic { .. });
    if !convex || Task::new(using, &p).has_pairs() {
        return None;
    }
    let settings = Settings {
        search: Aim {
            nodes: 2000,
            ..Aim::default()
        },
        ..Settings::default()
    };
    let mut shown = true;
    // Whether there is no solution; not known counts as no.
    let mut empty = |p: &Instance| {
        use ModelStatus as S;
        let task = Task::new(using, p).by(Some(super::NAME));
        let status = subproblem(&task, &settings, budget).map(|a| a.status);
        let empty = matches!(
            status,
            Ok(S::IntegerInfeasible | S::Infeasible | S::LocallyInfeasible)
        );
        shown &= empty || status.is_ok_and(S::has_solution);
        empty
    };
    if !empty(&p) {
        return None;
    }
    let mut rows = Vec::new();
    for i in 0..p.row_count() {
        let relation = std::mem::replace(&mut p.rows.relation[i], Relation::Free);
        if relation != Relation::Free && !empty(&p) {
            p.rows.relation[i] = relation;
            rows.push(i);
        }
    }
    let mut stands = vec![false; p.column_count()];
    for &i in &rows {
        p.matrix.row(i).for_each(|(j, _)| stands[j] = true);
    }
    for (i, j) in p.nonlinear_places() {
        stands[j as usize] |= rows.contains(&(i as usize));
    }
    let mut columns = Vec::new();
    for (j, stands) in stands.into_iter().enumerate() {
        let kind = p.columns.kind[j];
        if matches!(kind, ColumnKind::Continuous | ColumnKind::OrderedSet) {
            continue;
        }
        let thresholds = p.discrete.thresholds.clone();
        p.columns.kind[j] = ColumnKind::Continuous;
        p.discrete.thresholds.retain(|t| t.0 as usize != j);
        if stands && !empty(&p) {
            p.columns.kind[j] = kind;
            p.discrete.thresholds = thresholds;
            columns.push(j);
        }
    }
    let mut kept = 0;
    while kept < p.discrete.sets.len() {
        let set = p.discrete.sets.remove(kept);
        let members = || set.columns.iter().map(|&j| j as usize);
        members().for_each(|j| p.columns.kind[j] = ColumnKind::Continuous);
        if !empty(&p) {
            members().for_each(|j| p.columns.kind[j] = ColumnKind::OrderedSet);
            columns.extend(members());
            p.discrete.sets.insert(kept, set);
            kept += 1;
        }
    }
    Some(Conflict {
        rows,
        columns,
        shown,
    })
}
