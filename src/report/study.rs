//! A work–precision study as a table, as CSV, and as a picture with two logarithmic axes.

use std::fmt::Write;

use crate::color::series;
use crate::solve::study::{Reference, Run, Study};

fn small(v: Option<f64>) -> String {
    match v {
        None => "-".into(),
        Some(0.0) => "0".into(),
        Some(v) => format!("{v:.1e}"),
    }
}

/// Aligned columns for a terminal; also a table in Markdown.
pub fn table(title: &str, s: &Study) -> String {
    let mut out = format!("{title}\n");
    let _ = match s.reference {
        Reference::Proved(lo, hi) => {
            writeln!(out, "errors against the proved interval [{lo}, {hi}]")
        }
        Reference::Best(v) => writeln!(out, "errors against the most accurate run, {v:.15}"),
        Reference::Residual => writeln!(out, "errors are natural residuals"),
        Reference::None => writeln!(out, "nothing was solved"),
    };
    out.push('\n');
    let head = [
        "solver",
        "setting",
        "status",
        "seconds",
        "error",
        "objective",
        "primal",
        "dual",
        "compl.",
        "iterations",
    ];
    let mut lines: Vec<Vec<String>> = vec![head.iter().map(|h| h.to_string()).collect()];
    for r in &s.runs {
        lines.push(vec![
            r.way.family.to_string(),
            r.way.setting.clone(),
            r.status.name().to_string(),
            format!("{:.4}", r.seconds),
            small(r.error),
            r.objective.map_or("-".into(), |v| format!("{v:.12}")),
            small(r.primal),
            small(r.dual),
            small(r.complementarity),
            r.iterations.to_string(),
        ]);
    }
    let width: Vec<usize> = (0..head.len())
        .map(|c| {
            lines
                .iter()
                .map(|l| l[c].chars().count())
                .max()
                .unwrap_or(0)
        })
        .collect();
    for (k, line) in lines.iter().enumerate() {
        for (c, cell) in line.iter().enumerate() {
            let pad = " ".repeat(width[c] - cell.chars().count());
            let _ = match c < 3 {
                true => write!(out, "| {cell}{pad} "),
                false => write!(out, "| {pad}{cell} "),
            };
        }
        out.push_str("|\n");
        if k == 0 {
            for w in &width {
                let _ = write!(out, "|{}", "-".repeat(w + 2));
            }
            out.push_str("|\n");
        }
    }
    out
}

/// One line per run, all digits.
pub fn csv(s: &Study) -> String {
    let mut out = String::from(
        "solver,setting,status,seconds,error,objective,primal,dual,complementarity,iterations\n",
    );
    let number = |v: Option<f64>| v.map_or(String::new(), |v| v.to_string());
    for r in &s.runs {
        let _ = writeln!(
            out,
            "{},{},{},{},{},{},{},{},{},{}",
            r.way.family,
            r.way.setting,
            r.status.name(),
            r.seconds,
            number(r.error),
            number(r.objective),
            number(r.primal),
            number(r.dual),
            number(r.complementarity),
            r.iterations
        );
    }
    out
}

/// Errors below this are drawn at it.
const FLOOR: f64 = 1e-17;

/// Error over time, both logarithmic; one line per solver. Times differ from run to run, and so does
/// the picture.
pub fn svg(title: &str, s: &Study) -> String {
    const WIDTH: f64 = 640.0;
    const HEIGHT: f64 = 420.0;
    const LEFT: f64 = 70.0;
    const RIGHT: f64 = 180.0;
    const TOP: f64 = 40.0;
    const BOTTOM: f64 = 50.0;
    let drawn: Vec<(&Run, f64, f64)> = s
        .runs
        .iter()
        .filter_map(|r| {
            let e = r.error.filter(|e| e.is_finite())?;
            Some((r, r.seconds.max(1e-9).log10(), e.max(FLOOR).log10()))
        })
        .collect();
    let range = |values: &dyn Fn(&(&Run, f64, f64)) -> f64| {
        let low = drawn.iter().map(values).fold(f64::INFINITY, f64::min);
        let high = drawn.iter().map(values).fold(f64::NEG_INFINITY, f64::max);
        match low.is_finite() {
            true => (low.floor(), high.ceil().max(low.floor() + 1.0)),
            false => (0.0, 1.0),
        }
    };
    let (x0, x1) = range(&|d| d.1);
    let (y0, y1) = range(&|d| d.2);
    let px = |x: f64| LEFT + (x - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT);
    let py = |y: f64| HEIGHT - BOTTOM - (y - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"Inter, sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let _ = writeln!(
        out,
        "<text x=\"{LEFT}\" y=\"24\" font-size=\"14\">{}</text>",
        escaped(title)
    );
    for k in x0 as i32..=x1 as i32 {
        let x = px(f64::from(k));
        let _ = writeln!(
            out,
            "<path d=\"M{x:.1} {TOP}V{:.1}\" stroke=\"#ddd\"/><text x=\"{x:.1}\" y=\"{:.1}\" \
             text-anchor=\"middle\">1e{k}</text>",
            HEIGHT - BOTTOM,
            HEIGHT - BOTTOM + 18.0
        );
    }
    let step = ((y1 - y0) / 8.0).ceil().max(1.0) as usize;
    for k in (y0 as i32..=y1 as i32).step_by(step) {
        let y = py(f64::from(k));
        let _ = writeln!(
            out,
            "<path d=\"M{LEFT} {y:.1}H{:.1}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.1}\" \
             text-anchor=\"end\">1e{k}</text>",
            WIDTH - RIGHT,
            LEFT - 6.0,
            y + 4.0
        );
    }
    let (middle, right) = ((LEFT + WIDTH - RIGHT) / 2.0, WIDTH - RIGHT);
    let _ = writeln!(
        out,
        "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">seconds</text>\n<text x=\"16\" \
         y=\"{}\" text-anchor=\"middle\" transform=\"rotate(-90 16 {})\">error</text>",
        HEIGHT - 12.0,
        HEIGHT / 2.0,
        HEIGHT / 2.0
    );
    let mut families: Vec<&str> = Vec::new();
    for d in &drawn {
        if !families.contains(&d.0.way.family) {
            families.push(d.0.way.family);
        }
    }
    for (k, family) in families.iter().enumerate() {
        let color = series(k);
        let mine: Vec<_> = drawn.iter().filter(|d| d.0.way.family == *family).collect();
        let points: Vec<String> = mine
            .iter()
            .map(|d| format!("{:.1},{:.1}", px(d.1), py(d.2)))
            .collect();
        let _ = writeln!(
            out,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"/>",
            points.join(" ")
        );
        for d in mine {
            let (x, y) = (px(d.1), py(d.2));
            let _ = writeln!(
                out,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{color}\"/><text \
                 x=\"{:.1}\" y=\"{:.1}\" font-size=\"9\" fill=\"#555\">{}</text>",
                x + 5.0,
                y - 5.0,
                escaped(&d.0.way.setting)
            );
        }
        let y = TOP + 14.0 + 18.0 * k as f64;
        let _ = writeln!(
            out,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"4\" fill=\"{color}\"/><text x=\"{:.1}\" \
             y=\"{y:.1}\">{}</text>",
            right + 16.0,
            y - 4.0,
            right + 26.0,
            escaped(family)
        );
    }
    out.push_str("</svg>\n");
    out
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
