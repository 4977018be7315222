//! Columns that are decided, and that equations give by others.

use super::{Activity, Doubleton, Entries, Hopeless, ROUNDING, State, Step, Work, term};

/// Rows of a column that is substituted, at most.
const LONGEST: u32 = 6;

/// Rows with more entries are not looked through for each of their columns.
const LONG_ROW: u32 = 1000;

/// Entries that a substitution may add to those that it takes away.
const FILL: usize = 4;

/// Rows of a column that changes places with one of them, at most.
const LONGEST_EXCHANGED: u32 = 20;

/// A pivot of a substitution against the largest entry of its column.
const PIVOT: f64 = 1e-2;

impl Work {
    /// What can be done about a column.
    pub(super) fn column(&mut self, j: usize) -> Result<(), Hopeless> {
        if self.lower[j] == self.upper[j] {
            return self.fix(j, State::Basic);
        }
        if self.fix_by_cost(j)? {
            return Ok(());
        }
        let count = self.column_count[j];
        match count {
            0 => Ok(()),
            1 => self.singleton_column(j),
            _ if count <= LONGEST && self.implied_free(j)? => Ok(()),
            _ if count <= LONGEST_EXCHANGED => {
                self.exchange(j);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Fixes a column that no row holds back on its way to where the cost is less.
    fn fix_by_cost(&mut self, j: usize) -> Result<bool, Hopeless> {
        let (mut down, mut up) = (self.cost[j] >= 0.0, self.cost[j] <= 0.0);
        for (i, a) in self.column_entries(j) {
            let [low, high] = self.sides(i);
            let held = [low.is_finite(), high.is_finite()];
            let (falls, rises) = if a > 0.0 {
                (held[0], held[1])
            } else {
                (held[1], held[0])
            };
            down &= !falls;
            up &= !rises;
            if !down && !up {
                return Ok(false);
            }
        }
        let state = match (self.lower[j].is_finite(), self.upper[j].is_finite()) {
            (true, _) if down => State::Lower,
            (_, true) if up => State::Upper,
            // The rows of a column that may go on for ever at no cost hold anyway.
            _ if self.cost[j] == 0.0 && self.column_count[j] > 0 => return Ok(false),
            _ if self.cost[j] == 0.0 => State::Free,
            _ => return Err(Hopeless(None)),
        };
        self.fix(j, state)?;
        Ok(true)
    }

    /// A column of one row, whose bounds the others of that row imply: given by it.
    fn singleton_column(&mut self, j: usize) -> Result<(), Hopeless> {
        let Some((i, a)) = self.column_entries(j).next() else {
            return Ok(());
        };
        if self.row_count[i] < 2
            || self.row_count[i] > LONG_ROW
            || self.is_implied(j, i, a, &self.activity(i)) != [true, true]
        {
            return Ok(());
        }
        let y = self.cost[j] / a;
        let at = match self.sides(i) {
            [low, high] if low == high => State::Lower,
            [low, _] if y > 0.0 || y == 0.0 && low.is_finite() => State::Lower,
            _ => State::Upper,
        };
        self.substitute(i, j, at, None)
    }

    /// Whether a row and the bounds of its other columns imply this one's.
    fn is_implied(&self, j: usize, i: usize, a: f64, range: &Activity) -> [bool; 2] {
        let [low, high] = range.without(term(a, self.bounds(j)));
        let [side_low, side_high] = self.sides(i);
        let ends = [(side_low - high) / a, (side_high - low) / a];
        let (l, u) = if a > 0.0 {
            (ends[0], ends[1])
        } else {
            (ends[1], ends[0])
        };
        let slack = |bound: f64| match bound.is_finite() {
            true => ROUNDING * (range.size / a.abs()).max(bound.abs()),
            false => 0.0,
        };
        [
            self.lower[j].is_infinite() || l >= self.lower[j] - slack(self.lower[j]),
            self.upper[j].is_infinite() || u <= self.upper[j] + slack(self.upper[j]),
        ]
    }

    /// A free column and an inequality change places: what the row adds up to is the column then, and the row is gone. Taken where the row is short
    /// and the matrix grows by a few entries at most. (A wall's contacts have four inequalities of three free forces: three of them become bounds.)
    fn exchange(&mut self, j: usize) {
        if self.lower[j].is_finite() || self.upper[j].is_finite() {
            return;
        }
        let entries: Vec<(usize, f64)> = self.column_entries(j).collect();
        let largest = entries.iter().fold(0.0f64, |t, e| t.max(e.1.abs()));
        let able = |e: &&(usize, f64)| !self.is_equation(e.0) && e.1.abs() >= PIVOT * largest;
        let best = entries.iter().filter(able);
        let Some(&(i, a)) = best.min_by_key(|e| (self.row_count[e.0], e.0)) else {
            return;
        };
        if self.row_count[i] > LONGEST {
            return;
        }
        let pick = |e: (usize, f64)| (e.0 as u32, e.1);
        let row: Entries = self.row_entries(i).filter(|e| e.0 != j).map(pick).collect();
        let others = entries.iter().filter(|e| e.0 != i);
        let new = others
            .clone()
            .flat_map(|&(r, _)| row.iter().map(move |&(k, _)| (r, k as usize)));
        let fill = new.filter(|&(r, k)| self.entry(r, k).is_none()).count();
        if fill > row.len() + FILL {
            return;
        }
        let cost = self.cost[j] / a;
        for &(k, v) in &row {
            self.change_cost(k as usize, v * cost);
        }
        self.cost[j] = cost;
        self.remove_row(i);
        for &(r, v) in others {
            self.add_multiple(r, &row, -v / a);
            if let Ok(k) = self.rows[r].binary_search_by_key(&(j as u32), |e| e.0) {
                self.rows[r][k].1 = v / a;
            }
        }
        (self.lower[j], self.upper[j]) = (self.row_lower[i], self.row_upper[i]);
        self.steps.push(Step::Exchanged {
            row: i as u32,
            column: j as u32,
            a,
            entries: row,
        });
    }

    /// Substitutes a column whose bounds its rows imply, by an equation; whether it did.
    fn implied_free(&mut self, j: usize) -> Result<bool, Hopeless> {
        let entries: Vec<(usize, f64)> = self.column_entries(j).collect();
        let largest = entries.iter().fold(0.0f64, |t, e| t.max(e.1.abs()));
        let mut implied = [self.lower[j].is_infinite(), self.upper[j].is_infinite()];
        let mut best: Option<(u32, usize)> = None;
        for &(i, a) in &entries {
            if self.is_equation(i) && a.abs() >= PIVOT * largest {
                let candidate = (self.row_count[i], i);
                best = Some(best.map_or(candidate, |b| b.min(candidate)));
            }
        }
        let Some((count, i)) = best else {
            return Ok(false);
        };
        let (rows, columns) = (entries.len(), count as usize);
        if (rows - 1) * (columns - 1) > rows + columns - 1 + FILL {
            return Ok(false);
        }
        for &(r, a) in &entries {
            if implied == [true, true] {
                break;
            }
            if self.row_count[r] > LONG_ROW {
                continue;
            }
            let more = self.is_implied(j, r, a, &self.activity(r));
            implied = [implied[0] || more[0], implied[1] || more[1]];
        }
        match implied {
            [true, true] => self.substitute(i, j, State::Lower, None).map(|()| true),
            _ => Ok(false),
        }
    }

    /// An equation in two columns gives one by the other, which takes its bounds over.
    pub(super) fn doubleton(&mut self, i: usize) -> Result<(), Hopeless> {
        let mut entries = self.row_entries(i);
        let (Some(one), Some(two)) = (entries.next(), entries.next()) else {
            return Ok(());
        };
        drop(entries);
        let rank = |e: (usize, f64)| (self.column_count[e.0], e.0);
        let (mut gone, mut kept) = if rank(one) <= rank(two) {
            (one, two)
        } else {
            (two, one)
        };
        if gone.1.abs() < PIVOT * kept.1.abs() {
            (gone, kept) = (kept, gone);
        }
        let ((j, a), (k, b)) = (gone, kept);
        if self.column_count[j] > 4 * LONGEST {
            return Ok(());
        }
        let (bounds, side) = (self.bounds(j), self.row_lower[i]);
        // x_k = (side − a·x_j) / b
        let [low, high] = term(a, bounds);
        let ends = [(side - high) / b, (side - low) / b];
        let from_gone = self.narrow(k, if b > 0.0 { ends } else { [ends[1], ends[0]] })?;
        let doubleton = Doubleton {
            other: k as u32,
            b,
            from_gone,
            fixed: self.lower[k] == self.upper[k],
            bounds,
        };
        self.substitute(i, j, State::Lower, Some(doubleton))
    }

    /// Takes away a row, which stands at one of its sides, and a column, which it gives.
    fn substitute(
        &mut self,
        i: usize,
        j: usize,
        at: State,
        doubleton: Option<Doubleton>,
    ) -> Result<(), Hopeless> {
        let side = match at {
            State::Upper => self.row_upper[i],
            _ => self.row_lower[i],
        };
        if !side.is_finite() {
            return Err(Hopeless(None));
        }
        let Some(a) = self.entry(i, j) else {
            return Ok(());
        };
        let pick = |e: (usize, f64)| (e.0 as u32, e.1);
        let entries: Entries = self.row_entries(i).filter(|e| e.0 != j).map(pick).collect();
        let others: Entries = self
            .column_entries(j)
            .filter(|e| e.0 != i)
            .map(pick)
            .collect();
        let cost = self.cost[j];
        if cost != 0.0 {
            for &(k, v) in &entries {
                self.change_cost(k as usize, v * cost / a);
            }
        }
        self.remove_column(j);
        self.remove_row(i);
        for &(r, v) in &others {
            self.add_multiple(r as usize, &entries, -v / a);
            self.row_lower[r as usize] -= v * side / a;
            self.row_upper[r as usize] -= v * side / a;
        }
        self.steps.push(Step::Substituted {
            row: i as u32,
            column: j as u32,
            a,
            cost,
            side,
            at,
            entries,
            others,
            doubleton,
        });
        Ok(())
    }

    /// Takes this off a cost; what rounding leaves of two that are the same is nothing.
    fn change_cost(&mut self, k: usize, by: f64) {
        let left = self.cost[k] - by;
        self.cost[k] = match left.abs() <= ROUNDING * by.abs() {
            true => 0.0,
            false => left,
        };
    }

    /// Adds a multiple of these entries to a row.
    fn add_multiple(&mut self, r: usize, entries: &[(u32, f64)], factor: f64) {
        let old = std::mem::take(&mut self.rows[r]);
        let mut new = Vec::with_capacity(old.len() + entries.len());
        let mut old = old
            .into_iter()
            .filter(|e| self.column_alive[e.0 as usize])
            .peekable();
        for &(k, v) in entries {
            while let Some(e) = old.next_if(|e| e.0 < k) {
                new.push(e);
            }
            let add = factor * v;
            self.new_columns.push(k as usize);
            match old.next_if(|e| e.0 == k) {
                Some((_, was)) if (was + add).abs() <= ROUNDING * was.abs() => {
                    self.column_count[k as usize] -= 1;
                    self.columns[k as usize].retain(|&i| i as usize != r);
                }
                Some((_, was)) => new.push((k, was + add)),
                None => {
                    new.push((k, add));
                    self.column_count[k as usize] += 1;
                    self.columns[k as usize].push(r as u32);
                }
            }
        }
        new.extend(old);
        self.row_count[r] = new.len() as u32;
        self.rows[r] = new;
        self.new_rows.push(r);
    }
}
