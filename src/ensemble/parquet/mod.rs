//! Results as Parquet, for DuckDB, Polars and everything else that reads tables.
//!
//! The bytes depend on the manifest and the runs alone, whatever the order in which they finished.
mod bonds;
mod column;
mod runs;

pub(super) use bonds::bonds;
pub(super) use runs::runs;
