//! A linear program some of whose columns are discrete, and what it means that a point satisfies that.

use crate::model::instance::{ColumnKind, Instance, OrderedSet};
use crate::solve::SolveError;
use crate::solve::certificate::unit_of;
use crate::solve::lp::form::{Form, Problem};
use crate::solve::lp::scale::Scaling;

/// A value this near to an integer is one.
pub const INTEGRAL: f64 = 1e-6;

/// A violation of a row up to this, relative to the row's largest term, is none.
pub const FEASIBLE: f64 = 1e-7;

/// A least value of a semicontinuous column below this is its unit.
const SMALL: f64 = 1e-3;

/// New bounds of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// The column.
    pub column: usize,
    /// Its lower bound from here on.
    pub lower: f64,
    /// Its upper bound from here on.
    pub upper: f64,
}

impl Change {
    /// Of a column, to these bounds.
    pub fn new(column: usize, lower: f64, upper: f64) -> Self {
        Self {
            column,
            lower,
            upper,
        }
    }
}

/// A linear program (or the linear rows of a nonlinear one) with discrete columns.
#[derive(Clone, Debug, Default)]
pub struct Mip {
    /// Costs, bounds and rows.
    pub problem: Problem,
    /// By column: integers only.
    pub integer: Vec<bool>,
    /// By column: 0, or not below this; 0 for columns that are not semicontinuous.
    pub threshold: Vec<f64>,
    /// Sets of columns of which one, or two neighbours, may be nonzero.
    pub sets: Vec<OrderedSet>,
    /// By column: what is branched on first has the least; empty: no preference.
    pub priority: Vec<f64>,
    /// Columns that stand in rows which are not there yet.
    pub held: Vec<u32>,
}

/// What of a program's value is not a matter of the search: its unit and its constant.
#[derive(Clone, Copy, Debug)]
pub struct Units {
    /// Factor.
    pub price: f64,
    /// Constant, after the factor.
    pub offset: f64,
}

impl Units {
    /// A value in the units of the instance, of a minimisation.
    pub fn shown(&self, value: f64) -> f64 {
        value * self.price + self.offset
    }

    /// The gap between a solution's value and a bound, absolute and relative to the value.
    pub fn gap(&self, value: f64, bound: f64) -> [f64; 2] {
        let value = self.shown(value);
        let gap = value - self.shown(bound);
        [gap, gap / value.abs().max(1e-10)]
    }

    /// The other way.
    pub fn inner(&self, shown: f64) -> f64 {
        (shown - self.offset) / self.price
    }
}

impl Mip {
    /// The discrete side of an instance's columns; `column[k]` is the instance's number of column k.
    pub fn new(problem: Problem, instance: &Instance, columns: &[u32], priorities: bool) -> Self {
        let n = problem.n();
        let mut number = vec![u32::MAX; instance.column_count()];
        for (k, &j) in columns.iter().enumerate() {
            number[j as usize] = k as u32;
        }
        let kind = |k: usize| instance.columns.kind[columns[k] as usize];
        let whole = |k| matches!(kind(k), ColumnKind::Integer | ColumnKind::SemiInteger);
        let mut mip = Self {
            problem,
            integer: (0..n).map(whole).collect(),
            threshold: vec![0.0; n],
            sets: Vec::new(),
            priority: Vec::new(),
            held: Vec::new(),
        };
        for &(j, lower) in &instance.discrete.thresholds {
            if let Some(k) = number.get(j as usize).filter(|&&k| k != u32::MAX) {
                mip.threshold[*k as usize] = lower;
            }
        }
        for set in &instance.discrete.sets {
            let columns = set.columns.iter().map(|&j| number[j as usize]);
            mip.sets.push(OrderedSet {
                neighbours: set.neighbours,
                columns: columns.filter(|&k| k != u32::MAX).collect(),
            });
        }
        if priorities && !instance.discrete.priorities.is_empty() {
            let all = &instance.discrete.priorities;
            mip.priority = columns.iter().map(|&j| all[j as usize]).collect();
        }
        mip.round_bounds();
        mip
    }

    /// Whether a column is 0 or 1 between these bounds.
    pub fn is_binary(&self, column: usize, lower: &[f64], upper: &[f64]) -> bool {
        self.integer[column] && lower[column] == 0.0 && upper[column] == 1.0
    }

    /// Bounds of integer columns become integers.
    pub fn round_bounds(&mut self) {
        let p = &mut self.problem;
        for j in (0..self.integer.len()).filter(|&j| self.integer[j]) {
            p.lower[j] = (p.lower[j] - INTEGRAL).ceil();
            p.upper[j] = (p.upper[j] + INTEGRAL).floor();
        }
    }

    /// In units in which coefficients are near 1; integer columns and members of sets stay as they are, and semicontinuous
    /// columns whose least value would be lost in the tolerances are counted in it.
    pub fn scaled(&self) -> (Self, Scaling) {
        let columns = self.integer.iter().zip(&self.threshold);
        let unit = |(&integer, &t): (&bool, &f64)| match integer {
            true => Some(1.0),
            false => (t > 0.0 && t < SMALL).then_some(t),
        };
        let mut units: Vec<Option<f64>> = columns.map(unit).collect();
        for set in &self.sets {
            set.columns
                .iter()
                .for_each(|&j| units[j as usize] = Some(1.0));
        }
        let scaling = Scaling::with_units(&self.problem, &units);
        let mut scaled = self.clone();
        scaled.problem = scaling.apply(&self.problem);
        for (t, c) in scaled.threshold.iter_mut().zip(&scaling.column) {
            *t /= c;
        }
        (scaled, scaling)
    }

    /// The linear rows of an instance that are paired with no column, without costs, over all of its columns.
    pub fn of_nonlinear(instance: &Instance, priorities: bool) -> Result<Self, SolveError> {
        let mut rows = instance.clone();
        rows.objective = None;
        let mut free = instance.nonlinear_rows();
        for &i in instance.matched.iter().flatten().flatten() {
            free[i as usize] = true;
        }
        for (relation, free) in rows.rows.relation.iter_mut().zip(free) {
            if free {
                *relation = crate::model::instance::Relation::Free;
            }
        }
        rows.nonlinear.clear();
        let form = Form::new(&rows)?;
        Ok(Self::new(form.problem, instance, &form.columns, priorities))
    }

    /// How far a value of column j is from what it may be, given its bounds in a node.
    pub fn distance(&self, j: usize, x: f64, lower: f64) -> f64 {
        let mut far = 0.0f64;
        if self.integer[j] {
            far = (x - x.round()).abs();
        }
        let t = self.threshold[j];
        if t > 0.0 && lower < t {
            far = far.max((x / t).min(1.0 - x / t));
        }
        far
    }

    /// First and last position of what is not 0 in a set, if that is more than the set allows.
    pub fn spread(&self, set: &OrderedSet, x: &[f64]) -> Option<(usize, usize)> {
        let off = |j: &&u32| x[**j as usize].abs() > INTEGRAL;
        let first = set.columns.iter().position(|j| off(&j))?;
        let last = set.columns.iter().rposition(|j| off(&j))?;
        (last - first > usize::from(set.neighbours)).then_some((first, last))
    }

    /// Columns of a set that must be 0 if those stay which a point has farthest from it.
    pub fn outside<'s>(&self, set: &'s OrderedSet, x: &[f64]) -> impl Iterator<Item = usize> + 's {
        let width = 1 + usize::from(set.neighbours);
        let weight = |w: &[u32]| w.iter().map(|&j| x[j as usize].abs()).sum::<f64>();
        let kept = set.columns.windows(width).map(weight).enumerate();
        let kept = kept.reduce(|a, b| if b.1 > a.1 { b } else { a });
        let first = kept.map_or(0, |k| k.0);
        let all = set.columns.iter().enumerate();
        all.filter(move |(k, _)| *k < first || *k >= first + width)
            .map(|(_, &j)| j as usize)
    }

    /// Whether integer columns are all that is discrete: no ordered sets, nothing semicontinuous.
    pub fn has_integers_only(&self) -> bool {
        self.sets.is_empty() && self.threshold.iter().all(|t| *t == 0.0)
    }

    /// Whether all discrete columns have values that they may have.
    pub fn is_discrete(&self, x: &[f64]) -> bool {
        let fine = |j: usize| self.distance(j, x[j], 0.0) <= INTEGRAL;
        (0..x.len()).all(fine) && self.sets.iter().all(|s| self.spread(s, x).is_none())
    }

    /// Whether a point satisfies bounds and rows, up to rounding.
    pub fn is_feasible(&self, x: &[f64]) -> bool {
        let p = &self.problem;
        let inside = |(j, &x): (usize, &f64)| {
            let slack = FEASIBLE * unit_of(x.abs().max(1.0));
            x >= p.lower[j] - slack && x <= p.upper[j] + slack
        };
        let row = |i: usize| {
            let terms = p.rows.line(i).map(|(j, a)| a * x[j]);
            let (sum, size) = terms.fold((0.0, 1.0f64), |(s, z), t: f64| (s + t, z.max(t.abs())));
            let slack = FEASIBLE * unit_of(size);
            sum >= p.row_lower[i] - slack && sum <= p.row_upper[i] + slack
        };
        x.iter().enumerate().all(inside) && (0..p.m()).all(row)
    }

    /// Value of a point.
    pub fn value(&self, x: &[f64]) -> f64 {
        self.problem.cost.iter().zip(x).map(|(c, x)| c * x).sum()
    }

    /// Columns with costs, and these.
    pub fn costs(&self) -> impl Iterator<Item = (usize, f64)> {
        let costs = self.problem.cost.iter().copied().enumerate();
        costs.filter(|c| c.1 != 0.0)
    }

    /// The step of the objective's values where only columns whose values have one have costs; 0 if there is none.
    pub fn granularity(&self) -> f64 {
        let steps = self.steps();
        let open = |j: usize| self.problem.lower[j] < self.problem.upper[j];
        let costs = self.costs().filter(|&(j, _)| open(j));
        let known = |step: f64| if step > 0.0 { step } else { f64::NAN };
        step_of(costs.map(|(j, c)| c * known(steps[j])))
    }

    /// Steps of columns: 1 of integers; of others the step of what rows of such columns leave for them; 0: there is none.
    ///
    /// A column alone among such columns in an equation has no other values. One for which this is so in all of its rows,
    /// and whose bounds are multiples of its step, has a best value that is one: an end of what its rows leave.
    fn steps(&self) -> Vec<f64> {
        let p = &self.problem;
        let mut step: Vec<f64> = self
            .integer
            .iter()
            .map(|&i| f64::from(u8::from(i)))
            .collect();
        let of_row = |i: usize, j: usize, a: f64, step: &[f64]| {
            let sides = [p.row_lower[i], p.row_upper[i]];
            let sides = sides.into_iter().filter(|s| s.is_finite());
            let others = p.rows.line(i).filter(|e| e.0 != j && e.1 != 0.0);
            let others = others.map(|(k, b)| if step[k] > 0.0 { b * step[k] } else { f64::NAN });
            step_of(others.chain(sides).map(|v| v / a))
        };
        for _ in 0..3 {
            for j in (0..p.n()).filter(|&j| self.threshold[j] == 0.0) {
                if step[j] > 0.0 || p.columns.line(j).len() == 0 {
                    continue;
                }
                let rows = || p.columns.line(j).filter(|e| e.1 != 0.0);
                let fixed = |e: &(usize, f64)| p.row_lower[e.0] == p.row_upper[e.0];
                let from_equation = rows().filter(fixed).map(|(i, a)| of_row(i, j, a, &step));
                let found = from_equation.fold(0.0, f64::max);
                step[j] = match found > 0.0 {
                    true => found,
                    false => {
                        let rows = rows().map(|(i, a)| of_row(i, j, a, &step));
                        let common = step_of(rows.map(|s| if s > 0.0 { s } else { f64::NAN }));
                        let ends = [p.lower[j], p.upper[j]];
                        // presolve widens bounds that rows imply
                        let off = |b: f64| (b - (b / common).round() * common).abs();
                        let fits =
                            |&b: &f64| !b.is_finite() || off(b) <= 1e-6 * b.abs().max(common);
                        if ends.iter().all(fits) { common } else { 0.0 }
                    }
                };
            }
        }
        step
    }
}

/// The largest number of which all these are multiples, zeros aside; 0: there is none, or it is too small to tell.
fn step_of(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.map(f64::abs).filter(|v| *v != 0.0).collect();
    let largest = values.iter().copied().fold(0.0, f64::max);
    let mut step = 0.0;
    for &v in &values {
        if v.is_nan() {
            return 0.0;
        }
        let (mut a, mut b) = (v, step);
        while b > 1e-11 * largest {
            (a, b) = (b, (a - (a / b).round() * b).abs());
        }
        step = a;
    }
    if step <= 1e-8 * largest {
        return 0.0;
    }
    // As exact as the largest is.
    let step = largest / (largest / step).round();
    let whole = |v: &f64| (v / step - (v / step).round()).abs() < 1e-9 * (v / step);
    if values.iter().all(whole) { step } else { 0.0 }
}
