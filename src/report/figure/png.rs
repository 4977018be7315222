//! From SVG to PNG.
//!
//! Texts are set in the fonts that come with the program (`assets/fonts`, a part of Inter with
//! Latin, Greek, Cyrillic and mathematical characters, SIL Open Font License), never in the
//! system's: a machine without fonts gives the same picture, to the byte.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq)]
pub enum PngError {
    /// The SVG is not one, in the parser's words.
    Svg(String),
    /// The picture would have no or too many pixels.
    Size(u32, u32),
    /// The picture could not be encoded.
    Encoding(String),
}

impl std::fmt::Display for PngError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Svg(e) => write!(f, "the SVG cannot be read: {e}"),
            Self::Size(w, h) => write!(f, "a picture of {w} × {h} pixels cannot be made"),
            Self::Encoding(e) => write!(f, "the picture cannot be encoded: {e}"),
        }
    }
}

impl std::error::Error for PngError {}

static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
    let mut db = fontdb::Database::new();
    let regular = include_bytes!("../../../assets/fonts/Inter-400Regular.ttf");
    let semibold = include_bytes!("../../../assets/fonts/Inter-600SemiBold.ttf");
    db.load_font_data(regular.to_vec());
    db.load_font_data(semibold.to_vec());
    db.set_sans_serif_family("Inter");
    db.set_serif_family("Inter");
    db.set_monospace_family("Inter");
    Arc::new(db)
});

/// Rasterises an SVG; `scale` is pixels per SVG pixel (2 gives a picture for a dense screen).
pub fn png(svg: &str, scale: f64) -> Result<Vec<u8>, PngError> {
    let options = Options {
        font_family: "Inter".into(),
        fontdb: Arc::clone(&FONTS),
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options).map_err(|e| PngError::Svg(e.to_string()))?;
    let pixels = |length: f32| (f64::from(length) * scale).round().clamp(0.0, 1e9) as u32;
    let (w, h) = (pixels(tree.size().width()), pixels(tree.size().height()));
    if u64::from(w) * u64::from(h) > 200_000_000 {
        return Err(PngError::Size(w, h));
    }
    let mut pixmap = Pixmap::new(w, h).ok_or(PngError::Size(w, h))?;
    let transform = Transform::from_scale(scale as f32, scale as f32);
    resvg::render(&tree, transform, &mut pixmap.as_mut());
    pixmap
        .encode_png()
        .map_err(|e| PngError::Encoding(e.to_string()))
}
