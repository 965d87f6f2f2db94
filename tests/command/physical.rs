//! Tests a small ensemble with physics.
use std::fs;

use crate::stochc::{contains, path, stochc, stochc_with, tables};

#[test]
fn a_physical_run_depends_on_nothing_but_its_inputs() {
    let folder = tempfile::tempdir().unwrap();
    let outs = ["1", "3"].map(|threads| {
        let out = path(folder.path(), threads);
        let outcome = stochc_with(
            "simulate tests/fixtures/dense.sa --runs 3 --seed 5 --out",
            &[&out, "--threads", threads],
        );
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        assert!(
            outcome.err.starts_with("3 of 3 runs in "),
            "{}",
            outcome.err
        );
        out
    });
    assert!(
        tables(&outs[0]) == tables(&outs[1]),
        "threads do not matter"
    );

    let journal = fs::read_to_string(path(outs[0].as_ref(), "journal.jsonl")).unwrap();
    let last: serde_json::Value = serde_json::from_str(journal.lines().last().unwrap()).unwrap();
    assert_eq!(last["record"]["run"], 2, "one thread keeps the order");
    // A single run must equal the same run of the ensemble.
    let alone = "trace tests/fixtures/dense.sa --seed 5 --run 2";
    let outcome = stochc_with(alone, &["--json"]);
    assert!(
        contains(&outcome.json()["runs"][0], &last["record"]),
        "{}",
        outcome.out
    );
    let printed = stochc(alone).out;
    assert!(
        printed.starts_with("dense, run 2\n  phase grow, from tick 0 (0 s)\n"),
        "{printed}"
    );
    assert!(printed.contains("T[1].up captures T[2]"), "{printed}");
    assert!(printed.contains(&format!("complete after {} ticks", last["record"]["ticks"])));
}
