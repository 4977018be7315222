//! Reading CSV.

use super::records::{Loading, Records};
use super::{Outcome, Wanted, attribute_offset, missing};
use crate::check::symbols::{DomainPosition, Symbol, SymbolKind, attribute};
use crate::diag::Diagnostic;
use ::csv::{ReaderBuilder, StringRecord};

/// A file as rows.
struct Rows {
    header: StringRecord,
    rows: Vec<StringRecord>,
    lines: Vec<usize>,
}

/// Name of the column that makes a file hold many symbols.
const SYMBOL: &str = "symbol";

fn parse(text: &str) -> Result<Rows, String> {
    // Where the header has no comma, another delimiter separates.
    let first = text.lines().find(|l| !l.trim().is_empty()).unwrap_or("");
    let delimiter = [b',', b';', b'\t']
        .into_iter()
        .find(|&d| first.as_bytes().contains(&d))
        .unwrap_or(b',');
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(::csv::Trim::All)
        .delimiter(delimiter)
        .from_reader(text.as_bytes());
    let mut out = Rows {
        header: StringRecord::new(),
        rows: Vec::new(),
        lines: Vec::new(),
    };
    let mut record = StringRecord::new();
    let mut first = true;
    loop {
        match reader.read_record(&mut record) {
            Ok(false) => return Ok(out),
            Ok(true) if first => {
                out.header = record.clone();
                first = false;
            }
            Ok(true) => {
                let line = record.position().map_or(0, |p| p.line() as usize);
                if !record.iter().all(str::is_empty) {
                    out.rows.push(record.clone());
                    out.lines.push(line);
                }
            }
            Err(e) => return Err(e.to_string()),
        }
    }
}

fn is_long(header: &StringRecord) -> bool {
    header
        .get(0)
        .is_some_and(|h| h.eq_ignore_ascii_case(SYMBOL))
}

/// The symbols that a file holds, each once, in their order; none for a file of one symbol.
pub(super) fn names(text: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    if let Ok(rows) = parse(text)
        && is_long(&rows.header)
    {
        for r in &rows.rows {
            let name = r.get(0).unwrap_or("").split('.').next().unwrap_or("");
            if out.last().is_none_or(|l| l != name)
                && !out.iter().any(|o| o.eq_ignore_ascii_case(name))
            {
                out.push(name.to_string());
            }
        }
    }
    out
}

/// Reads the wanted symbols.
pub(super) fn read(
    file: &str,
    text: &str,
    items: &[Wanted],
    loading: &mut Loading<'_>,
) -> Outcome<()> {
    let fail = |w: &Wanted, message: String, help: &str| {
        Box::new(
            Diagnostic::execution("E0478", w.span)
                .says(format!("{file}: {message}"))
                .label(format!("while loading `{}`", w.name))
                .help(help),
        )
    };
    let rows = match (parse(text), items.first()) {
        (_, None) => return Ok(()),
        (Err(e), Some(w)) => {
            return Err(fail(
                w,
                e,
                "a CSV file has a header line, and the same columns in every line",
            ));
        }
        (Ok(rows), _) => rows,
    };
    if is_long(&rows.header) {
        let there = names(text);
        for w in items {
            if !there.iter().any(|n| n.eq_ignore_ascii_case(&w.name)) {
                return Err(missing(file, w, &there));
            }
            long(file, &rows, w, loading)?;
        }
        return Ok(());
    }
    if let [_, second, ..] = items {
        return Err(fail(
            second,
            "the file holds one symbol, but several are asked for".into(),
            "begin the header with a column `symbol`, or load every symbol from its own file",
        ));
    }
    single(file, &rows, &items[0], loading)
}

fn short(file: &str, line: usize, w: &Wanted, have: usize, need: usize) -> Box<Diagnostic> {
    Box::new(
        Diagnostic::execution("E0478", w.span)
            .says(format!(
                "{file}:{line}: {have} columns, but `{}` needs {need}",
                w.name
            ))
            .label("nothing was loaded")
            .help("the columns are the labels, in the order of the indices, then the value"),
    )
}

/// Many symbols: `symbol,label1,label2,value,text`.
fn long(file: &str, rows: &Rows, w: &Wanted, loading: &mut Loading<'_>) -> Outcome<()> {
    let symbol = loading.symbols.rooted(w.symbol).clone();
    let dim = symbol.dim();
    let value_column = rows
        .header
        .iter()
        .position(|h| h.eq_ignore_ascii_case("value"));
    let text_column = rows
        .header
        .iter()
        .position(|h| h.eq_ignore_ascii_case("text"));
    // Per attribute of variables and equations, in the order in which they appear.
    let mut parts: Vec<(u32, Records)> = Vec::new();
    let is_record = symbol.has_attributes();
    for (row, &line) in rows.rows.iter().zip(&rows.lines) {
        let mut name = row.get(0).unwrap_or("").splitn(2, '.');
        if !name.next().is_some_and(|n| n.eq_ignore_ascii_case(&w.name)) {
            continue;
        }
        let offset = match name.next() {
            Some(a) if is_record => attribute_offset(a),
            None if is_record => Some(attribute::L),
            None => Some(0),
            Some(_) => None,
        };
        let Some(offset) = offset else {
            return Diagnostic::execution("E0478", w.span)
                .says(format!(
                    "{file}:{line}: `{}` is not known",
                    row.get(0).unwrap_or("")
                ))
                .help("attributes are l, m, lo, up and scale, of variables and equations")
                .refuse();
        };
        if row.len() <= dim {
            return Err(short(file, line, w, row.len(), dim + 2));
        }
        let part = match parts.iter().position(|p| p.0 == offset) {
            Some(k) => &mut parts[k].1,
            None => {
                parts.push((offset, Records::default()));
                &mut parts.last_mut().expect("just pushed").1
            }
        };
        for p in 0..dim {
            let l = loading.label(&row[p + 1]);
            part.keys.push(l);
        }
        part.places.push(line);
        let at = value_column.unwrap_or(rows.header.len() - 1);
        match row.get(at) {
            Some(v) if !v.is_empty() && (!symbol.is_set() || at > dim) => {
                let v = if symbol.is_set() {
                    1.0
                } else {
                    loading.value(v, file, line, w)?
                };
                part.values.push(v);
            }
            _ if symbol.is_set() => part.values.push(1.0),
            _ => return Err(short(file, line, w, row.len(), at + 1)),
        }
        if symbol.is_set()
            && let Some(t) = text_column
                .and_then(|c| row.get(c))
                .filter(|t| !t.is_empty())
        {
            let key = part.keys[part.keys.len() - dim..].into();
            part.texts.insert(key, t.into());
        }
    }
    for (offset, records) in parts {
        loading.take(w, file, records, &[offset])?;
    }
    Ok(())
}

/// Whether the columns from the last index on are headed by its labels.
fn is_table(header: &StringRecord, symbol: &Symbol, loading: &Loading<'_>) -> bool {
    let dim = symbol.dim();
    if dim < 2 || header.len() < dim || symbol.is_set() {
        return false;
    }
    match symbol.domain[dim - 1] {
        DomainPosition::Set(d) => {
            let table = loading.store.table(loading.symbols.get(d).table);
            header.iter().skip(dim - 1).all(|h| {
                loading
                    .store
                    .universe
                    .get(h)
                    .is_some_and(|l| table.find(&[l]).is_some())
            })
        }
        _ => header.len() != dim + 1,
    }
}

/// One symbol: labels, then the value, the text, or the attributes; or a table with the last index on top.
fn single(file: &str, rows: &Rows, w: &Wanted, loading: &mut Loading<'_>) -> Outcome<()> {
    let symbol = loading.symbols.rooted(w.symbol).clone();
    let dim = symbol.dim();
    let mut r = Records::default();
    if is_table(&rows.header, &symbol, loading)
        && matches!(symbol.kind, SymbolKind::Parameter { .. })
    {
        let columns: Vec<u32> = rows
            .header
            .iter()
            .skip(dim - 1)
            .map(|h| loading.label(h))
            .collect();
        for (row, &line) in rows.rows.iter().zip(&rows.lines) {
            if row.len() < dim {
                return Err(short(file, line, w, row.len(), rows.header.len()));
            }
            let lead: Vec<u32> = (0..dim - 1).map(|p| loading.label(&row[p])).collect();
            for (c, &column) in columns.iter().enumerate() {
                let cell = row.get(dim - 1 + c).unwrap_or("");
                if cell.is_empty() {
                    continue;
                }
                r.keys.extend_from_slice(&lead);
                r.keys.push(column);
                r.places.push(line);
                r.values.push(loading.value(cell, file, line, w)?);
            }
        }
        return loading.take(w, file, r, &[0]);
    }
    // Columns behind the labels, and the tables that they fill.
    let columns: Vec<(usize, u32)> = match symbol.kind {
        SymbolKind::Variable(_) | SymbolKind::Equation(_) => {
            let named: Vec<_> = rows
                .header
                .iter()
                .enumerate()
                .skip(dim)
                .filter_map(|(c, h)| Some((c, attribute_offset(h)?)))
                .collect();
            if named.is_empty() {
                vec![(dim, attribute::L)]
            } else {
                named
            }
        }
        SymbolKind::Parameter { .. } => {
            let value = rows
                .header
                .iter()
                .skip(dim)
                .position(|h| h.eq_ignore_ascii_case("value"));
            vec![(dim + value.unwrap_or(0), 0)]
        }
        _ => vec![(dim, 0)],
    };
    for (row, &line) in rows.rows.iter().zip(&rows.lines) {
        if row.len() < dim {
            return Err(short(file, line, w, row.len(), dim));
        }
        for p in 0..dim {
            let l = loading.label(&row[p]);
            r.keys.push(l);
        }
        r.places.push(line);
        for &(c, offset) in &columns {
            let cell = row.get(c).unwrap_or("");
            if symbol.is_set() {
                r.values.push(1.0);
                if !cell.is_empty() {
                    let key = r.keys[r.keys.len() - dim..].into();
                    r.texts.insert(key, cell.into());
                }
            } else if !cell.is_empty() {
                r.values.push(loading.value(cell, file, line, w)?);
            } else if matches!(symbol.kind, SymbolKind::Parameter { .. }) {
                return Err(short(file, line, w, row.len(), c + 1));
            } else {
                r.values
                    .push(loading.store.table(symbol.table + offset).default_value());
            }
        }
    }
    let offsets: Vec<u32> = columns.iter().map(|c| c.1).collect();
    loading.take(w, file, r, &offsets)
}
