//! Reading JSON: an object with a member per symbol.

use super::records::{Loading, Records};
use super::{ATTRIBUTES, Outcome, Wanted, attribute_offset, missing};
use crate::check::symbols::{Symbol, SymbolKind, attribute};
use crate::diag::Diagnostic;
use serde_json::{Map, Value};

/// The names in a file.
pub(super) fn names(text: &str) -> Vec<String> {
    match serde_json::from_str::<Map<String, Value>>(text) {
        Ok(m) => m.keys().cloned().collect(),
        Err(_) => Vec::new(),
    }
}

/// Reads the wanted symbols.
pub(super) fn read(
    file: &str,
    text: &str,
    items: &[Wanted],
    loading: &mut Loading<'_>,
) -> Outcome<()> {
    let Some(first) = items.first() else {
        return Ok(());
    };
    let object: Map<String, Value> = serde_json::from_str(text).map_err(|e| {
        Box::new(
            Diagnostic::execution("E0478", first.span)
                .says(format!("{file}:{}: {e}", e.line()))
                .help("the file holds one object, with a member per symbol: `{\"p\": …}`"),
        )
    })?;
    for w in items {
        let Some((_, value)) = object.iter().find(|(k, _)| k.eq_ignore_ascii_case(&w.name)) else {
            let there: Vec<String> = object.keys().cloned().collect();
            return Err(missing(file, w, &there));
        };
        Reader {
            file,
            w,
            symbol: loading.symbols.rooted(w.symbol).clone(),
            records: Records::default(),
            columns: Vec::new(),
        }
        .symbol(value, loading)?;
    }
    Ok(())
}

struct Reader<'a> {
    file: &'a str,
    w: &'a Wanted,
    symbol: Symbol,
    records: Records,
    /// Tables that the values of a record go to.
    columns: Vec<u32>,
}

impl Reader<'_> {
    fn wrong<T>(&self, what: &str) -> Outcome<T> {
        let dim = self.symbol.dim();
        let example = match (self.symbol.is_set(), dim) {
            (true, 1) => "[\"a\", \"b\"]".to_string(),
            (true, _) => "[[\"a\", \"x\"], …]".to_string(),
            (false, 0) => "3.5".to_string(),
            (false, _) => {
                let labels: Vec<String> = (0..dim)
                    .map(|p| format!("\"{}\"", (b'a' + p as u8 % 26) as char))
                    .collect();
                format!("{{\"records\": [[[{}], 3.5], …]}}", labels.join(", "))
            }
        };
        Diagnostic::execution("E0478", self.w.span)
            .says(format!("{}: `{}`: {what}", self.file, self.w.name))
            .label("nothing was loaded")
            .help(format!(
                "a {} with {dim} indices is written as `{example}`",
                self.symbol.kind_name()
            ))
            .refuse()
    }

    fn symbol(mut self, v: &Value, loading: &mut Loading<'_>) -> Outcome<()> {
        let dim = self.symbol.dim();
        self.columns = match self.symbol.kind {
            SymbolKind::Variable(_) | SymbolKind::Equation(_) => {
                let mut found = Vec::new();
                attributes(v, &mut found);
                match found.is_empty() {
                    true => vec![attribute::L],
                    false => found,
                }
            }
            _ => vec![0],
        };
        let records = match v {
            Value::Object(m) => m.get("records").or_else(|| m.get("elements")).unwrap_or(v),
            _ => v,
        };
        match records {
            _ if dim == 0 => {
                let records = match records {
                    // A list of one record without labels.
                    Value::Array(a) => match a.as_slice() {
                        [Value::Array(one)] if one.len() == 2 => &one[1],
                        [one] => one,
                        _ => return self.wrong("one value is expected"),
                    },
                    other => other,
                };
                self.values(records, 1, loading)?;
            }
            Value::Array(list) => {
                for (k, entry) in list.iter().enumerate() {
                    self.entry(entry, k + 1, loading)?;
                }
            }
            Value::Object(_) => {
                let mut path = Vec::new();
                self.nested(records, &mut path, loading)?;
            }
            _ => return self.wrong("a list of records or an object is expected"),
        }
        let Self {
            file,
            w,
            records,
            columns,
            ..
        } = self;
        loading.take(w, file, records, &columns)
    }

    /// `[["a","x"], 3.5]`, and for sets `"a"`, `["a","x"]`, `[["a","x"], "text"]`.
    fn entry(&mut self, e: &Value, place: usize, loading: &mut Loading<'_>) -> Outcome<()> {
        let dim = self.symbol.dim();
        let (labels, value) = match e {
            Value::Array(pair) if pair.len() == 2 && pair[0].is_array() => {
                (&pair[0], Some(&pair[1]))
            }
            other if self.symbol.is_set() => (other, None),
            _ => return self.wrong(&format!("record {place} is not a pair of labels and value")),
        };
        let labels: Vec<&Value> = match labels {
            Value::Array(l) => l.iter().collect(),
            one => vec![one],
        };
        if labels.len() != dim {
            return self.wrong(&format!("record {place} has {} labels", labels.len()));
        }
        for l in labels {
            let Some(text) = label_text(l) else {
                return self.wrong(&format!("record {place} has a label that is no text"));
            };
            let l = loading.label(&text);
            self.records.keys.push(l);
        }
        self.values(value.unwrap_or(&Value::Null), place, loading)
    }

    /// `{"a": {"x": 3.5}}`
    fn nested(&mut self, v: &Value, path: &mut Vec<u32>, loading: &mut Loading<'_>) -> Outcome<()> {
        if path.len() == self.symbol.dim() {
            self.records.keys.extend_from_slice(path);
            let place = self.records.places.len() + 1;
            return self.values(v, place, loading);
        }
        let Value::Object(m) = v else {
            let levels = self.symbol.dim();
            return self.wrong(&format!("{levels} levels of objects are expected"));
        };
        for (label, inner) in m {
            let l = loading.label(label);
            path.push(l);
            self.nested(inner, path, loading)?;
            path.pop();
        }
        Ok(())
    }

    /// The values of a record.
    fn values(&mut self, v: &Value, place: usize, loading: &Loading<'_>) -> Outcome<()> {
        self.records.places.push(place);
        if self.symbol.is_set() {
            self.records.values.push(1.0);
            match v {
                Value::Null | Value::Bool(true) | Value::Number(_) => {}
                Value::String(t) if t.eq_ignore_ascii_case("yes") => {}
                Value::String(t) => self.records.text(self.symbol.dim(), t),
                _ => return self.wrong(&format!("record {place} has a value that is no text")),
            }
            return Ok(());
        }
        let columns = std::mem::take(&mut self.columns);
        for &offset in &columns {
            let member = match v {
                Value::Object(m) => {
                    let mut members = m.iter();
                    let hit = members.find(|(k, _)| attribute_offset(k) == Some(offset));
                    hit.map(|(_, x)| x)
                }
                other => Some(other),
            };
            let x = match member {
                None => {
                    let table = loading.store.table(self.symbol.table + offset);
                    Some(table.default_value())
                }
                Some(Value::Number(n)) => n.as_f64(),
                Some(Value::String(t)) => Some(loading.value(t, self.file, place, self.w)?),
                Some(Value::Bool(b)) => Some(f64::from(u8::from(*b))),
                Some(_) => None,
            };
            match x {
                Some(x) => self.records.values.push(x),
                None => {
                    return self.wrong(&format!("record {place} has a value that is no number"));
                }
            }
        }
        self.columns = columns;
        Ok(())
    }
}

fn label_text(v: &Value) -> Option<String> {
    match v {
        Value::String(s) => Some(s.clone()),
        Value::Number(n) => Some(n.to_string()),
        _ => None,
    }
}

/// The attributes that the first record with any has.
fn attributes(v: &Value, out: &mut Vec<u32>) {
    match v {
        Value::Object(m) => {
            let known = |k: &String| attribute_offset(k);
            if !m.is_empty() && m.keys().all(|k| known(k).is_some()) {
                for (_, _, offset) in ATTRIBUTES {
                    if m.keys().any(|k| known(k) == Some(*offset)) && !out.contains(offset) {
                        out.push(*offset);
                    }
                }
            } else {
                m.values().for_each(|x| attributes(x, out));
            }
        }
        Value::Array(a) => a.iter().for_each(|x| attributes(x, out)),
        _ => {}
    }
}
