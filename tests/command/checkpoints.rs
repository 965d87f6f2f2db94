//! Tests `kill -9` in the middle of a run, and resuming after it.
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::stochc::{path, run_command, stochc_with, tables};

const TOWER: &str = "examples/five_tower.sa";

/// Number of times that a process is killed.
const KILLS: usize = 3;

/// Returns the name and content of each file in a folder.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let entries = entries.map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, fs::read(&path).unwrap_or_default())
        })
        .collect();
    files.sort();
    files
}

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stochc"));
    command.args(arguments).stdin(Stdio::null());
    command
}

/// Kills a process as soon as the checkpoints differ from `before`. Returns whether the process
/// ended first.
fn kill(mut child: Child, folder: &Path, before: &[(String, Vec<u8>)]) -> bool {
    loop {
        if child.try_wait().unwrap().is_some() {
            return true;
        }
        let now = files(folder);
        // A file with its final name is complete.
        let is_whole = |(name, _): &&(String, Vec<u8>)| name.ends_with(".state");
        if now
            .iter()
            .any(|file| is_whole(&file) && !before.contains(file))
        {
            child.kill().unwrap();
            child.wait().unwrap();
            return false;
        }
        std::thread::sleep(Duration::from_millis(3));
    }
}

/// Kills a command several times during its runs, and then runs the command `later` to the end.
fn killed_and_resumed(arguments: &[&str], later: &[&str], out: &str) {
    let folder = Path::new(out).join("checkpoints");
    let mut arguments_now = arguments.to_vec();
    let mut resumed = 0;
    for _ in 0..KILLS {
        let before = files(&folder);
        let mut child = command(&arguments_now);
        let child = child.stdout(Stdio::null()).stderr(Stdio::null());
        if kill(child.spawn().unwrap(), &folder, &before) {
            break;
        }
        resumed += 1;
        arguments_now = later.to_vec();
    }
    assert!(resumed > 0, "the command was never killed during a run");
    let last = run_command(&mut command(&arguments_now));
    assert!([0, 3].contains(&last.status), "{}", last.err);
    assert!(
        last.err.contains("resumes from its checkpoint at tick"),
        "{}",
        last.err
    );
    // For shards, the folder and a draft of a killed process remain until the merge. Another
    // process may still be writing a checkpoint.
    let left: Vec<String> = files(&folder).into_iter().map(|(name, _)| name).collect();
    let may_stay = |name: &String| arguments[0] == "shard" && name.contains(".draft-");
    assert!(left.iter().all(may_stay), "{left:?}");
}

/// Returns a command whose runs have some thousand ticks, with a checkpoint every hundred ticks.
fn simulate<'a>(file: &'a str, more: &'a str, out: &'a str) -> Vec<&'a str> {
    let all = "--runs 2 --threads 1 --checkpoints 100ticks";
    let command = if more.contains("--vary") {
        "sweep"
    } else {
        "simulate"
    };
    let more = more.split_whitespace();
    let file = [command, file].into_iter();
    file.chain(all.split(' '))
        .chain(more)
        .chain(["--out", out])
        .collect()
}

/// Returns the command that resumes such runs.
fn resume<'a>(more: &'a str, out: &'a str) -> Vec<&'a str> {
    let line = "resume --threads 1 --checkpoints 100ticks";
    let words = line.split(' ').chain(more.split_whitespace());
    words.chain([out]).collect()
}

#[test]
fn recorded_runs_of_a_sweep_resume() {
    let place = tempfile::tempdir().unwrap();
    let [out, straight] = ["out", "straight"].map(|name| path(place.path(), name));
    let of = |out| {
        simulate(
            TOWER,
            "--max-ticks 3000 --vary free=100,300 --record all",
            out,
        )
    };
    killed_and_resumed(&of(&out), &resume("--record all", &out), &out);
    let outcome = run_command(&mut command(&of(&straight)));
    assert!([0, 3].contains(&outcome.status), "{}", outcome.err);
    assert!(tables(&out) == tables(&straight));
    for folder in ["recordings", "damaged"] {
        let [one, other] = [&out, &straight].map(|out| files(&Path::new(out).join(folder)));
        assert!(one == other, "{folder}");
    }
    for name in ["sweep.csv", "sweep.json"] {
        let [one, other] =
            [&out, &straight].map(|out| fs::read(Path::new(out).join(name)).unwrap());
        assert!(one == other, "{name}");
    }
}

#[test]
fn runs_in_double_precision_and_without_rotation_resume() {
    for more in [
        "--max-ticks 3000 --precision double",
        "--max-ticks 3000 --without rotation",
    ] {
        let place = tempfile::tempdir().unwrap();
        let [out, straight] = ["out", "straight"].map(|name| path(place.path(), name));
        let of = |out| simulate(TOWER, more, out);
        killed_and_resumed(&of(&out), &resume("", &out), &out);
        run_command(&mut command(&of(&straight)));
        assert!(tables(&out) == tables(&straight), "{more}");
    }
}

#[test]
fn shards_resume() {
    let place = tempfile::tempdir().unwrap();
    let [out, straight] = ["out", "straight"].map(|name| path(place.path(), name));
    let of = |out| simulate(TOWER, "--max-ticks 3000", out);
    let mut cut = of(&out);
    // Each shard has its own interval between checkpoints.
    let checkpoints = cut.iter().position(|word| *word == "--checkpoints");
    let checkpoints = checkpoints.expect("unfinished runs have waits");
    cut.drain(checkpoints..checkpoints + 2);
    cut.splice(0..1, ["shard", "new", "--shards", "2"]);
    let outcome = run_command(&mut command(&cut));
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    for shard in ["0", "1"] {
        let shard = [
            "shard",
            "run",
            &out,
            shard,
            "--threads",
            "1",
            "--checkpoints",
            "100ticks",
        ];
        killed_and_resumed(&shard, &shard, &out);
    }
    assert_eq!(stochc_with("shard merge", &[&out]).status, 0);
    assert!(files(&Path::new(&out).join("checkpoints")).is_empty());
    run_command(&mut command(&of(&straight)));
    assert!(tables(&out) == tables(&straight));
}
