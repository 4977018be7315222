//! `bmod new`: a model to begin with.

use std::path::Path;

use super::args::{EXECUTION, NewArgs, Template, USAGE};
use super::host::write_whole;

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
pub fn new(a: &NewArgs) -> u8 {
    let name = a.name.trim_end_matches(".blk");
    let stem = Path::new(name).file_name().and_then(|n| n.to_str());
    let Some(stem) = stem.filter(|n| !n.is_empty()) else {
        eprintln!("bmod: `{}` is not a name for a model", a.name);
        return USAGE;
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
        eprintln!(
            "bmod: {} is there already; nothing was written",
            there.display()
        );
        return USAGE;
    }
    for (path, text) in &files {
        let made =
            std::fs::create_dir_all(folder).and_then(|()| write_whole(path, text.as_bytes()));
        if let Err(e) = made {
            eprintln!("bmod: {} could not be written: {e}", path.display());
            return EXECUTION;
        }
        println!("written: {}", path.display());
    }
    println!("try: bmod run {}", files[0].0.display());
    0
}
