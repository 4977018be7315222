//! `bmod range`: in which intervals prices and solutions of a linear program hold.

use super::args::{EXECUTION, RangeArgs, TableFormat};
use super::commands::{Status, complain};
use super::derive::{studied, tell, width};
use crate::formulation::derive::Primal;
use crate::formulation::page::{Format, write};
use crate::formulation::range::{Ranges, named, of, page};
use crate::report::study::comma_separated;
use crate::run::Machine;

/// Carries out `bmod range`; its exit status.
pub(super) fn range(a: &RangeArgs) -> Status {
    studied(&a.model, &a.solve, &a.chosen, &mut |m, primal, studied| {
        let r = of(m, &primal, &studied, &a.names)?;
        match a.format {
            TableFormat::Text => tell(&write(&page(m, &primal, &r), Format::Text(width()), "")),
            TableFormat::Csv => tell(&csv(m, &primal, &r)),
            TableFormat::Json => tell(&json(m, &primal, &r)),
        }
        let missing = "some ranges are missing (their time is used up, or they are lost in rounding); name the rows and columns that you mean";
        Ok(match r.unfinished {
            true => complain(EXECUTION, missing),
            false => 0,
        })
    })
}

fn csv(m: &Machine, primal: &Primal, r: &Ranges) -> String {
    let o = &primal.generated.origin;
    let head = "kind,name,value,level,price_below,price_above,from,to";
    let mut lines = vec![head.split(',').map(String::from).collect()];
    let mut line = |kind: &str, name: String, numbers: [Option<f64>; 6]| {
        let cells = numbers.map(|x| x.map_or(String::new(), |x| x.to_string()));
        lines.push([kind.into(), name].into_iter().chain(cells).collect());
    };
    for r in &r.rows {
        let ([below, above], [from, to]) = (r.price.map(Some), r.interval.map(Some));
        let numbers = [Some(r.value), None, below, above, from, to];
        line("row", named(m, &o.rows, r.row), numbers);
    }
    for c in &r.costs {
        let [from, to] = c.interval.map(Some);
        let numbers = [Some(c.value), Some(c.level), None, None, from, to];
        line("column", named(m, &o.columns, c.column), numbers);
    }
    comma_separated(&lines)
}

fn json(m: &Machine, primal: &Primal, r: &Ranges) -> String {
    let o = &primal.generated.origin;
    // Infinite numbers are words, as in bmod's other reports.
    let number = |x: f64| match x.is_finite() {
        true => serde_json::json!(x),
        false if x > 0.0 => serde_json::json!("+INF"),
        false if x < 0.0 => serde_json::json!("-INF"),
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
