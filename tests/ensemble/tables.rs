//! The Parquet files, read back.
use std::fs::File;
use std::path::Path;

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use stochc::ensemble::Finished;
use stochc_runtime::record::{Origin, Outcome};

use crate::world::{complete, manifest};

fn rows(path: &Path) -> Vec<serde_json::Value> {
    let reader = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
    let rows = reader.get_row_iter(None).unwrap();
    rows.map(|row| {
        let row = row.unwrap();
        let columns = row.get_column_iter();
        columns
            .map(|(name, field)| (name.clone(), json(field)))
            .collect()
    })
    .collect()
}

fn json(field: &Field) -> serde_json::Value {
    match field {
        Field::Null => serde_json::Value::Null,
        Field::Int(value) => (*value).into(),
        Field::Long(value) => (*value).into(),
        Field::ULong(value) => (*value).into(),
        Field::Str(value) => value.as_str().into(),
        Field::ListInternal(list) => list.elements().iter().map(json).collect(),
        other => panic!("no column is a {other:?}"),
    }
}

/// What the table of runs should say.
fn run_row(done: &Finished, seed: u64) -> serde_json::Value {
    let names = ["first", "second"];
    let (outcome, phase, reason) = match &done.record.outcome {
        Outcome::Completed => ("completed", None, None),
        Outcome::TimedOut { phase } => ("timed_out", Some(phase), None),
        Outcome::Failed { phase, reason } => ("failed", Some(phase), Some(reason)),
    };
    serde_json::json!({
        "program": (["left", "right"][done.program]),
        "run": done.record.run,
        "outcome": outcome,
        "failed_phase": phase.map(|phase| names[phase.0 as usize]),
        "reason": reason,
        "ticks": done.record.ticks,
        "phase_ticks": done.record.phase_ticks,
        "blocks_used": done.record.blocks_used,
        "captures": done.record.bonds.len(),
        "hops": done.record.hops,
        "seed": seed,
    })
}

#[test]
fn the_table_of_runs_says_what_the_records_say() {
    let folder = tempfile::tempdir().unwrap();
    let results = complete(folder.path(), &manifest(40), 2);
    let expected: Vec<_> = results
        .finished
        .iter()
        .map(|done| run_row(done, u64::MAX))
        .collect();
    assert_eq!(rows(&folder.path().join("runs.parquet")), expected);
}

#[test]
fn the_table_of_bonds_says_what_the_records_say() {
    let folder = tempfile::tempdir().unwrap();
    let results = complete(folder.path(), &manifest(40), 2);
    let roles = ["A", "B", "C"];
    let mut expected = Vec::new();
    for done in &results.finished {
        for bond in &done.record.bonds {
            let released = match bond.origin {
                Origin::Free => None,
                Origin::Released { role, tick } => Some((roles[role.0 as usize], tick)),
            };
            expected.push(serde_json::json!({
                "program": (["left", "right"][done.program]),
                "run": done.record.run,
                "phase": (["first", "second"][bond.phase.0 as usize]),
                "parent": roles[bond.parent.0 as usize],
                "face": "up",
                "child": roles[bond.child.0 as usize],
                "x": bond.cell.x,
                "y": bond.cell.y,
                "z": bond.cell.z,
                "magnetized": bond.magnetized,
                "docked": bond.docked,
                "wait": bond.docked - bond.magnetized,
                "entries": bond.entries,
                "docking": bond.docking,
                "body": bond.body,
                "origin": if released.is_some() { "released" } else { "free" },
                "origin_role": released.map(|(role, _)| role),
                "released_at": released.map(|(_, tick)| tick),
            }));
        }
    }
    assert!(expected.len() > 100);
    assert_eq!(rows(&folder.path().join("bonds.parquet")), expected);
}

#[test]
fn an_ensemble_without_runs_has_empty_tables() {
    let folder = tempfile::tempdir().unwrap();
    assert!(complete(folder.path(), &manifest(0), 1).complete);
    assert_eq!(
        rows(&folder.path().join("runs.parquet")),
        [0; 0].map(serde_json::Value::from)
    );
    assert!(rows(&folder.path().join("bonds.parquet")).is_empty());
}
