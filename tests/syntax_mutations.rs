//! No text makes the reader panic or run without end: models with random damage.

use std::collections::BTreeMap;

use crate::common::Memory;
use bmod::source::{NothingKnown, PreprocessOptions, Span};
use bmod::syntax::Parser;
use bmod::syntax::ast::{StmtKind, SymbolDecl};
use bmod::syntax::data::{DataKind, DataReader};
use bmod::syntax::table::TableReader;
use proptest::prelude::*;

/// Texts that hold every construct at least once.
const SEEDS: &[&str] = &[
    "$title A transport model\n$offupper offsymxref\n$eolCom !!\n$inlineCom { }\n$set n 3\n$setGlobal g yes\n\
     Sets i  canning plants / seattle, san-diego 'the \"other\"' /\n  j(*) markets / j1*j%n%, (a,b*d).(x,y) text /;\n\
     $ifThen.one %n% == 3\n$log three\n$elseIf.one set x\n$log x\n$else.one\n$abort no\n$endIf.one\n\
     $macro sq(x,y) ((x)*(y) + &x)\nscalar s producer's cost /3/, t 'text' / -inf /;\n\
     Table d(i,j)  distance in miles\n                  j1       'j 2'\n    seattle   2.5   1.7\n+   j3\n  seattle - 4 ;\n\
     s = sq(2,3); !! comment\nt = { inline } 4;\n$include inc.gms\n$batInclude inc.gms one 'two three'\n",
    "variables x(i,j) shipments, z; positive variable x;\nequations cost, supply(i) 'limit', e;\n\
     cost.. z =e= sum((i,j)$(ord(i) > 1 and not sameas(j,'a')), c(i,j)*x(i,j));\n\
     supply(i)$a(i).. sum{j, x(i,j)} =l= a(i)**2 - (-b(i))$c(i)/3 + 1e-3;\n\
     model m 'all of it' / all, - e, f.x, (g|h).y /; solve m using lp minimizing z;\n\
     loop((i,j)$(x.l(i,j) > 0), s = s + 1; if(s > 3, break; elseif s, display s; else abort 'x';););\n\
     while(s < 3, s = s + 1); for(k = 10 downto 1 by 2, t = k); repeat(s = s - 1; until s < 0);\n\
     file f / out.txt /; put f 'a':<10 x.l('a','b'):8:3 / @5 #2; putclose;\n\
     option a:3:0:1, limrow = 0, r < q; display$(s) 'a', x.l; execute_unload 'x.gdx' x, y = z;\n\
     figure w 'title' { polygon(b,v)$c x = p(b,v), y = 2; title 'a', z.l; }; draw w 'a.svg';\n",
    "$onText\nanything ; ' goes\n$offText\n$onEcho > a.inc\nparameter p / a 1 /;\n$offEcho\n$include a.inc\n$onPut\nline 'x' \"y\"\n$offPut\n\
     $onEnd\nif s then t = 1; else t = 2; endif;\nloop i do s = 1; endloop;\n$offEnd\n$gdxIn x.csv\n$load i j=k\n$kill p\n\
     $goto there\ns = 1;\n$label there\n$ifE (2+3)*4 > 10 $eval y 2**3\n$if not exist nothing.gms $set z %y%\n\
     alias (i,ip), (*,u); acronym mon, tue; set k(i) / #i, i.i /; s $= 3; s := 4;\n\
     parameter v(i,j,k) / a.b.c 1, (a,b).c.d 2.5e3\n x.y.z = eps, 'q r'.s.t na, #i:#j.k 3 /;\n",
];

fn read_everything(text: &str) {
    let files = BTreeMap::from([
        ("m.gms".to_owned(), text.to_owned()),
        (
            "inc.gms".to_owned(),
            "* part %1\n$set inner %2\nq = 1;\n$include m.gms\n".to_owned(),
        ),
    ]);
    for slash_comments in [false, true] {
        let mut host = Memory::new(files.clone(), None);
        let options = PreprocessOptions {
            defines: vec![("d".into(), "1".into())],
            slash_comments,
            ..PreprocessOptions::default()
        };
        let Ok(mut parser) = Parser::new(&mut host, "m.gms", options) else {
            continue;
        };
        let mut steps = 0;
        loop {
            steps += 1;
            assert!(steps < 100_000, "the parser does not end");
            let stmt = match parser.next(&NothingKnown) {
                Ok(None) => break,
                Ok(Some(s)) => s,
                Err(list) => {
                    for d in list {
                        let map = parser.map();
                        let p = map.place(d.span).expect("a diagnostic has a place");
                        let file = map.file(p.file);
                        assert!(p.lo <= p.hi && p.hi as usize <= file.text.len());
                    }
                    continue;
                }
            };
            assert!(
                stmt.span.lo <= stmt.span.hi
                    && stmt.span.hi as usize <= parser.map().expanded().len()
            );
            let body = |span: Span, kind| {
                let mut reader = DataReader::new(parser.text(span), span.lo, kind, false);
                let mut n = 0;
                while let Some(r) = reader.next() {
                    n += 1;
                    assert!(
                        n <= 10 + (span.hi - span.lo) as usize,
                        "the data reader does not end"
                    );
                    drop(r);
                }
            };
            let symbols = |list: &[SymbolDecl], kind| {
                list.iter()
                    .filter_map(|d| d.data)
                    .for_each(|s| body(s, kind))
            };
            match &stmt.kind {
                StmtKind::Set(list) => list
                    .iter()
                    .for_each(|d| symbols(std::slice::from_ref(&d.symbol), DataKind::Set)),
                StmtKind::Parameter(list) => {
                    list.iter()
                        .for_each(|d| symbols(std::slice::from_ref(&d.symbol), DataKind::Values));
                }
                StmtKind::Variable(_, list) | StmtKind::Equation(list) => {
                    symbols(list, DataKind::Values)
                }
                StmtKind::Table(t) => {
                    let Some(lines) = t.symbols.last().and_then(|d| d.data) else {
                        continue;
                    };
                    let mut reader = TableReader::new(parser.map().expanded(), lines, 2, false);
                    let mut n = 0;
                    while let Some(r) = reader.next() {
                        n += 1;
                        assert!(
                            n <= 10 + (lines.hi - lines.lo) as usize,
                            "the table reader does not end"
                        );
                        drop(r);
                    }
                }
                _ => {}
            }
        }
    }
}

/// What damage puts into a text.
const SCRAPS: &[&str] = &[
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "'",
    "\"",
    "/",
    ";",
    ",",
    ".",
    "..",
    "=",
    "=e=",
    "$",
    "\n$",
    "%",
    "%n%",
    "*",
    "\n*",
    "+",
    "\n+",
    "-",
    "**",
    "#",
    ":",
    "@",
    "é",
    "\u{1}",
    "\u{2}0\u{2}",
    "\t",
    "\r",
    "\n",
    "\n\n",
    " ",
    "set ",
    "table ",
    "loop(",
    "if(",
    "sum(",
    "else ",
    "until ",
    "$onText\n",
    "$ifThen x\n",
    "$endIf\n",
    "$else\n",
    "$$",
    "$macro a a\n",
    "$include m.gms\n",
    "$goto there\n",
    "1e999",
    "1e",
    ".5.",
    "eps",
    "inf",
    "//",
    "!!",
    "/*",
    "*/",
    "&",
    "\\",
    "scalar x /",
    "display ",
    "model m /",
    "~",
    "^",
    "0123456789012345678901234567890",
];

#[derive(Clone, Debug)]
enum Damage {
    Delete(prop::sample::Index, usize),
    Insert(prop::sample::Index, prop::sample::Index),
    Double(prop::sample::Index, usize),
    Swap(prop::sample::Index, prop::sample::Index),
}

fn damage() -> impl Strategy<Value = Damage> {
    use any as a;
    prop_oneof![
        (a::<prop::sample::Index>(), 1usize..30).prop_map(|(i, n)| Damage::Delete(i, n)),
        (a::<prop::sample::Index>(), a::<prop::sample::Index>())
            .prop_map(|(i, s)| Damage::Insert(i, s)),
        (a::<prop::sample::Index>(), 1usize..80).prop_map(|(i, n)| Damage::Double(i, n)),
        (a::<prop::sample::Index>(), a::<prop::sample::Index>())
            .prop_map(|(i, j)| Damage::Swap(i, j)),
    ]
}

fn apply(text: &str, list: &[Damage]) -> String {
    let mut chars: Vec<char> = text.chars().collect();
    for d in list {
        if chars.is_empty() {
            break;
        }
        match d {
            Damage::Delete(i, n) => {
                let i = i.index(chars.len());
                let end = (i + n).min(chars.len());
                chars.drain(i..end);
            }
            Damage::Insert(i, s) => {
                let i = i.index(chars.len());
                chars.splice(i..i, SCRAPS[s.index(SCRAPS.len())].chars());
            }
            Damage::Double(i, n) => {
                let i = i.index(chars.len());
                let piece: Vec<char> = chars[i..(i + n).min(chars.len())].to_vec();
                chars.splice(i..i, piece);
            }
            Damage::Swap(i, j) => {
                let (i, j) = (i.index(chars.len()), j.index(chars.len()));
                chars.swap(i, j);
            }
        }
    }
    chars.into_iter().collect()
}

#[test]
fn seeds_are_read() {
    for seed in SEEDS {
        read_everything(seed);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_models(seed in 0..SEEDS.len(), list in prop::collection::vec(damage(), 1..8)) {
        read_everything(&apply(SEEDS[seed], &list));
    }

    #[test]
    fn scraps(list in prop::collection::vec(0..SCRAPS.len(), 0..60)) {
        read_everything(&list.into_iter().map(|i| SCRAPS[i]).collect::<String>());
    }

    #[test]
    fn any_text(text in "\\PC{0,200}") {
        read_everything(&text);
    }
}
