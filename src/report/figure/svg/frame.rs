//! What surrounds the plot: titles, axes, legends.

use std::fmt::Write;

use super::{Drawing, FONT, GRID, INK, MARGIN, Px, QUIET, escape};
use crate::color;
use crate::report::figure::layout::{
    Axis, log_ticks, power_label, rounded, text_width, tick_labels, ticks,
};
use crate::report::figure::{Element, Scene, Shape};

/// Ticks of an axis that is to have about so many, with their labels.
pub(super) fn tick_texts(range: [f64; 2], log: bool, wanted: f64) -> Vec<(f64, String)> {
    if log {
        let ticks = log_ticks(range, 8.0);
        return ticks.into_iter().map(|v| (v, power_label(v))).collect();
    }
    let ticks = ticks(range, wanted);
    let labels = tick_labels(&ticks);
    ticks.into_iter().zip(labels).collect()
}

/// Ticks of the vertical axis with their labels.
pub(super) fn y_ticks(scene: &Scene, range: [f64; 2]) -> Vec<(f64, String)> {
    if scene.y_categories.is_empty() {
        return tick_texts(range, scene.y_log, 6.0);
    }
    // Some of them where there are very many.
    let every = scene.y_categories.len().div_ceil(60);
    let numbered = scene.y_categories.iter().enumerate().step_by(every);
    numbered
        .map(|(k, c)| (-(k as f64) - 1.0, c.clone()))
        .collect()
}

/// What stands beside and below a plot, in pixels.
pub(super) struct Margins {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
    /// What is left between them.
    pub(super) plot_width: f64,
    /// The categories stand at an angle.
    pub(super) rotate: bool,
}

impl Margins {
    /// Around a plot in a picture of this width, with these ticks and these ends of a scale of colours.
    pub(super) fn new(
        scene: &Scene,
        axes: bool,
        y: [f64; 2],
        colors: Option<[f64; 2]>,
        width: f64,
    ) -> Self {
        let widest = |texts: &[(f64, String)], size| {
            let widths = texts.iter().map(|(_, t)| text_width(t, size));
            widths.fold(0.0, f64::max)
        };
        let [mut left, mut bottom, mut right] = [MARGIN; 3];
        if axes {
            left += widest(&y_ticks(scene, y), 11.5) + 8.0;
            left += if scene.y_label.is_some() { 20.0 } else { 0.0 };
            bottom += 20.0 + if scene.x_label.is_some() { 20.0 } else { 0.0 };
        }
        if let Some(ends) = colors {
            right += 34.0 + widest(&tick_texts(ends, false, 5.0), 11.0);
        }
        let plot_width = (width - left - right).max(20.0);
        let rotate = axes && rotated(scene, plot_width);
        if rotate {
            let widest = scene.categories.iter().map(|c| text_width(c, 11.5));
            bottom += (widest.fold(0.0, f64::max) * 0.71).min(110.0) - 8.0;
        }
        Self {
            left,
            right,
            bottom,
            plot_width,
            rotate,
        }
    }
}

/// What the axes reach over: the data with some room, the foot of the bars, and what the author said, which is not rounded.
pub(super) fn ranges(
    scene: &Scene,
    [x, y]: [[f64; 2]; 2],
    axes: bool,
    equal: bool,
) -> [[f64; 2]; 2] {
    let bars = has_bars(scene).is_some();
    let mut x = match scene.categories.is_empty() {
        true => pad(x, scene.x_log, axes && !bars, equal),
        false => x,
    };
    let mut y = match scene.y_categories.is_empty() {
        true => pad(y, scene.y_log, axes, equal),
        false => y,
    };
    if bars {
        y = [y[0].min(0.0), y[1].max(0.0)];
    }
    for (range, limits) in [(&mut x, scene.x_limits), (&mut y, scene.y_limits)] {
        let [low, high] = limits;
        let asked = [low.unwrap_or(range[0]), high.unwrap_or(range[1])];
        if asked[0] < asked[1] {
            *range = asked;
        }
    }
    [x, y]
}

/// Height of the plot without what is around it: as asked, as equal units want it, or as is usual.
pub(super) fn plot_height(
    scene: &Scene,
    around: f64,
    width: f64,
    [x, y]: [[f64; 2]; 2],
    equal: bool,
) -> f64 {
    let wanted = scene.height.filter(|h| h.is_finite());
    match wanted {
        Some(h) => (h - around).clamp(20.0, 10_000.0),
        None if equal => {
            let ratio = (y[1] - y[0]) / (x[1] - x[0]);
            (width * ratio).clamp(60.0, width.max(560.0))
        }
        None if !scene.y_categories.is_empty() => {
            (26.0 * scene.y_categories.len() as f64).clamp(90.0, 900.0)
        }
        None => (width * 0.6).clamp(60.0, 420.0),
    }
}

fn has_bars(scene: &Scene) -> Option<()> {
    let bars = |e: &Element| matches!(e.shape, Shape::Bars(_));
    scene.elements.iter().any(bars).then_some(())
}

/// A range with room at its ends and a positive width.
fn pad(range: [f64; 2], log: bool, axes: bool, equal: bool) -> [f64; 2] {
    let [lo, hi] = range;
    if log {
        let pad = |k: f64| 10f64.powf(k);
        return [
            pad((lo.log10() - 0.02).floor()),
            pad((hi.log10() + 0.02).ceil()),
        ];
    }
    if axes && !equal {
        return rounded(range, 6.0);
    }
    let width = hi - lo;
    if width <= 0.0 {
        let room = if lo == 0.0 { 1.0 } else { lo.abs() * 0.1 };
        return [lo - room, hi + room];
    }
    let room = if equal { 0.02 } else { 0.04 };
    [lo - room * width, hi + room * width]
}

/// Widens a range about its middle.
pub(super) fn widen(range: &mut [f64; 2], width: f64) {
    let middle = (range[0] + range[1]) / 2.0;
    *range = [middle - width / 2.0, middle + width / 2.0];
}

/// Whether the labels of the categories are too wide to stand side by side.
pub(super) fn rotated(scene: &Scene, plot_width: f64) -> bool {
    let room = plot_width / scene.categories.len().max(1) as f64;
    scene
        .categories
        .iter()
        .any(|c| text_width(c, 11.5) + 6.0 > room)
}

/// Legend entries in rows, each with its x offset.
pub(super) fn legend_rows(names: &[&str], width: f64) -> Vec<Vec<(usize, f64)>> {
    let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
    let mut x = f64::INFINITY;
    for (k, name) in names.iter().enumerate() {
        let wide = 40.0 + text_width(name, 12.0);
        if x + wide > width {
            rows.push(Vec::new());
            x = 0.0;
        }
        if let Some(row) = rows.last_mut() {
            row.push((k, x));
        }
        x += wide;
    }
    rows
}

/// Names of the legend in order, each with the place that chooses its colour.
pub(super) fn legend_names(scene: &Scene) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for name in scene.elements.iter().filter_map(|e| e.name.as_deref()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// A text, with what else is said of it.
pub(super) fn words(x: f64, y: f64, more: &str, text: &str) -> String {
    format!(
        "<text x=\"{}\" y=\"{}\"{more}>{text}</text>\n",
        Px(x),
        Px(y)
    )
}

/// A line, with what else is said of it.
fn line(from: [f64; 2], to: [f64; 2], more: &str) -> String {
    let [x1, y1, x2, y2] = [from[0], from[1], to[0], to[1]].map(Px);
    format!("<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"{more}/>\n")
}

/// A text at an angle about the place where it stands, with what else is said of it.
fn turned(x: f64, y: f64, anchor: &str, angle: i32, more: &str, text: &str) -> String {
    let about = format!("rotate({angle} {} {})", Px(x), Px(y));
    words(
        x,
        y,
        &format!(" text-anchor=\"{anchor}\" transform=\"{about}\"{more}"),
        text,
    )
}

impl Drawing<'_> {
    pub(super) fn head(&mut self, width: f64, height: f64) {
        let (w, h) = (Px(width.round()), Px(height.round()));
        let _ = writeln!(
            self.out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" \
             viewBox=\"0 0 {w} {h}\" font-family=\"{FONT}\" font-size=\"12\">"
        );
        if let Some(title) = &self.scene.title {
            let _ = writeln!(self.out, "  <title>{}</title>", escape(title));
        }
        let _ = writeln!(
            self.out,
            "  <rect width=\"{w}\" height=\"{h}\" fill=\"white\"/>"
        );
        let mut y = MARGIN + 13.0;
        if let Some(title) = &self.scene.title {
            let style = format!("font-size=\"16\" font-weight=\"600\" fill=\"{INK}\"");
            self.heading(y, &style, title);
            y += 20.0;
        }
        if let Some(subtitle) = &self.scene.subtitle {
            self.heading(y, &format!("font-size=\"12.5\" fill=\"{QUIET}\""), subtitle);
        }
    }

    fn heading(&mut self, y: f64, style: &str, text: &str) {
        self.out.push_str("  ");
        self.out
            .push_str(&words(MARGIN, y, &format!(" {style}"), &escape(text)));
    }

    pub(super) fn axes(&mut self, rotate: bool) {
        let [left, right] = self.x.pixels;
        let [bottom, top] = self.y.pixels;
        let (mut grid, mut labels) = (String::new(), String::new());
        for (v, text) in y_ticks(self.scene, self.y.range) {
            let y = self.y.at(v);
            if y < top - 0.5 || y > bottom + 0.5 {
                continue;
            }
            let end = " text-anchor=\"end\"";
            let text = words(left - 7.0, y + 4.0, end, &escape(&text));
            let _ = write!(grid, "    {}", line([left, y], [right, y], ""));
            let _ = write!(labels, "    {text}");
        }
        let x_ticks: Vec<(f64, String)> = if self.scene.categories.is_empty() {
            tick_texts(self.x.range, self.scene.x_log, (right - left) / 90.0)
        } else {
            // At most about one label per 14 pixels.
            let every = (14.0 * self.scene.categories.len() as f64 / (right - left)).ceil();
            let numbered = self.scene.categories.iter().enumerate();
            let shown = numbered.step_by((every as usize).max(1));
            shown.map(|(k, c)| (k as f64 + 1.0, escape(c))).collect()
        };
        for (v, text) in x_ticks {
            let x = self.x.at(v);
            if x < left - 0.5 || x > right + 0.5 {
                continue;
            }
            if self.scene.categories.is_empty() {
                let _ = write!(grid, "    {}", line([x, top], [x, bottom], ""));
            }
            let y = bottom + 18.0;
            let text = match rotate {
                true => turned(x + 4.0, y - 4.0, "end", -45, "", &text),
                false => words(x, y, " text-anchor=\"middle\"", &text),
            };
            let _ = write!(labels, "    {text}");
        }
        let _ = write!(
            self.out,
            "  <g stroke=\"{GRID}\" stroke-width=\"1\">\n{grid}  </g>\n  <g font-size=\"11.5\" fill=\"{QUIET}\">\n{labels}  </g>\n"
        );
        let base = match self.scene.y_log || !self.scene.y_categories.is_empty() {
            false => self.y.at(0.0f64.clamp(self.y.range[0], self.y.range[1])),
            true => bottom,
        };
        let stroke = format!(" stroke=\"{QUIET}\" stroke-width=\"1\"");
        let _ = write!(self.out, "  {}", line([left, base], [right, base], &stroke));
        self.axis_labels(rotate);
    }

    /// What the axes are called.
    fn axis_labels(&mut self, rotate: bool) {
        let [left, right] = self.x.pixels;
        let [bottom, top] = self.y.pixels;
        if let Some(label) = &self.scene.x_label {
            let y = match rotate {
                true => self.bottom_edge() - 8.0,
                false => bottom + 38.0,
            };
            let middle = format!(" text-anchor=\"middle\" fill=\"{INK}\"");
            let text = words((left + right) / 2.0, y, &middle, &escape(label));
            let _ = write!(self.out, "  {text}");
        }
        if let Some(label) = &self.scene.y_label {
            let (y, ink) = ((top + bottom) / 2.0, format!(" fill=\"{INK}\""));
            let text = turned(MARGIN + 4.0, y, "middle", -90, &ink, &escape(label));
            let _ = write!(self.out, "  {text}");
        }
    }

    /// Where the lowest rotated label ends.
    pub(super) fn bottom_edge(&self) -> f64 {
        let widest = self.scene.categories.iter().map(|c| text_width(c, 11.5));
        self.y.pixels[0] + (widest.fold(0.0, f64::max) * 0.71).min(110.0) + 38.0
    }

    pub(super) fn legend(&mut self, rows: &[Vec<(usize, f64)>], top: f64) {
        for (r, row) in rows.iter().enumerate() {
            let y = top + 20.0 * r as f64 + 8.0;
            for &(k, offset) in row {
                let name = self.names[k];
                let mut elements = self.scene.elements.iter();
                let number = elements.position(|e| e.name.as_deref() == Some(name));
                let Some(number) = number else { continue };
                let Element { shape, style, .. } = &self.scene.elements[number];
                let x = MARGIN + offset;
                let color = match shape {
                    Shape::Polygon(_) => self.color_or(style.fill.as_ref(), "#dde3ea"),
                    Shape::Polyline(_) | Shape::Arrow(..) => {
                        self.color_or(style.stroke.as_ref(), INK)
                    }
                    _ => self.series_color(number),
                };
                let mark = match shape {
                    Shape::Line(_) | Shape::Polyline(_) | Shape::Arrow(..) => {
                        let width = Px(style.width.unwrap_or(2.0));
                        let stroke = format!(" stroke=\"{color}\" stroke-width=\"{width}\"");
                        line([x, y], [x + 18.0, y], &stroke)
                    }
                    _ => {
                        let (x, y) = (Px(x + 3.0), Px(y - 6.0));
                        format!(
                            "<rect x=\"{x}\" y=\"{y}\" width=\"12\" height=\"12\" rx=\"2\" fill=\"{color}\"/>\n"
                        )
                    }
                };
                let ink = format!(" fill=\"{INK}\"");
                let text = words(x + 24.0, y + 4.0, &ink, &escape(name));
                let _ = write!(self.out, "  {mark}  {text}");
            }
        }
    }

    /// The colour scale, at the right of the plot.
    pub(super) fn color_legend(&mut self, x: f64) {
        let Some([lo, hi]) = self.colors else { return };
        let [bottom, top] = self.y.pixels;
        let long = (bottom - top).min(220.0);
        let middle = (bottom + top) / 2.0;
        let (y0, y1) = (middle + long / 2.0, middle - long / 2.0);
        self.out
            .push_str("  <defs><linearGradient id=\"scale\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">");
        for k in 0..=8 {
            let part = f64::from(k) / 8.0;
            let color = color::scale(part);
            let _ = write!(self.out, "<stop offset=\"{part}\" stop-color=\"{color}\"/>");
        }
        self.out.push_str("</linearGradient></defs>\n");
        let (left, top, high) = (Px(x), Px(y1), Px(long));
        let _ = writeln!(
            self.out,
            "  <rect x=\"{left}\" y=\"{top}\" width=\"12\" height=\"{high}\" fill=\"url(#scale)\"/>"
        );
        let axis = Axis {
            range: [lo, hi],
            pixels: [y0, y1],
            log: false,
        };
        let _ = writeln!(self.out, "  <g font-size=\"11\" fill=\"{QUIET}\">");
        for (v, text) in tick_texts([lo, hi], false, 5.0) {
            let text = words(x + 17.0, axis.at(v) + 4.0, "", &text);
            let _ = write!(self.out, "    {text}");
        }
        if let Some(label) = &self.scene.scale_label {
            let end = " text-anchor=\"end\"";
            let text = words(x + 12.0 + 30.0, y1 - 9.0, end, &escape(label));
            let _ = write!(self.out, "    {text}");
        }
        self.out.push_str("  </g>\n");
    }
}
