//! Files that GAMS 54.6 wrote, our own, and damaged ones.

use super::*;

const PLAIN: &[u8] = include_bytes!("../../tests/suite/exchange/gams.gdx");
const PACKED: &[u8] = include_bytes!("../../tests/suite/exchange/gams_packed.gdx");
const RELAXED: &[u8] = include_bytes!("../../tests/suite/exchange/gams_relaxed.gdx");

/// Opens a file and reads all of it.
fn all(bytes: &[u8]) -> Result<Contents<'_>> {
    let file = File::open(bytes)?;
    let mut symbols = Vec::new();
    for (n, s) in file.symbols.iter().enumerate() {
        let records = match s.kind {
            Kind::Alias(_) => {
                file.records(n)?;
                Records::default()
            }
            _ => file.records(n)?,
        };
        symbols.push((s.clone(), records));
    }
    let leak =
        |list: Vec<String>| -> Vec<&'static str> { list.into_iter().map(|t| &*t.leak()).collect() };
    Ok(Contents {
        acronyms: leak(file.acronyms().map(String::from).collect()),
        labels: leak(file.labels.clone()),
        texts: leak(file.texts.clone()),
        symbols,
    })
}

#[test]
fn large_steps_and_blocks() {
    let names: Vec<String> = (0..70_000).map(|n| format!("l{n}")).collect();
    let labels: Vec<&str> = names.iter().map(String::as_str).collect();
    let symbol = Symbol {
        name: "p".into(),
        text: String::new(),
        kind: Kind::Parameter,
        domain: vec![Domain::Universe; 2],
    };
    // Steps of the last label that fit in a byte and that do not; first labels of one, two and four bytes.
    let mut keys = Vec::new();
    for (a, b) in [
        (0, 0),
        (0, 1),
        (0, 252),
        (0, 600),
        (3, 69_999),
        (300, 5),
        (69_999, 0),
    ] {
        keys.extend([a, b]);
    }
    for n in 0..20_000 {
        keys.extend([69_999, n * 3 + 1]);
    }
    let len = keys.len() / 2;
    let value = |n: usize| Value::Number((n as f64).sin());
    let records = Records {
        len,
        keys,
        values: (0..len).map(value).collect(),
        texts: Vec::new(),
    };
    let contents = Contents {
        labels,
        texts: vec![""],
        acronyms: Vec::new(),
        symbols: vec![(symbol, records.clone())],
    };
    let bytes = write(&contents).expect("written");
    let file = File::open(&bytes).expect("read");
    assert_eq!(file.records(0).expect("read"), records);
}

#[test]
fn damaged_files_end_in_an_error() {
    for whole in [PLAIN, PACKED, RELAXED] {
        for n in 0..whole.len() {
            assert!(all(&whole[..n]).is_err(), "{n} bytes are enough");
        }
        let mut bytes = whole.to_vec();
        for n in 0..whole.len() {
            // Other data may come out, or an error; no panic, and no memory beyond the file's.
            for flip in [0x01, 0x80, 0xff] {
                bytes[n] ^= flip;
                let _ = all(&bytes);
                bytes[n] ^= flip;
            }
        }
    }
}

#[test]
fn what_a_file_cannot_hold_is_refused() {
    let long = "l".repeat(64);
    let value = |labels, v| {
        let symbol = Symbol {
            name: "p".into(),
            text: String::new(),
            kind: Kind::Parameter,
            domain: vec![Domain::Universe],
        };
        let records = Records {
            len: 1,
            keys: vec![0],
            values: vec![Value::Number(v)],
            texts: Vec::new(),
        };
        let contents = Contents {
            labels,
            texts: vec![""],
            acronyms: Vec::new(),
            symbols: vec![(symbol, records)],
        };
        write(&contents)
    };
    assert!(value(vec![&long], 1.0).is_err());
    assert!(value(vec!["a"], 1e300).is_err());
    assert!(value(vec!["a"], -1e305).is_ok());
}
