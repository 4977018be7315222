//! `bmod report --html`: formulas, data, solution, ranges, figures and certificate on one page that needs nothing else.

use super::args::{EXECUTION, ReportArgs};
use super::commands::{Status, Task, carry_out, complain, name, stem, write_file};
use super::derive::study_options;
use super::host::Output;
use crate::check::symbols::{Symbol, SymbolKind};
use crate::data::universe::Label;
use crate::formulation::derive::Primal;
use crate::formulation::derived::Kind;
use crate::formulation::page::{Block, Page, STYLE, body};
use crate::formulation::render::plain;
use crate::formulation::side::short;
use crate::formulation::{explain, range, show, study};
use crate::model::origin::Blocks;
use crate::report::json::{RunStatus, SolveReport};
use crate::run::{Machine, Studied};
use std::fmt::Write;
use std::path::Path;

/// Records of a table that are shown.
const MAX_RECORDS: usize = 400;

/// Sorts a table by the column whose head is clicked.
const SCRIPT: &str = "document.querySelectorAll('table.sortable th').forEach((th,c)=>th.addEventListener('click',()=>{\
const t=th.closest('table'),n=[...th.parentNode.children].indexOf(th),b=t.tBodies[0],d=th.dataset.d=th.dataset.d==='1'?'-1':'1';\
const v=r=>{const x=r.cells[n].textContent.replace('−','-').replace('∞','Infinity'),f=parseFloat(x);return isNaN(f)?x:f};\
[...b.rows].sort((p,q)=>{const x=v(p),y=v(q);return d*(x<y?-1:x>y?1:0)}).forEach(r=>b.append(r))}));";

/// Carries out `bmod report`; its exit status.
pub(super) fn report(a: &ReportArgs) -> Status {
    // The figures are put on the page.
    let out = tempfile::tempdir();
    let out = out.map_err(|_| complain(EXECUTION, "no folder for temporary files"))?;
    let options = study_options(&a.solve, &a.chosen)?;
    let task = Task {
        out: Some(out.path()),
        ..Task::new(&a.model, Output::Quiet)
    };
    let mut studied = None;
    let mut text = String::new();
    let finished = carry_out(task, options, &mut |m| {
        if let Some((primal, s)) = study::primal(m) {
            text = sections(m, &primal, &s);
            studied = Some(s.number);
        }
    });
    if finished.end == RunStatus::Interrupted {
        return Ok(finished.end.exit());
    }
    let Some(number) = studied else {
        let status = finished.end.exit().max(EXECUTION);
        let file = name(&a.model);
        let message = format!("nothing is solved in {file}: there is nothing to report");
        return Err(complain(status, message));
    };
    let solves = &finished.report.solves;
    text.push_str(&certificate(solves.get(number - 1).or(solves.last())));
    text.push_str(&figures(out.path()));
    let title = stem(&a.model);
    let page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>{STYLE}\
         th{{cursor:pointer}}svg{{max-width:100%;height:auto}}</style>\n</head>\n<body>\n<h1>{0}</h1>\n{text}<script>{SCRIPT}</script>\n</body>\n</html>\n",
        plain(&title)
    );
    write_file(&a.html, page.as_bytes())?;
    Ok(finished.end.exit())
}

fn sections(m: &Machine, primal: &Primal, studied: &Studied) -> String {
    let (words, ranges) = explain::of(m, primal, studied);
    let mut page: Page = vec![Block::Heading("In words".into())];
    page.extend(words.into_iter().map(Block::Words));
    let chosen = show::Chosen::of(studied);
    page.extend(show::page(m, &m.code, &chosen, None).0);
    page.extend(data(m, primal));
    page.extend(solution(m, primal));
    if let Some(r) = &ranges {
        page.extend(range::page(m, primal, r));
    }
    let derived = |k: Kind| k.derive(m, primal, studied, false, false).ok();
    page.extend(
        [Kind::Dual, Kind::Kkt]
            .into_iter()
            .find_map(derived)
            .map_or(Vec::new(), |d| d.page),
    );
    body(&page)
}

/// The parameters that the equations read.
fn data(m: &Machine, primal: &Primal) -> Page {
    use crate::formulation::tree::{Expr, Source};
    let mut used = Vec::new();
    let mut see = |e: &Expr| {
        e.walk(&mut |e| {
            if let Expr::Data(Source::Parameter(p), _) = e {
                used.push(*p);
            }
        });
    };
    for e in &primal.equations {
        see(&e.left);
        see(&e.right);
        e.binder.conditions.iter().for_each(&mut see);
    }
    used.sort_unstable();
    used.dedup();
    let mut out = Vec::new();
    for p in used {
        let symbol = m.symbols.get(p);
        if !matches!(symbol.kind, SymbolKind::Parameter { .. }) {
            continue;
        }
        let table = m.store.table(symbol.table);
        let rows = table.iter().map(|(key, v)| (key, [v]));
        out.extend(records(m, symbol, ["value"], rows, table.len()));
    }
    out
}

/// The first records of a symbol, and how many more there are.
fn records<'a, const N: usize>(
    m: &Machine,
    symbol: &Symbol,
    columns: [&str; N],
    rows: impl Iterator<Item = (&'a [Label], [f64; N])>,
    count: usize,
) -> Page {
    let heading = match symbol.text.is_empty() {
        true => symbol.name.to_string(),
        false => format!("{}: {}", symbol.name, symbol.text),
    };
    let mut head = m.symbols.domain_names(symbol);
    head.extend(columns.map(String::from));
    let rows = rows.take(MAX_RECORDS).map(|(key, numbers)| {
        let labels = key.iter().map(|l| m.store.universe.name(*l).to_string());
        labels.chain(numbers.map(short)).collect()
    });
    let mut out = vec![Block::Heading(heading), Block::Table(head, rows.collect())];
    if count > MAX_RECORDS {
        let more = count - MAX_RECORDS;
        out.push(Block::Words(format!("… and {more} more")));
    }
    out
}

/// Levels, bounds and marginals.
fn solution(m: &Machine, primal: &Primal) -> Page {
    let Some(a) = &primal.answer else {
        return Vec::new();
    };
    let g = &primal.generated;
    let c = &g.instance.columns;
    let mut out = Vec::new();
    let mut tables = |blocks: &Blocks, head: [&str; 4], numbers: &dyn Fn(usize) -> [f64; 4]| {
        for b in &blocks.list {
            let symbol = m.symbols.get(b.symbol);
            let rows = (b.start..b.start + b.len).map(|i| (b.key(i), numbers(i as usize)));
            out.extend(records(m, symbol, head, rows, b.len as usize));
        }
    };
    let head = ["lower", "level", "upper", "marginal"];
    tables(&g.origin.columns, head, &|j| {
        [c.lower[j], a.level[j], c.upper[j], a.column_marginal[j]]
    });
    let head = ["level", "right side", "slack", "marginal"];
    tables(&g.origin.rows, head, &|i| {
        let (level, rhs) = (a.activity[i], g.instance.rows.rhs[i]);
        [level, rhs, (level - rhs).abs(), a.row_marginal[i]]
    });
    out
}

/// How the solve ended, and how well.
fn certificate(solve: Option<&SolveReport>) -> String {
    let Some(s) = solve else { return String::new() };
    let text = crate::report::summary::solve(s, false);
    format!(
        "<h2>Certificate and times</h2>\n<pre>{}</pre>\n",
        plain(&text)
    )
}

/// The figures that the model drew.
fn figures(folder: &Path) -> String {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<_> = entries.map(|f| f.path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "svg"));
    files.sort();
    let mut out = String::new();
    for f in files {
        let Ok(svg) = std::fs::read_to_string(&f) else {
            continue;
        };
        // The XML declaration has no place inside a page.
        let svg = svg.find("<svg").map_or("", |at| &svg[at..]);
        let name = f.file_name().unwrap_or_default().to_string_lossy();
        let _ = writeln!(out, "<h2>{}</h2>\n{svg}", plain(&name));
    }
    out
}
