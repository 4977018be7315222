//! Multifrontal LU of matrices with a nearly symmetric pattern and a diagonal.
//!
//! The matrices of interior steps have positive numbers on the diagonal of every variable with a bound. A minimum degree
//! ordering of A + Aᵀ then gives factors many times sparser than one of AᵀA, on which the fill of partial pivoting
//! depends. Pivots are taken within the rows of a front as long as they are not smaller than the front's other rows by
//! more than [`THRESHOLD`]; columns without such a pivot go on to the front above (Duff & Reid 1983). So weak a test
//! lets digits be lost, which [`gmres`](super::gmres) wins back with the factors for a preconditioner.
//!
//! The libraries at hand have no such LU: `faer`'s orders AᵀA and pivots by rows, `feral`'s fronts are those of symmetric matrices. The
//! ordering, the supernodes and the dense kernels are `faer`'s.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
use faer::{Accum, MatMut, MatRef, Par, Side};

/// Least pivot, relative to the largest entry of its column.
const THRESHOLD: f64 = 1e-10;
/// Operations, as a multiple of those without columns that go on, after which the factorisation is given up.
const OPERATIONS: f64 = 12.0;
/// Columns per update of the others.
const PANEL: usize = 32;
/// Operations below which plain loops are faster than blocked products.
const MIN_BLOCKED_OPERATIONS: usize = 3000;

/// The fronts of a pattern: what depends on no values.
pub(super) struct Tree {
    /// Indices in the order of elimination.
    order: Vec<usize>,
    nodes: Vec<Node>,
    operations: f64,
}

struct Node {
    /// First index of its own, in the order of elimination, and how many.
    first: usize,
    own: usize,
    /// The other indices of the front, increasing.
    below: Vec<usize>,
    children: Vec<usize>,
    /// Where `below` stands in the front above.
    into: Vec<usize>,
    /// Positions of entries of A, and their rows and columns in the front.
    entries: Vec<(usize, usize, usize)>,
}

impl Node {
    /// Where an index stands in the front.
    fn local(&self, index: usize) -> usize {
        if index < self.first + self.own {
            return index - self.first;
        }
        self.own + self.below.partition_point(|&b| b < index)
    }
}

/// Operations to eliminate `pivots` columns of a front.
fn operations(pivots: usize, size: usize) -> f64 {
    pivots as f64 * (size as f64).powi(2)
}

/// The upper triangle of the pattern of A + Aᵀ + I.
fn symmetric(n: usize, col_ptr: &[usize], row_idx: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let mut columns: Vec<Vec<usize>> = (0..n).map(|j| vec![j]).collect();
    for j in 0..n {
        for &i in &row_idx[col_ptr[j]..col_ptr[j + 1]] {
            columns[i.max(j)].push(i.min(j));
        }
    }
    let (mut start, mut rows) = (vec![0], Vec::new());
    for mut column in columns {
        column.sort_unstable();
        column.dedup();
        rows.append(&mut column);
        start.push(rows.len());
    }
    (start, rows)
}

impl Tree {
    /// Orders a pattern compressed by columns; None if there is not enough memory.
    pub(super) fn new(n: usize, col_ptr: &[usize], row_idx: &[usize]) -> Option<Tree> {
        let (start, rows) = symmetric(n, col_ptr, row_idx);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            supernodal_params: SymbolicSupernodalParams {
                relax: Some(&[(8, 1.0), (24, 0.8), (64, 0.3), (usize::MAX, 0.1)]),
            },
            ..CholeskySymbolicParams::default()
        };
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &start, None, &rows);
        let symbolic =
            factorize_symbolic_cholesky(pattern, Side::Upper, SymmetricOrdering::Amd, params)
                .ok()?;
        let (order, inverse) = symbolic.perm()?.arrays();
        let SymbolicCholeskyRaw::Supernodal(supernodes) = symbolic.raw() else {
            return None;
        };
        let mut node_of = vec![0; n];
        let mut nodes: Vec<Node> = (0..supernodes.n_supernodes())
            .map(|s| {
                let first = supernodes.supernode_begin()[s];
                let end = supernodes.supernode_end()[s];
                node_of[first..end].fill(s);
                Node {
                    first,
                    own: end - first,
                    below: supernodes.supernode(s).pattern().to_vec(),
                    children: Vec::new(),
                    into: Vec::new(),
                    entries: Vec::new(),
                }
            })
            .collect();
        let mut total = 0.0;
        for s in 0..nodes.len() {
            let node = &nodes[s];
            total += operations(node.own, node.own + node.below.len());
            if let Some(&above) = node.below.first() {
                let above = node_of[above];
                nodes[s].into = node.below.iter().map(|&i| nodes[above].local(i)).collect();
                nodes[above].children.push(s);
            }
        }
        for j in 0..n {
            for (k, &i) in (col_ptr[j]..col_ptr[j + 1]).zip(&row_idx[col_ptr[j]..]) {
                let (i, j) = (inverse[i], inverse[j]);
                let node = &mut nodes[node_of[i.min(j)]];
                let entry = (k, node.local(i), node.local(j));
                node.entries.push(entry);
            }
        }
        Some(Tree {
            order: order.to_vec(),
            nodes,
            operations: total,
        })
    }
}

/// A dense matrix by columns, of which the first `full` rows and columns may be pivots.
struct Front {
    values: Vec<f64>,
    size: usize,
    full: usize,
    rows: Vec<usize>,
    columns: Vec<usize>,
}

/// The eliminated columns of a front.
struct Pivots {
    rows: Vec<usize>,
    columns: Vec<usize>,
    count: usize,
    /// L, and U in its triangle, `rows.len()` each.
    left: Vec<f64>,
    /// The rest of U by columns, `count` each.
    right: Vec<f64>,
    /// What is left for the front above, and how many of its columns could have been pivots.
    rest: Vec<f64>,
    late: usize,
}

/// LU factors.
pub(super) struct Multifrontal(Vec<Pivots>);

impl Front {
    fn swap_columns(&mut self, i: usize, j: usize) {
        if i != j {
            let (i, j) = (i.min(j), i.max(j));
            self.columns.swap(i, j);
            let (left, right) = self.values.split_at_mut(j * self.size);
            left[i * self.size..][..self.size].swap_with_slice(&mut right[..self.size]);
        }
    }

    fn swap_rows(&mut self, i: usize, j: usize) {
        if i != j {
            self.rows.swap(i, j);
            let columns = self.values.chunks_exact_mut(self.size);
            columns.for_each(|column| column.swap(i, j));
        }
    }

    /// The row to pivot on in column k, none of the rows before k.
    fn pivot(&self, k: usize) -> Option<usize> {
        let column = &self.values[k * self.size..][..self.size];
        let largest = |from: usize, to: usize| {
            (from..to).fold((0.0, from), |best: (f64, usize), i| {
                if column[i].abs() > best.0 {
                    (column[i].abs(), i)
                } else {
                    best
                }
            })
        };
        let (pivot, row) = largest(k, self.full);
        let (other, _) = largest(self.full, self.size);
        (pivot > 0.0 && pivot.is_finite() && pivot >= THRESHOLD * other).then_some(row)
    }

    /// Subtracts what pivots `first` to `last` eliminate from the columns from `from` to `to`.
    fn update(&mut self, (first, last): (usize, usize), from: usize, to: usize) {
        let (size, count, width) = (self.size, last - first, to - from);
        if count == 0 || width == 0 {
            return;
        }
        let (left, right) = self.values.split_at_mut(from * size);
        let right = &mut right[..width * size];
        if count * width * (size - first) < MIN_BLOCKED_OPERATIONS {
            for column in right.chunks_exact_mut(size) {
                for k in first..last {
                    subtract(column, &left[k * size..][..size], k);
                }
            }
            return;
        }
        let lower = MatRef::from_column_major_slice(&left[first * size..last * size], size, count);
        let (_, right) =
            MatMut::from_column_major_slice_mut(right, size, width).split_at_row_mut(first);
        let (mut upper, rest) = right.split_at_row_mut(count);
        let triangle = lower.submatrix(first, 0, count, count);
        solve_unit_lower_triangular_in_place(triangle, upper.as_mut(), Par::Seq);
        let below = lower.submatrix(last, 0, size - last, count);
        matmul(rest, Accum::Add, below, upper.as_ref(), -1.0, Par::Seq);
    }

    /// Eliminates what has a pivot; how many columns.
    fn eliminate(&mut self) -> usize {
        let (size, full) = (self.size, self.full);
        // Candidates are the columns from `done` to `end`; those after have none, or had none before the last pivots.
        let (mut done, mut end, mut progress) = (0, full, false);
        while done < full {
            if done == end {
                if !std::mem::take(&mut progress) {
                    break;
                }
                end = full;
            }
            let (first, last) = (done, end.min(done + PANEL));
            let mut open = last;
            while done < open {
                let Some(row) = self.pivot(done) else {
                    open -= 1;
                    self.swap_columns(done, open);
                    continue;
                };
                self.swap_rows(done, row);
                let (left, right) = self.values.split_at_mut((done + 1) * size);
                let column = &mut left[done * size..];
                let pivot = column[done];
                column[done + 1..].iter_mut().for_each(|l| *l /= pivot);
                for other in right[..(last - done - 1) * size].chunks_exact_mut(size) {
                    subtract(other, column, done);
                }
                done += 1;
            }
            progress |= done > first;
            self.update((first, done), last, full);
            let without = last - done;
            (0..without.min(end - last)).for_each(|k| self.swap_columns(done + k, end - 1 - k));
            end -= without;
        }
        self.update((0, done), full, size);
        done
    }

    /// Takes the eliminated columns apart from what is left.
    fn split(self, count: usize) -> Pivots {
        let (size, late) = (self.size, self.full - count);
        let mut right = Vec::with_capacity(count * (size - count));
        let mut rest = Vec::with_capacity((size - count).pow(2));
        for column in self.values.chunks_exact(size).skip(count) {
            right.extend_from_slice(&column[..count]);
            rest.extend_from_slice(&column[count..]);
        }
        let mut left = self.values;
        left.truncate(count * size);
        left.shrink_to_fit();
        Pivots {
            rows: self.rows,
            columns: self.columns,
            count,
            left,
            right,
            rest,
            late,
        }
    }
}

/// Row k of L times the k-th entry of a column, from the column's rows below k.
fn subtract(column: &mut [f64], lower: &[f64], k: usize) {
    let factor = column[k];
    if factor != 0.0 {
        let below = column[k + 1..].iter_mut().zip(&lower[k + 1..]);
        below.for_each(|(x, l)| *x -= factor * l);
    }
}

impl Multifrontal {
    /// Factorises; None if the matrix is singular, or too many columns have no pivot in their fronts.
    pub(super) fn new(tree: &Tree, values: &[f64]) -> Option<Multifrontal> {
        let mut done: Vec<Pivots> = Vec::with_capacity(tree.nodes.len());
        let mut spent = 0.0;
        for node in &tree.nodes {
            let mut front = assemble(tree, node, values, &mut done);
            let count = front.eliminate();
            if node.below.is_empty() && count < front.full {
                return None;
            }
            spent += operations(count, front.size);
            if spent > OPERATIONS * tree.operations {
                return None;
            }
            done.push(front.split(count));
        }
        Some(Multifrontal(done))
    }

    /// x ← A⁻¹x, as far as the pivots allow.
    pub(super) fn solve(&self, tree: &Tree, x: &mut [f64]) {
        let mut y: Vec<f64> = tree.order.iter().map(|&i| x[i]).collect();
        for front in &self.0 {
            let size = front.rows.len();
            for k in 0..front.count {
                let value = y[front.rows[k]];
                if value != 0.0 {
                    let column = &front.left[k * size..][..size];
                    let below = front.rows.iter().zip(column).skip(k + 1);
                    below.for_each(|(&i, l)| y[i] -= value * l);
                }
            }
        }
        let mut solution = vec![0.0; x.len()];
        let mut top = Vec::new();
        for front in self.0.iter().rev().filter(|front| front.count > 0) {
            let (count, size) = (front.count, front.rows.len());
            top.clear();
            top.extend(front.rows[..count].iter().map(|&i| y[i]));
            let right = front.right.chunks_exact(count);
            for (&j, upper) in front.columns[count..].iter().zip(right) {
                let value = solution[j];
                top.iter_mut().zip(upper).for_each(|(t, u)| *t -= value * u);
            }
            for k in (0..count).rev() {
                let column = &front.left[k * size..];
                let value = top[k] / column[k];
                solution[front.columns[k]] = value;
                let above = top[..k].iter_mut().zip(column);
                above.for_each(|(t, u)| *t -= value * u);
            }
        }
        for (&i, value) in tree.order.iter().zip(solution) {
            x[i] = value;
        }
    }
}

/// A node's front: its entries of A, and what its children left.
fn assemble(tree: &Tree, node: &Node, values: &[f64], done: &mut [Pivots]) -> Front {
    let late: usize = node.children.iter().map(|&c| done[c].late).sum();
    let full = node.own + late;
    let size = full + node.below.len();
    let own = || node.first..node.first + node.own;
    let mut front = Front {
        values: vec![0.0; size * size],
        size,
        full,
        rows: own().collect(),
        columns: own().collect(),
    };
    // Columns that come late stand after the node's own.
    let place = |i: usize| if i < node.own { i } else { i + late };
    for &(k, i, j) in &node.entries {
        front.values[place(j) * size + place(i)] += values[k];
    }
    for &c in &node.children {
        let (child, next) = (&mut done[c], front.rows.len());
        let came = child.count..child.count + child.late;
        front.rows.extend_from_slice(&child.rows[came.clone()]);
        front.columns.extend_from_slice(&child.columns[came]);
        let below = tree.nodes[c].into.iter().map(|&i| place(i));
        let into: Vec<usize> = (next..next + child.late).chain(below).collect();
        let rest = std::mem::take(&mut child.rest);
        for (&j, from) in into.iter().zip(rest.chunks_exact(into.len().max(1))) {
            let column = &mut front.values[j * size..][..size];
            into.iter().zip(from).for_each(|(&i, v)| column[i] += v);
        }
    }
    front.rows.extend_from_slice(&node.below);
    front.columns.extend_from_slice(&node.below);
    front
}

#[cfg(test)]
mod tests {
    use feral::SparseColMatrix;

    use super::super::random::Random;
    use super::*;

    /// A saddle point matrix: diagonal for half of the unknowns, none for the rest.
    fn saddle(half: usize, diagonal: impl Fn(usize) -> f64) -> SparseColMatrix {
        let mut random = Random::new(1);
        let mut columns = vec![Vec::new(); 2 * half];
        for j in 0..half {
            columns[j].push((j, diagonal(j)));
            for i in [j, (j + 1) % half, (j * 7 + 3) % half] {
                columns[j].push((half + i, random.between(0.5, 2.0)));
                columns[half + i].push((j, random.between(-2.0, -0.5)));
            }
        }
        for column in &mut columns {
            column.sort_unstable_by_key(|entry| entry.0);
            column.dedup_by_key(|entry| entry.0);
        }
        SparseColMatrix::from_sparse_columns(2 * half, &columns).expect("rows in range")
    }

    #[test]
    fn solves_with_pivots_that_are_large_small_or_missing() {
        for size in [1.0, 1e-6, 1e-14, 0.0] {
            let a = saddle(100, |j| if j % 3 == 0 { size } else { 1.0 });
            let tree = Tree::new(a.m, &a.col_ptr, &a.row_idx).expect("memory");
            let factors = Multifrontal::new(&tree, &a.values).expect("regular");
            let mut random = Random::new(2);
            let b: Vec<f64> = (0..a.m).map(|_| random.between(-1.0, 1.0)).collect();
            let mut x = b.clone();
            factors.solve(&tree, &mut x);
            let mut product = vec![0.0; a.m];
            a.matvec(&x, &mut product);
            for (p, b) in product.iter().zip(&b) {
                assert!((p - b).abs() < 1e-4, "{p} {b} with {size}");
            }
        }
    }

    #[test]
    fn singular_is_none() {
        let a = SparseColMatrix::from_sparse_columns(
            2,
            &[vec![(0, 1.0), (1, 2.0)], vec![(0, 2.0), (1, 4.0)]],
        )
        .expect("rows in range");
        let tree = Tree::new(2, &a.col_ptr, &a.row_idx).expect("memory");
        assert!(Multifrontal::new(&tree, &a.values).is_none());
    }
}
