//! Nothing goes wrong without a word: output that is lost, defines that nothing reads, files that are not written.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// Exit status, standard output and standard error.
fn bmod(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let out = Command::new(env!("CARGO_BIN_EXE_bmod"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("bmod runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        out.status.code().unwrap_or(-1),
        text(&out.stdout),
        text(&out.stderr),
    )
}

fn with(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.gms"), text).expect("written");
    folder
}

#[test]
fn a_define_that_nothing_reads() {
    let folder = with("$if not set hours $set hours 8\nscalar h / %hours% /; display h;\n");
    for command in ["run", "check"] {
        let (status, _, shown) = bmod(folder.path(), &[command, "m.gms", "-D", "hour=80"]);
        assert_eq!((status, shown.matches("E0117").count()), (0, 1), "{shown}");
        assert!(
            shown.contains("-D hour") && shown.contains("did you mean `-D hours`?"),
            "{shown}"
        );
        let (_, _, shown) = bmod(folder.path(), &[command, "m.gms", "-D", "hours=80"]);
        assert!(!shown.contains("E0117"), "{shown}");
    }
}

#[test]
fn early_files_outside() {
    for text in [
        "$echo lost > ../e.txt\n$include ../e.txt\n",
        "$onEcho > ../e.txt\nscalar q;\n$offEcho\n",
        "set i / a /;\n$gdxOut ../e.gdx\n$unload i\n$gdxOut\n",
    ] {
        let folder = with(&format!(
            "scalar lost / 1 /;\n{}",
            text.replace("echo lost", "echo display lost;")
        ));
        let (status, out, shown) = bmod(folder.path(), &["run", "m.gms"]);
        assert_eq!(
            (status, shown.matches("E0476").count()),
            (0, 1),
            "{text}{shown}"
        );
        assert!(
            shown.contains("../e.") && shown.contains("m.gms:") && !out.contains("written"),
            "{shown}"
        );
        let up = folder.path().parent().expect("a folder");
        assert!(!up.join("e.txt").exists() && !up.join("e.gdx").exists());
    }
}

#[cfg(unix)]
#[test]
fn early_files_that_cannot_be_written() {
    // A file stands where a folder is asked for.
    let folder = with("$echo lost > m.gms/e.txt\nscalar a;\n");
    let (status, _, shown) = bmod(folder.path(), &["run", "m.gms"]);
    assert_eq!((status, shown.matches("E0470").count()), (3, 1), "{shown}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device() {
    let folder = with(
        "variable x, z; equation e; e.. z =e= x; x.lo = 1; model m / all /; solve m using lp minimizing z; display x.l;\n*= z 1\n",
    );
    let commands: [&[&str]; 12] = [
        &["run", "m.gms"],
        &["run", "m.gms", "--json", "-"],
        &["run", "m.gms", "--solution", "-"],
        &["check", "m.gms"],
        &["why", "m.gms"],
        &["explain", "m.gms"],
        &["show", "m.gms"],
        &["dual", "m.gms"],
        &["list", "m.gms"],
        &["test", "m.gms"],
        &["bench", "m.gms"],
        &["completions", "bash"],
    ];
    for command in commands {
        let full = fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .expect("there");
        let out = Command::new(env!("CARGO_BIN_EXE_bmod"))
            .args(command)
            .current_dir(folder.path())
            .stdout(full)
            .output()
            .expect("bmod runs");
        let shown = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(3), "{command:?}: {shown}");
        assert!(
            shown.contains("the output could not be written"),
            "{command:?}: {shown}"
        );
        // A reader that has gone away is no error.
        let mut child = Command::new(env!("CARGO_BIN_EXE_bmod"))
            .args(command)
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("bmod runs");
        drop(child.stdout.take());
        assert_eq!(
            child.wait().expect("it ends").code(),
            Some(0),
            "{command:?}"
        );
    }
}

#[test]
fn errors_by_assignment() {
    for (text, status) in [
        ("execError = 5;\n", 3),
        ("execError = 5; execError = 0;\n", 0),
        (
            "execError = 5;\nvariable x, z; equation e; e.. z =e= x; x.lo = 1; model m / all /; solve m using lp minimizing z;\n",
            3,
        ),
        ("maxExecError = 9; execError = 5;\n", 0),
    ] {
        let folder = with(text);
        let (is, _, shown) = bmod(folder.path(), &["run", "m.gms"]);
        assert_eq!(
            (is, shown.matches("E0485").count()),
            (status, usize::from(status == 3)),
            "{text}{shown}"
        );
    }
}

#[test]
fn an_alias_of_nothing() {
    let (status, _, shown) = bmod(with("set i / a /; alias(i);\n").path(), &["check", "m.gms"]);
    assert_eq!((status, shown.matches("E0380").count()), (0, 1), "{shown}");
    let (status, _, shown) = bmod(with("scalar p; alias(p);\n").path(), &["check", "m.gms"]);
    assert_eq!((status, shown.matches("E0337").count()), (2, 1), "{shown}");
}

/// Writes in every way, after a solve.
const WRITES: &str = "$echo early > early.txt
set i / a /; parameter r(i); variable x, z; equation e; e.. z =e= x; x.lo = 1; model m / all /; solve m using lp minimizing z;
r(i) = z.l; file f / put.txt /; put f z.l; putclose; execute_unload 'r.gdx', r;
figure g { points(i) x = 1, y = z.l; }; draw g;
";

#[test]
fn only_a_run_writes_files_of_the_model() {
    let folder = with(WRITES);
    let (status, _, shown) = bmod(folder.path(), &["run", "m.gms"]);
    assert_eq!(status, 0, "{shown}");
    let files = || {
        let mut all: Vec<_> = fs::read_dir(folder.path())
            .expect("listed")
            .map(|f| f.expect("a file").path())
            .map(|p| (p.clone(), fs::read(p).expect("read")))
            .collect();
        all.sort();
        all
    };
    let before = files();
    assert!(before.len() >= 4, "{before:?}");
    for command in [
        "list", "check", "why", "explain", "show", "dual", "kkt", "range",
    ] {
        let (status, _, shown) = bmod(folder.path(), &[command, "m.gms"]);
        assert_eq!(status, 0, "{command}: {shown}");
        assert_eq!(files(), before, "{command}");
    }
}

#[test]
fn a_listing_that_needs_a_solve() {
    let model = "set k / 1*3 /; parameter c / 1 /, old / 0 /; variable x, z; equation e; e.. z =e= c*x; x.lo = 1;\nmodel m / all /;\n";
    let solve = "solve m using lp minimizing z;";
    for (text, line, generated) in [
        // It waits for a status, a level, what was computed from a level.
        (
            format!("m.modelStat = 0;\nwhile(m.modelStat <> 1,\n{solve} );"),
            4,
            1,
        ),
        (format!("repeat\n{solve}\nuntil z.l > 0;"), 5, 1),
        (format!("repeat {solve} old = z.l;\nuntil old > 0;"), 4, 1),
        (format!("while(1, {solve}\nif(z.l > 0, break); );"), 4, 1),
        // Another model: its data, its bounds.
        (format!("{solve} c = z.l + 1;\n{solve}"), 4, 2),
        (format!("{solve} x.lo = z.l + 1;\n{solve}"), 4, 2),
        // It waits for nothing.
        (
            format!("{solve} loop(k, {solve} old = z.l; display old;);"),
            0,
            4,
        ),
        (
            format!("scalar n / 0 /; while(n < 3, n = n + 1; c = n; {solve});"),
            0,
            3,
        ),
    ] {
        let folder = with(&format!("{model}{text}\n"));
        let (status, out, shown) = bmod(folder.path(), &["list", "m.gms"]);
        assert_eq!(status, 0, "{text}{shown}");
        let said = shown.matches("E0434").count();
        assert_eq!(said, usize::from(line > 0), "{text}{shown}");
        assert!(
            line == 0 || shown.contains(&format!("m.gms:{line}:")),
            "{text}{shown}"
        );
        assert_eq!(
            out.matches("e:").count().max(out.matches("e  ").count()),
            generated,
            "{text}{out}"
        );
    }
}
