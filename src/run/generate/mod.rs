//! From equations and data to an instance.
//!
//! Each equation block runs over its domain; each row is walked once, its linear terms going into
//! one compressed matrix and its nonlinear terms into kernels (one per shape, found by hashing the
//! program). Columns are numbered as they appear and put into label order at the end.
//!
//! As in GAMS: zero coefficients make no nonzero and no column; a row whose terms cancel is dropped
//! (an error if it then cannot hold); fixed columns stay unless `holdfixed`.

use super::{Frame, Machine, scan};
use crate::check::node::*;
use crate::check::symbols::{DomainPosition, SymbolKind, attribute};
use crate::data::key_index::{KeyIndex, LabelBox};
use crate::data::sort::{sort_records, sort_tuples};
use crate::data::universe::Label;
use crate::data::value::{is_eps, number, truth};
use crate::diag::Diagnostic;
use crate::model::instance::*;
use crate::model::origin::{Block, Blocks, Origin};
use crate::source::Span;
use crate::syntax::ast::VariableKind;
use rustc_hash::FxHashMap;

/// How to generate.
#[derive(Clone, Copy, Debug, Default)]
pub struct GenerateOptions {
    /// Fixed columns become constants.
    pub hold_fixed: bool,
    /// Use `.scale`.
    pub scale: bool,
    /// Rows that are paired are kept even when empty.
    pub keep_paired: bool,
}

/// An instance and where it comes from.
#[derive(Debug, Default)]
pub struct Generated {
    /// The instance.
    pub instance: Instance,
    /// Names and statistics.
    pub origin: Origin,
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
}

/// A nonlinear term in the making.
#[derive(Default)]
struct Tape {
    ops: Vec<Op>,
    columns: Vec<u32>,
    constants: Vec<f64>,
}

/// What `eps` is as a coefficient while a row is built: `eps*x` keeps `x` in the row, and counts, with
/// the coefficient 0. The size lets it vanish in sums and survive factors.
const EPS_COEFFICIENT: f64 = 1e-250;
/// Coefficients below are such.
const EPS_BELOW: f64 = 1e-200;

struct Builder<'m, 'h> {
    m: &'m Machine<'h>,
    options: GenerateOptions,
    maps: Vec<ColumnMap>,
    map_of: FxHashMap<SymbolId, usize>,
    columns: u32,
    instance: Instance,
    kernels: FxHashMap<Vec<Op>, usize>,
    nonlinear_terms: usize,
    /// Position + 1 of a column in the row at hand.
    place: Vec<u32>,
    row: u32,
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
        let mut scans = Vec::new();
        for r in &solve.equations {
            let e = &equations[r.definition];
            scan::domain(&e.domain, &mut scans);
            scan::expr(&e.left, true, &mut scans);
            scan::expr(&e.right, true, &mut scans);
            if let Some(s) = r.restrict {
                scans.push(self.symbols.get(s).table);
            }
        }
        for t in scans {
            self.store.table_mut(t).tidy();
        }
        let mut b = Builder {
            m: self,
            options,
            maps: Vec::new(),
            map_of: FxHashMap::default(),
            columns: 0,
            instance: Instance::default(),
            kernels: FxHashMap::default(),
            nonlinear_terms: 0,
            place: Vec::new(),
            row: 0,
            failed: false,
            span: Span::default(),
        };
        b.instance.matrix.start.push(0);
        if let Some((_, z)) = solve.objective {
            b.column(z, &[]);
        }
        let mut row_blocks = Blocks::default();
        let mut k = 0;
        while k < solve.equations.len() {
            // One equation may stand several times, paired with different variables.
            let e = &equations[solve.equations[k].definition];
            b.block(e, &solve.equations[k], &mut row_blocks, frame);
            k += 1;
            if b.failed || b.m.stopped() {
                return None;
            }
        }
        let origin = b.finish(row_blocks, solve);
        let instance = b.instance;
        let failed = b.failed;
        (!failed && !self.stopped()).then_some(Generated { instance, origin })
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
        let restrict = item.restrict.map(|s| self.m.symbols.get(s).table);
        // Tuples first (in label order), then rows: the order of rows is what a person sees.
        let d = e.domain.slots.len();
        let tuples = if d == 0 {
            let plan = self.m.plan(&e.domain, None);
            let mut any = false;
            self.m.run_plan(&e.domain, &plan, frame, &mut |_| {
                any = true;
                false
            });
            if !any {
                return;
            }
            Vec::new()
        } else {
            self.m.tuples(&e.domain, frame)
        };
        let plain = e.key.is_plain() && {
            let slots: Vec<Slot> = e
                .key
                .parts
                .iter()
                .filter_map(|p| {
                    if let Part::Slot(s) = p {
                        Some(*s)
                    } else {
                        None
                    }
                })
                .collect();
            slots == e.domain.slots
        };
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
            if let Some(t) = restrict
                && self.m.store.table(t).dim() == dim
                && self.m.store.table(t).find(&key[..dim]).is_none()
            {
                continue;
            }
            *self.m.current.borrow_mut() = Some((e.symbol, key[..dim].to_vec()));
            self.one_row(
                e,
                relation,
                item.pair.is_some(),
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
        paired: bool,
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
        let rhs = if row.constant == 0.0 {
            0.0
        } else {
            -row.constant
        };
        let empty = !nonlinear && row.terms.iter().all(|t| t.1 == 0.0);
        if empty && !(paired && self.options.keep_paired) {
            let violated = match relation {
                Relation::Equal => rhs.abs() > 1e-9,
                Relation::Greater => rhs > 1e-9,
                Relation::Less => rhs < -1e-9,
                Relation::Free => false,
            };
            if violated {
                let name = self.m.record_name(e.symbol, key);
                let sign = match relation {
                    Relation::Equal => "=e=",
                    Relation::Greater => "=g=",
                    _ => "=l=",
                };
                self.m.note(
                    Diagnostic::execution("E0410", e.span, format!("the row {name} has no variables and cannot hold: 0 {sign} {rhs}"))
                        .label("empty and infeasible")
                        .help("its coefficients are all zero, or its sums are empty: check the data, or add a `$` condition to the equation"),
                );
                self.failed = true;
            }
            return;
        }
        if !rhs.is_finite() {
            let name = self.m.record_name(e.symbol, key);
            self.m.note(
                Diagnostic::execution(
                    "E0411",
                    e.span,
                    format!("the constant of the row {name} is not a finite number"),
                )
                .label("not finite")
                .help("look for inf, na or undf in the data of this equation"),
            );
            self.failed = true;
            return;
        }
        let matrix = &mut self.instance.matrix;
        for &(c, v) in row.terms.iter().filter(|t| t.1 != 0.0) {
            if !v.is_finite() {
                let name = self.m.record_name(e.symbol, key);
                self.m.note(
                    Diagnostic::execution(
                        "E0411",
                        e.span,
                        format!("a coefficient of the row {name} is not a finite number"),
                    )
                    .label("not finite")
                    .help("look for inf, na or undf in the data of this equation"),
                );
                self.failed = true;
                return;
            }
            matrix.column.push(c);
            matrix.value.push(if v.abs() < EPS_BELOW { 0.0 } else { v });
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
        block.keys.extend_from_slice(key);
        self.row += 1;
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
    /// that leaves its set.
    fn reference(&mut self, s: SymbolId, key: &Key, frame: &mut Frame) -> Option<Result<u32, f64>> {
        let mut k = [0; 20];
        if !self.m.key(key, frame, &mut k) {
            return None;
        }
        let k = &k[..key.parts.len()];
        if self.options.hold_fixed {
            let t = self.m.symbols.get(s).table;
            let (lo, up) = (
                self.m.store.table(t + attribute::LO).get(k),
                self.m.store.table(t + attribute::UP).get(k),
            );
            if number(lo) == number(up) {
                return Some(Err(number(lo)));
            }
        }
        Some(Ok(self.column(s, k)))
    }

    fn add(&mut self, column: u32, coef: f64, row: &mut Row) {
        let p = &mut self.place[column as usize];
        if *p == 0 {
            row.terms.push((column, coef));
            *p = row.terms.len() as u32;
        } else {
            row.terms[*p as usize - 1].1 += coef;
        }
    }

    /// A value that goes into the instance: eps is 0.
    fn value(&self, n: &Node, frame: &mut Frame) -> f64 {
        let v = self.m.eval(n, frame);
        if is_eps(v) { 0.0 } else { v }
    }

    /// Adds `coef · n` to the row.
    fn emit(&mut self, n: &Node, coef: f64, frame: &mut Frame, row: &mut Row) {
        if !n.has_var {
            row.constant += coef * self.value(n, frame);
            return;
        }
        match &n.kind {
            NodeKind::Var(s, key) => match self.reference(*s, key, frame) {
                Some(Ok(c)) => self.add(c, coef, row),
                Some(Err(x)) => row.constant += coef * x,
                None => {}
            },
            NodeKind::Negate(a) => self.emit(a, -coef, frame, row),
            NodeKind::Sum(terms) => {
                for (minus, t) in terms {
                    self.emit(t, if *minus { -coef } else { coef }, frame, row);
                }
            }
            NodeKind::Product(factors) => {
                let Some((c, var)) = self.split(factors, frame) else {
                    return;
                };
                let c = coef * c;
                if c == 0.0 {
                    return;
                }
                match var {
                    Some(f) => self.emit(f, c, frame, row),
                    None => self.emit_nonlinear(n, coef, frame, row),
                }
            }
            NodeKind::Dollar(a, c) => {
                if truth(self.m.eval(c, frame)) {
                    self.emit(a, coef, frame, row);
                }
            }
            NodeKind::Aggregate(AggregateOp::Sum, d, body) => {
                let m = self.m;
                let plan = m.plan(d, Some(body));
                m.run_plan(d, &plan, frame, &mut |f| {
                    self.emit(body, coef, f, row);
                    !self.failed && m.keep_going()
                });
            }
            _ => self.emit_nonlinear(n, coef, frame, row),
        }
    }

    /// Splits a product into its data and the one linear factor with variables, if there is just one
    /// and it does not divide. None: the data part is not a number (an error was noted).
    fn split<'n>(
        &self,
        factors: &'n [(bool, Node)],
        frame: &mut Frame,
    ) -> Option<(f64, Option<&'n Node>)> {
        let mut c = 1.0;
        let mut var = None;
        let mut several = false;
        for (divide, f) in factors {
            if f.has_var {
                several |= var.is_some() || *divide;
                var = Some(f);
                continue;
            }
            let v = self.m.eval(f, frame);
            let v = match (is_eps(v), divide) {
                (true, false) => EPS_COEFFICIENT,
                (true, true) => 0.0,
                _ => v,
            };
            if *divide {
                if v == 0.0 {
                    self.m.execution_error(
                        "E0401",
                        f.span,
                        "division by zero".into(),
                        "guard it with a condition, `(x/b)$b`",
                    );
                    return None;
                }
                c /= v;
            } else {
                c *= v;
            }
        }
        Some((c, if several { None } else { var }))
    }

    fn emit_nonlinear(&mut self, n: &Node, coef: f64, frame: &mut Frame, row: &mut Row) {
        if coef == 0.0 {
            return;
        }
        let mut tape = Tape::default();
        self.build(n, frame, &mut tape);
        // Without variables, or with some held fixed, it may be a number or linear after all.
        if tape.columns.is_empty() || self.options.hold_fixed {
            match super::constant::affine(&tape.ops, &tape.constants) {
                Ok(Some(a)) => {
                    row.constant += coef * a.constant;
                    for (v, c) in a.terms {
                        self.add(tape.columns[v as usize], coef * c, row);
                    }
                    return;
                }
                Ok(None) => {}
                Err(e) => {
                    self.m.execution_error(
                        "E0403",
                        n.span,
                        e.to_string(),
                        "guard it with a condition",
                    );
                    return;
                }
            }
        }
        let k = match self.kernels.get(&tape.ops) {
            Some(&k) => k,
            None => {
                let k = self.instance.nonlinear.len();
                self.kernels.insert(tape.ops.clone(), k);
                self.instance.nonlinear.push(KernelTerms {
                    kernel: Kernel {
                        variables: tape.columns.len() as u32,
                        constants: tape.constants.len() as u32,
                        ops: tape.ops,
                    },
                    ..KernelTerms::default()
                });
                k
            }
        };
        self.nonlinear_terms += 1;
        let terms = &mut self.instance.nonlinear[k];
        terms.row.push(self.row);
        terms.coef.push(coef);
        terms.columns.extend_from_slice(&tape.columns);
        terms.constants.extend_from_slice(&tape.constants);
    }

    fn constant(&self, x: f64, tape: &mut Tape) {
        tape.ops.push(Op::Const(tape.constants.len() as u32));
        tape.constants.push(x);
    }

    /// Appends an affine expression.
    fn affine(&mut self, part: Row, tape: &mut Tape) {
        let terms: Vec<(u32, f64)> = part.terms.iter().copied().filter(|t| t.1 != 0.0).collect();
        match terms.as_slice() {
            [] => self.constant(part.constant, tape),
            [(c, v)] if *v == 1.0 && part.constant == 0.0 => {
                tape.ops.push(Op::Var(tape.columns.len() as u32));
                tape.columns.push(*c);
            }
            _ => {
                tape.ops.push(Op::Affine {
                    constant: tape.constants.len() as u32,
                    variable: tape.columns.len() as u32,
                    terms: terms.len() as u32,
                });
                tape.constants.push(part.constant);
                for (c, v) in terms {
                    tape.constants.push(v);
                    tape.columns.push(c);
                }
            }
        }
    }

    /// Collects linear expressions into one affine form. The row at hand uses `place` too, so a
    /// private list is merged by sorting.
    fn gather(&mut self, n: &Node, coef: f64, frame: &mut Frame, part: &mut Row) {
        if !n.has_var {
            part.constant += coef * self.value(n, frame);
            return;
        }
        match &n.kind {
            NodeKind::Var(s, key) => match self.reference(*s, key, frame) {
                Some(Ok(c)) => part.terms.push((c, coef)),
                Some(Err(x)) => part.constant += coef * x,
                None => {}
            },
            NodeKind::Negate(a) => self.gather(a, -coef, frame, part),
            NodeKind::Sum(terms) => {
                for (minus, t) in terms {
                    self.gather(t, if *minus { -coef } else { coef }, frame, part);
                }
            }
            NodeKind::Product(factors) => {
                if let Some((c, Some(f))) = self.split(factors, frame)
                    && c != 0.0
                {
                    self.gather(f, coef * c, frame, part);
                }
            }
            NodeKind::Dollar(a, c) if truth(self.m.eval(c, frame)) => {
                self.gather(a, coef, frame, part);
            }
            NodeKind::Aggregate(AggregateOp::Sum, d, body) => {
                let m = self.m;
                let plan = m.plan(d, Some(body));
                m.run_plan(d, &plan, frame, &mut |f| {
                    self.gather(body, coef, f, part);
                    m.keep_going()
                });
            }
            _ => {}
        }
    }

    fn linear(&mut self, n: &Node, frame: &mut Frame, tape: &mut Tape) {
        let mut part = Row::default();
        self.gather(n, 1.0, frame, &mut part);
        merge_terms(&mut part.terms);
        self.affine(part, tape);
    }

    /// Appends the program of an expression: leaves one value.
    fn build(&mut self, n: &Node, frame: &mut Frame, tape: &mut Tape) {
        if !n.has_var {
            let v = self.value(n, frame);
            self.constant(v, tape);
            return;
        }
        if n.linear {
            self.linear(n, frame, tape);
            return;
        }
        match &n.kind {
            NodeKind::Negate(a) => {
                self.build(a, frame, tape);
                tape.ops.push(Op::Negate);
            }
            NodeKind::Not(a) => {
                self.build(a, frame, tape);
                tape.ops.push(Op::Call(Function::BoolNot, 1));
            }
            NodeKind::Sum(terms) => {
                let (mut part, mut count) = (Row::default(), 0u32);
                for (minus, t) in terms {
                    if t.linear {
                        self.gather(t, if *minus { -1.0 } else { 1.0 }, frame, &mut part);
                        continue;
                    }
                    self.build(t, frame, tape);
                    if *minus {
                        tape.ops.push(Op::Negate);
                    }
                    count += 1;
                }
                merge_terms(&mut part.terms);
                if !part.terms.is_empty() || part.constant != 0.0 || count == 0 {
                    self.affine(part, tape);
                    count += 1;
                }
                add_n(count, tape);
            }
            NodeKind::Product(factors) => self.build_product(factors, frame, tape),
            NodeKind::Dollar(a, c) => {
                if truth(self.m.eval(c, frame)) {
                    self.build(a, frame, tape);
                } else {
                    self.constant(0.0, tape);
                }
            }
            NodeKind::Binary(op, a, b) => self.build_binary(*op, a, b, frame, tape),
            NodeKind::Call(f, args) => match (f, args.as_slice()) {
                (Function::Sqr, [a]) => {
                    self.build(a, frame, tape);
                    tape.ops.push(Op::PowerInt(2));
                }
                (Function::Power, [a, b]) if !b.has_var => {
                    let p = self.value(b, frame);
                    if p.fract() != 0.0 || p.abs() > 1e6 {
                        self.m.execution_error(
                            "E0403",
                            b.span,
                            format!("the exponent of `power` is {p}; it must be a whole number"),
                            "use `**` or `rpower` for real exponents",
                        );
                    }
                    self.build(a, frame, tape);
                    tape.ops.push(Op::PowerInt(p as i32));
                }
                _ => {
                    for a in args {
                        self.build(a, frame, tape);
                    }
                    tape.ops.push(Op::Call(*f, args.len() as u32));
                }
            },
            NodeKind::Aggregate(op, d, body) => self.build_aggregate(*op, d, body, frame, tape),
            _ => self.constant(0.0, tape),
        }
    }

    fn build_product(&mut self, factors: &[(bool, Node)], frame: &mut Frame, tape: &mut Tape) {
        let Some((c, _)) = self.split(factors, frame) else {
            self.constant(0.0, tape);
            return;
        };
        if c == 0.0 {
            self.constant(0.0, tape);
            return;
        }
        let mut count = 0;
        for (_, f) in factors.iter().filter(|(d, f)| f.has_var && !d) {
            self.build(f, frame, tape);
            count += 1;
        }
        if c != 1.0 || count == 0 {
            self.constant(c, tape);
            count += 1;
        }
        multiply_n(count, tape);
        let mut below = 0;
        for (_, f) in factors.iter().filter(|(d, f)| f.has_var && *d) {
            self.build(f, frame, tape);
            below += 1;
        }
        if below > 0 {
            multiply_n(below, tape);
            tape.ops.push(Op::Divide);
        }
    }

    fn build_binary(
        &mut self,
        op: BinaryOp,
        a: &Node,
        b: &Node,
        frame: &mut Frame,
        tape: &mut Tape,
    ) {
        self.build(a, frame, tape);
        self.build(b, frame, tape);
        tape.ops.push(match op {
            BinaryOp::Power => Op::Power,
            BinaryOp::Eq => Op::Call(Function::RelEq, 2),
            BinaryOp::Ne => Op::Call(Function::RelNe, 2),
            BinaryOp::Lt => Op::Call(Function::RelLt, 2),
            BinaryOp::Le => Op::Call(Function::RelLe, 2),
            BinaryOp::Gt => Op::Call(Function::RelGt, 2),
            BinaryOp::Ge => Op::Call(Function::RelGe, 2),
            BinaryOp::And => Op::Call(Function::BoolAnd, 2),
            BinaryOp::Or => Op::Call(Function::BoolOr, 2),
            BinaryOp::Xor => Op::Call(Function::BoolXor, 2),
            BinaryOp::Implies => Op::Call(Function::BoolImp, 2),
            BinaryOp::Equivalent => Op::Call(Function::BoolEqv, 2),
            _ => Op::Add,
        });
    }

    fn build_aggregate(
        &mut self,
        op: AggregateOp,
        d: &Domain,
        body: &Node,
        frame: &mut Frame,
        tape: &mut Tape,
    ) {
        let m = self.m;
        let sum = op == AggregateOp::Sum;
        let plan = m.plan(d, if sum { Some(body) } else { None });
        let mut count = 0u32;
        m.run_plan(d, &plan, frame, &mut |f| {
            self.build(body, f, tape);
            count += 1;
            m.keep_going()
        });
        match op {
            AggregateOp::Sum => {
                if count == 0 {
                    self.constant(0.0, tape);
                }
                add_n(count, tape);
            }
            AggregateOp::Prod => {
                if count == 0 {
                    self.constant(1.0, tape);
                }
                multiply_n(count, tape);
            }
            AggregateOp::Smin | AggregateOp::Smax => {
                let (f, none) = if op == AggregateOp::Smin {
                    (Function::Min, f64::INFINITY)
                } else {
                    (Function::Max, f64::NEG_INFINITY)
                };
                match count {
                    0 => self.constant(none, tape),
                    1 => {}
                    n => tape.ops.push(Op::Call(f, n)),
                }
            }
            AggregateOp::Sand | AggregateOp::Sor => {
                let (f, none) = if op == AggregateOp::Sand {
                    (Function::BoolAnd, 1.0)
                } else {
                    (Function::BoolOr, 0.0)
                };
                if count == 0 {
                    self.constant(none, tape);
                }
                for _ in 1..count {
                    tape.ops.push(Op::Call(f, 2));
                }
            }
        }
    }

    /// Numbers columns in label order, fills their bounds, matches pairs and counts.
    fn finish(&mut self, rows: Blocks, solve: &SolveCode) -> Origin {
        // Columns of pairs belong to the model even where they stand in no row.
        let mut pairs: Vec<(SymbolId, u32, Vec<Label>)> = Vec::new();
        for item in &solve.equations {
            let (Some(v), e) = (item.pair, self.m.equations[item.definition].symbol) else {
                continue;
            };
            if let Some(block) = rows.symbol(e) {
                for r in block.start..block.start + block.len {
                    pairs.push((v, r, block.key(r).to_vec()));
                }
            }
        }
        let mut used = vec![false; self.columns as usize];
        for &c in &self.instance.matrix.column {
            used[c as usize] = true;
        }
        for k in &self.instance.nonlinear {
            for &c in &k.columns {
                used[c as usize] = true;
            }
        }
        let mut matched_rows = Vec::new();
        let mut alone = Vec::new();
        for (v, r, key) in &pairs {
            let known = self.columns;
            let c = self.column(*v, key);
            if c >= known {
                alone.push((c, *r));
            }
            used.resize(self.columns as usize, false);
            used[c as usize] = true;
            matched_rows.push((c, *r));
        }
        if solve.objective.is_some() {
            used[0] = true;
        }
        self.maps.sort_by_key(|m| m.symbol);
        let mut new_number = vec![u32::MAX; self.columns as usize];
        let mut columns = Blocks::default();
        let mut next = 0u32;
        for m in &self.maps {
            let d = m.dim;
            let mut order: Vec<u32> = (0..m.numbers.len() as u32)
                .filter(|&i| used[m.numbers[i as usize] as usize])
                .collect();
            let key = |i: u32| &m.keys[i as usize * d..(i as usize + 1) * d];
            if d > 0 {
                sort_records(&mut order, &m.keys, d, &(0..d).collect::<Vec<_>>());
            }
            let mut block = Block {
                symbol: m.symbol,
                start: next,
                len: order.len() as u32,
                dim: d,
                keys: Vec::with_capacity(order.len() * d),
            };
            for &i in &order {
                new_number[m.numbers[i as usize] as usize] = next;
                next += 1;
                block.keys.extend_from_slice(key(i));
            }
            if block.len > 0 {
                columns.list.push(block);
            }
        }
        self.maps.clear();
        for c in &mut self.instance.matrix.column {
            *c = new_number[*c as usize];
        }
        for k in &mut self.instance.nonlinear {
            for c in &mut k.columns {
                *c = new_number[*c as usize];
            }
        }
        self.sort_rows();
        self.fill_columns(&columns);
        if let Some((sense, z)) = solve.objective {
            let column = columns.symbol(z).map_or(0, |b| b.start);
            self.instance.objective = Some(Objective { column, sense });
        }
        if solve.using == "mcp" {
            let renumbered = |list: &[(u32, u32)]| -> Vec<(u32, u32)> {
                list.iter()
                    .map(|&(c, r)| (new_number[c as usize], r))
                    .collect()
            };
            self.check_partners(
                &rows,
                &columns,
                &renumbered(&matched_rows),
                &renumbered(&alone),
            );
        }
        if matches!(solve.using, "mcp" | "mpec" | "rmpec" | "cns") {
            let mut matched: Vec<Option<u32>> = vec![None; next as usize];
            for (c, r) in matched_rows {
                let slot = &mut matched[new_number[c as usize] as usize];
                if let Some(other) = *slot {
                    let block = columns.of(new_number[c as usize]);
                    let name = self
                        .m
                        .record_name(block.symbol, block.key(new_number[c as usize]));
                    let row = |r: u32| self.m.record_name(rows.of(r).symbol, rows.of(r).key(r));
                    let (a, b) = (row(other), row(r));
                    self.m.note(
                        Diagnostic::execution("E0412", self.span, format!("the column {name} is matched twice: with {a} and with {b}"))
                            .label("in this model")
                            .help("each column has one row; restrict one of the equations by a `$` condition"),
                    );
                    self.failed = true;
                }
                *slot = Some(r);
            }
            self.instance.matched = Some(matched);
        }
        let (nonzeros, nonlinear_nonzeros) = self.count();
        Origin {
            rows,
            columns,
            nonzeros,
            nonlinear_nonzeros,
        }
    }

    /// A pair whose row is empty, or whose column stands in no row (`alone`), decides nothing: an error,
    /// as in GAMS, unless the column is fixed.
    fn check_partners(
        &mut self,
        rows: &Blocks,
        columns: &Blocks,
        pairs: &[(u32, u32)],
        alone: &[(u32, u32)],
    ) {
        let m = &self.instance.matrix;
        let mut empty: Vec<bool> = m.start.windows(2).map(|w| w[0] == w[1]).collect();
        for k in &self.instance.nonlinear {
            k.row.iter().for_each(|&r| empty[r as usize] = false);
        }
        let bounds = &self.instance.columns;
        let fixed = |c: u32| bounds.lower[c as usize] == bounds.upper[c as usize];
        let blamed = pairs
            .iter()
            .find(|&&(c, r)| empty[r as usize] && !fixed(c))
            .or_else(|| alone.iter().find(|&&(c, _)| !fixed(c)));
        let Some(&(c, r)) = blamed else { return };
        let name = |blocks: &Blocks, i: u32| {
            let block = blocks.of(i);
            self.m.record_name(block.symbol, block.key(i))
        };
        let (row, column) = (name(rows, r), name(columns, c));
        let symbol = rows.of(r).symbol;
        let place = self
            .m
            .equations
            .iter()
            .find(|d| d.symbol == symbol)
            .map_or(self.span, |d| d.span);
        let (code, message, help) = if empty[r as usize] {
            (
                "E0414",
                format!("the row {row} is empty, and its partner {column} is not fixed"),
                "no variable is left in the row: restrict the equation by a `$` condition, or fix the variable",
            )
        } else {
            (
                "E0415",
                format!("the row {row} is paired with {column}, which stands in no row"),
                "restrict the equation by a `$` condition to where the variable is used, or fix the variable",
            )
        };
        let diagnostic = Diagnostic::execution(code, place, message)
            .label("this equation")
            .other(self.span, "at this solve")
            .help(help);
        self.m.note(diagnostic);
        self.failed = true;
    }

    /// Columns increasing within each row.
    fn sort_rows(&mut self) {
        let m = &mut self.instance.matrix;
        let mut scratch: Vec<(u32, f64)> = Vec::new();
        for i in 0..m.start.len() - 1 {
            let r = m.start[i]..m.start[i + 1];
            if m.column[r.clone()].windows(2).all(|w| w[0] < w[1]) {
                continue;
            }
            scratch.clear();
            scratch.extend(
                m.column[r.clone()]
                    .iter()
                    .copied()
                    .zip(m.value[r.clone()].iter().copied()),
            );
            scratch.sort_unstable_by_key(|t| t.0);
            for (k, &(c, v)) in r.zip(&scratch) {
                m.column[k] = c;
                m.value[k] = v;
            }
        }
    }

    fn fill_columns(&mut self, blocks: &Blocks) {
        let n: usize = blocks.list.iter().map(|b| b.len as usize).sum();
        let c = &mut self.instance.columns;
        for v in [
            &mut c.lower,
            &mut c.upper,
            &mut c.level,
            &mut c.marginal,
            &mut c.scale,
        ] {
            v.reserve_exact(n);
        }
        for b in &blocks.list {
            let symbol = self.m.symbols.get(b.symbol);
            let t = symbol.table;
            let kind = match symbol.kind {
                SymbolKind::Variable(
                    VariableKind::Free
                    | VariableKind::Positive
                    | VariableKind::Negative
                    | VariableKind::Unstated,
                ) => ColumnKind::Continuous,
                _ => ColumnKind::Discrete,
            };
            let semi = matches!(
                symbol.kind,
                SymbolKind::Variable(VariableKind::SemiContinuous | VariableKind::SemiInteger)
            );
            let get = |o: u32, key: &[Label]| number(self.m.store.table(t + o).get(key));
            for i in b.start..b.start + b.len {
                let key = b.key(i);
                let lower = get(attribute::LO, key);
                c.lower.push(if semi { lower.min(0.0) } else { lower });
                c.upper.push(get(attribute::UP, key));
                c.level.push(get(attribute::L, key));
                c.marginal.push(get(attribute::M, key));
                c.scale.push(if self.options.scale {
                    get(attribute::SCALE, key)
                } else {
                    1.0
                });
                c.kind.push(kind);
            }
        }
        for i in 0..n {
            let (lo, up) = (
                self.instance.columns.lower[i],
                self.instance.columns.upper[i],
            );
            let level = self.instance.columns.level[i];
            let block = || blocks.of(i as u32);
            let name = || self.m.record_name(block().symbol, block().key(i as u32));
            let problem = if lo.is_nan() || up.is_nan() || level.is_nan() || level.is_infinite() {
                Some(format!(
                    "a bound or the level of {} is not a number",
                    name()
                ))
            } else if lo > up {
                Some(format!(
                    "the lower bound of {} is above its upper bound: {lo} > {up}",
                    name()
                ))
            } else if lo == f64::INFINITY || up == f64::NEG_INFINITY {
                Some(format!(
                    "the bounds of {} leave nothing: {lo} … {up}",
                    name()
                ))
            } else {
                None
            };
            if let Some(message) = problem {
                self.m.note(
                    Diagnostic::execution("E0413", self.m.options.at.get(), message)
                        .label("at this solve")
                        .help("check the assignments to `.lo`, `.up`, `.fx` and `.l`"),
                );
                self.failed = true;
            }
        }
    }

    /// Nonzeros, and nonlinear ones, as pairs of row and column.
    fn count(&self) -> (usize, usize) {
        let m = &self.instance.matrix;
        let mut pairs: Vec<u64> = Vec::new();
        for k in &self.instance.nonlinear {
            let v = k.kernel.variables as usize;
            for (t, &r) in k.row.iter().enumerate() {
                pairs.extend(
                    k.columns[t * v..(t + 1) * v]
                        .iter()
                        .map(|&c| u64::from(r) << 32 | u64::from(c)),
                );
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let both = pairs
            .iter()
            .filter(|&&p| {
                let (r, c) = ((p >> 32) as usize, p as u32);
                m.column[m.start[r]..m.start[r + 1]]
                    .binary_search(&c)
                    .is_ok()
            })
            .count();
        (m.column.len() + pairs.len() - both, pairs.len())
    }
}

fn add_n(n: u32, tape: &mut Tape) {
    match n {
        0 | 1 => {}
        2 => tape.ops.push(Op::Add),
        n => tape.ops.push(Op::AddN(n)),
    }
}

fn multiply_n(n: u32, tape: &mut Tape) {
    match n {
        0 | 1 => {}
        2 => tape.ops.push(Op::Multiply),
        n => tape.ops.push(Op::MultiplyN(n)),
    }
}

/// Sorts terms by column and adds up those of the same.
fn merge_terms(terms: &mut Vec<(u32, f64)>) {
    if terms.windows(2).all(|w| w[0].0 < w[1].0) {
        return;
    }
    terms.sort_by_key(|t| t.0);
    terms.dedup_by(|b, a| {
        let same = a.0 == b.0;
        if same {
            a.1 += b.1;
        }
        same
    });
}
