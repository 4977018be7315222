//! Ranges of a solve, as a page.

use super::derive::Primal;
use super::derived::{discrete, of_relaxation, of_solve};
use super::page::{Block, Page};
use super::side::short;
use crate::diag::Diagnostic;
use crate::model::origin::Blocks;
use crate::run::{Machine, Studied};
use crate::solve::ModelStatus;
use crate::solve::range::ranges;

pub use crate::solve::range::{Ranges, RowRange};

/// Seconds that the linear programs of the ranges may take.
const SECONDS: f64 = 60.0;

/// The ranges of a solved linear program; of these records or symbols only, if any are named.
///
/// # Errors
/// If the model is not linear, or has no optimal answer.
pub fn of(
    m: &Machine,
    primal: &Primal,
    studied: &Studied,
    names: &[String],
) -> Result<Ranges, Box<Diagnostic>> {
    let no = |message: &str| of_solve("E0433", studied, message);
    let instance = &primal.generated.instance;
    if primal.objective.is_none() {
        return Err(no("ranges belong to a linear program, and there is no objective").into());
    }
    if let Some(i) = instance.nonlinear_rows().iter().position(|curved| *curved) {
        let name = named(m, &primal.generated.origin.rows, i);
        let message = format!("ranges need a linear program, and {name} is not linear");
        let help = "the marginals say what a little more on a right side is worth; `bmod explain` puts them into words";
        return Err(no(&message).help(help).into());
    }
    if let Some((_, name)) = discrete(m, primal) {
        let message = format!("ranges belong to a linear program, and {name} is discrete");
        return Err(no(&message).help(of_relaxation(primal)).into());
    }
    let solved = studied.answer.as_ref().map(|(_, a)| a.status);
    let answer = primal.answer.as_ref();
    let Some(answer) = answer.filter(|_| solved == Some(ModelStatus::Optimal)) else {
        let refusal = no("ranges belong to an optimal answer, and there is none");
        return Err(refusal
            .help("`bmod why` says what is infeasible or unbounded")
            .into());
    };
    let g = &primal.generated;
    let is = |name: &String, blocks: &Blocks, i: usize| {
        let symbol = &m.symbols.get(blocks.of(i as u32).symbol).name;
        let whole = || named(m, blocks, i);
        let plain = |t: &str| t.to_lowercase().replace(['\'', '"', ' '], "");
        name.eq_ignore_ascii_case(symbol) || plain(name) == plain(&whole())
    };
    let wanted =
        |blocks: &Blocks, i: usize| names.is_empty() || names.iter().any(|n| is(n, blocks, i));
    let (rows, columns) = (&g.origin.rows, &g.origin.columns);
    let known = |n: &&String| {
        let found = |blocks, count| (0..count).any(|i| is(n, blocks, i));
        found(rows, g.instance.row_count()) || found(columns, g.instance.column_count())
    };
    if let Some(name) = names.iter().find(|n| !known(n)) {
        let blocks = rows.list.iter().chain(&columns.list);
        let all: Vec<&str> = blocks.map(|b| &*m.symbols.get(b.symbol).name).collect();
        let message = format!(
            "no row or column is called `{name}`; there are {}",
            all.join(", ")
        );
        return Err(no(&message).into());
    }
    let begin = m.elapsed();
    Ok(ranges(
        &g.instance,
        &answer.level,
        &answer.activity,
        &|i| wanted(&g.origin.rows, i),
        &|j| wanted(&g.origin.columns, j),
        &|| m.elapsed() - begin < SECONDS,
    ))
}

/// The name of a row or column.
pub fn named(m: &Machine, blocks: &Blocks, i: usize) -> String {
    m.origin_name(blocks, i)
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
            let ([below, above], [from, to]) = (r.price, r.interval);
            let mut row = vec![named(m, &o.rows, r.row)];
            row.extend([r.value, below, above, from, to].map(short));
            row
        });
        let head = words(&["row", "value", "price below", "price above", "from", "to"]);
        out.push(Block::Table(head, rows.collect()));
        let two = |r: &&RowRange| r.price[0] != r.price[1];
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
            let mut row = vec![named(m, &o.columns, c.column)];
            row.extend([c.level, c.value, c.interval[0], c.interval[1]].map(short));
            row
        });
        let head = words(&["column", "level", "coefficient", "from", "to"]);
        out.push(Block::Table(head, rows.collect()));
    }
    out
}
