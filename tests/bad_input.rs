//! Bad input: what a person sees, as snapshots. None may panic, name a Rust type, or leave a file.

use std::path::{Path, PathBuf};

use crate::common;
use bmod::diag::Diagnostic;
use bmod::host::{Found, Host, HostError};
use bmod::report::diagnostics::{Look, render};
use bmod::run::Options;

/// One text; an include that includes itself; a file that is not UTF-8; everything printed is kept.
struct Bench {
    text: String,
    printed: String,
}

impl Host for Bench {
    fn read(&mut self, path: &str, _: Option<&Path>) -> Found<String> {
        match path {
            "model.blk" => Ok((path.into(), self.text.clone())),
            "self.inc" => Ok((path.into(), "$include self.inc\n".into())),
            "latin.inc" => Err(HostError::NotUtf8(17)),
            "/etc/passwd" => Err(HostError::Outside("/etc/passwd".into())),
            _ => Err(HostError::NotFound),
        }
    }
    fn exists(&mut self, _: &str, _: Option<&Path>) -> bool {
        false
    }
    fn write(&mut self, path: &str, _: &[u8]) -> Result<PathBuf, HostError> {
        panic!("{path} was written")
    }
    fn print(&mut self, text: &str) {
        self.printed.push_str(text);
    }
}

/// Exit status, and what is shown.
fn shown(text: &str) -> String {
    let mut host = Bench {
        text: text.to_string(),
        printed: String::new(),
    };
    let finished = common::run(&mut host, "model.blk", Options::default());
    let diagnostics: &[Diagnostic] = &finished.diagnostics;
    let look = Look {
        width: 90,
        ..Look::plain()
    };
    // Times and iterations differ from machine to machine.
    let printed: Vec<&str> = host
        .printed
        .lines()
        .filter(|l| !l.contains("iterations"))
        .collect();
    format!(
        "exit {}\n{}\n{}",
        finished.end.exit(),
        render(diagnostics, &finished.map, look),
        printed.join("\n")
    )
}

const WALL: &str = "set i / a, b, c /, j / x, y /;\nparameter p(i) / a 1, b 2 /, q(i,j) / a.x 1 /;\nvariable v(i), z;\nequation e(i), obj;\n";

fn cases() -> Vec<(&'static str, String)> {
    let after = |rest: &str| format!("{WALL}{rest}");
    let model = "obj.. z =e= sum(i, v(i));\ne(i).. v(i) =g= p(i);\nmodel m / all /;\n";
    vec![
        ("unknown_symbol", after("scalar s; s = sum(i, pp(i));\n")),
        ("wrong_number_of_indices", after("scalar s; s = sum(i, q(i));\n")),
        ("label_not_in_set", after("scalar s; s = p('d');\n")),
        ("label_not_in_set_in_data", "set i / apple, pear /;\nparameter p(i) / appel 3 /;\n".into()),
        ("index_not_under_control", after("scalar s; s = p(i);\n")),
        ("index_controlled_twice", after("loop(i, p(i) = sum(i, p(i)));\n")),
        ("missing_semicolon", after("scalar s\ns = 3;\n")),
        ("unbalanced_parenthesis", after("scalar s; s = sum(i, p(i);\n")),
        ("equals_for_equation", after("obj.. z = sum(i, v(i));\n")),
        ("less_or_equal_in_equation", after("e(i).. v(i) <= p(i);\n")),
        ("level_forgotten", after("scalar s; s = v('a');\n")),
        ("variable_in_condition", after("obj.. z =e= sum(i$(v(i) > 1), v(i));\n")),
        ("nonlinear_in_lp", after("obj.. z =e= sum(i, v(i)*v(i));\nmodel m / obj /;\nsolve m using lp minimizing z;\n")),
        ("duplicate_data", "set i / a, b /;\nparameter p(i) / a 1, b 2, a 3 /;\n".into()),
        ("division_by_zero", after("scalar s; s = 1/p('c');\n")),
        ("value_under_no_column", "set i / a, b /, j / x, y /;\ntable t(i,j)\n      x    y\na     1    2\nb          3         4\n;\n".into()),
        ("objective_missing", after(&format!("{model}solve m using lp;\n"))),
        ("objective_indexed", after(&format!("{model}solve m using lp minimizing v;\n"))),
        ("objective_signed", format!("{}positive variable w;\n{model}solve m using lp minimizing w;\n", WALL)),
        ("equation_not_defined", after("obj.. z =e= 1;\nmodel m / obj, e /;\nsolve m using lp minimizing z;\n")),
        ("empty_set", "set i;\nscalar s;\ns = sum(i, 1);\n".into()),
        ("include_not_there", "$include nothing.inc\n".into()),
        ("include_of_itself", "$include self.inc\n".into()),
        ("include_not_utf8", "$include latin.inc\n".into()),
        ("include_outside", "$include /etc/passwd\n".into()),
        ("empty_file", String::new()),
        ("nested_parentheses", format!("scalar s; s = {}1{};\n", "(".repeat(100_000), ")".repeat(100_000))),
        ("numbers_out_of_range", "scalar a / 1e299 /, b;\nb = a*1e10;\nparameter p(*) / x 1e /;\n".into()),
        ("overflow", "scalar a / 1e299 /, b;\nb = a*1e10;\n".into()),
        ("infeasible", after("obj.. z =e= sum(i, v(i));\ne(i).. v(i) =g= 3;\nv.up(i) = 2;\nmodel m / all /;\nsolve m using lp minimizing z;\n")),
        ("unbounded", after(&format!("{model}solve m using lp maximizing z;\n"))),
        ("crossed_bounds", after(&format!("{model}v.lo(i) = 3; v.up(i) = 2;\nsolve m using lp minimizing z;\n"))),
        ("several_at_once", after("scalar s; s = pp('a');\ns = q('a');\ns = p('zz');\n")),
        ("neighbour_double_equal", after("obj.. z == sum(i, v(i));\n")),
        ("neighbour_double_and", after("scalar a / 1 /;\na = a && 1;\n")),
        ("neighbour_subject_to", after("subject to c1: z >= 2;\n")),
        ("neighbour_var", "var x >= 0;\n".into()),
        ("neighbour_for_in", after("for i in 1..3 {\n   z = 1;\n}\n")),
        ("neighbour_hash_comment", "# a comment\nscalar a / 1 /;\n".into()),
        ("neighbour_missing_dots", after("obj z =e= sum(i, v(i));\n")),
        ("neighbour_python_indentation", "scalar a / 1 /, b;\nif a > 1:\n    b = 2\nelse:\n    b = 3\n".into()),
        ("neighbour_ampl", "set PROD;\nparam cost{PROD} >= 0;\nvar make{PROD} >= 0;\nmaximize profit: sum{p in PROD} cost[p]*make[p];\n".into()),
        ("neighbour_ampl_data", "param n := 4;\nset I := a b c;\n".into()),
        ("neighbour_minizinc", "int: n = 4;\narray[1..n] of var int: x;\nconstraint x[1] <= 4;\nsolve minimize x[1];\n".into()),
        ("neighbour_braces", "scalar a / 1 /;\nwhile (a < 3) { a = a + 1 }\n".into()),
        ("neighbour_caret", "scalar a / 1 /;\na = a^2;\n".into()),
        ("neighbour_plus_assign", "scalar a / 1 /;\na += 2;\n".into()),
        ("call_refused", "$call rm -rf everything\nexecute 'rm -rf everything';\n".into()),
    ]
}

#[test]
fn bad_input_is_explained() {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    for (name, text) in cases() {
        let out = shown(&text);
        for forbidden in ["Some(", "None,", "::", "Vec<", "panicked", "unwrap"] {
            assert!(!out.contains(forbidden), "{name} shows {forbidden}:\n{out}");
        }
        settings.bind(|| insta::assert_snapshot!(name, out));
    }
}

#[test]
fn a_parameter_of_50_mb_is_read() {
    let mut text = String::with_capacity(52 << 20);
    text.push_str("set i / i1*i2000 /, j / j1*j2000 /;\nparameter p(i,j) /\n");
    let mut records = 0;
    'all: for i in 1..=2000 {
        for j in 1..=2000 {
            use std::fmt::Write;
            writeln!(text, "i{i}.j{j} {}.25", i + j).expect("a String takes all");
            records += 1;
            if text.len() > 50 << 20 {
                break 'all;
            }
        }
    }
    text.push_str("/;\nscalar n; n = card(p);\nabort$(n <> ");
    text.push_str(&records.to_string());
    text.push_str(") 'records are missing', n;\n");
    assert!(shown(&text).starts_with("exit 0"));
}

#[test]
fn what_no_model_lists_costs_nothing() {
    let core = "variable z; positive variable x; equation obj, c; obj.. z =e= x; c.. x =g= 1;\nmodel m / obj, c /; solve m using lp minimizing z;\n";
    let unused = "set a / a1*a100 /; alias(a, b, d);\nvariable u(a,b,d); equation eu(a,b,d);\neu(a,b,d).. u(a,b,d) =g= sum(a1(a), 1) + 1;\n";
    let counts = |text: &str| {
        let mut host = Bench {
            text: text.to_string(),
            printed: String::new(),
        };
        let f = common::run(&mut host, "model.blk", Options::default());
        let messages: Vec<String> = f.diagnostics.iter().map(|d| d.message.clone()).collect();
        assert_eq!(messages, Vec::<String>::new());
        let s = &f.report.solves[0];
        (s.rows, s.columns, s.nonzeros)
    };
    let unused = unused.replace("sum(a1(a), 1) + 1", "1");
    assert_eq!(counts(core), counts(&format!("{unused}{core}")));
}

/// A damaged GDX file ends in an error or gives other data; no panic, and no memory beyond the file's.
#[test]
fn damaged_gdx_files() {
    let all = |bytes: &[u8]| {
        let file = bmod::gdx::File::open(bytes)?;
        (0..file.symbols.len()).try_for_each(|n| file.records(n).map(drop))
    };
    for name in ["gams", "gams_packed", "gams_relaxed"] {
        let path = format!("tests/suite/exchange/{name}.gdx");
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
        let mut bytes = std::fs::read(path).expect("the file");
        assert!(all(&bytes).is_ok());
        for n in 0..bytes.len() {
            assert!(all(&bytes[..n]).is_err(), "{n} bytes are enough");
        }
        for n in 0..bytes.len() {
            for flip in [0x01, 0x80, 0xff] {
                bytes[n] ^= flip;
                let _ = all(&bytes);
                bytes[n] ^= flip;
            }
        }
    }
}
