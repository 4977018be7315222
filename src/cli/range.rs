//! `bmod range`: in which intervals prices and solutions of a linear program hold.

use super::args::{EXECUTION, RangeArgs, TableFormat};
use super::derive::{studied, tell};
use crate::diag::Diagnostic;
use crate::formulation::derive::Primal;
use crate::formulation::page::{Block, Format, Page, write};
use crate::formulation::range::{Ranges, ranges};
use crate::formulation::side::short;
use crate::formulation::text::record;
use crate::model::origin::Blocks;
use crate::run::Machine;
use std::time::Instant;

/// Seconds that the linear programs of the ranges may take.
const SECONDS: f64 = 60.0;

/// Carries out `bmod range`; its exit status.
pub fn range(a: &RangeArgs) -> u8 {
    studied(&a.model, &a.solve, &a.chosen, &mut |m, primal, studied| {
        let no = |message: String| {
            Diagnostic::execution("E0433", studied.span, message).label("of this solve")
        };
        let solved = studied.answer.as_ref().map(|(_, a)| a.status);
        if primal.objective.is_none() || !primal.generated.instance.is_linear() {
            return Err(no("ranges belong to a linear program".into()).into());
        }
        if solved != Some(crate::solve::ModelStatus::Optimal) {
            return Err(
                no("ranges belong to an optimal answer, and there is none".into())
                    .help("`bmod why` says what is infeasible or unbounded")
                    .into(),
            );
        }
        let Some(r) = of(m, &primal, &a.names) else {
            return Err(no("there is no answer".into()).into());
        };
        match a.format {
            TableFormat::Text => tell(&write(&page(m, &primal, &r), Format::Text(100), "")),
            TableFormat::Csv => tell(&csv(m, &primal, &r)),
            TableFormat::Json => tell(&json(m, &primal, &r)),
        }
        if r.unfinished {
            eprintln!(
                "bmod: the time for ranges is used up; name the rows and columns that you mean"
            );
            return Ok(EXECUTION);
        }
        Ok(0)
    })
}

/// The ranges of a solved linear program; of these records or symbols only, if any are named.
pub fn of(m: &Machine, primal: &Primal, names: &[String]) -> Option<Ranges> {
    let answer = primal.answer.as_ref()?;
    let g = &primal.generated;
    let wanted = |blocks: &Blocks, i: usize| {
        if names.is_empty() {
            return true;
        }
        let b = blocks.of(i as u32);
        let symbol = &m.symbols.get(b.symbol).name;
        let whole = record(&m.store, symbol, b.key(i as u32));
        let plain = |t: &str| t.to_lowercase().replace(['\'', '"', ' '], "");
        names
            .iter()
            .any(|n| n.eq_ignore_ascii_case(symbol) || plain(n) == plain(&whole))
    };
    let begin = Instant::now();
    Some(ranges(
        &g.instance,
        &answer.level,
        &answer.activity,
        &|i| wanted(&g.origin.rows, i),
        &|j| wanted(&g.origin.columns, j),
        &|| begin.elapsed().as_secs_f64() < SECONDS,
    ))
}

fn names(m: &Machine, blocks: &Blocks, i: usize) -> String {
    let b = blocks.of(i as u32);
    record(&m.store, &m.symbols.get(b.symbol).name, b.key(i as u32))
}

/// Both tables.
pub fn page(m: &Machine, primal: &Primal, r: &Ranges) -> Page {
    let o = &primal.generated.origin;
    let mut out = Vec::new();
    let words = |list: &[&str]| list.iter().map(|t| (*t).to_string()).collect::<Vec<_>>();
    if !r.rows.is_empty() {
        out.push(Block::Heading(
            "Right-hand sides: what one unit is worth, and from where to where".into(),
        ));
        let rows = r.rows.iter().map(|r| {
            let numbers = [
                r.value,
                r.price[0],
                r.price[1],
                r.interval[0],
                r.interval[1],
            ];
            let mut row = vec![names(m, &o.rows, r.row)];
            row.extend(numbers.map(short));
            row
        });
        let head = words(&["row", "value", "price below", "price above", "from", "to"]);
        out.push(Block::Table(head, rows.collect()));
        let two = |r: &&crate::formulation::range::RowRange| r.price[0] != r.price[1];
        if r.rows.iter().any(|r| two(&r)) {
            out.push(Block::Words(
                "Where the two prices differ the vertex is degenerate: one unit less is not worth what one unit more is."
                    .into(),
            ));
        }
    }
    if !r.costs.is_empty() {
        out.push(Block::Heading(
            "Objective coefficients: from where to where the solution stays optimal".into(),
        ));
        let rows = r.costs.iter().map(|c| {
            let mut row = vec![names(m, &o.columns, c.column)];
            row.extend([c.level, c.value, c.interval[0], c.interval[1]].map(short));
            row
        });
        let head = words(&["column", "level", "coefficient", "from", "to"]);
        out.push(Block::Table(head, rows.collect()));
    }
    out
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
            names(m, &o.rows, r.row),
            r.value.to_string(),
            String::new(),
        ];
        cells.extend([r.price[0], r.price[1], r.interval[0], r.interval[1]].map(|x| x.to_string()));
        line(cells);
    }
    for c in &r.costs {
        let mut cells = vec!["column".into(), names(m, &o.columns, c.column)];
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
            "name": names(m, &o.rows, r.row), "value": number(r.value), "price_below": number(r.price[0]),
            "price_above": number(r.price[1]), "from": number(r.interval[0]), "to": number(r.interval[1]),
        })
    });
    let costs = r.costs.iter().map(|c| {
        serde_json::json!({
            "name": names(m, &o.columns, c.column), "value": number(c.value), "level": number(c.level),
            "from": number(c.interval[0]), "to": number(c.interval[1]),
        })
    });
    let all = serde_json::json!({
        "model": primal.name, "rows": rows.collect::<Vec<_>>(), "columns": costs.collect::<Vec<_>>(),
    });
    format!("{all:#}\n")
}
