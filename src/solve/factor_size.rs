//! What a factorisation costs, before it is begun: nonzeros and operations of a symmetric matrix under a fill-reducing
//! ordering.

use super::budget::Size;
use feral::CscMatrix;
use feral::symbolic::supernode::SupernodeParams;
use feral::symbolic::symbolic_factorize;

/// Entries (of either triangle, in any order, without the diagonal) up to which the analysis is left out: whatever
/// the fill, the factors of so small a matrix take no time.
const MIN_ANALYSED_ENTRIES: usize = 2_000;

/// The size of the factors of a symmetric matrix of order n with these entries and a full diagonal. Where the
/// analysis fails, the size of the matrix itself.
pub(crate) fn symmetric_size(
    what: &'static str,
    n: usize,
    entries: impl Iterator<Item = (usize, usize)>,
) -> Size {
    let (mut rows, mut columns): (Vec<usize>, Vec<usize>) =
        entries.map(|(i, j)| (i.max(j), i.min(j))).unzip();
    let count = rows.len() + n;
    let known = |nonzeros: f64, operations: f64| Size {
        what,
        nonzeros,
        operations,
    };
    // What is dense has the factors that it has: n² / 2 numbers.
    let full = 0.5 * (n as f64) * (n as f64);
    if count <= MIN_ANALYSED_ENTRIES || count as f64 > 0.5 * full {
        return known(full, full * n as f64 * 2.0 / 3.0);
    }
    rows.extend(0..n);
    columns.extend(0..n);
    let values = vec![1.0; rows.len()];
    let analysed = CscMatrix::from_triplets(n, &rows, &columns, &values)
        .and_then(|m| symbolic_factorize(&m, &SupernodeParams::default()));
    match analysed {
        Ok(symbolic) => {
            let e = symbolic.work_estimate();
            known((e.peak_bytes / 8) as f64, e.factor_flops)
        }
        Err(_) => known(count as f64, count as f64),
    }
}
