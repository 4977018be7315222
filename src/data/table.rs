//! Sparse tables: records of labels with a value.
//!
//! A set, a parameter and each attribute of a variable or equation is a [`Table`]. What is not
//! stored has the table's default value (0 for parameters, +∞ for upper bounds …).
//!
//! Invariants: memory is proportional to the records; a *tidy* table is sorted by label order and
//! has no removed records; iteration is over tidy tables only, so what a user sees is always in
//! label order. An index by key and *orders* (records grouped by some positions) are built when first
//! needed and dropped when records move.

use super::key_index::{KeyIndex, before, same};
use super::sort::sort_records;
use super::universe::Label;
use super::value::is_eps;
use hashbrown::HashTable;
use std::cell::{Cell, OnceCell, RefCell};
use std::hash::Hasher;
use std::sync::Arc;

/// Records of `dim` labels with a value each.
#[derive(Clone, Debug, Default)]
pub struct Table {
    dim: usize,
    default: f64,
    keys: Vec<Label>,
    values: Vec<f64>,
    /// Records `..sorted` are strictly increasing.
    sorted: usize,
    /// Removed records that still take a place (their value is the default).
    dead: usize,
    index: OnceCell<KeyIndex>,
    orders: RefCell<Vec<(u32, Arc<Order>)>>,
    distinct: OnceCell<Vec<u32>>,
    special: Special,
    /// The record that a scan has come to: it is mostly the one that is asked for.
    visited: Cell<u32>,
}

/// What kind of special values there may be; each includes those before it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
enum Special {
    #[default]
    None,
    /// Infinite, `eps`.
    Extreme,
    /// `na`, `undf`, acronyms.
    Undefined,
}

impl Special {
    #[inline]
    fn of(value: f64) -> Self {
        if value.is_finite() {
            Self::None
        } else if value.is_infinite() || is_eps(value) {
            Self::Extreme
        } else {
            Self::Undefined
        }
    }

    fn among(values: &[f64]) -> Self {
        let kinds = values.iter().map(|&v| Self::of(v));
        kinds.max().unwrap_or(Self::None)
    }
}

/// Records grouped by their labels at some positions.
#[derive(Debug)]
pub struct Order {
    /// Records in group order; None where that is the stored order.
    rows: Option<Vec<u32>>,
    groups: Groups,
    positions: Vec<usize>,
}

#[derive(Debug)]
enum Groups {
    /// By label: `start[l]..start[l+1]`.
    Dense(Vec<u32>),
    Hash(HashTable<(u32, u32)>),
}

/// Rows of one group.
#[derive(Clone, Copy, Debug)]
pub enum Rows<'a> {
    /// Records `lo..hi` as stored.
    Range(u32, u32),
    /// These records.
    List(&'a [u32]),
}

impl Rows<'_> {
    /// Number of records.
    pub fn len(&self) -> usize {
        match self {
            Rows::Range(lo, hi) => (hi - lo) as usize,
            Rows::List(l) => l.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The k-th record.
    #[inline]
    pub fn get(&self, k: usize) -> u32 {
        match self {
            Rows::Range(lo, _) => lo + k as u32,
            Rows::List(l) => l[k],
        }
    }
}

fn hash_at(key: &[Label], positions: &[usize]) -> u64 {
    let mut h = rustc_hash::FxHasher::default();
    for &p in positions {
        h.write_u32(key[p]);
    }
    h.finish()
}

impl Table {
    /// An empty table.
    pub fn new(dim: usize, default: f64) -> Self {
        Self {
            dim,
            default,
            ..Self::default()
        }
    }

    /// A table from records; of equal keys the last one counts, and values equal to the default are skipped.
    pub fn from_records(dim: usize, default: f64, keys: Vec<Label>, values: Vec<f64>) -> Self {
        let mut t = Self::new(dim, default);
        let in_order = dim == 0 || keys.chunks_exact(dim).is_sorted_by(|a, b| before(a, b));
        t.special = Special::among(&values);
        t.sorted = if in_order { values.len() } else { 0 };
        t.dead = values.iter().filter(|&&v| v == default).count();
        t.keys = keys;
        t.values = values;
        t.tidy();
        t
    }

    /// Keys, one after the other, and values of all records in label order.
    pub fn into_records(mut self) -> (Vec<Label>, Vec<f64>) {
        self.tidy();
        (self.keys, self.values)
    }

    /// Number of index positions.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Value of what is not stored.
    pub fn default_value(&self) -> f64 {
        self.default
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.values.len() - self.dead
    }

    /// Whether nothing is stored.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether some value may be infinite, `na`, `eps` or `undf`: a zero does not annihilate those.
    pub fn has_special(&self) -> bool {
        self.special != Special::None
    }

    /// Whether some value, stored or not, may be `na`, `undf` or an acronym: logic with those is not two-valued.
    pub fn has_undefined(&self) -> bool {
        self.special.max(Special::of(self.default)) == Special::Undefined
    }

    /// Labels of a stored record.
    #[inline]
    pub fn key(&self, row: u32) -> &[Label] {
        let at = row as usize * self.dim;
        &self.keys[at..at + self.dim]
    }

    /// Labels of a stored record that a scan comes to.
    #[inline]
    pub fn visit(&self, row: u32) -> &[Label] {
        self.visited.set(row);
        self.key(row)
    }

    /// Labels of all stored records, one after the other; among them may be removed ones.
    pub fn all_keys(&self) -> &[Label] {
        &self.keys
    }

    /// Value of a stored record.
    #[inline]
    pub fn value(&self, row: u32) -> f64 {
        self.values[row as usize]
    }

    /// Whether all records are sorted and none is dead.
    pub fn is_tidy(&self) -> bool {
        self.dead == 0 && self.sorted == self.values.len()
    }

    /// All records in label order. The table must be tidy.
    pub fn iter(&self) -> impl Iterator<Item = (&[Label], f64)> + '_ {
        debug_assert!(self.is_tidy());
        (0..self.values.len())
            .map(|r| (&self.keys[r * self.dim..(r + 1) * self.dim], self.values[r]))
    }

    /// Keys of all records, in no order; the table need not be tidy.
    pub fn keys(&self) -> impl Iterator<Item = &[Label]> + '_ {
        let alive = |&r: &usize| self.values[r] != self.default;
        (0..self.values.len())
            .filter(alive)
            .map(|r| &self.keys[r * self.dim..(r + 1) * self.dim])
    }

    /// The record with this key.
    #[inline]
    pub fn find(&self, key: &[Label]) -> Option<u32> {
        debug_assert_eq!(key.len(), self.dim);
        match self.dim {
            0 => (!self.values.is_empty() && self.values[0] != self.default).then_some(0),
            1 if self.is_run() => {
                let record = key[0].wrapping_sub(self.keys[0]);
                ((record as usize) < self.values.len()).then_some(record)
            }
            _ => {
                let r = self.visited.get();
                if self.value_of(r).is_some_and(|v| v != self.default) && same(self.key(r), key) {
                    return Some(r);
                }
                self.index
                    .get_or_init(|| self.build_index())
                    .find(key, &self.keys)
            }
        }
    }

    /// Whether the keys are labels that follow each other, as those of most sets: then no index is needed.
    #[inline]
    fn is_run(&self) -> bool {
        let n = self.values.len();
        n > 0 && self.is_tidy() && (self.keys[n - 1] - self.keys[0]) as usize == n - 1
    }

    #[inline]
    fn value_of(&self, row: u32) -> Option<f64> {
        self.values.get(row as usize).copied()
    }

    /// The value for this key, the default where nothing is stored.
    #[inline]
    pub fn get(&self, key: &[Label]) -> f64 {
        match self.find(key) {
            Some(r) => self.values[r as usize],
            None => self.default,
        }
    }

    fn build_index(&self) -> KeyIndex {
        KeyIndex::build(&self.keys, self.dim, |r| {
            self.values[r as usize] != self.default || self.values[r as usize].is_nan()
        })
    }

    /// Takes room for so many records more at once; pages that none comes to stay untouched.
    pub fn reserve(&mut self, records: usize) {
        self.keys.reserve(records * self.dim);
        self.values.reserve(records);
    }

    #[inline]
    fn moved(&mut self) {
        let orders = self.orders.get_mut();
        if !orders.is_empty() {
            orders.clear();
        }
        self.distinct.take();
    }

    /// Stores a value; the default removes the record.
    #[inline]
    pub fn set(&mut self, key: &[Label], value: f64) {
        debug_assert_eq!(key.len(), self.dim);
        // Appending in order needs no index.
        if self.is_after_last(key) {
            self.special = self.special.max(Special::of(value));
            if value != self.default {
                self.push(key, value);
                self.sorted += 1;
            }
        } else {
            self.set_among(key, value);
        }
    }

    /// Stores records one after the other: at once where they are in order and new.
    pub fn set_all(&mut self, keys: &[Label], values: &[f64]) {
        let plain = |v: &f64| v.is_finite() && *v != self.default;
        if values.iter().all(plain) && self.append_all(keys, values.iter().copied()) {
            return;
        }
        for (key, &value) in keys.chunks_exact(self.dim).zip(values) {
            self.set(key, value);
        }
    }

    /// Appends records whose values are finite and not the default, if they come after all others, in order.
    pub fn append_all(&mut self, keys: &[Label], values: impl Iterator<Item = f64>) -> bool {
        let each = || keys.chunks_exact(self.dim);
        let behind = each().next().is_some_and(|k| self.is_after_last(k))
            && each().is_sorted_by(|a, b| before(a, b));
        if behind {
            self.keys.extend_from_slice(keys);
            self.values.extend(values);
            self.sorted = self.values.len();
            self.index.take();
            self.moved();
        }
        behind
    }

    /// The same among the records that are there.
    fn set_among(&mut self, key: &[Label], value: f64) {
        self.special = self.special.max(Special::of(value));
        if self.dim == 0 {
            self.values.clear();
            if value != self.default {
                self.values.push(value);
            }
            self.sorted = self.values.len();
            return;
        }
        match self.find(key) {
            Some(r) if value == self.default => {
                self.values[r as usize] = self.default;
                self.dead += 1;
                self.moved();
                if let Some(index) = self.index.get_mut() {
                    index.remove(key, &self.keys);
                }
            }
            Some(r) => self.values[r as usize] = value,
            None if value != self.default => self.push(key, value),
            None => {}
        }
    }

    #[inline]
    fn push(&mut self, key: &[Label], value: f64) {
        let r = self.values.len() as u32;
        // Without a call for the usual lengths.
        match *key {
            [a] => self.keys.push(a),
            [a, b] => self.keys.extend([a, b]),
            [a, b, c] => self.keys.extend([a, b, c]),
            _ => self.keys.extend_from_slice(key),
        }
        self.values.push(value);
        self.moved();
        if let Some(index) = self.index.get_mut() {
            index.insert(key, r, &self.keys);
        }
    }

    /// Changes the value of what is not stored (a variable that changes its kind).
    pub fn set_default(&mut self, default: f64) {
        self.default = default;
        self.dead = self.values.iter().filter(|&&v| v == default).count();
        self.index.take();
        self.tidy();
    }

    /// Whether a key comes after all stored ones (and so is new).
    #[inline]
    pub fn is_after_last(&self, key: &[Label]) -> bool {
        let n = self.values.len();
        self.dim > 0 && self.sorted == n && (n == 0 || before(self.key(n as u32 - 1), key))
    }

    /// Removes everything.
    pub fn clear(&mut self) {
        *self = Self::new(self.dim, self.default);
    }

    /// Sorts by label order and forgets removed records. Of equal keys the last one stays.
    pub fn tidy(&mut self) {
        if self.is_tidy() {
            return;
        }
        let (d, n) = (self.dim, self.values.len());
        let alive = |v: f64, default: f64| v != default;
        if self.sorted == n {
            // Only removals: compact in place.
            let mut to = 0;
            for r in 0..n {
                if alive(self.values[r], self.default) {
                    self.values[to] = self.values[r];
                    self.keys.copy_within(r * d..(r + 1) * d, to * d);
                    to += 1;
                }
            }
            self.values.truncate(to);
            self.keys.truncate(to * d);
        } else {
            let mut tail: Vec<u32> = (self.sorted as u32..n as u32).collect();
            sort_records(&mut tail, &self.keys, d, &(0..d).collect::<Vec<_>>());
            let mut keys = Vec::with_capacity(self.keys.len());
            let mut values: Vec<f64> = Vec::with_capacity(n);
            let mut put = |t: &Self, r: u32| {
                if values.last().is_some() && keys[keys.len() - d..] == *t.key(r) {
                    values.pop();
                    keys.truncate(keys.len() - d);
                }
                if alive(t.value(r), t.default) {
                    keys.extend_from_slice(t.key(r));
                    values.push(t.value(r));
                }
            };
            let mut head = 0u32;
            for &r in &tail {
                while (head as usize) < self.sorted && self.key(head) <= self.key(r) {
                    put(self, head);
                    head += 1;
                }
                put(self, r);
            }
            while (head as usize) < self.sorted {
                put(self, head);
                head += 1;
            }
            self.keys = keys;
            self.values = values;
        }
        self.sorted = self.values.len();
        self.dead = 0;
        self.special = Special::among(&self.values);
        self.index.take();
        self.moved();
    }

    /// Stores many records at once, one after the other.
    pub fn merge(&mut self, keys: &[Label], values: &[f64]) {
        let d = self.dim;
        if d == 0 {
            if let Some(&v) = values.last() {
                self.set(&[], v);
            }
            return;
        }
        if self.is_empty() {
            *self = Self::from_records(d, self.default, keys.to_vec(), values.to_vec());
            return;
        }
        if values.len() < 8 || values.len() * 16 < self.values.len() {
            for (k, &v) in keys.chunks_exact(d).zip(values) {
                self.set(k, v);
            }
            return;
        }
        self.tidy();
        self.keys.extend_from_slice(keys);
        self.values.extend_from_slice(values);
        self.tidy();
    }

    /// Number of different labels at each position (tidy tables).
    pub fn distinct(&self) -> &[u32] {
        self.distinct.get_or_init(|| {
            (0..self.dim)
                .map(|p| {
                    let mut seen = rustc_hash::FxHashSet::default();
                    let mut last = None;
                    for r in 0..self.values.len() {
                        let l = self.keys[r * self.dim + p];
                        if last != Some(l) {
                            seen.insert(l);
                            last = Some(l);
                        }
                    }
                    seen.len() as u32
                })
                .collect()
        })
    }

    /// Records grouped by the positions in `mask` (bit p for position p; not empty, not all). Tidy tables.
    pub fn order(&self, mask: u32) -> Arc<Order> {
        debug_assert!(self.is_tidy());
        if let Some((_, o)) = self.orders.borrow().iter().find(|(m, _)| *m == mask) {
            return o.clone();
        }
        let order = Arc::new(self.build_order(mask));
        self.orders.borrow_mut().push((mask, order.clone()));
        order
    }

    fn build_order(&self, mask: u32) -> Order {
        let positions: Vec<usize> = (0..self.dim).filter(|p| mask >> p & 1 == 1).collect();
        let n = self.values.len();
        let prefix = positions.iter().enumerate().all(|(i, &p)| i == p);
        if positions.len() == 1 {
            let p = positions[0];
            let top = (0..n)
                .map(|r| self.keys[r * self.dim + p] as usize + 1)
                .max()
                .unwrap_or(0);
            if top <= 64 + 16 * n {
                let mut start = vec![0u32; top + 1];
                for r in 0..n {
                    start[self.keys[r * self.dim + p] as usize + 1] += 1;
                }
                for l in 0..top {
                    start[l + 1] += start[l];
                }
                let rows = (!prefix).then(|| {
                    let mut next = start.clone();
                    let mut rows = vec![0u32; n];
                    for r in 0..n {
                        let l = self.keys[r * self.dim + p] as usize;
                        rows[next[l] as usize] = r as u32;
                        next[l] += 1;
                    }
                    rows
                });
                return Order {
                    rows,
                    groups: Groups::Dense(start),
                    positions,
                };
            }
        }
        let rows: Option<Vec<u32>> = (!prefix).then(|| {
            let mut rows: Vec<u32> = (0..n as u32).collect();
            sort_records(&mut rows, &self.keys, self.dim, &positions);
            rows
        });
        let at = |k: usize| self.key(rows.as_ref().map_or(k as u32, |r| r[k]));
        let mut groups: HashTable<(u32, u32)> = HashTable::new();
        let mut lo = 0;
        while lo < n {
            let mut hi = lo + 1;
            while hi < n && positions.iter().all(|&p| at(hi)[p] == at(lo)[p]) {
                hi += 1;
            }
            groups.insert_unique(
                hash_at(at(lo), &positions),
                (lo as u32, hi as u32),
                |&(l, _)| hash_at(at(l as usize), &positions),
            );
            lo = hi;
        }
        Order {
            rows,
            groups: Groups::Hash(groups),
            positions,
        }
    }

    /// The group of an order whose labels at the order's positions are those of `key` (a full-length
    /// key of which only those positions are read).
    #[inline]
    pub fn group<'a>(&self, order: &'a Order, key: &[Label]) -> Rows<'a> {
        let (lo, hi) = match &order.groups {
            Groups::Dense(start) => {
                let l = key[order.positions[0]] as usize;
                if l + 1 < start.len() {
                    (start[l], start[l + 1])
                } else {
                    (0, 0)
                }
            }
            Groups::Hash(t) => {
                let same = |&(lo, _): &(u32, u32)| {
                    let row = order.rows.as_ref().map_or(lo, |r| r[lo as usize]);
                    let k = self.key(row);
                    order.positions.iter().all(|&p| k[p] == key[p])
                };
                t.find(hash_at(key, &order.positions), same)
                    .copied()
                    .unwrap_or((0, 0))
            }
        };
        match &order.rows {
            None => Rows::Range(lo, hi),
            Some(r) => Rows::List(&r[lo as usize..hi as usize]),
        }
    }

    /// All records.
    pub fn all(&self) -> Rows<'static> {
        Rows::Range(0, self.values.len() as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    proptest! {
        /// Any sequence of writes leaves what a sorted map would hold, in order, and every lookup agrees.
        #[test]
        fn a_table_is_a_sorted_map(writes in prop::collection::vec(((0u32..6, 0u32..6), 0u8..4, any::<bool>()), 0..200)) {
            let mut t = Table::new(2, 0.0);
            let mut m = BTreeMap::new();
            for ((a, b), v, tidy) in writes {
                t.set(&[a, b], f64::from(v));
                if v == 0 { m.remove(&(a, b)); } else { m.insert((a, b), f64::from(v)); }
                prop_assert_eq!(t.get(&[a, b]), f64::from(v));
                if tidy { t.tidy(); }
                prop_assert_eq!(t.len(), m.len());
            }
            t.tidy();
            let got: Vec<_> = t.iter().map(|(k, v)| ((k[0], k[1]), v)).collect();
            let want: Vec<_> = m.clone().into_iter().collect();
            prop_assert_eq!(&got, &want);
            let by_column = t.order(2);
            for b in 0..6 {
                let rows = t.group(&by_column, &[0, b]);
                let got: Vec<u32> = (0..rows.len()).map(|k| t.key(rows.get(k))[0]).collect();
                let want: Vec<u32> = m.keys().filter(|k| k.1 == b).map(|k| k.0).collect();
                prop_assert_eq!(got, want);
            }
        }

        /// So is a table of labels, with gaps between them or without.
        #[test]
        fn a_table_of_labels_is_a_sorted_map(writes in prop::collection::vec((2u32..8, 0u8..3, any::<bool>()), 0..30)) {
            let mut t = Table::new(1, 0.0);
            let mut m = BTreeMap::new();
            for (a, v, tidy) in writes {
                t.set(&[a], f64::from(v));
                m.insert(a, f64::from(v));
                if tidy { t.tidy(); }
                for l in 0..10 {
                    prop_assert_eq!(t.get(&[l]), m.get(&l).copied().unwrap_or(0.0));
                }
            }
        }

        /// Storing records at once is the same as storing them one by one.
        #[test]
        fn all_at_once_is_one_by_one(rows in prop::collection::vec((0u32..9, prop::collection::vec((0u32..6, 0u8..9), 0..5), any::<bool>()), 0..20)) {
            let mut a = Table::new(2, 0.0);
            let mut b = a.clone();
            for (row, cells, look) in rows {
                let keys: Vec<u32> = cells.iter().flat_map(|c| [row, c.0]).collect();
                let values: Vec<f64> = cells.iter().map(|c| if c.1 == 8 { f64::INFINITY } else { f64::from(c.1) }).collect();
                a.set_all(&keys, &values);
                for (k, &v) in keys.chunks_exact(2).zip(&values) { b.set(k, v); }
                if look { prop_assert_eq!(a.get(&[row, 3]), b.get(&[row, 3])); }
            }
            prop_assert_eq!((a.len(), a.has_special()), (b.len(), b.has_special()));
            a.tidy();
            b.tidy();
            prop_assert!(a.iter().eq(b.iter()));
        }

        /// Merging sorted records is the same as storing them one by one.
        #[test]
        fn merging_is_storing(old in prop::collection::btree_map((0u32..30, 0u32..30), 1u8..4, 0..60),
                              new in prop::collection::btree_map((0u32..30, 0u32..30), 0u8..4, 0..60)) {
            let mut a = Table::new(2, 0.0);
            for (k, v) in &old { a.set(&[k.0, k.1], f64::from(*v)); }
            let mut b = a.clone();
            let keys: Vec<u32> = new.keys().flat_map(|k| [k.0, k.1]).collect();
            let values: Vec<f64> = new.values().map(|&v| f64::from(v)).collect();
            a.merge(&keys, &values);
            for (k, v) in &new { b.set(&[k.0, k.1], f64::from(*v)); }
            a.tidy();
            b.tidy();
            prop_assert!(a.iter().eq(b.iter()));
        }
    }
}
