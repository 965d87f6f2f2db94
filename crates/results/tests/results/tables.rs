//! Tests that the Parquet files have the same content as the records.
use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use serde_json::{Value, json};
use stochc_ir::record::{
    AbortRecord, BondRecord, FaultKind, Limit, Origin, Outcome, ReleaseRecord, RunRecord,
    WaitRecord,
};
use stochc_ir::table::PhaseId;
use stochc_results::{Destination, Finished, Folder, Varied, tables};

use crate::world::{complete, manifest, run_on, scene, simulate};

fn rows(path: &Path) -> Vec<Value> {
    let reader = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
    let rows = reader.get_row_iter(None).unwrap();
    rows.map(|row| {
        let row = row.unwrap();
        let columns = row.get_column_iter();
        columns
            .map(|(name, field)| (name.clone(), value(field)))
            .collect()
    })
    .collect()
}

fn value(field: &Field) -> Value {
    match field {
        Field::Null => Value::Null,
        Field::Bool(value) => (*value).into(),
        Field::Double(value) => (*value).into(),
        Field::Int(value) => (*value).into(),
        Field::Long(value) => (*value).into(),
        Field::ULong(value) => (*value).into(),
        Field::Str(value) => value.as_str().into(),
        Field::ListInternal(list) => list.elements().iter().map(value).collect(),
        other => panic!("no column is a {other:?}"),
    }
}

/// Returns the rows of a folder's table as JSON.
fn table(folder: &Path, name: &str) -> Vec<Value> {
    rows(&folder.join(format!("{name}.parquet")))
}

const PROGRAMS: [&str; 2] = ["left", "right"];
const PHASES: [&str; 2] = ["first", "second"];
const ROLES: [&str; 3] = ["A", "B", "C"];

fn word(outcome: &Outcome) -> (&'static str, Option<PhaseId>, Option<&str>) {
    match outcome {
        Outcome::Completed => ("completed", None, None),
        Outcome::TimedOut { phase, by } => match by {
            Limit::Timeout => ("timed_out", Some(*phase), None),
            Limit::MaxTicks => ("censored", Some(*phase), None),
        },
        Outcome::Failed {
            phase,
            reason,
            is_broken,
        } => {
            let word = if *is_broken { "broken" } else { "failed" };
            (word, Some(*phase), Some(reason))
        }
    }
}

/// Returns a row about an item in a phase: the columns of its run, and the columns `more`.
fn row(done: &Finished, phase: PhaseId, more: Value) -> Value {
    let mut row = json!({
        "program": PROGRAMS[done.program],
        "run": done.record.run,
        "phase": PHASES[phase.0 as usize],
        "phase_number": phase.0,
        "pre_attached": false,
    });
    let fields = row.as_object_mut().unwrap();
    fields.extend(more.as_object().unwrap().clone());
    row
}

fn seconds(ticks: u64) -> f64 {
    ticks as f64 * scene().tick
}

/// Sums a number over all aborted attempts of a run.
fn aborted(record: &RunRecord, number: impl Fn(&AbortRecord) -> usize) -> usize {
    record.aborts.iter().map(number).sum()
}

/// Returns the expected row of the table of runs.
fn run_row(done: &Finished, seed: u64) -> Value {
    let record = &done.record;
    let (outcome, phase, reason) = word(&record.outcome);
    json!({
        "program": PROGRAMS[done.program],
        "run": record.run,
        "assembly": PROGRAMS[done.program],
        "scene": "void",
        "outcome": outcome,
        "failed_phase": phase.map(|phase| PHASES[phase.0 as usize]),
        "failed_phase_number": phase.map(|phase| phase.0),
        "reason": reason,
        "ticks": record.ticks,
        "seconds": seconds(record.ticks),
        "tick_seconds": scene().tick,
        "phase_names": PHASES,
        "phase_ticks": record.phase_ticks,
        "blocks_used": record.blocks_used,
        "captures": record.bonds.len() + aborted(record, |it| it.bonds.len()),
        "censored_captures": record.waiting.len() + aborted(record, |it| it.waiting.len()),
        "releases": record.releases.len() + aborted(record, |it| it.releases.len()),
        "unplanned": record.unplanned,
        "dead": record.faults_of(FaultKind::Dead),
        "failed_latches": record.faults_of(FaultKind::Latch),
        "hops": record.hops,
        "seed": seed,
    })
}

#[test]
fn the_table_of_runs_matches_the_records() {
    let folder = tempfile::tempdir().unwrap();
    let results = complete(folder.path(), &manifest(40), 2);
    let runs = results.finished.to_vec().unwrap();
    let expected: Vec<_> = runs.iter().map(|done| run_row(done, u64::MAX)).collect();
    for outcome in ["completed", "timed_out", "censored", "broken", "failed"] {
        assert!(expected.iter().any(|row| row["outcome"] == outcome));
    }
    assert_eq!(table(folder.path(), "runs"), expected);
}

#[test]
fn the_table_of_phases_has_start_and_end() {
    let folder = tempfile::tempdir().unwrap();
    let results = complete(folder.path(), &manifest(40), 2);
    let mut expected = Vec::new();
    for done in &results.finished.to_vec().unwrap() {
        let record = &done.record;
        let mut began = 0;
        for (i, ticks) in record.phase_ticks.iter().enumerate() {
            let ended = began + ticks;
            let more = json!({ "outcome": "completed", "began": began, "ended": ended, "retries": i * record.aborts.len(), "ticks": ticks, "seconds": seconds(*ticks) });
            expected.push(row(done, PhaseId(i as u32), more));
            began = ended;
        }
        // The end of the phase is unknown for a failed run.
        let (outcome, phase, _) = word(&record.outcome);
        if let Some(phase) = phase.filter(|phase| phase.0 as usize == record.phase_ticks.len()) {
            let ticks = record.ticks - began;
            let more = json!({ "outcome": outcome, "began": began, "ended": null, "retries": phase.0 as usize * record.aborts.len(), "ticks": ticks, "seconds": seconds(ticks) });
            expected.push(row(done, phase, more));
        }
    }
    let ended = expected.iter().filter(|row| !row["ended"].is_null());
    assert!(expected.len() > 100 && ended.count() < expected.len());
    assert_eq!(table(folder.path(), "phases"), expected);
}

/// Returns the expected row about a capture.
fn bond_row(done: &Finished, bond: &BondRecord, is_aborted: bool) -> Value {
    let released = match bond.origin {
        Origin::Free => None,
        Origin::Released { role, tick } => Some((ROLES[role.0 as usize], tick)),
    };
    let more = json!({
        "parent": ROLES[bond.parent.0 as usize],
        "face": "up",
        "child": ROLES[bond.child.0 as usize],
        "x": bond.cell.x,
        "y": bond.cell.y,
        "z": bond.cell.z,
        "magnetized": bond.magnetized,
        "docked": bond.docked,
        "docked_seconds": seconds(bond.docked),
        "wait": bond.docked - bond.magnetized,
        "wait_seconds": seconds(bond.docked - bond.magnetized),
        "censored": false,
        "aborted": is_aborted,
        "entries": bond.entries,
        "docking": bond.docking,
        "body": bond.body,
        "origin": if released.is_some() { "released" } else { "free" },
        "origin_role": released.map(|(role, _)| role),
        "released_at": released.map(|(_, tick)| tick),
    });
    row(done, bond.phase, more)
}

/// Returns the expected row about a face that waited until the tick `end`.
fn wait_row(done: &Finished, wait: &WaitRecord, end: u64, is_aborted: bool) -> Value {
    let more = json!({
        "parent": ROLES[wait.parent.0 as usize],
        "face": "up",
        "child": ROLES[wait.child.0 as usize],
        "x": wait.cell.x,
        "y": wait.cell.y,
        "z": wait.cell.z,
        "magnetized": wait.magnetized,
        "docked": null,
        "docked_seconds": null,
        "wait": end - wait.magnetized,
        "wait_seconds": seconds(end - wait.magnetized),
        "censored": true,
        "aborted": is_aborted,
        "entries": wait.entries,
        "docking": null,
        "body": null,
        "origin": null,
        "origin_role": null,
        "released_at": null,
    });
    row(done, wait.phase, more)
}

#[test]
fn the_table_of_bonds_matches_the_records() {
    let folder = tempfile::tempdir().unwrap();
    let results = complete(folder.path(), &manifest(40), 2);
    let mut expected = Vec::new();
    for done in &results.finished.to_vec().unwrap() {
        let record = &done.record;
        let bonds = record.bonds.iter().map(|it| bond_row(done, it, false));
        expected.extend(bonds);
        let waiting = record.waiting.iter();
        expected.extend(waiting.map(|it| wait_row(done, it, record.ticks, false)));
        for abort in &record.aborts {
            expected.extend(abort.bonds.iter().map(|it| bond_row(done, it, true)));
            let waiting = abort.waiting.iter();
            expected.extend(waiting.map(|it| wait_row(done, it, abort.tick, true)));
        }
    }
    let count = |is_censored: bool, is_aborted: bool| {
        let rows = expected.iter();
        rows.filter(|it| it["censored"] == is_censored && it["aborted"] == is_aborted)
            .count()
    };
    assert!(count(false, false) > 100 && count(true, false) > 2);
    assert!(count(false, true) > 0 && count(true, true) > 0);
    assert_eq!(table(folder.path(), "bonds"), expected);
}

#[test]
fn the_tables_of_releases_and_unplanned_bonds_match_the_records() {
    let folder = tempfile::tempdir().unwrap();
    let results = complete(folder.path(), &manifest(40), 2);
    let (mut releases, mut unplanned) = (Vec::new(), Vec::new());
    for done in &results.finished.to_vec().unwrap() {
        let mut add = |release: &ReleaseRecord, is_aborted: bool| {
            let more = json!({
                "tick": release.tick,
                "seconds": seconds(release.tick),
                "parent": ROLES[release.parent.0 as usize],
                "child": ROLES[release.child.0 as usize],
                "body": release.body,
                "aborted": is_aborted,
            });
            releases.push(row(done, release.phase, more));
        };
        let (record, aborts) = (&done.record, &done.record.aborts);
        record.releases.iter().for_each(|it| add(it, false));
        let aborted = aborts.iter().flat_map(|abort| &abort.releases);
        aborted.for_each(|it| add(it, true));
        for bond in &done.record.unplanned_bonds {
            let more = json!({
                "tick": bond.tick,
                "seconds": seconds(bond.tick),
                "parent": ROLES[bond.parent.0 as usize],
                "face": bond.face.word(),
                "body": bond.body,
            });
            unplanned.push(row(done, bond.phase, more));
        }
    }
    assert!(releases.len() > 10 && unplanned.len() > 10);
    assert_eq!(table(folder.path(), "releases"), releases);
    assert_eq!(table(folder.path(), "unplanned"), unplanned);
}

/// Checks that large tables are written and read in row groups.
#[test]
fn large_tables_have_groups_of_rows() {
    const GROUP: usize = 1 << 17;
    const BONDS: usize = 2500;
    let (folder, never) = (tempfile::tempdir().unwrap(), AtomicBool::new(false));
    let manifest = manifest(40);
    let root = Destination::Folder(Folder::open(folder.path(), &manifest, false).unwrap());
    let results = run_on(1, root, &never, |program, run, watch| {
        let mut record = simulate(program, run, watch)?;
        if let Some(bond) = record.bonds.first().cloned() {
            record.bonds = vec![bond; BONDS];
            for (body, bond) in record.bonds.iter_mut().enumerate() {
                bond.body = body as u32;
            }
        }
        Ok(record)
    });
    let finished = results.unwrap().finished.to_vec().unwrap();
    let rows = |of: &Finished| of.record.all_bonds().count() + of.record.all_waiting().count();
    let rows: usize = finished.iter().map(rows).sum();
    let file = File::open(folder.path().join("bonds.parquet")).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let groups = reader.metadata().row_groups().iter();
    let groups: Vec<usize> = groups.map(|group| group.num_rows() as usize).collect();
    assert!(
        rows > GROUP && groups.len() == rows.div_ceil(GROUP),
        "{groups:?}"
    );
    assert!(
        groups.iter().all(|&group| group < GROUP + BONDS),
        "{groups:?}"
    );
    let bodies: Vec<i64> = (table(folder.path(), "bonds").iter())
        .filter(|row| row["aborted"] == false)
        .filter_map(|row| row["body"].as_i64())
        .collect();
    let expected = finished.iter().flat_map(|done| &done.record.bonds);
    assert!(
        bodies
            .into_iter()
            .eq(expected.map(|bond| i64::from(bond.body)))
    );
    assert_eq!(table(folder.path(), "runs").len(), 80);
}

#[test]
fn an_ensemble_without_runs_has_empty_tables() {
    let folder = tempfile::tempdir().unwrap();
    assert!(complete(folder.path(), &manifest(0), 1).complete);
    for shape in tables() {
        assert_eq!(table(folder.path(), &shape.name), [0; 0].map(Value::from));
    }
}

/// Checks that each scene parameter of a sweep is a column, in the unit of the command line.
#[test]
fn swept_parameters_are_columns_of_every_table() {
    let folder = tempfile::tempdir().unwrap();
    let mut manifest = manifest(6);
    for (program, given) in manifest.programs.iter_mut().zip([2.5, 4.0]) {
        program.varied = vec![Varied {
            name: "bond.pull".into(),
            value: given / 1000.0,
            given,
            unit: "mN".into(),
        }];
    }
    complete(folder.path(), &manifest, 1);
    for shape in tables() {
        let rows = table(folder.path(), &shape.name);
        assert!(!rows.is_empty(), "{}", shape.name);
        for row in rows {
            let given = if row["program"] == "left" { 2.5 } else { 4.0 };
            assert_eq!(row["scene_bond_pull"], given, "{row}");
        }
        let columns = metadata(folder.path(), &shape.name)["stochc.columns"].clone();
        let columns: Vec<Value> = serde_json::from_str(&columns).unwrap();
        let column = columns.iter().find(|it| it["name"] == "scene_bond_pull");
        assert_eq!(column.unwrap()["unit"], "mN");
    }
}

/// Returns the metadata of a table's file, as keys and values.
fn metadata(folder: &Path, name: &str) -> BTreeMap<String, String> {
    let file = File::open(folder.join(format!("{name}.parquet"))).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let metadata = reader.metadata().file_metadata();
    let pairs = metadata.key_value_metadata().unwrap().iter();
    let pairs = pairs.map(|pair| (pair.key.clone(), pair.value.clone().unwrap()));
    pairs.collect()
}

#[test]
fn every_table_has_metadata() {
    let folder = tempfile::tempdir().unwrap();
    let mut manifest = manifest(2);
    manifest.settings.max_ticks = Some(900);
    manifest.programs[1].scene.tick = 0.5;
    complete(folder.path(), &manifest, 1);
    for shape in tables() {
        let about = metadata(folder.path(), &shape.name);
        let columns: Value = serde_json::from_str(&about["stochc.columns"]).unwrap();
        assert_eq!(columns, json!(shape.columns));
        let known = [
            ("table", shape.name.clone()),
            ("row", shape.row.clone()),
            ("version", manifest.stochc.clone()),
            ("ensemble", manifest.identity()),
            ("model", "rigid".into()),
            ("substeps", "2/8".into()),
            ("settings", json!(manifest.settings).to_string()),
            ("seed", u64::MAX.to_string()),
            ("runs", "2".into()),
            ("max_ticks", "900".into()),
            ("side_m", scene().block.side.to_string()),
        ];
        for (key, value) in known {
            assert_eq!(about[&format!("stochc.{key}")], value, "{key}");
        }
        // The scenes of the programs have different ticks.
        assert!(!about.contains_key("stochc.tick_s"));
        let programs: Value = serde_json::from_str(&about["stochc.programs"]).unwrap();
        assert_eq!(programs[0]["name"], "left");
        assert_eq!(programs[0]["scene"], "void");
        assert_eq!(programs[0]["tick_s"], scene().tick);
        assert_eq!(programs[1]["tick_s"], 0.5);
        assert_eq!(
            programs[1]["phases"],
            json!(PHASES.map(|name| json!({ "name": name, "pre_attached": false })))
        );
    }
}

/// Checks that `docs/reference/results.md` lists every column with its type, unit, meaning and null
/// values.
///
/// `STOCHC_WRITE_DOCS=1 cargo test --workspace --test results columns` updates the list.
#[test]
fn all_columns_are_documented() {
    const PAGE: &str = "../../docs/reference/results.md";
    const BEGIN: &str = "<!-- tables: written by crates/results/tests/results/tables.rs -->\n";
    const END: &str = "<!-- end of tables -->\n";
    let mut text = String::new();
    for table in tables() {
        text += &format!(
            "\n### `{}.parquet`\n\nEach row is {}.\n\n",
            table.name, table.row
        );
        text += "| column | type | unit | meaning | null when |\n|---|---|---|---|---|\n";
        for column in &table.columns {
            let null = column.null.as_deref().unwrap_or("");
            let (name, kind, unit) = (&column.name, column.kind, &column.unit);
            let row = format!(
                "| `{name}` | {kind} | {unit} | {} | {null} |\n",
                column.meaning
            );
            text += &row.replace("|  |", "| |").replace("|  |", "| |");
        }
    }
    text.push('\n');
    crate::pages::assert_part(PAGE, [BEGIN, END], &text);
}
