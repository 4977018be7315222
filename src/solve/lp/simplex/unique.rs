//! Whether an optimal basis is the only one that matters: other optimal points, other multipliers.
//!
//! A nonbasic variable without reduced cost that can move by a positive step gives another optimal
//! point; a basic variable at a bound that can take a positive reduced cost gives other
//! multipliers. Both are shown by one step along an edge. Where no edge leads on because every step
//! has length 0, nothing is said: so a "yes" is certain, a "no" is not.

use super::{NONBASIC, PIVOT, Simplex};

/// Edges that are tried.
const TRIES: usize = 40;

/// A step shorter than this is none.
const STEP: f64 = 1e-7;

impl Simplex {
    /// For the basis of [`Simplex::point`]: whether another optimal point, and whether other
    /// multipliers, were found.
    pub fn others(&mut self) -> (bool, bool) {
        (
            self.other_point().unwrap_or(false),
            self.other_multipliers().unwrap_or(false),
        )
    }

    fn other_point(&mut self) -> Option<bool> {
        let candidates: Vec<usize> = (0..self.n + self.m)
            .filter(|&j| {
                let fixed = self.lower[j] == self.upper[j];
                self.slot[j] == NONBASIC && !fixed && self.d[j].abs() <= self.dual_tolerance
            })
            .take(TRIES)
            .collect();
        for j in candidates {
            let a_j = self.column(j);
            let column = self.factor.as_mut()?.forward(&a_j)?.clone();
            let up = self.x[j] < self.upper[j];
            let down = self.x[j] > self.lower[j];
            for (may, sigma) in [(up, 1.0), (down, -1.0)] {
                if !may {
                    continue;
                }
                let mut step = self.upper[j] - self.lower[j];
                for &(k, a) in column.iter().filter(|e| e.1.abs() > PIVOT) {
                    let b = self.head[k] as usize;
                    let room = match sigma * a > 0.0 {
                        true => self.x[b] - self.lower[b],
                        false => self.upper[b] - self.x[b],
                    };
                    step = step.min(room / a.abs());
                }
                if step > STEP {
                    return Some(true);
                }
            }
        }
        Some(false)
    }

    fn other_multipliers(&mut self) -> Option<bool> {
        let at = |x: f64, bound: f64| (x - bound).abs() <= self.tolerance;
        let candidates: Vec<(usize, f64)> = (0..self.m)
            .flat_map(|k| {
                let j = self.head[k] as usize;
                let (x, l, u) = (self.x[j], self.lower[j], self.upper[j]);
                let low = at(x, l).then_some((k, 1.0));
                low.into_iter().chain(at(x, u).then_some((k, -1.0)))
            })
            .take(TRIES)
            .collect();
        for (slot, sign) in candidates {
            let rho = self.factor.as_mut()?.backward(&[(slot, 1.0)])?.clone();
            self.pivot_row(&rho);
            let mut step = f64::INFINITY;
            for &j in &self.row_index {
                let j = j as usize;
                let (l, u, d) = (self.lower[j], self.upper[j], self.d[j]);
                // What d_j loses per unit of the new multiplier.
                let rate = -sign * self.row[j];
                if l == u || rate.abs() <= PIVOT {
                    continue;
                }
                let free = l.is_infinite() && u.is_infinite();
                let at_lower = self.is_low(j);
                if free {
                    step = 0.0;
                } else if (rate > 0.0) == at_lower {
                    step = step.min(d.abs() / rate.abs());
                }
            }
            if step > STEP {
                return Some(true);
            }
        }
        Some(false)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Simplex;
    use crate::model::instance::{Relation, Sense};
    use crate::solve::dense;
    use crate::solve::lp::Ended;
    use crate::solve::lp::form::Form;

    #[test]
    fn says_what_is_not_unique() {
        let inf = f64::INFINITY;
        let bounds = [(0., inf), (0., inf)];
        let others = |cost: &[f64], rows: &[dense::Row]| {
            let instance = dense::linear(Sense::Maximize, cost, &bounds, rows);
            let form = Form::new(&instance).expect("valid");
            let mut s = Simplex::new(&form.problem);
            assert_eq!(s.solve(&mut |_| None), Ended::Solved);
            s.point().expect("a point");
            s.others()
        };
        let less = Relation::Less;
        // A vertex.
        let rows = [(vec![1., 0.], less, 4.), (vec![0., 1.], less, 3.)];
        assert_eq!(others(&[1., 1.], &rows), (false, false));
        // An edge.
        let rows = [(vec![1., 1.], less, 4.)];
        assert_eq!(others(&[1., 1.], &rows), (true, false));
        // Three lines through a point.
        let rows = [
            (vec![1., 0.], less, 4.),
            (vec![0., 1.], less, 3.),
            (vec![1., 1.], less, 7.),
        ];
        assert_eq!(others(&[1., 1.5], &rows), (false, true));
    }
}
