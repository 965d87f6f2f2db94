//! Tables as comma-separated values (RFC 4180), from the same definitions as Parquet files.
use stochc_files::csv::CsvTable;

use super::column::ColumnValues;
use super::filled_table::FilledTable;

impl FilledTable<'_> {
    /// Returns the table as comma-separated values. A null value is an empty cell.
    pub fn csv(&self) -> String {
        let mut table = CsvTable::new(self.shape.columns.iter().map(|column| &column.name));
        let rows = self.values.first().map_or(0, ColumnValues::len);
        for row in 0..rows {
            table.row(self.values.iter().map(|column| column.cell(row)));
        }
        table.finish()
    }
}

fn or_empty<T: ToString>(value: Option<&T>) -> String {
    value.map_or(String::new(), ToString::to_string)
}

fn list<T: ToString>(values: &[T]) -> String {
    let texts: Vec<String> = values.iter().map(ToString::to_string).collect();
    texts.join(" ")
}

impl ColumnValues<'_> {
    fn len(&self) -> usize {
        match self {
            ColumnValues::Bool(values) => values.len(),
            ColumnValues::Int32(values) => values.len(),
            ColumnValues::Int64(values) => values.len(),
            ColumnValues::UInt64(values) => values.len(),
            ColumnValues::Float64(values) => values.len(),
            ColumnValues::Text(values) => values.len(),
            ColumnValues::Int64Lists(values) => values.len(),
            ColumnValues::TextLists(values) => values.len(),
        }
    }

    fn cell(&self, row: usize) -> String {
        match self {
            ColumnValues::Bool(values) => or_empty(values[row].as_ref()),
            ColumnValues::Int32(values) => or_empty(values[row].as_ref()),
            ColumnValues::Int64(values) => or_empty(values[row].as_ref()),
            ColumnValues::UInt64(values) => or_empty(values[row].as_ref()),
            ColumnValues::Float64(values) => or_empty(values[row].as_ref()),
            ColumnValues::Text(values) => or_empty(values[row].as_ref()),
            ColumnValues::Int64Lists(values) => list(&values[row]),
            ColumnValues::TextLists(values) => list(&values[row]),
        }
    }
}
