use super::*;
use crate::model::instance::{Relation, Sense};
use crate::solve::dense;
use crate::solve::lp::form::Form;

fn never(_: u64) -> Option<Ended> {
    None
}

#[test]
fn solves_and_restarts() {
    let instance = dense::linear(
        Sense::Maximize,
        &[3., 2.],
        &[(0., 8.), (0., f64::INFINITY)],
        &[(vec![1., 1.], Relation::Less, 10.)],
    );
    let form = Form::new(&instance).expect("valid");
    let mut s = Simplex::new(&form.problem);
    assert_eq!(s.solve(&mut never), Ended::Solved);
    let p = s.point().expect("a point");
    assert_eq!(p.x, [8.0, 2.0]);
    assert_eq!(p.y, [-2.0]);
    assert_eq!(p.d, [-1.0, 0.0]);
    let basis = s.basis();
    s.set_bounds(0, 0.0, 3.0);
    let before = s.iterations;
    assert_eq!(s.solve_from_basis(&basis, &mut never), Ended::Solved);
    assert_eq!(s.point().expect("a point").x, [3.0, 7.0]);
    s.set_cost(0, -1.0);
    assert_eq!(s.solve(&mut never), Ended::Solved);
    assert_eq!(s.point().expect("a point").x, [0.0, 10.0]);
    assert!(s.iterations - before <= 3);
}
