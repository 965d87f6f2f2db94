//! Results as Parquet, for DuckDB, Polars and everything else that reads tables.
//!
//! The bytes depend on the manifest and the runs alone, whatever the order in which they finished. Each
//! table is a list of column definitions (`column.rs`), from which its file, its metadata and
//! `docs/results.md` are made.
mod about;
mod bonds;
mod column;
mod phases;
mod releases;
mod row;
mod runs;
mod unplanned;

pub use column::{ColumnShape, TableShape};

use super::{Finished, Manifest};
use row::rows;

/// The tables of runs that are sorted by program and run: the names of their files, and the bytes.
pub(super) fn files(manifest: &Manifest, finished: &[Finished]) -> Vec<(String, Vec<u8>)> {
    let about = about::about(manifest);
    let axes = manifest.axes();
    macro_rules! file {
        ($table:ident, $of:expr) => {{
            let table = $table::table(axes);
            let rows = rows(manifest, finished, $of);
            (format!("{}.parquet", table.name), table.file(&rows, &about))
        }};
    }
    vec![
        file!(runs, |_| [()]),
        file!(phases, phases::reached),
        file!(bonds, bonds::bonds),
        file!(releases, |run| &run.record.releases),
        file!(unplanned, |run| &run.record.unplanned_bonds),
    ]
}

/// What the tables of a results folder are; those of a sweep have further columns.
pub fn tables() -> Vec<TableShape> {
    vec![
        runs::table(&[]).shape(),
        phases::table(&[]).shape(),
        bonds::table(&[]).shape(),
        releases::table(&[]).shape(),
        unplanned::table(&[]).shape(),
    ]
}
