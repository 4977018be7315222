//! The public interface of the library as a listing, read from the sources: a change of it shows in a snapshot
//! (`tests/snapshots/all__api__public_api.snap`; `INSTA_UPDATE=always` writes it).

use crate::common::files;
use std::fmt::Write;
use std::path::Path;

/// `pub use a::b::{C, D};` of the crate's root as (`a/b`, `C`), (`a/b`, `D`).
fn exported(root: &str) -> Vec<(String, String)> {
    let mut out = Vec::new();
    for part in root.split("\npub use ").skip(1) {
        let (path, _) = part.split_once(';').expect("a semicolon ends it");
        let (module, names) = match path.split_once('{') {
            Some((module, names)) => (module.trim_end_matches("::"), names.trim_end_matches('}')),
            None => path.rsplit_once("::").expect("a path"),
        };
        let module = module.trim().replace("::", "/");
        let names = names.split(',').map(str::trim).filter(|n| !n.is_empty());
        out.extend(names.map(|n| (module.clone(), n.to_string())));
    }
    out
}

/// A text in which enums with names (`model/named.rs`) stand as others do.
fn outdented(text: &str) -> String {
    let mut out = String::new();
    let mut inside = false;
    for line in text.lines() {
        match line {
            "named! {" | "functions! {" => inside = true,
            "}" if inside => inside = false,
            _ if inside => out.push_str(line.strip_prefix("    ").unwrap_or(line)),
            _ => out.push_str(line),
        }
        out.push('\n');
    }
    out
}

/// Lines of the block that begins in this line, without the first and the last; formatted code closes it at the
/// same indentation.
fn block<'a>(lines: &[&'a str], at: usize) -> Vec<&'a str> {
    if !lines[at].ends_with('{') {
        return Vec::new();
    }
    let end = lines[at..].iter().position(|l| *l == "}").expect("an end");
    lines[at + 1..at + end].to_vec()
}

/// A declaration that may run over several lines, as one line without its body.
fn declaration(lines: &[&str], at: usize) -> String {
    let mut text = String::new();
    for line in &lines[at..] {
        let line = line.trim();
        if !text.is_empty() && !text.ends_with('(') && !line.starts_with([')', '.']) {
            text.push(' ');
        }
        text.push_str(line);
        if line.ends_with(['{', ';', '}']) {
            break;
        }
    }
    text.trim_end_matches([' ', '{', '}', ';'])
        .replace(",)", ")")
}

/// Members of a block: public fields and functions, variants, functions of a trait.
fn members(lines: &[&str], head: &str, out: &mut String) {
    let all = head.starts_with("pub enum") || head.starts_with("pub trait");
    for (n, line) in lines.iter().enumerate() {
        let Some(item) = line.strip_prefix("    ") else {
            continue;
        };
        let field = item
            .strip_prefix("    ")
            .filter(|_| head.starts_with("pub enum"));
        if let Some(field) = field.filter(|f| !f.starts_with(['/', '#'])) {
            let _ = writeln!(out, "        {}", field.trim_end_matches(','));
            continue;
        }
        let is_plain = !item.starts_with([' ', '/', '#', '}', ')']) && !item.is_empty();
        if !is_plain || !(all || item.starts_with("pub ")) || item.starts_with("pub(") {
            continue;
        }
        let text = match item.contains("fn ") {
            true => declaration(lines, n),
            false => item.trim_end_matches([',', '{', ' ']).to_string(),
        };
        let _ = writeln!(out, "    {text}");
    }
}

#[test]
fn public_api() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let root = std::fs::read_to_string(src.join("lib.rs")).expect("the crate's root");
    let sources: Vec<(String, String)> = files(&src, &["rs"])
        .iter()
        .map(|f| {
            let name = f.strip_prefix(&src).expect("below src");
            let text = std::fs::read_to_string(f).expect("a source");
            (name.to_string_lossy().into_owned(), outdented(&text))
        })
        .collect();
    let below = std::fs::read_to_string(src.join("solver.rs")).expect("instances and backends");
    let mut names = exported(&root);
    names.extend(exported(&below.replace("pub use crate::", "pub use ")));
    names.dedup();
    assert!(names.len() > 20, "{names:?}");
    names.sort_by(|a, b| a.1.cmp(&b.1));
    let mut out = String::new();
    for (module, name) in names {
        let begins = |line: &str| {
            let kinds = [
                "struct", "enum", "trait", "fn", "const fn", "static", "type",
            ];
            kinds.iter().any(|kind| {
                let rest = line.strip_prefix(&format!("pub {kind} {name}"));
                rest.is_some_and(|r| !r.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
            })
        };
        let has = |(file, text): &&(String, String)| {
            file.starts_with(&module) && text.lines().any(begins)
        };
        let found = sources.iter().find(has);
        let (_, text) = found.unwrap_or_else(|| panic!("`{name}` is not in {module}"));
        let lines: Vec<&str> = text.lines().collect();
        for (n, line) in lines.iter().enumerate() {
            if begins(line) {
                let head = declaration(&lines, n);
                let _ = writeln!(out, "{head}");
                members(&block(&lines, n), &head, &mut out);
            }
        }
        for (n, line) in lines.iter().enumerate() {
            let Some(rest) = line.strip_prefix("impl") else {
                continue;
            };
            let of = rest.trim_end_matches([' ', '{', '}']);
            let is_own = |t: &str| t == name || t.starts_with(&format!("{name}<"));
            if let Some((_, of)) = of.split_once(" for ") {
                if is_own(of) {
                    let _ = writeln!(out, "{}", declaration(&lines, n));
                }
            } else if is_own(of.rsplit(' ').next().unwrap_or("")) {
                members(&block(&lines, n), "impl", &mut out);
            }
        }
        out.push('\n');
    }
    insta::assert_snapshot!(out);
}
