//! Sensitivity of a linear program: in which interval of a right-hand side a price holds, in which interval of a cost the
//! point stays optimal.
//!
//! No basis is asked, so degenerate vertices give the right answer: the prices on either side of a right-hand side are the
//! largest and the smallest multiplier of the optimal dual face (two programs say whether that is one point, and no more are
//! needed then); a price holds as far as the value of the program grows with
//! it, which one more linear program says.

use super::answer::answer_with;
use super::backend::Task;
use super::random::Random;
use super::registry::BACKENDS;
use super::{Budget, ModelStatus, Quiet, Settings};
use crate::model::instance::{Instance, Objective, Relation, Sense};
use crate::model::outcome::Basis;
use crate::model::problem_type::ProblemType;
use std::cell::{OnceCell, RefCell};

/// A row's right-hand side.
#[derive(Clone, Debug)]
pub struct RowRange {
    /// The row.
    pub row: usize,
    /// Its right-hand side.
    pub value: f64,
    /// What one unit less and one unit more change the objective by, per unit; infinite where nothing is feasible there.
    pub price: [f64; 2],
    /// As far as these prices hold.
    pub interval: [f64; 2],
}

/// A cost coefficient.
#[derive(Clone, Debug)]
pub struct CostRange {
    /// The column.
    pub column: usize,
    /// Its coefficient in the objective.
    pub value: f64,
    /// Its level.
    pub level: f64,
    /// The coefficients for which the point stays optimal.
    pub interval: [f64; 2],
}

/// All of them.
#[derive(Clone, Debug, Default)]
pub struct Ranges {
    /// By row, the objective's own left out.
    pub rows: Vec<RowRange>,
    /// By column, an eliminated objective variable left out.
    pub costs: Vec<CostRange>,
    /// A limit of time was reached: the rest is missing.
    pub unfinished: bool,
}

/// How far two multipliers of a row may be apart to be the same, relative.
const SAME: f64 = 1e-9;
/// How near to a bound is at it, relative.
const NEAR: f64 = 1e-7;
/// What the value may be off along a range, relative.
const VALUE_TOLERANCE: f64 = 1e-10;
/// An end nearer to 0 than this, relative to the right-hand side and the way from it, is 0.
const END_TOLERANCE: f64 = 1e-8;

/// The program as a minimum without its objective variable.
struct Reduced<'a> {
    p: &'a Instance,
    sign: f64,
    /// The row and the column that define the objective, where one does.
    gone: Option<(usize, usize)>,
    cost: Vec<f64>,
    x: &'a [f64],
    activity: &'a [f64],
    value: f64,
    /// The optimal dual face, and the multipliers where it is one point, once they were asked for.
    face: OnceCell<Instance>,
    point: OnceCell<Option<Vec<f64>>>,
    /// On the optimal dual face; on that of a program with another cost; and along a right-hand side.
    prices: Family,
    costs: Family,
    ways: Family,
}

/// The ranges of an optimal point: its levels and the activities of its rows. `wanted`: rows and columns to look at;
/// `in_time`: false once there is no time left.
pub fn ranges(
    p: &Instance,
    x: &[f64],
    activity: &[f64],
    wanted_row: &dyn Fn(usize) -> bool,
    wanted_column: &dyn Fn(usize) -> bool,
    in_time: &dyn Fn() -> bool,
) -> Ranges {
    let Some(reduced) = Reduced::new(p, x, activity) else {
        return Ranges::default();
    };
    let mut out = Ranges::default();
    for i in 0..p.row_count() {
        let skip = reduced.is_gone_row(i) || p.rows.relation[i] == Relation::Free;
        if skip || !wanted_row(i) {
            continue;
        }
        if !in_time() {
            out.unfinished = true;
            return out;
        }
        out.rows.push(reduced.row(i));
    }
    for j in 0..p.column_count() {
        if reduced.is_gone_column(j) || !wanted_column(j) {
            continue;
        }
        if !in_time() {
            out.unfinished = true;
            return out;
        }
        out.costs.push(reduced.cost_of(j));
    }
    out
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= NEAR * (1.0 + a.abs().max(b.abs()))
}

/// A number without the rounding of a linear program: the nearest with ten digits.
fn rounded(x: f64) -> f64 {
    match x.is_finite() && x != 0.0 {
        true => format!("{x:.8e}").parse().unwrap_or(x),
        false => x,
    }
}

/// Linear programs that differ little: each begins with the basis in which the last one ended.
#[derive(Default)]
struct Family {
    basis: RefCell<Option<Basis>>,
}

impl Family {
    /// The least or the largest value of a column; infinite if there is none, None if nothing is feasible.
    fn extreme(&self, p: Instance, column: usize, sense: Sense) -> Option<f64> {
        self.furthest(p, column, sense).map(|(value, _)| value)
    }

    /// The same with the point at which it is reached; no point where it is infinite.
    fn furthest(&self, mut p: Instance, column: usize, sense: Sense) -> Option<(f64, Vec<f64>)> {
        p.objective = Some(Objective {
            column: column as u32,
            sense,
        });
        let far = match sense {
            Sense::Minimize => f64::NEG_INFINITY,
            Sense::Maximize => f64::INFINITY,
        };
        let basis = self.basis.take();
        let task = Task {
            basis: basis.as_ref(),
            ..Task::new(ProblemType::Lp, &p)
        };
        let mut quiet = Quiet::default();
        let budget = Budget::unlimited(&mut quiet);
        let a = answer_with(BACKENDS, &task, &Settings::default(), &budget).ok()?;
        self.basis.replace(a.outcome.basis.or(basis));
        match a.status {
            ModelStatus::Optimal => Some((a.outcome.level[column], a.outcome.level)),
            ModelStatus::Unbounded | ModelStatus::UnboundedNoSolution => Some((far, Vec::new())),
            _ => None,
        }
    }
}

impl<'a> Reduced<'a> {
    fn new(p: &'a Instance, x: &'a [f64], activity: &'a [f64]) -> Option<Self> {
        let o = p.objective?;
        let z = o.column as usize;
        let row = p
            .objective_row()
            .filter(|&(i, _)| p.is_free(z) && p.rows.relation[i] == Relation::Equal);
        let gone = row.map(|(i, _)| (i, z));
        let sign = p.sign();
        let mut cost = vec![0.0; p.column_count()];
        match row {
            Some((i, a)) => {
                p.matrix.row(i).for_each(|(j, v)| cost[j] = -sign * v / a);
                cost[z] = 0.0;
            }
            None => cost[z] = sign,
        }
        let value = cost.iter().zip(x).map(|(c, x)| c * x).sum();
        Some(Self {
            p,
            sign,
            gone,
            cost,
            x,
            activity,
            value,
            face: OnceCell::new(),
            point: OnceCell::new(),
            prices: Family::default(),
            costs: Family::default(),
            ways: Family::default(),
        })
    }

    fn is_gone_row(&self, i: usize) -> bool {
        self.gone.is_some_and(|g| g.0 == i)
    }

    fn is_gone_column(&self, j: usize) -> bool {
        self.gone.is_some_and(|g| g.1 == j)
    }

    /// The optimal dual face: a column per row; `extra` columns behind them.
    fn dual_face(&self, shifted: Option<usize>) -> Instance {
        let p = self.p;
        let mut d = Instance::default();
        for i in 0..p.row_count() {
            let tight = near(self.activity[i], p.rows.rhs[i]);
            let (lo, up) = match p.rows.relation[i] {
                _ if self.is_gone_row(i) => (0.0, 0.0),
                Relation::Equal => (f64::NEG_INFINITY, f64::INFINITY),
                Relation::Greater if tight => (0.0, f64::INFINITY),
                Relation::Less if tight => (f64::NEG_INFINITY, 0.0),
                _ => (0.0, 0.0),
            };
            d.columns.push(lo, up);
        }
        let shift = d.columns.push(f64::NEG_INFINITY, f64::INFINITY);
        let mut transposed: Vec<Vec<(usize, f64)>> = vec![Vec::new(); p.column_count()];
        for i in (0..p.row_count()).filter(|&i| !self.is_gone_row(i)) {
            for (j, v) in p.matrix.row(i) {
                transposed[j].push((i, v));
            }
        }
        for (j, mut terms) in transposed.into_iter().enumerate() {
            let (lo, up) = (p.columns.lower[j], p.columns.upper[j]);
            if lo == up || self.is_gone_column(j) {
                continue;
            }
            let relation = match (near(self.x[j], lo), near(self.x[j], up)) {
                (true, _) if lo.is_finite() => Relation::Less,
                (_, true) if up.is_finite() => Relation::Greater,
                _ => Relation::Equal,
            };
            if shifted == Some(j) {
                terms.push((shift, -1.0));
            }
            d.add_row(terms, relation, self.cost[j]);
        }
        if shifted.is_none() {
            (d.columns.lower[shift], d.columns.upper[shift]) = (0.0, 0.0);
        }
        d
    }

    /// The point of which the optimal dual face consists, where it is one: a functional drawn at random has the same least and
    /// largest value on it, and reaches them at the same point. On any larger face these differ (with probability one).
    fn one_point(&self, mut face: Instance) -> Option<Vec<f64>> {
        let mut stream = Random(1);
        let rows = self.p.row_count();
        let weight = |_| (1.0 + stream.uniform()) * if stream.uniform() < 0.5 { -1.0 } else { 1.0 };
        let mut terms: Vec<(usize, f64)> = (0..rows).map(weight).enumerate().collect();
        let value = face.columns.push(f64::NEG_INFINITY, f64::INFINITY);
        terms.push((value, -1.0));
        face.add_row(terms, Relation::Equal, 0.0);
        let family = Family::default();
        let (_, low) = family.furthest(face.clone(), value, Sense::Minimize)?;
        let (_, high) = family.furthest(face, value, Sense::Maximize)?;
        let alike = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME * (1.0 + a.abs().max(b.abs()));
        let one = !low.is_empty() && !high.is_empty() && low[..rows].iter().zip(&high).all(alike);
        one.then_some(low)
    }

    fn row(&self, i: usize) -> RowRange {
        let p = self.p;
        let tight = p.rows.relation[i] == Relation::Equal || near(self.activity[i], p.rows.rhs[i]);
        let mut price = [0.0, 0.0];
        if tight {
            let face = || self.face.get_or_init(|| self.dual_face(None)).clone();
            let side = |sense| self.prices.extreme(face(), i, sense).unwrap_or(f64::NAN);
            price = match self.point.get_or_init(|| self.one_point(face())) {
                Some(y) => [y[i]; 2],
                None => [side(Sense::Minimize), side(Sense::Maximize)],
            };
        }
        let value = p.rows.rhs[i];
        let far = |up: bool| match price[usize::from(up)].is_finite() {
            true => self.as_far(i, price[usize::from(up)], if up { 1.0 } else { -1.0 }),
            false => 0.0,
        };
        let end = |by: f64| {
            let size = value.abs() + by.abs();
            // What is left of a difference of equal numbers is rounding.
            match (value + by).abs() <= END_TOLERANCE * size && size.is_finite() {
                true => 0.0,
                false => rounded(value + by),
            }
        };
        let interval = [end(-far(false)), end(far(true))];
        RowRange {
            row: i,
            value,
            price: price.map(|y| rounded(y * self.sign)),
            interval,
        }
    }

    /// How far the right-hand side of a row goes in a direction before its price changes.
    fn as_far(&self, i: usize, price: f64, direction: f64) -> f64 {
        let mut d = Instance {
            columns: self.p.columns.clone(),
            ..Instance::default()
        };
        let t = d.columns.push(0.0, f64::INFINITY);
        for k in (0..self.p.row_count()).filter(|&k| !self.is_gone_row(k)) {
            let mut terms: Vec<(usize, f64)> = self.p.matrix.row(k).collect();
            if k == i {
                terms.push((t, -direction));
            }
            d.add_row(terms, self.p.rows.relation[k], self.p.rows.rhs[k]);
        }
        let mut terms: Vec<(usize, f64)> = self.cost.iter().copied().enumerate().collect();
        terms.push((t, -direction * price));
        let room = VALUE_TOLERANCE * (1.0 + self.value.abs());
        d.add_row(terms, Relation::Less, self.value + room);
        let furthest = self.ways.extreme(d, t, Sense::Maximize);
        furthest.map_or(0.0, |t| t.max(0.0))
    }

    fn cost_of(&self, j: usize) -> CostRange {
        let shift = self.p.row_count();
        let side = |sense| self.costs.extreme(self.dual_face(Some(j)), shift, sense);
        let (down, up) = (side(Sense::Minimize), side(Sense::Maximize));
        let fixed = self.p.columns.lower[j] == self.p.columns.upper[j];
        let c = self.cost[j];
        let at = |s: Option<f64>, far: f64| match s {
            _ if fixed => far,
            Some(s) => c + s,
            None => c,
        };
        let (low, high) = (at(down, f64::NEG_INFINITY), at(up, f64::INFINITY));
        let mut interval = [low * self.sign, high * self.sign].map(rounded);
        interval.sort_by(f64::total_cmp);
        CostRange {
            column: j,
            value: c * self.sign + 0.0,
            level: self.x[j],
            interval,
        }
    }
}
