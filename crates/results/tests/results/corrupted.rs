//! Tests flipped bits in files. Each is detected, none causes a panic, and valid data are saved.
use std::fs;
use std::path::Path;

use stochc_results::integrity::{Integrity, repair, verify};
use stochc_results::{Folder, FolderError};

use crate::world::{bytes, complete, manifest, put};

const FILES: [&str; 5] = [
    "manifest.json",
    "journal.jsonl",
    "checksums.json",
    "runs.parquet",
    "bonds.parquet",
];

/// Returns whether reading or resuming a folder reports that it is corrupted.
fn is_reported(folder: &Path) -> bool {
    let read = Folder::read(folder).map_or(true, |contents| !contents.damage.is_empty());
    let opened =
        Folder::open(folder, &manifest(4), true).map_or(true, |it| !it.damage().is_empty());
    assert_eq!(read, opened);
    read
}

fn corrupted(folder: &Path) -> Vec<String> {
    let files = verify(folder).unwrap().into_iter();
    let corrupted = files.filter(|file| file.health.is_corrupted());
    corrupted.map(|file| file.name).collect()
}

#[test]
fn every_flipped_bit_is_found() {
    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), &manifest(4), 1);
    assert!(!is_reported(folder.path()));
    assert!(corrupted(folder.path()).is_empty());
    for name in FILES {
        let path = folder.path().join(name);
        let whole = fs::read(&path).unwrap();
        let bits = 8 * whole.len();
        // The step is odd, so that all bits of a byte are tested.
        for bit in (0..bits).step_by((bits / 150) | 1) {
            let mut flipped = whole.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            put(&path, &flipped);
            assert!(is_reported(folder.path()), "bit {bit} of {name}");
            let mut found = corrupted(folder.path());
            // Runs can contradict the changed manifest. Their journal is then reported, too.
            found.retain(|it| name != "manifest.json" || it != "journal.jsonl");
            assert_eq!(found, [name], "bit {bit}");
            // Opening may have removed a partial line at the end of a journal.
            put(&path, &whole);
        }
        // A missing last byte is also detected.
        put(&path, &whole[..whole.len() - 1]);
        assert_eq!(corrupted(folder.path()), [name]);
        put(&path, &whole);
    }
    assert!(corrupted(folder.path()).is_empty());
}

#[test]
fn valid_parts_are_repaired_and_corrupted_ones_moved_aside() {
    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), &manifest(4), 1);
    let tables = bytes(folder.path());
    let valid: Vec<_> = FILES
        .map(|name| fs::read(folder.path().join(name)).unwrap())
        .into();
    for (name, whole) in FILES.iter().zip(&valid).skip(1) {
        for at in [0, 15, whole.len() / 2, whole.len() - 1] {
            let path = folder.path().join(name);
            let mut flipped = whole.clone();
            flipped[at] ^= 0x04;
            put(&path, &flipped);
            repair(folder.path(), |_, _| Ok(Vec::new())).unwrap();
            assert!(corrupted(folder.path()).is_empty(), "byte {at} of {name}");
            let contents = Folder::read(folder.path()).unwrap();
            assert_eq!(contents.manifest, manifest(4));
            assert!(contents.finished.len() >= 7, "byte {at} of {name}");
            let mut aside = fs::read_dir(folder.path().join("damaged")).unwrap();
            let is_saved = aside.any(|it| fs::read(it.unwrap().path()).unwrap() == flipped);
            assert!(is_saved, "byte {at} of {name}");
            complete(folder.path(), &manifest(4), 2);
            assert!(bytes(folder.path()) == tables, "byte {at} of {name}");
        }
    }
}

/// Checks that a folder in place of a file is reported by name, or moved aside as a corrupted file.
#[test]
fn special_files_are_moved_aside_or_named() {
    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), &manifest(4), 1);
    let tables = bytes(folder.path());
    let in_folder = |name: &str| folder.path().join(name);
    fs::write(in_folder("checkpoints"), "").unwrap();
    fs::remove_file(in_folder("journal.jsonl")).unwrap();
    fs::create_dir(in_folder("journal.jsonl")).unwrap();
    assert_eq!(corrupted(folder.path()), ["journal.jsonl", "checkpoints"]);
    repair(folder.path(), |_, _| Ok(Vec::new())).unwrap();
    assert!(corrupted(folder.path()).is_empty());
    assert!(in_folder("damaged/journal.jsonl").is_dir());
    complete(folder.path(), &manifest(4), 2);
    assert!(bytes(folder.path()) == tables);

    fs::remove_file(in_folder("manifest.json")).unwrap();
    fs::create_dir(in_folder("manifest.json")).unwrap();
    for error in [
        Folder::read(folder.path()).map(drop).unwrap_err(),
        verify(folder.path()).map(drop).unwrap_err(),
    ] {
        let message = error.to_string();
        assert!(
            message.ends_with("manifest.json`: it is a folder"),
            "{message}"
        );
    }
}

#[test]
fn a_corrupted_manifest_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), &manifest(4), 1);
    let path = folder.path().join("manifest.json");
    let mut bytes = fs::read(&path).unwrap();
    bytes[100..120].fill(b'#');
    put(&path, &bytes);
    let error = repair(folder.path(), |_, _| Ok(Vec::new())).unwrap_err();
    assert!(matches!(error, FolderError::LostManifest(_)), "{error}");
    assert!(fs::read(&path).unwrap() == bytes);
    // The checksums still distinguish valid and corrupted files.
    let table = folder.path().join("runs.parquet");
    let mut bytes = fs::read(&table).unwrap();
    bytes[50] ^= 0x10;
    put(&table, &bytes);
    assert_eq!(corrupted(folder.path()), ["manifest.json", "runs.parquet"]);
    let files = verify(folder.path()).unwrap();
    let valid = |name: &str| {
        let mut of_name = files.iter().filter(|it| it.name == name);
        of_name.any(|it| it.health == Integrity::Valid)
    };
    assert!(
        valid("journal.jsonl") && valid("bonds.parquet"),
        "{files:?}"
    );
}

/// Returns the journal lines of a finished folder without checksums. [`sealed`] adds the checksums.
fn unsealed(folder: &Path, runs: u64) -> Vec<String> {
    complete(folder, &manifest(runs), 1);
    fs::remove_file(folder.join("checksums.json")).unwrap();
    let text = fs::read_to_string(folder.join("journal.jsonl")).unwrap();
    let line = |line: &str| line.rsplit_once(",\"crc\"").unwrap().0.to_owned() + "}";
    text.lines().map(line).collect()
}

fn sealed(lines: &[String]) -> String {
    let lines = lines.iter().cloned();
    lines
        .map(|line| stochc_files::checksum::sealed(line) + "\n")
        .collect()
}

#[test]
fn impossible_records_are_reported_and_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let mut lines = unsealed(folder.path(), 4);
    let mut manifest = manifest(4);
    manifest.settings.max_ticks = Some(1_000);
    put(&folder.path().join("manifest.json"), manifest.to_json());
    let before = crate::world::manifest(4).identity();
    lines[0] = lines[0].replace(&before, &manifest.identity());
    let first = lines[1].clone();
    for (what, with, reason) in [
        (
            "\"ticks\":",
            "\"ticks\":9999",
            "beyond `--max-ticks` (1000)",
        ),
        ("\"docked\":", "\"docked\":9999", "after its end"),
        ("\"program\":0", "\"program\":2", "program 2 does not exist"),
        ("\"run\":0", "\"run\":4", "run 4 is not among runs 0..3"),
        ("\"child\":1", "\"child\":7", "no such role"),
        ("\"phase\":0", "\"phase\":7", "no such phase"),
        ("\"cell\":[-1,0,1]", "\"cell\":[0,0,0]", "no such event"),
        ("\"face\":\"up\"", "\"face\":\"down\"", "no such event"),
        ("\"phase\":0", "\"phase\":1", "no such event"),
        ("\"body\":", "\"body\":9999", "no such block"),
        ("\"role\":1", "\"role\":9", "no such role"),
    ] {
        lines[1] = first.replacen(what, with, 1);
        assert_ne!(lines[1], first, "{what}");
        put(&folder.path().join("journal.jsonl"), sealed(&lines));
        let contents = Folder::read(folder.path()).unwrap();
        assert_eq!(contents.finished.len(), 7, "{what}");
        assert!(contents.damage[0].contains(reason), "{:?}", contents.damage);
    }
}

#[test]
fn impossible_aborted_attempts_are_reported_and_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let mut lines = unsealed(folder.path(), 40);
    let has_capture = |line: &String| {
        let aborts = line.split_once("\"aborts\":");
        aborts.is_some_and(|(_, aborts)| aborts.contains("docked"))
    };
    let at = lines.iter().position(has_capture).unwrap();
    let first: serde_json::Value = serde_json::from_str(&lines[at]).unwrap();
    for (what, with, reason) in [
        ("phase", 0, "in another phase"),
        ("tick", 0, "outside of the attempt"),
        ("retried", 1, "outside of the attempt"),
        ("bonds/0/magnetized", 0, "outside of the attempt"),
        ("bonds/0/phase", 0, "in another phase"),
        ("bonds/0/child", 1, "has not captured"),
        ("releases/0/body", 1, "has not captured"),
        ("bonds/0/cell/2", 5, "no such event"),
    ] {
        let mut changed = first.clone();
        let pointer = format!("/record/aborts/0/{what}");
        *changed.pointer_mut(&pointer).unwrap() = with.into();
        lines[at] = changed.to_string();
        put(&folder.path().join("journal.jsonl"), sealed(&lines));
        let contents = Folder::read(folder.path()).unwrap();
        assert_eq!(contents.finished.len(), 79, "{what}");
        assert!(contents.damage[0].contains(reason), "{:?}", contents.damage);
    }
}

/// Checks that tables with lost runs are kept, because they contain more than tables from the
/// journal.
#[test]
fn tables_of_lost_runs_are_saved() {
    let folder = tempfile::tempdir().unwrap();
    let in_folder = |name: &str| folder.path().join(name);
    complete(folder.path(), &manifest(4), 1);
    let tables = bytes(folder.path());
    fs::remove_file(in_folder("journal.jsonl")).unwrap();
    repair(folder.path(), |_, _| Ok(Vec::new())).unwrap();
    assert!(bytes(&in_folder("damaged")) == tables);
    complete(folder.path(), &manifest(4), 2);
    assert!(bytes(folder.path()) == tables);
}

/// Checks that a line with an impossible run stays invalid when more runs are made.
#[test]
fn a_rejected_line_stays_out_when_runs_are_added() {
    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), &manifest(6), 1);
    let tables = bytes(folder.path());
    let journal = fs::read_to_string(folder.path().join("journal.jsonl")).unwrap();
    let line = journal.lines().find(|line| line.contains("\"run\":5,"));
    let mut foreign: serde_json::Value = serde_json::from_str(line.unwrap()).unwrap();
    let foreign = foreign.as_object_mut().unwrap();
    foreign.remove("crc").unwrap();
    let hops = foreign["record"]["hops"].as_u64().unwrap();
    foreign.get_mut("record").unwrap()["hops"] = (hops + 1000).into();
    let foreign = stochc_files::checksum::sealed(serde_json::to_string(foreign).unwrap());

    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), &manifest(4), 1);
    let path = folder.path().join("journal.jsonl");
    let with_it = fs::read_to_string(&path).unwrap() + &foreign + "\n";
    put(&path, &with_it);
    assert_eq!(corrupted(folder.path()), ["journal.jsonl"]);
    complete(folder.path(), &manifest(6), 1);
    assert!(bytes(folder.path()) == tables);
    let aside = folder.path().join("damaged/journal.jsonl");
    assert_eq!(fs::read_to_string(aside).unwrap(), with_it);
}

/// Checks that a line without its checksum counts as corrupted.
#[test]
fn a_line_without_its_checksum_is_not_saved() {
    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), &manifest(4), 1);
    let tables = bytes(folder.path());
    let path = folder.path().join("journal.jsonl");
    let journal = fs::read_to_string(&path).unwrap();
    let line = journal.lines().nth(2).unwrap();
    let (object, _) = line.rsplit_once(",\"crc\"").unwrap();
    let other = object.replacen("\"hops\":", "\"hops\":7", 1) + "}";
    assert_ne!(other.len(), object.len() + 1);
    put(&path, journal.replace(line, &other));
    assert_eq!(corrupted(folder.path()), ["journal.jsonl"]);
    repair(folder.path(), |_, _| Ok(Vec::new())).unwrap();
    assert_eq!(Folder::read(folder.path()).unwrap().finished.len(), 7);
    complete(folder.path(), &manifest(4), 1);
    assert!(bytes(folder.path()) == tables);
}

/// Checks a journal with a line that is longer than any run. Lines before it are saved, lines after
/// it are not read.
#[test]
fn lines_before_endless_garbage_are_saved() {
    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), &manifest(4), 1);
    let path = folder.path().join("journal.jsonl");
    let journal = fs::read_to_string(&path).unwrap();
    let garbage = "x".repeat(70 << 20);
    for (whole, left) in [(3, 2), (9, 8)] {
        let before: String = journal.split_inclusive('\n').take(whole).collect();
        put(
            &path,
            format!("{before}{garbage}\n{}", &journal[before.len()..]),
        );
        assert_eq!(corrupted(folder.path()), ["journal.jsonl"]);
        assert!(Folder::read(folder.path()).is_err());
        repair(folder.path(), |_, _| Ok(Vec::new())).unwrap();
        assert_eq!(Folder::read(folder.path()).unwrap().finished.len(), left);
        assert!(corrupted(folder.path()).is_empty());
    }
}

/// Checks that a rejected extension leaves the folder unchanged, even if the folder is corrupted.
#[test]
fn a_refused_extension_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), &manifest(4), 1);
    fs::remove_file(folder.path().join("checksums.json")).unwrap();
    let mut other = manifest(4);
    other.builds = vec!["0123456789abcdef".to_owned()];
    put(&folder.path().join("manifest.json"), other.to_json());
    let path = folder.path().join("journal.jsonl");
    let corrupted = fs::read_to_string(&path)
        .unwrap()
        .replacen("\"ticks\":", "\"tocks\":", 1);
    put(&path, &corrupted);
    let error = Folder::open(folder.path(), &manifest(6), true).unwrap_err();
    assert!(matches!(error, FolderError::OtherBuild { .. }), "{error}");
    // Opening the folder for resuming does not change it before the first run.
    let resumed = Folder::open(
        folder.path(),
        &manifest(6),
        stochc_results::Resume::MixedBuilds,
    );
    assert_eq!(resumed.unwrap().damage().len(), 1);
    assert_eq!(fs::read_to_string(&path).unwrap(), corrupted);
    assert!(!folder.path().join("damaged").exists());
}
