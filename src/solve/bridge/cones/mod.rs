//! Convex programs as conic ones: `min cᵀx, L ≤ A x ≤ U, l ≤ x ≤ u, D x + e ∈ K`, for Clarabel's cones.
//!
//! A quadratic row is a sum of weighted squares of affine expressions and an affine rest, `Σ wₖ pₖ² + r ≤ 0`:
//!
//! ```text
//!     all w ≥ 0                                (1 − r, 1 + r, 2 √w p)  in the second-order cone
//!     w₀ < 0 alone, p₀ ≥ 0, r a number ≥ 0     (√|w₀| p₀, √r, √w p)    in the second-order cone
//! ```
//!
//! The squares are read off the terms, or come from the eigenvalues of the (homogenised) matrix. p₀ ≥ 0 follows from the
//! bounds and what linear rows imply. Any other row stays linear, with a column above each convex term (Grant, Boyd & Ye,
//! "Disciplined convex programming", 2006); the cones of the atoms are those of Boyd & Vandenberghe (2004) and the MOSEK
//! modeling cookbook.
//!
//! Multipliers: a row that stays linear has its own; that of a convex quadratic one is μ₀ − μ₁ (r stands in both with opposite signs); that of a row with a
//! negative square μ₀ / (2 √|w₀| p₀), which does not exist at the apex p₀ = 0. There the residuals are those of the conic program.

mod quadratic;
mod recognise;

use super::direction::{Directions, make_up};
use super::parts::{directions, expressions};
use crate::model::builder::Term;
use crate::model::instance::{Instance, Relation};
use crate::solve::budget::Budget;
use crate::solve::certificate::Residuals;
use crate::solve::lp::Ended;
use crate::solve::lp::form::Problem;
use crate::solve::lp::interior::{Affine, Cone, ConeKind, solve_conic};
use crate::solve::{Claim, Outcome, SolverStatus};
use recognise::Compiler;
use std::collections::BTreeMap;

/// Clarabel's tolerances; the next one is tried where it does not reach one.
const TOLERANCES: [f64; 2] = [1e-11, 1e-9];

/// Residuals of the conic program, relative to its data, up to which it is solved.
const GAP_TOLERANCE: f64 = 1e-7;

/// A certificate holds to this, relative to what it proves.
const CERTIFICATE_TOLERANCE: f64 = 1e-7;

/// Terms of multipliers this small beside the largest are errors of the method.
const NEGLIGIBLE_TERM: f64 = 1e-9;

/// A reduced cost below this, relative to its terms, is rounding, however far a bound is.
const ROUNDING: f64 = 1e-12;

/// A cone ends at its apex where the largest coordinate is at most this, relative to its columns.
const APEX_TOLERANCE: f64 = 1e-7;

/// Where the multiplier of a row comes from.
enum Multiplier {
    /// A row without one.
    None,
    /// The row of the linear part, times a number.
    Row(usize, f64),
    /// A convex quadratic row: the cone, times a number.
    Quadratic(usize, f64),
    /// A row with a negative square: the cone, times a number over its first coordinate.
    Square(usize, f64),
}

/// A conic program.
pub(in crate::solve) struct Conic {
    linear: Problem,
    cones: Vec<Cone>,
    multipliers: Vec<Multiplier>,
    /// By equation that is an inequality here: the column that makes it hold.
    makes_up: BTreeMap<usize, usize>,
    /// Some rows may have no multipliers as they are written: norms, and squares that are not convex.
    pub(in crate::solve) has_apex: bool,
}

/// What a conic program came to.
pub(in crate::solve) struct Solution {
    pub(in crate::solve) outcome: Outcome,
    /// Dual residuals of the conic program.
    pub(in crate::solve) residuals: Residuals,
    /// Cones that end at their apex, where a row has no multiplier.
    pub(in crate::solve) at_apex: usize,
}

impl Conic {
    /// None where a row is not known to be convex, or where no cone is needed that other methods would not know of.
    pub(in crate::solve) fn new(instance: &Instance) -> Option<Self> {
        let objective = instance.objective?;
        let nonlinear = instance.nonlinear_rows();
        let mut parts: BTreeMap<usize, Vec<(f64, Term)>> = BTreeMap::new();
        for (row, coefficient, term) in expressions(instance) {
            parts.entry(row).or_default().push((coefficient, term));
        }
        let mut compiler = Compiler {
            instance,
            columns: instance.columns.clone(),
            implied: None,
            cones: Vec::new(),
            rows: Vec::new(),
            has_apex: false,
        };
        let (direction, mut relaxed) = (directions(instance), None);
        let mut makes_up = BTreeMap::new();
        let mut multipliers = Vec::new();
        for (row, &curved) in nonlinear.iter().enumerate() {
            let entries = instance.matrix.row(row);
            let mut left = Affine {
                constant: 0.0,
                terms: entries.map(|(j, a)| (j as u32, a)).collect(),
            };
            let relation = instance.rows.relation[row];
            let rhs = instance.rows.rhs[row];
            if relation == Relation::Free {
                multipliers.push(Multiplier::None);
                continue;
            }
            if !curved {
                multipliers.push(Multiplier::Row(compiler.rows.len(), 1.0));
                compiler.rows.push((left, relation.bounds(rhs)));
                continue;
            }
            left.constant = -rhs;
            let terms = &parts[&row];
            if direction[row] != 0.0 {
                if relation == Relation::Equal {
                    makes_up.insert(row, objective.column as usize);
                }
                multipliers.push(compiler.row(&left, terms, direction[row])?);
                continue;
            }
            let directions = relaxed.get_or_insert_with(|| Directions::new(instance));
            let mut either = [1.0, -1.0].into_iter();
            let found = either.find_map(|way| {
                let begun = (compiler.cones.len(), compiler.rows.len());
                let can = directions.can_relax(row, way > 0.0);
                let found = can.then(|| compiler.row(&left, terms, way)).flatten();
                if found.is_none() {
                    compiler.cones.truncate(begun.0);
                    compiler.rows.truncate(begun.1);
                }
                found
            });
            multipliers.push(found?);
        }
        makes_up.extend(relaxed.map(|d| d.makes_up).unwrap_or_default());
        let cones = std::mem::take(&mut compiler.cones);
        if cones.is_empty() {
            return None;
        }
        let has_apex = compiler.has_apex;
        Some(Self {
            linear: compiler.finish(),
            cones,
            multipliers,
            makes_up,
            has_apex,
        })
    }

    /// What it consists of, for the summary.
    pub(in crate::solve) fn kinds(&self) -> String {
        let count = |of: fn(ConeKind) -> bool| self.cones.iter().filter(|c| of(c.kind)).count();
        let kinds = [
            (count(|k| k == ConeKind::SecondOrder), "second-order"),
            (count(|k| k == ConeKind::Exponential), "exponential"),
            (count(|k| matches!(k, ConeKind::Power(_))), "power"),
        ];
        let said = kinds.into_iter().filter(|k| k.0 > 0).map(|(n, kind)| {
            let s = if n == 1 { "" } else { "s" };
            format!("{n} {kind} cone{s}")
        });
        said.collect::<Vec<_>>().join(", ")
    }

    /// Solves it by Clarabel. None: neither solved nor proved to have no solution.
    pub(in crate::solve) fn solve(&self, instance: &Instance, budget: &Budget) -> Option<Solution> {
        let mut iterations = 0;
        for tolerance in TOLERANCES {
            let (run, duals) = solve_conic(&self.linear, None, &self.cones, tolerance, budget);
            iterations += run.iterations;
            let x = &run.point.x;
            let claim = match &run.ended {
                Ended::Infeasible(y) => self.is_infeasible(y, &duals).then_some(Claim::Infeasible),
                Ended::Unbounded(ray) if self.is_ray(ray) => {
                    let feasible = self.feasible(budget)?;
                    let outcome =
                        self.outcome(instance, &feasible, Claim::Unbounded, iterations)?;
                    return Some(Solution {
                        outcome,
                        residuals: Residuals::default(),
                        at_apex: 0,
                    });
                }
                Ended::Solved | Ended::Failed => {
                    let residuals = self.residuals(x, &run.point.y, &run.point.d, &duals);
                    budget.log(format!(
                        "clarabel: {}, {} iterations, dual residual {:.1e}, gap {:.1e}",
                        self.kinds(),
                        run.iterations,
                        residuals.dual_relative,
                        residuals.gap_relative
                    ));
                    if residuals.dual_relative <= GAP_TOLERANCE
                        && residuals.gap_relative <= GAP_TOLERANCE
                    {
                        let mut outcome = self.outcome(instance, x, Claim::Solved, iterations)?;
                        let at_apex =
                            self.price(instance, &mut outcome, &run.point.y, &run.point.d, &duals);
                        return Some(Solution {
                            outcome,
                            residuals,
                            at_apex,
                        });
                    }
                    None
                }
                Ended::Unbounded(_) => None,
                _ => return None,
            };
            if let Some(claim) = claim {
                let outcome = self.outcome(instance, x, claim, iterations)?;
                let residuals = Residuals::default();
                return Some(Solution {
                    outcome,
                    residuals,
                    at_apex: 0,
                });
            }
        }
        None
    }

    /// A point that satisfies all, if Clarabel finds one.
    fn feasible(&self, budget: &Budget) -> Option<Vec<f64>> {
        let mut linear = self.linear.clone();
        linear.cost.fill(0.0);
        let (run, _) = solve_conic(&linear, None, &self.cones, TOLERANCES[1], budget);
        (run.ended == Ended::Solved).then_some(run.point.x)
    }

    /// Levels of the instance: bounds hold, and equations that were relaxed.
    fn outcome(
        &self,
        instance: &Instance,
        x: &[f64],
        claim: Claim,
        iterations: u64,
    ) -> Option<Outcome> {
        let c = &instance.columns;
        let n = instance.column_count();
        let inside = |j: usize| x[j].max(c.lower[j]).min(c.upper[j]);
        let mut level: Vec<f64> = (0..n).map(inside).collect();
        if claim != Claim::Infeasible {
            make_up(instance, &self.makes_up, &mut level)?;
        }
        Some(Outcome {
            claim,
            iterations,
            message: Some(format!("convex: {}", self.kinds())),
            ..Outcome::unfinished("clarabel", level, instance.row_count())
        })
    }

    /// Marginals of the rows and columns of the instance; how many cones end at their apex.
    fn price(
        &self,
        instance: &Instance,
        outcome: &mut Outcome,
        y: &[f64],
        d: &[f64],
        duals: &[f64],
    ) -> usize {
        let sign = instance.sign();
        let starts = self.starts();
        let x = &outcome.level;
        let mut at_apex = 0;
        for (row, multiplier) in self.multipliers.iter().enumerate() {
            outcome.row_marginal[row] = sign
                * match *multiplier {
                    Multiplier::None => 0.0,
                    Multiplier::Row(i, factor) => factor * y[i],
                    Multiplier::Quadratic(k, factor) => {
                        let mu = &duals[starts[k]..];
                        factor * (mu[0] - mu[1])
                    }
                    Multiplier::Square(k, factor) => {
                        let dual = duals[starts[k]];
                        if self.is_at_apex(k, x) {
                            at_apex += usize::from(dual > CERTIFICATE_TOLERANCE);
                            0.0
                        } else {
                            factor * dual / self.cones[k].expressions[0].value(x)
                        }
                    }
                };
        }
        let n = instance.column_count();
        outcome.column_marginal = d[..n].iter().map(|d| sign * d).collect();
        outcome.status = SolverStatus::NormalCompletion;
        if at_apex > 0 {
            let are = if at_apex == 1 {
                "1 is"
            } else {
                &format!("{at_apex} are")
            };
            outcome.message = Some(format!(
                "convex: {}; {are} at the apex, where the squared row has no marginal",
                self.kinds()
            ));
        }
        at_apex
    }

    /// Whether the first coordinate of a cone, and so all of it, is 0.
    fn is_at_apex(&self, cone: usize, x: &[f64]) -> bool {
        let first = &self.cones[cone].expressions[0];
        let terms = first.terms.iter().map(|&(j, a)| (a * x[j as usize]).abs());
        first.value(x) <= APEX_TOLERANCE * terms.fold(1.0, f64::max)
    }

    /// Of each row that is a difference of squares: whether it is at its apex.
    pub(in crate::solve) fn squares_at_apex(&self, x: &[f64]) -> impl Iterator<Item = bool> {
        self.multipliers.iter().filter_map(move |m| match *m {
            Multiplier::Square(k, _) => Some(self.is_at_apex(k, x)),
            _ => None,
        })
    }

    /// Where the coordinates of each cone begin.
    fn starts(&self) -> Vec<usize> {
        let lengths = self.cones.iter().map(|c| c.expressions.len());
        let mut next = 0;
        lengths
            .map(|length| {
                next += length;
                next - length
            })
            .collect()
    }

    /// By column: Σ of |coefficient · multiplier|, and what the rows and cones add up to.
    fn combined(&self, y: &[f64], duals: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let p = &self.linear;
        let mut sum = vec![0.0; p.n()];
        let mut size = vec![0.0f64; p.n()];
        let mut add = |j: usize, v: f64| {
            sum[j] += v;
            size[j] = size[j].max(v.abs());
        };
        for (i, y) in y.iter().enumerate() {
            p.rows.line(i).for_each(|(j, a)| add(j, a * y));
        }
        let expressions = self.cones.iter().flat_map(|c| &c.expressions);
        for (e, dual) in expressions.zip(duals) {
            e.terms.iter().for_each(|&(j, a)| add(j as usize, a * dual));
        }
        (sum, size)
    }

    /// Dual residuals, complementarity and gap at a primal and a dual point.
    fn residuals(&self, x: &[f64], y: &[f64], d: &[f64], duals: &[f64]) -> Residuals {
        let p = &self.linear;
        let (_, size) = self.combined(y, duals);
        let mut out = Residuals::default();
        let (mut dual, mut complementarity, mut sum) = (0.0f64, 0.0f64, 0.0);
        let mut objective = (0.0f64, 0.0f64);
        let mut see = |product: f64| {
            complementarity = complementarity.max(product.abs());
            sum += product.abs();
        };
        for j in 0..p.n() {
            objective.0 += p.cost[j] * x[j];
            objective.1 = objective.1.max((p.cost[j] * x[j]).abs());
            let distance = if d[j] > 0.0 {
                x[j] - p.lower[j]
            } else {
                p.upper[j] - x[j]
            };
            let relative = d[j].abs() / p.cost[j].abs().max(size[j]).max(1.0);
            // a bound pays for a reduced cost: what that leaves is part of the gap
            if distance.is_finite() && relative > ROUNDING {
                see(d[j] * distance);
                continue;
            }
            dual = dual.max(d[j].abs());
            if relative > out.dual_relative {
                (out.dual_relative, out.worst_dual_column) = (relative, Some(j));
            }
        }
        for (i, &y) in y.iter().enumerate().filter(|y| *y.1 != 0.0) {
            let side = p.priced_side(i, y);
            if side.is_finite() {
                see(y * (p.activity(i, x) - side));
            }
        }
        let mut begin = 0;
        for cone in &self.cones {
            let own = &duals[begin..begin + cone.expressions.len()];
            begin += own.len();
            let products = cone.expressions.iter().zip(own);
            see(products.map(|(e, mu)| e.value(x) * mu).sum());
        }
        out.dual = Some(dual);
        out.complementarity = Some(complementarity);
        out.complementarity_sum = Some(sum);
        out.gap_relative = sum / objective.1.max(objective.0.abs()).max(1.0);
        out
    }

    /// Whether multipliers prove that there is no point: what the rows, bounds and cones add up to is a contradiction.
    fn is_infeasible(&self, y: &[f64], duals: &[f64]) -> bool {
        let p = &self.linear;
        let (y, duals) = self.without_negligible(y, duals);
        let (sum, size) = self.combined(&y, &duals);
        let mut proved = 0.0;
        let mut scale = 0.0f64;
        let mut add = |v: f64| {
            proved += v;
            scale = scale.max(v.abs());
        };
        for (i, &y) in y.iter().enumerate().filter(|y| *y.1 != 0.0) {
            let side = p.priced_side(i, y);
            if !side.is_finite() {
                return false;
            }
            add(y * side);
        }
        let expressions = self.cones.iter().flat_map(|c| &c.expressions);
        expressions
            .zip(&duals)
            .for_each(|(e, mu)| add(-e.constant * mu));
        // Σ y a x + Σ μ (D x) = Σ sum x ≥ proved for every feasible x; at most this
        for j in 0..p.n() {
            let bound = if sum[j] > 0.0 { p.upper[j] } else { p.lower[j] };
            match bound.is_finite() {
                true => add(-sum[j] * bound),
                false if sum[j].abs() <= CERTIFICATE_TOLERANCE * size[j] => {}
                false => return false,
            }
        }
        proved > CERTIFICATE_TOLERANCE * scale.max(f64::MIN_POSITIVE)
    }

    /// Multipliers without rows and cones whose terms are negligible beside the largest: they are not part of a proof, but times a
    /// column without a bound they could be all of it.
    fn without_negligible(&self, y: &[f64], duals: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (_, size) = self.combined(y, duals);
        let negligible = NEGLIGIBLE_TERM * size.into_iter().fold(0.0, f64::max);
        let (mut y, mut duals) = (y.to_vec(), duals.to_vec());
        for (i, y) in y.iter_mut().enumerate() {
            if self
                .linear
                .rows
                .line(i)
                .all(|(_, a)| (a * *y).abs() <= negligible)
            {
                *y = 0.0;
            }
        }
        let mut rest = &mut duals[..];
        for cone in &self.cones {
            let (own, others) = rest.split_at_mut(cone.expressions.len());
            let mut terms = cone.expressions.iter().zip(&*own);
            if terms.all(|(e, mu)| e.terms.iter().all(|t| (t.1 * mu).abs() <= negligible)) {
                own.fill(0.0);
            }
            rest = others;
        }
        (y, duals)
    }

    /// Whether a direction keeps all rows, bounds and cones and makes the objective better.
    fn is_ray(&self, ray: &[f64]) -> bool {
        let p = &self.linear;
        let size = ray.iter().fold(0.0f64, |t, v| t.max(v.abs()));
        let gain: f64 = p.cost.iter().zip(ray).map(|(c, v)| c * v).sum();
        let near = CERTIFICATE_TOLERANCE * size;
        let keeps = |v: f64, low: f64, high: f64| {
            (low == f64::NEG_INFINITY || v >= -near) && (high == f64::INFINITY || v <= near)
        };
        let columns = (0..p.n()).all(|j| keeps(ray[j], p.lower[j], p.upper[j]));
        let rows = (0..p.m()).all(|i| keeps(p.activity(i, ray), p.row_lower[i], p.row_upper[i]));
        let cones = self.cones.iter().all(|cone| {
            let e: Vec<f64> = cone
                .expressions
                .iter()
                .map(|e| e.value(ray) - e.constant)
                .collect();
            match cone.kind {
                ConeKind::SecondOrder => {
                    let norm = e[1..].iter().map(|v| v * v).sum::<f64>().sqrt();
                    norm <= e[0] + near
                }
                ConeKind::Exponential if e[1] > near => e[1] * (e[0] / e[1]).exp() <= e[2] + near,
                ConeKind::Exponential => e[0] <= near && e[1] >= -near && e[2] >= -near,
                ConeKind::Power(a) => {
                    let [u, v] = [e[0], e[1]].map(|v| v.max(0.0));
                    e[0].min(e[1]) >= -near && u.powf(a) * v.powf(1.0 - a) + near >= e[2].abs()
                }
            }
        });
        gain < -CERTIFICATE_TOLERANCE * size && columns && rows && cones
    }
}
