//! What the shape of a program says: linear, quadratic and convex, or neither.

use crate::autodiff::{Degree, Evaluator};
use crate::model::instance::{Instance, Relation};
use crate::solve::nlp::quadratic::is_semidefinite;

/// The shape of a program.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// All rows are linear.
    Linear,
    /// Linear rows, and a quadratic objective whose Hessian says that it is convex (of a maximum: concave).
    ConvexQuadratic(Objective),
    /// Linear rows and a quadratic objective that is not convex.
    Quadratic,
    /// This row is to blame.
    Nonlinear(usize),
}

/// A quadratic objective function `constant + gᵀx + ½ xᵀHx`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Objective {
    /// The row that defines it.
    pub row: usize,
    /// Its value at 0.
    pub constant: f64,
    /// Its gradient at 0, by column; 0 of the objective variable.
    pub gradient: Vec<f64>,
    /// Entries of its Hessian: row, column, value, both triangles.
    pub hessian: Vec<(usize, usize, f64)>,
}

/// The shape of an instance.
pub fn shape(p: &Instance) -> Shape {
    if p.is_linear() {
        return Shape::Linear;
    }
    let mut e = Evaluator::new(p);
    let degrees = e.degrees();
    let nonlinear = |i: &usize| degrees[*i] != Degree::Linear;
    let mut list = (0..p.row_count()).filter(nonlinear);
    let (first, second) = (list.next().unwrap_or(0), list.next());
    let z = p.objective.map(|o| o.column as usize);
    let defines =
        p.rows.relation[first] == Relation::Equal && p.matrix.row(first).any(|(j, _)| Some(j) == z);
    let quadratic = degrees[first] == Degree::Quadratic;
    if second.is_some() || !defines || !quadratic {
        return Shape::Nonlinear(second.filter(|_| defines && quadratic).unwrap_or(first));
    }
    let Some(f) = z.and_then(|z| at_origin(p, &mut e, first, z)) else {
        return Shape::Nonlinear(first);
    };
    let sign = p.sign();
    let lower = f.hessian.iter().filter(|e| e.0 >= e.1);
    let lower: Vec<_> = lower.map(|&(i, j, v)| (i, j, sign * v)).collect();
    match is_semidefinite(p.column_count(), &lower) {
        true => Shape::ConvexQuadratic(f),
        false => Shape::Quadratic,
    }
}

/// The function that a row defines for a column: value, gradient and Hessian at 0.
pub fn at_origin(p: &Instance, e: &mut Evaluator, row: usize, z: usize) -> Option<Objective> {
    let n = p.column_count();
    let x = vec![0.0; n];
    let mut activity = vec![0.0; p.row_count()];
    e.rows(&x, &mut activity).ok()?;
    let (start, column) = e.jacobian_pattern();
    let (range, column) = (start[row]..start[row + 1], column.to_vec());
    let mut values = vec![0.0; column.len()];
    e.jacobian(&x, &mut values).ok()?;
    let a = range
        .clone()
        .find(|&k| column[k] as usize == z)
        .map(|k| values[k])?;
    let mut gradient = vec![0.0; n];
    for k in range.filter(|&k| column[k] as usize != z) {
        gradient[column[k] as usize] = -values[k] / a;
    }
    let mut weight = vec![0.0; p.row_count()];
    weight[row] = -1.0 / a;
    let (i, j) = e.hessian_pattern();
    let places: Vec<(usize, usize)> = i
        .iter()
        .zip(j)
        .map(|(i, j)| (*i as usize, *j as usize))
        .collect();
    let mut entries = vec![0.0; places.len()];
    e.hessian(&x, &weight, &mut entries).ok()?;
    let mut hessian = Vec::new();
    for ((i, j), v) in places.into_iter().zip(entries).filter(|e| e.1 != 0.0) {
        hessian.push((i, j, v));
        if i != j {
            hessian.push((j, i, v));
        }
    }
    Some(Objective {
        row,
        constant: (p.rows.rhs[row] - activity[row]) / a,
        gradient,
        hessian,
    })
}
