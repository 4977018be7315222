//! Options of solvers: what is refused wherever it stands, and the page that lists them.

use bmod::model::option::{OptionTable, page};
use bmod::run::Options;
use bmod::solve::registry::OPTION_TABLES;
use bmod::solve::strategy;
use std::path::Path;

const HEAD: &str = "# Options of solvers

`option NAME = VALUE;` in a model, `--option NAME=VALUE` on the command line, or a line `NAME VALUE` in an option file
(`m.optfile = 1` reads `path.opt` for mcp and cns, `pounce.opt` or `ipopt.opt` for the other types). A name that no solver has and a
value that an option does not take are errors. `bmod help options [SOLVER]` prints these tables. They are made from the
declarations in `src/solve/`.

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
`option without = NAME;` in a model (several names between quotes). `cargo bench --bench ablation` solves the corpora without each in turn
and prints what is lost; what loses nothing is deleted. This page is made from the table in `src/solve/strategy.rs`.

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
        ("reslim", "10"),
        ("without", "interval_proof, square_newton"),
    ] {
        assert_eq!(refused(name, value), None, "{name}={value}");
    }
}
