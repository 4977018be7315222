//! The matrix of a dual against the transposed matrix of the model it comes from.

use super::{Comparison, Instance, eliminated};
use crate::autodiff::Evaluator;
use crate::check::node::SymbolId;
use crate::formulation::derive::Primal;
use crate::formulation::tree::Variable;
use crate::formulation::{Formulation, Origin, Scope};
use crate::model::instance::{self, Relation};
use crate::model::origin::Block;
use crate::solve::random::Random;
use rustc_hash::FxHashMap;

/// Compares the generated dual with the transposed primal: matrix, right sides, costs, bounds and relations. Of quadratic
/// programs the tangents are compared, at points drawn at random: there the one is the linear dual of the other.
pub(super) fn dual(scope: Scope, primal: &Primal, f: &Formulation, d: &Instance) -> Comparison {
    let mut c = Comparison::default();
    let p = &primal.generated.instance;
    let dual = &d.generated.instance;
    let names = Names::new(scope, primal, f, d);
    if p.is_linear() {
        compare(f, &names, p, dual, &mut c);
        return c;
    }
    let columns = 0..p.column_count();
    let points: Vec<Option<usize>> = columns.map(|j| names.of_column(Origin::Point, j)).collect();
    let mut stream = Random(1);
    for _ in 0..super::POINTS {
        let x: Vec<f64> = points
            .iter()
            .map(|_| 2.0 * stream.uniform() - 1.0)
            .collect();
        let mut y = vec![0.0; dual.column_count()];
        let mut is_point = vec![false; y.len()];
        for (place, x) in points.iter().zip(&x) {
            if let Some(k) = place {
                (y[*k], is_point[*k]) = (*x, true);
            }
        }
        match (tangents(p, &x, &[]), tangents(dual, &y, &is_point)) {
            (Some(p), Some(dual)) => compare(f, &names, &p, &dual, &mut c),
            _ => c.differ("a function has no value".into()),
        }
    }
    c
}

/// A program with the tangents at a point for its functions, and without the columns that are said.
fn tangents(p: &instance::Instance, x: &[f64], without: &[bool]) -> Option<instance::Instance> {
    let (activity, jacobian) = Evaluator::new(p).linearised(x).ok()?;
    let mut out = instance::Instance {
        columns: p.columns.clone(),
        objective: p.objective,
        ..instance::Instance::default()
    };
    for (i, entries) in jacobian.into_iter().enumerate() {
        let entries = entries.into_iter();
        let entries = entries.filter(|(j, _)| !without.get(*j).is_some_and(|w| *w));
        let entries: Vec<(usize, f64)> = entries.collect();
        let slope: f64 = entries.iter().map(|(j, v)| v * x[*j]).sum();
        let rhs = p.rows.rhs[i] - activity[i] + slope;
        out.add_row(entries, p.rows.relation[i], rhs);
    }
    Some(out)
}

/// The rows and columns of a model, and where they are in its dual.
struct Names<'a> {
    scope: Scope<'a>,
    primal: &'a Primal,
    d: &'a Instance,
    /// The dual's columns by what their multipliers belong to.
    multipliers: FxHashMap<Origin, &'a Block>,
}

impl<'a> Names<'a> {
    fn new(scope: Scope<'a>, primal: &'a Primal, f: &Formulation, d: &'a Instance) -> Self {
        let multipliers = f.multipliers.iter();
        Self {
            scope,
            primal,
            d,
            multipliers: multipliers
                .filter_map(|m| Some((m.origin, d.columns(&m.name)?)))
                .collect(),
        }
    }

    fn row(&self, i: usize) -> String {
        let rows = &self.primal.generated.origin.rows;
        self.scope.called(rows, i)
    }

    fn column(&self, j: usize) -> String {
        let columns = &self.primal.generated.origin.columns;
        self.scope.called(columns, j)
    }

    /// The column in the dual that belongs to a row.
    fn of_row(&self, i: usize) -> Option<usize> {
        let b = self.primal.generated.origin.rows.of(i as u32);
        let block = self.multipliers.get(&Origin::Row(b.symbol))?;
        self.d.find(block, b.key(i as u32))
    }

    /// The column in the dual that belongs to a column.
    fn of_column(&self, origin: fn(SymbolId) -> Origin, j: usize) -> Option<usize> {
        if self.multipliers.is_empty() {
            return None;
        }
        let b = self.primal.generated.origin.columns.of(j as u32);
        let block = self.multipliers.get(&origin(b.symbol))?;
        self.d.find(block, b.key(j as u32))
    }
}

/// Compares two linear programs.
fn compare(
    f: &Formulation,
    names: &Names,
    p: &instance::Instance,
    dual: &instance::Instance,
    c: &mut Comparison,
) {
    let first = |b: &Block| b.start as usize;
    let z = names.d.columns(&f.objective_name).map(first);
    let defining = names.d.rows(&format!("{}_row", f.objective_name));
    let defining = defining.map(first);
    let found = defining.zip(z);
    let Some(d0) = found.and_then(|(i, z)| Objective::of(dual, i, z)) else {
        c.differ("the dual has no objective".into());
        return;
    };
    let z = p.objective.map(|o| o.column as usize);
    let gone = eliminated(names.primal, f, z).zip(z);
    let by_row = gone.map(|(i, z)| Objective::of(p, i, z).unwrap_or_default());
    let f0 = by_row.unwrap_or_else(|| {
        let mut gradient = vec![0.0; p.column_count()];
        z.into_iter().for_each(|z| gradient[z] = 1.0);
        let constant = 0.0;
        Objective { gradient, constant }
    });
    c.number(f0.constant, d0.constant, &|| {
        "the constant of the objective".into()
    });
    let mut t = Transposed {
        c,
        names,
        p,
        dual,
        minimum: p.sign() > 0.0,
        gone,
        f0,
        d0,
    };
    let matrix = t.rows();
    t.columns(f, defining, matrix);
}

/// A linear objective function.
#[derive(Default)]
struct Objective {
    gradient: Vec<f64>,
    constant: f64,
}

impl Objective {
    /// The function that a linear row defines for a column.
    fn of(p: &instance::Instance, row: usize, z: usize) -> Option<Self> {
        let a = p.matrix.row(row).find(|t| t.0 == z && t.1 != 0.0)?.1;
        let mut gradient = vec![0.0; p.column_count()];
        p.matrix.row(row).for_each(|(j, v)| gradient[j] = -v / a);
        gradient[z] = 0.0;
        let constant = p.rows.rhs[row] / a;
        Some(Self { gradient, constant })
    }
}

/// The two instances, and where the one is in the other.
struct Transposed<'a> {
    c: &'a mut Comparison,
    names: &'a Names<'a>,
    p: &'a instance::Instance,
    dual: &'a instance::Instance,
    minimum: bool,
    /// The row and the column of the objective, where they are eliminated.
    gone: Option<(usize, usize)>,
    /// The objective functions of the primal and of the dual.
    f0: Objective,
    d0: Objective,
}

impl Transposed<'_> {
    /// The rows of the primal are columns of the dual: the transposed matrix by columns of the primal.
    fn rows(&mut self) -> Vec<Vec<(usize, f64)>> {
        let mut transposed = vec![Vec::new(); self.p.column_count()];
        for i in 0..self.p.row_count() {
            let (relation, rhs) = (self.p.rows.relation[i], self.p.rows.rhs[i]);
            if self.gone.is_some_and(|g| g.0 == i) || relation == Relation::Free {
                continue;
            }
            let names = self.names;
            let Some(y) = names.of_row(i) else {
                // A row that holds nothing but an eliminated variable, or no number but zeros.
                let z = self.gone.map(|g| g.1);
                let mut entries = self.p.matrix.row(i);
                let empty = entries.all(|(k, v)| v == 0.0 || Some(k) == z);
                if !empty || rhs != 0.0 {
                    let name = names.row(i);
                    self.c
                        .differ(format!("the multiplier of {name} is not in the dual"));
                }
                continue;
            };
            self.c.number(rhs, self.d0.gradient[y], &|| {
                format!("the right side of {}", names.row(i))
            });
            let bounds = match (relation, self.minimum) {
                (Relation::Equal, _) => (f64::NEG_INFINITY, f64::INFINITY),
                (Relation::Greater, true) | (Relation::Less, false) => (0.0, f64::INFINITY),
                _ => (f64::NEG_INFINITY, 0.0),
            };
            let columns = &self.dual.columns;
            if (columns.lower[y], columns.upper[y]) != bounds {
                let name = names.row(i);
                self.c
                    .differ(format!("the sign of the multiplier of {name}"));
            }
            for (j, v) in self.p.matrix.row(i).filter(|t| t.1 != 0.0) {
                transposed[j].push((y, v));
            }
        }
        transposed
    }

    /// The columns of the primal are rows of the dual.
    fn columns(
        &mut self,
        f: &Formulation,
        defining: Option<usize>,
        mut transposed: Vec<Vec<(usize, f64)>>,
    ) {
        let names = self.names;
        let columns = &names.primal.generated.origin.columns;
        let mut row_of: Vec<Option<usize>> = vec![None; transposed.len()];
        let mut is_known = vec![false; self.dual.row_count()];
        for r in &f.rows {
            let Some(Variable::Own(v)) = r.pair else {
                continue;
            };
            let (Some(own), Some(b)) = (names.d.rows(&r.name), columns.symbol(v)) else {
                continue;
            };
            for j in b.start..b.start + b.len {
                let gone = self.gone.is_some_and(|g| g.1 == j as usize);
                let Some(i) = names.d.find(own, b.key(j)).filter(|_| !gone) else {
                    continue;
                };
                is_known[i] = true;
                if row_of[j as usize].replace(i).is_some() {
                    let name = names.column(j as usize);
                    self.c
                        .differ(format!("two rows of the dual belong to {name}"));
                }
            }
        }
        for (j, want) in transposed.iter_mut().enumerate() {
            if self.gone.is_none_or(|g| g.1 != j) {
                self.column(j, row_of[j], std::mem::take(want));
            }
        }
        for i in (0..is_known.len()).filter(|&i| !is_known[i] && Some(i) != defining) {
            let name = names.d.name(&names.d.generated.origin.rows, i);
            self.c
                .differ(format!("a row of {name} of the dual belongs to no column"));
        }
    }

    /// A column of the primal with its row in the dual, whose entries are to be `want` and the multipliers of bounds.
    fn column(&mut self, j: usize, row: Option<usize>, mut want: Vec<(usize, f64)>) {
        let names = self.names;
        let name = || names.column(j);
        let origins: [fn(SymbolId) -> Origin; 3] = [Origin::Lower, Origin::Upper, Origin::Fixed];
        let [lower, upper, fixed] = origins.map(|o| names.of_column(o, j));
        let bounds = [lower, upper, fixed].into_iter().flatten();
        want.extend(bounds.map(|y| (y, 1.0)));
        let c = &mut *self.c;
        let Some(i) = row else {
            // Without a multiplier it is a row of numbers, which holds, or the dual could not be generated.
            if !want.is_empty() {
                c.differ(format!("the column {} has no row in the dual", name()));
            }
            return;
        };
        let dual = self.dual;
        let entry = |c: &mut Comparison, y: usize, v: f64, w: f64| {
            let of = |y| names.d.name(&names.d.generated.origin.columns, y);
            c.number(v, w, &|| format!("{} in the row of {}", of(y), name()));
        };
        want.sort_unstable_by_key(|t| t.0);
        let mut have = dual.matrix.row(i).filter(|t| t.1 != 0.0).peekable();
        for (y, v) in want {
            while let Some((other, w)) = have.next_if(|h| h.0 < y) {
                entry(c, other, 0.0, w);
            }
            c.entries += 1;
            entry(c, y, v, have.next_if(|h| h.0 == y).map_or(0.0, |h| h.1));
        }
        for (other, w) in have {
            entry(c, other, 0.0, w);
        }
        c.number(self.f0.gradient[j], dual.rows.rhs[i], &|| {
            format!("the cost of {}", name())
        });
        // The relation says what the multipliers of bounds do not.
        let (said_lower, said_upper) = match (dual.rows.relation[i], self.minimum) {
            (Relation::Equal, _) => (false, false),
            (Relation::Less, true) | (Relation::Greater, false) => (true, false),
            _ => (false, true),
        };
        let (lo, up) = (self.p.columns.lower[j], self.p.columns.upper[j]);
        let worth = &self.d0.gradient;
        if let Some(y) = fixed {
            c.number(lo, worth[y], &|| format!("the value of {}", name()));
        } else {
            let sides = [
                (lo, lower, said_lower, "lower"),
                (up, upper, said_upper, "upper"),
            ];
            for (b, y, said, what) in sides {
                let words = || format!("the {what} bound of {}", name());
                match y {
                    Some(y) => c.number(b, worth[y], &words),
                    None if said => c.number(b, 0.0, &words),
                    None if b.is_finite() => c.differ(format!("{} is not in the dual", words())),
                    None => {}
                }
            }
        }
        if said_lower && lo < 0.0 || said_upper && up > 0.0 {
            c.differ(format!("the relation of the row of {}", name()));
        }
    }
}
