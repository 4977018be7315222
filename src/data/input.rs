//! Data given from outside the text: by a program that uses the library, or by the command line.

use rustc_hash::FxHashMap;

/// Data for one symbol. They stand in place of what data statements of the text say about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// The symbol, in any case.
    pub name: String,
    /// Its data.
    pub data: InputData,
}

/// What a symbol gets.
#[derive(Clone, Debug, PartialEq)]
pub enum InputData {
    /// Members of a set, and their explanatory texts (none: all empty).
    Members(Keys, Vec<String>),
    /// Records of a parameter.
    Values(Keys, Vec<f64>),
}

impl InputData {
    /// Labels of the records.
    pub fn keys(&self) -> &Keys {
        match self {
            Self::Members(keys, _) | Self::Values(keys, _) => keys,
        }
    }
}

/// The labels of many records by index position: each label once, and which of them each record has.
///
/// ```
/// let keys = bmod::Keys::new(vec![vec!["a".into(), "b".into()], vec!["x".into()]], vec![vec![0, 1], vec![0, 0]]);
/// let keys = keys.expect("as many codes at each position");
/// assert_eq!((keys.len(), keys.dimension()), (2, 2));
/// assert_eq!(keys.key(1), ["b", "x"]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Keys {
    labels: Vec<Vec<String>>,
    codes: Vec<Vec<u32>>,
    count: usize,
    /// The first record that has another number of labels than the records before, and its number.
    odd: Option<(usize, Vec<String>)>,
}

impl Keys {
    /// By position: the labels, and for each record the place of its label among them. `None` if the positions have different numbers
    /// of records, or a code is no place.
    pub fn new(labels: Vec<Vec<String>>, codes: Vec<Vec<u32>>) -> Option<Self> {
        let count = codes.first().map_or(0, Vec::len);
        let fits = |(l, c): (&Vec<String>, &Vec<u32>)| {
            c.len() == count && c.iter().all(|&c| (c as usize) < l.len())
        };
        let all = labels.len() == codes.len() && labels.iter().zip(&codes).all(fits);
        all.then_some(Self {
            labels,
            codes,
            count,
            odd: None,
        })
    }

    /// Record by record.
    pub fn from_records(records: impl IntoIterator<Item = Vec<String>>) -> Self {
        let mut out = Self::default();
        let mut known: Vec<FxHashMap<String, u32>> = Vec::new();
        for (n, key) in records.into_iter().enumerate() {
            if n == 0 {
                out.labels = vec![Vec::new(); key.len()];
                out.codes = vec![Vec::new(); key.len()];
                known = vec![FxHashMap::default(); key.len()];
            }
            if key.len() != known.len() {
                out.odd = Some((n, key));
                break;
            }
            for (p, label) in key.into_iter().enumerate() {
                let list = &mut out.labels[p];
                let code = *known[p].entry(label).or_insert_with_key(|label| {
                    list.push(label.clone());
                    list.len() as u32 - 1
                });
                out.codes[p].push(code);
            }
            out.count += 1;
        }
        out
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Number of index positions.
    pub fn dimension(&self) -> usize {
        self.labels.len()
    }

    /// The labels of a position; none where there are no records.
    pub fn labels(&self, position: usize) -> &[String] {
        self.labels.get(position).map_or(&[], Vec::as_slice)
    }

    /// By record, the place of its label at a position.
    pub fn codes(&self, position: usize) -> &[u32] {
        self.codes.get(position).map_or(&[], Vec::as_slice)
    }

    /// The labels of a record.
    pub fn key(&self, record: usize) -> Vec<&str> {
        let at = |(l, c): (_, &Vec<u32>)| {
            let labels: &Vec<String> = l;
            labels[c[record] as usize].as_str()
        };
        self.labels.iter().zip(&self.codes).map(at).collect()
    }

    /// Number and labels of the first record that does not have so many labels.
    pub(crate) fn unlike(&self, dimension: usize) -> Option<(usize, Vec<String>)> {
        match self.count > 0 && self.dimension() != dimension {
            true => Some((0, self.key(0).iter().map(ToString::to_string).collect())),
            false => self.odd.clone(),
        }
    }

    /// A record whose labels an earlier one has too. Labels that differ in case only, or in blanks at the end, are the same.
    pub fn duplicate(&self) -> Option<usize> {
        // By position: the first place of each label, and how many bits such a place takes.
        let mut same: Vec<Vec<u32>> = Vec::with_capacity(self.labels.len());
        let mut bits = Vec::with_capacity(self.labels.len());
        for list in &self.labels {
            let mut first: FxHashMap<String, u32> = FxHashMap::default();
            let place = |(n, l): (usize, &String)| {
                let l = l.trim_end().to_lowercase();
                *first.entry(l).or_insert(n as u32)
            };
            same.push(list.iter().enumerate().map(place).collect());
            bits.push(u32::BITS - (list.len() as u32).leading_zeros());
        }
        let place = |p: usize, r: usize| same[p][self.codes[p][r] as usize];
        if bits.iter().sum::<u32>() <= u64::BITS {
            let pack =
                |r: usize| (0..bits.len()).fold(0, |n, p| n << bits[p] | u64::from(place(p, r)));
            return repeated((0..self.count).map(|r| (pack(r), r)).collect());
        }
        let key = |r: usize| (0..bits.len()).map(|p| place(p, r)).collect::<Vec<u32>>();
        repeated((0..self.count).map(|r| (key(r), r)).collect())
    }
}

/// The number that stands with the second of two equal keys.
fn repeated<K: Ord>(mut keys: Vec<(K, usize)>) -> Option<usize> {
    if !keys.is_sorted() {
        keys.sort_unstable();
    }
    let twice = keys.windows(2).filter(|w| w[0].0 == w[1].0);
    twice.map(|w| w[1].1).min()
}
