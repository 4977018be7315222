//! Claims about a run that stand in the model's own comments, `*= x.l('a') 4`: for a lecturer's exercises, a user's regression
//! tests (`bmod test`), and the language suite of the project.

use crate::check::functions::stored_attribute;
use crate::check::symbols::SymbolKind;
use crate::data::value;
use crate::run::Machine;

/// A claim about a value after the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// Line of the text, from 1.
    pub line: usize,
    /// What has the value: `p('a')`, `x.l('a')`, `m.modelstat`, `card(p)`.
    pub what: String,
    /// The value, as [`same`] reads it.
    pub value: String,
}

/// The claims `*= NAME VALUE` of a text.
pub fn claims(text: &str) -> Vec<Claim> {
    let lines = text.lines().enumerate();
    lines
        .filter_map(|(n, l)| {
            let (what, value) = l
                .strip_prefix("*=")?
                .trim()
                .rsplit_once(char::is_whitespace)?;
            Some(Claim {
                line: n + 1,
                what: what.trim().to_string(),
                value: value.to_string(),
            })
        })
        .collect()
}

/// The claims of a text that do not hold after its run, each with the value that is there.
pub fn broken<'c>(
    machine: &mut Machine,
    claims: &'c [Claim],
    tolerance: f64,
) -> Vec<(&'c Claim, String)> {
    let mut out = Vec::new();
    for claim in claims {
        match value_of(machine, &claim.what) {
            Some(v) if same(v, &claim.value, tolerance) => {}
            Some(v) => out.push((claim, spelled(v))),
            None => out.push((claim, "not there".to_string())),
        }
    }
    out
}

/// Labels in quotes between parentheses.
fn labels(text: &str) -> Vec<String> {
    let mut out = Vec::new();
    let mut rest = text;
    while let Some(start) = rest.find(['\'', '"']) {
        let quote = &rest[start..=start];
        let inner = &rest[start + 1..];
        let Some(end) = inner.find(quote) else { break };
        out.push(inner[..end].to_string());
        rest = &inner[end + 1..];
    }
    out
}

/// `x.l('a')` as the run left it; None where there is no such thing.
pub fn value_of(m: &mut Machine, what: &str) -> Option<f64> {
    let (head, key) = match what.split_once('(') {
        Some((h, k)) => (h.trim(), k),
        None => (what.trim(), ""),
    };
    if head.eq_ignore_ascii_case("card") {
        let s = m.symbols.find(key.trim_end_matches(')').trim())?;
        return Some(m.store.table(m.symbols.get(s).table).len() as f64);
    }
    let (name, attr) = match head.split_once('.') {
        Some((n, a)) => (n, Some(a.to_lowercase())),
        None => (head, None),
    };
    let s = m.symbols.find(name)?;
    let symbol = m.symbols.get(s);
    if let SymbolKind::Model(_) = symbol.kind {
        return Some(
            m.models
                .get(&s)
                .and_then(|x| x.get(&attr?))
                .unwrap_or(value::NA),
        );
    }
    let offset = match attr.as_deref() {
        None => 0,
        Some(name) => stored_attribute(name)?,
    };
    let table = symbol.table + offset;
    let keys: Option<Vec<u32>> = labels(key)
        .iter()
        .map(|l| m.store.universe.get(l))
        .collect();
    let table = m.store.table(table);
    match keys {
        Some(k) if k.len() == table.dim() => Some(table.get(&k)),
        Some(_) => None,
        // No such label: not stored.
        None => Some(table.default_value()),
    }
}

/// Whether a value is the one that is claimed: a number within a relative tolerance (absolute below 1), `eps`, `na`, `undf`,
/// `inf`, `-inf`, or `yes`, `no` for membership.
pub fn same(actual: f64, claimed: &str, tolerance: f64) -> bool {
    match claimed {
        "eps" => value::is_eps(actual),
        "na" => value::is_na(actual),
        "undf" => value::is_undf(actual),
        "inf" => actual == f64::INFINITY,
        "-inf" => actual == f64::NEG_INFINITY,
        "yes" => actual != 0.0,
        "no" => actual == 0.0,
        number => match number.parse::<f64>() {
            Ok(x) => actual.is_finite() && (actual - x).abs() <= tolerance * x.abs().max(1.0),
            Err(_) => false,
        },
    }
}

/// A value as a claim spells it.
pub fn spelled(v: f64) -> String {
    match v {
        v if value::is_eps(v) => "eps".into(),
        v if value::is_na(v) => "na".into(),
        v if v.is_nan() => "undf".into(),
        v => v.to_string(),
    }
}
