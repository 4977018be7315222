//! Programs with equilibrium constraints: instances with reference answers (`../shared/corpus/mpec`,
//! or the folder named by BMOD_SHARED; skipped, visibly, where it is not there), and the check of
//! stationarity from the language to the report.

use std::path::{Path, PathBuf};

use crate::common;
use bmod::report::json::SolveReport;

fn solves(file: &Path, allowed: &[PathBuf]) -> Vec<SolveReport> {
    let finished = common::run_file(file, allowed, common::quiet());
    for d in &finished.diagnostics {
        println!("{}: {}", file.display(), d.message);
    }
    finished.report.solves
}

/// A model of one's own, as text.
fn text(name: &str, model: &str) -> Vec<SolveReport> {
    let file = std::env::temp_dir().join(format!("bmod_mpec_{name}_{}.blk", std::process::id()));
    std::fs::write(&file, model).expect("a temporary file");
    let out = solves(&file, &[]);
    std::fs::remove_file(&file).expect("the temporary file is there");
    out
}

fn objective(s: &SolveReport) -> f64 {
    s.objective.map_or(f64::NAN, |o| o.0)
}

#[test]
fn corpus_is_feasible_and_as_good_as_the_reference() {
    let Some(folder) = common::shared("corpus") else {
        return;
    };
    let (mut count, mut infeasible, mut worse) = (0, Vec::new(), Vec::new());
    for row in common::records(&folder.join("reference.csv")) {
        if &row[2] != "MPEC" {
            continue;
        }
        count += 1;
        let want: f64 = row[4].parse().expect("an objective");
        let all = solves(&folder.join(&row[0]), &[]);
        let Some(s) = all.last() else {
            infeasible.push(format!("{}: no solve", &row[0]));
            continue;
        };
        let small = |r: Option<f64>| r.is_some_and(|r| r <= 1e-6);
        if !small(s.residual.primal) || !small(s.residual.complementarity) {
            infeasible.push(format!("{}: {:?}", &row[0], s.residual));
        }
        let sign = if s.sense == Some(bmod::Sense::Maximize) {
            -1.0
        } else {
            1.0
        };
        if sign * (objective(s) - want) > 1e-4 * want.abs().max(1.0) || s.model_status.code != 2 {
            let status = s.model_status.name;
            worse.push(format!(
                "{}: {} ({status}), the reference has {want}",
                &row[0],
                objective(s)
            ));
        }
    }
    assert!(count > 20, "{count} instances");
    assert!(infeasible.is_empty(), "{}", infeasible.join("\n"));
    assert!(worse.is_empty(), "{}", worse.join("\n"));
}

const CORNER: &str = "positive variables x, y; variable f; equations obj, g;
obj.. f =e= sqr(x - 1) + sqr(y - 1);
g.. y =g= 0;
model m / obj, g.x /;
option mpec_method = check;
";

#[test]
fn the_corner_is_refuted_with_a_direction() {
    let all = text(
        "corner",
        &format!("{CORNER} solve m using mpec minimizing f;"),
    );
    let [s] = &all[..] else { panic!("{all:?}") };
    assert_eq!(s.stationarity, Some("refuted"));
    assert_eq!(s.model_status.code, 7, "feasible, not more");
    assert_eq!(objective(s), 2.0, "the point is left as it was");
    let message = s.message.clone().unwrap_or_default();
    assert!(
        message.contains("slope -2") && (message.contains("x +1") || message.contains("y +1")),
        "{message}"
    );
}

#[test]
fn an_end_of_the_corner_is_proved() {
    let all = text(
        "end",
        &format!("{CORNER} x.l = 1; solve m using mpec minimizing f;"),
    );
    let [s] = &all[..] else { panic!("{all:?}") };
    assert_eq!(s.stationarity, Some("proved"));
    assert_eq!(s.model_status.code, 2);
    assert_eq!(objective(s), 1.0);
}

#[test]
fn the_search_goes_on_from_a_corner() {
    for method in ["auto", "relaxation"] {
        let all = text(
            method,
            &format!("{CORNER} option mpec_method = {method}; solve m using mpec minimizing f;"),
        );
        let [s] = &all[..] else { panic!("{all:?}") };
        assert_eq!(s.stationarity, Some("proved"), "{method}");
        assert!(
            (objective(s) - 1.0).abs() < 1e-9,
            "{method}: {}",
            objective(s)
        );
        assert_eq!(s.complementarity_sum, Some(0.0), "{method}");
    }
}

#[test]
fn options_are_checked() {
    for (option, word) in [
        ("mpec_method = simplex", "mpec_method"),
        ("mpec_bound = some", "mpec_bound"),
        ("mpec_factor = 2", "mpec_factor"),
    ] {
        let all = text(
            "options",
            &format!("{CORNER} option {option}; solve m using mpec minimizing f;"),
        );
        assert!(all.iter().all(|s| s.solver.is_empty()), "{word}: {all:?}");
    }
}

/// A wall of two courses on the ground, by the generic model.
fn small_wall(friction: f64, then: &str) -> Vec<SolveReport> {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    let model = format!(
        "$set friction {friction}
Sets course / k1*k2 /, pos / p1*p3 /;
Table len(course,pos)
         p1    p2    p3
   k2     1     1
   k1   0.5     1   0.5;
$include {}
{then}",
        models.join("block_limit.blk").display()
    );
    let folder = std::env::temp_dir().join(format!(
        "bmod_mpec_wall_{}_{}",
        std::process::id(),
        then.len()
    ));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let file = folder.join("wall.blk");
    std::fs::write(&file, model).expect("a temporary file");
    let out = solves(&file, &[models]);
    std::fs::remove_dir_all(&folder).expect("the temporary folder is there");
    out
}

#[test]
fn supports_and_relaxation_agree_on_a_small_wall() {
    let all = small_wall(
        0.65,
        "solve static using lp maximizing alpha;
option mpec_swaps = yes;
solve least using mpec minimizing alpha;
option mpec_method = relaxation;
solve least using mpec minimizing alpha;",
    );
    let [lp, pieces, relaxed] = &all[..] else {
        panic!("{all:?}")
    };
    assert_eq!(pieces.stationarity, Some("proved"));
    assert_eq!(pieces.model_status.code, 2);
    assert!(pieces.complementarity_sum.is_some_and(|s| s <= 1e-10));
    assert!(pieces.residual.primal.is_some_and(|r| r <= 1e-9));
    assert!(objective(pieces) <= objective(lp) + 1e-9);
    assert!(objective(pieces) <= objective(relaxed) + 1e-7);
    assert!(relaxed.complementarity_sum.is_some_and(|s| s <= 1e-10));
}

/// With much friction the whole wall slides at 1.2; that one end of it overturns at 40/49 is far from there.
/// `bound.blk -D friction=1.2` proves that nothing is below.
#[test]
fn a_local_mechanism_is_found_where_friction_is_high() {
    let all = small_wall(
        1.2,
        "option mpec_swaps = yes; solve least using mpec minimizing alpha;",
    );
    let [s] = &all[..] else { panic!("{all:?}") };
    assert!(
        (objective(s) - 40.0 / 49.0).abs() < 1e-9,
        "{}",
        objective(s)
    );
}

/// The paper's walls by `using mpec`. The sixth takes longer than a test should: `models/table1.sh` has all six.
#[test]
fn load_factors_are_not_above_the_paper() {
    for (k, printed) in [
        (1, 0.63898),
        (2, 0.55742),
        (3, 0.35582),
        (4, 0.26374),
        (5, 0.20863),
    ] {
        let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
        let file = std::env::temp_dir().join(format!("bmod_least_{k}_{}.blk", std::process::id()));
        let text = format!(
            "$set scene 1\n$include {}\noption mpec_swaps = yes;\nsolve least using mpec minimizing alpha;",
            models.join(format!("walls/example{k}.blk")).display()
        );
        std::fs::write(&file, text).expect("a temporary file");
        let all = solves(&file, &[models]);
        std::fs::remove_file(&file).expect("the temporary file is there");
        let [s] = &all[..] else { panic!("{all:?}") };
        assert!(objective(s) <= printed + 5e-6, "{k}: {}", objective(s));
        assert!(s.complementarity_sum.is_some_and(|p| p <= 1e-10), "{k}");
        assert!(s.residual.primal.is_some_and(|r| r <= 1e-9), "{k}");
        assert_eq!(s.stationarity, Some("proved"), "{k}");
        let message = s.message.clone().unwrap_or_default();
        assert!(
            message.contains("no single swap of supports improves"),
            "{k}: {message}"
        );
    }
}

/// The only other local minimum of the branch y = 0 is (1, 0), with the value 1; no direction leads from it to (0, 1).
#[test]
fn a_swap_leads_to_the_better_piece() {
    for method in ["auto", "relaxation", "pieces"] {
        let all = text(
            "swap",
            &format!(
                "Positive Variables x, y; Variable f; Equations cost, F_x;
cost.. f =e= 0.5*sqr(x - 1) + sqr(y - 1);
F_x.. x =g= 0;
Model m / cost, F_x.y /; x.l = 1; option mpec_method = {method}, mpec_starts = 0, mpec_swaps = yes;
solve m using mpec minimizing f;"
            ),
        );
        let [s] = &all[..] else { panic!("{all:?}") };
        assert!(
            (objective(s) - 0.5).abs() < 1e-8,
            "{method}: {}",
            objective(s)
        );
        assert_eq!(s.stationarity, Some("proved"), "{method}");
        let message = s.message.clone().unwrap_or_default();
        assert!(message.contains("no single swap of pieces"), "{message}");
    }
}

/// All forty pairs are biactive at the solution and none is with another in a row: 2⁴⁰ branches together, two each.
#[test]
fn pairs_that_do_not_meet_are_searched_by_themselves() {
    let all = text(
        "apart",
        "Set i / 1*40 /; Positive Variables y(i); Variable f; Equations cost, F_y(i);
cost.. f =e= sum(i, sqr(y(i) - 2));
F_y(i).. y(i) =g= 0;
Model m / cost, F_y.y /; solve m using mpec minimizing f;",
    );
    let [s] = &all[..] else { panic!("{all:?}") };
    assert_eq!(s.stationarity, Some("proved"));
    assert!((objective(s) - 160.0).abs() < 1e-6, "{}", objective(s));
}
