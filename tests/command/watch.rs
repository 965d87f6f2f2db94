//! Tests `simulate --watch`, which rewrites the report during the runs.
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::stochc::{command, path, stochc, stochc_with};

/// Time limit that exceeds any step on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// HTML element that makes a browser reload the page.
const RELOADS: &str = "<meta http-equiv=\"refresh\" content=\"5\"/>";

#[test]
#[cfg(unix)]
fn the_report_is_rewritten_until_the_command_ends() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let line = "simulate tests/fixtures/still.sa --runs 1000 --max-ticks 100000000 --watch";
    let mut command = command(line.split_whitespace().chain(["--out", &out]));
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let mut errors = BufReader::new(child.stderr.take().unwrap());
    let page = Path::new(&out).join("report.html");
    let expected = format!("report of the runs so far: {}\n", page.display());
    let mut message = String::new();
    while message != expected {
        message.clear();
        assert!(errors.read_line(&mut message).unwrap() > 0, "no message");
    }
    let text = fs::read_to_string(&page).unwrap();
    assert!(text.contains(RELOADS), "{text}");
    assert!(text.contains("0 of 1000 runs are finished"), "{text}");
    let old = "<!DOCTYPE html><!-- stochc report -->";
    fs::write(&page, old).unwrap();
    let start = Instant::now();
    while fs::read_to_string(&page).unwrap() == old && start.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(100));
    }
    let rewritten = fs::read_to_string(&page).unwrap();
    let id = child.id().to_string();
    let mut kill = std::process::Command::new("kill");
    assert!(kill.args(["-TERM", &id]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(rewritten.contains(RELOADS), "{rewritten}");
    let text = fs::read_to_string(&page).unwrap();
    assert!(!text.contains("http-equiv=\"refresh\""), "{text}");
    assert!(text.contains("0 of 1000 runs are finished"), "{text}");
}

#[test]
fn watching_changes_no_results() {
    let folder = tempfile::tempdir().unwrap();
    let [alone, watched] = ["alone", "watched"].map(|name| path(folder.path(), name));
    let line = "simulate tests/fixtures/tower.sa --runs 6 --threads 1 --record 0..1 --quiet --out";
    let plain = stochc_with(line, &[&alone]);
    assert_eq!(plain.status, 0, "{}", plain.err);
    let outcome = stochc_with(line, &[&watched, "--watch"]);
    assert_eq!(
        (outcome.status, &outcome.out),
        (0, &plain.out),
        "{}",
        outcome.err
    );
    for name in [
        "journal.jsonl",
        "runs.parquet",
        "recordings/0-0.rec",
        "recordings/0-1.rec",
    ] {
        let [one, other] = [&alone, &watched].map(|it| fs::read(Path::new(it).join(name)).unwrap());
        assert!(one == other, "{name}");
    }
    let page = Path::new(&watched).join("report.html");
    let last = fs::read_to_string(&page).unwrap();
    fs::remove_file(&page).unwrap();
    fs::remove_dir_all(Path::new(&watched).join("report-figures")).unwrap();
    assert_eq!(stochc_with("report --quiet", &[&watched]).status, 0);
    assert!(fs::read_to_string(&page).unwrap() == last);
}

#[test]
fn watching_needs_a_folder() {
    for (more, expected) in [
        ("--watch", "--out <DIR>"),
        ("--watch --until 3% --out nowhere", "cannot be used with"),
    ] {
        let outcome = stochc(&format!("simulate tests/fixtures/tower.sa {more}"));
        assert_eq!(outcome.status, 2, "{more}");
        assert!(outcome.err.contains(expected), "{}", outcome.err);
    }
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let line = "simulate tests/fixtures/tower.sa --model shuffle --runs 3 --quiet --out";
    assert_eq!(stochc_with(line, &[&out]).status, 0);
    let page = Path::new(&out).join("report.html");
    fs::write(&page, "<p>mine</p>").unwrap();
    let outcome = stochc_with("resume --watch --runs 5", &[&out]);
    assert_eq!(outcome.status, 2, "{}", outcome.err);
    assert!(
        outcome.err.contains("is not a report of stochc"),
        "{}",
        outcome.err
    );
    assert_eq!(fs::read_to_string(&page).unwrap(), "<p>mine</p>");
}
