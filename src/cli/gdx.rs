//! `bmod gdx`: what is in a GDX file.

use super::args::{EXECUTION, GdxArgs, USAGE};
use super::commands::{Status, complain};
use super::derive::tell;
use crate::diag::nearest;
use crate::gdx::{Domain, Error, File, Value};
use crate::report::study::comma_separated;

/// Shows the symbols of a file, or the records of one; the exit status.
pub(super) fn show(a: &GdxArgs) -> Status {
    let name = a.file.display();
    let bytes = std::fs::read(&a.file)
        .map_err(|e| complain(USAGE, format!("{name} cannot be read: {e}")))?;
    let table = File::open(&bytes).and_then(|file| {
        let Some(symbol) = &a.symbol else {
            return Ok((Some(head(&file, &name.to_string())), symbols(&file)?));
        };
        let Some(n) = file.find(symbol) else {
            let near = nearest(symbol, file.symbols.iter().map(|s| s.name.as_str()));
            let near = near.map(|n| format!("; did you mean `{n}`?"));
            let near = near.unwrap_or_default();
            return Err(format!("it has no symbol `{symbol}`{near}"));
        };
        Ok((None, records(&file, n)?))
    });
    let (head, table) = table.map_err(|e| complain(EXECUTION, format!("{name}: {e}")))?;
    tell(&match a.csv {
        true => comma_separated(&table),
        false => head.unwrap_or_default() + &aligned(&table),
    });
    Ok(0)
}

/// Lines of cells; the first has the names of the columns.
type Rows = Vec<Vec<String>>;

fn head(file: &File<'_>, name: &str) -> String {
    let packed = if file.packed { ", compressed" } else { "" };
    // A program fills its version with blanks.
    let producer: Vec<&str> = file.producer.split_whitespace().collect();
    format!(
        "{name}: GDX version {}{packed}, {} labels, written by {}\n\n",
        file.version,
        file.labels.len(),
        producer.join(" ")
    )
}

fn domain(file: &File<'_>, symbol: usize) -> Vec<String> {
    let name = |d: &Domain| match d {
        Domain::Universe => "*".to_string(),
        Domain::Set(n) => file.symbols[*n].name.clone(),
        Domain::Relaxed(name) => name.clone(),
    };
    file.symbols[symbol].domain.iter().map(name).collect()
}

fn symbols(file: &File<'_>) -> Result<Rows, Error> {
    let columns = ["symbol", "kind", "records", "text"];
    let mut rows = vec![columns.map(String::from).to_vec()];
    for (n, s) in file.symbols.iter().enumerate() {
        let domain = domain(file, n);
        let indices = match domain.is_empty() {
            true => String::new(),
            false => format!("({})", domain.join(",")),
        };
        rows.push(vec![
            s.name.clone() + &indices,
            s.kind.name().into(),
            file.count(n)?.to_string(),
            s.text.clone(),
        ]);
    }
    Ok(rows)
}

fn records(file: &File<'_>, symbol: usize) -> Result<Rows, Error> {
    let kind = file.symbols[symbol].kind;
    // An alias of all labels stands for no symbol of the file.
    let domain = match file.root(symbol)? {
        Some(n) => domain(file, n),
        None => vec!["*".to_string()],
    };
    let (dim, width) = (domain.len(), kind.width());
    let records = file.records(symbol)?;
    let mut head = domain;
    head.extend(
        match width {
            0 => &["text"][..],
            1 => &["value"],
            _ => &["level", "marginal", "lower", "upper", "scale"],
        }
        .iter()
        .map(|c| c.to_string()),
    );
    let mut rows = vec![head];
    for r in 0..records.len {
        let keys = &records.keys[r * dim..(r + 1) * dim];
        let mut row: Vec<String> = keys
            .iter()
            .map(|&k| file.labels[k as usize].clone())
            .collect();
        if width == 0 {
            let text = file.texts.get(records.texts[r] as usize);
            row.push(text.cloned().unwrap_or_default());
        }
        let values = &records.values[r * width..(r + 1) * width];
        row.extend(values.iter().map(|v| value(file, *v)));
        rows.push(row);
    }
    Ok(rows)
}

fn value(file: &File<'_>, v: Value) -> String {
    match v {
        Value::Number(f64::INFINITY) => "+INF".into(),
        Value::Number(f64::NEG_INFINITY) => "-INF".into(),
        Value::Number(x) if x == 0.0 || (1e-5..1e15).contains(&x.abs()) => x.to_string(),
        Value::Number(x) => format!("{x:e}"),
        Value::Undefined => "UNDF".into(),
        Value::NotAvailable => "NA".into(),
        Value::Eps => "EPS".into(),
        Value::Acronym(n) => file.acronyms().nth(n as usize).unwrap_or("?").into(),
    }
}

/// Columns of equal width; numbers stand to the right.
fn aligned(rows: &Rows) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |c: usize| {
        let widths = rows.iter().map(|r| r[c].chars().count());
        widths.max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let is_number = |c: usize| {
        let special = ["EPS", "NA", "UNDF", "+INF", "-INF"];
        let number = |t: &str| t.parse::<f64>().is_ok() || special.contains(&t);
        rows.len() > 1 && rows[1..].iter().all(|r| number(&r[c]))
    };
    let right: Vec<bool> = (0..columns).map(is_number).collect();
    let mut out = String::new();
    for row in rows {
        let mut line = String::new();
        for (c, cell) in row.iter().enumerate() {
            let w = widths[c];
            line += &match right[c] {
                true => format!("{cell:>w$}  "),
                false => format!("{cell:<w$}  "),
            };
        }
        out += line.trim_end();
        out.push('\n');
    }
    out
}
