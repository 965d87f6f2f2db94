//! Tests that interruptions do not change the tables, byte for byte.
use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use stochc_ir::record::Outcome;
use stochc_results::{Destination, Folder, FolderState};

use crate::world::{bytes, complete, manifest, put, run_on, simulate};

#[test]
fn threads_change_nothing() {
    let [one, four] = [1, 4].map(|threads| {
        let folder = tempfile::tempdir().unwrap();
        let results = complete(folder.path(), &manifest(12), threads);
        assert!(results.complete);
        (bytes(folder.path()), results.finished.to_vec().unwrap())
    });
    assert!(one == four);
}

#[test]
fn uncountable_runs_start_with_the_first() {
    let stop = AtomicBool::new(false);
    let manifest = manifest(u64::MAX);
    let root = Destination::Memory(&manifest);
    let results = run_on(1, root, &stop, |program, number, watch| {
        stop.fetch_or(number == 3, Ordering::Relaxed);
        simulate(program, number, watch)
    });
    let results = results.unwrap();
    assert!(!results.complete);
    let runs = results.finished.keys().map(|(_, run)| run);
    assert_eq!(runs.max(), Some(2));
}

#[test]
fn a_truncated_last_line_loses_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("journal.jsonl");
    complete(folder.path(), &manifest(4), 1);
    let (whole, tables) = (fs::read(&journal).unwrap(), bytes(folder.path()));
    let last = whole[..whole.len() - 1]
        .iter()
        .rposition(|&b| b == b'\n')
        .unwrap()
        + 1;
    for end in last..whole.len() {
        put(&journal, &whole[..end]);
        fs::remove_file(folder.path().join("runs.parquet")).unwrap();
        let stored = Folder::read(folder.path()).unwrap().finished;
        assert_eq!(stored.len(), 7);
        assert!(complete(folder.path(), &manifest(4), 2).complete);
        assert!(bytes(folder.path()) == tables, "cut at byte {end}");
        assert_eq!(fs::read(&journal).unwrap(), whole, "cut at byte {end}");
    }
}

#[test]
fn a_corrupted_journal_loses_only_its_corrupted_lines() {
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("journal.jsonl");
    complete(folder.path(), &manifest(4), 1);
    let (whole, tables) = (fs::read(&journal).unwrap(), bytes(folder.path()));
    let header = whole.iter().position(|&b| b == b'\n').unwrap() + 1;
    // The journal is missing, or ends within its first line or directly after it.
    for end in [0, 1, header - 1, header] {
        put(&journal, &whole[..end]);
        complete(folder.path(), &manifest(4), 1);
        assert!(bytes(folder.path()) == tables);
    }
    fs::remove_file(&journal).unwrap();
    complete(folder.path(), &manifest(4), 1);
    assert!(bytes(folder.path()) == tables);
    // A loss of power can leave zeros in the middle and at the end of a file.
    let mut corrupted = whole.clone();
    corrupted[header + 20..header + 40].fill(0);
    corrupted.extend([0; 512]);
    put(&journal, &corrupted);
    assert_eq!(Folder::read(folder.path()).unwrap().finished.len(), 7);
    complete(folder.path(), &manifest(4), 1);
    assert!(bytes(folder.path()) == tables);
}

#[test]
fn stopping_saves_finished_runs() {
    let [folder, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    complete(other.path(), &manifest(12), 1);
    let (stop, begun) = (AtomicBool::new(false), AtomicU64::new(0));
    let opened = Folder::open(folder.path(), &manifest(12), false).unwrap();
    assert_eq!(opened.state(), FolderState::New);
    let results = run_on(
        2,
        Destination::Folder(opened),
        &stop,
        |program, run, watch| {
            if begun.fetch_add(1, Ordering::Relaxed) == 10 {
                stop.store(true, Ordering::Relaxed);
            }
            simulate(program, run, watch)
        },
    )
    .unwrap();
    assert!(!results.complete && results.finished.len() < 24);
    // The folder contains the finished runs.
    let stored = Folder::read(folder.path()).unwrap().finished;
    assert_eq!(stored.to_vec().unwrap(), results.finished.to_vec().unwrap());
    assert!(folder.path().join("runs.parquet").exists());

    let results = complete(folder.path(), &manifest(12), 2);
    assert!(results.complete);
    assert!(bytes(folder.path()) == bytes(other.path()));
}

#[test]
fn a_panic_fails_one_run_only() {
    let folder = tempfile::tempdir().unwrap();
    let results = complete(folder.path(), &manifest(4), 2);
    assert!(results.complete);
    let finished = results.finished.to_vec().unwrap();
    let Outcome::Failed { reason, .. } = &finished[3].record.outcome else {
        panic!("run 3 panics")
    };
    assert_eq!(reason, "panicked: run 3 goes wrong");
    let failed = |outcome: &Outcome| matches!(outcome, Outcome::Failed { .. });
    assert_eq!(
        finished
            .iter()
            .filter(|done| failed(&done.record.outcome))
            .count(),
        2
    );
}

#[test]
fn more_runs_extend_an_ensemble() {
    let [folder, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    complete(folder.path(), &manifest(5), 2);
    let opened = Folder::open(folder.path(), &manifest(5), false).unwrap();
    assert_eq!(opened.state(), FolderState::Finished);
    drop(opened);
    complete(folder.path(), &manifest(9), 2);
    complete(other.path(), &manifest(9), 1);
    assert!(bytes(folder.path()) == bytes(other.path()));
    assert_eq!(Folder::read(folder.path()).unwrap().manifest, manifest(9));
}

/// Environment variable with the results folder of a process that is killed.
const VICTIM: &str = "STOCHC_TEST_VICTIM";

/// Environment variable with the number of threads of a process that is killed.
const THREADS: &str = "STOCHC_TEST_THREADS";

/// Starts a process that makes runs in a folder until one of them blocks.
fn stuck(folder: &Path, threads: &str) -> std::process::Child {
    let mut victim = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "interrupted::victim", "--ignored", "--nocapture"])
        .env(VICTIM, folder)
        .env(THREADS, threads)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let output = BufReader::new(victim.stdout.take().unwrap());
    let stuck = output.lines().any(|line| line.unwrap().contains("stuck"));
    assert!(stuck, "the victim reaches its last run");
    victim
}

#[test]
fn a_kill_loses_no_finished_run() {
    for _ in 0..10 {
        let folder = tempfile::tempdir().unwrap();
        let mut victim = stuck(folder.path(), "1");
        victim.kill().unwrap();
        victim.wait().unwrap();
        // Six runs of each program are finished. The seventh run of the first program has blocked.
        let contents = Folder::read(folder.path()).unwrap();
        assert_eq!((contents.finished.len(), contents.damage.len()), (12, 0));
    }
}

#[test]
fn a_killed_process_leaves_a_folder_that_resumes() {
    let [folder, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let mut victim = stuck(folder.path(), "2");
    let locked = Folder::open(folder.path(), &manifest(8), true).unwrap_err();
    assert!(
        locked.to_string().starts_with("another process"),
        "{locked}"
    );
    victim.kill().unwrap();
    victim.wait().unwrap();

    let results = complete(folder.path(), &manifest(8), 2);
    assert!(results.complete);
    complete(other.path(), &manifest(8), 2);
    assert!(bytes(folder.path()) == bytes(other.path()));
}

#[test]
#[ignore = "the process that `a_killed_process_leaves_a_folder_that_resumes` kills"]
fn victim() {
    let Some(path) = std::env::var_os(VICTIM) else {
        return;
    };
    let folder = Folder::open(Path::new(&path), &manifest(8), false).unwrap();
    let never = AtomicBool::new(false);
    let threads = std::env::var(THREADS).unwrap().parse().unwrap();
    run_on(
        threads,
        Destination::Folder(folder),
        &never,
        |program, run, watch| {
            if run == 6 {
                // If two threads block, the output of the second may fail, because its reader has
                // ended.
                let _ = writeln!(std::io::stdout(), "stuck");
                loop {
                    std::thread::park();
                }
            }
            simulate(program, run, watch)
        },
    )
    .unwrap();
}
