//! Where the rows and columns of an instance come from: symbol and key of each block, as ranges.
//!
//! Names are made when asked for, never stored per row.

use crate::data::universe::Label;

/// Rows (or columns) of one equation (or variable).
#[derive(Clone, Debug)]
pub struct Block {
    /// Number of the symbol.
    pub symbol: u32,
    /// First row or column.
    pub start: u32,
    /// How many.
    pub len: u32,
    /// Labels per key.
    pub dim: usize,
    /// Keys, flat, in label order.
    pub keys: Vec<Label>,
}

impl Block {
    /// Key of row or column `i` (a number of the instance, inside this block).
    pub fn key(&self, i: u32) -> &[Label] {
        let k = (i - self.start) as usize * self.dim;
        &self.keys[k..k + self.dim]
    }

    /// The row or column with this key.
    pub fn find(&self, key: &[Label]) -> Option<u32> {
        let (mut lo, mut hi) = (0u32, self.len);
        while lo < hi {
            let mid = lo + (hi - lo) / 2;
            let k = &self.keys[mid as usize * self.dim..(mid as usize + 1) * self.dim];
            match k.cmp(key) {
                std::cmp::Ordering::Less => lo = mid + 1,
                std::cmp::Ordering::Greater => hi = mid,
                std::cmp::Ordering::Equal => return Some(self.start + mid),
            }
        }
        None
    }
}

/// Blocks in the order of rows or columns.
#[derive(Clone, Default, Debug)]
pub struct Blocks {
    /// The blocks.
    pub list: Vec<Block>,
}

impl Blocks {
    /// The block of row or column `i`.
    pub fn of(&self, i: u32) -> &Block {
        &self.list[self.position(i)]
    }

    /// The block of row or column `i`; None for one that a method added.
    pub fn get(&self, i: u32) -> Option<&Block> {
        self.list.get(self.position(i))
    }

    fn position(&self, i: u32) -> usize {
        self.list.partition_point(|b| b.start + b.len <= i)
    }

    /// The block of a symbol.
    pub fn symbol(&self, s: u32) -> Option<&Block> {
        self.list.iter().find(|b| b.symbol == s)
    }
}

/// A row without variables.
#[derive(Clone, Debug)]
pub struct LeftOut {
    /// Number of the equation.
    pub symbol: u32,
    /// Labels.
    pub key: Vec<Label>,
    /// Lower and upper bound of the level, which is 0.
    pub bounds: [f64; 2],
}

/// Origin of all rows and columns, and statistics as GAMS counts them.
#[derive(Clone, Default, Debug)]
pub struct Origin {
    /// Rows.
    pub rows: Blocks,
    /// Columns.
    pub columns: Blocks,
    /// Nonzeros: pairs of row and column.
    pub nonzeros: usize,
    /// Of those, where the column stands in a nonlinear term.
    pub nonlinear_nonzeros: usize,
    /// Rows without variables: they are not in the instance.
    pub left_out: Vec<LeftOut>,
    /// Variables that are held fixed, and their keys: constants of the instance.
    pub held: Vec<(u32, Vec<Label>)>,
    /// Columns of the instance that are held fixed: each is there for the row it is paired with.
    pub held_columns: Vec<u32>,
}
