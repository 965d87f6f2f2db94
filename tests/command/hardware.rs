//! Tests programs for special hardware: faces that always attract, suction, and pre-attached
//! blocks.
use std::fs;

use crate::stochc::{path, stochc, stochc_with};

const ATTACHED: &str = "tests/fixtures/attached.sa";

#[test]
fn pre_attached_blocks_are_summarized_separately() {
    let outcome = stochc("check --cost=9 tests/fixtures/attached.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    let (reject, suction) = outcome.out.split_once("\nsucked: ").unwrap();
    let first = "attached: 1 pre-attached block, 2 captures and 1 release in 2 phases, 1 warning allowed\n  \
         proved: completes in every order\n";
    assert!(reject.contains(first), "{reject}");
    assert!(
        !reject.contains("P.up -> A"),
        "the phase does not wait: {reject}"
    );
    assert!(
        suction
            .starts_with("1 pre-attached block, 2 captures and 1 release in 2 phases\n  proved: "),
        "{suction}"
    );
    let outcome = stochc("verify tests/fixtures/attached.sa");
    let strays = "Stray blocks that dock at any moment change nothing.\n";
    assert!(
        outcome
            .out
            .ends_with("2 programs verified; every order of events explored: 2\n"),
        "{}",
        outcome.out
    );
    assert_eq!(outcome.out.matches(strays).count(), 1, "{}", outcome.out);
}

#[test]
fn runs_count_unplanned_bonds() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "runs");
    let arguments = [ATTACHED, "--runs", "20", "--out", &out, "--captures"];
    let outcome = stochc_with("simulate --model shuffle --quiet", &arguments);
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    assert_eq!(outcome.row("Captures"), ["3", "3"]);
    let unplanned = outcome.row("Unplanned bonds");
    assert!(unplanned[0].parse::<f64>().unwrap() > 0.2, "{unplanned:?}");
    assert_eq!(unplanned[1], "-");
    assert!(
        outcome.out.contains("assemble: A.east -> B"),
        "{}",
        outcome.out
    );
    assert!(!outcome.out.contains("P.up -> A"), "{}", outcome.out);
    let journal = fs::read_to_string(path(folder.path(), "runs/journal.jsonl")).unwrap();
    let mut counted = [0, 0];
    for line in journal.lines().skip(1) {
        let value: serde_json::Value = serde_json::from_str(line).unwrap();
        let record = &value["record"];
        assert_eq!(record["outcome"]["kind"], "completed");
        assert_eq!(record["phase_ticks"][0], 0);
        assert_eq!(record["bonds"][0]["body"], 5, "the last of six");
        let program = usize::try_from(value["program"].as_u64().unwrap()).unwrap();
        // A count of zero is not in the record.
        counted[program] += record.get("unplanned").map_or(0, |n| n.as_u64().unwrap());
        assert!(record["unplanned"] != 0);
    }
    assert!(counted[0] > 5, "{counted:?}");
    assert_eq!(counted[1], 0, "suction has to be switched on");
    // Reading the folder again gives the same output.
    let again = stochc_with("show --captures", &[&out]);
    assert_eq!((again.status, again.out), (0, outcome.out));
    let page = stochc_with(
        "report",
        &[&out, "--out", &path(folder.path(), "page.html")],
    );
    assert_eq!(page.status, 0, "{}", page.err);
    let traces = (0..20).map(|run| {
        let run = run.to_string();
        stochc_with("trace --model shuffle --run", &[&run, ATTACHED]).out
    });
    let traces: String = traces.collect();
    assert!(
        traces.contains(" unplanned bond, undone at once\n"),
        "{traces}"
    );
    assert!(
        traces.contains(" unplanned bonds, undone at once\n"),
        "{traces}"
    );
}

#[test]
fn tables_list_captures_and_releases() {
    let outcome = stochc("compile tests/fixtures/attached.sa");
    for line in [
        "plate 1 x 1, every face always attracts\notherwise: reject what docks on any other face\n",
        "phase seed: pre-attached, before the first tick\nphase assemble: ends after 1 report\n",
        "    at the start of seed\n        expect up -> A at (0, 0, 1)\n",
        "expect east -> B at (1, 0, 1)\n",
        "once B asks: reject east, which frees B\n",
        "plate 1 x 1, blocks open 5 valves at a time\n",
        "open north for C at (0, 1, 1)\n",
        "once B asks: close east, which frees B\n",
    ] {
        assert!(outcome.out.contains(line), "{line} in {}", outcome.out);
    }
}

#[test]
fn pre_attached_blocks_grow_in_a_physical_model() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "planted.sa");
    let text = "import \"dense.sa\"\n\nassembly planted in dense {\n    seed plate 2 x 1 {\n        \
                for i in 0..1 {\n            M[i] at (i, 0)\n            M[i].up ->> T[i, 1..2]\n        \
                }\n    }\n    phase grow { T[0, 2].up -> A }\n}\n";
    fs::write(&file, text).unwrap();
    fs::copy("tests/fixtures/dense.sa", path(folder.path(), "dense.sa")).unwrap();
    let formatted = stochc_with("fmt --check", &[&file]);
    assert_eq!(formatted.status, 0, "{}", formatted.out);
    let out = path(folder.path(), "runs");
    let outcome = stochc_with("simulate --runs 1 --record 0 --out", &[&out, &file]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let journal = fs::read_to_string(path(folder.path(), "runs/journal.jsonl")).unwrap();
    let line: serde_json::Value = serde_json::from_str(journal.lines().nth(1).unwrap()).unwrap();
    let record = &line["record"];
    assert_eq!(record["outcome"]["kind"], "completed");
    assert!(
        record.get("unplanned").is_none(),
        "faces are switched on here"
    );
    let docked: Vec<u64> = (record["bonds"].as_array().unwrap().iter())
        .map(|bond| bond["docked"].as_u64().unwrap())
        .collect();
    assert_eq!((docked.len(), &docked[..4]), (5, &[0; 4][..]));
    assert!(docked[4] > 0, "{docked:?}");
    assert_eq!(record["blocks_used"], 5);
    let page = path(folder.path(), "run.html");
    let replayed = stochc_with("replay", &[&out, "--run", "0", "--out", &page]);
    assert_eq!(replayed.status, 0, "{}", replayed.err);
}

#[test]
fn only_the_first_phase_may_be_pre_attached() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "wrong.sa");
    for (seed, part) in [
        ("P.up -> A  release A", "misplaced"),
        (
            "P.up -> A.up -> B after A",
            "an `after` must be inside a phase",
        ),
        ("P.east -> A", "embedded-face"),
        ("P.up -> A  P.up -> B", "occupied-cell"),
        ("P.up ->> T[1..301]", "too-few-blocks"),
        ("Q.up -> A", "unknown-name"),
    ] {
        let text =
            format!("assembly a {{ seed plate 1 x 1 {{ P at (0, 0)  {seed} }} phase p {{ }} }}\n");
        fs::write(&file, text).unwrap();
        let outcome = stochc_with("check", &[&file]);
        assert_eq!(outcome.status, 1, "{seed}: {}", outcome.out);
        assert!(outcome.err.contains(part), "{seed}: {}", outcome.err);
    }
}
