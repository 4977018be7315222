//! Keys in data that stand for many: ranges, and products of sets.

use crate::data::table::Table;
use crate::data::universe::Label;

/// A range or a product of sets in data may not make more records than this.
pub const MAX_EXPANSION: usize = 50_000_000;

/// Tuples of labels, one behind the other.
#[derive(Default)]
pub struct Tuples {
    /// Labels a tuple.
    pub width: usize,
    /// All of them.
    pub labels: Vec<Label>,
}

impl Tuples {
    /// One label a tuple.
    pub fn single(labels: Vec<Label>) -> Self {
        Self { width: 1, labels }
    }

    /// The keys of a table.
    pub fn of(table: &Table) -> Self {
        Self {
            width: table.dim(),
            labels: table.iter().flat_map(|(k, _)| k.iter().copied()).collect(),
        }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.labels.len() / self.width.max(1)
    }

    fn rows(&self) -> std::slice::ChunksExact<'_, Label> {
        self.labels.chunks_exact(self.width.max(1))
    }

    /// Every tuple with every one of the other.
    pub fn times(&self, other: &Self) -> Self {
        let width = self.width + other.width;
        let mut labels = Vec::with_capacity(self.len() * other.len() * width);
        for a in self.rows() {
            for b in other.rows() {
                labels.extend_from_slice(a);
                labels.extend_from_slice(b);
            }
        }
        Self { width, labels }
    }

    /// The first with the first, the second with the second, until one side ends.
    pub fn beside(&self, other: &Self) -> Self {
        let width = self.width + other.width;
        let mut labels = Vec::with_capacity(self.len().min(other.len()) * width);
        for (a, b) in self.rows().zip(other.rows()) {
            labels.extend_from_slice(a);
            labels.extend_from_slice(b);
        }
        Self { width, labels }
    }
}

/// Why two labels span no range.
#[derive(Debug, PartialEq)]
pub enum NoRange {
    /// They do not differ in one number.
    Unlike,
    /// So many labels.
    TooLong(u64),
}

/// `i1*i10`: labels that differ in one number, up or down; leading zeros are kept.
pub fn range(from: &str, to: &str) -> Result<Vec<String>, NoRange> {
    let (a, b) = (from.as_bytes(), to.as_bytes());
    if from.eq_ignore_ascii_case(to) {
        return Ok(vec![from.to_string()]);
    }
    let mut prefix = a
        .iter()
        .zip(b)
        .take_while(|(x, y)| x.eq_ignore_ascii_case(y))
        .count();
    while prefix > 0 && a[prefix - 1].is_ascii_digit() {
        prefix -= 1;
    }
    let digits = |s: &[u8]| {
        s[prefix..]
            .iter()
            .take_while(|c| c.is_ascii_digit())
            .count()
    };
    if a.iter().chain(b).all(u8::is_ascii_alphabetic) {
        return letters(from, to).ok_or(NoRange::Unlike);
    }
    let (da, db) = (digits(a), digits(b));
    if da == 0 || db == 0 || !a[prefix + da..].eq_ignore_ascii_case(&b[prefix + db..]) {
        return Err(NoRange::Unlike);
    }
    let (na, nb) = (&from[prefix..prefix + da], &to[prefix..prefix + db]);
    let (Ok(lo), Ok(hi)) = (na.parse::<u64>(), nb.parse::<u64>()) else {
        return Err(NoRange::Unlike);
    };
    if lo.abs_diff(hi) >= MAX_EXPANSION as u64 {
        return Err(NoRange::TooLong(lo.abs_diff(hi).saturating_add(1)));
    }
    // A leading zero, or equal lengths, fixes the width.
    let width = if na.starts_with('0') || da == db {
        da
    } else {
        0
    };
    let (head, tail) = (&from[..prefix], &from[prefix + da..]);
    let label = |k: u64| format!("{head}{k:0width$}{tail}");
    Ok(if lo <= hi {
        (lo..=hi).map(label).collect()
    } else {
        (hi..=lo).rev().map(label).collect()
    })
}

/// `a*e`, `x*ab`: labels of letters count like the columns of a spreadsheet.
fn letters(from: &str, to: &str) -> Option<Vec<String>> {
    let value = |s: &str| {
        s.bytes().try_fold(0u64, |v, c| {
            v.checked_mul(26)?
                .checked_add(u64::from(c.to_ascii_lowercase() - b'a') + 1)
        })
    };
    let (lo, hi) = (value(from)?, value(to)?);
    if lo > hi || hi - lo > 1_000_000 {
        return None;
    }
    let first = if from.as_bytes()[0].is_ascii_uppercase() {
        b'A'
    } else {
        b'a'
    };
    let spell = |mut k: u64| {
        let mut s = Vec::new();
        while k > 0 {
            s.push(first + ((k - 1) % 26) as u8);
            k = (k - 1) / 26;
        }
        s.reverse();
        s.into_iter().map(char::from).collect()
    };
    Some((lo..=hi).map(spell).collect())
}

#[cfg(test)]
mod tests {
    use super::{NoRange, range};

    #[test]
    fn ranges_keep_prefix_suffix_and_zeros() {
        assert_eq!(range("a9", "a11").unwrap(), ["a9", "a10", "a11"]);
        assert_eq!(range("c09", "c11").unwrap(), ["c09", "c10", "c11"]);
        assert_eq!(range("s02s", "s04s").unwrap(), ["s02s", "s03s", "s04s"]);
        assert_eq!(range("1990", "1992").unwrap(), ["1990", "1991", "1992"]);
        assert_eq!(range("a1", "b3"), Err(NoRange::Unlike));
        assert_eq!(range("a3", "a1").unwrap(), ["a3", "a2", "a1"]);
        assert_eq!(range("b", "d").unwrap(), ["b", "c", "d"]);
        assert_eq!(range("y", "ab").unwrap(), ["y", "z", "aa", "ab"]);
        assert_eq!(range("d", "a"), Err(NoRange::Unlike));
    }
}
