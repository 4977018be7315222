//! `bmod watch` on a terminal.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

/// What is on the screen while it waits: all that was written behind the last clearing.
fn screen(lines: &mut impl Iterator<Item = String>) -> String {
    let mut shown = String::new();
    for line in lines {
        shown.push_str(&line);
        shown.push('\n');
        if line.contains("waiting for a change") {
            break;
        }
    }
    shown.rsplit("\x1b[2J").next().unwrap_or("").to_string()
}

#[test]
fn the_answer_stays_on_the_screen() {
    // The terminal is that of util-linux.
    if Command::new("script").arg("--version").output().is_err() {
        println!("SKIPPED: there is no `script`");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("m.blk");
    let text = |least: u32| {
        format!(
            "variable x, z; equation o; o.. z =e= x; x.lo = {least};\nmodel m / all /; solve m using lp minimizing z;\n"
        )
    };
    std::fs::write(&file, text(3)).expect("the model is written");
    let watch = format!("{} watch m.blk", env!("CARGO_BIN_EXE_bmod"));
    let mut child = Command::new("script")
        .args(["-qefc", &watch, "/dev/null"])
        .current_dir(folder.path())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .expect("it starts");
    let out = BufReader::new(child.stdout.take().expect("a pipe"));
    let mut lines = out.lines().map_while(Result::ok);
    let first = screen(&mut lines);
    // Saved again, later than before by the clock of the files.
    std::thread::sleep(std::time::Duration::from_millis(50));
    std::fs::write(&file, text(4)).expect("the model is written");
    let second = screen(&mut lines);
    let _ = child.kill();
    let _ = child.wait();
    for (shown, least) in [(first, "3"), (second, "4")] {
        assert!(
            shown.contains("optimal") && shown.contains(least),
            "{shown}"
        );
    }
}
