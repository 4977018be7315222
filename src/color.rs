//! Colours: by name, as CSS writes them, or from a number through a scale.

/// What something is painted with.
#[derive(Clone, Debug, PartialEq)]
pub enum Paint {
    /// Nothing.
    None,
    /// A CSS colour, checked by [`Paint::parse`].
    Color(String),
    /// A number that the figure's colour scale turns into a colour.
    Value(f64),
}

impl Paint {
    /// Reads `none`, a colour's CSS name, `#rgb`, `#rrggbb` or `rgb(r, g, b)`. None for anything
    /// else.
    pub fn parse(text: &str) -> Option<Self> {
        let t = text.trim().to_ascii_lowercase();
        if t == "none" || t == "transparent" {
            return Some(Self::None);
        }
        if let Some(hex) = t.strip_prefix('#') {
            let digits = hex.bytes().all(|b| b.is_ascii_hexdigit());
            return (digits && matches!(hex.len(), 3 | 6)).then_some(Self::Color(t));
        }
        if let Some(inside) = t.strip_prefix("rgb(").and_then(|t| t.strip_suffix(')')) {
            let parts: Vec<u8> = inside
                .split([',', ' '])
                .filter(|p| !p.is_empty())
                .map_while(|p| p.parse().ok())
                .collect();
            let [r, g, b] = parts[..] else { return None };
            return Some(Self::Color(format!("#{r:02x}{g:02x}{b:02x}")));
        }
        NAMES.binary_search(&t.as_str()).ok()?;
        Some(Self::Color(t))
    }

    /// The names of colours, for suggestions.
    pub fn names() -> &'static [&'static str] {
        &NAMES
    }
}

/// Colour of `t` in 0 … 1 on a scale from dark blue over green to yellow that is even to the eye
/// and readable without colour vision (viridis, van der Walt & Smith 2015).
pub(crate) fn scale(t: f64) -> String {
    const STOPS: [[f64; 3]; 9] = [
        [68., 1., 84.],
        [71., 44., 122.],
        [59., 81., 139.],
        [44., 113., 142.],
        [33., 144., 141.],
        [39., 173., 129.],
        [92., 200., 99.],
        [170., 220., 50.],
        [253., 231., 37.],
    ];
    let t = if t.is_finite() {
        t.clamp(0.0, 1.0)
    } else {
        0.5
    };
    let place = t * (STOPS.len() - 1) as f64;
    let k = (place as usize).min(STOPS.len() - 2);
    let part = place - k as f64;
    let mix = |c: usize| (STOPS[k][c] + part * (STOPS[k + 1][c] - STOPS[k][c])).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// Colour of series k of a chart; after eight they begin again.
pub fn series(k: usize) -> &'static str {
    const COLORS: [&str; 8] = [
        "#2f6db3", "#d9772b", "#3c9150", "#b8403f", "#7b5aa6", "#8c6b52", "#4aa3b5", "#6f7780",
    ];
    COLORS[k % COLORS.len()]
}

/// CSS's names of colours, sorted.
#[rustfmt::skip]
static NAMES: [&str; 148] = [
    "aliceblue", "antiquewhite", "aqua", "aquamarine", "azure", "beige", "bisque", "black",
    "blanchedalmond", "blue", "blueviolet", "brown", "burlywood", "cadetblue", "chartreuse",
    "chocolate", "coral", "cornflowerblue", "cornsilk", "crimson", "cyan", "darkblue", "darkcyan",
    "darkgoldenrod", "darkgray", "darkgreen", "darkgrey", "darkkhaki", "darkmagenta",
    "darkolivegreen", "darkorange", "darkorchid", "darkred", "darksalmon", "darkseagreen",
    "darkslateblue", "darkslategray", "darkslategrey", "darkturquoise", "darkviolet", "deeppink",
    "deepskyblue", "dimgray", "dimgrey", "dodgerblue", "firebrick", "floralwhite", "forestgreen",
    "fuchsia", "gainsboro", "ghostwhite", "gold", "goldenrod", "gray", "green", "greenyellow",
    "grey", "honeydew", "hotpink", "indianred", "indigo", "ivory", "khaki", "lavender",
    "lavenderblush", "lawngreen", "lemonchiffon", "lightblue", "lightcoral", "lightcyan",
    "lightgoldenrodyellow", "lightgray", "lightgreen", "lightgrey", "lightpink", "lightsalmon",
    "lightseagreen", "lightskyblue", "lightslategray", "lightslategrey", "lightsteelblue",
    "lightyellow", "lime", "limegreen", "linen", "magenta", "maroon", "mediumaquamarine",
    "mediumblue", "mediumorchid", "mediumpurple", "mediumseagreen", "mediumslateblue",
    "mediumspringgreen", "mediumturquoise", "mediumvioletred", "midnightblue", "mintcream",
    "mistyrose", "moccasin", "navajowhite", "navy", "oldlace", "olive", "olivedrab", "orange",
    "orangered", "orchid", "palegoldenrod", "palegreen", "paleturquoise", "palevioletred",
    "papayawhip", "peachpuff", "peru", "pink", "plum", "powderblue", "purple", "rebeccapurple",
    "red", "rosybrown", "royalblue", "saddlebrown", "salmon", "sandybrown", "seagreen", "seashell",
    "sienna", "silver", "skyblue", "slateblue", "slategray", "slategrey", "snow", "springgreen",
    "steelblue", "tan", "teal", "thistle", "tomato", "turquoise", "violet", "wheat", "white",
    "whitesmoke", "yellow", "yellowgreen",
];
