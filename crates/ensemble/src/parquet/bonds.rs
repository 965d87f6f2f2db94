//! `bonds.parquet`.
use stochc_ir::Cell;
use stochc_ir::record::{BondRecord, Origin, WaitRecord};
use stochc_ir::table::{PhaseId, RoleId};

use super::column::{ColumnDefinition, TableDefinition, integer, real, small, text, truth};
use super::row::{RunContext, RunRow, key, phase};
use crate::manifest::SweepAxes;

/// When what a row says of the captured block is null.
const CENSORED: &str = "the wait is censored";

/// A capture, or one that was waited for when the run ended.
#[derive(Clone, Copy)]
pub(super) enum BondRow<'a> {
    Docked(&'a BondRecord),
    Waiting(&'a WaitRecord),
}

/// The captures of a run in the order of docking, then what was under way.
pub(super) fn bonds(run: RunContext<'_>) -> impl Iterator<Item = BondRow<'_>> {
    let docked = run.record.bonds.iter().map(BondRow::Docked);
    docked.chain(run.record.waiting.iter().map(BondRow::Waiting))
}

/// What both kinds have.
macro_rules! both {
    ($bond:expr, $field:ident) => {
        match $bond {
            BondRow::Docked(bond) => bond.$field,
            BondRow::Waiting(wait) => wait.$field,
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
        match self {
            BondRow::Docked(bond) => Some(bond),
            BondRow::Waiting(_) => None,
        }
    }

    /// Returns the ticks from the magnetizing to the docking, or to the end of the run.
    fn wait(self, run: RunContext<'_>) -> u64 {
        let docked = self.docked().map(|bond| bond.docked);
        let end = docked.unwrap_or(run.record.ticks);
        end.saturating_sub(both!(self, magnetized))
    }

    /// The role that the captured block had before, and when it lost it.
    fn released(self) -> Option<(RoleId, u64)> {
        match self.docked()?.origin {
            Origin::Free => None,
            Origin::Released { role, tick } => Some((role, tick)),
        }
    }
}

pub(super) fn table<'a>(axes: &SweepAxes<'_>) -> TableDefinition<'a, RunRow<'a, BondRow<'a>>> {
    type R<'a> = RunRow<'a, BondRow<'a>>;
    let mut columns = key(axes);
    columns.extend(phase(|bond: &BondRow<'a>| bond.phase()));
    columns.extend([
        ColumnDefinition::new(
            "parent",
            "",
            "role of the block that magnetized a face",
            text(|row: &R<'a>| row.run.program.role(row.of.parent())),
        ),
        ColumnDefinition::new(
            "face",
            "",
            "which of its faces, in the structure's frame: `up`, `down`, `north`, `south`, `east` or `west`",
            text(|row: &R<'a>| both!(row.of, face).word()),
        ),
        ColumnDefinition::new(
            "child",
            "",
            "role that the captured block is given",
            text(|row: &R<'a>| row.run.program.role(row.of.child())),
        ),
        ColumnDefinition::new("x", "sides", "cell of the child, to the east", small(|row: &R<'a>| row.of.cell().x)),
        ColumnDefinition::new("y", "sides", "to the north", small(|row: &R<'a>| row.of.cell().y)),
        ColumnDefinition::new("z", "sides", "up; the plate is at 0", small(|row: &R<'a>| row.of.cell().z)),
        ColumnDefinition::new(
            "magnetized",
            "ticks",
            "when the face was magnetized, from the beginning of the run",
            integer(|row: &R<'a>| both!(row.of, magnetized)),
        ),
        ColumnDefinition::new(
            "docked",
            "ticks",
            "when the block docked",
            integer(|row: &R<'a>| row.of.docked().map(|bond| bond.docked)),
        )
        .null(CENSORED),
        ColumnDefinition::new(
            "docked_seconds",
            "s",
            "`docked` in seconds of the scene",
            real(|row: &R<'a>| row.of.docked().map(|bond| row.run.seconds(bond.docked))),
        )
        .null(CENSORED),
        ColumnDefinition::new(
            "wait",
            "ticks",
            "from `magnetized` to `docked`; of a censored wait, to the end of the run",
            integer(|row: &R<'a>| row.of.wait(row.run)),
        ),
        ColumnDefinition::new(
            "wait_seconds",
            "s",
            "`wait` in seconds of the scene",
            real(|row: &R<'a>| row.run.seconds(row.of.wait(row.run))),
        ),
        ColumnDefinition::new(
            "censored",
            "",
            "whether the run ended during the wait: it would have been longer, by an unknown amount",
            truth(|row: &R<'a>| row.of.docked().is_none()),
        ),
        ColumnDefinition::new(
            "entries",
            "",
            "times that a free block came into the reach of the pull, re-entries included",
            integer(|row: &R<'a>| u64::from(both!(row.of, entries))),
        ),
        ColumnDefinition::new(
            "docking",
            "ticks",
            "from the captured block's last entry to its docking",
            integer(|row: &R<'a>| row.of.docked().map(|bond| bond.docking)),
        )
        .null(CENSORED),
        ColumnDefinition::new(
            "body",
            "",
            "number of the captured block, from 0",
            integer(|row: &R<'a>| row.of.docked().map(|bond| bond.body.into())),
        )
        .null(CENSORED),
        ColumnDefinition::new(
            "origin",
            "",
            "`free`: the captured block had never been captured; `released`: it had been part of the \
             structure before",
            text(|row: &R<'a>| {
                Some(match row.of.docked()?.origin {
                    Origin::Free => "free",
                    Origin::Released { .. } => "released",
                })
            }),
        )
        .null(CENSORED),
        ColumnDefinition::new(
            "origin_role",
            "",
            "role that the captured block had last",
            text(|row: &R<'a>| {
                let (role, _) = row.of.released()?;
                Some(row.run.program.role(role))
            }),
        )
        .null("it had none, or the wait is censored"),
        ColumnDefinition::new(
            "released_at",
            "ticks",
            "when it lost that role",
            integer(|row: &R<'a>| row.of.released().map(|(_, tick)| tick)),
        )
        .null("it had none, or the wait is censored"),
    ]);
    TableDefinition {
        name: "bonds",
        row: "a capture, or a face that waited for one when the run ended",
        columns,
    }
}
