//! Modules import in one direction only.

use crate::common::files;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The table of `docs/architecture.md`: each module, lowest first, and what it may import.
fn drawn() -> Vec<(String, BTreeSet<String>)> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/architecture.md");
    let page = std::fs::read_to_string(page).expect("the page");
    let table = page.split("| module | imports |\n| --- | --- |\n").nth(1);
    let lines = table.expect("the table").lines();
    let mut modules: Vec<(String, BTreeSet<String>)> = Vec::new();
    for line in lines.take_while(|l| l.starts_with('|')) {
        let names = |cell: &str| -> Vec<String> {
            let quoted = cell.split('`').skip(1).step_by(2);
            quoted.map(str::to_string).collect()
        };
        let cells: Vec<&str> = line.split('|').collect();
        let may: BTreeSet<String> = match cells[2].trim() {
            "all above" => modules.iter().map(|m| m.0.clone()).collect(),
            cell => names(cell).into_iter().collect(),
        };
        modules.extend(names(cells[1]).into_iter().map(|m| (m, may.clone())));
    }
    modules
}

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
    let drawn = drawn();
    // Lowest first: an arrow up cannot even be drawn.
    for (n, (module, may)) in drawn.iter().enumerate() {
        for other in may {
            assert!(
                drawn[..n].iter().any(|a| a.0 == *other),
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
        let row = drawn.iter().find(|a| a.0 == *from);
        !row.is_some_and(|a| a.1.contains(to))
    });
    let wrong: Vec<String> = wrong
        .map(|((from, to), file)| format!("{from} imports {to} (src/{file})"))
        .collect();
    assert!(
        wrong.is_empty(),
        "not drawn in docs/architecture.md:\n{}",
        wrong.join("\n")
    );
    let idle = drawn.iter().flat_map(|(from, may)| {
        let unused = |to: &&String| !arrows.contains_key(&(from.clone(), (*to).clone()));
        let unused = may.iter().filter(unused);
        unused.map(move |to| format!("{from} does not import {to}"))
    });
    let idle: Vec<String> = idle.filter(|i| !i.starts_with("cli ")).collect();
    assert!(
        idle.is_empty(),
        "drawn in docs/architecture.md:\n{}",
        idle.join("\n")
    );
}
