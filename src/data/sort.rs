//! Sorting of keys: tuples of labels, compared position by position.
//!
//! A tuple whose labels need few bits (each counted from the least label of its position) becomes one
//! integer, and integers are sorted; longer ones are compared as they are.

use super::universe::Label;

/// How tuples become integers: the least label and the bits at each position that is compared.
struct Packing {
    fields: Vec<(usize, Label, u32)>,
}

impl Packing {
    /// None when the bits do not fit.
    fn of(keys: &[Label], dim: usize, positions: &[usize], room: u32) -> Option<Self> {
        let mut total = 0;
        let mut fields = Vec::with_capacity(positions.len());
        for &p in positions {
            let labels = || keys.iter().skip(p).step_by(dim).copied();
            let (low, high) = (labels().min()?, labels().max()?);
            let bits = Label::BITS - (high - low).leading_zeros();
            total += bits;
            fields.push((p, low, bits));
        }
        (total <= room).then_some(Self { fields })
    }

    #[inline]
    fn pack(&self, key: &[Label]) -> u64 {
        self.fields
            .iter()
            .fold(0, |n, &(p, low, bits)| n << bits | u64::from(key[p] - low))
    }

    #[inline]
    fn unpack(&self, mut n: u64, key: &mut [Label]) {
        for &(p, low, bits) in self.fields.iter().rev() {
            key[p] = low + (n & ((1 << bits) - 1)) as Label;
            n >>= bits;
        }
    }
}

/// Sorts records (given in increasing order) by their labels at `positions`; equal ones stay in order.
/// The key of record r is `keys[r·dim..(r+1)·dim]`.
pub fn sort_records(records: &mut [u32], keys: &[Label], dim: usize, positions: &[usize]) {
    let key = |r: u32| &keys[r as usize * dim..][..dim];
    let before = |a: u32, b: u32| {
        let (a, b) = (key(a), key(b));
        positions
            .iter()
            .map(|&p| a[p])
            .cmp(positions.iter().map(|&p| b[p]))
    };
    if records.is_sorted_by(|&a, &b| before(a, b).is_le()) {
        return;
    }
    match Packing::of(keys, dim, positions, u64::BITS) {
        Some(packing) => {
            let mut packed: Vec<(u64, u32)> =
                records.iter().map(|&r| (packing.pack(key(r)), r)).collect();
            packed.sort_unstable();
            for (r, (_, p)) in records.iter_mut().zip(packed) {
                *r = p;
            }
        }
        None => records.sort_by(|&a, &b| before(a, b)),
    }
}

/// Sorts tuples of `dim` labels, which stand one after the other; equal ones become one if `unique`.
pub fn sort_tuples(mut flat: Vec<Label>, dim: usize, unique: bool) -> Vec<Label> {
    if dim == 0 {
        return flat;
    }
    let in_order = flat
        .chunks_exact(dim)
        .is_sorted_by(|a, b| if unique { a < b } else { a <= b });
    if in_order {
        return flat;
    }
    let positions: Vec<usize> = (0..dim).collect();
    match Packing::of(&flat, dim, &positions, u64::BITS) {
        Some(packing) => {
            let mut packed: Vec<u64> = flat.chunks_exact(dim).map(|k| packing.pack(k)).collect();
            packed.sort_unstable();
            if unique {
                packed.dedup();
            }
            flat.truncate(packed.len() * dim);
            for (k, n) in flat.chunks_exact_mut(dim).zip(packed) {
                packing.unpack(n, k);
            }
            flat
        }
        None => {
            let mut v: Vec<&[Label]> = flat.chunks_exact(dim).collect();
            v.sort_unstable();
            if unique {
                v.dedup();
            }
            v.concat()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Packed or not, tuples come in the order of comparison.
        #[test]
        fn tuples_are_sorted(tuples in prop::collection::vec((0u32..40, 7u32..9, any::<u32>()), 0..60), wide in any::<bool>()) {
            let mask = if wide { u32::MAX } else { 15 };
            let tuples: Vec<[u32; 4]> = tuples.into_iter().map(|(a, b, c)| [a, c & mask, b, c & mask]).collect();
            let mut sorted = tuples.clone();
            sorted.sort();
            prop_assert_eq!(sort_tuples(tuples.concat(), 4, false), sorted.concat());
            sorted.dedup();
            prop_assert_eq!(sort_tuples(tuples.concat(), 4, true), sorted.concat());

            let mut records: Vec<u32> = (0..tuples.len() as u32).collect();
            sort_records(&mut records, &tuples.concat(), 4, &[3, 0]);
            let mut expected: Vec<u32> = (0..tuples.len() as u32).collect();
            expected.sort_by_key(|&r| (tuples[r as usize][3], tuples[r as usize][0]));
            prop_assert_eq!(records, expected);
        }
    }
}
