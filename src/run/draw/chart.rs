//! Elements of charts: lines, bars and error bars against numbers or labels, heat maps, Gantt charts,
//! contours and networks.

use super::{Drawn, Turns};
use crate::check::figure::is_text;
use crate::data::universe::Label;
use crate::diag::Diagnostic;
use crate::report::figure::{Anchor, Paint, Scene, Shape, Style, series};
use crate::run::{Frame, Machine};
use rustc_hash::FxHashMap;

/// Diameter of a node in pixels.
const NODE_SIZE: f64 = 38.0;
/// Most levels of a contour.
const MAX_LEVELS: f64 = 100.0;

/// Where the labels stand that charts are drawn against.
#[derive(Default)]
pub(super) struct Categories {
    x: FxHashMap<String, f64>,
    y: FxHashMap<String, f64>,
}

/// Where the nodes of a network stand, by label, and their diameters in pixels.
pub(super) type Nodes = FxHashMap<Label, ([f64; 2], f64)>;

/// Adds a label to an axis that does not have it.
fn place(names: &mut Vec<String>, places: &mut FxHashMap<String, f64>, name: String, sign: f64) {
    places.entry(name).or_insert_with_key(|name| {
        names.push(name.clone());
        sign * names.len() as f64
    });
}

impl Machine<'_> {
    /// The labels that charts stand against, all elements of the figure together.
    pub(super) fn categories(
        &self,
        all: &[Turns<'_>],
        scene: &mut Scene,
        frame: &mut Frame,
    ) -> Categories {
        let mut out = Categories::default();
        let name = |l: Label| self.store.universe.name(l).to_string();
        let column = |t: &Turns<'_>, at: usize| -> Vec<Label> {
            (0..t.count).map(|k| t.key(k)[at]).collect()
        };
        let charts = |t: &&Turns<'_>| matches!(&*t.element.kind, "line" | "bar" | "errorbar");
        // Labels of sets come in the order of the sets, whatever element has them.
        let mut labels = Vec::new();
        for t in all.iter().filter(charts) {
            match t.argument("x") {
                None => labels.extend(column(t, t.width - 1)),
                Some(n) if is_text(n) => {
                    for k in 0..t.count {
                        self.enter(t, k, frame);
                        if let Ok(text) = self.text(&[n], n.span, frame) {
                            place(&mut scene.categories, &mut out.x, text, 1.0);
                        }
                    }
                }
                Some(_) => {}
            }
        }
        let mut rows = Vec::new();
        for t in all {
            match &*t.element.kind {
                "heat" => {
                    labels.extend(column(t, t.width - 2));
                    rows.extend(column(t, t.width - 1));
                }
                "gantt" => rows.extend(column(t, 0)),
                _ => {}
            }
        }
        for l in sorted(labels) {
            place(&mut scene.categories, &mut out.x, name(l), 1.0);
        }
        for l in sorted(rows) {
            place(&mut scene.y_categories, &mut out.y, name(l), -1.0);
        }
        out
    }

    /// Series of lines, bars or error bars, against `x` or against the last index.
    pub(super) fn chart(
        &self,
        t: &Turns<'_>,
        categories: &Categories,
        scene: &mut Scene,
        frame: &mut Frame,
    ) -> Drawn<()> {
        let kind = &*t.element.kind;
        let ends = match kind {
            "errorbar" => ["low", "high"],
            _ => ["y", "y"],
        };
        for range in t.runs() {
            self.enter(t, range.start, frame);
            let style = self.style(t, frame)?;
            let panel = self.panel(t, frame)?;
            let leading = &t.key(range.start)[..t.width - 1];
            let name = match self.legend_name(t, frame)? {
                Some(n) => Some(n),
                // An empty label: not in the legend.
                None if t.argument("label").is_some() => None,
                None if leading.is_empty() || kind == "errorbar" => None,
                None => Some(self.turn_name(leading)),
            };
            let mut points: Vec<[f64; 3]> = Vec::with_capacity(range.len());
            for k in range {
                self.enter(t, k, frame);
                let Some([low, high]) = self.point(t, k, ends, frame) else {
                    continue;
                };
                let at = |text: &str| categories.x.get(text).copied();
                let x = match t.argument("x") {
                    None => at(self.store.universe.name(t.key(k)[t.width - 1])),
                    Some(n) if is_text(n) => at(&self.text(&[n], n.span, frame)?),
                    Some(_) => self.point(t, k, ["x", "x"], frame).map(|p| p[0]),
                };
                points.extend(x.map(|x| [x, low, high]));
            }
            let pairs =
                |points: Vec<[f64; 3]>| points.into_iter().map(|[x, y, _]| [x, y]).collect();
            let shape = match kind {
                "bar" => Shape::Bars(pairs(points)),
                "line" => Shape::Line(pairs(points)),
                _ => Shape::Whiskers(points),
            };
            self.add(scene, (shape, style, name, panel))?;
        }
        Ok(())
    }

    /// Cells of a heat map, bars of a Gantt chart; a label stands in the middle of each.
    pub(super) fn cells(
        &self,
        t: &Turns<'_>,
        categories: &Categories,
        scene: &mut Scene,
        frame: &mut Frame,
    ) -> Drawn<()> {
        let is_heat = &*t.element.kind == "heat";
        scene.axes.get_or_insert(true);
        scene.equal.get_or_insert(false);
        let place = |l: Label, of: &FxHashMap<String, f64>| {
            of.get(self.store.universe.name(l)).copied().unwrap_or(0.0)
        };
        let jobs = sorted((0..t.count).map(|k| t.key(k)[t.width - 1]).collect());
        for k in 0..t.count {
            self.enter(t, k, frame);
            let (ends, row, half) = if is_heat {
                let x = place(t.key(k)[t.width - 2], &categories.x);
                let row = place(t.key(k)[t.width - 1], &categories.y);
                ([x - 0.5, x + 0.5], row, 0.5)
            } else {
                let Some(ends) = self.point(t, k, ["from", "to"], frame) else {
                    continue;
                };
                (ends, place(t.key(k)[0], &categories.y), 0.36)
            };
            let mut style = self.style(t, frame)?;
            let mut name = None;
            if is_heat {
                let Some([value, _]) = self.point(t, k, ["value", "value"], frame) else {
                    continue;
                };
                style.fill = Some(Paint::Value(value));
                style.stroke = Some(Paint::None);
            } else {
                // Bars have the colour of their last index, which the legend names.
                let last = t.key(k)[t.width - 1];
                let number = jobs.binary_search(&last).unwrap_or(0);
                style
                    .fill
                    .get_or_insert(Paint::Color(series(number).into()));
                name = Some(self.turn_name(&[last]));
            }
            let label = self.text_beside(t, frame)?.filter(|l| !l.is_empty());
            let panel = self.panel(t, frame)?;
            let [left, right] = ends;
            let corners = vec![
                [left, row - half],
                [right, row - half],
                [right, row + half],
                [left, row + half],
            ];
            self.add(scene, (Shape::Polygon(corners), style, name, panel.clone()))?;
            if let Some(label) = label {
                let text = Shape::Text([(left + right) / 2.0, row], label, Anchor::Middle);
                self.add(scene, (text, Style::sized(11.0), None, panel))?;
            }
        }
        Ok(())
    }

    /// Lines of equal z on the grid of the last two indices.
    pub(super) fn contour(&self, t: &Turns<'_>, scene: &mut Scene, frame: &mut Frame) -> Drawn<()> {
        scene.axes.get_or_insert(true);
        scene.equal.get_or_insert(false);
        let (mut xs, mut ys): (Vec<Label>, Vec<Label>) = (Vec::new(), Vec::new());
        let mut values = FxHashMap::default();
        for k in 0..t.count {
            self.enter(t, k, frame);
            let (Some(at), Some([z, _])) = (
                self.point(t, k, ["x", "y"], frame),
                self.point(t, k, ["z", "z"], frame),
            ) else {
                continue;
            };
            let [i, j] = [t.key(k)[t.width - 2], t.key(k)[t.width - 1]];
            xs.push(i);
            ys.push(j);
            values.insert((i, j), [at[0], at[1], z]);
        }
        let (xs, ys) = (sorted(xs), sorted(ys));
        let heights = || values.values().map(|v| v[2]);
        let low = heights().fold(f64::INFINITY, f64::min);
        let high = heights().fold(f64::NEG_INFINITY, f64::max);
        if t.count == 0 || low >= high {
            return Ok(());
        }
        self.enter(t, 0, frame);
        let count = t
            .argument("levels")
            .map_or(8.0, |n| self.number_of(n, frame));
        if !(1.0..=MAX_LEVELS).contains(&count) {
            let span = t.argument("levels").map_or(t.element.span, |n| n.span);
            let levels = format!("number of levels from 1 to {MAX_LEVELS}");
            let message = format!("{} is not a {levels}", self.shown(count));
            return self.give_up(Diagnostic::execution("E0483", span).says(message));
        }
        let style = self.style(t, frame)?;
        let panel = self.panel(t, frame)?;
        for level in 1..=count as usize {
            let height = low + (high - low) * level as f64 / (count.floor() + 1.0);
            let mut segments = Vec::new();
            for pair in xs.windows(2) {
                for other in ys.windows(2) {
                    let corner = |i: usize, j: usize| values.get(&(pair[i], other[j])).copied();
                    if let (Some(a), Some(b), Some(c), Some(d)) =
                        (corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1))
                    {
                        // Two triangles: no ambiguous saddle.
                        segments.extend(cut([a, b, c], height));
                        segments.extend(cut([a, c, d], height));
                    }
                }
            }
            for points in segments {
                let mut style = style.clone();
                style.stroke.get_or_insert(Paint::Value(height));
                let line = Shape::Polyline(points.to_vec());
                self.add(scene, (line, style, None, panel.clone()))?;
            }
        }
        Ok(())
    }

    /// Where the nodes of all `node` elements stand: at `x`, `y`, or on a circle.
    pub(super) fn nodes(&self, all: &[Turns<'_>], frame: &mut Frame) -> Nodes {
        let mut out = Nodes::default();
        for t in all.iter().filter(|t| &*t.element.kind == "node") {
            for k in 0..t.count {
                self.enter(t, k, frame);
                let at = if t.argument("x").is_some() && t.argument("y").is_some() {
                    self.point(t, k, ["x", "y"], frame)
                } else {
                    // From the top, clockwise.
                    let turn = std::f64::consts::TAU * k as f64 / t.count as f64;
                    Some([turn.sin(), turn.cos()])
                };
                let size = t.argument("size").map(|n| self.number_of(n, frame));
                let size = size.filter(|s| s.is_finite()).unwrap_or(NODE_SIZE);
                out.extend(at.map(|at| (t.key(k)[t.width - 1], (at, size))));
            }
        }
        out
    }

    /// Nodes with their names, arcs between them.
    pub(super) fn network(
        &self,
        t: &Turns<'_>,
        nodes: &Nodes,
        scene: &mut Scene,
        frame: &mut Frame,
    ) -> Drawn<()> {
        let is_node = &*t.element.kind == "node";
        for k in 0..t.count {
            self.enter(t, k, frame);
            let mut style = self.style(t, frame)?;
            let panel = self.panel(t, frame)?;
            let label = self.text_beside(t, frame)?.filter(|l| !l.is_empty());
            let last = t.key(k)[t.width - 1];
            let mut add = |shape, style| self.add(scene, (shape, style, None, panel.clone()));
            let text_style = Style::sized(11.5);
            if is_node {
                let Some(&(at, size)) = nodes.get(&last) else {
                    continue;
                };
                style.size = Some(size);
                style.fill.get_or_insert(Paint::Color("#eef2f7".into()));
                style.stroke.get_or_insert(Paint::Color("#2b3440".into()));
                add(Shape::Points(vec![at]), style)?;
                let label = label.unwrap_or_else(|| self.turn_name(&[last]));
                add(Shape::Text(at, label, Anchor::Middle), text_style)?;
            } else {
                let first = t.key(k)[t.width - 2];
                let (Some(&(from, a)), Some(&(to, b))) = (nodes.get(&first), nodes.get(&last))
                else {
                    let there = nodes.contains_key(&first);
                    let missing = if there { last } else { first };
                    let name = self.turn_name(&[missing]);
                    Diagnostic::warning("E0482", t.element.span)
                        .says(format!("`arc` leads to `{name}`, which no `node` draws"))
                        .label("left out of the figure")
                        .help("draw the nodes first: `node(i) x = px(i), y = py(i);`")
                        .note(self);
                    continue;
                };
                add(Shape::Arc(from, to, a.max(b) / 2.0 + 1.0), style)?;
                if let Some(label) = label {
                    let middle = [(from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0];
                    add(Shape::Text(middle, label, Anchor::Middle), text_style)?;
                }
            }
        }
        Ok(())
    }
}

/// Labels in their order, each once.
fn sorted(mut labels: Vec<Label>) -> Vec<Label> {
    labels.sort_unstable();
    labels.dedup();
    labels
}

/// The segment in which a plane over a triangle has this height.
fn cut(corners: [[f64; 3]; 3], height: f64) -> Option<[[f64; 2]; 2]> {
    let mut ends = Vec::with_capacity(2);
    for (k, a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % 3];
        if (a[2] < height) != (b[2] < height) {
            let part = (height - a[2]) / (b[2] - a[2]);
            ends.push([a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]);
        }
    }
    ends.try_into().ok()
}
