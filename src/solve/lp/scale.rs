//! Scaling of a [`Problem`]: x = C x', rows R A C, one factor for right-hand sides and bounds and
//! one for costs.
//!
//! All factors are powers of two, so scaling and unscaling are exact: the scaled problem *is* the
//! problem, in other units. Rows and columns are brought near 1 by a few sweeps of geometric means
//! and a last one by the largest entry of each column (Tomlin 1975).

use super::form::{Point, Problem};

/// Factors of a scaling.
#[derive(Clone, Debug)]
pub struct Scaling {
    /// Row factors R.
    pub row: Vec<f64>,
    /// Column factors C: x = C x' · `size`.
    pub column: Vec<f64>,
    /// Unit of right-hand sides and bounds.
    pub size: f64,
    /// Unit of costs.
    pub price: f64,
}

/// The power of two nearest to `x` (in ratio); 1 for 0 and for what is not finite.
fn power_of_two(x: f64) -> f64 {
    if x > 0.0 && x.is_finite() {
        2f64.powi((x.log2().round() as i32).clamp(-500, 500))
    } else {
        1.0
    }
}

/// Geometric mean of the nonzero finite magnitudes, 1 if there are none.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0usize);
    for v in values.map(f64::abs) {
        if v > 0.0 && v.is_finite() {
            sum += v.log2();
            count += 1;
        }
    }
    if count == 0 {
        1.0
    } else {
        (sum / count as f64).exp2()
    }
}

/// Bounds so many times beyond what the rows ask for are as good as none: no point is near them.
const MAX_BOUND_RATIO: f64 = 1e6;

/// The size of right-hand sides and of the bounds that are not far beyond them.
fn size_of(p: &Problem, row: &[f64], column: &[f64]) -> f64 {
    let counts = |v: &f64| *v > 0.0 && v.is_finite();
    let sides = [&p.row_lower, &p.row_upper].map(|s| s.iter().zip(row));
    let sides = sides.into_iter().flatten().map(|(b, r)| (b * r).abs());
    let bounds = [&p.lower, &p.upper].map(|s| s.iter().zip(column));
    let bounds = bounds.into_iter().flatten().map(|(b, c)| (b / c).abs());
    let unit = match sides.clone().any(|s| counts(&s)) {
        true => mean(sides.clone()),
        false => bounds.clone().filter(counts).fold(f64::INFINITY, f64::min),
    };
    mean(sides.chain(bounds.filter(|b| *b <= MAX_BOUND_RATIO * unit)))
}

impl Scaling {
    /// Chooses factors for a problem.
    pub fn new(p: &Problem) -> Self {
        Self::choose(p, &vec![None; p.n()])
    }

    /// The same with these units for columns, where they are given, and the unit 1 for all bounds.
    pub fn with_units(p: &Problem, units: &[Option<f64>]) -> Self {
        Self {
            size: 1.0,
            ..Self::choose(p, units)
        }
    }

    /// For a program in steps: the first columns in these units, rows in that of their largest entry there, each other column, which has one
    /// entry, in that of its row; bounds in units of `size`.
    pub fn of_steps(p: &Problem, units: &[f64], size: f64) -> Self {
        let mut column: Vec<f64> = units.iter().map(|&u| power_of_two(u)).collect();
        let row: Vec<f64> = (0..p.m())
            .map(|i| {
                let own = p.rows.line(i).filter(|e| e.0 < units.len());
                let largest = own.map(|(j, v)| (v * column[j]).abs()).fold(0.0, f64::max);
                power_of_two(1.0 / largest)
            })
            .collect();
        let single = |j: usize| p.columns.line(j).next().map_or(1.0, |(i, _)| 1.0 / row[i]);
        column.extend((units.len()..p.n()).map(single));
        let costs = p.cost.iter().zip(&column).map(|(&q, &c)| q * c);
        Self {
            price: power_of_two(mean(costs)),
            size: power_of_two(size),
            row,
            column,
        }
    }

    fn choose(p: &Problem, units: &[Option<f64>]) -> Self {
        let mut row = vec![1.0; p.m()];
        let unit = |u: &Option<f64>| u.map_or(1.0, power_of_two);
        let mut column: Vec<f64> = units.iter().map(unit).collect();
        let free = |j: &usize| units[*j].is_none();
        // what does not move says nothing about a row's unit
        let moves = |e: &(usize, f64)| p.lower[e.0] < p.upper[e.0] || !free(&e.0);
        for _ in 0..4 {
            for (i, r) in row.iter_mut().enumerate() {
                let entries = p.rows.line(i).filter(moves);
                *r = 1.0 / extremes(entries.map(|(j, v)| v * column[j]));
            }
            for (j, c) in column.iter_mut().enumerate().filter(|e| free(&e.0)) {
                *c = 1.0 / extremes(p.columns.line(j).map(|(i, v)| v * row[i]));
            }
        }
        row.iter_mut().for_each(|r| *r = power_of_two(*r));
        for (j, c) in column.iter_mut().enumerate().filter(|e| free(&e.0)) {
            let largest = p.columns.line(j).map(|(i, v)| (v * row[i]).abs());
            *c = match largest.fold(0.0, f64::max) {
                0.0 => 1.0,
                v => power_of_two(1.0 / v),
            };
        }
        let size = power_of_two(size_of(p, &row, &column));
        let price = power_of_two(mean(p.cost.iter().zip(&column).map(|(&q, &c)| q * c)));
        Self {
            row,
            column,
            size,
            price,
        }
    }

    /// The problem in the new units.
    pub fn apply(&self, p: &Problem) -> Problem {
        let mut s = p.clone();
        for (j, &c) in self.column.iter().enumerate() {
            s.cost[j] *= c / self.price;
            s.lower[j] /= c * self.size;
            s.upper[j] /= c * self.size;
            for k in s.columns.start[j]..s.columns.start[j + 1] {
                s.columns.value[k] *= c * self.row[s.columns.index[k] as usize];
            }
        }
        for (i, &r) in self.row.iter().enumerate() {
            s.row_lower[i] *= r / self.size;
            s.row_upper[i] *= r / self.size;
            for k in s.rows.start[i]..s.rows.start[i + 1] {
                s.rows.value[k] *= r * self.column[s.rows.index[k] as usize];
            }
        }
        s.offset /= self.price * self.size;
        s
    }

    /// A point in the old units.
    pub fn restore(&self, mut p: Point) -> Point {
        self.change(&mut p, |v, unit| *v *= unit);
        p
    }

    /// A point in the new units.
    pub fn carry(&self, mut p: Point) -> Point {
        self.change(&mut p, |v, unit| *v /= unit);
        p
    }

    /// Does this to each number of a point with what its new unit is in the old ones.
    fn change(&self, p: &mut Point, change: impl Fn(&mut f64, f64)) {
        let columns = || self.column.iter();
        let x = p.x.iter_mut().zip(columns());
        x.for_each(|(x, c)| change(x, c * self.size));
        let d = p.d.iter_mut().zip(columns());
        d.for_each(|(d, c)| change(d, self.price / c));
        let y = p.y.iter_mut().zip(&self.row);
        y.for_each(|(y, r)| change(y, self.price * r));
    }

    /// Whether no number of the scaled problem left the range in which scaling is exact.
    pub fn is_exact(&self, p: &Problem, scaled: &Problem) -> bool {
        let normal = |a: &[f64], b: &[f64]| {
            a.iter()
                .zip(b)
                .all(|(a, b)| *a == 0.0 || a.is_infinite() || b.is_normal())
        };
        normal(&p.rows.value, &scaled.rows.value)
            && normal(&p.columns.value, &scaled.columns.value)
            && normal(&p.cost, &scaled.cost)
            && normal(&p.lower, &scaled.lower)
            && normal(&p.upper, &scaled.upper)
            && normal(&p.row_lower, &scaled.row_lower)
            && normal(&p.row_upper, &scaled.row_upper)
    }

    /// A direction of columns in the old units.
    pub fn restore_direction(&self, x: &mut [f64]) {
        x.iter_mut().zip(&self.column).for_each(|(x, &c)| *x *= c);
    }

    /// Row multipliers of a proof of infeasibility in the old units.
    pub fn restore_multipliers(&self, y: &mut [f64]) {
        y.iter_mut().zip(&self.row).for_each(|(y, &r)| *y *= r);
    }

    /// The same into the new units.
    pub fn carry_multipliers(&self, y: &mut [f64]) {
        y.iter_mut().zip(&self.row).for_each(|(y, &r)| *y /= r);
    }
}

/// Entries this small against the largest of their line are rounding of data, not a unit to scale by.
const ROUNDING: f64 = 1e-12;

/// √(smallest · largest) of the magnitudes above rounding, 1 if there are none.
fn extremes(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let high = values.clone().fold(0.0, |h: f64, v| h.max(v.abs()));
    let low = values.map(f64::abs).filter(|&v| v > ROUNDING * high);
    let low = low.fold(f64::INFINITY, f64::min);
    if high > 0.0 && low.is_finite() {
        (low * high).sqrt()
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::lp::form::Sparse;

    /// Geometric means would make an entry count that changes nothing.
    #[test]
    fn what_changes_nothing_in_a_step_stays_small() {
        let mut rows = Sparse::default();
        rows.push([(0, 1e3), (1, 1e-20)]);
        rows.push([(1, 5.0), (2, 1.0)]);
        let problem = Problem {
            cost: vec![1.0, 1.0, 10.0],
            lower: vec![-0.5, -4.0, 0.0],
            upper: vec![0.5, 4.0, f64::INFINITY],
            row_lower: vec![1.0; 2],
            row_upper: vec![1.0; 2],
            columns: rows.transpose(3),
            rows,
            ..Problem::default()
        };
        let scaled = Scaling::of_steps(&problem, &[1.0, 8.0], 0.5).apply(&problem);
        let entries = scaled.rows.value;
        let near = |v: f64| (0.5..=2.0).contains(&v.abs());
        assert!(near(entries[0]) && near(entries[2]) && near(entries[3]));
        assert!(entries[1] < 1e-19);
        assert_eq!(scaled.upper[..2], [1.0, 1.0]);
    }
}
