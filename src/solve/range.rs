//! Sensitivity of a linear program: in which interval of a right-hand side a price holds, in which interval of a cost the
//! point stays optimal.
//!
//! All is asked of one basis, factorised once. Around the optimal point x the program is the cone of the directions in which x
//! can move,
//!
//! ```text
//!     min cᵀΔ   subject to   A Δ − s = 0,   (Δ, s) ≥ 0 where x is at a lower bound, ≤ 0 where it is at an upper one,
//! ```
//!
//! whose least value is 0, at 0. Given that one variable moves by 1 or −1 it is
//!
//! * for a row, what its right-hand side is worth on that side: the price, or that nothing is feasible there;
//! * for a column, by how much its cost must change until moving it costs nothing: the interval of the cost.
//!
//! The basis of x is optimal for the cone too, and begins each of these programs: where it stays optimal, the classical ratio
//! tests say all (one solve with the factor for each); else, at a degenerate vertex, the dual simplex method goes on from
//! there, so prices are one-sided as they must be. A price holds as far as the row can go while what its multipliers hold at a
//! bound stays there; that is one ratio test where the optimum is the only one, and a few primal pivots where it is not.

use super::answer::subproblem;
use super::backend::Task;
use super::lp::Ended;
use super::lp::form::{Form, Sparse};
use super::lp::scale::Scaling;
use super::lp::simplex::{Simplex, State};
use super::{Budget, ModelStatus, Quiet, Settings};
use crate::model::instance::{Instance, Relation};
use crate::model::outcome::Basis;
use crate::model::problem_type::ProblemType;

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
    /// Some are missing: a limit of time was reached, or numbers broke down.
    pub unfinished: bool,
}

/// How near to a bound is at it, relative to the two.
const NEAR: f64 = 1e-10;
/// The error of a row's level, relative to its largest term: that of columns that were solved for.
const TERM_ROUNDING: f64 = 1e-13;
/// A multiplier below this is 0, in the units of the scaled program.
const NO_PRICE: f64 = 1e-9;
/// An end nearer to 0 than this, relative to the number and the way from it, is 0.
const END_TOLERANCE: f64 = 1e-10;
/// A sum below this is rounding, relative to its terms.
const ROUNDING: f64 = 1e-12;
/// A direction in which one variable moves this much farther than another is none, where that is in doubt.
const STEEP: f64 = 1e9;
/// A movement or pivot below this is rounding, in the units of the scaled program.
const PIVOT: f64 = 1e-9;
/// Updates after which a factor still counts as fresh: what comes out is computed anew at the end.
const TRUSTED: usize = 30;

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
    let mut out = Ranges::default();
    let Some(mut cone) = Cone::new(p, x, activity, in_time) else {
        out.unfinished = p.objective.is_some();
        return out;
    };
    let numbered = |all: &[u32]| all.iter().map(|i| *i as usize).enumerate().collect();
    let rows: Vec<(usize, usize)> = numbered(&cone.form.rows);
    for (k, i) in rows.into_iter().filter(|r| wanted_row(r.1)) {
        let found = in_time().then(|| cone.row(k, i)).flatten();
        out.unfinished |= found.is_none();
        out.rows.extend(found);
    }
    let columns: Vec<(usize, usize)> = numbered(&cone.form.columns);
    for (k, j) in columns.into_iter().filter(|c| wanted_column(c.1)) {
        let found = in_time().then(|| cone.column(k, j)).flatten();
        out.unfinished |= found.is_none();
        out.costs.extend(found);
    }
    out
}

/// `size`: the largest term of a sum a, whose rounding counts.
fn near(a: f64, b: f64, size: f64) -> bool {
    let error = (NEAR * a.abs().max(b.abs()).max(1.0)).max(TERM_ROUNDING * size);
    b.is_finite() && (a - b).abs() <= error
}

/// The largest term of a row.
fn largest_term(p: &Instance, x: &[f64], i: usize) -> f64 {
    let terms = p.matrix.row(i).map(|(j, a)| (a * x[j]).abs());
    terms.fold(0.0, f64::max)
}

/// A number without the rounding of a linear program: the nearest with eleven digits.
fn rounded(x: f64) -> f64 {
    match x.is_finite() && x != 0.0 {
        true => format!("{x:.10e}").parse().unwrap_or(x),
        false => x,
    }
}

/// The end of a range that goes so far from a number. What is left of a difference of equal numbers is rounding.
fn end(from: f64, by: f64) -> f64 {
    let size = from.abs() + by.abs();
    match (from + by).abs() <= END_TOLERANCE * size && size.is_finite() {
        true => 0.0,
        false => rounded(from + by),
    }
}

/// The cone of the directions in which an optimal point can move, in scaled units. Variables are counted as in [`Simplex`]:
/// columns, then rows.
struct Cone<'a> {
    p: &'a Instance,
    form: Form,
    scaling: Scaling,
    x: Vec<f64>,
    activity: Vec<f64>,
    in_time: &'a dyn Fn() -> bool,
    /// How far each variable can go down and up to its bounds: 0 at a bound.
    room: Vec<[f64; 2]>,
    /// The matrix in scaled units, by columns.
    columns: Sparse,
    /// At an optimal basis of the cone, and its multipliers.
    engine: Simplex,
    at_rest: Vec<f64>,
    /// Its optimum is the only one: what is at a bound has a reduced cost that holds it there.
    is_unique: bool,
}

impl<'a> Cone<'a> {
    /// The cone of a point, or where that is not optimal enough, of the one that the simplex method ends at from there.
    fn new(
        p: &'a Instance,
        x: &[f64],
        activity: &[f64],
        in_time: &'a dyn Fn() -> bool,
    ) -> Option<Self> {
        p.objective?;
        let inside = |v: f64, l: f64, u: f64| match (near(v, l, 0.0), near(v, u, 0.0)) {
            (false, false) => State::Basic,
            (true, _) => State::Lower,
            _ => State::Upper,
        };
        let columns = (0..x.len()).map(|j| inside(x[j], p.columns.lower[j], p.columns.upper[j]));
        let binds = |i: usize| near(activity[i], p.rows.rhs[i], largest_term(p, x, i));
        let rows = (0..p.row_count()).map(|i| match binds(i) {
            false => State::Basic,
            true if p.rows.relation[i] == Relation::Less => State::Upper,
            true => State::Lower,
        });
        let start: Basis = columns.chain(rows).collect();
        let task = Task {
            basis: Some(&start),
            ..Task::new(ProblemType::Lp, p)
        };
        let mut quiet = Quiet::default();
        let budget = Budget::unlimited(&mut quiet);
        let a = subproblem(&task, &Settings::default(), &budget).ok()?;
        let basis = (a.status == ModelStatus::Optimal).then_some(a.outcome.basis)??;
        let (level, reached) = (&a.outcome.level, &a.activity);
        Self::at(p, x, activity, &basis, in_time)
            .or_else(|| Self::at(p, level, reached, &basis, in_time))
    }

    fn at(
        p: &'a Instance,
        x: &[f64],
        activity: &[f64],
        basis: &Basis,
        in_time: &'a dyn Fn() -> bool,
    ) -> Option<Self> {
        let form = Form::new(p).ok()?;
        let scaling = Scaling::new(&form.problem);
        let room = |v: f64, size: f64, [l, u]: [f64; 2], unit: f64| {
            let by = |bound: f64| {
                if near(v, bound, size) {
                    0.0
                } else {
                    (bound - v) / unit
                }
            };
            [by(l).min(0.0), by(u).max(0.0)]
        };
        let q = &form.problem;
        let columns = form.columns.iter().enumerate().map(|(k, &j)| {
            let unit = scaling.column[k] * scaling.size;
            room(x[j as usize], 0.0, [q.lower[k], q.upper[k]], unit)
        });
        let rows = form.rows.iter().enumerate().map(|(k, &i)| {
            let unit = scaling.size / scaling.row[k];
            let (i, sides) = (i as usize, [q.row_lower[k], q.row_upper[k]]);
            room(activity[i], largest_term(p, x, i), sides, unit)
        });
        let room: Vec<[f64; 2]> = columns.chain(rows).collect();
        let scaled = scaling.apply(q);
        let mut engine = Simplex::new(&scaled);
        for (v, room) in room.iter().enumerate() {
            let [lower, upper] = room.map(|r| if r == 0.0 { 0.0 } else { r * f64::INFINITY });
            engine.set_bounds(v, lower, upper);
        }
        let ended = engine.solve_from_basis(&form.basis(basis), &mut |_| None);
        let at_rest = engine.point().filter(|_| ended == Ended::Solved)?.y;
        engine.trusted = TRUSTED;
        let held = |v: usize| engine.is_basic(v) || engine.reduced()[v].abs() > NO_PRICE;
        let is_unique = (0..room.len()).all(|v| room[v] == [0.0; 2] || held(v));
        Some(Self {
            is_unique,
            p,
            x: x.to_vec(),
            activity: activity.to_vec(),
            in_time,
            room,
            columns: scaled.columns,
            engine,
            at_rest,
            form,
            scaling,
        })
    }

    /// How far a nonbasic variable goes in a direction with the basis as it is; None where another one has to come at once.
    fn ratio(&mut self, v: usize, direction: f64) -> Option<f64> {
        let mut far = f64::INFINITY;
        for (k, rate) in self.engine.direction(v)? {
            let rate = rate * direction;
            let room = self.room[k][usize::from(rate > 0.0)];
            match rate.abs() > PIVOT {
                true if room == 0.0 => return None,
                true => far = far.min(room / rate),
                false => {}
            }
        }
        Some(far)
    }

    /// What the cost of a basic variable has to change by until it moves in a direction, after one pivot; None where that takes
    /// more.
    fn dual_ratio(&mut self, v: usize, direction: f64) -> Option<f64> {
        let mut least = (f64::INFINITY, None);
        for (j, a) in self.engine.tableau_row(v)? {
            let way = -(a * direction).signum();
            if a.abs() > PIVOT && self.room[j][usize::from(way > 0.0)] != 0.0 {
                let reduced = self.engine.reduced()[j].abs();
                let ratio = match reduced <= ROUNDING {
                    true => 0.0,
                    false => reduced / a.abs(),
                };
                if ratio < least.0 {
                    least = (ratio, Some((j, way)));
                }
            }
        }
        if let Some((entering, way)) = least.1 {
            self.ratio(entering, way)?;
        }
        Some(least.0)
    }

    /// Solves again after bounds or costs have changed.
    fn solved(&self, mut s: Simplex) -> (Ended, Simplex) {
        let in_time = self.in_time;
        let ended = s.resolve(&mut |_| (!in_time()).then_some(Ended::Time));
        (ended, s)
    }

    /// The cone's optimum with other bounds for a variable; inner None: no direction is like this.
    fn least(&self, v: usize, [lower, upper]: [f64; 2]) -> Option<Option<(Simplex, Vec<f64>)>> {
        let mut s = self.engine.clone();
        s.set_bounds(v, lower, upper);
        let (mut ended, mut s) = self.solved(s);
        if ended == Ended::Failed {
            // What cannot be proved with infinite bounds because of rounding can with these.
            s = self.engine.clone();
            for (k, room) in self.room.iter().enumerate() {
                let [low, high] = room.map(|r| if r == 0.0 { 0.0 } else { STEEP.copysign(r) });
                s.set_bounds(k, low, high);
            }
            s.set_bounds(v, lower.max(-STEEP), upper.min(STEEP));
            (ended, s) = self.solved(s);
            if s.values().iter().any(|x| x.abs() >= 0.5 * STEEP) {
                return Some(None);
            }
        }
        match ended {
            Ended::Solved => s.prices().map(|y| Some((s, y))),
            Ended::Infeasible(_) => Some(None),
            _ => None,
        }
    }

    /// How far a variable goes in a direction while all stays at its bound that has a reduced cost.
    fn furthest(&self, mut s: Simplex, v: usize, direction: f64) -> Option<f64> {
        let held: Vec<bool> = s.reduced().iter().map(|d| d.abs() > NO_PRICE).collect();
        for (k, &held) in held.iter().enumerate() {
            let [lower, upper] = match held {
                _ if k == v && direction > 0.0 => [0.0, f64::INFINITY],
                _ if k == v => [f64::NEG_INFINITY, 0.0],
                true => [0.0, 0.0],
                false => self.room[k],
            };
            s.set_bounds(k, lower, upper);
            s.set_cost(k, if k == v { -direction } else { 0.0 });
        }
        match self.solved(s) {
            (Ended::Solved, mut s) => s.fresh_values().map(|x| x[v].abs()),
            (Ended::Unbounded(_), _) => Some(f64::INFINITY),
            _ => None,
        }
    }

    fn row(&mut self, k: usize, i: usize) -> Option<RowRange> {
        let v = self.form.columns.len() + k;
        let (value, relation) = (self.p.rows.rhs[i], self.p.rows.relation[i]);
        let tight = relation == Relation::Equal
            || near(self.activity[i], value, largest_term(self.p, &self.x, i));
        let unit = self.scaling.size / self.scaling.row[k];
        let worth = self.scaling.price * self.scaling.row[k];
        // The price and how far it holds when the right-hand side moves so.
        let mut side = |direction: f64| {
            let loosens = match relation {
                Relation::Less => direction > 0.0,
                Relation::Greater => direction < 0.0,
                _ => false,
            };
            if !tight && loosens {
                return Some((0.0, f64::INFINITY));
            }
            let spare = match tight {
                true => 0.0,
                false => (self.activity[i] - value).abs(),
            };
            if self.is_unique && !tight {
                return Some((0.0, spare));
            }
            let y = self.at_rest[k];
            if !self.engine.is_basic(v)
                && y.abs() > NO_PRICE
                && let Some(far) = self.ratio(v, direction)
            {
                let far = match self.is_unique || far.is_infinite() {
                    true => far,
                    false => self.furthest(self.engine.clone(), v, direction)?,
                };
                return Some((y * worth, far * unit));
            }
            let bounds = match relation {
                Relation::Less => [f64::NEG_INFINITY, direction],
                Relation::Greater => [direction, f64::INFINITY],
                _ => [direction; 2],
            };
            let at = match tight {
                true => self.least(v, bounds)?,
                false => Some((self.engine.clone(), self.at_rest.clone())),
            };
            let Some((engine, y)) = at else {
                return Some((direction * f64::INFINITY, 0.0));
            };
            let y = y[k];
            if engine.is_basic(v) || y.abs() <= NO_PRICE {
                if loosens {
                    return Some((0.0, f64::INFINITY));
                }
                return Some((0.0, spare + self.furthest(engine, v, direction)? * unit));
            }
            Some((y * worth, self.furthest(engine, v, direction)? * unit))
        };
        let (below, above) = (side(-1.0)?, side(1.0)?);
        Some(RowRange {
            row: i,
            value,
            price: [below.0, above.0].map(|y| rounded(y * self.form.sign)),
            interval: [end(value, -below.1), end(value, above.1)],
        })
    }

    fn column(&mut self, k: usize, j: usize) -> Option<CostRange> {
        let unit = self.scaling.price / self.scaling.column[k];
        let cost = self.form.problem.cost[k];
        // The cost with which the column would go this way: what the multipliers say that it is worth.
        let mut side = |direction: f64| {
            let stuck = self.room[k][usize::from(direction > 0.0)] == 0.0;
            let at = match self.engine.is_basic(k) {
                _ if stuck => None,
                true => match self.dual_ratio(k, direction) {
                    Some(0.0) => return Some(cost),
                    Some(by) => return Some(end(cost, -direction * by * unit)),
                    None => self.least(k, [direction; 2])?.map(|f| f.1),
                },
                false => match self.ratio(k, direction) {
                    Some(_) => Some(self.at_rest.clone()),
                    None => self.least(k, [direction; 2])?.map(|f| f.1),
                },
            };
            let Some(y) = at else {
                return Some(-direction * f64::INFINITY);
            };
            let terms = self.columns.line(k).map(|(i, a)| a * y[i]);
            let (worth, size) = terms.fold((0.0, 0.0), |(w, s), t: f64| (w + t, s + t.abs()));
            let worth = match worth.abs() <= ROUNDING * size {
                true => 0.0,
                false => worth * unit,
            };
            Some(match (cost - worth) * direction > 0.0 {
                true => rounded(worth),
                false => cost,
            })
        };
        let mut interval = [side(1.0)?, side(-1.0)?].map(|c| c * self.form.sign + 0.0);
        interval.sort_by(f64::total_cmp);
        Some(CostRange {
            column: j,
            value: cost * self.form.sign + 0.0,
            level: self.x[j],
            interval,
        })
    }
}
