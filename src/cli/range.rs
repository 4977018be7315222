//! `bmod range`: in which intervals prices and solutions of a linear program hold.

use super::args::{EXECUTION, RangeArgs, TableFormat};
use super::derive::{studied, tell, width};
use crate::formulation::derive::Primal;
use crate::formulation::page::{Format, write};
use crate::formulation::range::{Ranges, named, of, page};
use crate::run::Machine;

/// Carries out `bmod range`; its exit status.
pub fn range(a: &RangeArgs) -> u8 {
    studied(&a.model, &a.solve, &a.chosen, &mut |m, primal, studied| {
        let r = of(m, &primal, &studied, &a.names)?;
        match a.format {
            TableFormat::Text => tell(&write(&page(m, &primal, &r), Format::Text(width()), "")),
            TableFormat::Csv => tell(&csv(m, &primal, &r)),
            TableFormat::Json => tell(&json(m, &primal, &r)),
        }
        if r.unfinished {
            eprintln!(
                "bmod: some ranges are missing (their time is used up, or they are lost in rounding); name the rows and columns that you mean"
            );
            return Ok(EXECUTION);
        }
        Ok(0)
    })
}

fn csv(m: &Machine, primal: &Primal, r: &Ranges) -> String {
    let o = &primal.generated.origin;
    let mut w = csv::Writer::from_writer(Vec::new());
    let mut line = |cells: Vec<String>| {
        let _ = w.write_record(cells);
    };
    let head = [
        "kind",
        "name",
        "value",
        "level",
        "price_below",
        "price_above",
        "from",
        "to",
    ];
    line(head.map(String::from).to_vec());
    for r in &r.rows {
        let mut cells = vec![
            "row".into(),
            named(m, &o.rows, r.row),
            r.value.to_string(),
            String::new(),
        ];
        cells.extend([r.price[0], r.price[1], r.interval[0], r.interval[1]].map(|x| x.to_string()));
        line(cells);
    }
    for c in &r.costs {
        let mut cells = vec!["column".into(), named(m, &o.columns, c.column)];
        cells.extend([c.value, c.level].map(|x| x.to_string()));
        cells.extend([String::new(), String::new()]);
        cells.extend(c.interval.map(|x| x.to_string()));
        line(cells);
    }
    String::from_utf8(w.into_inner().unwrap_or_default()).unwrap_or_default()
}

fn json(m: &Machine, primal: &Primal, r: &Ranges) -> String {
    let o = &primal.generated.origin;
    // Infinite numbers are words, as in bmod's other reports.
    let number = |x: f64| match x.is_finite() {
        true => serde_json::json!(x),
        false if x > 0.0 => serde_json::json!("inf"),
        false if x < 0.0 => serde_json::json!("-inf"),
        false => serde_json::Value::Null,
    };
    let rows = r.rows.iter().map(|r| {
        serde_json::json!({
            "name": named(m, &o.rows, r.row), "value": number(r.value), "price_below": number(r.price[0]),
            "price_above": number(r.price[1]), "from": number(r.interval[0]), "to": number(r.interval[1]),
        })
    });
    let costs = r.costs.iter().map(|c| {
        serde_json::json!({
            "name": named(m, &o.columns, c.column), "value": number(c.value), "level": number(c.level),
            "from": number(c.interval[0]), "to": number(c.interval[1]),
        })
    });
    let all = serde_json::json!({
        "model": primal.name, "rows": rows.collect::<Vec<_>>(), "columns": costs.collect::<Vec<_>>(),
    });
    format!("{all:#}\n")
}
