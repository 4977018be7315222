//! What can be seen of a complementarity model before it is solved: equations that bounds may switch
//! off, and structurally singular blocks. (Empty rows and columns are errors of generation.)
//!
//! The rows of free variables are equations. If k of them stand in fewer than k variables, they
//! contradict each other or repeat each other whatever the numbers; if k free variables stand in fewer
//! than k rows, they are not determined. Both are read off a maximum matching of rows and columns:
//! the block is what alternating paths reach from an unmatched row or column (Dulmage &
//! Mendelsohn 1958; Pothen & Fan 1990).

use crate::autodiff::Evaluator;
use crate::model::instance::{Instance, Relation};
use crate::solve::lp::form::Sparse;

/// Something to tell a user about the model.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// Pairs (row, column) of an equation (`=e=`) and a variable with a bound: where the variable is at
    /// the bound, the equation need not hold.
    BoundedEquation(Vec<(usize, usize)>),
    /// More equations than variables that stand in them.
    Overdetermined(Block),
    /// More free variables than rows that they stand in.
    Underdetermined(Block),
}

/// A structurally singular block.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Its rows.
    pub rows: Vec<usize>,
    /// Its columns.
    pub columns: Vec<usize>,
}

/// Looks at the model; `row_of` gives each column its row, and in a `square` system every variable that
/// is not fixed counts as free.
pub fn examine(instance: &Instance, row_of: &[Option<u32>], square: bool) -> Vec<Finding> {
    let (m, n) = (instance.row_count(), instance.column_count());
    let columns = &instance.columns;
    let fixed = |j: usize| columns.lower[j] == columns.upper[j];
    let free = |j: usize| {
        !fixed(j)
            && (square
                || columns.lower[j] == f64::NEG_INFINITY && columns.upper[j] == f64::INFINITY)
    };
    let evaluator = Evaluator::first_order(instance);
    let (start, index) = evaluator.jacobian_pattern();
    let by_row = Sparse {
        start: start.to_vec(),
        index: index.to_vec(),
        value: vec![1.0; index.len()],
    };
    let by_column = by_row.transpose(n);
    let mut findings = Vec::new();
    let bounded: Vec<(usize, usize)> = (0..n)
        .filter(|&j| !square && !fixed(j) && !free(j))
        .filter_map(|j| Some((row_of[j]? as usize, j)))
        .filter(|&(i, _)| instance.rows.relation[i] == Relation::Equal)
        .collect();
    if !bounded.is_empty() {
        findings.push(Finding::BoundedEquation(bounded));
    }
    let mut equation = vec![false; m];
    for (j, row) in row_of.iter().enumerate() {
        if let (Some(i), true) = (row, free(j)) {
            equation[*i as usize] = by_row.line(*i as usize).len() > 0;
        }
    }
    let rows: Vec<usize> = (0..m).filter(|&i| equation[i]).collect();
    if let Some((rows, columns)) = deficient(&by_row, &rows, n, |j| !fixed(j)) {
        findings.push(Finding::Overdetermined(Block { rows, columns }));
    }
    let unknown: Vec<usize> = (0..n)
        .filter(|&j| free(j) && by_column.line(j).len() > 0)
        .collect();
    if let Some((columns, rows)) = deficient(&by_column, &unknown, m, |_| true) {
        findings.push(Finding::Underdetermined(Block { rows, columns }));
    }
    findings
}

/// Matches every vertex of `left` with one of its neighbours; if that is impossible, the part of `left`
/// that alternating paths reach from an unmatched vertex, and its fewer neighbours. An entry of the graph counts where its number
/// is not 0.
pub(super) fn deficient(
    graph: &Sparse,
    left: &[usize],
    right: usize,
    allowed: impl Fn(usize) -> bool,
) -> Option<(Vec<usize>, Vec<usize>)> {
    const NONE: usize = usize::MAX;
    let mut partner = vec![NONE; right];
    let mut place = vec![NONE; graph.lines()];
    let neighbours = |i: usize| {
        graph
            .line(i)
            .filter(|e| e.1 != 0.0 && allowed(e.0))
            .map(|e| e.0)
    };
    let mut unmatched = Vec::new();
    for &i in left {
        match neighbours(i).find(|&j| partner[j] == NONE) {
            Some(j) => (partner[j], place[i]) = (i, j),
            None => unmatched.push(i),
        }
    }
    // From where each vertex on the right was reached, and in which search.
    let (mut from, mut seen) = (vec![NONE; right], vec![NONE; right]);
    let mut lost = Vec::new();
    for (search, &root) in unmatched.iter().enumerate() {
        let (mut queue, mut next, mut end) = (vec![root], 0, NONE);
        'search: while next < queue.len() {
            let i = queue[next];
            next += 1;
            for j in neighbours(i) {
                if seen[j] == search {
                    continue;
                }
                (seen[j], from[j]) = (search, i);
                if partner[j] == NONE {
                    end = j;
                    break 'search;
                }
                queue.push(partner[j]);
            }
        }
        if end == NONE {
            lost.push(root);
            continue;
        }
        // Along the path every vertex on the left takes the neighbour it was left through.
        while end != NONE {
            let i = from[end];
            let before = place[i];
            (partner[end], place[i]) = (i, end);
            end = before;
        }
    }
    if lost.is_empty() {
        return None;
    }
    let (mut inside, mut touched) = (lost, vec![false; right]);
    let mut next = 0;
    while next < inside.len() {
        for j in neighbours(inside[next]) {
            if !touched[j] {
                touched[j] = true;
                inside.push(partner[j]);
            }
        }
        next += 1;
    }
    inside.sort_unstable();
    Some((inside, (0..right).filter(|&j| touched[j]).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(rows: &[&[usize]]) -> Sparse {
        let mut graph = Sparse::default();
        for row in rows {
            graph.push(row.iter().map(|&j| (j, 1.0)));
        }
        graph
    }

    #[test]
    fn a_matching_is_found_by_exchanges() {
        let g = graph(&[&[0, 1], &[0], &[1, 2], &[2, 3]]);
        assert_eq!(deficient(&g, &[0, 1, 2, 3], 4, |_| true), None);
        let g = graph(&[&[0, 1], &[1, 2], &[0], &[2, 3]]);
        assert_eq!(deficient(&g, &[0, 1, 2, 3], 4, |_| true), None);
    }

    #[test]
    fn two_rows_in_one_column_are_a_block() {
        let g = graph(&[&[2], &[2], &[0, 1, 2]]);
        let block = deficient(&g, &[0, 1, 2], 3, |_| true);
        assert_eq!(block, Some((vec![0, 1], vec![2])));
        // The columns: 0 and 1 stand in the third row only.
        let block = deficient(&g.transpose(3), &[0, 1, 2], 3, |_| true);
        assert_eq!(block, Some((vec![0, 1], vec![2])));
    }
}
