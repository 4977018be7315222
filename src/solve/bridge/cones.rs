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

use super::direction::{Directions, make_up};
use super::parts::{Parts, Tree, directions, expressions};
use crate::model::builder::Term;
use crate::model::instance::{Columns, Function, Instance, Op, Relation};
use crate::solve::budget::Budget;
use crate::solve::certificate::Residuals;
use crate::solve::interval::Interval;
use crate::solve::lp::Ended;
use crate::solve::lp::form::{Problem, Sparse};
use crate::solve::lp::interior::{Affine, Cone, ConeKind, solve_conic};
use crate::solve::nlp::composition::composed;
use crate::solve::{Claim, Outcome, SolverStatus};
use std::collections::BTreeMap;

/// Columns of a quadratic row whose matrix is taken apart by its eigenvalues.
const MAX_EIGEN_COLUMNS: usize = 300;

/// An eigenvalue below this, relative to the largest, is 0.
const EIGENVALUE_TOLERANCE: f64 = 1e-13;

/// Rounds in which linear rows tighten the bounds by which signs are judged.
const PROPAGATION_ROUNDS: usize = 5;

/// Clarabel's tolerances; the next one is tried where it does not reach one.
const TOLERANCES: [f64; 2] = [1e-11, 1e-9];

/// Residuals of the conic program, relative to its data, up to which it is solved.
const SOLVED: f64 = 1e-7;

/// A certificate holds to this, relative to what it proves.
const CERTIFICATE_TOLERANCE: f64 = 1e-7;

/// Terms of multipliers this small beside the largest are errors of the method.
const SLIGHT: f64 = 1e-9;

/// A reduced cost below this, relative to its terms, is rounding, however far a bound is.
const ROUNDING: f64 = 1e-12;

/// A cone ends at its apex where the largest coordinate is at most this, relative to its columns.
const APEX: f64 = 1e-7;

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

fn constant(constant: f64) -> Affine {
    Affine {
        constant,
        terms: Vec::new(),
    }
}

fn column(j: u32) -> Affine {
    Affine {
        constant: 0.0,
        terms: vec![(j, 1.0)],
    }
}

/// `a + weight b`.
fn plus(mut a: Affine, b: &Affine, weight: f64) -> Affine {
    a.constant += weight * b.constant;
    a.terms
        .extend(b.terms.iter().map(|&(j, v)| (j, weight * v)));
    a.terms.sort_by_key(|t| t.0);
    a.terms.dedup_by(|t, kept| {
        let same = t.0 == kept.0;
        if same {
            kept.1 += t.1;
        }
        same
    });
    a.terms.retain(|t| t.1 != 0.0);
    a
}

fn times(a: &Affine, weight: f64) -> Affine {
    plus(Affine::default(), a, weight)
}

/// A quadratic expression: weighted squares and an affine rest.
#[derive(Default)]
struct Quadratic {
    squares: Vec<(f64, Affine)>,
    rest: Affine,
}

impl Quadratic {
    /// Squares of a form whose matrix has these eigenvalues; None where it has too many columns.
    fn diagonal(&self, homogeneous: bool) -> Option<Self> {
        let all = self.squares.iter().flat_map(|s| &s.1.terms);
        let mut columns: Vec<u32> = all.map(|t| t.0).collect();
        if homogeneous {
            columns.extend(self.rest.terms.iter().map(|t| t.0));
        }
        columns.sort_unstable();
        columns.dedup();
        if columns.len() > MAX_EIGEN_COLUMNS {
            return None;
        }
        let one = columns.len();
        let place = |j: u32| columns.partition_point(|&k| k < j);
        let size = one + usize::from(homogeneous);
        let mut matrix = faer::Mat::<f64>::zeros(size, size);
        let mut rest = self.rest.clone();
        for (w, p) in &self.squares {
            let own = || p.terms.iter().map(|&(j, a)| (place(j), a));
            for (i, a) in own() {
                own().for_each(|(j, b)| matrix[(i, j)] += w * a * b);
            }
            let linear = times(p, 2.0 * w * p.constant);
            rest = plus(rest, &linear, 1.0);
            rest.constant -= w * p.constant * p.constant;
        }
        if homogeneous {
            for &(j, a) in &rest.terms {
                matrix[(place(j), one)] += 0.5 * a;
                matrix[(one, place(j))] += 0.5 * a;
            }
            matrix[(one, one)] += rest.constant;
            rest = Affine::default();
        }
        let eigen = matrix.self_adjoint_eigen(faer::Side::Lower).ok()?;
        let (values, vectors) = (eigen.S(), eigen.U());
        let largest = (0..size).fold(0.0f64, |t, k| t.max(values[k].abs()));
        let mut squares = Vec::new();
        for k in (0..size).filter(|&k| values[k].abs() > EIGENVALUE_TOLERANCE * largest) {
            let terms = columns.iter().enumerate();
            let p = Affine {
                constant: if homogeneous { vectors[(one, k)] } else { 0.0 },
                terms: terms.map(|(i, &j)| (j, vectors[(i, k)])).collect(),
            };
            squares.push((values[k], p));
        }
        Some(Self { squares, rest })
    }

    fn negative(&self) -> usize {
        self.squares.iter().filter(|s| s.0 < 0.0).count()
    }
}

/// A conic program in the making.
struct Compiler<'i> {
    instance: &'i Instance,
    /// Bounds; new columns come last.
    columns: Columns,
    /// Bounds that linear rows imply.
    implied: Option<Columns>,
    cones: Vec<Cone>,
    rows: Vec<(Affine, [f64; 2])>,
    has_apex: bool,
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
                    if residuals.dual_relative <= SOLVED && residuals.gap_relative <= SOLVED {
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
                        let first = &self.cones[k].expressions[0];
                        let terms = first.terms.iter();
                        let reach =
                            terms.fold(1.0f64, |t, &(j, a)| t.max((a * x[j as usize]).abs()));
                        let value = first.value(x);
                        let dual = duals[starts[k]];
                        if value <= APEX * reach {
                            at_apex += usize::from(dual > CERTIFICATE_TOLERANCE);
                            0.0
                        } else {
                            factor * dual / value
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
            let side = if y > 0.0 {
                p.row_lower[i]
            } else {
                p.row_upper[i]
            };
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
        let (y, duals) = self.without_slight(y, duals);
        let (sum, size) = self.combined(&y, &duals);
        let mut proved = 0.0;
        let mut scale = 0.0f64;
        let mut add = |v: f64| {
            proved += v;
            scale = scale.max(v.abs());
        };
        for (i, &y) in y.iter().enumerate().filter(|y| *y.1 != 0.0) {
            let side = if y > 0.0 {
                p.row_lower[i]
            } else {
                p.row_upper[i]
            };
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

    /// Multipliers without rows and cones whose terms are slight beside the largest: they are not part of a proof, but times a
    /// column without a bound they could be all of it.
    fn without_slight(&self, y: &[f64], duals: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (_, size) = self.combined(y, duals);
        let slight = SLIGHT * size.into_iter().fold(0.0, f64::max);
        let (mut y, mut duals) = (y.to_vec(), duals.to_vec());
        for (i, y) in y.iter_mut().enumerate() {
            if self
                .linear
                .rows
                .line(i)
                .all(|(_, a)| (a * *y).abs() <= slight)
            {
                *y = 0.0;
            }
        }
        let mut rest = &mut duals[..];
        for cone in &self.cones {
            let (own, others) = rest.split_at_mut(cone.expressions.len());
            let mut terms = cone.expressions.iter().zip(&*own);
            if terms.all(|(e, mu)| e.terms.iter().all(|t| (t.1 * mu).abs() <= slight)) {
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

impl Compiler<'_> {
    fn finish(self) -> Problem {
        let n = self.columns.lower.len();
        let mut out = Problem {
            cost: vec![0.0; n],
            rows: Sparse::default(),
            ..Problem::of(&Instance {
                columns: self.columns,
                ..Instance::default()
            })
        };
        if let Some(o) = self.instance.objective {
            out.cost[o.column as usize] = self.instance.sign();
        }
        for (left, [low, high]) in self.rows {
            let left = plus(left, &Affine::default(), 0.0);
            out.row_lower.push(low - left.constant);
            out.row_upper.push(high - left.constant);
            out.rows
                .push(left.terms.into_iter().map(|(j, a)| (j as usize, a)));
        }
        out.columns = out.rows.transpose(n);
        out
    }

    fn cone(&mut self, kind: ConeKind, expressions: Vec<Affine>) -> usize {
        self.cones.push(Cone { kind, expressions });
        self.cones.len() - 1
    }

    /// A second-order cone, which may end at its apex where no coordinate is a number other than 0.
    fn with_apex(&mut self, coordinates: Vec<Affine>) -> usize {
        let away = |e: &Affine| e.terms.is_empty() && e.constant != 0.0;
        self.has_apex |= !coordinates.iter().any(away);
        self.cone(ConeKind::SecondOrder, coordinates)
    }

    fn new_column(&mut self) -> Affine {
        column(self.columns.push(f64::NEG_INFINITY, f64::INFINITY) as u32)
    }

    /// A nonlinear row, `way (left + Σ terms) ≤ 0`.
    fn row(&mut self, left: &Affine, terms: &[(f64, Term)], way: f64) -> Option<Multiplier> {
        let left = times(left, way);
        let mut all = Parts::default();
        for (weight, term) in terms {
            let tree = Tree::new(term);
            tree.split(term.ops.len() - 1, way * weight, &mut all);
        }
        if let Some(found) = self.quadratic_row(&left, &all, way) {
            return Some(found);
        }
        let mut sum = plus(left, &affine_of(&all), 1.0);
        for (weight, term) in &all.nonlinear {
            let tree = Tree::new(term);
            let above = self.above(&tree, term.ops.len() - 1, *weight)?;
            sum = plus(sum, &above, 1.0);
        }
        self.rows.push((sum, [f64::NEG_INFINITY, 0.0]));
        Some(Multiplier::Row(self.rows.len() - 1, way))
    }

    fn quadratic_row(&mut self, left: &Affine, parts: &Parts, way: f64) -> Option<Multiplier> {
        let mut q = quadratic(parts)?;
        q.rest = plus(q.rest, left, 1.0);
        if q.negative() > 0 {
            let is_cone = q.negative() == 1 && q.rest.terms.is_empty() && q.rest.constant >= 0.0;
            if !is_cone {
                let convex = q.diagonal(false).filter(|q| q.negative() == 0);
                q = match convex {
                    Some(convex) => convex,
                    None => q.diagonal(true)?,
                };
            }
        }
        let root = |(w, p): &(f64, Affine), by: f64| times(p, by * w.abs().sqrt());
        if q.negative() == 0 {
            let minus_one = |sign: f64| plus(constant(1.0), &q.rest, sign);
            let mut coordinates = vec![minus_one(-1.0), minus_one(1.0)];
            coordinates.extend(q.squares.iter().map(|s| root(s, 2.0)));
            let k = self.cone(ConeKind::SecondOrder, coordinates);
            return Some(Multiplier::Quadratic(k, -way));
        }
        if q.negative() > 1 || !q.rest.terms.is_empty() || q.rest.constant < 0.0 {
            return None;
        }
        let negative = q.squares.iter().position(|s| s.0 < 0.0)?;
        let (w, p) = q.squares.swap_remove(negative);
        let sign = [1.0, -1.0]
            .into_iter()
            .find(|&s| self.is_nonnegative(&times(&p, s)))?;
        let mut coordinates = vec![times(&p, sign * w.abs().sqrt())];
        coordinates.extend(q.squares.iter().map(|s| root(s, 1.0)));
        if q.rest.constant > 0.0 {
            coordinates.push(constant(q.rest.constant.sqrt()));
        }
        let k = self.with_apex(coordinates);
        Some(Multiplier::Square(k, -0.5 * way))
    }

    /// Whether bounds and linear rows imply that an expression is not below 0.
    fn is_nonnegative(&mut self, e: &Affine) -> bool {
        let least = |c: &Columns| {
            let end = |&(j, a): &(u32, f64)| match a > 0.0 {
                true => a * c.lower[j as usize],
                false => a * c.upper[j as usize],
            };
            e.constant + e.terms.iter().map(end).sum::<f64>()
        };
        if least(&self.columns) >= 0.0 {
            return true;
        }
        let implied = self
            .implied
            .get_or_insert_with(|| implied_bounds(self.instance));
        let known = e.terms.iter().all(|t| (t.0 as usize) < implied.lower.len());
        known && least(implied) >= -1e-12 * e.constant.abs().max(1.0)
    }

    fn range(&self, tree: &Tree, p: usize) -> Interval {
        composed(&tree.cut(p), &self.columns).range
    }

    /// An expression that is not below `weight` times the one that ends at p, and equal to it at its least.
    fn above(&mut self, tree: &Tree, p: usize, weight: f64) -> Option<Affine> {
        if let Some(affine) = affine(tree, p) {
            return Some(times(&affine, weight));
        }
        let arguments = tree.arguments(p);
        let number = |k: usize| arguments.get(k).and_then(|&a| tree.number(a));
        let convex = weight > 0.0;
        match (tree.whole.ops[p], &arguments[..]) {
            (Op::Add(_), all) => {
                let mut sum = Affine::default();
                for &a in all {
                    sum = plus(sum, &self.above(tree, a, weight)?, 1.0);
                }
                Some(sum)
            }
            (Op::Negate, &[a]) => self.above(tree, a, -weight),
            (Op::Divide, &[a, b]) => {
                if let Some(c) = tree.number(b) {
                    return self.above(tree, a, weight / c);
                }
                // a / b = Σ squares / b
                let b = affine(tree, b).filter(|b| self.is_nonnegative(b))?;
                let squares = sum_of_squares(tree, a, weight)?;
                let v = self.new_column();
                let mut coordinates = vec![plus(v.clone(), &b, 1.0), plus(v.clone(), &b, -1.0)];
                coordinates.extend(squares.iter().map(|s| times(s, 2.0)));
                self.with_apex(coordinates);
                Some(v)
            }
            (Op::Multiply(_), all) => {
                let numbers: f64 = all.iter().filter_map(|&a| tree.number(a)).product();
                let weight = weight * numbers;
                let rest: Vec<usize> = all
                    .iter()
                    .copied()
                    .filter(|&a| tree.number(a).is_none())
                    .collect();
                match rest[..] {
                    [a] => self.above(tree, a, weight),
                    [a, b] => self.product(tree, a, b, weight),
                    _ => None,
                }
            }
            (Op::PowerInt(k), &[a]) => self.power(tree, a, f64::from(k), true, weight),
            (Op::Call(Function::Sqr, _), &[a]) => self.power(tree, a, 2.0, true, weight),
            (Op::Call(Function::Power, _), &[a, _]) => {
                self.power(tree, a, number(1)?, true, weight)
            }
            (Op::Power | Op::Call(Function::RPower | Function::VcPower, _), &[a, _]) => {
                self.power(tree, a, number(1)?, false, weight)
            }
            (Op::Call(Function::Sqrt, _), &[a]) => self.power(tree, a, 0.5, false, weight),
            (Op::Call(Function::EDist, _), all) if convex => {
                let all: Option<Vec<Affine>> = all.iter().map(|&a| affine(tree, a)).collect();
                Some(self.norm(all?, weight))
            }
            (Op::Call(Function::Exp, _), &[a]) if convex => {
                let a = self.above(tree, a, 1.0)?;
                let v = self.new_column();
                self.cone(ConeKind::Exponential, vec![a, constant(1.0), v.clone()]);
                Some(times(&v, weight))
            }
            (Op::Call(f @ (Function::Log | Function::Log2 | Function::Log10), _), &[a]) => {
                let base = match f {
                    Function::Log2 => std::f64::consts::LN_2,
                    Function::Log10 => std::f64::consts::LN_10,
                    _ => 1.0,
                };
                let v = self.new_column();
                if convex {
                    self.exponentials(tree, a, &v)?;
                } else {
                    let a = times(&self.above(tree, a, -1.0)?, -1.0);
                    self.cone(ConeKind::Exponential, vec![v.clone(), constant(1.0), a]);
                }
                Some(times(&v, weight / base))
            }
            (Op::Call(Function::LseMax, _), all) if convex => {
                let v = self.new_column();
                let mut sum = constant(-1.0);
                for &a in all {
                    let a = self.above(tree, a, 1.0)?;
                    sum = plus(sum, &self.below_exponential(&a, &v), 1.0);
                }
                self.rows.push((sum, [f64::NEG_INFINITY, 0.0]));
                Some(times(&v, weight))
            }
            // −x log x
            (Op::Call(Function::Entropy, _), &[a]) if !convex => {
                let x = affine(tree, a)?;
                Some(times(&self.relative_entropy(x, constant(1.0)), -weight))
            }
            _ => None,
        }
    }

    /// A column that is not below `weight` ‖all‖, times nothing more.
    fn norm(&mut self, all: Vec<Affine>, weight: f64) -> Affine {
        let v = self.new_column();
        let mut coordinates = vec![v.clone()];
        coordinates.extend(all);
        self.with_apex(coordinates);
        times(&v, weight)
    }

    /// A column that is not below x log(x/y).
    fn relative_entropy(&mut self, x: Affine, y: Affine) -> Affine {
        let v = self.new_column();
        self.cone(ConeKind::Exponential, vec![times(&v, -1.0), x, y]);
        v
    }

    /// A column that is not below exp(a − v).
    fn below_exponential(&mut self, a: &Affine, v: &Affine) -> Affine {
        let u = self.new_column();
        let difference = plus(a.clone(), v, -1.0);
        self.cone(
            ConeKind::Exponential,
            vec![difference, constant(1.0), u.clone()],
        );
        u
    }

    /// v ≥ log of a sum of exponentials and positive numbers.
    fn exponentials(&mut self, tree: &Tree, p: usize, v: &Affine) -> Option<()> {
        let mut parts = Parts::default();
        tree.split(p, 1.0, &mut parts);
        if !parts.linear.is_empty() || parts.constant < 0.0 {
            return None;
        }
        let mut sum = constant(-1.0);
        if parts.constant > 0.0 {
            let a = constant(parts.constant.ln());
            sum = plus(sum, &self.below_exponential(&a, v), 1.0);
        }
        for (weight, term) in &parts.nonlinear {
            let (tree, last) = (Tree::new(term), term.ops.len() - 1);
            match (term.ops[last], &tree.arguments(last)[..]) {
                (Op::Call(Function::Exp, _), &[a]) if *weight > 0.0 => {
                    let mut a = self.above(&tree, a, 1.0)?;
                    a.constant += weight.ln();
                    sum = plus(sum, &self.below_exponential(&a, v), 1.0);
                }
                _ => return None,
            }
        }
        self.rows.push((sum, [f64::NEG_INFINITY, 0.0]));
        Some(())
    }

    /// `weight · a^power`; where `signed`, of arguments below 0 too.
    fn power(
        &mut self,
        tree: &Tree,
        a: usize,
        power: f64,
        signed: bool,
        weight: f64,
    ) -> Option<Affine> {
        let convex = weight > 0.0;
        if convex && power == 0.5 {
            let squares = sum_of_squares(tree, a, 1.0)?;
            return Some(self.norm(squares, weight));
        }
        let range = self.range(tree, a);
        let even = signed && power.rem_euclid(2.0) == 0.0;
        // a real power has no value below 0, which its cone must say or the bounds
        let right = range.low >= 0.0;
        let rising = power > 0.0;
        let x = match affine(tree, a) {
            Some(x) => x,
            // convex and rising of convex, convex and falling of concave, concave and rising of concave
            None if convex && rising && range.low >= 0.0 => self.above(tree, a, 1.0)?,
            None if rising != convex || !convex => times(&self.above(tree, a, -1.0)?, -1.0),
            None => return None,
        };
        let v = self.new_column();
        let one = constant(1.0);
        let (kind, coordinates) = match power {
            2.0 if convex && (even || right) => {
                let both = [plus(one.clone(), &v, 1.0), plus(one, &v, -1.0)];
                let mut all = both.to_vec();
                all.push(times(&x, 2.0));
                (ConeKind::SecondOrder, all)
            }
            p if p > 1.0 && convex && (even || right) => {
                (ConeKind::Power(1.0 / p), vec![v.clone(), one, x])
            }
            p if p < 0.0 && convex && (right || !signed) => {
                (ConeKind::Power(1.0 / (1.0 - p)), vec![v.clone(), x, one])
            }
            p if p > 0.0 && p < 1.0 && !convex => (ConeKind::Power(p), vec![x, one, v.clone()]),
            _ => return None,
        };
        self.cone(kind, coordinates);
        Some(times(&v, weight))
    }

    /// `weight · a · b`: a square, x log(x/y), y exp(x/y), or a geometric mean.
    fn product(&mut self, tree: &Tree, a: usize, b: usize, weight: f64) -> Option<Affine> {
        let convex = weight > 0.0;
        let (terms, last) = ([tree.cut(a), tree.cut(b)], |t: &Term| t.ops.len() - 1);
        if terms[0] == terms[1] {
            return self.power(tree, a, 2.0, true, weight);
        }
        for (x, f) in [(0, 1), (1, 0)] {
            let whole = |t: &Term| affine(&Tree::new(t), last(t));
            let Some(x) = whole(&terms[x]) else { continue };
            let inner = Tree::new(&terms[f]);
            let end = last(&terms[f]);
            let (op, arguments) = (terms[f].ops[end], inner.arguments(end));
            let quotient = |p: usize| match (inner.whole.ops[p], &inner.arguments(p)[..]) {
                (Op::Divide, &[a, b]) => Some((affine(&inner, a)?, affine(&inner, b)?)),
                _ => None,
            };
            match (op, &arguments[..]) {
                (Op::Call(Function::Log, _), &[p]) => {
                    let (over, under) =
                        quotient(p).or_else(|| Some((affine(&inner, p)?, constant(1.0))))?;
                    // x log(a x/y) and, concave, x log(y/(a x))
                    let (own, other, sign) = match convex {
                        true => (&over, &under, 1.0),
                        false => (&under, &over, -1.0),
                    };
                    if let Some(a) = multiple(own, &x) {
                        let y = times(other, 1.0 / a);
                        return Some(times(&self.relative_entropy(x, y), sign * weight));
                    }
                }
                (Op::Call(Function::Exp, _), &[p]) if convex => {
                    if let Some((over, under)) = quotient(p).filter(|q| q.1 == x) {
                        let v = self.new_column();
                        self.cone(ConeKind::Exponential, vec![over, under, v.clone()]);
                        return Some(times(&v, weight));
                    }
                }
                _ => {}
            }
        }
        let [a, b] = [0, 1].map(|k| root_of(&terms[k]));
        let ((x, p), (y, q)) = (a?, b?);
        if convex || p <= 0.0 || q <= 0.0 || (p + q - 1.0).abs() > 1e-12 {
            return None;
        }
        let v = self.new_column();
        self.cone(ConeKind::Power(p), vec![x, y, v.clone()]);
        Some(times(&v, weight))
    }
}

/// A real power of an affine expression, with its exponent.
fn root_of(term: &Term) -> Option<(Affine, f64)> {
    let (tree, last) = (Tree::new(term), term.ops.len() - 1);
    let power = match (term.ops[last], &tree.arguments(last)[..]) {
        (Op::Call(Function::Sqrt, _), &[a]) => (a, 0.5),
        (Op::Power | Op::Call(Function::RPower | Function::VcPower, _), &[a, p]) => {
            (a, tree.number(p)?)
        }
        _ => return None,
    };
    Some((affine(&tree, power.0)?, power.1))
}

/// The positive number that makes the one of the other, rounding aside.
fn multiple(of: &Affine, one: &Affine) -> Option<f64> {
    let a = of.terms.first()?.1 / one.terms.first()?.1;
    let rest = plus(of.clone(), one, -a);
    let near = |v: f64, of: f64| v.abs() <= 4.0 * f64::EPSILON * of.abs();
    let size = of
        .terms
        .iter()
        .fold(of.constant.abs(), |t, e| t.max(e.1.abs()));
    let same = near(rest.constant, size) && rest.terms.iter().all(|e| near(e.1, size));
    (a > 0.0 && same).then_some(a)
}

fn affine_of(parts: &Parts) -> Affine {
    let parts = Affine {
        constant: parts.constant,
        terms: parts.linear.clone(),
    };
    times(&parts, 1.0)
}

/// The affine expression that ends at p.
fn affine(tree: &Tree, p: usize) -> Option<Affine> {
    let mut parts = Parts::default();
    tree.split(p, 1.0, &mut parts);
    parts.nonlinear.is_empty().then(|| affine_of(&parts))
}

/// A sum as weighted squares of affine expressions and an affine rest.
fn quadratic(parts: &Parts) -> Option<Quadratic> {
    let mut out = Quadratic {
        squares: Vec::new(),
        rest: affine_of(parts),
    };
    for (weight, term) in &parts.nonlinear {
        let (tree, last) = (Tree::new(term), term.ops.len() - 1);
        match (term.ops[last], &tree.arguments(last)[..]) {
            (Op::PowerInt(2) | Op::Call(Function::Sqr, _), &[a]) => {
                out.squares.push((*weight, affine(&tree, a)?));
            }
            (Op::Call(Function::Power, _), &[a, k]) if tree.number(k) == Some(2.0) => {
                out.squares.push((*weight, affine(&tree, a)?));
            }
            (Op::Multiply(_), all) => {
                let numbers: f64 = all.iter().filter_map(|&a| tree.number(a)).product();
                let mut factors = all.iter().filter(|&&a| tree.number(a).is_none());
                let (Some(&a), Some(&b), None) = (factors.next(), factors.next(), factors.next())
                else {
                    return None;
                };
                let (a, b) = (affine(&tree, a)?, affine(&tree, b)?);
                let weight = weight * numbers;
                if a == b {
                    out.squares.push((weight, a));
                } else {
                    out.squares.push((0.25 * weight, plus(a.clone(), &b, 1.0)));
                    out.squares.push((-0.25 * weight, plus(a, &b, -1.0)));
                }
            }
            _ => return None,
        }
    }
    Some(out)
}

/// Affine expressions whose squares add up to `weight` times the expression that ends at p.
fn sum_of_squares(tree: &Tree, p: usize, weight: f64) -> Option<Vec<Affine>> {
    let mut parts = Parts::default();
    tree.split(p, weight, &mut parts);
    let mut q = quadratic(&parts)?;
    if q.negative() > 0 || !q.rest.terms.is_empty() {
        q = q.diagonal(true)?;
    }
    if q.negative() > 0 || !q.rest.terms.is_empty() || q.rest.constant < 0.0 {
        return None;
    }
    let roots = q.squares.iter().map(|(w, p)| times(p, w.sqrt()));
    let mut all: Vec<Affine> = roots.collect();
    if q.rest.constant > 0.0 {
        all.push(constant(q.rest.constant.sqrt()));
    }
    Some(all)
}

/// Bounds of the columns that linear rows imply.
fn implied_bounds(instance: &Instance) -> Columns {
    let mut c = instance.columns.clone();
    let nonlinear = instance.nonlinear_rows();
    for _ in 0..PROPAGATION_ROUNDS {
        let mut changed = false;
        for i in (0..instance.row_count()).filter(|&i| !nonlinear[i]) {
            let [low, high] = instance.rows.relation[i].bounds(instance.rows.rhs[i]);
            for sign in [1.0, -1.0] {
                // sign Σ a x ≤ side
                let side = if sign > 0.0 { high } else { -low };
                if side == f64::INFINITY {
                    continue;
                }
                let least = |c: &Columns, j: usize, a: f64| match a > 0.0 {
                    true => a * c.lower[j],
                    false => a * c.upper[j],
                };
                let entries = || instance.matrix.row(i).map(|(j, a)| (j, sign * a));
                let infinite = entries()
                    .filter(|&(j, a)| least(&c, j, a) == f64::NEG_INFINITY)
                    .count();
                if infinite > 1 {
                    continue;
                }
                let finite: f64 = entries()
                    .map(|(j, a)| least(&c, j, a))
                    .filter(|v| v.is_finite())
                    .sum();
                let mut tighter = Vec::new();
                for (j, a) in entries() {
                    let own = least(&c, j, a);
                    if infinite == 1 && own.is_finite() {
                        continue;
                    }
                    let others = if own.is_finite() {
                        finite - own
                    } else {
                        finite
                    };
                    tighter.push((j, a, (side - others) / a));
                }
                for (j, a, bound) in tighter {
                    if a > 0.0 && bound < c.upper[j] {
                        (c.upper[j], changed) = (bound, true);
                    } else if a < 0.0 && bound > c.lower[j] {
                        (c.lower[j], changed) = (bound, true);
                    }
                }
            }
        }
        if !changed {
            break;
        }
    }
    c
}
