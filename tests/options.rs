//! Options of solvers: what is refused wherever it stands, and the page that lists them.

use bmod::model::option::{OptionTable, page};
use bmod::run::Options;
use bmod::solve::registry::OPTION_TABLES;
use bmod::solve::strategy;
use std::path::Path;

const HEAD: &str = "# Options

`option NAME = VALUE;` in a model, `--option NAME=VALUE` on the command line, or a line `NAME VALUE` in an option file: `m.optfile = 1`
reads `path.opt` for mcp and cns, `pounce.opt` or `ipopt.opt` for nonlinear programs, `clarabel.opt` or `bmip.opt` for linear ones. A name
that nobody has and a value of another kind are errors. In an `option` statement, a number outside its range, which GAMS lets pass, and the
name of a solver that is not here are warnings. `bmod help options [SOLVER]` prints these tables. They are made from the declarations in
`src/model/language.rs` and `src/solve/`.

";

#[test]
fn the_page_is_that_of_the_tables() {
    let shown = |t: &&OptionTable| !["ipopt", "highs"].contains(&t.backend);
    let tables: Vec<&OptionTable> = OPTION_TABLES.iter().copied().filter(shown).collect();
    let now = format!("{HEAD}{}", page(&tables));
    compare("options.md", &now);
}

/// Compares a page of `docs/` with what the tables say, or writes it.
fn compare(page: &str, now: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("docs")
        .join(page);
    if std::env::var_os("BMOD_WRITE").is_some() {
        std::fs::write(&path, now).expect("docs can be written");
    }
    let there = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        there == now,
        "docs/{page} is not what the tables say; to make it anew: \
         BMOD_WRITE=1 cargo test --test all options::"
    );
}

const STRATEGIES_HEAD: &str = "# Strategies

The fallbacks, restarts and special treatments of the solvers. Each can be left out: `--option without=NAME[,NAME…]`, or
`option without = NAME;` in a model (several names between quotes). `cargo bench --bench ablation` solves the corpora without each
and prints what is lost ([measured](lab/strategies.md)); what loses nothing is deleted. This page is made from the table in `src/solve/strategy.rs`.

";

#[test]
fn the_page_of_strategies_is_that_of_the_table() {
    compare(
        "strategies.md",
        &format!("{STRATEGIES_HEAD}{}", strategy::page()),
    );
}

#[test]
fn what_no_solver_takes_is_refused() {
    let refused = |name: &str, value: &str| {
        let mut options = Options::default();
        options.set(&[(name.to_string(), value.to_string())]).err()
    };
    for (name, value, says) in [
        ("lp_acuracy", "high", "did you mean `lp_accuracy`?"),
        ("method", "simplx", "not `simplx`"),
        ("tolerance", "abc", "a number between 0 and 1, not `abc`"),
        ("mpec_factor", "2", "a number between 0 and 1, not `2`"),
        ("major_iteration_limit", "few", "a whole number"),
        ("nosuchoption", "1", "bmod help options"),
        (
            "without",
            "square_newton,interval_prof",
            "not `interval_prof`; did you mean `interval_proof`?",
        ),
        ("lp", "clarabl", "did you mean `clarabel`?"),
        ("nlp", "bmcp", "the solver `bmcp` does not solve nlp"),
        ("reslim", "abc", "a number of at least 0, not `abc`"),
        ("reslim", "-1", "a number of at least 0, not `-1`"),
        ("seed", "foo", "a whole number, not `foo`"),
        ("certify", "perhaps", "`yes` or `no`, not `perhaps`"),
        (
            "solveopt",
            "xyz",
            "`clear` or a number from 0 to 2, not `xyz`",
        ),
        ("nodlm", "5", "did you mean `nodlim`?"),
        #[cfg(feature = "pounce")]
        ("tol", "small", "a number above 0, not `small`"),
        #[cfg(feature = "pounce")]
        ("mu_oracle", "delphi", "not `delphi`"),
    ] {
        let message = refused(name, value).unwrap_or_default();
        assert!(message.contains(says), "{name}={value}: {message}");
    }
    for (name, value) in [
        ("lp_accuracy", "HIGH"),
        ("method", "simplex"),
        ("lemke_start", "automatic"),
        ("lp", "clarabel"),
        ("lp", "path"),
        ("nlp", "conopt"),
        ("nlp", "default"),
        ("nodlim", "5"),
        ("threads", "2"),
        ("reslim", "10"),
        ("without", "interval_proof, square_newton"),
    ] {
        assert_eq!(refused(name, value), None, "{name}={value}");
    }
}

/// `--option seed=N` does what the statement does.
#[test]
fn options_from_outside_are_those_of_statements() {
    let text = "Scalar u;  u = uniform(0,1);";
    let drawn = |text: &str, seed: &str| {
        let options = bmod::Options::default().option("seed", seed);
        let run = bmod::Model::from_text("m.gms", text).run(&options);
        run.value("u", []).expect("a number")
    };
    let stated = drawn(&format!("option seed = 7;\n{text}"), "3141");
    assert_eq!(drawn(text, "7"), stated);
    assert_ne!(drawn(text, "8"), stated);
}

/// Names and option files of a backend are those that it gives of itself, and options that mean nothing warn once.
#[test]
fn warnings_are_said_once() {
    let text = "option threads = 4, nlp = bmcp;  option threads = 2;
        binary variable x;  variable z;  equation e;  e.. z =e= x;  model m / e /;
        m.optfile = 1;  solve m using mip minimizing z;";
    let run = bmod::Model::from_text("m.gms", text).run(&bmod::Options::default());
    let said: Vec<&str> = run.diagnostics().iter().map(|d| &*d.message).collect();
    let want = [
        "the option `threads` means nothing here",
        "the solver `bmcp` does not solve nlp",
        "there is no option file `bmip.opt`: the defaults are used",
    ];
    assert_eq!(said, want);
}
