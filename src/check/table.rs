//! `table` declarations.

use super::data::{Familiar, Filling, Seen, lines_about};
use super::expansion::{Tuples, record_bytes, set_prefix};
use super::node::SymbolId;
use super::symbols::SymbolKind;
use super::{Checked, Compiler, Failed, MAX_ERRORS};
use crate::data::universe::Label;
use crate::data::value::truth;
use crate::diag::Diagnostic;
use crate::source::{Known, SourceMap, Span};
use crate::syntax::ast::{ParameterDecl, SetDecl, SymbolDecl, TableDecl, TableOf, VariableKind};
use crate::syntax::data::{KeyPart, Tail, width};
use crate::syntax::table::{Cell, PlainCell, TableItem, TableReader};

/// What the label of a row or column stands for.
#[derive(Default)]
enum Line {
    /// A label that may not stand there.
    Refused,
    /// One label at each position.
    Labels(Vec<Label>),
    /// Several.
    Many(Tuples),
    /// It defines a set, where a value stands.
    #[default]
    Open,
}

/// The labels of a table as far as it is read.
struct Lines {
    columns: Vec<Line>,
    /// Each of these columns stands for one label at each of its positions.
    single: bool,
    row: Line,
    /// All columns so far, and the rows since the last headings: none may come twice.
    headings: Seen,
    rows: Seen,
    key: Vec<Label>,
    values: Vec<f64>,
    familiar: Familiar,
    /// The positions whose sets the table defines.
    defines: Vec<bool>,
    filling: Filling,
    /// Where the symbol is named.
    name: Span,
    /// Room for the records of a cell.
    keys: Tuples,
}

impl Compiler {
    pub(super) fn declare_tables(&mut self, t: &TableDecl, map: &SourceMap) -> Checked<()> {
        for d in &t.symbols {
            let mut symbol = d.clone();
            match (symbol.data.take(), t.of) {
                (Some(body), of) => self.declare_table(of, &symbol, body, map)?,
                (None, TableOf::Set) => {
                    let singleton = false;
                    self.declare_sets(&[SetDecl { symbol, singleton }], map)?;
                }
                (None, TableOf::Variable(kind)) => self.declare_variables(kind, &[symbol], map)?,
                (None, TableOf::Parameter) => {
                    let scalar = false;
                    self.declare_parameters(&[ParameterDecl { symbol, scalar }], map)?;
                }
            }
        }
        Ok(())
    }

    fn declare_table(
        &mut self,
        of: TableOf,
        d: &SymbolDecl,
        body: Span,
        map: &SourceMap,
    ) -> Checked<()> {
        // A symbol that is declared already may get its values so.
        let declared = self.symbols.find(&d.name.name);
        let kind = match (of, declared.map(|s| &self.symbols.get(s).kind)) {
            (_, Some(kind @ SymbolKind::Set { .. })) => kind.clone(),
            (TableOf::Set, _) => SymbolKind::Set { singleton: false },
            (TableOf::Variable(kind), _) => return self.variable_table(kind, d, body, map),
            (_, Some(SymbolKind::Variable(_))) => {
                return self.variable_table(VariableKind::Unstated, d, body, map);
            }
            _ => SymbolKind::Parameter { scalar: false },
        };
        let s = self.declare(d, kind, |c, n| c.store.add_table(n, 0.0))?;
        let name = d.name.span;
        if self.take_input(s, name) {
            return Ok(());
        }
        let open = self.symbols.get(s).open;
        let filling = self.open_data(s, name)?;
        self.open_domains(s, name)?;
        if open {
            let mut reader = self.table_reader(body, 1, map);
            while let Some(item) = reader.next() {
                if let Ok(TableItem::Cell(c)) = item {
                    self.set_dimension(s, width(c.row) + width(c.column));
                    break;
                }
            }
        }
        let symbol = self.symbols.get(s).clone();
        let dim = symbol.dim();
        if dim < 2 {
            let of = &symbol.name;
            return Diagnostic::error("E0346", name)
                .says(format!(
                    "a table has rows and columns; `{of}` has {dim} index"
                ))
                .label("at least two index positions are needed")
                .help("use a `parameter` with a list instead")
                .fail(self);
        }
        let lines = Lines {
            columns: Vec::new(),
            single: false,
            row: Line::Open,
            headings: Seen::default(),
            rows: Seen::default(),
            key: Vec::new(),
            values: Vec::new(),
            familiar: Familiar::new(&self.symbols, s),
            defines: d.defines(),
            filling,
            name,
            keys: Tuples::default(),
        };
        self.fill_table(s, lines, body, map)?;
        self.store.table_mut(symbol.table).tidy();
        Ok(())
    }

    fn fill_table(
        &mut self,
        s: SymbolId,
        mut lines: Lines,
        body: Span,
        map: &SourceMap,
    ) -> Checked<()> {
        let symbol = self.symbols.get(s);
        let (dim, table) = (symbol.dim(), symbol.table);
        let mut reader = self.table_reader(body, dim, map);
        let text = map.text(body);
        let height = lines_about(text);
        let mut cells = Vec::new();
        loop {
            while lines.single
                && let Some(row) = reader.plain_row(&mut cells, |p, text| {
                    lines.defines.get(p) != Some(&true)
                        && lines.familiar.find(&mut self.store, p, text)
                })
            {
                self.fill_row(s, &mut lines, row, &cells)?;
            }
            let Some(item) = reader.next() else { break };
            match item {
                Ok(TableItem::Cell(cell)) => self.fill_cell(s, &mut lines, &cell)?,
                // Labels count even where nothing stands under or behind them: they are checked, and
                // take their place in the universe.
                Ok(TableItem::Headings) => {
                    // A value and the blank before it take two characters at least.
                    let cells = (height * reader.columns().count()).min(text.len() / 2);
                    self.store.table_mut(table).reserve(cells);
                    lines.columns.clear();
                    lines.rows = Seen::default();
                    let across = reader.columns().next().map_or(0, |(key, _)| width(key));
                    lines.single = across < dim;
                    for (key, span) in reader.columns() {
                        let at = dim.saturating_sub(width(key));
                        let line = self.table_line(s, at, key, lines.name);
                        let line = self.not_again(line, &mut lines.headings, span, "column");
                        lines.single &= width(key) == across
                            && matches!(&line, Line::Labels(l) if l.len() == across);
                        lines.columns.push(line);
                    }
                }
                Ok(TableItem::EmptyRow(key, span)) => {
                    let line = self.table_line(s, 0, key, lines.name);
                    self.not_again(line, &mut lines.rows, span, "row");
                }
                Err(d) => {
                    d.report(self);
                    if self.errors() >= MAX_ERRORS {
                        break;
                    }
                }
            }
        }
        Ok(())
    }

    /// A row that [`TableReader::plain_row`] has read.
    fn fill_row(
        &mut self,
        s: SymbolId,
        lines: &mut Lines,
        row: Span,
        cells: &[PlainCell],
    ) -> Checked<()> {
        let symbol = self.symbols.get(s);
        let (dim, table, is_set) = (symbol.dim(), symbol.table, symbol.is_set());
        let Some(Line::Labels(column)) = lines.columns.first() else {
            return Ok(());
        };
        let labels = &lines.familiar.key[..dim - column.len()];
        if lines.rows.again(labels) {
            self.comes_again(labels, row, "row");
            return Ok(());
        }
        self.take(cells.len(), record_bytes(dim), row)?;
        lines.key.clear();
        lines.values.clear();
        for cell in cells {
            let Line::Labels(column) = &lines.columns[cell.place] else {
                continue;
            };
            match (labels, &**column) {
                (&[row], &[column]) => {
                    lines.key.push(row);
                    lines.key.push(column);
                }
                _ => lines.key.extend(labels.iter().chain(column)),
            }
            let value = self.table_value(is_set, cell.value, cell.span);
            lines.values.push(value);
        }
        // Neither its row nor its column comes twice, so none of them does.
        self.store.tables[table as usize].set_all(&lines.key, &lines.values);
        Ok(())
    }

    /// What a value of a table is stored as.
    fn table_value(&self, is_set: bool, value: f64, span: Span) -> f64 {
        match is_set {
            true => f64::from(u8::from(truth(value))),
            false => self.stored(value, span),
        }
    }

    fn fill_cell(&mut self, s: SymbolId, lines: &mut Lines, cell: &Cell) -> Checked<()> {
        if cell.first {
            let row = self.table_line(s, 0, cell.row, lines.name);
            lines.row = self.not_again(row, &mut lines.rows, cell.row_span, "row");
        }
        let value = match cell.value {
            Tail::Number(v, _) => Some(v),
            Tail::Name(n, at) => self.acronym(n, at).ok(),
            _ => None,
        };
        let Some(value) = value else { return Ok(()) };
        let symbol = self.symbols.get(s);
        let (dim, table, is_set) = (symbol.dim(), symbol.table, symbol.is_set());
        let value = self.table_value(is_set, value, cell.span);
        match (&lines.row, lines.columns.get(cell.place)) {
            (Line::Refused, _) | (_, Some(Line::Refused)) => return Ok(()),
            (Line::Labels(row), Some(Line::Labels(column))) if row.len() + column.len() == dim => {
                self.take(1, record_bytes(dim), cell.span)?;
                lines.key.clear();
                row.iter().chain(column).for_each(|l| lines.key.push(*l));
                // Neither its row nor its column comes twice, so it does not.
                self.store.tables[table as usize].set(&lines.key, value);
                return Ok(());
            }
            _ => {}
        }
        let parts = [cell.row, cell.column].concat();
        if self.expand(s, &parts, cell.span, &mut lines.keys).is_err() {
            return Ok(());
        }
        for row in lines.keys.rows() {
            match is_set {
                true => self.store.table_mut(table).set(row.labels, value),
                false => self.put_value(&mut lines.filling, row.labels, value, cell.span),
            }
        }
        Ok(())
    }

    fn table_reader<'a>(&self, body: Span, dim: usize, map: &'a SourceMap) -> TableReader<'a> {
        TableReader::new(map.expanded(), body, dim, self.modes.at(body).undf).with_constants(self)
    }

    /// A table of a variable: the last label of each cell is an attribute.
    fn variable_table(
        &mut self,
        kind: VariableKind,
        d: &SymbolDecl,
        body: Span,
        map: &SourceMap,
    ) -> Checked<()> {
        self.declare_variables(kind, std::slice::from_ref(d), map)?;
        let s = self.lookup(&d.name)?;
        let dim = self.symbols.get(s).dim() + 1;
        let mut reader = self.table_reader(body, dim, map);
        while let Some(item) = reader.next() {
            match item {
                Ok(TableItem::Cell(cell)) => {
                    if let Tail::Number(v, _) = cell.value {
                        let key = [cell.row, cell.column].concat();
                        let _ = self.attribute_data(s, &key, v, cell.span);
                    }
                }
                Ok(TableItem::Headings | TableItem::EmptyRow(..)) => {}
                Err(d) => d.report(self),
            }
        }
        self.attributes_given(s);
        Ok(())
    }

    /// Looks up the label of a row or column that begins at an index position. A set that the table
    /// defines gets labels from values only.
    fn table_line(&mut self, s: SymbolId, position: usize, key: &[KeyPart], span: Span) -> Line {
        let spelled_out = set_prefix(key);
        let key = spelled_out.as_deref().unwrap_or(key);
        let ends = key.iter().scan(position, |at, part| {
            let from = *at;
            *at += width(std::slice::from_ref(part));
            Some((from, *at))
        });
        let opens = |c: &Self, (from, to)| (from..to).any(|p| c.defines(s, p));
        if !ends.clone().any(|place| opens(self, place)) {
            return match self.products(s, position, key, span) {
                Err(Failed) => Line::Refused,
                Ok(t) if t.len() == 1 => Line::Labels(t.labels),
                Ok(t) => Line::Many(t),
            };
        }
        for (part, place) in key.iter().zip(ends) {
            let part = std::slice::from_ref(part);
            if !opens(self, place) && self.products(s, place.0, part, span).is_err() {
                return Line::Refused;
            }
        }
        Line::Open
    }

    /// The labels of a row or column, refused if they came before.
    fn not_again(&mut self, line: Line, before: &mut Seen, at: Span, what: &str) -> Line {
        let (labels, width) = match &line {
            Line::Labels(l) => (l, l.len()),
            Line::Many(t) => (&t.labels, t.width),
            Line::Open | Line::Refused => return line,
        };
        // All of them have come now.
        let keys = labels.chunks_exact(width.max(1));
        let Some(key) = keys.filter(|key| before.again(key)).reduce(|_, last| last) else {
            return line;
        };
        self.comes_again(key, at, what);
        Line::Refused
    }

    fn comes_again(&mut self, key: &[Label], at: Span, what: &str) {
        let label = self.key_text(key);
        Diagnostic::error("E0341", at)
            .says(format!("the {what} {label} appears twice in this table"))
            .label("second time")
            .report(self);
    }
}
