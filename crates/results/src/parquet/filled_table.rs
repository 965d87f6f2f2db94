//! Tables with their values in memory.
use super::column::{ColumnValues, TableDefinition, TableShape};

/// A table with its values, column by column.
#[derive(Clone, Debug, PartialEq)]
pub struct FilledTable<'a> {
    /// Description of the table.
    pub shape: TableShape,
    /// Values, column by column.
    pub values: Vec<ColumnValues<'a>>,
}

impl<'a, R> TableDefinition<'a, R> {
    /// Returns the table with the values of these rows.
    pub fn filled(&self, rows: &[R]) -> FilledTable<'a> {
        let columns = self.columns.iter();
        FilledTable {
            shape: self.shape(),
            values: columns.map(|column| column.values(rows)).collect(),
        }
    }
}
