//! The language service: layout, diagnostics with fixes, hover, completion, names; texts that are half typed; random edits.

use crate::common::{Memory, files, shared};
use bmod::check::{Program, compile};
use bmod::editor::{Editor, Location, Position, Range, format};
use bmod::solve::registry::SOLVERS;
use bmod::source::PreprocessOptions;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

fn has_slashes(file: &Path) -> bool {
    file.extension().is_some_and(|e| e == "blk")
}

/// What a text compiles to, places aside.
fn program(text: &str, file: &Path) -> Option<String> {
    let name = file
        .file_name()
        .expect("a name")
        .to_string_lossy()
        .into_owned();
    let all = BTreeMap::from([(name.clone(), text.to_owned())]);
    let mut host = Memory::new(all, file.parent().map(Path::to_path_buf));
    let options = PreprocessOptions {
        slash_comments: has_slashes(file),
        max_memory: Some(64 << 20),
        ..PreprocessOptions::default()
    };
    let p: Program = compile(&mut host, &name, options, &SOLVERS).ok()?;
    let codes: Vec<&str> = p.diagnostics.iter().map(|d| d.code).collect();
    let all = format!(
        "{:?}\n{:?}\n{:?}\n{:?}\n{codes:?}",
        p.symbols, p.store, p.equations, p.code
    );
    // Places are behind `Span { lo: 1, hi: 2 }`.
    let mut out = String::with_capacity(all.len());
    let mut parts = all.split("Span {");
    out.push_str(parts.next().unwrap_or(""));
    for part in parts {
        out.push_str(part.split_once('}').map_or(part, |p| p.1));
    }
    Some(out)
}

/// Our models, the suite, and public models where they are at hand: every `step`th.
fn texts(step: usize) -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = files(&root.join("models"), &["blk", "inc"]);
    all.extend(files(&root.join("tests/suite"), &["blk", "gms"]));
    if let Some(corpus) = shared("corpus") {
        all.extend(files(&corpus, &["gms"]).into_iter().step_by(step));
    }
    let read = |f: PathBuf| Some((f.clone(), std::fs::read_to_string(&f).ok()?));
    all.into_iter()
        .filter_map(read)
        .filter(|(_, t)| t.len() < 200_000)
        .collect()
}

/// `LAYOUT_ALL=1` takes every public model instead of each fortieth.
#[test]
fn layout_keeps_the_program_and_is_done_once() {
    let step = if std::env::var_os("LAYOUT_ALL").is_some() {
        1
    } else {
        40
    };
    let mut seen = 0;
    for (file, text) in texts(step) {
        let new = format(&text, has_slashes(&file));
        assert!(
            new == format(&new, has_slashes(&file)),
            "{}: laid out twice, it changes again",
            file.display()
        );
        if new != text {
            seen += 1;
            assert!(
                program(&text, &file) == program(&new, &file),
                "{}: another program",
                file.display()
            );
        }
    }
    println!("{seen} texts changed their layout and stayed the same programs");
    assert!(seen > 20);
}

#[test]
fn layout() {
    let text = "\
SETS I canning plants / Seattle,  San-Diego /
     J markets  /New-York,Chicago/ ;
Parameter A(I)   capacity
   / Seattle 350
     San-Diego 600 / ;
  TABLE D(I,J)  distance
              New-York  Chicago
   Seattle      2.5       1.7
   San-Diego    2.5       1.8  ;
POSITIVE VARIABLE X ( I , J ); variable z;

EQUATIONS COST, SUPPLY(I) limit;


COST ..   Z=E=SUM((I,J) , D(I,J) * X(I,J)) ;
Supply(I)$(A(I)>0)..   SUM( J, X(I, J) )=L= A(I)+ -1*eps;
* a comment   stays
Loop(I, a(i)=a(i)+1;
if(a(i)>3 and Not sameas(i,'x'),
display a;
else
  abort 'no';);
);
MODEL transport /all/;
x.up(i,j)=power( A(i) , 2 );a(i) = -3;
SOLVE transport USING lp MINIMIZING z;
$ontext
  Anything   here
$offtext
";
    insta::assert_snapshot!(format(text, false));
    // What stands in braces keeps its blanks; nothing comes between `;` and `)`.
    for text in [
        "figure f { points(i) x = ord(i); };\n",
        "loop(i, q(i) = 1;);\n",
    ] {
        assert_eq!(format(text, true), text);
    }
    // Comments behind code, and what must not come to the first column.
    let text = "x = 2 // two\n *3;   // three\n  y  = a\n     $b;\n";
    assert_eq!(
        format(text, true),
        "x = 2  // two\n *3;  // three\ny = a\n  $b;\n"
    );
}

const BLEND: &str = "\
Set i 'ingredients' / corn 'yellow', soy /;
Parameters price(i) 'per ton' / corn 30, soy 90 /, need;
need = 0.3;
Positive variable share(i);
Variable cost;
Equations total, whole(i);
total..  cost =e= sum(i, price(i)*share(i));
whole(i)..  share(i) =l= 1;
Model blend 'the cheapest' / all /;
solve blend using lp minimizing cost;
display share.l, price;
*= cost.l 0
";

fn open(text: &str) -> Editor {
    let mut editor = Editor::new(None);
    editor.open("blend.blk", text);
    editor.check("blend.blk");
    editor
}

/// The place of the `n`th time that a text has `what`, and so many characters on.
fn at(text: &str, what: &str, n: usize, on: usize) -> Position {
    let (offset, _) = text.match_indices(what).nth(n).expect("the text has it");
    let before = &text[..offset];
    let line = before.matches('\n').count();
    let start = before.rfind('\n').map_or(0, |n| n + 1);
    Position {
        line: line as u32,
        character: (before[start..].encode_utf16().count() + on) as u32,
    }
}

#[test]
fn hover() {
    let e = open(BLEND);
    let hover = |what: &str, n, on| {
        e.hover("blend.blk", at(BLEND, what, n, on))
            .map(|h| h.contents)
            .unwrap_or_default()
    };
    let mut all = String::new();
    for (what, n, on) in [
        ("price", 1, 2),
        ("share(i)", 1, 0),
        ("whole", 1, 0),
        ("corn", 1, 0),
        ("sum", 0, 1),
        ("blend", 1, 1),
        (".l", 0, 1),
        ("=l=", 0, 1),
        ("Equations", 0, 3),
    ] {
        all += &format!("--- {what}\n{}\n", hover(what, n, on));
    }
    insta::assert_snapshot!(all);
}

#[test]
fn names() {
    let e = open(BLEND);
    let lines = |list: Vec<Location>| list.iter().map(|l| l.range.start.line).collect::<Vec<_>>();
    assert_eq!(
        lines(e.definition("blend.blk", at(BLEND, "price", 1, 0))),
        [1]
    );
    // An equation is declared and defined.
    assert_eq!(
        lines(e.definition("blend.blk", at(BLEND, "whole", 0, 0))),
        [5, 7]
    );
    assert_eq!(
        lines(e.references("blend.blk", at(BLEND, "cost", 0, 0), true)),
        [4, 6, 9, 11]
    );
    let edits = e
        .rename("blend.blk", at(BLEND, "cost", 0, 0), "outlay")
        .expect("it can be renamed");
    assert_eq!(edits.len(), 4);
    for (new, why) in [
        ("sum", "no name"),
        ("price", "already"),
        ("2x", "no name"),
        ("x y", "no name"),
        ("exp", "no name"),
    ] {
        let wrong = e
            .rename("blend.blk", at(BLEND, "cost", 0, 0), new)
            .expect_err("refused");
        assert!(wrong.to_string().contains(why), "{new}: {wrong}");
    }
    assert!(
        e.rename("blend.blk", at(BLEND, "Model", 0, 0), "x")
            .is_err()
    );
}

fn labels(e: &Editor, text: &str, what: &str, on: usize) -> Vec<String> {
    let list = e.completion("blend.blk", at(text, what, 0, on));
    list.into_iter().map(|c| c.label).collect()
}

#[test]
fn completion() {
    let typed = |more: &str| {
        let mut e = open(BLEND);
        let text = format!("{BLEND}{more}");
        e.open("blend.blk", text.as_str());
        e.check("blend.blk");
        let labels = e.completion("blend.blk", at(&text, more, 0, more.len()));
        labels.into_iter().map(|c| c.label).collect::<Vec<_>>()
    };
    assert_eq!(typed("price('"), ["corn", "soy"]);
    assert_eq!(typed("price('co')= 3; display price('c"), ["corn", "soy"]);
    assert_eq!(typed("solve "), ["blend"]);
    assert!(typed("solve blend using ").contains(&"nlp".to_owned()));
    assert_eq!(typed("solve blend using lp minimizing "), ["cost"]);
    assert!(typed("x = share.").contains(&"lo".to_owned()));
    assert!(typed("x = blend.").contains(&"modelStat".to_owned()));
    assert_eq!(typed("Model other / "), ["all", "blend", "total", "whole"]);
    assert_eq!(typed("Parameter q(i) / "), ["corn", "soy"]);
    assert!(typed("Parameter q(").contains(&"i".to_owned()));
    assert!(typed("$inc").contains(&"include".to_owned()));
    let any = typed("x = pr");
    for word in ["price", "prod", "power", "sqrt", "share"] {
        assert!(any.contains(&word.to_owned()), "{word}");
    }
    assert!(typed("\npos").contains(&"positive".to_owned()));
    assert!(typed("* a comment ").is_empty());
    // The signs of a label belong to the word that is replaced.
    let text = "Set i / new-york, 'los angeles' /;\nParameter p(i) / new- /;\n";
    let e = open(text);
    let found = e.completion("blend.blk", at(text, "new- ", 0, 4));
    let found: Vec<_> = found.iter().map(|c| (&*c.label, c.range.start)).collect();
    let start = at(text, "new- ", 0, 0);
    assert_eq!(found, [("'los angeles'", start), ("new-york", start)]);
    // A place in the middle.
    let e = open(BLEND);
    assert_eq!(
        labels(&e, BLEND, "using lp", 6).len(),
        labels(&e, BLEND, "using lp", 7).len()
    );
}

#[test]
fn diagnostics_and_their_fixes() {
    for (wrong, title, new) in [
        ("display prise;", "Replace `prise` by `price`", "price"),
        (
            "price('korn') = 1;",
            "Replace `'korn'` by `'corn'`",
            "'corn'",
        ),
        ("display share.ll;", "Replace `ll` by `l`", "l"),
        (
            "option decimalz = 3;",
            "Replace `decimalz` by `decimals`",
            "decimals",
        ),
    ] {
        let mut e = Editor::new(None);
        e.open("blend.blk", format!("{BLEND}{wrong}\n"));
        let found = e.check("blend.blk");
        let d = &found[0].diagnostics[0];
        assert_eq!(d.fixes.len(), 1, "{wrong}: {d:?}");
        assert_eq!(
            (
                d.fixes[0].title.as_str(),
                d.fixes[0].edits[0].new_text.as_str()
            ),
            (title, new)
        );
        let edit = &d.fixes[0].edits[0];
        e.change("blend.blk", Some(edit.range), &edit.new_text);
        let left = e.check("blend.blk");
        assert!(
            left.iter().all(|f| f.diagnostics.is_empty()),
            "{wrong}: {left:?}"
        );
    }
}

/// Half-typed text: what was known is still known.
#[test]
fn the_last_good_program_answers() {
    let mut e = open(BLEND);
    let broken = BLEND.replace(
        "Parameters price(i) 'per ton' / corn 30, soy 90 /, need;",
        "Parameters price(i",
    );
    e.open("blend.blk", broken.as_str());
    let wrong = e.check("blend.blk");
    assert!(!wrong[0].diagnostics.is_empty());
    let hover = e
        .hover("blend.blk", at(&broken, "price(i)*", 0, 1))
        .expect("an answer");
    assert!(hover.contents.contains("per ton"), "{}", hover.contents);
    assert!(
        e.completion("blend.blk", at(&broken, "display", 0, 8))
            .iter()
            .any(|c| c.label == "price")
    );
}

/// A quote that is still open, behind it a character of several bytes.
#[test]
fn an_open_quote() {
    let text = "Set i / a /;\ndisplay i, '😀\n";
    let mut e = open(text);
    e.check("blend.blk");
    let place = at(text, "'😀", 0, 1);
    assert!(e.hover("blend.blk", place).is_none());
    assert!(e.references("blend.blk", place, true).is_empty());
}

/// What is missing behind a character of several bytes is told, and mended, behind it.
#[test]
fn a_mistake_at_a_wide_character() {
    let text = "scalar x\né\nx = 1;\n";
    let mut e = open(text);
    let found = e.check("blend.blk");
    let fixes: Vec<_> = found
        .iter()
        .flat_map(|f| &f.diagnostics)
        .flat_map(|d| &d.fixes)
        .collect();
    let [fix] = fixes[..] else {
        panic!("one fix: {}", fixes.len());
    };
    assert_eq!(fix.edits[0].new_text, ";");
    let behind = Position {
        line: 1,
        character: 1,
    };
    assert_eq!(fix.edits[0].range.start, behind);
}

/// Files that include others are one model; what is wrong in an included file is told there.
#[test]
fn includes() {
    let mut e = Editor::new(None);
    e.open("m/main.blk", "$include part.blk\ndisplay p;\n");
    e.open("m/part.blk", "Parameter p;\np = q;\n");
    let found = e.check("m/main.blk");
    let of = |file: &str| {
        found
            .iter()
            .find(|f| f.file == file)
            .map(|f| f.diagnostics.len())
    };
    assert_eq!((of("m/main.blk"), of("m/part.blk")), (Some(0), Some(1)));
    // The part is checked with its model, and knows what that declares.
    assert_eq!(e.main_of("m/part.blk"), "m/main.blk");
    e.change("m/part.blk", None, "Parameter p;\np = 2;\n");
    assert!(
        e.check("m/part.blk")
            .iter()
            .all(|f| f.diagnostics.is_empty())
    );
    let found = e.definition(
        "m/main.blk",
        Position {
            line: 1,
            character: 8,
        },
    );
    assert_eq!(found[0].file, "m/part.blk");
    let found = e.definition(
        "m/main.blk",
        Position {
            line: 0,
            character: 12,
        },
    );
    assert_eq!(found[0].file, "m/part.blk");
    let edits = e
        .rename(
            "m/main.blk",
            Position {
                line: 1,
                character: 8,
            },
            "w",
        )
        .expect("renamed");
    assert_eq!(edits.len(), 3);
}

#[test]
fn outline_folds_tokens_lenses_signatures() {
    let e = open(BLEND);
    let outline: Vec<String> = e
        .outline("blend.blk")
        .iter()
        .map(|i| format!("{:?} {}", i.kind, i.name))
        .collect();
    insta::assert_snapshot!(outline.join("\n"));
    assert_eq!(e.lenses("blend.blk").len(), 2);
    let s = e
        .signature("blend.blk", at(BLEND, "price(i)*", 0, 6))
        .expect("a signature");
    assert_eq!((s.label.as_str(), s.active), ("price(i)", 0));
    let text = "x = power(2, ";
    let mut f = Editor::new(None);
    f.open("a.blk", text);
    let s = f
        .signature(
            "a.blk",
            Position {
                line: 0,
                character: 13,
            },
        )
        .expect("a signature");
    assert_eq!(
        (s.label.as_str(), s.active, s.parameters.len()),
        ("power(x, n)", 1, 2)
    );
    f.open(
        "a.blk",
        "$ifThen set x\nSet i /\n a\n /;\n* one\n* two\n$endIf\n",
    );
    let folds: Vec<(u32, u32)> = f.folds("a.blk").iter().map(|f| (f.start, f.end)).collect();
    assert_eq!(folds, [(0, 6), (1, 3), (4, 5)]);
    // Each word has its kind, before anything was compiled.
    let kinds: Vec<&str> = f
        .tokens("a.blk")
        .iter()
        .map(|t| bmod::editor::TOKEN_KINDS[t.kind as usize])
        .collect();
    assert_eq!(
        kinds,
        [
            "macro",
            "keyword",
            "type",
            "enumMember",
            "comment",
            "comment",
            "macro"
        ]
    );
}

/// Names in data, in directives and in claims are renamed with the symbol; what cannot be followed refuses.
#[test]
fn renames() {
    let text = "\
$set n 3
Set i / a, b /, both / #i, c /, third / set.i /;
Scalar n / 2 /;
Acronym red;
Parameter p(i) / a [2*n], b red /;
$eval n card(i)
$if set n Scalar k / %n% /;
display n;
*= n 2
";
    for (old, on, times) in [
        ("n / 2", 0, 4),
        ("i / a", 0, 5),
        ("red;", 0, 2),
        ("#i", 1, 5),
    ] {
        let mut e = open(text);
        let edits = e.rename("blend.blk", at(text, old, 0, on), "other");
        let mut edits = edits.expect("it can be renamed");
        assert_eq!(edits.len(), times, "{old}: {edits:?}");
        edits.sort_by_key(|e| std::cmp::Reverse(e.range.start));
        for edit in edits {
            e.change("blend.blk", Some(edit.range), &edit.new_text);
        }
        let left = e.check("blend.blk");
        assert!(left.iter().all(|f| f.diagnostics.is_empty()), "{left:?}");
    }
    // A macro builds the name.
    let text =
        "$macro of(w) cost_&w\nScalar cost_a / 1 /;\ndisplay cost_a;\nScalar b; b = of(a);\n";
    let wrong = open(text).rename("blend.blk", at(text, "cost_a", 0, 0), "price");
    let wrong = wrong.expect_err("refused").to_string();
    assert!(wrong.contains("cost_a"), "{wrong}");
}

/// What `%name%` and a macro stand for, and where that is said; a figure's name is its place in the outline.
#[test]
fn substitutions() {
    let text = "\
$if not set friction $set friction 0.65
$macro twice(x) (2*x)
Scalar a; a = twice(%friction%);
Set i / p /; Parameter y(i) / p 1 /;
figure shape { points(i) x = y(i), y = y(i); };
";
    let e = open(text);
    for (word, on, given) in [
        ("%friction%", 4, "$set friction 0.65"),
        ("twice(%", 2, "$macro twice(x) (2*x)"),
    ] {
        let place = at(text, word, 0, on);
        let hover = e.hover("blend.blk", place).expect("something is known");
        assert_eq!(hover.contents, format!("```bmod\n{given}\n```"));
        let found = e.definition("blend.blk", place);
        assert_eq!(found[0].range.start, at(text, given, 0, 0));
    }
    let outline = e.outline("blend.blk");
    let figure = outline
        .iter()
        .find(|i| i.name == "shape")
        .expect("it is there");
    assert_eq!(figure.selection.start, at(text, "shape", 0, 0));
}

/// A stream of random numbers.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 33) as usize) % n.max(1)
    }
}

/// A file that its main file does not include after all is checked by itself; data are no text of a model.
#[test]
fn a_file_that_is_not_included() {
    let mut e = Editor::new(None);
    e.open("main.blk", "$ifThen set other\n$include opt.blk\n$endIf\n");
    e.open("opt.blk", "Scalar y;\ny = q;\n");
    e.open("data.csv", "i,value\n");
    for file in ["opt.blk", "data.csv"] {
        e.set_main(file, "main.blk");
    }
    let wrong = |e: &mut Editor, file: &str| -> usize {
        let all = e.check(file);
        all.iter()
            .filter(|f| f.file == file)
            .map(|f| f.diagnostics.len())
            .sum()
    };
    assert_eq!(wrong(&mut e, "opt.blk"), 1);
    assert_eq!(wrong(&mut e, "data.csv"), 0);
    e.open("main.blk", "Scalar q / 1 /;\n$include opt.blk\n");
    e.check("main.blk");
    assert_eq!(wrong(&mut e, "opt.blk"), 0);
}

/// Names that double with each `$set`, and jumps without end: an error while there is time and memory.
#[test]
fn directives_that_grow() {
    let mut text = String::from("$set a xxxxxxxxxx\n");
    text += &"$set a %a%%a%\n".repeat(40);
    for (text, code) in [
        (text.as_str(), "E0108"),
        ("$maxGoto 1000000000\n$label x\n$goto x\n", "E0116"),
    ] {
        let mut e = open(text);
        let found = e.check("blend.blk");
        assert_eq!(found[0].diagnostics[0].code, code);
        assert!(!found[0].diagnostics[0].message.contains("1000000 times"));
    }
}

/// A blank of Unicode is no separator: it is cut nowhere.
#[test]
fn blanks_of_unicode() {
    for text in [
        "Scalar rate\u{a0};\nrate = 1;\n",
        "Set f\u{2028};\n",
        "Set i / a \u{a0}, b \u{2028} /;\n",
        "Parameters\n   d\u{a0}(i-1);\n",
    ] {
        format(text, true);
        open(text);
    }
}

/// Random edits of models, as many as `EDITS` says: nothing crashes, and what was asked is answered. It tells the share of the
/// answers and compilations within 100 ms, percentiles, and the slowest.
#[test]
fn random_edits() {
    let edits: usize = std::env::var("EDITS")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(300);
    let all: Vec<(PathBuf, String)> = texts(if edits > 1000 { 4 } else { 100 })
        .into_iter()
        .filter(|t| t.1.len() < 20_000)
        .collect();
    const PIECES: &[&str] = &[
        ";",
        "/",
        "(",
        ")",
        "'",
        "\"",
        ",",
        "\n",
        "$",
        "*",
        "..",
        "=e=",
        "loop(",
        "$ontext\n",
        "\n$include x.gms\n",
        "é",
        "😀",
        "\u{a0}",
        "\u{2028}",
        "sum(i, ",
        "Set q / a*",
        "Table t(i,j)\n",
        "%x%",
        "$if ",
        ".",
        " ",
        "\t",
        "solve ",
        "1e",
        "{",
        "}",
        "[",
        "endloop",
        "until",
        "else",
        "\r\n",
        "//",
        "!!",
        "= ",
    ];
    let mut r = Random(7);
    let mut times: [Vec<(f64, &str, PathBuf)>; 2] = Default::default();
    let mut done = 0;
    'all: loop {
        for (file, text) in &all {
            let name = file.to_string_lossy().into_owned();
            let mut e = Editor::new(None);
            e.open(&name, text.as_str());
            e.check(&name);
            for _ in 0..10 {
                if done == edits {
                    break 'all;
                }
                done += 1;
                let now = e.text(&name).expect("it is open").to_owned();
                let lines = now.matches('\n').count() + 1;
                let mut place = || Position {
                    line: r.below(lines) as u32,
                    character: r.below(40) as u32,
                };
                let (a, b) = (place(), place());
                let b = if r.below(4) == 0 { b } else { a };
                let range = Range {
                    start: a.min(b),
                    end: a.max(b),
                };
                let new = if r.below(5) == 0 {
                    ""
                } else {
                    PIECES[r.below(PIECES.len())]
                };
                let mut timed = |which: usize, what: &'static str, work: &mut dyn FnMut()| {
                    let start = Instant::now();
                    work();
                    times[which].push((start.elapsed().as_secs_f64(), what, file.clone()));
                };
                timed(1, "change", &mut || e.change(&name, Some(range), new));
                timed(0, "check", &mut || drop(e.check(&name)));
                timed(1, "hover", &mut || drop(e.hover(&name, a)));
                timed(1, "completion", &mut || drop(e.completion(&name, a)));
                timed(1, "signature", &mut || drop(e.signature(&name, a)));
                timed(1, "definition", &mut || drop(e.definition(&name, a)));
                timed(1, "references", &mut || drop(e.references(&name, a, true)));
                timed(1, "rename", &mut || drop(e.rename(&name, a, "other")));
                timed(1, "outline", &mut || drop(e.outline(&name)));
                timed(1, "folds", &mut || drop(e.folds(&name)));
                timed(1, "tokens", &mut || drop(e.tokens(&name)));
                timed(1, "lenses", &mut || drop(e.lenses(&name)));
                timed(1, "format", &mut || drop(e.format(&name)));
            }
        }
    }
    for (what, mut times) in ["compilations", "answers"].into_iter().zip(times) {
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        let n = times.len();
        let within = times.partition_point(|t| t.0 <= 0.1);
        let at = |share: f64| times[((n as f64 * share) as usize).min(n - 1)].0 * 1e3;
        let (slowest, which, file) = &times[n - 1];
        println!(
            "{done} edits, {n} {what}: {} above 100 ms ({:.3} % within); median {:.2} ms, 99 % within {:.1} ms, 99.9 % within {:.1} ms; slowest {:.0} ms ({which}, {})",
            n - within,
            within as f64 / n as f64 * 100.0,
            at(0.5),
            at(0.99),
            at(0.999),
            slowest * 1e3,
            file.display()
        );
    }
}
