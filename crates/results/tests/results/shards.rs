//! Tests that merged shards equal an ensemble without shards, independent of how they were made.
use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::num::NonZeroUsize;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use stochc_files::checksum::sealed;
use stochc_ir::record::RunRecord;
use stochc_results::integrity::{Integrity, repair, verify};
use stochc_results::shards::{
    MAX_SHARDS, Prepared, Shard, ShardError, ShardState, merge, prepare, status,
};
use stochc_results::{Destination, Folder, FolderError, Manifest, this_build};

use crate::world::{bytes, complete, manifest, put, run_on, simulate};

const RUNS: u64 = 12;

/// Runs a shard. Returns whether the shard is complete.
fn make(folder: &Path, number: u64, threads: usize) -> bool {
    make_until(folder, number, threads, u64::MAX)
}

/// Runs a shard until this number of runs have begun. Returns whether the shard is complete.
fn make_until(folder: &Path, number: u64, threads: usize, last: u64) -> bool {
    let shard = Shard::open(folder, number).unwrap();
    let progress = shard.progress(NonZeroUsize::new(threads).unwrap());
    let (stop, begun) = (AtomicBool::new(false), AtomicU64::new(0));
    let made = shard.make(&progress, &stop, |program, run, watch| {
        stop.fetch_or(
            begun.fetch_add(1, Ordering::Relaxed) == last,
            Ordering::Relaxed,
        );
        simulate(program, run, watch)
    });
    made.unwrap()
}

fn cut(folder: &Path, shards: u64) -> Manifest {
    let manifest = manifest(RUNS);
    assert_eq!(prepare(folder, &manifest, shards).unwrap(), Prepared::New);
    manifest
}

fn put_together(folder: &Path) -> Result<u64, ShardError> {
    merge(folder, |_, finished| {
        Ok(vec![(
            "count.txt".to_owned(),
            finished.len().to_string().into_bytes(),
        )])
    })
}

/// Returns the content of every file in a folder, by name.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if entry.path().is_dir() {
            found.extend(
                files(&entry.path())
                    .into_iter()
                    .map(|(file, content)| (format!("{name}/{file}"), content)),
            )
        } else {
            found.insert(name, fs::read(entry.path()).unwrap());
        }
    }
    found
}

/// Returns the files of the same ensemble without shards, made on one thread.
fn whole() -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let never = AtomicBool::new(false);
    let opened = Folder::open(folder.path(), &manifest(RUNS), false).unwrap();
    let opened = opened.with(|_, finished| {
        Ok(vec![(
            "count.txt".to_owned(),
            finished.len().to_string().into_bytes(),
        )])
    });
    run_on(1, Destination::Folder(opened), &never, simulate).unwrap();
    files(folder.path())
}

fn missing(folder: &Path) -> Vec<u64> {
    status(folder).unwrap().missing().collect()
}

#[test]
fn any_number_of_shards_in_any_order_makes_the_same_folder() {
    let whole = whole();
    for shards in [1, 2, 3, 5, 7, 23, 24] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        cut(path, shards);
        // 29 has no common divisor with these numbers, so each shard occurs exactly once.
        let order = (0..shards).map(|i| (i * 29 + 11) % shards);
        for (i, number) in order.enumerate() {
            assert!(missing(path).contains(&number));
            assert!(make(path, number, 1 + i % 3));
            let before = files(path);
            assert!(make(path, number, 1), "a repeated shard");
            assert_eq!(
                files(path),
                before,
                "nothing is written for a complete shard"
            );
            assert!(!missing(path).contains(&number));
        }
        assert_eq!(put_together(path).unwrap(), 2 * RUNS);
        assert!(files(path) == whole, "{shards} shards");
        let read = Folder::read(path).unwrap();
        assert_eq!(
            (read.finished.len() as u64, read.damage.len()),
            (2 * RUNS, 0)
        );
    }
}

/// Checks several processes that detect the same corrupted shard. Only one of them moves it.
#[test]
fn several_processes_may_repair_a_shard() {
    for _ in 0..20 {
        let folder = tempfile::tempdir().unwrap();
        cut(folder.path(), 2);
        assert!(make(folder.path(), 0, 1));
        let file = folder.path().join("shards/0.jsonl");
        let content = fs::read(&file).unwrap();
        fs::write(&file, &content[..content.len() / 2]).unwrap();
        let start = std::sync::Barrier::new(4);
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    start.wait();
                    assert_eq!(Shard::open(folder.path(), 0).unwrap().runs(), (RUNS, 0));
                });
            }
        });
        assert_eq!(
            fs::read_dir(folder.path().join("damaged")).unwrap().count(),
            1
        );
    }
}

#[test]
fn a_merged_folder_can_be_extended() {
    let [folder, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    cut(folder.path(), 4);
    (0..4).for_each(|number| assert!(make(folder.path(), number, 2)));
    put_together(folder.path()).unwrap();
    complete(folder.path(), &manifest(RUNS + 5), 2);
    complete(other.path(), &manifest(RUNS + 5), 1);
    assert!(bytes(folder.path()) == bytes(other.path()));
}

#[test]
fn a_stopped_shard_resumes() {
    let whole = whole();
    let folder = tempfile::tempdir().unwrap();
    cut(folder.path(), 2);
    for (begun, stored) in [(3, 3), (2, 5), (4, 9)] {
        assert!(!make_until(folder.path(), 1, 1, begun));
        let state = &status(folder.path()).unwrap().states[1];
        assert_eq!(*state, ShardState::Begun { runs: stored });
        let shard = Shard::open(folder.path(), 1).unwrap();
        assert_eq!(shard.runs(), (RUNS, stored));
        shard
            .check_stored(|program, run| Ok(recorded(program, run)))
            .unwrap();
        let other = |program, run| {
            let mut record = recorded(program, run);
            record.hops += 1;
            Ok(record)
        };
        let message = shard.check_stored(other).unwrap_err().to_string();
        assert!(message.contains("does not come out as it is"), "{message}");
    }
    assert!(make(folder.path(), 1, 2));
    assert!(make(folder.path(), 0, 2));
    put_together(folder.path()).unwrap();
    assert!(files(folder.path()) == whole);
}

/// Returns the record that the model makes for a run.
fn recorded(program: usize, run: u64) -> RunRecord {
    let (all, never) = (manifest(RUNS), AtomicBool::new(false));
    let results = run_on(1, Destination::Memory(&all), &never, simulate).unwrap();
    results.finished.get(program, run).unwrap().unwrap().record
}

#[test]
fn a_truncated_line_of_a_killed_shard_loses_one_run() {
    let folder = tempfile::tempdir().unwrap();
    cut(folder.path(), 2);
    assert!(!make_until(folder.path(), 0, 1, 4));
    let shards = folder.path().join("shards");
    let entry = fs::read_dir(&shards).unwrap().next().unwrap().unwrap();
    let (part, whole) = (entry.path(), fs::read(entry.path()).unwrap());
    let mut expected = None;
    for end in (0..=whole.len()).rev().step_by(61) {
        put(&part, &whole[..end]);
        let lines = whole[..end].iter().filter(|byte| **byte == b'\n').count() as u64;
        let stored = Shard::open(folder.path(), 0).unwrap().runs().1;
        assert_eq!(stored, lines.saturating_sub(1), "cut at {end}");
        assert!(make(folder.path(), 0, 1));
        let shard = fs::read(shards.join("0.jsonl")).unwrap();
        assert!(
            *expected.get_or_insert(shard.clone()) == shard,
            "cut at {end}"
        );
        fs::remove_file(shards.join("0.jsonl")).unwrap();
    }
}

#[test]
fn two_processes_make_the_same_shard() {
    let whole = whole();
    for _ in 0..5 {
        let folder = tempfile::tempdir().unwrap();
        cut(folder.path(), 2);
        std::thread::scope(|scope| {
            for number in [0, 1, 0, 1, 0] {
                let path = folder.path();
                scope.spawn(move || assert!(make(path, number, 1)));
            }
        });
        put_together(folder.path()).unwrap();
        assert!(files(folder.path()) == whole);
    }
}

/// Checks the states that a kill can leave at each step of a merge.
#[test]
fn an_interrupted_merge_resumes() {
    let whole = whole();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    cut(path, 3);
    (0..3).for_each(|number| assert!(make(path, number, 1)));
    let shards = files(path);
    put_together(path).unwrap();
    for left in 0..=3 {
        for (name, content) in &shards {
            let number = name
                .strip_prefix("shards/")
                .and_then(|it| it.strip_suffix(".jsonl"));
            let is_left = number.map_or(name == "shards.json", |it| {
                it.parse::<u64>().unwrap() < left
            });
            if is_left {
                fs::create_dir_all(path.join("shards")).unwrap();
                put(&path.join(name), content);
            }
        }
        for name in ["runs.parquet", "checksums.json"]
            .iter()
            .skip(left as usize % 2)
        {
            fs::remove_file(path.join(name)).unwrap();
        }
        assert!(matches!(Folder::read(path), Err(FolderError::Split { .. })));
        assert!(missing(path).is_empty(), "{left} shards left");
        let before = files(path);
        for number in 0..3 {
            let shard = Shard::open(path, number).unwrap();
            assert!(shard.is_made(), "shard {number} of {left} left");
            assert!(make(path, number, 1));
        }
        assert!(files(path) == before, "{left} shards left");
        put_together(path).unwrap();
        assert!(files(path) == whole, "{left} shards left");
    }
}

/// Checks that files of users are kept, even if their names resemble the names of shards.
#[test]
fn a_merge_removes_shards_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    cut(path, 3);
    (0..3).for_each(|number| assert!(make(path, number, 1)));
    for name in ["shards/9.jsonl", "shards/note.txt"] {
        put(&path.join(name), "mine");
    }
    put_together(path).unwrap();
    let left: Vec<String> = files(path).into_keys().collect();
    let left: Vec<&String> = left
        .iter()
        .filter(|name| name.starts_with("shards"))
        .collect();
    assert_eq!(left, ["shards/9.jsonl", "shards/note.txt"]);
}

/// Checks that operations on the folder are rejected and change no file.
fn refused(folder: &Path, expected: &str) {
    let before = files(folder);
    let message = put_together(folder).unwrap_err().to_string();
    assert!(message.contains(expected), "{message}");
    let mut after = files(folder);
    after.remove(".lock");
    let mut before = before;
    before.remove(".lock");
    assert_eq!(
        before.keys().collect::<Vec<_>>(),
        after.keys().collect::<Vec<_>>()
    );
    assert!(before == after);
}

#[test]
fn missing_shards_are_named() {
    let folder = tempfile::tempdir().unwrap();
    cut(folder.path(), 5);
    refused(
        folder.path(),
        "5 of 5 shards are missing or corrupted (0, 1, 2, 3 and 4)",
    );
    for number in [0, 2, 4] {
        make(folder.path(), number, 1);
    }
    make_until(folder.path(), 3, 1, 2);
    assert_eq!(missing(folder.path()), [1, 3]);
    refused(
        folder.path(),
        "2 of 5 shards are missing or corrupted (1 and 3)",
    );
    make(folder.path(), 1, 1);
    refused(folder.path(), "stochc shard");
    assert!(matches!(
        put_together(folder.path()),
        Err(ShardError::Missing { shards, total: 5, .. }) if shards == [3]
    ));
}

#[test]
fn foreign_shards_are_rejected() {
    let [folder, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    cut(folder.path(), 2);
    let shard = folder.path().join("shards/1.jsonl");
    make(folder.path(), 0, 1);
    make(folder.path(), 1, 1);
    let own = fs::read(&shard).unwrap();
    let mut another = manifest(RUNS);
    another.seed = 7;
    let more = manifest(RUNS + 2);
    for (of, shards, number, expected) in [
        (&another, 2, 1, "shard 1 belongs to another manifest"),
        (
            &manifest(RUNS),
            2,
            0,
            "shard 1 is in fact shard 0 of 2, for 12 runs",
        ),
        (
            &manifest(RUNS),
            3,
            1,
            "shard 1 is in fact shard 1 of 3, for 12 runs",
        ),
        (&more, 2, 1, "shard 1 is in fact shard 1 of 2, for 14 runs"),
    ] {
        let root = other
            .path()
            .join(format!("{shards}-{number}-{}-{}", of.seed, of.runs));
        prepare(&root, of, shards).unwrap();
        make(&root, number, 1);
        fs::copy(root.join(format!("shards/{number}.jsonl")), &shard).unwrap();
        refused(folder.path(), expected);
        let message = Shard::open(folder.path(), 1).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
        let state = &status(folder.path()).unwrap().states[1];
        assert!(matches!(state, ShardState::Foreign { .. }), "{state:?}");
        assert_eq!(missing(folder.path()), [1]);
    }
    // This is the journal of an ordinary folder.
    complete(&other.path().join("plain"), &manifest(RUNS), 1);
    fs::copy(other.path().join("plain/journal.jsonl"), &shard).unwrap();
    refused(
        folder.path(),
        "shard 1 is in fact the journal of a whole ensemble",
    );
    // This is a shard of another build.
    let text = String::from_utf8(own.clone()).unwrap();
    let (first, rest) = text.split_once('\n').unwrap();
    let first = first[..first.rfind(",\"crc\"").unwrap()].to_owned() + "}";
    let first = first.replace(&this_build(), "0123456789abcdef");
    put(&shard, format!("{}\n{rest}", sealed(first)));
    refused(folder.path(), "another build of `stochc` (0123456789abcdef");
    put(&shard, own);
    put_together(folder.path()).unwrap();
}

#[test]
fn an_ensemble_of_another_build_is_not_split() {
    let folder = tempfile::tempdir().unwrap();
    let mut manifest = cut(folder.path(), 2);
    manifest.builds = vec!["0123456789abcdef".to_owned()];
    fs::remove_file(folder.path().join("checksums.json")).unwrap();
    for builds in [
        vec!["0123456789abcdef".to_owned()],
        vec![this_build(), "0123456789abcdef".to_owned()],
    ] {
        manifest.builds = builds;
        put(&folder.path().join("manifest.json"), manifest.to_json());
        let message = Shard::open(folder.path(), 0).unwrap_err().to_string();
        assert!(
            message.contains("run its shards with the `stochc` that split it"),
            "{message}"
        );
        let message = prepare(folder.path(), &self::manifest(RUNS), 2)
            .unwrap_err()
            .to_string();
        assert!(message.contains("another build"), "{message}");
    }
}

#[test]
fn ensembles_that_cannot_be_split_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("new");
    for requested in [0, 2 * RUNS + 1, 1_000_000_000, u64::MAX] {
        let error = prepare(&root, &manifest(RUNS), requested).unwrap_err();
        assert!(matches!(error, ShardError::InvalidSplit { .. }), "{error}");
        assert!(!root.exists());
    }
    let many = prepare(&root, &manifest(10_000_000), MAX_SHARDS + 1);
    assert!(many.is_err() && !root.exists());
    cut(&root, 4);
    assert_eq!(
        prepare(&root, &manifest(RUNS), 4).unwrap(),
        Prepared::Already
    );
    let before = files(&root);
    for (runs, shards) in [(RUNS, 3), (RUNS + 1, 4), (RUNS - 1, 4)] {
        let message = prepare(&root, &manifest(runs), shards)
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("is split into 4 shards of 12 runs of each program"),
            "{message}"
        );
    }
    for number in [4, u64::MAX] {
        let message = Shard::open(&root, number).unwrap_err().to_string();
        assert!(message.ends_with("shards are 0 to 3"), "{message}");
    }
    for resume in [false, true] {
        let error = Folder::open(&root, &manifest(RUNS), resume).unwrap_err();
        assert!(matches!(error, FolderError::Split { .. }), "{error}");
    }
    assert!(files(&root) == before);
    // Test folders without shards, finished or not, and a missing folder.
    let plain = folder.path().join("plain");
    complete(&plain, &manifest(RUNS), 1);
    let before = files(&plain);
    let message = prepare(&plain, &manifest(RUNS), 4).unwrap_err().to_string();
    assert!(
        message.contains("holds 24 runs of this ensemble already"),
        "{message}"
    );
    for message in [
        put_together(&plain).unwrap_err(),
        Shard::open(&plain, 0).unwrap_err(),
        status(&plain).unwrap_err(),
    ] {
        assert!(
            message
                .to_string()
                .contains("has no shards: it holds 24 of 24 runs"),
            "{message}"
        );
    }
    assert!(files(&plain) == before);
    let message = status(&folder.path().join("nothing"))
        .unwrap_err()
        .to_string();
    assert!(message.contains("contains no results"), "{message}");
}

#[test]
fn corrupted_shards_are_found_and_rerun() {
    let whole = whole();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    cut(path, 2);
    make(path, 0, 1);
    make(path, 1, 1);
    assert!(
        verify(path)
            .unwrap()
            .iter()
            .all(|file| file.health == Integrity::Valid)
    );
    let shard = path.join("shards/1.jsonl");
    let valid = fs::read(&shard).unwrap();
    let bits = 8 * valid.len();
    let first_line = 8 * (valid.iter().position(|byte| *byte == b'\n').unwrap() + 1);
    for bit in (0..bits).step_by((bits / 60) | 1) {
        let mut flipped = valid.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        put(&shard, &flipped);
        let files = verify(path).unwrap();
        let corrupted: Vec<&str> = files
            .iter()
            .filter(|file| file.health.is_corrupted())
            .map(|file| file.name.as_str())
            .collect();
        assert_eq!(corrupted, ["shards/1.jsonl"], "bit {bit}");
        if bit < first_line {
            assert_eq!(missing(path), [1]);
        }
        assert!(
            matches!(put_together(path), Err(ShardError::Missing { shards, .. }) if shards == [1])
        );
    }
    // These shards are truncated, also at the end of a line, or too long.
    let last = valid[..valid.len() - 1]
        .iter()
        .rposition(|byte| *byte == b'\n')
        .unwrap();
    let twice = [&valid[..], &valid[last + 1..]].concat();
    for content in [
        &valid[..last + 1],
        &valid[..valid.len() - 1],
        &valid[..40],
        &[],
        &twice,
    ] {
        put(&shard, content);
        assert!(
            verify(path)
                .unwrap()
                .iter()
                .any(|file| file.health.is_corrupted())
        );
        refused(path, "(1)");
    }
    // The corrupted shard is moved aside, and its runs are made again.
    assert!(make(path, 1, 1));
    assert_eq!(fs::read(&shard).unwrap(), valid);
    assert_eq!(fs::read(path.join("damaged/1.jsonl")).unwrap(), twice);
    put(&shard, &twice);
    repair(path, |_, _| Ok(Vec::new())).unwrap();
    assert_eq!(missing(path), [1]);
    assert!(
        verify(path)
            .unwrap()
            .iter()
            .all(|file| file.health == Integrity::Valid)
    );
    assert!(make(path, 1, 1));
    fs::remove_dir_all(path.join("damaged")).unwrap();
    put_together(path).unwrap();
    assert!(files(path) == whole);
}

#[test]
fn a_corrupted_split_or_manifest_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    cut(path, 2);
    make(path, 0, 1);
    for name in ["shards.json", "manifest.json", "checksums.json"] {
        let valid = fs::read(path.join(name)).unwrap();
        for bit in [9, 8 * valid.len() / 2 + 3, 8 * valid.len() - 20] {
            let mut flipped = valid.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            put(&path.join(name), &flipped);
            let files = verify(path).unwrap();
            let corrupted = files
                .iter()
                .find(|file| file.health.is_corrupted())
                .unwrap();
            assert_eq!(corrupted.name, name);
            let repaired = repair(path, |_, _| Ok(Vec::new()));
            let left = match (name, repaired) {
                ("shards.json", Err(FolderError::LostSplit(_)))
                | ("manifest.json", Err(FolderError::LostManifest(_))) => &flipped,
                ("checksums.json", Ok(())) => &valid,
                (_, repaired) => panic!("bit {bit} of {name}: {repaired:?}"),
            };
            assert!(fs::read(path.join(name)).unwrap() == *left, "{name}");
            put(&path.join(name), &valid);
            assert_eq!(missing(path), [1]);
        }
    }
}

/// Environment variable with the results folder of a process that is killed.
const VICTIM: &str = "STOCHC_TEST_PIECE";

#[test]
fn a_kill_loses_no_finished_run_of_a_shard() {
    let folder = tempfile::tempdir().unwrap();
    cut(folder.path(), 2);
    for kill in 1..=3 {
        let mut victim = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "shards::victim", "--ignored", "--nocapture"])
            .env(VICTIM, folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let output = BufReader::new(victim.stdout.take().unwrap());
        assert!(output.lines().any(|line| line.unwrap().contains("stuck")));
        victim.kill().unwrap();
        victim.wait().unwrap();
        let shard = Shard::open(folder.path(), 1).unwrap();
        assert_eq!(shard.runs(), (RUNS, 3 * kill));
    }
    assert!(make(folder.path(), 1, 2));
    assert!(make(folder.path(), 0, 2));
    put_together(folder.path()).unwrap();
    assert!(files(folder.path()) == whole());
}

#[test]
#[ignore = "the process that `a_kill_loses_no_finished_run_of_a_shard` kills"]
fn victim() {
    let Some(path) = std::env::var_os(VICTIM) else {
        return;
    };
    let shard = Shard::open(Path::new(&path), 1).unwrap();
    let (never, begun) = (AtomicBool::new(false), AtomicU64::new(0));
    let progress = shard.progress(NonZeroUsize::MIN);
    let made = shard.make(&progress, &never, |program, run, watch| {
        if begun.fetch_add(1, Ordering::Relaxed) == 3 {
            let _ = writeln!(std::io::stdout(), "stuck");
            loop {
                std::thread::park();
            }
        }
        simulate(program, run, watch)
    });
    made.unwrap();
}
