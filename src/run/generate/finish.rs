//! The last steps of generation: columns in label order, their bounds, pairs, and the counts.

use super::Builder;
use crate::check::node::*;
use crate::check::symbols::{SymbolKind, attribute};
use crate::data::sort::sort_records;
use crate::data::universe::Label;
use crate::data::value::number;
use crate::diag::Diagnostic;
use crate::model::instance::*;
use crate::model::origin::{Block, Blocks, Origin};
use crate::syntax::ast::VariableKind;

impl Builder<'_, '_> {
    /// Numbers columns in label order, fills their bounds, matches pairs and counts.
    pub(super) fn finish(&mut self, rows: Blocks, solve: &SolveCode) -> Origin {
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
        let mut held_columns = Vec::new();
        for (v, r, key) in &pairs {
            let known = self.columns;
            let c = self.column(*v, key);
            if self.held_at(*v, key).is_some() {
                self.held.insert((*v, key.clone()));
                held_columns.push(c);
            }
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
        let (columns, new_number) = self.numbered(&used);
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
        for (c, _) in matched_rows.iter_mut().chain(&mut alone) {
            *c = new_number[*c as usize];
        }
        if self.options.keep_paired {
            self.check_partners(&rows, &columns, &matched_rows, &alone);
        }
        if self.options.keep_paired || solve.using.is_system() {
            self.match_columns(&rows, &columns, &matched_rows);
            self.fix_unlimited(&rows, &matched_rows);
        }
        let (nonzeros, nonlinear_nonzeros) = self.count();
        Origin {
            rows,
            columns,
            nonzeros,
            nonlinear_nonzeros,
            left_out: std::mem::take(&mut self.left_out),
            held: std::mem::take(&mut self.held).into_iter().collect(),
            held_columns: held_columns
                .into_iter()
                .map(|c| new_number[c as usize])
                .collect(),
        }
    }

    /// The columns that are used, in label order, and the new number of each old one.
    fn numbered(&mut self, used: &[bool]) -> (Blocks, Vec<u32>) {
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
        (columns, new_number)
    }

    /// The row of each column that has one; an error where there are two.
    fn match_columns(&mut self, rows: &Blocks, columns: &Blocks, pairs: &[(u32, u32)]) {
        let mut matched: Vec<Option<u32>> = vec![None; self.instance.columns.kind.len()];
        for &(c, r) in pairs {
            let slot = &mut matched[c as usize];
            if let Some(other) = *slot {
                let name = |blocks, i| self.m.origin_name(blocks, i as usize);
                let (column, a, b) = (name(columns, c), name(rows, other), name(rows, r));
                Diagnostic::execution("E0412", self.span)
                    .says(format!(
                        "the column {column} is matched twice: with {a} and with {b}"
                    ))
                    .label("in this model")
                    .help(
                        "each column has one row; restrict one of the equations by a `$` condition",
                    )
                    .note(self.m);
                self.failed = true;
            }
            *slot = Some(r);
        }
        self.instance.matched = Some(matched);
    }

    /// `k =g= q` with k = ∞ holds at any q, and F = ∞: its column is at its lower bound.
    fn fix_unlimited(&mut self, rows: &Blocks, pairs: &[(u32, u32)]) {
        let never_bind = std::mem::take(&mut self.never_bind);
        let unlimited = |p: &&(u32, u32)| never_bind.binary_search(&p.1).is_ok();
        for &(c, r) in pairs.iter().filter(unlimited) {
            let columns = &mut self.instance.columns;
            let c = c as usize;
            let bound = match self.instance.rows.relation[r as usize] {
                Relation::Less => columns.upper[c],
                _ => columns.lower[c],
            };
            if bound.is_finite() {
                columns.lower[c] = bound;
                columns.upper[c] = bound;
                columns.level[c] = bound;
            } else {
                let name = self.m.origin_name(rows, r as usize);
                self.not_finite("the constant", &name, self.span);
            }
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
        let name = |blocks, i| self.m.origin_name(blocks, i as usize);
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
        let diagnostic = Diagnostic::execution(code, place)
            .says(message)
            .label("this equation")
            .other(self.span, "at this solve")
            .help(help);
        diagnostic.note(self.m);
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

    /// Bounds, levels, marginals and scales of the columns, and what makes them discrete.
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
                SymbolKind::Variable(VariableKind::Binary | VariableKind::Integer) => {
                    ColumnKind::Integer
                }
                SymbolKind::Variable(VariableKind::SemiContinuous) => ColumnKind::SemiContinuous,
                SymbolKind::Variable(VariableKind::SemiInteger) => ColumnKind::SemiInteger,
                SymbolKind::Variable(VariableKind::Sos1 | VariableKind::Sos2) => {
                    ColumnKind::OrderedSet
                }
                _ => ColumnKind::Continuous,
            };
            let semi = matches!(kind, ColumnKind::SemiContinuous | ColumnKind::SemiInteger);
            let sets = match symbol.kind {
                SymbolKind::Variable(VariableKind::Sos1) => Some(false),
                SymbolKind::Variable(VariableKind::Sos2) => Some(true),
                _ => None,
            };
            let discrete = &mut self.instance.discrete;
            let get = |o: u32, key: &[Label]| number(self.m.store.table(t + o).get(key));
            for i in b.start..b.start + b.len {
                let key = b.key(i);
                let lower = get(attribute::LO, key);
                let upper = get(attribute::UP, key);
                // bounds that cross stay for the check
                let zero = semi && lower <= upper;
                c.lower.push(if zero { lower.min(0.0) } else { lower });
                c.upper.push(upper);
                c.level.push(get(attribute::L, key));
                c.marginal.push(get(attribute::M, key));
                c.scale.push(if self.options.scale {
                    get(attribute::SCALE, key)
                } else {
                    1.0
                });
                let prior = match kind {
                    ColumnKind::Continuous => 1.0,
                    _ => get(attribute::PRIOR, key),
                };
                if prior != 1.0 {
                    discrete.priorities.resize(n, 1.0);
                    discrete.priorities[i as usize] = prior;
                }
                // As in GAMS, an infinite priority relaxes the column.
                let relaxed = prior == f64::INFINITY;
                c.kind.push(if relaxed {
                    ColumnKind::Continuous
                } else {
                    kind
                });
                if semi && lower > 0.0 && !relaxed {
                    discrete.thresholds.push((i, lower));
                }
                if let Some(neighbours) = sets.filter(|_| !relaxed) {
                    // The last index runs through a set; what stands before it names the set.
                    let outer = |i: u32| b.key(i).split_last().map(|(_, outer)| outer);
                    match discrete.sets.last_mut() {
                        Some(set)
                            if i > b.start
                                && set.columns.last() == Some(&(i - 1))
                                && outer(i - 1) == outer(i) =>
                        {
                            set.columns.push(i);
                        }
                        _ => discrete.sets.push(OrderedSet {
                            neighbours,
                            columns: vec![i],
                        }),
                    }
                }
            }
        }
        self.check_columns(blocks);
    }

    /// Bounds and levels that no solver can take are errors.
    fn check_columns(&mut self, blocks: &Blocks) {
        for i in 0..self.instance.columns.kind.len() {
            let (stored, up) = (
                self.instance.columns.lower[i],
                self.instance.columns.upper[i],
            );
            // that of a semicontinuous column stands elsewhere
            let thresholds = &self.instance.discrete.thresholds;
            let threshold = thresholds.binary_search_by_key(&(i as u32), |t| t.0);
            let lo = threshold.map_or(stored, |k| thresholds[k].1);
            let level = self.instance.columns.level[i];
            let name = || self.m.origin_name(blocks, i);
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
                let kind = self.instance.columns.kind[i];
                let declared = &self.m.symbols.get(blocks.of(i as u32).symbol).kind;
                let binary = matches!(declared, SymbolKind::Variable(VariableKind::Binary));
                broken_kind(kind, binary, lo, up)
                    .map(|rule| format!("{rule}: {} has {lo} … {up}", name()))
            };
            if let Some(message) = problem {
                Diagnostic::execution("E0413", self.m.options.at.get())
                    .says(message)
                    .label("at this solve")
                    .help("check the assignments to `.lo`, `.up`, `.fx` and `.l`")
                    .note(self.m);
                self.failed = true;
            }
            let scale = self.instance.columns.scale[i];
            if !is_scale(scale) {
                self.bad_scale(&name(), scale);
            }
        }
    }

    /// An error for a scale that rows and columns cannot be divided by.
    pub(super) fn bad_scale(&mut self, name: &str, scale: f64) {
        let message = format!("the scale of {name} must be a number above 1e-20, not {scale:e}");
        Diagnostic::execution("E0413", self.m.options.at.get())
            .says(message)
            .label("at this solve")
            .help("check the assignments to `.scale`")
            .note(self.m);
        self.failed = true;
    }

    /// Nonzeros, and nonlinear ones, as pairs of row and column.
    fn count(&self) -> (usize, usize) {
        let m = &self.instance.matrix;
        let places = self.instance.nonlinear_places();
        let is_linear_too = |&&(r, c): &&(u32, u32)| {
            let row = m.start[r as usize]..m.start[r as usize + 1];
            m.column[row].binary_search(&c).is_ok()
        };
        let both = places.iter().filter(is_linear_too).count();
        (m.column.len() + places.len() - both, places.len())
    }
}

/// Whether rows and columns can be scaled by it.
pub(super) fn is_scale(scale: f64) -> bool {
    scale > 1e-20 && scale.is_finite()
}

/// What bounds of a discrete variable must not be, relaxed or not.
fn broken_kind(kind: ColumnKind, binary: bool, lower: f64, upper: f64) -> Option<&'static str> {
    // As far as GAMS lets a bound be away from an integer.
    let whole = |x: f64| x.is_infinite() || (x - x.round()).abs() <= 1e-8;
    match kind {
        ColumnKind::Integer | ColumnKind::SemiInteger if !(whole(lower) && whole(upper)) => {
            Some("the bounds of a discrete variable must be integers")
        }
        ColumnKind::Integer if binary && (lower < -1e-8 || upper > 1.0 + 1e-8) => {
            Some("the bounds of a binary variable must be 0 or 1")
        }
        ColumnKind::SemiContinuous | ColumnKind::SemiInteger if lower < 0.0 => {
            Some("the lower bound of a semicontinuous variable must not be negative")
        }
        _ => None,
    }
}
