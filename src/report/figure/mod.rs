//! Figures: from plain numbers and texts to SVG and PNG.
//!
//! A [`Scene`] holds what is to be seen, in the reader's coordinates with y upwards. It knows no
//! names and no tables; the `figure` statement fills it. [`svg()`] lays it out and writes it,
//! [`png()`] rasterises what [`svg()`] wrote.
//!
//! Geometry (polygons, polylines, points, arrows, texts) is drawn with equal aspect and without
//! axes, charts (lines, bars) with a free aspect and axes, unless the scene says otherwise.
//!
//! Invariants: the same scene gives the same bytes; points that are not finite are left out, never
//! written; every text is escaped.

mod layout;
#[cfg(feature = "png")]
pub mod png;
mod svg;

pub use crate::color::{Paint, series};
#[cfg(feature = "png")]
pub use png::png;
pub use svg::svg;

/// A build without the feature `png` writes SVG only.
#[cfg(not(feature = "png"))]
pub fn png(_: &str, _: f64) -> Result<Vec<u8>, String> {
    Err("this build of bmod writes SVG only".into())
}

/// Something to see.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Above the picture.
    pub title: Option<String>,
    /// A smaller line under the title.
    pub subtitle: Option<String>,
    /// What is drawn, in this order.
    pub elements: Vec<Element>,
    /// Axes on or off; None: on for charts, off for geometry.
    pub axes: Option<bool>,
    /// Whether a unit is as long in y as in x; None: for geometry, not for charts.
    pub equal: Option<bool>,
    /// Text at the horizontal axis.
    pub x_label: Option<String>,
    /// Text at the vertical axis.
    pub y_label: Option<String>,
    /// Labels of the horizontal axis: label k stands at x = k + 1 (a chart against a set). Empty:
    /// the axis has numbers.
    pub categories: Vec<String>,
    /// Labels of the vertical axis from the top: label k stands at y = −(k + 1). Empty: the axis has numbers.
    pub y_categories: Vec<String>,
    /// Ends of the horizontal axis; None: from the data.
    pub x_limits: [Option<f64>; 2],
    /// Ends of the vertical axis; None: from the data.
    pub y_limits: [Option<f64>; 2],
    /// Horizontal axis with logarithmic scale.
    pub x_log: bool,
    /// Vertical axis with logarithmic scale.
    pub y_log: bool,
    /// Text above the colour scale's legend.
    pub scale_label: Option<String>,
    /// Width of the picture in pixels; None: 720.
    pub width: Option<f64>,
    /// Height of the picture in pixels; None: what the contents need.
    pub height: Option<f64>,
}

/// One thing drawn.
#[derive(Clone, Debug)]
pub struct Element {
    /// Its shape and place.
    pub shape: Shape,
    /// Its looks.
    pub style: Style,
    /// Its name in the legend; elements with the same name share one entry.
    pub name: Option<String>,
    /// Its panel, where a figure is a grid of small ones; None: in every panel.
    pub panel: Option<String>,
}

/// Shapes, in the scene's coordinates.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A closed area.
    Polygon(Vec<[f64; 2]>),
    /// A line from point to point.
    Polyline(Vec<[f64; 2]>),
    /// A dot at each point.
    Points(Vec<[f64; 2]>),
    /// From a point, by a vector, with a head.
    Arrow([f64; 2], [f64; 2]),
    /// A text at a point.
    Text([f64; 2], String, Anchor),
    /// A line chart's series: one x and y per point.
    Line(Vec<[f64; 2]>),
    /// A bar chart's series: position (see [`Scene::categories`]) and height of each bar. Series
    /// stand side by side.
    Bars(Vec<[f64; 2]>),
    /// Error bars: x, low and high end of each.
    Whiskers(Vec<[f64; 3]>),
    /// An arrow between two nodes of a network, that ends so many pixels before either.
    Arc([f64; 2], [f64; 2], f64),
}

/// Which part of a text stands at its point.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Anchor {
    /// Its beginning.
    Start,
    /// Its middle.
    #[default]
    Middle,
    /// Its end.
    End,
}

/// Looks; None: the default of the shape.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Style {
    /// Colour of the inside.
    pub fill: Option<Paint>,
    /// Colour of the line.
    pub stroke: Option<Paint>,
    /// Width of the line in pixels.
    pub width: Option<f64>,
    /// 0 (invisible) to 1.
    pub opacity: Option<f64>,
    /// Lengths of dashes and gaps in pixels; empty: solid.
    pub dash: Vec<f64>,
    /// Size of a text in pixels, diameter of a point in pixels.
    pub size: Option<f64>,
}

impl Style {
    /// The usual one, with a size in pixels.
    pub fn sized(size: f64) -> Self {
        Self {
            size: Some(size),
            ..Self::default()
        }
    }
}

impl Element {
    /// A shape with default looks.
    pub fn new(shape: Shape) -> Self {
        Self {
            shape,
            style: Style::default(),
            name: None,
            panel: None,
        }
    }

    /// With these looks.
    pub fn style(mut self, style: Style) -> Self {
        self.style = style;
        self
    }

    /// With a name for the legend.
    pub fn name(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }
}

#[cfg(all(test, feature = "png"))]
mod tests;
