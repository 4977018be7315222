//! The proof that a derivation is right: the derived model is generated, and its matrix compared entry by entry with that
//! of the primal.

use super::convex::{Objective, at_origin};
use super::derive::Primal;
use super::{Formulation, Origin, Sign};
use crate::autodiff::Evaluator;
use crate::check::node::SymbolId;
use crate::check::symbols::{Store, Symbols};
use crate::data::universe::Label;
use crate::host::{Host, HostError};
use crate::model::instance::{Relation, Sense};
use crate::model::origin::Blocks;
use crate::run::{Generated, Options, StudyChoice};
use crate::session;
use crate::solve::random::Random;
use crate::source::PreprocessOptions;
use rustc_hash::FxHashMap;
use std::path::{Path, PathBuf};

/// How far two numbers may be apart, relative to the larger.
pub const TOLERANCE: f64 = 1e-10;

/// What a comparison found.
#[derive(Clone, Debug, Default)]
pub struct Comparison {
    /// Entries that were compared.
    pub entries: usize,
    /// Right sides, costs and bounds that were compared.
    pub numbers: usize,
    /// What differs, in words; the first few.
    pub differences: Vec<String>,
    /// How much differs.
    pub count: usize,
    /// The largest relative difference.
    pub largest: f64,
}

impl Comparison {
    /// Whether all is equal.
    pub fn passed(&self) -> bool {
        self.count == 0
    }

    /// There is nothing to compare, and why.
    pub fn impossible(why: &str) -> Self {
        let mut c = Self::default();
        c.differ(format!("the derived model could not be generated: {why}"));
        c
    }

    /// Notes a difference.
    pub fn differ(&mut self, what: String) {
        self.count += 1;
        if self.differences.len() < 5 {
            self.differences.push(what);
        }
    }

    /// Compares two numbers.
    pub fn number(&mut self, a: f64, b: f64, what: &dyn Fn() -> String) {
        self.numbers += 1;
        if a == b {
            return;
        }
        let off = (a - b).abs() / a.abs().max(b.abs()).max(1.0);
        self.largest = self.largest.max(off);
        if off > TOLERANCE || off.is_nan() {
            self.differ(format!("{}: {a} and {b}", what()));
        }
    }
}

/// A text that is the only file there is.
struct Text<'a> {
    text: &'a str,
}

impl Host for Text<'_> {
    fn read(&mut self, path: &str, _: Option<&Path>) -> Result<(PathBuf, String), HostError> {
        match path {
            "derived.blk" => Ok((path.into(), self.text.to_string())),
            _ => Err(HostError::NotFound),
        }
    }
    fn exists(&mut self, _: &str, _: Option<&Path>) -> bool {
        false
    }
    fn write(&mut self, path: &str, _: &[u8]) -> Result<PathBuf, HostError> {
        Err(HostError::Outside(path.into()))
    }
    fn print(&mut self, _: &str) {}
    fn elapsed(&self) -> f64 {
        0.0
    }
    fn now(&self) -> f64 {
        0.0
    }
    fn interrupted(&self) -> bool {
        false
    }
}

/// A record's name and labels as words, in lower case.
pub type Record = (String, Vec<String>);

/// The instance of a derived model with the names of its rows and columns as words.
pub struct Instance {
    /// The instance.
    pub generated: Generated,
    /// Names of rows.
    pub rows: Vec<Record>,
    /// Names of columns.
    pub columns: Vec<Record>,
}

impl Instance {
    /// Numbers of columns by name.
    pub fn columns_by_name(&self) -> FxHashMap<&Record, usize> {
        self.columns
            .iter()
            .enumerate()
            .map(|(j, r)| (r, j))
            .collect()
    }

    /// Numbers of rows by name.
    pub fn rows_by_name(&self) -> FxHashMap<&Record, usize> {
        self.rows.iter().enumerate().map(|(i, r)| (r, i)).collect()
    }
}

/// Names of all rows or columns as words.
pub fn records(symbols: &Symbols, store: &Store, blocks: &Blocks) -> Vec<Record> {
    let mut out = Vec::new();
    for b in &blocks.list {
        let name = symbols.get(b.symbol).name.to_lowercase();
        out.extend((b.start..b.start + b.len).map(|i| (name.clone(), words(store, b.key(i)))));
    }
    out
}

fn words(store: &Store, key: &[Label]) -> Vec<String> {
    key.iter()
        .map(|l| store.universe.name(*l).to_lowercase())
        .collect()
}

/// Generates the last model that a text solves; the first complaint where it cannot be.
pub fn generate(text: &str) -> Result<Instance, String> {
    let mut host = Text { text };
    let options = Options {
        quiet: true,
        collect: false,
        study: Some(StudyChoice {
            generate_only: true,
            ..StudyChoice::default()
        }),
        ..Options::default()
    };
    let preprocess = PreprocessOptions {
        slash_comments: true,
        ..PreprocessOptions::default()
    };
    let mut found = None;
    let finished = session::run(
        &mut host,
        "derived.blk",
        preprocess,
        options,
        false,
        &mut |m| {
            if let Some((_, Some(g))) = m.take_study() {
                found = Some(Instance {
                    rows: records(&m.symbols, &m.store, &g.origin.rows),
                    columns: records(&m.symbols, &m.store, &g.origin.columns),
                    generated: g,
                });
            }
        },
    );
    found.ok_or_else(|| {
        let first = finished.diagnostics.iter().find(|d| d.code != "W");
        let place = |d: &crate::diag::Diagnostic| {
            let line = finished.map.line(d.span);
            let text = text.lines().nth(line.saturating_sub(1)).unwrap_or_default();
            format!("{} (line {line}: {})", d.message, text.trim())
        };
        first.map_or_else(|| "nothing is solved".to_string(), place)
    })
}

/// Compares the generated dual with the transposed primal: matrix, right sides, costs, bounds and relations.
pub fn dual(
    symbols: &Symbols,
    store: &Store,
    primal: &Primal,
    f: &Formulation,
    d: &Instance,
) -> Comparison {
    let mut c = Comparison::default();
    let g = &primal.generated;
    let p = &g.instance;
    let minimum = p.objective.is_none_or(|o| o.sense == Sense::Minimize);
    let (p_rows, p_columns) = (
        records(symbols, store, &g.origin.rows),
        records(symbols, store, &g.origin.columns),
    );
    // What the objective's variable and its row are.
    let z = p.objective.map(|o| o.column as usize);
    let gone = eliminated(primal, f, z);
    let f0 = match (gone, z) {
        (Some(i), Some(z)) => at_origin(p, &mut Evaluator::new(p), i, z).unwrap_or_default(),
        (_, z) => {
            let mut gradient = vec![0.0; p.column_count()];
            z.into_iter().for_each(|z| gradient[z] = 1.0);
            Objective {
                gradient,
                ..Objective::default()
            }
        }
    };
    let (cost, constant) = (&f0.gradient, f0.constant);
    // Where the multipliers of the rows and bounds are in the dual.
    let columns = d.columns_by_name();
    let dual = &d.generated.instance;
    let flip = if f.flipped { -1.0 } else { 1.0 };
    let named = |origin: &dyn Fn(Origin) -> bool| {
        let m = f.multipliers.iter().find(|m| origin(m.origin));
        m.map(|m| m.name.to_lowercase())
    };
    let objective_column = columns
        .get(&(f.objective_name.to_lowercase(), Vec::new()))
        .copied();
    let objective_row = (f.objective_name.to_lowercase() + "_row", Vec::new());
    let rows = d.rows_by_name();
    let d0 = match (rows.get(&objective_row), objective_column) {
        (Some(&i), Some(z)) => at_origin(dual, &mut Evaluator::new(dual), i, z),
        _ => None,
    };
    let Some(d0) = d0 else {
        c.differ("the dual has no objective".into());
        return c;
    };
    let (dual_cost, dual_constant) = (&d0.gradient, d0.constant);
    c.number(constant, dual_constant, &|| {
        "the constant of the objective".into()
    });
    // Rows of the primal.
    let mut of_row: Vec<Option<usize>> = vec![None; p.row_count()];
    for b in &g.origin.rows.list {
        let name = named(&|o| o == Origin::Row(b.symbol));
        for i in b.start as usize..(b.start + b.len) as usize {
            if Some(i) == gone {
                continue;
            }
            let (relation, rhs) = (p.rows.relation[i], p.rows.rhs[i]);
            if relation == Relation::Free {
                continue;
            }
            let Some(name) = &name else {
                if relation != Relation::Free {
                    c.differ(format!("no multiplier of {:?}", p_rows[i]));
                }
                continue;
            };
            let key = (name.clone(), p_rows[i].1.clone());
            let Some(&j) = columns.get(&key) else {
                // A row that holds nothing but an eliminated variable, or no number but zeros.
                let only = p
                    .matrix
                    .row(i)
                    .all(|(k, v)| v == 0.0 || Some(k) == z && gone.is_some());
                if !only || rhs != 0.0 {
                    c.differ(format!("the multiplier of {key:?} is not in the dual"));
                }
                continue;
            };
            of_row[i] = Some(j);
            c.number(rhs * flip, dual_cost[j], &|| {
                format!("the right side of {:?}", p_rows[i])
            });
            let sign = match (relation, minimum, flip == 1.0) {
                (Relation::Equal, ..) => Sign::Free,
                (Relation::Greater, true, true) | (Relation::Less, false, true) => Sign::Positive,
                (Relation::Less, true, false) | (Relation::Greater, false, false) => Sign::Positive,
                _ => Sign::Negative,
            };
            let bounds = match sign {
                Sign::Free => (f64::NEG_INFINITY, f64::INFINITY),
                Sign::Positive => (0.0, f64::INFINITY),
                Sign::Negative => (f64::NEG_INFINITY, 0.0),
            };
            if (dual.columns.lower[j], dual.columns.upper[j]) != bounds
                && relation != Relation::Free
            {
                c.differ(format!("the sign of the multiplier of {:?}", p_rows[i]));
            }
        }
    }
    // The transposed matrix by columns of the primal.
    let mut transposed: Vec<Vec<(usize, f64)>> = vec![Vec::new(); p.column_count()];
    for (i, multiplier) in of_row.iter().enumerate() {
        for (j, v) in p.matrix.row(i) {
            if let (Some(y), true) = (*multiplier, v != 0.0) {
                transposed[j].push((y, v * flip));
            }
        }
    }
    // The gradient of a quadratic objective stands on the right side, at the point of the dual.
    let point = |j: usize| {
        let symbol = g.origin.columns.of(j as u32).symbol;
        let name = named(&|o| o == Origin::Point(symbol))?;
        columns.get(&(name, p_columns[j].1.clone())).copied()
    };
    let mut slopes: FxHashMap<(usize, usize), f64> = FxHashMap::default();
    for &(j, k, v) in &f0.hessian {
        match (point(j), point(k)) {
            (Some(a), Some(b)) => {
                transposed[j].push((b, -v));
                slopes.insert((a, b), -v);
            }
            _ => c.differ(format!(
                "the point of {:?} is not in the dual",
                p_columns[k]
            )),
        }
    }
    for &(a, b, v) in &d0.hessian {
        let want = slopes.remove(&(a, b)).unwrap_or(0.0);
        c.number(want, v, &|| {
            format!(
                "{:?} and {:?} in the dual objective",
                d.columns[a], d.columns[b]
            )
        });
    }
    if !slopes.is_empty() {
        c.differ("the dual objective lacks quadratic terms".into());
    }
    let blocks: FxHashMap<String, SymbolId> = f
        .rows
        .iter()
        .filter_map(|r| match r.pair? {
            super::tree::Variable::Own(s) => Some((r.name.to_lowercase(), s)),
            super::tree::Variable::Multiplier(_) => None,
        })
        .collect();
    let mut row_of: FxHashMap<Record, usize> = FxHashMap::default();
    for (i, (name, key)) in d.rows.iter().enumerate() {
        if let Some(s) = blocks.get(name) {
            let column = (symbols.get(*s).name.to_lowercase(), key.clone());
            if row_of.insert(column, i).is_some() {
                c.differ(format!(
                    "two rows of the dual belong to the column {key:?} of {name}"
                ));
            }
        }
    }
    let mut used = vec![false; dual.row_count()];
    for j in 0..p.column_count() {
        if Some(j) == z && gone.is_some() {
            continue;
        }
        let name = &p_columns[j];
        let (lo, up) = (p.columns.lower[j], p.columns.upper[j]);
        let symbol = g.origin.columns.of(j as u32).symbol;
        let bound = |origin: &dyn Fn(Origin) -> bool| {
            let m = named(origin)?;
            columns.get(&(m, name.1.clone())).copied()
        };
        let by_lower = bound(&|o| o == Origin::Lower(symbol));
        let by_upper = bound(&|o| o == Origin::Upper(symbol));
        let fixed = bound(&|o| o == Origin::Fixed(symbol));
        let Some(&i) = row_of.get(name) else {
            // Without a multiplier it is a row of numbers, which holds, or the dual could not be generated.
            let bounded = [by_lower, by_upper, fixed].iter().any(Option::is_some);
            if !transposed[j].is_empty() || bounded {
                c.differ(format!("the column {name:?} has no row in the dual"));
            }
            continue;
        };
        used[i] = true;
        let mut want = std::mem::take(&mut transposed[j]);
        want.extend(
            [by_lower, by_upper, fixed]
                .into_iter()
                .flatten()
                .map(|y| (y, flip)),
        );
        want.sort_by_key(|t| t.0);
        let mut have: Vec<(usize, f64)> = dual.matrix.row(i).filter(|t| t.1 != 0.0).collect();
        have.sort_by_key(|t| t.0);
        let mut have = have.into_iter().peekable();
        for (y, v) in want {
            c.entries += 1;
            while let Some((k, w)) = have.next_if(|t| t.0 < y) {
                c.number(0.0, w, &|| {
                    format!("{:?} in the row of {name:?}", d.columns[k])
                });
            }
            let w = have.next_if(|t| t.0 == y).map_or(0.0, |t| t.1);
            c.number(v, w, &|| {
                format!("{:?} in the row of {name:?}", d.columns[y])
            });
        }
        for (k, w) in have {
            c.number(0.0, w, &|| {
                format!("{:?} in the row of {name:?}", d.columns[k])
            });
        }
        c.number(cost[j], dual.rows.rhs[i], &|| {
            format!("the cost of {name:?}")
        });
        // The relation says what the multipliers of bounds do not.
        let relation = dual.rows.relation[i];
        let (said_lower, said_upper) = match (relation, minimum) {
            (Relation::Equal, _) => (false, false),
            (Relation::Less, true) | (Relation::Greater, false) => (true, false),
            _ => (false, true),
        };
        match fixed {
            Some(y) => c.number(lo * flip, dual_cost[y], &|| {
                format!("the value of {name:?}")
            }),
            None => {
                let mut side = |b: f64, y: Option<usize>, said: bool, what: &str| match y {
                    Some(y) => c.number(b * flip, dual_cost[y], &|| {
                        format!("the {what} of {name:?}")
                    }),
                    None if said => c.number(b, 0.0, &|| format!("the {what} of {name:?}")),
                    None if b.is_finite() => {
                        c.differ(format!("the {what} of {name:?} is not in the dual"))
                    }
                    None => {}
                };
                side(lo, by_lower, said_lower, "lower bound");
                side(up, by_upper, said_upper, "upper bound");
            }
        }
        if said_lower && lo < 0.0 || said_upper && up > 0.0 {
            c.differ(format!("the relation of the row of {name:?}"));
        }
    }
    for (i, used) in used.iter().enumerate() {
        if !used && rows.get(&objective_row) != Some(&i) {
            c.differ(format!(
                "the row {:?} of the dual belongs to no column",
                d.rows[i]
            ));
        }
    }
    c
}

/// The row that defined the objective, where the derivation eliminated it.
fn eliminated(primal: &Primal, f: &Formulation, z: Option<usize>) -> Option<usize> {
    let z = z?;
    let symbol = primal.generated.origin.columns.of(z as u32).symbol;
    let stays = f
        .rows
        .iter()
        .any(|r| r.pair == Some(super::tree::Variable::Own(symbol)));
    if stays {
        return None;
    }
    let p = &primal.generated.instance;
    (0..p.row_count()).find(|&i| p.matrix.row(i).any(|(j, v)| j == z && v != 0.0))
}

/// Compares the generated optimality conditions with `∇f − Jᵀλ` of the model's automatic derivatives, and its rows with the
/// model's, at points around the answer drawn at random.
pub fn kkt(
    symbols: &Symbols,
    store: &Store,
    primal: &Primal,
    f: &Formulation,
    d: &Instance,
    points: usize,
) -> Comparison {
    let mut c = Comparison::default();
    let mut places = Places::new(symbols, store, primal, f, d);
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
        let x = places.point(primal, size, &mut random);
        let y: Vec<f64> = (0..primal.generated.instance.row_count())
            .map(|_| random())
            .collect();
        if places.compare(&x, &y, &mut c).is_ok() {
            evaluated += 1;
        }
    }
    if evaluated == 0 {
        c.differ("no point was found at which all functions have a value".into());
    }
    c
}

/// Where the rows and columns of a model are in its optimality conditions.
struct Places<'a> {
    primal: &'a crate::model::instance::Instance,
    derived: &'a crate::model::instance::Instance,
    sign: f64,
    objective: Aim,
    /// By column of the model: its column and its row.
    columns: Vec<Option<(usize, Option<usize>)>>,
    /// By row of the model: its multiplier and its row.
    rows: Vec<Option<(usize, usize)>>,
    names: Vec<Record>,
    missing: Option<String>,
    of_primal: Evaluator,
    of_derived: Evaluator,
}

/// What the objective is: a row whose variable was eliminated, or a column.
enum Aim {
    Row(usize, usize),
    Column(usize),
}

impl<'a> Places<'a> {
    fn new(
        symbols: &Symbols,
        store: &Store,
        primal: &'a Primal,
        f: &Formulation,
        d: &'a Instance,
    ) -> Self {
        let g = &primal.generated;
        let p = &g.instance;
        let z = p.objective.map_or(0, |o| o.column as usize);
        let gone = eliminated(primal, f, Some(z));
        let (row_names, column_names) = (
            records(symbols, store, &g.origin.rows),
            records(symbols, store, &g.origin.columns),
        );
        let by_column = d.columns_by_name();
        let by_row = d.rows_by_name();
        let mut missing = None;
        let row_of = |v: super::tree::Variable| {
            let r = f.rows.iter().find(|r| r.pair == Some(v));
            r.map(|r| r.name.to_lowercase())
        };
        let mut columns = vec![None; p.column_count()];
        for b in &g.origin.columns.list {
            let row = row_of(super::tree::Variable::Own(b.symbol));
            for j in b.start as usize..(b.start + b.len) as usize {
                if gone.is_some() && j == z {
                    continue;
                }
                let Some(&at) = by_column.get(&column_names[j]) else {
                    missing = Some(format!(
                        "the column {:?} is not in the conditions",
                        column_names[j]
                    ));
                    continue;
                };
                let row = row
                    .as_ref()
                    .and_then(|r| by_row.get(&(r.clone(), column_names[j].1.clone())).copied());
                if row.is_none() && p.columns.lower[j] < p.columns.upper[j] {
                    missing = Some(format!("the column {:?} has no row", column_names[j]));
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
            let row = row_of(super::tree::Variable::Multiplier(n)).unwrap_or_default();
            for i in b.start as usize..(b.start + b.len) as usize {
                let key = &row_names[i].1;
                let column = by_column.get(&(m.name.to_lowercase(), key.clone()));
                let own = by_row.get(&(row.clone(), key.clone()));
                match (column, own) {
                    (Some(&y), Some(&r)) => rows[i] = Some((y, r)),
                    _ if p.rows.relation[i] == Relation::Free => {}
                    _ => {
                        missing = Some(format!(
                            "the row {:?} is not in the conditions",
                            row_names[i]
                        ))
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
            names: column_names,
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
        let (start, column) = self.of_primal.jacobian_pattern();
        let (start, column) = (start.to_vec(), column.to_vec());
        let mut values = vec![0.0; column.len()];
        self.of_primal.jacobian(x, &mut values).map_err(|_| ())?;
        if have.iter().chain(&values).any(|v| !v.is_finite()) {
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
                let r = start[i]..start[i + 1];
                let a = r
                    .clone()
                    .find(|&k| column[k] as usize == z)
                    .map_or(1.0, |k| values[k]);
                r.for_each(|k| add(column[k] as usize, -values[k] / a));
            }
        }
        for (i, place) in self.rows.iter().enumerate() {
            if place.is_some() {
                for k in start[i]..start[i + 1] {
                    add(column[k] as usize, -y[i] * values[k]);
                }
            }
        }
        for (j, place) in self.columns.iter().enumerate() {
            if let Some((_, Some(r))) = place {
                c.entries += 1;
                let value = have[*r] - self.derived.rows.rhs[*r];
                let (a, b) = (self.sign * want[j] / scale[j], value / scale[j]);
                c.number(a, b, &|| format!("stationarity of {:?}", self.names[j]));
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

/// The dual of a model as it is written, and the comparison of its matrix with the model's. `Err` says why there is none.
pub fn checked_dual(
    symbols: &Symbols,
    store: &Store,
    primal: &Primal,
) -> Result<(Formulation, Comparison), String> {
    let f = super::dual::dual(symbols, store, primal, false)?;
    let d = generate(&super::text::model(symbols, store, &f, None, "", true))?;
    let c = dual(symbols, store, primal, &f, &d);
    Ok((f, c))
}

/// The optimality conditions of a model as they are written, and the comparison of their rows with automatic derivatives at
/// points drawn at random. `Err` says why there are none.
pub fn checked_kkt(
    symbols: &Symbols,
    store: &Store,
    primal: &Primal,
) -> Result<(Formulation, Comparison), String> {
    let derived = |keep| -> Result<(Formulation, Instance), String> {
        let f = super::kkt::kkt(symbols, store, primal, keep, false).map_err(|(_, why)| why)?;
        let text = super::text::model(symbols, store, &f, None, "", true);
        generate(&text).map(|d| (f, d))
    };
    let (f, d) = derived(false).or_else(|why| derived(true).map_err(|_| why))?;
    let c = kkt(symbols, store, primal, &f, &d, POINTS);
    Ok((f, c))
}

/// Points at which optimality conditions are compared.
pub const POINTS: usize = 3;
