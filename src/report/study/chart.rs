//! The picture of a work–precision study: error over time, both logarithmic; one line per solver, named at its end.
//! Times differ from run to run, and so does the picture.

use std::fmt::Write;

use crate::color::series;
use crate::solve::study::{Run, Study};

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 50.0;
/// Points of a line that are as near as this, in pixels, share a label.
const NEAR: f64 = 5.0;

/// A rectangle in pixels: left, top, right, bottom.
type Rectangle = [f64; 4];

fn overlap(a: &Rectangle, b: &Rectangle) -> f64 {
    let wide = a[2].min(b[2]) - a[0].max(b[0]);
    let high = a[3].min(b[3]) - a[1].max(b[1]);
    wide.max(0.0) * high.max(0.0)
}

/// A logarithmic axis: the values at its ends, the pixels there, and the values of its ticks.
struct Axis {
    ends: [f64; 2],
    pixels: [f64; 2],
    ticks: Vec<f64>,
}

impl Axis {
    /// An axis for positive values, with at most `count` ticks.
    fn new(values: &[f64], pixels: [f64; 2], count: usize) -> Self {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(0.0, f64::max);
        let (low, high) = match low <= high {
            true => (low, high),
            false => (0.1, 10.0),
        };
        let ends = [low / 1.5, high * 1.5];
        let decades = (ends[1] / ends[0]).log10();
        let first = ends[0].log10().floor() as i32;
        let last = ends[1].log10().ceil() as i32;
        let steps: &[f64] = match decades {
            d if d < 1.0 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
            d if d < 3.0 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let every = (decades / count as f64).ceil().max(1.0) as usize;
        let ticks = (first..=last)
            .step_by(every)
            .flat_map(|k| steps.iter().map(move |s| format!("{s}e{k}")))
            .filter_map(|text| text.parse().ok())
            .filter(|t| (ends[0]..=ends[1]).contains(t))
            .collect();
        Self {
            ends,
            pixels,
            ticks,
        }
    }

    fn at(&self, v: f64) -> f64 {
        let part = (v / self.ends[0]).ln() / (self.ends[1] / self.ends[0]).ln();
        self.pixels[0] + part * (self.pixels[1] - self.pixels[0])
    }
}

/// Labels that keep clear of each other, of the points and of the picture's edge.
struct Labels {
    taken: Vec<Rectangle>,
    out: String,
}

impl Labels {
    /// Writes a label beside a point, where it covers least of what is there.
    fn add(&mut self, [x, y]: [f64; 2], text: &str, size: f64, color: &str, weight: &str) {
        let width = 0.56 * size * text.chars().count() as f64;
        let mut best: Option<(f64, [f64; 2], Rectangle)> = None;
        for distance in [0.0, 12.0, 24.0, 40.0] {
            let (dx, dy) = (7.0 + distance, 8.0 + distance);
            let middle = y + 0.35 * size;
            for at in [
                [x + dx, middle],
                [x + 5.0, y - dy],
                [x + 5.0, y + dy + 0.7 * size],
                [x - dx - width, middle],
                [x - 5.0 - width, y - dy],
                [x - 5.0 - width, y + dy + 0.7 * size],
                [x - 0.5 * width, y - dy],
                [x - 0.5 * width, y + dy + 0.7 * size],
            ] {
                let mine = [at[0], at[1] - 0.8 * size, at[0] + width, at[1] + 0.2 * size];
                let frame = [LEFT, TOP, WIDTH - RIGHT, HEIGHT - BOTTOM];
                let outside = width * size - overlap(&mine, &frame);
                let covered: f64 = self.taken.iter().map(|t| overlap(t, &mine)).sum();
                let cost = 4.0 * outside + covered + 0.2 * distance;
                if best.is_none_or(|b| cost < b.0 - 1e-9) {
                    best = Some((cost, at, mine));
                }
            }
        }
        let Some((_, at, mine)) = best else { return };
        self.taken.push(mine);
        if (at[0] - x).abs().max((at[1] - y).abs()) > 30.0 + width {
            let _ = writeln!(
                self.out,
                "<path d=\"M{x:.1} {y:.1}L{:.1} {:.1}\" stroke=\"#aaa\" stroke-width=\"0.5\"/>",
                at[0] + 0.5 * width,
                at[1] - 0.3 * size
            );
        }
        let _ = writeln!(
            self.out,
            "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"{size}\" font-weight=\"{weight}\" fill=\"{color}\" \
             stroke=\"white\" stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
            at[0],
            at[1],
            escaped(text)
        );
    }
}

/// The picture. Errors that are exactly 0 stand on a line of their own below the others.
pub fn svg(title: &str, s: &Study) -> String {
    let drawn: Vec<(&Run, f64)> = s
        .runs
        .iter()
        .filter_map(|r| Some((r, r.error.filter(|e| e.is_finite())?)))
        .collect();
    let least = drawn.iter().map(|d| d.1).filter(|&e| e > 0.0);
    let least = least.fold(f64::INFINITY, f64::min).min(1.0);
    // An error of 0 has no logarithm: its line is a decade (or a tenth of the axis) below.
    let most = drawn.iter().map(|d| d.1).fold(least, f64::max);
    let zero = least / (most / least).powf(0.1).max(10.0);
    let errors: Vec<f64> = drawn
        .iter()
        .map(|d| if d.1 > 0.0 { d.1 } else { zero })
        .collect();
    let times: Vec<f64> = drawn.iter().map(|d| d.0.seconds.max(1e-9)).collect();
    let x = Axis::new(&times, [LEFT, WIDTH - RIGHT], 8);
    let y = Axis::new(&errors, [HEIGHT - BOTTOM, TOP], 9);
    let has_zero = drawn.iter().any(|d| d.1 == 0.0);
    let mut out = frame(title, &x, &y, has_zero.then_some((zero, least)));
    let points: Vec<[f64; 2]> = times
        .iter()
        .zip(&errors)
        .map(|(&t, &e)| [x.at(t), y.at(e)])
        .collect();
    let around = |p: &[f64; 2]| [p[0] - 4.0, p[1] - 4.0, p[0] + 4.0, p[1] + 4.0];
    let mut labels = Labels {
        taken: points.iter().map(around).collect(),
        out: String::new(),
    };
    let mut families: Vec<&str> = Vec::new();
    for d in &drawn {
        if !families.contains(&d.0.way.family) {
            families.push(d.0.way.family);
        }
    }
    let of = |family: &str| -> Vec<usize> {
        (0..drawn.len())
            .filter(|&k| drawn[k].0.way.family == family)
            .collect()
    };
    for (k, family) in families.iter().enumerate() {
        let mine = of(family);
        let path: Vec<String> = mine
            .iter()
            .map(|&k| format!("{:.1},{:.1}", points[k][0], points[k][1]))
            .collect();
        // Labels keep off the lines where they can.
        for pair in mine.windows(2) {
            let ([x0, y0], [x1, y1]) = (points[pair[0]], points[pair[1]]);
            let count = ((x1 - x0).hypot(y1 - y0) / 4.0).ceil().max(1.0);
            labels.taken.extend((0..count as usize).map(|k| {
                let part = k as f64 / count;
                let (x, y) = (x0 + part * (x1 - x0), y0 + part * (y1 - y0));
                [x - 1.5, y - 1.5, x + 1.5, y + 1.5]
            }));
        }
        let color = series(k);
        let _ = writeln!(
            out,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"/>",
            path.join(" ")
        );
        for &k in &mine {
            let [x, y] = points[k];
            let _ = writeln!(
                out,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{color}\"/>"
            );
        }
        // The name at the first point, which the others are more often near to.
        labels.add(points[mine[0]], family, 12.0, color, "bold");
    }
    for (k, family) in families.iter().enumerate() {
        let mut left = of(family);
        while let Some(&first) = left.first() {
            let near = |k: &usize| {
                let [dx, dy] = [0, 1].map(|c: usize| (points[*k][c] - points[first][c]).abs());
                dx.max(dy) <= NEAR
            };
            let here: Vec<&str> = left
                .iter()
                .filter(|k| near(k))
                .map(|&k| &*drawn[k].0.way.setting)
                .collect();
            labels.add(points[first], &here.join(", "), 10.0, series(k), "normal");
            left.retain(|k| !near(k));
        }
    }
    out + &labels.out + "</svg>\n"
}

/// Title, grid and axes. `zero`: where errors of 0 are drawn, and the least of the others.
fn frame(title: &str, x: &Axis, y: &Axis, zero: Option<(f64, f64)>) -> String {
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"Inter, sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{LEFT}\" y=\"24\" font-size=\"14\">{}</text>\n",
        escaped(title)
    );
    let bottom = HEIGHT - BOTTOM;
    for &t in &x.ticks {
        let at = x.at(t);
        let _ = writeln!(
            out,
            "<path d=\"M{at:.1} {TOP}V{bottom}\" stroke=\"#ddd\"/><text x=\"{at:.1}\" y=\"{:.1}\" \
             text-anchor=\"middle\">{}</text>",
            bottom + 18.0,
            number(t)
        );
    }
    let above = zero.map_or(0.0, |z| 0.5 * z.1);
    let marks = y.ticks.iter().filter(|&&t| t > above);
    let zero = zero.map(|z| (z.0, "0".to_string()));
    for (t, name) in marks.map(|&t| (t, format!("{t:e}"))).chain(zero) {
        let at = y.at(t);
        let _ = writeln!(
            out,
            "<path d=\"M{LEFT} {at:.1}H{}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{:.1}\" \
             text-anchor=\"end\">{name}</text>",
            WIDTH - RIGHT,
            LEFT - 6.0,
            at + 4.0
        );
    }
    let (middle, center) = ((LEFT + WIDTH - RIGHT) / 2.0, HEIGHT / 2.0);
    let _ = writeln!(
        out,
        "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">seconds</text>\n\
         <text x=\"14\" y=\"{center}\" text-anchor=\"middle\" transform=\"rotate(-90 14 {center})\">error</text>",
        HEIGHT - 12.0
    );
    out
}

/// A time in seconds.
fn number(v: f64) -> String {
    if (1e-3..1e4).contains(&v) {
        v.to_string()
    } else {
        format!("{v:e}")
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
