//! Rows, and columns, that are multiples of each other.

use super::{Hopeless, State, Step, Work, term};
use std::collections::HashMap;

/// Ratios that agree to this part are the same.
const SAME: f64 = 1e-13;

/// A difference of costs is clear beyond this part.
const CLEAR: f64 = 1e-9;

/// Two lists of entries whose second is a multiple of the first: the ratio.
fn ratio(one: &[(usize, f64)], two: &[(usize, f64)]) -> Option<f64> {
    let ratio = two.first()?.1 / one.first()?.1;
    let same = |(p, q): (&(usize, f64), &(usize, f64))| {
        p.0 == q.0 && (q.1 - ratio * p.1).abs() <= SAME * q.1.abs()
    };
    (one.len() == two.len() && one.iter().zip(two).all(same)).then_some(ratio)
}

/// The same for lists that are multiples of each other, whatever the rounding; hardly ever for others.
fn signature(entries: &[(usize, f64)]) -> u64 {
    let first = entries.first().map_or(1.0, |e| e.1);
    entries.iter().fold(entries.len() as u64, |h, &(k, v)| {
        let part = ((v / first) as f32).to_bits() >> 3;
        (h.rotate_left(5) ^ k as u64 ^ u64::from(part) << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    })
}

impl Work {
    pub(super) fn parallel_rows(&mut self) -> Result<(), Hopeless> {
        let mut seen: HashMap<u64, Vec<usize>> = HashMap::new();
        for i in 0..self.rows.len() {
            if !self.row_alive[i] || self.row_count[i] < 2 {
                continue;
            }
            let entries: Vec<(usize, f64)> = self.row_entries(i).collect();
            let group = seen.entry(signature(&entries)).or_default();
            let twin = group.iter().find_map(|&k| {
                let other: Vec<(usize, f64)> = self.row_entries(k).collect();
                Some((k, ratio(&other, &entries)?))
            });
            let Some((kept, ratio)) = twin else {
                group.push(i);
                continue;
            };
            let [low, high] = term(1.0 / ratio, self.sides(i));
            let from_gone = [low > self.row_lower[kept], high < self.row_upper[kept]];
            let (low, high) = (
                low.max(self.row_lower[kept]),
                high.min(self.row_upper[kept]),
            );
            if low > high + 1e-9 * low.abs().max(1.0) {
                return Err(Hopeless(None));
            }
            (self.row_lower[kept], self.row_upper[kept]) = match low > high {
                true if from_gone[0] => (high, high),
                true => (low, low),
                false => (low, high),
            };
            self.remove_row(i);
            self.new_rows.push(kept);
            self.steps.push(Step::Row {
                kept: kept as u32,
                gone: i as u32,
                ratio,
                from_gone,
                fixed: self.is_equation(kept),
            });
        }
        Ok(())
    }

    pub(super) fn parallel_columns(&mut self) {
        let mut seen: HashMap<u64, Vec<usize>> = HashMap::new();
        for j in 0..self.cost.len() {
            if !self.column_alive[j] || self.column_count[j] == 0 {
                continue;
            }
            let entries = self.sorted_column(j);
            let group = seen.entry(signature(&entries)).or_default();
            let mut twins = Vec::new();
            for &k in group.iter().filter(|&&k| self.column_alive[k]) {
                if let Some(ratio) = ratio(&self.sorted_column(k), &entries) {
                    twins.push((k, ratio));
                }
            }
            group.push(j);
            for (k, ratio) in twins {
                if self.merge(k, j, ratio) {
                    break;
                }
            }
        }
    }

    fn sorted_column(&self, j: usize) -> Vec<(usize, f64)> {
        let mut entries: Vec<(usize, f64)> = self.column_entries(j).collect();
        entries.sort_unstable_by_key(|e| e.0);
        entries
    }

    /// Column `gone` is `ratio` times column `kept`: together one, or the dearer one at its bound. True: `gone` has gone.
    fn merge(&mut self, kept: usize, gone: usize, ratio: f64) -> bool {
        let more = self.cost[gone] - ratio * self.cost[kept];
        if more.abs() <= SAME * self.cost[gone].abs() {
            let (kept_bounds, gone_bounds) = (self.bounds(kept), self.bounds(gone));
            let [low, high] = term(ratio, gone_bounds);
            let bounds = [kept_bounds[0] + low, kept_bounds[1] + high];
            if bounds.iter().all(|b| b.is_infinite()) {
                return false;
            }
            [self.lower[kept], self.upper[kept]] = bounds;
            self.remove_column(gone);
            self.new_columns.push(kept);
            self.steps.push(Step::Column {
                kept: kept as u32,
                gone: gone as u32,
                ratio,
                kept_bounds,
                gone_bounds,
            });
            return true;
        }
        if more.abs() <= CLEAR * self.cost[gone].abs() {
            return false;
        }
        // d of one is `ratio` times d of the other, and `more`: where that has a sign the dearer one stays at its bound.
        for (j, k, ratio, more) in [
            (gone, kept, ratio, more),
            (kept, gone, 1.0 / ratio, -more / ratio),
        ] {
            let [low, high] = self.bounds(k);
            let not_negative = if ratio > 0.0 { high } else { low };
            let not_positive = if ratio > 0.0 { low } else { high };
            let state = match more > 0.0 {
                true if not_negative.is_infinite() => State::Lower,
                false if not_positive.is_infinite() => State::Upper,
                _ => continue,
            };
            if self.fix(j, state).is_ok() {
                return j == gone;
            }
        }
        false
    }
}
