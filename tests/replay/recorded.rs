//! Tests recordings in a results folder, made during the simulation or afterwards.
use std::fs;

use stochc::files::checksum::sealed;
use stochc::ir::table::PhaseId;
use stochc::results::recording::{Recording, TimedEvent};
use stochc::runtime::observe::ObservedEvent;

use crate::folder::{PROGRAM, Results, SWARM, stochc};

const DENSE: &str = "tests/fixtures/dense.sa";

#[test]
fn a_later_recording_is_bitwise_equal() {
    let [at_once, later] =
        ["--record all", ""].map(|options| Results::from_records(DENSE, options));
    assert!(!later.recording_path(1).exists());
    later.page(1);
    let [first, second] = [&at_once, &later].map(|of| fs::read(of.recording_path(1)).unwrap());
    assert!(first == second);
    assert!(!later.recording_path(0).exists());
    // Recording does not change the results.
    for table in ["journal.jsonl", "runs.parquet", "bonds.parquet"] {
        let [first, second] = [&at_once, &later].map(|of| fs::read(of.path().join(table)).unwrap());
        if table != "journal.jsonl" {
            assert!(first == second, "{table}");
        }
    }
    // The pages of both folders are identical.
    let [first, second] = [&at_once, &later].map(|of| fs::read(of.page(1)).unwrap());
    assert!(first == second);
}

#[test]
fn only_requested_runs_are_recorded() {
    let results = Results::from_records(DENSE, "--record 1");
    assert_eq!(
        fs::read_dir(results.path().join("recordings"))
            .unwrap()
            .count(),
        1
    );
    let recording = results.recording(1);
    assert_eq!((recording.header().run, recording.header().every), (1, 4));
    assert_eq!(recording.record().run, 1);
}

#[test]
fn a_recording_contains_every_tick_with_an_event() {
    let results = Results::from_records(PROGRAM, "--record 0 --record-every 10");
    let recording = results.recording(0);
    let ticks: Vec<u64> = recording.frames().map(|frame| frame.tick).collect();
    let mut requested: Vec<u64> = (recording.events().iter())
        .filter(|TimedEvent { event, .. }| {
            matches!(
                event,
                ObservedEvent::Captured { .. }
                    | ObservedEvent::Released { .. }
                    | ObservedEvent::Reported { .. }
            )
        })
        .map(|happening| happening.tick)
        .chain((0..=recording.record().ticks).step_by(10))
        .collect();
    requested.sort_unstable();
    requested.dedup();
    assert_eq!(ticks, requested);
    assert_eq!(ticks.last(), Some(&recording.record().ticks));
    let captured = (recording.events().iter())
        .filter(|happening| matches!(happening.event, ObservedEvent::Captured { .. }));
    assert_eq!(captured.count(), recording.record().bonds.len());
}

#[test]
fn anchored_blocks_are_at_their_cells() {
    let results = Results::from_records(PROGRAM, "--record 0");
    let recording = results.recording(0);
    let tables = results.tables();
    for frame in recording.frames() {
        for bond in &recording.record().bonds {
            if bond.docked != frame.tick {
                continue;
            }
            let [x, y, z, ..] = frame.poses[bond.body as usize];
            let centre = |n: i32, blocks: u32| f64::from(n) - (f64::from(blocks) - 1.0) / 2.0;
            let cell = [
                centre(bond.cell.x, tables.plate.width),
                centre(bond.cell.y, tables.plate.depth),
                f64::from(bond.cell.z) - 0.5,
            ];
            // The limit is half a step of a 16-bit coordinate in an arena of 50 block lengths.
            let far = [x - cell[0], y - cell[1], z - cell[2]];
            assert!(far.iter().all(|far| far.abs() <= 1.0 / 1024.0), "{far:?}");
        }
    }
}

#[test]
fn a_resumed_ensemble_records_its_runs() {
    let results = Results::from_records(DENSE, "--record 1");
    let left = results.path().join("recordings/.stochc-partial-left");
    fs::write(&left, "by a kill").unwrap();
    let outcome = stochc("resume --runs 3 --record all", &[&results.path()]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let note = "note: 1 of the runs to record had been made before";
    assert!(outcome.err.contains(note), "{}", outcome.err);
    assert_eq!(results.recording(2).record().run, 2);
    assert!(!results.recording_path(0).exists());
    assert!(!left.exists());
}

/// Returns the name and payload of each section of a recording.
fn sections(bytes: &[u8]) -> Vec<(&str, &[u8])> {
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    // Four bytes of a checksum follow each part.
    let mut at = 16 + number(12) + 4;
    let mut sections = Vec::new();
    while at < bytes.len() {
        let name = std::str::from_utf8(&bytes[at..at + 4]).unwrap();
        let end = at + 8 + number(at + 4);
        sections.push((name, &bytes[at + 8..end]));
        at = end + 4;
    }
    sections
}

#[test]
fn a_long_run_is_written_in_chunks() {
    let results = Results::from_records(PROGRAM, "--record 0 --record-every 1");
    let bytes = fs::read(results.recording_path(0)).unwrap();
    let sections = sections(&bytes);
    let ticks: Vec<usize> = (sections.iter())
        .filter(|(name, _)| *name == "POSE")
        .map(|(_, payload)| u32::from_le_bytes(payload[8..12].try_into().unwrap()) as usize)
        .collect();
    // 300 blocks have 7 numbers each, so half a million numbers are about 250 ticks.
    let recording = results.recording(0);
    assert_eq!(recording.header().bodies, 300);
    assert!(ticks.iter().all(|ticks| *ticks <= 250), "{ticks:?}");
    assert_eq!(
        ticks.iter().sum::<usize>() as u64,
        recording.record().ticks + 1
    );
    assert_eq!(sections.last().map(|(name, _)| *name), Some("DONE"));
}

#[test]
fn bonds_among_free_blocks_are_recorded() {
    let results = Results::from_records(SWARM, "--record 0");
    let recording = results.recording(0);
    let rows: usize = (recording.events().iter())
        .filter(|happening| matches!(happening.event, ObservedEvent::Bonded { .. }))
        .count();
    // A group of n blocks has n - 1 bonds.
    assert!(rows as u32 + 1 >= recording.record().blocks_used, "{rows}");
    // A phase begins at the tick of the bond that completed a group of its size.
    let begins = (recording.events().iter())
        .filter(|happening| matches!(happening.event, ObservedEvent::Phase(PhaseId(1..))));
    let mut looked = 0;
    for begin in begins {
        let ObservedEvent::Phase(PhaseId(phase)) = begin.event else {
            continue;
        };
        let made = (recording.events().iter()).any(|happening| {
            happening.tick == begin.tick
                && matches!(happening.event, ObservedEvent::Bonded { size, .. } if size > phase)
        });
        assert!(made, "phase {phase}");
        looked += 1;
    }
    assert!(looked > 5, "{looked}");
}

#[test]
fn rejects_corrupted_recordings() {
    let results = Results::from_records(DENSE, "--record 0");
    let bytes = fs::read(results.recording_path(0)).unwrap();
    let tables = results.tables();
    for at in (0..400).chain((400..bytes.len()).step_by(bytes.len() / 199)) {
        for change in [0x01, 0x80, 0xFF] {
            let mut bytes = bytes.clone();
            bytes[at] ^= change;
            // The changed bytes include the corner and the step of a chunk, its ticks, and the
            // header.
            let read = Recording::read(&bytes[..], &tables);
            assert!(read.is_err(), "byte {at}, change {change}");
        }
        assert!(Recording::read(&bytes[..at], &tables).is_err());
    }
    let longer = [&bytes[..], b"x"].concat();
    assert!(Recording::read(&longer[..], &tables).is_err());
}

/// Returns the error message of `replay` for a changed folder.
fn error(results: &Results) -> String {
    let page = results.path().join("page.html");
    let outcome = stochc("replay --run 0 --out", &[&page, &results.path()]);
    assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
    assert!(!page.exists());
    outcome.err
}

#[test]
fn an_unusable_recording_is_reported() {
    let results = Results::from_records(DENSE, "--record all");
    let path = results.recording_path(0);
    let whole = fs::read(&path).unwrap();
    let with = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = whole.clone();
        change(&mut bytes);
        fs::write(&path, bytes).unwrap();
        let outcome = error(&results);
        assert!(outcome.contains("remove it"), "{outcome}");
        outcome
    };
    let outcome = with(&|bytes| bytes.truncate(bytes.len() - 1));
    assert!(outcome.contains("truncated after tick"), "{outcome}");
    assert!(with(&|bytes| bytes.truncate(13)).contains("truncated"));
    assert!(with(&|bytes| bytes.clear()).contains("not a recording of a run"));
    assert!(with(&|bytes| bytes[0] = b'x').contains("not a recording of a run"));
    assert!(with(&|bytes| bytes[8] = 9).contains("version 9"));
    let middle = whole.len() / 2;
    assert!(with(&|bytes| bytes[middle] ^= 0x10).contains("damaged"));
    let other = fs::read(results.recording_path(1)).unwrap();
    assert!(with(&|bytes| bytes.clone_from(&other)).contains("another run"));
    // Without a recording, the run is repeated.
    fs::remove_file(&path).unwrap();
    results.page(0);
    assert!(fs::read(&path).unwrap() == whole);
}

#[test]
fn a_changed_program_is_rejected() {
    let results = Results::from_records(DENSE, "");
    let manifest = results.path().join("manifest.json");
    let text = fs::read_to_string(&manifest).unwrap();
    // The program stored in the folder counts, and all files must be consistent.
    fs::write(&manifest, text.replace("T[1..2]", "T[1..3]")).unwrap();
    let outcome = error(&results);
    assert!(outcome.contains("changed by hand"), "{outcome}");
    // Deliberate changes give the same result.
    fs::remove_file(results.path().join("checksums.json")).unwrap();
    let outcome = error(&results);
    assert!(
        outcome.contains("does not belong to the `manifest.json`"),
        "{outcome}"
    );
    // Even without a journal, an invalid program is not run.
    fs::remove_file(results.path().join("journal.jsonl")).unwrap();
    let corrupted = text.replacen("\"duties\":[{\"role\":0", "\"duties\":[{\"role\":900", 1);
    assert_ne!(corrupted, text);
    fs::write(&manifest, corrupted).unwrap();
    let outcome = error(&results);
    assert!(outcome.contains("it is damaged"), "{outcome}");
}

#[test]
fn a_run_with_a_different_result_is_rejected() {
    let results = Results::from_records(DENSE, "");
    let journal = results.path().join("journal.jsonl");
    let text = fs::read_to_string(&journal).unwrap();
    // The lines have the checksums that another build would have written.
    let lines = text.lines().map(|line| {
        let (object, _) = line.rsplit_once(",\"crc\"").unwrap();
        sealed(object.replace("\"hops\":", "\"hops\":1") + "}") + "\n"
    });
    fs::write(&journal, lines.collect::<String>()).unwrap();
    let outcome = error(&results);
    assert!(
        outcome.contains("differs from the one in the folder"),
        "{outcome}"
    );
}

#[test]
fn invalid_requests_are_reported() {
    let results = Results::from_records(DENSE, "");
    let outcome = stochc("replay --run 2", &[&results.path()]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("run 2 is not among runs 0..1"),
        "{}",
        outcome.err
    );
    let outcome = stochc("replay --run 0 --program tower", &[&results.path()]);
    assert!(
        outcome.err.contains("no program `tower`, but `dense`"),
        "{}",
        outcome.err
    );
    let outcome = stochc("replay --run 0 tests", &[]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("contains no results"),
        "{}",
        outcome.err
    );
    for line in [
        "replay tests",
        "simulate tests/fixtures/dense.sa --record 0",
        "simulate tests/fixtures/dense.sa --out nowhere --record 3..1",
        "simulate tests/fixtures/dense.sa --out nowhere --record-every 2",
    ] {
        let outcome = stochc(line, &[]);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{line}");
    }
    let line = "simulate --model shuffle tests/fixtures/dense.sa --record 0 --out nowhere";
    let outcome = stochc(line, &[]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("use `--model rigid`"),
        "{}",
        outcome.err
    );
    assert!(!fs::exists("nowhere").unwrap());
}

#[test]
fn a_read_only_folder_is_shown() {
    let results = Results::from_records(DENSE, "");
    // A file with this name prevents creating the folder for recordings, even for root.
    fs::write(results.path().join("recordings"), "").unwrap();
    let page = results.page(0);
    assert!(fs::metadata(page).unwrap().len() > 10_000);
}
