//! All tables, with functions that write them as Parquet or return them in row groups.
use std::io;
use std::io::Write;

use ::parquet::errors::ParquetError;

use super::column::{ColumnValues, TableShape};
use super::row::rows;
use super::{about, bonds, phases, releases, runs, unplanned};
use crate::manifest::SweepAxes;
use crate::{Finished, FolderError, JournalError, Manifest, Records};

/// Approximate number of captures, releases, phases and other rows per row group. Limits the memory
/// for writing tables.
pub(super) const GROUP: usize = 1 << 17;

/// Calls the macro `$do` for each table. The arguments are the table's index, its module, and a
/// function that returns the rows of a run.
macro_rules! for_each_table {
    ($do:ident) => {
        $do!(0, runs, |_| [()]);
        $do!(1, phases, phases::reached);
        $do!(2, bonds, bonds::bonds);
        $do!(3, releases, releases::releases);
        $do!(4, unplanned, |run| &run.record.unplanned_bonds);
    };
}

/// Writes all tables of the runs. `begin` creates the output for a table name. `io` converts errors
/// of the file system. Returns the outputs with the names of their tables.
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
                // A table without rows gets one empty row group.
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

/// Divides the runs into groups, one for each row group of the tables. Calls `show` for each group,
/// at least once. The second argument states whether the group is the last.
fn each_group<E: From<JournalError>>(
    finished: &Records,
    mut show: impl FnMut(&[Finished], bool) -> Result<(), E>,
) -> Result<(), E> {
    let (mut group, mut size) = (Vec::new(), 0);
    finished.try_take_each(|done| {
        let record = &done.record;
        let parts = [
            record.phase_ticks.len(),
            record.all_bonds().count(),
            record.all_waiting().count(),
            record.all_releases().count(),
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

/// Calls `show` with the columns of a table, once per row group of its file and at least once.
/// `table` is the index in [`tables`].
///
/// # Errors
///
/// Errors of `show`, and of reading the runs.
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

/// Returns the metadata of table files about their ensemble, as pairs of keys and values.
pub fn table_metadata(manifest: &Manifest) -> Vec<(&'static str, String)> {
    about::about(manifest)
}

/// Converts a Parquet error to an error of the file system.
pub(super) fn plain(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(error) => match error.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(error) => io::Error::other(error),
        },
        error => io::Error::other(error),
    }
}

/// Returns the descriptions of the tables of a results folder without a sweep. A sweep adds
/// columns.
pub fn tables() -> Vec<TableShape> {
    shapes(&SweepAxes::default())
}

/// Returns the descriptions of the tables of an ensemble, including the columns of a sweep.
pub fn tables_of(manifest: &Manifest) -> Vec<TableShape> {
    shapes(&manifest.swept())
}

pub(super) fn shapes(axes: &SweepAxes<'_>) -> Vec<TableShape> {
    let mut shapes = Vec::new();
    macro_rules! shape {
        ($number:expr, $table:ident, $of:expr) => {
            shapes.push($table::table(axes).shape());
        };
    }
    for_each_table!(shape);
    shapes
}
