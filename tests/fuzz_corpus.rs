//! The inputs that fuzzing has kept are answered like any other.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]

use std::path::PathBuf;

use stochc::compiler::{Limits, check};

#[test]
fn every_kept_input_is_answered() {
    let limits = Limits {
        events: 500,
        steps: 5_000,
        search: 2_000,
        further: None,
    };
    let mut count = 0;
    for folder in ["fuzz/corpus/check", "fuzz/corpus/parse"] {
        let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .collect();
        paths.sort();
        for path in paths {
            let bytes = std::fs::read(&path).unwrap();
            let mut reader = |name: &str| match name {
                "fuzz.sa" => Ok(bytes.clone()),
                _ => Err("there is only one file".to_owned()),
            };
            let checked = check("fuzz.sa", &mut reader, limits);
            let is_right = !checked.has_errors();
            let has_tables = checked
                .programs
                .iter()
                .all(|program| program.tables.is_some());
            assert!(!is_right || has_tables, "{}", path.display());
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
}
