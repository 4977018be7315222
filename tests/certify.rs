//! Proved intervals of the six walls of Ferris & Tin-Loi, from the command line as a person asks for
//! them.

use std::process::Command;

/// Load factors of the static theorem, to five digits (paper, table 1; Example 3 as recomputed).
const WALLS: [f64; 6] = [0.64286, 0.58000, 0.40369, 0.33195, 0.23964, 0.34782];

fn solves(wall: usize, method: &str) -> Vec<serde_json::Value> {
    let out = tempfile::tempdir().expect("a folder");
    let done = Command::new(env!("CARGO_BIN_EXE_bmod"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["run", &format!("models/walls/example{wall}.blk")])
        .args(["-D", "lponly=1", "--certify", "--json", "-", "--out"])
        .arg(out.path())
        .args(["--option", &format!("method={method}")])
        .output()
        .expect("bmod runs");
    let report: serde_json::Value = serde_json::from_slice(&done.stdout).expect("a report");
    report["solves"].as_array().expect("solves").clone()
}

fn bounds(solves: &[serde_json::Value]) -> Vec<[f64; 2]> {
    let end = |s: &serde_json::Value, k: usize| s["bounds"][k].as_f64().expect("a proved bound");
    solves.iter().map(|s| [end(s, 0), end(s, 1)]).collect()
}

#[test]
fn the_six_walls_are_proved() {
    for (k, paper) in WALLS.into_iter().enumerate() {
        let solved = solves(k + 1, "auto");
        let found = bounds(&solved);
        assert_eq!(found.len(), 2, "example {}", k + 1);
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for [l, h] in &found {
            assert!(l <= h && h - l <= 1e-9, "example {}: [{l}, {h}]", k + 1);
            assert!(l - 5e-6 <= paper && paper <= h + 5e-6, "example {}", k + 1);
            low = low.max(*l);
            high = high.min(*h);
        }
        // Both theorems bound the same number; their programs round their data alike.
        assert!(low <= high + 1e-12, "example {}", k + 1);
        // The same digits again.
        assert_eq!(found, bounds(&solves(k + 1, "auto")), "example {}", k + 1);
        // From the interior point to a vertex by pushes, which leave next to nothing to the simplex method.
        for s in &solves(k + 1, "crossover") {
            let count = |key: &str| s[key].as_u64().expect("a count");
            let (iterations, rows) = (count("iterations"), count("rows"));
            assert!(2 * iterations < rows, "example {}: {iterations}", k + 1);
        }
    }
}
