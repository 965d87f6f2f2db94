//! Columns of `bonds.parquet`.
use stochc_ir::Cell;
use stochc_ir::record::{BondRecord, Origin, WaitRecord};
use stochc_ir::table::{PhaseId, RoleId};

use super::column::TableDefinition;
use super::row::{RunContext, RunRow, add_phase, keyed};
use crate::manifest::SweepAxes;

/// Condition for nulls in the columns about the captured block.
const CENSORED: &str = "the waiting time is censored";

/// Row of the table of bonds.
#[derive(Clone, Copy)]
pub(super) struct BondRow<'a> {
    wait: Wait<'a>,
    /// End of the run or of the aborted attempt \[ticks\].
    end: u64,
    is_aborted: bool,
}

/// A capture, or a waiting time in progress at the end of the run or of an aborted attempt.
#[derive(Clone, Copy)]
enum Wait<'a> {
    Docked(&'a BondRecord),
    Waiting(&'a WaitRecord),
}

/// Returns the captures of a run in order and the waiting times in progress, then those of aborted
/// attempts.
pub(super) fn bonds(run: RunContext<'_>) -> impl Iterator<Item = BondRow<'_>> {
    let record = run.record;
    let aborted = record.aborts.iter();
    let aborted = aborted.map(|it| (&it.bonds, &it.waiting, it.tick, true));
    let attempts = [(&record.bonds, &record.waiting, record.ticks, false)].into_iter();
    (attempts.chain(aborted)).flat_map(|(bonds, waiting, end, is_aborted)| {
        let docked = bonds.iter().map(Wait::Docked);
        let waits = docked.chain(waiting.iter().map(Wait::Waiting));
        waits.map(move |wait| BondRow {
            wait,
            end,
            is_aborted,
        })
    })
}

/// Returns a field that both variants of [`Wait`] have.
macro_rules! both {
    ($row:expr, $field:ident) => {
        match $row.wait {
            Wait::Docked(bond) => bond.$field,
            Wait::Waiting(wait) => wait.$field,
        }
    };
}

impl<'a> BondRow<'a> {
    fn phase(self) -> PhaseId {
        both!(self, phase)
    }

    fn parent(self) -> RoleId {
        both!(self, parent)
    }

    fn child(self) -> RoleId {
        both!(self, child)
    }

    fn cell(self) -> Cell {
        both!(self, cell)
    }

    fn docked(self) -> Option<&'a BondRecord> {
        match self.wait {
            Wait::Docked(bond) => Some(bond),
            Wait::Waiting(_) => None,
        }
    }

    /// Returns the ticks from switching the face on to the capture, or to the end of the attempt.
    fn wait(self) -> u64 {
        let docked = self.docked().map(|bond| bond.docked);
        docked
            .unwrap_or(self.end)
            .saturating_sub(both!(self, magnetized))
    }

    /// Returns the former role of the captured block and the tick of its release. Returns `None` if
    /// it had no role before.
    fn released(self) -> Option<(RoleId, u64)> {
        match self.docked()?.origin {
            Origin::Free => None,
            Origin::Released { role, tick } => Some((role, tick)),
        }
    }
}

pub(super) fn table<'a>(axes: &SweepAxes<'_>) -> TableDefinition<'a, RunRow<'a, BondRow<'a>>> {
    let mut table = keyed(
        "bonds",
        "a capture, or a face that waited for one when the run or an attempt ended",
        axes,
    );
    add_phase(&mut table, |of: &BondRow<'a>| of.phase());
    table.text(
        "parent",
        "role of the block that magnetized a face",
        |row| row.run.program.role(row.item.parent()),
    );
    table.text("face", "magnetized face, in the structure's frame: `up`, `down`, `north`, `south`, `east` or `west`", |row| both!(row.item, face).word());
    table.text("child", "role that the captured block gets", |row| {
        row.run.program.role(row.item.child())
    });
    table
        .small("x", "cell of the child: position to the east", |row| {
            row.item.cell().x
        })
        .unit("block lengths");
    table
        .small("y", "position to the north", |row| row.item.cell().y)
        .unit("block lengths");
    table
        .small("z", "height; the plate is at 0", |row| row.item.cell().z)
        .unit("block lengths");
    table
        .integer(
            "magnetized",
            "time when the face was magnetized, from the start of the run",
            |row| both!(row.item, magnetized),
        )
        .unit("ticks");
    table
        .integer(
            "docked",
            "time when the block docked, from the start of the run",
            |row| row.item.docked().map(|bond| bond.docked),
        )
        .unit("ticks")
        .null(CENSORED);
    table
        .real(
            "docked_seconds",
            "`docked` in seconds of the scene",
            |row| row.item.docked().map(|bond| row.run.seconds(bond.docked)),
        )
        .unit("s")
        .null(CENSORED);
    table
        .integer(
            "wait",
            "waiting time: from `magnetized` to `docked`; if it is censored, to the end of the run or attempt",
            |row| row.item.wait(),
        )
        .unit("ticks");
    table
        .real("wait_seconds", "`wait` in seconds of the scene", |row| {
            row.run.seconds(row.item.wait())
        })
        .unit("s");
    table.truth(
        "censored",
        "whether the run or attempt ended before the block docked; the waiting time is then a lower bound",
        |row| row.item.docked().is_none(),
    );
    table.truth(
        "aborted",
        "whether the row belongs to an attempt at the phase that reached its timeout and was undone",
        |row| row.item.is_aborted,
    );
    add_capture(&mut table);
    table
}

/// Adds the columns about the captured block.
fn add_capture<'a>(table: &mut TableDefinition<'a, RunRow<'a, BondRow<'a>>>) {
    table.integer(
        "entries",
        "number of times that a free block entered the reach of the pull, re-entries included",
        |row| u64::from(both!(row.item, entries)),
    );
    table
        .integer(
            "docking",
            "time from the last entry of the captured block to its docking",
            |row| row.item.docked().map(|bond| bond.docking),
        )
        .unit("ticks")
        .null(CENSORED);
    table
        .integer("body", "number of the captured block, from 0", |row| {
            row.item.docked().map(|bond| bond.body.into())
        })
        .null(CENSORED);
    table.text("origin", "`free`: the captured block had never been captured before; `released`: the block had been captured and released \
             before", |row| {
                Some(match row.item.docked()?.origin {
                    Origin::Free => "free",
                    Origin::Released { .. } => "released",
                })
            }).null(CENSORED);
    table
        .text("origin_role", "last role of the captured block", |row| {
            let (role, _) = row.item.released()?;
            Some(row.run.program.role(role))
        })
        .null("the block had no role before, or the waiting time is censored");
    table
        .integer("released_at", "time when the block lost that role", |row| {
            row.item.released().map(|(_, tick)| tick)
        })
        .unit("ticks")
        .null("the block had no role before, or the waiting time is censored");
}
