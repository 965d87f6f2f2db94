//! What no cluster can make.
use crate::emulated::{Ensemble, FAST, cluster, end};

/// A program that needs more memory than its tasks get.
#[test]
fn a_piece_that_fails_by_itself_is_named() {
    let Some(cluster) = cluster() else { return };
    let line = "simulate tests/fixtures/tower.sa --model shuffle --runs 1 --sweep free=10,9000000";
    let ensemble = Ensemble::cut(line, 2);
    let mut command = cluster.command("prlimit --as=200000000");
    command.args([env!("CARGO_BIN_EXE_stochc"), "submit", "--attempts", "2"]);
    let (status, said) = end(command.arg(&ensemble.path).spawn().unwrap());
    assert_eq!(status, 3, "{said}");
    assert!(
        said.contains("1 of 2 pieces are missing (1) after 2 attempts"),
        "{said}"
    );
    assert!(said.contains("memory allocation of"), "{said}");
    assert!(said.contains("(piece 1; FAILED) said:"), "{said}");
    let left = files_of(&ensemble.path);
    assert!(left.contains(&"0.jsonl".to_owned()), "{left:?}");
}

/// What Slurm says is told as it is.
#[test]
fn what_slurm_refuses_is_told() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(FAST, 2);
    let (status, said) = end(cluster.submit(&ensemble.path, "--partition nowhere"));
    assert_eq!(status, 2, "{said}");
    assert!(
        said.contains("invalid partition specified: nowhere"),
        "{said}"
    );
    assert!(said.contains("--dry-run"), "{said}");
    assert_eq!(cluster.arrays(&cluster.name(&ensemble.path)), 0);
}

fn files_of(folder: &std::path::Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder.join("shards")).unwrap().flatten();
    entries
        .map(|entry| entry.file_name().into_string().unwrap())
        .collect()
}
