//! Results as Parquet files, for DuckDB, Polars and other readers.
//!
//! The bytes depend only on the manifest and the runs, not on the order of finishing. Each table is
//! a list of column definitions (`column.rs`). The table's file and metadata, and
//! `docs/reference/results.md`, are generated from this list.
mod about;
mod bonds;
mod column;
mod csv;
mod filled_table;
mod phases;
mod releases;
mod row;
mod runs;
mod tables;
mod unplanned;

pub use column::{ColumnDefinition, ColumnShape, ColumnValues, TableDefinition, TableShape};
pub use filled_table::FilledTable;
pub use row::setting_column;
pub(crate) use tables::write;
pub use tables::{each_row_group, table_metadata, tables, tables_of};
