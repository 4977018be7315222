//! The way back: points, multipliers and bases, step by step from the last to the first.

use super::super::form::Point;
use super::super::simplex::{Basis, State};
use super::{Doubleton, Presolved, Step};

/// A point of the program before, as far as the way back has come. Reduced costs are for the rows that are there again.
struct Back {
    x: Vec<f64>,
    y: Vec<f64>,
    d: Vec<f64>,
    columns: Vec<State>,
    rows: Vec<State>,
    /// Multipliers that prove infeasibility: costs are 0, and signs say where columns and rows are.
    ray: bool,
}

impl Presolved {
    /// A point and a basis of the program before, of those of the smaller one.
    pub(crate) fn restore(&self, point: &Point, basis: &[State]) -> (Point, Basis) {
        let mut back = self.begin(point, basis);
        self.steps.iter().rev().for_each(|s| back.undo(s));
        let basis = back.columns.into_iter().chain(back.rows).collect();
        let (x, y, d) = (back.x, back.y, back.d);
        (Point { x, y, d }, basis)
    }

    /// Multipliers that may prove the program before infeasible, of those that prove it of the smaller one.
    pub(crate) fn restore_ray(&self, y: &[f64]) -> Vec<f64> {
        let n = self.columns.len();
        let p = &self.problem;
        let reduced = |j: usize| -p.columns.line(j).map(|(i, a)| a * y[i]).sum::<f64>();
        let point = Point {
            x: vec![0.0; n],
            y: y.to_vec(),
            d: (0..n).map(reduced).collect(),
        };
        let mut back = self.begin(&point, &vec![State::Lower; n + y.len()]);
        back.ray = true;
        self.steps.iter().rev().for_each(|s| back.undo(s));
        back.y
    }

    fn begin(&self, point: &Point, basis: &[State]) -> Back {
        let [m, n] = self.size;
        let mut back = Back {
            x: vec![0.0; n],
            y: vec![0.0; m],
            d: vec![0.0; n],
            columns: vec![State::Lower; n],
            rows: vec![State::Basic; m],
            ray: false,
        };
        for (k, &j) in self.columns.iter().enumerate() {
            let j = j as usize;
            (back.x[j], back.d[j], back.columns[j]) = (point.x[k], point.d[k], basis[k]);
        }
        for (k, &i) in self.rows.iter().enumerate() {
            let i = i as usize;
            let state = basis[self.columns.len() + k];
            // An equation is at the side that its multiplier says.
            let fixed = self.problem.row_lower[k] == self.problem.row_upper[k];
            let state = match state {
                State::Lower | State::Upper if fixed => by_sign(point.y[k]),
                state => state,
            };
            (back.y[i], back.rows[i]) = (point.y[k], state);
        }
        back
    }
}

/// Where what has this reduced cost is.
fn by_sign(d: f64) -> State {
    if d < 0.0 { State::Upper } else { State::Lower }
}

/// Whether a state is at a bound that is marked.
fn is_at(state: State, marked: [bool; 2]) -> bool {
    match state {
        State::Lower => marked[0],
        State::Upper => marked[1],
        State::Basic | State::Free => false,
    }
}

fn opposite(state: State) -> State {
    match state {
        State::Lower => State::Upper,
        State::Upper => State::Lower,
        other => other,
    }
}

/// The bound that a value is nearer to.
fn nearest(x: f64, [l, u]: [f64; 2]) -> State {
    if u.is_infinite() || (x - l).abs() <= (u - x).abs() {
        State::Lower
    } else {
        State::Upper
    }
}

impl Back {
    /// Where a column is; the sign of its reduced cost says at which of two equal bounds.
    fn column_state(&mut self, j: usize, fixed: bool) -> State {
        let d = self.d[j];
        self.columns[j] = match self.columns[j] {
            _ if self.ray && d == 0.0 => State::Basic,
            _ if self.ray => by_sign(d),
            State::Lower | State::Upper if fixed => by_sign(d),
            state => state,
        };
        self.columns[j]
    }

    fn cost(&self, cost: f64) -> f64 {
        if self.ray { 0.0 } else { cost }
    }

    /// Σ a·v over entries.
    fn sum(entries: &[(u32, f64)], v: &[f64]) -> f64 {
        entries.iter().map(|&(k, a)| a * v[k as usize]).sum()
    }

    fn undo(&mut self, step: &Step) {
        match step {
            Step::Idle(row) => self.rows[*row as usize] = State::Basic,
            Step::Fixed {
                column,
                value,
                state,
                cost,
                entries,
            } => {
                let j = *column as usize;
                self.x[j] = *value;
                self.d[j] = self.cost(*cost) - Self::sum(entries, &self.y);
                self.columns[j] = match state {
                    State::Basic => by_sign(self.d[j]),
                    state => *state,
                };
            }
            Step::Singleton {
                row,
                column,
                a,
                from_row,
                fixed,
            } => {
                let (i, j) = (*row as usize, *column as usize);
                let state = self.column_state(j, *fixed);
                if is_at(state, *from_row) {
                    self.rows[i] = if *a > 0.0 { state } else { opposite(state) };
                    self.columns[j] = State::Basic;
                    self.y[i] = std::mem::take(&mut self.d[j]) / a;
                }
            }
            Step::Forcing {
                row,
                upper,
                entries,
            } => self.forcing(*row as usize, *upper, entries),
            Step::Substituted { .. } => self.substituted(step),
            Step::Exchanged {
                row,
                column,
                a,
                entries,
            } => {
                let (i, j) = (*row as usize, *column as usize);
                self.rows[i] = std::mem::replace(&mut self.columns[j], State::Basic);
                self.y[i] = std::mem::take(&mut self.d[j]);
                self.x[j] = (self.x[j] - Self::sum(entries, &self.x)) / a;
            }
        }
    }

    /// The multiplier for which all columns may stay at their bounds; one of them becomes basic.
    fn forcing(&mut self, i: usize, upper: bool, entries: &[(u32, f64)]) {
        let mut worst = (0.0, None);
        for &(j, a) in entries {
            let y = self.d[j as usize] / a;
            if if upper { y < worst.0 } else { y > worst.0 } {
                worst = (y, Some(j as usize));
            }
        }
        let (y, Some(basic)) = worst else {
            return;
        };
        self.y[i] = y;
        self.rows[i] = if upper { State::Upper } else { State::Lower };
        entries
            .iter()
            .for_each(|&(j, a)| self.d[j as usize] -= a * y);
        self.d[basic] = 0.0;
        self.columns[basic] = State::Basic;
    }

    fn substituted(&mut self, step: &Step) {
        let Step::Substituted {
            row,
            column,
            a,
            cost,
            side,
            at,
            entries,
            others,
            doubleton,
        } = step
        else {
            return;
        };
        let (i, j) = (*row as usize, *column as usize);
        self.y[i] = (self.cost(*cost) - Self::sum(others, &self.y)) / a;
        self.x[j] = (side - Self::sum(entries, &self.x)) / a;
        self.d[j] = 0.0;
        self.columns[j] = State::Basic;
        self.rows[i] = *at;
        let Some(Doubleton {
            other,
            b,
            from_gone,
            fixed,
            bounds,
        }) = doubleton
        else {
            return;
        };
        let k = *other as usize;
        if is_at(self.column_state(k, *fixed), *from_gone) {
            let d = std::mem::take(&mut self.d[k]);
            self.y[i] += d / b;
            self.d[j] = -a * d / b;
            self.columns[k] = State::Basic;
            self.columns[j] = nearest(self.x[j], *bounds);
        }
    }
}
