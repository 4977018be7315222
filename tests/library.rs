//! The library as a program uses it.

use bmod::{Control, Error, Model, ModelStatus, Options, RunStatus, Special, SymbolKind};
use std::path::Path;

const SHOP: &str = "
Set i 'goods' / a 'first', b /;
Alias(i, ii);
Parameter price(i) / a 3, b 5 /, seen(i,ii);
Scalar room / 6 /, loss / eps /, none / na /;
Positive variable x(i) 'made';  Variable z;
Equations value, most(i), limit;
value..    z =e= sum(i, price(i)*x(i));
most(i)..  x(i) =l= 4;
limit..    sum(i, x(i)) =l= room;
x.up('a') = 9;
seen(i,ii)$(ord(i) < ord(ii)) = 1;
Model shop / all /;
solve shop using lp maximizing z;
display x.l;
File f / 'out.txt' /;  put f 'z = ' z.l:0:1;
Figure g { line(i)  x = ord(i), y = x.l(i); };
draw g;
";

fn run(model: &Model) -> bmod::Run {
    model.run(&Options::default())
}

#[test]
fn answers_by_name() {
    let run = run(&Model::from_text("shop.blk", SHOP));
    assert_eq!(run.messages(), "");
    assert_eq!(run.status(), RunStatus::Ok);
    let solve = &run.solves()[0];
    assert_eq!(solve.model, "shop");
    assert_eq!(solve.model_status, ModelStatus::Optimal);
    assert_eq!(solve.objective_variable.as_deref(), Some("z"));
    assert_eq!(solve.objective, Some(26.0));
    assert!(solve.residuals.primal.is_some_and(|r| r < 1e-9));
    assert_eq!(run.level("X", ["B"]), Ok(4.0));
    assert_eq!(run.marginal("limit", []), Ok(3.0));
    assert_eq!(run.marginal("most", "b"), Ok(2.0));
    assert_eq!(run.upper("x", "a"), Ok(9.0));
    assert_eq!(run.upper("x", "b"), Ok(f64::INFINITY));
    assert_eq!(run.value("price", "a"), Ok(3.0));
    assert_eq!(run.value("seen", ("a", "b")), Ok(1.0));
    assert_eq!(run.value("seen", ["b", "a"]), Ok(0.0));
    assert_eq!(run.value("loss", ()), Ok(0.0));
    assert!(run.value("none", []).is_ok_and(f64::is_nan));
    let special = |name| run.symbol(name).ok()?.records().next()?.special;
    assert_eq!(special("loss"), Some(Special::Eps));
    assert_eq!(special("none"), Some(Special::NotAvailable));
    assert_eq!(special("room"), None);

    let goods = run.symbol("i").expect("a set");
    let members: Vec<_> = goods.records().map(|r| (r.labels[0], r.text)).collect();
    assert_eq!(members, [("a", "first"), ("b", "")]);
    let alias = run.symbol("ii").expect("an alias");
    assert_eq!(alias.alias_of(), Some("i"));
    assert_eq!(alias.records().count(), 2);
    let x = run.symbol("x").expect("a variable");
    assert_eq!(
        (x.kind(), x.text(), x.domain()),
        (SymbolKind::Variable, "made", &["i".to_string()][..])
    );
    let levels: Vec<_> = x
        .variable_records()
        .map(|r| (r.labels[0], r.level, r.upper))
        .collect();
    assert_eq!(levels, [("a", 2.0, 9.0), ("b", 4.0, f64::INFINITY)]);
    let names: Vec<_> = run.symbols().map(|s| s.name()).take(3).collect();
    assert_eq!(names, ["i", "ii", "price"]);
}

#[test]
fn output_stays_in_memory() {
    let run = run(&Model::from_text("shop.blk", SHOP));
    let names: Vec<_> = run.files().iter().map(|f| &*f.name).collect();
    assert_eq!(names, ["g.svg", "out.txt"]);
    assert_eq!(run.files()[1].text().map(str::trim), Some("z = 26.0"));
    let (name, svg) = run.figures().next().expect("a figure");
    assert_eq!(name, "g.svg");
    assert!(svg.starts_with("<svg"));
    assert!(run.printed().contains("VARIABLE x.L"));
    assert_eq!(run.displays().len(), 1);
    assert!(run.to_json().contains("\"objective\": 26.0"));
    assert_eq!(run.solution_json(), None);
    assert!(!Path::new("out.txt").exists());
}

#[test]
fn errors_are_values() {
    let run = run(&Model::from_text("shop.blk", SHOP));
    let similar = |e: Result<f64, Error>| match e {
        Err(Error::UnknownSymbol { similar, .. } | Error::UnknownLabel { similar, .. }) => similar,
        other => panic!("{other:?}"),
    };
    assert_eq!(similar(run.level("lmit", [])).as_deref(), Some("limit"));
    let wrong = run.level("price", "a").expect_err("a parameter");
    assert_eq!(wrong.to_string(), "`price` is a parameter; it has no level");
    let wrong = run.level("x", ["a", "b"]).expect_err("two labels");
    assert_eq!(wrong.to_string(), "`x` has 1 indices, 2 labels were given");
    let wrong = run.level("x", "elsewhere").expect_err("no such label");
    assert_eq!(wrong.to_string(), "the model has no label `elsewhere`");
    assert!(matches!(
        Model::from_file("no/such.blk"),
        Err(Error::File { .. })
    ));
    let broken = Model::from_text("m.blk", "Scalar a / 1 /;\na = b;");
    let Err(Error::Model { diagnostics, .. }) = broken.run(&Options::default()).ok() else {
        panic!("there is no b");
    };
    let place = diagnostics[0].place.as_ref().expect("a place");
    assert_eq!((&*place.file, place.line, place.column), ("m.blk", 2, 5));
    assert_eq!((place.start, place.end), (20, 21));
}

#[test]
fn data_from_outside() {
    let mut model = Model::from_text("shop.blk", SHOP);
    model.set_scalar("Room", 3.0);
    assert_eq!(run(&model).level("z", []), Ok(15.0));
    model.set_members_with_texts("i", [("b", "only".to_string()), ("c", String::new())]);
    model.set_parameter("price", [("c", 7.0)]);
    let text = SHOP.replace("x.up('a') = 9;", "");
    let mut changed = model.clone();
    changed.file("shop.blk", text);
    let answer = run(&changed);
    assert_eq!(answer.messages(), "");
    assert_eq!(answer.level("x", "c"), Ok(3.0));
    let member = answer.symbol("i").expect("a set").records().next();
    assert_eq!(member.map(|r| (r.labels[0], r.text)), Some(("b", "only")));
    changed.forget("i").forget("price").forget("room");
    assert_eq!(run(&changed).level("z", []), Ok(26.0));
}

#[test]
fn data_from_outside_are_checked() {
    let say = |change: &dyn Fn(&mut Model)| {
        let mut model = Model::from_text("shop.blk", SHOP);
        change(&mut model);
        let run = run(&model);
        assert_eq!(run.status(), RunStatus::CompilationError);
        let d = &run.diagnostics()[0];
        let line = d.place.as_ref().map_or(0, |p| p.line);
        format!(
            "{line} {} {} {:?}",
            d.code,
            d.message,
            d.help.as_deref().unwrap_or("")
        )
    };
    let cases: [&dyn Fn(&mut Model); 6] = [
        &|m| {
            m.set_parameter("price", [("c", 1.0)]);
        },
        &|m| {
            m.set_parameter("price", [(["a", "b"], 1.0)]);
        },
        &|m| {
            m.set_parameter("prise", [("a", 1.0)]);
        },
        &|m| {
            m.set_scalar("x", 1.0);
        },
        &|m| {
            m.set_scalar("i", 1.0);
        },
        &|m| {
            m.set_members("i", ["b"]);
        },
    ];
    let said: Vec<String> = cases.iter().map(|c| say(c)).collect();
    insta::assert_snapshot!(said.join("\n"));
}

#[test]
fn includes_from_memory() {
    let mut model = Model::from_text(
        "main/m.blk",
        "$include data/sizes.inc\nScalar y; y = %twice%*n;",
    );
    model
        .file("main/data/sizes.inc", "$include more.inc")
        .define("twice", 2);
    model.resolver(|name| {
        name.ends_with("more.inc")
            .then(|| "Scalar n / 21 /;".to_string())
    });
    let run = run(&model);
    assert_eq!(run.messages(), "");
    assert_eq!(run.value("y", []), Ok(42.0));
    let missing = Model::from_text("m.blk", "$include none.inc").check();
    assert_eq!(missing.diagnostics()[0].code, "E0103");
}

#[test]
fn checks_without_running() {
    let run = Model::from_text("shop.blk", SHOP).check();
    assert_eq!((run.status(), run.solves().len()), (RunStatus::Ok, 0));
    assert_eq!(run.value("price", "b"), Ok(5.0));
    assert_eq!(run.symbol("price").map(|s| s.records().len()), Ok(2));
}

#[test]
fn limits_and_cancelling() {
    let model = Model::from_text("m.blk", "Scalar n / 0 /;  while(1, n = n + 1);");
    let run = model.run(&Options::default().time_limit(0.2));
    assert!(run.was_stopped());
    assert_eq!(run.diagnostics()[0].code, "E0490");
    assert!(run.value("n", []).is_ok_and(|n| n > 0.0));
    let control = Control::new();
    control.cancel();
    let run = model.run(&Options::default().control(&control));
    assert!(run.was_stopped() && control.is_cancelled());
}

#[test]
fn a_folder_of_files() {
    let wall = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/wall.blk");
    let control = Control::new();
    let model = Model::from_file(&wall).expect("the flagship");
    let run = model.run(&Options::default().control(&control));
    assert_eq!(run.messages(), "");
    assert!(
        run.level("alpha", [])
            .is_ok_and(|a| (a - 0.642_859_003).abs() < 1e-8)
    );
    assert!(run.figures().any(|(name, _)| name == "wall.svg"));
    assert!(control.progress().message.contains("kinematic"));
}
