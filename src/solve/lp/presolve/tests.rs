//! Programs drawn at random with what the presolve looks for: the restored basis is optimal in the program as given.

use super::super::Ended;
use super::super::form::{Problem, Sparse};
use super::super::simplex::{Simplex, State};
use super::presolve;

struct Draw(u64);

impl Draw {
    /// An integer in 0 … n − 1.
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    fn number(&mut self) -> f64 {
        [1.0, -1.0, 2.0, 0.5, -3.0, 4.0][self.below(6) as usize]
    }
}

/// A program with a point: rows of one to four columns, some of them multiples of each other, and columns likewise.
fn drawn(seed: u64) -> Problem {
    let mut draw = Draw(seed);
    let (m, n) = (4 + draw.below(12) as usize, 4 + draw.below(12) as usize);
    let mut p = Problem::default();
    let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
    for i in 0..m {
        if i > 1 && draw.below(8) == 0 {
            let (twin, by) = (rows[i - 1].clone(), draw.number());
            rows.push(twin.iter().map(|&(j, a)| (j, a * by)).collect());
            continue;
        }
        let mut row: Vec<(usize, f64)> = Vec::new();
        for _ in 0..1 + draw.below(4) {
            let j = draw.below(n as u64) as usize;
            if row.iter().all(|e| e.0 != j) {
                row.push((j, draw.number()));
            }
        }
        row.sort_unstable_by_key(|e| e.0);
        rows.push(row);
    }
    let x: Vec<f64> = (0..n).map(|_| draw.below(7) as f64 - 1.0).collect();
    for &v in &x {
        let gap = |draw: &mut Draw| [0.0, 1.0, 5.0, f64::INFINITY][draw.below(4) as usize];
        p.lower.push(v - gap(&mut draw));
        p.upper.push(v + gap(&mut draw));
        p.cost
            .push([0.0, 0.0, 1.0, -1.0, 3.0][draw.below(5) as usize]);
    }
    p.rows = Sparse::new();
    for row in rows {
        let value: f64 = row.iter().map(|&(j, a)| a * x[j]).sum();
        let gap = |draw: &mut Draw| [0.0, 0.0, 2.0, f64::INFINITY][draw.below(4) as usize];
        let (low, high) = (value - gap(&mut draw), value + gap(&mut draw));
        p.row_lower.push(low);
        p.row_upper
            .push(if low == f64::NEG_INFINITY && high == f64::INFINITY {
                value
            } else {
                high
            });
        p.rows.push(row);
    }
    p.columns = p.rows.transpose(n);
    p
}

#[test]
fn restored_bases_are_optimal() {
    let (mut smaller, mut solved) = (0, 0);
    for seed in 0..3000 {
        let p = drawn(seed);
        let mut direct = Simplex::new(&p);
        let Some(reduced) = presolve(&p) else {
            continue;
        };
        smaller += 1;
        let mut simplex = Simplex::new(&reduced.problem);
        let ended = simplex.solve(&mut |_| None);
        match (direct.solve(&mut |_| None), ended) {
            (Ended::Solved, Ended::Solved) => {}
            (Ended::Solved, other) => panic!("{seed}: {other:?}"),
            (Ended::Unbounded(_), ended) => {
                assert!(ended != Ended::Solved, "{seed}");
                continue;
            }
            other => panic!("{seed}: {other:?}"),
        }
        solved += 1;
        let basis = simplex.basis();
        let (point, basis) = reduced.restore(&simplex.point().expect("a point"), &basis);
        let basic = basis.iter().filter(|s| **s == State::Basic).count();
        assert_eq!(basic, p.m(), "{seed}");
        let mut again = Simplex::new(&p);
        assert_eq!(
            again.solve_from_basis(&basis, &mut |_| None),
            Ended::Solved,
            "{seed}"
        );
        assert_eq!(again.iterations, 0, "{seed}");
        let value = |x: &[f64]| p.cost.iter().zip(x).map(|(c, x)| c * x).sum::<f64>();
        let best = value(&direct.point().expect("a point").x);
        assert!(
            (value(&point.x) - best).abs() < 1e-9,
            "{seed}: {} {best}",
            value(&point.x)
        );
    }
    assert!(smaller > 2000 && solved > 1000, "{smaller} {solved}");
}

/// Rows that contradict each other after some steps: the multipliers prove it of the program as given.
#[test]
fn proofs_of_infeasibility_come_back() {
    let (mut proved, mut at_once) = (0, 0);
    for seed in 0..3000 {
        let mut p = drawn(seed);
        let i = seed as usize % p.m();
        if p.row_lower[i].is_finite() {
            p.row_lower[i] += 3.0;
            p.row_upper[i] += 3.0;
        }
        let Some(reduced) = presolve(&p) else {
            continue;
        };
        if let Some(y) = &reduced.proof {
            at_once += 1;
            assert!(p.proves_infeasible(&reduced.restore_ray(y)), "{seed}");
            continue;
        }
        let ended = Simplex::new(&reduced.problem).solve(&mut |_| None);
        if let Ended::Infeasible(y) = ended {
            assert!(p.proves_infeasible(&reduced.restore_ray(&y)), "{seed}");
            proved += 1;
        }
    }
    assert!(proved > 50 && at_once > 0, "{proved} {at_once}");
}
