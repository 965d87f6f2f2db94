//! `unplanned.parquet`.
use stochc_ir::record::UnplannedRecord;

use super::column::{ColumnDefinition, TableDefinition, integer, real, text};
use super::row::{RunRow, key, phase};
use crate::manifest::SweepAxes;

pub(super) fn table<'a>(
    axes: &SweepAxes<'_>,
) -> TableDefinition<'a, RunRow<'a, &'a UnplannedRecord>> {
    type R<'a> = RunRow<'a, &'a UnplannedRecord>;
    let mut columns = key(axes);
    columns.extend(phase(|bond: &&UnplannedRecord| bond.phase));
    columns.extend([
        ColumnDefinition::new(
            "tick",
            "ticks",
            "when, from the beginning of the run",
            integer(|row: &R<'a>| row.of.tick),
        ),
        ColumnDefinition::new(
            "seconds",
            "s",
            "the same in seconds of the scene",
            real(|row: &R<'a>| row.run.seconds(row.of.tick)),
        ),
        ColumnDefinition::new(
            "parent",
            "",
            "role of the block that it docked on",
            text(|row: &R<'a>| row.run.program.role(row.of.parent)),
        ),
        ColumnDefinition::new(
            "face",
            "",
            "face of that block, in the structure's frame",
            text(|row: &R<'a>| row.of.face.word()),
        ),
        ColumnDefinition::new(
            "body",
            "",
            "number of the block that docked, from 0",
            integer(|row: &R<'a>| u64::from(row.of.body)),
        ),
    ]);
    TableDefinition {
        name: "unplanned",
        row: "a block that docked on a face that expected none, and was rejected at once (`bond reject`)",
        columns,
    }
}
