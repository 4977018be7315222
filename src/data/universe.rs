//! The universe of labels, in the order of their first appearance.
//!
//! Label order is the order of everything a user sees: `ord`, lags, `display`, loops.
//! Labels are compared without regard to case; the first spelling is kept.

use hashbrown::HashTable;
use hashbrown::hash_table::Entry;
use std::hash::Hasher;

/// Number of a label: its place in the universe.
pub type Label = u32;

/// All labels of a run.
#[derive(Clone, Default, Debug)]
pub struct Universe {
    text: String,
    ends: Vec<u32>,
    /// By label: growing the index and passing over others does not read the texts again.
    hashes: Vec<u32>,
    index: HashTable<Label>,
}

fn hash(label: &str) -> u32 {
    let mut h = rustc_hash::FxHasher::default();
    let bytes = label.as_bytes();
    let mut chunks = bytes.chunks_exact(8);
    for c in &mut chunks {
        let word = u64::from_le_bytes(c.try_into().expect("chunks of eight"));
        h.write_u64(fold(word));
    }
    let mut last = [0u8; 8];
    last[..chunks.remainder().len()].copy_from_slice(chunks.remainder());
    h.write_u64(fold(u64::from_le_bytes(last)) ^ (bytes.len() as u64) << 56);
    let h = h.finish();
    (h ^ h >> 32) as u32
}

/// A hash as the index wants it, with all bits in use.
fn spread(hash: u32) -> u64 {
    u64::from(hash).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// Sets bit 5 of every byte: equal for letters that differ in case only.
fn fold(word: u64) -> u64 {
    word | 0x2020_2020_2020_2020
}

impl Universe {
    /// Number of labels.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// First spelling of a label.
    pub fn name(&self, label: Label) -> &str {
        spelling(&self.text, &self.ends, label)
    }

    /// The label with this spelling, if there is one.
    pub fn get(&self, label: &str) -> Option<Label> {
        let label = label.trim_end();
        let hash = hash(label);
        let is =
            |l: Label| self.hashes[l as usize] == hash && self.name(l).eq_ignore_ascii_case(label);
        self.index.find(spread(hash), |&l| is(l)).copied()
    }

    /// The label with this spelling; a new one goes to the end.
    pub fn intern(&mut self, label: &str) -> Label {
        let label = label.trim_end();
        let hash = hash(label);
        let Self {
            text,
            ends,
            hashes,
            index,
        } = self;
        let is = |&l: &Label| {
            hashes[l as usize] == hash && spelling(text, ends, l).eq_ignore_ascii_case(label)
        };
        match index.entry(spread(hash), is, |&l| spread(hashes[l as usize])) {
            Entry::Occupied(e) => *e.get(),
            Entry::Vacant(e) => {
                let new = ends.len() as Label;
                e.insert(new);
                text.push_str(label);
                ends.push(text.len() as u32);
                hashes.push(hash);
                new
            }
        }
    }

    /// Takes room for so many labels more at once.
    pub fn reserve(&mut self, labels: usize) {
        let hashes = &self.hashes;
        self.index.reserve(labels, |&l| spread(hashes[l as usize]));
        self.ends.reserve(labels);
        self.hashes.reserve(labels);
    }
}

/// First spelling of a label.
fn spelling<'t>(text: &'t str, ends: &[u32], label: Label) -> &'t str {
    let i = label as usize;
    let lo = if i == 0 { 0 } else { ends[i - 1] as usize };
    &text[lo..ends[i] as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_first_spelling_and_order() {
        let mut u = Universe::default();
        let a = u.intern("Seattle");
        let b = u.intern("san-diego-and-more");
        assert_eq!(u.intern("SEATTLE"), a);
        assert_eq!(u.intern("San-Diego-And-More"), b);
        assert_eq!((a, b), (0, 1));
        assert_eq!(u.name(a), "Seattle");
        assert_eq!(u.get("nowhere"), None);
        assert_ne!(u.intern("a@"), u.intern("a`"));
    }
}
