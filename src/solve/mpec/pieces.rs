//! The method `pieces`: linear programs on supports, for programs that come apart ([`super::split`]).
//!
//! * **piece**: for a point of side B, the optimum of side A on its support. From there the values are
//!   those of points that satisfy everything.
//! * **swaps**: for every binding pair of the support, the pair with the largest gain by its
//!   multiplier first: the point of B that avoids it and is nearest to complementary to A's point (a
//!   linear program), and the piece on that point's support. Where that is better, start again. A's optimum is
//!   rarely unique, and what is near to complementary depends on it: rounds with other optima find more
//!   ([`Round`]). At the end no single swap improves: the set of points with equal value around it, which a local minimum in
//!   the usual sense may lie on, is searched as far as single swaps reach.
//! * **alternation**: A's program with the products penalised, B's with the products as its cost, in
//!   turn, with a growing penalty, until the products vanish. Random penalties and costs (from a fixed
//!   seed) give many starts;
//! * **below**: the alternation with the products alone as the cost, A's value capped below the best so far, from
//!   random points of B. Most tries end at a local minimum of the products that is not 0, but what succeeds is
//!   better, and the objective does not draw it to where few pairs hold.

use super::pairs::{Pair, Piece, Program};
use super::split::{Point, Retry, Side, Split, shifts};
use crate::solve::lp::Ended;
use crate::solve::lp::simplex::{Basis, Simplex, State};
use crate::solve::random::Random;
use std::collections::HashSet;

/// An improvement smaller than this, relative to the value, is none.
const BETTER: f64 = 1e-10;

/// Products below this vanish.
const GAP: f64 = 1e-11;

/// A penalty that no gain of the objective outweighs.
const HIGH: f64 = 1e3;

/// Iterations of the programs of B and of A in a short round.
const SHORT: [u64; 2] = [5, 40];

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

/// A round of swaps from one point.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Round {
    /// All of them, a few iterations ([`SHORT`]) each: nearly all that improve need no more, and those that
    /// move far seldom do.
    Short,
    /// The same with the weights of another optimum of A, in random order.
    Kicked,
    /// With the weights of the first, whatever was not finished there.
    Rest,
}

/// What a swap gives.
enum Swap {
    Better(Solution),
    Nothing,
    Unfinished,
}

/// The method's state.
pub struct Pieces {
    /// The two sides.
    pub split: Split,
    rhs: Vec<f64>,
    random: Random,
    /// Pieces whose value is known to be no improvement.
    tried: HashSet<Vec<Piece>>,
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
            random: Random(1),
            tried: HashSet::new(),
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
        self.split.allow(&pieces, &self.rhs);
        self.split.a.price(1.0, &[]);
        let a = self.split.a.solve(&self.rhs, stop)?;
        Some(Solution { pieces, a, b })
    }

    /// An optimal basis of a branch.
    pub fn basis(&mut self, pieces: &[Piece], stop: Stop) -> Option<Basis> {
        let Split { a, b, pairs } = &mut self.split;
        for (side, weight) in [(&mut *a, 1.0), (&mut *b, 0.0)] {
            for (k, &piece) in pieces.iter().enumerate() {
                side.restrict(k, Some(piece), &pairs[k], self.rhs[k]);
            }
            side.price(weight, &[]);
            side.solve(&self.rhs, stop)?;
        }
        let n = a.columns.len() + b.columns.len();
        let mut out = vec![State::Free; n + a.rows.len() + b.rows.len()];
        for side in [a, b] {
            let (columns, rows) = side.basis();
            let at = side.columns.iter().zip(columns);
            at.for_each(|(&j, state)| out[j] = state);
            let at = side.rows.iter().zip(rows);
            at.for_each(|(&i, state)| out[n + i] = state);
        }
        Some(out)
    }

    /// Bounds of one side without the pairs, but for those whose products are not linear in it.
    fn relax(&mut self, which: bool, other: Option<&Point>) {
        let given = other.map(|p| {
            let from = if which { &self.split.b } else { &self.split.a };
            self.split.pieces(from, p)
        });
        let rhs = &self.rhs;
        let pairs = &self.split.pairs;
        let side: &mut Side = if which {
            &mut self.split.a
        } else {
            &mut self.split.b
        };
        for (k, pair) in pairs.iter().enumerate() {
            let both = pair.lower.is_finite() && pair.upper.is_finite();
            let piece = given
                .as_ref()
                .filter(|_| both && side.has_row(k))
                .map(|g| g[k]);
            side.restrict(k, piece, pair, rhs[k]);
        }
    }

    /// Swaps by these rounds until none improves, or until the work is done.
    pub fn swaps(
        &mut self,
        mut best: Solution,
        rounds: &[Round],
        work: u64,
        stop: Stop,
    ) -> Solution {
        let limit = self.iterations() + work;
        self.exhausted = false;
        'again: loop {
            let mut order: Vec<(f64, usize)> = (0..best.pieces.len())
                .filter(|&k| self.split.binds(&self.split.b, k, best.pieces[k]))
                .map(|k| (self.gain(&best, k), k))
                .collect();
            order.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
            // None: nothing is avoided. What B's point becomes under other weights may be better already.
            let all = order.into_iter().map(|(_, k)| Some(k));
            let all: Vec<Option<usize>> = std::iter::once(None).chain(all).collect();
            let mut unfinished = all.clone();
            // Every swap starts from two states, of A and of B.
            let Some(again) = self.piece(best.b.clone(), stop) else {
                return best;
            };
            let usual = self.split.weights(&self.split.a, &again.a);
            let a = self.split.a.mark();
            for &round in rounds {
                let weights = match round {
                    Round::Kicked => {
                        self.split.a.back(&a);
                        self.other_weights(&usual, stop)
                    }
                    _ => usual.clone(),
                };
                self.relax(false, Some(&again.a));
                self.split.b.price(0.0, &weights);
                if self.split.b.solve(&self.rhs, stop).is_none() {
                    return best;
                }
                let b = self.split.b.mark();
                let list = match round {
                    Round::Short => all.clone(),
                    Round::Kicked => self.shuffled(all.clone()),
                    Round::Rest => std::mem::take(&mut unfinished),
                };
                for avoid in list {
                    if self.iterations() > limit || stop(0).is_some() {
                        return best;
                    }
                    self.split.b.back(&b);
                    match self.swap(&again, &a, avoid, round != Round::Rest, stop) {
                        Swap::Better(next) => {
                            best = next;
                            continue 'again;
                        }
                        Swap::Nothing if round == Round::Short => {
                            unfinished.retain(|k| *k != avoid);
                        }
                        _ => {}
                    }
                }
                self.exhausted = round == Round::Rest;
            }
            return best;
        }
    }

    fn shuffled<T>(&mut self, mut list: Vec<T>) -> Vec<T> {
        for i in (1..list.len()).rev() {
            list.swap(i, (self.random.uniform() * (i + 1) as f64) as usize);
        }
        list
    }

    /// The piece at the point of B that avoids a pair, from a state of A, in a few iterations if it is to be
    /// `short`.
    fn swap(
        &mut self,
        at: &Solution,
        from: &Simplex,
        avoid: Option<usize>,
        short: bool,
        stop: Stop,
    ) -> Swap {
        let rhs = &self.rhs;
        let run = |side: &mut Side, most: u64, stop: Stop| match short {
            true => side.retry(most, rhs),
            false => side.solve(rhs, stop).map_or(Retry::Nothing, Retry::Solved),
        };
        let side = &mut self.split.b;
        if let Some(k) = avoid {
            let pair = &self.split.pairs[k];
            let v = at.b.pair[k];
            let piece = if side.has_row(k) {
                Piece::Inside
            } else if v - pair.lower <= pair.upper - v {
                Piece::Lower
            } else {
                Piece::Upper
            };
            side.restrict(k, Some(piece), pair, rhs[k]);
        }
        let b = match run(side, SHORT[0], stop) {
            Retry::Solved(b) => b,
            Retry::Nothing => return Swap::Nothing,
            Retry::Unfinished => return Swap::Unfinished,
        };
        let pieces = self.split.pieces(&self.split.b, &b);
        if self.tried.contains(&pieces) {
            return Swap::Nothing;
        }
        let value = at.a.value;
        self.split.a.back(from);
        self.split.allow(&pieces, rhs);
        let side = &mut self.split.a;
        // Perturbed costs make the value inexact.
        let margin = if short { 1e-6 } else { 1e-2 };
        side.cut_above(value + margin * value.abs().max(0.1));
        let a = run(side, SHORT[1], stop);
        side.cut_above(f64::INFINITY);
        match a {
            Retry::Solved(a) if a.value < value - BETTER * value.abs().max(1.0) => {
                Swap::Better(Solution { pieces, a, b })
            }
            Retry::Unfinished => Swap::Unfinished,
            _ => {
                self.tried.insert(pieces);
                Swap::Nothing
            }
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
        let pair = &self.split.pairs[k];
        let d = at.a.reduced[k];
        let (up, down) = match (self.split.a.has_row(k), at.pieces[k]) {
            (true, _) => (pair.lower.is_finite(), pair.upper.is_finite()),
            (false, piece) => (piece == Piece::Lower, piece == Piece::Upper),
        };
        let up = if up { -d } else { 0.0 };
        let down = if down { d } else { 0.0 };
        up.max(down)
    }

    /// Random costs on the pairs, of different sizes, so that few of them differ from 0 at an optimum.
    fn random_costs(&mut self) -> Vec<f64> {
        let random: Vec<f64> = self.rhs.iter().map(|_| self.random.uniform()).collect();
        // Signs keep the side bounded where one is.
        let toward = |(w, p): (f64, &Pair)| if p.lower.is_finite() { w } else { -w };
        let sizes = random.iter().map(|w| 10f64.powf(-3.0 * w));
        sizes.zip(&self.split.pairs).map(toward).collect()
    }

    /// From a random start to a point that satisfies the pairs and is better than `best`.
    pub fn below(&mut self, best: f64, stop: Stop) -> Option<Solution> {
        let costs = self.random_costs();
        self.relax(false, None);
        self.split.b.price(0.0, &costs);
        let b = self.split.b.solve(&self.rhs, stop)?;
        let step = 10f64.powf(-3.0 * self.random.uniform());
        self.split.a.cap(best - step * best.abs().max(0.1));
        let b = self.rounds(b, f64::INFINITY, stop);
        self.split.a.cap(f64::INFINITY);
        self.piece(b?, stop)
    }

    /// From a random start to a point that satisfies the pairs.
    pub fn random_start(&mut self, stop: Stop) -> Option<Solution> {
        let mut costs = self.random_costs();
        if self.random.uniform() < 0.5 {
            // Of A, and then the point of B nearest to complementary to it.
            self.relax(true, None);
            let weight = 10f64.powf(2.0 * self.random.uniform() - 0.5);
            self.split.a.price(weight, &costs);
            let a = self.split.a.solve(&self.rhs, stop)?;
            costs = self.split.weights(&self.split.a, &a);
        }
        self.relax(false, None);
        self.split.b.price(0.0, &costs);
        let b = self.split.b.solve(&self.rhs, stop)?;
        let rho = 10f64.powf(-3.0 + 2.5 * self.random.uniform());
        self.alternate(b, rho, stop)
    }

    /// The alternation from a point of B with a first penalty.
    pub fn alternate(&mut self, b: Point, rho: f64, stop: Stop) -> Option<Solution> {
        let b = self.rounds(b, rho, stop)?;
        self.piece(b, stop)
    }

    /// With ρ = ∞ A's cost is the products alone.
    fn rounds(&mut self, mut b: Point, mut rho: f64, stop: Stop) -> Option<Point> {
        let mut last = f64::INFINITY;
        for _ in 0..100 {
            let mut weights = self.split.weights(&self.split.b, &b);
            let total: f64 = weights.iter().map(|w| w.abs()).sum();
            let (own, scale) = match rho.is_finite() {
                true => (1.0, 10.0 * rho),
                false => (0.0, 1.0),
            };
            let scale = scale / total.max(1e-12);
            weights.iter_mut().for_each(|w| *w *= scale);
            self.relax(true, Some(&b));
            self.split.a.price(own, &weights);
            let a = self.split.a.solve(&self.rhs, stop)?;
            let weights = self.split.weights(&self.split.a, &a);
            self.relax(false, Some(&a));
            self.split.b.price(0.0, &weights);
            b = self.split.b.solve(&self.rhs, stop)?;
            let gap = self.split.gap(&a, &b);
            if gap < GAP {
                return Some(b);
            }
            // Neither side moves any more, or hardly.
            let still = (gap - last).abs() <= 1e-6 * gap;
            if still && rho >= HIGH {
                // The penalty is exact: no point of A is on the support, unless beyond its cap.
                return rho.is_infinite().then_some(b);
            }
            last = gap;
            rho *= if still { 10.0 } else { 2.0 };
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
