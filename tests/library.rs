//! The library as a program uses it.

use bmod::{Control, Error, Model, ModelStatus, Options, RunStatus, Special, SymbolKind};
use std::path::Path;
use std::sync::{Arc, Mutex};

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
    assert_eq!(run.status(), RunStatus::Interrupted);
    assert_eq!(run.diagnostics()[0].code, "E0492");
}

#[test]
fn who_waits_is_told_before_a_solver_begins() {
    let text = "set i / 1*300 /; alias(i, j); parameter p(i,j); p(i,j) = ord(i)*ord(j); variable x(i,j), z; equation e(i,j), o;
                e(i,j).. x(i,j) =g= p(i,j); o.. z =e= sum((i,j), x(i,j)); model m / all /; solve m using lp minimizing z;";
    let told = Arc::new(Mutex::new(Vec::new()));
    let heard = told.clone();
    let options = Options::default().list(1).on_progress(move |message| {
        heard.lock().expect("one thread").push(message.to_string());
    });
    Model::from_text("m.blk", text).run(&options);
    let told = told.lock().expect("one thread");
    assert_eq!(told[0], "running statements");
    assert!(
        told.iter().filter(|t| *t == "generating m").count() > 1,
        "{told:?}"
    );
}

#[test]
fn a_folder_of_files() {
    let wall = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/wall.blk");
    let told = Arc::new(Mutex::new(String::new()));
    let heard = told.clone();
    let options =
        Options::default().on_progress(move |m| heard.lock().expect("one thread").push_str(m));
    let model = Model::from_file(&wall).expect("the flagship");
    let run = model.run(&options);
    assert_eq!(run.messages(), "");
    assert!(
        run.level("alpha", [])
            .is_ok_and(|a| (a - 0.642_859_003).abs() < 1e-8)
    );
    assert!(run.figures().any(|(name, _)| name == "wall.svg"));
    assert!(told.lock().expect("one thread").contains("kinematic"));
}

/// Texts of data that make a difference while the text is read.
const ASKING: &str =
    "Set i / a /;  Scalar n / 2 /;\n$eval m card(i)\n$eval k n\nScalar y, z;  y = %m%;  z = %k%;";

#[test]
fn what_is_kept_changes_no_answer() {
    let mut kept = Model::from_text("shop.blk", SHOP);
    kept.keep(true);
    let mut fresh = Model::from_text("shop.blk", SHOP);
    for k in 0..6 {
        let give = |m: &mut Model| match k {
            1 => drop(m.set_scalar("room", 7.0)),
            2 => drop(m.set_parameter("price", [("b", 1.0), ("a", 4.0)])),
            3 => drop(m.set_parameter("price", [("a", 2.0)])),
            4 => drop(m.set_members("i", ["a", "b", "c"])),
            5 => drop(m.set_parameter("price", [("c", 9.0)])),
            _ => {}
        };
        give(&mut kept);
        give(&mut fresh);
        let (a, b) = (run(&kept), run(&fresh));
        assert_eq!(a.messages(), b.messages());
        assert_eq!(a.solves()[0].objective, b.solves()[0].objective, "{k}");
        for name in ["i", "price", "seen"] {
            let columns = |r: &bmod::Run| r.symbol(name).expect("declared").columns();
            assert_eq!(columns(&a), columns(&b), "{k}: {name}");
        }
        // Where goods have no price their amounts are not unique.
        assert!(matches!(k, 3 | 5) || a.files() == b.files(), "{k}");
    }
    // A label that is not there is found out, and the next run is right again.
    kept.set_parameter("price", [("d", 1.0)]);
    assert!(run(&kept).messages().contains("`d` is not a member of `i`"));
    kept.set_parameter("price", [("c", 9.0)]);
    assert_eq!(
        run(&kept).solves()[0].objective,
        run(&fresh).solves()[0].objective
    );
}

#[test]
fn a_text_that_asks_for_data_is_compiled_again() {
    let mut model = Model::from_text("m.blk", ASKING);
    model.keep(true);
    let values = |m: &Model| {
        let r = run(m);
        (r.value("y", []).expect("y"), r.value("z", []).expect("z"))
    };
    assert_eq!(values(&model), (1.0, 2.0));
    model.set_scalar("n", 5.0);
    assert_eq!(values(&model), (1.0, 5.0));
    model.set_scalar("n", 6.0);
    model.set_members("i", ["x", "y"]);
    assert_eq!(values(&model), (2.0, 6.0));

    // So is one whose files change.
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("m.blk");
    let write =
        |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    write(
        "m.blk",
        "$include n.inc\n$if exist more.inc $include more.inc\nScalar y;  y = n;",
    );
    write("n.inc", "Scalar n / 1 /;");
    let mut model = Model::from_file(&path).expect("there");
    model.keep(true);
    let y = |m: &Model| run(m).value("y", []).expect("y");
    assert_eq!((y(&model), y(&model)), (1.0, 1.0));
    let digest = model.digest(&Options::default(), &[]);
    write("n.inc", "Scalar n / 2 /;");
    assert_eq!(y(&model), 2.0);
    assert_ne!(model.digest(&Options::default(), &[]), digest);
    write("more.inc", "n = 3;");
    assert_eq!(y(&model), 3.0);
}

#[test]
fn the_next_solve_starts_at_the_last_basis() {
    // An assignment of 20 to 20 with costs that differ everywhere.
    let text = "Set i / 1*20 /;  Alias(i, j);  Parameter c(i,j), need(j);
        c(i,j) = 1 + mod(ord(i)*37 + ord(j)*ord(j)*11, 101)/10;  need(j) = 1;  Scalar shift / 0 /;
        Positive variable x(i,j);  Variable z;  Equations cost, row(i), column(j);
        cost..  z =e= sum((i,j), c(i,j)*x(i,j));
        row(i)..  sum(j, x(i,j)) =l= 1.5 + shift;  column(j)..  sum(i, x(i,j)) =g= need(j);
        Model m / all /;  %more% solve m using lp minimizing z;";
    let mut model = Model::from_text("m.blk", text);
    model.define("more", "").keep(true);
    let first = run(&model);
    let again = run(&model);
    let iterations = |r: &bmod::Run| r.solves()[0].iterations;
    assert!(iterations(&first) > 15 && iterations(&again) == 0);
    assert_eq!(first.solves()[0].objective, again.solves()[0].objective);
    model.set_scalar("shift", 0.01);
    let moved = run(&model);
    assert!(
        iterations(&moved) < iterations(&first) / 2,
        "{}",
        iterations(&moved)
    );
    let mut fresh = model.clone();
    fresh.keep(false);
    let (a, b) = (
        moved.solves()[0].objective,
        run(&fresh).solves()[0].objective,
    );
    assert!((a.expect("solved") - b.expect("solved")).abs() < 1e-9);
    // `bratio = 1` asks for no basis.
    model.define("more", "option bratio = 1;");
    assert!(iterations(&run(&model)) > 15 && iterations(&run(&model)) > 15);
}

#[test]
fn columns_of_many_records() {
    let labels = |n: usize| (0..n).map(|k| format!("l{k}")).collect::<Vec<_>>();
    let codes = (0..40u32).map(|k| k * 7 % 40).collect::<Vec<_>>();
    let keys = bmod::Keys::new(vec![labels(40)], vec![codes.clone()]).expect("as many");
    assert_eq!(keys.duplicate(), None);
    let mut model = Model::from_text(
        "m.blk",
        "Set i;  Parameter p(i<);  Scalar s;  s = sum(i, p(i));",
    );
    model.set_values("p", keys, codes.iter().map(|&c| f64::from(c)).collect());
    let done = run(&model);
    assert_eq!(done.value("s", []), Ok(780.0));
    assert_eq!(done.value("p", "l7"), Ok(7.0));
    let p = done.symbol("p").expect("declared").columns();
    assert_eq!((p.keys.len(), p.values[0].0), (39, "value")); // 0 is not stored
    assert_eq!(p.keys.key(0), ["l7"]);
    let twice = bmod::Keys::new(vec![vec!["a".into(), "A ".into()]], vec![vec![0, 1]]);
    assert_eq!(twice.and_then(|k| k.duplicate()), Some(1));
    assert_eq!(bmod::Keys::new(vec![vec!["a".into()]], vec![vec![1]]), None);
}
