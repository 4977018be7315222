//! `draw`: a figure's elements are evaluated over their domains and become a scene, which is written as
//! SVG or PNG.
//!
//! Of several controlled indices the last one runs along a polygon, a line or a series; there is one of
//! those for each combination of the others.

mod chart;

use super::scan::Scans;
use super::{Frame, Machine};
use crate::check::node::{FigureCode, FigureElementCode, Node, SymbolId};
use crate::check::symbols::SymbolKind;
use crate::check::visit::Visitor;
use crate::data::universe::Label;
use crate::data::value::truth;
use crate::diag::{Diagnostic, nearest};
use crate::report::display::Numbers;
use crate::report::figure::{Anchor, Element, Paint, Scene, Shape, Style, png, svg};
use crate::report::format::{self, Value};
use crate::report::textfile::Item;
use crate::source::Span;
use std::sync::Arc;

/// Pixels of a PNG per pixel of the SVG.
const PNG_SCALE: f64 = 2.0;

/// Nothing to draw: a diagnostic says why.
struct Failed;

/// What is drawn, unless a diagnostic says why not.
type Drawn<T> = Result<T, Failed>;

/// The labels of one turn of an element.
struct Turns<'a> {
    element: &'a FigureElementCode,
    /// Flat, in label order.
    labels: Vec<Label>,
    /// Labels per turn.
    width: usize,
    /// Turns; 1 without an index.
    count: usize,
}

impl Machine<'_> {
    /// Draws a figure into a file.
    pub(super) fn draw(
        &mut self,
        figure: SymbolId,
        file: Option<&str>,
        frame: &mut Frame,
        span: Span,
    ) {
        let symbol = self.symbols.get(figure);
        let SymbolKind::Figure(code) = &symbol.kind else {
            return;
        };
        let code = Arc::clone(code);
        let file = file.map_or_else(|| format!("{}.svg", symbol.name), str::to_string);
        let lower = file.to_lowercase();
        if !lower.ends_with(".svg") && !lower.ends_with(".png") {
            Diagnostic::execution("E0481", span)
                .says(format!("`draw` cannot write `{file}`"))
                .label("a name that ends in .svg or .png is expected")
                .help(format!(
                    "write `draw {} '{}.svg';`",
                    symbol.name, symbol.name
                ))
                .note(self);
            return;
        }
        let name = symbol.name.to_string();
        self.look_soon();
        let Ok(scene) = self.scene(&code, frame) else {
            return;
        };
        if scene.elements.is_empty() {
            let message = format!("the figure `{name}` is empty: no element has a record to draw");
            Diagnostic::warning("E0484", span)
                .says(message)
                .label("drawn as an empty page")
                .help("`display` the data of its elements; a condition may leave nothing")
                .note(self);
        }
        let picture = svg(&scene);
        if lower.ends_with(".svg") {
            self.write_file(&file, picture.as_bytes(), span);
            return;
        }
        match png(&picture, PNG_SCALE) {
            Ok(bytes) => {
                self.write_file(&file, &bytes, span);
            }
            Err(e) => Diagnostic::execution("E0481", span)
                .says(format!("the figure cannot be drawn: {e}"))
                .note(self),
        }
    }

    fn scene(&mut self, code: &FigureCode, frame: &mut Frame) -> Drawn<Scene> {
        let mut scans = Scans::default();
        for e in &code.elements {
            e.domain.iter().for_each(|d| scans.domain(d));
            e.arguments.iter().for_each(|(_, n)| scans.node(n));
        }
        for &t in scans.tables().iter() {
            self.store.table_mut(t).tidy();
        }
        let mut scene = Scene {
            title: code.title.as_ref().map(|t| t.to_string()),
            ..Scene::default()
        };
        let mut legend = true;
        let all: Vec<Turns<'_>> = code.elements.iter().map(|e| self.turns(e, frame)).collect();
        let categories = self.categories(&all, &mut scene, frame);
        let nodes = self.nodes(&all, frame);
        for turns in all.iter().filter(|t| t.count > 0) {
            let e = turns.element;
            match &*e.kind {
                "title" => {
                    self.enter(turns, 0, frame);
                    let nodes: Vec<&Node> = e.arguments.iter().map(|a| &a.1).collect();
                    let text = self.text(&nodes, e.span, frame)?;
                    scene.subtitle = scene.title.take();
                    scene.title = Some(text);
                }
                "axes" | "xaxis" | "yaxis" | "size" => self.setting(e, &mut scene, frame)?,
                "legend" => {
                    for (_, n) in &e.arguments {
                        match self.text(&[n], e.span, frame)? {
                            t if t.eq_ignore_ascii_case("none") => legend = false,
                            t => scene.scale_label = Some(t),
                        }
                    }
                }
                "line" | "bar" | "errorbar" => self.chart(turns, &categories, &mut scene, frame)?,
                "heat" | "gantt" => self.cells(turns, &categories, &mut scene, frame)?,
                "contour" => self.contour(turns, &mut scene, frame)?,
                "node" | "arc" => self.network(turns, &nodes, &mut scene, frame)?,
                "polygon" | "polyline" => self.paths(turns, &mut scene, frame)?,
                _ => self.marks(turns, &mut scene, frame)?,
            }
        }
        if !legend {
            scene.elements.iter_mut().for_each(|e| e.name = None);
        }
        Ok(scene)
    }

    /// What an element runs over.
    fn turns<'a>(&self, element: &'a FigureElementCode, frame: &mut Frame) -> Turns<'a> {
        let none = Turns {
            element,
            labels: Vec::new(),
            width: 0,
            count: 1,
        };
        let Some(d) = &element.domain else {
            return none;
        };
        if d.slots.is_empty() {
            let there = d.conditions.iter().all(|c| truth(self.eval(c, frame)))
                && d.members
                    .iter()
                    .all(|m| self.is_member(m.table, &m.key, frame));
            return Turns {
                count: usize::from(there),
                ..none
            };
        }
        let labels = self.tuples(d, &[], frame);
        let width = d.slots.len();
        Turns {
            element,
            count: labels.len() / width,
            labels,
            width,
        }
    }

    /// Puts the labels of a turn into the frame.
    fn enter(&self, t: &Turns<'_>, k: usize, frame: &mut Frame) {
        if let Some(d) = &t.element.domain {
            for (&s, &l) in d.slots.iter().zip(t.key(k)) {
                frame[s as usize] = l;
            }
        }
    }

    /// `a.x`, for messages and names of series.
    fn turn_name(&self, key: &[Label]) -> String {
        let names: Vec<&str> = key.iter().map(|&l| self.store.universe.name(l)).collect();
        names.join(".")
    }

    /// A number that an element needs.
    fn number_of(&self, n: &Node, frame: &mut Frame) -> f64 {
        crate::data::value::number(self.eval(n, frame))
    }

    /// A point; None, and a warning, if a coordinate is not a number.
    fn point(
        &self,
        t: &Turns<'_>,
        k: usize,
        names: [&str; 2],
        frame: &mut Frame,
    ) -> Option<[f64; 2]> {
        let mut out = [0.0; 2];
        for (v, name) in out.iter_mut().zip(names) {
            let Some(n) = t.argument(name) else { continue };
            *v = self.number_of(n, frame);
            if !v.is_finite() {
                let at = match t.key(k) {
                    [] => String::new(),
                    key => format!(" at `{}`", self.turn_name(key)),
                };
                Diagnostic::warning("E0482", n.span)
                    .says(format!("`{name}` is {} {at}", self.shown(*v)).replace("  ", " "))
                    .label("left out of the figure")
                    .help("give it a value, or leave it out with a condition, `polygon(i,j)$c(i)`")
                    .note(self);
                return None;
            }
        }
        Some(out)
    }

    fn shown(&self, v: f64) -> String {
        Numbers::usual(&self.store.acronyms).text(v)
    }

    /// The text that an argument stands for: a text, or a format with values.
    fn text(&self, nodes: &[&Node], span: Span, frame: &mut Frame) -> Drawn<String> {
        let mut values = Vec::with_capacity(nodes.len());
        for n in nodes {
            values.push(match self.put_item(n, frame) {
                None => Value::Text(String::new()),
                Some(Item::Number(x)) => Value::number(x),
                Some(Item::Eps) => Value::number(0.0),
                Some(Item::Special(name)) => Value::Number(f64::NAN, Some(name)),
                Some(Item::Label(t) | Item::Text(t)) => Value::Text(t),
                Some(Item::Member(yes)) => Value::Text(if yes { "yes" } else { "no" }.into()),
                Some(Item::Page) => Value::Text(String::new()),
            });
        }
        let filled = match values.split_first() {
            // Without values a text is a text: a percent sign in it needs no second one.
            Some((first, [])) => Ok(format::plain(first)),
            Some((Value::Text(template), rest)) => format::fill(template, rest),
            Some(_) => format::fill("", &values),
            None => Ok(String::new()),
        };
        filled.map_err(|e| {
            let at = nodes.first().map_or(span, |n| n.span);
            Diagnostic::execution("E0483", at)
                .says(e)
                .label("in this text")
                .note(self);
            Failed
        })
    }

    /// A colour: a text, or a number for the scale.
    fn paint(&self, t: &Turns<'_>, name: &str, frame: &mut Frame) -> Drawn<Option<Paint>> {
        let Some(n) = t.argument(name) else {
            return Ok(None);
        };
        match self.put_item(n, frame) {
            Some(Item::Number(x)) => Ok(Some(Paint::Value(x))),
            Some(Item::Label(word) | Item::Text(word)) => match Paint::parse(&word) {
                Some(p) => Ok(Some(p)),
                None => {
                    let near = nearest(&word, Paint::names().iter().copied());
                    let others =
                        "colours are CSS names, `#rrggbb`, `none`, or numbers for the colour scale";
                    let d = Diagnostic::execution("E0372", n.span)
                        .says(format!("`{word}` is not a colour"))
                        .label("unknown colour");
                    self.give_up(d.did_you_mean(near, others))
                }
            },
            _ => Ok(None),
        }
    }

    fn style(&self, t: &Turns<'_>, frame: &mut Frame) -> Drawn<Style> {
        let mut number = |name: &str| {
            let v = self.number_of(t.argument(name)?, frame);
            v.is_finite().then_some(v)
        };
        let (width, opacity, size) = (number("width"), number("opacity"), number("size"));
        let dash = match t.argument("dash") {
            None => Vec::new(),
            Some(n) => match self.text(&[n], n.span, frame)?.to_lowercase().as_str() {
                "none" | "solid" | "" => Vec::new(),
                "dashed" => vec![6.0, 4.0],
                "dotted" => vec![1.5, 3.0],
                list => {
                    let lengths = list.split([' ', ',']).filter(|p| !p.is_empty());
                    let lengths = lengths.map(|p| p.parse().ok().filter(|x: &f64| *x >= 0.0));
                    let Some(lengths) = lengths.collect() else {
                        let d = Diagnostic::execution("E0483", n.span)
                            .says(format!("`{list}` is not a dash"))
                            .help("`dashed`, `dotted`, or lengths of dashes and gaps in pixels: `'6 2'`");
                        return self.give_up(d);
                    };
                    lengths
                }
            },
        };
        Ok(Style {
            fill: self.paint(t, "fill", frame)?,
            stroke: self.paint(t, "stroke", frame)?,
            width,
            opacity,
            dash,
            size,
        })
    }

    /// Notes why a picture is not drawn.
    fn give_up<T>(&self, d: Diagnostic) -> Drawn<T> {
        d.note(self);
        Err(Failed)
    }

    /// Name in the legend.
    fn legend_name(&self, t: &Turns<'_>, frame: &mut Frame) -> Drawn<Option<String>> {
        let name = self.text_of(t, "label", frame)?;
        Ok(name.filter(|t| !t.is_empty()))
    }

    /// The text of an argument, if it is given.
    fn text_of(&self, t: &Turns<'_>, name: &str, frame: &mut Frame) -> Drawn<Option<String>> {
        let text = t.argument(name).map(|n| self.text(&[n], n.span, frame));
        text.transpose()
    }

    /// The text of an element: `label`, a format for the bare values if there are any.
    fn text_beside(&self, t: &Turns<'_>, frame: &mut Frame) -> Drawn<Option<String>> {
        let bare = t.element.arguments.iter().filter(|a| a.0.is_none());
        let nodes: Vec<&Node> = t
            .argument("label")
            .into_iter()
            .chain(bare.map(|a| &a.1))
            .collect();
        match nodes.is_empty() {
            true => Ok(None),
            false => self.text(&nodes, t.element.span, frame).map(Some),
        }
    }

    /// The panel of small multiples that an element belongs to.
    fn panel(&self, t: &Turns<'_>, frame: &mut Frame) -> Drawn<Option<String>> {
        self.text_of(t, "panel", frame)
    }

    /// Adds an element to a picture; fails once the run is to stop.
    fn add(
        &self,
        scene: &mut Scene,
        (shape, style, name, panel): (Shape, Style, Option<String>, Option<String>),
    ) -> Drawn<()> {
        scene.elements.push(Element {
            shape,
            style,
            name,
            panel,
        });
        self.going()
    }

    /// Fails once the run is to stop.
    fn going(&self) -> Drawn<()> {
        self.keep_going().then_some(()).ok_or(Failed)
    }

    /// Polygons and polylines.
    fn paths(&self, t: &Turns<'_>, scene: &mut Scene, frame: &mut Frame) -> Drawn<()> {
        for range in t.runs() {
            self.enter(t, range.start, frame);
            let style = self.style(t, frame)?;
            let name = self.legend_name(t, frame)?;
            let mut points = Vec::with_capacity(range.len());
            for k in range {
                self.enter(t, k, frame);
                points.extend(self.point(t, k, ["x", "y"], frame));
            }
            let shape = if &*t.element.kind == "polygon" {
                Shape::Polygon(points)
            } else {
                Shape::Polyline(points)
            };
            let panel = self.panel(t, frame)?;
            self.add(scene, (shape, style, name, panel))?;
        }
        Ok(())
    }

    /// Points, arrows and texts.
    fn marks(&self, t: &Turns<'_>, scene: &mut Scene, frame: &mut Frame) -> Drawn<()> {
        let kind = &*t.element.kind;
        let first = scene.elements.len();
        for k in 0..t.count {
            self.enter(t, k, frame);
            let Some(at) = self.point(t, k, ["x", "y"], frame) else {
                continue;
            };
            let style = self.style(t, frame)?;
            let panel = self.panel(t, frame)?;
            match kind {
                "points" => {
                    let name = self.legend_name(t, frame)?;
                    // Points that look alike are one element.
                    match scene.elements[first..].last_mut() {
                        Some(Element {
                            shape: Shape::Points(list),
                            style: s,
                            name: n,
                            panel: p,
                        }) if *s == style && *n == name && *p == panel => {
                            list.push(at);
                            self.going()?;
                        }
                        _ => self.add(scene, (Shape::Points(vec![at]), style, name, panel))?,
                    }
                }
                "arrow" => {
                    let Some(by) = self.point(t, k, ["dx", "dy"], frame) else {
                        continue;
                    };
                    let name = self.legend_name(t, frame)?;
                    self.add(scene, (Shape::Arrow(at, by), style, name, panel))?;
                }
                _ => {
                    let text = self.text_beside(t, frame)?.unwrap_or_default();
                    let anchor = match t.argument("align") {
                        None => Anchor::default(),
                        Some(n) => match self.text(&[n], n.span, frame)?.to_lowercase().as_str() {
                            "start" | "left" => Anchor::Start,
                            "end" | "right" => Anchor::End,
                            "middle" | "center" | "centre" => Anchor::Middle,
                            other => {
                                let d = Diagnostic::execution("E0483", n.span)
                                    .says(format!("`{other}` is not an alignment"));
                                return self.give_up(d.help("there are: start, middle, end"));
                            }
                        },
                    };
                    self.add(scene, (Shape::Text(at, text, anchor), style, None, panel))?;
                }
            }
        }
        Ok(())
    }

    /// `axes`, `xaxis`, `yaxis`, `size`.
    fn setting(&self, e: &FigureElementCode, scene: &mut Scene, frame: &mut Frame) -> Drawn<()> {
        let mut numbers = Vec::new();
        for (name, n) in &e.arguments {
            if &*e.kind == "size" {
                let v = self.number_of(n, frame);
                if !v.is_finite() || v <= 0.0 {
                    let d = Diagnostic::execution("E0483", n.span);
                    return self
                        .give_up(d.says(format!("{} is not a size in pixels", self.shown(v))));
                }
                match name.as_deref() {
                    Some("width") => scene.width = Some(v),
                    Some(_) => scene.height = Some(v),
                    None => numbers.push(v),
                }
                continue;
            }
            if let Some(end @ ("min" | "max")) = name.as_deref() {
                let v = self.number_of(n, frame);
                let limits = match &*e.kind {
                    "xaxis" => &mut scene.x_limits,
                    _ => &mut scene.y_limits,
                };
                limits[usize::from(end == "max")] = v.is_finite().then_some(v);
                continue;
            }
            let text = self.text(&[n], e.span, frame)?;
            let word = text.to_lowercase();
            match (&*e.kind, name.as_deref()) {
                ("axes", Some("x")) | ("xaxis", Some(_)) => scene.x_label = Some(text),
                ("axes", Some(_)) | ("yaxis", Some(_)) => scene.y_label = Some(text),
                ("axes", None) => match word.as_str() {
                    "none" => scene.axes = Some(false),
                    "on" => scene.axes = Some(true),
                    "equal" => scene.equal = Some(true),
                    "free" => scene.equal = Some(false),
                    "xlog" => scene.x_log = true,
                    _ => scene.y_log = true,
                },
                ("xaxis", None) if word == "log" => scene.x_log = true,
                ("yaxis", None) if word == "log" => scene.y_log = true,
                ("xaxis", None) => scene.x_label = Some(text),
                _ => scene.y_label = Some(text),
            }
        }
        let mut numbers = numbers.into_iter();
        scene.width = numbers.next().or(scene.width);
        scene.height = numbers.next().or(scene.height);
        // Who writes about axes wants to see them.
        if &*e.kind != "size" && scene.axes.is_none() {
            scene.axes = Some(true);
        }
        Ok(())
    }
}

impl Turns<'_> {
    fn key(&self, k: usize) -> &[Label] {
        &self.labels[k * self.width..(k + 1) * self.width]
    }

    fn argument(&self, name: &str) -> Option<&Node> {
        self.element
            .arguments
            .iter()
            .find(|a| a.0.as_deref() == Some(name))
            .map(|a| &a.1)
    }

    /// Turns that differ in the last index only.
    fn runs(&self) -> Vec<std::ops::Range<usize>> {
        let mut out: Vec<std::ops::Range<usize>> = Vec::new();
        let lead = self.width.saturating_sub(1);
        for k in 0..self.count {
            match out.last_mut() {
                Some(r) if self.key(r.start)[..lead] == self.key(k)[..lead] => r.end = k + 1,
                _ => out.push(k..k + 1),
            }
        }
        out
    }
}
