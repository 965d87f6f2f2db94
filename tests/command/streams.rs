//! Tests output streams, including closed ones.
use std::process::Stdio;

#[cfg(target_os = "linux")]
use crate::stochc::stochc;
use crate::stochc::{command, path, run_command};

#[test]
fn nothing_is_coloured_outside_a_terminal() {
    for line in [
        "check tests/fixtures/wrong.sa",
        "check nothing --bogus",
        "explain cycle",
        "simulate --model shuffle --runs 3 tests/fixtures/tower.sa",
        "--help",
    ] {
        for no_colour in [None, Some("1")] {
            let mut command = command(line.split_whitespace());
            // The kind of terminal must not affect the output.
            command.env("TERM", "xterm-256color").env_remove("NO_COLOR");
            command.envs(no_colour.map(|value| ("NO_COLOR", value)));
            let outcome = run_command(&mut command);
            assert!(
                !outcome.out.contains('\x1b') && !outcome.err.contains('\x1b'),
                "{line}"
            );
        }
    }
}

/// Runs a command on a terminal, by the program `script`. Returns `None` if `script` is not
/// installed.
#[cfg(target_os = "linux")]
fn on_a_terminal(arguments: &str) -> Option<String> {
    on_a_terminal_called("xterm", arguments)
}

/// Runs a command on a terminal of this kind.
#[cfg(target_os = "linux")]
fn on_a_terminal_called(kind: &str, arguments: &str) -> Option<String> {
    let line = format!("{} {arguments}", env!("CARGO_BIN_EXE_stochc"));
    let mut script = std::process::Command::new("script");
    script
        .args(["-qec", &line, "/dev/null"])
        .stdin(Stdio::null());
    let output = script.env("TERM", kind).env_remove("NO_COLOR").output();
    let output = output.inspect_err(|_| crate::skipped::skipped("bsdutils", "script"));
    Some(String::from_utf8(output.ok()?.stdout).unwrap())
}

#[test]
#[cfg(target_os = "linux")]
fn a_dumb_terminal_gets_no_colours_and_no_bar() {
    for line in [
        "check tests/fixtures/wrong.sa",
        "simulate --model shuffle --runs 3 tests/fixtures/tower.sa",
    ] {
        let Some(dumb) = on_a_terminal_called("dumb", line) else {
            return;
        };
        assert!(!dumb.contains('\x1b'), "{dumb:?}");
        let able = on_a_terminal(line).unwrap();
        assert!(able.contains('\x1b'), "{able:?}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_terminal_gets_the_next_command() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let simulate = "simulate --model shuffle --runs 3 tests/fixtures/tower.sa";
    let Some(watched) = on_a_terminal(&format!("{simulate} --out {out}")) else {
        return;
    };
    assert!(
        watched.contains(&format!("stochc report {out}")),
        "{watched}"
    );
    // Without a results folder, `report` is not suggested.
    assert!(!on_a_terminal(simulate).unwrap().contains("stochc report"));
    let quiet = on_a_terminal(&format!("{simulate} --quiet --out {out}-0")).unwrap();
    assert!(!quiet.contains("stochc report"), "{quiet}");
    // If output goes to a pipe, it does not suggest the next command.
    for json in ["", "--json"] {
        let piped = stochc(&format!("{simulate} {json} --out {out}-1{json}"));
        assert!(!piped.out.contains("stochc report"), "{}", piped.out);
        assert!(piped.err.contains("stochc report"), "{}", piped.err);
    }
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "long.sa");
    // The output is larger than the buffer of a pipe.
    let program = "assembly long {\n\
                   seed plate 3 x 3 { M at (1, 1) }\n\
                   phase grow { M.up ->> T[1..20] }\n\
                   }\n";
    std::fs::write(&file, program).unwrap();
    for arguments in [
        &["compile", "--format", "json", &file][..],
        &["compile", "--emit", "graph", "--format", "dot", &file],
        &["check", &file],
        &["check", "--format", "short", "tests/fixtures/wrong.sa"],
        &["explain"],
        &["explain", "cycle"],
        &["simulate", "--model", "shuffle", "--runs", "3", &file],
        &["trace", "--model", "shuffle", "--run", "3", &file],
        &["--help"],
    ] {
        let mut command = command(arguments.iter().copied());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert!(!err.contains("panicked"), "{arguments:?}: {err}");
        assert!(matches!(output.status.code(), Some(0 | 1)), "{arguments:?}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_reported() {
    for line in [
        "--help",
        "simulate --help",
        "--version",
        "explain",
        "check tests/fixtures/tower.sa",
        "compile tests/fixtures/tower.sa",
        "simulate --model shuffle --runs 3 tests/fixtures/tower.sa",
    ] {
        let full = std::fs::File::options()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let mut command = command(line.split_whitespace());
        let output = command.stdout(full).output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{line}");
        assert!(err.contains("cannot write the output"), "{err}");
    }
}

/// Checks that files are written before messages: a closed output changes neither files nor the
/// exit status.
#[test]
fn a_closed_pipe_loses_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let [out, trade] = ["out", "trade"].map(|name| path(folder.path(), name));
    let unsuccessful = [
        "sweep",
        "--model",
        "shuffle",
        "--runs",
        "2",
        "--max-ticks",
        "2",
        "--quiet",
    ];
    let sweep = [
        "tests/fixtures/tower.sa",
        "--vary",
        "free=50,100",
        "--out",
        &out,
    ];
    let measure = [
        "trade",
        "tests/fixtures/dense.sa",
        "--runs",
        "2",
        "--finest",
        "4",
        "--quiet",
    ];
    for (line, status, files) in [
        (
            [&unsuccessful[..], &sweep].concat(),
            3,
            &["runs.parquet", "sweep.csv", "sweep.json"][..],
        ),
        (
            [&measure[..], &["--max-ticks", "2000", "--out", &trade]].concat(),
            0,
            &["trade.json", "trade.svg"],
        ),
    ] {
        let mut command = command(line.iter().copied());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{err}");
        let out = line.last().unwrap();
        for file in files {
            assert!(std::path::Path::new(out).join(file).is_file(), "{file}");
        }
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_limit_on_file_sizes_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "graph.json");
    let line = format!(
        "ulimit -f 1; exec {} compile examples/five_tower.sa --format json --out {out}",
        env!("CARGO_BIN_EXE_stochc")
    );
    let mut limited = std::process::Command::new("sh");
    let output = limited.args(["-c", &line]).output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{err}");
    assert!(err.contains("cannot write"), "{err}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
