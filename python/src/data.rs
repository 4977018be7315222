//! Columns of numbers and codes of labels, in and out.

use bmod::Keys;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes};

/// Numbers out of the bytes of a NumPy array of float64.
pub fn floats(bytes: &[u8]) -> Vec<f64> {
    let (parts, _) = bytes.as_chunks::<8>();
    parts.iter().map(|b| f64::from_ne_bytes(*b)).collect()
}

/// An array of NumPy's own, to be viewed without a copy.
pub fn float_bytes<'py>(py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyByteArray>> {
    PyByteArray::new_with(py, values.len() * 8, |bytes| {
        let parts = bytes.as_chunks_mut::<8>().0.iter_mut();
        parts.zip(values).for_each(|(b, v)| *b = v.to_ne_bytes());
        Ok(())
    })
}

/// The same of int32.
pub fn code_bytes<'py>(py: Python<'py>, codes: &[u32]) -> PyResult<Bound<'py, PyByteArray>> {
    PyByteArray::new_with(py, codes.len() * 4, |bytes| {
        let parts = bytes.as_chunks_mut::<4>().0.iter_mut();
        parts.zip(codes).for_each(|(b, c)| *b = c.to_ne_bytes());
        Ok(())
    })
}

/// A record's labels for a message.
pub fn shown(key: &[&str]) -> String {
    match key {
        [] => "the scalar".into(),
        [one] => format!("'{one}'"),
        many => format!("('{}')", many.join("', '")),
    }
}

/// Labels of each record, at least one position. Errors: a record that stands twice, columns of different lengths.
pub fn keys(
    name: &str,
    labels: Vec<Vec<String>>,
    codes: &[Bound<'_, PyBytes>],
    count: usize,
) -> PyResult<Keys> {
    let one = |c: &Bound<'_, PyBytes>| {
        let (parts, _) = c.as_bytes().as_chunks::<4>();
        parts.iter().map(|b| u32::from_ne_bytes(*b)).collect()
    };
    let keys = Keys::new(labels, codes.iter().map(one).collect());
    let Some(keys) = keys.filter(|k| k.len() == count) else {
        return Err(PyValueError::new_err(format!(
            "`{name}`: the columns have different lengths"
        )));
    };
    match keys.duplicate() {
        Some(r) => Err(PyValueError::new_err(format!(
            "`{name}`: {} is given twice",
            shown(&keys.key(r))
        ))),
        None => Ok(keys),
    }
}
