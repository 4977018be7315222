//! `table` declarations.

use super::expansion::{Tuples, set_prefix};
use super::node::SymbolId;
use super::symbols::SymbolKind;
use super::{Compiler, Failed, MAX_ERRORS};
use crate::data::value::truth;
use crate::diag::Diagnostic;
use crate::source::{Known, SourceMap, Span};
use crate::syntax::ast::{TableDecl, TableOf, VariableKind};
use crate::syntax::data::{KeyPart, Tail, width};
use crate::syntax::table::{TableItem, TableReader};

impl Compiler {
    pub(super) fn declare_table(&mut self, t: &TableDecl, map: &SourceMap) -> Result<(), Failed> {
        // A symbol that is declared already may get its values so.
        let declared = self.symbols.find(&t.symbol.name.name);
        let kind = match (t.of, declared.map(|s| &self.symbols.get(s).kind)) {
            (_, Some(kind @ SymbolKind::Set { .. })) => kind.clone(),
            (TableOf::Set, _) => SymbolKind::Set { singleton: false },
            (_, Some(SymbolKind::Variable(_))) | (TableOf::Variable(_), _) => {
                return self.variable_table(t, map);
            }
            _ => SymbolKind::Parameter { scalar: false },
        };
        let s = self.declare(&t.symbol, kind, |c, n| c.store.add_table(n, 0.0))?;
        let open = self.symbols.get(s).open;
        let name = t.symbol.name.span;
        let defines = t.symbol.defines();
        self.open_data(s, name)?;
        self.open_domains(s, &defines, name)?;
        if open {
            let mut reader = TableReader::new(map.expanded(), t.body, 1, self.modes.undf);
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
            return self.fail(
                Diagnostic::error(
                    "E0346",
                    name,
                    format!(
                        "a table has rows and columns; `{}` has {dim} index",
                        symbol.name
                    ),
                )
                .label("at least two index positions are needed")
                .help("use a `parameter` with a list instead"),
            );
        }
        let mut reader = TableReader::new(map.expanded(), t.body, dim, self.modes.undf);
        let (mut keys, mut parts) = (Tuples::default(), Vec::new());
        // Columns whose labels were refused.
        let mut refused: Vec<bool> = Vec::new();
        while let Some(item) = reader.next() {
            let cell = match item {
                Ok(TableItem::Cell(c)) => c,
                // Labels count even where nothing stands under or behind them: they are checked, and
                // take their place in the universe.
                Ok(TableItem::Headings) => {
                    refused.clear();
                    for key in reader.columns() {
                        let at = dim.saturating_sub(width(key));
                        let label = self.table_label(s, at, key, &defines, name);
                        refused.push(label.is_err());
                    }
                    continue;
                }
                Ok(TableItem::EmptyRow(key)) => {
                    let _ = self.table_label(s, 0, key, &defines, name);
                    continue;
                }
                Err(d) => {
                    self.report(d);
                    if self.errors() >= MAX_ERRORS {
                        break;
                    }
                    continue;
                }
            };
            if refused.get(cell.place) == Some(&true) {
                continue;
            }
            let value = match cell.value {
                Tail::Number(v, _) => v,
                Tail::Name(n, at) => match self.acronym(n, at) {
                    Ok(v) => v,
                    Err(_) => continue,
                },
                _ => continue,
            };
            parts.clear();
            parts.extend_from_slice(cell.row);
            parts.extend_from_slice(cell.column);
            if self
                .expand(s, &parts, None, cell.span, &defines, &mut keys)
                .is_err()
            {
                continue;
            }
            for (k, _) in keys.rows() {
                if !symbol.is_set() {
                    self.put_value(s, symbol.table, k, value, cell.span);
                } else {
                    let member = f64::from(u8::from(truth(value)));
                    self.store.table_mut(symbol.table).set(k, member);
                }
            }
        }
        self.store.table_mut(symbol.table).tidy();
        Ok(())
    }

    /// A table of a variable: the last label of each cell is an attribute.
    fn variable_table(&mut self, t: &TableDecl, map: &SourceMap) -> Result<(), Failed> {
        let kind = match t.of {
            TableOf::Variable(kind) => kind,
            _ => VariableKind::Unstated,
        };
        self.declare_variables(kind, std::slice::from_ref(&t.symbol), map)?;
        let s = self.lookup(&t.symbol.name)?;
        let dim = self.symbols.get(s).dim() + 1;
        let mut reader = TableReader::new(map.expanded(), t.body, dim, self.modes.undf);
        while let Some(item) = reader.next() {
            match item {
                Ok(TableItem::Cell(cell)) => {
                    if let Tail::Number(v, _) = cell.value {
                        let key = [cell.row, cell.column].concat();
                        let _ = self.attribute_data(s, &key, v, cell.span);
                    }
                }
                Ok(TableItem::Headings | TableItem::EmptyRow(_)) => {}
                Err(d) => self.report(d),
            }
        }
        self.attributes_given(s);
        Ok(())
    }

    /// Checks the label of a row or column that begins at an index position. A set that the table
    /// defines gets labels from values only.
    fn table_label(
        &mut self,
        s: SymbolId,
        position: usize,
        key: &[KeyPart],
        defines: &[bool],
        span: Span,
    ) -> Result<(), Failed> {
        let spelled_out = set_prefix(key);
        let mut at = position;
        for part in spelled_out.as_deref().unwrap_or(key) {
            let part = std::slice::from_ref(part);
            let end = at + width(part);
            if !defines.iter().take(end).skip(at).any(|&d| d) {
                self.products(s, at, part, span, &[])?;
            }
            at = end;
        }
        Ok(())
    }
}
