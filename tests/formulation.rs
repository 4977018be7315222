//! Duals and optimality conditions derived from texts: compared entry by entry with the models they come from.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::common::{Memory, blk, files, shared};
use bmod::cli::host::{Output, SystemHost};
use bmod::formulation::check::{self, Comparison};
use bmod::formulation::{Formulation, study};
use bmod::host::Host;
use bmod::run::{Machine, Options, StudyChoice};
use bmod::session;
use bmod::solve::random::Random;
use bmod::source::PreprocessOptions;

/// What became of the last solve of a text.
enum Derived {
    /// There is none, or it is of a kind that has neither.
    Nothing,
    /// The formulation and the comparison.
    Dual(Box<Formulation>, Comparison),
    Kkt(Box<Formulation>, Comparison),
    /// A refusal, or a derived model that could not be generated.
    Refused(String),
}

fn options(generate_only: bool) -> Options {
    Options {
        quiet: true,
        collect: false,
        time_limit: 60.0,
        study: Some(StudyChoice {
            generate_only,
            ..StudyChoice::default()
        }),
        ..Options::default()
    }
}

fn derive(
    host: &mut dyn Host,
    file: &str,
    preprocess: PreprocessOptions,
    generate_only: bool,
) -> Derived {
    let mut out = Derived::Nothing;
    let options = options(generate_only);
    session::run(host, file, preprocess, options, false, &mut |m| {
        out = derived(m)
    });
    out
}

fn derived(m: &mut Machine) -> Derived {
    let Some((primal, _)) = study::primal(m) else {
        return Derived::Nothing;
    };
    if primal.objective.is_none() || primal.using.ends_with("mpec") || primal.using.contains("mi") {
        return Derived::Nothing;
    }
    let result = match primal.generated.instance.is_linear() {
        true => check::checked_dual(&m.symbols, &m.store, &primal)
            .map(|(f, c)| Derived::Dual(Box::new(f), c)),
        false => check::checked_kkt(&m.symbols, &m.store, &primal)
            .map(|(f, c)| Derived::Kkt(Box::new(f), c)),
    };
    result.unwrap_or_else(Derived::Refused)
}

fn derive_file(file: &Path, allowed: &[PathBuf]) -> Derived {
    let mut host = SystemHost::new(file, Path::new("."), allowed, Output::Quiet);
    let preprocess = PreprocessOptions {
        slash_comments: file.extension().is_some_and(|e| e == "blk"),
        ..PreprocessOptions::default()
    };
    derive(&mut host, &file.to_string_lossy(), preprocess, false)
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
        match derive_file(file, allowed) {
            Derived::Nothing => {}
            Derived::Refused(why) => wrong.push(format!("{name}: {why}")),
            Derived::Dual(f, c) | Derived::Kkt(f, c) => {
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
        ("", &["", "$(card(i) > 3)"][..]),
        (
            "(i)",
            &["", "$dyn(i)", "$(a(i) > 0)", "$(ord(i) > 1 and s(i))"],
        ),
        ("(t)", &["", "$(ord(t) < card(t))", "$c(t)"]),
        ("(i,j)", &["", "$arc(i,j)", "$(b(i,j) > 0)"]),
    ];
    for k in 0..3 + d.below(3) {
        let kind = if k == 0 { 1 } else { d.below(4) };
        let (domain, conditions) = heads[kind];
        let mut body = String::new();
        for n in 0..2 + d.below(3) {
            let list = if smooth && d.below(2) == 0 {
                SMOOTH[kind]
            } else {
                LINEAR[kind]
            };
            let sign = if d.below(3) == 0 { " - " } else { " + " };
            let _ = write!(body, "{}{}", if n == 0 { "" } else { sign }, d.one(list));
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
            "{name}{domain}{}.. {body} {relation} {right};",
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

#[test]
fn duals_of_models_drawn_at_random_are_transposed_matrices() {
    let mut count = 0;
    for seed in 0..cases() {
        let text = model(seed, false);
        match derive(&mut Memory::text(&text), "m.blk", blk(), true) {
            // Rows that contradict themselves are drawn, too.
            Derived::Nothing => {}
            Derived::Dual(f, c) => {
                assert!(c.passed(), "seed {seed}: {:?}\n{text}", c.differences);
                assert!(
                    f.by_instance.is_empty(),
                    "seed {seed}: {:?}\n{text}",
                    f.by_instance
                );
                count += 1;
            }
            Derived::Kkt(..) => panic!("seed {seed}: not linear\n{text}"),
            // A free column with a cost that stands in no row: the dual says 0 = cost.
            Derived::Refused(why) if why.contains("has no variables and cannot hold") => {}
            Derived::Refused(why) => panic!("seed {seed}: {why}\n{text}"),
        }
    }
    assert!(count * 3 > cases(), "{count}");
}

#[test]
fn conditions_of_models_drawn_at_random_are_those_of_automatic_derivatives() {
    let mut count = 0;
    for seed in 0..cases() {
        let text = model(seed, true);
        match derive(&mut Memory::text(&text), "m.blk", blk(), true) {
            Derived::Nothing => {}
            Derived::Dual(f, c) | Derived::Kkt(f, c) => {
                assert!(c.passed(), "seed {seed}: {:?}\n{text}", c.differences);
                assert!(
                    f.by_instance.is_empty(),
                    "seed {seed}: {:?}\n{text}",
                    f.by_instance
                );
                count += 1;
            }
            Derived::Refused(why) => panic!("seed {seed}: {why}\n{text}"),
        }
    }
    assert!(count * 3 > cases(), "{count}");
}

/// All entries of a matrix by the names of their rows and columns, right-hand sides among them.
fn entries(
    i: &check::Instance,
    rename: &dyn Fn(&str) -> String,
) -> std::collections::BTreeMap<(String, Vec<String>, String, Vec<String>), f64> {
    let mut out = std::collections::BTreeMap::new();
    let g = &i.generated.instance;
    for r in 0..g.row_count() {
        let (row, row_key) = &i.rows[r];
        for (c, v) in g.matrix.row(r) {
            let (column, key) = &i.columns[c];
            let at = (rename(row), row_key.clone(), rename(column), key.clone());
            out.insert(at, v);
        }
        let at = (
            rename(row),
            row_key.clone(),
            format!("{:?}", g.rows.relation[r]),
            Vec::new(),
        );
        out.insert(at, g.rows.rhs[r]);
    }
    for c in 0..g.column_count() {
        let (column, key) = &i.columns[c];
        for (word, v) in [("lower", g.columns.lower[c]), ("upper", g.columns.upper[c])] {
            out.insert((word.into(), Vec::new(), rename(column), key.clone()), v);
        }
    }
    out
}

#[test]
fn the_kinematic_theorem_written_by_hand_is_the_dual_of_the_static_one() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/wall.blk");
    let mut found = Vec::new();
    for model in ["static", "kinematic"] {
        let mut host = SystemHost::new(&file, Path::new("."), &[], Output::Quiet);
        let mut options = options(true);
        options.study = Some(StudyChoice {
            model: Some(model.into()),
            generate_only: true,
            ..StudyChoice::default()
        });
        session::run(
            &mut host,
            &file.to_string_lossy(),
            blk(),
            options,
            false,
            &mut |m| {
                let (primal, _) = study::primal(m).expect("it is solved");
                found.push(match model {
                    "static" => {
                        let dual =
                            bmod::formulation::dual::dual(&m.symbols, &m.store, &primal, true)
                                .expect("a dual");
                        assert!(dual.by_instance.is_empty());
                        let text = bmod::formulation::text::model(
                            &m.symbols, &m.store, &dual, None, "", true,
                        );
                        entries(&check::generate(&text).expect("generated"), &|n| {
                            let names = [
                                ("dual_alpha", "norm"),
                                ("dual_x", "normal"),
                                ("dual_objective_row", "work"),
                                ("dual_objective", "rate"),
                            ];
                            let known = names.iter().find(|k| k.0 == n);
                            known.map_or(n.to_string(), |k| k.1.to_string())
                        })
                    }
                    _ => {
                        let records = |b| check::records(&m.symbols, &m.store, b);
                        let o = &primal.generated.origin;
                        let (rows, columns) = (records(&o.rows), records(&o.columns));
                        entries(
                            &check::Instance {
                                generated: primal.generated,
                                rows,
                                columns,
                            },
                            &str::to_string,
                        )
                    }
                });
            },
        );
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
