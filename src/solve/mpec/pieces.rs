//! The method `pieces`: linear programs on supports, for programs that come apart ([`super::split`]).
//!
//! * **piece**: for a point of side B, the optimum of side A on its support. From there the values are
//!   those of points that satisfy everything.
//! * **swaps**: for every binding pair of the support, the pair with the largest gain by its
//!   multiplier first: the point of B that avoids it and is nearest to complementary to A's point (a
//!   linear program), and the piece on that point's support. Where that is better, start again. At
//!   the end no single swap improves: the *plateau* around the point, which a local minimum in
//!   the usual sense may lie on, is searched as far as single swaps reach.
//! * **alternation**: A's program with the products penalised, B's with the products as its cost, in
//!   turn, with a growing penalty, until the products vanish. Random penalties and costs (from a fixed
//!   seed) give many starts.

use super::pairs::{Piece, Program};
use super::split::{Point, Side, Split, shifts};
use crate::solve::lp::Ended;
use crate::solve::random::Random;

/// An improvement smaller than this, relative to the value, is none.
const BETTER: f64 = 1e-10;

/// Products below this vanish.
const GAP: f64 = 1e-11;

/// Rounds of swaps from one point: the last one tries all of them, the others [`FEW`] and a twentieth,
/// each with other weights.
const KICKS: usize = 8;
const FEW: usize = 10;

/// A point of both sides; A's is optimal on the support of B's.
#[derive(Clone, Debug)]
pub struct Solution {
    /// What B's point allows A.
    pub pieces: Vec<Piece>,
    /// Side A.
    pub a: Point,
    /// Side B.
    pub b: Point,
}

/// The method's state.
pub struct Pieces {
    /// The two sides.
    pub split: Split,
    rhs: Vec<f64>,
    random: Random,
    /// No single swap improves the best solution.
    pub exhausted: bool,
}

type Stop<'s> = &'s mut dyn FnMut(u64) -> Option<Ended>;

impl Pieces {
    /// None if the program does not come apart.
    pub fn new(program: &Program) -> Option<Self> {
        Some(Self {
            split: Split::new(program)?,
            rhs: shifts(program),
            random: Random(0x5eed),
            exhausted: false,
        })
    }

    /// Simplex iterations so far.
    pub fn iterations(&self) -> u64 {
        self.split.a.iterations() + self.split.b.iterations()
    }

    /// The piece at B's part of a point.
    pub fn at(&mut self, level: &[f64], stop: Stop) -> Option<Solution> {
        let b = self.split.b.point_at(level, &self.rhs);
        self.piece(b, stop)
    }

    /// A's optimum on the support of a point of B.
    fn piece(&mut self, b: Point, stop: Stop) -> Option<Solution> {
        let pieces = self.split.pieces(&self.split.b, &b);
        let side = &mut self.split.a;
        for (k, &piece) in pieces.iter().enumerate() {
            side.restrict(k, Some(piece), self.split.bounds[k], self.rhs[k]);
        }
        side.price(1.0, &[]);
        let a = side.solve(&self.rhs, stop)?;
        Some(Solution { pieces, a, b })
    }

    /// Bounds of one side without the pairs, but for those whose products are not linear in it.
    fn relax(&mut self, which: bool, other: Option<&Point>) {
        let given = other.map(|p| {
            let from = if which { &self.split.b } else { &self.split.a };
            self.split.pieces(from, p)
        });
        let rhs = &self.rhs;
        let bounds = &self.split.bounds;
        let side: &mut Side = if which {
            &mut self.split.a
        } else {
            &mut self.split.b
        };
        for (k, &(l, u)) in bounds.iter().enumerate() {
            let both = l.is_finite() && u.is_finite();
            let piece = given
                .as_ref()
                .filter(|_| both && side.has_row(k))
                .map(|g| g[k]);
            side.restrict(k, piece, (l, u), rhs[k]);
        }
    }

    /// Swaps until none improves, or until the work is done.
    pub fn swaps(&mut self, mut best: Solution, work: u64, stop: Stop) -> Solution {
        let limit = self.iterations() + work;
        self.exhausted = false;
        let mut kicks = 0;
        'again: loop {
            let mut order: Vec<(f64, usize)> = (0..best.pieces.len())
                .filter(|&k| self.split.binds(&self.split.b, k, best.pieces[k]))
                .map(|k| (self.gain(&best, k), k))
                .collect();
            order.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
            // Every swap starts from these two bases.
            let Some(again) = self.piece(best.b.clone(), stop) else {
                return best;
            };
            let mut weights = self.split.weights(&self.split.a, &again.a);
            let last = kicks == KICKS;
            if kicks > 0 && !last {
                weights = self.other_weights(&weights, stop);
            }
            self.relax(false, Some(&again.a));
            self.split.b.price(0.0, &weights);
            if self.split.b.solve(&self.rhs, stop).is_none() {
                return best;
            }
            let bases = (self.split.a.basis.clone(), self.split.b.basis.clone());
            let value = best.a.value;
            let margin = BETTER * value.abs().max(1.0);
            let tries = if last {
                order.len()
            } else {
                FEW + order.len() / 20
            };
            for (_, k) in order.into_iter().take(tries) {
                if self.iterations() > limit || stop(0).is_some() {
                    return best;
                }
                (self.split.a.basis, self.split.b.basis) = bases.clone();
                let swapped = self.avoid(&again, k, &weights, stop);
                self.split.a.cut_above(value + 1e-2 * value.abs().max(0.1));
                let next = swapped.and_then(|b| self.piece(b, stop));
                self.split.a.cut_above(f64::INFINITY);
                if let Some(next) = next
                    && next.a.value < value - margin
                {
                    best = next;
                    kicks = 0;
                    continue 'again;
                }
            }
            if last {
                self.exhausted = true;
                return best;
            }
            kicks += 1;
        }
    }

    /// Weights of the same point's products at another optimum of A: A's optimum is rarely unique,
    /// and what is near to complementary depends on it.
    fn other_weights(&mut self, usual: &[f64], stop: Stop) -> Vec<f64> {
        let noise: Vec<f64> = usual.iter().map(|_| 1e-6 * self.random.uniform()).collect();
        self.split.a.price(1.0, &noise);
        let a = self.split.a.solve(&self.rhs, stop);
        let weights = a.map_or_else(|| usual.to_vec(), |a| self.split.weights(&self.split.a, &a));
        weights
            .into_iter()
            .map(|w| w * (0.5 + self.random.uniform()))
            .collect()
    }

    /// How much A would gain, to first order, if a pair did not bind.
    fn gain(&self, at: &Solution, k: usize) -> f64 {
        let (l, u) = self.split.bounds[k];
        let d = at.a.reduced[k];
        let (up, down) = match (self.split.a.has_row(k), at.pieces[k]) {
            (true, _) => (l.is_finite(), u.is_finite()),
            (false, piece) => (piece == Piece::Lower, piece == Piece::Upper),
        };
        let up = if up { -d } else { 0.0 };
        let down = if down { d } else { 0.0 };
        up.max(down)
    }

    /// The point of B nearest to complementary to A's at which a pair does not bind.
    fn avoid(&mut self, at: &Solution, k: usize, weights: &[f64], stop: Stop) -> Option<Point> {
        self.relax(false, Some(&at.a));
        let (l, u) = self.split.bounds[k];
        let side = &mut self.split.b;
        let v = at.b.pair[k];
        let piece = if side.has_row(k) {
            Piece::Inside
        } else if v - l <= u - v {
            Piece::Lower
        } else {
            Piece::Upper
        };
        side.restrict(k, Some(piece), (l, u), self.rhs[k]);
        side.price(0.0, weights);
        side.solve(&self.rhs, stop)
    }

    /// From a random start to a point that satisfies the pairs.
    pub fn random_start(&mut self, stop: Stop) -> Option<Solution> {
        let count = self.rhs.len();
        let random: Vec<f64> = (0..count).map(|_| self.random.uniform()).collect();
        // A point of B with random costs on the pairs: their signs keep it bounded where one is.
        let toward = |(w, &(l, _)): (&f64, &(f64, f64))| if l.is_finite() { *w } else { -w };
        let costs: Vec<f64> = random.iter().zip(&self.split.bounds).map(toward).collect();
        self.relax(false, None);
        self.split.b.price(0.0, &costs);
        let b = self.split.b.solve(&self.rhs, stop)?;
        let rho = 10f64.powf(-3.0 + 2.5 * self.random.uniform());
        self.alternate(b, rho, stop)
    }

    /// The alternation from a point of B with a first penalty.
    pub fn alternate(&mut self, b: Point, rho: f64, stop: Stop) -> Option<Solution> {
        // Rounds are many, and there are other starts.
        (self.split.a.patient, self.split.b.patient) = (false, false);
        let end = self.rounds(b, rho, stop);
        (self.split.a.patient, self.split.b.patient) = (true, true);
        self.piece(end?, stop)
    }

    fn rounds(&mut self, mut b: Point, mut rho: f64, stop: Stop) -> Option<Point> {
        for _ in 0..100 {
            let mut weights = self.split.weights(&self.split.b, &b);
            let total: f64 = weights.iter().map(|w| w.abs()).sum();
            let scale = 10.0 * rho / total.max(1e-12);
            weights.iter_mut().for_each(|w| *w *= scale);
            self.relax(true, Some(&b));
            self.split.a.price(1.0, &weights);
            let a = self.split.a.solve(&self.rhs, stop)?;
            let weights = self.split.weights(&self.split.a, &a);
            self.relax(false, Some(&a));
            self.split.b.price(0.0, &weights);
            b = self.split.b.solve(&self.rhs, stop)?;
            if self.split.gap(&a, &b) < GAP {
                return Some(b);
            }
            rho *= 2.0;
        }
        None
    }

    /// Writes a solution into levels of the program.
    pub fn write(&self, solution: &Solution, level: &mut [f64]) {
        for (side, point) in [(&self.split.a, &solution.a), (&self.split.b, &solution.b)] {
            for (&j, &x) in side.columns.iter().zip(&point.x) {
                level[j] = x;
            }
        }
    }

    /// Pieces of the pairs at a point of the program, by B's part of it.
    pub fn pieces_at(&self, level: &[f64]) -> Vec<Piece> {
        let b = self.split.b.point_at(level, &self.rhs);
        self.split.pieces(&self.split.b, &b)
    }
}
