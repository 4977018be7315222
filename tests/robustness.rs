//! No text makes a run panic, go on without end or take all memory.
//!
//! `damaged_runs` takes models of the suite apart into words, mixes and damages them, and carries out what
//! comes out; half of the damage puts a word of the same kind in a word's place, so that much of it still runs.
//! `FUZZ_CASES=100000 PROPTEST_RNG_SEED=2 cargo test --test robustness damaged -- --nocapture` runs it for hours, on
//! other cases than last time; what it finds is shrunk, and belongs into `tests/suite` or here.

mod common;

use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use bmod::run::Options;
use bmod::session::Finished;
use common::Memory;
use proptest::prelude::*;

/// The memory that is measured is the process's: one run at a time.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

fn run(text: &str, seconds: f64, megabytes: usize) -> Finished {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let mut host = Memory::text(text);
    let options = Options {
        time_limit: seconds,
        max_memory: Some(megabytes << 20),
        collect: true,
        ..Options::default()
    };
    common::run(&mut host, "m.blk", options)
}

/// The text ends with a diagnostic of this code, and within the limits.
fn ends_with(text: &str, code: &str, exit: u8) {
    let start = Instant::now();
    // An endless loop is given half a second, what takes memory as long as it needs.
    let (seconds, megabytes) = match code {
        "E0490" => (0.5, 4000),
        _ => (500.0, 200),
    };
    let finished = run(text, seconds, megabytes);
    let codes: Vec<&str> = finished.diagnostics.iter().map(|d| d.code).collect();
    assert!(
        codes.contains(&code),
        "{code} is not among {codes:?}:\n{text}"
    );
    assert_eq!(finished.end.exit(), exit, "{text}");
    // Far more than the limit, far less than for ever.
    assert!(start.elapsed().as_secs() < 600, "{text}");
}

#[test]
fn loops_without_end() {
    ends_with("scalar a / 0 /;\nwhile(1, a = a + 1; );\n", "E0490", 3);
    ends_with(
        "scalar a / 0 /;\nrepeat a = a + 1; until a < 0;\n",
        "E0490",
        3,
    );
    ends_with("scalar a;\nfor(a = 1 to inf, a = 1; );\n", "E0490", 3);
    ends_with(
        "set i / 1*1000 /;  alias(i,j,k,l);\nscalar s;  s = sum((i,j,k,l), 1);\n",
        "E0490",
        3,
    );
}

#[test]
fn too_much() {
    if !Path::new("/proc/self/statm").exists() {
        common::skipped("this system does not tell how much memory is used");
        return;
    }
    let square = "set i / 1*40000 /;  alias(i,j);\n";
    ends_with(
        &format!("{square}parameter p(i,j);\np(i,j) = 1;\n"),
        "E0491",
        3,
    );
    ends_with(&format!("{square}set s(i,j);\ns(i,j) = yes;\n"), "E0491", 3);
    ends_with(&format!("{square}set s(i,j) / #i.#j /;\n"), "E0343", 2);
    ends_with("set i / 1*1000000000 /;\n", "E0343", 2);
    ends_with("set i / 1*60000000 /;\n", "E0343", 2);
    // What the data in the text take is counted while they are read.
    ends_with("set t / 2000*20040001 /;\n", "E0491", 2);
    ends_with("set i / 1*4000 /, s(i,i) / #i.#i /;\n", "E0491", 2);
}

#[test]
fn recursion() {
    ends_with(
        "$macro f(x) g(x) + 1\n$macro g(x) f(x) + 1\nscalar a;\na = f(1);\n",
        "E0111",
        2,
    );
    ends_with("$include m.blk\n", "E0105", 2);
    ends_with("$batInclude m.blk 1\n", "E0105", 2);
    ends_with("$label again\n$goto again\n", "E0116", 2);
    ends_with(
        &format!("scalar s;\ns = {}1;\n", "-(".repeat(50_000)),
        "E0204",
        2,
    );
    let sums = "sum(i, ".repeat(60);
    run(
        &format!(
            "set i / a /;\nscalar s;\ns = {sums} 1 {};\n",
            ")".repeat(60)
        ),
        1.0,
        200,
    );
}

#[test]
fn programs_are_refused() {
    ends_with("$call gams other.gms\n", "E0113", 2);
    // This one is passed over, as in GAMS a program that cannot be started.
    ends_with("execute 'rm -rf /';\n", "E0322", 0);
    ends_with(
        "$onEmbeddedCode Python:\nimport os\n$offEmbeddedCode\n",
        "E0113",
        2,
    );
}

/// Texts that once made a run panic.
#[test]
fn found_by_damage() {
    // A variable without a domain, used as a scalar first, then with an index.
    run(
        "set i / a, b /;\nvariable x, z;\nequation e, o;\ne(i).. x =g= ord(i);\no.. z =e= sum(i, x(i));\n\
         model m / all /;\nsolve m using lp minimizing z;\n",
        5.0,
        2000,
    );
    // A width that no formatter takes.
    run(
        "file out / wide.txt /;\nout.nw = 678000000; out.lw = 1e9; out.tw = inf;\nput out 1 'text' out.ts;\n",
        5.0,
        2000,
    );
}

/// A word, a number, a text in quotes, blanks, or one other character.
fn words(text: &str) -> Vec<&str> {
    let mut out = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let of = |f: fn(char) -> bool| rest.find(|c: char| !f(c)).unwrap_or(rest.len());
        let n = match first {
            'a'..='z' | 'A'..='Z' | '0'..='9' | '_' => {
                of(|c| c.is_ascii_alphanumeric() || c == '_')
            }
            ' ' | '\n' => of(|c| c == ' ' || c == '\n'),
            '\'' | '"' => rest[1..].find(first).map_or(1, |k| k + 2),
            c => c.len_utf8(),
        };
        out.push(&rest[..n]);
        rest = &rest[n..];
    }
    out
}

/// What damage puts into a text, between the words.
const SCRAPS: &[&str] = &[
    "(",
    ")",
    "(i)",
    "(i,j)",
    "(i-1)",
    "('a')",
    "$",
    "$(1)",
    "$i(i)",
    ".l",
    ".m",
    ".lo",
    ".up",
    ".fx",
    ".val",
    ".local",
    "eps",
    "inf",
    "-inf",
    "na",
    "undf",
    "0",
    "1e300",
    "-1",
    "1e-300",
    "sum(i,",
    "smax(j,",
    "prod(i,",
    "=",
    "=e=",
    "..",
    "**",
    "/",
    "*",
    "- ",
    "not ",
    "and ",
    "yes",
    "no",
    "ord(i)",
    "card(i)",
    "i",
    "j",
    "i++1",
    "i--1",
    "i+1",
    "power(",
    "uniform(0,1)",
    "sqrt(",
    "exp(",
    "abs(",
    "mod(",
    ";",
    ",",
    "\n",
    "loop(i,",
    "if(1,",
    "display ",
    "put ",
    "alias(i,k);",
    "option clear=",
    "set i / a, b /;",
    "$onMulti\n",
    "$onEmpty\n",
    "#",
    ":",
    "'a'",
    "sameas(i,'a')",
    "%n%",
    "singleton ",
];

/// Names, numbers, quoted texts, and other characters.
fn kind(word: &str) -> u8 {
    match word.as_bytes().first() {
        Some(c) if c.is_ascii_digit() => 0,
        Some(c) if c.is_ascii_alphabetic() => 1,
        Some(b'\'' | b'"') => 2,
        Some(b' ' | b'\n') | None => 3,
        _ => 4,
    }
}

#[derive(Clone, Debug)]
enum Damage {
    /// Another word of the text, of the same kind.
    Replace(prop::sample::Index, prop::sample::Index),
    Delete(prop::sample::Index, usize),
    Insert(prop::sample::Index, prop::sample::Index),
    Double(prop::sample::Index, usize),
    Swap(prop::sample::Index, prop::sample::Index),
    /// A piece of another model.
    Graft(
        prop::sample::Index,
        prop::sample::Index,
        prop::sample::Index,
        usize,
    ),
}

fn damage() -> impl Strategy<Value = Damage> {
    use any as a;
    use prop::sample::Index;
    prop_oneof![
        5 => (a::<Index>(), a::<Index>()).prop_map(|(i, j)| Damage::Replace(i, j)),
        1 => (a::<Index>(), 1usize..6).prop_map(|(i, n)| Damage::Delete(i, n)),
        1 => (a::<Index>(), a::<Index>()).prop_map(|(i, s)| Damage::Insert(i, s)),
        1 => (a::<Index>(), 1usize..20).prop_map(|(i, n)| Damage::Double(i, n)),
        1 => (a::<Index>(), a::<Index>()).prop_map(|(i, j)| Damage::Swap(i, j)),
        1 => (a::<Index>(), a::<Index>(), a::<Index>(), 1usize..40)
            .prop_map(|(i, f, k, n)| Damage::Graft(i, f, k, n)),
    ]
}

fn apply(texts: &[String], which: usize, list: &[Damage]) -> String {
    let mut w = words(&texts[which]);
    for d in list {
        if w.is_empty() {
            break;
        }
        match d {
            Damage::Replace(i, j) => {
                let i = i.index(w.len());
                let alike: Vec<&str> = w
                    .iter()
                    .copied()
                    .filter(|o| kind(o) == kind(w[i]))
                    .collect();
                w[i] = alike[j.index(alike.len())];
            }
            Damage::Delete(i, n) => {
                let i = i.index(w.len());
                w.drain(i..(i + n).min(w.len()));
            }
            Damage::Insert(i, s) => w.insert(i.index(w.len()), SCRAPS[s.index(SCRAPS.len())]),
            Damage::Double(i, n) => {
                let i = i.index(w.len());
                let piece = w[i..(i + n).min(w.len())].to_vec();
                w.splice(i..i, piece);
            }
            Damage::Swap(i, j) => {
                let (i, j) = (i.index(w.len()), j.index(w.len()));
                w.swap(i, j);
            }
            Damage::Graft(i, f, k, n) => {
                let other = words(&texts[f.index(texts.len())]);
                if !other.is_empty() {
                    let k = k.index(other.len());
                    let i = i.index(w.len());
                    w.splice(i..i, other[k..(k + n).min(other.len())].iter().copied());
                }
            }
        }
    }
    w.concat()
}

/// The models of the suite that are short.
fn texts() -> Vec<String> {
    let files = common::files(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite"),
        &["blk"],
    );
    files
        .iter()
        .map(|p| std::fs::read_to_string(p).expect("the file can be read"))
        .filter(|t| t.len() < 4000)
        .collect()
}

#[test]
fn damaged_runs() {
    let cases = std::env::var("FUZZ_CASES")
        .ok()
        .and_then(|c| c.parse().ok());
    let texts = texts();
    let check = move || {
        let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig {
            cases: cases.unwrap_or(150),
            failure_persistence: None,
            max_shrink_iters: 2000,
            ..ProptestConfig::default()
        });
        let input = (0..texts.len(), prop::collection::vec(damage(), 1..5));
        let ran = std::cell::Cell::new(0);
        let result = runner.run(&input, |(which, list)| {
            let text = apply(&texts, which, &list);
            let start = Instant::now();
            let finished = run(&text, 0.3, 300);
            ran.set(ran.get() + usize::from(finished.end.exit() != 2));
            prop_assert!(start.elapsed().as_secs() < 30, "took too long:\n{}", text);
            Ok(())
        });
        println!("{} of them ran", ran.get());
        if let Err(e) = result {
            if let proptest::test_runner::TestError::Fail(_, (which, list)) = &e {
                println!("the text:\n{}\n", apply(&texts, *which, list));
            }
            panic!("{e}");
        }
    };
    // Nested expressions need room on the stack.
    let thread = std::thread::Builder::new()
        .stack_size(64 << 20)
        .spawn(check);
    thread.expect("a thread").join().expect("no run panics");
}
