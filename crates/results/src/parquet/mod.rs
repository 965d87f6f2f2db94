//! Results as Parquet, for DuckDB, Polars and everything else that reads tables.
//!
//! The bytes depend on the manifest and the runs alone, whatever the order in which they finished. Each
//! table is a list of column definitions (`column.rs`), from which its file, its metadata and
//! `docs/reference/results.md` are made.
mod about;
mod bonds;
mod column;
mod csv;
mod filled_table;
mod phases;
mod releases;
mod row;
mod runs;
mod unplanned;

pub use column::{ColumnDefinition, ColumnShape, ColumnValues, TableDefinition, TableShape};
pub use filled_table::FilledTable;
pub use row::setting_column;

use std::io::{self, Write};

use ::parquet::errors::ParquetError;

use super::manifest::SweepAxes;
use super::{Finished, FolderError, JournalError, Manifest, Records};
use row::rows;

/// Captures, releases, phases and whatever else is in one row group of each table, with some more at its end: what is in memory
/// while tables are written.
const GROUP: usize = 1 << 17;

/// The tables: the number of each, its columns, and what its rows are in a run.
macro_rules! for_each_table {
    ($do:ident) => {
        $do!(0, runs, |_| [()]);
        $do!(1, phases, phases::reached);
        $do!(2, bonds, bonds::bonds);
        $do!(3, releases, |run| &run.record.releases);
        $do!(4, unplanned, |run| &run.record.unplanned_bonds);
    };
}

/// Writes the tables of runs into what `begin` gives for the name of each file; `io` says where something went wrong.
pub(crate) fn write<W: Write + Send>(
    manifest: &Manifest,
    finished: &Records,
    begin: impl Fn(&str) -> io::Result<W>,
    io: impl Fn(io::Error) -> FolderError,
) -> Result<Vec<(String, W)>, FolderError> {
    let about = about::about(manifest);
    let axes = &manifest.swept();
    let mut files = Vec::new();
    macro_rules! begin_file {
        ($number:expr, $table:ident, $of:expr) => {
            let table = $table::table(axes);
            let name = format!("{}.parquet", table.name);
            let out = begin(&name).map_err(&io)?;
            let file = table.begin(out, &about);
            files.push((name, file.map_err(|error| io(plain(error)))?));
        };
    }
    for_each_table!(begin_file);
    let mut add = |group: &[Finished], is_last: bool| -> Result<(), ParquetError> {
        macro_rules! add_rows {
            ($number:expr, $table:ident, $of:expr) => {
                let rows = rows(manifest, group, $of);
                let file = &mut files[$number].1;
                // A table without rows has a group without rows.
                if !rows.is_empty() || is_last && file.is_empty() {
                    file.add(&$table::table(axes), &rows)?;
                }
            };
        }
        for_each_table!(add_rows);
        Ok(())
    };
    each_group(finished, |group, is_last| {
        add(group, is_last).map_err(|error| io(plain(error)))
    })?;
    let files = files.into_iter();
    let files = files.map(|(name, file)| Ok((name, file.finish()?)));
    let files: Result<_, ParquetError> = files.collect();
    files.map_err(|error| io(plain(error)))
}

/// Shows runs group by group, and which group is the last one; there is one at least.
fn each_group<E: From<JournalError>>(
    finished: &Records,
    mut show: impl FnMut(&[Finished], bool) -> Result<(), E>,
) -> Result<(), E> {
    let (mut group, mut size) = (Vec::new(), 0);
    finished.try_take_each(|done| {
        let record = &done.record;
        let parts = [
            record.phase_ticks.len(),
            record.bonds.len(),
            record.waiting.len(),
            record.releases.len(),
            record.unplanned_bonds.len(),
        ];
        size += 1 + parts.iter().sum::<usize>();
        group.push(done.into_owned());
        if size >= GROUP {
            show(&group, false)?;
            (group, size) = (Vec::new(), 0);
        }
        Ok::<(), E>(())
    })?;
    show(&group, true)
}

/// Shows what the columns of a table hold, group by group of its rows, as they are written into its file; one group
/// at least. `table` is its number among [`tables`].
///
/// # Errors
/// Those of `show`, and where the runs cannot be read again.
pub fn each_row_group<E: From<JournalError>>(
    (manifest, finished): (&Manifest, &Records),
    table: usize,
    mut show: impl FnMut(Vec<ColumnValues<'_>>) -> Result<(), E>,
) -> Result<(), E> {
    let axes = &manifest.swept();
    each_group(finished, |group, _| {
        macro_rules! show_rows {
            ($number:expr, $table:ident, $of:expr) => {
                if table == $number {
                    let (rows, table) = (rows(manifest, group, $of), $table::table(axes));
                    let columns = table.columns.iter();
                    show(columns.map(|column| column.values(&rows)).collect())?;
                }
            };
        }
        for_each_table!(show_rows);
        Ok(())
    })
}

/// What the files of these tables say of their ensemble, as pairs of keys and values.
pub fn table_metadata(manifest: &Manifest) -> Vec<(&'static str, String)> {
    about::about(manifest)
}

/// What the file system has said.
fn plain(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(error) => match error.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(error) => io::Error::other(error),
        },
        error => io::Error::other(error),
    }
}

/// What the tables of a results folder are; those of a sweep have further columns.
pub fn tables() -> Vec<TableShape> {
    shapes(&SweepAxes::default())
}

/// What the tables of an ensemble are.
pub fn tables_of(manifest: &Manifest) -> Vec<TableShape> {
    shapes(&manifest.swept())
}

fn shapes(axes: &SweepAxes<'_>) -> Vec<TableShape> {
    let mut shapes = Vec::new();
    macro_rules! shape {
        ($number:expr, $table:ident, $of:expr) => {
            shapes.push($table::table(axes).shape());
        };
    }
    for_each_table!(shape);
    shapes
}
