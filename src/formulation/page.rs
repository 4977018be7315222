//! A formulation as a page: headings, formulas, legends and tables, as text, LaTeX or HTML.

use super::math::{Math, explained, name, symbol_name};
use super::names::Names;
use super::render::{
    LINE, latex, latex_lines, latex_words, mathml, mathml_lines, plain, text, wrapped,
};
use super::tree::*;
use super::{Formulation, Origin, Sign};
use crate::check::node::SymbolId;
use crate::check::symbols::{SymbolKind, Symbols, UNIVERSE};
use std::fmt::Write;

pub use super::math::Setter;

/// How a page is written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Format {
    /// For a terminal of so many characters.
    Text(usize),
    /// LaTeX with amsmath.
    Latex,
    /// HTML with MathML.
    Html,
}

/// One formula with what belongs to it.
#[derive(Clone, Debug)]
pub struct Formula {
    /// The name of its equation.
    pub name: String,
    /// The formula.
    pub math: Math,
    /// What it runs over.
    pub runs: Option<Math>,
    /// Words beside it.
    pub words: String,
    /// One of its rows written out: name and formula.
    pub example: Option<(String, Math)>,
}

impl Formula {
    /// A formula alone.
    pub fn of(math: Math) -> Self {
        Self {
            name: String::new(),
            math,
            runs: None,
            words: String::new(),
            example: None,
        }
    }
}

/// A part of a page.
#[derive(Clone, Debug)]
pub enum Block {
    /// A heading.
    Heading(String),
    /// A sentence.
    Words(String),
    /// Formulas, aligned.
    Formulas(Vec<Formula>),
    /// Symbols with words, and units.
    Legend(Vec<(Math, String, String)>),
    /// A table of formulas and words.
    Pairs([String; 2], Vec<(Math, Math)>),
    /// A table of words: head and rows.
    Table(Vec<String>, Vec<Vec<String>>),
}

/// A page.
pub type Page = Vec<Block>;

/// The parts of a formulation: objective, rows, variables with their signs.
pub fn formulas(s: &mut Setter, f: &Formulation) -> Page {
    let symbols = s.scope.symbols;
    let mut out = Vec::new();
    if let Some((sense, e)) = &f.objective {
        let word = match sense {
            Sense::Minimize => "minimize",
            Sense::Maximize => "maximize",
        };
        let math = s.expr(e);
        out.push(Block::Formulas(vec![Formula {
            name: word.into(),
            ..Formula::of(math)
        }]));
        if !f.rows.is_empty() {
            out.push(Block::Words("subject to".into()));
        }
    }
    let rows = f.rows.iter().map(|r| {
        let (math, runs) = s.row(r);
        Formula {
            name: r.name.clone(),
            runs,
            words: explained(&r.text).1.to_string(),
            ..Formula::of(math)
        }
    });
    let rows: Vec<Formula> = rows.collect();
    out.push(Block::Formulas(rows));
    let signs: Vec<Formula> = f
        .multipliers
        .iter()
        .enumerate()
        .map(|(n, m)| {
            let base = over_domain(symbols, s.variable(Variable::Multiplier(n)), &m.domain);
            let named = |s: SymbolId| symbols.get(s).name.to_string();
            let words = match m.origin {
                Origin::Row(e) => format!("multiplier of {}", named(e)),
                Origin::Lower(v) => format!("multiplier of the lower bounds of {}", named(v)),
                Origin::Upper(v) => format!("multiplier of the upper bounds of {}", named(v)),
                Origin::Fixed(v) => format!("multiplier of the fixed values of {}", named(v)),
                Origin::Missing(v) => {
                    format!(
                        "has no effect: {} has no bound where it stands in no row",
                        named(v)
                    )
                }
                Origin::Point(v) => format!("stands for {} in the gradient", named(v)),
            };
            Formula {
                words,
                ..Formula::of(signed(base, m.sign))
            }
        })
        .collect();
    if !signs.is_empty() {
        out.push(Block::Words("with".into()));
        out.push(Block::Formulas(signs));
    }
    out
}

/// A symbol with the sets that it runs over as indices.
pub fn over_domain(symbols: &Symbols, base: Math, domain: &[SymbolId]) -> Math {
    if domain.is_empty() {
        return base;
    }
    let again = |n: usize| domain[n] != UNIVERSE && domain[..n].contains(&domain[n]);
    let sets: Vec<Math> = match (0..domain.len()).any(again) {
        false => domain
            .iter()
            .map(|s| Math::Name(symbol_name(symbols, *s)))
            .collect(),
        // The same set twice: with the names that two indices over it have, it does not read as the diagonal.
        true => {
            let mut indices = Indices::default();
            let each: Vec<IndexId> = domain.iter().map(|s| indices.add(*s)).collect();
            let taken = symbols.iter().map(|(_, s)| s.name.to_lowercase()).collect();
            let mut names = Names::new(symbols, &indices, taken);
            names.enter(&each);
            each.iter()
                .map(|k| Math::Name(name(names.of(*k))))
                .collect()
        }
    };
    Math::Indexed(Box::new(base), sets)
}

/// With the sign that it has.
pub fn signed(m: Math, sign: Sign) -> Math {
    let zero = |sign| vec![Math::Operator(sign), Math::Number("0".into())];
    let mut row = vec![m];
    row.extend(match sign {
        Sign::Free => vec![Math::Words(" free".into())],
        Sign::Positive => zero("≥"),
        Sign::Negative => zero("≤"),
    });
    Math::Row(row)
}

/// The user's symbols in a formulation with their explanatory texts: sets, data, variables.
pub fn legend<'a>(
    symbols: &Symbols,
    f: &Formulation,
    more: impl Iterator<Item = &'a Expr>,
) -> Page {
    let mut used: Vec<SymbolId> = f.own.clone();
    let mut see = |e: &Expr| {
        e.walk(&mut |e| match e {
            Expr::Data(Source::Parameter(s) | Source::Attribute(s, _), _)
            | Expr::Member(s, _)
            | Expr::Card(s)
            | Expr::Variable(Variable::Own(s), _) => used.push(*s),
            Expr::Aggregate(_, d, _) => {
                used.extend(d.indices.iter().map(|k| f.indices.set[*k]));
            }
            _ => {}
        });
    };
    for r in &f.rows {
        see(&r.left);
        see(&r.right);
        r.binder.conditions.iter().for_each(&mut see);
    }
    if let Some((_, e)) = &f.objective {
        see(e);
    }
    more.for_each(&mut see);
    for r in &f.rows {
        used.extend(r.binder.indices.iter().map(|k| f.indices.set[*k]));
    }
    used.sort_unstable();
    used.dedup();
    let mut out = Vec::new();
    for (title, pick) in [("Sets", 0), ("Data", 1), ("Variables", 2)] {
        let kind = |s: &SymbolId| match symbols.get(*s).kind {
            SymbolKind::Set { .. } | SymbolKind::Alias(_) => 0,
            SymbolKind::Parameter { .. } => 1,
            _ => 2,
        };
        let rows: Vec<(Math, String, String)> = used
            .iter()
            .filter(|s| **s != 0 && kind(s) == pick)
            .map(|&s| entry(symbols, s))
            .collect();
        if !rows.is_empty() {
            out.push(Block::Heading(title.into()));
            out.push(Block::Legend(rows));
        }
    }
    out
}

fn entry(symbols: &Symbols, s: SymbolId) -> (Math, String, String) {
    let symbol = symbols.get(s);
    let (_, words, unit) = explained(&symbol.text);
    let base = Math::Name(symbol_name(symbols, s));
    let domain: Vec<String> = symbols.domain_names(symbol);
    let is_set = symbol.is_set();
    let plain = domain.is_empty() || is_set && domain == ["*"];
    let math = match plain || matches!(symbol.kind, SymbolKind::Alias(_)) {
        true => base,
        false => {
            let parts = domain.iter().map(|d| Math::Name(name(d))).collect();
            Math::Indexed(Box::new(base), parts)
        }
    };
    let words = match symbol.kind {
        SymbolKind::Alias(root) => format!("another index over {}", symbols.get(root).name),
        _ => words.to_string(),
    };
    (math, words, unit.unwrap_or_default().to_string())
}

/// Writes a page.
pub fn write(page: &Page, format: Format, title: &str) -> String {
    match format {
        Format::Text(width) => as_text(page, width),
        Format::Latex => as_latex(page, title),
        Format::Html => as_html(page, title),
    }
}

fn as_text(page: &Page, width: usize) -> String {
    let mut out = String::new();
    for b in page {
        match b {
            Block::Heading(t) => {
                let gap = if out.is_empty() { "" } else { "\n" };
                let _ = writeln!(out, "{gap}{t}\n{}", "─".repeat(t.chars().count()));
            }
            Block::Words(t) => {
                let _ = writeln!(out, "{}", filled(t, width));
            }
            Block::Formulas(list) => formulas_text(&mut out, list, width),
            Block::Legend(rows) => {
                let rows: Vec<(String, &String, &String)> =
                    rows.iter().map(|r| (text(&r.0), &r.1, &r.2)).collect();
                let w = rows.iter().map(|r| r.0.chars().count()).max().unwrap_or(0);
                for (symbol, words, unit) in rows {
                    let unit = match unit.is_empty() {
                        true => String::new(),
                        false => format!(" [{unit}]"),
                    };
                    let line = format!("  {symbol:w$}  {words}{unit}");
                    let _ = writeln!(out, "{}", line.trim_end());
                }
            }
            Block::Pairs(head, rows) => {
                let rows: Vec<[String; 2]> = rows.iter().map(|(a, b)| [text(a), text(b)]).collect();
                let all = || std::iter::once(head).chain(&rows);
                let longest = all().map(|r| r[0].chars().count()).max();
                let w = longest.unwrap_or(0).min(width / 2);
                for r in all() {
                    let _ = writeln!(out, "  {:w$}  │ {}", r[0], r[1]);
                }
            }
            Block::Table(head, rows) => table_text(&mut out, head, rows),
        }
    }
    out
}

fn formulas_text(out: &mut String, list: &[Formula], width: usize) {
    let names = list.iter().map(|f| f.name.chars().count());
    let w = names.max().unwrap_or(0);
    for f in list {
        let indent = if w == 0 { 2 } else { w + 4 };
        let body = wrapped(&f.math, width, indent);
        let mut line = match w {
            0 => format!("  {body}"),
            _ => format!("  {:w$}  {body}", f.name),
        };
        if let Some(r) = &f.runs {
            let runs = format!("for all {}", text(r));
            let last = line.rsplit('\n').next().unwrap_or_default().chars().count();
            if last + 3 + runs.chars().count() <= width {
                line.push_str(&format!("   {runs}"));
            } else {
                let blanks = " ".repeat(indent + 2);
                let room = width.saturating_sub(indent + 2);
                for runs in filled(&runs, room).lines() {
                    line.push_str(&format!("\n{blanks}{runs}"));
                }
            }
        }
        if !f.words.is_empty() && f.name.is_empty() {
            line.push_str(&format!("   {}", f.words));
        }
        let _ = writeln!(out, "{line}");
        if let Some((name, math)) = &f.example {
            let head = format!("{}{name}: ", " ".repeat(indent));
            let at = head.chars().count();
            let _ = writeln!(out, "{head}{}", wrapped(math, width, at.min(indent + 4)));
        }
    }
}

fn table_text(out: &mut String, head: &[String], rows: &[Vec<String>]) {
    let all = || std::iter::once(head).chain(rows.iter().map(Vec::as_slice));
    let widths: Vec<usize> = (0..head.len())
        .map(|c| {
            let cells = all().filter_map(|r| r.get(c));
            cells.map(|t| t.chars().count()).max().unwrap_or(0)
        })
        .collect();
    for r in all() {
        let cells = r.iter().zip(&widths).enumerate().map(|(n, (t, w))| {
            let number = t.starts_with(|c: char| c.is_ascii_digit() || "-−+∞".contains(c));
            match n > 0 && number {
                true => format!("{t:>w$}"),
                false => format!("{t:w$}"),
            }
        });
        let line = cells.collect::<Vec<_>>().join("  ");
        let _ = writeln!(out, "  {}", line.trim_end());
    }
}

/// Words in lines of at most `width` characters.
pub fn filled(t: &str, width: usize) -> String {
    let mut out = String::new();
    let mut column = 0;
    for word in t.split_whitespace() {
        let n = word.chars().count();
        if column > 0 && column + 1 + n > width {
            out.push('\n');
            column = 0;
        } else if column > 0 {
            out.push(' ');
            column += 1;
        }
        out.push_str(word);
        column += n;
    }
    out
}

fn as_latex(page: &Page, title: &str) -> String {
    let mut out = String::from(
        "\\documentclass{article}\n\\usepackage[utf8]{inputenc}\n\\usepackage{amsmath}\n\\allowdisplaybreaks\n\
         \\addtolength{\\textwidth}{3cm}\\addtolength{\\oddsidemargin}{-1.5cm}\n\\begin{document}\n",
    );
    let _ = writeln!(out, "\\section*{{{}}}", latex_words(title));
    for b in page {
        match b {
            Block::Heading(t) => {
                let _ = writeln!(out, "\\subsection*{{{}}}", latex_words(t));
            }
            Block::Words(t) => {
                let _ = writeln!(out, "{}\n", latex_words(t));
            }
            Block::Formulas(list) => {
                if list.is_empty() {
                    continue;
                }
                out.push_str("\\begin{align*}\n");
                let names = list.iter().map(|f| f.name.chars().count());
                let room = LINE.saturating_sub(names.max().unwrap_or(0));
                for (n, f) in list.iter().enumerate() {
                    let words = match f.name.is_empty() && !f.words.is_empty() {
                        true => format!(" && \\text{{{}}}", latex_words(&f.words)),
                        false => String::new(),
                    };
                    let example = match &f.example {
                        Some((name, math)) => format!(
                            " \\\\\n&\\text{{{}: }} {}",
                            latex_words(name),
                            latex_lines(math, room, None)
                        ),
                        None => String::new(),
                    };
                    let end = if n + 1 < list.len() { " \\\\" } else { "" };
                    let _ = writeln!(
                        out,
                        "\\text{{{}}} \\quad & {}{words}{example}{end}",
                        latex_words(&f.name),
                        latex_lines(&f.math, room, f.runs.as_ref()),
                    );
                }
                out.push_str("\\end{align*}\n");
            }
            Block::Legend(rows) => {
                let cells = rows.iter().map(|(m, words, unit)| {
                    let words = [words, unit].map(|t| latex_words(t));
                    [vec![format!("${}$", latex(m))], words.to_vec()].concat()
                });
                tabular(&mut out, "lll", &[], cells.collect());
            }
            Block::Pairs(head, rows) => {
                let cell = |m| format!("${}$", latex(m));
                let cells = rows.iter().map(|(a, b)| vec![cell(a), cell(b)]);
                tabular(&mut out, "l|l", head, cells.collect());
            }
            Block::Table(head, rows) => {
                let cells = rows
                    .iter()
                    .map(|r| r.iter().map(|t| latex_words(t)).collect());
                tabular(&mut out, &"l".repeat(head.len()), head, cells.collect());
            }
        }
    }
    out.push_str("\\end{document}\n");
    out
}

/// A table, in as many as fit on pages.
fn tabular(out: &mut String, columns: &str, head: &[String], rows: Vec<Vec<String>>) {
    const ROWS: usize = 40;
    let head: Vec<String> = head.iter().map(|t| latex_words(t)).collect();
    for rows in rows.chunks(ROWS) {
        let _ = writeln!(out, "\\noindent\\begin{{tabular}}{{{columns}}}");
        if !head.is_empty() {
            let _ = writeln!(out, "{} \\\\ \\hline", head.join(" & "));
        }
        for r in rows {
            let _ = writeln!(out, "{} \\\\", r.join(" & "));
        }
        out.push_str("\\end{tabular}\n\n");
    }
}

/// The look of a page that stands alone; also of `bmod report`.
pub const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#1b1b1b}\
h1{font-size:1.6em}h2{font-size:1.15em;margin:1.6em 0 .4em;border-bottom:1px solid #ccc}\
table{border-collapse:collapse;margin:.5em 0}td,th{padding:.15em 1em .15em 0;text-align:left;vertical-align:baseline}\
th{font-weight:600;border-bottom:1px solid #999}td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}\
td.name{color:#666;font-size:.9em}td.runs{color:#444;padding-left:2em;white-space:nowrap}math{font-size:1.08em;font-family:'STIX Two Math','Cambria Math','Latin Modern Math','DejaVu Math TeX Gyre',math}mtext{font-family:system-ui,sans-serif}\
.example td{color:#555;font-size:.9em}.f td{padding:.35em .6em .35em 0}@media print{body{font-size:11pt;max-width:none;margin:0}h2{break-after:avoid}tr{break-inside:avoid}}\
@page{size:A4;margin:18mm}";

fn as_html(page: &Page, title: &str) -> String {
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
        plain(title)
    );
    out.push_str(&body(page));
    out.push_str("</body>\n</html>\n");
    out
}

/// The blocks of a page as HTML.
pub fn body(page: &Page) -> String {
    let math = |m: &Math| format!("<math>{}</math>", mathml(m));
    let mut out = String::new();
    for b in page {
        match b {
            Block::Heading(t) => {
                let _ = writeln!(out, "<h2>{}</h2>", plain(t));
            }
            Block::Words(t) => {
                let _ = writeln!(out, "<p>{}</p>", plain(t));
            }
            Block::Formulas(list) => {
                out.push_str("<table class=\"f\">\n");
                // What formulas run over stands below them where it takes half a line.
                let mut runs = list.iter().filter_map(|f| f.runs.as_ref());
                let is_long = runs.any(|r| text(r).chars().count() > LINE / 2);
                for f in list {
                    let runs = f.runs.as_ref().map(|r| format!("for all {}", math(r)));
                    let runs = runs.unwrap_or_default();
                    let (below, beside) = match is_long {
                        true => (format!("<div>{runs}</div>"), String::new()),
                        false => (String::new(), runs),
                    };
                    let words = plain(if f.name.is_empty() { &f.words } else { "" });
                    let (title, name) = (plain(&f.words).replace('"', "&quot;"), plain(&f.name));
                    let formula = mathml_lines(&f.math);
                    let _ = writeln!(
                        out,
                        "<tr title=\"{title}\"><td class=\"name\">{name}</td><td>{formula}{below}</td><td class=\"runs\">{beside}{words}</td></tr>"
                    );
                    if let Some((name, m)) = &f.example {
                        let (name, m) = (plain(name), mathml_lines(m));
                        let _ = writeln!(
                            out,
                            "<tr class=\"example\"><td></td><td colspan=\"2\">{name}: {m}</td></tr>"
                        );
                    }
                }
                out.push_str("</table>\n");
            }
            Block::Legend(rows) => {
                out.push_str("<table>\n");
                for (m, words, unit) in rows {
                    let (m, words, unit) = (math(m), plain(words), plain(unit));
                    let _ = writeln!(out, "<tr><td>{m}</td><td>{words}</td><td>{unit}</td></tr>");
                }
                out.push_str("</table>\n");
            }
            Block::Pairs(head, rows) => {
                let [a, b] = head.each_ref().map(|t| plain(t));
                let _ = writeln!(out, "<table>\n<tr><th>{a}</th><th>{b}</th></tr>");
                for (a, b) in rows {
                    let _ = writeln!(out, "<tr><td>{}</td><td>{}</td></tr>", math(a), math(b));
                }
                out.push_str("</table>\n");
            }
            Block::Table(head, rows) => table_html(&mut out, head, rows),
        }
    }
    out
}

fn table_html(out: &mut String, head: &[String], rows: &[Vec<String>]) {
    let number = |t: &str| t.starts_with(|c: char| c.is_ascii_digit() || "-−+∞".contains(c));
    let fits = |t: &String| t.is_empty() || number(t);
    let numeric = (0..head.len()).map(|c| rows.iter().all(|r| r.get(c).is_none_or(fits)));
    let numeric: Vec<bool> = numeric.collect();
    let cells = |tag: &str, row: &[String]| {
        let class = |n: usize| if numeric[n] { " class=\"n\"" } else { "" };
        let each = row.iter().enumerate();
        let each = each.map(|(n, t)| format!("<{tag}{}>{}</{tag}>", class(n), plain(t)));
        format!("<tr>{}</tr>", each.collect::<String>())
    };
    let _ = writeln!(
        out,
        "<table class=\"sortable\">\n<thead>{}</thead>\n<tbody>",
        cells("th", head)
    );
    for r in rows {
        let _ = writeln!(out, "{}", cells("td", r));
    }
    out.push_str("</tbody></table>\n");
}
