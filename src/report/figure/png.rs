//! From SVG to PNG.
//!
//! Texts are set in the fonts that come with the program (`assets/fonts`, a part of Inter with
//! Latin, Greek, Cyrillic and mathematical characters, SIL Open Font License), never in the
//! system's: a machine without fonts gives the same picture, to the byte.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

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

/// Rasterises an SVG; `scale` is pixels per SVG pixel (2 gives a picture for a dense screen). Err: why there is no picture.
pub fn png(svg: &str, scale: f64) -> Result<Vec<u8>, String> {
    let options = Options {
        font_family: "Inter".into(),
        fontdb: Arc::clone(&FONTS),
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options);
    let tree = tree.map_err(|e| format!("the SVG cannot be read: {e}"))?;
    let pixels = |length: f32| (f64::from(length) * scale).round().clamp(0.0, 1e9) as u32;
    let (w, h) = (pixels(tree.size().width()), pixels(tree.size().height()));
    let few = u64::from(w) * u64::from(h) <= 200_000_000;
    let Some(mut pixmap) = few.then(|| Pixmap::new(w, h)).flatten() else {
        return Err(format!("a picture of {w} × {h} pixels cannot be made"));
    };
    let transform = Transform::from_scale(scale as f32, scale as f32);
    resvg::render(&tree, transform, &mut pixmap.as_mut());
    let png = pixmap.encode_png();
    png.map_err(|e| format!("the picture cannot be encoded: {e}"))
}
