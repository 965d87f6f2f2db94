//! `bonds.parquet`: one row per capture.
use stochc_runtime::record::{BondRecord, Origin};

use super::column::{Column, file, integer};
use crate::ensemble::{Finished, Manifest, Program};

/// A capture, and the run it belongs to.
#[derive(Clone, Copy)]
struct Row<'a> {
    program: &'a Program,
    run: u64,
    bond: &'a BondRecord,
}

/// The table of captures of runs that are sorted by program and run, in the order of docking.
///
/// | column | type | what |
/// |---|---|---|
/// | `program`, `run` | text, integer | of the table of runs |
/// | `phase`, `parent`, `child` | text | names of the program |
/// | `face` | text | of the parent, in the structure's frame |
/// | `x`, `y`, `z` | integer | the child's cell |
/// | `magnetized`, `docked` | integer | ticks of the run |
/// | `wait` | integer | ticks from one to the other |
/// | `entries` | integer | of blocks into the reach of the pull |
/// | `docking` | integer | ticks from the captured block's last entry |
/// | `body` | integer | which free block, from 0 |
/// | `origin` | text | `free`, or `released` when it was captured before |
/// | `origin_role` | text or null | the role it had last |
/// | `released_at` | integer or null | the tick at which it lost that role |
pub(in crate::ensemble) fn bonds(manifest: &Manifest, finished: &[Finished]) -> Vec<u8> {
    let rows: Vec<Row> = finished
        .iter()
        .flat_map(|done| {
            done.record.bonds.iter().map(|bond| Row {
                program: &manifest.programs[done.program],
                run: done.record.run,
                bond,
            })
        })
        .collect();
    let texts = |value: for<'a> fn(Row<'a>) -> &'a str| {
        Column::Texts(rows.iter().map(|row| value(*row)).collect())
    };
    let integers = |value: fn(Row) -> u64| {
        Column::Integers(rows.iter().map(|row| integer(value(*row))).collect())
    };
    let coordinates = |value: fn(&BondRecord) -> i32| {
        Column::Small(rows.iter().map(|row| value(row.bond)).collect())
    };
    let origin_roles = rows.iter().map(|row| match row.bond.origin {
        Origin::Free => None,
        Origin::Released { role, .. } => Some(row.program.role(role)),
    });
    let released_at = rows.iter().map(|row| match row.bond.origin {
        Origin::Free => None,
        Origin::Released { tick, .. } => Some(integer(tick)),
    });
    let columns = [
        ("program", texts(|row| &row.program.name)),
        ("run", integers(|row| row.run)),
        ("phase", texts(|row| row.program.phase(row.bond.phase))),
        ("parent", texts(|row| row.program.role(row.bond.parent))),
        ("face", texts(|row| row.bond.face.word())),
        ("child", texts(|row| row.program.role(row.bond.child))),
        ("x", coordinates(|bond| bond.cell.x)),
        ("y", coordinates(|bond| bond.cell.y)),
        ("z", coordinates(|bond| bond.cell.z)),
        ("magnetized", integers(|row| row.bond.magnetized)),
        ("docked", integers(|row| row.bond.docked)),
        (
            "wait",
            integers(|row| row.bond.docked.saturating_sub(row.bond.magnetized)),
        ),
        ("entries", integers(|row| row.bond.entries.into())),
        ("docking", integers(|row| row.bond.docking)),
        ("body", integers(|row| row.bond.body.into())),
        (
            "origin",
            texts(|row| match row.bond.origin {
                Origin::Free => "free",
                Origin::Released { .. } => "released",
            }),
        ),
        ("origin_role", Column::MaybeTexts(origin_roles.collect())),
        ("released_at", Column::MaybeIntegers(released_at.collect())),
    ];
    file("bonds", &manifest.identity(), &columns)
}
