//! The picture of a work–precision study: error over time, both logarithmic; one line per solver.
//! Times differ from run to run, and so does the picture.

use crate::color::{Paint, series};
use crate::report::figure::{self, Anchor, Element, Scene, Shape, Style};
use crate::solve::study::{Run, Study};

/// Points of a line that are as near as this, in powers of ten, share a label.
const NEAR: f64 = 0.05;

/// The picture. Errors that are exactly 0 stand a decade below the others.
pub fn svg(title: &str, s: &Study) -> String {
    let drawn: Vec<(&Run, f64)> = s
        .runs
        .iter()
        .filter_map(|r| Some((r, r.error.filter(|e| e.is_finite())?)))
        .collect();
    let errors = drawn.iter().map(|d| d.1).filter(|&e| e > 0.0);
    let zero = errors.fold(1.0, f64::min) / 10.0;
    let point = |&(run, error): &(&Run, f64)| {
        let error = if error > 0.0 { error } else { zero };
        [run.seconds.max(1e-9), error]
    };
    let mut families: Vec<&str> = Vec::new();
    for d in &drawn {
        if !families.contains(&d.0.way.family) {
            families.push(d.0.way.family);
        }
    }
    let mut elements = Vec::new();
    let mut labels = Vec::new();
    for (k, family) in families.into_iter().enumerate() {
        let mut mine: Vec<&(&Run, f64)> =
            drawn.iter().filter(|d| d.0.way.family == family).collect();
        let points: Vec<[f64; 2]> = mine.iter().map(|d| point(d)).collect();
        elements.push(Element::new(Shape::Line(points.clone())).name(family));
        elements.push(Element::new(Shape::Points(points)).name(family));
        while let Some(&first) = mine.first() {
            let at = point(first);
            let near = |d: &&(&Run, f64)| {
                let [dx, dy] = [0, 1].map(|c| (point(d)[c] / at[c]).log10().abs());
                dx.max(dy) <= NEAR
            };
            let here: Vec<&str> = mine
                .iter()
                .filter(|d| near(d))
                .map(|d| &*d.0.way.setting)
                .collect();
            let exact = if first.1 == 0.0 { " (error 0)" } else { "" };
            // Blanks that stay keep it off the point.
            let text = format!("\u{a0}\u{a0}{}{exact}", here.join(", "));
            let style = Style {
                fill: Some(Paint::Color(series(k).into())),
                ..Style::sized(10.0)
            };
            labels.push(Element::new(Shape::Text(at, text, Anchor::Start)).style(style));
            mine.retain(|d| !near(d));
        }
    }
    elements.append(&mut labels);
    figure::svg(&Scene {
        title: Some(title.into()),
        elements,
        x_label: Some("seconds".into()),
        y_label: Some("error".into()),
        x_log: true,
        y_log: true,
        ..Scene::default()
    })
}
