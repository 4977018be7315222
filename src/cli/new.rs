//! `bmod new`: a model to begin with.

use std::path::Path;

use super::args::{NewArgs, Template, USAGE};
use super::commands::{Status, complain, unwritten, write_file};
use super::host::say;

/// The files of a template: names, with NAME for the name that was given, and their texts.
fn files(template: Template) -> &'static [(&'static str, &'static str)] {
    match template {
        Template::Lp => &[
            ("NAME.blk", include_str!("../../models/templates/lp.blk")),
            ("NAME.csv", include_str!("../../models/templates/lp.csv")),
        ],
        Template::Nlp => &[("NAME.blk", include_str!("../../models/templates/nlp.blk"))],
        Template::Mcp => &[("NAME.blk", include_str!("../../models/templates/mcp.blk"))],
        Template::Wall => &[
            ("NAME.blk", include_str!("../../models/wall.blk")),
            (
                "block_limit.blk",
                include_str!("../../models/block_limit.blk"),
            ),
            ("mechanism.blk", include_str!("../../models/mechanism.blk")),
        ],
    }
}

/// Carries out `bmod new`; nothing that is there is overwritten.
pub(super) fn new(a: &NewArgs) -> Status {
    let name = a.name.trim_end_matches(".blk");
    let stem = Path::new(name).file_name().and_then(|n| n.to_str());
    let Some(stem) = stem.filter(|n| !n.is_empty()) else {
        let message = format!("`{}` is not a name for a model", a.name);
        return Err(complain(USAGE, message));
    };
    let folder = Path::new(name).parent().unwrap_or(Path::new(""));
    let files: Vec<_> = files(a.template)
        .iter()
        .map(|(file, text)| {
            (
                folder.join(file.replace("NAME", stem)),
                text.replace("NAME", stem),
            )
        })
        .collect();
    if let Some((there, _)) = files.iter().find(|(path, _)| path.exists()) {
        let message = format!("{} is there already; nothing was written", there.display());
        return Err(complain(USAGE, message));
    }
    for (path, text) in &files {
        std::fs::create_dir_all(folder).map_err(|e| unwritten(path, e))?;
        write_file(path, text.as_bytes())?;
        say!("written: {}", path.display());
    }
    say!("try: bmod run {}", files[0].0.display());
    Ok(0)
}
