//! Rows that say nothing, a bound, or all.

use super::{Entries, Hopeless, ROUNDING, State, Step, Work};

impl Work {
    /// What can be done about a row.
    pub(super) fn row(&mut self, i: usize) -> Result<(), Hopeless> {
        match self.row_count[i] {
            0 => self.empty_row(i),
            1 => self.singleton_row(i),
            _ => {
                self.ranged_row(i)?;
                if self.row_alive[i] && self.row_count[i] == 2 && self.is_equation(i) {
                    self.doubleton(i)?;
                }
                Ok(())
            }
        }
    }

    fn drop_row(&mut self, i: usize) {
        self.remove_row(i);
        self.steps.push(Step::Idle(i as u32));
    }

    fn empty_row(&mut self, i: usize) -> Result<(), Hopeless> {
        let [low, high] = self.sides(i);
        if low > 1e-9 || high < -1e-9 {
            return Err(Hopeless(Some(i as u32)));
        }
        self.drop_row(i);
        Ok(())
    }

    fn singleton_row(&mut self, i: usize) -> Result<(), Hopeless> {
        let Some((j, a)) = self.row_entries(i).next() else {
            return Ok(());
        };
        let [low, high] = self.sides(i);
        let ends = [low / a, high / a];
        let ends = if a > 0.0 { ends } else { [ends[1], ends[0]] };
        let contradicted = |_| Hopeless(Some(i as u32));
        let mut from_row = self.narrow(j, ends).map_err(contradicted)?;
        if low == high {
            from_row = [true, true];
        }
        self.remove_row(i);
        self.steps.push(Step::Singleton {
            row: i as u32,
            column: j as u32,
            a,
            from_row,
            fixed: self.lower[j] == self.upper[j],
        });
        Ok(())
    }

    /// Sides that the bounds imply, and rows that hold at one point only.
    fn ranged_row(&mut self, i: usize) -> Result<(), Hopeless> {
        let range = self.activity(i);
        let (low, high) = (range.low(), range.high());
        let [side_low, side_high] = self.sides(i);
        let size = |side: f64| match side.is_finite() {
            true => ROUNDING * range.size.max(side.abs()).max(1.0),
            false => 0.0,
        };
        let slack = [size(side_low), size(side_high)];
        if low > side_high + 1e3 * slack[1] || high < side_low - 1e3 * slack[0] {
            return Err(Hopeless(Some(i as u32)));
        }
        let forced = [high <= side_low + slack[0], low >= side_high - slack[1]];
        if forced[0] && high.is_finite() || forced[1] && low.is_finite() {
            return self.forcing_row(i, forced[1]);
        }
        if low >= side_low {
            self.row_lower[i] = f64::NEG_INFINITY;
        }
        if high <= side_high {
            self.row_upper[i] = f64::INFINITY;
        }
        if self.row_lower[i].is_infinite() && self.row_upper[i].is_infinite() {
            self.drop_row(i);
        }
        Ok(())
    }

    /// All columns of the row stand where its activity is smallest (at the upper side) or largest.
    fn forcing_row(&mut self, i: usize, upper: bool) -> Result<(), Hopeless> {
        let entries: Entries = self.row_entries(i).map(|(j, a)| (j as u32, a)).collect();
        self.steps.push(Step::Forcing {
            row: i as u32,
            upper,
            entries: entries.clone(),
        });
        for &(j, a) in &entries {
            let state = match (a > 0.0) == upper {
                true => State::Lower,
                false => State::Upper,
            };
            self.fix(j as usize, state)?;
        }
        self.remove_row(i);
        Ok(())
    }
}
