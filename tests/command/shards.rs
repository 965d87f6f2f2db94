//! Tests a sharded ensemble on the command line: `shard new`, `shard run`, `shard status`, `shard
//! merge`.
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::json;

use crate::stochc::{path, shard_new, stochc_with};

const TOWER: &str = "simulate --model shuffle tests/fixtures/tower.sa --runs 10 --seed 3";
const SWEEP: &str = "sweep --model shuffle examples/line.sa examples/five_tower.sa --runs 4 --vary free=50,60 --max-ticks 12";

/// Returns the content of every file below a folder, except the lock.
fn files(folder: &str) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if entry.path().is_dir() {
            let below = files(entry.path().to_str().unwrap()).into_iter();
            found.extend(below.map(|(file, content)| (format!("{name}/{file}"), content)));
        } else if name != ".lock" {
            found.insert(name, fs::read(entry.path()).unwrap());
        }
    }
    found
}

#[test]
fn merged_shards_equal_the_folder_of_one_machine() {
    let folder = tempfile::tempdir().unwrap();
    for (number, command) in [TOWER, SWEEP].into_iter().enumerate() {
        let [plain, shards] =
            ["plain", "shards"].map(|it| path(folder.path(), &format!("{it}{number}")));
        stochc_with(command, &["--quiet", "--threads", "1", "--out", &plain]);
        // The machines that run shards do not have the source of the program.
        let outcome = stochc_with(&shard_new(command), &["--shards", "3", "--out", &shards]);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        assert!(
            outcome.out.contains("is split into 3 shards, "),
            "{}",
            outcome.out
        );
        let again = stochc_with(&shard_new(command), &["--shards", "3", "--out", &shards]);
        assert_eq!(again.status, 0);
        assert!(again.out.contains("into 3 shards already"), "{}", again.out);
        for shard in ["2", "0", "0", "1"] {
            let outcome = stochc_with("shard run", &[&shards, shard]);
            assert_eq!(outcome.status, 0, "{}", outcome.err);
            assert!(
                outcome.out.starts_with(&format!("shard {shard} of")),
                "{}",
                outcome.out
            );
        }
        let outcome = stochc_with("shard merge", &[&shards]);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        assert!(files(&shards) == files(&plain), "{command}");
        for what in ["show", "fsck", "report --quiet"] {
            let [one, other] = [&plain, &shards].map(|it| stochc_with(what, &[it]));
            assert_eq!((one.status, &one.out), (other.status, &other.out), "{what}");
        }
        let outcome = stochc_with("resume", &[&shards]);
        assert!(
            outcome.err.contains("is finished already"),
            "{}",
            outcome.err
        );
    }
}

#[test]
fn a_shell_loop_runs_missing_shards() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    stochc_with(
        &shard_new(TOWER),
        &["--quiet", "--shards", "5", "--out", &out],
    );
    stochc_with("shard run --quiet", &[&out, "3"]);
    let outcome = stochc_with("shard status --missing", &[&out]);
    assert_eq!((outcome.status, outcome.out.as_str()), (0, "0\n1\n2\n4\n"));
    let outcome = stochc_with("shard status", &[&out]);
    assert!(
        outcome
            .out
            .starts_with("1 of 5 shards are complete; 10 runs in all\nmissing: 0-2, 4\n"),
        "{}",
        outcome.out
    );
    let outcome = stochc_with("shard status --json", &[&out]);
    let status = outcome.json();
    assert_eq!(status["missing"], json!([0, 1, 2, 4]));
    assert_eq!(status["states"][3], json!({ "state": "whole" }));
    let outcome = stochc_with("shard status --missing --json", &[&out]);
    assert_eq!(outcome.json()["missing"], json!([0, 1, 2, 4]));
    for shard in ["0", "1", "2", "4"] {
        assert_eq!(stochc_with("shard run --quiet", &[&out, shard]).status, 0);
    }
    let outcome = stochc_with("shard status --missing", &[&out]);
    assert_eq!((outcome.status, outcome.out.as_str()), (0, ""));
    assert_eq!(stochc_with("shard merge --quiet", &[&out]).out, "");
}

/// Checks that each rejection has a reason, advice and an exit status, and changes no file.
#[test]
fn impossible_shards_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let refused = |line: &str, more: &[&str], status, reason: &str| {
        let before = Path::new(&out).exists().then(|| files(&out));
        let outcome = stochc_with(line, more);
        assert_eq!(outcome.status, status, "{line}: {}", outcome.err);
        assert!(outcome.err.contains(reason), "{line}: {}", outcome.err);
        let after = Path::new(&out).exists().then(|| files(&out));
        assert!(before == after, "{line}");
    };
    for shards in ["0", "11", "1000000000"] {
        refused(
            &shard_new(TOWER),
            &["--shards", shards, "--out", &out],
            2,
            "cannot split 10 runs into",
        );
    }
    refused(&shard_new(TOWER), &["--shards", "2"], 2, "--out");
    refused("shard run", &[&out, "0"], 2, "contains no results");
    stochc_with(
        &shard_new(TOWER),
        &["--quiet", "--shards", "4", "--out", &out],
    );
    refused(
        &shard_new(TOWER),
        &["--shards", "5", "--out", &out],
        2,
        "is split into 4 shards of 10 runs",
    );
    refused(
        &shard_new(TOWER),
        &["--seed", "4", "--shards", "4", "--out", &out],
        2,
        "cannot be used multiple times",
    );
    refused(TOWER, &["--out", &out], 2, "stochc shard merge");
    refused("resume", &[&out], 2, "stochc shard merge");
    for line in ["show", "report", "replay --run 0"] {
        refused(line, &[&out], 2, "stochc shard status");
    }
    refused(
        "shard run",
        &[&out, "4"],
        2,
        "there is no shard 4; shards are 0 to 3",
    );
    refused("shard run", &[&out, "-1"], 2, "-1");
    stochc_with("shard run --quiet", &[&out, "1"]);
    refused(
        "shard merge",
        &[&out],
        3,
        "3 of 4 shards are missing or corrupted (0, 2 and 3)",
    );
    for shard in ["0", "2", "3"] {
        stochc_with("shard run --quiet", &[&out, shard]);
    }
    stochc_with("shard merge --quiet", &[&out]);
    for line in ["shard merge", "shard status"] {
        refused(line, &[&out], 2, "has no shards: it holds 10 of 10 runs");
    }
    refused(
        "shard run",
        &[&out, "0"],
        2,
        "has no shards: it holds 10 of 10 runs",
    );
    refused(
        &shard_new(TOWER),
        &["--shards", "4", "--out", &out],
        2,
        "holds 10 runs of this ensemble already",
    );
}

/// Changes a digit after the first line of a shard's file.
fn damage(out: &str, shard: &str) {
    let file = format!("{out}/shards/{shard}.jsonl");
    let text = fs::read_to_string(&file).unwrap();
    let (first, rest) = text.split_once('\n').unwrap();
    let at = rest.find("\"ticks\":").unwrap() + "\"ticks\":".len();
    let digit = if rest[at..].starts_with('1') {
        "2"
    } else {
        "1"
    };
    let rest = format!("{}{digit}{}", &rest[..at], &rest[at + 1..]);
    fs::write(&file, format!("{first}\n{rest}")).unwrap();
}

/// Checks a shard whose first line is still valid, so that `status` does not detect the corruption.
#[test]
fn corrupted_shards_are_rerun_by_the_proposed_command() {
    let folder = tempfile::tempdir().unwrap();
    let [plain, out] = ["plain", "out"].map(|name| path(folder.path(), name));
    stochc_with(TOWER, &["--quiet", "--threads", "1", "--out", &plain]);
    stochc_with(
        &shard_new(TOWER),
        &["--quiet", "--shards", "4", "--out", &out],
    );
    for shard in ["0", "1", "2", "3"] {
        stochc_with("shard run --quiet", &[&out, shard]);
    }
    for shard in ["1", "3"] {
        damage(&out, shard);
    }
    let outcome = stochc_with("shard merge", &[&out]);
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    assert!(
        outcome.err.contains("for i in 1 3; do stochc shard run "),
        "{}",
        outcome.err
    );
    for shard in ["1", "3"] {
        stochc_with("shard run --quiet", &[&out, shard]);
        damage(&out, shard);
    }
    let outcome = stochc_with("fsck --repair", &[&out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(
        outcome.out.contains("repaired: `stochc shard status "),
        "{}",
        outcome.out
    );
    assert_eq!(stochc_with("shard status --missing", &[&out]).out, "1\n3\n");
    for shard in ["1", "3"] {
        stochc_with("shard run --quiet", &[&out, shard]);
    }
    assert_eq!(stochc_with("shard merge --quiet", &[&out]).status, 0);
    let mut merged = files(&out);
    merged.retain(|name, _| !name.starts_with("damaged/"));
    assert!(merged == files(&plain));
}

#[test]
fn shards_without_their_split_are_not_removed() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    stochc_with(
        &shard_new(TOWER),
        &["--quiet", "--shards", "4", "--out", &out],
    );
    for shard in ["0", "1", "2", "3"] {
        stochc_with("shard run --quiet", &[&out, shard]);
    }
    let cut = format!("{out}/shards.json");
    let text = fs::read_to_string(&cut).unwrap();
    fs::write(&cut, &text[..text.len() - 5]).unwrap();
    let before = files(&out);
    let outcome = stochc_with("fsck --repair", &[&out]);
    assert_eq!(outcome.status, 2, "{}", outcome.out);
    assert!(outcome.err.contains("move it away"), "{}", outcome.err);
    assert!(files(&out) == before);
    fs::remove_file(&cut).unwrap();
    let outcome = stochc_with("shard status", &[&out]);
    assert_eq!(outcome.status, 2, "{}", outcome.out);
    assert!(
        outcome.err.contains("writes it again and keeps the shards"),
        "{}",
        outcome.err
    );
    let outcome = stochc_with(
        &shard_new(TOWER),
        &["--quiet", "--shards", "4", "--out", &out],
    );
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert_eq!(stochc_with("shard status --missing", &[&out]).out, "");
    assert_eq!(stochc_with("shard merge --quiet", &[&out]).status, 0);
}
