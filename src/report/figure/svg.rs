//! Lays a scene out and writes it as SVG; what surrounds the plot is in [`frame`].

mod frame;

use std::fmt::Write;

use super::layout::{Axis, extent, visible};
use super::{Anchor, Element, Scene, Shape, Style};
use crate::color::{self, Paint};
use frame::{Margins, legend_names, legend_rows, plot_height, ranges, widen, words};

/// Ink of axes, texts and lines that have no colour of their own.
const INK: &str = "#2b3440";
/// Quieter ink: ticks, subtitle.
const QUIET: &str = "#5b6673";
/// Lines of the grid.
const GRID: &str = "#e3e7ec";
const FONT: &str = "Inter, 'Helvetica Neue', Helvetica, Arial, 'DejaVu Sans', sans-serif";
/// Pixels around a plot with given limits in which what stands on its edge is still drawn.
const EDGE: f64 = 5.0;
/// Margin around everything, in pixels.
const MARGIN: f64 = 18.0;

/// A pixel coordinate: two decimals, no trailing zeros.
struct Px(f64);

impl std::fmt::Display for Px {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Widths and sizes come as the user gave them; a number that is none counts as 0.
        let v = if self.0.is_nan() { 0.0 } else { self.0 };
        let text = format!("{:.2}", v.clamp(-1e7, 1e7));
        let text = text.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if text == "-0" { "0" } else { text })
    }
}

/// A text as XML holds it; characters that XML forbids become U+FFFD.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\t' | '\r' => out.push(' '),
            c if c < ' ' || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// The range of the numbers that colours stand for.
fn scale_range(scene: &Scene) -> Option<[f64; 2]> {
    let styles = scene.elements.iter().map(|e| &e.style);
    let paints = styles.flat_map(|s| [&s.fill, &s.stroke]);
    let values = paints.filter_map(|p| match p {
        Some(Paint::Value(v)) if v.is_finite() => Some(*v),
        _ => None,
    });
    values.fold(None, |r: Option<[f64; 2]>, v| {
        let [lo, hi] = r.unwrap_or([v, v]);
        Some([lo.min(v), hi.max(v)])
    })
}

struct Drawing<'a> {
    scene: &'a Scene,
    out: String,
    x: Axis,
    y: Axis,
    colors: Option<[f64; 2]>,
    names: Vec<&'a str>,
    /// Attributes of the open `<g>`.
    group: Option<String>,
}

/// What the panels of a figure have in common.
struct Common<'a> {
    extent: [[f64; 2]; 2],
    colors: Option<[f64; 2]>,
    names: Vec<&'a str>,
}

impl<'a> Common<'a> {
    fn of(scene: &'a Scene) -> Self {
        Self {
            extent: extent(scene).map(|r| r.unwrap_or([0.0, 1.0])),
            colors: scale_range(scene),
            names: legend_names(scene),
        }
    }
}

/// The scene as an SVG text.
pub fn svg(scene: &Scene) -> String {
    let mut panels: Vec<&str> = Vec::new();
    for name in scene.elements.iter().filter_map(|e| e.panel.as_deref()) {
        if !panels.contains(&name) {
            panels.push(name);
        }
    }
    if panels.is_empty() {
        return plot(scene, Common::of(scene), true);
    }
    small_multiples(scene, &panels)
}

/// A grid of panels with the same axes, one legend above.
fn small_multiples(scene: &Scene, panels: &[&str]) -> String {
    let width = picture_width(scene, 960.0);
    let columns = match panels.len() {
        n @ 1..=3 => n,
        4 => 2,
        _ => 3,
    };
    let common = Common::of(scene);
    let legend = legend_rows(&common.names, width - 2.0 * MARGIN);
    let legend_top = headings_height(scene);
    let mut top = legend_top + legend_height(&legend);
    let each = (width / columns as f64).floor();
    let mut body = String::new();
    for names in panels.chunks(columns) {
        let mut tallest = 0.0f64;
        for (column, name) in names.iter().enumerate() {
            let there = |e: &&Element| e.panel.as_deref().is_none_or(|p| p == *name);
            let panel = Scene {
                title: None,
                subtitle: Some((*name).to_string()),
                width: Some(each),
                height: scene.height,
                elements: scene.elements.iter().filter(there).cloned().collect(),
                ..scene.clone()
            };
            let text = plot(&panel, Common::of(scene), false);
            tallest = tallest.max(height_of(&text));
            let at = format!("<svg x=\"{}\" y=\"{}\" ", Px(column as f64 * each), Px(top));
            body.push_str(&text.replacen("<svg ", &at, 1));
        }
        top += tallest;
    }
    let [x_range, y_range] = common.extent;
    let axis = |range| Axis {
        range,
        pixels: [0.0, 1.0],
        log: false,
    };
    let mut d = Drawing {
        scene,
        out: String::new(),
        x: axis(x_range),
        y: axis(y_range),
        colors: common.colors,
        names: common.names,
        group: None,
    };
    d.head(width, top);
    d.legend(&legend, legend_top);
    d.out.push_str(&body);
    d.out.push_str("</svg>\n");
    d.out
}

/// The height that a picture states in its first line.
fn height_of(svg: &str) -> f64 {
    let text = svg.split("height=\"").nth(1).unwrap_or_default();
    let text = text.split('"').next().unwrap_or_default();
    text.parse().unwrap_or(0.0)
}

fn picture_width(scene: &Scene, usual: f64) -> f64 {
    let width = scene.width.filter(|w| w.is_finite()).unwrap_or(usual);
    width.clamp(80.0, 10_000.0)
}

/// Pixels above the legend.
fn headings_height(scene: &Scene) -> f64 {
    let title = if scene.title.is_some() { 26.0 } else { 0.0 };
    let subtitle = if scene.subtitle.is_some() { 18.0 } else { 0.0 };
    MARGIN + title + subtitle
}

fn legend_height(rows: &[Vec<(usize, f64)>]) -> f64 {
    match rows.len() {
        0 => 0.0,
        n => 20.0 * n as f64 + 8.0,
    }
}

/// One plot with what surrounds it; the legend only if asked for.
fn plot(scene: &Scene, common: Common<'_>, with_legend: bool) -> String {
    use Shape::{Bars, Line, Whiskers};
    let chart = |e: &Element| matches!(e.shape, Line(_) | Bars(_) | Whiskers(_));
    let has_chart = scene.elements.iter().any(chart);
    let axes = scene.axes.unwrap_or(has_chart);
    let equal = scene.equal.unwrap_or(!has_chart) && !scene.x_log && !scene.y_log;
    let Common { colors, names, .. } = common;

    // What surrounds the plot.
    let width = picture_width(scene, 720.0);
    let legend = match with_legend {
        true => legend_rows(&names, width - 2.0 * MARGIN),
        false => Vec::new(),
    };
    let legend_top = headings_height(scene);
    let top = legend_top + legend_height(&legend);
    let [mut x_range, mut y_range] = ranges(scene, common.extent, axes, equal);
    let m = Margins::new(scene, axes, y_range, colors, width);

    // The plot itself.
    let (left, plot_width) = (m.left, m.plot_width);
    let around = top + m.bottom;
    let plot_height = plot_height(scene, around, plot_width, [x_range, y_range], equal);
    if equal {
        let per_unit =
            (plot_width / (x_range[1] - x_range[0])).min(plot_height / (y_range[1] - y_range[0]));
        widen(&mut x_range, plot_width / per_unit);
        widen(&mut y_range, plot_height / per_unit);
    }
    let height = around + plot_height;
    let mut d = Drawing {
        scene,
        out: String::new(),
        x: Axis {
            range: x_range,
            pixels: [left, left + plot_width],
            log: scene.x_log,
        },
        y: Axis {
            range: y_range,
            pixels: [top + plot_height, top],
            log: scene.y_log,
        },
        colors,
        names,
        group: None,
    };
    d.head(width, height);
    if axes {
        d.axes(m.rotate);
    }
    let mut limits = scene.x_limits.iter().chain(&scene.y_limits);
    let is_cut = limits.any(Option::is_some);
    if is_cut {
        let size = [plot_width + 2.0 * EDGE, plot_height + 2.0 * EDGE];
        let inside = rectangle([left - EDGE, top - EDGE], size);
        let _ = writeln!(
            d.out,
            "  <clipPath id=\"plot\">{inside}</clipPath>\n  <g clip-path=\"url(#plot)\">"
        );
    }
    for k in 0..scene.elements.len() {
        d.element(k);
    }
    d.close_group();
    if is_cut {
        d.out.push_str("  </g>\n");
    }
    d.legend(&legend, legend_top);
    d.color_legend(width - m.right + 14.0);
    d.out.push_str("</svg>\n");
    d.out
}

/// A rectangle from its upper left corner.
fn rectangle([x, y]: [f64; 2], [width, height]: [f64; 2]) -> String {
    let [x, y, w, h] = [x, y, width, height].map(Px);
    format!("<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/>")
}

impl Drawing<'_> {
    /// The colour of a paint.
    fn color(&self, paint: &Paint) -> String {
        match paint {
            Paint::None => "none".into(),
            Paint::Color(c) => c.clone(),
            Paint::Value(v) => {
                let [lo, hi] = self.colors.unwrap_or([0.0, 1.0]);
                let part = if hi > lo { (v - lo) / (hi - lo) } else { 0.5 };
                color::scale(part)
            }
        }
    }

    /// The colour of a paint, if there is one, else this one.
    fn color_or(&self, paint: Option<&Paint>, otherwise: &str) -> String {
        paint.map_or(otherwise.into(), |p| self.color(p))
    }

    /// The colour of a series: its own, or the one of its name's or element's number.
    fn series_color(&self, k: usize) -> String {
        let e = &self.scene.elements[k];
        let own = match e.shape {
            Shape::Line(_) => e.style.stroke.as_ref(),
            _ => e.style.fill.as_ref().or(e.style.stroke.as_ref()),
        };
        if let Some(paint) = own {
            return self.color(paint);
        }
        let number = match &e.name {
            Some(name) => self.names.iter().position(|n| n == name).unwrap_or(0),
            None => {
                let chart = |e: &&Element| matches!(e.shape, Shape::Line(_) | Shape::Bars(_));
                self.scene.elements[..k].iter().filter(chart).count()
            }
        };
        color::series(number).into()
    }

    fn point(&self, p: [f64; 2]) -> Option<(f64, f64)> {
        if !p.iter().all(|&v| visible(v)) {
            return None;
        }
        let q = (self.x.at(p[0]), self.y.at(p[1]));
        (q.0.is_finite() && q.1.is_finite()).then_some(q)
    }

    fn pixels(&self, ps: &[[f64; 2]]) -> Vec<(f64, f64)> {
        ps.iter().filter_map(|&p| self.point(p)).collect()
    }

    fn points(&self, ps: &[[f64; 2]]) -> String {
        let mut text = String::new();
        for (x, y) in self.pixels(ps) {
            let gap = if text.is_empty() { "" } else { " " };
            let _ = write!(text, "{gap}{},{}", Px(x), Px(y));
        }
        text
    }

    /// Opens a group with these attributes, unless it is open already.
    fn enter(&mut self, attributes: String) {
        if self.group.as_ref() != Some(&attributes) {
            self.close_group();
            let _ = writeln!(self.out, "  <g{attributes}>");
            self.group = Some(attributes);
        }
    }

    fn close_group(&mut self) {
        if self.group.take().is_some() {
            self.out.push_str("  </g>\n");
        }
    }

    fn element(&mut self, k: usize) {
        let scene = self.scene;
        let e = &scene.elements[k];
        match &e.shape {
            Shape::Polygon(ps) => {
                let fill = self.color_or(e.style.fill.as_ref(), "#dde3ea");
                let attributes = self.attributes(&e.style, &fill, INK, 1.0, "round");
                let points = self.points(ps);
                if !points.is_empty() {
                    self.enter(attributes);
                    let _ = writeln!(self.out, "    <polygon points=\"{points}\"/>");
                }
            }
            Shape::Polyline(ps) => {
                let fill = self.color_or(e.style.fill.as_ref(), "none");
                let attributes = self.attributes(&e.style, &fill, INK, 1.5, "round");
                self.polyline(ps, attributes);
            }
            Shape::Line(ps) => {
                let style = Style {
                    stroke: Some(Paint::Color(self.series_color(k))),
                    ..e.style.clone()
                };
                let attributes = self.attributes(&style, "none", INK, 2.0, "round");
                self.polyline(ps, attributes);
            }
            Shape::Points(ps) => {
                let fill = match (&e.style.fill, &e.name) {
                    (None, Some(_)) => self.series_color(k),
                    (fill, _) => self.color_or(fill.as_ref(), INK),
                };
                let attributes = self.attributes(&e.style, &fill, "none", 1.0, "round");
                self.enter(attributes);
                let r = Px(e.style.size.unwrap_or(6.0) / 2.0);
                for (x, y) in self.pixels(ps) {
                    let (x, y) = (Px(x), Px(y));
                    let _ = writeln!(self.out, "    <circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"/>");
                }
            }
            Shape::Arrow(from, by) => self.arrow(*from, *by, &e.style),
            Shape::Text(at, text, anchor) => self.text(*at, text, *anchor, &e.style),
            Shape::Bars(ps) => self.bars(k, ps),
            Shape::Whiskers(ps) => self.whiskers(ps, &e.style),
            Shape::Arc(from, to, gap) => self.arc(*from, *to, *gap, &e.style),
        }
    }

    /// Error bars: a line with caps.
    fn whiskers(&mut self, ps: &[[f64; 3]], style: &Style) {
        let attributes = self.attributes(style, "none", INK, 1.3, "miter");
        for &[x, low, high] in ps {
            let (Some((x, y0)), Some((_, y1))) = (self.point([x, low]), self.point([x, high]))
            else {
                continue;
            };
            self.enter(attributes.clone());
            let (left, right, x) = (Px(x - 4.0), Px(x + 4.0), Px(x));
            let (y0, y1) = (Px(y0), Px(y1));
            let _ = writeln!(
                self.out,
                "    <path d=\"M{left},{y0} H{right} M{x},{y0} V{y1} M{left},{y1} H{right}\"/>"
            );
        }
    }

    /// An arrow from node to node, which leaves out so many pixels at both ends.
    fn arc(&mut self, from: [f64; 2], to: [f64; 2], gap: f64, style: &Style) {
        let (Some((x0, y0)), Some((x1, y1))) = (self.point(from), self.point(to)) else {
            return;
        };
        let length = (x1 - x0).hypot(y1 - y0);
        if length > 2.0 * gap {
            let (gx, gy) = (gap * ((x1 - x0) / length), gap * ((y1 - y0) / length));
            self.arrow_in_pixels([x0 + gx, y0 + gy], [x1 - gx, y1 - gy], style);
        }
    }

    fn attributes(
        &self,
        style: &Style,
        fill: &str,
        stroke: &str,
        width: f64,
        join: &str,
    ) -> String {
        let stroke = self.color_or(style.stroke.as_ref(), stroke);
        let mut a = format!(" fill=\"{fill}\"");
        if stroke == "none" {
            a.push_str(" stroke=\"none\"");
        } else {
            let width = Px(style.width.unwrap_or(width).max(0.0));
            let _ = write!(
                a,
                " stroke=\"{stroke}\" stroke-width=\"{width}\" stroke-linejoin=\"{join}\""
            );
            if fill == "none" {
                a.push_str(" stroke-linecap=\"round\"");
            }
            let dash = style.dash.iter().map(|&d| Px(d.max(0.0)).to_string());
            let dash: Vec<String> = dash.collect();
            if !dash.is_empty() {
                let _ = write!(a, " stroke-dasharray=\"{}\"", dash.join(" "));
            }
        }
        if let Some(o) = style.opacity.filter(|o| *o < 1.0) {
            let _ = write!(a, " opacity=\"{}\"", Px(o.clamp(0.0, 1.0)));
        }
        a
    }

    /// A line in as many pieces as the points that are not finite make of it.
    fn polyline(&mut self, ps: &[[f64; 2]], attributes: String) {
        for piece in ps.split(|p| !p.iter().all(|&v| visible(v))) {
            let points = self.points(piece);
            if points.contains(' ') {
                self.enter(attributes.clone());
                let _ = writeln!(self.out, "    <polyline points=\"{points}\"/>");
            }
        }
    }

    fn arrow(&mut self, from: [f64; 2], by: [f64; 2], style: &Style) {
        let to = [from[0] + by[0], from[1] + by[1]];
        let (Some((x0, y0)), Some((x1, y1))) = (self.point(from), self.point(to)) else {
            return;
        };
        self.arrow_in_pixels([x0, y0], [x1, y1], style);
    }

    fn arrow_in_pixels(&mut self, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2], style: &Style) {
        let length = (x1 - x0).hypot(y1 - y0);
        if length < 0.05 {
            return;
        }
        let width = style.width.unwrap_or(1.5);
        let head = (6.0 + 1.5 * width).min(0.6 * length);
        let (ux, uy) = ((x1 - x0) / length, (y1 - y0) / length);
        let (bx, by) = (x1 - head * ux, y1 - head * uy);
        let half = 0.4 * head;
        let color = self.color_or(style.stroke.as_ref(), INK);
        let attributes = self.attributes(style, &color, INK, 1.5, "miter");
        self.enter(attributes);
        let at = |x: f64, y: f64| format!("{},{}", Px(x), Px(y));
        let (from, base, tip) = (at(x0, y0), at(bx, by), at(x1, y1));
        let left = at(bx - half * uy, by + half * ux);
        let right = at(bx + half * uy, by - half * ux);
        let _ = writeln!(
            self.out,
            "    <path d=\"M{from} L{base}\"/><path stroke=\"none\" d=\"M{tip} L{left} L{right} Z\"/>"
        );
    }

    fn text(&mut self, at: [f64; 2], text: &str, anchor: Anchor, style: &Style) {
        let Some((x, y)) = self.point(at) else { return };
        let size = style.size.unwrap_or(12.0);
        let color = self.color_or(style.fill.as_ref().or(style.stroke.as_ref()), INK);
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        // A soft white outline keeps a text readable on any colour.
        let mut a = format!(
            " fill=\"{color}\" stroke=\"white\" stroke-width=\"2.5\" stroke-opacity=\"0.6\" \
             stroke-linejoin=\"round\" paint-order=\"stroke\" font-size=\"{}\" text-anchor=\"{anchor}\"",
            Px(size)
        );
        if let Some(o) = style.opacity.filter(|o| *o < 1.0) {
            let _ = write!(a, " opacity=\"{}\"", Px(o.clamp(0.0, 1.0)));
        }
        self.enter(a);
        // The middle of small letters stands at the point.
        let text = words(x, y + 0.35 * size, "", &escape(text));
        let _ = write!(self.out, "    {text}");
    }

    fn bars(&mut self, k: usize, ps: &[[f64; 2]]) {
        let bars = |e: &Element| matches!(e.shape, Shape::Bars(_));
        let count = self.scene.elements.iter().filter(|e| bars(e)).count() as f64;
        let place = self.scene.elements[..k].iter().filter(|e| bars(e)).count() as f64;
        let unit = (self.x.at(1.0) - self.x.at(0.0)).abs();
        let slot = 0.76 * unit / count;
        let fill = self.series_color(k);
        let style = &self.scene.elements[k].style;
        let attributes = self.attributes(style, &fill, "none", 1.0, "miter");
        self.enter(attributes);
        let base = self.y.at(0.0f64.clamp(self.y.range[0], self.y.range[1]));
        let base = match base.is_finite() {
            true => base,
            false => self.y.pixels[0],
        };
        for (x, y) in self.pixels(ps) {
            let left = x + slot * (place - count / 2.0) + 0.04 * slot;
            let bar = rectangle([left, y.min(base)], [0.92 * slot, (y - base).abs()]);
            let _ = writeln!(self.out, "    {bar}");
        }
    }
}
