//! Tests of the reader of data.

use super::*;

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
