//! Writing CSV and JSON; the records of a symbol in any format.

use super::{ATTRIBUTES, Wanted};
use crate::check::symbols::{Store, Symbol, SymbolKind, Symbols, attribute};
use crate::data::universe::Label;
use crate::data::value::special_text;
use serde_json::{Value, json};

/// Makes the tables of symbols ready for reading in order.
pub(super) fn tidy(symbols: &Symbols, store: &mut Store, items: &[Wanted]) {
    for w in items {
        for (_, table) in parts(symbols.rooted(w.symbol)) {
            store.table_mut(table).tidy();
        }
    }
}

/// All keys that a symbol has records for, in label order.
pub(super) fn keys(store: &Store, symbol: &Symbol) -> Vec<Vec<Label>> {
    let tables = parts(symbol);
    let mut keys: Vec<Vec<Label>> = tables
        .iter()
        .flat_map(|(_, t)| store.table(*t).iter().map(|(k, _)| k.to_vec()))
        .collect();
    if tables.len() > 1 {
        keys.sort_unstable();
        keys.dedup();
    }
    if symbol.dim() == 0 && keys.is_empty() {
        keys.push(Vec::new());
    }
    keys
}

/// What is written: the symbols and their data.
pub(super) struct Writer<'a> {
    pub symbols: &'a Symbols,
    pub store: &'a Store,
}

/// Tables of a symbol that a file holds: name of the attribute (none: the data itself) and table.
fn parts(symbol: &Symbol) -> Vec<(&'static str, u32)> {
    match symbol.kind {
        SymbolKind::Variable(_) | SymbolKind::Equation(_) => ATTRIBUTES
            .iter()
            .filter(|a| a.2 != attribute::SCALE)
            .map(|a| (a.0, symbol.table + a.2))
            .collect(),
        _ => vec![("", symbol.table)],
    }
}

impl Writer<'_> {
    /// One symbol with its own columns, or several in one long table.
    pub(super) fn csv(&self, items: &[Wanted]) -> String {
        let mut out = csv::Writer::from_writer(Vec::new());
        // A vector takes everything: writing cannot fail.
        let mut write = |row: &[String]| drop(out.write_record(row));
        let labels = |key: &[Label]| -> Vec<String> {
            let names = key.iter().map(|&l| self.store.universe.name(l));
            names.map(str::to_string).collect()
        };
        let text = |s: &Symbol, key: &[Label]| {
            let text = self.store.element_text(s.table, key);
            text.unwrap_or("").to_string()
        };
        if let [one] = items {
            let symbol = self.symbols.rooted(one.symbol);
            let tables = parts(symbol);
            let mut header = self.symbols.domain_names(symbol);
            match tables.as_slice() {
                [_] if symbol.is_set() => header.push("text".into()),
                [_] => header.push("value".into()),
                many => header.extend(many.iter().map(|p| p.0.to_string())),
            }
            write(&header);
            for key in keys(self.store, symbol) {
                let mut row = labels(&key);
                if symbol.is_set() {
                    row.push(text(symbol, &key));
                } else {
                    let values = tables.iter().map(|(_, t)| self.store.table(*t).get(&key));
                    row.extend(values.map(|v| self.value_text(v)));
                }
                write(&row);
            }
        } else {
            let symbols = || items.iter().map(|w| (w, self.symbols.rooted(w.symbol)));
            let dim = symbols().map(|(_, s)| s.dim()).max().unwrap_or(0);
            let texts = symbols().any(|(_, s)| {
                let texts = self.store.texts.get(&s.table);
                s.is_set() && texts.is_some_and(|t| !t.is_empty())
            });
            let mut header = vec!["symbol".to_string()];
            header.extend((1..=dim).map(|p| format!("label{p}")));
            header.push("value".into());
            header.extend(texts.then(|| "text".into()));
            write(&header);
            for (w, symbol) in symbols() {
                for (attribute, table) in parts(symbol) {
                    let short = ATTRIBUTES.iter().find(|a| a.0 == attribute).map(|a| a.1);
                    let name = short.map_or_else(|| w.name.clone(), |a| format!("{}.{a}", w.name));
                    let mut row = |key: &[Label], v: f64| {
                        let mut row = vec![name.clone()];
                        row.extend(labels(key));
                        row.resize(dim + 1, String::new());
                        let (value, comment) = match symbol.is_set() {
                            true => ("yes".into(), text(symbol, key)),
                            false => (self.value_text(v), String::new()),
                        };
                        row.push(value);
                        row.extend(texts.then_some(comment));
                        write(&row);
                    };
                    let t = self.store.table(table);
                    if t.dim() == 0 {
                        row(&[], t.get(&[]));
                    } else {
                        t.iter().for_each(|(k, v)| row(k, v));
                    }
                }
            }
        }
        let bytes = out.into_inner().unwrap_or_default();
        String::from_utf8(bytes).unwrap_or_default()
    }

    fn json_number(&self, v: f64) -> Value {
        match special_text(v, &self.store.acronyms) {
            Some(name) => Value::from(name),
            None => Value::from(v),
        }
    }

    /// One object with a member per symbol, one record per line.
    pub(super) fn json(&self, items: &[Wanted]) -> String {
        let mut out = String::from("{");
        for (n, w) in items.iter().enumerate() {
            let symbol = self.symbols.rooted(w.symbol);
            out.push_str(if n > 0 { ",\n" } else { "\n" });
            out.push_str(&format!("  {}: ", Value::from(w.name.as_str())));
            let parts = parts(symbol);
            let value = |key: &[Label]| match parts.as_slice() {
                [(_, t)] if symbol.is_set() => {
                    Value::from(self.store.element_text(*t, key).unwrap_or(""))
                }
                [(_, t)] => self.json_number(self.store.table(*t).get(key)),
                many => {
                    let number = |t: u32| self.json_number(self.store.table(t).get(key));
                    let members = many.iter().map(|(a, t)| (a.to_string(), number(*t)));
                    Value::Object(members.collect())
                }
            };
            if symbol.dim() == 0 {
                out.push_str(&value(&[]).to_string());
                continue;
            }
            out.push_str(&format!(
                "{{\"domain\": {}, \"records\": [",
                json!(self.symbols.domain_names(symbol))
            ));
            for (k, key) in keys(self.store, symbol).iter().enumerate() {
                let labels: Vec<&str> = key.iter().map(|&l| self.store.universe.name(l)).collect();
                out.push_str(if k > 0 { ",\n    " } else { "\n    " });
                out.push_str(&json!([labels, value(key)]).to_string());
            }
            out.push_str("]}");
        }
        out.push_str("\n}\n");
        out
    }

    /// A value as files hold it.
    fn value_text(&self, v: f64) -> String {
        match special_text(v, &self.store.acronyms) {
            Some(name) => name.to_string(),
            None if v == 0.0 || (1e-5..1e15).contains(&v.abs()) => v.to_string(),
            None => format!("{v:e}"),
        }
    }
}
