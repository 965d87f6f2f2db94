//! Tests interruptions with Ctrl-C.
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::stochc::{Outcome, path, stochc_with};

/// Time limit that exceeds all waits on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// Waits until a condition holds while the process runs.
fn until(child: &mut Child, what: &str, so: impl Fn() -> bool) {
    let start = Instant::now();
    while !so() {
        assert_eq!(
            child.try_wait().unwrap(),
            None,
            "the process ended before {what}"
        );
        assert!(start.elapsed() < PATIENCE, "no {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Returns a command for another program, with default signal handling. Child processes would
/// inherit ignored signals from the tests.
fn with_signals(program: &str) -> Command {
    if !cfg!(target_os = "linux") {
        return Command::new(program);
    }
    let mut command = Command::new("env");
    command.args(["--default-signal=INT,TERM,HUP", program]);
    command
}

fn start(arguments: &[&str]) -> Child {
    let mut command = with_signals(env!("CARGO_BIN_EXE_stochc"));
    command.args(arguments).stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

/// Sends a signal to a process, and waits until it ends.
fn interrupt(child: Child, signal: &str) -> Outcome {
    let id = child.id().to_string();
    let sent = Command::new("kill").args([signal, &id]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    Outcome {
        status: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

#[test]
fn finished_runs_are_saved() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let journal = path(out.as_ref(), "journal.jsonl");
    // The first program completes at once, the second never completes.
    let simulate = [
        "simulate",
        "tests/fixtures/dense.sa",
        "tests/fixtures/still.sa",
        "--runs",
        "1",
        "--max-ticks",
        "1000000000000",
        "--threads",
        "2",
        "--out",
        &out,
    ];
    let lines = || fs::read_to_string(&journal).map_or(0, |text| text.matches('\n').count());
    let mut child = start(&simulate);
    until(&mut child, "first finished run", || lines() == 2);
    let outcome = interrupt(child, "-INT");
    assert_eq!(outcome.status, 130, "{}", outcome.err);
    assert!(outcome.err.contains("stochc resume "), "{}", outcome.err);
    assert!(!outcome.err.contains("panicked"), "{}", outcome.err);
    assert_eq!(
        outcome.row("Runs completed"),
        ["1", "of", "1", "0", "of", "1"]
    );
    assert_eq!(lines(), 2);

    let results = stochc_with("show", &[&out]);
    assert_eq!(results.status, 3);
    assert_eq!(results.err, "1 of 2 runs is still to do\n");
    assert_eq!(results.out, outcome.out);
    // The table contains the run that was finished.
    let tables = path(folder.path(), "tables");
    let written = stochc_with("show", &[&out, "--tables", &tables]);
    assert_eq!(written.status, 3, "{}", written.err);
    assert!(Path::new(&tables).join("runs.parquet").is_file());
    let refused = stochc_with("", &simulate);
    assert_eq!(refused.status, 2);
    assert!(refused.err.contains("1 of the 2 runs"), "{}", refused.err);

    // The ensemble is resumed and interrupted again, by SIGTERM.
    #[cfg(target_os = "linux")]
    {
        let mut child = start(&["resume", "--threads", "2", &out]);
        listens(&mut child);
        let outcome = interrupt(child, "-TERM");
        assert_eq!(outcome.status, 130, "{}", outcome.err);
        assert_eq!(outcome.out, results.out);
    }
}

/// Waits until the process has a handler for SIGINT.
#[cfg(target_os = "linux")]
fn listens(child: &mut Child) {
    const SIGINT: u64 = 1 << 1;
    let status = format!("/proc/{}/status", child.id());
    until(child, "handler", || {
        let status = fs::read_to_string(&status).unwrap_or_default();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        let caught = caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        caught.is_some_and(|mask| mask & SIGINT != 0)
    });
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_folder_nothing_is_saved() {
    let still = [
        "simulate",
        "tests/fixtures/still.sa",
        "--max-ticks",
        "1000000000000",
    ];
    let mut child = start(&still);
    listens(&mut child);
    let outcome = interrupt(child, "-INT");
    assert_eq!(outcome.status, 130);
    assert!(outcome.err.contains("with `--out DIR`"), "{}", outcome.err);
    assert!(!outcome.err.contains("stochc resume"), "{}", outcome.err);
    let mut child = start(&[&["trace"], &still[1..]].concat());
    listens(&mut child);
    let outcome = interrupt(child, "-INT");
    assert_eq!((outcome.status, outcome.out.as_str()), (130, ""));
}

#[test]
#[cfg(target_os = "linux")]
fn an_interrupted_trade_prints_its_measurements() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let trade = [
        "trade",
        "tests/fixtures/dense.sa",
        "--runs",
        "10000000",
        "--threads",
        "1",
        "--out",
        &out,
    ];
    let journal = path(out.as_ref(), "journal.jsonl");
    let mut child = start(&trade);
    until(&mut child, "measured run", || {
        let text = fs::read_to_string(&journal).unwrap_or_default();
        text.matches('\n').count() > 2
    });
    let outcome = interrupt(child, "-INT");
    assert_eq!(outcome.status, 130, "{}", outcome.err);
    assert!(outcome.out.contains("CPU/run"), "{}", outcome.out);
    let stored = fs::read_to_string(path(out.as_ref(), "trade.json")).unwrap();
    let stored: serde_json::Value = serde_json::from_str(&stored).unwrap();
    let runs = stored["candidates"][0]["programs"][0]["runs"]
        .as_u64()
        .unwrap();
    assert!(runs > 0, "{runs}");
}

/// Checks that signals that the caller ignores, as `nohup` does, stay ignored. Other signals still
/// end the process.
#[test]
#[cfg(target_os = "linux")]
fn an_ignored_signal_stays_ignored() {
    let still = "simulate tests/fixtures/still.sa --max-ticks 1000000000000 --quiet";
    let line = format!("trap '' HUP; exec {} {still}", env!("CARGO_BIN_EXE_stochc"));
    let mut command = with_signals("sh");
    command.args(["-c", &line]).stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    listens(&mut child);
    let id = child.id().to_string();
    let sent = Command::new("kill").args(["-HUP", &id]).status().unwrap();
    assert!(sent.success());
    std::thread::sleep(Duration::from_millis(500));
    assert!(child.try_wait().unwrap().is_none());
    let outcome = interrupt(child, "-TERM");
    assert_eq!(outcome.status, 130, "{}", outcome.err);
    assert_eq!(
        outcome.err.matches("stopping").count(),
        1,
        "{}",
        outcome.err
    );
}

/// Checks an interrupted search at any time: the command prints the best plan so far, or none.
#[test]
#[cfg(target_os = "linux")]
fn the_best_plan_is_written() {
    let plan = ["plan", "examples/five_tower.sa", "--time", "24h", "--quiet"];
    let mut child = start(&plan);
    let threads = format!("/proc/{}/task", child.id());
    let listens = || {
        let threads = fs::read_dir(&threads).into_iter().flatten().flatten();
        let names =
            threads.filter_map(|thread| fs::read_to_string(thread.path().join("comm")).ok());
        names.into_iter().any(|name| name.trim() == "signals")
    };
    until(&mut child, "thread that listens", listens);
    let outcome = interrupt(child, "-INT");
    assert_eq!(outcome.status, 130, "{}", outcome.err);
    if outcome.out.is_empty() {
        assert!(
            outcome.err.contains("stopped before there was a plan"),
            "{}",
            outcome.err
        )
    } else {
        assert!(
            outcome.out.contains("yields five_towers"),
            "{}",
            outcome.out
        );
        assert!(outcome.err.contains("the best of"), "{}", outcome.err);
    }
}
