//! Tests of the reader of data.

use super::*;

fn all(text: &str, kind: DataKind) -> Vec<String> {
    fn part(p: &KeyPart<'_>) -> String {
        match p {
            KeyPart::Label {
                text, quoted: true, ..
            } => format!("'{text}'"),
            KeyPart::Label { text, .. } => (*text).to_owned(),
            KeyPart::Range { from, to, .. } => format!("{from}*{to}"),
            KeyPart::AllOf { set, .. } => format!("#{set}"),
            KeyPart::Universe(_) => "*".into(),
            KeyPart::Factor(x) => x.to_string(),
            KeyPart::Matched(a, b) => {
                let key = |k: &[KeyPart<'_>]| k.iter().map(part).collect::<Vec<_>>().join(".");
                format!("{}:{}", key(a), key(b))
            }
            KeyPart::Group(g) => format!(
                "({})",
                g.iter().map(|k| key(k)).collect::<Vec<_>>().join(",")
            ),
        }
    }
    fn key(k: &[KeyPart<'_>]) -> String {
        k.iter().map(part).collect::<Vec<_>>().join(".")
    }
    let mut r = DataReader::new(text, 0, kind, false);
    let mut out = Vec::new();
    while let Some(x) = r.next() {
        out.push(match x {
            Ok(r) => {
                let tail = match &r.value {
                    Tail::None => String::new(),
                    Tail::Number(x, _) => format!("={x}"),
                    Tail::Text(t, _) => format!(" \"{t}\""),
                    Tail::Name(n, _) => format!("~{n}"),
                };
                format!("{}{tail}", key(r.key))
            }
            Err(d) => format!("!{}", d.code),
        });
    }
    out
}

#[test]
fn sets() {
    let read = |t| all(t, DataKind::Set);
    assert_eq!(
        read(" a  first one, b 'the second',\n'c d'   it's third\n"),
        [
            "a \"first one\"",
            "b \"the second\"",
            "'c d' \"it's third\""
        ]
    );
    assert_eq!(
        read("i1*i10, 1990*1992, 't 1'*'t 3'"),
        ["i1*i10", "1990*1992", "t 1*t 3"]
    );
    assert_eq!(
        read("a.b, c.(d,e) two, (f,g*h).(i.j,k), p . q"),
        ["a.b", "c.(d,e) \"two\"", "(f,g*h).(i.j,k)", "p.q"]
    );
    assert_eq!(
        read("#i.#j, set.set, k.set, a-1, b+2"),
        ["#i.#j", "#set", "#k", "a-1", "b+2"]
    );
    assert_eq!(read("#a:#b, (x,y):(u,v)"), ["#a:#b", "(x,y):(u,v)"]);
    assert_eq!(read("a (x=y) $ %;\nb"), ["a \"(x=y) $ %;\"", "b"]);
    assert_eq!(read("a%b, c"), ["!E0243", "c"]);
    assert_eq!(read(""), Vec::<String>::new());
}

#[test]
fn values() {
    let read = |t| all(t, DataKind::Values);
    assert_eq!(read(" 5 "), ["=5"]);
    assert_eq!(read("-.5e1"), ["=-5"]);
    assert_eq!(read("- 5"), ["=-5"]);
    assert_eq!(read("inf"), ["=inf"]);
    assert_eq!(read("1990 5\n1991 6.5"), ["1990=5", "1991=6.5"]);
    assert_eq!(read("a mon, b +inf, c yes"), ["a~mon", "b=inf", "c=1"]);
    assert_eq!(read("a 1x, b 2"), ["!E0245", "b=2"]);
    assert_eq!(read("1.2.3 4"), ["1.2.3=4"]);
    assert_eq!(read("a\n 7"), ["a=7"]);
    let mut one = DataReader::new("a .5", 0, DataKind::Values, false).with_arity(1);
    match one.next() {
        Some(Ok(r)) => assert!(matches!(r.value, Tail::Number(0.5, _))),
        other => panic!("{other:?}"),
    }
    assert_eq!(read("i1*i3 4"), ["i1*i3=4"]);
    assert_eq!(read("(a,b 2"), ["!E0241"]);
}

/// Records as text, with places; `plainly`: those that can be read by [`DataReader::plain`] are.
fn records(text: &str, kind: DataKind, arity: usize, plainly: bool) -> Vec<String> {
    let mut r = DataReader::new(text, 7, kind, false).with_arity(arity);
    let mut out = Vec::new();
    loop {
        let mut labels: Vec<&str> = Vec::new();
        let label = |p: usize, text| {
            labels.truncate(p);
            labels.push(text);
            plainly && text != "b"
        };
        if let Some((x, span)) = r.plain(label) {
            out.push(match kind {
                DataKind::Values => format!("{labels:?} {:x} {span:?}", x.to_bits()),
                DataKind::Set => format!("{labels:?} {:?} {span:?}", Tail::None),
            });
            continue;
        }
        out.push(match r.next() {
            None => return out,
            Some(Err(d)) => format!("{d:?}"),
            Some(Ok(r)) => {
                let label = |p: &KeyPart<'_>| match p {
                    KeyPart::Label { text, .. } => (*text).to_owned(),
                    p => format!("{p:?}"),
                };
                let key: Vec<String> = r.key.iter().map(label).collect();
                match &r.value {
                    Tail::Number(x, _) => {
                        format!("{key:?} {:x} {:?}", x.to_bits(), r.span)
                    }
                    value => format!("{key:?} {value:?} {:?}", r.span),
                }
            }
        });
    }
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(4000))]
    /// The short way reads what the long way reads.
    #[test]
    fn plain_records_are_records(
        text in proptest::collection::vec(
            proptest::sample::select(vec![
                "a", "b", "i1", "set", ".", ".", ".", " ", " ", "1", "2.5", "0", "1e400", "1e-400", "e", "-", "+", ",",
                "\n", "\n", "'q r'", "(", ")", "*", ":", "=", "#", "inf", "é", "\u{1e}", "a.i1 3\n", "a 4,", "i1.a.a -2",
                "'a'", "'a'.\"b c\" 7\n", "a . i1", "\n\u{1e}a,i1,5\n", "\n\u{1e}'a b' , -3\n", "i1.a\n", "a,",
            ]),
            0..14,
        ),
        arity in 1usize..4,
        kind in proptest::sample::select(vec![DataKind::Set, DataKind::Values]),
    ) {
        let text = text.concat();
        proptest::prop_assert_eq!(records(&text, kind, arity, true), records(&text, kind, arity, false));
    }
}

#[test]
fn special_values() {
    let value = |t: &str| {
        let text = format!("a {t}");
        let mut r = DataReader::new(&text, 0, DataKind::Values, true);
        match r.next() {
            Some(Ok(Record {
                value: Tail::Number(x, _),
                ..
            })) => x,
            other => panic!("{other:?}"),
        }
    };
    use crate::data::value::*;
    assert!(is_eps(value("eps")) && is_eps(value("1e-400")));
    assert!(is_na(value("NA")) && is_undf(value("undf")) && is_undf(value("1e400")));
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(4000))]
    /// Numbers read the short way are those of the library, to the last bit.
    #[test]
    fn short_numbers_are_exact(whole in 0u64..1_000_000_000, decimals in 0u64..100_000_000_000, zeros in 0usize..5, width in 0usize..12, behind in "[ ,\n]?") {
        let fraction = format!("{}{decimals}", "0".repeat(zeros));
        let fraction = &fraction[..width.min(fraction.len())];
        let text = if fraction.is_empty() { whole.to_string() } else { format!("{whole}.{fraction}") };
        let (x, end) = plain_number(&format!("-{text}{behind}"), 0).expect("a number");
        proptest::prop_assert_eq!(end, text.len() + 1);
        proptest::prop_assert_eq!((-x).to_bits(), text.parse::<f64>().expect("a number").to_bits());
    }
}
