//! `bonds.parquet`.
use stochc_ir::Cell;
use stochc_ir::record::{BondRecord, Origin, WaitRecord};
use stochc_ir::table::{PhaseId, RoleId};

use super::column::{Column, Table, integer, small, text, truth};
use super::row::{Row, Run, key, phase};
use crate::Varied;

/// When what a row says of the captured block is null.
const CENSORED: &str = "the wait is censored";

/// A capture, or one that was waited for when the run ended.
#[derive(Clone, Copy)]
pub(super) enum Bond<'a> {
    Docked(&'a BondRecord),
    Waiting(&'a WaitRecord),
}

/// The captures of a run in the order of docking, then what was under way.
pub(super) fn bonds(run: Run<'_>) -> impl Iterator<Item = Bond<'_>> {
    let docked = run.record.bonds.iter().map(Bond::Docked);
    docked.chain(run.record.waiting.iter().map(Bond::Waiting))
}

/// What both kinds have.
macro_rules! both {
    ($bond:expr, $field:ident) => {
        match $bond {
            Bond::Docked(bond) => bond.$field,
            Bond::Waiting(wait) => wait.$field,
        }
    };
}

impl<'a> Bond<'a> {
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
            Bond::Docked(bond) => Some(bond),
            Bond::Waiting(_) => None,
        }
    }

    /// The role that the captured block had before, and when it lost it.
    fn released(self) -> Option<(RoleId, u64)> {
        match self.docked()?.origin {
            Origin::Free => None,
            Origin::Released { role, tick } => Some((role, tick)),
        }
    }
}

pub(super) fn table<'a>(axes: &[Varied]) -> Table<'a, Row<'a, Bond<'a>>> {
    type R<'a> = Row<'a, Bond<'a>>;
    let mut columns = key(axes);
    columns.extend(phase(|bond: &Bond<'a>| bond.phase()));
    columns.extend([
        Column::new(
            "parent",
            "",
            "role of the block that magnetized a face",
            text(|row: &R<'a>| row.run.program.role(row.of.parent())),
        ),
        Column::new(
            "face",
            "",
            "which of its faces, in the structure's frame: `up`, `down`, `north`, `south`, `east` or `west`",
            text(|row: &R<'a>| both!(row.of, face).word()),
        ),
        Column::new(
            "child",
            "",
            "role that the captured block is given",
            text(|row: &R<'a>| row.run.program.role(row.of.child())),
        ),
        Column::new("x", "sides", "cell of the child, to the east", small(|row: &R<'a>| row.of.cell().x)),
        Column::new("y", "sides", "to the north", small(|row: &R<'a>| row.of.cell().y)),
        Column::new("z", "sides", "up; the plate is at 0", small(|row: &R<'a>| row.of.cell().z)),
        Column::new(
            "magnetized",
            "ticks",
            "when the face was magnetized, from the beginning of the run",
            integer(|row: &R<'a>| both!(row.of, magnetized)),
        ),
        Column::new(
            "docked",
            "ticks",
            "when the block docked",
            integer(|row: &R<'a>| row.of.docked().map(|bond| bond.docked)),
        )
        .null(CENSORED),
        Column::new(
            "wait",
            "ticks",
            "from `magnetized` to `docked`; of a censored wait, to the end of the run",
            integer(|row: &R<'a>| {
                let docked = row.of.docked().map(|bond| bond.docked);
                let end = docked.unwrap_or(row.run.record.ticks);
                end.saturating_sub(both!(row.of, magnetized))
            }),
        ),
        Column::new(
            "censored",
            "",
            "whether the run ended during the wait: it would have been longer, nobody knows by how much",
            truth(|row: &R<'a>| row.of.docked().is_none()),
        ),
        Column::new(
            "entries",
            "",
            "times that a free block came into the reach of the pull, re-entries included",
            integer(|row: &R<'a>| u64::from(both!(row.of, entries))),
        ),
        Column::new(
            "docking",
            "ticks",
            "from the captured block's last entry to its docking",
            integer(|row: &R<'a>| row.of.docked().map(|bond| bond.docking)),
        )
        .null(CENSORED),
        Column::new(
            "body",
            "",
            "number of the captured block, from 0",
            integer(|row: &R<'a>| row.of.docked().map(|bond| bond.body.into())),
        )
        .null(CENSORED),
        Column::new(
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
        Column::new(
            "origin_role",
            "",
            "role that the captured block had last",
            text(|row: &R<'a>| {
                let (role, _) = row.of.released()?;
                Some(row.run.program.role(role))
            }),
        )
        .null("it had none, or the wait is censored"),
        Column::new(
            "released_at",
            "ticks",
            "when it lost that role",
            integer(|row: &R<'a>| row.of.released().map(|(_, tick)| tick)),
        )
        .null("it had none, or the wait is censored"),
    ]);
    Table {
        name: "bonds",
        row: "a capture, or a face that waited for one when the run ended",
        columns,
    }
}
