//! An instance as min f(x) subject to l ≤ x ≤ u, a ≤ g(x) ≤ b, and the way back.
//!
//! * The objective column z is eliminated when that is exact: z is free, occurs linearly with a
//!   coefficient c ≠ 0 in exactly one row, and that row is an equation c z + h(x) = r. Then
//!   f = ±(r − h(x))/c; the row's marginal is 1/c.
//! * Fixed columns are numbers. Rows without a variable, and free rows, are left out.
//! * A maximum is the minimum of −f.
//!
//! Marginals (d objective / d right-hand side, for min and max alike): with the multipliers λ of
//! min f + λᵀg, the row's marginal is −λ for a minimum and +λ for a maximum; the marginals of all
//! columns, fixed ones too, follow from stationarity: r = e_z − Jᵀm.

use crate::autodiff::{EvalFailure, Evaluator};
use crate::model::instance::{Function, Instance, Op, Relation};
use crate::solve::backend::Seen;
use crate::solve::certificate::nonlinear::inside;

/// Row, column and value of an entry of a matrix.
pub type Entry = (usize, usize, f64);

fn entries((rows, columns): (&[u32], &[u32]), value: Vec<f64>) -> Vec<Entry> {
    let place = rows.iter().zip(columns);
    let entry = |((&i, &j), v): ((&u32, &u32), f64)| (i as usize, j as usize, v);
    place.zip(value).map(entry).collect()
}

/// Violation up to which a point on the way counts as one that satisfies the constraints: well within what the certificate
/// asks for, whose units may be smaller.
const SEEN_TOLERANCE: f64 = 1e-8;

/// Where f comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObjectiveForm {
    /// There is none: any feasible point will do.
    Nothing,
    /// ± the value of a variable.
    Variable {
        /// Number of the variable.
        variable: usize,
    },
    /// The objective column is fixed, or occurs nowhere: f is constant.
    Constant,
    /// ±(rhs − h(x))/c, h being the rest of the row.
    Row {
        /// The defining row.
        row: usize,
        /// The objective column.
        column: usize,
        /// c.
        coefficient: f64,
    },
}

/// Entries of a sparse matrix, and where each stands in what the evaluator gives.
#[derive(Default)]
struct Pattern {
    row: Vec<u32>,
    column: Vec<u32>,
    from: Vec<u32>,
}

impl Pattern {
    fn push(&mut self, row: u32, column: u32, from: usize) {
        self.row.push(row);
        self.column.push(column);
        self.from.push(from as u32);
    }
}

/// The rows that are constraints with the pattern of their Jacobian, and that of the objective's gradient. `variable`: number
/// of each column, or `u32::MAX`.
fn first_derivatives(
    instance: &Instance,
    evaluator: &Evaluator,
    variable: &[u32],
    defining_row: usize,
) -> (Vec<u32>, Pattern, Pattern) {
    let (start, column) = evaluator.jacobian_pattern();
    let (mut rows, mut jacobian, mut gradient) =
        (Vec::new(), Pattern::default(), Pattern::default());
    for i in 0..instance.row_count() {
        let entries = (start[i]..start[i + 1])
            .map(|k| (variable[column[k] as usize], k))
            .filter(|e| e.0 != u32::MAX);
        if i == defining_row {
            entries.for_each(|(v, k)| gradient.push(0, v, k));
        } else if instance.rows.relation[i] != Relation::Free {
            let (before, row) = (jacobian.row.len(), rows.len() as u32);
            entries.for_each(|(v, k)| jacobian.push(row, v, k));
            if jacobian.row.len() > before {
                rows.push(i as u32);
            }
        }
    }
    (rows, jacobian, gradient)
}

/// The lower triangle of the pattern of second derivatives.
fn second_derivatives(evaluator: &Evaluator, variable: &[u32]) -> Pattern {
    let (rows, columns) = evaluator.hessian_pattern();
    let mut out = Pattern::default();
    for (k, (&i, &j)) in rows.iter().zip(columns).enumerate() {
        let (p, q) = (variable[i as usize], variable[j as usize]);
        if p != u32::MAX && q != u32::MAX {
            out.push(p.max(q), p.min(q), k);
        }
    }
    out
}

/// Columns that are by themselves the base of `**` or under a root: where they are negative nothing can be evaluated.
fn never_negative(instance: &Instance) -> impl Iterator<Item = u32> {
    instance.nonlinear.iter().flat_map(|terms| {
        let ops = &terms.kernel.ops;
        let slots = (0..ops.len()).filter_map(|i| match ops[i..] {
            [Op::Var(k), Op::Call(Function::Sqrt, _), ..]
            | [Op::Var(k), Op::Const(_), Op::Power, ..] => Some(k as usize),
            _ => None,
        });
        let width = terms.kernel.variables as usize;
        slots.flat_map(move |k| terms.columns.iter().skip(k).step_by(width).copied())
    })
}

/// An instance in the form that solvers take.
pub struct Problem {
    /// Of the whole instance.
    pub evaluator: Evaluator,
    /// Form of the objective.
    pub form: ObjectiveForm,
    /// +1 for a minimum, −1 for a maximum.
    sign: f64,
    rhs: Vec<f64>,
    /// Column of each variable.
    pub columns: Vec<u32>,
    /// Row of each constraint.
    pub rows: Vec<u32>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    row_lower: Vec<f64>,
    row_upper: Vec<f64>,
    /// Start point.
    pub start: Vec<f64>,
    /// Start multipliers λ of the constraints, if they are to be used.
    pub start_multipliers: Option<Vec<f64>>,
    /// Start values of ∇f + Jᵀλ, which the multipliers of the bounds balance, if they are to be used.
    start_reduced: Option<Vec<f64>>,
    jacobian: Pattern,
    /// In row 0.
    gradient: Pattern,
    hessian: Pattern,
    /// The full point: fixed columns filled in, the eliminated objective column 0.
    full: Vec<f64>,
    activity: Vec<f64>,
    derivative: Vec<f64>,
    second: Vec<f64>,
    lambda: Vec<f64>,
    activity_at: Option<Vec<f64>>,
    derivative_at: Option<Vec<f64>>,
    /// The best point that satisfies the constraints of those at which they were evaluated, with its objective.
    pub best_seen: Option<(f64, Vec<f64>)>,
    /// Who hears of all of them.
    pub seen: Option<Seen>,
    /// Evaluations that failed.
    pub failure_count: u64,
    /// The last of them.
    pub last_failure: Option<EvalFailure>,
}

impl Problem {
    /// Takes an instance apart.
    pub fn new(instance: &Instance) -> Self {
        Self::smoothed(instance, 0.0)
    }

    /// The same with kinks rounded by δ, see [`Evaluator::smoothed`].
    pub fn smoothed(instance: &Instance, delta: f64) -> Self {
        Self::made(instance, Evaluator::smoothed(instance, delta))
    }

    /// The same where the Hessian is only multiplied: it has no entries.
    pub fn with_products(instance: &Instance) -> Self {
        Self::made(instance, Evaluator::with_products(instance))
    }

    fn made(instance: &Instance, evaluator: Evaluator) -> Self {
        let (m, n) = (instance.row_count(), instance.column_count());
        let columns = &instance.columns;
        let form = objective_form(instance);
        let sign = instance.sign();
        let (defining_row, eliminated) = match form {
            ObjectiveForm::Row { row, column, .. } => (row, column),
            _ => (usize::MAX, usize::MAX),
        };
        let mut full = vec![0.0; n];
        let mut variable = vec![u32::MAX; n];
        let mut kept: Vec<u32> = Vec::new();
        for j in 0..n {
            let (l, u) = (columns.lower[j], columns.upper[j]);
            if l == u {
                full[j] = l;
            } else if j != eliminated {
                variable[j] = kept.len() as u32;
                kept.push(j as u32);
            }
        }
        let (rows, jacobian, gradient) =
            first_derivatives(instance, &evaluator, &variable, defining_row);
        let hessian = second_derivatives(&evaluator, &variable);
        let pick = |v: &[f64]| -> Vec<f64> { kept.iter().map(|&j| v[j as usize]).collect() };
        let sides = |&i: &u32| {
            let i = i as usize;
            let [l, u] = instance.rows.relation[i].bounds(instance.rows.rhs[i]);
            (l, u)
        };
        let (row_lower, row_upper) = rows.iter().map(sides).unzip();
        let (mut lower, upper) = (pick(&columns.lower), pick(&columns.upper));
        let levels = pick(&columns.level);
        let form = match (form, instance.objective) {
            (ObjectiveForm::Variable { .. }, Some(o)) => match variable[o.column as usize] {
                u32::MAX => ObjectiveForm::Constant,
                v => ObjectiveForm::Variable {
                    variable: v as usize,
                },
            },
            (form, _) => form,
        };
        let start_point = levels
            .iter()
            .zip(lower.iter().zip(&upper))
            .map(|(&x, (&l, &u))| {
                if x.is_finite() {
                    x.max(l).min(u)
                } else {
                    0.0_f64.max(l).min(u)
                }
            })
            .collect();
        for j in never_negative(instance) {
            let v = variable[j as usize] as usize;
            if upper.get(v).is_some_and(|u| *u > 0.0) {
                lower[v] = lower[v].max(0.0);
            }
        }
        let derivative = vec![0.0; evaluator.jacobian_pattern().1.len()];
        let second = vec![0.0; evaluator.hessian_pattern().0.len()];
        Self {
            form,
            sign,
            rhs: instance.rows.rhs.clone(),
            columns: kept,
            rows,
            lower,
            upper,
            row_lower,
            row_upper,
            start: start_point,
            start_multipliers: None,
            start_reduced: None,
            jacobian,
            gradient,
            hessian,
            full,
            activity: vec![0.0; m],
            derivative,
            second,
            lambda: vec![0.0; m],
            activity_at: None,
            derivative_at: None,
            best_seen: None,
            seen: None,
            failure_count: 0,
            last_failure: None,
            evaluator,
        }
    }

    /// Uses the marginals of the instance's rows and columns as start multipliers.
    pub fn use_marginals(&mut self, instance: &Instance) {
        let s = self.sign;
        self.start_multipliers = Some(self.marginals_of(instance));
        let reduced = self
            .columns
            .iter()
            .map(|&j| s * instance.columns.marginal[j as usize])
            .collect();
        self.start_reduced = Some(reduced);
    }

    /// Multipliers of the constraints from the marginals of the instance's rows.
    pub fn marginals_of(&self, instance: &Instance) -> Vec<f64> {
        let marginal = |&i: &u32| -self.sign * instance.rows.marginal[i as usize];
        self.rows.iter().map(marginal).collect()
    }

    /// The full point of the instance: fixed columns filled in, the objective column computed.
    pub fn levels(&mut self, x: &[f64]) -> Vec<f64> {
        self.place(x);
        let mut full = self.full.clone();
        if let ObjectiveForm::Row { column, .. } = self.form
            && let Some(f) = self.objective(x)
        {
            full[column] = self.sign * f;
        }
        full
    }

    /// Marginals of all rows from the multipliers of the constraints.
    pub fn row_marginals(&self, lambda: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.rhs.len()];
        for (&i, &l) in self.rows.iter().zip(lambda) {
            out[i as usize] = -self.sign * l;
        }
        if let ObjectiveForm::Row {
            row, coefficient, ..
        } = self.form
        {
            out[row] = 1.0 / coefficient;
        }
        out
    }

    fn place(&mut self, x: &[f64]) {
        for (&j, &v) in self.columns.iter().zip(x) {
            self.full[j as usize] = v;
        }
    }

    /// Keeps x if it satisfies bounds and constraints, whose values are known there, and is better than what was kept.
    fn note(&mut self, x: &[f64]) {
        let f = match self.form {
            ObjectiveForm::Nothing | ObjectiveForm::Constant => 0.0,
            ObjectiveForm::Variable { variable } => self.sign * x[variable],
            ObjectiveForm::Row {
                row, coefficient, ..
            } => self.sign * (self.rhs[row] - self.activity[row]) / coefficient,
        };
        let better = self.best_seen.as_ref().is_none_or(|b| b.0 > f);
        if !f.is_finite() || !better && self.seen.is_none() {
            return;
        }
        let within = |v: f64, l: f64, u: f64| {
            let room = SEEN_TOLERANCE * v.abs().max(1.0);
            v >= l - room && v <= u + room
        };
        let mut bounds = x.iter().zip(self.lower.iter().zip(&self.upper));
        let mut rows = self
            .rows
            .iter()
            .zip(self.row_lower.iter().zip(&self.row_upper));
        if bounds.all(|(&v, (&l, &u))| within(v, l, u))
            && rows.all(|(&i, (&l, &u))| within(self.activity[i as usize], l, u))
        {
            if let Some(seen) = &self.seen {
                seen(f, &self.full);
            }
            if better {
                self.best_seen = Some((f, x.to_vec()));
            }
        }
    }

    fn fail(&mut self, failure: EvalFailure) {
        self.failure_count += 1;
        self.last_failure = Some(failure);
    }

    /// Computes the activities of all rows at x, unless they are known.
    fn need_activity(&mut self, x: &[f64]) -> Option<()> {
        if self.activity_at.as_deref() == Some(x) {
            return Some(());
        }
        self.activity_at = None;
        self.place(x);
        let mut evaluated = self.evaluator.rows(&self.full, &mut self.activity);
        if let Err(e) = &evaluated
            && let Some(inside) = inside(e, x, &self.lower, &self.upper)
        {
            self.place(&inside);
            evaluated = self.evaluator.rows(&self.full, &mut self.activity);
        }
        match evaluated {
            Ok(()) => {
                self.activity_at = Some(x.to_vec());
                self.note(x);
                Some(())
            }
            Err(e) => {
                self.fail(e);
                None
            }
        }
    }

    /// The variables of a row that has no derivatives at x; None if all have some.
    pub fn without_derivatives(&mut self, x: &[f64]) -> Option<Vec<usize>> {
        let row = self.evaluate_derivative(x).err()?.row as usize;
        let (start, column) = self.evaluator.jacobian_pattern();
        let own = column[start[row]..start[row + 1]].iter();
        let variable = |j: &u32| self.columns.binary_search(j).ok();
        Some(own.filter_map(variable).collect())
    }

    /// Computes the derivatives of all rows at x, unless they are known.
    fn evaluate_derivative(&mut self, x: &[f64]) -> Result<(), EvalFailure> {
        if self.derivative_at.as_deref() == Some(x) {
            return Ok(());
        }
        self.derivative_at = None;
        self.place(x);
        self.evaluator.jacobian(&self.full, &mut self.derivative)?;
        self.derivative_at = Some(x.to_vec());
        Ok(())
    }

    /// The same, with limits at bounds where there are no derivatives. A failure is counted.
    fn need_derivative(&mut self, x: &[f64]) -> Option<()> {
        let mut evaluated = self.evaluate_derivative(x);
        if let Err(e) = &evaluated
            && let Some(inside) = inside(e, x, &self.lower, &self.upper)
        {
            evaluated = self.evaluate_derivative(&inside);
        }
        evaluated.map_err(|e| self.fail(e)).ok()
    }
}

/// What solvers need of it.
impl Problem {
    /// Numbers of variables and constraints.
    pub fn size(&self) -> (usize, usize) {
        (self.columns.len(), self.rows.len())
    }

    /// Bounds of the variables.
    pub fn bounds(&self) -> (&[f64], &[f64]) {
        (&self.lower, &self.upper)
    }

    /// Bounds of the constraints.
    pub fn sides(&self) -> (&[f64], &[f64]) {
        (&self.row_lower, &self.row_upper)
    }

    /// Pattern of the Jacobian of the constraints: rows and columns.
    pub fn jacobian_pattern(&self) -> (&[u32], &[u32]) {
        (&self.jacobian.row, &self.jacobian.column)
    }

    /// Pattern of the lower triangle of the Hessian of the Lagrangian: rows and columns.
    pub fn hessian_pattern(&self) -> (&[u32], &[u32]) {
        (&self.hessian.row, &self.hessian.column)
    }

    /// f(x); None where it cannot be evaluated.
    pub fn objective(&mut self, x: &[f64]) -> Option<f64> {
        match self.form {
            ObjectiveForm::Nothing | ObjectiveForm::Constant => Some(0.0),
            ObjectiveForm::Variable { variable } => Some(self.sign * x[variable]),
            ObjectiveForm::Row {
                row, coefficient, ..
            } => {
                self.need_activity(x)?;
                Some(self.sign * (self.rhs[row] - self.activity[row]) / coefficient)
            }
        }
    }

    /// ∇f(x), dense.
    pub fn gradient(&mut self, x: &[f64], out: &mut [f64]) -> Option<()> {
        out.fill(0.0);
        match self.form {
            ObjectiveForm::Nothing | ObjectiveForm::Constant => {}
            ObjectiveForm::Variable { variable } => out[variable] = self.sign,
            ObjectiveForm::Row { coefficient, .. } => {
                self.need_derivative(x)?;
                for (&j, &k) in self.gradient.column.iter().zip(&self.gradient.from) {
                    out[j as usize] -= self.sign * self.derivative[k as usize] / coefficient;
                }
            }
        }
        Some(())
    }

    /// g(x).
    pub fn constraints(&mut self, x: &[f64], out: &mut [f64]) -> Option<()> {
        self.need_activity(x)?;
        for (v, &i) in out.iter_mut().zip(&self.rows) {
            *v = self.activity[i as usize];
        }
        Some(())
    }

    /// Jacobian of g in the order of its pattern.
    pub fn jacobian(&mut self, x: &[f64], out: &mut [f64]) -> Option<()> {
        self.need_derivative(x)?;
        for (v, &k) in out.iter_mut().zip(&self.jacobian.from) {
            *v = self.derivative[k as usize];
        }
        Some(())
    }

    /// Lower triangle of σ ∇²f + Σ λ_i ∇²g_i in the order of its pattern.
    pub fn hessian(
        &mut self,
        x: &[f64],
        sigma: f64,
        lambda: &[f64],
        out: &mut [f64],
    ) -> Option<()> {
        self.place(x);
        self.lambda.fill(0.0);
        for (&i, &l) in self.rows.iter().zip(lambda) {
            self.lambda[i as usize] = l;
        }
        if let ObjectiveForm::Row {
            row, coefficient, ..
        } = self.form
        {
            self.lambda[row] = -sigma * self.sign / coefficient;
        }
        let (evaluator, lambda) = (&mut self.evaluator, &self.lambda);
        let mut result = evaluator.hessian(&self.full, lambda, &mut self.second);
        if let Err(e) = &result
            && let Some(inside) = inside(e, x, &self.lower, &self.upper)
        {
            self.place(&inside);
            let (evaluator, lambda) = (&mut self.evaluator, &self.lambda);
            result = evaluator.hessian(&self.full, lambda, &mut self.second);
        }
        if let Err(e) = result {
            self.fail(e);
            return None;
        }
        for (v, &k) in out.iter_mut().zip(&self.hessian.from) {
            *v = self.second[k as usize];
        }
        Some(())
    }

    /// ∇²f(x) times a vector, of a problem that was made for it. None where it has no value, and of other problems.
    pub fn product(&mut self, x: &[f64], vector: &[f64]) -> Option<Vec<f64>> {
        let ObjectiveForm::Row {
            row, coefficient, ..
        } = self.form
        else {
            return None;
        };
        self.place(x);
        self.lambda.fill(0.0);
        self.lambda[row] = -self.sign / coefficient;
        let mut along = vec![0.0; self.full.len()];
        for (&j, v) in self.columns.iter().zip(vector) {
            along[j as usize] = *v;
        }
        let mut out = vec![0.0; along.len()];
        let evaluator = &mut self.evaluator;
        let result = evaluator.product(&self.full, &along, &self.lambda, &mut out);
        result.map_err(|e| self.fail(e)).ok()?;
        Some(self.columns.iter().map(|&j| out[j as usize]).collect())
    }

    /// The last point at which derivatives were evaluated: where a run is, or the start.
    pub fn latest(&self) -> &[f64] {
        self.derivative_at.as_deref().unwrap_or(&self.start)
    }

    /// Start multipliers of the rows; 0 where nothing is known.
    pub fn start_rows(&self, lambda: &mut [f64]) {
        match &self.start_multipliers {
            Some(l) => lambda.copy_from_slice(l),
            None => lambda.fill(0.0),
        }
    }

    /// Start multipliers of the lower and upper bounds; 1 where nothing is known.
    pub fn start_bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        let Some(reduced) = &self.start_reduced else {
            lower.fill(1.0);
            upper.fill(1.0);
            return;
        };
        for ((l, u), r) in lower.iter_mut().zip(upper).zip(reduced) {
            (*l, *u) = (r.max(0.0), (-r).max(0.0));
        }
    }

    /// Jacobian of g: row, column, value.
    pub fn jacobian_entries(&mut self, x: &[f64]) -> Option<Vec<Entry>> {
        let mut value = vec![0.0; self.jacobian_pattern().0.len()];
        self.jacobian(x, &mut value)?;
        Some(entries(self.jacobian_pattern(), value))
    }

    /// Lower triangle of ∇²f + Σ λ_i ∇²g_i: row, column, value.
    pub fn hessian_entries(&mut self, x: &[f64], lambda: &[f64]) -> Option<Vec<Entry>> {
        self.hessian_entries_of(x, 1.0, lambda)
    }

    /// Lower triangle of σ ∇²f + Σ λ_i ∇²g_i: row, column, value.
    pub fn hessian_entries_of(
        &mut self,
        x: &[f64],
        sigma: f64,
        lambda: &[f64],
    ) -> Option<Vec<Entry>> {
        let mut value = vec![0.0; self.hessian_pattern().0.len()];
        self.hessian(x, sigma, lambda, &mut value)?;
        Some(entries(self.hessian_pattern(), value))
    }
}

/// Finds out whether the objective column can be eliminated.
fn objective_form(instance: &Instance) -> ObjectiveForm {
    let Some(objective) = instance.objective else {
        return ObjectiveForm::Nothing;
    };
    let z = objective.column as usize;
    let columns = &instance.columns;
    let variable = ObjectiveForm::Variable { variable: z };
    if columns.lower[z] == columns.upper[z] {
        return ObjectiveForm::Constant;
    }
    // z ≥ f(x) holds as an equation where z is minimised
    let pushes = |row: usize, c: f64| match instance.rows.relation[row] {
        Relation::Equal => true,
        Relation::Greater => instance.sign() * c > 0.0,
        Relation::Less => instance.sign() * c < 0.0,
        Relation::Free => false,
    };
    match instance.objective_row() {
        Some((row, coefficient)) if instance.is_free(z) && pushes(row, coefficient) => {
            ObjectiveForm::Row {
                row,
                column: z,
                coefficient,
            }
        }
        _ => variable,
    }
}
