//! Tests `stochc fsck` through the command line.
use std::fs;
use std::path::Path;

use crate::stochc::{path, stochc_with, tables};

const SIMULATE: &str = "sweep --quiet tests/fixtures/dense.sa --substeps 1 --runs 3 --record all --vary free=12,14 --out";

fn flip(folder: &str, name: &str, at: usize) {
    let file = path(folder.as_ref(), name);
    let mut bytes = fs::read(&file).unwrap();
    let at = at.min(bytes.len() - 1);
    bytes[at] ^= 0x10;
    fs::write(&file, bytes).unwrap();
}

#[test]
fn corruption_is_reported_and_valid_parts_are_saved() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    assert_eq!(stochc_with(SIMULATE, &[&out]).status, 0);
    let whole = tables(&out);
    let outcome = stochc_with("fsck", &[&out]);
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    for name in [
        "manifest.json",
        "journal.jsonl",
        "sweep.csv",
        "recordings/1-2.rec",
    ] {
        assert!(
            outcome.out.contains(&format!("{name}: valid\n")),
            "{}",
            outcome.out
        );
    }
    let names = [
        "journal.jsonl",
        "runs.parquet",
        "sweep.svg",
        "recordings/0-1.rec",
    ];
    let names = names.map(|name| {
        if Path::new(&out).join(name).exists() {
            name
        } else {
            "sweep.json"
        }
    });
    for name in names {
        flip(&out, name, 700);
    }
    let outcome = stochc_with("fsck", &[&out]);
    assert_eq!(outcome.status, 2);
    for name in names {
        assert!(
            outcome.out.contains(&format!("{name}: damaged: ")),
            "{}",
            outcome.out
        );
    }
    assert_eq!(
        outcome.out.matches(": damaged: ").count(),
        4,
        "{}",
        outcome.out
    );
    assert!(!Path::new(&out).join("damaged").exists());
    let shown = stochc_with("show", &[&out]);
    assert_eq!(shown.status, 2);
    assert!(shown.err.contains("`stochc fsck"), "{}", shown.err);
    let outcome = stochc_with("fsck --repair", &[&out]);
    assert_eq!(outcome.status, 0, "{}{}", outcome.out, outcome.err);
    assert!(
        outcome.out.contains("5 of 6 runs are kept"),
        "{}",
        outcome.out
    );
    // The backup contains the corrupted files, and all files that depend on the lost line of the
    // journal.
    let others = ["checksums.json", "bonds.parquet", "phases.parquet"];
    for name in names.into_iter().chain(others) {
        let name = Path::new(name).file_name().unwrap().to_string_lossy();
        let aside = path(out.as_ref(), &format!("damaged/{name}"));
        assert!(Path::new(&aside).exists(), "{name}");
    }
    assert_eq!(stochc_with("fsck", &[&out]).status, 0);
    let outcome = stochc_with("resume --quiet --record all", &[&out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(tables(&out) == whole);
    let page = path(folder.path(), "page.html");
    let program = ["--program", "dense [free=12]", "--run", "1", "--out", &page];
    let outcome = stochc_with("replay", &[&[&out[..]], &program[..]].concat());
    assert_eq!(outcome.status, 0, "{}", outcome.err);
}

#[test]
fn a_corrupted_manifest_is_not_repaired() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    assert_eq!(stochc_with(SIMULATE, &[&out]).status, 0);
    flip(&out, "manifest.json", 700);
    let outcome = stochc_with("fsck --repair", &[&out]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("is damaged beyond repair"),
        "{}",
        outcome.err
    );
    assert!(!Path::new(&out).join("damaged").exists());
}

#[test]
fn a_folder_without_results_is_reported() {
    let outcome = stochc_with("fsck", &["tests/fixtures"]);
    assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
    assert!(
        outcome.err.contains("contains no results"),
        "{}",
        outcome.err
    );
}
