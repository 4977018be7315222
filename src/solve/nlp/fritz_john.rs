//! Optima without multipliers: no feasible direction leads down, by conditions of second order.
//!
//! Where Σ λ_i ∇g_i = 0 with multipliers λ ≥ 0 of binding rows alone (a point of Fritz John without the objective), the rows
//! have no multipliers that bound the objective. With H = Σ λ_i ∇²g_i, whoever moves along a feasible arc x + td + o(t)
//! has dᵀHd ≤ 0, for Σ λ_i g_i grows by t²dᵀHd/2. Where H is positive semidefinite this is Hd = 0, and one linear program
//! decides: if none of the d with Hd = 0 in the linearised cone leads down, no feasible direction does
//! (Bonnans & Shapiro 2000, 3.2 and 5.2).

use crate::autodiff::Evaluator;
use crate::model::instance::{Instance, Relation};
use crate::model::problem_type::ProblemType;
use crate::solve::answer::subproblem;
use crate::solve::backend::Task;
use crate::solve::certificate::TOLERANCE;
use crate::solve::certificate::nonlinear::{binding_rows, steps_within_bounds};
use crate::solve::{Budget, ModelStatus, Settings};

/// Multipliers below this, relative to the largest, are those of rows that have some beside the objective.
const LEAST_MULTIPLIER: f64 = 1e-3;

/// A row that holds to 1e-9 is a square that is to be 0 up to 3e-5, and so are its derivatives.
const GRADIENT_TOLERANCE: f64 = 1e-4;

/// Eigenvalues below this, relative to the largest, are 0.
const EIGENVALUE_TOLERANCE: f64 = 1e-9;

/// Columns of H for which its eigenvalues are computed.
const MAX_EIGEN_COLUMNS: usize = 500;

/// Whether no feasible direction from a point leads down. `marginal`: by row, multipliers of the same rows a little wider.
pub(super) fn is_without_descent(
    instance: &Instance,
    level: &[f64],
    marginal: &[f64],
    budget: &Budget,
) -> bool {
    linearised_program(instance, level, marginal).is_some_and(|(program, scale)| {
        let task = Task::new(ProblemType::Lp, &program);
        let answer = budget.aside(|b| subproblem(&task, &Settings::default(), b));
        answer.is_ok_and(|a| {
            let z = program.objective.map_or(0, |o| o.column as usize);
            let slope = program.sign() * a.outcome.level[z];
            a.status == ModelStatus::Optimal && slope >= -TOLERANCE * scale
        })
    })
}

/// The linear program in d, and the size of a slope. None where H is not positive semidefinite or the gradients do not cancel.
fn linearised_program(
    instance: &Instance,
    level: &[f64],
    marginal: &[f64],
) -> Option<(Instance, f64)> {
    let objective = instance.objective?;
    let z = objective.column as usize;
    let mut evaluator = Evaluator::new(instance);
    let (activity, mut lines) = evaluator.linearised(level).ok()?;
    let (m, n) = (instance.row_count(), instance.column_count());
    let size = |j: usize| level[j].abs().max(1.0);
    let binding = binding_rows(instance, level, &activity, &lines);
    // rows g ≤ 0 have multipliers λ ≥ 0, which are marginals of the other sign
    let sign = instance.sign();
    let of_objective = |i: usize| lines[i].iter().any(|e| e.0 == z);
    let mut lambda: Vec<f64> = (0..m)
        .map(|i| match instance.rows.relation[i] {
            _ if !binding[i] || of_objective(i) => 0.0,
            Relation::Less => (-sign * marginal[i]).max(0.0),
            Relation::Greater => (-sign * marginal[i]).min(0.0),
            _ => -sign * marginal[i],
        })
        .collect();
    let most = lambda.iter().fold(0.0f64, |t, l| t.max(l.abs()));
    if most <= 0.0 {
        return None;
    }
    for l in &mut lambda {
        *l = if l.abs() < LEAST_MULTIPLIER * most {
            0.0
        } else {
            *l / most
        };
    }
    let (places, values) = {
        let (rows, columns) = evaluator.hessian_pattern();
        let places: Vec<_> = rows.iter().copied().zip(columns.iter().copied()).collect();
        let mut values = vec![0.0; places.len()];
        evaluator.hessian(level, &lambda, &mut values).ok()?;
        (places, values)
    };
    let entries = places.iter().zip(values).filter(|e| e.1 != 0.0);
    let entries: Vec<(usize, usize, f64)> = entries
        .map(|(&(i, j), v)| (i as usize, j as usize, v))
        .collect();
    let mut columns: Vec<usize> = entries.iter().flat_map(|e| [e.0, e.1]).collect();
    columns.sort_unstable();
    columns.dedup();
    let k = columns.len();
    if k == 0 || k > MAX_EIGEN_COLUMNS {
        return None;
    }
    let place = |j: usize| columns.partition_point(|&c| c < j);
    // in units of the columns' sizes
    let mut h = faer::Mat::<f64>::zeros(k, k);
    for &(i, j, v) in &entries {
        let v = v * size(i) * size(j);
        h[(place(i), place(j))] = v;
        h[(place(j), place(i))] = v;
    }
    let eigen = h.self_adjoint_eigen(faer::Side::Lower).ok()?;
    let (curvature, vectors) = (eigen.S(), eigen.U());
    let most = (0..k).fold(0.0f64, |t, i| t.max(curvature[i].abs()));
    let zero = EIGENVALUE_TOLERANCE * most;
    if (0..k).any(|i| curvature[i] < -zero) {
        return None;
    }
    let small = GRADIENT_TOLERANCE * most;
    let mut cancelled = vec![0.0; n];
    for (line, &l) in lines.iter_mut().zip(&lambda).filter(|e| *e.1 != 0.0) {
        line.retain(|&(j, a)| (a * size(j)).abs() > small);
        line.iter().for_each(|&(j, a)| cancelled[j] += l * a);
    }
    let mut program = Instance::default();
    for (j, &sum) in cancelled.iter().enumerate() {
        let reach = if j == z { f64::INFINITY } else { size(j) };
        let [down, up] = steps_within_bounds(instance, level, j, reach);
        let sum = sum * size(j);
        if sum > small && down < 0.0 || sum < -small && up > 0.0 {
            return None;
        }
        program.add_column(down, up, 0.0);
    }
    let mut scale = 1.0f64;
    for (i, line) in lines.iter().enumerate().filter(|e| binding[e.0]) {
        if line.iter().any(|e| e.0 == z) {
            scale = line
                .iter()
                .fold(scale, |s, &(j, a)| s.max((a * size(j)).abs()));
        }
        program.add_row(line.iter().copied(), instance.rows.relation[i], 0.0);
    }
    for i in (0..k).filter(|&i| curvature[i] > zero) {
        let entries = columns.iter().enumerate();
        let row = entries.map(|(c, &j)| (j, vectors[(c, i)] / size(j)));
        program.add_row(row, Relation::Equal, 0.0);
    }
    program.set_objective(z, objective.sense);
    Some((program, scale))
}
