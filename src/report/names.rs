//! Names of rows and columns, made when asked for.

/// Maps rows and columns of an instance back to the symbols and labels they came from.
pub trait Names {
    /// Symbol and labels of a row.
    fn row_parts(&self, row: usize) -> (String, Vec<String>);
    /// Symbol and labels of a column.
    fn column_parts(&self, column: usize) -> (String, Vec<String>);

    /// `equil('b3','x')`
    fn row(&self, row: usize) -> String {
        let (symbol, labels) = self.row_parts(row);
        join(&symbol, &labels)
    }

    /// `x('c1','n')`
    fn column(&self, column: usize) -> String {
        let (symbol, labels) = self.column_parts(column);
        join(&symbol, &labels)
    }
}

/// A symbol with its labels as one writes them.
pub fn join(symbol: &str, labels: &[String]) -> String {
    if labels.is_empty() {
        return symbol.to_string();
    }
    let quoted: Vec<String> = labels
        .iter()
        .map(|l| match l.contains('\'') {
            true => format!("\"{l}\""),
            false => format!("'{l}'"),
        })
        .collect();
    format!("{symbol}({})", quoted.join(","))
}
