//! Writing version 7.

use super::stream::Output;
use super::{
    ACRONYM_UNIT, Domain, INDEX_MARK, Kind, MAX_DIMENSION, MAX_LABEL, Records, Result, Symbol,
    TOO_LARGE, Value, fail,
};

/// Places that the header reserves for parts of the index.
const PLACES: usize = 10;

/// GAMS numbers acronyms after its own names; any numbers do.
const FIRST_ACRONYM: i32 = 101;

/// Symbols and all that they refer to.
#[derive(Clone, Debug, Default)]
pub struct Contents<'a> {
    /// Labels.
    pub labels: Vec<&'a str>,
    /// Texts of elements; the first is empty.
    pub texts: Vec<&'a str>,
    /// Names of acronyms.
    pub acronyms: Vec<&'a str>,
    /// Symbols and their records (none for an alias).
    pub symbols: Vec<(Symbol, Records)>,
}

/// The bytes of a file. Errors: labels, names or symbols that no GDX file can hold.
pub fn write(contents: &Contents<'_>) -> Result<Vec<u8>> {
    for l in &contents.labels {
        if l.len() > MAX_LABEL {
            return fail(format!("the label `{l}` is longer than {MAX_LABEL} bytes"));
        }
    }
    let mut out = Output::default();
    out.raw(&[2, 0x34, 0x12, 4, 0x78, 0x56, 0x34, 0x12, 8]);
    out.f64(std::f64::consts::PI);
    out.byte(123);
    out.text("GAMSGDX");
    out.i32(7);
    // Nothing is packed.
    out.i32(0);
    out.text(concat!("bmod ", env!("CARGO_PKG_VERSION"), ", GDX V7"));
    out.text(concat!("bmod ", env!("CARGO_PKG_VERSION")));
    let index = out.bytes.len();
    out.i32(INDEX_MARK);
    (0..PLACES).for_each(|_| out.i64(0));
    let mut places = Vec::new();
    for (symbol, records) in &contents.symbols {
        places.push(match symbol.kind {
            Kind::Alias(_) => 0,
            _ => data(&mut out, symbol, records)?,
        });
    }
    let symbols = out.place();
    list(&mut out, "_SYMB_", &contents.symbols, {
        let mut places = places.iter();
        move |out, (symbol, records)| {
            let at = places.next().copied().unwrap_or(0);
            entry(out, symbol, records, at);
        }
    });
    let texts = out.place();
    list(&mut out, "_SETT_", &contents.texts, |out, t| out.text(t));
    let labels = out.place();
    list(&mut out, "_UEL_", &contents.labels, |out, l| out.text(l));
    let acronyms = out.place();
    let mut number = FIRST_ACRONYM;
    list(&mut out, "_ACRO_", &contents.acronyms, |out, a| {
        out.text(a);
        out.text("");
        out.i32(number);
        number += 1;
    });
    let domains = out.place();
    relaxed_domains(&mut out, &contents.symbols);
    let next = symbols;
    let parts = [symbols, labels, texts, acronyms, next, domains];
    for (k, part) in parts.iter().enumerate() {
        let at = index + 4 + 8 * k;
        out.bytes[at..at + 8].copy_from_slice(&part.to_le_bytes());
    }
    Ok(out.bytes)
}

/// A list between two marks.
fn list<T>(out: &mut Output, mark: &str, items: &[T], mut write: impl FnMut(&mut Output, &T)) {
    out.text(mark);
    out.i32(items.len() as i32);
    for item in items {
        write(out, item);
    }
    out.text(mark);
}

/// An entry of the list of symbols.
fn entry(out: &mut Output, symbol: &Symbol, records: &Records, at: i64) {
    let (kind, detail) = match symbol.kind {
        Kind::Set { singleton } => (0, i32::from(singleton)),
        Kind::Parameter => (1, 0),
        Kind::Variable(t) => (2, t),
        Kind::Equation(t) => (3, t),
        Kind::Alias(of) => (4, of.map_or(0, |n| n as i32 + 1)),
    };
    out.text(&symbol.name);
    out.i64(at);
    out.i32(symbol.domain.len() as i32);
    out.byte(kind);
    out.i32(detail);
    out.i32(records.len as i32);
    out.i32(0);
    out.byte(u8::from(records.texts.iter().any(|t| *t != 0)));
    out.text(&symbol.text);
    out.byte(0);
    let has_domain = !symbol.domain.is_empty() && !matches!(symbol.kind, Kind::Alias(_));
    out.byte(u8::from(has_domain));
    if has_domain {
        for d in &symbol.domain {
            out.i32(match d {
                Domain::Set(n) => *n as i32 + 1,
                _ => 0,
            });
        }
    }
    out.i32(0);
}

/// Names of sets that are domains in words only.
fn relaxed_domains(out: &mut Output, symbols: &[(Symbol, Records)]) {
    let mut names: Vec<&str> = Vec::new();
    let mut uses = Vec::new();
    for (n, (symbol, _)) in symbols.iter().enumerate() {
        let is_relaxed = |d: &Domain| matches!(d, Domain::Relaxed(_));
        if !symbol.domain.iter().any(is_relaxed) {
            continue;
        }
        uses.push(n as i32 + 1);
        for d in &symbol.domain {
            let name = match d {
                Domain::Universe => {
                    uses.push(0);
                    continue;
                }
                Domain::Set(n) => symbols.get(*n).map_or("*", |s| s.0.name.as_str()),
                Domain::Relaxed(name) => name.as_str(),
            };
            let at = names.iter().position(|n| *n == name).unwrap_or_else(|| {
                names.push(name);
                names.len() - 1
            });
            uses.push(at as i32 + 1);
        }
    }
    list(out, "_DOMS_", &names, |out, n| out.text(n));
    uses.iter().for_each(|n| out.i32(*n));
    out.i32(-1);
    out.text("_DOMS_");
}

/// The records of a symbol; their place.
fn data(out: &mut Output, symbol: &Symbol, records: &Records) -> Result<i64> {
    let dim = symbol.domain.len();
    if dim > MAX_DIMENSION {
        return fail(format!("`{}` has {dim} index positions", symbol.name));
    }
    if symbol.name.len() > MAX_LABEL {
        return fail(format!(
            "the name `{}` is longer than {MAX_LABEL} bytes",
            symbol.name
        ));
    }
    for v in &records.values {
        if let Value::Number(x) = v
            && x.is_finite()
            && *x >= TOO_LARGE
        {
            return fail(format!(
                "`{}` has the value {x:e}; numbers are below {TOO_LARGE:e}",
                symbol.name
            ));
        }
    }
    let at = out.place();
    out.text("_DATA_");
    out.byte(dim as u8);
    out.i32(-1);
    let mut least = [0u32; MAX_DIMENSION];
    let mut size = [4u8; MAX_DIMENSION];
    for d in 0..dim {
        let labels = || records.keys.iter().skip(d).step_by(dim).copied();
        let (low, high) = (labels().min().unwrap_or(0), labels().max().unwrap_or(0));
        least[d] = low;
        size[d] = match high - low + 1 {
            ..=255 => 1,
            256..=65535 => 2,
            _ => 4,
        };
        // Labels are counted from one.
        out.i32(low as i32 + 1);
        out.i32(high as i32 + 1);
    }
    let width = symbol.kind.width();
    for r in 0..records.len {
        let key = &records.keys[r * dim..(r + 1) * dim];
        let before = match r {
            0 => None,
            _ => Some(&records.keys[(r - 1) * dim..r * dim]),
        };
        code(out, key, before, &least, &size);
        if width == 0 {
            value(out, Value::Number(f64::from(records.texts[r])));
        }
        for v in &records.values[r * width..(r + 1) * width] {
            value(out, *v);
        }
    }
    out.byte(255);
    Ok(at)
}

/// Codes the labels of a record by what changes.
fn code(
    out: &mut Output,
    key: &[u32],
    before: Option<&[u32]>,
    least: &[u32; MAX_DIMENSION],
    size: &[u8; MAX_DIMENSION],
) {
    let dim = key.len();
    let changed = before.map_or(0, |b| {
        let same = b.iter().zip(key).take_while(|(x, y)| x == y);
        same.count().min(dim.saturating_sub(1))
    });
    if let (Some(b), true) = (before, changed + 1 == dim)
        && key[dim - 1] > b[dim - 1]
    {
        let code = (key[dim - 1] - b[dim - 1]) as usize + dim;
        if code < 255 {
            return out.byte(code as u8);
        }
    }
    out.byte(changed as u8 + 1);
    for d in changed..dim {
        let step = key[d] - least[d];
        match size[d] {
            1 => out.byte(step as u8),
            2 => out.raw(&(step as u16).to_le_bytes()),
            _ => out.i32(step as i32),
        }
    }
}

fn value(out: &mut Output, v: Value) {
    let x = match v {
        Value::Undefined => return out.byte(0),
        Value::NotAvailable => return out.byte(1),
        Value::Eps => return out.byte(4),
        Value::Acronym(n) => f64::from(FIRST_ACRONYM + n as i32) * ACRONYM_UNIT,
        Value::Number(x) => {
            let code = match x {
                f64::INFINITY => 2,
                f64::NEG_INFINITY => 3,
                0.0 => 5,
                1.0 => 6,
                -1.0 => 7,
                0.5 => 8,
                2.0 => 9,
                _ => 10,
            };
            if code < 10 {
                return out.byte(code);
            }
            x
        }
    };
    out.byte(10);
    out.f64(x);
}
