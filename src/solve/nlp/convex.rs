//! What the shape of a program says: linear, quadratic and convex, or neither.

use super::quadratic::is_semidefinite;
use crate::autodiff::{Degree, Evaluator};
use crate::model::instance::{Instance, Relation};

/// The shape of a program.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// All rows are linear.
    Linear,
    /// Objective and rows are linear or quadratic, and their Hessians say that the program is convex.
    ConvexQuadratic {
        /// The objective function.
        objective: Objective,
        /// Whether a row is quadratic, too.
        in_rows: bool,
    },
    /// Quadratic and not convex: the objective, or this row.
    Quadratic(Option<usize>),
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
    let eliminated = p
        .objective
        .map(|o| o.column as usize)
        .zip(p.objective_row())
        .filter(|(z, (i, _))| p.is_free(*z) && p.rows.relation[*i] == Relation::Equal);
    let mut objective = Objective::default();
    let mut in_rows = false;
    for (row, degree) in degrees.into_iter().enumerate() {
        let defined = eliminated.filter(|d| d.1.0 == row).map(|d| d.0);
        match degree {
            Degree::Linear if defined.is_none() => continue,
            Degree::Linear | Degree::Quadratic => {}
            _ => return Shape::Nonlinear(row),
        }
        let (convex, blame) = match defined {
            Some(z) => match at_origin(p, &mut e, row, z) {
                Some(f) => {
                    objective = f;
                    (
                        is_convex(p.column_count(), &objective.hessian, p.sign()),
                        None,
                    )
                }
                None => return Shape::Nonlinear(row),
            },
            None => {
                let sign = match p.rows.relation[row] {
                    Relation::Less => 1.0,
                    Relation::Greater => -1.0,
                    Relation::Free => continue,
                    Relation::Equal => return Shape::Quadratic(Some(row)),
                };
                in_rows = true;
                let h = hessian(p, &mut e, row, sign);
                (
                    h.is_some_and(|h| is_convex(p.column_count(), &h, 1.0)),
                    Some(row),
                )
            }
        };
        if !convex {
            return Shape::Quadratic(blame);
        }
    }
    if let (None, Some(o)) = (eliminated, p.objective) {
        objective.gradient = vec![0.0; p.column_count()];
        objective.gradient[o.column as usize] = 1.0;
    }
    Shape::ConvexQuadratic { objective, in_rows }
}

/// Whether `sign` times a Hessian of so many columns is positive semidefinite.
pub fn is_convex(columns: usize, hessian: &[(usize, usize, f64)], sign: f64) -> bool {
    let lower = hessian.iter().filter(|e| e.0 >= e.1);
    let lower: Vec<_> = lower.map(|&(i, j, v)| (i, j, sign * v)).collect();
    is_semidefinite(columns, &lower)
}

/// Entries of the Hessian of a quadratic row times a number: row, column, value, both triangles.
pub fn hessian(
    p: &Instance,
    e: &mut Evaluator,
    row: usize,
    weight: f64,
) -> Option<Vec<(usize, usize, f64)>> {
    let mut weights = vec![0.0; p.row_count()];
    weights[row] = weight;
    let (i, j) = e.hessian_pattern();
    let places: Vec<(usize, usize)> = i
        .iter()
        .zip(j)
        .map(|(i, j)| (*i as usize, *j as usize))
        .collect();
    let mut entries = vec![0.0; places.len()];
    e.hessian(&vec![0.0; p.column_count()], &weights, &mut entries)
        .ok()?;
    let mut hessian = Vec::new();
    for ((i, j), v) in places.into_iter().zip(entries).filter(|e| e.1 != 0.0) {
        hessian.push((i, j, v));
        if i != j {
            hessian.push((j, i, v));
        }
    }
    Some(hessian)
}

/// The function that a row defines for a column: value, gradient and Hessian at 0.
fn at_origin(p: &Instance, e: &mut Evaluator, row: usize, z: usize) -> Option<Objective> {
    let n = p.column_count();
    let x = vec![0.0; n];
    let (activity, slopes) = e.linearised(&x).ok()?;
    let (_, a) = *slopes[row].iter().find(|s| s.0 == z)?;
    let mut gradient = vec![0.0; n];
    for &(j, slope) in slopes[row].iter().filter(|s| s.0 != z) {
        gradient[j] = -slope / a;
    }
    Some(Objective {
        row,
        constant: (p.rows.rhs[row] - activity[row]) / a,
        gradient,
        hessian: hessian(p, e, row, -1.0 / a)?,
    })
}
