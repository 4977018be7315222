//! The universe of labels, in the order of their first appearance.
//!
//! Label order is the order of everything a user sees: `ord`, lags, `display`, loops.
//! Labels are compared without regard to case; the first spelling is kept.

use rustc_hash::FxHasher;
use std::hash::Hasher;

/// Number of a label: its place in the universe.
pub type Label = u32;

/// All labels of a run.
#[derive(Clone, Default, Debug)]
pub struct Universe {
    text: String,
    ends: Vec<u32>,
    /// Hash table with open addressing, a power of two of places: a new label costs one access to memory, since
    /// its hash tells it from the others without a look at their texts.
    places: Vec<Place>,
}

/// A place of the hash table.
#[derive(Clone, Copy, Default, Debug)]
struct Place {
    hash: u32,
    /// Label + 1; 0 where there is none.
    label: u32,
}

/// Labels that [`Universe::warm`] looks up at once.
pub const AT_ONCE: usize = 64;

#[inline]
fn hash(label: &str) -> u32 {
    let bytes = label.as_bytes();
    let mut h = FxHasher::default();
    let mut rest = bytes;
    while let Some((word, behind)) = rest.split_first_chunk::<8>() {
        h.write_u64(fold(u64::from_le_bytes(*word)));
        rest = behind;
    }
    // The last eight bytes once more, or the first four and the last, are cheaper than what is left.
    let four = |word: &[u8; 4]| u64::from(u32::from_le_bytes(*word));
    let last = match (bytes.last_chunk(), bytes.first_chunk(), bytes.last_chunk()) {
        (Some(word), ..) => u64::from_le_bytes(*word),
        (_, Some(first), Some(last)) => four(first) << 32 | four(last),
        _ => bytes.iter().fold(0, |word, &b| word << 8 | u64::from(b)),
    };
    h.write_u64(fold(last) ^ (bytes.len() as u64) << 56);
    let h = h.finish();
    (h ^ h >> 32) as u32
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
    #[inline]
    pub fn name(&self, label: Label) -> &str {
        let i = label as usize;
        let lo = if i == 0 { 0 } else { self.ends[i - 1] as usize };
        &self.text[lo..self.ends[i] as usize]
    }

    /// The label with this spelling, if there is one.
    pub fn get(&self, label: &str) -> Option<Label> {
        let label = label.trim_end();
        self.seek(label, hash(label)).ok()
    }

    /// The label with this spelling; a new one goes to the end.
    pub fn intern(&mut self, label: &str) -> Label {
        let label = label.trim_end();
        let hash = hash(label);
        if full(self.len(), self.places.len()) {
            self.reserve(1);
        }
        match self.seek(label, hash) {
            Ok(known) => known,
            Err(place) => {
                let new = self.ends.len() as Label;
                self.places[place] = Place {
                    hash,
                    label: new + 1,
                };
                self.text.push_str(label);
                self.ends.push(self.text.len() as u32);
                new
            }
        }
    }

    /// The label with this spelling and hash, or the place where it would stand.
    #[inline]
    fn seek(&self, label: &str, hash: u32) -> Result<Label, usize> {
        let mut at = self.first_place(hash);
        loop {
            let Some(place) = self.places.get(at) else {
                // Behind the last place comes the first; without places nothing is known.
                if at == 0 {
                    return Err(0);
                }
                at = 0;
                continue;
            };
            if place.label == 0 {
                return Err(at);
            }
            let known = place.label - 1;
            if place.hash == hash && self.name(known).eq_ignore_ascii_case(label) {
                return Ok(known);
            }
            at += 1;
        }
    }

    /// Where a label of this hash is looked for first.
    #[inline]
    fn first_place(&self, hash: u32) -> usize {
        // The upper bits of a product with an odd number depend on all bits of the hash.
        let spread = u64::from(hash).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        spread as usize & self.places.len().wrapping_sub(1)
    }

    /// Takes room for so many labels more at once.
    pub fn reserve(&mut self, labels: usize) {
        let room = self.len() + labels;
        self.ends.reserve(labels);
        if labels == 0 || !full(room - 1, self.places.len()) {
            return;
        }
        let size = (room + room / 4 + 2).next_power_of_two();
        let old = std::mem::replace(&mut self.places, vec![Place::default(); size]);
        for place in old.into_iter().filter(|p| p.label > 0) {
            let mut at = self.first_place(place.hash);
            while self.places[at].label > 0 {
                at = (at + 1) % size;
            }
            self.places[at] = place;
        }
    }

    /// Brings the places of labels into the cache, many at once, before they are asked for one by one: with a
    /// million labels each place is an access to memory, and one after the other these take most of the time.
    pub fn warm<'t>(&self, mut labels: impl Iterator<Item = &'t str>) {
        if self.places.is_empty() {
            return;
        }
        loop {
            let mut hashes = [0; AT_ONCE];
            let mut count = 0;
            for (h, label) in hashes.iter_mut().zip(&mut labels) {
                *h = hash(label);
                count += 1;
            }
            let seen = hashes[..count]
                .iter()
                .fold(0, |seen, &h| seen ^ self.places[self.first_place(h)].hash);
            std::hint::black_box(seen);
            if count < AT_ONCE {
                return;
            }
        }
    }
}

/// Whether a hash table with so many places has no room for another label.
fn full(labels: usize, places: usize) -> bool {
    (labels + 1) * 5 > places * 4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_labels_are_found_again() {
        let names: Vec<String> = (0..5000u32)
            .map(|n| format!("{}{n}", "ab".repeat(n as usize % 6)))
            .collect();
        for room in [0, 1, 100, 5000] {
            let mut u = Universe::default();
            u.reserve(room);
            for (n, name) in names.iter().enumerate() {
                assert_eq!(u.get(name), None);
                assert_eq!(u.intern(name), n as Label);
            }
            u.warm(names.iter().map(String::as_str));
            for (n, name) in names.iter().enumerate() {
                assert_eq!(u.get(&name.to_uppercase()), Some(n as Label));
                assert_eq!(u.name(n as Label), name);
            }
        }
    }
}
