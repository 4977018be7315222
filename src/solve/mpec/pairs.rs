//! The pairs of an instance, what a point is worth with respect to them, and the branches.
//!
//! A pair of a row with F(x) = left − right and a column l ≤ x ≤ u asks for x = mid(l, u, x − F(x)):
//!
//! ```text
//!     x = l and F ≥ 0,     l ≤ x ≤ u and F = 0,     or x = u and F ≤ 0.
//! ```
//!
//! These are its *pieces*. The bounds decide, not the row's relation: a free column makes F = 0 an
//! ordinary equation, a fixed one leaves F free; neither is a pair with a choice. With a piece
//! chosen for every pair the program is an ordinary one, a *branch*. Dropping the products but
//! keeping what the signs of F must be in every piece (F ≥ 0 where there is no upper bound, F ≤ 0
//! where there is no lower one) gives the *envelope*, the relaxation that contains all branches.

use crate::model::instance::{INFINITE, Instance, Relation};
use crate::model::sum::Sum;
use crate::solve::SolveError;
use crate::solve::certificate::nonlinear::activity;
use crate::solve::certificate::{self, Residuals, TOLERANCE};
use crate::solve::pairing::refuse_relation;

/// A row and a column with a choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Column x.
    pub column: usize,
    /// Row of F.
    pub row: usize,
    /// l, −∞ allowed.
    pub lower: f64,
    /// u, +∞ allowed; not both bounds are infinite, and l < u.
    pub upper: f64,
}

/// Which of its pieces a pair is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Piece {
    /// x = l, F ≥ 0.
    Lower,
    /// F = 0.
    Inside,
    /// x = u, F ≤ 0.
    Upper,
}

impl Pair {
    /// Whether a pair with these bounds can be on the piece.
    pub fn allows(&self, piece: Piece) -> bool {
        match piece {
            Piece::Lower => self.lower.is_finite(),
            Piece::Inside => true,
            Piece::Upper => self.upper.is_finite(),
        }
    }

    /// What x and F + b are between on a piece, x being in an interval `between` its bounds; or, without a piece, in the envelope.
    pub fn ranges(&self, piece: Option<Piece>, between: (f64, f64), b: f64) -> [(f64, f64); 2] {
        let inf = f64::INFINITY;
        match piece {
            Some(Piece::Lower) => [(self.lower, self.lower), (b, inf)],
            Some(Piece::Inside) => [between, (b, b)],
            Some(Piece::Upper) => [(self.upper, self.upper), (-inf, b)],
            None => {
                let low = if self.upper.is_finite() { -inf } else { b };
                let high = if self.lower.is_finite() { inf } else { b };
                [between, (low, high)]
            }
        }
    }

    /// How far a point is from the piece: the bound's distance, or |F|.
    pub fn distance(&self, piece: Piece, x: f64, f: f64) -> f64 {
        match piece {
            Piece::Lower => (x - self.lower).abs().max(-f),
            Piece::Inside => f.abs(),
            Piece::Upper => (self.upper - x).abs().max(f),
        }
    }

    /// The piece a point is nearest to.
    pub fn nearest(&self, x: f64, f: f64) -> Piece {
        let all = [Piece::Lower, Piece::Inside, Piece::Upper];
        let allowed = all.into_iter().filter(|&p| self.allows(p));
        allowed
            .min_by(|&a, &b| self.distance(a, x, f).total_cmp(&self.distance(b, x, f)))
            .unwrap_or(Piece::Inside)
    }

    /// |F| times the distance to the bound that F's sign asks for; the distance counts as 1 where
    /// there is no such bound.
    pub fn product(&self, x: f64, f: f64) -> f64 {
        let room = match f > 0.0 {
            true if self.lower.is_finite() => x - self.lower,
            false if self.upper.is_finite() => self.upper - x,
            _ => 1.0,
        };
        if f == 0.0 { 0.0 } else { (f * room).abs() }
    }

    /// |x − mid(l, u, x − F)|.
    pub fn natural(&self, x: f64, f: f64) -> f64 {
        (x - (x - f).max(self.lower).min(self.upper)).abs()
    }
}

/// A program with equilibrium constraints.
pub struct Program<'a> {
    /// As it was generated.
    pub instance: &'a Instance,
    /// The pairs with a choice, by columns.
    pub pairs: Vec<Pair>,
    /// Without the products.
    pub envelope: Instance,
}

/// A point with its certificate.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Levels of the rows.
    pub activity: Vec<f64>,
    /// Primal residuals with respect to the envelope, complementarity over the pairs.
    pub residuals: Residuals,
    /// All of them are small.
    pub feasible: bool,
}

impl<'a> Program<'a> {
    /// Takes an instance apart. Errors: a row whose relation does not go with its column's bounds.
    pub fn new(instance: &'a Instance) -> Result<Self, SolveError> {
        let mut envelope = instance.clone();
        envelope.matched = None;
        let mut pairs = Vec::new();
        let matched = instance.matched.iter().flatten().enumerate();
        for (column, row) in matched.filter_map(|(j, r)| r.map(|r| (j, r as usize))) {
            let finite = |b: f64| {
                if b.abs() >= INFINITE {
                    f64::INFINITY * b.signum()
                } else {
                    b
                }
            };
            let lower = finite(instance.columns.lower[column]);
            let upper = finite(instance.columns.upper[column]);
            let relation = instance.rows.relation[row];
            refuse_relation(relation, lower, upper, row, column)?;
            envelope.rows.relation[row] = match (lower.is_finite(), upper.is_finite()) {
                (false, false) => Relation::Equal,
                (true, false) => Relation::Greater,
                (false, true) => Relation::Less,
                (true, true) => Relation::Free,
            };
            if lower < upper && (lower.is_finite() || upper.is_finite()) {
                pairs.push(Pair {
                    column,
                    row,
                    lower,
                    upper,
                });
            }
        }
        Ok(Self {
            instance,
            pairs,
            envelope,
        })
    }

    /// Only what is linear: without an objective, rows with nonlinear terms free and without partners.
    pub fn linear_rows(&self) -> Instance {
        let mut out = self.instance.clone();
        let nonlinear = out.nonlinear_rows();
        let relations = out.rows.relation.iter_mut().zip(&nonlinear);
        relations
            .filter(|(_, n)| **n)
            .for_each(|(r, _)| *r = Relation::Free);
        let partners = out.matched.iter_mut().flatten();
        partners
            .filter(|row| row.is_some_and(|i| nonlinear[i as usize]))
            .for_each(|row| *row = None);
        out.nonlinear.clear();
        out.objective = None;
        out
    }

    /// +1 for a minimum, −1 for a maximum.
    pub fn sign(&self) -> f64 {
        self.instance.sign()
    }

    /// The objective at a point, minimised.
    pub fn objective(&self, level: &[f64]) -> f64 {
        let value = self.instance.objective.map(|o| level[o.column as usize]);
        self.sign() * value.unwrap_or(0.0)
    }

    /// Levels of the rows at a point; not numbers where a function has no value.
    pub fn activity(&self, level: &[f64]) -> Vec<f64> {
        let m = self.instance.row_count();
        if self.instance.is_linear() {
            let line = |i| {
                let mut sum = Sum::default();
                let entries = self.instance.matrix.row(i);
                entries.for_each(|(j, a)| sum.add_product(a, level[j]));
                sum.value()
            };
            return (0..m).map(line).collect();
        }
        activity(self.instance, level)
    }

    /// F of a pair.
    pub fn force(&self, pair: &Pair, activity: &[f64]) -> f64 {
        activity[pair.row] - self.instance.rows.rhs[pair.row]
    }

    /// Recomputes all residuals at a point.
    pub fn judge(&self, level: &[f64]) -> Judged {
        let activity = self.activity(level);
        let size: Vec<f64> = (0..activity.len())
            .map(|i| {
                let terms = self.instance.matrix.row(i);
                terms.fold(activity[i].abs().max(1.0), |s, (j, a)| {
                    s.max((a * level[j]).abs())
                })
            })
            .collect();
        let mut residuals = certificate::primal(&self.envelope, level, &activity, &size);
        let (mut most, mut sum, mut natural, mut relative) = (0.0f64, Sum::default(), 0.0f64, 0.0);
        let mut worst = None;
        for p in &self.pairs {
            let (x, f) = (level[p.column], self.force(p, &activity));
            let product = p.product(x, f);
            most = most.max(product);
            sum.add(product);
            let n = p.natural(x, f);
            let r = if n.is_nan() {
                f64::INFINITY
            } else {
                n / x.abs().min(f.abs()).max(1.0)
            };
            natural = natural.max(n);
            if r > relative {
                (relative, worst) = (r, Some(p.row));
            }
        }
        residuals.complementarity = Some(most);
        residuals.complementarity_sum = Some(sum.value());
        residuals.natural = Some(natural);
        residuals.natural_relative = relative;
        if relative > residuals.primal_relative {
            (residuals.worst_row, residuals.worst_column) = (worst, None);
        }
        let feasible = residuals.is_feasible(TOLERANCE) && relative <= TOLERANCE;
        Judged {
            activity,
            residuals,
            feasible,
        }
    }

    /// The point with the objective variable as its defining equation says, if it has one.
    pub fn complete(&self, mut level: Vec<f64>) -> Vec<f64> {
        let instance = self.instance;
        let equation = |row: &usize| instance.rows.relation[*row] == Relation::Equal;
        let row = instance.objective_row().filter(|(row, _)| equation(row));
        if let (Some(objective), Some((row, a))) = (instance.objective, row) {
            let z = objective.column as usize;
            let x = level[z] + (instance.rows.rhs[row] - self.activity(&level)[row]) / a;
            if x.is_finite() {
                level[z] = x.clamp(instance.columns.lower[z], instance.columns.upper[z]);
            }
        }
        level
    }

    /// The nearest piece of every pair.
    pub fn nearest(&self, level: &[f64]) -> Vec<Piece> {
        let activity = self.activity(level);
        let near = |p: &Pair| p.nearest(level[p.column], self.force(p, &activity));
        self.pairs.iter().map(near).collect()
    }

    /// The piece of every pair to which the marginals of a point belong: where it is on several, that which allows the sign
    /// of the row's marginal.
    pub fn pieces_with(&self, level: &[f64], activity: &[f64], marginal: &[f64]) -> Vec<Piece> {
        let of = |p: &Pair| {
            let (x, f) = (level[p.column], self.force(p, activity));
            let near = p.nearest(x, f);
            let price = self.sign() * marginal[p.row];
            let wrong = match near {
                Piece::Lower => price < 0.0,
                Piece::Inside => false,
                Piece::Upper => price > 0.0,
            };
            match wrong && p.distance(Piece::Inside, x, f) <= TOLERANCE {
                true => Piece::Inside,
                false => near,
            }
        };
        self.pairs.iter().map(of).collect()
    }

    /// The ordinary program in which every pair is on its piece, starting from a point.
    pub fn branch(&self, pieces: &[Piece], start: &[f64]) -> Instance {
        let mut out = self.envelope.clone();
        out.columns.level.copy_from_slice(start);
        for (pair, piece) in self.pairs.iter().zip(pieces) {
            let (relation, bound) = match piece {
                Piece::Lower => (Relation::Greater, Some(pair.lower)),
                Piece::Inside => (Relation::Equal, None),
                Piece::Upper => (Relation::Less, Some(pair.upper)),
            };
            out.rows.relation[pair.row] = relation;
            if let Some(b) = bound {
                out.columns.lower[pair.column] = b;
                out.columns.upper[pair.column] = b;
            }
        }
        out
    }
}
