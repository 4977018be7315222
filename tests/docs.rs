//! Every command in the pages of `docs/` gives the output that stands under it.
//!
//! A block ` ```blk NAME ` is a file; a block ` ```console ` holds commands (`$ bmod …`, `$ NAME=VALUE bmod …`), each followed by what it prints. Pages
//! run from top to bottom in a folder of their own, in which `models` is the project's. Times and residuals of the size of rounding are not compared. `UPDATE_DOCS=1`
//! writes the outputs anew.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Pages whose commands are run.
fn pages() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut pages: Vec<PathBuf> = std::fs::read_dir(root.join("docs"))
        .expect("docs")
        .map(|e| e.expect("an entry").path())
        .filter(|p| p.extension().is_some_and(|e| e == "md"))
        .collect();
    pages.push(root.join("tests/commands.md"));
    pages.sort();
    pages
}

/// What a command prints: standard output, then standard error.
fn output_of(command: &str, folder: &Path) -> String {
    let (set, words) = command.split_once("bmod ").expect(command);
    let set = set.split_whitespace().filter_map(|s| s.split_once('='));
    let out = Command::new(env!("CARGO_BIN_EXE_bmod"))
        .args(words.split_whitespace())
        .current_dir(folder)
        .env_remove("NO_COLOR")
        .env_remove("COLUMNS")
        .envs(set)
        .output()
        .expect("bmod runs");
    let text = [out.stdout, out.stderr].map(|b| String::from_utf8(b).expect("UTF-8"));
    text.concat().trim_end().to_string()
}

/// Without what differs from machine to machine: durations (`6.2 ms`, `0.31 s`) and residuals of the size of rounding (`3e-14`).
fn lasting(text: &str) -> String {
    let words: Vec<&str> = text.split(' ').collect();
    let mut out: Vec<String> = Vec::new();
    for (k, word) in words.iter().enumerate() {
        let (first, rest) = word.split_once('\n').unwrap_or((word, ""));
        let number = first.trim_end_matches([',', '.', ')']).parse::<f64>();
        let next = words.get(k + 1).copied().unwrap_or_default();
        let unit = next.lines().next().unwrap_or_default();
        let is_duration = number.is_ok() && matches!(unit, "ms" | "s");
        let is_rounding = number.is_ok_and(|x| x != 0.0 && x.abs() < 1e-9);
        out.push(match is_duration || is_rounding {
            true => format!("_\n{rest}"),
            false => (*word).to_string(),
        });
    }
    out.join(" ")
}

/// A page with the outputs as they are now.
fn run(page: &str, folder: &Path) -> String {
    let mut out = String::new();
    let mut lines = page.lines().peekable();
    while let Some(line) = lines.next() {
        out.push_str(line);
        out.push('\n');
        if let Some(name) = line.strip_prefix("```blk ") {
            let mut text = String::new();
            while let Some(line) = lines.next_if(|l| *l != "```") {
                text.push_str(line);
                text.push('\n');
            }
            std::fs::write(folder.join(name), &text).expect("written");
            out.push_str(&text);
        } else if line == "```console" {
            while let Some(line) = lines.next_if(|l| *l != "```") {
                let Some(command) = line.strip_prefix("$ ") else {
                    panic!("output without a command: {line}");
                };
                let mut claimed: Vec<&str> = Vec::new();
                while let Some(line) = lines.next_if(|l| *l != "```" && !l.starts_with("$ ")) {
                    claimed.push(line);
                }
                let claimed = claimed.join("\n").trim_end().to_string();
                let now = output_of(command, folder);
                let same = lasting(&claimed) == lasting(&now);
                let text = if same { claimed } else { now };
                out.push_str(&format!("$ {command}\n{text}\n"));
            }
        }
    }
    out
}

/// README shows the file of its first command, comments aside, and how its output begins.
#[test]
fn readme_shows_the_wall() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(root.join("README.md")).expect("README");
    let text = std::fs::read_to_string(root.join("models/wall.blk")).expect("the wall");
    let says = |l: &&str| !l.is_empty() && !l.starts_with('*') && !l.starts_with("$title");
    let words = |text: &str| -> String {
        let lines: Vec<&str> = text.lines().filter(says).collect();
        let words: Vec<&str> = lines.iter().flat_map(|l| l.split_whitespace()).collect();
        words.join(" ")
    };
    let blocks: Vec<&str> = page.split("```\n").skip(1).step_by(2).collect();
    let [output, file, ..] = blocks[..] else {
        panic!("README has no two blocks");
    };
    assert_eq!(words(file), words(&text));
    let folder = tempfile::tempdir().expect("a folder");
    let command = format!("bmod run {}", root.join("models/wall.blk").display());
    let now = output_of(&command, folder.path());
    let first: Vec<&str> = now.lines().take(output.lines().count()).collect();
    assert_eq!(lasting(output.trim_end()), lasting(&first.join("\n")));
}

/// The pictures that the commands of a page have drawn.
fn pictures_of(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let names = entries.map(|e| {
        e.expect("an entry")
            .file_name()
            .to_string_lossy()
            .into_owned()
    });
    let mut names: Vec<String> = names.filter(|n| n.ends_with(".svg")).collect();
    names.sort();
    names
}

#[test]
fn commands_of_the_pages_print_what_stands_there() {
    let update = std::env::var_os("UPDATE_DOCS").is_some();
    let mut wrong = Vec::new();
    let mut commands = 0;
    for path in pages() {
        let page = std::fs::read_to_string(&path).expect("a page");
        if !page.contains("```console") {
            continue;
        }
        commands += page.lines().filter(|l| l.starts_with("$ bmod")).count();
        let folder = tempfile::tempdir().expect("a folder");
        #[cfg(unix)]
        std::os::unix::fs::symlink(
            Path::new(env!("CARGO_MANIFEST_DIR")).join("models"),
            folder.path().join("models"),
        )
        .expect("a link");
        let now = run(&page, folder.path());
        for drawn in pictures_of(folder.path()) {
            let kept = Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("docs/figures")
                .join(&drawn);
            let bytes = std::fs::read(folder.path().join(&drawn)).expect("a picture");
            let is_shown = page.contains(&format!("(figures/{drawn})"));
            if is_shown && std::fs::read(&kept).ok().as_ref() != Some(&bytes) {
                if update {
                    std::fs::write(&kept, &bytes).expect("written");
                }
                wrong.push(format!("{}: docs/figures/{drawn} differs", path.display()));
            }
        }
        if now != page {
            if update {
                std::fs::write(&path, &now).expect("written");
            }
            let differs = now.lines().zip(page.lines()).find(|(a, b)| a != b);
            wrong.push(format!("{}: {differs:?}", path.display()));
        }
    }
    assert!(commands > 8, "{commands} commands");
    assert!(
        wrong.is_empty() || update,
        "UPDATE_DOCS=1 cargo test --test all docs:: writes the outputs anew\n{}",
        wrong.join("\n")
    );
}

/// No page is longer than a reader likes, but for the language, tables that are written from the program and tests; the lab is
/// apart.
#[test]
fn pages_are_short() {
    let long = ["language.md", "errors.md", "options.md", "commands.md"];
    for page in pages() {
        let words = std::fs::read_to_string(&page)
            .expect("a page")
            .split_whitespace()
            .count();
        let is_long = long.iter().any(|l| page.ends_with(l));
        assert!(
            is_long || words <= 1500,
            "{}: {words} words",
            page.display()
        );
    }
}

/// Every relative link in the pages leads to a file of the project.
#[test]
fn links_of_the_pages_lead_to_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders = vec![root.to_path_buf()];
    let (mut links, mut broken) = (0, Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if path.is_dir() {
                if !name.starts_with('.') && !matches!(&*name, "target" | "node_modules" | "dist") {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|e| e == "md") {
                let text = std::fs::read_to_string(&path).expect("a page");
                // Outside of blocks of code.
                let prose = text.split("```").step_by(2).collect::<String>();
                for rest in prose.split("](").skip(1) {
                    let target = rest.split([')', ' ', '#']).next().unwrap_or_default();
                    if target.is_empty() || target.contains(':') {
                        continue;
                    }
                    links += 1;
                    if !folder.join(target).exists() {
                        broken.push(format!("{}: {target}", path.display()));
                    }
                }
            }
        }
    }
    assert!(links > 50, "{links} links");
    assert!(broken.is_empty(), "{broken:#?}");
}
