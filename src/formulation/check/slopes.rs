//! Optimality conditions against the automatic derivatives of the model they come from.

use super::{Comparison, Instance, eliminated};
use crate::autodiff::Evaluator;
use crate::formulation::derive::Primal;
use crate::formulation::tree::Variable;
use crate::formulation::{Formulation, Origin, Scope};
use crate::model::instance::{self, Relation, Sense};
use crate::model::origin::Block;
use crate::solve::random::Random;

/// Compares the generated optimality conditions with `∇f − Jᵀλ` of the model's automatic derivatives, and its rows with the
/// model's, at points around the answer drawn at random.
pub(super) fn kkt(
    scope: Scope,
    primal: &Primal,
    f: &Formulation,
    d: &Instance,
    points: usize,
) -> Comparison {
    let mut c = Comparison::default();
    let mut places = Places::new(scope, primal, f, d);
    if let Some(missing) = places.missing.take() {
        c.differ(missing);
        return c;
    }
    let mut stream = Random(1);
    let mut random = move || stream.uniform() * 2.0 - 1.0;
    let mut evaluated = 0;
    for attempt in 0..points * 8 {
        if evaluated == points {
            break;
        }
        // Farther from the answer at first, nearer where functions have no value there.
        let size = 0.5 / (1 << (attempt / points).min(20)) as f64;
        // Also all up or all down: a base that is to be positive may be 0 at the answer.
        let x = places.point(primal, size, &mut || match attempt % 3 {
            0 => random(),
            1 => random().abs(),
            _ => -random().abs(),
        });
        let y: Vec<f64> = (0..primal.generated.instance.row_count())
            .map(|_| random())
            .collect();
        if places.compare(&x, &y, &mut c).is_ok() {
            evaluated += 1;
        }
    }
    if evaluated == 0 {
        return Comparison::impossible("no point was found at which all functions have a value");
    }
    c
}

/// Where the rows and columns of a model are in its optimality conditions.
struct Places<'a> {
    primal: &'a instance::Instance,
    derived: &'a instance::Instance,
    sign: f64,
    objective: Aim,
    /// By column of the model: its column and its row.
    columns: Vec<Option<(usize, Option<usize>)>>,
    /// By row of the model: its multiplier and its row.
    rows: Vec<Option<(usize, usize)>>,
    missing: Option<String>,
    of_primal: Evaluator,
    of_derived: Evaluator,
}

/// What the objective is: a row whose variable was eliminated, or a column.
enum Aim {
    Row(usize, usize),
    Column(usize),
}

/// By column: whether it stands in a row that asks for anything. No condition is about the others.
fn constrained(p: &instance::Instance) -> Vec<bool> {
    let mut out = vec![false; p.column_count()];
    let asks = |i: usize| p.rows.relation[i] != Relation::Free;
    for i in (0..p.row_count()).filter(|&i| asks(i)) {
        p.matrix.row(i).for_each(|(j, _)| out[j] = true);
    }
    for k in &p.nonlinear {
        let terms = k.columns.chunks(k.kernel.variables.max(1) as usize);
        for (columns, _) in terms.zip(&k.row).filter(|(_, r)| asks(**r as usize)) {
            columns.iter().for_each(|&j| out[j as usize] = true);
        }
    }
    out
}

impl<'a> Places<'a> {
    fn new(scope: Scope, primal: &'a Primal, f: &Formulation, d: &'a Instance) -> Self {
        let g = &primal.generated;
        let p = &g.instance;
        let z = p.objective.map_or(0, |o| o.column as usize);
        let gone = eliminated(primal, f, Some(z));
        let mut missing = None;
        let row_of = |v: Variable| {
            let r = f.rows.iter().find(|r| r.pair == Some(v));
            r.and_then(|r| d.rows(&r.name))
        };
        let find = |b: Option<&Block>, key| b.and_then(|b| d.find(b, key));
        let mut columns = vec![None; p.column_count()];
        let matters = constrained(p);
        for b in &g.origin.columns.list {
            let row = row_of(Variable::Own(b.symbol));
            let own = d.columns(&scope.get(b.symbol).name);
            for k in b.start..b.start + b.len {
                let j = k as usize;
                if gone.is_some() && j == z {
                    continue;
                }
                let name = || scope.called(&g.origin.columns, j);
                let key = b.key(k);
                let Some(at) = find(own, key) else {
                    if matters[j] {
                        missing = Some(format!("the column {} is not in the conditions", name()));
                    }
                    continue;
                };
                let row = find(row, key);
                if row.is_none() && p.columns.lower[j] < p.columns.upper[j] {
                    missing = Some(format!("the column {} has no row", name()));
                }
                columns[j] = Some((at, row));
            }
        }
        let mut rows = vec![None; p.row_count()];
        for (n, m) in f.multipliers.iter().enumerate() {
            let Origin::Row(e) = m.origin else { continue };
            let Some(b) = g.origin.rows.symbol(e) else {
                continue;
            };
            let (multiplier, row) = (d.columns(&m.name), row_of(Variable::Multiplier(n)));
            for k in b.start..b.start + b.len {
                let (i, key) = (k as usize, b.key(k));
                match (find(multiplier, key), find(row, key)) {
                    (Some(y), Some(r)) => rows[i] = Some((y, r)),
                    _ if p.rows.relation[i] == Relation::Free => {}
                    _ => {
                        let name = scope.called(&g.origin.rows, i);
                        missing = Some(format!("the row {name} is not in the conditions"));
                    }
                }
            }
        }
        let minimum = p.objective.is_none_or(|o| o.sense == Sense::Minimize);
        Self {
            primal: p,
            derived: &d.generated.instance,
            sign: if minimum { 1.0 } else { -1.0 },
            objective: gone.map_or(Aim::Column(z), |i| Aim::Row(i, z)),
            columns,
            rows,
            missing,
            of_primal: Evaluator::new(p),
            of_derived: Evaluator::new(&d.generated.instance),
        }
    }

    /// A point of the model between its bounds, near the answer.
    fn point(&self, primal: &Primal, size: f64, random: &mut dyn FnMut() -> f64) -> Vec<f64> {
        let c = &self.primal.columns;
        let level = |j: usize| match &primal.answer {
            Some(a) => a.level[j],
            None => c.level[j],
        };
        (0..self.primal.column_count())
            .map(|j| {
                let x = level(j);
                let (lo, up) = (c.lower[j], c.upper[j]);
                let step = size * (1.0 + x.abs()) * random();
                let moved = x + step;
                // Inside the bounds, where functions such as logarithms have values.
                match () {
                    () if moved < lo => (lo + step.abs()).min(up),
                    () if moved > up => (up - step.abs()).max(lo),
                    () => moved,
                }
            })
            .collect()
    }

    fn compare(&mut self, x: &[f64], y: &[f64], c: &mut Comparison) -> Result<(), ()> {
        let mut at = vec![0.0; self.derived.column_count()];
        for (j, place) in self.columns.iter().enumerate() {
            if let Some((k, _)) = place {
                at[*k] = x[j];
            }
        }
        for (i, place) in self.rows.iter().enumerate() {
            if let Some((k, _)) = place {
                at[*k] = y[i];
            }
        }
        let mut have = vec![0.0; self.derived.row_count()];
        self.of_derived.rows(&at, &mut have).map_err(|_| ())?;
        let mut activity = vec![0.0; self.primal.row_count()];
        self.of_primal.rows(x, &mut activity).map_err(|_| ())?;
        let slope = self.of_primal.jacobian_rows(x).map_err(|_| ())?;
        let values = slope.iter().flatten().map(|(_, v)| v);
        if have.iter().chain(values).any(|v| !v.is_finite()) {
            return Err(());
        }
        let n = self.primal.column_count();
        let (mut want, mut scale) = (vec![0.0; n], vec![1.0; n]);
        let mut add = |j: usize, v: f64| {
            want[j] += v;
            scale[j] += v.abs();
        };
        match self.objective {
            Aim::Column(z) => add(z, 1.0),
            Aim::Row(i, z) => {
                let a = slope[i].iter().find(|(j, _)| *j == z);
                let a = a.map_or(1.0, |(_, v)| *v);
                slope[i].iter().for_each(|(j, v)| add(*j, -v / a));
            }
        }
        for (i, row) in slope.iter().enumerate() {
            if self.rows[i].is_some() {
                row.iter().for_each(|(j, v)| add(*j, -y[i] * v));
            }
        }
        for (j, place) in self.columns.iter().enumerate() {
            if let Some((_, Some(r))) = place {
                c.entries += 1;
                let value = have[*r] - self.derived.rows.rhs[*r];
                let (a, b) = (self.sign * want[j] / scale[j], value / scale[j]);
                c.number(a, b, &|| format!("stationarity of column {j}"));
            }
        }
        for (i, place) in self.rows.iter().enumerate() {
            if let Some((_, r)) = place {
                let want = self.sign * (activity[i] - self.primal.rows.rhs[i]);
                let value = have[*r] - self.derived.rows.rhs[*r];
                let size = 1.0 + activity[i].abs();
                c.number(want / size, value / size, &|| format!("the row {i}"));
            }
        }
        Ok(())
    }
}
