//! `unplanned.parquet`.
use stochc_ir::record::UnplannedRecord;

use super::column::{Column, Table, integer, text};
use super::row::{Row, key, phase};
use crate::Varied;

pub(super) fn table<'a>(axes: &[Varied]) -> Table<'a, Row<'a, &'a UnplannedRecord>> {
    type R<'a> = Row<'a, &'a UnplannedRecord>;
    let mut columns = key(axes);
    columns.extend(phase(|bond: &&UnplannedRecord| bond.phase));
    columns.extend([
        Column::new(
            "tick",
            "ticks",
            "when, from the beginning of the run",
            integer(|row: &R<'a>| row.of.tick),
        ),
        Column::new(
            "parent",
            "",
            "role of the block on which it docked",
            text(|row: &R<'a>| row.run.program.role(row.of.parent)),
        ),
        Column::new(
            "face",
            "",
            "on which of its faces, in the structure's frame",
            text(|row: &R<'a>| row.of.face.word()),
        ),
        Column::new(
            "body",
            "",
            "number of the block that docked, from 0",
            integer(|row: &R<'a>| u64::from(row.of.body)),
        ),
    ]);
    Table {
        name: "unplanned",
        row: "a block that docked where none was expected, and was rejected at once (`bond reject`)",
        columns,
    }
}
