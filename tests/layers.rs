//! Modules import in one direction only.

use crate::common::files;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The drawing of `docs/architecture.md`: each module, lowest first, and what it may import.
const ARROWS: &[(&str, &[&str])] = &[
    ("span", &[]),
    ("color", &[]),
    ("host", &[]),
    ("data", &[]),
    ("gdx", &[]),
    ("system", &["host"]),
    ("diag", &["span"]),
    ("model", &["data", "diag"]),
    ("autodiff", &["model"]),
    ("source", &["data", "diag", "host", "span"]),
    ("syntax", &["data", "diag", "host", "model", "source"]),
    (
        "check",
        &[
            "autodiff", "color", "data", "diag", "gdx", "host", "model", "source", "syntax",
        ],
    ),
    ("solve", &["autodiff", "model"]),
    ("solver", &["autodiff", "model", "solve"]),
    (
        "report",
        &["color", "data", "diag", "model", "solve", "source"],
    ),
    (
        "run",
        &[
            "autodiff", "check", "data", "diag", "host", "model", "report", "solve", "source",
            "syntax",
        ],
    ),
    (
        "session",
        &["check", "diag", "host", "report", "run", "solve", "source"],
    ),
    (
        "formulation",
        &[
            "autodiff", "check", "data", "diag", "host", "model", "report", "run", "session",
            "solve", "source", "syntax",
        ],
    ),
    ("claims", &["check", "data", "run"]),
    (
        "api",
        &[
            "check",
            "claims",
            "data",
            "diag",
            "formulation",
            "host",
            "model",
            "report",
            "run",
            "session",
            "solve",
            "source",
            "system",
        ],
    ),
    (
        "editor",
        &["check", "data", "diag", "host", "solve", "source", "syntax"],
    ),
    (
        "cli",
        &[
            "check",
            "claims",
            "diag",
            "editor",
            "formulation",
            "gdx",
            "host",
            "model",
            "report",
            "run",
            "session",
            "solve",
            "source",
            "system",
        ],
    ),
];

/// Names behind `crate::` in a source, without its comments and its tests.
fn imports(text: &str) -> BTreeSet<String> {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or("");
    let lines = text.lines().filter(|l| !l.trim_start().starts_with("//"));
    let mut found = BTreeSet::new();
    for line in lines {
        for rest in line.split("crate::").skip(1) {
            let end = |c: char| !c.is_ascii_lowercase() && c != '_';
            found.insert(rest.split(end).next().unwrap_or("").to_string());
        }
    }
    found.remove("");
    found
}

#[test]
fn modules_import_in_one_direction() {
    // Lowest first: an arrow up cannot even be drawn.
    for (n, (module, may)) in ARROWS.iter().enumerate() {
        for other in *may {
            assert!(
                ARROWS[..n].iter().any(|a| a.0 == *other),
                "{module} is drawn below {other}"
            );
        }
    }
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut arrows: BTreeMap<(String, String), String> = BTreeMap::new();
    for file in files(&src, &["rs"]) {
        let name = file.strip_prefix(&src).expect("below src");
        let name = name.to_string_lossy().replace('\\', "/");
        let module = name.split(['/', '.']).next().unwrap_or("").to_string();
        if matches!(&*module, "lib" | "main") || name.ends_with("tests.rs") {
            continue;
        }
        let text = std::fs::read_to_string(&file).expect("a source");
        for other in imports(&text).into_iter().filter(|o| *o != module) {
            arrows
                .entry((module.clone(), other))
                .or_insert(name.clone());
        }
    }
    assert!(arrows.len() > 40, "{arrows:?}");
    let wrong = arrows.iter().filter(|((from, to), _)| {
        let drawn = ARROWS.iter().find(|a| a.0 == from);
        let drawn = drawn.is_some_and(|a| a.1.contains(&to.as_str()));
        !drawn
    });
    let wrong: Vec<String> = wrong
        .map(|((from, to), file)| format!("{from} imports {to} (src/{file})"))
        .collect();
    assert!(
        wrong.is_empty(),
        "not drawn in docs/architecture.md:\n{}",
        wrong.join("\n")
    );
}
