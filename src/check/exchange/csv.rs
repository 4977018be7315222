//! Reading CSV.

use super::records::{Loading, Records};
use super::{Outcome, Wanted, attribute_offset, missing};
use crate::check::symbols::{DomainPosition, Symbol, SymbolKind, attribute};
use crate::diag::Diagnostic;
use ::csv::{ReaderBuilder, StringRecord};

/// A file as rows.
#[derive(Default)]
struct Rows {
    header: StringRecord,
    rows: Vec<StringRecord>,
}

impl Rows {
    /// The column that is headed so, from the column `from` on.
    fn column(&self, name: &str, from: usize) -> Option<usize> {
        let mut headings = self.header.iter().enumerate().skip(from);
        headings
            .find(|(_, h)| h.eq_ignore_ascii_case(name))
            .map(|(c, _)| c)
    }

    /// The rows with their lines in the file.
    fn iter(&self) -> impl Iterator<Item = (&StringRecord, usize)> {
        let line = |r: &StringRecord| r.position().map_or(0, |p| p.line() as usize);
        self.rows.iter().map(move |r| (r, line(r)))
    }
}

/// Name of the column that makes a file hold many symbols.
const SYMBOL: &str = "symbol";

fn parse(text: &str) -> Result<Rows, ::csv::Error> {
    // Where the header has no comma, another delimiter separates.
    let first = text.lines().find(|l| !l.trim().is_empty()).unwrap_or("");
    let mut delimiters = [b',', b';', b'\t'].into_iter();
    let delimiter = delimiters.find(|d| first.as_bytes().contains(d));
    let mut reader = ReaderBuilder::new()
        .flexible(true)
        .trim(::csv::Trim::All)
        .delimiter(delimiter.unwrap_or(b','))
        .from_reader(text.as_bytes());
    let header = reader.headers()?.clone();
    let mut rows = reader.into_records().collect::<Result<Vec<_>, _>>()?;
    rows.retain(|r| !r.iter().all(str::is_empty));
    Ok(Rows { header, rows })
}

fn is_long(rows: &Rows) -> bool {
    rows.column(SYMBOL, 0) == Some(0)
}

/// The symbols that a file holds, each once, in their order; none for a file of one symbol.
pub(super) fn names(text: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let rows = parse(text).unwrap_or_default();
    for r in rows.rows.iter().filter(|_| is_long(&rows)) {
        let name = r.get(0).unwrap_or("").split('.').next().unwrap_or("");
        let is_new = |o: &String| !o.eq_ignore_ascii_case(name);
        if out.last().is_none_or(is_new) && out.iter().all(is_new) {
            out.push(name.to_string());
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
    let Some(first) = items.first() else {
        return Ok(());
    };
    let columns = "a CSV file has a header line, and the same columns in every line";
    let rows = parse(text).map_err(|e| fail(first, e.to_string(), columns))?;
    if is_long(&rows) {
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
    single(file, &rows, first, loading)
}

fn short(file: &str, line: usize, w: &Wanted, have: usize, need: usize) -> Box<Diagnostic> {
    let name = &w.name;
    let d = Diagnostic::execution("E0478", w.span)
        .says(format!(
            "{file}:{line}: {have} columns, but `{name}` needs {need}"
        ))
        .label("nothing was loaded");
    Box::new(d.help("the columns are the labels, in the order of the indices, then the value"))
}

/// Many symbols: `symbol,label1,label2,value,text`.
fn long(file: &str, rows: &Rows, w: &Wanted, loading: &mut Loading<'_>) -> Outcome<()> {
    let symbol = loading.symbols.rooted(w.symbol).clone();
    let dim = symbol.dim();
    let value_column = rows.column("value", 0);
    let text_column = rows.column("text", 0);
    // Per attribute of variables and equations, in the order in which they appear.
    let mut parts: Vec<(u32, Records)> = Vec::new();
    let is_record = symbol.has_attributes();
    for (row, line) in rows.iter() {
        let written = row.get(0).unwrap_or("");
        let mut name = written.splitn(2, '.');
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
                .says(format!("{file}:{line}: `{written}` is not known"))
                .help("attributes are l, m, lo, up and scale, of variables and equations")
                .refuse();
        };
        if row.len() <= dim {
            return Err(short(file, line, w, row.len(), dim + 2));
        }
        let at = parts.iter().position(|p| p.0 == offset);
        let at = at.unwrap_or_else(|| {
            parts.push((offset, Records::default()));
            parts.len() - 1
        });
        let part = &mut parts[at].1;
        part.keys
            .extend((0..dim).map(|p| loading.label(&row[p + 1])));
        part.places.push(line);
        let at = value_column.unwrap_or(rows.header.len() - 1);
        part.values.push(match row.get(at) {
            _ if symbol.is_set() => 1.0,
            Some(v) if !v.is_empty() => loading.value(v, file, line, w)?,
            _ => return Err(short(file, line, w, row.len(), at + 1)),
        });
        let text = text_column.and_then(|c| row.get(c));
        if let Some(t) = text.filter(|_| symbol.is_set()) {
            part.text(dim, t);
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
            let known = |h| loading.store.universe.get(h);
            let belongs = |h| known(h).is_some_and(|l| table.find(&[l]).is_some());
            header.iter().skip(dim - 1).all(belongs)
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
        let headings = rows.header.iter().skip(dim - 1);
        let columns: Vec<u32> = headings.map(|h| loading.label(h)).collect();
        for (row, line) in rows.iter() {
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
            let headings = rows.header.iter().enumerate().skip(dim);
            let named = headings.filter_map(|(c, h)| Some((c, attribute_offset(h)?)));
            let named: Vec<_> = named.collect();
            match named.is_empty() {
                true => vec![(dim, attribute::L)],
                false => named,
            }
        }
        SymbolKind::Parameter { .. } => vec![(rows.column("value", dim).unwrap_or(dim), 0)],
        _ => vec![(dim, 0)],
    };
    for (row, line) in rows.iter() {
        if row.len() < dim {
            return Err(short(file, line, w, row.len(), dim));
        }
        r.keys.extend((0..dim).map(|p| loading.label(&row[p])));
        r.places.push(line);
        for &(c, offset) in &columns {
            let cell = row.get(c).unwrap_or("");
            if symbol.is_set() {
                r.values.push(1.0);
                r.text(dim, cell);
            } else if !cell.is_empty() {
                r.values.push(loading.value(cell, file, line, w)?);
            } else if matches!(symbol.kind, SymbolKind::Parameter { .. }) {
                return Err(short(file, line, w, row.len(), c + 1));
            } else {
                let table = loading.store.table(symbol.table + offset);
                r.values.push(table.default_value());
            }
        }
    }
    let offsets: Vec<u32> = columns.iter().map(|c| c.1).collect();
    loading.take(w, file, r, &offsets)
}
