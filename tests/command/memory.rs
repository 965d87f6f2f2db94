//! `--memory`: nothing is lost at a limit, and a limit that suffices changes no byte.
use std::fs;
use std::path::Path;

use crate::stochc::{Said, command, path, said};

/// A program of ten thousand captures.
const LARGE: &str = "scene wide from hemisphere {
    free 12000 uniform
    enclosure hemisphere { radius 60m  wall 25 N/m }
}
pattern tower(base) { base.up ->> T[1..10] }
assembly towers in wide {
    seed plate 32 x 32 { for y in 0..31 { for x in 0..31 { S[x, y] at (x, y) } } }
    phase build { for y in 0..31 { for x in 0..31 { tower(S[x, y]) as t[x, y] } } }
}
";

/// Does the command with the words of `line`, and then `more`: with backtraces, for which there is no memory either.
fn stochc_with(line: &str, more: &[&str]) -> Said {
    let arguments = line.split_whitespace().chain(more.iter().copied());
    said(command(arguments).env("RUST_BACKTRACE", "1"))
}

/// All that the runs of a folder have come to.
fn tables(folder: &str) -> Vec<(String, Vec<u8>)> {
    let names = ["journal.jsonl", "runs.parquet", "bonds.parquet"];
    names
        .into_iter()
        .map(|name| {
            let content = fs::read(Path::new(folder).join(name)).unwrap();
            (name.to_string(), content)
        })
        .collect()
}

#[track_caller]
fn is_refused(said: &Said) {
    assert_eq!(said.status, 2, "{}", said.err);
    assert!(said.err.contains("is not enough: "), "{}", said.err);
}

/// Whether the process ended at the limit.
#[track_caller]
fn ended(said: &Said) -> bool {
    let ends = [
        "memory allocation of ",
        "error: there is no memory left",
        // A thread, or a file.
        "Resource temporarily unavailable",
        "Cannot allocate memory",
    ];
    let ended = ends.iter().any(|end| said.err.contains(end));
    assert_eq!(said.status, if ended { 2 } else { 0 }, "{}", said.err);
    assert!(!said.err.contains("panicked"), "{}", said.err);
    ended
}

#[test]
fn at_a_limit_nothing_is_lost() {
    let place = tempfile::tempdir().unwrap();
    let [large, whole, out] = ["large.sa", "whole", "out"].map(|name| path(place.path(), name));
    fs::write(&large, LARGE).unwrap();
    let line = "simulate --model shuffle --runs 4 --threads 1 --quiet";
    let whole_line = format!("{line} --out");
    assert_eq!(stochc_with(&whole_line, &[&whole, &large]).status, 0);
    let (mut refused, mut stopped, mut kept) = (0, 0, 0);
    for limit in (1..).map(|step| 4 * step) {
        let resumed = Path::new(&out).exists();
        let limited = format!(
            "{line} --memory {limit}MiB {} --out",
            ["", "--resume"][usize::from(resumed)]
        );
        let said = stochc_with(&limited, &[&out, &large]);
        if said.status == 2 && said.err.contains("is not enough: ") {
            refused += 1;
            assert!(!resumed || limit < 1000, "{limit}");
            continue;
        }
        if !ended(&said) {
            break;
        }
        stopped += 1;
        let journal = fs::read_to_string(Path::new(&out).join("journal.jsonl")).unwrap_or_default();
        let lines = journal.lines().count();
        assert!(lines >= kept, "{limit}: {lines} of {kept} are left");
        kept = lines;
        assert!(limit < 1000, "{limit}: {}", said.err);
    }
    assert!(refused + stopped > 2, "{refused}, {stopped}");
    assert!(tables(&out) == tables(&whole));
}

#[test]
fn what_cannot_fit_is_refused_before_it_begins() {
    let place = tempfile::tempdir().unwrap();
    let out = path(place.path(), "out");
    let line = "simulate examples/line.sa --model shuffle --runs 10000000 --memory 100MiB --quiet";
    let said = stochc_with(&format!("{line} --out"), &[&out]);
    is_refused(&said);
    assert!(said.err.contains("`--memory 100 MiB`"), "{}", said.err);
    assert!(
        said.err.contains("or make them in pieces, by `--shards`"),
        "{}",
        said.err
    );
    assert!(!Path::new(&out).exists());
}

#[test]
fn fewer_runs_are_made_at_a_time_where_that_suffices() {
    let place = tempfile::tempdir().unwrap();
    let [many, one] = ["many", "one"].map(|name| path(place.path(), name));
    let line = "simulate examples/five_tower.sa --model shuffle --runs 40 --quiet";
    let said = stochc_with(
        &format!("{line} --threads 1000 --memory 100MiB --out"),
        &[&many],
    );
    assert_eq!(said.status, 0, "{}", said.err);
    let told = "runs are made at the same time, not 1000, for `--memory 100 MiB`: ";
    assert!(said.err.contains(told), "{}", said.err);
    assert_eq!(stochc_with(&format!("{line} --out"), &[&one]).status, 0);
    // Lines of a journal are in the order in which runs end.
    let [many, one] = [many, one].map(|folder| tables(&folder).split_off(1));
    assert!(many == one);
}

#[test]
fn every_command_of_ensembles_has_a_limit() {
    let place = tempfile::tempdir().unwrap();
    let [whole, cut] = ["whole", "cut"].map(|name| path(place.path(), name));
    let line = "simulate examples/five_tower.sa --model shuffle --runs 30 --quiet";
    assert_eq!(stochc_with(&format!("{line} --out"), &[&whole]).status, 0);
    let limits = ["--memory", "1MiB"];
    let enough = ["--memory", "200MiB"];
    assert_eq!(
        stochc_with(&format!("{line} --shards 2 --out"), &[&cut]).status,
        0
    );
    let mut refused = 0;
    for arguments in [
        &["shard", &cut, "0", "--quiet"][..],
        &["shard", &cut, "1", "--quiet"],
        &["merge", &cut, "--quiet"],
        &["show", &cut],
        &["report", &cut, "--quiet"],
        &["verify", &cut],
    ] {
        let said = stochc_with("", &[arguments, &limits[..]].concat());
        // Little may suffice for little.
        let is_refused = said.status == 2 && said.err.contains("is not enough: ");
        refused += usize::from(is_refused || ended(&said));
        let said = stochc_with("", &[arguments, &enough[..]].concat());
        assert_eq!(said.status, 0, "{arguments:?}: {}", said.err);
    }
    assert!(refused > 1, "{refused}");
    let [whole, cut] = [whole, cut].map(|folder| tables(&folder).split_off(1));
    assert!(whole == cut);
    let said = stochc_with("show nowhere --memory 2", &[]);
    assert_eq!(said.status, 2);
    assert!(
        said.err
            .contains("give a number and its unit: 512MiB, 2GiB"),
        "{}",
        said.err
    );
}

#[test]
fn what_there_is_no_memory_to_look_at_is_not_called_damaged() {
    let place = tempfile::tempdir().unwrap();
    let out = path(place.path(), "recorded");
    let line = "simulate examples/line.sa --runs 2 --record all --quiet --out";
    assert_eq!(stochc_with(line, &[&out]).status, 0);
    let mut short = 0;
    for limit in ["1MiB", "2MiB", "3MiB", "4MiB", "6MiB", "8MiB"] {
        let said = stochc_with("verify", &[&out, "--memory", limit]);
        let all = [said.out.as_str(), &said.err].concat();
        assert!(!all.contains("damaged"), "{limit}: {all}");
        short += usize::from(said.status == 2);
    }
    assert!(short > 0, "nothing was short of memory");
    assert_eq!(stochc_with("verify", &[&out]).status, 0);
}
