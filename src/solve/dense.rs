//! Linear instances that are written densely, for tests.

use crate::model::instance::{Columns, Instance, Relation, Sense};

const INF: f64 = f64::INFINITY;

/// A row: dense coefficients, relation, right-hand side.
pub(crate) type Row = (Vec<f64>, Relation, f64);

/// An instance whose last column z is the objective, defined by the last row `z - c'x =e= 0`.
pub(crate) fn linear(sense: Sense, cost: &[f64], bounds: &[(f64, f64)], rows: &[Row]) -> Instance {
    let mut instance = Instance {
        columns: columns(bounds),
        ..Instance::default()
    };
    let z = instance.add_column(-INF, INF, 0.0);
    instance.set_objective(z, sense);
    let definition: Vec<f64> = cost.iter().map(|&c| -c).chain([1.0]).collect();
    let all = rows
        .iter()
        .cloned()
        .chain([(definition, Relation::Equal, 0.0)]);
    for (coefficients, relation, rhs) in all {
        push_row(&mut instance, &coefficients, relation, rhs);
    }
    instance
}

/// Columns with these bounds, at level 0.
pub(crate) fn columns(bounds: &[(f64, f64)]) -> Columns {
    let mut out = Columns::default();
    for &(lower, upper) in bounds {
        out.push(lower, upper);
    }
    out
}

/// Appends a row given densely.
fn push_row(instance: &mut Instance, coefficients: &[f64], relation: Relation, rhs: f64) {
    instance.add_row(coefficients.iter().copied().enumerate(), relation, rhs);
}
