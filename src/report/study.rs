//! A work–precision study as a table, as CSV, and as a picture with two logarithmic axes.

use std::fmt::Write;

use super::figure::{self, Anchor, Element, Scene, Shape, Style};
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
    let head = "solver,setting,status,seconds,error,objective,primal,dual,compl.,iterations";
    let mut lines: Vec<Vec<String>> = vec![head.split(',').map(str::to_string).collect()];
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
    let widest = |c: usize| lines.iter().map(|l| l[c].chars().count()).max();
    let width: Vec<usize> = (0..lines[0].len())
        .map(|c| widest(c).unwrap_or(0))
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
    let number = |v: Option<f64>| v.map_or(String::new(), |v| v.to_string());
    let head =
        "solver,setting,status,seconds,error,objective,primal,dual,complementarity,iterations";
    let mut lines = vec![head.split(',').map(str::to_string).collect::<Vec<_>>()];
    lines.extend(s.runs.iter().map(|r| {
        vec![
            r.way.family.to_string(),
            r.way.setting.clone(),
            r.status.name().to_string(),
            r.seconds.to_string(),
            number(r.error),
            number(r.objective),
            number(r.primal),
            number(r.dual),
            number(r.complementarity),
            r.iterations.to_string(),
        ]
    }));
    comma_separated(&lines)
}

/// Error over time, both logarithmic: a line for each solver, the settings at its points. Errors that are exactly 0 stand a decade
/// below the others. Times differ from run to run, and so does the picture.
pub fn svg(title: &str, s: &Study) -> String {
    let error = |r: &Run| r.error.filter(|e| e.is_finite());
    let drawn: Vec<&Run> = s.runs.iter().filter(|r| error(r).is_some()).collect();
    let errors = drawn.iter().filter_map(|r| error(r)).filter(|&e| e > 0.0);
    let zero = errors.fold(1.0, f64::min) / 10.0;
    let at = |r: &Run| {
        let error = r.error.filter(|&e| e > 0.0);
        [r.seconds.max(1e-9), error.unwrap_or(zero)]
    };
    let mut scene = Scene {
        title: Some(title.into()),
        x_label: Some("seconds".into()),
        y_label: Some("error".into()),
        x_log: true,
        y_log: true,
        ..Scene::default()
    };
    if drawn.iter().any(|r| r.error == Some(0.0)) {
        scene.subtitle = Some(format!("errors of 0 stand at {zero:.0e}"));
    }
    for runs in drawn.chunk_by(|a, b| a.way.family == b.way.family) {
        let points: Vec<[f64; 2]> = runs.iter().map(|r| at(r)).collect();
        for shape in [Shape::Line(points.clone()), Shape::Points(points)] {
            let element = Element::new(shape).name(runs[0].way.family);
            scene.elements.push(element);
        }
        // Points that lie on each other share a label.
        let near = |a: f64, b: f64| (a / b).ln().abs() < 0.05;
        let mut left = runs.to_vec();
        while let Some([x, y]) = left.first().map(|r| at(r)) {
            let here = |r: &&Run| near(at(r)[0], x) && near(at(r)[1], y);
            let names: Vec<&str> = left
                .iter()
                .copied()
                .filter(here)
                .map(|r| &*r.way.setting)
                .collect();
            let label = Shape::Text(
                [x, y],
                format!("\u{a0}\u{a0}{}", names.join(", ")),
                Anchor::Start,
            );
            scene
                .elements
                .push(Element::new(label).style(Style::sized(10.0)));
            left.retain(|r| !here(r));
        }
    }
    figure::svg(&scene)
}

/// Lines of cells as comma-separated values.
pub fn comma_separated(lines: &[Vec<String>]) -> String {
    let mut out = csv::Writer::from_writer(Vec::new());
    for line in lines {
        // A vector takes everything: writing cannot fail.
        let _ = out.write_record(line);
    }
    String::from_utf8(out.into_inner().unwrap_or_default()).unwrap_or_default()
}
