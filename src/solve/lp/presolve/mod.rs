//! A smaller program with the same optimum, and the way back from its points and bases.
//!
//! Each [`Step`] removes a row, a column or both, and says how a basis of the program after it becomes one of the
//! program before it that is optimal if the other was (Andersen & Andersen 1995; Gondzio 1997):
//!
//! * a row of one column becomes bounds; a row that bounds imply goes; one that only one point can hold fixes it (*forcing*);
//! * an equation gives a column as a combination of others where its bounds follow from theirs, or where there is but one other;
//! * a free column gives its place to the activity of an inequality, which becomes the bounds of a column.
//!
//! The data of the smaller program are rounded. That is harmless: the basis is what comes back, and the simplex method goes
//! on from it in the program as it was given.

mod columns;
mod restore;
mod rows;

use super::form::{Activity, Problem, Sparse, term};
use super::simplex::State;

/// Rounds over all rows and columns that have changed, at most.
const ROUNDS: usize = 30;

/// A difference this small, against the terms that it is of, is rounding.
const ROUNDING: f64 = 1e-12;

type Entries = Box<[(u32, f64)]>;

/// What was taken away, for the way back.
#[derive(Debug)]
enum Step {
    /// A row that says nothing.
    Idle(u32),
    /// A column at a value, which is a bound (Basic: both); its entries in the rows that were left.
    Fixed {
        column: u32,
        value: f64,
        state: State,
        cost: f64,
        entries: Entries,
    },
    /// A row a·x between two sides that became bounds; which of the column's bounds are the row's.
    Singleton {
        row: u32,
        column: u32,
        a: f64,
        from_row: [bool; 2],
        /// The bounds are one.
        fixed: bool,
    },
    /// A row that holds at one point only, at its upper side or its lower one.
    Forcing {
        row: u32,
        upper: bool,
        entries: Entries,
    },
    /// A column that a row at its side gives by the others.
    Substituted {
        row: u32,
        column: u32,
        a: f64,
        cost: f64,
        side: f64,
        at: State,
        /// The row without the column.
        entries: Entries,
        /// The column without the row.
        others: Entries,
        doubleton: Option<Doubleton>,
    },
    /// A free column that stands for what the row, gone since, adds up to.
    Exchanged {
        row: u32,
        column: u32,
        a: f64,
        /// The row without the column.
        entries: Entries,
    },
}

/// The other column of an equation in two, and which of its bounds stem from the one that went.
#[derive(Debug)]
struct Doubleton {
    other: u32,
    b: f64,
    from_gone: [bool; 2],
    /// Its bounds are one.
    fixed: bool,
    /// Of the one that went.
    bounds: [f64; 2],
}

/// The way back from a smaller program.
pub(super) struct Presolved {
    /// The smaller program.
    pub problem: Problem,
    columns: Vec<u32>,
    rows: Vec<u32>,
    steps: Vec<Step>,
    /// Of the program before.
    size: [usize; 2],
    /// Multipliers that prove the smaller program infeasible: of a row that bounds contradict.
    pub proof: Option<Vec<f64>>,
}

/// Why there is no smaller program: no point, since bounds contradict this row if it is known, or no bound.
struct Hopeless(Option<u32>);

/// The program while it shrinks. What has gone is marked; entries of it are passed over.
struct Work {
    rows: Vec<Vec<(u32, f64)>>,
    /// Rows of each column; some may have lost their entry.
    columns: Vec<Vec<u32>>,
    row_alive: Vec<bool>,
    column_alive: Vec<bool>,
    row_count: Vec<u32>,
    column_count: Vec<u32>,
    cost: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    row_lower: Vec<f64>,
    row_upper: Vec<f64>,
    steps: Vec<Step>,
    new_rows: Queue,
    new_columns: Queue,
}

/// What is to be looked at again, each once.
struct Queue {
    list: Vec<u32>,
    waits: Vec<bool>,
}

impl Queue {
    fn full(n: usize) -> Self {
        Self {
            list: (0..n as u32).collect(),
            waits: vec![true; n],
        }
    }

    fn push(&mut self, k: usize) {
        if !std::mem::replace(&mut self.waits[k], true) {
            self.list.push(k as u32);
        }
    }

    fn take(&mut self) -> Vec<u32> {
        let list = std::mem::take(&mut self.list);
        list.iter().for_each(|&k| self.waits[k as usize] = false);
        list
    }
}

/// The smaller program. None: nothing came of it, or it was found to have no solution, which the program itself proves.
pub(super) fn presolve(p: &Problem) -> Option<Presolved> {
    let mut work = Work::new(p);
    let contradicted = match work.run() {
        Ok(()) if work.steps.is_empty() => return None,
        Ok(()) => return Some(work.assemble(p)),
        Err(Hopeless(row)) => row?,
    };
    let mut reduced = work.assemble(p);
    let at = reduced.rows.binary_search(&contradicted).ok()?;
    reduced.proof = [1.0, -1.0].into_iter().find_map(|y| {
        let mut proof = vec![0.0; reduced.rows.len()];
        proof[at] = y;
        let proved = reduced.problem.proves_infeasible(&proof);
        proved.then_some(proof)
    });
    reduced.proof.is_some().then_some(reduced)
}

impl Work {
    fn new(p: &Problem) -> Self {
        let (m, n) = (p.m(), p.n());
        let rows: Vec<Vec<(u32, f64)>> = (0..m)
            .map(|i| {
                p.rows
                    .line(i)
                    .filter(|e| e.1 != 0.0)
                    .map(|(j, a)| (j as u32, a))
                    .collect()
            })
            .collect();
        let mut columns = vec![Vec::new(); n];
        for (i, row) in rows.iter().enumerate() {
            row.iter()
                .for_each(|&(j, _)| columns[j as usize].push(i as u32));
        }
        Self {
            row_count: rows.iter().map(|r| r.len() as u32).collect(),
            column_count: columns.iter().map(|c: &Vec<u32>| c.len() as u32).collect(),
            rows,
            columns,
            row_alive: vec![true; m],
            column_alive: vec![true; n],
            cost: p.cost.clone(),
            lower: p.lower.clone(),
            upper: p.upper.clone(),
            row_lower: p.row_lower.clone(),
            row_upper: p.row_upper.clone(),
            steps: Vec::new(),
            new_rows: Queue::full(m),
            new_columns: Queue::full(n),
        }
    }

    fn run(&mut self) -> Result<(), Hopeless> {
        for _ in 0..ROUNDS {
            for i in self.new_rows.take() {
                if self.row_alive[i as usize] {
                    self.row(i as usize)?;
                }
            }
            for j in self.new_columns.take() {
                if self.column_alive[j as usize] {
                    self.column(j as usize)?;
                }
            }
            if self.new_rows.list.is_empty() {
                break;
            }
        }
        Ok(())
    }

    /// The entries of a row in columns that are left.
    fn row_entries(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let entries = self.rows[i].iter().map(|&(j, a)| (j as usize, a));
        entries.filter(|e| self.column_alive[e.0])
    }

    /// The entries of a column in rows that are left.
    fn column_entries(&self, j: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let rows = self.columns[j].iter().map(|&i| i as usize);
        rows.filter(|&i| self.row_alive[i])
            .filter_map(move |i| Some((i, self.entry(i, j)?)))
    }

    fn entry(&self, i: usize, j: usize) -> Option<f64> {
        let row = &self.rows[i];
        let k = row.binary_search_by_key(&(j as u32), |e| e.0).ok()?;
        Some(row[k].1)
    }

    fn bounds(&self, j: usize) -> [f64; 2] {
        [self.lower[j], self.upper[j]]
    }

    fn sides(&self, i: usize) -> [f64; 2] {
        [self.row_lower[i], self.row_upper[i]]
    }

    fn is_equation(&self, i: usize) -> bool {
        self.row_lower[i] == self.row_upper[i]
    }

    /// The range of a row's activity within the bounds.
    fn activity(&self, i: usize) -> Activity {
        Activity::of(self.row_entries(i), &self.lower, &self.upper)
    }

    /// Takes a row away; its columns are looked at again.
    fn remove_row(&mut self, i: usize) {
        self.row_alive[i] = false;
        for k in 0..self.rows[i].len() {
            let j = self.rows[i][k].0 as usize;
            if self.column_alive[j] {
                self.column_count[j] -= 1;
                self.new_columns.push(j);
            }
        }
    }

    /// Takes a column away; its rows are looked at again.
    fn remove_column(&mut self, j: usize) {
        self.column_alive[j] = false;
        for k in 0..self.columns[j].len() {
            let i = self.columns[j][k] as usize;
            if self.row_alive[i] && self.entry(i, j).is_some() {
                self.row_count[i] -= 1;
                self.new_rows.push(i);
            }
        }
    }

    /// Fixes a column at one of its bounds, or at 0 if it has none; Basic: at both.
    fn fix(&mut self, j: usize, state: State) -> Result<(), Hopeless> {
        let value = match state {
            State::Upper => self.upper[j],
            State::Free => 0.0,
            _ => self.lower[j],
        };
        if !value.is_finite() {
            return Err(Hopeless(None));
        }
        let entries: Entries = self.column_entries(j).map(|(i, a)| (i as u32, a)).collect();
        for &(i, a) in &entries {
            self.row_lower[i as usize] -= a * value;
            self.row_upper[i as usize] -= a * value;
        }
        self.remove_column(j);
        self.steps.push(Step::Fixed {
            column: j as u32,
            value,
            state,
            cost: self.cost[j],
            entries,
        });
        Ok(())
    }

    /// New bounds of a column, where they are narrower; which of them are. Err: they cross.
    fn narrow(&mut self, j: usize, [l, u]: [f64; 2]) -> Result<[bool; 2], Hopeless> {
        let from_row = [l > self.lower[j], u < self.upper[j]];
        let (l, u) = (l.max(self.lower[j]), u.min(self.upper[j]));
        let (l, u) = match l > u {
            true if l - u > 1e-9 * l.abs().max(1.0) => return Err(Hopeless(None)),
            true if from_row[0] => (u, u),
            true => (l, l),
            false => (l, u),
        };
        (self.lower[j], self.upper[j]) = (l, u);
        if from_row[0] || from_row[1] {
            self.new_columns.push(j);
            for k in 0..self.columns[j].len() {
                let i = self.columns[j][k] as usize;
                if self.row_alive[i] {
                    self.new_rows.push(i);
                }
            }
        }
        Ok(from_row)
    }

    fn assemble(self, p: &Problem) -> Presolved {
        let kept = |alive: &[bool]| -> Vec<u32> {
            (0..alive.len() as u32)
                .filter(|&k| alive[k as usize])
                .collect()
        };
        let (rows, columns) = (kept(&self.row_alive), kept(&self.column_alive));
        let mut number = vec![0; p.n()];
        columns
            .iter()
            .enumerate()
            .for_each(|(k, &j)| number[j as usize] = k);
        let pick = |values: &[f64], places: &[u32]| -> Vec<f64> {
            places.iter().map(|&k| values[k as usize]).collect()
        };
        let mut lines = Sparse::default();
        for &i in &rows {
            lines.push(self.row_entries(i as usize).map(|(j, a)| (number[j], a)));
        }
        Presolved {
            problem: Problem {
                cost: pick(&self.cost, &columns),
                lower: pick(&self.lower, &columns),
                upper: pick(&self.upper, &columns),
                row_lower: pick(&self.row_lower, &rows),
                row_upper: pick(&self.row_upper, &rows),
                columns: lines.transpose(columns.len()),
                rows: lines,
                offset: 0.0,
            },
            columns,
            rows,
            steps: self.steps,
            size: [p.m(), p.n()],
            proof: None,
        }
    }
}
