//! Columns of `releases.parquet`.
use stochc_ir::record::ReleaseRecord;

use super::column::TableDefinition;
use super::row::{RunContext, RunRow, add_phase, add_ticks, keyed};
use crate::manifest::SweepAxes;

/// Row of the table of releases.
pub(super) struct ReleaseRow<'a> {
    release: &'a ReleaseRecord,
    is_aborted: bool,
}

/// Returns the releases of a run in order, then those of aborted attempts.
pub(super) fn releases(run: RunContext<'_>) -> impl Iterator<Item = ReleaseRow<'_>> {
    let row = |is_aborted| {
        move |release| ReleaseRow {
            release,
            is_aborted,
        }
    };
    let aborted = run.record.aborts.iter().flat_map(|it| &it.releases);
    let kept = run.record.releases.iter().map(row(false));
    kept.chain(aborted.map(row(true)))
}

pub(super) fn table<'a>(axes: &SweepAxes<'_>) -> TableDefinition<'a, RunRow<'a, ReleaseRow<'a>>> {
    let mut table = keyed("releases", "a block that was released", axes);
    add_phase(&mut table, |of: &ReleaseRow<'_>| of.release.phase);
    add_ticks(
        &mut table,
        "tick",
        "time of the release, from the start of the run",
        |row| row.item.release.tick,
    );
    table.text("parent", "role of the releasing block", |row| {
        row.run.program.role(row.item.release.parent)
    });
    table.text("child", "role of the released block", |row| {
        row.run.program.role(row.item.release.child)
    });
    table.integer("body", "number of the released block, from 0", |row| {
        u64::from(row.item.release.body)
    });
    table.truth(
        "aborted",
        "whether the release undoes an attempt at the phase that reached its timeout",
        |row| row.item.is_aborted,
    );
    table
}
