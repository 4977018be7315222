//! From text to tree: what is read, and what is said about what cannot be read.

use std::collections::BTreeMap;

use crate::common::Memory;
use bmod::diag::Diagnostic;
use bmod::source::{Ending, NothingKnown, PreprocessOptions};
use bmod::syntax::Parser;
use bmod::syntax::ast::*;

/// Everything that came out of a text.
struct Outcome {
    statements: Vec<Stmt>,
    /// `line:column code` of each error.
    errors: Vec<String>,
    warnings: Vec<String>,
    log: Vec<String>,
    ending: Ending,
}

fn read_files(files: &[(&str, &str)], defines: &[(&str, &str)]) -> Outcome {
    let texts = files.iter().map(|(n, t)| ((*n).into(), (*t).into()));
    let mut host = Memory::new(texts.collect(), None);
    let main = files[0].0;
    let options = PreprocessOptions {
        defines: defines
            .iter()
            .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()))
            .collect(),
        slash_comments: main.ends_with(".blk"),
        ..PreprocessOptions::default()
    };
    let mut out = Outcome {
        statements: Vec::new(),
        errors: Vec::new(),
        warnings: Vec::new(),
        log: Vec::new(),
        ending: Ending::Regular,
    };
    let mut parser = match Parser::new(&mut host, main, options) {
        Ok(p) => p,
        Err(e) => {
            out.errors.push(format!("0:0 {}", e.diagnostic.code));
            return out;
        }
    };
    loop {
        match parser.next(&NothingKnown) {
            Ok(None) => break,
            Ok(Some(s)) => out.statements.push(s),
            Err(list) => {
                for d in list {
                    out.errors.push(place(&parser, &d));
                }
            }
        }
    }
    out.warnings = parser
        .warnings()
        .iter()
        .map(|d| place(&parser, d))
        .collect();
    out.ending = parser.ending();
    out.log = host.printed;
    out
}

fn place(parser: &Parser<'_>, d: &Diagnostic) -> String {
    let map = parser.map();
    let p = map.place(d.span).expect("every diagnostic has a place");
    let (line, column) = map.file(p.file).line_column(p.lo);
    format!("{line}:{column} {}", d.code)
}

fn read(text: &str) -> Outcome {
    read_files(&[("m.gms", text)], &[])
}

fn statements(text: &str) -> Vec<Stmt> {
    let out = read(text);
    assert_eq!(out.errors, Vec::<String>::new(), "in {text}");
    out.statements
}

fn list(items: &[Expr]) -> String {
    items.iter().map(show).collect::<Vec<_>>().join(",")
}

/// An expression with every operation in parentheses.
fn show(e: &Expr) -> String {
    match &e.kind {
        ExprKind::Number(x) => x.to_string(),
        ExprKind::Membership(yes) => if *yes { "yes" } else { "no" }.to_string(),
        ExprKind::Text(t) => format!("'{t}'"),
        ExprKind::Apply(name, attribute, arguments) => {
            let a = attribute
                .as_ref()
                .map_or(String::new(), |a| format!(".{}", a.name));
            let b = arguments
                .as_ref()
                .map_or(String::new(), |b| format!("[{}]", list(b)));
            format!("{}{a}{b}", name.name)
        }
        ExprKind::Unary(op, x) => {
            let op = match op {
                UnaryOp::Minus => "-",
                UnaryOp::Plus => "+",
                UnaryOp::Not => "not ",
            };
            format!("({op}{})", show(x))
        }
        ExprKind::Binary(op, a, b) => format!("({} {op:?} {})", show(a), show(b)),
        ExprKind::Sum(terms) => {
            let t = terms
                .iter()
                .map(|(s, e)| format!("{}{}", if *s { "-" } else { "+" }, show(e)));
            format!("({})", t.collect::<String>())
        }
        ExprKind::Product(factors) => {
            let t = factors
                .iter()
                .map(|(s, e)| format!("{}{}", if *s { "/" } else { "*" }, show(e)));
            format!("({})", t.collect::<String>())
        }
        ExprKind::Dollar(a, b) => format!("({}${})", show(a), show(b)),
        ExprKind::Aggregate(op, d, e) => format!("{op:?}({}: {})", domain(d), show(e)),
    }
}

fn domain(d: &Domain) -> String {
    let items: Vec<String> = d
        .items
        .iter()
        .map(|i| {
            format!(
                "{}{}",
                i.set.name,
                i.indices
                    .as_ref()
                    .map_or(String::new(), |x| format!("[{}]", list(x)))
            )
        })
        .collect();
    format!(
        "{}{}",
        items.join(","),
        d.condition
            .as_ref()
            .map_or(String::new(), |c| format!(" | {}", show(c)))
    )
}

fn expression(text: &str) -> String {
    match &statements(&format!("a = {text};"))[0].kind {
        StmtKind::Assign(a) => show(&a.value),
        other => panic!("{other:?}"),
    }
}

fn errors(text: &str) -> Vec<String> {
    read(text).errors
}

#[test]
fn precedence() {
    for (text, tree) in [
        ("1+2*3", "(+1+(2 Multiply 3))"),
        ("-2**2", "(-(2 Power 2))"),
        ("2**3**2", "((2 Power 3) Power 2)"),
        ("-a*b", "((-a) Multiply b)"),
        ("a-b-c+d", "(+a-b-c+d)"),
        ("a*b/c*d", "(*a*b/c*d)"),
        ("a/b", "(a Divide b)"),
        ("(a+b)+c", "(+(+a+b)+c)"),
        ("2*3$0+1", "(+(2 Multiply (3$0))+1)"),
        ("2**3$0", "(2 Power (3$0))"),
        ("a$b$c", "((a$b)$c)"),
        ("not a+b = c", "(not ((+a+b) Eq c))"),
        ("not a and b or c", "(((not a) And b) Or c)"),
        ("not -1", "(not (-1))"),
        ("a or b xor c", "((a Or b) Xor c)"),
        ("a -> b <=> c", "((a Implies b) Equivalent c)"),
        ("a > -1", "(a Gt (-1))"),
        ("a ge b and c lt d", "((a Ge b) And (c Lt d))"),
        ("x.l('a',i+1)", "x.l['a',(+i+1)]"),
        ("p(i--1,j++k)", "p[(i CircularMinus 1),(j CircularPlus k)]"),
        (
            "sum((i,j)$(a(i) > 2), b(i,j))",
            "Sum(i,j | (a[i] Gt 2): b[i,j])",
        ),
        ("sum{i$a[i], 2}", "Sum(i | a[i]: 2)"),
        ("prod(arc(i,'b')$c, 1)", "Prod(arc[i,'b'] | c: 1)"),
        ("smax((arc(i,j),k), 1)", "Smax(arc[i,j],k: 1)"),
        ("summer(i) + sums", "(+summer[i]+sums)"),
        ("1.5e-3 + .5 + 5. + 1E+3", "(+0.0015+0.5+5+1000)"),
        ("inf - yes + no", "(+inf-yes+no)"),
        ("m.modelstat + i.val", "(+m.modelstat+i.val)"),
        (
            "p('a b')$(not sameas(i,\"it's\"))",
            "(p['a b']$(not sameas[i,'it's']))",
        ),
        ("pi + uniform(0,1)", "(+pi+uniform[0,1])"),
        ("a eq b", "(a Eq b)"),
        ("eq + 1", "(+eq+1)"),
    ] {
        assert_eq!(expression(text), tree, "{text}");
    }
}

#[test]
fn operators_in_a_row_and_chains() {
    for text in [
        "2**-1",
        "2*-1",
        "2 - -1",
        "- -3",
        "- not 1",
        "not not 1",
        "1 + +2",
        "a$-1",
        "a$not b",
    ] {
        let found = errors(&format!("a = {text};"));
        assert_eq!(found.len(), 1, "{text}: {found:?}");
        assert!(found[0].ends_with("E0212"), "{text}: {found:?}");
    }
    for text in ["1<2<3", "2=2=2", "a < b <= c"] {
        assert_eq!(errors(&format!("a = {text};")).len(), 1, "{text}");
    }
}

#[test]
fn equations_and_assignments() {
    let s = statements(
        "e(i,'a')$(ord(i)>1).. x(i) + 2 =L= sum(j, y(j));\nx.up(i)$a(i) = 3; s $= 4; s := 5; e.. x =e= 1",
    );
    match &s[0].kind {
        StmtKind::Equate(e) => {
            assert_eq!((&*e.name.name, e.relation), ("e", Relation::Less));
            assert_eq!(list(&e.indices), "i,'a'");
            assert_eq!(show(e.condition.as_ref().unwrap()), "(ord[i] Gt 1)");
            assert_eq!(show(&e.right), "Sum(j: y[j])");
        }
        other => panic!("{other:?}"),
    }
    match &s[1].kind {
        StmtKind::Assign(a) => assert_eq!(&*a.target.attribute.as_ref().unwrap().name, "up"),
        other => panic!("{other:?}"),
    }
    match &s[2].kind {
        StmtKind::Assign(a) => assert!(a.nonzero && show(&a.value) == "4"),
        other => panic!("{other:?}"),
    }
    assert_eq!(s.len(), 5);
}

#[test]
fn long_chains_and_deep_nesting() {
    let sum = vec!["x"; 100_000].join(" + ");
    match &statements(&format!("e.. {sum} =e= 3;"))[0].kind {
        StmtKind::Equate(e) => match &e.left.kind {
            ExprKind::Sum(terms) => assert_eq!(terms.len(), 100_000),
            other => panic!("{other:?}"),
        },
        other => panic!("{other:?}"),
    }
    let deep = format!("a = {}1{};", "(".repeat(200), ")".repeat(200));
    assert_eq!(errors(&deep), Vec::<String>::new());
    let deeper = format!(
        "a = {}1{};\nb = ;",
        "(".repeat(100_000),
        ")".repeat(100_000)
    );
    assert_eq!(errors(&deeper), ["1:255 E0204", "2:3 E0210"]);
    let chain = vec!["x"; 5_000].join(" or ");
    assert!(errors(&format!("a = {chain};"))[0].ends_with("E0204"));
    let powers = vec!["x"; 5_000].join("**");
    assert!(errors(&format!("a = {powers};"))[0].ends_with("E0204"));
    let dollars = vec!["x"; 5_000].join("$");
    assert!(errors(&format!("a = {dollars};"))[0].ends_with("E0204"));
}

fn text_of<'a>(out: &'a Parser<'_>, d: &SymbolDecl) -> &'a str {
    d.data.map_or("", |s| out.text(s).trim())
}

/// Names, domains, texts and data of all declarations of a text.
fn declared(text: &str) -> Vec<String> {
    let files = BTreeMap::from([("m.gms".to_owned(), text.to_owned())]);
    let mut host = Memory::new(files, None);
    let mut parser =
        Parser::new(&mut host, "m.gms", PreprocessOptions::default()).expect("the file is there");
    let mut found = Vec::new();
    while let Some(s) = parser
        .next(&NothingKnown)
        .unwrap_or_else(|e| panic!("{e:?} in {text}"))
    {
        let symbols: Vec<SymbolDecl> = match s.kind {
            StmtKind::Set(l) => l.into_iter().map(|d| d.symbol).collect(),
            StmtKind::Parameter(l) => l.into_iter().map(|d| d.symbol).collect(),
            StmtKind::Variable(_, l) | StmtKind::Equation(l) | StmtKind::Acronym(l) => l,
            StmtKind::Table(t) => t.symbols,
            _ => vec![],
        };
        for d in symbols {
            let over: Vec<String> = d
                .domain
                .iter()
                .flatten()
                .map(|n| format!("{}{}", n.name.name, if n.defines { "<" } else { "" }))
                .collect();
            found.push(format!(
                "{}({}) [{}] /{}/",
                d.name.name,
                over.join(","),
                d.text.as_deref().unwrap_or(""),
                text_of(&parser, &d)
            ));
        }
    }
    found
}

#[test]
fn declarations_with_texts() {
    let found = declared(
        "Sets i  canning plants / seattle, san-diego /\n j(*)  'markets' / a, b / , k;\n\
         Scalar x producer's cost (in $ per ton) /3/, y \"it's\" /4/\n  z /5/, w /6/;\n\
         parameters a(i)  (in tons) = text. /seattle 1/\n\n b(i,j)\n  /seattle.a 2/\n c(i<,*) -one\n;\n\
         variables x1, x2 second one\n x3(i) /seattle.l 3/; positive variable x1;\n\
         equation e text of e, f(i) ;\n set k2 /a people's republic, b 'x / y' \n c/ ",
    );
    assert_eq!(
        found,
        [
            "i() [canning plants] /seattle, san-diego/",
            "j(*) [markets] /a, b/",
            "k() [] //",
            "x() [producer's cost (in $ per ton)] /3/",
            "y() [it's] /4/",
            "z() [] /5/",
            "w() [] /6/",
            "a(i) [(in tons) = text.] /seattle 1/",
            "b(i,j) [] /seattle.a 2/",
            "c(i<,*) [-one] //",
            "x1() [] //",
            "x2() [second one] //",
            "x3(i) [] /seattle.l 3/",
            "x1() [] //",
            "e() [text of e] //",
            "f(i) [] //",
            "k2() [] /a people's republic, b 'x / y' \n c/",
        ]
    );
}

#[test]
fn tables_end_at_a_semicolon_or_a_keyword() {
    let found = declared(
        "table e(i) none; table n(i), t(i,j) cost in $/ton\n   a b\nset 1 2\nx 3 4\nscalar s /1/;\n\
         table u(*,*) 'text'\n  'a;b'\nx 1;\nTable\n v(*,*)\n a\nb 1\n;",
    );
    assert_eq!(
        found,
        [
            "e(i) [none] //",
            "n(i) [] //",
            "t(i,j) [cost in $/ton] /a b\nset 1 2\nx 3 4/",
            "s() [] /1/",
            "u(*,*) [text] /'a;b'\nx 1/",
            "v(*,*) [] /a\nb 1/",
        ]
    );
}

#[test]
fn a_keyword_ends_a_statement() {
    let s = statements(
        "set i /a/ parameter b /1/;\nb = 5 display b\nif(b, b = 1 display b; b = 2) solve m using lp min z\noption limrow=0 limcol = 3",
    );
    let kinds: Vec<&str> = s
        .iter()
        .map(|s| match s.kind {
            StmtKind::Set(_) => "set",
            StmtKind::Parameter(_) => "parameter",
            StmtKind::Assign(_) => "assign",
            StmtKind::Display(..) => "display",
            StmtKind::If(..) => "if",
            StmtKind::Solve(_) => "solve",
            StmtKind::Option(_) => "option",
            _ => "other",
        })
        .collect();
    assert_eq!(
        kinds,
        [
            "set",
            "parameter",
            "assign",
            "display",
            "if",
            "solve",
            "option"
        ]
    );
    match &s[4].kind {
        StmtKind::If(branches, _) => assert_eq!(branches[0].1.len(), 3),
        other => panic!("{other:?}"),
    }
}

#[test]
fn blocks() {
    let s = statements(
        "loop((i,j)$a(i), x = 1; loop(k, y = 2;); if(x > 1, y = 1; elseif x, y = 2; else y = 3;););\n\
         while(x < 3, x = x + 1);\nfor(k = 10 downto 1 by 2, y = k; break$(y = 3); continue;);\n\
         repeat(x = x + 1; until x > 3;);\nif((x = 1), put 'a' / else display x);",
    );
    assert_eq!(s.len(), 5);
    match &s[0].kind {
        StmtKind::Loop(d, body) => {
            assert_eq!(domain(d), "i,j | a[i]");
            assert_eq!(body.len(), 3);
            match &body[2].kind {
                StmtKind::If(b, e) => assert_eq!((b.len(), e.len()), (2, 1)),
                other => panic!("{other:?}"),
            }
        }
        other => panic!("{other:?}"),
    }
    let s = statements("loop(i, loop(j, if(x, break$(n = 2) 2; else break;)));");
    assert!(format!("{:?}", s[0].kind).contains("Break(2)"));
    let s = statements(
        "$onEnd\nif x then y = 1; else y = 2; endif;\nloop i do y = 1; endloop;\nwhile y < 3 do y = 3; endwhile; for y = 1 to 3 do x = 1; endfor\nrepeat x = x + 1; until x > 3;",
    );
    assert_eq!(s.len(), 5);
}

#[test]
fn other_statements() {
    let s = statements(
        "model m 'text' / all, - e2, f.x, (g|h).y, e3(sub) /, m2 / m1 + a /; alias (i,j,k), (l,m);\n\
         solve m maximizing z using nlp; display$(x > 1) 'a', x.l y;\nabort.noerror 'x'; file f 'text' / 'out.txt' /, g;\n\
         put f 'a' x.l('b'):10:4 / @5 (a+b):<8 #3 i.tl:0; putclose; execute_unload 'a.gdx', x, y = z;\n\
         option a:3:0:1, lp = conopt, r(i) < s, seed = -1, dmpSym; acronym mon 'Monday', tue;\n\
         figure w 'the wall' { polygon(b,v)$c(b) x = p(b), fill = 3; title 'a = %8.5f', alpha.l; }; draw w 'a.svg';\n\
         figure(i) = 3; draw = 4; break = 2;",
    );
    let name = |s: &Stmt| {
        format!("{:?}", s.kind)
            .split(['(', ' ', '{'])
            .next()
            .unwrap_or("")
            .to_owned()
    };
    assert_eq!(
        s.iter().map(name).collect::<Vec<_>>(),
        [
            "Model", "Alias", "Solve", "If", "Abort", "File", "Put", "Put", "Exchange", "Option",
            "Acronym", "Figure", "Draw", "Assign", "Assign", "Assign"
        ]
    );
    match &s[0].kind {
        StmtKind::Model(list) => {
            let items = list[0].items.as_ref().unwrap();
            assert!(
                matches!(items[0], ModelItem::All(_)) && matches!(items[1], ModelItem::Remove(_))
            );
            assert!(matches!(&items[3], ModelItem::Pair { rows, .. } if rows.len() == 2));
            assert!(matches!(&items[4], ModelItem::Limit(_, over) if over.len() == 1));
        }
        other => panic!("{other:?}"),
    }
    match &s[6].kind {
        StmtKind::Put(_, items) => assert_eq!(items.len(), 8),
        other => panic!("{other:?}"),
    }
}

#[test]
fn directives_shape_the_text() {
    let out = read_files(
        &[
            (
                "m.gms",
                "$title A model\n$set n 3\n$eval m %n%**2\n$ontext\n; ' anything\n$offtext\na%n% = %m%;\n\
                 $offlisting offsymxref\n$if set n $log set %n%\n$ifThen.x %n% == 4\nb = 1;\n$elseIf.x %n% == 3\nb = 2;\n\
                 $else.x\nb = 3;\n$endIf.x\n$macro sq(x) ((x)*(x))\nc = sq(2+1);\n$include inc.gms\n$batInclude bat.gms one 'two three'\n\
                 $goto end\nd = 5;\n$label end\n$eolCom !!\ne = 1; !! comment ' with quote\n$inlineCom { }\nf = { one ; two } 2;\n\
                 $log %nothing% %inner%.\n$exit\ng = 3;",
            ),
            ("inc.gms", "$set inner 7\ni = %inner%;"),
            ("bat.gms", "* %1\n$setArgs a b\nj = '%1' + '%b%';"),
        ],
        &[],
    );
    assert_eq!(out.errors, Vec::<String>::new());
    assert_eq!(out.log, ["set 3\n", "%nothing% %inner%.\n"]);
    let shown: Vec<String> = out
        .statements
        .iter()
        .filter_map(|s| match &s.kind {
            StmtKind::Assign(a) => Some(format!("{}={}", a.target.name.name, show(&a.value))),
            _ => None,
        })
        .collect();
    assert_eq!(shown[0], "a3=9");
    assert_eq!(
        &shown[shown.len() - 6..],
        [
            "b=2",
            "c=((+2+1) Multiply (+2+1))",
            "i=7",
            "j=(+'one'+'two three')",
            "e=1",
            "f=2"
        ]
    );
}

#[test]
fn files_that_are_not_as_they_should_be() {
    assert_eq!(
        read_files(
            &[
                ("a.gms", "$include b.gms\nx = ;"),
                ("b.gms", "$include a.gms\n")
            ],
            &[]
        )
        .errors,
        ["1:1 E0105", "2:3 E0210"]
    );
    assert_eq!(errors("$include nowhere.gms\n"), ["1:1 E0103"]);
    assert_eq!(errors("$ifThen 1 == 1\na = 1;\n"), ["1:1 E0106"]);
    assert_eq!(errors("a = 1;\n$endif\n"), ["2:1 E0106"]);
    assert_eq!(errors("$ontext\na = 1;\n"), ["1:1 E0101"]);
    assert_eq!(errors("$label x\n$goto x\n"), ["2:1 E0116"]);
    assert_eq!(errors("$offlistin\n"), ["1:1 E0107"]);
    assert_eq!(errors("$call ls\n"), ["1:1 E0113"]);
    assert_eq!(errors("$if a b c\n"), ["1:1 E0114"]);
    assert_eq!(errors("$eval x 1 +\n"), ["1:1 E0115"]);
    assert_eq!(errors("$macro a b\n$macro b a\nx = a;\n"), ["3:5 E0111"]);
    let out = read("$abort 'stop here'\nx = ;");
    assert_eq!(
        (out.errors, out.ending),
        (vec!["1:1 E0110".to_owned()], Ending::Aborted)
    );
    assert_eq!(read("$terminate\nx = ;").ending, Ending::NoRun);
    assert!(read("").statements.is_empty());
}

#[test]
fn doubled_dollars_may_be_indented() {
    let s = statements(
        "   $$set n 5\nif(a,\n   $$ifThen not set n\n   a = ;\n   $$else\n  a = %n%;\n   $$endIf\n);",
    );
    assert_eq!(s.len(), 1);
    assert!(matches!(&s[0].kind, StmtKind::If(b, _) if b[0].1.len() == 1));
}

#[test]
fn defines_and_slashes() {
    let out = read_files(
        &[(
            "m.blk",
            "x = %N%; // comment: don't\n// whole line\ny = 'a//b';",
        )],
        &[("n", "5")],
    );
    assert_eq!(out.errors, Vec::<String>::new());
    assert_eq!(out.statements.len(), 2);
    assert_eq!(errors("x = 3; // no comment\n"), ["1:8 E0230"]);
    assert_eq!(statements("$ifThen set BMOD\nx = %BMOD%;\n$endIf").len(), 1);
}

#[test]
fn echoed_files_and_put_blocks() {
    let s = statements(
        "$onEcho > 'data.inc'\nx = 1;\n$offEcho\n$include data.inc\n$onPut\nit's \"text\"\n\n$offPut\n",
    );
    assert_eq!(s.len(), 3);
    assert!(
        matches!(&s[1].kind, StmtKind::Put(_, items) if items.len() == 4),
        "{:?}",
        s[1].kind
    );
}

#[test]
fn compile_time_data() {
    let s = statements("set i\n$gdxin data.csv\n$load i x=y\n$gdxin\n$kill x y\nz = 3;");
    assert!(
        matches!(&s[1].kind, StmtKind::Exchange(e) if e.file.as_ref().is_some_and(|f| &*f.0 == "data.csv"))
    );
    assert!(
        matches!(&s[2].kind, StmtKind::Exchange(e) if e.items.len() == 2 && e.items[1].other.is_some())
    );
    assert!(matches!(&s[4].kind, StmtKind::Clear { kill: true, names } if names.len() == 2));
    assert_eq!(s.len(), 6);
}

#[test]
fn slips_are_named() {
    let out =
        read("variable x >= 0;  set k int: 1..4 = K;  set d 'those with i-j=k, k=-6..6' / 1*3 /;");
    assert_eq!(out.warnings, ["1:10 E0234", "1:23 E0234"]);
    for (text, found) in [
        ("a = 5\nb = 6;\nc = 7", "1:5 E0201"),
        ("equations e1\n e2\ne1.. x =e= 1;", "2:3 E0201"),
        ("a = (b + 3;", "1:5 E0202"),
        ("a = b + 3);", "1:10 E0207"),
        ("loop(i, a = 3;\nset j /1/;", "1:5 E0202"),
        ("loop(i, a = 3\nb = 4;\n);", "1:13 E0201"),
        ("parameter p /a 1;\nb = 2;", "1:13 E0203"),
        ("scalar set /1/;", "1:8 E0205"),
        ("a = 'text;", "1:5 E0206"),
        ("a = %foo% + 1;", "1:5 E0208"),
        ("a = 1d3;", "1:5 E0209"),
        ("a = b ≤ 3;", "1:7 E0209"),
        ("scalar q = 5;", "1:10 E0220"),
        ("e a =e= 3;", "1:1 E0221"),
        ("e: a =l= 3;", "1:2 E0221"),
        ("e.. a <= 3;", "1:7 E0222"),
        ("e.. a = 3;", "1:7 E0222"),
        ("e.. a;", "1:5 E0222"),
        ("a == 3;", "1:3 E0232"),
        ("a = b && c;", "1:7 E0232"),
        ("a = b^2;", "1:6 E0232"),
        ("# comment\na = 3;", "1:1 E0230"),
        ("subject to c1: a >= 3;", "1:1 E0231"),
        ("var x >= 0;", "1:1 E0231"),
        ("param n := 5;", "1:1 E0231"),
        ("for i in s: a = 3;", "1:1 E0231"),
        ("minimize z: a;", "1:1 E0231"),
        ("def f(x):\n  return x\n;", "1:1 E0231"),
        ("solve m minimizing z;", "1:1 E0218"),
        ("e.. a =x= 3;", "1:7 E0216"),
    ] {
        assert_eq!(errors(text), [found], "{text}");
    }
}
