//! Sparse LU factorisations of Newton systems, each checked by its residual.
//!
//! `faer`'s LU (COLAMD ordering, partial pivoting, supernodal) reports structural singularity
//! only; a numerically singular matrix gives factors full of infinities, or of rounding errors. So
//! every solution is refined, and one whose residual is not small against the right-hand side
//! counts as a singular matrix. Of matrices that share a pattern and have a diagonal ([`Factor::analysed`]) the
//! [`multifrontal`](super::multifrontal) LU is tried first, which fills up far less. Where little fill is to be expected ([`Fill`]), `feral`'s Markowitz
//! LU is used instead: it peels singletons, and a dense row does no harm.

use std::cell::RefCell;
use std::rc::Rc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use feral::{LuParams, LuScaling, SparseColMatrix, SparseLu, SparseLuSymbolic};

use super::gmres::gmres;
use super::multifrontal::{Multifrontal, Tree};

/// How much the factors of a problem's matrices will fill up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fill {
    /// Factors about as sparse as the matrix.
    Light,
    /// Factors with dense blocks.
    Heavy,
}

/// Operations per nonzero of the factors from which dense blocks pay.
const HEAVY_RATIO: f64 = 6.0;
/// Bound on the nonzeros of AᵀA, which bound the memory of the supernodal LU.
const HEAVY_MEMORY: f64 = 2e8;

impl Fill {
    /// Judges a pattern by the operations a minimum degree ordering of A + Aᵀ leads to.
    pub(super) fn of(n: usize, col_ptr: &[usize], row_idx: &[usize]) -> Fill {
        let mut row_count = vec![0usize; n];
        row_idx.iter().for_each(|&i| row_count[i] += 1);
        let product: f64 = row_count.iter().map(|&r| (r as f64).powi(2)).sum();
        if n == 0 || product > HEAVY_MEMORY {
            return Fill::Light;
        }
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, col_ptr, None, row_idx);
        let (mut order, mut inverse) = (vec![0usize; n], vec![0usize; n]);
        let mut memory = MemBuffer::new(amd::order_scratch::<usize>(n, row_idx.len()));
        match amd::order(
            &mut order,
            &mut inverse,
            pattern,
            amd::Control::default(),
            MemStack::new(&mut memory),
        ) {
            Ok(count) if count.n_mult_subs_lu > HEAVY_RATIO * (count.n_div + n as f64) => {
                Fill::Heavy
            }
            _ => Fill::Light,
        }
    }
}

/// `faer`'s factors of a finite matrix; None if it is structurally singular.
pub(super) fn faer_lu(matrix: &SparseColMatrix) -> Option<Lu<usize, f64>> {
    Orderings::new(matrix).columns(matrix)
}

/// x ← A⁻¹x.
pub(super) fn faer_solve(lu: &Lu<usize, f64>, x: &mut [f64]) {
    lu.solve_in_place(faer::ColMut::from_slice_mut(x));
}

/// A matrix and its LU factors.
pub(super) struct Factor {
    matrix: SparseColMatrix,
    lu: Engine,
}

enum Engine {
    Markowitz(Box<SparseLu>),
    Supernodal(Box<Lu<usize, f64>>),
    /// With what to do where its solutions are not exact.
    Multifrontal(Rc<Tree>, Multifrontal, Analysis),
}

/// Residual, relative to the right-hand side, above which a solution is not one.
const RESIDUAL_TOLERANCE: f64 = 1e-6;
/// Factorisations after one that failed for which the multifrontal LU is not tried again.
const PAUSE: usize = 10;

/// The orderings of a pattern, kept for matrices that share it.
#[derive(Default, Clone)]
pub(super) struct Analysis(Rc<RefCell<Orderings>>);

#[derive(Default)]
struct Orderings {
    col_ptr: Vec<usize>,
    row_idx: Vec<usize>,
    columns: Option<SymbolicLu<usize>>,
    tree: Option<Rc<Tree>>,
    pause: usize,
}

impl Orderings {
    fn new(matrix: &SparseColMatrix) -> Self {
        Orderings {
            col_ptr: matrix.col_ptr.clone(),
            row_idx: matrix.row_idx.clone(),
            ..Orderings::default()
        }
    }

    /// `faer`'s factors.
    fn columns(&mut self, matrix: &SparseColMatrix) -> Option<Lu<usize, f64>> {
        let m = matrix.m;
        let pattern =
            SymbolicSparseColMatRef::new_checked(m, m, &matrix.col_ptr, None, &matrix.row_idx);
        if self.columns.is_none() {
            self.columns = Some(SymbolicLu::try_new(pattern).ok()?);
        }
        let matrix = SparseColMatRef::new(pattern, &matrix.values);
        Lu::try_new_with_symbolic(self.columns.clone()?, matrix).ok()
    }

    /// Multifrontal factors, unless they failed of late.
    fn fronts(&mut self, matrix: &SparseColMatrix) -> Option<(Rc<Tree>, Multifrontal)> {
        if self.pause > 0 {
            self.pause -= 1;
            return None;
        }
        if self.tree.is_none() {
            let tree = Tree::new(matrix.m, &matrix.col_ptr, &matrix.row_idx)?;
            self.tree = Some(Rc::new(tree));
        }
        let tree = self.tree.clone()?;
        let factors = Multifrontal::new(&tree, &matrix.values);
        if factors.is_none() {
            self.pause = PAUSE;
        }
        Some((tree, factors?))
    }
}

impl Analysis {
    /// The factors that promise the least work.
    fn engine(&self, matrix: &SparseColMatrix) -> Option<Engine> {
        let mut orderings = self.0.borrow_mut();
        if orderings.col_ptr != matrix.col_ptr || orderings.row_idx != matrix.row_idx {
            *orderings = Orderings::new(matrix);
        }
        if let Some((tree, factors)) = orderings.fronts(matrix) {
            return Some(Engine::Multifrontal(tree, factors, self.clone()));
        }
        let lu = orderings.columns(matrix)?;
        Some(Engine::Supernodal(Box::new(lu)))
    }
}

impl Factor {
    /// Factorises; None if singular or not finite.
    pub(super) fn new(matrix: SparseColMatrix, fill: Fill) -> Option<Factor> {
        Factor::with(matrix, fill, |matrix| {
            Some(Engine::Supernodal(Box::new(faer_lu(matrix)?)))
        })
    }

    /// Factorises one of several matrices with the same pattern, whose diagonals are worth pivoting on.
    pub(super) fn analysed(
        matrix: SparseColMatrix,
        fill: Fill,
        analysis: &Analysis,
    ) -> Option<Factor> {
        Factor::with(matrix, fill, |matrix| analysis.engine(matrix))
    }

    fn with(
        matrix: SparseColMatrix,
        fill: Fill,
        heavy: impl FnOnce(&SparseColMatrix) -> Option<Engine>,
    ) -> Option<Factor> {
        // A non-finite entry must not reach the factorisation, which compares magnitudes.
        if matrix.m == 0 || matrix.values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let lu = match fill {
            Fill::Heavy => heavy(&matrix)?,
            Fill::Light => {
                let params = LuParams {
                    scaling: LuScaling::InfNorm,
                    zero_pivot_tol: 1e-14,
                    ..LuParams::default()
                };
                let lu =
                    SparseLu::factor(&matrix, &SparseLuSymbolic::natural(matrix.m), params).ok()?;
                Engine::Markowitz(Box::new(lu))
            }
        };
        Some(Factor { matrix, lu })
    }

    /// b ← A⁻¹b; to a residual of `enough` where factors are not exact.
    fn solve_once(&mut self, b: &mut [f64], enough: f64) -> Option<()> {
        match &mut self.lu {
            Engine::Markowitz(lu) => lu.ftran(b).ok()?,
            Engine::Supernodal(lu) => faer_solve(lu, b),
            Engine::Multifrontal(tree, factors, _) => {
                let solution = gmres(&self.matrix, b, enough, |x| factors.solve(tree, x));
                b.copy_from_slice(&solution);
            }
        }
        Some(())
    }

    /// Whether other factors may do better; then they are at hand.
    fn exchanged(&mut self) -> bool {
        let Engine::Multifrontal(_, _, analysis) = &self.lu else {
            return false;
        };
        let mut orderings = analysis.0.borrow_mut();
        orderings.pause = PAUSE;
        let lu = orderings.columns(&self.matrix);
        drop(orderings);
        let exchanged = lu.is_some();
        if let Some(lu) = lu {
            self.lu = Engine::Supernodal(Box::new(lu));
        }
        exchanged
    }

    /// Solves A x = b; None if the solution does not satisfy the system.
    pub(super) fn solve(&mut self, b: &[f64]) -> Option<Vec<f64>> {
        self.solve_to(b, 1e-14)
    }

    /// As [`Factor::solve`], refined only as long as the residual, relative to b, is larger than `enough`.
    pub(super) fn solve_to(&mut self, b: &[f64], enough: f64) -> Option<Vec<f64>> {
        self.refined(b, enough).or_else(|| {
            let exchanged = self.exchanged();
            exchanged.then(|| self.refined(b, enough))?
        })
    }

    fn refined(&mut self, b: &[f64], enough: f64) -> Option<Vec<f64>> {
        let norm = b.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        let mut x = b.to_vec();
        self.solve_once(&mut x, enough * norm)?;
        let mut residual = vec![0.0; b.len()];
        for step in 0..3 {
            self.matrix.matvec(&x, &mut residual);
            let mut worst = 0.0f64;
            for (r, b) in residual.iter_mut().zip(b) {
                *r = b - *r;
                worst = if r.is_nan() {
                    f64::INFINITY
                } else {
                    worst.max(r.abs())
                };
            }
            if !worst.is_finite() {
                return None;
            }
            if worst <= enough * norm {
                return Some(x);
            }
            if step == 2 {
                return (worst <= RESIDUAL_TOLERANCE * norm).then_some(x);
            }
            self.solve_once(&mut residual, enough * norm)?;
            x.iter_mut().zip(&residual).for_each(|(x, d)| *x += d);
        }
        unreachable!("the loop returns in its last step")
    }
}

/// Builds a matrix from columns given as (row, value) lists.
pub(super) struct Builder {
    matrix: SparseColMatrix,
}

impl Builder {
    /// An m × m matrix without columns yet.
    pub(super) fn new(m: usize) -> Self {
        let mut col_ptr = Vec::with_capacity(m + 1);
        col_ptr.push(0);
        Builder {
            matrix: SparseColMatrix {
                m,
                col_ptr,
                row_idx: Vec::new(),
                values: Vec::new(),
            },
        }
    }

    /// Adds an entry to the column under construction; rows must come in increasing order.
    pub(super) fn push(&mut self, row: usize, value: f64) {
        self.matrix.row_idx.push(row);
        self.matrix.values.push(value);
    }

    /// Ends the column.
    pub(super) fn end_column(&mut self) {
        self.matrix.col_ptr.push(self.matrix.row_idx.len());
    }

    /// The matrix; all m columns must have been ended.
    pub(super) fn finish(self) -> SparseColMatrix {
        debug_assert_eq!(self.matrix.col_ptr.len(), self.matrix.m + 1);
        self.matrix
    }
}

/// A + v·I. The pattern of A need not contain the diagonal.
pub(super) fn shifted(a: &SparseColMatrix, v: f64) -> SparseColMatrix {
    combine(a, |_| v, |_| 1.0)
}

/// Diagonal(da) + Diagonal(db)·A.
pub(super) fn combine(
    a: &SparseColMatrix,
    da: impl Fn(usize) -> f64,
    db: impl Fn(usize) -> f64,
) -> SparseColMatrix {
    let mut b = Builder::new(a.m);
    for j in 0..a.m {
        let (rows, values) = a.column(j);
        let mut diagonal = Some(da(j)).filter(|d| *d != 0.0);
        for (&i, &v) in rows.iter().zip(values) {
            if i >= j
                && let Some(d) = diagonal.take()
            {
                if i == j {
                    b.push(i, d + db(i) * v);
                    continue;
                }
                b.push(j, d);
            }
            b.push(i, db(i) * v);
        }
        if let Some(d) = diagonal {
            b.push(j, d);
        }
        b.end_column();
    }
    b.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagonal_is_added_where_the_pattern_lacks_it() {
        let a = SparseColMatrix {
            m: 3,
            col_ptr: vec![0, 2, 3, 4],
            row_idx: vec![1, 2, 1, 0],
            values: vec![5.0, 6.0, 7.0, 8.0],
        };
        let b = shifted(&a, 2.0);
        let mut y = vec![0.0; 3];
        b.matvec(&[1.0, 10.0, 100.0], &mut y);
        assert_eq!(y, [2.0 + 800.0, 5.0 + 70.0 + 20.0, 6.0 + 200.0]);
        assert!(b.validate().is_ok());
    }

    #[test]
    fn singular_matrices_are_noticed() {
        // Rank one, and its perturbation by rounding.
        for epsilon in [0.0, 1e-17] {
            let a = SparseColMatrix {
                m: 2,
                col_ptr: vec![0, 2, 4],
                row_idx: vec![0, 1, 0, 1],
                values: vec![1.0, 2.0, 2.0, 4.0 + epsilon],
            };
            for fill in [Fill::Light, Fill::Heavy] {
                let solved = Factor::new(a.clone(), fill).and_then(|mut f| f.solve(&[1.0, 0.0]));
                assert!(solved.is_none());
            }
        }
        let nan = SparseColMatrix {
            m: 1,
            col_ptr: vec![0, 1],
            row_idx: vec![0],
            values: vec![f64::NAN],
        };
        assert!(Factor::new(nan, Fill::Light).is_none());
    }
}
