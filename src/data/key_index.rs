//! Which record has a key.
//!
//! Records are numbered 0, 1, … and their keys are kept by the owner, `dim` labels a record in one
//! vector; the index finds the number. Where the keys fill a good part of the box of labels they
//! span it is that box, laid out row by row (one access to memory for a lookup); elsewhere it is a
//! hash table.
//!
//! Invariant: memory is proportional to the records, at most [`SPARE`] places each.

use super::universe::Label;
use hashbrown::HashTable;
use std::hash::Hasher;

/// Places of a box per record in it, at most.
const SPARE: usize = 8;

/// The range of labels at each position.
#[derive(Clone, Debug)]
pub struct LabelBox {
    /// The least label and the number of labels, by position.
    ranges: Box<[(Label, u32)]>,
    /// Number of places; None when it does not fit into 32 bits.
    size: Option<usize>,
}

impl LabelBox {
    /// From the least and the greatest label at each position; None for an empty range.
    pub fn new(ranges: impl Iterator<Item = Option<(Label, Label)>>) -> Option<Self> {
        let mut boxed = Vec::new();
        let mut size = Some(1usize);
        for r in ranges {
            let (low, high) = r?;
            let extent = (high - low).checked_add(1)?;
            size = size
                .and_then(|s| s.checked_mul(extent as usize))
                .filter(|&s| s < u32::MAX as usize);
            boxed.push((low, extent));
        }
        Some(Self {
            ranges: boxed.into(),
            size,
        })
    }

    /// What the keys span.
    fn around(keys: &[Label], dim: usize) -> Option<Self> {
        let mut ranges = vec![None; dim];
        for key in keys.chunks_exact(dim) {
            for (r, &l) in ranges.iter_mut().zip(key) {
                *r = match *r {
                    None => Some((l, l)),
                    Some((lo, hi)) => Some((l.min(lo), l.max(hi))),
                };
            }
        }
        Self::new(ranges.into_iter())
    }

    /// Whether a box for that many records is worth its memory.
    pub fn fits(&self, records: usize) -> bool {
        self.size.is_some_and(|s| s <= 64 + SPARE * records)
    }

    #[inline]
    fn place(&self, key: &[Label]) -> Option<usize> {
        let mut at = 0;
        for (&l, &(low, extent)) in key.iter().zip(&self.ranges) {
            let offset = l.wrapping_sub(low);
            if offset >= extent {
                return None;
            }
            at = at * extent as usize + offset as usize;
        }
        Some(at)
    }
}

/// An index over records of `dim` ≥ 1 labels.
#[derive(Clone, Debug)]
pub struct KeyIndex {
    dim: usize,
    shape: Shape,
}

#[derive(Clone, Debug)]
enum Shape {
    /// Record + 1 by place.
    Dense(LabelBox, Vec<u32>),
    Hash(HashTable<u32>),
}

/// Whether two keys of the same length are equal, without a call for the usual lengths.
#[inline]
pub(super) fn same(a: &[Label], b: &[Label]) -> bool {
    match (a, b) {
        ([a], [b]) => a == b,
        ([a0, a1], [b0, b1]) => a0 == b0 && a1 == b1,
        ([a0, a1, a2], [b0, b1, b2]) => a0 == b0 && a1 == b1 && a2 == b2,
        _ => a == b,
    }
}

/// Whether a key comes before another of the same length, without a call for the usual lengths.
#[inline]
pub(super) fn before(a: &[Label], b: &[Label]) -> bool {
    match (a, b) {
        ([a], [b]) => a < b,
        ([a0, a1], [b0, b1]) => (a0, a1) < (b0, b1),
        _ => a < b,
    }
}

#[inline]
fn hash_key(key: &[Label]) -> u64 {
    let mut h = rustc_hash::FxHasher::default();
    for &k in key {
        h.write_u32(k);
    }
    h.finish()
}

impl KeyIndex {
    /// An index without records.
    pub fn new(dim: usize) -> Self {
        Self {
            dim,
            shape: Shape::Hash(HashTable::new()),
        }
    }

    /// An index of the records that are alive.
    pub fn build(keys: &[Label], dim: usize, alive: impl Fn(u32) -> bool + Copy) -> Self {
        let n = keys.len() / dim;
        let records = (0..n as u32).filter(|&r| alive(r));
        let mut index = Self::new(dim);
        let whole = LabelBox::around(keys, dim).filter(|b| b.fits(n));
        if whole
            .and_then(|b| index.fill_box(b, keys, records.clone()))
            .is_none()
        {
            index.fill_hash(keys, n, records);
        }
        index
    }

    /// None, and no change, when the box does not hold every key.
    fn fill_box(
        &mut self,
        b: LabelBox,
        keys: &[Label],
        records: impl Iterator<Item = u32>,
    ) -> Option<()> {
        let mut place = vec![0; b.size?];
        for r in records {
            let at = b.place(&keys[r as usize * self.dim..][..self.dim])?;
            place[at] = r + 1;
        }
        self.shape = Shape::Dense(b, place);
        Some(())
    }

    fn fill_hash(&mut self, keys: &[Label], room: usize, records: impl Iterator<Item = u32>) {
        let hash = |r: u32| hash_key(&keys[r as usize * self.dim..][..self.dim]);
        let mut t = HashTable::with_capacity(room);
        for r in records {
            t.insert_unique(hash(r), r, |&r| hash(r));
        }
        self.shape = Shape::Hash(t);
    }

    /// Lays the records out in a box that holds every key, those to come too (else it will not last).
    pub fn spread_over(&mut self, b: &LabelBox, keys: &[Label]) {
        if let Shape::Hash(t) = &self.shape {
            let records: Vec<u32> = t.iter().copied().collect();
            self.fill_box(b.clone(), keys, records.into_iter());
        }
    }

    /// Whether a lookup costs one access.
    pub fn is_dense(&self) -> bool {
        matches!(self.shape, Shape::Dense(..))
    }

    /// The record with this key.
    #[inline]
    pub fn find(&self, key: &[Label], keys: &[Label]) -> Option<u32> {
        match &self.shape {
            Shape::Dense(b, place) => place[b.place(key)?].checked_sub(1),
            Shape::Hash(t) => {
                let d = self.dim;
                t.find(hash_key(key), |&r| same(&keys[r as usize * d..][..d], key))
                    .copied()
            }
        }
    }

    /// The record with this key, or None after making `record` the one that has it.
    pub fn find_or_insert(&mut self, key: &[Label], record: u32, keys: &[Label]) -> Option<u32> {
        let d = self.dim;
        match &mut self.shape {
            Shape::Dense(b, place) => match b.place(key) {
                Some(at) if place[at] > 0 => Some(place[at] - 1),
                Some(at) => {
                    place[at] = record + 1;
                    None
                }
                None => {
                    self.insert(key, record, keys);
                    None
                }
            },
            Shape::Hash(t) => {
                let at = |&r: &u32| &keys[r as usize * d..][..d];
                match t.entry(hash_key(key), |r| at(r) == key, |r| hash_key(at(r))) {
                    hashbrown::hash_table::Entry::Occupied(e) => Some(*e.get()),
                    hashbrown::hash_table::Entry::Vacant(e) => {
                        e.insert(record);
                        None
                    }
                }
            }
        }
    }

    /// Adds a record whose key is new. `keys` holds the keys of the others at least.
    pub fn insert(&mut self, key: &[Label], record: u32, keys: &[Label]) {
        if let Shape::Dense(b, place) = &mut self.shape {
            if let Some(at) = b.place(key) {
                place[at] = record + 1;
                return;
            }
            if self.dim == 1 && key[0] >= b.ranges[0].0 {
                let extent = (key[0] - b.ranges[0].0) as usize + 1;
                if extent <= 64 + SPARE * (record as usize + 1) {
                    b.ranges[0].1 = extent as u32;
                    b.size = Some(extent);
                    place.resize(extent, 0);
                    place[extent - 1] = record + 1;
                    return;
                }
            }
            let records: Vec<u32> = place.iter().filter_map(|r| r.checked_sub(1)).collect();
            self.fill_hash(keys, records.len() + 1, records.into_iter());
        }
        if let Shape::Hash(t) = &mut self.shape {
            if t.is_empty() && self.dim == 1 {
                // A set that grows label by label is a box that grows.
                if let Some(b) = LabelBox::around(key, 1) {
                    self.shape = Shape::Dense(b, vec![record + 1]);
                }
                return;
            }
            let d = self.dim;
            t.insert_unique(hash_key(key), record, |&r| {
                hash_key(&keys[r as usize * d..][..d])
            });
        }
    }

    /// Forgets the record with this key.
    pub fn remove(&mut self, key: &[Label], keys: &[Label]) {
        let d = self.dim;
        match &mut self.shape {
            Shape::Dense(b, place) => {
                if let Some(at) = b.place(key) {
                    place[at] = 0;
                }
            }
            Shape::Hash(t) => {
                let same = |&r: &u32| keys[r as usize * d..][..d] == *key;
                if let Ok(e) = t.find_entry(hash_key(key), same) {
                    e.remove();
                }
            }
        }
    }
}
