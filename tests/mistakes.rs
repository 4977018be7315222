//! What people get wrong, and what they are told: the files of `tests/mistakes/`, one per origin, as snapshots.
//!
//! A case begins with `=== name` and is a whole text; `=== name [part]` replaces that part of [`MODEL`], a small
//! complete model, so that what follows a mistake is there to be misunderstood. One mistake, one message, with its
//! place, cause and fix: how many cases reach that is counted and may not fall.
//! `INSTA_UPDATE=always` writes the snapshots.

use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use crate::common::{self, Memory};
use bmod::diag::codes::{self, CODES};
use bmod::report::diagnostics::{Look, render};
use bmod::run::Options;

/// A transport model, in parts.
const MODEL: &[(&str, &str)] = &[
    (
        "set",
        "set i 'plants' / seattle, sandiego /, j 'markets' / newyork, chicago, topeka /;\n",
    ),
    (
        "a",
        "parameter a(i) 'capacity' / seattle 350, sandiego 600 /;\n",
    ),
    (
        "b",
        "parameter b(j) 'demand' / newyork 325, chicago 300, topeka 275 /;\n",
    ),
    (
        "d",
        "table d(i,j) 'distance'\n           newyork  chicago  topeka\nseattle      2.5      1.7      1.8\nsandiego     2.5      1.8      1.4;\n",
    ),
    ("f", "scalar f 'freight' / 90 /;\n"),
    ("c", "parameter c(i,j) 'cost'; c(i,j) = f*d(i,j)/1000;\n"),
    ("var", "positive variable x(i,j); variable z;\n"),
    ("equ", "equation cost, supply(i), demand(j);\n"),
    ("cost", "cost.. z =e= sum((i,j), c(i,j)*x(i,j));\n"),
    ("supply", "supply(i).. sum(j, x(i,j)) =l= a(i);\n"),
    ("demand", "demand(j).. sum(i, x(i,j)) =g= b(j);\n"),
    ("model", "model transport / all /;\n"),
    ("solve", "solve transport using lp minimizing z;\n"),
    ("show", "display x.l, z.l;\n"),
];

/// Cases with exactly one message that has a place and says what to do.
const RIGHT: usize = 633;

/// Fixes that an editor offers over all cases.
const FIXED: usize = 70;

struct Case {
    name: String,
    text: String,
}

fn cases(file: &str) -> Vec<Case> {
    let blocks = file.split("\n=== ").skip(1);
    blocks
        .map(|block| {
            let (head, text) = block.split_once('\n').expect("a text follows the name");
            let (name, part) = match head.split_once(" [") {
                Some((name, part)) => (name, part.strip_suffix(']')),
                None => (head, None),
            };
            let text = format!("{}\n", text.trim_end());
            let whole = |part: &str| {
                let known = MODEL.iter().any(|(name, _)| *name == part);
                assert!(known, "{name}: there is no part {part}");
                let line = |&(n, t): &(&str, &'static str)| {
                    if n == part {
                        text.clone()
                    } else {
                        t.to_string()
                    }
                };
                MODEL.iter().map(line).collect()
            };
            Case {
                name: name.to_string(),
                text: part.map_or_else(|| text.clone(), whole),
            }
        })
        .collect()
}

/// What a person sees, and whether it is one message with a place and a fix.
fn told(case: &Case) -> (String, bool) {
    let mut host = Memory::text(&case.text);
    let options = Options {
        quiet: true,
        ..Options::default()
    };
    let run = || common::run(&mut host, "m.blk", options);
    let Ok(finished) = catch_unwind(AssertUnwindSafe(run)) else {
        return ("PANIC\n".into(), false);
    };
    let list = &finished.diagnostics;
    let look = Look {
        width: 110,
        ..Look::plain()
    };
    let right = match list.as_slice() {
        [d] => {
            // "expected a name" is what the grammar says where nothing better is known.
            let guess = d.help.as_ref().is_some_and(|h| h.starts_with("expected"));
            let fix = d.help.is_some() && !guess
                || d.label.contains("write")
                || d.label.contains("missing");
            finished.map.place(d.span).is_some() && fix
        }
        _ => false,
    };
    (render(list, &finished.map, look), right)
}

#[test]
fn one_mistake_one_message() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mistakes");
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_snapshot_path("mistakes");
    let (mut total, mut right) = (0, 0);
    let mut wrong = Vec::new();
    for path in common::files(&folder, &["txt"]) {
        let file = std::fs::read_to_string(&path).expect("the cases can be read");
        let stem = path.file_stem().expect("a name").to_string_lossy();
        let mut page = String::new();
        for case in cases(&file) {
            let (text, ok) = told(&case);
            for forbidden in ["PANIC", "Some(", "None,", "Vec<", "unwrap"] {
                if text.contains(forbidden) {
                    wrong.push((case.name.clone(), forbidden));
                }
            }
            total += 1;
            right += usize::from(ok);
            let mark = if ok {
                ""
            } else {
                "  (not one message with a fix)"
            };
            let _ = write!(page, "=== {}{mark}\n{text}", case.name);
        }
        settings.bind(|| insta::assert_snapshot!(&*stem, page));
    }
    for (name, what) in &wrong {
        println!("{name} shows {what}");
    }
    assert!(
        wrong.is_empty(),
        "{} cases show what nobody should see",
        wrong.len()
    );
    println!("{right} of {total} mistakes have exactly one message that names place and fix");
    assert!(total >= 250, "only {total} cases");
    assert!(
        right >= RIGHT,
        "{right} cases have one message; there were {RIGHT}"
    );
}

/// What an editor offers as a fix mends what it is offered for: less is wrong, or as much, but only behind that place.
#[test]
fn fixes_mend() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mistakes");
    let (mut fixed, mut worse) = (0, Vec::new());
    for path in common::files(&folder, &["txt"]) {
        let file = std::fs::read_to_string(&path).expect("the cases can be read");
        for case in cases(&file) {
            let mut editor = bmod::editor::Editor::new(None);
            let mut check = |text: &str| {
                editor.open("m.blk", text);
                let found = editor.check("m.blk").into_iter();
                found.flat_map(|f| f.diagnostics).collect::<Vec<_>>()
            };
            let before = check(&case.text);
            for d in &before {
                let Some(fix) = d.fixes.first() else { continue };
                check(&case.text);
                let edit = &fix.edits[0];
                let mut changed = bmod::editor::Editor::new(None);
                changed.open("m.blk", case.text.as_str());
                changed.change("m.blk", Some(edit.range), &edit.new_text);
                let text = changed.text("m.blk").expect("it is open").to_owned();
                let after = check(&text);
                let behind = after.iter().all(|d| d.range.start > edit.range.start);
                if after.len() < before.len() || after.len() == before.len() && behind {
                    fixed += 1;
                } else {
                    worse.push(format!("{} ({}): {}", case.name, d.code, fix.title));
                }
            }
        }
    }
    println!("{fixed} fixes mend; these do not:\n{}", worse.join("\n"));
    assert!(
        fixed >= FIXED && worse.is_empty(),
        "{fixed} mend, {} do not",
        worse.len()
    );
}

/// The codes of the sources are those of the table, and the page is made from it.
#[test]
fn every_code_is_declared() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut used: Vec<String> = Vec::new();
    for path in common::files(&root.join("src"), &["rs"]) {
        if path.ends_with("diag/codes.rs") {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("a source can be read");
        for (at, _) in text.match_indices("\"E0") {
            let Some(code) = text
                .get(at + 1..at + 6)
                .filter(|_| text[at + 6..].starts_with('"'))
            else {
                continue;
            };
            let row = codes::find(code);
            let row = row.unwrap_or_else(|| {
                panic!(
                    "{} uses {code}, which src/diag/codes.rs lacks",
                    path.display()
                )
            });
            let before = text[..at].trim_end();
            for (made, severity) in [("warning(", 0), ("error(", 1), ("execution(", 2)] {
                let constructor = before.ends_with(&format!("Diagnostic::{made}"));
                assert!(
                    !constructor || row.severity as i32 >= severity,
                    "{code} is more serious in {}",
                    path.display()
                );
            }
            used.push(code.to_string());
        }
    }
    for pair in CODES.windows(2) {
        assert!(
            pair[0].code < pair[1].code,
            "{} is not in order",
            pair[1].code
        );
    }
    for c in CODES {
        assert!(
            used.iter().any(|u| u == c.code),
            "no source uses {}",
            c.code
        );
    }
    let page = root.join("docs/errors.md");
    if std::env::var("INSTA_UPDATE").is_ok_and(|v| v == "always") {
        std::fs::write(&page, codes::page()).expect("the page can be written");
    }
    let written = std::fs::read_to_string(&page).expect("the page can be read");
    assert!(
        written == codes::page(),
        "docs/errors.md is made by INSTA_UPDATE=always cargo test --test all every_code"
    );
}
