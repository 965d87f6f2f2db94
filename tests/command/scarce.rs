//! Tests commands with little memory and few threads. Each must end with a documented status and a
//! reason.
use std::fs;
use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _};
use std::process::{Command, Stdio};

use crate::skipped::skipped;
use crate::stochc::{Outcome, path, run_command, stochc_with};

/// Source of a program with a hundred thousand captures: towers of ten on a square plate.
const LARGE: &str = "scene vast from hemisphere {
    free 100000 uniform
    enclosure hemisphere { radius 120m  wall 25 N/m }
}
pattern tower(base) { base.up ->> T[1..10] }
assembly towers in vast {
    seed plate 100 x 100 { for y in 0..99 { for x in 0..99 { S[x, y] at (x, y) } } }
    phase build { for y in 0..99 { for x in 0..99 { tower(S[x, y]) as t[x, y] } } }
}
";

/// Runs a command with this limit on its address space \[kB\].
fn with_memory(kilobytes: u32, arguments: &[&str]) -> Outcome {
    let program = format!("ulimit -v {kilobytes}; \"$@\"; exit $?");
    let mut command = Command::new("sh");
    command.args(["-c", &program, "sh", env!("CARGO_BIN_EXE_stochc")]);
    run_command(command.args(arguments).env_remove("RUST_BACKTRACE"))
}

/// Exit status that a shell reports for a process that ran out of memory (SIGABRT).
const ABORTED: i32 = 128 + 6;

#[track_caller]
fn ends_well(outcome: &Outcome, statuses: &[i32]) {
    assert!(
        statuses.contains(&outcome.status),
        "{}: {}",
        outcome.status,
        outcome.err
    );
    assert!(!outcome.err.contains("panicked"), "{}", outcome.err);
    let is_reported = ![2, ABORTED].contains(&outcome.status)
        || outcome.err.contains("error: ")
        || outcome.err.contains("memory allocation of ");
    assert!(is_reported, "{}", outcome.err);
}

#[test]
fn without_memory_a_command_fails_with_a_message() {
    let place = tempfile::tempdir().unwrap();
    let [large, out, cut] = ["large.sa", "out", "cut"].map(|name| path(place.path(), name));
    fs::write(&large, LARGE).unwrap();
    let line = "simulate examples/five_tower.sa --model shuffle --runs 300 --quiet --out";
    assert_eq!(stochc_with(line, &[&out]).status, 0);
    let line =
        "shard new examples/five_tower.sa --model shuffle --runs 20 --shards 2 --quiet --out";
    assert_eq!(stochc_with(line, &[&cut]).status, 0);
    for piece in ["0", "1"] {
        assert_eq!(stochc_with("shard run --quiet", &[&cut, piece]).status, 0);
    }
    let mut refused = 0;
    // The limits start slightly above the smallest memory that any command needs.
    let mut limits = (20_000..).step_by(5_000);
    let begins = |&kilobytes: &u32| with_memory(kilobytes, &["--version"]).status == 0;
    let own = 15_000 + limits.find(begins).unwrap();
    for kilobytes in [own, own + 10_000, own + 80_000, 1_000_000] {
        let new = path(place.path(), &kilobytes.to_string());
        for arguments in [
            &["check", &large][..],
            &[
                "simulate", &large, "--model", "shuffle", "--runs", "1", "--out", &new, "--quiet",
            ],
            &[
                "simulate",
                "examples/five_tower.sa",
                "--max-ticks",
                "50",
                "--runs",
                "2",
            ],
            &["show", &out],
            &["report", &out],
            &["plan", "examples/planned/chair.sa", "--tries", "3"],
            &["shard", "merge", &cut],
        ] {
            let outcome = with_memory(kilobytes, arguments);
            // For a folder that is already merged, `merge` reports this.
            ends_well(&outcome, &[0, 2, 3, ABORTED]);
            refused += usize::from(outcome.err.contains("memory allocation of "));
        }
    }
    assert!(refused > 2, "{refused}: nothing was short of memory");
    let results = stochc_with("show", &[&out]);
    assert_eq!(results.status, 0, "{}", results.err);
}

#[test]
fn without_memory_no_recording_is_called_corrupted() {
    let place = tempfile::tempdir().unwrap();
    let out = path(place.path(), "recorded");
    let line = "simulate examples/line.sa --runs 2 --record all --quiet --out";
    assert_eq!(stochc_with(line, &[&out]).status, 0);
    let mut short = 0;
    for kilobytes in (10_000..).step_by(500) {
        let outcome = with_memory(kilobytes, &["fsck", &out]);
        let all = [outcome.out.as_str(), &outcome.err].concat();
        assert!(!all.contains("damaged"), "{kilobytes}: {all}");
        short += usize::from(all.contains("out of memory"));
        if outcome.status == 0 {
            break;
        }
    }
    assert!(short > 0, "nothing was short of memory");
}

/// User id without other processes. The limit on threads counts all threads of a user, except root.
const NOBODY_UID: u32 = 61_234;

#[test]
fn without_threads_a_command_continues_or_fails() {
    let place = tempfile::tempdir().unwrap();
    let is_root = fs::metadata("/proc/self").unwrap().uid() == 0;
    let setpriv = Command::new("setpriv").arg("--version").output();
    if !is_root || setpriv.is_err() {
        return skipped("util-linux", "setpriv as root");
    }
    // The copy of `stochc` is in a folder that this user can access.
    let program = place.path().join("stochc");
    fs::copy(env!("CARGO_BIN_EXE_stochc"), &program).unwrap();
    let example = place.path().join("line.sa");
    fs::copy("examples/line.sa", &example).unwrap();
    fs::set_permissions(place.path(), fs::Permissions::from_mode(0o777)).unwrap();
    let example = example.to_str().unwrap();
    for threads in 1..=3 {
        let out = path(place.path(), &threads.to_string());
        let simulate = [
            "simulate",
            example,
            "--max-ticks",
            "50",
            "--runs",
            "3",
            "--threads",
            "3",
        ];
        for (arguments, statuses) in [
            (&["check", example][..], &[0][..]),
            (&simulate, &[2, 3]),
            (&[&simulate[..], &["--out", &out]].concat(), &[2, 3]),
            (&["lsp"], &[1, 2]),
        ] {
            let mut command = Command::new("prlimit");
            command.arg(format!("--nproc={threads}:{threads}"));
            let user = [
                format!("--reuid={NOBODY_UID}"),
                format!("--regid={NOBODY_UID}"),
            ];
            command.arg("setpriv").args(user).arg("--clear-groups");
            command.arg(&program).args(arguments).stdin(Stdio::null());
            ends_well(&run_command(&mut command), statuses);
        }
    }
}
