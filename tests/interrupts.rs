//! Interrupted runs say so: exit status 130, a whole report, what was computed until then.
#![cfg(target_os = "linux")]

use serde_json::Value;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Seconds from a signal to the end; what a busy machine needs beside is allowed for.
const WITHIN: f64 = 2.0 + 3.0;

/// Solves without end, a file, and statements behind the loop.
const SOLVES: &str =
    "Set k/1*100000/; Positive variable x; Variable z; Equation e, r; parameter res(k);
e.. z =e= x + 1; r.. x =g= 1; Model m / all /;
file f/o.txt/; put f 'first' /;
loop(k, solve m using lp minimizing z; res(k)=z.l; put k.tl z.l/;);
display 'done';
execute_unload 'o.gdx', res;
";

fn start(folder: &Path, arguments: &[&str]) -> Child {
    let mut child = Command::new(env!("CARGO_BIN_EXE_bmod"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("bmod runs");
    // The handler is there before the text is read: SIGTERM is the bit 14 of those that are caught.
    let status = format!("/proc/{}/status", child.id());
    let catches = || {
        let text = std::fs::read_to_string(&status).ok()?;
        let mask = text.lines().find_map(|l| l.strip_prefix("SigCgt:"))?;
        Some(u64::from_str_radix(mask.trim(), 16).ok()? >> 14 & 1 == 1)
    };
    while catches() == Some(false) {
        assert!(child.try_wait().expect("it is a child").is_none());
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

/// Sends a signal after a while; how it ended, and after how many seconds.
fn interrupt(child: Child, signal: &str, after: f64) -> (Output, f64) {
    // Nobody reads meanwhile what it prints: that is done on a thread.
    let id = child.id().to_string();
    let reader = std::thread::spawn(move || child.wait_with_output().expect("it ends"));
    std::thread::sleep(Duration::from_secs_f64(after));
    let sent = Command::new("kill").args([signal, &id]).status();
    assert!(sent.expect("there is `kill`").success(), "it had ended");
    let start = Instant::now();
    let output = reader.join().expect("no panic");
    (output, start.elapsed().as_secs_f64())
}

fn report(text: &[u8]) -> Value {
    serde_json::from_slice(text).expect("a whole report")
}

#[test]
fn a_loop_of_solves() {
    for (signal, after) in [
        ("-INT", 0.0),
        ("-INT", 0.5),
        ("-TERM", 0.0),
        ("-TERM", 0.1),
        ("-TERM", 0.5),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path();
        std::fs::write(path.join("m.blk"), SOLVES).expect("written");
        let child = start(path, &["run", "m.blk", "--quiet", "--json", "r.json"]);
        let (output, seconds) = interrupt(child, signal, after);
        let shown = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(130), "{signal} {after}: {shown}");
        assert!(seconds < WITHIN, "{signal} {after}: {seconds} s");
        let r = report(&std::fs::read(path.join("r.json")).expect("a report"));
        assert_eq!(r["status"], "interrupted");
        let list = r["diagnostics"].as_array().expect("a list");
        assert_eq!(list.len(), 1, "{list:?}");
        assert_eq!(
            (&list[0]["code"], shown.matches("E0492").count()),
            (&Value::from("E0492"), 1)
        );
        assert!(list[0]["line"].as_u64().is_some(), "{list:?}");
        assert!(
            r["displays"].as_array().is_some_and(Vec::is_empty) && !path.join("o.gdx").exists()
        );
        // What was put is kept, and said to be a part.
        let solves = r["solves"].as_array().expect("a list").len();
        assert!(after < 0.5 || solves > 0);
        if solves > 0 {
            let text = std::fs::read_to_string(path.join("o.txt")).expect("what was put");
            assert!(text.starts_with("first\n"), "{text}");
            assert_eq!(
                (&r["partial"][0], &r["files"][0]),
                (&"o.txt".into(), &"o.txt".into())
            );
        }
    }
}

#[test]
fn every_kind_of_work() {
    let square = "Set i / 1*700 /;  Alias(i,j);  Parameter a(i,j);  a(i,j) = uniform(0.1, 1);\n";
    let texts = [
        ("a while", "Scalar n / 0 /;  while(1, n = n + 1);".to_string()),
        ("a sum", "Set i / 1*3000 /;  Alias(i,j,k);  Scalar s;  s = sum((i,j,k), 1);".into()),
        ("displays", "Scalar n / 0 /;  while(1, display n;  n = n + 1);".into()),
        (
            "a system of equations",
            format!(
                "{square}Variable x(i);  Equation f(i);  f(i)..  sum(j, a(i,j)*sin(x(j))) + sqr(x(i)) =e= -10000;\n\
                 Model m / f /;  solve m using cns;"
            ),
        ),
        (
            "knapsacks",
            "Set i / i1*i120 /, k / k1*k30 /;  Parameter w(i,k), v(i);  w(i,k) = uniformInt(10, 99);\n\
             v(i) = round(sum(k, w(i,k))/card(k)) + uniformInt(1, 9);  Binary variable x(i);  Variable z;\n\
             Equations value, fits(k);  value.. z =e= sum(i, v(i)*x(i));  fits(k).. sum(i, w(i,k)*x(i)) =l= 2500;\n\
             Model m / all /;  option optCr = 0;  solve m using mip maximizing z;"
                .into(),
        ),
    ];
    for (name, text) in texts {
        for signal in ["-INT", "-TERM"] {
            let folder = tempfile::tempdir().expect("a folder");
            std::fs::write(folder.path().join("m.blk"), &text).expect("written");
            let child = start(folder.path(), &["run", "m.blk", "--quiet", "--json", "-"]);
            let (output, seconds) = interrupt(child, signal, 0.4);
            assert_eq!(output.status.code(), Some(130), "{name}");
            assert!(seconds < WITHIN, "{name}: {seconds} s");
            let r = report(&output.stdout);
            assert_eq!(r["status"], "interrupted", "{name}");
            let codes = r["diagnostics"].as_array().into_iter().flatten();
            let codes: Vec<_> = codes.map(|d| &d["code"]).collect();
            assert!(codes.contains(&&"E0492".into()), "{name}: {codes:?}");
        }
    }
}

#[test]
fn every_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let text = format!("Scalar n / 0 /;\n{SOLVES}*= card(k) 100000\n");
    std::fs::write(path.join("m.blk"), text).expect("written");
    let commands: [&[&str]; 9] = [
        &["why", "m.blk"],
        &["bench", "m.blk"],
        &["report", "m.blk", "--html", "r.html"],
        &["explain", "m.blk"],
        &["range", "m.blk"],
        &["dual", "m.blk"],
        &["test", "m.blk"],
        &["sweep", "m.blk", "-D", "n=1,2", "--out", "sweep"],
        &["watch", "m.blk"],
    ];
    for command in commands {
        let (output, seconds) = interrupt(start(path, command), "-TERM", 0.7);
        let shown = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(130), "{command:?}: {shown}");
        assert!(seconds < WITHIN, "{command:?}: {seconds} s");
        assert!(shown.contains("interrupted"), "{command:?}: {shown}");
        let out = String::from_utf8_lossy(&output.stdout);
        assert!(!out.contains("passed"), "{command:?}: {out}");
    }
    assert!(!path.join("r.html").exists());
}
