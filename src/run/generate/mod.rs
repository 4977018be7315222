//! From equations and data to an instance.
//!
//! Each equation block runs over its domain; each row is walked once, its linear terms going into
//! one compressed matrix and its nonlinear terms into kernels (one per shape, found by hashing the
//! program). Columns are numbered as they appear and put into label order at the end.
//!
//! As in GAMS: zero coefficients make no nonzero and no column; a row whose terms cancel is dropped
//! (an error if it then cannot hold); fixed columns stay unless `holdfixed`.

mod finish;
mod terms;

use super::plan::Wanted;
use super::scan::Scans;
use super::{Frame, Machine};
use crate::check::node::*;
use crate::check::symbols::{DomainPosition, attribute};
use crate::check::visit::Visitor;
use crate::data::key_index::{KeyIndex, LabelBox};
use crate::data::sort::sort_tuples;
use crate::data::universe::Label;
use crate::data::value::number;
use crate::diag::Diagnostic;
use crate::model::instance::*;
use crate::model::origin::{Block, Blocks, LeftOut, Origin};
use crate::report::json::Seconds;
use crate::source::Span;
use rustc_hash::{FxHashMap, FxHashSet};

/// How to generate.
#[derive(Clone, Copy, Debug, Default)]
pub struct GenerateOptions {
    /// Fixed columns become constants.
    pub hold_fixed: bool,
    /// Use `.scale`.
    pub scale: bool,
    /// Rows that are paired are kept even when empty, unless the partner is fixed.
    pub keep_paired: bool,
}

/// An instance and where it comes from.
#[derive(Debug, Default)]
pub struct Generated {
    /// The instance.
    pub instance: Instance,
    /// Names and statistics.
    pub origin: Origin,
    /// What its generation and solution took, once it is solved.
    pub seconds: Seconds,
}

impl Generated {
    /// Number of columns, without those that are held fixed.
    pub fn columns(&self) -> usize {
        self.instance.column_count() - self.origin.held_columns.len()
    }
}

/// Columns of one variable, numbered as they appear.
struct ColumnMap {
    symbol: SymbolId,
    dim: usize,
    keys: Vec<Label>,
    /// Provisional number of each key.
    numbers: Vec<u32>,
    index: KeyIndex,
    /// The labels that the domain allows, where it does not allow all.
    labels: Option<LabelBox>,
}

/// A row in the making: linear terms by column, and a constant.
#[derive(Default)]
struct Row {
    terms: Vec<(u32, f64)>,
    constant: f64,
    /// The affine part of a nonlinear term. `place` belongs to the row, so such a part lists a column
    /// as often as it occurs, and is merged by sorting.
    part: bool,
}

impl Row {
    fn part() -> Self {
        Self {
            part: true,
            ..Self::default()
        }
    }
}

/// What `eps` is as a coefficient while a row is built: `eps*x` keeps `x` in the row, and counts, with
/// the coefficient 0. The size lets it vanish in sums and survive factors.
const EPS_COEFFICIENT: f64 = 1e-250;

/// A number of an instance: what `eps` has become is 0.
fn without_eps(v: f64) -> f64 {
    if v.abs() < 1e-200 { 0.0 } else { v }
}

struct Builder<'m, 'h> {
    m: &'m Machine<'h>,
    options: GenerateOptions,
    maps: Vec<ColumnMap>,
    map_of: FxHashMap<SymbolId, usize>,
    /// Sets that say which columns some variables have.
    limits: FxHashMap<SymbolId, TableId>,
    columns: u32,
    instance: Instance,
    kernels: FxHashMap<Vec<Op>, usize>,
    nonlinear_terms: usize,
    /// A constant in a nonlinear term of the row at hand is `na` or `undf`.
    not_a_number: bool,
    /// Position + 1 of a column in the row at hand.
    place: Vec<u32>,
    row: u32,
    /// Rows of pairs whose constant says that they never bind: the column is at the bound that F = ±∞ asks for.
    never_bind: Vec<u32>,
    /// Rows without variables.
    left_out: Vec<LeftOut>,
    /// Variables that are held fixed.
    held: FxHashSet<(SymbolId, Vec<Label>)>,
    failed: bool,
    span: Span,
}

impl Machine<'_> {
    /// The labels that the domain of a symbol allows; None where it allows all.
    fn label_box(&self, s: SymbolId) -> Option<LabelBox> {
        let ranges = self.symbols.get(s).domain.iter().map(|p| match p {
            DomainPosition::Set(set) => {
                let t = self.store.table(self.symbols.get(*set).table);
                let labels = || t.all_keys().iter().copied();
                (t.dim() == 1).then(|| labels().min().zip(labels().max()))?
            }
            _ => None,
        });
        LabelBox::new(ranges)
    }

    /// Generates the instance of a model; None after an execution error.
    pub fn generate(
        &mut self,
        solve: &SolveCode,
        options: GenerateOptions,
        frame: &mut Frame,
    ) -> Option<Generated> {
        let equations = self.equations.clone();
        let mut scans = Scans::default();
        for r in &solve.equations {
            let e = &equations[r.definition];
            scans.domain(&e.domain);
            scans.driving(&e.left);
            scans.driving(&e.right);
        }
        let table = |s: SymbolId| self.symbols.rooted(s).table;
        let limits: FxHashMap<SymbolId, TableId> =
            solve.limits.iter().map(|&(v, s)| (v, table(s))).collect();
        for &t in scans.tables().iter().chain(limits.values()) {
            self.store.table_mut(t).tidy();
        }
        let mut b = Builder {
            m: self,
            options,
            maps: Vec::new(),
            map_of: FxHashMap::default(),
            limits,
            columns: 0,
            instance: Instance::default(),
            kernels: FxHashMap::default(),
            nonlinear_terms: 0,
            not_a_number: false,
            place: Vec::new(),
            row: 0,
            never_bind: Vec::new(),
            left_out: Vec::new(),
            held: FxHashSet::default(),
            failed: false,
            span: Span::default(),
        };
        b.instance.matrix.start.push(0);
        if let Some((_, z)) = solve.objective {
            b.column(z, &[]);
        }
        let mut row_blocks = Blocks::default();
        for item in &solve.equations {
            // One equation may stand several times, paired with different variables.
            b.block(&equations[item.definition], item, &mut row_blocks, frame);
            if b.failed || b.m.stopped() {
                return None;
            }
        }
        let origin = b.finish(row_blocks, solve);
        let instance = b.instance;
        let failed = b.failed;
        let seconds = Seconds::default();
        (!failed && !self.stopped()).then_some(Generated {
            instance,
            origin,
            seconds,
        })
    }
}

impl Builder<'_, '_> {
    fn block(&mut self, e: &EquationDef, item: &ModelRow, blocks: &mut Blocks, frame: &mut Frame) {
        let dim = e.key.parts.len();
        let start = self.row;
        self.span = e.span;
        let mut block = Block {
            symbol: e.symbol,
            start,
            len: 0,
            dim,
            keys: Vec::new(),
        };
        // Tuples first (in label order), then rows: the order of rows is what a user sees.
        let d = e.domain.slots.len();
        let errors = self.m.execution_error_count();
        let tuples = if d == 0 {
            let plan = self.m.plan(&e.domain, Wanted::default());
            let mut any = false;
            self.m.run_plan(&e.domain, &plan, frame, &mut |_| {
                any = true;
                false
            });
            if !any && self.m.execution_error_count() == errors {
                return;
            }
            Vec::new()
        } else {
            self.m.tuples(&e.domain, &[], frame)
        };
        // Which rows there are is not known then.
        if self.m.execution_error_count() > errors {
            self.failed = true;
            return;
        }
        let slots = e.key.parts.iter().filter_map(|p| match p {
            Part::Slot(s) => Some(s),
            _ => None,
        });
        let plain = e.key.is_plain() && slots.eq(&e.domain.slots);
        let tuples = if plain || d == 0 {
            tuples
        } else {
            self.by_key(e, tuples, d, frame)
        };
        let relation = e.relation;
        let mut row = Row::default();
        for k in 0..tuples.len().checked_div(d).unwrap_or(1) {
            for (&s, &l) in e.domain.slots.iter().zip(&tuples[k * d..]) {
                frame[s as usize] = l;
            }
            let mut key = [0; 20];
            if !self.m.key(&e.key, frame, &mut key) {
                continue;
            }
            *self.m.current.borrow_mut() = Some((e.symbol, key[..dim].to_vec()));
            self.one_row(
                e,
                relation,
                item.pair,
                frame,
                &mut row,
                &key[..dim],
                &mut block,
            );
            if self.failed || !self.m.keep_going() {
                return;
            }
        }
        *self.m.current.borrow_mut() = None;
        block.len = self.row - start;
        if block.len > 0 || blocks.list.is_empty() {
            blocks.list.push(block);
        }
    }

    /// Tuples in the order of the row labels they make.
    fn by_key(
        &self,
        e: &EquationDef,
        tuples: Vec<Label>,
        d: usize,
        frame: &mut Frame,
    ) -> Vec<Label> {
        let dim = e.key.parts.len();
        let mut flat = Vec::new();
        for t in tuples.chunks_exact(d) {
            for (&s, &l) in e.domain.slots.iter().zip(t) {
                frame[s as usize] = l;
            }
            let mut key = [0; 20];
            if self.m.key(&e.key, frame, &mut key) {
                flat.extend_from_slice(&key[..dim]);
                flat.extend_from_slice(t);
            }
        }
        let sorted = sort_tuples(flat, dim + d, false);
        sorted
            .chunks_exact(dim + d)
            .flat_map(|k| k[dim..].iter().copied())
            .collect()
    }

    #[allow(clippy::too_many_arguments)]
    fn one_row(
        &mut self,
        e: &EquationDef,
        relation: Relation,
        pair: Option<SymbolId>,
        frame: &mut Frame,
        row: &mut Row,
        key: &[Label],
        block: &mut Block,
    ) {
        row.terms.clear();
        row.constant = 0.0;
        let errors = self.m.execution_error_count();
        let nonlinear_before = self.nonlinear_terms;
        self.emit(&e.left, 1.0, frame, row);
        self.emit(&e.right, -1.0, frame, row);
        if self.m.execution_error_count() > errors {
            self.failed = true;
            return;
        }
        let nonlinear = self.nonlinear_terms > nonlinear_before;
        for &(c, _) in &row.terms {
            self.place[c as usize] = 0;
        }
        let rhs = without_eps(0.0 - row.constant);
        let empty = !nonlinear && row.terms.iter().all(|t| t.1 == 0.0);
        let pair = pair.filter(|_| self.options.keep_paired);
        let decided = |v| self.fixed_at(v, key).is_some() || self.is_left_out(v, key);
        if empty && pair.is_some_and(decided) {
            self.leave_out(e, key, rhs);
            return;
        }
        if empty && pair.is_none() {
            return self.empty_row(e, relation, key, rhs);
        }
        let kept = || row.terms.iter().filter(|t| t.1 != 0.0);
        // `x =l= inf` never binds.
        let unlimited = match relation {
            Relation::Less => rhs == f64::INFINITY,
            Relation::Greater => rhs == f64::NEG_INFINITY,
            _ => false,
        };
        let (relation, rhs) = match (unlimited, pair.is_some()) {
            (true, false) => (Relation::Free, 0.0),
            (true, true) => {
                self.never_bind.push(self.row);
                (relation, 0.0)
            }
            (false, _) => (relation, rhs),
        };
        let part = if std::mem::take(&mut self.not_a_number) {
            Some("a constant in a nonlinear term")
        } else if !rhs.is_finite() {
            Some("the constant")
        } else {
            let bad = kept().any(|t| !t.1.is_finite());
            bad.then_some("a coefficient")
        };
        if let Some(part) = part {
            let name = self.m.record_name(e.symbol, key);
            self.not_finite(part, &name, e.span);
            return;
        }
        let matrix = &mut self.instance.matrix;
        for &(c, v) in kept() {
            matrix.column.push(c);
            matrix.value.push(without_eps(v));
        }
        matrix.start.push(matrix.column.len());
        let t = self.m.symbols.get(e.symbol).table;
        let rows = &mut self.instance.rows;
        rows.relation.push(relation);
        rows.rhs.push(rhs);
        rows.marginal
            .push(number(self.m.store.table(t + attribute::M).get(key)));
        let scale = if self.options.scale {
            number(self.m.store.table(t + attribute::SCALE).get(key))
        } else {
            1.0
        };
        rows.scale.push(scale);
        if !finish::is_scale(scale) {
            let name = self.m.record_name(e.symbol, key);
            self.bad_scale(&name, scale);
        }
        block.keys.extend_from_slice(key);
        self.row += 1;
    }

    /// A row without variables and without a partner: left out if it holds, else an error.
    fn empty_row(&mut self, e: &EquationDef, relation: Relation, key: &[Label], rhs: f64) {
        let violated = match relation {
            Relation::Equal => rhs.abs() > 1e-9,
            Relation::Greater => rhs > 1e-9,
            Relation::Less => rhs < -1e-9,
            Relation::Free => false,
        };
        if violated {
            let name = self.m.record_name(e.symbol, key);
            let sign = relation.name();
            Diagnostic::execution("E0410", e.span)
                .says(format!("the row {name} has no variables and cannot hold: 0 {sign} {rhs}"))
                .label("empty and infeasible")
                .help("its coefficients are all zero, or its sums are empty: check the data, or add a `$` condition to the equation")
                .note(self.m);
            self.failed = true;
        }
        self.leave_out(e, key, rhs);
    }

    /// A row without variables.
    fn leave_out(&mut self, e: &EquationDef, key: &[Label], rhs: f64) {
        self.left_out.push(LeftOut {
            symbol: e.symbol,
            key: key.to_vec(),
            bounds: e.relation.bounds(rhs),
        });
    }

    fn not_finite(&mut self, part: &str, row: &str, span: Span) {
        Diagnostic::execution("E0411", span)
            .says(format!("{part} of the row {row} is not a finite number"))
            .label("not finite")
            .help("look for inf, na or undf in the data of this equation")
            .note(self.m);
        self.failed = true;
    }

    /// Provisional number of a column.
    fn column(&mut self, symbol: SymbolId, key: &[Label]) -> u32 {
        let next = self.columns;
        let m = match self.map_of.get(&symbol) {
            Some(&i) => &mut self.maps[i],
            None => {
                self.map_of.insert(symbol, self.maps.len());
                self.maps.push(ColumnMap {
                    symbol,
                    dim: key.len(),
                    keys: Vec::new(),
                    numbers: Vec::new(),
                    index: KeyIndex::new(key.len()),
                    labels: self.m.label_box(symbol),
                });
                self.maps.last_mut().expect("just pushed")
            }
        };
        let i = m.numbers.len() as u32;
        let found = match m.dim {
            0 => (i > 0).then_some(0),
            _ => m.index.find_or_insert(key, i, &m.keys),
        };
        if let Some(r) = found {
            return m.numbers[r as usize];
        }
        m.numbers.push(next);
        m.keys.extend_from_slice(key);
        if let Some(b) = &m.labels
            && !m.index.is_dense()
            && b.fits(m.numbers.len())
        {
            m.index.spread_over(b, &m.keys);
        }
        self.columns += 1;
        self.place.push(0);
        next
    }

    /// The column of a reference in the frame, or a constant when it is held fixed; None for a lag
    /// that leaves its set, and for a column that the model leaves out.
    fn reference(&mut self, s: SymbolId, key: &Key, frame: &mut Frame) -> Option<Result<u32, f64>> {
        let mut k = [0; 20];
        if !self.m.key(key, frame, &mut k) {
            return None;
        }
        let k = &k[..key.parts.len()];
        if self.is_left_out(s, k) {
            return None;
        }
        Some(match self.held_at(s, k) {
            None => Ok(self.column(s, k)),
            Some(value) => {
                self.held.insert((s, k.to_vec()));
                Err(value)
            }
        })
    }

    /// The value at which `holdFixed` holds a variable.
    fn held_at(&self, s: SymbolId, key: &[Label]) -> Option<f64> {
        let hold = self.options.hold_fixed;
        hold.then(|| self.fixed_at(s, key)).flatten()
    }

    /// Whether the model limits a variable to a set that a key is not in.
    fn is_left_out(&self, s: SymbolId, key: &[Label]) -> bool {
        let limit = self.limits.get(&s).map(|&t| self.m.store.table(t));
        limit.is_some_and(|t| t.find(key).is_none())
    }

    /// The value of a variable whose bounds are equal.
    fn fixed_at(&self, s: SymbolId, key: &[Label]) -> Option<f64> {
        let t = self.m.symbols.get(s).table;
        let bound = |o: u32| number(self.m.store.table(t + o).get(key));
        let (lower, upper) = (bound(attribute::LO), bound(attribute::UP));
        (lower == upper).then_some(lower)
    }
}
