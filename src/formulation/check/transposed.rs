//! The matrix of a dual against the transposed matrix of the model it comes from.

use super::{Comparison, Instance, Record, eliminated, records};
use crate::autodiff::Evaluator;
use crate::check::symbols::{Store, Symbols};
use crate::formulation::convex::{Objective, at_origin};
use crate::formulation::derive::Primal;
use crate::formulation::tree::Variable;
use crate::formulation::{Formulation, Origin};
use crate::model::instance::{self, Relation};
use rustc_hash::FxHashMap;

/// Compares the generated dual with the transposed primal: matrix, right sides, costs, bounds and relations.
pub fn dual(
    symbols: &Symbols,
    store: &Store,
    primal: &Primal,
    f: &Formulation,
    d: &Instance,
) -> Comparison {
    let mut c = Comparison::default();
    let objective = (f.objective_name.to_lowercase(), Vec::new());
    let objective_row = (f.objective_name.to_lowercase() + "_row", Vec::new());
    let dual = &d.generated.instance;
    let place = d.columns_by_name();
    let defining = d.rows.iter().position(|r| *r == objective_row);
    let found = defining.zip(place.get(&objective));
    let Some(d0) = found.and_then(|(i, &z)| at_origin(dual, &mut Evaluator::new(dual), i, z))
    else {
        c.differ("the dual has no objective".into());
        return c;
    };
    let o = &primal.generated.origin;
    let p = &primal.generated.instance;
    let z = p.objective.map(|o| o.column as usize);
    let gone = eliminated(primal, f, z).zip(z);
    let by_row = gone.map(|(i, z)| at_origin(p, &mut Evaluator::new(p), i, z).unwrap_or_default());
    let f0 = by_row.unwrap_or_else(|| {
        let mut gradient = vec![0.0; p.column_count()];
        z.into_iter().for_each(|z| gradient[z] = 1.0);
        Objective {
            gradient,
            ..Objective::default()
        }
    });
    let mut t = Transposed {
        c,
        primal,
        p,
        d,
        minimum: p.sign() > 0.0,
        rows: records(symbols, store, &o.rows),
        columns: records(symbols, store, &o.columns),
        names: f
            .multipliers
            .iter()
            .map(|m| (m.origin, m.name.to_lowercase()))
            .collect(),
        place,
        gone,
        f0,
        d0,
    };
    let constants = (t.f0.constant, t.d0.constant);
    t.c.number(constants.0, constants.1, &|| {
        "the constant of the objective".into()
    });
    let mut matrix = t.rows();
    t.slopes(&mut matrix);
    t.columns(symbols, f, defining, matrix);
    t.c
}

/// The two instances, and where the one is in the other.
struct Transposed<'a> {
    c: Comparison,
    primal: &'a Primal,
    p: &'a instance::Instance,
    d: &'a Instance,
    minimum: bool,
    /// Names of the primal's rows and columns.
    rows: Vec<Record>,
    columns: Vec<Record>,
    /// Names of multipliers.
    names: FxHashMap<Origin, String>,
    /// The dual's columns.
    place: FxHashMap<&'a Record, usize>,
    /// The row and the column of the objective, where they are eliminated.
    gone: Option<(usize, usize)>,
    /// The objective functions of the primal and of the dual.
    f0: Objective,
    d0: Objective,
}

impl Transposed<'_> {
    /// The column of a multiplier in the dual.
    fn multiplier(&self, origin: Origin, key: &[String]) -> Option<usize> {
        let name = self.names.get(&origin)?.clone();
        self.place.get(&(name, key.to_vec())).copied()
    }

    /// The rows of the primal are columns of the dual: the transposed matrix by columns of the primal.
    fn rows(&mut self) -> Vec<Vec<(usize, f64)>> {
        let mut transposed = vec![Vec::new(); self.p.column_count()];
        for i in 0..self.p.row_count() {
            let (relation, rhs) = (self.p.rows.relation[i], self.p.rows.rhs[i]);
            if self.gone.is_some_and(|g| g.0 == i) || relation == Relation::Free {
                continue;
            }
            let symbol = self.primal.generated.origin.rows.of(i as u32).symbol;
            let Some(y) = self.multiplier(Origin::Row(symbol), &self.rows[i].1) else {
                // A row that holds nothing but an eliminated variable, or no number but zeros.
                let z = self.gone.map(|g| g.1);
                let mut entries = self.p.matrix.row(i);
                let empty = entries.all(|(k, v)| v == 0.0 || Some(k) == z);
                if !empty || rhs != 0.0 {
                    let name = &self.rows[i];
                    self.c
                        .differ(format!("the multiplier of {name:?} is not in the dual"));
                }
                continue;
            };
            let name = &self.rows[i];
            self.c.number(rhs, self.d0.gradient[y], &|| {
                format!("the right side of {name:?}")
            });
            let bounds = match (relation, self.minimum) {
                (Relation::Equal, _) => (f64::NEG_INFINITY, f64::INFINITY),
                (Relation::Greater, true) | (Relation::Less, false) => (0.0, f64::INFINITY),
                _ => (f64::NEG_INFINITY, 0.0),
            };
            let columns = &self.d.generated.instance.columns;
            if (columns.lower[y], columns.upper[y]) != bounds {
                self.c
                    .differ(format!("the sign of the multiplier of {name:?}"));
            }
            for (j, v) in self.p.matrix.row(i).filter(|t| t.1 != 0.0) {
                transposed[j].push((y, v));
            }
        }
        transposed
    }

    /// The gradient of a quadratic objective stands on the right side, at the point of the dual.
    fn slopes(&mut self, transposed: &mut [Vec<(usize, f64)>]) {
        let point = |j: usize| {
            let symbol = self.primal.generated.origin.columns.of(j as u32).symbol;
            self.multiplier(Origin::Point(symbol), &self.columns[j].1)
        };
        let points: Vec<Option<usize>> = match self.f0.hessian.is_empty() {
            true => Vec::new(),
            false => (0..self.columns.len()).map(point).collect(),
        };
        let mut slopes: FxHashMap<(usize, usize), f64> = FxHashMap::default();
        for &(j, k, v) in &self.f0.hessian {
            match (points[j], points[k]) {
                (Some(a), Some(b)) => {
                    transposed[j].push((b, -v));
                    slopes.insert((a, b), -v);
                }
                _ => self.c.differ(format!(
                    "the point of {:?} is not in the dual",
                    self.columns[k]
                )),
            }
        }
        for &(a, b, v) in &self.d0.hessian {
            let want = slopes.remove(&(a, b)).unwrap_or(0.0);
            let (a, b) = (&self.d.columns[a], &self.d.columns[b]);
            self.c.number(want, v, &|| {
                format!("{a:?} and {b:?} in the dual objective")
            });
        }
        if !slopes.is_empty() {
            self.c
                .differ("the dual objective lacks quadratic terms".into());
        }
    }

    /// The columns of the primal are rows of the dual.
    fn columns(
        &mut self,
        symbols: &Symbols,
        f: &Formulation,
        defining: Option<usize>,
        mut transposed: Vec<Vec<(usize, f64)>>,
    ) {
        let own = |v| match v {
            Variable::Own(s) => Some(symbols.get(s).name.to_lowercase()),
            Variable::Multiplier(_) => None,
        };
        let pairs = f.rows.iter();
        let pairs = pairs.filter_map(|r| Some((r.name.to_lowercase(), own(r.pair?)?)));
        let pairs: FxHashMap<String, String> = pairs.collect();
        let mut row_of: FxHashMap<Record, usize> = FxHashMap::default();
        for (i, (name, key)) in self.d.rows.iter().enumerate() {
            let column = pairs.get(name).map(|c| (c.clone(), key.clone()));
            if let Some(column) = column
                && row_of.insert(column, i).is_some()
            {
                self.c
                    .differ(format!("two rows of the dual belong to {key:?} of {name}"));
            }
        }
        for (j, want) in transposed.iter_mut().enumerate() {
            if self.gone.is_none_or(|g| g.1 != j) {
                let row = row_of.remove(&self.columns[j]);
                self.column(j, row, std::mem::take(want));
            }
        }
        let unpaired =
            |(i, r): &(usize, &Record)| !pairs.contains_key(&r.0) && Some(*i) != defining;
        let others = self.d.rows.iter().enumerate().filter(unpaired).map(|r| r.0);
        for i in row_of.into_values().chain(others) {
            let name = &self.d.rows[i];
            self.c
                .differ(format!("the row {name:?} of the dual belongs to no column"));
        }
    }

    /// A column of the primal with its row in the dual, whose entries are to be `want` and the multipliers of bounds.
    fn column(&mut self, j: usize, row: Option<usize>, mut want: Vec<(usize, f64)>) {
        let name = &self.columns[j];
        let symbol = self.primal.generated.origin.columns.of(j as u32).symbol;
        let [lower, upper, fixed] = [
            Origin::Lower(symbol),
            Origin::Upper(symbol),
            Origin::Fixed(symbol),
        ]
        .map(|o| self.multiplier(o, &name.1));
        want.extend(
            [lower, upper, fixed]
                .into_iter()
                .flatten()
                .map(|y| (y, 1.0)),
        );
        let c = &mut self.c;
        let Some(i) = row else {
            // Without a multiplier it is a row of numbers, which holds, or the dual could not be generated.
            if !want.is_empty() {
                c.differ(format!("the column {name:?} has no row in the dual"));
            }
            return;
        };
        let dual = &self.d.generated.instance;
        let mut have: FxHashMap<usize, f64> = dual.matrix.row(i).filter(|t| t.1 != 0.0).collect();
        let entry = |c: &mut Comparison, y: usize, v: f64, w: f64| {
            let columns = &self.d.columns;
            c.number(v, w, &|| format!("{:?} in the row of {name:?}", columns[y]));
        };
        for (y, v) in want {
            c.entries += 1;
            entry(c, y, v, have.remove(&y).unwrap_or(0.0));
        }
        for (y, w) in have {
            entry(c, y, 0.0, w);
        }
        c.number(self.f0.gradient[j], dual.rows.rhs[i], &|| {
            format!("the cost of {name:?}")
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
            c.number(lo, worth[y], &|| format!("the value of {name:?}"));
        } else {
            let sides = [
                (lo, lower, said_lower, "lower"),
                (up, upper, said_upper, "upper"),
            ];
            for (b, y, said, what) in sides {
                let words = || format!("the {what} bound of {name:?}");
                match y {
                    Some(y) => c.number(b, worth[y], &words),
                    None if said => c.number(b, 0.0, &words),
                    None if b.is_finite() => c.differ(format!("{} is not in the dual", words())),
                    None => {}
                }
            }
        }
        if said_lower && lo < 0.0 || said_upper && up > 0.0 {
            c.differ(format!("the relation of the row of {name:?}"));
        }
    }
}
