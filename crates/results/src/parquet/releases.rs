//! Columns of `releases.parquet`.
use stochc_ir::record::ReleaseRecord;

use super::column::TableDefinition;
use super::row::{RunRow, add_phase, add_ticks, keyed};
use crate::manifest::SweepAxes;

pub(super) fn table<'a>(
    axes: &SweepAxes<'_>,
) -> TableDefinition<'a, RunRow<'a, &'a ReleaseRecord>> {
    let mut table = keyed("releases", "a block that was released", axes);
    add_phase(&mut table, |of: &&ReleaseRecord| of.phase);
    add_ticks(
        &mut table,
        "tick",
        "time of the release, from the start of the run",
        |row| row.item.tick,
    );
    table.text("parent", "role of the releasing block", |row| {
        row.run.program.role(row.item.parent)
    });
    table.text("child", "role of the released block", |row| {
        row.run.program.role(row.item.child)
    });
    table.integer("body", "number of the released block, from 0", |row| {
        u64::from(row.item.body)
    });
    table
}
