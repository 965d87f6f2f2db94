//! `releases.parquet`.
use stochc_ir::record::ReleaseRecord;

use super::column::{ColumnDefinition, TableDefinition, integer, real, text};
use super::row::{RunRow, key, phase};
use crate::manifest::SweepAxes;

pub(super) fn table<'a>(
    axes: &SweepAxes<'_>,
) -> TableDefinition<'a, RunRow<'a, &'a ReleaseRecord>> {
    type R<'a> = RunRow<'a, &'a ReleaseRecord>;
    let mut columns = key(axes);
    columns.extend(phase(|release: &&ReleaseRecord| release.phase));
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
            "role of the block that released it",
            text(|row: &R<'a>| row.run.program.role(row.of.parent)),
        ),
        ColumnDefinition::new(
            "child",
            "",
            "role that the released block had",
            text(|row: &R<'a>| row.run.program.role(row.of.child)),
        ),
        ColumnDefinition::new(
            "body",
            "",
            "number of the released block, from 0",
            integer(|row: &R<'a>| u64::from(row.of.body)),
        ),
    ]);
    TableDefinition {
        name: "releases",
        row: "a block that was released",
        columns,
    }
}
