//! Numbers of the language that become a size, a position, a width or a count: whatever they are, the run ends soon, writes
//! little, and says what is wrong.

use bmod::{Model, Options};
use std::time::Instant;

const VALUES: [&str; 8] = ["na", "inf", "-inf", "eps", "undf", "-1", "1e300", "0"];

/// While a statement runs; `NUM` stands for the number. What must be finite is marked: E0400.
const STATEMENTS: &[(bool, &str)] = &[
    (true, "put @(NUM) 'q';"),
    (true, "put #(NUM) 'q';"),
    (true, "puttl #(NUM) 'q'; put 'x';"),
    (true, "put 1:(NUM):2;"),
    (true, "put 1:10:(NUM);"),
    (true, "put 'q':(NUM);"),
    (true, "put_utility 'log' / 1:(NUM):0;"),
    (true, "execError = NUM;"),
    (true, "maxExecError = NUM;"),
    (true, "execSeed = 1 + (NUM);"),
    (true, "n = ord('abc', NUM);"),
    (false, "for(n = 1 to 3 by NUM, break;);"),
    (false, "for(n = NUM to 3, break;);"),
    (false, "p(i) = p(i + (NUM));"),
    (false, "p(i) = p(i -- (NUM));"),
    (false, "n = round(1.5, NUM);"),
    (false, "n = power(2, NUM);"),
    (false, "n = fact(NUM);"),
    (false, "n = uniformInt(1, NUM);"),
    (false, "n = randBinomial(NUM, 0.5);"),
    (false, "n = sleep(NUM);"),
    (false, "n = jdate(NUM, 1, 1);"),
    (false, "n = jdate(2000, NUM, 1);"),
    (false, "n = jdate(2000, 1, NUM);"),
    (false, "n = gyear(NUM);"),
    (false, "n = handleStatus(NUM);"),
    (false, "n = handleCollect(NUM);"),
    (false, "n = handleDelete(NUM);"),
    (false, "n = binomial(NUM, 3);"),
    (false, "n = binomial(3, NUM);"),
    (false, "n = mod(3, NUM);"),
    (false, "m.iterLim = NUM; solve m using lp minimizing z;"),
    (false, "m.resLim = NUM; solve m using lp minimizing z;"),
    (false, "m.nodLim = NUM; solve m using mip minimizing z;"),
    (false, "m.domLim = NUM; solve m using nlp minimizing z;"),
    (false, "m.optFile = NUM; solve m using lp minimizing z;"),
    (false, "m.savePoint = NUM; solve m using lp minimizing z;"),
    (false, "m.solPrint = NUM; solve m using lp minimizing z;"),
    (false, "m.solveLink = NUM; solve m using lp minimizing z;"),
    (false, "m.bRatio = NUM; solve m using lp minimizing z;"),
    (
        false,
        "figure g { points(i) x = ord(i), y = 1, size = NUM; size width = NUM; }; draw g;",
    ),
    (
        false,
        "figure g { points(i) x = NUM, y = 1, width = NUM; xaxis min = NUM; }; draw g;",
    ),
];

/// Attributes of a `put` file.
const FILE: [&str; 26] = [
    "pw", "ps", "pc", "nd", "nw", "nr", "nz", "nj", "lj", "lw", "sj", "sw", "tj", "tw", "tf", "tm",
    "bm", "lm", "cc", "cr", "hdcc", "hdcr", "hdll", "tlcc", "ll", "case",
];

/// While the text is read.
const TEXTS: &[&str] = &[
    "option decimals = NUM; display n;",
    "option dispWidth = NUM; display n;",
    "option limRow = NUM;",
    "option seed = NUM;",
    "option iterLim = NUM;",
    "option p:NUM; display p;",
    "option p:3:NUM:1; display p;",
    "$maxCol NUM\n",
    "$minCol NUM\n",
    "$maxGoTo NUM\n",
    "$eval k NUM\nset s / s1*s%k% /;",
    "set s / 1*NUM /;",
    "while(1, break NUM;);",
];

fn run(statement: &str, value: &str) -> (Vec<String>, bool) {
    let text = format!(
        "$onUndf\nset i / 1*3 /; parameter p(i) / 1 1, 2 2 /; scalar n / 0 /;\nvariables x, z; equation e; x.lo = 1; e.. z =e= x;\n\
         model m / all /;\nfile f / 'o.txt' /; put f;\n{}\nput 'end' /;\n",
        statement.replace("NUM", value)
    );
    let start = Instant::now();
    let run = Model::from_text("m.gms", &text).run(&Options::default().time_limit(5.0));
    let seconds = start.elapsed().as_secs_f64();
    let written: usize = run.files().iter().map(|f| f.bytes.len()).sum();
    assert!(
        seconds < 10.0 && written < 2_000_000,
        "{statement} {value}: {seconds} s, {written} bytes"
    );
    let codes: Vec<String> = run
        .diagnostics()
        .iter()
        .map(|d| d.code.to_string())
        .collect();
    assert!(
        !codes.iter().any(|c| c == "E0499" || c == "E0490"),
        "{statement} {value}: {codes:?}"
    );
    (codes, run.succeeded())
}

#[test]
fn numbers_that_become_sizes() {
    let attributes: Vec<String> = FILE
        .iter()
        .map(|a| format!("f.{a} = NUM;  put 1 'q' /;"))
        .collect();
    let attributes = attributes.iter().map(|s| (true, s.as_str()));
    for (finite, statement) in STATEMENTS.iter().copied().chain(attributes) {
        for value in VALUES {
            let (codes, succeeded) = run(statement, value);
            let is_finite = ["eps", "-1", "1e300", "0"].contains(&value);
            // What is no number is an error; a number is cut to what there is.
            if finite && !is_finite {
                assert_eq!(
                    codes.first().map(String::as_str),
                    Some("E0400"),
                    "{statement} {value}"
                );
            }
            assert!(
                succeeded || !codes.is_empty(),
                "{statement} {value}: fails and says nothing"
            );
        }
    }
    for text in TEXTS {
        for value in VALUES {
            let (codes, succeeded) = run(text, value);
            assert!(
                succeeded || !codes.is_empty(),
                "{text} {value}: fails and says nothing"
            );
        }
    }
}
