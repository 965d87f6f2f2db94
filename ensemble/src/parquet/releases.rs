//! `releases.parquet`.
use stochc_ir::record::ReleaseRecord;

use super::column::{Column, Table, integer, text};
use super::row::{Row, key, phase};
use crate::Varied;

pub(super) fn table<'a>(axes: &[Varied]) -> Table<'a, Row<'a, &'a ReleaseRecord>> {
    type R<'a> = Row<'a, &'a ReleaseRecord>;
    let mut columns = key(axes);
    columns.extend(phase(|release: &&ReleaseRecord| release.phase));
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
            "role of the block that let it go",
            text(|row: &R<'a>| row.run.program.role(row.of.parent)),
        ),
        Column::new(
            "child",
            "",
            "role that the released block had",
            text(|row: &R<'a>| row.run.program.role(row.of.child)),
        ),
        Column::new(
            "body",
            "",
            "number of the released block, from 0",
            integer(|row: &R<'a>| u64::from(row.of.body)),
        ),
    ]);
    Table {
        name: "releases",
        row: "a block that was released",
        columns,
    }
}
