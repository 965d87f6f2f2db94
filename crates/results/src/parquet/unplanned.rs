//! Columns of `unplanned.parquet`.
use stochc_ir::record::UnplannedRecord;

use super::column::TableDefinition;
use super::row::{RunRow, add_phase, add_ticks, keyed};
use crate::manifest::SweepAxes;

pub(super) fn table<'a>(
    axes: &SweepAxes<'_>,
) -> TableDefinition<'a, RunRow<'a, &'a UnplannedRecord>> {
    let mut table = keyed(
        "unplanned",
        "a block that docked on a face that expected no block, and was rejected (`bond reject`)",
        axes,
    );
    add_phase(&mut table, |of: &&UnplannedRecord| of.phase);
    add_ticks(
        &mut table,
        "tick",
        "time of the docking, from the start of the run",
        |row| row.item.tick,
    );
    table.text("parent", "role of the block with this face", |row| {
        row.run.program.role(row.item.parent)
    });
    table.text(
        "face",
        "face of that block, in the structure's frame",
        |row| row.item.face.word(),
    );
    table.integer("body", "number of the block that docked, from 0", |row| {
        u64::from(row.item.body)
    });
    table
}
