//! Tests pipes, sockets, devices and folders in place of files. No command may wait for them or
//! read them without end.
use std::fs;
use std::os::unix::fs::symlink;
use std::os::unix::net::UnixListener;
use std::path::Path;
use std::process::Command;

use crate::stochc::{Outcome, path, stochc, stochc_with};

fn pipe(path: &str) {
    let made = Command::new("mkfifo").arg(path).status().unwrap();
    assert!(made.success());
}

fn refused(outcome: &Outcome, status: i32, what: &str) {
    let reasons = [
        "it is not a regular file",
        "is a folder",
        "contains no program",
    ];
    let is_reported = reasons.iter().any(|reason| outcome.err.contains(reason));
    assert!(is_reported, "{what}: {}{}", outcome.out, outcome.err);
    assert_eq!(outcome.status, status, "{what}: {}", outcome.err);
    // `report` takes its name from the input.
    assert!(outcome.out.is_empty(), "{what}: {}", outcome.out);
}

#[test]
fn only_regular_files_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let here = |name: &str| path(folder.path(), name);
    pipe(&here("pipe"));
    let _socket = UnixListener::bind(here("socket")).unwrap();
    symlink("/dev/zero", here("device")).unwrap();
    symlink("pipe", here("link")).unwrap();
    fs::create_dir(here("folder")).unwrap();
    let tower = fs::canonicalize("tests/fixtures/tower.sa").unwrap();
    symlink(&tower, here("tower.sa")).unwrap();
    for name in ["pipe", "socket", "device", "link", "folder"] {
        let file = here(name);
        for line in ["check", "check --fix", "compile", "simulate", "repeat"] {
            // A folder is valid input for `repeat`, because a results folder contains a manifest.
            if (line, name) != ("repeat", "folder") {
                refused(&stochc_with(line, &[&file]), 2, &format!("{line} {name}"));
            }
        }
        if name != "folder" {
            for line in ["fmt", "fmt --check"] {
                refused(&stochc_with(line, &[&file]), 2, &format!("{line} {name}"));
            }
        }
        let importing = here("importing.sa");
        fs::write(
            &importing,
            format!("import \"{name}\"\nimport \"tower.sa\"\n"),
        )
        .unwrap();
        let allowed = ["--allow-import", "/", &importing];
        refused(&stochc_with("check", &allowed), 1, name);
    }
    // A link to a regular file is accepted.
    let outcome = stochc_with("check", &[&here("tower.sa")]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    for device in ["/dev/zero", "/dev/null", "/dev/tty"] {
        let outcome = stochc(&format!("check {device}"));
        assert_eq!(outcome.status, 2, "{device}: {}", outcome.err);
    }
}

#[test]
fn results_folders_contain_only_regular_files() {
    let folder = tempfile::tempdir().unwrap();
    let simulate = "simulate --quiet tests/fixtures/dense.sa --runs 1 --record 0 --out";
    let (report, page) = (
        path(folder.path(), "page.html"),
        path(folder.path(), "pipe"),
    );
    pipe(&page);
    for (name, lines) in [
        (
            "manifest.json",
            &[
                "simulate",
                "show",
                "report",
                "replay --run 0",
                "export --format gltf --run 0",
            ][..],
        ),
        (
            "journal.jsonl",
            &[
                "simulate",
                "show",
                "report",
                "replay --run 0",
                "export --format gltf --run 0",
            ],
        ),
        (".lock", &["simulate"]),
        ("recordings/0-0.rec", &["replay --run 0"]),
    ] {
        for line in lines {
            let out = path(folder.path(), "out");
            assert_eq!(stochc_with(simulate, &[&out]).status, 0);
            let place = Path::new(&out).join(name);
            fs::remove_file(&place).unwrap();
            pipe(place.to_str().unwrap());
            let outcome = match *line {
                "simulate" => stochc_with(simulate, &[&out]),
                "report" => stochc_with("report", &[&out, "--out", &report]),
                line => stochc_with(line, &[&out]),
            };
            refused(&outcome, 2, &format!("{line}, {name}"));
            fs::remove_dir_all(&out).unwrap();
        }
    }
    let out = path(folder.path(), "out");
    assert_eq!(stochc_with(simulate, &[&out]).status, 0);
    let outcome = stochc_with("report", &[&out, "--out", &page]);
    refused(&outcome, 2, "a page of a report");
}
