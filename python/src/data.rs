//! Columns of numbers and codes of labels, in and out.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::collections::{HashMap, HashSet};

/// Numbers out of the bytes of a NumPy array.
pub fn floats(bytes: &[u8]) -> Vec<f64> {
    let (parts, _) = bytes.as_chunks::<8>();
    parts.iter().map(|b| f64::from_ne_bytes(*b)).collect()
}

fn integers(bytes: &[u8]) -> Vec<i32> {
    let (parts, _) = bytes.as_chunks::<4>();
    parts.iter().map(|b| i32::from_ne_bytes(*b)).collect()
}

/// A record's labels for a message.
pub fn shown(key: &[String]) -> String {
    match key {
        [] => "the scalar".into(),
        [one] => format!("'{one}'"),
        many => format!("('{}')", many.join("', '")),
    }
}

/// Labels of each record. Errors: a record that stands twice, columns of different lengths.
pub fn keys(
    name: &str,
    labels: &[Vec<String>],
    codes: &[Bound<'_, PyBytes>],
    count: usize,
) -> PyResult<Vec<Vec<String>>> {
    let codes: Vec<Vec<i32>> = codes.iter().map(|c| integers(c.as_bytes())).collect();
    if labels.len() != codes.len() || codes.iter().any(|c| c.len() != count) {
        return Err(PyValueError::new_err(format!(
            "`{name}`: the columns have different lengths"
        )));
    }
    // Labels that differ in case only, or in blanks at the end, are the same label.
    let same: Vec<Vec<usize>> = labels
        .iter()
        .map(|list| {
            let mut first = HashMap::new();
            let number =
                |(n, l): (usize, &String)| *first.entry(l.trim_end().to_lowercase()).or_insert(n);
            list.iter().enumerate().map(number).collect()
        })
        .collect();
    let mut seen = HashSet::with_capacity(count);
    let mut keys = Vec::with_capacity(count);
    for r in 0..count {
        let mut key = Vec::with_capacity(labels.len());
        let mut number = Vec::with_capacity(labels.len());
        for (p, list) in labels.iter().enumerate() {
            let code = usize::try_from(codes[p][r]).unwrap_or(usize::MAX);
            let Some(label) = list.get(code) else {
                return Err(PyValueError::new_err(format!(
                    "`{name}`: record {} has no label at position {}",
                    r + 1,
                    p + 1
                )));
            };
            key.push(label.clone());
            number.push(same[p][code]);
        }
        if !labels.is_empty() && !seen.insert(number) {
            return Err(PyValueError::new_err(format!(
                "`{name}`: {} is given twice",
                shown(&key)
            )));
        }
        keys.push(key);
    }
    Ok(keys)
}

/// The labels of one index position: each once, and their codes per record.
#[derive(Default)]
pub struct Column<'a> {
    known: HashMap<*const u8, i32>,
    labels: Vec<&'a str>,
    codes: Vec<u8>,
}

impl<'a> Column<'a> {
    /// Appends a label. Labels of a run are stored once: their address tells them apart.
    pub fn push(&mut self, label: &'a str) {
        let code = *self.known.entry(label.as_ptr()).or_insert_with(|| {
            self.labels.push(label);
            self.labels.len() as i32 - 1
        });
        self.codes.extend(code.to_ne_bytes());
    }

    /// Labels and codes.
    pub fn finish<'py>(self, py: Python<'py>) -> (Vec<String>, Bound<'py, PyBytes>) {
        let labels = self.labels.into_iter().map(String::from).collect();
        (labels, PyBytes::new(py, &self.codes))
    }
}
