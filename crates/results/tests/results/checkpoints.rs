//! Tests that runs resume from their checkpoints, and that checkpoints have no other effect.
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use stochc_ir::record::RunRecord;
use stochc_ir::state::StateWriter;
use stochc_results::integrity::{repair, verify};
use stochc_results::shards::{Shard, merge, prepare};
use stochc_results::{
    CHECKPOINTS, Destination, Folder, Interval, Manifest, Progress, RunCancelled, RunWatch,
};
use stochc_runtime::{Model, Settings, Watch as _};

use crate::world::{EVERY, bytes, complete, manifest, put, run_on, simulate};

/// Program index and number of the run that is stopped.
const LAST: (usize, u64) = (1, 2);

/// Starts an ensemble, and stops it during one of its runs. Saves the state of that run at its last
/// tick.
fn stopped(root: &Path, manifest: &Manifest) {
    let folder = Folder::open(root, manifest, false).unwrap();
    let folder = folder.with_checkpoints(EVERY).unwrap();
    let stop = AtomicBool::new(false);
    let simulate = |program, run, watch: &RunWatch| {
        if (program, run) == LAST {
            // The stop comes at the beginning of the run, so its first checkpoint is at the next
            // tick.
            stop.store(true, Ordering::Relaxed);
            return stopped_run(watch);
        }
        simulate(program, run, watch)
    };
    let results = run_on(1, Destination::Folder(folder), &stop, simulate).unwrap();
    assert!(!results.complete);
}

/// Makes a run that is stopped at tick 70.
fn stopped_run(mut watch: &RunWatch) -> Result<RunRecord, RunCancelled> {
    let flow = watch.tick(70, stochc_ir::table::PhaseId(0));
    assert!(flow.is_break() && watch.wants_state());
    watch.keep(&mut |to| to.put(&70u64));
    Err(RunCancelled)
}

fn checkpoint(root: &Path) -> PathBuf {
    let (program, run) = LAST;
    root.join(CHECKPOINTS)
        .join(format!("{program}-{run}.state"))
}

/// Resumes an ensemble. Returns the messages about its checkpoints.
fn resumed(root: &Path, manifest: &Manifest) -> Vec<String> {
    let folder = Folder::open(root, manifest, true).unwrap();
    let folder = folder.with_checkpoints(EVERY).unwrap();
    let checkpoints = folder.checkpoints().unwrap().clone();
    let mut notes = checkpoints.notes();
    let never = AtomicBool::new(false);
    let results = run_on(1, Destination::Folder(folder), &never, simulate).unwrap();
    assert!(results.complete);
    notes.extend(checkpoints.notes());
    notes
}

/// Returns the tables of an ensemble that was never interrupted.
fn undisturbed(manifest: &Manifest) -> Vec<Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), manifest, 1);
    assert!(!folder.path().join(CHECKPOINTS).exists());
    bytes(folder.path())
}

#[test]
fn a_stopped_run_resumes_from_its_checkpoint() {
    let (folder, manifest) = (tempfile::tempdir().unwrap(), manifest(4));
    stopped(folder.path(), &manifest);
    let health = verify(folder.path()).unwrap();
    let name = format!("{CHECKPOINTS}/1-2.state");
    let known = health.iter().find(|file| file.name == name).unwrap();
    assert!(!known.health.is_corrupted());
    let notes = resumed(folder.path(), &manifest);
    assert_eq!(
        notes,
        ["run 2 of `right` resumes from its checkpoint at tick 70"]
    );
    assert!(bytes(folder.path()) == undisturbed(&manifest));
    assert!(!folder.path().join(CHECKPOINTS).exists());
}

#[test]
fn a_corrupted_checkpoint_is_moved_aside_and_its_run_restarts() {
    let manifest = manifest(4);
    let tables = undisturbed(&manifest);
    let valid = {
        let folder = tempfile::tempdir().unwrap();
        stopped(folder.path(), &manifest);
        fs::read(checkpoint(folder.path())).unwrap()
    };
    for at in (0..valid.len()).step_by(7).chain([valid.len() - 1]) {
        let mut flipped = valid.clone();
        flipped[at] ^= 1 << (at % 8);
        for corrupted in [&flipped[..], &valid[..at]] {
            let folder = tempfile::tempdir().unwrap();
            stopped(folder.path(), &manifest);
            put(&checkpoint(folder.path()), corrupted);
            let health = verify(folder.path()).unwrap();
            let is_reported = |file: &stochc_results::integrity::FileIntegrity| {
                file.name.ends_with(".state") && file.health.is_corrupted()
            };
            assert!(health.iter().any(is_reported), "{at}");
            let notes = resumed(folder.path(), &manifest);
            let [note] = &notes[..] else {
                panic!("{at}: {notes:?}");
            };
            assert!(
                note.contains("of run 2 of `right` is damaged; it is now"),
                "{note}"
            );
            assert!(note.ends_with("and the run restarts"), "{note}");
            assert!(bytes(folder.path()) == tables, "{at}");
            assert!(folder.path().join("damaged/1-2.state").exists());
        }
    }
}

#[test]
fn repair_moves_a_corrupted_checkpoint_aside() {
    let (folder, manifest) = (tempfile::tempdir().unwrap(), manifest(4));
    stopped(folder.path(), &manifest);
    put(&checkpoint(folder.path()), "nothing of the kind");
    repair(folder.path(), |_, _| Ok(Vec::new())).unwrap();
    assert!(!checkpoint(folder.path()).exists());
    assert!(folder.path().join("damaged/1-2.state").exists());
}

/// Checks a state with valid checksums that is not a state of the run. It must not affect results.
#[test]
fn an_invalid_state_loses_no_run() {
    let manifest = manifest(4);
    let mut too_late = Vec::new();
    StateWriter::new(&mut too_late).put(&u64::MAX).unwrap();
    let endless = [0xff; 9];
    for state in [&too_late[..], b"", &endless] {
        let folder = tempfile::tempdir().unwrap();
        stopped(folder.path(), &manifest);
        forge(&checkpoint(folder.path()), str::to_owned, state);
        let notes = resumed(folder.path(), &manifest);
        assert_eq!(notes.len(), 2, "{notes:?}");
        assert!(
            notes[1].contains("does not fit its present recording; it is now"),
            "{notes:?}"
        );
        assert!(bytes(folder.path()) == undisturbed(&manifest));
    }
}

/// Checks that `rapier` writes no checkpoints, because its engine would restore them without
/// validation.
#[test]
fn runs_of_rapier_have_no_checkpoints() {
    let (folder, mut manifest) = (tempfile::tempdir().unwrap(), manifest(4));
    let state = {
        let other = tempfile::tempdir().unwrap();
        stopped(other.path(), &manifest);
        fs::read(checkpoint(other.path())).unwrap()
    };
    manifest.settings = Settings::new(Model::Rapier, 1);
    let tables = undisturbed(&manifest);
    let opened = Folder::open(folder.path(), &manifest, false).unwrap();
    let opened = opened.with_checkpoints(EVERY).unwrap();
    let stop = AtomicBool::new(false);
    let simulate = |program, run, mut watch: &RunWatch| {
        if (program, run) == LAST {
            stop.store(true, Ordering::Relaxed);
            let flow = watch.tick(1000, stochc_ir::table::PhaseId(0));
            assert!(flow.is_break() && !watch.wants_state());
            return Err(RunCancelled);
        }
        self::simulate(program, run, watch)
    };
    run_on(1, Destination::Folder(opened), &stop, simulate).unwrap();
    // A checkpoint of another model is ignored.
    fs::create_dir_all(folder.path().join(CHECKPOINTS)).unwrap();
    put(&checkpoint(folder.path()), state);
    assert_eq!(resumed(folder.path(), &manifest), [""; 0]);
    assert!(bytes(folder.path()) == tables);
    assert!(!folder.path().join(CHECKPOINTS).exists());
}

/// Changes the first line and the state of a checkpoint. The checksums stay valid.
fn forge(file: &Path, header: impl Fn(&str) -> String, state: &[u8]) {
    let bytes = fs::read(file).unwrap();
    let end = bytes.iter().position(|&byte| byte == b'\n').unwrap();
    let line = std::str::from_utf8(&bytes[..end]).unwrap();
    let open = line.split(",\"crc\"").next().unwrap().to_owned() + "}";
    let mut forged = stochc_files::checksum::sealed(header(&open)).into_bytes();
    forged.push(b'\n');
    forged.extend_from_slice(state);
    let sum = stochc_files::checksum::crc32(&forged);
    forged.extend(sum.to_le_bytes());
    put(file, forged);
}

#[test]
fn a_foreign_checkpoint_is_not_used() {
    let manifest = manifest(4);
    for (what, from, to) in [
        (
            "of another build of `stochc`",
            "\"build\":\"",
            "\"build\":\"f",
        ),
        ("of another ensemble", "\"ensemble\":\"", "\"ensemble\":\"0"),
        ("of another run", "\"run\":2", "\"run\":1"),
        ("in another format", "\"checkpoint\":1", "\"checkpoint\":9"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        stopped(folder.path(), &manifest);
        let state = 70u64.to_le_bytes();
        forge(
            &checkpoint(folder.path()),
            |line| line.replacen(from, to, 1),
            &state,
        );
        let notes = resumed(folder.path(), &manifest);
        let expected = format!(
            "the checkpoint of run 2 of `right` is not used because it is {what}; the run restarts"
        );
        assert_eq!(notes, [expected]);
        assert!(bytes(folder.path()) == undisturbed(&manifest));
    }
}

#[test]
fn a_shard_resumes_from_the_checkpoint_of_another_process() {
    let manifest = manifest(4);
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    prepare(root, &manifest, 2).unwrap();
    let stop = AtomicBool::new(false);
    let open = |number| {
        let shard = Shard::open(root, number).unwrap();
        shard.with_checkpoints(EVERY).unwrap()
    };
    let make = |shard: &Shard,
                simulate: &(
                     dyn Fn(usize, u64, &RunWatch) -> Result<RunRecord, RunCancelled> + Sync
                 )| {
        let progress: Progress = shard.progress(std::num::NonZeroUsize::MIN);
        shard.make(&progress, &stop, simulate).unwrap()
    };
    let run_one = |program, run, watch: &RunWatch| {
        if (program, run) == LAST {
            stop.store(true, Ordering::Relaxed);
            return stopped_run(watch);
        }
        simulate(program, run, watch)
    };
    assert!(make(&open(0), &simulate));
    assert!(!make(&open(1), &run_one));
    stop.store(false, Ordering::Relaxed);
    // Opening other shards does not report the checkpoint.
    assert_eq!(open(0).checkpoints().unwrap().notes(), [""; 0]);
    let shard = open(1);
    let notes = shard.checkpoints().unwrap().notes();
    assert_eq!(
        notes,
        ["run 2 of `right` resumes from its checkpoint at tick 70"]
    );
    assert!(make(&shard, &simulate));
    // Another process was killed while it ran the shard.
    fs::create_dir_all(root.join(CHECKPOINTS)).unwrap();
    for name in ["1-2.state", "1-2.draft-x7"] {
        put(&root.join(CHECKPOINTS).join(name), "half of it");
    }
    merge(root, |_, _| Ok(Vec::new())).unwrap();
    assert!(bytes(root) == undisturbed(&manifest));
    assert!(!root.join(CHECKPOINTS).exists());
}

#[test]
fn the_interval_is_a_time_or_a_number_of_ticks() {
    let parsed = |text: &str| text.parse::<Interval>();
    assert_eq!(parsed("5m"), Ok(Interval::DEFAULT));
    assert_eq!(parsed("2000ticks"), Ok(Interval::Ticks(2000)));
    assert_eq!(parsed("never"), Ok(Interval::Never));
    for wrong in ["0ticks", "0s", "5", "", "-3m", "ticks", "1e99h"] {
        assert!(parsed(wrong).is_err(), "{wrong}");
    }
    for text in ["5m", "90s", "7ticks", "never"] {
        let message = parsed(text).unwrap().to_string();
        assert_eq!(message, text);
    }
}
