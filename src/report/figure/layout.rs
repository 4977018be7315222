//! Where things go: ranges, ticks, and the map from the scene's coordinates to pixels.

use super::{Scene, Shape};

/// An axis: a range of the scene's coordinate laid on a range of pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// Coordinates at the two ends.
    pub range: [f64; 2],
    /// Pixels at the two ends.
    pub pixels: [f64; 2],
    /// Logarithmic.
    pub log: bool,
}

impl Axis {
    /// Pixel of a coordinate. NaN for what a logarithmic axis cannot show.
    pub(super) fn at(&self, v: f64) -> f64 {
        let f = |v: f64| if self.log { v.log10() } else { v };
        let [lo, hi] = [f(self.range[0]), f(self.range[1])];
        let part = if hi > lo {
            (f(v) - lo) / (hi - lo)
        } else {
            0.5
        };
        self.pixels[0] + part * (self.pixels[1] - self.pixels[0])
    }
}

/// Whether a coordinate can be shown; beyond 1e100 the arithmetic of ranges would overflow.
pub(super) fn visible(v: f64) -> bool {
    v.abs() <= 1e100
}

/// The smallest ranges in x and y that hold all shapes; None where there is nothing to hold.
pub(super) fn extent(scene: &Scene) -> [Option<[f64; 2]>; 2] {
    let mut range: [Option<[f64; 2]>; 2] = [None, None];
    let mut see = |axis: usize, v: f64, log: bool| {
        if visible(v) && (!log || v > 0.0) {
            let r = range[axis].get_or_insert([v, v]);
            *r = [r[0].min(v), r[1].max(v)];
        }
    };
    let mut point = |p: [f64; 2]| {
        if p.iter().all(|&v| visible(v)) {
            see(0, p[0], scene.x_log);
            see(1, p[1], scene.y_log);
        }
    };
    for element in &scene.elements {
        match &element.shape {
            Shape::Polygon(ps) | Shape::Polyline(ps) | Shape::Points(ps) | Shape::Line(ps) => {
                ps.iter().for_each(|&p| point(p));
            }
            Shape::Arrow(a, d) => {
                point(*a);
                point([a[0] + d[0], a[1] + d[1]]);
            }
            Shape::Text(p, ..) => point(*p),
            Shape::Arc(a, b, _) => {
                point(*a);
                point(*b);
            }
            Shape::Whiskers(ps) => {
                for &[x, low, high] in ps {
                    point([x, low]);
                    point([x, high]);
                }
            }
            Shape::Bars(ps) => {
                for &p in ps {
                    point(p);
                    // A bar stands on 0 and is as wide as its place.
                    point([p[0] - 0.5, 0.0]);
                    point([p[0] + 0.5, 0.0]);
                }
            }
        }
    }
    if !scene.categories.is_empty() {
        see(0, 0.5, false);
        see(0, scene.categories.len() as f64 + 0.5, false);
    }
    if !scene.y_categories.is_empty() {
        see(1, -0.5, false);
        see(1, -(scene.y_categories.len() as f64) - 0.5, false);
    }
    for (axis, limits) in [scene.x_limits, scene.y_limits].iter().enumerate() {
        for (end, limit) in limits.iter().enumerate() {
            if let (Some(v), Some(r)) = (limit, &mut range[axis]) {
                r[end] = *v;
            }
        }
        if let Some(r) = &mut range[axis]
            && r[0] >= r[1]
            && limits.iter().any(Option::is_some)
        {
            *r = [r[0].min(r[1]), r[0].max(r[1]) + 1.0];
        }
    }
    range
}

/// Round numbers within a range, about `wanted` of them.
pub(super) fn ticks(range: [f64; 2], wanted: f64) -> Vec<f64> {
    let width = range[1] - range[0];
    if width <= 0.0 || !width.is_finite() {
        return vec![range[0]];
    }
    let step = nice_step(width / wanted.max(1.0));
    let first = (range[0] / step - 1e-9).ceil() as i64;
    let last = (range[1] / step + 1e-9).floor() as i64;
    (first..=last.min(first + 100))
        .map(|k| k as f64 * step)
        .collect()
}

/// Powers of ten within a range, thinned to at most about `wanted`.
pub(super) fn log_ticks(range: [f64; 2], wanted: f64) -> Vec<f64> {
    let first = (range[0].log10() - 1e-9).ceil() as i32;
    let last = (range[1].log10() + 1e-9).floor() as i32;
    let every = (f64::from(last - first + 1) / wanted.max(1.0))
        .ceil()
        .max(1.0) as usize;
    (first..=last)
        .step_by(every)
        .map(|k| 10f64.powi(k))
        .collect()
}

/// 1, 2 or 5 times a power of ten, not less than `x`.
pub(super) fn nice_step(x: f64) -> f64 {
    let power = 10f64.powf(x.log10().floor());
    let lead = x / power;
    let nice = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|&n| lead <= n * (1.0 + 1e-9));
    nice.unwrap_or(10.0) * power
}

/// A range widened to whole steps, for axes with ticks at their ends.
pub(super) fn rounded(range: [f64; 2], wanted: f64) -> [f64; 2] {
    let width = range[1] - range[0];
    if width <= 0.0 || !width.is_finite() {
        let pad = if range[0] == 0.0 {
            1.0
        } else {
            range[0].abs() * 0.5
        };
        return [range[0] - pad, range[1] + pad];
    }
    let step = nice_step(width / wanted);
    [
        (range[0] / step + 1e-9).floor() * step,
        (range[1] / step - 1e-9).ceil() * step,
    ]
}

/// Labels of ticks: as many decimals as the steps need, powers of ten where numbers get long.
pub(super) fn tick_labels(ticks: &[f64]) -> Vec<String> {
    let step = match ticks {
        [a, b, ..] => (b - a).abs(),
        [a] if *a != 0.0 => a.abs(),
        _ => 1.0,
    };
    let top = ticks.iter().fold(0.0f64, |t, v| t.max(v.abs()));
    let minus = |s: String| s.replace('-', "\u{2212}");
    if top >= 1e6 || (top > 0.0 && step < 1e-5) {
        return ticks
            .iter()
            .map(|&v| minus(format!("{}", Short(v))))
            .collect();
    }
    let decimals = (-(step * 1.000001).log10().floor()).clamp(0.0, 8.0) as usize;
    let text = |v: f64| minus(format!("{:.decimals$}", if v == 0.0 { 0.0 } else { v }));
    ticks.iter().map(|&v| text(v)).collect()
}

/// A number with at most four significant digits, in the shorter of the two notations.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0 == 0.0 {
            return f.write_str("0");
        }
        let text = format!("{:.3e}", self.0);
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        write!(f, "{digits}e{power}")
    }
}

/// Label of a power of ten.
pub(super) fn power_label(v: f64) -> String {
    let k = v.log10().round() as i32;
    if (-3..=3).contains(&k) {
        return format!("{}", 10f64.powi(k));
    }
    let digits = k.to_string();
    let up = digits.chars().map(|c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        d => char::from_u32('⁰' as u32 + d as u32 - '0' as u32).unwrap_or(d),
    });
    std::iter::once('1').chain(['0']).chain(up).collect()
}

/// About how wide a text is, in pixels.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    text.chars()
        .map(|c| match c {
            'i' | 'l' | 'j' | '.' | ',' | '\'' | '|' | ':' | ';' | ' ' | 'I' => 0.3,
            'm' | 'w' | 'M' | 'W' | '@' | '%' => 0.9,
            'A'..='Z' => 0.7,
            _ => 0.6,
        })
        .sum::<f64>()
        * size
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_cover() {
        assert_eq!(ticks([0.0, 10.0], 5.0), vec![0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(
            tick_labels(&ticks([-0.2, 0.2], 4.0)),
            ["−0.2", "−0.1", "0.0", "0.1", "0.2"]
        );
        assert_eq!(rounded([0.3, 9.2], 5.0), [0.0, 10.0]);
        assert_eq!(tick_labels(&[0.0, 2e6]), ["0", "2e6"]);
        assert_eq!(log_ticks([1e-3, 1e2], 10.0).len(), 6);
        assert_eq!(power_label(1e-12), "10⁻¹²");
        assert_eq!(ticks([3.0, 3.0], 5.0), vec![3.0]);
    }
}
