//! Walls of blocks straight through the complementarity solver: large ones are in `benches/mcp.rs`.

use crate::walls::wall;
use bmod::solve::mcp::{Outcome, Settings, Status, solve};
use bmod::solve::{Budget, Quiet};

fn run(courses: usize, width: usize, friction: f64, associated: bool) -> Outcome {
    let outcome = solve(
        &mut wall(courses, width, friction, associated),
        &Settings::default(),
        &Budget::unlimited(&mut Quiet::default()),
        &|i| (i + 1).to_string(),
    );
    assert_eq!(outcome.status, Status::Solved);
    assert!(outcome.residual <= 1e-9, "{}", outcome.residual);
    outcome
}

#[test]
fn the_first_example_of_the_paper() {
    // With the associated flow rule (7) is the pair of linear programs (8), (9).
    let associated = run(6, 5, 0.65, true);
    assert!(
        (associated.x[0] - 0.642859003).abs() < 1e-9,
        "{}",
        associated.x[0]
    );
    let nonassociated = run(6, 5, 0.65, false);
    assert!(nonassociated.x[0] <= associated.x[0] + 1e-9 && nonassociated.x[0] > 0.638);
}

/// Large enough for the interior crash, which ends inside a face of solutions.
#[test]
fn a_large_wall_has_the_load_factor_of_the_linear_program() {
    let associated = run(15, 8, 0.65, true);
    assert!(
        (associated.x[0] - 0.534027271).abs() < 1e-9,
        "{}",
        associated.x[0]
    );
    let nonassociated = run(15, 8, 0.65, false);
    assert!(nonassociated.x[0] < associated.x[0]);
}

/// Far from monotone: the interior crash meets folds of its path, and goes around them.
#[test]
fn a_wall_whose_path_has_folds() {
    let outcome = run(8, 8, 1.0, false);
    assert!(outcome.x[0] < run(8, 8, 1.0, true).x[0]);
    assert!(outcome.pivots < 100, "{} pivots", outcome.pivots);
}
