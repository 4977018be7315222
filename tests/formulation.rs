//! Duals and optimality conditions derived from texts: compared entry by entry with the models they come from.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{self, Memory, files, shared};
use bmod::cli::host::{Output, SystemHost};
use bmod::formulation::check::{self, Comparison};
use bmod::formulation::derive::Primal;
use bmod::formulation::{Formulation, Scope, dual, study, text};
use bmod::host::Host;
use bmod::model::instance::Relation;
use bmod::model::origin::Blocks;
use bmod::run::{Generated, Machine, Options, StudyChoice};
use bmod::session;
use bmod::solve::nlp::convex::{Shape, shape};
use bmod::solve::random::Random;
use bmod::source::PreprocessOptions;
use bmod::{Choice, Model, ModelStatus};

/// What became of a solve of a text.
enum Derived {
    /// There is none, or it is of a kind that has neither.
    Nothing,
    /// The formulation and the comparison, and as a model.
    Dual(Box<Formulation>, Comparison, String),
    Kkt(Box<Formulation>, Comparison, String),
    /// A refusal, or a derived model that could not be generated.
    Refused(String),
}

/// Runs a text and looks at a solve of it.
fn look<T>(
    host: &mut dyn Host,
    file: &str,
    choice: StudyChoice,
    f: &mut dyn FnMut(&Machine, Primal) -> T,
) -> Option<T> {
    let preprocess = PreprocessOptions {
        slash_comments: file.ends_with(".blk"),
        ..PreprocessOptions::default()
    };
    let options = Options {
        quiet: true,
        collect: false,
        time_limit: 600.0,
        study: Some(choice),
        ..Options::default()
    };
    let mut out = None;
    session::run(host, file, preprocess, options, false, &mut |m| {
        out = study::primal(m).map(|(primal, _)| f(m, primal));
    });
    out
}

fn generated(model: Option<&str>) -> StudyChoice {
    StudyChoice {
        model: model.map(String::from),
        generate_only: true,
        ..StudyChoice::default()
    }
}

fn derived(m: &Machine, primal: &Primal) -> Derived {
    let discrete = matches!(&*primal.using, "mip" | "miqcp" | "minlp");
    if primal.objective.is_none() || primal.using.ends_with("mpec") || discrete {
        return Derived::Nothing;
    }
    let scope = Scope::of(m);
    let written = |f: &Formulation| text::model(scope, f, None, "", true, None);
    let result = match shape(&primal.generated.instance) {
        Shape::Linear | Shape::ConvexQuadratic { .. } => check::checked_dual(scope, primal)
            .map(|(f, c)| Derived::Dual(Box::new(f.clone()), c, written(&f))),
        _ => check::checked_kkt(scope, primal)
            .map(|(f, c)| Derived::Kkt(Box::new(f.clone()), c, written(&f))),
    };
    result.unwrap_or_else(Derived::Refused)
}

fn derive_text(text: &str) -> Derived {
    let mut host = Memory::text(text);
    let found = look(&mut host, "m.blk", generated(None), &mut |m, p| {
        derived(m, &p)
    });
    found.unwrap_or(Derived::Nothing)
}

fn derive_file(file: &Path, allowed: &[PathBuf]) -> Derived {
    let mut host = SystemHost::new(file, None, allowed, Output::Quiet);
    let name = file.to_string_lossy();
    let found = look(&mut host, &name, StudyChoice::default(), &mut |m, p| {
        derived(m, &p)
    });
    found.unwrap_or(Derived::Nothing)
}

/// The last solve of a text: status, objective, largest violation.
fn solved(text: &str, options: &bmod::Options) -> Option<bmod::Solve> {
    let run = bmod::Model::from_text("derived.blk", text).run(options);
    assert!(run.succeeded(), "{}\n{text}", run.messages());
    run.solves().last().cloned()
}

/// Derives from all files; the lines that say what went wrong, and how many were derived.
fn derive_all(list: &[PathBuf], allowed: &[PathBuf], in_symbols: bool) -> (usize, Vec<String>) {
    let (mut count, mut wrong) = (0, Vec::new());
    for file in list {
        let name = file
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let (f, c) = match derive_file(file, allowed) {
            Derived::Nothing => continue,
            Derived::Refused(why) => {
                wrong.push(format!("{name}: {why}"));
                continue;
            }
            Derived::Dual(f, c, _) | Derived::Kkt(f, c, _) => (f, c),
        };
        count += 1;
        if !c.passed() {
            wrong.push(format!(
                "{name}: {} differences: {:?}",
                c.count, c.differences
            ));
        }
        if in_symbols && !f.by_instance.is_empty() {
            wrong.push(format!("{name}: by instance: {:?}", f.by_instance));
        }
    }
    (count, wrong)
}

#[test]
fn the_models_to_read_are_derived_in_symbols() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    let mut list = files(&models.join("teaching"), &["blk"]);
    list.push(models.join("wall.blk"));
    let (count, wrong) = derive_all(&list, &[models], true);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count >= 11, "{count}");
}

/// Models of the kinds that public collections hold: derived in symbols, right, and the derived model that is written
/// solves: the dual to the same objective, the conditions without an iteration from the answer.
#[test]
fn models_of_many_kinds_are_derived_and_run() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/derive");
    let list = files(&folder, &["gms"]);
    let mut wrong = Vec::new();
    for file in &list {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let mut host = SystemHost::new(file, None, &[], Output::Quiet);
        let path = file.to_string_lossy();
        let found = look(&mut host, &path, StudyChoice::default(), &mut |m, p| {
            let objective = p
                .objective
                .map(|(_, z)| p.generated.origin.columns.symbol(z));
            let z = objective.flatten().map(|b| b.start as usize);
            let value = z.and_then(|z| Some(p.answer.as_ref()?.level[z]));
            (derived(m, &p), value)
        });
        let Some((derived, value)) = found else {
            wrong.push(format!("{name}: nothing is solved"));
            continue;
        };
        let (f, c, kkt, text) = match &derived {
            Derived::Dual(f, c, text) => (f, c, false, text),
            Derived::Kkt(f, c, text) => (f, c, true, text),
            Derived::Refused(why) => {
                wrong.push(format!("{name}: {why}"));
                continue;
            }
            Derived::Nothing => {
                wrong.push(format!("{name}: neither"));
                continue;
            }
        };
        if !c.passed() {
            wrong.push(format!("{name}: {:?}", c.differences));
        }
        let on_purpose = name == "random.gms";
        if f.by_instance.is_empty() == on_purpose {
            wrong.push(format!("{name}: by instance: {:?}", f.by_instance));
        }
        let mut options = bmod::Options::default();
        if kkt {
            options = options.option("iterlim", 0);
        }
        let Some(s) = solved(text, &options) else {
            wrong.push(format!("{name}: the derived model does not solve"));
            continue;
        };
        let good = matches!(
            s.model_status,
            ModelStatus::Optimal | ModelStatus::LocallyOptimal | ModelStatus::Solved
        );
        let same = match (s.objective, value) {
            (Some(a), Some(b)) if !kkt => (a - b).abs() <= 1e-6 * (1.0 + b.abs()),
            _ => kkt,
        };
        if !good || !same {
            wrong.push(format!(
                "{name}: {:?} {:?} {value:?} {:?}",
                s.model_status, s.objective, s.residuals
            ));
        }
    }
    assert!(list.len() >= 40, "{}", list.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Every formula that can be written is accepted by LaTeX with amsmath alone.
#[test]
fn latex_is_compiled() {
    if Command::new("pdflatex").arg("--version").output().is_err() {
        common::skipped("pdflatex is not there (apt-get install texlive-latex-base)");
        return;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let derive = |f: &str| root.join("tests/derive").join(f);
    let list = [
        root.join("models/wall.blk"),
        root.join("models/teaching/diet.blk"),
        root.join("models/teaching/walras.blk"),
        derive("circuit.gms"),
        derive("tanks.gms"),
        derive("attributes.gms"),
        derive("collision.gms"),
        derive("labels.gms"),
    ];
    let folder = tempfile::tempdir().expect("a folder");
    let tex = folder.path().join("m.tex");
    let compile = |latex: String, what: &str| {
        std::fs::write(&tex, latex).expect("written");
        let run = Command::new("pdflatex")
            .args(["-halt-on-error", "-interaction=nonstopmode", "m.tex"])
            .current_dir(folder.path())
            .output()
            .expect("it runs");
        let log = String::from_utf8_lossy(&run.stdout);
        assert!(run.status.success(), "{what}: {log}");
    };
    for file in list {
        let what = file.to_string_lossy();
        let mut model = Model::from_file(&file).expect("it is there");
        model.allow_read(root.join("models"));
        let choice = Choice::default();
        let options = bmod::Options::default();
        let shown = model.show(&choice.clone().numbers(true)).expect("formulas");
        compile(shown.latex(), &what);
        let made = [model.dual(&choice, &options), model.kkt(&choice, &options)];
        for f in made.into_iter().flatten() {
            compile(f.latex(), &what);
        }
    }
}

/// A column that stands in no row and makes the program unbounded has a row in the dual that holds nowhere.
#[test]
fn the_dual_of_an_unlimited_column_is_infeasible() {
    let text = "set i / a, b, c /;  parameter c(i) / a 1, b -2, c 3 /;
        positive variable x(i);  negative variable n;  variables f, z;  equations o, r;
        o..  z =e= sum(i, c(i)*x(i)) + 2*n + f;
        r..  x('a') + f =g= 1;
        model m / all /;  solve m using lp minimizing z;";
    let Derived::Dual(f, c, written) = derive_text(text) else {
        panic!("a linear program");
    };
    assert!(c.passed(), "{:?}", c.differences);
    let named = |n: &str| f.multipliers.iter().any(|m| m.name == n);
    assert!(named("y_lo_x") && named("y_up_n"));
    let solve = solved(&written, &bmod::Options::default()).expect("a solve");
    assert_eq!(solve.model_status, bmod::ModelStatus::Infeasible);
}

/// A free column that stands in no row and has a cost: its row in the dual is generated, holds nowhere, and says so.
#[test]
fn the_dual_of_a_free_column_without_rows_is_infeasible() {
    let text = "set i / a, b, c /;  parameter c(i) / a 1, b -2, c 3 /;
        variables x(i), z;  equations o, r;
        o..  z =e= sum(i, c(i)*x(i));  r..  x('a') =g= 1;
        model m / all /;  solve m using lp minimizing z;";
    let Derived::Dual(f, c, written) = derive_text(text) else {
        panic!("a linear program");
    };
    assert!(c.passed(), "{:?}", c.differences);
    assert!(
        f.notes[0].starts_with("x('b') (and 1 more like it) is free"),
        "{:?}",
        f.notes
    );
    let solve = solved(&written, &bmod::Options::default()).expect("a solve");
    assert_eq!(solve.model_status, bmod::ModelStatus::Infeasible);
}

/// A linear objective over quadratic rows is convex as the rows are.
#[test]
fn a_linear_objective_over_quadratic_rows_has_a_dual() {
    let text = "set i / a, b /;  variables z, w(i);  positive variable x(i);  equations o, c(i), d;
        o..  z =e= sum(i, 2*x(i));  c(i)..  sqr(w(i)) =l= x(i);  d..  sum(i, w(i)) =g= 3;
        model m / all /;  solve m using qcp minimizing z;";
    let Derived::Dual(_, c, _) = derive_text(text) else {
        panic!("a convex program");
    };
    assert!(c.passed(), "{:?}", c.differences);
}

/// What a command says of a text: standard output, then standard error.
fn told(command: &[&str], text: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("told.blk"), text).expect("written");
    let out = Command::new(env!("CARGO_BIN_EXE_bmod"))
        .args(command)
        .current_dir(folder.path())
        .env("COLUMNS", "70")
        .output()
        .expect("bmod runs");
    let told = [out.stdout, out.stderr].map(|b| String::from_utf8(b).expect("UTF-8"));
    told.concat()
}

/// What `bmod explain` says of a text.
fn explained(text: &str) -> String {
    let told = told(&["explain", "told.blk"], text);
    assert!(!told.contains('∞'), "{told}");
    assert!(told.lines().all(|l| l.chars().count() <= 70), "{told}");
    // As one line: where lines break is another matter.
    told.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// These lines stand in a text.
fn has(text: &str, lines: &[&str]) {
    for line in lines {
        assert!(text.contains(line), "`{line}` is missing:\n{text}");
    }
}

/// The formulas of a text have these lines.
fn shows(text: &str, lines: &[&str]) {
    let shown = Model::from_text("m.blk", text).show(&Choice::default());
    has(&shown.expect("formulas").text(100), lines);
}

/// The dual and the optimality conditions of a text have these lines.
fn derives(text: &str, dual: &[&str], kkt: &[&str]) {
    let model = Model::from_text("m.blk", text);
    let (choice, options) = (Choice::default(), bmod::Options::default());
    let page = |f: Result<bmod::Formulas, bmod::Error>| f.expect("formulas").text(100);
    if !dual.is_empty() {
        has(&page(model.dual(&choice, &options)), dual);
    }
    has(&page(model.kkt(&choice, &options)), kkt);
}

/// Columns that a solve held fixed have their values in what is said of it, and rows their whole activities.
#[test]
fn what_a_solve_held_fixed_is_in_its_answer() {
    let text = "positive variables x, y;  variable z;  equations o, r;
        o..  z =e= 2*x + 3*y;  r..  x + y =g= 4;  x.fx = 2.5;
        model h / all /;  h.holdFixed = 1;  solve h using lp minimizing z;";
    says(
        text,
        &["The smallest z is 9.5, at x = 2.5, y = 1.5.", "r binds"],
    );
    let numbers = [
        "r: 4 ≥ 4, tight: its multiplier is 3",
        "x: 2.5 = 2.5, tight: its multiplier is −1",
    ];
    derives(text, &numbers, &["x = 2.5"]);
}

/// What is divided by a fraction, raised to one, or squared as a root stays in parentheses.
#[test]
fn formulas_in_text_keep_their_parentheses() {
    let text = "scalars a / 2 /, b / 3 /;  variables y, w, z;  equation o;  y.lo = 1;  w.lo = 1;
        o..  z =e= a/(b/y) + 1/(1/(y + 1)) + y**(1/3) + sqr(sqrt(y)) + 0.2*0.2*y + w**1.5;
        model m / all /;  solve m using nlp minimizing z;";
    shows(
        text,
        &["a/(b/y) + 1/(1/(y + 1)) + y^(1/3) + (√y)² + 0.2·0.2·y"],
    );
    derives(text, &[], &["y^(−2/3)/3 + ", "1.5·w^0.5"]);
}

/// What a lag does to a condition on positions is worked out, and what holds anyway is left out.
#[test]
fn conditions_on_positions_are_short() {
    let text = "set t / 1*6 /;  variables x(t), z;  positive variables x;  equations o, e(t), f(t), g(t), h(t);
        scalar far / 2 /;  o..  z =e= sum(t, x(t));  e(t)$(ord(t) > 1)..  x(t) - x(t-1) =g= 1;
        f(t)$(ord(t) < card(t))..  x(t) + x(t+1) =g= 2;  g(t)$(ord(t) < card(t) - 1)..  x(t+1) =l= 9;
        h(t)..  x(t-(far+1)) =l= 8;  model m / all /;  solve m using lp minimizing z;";
    let dual = [
        "y_e(t)·[ord(t) > 1] − y_e(t+1) + y_f(t)·[ord(t) < |t|] + y_f(t−1)",
        "+ y_g(t−1)·[ord(t) < |t|] + y_h(t+(far + 1)) ≤ 1   for all t",
    ];
    derives(text, &dual, &[]);
}

/// Long terms are broken inside of their parentheses; lines of text fit the terminal.
#[test]
fn formulas_fit_the_terminal() {
    let text = "sets plant / a, b /, product / p, q /, month / 1*3 /;  parameters yield(plant,product), loss(month);
        yield(plant,product) = 1;  loss(month) = 0.1;  variables z;
        positive variables processed(plant,product,month), bought(plant,product,month);  equation output(product), o;
        o..  z =e= sum((plant,product,month), bought(plant,product,month));
        output(product)..  sum((plant,month)$(ord(month) > 1), (1 - loss(month))*yield(plant,product)
            *(processed(plant,product,month) + bought(plant,product,month) - 2*processed(plant,product,month-1))) =g= 5;
        model m / all /;  solve m using lp minimizing z;";
    let shown = Model::from_text("m.blk", text)
        .show(&Choice::default())
        .expect("formulas");
    let lines = shown.text(72);
    assert!(lines.lines().all(|l| l.chars().count() <= 72), "{lines}");
    has(&lines, &["− 2·processed(plant,product,month−1)) ≥ 5"]);
    has(&shown.latex(), &["\\bigl(", "\\bigr)"]);
}

/// A row whose name has a lead, a set that stands twice, data in bounds: all of it is in the formulas.
#[test]
fn formulas_say_what_they_run_over() {
    let text = "sets t / 1*3 /, n / a, b /, y / u, v /;  alias (n,m);  parameter cap(n,m) 'capacity';
        variables k(t), x(n,m), w(y,y), z;  positive variables x, w;  equations e(t), o, r(n), s(y);
        e(t+1)..  k(t+1) =e= 0.9*k(t) + 1;  o..  z =e= sum((n,m), x(n,m));  r(n)..  sum(m, x(n,m)) =g= 1;
        s(y)..  w(y,y) =g= 1;  cap(n,m) = 2;  x.up(n,m) = cap(n,m);
        model d / all /;  solve d using lp minimizing z;  x.up(n,m) = 7;";
    shows(
        text,
        &[
            "for all t : t+1 ∈ t",
            "x(n,m) ≥ 0",
            "w(y,y2) ≥ 0",
            "cap(n,m)  capacity",
            "x(n,m) ≤ cap(n,m)",
        ],
    );
}

/// What declarations say of the values of a variable.
#[test]
fn formulas_say_what_is_discrete() {
    let text = "set i / a, b /;  variable z;  binary variable b(i);  integer variable n(i);
        semicont variable s(i);  semiint variable q;  sos1 variable u(i);  sos2 variable v(i);  equation o;
        o..  z =e= sum(i, b(i) + n(i) + s(i) + u(i) + v(i)) + q;  n.up(i) = 7;  s.lo(i) = 1;  s.up(i) = 9;
        q.lo = 2;  q.up = 5;  model m / all /;  solve m using USING minimizing z;";
    let values = [
        "b(i) ∈ {0, 1}",
        "n(i) ∈ ℤ",
        "n(i) ≤ 7",
        "s(i) = 0 or s(i) ≥ 1",
        "s(i) ≤ 9",
        "q = 0 or q ≥ 2",
        "q ∈ ℤ",
        "u(i) SOS1: at most one is not 0 along i",
        "v(i) SOS2: ",
    ];
    shows(&text.replace("USING", "mip"), &values);
    shows(&text.replace("USING", "rmip"), &["b(i) ≤ 1", "  s(i) ≥ 1"]);
}

/// Bounds stand in the primal beside its dual, are paired with their multipliers, and belong to the conditions.
#[test]
fn bounds_are_in_derivations() {
    let text = "variables x, z;  equations o, r;  x.lo = -5;  x.up = 4;
        o..  z =e= 2*x;  r..  x =g= -7;  model m / all /;  solve m using lp minimizing z;";
    let dual = [
        "with\n  x ≥ −5\n  x ≤ 4\n",
        "x       │ dual_x = …",
        "x ≥ −5  │ y_lo_x ≥ 0",
        "x ≤ 4   │ y_up_x ≤ 0",
        "x: −5 ≥ −5, tight: its multiplier is 2",
    ];
    derives(text, &dual, &["x ≥ −5", "x ≤ 4"]);
}

/// A derived model that includes the text finds it from its own folder, and says where the text goes on to other data.
#[test]
fn a_derived_model_includes_the_text_from_its_folder() {
    let text = "set i / a /;  scalar b / 3 /;  positive variable x(i);  variable z;  equations o, r;
        o..  z =e= sum(i, x(i));  r..  sum(i, x(i)) =g= b;  model m / all /;  solve m using lp min z;";
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir_all(folder.path().join("a/b")).expect("folders");
    std::fs::write(folder.path().join("m.blk"), text).expect("written");
    let run = |args: &[&str]| {
        let mut bmod = Command::new(env!("CARGO_BIN_EXE_bmod"));
        let out = bmod.args(args).current_dir(folder.path()).output();
        let out = out.expect("bmod runs");
        assert!(out.status.success(), "{out:?}");
        String::from_utf8(out.stdout).expect("UTF-8")
    };
    let same = run(&["dual", "m.blk", "--include", "--as-model", "a/b/d.blk"]);
    assert!(!same.contains("other values"), "{same}");
    has(&run(&["run", "a/b/d.blk"]), &["dual_objective = 3"]);
    std::fs::write(folder.path().join("m.blk"), format!("{text}  b = 5;")).expect("written");
    let other = run(&["dual", "m.blk", "--include", "--as-model", "a/b/d.blk"]);
    has(
        &other,
        &["b has other values at the end of the text than at the solve"],
    );
}

/// Points for the comparison are found where all bases of powers are 0 at the answer.
#[test]
fn a_check_finds_points_where_powers_have_values() {
    let text = "set i / 1*20 /;  variables a(i), z;  equations o, r;
        o..  z =e= sum(i, (a(i) - ord(i))**2);  r..  sum(i, a(i)) =g= 100;  a.l(i) = 30;
        model m / all /;  solve m using nlp min z;";
    has(&told(&["kkt", "told.blk", "--check"], text), &["Checked: "]);
}

/// The page of a solve has its dual, or its optimality conditions where it has none.
#[test]
fn a_report_has_the_dual_or_the_conditions() {
    let text = "variables x, z;  equations o, r;  x.lo = 1;  o..  z =e= EXPR;  r..  x =g= 2;
        model m / all /;  solve m using TYPE minimizing z;";
    for (expression, using, heading) in [
        ("3*x", "lp", "What is paired with what"),
        (
            "exp(x)",
            "nlp",
            "Optimality conditions (Karush, Kuhn, Tucker)",
        ),
    ] {
        let text = text.replace("EXPR", expression).replace("TYPE", using);
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("told.blk");
        std::fs::write(&file, text).expect("written");
        let page = folder.path().join("told.html");
        let mut bmod = Command::new(env!("CARGO_BIN_EXE_bmod"));
        let run = bmod.arg("report").arg(&file).arg("--html").arg(&page);
        assert!(run.status().expect("bmod runs").success());
        has(
            &std::fs::read_to_string(&page).expect("a page"),
            &[heading, "<h2>In words</h2>"],
        );
    }
}

/// Rows that differ by 3e-8 of their size are two: one has the price. Numbers without end are as in all reports.
#[test]
fn ranges_tell_near_rows_apart() {
    let text = "variables x, z;  equations o, a, b;  o..  z =e= 3*x;  a..  x =g= 4000000123;  b..  x =g= 4000000000;
        model m / all /;  solve m using lp min z;";
    let said = told(&["range", "told.blk", "--format", "json"], text);
    let all: serde_json::Value = serde_json::from_str(&said).expect("JSON");
    let number = |row: usize, key: &str| all["rows"][row][key].as_f64();
    assert_eq!(number(0, "price_above"), Some(3.0), "{said}");
    assert_eq!(number(1, "price_below"), Some(0.0), "{said}");
    assert_eq!(number(1, "to"), Some(4_000_000_123.0), "{said}");
    assert_eq!(all["rows"][0]["to"], "+INF");
    assert_eq!(all["rows"][1]["from"], "-INF");
}

/// What no command and no record is called.
#[test]
fn names_that_are_not_there_are_told() {
    let text = "variables x, z;  equation o;  x.lo = 1;  o..  z =e= 3*x;  model m / all /;  solve m using lp min z;";
    let said = told(&["range", "told.blk", "nosuch"], text);
    has(
        &said,
        &["no row or column is called `nosuch`; there are o, "],
    );
    has(
        &told(&["told.blk"], text),
        &["`bmod run told.blk` runs a model"],
    );
    let unbounded = told(&["run", "told.blk"], &text.replace("x.lo", "x.up"));
    assert!(unbounded.contains("unbounded\n"), "{unbounded}");
}

/// The explanation of a text has these sentences.
fn says(text: &str, sentences: &[&str]) {
    let told = explained(text);
    for sentence in sentences {
        assert!(told.contains(sentence), "{told}");
    }
}

/// No price is told where a right-hand side cannot move.
#[test]
fn an_explanation_says_where_nothing_is_feasible() {
    says(
        "set i / a, b /;  variable z;  positive variable x(i);  equations o, r(i), s;
        o..  z =e= sum(i, x(i));  r(i)..  x(i) =l= 3;  s..  sum(i, x(i)) =g= 6;
        model m / all /;  solve m using lp minimizing z;",
        &[
            "r('a') and r('b') bind; for each, more on its right side changes nothing, with less nothing is feasible.",
            "s binds: a unit less on its right side changes z by −1 (from 0 to 6), with more nothing is feasible.",
        ],
    );
}

/// Records that say the same are one sentence; a block of which there is too much to say is summed up.
#[test]
fn an_explanation_does_not_repeat_itself() {
    says(
        "set i / i1*i9 /, j / j1*j5 /;  variable z;  positive variables x(i), y(j);
        equations o, r(i), s(j), c;
        o..  z =e= sum(i, ord(i)*x(i)) + sum(j, y(j));  r(i)..  x(i) =g= 1;  s(j)..  y(j) =l= 4;
        c..  sum(j, y(j)) =g= 20;  x.fx('i9') = 1;
        model m / all /;  solve m using lp minimizing z;",
        &[
            "8 of the 9 rows of r bind: a unit more on a right side changes z by between 1 (r('i1')) and 8 (r('i8')).",
            "All 5 rows of s bind; for each, more on its right side changes nothing, with less nothing is feasible.",
        ],
    );
}

/// A model with discrete variables has no prices: none are told, and ranges are refused.
#[test]
fn discrete_variables_have_no_prices() {
    let text = "set i / a, b, c /;  variable z;  binary variable x(i);  equations o, r;
        o..  z =e= sum(i, ord(i)*x(i));  r..  sum(i, x(i)) =g= 2;
        model m / all /;  option optcr = 0;  solve m using mip minimizing z;";
    let told = explained(text);
    assert!(told.contains("but for 3 discrete columns"), "{told}");
    assert!(told.ends_with("r binds."), "{told}");
    let refused = bmod::Model::from_text("m.blk", text)
        .ranges(&bmod::Choice::default(), &bmod::Options::default())
        .expect_err("no ranges");
    assert!(
        refused.to_string().contains("x('a') is discrete"),
        "{refused}"
    );
}

/// What cannot be derived is refused with its place and a reason.
#[test]
fn refusals_have_place_and_reason() {
    let head = "set i / a, b /; variable x(i), z; binary variable u(i); scalar n / 1 /;
equation obj, e(i); e(i).. x(i) =g= ord(i);
";
    let cases = [
        (
            "integers",
            "obj.. z =e= sum(i, x(i) + u(i)); model m / all /; solve m using mip minimizing z;",
        ),
        (
            "quadratic integers",
            "obj.. z =e= sum(i, sqr(x(i)) + u(i)); model m / all /; solve m using miqcp minimizing z;",
        ),
        (
            "nonlinear",
            "obj.. z =e= sum(i, exp(x(i))); model m / all /; solve m using nlp minimizing z;",
        ),
        (
            "not convex",
            "obj.. z =e= -sum(i, sqr(x(i))); x.up(i) = 5; model m / all /; solve m using qcp minimizing z;",
        ),
        (
            "kink",
            "obj.. z =e= sum(i, exp(x(i))*abs(x(i) - 2)); model m / all /; solve m using dnlp minimizing z;",
        ),
        (
            "no objective",
            "obj.. z =e= sum(i, x(i)); model m / obj.z, e.x /; z.l = 3; solve m using mcp;",
        ),
        (
            "condition over a variable",
            "obj.. z =e= sum(i$(x(i) > 0), x(i)); model m / all /; solve m using nlp minimizing z;",
        ),
        (
            "unknown model",
            "obj.. z =e= sum(i, x(i)); model static / all /; solve static using lp minimizing z;",
        ),
        (
            "nothing is solved",
            "obj.. z =e= sum(i, x(i)); model m / all /;",
        ),
        (
            "no such solve",
            "obj.. z =e= sum(i, x(i)); model m / all /; solve m using lp minimizing z;",
        ),
    ];
    let mut out = String::new();
    for (name, tail) in cases {
        let model = Model::from_text("m.blk", format!("{head}{tail}"));
        let choice = match name {
            "unknown model" => Choice::default().model("statik"),
            "no such solve" => Choice::default().solve(4),
            _ => Choice::default(),
        };
        let options = bmod::Options::default();
        let made = [
            ("dual", model.dual(&choice, &options)),
            ("kkt", model.kkt(&choice, &options)),
        ];
        for (what, f) in made {
            let said = match f {
                Ok(f) => f.title().to_string(),
                Err(e) => e.to_string(),
            };
            let _ = writeln!(out, "=== {name}: {what}\n{said}\n");
        }
    }
    insta::assert_snapshot!("refusals_of_derivations", out);
}

/// A model that includes the text it comes from instead of its data runs, too.
#[test]
fn a_derived_model_may_include_the_text() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/teaching/diet.blk");
    let mut host = SystemHost::new(&file, None, &[], Output::Quiet);
    let name = file.to_string_lossy();
    let model = look(&mut host, &name, StudyChoice::default(), &mut |m, p| {
        let f = dual::dual(Scope::of(m), &p, false).expect("a dual");
        text::model(Scope::of(m), &f, Some("diet.blk"), "", true, None)
    });
    let mut derived = Model::from_text("dual.blk", model.expect("it is solved"));
    derived.file("diet.blk", std::fs::read(&file).expect("the text"));
    let run = derived.run(&bmod::Options::default());
    assert!(run.succeeded(), "{}", run.messages());
    let [primal, dual] = run.solves() else {
        panic!("two solves")
    };
    let (a, b) = (
        primal.objective.unwrap_or(0.0),
        dual.objective.unwrap_or(1.0),
    );
    assert!((a - b).abs() < 1e-9, "{a} {b}");
}

#[test]
fn linear_programs_of_others_are_derived() {
    let Some(folder) = shared("corpus/lp") else {
        return;
    };
    let (count, wrong) = derive_all(&files(&folder, &["gms"]), &[folder], false);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count >= 20, "{count}");
}

#[test]
fn nonlinear_programs_of_others_are_derived() {
    let Some(folder) = shared("corpus/nlp") else {
        return;
    };
    let (count, wrong) = derive_all(&files(&folder, &["gms"]), &[folder], false);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count >= 20, "{count}");
}

/// Sets and data of the models drawn at random: subsets, tuple sets, a dynamic set, an order.
const HEAD: &str = "
Sets i / i1*i4 /, s(i) / i2, i3 /, j / j1*j3 /, t / t1*t5 /, arc(i,j) / i1.j1, i1.j3, i2.j2, i4.j1 /, dyn(i);
Alias (i,k), (t,tt);
Parameters a(i), b(i,j), c(t), n(t) / t1 2, t2 -1, t4 1 /, h(s) / i2 3, i3 -2 /, e(i,k), lim(i);
a(i) = mod(7*ord(i),5) - 2; b(i,j) = ord(i) - 2*ord(j); c(t) = 1/ord(t); dyn(i) = ord(i) <> 2;
e(i,k) = ord(i) - ord(k); lim(i) = 3 + ord(i);
Scalar two / 2 /;
Variables z, x0, xi(i), xij(i,j), xt(t), xii(i,k), xu(*);
";

/// Linear terms, by what is under control: nothing, `i`, `t`, `(i,j)`.
const LINEAR: [&[&str]; 4] = [
    &[
        "sum(i, a(i)*xi(i))",
        "sum((i,j)$arc(i,j), b(i,j)*xij(i,j))",
        "sum(arc(i,j), xij(arc))",
        "two*x0",
        "sum(t, c(t)*xt(t-1))",
        "sum(t, xt(t++1))",
        "3*xi('i2')",
        "sum(s, h(s)*xi(s))",
        "sum(t$(ord(t) > 2), (ord(t) - 1)*xt(t))",
        "sum((i,k)$(ord(i) < ord(k)), xii(i,k))",
        "sum(i, xii(i,i))",
        "sum(dyn(i), a(i)*(xi(i) + sum(j, b(i,j)*xij(i,j))))",
        "card(arc)*x0",
        "sum(i, xu(i))",
        "sum(t, xt(t+n(t)))",
        "sum((i,t)$(ord(i) = ord(t)), xi(i)*c(t))",
        "2*(x0 - sum(j, xij('i1',j)))/two",
        "sum(t$t.last, xt(t))",
        "sum(t, ord(t)*xt(t+1))",
        "sum(i$(not dyn(i)), xi(i))",
        "prod(t, 1 + c(t))*x0",
    ],
    &[
        "a(i)*xi(i)",
        "sum(j, b(i,j)*xij(i,j))",
        "xii(i,i)",
        "sum(k$(not sameas(i,k)), e(i,k)*xii(k,i))",
        "xi(i)$dyn(i)",
        "xi(i+1)",
        "xi('i1')$(ord(i) = 2)",
        "(1/a(i)*xi(i))$a(i)",
        "sum(arc(i,j), xij(i,j))",
        "sum(dyn, e(i,dyn)*xii(i,dyn))",
        "sum(k$(ord(k) <= ord(i)), xi(k))",
        "x0$s(i)",
        "xu(i)",
        "sum(t$(ord(t) = ord(i)), xt(t))",
        "xii(i,'i3')",
        "xi(i--1)",
        "ord(i)*xi(i-2)",
        "sum((k,j)$(arc(k,j) and e(i,k) > 0), xij(k,j))",
        "xii(i+1,i)",
    ],
    &[
        "xt(t) - 0.5*xt(t-1)",
        "xt(t++2)",
        "sum(tt$(ord(tt) <= ord(t)), c(tt)*xt(tt))",
        "xt(t+n(t))",
        "xt(t-1)$(ord(t) > 3)",
        "c(t)*xt(t)",
        "x0$(ord(t) = 1)",
        "sum(i$(ord(i) = ord(t)), a(i)*xi(i))",
        "xt(t+1)*c(t+1)",
        "xt('t3')",
        "ord(t)*xt(t-2)",
        "xt(t-(card(t)-1))",
    ],
    &[
        "xij(i,j)",
        "b(i,j)*xi(i)",
        "xij(i,j+1)",
        "xij(i++1,j)",
        "sum(k$arc(k,j), xij(k,j))",
        "xij(i,'j2')$dyn(i)",
        "x0$arc(i,j)",
        "sum(t$(ord(t) <= ord(j)), xt(t))",
    ],
];

/// Smooth terms.
const SMOOTH: [&[&str]; 4] = [
    &[
        "exp(0.1*sum(i, a(i)*xi(i)))",
        "sum(i, sqr(xi(i) - a(i)))",
        "prod(j, 1.5 + 0.1*xij('i1',j))",
        "x0*sum(t, c(t)*xt(t))",
        "sum((i,k), xi(i)*e(i,k)*xi(k))",
        "sum(t, log(1 + sqr(xt(t-1))))",
        "x0/(2 + sqr(xi('i1')))",
        "sqrt(1 + sum(i, sqr(xi(i))))",
        "sum(i, prod(k$(not sameas(i,k)), 1 + 0.1*xi(k)))",
        "edist(x0, 2, xi('i3'))",
    ],
    &[
        "sin(xi(i))",
        "power(xi(i),3)",
        "xi(i)*xi(i+1)",
        "(2 + sqr(xi(i)))**1.5",
        "exp(0.1*xi(i)*xii(i,i))",
        "xi(i)/(3 + sqr(x0))",
        "sum(k, tanh(xii(k,i)))",
        "arctan(xi(i))$dyn(i)",
        "prod(j$arc(i,j), 2 + 0.1*xij(i,j))",
        "errorf(xi(i)) + sigmoid(x0)",
        "sqr(sum(j, b(i,j)*xij(i,j)))",
    ],
    &[
        "sqr(xt(t) - xt(t-1))",
        "exp(0.1*xt(t++1))",
        "cos(xt(t))*x0",
        "log(3 + sqr(sum(tt$(ord(tt) < ord(t)), xt(tt))))",
        "xt(t+n(t))*xt(t)",
        "arctan2(1 + sqr(xt(t)), 2)",
        "vcpower(2 + sqr(xt(t)), 0.5)",
        "rpower(2 + sqr(xt(t)), 1 + 0.1*cos(x0))",
    ],
    &[
        "xij(i,j)*xi(i)",
        "sqr(xij(i,j) - xij(i,j-1))",
        "exp(0.2*xij(i,j))$arc(i,j)",
        "cosh(0.1*xij(i++1,j))",
    ],
];

const BOUNDS: &[&str] = &[
    "xi.lo(i) = 0;",
    "xi.up(i) = lim(i);",
    "xij.lo(arc) = 0; xij.up(i,'j1') = 4;",
    "xt.lo(t) = -c(t);",
    "xt.fx('t2') = 1.5;",
    "x0.up = 0;",
    "xii.lo(i,k)$(ord(i) > 1) = 0.5;",
    "xu.lo(i) = 0; xu.up('i2') = 9;",
    "xi.fx(s) = 1;",
    "xt.up(t) = 0;",
    "xt.lo(t) = 1; xt.up(t) = 8;",
    "xij.fx(i,j)$(not arc(i,j)) = 0;",
    "Positive variables xij, xt;",
    "Negative variable xii;",
];

/// What smooth expressions drawn at random are made of, by what is under control.
const ATOMS: [&[&str]; 4] = [
    &[
        "x0",
        "xi('i2')",
        "sum(i, a(i)*xi(i))",
        "two",
        "sum(t, xt(t++1)*xt(t))",
    ],
    &[
        "xi(i)",
        "xi(i+1)",
        "x0",
        "a(i)",
        "xij(i,'j1')",
        "sum(k$(ord(k) < ord(i)), xii(i,k))",
    ],
    &["xt(t)", "xt(t-1)", "xt(t++1)", "c(t)", "x0$(ord(t) > 2)"],
    &[
        "xij(i,j)",
        "xi(i)",
        "b(i,j)",
        "xij(i,j+1)",
        "xi(i)$arc(i,j)",
    ],
];

struct Dice(Random);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        (self.0.uniform() * n as f64) as usize
    }

    fn one<'a>(&mut self, list: &[&'a str]) -> &'a str {
        list[self.below(list.len())]
    }
}

/// A smooth expression drawn at random, at most so deep.
fn expression(d: &mut Dice, kind: usize, depth: usize) -> String {
    if depth == 0 || d.below(5) == 0 {
        return d.one(ATOMS[kind]).to_string();
    }
    let shape = d.one(&[
        "(A + B)",
        "(A - B)",
        "A*B",
        "(-A)*B",
        "A/(2 + sqr(B))",
        "A/(1.5 + cos(B))",
        "sqr(A - B)",
        "exp(0.1*sin(A))",
        "log(1 + sqr(A))",
        "sqrt(1 + sqr(A))",
        "(1 + sqr(A))**0.7",
        "arctan(A)*B",
        "sin(A)",
        "tanh(A + B)",
        "power(cos(A),3)",
    ]);
    let mut out = String::new();
    for c in shape.chars() {
        match c {
            'A' | 'B' => out.push_str(&expression(d, kind, depth - 1)),
            c => out.push(c),
        }
    }
    out
}

/// A model drawn at random.
fn model(seed: u64, smooth: bool) -> String {
    let mut d = Dice(Random(seed.wrapping_mul(977).wrapping_add(13)));
    for _ in 0..3 {
        d.below(2);
    }
    let mut text = HEAD.to_string();
    let mut names = Vec::new();
    let (mut declared, mut rows) = (String::new(), String::new());
    let heads = [
        ("", &[""][..], &["", "$(card(i) > 3)"][..]),
        (
            "(i)",
            &["(i)", "(i)", "(s(i))"],
            &["", "$dyn(i)", "$(a(i) > 0)", "$(ord(i) > 1 and s(i))"],
        ),
        (
            "(t)",
            &["(t)", "(t)", "(t+1)"],
            &["", "$(ord(t) < card(t))", "$c(t)"],
        ),
        (
            "(i,j)",
            &["(i,j)", "(i,j)", "(arc(i,j))"],
            &["", "$arc(i,j)", "$(b(i,j) > 0)"],
        ),
    ];
    for k in 0..3 + d.below(3) {
        let kind = if k == 0 { 1 } else { d.below(4) };
        let (domain, defined, conditions) = heads[kind];
        let defined = d.one(defined);
        let mut body = String::new();
        for n in 0..2 + d.below(3) {
            let term = match if smooth { d.below(4) } else { 3 } {
                0 => expression(&mut d, kind, 3),
                1 => d.one(SMOOTH[kind]).to_string(),
                _ => d.one(LINEAR[kind]).to_string(),
            };
            let sign = if d.below(3) == 0 { " - " } else { " + " };
            let _ = write!(body, "{}{term}", if n == 0 { "" } else { sign });
        }
        let relation = d.one(&["=e=", "=l=", "=g=", "=g=", "=l=", "=n="]);
        let right = match kind {
            0 => d.one(&["0", "5", "two*3", "x0 + 1", "sum(i, a(i))"]),
            1 => d.one(&["0", "a(i)", "5$dyn(i)", "xi(i) - 2", "lim(i)"]),
            2 => d.one(&["0", "c(t)", "ord(t)", "-4"]),
            _ => d.one(&["0", "b(i,j)", "1$arc(i,j)"]),
        };
        let name = format!("e{k}");
        let _ = writeln!(declared, "Equation {name}{domain};");
        let _ = writeln!(
            rows,
            "{name}{defined}{}.. {body} {relation} {right};",
            d.one(conditions)
        );
        names.push(name);
    }
    let list = if smooth { SMOOTH[0] } else { LINEAR[0] };
    let objective = [d.one(list), d.one(LINEAR[0]), d.one(LINEAR[0])].join(" + ");
    let define = d.one(&["z =e= ", "0 =e= -z + ", "two*z =e= 1 + ", "z =g= "]);
    let _ = writeln!(declared, "Equation obj;");
    let _ = writeln!(rows, "obj.. {define}{objective};");
    text.push_str(&declared);
    text.push_str(&rows);
    for _ in 0..d.below(4) {
        let _ = writeln!(text, "{}", d.one(BOUNDS));
    }
    let using = if smooth { "nlp" } else { "lp" };
    let sense = d.one(&["minimizing", "maximizing"]);
    let _ = writeln!(text, "Model m / all /;\nsolve m using {using} {sense} z;");
    text
}

fn cases() -> u64 {
    let wanted = std::env::var("FUZZ_CASES")
        .ok()
        .and_then(|n| n.parse().ok());
    wanted.unwrap_or(150)
}

/// The derivation of a model drawn at random; None where it has none on purpose.
fn drawn(seed: u64, smooth: bool) -> Option<(String, Derived)> {
    let text = model(seed, smooth);
    let derived = derive_text(&text);
    match &derived {
        // Rows that contradict themselves are drawn, too.
        Derived::Nothing => None,
        // A free column with a cost that stands in no row: the dual says 0 = cost.
        Derived::Refused(why) if why.contains("has no variables and cannot hold") => None,
        Derived::Refused(why) => panic!("seed {seed}: {why}\n{text}"),
        Derived::Dual(f, c, _) | Derived::Kkt(f, c, _) => {
            assert!(c.passed(), "seed {seed}: {:?}\n{text}", c.differences);
            let symbols = f.by_instance.is_empty();
            assert!(symbols, "seed {seed}: {:?}\n{text}", f.by_instance);
            Some((text, derived))
        }
    }
}

#[test]
fn duals_of_models_drawn_at_random_are_transposed_matrices() {
    let mut count = 0;
    for seed in 0..cases() {
        if let Some((text, derived)) = drawn(seed, false) {
            let linear = matches!(derived, Derived::Dual(..));
            assert!(linear, "seed {seed}: not linear\n{text}");
            count += 1;
        }
    }
    assert!(count * 3 > cases(), "{count}");
}

#[test]
fn conditions_of_models_drawn_at_random_are_those_of_automatic_derivatives() {
    let count = (0..cases()).filter_map(|seed| drawn(seed, true)).count() as u64;
    assert!(count * 3 > cases(), "{count}");
}

/// The dual of the dual is the primal again: same rows and columns by name, same matrix, same sides and bounds. A bound of
/// the primal other than 0 is a column of its dual, and so a row of the dual of that: only rows and columns without such
/// bounds are compared by bounds.
#[test]
fn the_dual_of_the_dual_is_the_primal() {
    let mut count = 0;
    for seed in 0..cases() {
        let Some((text, Derived::Dual(_, _, dual))) = drawn(seed, false) else {
            continue;
        };
        let first = matrix(&text, &str::to_string);
        let Derived::Dual(_, c, twice) = derive_text(&dual) else {
            panic!("seed {seed}: the dual has no dual\n{dual}");
        };
        assert!(c.passed(), "seed {seed}: {:?}\n{dual}", c.differences);
        // y_dual_x is x again, dual_y_e is e again.
        let again = matrix(&twice, &|n| {
            let known = n.strip_prefix("y_dual_").or(n.strip_prefix("dual_y_"));
            known.map_or(n.to_string(), |k| {
                k.trim_end_matches("_1").trim_end_matches("_2").to_string()
            })
        });
        let mut missing = Vec::new();
        for (key, v) in &first {
            match again.get(key) {
                Some(w) if (v - w).abs() <= 1e-10 * v.abs().max(1.0) => {}
                w => missing.push((key, v, w)),
            }
        }
        assert!(
            missing.is_empty(),
            "seed {seed}: {missing:?}\n{text}\n{dual}\n{twice}"
        );
        count += 1;
    }
    assert!(count * 3 > cases(), "{count}");
}

/// The name of a row or column in lower case, and its labels.
type Record = (String, String);

type Entries = BTreeMap<(Record, Record), f64>;

/// An instance with the names of its rows and columns.
struct Named {
    generated: Generated,
    rows: Vec<Record>,
    columns: Vec<Record>,
}

impl Named {
    fn new(m: &Machine, generated: Generated) -> Self {
        let names = |blocks: &Blocks| {
            let mut out = Vec::new();
            for b in &blocks.list {
                let name = m.symbols.get(b.symbol).name.to_lowercase();
                let label = |l: &u32| m.store.universe.name(*l).to_lowercase();
                let key = |i| b.key(i).iter().map(label).collect::<Vec<_>>();
                out.extend((b.start..b.start + b.len).map(|i| (name.clone(), key(i).join("."))));
            }
            out
        };
        Self {
            rows: names(&generated.origin.rows),
            columns: names(&generated.origin.columns),
            generated,
        }
    }

    /// What a text generates.
    fn of(text: &str) -> Self {
        let mut host = Memory::text(text);
        let f = &mut |m: &Machine, p: Primal| Named::new(m, p.generated);
        look(&mut host, "m.blk", generated(None), f).expect("it is generated")
    }
}

/// The matrix that a text generates, by names, its objective's row and column left out.
fn matrix(text: &str, rename: &dyn Fn(&str) -> String) -> Entries {
    let i = Named::of(text);
    let p = &i.generated.instance;
    let z = p.objective.map(|o| o.column as usize);
    let named = |r: &Record| (rename(&r.0), r.1.clone());
    let mut out = Entries::new();
    for r in (0..p.row_count()).filter(|&r| p.rows.relation[r] != Relation::Free) {
        if p.matrix.row(r).any(|(j, _)| Some(j) == z) {
            continue;
        }
        for (j, v) in p.matrix.row(r).filter(|t| t.1 != 0.0) {
            out.insert((named(&i.rows[r]), named(&i.columns[j])), v);
        }
    }
    out
}

/// All entries of a matrix by the names of their rows and columns, right-hand sides among them.
fn entries(
    i: &Named,
    rename: &dyn Fn(&str) -> String,
) -> BTreeMap<(String, String, String, String), f64> {
    let mut out = BTreeMap::new();
    let g = &i.generated.instance;
    for r in 0..g.row_count() {
        let (row, row_key) = &i.rows[r];
        for (c, v) in g.matrix.row(r) {
            let (column, key) = &i.columns[c];
            let at = (
                rename(row),
                row_key.to_string(),
                rename(column),
                key.to_string(),
            );
            out.insert(at, v);
        }
        let at = (
            rename(row),
            row_key.to_string(),
            format!("{:?}", g.rows.relation[r]),
            String::new(),
        );
        out.insert(at, g.rows.rhs[r]);
    }
    for c in 0..g.column_count() {
        let (column, key) = &i.columns[c];
        for (word, v) in [("lower", g.columns.lower[c]), ("upper", g.columns.upper[c])] {
            out.insert(
                (word.into(), String::new(), rename(column), key.to_string()),
                v,
            );
        }
    }
    out
}

#[test]
fn the_kinematic_theorem_written_by_hand_is_the_dual_of_the_static_one() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/wall.blk");
    let mut found = Vec::new();
    for model in ["static", "kinematic"] {
        let mut host = SystemHost::new(&file, None, &[], Output::Quiet);
        let name = file.to_string_lossy();
        let all = look(
            &mut host,
            &name,
            generated(Some(model)),
            &mut |m, primal| {
                if model == "kinematic" {
                    let i = Named::new(m, primal.generated);
                    return entries(&i, &str::to_string);
                }
                let dual = dual::dual(Scope::of(m), &primal, true).expect("a dual");
                assert!(dual.by_instance.is_empty());
                let text = text::model(Scope::of(m), &dual, None, "", true, None);
                entries(&Named::of(&text), &|n| {
                    let names = [
                        ("dual_alpha", "norm"),
                        ("dual_x", "normal"),
                        ("dual_objective_row", "work"),
                        ("dual_objective", "rate"),
                    ];
                    let known = names.iter().find(|k| k.0 == n);
                    known.map_or(n.to_string(), |k| k.1.to_string())
                })
            },
        );
        found.push(all.expect("it is solved"));
    }
    let (derived, by_hand) = (&found[0], &found[1]);
    let known: Vec<_> = by_hand
        .keys()
        .filter(|k| !derived.contains_key(*k))
        .take(3)
        .collect();
    let new: Vec<_> = derived
        .keys()
        .filter(|k| !by_hand.contains_key(*k))
        .take(3)
        .collect();
    assert!(
        known.is_empty() && new.is_empty(),
        "only by hand: {known:?}; only derived: {new:?}"
    );
    for (k, v) in by_hand {
        let d = derived[k];
        assert!(
            (d - v).abs() <= 1e-12 * v.abs().max(1.0) || d == *v,
            "{k:?}: {d} and {v}"
        );
    }
    assert!(by_hand.len() > 2000);
}
